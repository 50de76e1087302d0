//! Eight rays at once, as structures of arrays: what a path tracer that follows eight paths asks for.
//!
//! Every ray is answered to the bit as it is alone, whatever the others are.

use crate::{Hit, Ray, SurfaceId, SurfacePoint};
use etalon_optics::Vec3;

/// Rays that are asked for at once.
pub const LANES: usize = 8;

/// Eight half-lines; the fields are those of [`Ray`].
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    /// Starts: x, y and z.
    pub origin: [[f64; LANES]; 3],
    /// Directions, of any length: x, y and z.
    pub direction: [[f64; LANES]; 3],
    /// Ends, exclusive.
    pub t_max: [f64; LANES],
    /// The surfaces that the rays leave.
    pub leaves: [SurfaceId; LANES],
    /// The surfaces at which shadow rays aim.
    pub aims_at: [SurfaceId; LANES],
}

/// Eight closest hits; the fields are those of [`Hit`]. What stands in lanes that hit nothing means nothing.
#[derive(Clone, Copy, Debug)]
pub struct Hits {
    /// The lanes that hit anything, one bit each.
    pub mask: u8,
    /// Ray parameters.
    pub t: [f64; LANES],
    /// What was hit.
    pub surface: [SurfaceId; LANES],
    /// Surface parameters.
    pub uv: [[f64; LANES]; 2],
}

/// Eight points on surfaces; the fields are those of [`SurfacePoint`]. What stands in lanes that were not asked for means
/// nothing.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoints {
    /// Positions, m: x, y and z.
    pub position: [[f64; LANES]; 3],
    /// Bounds on the distance between the positions and the true surfaces, m.
    pub position_error: [f64; LANES],
    /// Unit geometric normals: x, y and z.
    pub normal: [[f64; LANES]; 3],
    /// What they are points of.
    pub surface: [SurfaceId; LANES],
    /// The labels of the geometries whose primitives they are.
    pub label: [u32; LANES],
}

/// A vector of one lane.
#[inline(always)]
pub(crate) fn vector(v: &[[f64; LANES]; 3], lane: usize) -> Vec3<f64> {
    Vec3::new(v[0][lane], v[1][lane], v[2][lane])
}

#[inline(always)]
fn set_vector(v: &mut [[f64; LANES]; 3], lane: usize, Vec3 { x, y, z }: Vec3<f64>) {
    for (row, c) in v.iter_mut().zip([x, y, z]) {
        row[lane] = c;
    }
}

/// The lanes of a mask.
pub(crate) fn lanes_of(mut mask: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

impl Rays {
    /// Eight rays of which no point is defined: they hit nothing.
    pub const NONE: Self = Self {
        origin: [[0.0; LANES]; 3],
        direction: [[0.0; LANES]; 3],
        t_max: [0.0; LANES],
        leaves: [SurfaceId::NONE; LANES],
        aims_at: [SurfaceId::NONE; LANES],
    };

    /// The ray of a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> Ray<f64> {
        Ray {
            origin: vector(&self.origin, lane),
            direction: vector(&self.direction, lane),
            t_max: self.t_max[lane],
            leaves: self.leaves[lane],
            aims_at: self.aims_at[lane],
            time: 0.0,
        }
    }

    /// Puts a ray into a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, ray: &Ray<f64>) {
        set_vector(&mut self.origin, lane, ray.origin);
        set_vector(&mut self.direction, lane, ray.direction);
        self.t_max[lane] = ray.t_max;
        self.leaves[lane] = ray.leaves;
        self.aims_at[lane] = ray.aims_at;
    }
}

impl Hits {
    /// Eight lanes that hit nothing.
    pub const NONE: Self = Self { mask: 0, t: [0.0; LANES], surface: [SurfaceId::NONE; LANES], uv: [[0.0; LANES]; 2] };

    /// The hit of a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> Option<Hit<f64>> {
        let hit = Hit { t: self.t[lane], surface: self.surface[lane], uv: [self.uv[0][lane], self.uv[1][lane]] };
        (self.mask >> lane & 1 == 1).then_some(hit)
    }

    /// Puts a hit, or none, into a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, hit: Option<&Hit<f64>>) {
        self.mask &= !(1 << lane);
        if let Some(hit) = hit {
            self.mask |= 1 << lane;
            self.t[lane] = hit.t;
            self.surface[lane] = hit.surface;
            (self.uv[0][lane], self.uv[1][lane]) = (hit.uv[0], hit.uv[1]);
        }
    }
}

impl SurfacePoints {
    /// Eight lanes of nothing.
    pub const NONE: Self = Self {
        position: [[0.0; LANES]; 3],
        position_error: [0.0; LANES],
        normal: [[0.0; LANES]; 3],
        surface: [SurfaceId::NONE; LANES],
        label: [0; LANES],
    };

    /// The point of a lane.
    #[inline]
    pub fn get(&self, lane: usize) -> SurfacePoint<f64> {
        SurfacePoint {
            position: vector(&self.position, lane),
            position_error: self.position_error[lane],
            normal: vector(&self.normal, lane),
            surface: self.surface[lane],
            label: self.label[lane],
            time: 0.0,
        }
    }

    /// Puts a point into a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, point: &SurfacePoint<f64>) {
        set_vector(&mut self.position, lane, point.position);
        self.position_error[lane] = point.position_error;
        set_vector(&mut self.normal, lane, point.normal);
        self.surface[lane] = point.surface;
        self.label[lane] = point.label;
    }
}
