//! Camera, backdrop and light of a model that comes without them.
//!
//! Every length is a multiple of the radius of the ball around the model, and every radiance is fixed. So a model looks the same at
//! any size, and a white surface that faces the key light has a luminance of about 0.7: exposure 0 is right.

use etalon_optics::colour::rec709_luminance;
use etalon_scene::mesh::area_vectors;
use etalon_scene::{Encoding, Image, Mesh};
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

use super::Builder;

/// The vertical angle of view of the camera that is added, degrees.
const FOV_DEG: f64 = 35.0;
/// From the model to the camera that is added: three quarters from the front, and from above.
const TO_CAMERA: DVec3 = DVec3::new(0.7, 0.42, 1.0);
/// Least mean radiance that lamps of the model leave on the box around it, for the model to count as lit. The studio leaves about 1.
const LEAST_RADIANCE: f64 = 0.05;

/// Reflectance of the backdrop.
const BACKDROP: f64 = 0.4;
/// Half its width, how far it reaches to the front and to the back, its height and the radius of its bend; in radii of the model.
const HALF_WIDTH: f64 = 14.0;
const FRONT: f64 = 8.0;
const BACK: f64 = 7.0;
const HEIGHT: f64 = 9.0;
const BEND: f64 = 3.0;
/// Segments of the bend.
const SEGMENTS: u32 = 32;
/// The air below the model, in radii: no surface of the model lies within the floor.
const GAP: f64 = 1e-4;

/// A lamp, a square that faces the centre of the model.
struct Lamp {
    name: &'static str,
    /// Direction from the model: its angles to the right of the camera and above the floor, degrees.
    azimuth_deg: f64,
    elevation_deg: f64,
    /// Its distance and its side, in radii of the model.
    distance: f64,
    side: f64,
    /// Its radiance, in units of the illuminant D65 of luminance 1.
    radiance: f64,
}

const LAMPS: [Lamp; 2] = [
    Lamp { name: "key light", azimuth_deg: -50.0, elevation_deg: 48.0, distance: 4.0, side: 2.6, radiance: 5.0 },
    Lamp { name: "rim light", azimuth_deg: 145.0, elevation_deg: 52.0, distance: 3.6, side: 1.6, radiance: 6.0 },
];
/// Radiance of the even light from everywhere, in the same units.
const FILL: f64 = 0.25;

/// The middle of a box, and the radius of the ball around it.
fn ball([low, high]: [[f64; 3]; 2]) -> (DVec3, f64) {
    let (low, high) = (DVec3::from(low), DVec3::from(high));
    (0.5 * low + 0.5 * high, (0.5 * (high - low).length()).max(f64::MIN_POSITIVE))
}

/// A camera that sees all of a box, and its distance from the middle, m.
pub(super) fn camera(bounds: [[f64; 3]; 2]) -> (Value, f64) {
    let (center, radius) = ball(bounds);
    // So far that the ball around the bounds fits into the height of the picture.
    let distance = 1.02 * radius / (0.5 * FOV_DEG).to_radians().sin();
    let position = center + distance * TO_CAMERA.normalize();
    let camera = json!({
        "type": "perspective", "position_m": position.to_array(), "look_at_m": center.to_array(), "vertical_fov_deg": FOV_DEG,
    });
    (camera, distance)
}

/// The area of a mesh that is moved.
pub(super) fn area(mesh: &Mesh, map: &DAffine3) -> f64 {
    area_vectors(mesh, &map.matrix3).map(DVec3::length).sum()
}

impl Builder<'_> {
    /// Light for a model that has none, or whose lamps are too weak to see it by. Gives what there is to say about it.
    pub(super) fn add_light(&mut self, bounds: [[f64; 3]; 2], camera: &Value) -> Option<String> {
        if !self.lights.is_empty() || (self.emits && !self.is_bare) {
            return None;
        }
        let lacks = if self.emits {
            let lit = self.emitted / box_area(bounds);
            // Not a number counts as light: the reader of the scene says what is wrong.
            if lit.is_nan() || lit >= LEAST_RADIANCE {
                return None;
            }
            format!("the model's own lights are too weak (mean radiance {lit:.1e}, below {LEAST_RADIANCE})")
        } else {
            "the model has no light".to_owned()
        };
        if self.is_bare
            && let Some(studio) = Studio::around(bounds, camera)
        {
            self.add_studio(&studio);
            return Some(format!(
                "{lacks}: a grey studio is added, with a backdrop, a key light, a rim light and fill light"
            ));
        }
        self.lights.push(sky("sky", 1.0));
        Some(format!("{lacks}: an even white sky is added"))
    }

    fn add_studio(&mut self, studio: &Studio) {
        let [grey, black] =
            [("backdrop", json!({ "type": "lambert", "reflectance": BACKDROP })), ("lamp", json!({ "type": "black" }))]
                .map(|(wanted, material)| {
                    let name = self.material_name(wanted);
                    self.materials.insert(name.clone(), material);
                    name
                });
        let mesh = studio.backdrop();
        let file = self.mesh_file(&mesh);
        self.objects.push(json!({ "name": "backdrop", "shape": { "type": "mesh", "file": file }, "material": grey }));
        for lamp in &LAMPS {
            let [origin, u, v] = studio.square(lamp).map(|p| p.to_array());
            self.objects.push(json!({
                "name": lamp.name,
                "shape": { "type": "parallelogram", "origin_m": origin, "u_m": u, "v_m": v },
                "material": black,
                "emission": { "radiance": { "type": "illuminant", "name": "D65", "scale": lamp.radiance } },
            }));
        }
        self.lights.push(sky("fill light", FILL));
    }

    /// The mean luminance of what an object emits, as far as that is known: colours and images.
    pub(super) fn mean_radiance(&mut self, emission: &Value) -> f64 {
        let radiance = &emission["radiance"];
        let colour = |value: &Value| -> Option<[f64; 3]> {
            let list = value.as_array()?;
            Some(std::array::from_fn(|c| list.get(c).and_then(Value::as_f64).unwrap_or(0.0)))
        };
        let mean = match radiance["file"].as_str() {
            Some(file) => self.mean_of_image(file) * colour(&radiance["factor"]).map_or(1.0, rec709_luminance),
            None => {
                colour(&radiance["rgb"]).map_or(f64::NAN, rec709_luminance) * radiance["scale"].as_f64().unwrap_or(1.0)
            }
        };
        if emission["sides"] == "both" { 2.0 * mean } else { mean }
    }

    fn mean_of_image(&mut self, file: &str) -> f64 {
        if let Some(&mean) = self.emitting_images.get(file) {
            return mean;
        }
        let bytes = self.files.iter().find(|known| known.name == file).map(|known| &known.bytes);
        let image = bytes.and_then(|bytes| Image::decode(bytes, Encoding::Srgb).ok());
        let mean = image.map_or(f64::NAN, |(image, _)| rec709_luminance(image.mean()));
        self.emitting_images.insert(file.to_owned(), mean);
        mean
    }
}

/// The area of the sides of a box.
fn box_area([low, high]: [[f64; 3]; 2]) -> f64 {
    let [x, y, z] = std::array::from_fn(|k| high[k] - low[k]);
    2.0 * (x * y + y * z + z * x)
}

fn sky(name: &str, scale: f64) -> Value {
    json!({ "name": name, "type": "environment", "radiance": { "type": "illuminant", "name": "D65", "scale": scale } })
}

/// A studio around a model, as its camera sees it.
struct Studio {
    center: DVec3,
    radius: f64,
    /// The height of the floor.
    floor: f64,
    /// Unit vectors in the floor: to the camera, and to its right.
    front: DVec3,
    right: DVec3,
}

impl Studio {
    /// The studio around a box; `None` if the camera is inside the model, under the floor or tilted by 60° or more, or if the
    /// model is too small for the digits of its coordinates.
    fn around(bounds: [[f64; 3]; 2], camera: &Value) -> Option<Self> {
        let vector = |key: &str| {
            let list: Vec<f64> = camera[key].as_array()?.iter().filter_map(Value::as_f64).collect();
            <[f64; 3]>::try_from(list).ok().map(DVec3::from)
        };
        let (center, radius) = ball(bounds);
        let digits = radius > 1e-6 * center.abs().max_element() && (1e-50..1e50).contains(&radius);
        let upright = vector("up").is_none_or(|up| up.normalize_or_zero().y > 0.5);
        let floor = bounds[0][1] - GAP * radius;
        let eye = vector("position_m")?;
        let away = eye - center;
        let [low, high] = bounds.map(DVec3::from);
        let outside = eye.cmplt(low).any() || eye.cmpgt(high).any();
        // Closer than the wall in front of it, and above the floor.
        let placed = eye.y > floor && away.length() < 1e3 * radius && outside;
        if !(digits && upright && placed) {
            return None;
        }
        let front = DVec3::new(away.x, 0.0, away.z).try_normalize().unwrap_or(DVec3::Z);
        Some(Self { center, radius, floor, front, right: DVec3::Y.cross(front) })
    }

    /// A floor that bends up to a wall behind the model.
    fn backdrop(&self) -> Mesh {
        let Self { center, radius, floor, front, right } = *self;
        // Along the way from the front: the distance to the back, the height, and the normal's share to the front.
        let mut profile = vec![(-FRONT, 0.0, 0.0_f64)];
        for i in 0..=SEGMENTS {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(i) / f64::from(SEGMENTS);
            profile.push((BACK - BEND + BEND * angle.sin(), BEND - BEND * angle.cos(), angle.sin()));
        }
        profile.push((BACK, HEIGHT, 1.0));
        let mut mesh = Mesh::default();
        let foot = DVec3::new(center.x, floor, center.z);
        for &(back, up, to_front) in &profile {
            let normal = to_front * front + (1.0 - to_front * to_front).max(0.0).sqrt() * DVec3::Y;
            for side in [-HALF_WIDTH, HALF_WIDTH] {
                mesh.vertices.push((foot + radius * (side * right - back * front + up * DVec3::Y)).to_array());
                mesh.normals.push(normal.to_array().map(|v| v as f32));
            }
        }
        for i in 0..profile.len() as u32 - 1 {
            let [left, right, above] = [2 * i, 2 * i + 1, 2 * i + 2];
            mesh.triangles.extend([[left, right, above], [right, above + 1, above]]);
        }
        mesh
    }

    /// A corner of a lamp, and its sides; its normal points to the model.
    fn square(&self, lamp: &Lamp) -> [DVec3; 3] {
        let (azimuth, elevation) = (lamp.azimuth_deg.to_radians(), lamp.elevation_deg.to_radians());
        let level = azimuth.cos() * self.front + azimuth.sin() * self.right;
        let to_lamp = elevation.cos() * level + elevation.sin() * DVec3::Y;
        let u = DVec3::Y.cross(level);
        let v = u.cross(to_lamp);
        let side = lamp.side * self.radius;
        let middle = self.center + lamp.distance * self.radius * to_lamp;
        [middle - 0.5 * side * (u + v), side * u, side * v]
    }
}
