//! How a camera stands, and how it moves.

use glam::DVec3;

use super::motion::Placed;
use crate::json::{Code, Direction, Optional, Reader, Spanned};
use crate::linear::unit;
use crate::model::{Camera, CameraMotion};

/// Below this sine of the angle between `up` and the view, the roll of the picture hangs on digits that nobody meant.
const PARALLEL: f64 = 1e-6;

/// Viewing direction and the picture's upward direction, orthogonal unit vectors.
pub(super) fn orientation(
    position_m: Option<[f64; 3]>,
    look_at_m: &Optional<Spanned<[f64; 3]>>,
    direction: &Optional<Spanned<Direction>>,
    up: Option<Spanned<Direction>>,
    reader: &mut Reader<'_>,
) -> Option<([f64; 3], [f64; 3])> {
    let forward = match (look_at_m.given(), direction.given()) {
        (Some(target), None) => {
            // Halved, so that the difference of two finite numbers is finite.
            let towards = 0.5 * DVec3::from(target.value) - 0.5 * DVec3::from(position_m?);
            let forward = unit(towards);
            if forward.is_none() {
                let message = "the camera looks at its own position";
                reader.error(Code::DegenerateView, target.at, message);
            }
            forward?
        }
        (None, Some(direction)) => direction.value.0.into(),
        _ => return None,
    };
    let up = up?;
    let mut across = DVec3::from(up.value.0);
    if forward.cross(across).length() < PARALLEL {
        let hint = "give an \"up\" across the view";
        reader.error_hint(Code::DegenerateView, up.at, "\"up\" is along the viewing direction", hint);
        return None;
    }
    // Across the view, and once more, since rounding left a little along it.
    for _ in 0..2 {
        across = unit(across - forward * across.dot(forward))?;
    }
    Some((forward.to_array(), across.to_array()))
}

/// A camera where its keyframes put it.
pub(super) fn moving(still: Camera, placed: Option<Placed>) -> Camera {
    let Some((_, motion)) = placed else { return still };
    let Camera { position_m, forward, up, shutter_s, .. } = still;
    let motion = motion.map(|motion| CameraMotion { motion, position_m, forward, up });
    let mut camera = Camera { motion, ..still };
    camera.set_shutter(shutter_s);
    camera
}
