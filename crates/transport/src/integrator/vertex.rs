//! Where paths scatter, as shadow rays see it: at a surface or in a medium.

use super::Path;
use crate::bsdf::Lobe;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::media::{MediumInteraction, MediumStack};
use crate::polarisation::Polarisation;
use crate::polarisation::mueller::Mueller;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::world::World;
use etalon_geometry::SurfacePoint;
use etalon_optics::{Lanes, Vec3};

/// A place that shadow rays leave.
pub(crate) trait Vertex<'a> {
    /// The point.
    fn point(&self) -> &SurfacePoint<f64>;

    /// Toward where the path came from; a unit vector.
    fn wo(&self) -> Vec3<f64>;

    /// The media into which a direction leads.
    fn media_toward<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        path: &Path<'a, M, P, N>,
        wi: Vec3<f64>,
    ) -> MediumStack<'a>;

    /// f·|cos θ| of a direction, sr⁻¹, in a medium its phase function; and the mean over the lanes of the density with which the walk would
    /// draw it, sr⁻¹.
    fn eval<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        path: &mut Path<'a, M, P, N>,
        world: &World<'a>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, f64);

    /// What it does to polarisation; `None` if it depolarises.
    fn mueller<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, wi: Vec3<f64>) -> Option<Mueller<N>>;
}

impl<'a> Vertex<'a> for SurfaceInteraction<'a> {
    #[inline(always)]
    fn point(&self) -> &SurfacePoint<f64> {
        &self.point
    }

    #[inline(always)]
    fn wo(&self) -> Vec3<f64> {
        self.wo
    }

    #[inline(always)]
    fn media_toward<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        path: &Path<'a, M, P, N>,
        wi: Vec3<f64>,
    ) -> MediumStack<'a> {
        match self.goes_through(wi) {
            true => path.walk.behind(self, &path.stack),
            false => path.stack,
        }
    }

    fn eval<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        path: &mut Path<'a, M, P, N>,
        world: &World<'a>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, f64) {
        path.eval(world, self, wi)
    }

    #[inline(always)]
    fn mueller<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, wi: Vec3<f64>) -> Option<Mueller<N>> {
        self.scattering().mueller(lambda_nm, self.wo, wi, Lobe::SolidAngle)
    }
}

impl<'a> Vertex<'a> for MediumInteraction<'a> {
    fn point(&self) -> &SurfacePoint<f64> {
        &self.point
    }

    fn wo(&self) -> Vec3<f64> {
        self.wo
    }

    fn media_toward<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        _: &Path<'a, M, P, N>,
        _: Vec3<f64>,
    ) -> MediumStack<'a> {
        self.stack
    }

    fn eval<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
        &self,
        _: &mut Path<'a, M, P, N>,
        _: &World<'a>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, f64) {
        let density = self.medium.phase.density(-self.wo.dot(wi));
        (Lanes::splat(density), density)
    }

    fn mueller<const N: usize>(&self, _: &Lanes<f64, N>, wi: Vec3<f64>) -> Option<Mueller<N>> {
        self.medium.phase.mueller(self.wo, wi)
    }
}
