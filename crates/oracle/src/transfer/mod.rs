//! Radiative transfer: how much light comes back from media that scatter and absorb, without random numbers.
//!
//! | for | see | second evaluation |
//! |---|---|---|
//! | a half-space that scatters alike in all directions | [`HalfSpace`]: Chandrasekhar's H-function as an integral | his equation for H, by iteration |
//! | a slab of any phase function that depends on one angle | [`Slab`]: doubling of thin layers | [`by_scattering_orders`]: the transfer equation on a grid of depths, order by order |
//! | a slab that scatters alike in all directions | [`Slab`] | [`IsotropicSlab`]: the integral equation for its source function |
//! | a slab of air, with polarisation, above a diffuse ground | [`Air`]: doubling, for I, Q and U | [`AirByOrders`]: the transfer equation on a grid of depths for the tensor of the field |
//! | light that is scattered once | [`scattered_once`], [`glow_of_point_lamp`] | quadrature |
//! | a ball that absorbs | [`ball_transmittance`] | quadrature over its chords |
//!
//! Optical depths τ are along the normal of a layer. Angles are given by the cosines μ to it. ϖ is the albedo of a single scattering. The
//! phase functions here have the mean 1 over the sphere.

mod air;
mod air_orders;
mod doubling;
mod half_space;
mod layer;
mod orders;
mod phase;
mod single;
mod source_function;

pub use air::{Air, Leaving};
pub use air_orders::AirByOrders;
pub use doubling::{Fluxes, Slab};
pub use half_space::HalfSpace;
pub use orders::by_scattering_orders;
pub use phase::{henyey_greenstein, legendre_moments};
pub use single::{ball_transmittance, glow_of_point_lamp, scattered_once};
pub use source_function::IsotropicSlab;
