//! Watching a single path, for replays and for counting; costs nothing when nobody watches.

use crate::guiding::Mixture;
use etalon_optics::{Lanes, Vec3};

/// What ended a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// It left the scene.
    Escaped,
    /// The camera's lens blocks it, before it begins.
    Blocked,
    /// The surface scattered nothing on.
    Absorbed,
    /// Its throughput fell below the floor.
    Vanished,
    /// Russian roulette.
    Roulette,
    /// The limit on depth.
    Depth,
    /// Its throughput is no longer a finite number.
    NonFinite,
}

/// A watcher of a path. Every method does nothing unless it is implemented.
pub(crate) trait Observer<const N: usize> {
    /// The path meets a surface: vertex number `vertex` (0 is the first), where, which object, and its throughput so far.
    fn vertex(&mut self, _vertex: u32, _position: Vec3<f64>, _object: u32, _beta: Lanes<f64, N>) {}
    /// A medium scatters the path: vertex number `vertex`, where, and its throughput so far.
    fn scattering(&mut self, _vertex: u32, _position: Vec3<f64>, _beta: Lanes<f64, N>) {}
    /// Light reaches a vertex at other wavelengths than it leaves it, nm: from here on the path carries these.
    fn fluoresces(&mut self, _vertex: u32, _excitation_nm: Lanes<f64, N>) {}
    /// Light is added: at which vertex, how, and how much in each lane at the camera.
    fn light(&mut self, _vertex: u32, _how: Found, _radiance: Lanes<f64, N>) {}
    /// A direction is drawn from a mixture.
    fn direction(&mut self, _mixture: &Mixture) {}
    /// A specular connection was tried, from a vertex to which the path has come straight from one that scatters or not, and took this many rays.
    fn connection(&mut self, _indirect: bool, _rays: u64) {}
    /// The path ends.
    fn end(&mut self, _end: End) {}
}

/// How light was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// The path ran into an emitting surface.
    Emitter,
    /// The path left the scene into the environment.
    Environment,
    /// A medium that the path went through emits.
    Medium,
    /// A shadow ray reached the light of this index.
    ShadowRay {
        /// Index into the table of lights.
        light: u32,
    },
    /// A chain of mirrors and smooth interfaces was found that leads to the light of this index.
    SpecularConnection {
        /// Index into the table of lights.
        light: u32,
    },
}

impl<const N: usize> Observer<N> for () {}

/// For all observers but `()`: so a kernel is compiled twice, with and without an observer. Such a call takes little beside its work.
impl<const N: usize> Observer<N> for &mut dyn Observer<N> {
    fn vertex(&mut self, vertex: u32, position: Vec3<f64>, object: u32, beta: Lanes<f64, N>) {
        (**self).vertex(vertex, position, object, beta);
    }

    fn scattering(&mut self, vertex: u32, position: Vec3<f64>, beta: Lanes<f64, N>) {
        (**self).scattering(vertex, position, beta);
    }

    fn fluoresces(&mut self, vertex: u32, excitation_nm: Lanes<f64, N>) {
        (**self).fluoresces(vertex, excitation_nm);
    }

    fn light(&mut self, vertex: u32, how: Found, radiance: Lanes<f64, N>) {
        (**self).light(vertex, how, radiance);
    }

    fn direction(&mut self, mixture: &Mixture) {
        (**self).direction(mixture);
    }

    fn connection(&mut self, indirect: bool, rays: u64) {
        (**self).connection(indirect, rays);
    }

    fn end(&mut self, end: End) {
        (**self).end(end);
    }
}
