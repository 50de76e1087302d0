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
//! angle and its cosine run between two rows: by at most a factor of two, next to the poles. Where paths run into the sky as well, corners count
//! by what they are [above the mean](super::above_mean).

use super::above_mean::AboveMean;
use super::cumulative::Cumulative;
use super::{Along, Look};
use crate::light::LightSampling;
use etalon_optics::colour::rec709_luminance;
use etalon_optics::{Real, atan2_turns};
use etalon_scene::Image;
use std::f64::consts::{PI, TAU};

/// The cells of an image.
#[derive(Clone, Debug)]
pub(in crate::light) struct Meridians {
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
    /// What of the luminance they are drawn by.
    above: AboveMean,
}

/// Where a direction stands between the centres of texels.
#[derive(Clone, Copy)]
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

impl Place {
    const FIRST: Self = Self { columns: [0; 2], row: 0, across: 0.0, down: 0.0, down_by_cosine: 0.0 };
}

impl Meridians {
    /// `at_poles`: the first and the last row of texels lie at the poles, not half a row from them.
    pub(in crate::light) fn new(image: &Image, at_poles: bool, sampling: LightSampling) -> Self {
        let (width, height) = (image.width as usize, image.height as usize);
        let (intervals, first, before, last) =
            if at_poles { (height as f64 - 1.0, 0.0, 1.0, height - 1) } else { (height as f64, 0.5, 0.5, height) };
        let mut cosines: Vec<f64> = (0..height).map(|row| (PI * (row as f64 + first) / intervals).cos()).collect();
        cosines.insert(0, 1.0);
        cosines.push(-1.0);
        let solid_angle = |row: usize| (TAU / width as f64) * (cosines[row] - cosines[row + 1]);
        let above = AboveMean::new(sampling, |above| {
            let mut total = 0.0;
            each_row_of_cells(image, above, |row, cells| total += cells.iter().sum::<f64>() * solid_angle(row));
            total
        });
        let mut columns = Cumulative::new(width, height + 1);
        let mut of_rows = Vec::with_capacity(height + 1);
        each_row_of_cells(image, above, |row, cells| {
            of_rows.push(columns.push(cells.iter().copied()) * solid_angle(row))
        });
        let mut rows = Cumulative::new(height + 1, 1);
        rows.push(of_rows.into_iter());
        Self { width, height, intervals, before, last, cosines, rows, columns, above }
    }

    /// What of the luminance directions are drawn by.
    pub(in crate::light) fn above(&self) -> &AboveMean {
        &self.above
    }

    /// The colours in some directions, and their densities.
    #[inline(always)]
    pub(in crate::light) fn look<const W: usize>(&self, image: &Image, wi: &[Along; W]) -> [Look; W] {
        let (mut columns, mut rows) = ([0.0; W], [0.0; W]);
        for k in 0..W {
            [columns[k], rows[k]] = self.coordinates(wi[k]);
        }
        let mut places = [Place::FIRST; W];
        for k in 0..W {
            places[k] = self.place([columns[k], rows[k]], wi[k].up);
        }
        // In a loop of its own: most texels miss the cache, and so they do not wait for one another.
        let mut corners = [[[0.0; 3]; 4]; W];
        for k in 0..W {
            let [left, right] = places[k].columns;
            let [above, below] = self.rows_around(places[k].row);
            corners[k][0] = image.texel(left, above);
            corners[k][1] = image.texel(right, above);
            corners[k][2] = image.texel(left, below);
            corners[k][3] = image.texel(right, below);
        }
        let mut looks = [Look::BLACK; W];
        for k in 0..W {
            looks[k] = self.interpolate(&corners[k], &places[k]);
        }
        looks
    }

    /// The directions that each `u` in [0, 1)² draws.
    #[inline(always)]
    pub(in crate::light) fn sample<const W: usize>(&self, image: &Image, u: [&[f64; W]; 2]) -> [Along; W] {
        // In several loops: those without branches become vector instructions, and what misses the cache is asked for at once.
        let rows = self.rows.choose_each(&[0; W], u[1]);
        let columns = self.columns.choose_each(&rows.map(|(row, _)| row), u[0]);
        let (mut corners, mut cosines, mut left) = ([[0.0; W]; 4], [[0.0; W]; 2], [0.0; W]);
        for k in 0..W {
            let (row, j) = (rows[k].0, columns[k].0);
            let right = if j + 1 == self.width { 0 } else { j + 1 };
            let [upper, lower] = self.rows_around(row);
            for (corner, (column, row)) in
                corners.iter_mut().zip([(j, upper), (right, upper), (j, lower), (right, lower)])
            {
                corner[k] = self.above.of(rec709_luminance(image.texel(column, row)));
            }
            (cosines[0][k], cosines[1][k], left[k]) = (self.cosines[row], self.cosines[row + 1], j as f64);
        }
        let mut wi = [Along::UP; W];
        for k in 0..W {
            let [a, b, c, d] = [corners[0][k], corners[1][k], corners[2][k], corners[3][k]];
            let (u0, u1) = (columns[k].1, rows[k].1);
            let down = linear(u1, a + b, c + d);
            let across = linear(u0, a + down * (c - a), b + down * (d - b));
            let cos = cosines[0][k] + down * (cosines[1][k] - cosines[0][k]);
            let sin = ((1.0 - cos) * (1.0 + cos)).sqrt_nonnegative();
            // Half a turn from the middle of the image.
            let turns = (left[k] + 0.5 + across) / self.width as f64;
            let (sin_phi, cos_phi) = f64::sin_cos_turns(if turns > 1.0 { turns - 1.0 } else { turns });
            wi[k] = Along { forward: -cos_phi * sin, right: -sin_phi * sin, up: cos };
        }
        wi
    }

    /// Where a direction stands: the column, from the centre of the last one, which stands before the seam (0 to the width), and the row
    /// of cells.
    #[inline(always)]
    fn coordinates(&self, wi: Along) -> [f64; 2] {
        let (x, y, z) = (wi.forward, wi.right, wi.up);
        let column = (0.5 + atan2_turns(y, x)) * self.width as f64 + 0.5;
        // In half turns.
        let polar = 2.0 * atan2_turns((x * x + y * y).sqrt(), z);
        [column, polar * self.intervals + self.before]
    }

    #[inline(always)]
    fn place(&self, [column, from_centre]: [f64; 2], up: f64) -> Place {
        let left = (column as usize).min(self.width);
        let across = column - left as f64;
        let left = if left == 0 { self.width - 1 } else { left - 1 };
        let right = if left + 1 == self.width { 0 } else { left + 1 };
        let row = (from_centre as usize).min(self.last);
        let [above, below] = [self.cosines[row], self.cosines[row + 1]];
        Place {
            columns: [left, right],
            row,
            across,
            down: from_centre - row as f64,
            down_by_cosine: ((above - up) / (above - below)).clamp(0.0, 1.0),
        }
    }

    #[inline(always)]
    fn interpolate(&self, texels: &[[f64; 3]; 4], place: &Place) -> Look {
        // Along both rows of texels, from which the colour mixes by angle and the density by cosine.
        let upper = mix(texels[0], texels[1], place.across);
        let lower = mix(texels[2], texels[3], place.across);
        let colour = mix(upper, lower, place.down);
        let mut brightness = [0.0; 4];
        for corner in 0..4 {
            brightness[corner] = self.above.of(rec709_luminance(texels[corner]));
        }
        let [a, b, c, d] = brightness;
        let (upper, lower) = (a + place.across * (b - a), c + place.across * (d - c));
        Look { colour, density: self.above.density(upper + place.down_by_cosine * (lower - upper)) }
    }

    /// The rows of texels above and below a row of cells.
    #[inline(always)]
    fn rows_around(&self, row: usize) -> [usize; 2] {
        [row.saturating_sub(1), row.min(self.height - 1)]
    }
}

/// Gives `put` the rows of cells with the means of their corners.
fn each_row_of_cells(image: &Image, above: AboveMean, mut put: impl FnMut(usize, &[f64])) {
    let (width, height) = (image.width as usize, image.height as usize);
    let texels_of = |row: usize| (0..width).map(move |column| above.of(rec709_luminance(image.texel(column, row))));
    let mut texels: [Vec<f64>; 2] = [Vec::new(), texels_of(0).collect()];
    let mut cells = Vec::with_capacity(width);
    for row in 0..=height {
        texels.swap(0, 1);
        texels[1].clear();
        texels[1].extend(texels_of(row.min(height - 1)));
        let [upper, lower] = &texels;
        cells.clear();
        cells.extend((0..width).map(|j| {
            let k = if j + 1 == width { 0 } else { j + 1 };
            0.25 * (upper[j] + upper[k] + lower[j] + lower[k])
        }));
        put(row, &cells);
    }
}

/// The colour at a share of the way from `a` to `b`.
#[inline(always)]
fn mix(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])]
}

/// The number in [0, 1] that `u` draws with a density that runs linearly from `a` to `b`, up to a factor.
#[inline(always)]
fn linear(u: f64, a: f64, b: f64) -> f64 {
    let root = (a * a + u * (b * b - a * a)).sqrt_nonnegative();
    let sum = a + root;
    if sum > 0.0 { (u * (a + b) / sum).min(1.0) } else { u }
}
