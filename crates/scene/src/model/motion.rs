//! Motion: where things are at each time.

use glam::{DAffine3, DMat3, DVec3};

use super::Transform;
use crate::linear::{cofactors, from_rows, largest, rows, unit};

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
        let linear = transform.affine().matrix3;
        let mut x = linear / largest(&linear);
        for _ in 0..POLAR_STEPS {
            let next = (x + cofactors(&x) / x.determinant()) * 0.5;
            let change = largest(&(next - x));
            x = next;
            if change <= 2.0 * f64::EPSILON {
                break;
            }
        }
        let rotation = if x.determinant() < 0.0 { -x } else { x };
        let stretch = rotation.transpose() * linear;
        let stretch = (stretch + stretch.transpose()) * 0.5;
        Self { time_s, transform, rotation: rows(&rotation), stretch: rows(&stretch) }
    }

    /// Whether the transform turns left hands into right ones.
    pub fn mirrors(&self) -> bool {
        self.stretch[0][0] < 0.0
    }

    /// From the rotation of this keyframe to that of another: Rᵀ·R′.
    fn turn_to(&self, other: &Self) -> DMat3 {
        from_rows(self.rotation).transpose() * from_rows(other.rotation)
    }

    /// Whether the rotations of two keyframes are half a turn apart, so that neither way is the shorter.
    pub fn is_half_turn_from(&self, other: &Self) -> bool {
        0.25 * (1.0 + trace(&self.turn_to(other))) < HALF_TURN
    }

    /// The angle from the rotation of this keyframe to that of another, rad.
    pub fn angle_to_rad(&self, other: &Self) -> f64 {
        let (axis, cosine) = axis_and_cosine(&self.turn_to(other));
        (0.5 * axis.length()).atan2(cosine)
    }
}

/// The axis of a rotation by θ, 2·sin θ long, and cos θ.
fn axis_and_cosine(m: &DMat3) -> (DVec3, f64) {
    let axis = DVec3::new(m.y_axis.z - m.z_axis.y, m.z_axis.x - m.x_axis.z, m.x_axis.y - m.y_axis.x);
    (axis, 0.5 * (trace(m) - 1.0))
}

fn trace(m: &DMat3) -> f64 {
    m.x_axis.x + m.y_axis.y + m.z_axis.z
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
        let (from, to) = (from_rows(before.stretch), from_rows(after.stretch));
        let stretch = from + (to - from) * share;
        let rotation = from_rows(before.rotation) * part_of_turn(&before.turn_to(after), share);
        let (from, to) = (DVec3::from(before.transform.translation_m), DVec3::from(after.transform.translation_m));
        DAffine3::from_mat3_translation(rotation * stretch, from + (to - from) * share).into()
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
fn part_of_turn(turn: &DMat3, share: f64) -> DMat3 {
    let (axis, cosine) = axis_and_cosine(turn);
    let length = axis.length();
    let angle = (0.5 * length).atan2(cosine);
    // Near half a turn the axis is the direction that (Q + 1) leaves, the largest of its columns.
    let direction = if cosine > -0.5 {
        if length > 0.0 { axis / length } else { DVec3::X }
    } else {
        let left = (*turn + turn.transpose()) * 0.5 - DMat3::from_diagonal(DVec3::splat(cosine));
        let columns = [left.x_axis, left.y_axis, left.z_axis];
        let longest =
            columns.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(axis);
        longest / longest.length().copysign(longest.dot(axis))
    };
    DMat3::from_axis_angle(direction, angle * share)
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

impl CameraMotion {
    /// Position, viewing direction and up at a time.
    pub fn at(&self, time_s: f64) -> [[f64; 3]; 3] {
        let placed = self.motion.at(time_s).affine();
        let turned = |v: [f64; 3]| unit(placed.matrix3 * DVec3::from(v)).map_or(v, |v| v.to_array());
        [placed.transform_point3(self.position_m.into()).to_array(), turned(self.forward), turned(self.up)]
    }

    /// Whether it moves from one time to another.
    pub fn moves(&self, during_s: [f64; 2]) -> bool {
        self.motion.moves(during_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::norm;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_transform_is_put_together_again(m in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64))) {
            let m = from_rows(m);
            let determinant = m.determinant();
            prop_assume!(determinant.abs() > 1e-3);
            let key = Keyframe::new(0.0, DAffine3::from_mat3(m).into());
            let rotation = from_rows(key.rotation);
            let again = rotation * from_rows(key.stretch);
            let square = rotation.transpose() * rotation;
            // The first steps invert m, which loses as many digits as its condition number has: of 400,000 such matrices the
            // worst errs by 3.2 times ε·κ (most by a tenth of it). What they converge to is a rotation to 2.5 ε whatever m was.
            let condition = norm(&m) * norm(&cofactors(&m)) / determinant.abs();
            prop_assert!(largest(&(again - m)) < 8.0 * f64::EPSILON * condition);
            prop_assert!(largest(&(square - DMat3::IDENTITY)) < 8.0 * f64::EPSILON);
            prop_assert_eq!(key.mirrors(), determinant < 0.0);
        }

        /// A wheel that is scaled and moved as it turns is halfway, or at any other share, where its angle says.
        #[test]
        fn between_two_keyframes_angle_and_scale_grow_with_time(
            angle in 0.0..3.1_f64, first in 0.1..10.0_f64, second in 0.1..10.0_f64, share in 0.0..1.0_f64,
        ) {
            let axis = DVec3::new(2.0, -3.0, 6.0) / 7.0;
            let start = DMat3::from_axis_angle(DVec3::new(0.0, 0.6, 0.8), 1.0);
            let at = |turn: f64, scale: f64, x: f64| {
                let linear = start * DMat3::from_axis_angle(axis, turn) * scale;
                DAffine3::from_mat3_translation(linear, DVec3::new(x, 0.0, 1.0))
            };
            let motion = Motion { keyframes: vec![
                Keyframe::new(1.0, at(0.0, first, 3.0).into()),
                Keyframe::new(3.0, at(angle, second, 5.0).into()),
            ] };
            let got = motion.at(1.0 + 2.0 * share).affine();
            let expected = at(angle * share, first + (second - first) * share, 3.0 + 2.0 * share);
            prop_assert!(largest(&(got.matrix3 - expected.matrix3)) < 1e-12 * first.max(second));
            prop_assert!((got.translation - expected.translation).length() < 1e-14);
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
