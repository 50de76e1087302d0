//! Where images lie on disks with square coordinates and on cylinders, and which way u and v grow there.

use std::f64::consts::TAU;

use serde_json::{Value, json};

use super::shown::{Shown, Wrap, patches};
use super::{flat, matte};
use crate::truths::facets::{direction, highlight, highlight_by_slopes};
use crate::truths::scene::{Scene, brushed_metal, disk};
use crate::truths::{Claim, Truth};
use crate::vector::{Vec3, add, cross, dot, normalize, scale};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = disks();
    list.extend(walls());
    list.push(end());
    list.extend(brushed());
    list
}

const FILE: &str = "patches.hdr";

/// The directions in which u and v of a disk grow, and its normal. With the normal +z they are +x and +y, with −z +x and −y. The turn on the
/// shortest way from there to the normal carries them along.
fn axes(normal: Vec3) -> [Vec3; 3] {
    let n = normalize(normal);
    let up = if n[2] < 0.0 { -1.0 } else { 1.0 };
    let between = add(n, [0.0, 0.0, up]);
    // The turn adds to a vector w across the first normal −(w·n)/(1 + cos) times the sum of both normals.
    let turned = |w: Vec3| add(w, scale(-dot(w, n) / (1.0 + up * n[2]), between));
    [turned([1.0, 0.0, 0.0]), turned([0.0, up, 0.0]), n]
}

/// A point in a frame.
fn at([s, t, n]: [Vec3; 3], [a, b, c]: Vec3) -> Vec3 {
    add(add(scale(a, s), scale(b, t)), scale(c, n))
}

/// A square of side `side_m` about a place, seen from along `toward`.
fn seen(place: Vec3, toward: Vec3, up: Vec3, side_m: f64) -> Scene {
    Scene::orthographic(add(place, scale(2.0, toward)), place, side_m).up(up).film(16, 16)
}

/// The same, of a body with an image on it, in a sky of radiance 1.
fn pictured(place: Vec3, toward: Vec3, up: Vec3, side_m: f64, shape: Value, image: &Shown) -> Scene {
    seen(place, toward, up, side_m)
        .sky(1.0)
        .spp(1024)
        .thing(json!({ "shape": shape, "material": matte(image.albedo(FILE)) }))
        .file(FILE, image.hdr())
}

/// A square of the disk, by its coordinates.
fn disks() -> Vec<Truth> {
    const RADIUS_M: f64 = 0.5;
    let centre = [0.3, -0.2, 0.1];
    let make = |name: &str, normal: Vec3, bilinear: bool, u: [f64; 2], v: [f64; 2]| {
        let image = Shown { bilinear, ..patches() };
        let frame = axes(normal);
        let middle = |[from, to]: [f64; 2]| RADIUS_M * (from + to - 1.0);
        let place = add(centre, at(frame, [middle(u), middle(v), 0.0]));
        let side_m = 2.0 * RADIUS_M * (u[1] - u[0]);
        let scene = pictured(place, frame[2], frame[1], side_m, disk(centre, normal, RADIUS_M), &image);
        with_mistakes(flat(name, &scene, &image, u, v), &image, u, v)
    };
    let mut list = vec![
        make("texture-on-a-disk", [0.0, 0.0, 1.0], true, [0.55, 0.8], [0.15, 0.4]),
        make("texture-on-a-slanting-disk", [2.0, 3.0, 6.0], false, [0.2, 0.5], [0.55, 0.85]),
        make("texture-on-a-disk-that-faces-down", [-2.0, 3.0, -6.0], true, [0.15, 0.4], [0.3, 0.55]),
    ];
    // Mirrored and twice as large: u = ½ − (x + 0.6)/2, v = ½ + (y + 0.4)/2.
    let (image, u, v) = (patches(), [0.6, 0.85], [0.2, 0.45]);
    let mut scene = seen([-0.6 - 0.45, -0.4 - 0.35, 0.2], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 0.5).sky(1.0).spp(1024);
    scene = scene
        .thing(json!({
            "shape": disk(centre, [0.0, 0.0, 1.0], RADIUS_M), "material": matte(image.albedo(FILE)),
            "transform": [{ "scale": [-2, 2, 2] }],
        }))
        .file(FILE, image.hdr());
    let truth = flat("texture-on-a-mirrored-disk", &scene, &image, u, v);
    list.push(with_mistakes(truth, &image, u, v));
    list
}

/// What a square of a disk shows if its coordinates run otherwise.
fn with_mistakes(truth: Truth, image: &Shown, u: [f64; 2], v: [f64; 2]) -> Truth {
    let back = |[from, to]: [f64; 2]| [1.0 - to, 1.0 - from];
    truth
        .or_else("left and right exchanged", image.mean(back(u), v))
        .or_else("upside down", image.mean(u, back(v)))
        .or_else("u and v exchanged", image.mean(v, u))
        .or_else("a quarter of a turn off", image.mean(v, back(u)))
        .or_else("a quarter of a turn off, the other way", image.mean(back(v), u))
        .or_else("half a turn off", image.mean(back(u), back(v)))
}

/// A cylinder seen from the side: at the angle `turn` from where u is ½, counter-clockwise seen from its end. The axis is upright in the picture,
/// which shows the parts [x] of the radius, to the right of the axis, and heights above the start, m.
struct Side {
    name: &'static str,
    along: Vec3,
    length_m: f64,
    radius_m: f64,
    capped: bool,
    image: Shown,
    turn: f64,
    x: [f64; 2],
    bottom_m: f64,
}

impl Side {
    const START: Vec3 = [0.1, 0.2, -0.3];

    /// Coordinates at the shares a and b of the picture: a ray at the part x of the radius meets the wall at the angle asin x from the middle.
    fn uv(&self, a: f64, b: f64) -> [f64; 2] {
        let [from, to] = self.x;
        let side_m = (to - from) * self.radius_m;
        [0.5 + (self.turn + (from + a * (to - from)).asin()) / TAU, (self.bottom_m + b * side_m) / self.length_m]
    }

    /// The same from the point in space: its angle and height in the cylinder's frame.
    fn uv_again(&self, a: f64, b: f64) -> [f64; 2] {
        let [s, t, n] = axes(self.along);
        let [from, to] = self.x;
        let x = from + a * (to - from);
        let toward = at([s, t, n], [self.turn.cos(), self.turn.sin(), 0.0]);
        let right = cross(n, toward);
        let height_m = self.bottom_m + b * (to - from) * self.radius_m;
        let from_start = at([right, toward, n], [x * self.radius_m, (1.0 - x * x).sqrt() * self.radius_m, height_m]);
        let turns = dot(from_start, t).atan2(dot(from_start, s)) / TAU;
        [0.5 + turns, dot(from_start, n) / self.length_m]
    }

    fn truth(self) -> Truth {
        let [s, t, n] = axes(self.along);
        let toward = at([s, t, n], [self.turn.cos(), self.turn.sin(), 0.0]);
        let [from, to] = self.x;
        let side_m = (to - from) * self.radius_m;
        let middle =
            at([cross(n, toward), toward, n], [0.5 * (from + to) * self.radius_m, 0.0, self.bottom_m + 0.5 * side_m]);
        let shape = json!({
            "type": "cylinder", "start_m": Self::START, "end_m": add(Self::START, scale(self.length_m, n)),
            "radius_m": self.radius_m, "capped": self.capped,
        });
        let scene = pictured(add(Self::START, middle), toward, n, side_m, shape, &self.image);
        // With the nearest texel the mean of midpoints is off by what their columns at an edge make up.
        let tolerance = if self.image.bilinear { 1e-4 } else { 2e-3 };
        let over = |uv: &dyn Fn([f64; 2]) -> [f64; 2]| self.image.over(400, |a, b| uv(self.uv(a, b)));
        let mistakes = [
            ("left and right exchanged", over(&|[u, v]| [1.0 - u, v])),
            ("upside down", over(&|[u, v]| [u, 1.0 - v])),
            ("u and v exchanged", over(&|[u, v]| [v, u])),
            ("a quarter of a turn off", over(&|[u, v]| [u + 0.25, v])),
            ("a quarter of a turn off, the other way", over(&|[u, v]| [u - 0.25, v])),
            ("half a turn off", over(&|[u, v]| [u + 0.5, v])),
            ("u even across the picture", {
                let [first, last] = [self.uv(0.0, 0.0)[0], self.uv(1.0, 0.0)[0]];
                self.image.over(400, |a, b| [first + a * (last - first), self.uv(a, b)[1]])
            }),
        ];
        // By the areas of texels, or by midpoints.
        let value = if self.image.bilinear { self.image.over(1500, |a, b| self.uv(a, b)) } else { self.by_areas() };
        let formula = format!(
            "mean over the picture of the image at u = ½ + ({} + asin x)/2π, x from {from} to {to}, and v even from {} to {}",
            self.turn,
            self.uv(0.0, 0.0)[1],
            self.uv(0.0, 1.0)[1]
        );
        let truth = Truth::new(self.name, &scene, value, formula)
            .because(
                "Each place of a convex Lambert body under a sky of radiance 1 shows its albedo. u is the angle around the axis, counter-clockwise \
                 seen from the end, in turns, and ½ on the side where u of a disk across the axis grows. v is the share of the way from start to end.",
            )
            .sees(0.01);
        let truth = mistakes.into_iter().fold(truth, |truth, (what, value)| truth.or_else(what, value));
        truth.confirmed("points of the wall in space, on another grid", tolerance, move || {
            self.image.over(1111, |a, b| self.uv_again(a, b))
        })
    }

    /// Each texel's area in the picture: between x at its edges, the sines of their angles.
    fn by_areas(&self) -> f64 {
        let [columns, rows] = [self.image.width, self.image.texels.len() / self.image.width];
        let ([u_0, v_0], [u_1, v_1]) = (self.uv(0.0, 0.0), self.uv(1.0, 1.0));
        let [from, to] = self.x;
        let mut sum = 0.0;
        for i in (u_0 * columns as f64).floor() as i64..=(u_1 * columns as f64).floor() as i64 {
            let x = |edge: i64| {
                let u = (edge as f64 / columns as f64).clamp(u_0, u_1);
                (TAU * (u - 0.5) - self.turn).sin()
            };
            for j in (v_0 * rows as f64).floor() as i64..=(v_1 * rows as f64).floor() as i64 {
                let v = |edge: i64| (edge as f64 / rows as f64).clamp(v_0, v_1);
                sum += (x(i + 1) - x(i)) * (v(j + 1) - v(j)) * self.image.texel(i, j);
            }
        }
        sum / ((to - from) * (v_1 - v_0))
    }
}

fn walls() -> Vec<Truth> {
    let nearest = || Shown { bilinear: false, ..patches() };
    [
        Side {
            name: "texture-on-a-cylinder",
            along: [0.0, 1.0, 0.0],
            length_m: 2.0,
            radius_m: 0.8,
            capped: true,
            image: patches(),
            turn: -0.25 * TAU,
            x: [-0.2, 0.8],
            bottom_m: 0.7,
        },
        Side {
            name: "texture-on-a-slanting-tube",
            along: [2.0, 3.0, 6.0],
            length_m: 1.4,
            radius_m: 0.5,
            capped: false,
            image: nearest(),
            turn: 0.7,
            x: [-0.9, 0.1],
            bottom_m: 0.2,
        },
        // Where u goes from 1 to 0.
        Side {
            name: "texture-on-a-cylinder-at-its-seam",
            along: [-2.0, 3.0, -6.0],
            length_m: 1.4,
            radius_m: 0.5,
            capped: true,
            image: patches(),
            turn: 2.6,
            x: [-0.1, 0.9],
            bottom_m: 0.1,
        },
    ]
    .into_iter()
    .map(Side::truth)
    .collect()
}

/// The end of a cylinder, where v is 1: four texels of the top row, each a quarter of the way around.
fn end() -> Truth {
    let image = Shown { bilinear: false, wrap: [Wrap::Repeat, Wrap::Clamp], ..patches() };
    let shape = json!({ "type": "cylinder", "start_m": [0.2, -0.1, -0.7], "end_m": [0.2, -0.1, 0.3], "radius_m": 0.6 });
    let scene = pictured([0.3, -0.15, 0.3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 0.5, shape, &image);
    // Of the picture 0.35 m of 0.5 m lie beyond the axis along x, 0.2 m along y. From +x on, u goes from ½ on.
    let shown = |row: i64, columns: [i64; 4]| {
        let [a, b, c, d] = columns.map(|column| image.texel(column, row));
        0.4 * (0.7 * a + 0.3 * b) + 0.6 * (0.3 * c + 0.7 * d)
    };
    let own = image.clone();
    Truth::new(
        "texture-on-the-end-of-a-cylinder",
        &scene,
        shown(2, [2, 3, 0, 1]),
        "0.4 (0.7 a + 0.3 b) + 0.6 (0.3 c + 0.7 d) for the texels of the top row about u = ⅝, ⅞, ⅛ and ⅜",
    )
    .because(
        "On an end v is that of the end, 1, and u the angle around the axis in turns, ½ along +x. So each quarter of the end has the albedo of a \
         texel, which it shows under a sky of radiance 1.",
    )
    .confirmed("the angle at midpoints of the picture", 1e-3, move || {
        own.over(2000, |a, b| [0.5 + (0.5 * b - 0.3).atan2(0.5 * a - 0.15) / TAU, 0.99])
    })
    .or_else("the other end's row", shown(0, [2, 3, 0, 1]))
    .or_else("left and right exchanged", shown(2, [3, 2, 1, 0]))
    .or_else("mirrored", shown(2, [1, 0, 3, 2]))
    .or_else("a quarter of a turn off", shown(2, [3, 0, 1, 2]))
    .or_else("a quarter of a turn off, the other way", shown(2, [1, 2, 3, 0]))
    .or_else("half a turn off", shown(2, [0, 1, 2, 3]))
    .sees(0.01)
}

/// Metal whose grain goes with u: a small place of it, seen along its normal.
fn brushed() -> Vec<Truth> {
    const WIDTHS: [f64; 2] = [0.6, 0.15];
    const TURN_DEG: f64 = 30.0;
    let (grain, tilt_deg, from_u_deg) = ((WIDTHS, TURN_DEG), 50.0, 25.0);
    let make = |name: &str, shape: Value, place: Vec3, [along_u, along_v, out]: [Vec3; 3]| {
        let light = at([along_u, along_v, out], direction(tilt_deg, from_u_deg)).map(|v| -v);
        let scene = seen(place, out, along_v, 1e-3)
            .thing(json!({ "shape": shape, "material": brushed_metal(WIDTHS, TURN_DEG, false) }))
            .directional_light(light, 1.0)
            .spp(64);
        let value = highlight(grain, tilt_deg, from_u_deg);
        Truth::new(
            name,
            &scene,
            value,
            "D(h) G₁/4 for α_u = 0.6 along the grain, 30° from u toward v, α_v = 0.15 across it, light 50° off the normal, 25° from u toward v",
        )
        .because("Grain lies at the angle that is stated from the way u grows, toward growing v. A place so small is as good as a plate, whose highlight is the density of the facets half way.")
        .confirmed("the density of slopes, its Jacobians and Walter's G₁", 1e-12, move || {
            highlight_by_slopes(grain, tilt_deg, from_u_deg)
        })
        .or_else("widths exchanged", highlight(([WIDTHS[1], WIDTHS[0]], TURN_DEG), tilt_deg, from_u_deg))
        .or_else("not turned", highlight((WIDTHS, 0.0), tilt_deg, from_u_deg))
        .or_else("u and v exchanged", highlight(grain, tilt_deg, 90.0 - from_u_deg))
        .or_else("u or v mirrored", highlight(grain, tilt_deg, -from_u_deg))
        .allows(1e-5 * value, "the wall bends within the picture by 0.001; single precision")
        .claims(Claim::AnisotropicFacets)
        .sees(2e-3)
    };
    let frame = axes([2.0, 3.0, 6.0]);
    let [s, t, n] = frame;
    let (centre, end) = ([0.1, 0.2, -0.3], add([0.1, 0.2, -0.3], scale(1.4, n)));
    let (sin, cos) = 1.1_f64.sin_cos();
    let out = at(frame, [cos, sin, 0.0]);
    let tube = json!({ "type": "cylinder", "start_m": centre, "end_m": end, "radius_m": 0.5, "capped": false });
    vec![
        make("brushed-disk", disk(centre, [2.0, 3.0, 6.0], 0.5), add(centre, at(frame, [0.2, -0.1, 0.0])), frame),
        make(
            "brushed-cylinder",
            tube,
            add(centre, at([out, s, n], [0.5, 0.0, 0.5])),
            [add(scale(-sin, s), scale(cos, t)), n, out],
        ),
    ]
}
