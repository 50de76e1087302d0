//! Objects that light paths begin at: see [`light_tracing`](crate::integrator::light_tracing).

use crate::bsdf::{Bsdf, Properties};
use crate::frame::Affine;
use crate::surface::{ObjectSurface, Surfaces};
use etalon_geometry::{Geometry, PrimitiveId, SurfaceId};
use etalon_optics::Vec3;

/// Primitives of specular objects, each as often as it is placed. Scenes with more have no light paths: a list of them would fill the memory.
const MOST_PRIMITIVES: usize = 1 << 22;

/// Smooth mirrors, metals, glass and panes that throw light on a scene, and how it is followed.
#[derive(Clone, Debug)]
pub(crate) struct SpecularObjects {
    /// Of each object of the scene.
    pub(crate) is_one: Vec<bool>,
    /// Their primitives wherever they are placed, and the area of each with all before it.
    primitives: Vec<SurfaceId>,
    area_until: Vec<f64>,
    /// Whether light of lamps without area is found too. Then specular connections do not look for it.
    pub finds_sources: bool,
    /// Light paths of a sample, for each pixel of the picture.
    pub paths_per_pixel: f64,
}

/// A primitive that is placed somewhere.
struct Placed {
    object: u32,
    surface: SurfaceId,
    /// `None` where it is not known: of balls, disks and cylinders that are stretched.
    area: Option<f64>,
}

impl SpecularObjects {
    /// Those of a scene, or why it has none.
    pub(crate) fn new(surfaces: &Surfaces, geometry: &Geometry) -> Result<Self, &'static str> {
        let smooth = |object: &ObjectSurface| is_smooth(surfaces, object);
        let mut is_one: Vec<bool> = surfaces.objects.iter().map(smooth).collect();
        let mut all = Vec::new();
        let mut known = vec![None; surfaces.object_of.len()];
        if holds_any(&mut known, (surfaces, &is_one), geometry) {
            add_placed(&mut all, (surfaces, &is_one, &known), geometry, 0, &Affine::IDENTITY);
        }
        for placed in all.iter().filter(|placed| placed.area.is_none()) {
            is_one[placed.object as usize] = false;
        }
        if all.len() > MOST_PRIMITIVES {
            return Err(
                "mirrors and glass have more than four million primitives, counted as often as they are placed",
            );
        }
        all.retain(|placed| is_one[placed.object as usize]);
        let mut area = 0.0;
        let area_until = all.iter().filter_map(|placed| placed.area).map(|own| {
            area += own;
            area
        });
        let (area_until, primitives) = (area_until.collect(), all.iter().map(|placed| placed.surface).collect());
        let finds_sources = surfaces.other_properties(&is_one).all(|of| !of.has_delta());
        match area > 0.0 {
            true => Ok(Self { is_one, primitives, area_until, finds_sources, paths_per_pixel: 1.0 }),
            false => Err("there is no smooth mirror, metal or glass that keeps its shape where it is placed"),
        }
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
    pub(crate) fn point(&self, geometry: &Geometry, u: f64, on_shape: [f64; 2]) -> Option<(SurfaceId, Vec3<f64>)> {
        let at = u * self.area();
        let index = self.area_until.partition_point(|&until| until <= at).min(self.primitives.len() - 1);
        let surface = self.primitives[index];
        let local = geometry.primitive_of(surface).sampler()?.point(on_shape);
        Some((surface, geometry.placed_point(surface, local, 0.0)))
    }
}

/// Whether a geometry has a primitive of objects of which `is_one` says so, itself or in what it places. `known` keeps that by the label, so that
/// each geometry is looked at once, however often it is placed.
fn holds_any(known: &mut [Option<bool>], (surfaces, is_one): (&Surfaces, &[bool]), geometry: &Geometry) -> bool {
    let label = geometry.label() as usize;
    if let Some(holds) = known[label] {
        return holds;
    }
    let mut holds = surfaces.object_of[label].iter().any(|&object| is_one.get(object as usize) == Some(&true));
    // Of all that it places, since each is asked for later.
    for (_, instance) in geometry.instances() {
        holds |= holds_any(known, (surfaces, is_one), instance.geometry());
    }
    known[label] = Some(holds);
    holds
}

/// Adds the primitives of objects of which `is_one` says so, of a geometry that is placed by `to_frame` and whose own primitives have the
/// instance number `number`. Ends beyond [`MOST_PRIMITIVES`].
fn add_placed(
    all: &mut Vec<Placed>,
    (surfaces, is_one, holds): (&Surfaces, &[bool], &[Option<bool>]),
    geometry: &Geometry,
    number: u32,
    to_frame: &Affine,
) {
    for (i, &object) in surfaces.object_of[geometry.label() as usize].iter().enumerate() {
        if is_one.get(object as usize) != Some(&true) || all.len() > MOST_PRIMITIVES {
            continue;
        }
        let surface = SurfaceId { instance: number, primitive: PrimitiveId(i as u32) };
        let shape = to_frame.shape(geometry.primitive(surface.primitive)).ok();
        let area = shape.and_then(|shape| shape.sampler()).map(|sampler| sampler.area());
        all.push(Placed { object, surface, area });
    }
    for (inner, instance) in geometry.instances() {
        if all.len() > MOST_PRIMITIVES {
            return;
        }
        if holds[instance.geometry().label() as usize] == Some(true) {
            let to_frame = to_frame.after(instance.placement());
            add_placed(all, (surfaces, is_one, holds), instance.geometry(), number + inner, &to_frame);
        }
    }
}

/// Whether light goes on from an object in one direction or two, and none begins there.
fn is_smooth(surfaces: &Surfaces, object: &ObjectSurface) -> bool {
    let smooth = matches!(
        surfaces.bsdfs[object.material].untinted(),
        Bsdf::Mirror(_) | Bsdf::Conductor(_) | Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_)
    );
    smooth && object.emission.is_none()
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
