//! Shapes, and what the rest of the renderer asks of them.

use std::collections::HashMap;
use std::sync::Arc;

/// Texture coordinates of a disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DiskCoordinates {
    /// Those of the square around it.
    #[default]
    Square,
    /// u is the share of the radius, v that of a turn about the axis.
    Polar,
}

/// A shape in its own coordinates, lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Sphere; its normal points outward.
    Sphere {
        /// Centre.
        center: [f64; 3],
        /// Radius, above 0.
        radius_m: f64,
    },
    /// The points `origin + a·u + b·v` for a, b in [0, 1]; its normal is along u × v.
    Parallelogram {
        /// One corner.
        origin: [f64; 3],
        /// One edge from it.
        u: [f64; 3],
        /// The other edge from it.
        v: [f64; 3],
    },
    /// Disk.
    Disk {
        /// Centre.
        center: [f64; 3],
        /// Unit normal.
        normal: [f64; 3],
        /// Radius, above 0.
        radius_m: f64,
        /// Its texture coordinates.
        coordinates: DiskCoordinates,
    },
    /// Cylinder; its normal points outward.
    Cylinder {
        /// Middle of one end.
        start: [f64; 3],
        /// Middle of the other.
        end: [f64; 3],
        /// Radius, above 0.
        radius_m: f64,
        /// Whether disks close its ends.
        capped: bool,
    },
    /// Triangles; objects that name the same file share them.
    Mesh(Arc<Mesh>),
}

/// Triangles, and what their vertices carry.
///
/// The geometric normal of a triangle (a, b, c) is along (b − a) × (c − a).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, m.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices, all within range.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals: none, or for each vertex a unit vector, or (0, 0, 0) where it has none.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates: none, or one pair for each vertex.
    pub uvs: Vec<[f32; 2]>,
    /// Linear Rec. 709 colours: none, or one for each vertex.
    pub colours: Vec<[f32; 3]>,
}

impl Shape {
    /// What it is called, if it has a radius: it then stays what it is under similarities only.
    pub fn round_name(&self) -> Option<&'static str> {
        match self {
            Self::Sphere { .. } => Some("sphere"),
            Self::Disk { .. } => Some("disk"),
            Self::Cylinder { .. } => Some("cylinder"),
            Self::Parallelogram { .. } | Self::Mesh(_) => None,
        }
    }

    /// Whether its points have texture coordinates.
    pub fn has_texture_coordinates(&self) -> bool {
        match self {
            Self::Mesh(mesh) => !mesh.uvs.is_empty(),
            _ => true,
        }
    }

    /// The colours of its vertices; empty if it has none.
    pub fn vertex_colours(&self) -> &[[f32; 3]] {
        match self {
            Self::Mesh(mesh) => &mesh.colours,
            _ => &[],
        }
    }

    /// Points and a length, m: no point of the shape is farther than this length from the convex hull of the points.
    pub fn hull_m(&self) -> (Vec<[f64; 3]>, f64) {
        match self {
            Self::Sphere { center, radius_m } | Self::Disk { center, radius_m, .. } => (vec![*center], *radius_m),
            Self::Cylinder { start, end, radius_m, .. } => (vec![*start, *end], *radius_m),
            Self::Parallelogram { origin, u, v } => {
                let corner = |a: f64, b: f64| [0, 1, 2].map(|k| origin[k] + a * u[k] + b * v[k]);
                (vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0)], 0.0)
            }
            Self::Mesh(mesh) => (mesh.box_corners_m().to_vec(), 0.0),
        }
    }

    /// Where it is open, so that it bounds no solid; `None` if it is closed.
    pub fn open_edges(&self) -> Option<String> {
        match self {
            Self::Sphere { .. } => None,
            Self::Cylinder { capped, .. } => (!capped).then(|| "a tube is open at its ends".to_owned()),
            Self::Parallelogram { .. } => Some("a parallelogram has an edge".to_owned()),
            Self::Disk { .. } => Some("a disk has an edge".to_owned()),
            Self::Mesh(mesh) => {
                let count = mesh.open_edges();
                (count > 0).then(|| format!("{count} edges of its mesh are open"))
            }
        }
    }
}

impl Mesh {
    /// The corners of the smallest box around its vertices.
    fn box_corners_m(&self) -> [[f64; 3]; 8] {
        let least = |k: usize| self.vertices.iter().fold(f64::INFINITY, |least, vertex| least.min(vertex[k]));
        let most = |k: usize| self.vertices.iter().fold(f64::NEG_INFINITY, |most, vertex| most.max(vertex[k]));
        let (min, max) = ([0, 1, 2].map(least), [0, 1, 2].map(most));
        std::array::from_fn(|number| [0, 1, 2].map(|k| if number >> k & 1 == 0 { min[k] } else { max[k] }))
    }

    /// How many of its edges are open. An edge is closed if two triangles share it that pass it in opposite directions, vertices at
    /// the same place counting as one.
    fn open_edges(&self) -> usize {
        let at = |i: u32| self.vertices[i as usize].map(|v| (v + 0.0).to_bits());
        let mut open: HashMap<_, i64> = HashMap::new();
        for triangle in &self.triangles {
            for i in 0..3 {
                let (a, b) = (at(triangle[i]), at(triangle[(i + 1) % 3]));
                let (edge, turn) = if a < b { ((a, b), 1) } else { ((b, a), -1) };
                *open.entry(edge).or_default() += turn;
            }
        }
        open.values().filter(|&&balance| balance != 0).count()
    }
}
