//! A minimal Whitted ray tracer that reproduces 16 published pictures bit for bit.
//!
//! It stands alone, and it is meant to be read in one sitting: [`Scene`] is what a scene file says, [`render`] makes the
//! picture, [`Arithmetic`] names the operations whose rounding the pixels depend on, [`random`] is the C library's generator
//! that shakes the lens. `docs/assignment.md` goes through the exercises behind it.
//!
//! It is not a physical renderer: mirror and refraction rays bring back only the highlights they pass, the lens is square,
//! the field of view spans half the image. All of that is published, so all of it is kept.
//!
//! ```
//! use etalon_whitted::{Figure, Settings, render};
//!
//! let figure = &Figure::ALL[0];
//! let settings = Settings { shadow_epsilon: figure.shadow_epsilon, ..Settings::default() };
//! let rgb = render(&figure.scene(), &settings).to_rgb8();
//! assert_eq!(rgb[..3], [77, 77, 229]);
//! ```
//!
//! | for | see |
//! |---|---|
//! | what a scene holds, and the published one | [`Scene`], [`Scene::seven_spheres`] |
//! | the sixteen pictures | [`Figure::ALL`] |
//! | size, rays a pixel, the distance that shadow rays keep | [`Settings`] |
//! | pixels as numbers and as bytes | [`Film`] |
//! | other roundings, other formulas of refraction | [`render_with`], [`RefractionRule`] |
//!
//! The example `picture` renders a scene that is made in code. `shadow_epsilon` and `depth_of_field` measure what the published numbers
//! trade, `assignment_images` draws the pictures of `docs/assignment.md`.

pub mod random;
mod refraction;
mod render;
mod scene;
mod vector;

pub use refraction::{RefractionRule, reflect, refract, refract_as_published, refract_snell};
pub use render::{Film, Settings, render, render_with};
pub use scene::{Camera, Figure, Light, Material, Object, Scene, Shape};
pub use vector::{Arithmetic, Published, Vec3, vec3};
