//! What primitives there are.

use super::Primitive;
use crate::Aabb;
use crate::shapes::FilterShape;
use rayon::prelude::*;

/// Primitives that are counted one after the other.
const CHUNK: usize = 1 << 14;

/// What primitives there are: all that is asked of each of them before a tree is built, at once, for a million are ten times what
/// caches hold.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PrimitiveStatistics {
    /// All.
    pub(crate) count: usize,
    /// Triangles among them.
    pub(crate) triangles: usize,
    /// Spheres among them.
    pub(crate) spheres: usize,
    /// Shapes among them that are tested one by one.
    pub(crate) without_filter: usize,
    /// Instances among them.
    pub(crate) instances: usize,
    /// A box around all; `None` if there are none.
    pub(crate) bounds: Option<Aabb>,
}

impl PrimitiveStatistics {
    /// Counts. The result does not depend on the number of threads.
    pub(crate) fn of(primitives: &[Primitive]) -> Self {
        let count = |chunk: &[Primitive]| chunk.iter().fold(Self::default(), Self::with);
        if primitives.len() <= CHUNK {
            return count(primitives);
        }
        let chunks: Vec<Self> = primitives.par_chunks(CHUNK).map(count).collect();
        chunks.into_iter().fold(Self::default(), Self::and)
    }

    fn with(self, primitive: &Primitive) -> Self {
        let is = |is: bool| usize::from(is);
        self.and(Self {
            count: 1,
            triangles: is(matches!(primitive, Primitive::Triangle(_))),
            spheres: is(matches!(primitive, Primitive::Sphere(_))),
            without_filter: is(!primitive.is_instance() && matches!(primitive.filter_shape(), FilterShape::Other)),
            instances: is(primitive.is_instance()),
            bounds: Some(primitive.bounds()),
        })
    }

    fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            triangles: self.triangles + other.triangles,
            spheres: self.spheres + other.spheres,
            without_filter: self.without_filter + other.without_filter,
            instances: self.instances + other.instances,
            bounds: self.bounds.into_iter().chain(other.bounds).reduce(Aabb::union),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::Random;
    use crate::{Cylinder, Sphere, Triangle};
    use etalon_optics::Vec3;

    #[test]
    fn many_are_counted_as_one_by_one() {
        let mut random = Random::new(5);
        for count in [0, 1, 7, CHUNK, CHUNK + 1, 3 * CHUNK - 1] {
            let (mut bounds, mut counts) = (None::<Aabb>, [0; 3]);
            let primitives: Vec<Primitive> = (0..count)
                .map(|_| {
                    let p = Vec3::new(random.unit(), random.unit(), random.unit());
                    let kind = (3.0 * random.unit()) as usize;
                    counts[kind] += 1;
                    let primitive = match kind {
                        0 => Primitive::from(Sphere::new(p, 0.1).unwrap()),
                        1 => Primitive::from(Cylinder::new(p, p + Vec3::new(0.0, 0.0, 1.0), 0.1, false).unwrap()),
                        _ => {
                            let (b, c) = (p + Vec3::new(0.1, 0.0, 0.0), p + Vec3::new(0.0, 0.1, 0.0));
                            Primitive::from(Triangle::new(p, b, c).unwrap())
                        }
                    };
                    bounds = Some(bounds.map_or(primitive.bounds(), |b| b.union(primitive.bounds())));
                    primitive
                })
                .collect();
            let statistics = PrimitiveStatistics::of(&primitives);
            assert_eq!([statistics.spheres, statistics.without_filter, statistics.triangles], counts);
            assert_eq!([statistics.count, statistics.instances], [count, 0]);
            assert_eq!(statistics.bounds, bounds);
        }
    }
}
