//! A chain of mirrors and smooth interfaces, as a function of the direction in which it begins.

use super::solve::Root;
use super::walker::{LobeChoice, Lobes, Scout, Walker, media_toward};
use crate::film::Counters;
use crate::integrator::vertex::Vertex;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{MOST_VERTICES, Path};
use crate::light::{Light, Source};
use crate::media::MediumStack;
use crate::polarisation::Polarisation;
use crate::sampler::NumberStream;
use crate::scene::world::World;
use crate::spectral::Colour;
use etalon_geometry::{Ray, SurfaceId};
use etalon_optics::{Frame, Lanes, Vec3};

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

/// A vertex of a chain, and how it goes on from there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub surface: SurfaceId,
    pub position: Vec3<f64>,
    /// Unit vector.
    pub direction: Vec3<f64>,
    /// Whether the chain goes through it.
    pub passes: bool,
    /// Whether it is a pane that the chain passes, which shadow rays do too.
    pub passes_pane: bool,
}

impl Link {
    /// The part of the lamp's direction that is at right angles to the chain's: its length is the sine of the angle between them. Beyond a right
    /// angle it is 2 less the sine, so that it grows with the angle.
    pub(super) fn miss(&self, source: &Source) -> Vec3<f64> {
        let toward = source.toward(self.position);
        let cos = toward.dot(self.direction);
        let across = toward - self.direction * cos;
        if cos >= 0.0 {
            return across;
        }
        let sin = across.length();
        if sin > 0.0 { across * ((2.0 - sin) / sin) } else { Frame::from_normal(self.direction).s * 2.0 }
    }
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
        Self { world, vertex, path, scout: Scout::of(path), choice: LobeChoice { numbers, lobes: Lobes::Drawn }, most }
    }

    /// From here on vertices choose their lobes so.
    pub(super) fn choose(&mut self, lobes: Lobes) {
        self.choice.lobes = lobes;
    }

    /// Follows the chain that begins in a direction. `each` hears of its vertices, and says whether to go on.
    pub(super) fn follow(&mut self, wi: Vec3<f64>, counters: &mut Counters, mut each: impl FnMut(&Link) -> bool) {
        self.scout.begin(self.world, media_toward(self.world, self.path, self.vertex, wi));
        let mut ray = self.vertex.point().spawn(wi);
        for number in 0..self.most {
            let Some(next) = self.scout.next(self.world, &self.choice, &ray, number, counters) else { return };
            let (surface, position) = (next.vertex.point.surface, next.vertex.point.position);
            let is_pane = self.world.panes.is_some()
                && self.world.tables.is_pane(next.vertex.surface.object, next.vertex.surface.material);
            let (before, normal) = (ray.direction, next.vertex.point.normal);
            ray = self.scout.go_on(self.world, next);
            let passes_pane = is_pane && ray.direction == before;
            let passes = normal.dot(before) * normal.dot(ray.direction) > 0.0;
            if self.is_too_long(number + 1)
                || !each(&Link { surface, position, direction: ray.direction, passes, passes_pane })
            {
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
            let position = next.vertex.point.position;
            ray = self.scout.go_on(self.world, next);
            if self.is_too_long(count) {
                break;
            }
            last = Some((position, count));
        }
        last
    }

    /// The ray on which a ray of a lamp leaves the last mirror or interface that it meets, refracted wherever it can be; `None` if it meets none.
    pub(super) fn passed(&mut self, ray: &Ray<f64>, counters: &mut Counters) -> Option<Ray<f64>> {
        let mut ray = self.begin_at_lamp(ray, counters);
        let choice = LobeChoice { lobes: Lobes::Refracted, ..self.choice };
        let mut passed = None;
        for number in 0..self.most {
            let Some(next) = self.scout.next(self.world, &choice, &ray, number, counters) else { break };
            ray = self.scout.go_on(self.world, next);
            if self.is_too_long(number + 1) {
                break;
            }
            passed = Some(ray);
        }
        passed
    }

    /// Whether the path has more edges than it may have, if the chain has this many vertices: to this vertex, to each of the chain, and to the lamp.
    fn is_too_long(&self, vertices: u32) -> bool {
        self.scout.path.edges(2 + vertices) > self.world.max_depth
    }

    /// The scout at the beginning of a ray of a lamp.
    fn begin_at_lamp(&mut self, ray: &Ray<f64>, counters: &mut Counters) -> Ray<f64> {
        let ray = Ray { time: self.vertex.point().time, ..*ray };
        let stack = self.world.media_around(&ray, counters).unwrap_or(MediumStack::NOTHING);
        self.scout.begin(self.world, Some(stack));
        ray
    }

    /// What comes along a root's chain; `None` if nothing comes through.
    pub(super) fn bring(&self, root: &Root, light: &Light, counters: &mut Counters) -> Option<Brought<N>> {
        let Self { world, vertex, path, choice, .. } = self;
        let mut walker = Walker::like(path);
        let (f_cos, _) = vertex.eval(&mut walker.path, world, root.wi);
        if f_cos.is_zero() {
            return None;
        }
        let mut ray = walker.leave(path, world, *vertex, root.wi);
        walker.path.beta *= f_cos;
        let mut walked = 0.0;
        for number in 0..self.most {
            let next = walker.next(world, choice, &ray, number, counters)?;
            walker.path.beta *= next.weight;
            let from = next.vertex.point.position;
            walked += (from - ray.origin).length();
            if number + 1 < root.vertices {
                ray = walker.go_on(world, next);
                continue;
            }
            let sample = light.sample(from, [0.0; 2], next.vertex.point.time)?;
            let visible = walker.path.visibility(world, &next.vertex, &sample, counters)?;
            walker.go_on(world, next);
            // A chain may be as long with this probability.
            let continued = GOES_ON.powi(root.vertices.saturating_sub(SURE_VERTICES) as i32);
            let scale = sample.scale * visible.share / (root.determinant.abs() * continued);
            let walker = &walker.path;
            let light = walker.beta * visible.transmittance.unwrap_or(Lanes::ONE) * (walker.lanes.weight() * scale);
            if light.is_zero() {
                return None;
            }
            let distance = sample.target.distance(from);
            let spread = if distance.is_finite() { (walked + distance) / distance } else { 1.0 };
            let of_chain = walker.beta.max_lane() / (path.beta * f_cos).max_lane();
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
}
