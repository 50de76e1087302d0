//! The whole file.

use serde_json::json;

use super::camera::{CameraForm, FilmForm, camera, film, shutter_of};
use super::detail::{BumpMapForm, NormalMapForm, OpacityImageForm, bump_map, normal_map, opacity_image};
use super::geometry::{ShapeForm, Step, check_extent, check_similarity, shape, transform};
use super::group::{GroupForm, InstanceForm, groups};
use super::integrator::{IntegratorForm, integrator, warn_of_invisible_wavelengths, wavelength_range_nm};
use super::light::{LightForm, light};
use super::material::{Before, MaterialForm, Share, material};
use super::medium::{MediumForm, medium};
use super::meter::{MeterForm, meters};
use super::names::Names;
use super::photometric::stated;
use super::spectra::Spectra;
use super::spectrum::SpectrumForm;
use super::surface::{check_colours, check_coordinates, check_tangents};
use crate::files::Files;
use crate::json::{
    Code, Decode, Kind, List, Named, Node, NonNegative, Optional, Place, Reader, Required, Rule, SchemaBuilder,
    SchemaValue, Span, Spanned, by_json_type,
};
use crate::model::{Emission, EmissionSides, Material, MaterialKind, Object, Parameter, Scene};

/// The version of the format that this program reads.
const VERSION: f64 = 1.0;

/// The version that a file says.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Version;

impl Decode for Version {
    fn schema(_: &mut SchemaBuilder) -> SchemaValue {
        json!({ "const": 1 })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let version = f64::decode(node, reader)?;
        if version != VERSION {
            let message = format!("version {version} of the format is not known");
            reader.error_hint(Code::Version, reader.span(node), message, format!("this program reads {VERSION}"));
        }
        Some(Self)
    }
}

crate::record! {
    /// A scene of Etalon, version 1 of the format. Lengths are metres, wavelengths nanometres, angles degrees; world space
    /// is right-handed.
    pub(crate) struct SceneForm + comment {
        /// Version of the format: 1.
        #[allow(dead_code, reason = "checked when it is decoded")]
        etalon: Required<Version>,
        /// The schema that this file follows, for editors. It changes nothing.
        schema as "$schema": Optional<Spanned<String>>,
        /// The camera.
        camera: Required<CameraForm>,
        /// Size and reconstruction of the picture.
        film: Required<FilmForm>,
        /// Spectra by name.
        spectra: Required<Named<Box<SpectrumForm>>> = "{}",
        /// Materials by name.
        materials: Required<Named<Box<MaterialForm>>> = "{}",
        /// Things with a surface.
        objects: Required<Spanned<List<Box<ObjectForm>>>> = "[]",
        /// Groups of objects by name, to be placed by "instances".
        groups: Required<Named<Box<GroupForm>>> = "{}",
        /// Groups placed in the scene.
        instances: Required<List<Box<InstanceForm>>> = "[]",
        /// Lights without a surface.
        lights: Required<List<Box<LightForm>>> = "[]",
        /// What fills the space outside of all bodies: fog, smoke, air. Left out, it is clear.
        medium: Optional<Box<MediumForm>>,
        /// What `etalon measure` measures.
        meters: Required<Spanned<List<Box<MeterForm>>>> = "[]",
        /// How to integrate.
        integrator: Required<IntegratorForm> = "{}",
    }
}

crate::record! {
    /// A thing with a surface.
    pub(crate) struct ObjectForm + comment {
        /// Its name, for messages; "objects[i]" if left out.
        name: Optional<String>,
        /// Its shape, in its own coordinates.
        shape: Required<ShapeForm>,
        /// What its surface does to light: the name of one of "materials", or a material of its own.
        material: Required<MaterialUse>,
        /// What its surface emits.
        emission: Optional<EmissionForm>,
        /// Share of light that meets the surface at all, from 0 to 1; the rest passes as if it were not there.
        opacity: Required<Share> = "1",
        /// An image of that share over the texture coordinates; `opacity` is a factor on it.
        opacity_image: Optional<OpacityImageForm>,
        /// An image of normals to scatter around.
        normal_map: Optional<NormalMapForm>,
        /// An image of heights, instead of one of normals.
        bump_map: Optional<BumpMapForm>,
        /// From its own coordinates to the world: steps, the first of which is applied first.
        transform: Required<Spanned<List<Box<Step>>>> = "[]",
    } with [Rule::NotBoth("normal_map", "bump_map")]
}

crate::record! {
    /// Diffuse emission: the same radiance in every direction.
    pub(crate) struct EmissionForm + comment {
        /// Radiance, W·m⁻²·sr⁻¹·nm⁻¹, perhaps an image: of 1, white (1, 1, 1) has the luminance of the constant spectrum 1. Either this or
        /// `luminance_cd_per_m2`.
        radiance: Optional<Box<SpectrumForm>>,
        /// Luminance, cd·m⁻².
        luminance_cd_per_m2: Optional<Spanned<NonNegative>>,
        /// The spectrum of a luminance, to any scale; the same at every wavelength if left out.
        spectrum: Optional<Box<SpectrumForm>>,
        /// Which sides emit.
        sides: Required<EmissionSides> = r#""front""#,
    } with [Rule::OneOf(&["radiance", "luminance_cd_per_m2"]), Rule::NotBoth("radiance", "spectrum")]
}

crate::keywords!(EmissionSides {
    /// The side that the surface normal points into.
    "front" => Self::Front,
    /// The side that the surface normal points away from.
    "back" => Self::Back,
    /// Both sides.
    "both" => Self::Both,
});

/// The material of an object.
#[derive(Clone, Debug)]
pub(crate) enum MaterialUse {
    /// By name.
    Named(Spanned<String>),
    /// Its own.
    Own(Box<MaterialForm>),
}

impl MaterialUse {
    /// Its place.
    fn at(&self) -> Span {
        match self {
            Self::Named(name) => name.at,
            Self::Own(own) => own.at().head(),
        }
    }
}

impl Decode for MaterialUse {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        by_json_type(vec![("string", String::schema(schema)), ("object", MaterialForm::schema(schema))])
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::String(_) => Spanned::decode(node, reader).map(Self::Named),
            Kind::Object => MaterialForm::decode(node, reader).map(|own| Self::Own(Box::new(own))),
            other => {
                let message = format!("expected a material (a name or an object), found {}", other.name());
                reader.error(Code::WrongType, reader.span(node), message);
                None
            }
        }
    }
}

/// The scene of a file, or every error in it.
pub(crate) fn scene(
    form: &SceneForm,
    size: Option<[u32; 2]>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Scene> {
    let range_nm = form.integrator.as_ref().and_then(|form| wavelength_range_nm(form, reader));
    let film = form.film.as_ref().and_then(|form| film(form, size, range_nm, reader));
    let camera = form.camera.as_ref().and_then(|form| camera(form, film.as_ref(), range_nm, files, reader));
    let integrator = form.integrator.as_ref().and_then(|form| integrator(form, range_nm));
    let mut spectra = Spectra::new(form.spectra.as_ref(), range_nm, reader);

    let named = form.materials.as_ref().map_or(&[][..], |named| &named.0);
    let names = Names::new("material", "materials", Place::Material, named);
    let mut materials = All::default();
    let mut made = Vec::with_capacity(named.len());
    for entry in named {
        let before = Before { names: &names, made: &made };
        let one = entry.value.as_ref().and_then(|form| material(form, &before, &mut spectra, files, reader));
        made.push(one.clone());
        materials.push(one.map(|one| one.named(entry.name.clone())));
    }
    let named = Before { names: &names, made: &made };
    let mut objects = All::default();
    for (i, form) in form.objects.iter().flat_map(|objects| objects.value.0.iter().enumerate()) {
        let place = format!("objects[{i}]");
        objects.push(
            form.as_ref().and_then(|form| object(form, place, &named, &mut materials, &mut spectra, files, reader)),
        );
    }
    let grouped = groups(
        form.groups.as_ref().map_or(&[][..], |named| &named.0),
        form.instances.as_ref(),
        shutter_of(form.camera.as_ref()),
        |form, place, reader| object(form, place, &named, &mut materials, &mut spectra, files, reader),
        reader,
    );
    let mut lights = All::default();
    for (i, form) in form.lights.iter().flat_map(|lights| lights.0.iter().enumerate()) {
        lights.push(form.as_ref().and_then(|form| light(form, i, &mut spectra, files, reader)));
    }

    let medium = match &form.medium {
        Optional::Absent => Some(None),
        Optional::Given(form) => medium(form, &mut spectra, files, reader).map(Some),
        Optional::Invalid => None,
    };

    let meters = form.meters.as_ref().and_then(|forms| meters(forms, reader));

    let fluoresces =
        |material: &Material| material.kind.parameters().iter().any(|p| matches!(p, Parameter::Fluorescence(_)));
    if let Some(form) = &form.integrator
        && !materials.right.iter().any(fluoresces)
    {
        warn_of_invisible_wavelengths(form, reader);
    }
    files.warn_of_what_is_left_out(reader);

    // Whatever is wrong has been reported by now; a wrong list has not become an empty one.
    let _ = (form.spectra.as_ref()?, form.materials.as_ref()?, form.objects.as_ref()?, form.lights.as_ref()?);
    let _ = form.groups.as_ref()?;
    let (groups, instances) = grouped?;
    let scene = Scene {
        camera: camera?,
        film: film?,
        materials: materials.complete()?,
        objects: objects.complete()?,
        groups,
        instances,
        lights: lights.complete()?,
        medium: medium?,
        meters: meters?,
        receivers: Vec::new(),
        integrator: integrator?,
    };
    warn(&scene, form, reader);
    if let Optional::Given(schema) = &form.schema
        && files.lacks_beside_the_scene(&schema.value)
    {
        let message = format!("there is no file \"{}\": an editor cannot complete or check this scene", schema.value);
        let hint =
            format!("write it with `etalon schema > {}` in the folder of the scene, or remove the key", schema.value);
        reader.warning(Code::NoSchema, schema.at, message, Some(hint));
    }
    Some(scene)
}

/// Collects things all of which must be right.
#[derive(Debug)]
struct All<T> {
    right: Vec<T>,
    wrong: bool,
}

impl<T> Default for All<T> {
    fn default() -> Self {
        Self { right: Vec::new(), wrong: false }
    }
}

impl<T> All<T> {
    /// Adds one, and returns its index; `None` is wrong, and takes no memory: a hostile file may hold millions.
    fn push(&mut self, thing: Option<T>) -> usize {
        match thing {
            Some(thing) => self.right.push(thing),
            None => self.wrong = true,
        }
        self.right.len().saturating_sub(1)
    }

    fn complete(self) -> Option<Vec<T>> {
        (!self.wrong).then_some(self.right)
    }
}

fn object<'f>(
    form: &'f ObjectForm,
    place: String,
    named: &Before<'_>,
    materials: &mut All<Material>,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Object> {
    let name = form.name.clone().checked().map(|name| name.unwrap_or_else(|| place.clone()));
    let shape = form.shape.as_ref().and_then(|form| shape(form, name.as_ref().unwrap_or(&place), files, reader));
    let transform = form.transform.as_ref().and_then(|steps| {
        let transform = transform(&steps.value, steps.at.head(), reader)?;
        if let Some(shape) = &form.shape {
            check_similarity(shape, &transform, steps.at.head(), reader);
        }
        Some(transform)
    });
    if let (Some(shape), Some(transform)) = (&shape, &transform) {
        check_extent(shape, transform, form.at.head(), reader);
    }
    let material = form.material.as_ref().and_then(|material_use| match material_use {
        MaterialUse::Named(name) => named.names.find(name, reader),
        MaterialUse::Own(own) => {
            let made = material(own, named, spectra, files, reader)?;
            Some(materials.push(Some(made.named(format!("{place}.material")))))
        }
    });
    if let (Some(material), Some(shape)) = (material, &shape)
        && let Some(at) = form.material.as_ref().map(MaterialUse::at)
    {
        // Indices count the right ones only as long as all are.
        let material = materials.right.get(material).filter(|_| !materials.wrong);
        let material = material.map(|material| &material.kind);
        check_coordinates(material.and_then(|kind| kind.image()), shape, at, reader);
        material.into_iter().for_each(|kind| check_colours(kind, shape, at, reader));
        if material.is_some_and(MaterialKind::has_grain) {
            check_tangents(shape, at, reader);
        }
    }
    let opacity_image = match &form.opacity_image {
        Optional::Absent => Some(None),
        Optional::Given(image) => opacity_image(image, files, reader).map(Some),
        Optional::Invalid => None,
    };
    let relief = match (&form.normal_map, &form.bump_map) {
        (Optional::Absent, Optional::Absent) => Some(None),
        (Optional::Given(map), Optional::Absent) => normal_map(map, files, reader).map(Some),
        (Optional::Absent, Optional::Given(map)) => bump_map(map, files, reader).map(Some),
        _ => None,
    };
    let emission = match &form.emission {
        Optional::Absent => Some(None),
        Optional::Invalid => None,
        Optional::Given(emission) => {
            let radiance = match &emission.radiance {
                Optional::Given(form) => spectra.resolve_emission(form, files, reader),
                Optional::Invalid => None,
                Optional::Absent => {
                    let keys = [(&emission.luminance_cd_per_m2, 1.0)];
                    stated(&emission.radiance, &keys, &emission.spectrum, spectra, reader)
                        .map(|radiance| (radiance, None))
                }
            };
            radiance.zip(emission.sides).map(|((radiance, image), sides)| Some(Emission { radiance, image, sides }))
        }
    };
    if let Some(shape) = &shape {
        let of_opacity = opacity_image.iter().flatten().map(|image| &image.texture);
        let of_relief = relief.iter().flatten().map(|relief| relief.texture());
        let of_emission = emission.iter().flatten().filter_map(|emission| emission.image.as_ref());
        for texture in of_opacity.chain(of_relief).chain(of_emission) {
            check_coordinates(Some(texture), shape, form.at.head(), reader);
        }
    }
    Some(Object {
        name: name?,
        shape: shape?,
        transform: transform?,
        material: material?,
        emission: emission?,
        opacity: form.opacity?.0,
        opacity_image: opacity_image?,
        relief: relief?,
    })
}

/// Odd scenes that can be rendered all the same.
fn warn(scene: &Scene, form: &SceneForm, reader: &mut Reader<'_>) {
    let at = form.objects.as_ref().map_or(form.at.head(), |objects| objects.at.head());
    if scene.objects.is_empty() && scene.instances.is_empty() {
        reader.warning(Code::NoObjects, at, "the scene has no objects", None);
    }
    let lit = scene.lights.iter().any(|light| !light.kind.is_zero());
    let glowing = scene.placed_objects().filter_map(|o| o.emission.as_ref()).any(|e| !e.is_zero());
    let media = scene.medium.iter().chain(scene.materials.iter().flat_map(Material::media));
    let shining = media.filter_map(|medium| medium.shines()).next().is_some();
    if !lit && !glowing && !shining {
        let hint = "give an object an \"emission\", or add to \"lights\"".to_owned();
        let message = "nothing emits light: the picture will be black";
        reader.warning(Code::NoLight, form.at.head(), message, Some(hint));
    }
}
