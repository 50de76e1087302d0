//! Steps along a chain of mirrors and smooth interfaces.

use crate::film::Counters;
use crate::integrator::vertex::Vertex;
use crate::integrator::wavelength_lanes::{OneLane, WavelengthModel};
use crate::integrator::{Direction, MOST_VERTICES, Path};
use crate::media::{MediumStack, Way};
use crate::mis::Density;
use crate::polarisation::{Averaged, Polarisation};
use crate::sampler::NumberStream;
use crate::scene::interaction::SurfaceInteraction;
use crate::scene::shading_tables::BsdfKind;
use crate::scene::world::World;
use crate::wavelength::Wavelengths;
use etalon_geometry::Ray;
use etalon_optics::{Lanes, Vec3};

/// The share of the chains that are reflected where some light is, and some passes.
const REFLECTS: f64 = 0.2;

/// Walks along chains.
pub(super) struct Walker<'a, M, P, const N: usize> {
    pub path: Path<'a, M, P, N>,
    /// Whether it asks what media let through. Where chains lead does not depend on that.
    asks_media: bool,
    /// [`Path::uncounted`] where chains begin.
    uncounted: u32,
}

/// Finds where chains lead: with the hero alone, which decides that, and without polarisation.
pub(super) type Scout<'a> = Walker<'a, OneLane, Averaged, 1>;

/// A mirror or smooth interface that a walker has come to, before it goes on.
pub(super) struct ChainVertex<'a, const N: usize> {
    pub vertex: SurfaceInteraction<'a>,
    /// What media have let through up to there, times the probability of its lobe over that with which it was chosen.
    pub weight: Lanes<f64, N>,
    /// Where it goes on, and the number that chose among its lobes.
    direction: Direction<N>,
    u_lobe: f64,
}

/// How the vertices of a chain choose among their lobes.
#[derive(Clone, Copy)]
pub(super) struct LobeChoice {
    pub numbers: NumberStream,
    pub lobes: Lobes,
}

/// Which lobe light takes where some is reflected and some passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lobes {
    /// As the numbers say.
    Drawn,
    /// That of what passes, wherever some does; elsewhere as the numbers say.
    Refracted,
    /// The same. A vertex where the numbers would decide ends the chain, so that nothing is drawn.
    Sure,
}

impl<'a> Scout<'a> {
    /// That of chains which begin at a vertex of a path.
    pub(super) fn of<M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(path: &Path<'a, M, P, N>) -> Self {
        let mut scout = Path::idle();
        scout.wavelengths = Wavelengths::fixed([path.hero_nm()]);
        scout.vertex = path.vertex;
        scout.spectra.forget(&scout.wavelengths.lambda_nm, false);
        Self { path: scout, asks_media: false, uncounted: path.uncounted }
    }
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Walker<'a, M, P, N> {
    /// One at the wavelengths of a path, and at its vertex.
    pub(super) fn like(path: &Path<'a, M, P, N>) -> Self {
        let mut walker = Path::idle();
        walker.wavelengths = path.wavelengths;
        walker.vertex = path.vertex;
        walker.spectra = path.spectra.clone();
        Self { path: walker, asks_media: true, uncounted: path.uncounted }
    }

    /// At the vertex of the path that it is like, with what the path has there and what the vertex does to polarisation; the ray in a direction.
    pub(super) fn leave<V: Vertex<'a>>(
        &mut self,
        path: &Path<'a, M, P, N>,
        world: &World<'a>,
        vertex: &V,
        wi: Vec3<f64>,
    ) -> Ray<f64> {
        self.begin(world, media_toward(world, path, vertex, wi));
        let walker = &mut self.path;
        (walker.beta, walker.lanes, walker.polarisation) = (path.beta, path.lanes, path.polarisation);
        walker.polarisation.follow(vertex.wo(), wi, || vertex.mueller(&path.wavelengths.lambda_nm, wi));
        vertex.point().spawn(wi)
    }

    /// Back at the beginning of the chain, in these media if they are followed.
    pub(super) fn begin(&mut self, world: &World<'a>, stack: Option<MediumStack<'a>>) {
        self.path.leave_ray(world);
        self.path.uncounted = self.uncounted;
        if let Some(stack) = stack {
            self.path.stack = stack;
        }
    }

    /// The mirror or smooth interface that the ray meets next; `None` if it meets none.
    pub(super) fn next(
        &mut self,
        world: &World<'a>,
        choice: &LobeChoice,
        ray: &Ray<f64>,
        number: u32,
        counters: &mut Counters,
    ) -> Option<ChainVertex<'a, N>> {
        let Self { path: walker, asks_media, .. } = self;
        let [mut u_lobe, u1, u2, mut u_mask] = choice.numbers.set(u64::from(number));
        if choice.lobes != Lobes::Drawn {
            u_lobe = 1.0_f64.next_down();
        }
        let (mut weight, mut start) = (Lanes::ONE, ray.origin);
        for _ in 0..MOST_VERTICES {
            counters.rays += 1;
            let mut met = world.intersect(ray, &mut walker.walk, &mut walker.stack, counters)?;
            if world.participating.is_some() {
                walker.stack.meet(met.stated_media(), met.meets_front());
                if *asks_media {
                    let length = (met.point.position - start).length();
                    let way = Way { origin: start, direction: ray.direction, length, time: ray.time };
                    weight *= walker.transmittance(world, &walker.stack, &way);
                }
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
                    true if choice.lobes == Lobes::Sure => (false, 1.0 - reflectance),
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
                    if choice.lobes == Lobes::Sure && !met.is_glass(world) {
                        return None;
                    }
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
    pub(super) fn go_on(&mut self, world: &World<'a>, from: ChainVertex<'a, N>) -> Ray<f64> {
        let taken = self.path.scatter(world, &from.vertex, from.direction, from.u_lobe);
        from.vertex.point.spawn(taken.wi)
    }
}

/// The media behind a vertex in a direction, where media are followed. The path knows what is behind the surface that it has met.
pub(super) fn media_toward<'a, V: Vertex<'a>, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize>(
    world: &World<'a>,
    path: &Path<'a, M, P, N>,
    vertex: &V,
    wi: Vec3<f64>,
) -> Option<MediumStack<'a>> {
    world.follows_media().then(|| vertex.media_toward(path, wi))
}
