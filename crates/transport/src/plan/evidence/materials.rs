//! What the materials of surfaces call for.

use crate::bsdf::{Properties, properties};
use etalon_optics::spectrum::whole_nm;
use etalon_optics::{ComplexIndex, Fluorescence, RefractiveIndex};
use etalon_scene::{
    Grating, MaterialKind, MeasuredSurface, Metal, Parameter, PolarisingSheet, SpectrumTexture, ThinFilm,
};

/// The index by which wavelengths go different ways, if there is one.
pub(super) fn dispersion(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<String> {
    kind.parameters().iter().find_map(|parameter| match parameter {
        Parameter::Interface(media) => dispersion_of_media(*media, range_nm),
        Parameter::Grating(grating) => diffraction(grating),
        _ => None,
    })
}

fn dispersion_of_media(media: [&RefractiveIndex; 2], range_nm: [f64; 2]) -> Option<String> {
    media.into_iter().find(|index| index.is_dispersive()).map(|index| index_range(index, range_nm))
}

/// How the light that a material hands on depends on the wavelength, if it does.
pub(super) fn colour(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<String> {
    kind.parameters().into_iter().find_map(|parameter| match parameter {
        Parameter::Reflectance(reflectance) | Parameter::Metal(Metal::Reflectance(reflectance)) => {
            colour_of_texture(reflectance, range_nm)
        }
        Parameter::Metal(Metal::Index(index)) => index.is_dispersive().then(|| metal_range(index, range_nm)),
        Parameter::Interface(media) => dispersion_of_media(media, range_nm),
        Parameter::Coat(index) | Parameter::Principled(index) => {
            index.is_dispersive().then(|| index_range(index, range_nm))
        }
        Parameter::Sheet(PolarisingSheet::Polariser { transmittance, .. }) => (!transmittance.is_constant())
            .then(|| format!("transmittance {}", spread(range_nm, |nm| transmittance.eval(nm)))),
        Parameter::Sheet(PolarisingSheet::Retarder { retardance_rad, at_nm }) => at_nm.map(|at_nm| {
            format!("retardance in degrees {}", spread(range_nm, |nm| retardance_rad.to_degrees() * at_nm / nm))
        }),
        Parameter::Grating(grating) => diffraction(grating),
        Parameter::Fluorescence(fluorescence) => reradiation(fluorescence, range_nm),
        // What fixes the wavelength treats all alike.
        Parameter::Film(film) => film.at_nm.is_none().then(|| thickness(film)),
        Parameter::Measured(surface) => surface.is_coloured().then(|| measured(surface)),
    })
}

/// The most light that a material gives back at other wavelengths, if it gives any back that is rendered.
pub(super) fn fluorescence(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<String> {
    kind.parameters().into_iter().find_map(|parameter| match parameter {
        Parameter::Fluorescence(fluorescence) => reradiation(fluorescence, range_nm),
        _ => None,
    })
}

/// `gives back up to 0.62 of light at 450 nm, between 480 and 680 nm`.
fn reradiation(fluorescence: &Fluorescence, range_nm: [f64; 2]) -> Option<String> {
    let nm: Vec<f64> = whole_nm(range_nm).collect();
    let returned = fluorescence.returned(&nm, range_nm);
    let (nm, most) = nm.iter().zip(returned).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let [first, last] = fluorescence.emission_range_nm();
    (most > 0.0).then(|| format!("gives back up to {most:.3} of light at {nm} nm, between {first} and {last} nm"))
}

/// `measured at 195 wavelengths, from 360 to 1000 nm`.
fn measured(surface: &MeasuredSurface) -> String {
    let nm = surface.brdf.wavelengths_nm();
    format!("measured at {} wavelengths, from {:.0} to {:.0} nm", nm.len(), nm[0], nm[nm.len() - 1])
}

/// By which period a grating parts wavelengths, if it does.
fn diffraction(grating: &Grating) -> Option<String> {
    let parts = grating.at_nm.is_none() && grating.orders.iter().any(|(order, share)| *order != 0 && *share > 0.0);
    parts.then(|| format!("grating of {} nm", grating.period_nm))
}

/// The film on a material, if there is one.
pub(super) fn interference(kind: &MaterialKind) -> Option<String> {
    kind.film().map(thickness)
}

/// `thin film of 2 layers, 480 nm thick`.
fn thickness(film: &ThinFilm) -> String {
    let layers = if film.layers.len() == 1 { "1 layer" } else { &format!("{} layers", film.layers.len()) };
    let mean = if film.images().next().is_some() { "on average " } else { "" };
    format!("thin film of {layers}, {mean}{:.1} nm thick", film.mean_thickness_nm())
}

/// Whether a film gives each wavelength another chance to go one of two ways.
pub(super) fn parts_lanes(kind: &MaterialKind) -> bool {
    let of_part = |part: &MaterialKind| match part {
        MaterialKind::Dielectric { film, .. }
        | MaterialKind::RoughDielectric { film, .. }
        | MaterialKind::ThinDielectric { film, .. } => film.as_ref().is_some_and(|film| film.at_nm.is_none()),
        _ => false,
    };
    kind.parts().into_iter().any(of_part)
}

/// How a reflectance depends on the wavelength, if it does.
fn colour_of_texture(reflectance: &SpectrumTexture, range_nm: [f64; 2]) -> Option<String> {
    (!reflectance.is_grey()).then(|| match reflectance {
        SpectrumTexture::Uniform(spectrum) => format!("reflectance {}", spread(range_nm, |nm| spectrum.eval(nm))),
        SpectrumTexture::Image(texture) => format!("colours of \"{}\"", texture.name),
        SpectrumTexture::VertexColours { .. } => "colours of vertices".to_owned(),
    })
}

pub(super) fn nested(kind: &MaterialKind) -> Option<String> {
    kind.solid().map(|(_, priority)| format!("priority {priority}"))
}

/// The first part that sends all light on in single directions.
pub(super) fn specular(kind: &MaterialKind) -> Option<String> {
    let mut parts = kind.parts().into_iter().map(properties);
    parts.find(Properties::is_specular).map(|part| part.smooth_name.to_owned())
}

/// Whether a shadow ray from the surface could find light.
pub(super) fn is_diffuse(kind: &MaterialKind) -> bool {
    kind.parts().into_iter().map(properties).any(|part| part.solid_angle && !part.dark)
}

pub(super) fn index_range(index: &RefractiveIndex, range_nm: [f64; 2]) -> String {
    format!("n {}", spread(range_nm, |nm| index.eval(nm)))
}

fn metal_range(index: &ComplexIndex, range_nm: [f64; 2]) -> String {
    let n = extremes(range_nm, |nm| index.eval(nm).0);
    let k = extremes(range_nm, |nm| index.eval(nm).1);
    let [n, k] = [n, k].map(|[low, high]| format!("{low:.3}–{high:.3}"));
    format!("n {n} and k {k} over {}–{} nm", range_nm[0], range_nm[1])
}

/// `1.61–1.66 over 380–780 nm`.
pub(super) fn spread(range_nm: [f64; 2], value: impl Fn(f64) -> f64) -> String {
    let [low, high] = extremes(range_nm, value);
    format!("{low:.3}–{high:.3} over {}–{} nm", range_nm[0], range_nm[1])
}

/// The least and the largest value at whole nanometres and at the ends.
fn extremes(range_nm: [f64; 2], value: impl Fn(f64) -> f64) -> [f64; 2] {
    whole_nm(range_nm).map(value).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}
