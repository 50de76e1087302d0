//! Motion while the shutter is open.

use super::Transform;
use crate::vector::{Matrix, apply, cross, dot, product};

/// A placement through several transforms in the order of their times; before the first and after the last it rests.
///
/// Each transform is taken apart into a translation T, a rotation R and a symmetric stretch S, p ↦ R·S·p + T (the polar
/// decomposition; Shoemake & Duff, *Matrix Animation and Polar Decomposition*, Graphics Interface 1992). Between two keyframes
/// T and S change in proportion to time, and R turns about a fixed axis at a constant rate, the shorter way.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// At least one; neighbours mirror alike and are less than half a turn apart.
    pub keyframes: Vec<Keyframe>,
}

/// A placement at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframe {
    /// When, s.
    pub time_s: f64,
    /// The whole of it.
    pub transform: Transform,
    /// Rows of R.
    pub rotation: [[f64; 3]; 3],
    /// Rows of S: positive definite, or negative definite in a transform that mirrors.
    pub stretch: [[f64; 3]; 3],
}

/// Most steps of the iteration for a polar decomposition: each halves the logarithm of a condition number of 10¹² and less.
const POLAR_STEPS: usize = 100;
/// Keyframes whose rotations are this near half a turn apart do not tell which way: square of the cosine of half the angle.
const HALF_TURN: f64 = 1e-11;

impl Keyframe {
    /// A transform, which can be inverted, at a time.
    ///
    /// The rotation is the limit of X ← (X + X⁻ᵀ)/2 (Higham, *Computing the Polar Decomposition – with Applications*, SIAM J.
    /// Sci. Stat. Comput. 7(4), 1986).
    pub fn new(time_s: f64, transform: Transform) -> Self {
        let largest = transform.linear.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
        let mut x = transform.linear.map(|row| row.map(|v| v / largest));
        for _ in 0..POLAR_STEPS {
            let cofactors = [cross(x[1], x[2]), cross(x[2], x[0]), cross(x[0], x[1])];
            let determinant = dot(x[0], cofactors[0]);
            let next: Matrix =
                std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (x[i][j] + cofactors[i][j] / determinant)));
            let change = (0..9).fold(0.0_f64, |m, k| m.max((next[k / 3][k % 3] - x[k / 3][k % 3]).abs()));
            x = next;
            if change <= 2.0 * f64::EPSILON {
                break;
            }
        }
        let side = if dot(x[0], cross(x[1], x[2])) < 0.0 { -1.0 } else { 1.0 };
        let rotation = x.map(|row| row.map(|v| side * v));
        let stretch = product(&transposed(&rotation), &transform.linear);
        let stretch = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (stretch[i][j] + stretch[j][i])));
        Self { time_s, transform, rotation, stretch }
    }

    /// Whether the transform turns left hands into right ones.
    pub fn mirrors(&self) -> bool {
        self.stretch[0][0] < 0.0
    }

    /// From the rotation of this keyframe to that of another: Rᵀ·R′.
    fn turn_to(&self, other: &Self) -> Matrix {
        product(&transposed(&self.rotation), &other.rotation)
    }

    /// Whether the rotations of two keyframes are half a turn apart, so that neither way is the shorter.
    pub fn is_half_turn_from(&self, other: &Self) -> bool {
        let turn = self.turn_to(other);
        0.25 * (1.0 + turn[0][0] + turn[1][1] + turn[2][2]) < HALF_TURN
    }

    /// The angle from the rotation of this keyframe to that of another, rad.
    pub fn angle_to_rad(&self, other: &Self) -> f64 {
        let (axis, cosine) = axis_and_cosine(&self.turn_to(other));
        (0.5 * dot(axis, axis).sqrt()).atan2(cosine)
    }
}

fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// The axis of a rotation by θ, 2·sin θ long, and cos θ.
fn axis_and_cosine(m: &Matrix) -> ([f64; 3], f64) {
    let axis = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
    (axis, 0.5 * (m[0][0] + m[1][1] + m[2][2] - 1.0))
}

impl Motion {
    /// The transform at a time. That of a keyframe is the keyframe's own to the bit, as is that between two which are the same.
    pub fn at(&self, time_s: f64) -> Transform {
        let after = self.keyframes.iter().position(|key| key.time_s >= time_s);
        let (before, after) = match after {
            None => return self.last().transform.clone(),
            Some(0) => return self.keyframes[0].transform.clone(),
            Some(i) if self.keyframes[i].time_s == time_s => return self.keyframes[i].transform.clone(),
            Some(i) => (&self.keyframes[i - 1], &self.keyframes[i]),
        };
        if before.transform == after.transform {
            return before.transform.clone();
        }
        let share = (time_s - before.time_s) / (after.time_s - before.time_s);
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let stretch: Matrix =
            std::array::from_fn(|i| std::array::from_fn(|j| mix(before.stretch[i][j], after.stretch[i][j])));
        let rotation = product(&before.rotation, &part_of_turn(&before.turn_to(after), share));
        let (a, b) = (before.transform.translation_m, after.transform.translation_m);
        Transform { linear: product(&rotation, &stretch), translation_m: std::array::from_fn(|i| mix(a[i], b[i])) }
    }

    fn last(&self) -> &Keyframe {
        self.keyframes.last().expect("a motion has a keyframe")
    }

    /// The keyframes that decide where things are from one time to another: those between, the last one before and the first one
    /// after.
    pub fn during(&self, [from_s, to_s]: [f64; 2]) -> &[Keyframe] {
        let count = self.keyframes.len();
        let first = self.keyframes.iter().rposition(|key| key.time_s <= from_s).unwrap_or(0);
        let last = self.keyframes.iter().position(|key| key.time_s >= to_s).unwrap_or(count - 1);
        &self.keyframes[first..=last.max(first)]
    }

    /// Whether anything changes from one time to another.
    pub fn moves(&self, during_s: [f64; 2]) -> bool {
        let keyframes = self.during(during_s);
        during_s[0] < during_s[1] && keyframes.iter().any(|key| key.transform != keyframes[0].transform)
    }
}

/// A share of a rotation: about the same axis.
fn part_of_turn(turn: &Matrix, share: f64) -> Matrix {
    let (axis, cosine) = axis_and_cosine(turn);
    let length = dot(axis, axis).sqrt();
    let angle = (0.5 * length).atan2(cosine);
    // Near half a turn the axis is the direction that (Q + 1) leaves, the largest of its columns.
    let direction = if cosine > -0.5 {
        axis.map(|c| if length > 0.0 { c / length } else { 0.0 })
    } else {
        let columns: Matrix = std::array::from_fn(|j| {
            std::array::from_fn(|i| 0.5 * (turn[i][j] + turn[j][i]) - if i == j { cosine } else { 0.0 })
        });
        let longest = columns.iter().copied().max_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b))).unwrap_or(axis);
        let side = if dot(longest, axis) < 0.0 { -1.0 } else { 1.0 };
        let scale = side / dot(longest, longest).sqrt();
        longest.map(|c| c * scale)
    };
    let (s, c) = (angle * share).sin_cos();
    let [x, y, z] = direction;
    let skew: Matrix = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let square = product(&skew, &skew);
    // Rodrigues: 1 + sin·K + (1 − cos)·K².
    std::array::from_fn(|i| {
        std::array::from_fn(|j| f64::from(u8::from(i == j)) + s * skew[i][j] + (1.0 - c) * square[i][j])
    })
}

impl Transform {
    /// A point, m.
    pub(crate) fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let p = apply(&self.linear, p);
        std::array::from_fn(|i| p[i] + self.translation_m[i])
    }
}

/// How a camera moves: as a thing would that stands still in a group which is so placed.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraMotion {
    /// The placements, none of which stretches anything.
    pub motion: Motion,
    /// Where the camera stands in the group: the eye, m.
    pub position_m: [f64; 3],
    /// Its viewing direction there.
    pub forward: [f64; 3],
    /// What is up in its picture there.
    pub up: [f64; 3],
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn turned(axis: [f64; 3], angle: f64) -> Matrix {
        let (s, c) = angle.sin_cos();
        let [x, y, z] = axis;
        let skew: Matrix = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        let square = product(&skew, &skew);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| f64::from(u8::from(i == j)) + s * skew[i][j] + (1.0 - c) * square[i][j])
        })
    }

    proptest! {
        #[test]
        fn a_transform_is_put_together_again(m in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64))) {
            let determinant = dot(m[0], cross(m[1], m[2]));
            prop_assume!(determinant.abs() > 1e-3);
            let key = Keyframe::new(0.0, Transform { linear: m, translation_m: [0.0; 3] });
            let again = product(&key.rotation, &key.stretch);
            let square = product(&transposed(&key.rotation), &key.rotation);
            // The first steps invert m, which loses as many digits as its condition number has: of 400,000 such matrices the
            // worst errs by 3.2 times ε·κ (most by a tenth of it). What they converge to is a rotation to 2.5 ε whatever m was.
            let cofactors = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
            let norm = |m: &Matrix| m.iter().map(|row| dot(*row, *row)).sum::<f64>().sqrt();
            let condition = norm(&m) * norm(&cofactors) / determinant.abs();
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                prop_assert!((again[i][j] - m[i][j]).abs() < 8.0 * f64::EPSILON * condition);
                prop_assert!((square[i][j] - f64::from(u8::from(i == j))).abs() < 8.0 * f64::EPSILON);
            }
            prop_assert_eq!(key.mirrors(), determinant < 0.0);
        }

        /// A wheel that is scaled and moved as it turns is halfway, or at any other share, where its angle says.
        #[test]
        fn between_two_keyframes_angle_and_scale_grow_with_time(
            angle in 0.0..3.1_f64, first in 0.1..10.0_f64, second in 0.1..10.0_f64, share in 0.0..1.0_f64,
        ) {
            let axis = [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0];
            let start = turned([0.0, 0.6, 0.8], 1.0);
            let at = |turn: f64, scale: f64, x: f64| Transform {
                linear: product(&start, &turned(axis, turn)).map(|row| row.map(|v| v * scale)),
                translation_m: [x, 0.0, 1.0],
            };
            let motion = Motion { keyframes: vec![
                Keyframe::new(1.0, at(0.0, first, 3.0)),
                Keyframe::new(3.0, at(angle, second, 5.0)),
            ] };
            let got = motion.at(1.0 + 2.0 * share);
            let expected = at(angle * share, first + (second - first) * share, 3.0 + 2.0 * share);
            for k in 0..9 {
                let (i, j) = (k / 3, k % 3);
                prop_assert!((got.linear[i][j] - expected.linear[i][j]).abs() < 1e-12 * first.max(second));
            }
            prop_assert!((got.translation_m[0] - expected.translation_m[0]).abs() < 1e-14);
        }
    }

    #[test]
    fn keyframes_are_met_to_the_bit_and_rest_before_and_after() {
        let at = |x| Transform { translation_m: [x, 0.1, 0.0], ..Transform::IDENTITY };
        let motion = Motion { keyframes: [0.0, 1.0, 4.0].map(|t| Keyframe::new(t, at(t * t))).into() };
        for (time, x) in [(-1.0, 0.0), (0.0, 0.0), (1.0, 1.0), (4.0, 16.0), (9.0, 16.0), (2.0, 6.0)] {
            assert_eq!(motion.at(time), at(x));
        }
        assert!(motion.moves([0.5, 0.6]) && motion.moves([-1.0, 0.1]));
        assert!(!motion.moves([0.5, 0.5]) && !motion.moves([4.0, 5.0]) && !motion.moves([-2.0, 0.0]));
        assert_eq!(motion.during([1.0, 2.0]).len(), 2);
    }
}
