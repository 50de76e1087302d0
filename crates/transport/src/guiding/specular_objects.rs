//! Objects that light paths begin at: see [`light_tracing`](crate::integrator::light_tracing).

use crate::bsdf::{Bsdf, Properties};
use crate::surface::shading_geometry::Coordinates;
use crate::surface::{ObjectSurface, Surfaces};
use etalon_geometry::{Geometry, PrimitiveId};
use etalon_optics::Vec3;

/// Smooth mirrors, metals, glass and panes that throw light on a scene, and how it is followed.
#[derive(Clone, Debug)]
pub(crate) struct SpecularObjects {
    /// Of each object of the scene.
    pub(crate) is_one: Vec<bool>,
    /// Their shapes, and the area of each with all before it.
    primitives: Vec<PrimitiveId>,
    area_until: Vec<f64>,
    /// Whether light of lamps without area is found too. Then specular connections do not look for it.
    pub finds_sources: bool,
    /// Light paths of a sample, for each pixel of the picture.
    pub paths_per_pixel: f64,
}

impl SpecularObjects {
    /// Those of a scene.
    pub(crate) fn new(surfaces: &Surfaces, geometry: &Geometry) -> Option<Self> {
        let mut is_one = vec![false; surfaces.objects.len()];
        let (mut primitives, mut area_until, mut area) = (Vec::new(), Vec::new(), 0.0);
        // The scene's own: where instances place others, their areas are not known.
        for (number, &object) in surfaces.object_of.first().into_iter().flatten().enumerate() {
            let Some(of_object) = surfaces.objects.get(object as usize) else { continue };
            let primitive = PrimitiveId(number as u32);
            if let (true, Some(shape)) = (is_reciprocal(surfaces, of_object), geometry.primitive(primitive).sampler()) {
                is_one[object as usize] = true;
                area += shape.area();
                primitives.push(primitive);
                area_until.push(area);
            }
        }
        let finds_sources = surfaces.other_properties(&is_one).all(|of| !of.has_delta());
        (area > 0.0).then_some(Self { is_one, primitives, area_until, finds_sources, paths_per_pixel: 1.0 })
    }

    /// Whether an object is one of them.
    #[inline(always)]
    pub(crate) fn contains(&self, object: u32) -> bool {
        self.is_one[object as usize]
    }

    /// The area of all specular objects.
    pub(crate) fn area(&self) -> f64 {
        self.area_until.last().copied().unwrap_or(0.0)
    }

    /// A point of the specular objects for numbers in [0, 1); all are equally likely.
    pub(crate) fn point(&self, geometry: &Geometry, u: f64, on_shape: [f64; 2]) -> Option<(PrimitiveId, Vec3<f64>)> {
        let at = u * self.area();
        let index = self.area_until.partition_point(|&until| until <= at).min(self.primitives.len() - 1);
        let primitive = self.primitives[index];
        Some((primitive, geometry.primitive(primitive).sampler()?.point(on_shape)))
    }
}

/// Whether a walk along the light may go through an object as a walk against it does.
fn is_reciprocal(surfaces: &Surfaces, object: &ObjectSurface) -> bool {
    let smooth = matches!(
        surfaces.bsdfs[object.material].untinted(),
        Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_)
    );
    let bent = matches!(&object.coordinates, Coordinates::Mesh(mesh) if !mesh.mesh.normals.is_empty());
    smooth && !bent && object.relief.is_none() && object.emission.is_none()
}

impl Surfaces {
    /// The properties of the objects that are none of some.
    pub(crate) fn other_properties<'a>(&'a self, is_one: &'a [bool]) -> impl Iterator<Item = &'a Properties> {
        self.objects
            .iter()
            .zip(is_one)
            .filter(|(_, is_one)| !**is_one)
            .map(|(object, _)| &self.properties[object.material])
    }
}
