//! Texture coordinates of spheres, disks and cylinders.
//!
//! Each is a unit shape under an affine map: the unit ball, the unit disk and the unit tube of height 1 about z, the disk
//! and the tube in a frame about their axis. Transforms carry the image along.

use crate::frame::{Affine, SceneFrame};
use etalon_optics::{Frame, Vec3, atan2_turns};
use std::f64::consts::{PI, TAU};

/// A round shape's map to its unit shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundCoordinates {
    kind: Round,
    /// To the unit shape: rows, and what is added.
    rows: [Vec3<f64>; 3],
    offset: Vec3<f64>,
    /// Images of the unit shape's axes.
    columns: [Vec3<f64>; 3],
}

#[derive(Clone, Copy, Debug)]
enum Round {
    /// u runs with the longitude, counter-clockwise seen from +y, ½ at +z; v from the south pole −y to the north pole.
    Sphere,
    /// The square around it, u along the first and v along the second axis.
    Disk,
    /// u runs around the axis, counter-clockwise seen from the end; v from the start to the end.
    Cylinder,
}

impl RoundCoordinates {
    /// Of a sphere under an object's transform.
    pub(crate) fn sphere(centre: [f64; 3], radius: f64, to_world: &Affine) -> Self {
        let axes = [Vec3::new(radius, 0.0, 0.0), Vec3::new(0.0, radius, 0.0), Vec3::new(0.0, 0.0, radius)];
        Self::new(Round::Sphere, axes, centre, to_world)
    }

    /// Of a disk.
    pub(crate) fn disk(centre: [f64; 3], normal: [f64; 3], radius: f64, to_world: &Affine) -> Self {
        let frame = Frame::from_normal(Vec3::from_array(normal));
        Self::new(Round::Disk, [frame.s * radius, frame.t * radius, frame.n * radius], centre, to_world)
    }

    /// Of a cylinder.
    pub(crate) fn cylinder(start: [f64; 3], end: [f64; 3], radius: f64, to_world: &Affine) -> Self {
        let along = Vec3::from_array(end) - Vec3::from_array(start);
        let frame = Frame::from_normal(along.normalized());
        Self::new(Round::Cylinder, [frame.s * radius, frame.t * radius, along], start, to_world)
    }

    fn new(kind: Round, axes: [Vec3<f64>; 3], origin: [f64; 3], to_world: &Affine) -> Self {
        let columns = axes.map(|axis| to_world.vector(axis.to_array()));
        let origin = to_world.point(origin);
        let [x, y, z] = columns;
        // The rows of the inverse of the matrix with these columns.
        let determinant = x.dot(y.cross(z));
        let rows = [y.cross(z), z.cross(x), x.cross(y)].map(|row| row / determinant);
        let offset = -Vec3::from_array(rows.map(|row| row.dot(origin)));
        Self { kind, rows, offset, columns }
    }

    pub(crate) fn framed(self, frame: &SceneFrame) -> Self {
        let world_origin = frame.to_world_m(Vec3::ZERO);
        Self {
            offset: self.offset + Vec3::from_array(self.rows.map(|row| row.dot(world_origin))),
            rows: self.rows.map(|row| row / frame.per_m()),
            columns: self.columns.map(|column| column * frame.per_m()),
            ..self
        }
    }

    fn unit(&self, p: Vec3<f64>) -> Vec3<f64> {
        Vec3::from_array(self.rows.map(|row| row.dot(p))) + self.offset
    }

    /// Texture coordinates of a point.
    pub(crate) fn uv(&self, p: Vec3<f64>) -> [f64; 2] {
        let q = self.unit(p);
        match self.kind {
            Round::Sphere => {
                let off_axis = (q.x * q.x + q.z * q.z).sqrt();
                [0.5 + atan2_turns(q.x, q.z), 0.5 + 2.0 * atan2_turns(q.y, off_axis)]
            }
            Round::Disk => [0.5 + 0.5 * q.x, 0.5 + 0.5 * q.y],
            Round::Cylinder => [0.5 + atan2_turns(q.y, q.x), q.z],
        }
    }

    /// How a point moves with u and with v; `None` at a pole, and on the caps of a cylinder.
    pub(crate) fn tangents(&self, p: Vec3<f64>) -> Option<[Vec3<f64>; 2]> {
        let q = self.unit(p);
        let [along_u, along_v] = match self.kind {
            Round::Sphere => {
                let off_axis = (q.x * q.x + q.z * q.z).sqrt();
                if off_axis == 0.0 {
                    return None;
                }
                let up = Vec3::new(-q.y * q.x / off_axis, off_axis, -q.y * q.z / off_axis);
                [Vec3::new(q.z, 0.0, -q.x) * TAU, up * PI]
            }
            Round::Disk => [Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0)],
            Round::Cylinder => {
                // A cap is where the nearest part of the surface is an end.
                let off_axis = (q.x * q.x + q.y * q.y).sqrt();
                if (1.0 - off_axis).abs() > q.z.abs().min((1.0 - q.z).abs()) {
                    return None;
                }
                [Vec3::new(-q.y, q.x, 0.0) * TAU, Vec3::new(0.0, 0.0, 1.0)]
            }
        };
        let [x, y, z] = self.columns;
        Some([along_u, along_v].map(|v| x * v.x + y * v.y + z * v.z))
    }
}
