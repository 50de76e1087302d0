//! pbrt-v4 scenes: their common shapes, materials, spectra, lights and cameras.
//!
//! What a directive says and no part of this module has asked for is listed with its line.

mod arguments;
mod attributes;
mod camera;
mod glass;
mod grid;
mod gzip;
mod light;
mod material;
mod measured;
mod medium;
mod mix;
mod parameters;
mod power;
mod relief;
mod shape;
mod spectrum;
mod tokens;

use std::collections::HashMap;
use std::rc::Rc;

use glam::DAffine3;
use serde_json::{Map, Value};

use super::budget::BlendSize;
use super::matrix::{inverse, looking, rotation};
use super::number::Number;
use super::{Builder, Outside};
use arguments::Arguments;
use attributes::{Attributes, Inheritance};
use gzip::MOST_INFLATED;
use power::{Faces, Lamp, MOST_MEASURED};
use tokens::{MOST_WORDS, Token, Word, tokens};

/// Deepest nesting of files that include files, and of attributes.
const MAX_DEPTH: usize = 64;
/// Most files that are included, each counted as often as it is.
const MAX_INCLUDES: usize = 1000;

pub(super) fn import(bytes: &[u8], builder: &mut Builder<'_>) -> Result<(), String> {
    let mut reading = Reading {
        builder,
        state: State::default(),
        saved: Vec::new(),
        world: DAffine3::IDENTITY,
        in_world: false,
        systems: HashMap::new(),
        materials: HashMap::new(),
        textures: HashMap::new(),
        boards: HashMap::new(),
        media: HashMap::new(),
        meshes: HashMap::new(),
        faces: HashMap::new(),
        upper_halves: HashMap::new(),
        object: None,
        inheritance: Inheritance::default(),
        measured_left: MOST_MEASURED,
        inflated_left: MOST_INFLATED,
        words_left: MOST_WORDS,
        includes: 0,
        shapes: 0,
    };
    // Where the file says nothing.
    reading.builder.film = serde_json::json!({ "width": 1280, "height": 720, "filter": { "type": "gaussian" } });
    reading.builder.integrator.insert("max_depth".to_owned(), serde_json::json!(6));
    let (words, _) = reading.words(bytes, "")?;
    reading.file(&words, "", 0)?;
    if let Some((name, ..)) = &reading.object {
        return Err(format!("the object \"{name}\" is not ended"));
    }
    reading.list_unread_attributes();
    Ok(())
}

/// What attributes save and restore.
///
/// Copies share what may be large.
#[derive(Clone, Debug)]
struct State {
    /// From the coordinates in force to the world.
    transform: DAffine3,
    /// A material of the format, or the name of one, and how opaque it is.
    material: Rc<Look>,
    /// What the shapes from here on emit.
    emission: Option<Rc<Lamp>>,
    /// Whether transforms are those of the end of the shutter only.
    at_end: bool,
    /// Parameters that directives from here on have.
    attributes: Attributes,
    reversed: bool,
    /// What fills the shapes from here on, and what stands outside of them.
    inside: Option<Rc<Value>>,
    outside: Option<Rc<Value>>,
}

/// What a surface is made of.
#[derive(Clone, Debug)]
struct Look {
    value: Value,
    opacity: f64,
    /// Further keys of its objects: a map of normals or heights.
    detail: Map<String, Value>,
    /// How many materials it is a blend of.
    size: BlendSize,
}

impl Default for State {
    fn default() -> Self {
        let value = serde_json::json!({ "type": "lambert", "reflectance": 0.5 });
        let material = Look { value, opacity: 1.0, detail: Map::new(), size: BlendSize::ONE };
        Self {
            transform: DAffine3::IDENTITY,
            material: Rc::new(material),
            emission: None,
            at_end: false,
            attributes: Attributes::default(),
            reversed: false,
            inside: None,
            outside: None,
        }
    }
}

struct Reading<'r, 'b> {
    builder: &'r mut Builder<'b>,
    state: State,
    saved: Vec<State>,
    /// pbrt's axes are left-handed: unless the camera's transform mirrors, the world is mirrored here.
    world: DAffine3,
    in_world: bool,
    systems: HashMap<String, DAffine3>,
    materials: HashMap<String, Rc<Look>>,
    textures: HashMap<String, Value>,
    /// Chequerboards as numbers, by the names of their textures.
    boards: HashMap<String, Number>,
    /// Media by their names: nothing for one that cannot be read.
    media: HashMap<String, Option<Rc<Value>>>,
    /// Mesh files that have been read: what is placed of each, the box around it, and whether it has texture coordinates; and how many faces it
    /// has.
    meshes: HashMap<String, (shape::Placeable, usize)>,
    /// The areas of those that are lamps of a stated power.
    faces: HashMap<String, Rc<Faces>>,
    /// The illuminance by the upper half of each sky whose illuminance is stated, by its file.
    upper_halves: HashMap<String, f64>,
    /// The object that is being defined, and what is outside of it.
    object: Option<(String, Outside)>,
    inheritance: Inheritance,
    /// How many more triangles of mesh files may be measured.
    measured_left: usize,
    /// How many more bytes compressed files may have.
    inflated_left: usize,
    /// How many more words the files may have that are being read, one within the other.
    words_left: usize,
    includes: usize,
    shapes: usize,
}

impl Reading<'_, '_> {
    /// The words of a file, and how many they count for.
    fn words(&mut self, bytes: &[u8], of: &str) -> Result<(Vec<Token>, usize), String> {
        let text = std::str::from_utf8(bytes).map_err(|_| format!("{of}it is not UTF-8"))?;
        let (words, count) = tokens(text, self.words_left).map_err(|why| format!("{of}{why}"))?;
        self.words_left -= count;
        Ok((words, count))
    }

    fn file(&mut self, tokens: &[Token], of: &str, depth: usize) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err(format!("{of}files are included more than {MAX_DEPTH} deep"));
        }
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            let place = format!("{of}line {}", token.line);
            let Word::Name(directive) = &token.word else {
                return Err(format!("{place}: a directive should stand here"));
            };
            at += 1;
            let mut arguments = Arguments { tokens, at: &mut at, of, place: &place };
            if matches!(directive.as_str(), "Include" | "Import") {
                let name = arguments.quoted()?;
                self.includes += 1;
                if self.includes > MAX_INCLUDES {
                    return Err(format!("{place}: more than {MAX_INCLUDES} files are included"));
                }
                let bytes = self.inflated(&name, &place)?;
                let of = format!("{name}, ");
                let (words, count) = self.words(&bytes, &of)?;
                drop(bytes);
                self.file(&words, &of, depth + 1)?;
                self.words_left += count;
            } else {
                self.directive(directive, &mut arguments)?;
            }
        }
        Ok(())
    }

    fn directive(&mut self, directive: &str, arguments: &mut Arguments<'_>) -> Result<(), String> {
        let place = arguments.place.to_owned();
        match directive {
            "Identity" => self.set(DAffine3::IDENTITY),
            "Translate" => self.apply(&DAffine3::from_translation(arguments.numbers()?.into())),
            "Scale" => self.apply(&DAffine3::from_scale(arguments.numbers()?.into())),
            "Rotate" => {
                let [angle_deg, x, y, z] = arguments.numbers()?;
                let turn = rotation([x, y, z], angle_deg);
                self.apply(&turn.ok_or_else(|| format!("{place}: its axis has no direction"))?);
            }
            "LookAt" => {
                let [a, b, c, d, e, f, g, h, i] = arguments.numbers()?;
                let placed = looking([a, b, c], [d, e, f], [g, h, i]).and_then(|placed| inverse(&placed));
                self.apply(
                    &placed.ok_or_else(|| format!("{place}: it has no viewing direction, or its up is along it"))?,
                );
            }
            "Transform" => {
                let matrix = arguments.matrix()?;
                self.set(matrix);
            }
            "ConcatTransform" => {
                let matrix = arguments.matrix()?;
                self.apply(&matrix);
            }
            "CoordinateSystem" => {
                self.systems.insert(arguments.quoted()?, self.state.transform);
            }
            "CoordSysTransform" => {
                let name = arguments.quoted()?;
                let known = self.systems.get(&name).copied();
                self.set(known.ok_or_else(|| format!("{place}: there is no coordinate system \"{name}\""))?);
            }
            "ActiveTransform" => self.active_transform(arguments.word().unwrap_or_default(), &place)?,
            "ColorSpace" => self.colour_space(&arguments.quoted()?, &place),
            "Attribute" => {
                let (target, list) = (arguments.quoted()?, arguments.parameters()?);
                self.attribute(&target, list, &place)?;
            }
            "AttributeBegin" | "TransformBegin" => {
                if self.saved.len() > 1 << 16 {
                    return Err(format!("{place}: AttributeBegin is nested more than 65536 deep"));
                }
                self.saved.push(self.state.clone());
            }
            "AttributeEnd" | "TransformEnd" => {
                let saved = self.saved.pop().ok_or_else(|| format!("{place}: this end has no matching begin"))?;
                if directive == "TransformEnd" {
                    self.state.transform = saved.transform;
                } else {
                    self.state = saved;
                }
            }
            "ReverseOrientation" => self.state.reversed = !self.state.reversed,
            "WorldBegin" => {
                (self.state.transform, self.state.at_end) = (DAffine3::IDENTITY, false);
                self.systems.insert("world".to_owned(), DAffine3::IDENTITY);
                self.in_world = true;
            }
            "MakeNamedMedium" => {
                let (name, list) = (arguments.quoted()?, self.inheriting("medium", arguments)?);
                self.named_medium(name, &list, &place)?;
            }
            "MediumInterface" => {
                let inside = arguments.quoted()?;
                // One name stands for both.
                let outside = arguments.quoted().unwrap_or_else(|_| inside.clone());
                self.medium_interface(&inside, &outside, &place);
            }
            "Camera" => self.camera(&arguments.quoted()?, &arguments.parameters()?, &place)?,
            "Film" => self.film(&arguments.quoted()?, &arguments.parameters()?, &place)?,
            "Sampler" => self.sampler(&arguments.quoted()?, &arguments.parameters()?)?,
            "Integrator" => self.integrator(&arguments.quoted()?, &arguments.parameters()?, &place)?,
            "PixelFilter" => self.filter(&arguments.quoted()?, &arguments.parameters()?, &place)?,
            "Material" => {
                let (kind, list) = (arguments.quoted()?, self.inheriting("material", arguments)?);
                self.state.material = Rc::new(self.material(&kind, &list, &place)?);
            }
            "MakeNamedMaterial" => {
                let (name, list) = (arguments.quoted()?, self.inheriting("material", arguments)?);
                let kind = list.string("type").unwrap_or("diffuse").to_owned();
                let mut look = self.material(&kind, &list, &place)?;
                let known = self.builder.material_name(&name);
                self.builder.materials.insert(known.clone(), look.value);
                look.value = Value::String(known);
                self.materials.insert(name, Rc::new(look));
            }
            "NamedMaterial" => {
                let name = arguments.quoted()?;
                let known = self.materials.get(&name);
                self.state.material =
                    known.cloned().ok_or_else(|| format!("{place}: there is no material \"{name}\""))?;
            }
            "Texture" => {
                let (name, kind, class) = (arguments.quoted()?, arguments.quoted()?, arguments.quoted()?);
                let list = self.inheriting("texture", arguments)?;
                self.texture(name, &kind, &class, &list, &place)?;
            }
            "LightSource" => {
                let (kind, list) = (arguments.quoted()?, self.inheriting("light", arguments)?);
                self.light(&kind, &list, &place)?;
            }
            "AreaLightSource" => {
                let (kind, list) = (arguments.quoted()?, self.inheriting("light", arguments)?);
                self.state.emission = self.area_light(&kind, &list, &place)?.map(Rc::new);
            }
            "Shape" => {
                let (kind, list) = (arguments.quoted()?, self.inheriting("shape", arguments)?);
                self.shape(&kind, &list, &place)?;
            }
            "ObjectBegin" => {
                let name = arguments.quoted()?;
                if self.object.is_some() {
                    return Err(format!("{place}: ObjectBegin inside another object"));
                }
                self.saved.push(self.state.clone());
                self.object = Some((name, self.builder.begin_group()));
            }
            "ObjectEnd" => {
                let (name, outside) =
                    self.object.take().ok_or_else(|| format!("{place}: ObjectEnd without ObjectBegin"))?;
                self.builder.end_group(&name, outside);
                self.state = self.saved.pop().unwrap_or_default();
            }
            "ObjectInstance" => {
                let name = arguments.quoted()?;
                let map = self.to_world();
                self.builder.place_group(&format!("{name}, {place}"), &name, &map, &place);
            }
            other => {
                self.builder.leave_out(&place, format!("{other} is ignored"));
                arguments.skip();
            }
        }
        Ok(())
    }

    fn apply(&mut self, step: &DAffine3) {
        self.set(self.state.transform * *step);
    }

    /// Sets the coordinates in force, unless they are those of the end of the shutter: things stay where they are at its start.
    fn set(&mut self, transform: DAffine3) {
        if !self.state.at_end {
            self.state.transform = transform;
        }
    }

    /// From the coordinates in force to those of the scene, or of the object that is being defined.
    fn to_world(&self) -> DAffine3 {
        if self.object.is_some() { self.state.transform } else { self.world * self.state.transform }
    }
}
