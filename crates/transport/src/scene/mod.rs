//! The prepared scene, and what paths meet in it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`prepare`] | from a scene to what the kernels trace; frames made from earlier ones |
//! | [`shapes`] | geometry and lamps made from objects, groups and instances |
//! | [`world`] | all that a path meets |
//! | [`interaction`] | what a path meets next: surfaces, masks, solids that coincide |
//! | [`receiver`] | where paths of meters begin |
//! | [`starting_media`] | the media that hold the camera |
//! | [`shading_tables`] | spectra and kinds of materials by object, looked up on paths |
//! | [`coincidence`] | warnings about interfaces that coincide |

pub(crate) mod coincidence;
pub(crate) mod interaction;
mod motion;
pub(crate) mod prepare;
pub(crate) mod prepare_error;
pub(crate) mod receiver;
pub(crate) mod shading_tables;
mod shapes;
mod starting_media;
pub(crate) mod world;
