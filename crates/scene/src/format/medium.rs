//! Media.

use std::ops::Bound;
use std::sync::Arc;

use super::geometry::{Step, transform};
use super::material::Share;
use super::spectra::{Role, Spectra};
use super::spectrum::SpectrumForm;
use etalon_optics::Spectrum;

use crate::files::Files;
use crate::grid::Grid;
use crate::json::{Code, Direction, List, NonNegative, Optional, Positive, Reader, Required, Rule, Spanned};
use crate::model::{
    AlbedoGrid, DensityGrid, ExponentialDensity, Medium, MediumDensity, PhaseFunction, PhaseMatrix, PhaseTable,
};
use crate::texture::Wrap;

crate::record! {
    /// What fills a space, and what it does to light on its way.
    pub(crate) struct MediumForm + comment {
        /// Absorption coefficient σₐ, 1/m.
        absorption_per_m: Required<SpectrumForm> = "0",
        /// Scattering coefficient σₛ, 1/m: its inverse is the mean way between two scatterings.
        scattering_per_m: Required<SpectrumForm> = "0",
        /// Instead of both: extinction coefficient σₜ = σₐ + σₛ, 1/m.
        extinction_per_m: Optional<SpectrumForm>,
        /// With it: the share of extinction that is scattering, from 0 to 1.
        albedo: Optional<SpectrumForm>,
        /// A factor on the albedo at each place, from 0 to 1.
        albedo_grid: Optional<AlbedoGridForm>,
        /// Where scattered light goes.
        phase: Required<PhaseForm> = r#"{"type": "isotropic"}"#,
        /// What both coefficients are multiplied by at each place: the medium is the same everywhere if this is left out.
        density: Optional<DensityForm>,
        /// Source radiance B, W·m⁻²·sr⁻¹·nm⁻¹: the medium emits σₐB a metre. A hot gas has the radiance of a black body.
        source_radiance: Optional<SpectrumForm>,
    } with [
        Rule::NotBoth("extinction_per_m", "absorption_per_m"),
        Rule::NotBoth("extinction_per_m", "scattering_per_m"),
        Rule::Needs("extinction_per_m", &["albedo"]),
        Rule::Needs("albedo", &["extinction_per_m"]),
        Rule::Needs("albedo_grid", &["albedo"]),
        Rule::NotBoth("albedo_grid", "source_radiance"),
    ]
}

crate::variants! {
    /// Where scattered light goes.
    pub(crate) enum PhaseForm by "type" {
        "isotropic" => Isotropic(IsotropicPhase),
        "henyey-greenstein" => HenyeyGreenstein(HenyeyGreensteinPhase),
        "double-henyey-greenstein" => DoubleHenyeyGreenstein(DoubleHenyeyGreensteinPhase),
        "rayleigh" => Rayleigh(RayleighPhase),
        "tabulated" => Tabulated(TabulatedPhase),
    }
}

crate::record! {
    /// The same in every direction.
    pub(crate) struct IsotropicPhase + comment {}
}

crate::number! {
    /// A mean cosine: directions cannot resolve sharper peaks.
    pub(crate) struct MeanCosine in (Bound::Included(-0.9999), Bound::Included(0.9999));
}

crate::record! {
    /// Henyey and Greenstein's: (1 − g²)/(1 + g² − 2g cos θ)^(3/2)/4π.
    pub(crate) struct HenyeyGreensteinPhase + comment {
        /// Mean cosine of the angle of scattering: above 0 light goes on forward, below 0 back.
        g: Required<MeanCosine>,
    }
}

crate::record! {
    /// Two of Henyey and Greenstein's, as clouds and tissue have them: a peak forward and one back.
    pub(crate) struct DoubleHenyeyGreensteinPhase + comment {
        /// Mean cosines of both.
        g: Required<[MeanCosine; 2]>,
        /// Share of the first, from 0 to 1.
        weight: Required<Share>,
    }
}

crate::record! {
    /// Of molecules and whatever else is much smaller than the wavelength: 3(1 + cos²θ)/16π. Followed with --polarised.
    pub(crate) struct RayleighPhase + comment {}
}

crate::number! {
    /// An angle of scattering in degrees.
    pub(crate) struct ScatteringAngle in (Bound::Included(0.0), Bound::Included(180.0));
}

crate::record! {
    /// A table, such as Mie's theory gives: linear in the cosine between its rows, and scaled so that no light is lost.
    pub(crate) struct TabulatedPhase + comment {
        /// Angles of scattering in degrees, increasing from 0 (forward) to 180 (back).
        angles_deg: Required<Spanned<List<ScatteringAngle>>>,
        /// Values at these angles, in any unit: F₁₁ of the scattering matrix.
        values: Required<Spanned<List<NonNegative>>>,
        /// F₁₂ at these angles, in the same unit. Without a matrix, scattered light is unpolarised.
        f12: Optional<Spanned<List<f64>>>,
        /// F₃₃.
        f33: Optional<Spanned<List<f64>>>,
        /// F₃₄.
        f34: Optional<Spanned<List<f64>>>,
        /// F₂₂, for particles that are not spheres; of spheres it is F₁₁.
        f22: Optional<Spanned<List<f64>>>,
        /// F₄₄, for particles that are not spheres; of spheres it is F₃₃.
        f44: Optional<Spanned<List<f64>>>,
    } with [
        Rule::Needs("f12", &["f33", "f34"]),
        Rule::Needs("f33", &["f12", "f34"]),
        Rule::Needs("f34", &["f12", "f33"]),
        Rule::Needs("f22", &["f12"]),
        Rule::Needs("f44", &["f12"]),
    ]
}

crate::variants! {
    /// How dense a medium is at each place: of the world, or of the group that holds the body which it fills.
    pub(crate) enum DensityForm by "type" {
        "exponential" => Exponential(ExponentialForm),
        "grid" => Grid(GridForm),
    }
}

crate::record! {
    /// A density that falls exponentially with the height, as that of air: e^(−h/H).
    pub(crate) struct ExponentialForm + comment {
        /// A point at which it is 1, m.
        base_m: Required<[f64; 3]> = "[0, 0, 0]",
        /// The direction in which heights count; only the direction counts.
        up: Required<Direction> = "[0, 1, 0]",
        /// Scale height H, m: the density falls to 1/e over this height.
        scale_height_m: Required<Positive>,
    }
}

crate::record! {
    /// Densities of a grid, in trilinear proportion between the middles of its cells, and 0 outside of its box.
    pub(crate) struct GridForm + comment {
        /// A .vol file, relative to this file's folder.
        file: Required<Spanned<String>>,
        /// Factor on its numbers.
        scale: Required<NonNegative> = "1",
        /// From the coordinates of the file's box to the world, or to those of the body's group: steps, the first of which is applied first.
        transform: Required<Spanned<List<Box<Step>>>> = "[]",
    }
}

crate::record! {
    /// Shares or colours of a grid, in trilinear proportion between the middles of its cells.
    pub(crate) struct AlbedoGridForm + comment {
        /// A .vol file of one channel or of three (linear red, green and blue), relative to this file's folder.
        file: Required<Spanned<String>>,
        /// From the coordinates of the file's box to the world, or to those of the body's group: steps, the first of which is applied first.
        transform: Required<Spanned<List<Box<Step>>>> = "[]",
        /// What holds beyond the box: the nearest value ("clamp"), or the box again ("repeat", "mirror").
        wrap: Required<Wrap> = r#""clamp""#,
    }
}

/// The medium of a form.
pub(super) fn medium<'f>(
    form: &'f MediumForm,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Medium> {
    let coefficients = match (&form.extinction_per_m, &form.albedo) {
        (Optional::Absent, Optional::Absent) => {
            let mut coefficient = |form: &'f Required<SpectrumForm>, reader: &mut Reader<'_>| {
                spectra.resolve(form.as_ref()?, Role::Coefficient, reader)
            };
            let absorption = coefficient(&form.absorption_per_m, reader);
            absorption.zip(coefficient(&form.scattering_per_m, reader))
        }
        (Optional::Given(extinction), Optional::Given(albedo)) => {
            let extinction = spectra.resolve(extinction, Role::Coefficient, reader);
            let albedo = spectra.resolve(albedo, Role::Reflectance, reader);
            extinction.zip(albedo).and_then(|(extinction, albedo)| by_albedo(&extinction, &albedo, spectra))
        }
        _ => None,
    };
    let source = match &form.source_radiance {
        Optional::Absent => Some(None),
        Optional::Given(source) => spectra.resolve(source, Role::Emission, reader).map(Some),
        Optional::Invalid => None,
    };
    let phase = form.phase.as_ref().and_then(|form| phase(form, reader));
    let density = match &form.density {
        Optional::Absent => Some(MediumDensity::Uniform),
        Optional::Given(form) => density(form, files, reader),
        Optional::Invalid => None,
    };
    let albedo = match &form.albedo_grid {
        Optional::Absent => Some(None),
        Optional::Given(form) => albedo_grid(form, files, reader).map(|grid| Some(Arc::new(grid))),
        Optional::Invalid => None,
    };
    let (absorption, scattering) = coefficients?;
    Some(Medium { absorption, scattering, phase: phase?, source: source?, density: density?, albedo: albedo? })
}

/// Absorption and scattering of an extinction by the share that is scattering.
fn by_albedo(extinction: &Spectrum, albedo: &Spectrum, spectra: &Spectra<'_>) -> Option<(Spectrum, Spectrum)> {
    let absorption = spectra.combined(extinction, albedo, |extinction, albedo| extinction * (1.0 - albedo))?;
    let scattering = spectra.combined(extinction, albedo, |extinction, albedo| extinction * albedo)?;
    Some((absorption, scattering))
}

fn density(form: &DensityForm, files: &mut Files, reader: &mut Reader<'_>) -> Option<MediumDensity> {
    match form {
        DensityForm::Exponential(form) => Some(MediumDensity::Exponential(ExponentialDensity {
            base_m: form.base_m?,
            up: form.up?.0,
            scale_height_m: form.scale_height_m?.0,
        })),
        DensityForm::Grid(form) => {
            let transform = form.transform.as_ref().and_then(|steps| transform(&steps.value, steps.at.head(), reader));
            let grid = form.file.as_ref().and_then(|name| grid(name, &[1], "a density has 1", files, reader));
            let (grid, scale) = (grid?, form.scale?.0);
            let values = match scale {
                1.0 => grid.values,
                scale => grid.values.iter().map(|value| (f64::from(*value) * scale) as f32).collect(),
            };
            if values.iter().any(|value| !value.is_finite()) {
                reader.error(
                    Code::OutOfRange,
                    form.at.head(),
                    "the densities are too large for single precision".to_owned(),
                );
                return None;
            }
            Some(MediumDensity::Grid(DensityGrid {
                values,
                transform: transform?,
                cells: grid.cells,
                box_m: grid.box_m,
            }))
        }
    }
}

/// The grid of a file that has one of these numbers of channels.
fn grid(
    name: &Spanned<String>,
    channels: &[usize],
    has: &str,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Grid> {
    let grid = files.grid(name, reader)?;
    if !channels.contains(&grid.channels) {
        reader.error(Code::File, name.at, format!("{}: it has {} channels; {has}", name.value, grid.channels));
        return None;
    }
    Some(grid)
}

fn albedo_grid(form: &AlbedoGridForm, files: &mut Files, reader: &mut Reader<'_>) -> Option<AlbedoGrid> {
    let transform = form.transform.as_ref().and_then(|steps| transform(&steps.value, steps.at.head(), reader));
    let name = form.file.as_ref()?;
    let grid = grid(name, &[1, 3], "an albedo has 1 or 3", files, reader);
    let (transform, grid) = (transform?, grid?);
    if let Some(place) = grid.values.iter().position(|value| *value > 1.0) {
        let message = format!("{}: number {place} is {}: an albedo is at most 1", name.value, grid.values[place]);
        reader.error(Code::OutOfRange, name.at, message);
        return None;
    }
    let Grid { cells, channels, values, box_m } = grid;
    Some(AlbedoGrid { cells, channels, values, box_m, transform, wrap: form.wrap? })
}

fn phase(form: &PhaseForm, reader: &mut Reader<'_>) -> Option<PhaseFunction> {
    Some(match form {
        PhaseForm::Isotropic(_) => PhaseFunction::Isotropic,
        PhaseForm::HenyeyGreenstein(form) => PhaseFunction::HenyeyGreenstein { g: form.g?.0 },
        PhaseForm::DoubleHenyeyGreenstein(form) => {
            PhaseFunction::DoubleHenyeyGreenstein { g: form.g?.map(|g| g.0), weight: form.weight?.0 }
        }
        PhaseForm::Rayleigh(_) => PhaseFunction::Rayleigh,
        PhaseForm::Tabulated(form) => PhaseFunction::Tabulated(table(form, reader)?),
    })
}

fn table(form: &TabulatedPhase, reader: &mut Reader<'_>) -> Option<PhaseTable> {
    let (angles, values) = (form.angles_deg.as_ref()?, form.values.as_ref()?);
    let degrees = angles.value.0.iter().map(|angle| angle.map(|angle| angle.0)).collect::<Option<Vec<_>>>()?;
    let numbers = values.value.0.iter().map(|value| value.map(|value| value.0)).collect::<Option<Vec<_>>>()?;
    let ends = [degrees.first().copied(), degrees.last().copied()];
    if ends != [Some(0.0), Some(180.0)] || degrees.windows(2).any(|pair| pair[0] >= pair[1]) {
        let message = "the angles of a phase function must increase from 0 to 180";
        reader.error(Code::OutOfRange, angles.at, message.to_owned());
        return None;
    }
    if degrees.len() != numbers.len() {
        let message = format!("{} angles have {} values", degrees.len(), numbers.len());
        reader.error(Code::WrongLength, values.at, message);
        return None;
    }
    if numbers.iter().all(|value| *value == 0.0) {
        reader.error(Code::OutOfRange, values.at, "a phase function of nothing but 0 scatters nowhere".to_owned());
        return None;
    }
    let cosine = |degrees: f64| match degrees {
        0.0 => 1.0,
        180.0 => -1.0,
        other => other.to_radians().cos(),
    };
    let matrix = matrix(form, &degrees, &numbers, reader)?;
    Some(PhaseTable {
        cosines: degrees.iter().rev().map(|degrees| cosine(*degrees)).collect(),
        values: numbers.into_iter().rev().collect(),
        matrix,
    })
}

/// The other elements of a table's matrix, if it has them; all by increasing cosine.
fn matrix(form: &TabulatedPhase, degrees: &[f64], f11: &[f64], reader: &mut Reader<'_>) -> Option<Option<PhaseMatrix>> {
    let mut read = |elements: &Optional<Spanned<List<f64>>>| -> Option<Option<Vec<f64>>> {
        let Some(elements) = elements.clone().checked()? else { return Some(None) };
        let numbers = elements.value.0.iter().copied().collect::<Option<Vec<_>>>()?;
        if numbers.len() != degrees.len() {
            let message = format!("{} angles have {} values", degrees.len(), numbers.len());
            reader.error(Code::WrongLength, elements.at, message);
            return None;
        }
        Some(Some(numbers))
    };
    let elements = [&form.f12, &form.f33, &form.f34, &form.f22, &form.f44].map(&mut read);
    let [f12, f33, f34, f22, f44] = elements;
    let (Some(f12), Some(f33), Some(f34)) = (f12?, f33?, f34?) else { return Some(None) };
    let (f22, f44) = (f22?.unwrap_or_else(|| f11.to_vec()), f44?.unwrap_or_else(|| f33.clone()));
    // Light cannot be more than wholly polarised, whatever comes in; tables have few digits.
    const ROUNDED: f64 = 1e-3;
    for (i, degrees) in degrees.iter().enumerate() {
        let limit = (f11[i] + f22[i]).powi(2) * (1.0 + ROUNDED);
        let across = (f33[i] + f44[i]).powi(2) + 4.0 * (f34[i] * f34[i] + f12[i] * f12[i]);
        let wide = f11[i] * (1.0 + ROUNDED);
        let uneven = (f33[i] - f44[i]).abs() > f11[i] - f22[i] + ROUNDED * f11[i];
        if across > limit || uneven || [f22[i], f33[i], f44[i]].iter().any(|f| f.abs() > wide) {
            let message = format!("the matrix at {degrees}° makes more polarised light than there is light");
            let hint = "of spheres, f12² + f33² + f34² is at most the square of the value, and f44 is f33";
            reader.error_hint(Code::OutOfRange, form.at.head(), message, hint);
            return None;
        }
    }
    let turned = |numbers: Vec<f64>| numbers.into_iter().rev().collect();
    Some(Some(PhaseMatrix { f12: turned(f12), f22: turned(f22), f33: turned(f33), f34: turned(f34), f44: turned(f44) }))
}
