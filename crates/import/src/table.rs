//! Values by wavelength, as files of other programs state them.

use etalon_optics::spectrum::RgbBasis;
use serde_json::{Value, json};

/// Wavelengths, nm, and values, in the order of the file.
#[derive(Clone, Debug)]
pub(crate) struct Table(pub Vec<(f64, f64)>);

impl Table {
    /// Of wavelengths and values in turn; `None` if they are fewer than two pairs, or not finite.
    pub(crate) fn of_pairs(numbers: &[f64]) -> Option<Self> {
        let whole = numbers.len() >= 4 && numbers.len().is_multiple_of(2) && numbers.iter().all(|v| v.is_finite());
        whole.then(|| Self(numbers.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()))
    }

    /// Of a spectrum of the format, if it is a number or a table.
    pub(crate) fn of_spectrum(spectrum: &Value) -> Option<Self> {
        if let Some(value) = spectrum.as_f64() {
            return Some(Self(vec![(550.0, value)]));
        }
        let list = |key: &str| spectrum[key].as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>();
        Some(Self(list("wavelengths_nm")?.into_iter().zip(list("values")?).collect()))
    }

    /// Of a function, from 360 to 830 nm in steps of 5 nm.
    pub(crate) fn of_function(value: impl Fn(f64) -> f64) -> Self {
        Self((72..=166).map(|step| 5.0 * f64::from(step)).map(|nm| (nm, value(nm))).collect())
    }

    /// Of a colour of the format, whose channels may exceed 1: the smooth spectrum that has it; `None` of anything else.
    pub(crate) fn of_colour(spectrum: &Value) -> Option<Self> {
        let rgb: Vec<f64> = spectrum["rgb"].as_array()?.iter().filter_map(Value::as_f64).collect();
        let rgb: [f64; 3] = rgb.try_into().ok()?;
        let basis = RgbBasis::get();
        Some(Self::of_function(|nm| basis.reflectance(rgb, nm)))
    }

    /// All values times a factor.
    pub(crate) fn times(mut self, factor: f64) -> Self {
        self.0.iter_mut().for_each(|(_, value)| *value *= factor);
        self
    }

    /// As a spectrum of the format.
    pub(crate) fn spectrum(&self, outside: &str) -> Value {
        let (wavelengths, values): (Vec<f64>, Vec<f64>) = self.0.iter().copied().unzip();
        json!({ "type": "tabulated", "wavelengths_nm": wavelengths, "values": values, "outside": outside })
    }

    /// Linear between its wavelengths, constant outside.
    pub(crate) fn at(&self, nm: f64) -> f64 {
        let next = self.0.partition_point(|(known, _)| *known < nm);
        match (next.checked_sub(1).map(|i| self.0[i]), self.0.get(next)) {
            (Some((a, below)), Some(&(b, above))) => below + (above - below) * (nm - a) / (b - a),
            (_, Some(&(_, value))) | (Some((_, value)), None) => value,
            (None, None) => 0.0,
        }
    }

    /// Linear between its wavelengths, zero outside.
    pub(crate) fn at_or_zero(&self, nm: f64) -> f64 {
        match (self.0.first(), self.0.last()) {
            (Some((first, _)), Some((last, _))) if (*first..=*last).contains(&nm) => self.at(nm),
            _ => 0.0,
        }
    }
}

/// A metal of the format by its own n and k, at all wavelengths of either.
pub(crate) fn metal(n: &Table, k: &Table) -> Value {
    let mut wavelengths: Vec<f64> = n.0.iter().chain(&k.0).map(|(nm, _)| *nm).collect();
    wavelengths.sort_by(f64::total_cmp);
    wavelengths.dedup();
    if wavelengths.len() < 2 {
        wavelengths = vec![300.0, 900.0];
    }
    let at = |table: &Table| wavelengths.iter().map(|nm| table.at(*nm)).collect::<Vec<f64>>();
    json!({ "type": "conductor", "wavelengths_nm": wavelengths, "n": at(n), "k": at(k) })
}
