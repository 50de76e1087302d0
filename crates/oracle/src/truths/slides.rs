//! Slides before lamps at a point: projectors, spots and luminaires with a picture, by way of a mirror too.

use serde_json::{Value, json};

use super::cie171::LUX;
use super::image_files::grey_hdr;
use super::meters::measured;
use super::scene::{Scene, mirror, parallelogram};
use super::{Claim, Truth};
use crate::vector::{Vec3, add, cross, dot, length, normalize, scale, sub};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = pictures();
    list.extend(beside());
    list.push(colours());
    list.push(in_a_mirror());
    list
}

const INTENSITY: f64 = 10.0;

/// A lamp that throws a slide, and a place that it throws it to.
#[derive(Clone, Copy)]
struct Throw {
    lamp: Vec3,
    direction: Vec3,
    up: Vec3,
    /// Tangents of the angles to its right and upper edge.
    tangents: [f64; 2],
    place: Vec3,
}

impl Throw {
    /// Unit vectors to the right, up, and through the middle.
    fn axes(&self) -> [Vec3; 3] {
        let middle = normalize(self.direction);
        let right = normalize(cross(middle, self.up));
        [right, cross(right, middle), middle]
    }

    /// The depth of the place before the lamp, and where it stands in the slide, from (0, 0) at the lower left to (1, 1).
    fn stands(&self) -> (f64, [f64; 2]) {
        let way = sub(self.place, self.lamp);
        let [x, y, depth] = self.axes().map(|axis| dot(way, axis));
        let [right, up] = self.tangents;
        (depth, [0.5 + 0.5 * x / (depth * right), 0.5 + 0.5 * y / (depth * up)])
    }

    /// The same from the lengths of the sides of a triangle: the foot of the place on the axis, by squares alone.
    fn stands_by_lengths(&self) -> (f64, [f64; 2]) {
        let [right, _, middle] = self.axes();
        let far = sub(self.place, self.lamp);
        let along = |axis: Vec3| (dot(far, far) + 1.0 - length(sub(far, axis)).powi(2)) / 2.0;
        let (depth, x) = (along(middle), along(right));
        let y = (dot(far, far) - depth * depth - x * x).max(0.0).sqrt() * dot(far, self.axes()[1]).signum();
        let [of_right, of_up] = self.tangents;
        (depth, [0.5 + x / (2.0 * depth * of_right), 0.5 + y / (2.0 * depth * of_up)])
    }

    fn slide(&self, image: &Value, even_on: Option<&str>) -> Value {
        let [right, up] = self.tangents;
        let mut slide = json!({
            "image": image, "direction": self.direction, "up": self.up, "horizontal_fov_deg": 2.0 * right.atan().to_degrees(),
            "aspect": right / up,
        });
        if let Some(even_on) = even_on {
            slide["even_on"] = json!(even_on);
        }
        slide
    }

    /// A scene with a meter at the place that faces against the slide's direction.
    fn scene(&self, light: Value) -> Scene {
        let meter = json!({ "type": "irradiance", "position_m": self.place, "normal": scale(-1.0, self.direction) });
        measured(&[meter]).light(light)
    }
}

fn tilted(place: Vec3) -> Throw {
    Throw { lamp: [0.4, -0.3, 2.2], direction: [0.2, 0.1, -1.0], up: [0.1, 1.0, 0.3], tangents: [0.8, 0.5], place }
}

/// Irradiance behind gradients, a chequerboard, and an image of 3 by 2 texels.
fn pictures() -> Vec<Truth> {
    let from_to = |along: &str| json!({ "type": "gradient", "from": 0.2, "to": 1, "along": along });
    let linear = |t: f64| 0.2 + 0.8 * t;
    let throw = tilted([1.3, 0.3, 0.1]);
    let mut list = Vec::new();
    for (name, along, k) in [("projector-from-left-to-right", "u", 0), ("projector-from-below", "v", 1)] {
        let even = move |(depth, uv): (f64, [f64; 2])| INTENSITY * linear(uv[k]) / (depth * depth);
        let (depth, uv) = throw.stands();
        let value = even((depth, uv));
        let cos = depth / length(sub(throw.place, throw.lamp));
        let light = json!({
            "type": "point", "position_m": throw.lamp, "intensity": INTENSITY, "slide": throw.slide(&from_to(along), None),
        });
        list.push(
            Truth::new(name, &throw.scene(light), value, "I₀ C(u, v)/d², d the depth before the lamp")
                .because("A projector lights a screen across its direction by its picture alone, without the cos³θ of a bare lamp.")
                .confirmed("depth and place by lengths of sides", 1e-9, move || even(throw.stands_by_lengths()))
                .or_else("the picture turned over", INTENSITY * linear(1.0 - uv[k]) / (depth * depth))
                .or_else("the other coordinate", INTENSITY * linear(uv[1 - k]) / (depth * depth))
                .or_else("cos³θ as of a bare lamp", value * cos.powi(3))
                .or_else("by the distance", value * cos * cos)
                .or_else("the slide left out", INTENSITY * cos.powi(3) / (depth * depth))
                .sees(1e-4),
        );
    }
    list.push(spot_with_a_gobo());
    list.push(luminaire_with_a_slide());
    list.push(image_file());
    list
}

/// A soft spot through a chequerboard; the place lies between its two angles.
fn spot_with_a_gobo() -> Truth {
    let throw = tilted([1.3, 0.3, 0.1]);
    let (depth, [u, v]) = throw.stands();
    let distance = length(sub(throw.place, throw.lamp));
    let cos = depth / distance;
    let [inner, outer] = [8.0_f64, 25.0].map(|degrees| degrees.to_radians().cos());
    let x = (cos - outer) / (inner - outer);
    // Four by four fields, of which the first is lower left.
    let odd = ((4.0 * u).floor() + (4.0 * v).floor()) as i64 % 2 != 0;
    let [shows, other] = if odd { [0.25, 0.75] } else { [0.75, 0.25] };
    let of = move |shows: f64| INTENSITY * x * x * (3.0 - 2.0 * x) * shows * cos / (distance * distance);
    let value = of(shows);
    let board = json!({ "type": "checker", "first": 0.75, "second": 0.25, "uv_scale": [2, 2] });
    let light = json!({
        "type": "spot", "position_m": throw.lamp, "direction": throw.direction, "inner_half_angle_deg": 8, "half_angle_deg": 25,
        "intensity": INTENSITY, "slide": throw.slide(&board, Some("sphere")),
    });
    Truth::new("spot-with-a-gobo", &throw.scene(light), value, "I(θ) C cos θ/r²")
        .because("Before a spot, a picture multiplies its intensity.")
        .confirmed("the integral of 6t(1 − t) up to x, and the place by lengths of sides", 1e-9, move || {
            let (depth, _) = throw.stands_by_lengths();
            let falls = crate::quadrature::interval(|t| 6.0 * t * (1.0 - t), 0.0, x, 1e-12).value;
            INTENSITY * falls * shows * depth / distance.powi(3)
        })
        .or_else("the field beside", of(other))
        .or_else("evenly on a screen", value / cos.powi(3))
        .or_else("the slide left out", of(1.0))
        .sees(1e-4)
}

/// A luminaire whose intensity falls in proportion to the angle, through a gradient.
fn luminaire_with_a_slide() -> Truth {
    let throw = tilted([1.1, -0.6, 0.1]);
    let (depth, [u, _]) = throw.stands();
    let distance = length(sub(throw.place, throw.lamp));
    let angle = (depth / distance).acos().to_degrees();
    let lux = 400.0 * (1.0 - angle / 60.0) * (1.0 - 0.9 * u) * depth / distance.powi(3);
    let file = b"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 0\n0 60\n0\n400 0\n".to_vec();
    let image = json!({ "type": "gradient", "from": 1, "to": 0.1, "along": "u" });
    let light = json!({
        "type": "luminaire", "file": "cone.ies", "position_m": throw.lamp, "nadir": throw.direction, "forward": [1, 0, 0],
        "slide": throw.slide(&image, Some("sphere")),
    });
    let value = lux / LUX;
    let scene = throw.scene(light).file("cone.ies", file);
    Truth::new("luminaire-with-a-slide", &scene, value, "I(γ) C(u) cos γ/r², over 683.002 lm/W · ∫ȳ dλ")
        .because("Before a luminaire, a picture multiplies the intensities of its file.")
        .confirmed("depth and place by lengths of sides", 1e-9, move || {
            let (depth, [u, _]) = throw.stands_by_lengths();
            let angle = (depth / distance).acos().to_degrees();
            400.0 * (60.0 - angle) / 60.0 * (0.1 + 0.9 * (1.0 - u)) * depth / distance.powi(3) / LUX
        })
        .or_else("the slide left out", value / (1.0 - 0.9 * u))
        .or_else("the picture turned over", value * (0.1 + 0.9 * u) / (1.0 - 0.9 * u))
        .claims(Claim::PhotometricSensor)
        .allows(3e-4 * value, "spectra are drawn as straight lines between nanometres, and ȳ too")
        .sees(0.005)
}

/// An image of 3 by 2 texels, linear between their centres, whose shape is that of the slide.
fn image_file() -> Truth {
    let texels = [0.125, 0.5, 1.0, 0.75, 0.25, 2.0];
    let throw = Throw { tangents: [0.75, 0.5], ..tilted([0.0; 3]) };
    let [right, up, middle] = throw.axes();
    let aside = add(scale(0.3, right), scale(-0.1, up));
    let throw = Throw { place: add(throw.lamp, scale(2.0, add(middle, aside))), ..throw };
    let (depth, [u, v]) = throw.stands();
    let (x, y) = (3.0 * u - 0.5, 2.0 * (1.0 - v) - 0.5);
    // The place lies between the centres of texels.
    let (column, row) = (x.floor() as usize, y.floor() as usize);
    let (right, down) = (x.fract(), y.fract());
    let texel = |column: usize, row: usize| texels[3 * row + column];
    let across = |row: usize| texel(column, row) * (1.0 - right) + texel(column + 1, row) * right;
    let shows = across(row) * (1.0 - down) + across(row + 1) * down;
    let value = INTENSITY * shows / (depth * depth);
    let mut slide = throw.slide(&json!({ "type": "image", "file": "slide.hdr", "encoding": "linear" }), None);
    slide.as_object_mut().expect("a slide").remove("aspect");
    let light = json!({ "type": "point", "position_m": throw.lamp, "intensity": INTENSITY, "slide": slide });
    let scene = throw.scene(light).file("slide.hdr", grey_hdr(3, &texels));
    let hats = move || {
        let hat = |t: f64| (1.0 - t.abs()).max(0.0);
        let weight = |i: usize| hat(x - (i % 3) as f64) * hat(y - (i / 3) as f64);
        INTENSITY * (0..6).map(|i| weight(i) * texels[i]).sum::<f64>() / (depth * depth)
    };
    Truth::new("projector-of-an-image", &scene, value, "I₀ C/d², C linear between the centres of texels")
        .because("The slide has the shape of its image, whose rows run from the top.")
        .confirmed("hats around the centres of texels", 1e-12, hats)
        .or_else("the nearest texel", INTENSITY * texel(x.round() as usize, y.round() as usize) / (depth * depth))
        .or_else("the slide left out", value / shows)
        .sees(1e-4)
}

/// Just outside of each edge, and behind the lamp, there is no light.
fn beside() -> Vec<Truth> {
    let throw = tilted([0.0; 3]);
    let [right, up, middle] = throw.axes();
    let at = |x: f64, y: f64| {
        let aside = add(scale(1.5 * 0.8 * x, right), scale(1.5 * 0.5 * y, up));
        add(throw.lamp, add(scale(1.5, middle), aside))
    };
    let white = json!({ "type": "checker", "first": 1, "second": 1 });
    let mut places = vec![
        ("right-of-a-slide", at(1.01, 0.5), 1.0),
        ("left-of-a-slide", at(-1.01, 0.5), 1.0),
        ("above-a-slide", at(0.5, 1.01), 1.0),
        ("below-a-slide", at(0.5, -1.01), 1.0),
    ];
    places.push(("behind-a-projector", sub(scale(2.0, throw.lamp), at(0.5, 0.5)), -1.0));
    let lit = INTENSITY / 2.25;
    let dark = places.into_iter().map(|(name, place, side)| {
        let throw = Throw { place, ..throw };
        let light = json!({
            "type": "point", "position_m": throw.lamp, "intensity": INTENSITY, "slide": throw.slide(&white, None),
        });
        let meter = json!({ "type": "irradiance", "position_m": place, "normal": scale(-side, throw.direction) });
        Truth::new(name, &measured(&[meter]).light(light), 0.0, "0")
            .because("A slide lets no light pass beside itself.")
            .or_else("the picture goes on", lit)
    });
    let throw = Throw { place: at(0.99, -0.99), ..throw };
    let light = json!({
        "type": "point", "position_m": throw.lamp, "intensity": INTENSITY, "slide": throw.slide(&white, None),
    });
    let corner = Truth::new("corner-of-a-slide", &throw.scene(light), lit, "I₀/d²")
        .because("A white slide lights a screen evenly up to its edges.")
        .confirmed("I₀/cos³θ · cos θ/r²", 1e-9, move || {
            let way = sub(throw.place, throw.lamp);
            let cos = dot(normalize(way), normalize(throw.direction));
            INTENSITY / cos.powi(3) * cos / dot(way, way)
        })
        .or_else("dark", 0.0)
        .sees(1e-4);
    dark.chain([corner]).collect()
}

/// The luminance of a saturated colour, of a lamp of daylight.
fn colours() -> Truth {
    let throw = tilted([0.9, 0.2, 0.1]);
    let (depth, _) = throw.stands();
    let colour = [0.9, 0.1, 0.05];
    let luminance = |rgb: [f64; 3]| 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    let lux = 300.0 * luminance(colour) / (depth * depth);
    let image = json!({ "type": "checker", "first": colour, "second": colour });
    let light = json!({
        "type": "point", "position_m": throw.lamp, "intensity_cd": 300, "spectrum": { "type": "illuminant", "name": "D65" },
        "slide": throw.slide(&image, None),
    });
    let value = lux / LUX;
    Truth::new("luminance-of-a-coloured-slide", &throw.scene(light), value, "I C_Y/d², over 683.002 lm/W · ∫ȳ dλ")
        .because("A colour of a slide is a share of the white of D65, of the luminance that Rec. 709 gives it.")
        .confirmed("depth by lengths of sides", 1e-9, move || {
            let (depth, _) = throw.stands_by_lengths();
            300.0 * luminance(colour) / (depth * depth) / LUX
        })
        .or_else("white", value / luminance(colour))
        .or_else("red and blue exchanged", value / luminance(colour) * luminance([0.05, 0.1, 0.9]))
        .claims(Claim::PhotometricSensor)
        .allows(1e-3 * value, "the primaries are tables between which spectra are straight lines")
        .sees(0.01)
}

/// A meter that sees a projector by way of a mirror alone: the mirror image of its picture.
fn in_a_mirror() -> Truth {
    // The mirror is the plane x = 1; the place lies behind the projector.
    let reflected = |p: Vec3| [2.0 - p[0], p[1], p[2]];
    let turned = |d: Vec3| [-d[0], d[1], d[2]];
    let lamp = [0.0, 0.2, 0.3];
    let (direction, up, tangents) = ([1.0, 0.1, 0.05], [0.0, 0.0, 1.0], [0.8, 0.6]);
    let place = [-0.5, 0.7, 0.9];
    let throw = Throw { lamp, direction, up, tangents, place: reflected(place) };
    let (depth, [u, _]) = throw.stands();
    let meter = json!({ "type": "irradiance", "position_m": place, "normal": scale(-1.0, turned(direction)) });
    let image = json!({ "type": "gradient", "from": 0.2, "to": 1, "along": "u" });
    let light = json!({
        "type": "point", "position_m": lamp, "intensity": INTENSITY, "slide": throw.slide(&image, None),
    });
    let scene = measured(&[meter])
        .spp(1 << 15)
        .object(parallelogram([1.0, -9.0, -9.0], [0.0, 18.0, 0.0], [0.0, 0.0, 18.0]), mirror(0.8))
        .light(light);
    let of = move |shows: f64| 0.8 * INTENSITY * shows / (depth * depth);
    Truth::new("projector-in-a-mirror", &scene, of(0.2 + 0.8 * u), "R I₀ C(u)/d²")
        .because("A flat mirror throws the picture as far as it would go behind it, mirrored and R times as bright.")
        .confirmed("depth and place by lengths of sides", 1e-9, move || {
            let (depth, [u, _]) = throw.stands_by_lengths();
            0.8 * INTENSITY * (0.2 + 0.8 * u) / (depth * depth)
        })
        .or_else("the picture turned over", of(1.0 - 0.8 * u))
        .or_else("the slide left out of the light by mirrors", of(1.0))
        .or_else("dark", 0.0)
        .claims(Claim::SpecularConnections)
        .sees(0.005)
}
