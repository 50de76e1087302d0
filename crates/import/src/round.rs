//! Round shapes with the texture coordinates that they have in Mitsuba and pbrt. Spheres have the pole +z, around which u runs from +x; the
//! coordinates of disks are polar.

use std::f64::consts::TAU;

use etalon_scene::Mesh;
use glam::{DAffine3, DMat3, DVec3};

/// From our unit sphere, whose pole is y and whose u is ½ at +z, to theirs.
pub(crate) fn sphere_turn() -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_cols(-DVec3::Y, DVec3::Z, -DVec3::X))
}

/// Sectors and rings of a disk.
const DISK: [u32; 2] = [256, 16];

/// Why a disk is a mesh, and how well it is one.
pub(crate) const DISK_OF_TRIANGLES: &str =
    "its texture coordinates are polar: it becomes a mesh of 256 sectors, whose area is 0.01 % smaller";

/// The unit disk with u along the radius and v around the axis.
pub(crate) fn disk() -> Mesh {
    let [sectors, rings] = DISK;
    let (mut vertices, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for ring in 0..=rings {
        for sector in 0..=sectors {
            let r = f64::from(ring) / f64::from(rings);
            // In the middle, the coordinates are those of the sector.
            let middle = if ring == 0 { 0.5 } else { 0.0 };
            let v = (f64::from(sector) + middle) / f64::from(sectors);
            let (sin, cos) = (TAU * v).sin_cos();
            vertices.push([r * cos, r * sin, 0.0]);
            uvs.push([r, v].map(|x| x as f32));
        }
    }
    let corner = |ring: u32, sector: u32| ring * (sectors + 1) + sector;
    for ring in 0..rings {
        for sector in 0..sectors {
            let [a, b] = [corner(ring, sector), corner(ring, sector + 1)];
            let [c, d] = [corner(ring + 1, sector), corner(ring + 1, sector + 1)];
            triangles.push([a, c, d]);
            if ring > 0 {
                triangles.push([a, d, b]);
            }
        }
    }
    Mesh { vertices, uvs, triangles, ..Mesh::default() }
}
