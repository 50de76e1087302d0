//! Pure light physics: spectra, colours, refractive indices, Fresnel's formulas, Snell's law. It knows no scenes, files or random numbers.
//!
//! A [`Spectrum`] is a function of the wavelength, kept as its formula. [`colour`] makes a colour of it, [`RefractiveIndex`] and
//! [`ComplexIndex`] hold what glasses and metals do to each wavelength, [`fresnel`] and [`snell`] say how much light goes where.
//!
//! Blue light is turned more than red when it enters glass, and the surface sends back about 4 % of both:
//!
//! ```
//! use etalon_optics::fresnel::dielectric;
//! use etalon_optics::snell::refract;
//! use etalon_optics::{RefractiveIndex, Vec3};
//!
//! let glass = RefractiveIndex::named("N-BK7").expect("a glass of the list");
//! // Light from above, 45° from the normal. Directions leave the surface.
//! let (normal, wi) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0).normalized());
//! let angle_deg = |nm: f64| {
//!     let inside = refract(wi, normal, glass.eval(nm)).expect("light always enters glass");
//!     (-inside.z).acos().to_degrees()
//! };
//! assert!(angle_deg(450.0) < angle_deg(650.0));
//! let straight = dielectric(1.0, glass.eval(550.0)).expect("light always enters glass");
//! assert!((straight.reflectance - 0.042).abs() < 0.001);
//! ```
//!
//! | for | see |
//! |---|---|
//! | spectra: constants, tables, black bodies, illuminants, RGB made into spectra | [`spectrum`] |
//! | the CIE 1931 2° observer, XYZ, linear Rec. 709, sRGB, adaptation, CIELAB | [`colour`] |
//! | glasses and metals, with the range that each is known for | [`index`] |
//! | reflectance and transmittance, in forms that do not cancel; thin films | [`fresnel`] |
//! | light that is given back at another wavelength | [`fluorescence`] |
//! | where refracted light goes | [`snell`] |
//! | vectors and frames over `f32` or `f64` | [`Vec3`], [`Frame`], [`Real`] |
//! | one value for each wavelength of a path | [`Lanes`] |
//! | e⁻ˣ and angles by operations that round alike everywhere | [`exponential`], [`error_function`], [`angle`] |
//! | what can be wrong with the numbers above | [`OpticsError`] |
//!
//! The example `prism` prints what a prism does to four spectral lines.
//!
//! Arithmetic here uses only operations that IEEE 754 rounds correctly (+ − × ÷ √). It uses no fused multiply-add, and inside a path never
//! the platform's mathematics library. So a result has the same bits on every machine. Two kinds of spectra need an exponential,
//! [`spectrum::Blackbody`] and illuminant A, and so does sRGB. A renderer tabulates those before its paths start.

pub mod angle;
pub mod colour;
pub mod complex;
pub mod error;
pub mod error_function;
pub mod exponential;
pub mod fluorescence;
pub mod fresnel;
pub mod index;
pub mod lanes;
pub mod real;
pub mod snell;
pub mod spectrum;
mod table;
pub mod vec3;

pub use angle::atan2_turns;
pub use complex::Complex;
pub use error::{INDEX_RANGE, OpticsError};
pub use error_function::scaled_erfc;
pub use exponential::{exp_neg, neg_ln, one_minus_exp_neg};
pub use fluorescence::{Fluorescence, Fluorophore, ReradiationMatrix};
pub use index::{ComplexIndex, OutsideFit, RefractiveIndex, reference_nm};
pub use lanes::Lanes;
pub use real::Real;
pub use spectrum::{Illuminant, Spectrum};
pub use vec3::{Frame, Vec3};
