//! Laws of light as functions that return a [`Verdict`](crate::Verdict).
//!
//! A subject is handed over as a closure or a trait object over plain `f64` arrays. Every law takes `epsilon`, the machine
//! epsilon of the subject's arithmetic ([`f64::EPSILON`], or [`SINGLE`] for an f32 subject), or asks the subject for it: inputs
//! are rounded to what the subject can represent, and bounds are stated in units of it. Sweeps take a seed and are the same
//! for equal seeds.

mod cells;
mod directions;
mod fresnel;
mod intersection;
mod light;
mod microfacet;
mod numerics;
mod polarisation;
mod refraction;
mod sampling;
mod scattering;
mod thin_film;
mod trees;

pub use fresnel::{
    FresnelPowers, fresnel_conserves_energy, fresnel_exact, fresnel_is_accurate, fresnel_obeys_brewster,
    fresnel_obeys_stokes, fresnel_reflects_totally, stokes_amplitudes,
};
pub use intersection::{closed_mesh_is_tight, far_sphere_is_hit, powers_of_two_are_exact, signed_zeros_are_equal};
pub use light::{
    light_closed_forms, light_fills_its_solid_angle, light_gives_irradiance, light_is_uniform_in_solid_angle,
    light_laws, light_pdf_integrates_to_one, light_sample_is_consistent, light_samples_follow_pdf,
    rectangle_solid_angle, sphere_solid_angle, triangle_solid_angle,
};
pub use microfacet::{
    Masking, SingleScattering, anisotropic_ggx_albedo, anisotropic_ggx_mirrors, beckmann_albedo, beckmann_mirrors,
    coated_ggx_albedo, ggx_albedo,
};
pub use numerics::{film_mean_is_exact, frame_is_orthonormal, mis_weights_add_up, wavelengths_follow_density};
pub use polarisation::{
    Polarises, Turn, TurnedBy, mueller_is_physical, mueller_is_reciprocal, stokes_along, stokes_along_paths_is_exact,
};
pub use refraction::{Crossing, mirror_reflection, snell, snell_sweep, total_internal_reflection};
pub use sampling::{Albedos, energy_is_not_created, furnace_agrees, pdf_integrates_to_one, samples_follow_pdf};
pub use scattering::{etendue_is_conserved, f_and_pdf_are_proper, is_isotropic, is_reciprocal, sample_is_consistent};
pub use thin_film::{CoatedInterface, FilmLayer, FilmWaves};
pub use trees::{built_mesh_is_tight, near_surfaces_are_hit, needles_are_hit_where_they_are, neighbours_change_no_hit};

/// Machine epsilon of an f32 subject, as an `f64`.
pub const SINGLE: f64 = f32::EPSILON as f64;
