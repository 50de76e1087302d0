//! Tables of luminous intensity by direction, and the files that hold them.

mod eulumdat;
mod ies;
mod read;

pub(crate) use read::read_photometry;

use std::f64::consts::TAU;

/// Most values of a table.
pub(crate) const MOST_VALUES: usize = 1 << 20;

/// Luminous intensity by direction: between the angles of the table it is linear in both of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Photometry {
    /// Angles from the nadir of the luminaire, turns, from 0 to ½, ascending. Beyond the first and the last there is no light.
    polar_turns: Vec<f64>,
    /// Angles about it, turns, from 0 to 1, ascending; 0 alone if the light is the same all around.
    azimuth_turns: Vec<f64>,
    /// cd, azimuth by azimuth.
    intensity_cd: Vec<f64>,
}

impl Photometry {
    /// A table of `intensity_cd`, azimuth by azimuth, at angles in degrees. Azimuths begin at 0 and end at 0 (the same all around), 90
    /// (mirrored at both planes), 180 (mirrored at the plane from 0 to 180) or 360; or they run from 90 to 270, mirrored at that plane.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn new(polar_deg: &[f64], azimuth_deg: &[f64], intensity_cd: &[f64]) -> Result<Self, String> {
        let rises = |angles: &[f64]| angles.windows(2).all(|pair| pair[0] < pair[1]);
        if polar_deg.len() < 2 || !rises(polar_deg) {
            return Err("the vertical angles are not two or more that rise".to_owned());
        }
        if !rises(azimuth_deg) {
            return Err("the horizontal angles do not rise".to_owned());
        }
        if !polar_deg.iter().all(|angle| (0.0..=180.0).contains(angle)) {
            return Err("a vertical angle is not from 0 to 180 degrees".to_owned());
        }
        let count = polar_deg.len();
        if intensity_cd.len() != count * azimuth_deg.len() {
            return Err(format!(
                "{} vertical and {} horizontal angles need {} intensities, but there are {}",
                count,
                azimuth_deg.len(),
                count * azimuth_deg.len(),
                intensity_cd.len()
            ));
        }
        if let Some(place) = intensity_cd.iter().position(|value| !(*value >= 0.0 && value.is_finite())) {
            return Err(format!("intensity number {} is {}: it must be 0 or above", place + 1, intensity_cd[place]));
        }
        let (first, last) = match azimuth_deg {
            [first, .., last] => (*first, *last),
            [only] => (*only, *only),
            [] => return Err("there are no horizontal angles".to_owned()),
        };
        let columns = match (first, last) {
            (0.0, 0.0 | 360.0) => columns(azimuth_deg, Some),
            (0.0, 90.0) => [
                columns(azimuth_deg, Some),
                mirrored(azimuth_deg, 180.0),
                shifted(azimuth_deg, 180.0),
                mirrored(azimuth_deg, 360.0),
            ]
            .concat(),
            (0.0, 180.0) => [columns(azimuth_deg, Some), mirrored(azimuth_deg, 360.0)].concat(),
            // At the plane from 90 to 270: an angle a stands for 180 − a too.
            (90.0, 270.0) => {
                [columns(azimuth_deg, Some), mirrored(azimuth_deg, 180.0), mirrored(azimuth_deg, 540.0)].concat()
            }
            _ => {
                return Err(format!(
                    "the horizontal angles run from {first} to {last} degrees; they run from 0 to 0, 90, 180 or 360, or from 90 to 270"
                ));
            }
        };
        Ok(Self::of_columns(columns, polar_deg, intensity_cd))
    }

    /// Columns of the table at angles in degrees, in any order, those at the same angle the same. They reach over the whole circle, or are
    /// one.
    fn of_columns(mut columns: Vec<(f64, usize)>, polar_deg: &[f64], intensity_cd: &[f64]) -> Self {
        columns.sort_by(|a, b| a.0.total_cmp(&b.0));
        columns.dedup_by(|a, b| a.0 == b.0);
        let count = polar_deg.len();
        let of = |column: usize| intensity_cd[column * count..][..count].iter().copied();
        let reaching = Self {
            polar_turns: polar_deg.iter().map(|angle| angle / 360.0).collect(),
            azimuth_turns: columns.iter().map(|(angle, _)| angle / 360.0).collect(),
            intensity_cd: columns.iter().flat_map(|(_, column)| of(*column)).collect(),
        };
        if columns.len() == 1 {
            return reaching;
        }
        // From 0 to a whole turn; a plane of symmetry need not be a column.
        let inner = reaching.azimuth_turns.iter().copied().filter(|turns| *turns > 0.0 && *turns < 1.0);
        let azimuth_turns: Vec<f64> = std::iter::once(0.0).chain(inner).chain([1.0]).collect();
        let at = |azimuth: f64| reaching.polar_turns.iter().map(move |polar| (*polar, azimuth));
        let intensity_cd =
            azimuth_turns.iter().flat_map(|azimuth| at(*azimuth)).map(|(p, a)| reaching.eval(p, a)).collect();
        Self { polar_turns: reaching.polar_turns.clone(), azimuth_turns, intensity_cd }
    }

    /// Intensity, cd, at an angle from the nadir, from 0 to ½ turn, and one about it, from 0 to 1 turn.
    #[inline]
    pub fn eval(&self, polar_turns: f64, azimuth_turns: f64) -> f64 {
        let Some((row, down)) = place(&self.polar_turns, polar_turns) else { return 0.0 };
        let count = self.polar_turns.len();
        let at = |column: usize| {
            let cells = &self.intensity_cd[column * count + row..];
            cells[0] + down * (cells[1] - cells[0])
        };
        match place(&self.azimuth_turns, azimuth_turns) {
            Some((column, across)) => at(column) + across * (at(column + 1) - at(column)),
            // One column, the same all around.
            None => at(0),
        }
    }

    /// Luminous flux, lm: the integral of what [`Photometry::eval`] gives.
    pub fn flux_lm(&self) -> f64 {
        let count = self.polar_turns.len();
        let of_column = |column: usize| -> f64 {
            let cells = &self.intensity_cd[column * count..][..count];
            let of_row = |(angles, values): (&[f64], &[f64])| {
                let [from, to] = [angles[0] * TAU, angles[1] * TAU];
                let slope = (values[1] - values[0]) / (to - from);
                values[0] * from.cos() - values[1] * to.cos() + slope * (to.sin() - from.sin())
            };
            self.polar_turns.windows(2).zip(cells.windows(2)).map(of_row).sum()
        };
        match self.azimuth_turns.len() {
            1 => TAU * of_column(0),
            columns => (1..columns)
                .map(|k| {
                    let width = (self.azimuth_turns[k] - self.azimuth_turns[k - 1]) * TAU;
                    0.5 * width * (of_column(k - 1) + of_column(k))
                })
                .sum(),
        }
    }

    /// The largest intensity, cd.
    pub fn most_cd(&self) -> f64 {
        self.intensity_cd.iter().copied().fold(0.0, f64::max)
    }

    /// The largest angle from the nadir at which there is light, rad.
    pub fn reach_rad(&self) -> f64 {
        let count = self.polar_turns.len();
        let lit = |row: &usize| self.intensity_cd.iter().skip(*row).step_by(count).any(|value| *value > 0.0);
        let last = (0..count).rev().find(lit);
        last.map_or(0.0, |row| self.polar_turns[(row + 1).min(count - 1)] * TAU)
    }
}

/// Between which two of rising numbers one lies, and the share of the second; `None` outside of them all.
#[inline]
fn place(angles: &[f64], angle: f64) -> Option<(usize, f64)> {
    let last = angles.len() - 1;
    if last == 0 || !(angles[0]..=angles[last]).contains(&angle) {
        return None;
    }
    let row = angles.partition_point(|a| *a <= angle).clamp(1, last) - 1;
    Some((row, (angle - angles[row]) / (angles[row + 1] - angles[row])))
}

fn columns(azimuth_deg: &[f64], of: impl Fn(f64) -> Option<f64>) -> Vec<(f64, usize)> {
    azimuth_deg.iter().enumerate().filter_map(|(column, angle)| Some((of(*angle)?, column))).collect()
}

/// The same columns at the angles `sum` − a.
fn mirrored(azimuth_deg: &[f64], sum: f64) -> Vec<(f64, usize)> {
    columns(azimuth_deg, |angle| Some(sum - angle))
}

/// The same columns at the angles a + `by`.
fn shifted(azimuth_deg: &[f64], by: f64) -> Vec<(f64, usize)> {
    columns(azimuth_deg, |angle| Some(angle + by))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetries_fill_the_circle() {
        let polar = [0.0, 90.0];
        let quadrant = Photometry::new(&polar, &[0.0, 45.0, 90.0], &[1.0, 2.0, 1.0, 3.0, 1.0, 4.0]).unwrap();
        for (turns, cd) in
            [(0.0, 2.0), (0.125, 3.0), (0.25, 4.0), (0.375, 3.0), (0.5, 2.0), (0.625, 3.0), (0.75, 4.0), (0.9375, 2.5)]
        {
            assert_eq!(quadrant.eval(0.25, turns), cd, "{turns}");
        }
        let half = Photometry::new(&polar, &[0.0, 180.0], &[1.0, 2.0, 1.0, 4.0]).unwrap();
        assert_eq!([half.eval(0.25, 0.25), half.eval(0.25, 0.75), half.eval(0.125, 0.5)], [3.0, 3.0, 2.5]);
        let other = Photometry::new(&polar, &[90.0, 180.0, 270.0], &[1.0, 2.0, 1.0, 4.0, 1.0, 6.0]).unwrap();
        assert_eq!([0.25, 0.5, 0.75, 0.0, 1.0].map(|turns| other.eval(0.25, turns)), [2.0, 4.0, 6.0, 4.0, 4.0]);
        // Without a column in the plane of symmetry.
        let open =
            Photometry::new(&polar, &[90.0, 150.0, 210.0, 270.0], &[1.0, 2.0, 1.0, 4.0, 1.0, 6.0, 1.0, 2.0]).unwrap();
        assert!((open.eval(0.25, 0.0) - 5.0).abs() < 1e-14 && (open.eval(0.25, 0.5) - 5.0).abs() < 1e-14);
        assert!((open.eval(0.25, 30.0 / 360.0) - 4.0).abs() < 1e-14, "{}", open.eval(0.25, 30.0 / 360.0));
        let all_around = Photometry::new(&[0.0, 60.0], &[0.0], &[8.0, 4.0]).unwrap();
        assert_eq!([all_around.eval(30.0 / 360.0, 0.7), all_around.eval(0.17, 0.1)], [6.0, 0.0]);
        assert!((all_around.reach_rad() - TAU / 6.0).abs() < 1e-15);
    }

    #[test]
    fn flux_is_the_integral_of_intensity() {
        let even = Photometry::new(&[0.0, 90.0, 180.0], &[0.0, 90.0], &[3.0; 6]).unwrap();
        assert!((even.flux_lm() - 6.0 * TAU).abs() < 1e-13);
        let table = [5.0, 3.0, 0.5, 7.0, 2.0, 1.0, 6.0, 4.0, 0.0];
        let uneven = Photometry::new(&[10.0, 40.0, 110.0], &[0.0, 100.0, 360.0], &table).unwrap();
        let n = 2000;
        let sum: f64 = (0..n)
            .flat_map(|i| (0..n).map(move |j| (i, j)))
            .map(|(i, j)| {
                let (polar, azimuth) = ((f64::from(i) + 0.5) / f64::from(n) * 0.5, (f64::from(j) + 0.5) / f64::from(n));
                uneven.eval(polar, azimuth) * (polar * TAU).sin()
            })
            .sum();
        let by_grid = sum * (0.5 * TAU / f64::from(n)) * (TAU / f64::from(n));
        // The jump at the first and the last angle is met to half a step.
        assert!((uneven.flux_lm() - by_grid).abs() < 2e-3 * by_grid, "{} {by_grid}", uneven.flux_lm());
    }
}
