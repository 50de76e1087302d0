//! Three spectra that mix as colours do.

use crate::Lanes;
use std::sync::LazyLock;

/// Wavelengths of the table's first and last row, nm, and the step between rows.
const RANGE_NM: [f64; 2] = [360.0, 830.0];
const STEP_NM: f64 = 5.0;

static ROWS: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    include_str!("../../data/rgb-basis-5nm.csv")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let mut numbers = line.split(',').skip(1).map(|number| number.parse().expect("a table of numbers"));
            std::array::from_fn(|_| numbers.next().expect("three columns"))
        })
        .collect()
});

/// Reflectances of the three primaries of linear Rec. 709: whatever they are mixed to shows the mixed colour under D65.
///
/// They are not negative and add up to 1 at every wavelength, so a colour with channels in [0, 1] is a reflectance in
/// [0, 1], a grey is constant, and mixing (interpolation between texels) is exact. The idea is that of Mallett and Yuksel,
/// *Spectral Primary Decomposition for Rendering with sRGB Reflectance*, EGSR 2019; the table is our own, the smoothest at
/// 5 nm for the observer and the white of this crate (see the head of `data/rgb-basis-5nm.csv`).
///
/// [`RgbReflectance`](super::RgbReflectance) shows the same colours by smoother spectra, which do not mix.
#[derive(Clone, Copy, Debug)]
pub struct RgbBasis {
    rows: &'static [[f64; 3]],
}

impl RgbBasis {
    /// The basis; made once, shared by all.
    pub fn get() -> Self {
        Self { rows: &ROWS }
    }

    /// What one unit of red, green and blue reflect at a wavelength in nm; the first and the last value hold outside
    /// 360 to 830 nm.
    #[inline(always)]
    pub fn eval(&self, wavelength_nm: f64) -> [f64; 3] {
        let x = (wavelength_nm.clamp(RANGE_NM[0], RANGE_NM[1]) - RANGE_NM[0]) / STEP_NM;
        let i = (x as usize).min(self.rows.len() - 2);
        let (low, high, share) = (&self.rows[i], &self.rows[i + 1], x - i as f64);
        [low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1]), low[2] + share * (high[2] - low[2])]
    }

    /// What one unit of red, green and blue reflect in each lane.
    #[inline(always)]
    pub fn lanes<const N: usize>(&self, wavelengths_nm: &Lanes<f64, N>) -> [Lanes<f64, N>; 3] {
        let mut lanes = [Lanes::ZERO; 3];
        for lane in 0..N {
            let [red, green, blue] = self.eval(wavelengths_nm[lane]);
            (lanes[0][lane], lanes[1][lane], lanes[2][lane]) = (red, green, blue);
        }
        lanes
    }

    /// The reflectance of a colour in linear Rec. 709 at a wavelength in nm.
    #[inline]
    pub fn reflectance(&self, rgb: [f64; 3], wavelength_nm: f64) -> f64 {
        let basis = self.eval(wavelength_nm);
        rgb[0] * basis[0] + rgb[1] * basis[1] + rgb[2] * basis[2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{inverse, multiply, rgb_to_xyz_matrix, xyz_of};
    use crate::spectrum::Illuminant;

    #[test]
    fn every_mix_shows_its_colour_and_stays_a_reflectance() {
        let basis = RgbBasis::get();
        assert_eq!(ROWS.len(), 95);
        let from_xyz = inverse(&rgb_to_xyz_matrix(xyz_of(|nm| Illuminant::D65.eval(nm))));
        for rgb in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.7, 0.4], [1.0, 1.0, 1.0]] {
            let shown = multiply(&from_xyz, xyz_of(|nm| basis.reflectance(rgb, nm) * Illuminant::D65.eval(nm)));
            for c in 0..3 {
                // The table has 17 digits; what is left is the rounding of 471 sums.
                assert!((shown[c] - rgb[c]).abs() < 1e-12, "{rgb:?} shows {shown:?}");
            }
        }
        for i in 0..=4700 {
            let values = basis.eval(360.0 + 0.1 * f64::from(i));
            assert!(values.iter().all(|v| (0.0..=1.0).contains(v)), "{values:?}");
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{values:?}");
        }
        assert_eq!((basis.eval(100.0), basis.eval(2000.0)), (basis.eval(360.0), basis.eval(830.0)));
    }
}
