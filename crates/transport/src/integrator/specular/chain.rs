//! A chain of mirrors and smooth interfaces, as a function of the direction in which it begins.

use super::refracted_shadow::{MOST_INTERFACES, pass_alike};
use super::solve::Root;
use super::walker::{LobeChoice, Scout, Walker};
use crate::film::Counters;
use crate::integrator::vertex::Vertex;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{Direction, MOST_VERTICES, Path};
use crate::light::Light;
use crate::media::{MediumStack, Way};
use crate::polarisation::Polarisation;
use crate::sampler::NumberStream;
use crate::scene::world::World;
use crate::spectral::Colour;
use etalon_geometry::{Ray, SurfaceId};
use etalon_optics::{Lanes, Vec3};

/// Vertices that every chain may have, and the probability of each further one.
const SURE_VERTICES: u32 = 8;
const GOES_ON: f64 = 0.5;

/// A chain of mirrors and smooth interfaces that begins at a vertex of a path.
pub(super) struct Chain<'c, 'a, V, M, P, const N: usize> {
    world: &'c World<'a>,
    /// Where it begins.
    vertex: &'c V,
    /// The path, which is there.
    path: &'c Path<'a, M, P, N>,
    /// Finds where chains lead.
    scout: Scout<'a>,
    /// Finds what comes along a chain.
    walker: Walker<'a, M, P, N>,
    choice: LobeChoice,
    /// Vertices that it may have.
    most: u32,
}

/// What a lamp of unit spectrum sends along a chain to the camera.
pub(super) struct Brought<const N: usize> {
    /// What the light's spectrum is multiplied by at each wavelength, if it is not the same in all directions.
    pub colour: Option<Colour>,
    /// S₀.
    pub light: Lanes<f64, N>,
    /// S₁, S₂ and S₃, where polarisation is followed.
    pub stokes: Option<[Lanes<f64, N>; 3]>,
    /// How strong it is where the chain begins, over what the lamp would bring from as far away without it.
    pub concentration: f64,
}

/// What a shadow ray brings through smooth interfaces.
pub(super) struct ShadowPassed<const N: usize> {
    /// S₀ of radiance times throughput.
    pub light: Lanes<f64, N>,
    /// S₁, S₂ and S₃, where polarisation is followed.
    pub stokes: Option<[Lanes<f64, N>; 3]>,
    /// How many interfaces it went through.
    pub interfaces: u32,
    /// The probability with which the walk would have passed them.
    pub probability: f64,
}

/// A vertex of a chain, and how it goes on from there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub surface: SurfaceId,
    pub position: Vec3<f64>,
    /// Unit vector.
    pub direction: Vec3<f64>,
}

impl<'c, 'a, V: Vertex<'a>, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Chain<'c, 'a, V, M, P, N> {
    /// That of a path at a vertex. `u_length` in [0, 1) says how many vertices it may have.
    pub(super) fn new(
        path: &'c Path<'a, M, P, N>,
        world: &'c World<'a>,
        vertex: &'c V,
        numbers: NumberStream,
        u_length: f64,
    ) -> Self {
        let mut most = SURE_VERTICES;
        let mut left = u_length;
        while left < GOES_ON && most < MOST_VERTICES {
            left /= GOES_ON;
            most += 1;
        }
        Self::of(path, world, vertex, numbers, most)
    }

    /// That of a shadow ray, which is refracted wherever it can be.
    pub(super) fn shadow(path: &'c Path<'a, M, P, N>, world: &'c World<'a>, vertex: &'c V) -> Self {
        Self::of(path, world, vertex, NumberStream::default(), MOST_INTERFACES)
    }

    fn of(path: &'c Path<'a, M, P, N>, world: &'c World<'a>, vertex: &'c V, numbers: NumberStream, most: u32) -> Self {
        // Edges of the path: to this vertex, to each of the chain, and to the lamp.
        let most = most.min(world.max_depth.saturating_sub(path.vertex + 2));
        let choice = LobeChoice { numbers, refracts: false };
        let walker = Walker::like(path);
        Self { world, vertex, path, scout: Scout::of(path), walker, choice, most }
    }

    /// Follows the chain that begins in a direction. `each` hears of its vertices, and says whether to go on.
    pub(super) fn follow(&mut self, wi: Vec3<f64>, counters: &mut Counters, mut each: impl FnMut(&Link) -> bool) {
        self.scout.begin(self.world, self.media_toward(wi));
        let mut ray = self.vertex.point().spawn(wi);
        for number in 0..self.most {
            let Some(next) = self.scout.next(self.world, &self.choice, &ray, number, counters) else { return };
            let (surface, position) = (next.vertex.point.surface, next.vertex.point.position);
            ray = self.scout.go_on(self.world, next);
            if !each(&Link { surface, position, direction: ray.direction }) {
                return;
            }
        }
    }

    /// The last vertex of the chain that a ray of a lamp follows, and how many it has.
    pub(super) fn of_lamp(&mut self, ray: &Ray<f64>, counters: &mut Counters) -> Option<(Vec3<f64>, u32)> {
        let mut ray = self.begin_at_lamp(ray, counters);
        let mut last = None;
        for count in 1..=self.most {
            // Mostly there are two, which the chain meets in the other order.
            let number = if count <= 2 { 2 - count } else { count - 1 };
            let Some(next) = self.scout.next(self.world, &self.choice, &ray, number, counters) else { break };
            last = Some((next.vertex.point.position, count));
            ray = self.scout.go_on(self.world, next);
        }
        last
    }

    /// The ray on which a ray of a lamp leaves the last mirror or interface that it meets, refracted wherever it can be; `None` if it meets none.
    pub(super) fn passed(&mut self, ray: &Ray<f64>, counters: &mut Counters) -> Option<Ray<f64>> {
        let mut ray = self.begin_at_lamp(ray, counters);
        let choice = LobeChoice { refracts: true, ..self.choice };
        let mut passed = None;
        for number in 0..self.most {
            let Some(next) = self.scout.next(self.world, &choice, &ray, number, counters) else { break };
            ray = self.scout.go_on(self.world, next);
            passed = Some(ray);
        }
        passed
    }

    /// The scout at the beginning of a ray of a lamp.
    fn begin_at_lamp(&mut self, ray: &Ray<f64>, counters: &mut Counters) -> Ray<f64> {
        let ray = Ray { time: self.vertex.point().time, ..*ray };
        let stack = self.world.media_around(&ray, counters).unwrap_or(MediumStack::NOTHING);
        self.scout.begin(self.world, Some(stack));
        ray
    }

    /// What comes along a root's chain; `None` if nothing comes through.
    pub(super) fn bring(&mut self, root: &Root, light: &Light, counters: &mut Counters) -> Option<Brought<N>> {
        let (f_cos, _) = self.vertex.eval(&mut self.walker.path, self.world, root.wi);
        if f_cos.is_zero() {
            return None;
        }
        let mut ray = self.begin(root.wi);
        self.walker.path.beta *= f_cos;
        let mut walked = 0.0;
        for number in 0..self.most {
            let next = self.walker.next(self.world, &self.choice, &ray, number, counters)?;
            let walker = &mut self.walker.path;
            walker.beta *= next.weight;
            let from = next.vertex.point.position;
            walked += (from - ray.origin).length();
            if number + 1 < root.vertices {
                ray = self.walker.go_on(self.world, next);
                continue;
            }
            let sample = light.sample(from, [0.0; 2], next.vertex.point.time)?;
            let visible = walker.visibility(self.world, &next.vertex, &sample, counters)?;
            self.walker.go_on(self.world, next);
            // A chain may be as long with this probability.
            let continued = GOES_ON.powi(root.vertices.saturating_sub(SURE_VERTICES) as i32);
            let scale = sample.scale * visible.share / (root.determinant.abs() * continued);
            let walker = &self.walker.path;
            let light = walker.beta * visible.transmittance.unwrap_or(Lanes::ONE) * (walker.lanes.weight() * scale);
            if light.is_zero() {
                return None;
            }
            let distance = sample.target.distance(from);
            let spread = if distance.is_finite() { (walked + distance) / distance } else { 1.0 };
            let of_chain = walker.beta.max_lane() / (self.path.beta * f_cos).max_lane();
            let [s0, others @ ..] = walker.polarisation.of_unpolarised();
            return Some(Brought {
                colour: sample.colour,
                light: light * s0,
                stokes: P::FOLLOWED.then(|| others.map(|s| light * s)),
                concentration: of_chain * spread * spread / root.determinant.abs(),
            });
        }
        None
    }

    /// What a light sends to the beginning along a shadow ray through smooth interfaces; `None` if the ray does not come to it. `goes_on`
    /// decides with which probability the ray goes on after each of its parts, by the share that media have let through.
    pub(super) fn pass(
        &mut self,
        wi: Vec3<f64>,
        light: u32,
        mut goes_on: impl FnMut(Lanes<f64, N>) -> f64,
        counters: &mut Counters,
    ) -> Option<ShadowPassed<N>> {
        let mut ray = self.begin(wi);
        let (mut start, mut interfaces, mut probability) = (ray.origin, 0, 1.0);
        let mut left = Lanes::ONE;
        for _ in 0..MOST_VERTICES {
            let Self { world, walker: Walker { path: walker, .. }, .. } = self;
            counters.rays += 1;
            let met = world.intersect(&ray, &mut walker.walk, &mut walker.stack, counters);
            if world.participating.is_some() {
                if let Some(met) = &met {
                    walker.stack.meet(met.surface.interior(), met.meets_front());
                }
                let length = met.as_ref().map_or(f64::INFINITY, |met| (met.point.position - start).length());
                left *= walker.transmittance(
                    world,
                    &walker.stack,
                    &Way { origin: start, direction: ray.direction, length },
                );
                let survival = goes_on(left);
                if survival == 0.0 {
                    return None;
                }
                left /= survival;
            }
            let Some(mut met) = met else {
                let radiance = walker.radiance_of_sky(world, &ray, light)?;
                return Some(self.came_through(radiance * left, interfaces, probability));
            };
            let is_of_light = match interfaces {
                0 => met.surface.light(met.point.surface) == Some(light),
                _ if met.point.surface == self.vertex.point().surface => false,
                _ => world.is_of(&met.surface, met.point.surface, light),
            };
            if is_of_light {
                let radiance = walker.radiance_of_surface(world, &met)?;
                return Some(self.came_through(radiance * left, interfaces, probability));
            }
            match met.share_that_stops(world) {
                0.0 if !met.surface.shines() => {
                    start = met.point.position;
                    walker.walk.pass(&met, &mut walker.stack);
                    continue;
                }
                1.0 if interfaces < self.most && !met.surface.shines() => {}
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
            (ray, start) = (next, next.origin);
        }
        None
    }

    fn came_through(&self, radiance: Lanes<f64, N>, interfaces: u32, probability: f64) -> ShadowPassed<N> {
        let walker = &self.walker.path;
        let light = walker.beta * radiance * walker.lanes.weight();
        let [s0, others @ ..] = walker.polarisation.of_unpolarised();
        ShadowPassed {
            light: light * s0,
            stokes: P::FOLLOWED.then(|| others.map(|s| light * s)),
            interfaces,
            probability,
        }
    }

    /// The walker at the beginning, with what the path has there and what the vertex does to polarisation, and the ray in a direction.
    fn begin(&mut self, wi: Vec3<f64>) -> Ray<f64> {
        let stack = self.media_toward(wi);
        self.walker.begin(self.world, stack);
        let (walker, path, vertex) = (&mut self.walker.path, self.path, self.vertex);
        (walker.beta, walker.lanes, walker.polarisation) = (path.beta, path.lanes, path.polarisation);
        walker.polarisation.follow(vertex.wo(), wi, || vertex.mueller(&path.wavelengths.lambda_nm, wi));
        vertex.point().spawn(wi)
    }

    /// The media behind the vertex in a direction, where media are followed. The path knows what is behind the surface that it has met.
    fn media_toward(&self, wi: Vec3<f64>) -> Option<MediumStack<'a>> {
        self.world.follows_media().then(|| self.vertex.media_toward(self.path, wi))
    }
}
