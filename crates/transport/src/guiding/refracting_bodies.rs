//! Where shadow rays may meet smooth interfaces that refract them.

use crate::bsdf::Bsdf;
use crate::surface::{ObjectSurface, Surfaces};
use etalon_geometry::{Aabb, Geometry, PrimitiveId};
use etalon_optics::Vec3;

/// What a box is larger than its body, of its size: positions of hits are rounded.
const MARGIN: f64 = 1e-6;

/// The bodies and panes of glass of a scene.
#[derive(Clone, Debug)]
pub(crate) struct RefractingBodies {
    /// The box around each.
    boxes: Vec<Aabb>,
    /// Whether some are placed as instances, where no box is known.
    anywhere: bool,
}

impl RefractingBodies {
    /// Those of a scene; `None` if it has none.
    pub(crate) fn new(surfaces: &Surfaces, geometry: &Geometry) -> Option<Self> {
        Self::those(surfaces, geometry, Bsdf::is_smooth_glass)
    }

    /// The panes of a scene alone; `None` if it has none.
    pub(crate) fn panes(surfaces: &Surfaces, geometry: &Geometry) -> Option<Self> {
        Self::those(surfaces, geometry, Bsdf::is_pane)
    }

    fn those(surfaces: &Surfaces, geometry: &Geometry, counts: impl Fn(&Bsdf) -> bool) -> Option<Self> {
        let refracts = |of: &ObjectSurface| counts(&surfaces.bsdfs[of.material]);
        let is_body = |object: u32| surfaces.objects.get(object as usize).is_some_and(refracts);
        let mut bodies: Vec<(u32, Aabb)> = Vec::new();
        for (number, &object) in surfaces.object_of.first().into_iter().flatten().enumerate() {
            if !is_body(object) {
                continue;
            }
            let bounds = geometry.primitive(PrimitiveId(number as u32)).bounds();
            match bodies.last_mut() {
                Some((of, body)) if *of == object => *body = body.union(bounds),
                _ => bodies.push((object, bounds)),
            }
        }
        let anywhere = surfaces.object_of.iter().skip(1).flatten().any(|&object| is_body(object));
        let larger = |(_, body): (u32, Aabb)| {
            let margin = Vec3::splat(MARGIN * (body.extent().length() + body.centre().length()));
            Aabb { min: body.min - margin, max: body.max + margin }
        };
        let boxes: Vec<_> = bodies.into_iter().map(larger).collect();
        (anywhere || !boxes.is_empty()).then_some(Self { boxes, anywhere })
    }

    /// Whether one may be met within a distance.
    pub(crate) fn may_be_met(&self, origin: Vec3<f64>, direction: Vec3<f64>, distance: f64) -> bool {
        self.anywhere || self.boxes.iter().any(|body| crosses(body, origin, direction, distance))
    }
}

/// Whether a ray comes into a box within a distance.
fn crosses(body: &Aabb, origin: Vec3<f64>, direction: Vec3<f64>, distance: f64) -> bool {
    let (mut near, mut far) = (0.0_f64, distance);
    for axis in 0..3 {
        let (from, along) = (origin[axis], direction[axis]);
        let (to_min, to_max) = (body.min[axis] - from, body.max[axis] - from);
        if along == 0.0 {
            if to_min > 0.0 || to_max < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (to_min / along, to_max / along);
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    near <= far
}
