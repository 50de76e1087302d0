//! A camera as the matrices that EXR files carry.

use etalon_scene::{Camera, Projection};

/// `worldToCamera` and `worldToNDC`, for row vectors, row after row (OpenEXR, *Standard Attributes*).
///
/// Camera space is left-handed: x to the right of the picture, y up, z along the view, in metres. NDC has (0, 0) in the upper left
/// corner of the frame and (1, 1) in the lower right; its z is the depth.
pub(crate) fn of_camera(camera: &Camera, width: u32, height: u32) -> [[f32; 16]; 2] {
    let (forward, up, position) = (camera.forward, camera.up, camera.position_m);
    let aspect = f64::from(width) / f64::from(height);
    // As columns: a direction, and what it makes of the origin.
    let column = |axis: [f64; 3]| {
        let origin = -(0..3).map(|c| axis[c] * position[c]).sum::<f64>();
        [axis[0], axis[1], axis[2], origin]
    };
    let [x, y, z] = [column(camera.right()), column(up), column(forward)];
    let one = [0.0, 0.0, 0.0, 1.0];
    let mix = |a: [f64; 4], s: f64, b: [f64; 4], t: f64| -> [f64; 4] { std::array::from_fn(|i| s * a[i] + t * b[i]) };
    let central = |half: f64| [mix(x, 0.5 / (half * aspect), z, 0.5), mix(y, -0.5 / half, z, 0.5), z, z];
    let ndc = match &camera.projection {
        Projection::Perspective { vertical_fov_rad, .. } => central((0.5 * vertical_fov_rad).tan()),
        // The pinhole of the same view, without distortion.
        Projection::CompoundLens(lens) => central(lens.half_view()),
        Projection::Orthographic { height_m } => {
            [mix(x, 1.0 / (height_m * aspect), one, 0.5), mix(y, -1.0 / height_m, one, 0.5), z, one]
        }
    };
    let rows = |columns: [[f64; 4]; 4]| std::array::from_fn(|i| columns[i % 4][i / 4] as f32);
    [rows([x, y, z, one]), rows(ndc)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(point: [f64; 3], matrix: &[f32; 16]) -> [f64; 3] {
        let row = [point[0], point[1], point[2], 1.0];
        let image: [f64; 4] = std::array::from_fn(|c| (0..4).map(|r| row[r] * f64::from(matrix[4 * r + c])).sum());
        [0, 1, 2].map(|c| image[c] / image[3])
    }

    #[test]
    fn points_of_the_view_come_where_they_are_seen() {
        let fov = 0.8_f64;
        let perspective = Projection::Perspective { vertical_fov_rad: fov, lens: None };
        let orthographic = Projection::Orthographic { height_m: 2.0 };
        // Looking along −z with y up, x is to the right.
        let base = Camera {
            shutter_s: [0.0; 2],
            motion: None,
            position_m: [1.0, 2.0, 3.0],
            forward: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            world_up: [0.0, 1.0, 0.0],
            mirrored: false,
            projection: perspective,
            near_m: 0.0,
        };
        let [to_camera, to_ndc] = of_camera(&base, 300, 200);
        assert_eq!(times([4.0, 2.5, -7.0], &to_camera), [3.0, 0.5, 10.0]);
        let half = 10.0 * (0.5 * fov).tan();
        for (point, seen) in [
            ([1.0, 2.0, -7.0], [0.5, 0.5]),
            ([1.0 - 1.5 * half, 2.0 + half, -7.0], [0.0, 0.0]),
            ([1.0 + 1.5 * half, 2.0 - half, -7.0], [1.0, 1.0]),
        ] {
            let [x, y, _] = times(point, &to_ndc);
            assert!((x - seen[0]).abs() < 1e-6 && (y - seen[1]).abs() < 1e-6, "{x} {y}");
        }
        let [_, mirrored] = of_camera(&Camera { mirrored: true, ..base.clone() }, 300, 200);
        assert!((times([1.0 + 1.5 * half, 2.0, -7.0], &mirrored)[0]).abs() < 1e-6);
        let [_, to_ndc] = of_camera(&Camera { projection: orthographic, ..base }, 300, 200);
        let [x, y, z] = times([1.0 - 1.5, 2.0 + 1.0, -4.0], &to_ndc);
        assert!(x.abs() < 1e-6 && y.abs() < 1e-6 && (z - 7.0).abs() < 1e-6, "{x} {y} {z}");
    }
}
