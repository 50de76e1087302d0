//! Spectra, indices of refraction and colours, over arrays of 64-bit floats.

use etalon::optics::colour::{self, rec709_from_xyz, rec709_to_xyz};
use etalon::optics::index::OutsideFit;
use etalon::optics::spectrum::{Blackbody, RgbEmission, RgbReflectance};
use etalon::optics::{ComplexIndex, Illuminant, OpticsError, RefractiveIndex};
use pyo3::prelude::*;
use pyo3::types::PyByteArray;

use crate::errors::setting;
use crate::picture::doubles;

type Array<'py> = PyResult<Bound<'py, PyByteArray>>;

fn of_bytes(bytes: &[u8]) -> impl ExactSizeIterator<Item = f64> {
    bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_ne_bytes(*bytes))
}

/// `N` numbers for each.
fn mapped<'py, const N: usize>(py: Python<'py>, bytes: &[u8], of: impl Fn(f64) -> [f64; N]) -> Array<'py> {
    let values: Vec<f64> = of_bytes(bytes).flat_map(of).collect();
    doubles(py, values.into_iter())
}

/// Three numbers for each three.
fn mapped_colours<'py>(py: Python<'py>, bytes: &[u8], of: impl Fn([f64; 3]) -> [f64; 3]) -> Array<'py> {
    let numbers: Vec<f64> = of_bytes(bytes).collect();
    let values: Vec<f64> = numbers.as_chunks::<3>().0.iter().flat_map(|colour| of(*colour)).collect();
    doubles(py, values.into_iter())
}

fn refused(py: Python<'_>) -> impl Fn(OpticsError) -> PyErr {
    move |error| setting(py, error.to_string())
}

fn unknown<'a>(py: Python<'_>, what: &str, name: &str, names: impl Iterator<Item = &'a str>) -> PyErr {
    setting(py, format!("there is no {what} {name:?}: {}", names.collect::<Vec<_>>().join(", ")))
}

/// The closed range of some wavelengths; `None` without any.
fn range(wavelengths_nm: &[u8]) -> Option<[f64; 2]> {
    let least = of_bytes(wavelengths_nm).reduce(f64::min)?;
    Some([least, of_bytes(wavelengths_nm).fold(least, f64::max)])
}

fn outside(clamp: bool) -> OutsideFit {
    if clamp { OutsideFit::Clamp } else { OutsideFit::Error }
}

/// Names of the illuminants.
#[pyfunction]
pub(crate) fn illuminants() -> Vec<&'static str> {
    Illuminant::ALL.map(Illuminant::name).to_vec()
}

fn named_illuminant(py: Python<'_>, name: &str) -> PyResult<Illuminant> {
    Illuminant::named(name).ok_or_else(|| unknown(py, "illuminant", name, illuminants().into_iter()))
}

/// Relative power of an illuminant.
#[pyfunction]
pub(crate) fn illuminant<'py>(py: Python<'py>, name: &str, wavelengths_nm: &[u8]) -> Array<'py> {
    let illuminant = named_illuminant(py, name)?;
    mapped(py, wavelengths_nm, |nm| [illuminant.eval(nm)])
}

/// Spectral radiance of a black body.
#[pyfunction]
pub(crate) fn blackbody<'py>(py: Python<'py>, temperature_k: f64, wavelengths_nm: &[u8]) -> Array<'py> {
    let body = Blackbody::new(temperature_k, 1.0).map_err(refused(py))?;
    mapped(py, wavelengths_nm, |nm| [body.eval(nm)])
}

/// Names of the glasses and liquids.
#[pyfunction]
pub(crate) fn glasses() -> Vec<&'static str> {
    RefractiveIndex::names().collect()
}

fn named_glass(py: Python<'_>, name: &str) -> PyResult<RefractiveIndex> {
    RefractiveIndex::named(name).ok_or_else(|| unknown(py, "glass", name, RefractiveIndex::names()))
}

/// Index of refraction of a glass.
#[pyfunction]
pub(crate) fn glass<'py>(py: Python<'py>, name: &str, wavelengths_nm: &[u8], clamp: bool) -> Array<'py> {
    let index = named_glass(py, name)?.with_outside(outside(clamp));
    if let Some(range) = range(wavelengths_nm) {
        index.check_range(range).map_err(refused(py))?;
    }
    mapped(py, wavelengths_nm, |nm| [index.eval(nm)])
}

/// Abbe number of a glass.
#[pyfunction]
pub(crate) fn abbe_number(py: Python<'_>, name: &str) -> PyResult<f64> {
    Ok(named_glass(py, name)?.abbe_number())
}

/// Names of the metals.
#[pyfunction]
pub(crate) fn metals() -> Vec<&'static str> {
    ComplexIndex::names().collect()
}

/// n and k of a metal.
#[pyfunction]
pub(crate) fn metal<'py>(py: Python<'py>, name: &str, wavelengths_nm: &[u8], clamp: bool) -> Array<'py> {
    let index = ComplexIndex::named(name).ok_or_else(|| unknown(py, "metal", name, ComplexIndex::names()))?;
    let index = index.with_outside(outside(clamp));
    if let Some(range) = range(wavelengths_nm) {
        index.check_range(range).map_err(refused(py))?;
    }
    mapped(py, wavelengths_nm, |nm| {
        let (n, k) = index.eval(nm);
        [n, k]
    })
}

/// A reflectance with this colour under D65.
#[pyfunction]
pub(crate) fn reflectance_of_rgb<'py>(py: Python<'py>, rgb: [f64; 3], wavelengths_nm: &[u8]) -> Array<'py> {
    let spectrum = RgbReflectance::new(rgb).map_err(refused(py))?;
    mapped(py, wavelengths_nm, |nm| [spectrum.eval(nm)])
}

/// An emission of this colour.
#[pyfunction]
pub(crate) fn emission_of_rgb<'py>(py: Python<'py>, rgb: [f64; 3], white: &str, wavelengths_nm: &[u8]) -> Array<'py> {
    let spectrum = RgbEmission::new(rgb, named_illuminant(py, white)?).map_err(refused(py))?;
    mapped(py, wavelengths_nm, |nm| [spectrum.eval(nm)])
}

/// The CIE 1931 2° colour matching functions.
#[pyfunction]
pub(crate) fn colour_matching<'py>(py: Python<'py>, wavelengths_nm: &[u8]) -> Array<'py> {
    mapped(py, wavelengths_nm, colour::colour_matching)
}

/// Linear Rec. 709 of CIE XYZ.
#[pyfunction]
pub(crate) fn xyz_to_rgb<'py>(py: Python<'py>, xyz: &[u8]) -> Array<'py> {
    mapped_colours(py, xyz, rec709_from_xyz)
}

/// CIE XYZ of linear Rec. 709.
#[pyfunction]
pub(crate) fn rgb_to_xyz<'py>(py: Python<'py>, rgb: &[u8]) -> Array<'py> {
    mapped_colours(py, rgb, rec709_to_xyz)
}

/// The sRGB signal of linear light.
#[pyfunction]
pub(crate) fn srgb_encode<'py>(py: Python<'py>, linear: &[u8]) -> Array<'py> {
    mapped(py, linear, |value| [colour::srgb_encode(value)])
}

/// Linear light of an sRGB signal.
#[pyfunction]
pub(crate) fn srgb_decode<'py>(py: Python<'py>, signal: &[u8]) -> Array<'py> {
    mapped(py, signal, |value| [colour::srgb_decode(value)])
}
