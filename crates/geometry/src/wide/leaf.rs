//! Leaves of the tree that rays traverse.

use crate::build::BinaryTree;
use crate::frame::Frame;
use crate::query::Four;
use crate::{Primitive, PrimitiveId};
use bytemuck::{Pod, Zeroable};

/// Primitives of a leaf.
pub(crate) const LEAF_WIDTH: usize = 8;

/// A leaf: up to eight primitives.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Leaf8 {
    /// Ids; `u32::MAX` for an empty lane.
    pub(crate) ids: [u32; LEAF_WIDTH],
    /// The largest extent of the primitives' common box along an axis.
    pub(crate) extent: f32,
    /// Its part of the bound on the error of projected coordinates.
    pub(crate) error: f32,
    /// The lanes of flat shapes, one bit each.
    pub(crate) flats: u8,
    /// Those among them that are parallelograms, or disks.
    pub(crate) quads: u8,
    /// Those among these that are disks.
    pub(crate) disks: u8,
    /// The lanes of spheres.
    pub(crate) spheres: u8,
    /// The lanes of cylinders and instances. They have no filter: they are tested in `f64`
    /// whenever a ray enters the leaf.
    pub(crate) others: u8,
    /// The lanes of triangles whose vertices are exact: they need not be fetched to be tested in `f64`.
    pub(crate) exact: u8,
    padding: [u8; 18],
    /// The vertices of triangles in the accelerator's frame, rounded: x, y, z of a, then of b, then of c; of a parallelogram
    /// a corner and its neighbours; those of a square around a disk. The rows of the first vertex hold a sphere's centre, the first row of the second its radius. NaN in all other lanes, which no
    /// filter for flat shapes or spheres keeps.
    pub(crate) vertices: [[[f32; LEAF_WIDTH]; 3]; 3],
}

impl Leaf8 {
    /// The leaf that stands for a leaf of a binary tree.
    pub(super) fn new(frame: &Frame, tree: &BinaryTree, root: u32, primitives: &[Primitive]) -> Self {
        let node = &tree.nodes[root as usize];
        let first = node.first as usize;
        let extent = |k: usize| node.bounds.max[k] - node.bounds.min[k];
        let mut leaf = Self {
            vertices: [[[f32::NAN; LEAF_WIDTH]; 3]; 3],
            ids: [u32::MAX; LEAF_WIDTH],
            extent: extent(0).max(extent(1)).max(extent(2)),
            error: 0.0,
            flats: 0,
            quads: 0,
            disks: 0,
            spheres: 0,
            others: 0,
            exact: 0,
            padding: [0; 18],
        };
        for (lane, &id) in tree.order[first..first + node.count as usize].iter().enumerate() {
            leaf.ids[lane] = id;
            let mut put = |i: usize, vertex| {
                for (c, row) in frame.point(vertex).into_iter().zip(&mut leaf.vertices[i]) {
                    row[lane] = c;
                }
            };
            match &primitives[id as usize] {
                Primitive::Triangle(t) => {
                    t.vertices().into_iter().enumerate().for_each(|(i, vertex)| put(i, vertex));
                    leaf.flats |= 1 << lane;
                    let exact = t.vertices().into_iter().all(|v| frame.is_exact(v));
                    leaf.exact |= u8::from(exact) << lane;
                }
                Primitive::Parallelogram(p) => {
                    let [corner, a, _, b] = p.corners();
                    [corner, a, b].into_iter().enumerate().for_each(|(i, vertex)| put(i, vertex));
                    leaf.flats |= 1 << lane;
                    leaf.quads |= 1 << lane;
                }
                Primitive::Disk(d) => {
                    d.square().into_iter().enumerate().for_each(|(i, vertex)| put(i, vertex));
                    leaf.flats |= 1 << lane;
                    leaf.quads |= 1 << lane;
                    leaf.disks |= 1 << lane;
                }
                Primitive::Sphere(s) => {
                    put(0, s.centre());
                    leaf.vertices[1][0][lane] = frame.length(s.radius());
                    leaf.spheres |= 1 << lane;
                }
                _ => leaf.others |= 1 << lane,
            }
        }
        // NaN is never the larger.
        let magnitude = leaf.vertices.iter().flatten().flatten().fold(0.0, |m, c| c.abs().max(m));
        leaf.error = Frame::projection_error(magnitude);
        if leaf.disks != 0 {
            // Their squares reach out of the box.
            for k in 0..3 {
                let corners = || leaf.vertices.iter().flat_map(|v| v[k]);
                let (lower, upper) =
                    (corners().fold(node.bounds.min[k], f32::min), corners().fold(node.bounds.max[k], f32::max));
                leaf.extent = leaf.extent.max(upper - lower);
            }
        }
        leaf
    }

    /// The primitive in a lane.
    #[inline(always)]
    pub(crate) fn id(&self, lane: usize) -> PrimitiveId {
        PrimitiveId(self.ids[lane % LEAF_WIDTH])
    }

    /// Whether the vertices in a lane are those of its triangle.
    #[inline(always)]
    pub(crate) fn is_exact(&self, lane: usize) -> bool {
        self.exact >> lane & 1 == 1
    }

    /// The vertices in a lane if they are exact, along `axes`: what [`Triangle::lanes`] gives for it.
    ///
    /// [`Triangle::lanes`]: crate::Triangle::lanes
    #[inline(always)]
    pub(crate) fn lanes<F: Four>(&self, token: F::Token, frame: &Frame, lane: usize, axes: [usize; 3]) -> [F; 3] {
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
    fn row(&self, axis: usize, lane: usize) -> [f32; 4] {
        let ([a, b, c], lane) = (&self.vertices, lane % LEAF_WIDTH);
        [a[axis][lane], b[axis][lane], c[axis][lane], c[axis][lane]]
    }
}
