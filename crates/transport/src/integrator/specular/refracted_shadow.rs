//! Shadow rays that glass refracts: direct light of lamps with an area, and of skies, behind smooth interfaces and panes.
//!
//! A shadow ray is drawn straight toward a light. Where glass blocks it, it goes on through the glass, refracted at each interface, and counts
//! if it comes to the same light in the end. That is a second way to draw a direction that the walk may take too, which then passes each
//! interface with the probability of its transmittance. Both are weighed by their densities (Veach 1997, §9.2.4):
//!
//! - of the shadow ray: the probability of the light times the density of the direction toward it, as seen without the glass;
//! - of the walk: the density of the direction times the product of the transmittances, for the wavelength that decides.
//!
//! So light behind a pane, in a bulb or outside of a glass of water is found by shadow rays where these are good at it: where glass turns light
//! little. Where it concentrates light, the walk finds most of it, as before.
//!
//! Neither counts reflections within the glass, nor surfaces of which only a part is there. Such light is the walk's alone.

use super::walker::Walker;
use crate::film::Counters;
use crate::guiding::RefractingBodies;
use crate::integrator::observer::{Found, Observer};
use crate::integrator::path::{Since, Step, Through};
use crate::integrator::vertex::Vertex;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{Direction, LightDraw, MOST_VERTICES, Path};
use crate::light::Emitter;
use crate::mis::Density;
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::world::World;
use crate::surface::Surface;
use etalon_geometry::{Ray, SurfaceId};
use etalon_optics::{Lanes, Vec3};

/// Most interfaces that a shadow ray goes through.
const MOST_INTERFACES: u32 = 8;
/// Where media leave less of its light than this, a shadow ray goes on with a probability in proportion.
const FAINT: f64 = 0.25;
/// The number of the set before those that decide this.
const SHADOW_SETS: u64 = 1 << 43;

/// What a shadow ray brings through smooth interfaces and panes.
pub(super) struct ShadowPassed<const N: usize> {
    /// S₀ of radiance times throughput.
    pub light: Lanes<f64, N>,
    /// S₁, S₂ and S₃, where polarisation is followed.
    pub stokes: Option<[Lanes<f64, N>; 3]>,
    /// How many interfaces it went through.
    interfaces: u32,
    /// The probability with which the walk would have passed them.
    probability: f64,
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// Whether a shadow ray starts within a body and may meet glass, as in milk in a glass. [`Path::add_refracted_light`] then finds all light
    /// that arrives, that of a lamp in the same body too. No other shadow ray need be sent.
    #[inline]
    pub(crate) fn starts_within_body(&self, world: &World<'a>, vertex: &impl Vertex<'a>, draw: &LightDraw) -> bool {
        may_meet_glass(world, vertex, draw)
            && !world.masks
            && matches!(draw.sample.density, Density::SolidAngle(_))
            && vertex.media_toward(self, draw.sample.wi).is_in_a_body()
    }

    /// Adds the light that comes along a shadow ray through the glass that is in its way, if glass is.
    #[inline]
    pub(crate) fn add_refracted_light(
        &mut self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        draw: &LightDraw,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        if matches!(draw.sample.density, Density::Delta) {
            self.add_light_through_panes(world, vertex, draw, counters, observer);
        } else if !self.is_light_traced_after_specular(world) && may_meet_glass(world, vertex, draw) {
            self.follow_shadow_ray(world, vertex, draw, sampler, counters, observer);
        }
    }

    #[inline(never)]
    fn follow_shadow_ray(
        &mut self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        draw: &LightDraw,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) {
        let Density::SolidAngle(density) = draw.sample.density else { return };
        let wi = draw.sample.wi;
        let (f_cos, of_walk) = vertex.eval(self, world, wi);
        let numbers = sampler.connection_numbers(self.vertex);
        let mut part = SHADOW_SETS;
        let goes_on = |left: Lanes<f64, N>| {
            let survival = (left.max_lane() / FAINT).min(1.0);
            part += 1;
            if survival == 1.0 || numbers.set(part)[0] < survival { survival } else { 0.0 }
        };
        let Some(passed) = self.refracted(world, vertex, (wi, draw.light), goes_on, counters) else { return };
        let of_walk = of_walk * passed.probability;
        // As straight, if nothing was in the way.
        let density = match passed.interfaces {
            0 => density * draw.probability,
            _ => {
                let point = vertex.point();
                world.density_toward(draw.light, (point.position, point.surface), wi, point.time)
            }
        };
        if density == 0.0 {
            return;
        }
        let weight = draw.sample.target.heuristic().weight(density, of_walk) / density;
        let factor = f_cos * weight;
        if let Some(stokes) = passed.stokes {
            self.polarisation.record(stokes.map(|s| s * factor));
        }
        let found = self.gather(passed.light * factor);
        observer.light(self.vertex, Found::ShadowRay { light: draw.light }, found);
    }

    /// What a light sends to a vertex along a shadow ray in a direction, refracted at each smooth interface; `None` if the ray does not come to it.
    /// `goes_on` decides with which probability the ray goes on after each of its parts, by the share that media have let through.
    fn refracted(
        &self,
        world: &World<'a>,
        vertex: &impl Vertex<'a>,
        (wi, light): (Vec3<f64>, u32),
        mut goes_on: impl FnMut(Lanes<f64, N>) -> f64,
        counters: &mut Counters,
    ) -> Option<ShadowPassed<N>> {
        let mut walker = Walker::like(self);
        let mut ray = walker.leave(self, world, vertex, wi);
        let walker = &mut walker.path;
        let (mut start, mut interfaces, mut probability) = (ray.origin, 0, 1.0);
        let mut left = Lanes::ONE;
        for _ in 0..MOST_VERTICES {
            counters.rays += 1;
            let met = world.intersect(&ray, &mut walker.walk, &mut walker.stack, counters);
            if world.participating.is_some() {
                left *= walker.transmittance_to(world, (start, &ray), met.as_ref(), f64::INFINITY);
                let survival = goes_on(left);
                if survival == 0.0 {
                    return None;
                }
                left /= survival;
            }
            let Some(mut met) = met else {
                let radiance = walker.radiance_of_sky(world, &ray, light)?;
                return Some(ShadowPassed::by(walker, radiance * left, interfaces, probability));
            };
            let is_of_light = match interfaces {
                0 => met.surface.light(met.point.surface) == Some(light),
                _ if met.point.surface == vertex.point().surface => false,
                _ => world.is_of(&met.surface, met.point.surface, light),
            };
            if is_of_light {
                let radiance = walker.radiance_of_surface(world, &met)?;
                return Some(ShadowPassed::by(walker, radiance * left, interfaces, probability));
            }
            match met.share_that_stops(world) {
                0.0 if !met.surface.shines() => {
                    start = met.point.position;
                    walker.walk.pass(&met, &mut walker.stack);
                    continue;
                }
                1.0 if interfaces < MOST_INTERFACES && !met.surface.shines() => {}
                _ => return None,
            }
            met.prepare_scattering(world);
            let transmitted = 1.0 - walker.reflection_probability(world, &met)?;
            if transmitted == 0.0 {
                return None;
            }
            let u_lobe = 1.0_f64.next_down();
            let direction = walker.sample_direction(world, &met, [u_lobe, 0.5, 0.5], &mut ())?;
            if let Direction::General { sample, .. } = &direction
                && !pass_alike(&sample.lane_density)
            {
                return None;
            }
            let taken = walker.scatter(world, &met, direction, u_lobe);
            if !met.goes_through(taken.wi) {
                return None;
            }
            let next = met.point.spawn(taken.wi);
            walker.beta *= transmitted;
            probability *= transmitted;
            interfaces += 1;
            // To this vertex, to each interface, and to the lamp.
            if walker.edges(2 + interfaces) > world.max_depth {
                return None;
            }
            (ray, start) = (next, next.origin);
        }
        None
    }

    /// What the last step is after an interface that the path goes through in the direction `wi`: still one that a shadow ray may have taken, if
    /// all surfaces since are such.
    pub(in crate::integrator) fn step_through(
        &self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        (wi, lane_density): (Vec3<f64>, &Lanes<f64, N>),
    ) -> Step {
        let Step::Shared { from, leaves, density, since } = self.step else { return Step::Unshared };
        if vertex.surface.shines()
            || vertex.share_that_stops(world) < 1.0
            || !vertex.goes_through(wi)
            || !pass_alike(lane_density)
        {
            return Step::Unshared;
        }
        let through = match since {
            Since::Nothing => Through { wi: -vertex.wo, interfaces: 0 },
            Since::Interfaces(through) if through.interfaces < MOST_INTERFACES => through,
            Since::Interfaces(_) | Since::Mask(_) => return Step::Unshared,
        };
        let Some(reflectance) = self.reflection_probability(world, vertex) else { return Step::Unshared };
        let since = Since::Interfaces(Through { interfaces: through.interfaces + 1, ..through });
        Step::Shared { from, leaves, density: density * (1.0 - reflectance), since }
    }
}

impl<const N: usize> ShadowPassed<N> {
    /// What a walker brings that has come through.
    pub(super) fn by<M: WavelengthModel<N>, P: Polarisation<N>>(
        walker: &Path<'_, M, P, N>,
        radiance: Lanes<f64, N>,
        interfaces: u32,
        probability: f64,
    ) -> Self {
        let light = walker.beta * radiance * walker.lanes.weight();
        let [s0, others @ ..] = walker.polarisation.of_unpolarised();
        Self { light: light * s0, stokes: P::FOLLOWED.then(|| others.map(|s| light * s)), interfaces, probability }
    }
}

/// Whether glass may be in the way of a shadow ray.
#[inline]
fn may_meet_glass<'a>(world: &World<'a>, vertex: &impl Vertex<'a>, draw: &LightDraw) -> bool {
    let (from, sample) = (vertex.point().position, &draw.sample);
    let meets = |bodies: &RefractingBodies| bodies.may_be_met(from, sample.wi, sample.target.distance(from));
    world.refracting_bodies.is_some_and(meets)
}

/// Whether an interface lets all wavelengths pass with the same probability, or the hero's alone. Films may not: the weights would then depend on
/// which wavelength is the hero.
fn pass_alike<const N: usize>(lane_density: &Lanes<f64, N>) -> bool {
    *lane_density == Lanes::ONE || *lane_density == Lanes::ONE.hero_only()
}

impl<'a> World<'a> {
    /// The density with which straight shadow rays toward a light take a direction, sr⁻¹. All parts of a lamp count together, such as the
    /// triangles of a mesh. 0 of lights that refracted shadow rays do not look for.
    pub(in crate::integrator) fn density_toward(
        &self,
        light: u32,
        (from, leaves): (Vec3<f64>, SurfaceId),
        wi: Vec3<f64>,
        time: f64,
    ) -> f64 {
        let of_light = |light: u32| {
            let probability = self.lights.probability(light as usize, from);
            probability * self.lights.lights()[light as usize].density(from, wi, time)
        };
        let Some(emitter) = self.lights.lights()[light as usize].emitter() else { return of_light(light) };
        let Some(lamp) = self.lamp(emitter) else { return 0.0 };
        let (mut density, mut counted) = (0.0, Vec::new());
        let ray = Ray { time, ..Ray::free(from, wi) };
        self.geometry.all_hits(&ray, 0.0, |hit| {
            let surface = self.surfaces.of(&self.geometry.surface(&ray, &hit));
            let light = if surface.object == lamp { surface.light(hit.surface) } else { None };
            // No surface is aimed at from itself, and a curved one may be met twice.
            if let Some(light) = light.filter(|light| hit.surface != leaves && !counted.contains(light)) {
                counted.push(light);
                density += of_light(light);
            }
            ray.t_max
        });
        // From a point in its plane, a lamp has no density.
        if density.is_finite() { density } else { 0.0 }
    }

    /// The object that a lamp is, unless an instance places it.
    fn lamp(&self, emitter: &Emitter) -> Option<u32> {
        let SurfaceId { instance, primitive } = emitter.surface;
        if instance != 0 { None } else { self.surfaces.object_of.first()?.get(primitive.0 as usize).copied() }
    }

    /// Whether a surface is of the light that a shadow ray looks for, so that it may count.
    fn is_of(&self, surface: &Surface<'_>, point: SurfaceId, light: u32) -> bool {
        let lamp = self.lights.lights()[light as usize].emitter().and_then(|emitter| self.lamp(emitter));
        lamp == Some(surface.object) && surface.light(point).is_some()
    }
}
