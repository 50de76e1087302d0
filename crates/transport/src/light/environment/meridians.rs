//! Longitude along rows, latitude along columns.
//!
//! The image is interpolated between the centres of its texels, so what it shows is made of *cells*, each between four centres:
//! as many columns of them as of texels, the last one across the seam, and one row more, since half a texel is left at each
//! pole, where the image is constant along each meridian. (Where the first and the last row lie at the poles, the cells beyond
//! them have no extent.)
//!
//! **Sampling.** In a cell the luminance of the radiance is bilinear in longitude and latitude; the density is the bilinear
//! function of the same four corners in longitude and the *cosine* of the polar angle, in which solid angle is uniform. So the
//! factor sin θ is exact, a cell is chosen by the mean of its corners times its solid angle, both inversions are in closed
//! form, and where the image is not black the density is not zero. Within a cell the two functions differ by how the polar
//! angle and its cosine run between two rows: by at most a factor of two, next to the poles.

use super::cumulative::Cumulative;
use super::{Along, Look, luminance};
use etalon_optics::{Real, atan2_turns};
use etalon_scene::Image;
use std::f64::consts::{PI, TAU};

/// The cells of an image.
#[derive(Clone, Debug)]
pub(super) struct Meridians {
    width: usize,
    height: usize,
    /// Distances of rows in half a turn, and how many of them the first centre lies before the pole's cell ends.
    intervals: f64,
    before: f64,
    /// The last row of cells that has an extent.
    last: usize,
    /// Cosines of the polar angles between the rows of cells, from 1 to −1.
    cosines: Vec<f64>,
    /// The rows of cells, by their share.
    rows: Cumulative,
    /// The cells of each row.
    columns: Cumulative,
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

impl Meridians {
    /// `at_poles`: the first and the last row of texels lie at the poles, not half a row from them.
    pub(super) fn new(image: &Image, at_poles: bool) -> Self {
        let (width, height) = (image.width as usize, image.height as usize);
        let (intervals, first, before, last) =
            if at_poles { (height as f64 - 1.0, 0.0, 1.0, height - 1) } else { (height as f64, 0.5, 0.5, height) };
        let mut cosines: Vec<f64> = (0..height).map(|row| (PI * (row as f64 + first) / intervals).cos()).collect();
        cosines.insert(0, 1.0);
        cosines.push(-1.0);
        let mut columns = Cumulative::new(width, height + 1);
        let luminances_of =
            |row: usize| -> Vec<f64> { (0..width).map(|column| luminance(image.texel(column, row))).collect() };
        let mut luminances: [Vec<f64>; 2] = [Vec::new(), luminances_of(0)];
        let mut of_rows = Vec::with_capacity(height + 1);
        for row in 0..=height {
            luminances.swap(0, 1);
            luminances[1] = luminances_of(row.min(height - 1));
            let [upper, lower] = &luminances;
            let sum = columns.push((0..width).map(|j| {
                let k = if j + 1 == width { 0 } else { j + 1 };
                0.25 * (upper[j] + upper[k] + lower[j] + lower[k])
            }));
            of_rows.push(sum * (TAU / width as f64) * (cosines[row] - cosines[row + 1]));
        }
        let mut rows = Cumulative::new(height + 1, 1);
        let total = rows.push(of_rows.into_iter());
        Self { width, height, intervals, before, last, cosines, rows, columns, total }
    }

    /// ∫ of the luminance over all directions, sr.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    /// The colour in a direction, and its density.
    #[inline]
    pub(super) fn look(&self, image: &Image, wi: Along) -> Look {
        let place = self.place(wi);
        let [left, right] = place.columns;
        // The image along both rows of texels, from which the colour mixes by angle and the density by cosine.
        let [upper, lower] = self.rows_around(place.row).map(|row| {
            let (left, right) = (image.texel(left, row), image.texel(right, row));
            [0, 1, 2].map(|k| left[k] + place.across * (right[k] - left[k]))
        });
        let colour = [0, 1, 2].map(|k| upper[k] + place.down * (lower[k] - upper[k]));
        let [upper, lower] = [luminance(upper), luminance(lower)];
        Look { colour, density: (upper + place.down_by_cosine * (lower - upper)) / self.total }
    }

    /// The direction that `u` in [0, 1)² draws.
    pub(super) fn sample(&self, image: &Image, u: [f64; 2]) -> Along {
        let width = self.width;
        let (row, u1) = self.rows.choose(0, u[1]);
        let (j, u0) = self.columns.choose(row, u[0]);
        let k = if j + 1 == width { 0 } else { j + 1 };
        let [upper, lower] = self.rows_around(row);
        let corner = |column, row| luminance(image.texel(column, row));
        let [a, b, c, d] = [corner(j, upper), corner(k, upper), corner(j, lower), corner(k, lower)];
        let down = linear(u1, a + b, c + d);
        let across = linear(u0, a + down * (c - a), b + down * (d - b));
        let cos = self.cosines[row] + down * (self.cosines[row + 1] - self.cosines[row]);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt_nonnegative();
        // Half a turn from the middle of the image.
        let turns = (j as f64 + 0.5 + across) / width as f64;
        let (sin_phi, cos_phi) = f64::sin_cos_turns(if turns > 1.0 { turns - 1.0 } else { turns });
        Along { forward: -cos_phi * sin, right: -sin_phi * sin, up: cos }
    }

    fn place(&self, wi: Along) -> Place {
        let (x, y, z) = (wi.forward, wi.right, wi.up);
        // From the centre of the last column, which stands before the seam: 0 to width.
        let column = (0.5 + atan2_turns(y, x)) * self.width as f64 + 0.5;
        let left = (column as usize).min(self.width);
        let across = column - left as f64;
        let left = if left == 0 { self.width - 1 } else { left - 1 };
        let right = if left + 1 == self.width { 0 } else { left + 1 };
        // In half turns.
        let polar = 2.0 * atan2_turns((x * x + y * y).sqrt(), z);
        let from_centre = polar * self.intervals + self.before;
        let row = (from_centre as usize).min(self.last);
        let [above, below] = [self.cosines[row], self.cosines[row + 1]];
        Place {
            columns: [left, right],
            row,
            across,
            down: from_centre - row as f64,
            down_by_cosine: ((above - z) / (above - below)).clamp(0.0, 1.0),
        }
    }

    /// The rows of texels above and below a row of cells.
    fn rows_around(&self, row: usize) -> [usize; 2] {
        [row.saturating_sub(1), row.min(self.height - 1)]
    }
}

/// The number in [0, 1] that `u` draws with a density that runs linearly from `a` to `b`, up to a factor.
fn linear(u: f64, a: f64, b: f64) -> f64 {
    let root = (a * a + u * (b * b - a * a)).sqrt_nonnegative();
    let sum = a + root;
    if sum > 0.0 { (u * (a + b) / sum).min(1.0) } else { u }
}
