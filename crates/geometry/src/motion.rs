//! Placements that change while the shutter is open.
//!
//! A motion is given by poses, each a placement taken apart: p ↦ R·S·p + T with a rotation R and a symmetric stretch S, the
//! polar decomposition of the linear part (Shoemake & Duff, *Matrix Animation and Polar Decomposition*, Graphics Interface
//! 1992). Between two poses T and S change in proportion to time, and R turns about a fixed axis at a constant rate by less
//! than half a turn, which is the spherical interpolation of rotations. A rate of turning makes circles of the paths of points,
//! not polygons: with sine and cosine by polynomials of [`Real::sin_cos_turns`] the placement is exact to rounding at every
//! time, and + − × ÷ are all that it takes.

use crate::shapes::check_points;
use crate::{Aabb, Placement, ShapeError};
use etalon_optics::{Real, Vec3};
use std::f64::consts::TAU;

type Rows = [Vec3<f64>; 3];

/// Symmetric stretches that differ from a multiple of the identity by less than this many unit roundoffs of their largest
/// number are taken for it: what is left of the identity when a rotation is taken apart.
const UNIFORM: f64 = 64.0;
/// How far from half a turn two poses must be, in turns: nearer, rounding would decide which way it is shorter.
const HALF_TURN_MARGIN: f64 = 1e-7;
/// How far RᵀR may be from the identity.
const ORTHOGONAL: f64 = 1e-12;

/// How something is placed at one moment: p ↦ R·S·p + T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// When: 0 as the shutter opens, 1 as it closes; poses may lie before and after.
    pub time: f64,
    /// T, m.
    pub translation: Vec3<f64>,
    /// Rows of R, a rotation.
    pub rotation: [Vec3<f64>; 3],
    /// Rows of S, symmetric: positive definite, or negative definite in a placement that mirrors.
    pub stretch: [Vec3<f64>; 3],
}

/// A placement as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// In the order of time; the first begins at 0 or before, the last ends at 1 or after.
    segments: Vec<Segment>,
    /// Whether S is a multiple of the identity at all times.
    uniform: bool,
}

/// From one pose to the next.
#[derive(Clone, Debug, PartialEq)]
struct Segment {
    start: f64,
    end: f64,
    /// 1/(end − start).
    per_unit: f64,
    /// T at its start, and how much it changes.
    translation: [Vec3<f64>; 2],
    /// S at its start, and how much it changes.
    stretch: [Rows; 2],
    /// R = fixed + across·cos + around·sin of the angle turned.
    fixed: Rows,
    across: Rows,
    around: Rows,
    /// The whole angle, turns.
    turns: f64,
}

impl Motion {
    /// The motion through some poses, in the order of their times. Before the first and after the last everything rests.
    ///
    /// # Errors
    /// If there is no pose, times do not increase, a pose flattens what it places or is not taken apart as [`Pose`] says, one
    /// mirrors and another does not, or two neighbours are half a turn apart.
    pub fn new(poses: &[Pose]) -> Result<Self, ShapeError> {
        let mut poses: Vec<Pose> = poses.to_vec();
        for pose in &mut poses {
            check(pose)?;
            pose.stretch = snapped(pose.stretch);
        }
        let increase = poses.windows(2).all(|pair| pair[0].time < pair[1].time);
        let mirrors = |pose: &Pose| pose.stretch[0].x < 0.0;
        let alike = poses.windows(2).all(|pair| mirrors(&pair[0]) == mirrors(&pair[1]));
        let (Some(&first), Some(&last), true) = (poses.first(), poses.last(), increase && alike) else {
            return Err(ShapeError::Unjoinable);
        };
        if first.time > 0.0 {
            poses.insert(0, Pose { time: 0.0, ..first });
        }
        if last.time < 1.0 || poses.len() == 1 {
            poses.push(Pose { time: last.time.max(0.0) + 1.0, ..last });
        }
        let needed = poses.windows(2).filter(|pair| pair[1].time > 0.0 && pair[0].time < 1.0);
        let segments: Vec<Segment> = needed.map(|pair| Segment::new(&pair[0], &pair[1])).collect::<Result<_, _>>()?;
        let uniform = segments.iter().all(|segment| segment.stretch.iter().all(is_uniform));
        Ok(Self { segments, uniform })
    }

    /// Where it places things at a time from 0 to 1.
    pub fn at(&self, time: f64) -> Placement {
        // Few: a motion has as many segments as the scene file has keyframes.
        let segment = self.segments.iter().find(|segment| time < segment.end).unwrap_or(self.last());
        let (linear, translation) = segment.at(segment.share(time));
        if self.uniform { Placement::of_similarity(linear, translation) } else { Placement::of(linear, translation) }
    }

    /// The same motion in coordinates with this origin and this many units, a power of two, in one of its own.
    #[must_use]
    pub fn framed(&self, origin: Vec3<f64>, per_unit: f64) -> Self {
        let framed = |segment: &Segment| Segment {
            translation: [(segment.translation[0] - origin) * per_unit, segment.translation[1] * per_unit],
            stretch: segment.stretch.map(|rows| rows.map(|row| row * per_unit)),
            ..segment.clone()
        };
        Self { segments: self.segments.iter().map(framed).collect(), ..*self }
    }

    fn last(&self) -> &Segment {
        self.segments.last().expect("a motion has a segment")
    }

    /// A box around all that some boxes within `inner` meet from one time to another.
    ///
    /// Each coordinate of a point is a smooth function of time between two poses. It differs from the straight line through its
    /// values at two times, h apart, by at most h²/8 of the largest magnitude of its second derivative, which is that of
    /// R″·S·p + 2·R′·S′·p: with θ radians turned a unit of time, θ²·|S·p| + 2θ·|S′·p|.
    pub(crate) fn swept(&self, [from, to]: [f64; 2], inner: Aabb, outline: &[Aabb]) -> Aabb {
        let reach = inner.min.abs().max(inner.max.abs()).length();
        let mut swept = Aabb::EMPTY;
        for segment in self.segments.iter().filter(|segment| segment.end >= from && segment.start <= to) {
            let ends = [from.max(segment.start), to.min(segment.end)];
            let bounds = ends.map(|time| {
                let (linear, translation) = segment.at(segment.share(time));
                Placement::of(linear, translation).bounds(inner, outline)
            });
            let step = (ends[1] - ends[0]) * segment.per_unit;
            let angle = segment.turns * TAU;
            let [stretch, change] = &segment.stretch;
            let after: Rows = std::array::from_fn(|i| stretch[i] + change[i]);
            let stretched = norm(stretch).max(norm(&after)) * reach;
            let sagitta = 0.125 * step * step * angle * (angle * stretched + 2.0 * norm(change) * reach);
            // A share more for the rounding of this sum.
            let margin = Vec3::splat(sagitta * (1.0 + 64.0 * f64::EPSILON));
            let [a, b] = bounds;
            let both = a.union(b);
            swept = swept.union(Aabb { min: both.min - margin, max: both.max + margin });
        }
        swept
    }
}

impl Segment {
    fn new(a: &Pose, b: &Pose) -> Result<Self, ShapeError> {
        let columns = transposed(&a.rotation);
        // Q = Rₐᵀ·R_b, as a unit quaternion.
        let q: Rows = std::array::from_fn(|i| {
            let row = columns[i];
            b.rotation[0] * row.x + b.rotation[1] * row.y + b.rotation[2] * row.z
        });
        let [w, vector] = quaternion(&q);
        let length = vector.length();
        let turns = length.atan2(w.x) * (2.0 / TAU);
        if turns > 0.5 - HALF_TURN_MARGIN {
            return Err(ShapeError::Unjoinable);
        }
        let axis = if length > 0.0 { vector / length } else { Vec3::new(0.0, 0.0, 1.0) };
        let onto = [axis * axis.x, axis * axis.y, axis * axis.z];
        let identity = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
        let off: Rows = std::array::from_fn(|i| identity[i] - onto[i]);
        let Vec3 { x, y, z } = axis;
        let cross = [Vec3::new(0.0, -z, y), Vec3::new(z, 0.0, -x), Vec3::new(-y, x, 0.0)];
        let change: Rows = std::array::from_fn(|i| b.stretch[i] - a.stretch[i]);
        Ok(Self {
            start: a.time,
            end: b.time,
            per_unit: 1.0 / (b.time - a.time),
            translation: [a.translation, b.translation - a.translation],
            stretch: [a.stretch, change],
            fixed: product(&a.rotation, &onto),
            across: product(&a.rotation, &off),
            around: product(&a.rotation, &cross),
            turns,
        })
    }

    /// The share of the segment that has passed.
    fn share(&self, time: f64) -> f64 {
        ((time - self.start) * self.per_unit).clamp(0.0, 1.0)
    }

    /// R·S and T.
    fn at(&self, share: f64) -> (Rows, Vec3<f64>) {
        let (sine, cosine) = f64::sin_cos_turns(self.turns * share);
        let rotation: Rows = std::array::from_fn(|i| self.fixed[i] + self.across[i] * cosine + self.around[i] * sine);
        let stretch: Rows = std::array::from_fn(|i| self.stretch[0][i] + self.stretch[1][i] * share);
        (product(&rotation, &stretch), self.translation[0] + self.translation[1] * share)
    }
}

fn check(pose: &Pose) -> Result<(), ShapeError> {
    let Pose { time, translation, rotation, stretch } = pose;
    check_points(&[*translation, Vec3::splat(*time)])?;
    check_points(rotation)?;
    check_points(stretch)?;
    let linear = product(rotation, stretch).map(Vec3::to_array);
    Placement::new(linear, translation.to_array())?;
    let square = product(&transposed(rotation), rotation);
    let orthogonal = (0..3).all(|i| (0..3).all(|j| (square[i][j] - f64::from(u8::from(i == j))).abs() < ORTHOGONAL));
    let turned = rotation[0].cross(rotation[1]).dot(rotation[2]) > 0.0;
    // Sylvester's criterion, of S or of −S.
    let side = if stretch[0].x < 0.0 { -1.0 } else { 1.0 };
    let s = stretch.map(|row| row * side);
    let largest = s.iter().map(|row| row.abs().max_component()).fold(0.0, f64::max);
    let symmetric = (0..3).all(|i| (0..3).all(|j| (s[i][j] - s[j][i]).abs() <= ORTHOGONAL * largest));
    let definite = s[0].x > 0.0 && s[0].x * s[1].y > s[0].y * s[1].x && s[0].cross(s[1]).dot(s[2]) > 0.0;
    if orthogonal && turned && symmetric && definite { Ok(()) } else { Err(ShapeError::Unjoinable) }
}

/// A multiple of the identity, if it is one to rounding.
fn snapped(stretch: Rows) -> Rows {
    let scale = stretch[0].x;
    let near = |i: usize, j: usize| {
        let expected = if i == j { scale } else { 0.0 };
        (stretch[i][j] - expected).abs() <= UNIFORM * f64::UNIT_ROUNDOFF * scale.abs()
    };
    if (0..3).all(|i| (0..3).all(|j| near(i, j))) {
        [Vec3::new(scale, 0.0, 0.0), Vec3::new(0.0, scale, 0.0), Vec3::new(0.0, 0.0, scale)]
    } else {
        stretch
    }
}

fn is_uniform(m: &Rows) -> bool {
    let scale = m[0].x;
    *m == [Vec3::new(scale, 0.0, 0.0), Vec3::new(0.0, scale, 0.0), Vec3::new(0.0, 0.0, scale)]
}

/// At least the largest factor by which a symmetric matrix stretches: that itself of a multiple of the identity, else the
/// Frobenius norm.
fn norm(m: &Rows) -> f64 {
    if is_uniform(m) { m[0].x.abs() } else { m.iter().map(|row| row.length_squared()).sum::<f64>().sqrt() }
}

fn transposed(m: &Rows) -> Rows {
    let [a, b, c] = *m;
    [Vec3::new(a.x, b.x, c.x), Vec3::new(a.y, b.y, c.y), Vec3::new(a.z, b.z, c.z)]
}

fn product(a: &Rows, b: &Rows) -> Rows {
    a.map(|row| b[0] * row.x + b[1] * row.y + b[2] * row.z)
}

/// The unit quaternion of a rotation, its real part not negative: that (three times), and its vector part.
///
/// The largest of the four numbers is found from the diagonal, the others from it (Shepperd, *Quaternion from Rotation Matrix*,
/// Journal of Guidance and Control 1(3), 1978): no rotation loses digits.
fn quaternion(m: &Rows) -> [Vec3<f64>; 2] {
    let trace = m[0].x + m[1].y + m[2].z;
    let squares = [trace, m[0].x, m[1].y, m[2].z];
    let largest = (1..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let from_axes = Vec3::new(m[2].y - m[1].z, m[0].z - m[2].x, m[1].x - m[0].y);
    let (w, vector) = match largest {
        0 => (1.0 + trace, from_axes),
        k => {
            let (i, j) = (k % 3, (k + 1) % 3);
            let k = k - 1;
            let mut vector = [0.0; 3];
            vector[k] = 1.0 + m[k][k] - m[i][i] - m[j][j];
            vector[i] = m[i][k] + m[k][i];
            vector[j] = m[j][k] + m[k][j];
            (from_axes[k], Vec3::from_array(vector))
        }
    };
    let length = (w * w + vector.length_squared()).sqrt();
    let side = if w < 0.0 { -length } else { length };
    [Vec3::splat(w / side), vector / side]
}
