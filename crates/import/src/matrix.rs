//! Affine maps, as files of other programs state them.

use etalon_scene::linear::{self, affine_rows, unit};
use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};

/// Counter-clockwise when the axis points at the viewer; `None` for an axis without a direction.
pub(crate) fn rotation(axis: [f64; 3], angle_deg: f64) -> Option<DAffine3> {
    Some(DAffine3::from_mat3(linear::rotation(unit(axis.into())?, angle_deg)))
}

/// A camera at `origin`: the columns of the map are up × forward, the up at right angles to the view, and forward. `None`
/// if there is no view, or up lies along it.
pub(crate) fn looking(origin: [f64; 3], target: [f64; 3], up: [f64; 3]) -> Option<DAffine3> {
    let origin = DVec3::from(origin);
    let forward = unit(DVec3::from(target) - origin)?;
    let side = unit(unit(up.into())?.cross(forward))?;
    Some(DAffine3::from_mat3_translation(DMat3::from_cols(side, forward.cross(side), forward), origin))
}

/// `None` if it has none.
pub(crate) fn inverse(map: &DAffine3) -> Option<DAffine3> {
    Some(map.inverse()).filter(DAffine3::is_finite)
}

/// The rows of the format's key `matrix`, without negative zeros.
pub(crate) fn rows(map: &DAffine3) -> [[f64; 4]; 3] {
    affine_rows(map).map(|row| row.map(|v| v + 0.0))
}

/// As a list of steps of the format, or null for the identity.
pub(crate) fn steps(map: &DAffine3) -> Value {
    if *map == DAffine3::IDENTITY { Value::Null } else { json!([{ "matrix": rows(map) }]) }
}
