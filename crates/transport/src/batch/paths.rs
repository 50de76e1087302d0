//! The paths of a set, and the rows that rays and directions of all of them are computed from at once.

use super::arrive::of_group;
use super::rows::{Mask, Row, Rows3, W};
use crate::integrator::Path;
use crate::integrator::reuse::ReusePath;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::polarisation::Polarisation;
use crate::sampler::{Sampler, Samplers};
use crate::scene::interaction::SurfaceInteraction;
use etalon_geometry::{LANES, Ray, Rays, SurfaceId};

/// All paths of a set.
pub(super) const ALL: Mask = ((1_u64 << W) - 1) as Mask;

/// See the module.
pub(super) struct Paths<'a, M, P, const N: usize> {
    /// Which paths there are.
    pub alive: Mask,
    /// Numbers of the samples.
    pub number: [u32; W],
    pub samplers: Samplers<W>,
    /// Rays of all kinds so far.
    pub ray_count: [u32; W],
    pub paths: [Path<'a, M, P, N>; W],
    /// Numbers of their vertices.
    pub vertex: [u32; W],
    /// Their rays, which leave the surfaces `leaves`.
    pub origin: Rows3,
    pub direction: Rows3,
    pub leaves: [SurfaceId; W],
    pub time: [f64; W],
    /// The surfaces that they are at, and where these are.
    pub at: [Option<SurfaceInteraction<'a>>; W],
    pub position: Rows3,
    pub error: Row,
    pub normal: Rows3,
    /// Whether neighbouring pixels share paths, and then what each path brings in.
    pub shares: bool,
    pub reuse_path: [ReusePath<N>; W],
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Paths<'a, M, P, N> {
    /// None yet; numbers will be drawn by samplers of the kind of this one.
    pub(super) fn new(sampler: Sampler, shares: bool) -> Self {
        Self {
            alive: 0,
            number: [0; W],
            samplers: Samplers::new(sampler),
            ray_count: [0; W],
            paths: std::array::from_fn(|_| Path::idle()),
            vertex: [0; W],
            origin: Rows3::ZERO,
            direction: Rows3::ZERO,
            leaves: [SurfaceId::NONE; W],
            time: [0.0; W],
            at: [const { None }; W],
            position: Rows3::ZERO,
            error: Row::ZERO,
            normal: Rows3::ZERO,
            shares,
            reuse_path: [ReusePath::NOTHING; W],
        }
    }

    /// The rays of a group.
    #[inline(always)]
    pub(super) fn rays(&self, group: usize) -> Rays {
        Rays {
            origin: self.origin.group(group),
            direction: self.direction.group(group),
            t_max: [f64::INFINITY; LANES],
            leaves: of_group(&self.leaves, group * LANES),
            aims_at: [SurfaceId::NONE; LANES],
        }
    }

    /// Gives a path another ray, at the same time.
    pub(super) fn put_ray(&mut self, lane: usize, ray: &Ray<f64>) {
        self.origin.set(lane, ray.origin);
        self.direction.set(lane, ray.direction);
        self.leaves[lane] = ray.leaves;
    }

    /// The ray of a path.
    #[inline(always)]
    pub(super) fn ray(&self, lane: usize) -> Ray<f64> {
        Ray {
            origin: self.origin.at(lane),
            direction: self.direction.at(lane),
            t_max: f64::INFINITY,
            leaves: self.leaves[lane],
            aims_at: SurfaceId::NONE,
            time: self.time[lane],
        }
    }
}

/// The vertex that a path is at.
#[inline(always)]
pub(super) fn vertex<'v, 'a>(at: &'v [Option<SurfaceInteraction<'a>>; W], lane: usize) -> &'v SurfaceInteraction<'a> {
    at[lane].as_ref().expect("a path that scatters is at a surface")
}
