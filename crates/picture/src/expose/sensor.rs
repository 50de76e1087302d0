//! An image sensor, and how much light its lens gives it.

use etalon_optics::spectrum::Tabulated;

use crate::PictureError;

/// The largest full well, electrons: 2²⁴, so that a 32-bit float counts every electron.
pub const MOST_FULL_WELL_E: u32 = 1 << 24;
/// Most bits of a digital number.
pub const MOST_BITS: u32 = 16;
/// The largest PRNU. With it, no pixel that normal deviates of 53 random bits can give responds to light with fewer than no electrons.
pub const MOST_PRNU: f64 = 0.08;
/// Most channels of a sensor.
pub const MOST_CHANNELS: usize = 64;
/// Most rows and columns of the unit of a mosaic.
pub const MOST_MOSAIC: usize = 16;

/// The attribute (double) of a picture through a compound lens that states sin θ₀: its pixels are irradiances over π sin²θ₀.
pub const IMAGE_NUMERICAL_APERTURE: &str = "imageNumericalAperture";

/// An image sensor behind a lens: all that decides its digital numbers, but the light and the seed.
///
/// The words are those of the EMVA Standard 1288, release 4.0 Linear (2021). `etalon::SensorFile` reads a sensor from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Side of a square pixel, m. The whole area counts: the quantum efficiency covers fill factor and microlenses.
    pub pixel_pitch_m: f64,
    /// Exposure time, s.
    pub exposure_s: f64,
    /// sin θ of the cone of light from the lens to the middle of the sensor, above 0 and at most 1. For a lens of f-number N that is focused
    /// far away it is 1/(2N). `None`: what the picture of a compound lens states ([`IMAGE_NUMERICAL_APERTURE`]).
    pub numerical_aperture: Option<f64>,
    /// Share of light that the lens lets through, from 0 to 1. A picture through a compound lens has the losses already.
    pub lens_transmittance: f64,
    /// Its kinds of pixels, at least one.
    pub channels: Vec<SensorChannel>,
    /// Which pixel is of which kind. `None`: each pixel has all channels.
    pub mosaic: Option<Mosaic>,
    /// Most electrons that a pixel holds.
    pub full_well_e: u32,
    /// Mean dark current, electrons in a pixel in a second.
    pub dark_current_e_per_s: f64,
    /// Standard deviation of the noise of the readout, electrons.
    pub read_noise_e: f64,
    /// Electrons for one digital number, e⁻/DN: 1/K, where K is the system gain of EMVA 1288.
    pub gain_e_per_dn: f64,
    /// Digital number of no electrons.
    pub black_level_dn: f64,
    /// Bits of a digital number, from 1 to [`MOST_BITS`].
    pub bits: u32,
    /// Photo response nonuniformity: standard deviation of the response of pixels over its mean (0.01 is 1 %).
    pub prnu: f64,
    /// Dark signal nonuniformity: standard deviation of the dark signal of pixels, electrons.
    pub dsnu_e: f64,
    /// Seed of the fixed pattern of PRNU and DSNU. Each seed is another specimen of the sensor.
    pub pattern_seed: u64,
}

/// A kind of pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorChannel {
    /// Its name, such as `R` or `mono`.
    pub name: String,
    /// How many electrons a photon raises.
    pub quantum_efficiency: QuantumEfficiency,
}

/// Electrons for each photon that falls on a pixel, from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub enum QuantumEfficiency {
    /// The same at every wavelength.
    Constant(f64),
    /// By wavelength, linear between the entries. Beyond the table: 0 where it says [`etalon_optics::spectrum::Outside::Zero`], else unknown, and a picture
    /// whose bands reach there is refused.
    Table(Tabulated),
}

/// A pattern of channels that repeats over the sensor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mosaic {
    columns: usize,
    /// Numbers of channels, row after row from the upper left corner of the frame.
    channels: Vec<usize>,
}

impl Mosaic {
    /// The pattern of rows of numbers of channels.
    ///
    /// # Errors
    /// Rows of different lengths, none, or more than [`MOST_MOSAIC`] rows or columns.
    pub fn new(rows: &[Vec<usize>]) -> Result<Self, PictureError> {
        let columns = rows.first().map_or(0, Vec::len);
        if !(1..=MOST_MOSAIC).contains(&rows.len()) || !(1..=MOST_MOSAIC).contains(&columns) {
            let why = format!("a mosaic has from 1 to {MOST_MOSAIC} rows and columns");
            return Err(PictureError::Expose { why });
        }
        if rows.iter().any(|row| row.len() != columns) {
            return Err(PictureError::expose("the rows of a mosaic have the same length"));
        }
        Ok(Self { columns, channels: rows.concat() })
    }

    /// The channel of the pixel in a column and a row of the frame.
    #[must_use]
    pub fn at(&self, column: i32, row: i32) -> usize {
        let rows = self.channels.len() / self.columns;
        // Both are at most `MOST_MOSAIC`.
        let place = |at: i32, of: usize| at.rem_euclid(of as i32) as usize;
        self.channels[place(row, rows) * self.columns + place(column, self.columns)]
    }

    /// The numbers of its channels, row by row.
    pub fn rows(&self) -> impl Iterator<Item = &[usize]> {
        self.channels.chunks_exact(self.columns)
    }
}

impl Sensor {
    /// Mean electrons of the dark current in one exposure.
    #[must_use]
    pub fn dark_e(&self) -> f64 {
        self.dark_current_e_per_s * self.exposure_s
    }

    /// The largest digital number.
    #[must_use]
    pub fn most_dn(&self) -> u32 {
        (1 << self.bits) - 1
    }

    /// Standard deviation of the temporal noise of a pixel, in electrons: √(µₑ + µ_d + σ_r² + g²/12). Light raises µₑ electrons on average and heat µ_d,
    /// σ_r is the noise of the readout, and g²/12 is the noise of quantisation for a gain of g e⁻/DN. It holds below saturation (EMVA 1288,
    /// release 4.0 Linear, chapter 2, noise model).
    #[must_use]
    pub fn noise_e(&self, photo_e: f64) -> f64 {
        let quantisation = self.gain_e_per_dn * self.gain_e_per_dn / 12.0;
        (photo_e + self.dark_e() + self.read_noise_e * self.read_noise_e + quantisation).sqrt()
    }

    /// The first thing that is wrong with its numbers.
    ///
    /// # Errors
    /// A number out of the range that its field states; a mosaic of channels that are not there.
    pub fn check(&self) -> Result<(), PictureError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let non_negative = |value: f64| value >= 0.0 && value.is_finite();
        let share = |value: f64| (0.0..=1.0).contains(&value);
        let efficient = |channel: &SensorChannel| match &channel.quantum_efficiency {
            QuantumEfficiency::Constant(value) => share(*value),
            QuantumEfficiency::Table(table) => table.values().iter().all(|value| share(*value)),
        };
        let count = self.channels.len();
        let mosaic_fits =
            self.mosaic.as_ref().is_none_or(|mosaic| mosaic.channels.iter().all(|channel| *channel < count));
        let rules = [
            (positive(self.pixel_pitch_m), "the pixel pitch is above 0 m"),
            (positive(self.exposure_s), "the exposure time is above 0 s"),
            (
                self.numerical_aperture.is_none_or(|sine| sine > 0.0 && sine <= 1.0),
                "the numerical aperture is above 0 and at most 1",
            ),
            (share(self.lens_transmittance), "the transmittance of the lens is from 0 to 1"),
            ((1..=MOST_CHANNELS).contains(&count), "a sensor has from 1 to 64 channels"),
            (self.channels.iter().all(efficient), "a quantum efficiency is from 0 to 1"),
            (mosaic_fits, "a mosaic consists of channels of the sensor"),
            ((1..=MOST_FULL_WELL_E).contains(&self.full_well_e), "the full well is from 1 to 16777216 electrons"),
            (non_negative(self.dark_current_e_per_s), "the dark current is 0 or above"),
            (non_negative(self.read_noise_e), "the read noise is 0 or above"),
            (positive(self.gain_e_per_dn), "the gain is above 0 e⁻/DN"),
            (non_negative(self.black_level_dn), "the black level is 0 or above"),
            ((1..=MOST_BITS).contains(&self.bits), "a digital number has from 1 to 16 bits"),
            (non_negative(self.prnu) && self.prnu <= MOST_PRNU, "the PRNU is from 0 to 0.08"),
            (non_negative(self.dsnu_e), "the DSNU is 0 or above"),
        ];
        match rules.into_iter().find(|(holds, _)| !holds) {
            Some((_, rule)) => Err(PictureError::expose(format!("the sensor cannot be: {rule}"))),
            None => Ok(()),
        }
    }
}
