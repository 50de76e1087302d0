//! Media along paths: which of them surrounds a path, what comes through, and where a path is scattered.
//!
//! **Coordinates.** What fills a body of a group has the coordinates of the group. A way is taken into them as an instance takes rays, at the
//! ray's time and with a direction that is not normalised, so that lengths along it stay what they are. A medium that is the same everywhere
//! needs none of this.
//!
//! **Wavelengths.** A path is scattered where the hero's extinction says. Lane j would have drawn the same distance t with the density
//! σⱼe^(−σⱼt), and would have passed a stretch of the length d with the probability e^(−σⱼd). Both over the hero's go into the lanes' densities
//! of the path ([`WavelengthModel::follow`](crate::integrator::wavelength_lanes::WavelengthModel::follow)), so that the balance heuristic
//! weighs the lanes (Wilkie et al. 2014; Miller, Georgiev & Jarosz, *A Null-Scattering Path Integral Formulation of Light Transport*, TOG
//! 38(4), 2019). What is divided by is the hero's density of what the hero drew: never zero.

use super::medium::{Coefficients, Medium};
use super::{Media, MediumStack, Way};
use crate::frame::SceneFrame;
use etalon_geometry::{Geometry, SurfaceId};
use etalon_optics::{Lanes, neg_ln};

/// What the media of a scene do to light along paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Participating<'a> {
    /// Metres in a unit of the frame.
    pub unit_m: f64,
    /// What fills the space outside of all bodies.
    pub surrounding: Option<&'a Medium>,
    /// What places the bodies.
    pub geometry: &'a Geometry,
    /// That of the scene: coordinates of groups are taken into it as those of the world.
    pub frame: &'a SceneFrame,
}

impl<'a> Participating<'a> {
    /// The medium at a place, and the instance that places it: `None` if it is clear.
    #[inline]
    fn around(&self, media: Option<&'a Media>, stack: &MediumStack<'a>) -> Option<(&'a Medium, u32)> {
        if let Some((stated, instance)) = stack.body {
            return Some((stated.interior.as_ref()?, instance));
        }
        if let Some((solid, instance)) = media.and_then(|media| media.filling_solid(stack)) {
            return Some((solid.medium.as_ref()?, instance));
        }
        match stack.outside_of {
            Some((stated, instance)) => Some((stated.exterior.as_ref()?.as_ref()?, instance)),
            None => Some((self.surrounding?, 0)),
        }
    }

    /// The medium along a way, and the way in the coordinates of that medium: `None` if it is clear.
    #[inline]
    pub(crate) fn along(
        &self,
        media: Option<&'a Media>,
        stack: &MediumStack<'a>,
        way: &Way,
    ) -> Option<(&'a Medium, Way)> {
        let (medium, instance) = self.around(media, stack)?;
        let is_placed = instance != 0 && medium.varies();
        Some((medium, if is_placed { self.within(instance, way) } else { *way }))
    }

    /// A way in the coordinates of what an instance places.
    fn within(&self, instance: u32, way: &Way) -> Way {
        let placed = SurfaceId { instance, ..SurfaceId::NONE };
        let origin = self.frame.point(self.geometry.local_point(placed, way.origin, way.time));
        let direction = self.geometry.local_vector(placed, way.direction, way.time) * self.frame.per_m();
        Way { origin, direction, ..*way }
    }

    /// The share of light that comes through a way, in each lane.
    #[inline]
    pub(crate) fn transmittance<const N: usize>(
        &self,
        media: Option<&'a Media>,
        stack: &MediumStack<'a>,
        lambda_nm: &Lanes<f64, N>,
        way: &Way,
    ) -> Lanes<f64, N> {
        match self.along(media, stack, way) {
            Some((medium, way)) => medium.coefficients(lambda_nm).transmittance(medium.column(&way) * self.unit_m),
            None => Lanes::ONE,
        }
    }
}

/// What becomes of a path along a way through a medium that scatters.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stretch<const N: usize> {
    /// It comes through: what throughput is multiplied by, and the lanes' densities relative to the hero's.
    Passed { weight: Lanes<f64, N>, lane_density: Lanes<f64, N> },
    /// It is scattered after this column, m.
    Scattered { column_m: f64, weight: Lanes<f64, N>, lane_density: Lanes<f64, N> },
}

impl<const N: usize> Stretch<N> {
    /// Follows a path whose hero is scattered at this optical depth, and takes from that what the way has if it comes through. The way has the
    /// column `whole_m`.
    #[inline]
    pub(crate) fn follow(coefficients: &Coefficients<N>, whole_m: f64, optical_depth: &mut f64) -> Self {
        let Coefficients { scattering, extinction, .. } = coefficients;
        let hero = extinction[0];
        // Not 0·∞ on an endless way.
        let whole = if hero > 0.0 { hero * whole_m } else { 0.0 };
        if whole <= *optical_depth {
            *optical_depth -= whole;
            let transmittance = coefficients.transmittance(whole_m);
            let weight = transmittance / transmittance[0];
            return Self::Passed { weight, lane_density: weight };
        }
        let column_m = *optical_depth / hero;
        let transmittance = coefficients.transmittance(column_m);
        // Divided one by one, so that lanes of the hero's extinction have exactly its density.
        let relative = transmittance / transmittance[0];
        Self::Scattered { column_m, weight: *scattering / hero * relative, lane_density: *extinction / hero * relative }
    }
}

/// The optical depth at which a path is scattered that goes far enough: exponentially distributed with the mean 1. `u` are two numbers in
/// [0, 1), of which the second refines the first: alone, that ends at a depth of 17.
#[inline]
pub(crate) fn optical_depth(u: [f64; 2]) -> f64 {
    const STEPS: f64 = (1_u64 << 24) as f64;
    let fine = (u[0] * STEPS).floor() + u[1];
    neg_ln(1.0 - fine / STEPS)
}
