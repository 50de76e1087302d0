//! Leaves of the tree that rays traverse.

use crate::PrimitiveId;
use crate::bvh::build::BinaryTree;
use crate::frame::Frame;
use crate::shapes::FilterShape;
use crate::vec4::{Axis, Four};
use bytemuck::{Pod, Zeroable};

/// The fewest lanes that leaves have, and as many numbers about its primitives as a leaf tells.
pub(crate) const LEAST_LANES: usize = 8;

/// The id in a lane that is empty.
pub(crate) const NO_ID: u32 = u32::MAX;

/// Rows before those of vertices: ids, and what is told of all lanes.
const HEAD_ROWS: usize = 2;
/// Rows of a leaf.
const ROWS: usize = HEAD_ROWS + 9;

/// A leaf: up to `W` primitives, eight or sixteen, as many as a vector of the instruction set has lanes. A row of the leaf is a number
/// for each of them, and begins where a vector does in memory:
///
/// - ids; [`NO_ID`] for an empty lane. Lanes are filled from the first on.
/// - What is told of all, see [`About`].
/// - The vertices of triangles in the accelerator's frame, rounded: x, y, z of a, then of b, then of c; of a parallelogram
///   a corner and its neighbours; those of a square around a disk. The rows of the first vertex hold a sphere's centre, the first row
///   of the second its radius. NaN in all other lanes, which no filter for flat shapes or spheres keeps.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct Leaf<const W: usize>([[u32; W]; ROWS]);

/// A number about a leaf, by its place in the second row.
#[derive(Clone, Copy)]
enum About {
    /// The largest extent of the primitives' common box along an axis.
    Extent,
    /// Its part of the bound on the error of projected coordinates.
    Error,
    /// The lanes of flat shapes, one bit each.
    Flats,
    /// Those among them that are parallelograms, or disks.
    Quads,
    /// Those among these that are disks.
    Disks,
    /// The lanes of spheres.
    Spheres,
    /// The lanes of cylinders and instances.
    Others,
    /// The lanes of triangles whose vertices are exact.
    Exact,
}

impl<const W: usize> Leaf<W> {
    /// The leaf that stands for a subtree of a binary tree. `shape` tells what a primitive is.
    pub(crate) fn new(frame: &Frame, tree: &BinaryTree, root: u32, shape: impl Fn(u32) -> FilterShape) -> Self {
        let node = &tree.nodes[root as usize];
        let mut vertices = [[[f32::NAN; W]; 3]; 3];
        let mut ids = [NO_ID; W];
        let [mut flats, mut quads, mut disks, mut spheres, mut others, mut exact] = [0_u32; 6];
        for (lane, id) in tree.primitives(root).enumerate() {
            ids[lane] = id;
            let mut put = |i: usize, vertex| {
                for (c, row) in frame.point(vertex).into_iter().zip(&mut vertices[i]) {
                    row[lane] = c;
                }
            };
            match shape(id) {
                FilterShape::Triangle(vertices) => {
                    vertices.into_iter().enumerate().for_each(|(i, vertex)| put(i, vertex));
                    flats |= 1 << lane;
                    exact |= u32::from(vertices.into_iter().all(|v| frame.is_exact(v))) << lane;
                }
                FilterShape::Parallelogram(corners) => {
                    corners.into_iter().enumerate().for_each(|(i, vertex)| put(i, vertex));
                    flats |= 1 << lane;
                    quads |= 1 << lane;
                }
                FilterShape::Disk(corners) => {
                    corners.into_iter().enumerate().for_each(|(i, vertex)| put(i, vertex));
                    flats |= 1 << lane;
                    quads |= 1 << lane;
                    disks |= 1 << lane;
                }
                FilterShape::Sphere(centre, radius) => {
                    put(0, centre);
                    vertices[1][0][lane] = frame.length(radius);
                    spheres |= 1 << lane;
                }
                FilterShape::Other => others |= 1 << lane,
            }
        }
        // NaN is never the larger.
        let magnitude = vertices.iter().flatten().flatten().fold(0.0, |m, c| c.abs().max(m));
        let mut extent = (0..3).map(|k| node.bounds.max[k] - node.bounds.min[k]).fold(0.0, f32::max);
        if disks != 0 {
            // Their squares reach out of the box.
            for k in 0..3 {
                let corners = || vertices.iter().flat_map(|v| v[k]);
                let (lower, upper) =
                    (corners().fold(node.bounds.min[k], f32::min), corners().fold(node.bounds.max[k], f32::max));
                extent = extent.max(upper - lower);
            }
        }
        let error = Frame::projection_error(magnitude);
        let about = [extent.to_bits(), error.to_bits(), flats, quads, disks, spheres, others, exact];
        let mut rows = [[0; W]; ROWS];
        rows[0] = ids;
        rows[1][..LEAST_LANES].copy_from_slice(&about);
        for (row, coordinates) in rows[HEAD_ROWS..].iter_mut().zip(vertices.as_flattened()) {
            *row = coordinates.map(f32::to_bits);
        }
        Self(rows)
    }

    #[inline(always)]
    fn about(&self, what: About) -> u32 {
        self.0[1][what as usize]
    }

    /// Ids.
    #[inline(always)]
    pub(crate) fn ids(&self) -> &[u32; W] {
        &self.0[0]
    }

    /// The largest extent of the primitives' common box along an axis.
    #[inline(always)]
    pub(crate) fn extent(&self) -> f32 {
        f32::from_bits(self.about(About::Extent))
    }

    /// The leaf's part of the bound on the error of projected coordinates.
    #[inline(always)]
    pub(crate) fn error(&self) -> f32 {
        f32::from_bits(self.about(About::Error))
    }

    /// The lanes of flat shapes, one bit each.
    #[inline(always)]
    pub(crate) fn flats(&self) -> u32 {
        self.about(About::Flats)
    }

    /// Those among them that are parallelograms, or disks.
    #[inline(always)]
    pub(crate) fn quads(&self) -> u32 {
        self.about(About::Quads)
    }

    /// Those among these that are disks.
    #[inline(always)]
    pub(crate) fn disks(&self) -> u32 {
        self.about(About::Disks)
    }

    /// The lanes of spheres.
    #[inline(always)]
    pub(crate) fn spheres(&self) -> u32 {
        self.about(About::Spheres)
    }

    /// The lanes of cylinders and instances. They have no filter: they are tested in `f64`
    /// whenever a ray enters the leaf.
    #[inline(always)]
    pub(crate) fn others(&self) -> u32 {
        self.about(About::Others)
    }

    /// A vertex in all lanes: x, y and z.
    #[inline(always)]
    pub(crate) fn vertex(&self, i: usize) -> &[[f32; W]; 3] {
        let rows = self.0[HEAD_ROWS + 3 * i..].first_chunk::<3>().expect("a vertex");
        bytemuck::cast_ref(rows)
    }

    /// The primitive in a lane.
    #[inline(always)]
    pub(crate) fn id(&self, lane: usize) -> PrimitiveId {
        PrimitiveId(self.ids()[lane % W])
    }

    /// Whether the vertices in a lane are those of its triangle, which need not be fetched to be tested in `f64`.
    #[inline(always)]
    pub(crate) fn is_exact(&self, lane: usize) -> bool {
        self.about(About::Exact) >> lane & 1 == 1
    }

    /// The vertices in a lane if they are exact, along `axes`: what [`Triangle::lanes`] gives for it.
    ///
    /// [`Triangle::lanes`]: crate::Triangle::lanes
    #[inline(always)]
    pub(crate) fn lanes<F: Four>(&self, token: F::Token, frame: &Frame, lane: usize, axes: [Axis; 3]) -> [F; 3] {
        let unscale = F::splat(token, frame.unscale());
        let [kx, ky, kz] = axes;
        [
            F::widened(token, self.row(kx, lane)) * unscale,
            F::widened(token, self.row(ky, lane)) * unscale,
            F::widened(token, self.row(kz, lane)) * unscale,
        ]
    }

    /// The coordinates of the vertices in a lane along an axis; the fourth is the third's.
    #[inline(always)]
    fn row(&self, axis: Axis, lane: usize) -> [f32; 4] {
        let at = |vertex: usize| f32::from_bits(self.0[HEAD_ROWS + 3 * vertex + axis as usize][lane % W]);
        [at(0), at(1), at(2), at(2)]
    }
}
