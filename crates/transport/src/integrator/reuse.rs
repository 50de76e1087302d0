//! Paths that neighbouring pixels share (Bekaert, Sbert and Halton 2002, *Accelerating Path Tracing by Re-Using Paths*).
//!
//! The samples of one number of the pixels of a block have their wavelengths in common. Path j leaves its first diffuse surface at xⱼ
//! and finds yⱼ, a diffuse surface or a sky that no shadow ray aims at. What arrives at xⱼ from there arrives at every other first
//! surface xᵢ of the block that sees yⱼ, too. Drawn by any of the paths, a point y has the density p̄(y) = Σₖ pₖ(y) in area measure,
//! pₖ(y) = V(xₖ, y)·cos θₖ/π · cos θ′ₖ/r²ₖ with θ′ₖ at y (the balance heuristic, Veach 1997, §9.2.2). With f = ρᵢ/π pixel i receives
//!
//! ρᵢ Σⱼ wᵢⱼ L(yⱼ),   wᵢⱼ = qᵢⱼ / Σₖ qₖⱼ,   qₖⱼ = V(xₖ, yⱼ)·cos θₖ·cos θ′ₖ/r²ₖ,
//!
//! and cos θₖ alone for a sky. So each path's light is dealt out to the pixels that it could have served: no weight is above ρᵢ. The
//! visibility is part of the densities: weights that left it out would not add up to one where somebody does not see y.
//!
//! Directions of the paths need not be drawn by the cosine alone: of any density p̂ⱼ path j brings its light times pⱼ/p̂ⱼ, and the weights
//! stay those of the cosine. Any weights do that add up to one, and what is left of pixel i's share is
//! Σⱼ ∫ p̂ⱼ (pⱼ/p̂ⱼ) wᵢⱼ L = ∫ (Σⱼ pⱼ) pᵢ/Σₖ pₖ L = ∫ pᵢ L. So directions go toward guided targets of caustics here, too
//! ([`caustics`](crate::guiding)), and no mate asks for the densities of another's.
//!
//! Light that a path finds before x, at x, and on y itself (by MIS with the shadow ray from x) stays its own. So does all light of a path
//! whose first surface is not diffuse, or that meets a mirror or glass there.

#[cfg(test)]
mod room;
#[cfg(test)]
mod tests;

use crate::bsdf::lambert::toward;
use crate::film::{Counters, Sums};
use crate::integrator::film_entry::{FilmEntry, Received, SampleId};
use crate::integrator::tracer::{PixelSamples, Tracer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::integrator::{Arrival, Intersection, Path};
use crate::polarisation::{Averaged, Polarisation};
use crate::sampler::Sampler;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::prepare::Prepared;
use crate::scene::world::World;
use crate::wavelength::Wavelengths;
use etalon_geometry::{Ray, SurfaceId, SurfacePoint};
use etalon_optics::{Lanes, Vec3};
use std::collections::BTreeMap;

/// Most pixels of a block.
pub(crate) const MAX_BLOCK_PIXELS: usize = 16;

/// How far a path has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Its first surface that is no delta is still to come.
    Begins,
    /// It has left x.
    Left,
    /// Its light since y is for all.
    SampleAllocation,
    /// It has no x, or none that others can be of use to.
    Alone,
    /// It has an x, but what it met from there is for itself.
    Receives,
}

/// Where a path leaves its first diffuse surface.
#[derive(Clone, Copy, Debug)]
struct Start<const N: usize> {
    /// The edges of the path up to here, as far as they count.
    edges: u32,
    point: SurfacePoint<f64>,
    /// The normal on the side that the path came from.
    normal: Vec3<f64>,
    /// Throughput from the camera up to here, the reflectance here included.
    beta: Lanes<f64, N>,
}

/// What it finds from there.
#[derive(Clone, Copy, Debug)]
enum Target {
    /// A point of a surface, and the normal on the side that is seen.
    Surface { position: Vec3<f64>, surface: SurfaceId, normal: Vec3<f64> },
    /// A sky, in this direction.
    Sky(Vec3<f64>),
}

/// What one path brings into its block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReusePath<const N: usize> {
    stage: Stage,
    start: Start<N>,
    target: Target,
    /// Radiance that is its pixel's alone.
    own: Lanes<f64, N>,
    /// Radiance that leaves y toward x.
    shared: Lanes<f64, N>,
}

impl<const N: usize> ReusePath<N> {
    /// Of a path that begins.
    pub(crate) const NOTHING: Self = Self {
        stage: Stage::Begins,
        start: Start {
            edges: 0,
            point: SurfacePoint {
                position: Vec3::ZERO,
                position_error: 0.0,
                normal: Vec3::ZERO,
                surface: SurfaceId::NONE,
                label: 0,
                time: 0.0,
            },
            normal: Vec3::ZERO,
            beta: Lanes::ZERO,
        },
        target: Target::Sky(Vec3::ZERO),
        own: Lanes::ZERO,
        shared: Lanes::ZERO,
    };

    /// The path has taken a step from a vertex, but for the guiding weight of the direction. The first that is no delta is from x: its
    /// throughput up to there, with the reflectance, is kept, and begins anew; what roulette goes by does not.
    #[inline(always)]
    pub(crate) fn leave<'a, M: WavelengthModel<N>, P: Polarisation<N>>(
        &mut self,
        world: &World<'a>,
        path: &mut Path<'a, M, P, N>,
        vertex: &SurfaceInteraction<'a>,
        delta: bool,
    ) {
        if self.stage != Stage::Begins || delta || !path.beta.is_finite() {
            return;
        }
        if !(world.tables.is_diffuse(vertex.surface.object) && path.lanes.together()) {
            self.stage = Stage::Alone;
            return;
        }
        let normal = toward(vertex.point.normal, vertex.wo);
        self.start = Start { edges: path.edges(1), point: vertex.point, normal, beta: path.beta };
        self.stage = Stage::Left;
        self.own = path.radiance;
        path.radiance = Lanes::ZERO;
        path.eta_squared *= path.beta.max_lane();
        path.beta = Lanes::ONE;
    }

    /// The path has met a surface that scatters it and taken what that emits. If it has left x, this is y.
    #[inline(always)]
    pub(crate) fn arrive(&mut self, world: &World<'_>, vertex: &SurfaceInteraction<'_>, radiance: &mut Lanes<f64, N>) {
        if self.stage != Stage::Left {
            return;
        }
        if !world.tables.is_diffuse(vertex.surface.object) {
            self.stage = Stage::Receives;
            return;
        }
        let SurfacePoint { position, surface, normal, .. } = vertex.point;
        self.target = Target::Surface { position, surface, normal: toward(normal, vertex.wo) };
        self.take(radiance);
        self.stage = Stage::SampleAllocation;
    }

    /// The path has met skies only, in this direction. If it has left x, they are for all, unless a shadow ray aims at one of them.
    #[inline(always)]
    pub(crate) fn escape(&mut self, world: &World<'_>, direction: Vec3<f64>) {
        if self.stage == Stage::Left {
            self.target = Target::Sky(direction);
            self.stage = if world.plain_skies { Stage::SampleAllocation } else { Stage::Receives };
        }
    }

    #[inline(always)]
    fn take(&mut self, radiance: &mut Lanes<f64, N>) {
        self.own += self.start.beta * *radiance;
        *radiance = Lanes::ZERO;
    }

    /// The path has ended with this radiance.
    #[inline(always)]
    pub(crate) fn end(&mut self, mut radiance: Lanes<f64, N>) {
        match self.stage {
            Stage::Begins | Stage::Alone => self.own = radiance,
            Stage::Left | Stage::Receives => self.take(&mut radiance),
            Stage::SampleAllocation => self.shared = radiance,
        }
    }

    /// Whether its first surface is diffuse.
    fn has_start(&self) -> bool {
        matches!(self.stage, Stage::Left | Stage::SampleAllocation | Stage::Receives)
    }
}

/// q of one first surface and one target, but for the visibility, and the shadow ray that tells that; 0 where the surfaces are
/// turned away from each other.
#[inline(always)]
fn facing<const N: usize>(x: &Start<N>, target: &Target) -> f64 {
    match target {
        Target::Surface { position, normal, .. } => {
            let d = *position - x.point.position;
            let (r_squared, at_x, at_y) = (d.dot(d), x.normal.dot(d), -normal.dot(d));
            if at_x > 0.0 && at_y > 0.0 { (at_x / r_squared) * (at_y / r_squared) } else { 0.0 }
        }
        Target::Sky(direction) => x.normal.dot(*direction).max(0.0),
    }
}

/// The ray that tells whether a first surface sees a target.
#[inline(always)]
fn shadow_ray<const N: usize>(x: &Start<N>, target: &Target) -> Ray<f64> {
    match *target {
        Target::Surface { position, surface, .. } => x.point.spawn_to(position, surface),
        Target::Sky(direction) => x.point.spawn(direction),
    }
}

/// What each pixel of a block receives from all paths, in the order of the pixels, put into `radiance`. `occluded` tells of some rays which
/// of them are cut off, one bit each. Returns the number of shadow rays.
#[inline(always)]
pub(crate) fn redistribute<const N: usize>(
    paths: &[ReusePath<N>],
    radiance: &mut [Lanes<f64, N>; MAX_BLOCK_PIXELS],
    mut occluded: impl FnMut(&[Ray<f64>]) -> u64,
) -> u64 {
    let mut received = [Lanes::ZERO; MAX_BLOCK_PIXELS];
    let mut shadow_rays = 0;
    let mut rays = [paths[0].start.point.spawn(Vec3::ZERO); MAX_BLOCK_PIXELS];
    let (mut q, mut of) = ([0.0; MAX_BLOCK_PIXELS], [0; MAX_BLOCK_PIXELS]);
    for (j, path) in paths.iter().enumerate() {
        if path.stage != Stage::SampleAllocation || path.shared.is_zero() {
            continue;
        }
        let mut count = 0;
        for (i, mate) in paths.iter().enumerate() {
            q[i] = 0.0;
            // Light may take as many steps from there as are left to path j.
            if !mate.has_start() || mate.start.edges != path.start.edges {
                continue;
            }
            q[i] = facing(&mate.start, &path.target);
            // That its own path sees it is known.
            if i != j && q[i] > 0.0 {
                rays[count] = shadow_ray(&mate.start, &path.target);
                of[count] = i;
                count += 1;
            }
        }
        shadow_rays += count as u64;
        let hidden = if count == 0 { 0 } else { occluded(&rays[..count]) };
        for (ray, &i) in of[..count].iter().enumerate() {
            if hidden >> ray & 1 == 1 {
                q[i] = 0.0;
            }
        }
        let total: f64 = q[..paths.len()].iter().sum();
        if q[j] > 0.0 {
            for i in 0..paths.len() {
                if q[i] > 0.0 {
                    received[i] += path.shared * (q[i] / total);
                }
            }
        } else {
            // So flat to the surface that rounding took it below: its own.
            received[j] += path.shared;
        }
    }
    for (i, path) in paths.iter().enumerate() {
        radiance[i] = if path.has_start() { path.own + path.start.beta * received[i] } else { path.own };
    }
    shadow_rays
}

/// The pixels of whole blocks, one block after the other: the pixels asked for, and the others of their blocks, whose paths are
/// traced for them.
pub(crate) struct Blocks {
    pub all_samples: Vec<PixelSamples>,
    /// How many pixels the block has that begins there; of others 0.
    pub block_pixels: Vec<usize>,
    /// The place of each among the pixels asked for; `None` of the others.
    pub kept: Vec<Option<usize>>,
}

impl Blocks {
    /// The blocks of `block` pixels that hold these pixels, on a film of this size. They begin at the corner of the film, whichever part of it
    /// is rendered, so that a sample is the same in each.
    pub(crate) fn of(all_samples: &[PixelSamples], block: [u32; 2], film: [u32; 2]) -> Self {
        let mut of_block: BTreeMap<_, Vec<(u32, u32, usize)>> = BTreeMap::new();
        for (place, pixel_samples) in all_samples.iter().enumerate() {
            let corner = [pixel_samples.y / block[1] * block[1], pixel_samples.x / block[0] * block[0]];
            let key = (corner, pixel_samples.samples.start, pixel_samples.samples.end);
            of_block.entry(key).or_default().push((pixel_samples.x, pixel_samples.y, place));
        }
        let mut blocks = Self { all_samples: Vec::new(), block_pixels: Vec::new(), kept: Vec::new() };
        for (([y0, x0], start, end), held) in of_block {
            let first = blocks.all_samples.len();
            for y in y0..(y0 + block[1]).min(film[1]) {
                for x in x0..(x0 + block[0]).min(film[0]) {
                    let place = held.iter().find(|(of_x, of_y, _)| (*of_x, *of_y) == (x, y));
                    blocks.kept.push(place.map(|(.., place)| *place));
                    blocks.all_samples.push(PixelSamples { x, y, samples: start..end });
                    blocks.block_pixels.push(0);
                }
            }
            blocks.block_pixels[first] = blocks.all_samples.len() - first;
        }
        blocks
    }
}

/// [`trace`](crate::integrator::trace), with what the path brings into its block.
fn trace_gathering<'a, M: WavelengthModel<N>, const N: usize>(
    world: &World<'a>,
    path: &mut Path<'a, M, Averaged, N>,
    mut ray: Ray<f64>,
    sampler: &Sampler,
    counters: &mut Counters,
) -> ReusePath<N> {
    let mut reuse_path = ReusePath::NOTHING;
    let observer = &mut ();
    loop {
        counters.rays += 1;
        counters.lane_weights += u64::from(M::CARRIES_WEIGHTS);
        let mut met = world.intersect(&ray, &mut path.walk, &mut path.stack, counters);
        match path.arrive(world, &ray, Intersection::of(met.as_mut()), sampler, counters, observer) {
            Arrival::Scatters => {}
            Arrival::Passed => continue,
            Arrival::Collides => unreachable!("no plan shares paths where media scatter"),
            Arrival::Ended => break,
            Arrival::Escaped => {
                reuse_path.escape(world, ray.direction);
                break;
            }
        }
        let Some(vertex) = met else { break };
        reuse_path.arrive(world, &vertex, &mut path.radiance);
        if vertex.sees_lights {
            path.direct_light(world, &vertex, sampler, counters, observer);
            path.connect(world, &vertex, sampler, counters, observer);
        }
        let [u_lobe, u1, u2, u_roulette] = sampler.vertex_set(path.vertex, 0);
        let Some(direction) = path.sample_direction(world, &vertex, [u_lobe, u1, u2], observer) else { break };
        let taken = path.scatter(world, &vertex, direction, u_lobe);
        reuse_path.leave(world, path, &vertex, taken.delta);
        if !path.survives(world, taken.guiding, u_roulette, observer) {
            break;
        }
        ray = vertex.point.spawn(taken.wi);
    }
    reuse_path.end(path.radiance);
    reuse_path
}

/// The samples of some pixels, one path at a time.
pub(crate) fn render_pixels<M: WavelengthModel<N>, const N: usize>(
    prepared: &Prepared,
    all_samples: &[PixelSamples],
    sums: Sums<'_>,
    rays: &mut [u64],
) -> Counters {
    let film = &prepared.scene.film;
    let block = prepared.path_reuse().expect("only where paths are shared");
    let blocks = Blocks::of(all_samples, block, [film.width, film.height]);
    let tracer = Tracer::new(prepared);
    let mut counters = Counters::default();
    let mut adding = BlockEntry::new(prepared, sums, rays);
    let mut path = Path::<M, Averaged, N>::idle();
    for (first, &block_pixels) in blocks.block_pixels.iter().enumerate().filter(|(_, block_pixels)| **block_pixels > 0)
    {
        let pixels = &blocks.all_samples[first..first + block_pixels];
        let mut reuse_path = [ReusePath::NOTHING; MAX_BLOCK_PIXELS];
        let mut rays_of = [0; MAX_BLOCK_PIXELS];
        for sample in pixels[0].samples.clone() {
            let mut shared = None;
            for (mate, pixel) in pixels.iter().enumerate() {
                let before = counters.rays + counters.shadow_rays;
                let sampler = tracer.sampler(pixel.x, pixel.y, sample);
                // Compound lenses share no paths, so none is blocked.
                let (start, _) = tracer.start::<M, Averaged, N>(pixel.x, pixel.y, sample, &sampler, &mut counters);
                path.begin(&tracer.world, &start);
                reuse_path[mate] = trace_gathering(&tracer.world, &mut path, start.ray, &sampler, &mut counters);
                rays_of[mate] = counters.rays + counters.shadow_rays - before;
                shared = Some(start.wavelengths);
            }
            let mut radiance = [Lanes::ZERO; MAX_BLOCK_PIXELS];
            let occluded = |rays: &[Ray<f64>]| {
                let hidden = rays.iter().enumerate().filter(|(_, ray)| prepared.geometry.occluded(ray));
                hidden.fold(0, |mask, (ray, _)| mask | 1 << ray)
            };
            let shadow_rays = redistribute(&reuse_path[..block_pixels], &mut radiance, occluded);
            counters.shadow_rays += shadow_rays;
            rays_of[0] += shadow_rays;
            let wavelengths = shared.expect("a block has a pixel");
            for (mate, pixel) in pixels.iter().enumerate() {
                let place = (blocks.kept[first + mate], pixel.x, pixel.y, sample);
                adding.add::<M, N>(place, rays_of[mate], &wavelengths, radiance[mate], &mut counters);
            }
        }
    }
    counters
}

/// Adds the samples of blocks to the sums of pixels.
pub(crate) struct BlockEntry<'a> {
    prepared: &'a Prepared,
    film: FilmEntry<'a>,
    /// The pixel whose block's rays nobody else counts.
    last: usize,
}

impl<'a> BlockEntry<'a> {
    pub(crate) fn new(prepared: &'a Prepared, sums: Sums<'a>, rays: &'a mut [u64]) -> Self {
        Self { prepared, film: FilmEntry::new(prepared, sums, rays), last: 0 }
    }

    /// A sample of the pixel number `.0`, or of another of its block, at (`.1`, `.2`). The rays of the others count for one of the pixels asked for.
    #[inline(always)]
    pub(crate) fn add<M: WavelengthModel<N>, const N: usize>(
        &mut self,
        (pixel_samples, x, y, sample): (Option<usize>, u32, u32, u32),
        rays: u64,
        wavelengths: &Wavelengths<N>,
        radiance: Lanes<f64, N>,
        counters: &mut Counters,
    ) {
        self.last = pixel_samples.unwrap_or(self.last);
        self.film.count_rays(self.last, rays);
        let Some(pixel_samples) = pixel_samples else { return };
        let xyz = if radiance.is_zero() { [0.0; 3] } else { M::to_xyz(self.prepared, wavelengths, radiance) };
        let received = Received::unpolarised(*wavelengths, radiance);
        self.film.add::<M, N>(SampleId { pixel_samples, x, y, sample }, xyz, &received, counters);
    }
}
