//! Motion of a scene, in the time of the shutter: 0 as it opens, 1 as it closes.

use etalon_geometry::{Motion, Pose, ShapeError};
use etalon_optics::Vec3;
use etalon_scene as scene;

/// The motion as geometry has it, in the world.
///
/// # Errors
/// As [`Motion::new`].
pub(crate) fn motion(motion: &scene::Motion, [open_s, close_s]: [f64; 2]) -> Result<Motion, ShapeError> {
    let poses: Vec<Pose> = motion
        .during([open_s, close_s])
        .iter()
        .map(|key| Pose {
            time: (key.time_s - open_s) / (close_s - open_s),
            translation: Vec3::from_array(key.transform.translation_m),
            rotation: key.rotation.map(Vec3::from_array),
            stretch: key.stretch.map(Vec3::from_array),
        })
        .collect();
    Motion::new(&poses)
}
