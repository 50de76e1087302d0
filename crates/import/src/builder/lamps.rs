//! Lamps of round shapes that a transform stretches. An instance may be stretched, but it cannot shine, so they become other shapes.

use std::f64::consts::{PI, TAU};

use etalon_scene::Mesh;
use etalon_scene::linear::is_similarity;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::{Value, json};

use super::Builder;
use crate::round;

/// Sectors of a circle, and steps from pole to pole.
const SECTORS: u32 = 256;
const STEPS: u32 = 128;

impl Builder<'_> {
    /// A lamp of a round shape that its transform stretches, as a shape that may shine and its transform. A cylinder that is stretched along
    /// its axis stays one. What becomes a mesh is listed.
    pub(super) fn stretched_lamp(&mut self, shape: &Value, map: &DAffine3, place: &str) -> Option<(Value, DAffine3)> {
        let radius = shape["radius_m"].as_f64()?;
        let (kind, own) = match shape["type"].as_str()? {
            "sphere" => ("sphere", DAffine3::from_translation(point(&shape["center_m"])) * scaled(radius, radius)),
            "disk" => {
                let turn = DQuat::from_rotation_arc(DVec3::Z, point(&shape["normal"]).try_normalize()?);
                let placed = DAffine3::from_rotation_translation(turn, point(&shape["center_m"]));
                ("disk", placed * scaled(radius, 1.0))
            }
            "cylinder" if shape["capped"] == false => {
                let (start, end) = (point(&shape["start_m"]), point(&shape["end_m"]));
                let turn = DQuat::from_rotation_arc(DVec3::Z, (end - start).try_normalize()?);
                let placed = DAffine3::from_rotation_translation(turn, start) * scaled(radius, (end - start).length());
                if let Some(straight) = straight_tube(&(*map * placed)) {
                    return Some(straight);
                }
                ("tube", placed)
            }
            _ => return None,
        };
        let key = format!("the lamp {kind}");
        let file = match self.made.get(&key) {
            Some(file) => file.clone(),
            None => {
                let file = self.mesh_file(&mesh(kind));
                self.made.insert(key, file.clone());
                file
            }
        };
        self.approximate(place, format!("a stretched {kind} that shines becomes a mesh of {SECTORS} sectors"));
        Some((json!({ "type": "mesh", "file": file }), *map * own))
    }
}

/// A cylinder of the format and its transform, of the map that takes the unit tube along z to it; `None` if it is not round or is not straight.
fn straight_tube(map: &DAffine3) -> Option<(Value, DAffine3)> {
    let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    let (radius, length) = (x.length(), z.length());
    let matrix3 = DMat3::from_cols(x / radius, y / radius, z / length);
    let shape = json!({
        "type": "cylinder", "start_m": [0, 0, 0], "end_m": [0, 0, length], "radius_m": radius, "capped": false,
    });
    is_similarity(&matrix3).then_some((shape, DAffine3 { matrix3, translation: map.translation }))
}

fn point(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|k| value[k].as_f64().unwrap_or(0.0)))
}

fn scaled(across: f64, along: f64) -> DAffine3 {
    DAffine3::from_scale(DVec3::new(across, across, along))
}

/// The shape of radius 1, with the texture coordinates that the format gives it. Its area, before it is stretched, is that of the round one.
fn mesh(kind: &str) -> Mesh {
    let angle = |u: f64| TAU * (u - 0.5);
    match kind {
        "sphere" => {
            let ball = grid(STEPS, |u, v| {
                let ((sin, cos), (y, level)) = (angle(u).sin_cos(), (PI * (v - 0.5)).sin_cos());
                let normal = DVec3::new(level * sin, y, level * cos);
                (normal, normal)
            });
            let factor = (2.0 * TAU / area(&ball)).sqrt();
            enlarged(ball, DVec3::splat(factor))
        }
        "disk" => {
            let disk = round::disk();
            let factor = (PI / area(&disk)).sqrt();
            enlarged(disk, DVec3::new(factor, factor, 1.0))
        }
        _ => {
            let tube = grid(1, |u, v| {
                let (sin, cos) = angle(u).sin_cos();
                (DVec3::new(cos, sin, v), DVec3::new(cos, sin, 0.0))
            });
            let factor = TAU / area(&tube);
            enlarged(tube, DVec3::new(factor, factor, 1.0))
        }
    }
}

fn enlarged(mut mesh: Mesh, factors: DVec3) -> Mesh {
    mesh.vertices.iter_mut().for_each(|v| *v = (DVec3::from(*v) * factors).to_array());
    mesh
}

fn area(mesh: &Mesh) -> f64 {
    super::studio::area(mesh, &DAffine3::IDENTITY)
}

/// A surface over (u, v), each from 0 to 1, from places and normals. Where a row is one point, each sector has its own vertex there.
fn grid(rows: u32, at: impl Fn(f64, f64) -> (DVec3, DVec3)) -> Mesh {
    let mut mesh = Mesh::default();
    let is_point = |row: u32| rows > 1 && (row == 0 || row == rows);
    for row in 0..=rows {
        for sector in 0..=SECTORS {
            let (u, v) = (f64::from(sector) / f64::from(SECTORS), f64::from(row) / f64::from(rows));
            let (place, normal) = at(u, v);
            let middle = if is_point(row) { 0.5 / f64::from(SECTORS) } else { 0.0 };
            mesh.vertices.push(place.to_array());
            mesh.normals.push(normal.to_array().map(|c| c as f32));
            mesh.uvs.push([(u + middle) as f32, v as f32]);
        }
    }
    for row in 0..rows {
        for sector in 0..SECTORS {
            let a = row * (SECTORS + 1) + sector;
            let d = a + SECTORS + 1;
            if !is_point(row) {
                mesh.triangles.push([a, a + 1, d]);
            }
            if !is_point(row + 1) {
                mesh.triangles.push([a + 1, d + 1, d]);
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_that_shine_face_outward_and_have_the_areas_of_round_shapes() {
        for (kind, expected) in [("sphere", 2.0 * TAU), ("disk", PI), ("tube", TAU)] {
            let mesh = mesh(kind);
            assert!((area(&mesh) / expected - 1.0).abs() < 1e-12, "{kind}");
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|corner| DVec3::from(mesh.vertices[corner as usize]));
                let outward = match kind {
                    "disk" => DVec3::Z,
                    "tube" => DVec3::new(a.x + b.x, a.y + b.y, 0.0),
                    _ => a + b + c,
                };
                assert!((b - a).cross(c - a).dot(outward) > 0.0, "{kind}: {triangle:?}");
            }
        }
        // Stretched to twice its height, a ball has the area 2π (1 + 2 · (π/3)/sin(π/3)), by the formula of a spheroid.
        let longer = super::super::studio::area(&mesh("sphere"), &scaled(1.0, 2.0));
        let spheroid = TAU * (1.0 + 2.0 * (PI / 3.0) / (PI / 3.0).sin());
        assert!((longer / spheroid - 1.0).abs() < 1e-4, "{longer} {spheroid}");
    }

    #[test]
    fn a_tube_that_is_stretched_along_its_axis_stays_one() {
        let placed = DAffine3::from_translation(DVec3::X) * scaled(2.0, 3.0);
        let (shape, map) = straight_tube(&placed).expect("it is straight");
        assert_eq!((shape["radius_m"].as_f64(), shape["end_m"][2].as_f64()), (Some(2.0), Some(3.0)));
        assert_eq!(map, DAffine3::from_translation(DVec3::X));
        assert!(straight_tube(&(DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0)) * placed)).is_none());
    }
}
