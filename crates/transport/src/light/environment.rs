//! An image of everything around the scene.
//!
//! The image is interpolated between the centres of its texels, so what it shows is made of *cells*, each between four centres:
//! as many columns of them as of texels, the last one across the seam, and one row more, since half a texel is left at each
//! pole, where the image is constant along each meridian.
//!
//! **Sampling.** In a cell the luminance of the radiance is bilinear in longitude and latitude; the density is the bilinear
//! function of the same four corners in longitude and the *cosine* of the polar angle, in which solid angle is uniform. So the
//! factor sin θ is exact, a cell is chosen by the mean of its corners times its solid angle, both inversions are in closed
//! form, and where the image is not black the density is not zero. Within a cell the two functions differ by how the polar
//! angle and its cosine run between two rows: by at most a factor of two, next to the poles.

use super::{LightSample, Target};
use crate::mis::Density;
use crate::spectral::PathSpectrum;
use etalon_geometry::SurfaceId;
use etalon_optics::spectrum::RgbBasis;
use etalon_optics::{Lanes, Real, Vec3, atan2_turns};
use etalon_scene::{EnvironmentImage, Image};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Light from infinity by the colours of an image.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    image: Arc<Image>,
    forward: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    white: PathSpectrum,
    basis: RgbBasis,
    /// Cosines of the polar angles between the rows of cells, from 1 to −1.
    cosines: Vec<f64>,
    /// Cumulative share of each row of cells; the last is 1.
    rows: Vec<f64>,
    /// Cumulative share of each cell in its row, row after row.
    columns: Vec<f64>,
    /// ∫ of the function that the density is proportional to: luminance · sr.
    total: f64,
}

/// Where a direction stands between the centres of texels.
struct Place {
    /// Columns of texels to the left and to the right.
    columns: [usize; 2],
    /// Row of cells; the rows of texels are the one before and this one.
    row: usize,
    /// Share of the right column, of the lower row by angle, and by the cosine of the polar angle.
    across: f64,
    down: f64,
    down_by_cosine: f64,
}

impl EnvironmentLight {
    /// The light of an image, at wavelengths within `range_nm`.
    pub fn new(image: &EnvironmentImage, range_nm: [f64; 2]) -> Self {
        let [forward, right, up] = [image.forward, image.right, image.up].map(Vec3::from_array);
        let (width, height) = (image.image.width as usize, image.image.height as usize);
        let mut cosines: Vec<f64> = (0..height).map(|row| (PI * (row as f64 + 0.5) / height as f64).cos()).collect();
        cosines.insert(0, 1.0);
        cosines.push(-1.0);
        let mut light = Self {
            image: Arc::clone(&image.image),
            forward,
            right,
            up,
            white: PathSpectrum::new(&image.white, range_nm),
            basis: RgbBasis::get(),
            cosines,
            rows: Vec::with_capacity(height + 1),
            columns: Vec::with_capacity((height + 1) * width),
            total: 0.0,
        };
        let mut luminances: [Vec<f64>; 2] = [Vec::new(), light.row_of_luminances(0)];
        let mut whole = 0.0;
        for row in 0..=height {
            luminances.swap(0, 1);
            luminances[1] = light.row_of_luminances(row.min(height - 1));
            let [upper, lower] = &luminances;
            let first = light.columns.len();
            let mut sum = 0.0;
            for j in 0..width {
                let k = if j + 1 == width { 0 } else { j + 1 };
                sum += 0.25 * (upper[j] + upper[k] + lower[j] + lower[k]);
                light.columns.push(sum);
            }
            normalise(&mut light.columns[first..]);
            whole += sum * (TAU / width as f64) * (light.cosines[row] - light.cosines[row + 1]);
            light.rows.push(whole);
        }
        normalise(&mut light.rows);
        light.total = whole;
        light
    }

    /// The spectrum of a texel (1, 1, 1), W·m⁻²·sr⁻¹·nm⁻¹.
    pub fn white(&self) -> &PathSpectrum {
        &self.white
    }

    /// ∫ of the luminance over all directions, sr: what the white would have to shine with from one.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    /// Radiance that arrives from the direction `wi`, in each lane.
    #[inline]
    pub fn lanes<R: Real, const N: usize>(&self, lambda_nm: &Lanes<f64, N>, wi: Vec3<f64>) -> Lanes<R, N> {
        let place = self.place(wi);
        let rgb = self.mix(&place, place.down, |texel| texel);
        Lanes::from_fn(|lane| {
            let nm = lambda_nm[lane];
            R::from_f64(self.basis.reflectance(rgb, nm) * self.white.eval(nm))
        })
    }

    /// The density in sr⁻¹ with which `sample` draws the direction `wi`.
    pub fn density(&self, wi: Vec3<f64>) -> f64 {
        let place = self.place(wi);
        let [luminance] = self.mix(&place, place.down_by_cosine, |texel| [luminance(texel)]);
        luminance / self.total
    }

    /// Draws a direction with `u` in [0, 1)².
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<LightSample> {
        let width = self.image.width as usize;
        let (row, u1) = choose(&self.rows, u[1]);
        let (j, u0) = choose(&self.columns[row * width..(row + 1) * width], u[0]);
        let k = if j + 1 == width { 0 } else { j + 1 };
        let [upper, lower] = self.rows_around(row);
        let corner = |column, row| luminance(self.image.texel(column, row));
        let [a, b, c, d] = [corner(j, upper), corner(k, upper), corner(j, lower), corner(k, lower)];
        let down = linear(u1, a + b, c + d);
        let across = linear(u0, a + down * (c - a), b + down * (d - b));
        let cos = self.cosines[row] + down * (self.cosines[row + 1] - self.cosines[row]);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt_nonnegative();
        // Half a turn from the middle of the image.
        let turns = (j as f64 + 0.5 + across) / width as f64;
        let (sin_phi, cos_phi) = f64::sin_cos_turns(if turns > 1.0 { turns - 1.0 } else { turns });
        let wi = self.up * cos - (self.forward * cos_phi + self.right * sin_phi) * sin;
        let wi = wi.renormalized();
        let density = self.density(wi);
        // Rounding may put the edge of a cell into a black neighbour.
        (density > 0.0).then_some(LightSample {
            wi,
            density: Density::SolidAngle(density),
            target: Target::Infinity,
            surface: SurfaceId::NONE,
            scale: 1.0,
        })
    }

    fn place(&self, wi: Vec3<f64>) -> Place {
        let (width, height) = (self.image.width as usize, self.image.height as usize);
        let (x, y, z) = (wi.dot(self.forward), wi.dot(self.right), wi.dot(self.up));
        // From the centre of the last column, which stands before the seam: 0 to width.
        let column = (0.5 + atan2_turns(y, x)) * width as f64 + 0.5;
        let left = (column as usize).min(width);
        let across = column - left as f64;
        let left = if left == 0 { width - 1 } else { left - 1 };
        let right = if left + 1 == width { 0 } else { left + 1 };
        // In half turns.
        let polar = 2.0 * atan2_turns((x * x + y * y).sqrt(), z);
        let from_centre = polar * height as f64 + 0.5;
        let row = (from_centre as usize).min(height);
        let [above, below] = [self.cosines[row], self.cosines[row + 1]];
        Place {
            columns: [left, right],
            row,
            across,
            down: from_centre - row as f64,
            down_by_cosine: ((above - z) / (above - below)).clamp(0.0, 1.0),
        }
    }

    /// The bilinear mixture of what `of` makes of the four texels around a place, with this share of the lower row.
    fn mix<const C: usize>(&self, place: &Place, down: f64, of: impl Fn([f64; 3]) -> [f64; C]) -> [f64; C] {
        let [left, right] = place.columns;
        let [upper, lower] = self.rows_around(place.row);
        let texel = |column, row| of(self.image.texel(column, row));
        let [a, b, c, d] = [texel(left, upper), texel(right, upper), texel(left, lower), texel(right, lower)];
        std::array::from_fn(|i| {
            let [upper, lower] = [(a[i], b[i]), (c[i], d[i])].map(|(left, right)| left + place.across * (right - left));
            upper + down * (lower - upper)
        })
    }

    /// The rows of texels above and below a row of cells.
    fn rows_around(&self, row: usize) -> [usize; 2] {
        [row.saturating_sub(1), row.min(self.image.height as usize - 1)]
    }

    fn row_of_luminances(&self, row: usize) -> Vec<f64> {
        (0..self.image.width as usize).map(|column| luminance(self.image.texel(column, row))).collect()
    }
}

/// Luminance of linear Rec. 709: zero for black only.
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Makes a cumulative sum end at 1; one of nothing stays 0.
fn normalise(cumulative: &mut [f64]) {
    let whole = cumulative.last().copied().unwrap_or(0.0);
    if whole > 0.0 {
        cumulative.iter_mut().for_each(|sum| *sum /= whole);
    }
}

/// The entry that `u` in [0, 1) chooses, and where between its ends `u` lies, in [0, 1).
fn choose(cumulative: &[f64], u: f64) -> (usize, f64) {
    let i = cumulative.partition_point(|&c| c <= u).min(cumulative.len() - 1);
    let start = if i == 0 { 0.0 } else { cumulative[i - 1] };
    let within = (u - start) / (cumulative[i] - start);
    (i, if within.is_finite() { within.clamp(0.0, f64::ONE_MINUS_EPSILON) } else { 0.5 })
}

/// The number in [0, 1] that `u` draws with a density that runs linearly from `a` to `b`, up to a factor.
fn linear(u: f64, a: f64, b: f64) -> f64 {
    let root = (a * a + u * (b * b - a * a)).sqrt_nonnegative();
    let sum = a + root;
    if sum > 0.0 { (u * (a + b) / sum).min(1.0) } else { u }
}
