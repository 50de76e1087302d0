//! What became of the light: signal, noise, saturation, and the noise of the render beside that of the sensor.

use super::readout::PixelReading;
use super::sensor::Sensor;

/// What an exposure made of the pixels of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelReport {
    /// The channel.
    pub name: String,
    /// Pixels of this channel, without those that cannot be exposed.
    pub pixels: usize,
    /// Mean over these pixels of the mean number of electrons raised by light.
    pub mean_photo_e: f64,
    /// Mean digital number.
    pub mean_dn: f64,
    /// Signal-to-noise ratio of one pixel with the mean signal: µₑ over its temporal noise ([`Sensor::noise_e`]), as EMVA 1288 defines it.
    pub signal_to_noise: f64,
    /// Pixels whose well is full, or whose digital number is the largest.
    pub saturated: usize,
    /// Pixels whose digital number noise took below 0, where it was cut: the black level is too low for the noise.
    pub below_zero: usize,
    /// Share of the response to an even spectrum that lies outside of the bands of the picture: light there is missing. 0 for a constant
    /// quantum efficiency.
    pub share_outside: f64,
    /// The noise of the render, if the picture states its errors.
    pub render_noise: Option<RenderNoise>,
}

/// The error of the picture itself beside the noise of the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderNoise {
    /// Root mean square over the pixels of the standard error of the picture's light, over that of the sensor's temporal noise. It is an
    /// upper bound: the file does not hold how the errors of bands go together, so they are added up as if they rose and fell together.
    /// `None` if no pixel has a known error and is below saturation.
    pub over_sensor_noise: Option<f64>,
    /// Pixels whose error is not known, because no wavelength or a single replicate fell into a band.
    pub unknown: usize,
}

/// Sums over the pixels of a channel, taken in the order of the pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChannelSums {
    pixels: usize,
    photo_e: f64,
    dn: f64,
    saturated: usize,
    below_zero: usize,
    /// Pixels whose error the picture states, known or not.
    with_error: usize,
    unknown_error: usize,
    render_variance: f64,
    sensor_variance: f64,
}

impl ChannelSums {
    /// Counts a pixel.
    pub(super) fn add(&mut self, sensor: &Sensor, photo_e: f64, error_e: Option<f64>, reading: &PixelReading) {
        self.pixels += 1;
        self.photo_e += photo_e;
        self.dn += reading.dn;
        self.saturated += usize::from(reading.saturated);
        self.below_zero += usize::from(reading.below_zero);
        let Some(error_e) = error_e else { return };
        self.with_error += 1;
        if !error_e.is_finite() {
            self.unknown_error += 1;
        } else if !reading.saturated {
            self.render_variance += error_e * error_e;
            self.sensor_variance += sensor.noise_e(photo_e) * sensor.noise_e(photo_e);
        }
    }

    /// What there is to say of them.
    pub(super) fn report(&self, sensor: &Sensor, name: &str, share_outside: f64) -> ChannelReport {
        let count = self.pixels as f64;
        let mean_photo_e = self.photo_e / count;
        let over_sensor_noise =
            (self.sensor_variance > 0.0).then(|| (self.render_variance / self.sensor_variance).sqrt());
        ChannelReport {
            name: name.to_owned(),
            pixels: self.pixels,
            mean_photo_e,
            mean_dn: self.dn / count,
            signal_to_noise: mean_photo_e / sensor.noise_e(mean_photo_e),
            saturated: self.saturated,
            below_zero: self.below_zero,
            share_outside,
            render_noise: (self.with_error > 0)
                .then_some(RenderNoise { over_sensor_noise, unknown: self.unknown_error }),
        }
    }
}
