//! Why a scene cannot be prepared.

use crate::plan::StudyError;
use etalon_geometry::{GeometryError, ShapeError};
use etalon_scene::ReferenceError;
use etalon_simd::LevelError;

/// Why a scene cannot be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// A shape that cannot be intersected.
    #[error("object \"{object}\": {source}")]
    Shape {
        /// Name of the object.
        object: String,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// An instance that cannot be placed.
    #[error("instance \"{instance}\": {source}")]
    Instance {
        /// Name of the instance.
        instance: String,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// A camera that cannot move as it should.
    #[error("the camera: {0}")]
    Camera(ShapeError),
    /// A compound lens through which the middle of the film sees nothing.
    #[error("the camera's lens: no light reaches the middle of the film")]
    DarkLens,
    /// The scene as a whole cannot be built.
    #[error("the scene's geometry: {0}")]
    Geometry(#[from] GeometryError),
    /// A dielectric with a priority whose surface bounds no solid.
    #[error("object \"{object}\" has a dielectric with a priority, but it is not a closed solid: {why}")]
    OpenSolid {
        /// Name of the object.
        object: String,
        /// Where it is open.
        why: String,
    },
    /// A reference to something that is not in the scene.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// The instruction set that the environment names cannot be used.
    #[error(transparent)]
    Level(#[from] LevelError),
    /// What the study asks for makes no sense.
    #[error(transparent)]
    Study(#[from] StudyError),
}
