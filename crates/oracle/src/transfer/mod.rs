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

/// What is known of slabs that scatter alike in all directions and absorb nothing: their optical depth, and the share that they transmit.
#[cfg(test)]
mod known_slabs {
    /// Of light that comes alike from all directions.
    pub(super) const OF_DIFFUSE_LIGHT: [(f64, f64); 6] =
        [(0.1, 0.915_703), (0.5, 0.704_169), (1.0, 0.553_406), (2.0, 0.390_060), (5.0, 0.207_657), (10.0, 0.116_745)];
    /// Of a beam along the normal.
    pub(super) const OF_BEAM: [(f64, f64); 4] =
        [(1.0, 0.658_671), (2.0, 0.482_485), (5.0, 0.261_279), (10.0, 0.146_995)];
}
