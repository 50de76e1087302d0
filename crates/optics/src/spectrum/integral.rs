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

    /// The ends of a range and what lies between them, nm, such that between neighbours it is linear, or at most a nanometre long.
    pub fn borders_nm(&self, range_nm: [f64; 2]) -> Vec<f64> {
        match self {
            Self::Tabulated(_) => range_nm.into_iter().chain(self.kinks_nm(range_nm)).collect(),
            Self::Scaled { spectrum, .. } => spectrum.borders_nm(range_nm),
            _ => whole_nm(range_nm).collect(),
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

/// Simpson's rule over wavelengths: nodes, nm, with their weights, three between any two neighbours of `borders_nm`, which come in any order.
///
/// Exact where the integrand is a cubic or simpler between them. Between whole nanometres better than 1e-9 for a spectrum that does not curve
/// within a nanometre.
pub fn simpson(borders_nm: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
    let mut borders: Vec<f64> = borders_nm.into_iter().collect();
    borders.sort_by(f64::total_cmp);
    let nodes = borders.windows(2).flat_map(|w| {
        // A table that is zero outside jumps at its ends; the borders themselves belong to the inside.
        let inward = 1e-9 * (w[1] - w[0]);
        [(w[0] + inward, 1.0), (0.5 * (w[0] + w[1]), 4.0), (w[1] - inward, 1.0)]
            .map(|(nm, weight)| (nm, weight / 6.0 * (w[1] - w[0])))
    });
    nodes.collect()
}
