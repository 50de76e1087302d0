//! The bounding volume hierarchy: a binary tree of boxes, built and made better, and the wide nodes and leaves that it becomes.
//!
//! It knows primitives by their boxes, by what filters see of them, and by whether they need a leaf of their own.

pub(crate) mod build;
pub(crate) mod collapse;
pub(crate) mod leaf;
pub(crate) mod node;
pub(crate) mod optimize;
pub(crate) mod sah_cost;
