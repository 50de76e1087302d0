//! What the engine looks up instead of asking the scene each time: what objects do, and which spectra there are.

use crate::bsdf::{Bsdf, Dielectric};
use crate::cells::CellTable;
use crate::coordinates::Coordinates;
use crate::light::{Environment, EnvironmentRadiance, Light, LightTable};
use crate::spectral::PathSpectrum;
use crate::surface::{ObjectSurface, Surfaces};
use crate::wavelength::WavelengthDistribution;

/// Spectra whose values at its wavelengths a path keeps.
pub(super) const SLOTS: usize = 16;

/// Most smooth interfaces that have numbers.
const INTERFACES: usize = 256;

/// Place of a spectrum among those kept.
pub(super) type Slot = Option<u8>;

/// What an object does to light, where that has a row form: around its own normals, the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Lambert's reflection, of this reflectance.
    Lambert(u8),
    /// A mirror's, of this reflectance.
    Mirror(u8),
    /// That of a smooth interface: its number.
    Dielectric(u8),
    /// Anything else.
    Other,
}

/// A smooth interface.
#[derive(Clone, Debug)]
pub(super) struct SmoothInterface {
    pub glass: Dielectric,
    /// The indices behind and before the outward normal, where they are the same at every wavelength.
    pub constant: Option<[f64; 2]>,
}

/// What the surfaces of an object do, as far as the engine knows it by heart.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectRecord {
    pub form: Form,
    /// Whether it reflects as Lambert's law says, around its own normals.
    pub diffuse: bool,
    /// Whether shadow rays are of use.
    pub solid_angle_part: bool,
    /// Whether it emits.
    pub emits: bool,
    /// What it emits.
    pub emission: Slot,
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Tables {
    pub(super) spectra: Vec<PathSpectrum>,
    /// The same, in their order, by cells of wavelengths, where they can be.
    pub(super) by_cells: Vec<Option<CellTable>>,
    pub(super) objects: Vec<ObjectRecord>,
    /// The first [`INTERFACES`] of them.
    pub(super) interfaces: Vec<SmoothInterface>,
    /// Of the lights, in their order.
    pub(super) lights: Vec<Slot>,
    /// Of the environments.
    pub(super) environments: Vec<Slot>,
}

impl Tables {
    /// For paths whose wavelengths are drawn from `wavelengths`, if they are drawn.
    pub(crate) fn new(
        surfaces: &Surfaces,
        lights: &LightTable,
        skies: &[Environment],
        wavelengths: Option<&WavelengthDistribution>,
    ) -> Self {
        let (mut spectra, mut interfaces) = (Vec::new(), Vec::new());
        // Objects of one material share its form.
        let forms: Vec<_> = surfaces.bsdfs.iter().map(|bsdf| form(bsdf, &mut spectra, &mut interfaces)).collect();
        let objects = surfaces.objects.iter().map(|object| record(object, surfaces, &forms, &mut spectra)).collect();
        let environments = skies
            .iter()
            .map(|sky| match &sky.radiance {
                EnvironmentRadiance::Uniform(spectrum) => slot(spectrum, &mut spectra),
                EnvironmentRadiance::Image(_) => None,
            })
            .collect();
        // The triangles of a mesh share their spectrum, and come one after the other.
        let mut last: Option<(*const PathSpectrum, Slot)> = None;
        let lights = lights
            .lights()
            .iter()
            .map(|light| {
                if matches!(light, Light::Environment(_)) || light.emitter().is_some_and(|e| e.image.is_some()) {
                    return None;
                }
                let spectrum = light.spectrum();
                let found = match last {
                    Some((of, found)) if std::ptr::eq(of, spectrum) => found,
                    _ => slot(spectrum, &mut spectra),
                };
                last = Some((spectrum, found));
                found
            })
            .collect();
        let whole_nm = wavelengths.and_then(WavelengthDistribution::whole_nm);
        let by_cells = spectra.iter().map(|spectrum| spectrum.by_cells(whole_nm.as_deref()?)).collect();
        Self { spectra, by_cells, objects, interfaces, lights, environments }
    }
}

impl Tables {
    /// Whether an object reflects as Lambert's law says, around its own normals.
    #[inline(always)]
    pub(crate) fn is_diffuse(&self, object: u32) -> bool {
        self.objects[object as usize].diffuse
    }
}

fn form(bsdf: &Bsdf, spectra: &mut Vec<PathSpectrum>, interfaces: &mut Vec<SmoothInterface>) -> Form {
    let of = |known: Slot, form: fn(u8) -> Form| known.map_or(Form::Other, form);
    match bsdf {
        Bsdf::Lambert(lambert) => of(lambert.uniform().and_then(|spectrum| slot(spectrum, spectra)), Form::Lambert),
        Bsdf::Mirror(mirror) => of(mirror.uniform().and_then(|spectrum| slot(spectrum, spectra)), Form::Mirror),
        Bsdf::Dielectric(glass) if interfaces.len() < INTERFACES => {
            interfaces.push(SmoothInterface { glass: glass.clone(), constant: glass.constant_indices() });
            Form::Dielectric((interfaces.len() - 1) as u8)
        }
        _ => Form::Other,
    }
}

fn record(
    object: &ObjectSurface,
    surfaces: &Surfaces,
    forms: &[Form],
    spectra: &mut Vec<PathSpectrum>,
) -> ObjectRecord {
    let bends = object.relief.is_some()
        || match &object.coordinates {
            Coordinates::Mesh(mesh) => !mesh.mesh.normals.is_empty(),
            Coordinates::None | Coordinates::Parallelogram { .. } | Coordinates::Round(_) => false,
        };
    let emission = object.emission.as_ref();
    ObjectRecord {
        form: if bends { Form::Other } else { forms[object.material] },
        diffuse: !bends && matches!(surfaces.bsdfs[object.material], Bsdf::Lambert(_)),
        solid_angle_part: surfaces.bsdfs[object.material].has_solid_angle_part(),
        emits: emission.is_some(),
        emission: emission.and_then(|emission| slot(&emission.radiance, spectra)),
    }
}

/// The place of a spectrum, if there is room for it.
fn slot(spectrum: &PathSpectrum, spectra: &mut Vec<PathSpectrum>) -> Slot {
    if let Some(place) = spectra.iter().position(|known| known.is_same(spectrum)) {
        return Some(place as u8);
    }
    if spectra.len() == SLOTS {
        return None;
    }
    spectra.push(spectrum.clone());
    Some(spectra.len() as u8 - 1)
}
