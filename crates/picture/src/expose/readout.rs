//! One pixel, from the mean of its electrons to its digital number.

use super::poisson::poisson;
use super::random::{MOST_DEVIATION, NoiseKind, PixelPlace, Stream};
use super::sensor::{MOST_PRNU, Sensor};

/// From this mean on a pixel is full: the probability that it raises no more electrons than the largest full well, 2²⁴, is below
/// 10^(−10⁸).
const CERTAINLY_FULL_E: f64 = 2_147_483_648.0;

// So that the response of a pixel is never negative.
const _: () = assert!(MOST_PRNU * MOST_DEVIATION < 1.0);

/// What a pixel shows after one exposure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelReading {
    /// Electrons in the well.
    pub electrons: f64,
    /// Digital number.
    pub dn: f64,
    /// Whether the well is full, or the digital number the largest.
    pub saturated: bool,
    /// Whether noise took the digital number below 0, where it was cut.
    pub below_zero: bool,
}

/// Reads the pixel at a place in an exposure with a mean of `photo_e` electrons raised by light.
///
/// 1. The response of the pixel differs from the mean by the PRNU; the dark current adds its electrons.
/// 2. The number of electrons has Poisson's distribution, and the full well cuts it.
/// 3. The dark signal of the pixel (DSNU) and the noise of the readout are added, both with normal distributions.
/// 4. The gain makes digital numbers, the black level is added, the sum is rounded to a whole number of the range.
pub(super) fn read_pixel(sensor: &Sensor, photo_e: f64, place: PixelPlace, seed: u64, frame: u32) -> PixelReading {
    let deviate = |scale: f64, seed: u64, frame: u32, kind: NoiseKind| {
        if scale == 0.0 { 0.0 } else { scale * Stream::new(seed, place, frame, kind).gaussian() }
    };
    let pattern = |scale: f64, kind: NoiseKind| deviate(scale, sensor.pattern_seed, 0, kind);

    let response = 1.0 + pattern(sensor.prnu, NoiseKind::Prnu);
    let mean_e = photo_e * response + sensor.dark_e();
    let raised_e = if mean_e < CERTAINLY_FULL_E {
        poisson(mean_e, &mut Stream::new(seed, place, frame, NoiseKind::Shot))
    } else {
        f64::INFINITY
    };
    let electrons = raised_e.min(f64::from(sensor.full_well_e));

    let signal_e = electrons
        + pattern(sensor.dsnu_e, NoiseKind::Dsnu)
        + deviate(sensor.read_noise_e, seed, frame, NoiseKind::Read);
    let level = (signal_e / sensor.gain_e_per_dn + sensor.black_level_dn + 0.5).floor();
    let most = f64::from(sensor.most_dn());
    PixelReading {
        electrons,
        dn: level.clamp(0.0, most),
        saturated: electrons >= f64::from(sensor.full_well_e) || level >= most,
        below_zero: level < 0.0,
    }
}
