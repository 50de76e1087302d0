//! Integrals over wavelengths.

use super::{Outside, Spectrum};

impl Spectrum {
    /// The wavelengths within a range at which it may have a kink, nm, those of CIE illuminants left out: theirs are at whole nanometres.
    pub fn kinks_nm(&self, [first, last]: [f64; 2]) -> Vec<f64> {
        match self {
            Self::Tabulated(table) => {
                table.wavelengths_nm().iter().copied().filter(|nm| (first..=last).contains(nm)).collect()
            }
            Self::Scaled { spectrum, .. } => spectrum.kinks_nm([first, last]),
            Self::Constant(_)
            | Self::Blackbody(_)
            | Self::Illuminant(_)
            | Self::RgbReflectance(_)
            | Self::RgbEmission(_) => Vec::new(),
        }
    }

    /// The wavelengths outside which it is zero, nm, if it says so.
    pub fn support_nm(&self) -> Option<[f64; 2]> {
        match self {
            Self::Tabulated(table) => (table.outside() == Outside::Zero).then(|| table.range_nm()),
            Self::Scaled { spectrum, .. } => spectrum.support_nm(),
            _ => None,
        }
    }
}

/// The ends of a range and the whole nanometres between them.
pub fn whole_nm([first, last]: [f64; 2]) -> impl Iterator<Item = f64> {
    let inner = (1..).map(move |i| first.floor() + f64::from(i)).take_while(move |&nm| nm < last);
    std::iter::once(first).chain(inner).chain(std::iter::once(last))
}

/// Simpson's rule over a range of wavelengths: nodes, nm, with their weights, between whole nanometres and the wavelengths at which the
/// integrand has a kink or jumps.
///
/// Exact where that is a cubic or simpler in between; elsewhere better than 1e-9 for a spectrum that does not curve within a nanometre.
pub fn simpson(range_nm: [f64; 2], kinks_nm: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    let mut borders: Vec<f64> = whole_nm(range_nm).chain(kinks_nm).collect();
    borders.sort_by(f64::total_cmp);
    let nodes = borders.windows(2).flat_map(|w| {
        // A table that is zero outside jumps at its ends; the borders themselves belong to the inside.
        let inward = 1e-9 * (w[1] - w[0]);
        [(w[0] + inward, 1.0), (0.5 * (w[0] + w[1]), 4.0), (w[1] - inward, 1.0)]
            .map(|(nm, weight)| (nm, weight / 6.0 * (w[1] - w[0])))
    });
    nodes.collect()
}
