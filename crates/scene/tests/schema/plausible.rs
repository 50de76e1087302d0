//! What holds of every material that a scene was accepted with.

use etalon_scene::{MaterialKind as M, Metal, PolarisingSheet, SpectrumTexture};

/// Whether its numbers are possible at a wavelength, nm.
pub(crate) fn kind(kind: &M, nm: f64, holds_medium: bool) -> bool {
    match kind {
        M::TwoSided { front, back } => {
            let side = |kind: &M| !matches!(kind, M::TwoSided { .. }) && self::kind(kind, nm, holds_medium);
            side(front) && side(back)
        }
        M::Tinted { kind: of, reflected, transmitted } => {
            let share = |tint: &SpectrumTexture| match tint {
                SpectrumTexture::Uniform(spectrum) => (0.0..=1.0).contains(&spectrum.eval(nm)),
                SpectrumTexture::Image(texture) => texture.mean().iter().all(|v| (0.0..=1.0).contains(v)),
                SpectrumTexture::VertexColours { factor, .. } => factor.iter().all(|f| *f >= 0.0),
            };
            share(reflected) && share(transmitted) && self::kind(of, nm, holds_medium)
        }
        M::Lambert { reflectance }
        | M::Mirror { reflectance }
        | M::OrenNayar { reflectance, .. }
        | M::Plastic { reflectance, .. }
        | M::Principled { reflectance, .. }
        | M::Conductor { metal: Metal::Reflectance(reflectance), .. }
        | M::RoughConductor { metal: Metal::Reflectance(reflectance), .. } => match reflectance {
            SpectrumTexture::Uniform(spectrum) => (0.0..=1.0).contains(&spectrum.eval(nm)),
            // The scene names no files: it is a texture of a few texels that the scene states.
            SpectrumTexture::Image(texture) => texture.mean().iter().all(|v| (0.0..=1.0).contains(v)),
            SpectrumTexture::VertexColours { factor, .. } => factor.iter().all(|f| *f >= 0.0),
        },
        M::Conductor { metal: Metal::Index(index), .. } | M::RoughConductor { metal: Metal::Index(index), .. } => {
            index.eval(nm).0 > 0.0
        }
        M::Dielectric { interior, exterior, .. } | M::RoughDielectric { interior, exterior, .. } => {
            interior.eval(nm) > 0.0 && exterior.eval(nm) > 0.0
        }
        M::Translucent { reflectance, transmittance } => {
            let shares = [reflectance, transmittance].map(|texture| match texture {
                SpectrumTexture::Uniform(spectrum) => spectrum.eval(nm),
                SpectrumTexture::Image(texture) => texture.mean().into_iter().fold(0.0, f64::max),
                SpectrumTexture::VertexColours { .. } => 0.0,
            });
            shares.iter().all(|share| *share >= 0.0) && shares.iter().sum::<f64>() <= 1.0 + 1e-6
        }
        M::ThinDielectric { index, .. } => index.eval(nm) > 0.0,
        M::PolarisingSheet { axis, sheet } => {
            let good = match sheet {
                PolarisingSheet::Polariser { transmittance, extinction } => {
                    (0.0..=1.0).contains(&transmittance.eval(nm)) && (0.0..=1.0).contains(extinction)
                }
                PolarisingSheet::Retarder { retardance_rad, at_nm } => {
                    retardance_rad.is_finite() && at_nm.is_none_or(|nm| nm >= 1.0)
                }
            };
            good && (axis.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-12
        }
        M::Grating { grating, .. } => grating.period_nm > 0.0 && (0.0..1.0 + 1e-9).contains(&grating.efficiency()),
        M::Fluorescent { reflectance, fluorescence } => {
            let returned = fluorescence.returned(&[nm], fluorescence.emission_range_nm())[0];
            let SpectrumTexture::Uniform(reflectance) = reflectance else { panic!("no image is read") };
            returned >= 0.0 && returned + reflectance.eval(nm) <= 1.0 + 1e-6
        }
        M::Blend { parts, by } => {
            parts.len() >= 2 && parts.is_sorted_by(|a, b| a.0 < b.0) && (0.0..=1.0).contains(&by.eval([0.3, 0.7]))
        }
        M::Measured { surface } => surface.rotation_rad.is_finite() && surface.at_nm.is_none(),
        M::Boundary { .. } => holds_medium,
        M::Black => true,
    }
}
