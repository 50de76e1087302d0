//! Light stated in photometric units: a number, and the spectrum that it has.

use etalon_optics::Spectrum;
use etalon_optics::colour::{LUMINOUS_EFFICACY, cie_y_integral_nm, luminance_of};

use super::spectra::{BRIGHTEST, Role, Spectra};
use super::spectrum::SpectrumForm;
use crate::json::{Code, NonNegative, Optional, Reader, Span, Spanned};

/// The spectrum of a light of `value` in a photometric unit, shaped like `shape`: `value` = K ∫ S ȳ dλ over all wavelengths that are seen,
/// K = 683.002 lm/W, whatever wavelengths are rendered. Without a shape it is the same at every wavelength.
pub(crate) fn photometric<'f>(
    value: f64,
    at: Span,
    shape: &'f Optional<Box<SpectrumForm>>,
    spectra: &mut Spectra<'f>,
    reader: &mut Reader<'_>,
) -> Option<Spectrum> {
    let spectrum = match shape {
        Optional::Absent => Spectrum::ONE,
        Optional::Given(form) => spectra.resolve(form, Role::Emission, reader)?,
        Optional::Invalid => return None,
    };
    let of_shape = LUMINOUS_EFFICACY * cie_y_integral_nm() * luminance_of(|nm| spectrum.eval(nm));
    let factor = value / of_shape;
    if !(of_shape > 0.0 && factor.is_finite()) {
        let at = shape.given().map_or(at, |form| form.at().head());
        let message = "a light of this spectrum is invisible: it cannot be stated in photometric units";
        reader.error(Code::OutOfRange, at, message);
        return None;
    }
    let scaled = spectrum.scaled(factor).ok()?;
    let largest = scaled.max_over(spectra.range_nm?);
    if largest > BRIGHTEST || largest.is_nan() {
        reader.error(Code::OutOfRange, at, format!("an emission of {largest:e} is more than {BRIGHTEST:e}"));
        return None;
    }
    Some(scaled)
}

/// A light that one of several keys states: the spectrum itself, or a number in a photometric unit, which is multiplied by a factor.
pub(crate) fn stated<'f>(
    radiometric: &'f Optional<Box<SpectrumForm>>,
    photometric_keys: &[(&Optional<Spanned<NonNegative>>, f64)],
    shape: &'f Optional<Box<SpectrumForm>>,
    spectra: &mut Spectra<'f>,
    reader: &mut Reader<'_>,
) -> Option<Spectrum> {
    if let Some(form) = radiometric.given() {
        return spectra.resolve(form, Role::Emission, reader);
    }
    let (number, factor) = photometric_keys.iter().find_map(|(key, factor)| Some((key.given()?, *factor)))?;
    photometric(number.value.0 * factor, number.at, shape, spectra, reader)
}
