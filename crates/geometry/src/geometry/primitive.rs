//! What rays meet: shapes, and instances of whole geometries.

use super::Instance;
use crate::query::Query;
use crate::ray::{ExactPoint, RawHit};
use crate::shapes::{FilterShape, ShapeMap};
use crate::{Aabb, Cylinder, Disk, Parallelogram, ShapeError, ShapeSampler, Sphere, Triangle};
use etalon_optics::Vec3;

/// A shape that rays meet.
#[derive(Clone, Debug, PartialEq)]
pub enum Primitive {
    /// A full sphere.
    Sphere(Sphere),
    /// A parallelogram.
    Parallelogram(Parallelogram),
    /// A flat disk.
    Disk(Disk),
    /// A triangle.
    Triangle(Triangle),
    /// A cylinder.
    Cylinder(Cylinder),
    /// A geometry placed by an affine map.
    Instance(Box<Instance>),
}

macro_rules! primitive_from {
    ($($shape:ident),*) => {
        $(impl From<$shape> for Primitive {
            fn from(shape: $shape) -> Self {
                Self::$shape(shape)
            }
        })*
    };
}
primitive_from!(Sphere, Parallelogram, Disk, Triangle, Cylinder);

impl From<Instance> for Primitive {
    fn from(instance: Instance) -> Self {
        Self::Instance(Box::new(instance))
    }
}

macro_rules! each {
    ($primitive:expr, $shape:ident => $result:expr) => {
        match $primitive {
            Primitive::Sphere($shape) => $result,
            Primitive::Parallelogram($shape) => $result,
            Primitive::Disk($shape) => $result,
            Primitive::Triangle($shape) => $result,
            Primitive::Cylinder($shape) => $result,
            Primitive::Instance($shape) => $result,
        }
    };
}

impl Primitive {
    /// A box that contains the shape.
    pub fn bounds(&self) -> Aabb {
        each!(self, s => s.bounds())
    }

    /// A point, the unit normal and the size of a flat shape.
    pub(crate) fn plane(&self) -> Option<(Vec3<f64>, Vec3<f64>, f64)> {
        match self {
            Self::Triangle(s) => Some(s.plane()),
            Self::Parallelogram(s) => Some(s.plane()),
            Self::Disk(s) => Some((s.centre(), s.normal(), s.radius())),
            Self::Sphere(_) | Self::Cylinder(_) | Self::Instance(_) => None,
        }
    }

    /// Its image, of spheres, disks and cylinders under similarities only. An instance stays what it is.
    ///
    /// # Errors
    /// If the image is out of range or has no area.
    pub fn mapped(&self, map: &impl ShapeMap) -> Result<Self, ShapeError> {
        Ok(match self {
            Self::Sphere(s) => s.mapped(map)?.into(),
            Self::Parallelogram(s) => s.mapped(map)?.into(),
            Self::Disk(s) => s.mapped(map)?.into(),
            Self::Triangle(s) => s.mapped(map)?.into(),
            Self::Cylinder(s) => s.mapped(map)?.into(),
            Self::Instance(_) => self.clone(),
        })
    }

    /// How directions toward it are drawn; `None` of an instance.
    pub fn sampler(&self) -> Option<ShapeSampler> {
        match self {
            Self::Sphere(s) => Some(ShapeSampler::Sphere(s.clone())),
            Self::Parallelogram(s) => Some(ShapeSampler::Planar(s.sampler())),
            Self::Disk(s) => Some(ShapeSampler::Disk(s.clone())),
            Self::Triangle(s) => Some(ShapeSampler::Planar(s.sampler())),
            Self::Cylinder(s) => Some(ShapeSampler::Cylinder(s.clone())),
            Self::Instance(_) => None,
        }
    }

    /// What the filters see of it.
    pub(crate) fn filter_shape(&self) -> FilterShape {
        match self {
            Self::Triangle(s) => FilterShape::Triangle(s.vertices()),
            Self::Parallelogram(s) => {
                let [corner, a, _, b] = s.corners();
                FilterShape::Parallelogram([corner, a, b])
            }
            Self::Disk(s) => FilterShape::Disk(s.square()),
            Self::Sphere(s) => FilterShape::Sphere(s.centre(), s.radius()),
            Self::Cylinder(_) | Self::Instance(_) => FilterShape::Other,
        }
    }

    /// Whether it is an instance.
    pub(crate) fn is_instance(&self) -> bool {
        matches!(self, Self::Instance(_))
    }

    /// Whether its normal depends on the place.
    pub(crate) fn is_curved(&self) -> bool {
        matches!(self, Self::Sphere(_) | Self::Cylinder(_))
    }

    /// The closest hit of a shape, no instance, with 0 < t < `t_max`. `leaves`: the ray leaves this very primitive.
    #[inline]
    pub(crate) fn intersect(&self, query: &Query, t_max: f64, leaves: bool) -> Option<RawHit> {
        match self {
            Self::Triangle(s) => (!leaves).then(|| s.intersect(query, t_max)).flatten(),
            Self::Parallelogram(s) => (!leaves).then(|| s.intersect(query, t_max)).flatten(),
            Self::Disk(s) => (!leaves).then(|| s.intersect(query, t_max)).flatten(),
            Self::Sphere(s) => s.intersect(query, t_max, leaves),
            Self::Cylinder(s) => s.intersect(query, t_max, leaves),
            Self::Instance(_) => unreachable!("a ray enters an instance by a walk"),
        }
    }

    /// All crossings of the ray with the shape, at most two, the nearer first. `leaves`: the ray leaves this very primitive.
    ///
    /// The second crossing of a curved shape is the one that a ray meets which leaves the shape at the first.
    pub(crate) fn crossings(&self, query: &Query, leaves: bool) -> [Option<RawHit>; 2] {
        let first = self.intersect(query, f64::INFINITY, leaves);
        let second = match first {
            Some(first) if self.is_curved() => {
                self.intersect(query, f64::INFINITY, true).filter(|second| second.t > first.t)
            }
            _ => None,
        };
        [first, second]
    }

    /// The parameters that a hit at the point `p` of it carries, to rounding; 0 of shapes whose hits carry none.
    pub(crate) fn parameters(&self, p: Vec3<f64>) -> [f64; 2] {
        let (corner, [a, b]) = match self {
            Self::Triangle(s) => {
                let [a, b, c] = s.vertices();
                (a, [b - a, c - a])
            }
            Self::Parallelogram(s) => (s.corner(), s.edges()),
            Self::Sphere(_) | Self::Disk(_) | Self::Cylinder(_) | Self::Instance(_) => return [0.0; 2],
        };
        // p = corner + u a + v b, each by its share of a × b.
        let (n, d) = (a.cross(b), p - corner);
        let whole = n.length_squared();
        [d.cross(b).dot(n) / whole, a.cross(d).dot(n) / whole]
    }

    /// The surface at the point `p`, which lies near it.
    #[inline]
    pub(crate) fn surface(&self, p: Vec3<f64>) -> ExactPoint {
        match self {
            Self::Sphere(s) => s.surface(p),
            Self::Parallelogram(s) => s.surface(p),
            Self::Disk(s) => s.surface(p),
            Self::Triangle(s) => s.surface(p),
            Self::Cylinder(s) => s.surface(p),
            Self::Instance(_) => unreachable!("a hit names the shape within an instance"),
        }
    }
}
