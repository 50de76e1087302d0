//! Random numbers of a sensor: each stream is a pure function of (seed, pixel, frame, plane, kind).

use etalon_optics::neg_ln;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rand_xoshiro::{SplitMix64, Xoshiro256PlusPlus};

/// What random numbers are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoiseKind {
    /// Electrons raised by light and heat.
    Shot = 0,
    /// Noise of the readout.
    Read = 1,
    /// Differences in the response of pixels.
    Prnu = 2,
    /// Differences in the dark signal of pixels.
    Dsnu = 3,
}

/// Where a pixel is: column and row in the frame that its picture was cut from, and the number of its plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PixelPlace {
    pub column: i32,
    pub row: i32,
    pub plane: u16,
}

/// Random numbers of one pixel for one purpose.
pub(super) struct Stream(Xoshiro256PlusPlus);

impl Stream {
    pub(super) fn new(seed: u64, place: PixelPlace, frame: u32, kind: NoiseKind) -> Self {
        let pixel = u64::from(place.row.cast_unsigned()) << 32 | u64::from(place.column.cast_unsigned());
        let purpose = u64::from(frame) << 32 | u64::from(place.plane) << 8 | kind as u64;
        Self(Xoshiro256PlusPlus::seed_from_u64(mix(mix(mix(seed) ^ pixel) ^ purpose)))
    }

    /// A number in [0, 1): 53 random bits.
    pub(super) fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// A number of the standard normal distribution, by the polar method of Marsaglia & Bray 1964 (*A Convenient Method for Generating
    /// Normal Variables*, SIAM Review 6). It is never beyond [`MOST_DEVIATION`].
    pub(super) fn gaussian(&mut self) -> f64 {
        loop {
            let (u, v) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let s = u * u + v * v;
            if 0.0 < s && s < 1.0 {
                return u * (2.0 * neg_ln(s) / s).sqrt();
            }
        }
    }
}

/// The largest normal deviate that 53 random bits can give: √(2 ln 2¹⁰⁴) = 12.007.
pub(super) const MOST_DEVIATION: f64 = 12.01;

/// The next number of SplitMix64 after the state `value`: a bijective mixer of 64 bits (Steele, Lea & Flood 2014).
fn mix(value: u64) -> u64 {
    SplitMix64::seed_from_u64(value).next_u64()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_oracle::statistics::{Estimate, chi_square_verdict, normal_upper_tail, z_verdict};

    const PLACE: PixelPlace = PixelPlace { column: 3, row: 5, plane: 0 };

    #[test]
    fn a_stream_follows_from_all_that_it_is_for() {
        let first = |seed, place, frame, kind| Stream::new(seed, place, frame, kind).uniform();
        let one = first(1, PLACE, 0, NoiseKind::Shot);
        assert_eq!(one, first(1, PLACE, 0, NoiseKind::Shot));
        let others = [
            first(2, PLACE, 0, NoiseKind::Shot),
            first(1, PixelPlace { column: 4, ..PLACE }, 0, NoiseKind::Shot),
            first(1, PixelPlace { row: -5, ..PLACE }, 0, NoiseKind::Shot),
            first(1, PixelPlace { plane: 1, ..PLACE }, 0, NoiseKind::Shot),
            first(1, PLACE, 1, NoiseKind::Shot),
            first(1, PLACE, 0, NoiseKind::Read),
            first(1, PixelPlace { column: 5, row: 3, plane: 0 }, 0, NoiseKind::Shot),
        ];
        assert!(others.iter().all(|other| *other != one), "{one} {others:?}");
    }

    /// First numbers of the streams of 65,536 pixels. The significance of each test is 1e-6. The verdict states the bias that it sees:
    /// 0.002 in the mean, about 3 % in the root mean square of 64 cells.
    #[test]
    fn first_numbers_of_neighbouring_pixels_are_uniform_and_normal() {
        let n = 65_536_u32;
        let place = |i: u32| PixelPlace { column: (i % 256) as i32, row: (i / 256) as i32, plane: 0 };
        let mut cells = [0_u64; 64];
        let mut normal = [0_u64; 64];
        let edges: Vec<f64> = (0..63).map(|i| -3.1 + 0.1 * f64::from(i)).collect();
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..n {
            let u = Stream::new(7, place(i), 0, NoiseKind::Shot).uniform();
            cells[(64.0 * u) as usize] += 1;
            let z = Stream::new(7, place(i), 0, NoiseKind::Read).gaussian();
            assert!(z.abs() < MOST_DEVIATION);
            normal[edges.partition_point(|edge| *edge <= z)] += 1;
            sum += z;
            squares += z * z;
        }
        let count = f64::from(n);
        let verdict = chi_square_verdict("uniform", &cells, &[count / 64.0; 64], 1e-6, "first numbers");
        assert!(verdict.pass, "{verdict:?}");
        let above = |i: usize| if i == 0 { 1.0 } else { normal_upper_tail(edges[i - 1]) };
        let expected: Vec<f64> =
            (0..64).map(|i| count * (above(i) - if i == 63 { 0.0 } else { above(i + 1) })).collect();
        let verdict = chi_square_verdict("normal", &normal, &expected, 1e-6, "first deviates");
        assert!(verdict.pass, "{verdict:?}");
        // The variance of z is 1, that of z² is 2.
        for (mean, truth, deviation) in [(sum / count, 0.0, 1.0_f64), (squares / count, 1.0, 2.0_f64.sqrt())] {
            let verdict = z_verdict("moments", &Estimate::new(mean, deviation / count.sqrt()), truth, 0.0, 1e-6);
            assert!(verdict.pass, "{verdict:?}");
        }
    }
}
