//! Shapes and a ray accelerator over them, without a scene epsilon.
//!
//! A [`Geometry`] is built once from [`Primitive`]s and answers which surface a ray meets first, and whether anything lies between two points.
//! Every hit comes with a bound on the error of its position. A ray that leaves a surface starts as far off it as this bound requires, and
//! knows which primitive it leaves.
//!
//! ```
//! use etalon_geometry::{Geometry, Parallelogram, Primitive, Ray, Sphere, SurfaceId};
//! use etalon_optics::Vec3;
//!
//! let v = Vec3::<f64>::new;
//! let ball = Sphere::new(v(0.0, 1.0, 0.0), 1.0)?;
//! let floor = Parallelogram::new(v(-5.0, 0.0, -5.0), v(10.0, 0.0, 0.0), v(0.0, 0.0, 10.0))?;
//! let geometry = Geometry::build(vec![Primitive::from(ball), floor.into()])?;
//!
//! // Down on the floor, two metres beside the middle of the ball.
//! let ray = Ray::free(v(2.0, 5.0, 0.0), v(0.0, -1.0, 0.0));
//! let hit = geometry.closest_hit(&ray).expect("the floor");
//! assert_eq!(hit.t, 5.0);
//! let point = geometry.surface(&ray, &hit);
//! // The ball hides a lamp on its other side, and not one above.
//! assert!(geometry.occluded(&point.spawn_to(v(-2.0, 2.0, 0.0), SurfaceId::NONE)));
//! assert!(!geometry.occluded(&point.spawn_to(v(2.0, 9.0, 0.0), SurfaceId::NONE)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | for | see |
//! |---|---|
//! | shapes | [`Sphere`], [`Triangle`], [`Parallelogram`], [`Disk`], [`Cylinder`] |
//! | a geometry within another, placed by an affine map, also a moving one | [`Instance`], [`Placement`], [`Motion`] |
//! | rays and what they find | [`Ray`], [`Hit`], [`SurfacePoint`] |
//! | eight rays at once | [`Geometry::closest_hits`], [`Rays`] |
//! | every hit of a ray, in order | [`Geometry::next_hit`], [`Passed`] |
//! | thorough or fast building | [`TreeBuilder`] |
//!
//! The example `shadow` draws a ball and its shadow.
//!
//! # Inside
//!
//! Everything is decided in `f64`. Boxes and leaves are filtered in `f32`, by bounds that err on the side of keeping. So hits are the same on
//! every instruction set, and the same as without a tree. Each module uses those above it:
//!
//! | module | what it holds |
//! |---|---|
//! | `aabb`, `double_double`, `pages`, `level` | boxes; the arithmetic behind `f64`; arrays in large pages; the instruction set to use |
//! | `vec4`, `ray`, `passed`, `lanes` | four lanes of any instruction set; rays and hits; hits that a walk has passed; eight rays |
//! | `query` | a ray prepared for the tests in `f64` |
//! | `shapes` | the shapes, one a file, with their intersection tests; [`ShapeSampler`]: directions toward them |
//! | [`warp`] | maps from the unit square to disks, hemispheres and spheres |
//! | `placement`, `motion` | where a geometry is placed, also as a function of time |
//! | `frame` | the accelerator's frame, and conservative box tests in `f32` |
//! | `bvh` | the tree: its two builders, an optimiser, the choice of nodes of sixteen children and of leaves |
//! | `small_scene` | up to 128 primitives in blocks, instead of a tree |
//! | `geometry` | primitives, instances, and what is built over them |
//! | `traverse` | how rays go through trees, small scenes and instances, for each instruction set |
//! | `queries` | the questions that a [`Geometry`] answers |

mod aabb;
mod bvh;
mod double_double;
mod frame;
mod geometry;
mod lanes;
mod level;
mod motion;
mod pages;
mod passed;
mod placement;
mod queries;
mod query;
mod ray;
mod shapes;
mod small_scene;
mod traverse;
mod vec4;
pub mod warp;

pub use aabb::Aabb;
pub use bvh::build::TreeBuilder;
pub use geometry::{Geometry, GeometryError, Instance, MAX_NESTING, Primitive};
pub use lanes::{Hits, LANES, Rays, SurfacePoints};
pub use motion::{Motion, Pose};
pub use passed::Passed;
pub use placement::Placement;
pub use ray::{Hit, PrimitiveId, Ray, SurfaceId, SurfacePoint};
pub use shapes::{
    Cylinder, DirectionDensity, Disk, MAX_COORDINATE, MIN_LENGTH, Parallelogram, PlanarSampler, ShapeError, ShapeMap,
    ShapeSample, ShapeSampler, Sphere, SphereSampler, Triangle,
};

#[cfg(test)]
mod test_support;
#[cfg(test)]
mod tests;
