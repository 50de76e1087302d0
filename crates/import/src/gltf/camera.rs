//! Cameras of glTF, also such that move.

use etalon_scene::linear::{is_similarity, unit};
use glam::DAffine3;
use serde_json::{Value, json};

use super::Walk;
use super::animation::{Pose, slerp};
use super::material::decimal;
use crate::matrix::rows;

/// Between keyframes a camera may be off its way by this share of its distance from the origin and of the way, and of a radian.
const OFF: f64 = 1e-6;
/// Keyframes of the scene between two of the model, at most: 2 to this power.
const MOST_HALVINGS: usize = 10;
/// From this many keyframes on none is added.
const MOST_FRAMES: usize = 1 << 16;

impl Walk<'_, '_> {
    /// The first camera is the scene's.
    pub(super) fn camera(&mut self, camera: &gltf::Camera<'_>, matrix: &DAffine3) {
        let place = format!("$.cameras[{}]", camera.index());
        if self.builder.camera.is_some() {
            self.builder.leave_out(place, "only the first camera of the scene is used");
            return;
        }
        let motion = self.camera_motion(matrix, &place);
        let opened = self.world(matrix, self.animated.shutter_s[0]);
        let matrix = &opened;
        let (Some(direction), Some(up)) = (unit(-matrix.matrix3.z_axis), unit(matrix.matrix3.y_axis)) else {
            self.builder.leave_out(place, "its node flattens it");
            return;
        };
        let mut value = json!({ "direction": direction.to_array(), "up": up.to_array() });
        let mut forward_m = 0.0;
        let aspect = match camera.projection() {
            gltf::camera::Projection::Perspective(lens) => {
                value["type"] = json!("perspective");
                value["vertical_fov_deg"] = json!(f64::from(lens.yfov()).to_degrees());
                value["near_m"] = json!(decimal(lens.znear()).max(0.0));
                lens.aspect_ratio().map(f64::from)
            }
            gltf::camera::Projection::Orthographic(view) => {
                value["type"] = json!("orthographic");
                value["height_m"] = json!(2.0 * f64::from(view.ymag()));
                // Its rays start on the plane of its place.
                forward_m = decimal(view.znear());
                Some(f64::from(view.xmag() / view.ymag()))
            }
        };
        value["position_m"] = json!((matrix.translation + forward_m * direction).to_array());
        if let Some(keyframes) = motion {
            // From where it looks along −z at the origin, so that its way is the keyframes' own.
            value["position_m"] = json!([0.0, 0.0, 0.0 - forward_m]);
            value["direction"] = json!([0, 0, -1]);
            value["up"] = json!([0, 1, 0]);
            value["keyframes"] = json!(keyframes);
        }
        if let Some(aspect) = aspect.filter(|a| (0.01..=100.0).contains(a)) {
            self.builder.film = json!({ "width": (720.0 * aspect).round().max(1.0) as u32, "height": 720 });
        }
        self.builder.camera = Some(value);
    }

    /// The keyframes of a camera that moves; `None` if it rests, or cannot be followed, which is listed.
    fn camera_motion(&mut self, matrix: &DAffine3, place: &str) -> Option<Vec<Value>> {
        if self.chain.is_empty() {
            return None;
        }
        let mut times: Vec<f64> =
            self.chain.iter().flat_map(|(_, poses)| poses.iter().map(|(time_s, _)| *time_s)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let rigid = |map: &DAffine3| is_similarity(&map.matrix3) && map.matrix3.determinant() > 0.0;
        let at = |time_s: f64| {
            let map = self.world(matrix, time_s);
            rigid(&map).then(|| (time_s, Pose::rigid(&map)))
        };
        let mut frames = Vec::new();
        let followed = times.windows(2).try_for_each(|pair| {
            let (from, to) = (at(pair[0])?, at(pair[1])?);
            frames.push(from);
            between(from, to, &at, MOST_HALVINGS, &mut frames)?;
            Some(())
        });
        if let (Some(()), Some(last)) = (followed, times.last().and_then(|time| at(*time))) {
            frames.push(last);
        } else {
            let what = "its nodes stretch or mirror it while it moves: it stays where it is when the shutter opens";
            self.builder.leave_out(place, what);
            return None;
        }
        let frame =
            |(time_s, pose): &(f64, Pose)| json!({ "time_s": time_s, "transform": [{ "matrix": rows(&pose.map()) }] });
        Some(frames.iter().map(frame).collect())
    }
}

/// Adds what is needed between two placements, so that the way between them is followed.
fn between(
    from: (f64, Pose),
    to: (f64, Pose),
    at: &impl Fn(f64) -> Option<(f64, Pose)>,
    halvings: usize,
    frames: &mut Vec<(f64, Pose)>,
) -> Option<()> {
    let middle = at(0.5 * (from.0 + to.0))?;
    let (a, b, m) = (from.1, to.1, middle.1);
    let straight = 0.5 * (a.translation + b.translation);
    let size = m.translation.length() + (b.translation - a.translation).length();
    let turned = slerp(a.rotation, b.rotation, 0.5);
    let apart = |sign: f64| (0..4).map(|k| (turned[k] + sign * m.rotation[k]).powi(2)).sum::<f64>().sqrt();
    // Half of the angle between quaternions is that between rotations.
    let off = (m.translation - straight).length() > OFF * size || 2.0 * apart(1.0).min(apart(-1.0)) > OFF;
    if off && halvings > 0 && frames.len() < MOST_FRAMES && from.0 < middle.0 && middle.0 < to.0 {
        between(from, middle, at, halvings - 1, frames)?;
        frames.push(middle);
        between(middle, to, at, halvings - 1, frames)?;
    }
    Some(())
}
