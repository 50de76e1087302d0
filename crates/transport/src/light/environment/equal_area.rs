//! The sphere of directions on a square, by a map that keeps solid angle (Clarberg, *Fast Equal-Area Mapping of the
//! (Hemi)Sphere using SIMD*, Journal of Graphics Tools 13(3), 2008).
//!
//! Every texel is the same solid angle, 4π over their number, and shows one colour. So the density is that colour's luminance over
//! the whole, constant in each texel: a texel is chosen by its luminance and a place in it evenly, and shadow rays have no
//! variance but that of what they meet. Where paths run into the sky as well, it is what the luminance is [above its mean](super::above_mean).

use super::above_mean::AboveMean;
use super::cumulative::Cumulative;
use super::{Along, Look};
use crate::light::LightSampling;
use etalon_optics::colour::rec709_luminance;
use etalon_optics::{Real, atan2_turns};
use etalon_scene::Image;
use std::f64::consts::PI;

/// The texels of a square image, chosen by their luminance.
#[derive(Clone, Debug)]
pub(super) struct EqualArea {
    /// Texels along an edge.
    side: usize,
    /// The rows of texels, by their share.
    rows: Cumulative,
    /// The texels of each row.
    columns: Cumulative,
    /// What of the luminance they are chosen by.
    above: AboveMean,
}

impl EqualArea {
    pub(super) fn new(image: &Image, sampling: LightSampling) -> Self {
        let side = image.width as usize;
        let texels = |row: usize| (0..side).map(move |column| rec709_luminance(image.texel(column, row)));
        let above = AboveMean::new(sampling, |above| {
            let sum: f64 = (0..side).flat_map(texels).map(|luminance| above.of(luminance)).sum();
            sum * (4.0 * PI / (side * side) as f64)
        });
        let mut columns = Cumulative::new(side, side);
        let of_rows: Vec<f64> =
            (0..side).map(|row| columns.push(texels(row).map(|luminance| above.of(luminance)))).collect();
        let mut rows = Cumulative::new(side, 1);
        rows.push(of_rows.into_iter());
        Self { side, rows, columns, above }
    }

    /// What of the luminance directions are drawn by.
    pub(super) fn above(&self) -> &AboveMean {
        &self.above
    }

    /// The colours in some directions, and their densities.
    #[inline(always)]
    pub(super) fn look<const W: usize>(&self, image: &Image, wi: &[Along; W]) -> [Look; W] {
        let texel = |share: f64| ((share * self.side as f64) as usize).min(self.side - 1);
        wi.map(|wi| {
            let [u, v] = square(wi);
            let colour = image.texel(texel(u), texel(v));
            Look { colour, density: self.above.density(self.above.of(rec709_luminance(colour))) }
        })
    }

    /// The directions that each `u` in [0, 1)² draws.
    #[inline(always)]
    pub(super) fn sample<const W: usize>(&self, u: [&[f64; W]; 2]) -> [Along; W] {
        let rows = self.rows.choose_each(&[0; W], u[1]);
        let columns = self.columns.choose_each(&rows.map(|(row, _)| row), u[0]);
        let share = |(texel, within): (usize, f64)| (texel as f64 + within) / self.side as f64;
        std::array::from_fn(|k| direction([share(columns[k]), share(rows[k])]))
    }
}

/// Where a unit vector stands: the shares of the width from the left and of the height from the top.
fn square(wi: Along) -> [f64; 2] {
    let level2 = wi.right * wi.right + wi.forward * wi.forward;
    // √(1 − |cos θ|), without cancellation at the poles.
    let r = (level2 / (1.0 + wi.up.abs())).sqrt_nonnegative();
    let turn = 4.0 * atan2_turns(wi.forward.abs(), wi.right.abs());
    let (p, q) = (r * (1.0 - turn), r * turn);
    // The lower half is folded outward over the diagonals.
    let (p, q) = if wi.up < 0.0 { (1.0 - q, 1.0 - p) } else { (p, q) };
    [(p, wi.right), (q, wi.forward)].map(|(size, sign)| 0.5 + 0.5 * size.copysign(sign))
}

/// The unit vector at shares of the width and of the height.
fn direction(at: [f64; 2]) -> Along {
    let [p, q] = at.map(|share| 2.0 * share - 1.0);
    let from_fold = 1.0 - (p.abs() + q.abs());
    let r = 1.0 - from_fold.abs();
    let turn = if r > 0.0 { 0.5 * ((q.abs() - p.abs()) / r + 1.0) } else { 0.5 };
    let (sin, cos) = f64::sin_cos_turns(0.25 * turn);
    let level = r * (2.0 - r * r).sqrt_nonnegative();
    Along { forward: sin.copysign(q) * level, right: cos.copysign(p) * level, up: (1.0 - r * r).copysign(from_fold) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_and_the_sphere_are_inverses() {
        for i in 0..=64 {
            for j in 0..=64 {
                // Off the edges, where places on either side of a fold are the same direction.
                let at = [f64::from(i), f64::from(j)].map(|k| (k + 0.013) / 65.0);
                let wi = direction(at);
                let length2 = wi.forward * wi.forward + wi.right * wi.right + wi.up * wi.up;
                assert!((length2 - 1.0).abs() < 1e-14, "{at:?}: {wi:?}");
                let back = square(wi);
                // √ of a roundoff next to the poles.
                assert!((0..2).all(|k| (back[k] - at[k]).abs() < 1e-12), "{at:?} comes back as {back:?}");
            }
        }
    }

    #[test]
    fn the_middle_is_up_the_corners_are_down_and_edges_face_their_side() {
        for (at, want) in [
            ([0.5, 0.5], [0.0, 0.0, 1.0]),
            ([0.0, 0.0], [0.0, 0.0, -1.0]),
            ([1.0, 0.0], [0.0, 0.0, -1.0]),
            ([1.0, 0.5], [1.0, 0.0, 0.0]),
            ([0.0, 0.5], [-1.0, 0.0, 0.0]),
            ([0.5, 1.0], [0.0, 1.0, 0.0]),
            ([0.5, 0.0], [0.0, -1.0, 0.0]),
        ] {
            let wi = direction(at);
            let got = [wi.right, wi.forward, wi.up];
            assert!((0..3).all(|k| (got[k] - want[k]).abs() < 1e-15), "{at:?}: {got:?} is not {want:?}");
        }
    }

    /// The solid angle of a cell is that of the polygon of its border: each is 4π over their number.
    #[test]
    fn cells_are_of_the_same_solid_angle() {
        const SIDE: usize = 6;
        const STEPS: usize = 400;
        for cell in 0..SIDE * SIDE {
            let corner = [cell % SIDE, cell / SIDE];
            // ∫∫ |∂ω/∂u × ∂ω/∂v| by central differences at midpoints.
            let mut area = 0.0;
            let steps = 24;
            for k in 0..steps * steps {
                let inner = [k % steps, k / steps];
                let at: [f64; 2] =
                    std::array::from_fn(|i| (corner[i] as f64 + (inner[i] as f64 + 0.37) / steps as f64) / SIDE as f64);
                let h = 1.0 / (STEPS * SIDE * steps) as f64;
                let of = |du: f64, dv: f64| {
                    let wi = direction([at[0] + du, at[1] + dv]);
                    [wi.right, wi.forward, wi.up]
                };
                let slope = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| (a[i] - b[i]) / (2.0 * h));
                let (a, b) = (slope(of(h, 0.0), of(-h, 0.0)), slope(of(0.0, h), of(0.0, -h)));
                let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                area += cross.iter().map(|v| v * v).sum::<f64>().sqrt() / (SIDE * steps).pow(2) as f64;
            }
            let want = 4.0 * PI / (SIDE * SIDE) as f64;
            // The determinant is 4π everywhere but across folds, which the points avoid; the rest is h².
            assert!((area / want - 1.0).abs() < 1e-4, "cell {cell}: {area} is not {want}");
        }
    }
}
