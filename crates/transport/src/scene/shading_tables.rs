//! Per-object shading lookup tables, and the spectra that paths keep at their wavelengths.

use crate::bsdf::{Bsdf, Dielectric, Properties};
use crate::light::{Environment, LightTable};
use crate::spectral::{Colour, PathSpectrum, daylight};
use crate::surface::shading_geometry::Coordinates;
use crate::surface::{ObjectSurface, Surfaces};
use crate::wavelength::cells::CellTable;
use crate::wavelength::{WavelengthDistribution, Wavelengths};
use etalon_optics::Lanes;
use etalon_optics::spectrum::RgbBasis;

/// Spectra whose values at its wavelengths a path keeps.
const SLOTS: usize = 16;

/// Most smooth interfaces that have numbers.
const INTERFACES: usize = 256;

/// Place of a spectrum among those kept.
pub(crate) type Slot = Option<u8>;

/// The BSDFs that drivers draw directions of with vector instructions: around the surface's own normal, the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BsdfKind {
    /// Lambert's reflection, of this reflectance; `None` of the colour that an image or the vertices around show at the place.
    Lambert(Slot),
    /// A mirror's, of this reflectance.
    Mirror(u8),
    /// That of a smooth interface: its number.
    Dielectric(u8),
    /// Any other, and any around a bent normal.
    General,
}

/// A smooth interface.
#[derive(Clone, Debug)]
pub(crate) struct SmoothInterface {
    pub glass: Dielectric,
    /// The indices behind and before the outward normal, where they are the same at every wavelength.
    pub constant: Option<[f64; 2]>,
}

/// What the surfaces of an object do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectRecord {
    /// Whether it scatters around other normals than its own.
    bent: bool,
    /// Whether it reflects as Lambert's law says, around its own normals.
    diffuse: bool,
    /// Whether no light passes it as if it were not there.
    opaque: bool,
    /// The spectrum that it emits.
    pub emission: Slot,
}

/// What a material does.
#[derive(Clone, Copy, Debug)]
struct MaterialRecord {
    kind: BsdfKind,
    /// Whether shadow rays are of use.
    solid_angle_part: bool,
    /// Whether light may pass it straight on.
    passes_straight: bool,
    /// Whether it is smooth glass or a pane: which part it reflects is known.
    glass: bool,
    /// Whether it is a pane, which passes all light straight on that it does not reflect.
    pane: bool,
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct ShadingTables {
    spectra: Vec<PathSpectrum>,
    /// The same, in their order, by cells of wavelengths, where they can be.
    by_cells: Vec<Option<CellTable>>,
    pub(crate) objects: Vec<ObjectRecord>,
    materials: Vec<MaterialRecord>,
    /// The first [`INTERFACES`] of them.
    pub(crate) interfaces: Vec<SmoothInterface>,
    /// Of the lights, in their order; of an image, its white.
    pub(crate) lights: Vec<Slot>,
    /// Of the environments; of an image, its white.
    pub(crate) environments: Vec<Slot>,
}

impl ShadingTables {
    /// For paths whose wavelengths are drawn from `wavelengths`, if they are drawn. Where light is followed with its polarisation, all BSDFs
    /// are general.
    pub(crate) fn new(
        surfaces: &Surfaces,
        lights: &LightTable,
        skies: &[Environment],
        wavelengths: Option<&WavelengthDistribution>,
        polarised: bool,
    ) -> Self {
        let (mut spectra, mut interfaces) = (Vec::new(), Vec::new());
        let material = |(bsdf, properties): (&Bsdf, &Properties)| MaterialRecord {
            kind: if polarised { BsdfKind::General } else { kind(bsdf, &mut spectra, &mut interfaces) },
            solid_angle_part: properties.solid_angle,
            passes_straight: properties.passes_straight,
            glass: bsdf.is_smooth_glass() || bsdf.is_pane(),
            pane: bsdf.is_pane(),
        };
        let materials: Vec<_> = surfaces.bsdfs.iter().zip(&surfaces.properties).map(material).collect();
        let objects = surfaces.objects.iter().map(|object| record(object, surfaces, &mut spectra)).collect();
        let environments = skies.iter().map(|sky| slot(sky.radiance.spectrum(), &mut spectra)).collect();
        // The triangles of a mesh share their spectrum, and come one after the other.
        let mut last: Option<(*const PathSpectrum, Slot)> = None;
        let lights = lights
            .lights()
            .iter()
            .map(|light| {
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
        Self { spectra, by_cells, objects, materials, interfaces, lights, environments }
    }
}

impl ShadingTables {
    /// Whether an object reflects as Lambert's law says, around its own normals.
    #[inline(always)]
    pub(crate) fn is_diffuse(&self, object: u32) -> bool {
        self.objects[object as usize].diffuse
    }

    /// What an object does, that has or stands for this material.
    #[inline(always)]
    pub(crate) fn kind(&self, object: u32, material: usize) -> BsdfKind {
        if self.objects[object as usize].bent { BsdfKind::General } else { self.materials[material].kind }
    }

    /// Whether shadow rays from a material are of use.
    #[inline(always)]
    pub(crate) fn has_solid_angle_part(&self, material: usize) -> bool {
        self.materials[material].solid_angle_part
    }

    /// Whether an object is a pane and has or stands for this material.
    #[inline(always)]
    pub(crate) fn is_pane(&self, object: u32, material: usize) -> bool {
        self.objects[object as usize].opaque && self.materials[material].pane
    }

    /// Whether a material is smooth glass or a pane.
    pub(crate) fn is_glass(&self, material: usize) -> bool {
        self.materials[material].glass
    }

    /// Whether light may pass a material straight on: a pane, or a blend with one.
    #[inline(always)]
    pub(crate) fn passes_straight(&self, material: usize) -> bool {
        self.materials[material].passes_straight
    }
}

fn kind(bsdf: &Bsdf, spectra: &mut Vec<PathSpectrum>, interfaces: &mut Vec<SmoothInterface>) -> BsdfKind {
    let mut known = |spectrum: &PathSpectrum| slot(spectrum, spectra);
    if let Some(lambert) = bsdf.lambert() {
        return match lambert.uniform() {
            Some(spectrum) => known(spectrum).map_or(BsdfKind::General, |place| BsdfKind::Lambert(Some(place))),
            None => BsdfKind::Lambert(None),
        };
    }
    match bsdf {
        Bsdf::Mirror(mirror) => mirror.uniform().and_then(known).map_or(BsdfKind::General, BsdfKind::Mirror),
        // The general way knows what films do.
        Bsdf::Dielectric(glass) if interfaces.len() < INTERFACES && !glass.is_coated() => {
            interfaces.push(SmoothInterface { glass: glass.clone(), constant: glass.constant_indices() });
            BsdfKind::Dielectric((interfaces.len() - 1) as u8)
        }
        _ => BsdfKind::General,
    }
}

fn record(object: &ObjectSurface, surfaces: &Surfaces, spectra: &mut Vec<PathSpectrum>) -> ObjectRecord {
    let bent = object.relief.is_some()
        || match &object.coordinates {
            Coordinates::Mesh(mesh) => !mesh.mesh.normals.is_empty(),
            Coordinates::None | Coordinates::Parallelogram { .. } | Coordinates::Round(_) => false,
        };
    ObjectRecord {
        bent,
        opaque: object.opacity == 1.0 && object.opacity_image.is_none(),
        diffuse: !bent && matches!(surfaces.bsdfs[object.material], Bsdf::Lambert(_)),
        emission: object.emission.as_ref().and_then(|emission| slot(&emission.radiance, spectra)),
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

/// Values of spectra at the wavelengths of one path: those that have no table by cells are evaluated when they are asked for first.
#[derive(Clone)]
pub(crate) struct SpectrumCache<const N: usize> {
    valid: u32,
    /// Whether the wavelengths were drawn from the cells of the tables.
    from_cells: bool,
    values: [Lanes<f64, N>; SLOTS],
    /// How far wavelengths are from the whole nanometre before.
    past_nm: Lanes<f64, N>,
    /// What one unit of red, green and blue reflect, once an image was asked.
    primaries: Option<[Lanes<f64, N>; 3]>,
}

impl<const N: usize> SpectrumCache<N> {
    pub(crate) fn new() -> Self {
        Self { valid: 0, from_cells: true, values: [Lanes::ZERO; SLOTS], past_nm: Lanes::ZERO, primaries: None }
    }

    /// Other wavelengths take the place, drawn from the cells of the tables or not.
    #[inline(always)]
    pub(crate) fn forget(&mut self, lambda_nm: &Lanes<f64, N>, from_cells: bool) {
        self.valid = 0;
        self.from_cells = from_cells;
        self.past_nm = lambda_nm.map(past_whole);
        self.primaries = None;
    }

    /// A spectrum with a place at the wavelengths of the path.
    #[inline(always)]
    pub(crate) fn spectrum(&mut self, slot: u8, tables: &ShadingTables, wavelengths: &Wavelengths<N>) -> Lanes<f64, N> {
        let slot = usize::from(slot) % SLOTS;
        if let Some(table) = &tables.by_cells[slot]
            && self.from_cells
        {
            let [value, step] = table.at(&wavelengths.place);
            return value + self.past_nm * step;
        }
        if self.valid >> slot & 1 == 0 {
            self.values[slot] = tables.spectra[slot].lanes(&wavelengths.lambda_nm);
            self.valid |= 1 << slot;
        }
        self.values[slot]
    }

    /// What a light of this colour has its spectrum multiplied by.
    #[inline(always)]
    pub(crate) fn colour(&mut self, colour: Colour, lambda_nm: &Lanes<f64, N>) -> Lanes<f64, N> {
        let [r, g, b] = match colour {
            Colour::Rgb(rgb) => rgb,
            Colour::Daylight(weights) => return daylight(weights, lambda_nm),
        };
        let [red, green, blue] = match self.primaries {
            Some(primaries) => primaries,
            None => *self.primaries.insert(RgbBasis::get().lanes(lambda_nm)),
        };
        red * r + green * g + blue * b
    }

    /// A spectrum at the wavelengths of the path, with a place or not.
    #[inline(always)]
    pub(crate) fn of(
        &mut self,
        slot: Slot,
        spectrum: &PathSpectrum,
        tables: &ShadingTables,
        wavelengths: &Wavelengths<N>,
    ) -> Lanes<f64, N> {
        match slot {
            Some(slot) => self.spectrum(slot, tables, wavelengths),
            None => spectrum.lanes(&wavelengths.lambda_nm),
        }
    }
}

/// How far a number is from the whole one before, exactly; in 0 to 2⁵¹.
#[inline(always)]
fn past_whole(x: f64) -> f64 {
    // No double of this size has a fraction: rounded to the nearest whole number.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let nearest = (x + WHOLE) - WHOLE;
    x - if nearest > x { nearest - 1.0 } else { nearest }
}

#[cfg(test)]
mod tests {
    #[test]
    fn what_is_past_a_whole_number_is_its_fraction() {
        for x in [0.0, 0.25, 0.5, 1.0_f64.next_down(), 1.0, 1.5, 360.0, 360.0_f64.next_up(), 555.49, 555.5, 829.999] {
            assert_eq!(super::past_whole(x), x.fract(), "{x}");
        }
    }
}
