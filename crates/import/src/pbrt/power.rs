//! Factors that give lights of pbrt their stated power or illuminance. The spectra themselves have a luminance of 1.

use std::f64::consts::PI;
use std::rc::Rc;

use etalon_optics::colour::rec709_luminance;
use etalon_scene::mesh::{area_vectors, read_ply};
use etalon_scene::{Encoding, Image, Mesh};
use glam::{DMat3, DVec3};
use serde_json::{Value, json};

use super::Reading;
use super::parameters::Parameters;

/// Most triangles of mesh files that are measured, each as often as a lamp has it.
pub(super) const MOST_MEASURED: usize = 1 << 31;

/// What shapes emit.
#[derive(Clone, Debug)]
pub(super) struct Lamp {
    pub emission: Value,
    /// Radiance × area of each pbrt shape, if its power is stated.
    pub power: Option<f64>,
}

/// The areas of pbrt's shapes in one of ours: how many, all of them together, and whether they are alike.
#[derive(Clone, Copy, Debug)]
struct Areas {
    count: usize,
    total: f64,
    alike: bool,
}

impl Areas {
    fn of(areas: &[f64]) -> Self {
        let total: f64 = areas.iter().sum();
        let mean = total / areas.len() as f64;
        let alike = areas.iter().all(|area| (area - mean).abs() <= 1e-6 * mean);
        Self { count: areas.len(), total, alike }
    }
}

/// The faces of a mesh.
#[derive(Debug)]
pub(super) struct Faces {
    /// Of each triangle its normal times its area.
    triangles: Vec<DVec3>,
    /// How many faces there are: each is a lamp of pbrt, a quadrilateral too.
    count: usize,
}

impl Faces {
    fn of(mesh: &Mesh, count: usize) -> Self {
        Self { triangles: area_vectors(mesh, &DMat3::IDENTITY).collect(), count }
    }

    /// Their areas after a map.
    fn areas(&self, map: &DMat3) -> Areas {
        let [x, y, z] = [map.x_axis, map.y_axis, map.z_axis];
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        // Two triangles of a quadrilateral stand next to each other.
        let each = if self.triangles.len() == 2 * self.count { 2 } else { 1 };
        let faces = self.triangles.chunks(each);
        let areas: Vec<f64> = faces.map(|face| face.iter().map(|area| (cofactors * *area).length()).sum()).collect();
        let areas = Areas::of(&areas);
        // Triangles and quadrilaterals in one file are not told apart: their number and their sum are known.
        Areas { count: self.count, alike: areas.alike && areas.count == self.count, ..areas }
    }
}

/// A number that counts only above 0.
fn positive(list: &Parameters, name: &str) -> Result<Option<f64>, String> {
    Ok(list.number(name)?.filter(|number| *number > 0.0))
}

/// The factor on an intensity so that the light has its stated power. `solid_angle`, sr: where it shines; a soft edge counts half.
pub(super) fn of_power(list: &Parameters, solid_angle: f64) -> Result<f64, String> {
    Ok(positive(list, "power")?.map_or(1.0, |power| power / solid_angle))
}

/// The solid angle of a spot, whose edge counts half as pbrt takes it.
pub(super) fn cone(outer_deg: f64, inner_deg: f64) -> f64 {
    let (outer, inner) = (outer_deg.to_radians().cos(), inner_deg.to_radians().cos());
    2.0 * PI * ((1.0 - inner) + 0.5 * (inner - outer))
}

/// The factor on a light so that it gives its stated illuminance; `of_one` is what radiance or irradiance 1 gives.
pub(super) fn of_illuminance(list: &Parameters, of_one: f64) -> Result<f64, String> {
    Ok(positive(list, "illuminance")?.map_or(1.0, |illuminance| illuminance / of_one))
}

/// Illuminance by the upper half of an equal-area sky as pbrt computes it. pbrt counts half of each texel's solid angle, so this is half of
/// the true value.
fn of_upper_half(image: &Image) -> f64 {
    let (width, height) = (f64::from(image.width), f64::from(image.height));
    let mut sum = 0.0;
    for (i, texel) in image.linear_texels().enumerate() {
        let (column, row) = (i as f64 % width, (i as f64 / width).floor());
        // From −1 to 1; the upper half is the inner square that stands on a corner, where 1 − z is the square of the distance.
        let [u, v] = [(column + 0.5) / width, (row + 0.5) / height].map(|x| (2.0 * x - 1.0).abs());
        let cos = 1.0 - (u + v) * (u + v);
        if u + v < 1.0 {
            sum += rec709_luminance(texel) * cos;
        }
    }
    2.0 * PI * sum / (width * height)
}

/// Multiplies light of the format by a factor.
fn brighten(light: &mut Value, factor: f64) {
    if light["type"] == "image" {
        let before = light["factor"].as_array().cloned().unwrap_or_default();
        light["factor"] = before.iter().map(|v| v.as_f64().unwrap_or(1.0) * factor).collect();
    } else {
        light["scale"] = json!(light["scale"].as_f64().unwrap_or(1.0) * factor);
    }
}

impl Reading<'_, '_> {
    /// The factor on the image of a sky, in the scene's file.
    pub(super) fn illuminance_of_sky(&mut self, list: &Parameters, file: &str, place: &str) -> Result<f64, String> {
        let Some(stated) = positive(list, "illuminance")? else { return Ok(1.0) };
        let of_one = match self.upper_halves.get(file) {
            Some(known) => *known,
            None => {
                let bytes = self.builder.files.iter().find(|known| known.name == file).map(|known| &known.bytes);
                let image = bytes.and_then(|bytes| Image::decode(bytes, Encoding::Auto).ok());
                let of_one = image.map_or(0.0, |(image, _)| of_upper_half(&image));
                self.upper_halves.insert(file.to_owned(), of_one);
                of_one
            }
        };
        if of_one > 0.0 {
            return Ok(stated / of_one);
        }
        self.builder.leave_out(place, "the upper half of its image is black: its illuminance is left out");
        Ok(1.0)
    }

    /// What is emitted by an area light of a power; `luminance` is the mean of its image, or 1.
    pub(super) fn lamp(emission: Value, list: &Parameters, luminance: f64) -> Result<Lamp, String> {
        let sides = if emission["sides"] == "both" { 2.0 } else { 1.0 };
        let power = positive(list, "power")?.map(|power| power / (sides * PI * luminance));
        Ok(Lamp { emission, power: power.filter(|power| power.is_finite()) })
    }

    /// What the shape in hand emits: each of pbrt's shapes has the stated power, so each triangle and each patch of a mesh.
    pub(super) fn emission(
        &mut self,
        shape: &str,
        list: &Parameters,
        mesh: Option<&Mesh>,
        place: &str,
    ) -> Result<Option<Value>, String> {
        let Some(lamp) = self.state.emission.clone() else { return Ok(None) };
        let mut emission = lamp.emission.clone();
        let Some(power) = lamp.power else { return Ok(Some(emission)) };
        let Some(Areas { count, total, alike }) = self.areas(shape, list, mesh, place)? else {
            return Ok(Some(emission));
        };
        if total <= 0.0 {
            return Ok(Some(emission));
        }
        if !alike {
            let what = "in pbrt each triangle or patch has the whole \"power\"; here all get the mean radiance";
            self.builder.approximate(place, what);
        }
        brighten(&mut emission["radiance"], power * count as f64 / total);
        Ok(Some(emission))
    }

    /// The areas of pbrt's shapes. Those of round ones are taken before their transform, as pbrt does.
    fn areas(
        &mut self,
        shape: &str,
        list: &Parameters,
        mesh: Option<&Mesh>,
        place: &str,
    ) -> Result<Option<Areas>, String> {
        let round = |area: f64| Some(Areas::of(&[area]));
        let map = self.to_world();
        let radius = list.number_or("radius", 1.0)?;
        Ok(match (shape, mesh) {
            ("sphere", _) => round(4.0 * PI * radius * radius),
            ("disk", _) => round(PI * radius * radius),
            ("cylinder", _) => {
                round(2.0 * PI * radius * (list.number_or("zmax", 1.0)? - list.number_or("zmin", -1.0)?).abs())
            }
            ("plymesh", _) => {
                let Some(file) = list.string("filename") else { return Ok(None) };
                Some(self.faces(file, place)?.areas(&map.matrix3))
            }
            (_, Some(mesh)) => {
                // A patch is two triangles.
                let each = if shape == "bilinearmesh" { 2 } else { 1 };
                Some(Faces::of(mesh, mesh.triangles.len() / each).areas(&map.matrix3))
            }
            _ => None,
        })
    }

    /// The faces of a mesh file that has been placed. They are measured in its copy in the scene, once.
    fn faces(&mut self, file: &str, place: &str) -> Result<Rc<Faces>, String> {
        let fail = |why: &str| format!("{place}: \"{file}\": {why}");
        let faces = match self.faces.get(file) {
            Some(known) => Rc::clone(known),
            None => {
                let known = self.meshes.get(file);
                let ((shape, ..), count) = known.ok_or_else(|| fail("it is not placed"))?;
                let copy = self.builder.files.iter().find(|known| shape["file"] == known.name.as_str());
                let bytes = copy.map_or(&[][..], |copy| &copy.bytes);
                let part = read_ply(bytes).map_err(|error| fail(&error.to_string()))?;
                let faces = Rc::new(Faces::of(&part.mesh, *count));
                self.faces.insert(file.to_owned(), Rc::clone(&faces));
                faces
            }
        };
        let left = self.measured_left.checked_sub(faces.triangles.len());
        self.measured_left =
            left.ok_or_else(|| fail(&format!("more than {MOST_MEASURED} triangles have a \"power\"")))?;
        Ok(faces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_white_sky_lights_its_floor_by_half_of_pi_there() {
        // 64 × 64 texels of white, as a PNG of a single channel.
        let white = image::GrayImage::from_pixel(64, 64, image::Luma([255]));
        let mut png = std::io::Cursor::new(Vec::new());
        white.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let (image, _) = Image::decode(&png.into_inner(), Encoding::Auto).unwrap();
        assert!((2.0 * of_upper_half(&image) / PI - 1.0).abs() < 2e-3, "{}", of_upper_half(&image));
    }

    #[test]
    fn areas_of_a_file_are_those_after_any_map() {
        let mesh = Mesh {
            vertices: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 1.0, 0.25], [1.0, 2.0, 3.0]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            ..Mesh::default()
        };
        let map = DMat3::from_cols_array(&[1.0, 2.0, 0.0, -1.0, 0.5, 0.0, 0.25, 3.0, -2.0]);
        let expected: f64 = area_vectors(&mesh, &map).map(DVec3::length).sum();
        for (count, alike) in [(2, false), (1, true)] {
            let areas = Faces::of(&mesh, count).areas(&map);
            assert_eq!((areas.count, areas.alike), (count, alike));
            assert!((areas.total / expected - 1.0).abs() < 1e-12, "{} {expected}", areas.total);
        }
    }

    #[test]
    fn the_edge_of_a_spot_counts_half() {
        assert!((cone(180.0, 180.0) - 4.0 * PI).abs() < 1e-12);
        assert!((cone(90.0, 0.0) - PI).abs() < 1e-12);
    }
}
