//! The frame in which a scene is rendered: centred and scaled by an exact power of two.
//!
//! In it the scene is about as large as 1 and near the origin, wherever and however large it is in the world, so that no
//! digits are spent on its place. Nothing is rounded on the way: the scale is a power of two, and an axis is centred only
//! where every coordinate c of the scene is between half of the centre and twice it, in which case c − centre is exact
//! (Sterbenz, *Floating-Point Computation*, 1974). Scaling a scene by a power of two therefore changes no bit of its image.

use etalon_geometry::{Aabb, Instance, Placement, Primitive, ShapeError, ShapeMap};
use etalon_optics::Vec3;
use etalon_scene::{Camera, Projection, ThinLens, Transform};
use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

/// World coordinates ⇄ those of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFrame {
    /// The frame's origin in the world, m.
    centre: Vec3<f64>,
    /// Units of the frame in a metre: a power of two.
    per_m: f64,
    /// Metres in a unit of the frame.
    unit_m: f64,
}

impl SceneFrame {
    /// The world itself.
    pub const WORLD: Self = Self { centre: Vec3::ZERO, per_m: 1.0, unit_m: 1.0 };

    /// The frame of a scene with these bounds in the world.
    pub fn around(bounds: Aabb) -> Self {
        let middle = bounds.centre();
        let centred = |k: usize| {
            let (low, c, high) = (bounds.min[k], middle[k], bounds.max[k]);
            // The same on both sides of zero.
            let (near, far) = if c < 0.0 { (-high, -low) } else { (low, high) };
            if 0.5 * c.abs() <= near && far <= 2.0 * c.abs() { c } else { 0.0 }
        };
        let centre = Vec3::new(centred(0), centred(1), centred(2));
        let half = (bounds.max - centre).abs().max((bounds.min - centre).abs()).max_component();
        // 2ᵉ ≤ half < 2ᵉ⁺¹; a single point has no size.
        let exponent = if half > 0.0 { ((half.to_bits() >> 52) as i32 - 1023).clamp(-500, 500) } else { 0 };
        let power = |e: i32| f64::from_bits(((1023 + e) as u64) << 52);
        Self { centre, per_m: power(-exponent), unit_m: power(exponent) }
    }

    /// A point of the world in the frame.
    pub fn point(&self, p: Vec3<f64>) -> Vec3<f64> {
        (p - self.centre) * self.per_m
    }

    /// A point of the frame in the world, m.
    pub fn to_world_m(&self, p: Vec3<f64>) -> Vec3<f64> {
        p * self.unit_m + self.centre
    }

    /// Units of the frame in a metre, a power of two: lengths in m are multiplied by it, densities per metre divided.
    pub fn per_m(&self) -> f64 {
        self.per_m
    }

    /// The camera in the frame.
    pub(crate) fn camera(&self, camera: &Camera) -> Camera {
        let projection = match &camera.projection {
            Projection::Perspective { vertical_fov_rad, lens } => Projection::Perspective {
                vertical_fov_rad: *vertical_fov_rad,
                lens: lens.as_ref().map(|lens| ThinLens {
                    radius_m: lens.radius_m * self.per_m,
                    focus_distance_m: lens.focus_distance_m * self.per_m,
                }),
            },
            Projection::Orthographic { height_m } => Projection::Orthographic { height_m: height_m * self.per_m },
            // Its rays are made in metres, and then brought into the frame.
            Projection::CompoundLens(lens) => Projection::CompoundLens(lens.clone()),
        };
        let position_m = self.point(Vec3::from_array(camera.position_m)).to_array();
        Camera { position_m, projection, near_m: camera.near_m * self.per_m, ..camera.clone() }
    }

    /// A shape of the world in the frame.
    pub(crate) fn shape(&self, shape: &Primitive) -> Result<Primitive, ShapeError> {
        let Primitive::Instance(instance) = shape else { return shape.mapped(self) };
        let (geometry, s) = (instance.geometry().clone(), self.per_m);
        if let Some(motion) = instance.motion() {
            return Ok(Instance::moving(geometry, Arc::new(motion.framed(self.centre, s)))?.into());
        }
        let placement = instance.placement();
        let linear = placement.linear().map(|row| (row * s).to_array());
        let placement = Placement::new(linear, self.point(placement.translation()).to_array())?;
        Ok(Instance::new(geometry, placement)?.into())
    }
}

impl ShapeMap for SceneFrame {
    fn point(&self, p: Vec3<f64>) -> Vec3<f64> {
        self.point(p)
    }

    fn vector(&self, v: Vec3<f64>) -> Vec3<f64> {
        v * self.per_m
    }

    fn normal(&self, n: Vec3<f64>) -> Vec3<f64> {
        n
    }

    fn length(&self, length: f64) -> f64 {
        length * self.per_m
    }

    fn mirrors(&self) -> bool {
        false
    }
}

/// The image of a vector under a linear map.
#[inline]
pub(crate) fn mapped(matrix: &DMat3, v: Vec3<f64>) -> Vec3<f64> {
    Vec3::from_array((*matrix * DVec3::from_array(v.to_array())).to_array())
}

/// An affine map of points, vectors and orientations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Affine {
    matrix: DAffine3,
    mirrors: bool,
}

impl Affine {
    pub(crate) const IDENTITY: Self = Self { matrix: DAffine3::IDENTITY, mirrors: false };

    pub(crate) fn new(transform: &Transform) -> Self {
        Self::of_rows(transform.linear, transform.translation_m)
    }

    fn of_rows(linear: [[f64; 3]; 3], translation: [f64; 3]) -> Self {
        let matrix3 = DMat3::from_cols_array_2d(&linear).transpose();
        // Lengths near 1 first, so that the determinant neither overflows nor underflows.
        let largest = matrix3.to_cols_array().into_iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let mirrors = (matrix3 * largest.recip()).determinant() < 0.0;
        Self { matrix: DAffine3::from_mat3_translation(matrix3, translation.into()), mirrors }
    }

    /// This map after the placement `inner`.
    pub(crate) fn after(&self, inner: &Placement) -> Self {
        let inner = Self::of_rows(inner.linear().map(Vec3::to_array), inner.translation().to_array());
        Self { matrix: self.matrix * inner.matrix, mirrors: self.mirrors != inner.mirrors }
    }

    /// Whether it turns left hands into right ones.
    pub(crate) fn mirrors(&self) -> bool {
        self.mirrors
    }

    /// The linear part.
    pub(crate) fn matrix(&self) -> &DMat3 {
        &self.matrix.matrix3
    }

    /// The inverse transpose of the linear part, times its determinant: it gives positive multiples of world normals, or
    /// negative ones if the transform mirrors.
    pub(crate) fn normal_matrix(&self) -> DMat3 {
        let m = &self.matrix.matrix3;
        let columns = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
        let sign = if self.mirrors { -1.0 } else { 1.0 };
        // Scaled so that neither it nor what it maps leaves the numbers of double precision.
        let largest = columns.iter().map(|c| c.abs().max_element()).fold(0.0, f64::max);
        let [x, y, z] = columns.map(|column| sign * column / largest);
        DMat3::from_cols(x, y, z)
    }

    pub(crate) fn point(&self, p: [f64; 3]) -> Vec3<f64> {
        Vec3::from_array(self.matrix.transform_point3(p.into()).into())
    }

    pub(crate) fn vector(&self, v: [f64; 3]) -> Vec3<f64> {
        Vec3::from_array(self.matrix.transform_vector3(v.into()).into())
    }

    /// The factor by which a similarity scales lengths.
    pub(crate) fn uniform_scale(&self) -> f64 {
        self.matrix.matrix3.x_axis.length()
    }

    /// A pair in the order that keeps the surface's outward side outward: a mirroring map swaps it.
    pub(crate) fn oriented<T>(&self, first: T, second: T) -> (T, T) {
        if self.mirrors { (second, first) } else { (first, second) }
    }

    /// The image of a shape; of spheres, disks and cylinders under similarities only.
    pub(crate) fn shape(&self, shape: &Primitive) -> Result<Primitive, ShapeError> {
        shape.mapped(self)
    }
}

impl ShapeMap for Affine {
    fn point(&self, p: Vec3<f64>) -> Vec3<f64> {
        self.point(p.to_array())
    }

    fn vector(&self, v: Vec3<f64>) -> Vec3<f64> {
        self.vector(v.to_array())
    }

    fn normal(&self, n: Vec3<f64>) -> Vec3<f64> {
        self.vector(n.to_array())
    }

    fn length(&self, length: f64) -> f64 {
        length * self.uniform_scale()
    }

    fn mirrors(&self) -> bool {
        self.mirrors
    }
}
