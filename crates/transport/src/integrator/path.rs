//! The state of a path between two of its steps, and the steps.

use super::MOST_VERTICES;
use crate::film::Counters;
use crate::integrator::film_entry::Received;
use crate::integrator::fluorescence::Reradiated;
use crate::integrator::observer::{End, Observer};
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::Look;
use crate::media::{MediumInteraction, MediumStack};
use crate::polarisation::Polarisation;
use crate::sampler::Sampler;
use crate::scene::interaction::{SurfaceInteraction, Walk};
use crate::scene::shading_tables::{Slot, SpectrumCache};
use crate::scene::world::World;
use crate::spectral::Colour;
use crate::wavelength::Wavelengths;
use etalon_geometry::{Ray, SurfaceId};
use etalon_optics::{Lanes, Vec3};

/// A path under way: what it has gathered, and what its next step depends on.
pub(crate) struct Path<'a, M, P, const N: usize> {
    pub wavelengths: Wavelengths<N>,
    /// Radiance found so far.
    pub radiance: Lanes<f64, N>,
    /// Throughput: ∏ f·|cos θ|/p, with the hero's p.
    pub beta: Lanes<f64, N>,
    /// The lanes' densities of the path, relative to the hero's.
    pub lanes: M,
    pub polarisation: P,
    /// Number of the vertex that it is at, or that its ray leads to.
    pub vertex: u32,
    /// How many of its vertices are panes that it has passed and that do not count.
    pub(super) uncounted: u32,
    /// ∏ η²: the part of beta that comes back when the path leaves the medium, which roulette must not count.
    pub eta_squared: f64,
    /// Product of guiding weights since the last diffuse vertex; excluded from Russian roulette.
    pub(super) guiding: f64,
    /// The last step of the walk, as far as MIS needs it.
    pub(super) step: Step,
    /// Which of the light that it finds is left to light paths.
    pub(super) light_traced: LightTraced,
    /// The media that it is in, where they are followed.
    pub stack: MediumStack<'a>,
    /// How far it has come along its ray.
    pub walk: Walk<'a>,
    /// Surfaces passed as if they were not there, which are no vertices of the path, and where the last one was on this ray.
    passes: u32,
    pub(super) passed_at: Option<Vec3<f64>>,
    /// The number that decides whether the next surface is passed, once one was.
    u_mask: Option<f64>,
    /// The optical depth on its ray, from where it is, at which a medium scatters it, once one was met that scatters.
    pub(super) optical_depth: Option<f64>,
    /// Where a medium scatters it, once it does.
    pub(super) collision: Option<MediumInteraction<'a>>,
    pub(super) spectra: SpectrumCache<N>,
    /// What it has at the camera, once a surface has fluoresced: its lanes are then at other wavelengths.
    pub(super) reradiated: Option<Box<Reradiated<P, N>>>,
}

/// Where a path begins.
pub(crate) struct Start<'a, P, const N: usize> {
    pub ray: Ray<f64>,
    /// The media that hold the camera, where they are followed.
    pub stack: Option<MediumStack<'a>>,
    pub wavelengths: Wavelengths<N>,
    pub polarisation: P,
    /// What radiance along the ray counts for.
    pub weight: f64,
    /// Whether the ray is the hero's alone: the lens of the camera disperses.
    pub hero_only: bool,
}

impl<P: Polarisation<N>, const N: usize> Start<'_, P, N> {
    /// That of a path which the lens of the camera blocks: it brings nothing.
    #[inline(always)]
    pub(crate) fn blocked(wavelengths: Wavelengths<N>) -> Self {
        let ray = Ray::free(Vec3::ZERO, Vec3::new(0.0, 0.0, 1.0));
        let polarisation = P::at_camera(ray.direction, Vec3::new(1.0, 0.0, 0.0));
        Self { ray, stack: None, wavelengths, polarisation, weight: 0.0, hero_only: false }
    }
}

/// The last step of a walk.
#[derive(Clone, Copy)]
pub(super) enum Step {
    /// From the camera or by a delta: no shadow ray could have found what it finds.
    Unshared,
    /// Drawn with this density, the mean over the lanes, from this point of this primitive, where a shadow ray was sent too.
    /// If the path has gone through smooth interfaces since, the density is that of coming through.
    Shared { from: Vec3<f64>, leaves: SurfaceId, density: f64, since: Since },
}

/// Which of the light that a path finds is left to light paths: see [`light_tracing`](super::light_tracing).
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LightTraced {
    /// That which comes by way of specular objects to a vertex that scatters.
    AfterSpecular,
    /// That which it meets next as well, since it came by way of specular objects from such a vertex.
    Now,
    /// None: the camera sees a mirror or glass first, or something was in the way that light paths do not go through.
    Never,
}

/// What a path has met since its last vertex that scatters.
#[derive(Clone, Copy)]
pub(super) enum Since {
    Nothing,
    /// Surfaces of which only a part is there, or that shine, which it has passed. Behind them, shadow rays go straight only. With the last that
    /// shines.
    Mask(SurfaceId),
    /// Smooth interfaces, which it has gone through.
    Interfaces(Through),
}

/// Smooth interfaces that a path has gone through.
#[derive(Clone, Copy)]
pub(super) struct Through {
    /// The direction in which it left its last vertex that scatters.
    pub wi: Vec3<f64>,
    /// How many.
    pub interfaces: u32,
}

/// What a ray meets.
pub(crate) enum Intersection<'m, 'a> {
    Surface(&'m mut SurfaceInteraction<'a>),
    /// Nothing; and what the first image of the sky shows there, if the driver has looked.
    Nothing(Option<Look>),
}

impl<'m, 'a> Intersection<'m, 'a> {
    #[inline(always)]
    pub(crate) fn of(surface: Option<&'m mut SurfaceInteraction<'a>>) -> Self {
        surface.map_or(Self::Nothing(None), Self::Surface)
    }

    #[inline(always)]
    fn surface(&self) -> Option<&SurfaceInteraction<'a>> {
        match self {
            Self::Surface(surface) => Some(surface),
            Self::Nothing(_) => None,
        }
    }
}

/// What becomes of a path at the end of its ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// It has left the scene and ended.
    Escaped,
    /// It ends at the surface that it has met.
    Ended,
    /// It passes the surface as if that were not there: its ray goes on.
    Passed,
    /// The surface scatters it: the next vertex of the path.
    Scatters,
    /// A medium scatters it before it comes to the surface.
    Collides,
}

impl<'a, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Path<'a, M, P, N> {
    /// A place for paths.
    pub(crate) fn idle() -> Self {
        let (x, y) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0));
        Self {
            wavelengths: Wavelengths::fixed([0.0; N]),
            radiance: Lanes::ZERO,
            beta: Lanes::ONE,
            lanes: M::start(&Wavelengths::fixed([0.0; N])),
            polarisation: P::at_camera(x, y),
            vertex: 0,
            uncounted: 0,
            eta_squared: 1.0,
            guiding: 1.0,
            step: Step::Unshared,
            light_traced: LightTraced::AfterSpecular,
            stack: MediumStack::NOTHING,
            walk: Walk::default(),
            passes: 0,
            passed_at: None,
            u_mask: None,
            optical_depth: None,
            collision: None,
            spectra: SpectrumCache::new(),
            reradiated: None,
        }
    }

    /// Begins a path here.
    #[inline(always)]
    pub(crate) fn begin(&mut self, world: &World<'a>, start: &Start<'a, P, N>) {
        self.wavelengths = start.wavelengths;
        self.radiance = Lanes::ZERO;
        self.beta = Lanes::splat(start.weight);
        self.lanes = M::start(&start.wavelengths);
        if start.hero_only {
            // As behind an interface that disperses.
            self.beta = self.beta.hero_only();
            self.lanes.follow(Lanes::ONE.hero_only());
        }
        self.polarisation = start.polarisation;
        (self.vertex, self.uncounted) = (0, 0);
        self.eta_squared = 1.0;
        self.guiding = 1.0;
        self.step = Step::Unshared;
        self.light_traced = LightTraced::AfterSpecular;
        if let Some(stack) = start.stack {
            self.stack = stack;
        }
        self.passes = 0;
        self.leave_ray(world);
        self.spectra.forget(&self.wavelengths.lambda_nm, true);
        self.reradiated = None;
    }

    /// The wavelengths of what it brings to the camera.
    #[inline(always)]
    pub(crate) fn wavelengths_at_camera(&self) -> &Wavelengths<N> {
        self.reradiated.as_ref().map_or(&self.wavelengths, |reradiated| &reradiated.wavelengths)
    }

    /// What it brings to the camera.
    #[inline(always)]
    pub(crate) fn received(&self) -> Received<N> {
        let (wavelengths, polarisation) = match &self.reradiated {
            None => (self.wavelengths, &self.polarisation),
            Some(reradiated) => (reradiated.wavelengths, &reradiated.polarisation),
        };
        Received { wavelengths, radiance: self.radiance, stokes: polarisation.received() }
    }

    /// Arrives at what the ray has met, unless a medium scatters the path before: light is absorbed on the way, and found there.
    #[inline(always)]
    pub(crate) fn arrive(
        &mut self,
        world: &World<'a>,
        ray: &Ray<f64>,
        met: Intersection<'_, 'a>,
        sampler: &Sampler,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> Arrival {
        if world.participating.is_some() && self.travel(world, ray, met.surface(), sampler, counters, observer) {
            return match self.is_too_deep(world, false, counters, observer) {
                true => Arrival::Ended,
                false => Arrival::Collides,
            };
        }
        let vertex = match met {
            Intersection::Surface(vertex) => vertex,
            Intersection::Nothing(sky) => {
                if !(world.hides_lights && self.vertex == 0) {
                    self.add_environments(world, ray, sky, counters, observer);
                }
                observer.end(End::Escaped);
                return Arrival::Escaped;
            }
        };
        if world.hides_lights && self.vertex == 0 && vertex.surface.shines() && self.passes < MOST_VERTICES {
            self.pass(vertex);
            return Arrival::Passed;
        }
        observer.vertex(self.vertex, vertex.point.position, vertex.surface.object, self.beta);
        self.add_emission(world, ray, vertex, observer);
        if world.masks && self.passes(world, vertex, sampler) {
            return Arrival::Passed;
        }
        let may_pass = !world.counts_panes && world.tables.passes_straight(vertex.surface.material);
        if self.is_too_deep(world, may_pass, counters, observer) {
            return Arrival::Ended;
        }
        vertex.prepare_scattering(world);
        // Where only a pane that does not count goes on, a shadow ray would be one edge too many.
        vertex.sees_lights &= !may_pass || self.edges(2) <= world.max_depth;
        if world.fluoresces {
            self.fluoresce(world, vertex, sampler, observer);
        }
        Arrival::Scatters
    }

    /// The edges of the path from the camera to vertex number `vertex + further - 1`, as far as they count.
    #[inline(always)]
    pub(super) fn edges(&self, further: u32) -> u32 {
        self.vertex + further - self.uncounted
    }

    /// Whether a lamp can be found by way of one more mirror, interface or pane.
    #[inline(always)]
    pub(super) fn has_edges_for_a_chain(&self, world: &World<'a>) -> bool {
        self.edges(if world.counts_panes { 3 } else { 2 }) <= world.max_depth
    }

    /// Whether it ends here because it has as many edges as it may have. `may_pass`: by a pane that does not count it may go on.
    #[inline(always)]
    fn is_too_deep(
        &self,
        world: &World<'a>,
        may_pass: bool,
        counters: &mut Counters,
        observer: &mut impl Observer<N>,
    ) -> bool {
        let is_longest = self.vertex + 1 == MOST_VERTICES;
        if !is_longest && (self.edges(1) < world.max_depth || may_pass) {
            return false;
        }
        if is_longest {
            counters.record_cut(self.beta.max_lane() * self.lanes.weight());
        }
        observer.end(End::Depth);
        true
    }

    /// Whether the path passes a surface that lets a part of the light through. It then goes on along the same ray: a straight
    /// shadow ray would have passed here too.
    #[inline(always)]
    fn passes(&mut self, world: &World<'a>, vertex: &SurfaceInteraction<'a>, sampler: &Sampler) -> bool {
        let opacity = vertex.opacity(world);
        if opacity == 1.0 || self.passes == MOST_VERTICES {
            return false;
        }
        let u = self.u_mask.unwrap_or_else(|| sampler.vertex_set(self.vertex, 1)[3]);
        if u < opacity {
            return false;
        }
        // What is left of the number is uniform again.
        self.u_mask = Some((u - opacity) / (1.0 - opacity));
        let shines = vertex.surface.shines();
        if (opacity > 0.0 || shines)
            && let Step::Shared { since, .. } = &mut self.step
        {
            match since {
                Since::Interfaces(_) => self.step = Step::Unshared,
                Since::Mask(_) if !shines => {}
                Since::Nothing | Since::Mask(_) => {
                    *since = Since::Mask(if shines { vertex.point.surface } else { SurfaceId::NONE });
                }
            }
        }
        self.pass(vertex);
        true
    }

    /// Passes a surface on the same ray.
    #[inline(always)]
    fn pass(&mut self, vertex: &SurfaceInteraction<'a>) {
        self.passes += 1;
        self.passed_at = Some(vertex.point.position);
        self.walk.pass(vertex, &mut self.stack);
    }

    /// Forgets how far the path has come along its ray.
    #[inline(always)]
    pub(super) fn leave_ray(&mut self, world: &World<'a>) {
        if world.meets_groups {
            self.walk.restart();
            (self.passed_at, self.u_mask) = (None, None);
        }
        if world.participating.is_some() {
            self.optical_depth = None;
        }
    }

    /// Whether light paths bring the light of a lamp, or the bright share of a sky that shadow rays aim at, which it has met.
    #[inline(always)]
    pub(super) fn is_light_traced(&self, world: &World<'a>) -> bool {
        world.specular_objects.is_some() && self.light_traced == LightTraced::Now
    }

    /// Whether light paths bring what comes by way of specular objects to the vertex at which it is, where that scatters.
    #[inline(always)]
    pub(super) fn is_light_traced_after_specular(&self, world: &World<'a>) -> bool {
        world.specular_objects.is_some() && self.light_traced != LightTraced::Never
    }

    /// Whether its last step was from a vertex that scatters into every direction.
    pub(super) fn is_indirect(&self) -> bool {
        matches!(self.step, Step::Shared { since: Since::Nothing | Since::Mask(_), .. })
    }

    /// A spectrum of the tables at the path's wavelengths.
    #[inline(always)]
    pub(super) fn spectrum(&mut self, world: &World<'a>, slot: u8) -> Lanes<f64, N> {
        self.spectra.spectrum(slot, world.tables, &self.wavelengths)
    }

    /// The reflectance of a surface of the kind [`BsdfKind::Lambert`].
    #[inline(always)]
    pub(super) fn diffuse_reflectance(
        &mut self,
        world: &World<'a>,
        vertex: &SurfaceInteraction<'a>,
        slot: Slot,
    ) -> Lanes<f64, N> {
        match slot {
            Some(slot) => self.spectrum(world, slot),
            None => self.spectra.colour(Colour::Rgb(vertex.colour), &self.wavelengths.lambda_nm),
        }
    }

    /// The spectrum of a light; where an image colours it, its white.
    #[inline(always)]
    pub(super) fn spectrum_of_light(&mut self, world: &World<'a>, light: u32) -> Lanes<f64, N> {
        let slot = world.tables.lights[light as usize];
        self.spectra.of(slot, world.lights.lights()[light as usize].spectrum(), world.tables, &self.wavelengths)
    }

    /// A white in the colour that an image gives it.
    #[inline(always)]
    pub(super) fn coloured(&mut self, white: Lanes<f64, N>, colour: Option<Colour>) -> Lanes<f64, N> {
        match colour {
            None => white,
            Some(colour) => white * self.spectra.colour(colour, &self.wavelengths.lambda_nm),
        }
    }
}
