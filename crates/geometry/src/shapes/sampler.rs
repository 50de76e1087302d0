//! Directions toward shapes: how they are drawn, and with which density.
//!
//! The density of a direction is a function of the reference point and the direction alone. It is the same for a direction that was drawn
//! and for one that was found otherwise. Solid angles of near, far and enclosing shapes need `f64`.
//!
//! This belongs to geometry: it needs the roots and error bounds of shapes, and knows of no light. Which sides emit, and how much, is the
//! light's.

use super::{Cylinder, Disk, PlanarSampler, Sphere};
use crate::Aabb;
use crate::warp::uniform_sphere;
use etalon_optics::Vec3;

/// A shape that directions can be drawn toward, with what every draw asks of it.
#[derive(Clone, Debug)]
pub enum ShapeSampler {
    /// A parallelogram or a triangle: points are uniform on its area.
    Planar(PlanarSampler),
    /// A disk: points are uniform on its area.
    Disk(Disk),
    /// A sphere: directions are uniform in the cone that it fills.
    Sphere(Sphere),
    /// A cylinder: points are uniform on its area.
    Cylinder(Cylinder),
}

/// A direction toward a point of a shape.
#[derive(Clone, Copy, Debug)]
pub struct ShapeSample {
    /// The point.
    pub point: Vec3<f64>,
    /// Unit vector from the reference point toward it.
    pub wi: Vec3<f64>,
    /// Density of `wi`, sr⁻¹.
    pub density: f64,
    /// Whether the outward side is seen.
    pub front: bool,
    /// False where there is no direction, or none with a finite density, as edge-on. The rest then means nothing, but for the point of a shape
    /// whose points are uniform.
    pub valid: bool,
}

/// The density of a direction that meets a shape.
#[derive(Clone, Copy, Debug)]
pub struct DirectionDensity {
    /// The density, sr⁻¹.
    pub density: f64,
    /// Whether the outward side is seen first.
    pub front: bool,
}

macro_rules! each {
    ($sampler:expr, $shape:ident => $result:expr) => {
        match $sampler {
            ShapeSampler::Planar($shape) => $result,
            ShapeSampler::Disk($shape) => $result,
            ShapeSampler::Sphere($shape) => $result,
            ShapeSampler::Cylinder($shape) => $result,
        }
    };
}

impl ShapeSampler {
    /// Draws a direction from `from` toward the shape with `u` in [0, 1)².
    #[inline]
    pub fn sample(&self, from: Vec3<f64>, u: [f64; 2]) -> ShapeSample {
        each!(self, shape => shape.sample(from, u))
    }

    /// The density with which [`ShapeSampler::sample`] draws from `from` the direction `wi`, which meets the shape.
    #[inline]
    pub fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> DirectionDensity {
        each!(self, shape => shape.density(from, wi))
    }

    /// A point of the shape for `u` in [0, 1)²; all are equally likely.
    pub fn point(&self, u: [f64; 2]) -> Vec3<f64> {
        match self {
            Self::Sphere(sphere) => sphere.centre() + uniform_sphere(u) * sphere.radius(),
            // Their points are uniform, wherever they are seen from.
            _ => self.sample(Vec3::ZERO, u).point,
        }
    }

    /// Area of one side, m².
    pub fn area(&self) -> f64 {
        each!(self, shape => shape.area())
    }

    /// A box that contains the shape.
    pub fn bounds(&self) -> Aabb {
        each!(self, shape => shape.bounds())
    }

    /// The unit normal, if it is the same all over the shape.
    pub fn normal(&self) -> Option<Vec3<f64>> {
        match self {
            Self::Planar(shape) => Some(shape.normal),
            Self::Disk(shape) => Some(shape.normal()),
            _ => None,
        }
    }
}
