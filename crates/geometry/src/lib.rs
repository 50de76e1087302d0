//! Shapes, robust intersection and the ray accelerator.
//!
//! The door is [`Geometry`]: it is built once from primitives in `f64` and answers closest-hit and occlusion queries for
//! rays of either scalar type. No query uses a scene epsilon: a hit carries a bound on the error of its position, and a
//! ray that leaves a surface knows the primitive and the bound that it left.
//!
//! | module | what it holds |
//! |---|---|
//! | `shapes` | [`Primitive`] and the shapes, one a file, with their intersection tests in `f64` |
//! | `ray` | [`Ray`], [`Hit`], [`SurfacePoint`] and the rays that leave it |
//! | `query` | a ray prepared for the intersection tests; the watertight projection |
//! | `double_double` | the arithmetic behind `f64`, where an error bound calls for it |
//! | `frame` | the accelerator's frame and conservative box tests in `f32` |
//! | `build` | the two builders of a binary tree ([`TreeBuilder`]) |
//! | `improve` | grouping and moving its subtrees |
//! | `measure` | how often rays enter a box |
//! | `wide` | the tree of sixteen children a node that it becomes |
//! | `pages` | arrays in large pages |
//! | `traverse` | its traversal, for each instruction set; `traverse::flat`: few primitives, without a tree |
//! | `geometry` | [`Geometry`]: the queries |
//! | `instance_node` | what a ray needs to go into an instance |
//! | `best` | the closest hit so far |
//! | `passed` | [`Passed`]: the hits that a walk along a ray leaves behind |
//! | `lanes` | [`Rays`]: eight rays at once |
//! | `instance` | [`Instance`]: a geometry within another, placed by an affine map |
//! | `motion` | [`Motion`]: such a map that changes while the shutter is open |

mod aabb;
mod best;
mod build;
mod double_double;
mod frame;
mod geometry;
mod instance;
mod instance_node;
mod lanes;
mod motion;
mod narrow;
mod optimize;
mod pages;
mod passed;
mod query;
mod ray;
mod sah_cost;
mod shapes;
mod statistics;
mod traverse;
mod wide;

pub use aabb::Aabb;
pub use build::TreeBuilder;
pub use geometry::{Geometry, GeometryError, MAX_NESTING};
pub use instance::{Instance, Placement};
pub use lanes::{Hits, LANES, Rays, SurfacePoints};
pub use motion::{Motion, Pose};
pub use passed::Passed;
pub use ray::{Hit, PrimitiveId, Ray, SurfaceId, SurfacePoint};
pub use shapes::{Cylinder, Disk, MAX_COORDINATE, MIN_LENGTH, Parallelogram, Primitive, ShapeError, Sphere, Triangle};

#[cfg(test)]
mod test_support;
#[cfg(test)]
mod tests;
