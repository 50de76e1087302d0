//! Where paths of meters begin.
//!
//! A plane receiver is the white side of a plate that no ray meets: the first vertex of each of its paths. With f = 1/π it shows the radiance
//! ∫ L cos θ dω / π = E/π, E the irradiance. So a meter needs no estimator of its own: shadow rays, weights of multiple importance sampling and
//! guided directions are those of any white surface.

use crate::bsdf::{Bsdf, properties};
use crate::frame::SceneFrame;
use crate::surface::shading_geometry::Coordinates;
use crate::surface::{ObjectSurface, Surfaces};
use crate::warp::uniform_cone;
use etalon_geometry::{Ray, SurfaceId, SurfacePoint};
use etalon_optics::{Frame, Spectrum, Vec3};
use etalon_scene::{MaterialKind, Receiver, SpectrumTexture};

/// A place where paths begin, in the frame.
#[derive(Clone, Debug)]
pub(crate) enum PreparedReceiver {
    /// A piece of a plane.
    Plane {
        origin: Vec3<f64>,
        edges: [Vec3<f64>; 2],
        normal: Vec3<f64>,
        /// Bound on how far a surface that the scene states in the same plane may be from it.
        error: f64,
    },
    /// A point that sees a cone of directions.
    Cone { position: Vec3<f64>, axis: Frame<f64>, one_minus_cos: f64 },
}

/// How a path leaves a receiver.
pub(crate) enum Departure {
    /// From a point of a white plate.
    Plane(SurfacePoint<f64>),
    /// Along a ray from a point in space.
    Free(Ray<f64>),
}

impl Departure {
    /// A ray that begins where the path does: from a plate along its normal.
    pub(crate) fn first_ray(&self) -> Ray<f64> {
        match self {
            Self::Plane(point) => point.spawn(point.normal),
            Self::Free(ray) => *ray,
        }
    }
}

/// Roundings of coordinates between a plate and a surface that is meant to lie in its plane: some of the numbers that the scene states, of
/// transforms, and of the frame.
const ROUNDINGS: f64 = 64.0;

impl PreparedReceiver {
    pub(crate) fn new(receiver: &Receiver, frame: &SceneFrame) -> Self {
        match receiver {
            Receiver::Plane { origin_m, edges_m, normal } => {
                let origin_m = Vec3::from_array(*origin_m);
                let edges_m = edges_m.map(Vec3::from_array);
                let reach = origin_m.abs() + edges_m[0].abs() + edges_m[1].abs();
                let largest = reach.max_component() * frame.per_m();
                Self::Plane {
                    origin: frame.point(origin_m),
                    edges: edges_m.map(|edge| edge * frame.per_m()),
                    normal: Vec3::from_array(*normal),
                    error: ROUNDINGS * f64::EPSILON * (1.0 + largest),
                }
            }
            Receiver::Cone { position_m, axis, one_minus_cos } => Self::Cone {
                position: frame.point(Vec3::from_array(*position_m)),
                axis: Frame::from_normal(Vec3::from_array(*axis)),
                one_minus_cos: *one_minus_cos,
            },
        }
    }

    /// Where a path begins that draws these numbers, at a time of the shutter's.
    pub(crate) fn depart(&self, [u1, u2, ..]: [f64; 4], time: f64) -> Departure {
        match self {
            Self::Plane { origin, edges: [u, v], normal, error } => Departure::Plane(SurfacePoint {
                position: *origin + *u * u1 + *v * u2,
                position_error: *error,
                normal: *normal,
                surface: SurfaceId::OUTSIDE,
                label: 0,
                time,
            }),
            Self::Cone { position, axis, one_minus_cos } => {
                let direction = axis.to_world(uniform_cone([u1, u2], *one_minus_cos)).renormalized();
                Departure::Free(Ray { time, ..Ray::free(*position, direction) })
            }
        }
    }
}

/// Adds the object whose surface the plates of meters are: white in all wavelengths, and nowhere in the geometry.
pub(crate) fn add_white(surfaces: &mut Surfaces, range_nm: [f64; 2]) {
    let white = MaterialKind::Lambert { reflectance: SpectrumTexture::Uniform(Spectrum::ONE) };
    surfaces.objects.push(ObjectSurface {
        material: surfaces.bsdfs.len(),
        emission: None,
        opacity: 1.0,
        opacity_image: None,
        relief: None,
        coordinates: Coordinates::None,
        axis: None,
    });
    surfaces.bsdfs.push(Bsdf::new(&white, range_nm));
    surfaces.properties.push(properties(&white));
    surfaces.stated_media.push(None);
}
