//! A clear or hazy sky with the colours of daylight.

use super::{Perez, SkyCoefficients};
use etalon_optics::colour::{daylight_components, daylight_luminances, daylight_wavelengths_nm, daylight_weights};
use etalon_optics::{Frame, Spectrum, Vec3};

/// The sky of Preetham, Shirley and Smits, *A practical analytic model for daylight*, SIGGRAPH 1999, without the sun itself: luminance and
/// chromaticity by direction, and CIE daylight of each chromaticity.
#[derive(Clone, Debug, PartialEq)]
pub struct DaylightSky {
    /// How much more air with its haze scatters than air alone, from [`Self::TURBIDITIES`].
    pub turbidity: f64,
    /// Unit vector toward the zenith.
    pub up: [f64; 3],
    /// Unit vector toward the sun, not below the horizon.
    pub sun: [f64; 3],
    /// Radiance from below the horizon, in units of that of the zenith.
    pub ground: f64,
    /// The component S₀ of daylight, of the radiance that has a luminance of 1 cd·m⁻² times the sky's scale, W·m⁻²·sr⁻¹·nm⁻¹.
    pub mean: Spectrum,
}

/// What a [`DaylightSky`] shows by direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DaylightPattern {
    up: Vec3<f64>,
    luminance: Perez,
    chromaticity: [Perez; 2],
    /// From below the horizon.
    ground: DaylightLook,
}

/// What a [`DaylightSky`] shows in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DaylightLook {
    /// Its luminance, cd·m⁻² before the sky's scale.
    pub luminance: f64,
    /// What [`DaylightSky::mean`] is multiplied by; the component S₀ of its daylight.
    pub mean: f64,
    /// The weights M₁ and M₂ of its daylight.
    pub weights: [f64; 2],
}

/// How large the spectra of a [`DaylightSky`] are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DaylightExtremes {
    /// The largest factor on [`DaylightSky::mean`].
    pub brightest: f64,
    /// The least value of a spectrum, over the largest of the same.
    pub darkest: f64,
    /// Where that is, nm.
    pub darkest_nm: f64,
}

/// A number that is linear in the turbidity: its factor, and what is added.
type Linear = [f64; 2];

/// a to e of the luminance (table 2 of the paper).
const LUMINANCE: [Linear; 5] =
    [[0.1787, -1.4630], [-0.3554, 0.4275], [-0.0227, 5.3251], [0.1206, -2.5771], [-0.0670, 0.3703]];

/// a to e of the chromaticities x and y.
const CHROMATICITY: [[Linear; 5]; 2] = [
    [[-0.0193, -0.2592], [-0.0665, 0.0008], [-0.0004, 0.2125], [-0.0641, -0.8989], [-0.0033, 0.0452]],
    [[-0.0167, -0.2608], [-0.0950, 0.0092], [-0.0079, 0.2102], [-0.0441, -1.6537], [-0.0109, 0.0529]],
];

/// x and y of the zenith: rows by powers of the turbidity from the second, columns by powers of the sun's angle from the third.
const ZENITH: [[[f64; 4]; 3]; 2] = [
    [
        [0.001_66, -0.003_75, 0.002_09, 0.0],
        [-0.029_03, 0.063_77, -0.032_02, 0.003_94],
        [0.116_93, -0.211_96, 0.060_52, 0.258_86],
    ],
    [
        [0.002_75, -0.006_10, 0.003_17, 0.0],
        [-0.042_14, 0.089_70, -0.041_53, 0.005_16],
        [0.153_46, -0.267_56, 0.066_70, 0.266_88],
    ],
];

impl DaylightSky {
    /// The turbidities for which there is a sky: very clear to a thick haze.
    pub const TURBIDITIES: [f64; 2] = [2.0, 10.0];

    /// What it shows by direction.
    pub fn pattern(&self) -> DaylightPattern {
        let t = self.turbidity;
        let [up, sun] = [self.up, self.sun].map(Vec3::from_array);
        let angle = self.sun_angle_rad();
        let perez = |zenith: f64, numbers: &[Linear; 5]| {
            let [a, b, c, d, e] = numbers.map(|[factor, sum]| factor * t + sum);
            Perez::new(zenith, [up, sun], SkyCoefficients { a, b, c, d, e }, 0.0)
        };
        let chi = (4.0 / 9.0 - t / 120.0) * (std::f64::consts::PI - 2.0 * angle);
        let luminance = 1000.0 * ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192);
        let polynomial = |numbers: &[f64]| numbers.iter().fold(0.0, |sum, number| sum * angle + number);
        let chromaticity = [0, 1].map(|c| {
            let zenith = ZENITH[c].iter().fold(0.0, |sum, row| sum * t + polynomial(row));
            perez(zenith, &CHROMATICITY[c])
        });
        let dark = DaylightLook { luminance: 0.0, mean: 0.0, weights: [0.0; 2] };
        let sky = DaylightPattern { up, luminance: perez(luminance, &LUMINANCE), chromaticity, ground: dark };
        let zenith = sky.look(up);
        let (luminance, mean) = (self.ground * zenith.luminance, self.ground * zenith.mean);
        DaylightPattern { ground: DaylightLook { luminance, mean, ..zenith }, ..sky }
    }

    /// The sun's angle from the zenith, rad.
    fn sun_angle_rad(&self) -> f64 {
        let [up, sun] = [self.up, self.sun].map(Vec3::from_array);
        up.cross(sun).length().atan2(up.dot(sun))
    }

    /// What its spectra are at most and at least, over a grid of directions 2° by 4° and toward the sun, at wavelengths in the range.
    ///
    /// The chromaticities of the model leave those of daylight where the sun is low. Then spectra have negative values.
    pub fn extremes(&self, range_nm: [f64; 2]) -> DaylightExtremes {
        let pattern = self.pattern();
        let [up, sun] = [self.up, self.sun].map(Vec3::from_array);
        let axes = Frame::from_normal(up);
        let directions = (0..=45).flat_map(|row| (0..90).map(move |column| [row, column])).map(|[row, column]| {
            let (height, azimuth) = (f64::from(2 * row).to_radians(), f64::from(4 * column).to_radians());
            let level = axes.s * azimuth.cos() + axes.t * azimuth.sin();
            (axes.n * height.sin() + level * height.cos()).renormalized()
        });
        let rows: Vec<(f64, [f64; 3])> = daylight_wavelengths_nm()
            .filter(|nm| (range_nm[0] - 10.0..=range_nm[1] + 10.0).contains(nm))
            .map(|nm| (nm, daylight_components(nm)))
            .collect();
        let looks = directions.chain([sun]).map(|wi| pattern.look(wi)).chain([pattern.ground]);
        let mut extremes = DaylightExtremes { brightest: 0.0, darkest: f64::INFINITY, darkest_nm: 0.0 };
        for DaylightLook { mean, weights: [m1, m2], .. } in looks {
            let value = |[s0, s1, s2]: [f64; 3]| s0 + m1 * s1 + m2 * s2;
            let largest = rows.iter().map(|(_, row)| value(*row)).fold(0.0, f64::max);
            for &(nm, row) in &rows {
                extremes.brightest = extremes.brightest.max(mean * value(row) / row[0]);
                let share = value(row) / largest;
                if share.is_nan() || share < extremes.darkest {
                    (extremes.darkest, extremes.darkest_nm) = (share, nm);
                }
            }
        }
        extremes
    }
}

impl DaylightPattern {
    /// What the sky shows in the direction of a unit vector.
    #[inline]
    pub fn look(&self, wi: Vec3<f64>) -> DaylightLook {
        let cos = wi.dot(self.up);
        if cos < 0.0 { self.ground } else { self.at(wi, cos) }
    }

    /// The same in a direction above the horizon, of this cosine to the zenith.
    #[inline]
    pub fn at(&self, wi: Vec3<f64>, cos: f64) -> DaylightLook {
        let luminance = self.luminance.at(wi, cos);
        let [m1, m2] = daylight_weights([self.chromaticity[0].at(wi, cos), self.chromaticity[1].at(wi, cos)]);
        let [y0, y1, y2] = daylight_luminances();
        DaylightLook { luminance, mean: luminance * y0 / (y0 + m1 * y1 + m2 * y2), weights: [m1, m2] }
    }

    /// What it shows below the horizon.
    pub fn ground(&self) -> DaylightLook {
        self.ground
    }
}
