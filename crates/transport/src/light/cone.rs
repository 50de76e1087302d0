//! The round cone, or cylinder, that a lamp shines into.

use crate::media::Way;
use etalon_optics::Vec3;

/// All places beyond a disk of this radius that are nearer to its axis than the radius and the tangent times the distance from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    pub position: Vec3<f64>,
    /// Unit vector.
    pub axis: Vec3<f64>,
    pub radius: f64,
    /// Not below 0.
    pub tangent: f64,
}

impl Cone {
    /// The part of a way that lies in it, as distances; `None` if there is none.
    ///
    /// With the depth z + żt and the distance |a + ȧt| from the axis, it is what has z + żt ≥ 0 of |a + ȧt|² ≤ (r + (z + żt) tan)².
    pub(super) fn part(&self, way: &Way) -> Option<[f64; 2]> {
        let Self { position, axis, radius, tangent } = *self;
        let from = way.origin - position;
        let (depth, deepens) = (from.dot(axis), way.direction.dot(axis));
        let (across, moves) = (from - axis * depth, way.direction - axis * deepens);
        let width = radius + tangent * depth;
        let squares = moves.length_squared() - (tangent * deepens).powi(2);
        let half = across.dot(moves) - tangent * deepens * width;
        let rest = across.length_squared() - width * width;
        let [mut first, mut last] = [0.0, way.length];
        // In front of the disk.
        match deepens {
            _ if deepens > 0.0 => first = f64::max(first, -depth / deepens),
            _ if deepens < 0.0 => last = f64::min(last, -depth / deepens),
            _ if depth < 0.0 => return None,
            _ => {}
        }
        let discriminant = half * half - squares * rest;
        if squares > 0.0 {
            if discriminant <= 0.0 {
                return None;
            }
            let root = discriminant.sqrt();
            // Neither is a small difference of large numbers.
            let sum = if half > 0.0 { -half - root } else { root - half };
            let [a, b] = [sum / squares, rest / sum];
            first = first.max(a.min(b));
            last = last.min(a.max(b));
        } else if discriminant > 0.0 && half != 0.0 {
            // The way enters the cone once, or leaves it once. Of two roots one lies behind the disk.
            let root = discriminant.sqrt();
            let sum = if half > 0.0 { -half - root } else { root - half };
            let (ends, enters) = match squares < 0.0 {
                true => ([rest / sum, sum / squares], deepens > 0.0),
                false => ([rest / sum; 2], half < 0.0),
            };
            match enters {
                true => first = ends.into_iter().fold(first, f64::max),
                false => last = ends.into_iter().fold(last, f64::min),
            }
        } else if squares == 0.0 && rest > 0.0 {
            return None;
        }
        (last > first).then_some([first, last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn holds(cone: &Cone, at: Vec3<f64>) -> bool {
        let from = at - cone.position;
        let depth = from.dot(cone.axis);
        depth >= 0.0 && (from - cone.axis * depth).length() <= cone.radius + cone.tangent * depth
    }

    proptest! {
        #[test]
        fn a_part_holds_what_a_cone_holds(
            from in prop::array::uniform3(-3.0..3.0_f64),
            toward in prop::array::uniform3(-1.0..1.0_f64),
            radius in prop_oneof![Just(0.0), 0.01..1.0_f64],
            tangent in prop_oneof![Just(0.0), 0.0..3.0_f64],
        ) {
            let toward = Vec3::from_array(toward);
            prop_assume!(toward.length() > 0.1 && radius + tangent > 0.0);
            let way = Way { origin: Vec3::from_array(from), direction: toward.normalized(), length: 5.0, time: 0.0 };
            let cone = Cone { position: Vec3::new(0.1, 0.2, -0.1), axis: Vec3::new(0.48, 0.6, 0.64), radius, tangent };
            let [first, last] = cone.part(&way).unwrap_or([f64::NAN; 2]);
            for i in 0..500 {
                let t = 5.0 * (f64::from(i) + 0.5) / 500.0;
                // Rounding decides at the edges.
                if (t - first).abs() > 1e-6 && (t - last).abs() > 1e-6 {
                    let within = t > first && t < last;
                    prop_assert_eq!(within, holds(&cone, way.origin + way.direction * t), "{} {} {}", t, first, last);
                }
            }
        }
    }
}
