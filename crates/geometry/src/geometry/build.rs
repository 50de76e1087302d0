//! Building a geometry: a tree of many primitives, a small scene of few shapes.

use super::{Geometry, GeometryError, MAX_NESTING, Primitive, PrimitiveStatistics, WideTree};
use crate::bvh::build::{Costs, Item, LEAF_LIMIT, TreeBuilder, build, build_fast};
use crate::bvh::node::leaf_lanes;
use crate::bvh::optimize::improved;
use crate::frame::Frame;
use crate::level;
use crate::small_scene::{FLAT_LIMIT, SmallScene};
use rayon::prelude::*;

/// Up to this many primitives, instances among them, are tested one by one, without a tree.
const TREELESS_LIMIT: usize = 8;
/// Most boxes of an outline.
const OUTLINE_LIMIT: usize = 96;

impl Geometry {
    /// Builds the accelerator. No primitives at all are allowed.
    ///
    /// # Errors
    /// If there are more than 2²⁹ primitives, more than 2³¹ instances, or more than [`MAX_NESTING`] of them within each
    /// other.
    pub fn build(primitives: Vec<Primitive>) -> Result<Self, GeometryError> {
        Self::build_by(primitives, TreeBuilder::Thorough)
    }

    /// [`Geometry::build`] with a choice of the tree's builder. The hits of rays do not depend on it. Of a geometry that is placed by
    /// instances, the boxes of these follow the tree: there the last bits of a hit at the edge of a box may.
    ///
    /// # Errors
    /// As [`Geometry::build`].
    pub fn build_by(primitives: Vec<Primitive>, builder: TreeBuilder) -> Result<Self, GeometryError> {
        Self::build_as(primitives, FLAT_LIMIT, builder)
    }

    /// [`Geometry::build`] with a tree above another number of primitives: for tests, which want trees of few.
    ///
    /// # Errors
    /// As [`Geometry::build`].
    #[doc(hidden)]
    pub fn build_with(primitives: Vec<Primitive>, flat_limit: usize) -> Result<Self, GeometryError> {
        Self::build_as(primitives, flat_limit, TreeBuilder::Thorough)
    }

    pub(crate) fn build_as(
        mut primitives: Vec<Primitive>,
        flat_limit: usize,
        builder: TreeBuilder,
    ) -> Result<Self, GeometryError> {
        if primitives.len() > 1 << 29 {
            return Err(GeometryError::TooMany(primitives.len()));
        }
        let statistics = PrimitiveStatistics::of(&primitives);
        let (mut instances, mut instance_count, mut nesting) = (Vec::with_capacity(statistics.instances), 1, 0);
        let may_be_instances = if statistics.instances > 0 { primitives.as_mut_slice() } else { &mut [] };
        for (index, primitive) in may_be_instances.iter_mut().enumerate() {
            if let Primitive::Instance(instance) = primitive {
                instances.push(index as u32);
                instance.first = instance_count as u32;
                // Each is at most 2³¹, and they are checked as they come: no overflow.
                instance_count += instance.count();
                nesting = nesting.max(instance.geometry().nesting + 1);
                if instance_count > 1 << 31 {
                    return Err(GeometryError::TooManyInstances(instance_count));
                }
            }
        }
        if nesting > MAX_NESTING {
            return Err(GeometryError::TooDeep(nesting));
        }
        let bounds = statistics.bounds;
        let level = level::best();
        let is_small = instances.is_empty() && primitives.len() <= flat_limit;
        let shapes = || primitives.iter().map(Primitive::filter_shape);
        let small_scene = bounds.filter(|_| is_small).map(|bounds| SmallScene::new(shapes(), bounds));
        let mut outline = Vec::new();
        let tree = bounds.filter(|_| !is_small && primitives.len() > TREELESS_LIMIT).map(|bounds| {
            let frame = Frame::around(bounds);
            // What is within an instance costs far more than a node.
            let item = |(id, p): (usize, &Primitive)| Item::new(&frame.enclose(p.bounds()), id as u32, p.is_instance());
            let items = primitives.par_iter().enumerate().map(item).collect();
            let costs = costs(&statistics);
            let binary = match builder {
                TreeBuilder::Thorough => improved(build(items, costs, level), costs, level),
                TreeBuilder::Fast => build_fast(items, costs, level),
            };
            outline = binary.outline(OUTLINE_LIMIT).into_iter().map(|b| frame.unscaled_box(b)).collect();
            WideTree::collapse(frame, &binary, &primitives, &statistics, costs, leaf_lanes(level))
        });
        if tree.is_none() {
            outline = if primitives.len() <= OUTLINE_LIMIT {
                primitives.iter().map(Primitive::bounds).collect()
            } else {
                bounds.into_iter().collect()
            };
        }
        Ok(Self { primitives, bounds, tree, small_scene, level, instances, instance_count, nesting, outline, label: 0 })
    }
}

/// What the tree's builder weighs: a leaf tests flat shapes or spheres at once, but shapes without a filter one by one. As many at once, whatever
/// the instruction set: what a ray meets of an instance must not depend on that, nor does the tree of which its box is made.
fn costs(statistics: &PrimitiveStatistics) -> Costs {
    let most = 2 * statistics.without_filter < statistics.count - statistics.instances;
    Costs { block: if most { LEAF_LIMIT as u32 } else { 1 }, node: 0.35 }
}
