//! The rendering equation along a path, one step at a time.
//!
//! L(x, ω) = Le(x, ω) + ∫ f(x, ω, ω′) L(x′, −ω′) |cos θ′| dω′ is estimated along one random walk from the camera. At each
//! vertex the light that arrives from the lights themselves is found in two ways, by a shadow ray toward a light and by
//! the walk's own next step, combined by multiple importance sampling (Veach 1997).
//!
//! A [`Path`] is the state of one such walk, and its methods are the steps: [`Path::arrive`], [`Path::next_event`],
//! [`Path::add_light`], [`Path::scatter`], [`Path::survives`]. Two drivers call them in the same order: [`trace`] follows one path at a
//! time, and [`batch`](crate::batch) many, for which it casts rays and draws directions with vector instructions. Every rule of the
//! estimator is in these steps, once.
//!
//! **Wavelengths.** All lanes follow the path that the hero drew. `beta` is f/p along it with the hero's p, and `lanes`
//! ([`WavelengthModel`](crate::integrator::wavelength_lanes::WavelengthModel)) knows each lane's own density of the same path relative to the hero's, where
//! they can differ. The balance heuristic over the lanes that could have been hero (Wilkie et al. 2014, eq. 5) then weighs lane j by
//! N·beta_j / Σ densities: plain `beta` as long as all lanes sample alike, N·beta_hero once dispersion has left the hero
//! alone.
//!
//! **Wavelengths and MIS.** Where the lanes' densities of a direction differ, the weights of shadow rays and of the walk
//! must not depend on which lane is the hero, or the two no longer add up to one for the lanes together. So what meets a
//! light's density is the mean of the lanes' own densities, each weighed by its share of the path so far.

pub(crate) mod connection_trial;
mod emission;
pub(crate) mod film_entry;
mod fluorescence;
pub(crate) mod light_choice_trial;
pub(crate) mod light_tracing;
mod medium;
mod next_event;
pub mod observer;
mod path;
pub mod replay;
pub(crate) mod reuse;
mod scalar;
mod scatter;
mod specular;
pub(crate) mod tracer;
pub(crate) mod trial;
mod vertex;
pub(crate) mod wavelength_lanes;
pub(crate) mod wavelength_trial;

pub(crate) use next_event::{LambertTerms, LightDraw, NextEvent, beyond_target, light_weight};
pub(crate) use path::{Arrival, Intersection, Path, Start};
pub(crate) use scalar::trace;
pub(crate) use scatter::Direction;

/// Below this throughput a path is ended even without roulette: no film value could change (hard case 30).
pub(crate) const THROUGHPUT_FLOOR: f64 = 1e-30;
/// Vertices after which any path is cut, so that a room without absorption ends; such paths are counted and reported.
pub(crate) const MOST_VERTICES: u32 = 1 << 16;
/// Vertices before Russian roulette begins.
pub(crate) const ROULETTE_FROM_VERTEX: u32 = 2;
/// The throughput that a path keeps which roulette lets live. Less is more vertices with less noise; of 1, 1/2, 1/3, 1/4 and 1/8
/// this takes the least time to a given error in rooms of white walls and under the sky (docs/log/2026-11-paths.md).
pub(crate) const ROULETTE_THROUGHPUT: f64 = 0.4;
