//! Which object of a scene calls for an effect, and by what number.

mod lights;
mod materials;
mod media;
mod motion;
mod polarisation;
mod specular_connections;

pub(super) use lights::sources;
pub(super) use media::parts_lanes as media_part_lanes;
pub(super) use polarisation::{UNPOLARISED, polarisation};

use super::EffectName;
use super::grey::same_shape;
use etalon_optics::reference_nm;
use etalon_scene::{Filter, ImageTexture, Light, Material, MaterialKind, Object, Projection, Scene, Shape};
use lights::{is_environment, mis, shadow_rays};
use materials::{colour, dispersion, fluorescence, interference, nested, specular};
use media::{absorption, coloured, scattering};
use specular_connections::specular_connections;

/// What calls for an effect (`Ok`), or why nothing does (`Err`).
pub(super) fn of(name: EffectName, scene: &Scene) -> Result<String, String> {
    let nothing = |why: &str| Err(why.to_owned());
    match name {
        EffectName::Wavelengths => wavelengths(scene),
        EffectName::Dispersion => match first_surface(scene, |material, range| dispersion(&material.kind, range)) {
            Some(found) => Ok(found),
            None => dispersive_lens(scene).ok_or_else(|| "no index of refraction varies".to_owned()),
        },
        EffectName::Interference => match first_surface(scene, |material, _| interference(&material.kind)) {
            Some(found) => Ok(found),
            None => nothing("no surface has a thin film"),
        },
        EffectName::Fluorescence => match first_surface(scene, |material, range| fluorescence(&material.kind, range)) {
            Some(found) => Ok(found),
            None => nothing("no surface gives light back at another wavelength"),
        },
        EffectName::Lens => lens(&scene.camera.projection, scene.integrator.wavelength_range_nm),
        EffectName::ShadowRays => shadow_rays(scene),
        EffectName::Mis => mis(scene),
        EffectName::Environment => match scene.lights.iter().find(|light| is_environment(&light.kind)) {
            Some(Light { name, kind }) => Ok(match kind.image() {
                Some(sky) => {
                    let (width, height) = (sky.image.width, sky.image.height);
                    format!("light \"{name}\": \"{}\", {width} × {height} texels", sky.name)
                }
                None => format!("light \"{name}\""),
            }),
            None => nothing("no light at infinity"),
        },
        EffectName::SpecularChains => match first_surface(scene, |material, _| specular(&material.kind)) {
            Some(found) => Ok(found),
            None => nothing("no mirror, metal or glass"),
        },
        EffectName::SpecularConnections => specular_connections(scene),
        EffectName::RefractedShadows => refracted_shadow_rays(scene),
        EffectName::NestedDielectrics => match first_surface(scene, |material, _| nested(&material.kind)) {
            Some(found) => Ok(found),
            None => nothing("no solid carries a priority"),
        },
        EffectName::Absorption => absorption(scene).ok_or_else(|| "no medium absorbs".to_owned()),
        EffectName::Scattering => scattering(scene).ok_or_else(|| "no medium scatters".to_owned()),
        EffectName::Polarisation => polarisation(scene, false),
        EffectName::Textures => match first_surface(scene, |material, _| textured(&material.kind)) {
            Some(found) => Ok(found),
            None => match scene.placed_objects().find_map(shining_image) {
                Some((object, image)) => Ok(format!("emission of \"{}\": {}", object.name, size(image))),
                None => nothing("no image on a surface"),
            },
        },
        EffectName::ShadingNormals => match scene.placed_objects().find_map(bent) {
            Some(found) => Ok(found),
            None => nothing("no mesh has normals, and no image changes normals"),
        },
        EffectName::Masks => match scene.placed_objects().find_map(mask) {
            Some(found) => Ok(found),
            None => nothing("every surface is opaque"),
        },
        EffectName::Instances => match scene.instances.first() {
            Some(first) => {
                let (name, count) = (&scene.groups[first.group].name, scene.instances.len());
                Ok(format!("group \"{name}\" by \"{}\", the first of {count} in the scene", first.name))
            }
            None => nothing("every object stands where it is defined"),
        },
        EffectName::Motion => motion::motion(scene),
        EffectName::WideFilter => match scene.film.filter {
            Filter::Box => nothing("each pixel is a square (box filter)"),
            Filter::Tent { radius_px } => Ok(format!("film: tent of radius {radius_px} px")),
            Filter::Gaussian { sigma_px } => Ok(format!("film: Gaussian of σ {sigma_px} px")),
            Filter::Mitchell { radius_px, .. } => Ok(format!("film: Mitchell's filter of radius {radius_px} px")),
            Filter::Lanczos { lobes } => Ok(format!("film: Lanczos's filter of radius {lobes} px")),
        },
        EffectName::Bands => match &scene.film.bands {
            None => nothing("the film keeps only the colour"),
            Some(bands) => {
                let [first, last] = [bands.edge_nm(0), bands.edge_nm(bands.count)];
                Ok(format!("film: {} bands of {} nm over {first}–{last} nm", bands.count, bands.step_nm))
            }
        },
    }
}

/// Glass through which a shadow ray may find what the walk finds too.
fn refracted_shadow_rays(scene: &Scene) -> Result<String, String> {
    if mis(scene).is_err() {
        return Err("no light is found both by shadow rays and by paths".to_owned());
    }
    if scene.integrator.path_reuse.block_px().is_some() {
        return Err("pixels share paths".to_owned());
    }
    let smooth = |object: &&Object| {
        object.opacity == 1.0
            && matches!(
                scene.materials[object.material].kind.untinted(),
                MaterialKind::Dielectric { .. } | MaterialKind::ThinDielectric { .. }
            )
    };
    match scene.placed_objects().find(smooth) {
        Some(object) => {
            let material = &scene.materials[object.material];
            Ok(format!("material \"{}\" of \"{}\": shadow rays go through", material.name, object.name))
        }
        None => Err("no smooth glass of opacity 1".to_owned()),
    }
}

/// Whether a thin film sends wavelengths different ways, each with a probability of its own.
pub(super) fn films_part_lanes(scene: &Scene) -> bool {
    scene.placed_objects().any(|object| materials::parts_lanes(&scene.materials[object.material].kind))
}

/// The first object whose material has something to say, which it says. Materials that no object is made of are silent.
pub(super) fn first_surface(scene: &Scene, says: impl Fn(&Material, [f64; 2]) -> Option<String>) -> Option<String> {
    scene.placed_objects().find_map(|object| {
        let material = &scene.materials[object.material];
        says(material, scene.integrator.wavelength_range_nm)
            .map(|what| format!("{}: {what}", surface(object, material)))
    })
}

fn surface(object: &Object, material: &Material) -> String {
    format!("material \"{}\" of \"{}\"", material.name, object.name)
}

/// What lets a part of the light pass an object, if something does.
fn mask(object: &Object) -> Option<String> {
    match &object.opacity_image {
        Some(image) => Some(format!("\"{}\": opacity {}", object.name, size(&image.texture))),
        None => (object.opacity < 1.0).then(|| format!("\"{}\": opacity {}", object.name, object.opacity)),
    }
}

/// What varies a material over a surface, if something does.
fn textured(kind: &MaterialKind) -> Option<String> {
    let vertices = || kind.vertex_colours().next().map(|_| "the colours of vertices".to_owned());
    kind.image().map(size).or_else(vertices)
}

fn size(texture: &ImageTexture) -> String {
    format!("\"{}\", {} × {} texels", texture.name, texture.image.width, texture.image.height)
}

/// An object and the image of what it emits, if there is one.
fn shining_image(object: &Object) -> Option<(&Object, &ImageTexture)> {
    Some((object, object.emission.as_ref()?.image.as_ref()?))
}

/// What bends the normals of an object, if something does.
fn bent(object: &Object) -> Option<String> {
    match &object.relief {
        Some(relief) => Some(format!("\"{}\": {}", object.name, size(relief.texture()))),
        None => smooth_mesh(object),
    }
}

fn smooth_mesh(object: &Object) -> Option<String> {
    let Shape::Mesh(mesh) = &object.shape else { return None };
    let normals = mesh.normals.len();
    (normals > 0).then(|| format!("\"{}\": {normals} vertices with normals", object.name))
}

/// The glass by which the camera's lens parts wavelengths, if it does.
fn dispersive_lens(scene: &Scene) -> Option<String> {
    let Projection::CompoundLens(lens) = &scene.camera.projection else { return None };
    let range_nm = scene.integrator.wavelength_range_nm;
    lens.dispersive_medium().map(|medium| format!("the camera's lens: {}", materials::index_range(medium, range_nm)))
}

fn lens(projection: &Projection, range_nm: [f64; 2]) -> Result<String, String> {
    match projection {
        Projection::CompoundLens(lens) => Ok(format!(
            "camera: {} surfaces, focal length {:.5} m, film {:.5} m behind the last",
            lens.surfaces.len(),
            lens.focal_length_m(reference_nm(range_nm)),
            lens.film_distance_m
        )),
        Projection::Perspective { lens: Some(lens), .. } if lens.radius_m > 0.0 => {
            Ok(format!("camera: aperture of radius {:.4} m, in focus at {:.4} m", lens.radius_m, lens.focus_distance_m))
        }
        Projection::Perspective { .. } => Err("the camera is a pinhole".to_owned()),
        Projection::Orthographic { .. } => Err("the camera is orthographic".to_owned()),
    }
}

/// Whether one number cannot stand for all wavelengths.
fn wavelengths(scene: &Scene) -> Result<String, String> {
    if let Some(found) = first_surface(scene, |material, range| colour(&material.kind, range)) {
        return Ok(found);
    }
    if let Some(found) = coloured(scene).or_else(|| dispersive_lens(scene)) {
        return Ok(found);
    }
    if let Some(Light { name, kind }) = scene.lights.iter().find(|light| light.kind.has_colours()) {
        return Ok(match (kind.image(), kind.slide()) {
            (Some(sky), _) => format!("light \"{name}\": colours of \"{}\"", sky.name),
            (None, Some(slide)) => format!("light \"{name}\": colours of \"{}\"", slide.image.name),
            (None, None) => format!("light \"{name}\": colours of daylight"),
        });
    }
    let coloured = |(_, image): &(&Object, &ImageTexture)| !image.is_grey();
    if let Some((object, image)) = scene.placed_objects().filter_map(shining_image).find(coloured) {
        return Ok(format!("emission of \"{}\": colours of \"{}\"", object.name, image.name));
    }
    let range_nm = scene.integrator.wavelength_range_nm;
    let lamps = sources(scene);
    let Some((first, shape)) = lamps.first() else {
        return Err("nothing emits light".to_owned());
    };
    match lamps.iter().find(|(_, other)| !same_shape(shape, other, range_nm)) {
        Some((second, _)) => Ok(format!("{first} and {second} differ in spectrum")),
        None => Err(format!("every surface is grey, and all light has the spectrum of {first}")),
    }
}
