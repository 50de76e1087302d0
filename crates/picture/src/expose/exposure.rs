//! The mean electrons of every pixel, and exposures of them.

use rayon::prelude::*;

use super::photons::{electrons_per_radiance, share_outside};
use super::random::PixelPlace;
use super::readout::{PixelReading, read_pixel};
use super::report::{ChannelReport, ChannelSums};
use super::sensor::{IMAGE_NUMERICAL_APERTURE, Sensor};
use crate::develop::{bands_of, is_radiance};
use crate::{Attribute, Attributes, ERROR_PREFIX, ExrFile, Picture, PictureError, Window};

/// A picture on a sensor: how many electrons its light raises in each pixel, on average.
///
/// [`SensorExposure::frame`] makes as many exposures of it as are wanted.
#[derive(Clone, Debug)]
pub struct SensorExposure {
    sensor: Sensor,
    size: [usize; 2],
    window: Window,
    /// sin θ that is used, and that of the picture's lens, if it states one.
    sines: [f64; 2],
    planes: Vec<Plane>,
    outside: Vec<f64>,
    states_unit: bool,
}

/// One number for each pixel: of all pixels of a mosaic, or of one channel.
#[derive(Clone, Debug)]
struct Plane {
    /// The channel of all its pixels; `None` if the mosaic decides.
    channel: Option<usize>,
    /// Mean electrons raised by light; NaN, infinite or negative where the picture is.
    photo_e: Vec<f64>,
    /// Upper bound on their standard error, if the picture states errors.
    error_e: Option<Vec<f64>>,
}

/// Which exposure is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExposureSettings {
    /// Seed of shot noise and read noise. The fixed pattern has a seed of its own, that of the sensor.
    pub seed: u64,
    /// Number of the exposure: each has other noise.
    pub frame: u32,
    /// Whether the electrons are kept beside the digital numbers.
    pub electrons: bool,
}

/// One exposure.
#[derive(Clone, Debug, PartialEq)]
pub struct RawFrame {
    /// The digital numbers: channel `DN`, or `DN.NAME` for each channel of a sensor whose pixels have several. With
    /// [`ExposureSettings::electrons`] also the electrons in the well (`electrons`) and the mean of those that light raises
    /// (`meanPhotoelectrons`). NaN where the picture's light is no number or negative.
    pub picture: Picture<f32>,
    /// What became of the light, channel by channel.
    pub channels: Vec<ChannelReport>,
    /// Pixels whose light is no number or negative.
    pub unusable: UnusablePixels,
}

/// Pixels that cannot be exposed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnusablePixels {
    /// How many there are.
    pub count: usize,
    /// Column and row of the first, in the picture.
    pub first: Option<[usize; 2]>,
}

impl SensorExposure {
    /// Brings the light of a spectral picture onto a sensor. Each band is even within its ends, which lie half-way to its neighbours.
    ///
    /// # Errors
    /// A picture without at least two spectral bands, or with bands beyond the table of a quantum efficiency. A sensor with impossible numbers.
    pub fn new(file: &ExrFile, sensor: &Sensor) -> Result<Self, PictureError> {
        sensor.check()?;
        let bands = bands_of(&file.picture);
        if bands.is_empty() {
            return Err(PictureError::Expose { why: crate::develop::no_bands().to_string() });
        }
        if bands.len() == 1 {
            return Err(PictureError::expose(
                "the file has a single spectral band, whose width is not known: render with several, such as `--bands 400:700:10`",
            ));
        }
        let of_lens = lens_sine(&file.attributes);
        let Some(sine) = sensor.numerical_aperture.or(of_lens) else {
            return Err(PictureError::expose(
                "neither the sensor nor the picture says how wide the cone of light from the lens is: state \"f_number\" or \"numerical_aperture\"",
            ));
        };
        let edges_nm = crate::develop::band_edges_nm(&bands);
        let weights: Vec<Vec<f64>> = sensor
            .channels
            .iter()
            .map(|channel| electrons_per_radiance(sensor, sine, channel, &edges_nm))
            .collect::<Result<_, _>>()?;
        let radiance: Vec<&[f32]> = bands.iter().map(|band| band.samples).collect();
        let error_of = |name: &str| file.picture.channel(&format!("{ERROR_PREFIX}{name}"));
        let errors: Option<Vec<&[f32]>> = bands.iter().map(|band| error_of(band.channel)).collect();

        let window = file.picture.window();
        let size = [file.picture.width(), file.picture.height()];
        let kinds: Vec<Option<usize>> = match sensor.mosaic {
            Some(_) => vec![None],
            None => (0..sensor.channels.len()).map(Some).collect(),
        };
        let mut exposure = Self {
            sensor: sensor.clone(),
            size,
            window,
            sines: [sine, of_lens.unwrap_or(sine)],
            planes: Vec::new(),
            outside: Vec::new(),
            states_unit: true,
        };
        let planes = kinds.into_iter().map(|channel| {
            let of = |bands: &[&[f32]]| {
                let pixel = |i| weighted_sum(bands, &weights[exposure.channel_at(channel, i)], i);
                (0..size[0] * size[1]).into_par_iter().map(pixel).collect()
            };
            Plane { channel, photo_e: of(&radiance), error_e: errors.as_deref().map(of) }
        });
        exposure.planes = planes.collect();
        exposure.outside = sensor.channels.iter().map(|channel| share_outside(channel, &edges_nm)).collect();
        exposure.states_unit = is_radiance(&file.attributes);
        Ok(exposure)
    }

    /// Whether the file says that its numbers are W·m⁻²·sr⁻¹·nm⁻¹. Otherwise they are read as if it did.
    #[must_use]
    pub fn states_unit(&self) -> bool {
        self.states_unit
    }

    /// sin θ of the cone of light that was used, and that of the lens of the picture, which is the same unless both sensor and picture state one.
    #[must_use]
    pub fn sines(&self) -> [f64; 2] {
        self.sines
    }

    /// Makes one exposure.
    ///
    /// # Errors
    /// Names of channels that an EXR file cannot hold.
    pub fn frame(&self, settings: &ExposureSettings) -> Result<RawFrame, PictureError> {
        let [width, height] = self.size;
        let mut picture = Picture::new(width, height)?.in_frame(self.window)?;
        let mut sums = vec![ChannelSums::default(); self.sensor.channels.len()];
        let mut unusable = vec![false; width * height];
        let mut extra = Vec::new();
        for (number, plane) in self.planes.iter().enumerate() {
            let pixels = (0..width * height).into_par_iter();
            let readings: Vec<_> = pixels.map(|i| self.read(plane, number, i, settings)).collect();
            for (i, reading) in readings.iter().enumerate() {
                let error_e = plane.error_e.as_ref().map(|errors| errors[i]);
                match reading {
                    Some(reading) => {
                        sums[self.channel_at(plane.channel, i)].add(&self.sensor, plane.photo_e[i], error_e, reading);
                    }
                    None => unusable[i] = true,
                }
            }
            let values = |of: fn(&PixelReading) -> f64| -> Vec<f32> {
                readings.iter().map(|reading| reading.as_ref().map_or(f32::NAN, |reading| of(reading) as f32)).collect()
            };
            let name = |what: &str| self.plane_name(what, plane);
            picture.insert(&name("DN"), values(|reading| reading.dn))?;
            if settings.electrons {
                extra.push((name("electrons"), values(|reading| reading.electrons)));
                extra.push((name("meanPhotoelectrons"), plane.photo_e.iter().map(|e| *e as f32).collect()));
            }
        }
        extra.into_iter().try_for_each(|(name, values)| picture.insert(&name, values))?;
        let channels = sums
            .iter()
            .enumerate()
            .map(|(i, sums)| sums.report(&self.sensor, &self.sensor.channels[i].name, self.outside[i]));
        let first = unusable.iter().position(|is| *is).map(|i| [i % width, i / width]);
        let unusable = UnusablePixels { count: unusable.iter().filter(|is| **is).count(), first };
        Ok(RawFrame { picture, channels: channels.collect(), unusable })
    }

    /// What a pixel shows; `None` if its light is no number or negative.
    fn read(&self, plane: &Plane, number: usize, i: usize, settings: &ExposureSettings) -> Option<PixelReading> {
        let photo_e = plane.photo_e[i];
        let [column, row] = self.frame_place(i);
        // At most `MOST_CHANNELS`.
        let place = PixelPlace { column, row, plane: number as u16 };
        let usable = photo_e.is_finite() && photo_e >= 0.0;
        usable.then(|| read_pixel(&self.sensor, photo_e, place, settings.seed, settings.frame))
    }

    /// Column and row in the frame of pixel number `i` of the picture. A part of a picture has the noise that it has in the whole.
    fn frame_place(&self, i: usize) -> [i32; 2] {
        let [x, y] = self.window.origin_px;
        let width = self.size[0];
        // Sides of pictures fit into 31 bits.
        [x.wrapping_add((i % width) as i32), y.wrapping_add((i / width) as i32)]
    }

    /// The channel of a pixel.
    fn channel_at(&self, of_plane: Option<usize>, i: usize) -> usize {
        let [column, row] = self.frame_place(i);
        of_plane.unwrap_or_else(|| self.sensor.mosaic.as_ref().map_or(0, |mosaic| mosaic.at(column, row)))
    }

    fn plane_name(&self, what: &str, plane: &Plane) -> String {
        match plane.channel {
            Some(channel) if self.planes.len() > 1 => format!("{what}.{}", self.sensor.channels[channel].name),
            _ => what.to_owned(),
        }
    }
}

/// sin θ₀ of the compound lens of a picture, if it states one that can be.
fn lens_sine(attributes: &Attributes) -> Option<f64> {
    match attributes.get(IMAGE_NUMERICAL_APERTURE) {
        Some(Attribute::Double(sine)) if *sine > 0.0 && *sine <= 1.0 => Some(*sine),
        _ => None,
    }
}

/// The sum of a pixel's bands. A band that the channel does not respond to has no part in it, whatever its value.
fn weighted_sum(bands: &[&[f32]], weights: &[f64], i: usize) -> f64 {
    let used = bands.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    used.fold(0.0, |sum, (band, weight)| sum + weight * f64::from(band[i]))
}
