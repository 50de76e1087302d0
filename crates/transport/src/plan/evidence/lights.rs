//! What lights call for, and the surfaces that they shine on.

use super::{materials::is_diffuse, media, surface};
use etalon_optics::Spectrum;
use etalon_scene::{Light, LightKind, LightSampling, Object, Receiver, Scene};

pub(super) fn is_environment(kind: &LightKind) -> bool {
    !kind.is_delta() && !kind.is_zero()
}

/// Whether only a shadow ray finds the light.
pub(super) fn is_target(kind: &LightKind) -> bool {
    kind.is_delta() && !kind.is_zero()
}

/// A sky that is not the same everywhere, which shadow rays aim at and paths run into.
fn sky(scene: &Scene) -> Option<&Light> {
    scene.lights.iter().find(|light| light.kind.is_uneven_sky() && !light.kind.is_zero())
}

fn emitter(scene: &Scene) -> Option<&Object> {
    scene.placed_objects().find(|object| object.emission.as_ref().is_some_and(|e| !e.is_zero()))
}

/// A diffuse surface, one that does not shine itself if there is any; without one, a medium that scatters, or the plate of a meter.
fn diffuse_surface(scene: &Scene) -> Option<String> {
    let diffuse = |object: &&Object| is_diffuse(&scene.materials[object.material].kind);
    let lit = scene.placed_objects().filter(|object| object.emission.is_none()).find(diffuse);
    let object = lit.or_else(|| scene.placed_objects().find(diffuse));
    let found = object.map(|object| surface(object, &scene.materials[object.material]));
    let plate = || scene.receivers.iter().any(|receiver| matches!(receiver, Receiver::Plane { .. }));
    found.or_else(|| media::scatters_everywhere(scene)).or_else(|| plate().then(|| "the plate of a meter".to_owned()))
}

pub(super) fn shadow_rays(scene: &Scene) -> Result<String, String> {
    let Some(diffuse) = diffuse_surface(scene) else {
        return Err("no diffuse surface and no medium in which a shadow ray could find light".to_owned());
    };
    if let Some(light) = scene.lights.iter().find(|light| is_target(&light.kind)) {
        return Ok(format!("light \"{}\" on {diffuse}", light.name));
    }
    match (lamp(scene), scene.integrator.light_sampling) {
        (None, _) => Err("no lamp that a shadow ray could aim at".to_owned()),
        (Some(_), LightSampling::Bsdf) => Err("integrator.light_sampling is \"bsdf\"".to_owned()),
        (Some(lamp), LightSampling::Mis | LightSampling::Light) => Ok(format!("{lamp} on {diffuse}")),
    }
}

/// Light that both shadow rays and paths may find.
fn lamp(scene: &Scene) -> Option<String> {
    match emitter(scene) {
        Some(object) => Some(format!("emission of \"{}\"", object.name)),
        None => sky(scene).map(|light| format!("light \"{}\"", light.name)),
    }
}

pub(super) fn mis(scene: &Scene) -> Result<String, String> {
    match (scene.integrator.light_sampling, lamp(scene), diffuse_surface(scene)) {
        (LightSampling::Light, ..) => Err("integrator.light_sampling is \"light\"".to_owned()),
        (LightSampling::Bsdf, ..) => Err("integrator.light_sampling is \"bsdf\"".to_owned()),
        (LightSampling::Mis, None, _) => Err("no lamp that a path could hit".to_owned()),
        (LightSampling::Mis, _, None) => {
            Err("no diffuse surface and no medium, where shadow rays and paths compete".to_owned())
        }
        (LightSampling::Mis, Some(lamp), Some(diffuse)) => {
            Ok(format!("{lamp} is found from {diffuse} by shadow rays and by paths"))
        }
    }
}

/// What shines, with its name.
pub(in crate::plan) fn sources(scene: &Scene) -> Vec<(String, &Spectrum)> {
    let emitters = scene
        .placed_objects()
        .filter_map(|object| Some((format!("emission of \"{}\"", object.name), &object.emission.as_ref()?.radiance)));
    let lights = scene.lights.iter().map(|light| (format!("light \"{}\"", light.name), light.kind.spectrum()));
    emitters.chain(lights).chain(media::sources(scene)).filter(|(_, spectrum)| !spectrum.is_zero()).collect()
}
