//! The assignment's JSON form of scenes.

use std::f64::consts::PI;
use std::ops::Bound;

use etalon_scene::json::{
    self, Code, Decode, Kind, List, Node, NonNegative, Positive, Problem, Reader, Required, SceneErrors, SchemaBuilder,
    SchemaValue, Spanned,
};
use etalon_scene::{number, record, variants};
use etalon_whitted::{Camera, Light, Material, Object, Scene, Shape, Vec3, vec3};

/// Reads a scene in the assignment's JSON form, with its warnings.
///
/// # Errors
/// Every error of the text.
pub(super) fn parse(text: &str, file_name: &str) -> Result<(Scene, Vec<Problem>), SceneErrors> {
    json::read(text, file_name, |file: File, reader| build(file, reader))
}

record! {
    /// A scene.
    struct File {
        /// What there is without objects and lamps.
        surroundings as "Scene": Required<Surroundings>,
        /// The camera.
        camera as "Camera": Required<CameraEntry>,
        /// Materials; objects name them by their place in this list, from 0.
        materials as "Materials": Required<List<MaterialEntry>>,
        /// Point lights.
        lights as "Lights": Required<List<LightEntry>>,
        /// Objects.
        objects as "Objects": Required<List<ObjectEntry>>,
    }
}

record! {
    /// What there is without objects and lamps.
    struct Surroundings {
        /// Colour of a camera ray that meets nothing.
        background as "Background": Required<Color>,
        /// Colour of the ambient light.
        ambient as "Ambient": Required<Color>,
    }
}

number! {
    /// An angle between 0 and π, rad.
    struct ViewAngle in (Bound::Excluded(0.0), Bound::Excluded(PI));
}

record! {
    /// A camera that looks along −z.
    struct CameraEntry {
        /// Perspective or, if false, orthographic.
        is_perspective as "IsPerspective": Required<bool>,
        /// Its place.
        position as "Position": Required<[f64; 3]>,
        /// Angle of view, rad.
        field_of_view as "FieldOfView": Required<ViewAngle>,
        /// Distance of the plane in focus from the origin.
        focal_length as "FocalLength": Required<Positive>,
        /// Half the side of the square lens.
        lens_radius as "LensRadius": Required<NonNegative>,
    }
}

record! {
    /// A material.
    struct MaterialEntry {
        /// Multiplies the ambient light.
        ambient as "Ambient": Required<Color>,
        /// Weight of the cosine term.
        diffuse as "Diffuse": Required<Color>,
        /// Weight of the highlight.
        specular as "Specular": Required<Color>,
        /// Weight of the mirrored highlights.
        mirror as "Mirror": Required<Color>,
        /// Weight of the refracted highlights.
        refraction as "Refraction": Required<Color>,
        /// Index of refraction.
        refraction_index as "RefractionIndex": Required<Positive>,
        /// Exponent of the highlight.
        shininess as "Shininess": Required<NonNegative>,
    }
}

record! {
    /// A point light.
    struct LightEntry {
        /// Its place.
        position as "Position": Required<[f64; 3]>,
        /// Its colour at distance 1.
        color as "Color": Required<Color>,
    }
}

record! {
    /// A sphere.
    struct SphereEntry {
        /// Place of its material in the list of materials, from 0.
        material as "Material": Required<Spanned<u32>>,
        /// Its centre.
        position as "Position": Required<[f64; 3]>,
        /// Its radius.
        radius as "Radius": Required<Positive>,
    }
}

record! {
    /// A parallelogram.
    struct ParallelogramEntry {
        /// Place of its material in the list of materials, from 0.
        material as "Material": Required<Spanned<u32>>,
        /// A corner.
        origin as "Origin": Required<[f64; 3]>,
        /// One side.
        u as "u": Required<[f64; 3]>,
        /// The other side.
        v as "v": Required<[f64; 3]>,
    }
}

variants! {
    /// An object.
    enum ObjectEntry by "Type" {
        "Sphere" => Sphere(SphereEntry),
        "Parallelogram" => Parallelogram(ParallelogramEntry),
    }
}

/// Red, green and blue, or one number for all three; none below 0.
#[derive(Clone, Copy, Debug)]
struct Color(Vec3);

impl Decode for Color {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        let (grey, channels) = (NonNegative::schema(schema), <[NonNegative; 3]>::schema(schema));
        json::by_json_type(vec![("number", grey), ("array", channels)])
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::Number(_) => NonNegative::decode(node, reader).map(|grey| Self(vec3(grey.0, grey.0, grey.0))),
            _ => <[NonNegative; 3]>::decode(node, reader).map(|[r, g, b]| Self(vec3(r.0, g.0, b.0))),
        }
    }
}

fn build(file: File, reader: &mut Reader<'_>) -> Option<Scene> {
    let materials = file.materials.map(|list| list.0.into_iter().map(|m| m.and_then(material)).collect::<Vec<_>>());
    let lights = file.lights.and_then(List::complete);
    // Every object is looked at, also after a wrong one.
    let objects = file.objects.map(|list| {
        let objects = list.0.into_iter().map(|entry| object(entry?, materials.as_deref(), reader));
        objects.collect::<Vec<_>>()
    });
    let (surroundings, entry) = (file.surroundings?, file.camera?);
    let light = |l: LightEntry| Some(Light { position: Vec3(l.position?), color: l.color?.0 });
    Some(Scene {
        background: surroundings.background?.0,
        ambient: surroundings.ambient?.0,
        camera: Camera {
            is_perspective: entry.is_perspective?,
            position: Vec3(entry.position?),
            field_of_view_rad: entry.field_of_view?.0,
            focal_length: entry.focal_length?.0,
            lens_radius: entry.lens_radius?.0,
        },
        lights: lights?.into_iter().map(light).collect::<Option<_>>()?,
        objects: objects?.into_iter().collect::<Option<_>>()?,
    })
}

fn material(entry: MaterialEntry) -> Option<Material> {
    Some(Material {
        ambient: entry.ambient?.0,
        diffuse: entry.diffuse?.0,
        specular: entry.specular?.0,
        mirror: entry.mirror?.0,
        refraction: entry.refraction?.0,
        refraction_index: entry.refraction_index?.0,
        shininess: entry.shininess?.0,
    })
}

fn object(entry: ObjectEntry, materials: Option<&[Option<Material>]>, reader: &mut Reader<'_>) -> Option<Object> {
    let (index, shape) = match entry {
        ObjectEntry::Sphere(sphere) => (sphere.material, ball(sphere)),
        ObjectEntry::Parallelogram(parallelogram) => (parallelogram.material, flat(parallelogram, reader)),
    };
    let (index, materials) = (index?, materials?);
    let Some(material) = materials.get(index.value as usize) else {
        let message = format!("there is no material {}", index.value);
        let hint = match materials.len() {
            0 => "\"Materials\" is empty".to_owned(),
            1 => "there is one material, number 0".to_owned(),
            n => format!("there are {n} materials, numbers 0 to {}", n - 1),
        };
        reader.error_hint(Code::IndexOutOfRange, index.at, message, hint);
        return None;
    };
    Some(Object { shape: shape?, material: (*material)? })
}

fn ball(entry: SphereEntry) -> Option<Shape> {
    Some(Shape::Sphere { center: Vec3(entry.position?), radius: entry.radius?.0 })
}

fn flat(entry: ParallelogramEntry, reader: &mut Reader<'_>) -> Option<Shape> {
    let (origin, u, v) = (Vec3(entry.origin?), Vec3(entry.u?), Vec3(entry.v?));
    if u.cross(v) == Vec3::default() {
        let message = "the sides \"u\" and \"v\" are parallel, or one of them is 0";
        reader.error(Code::DegenerateShape, entry.at.head(), message);
        return None;
    }
    Some(Shape::Parallelogram { origin, u, v })
}

#[cfg(test)]
mod tests {
    use super::*;

    const PUBLISHED: &str = include_str!("../../../../../reference/assignment/scene.json");

    /// The lines of all problems of the published scene after a replacement.
    fn problems(replace: &str, by: &str) -> Vec<String> {
        assert!(PUBLISHED.contains(replace), "{replace}");
        let text = PUBLISHED.replacen(replace, by, 1);
        parse(&text, "scene.json").unwrap_err().problems.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn the_published_scene_is_the_seven_spheres() {
        let (scene, warnings) = parse(PUBLISHED, "scene.json").unwrap();
        assert_eq!(scene, Scene::seven_spheres());
        assert!(warnings.is_empty());
    }

    #[test]
    fn one_number_stands_for_three_equal_channels() {
        let text = PUBLISHED.replace("[0.5, 0.5, 0.5]", "0.5").replace("[0.0, 0.0, 0.0]", "0");
        assert_eq!(parse(&text, "scene.json").unwrap().0, Scene::seven_spheres());
    }

    #[test]
    fn a_parallelogram_is_read() {
        let entry = r#"{ "Type": "Parallelogram", "Material": 0, "Origin": [1, 2, 3], "u": [1, 0, 0], "v": [0, 0, 2] },
            { "Type": "Sphere", "Material": 0, "Position": [10, 0, 1], "Radius": 1 }"#;
        let text =
            PUBLISHED.replacen(r#"{ "Type": "Sphere", "Material": 0, "Position": [10, 0, 1], "Radius": 1 }"#, entry, 1);
        let (scene, _) = parse(&text, "scene.json").unwrap();
        let expected =
            Shape::Parallelogram { origin: vec3(1.0, 2.0, 3.0), u: vec3(1.0, 0.0, 0.0), v: vec3(0.0, 0.0, 2.0) };
        assert_eq!(scene.objects[0].shape, expected);
        assert_eq!(scene.objects.len(), 8);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        for (replace, by, place, words) in [
            (r#""FocalLength": 5.0,"#, "", "6:15: error[missing-key]: $.Camera:", "FocalLength"),
            (r#""Radius": 1 }"#, r#""Radius": 0 }"#, "34:78: error[out-of-range]: $.Objects[0].Radius:", "above 0"),
            (
                r#""Material": 0, "Position": [10"#,
                r#""Material": 1, "Position": [10"#,
                "34:41: error[index-out-of-range]: $.Objects[0].Material:",
                "there is no material 1 (there is one material, number 0)",
            ),
            (
                r#""Material": 0, "Position": [10"#,
                r#""Material": "green", "Position": [10"#,
                "34:41: error[wrong-type]: $.Objects[0].Material:",
                "whole number",
            ),
            ("[16, 16, 16]", "[16, 16]", "25:43: error[wrong-length]: $.Lights[0].Color:", "3"),
            (
                r#""Shininess""#,
                r#""Shinyness""#,
                "21:13: error[unknown-key]: $.Materials[0].Shinyness:",
                r#"did you mean "Shininess"?"#,
            ),
            (
                r#""Type": "Sphere""#,
                r#""Type": "Spere""#,
                "34:19: error[unknown-word]: $.Objects[0].Type:",
                r#"did you mean "Sphere"?"#,
            ),
            (
                r#""FieldOfView": 0.7854"#,
                r#""FieldOfView": 45"#,
                "9:24: error[out-of-range]: $.Camera.FieldOfView:",
                "45",
            ),
        ] {
            let found = problems(replace, by);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(found[0].starts_with(place) && found[0].contains(words), "{found:?}, expected {place} … {words}");
        }
    }

    #[test]
    fn a_flat_parallelogram_is_refused() {
        let flat = r#"{ "Type": "Parallelogram", "Material": 0, "Origin": [0, 0, 0], "u": [1, 1, 0], "v": [2, 2, 0] }"#;
        let found = problems(r#"{ "Type": "Sphere", "Material": 0, "Position": [10, 0, 1], "Radius": 1 }"#, flat);
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("error[degenerate-shape]: $.Objects[0]"), "{found:?}");
    }

    #[test]
    fn every_error_of_a_file_is_found_in_one_run() {
        let text = PUBLISHED
            .replace(r#""Ambient": [0.2, 0.2, 0.2]"#, r#""Ambient": [0.2, -0.2, 0.2]"#)
            .replace(r#""IsPerspective": true"#, r#""IsPerspective": 1"#)
            .replace(r#""Material": 0, "Position": [-8"#, r#""Material": 7, "Position": [-8"#)
            .replace(r#""Position": [4, 8, 0], "#, "");
        let errors = parse(&text, "scene.json").unwrap_err();
        let codes: Vec<_> = errors.errors().map(|problem| problem.code).collect();
        assert_eq!(codes, [Code::OutOfRange, Code::WrongType, Code::MissingKey, Code::IndexOutOfRange]);
    }

    #[test]
    fn what_is_not_a_scene_at_all_is_refused_and_nothing_panics() {
        for text in ["", "{", "[]", "null", "7", "{}", "\u{0}", r#"{"Scene": {"Scene": {}}}"#, r#"{"Objects": {}}"#] {
            assert!(parse(text, "scene.json").unwrap_err().errors().count() > 0, "{text}");
        }
    }
}
