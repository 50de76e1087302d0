//! The primitives of a small scene, as the filters want them.

use crate::PrimitiveId;
use crate::double_double::{cross, difference, round};
use crate::frame::Frame;
use crate::query::power_of_two;
use etalon_optics::Vec3;

/// Primitives of a block.
pub(crate) const BLOCK: usize = 16;
/// What stands for no primitive where ids are numbers.
pub(crate) const NO_ID: f32 = -1.0;

/// One number for each primitive.
type Row = [f32; BLOCK];

/// Sixteen triangles, parallelograms or squares around disks, in the accelerator's frame, rounded. NaN in empty lanes, which no
/// filter keeps.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Flats {
    /// A corner.
    pub(crate) corner: [Row; 3],
    /// The edge a from it to the next corner, scaled by a power of two so that the larger edge's largest component is in [1, 2).
    pub(crate) a: [Row; 3],
    /// The edge to the one before, negated, at the same scale.
    pub(crate) minus_b: [Row; 3],
    /// Their product b × a, at that scale once.
    pub(crate) normal: [Row; 3],
    /// 48 roundoffs of its largest component: see `filter`. Infinite if the filter can know no distance.
    pub(crate) t_error: Row,
    /// 1 for triangles, else 0.
    pub(crate) triangle: Row,
    /// Ids, as numbers.
    pub(crate) id: Row,
}

/// Sixteen spheres, likewise.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Spheres {
    pub(crate) centre: [Row; 3],
    pub(crate) radius: Row,
    pub(crate) id: Row,
}

const EMPTY: Row = [f32::NAN; BLOCK];

impl Flats {
    pub(crate) const EMPTY: Self = Self {
        corner: [EMPTY; 3],
        a: [EMPTY; 3],
        minus_b: [EMPTY; 3],
        normal: [EMPTY; 3],
        t_error: EMPTY,
        triangle: EMPTY,
        id: EMPTY,
    };

    /// Puts a shape into a lane, given by three corners, the first between its neighbours.
    pub(crate) fn set(
        &mut self,
        lane: usize,
        frame: &Frame,
        id: PrimitiveId,
        [corner, a, b]: [Vec3<f64>; 3],
        kind: Kind,
    ) {
        // Differences of two numbers are right to a roundoff of themselves.
        let (ea, eb) = ((a - corner) / frame.unscale(), (b - corner) / frame.unscale());
        let magnitude = ea.abs().max(eb.abs()).max_component();
        let exponent = ((magnitude.to_bits() >> 52) as i64 - 1023).clamp(-900, 900);
        let scale = power_of_two(-exponent);
        // In double-double arithmetic: the normal of a sliver cancels.
        let n = round(cross(difference(b, corner), difference(a, corner)));
        let normal = n / frame.unscale() / frame.unscale() * scale;
        put(&mut self.corner, lane, frame.point(corner).map(f64::from));
        put(&mut self.a, lane, (ea * scale).to_array());
        put(&mut self.minus_b, lane, (eb * -scale).to_array());
        put(&mut self.normal, lane, normal.to_array());
        let size = normal.abs().max_component();
        // Below this, products with it could underflow. A disk is only part of its square.
        let known = size > 1e-30 && !matches!(kind, Kind::Disk);
        self.t_error[lane] = if known { (size * (48.0 * 0.5)) as f32 * f32::EPSILON } else { f32::INFINITY };
        self.triangle[lane] = if matches!(kind, Kind::Triangle) { 1.0 } else { 0.0 };
        self.id[lane] = id.0 as f32;
    }
}

impl Spheres {
    pub(crate) const EMPTY: Self = Self { centre: [EMPTY; 3], radius: EMPTY, id: EMPTY };

    pub(crate) fn set(&mut self, lane: usize, frame: &Frame, id: PrimitiveId, centre: Vec3<f64>, radius: f64) {
        put(&mut self.centre, lane, frame.point(centre).map(f64::from));
        self.radius[lane] = frame.length(radius);
        self.id[lane] = id.0 as f32;
    }
}

fn put(rows: &mut [Row; 3], lane: usize, v: [f64; 3]) {
    for (row, c) in rows.iter_mut().zip(v) {
        row[lane] = c as f32;
    }
}

/// Which flat shape a lane holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Triangle,
    Parallelogram,
    Disk,
}
