//! A lamp without area whose light some mirror or smooth interface hands on.
//!
//! A path from the camera never meets a point, and never has the one direction of parallel light by chance. Only a shadow ray finds such
//! lamps: from a surface that scatters into every direction, along a straight line that nothing blocks. A mirror or a smooth
//! interface does not scatter into every direction, and blocks the shadow rays of what is behind it. So whatever such a surface
//! reflects, refracts or lets pass of such a lamp must be searched for ([`specular`](crate::integrator::specular)).
//!
//! A scene calls for it unless it is certain that no light of any such lamp reaches such a surface: outside the cone of a spot. What stands
//! between the two is not asked.

use super::lights::{is_target, shadow_rays};
use crate::bsdf::properties;
use crate::frame::Affine;
use etalon_geometry::Aabb;
use etalon_optics::Vec3;
use etalon_scene::{LightCone, MaterialKind, Mesh, Object, Scene, Shape};
use std::collections::HashMap;
use std::sync::Arc;

/// Fewest edges of a path from a lamp by a smooth surface and another one to the camera.
const FEWEST_EDGES: u32 = 3;
/// Pairs of spots and surfaces of which it is asked whether the one shines on the other; of more, each counts.
const MOST_ASKED: usize = 1 << 22;

/// The first lamp without area and the first smooth surface that it may shine on; or why there are none.
pub(super) fn specular_connections(scene: &Scene) -> Result<String, String> {
    let none = |why: &str| Err(why.to_owned());
    // A meter's plate stands for the other surface.
    let fewest = FEWEST_EDGES - u32::from(!scene.receivers.is_empty()) - u32::from(!scene.integrator.count_panes);
    if scene.integrator.max_depth.is_some_and(|depth| depth < fewest) {
        return none("no path is long enough for a lamp, a mirror or glass, and another surface");
    }
    if shadow_rays(scene).is_err() {
        return none("no diffuse surface and no medium on which a mirror or glass could throw light");
    }
    let lamps: Vec<_> = scene.lights.iter().filter(|light| is_target(&light.kind)).collect();
    if lamps.is_empty() {
        return none("every lamp has an area");
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
        if let Some((Smooth { object, surface, .. }, _)) = smooth.iter().zip(&balls).find(|(_, ball)| lit(ball)) {
            return Ok(format!("light \"{}\" by way of \"{}\", {surface}", lamp.name, object.name));
        }
    }
    none("no lamp without area shines on a mirror, metal or glass")
}

/// An object with a smooth surface.
struct Smooth<'a> {
    object: &'a Object,
    /// Whether it stands in the scene itself, and only there.
    stands: bool,
    surface: &'static str,
}

fn smooth_objects(scene: &Scene) -> Vec<Smooth<'_>> {
    let of_materials: Vec<_> = scene.materials.iter().map(|material| smooth_part(&material.kind)).collect();
    let objects = scene.placed_objects().enumerate().filter(|(_, object)| object.opacity > 0.0);
    objects
        .filter_map(|(index, object)| {
            let surface = of_materials[object.material]?;
            Some(Smooth { object, stands: index < scene.objects.len(), surface })
        })
        .collect()
}

/// The part of a material that sends light on in single directions, if it has one; of several the name of the first.
fn smooth_part(kind: &MaterialKind) -> Option<&'static str> {
    let parts = kind.parts().into_iter().map(properties);
    parts.into_iter().find(|part| part.has_delta() && !part.dark).map(|part| part.smooth_name)
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
