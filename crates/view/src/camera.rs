//! The camera as the page moves it, and where points of the world are seen.

use etalon_scene::{Camera, Projection, ThinLens};
use serde::{Deserialize, Serialize};

/// Largest coordinate of a camera, m: beyond, positions lose the bits that tell neighbours apart.
const MOST_M: f64 = 1e9;
/// How far unit vectors may be from unit length and from right angles before they are put right.
const NEARLY: f64 = 1e-3;
/// Sine of an angle below which two directions count as being at right angles.
const ACROSS: f64 = 1e-9;

/// Where the camera stands and how it looks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CameraView {
    /// The eye, m.
    pub position_m: [f64; 3],
    /// Unit vector of the viewing direction.
    pub forward: [f64; 3],
    /// Unit vector, orthogonal to `forward`, that is up in the picture.
    pub up: [f64; 3],
    /// Whether left and right are exchanged in the picture.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mirrored: bool,
    /// Full vertical angle of view, rad, of a perspective camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertical_fov_rad: Option<f64>,
    /// Height of the picture in the world, m, of an orthographic camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Radius of the lens, m; `None` for a pinhole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lens_radius_m: Option<f64>,
    /// Distance of the plane in focus along `forward`, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub focus_distance_m: Option<f64>,
}

impl CameraView {
    /// The view of a scene's camera.
    pub(crate) fn of(camera: &Camera) -> Self {
        let &Camera { position_m, forward, up, mirrored, .. } = camera;
        let mut view = Self {
            position_m,
            forward,
            up,
            mirrored,
            vertical_fov_rad: None,
            height_m: None,
            lens_radius_m: None,
            focus_distance_m: None,
        };
        match &camera.projection {
            Projection::Perspective { vertical_fov_rad, lens } => {
                view.vertical_fov_rad = Some(*vertical_fov_rad);
                view.lens_radius_m = lens.as_ref().map(|lens| lens.radius_m);
                view.focus_distance_m = lens.as_ref().map(|lens| lens.focus_distance_m);
            }
            Projection::Orthographic { height_m } => view.height_m = Some(*height_m),
            // Seen as through the pinhole of the same view. Its focus is the scene's.
            Projection::CompoundLens(lens) => view.vertical_fov_rad = Some(2.0 * lens.half_view().atan()),
        }
        view
    }

    /// Puts the view into a camera of the same kind, which then stands still while the shutter is open.
    pub(crate) fn put_into(&self, camera: &mut Camera) {
        (camera.position_m, camera.forward, camera.up) = (self.position_m, self.forward, self.up);
        camera.mirrored = self.mirrored;
        camera.motion = None;
        match &mut camera.projection {
            Projection::Perspective { vertical_fov_rad, lens } => {
                *vertical_fov_rad = self.vertical_fov_rad.unwrap_or(*vertical_fov_rad);
                let of = |radius_m, focus_distance_m| ThinLens { radius_m, focus_distance_m };
                if let Some((radius_m, focus_m)) = self.lens_radius_m.zip(self.focus_distance_m) {
                    *lens = Some(of(radius_m, focus_m));
                }
            }
            Projection::Orthographic { height_m } => *height_m = self.height_m.unwrap_or(*height_m),
            // The page moves it. Its lens and film stay.
            Projection::CompoundLens(_) => {}
        }
    }

    /// The view with exact unit vectors.
    ///
    /// # Errors
    /// A sentence that says which number makes no sense.
    pub(crate) fn checked(mut self) -> Result<Self, String> {
        let finite = |v: &[f64; 3]| v.iter().all(|c| c.is_finite() && c.abs() <= MOST_M);
        if !(finite(&self.position_m) && finite(&self.forward) && finite(&self.up)) {
            return Err("the camera has a number that is not finite or too large".to_owned());
        }
        let forward = unit(self.forward).filter(|_| (length(self.forward) - 1.0).abs() < NEARLY);
        let forward = forward.ok_or("`forward` is not a unit vector")?;
        let along = dot(self.up, forward);
        let up = unit(std::array::from_fn(|c| self.up[c] - along * forward[c]))
            .filter(|_| (length(self.up) - 1.0).abs() < NEARLY && along.abs() < NEARLY)
            .ok_or("`up` is not a unit vector at right angles to `forward`")?;
        (self.forward, self.up) = (forward, up);
        let within = |value: Option<f64>, low: f64, high: f64| value.is_none_or(|v| v > low && v < high);
        if !within(self.vertical_fov_rad, 1e-4, 3.1) {
            return Err("the angle of view must lie between 0.0001 and 3.1 rad".to_owned());
        }
        if !within(self.height_m, 0.0, MOST_M) || !within(self.focus_distance_m, 0.0, MOST_M) {
            return Err("heights and distances must be above 0 and finite".to_owned());
        }
        if self.lens_radius_m.is_some_and(|radius| !(0.0..MOST_M).contains(&radius)) {
            return Err("the radius of the lens must be 0 or more and finite".to_owned());
        }
        Ok(self)
    }

    /// Right of the picture.
    fn right(&self) -> [f64; 3] {
        etalon_scene::right_of(self.forward, self.up, self.mirrored)
    }

    /// A point in the camera's own coordinates, m: along right, up and forward.
    pub(crate) fn local(&self, point_m: [f64; 3]) -> [f64; 3] {
        let from_eye: [f64; 3] = std::array::from_fn(|c| point_m[c] - self.position_m[c]);
        [dot(from_eye, self.right()), dot(from_eye, self.up), dot(from_eye, self.forward)]
    }

    /// Column and row, in pixels of a picture of this size, where a point in the camera's coordinates is seen. Points of a perspective
    /// view that are not in front of the eye are seen nowhere.
    pub(crate) fn pixel(&self, local_m: [f64; 3], [width, height]: [u32; 2]) -> Option<[f64; 2]> {
        let [width, height] = [width, height].map(f64::from);
        let scale = match (self.vertical_fov_rad, self.height_m) {
            (Some(fov), _) if local_m[2] > 0.0 => 0.5 * height / ((0.5 * fov).tan() * local_m[2]),
            (None, Some(height_m)) => height / height_m,
            _ => return None,
        };
        Some([0.5 * width + scale * local_m[0], 0.5 * height - scale * local_m[1]])
    }

    /// The part of a segment that is in front of the eye, in pixels: its two ends.
    pub(crate) fn segment(&self, from_m: [f64; 3], to_m: [f64; 3], size: [u32; 2]) -> Option<[[f64; 2]; 2]> {
        let (mut a, mut b) = (self.local(from_m), self.local(to_m));
        if self.vertical_fov_rad.is_some() {
            let near = 1e-3 * (a[2].abs() + b[2].abs());
            if a[2] < near && b[2] < near {
                return None;
            }
            let cut = |inside: [f64; 3], outside: [f64; 3]| -> [f64; 3] {
                let t = (near - outside[2]) / (inside[2] - outside[2]);
                std::array::from_fn(|c| outside[c] + t * (inside[c] - outside[c]))
            };
            if a[2] < near {
                a = cut(b, a);
            } else if b[2] < near {
                b = cut(a, b);
            }
        }
        Some([self.pixel(a, size)?, self.pixel(b, size)?])
    }
}

/// What is up in the world of a scene: what its file states as up. The cameras of converted models state what is up in the picture, at
/// right angles to the view. For these it is the nearest axis of the world.
pub(crate) fn world_up(camera: &Camera) -> [f64; 3] {
    let up = camera.world_up;
    if dot(up, camera.forward).abs() > ACROSS {
        return up;
    }
    let largest = (0..3).max_by(|&a, &b| up[a].abs().total_cmp(&up[b].abs())).unwrap_or(1);
    std::array::from_fn(|c| if c == largest { up[c].signum() } else { 0.0 })
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| a[c] * b[c]).sum()
}

fn length(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = length(v);
    (length > 0.5).then(|| v.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> CameraView {
        CameraView {
            position_m: [1.0, 2.0, 3.0],
            forward: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            mirrored: false,
            vertical_fov_rad: Some(0.8),
            height_m: None,
            lens_radius_m: None,
            focus_distance_m: None,
        }
    }

    #[test]
    fn points_are_seen_where_the_film_has_them() {
        let (view, size) = (view(), [300, 200]);
        let at = |point| view.pixel(view.local(point), size);
        let half = 10.0 * 0.4_f64.tan();
        let near = |seen: Option<[f64; 2]>, x: f64, y: f64| {
            let seen = seen.unwrap();
            assert!((seen[0] - x).abs() < 1e-9 && (seen[1] - y).abs() < 1e-9, "{seen:?}");
        };
        near(at([1.0, 2.0, -7.0]), 150.0, 100.0);
        near(at([1.0 - 1.5 * half, 2.0 + half, -7.0]), 0.0, 0.0);
        near(at([1.0 + 1.5 * half, 2.0 - half, -7.0]), 300.0, 200.0);
        let mirrored = CameraView { mirrored: true, ..view.clone() };
        near(mirrored.pixel(mirrored.local([1.0 + 1.5 * half, 2.0 - half, -7.0]), size), 0.0, 200.0);
        assert_eq!(at([1.0, 2.0, 4.0]), None);
        let [from, to] = view.segment([1.0, 2.0, -7.0], [1.0, 12.0, 13.0], size).unwrap();
        assert!(from == [150.0, 100.0] && to[0] == 150.0 && to[1] < 0.0, "{to:?}");
        assert_eq!(view.segment([1.0, 2.0, 4.0], [1.0, 2.0, 5.0], size), None);
    }

    #[test]
    fn the_world_keeps_its_up_where_the_camera_looks_down() {
        let camera = |forward, up, world_up| Camera {
            position_m: [0.0; 3],
            forward,
            up,
            world_up,
            mirrored: false,
            projection: Projection::Orthographic { height_m: 1.0 },
            near_m: 0.0,
            shutter_s: [0.0; 2],
            motion: None,
        };
        let (down, across) = ([0.0, -0.8, -0.6], [0.0, 0.6, -0.8]);
        let stated = [0.0, 1.0, 0.0];
        assert_eq!(world_up(&camera(down, across, stated)), stated);
        // A converted model states what is up in the picture.
        let (down, across) = ([0.0, -0.6, -0.8], [0.0, 0.8, -0.6]);
        assert_eq!(world_up(&camera(down, across, across)), stated);
        let tilted = [0.6, 0.8, 0.0];
        assert_eq!(world_up(&camera(down, across, tilted)), tilted);
    }

    #[test]
    fn a_view_that_makes_no_sense_is_refused() {
        assert!(view().checked().is_ok());
        let with = |change: fn(&mut CameraView)| {
            let mut view = view();
            change(&mut view);
            view.checked().unwrap_err()
        };
        assert!(with(|v| v.forward = [0.0; 3]).contains("forward"));
        assert!(with(|v| v.up = [0.0, 0.0, -1.0]).contains("up"));
        assert!(with(|v| v.position_m[0] = f64::NAN).contains("finite"));
        assert!(with(|v| v.vertical_fov_rad = Some(4.0)).contains("angle"));
        assert!(with(|v| v.lens_radius_m = Some(-1.0)).contains("lens"));
    }
}
