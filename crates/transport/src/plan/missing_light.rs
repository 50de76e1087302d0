//! Light that no path finds: what a lamp without area sends straight to a smooth surface.
//!
//! A path from the camera never meets a point, and never has the one direction of parallel light by chance. Only a shadow ray finds such
//! lamps: from a surface that scatters into every direction, along a straight line that nothing blocks. A mirror or a smooth
//! interface does not scatter into every direction, and blocks the shadow rays of what is behind it. So whatever such a surface
//! reflects, refracts or lets pass of such a lamp is missing: the lamp and the surface are a pair of the plan.
//!
//! A pair is listed unless it is certain that no light of the lamp reaches the surface: outside the cone of a spot. What stands
//! between the two is not asked.

use super::evidence::is_target;
use crate::bsdf::properties;
use crate::frame::Affine;
use etalon_geometry::Aabb;
use etalon_optics::Vec3;
use etalon_scene::{LightCone, MaterialKind, Mesh, Object, Scene, Shape};
use serde::Serialize;
use std::collections::HashMap;
use std::sync::Arc;

/// Pairs that a plan lists; the others are counted.
const MOST_LISTED: usize = 64;
/// Fewest edges of a path from a lamp by a smooth surface and another one to the camera.
const FEWEST_EDGES: u32 = 3;
/// Pairs of spots and surfaces of which it is asked whether the one shines on the other; of more, each counts.
const MOST_ASKED: usize = 1 << 22;

/// Pairs of a lamp without area and a smooth surface, whose light is missing from the picture.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MissingLight {
    /// All pairs, by the order of the lamps, then of the objects.
    pub pairs: u64,
    /// The first of them, 64 at most.
    pub listed: Vec<MissingPair>,
}

/// A lamp without area and a smooth surface.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MissingPair {
    /// Name of the light.
    pub light: String,
    /// Name of the object that has the surface.
    pub object: String,
    /// Name of its material.
    pub material: String,
    /// What is smooth about it, such as "a mirror".
    pub surface: &'static str,
    /// What it does to the light that is missing.
    pub lost: Lost,
}

/// What a smooth surface does to light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lost {
    /// It reflects some.
    Reflected,
    /// It lets some pass, bent or straight.
    Transmitted,
    /// Both.
    ReflectedAndTransmitted,
}

/// What a scene asks for that no path finds.
pub(super) fn of(scene: &Scene) -> MissingLight {
    let mut missing = MissingLight::default();
    // A meter's plate stands for the other surface.
    let fewest = FEWEST_EDGES - u32::from(!scene.receivers.is_empty());
    if scene.integrator.max_depth.is_some_and(|depth| depth < fewest) {
        // No picture of so few edges shows it.
        return missing;
    }
    let lamps: Vec<_> = scene.lights.iter().filter(|light| is_target(&light.kind)).collect();
    if lamps.is_empty() {
        return missing;
    }
    let smooth = smooth_objects(scene);
    let cones = lamps.iter().filter(|lamp| lamp.kind.cone().is_some()).count();
    let asks = cones > 0 && cones.saturating_mul(smooth.len()) <= MOST_ASKED;
    let mut hulls = HashMap::new();
    // What a group holds is anywhere.
    let balls: Vec<Option<Ball>> = match asks {
        true => smooth.iter().map(|one| one.stands.then(|| Ball::around(one.object, &mut hulls))).collect(),
        false => vec![None; smooth.len()],
    };
    for lamp in lamps {
        let cone = lamp.kind.cone();
        let lit = |ball: &Option<Ball>| cone.zip(*ball).is_none_or(|(cone, ball)| may_light(&cone, ball));
        let reached = smooth.iter().zip(&balls).filter(|(_, ball)| lit(ball));
        for (Smooth { object, surface, lost, .. }, _) in reached {
            missing.pairs += 1;
            if missing.listed.len() < MOST_LISTED {
                missing.listed.push(MissingPair {
                    light: lamp.name.clone(),
                    object: object.name.clone(),
                    material: scene.materials[object.material].name.clone(),
                    surface,
                    lost: *lost,
                });
            }
        }
    }
    missing
}

/// An object with a smooth surface.
struct Smooth<'a> {
    object: &'a Object,
    /// Whether it stands in the scene itself, and only there.
    stands: bool,
    surface: &'static str,
    lost: Lost,
}

fn smooth_objects(scene: &Scene) -> Vec<Smooth<'_>> {
    let of_materials: Vec<_> = scene.materials.iter().map(|material| smooth_part(&material.kind)).collect();
    let objects = scene.placed_objects().enumerate().filter(|(_, object)| object.opacity > 0.0);
    objects
        .filter_map(|(index, object)| {
            let (surface, lost) = of_materials[object.material]?;
            Some(Smooth { object, stands: index < scene.objects.len(), surface, lost })
        })
        .collect()
}

/// The part of a material that sends light on in single directions, if it has one; of several the name of the first.
fn smooth_part(kind: &MaterialKind) -> Option<(&'static str, Lost)> {
    let of_parts = kind.parts().into_iter().map(properties);
    let parts: Vec<_> = of_parts.filter(|part| part.has_delta() && !part.dark).collect();
    let lost = match (parts.iter().any(|part| part.delta_reflection), parts.iter().any(|part| part.delta_transmission))
    {
        (true, false) => Lost::Reflected,
        (false, true) => Lost::Transmitted,
        _ => Lost::ReflectedAndTransmitted,
    };
    Some((parts.first()?.smooth_name, lost))
}

/// A ball around an object in the world.
#[derive(Clone, Copy)]
struct Ball {
    centre: Vec3<f64>,
    radius: f64,
}

impl Ball {
    /// `hulls` are those of meshes, each found once.
    fn around(object: &Object, hulls: &mut HashMap<*const Mesh, Hull>) -> Self {
        let found;
        let (points, beyond_m) = match &object.shape {
            Shape::Mesh(mesh) => &*hulls.entry(Arc::as_ptr(mesh)).or_insert_with(|| object.shape.hull_m()),
            other => {
                found = other.hull_m();
                &found
            }
        };
        let placed = Affine::new(&object.transform);
        let points = || points.iter().map(|point| placed.point(*point));
        let centre = Aabb::of_points(points()).centre();
        let reach = points().map(|point| (point - centre).length()).fold(0.0, f64::max);
        // Shapes with a radius are scaled alike in every direction.
        Self { centre, radius: reach + beyond_m * placed.uniform_scale() }
    }
}

/// See [`Shape::hull_m`].
type Hull = (Vec<[f64; 3]>, f64);

/// Whether light within a cone may reach a ball.
fn may_light(cone: &LightCone, ball: Ball) -> bool {
    let toward = ball.centre - Vec3::from_array(cone.position_m);
    let distance = toward.length();
    if distance <= ball.radius {
        return true;
    }
    let off_axis = (toward.dot(Vec3::from_array(cone.axis)) / distance).clamp(-1.0, 1.0).acos();
    // What cannot be computed is not certain; nor is what rounding decides.
    let beyond = off_axis - (ball.radius / distance).asin() - cone.half_angle_rad;
    beyond.is_nan() || beyond < 1e-9
}
