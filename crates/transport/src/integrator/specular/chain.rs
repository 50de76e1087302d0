//! A chain of mirrors and smooth interfaces, as a function of the direction in which it begins.

use super::refracted_shadow::{MOST_INTERFACES, pass_alike};
use super::solve::Root;
use crate::film::Counters;
use crate::integrator::vertex::Vertex;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{Direction, MOST_VERTICES, Path};
use crate::light::Light;
use crate::media::{MediumStack, Way};
use crate::mis::Density;
use crate::polarisation::Polarisation;
use crate::sampler::NumberStream;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::shading_tables::BsdfKind;
use crate::scene::world::World;
use crate::spectral::Colour;
use etalon_geometry::{Ray, SurfaceId};
use etalon_optics::{Lanes, Vec3};

/// Vertices that every chain may have, and the probability of each further one.
const SURE_VERTICES: u32 = 8;
const GOES_ON: f64 = 0.5;

/// The share of the chains that are reflected where some light is, and some passes.
const REFLECTS: f64 = 0.2;

/// A chain of mirrors and smooth interfaces that begins at a vertex of a path.
pub(super) struct Chain<'c, 'a, V, M, P, const N: usize> {
    world: &'c World<'a>,
    /// Where it begins.
    vertex: &'c V,
    /// The path, which is there.
    path: &'c Path<'a, M, P, N>,
    /// Walks along the chain.
    walker: Path<'a, M, P, N>,
    /// The numbers by which its vertices choose among their lobes.
    numbers: NumberStream,
    /// Vertices that it may have.
    most: u32,
    /// Whether it is refracted wherever it can be, whatever the numbers say.
    refracts: bool,
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

/// A mirror or smooth interface that the walk has come to, before it goes on.
struct ChainVertex<'a, const N: usize> {
    vertex: SurfaceInteraction<'a>,
    /// What media have let through up to there, times the probability of its lobe over that with which it was chosen.
    weight: Lanes<f64, N>,
    /// Where it goes on, and the number that chose among its lobes.
    direction: Direction<N>,
    u_lobe: f64,
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
        let mut walker = Path::idle();
        walker.wavelengths = path.wavelengths;
        walker.vertex = path.vertex;
        walker.spectra = path.spectra.clone();
        // Edges of the path: to this vertex, to each of the chain, and to the lamp.
        let most = most.min(world.max_depth.saturating_sub(path.vertex + 2));
        Self { world, vertex, path, walker, numbers, most, refracts: false }
    }

    /// Follows the chain that begins in a direction. `each` hears of its vertices, and says whether to go on.
    pub(super) fn follow(&mut self, wi: Vec3<f64>, counters: &mut Counters, mut each: impl FnMut(&Link) -> bool) {
        let mut ray = self.begin(wi);
        for number in 0..self.most {
            let Some(ChainVertex { vertex, direction, u_lobe, .. }) = self.next(&ray, number, counters) else { return };
            ray = self.go_on(&vertex, direction, u_lobe);
            let link =
                Link { surface: vertex.point.surface, position: vertex.point.position, direction: ray.direction };
            if !each(&link) {
                return;
            }
        }
    }

    /// The last vertex of the chain that a ray of a lamp follows, and how many it has.
    pub(super) fn of_lamp(&mut self, ray: &Ray<f64>, counters: &mut Counters) -> Option<(Vec3<f64>, u32)> {
        let mut ray = Ray { time: self.vertex.point().time, ..*ray };
        self.begin(ray.direction);
        self.walker.stack = self.world.media_around(&ray, counters).unwrap_or(MediumStack::NOTHING);
        let mut last = None;
        for count in 1..=self.most {
            // Mostly there are two, which the chain meets in the other order.
            let number = if count <= 2 { 2 - count } else { count - 1 };
            let Some(ChainVertex { vertex, direction, u_lobe, .. }) = self.next(&ray, number, counters) else { break };
            last = Some((vertex.point.position, count));
            ray = self.go_on(&vertex, direction, u_lobe);
        }
        last
    }

    /// The ray on which a ray of a lamp leaves the last mirror or interface that it meets, refracted wherever it can be; `None` if it meets none.
    pub(super) fn passed(&mut self, ray: &Ray<f64>, counters: &mut Counters) -> Option<Ray<f64>> {
        let mut ray = Ray { time: self.vertex.point().time, ..*ray };
        self.begin(ray.direction);
        self.walker.stack = self.world.media_around(&ray, counters).unwrap_or(MediumStack::NOTHING);
        self.refracts = true;
        let mut passed = None;
        for number in 0..self.most {
            let Some(ChainVertex { vertex, direction, u_lobe, .. }) = self.next(&ray, number, counters) else { break };
            ray = self.go_on(&vertex, direction, u_lobe);
            passed = Some(ray);
        }
        self.refracts = false;
        passed
    }

    /// What comes along a root's chain; `None` if nothing comes through.
    pub(super) fn bring(&mut self, root: &Root, light: &Light, counters: &mut Counters) -> Option<Brought<N>> {
        let (f_cos, _) = self.vertex.eval(&mut self.walker, self.world, root.wi);
        if f_cos.is_zero() {
            return None;
        }
        let mut ray = self.begin(root.wi);
        let lambda_nm = self.walker.wavelengths.lambda_nm;
        self.walker.beta *= f_cos;
        let wo = self.vertex.wo();
        self.walker.polarisation.follow(wo, root.wi, || self.vertex.mueller(&lambda_nm, root.wi));
        let mut walked = 0.0;
        for number in 0..self.most {
            let ChainVertex { vertex, weight, direction, u_lobe } = self.next(&ray, number, counters)?;
            self.walker.beta *= weight;
            walked += (vertex.point.position - ray.origin).length();
            if number + 1 < root.vertices {
                ray = self.go_on(&vertex, direction, u_lobe);
                continue;
            }
            let sample = light.sample(vertex.point.position, [0.0; 2], vertex.point.time)?;
            let visible = self.walker.visibility(self.world, &vertex, &sample, counters)?;
            self.go_on(&vertex, direction, u_lobe);
            // A chain may be as long with this probability.
            let continued = GOES_ON.powi(root.vertices.saturating_sub(SURE_VERTICES) as i32);
            let scale = sample.scale * visible.share / (root.determinant.abs() * continued);
            let walker = &self.walker;
            let light = walker.beta * visible.transmittance.unwrap_or(Lanes::ONE) * (walker.lanes.weight() * scale);
            if light.is_zero() {
                return None;
            }
            let distance = sample.target.distance(vertex.point.position);
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
        let (wo, lambda_nm) = (self.vertex.wo(), self.walker.wavelengths.lambda_nm);
        self.walker.polarisation.follow(wo, wi, || self.vertex.mueller(&lambda_nm, wi));
        let (mut start, mut interfaces, mut probability) = (ray.origin, 0, 1.0);
        let mut left = Lanes::ONE;
        for _ in 0..MOST_VERTICES {
            let Self { world, walker, .. } = self;
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
            let next = self.go_on(&met, direction, u_lobe);
            if !met.goes_through(next.direction) {
                return None;
            }
            self.walker.beta *= transmitted;
            probability *= transmitted;
            interfaces += 1;
            (ray, start) = (next, next.origin);
        }
        None
    }

    fn came_through(&self, radiance: Lanes<f64, N>, interfaces: u32, probability: f64) -> ShadowPassed<N> {
        let walker = &self.walker;
        let light = walker.beta * radiance * walker.lanes.weight();
        let [s0, others @ ..] = walker.polarisation.of_unpolarised();
        ShadowPassed {
            light: light * s0,
            stokes: P::FOLLOWED.then(|| others.map(|s| light * s)),
            interfaces,
            probability,
        }
    }

    /// The walker back at the beginning, and the ray in a direction.
    fn begin(&mut self, wi: Vec3<f64>) -> Ray<f64> {
        let (walker, path) = (&mut self.walker, self.path);
        (walker.beta, walker.lanes, walker.polarisation) = (path.beta, path.lanes, path.polarisation);
        walker.leave_ray(self.world);
        if self.world.follows_media() {
            // The path knows what is behind the surface that it has met.
            walker.stack = self.vertex.media_toward(path, wi);
        }
        self.vertex.point().spawn(wi)
    }

    /// The mirror or smooth interface that the ray meets next; `None` if it meets none.
    fn next(&mut self, ray: &Ray<f64>, number: u32, counters: &mut Counters) -> Option<ChainVertex<'a, N>> {
        let Self { world, walker, refracts, .. } = self;
        let [mut u_lobe, u1, u2, mut u_mask] = self.numbers.set(u64::from(number));
        if *refracts {
            u_lobe = 1.0_f64.next_down();
        }
        let (mut weight, mut start) = (Lanes::ONE, ray.origin);
        for _ in 0..MOST_VERTICES {
            counters.rays += 1;
            let mut met = world.intersect(ray, &mut walker.walk, &mut walker.stack, counters)?;
            if world.participating.is_some() {
                walker.stack.meet(met.surface.interior(), met.meets_front());
                let way =
                    Way { origin: start, direction: ray.direction, length: (met.point.position - start).length() };
                weight *= walker.transmittance(world, &walker.stack, &way);
            }
            if world.masks {
                let opacity = met.opacity(world);
                if u_mask >= opacity {
                    u_mask = (u_mask - opacity) / (1.0 - opacity);
                    start = met.point.position;
                    walker.walk.pass(&met, &mut walker.stack);
                    continue;
                }
            }
            met.prepare_scattering(world);
            if let Some(reflectance) = walker.reflection_probability(world, &met) {
                // The same choice from wherever the chain comes, so that Newton's method finds its root from afar: the first lobe or the last.
                let (reflects, probability) = match reflectance < 1.0 {
                    true if u_lobe < REFLECTS => (true, reflectance / REFLECTS),
                    true => (false, (1.0 - reflectance) / (1.0 - REFLECTS)),
                    false => (true, 1.0),
                };
                u_lobe = if reflects { 0.0 } else { 1.0_f64.next_down() };
                weight *= probability;
            }
            let direction = match met.kind {
                BsdfKind::Lambert(_) => return None,
                BsdfKind::Mirror(_) | BsdfKind::Dielectric(_) => {
                    walker.sample_direction(world, &met, [u_lobe, u1, u2], &mut ())?
                }
                BsdfKind::General => {
                    let lambda_nm = &walker.wavelengths.lambda_nm;
                    let sample = met.scattering().sample(lambda_nm, met.wo, [u_lobe, u1, u2])?;
                    if sample.density != Density::Delta {
                        return None;
                    }
                    Direction::General { sample, guiding: 1.0 }
                }
            };
            return Some(ChainVertex { vertex: met, weight, direction, u_lobe });
        }
        None
    }

    /// Takes the step from a vertex of the chain.
    fn go_on(&mut self, vertex: &SurfaceInteraction<'a>, direction: Direction<N>, u_lobe: f64) -> Ray<f64> {
        let taken = self.walker.scatter(self.world, vertex, direction, u_lobe);
        vertex.point.spawn(taken.wi)
    }
}
