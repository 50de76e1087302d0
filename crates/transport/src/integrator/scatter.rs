//! The walk's next step: a direction from a surface, what it is worth, and whether the path goes on.

use super::path::{LightTraced, Since, Step};
use super::{Path, ROULETTE_FROM_VERTEX, ROULETTE_THROUGHPUT, THROUGHPUT_FLOOR};
use crate::bsdf::dielectric::{Turn, turn};
use crate::bsdf::{BsdfSample, Lobe, lambert};
use crate::guiding::Mixture;
use crate::integrator::observer::{End, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::mis::Density;
use crate::polarisation::Polarisation;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::shading_tables::BsdfKind;
use crate::scene::world::World;
use etalon_optics::{Lanes, Vec3, fresnel};

/// A direction that was drawn from a surface.
pub(crate) enum Direction<const N: usize> {
    /// From a Lambertian surface, with its cosine; `guiding` is its density by the cosine over the density that it was drawn with.
    Diffuse { wi: Vec3<f64>, cos: f64, guiding: f64 },
    /// By a mirror.
    Mirrored(Vec3<f64>),
    /// By a smooth interface, from outside or not, of this relative index for the hero.
    Turned { turn: Turn, eta: f64, from_outside: bool },
    /// By any BSDF.
    General { sample: BsdfSample<N>, guiding: f64 },
}

/// A step that a path has taken, but for its guiding weight.
pub(crate) struct Taken {
    pub wi: Vec3<f64>,
    /// What throughput is to be multiplied by for the direction not being drawn by the BSDF alone.
    pub guiding: f64,
    /// Whether no other direction was possible.
    pub delta: bool,
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// f·|cos θ| of a direction, and the mean over the lanes of the density with which the walk would draw it, sr⁻¹.
    #[inline(always)]
    pub(super) fn eval(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, f64) {
        match vertex.kind {
            BsdfKind::Lambert(slot) => {
                let cos = lambert::common_cosine(vertex.point.normal, vertex.wo, wi);
                if cos == 0.0 {
                    return (Lanes::ZERO, 0.0);
                }
                let density = lambert::density(cos);
                (self.diffuse_reflectance(world, vertex, slot) * density, density)
            }
            BsdfKind::Mirror(_) | BsdfKind::Dielectric(_) => (Lanes::ZERO, 0.0),
            BsdfKind::General => {
                let (f_cos, densities) = vertex.scattering().eval(&self.wavelengths.lambda_nm, vertex.wo, wi);
                (f_cos, self.lanes.mean_density(densities))
            }
        }
    }

    /// Draws a direction; `None` absorbs the path.
    #[inline(always)]
    pub(crate) fn sample_direction(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        u: [f64; 3],
        observer: &mut impl Observer<N>,
    ) -> Option<Direction<N>> {
        let SurfaceInteraction { point, wo, .. } = vertex;
        match vertex.kind {
            BsdfKind::Lambert(_) => {
                let (wi, cos, mixture) = world.guided_targets.diffuse(point, *wo, [u[1], u[2]])?;
                observer.direction(&mixture);
                Some(Direction::Diffuse { wi, cos, guiding: mixture.factor(1.0) })
            }
            BsdfKind::Mirror(_) => {
                observer.direction(&Mixture::NONE);
                Some(Direction::Mirrored(wo.reflected_about(point.normal).renormalized()))
            }
            BsdfKind::Dielectric(number) => {
                observer.direction(&Mixture::NONE);
                let [interior, exterior] =
                    vertex.indices(&world.tables.interfaces[usize::from(number)], self.hero_nm());
                let from_outside = vertex.meets_front();
                let eta = if from_outside { interior / exterior } else { exterior / interior };
                let turn = turn(point.normal, *wo, eta, u[0]);
                Some(Direction::Turned { turn, eta, from_outside })
            }
            BsdfKind::General => {
                let lambda_nm = &self.wavelengths.lambda_nm;
                let (sample, mixture) = world.guided_targets.sample(point, vertex.scattering(), lambda_nm, *wo, u)?;
                observer.direction(&mixture);
                Some(Direction::General { sample, guiding: mixture.factor(1.0) })
            }
        }
    }

    /// The probability of reflection at a smooth interface or pane, of the hero; `None` at other surfaces.
    pub(super) fn reflection_probability(&self, world: &World<'a>, vertex: &SurfaceInteraction<'a>) -> Option<f64> {
        match vertex.kind {
            BsdfKind::Lambert(_) | BsdfKind::Mirror(_) => None,
            BsdfKind::Dielectric(number) => {
                let [interior, exterior] =
                    vertex.indices(&world.tables.interfaces[usize::from(number)], self.hero_nm());
                let eta = if vertex.meets_front() { interior / exterior } else { exterior / interior };
                let cos = vertex.point.normal.dot(vertex.wo).abs().min(1.0);
                Some(fresnel::dielectric_reflectance(cos, eta).0)
            }
            BsdfKind::General => vertex.scattering().reflection_probability(self.hero_nm(), vertex.wo),
        }
    }

    /// The wavelength that decides where the path goes, nm.
    #[inline(always)]
    pub(crate) fn hero_nm(&self) -> f64 {
        self.wavelengths.lambda_nm[0]
    }

    /// Takes the step along a direction: throughput is multiplied by f·|cos θ|/p, but for the guiding weight. `u_lobe` is the number that
    /// chose among deltas.
    #[inline(always)]
    pub(crate) fn scatter(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        direction: Direction<N>,
        u_lobe: f64,
    ) -> Taken {
        let lane_density = Lanes::ONE;
        // Each kind takes the step by itself, so that what is constant for it is known to the compiler.
        match (direction, vertex.kind) {
            (Direction::Diffuse { wi, cos, guiding }, BsdfKind::Lambert(slot)) => {
                let weight = self.diffuse_reflectance(world, vertex, slot);
                let density = Density::SolidAngle(lambert::density(cos));
                let sample = BsdfSample { wi, weight, density, lane_density, eta: 1.0 };
                self.take(world, vertex, &sample, guiding, u_lobe)
            }
            (Direction::Mirrored(wi), BsdfKind::Mirror(slot)) => {
                let (weight, density) = (self.spectrum(world, slot), Density::Delta);
                let sample = BsdfSample { wi, weight, density, lane_density, eta: 1.0 };
                self.take(world, vertex, &sample, 1.0, u_lobe)
            }
            (Direction::Turned { turn, eta, from_outside }, BsdfKind::Dielectric(number)) => {
                let glass = &world.tables.interfaces[usize::from(number)].glass;
                let lambda_nm = &self.wavelengths.lambda_nm;
                let sample = glass.turned(lambda_nm, &turn, (eta, from_outside), vertex.interface);
                self.take(world, vertex, &sample, 1.0, u_lobe)
            }
            (Direction::General { sample, guiding }, _) => self.take(world, vertex, &sample, guiding, u_lobe),
            _ => unreachable!("directions are drawn for the kind of surface that the path is at"),
        }
    }

    #[inline(always)]
    fn take(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        sample: &BsdfSample<N>,
        guiding: f64,
        u_lobe: f64,
    ) -> Taken {
        let SurfaceInteraction { point, wo, .. } = vertex;
        let wi = sample.wi;
        let delta = matches!(sample.density, Density::Delta);
        self.beta *= sample.weight;
        let lobe = if delta { Lobe::Delta(u_lobe) } else { Lobe::SolidAngle };
        self.polarisation.follow(*wo, wi, || vertex.scattering().mueller(&self.wavelengths.lambda_nm, *wo, wi, lobe));
        let mean_of_hero = self.lanes.follow(sample.lane_density);
        self.eta_squared *= sample.eta * sample.eta;
        if !world.counts_panes && delta && wi == -*wo && world.tables.passes_straight(vertex.surface.material) {
            self.uncounted += 1;
        }
        if let Some(specular_objects) = world.specular_objects {
            self.light_traced = match self.light_traced {
                LightTraced::Never => LightTraced::Never,
                _ if !delta => LightTraced::AfterSpecular,
                _ if self.vertex > 0 && specular_objects.contains(vertex.surface.object) => LightTraced::Now,
                _ => LightTraced::Never,
            };
        }
        self.step = if world.refracting_bodies.is_some() && delta {
            self.step_through(world, vertex, (wi, &sample.lane_density))
        } else {
            Step::Unshared
        };
        if let Density::SolidAngle(density) = sample.density {
            self.guiding = guiding.min(1.0);
            if vertex.sees_lights {
                let density = density * mean_of_hero;
                self.step =
                    Step::Shared { from: point.position, leaves: point.surface, density, since: Since::Nothing };
            }
        }
        self.leave_ray(world);
        if world.follows_media() && vertex.goes_through(wi) {
            self.stack = self.walk.behind(vertex, &self.stack);
        }
        Taken { wi, guiding, delta }
    }

    /// Applies the guiding weight of a step, and plays Russian roulette with the throughput. False if the path ends.
    #[inline(always)]
    pub(crate) fn survives(
        &mut self,
        world: &World<'a>,
        guiding: f64,
        u_roulette: f64,
        observer: &mut impl Observer<N>,
    ) -> bool {
        self.beta *= guiding;
        if !self.beta.is_finite() {
            // Shown to the film, which counts and locates it.
            self.radiance = self.beta;
            observer.end(End::NonFinite);
            return false;
        }
        let throughput = (self.beta.max_lane() * self.lanes.weight_of_even(&self.wavelengths)) * self.eta_squared;
        if throughput < THROUGHPUT_FLOOR {
            observer.end(End::Vanished);
            return false;
        }
        if world.roulette && self.vertex + 1 >= ROULETTE_FROM_VERTEX {
            // No cap below one: it would make the variance infinite between good mirrors (hard case 29).
            let survival = (throughput / (self.guiding * ROULETTE_THROUGHPUT)).min(1.0);
            if u_roulette >= survival {
                observer.end(End::Roulette);
                return false;
            }
            self.beta /= survival;
        }
        self.vertex += 1;
        if self.edges(1) > world.max_depth {
            // It was to go on only by a pane that does not count.
            observer.end(End::Depth);
            return false;
        }
        true
    }
}
