//! What the materials of surfaces call for.

use crate::plan::grey::steps;
use etalon_optics::{ComplexIndex, RefractiveIndex};
use etalon_scene::{Material, MaterialKind, Metal, PolarisingSheet, SpectrumTexture};

pub(super) fn dispersion(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<String> {
    match kind {
        MaterialKind::Dielectric { interior, exterior, .. }
        | MaterialKind::RoughDielectric { interior, exterior, .. } => [interior, exterior]
            .into_iter()
            .find(|index| index.is_dispersive())
            .map(|index| index_range(index, range_nm)),
        MaterialKind::Lambert { .. }
        | MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::RoughConductor { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Plastic { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::PolarisingSheet { .. }
        | MaterialKind::Black => None,
        MaterialKind::Blend { parts, .. } => parts.iter().find_map(|(_, part)| dispersion(part, range_nm)),
    }
}

/// How the light that a material hands on depends on the wavelength, if it does.
pub(super) fn colour(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<String> {
    if let Some(found) = kind.reflectance().and_then(|reflectance| colour_of_texture(reflectance, range_nm)) {
        return Some(found);
    }
    match kind {
        MaterialKind::Conductor { metal: Metal::Index(index) }
        | MaterialKind::RoughConductor { metal: Metal::Index(index), .. } => {
            index.is_dispersive().then(|| metal_range(index, range_nm))
        }
        MaterialKind::Dielectric { .. } | MaterialKind::RoughDielectric { .. } => dispersion(kind, range_nm),
        MaterialKind::Plastic { coat: index, .. } | MaterialKind::ThinDielectric { index } => {
            index.is_dispersive().then(|| index_range(index, range_nm))
        }
        MaterialKind::PolarisingSheet { sheet, .. } => match sheet {
            PolarisingSheet::Polariser { transmittance, .. } => (!transmittance.is_constant())
                .then(|| format!("transmittance {}", spread(range_nm, |nm| transmittance.eval(nm)))),
            PolarisingSheet::Retarder { retardance_rad, at_nm } => at_nm.map(|at_nm| {
                format!("retardance in degrees {}", spread(range_nm, |nm| retardance_rad.to_degrees() * at_nm / nm))
            }),
        },
        MaterialKind::Blend { parts, .. } => parts.iter().find_map(|(_, part)| colour(part, range_nm)),
        MaterialKind::Lambert { .. }
        | MaterialKind::Mirror { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Conductor { metal: Metal::Reflectance(_) }
        | MaterialKind::RoughConductor { metal: Metal::Reflectance(_), .. }
        | MaterialKind::Black => None,
    }
}

/// How a reflectance depends on the wavelength, if it does.
fn colour_of_texture(reflectance: &SpectrumTexture, range_nm: [f64; 2]) -> Option<String> {
    (!reflectance.is_grey()).then(|| match reflectance {
        SpectrumTexture::Uniform(spectrum) => format!("reflectance {}", spread(range_nm, |nm| spectrum.eval(nm))),
        SpectrumTexture::Image(texture) => format!("colours of \"{}\"", texture.name),
    })
}

/// What the medium within a surface absorbs, if it does.
pub(super) fn absorption(material: &Material, range_nm: [f64; 2]) -> Option<String> {
    let absorption = material.absorption.as_ref().filter(|absorption| !absorption.is_zero())?;
    Some(format!("σ {}", spread(range_nm, |nm| absorption.eval(nm)).replace(" over", " m⁻¹ over")))
}

pub(super) fn nested(kind: &MaterialKind) -> Option<String> {
    match kind {
        MaterialKind::Dielectric { priority, .. } | MaterialKind::RoughDielectric { priority, .. } => {
            priority.map(|priority| format!("priority {priority}"))
        }
        // The reader refuses priorities in the parts of a blend.
        MaterialKind::RoughConductor { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Plastic { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::PolarisingSheet { .. }
        | MaterialKind::Blend { .. }
        | MaterialKind::Lambert { .. }
        | MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::Black => None,
    }
}

pub(super) fn specular(kind: &MaterialKind) -> Option<String> {
    match kind {
        MaterialKind::Mirror { .. } => Some("a mirror".to_owned()),
        MaterialKind::Conductor { .. } => Some("smooth metal".to_owned()),
        MaterialKind::Dielectric { .. } => Some("a smooth interface of two media".to_owned()),
        MaterialKind::ThinDielectric { .. } => Some("a thin pane".to_owned()),
        MaterialKind::PolarisingSheet { sheet, .. } => Some(sheet_name(sheet).to_owned()),
        MaterialKind::Blend { parts, .. } => parts.iter().find_map(|(_, part)| specular(part)),
        MaterialKind::Lambert { .. }
        | MaterialKind::RoughConductor { .. }
        | MaterialKind::RoughDielectric { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Plastic { .. }
        | MaterialKind::Black => None,
    }
}

pub(in crate::plan) fn sheet_name(sheet: &PolarisingSheet) -> &'static str {
    match sheet {
        PolarisingSheet::Polariser { .. } => "a polariser",
        PolarisingSheet::Retarder { .. } => "a retarder",
    }
}

/// Whether a shadow ray from the surface could find light.
pub(super) fn is_diffuse(kind: &MaterialKind) -> bool {
    match kind {
        MaterialKind::Lambert { reflectance } => !reflectance.is_zero(),
        MaterialKind::OrenNayar { reflectance, .. } => !reflectance.is_zero(),
        MaterialKind::RoughConductor { .. } | MaterialKind::RoughDielectric { .. } | MaterialKind::Plastic { .. } => {
            true
        }
        MaterialKind::Blend { parts, .. } => parts.iter().any(|(_, part)| is_diffuse(part)),
        MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::Dielectric { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::PolarisingSheet { .. }
        | MaterialKind::Black => false,
    }
}

fn index_range(index: &RefractiveIndex, range_nm: [f64; 2]) -> String {
    format!("n {}", spread(range_nm, |nm| index.eval(nm)))
}

fn metal_range(index: &ComplexIndex, range_nm: [f64; 2]) -> String {
    let n = extremes(range_nm, |nm| index.eval(nm).0);
    let k = extremes(range_nm, |nm| index.eval(nm).1);
    let [n, k] = [n, k].map(|[low, high]| format!("{low:.3}–{high:.3}"));
    format!("n {n} and k {k} over {}–{} nm", range_nm[0], range_nm[1])
}

/// `1.61–1.66 over 380–780 nm`.
fn spread(range_nm: [f64; 2], value: impl Fn(f64) -> f64) -> String {
    let [low, high] = extremes(range_nm, value);
    format!("{low:.3}–{high:.3} over {}–{} nm", range_nm[0], range_nm[1])
}

/// The least and the largest value at whole nanometres and at the ends.
fn extremes(range_nm: [f64; 2], value: impl Fn(f64) -> f64) -> [f64; 2] {
    steps(range_nm).map(value).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}
