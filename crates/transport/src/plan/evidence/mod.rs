//! Which object of a scene calls for an effect, and by what number.

use super::EffectName;
use super::grey::{same_shape, steps};
use crate::texture;
use etalon_optics::{ComplexIndex, RefractiveIndex, Spectrum, fresnel};
use etalon_scene::{
    Filter, ImageTexture, Light, LightKind, LightSampling, Material, MaterialKind, Metal, Object, PolarisingSheet,
    Projection, Scene, Shape, SpectrumTexture,
};

/// What calls for an effect (`Ok`), or why nothing does (`Err`).
pub(super) fn of(name: EffectName, scene: &Scene) -> Result<String, String> {
    let nothing = |why: &str| Err(why.to_owned());
    match name {
        EffectName::Wavelengths => wavelengths(scene),
        EffectName::Dispersion => match first_surface(scene, |material, range| dispersion(&material.kind, range)) {
            Some(found) => Ok(found),
            None => nothing("no index of refraction varies"),
        },
        EffectName::Lens => lens(&scene.camera.projection),
        EffectName::ShadowRays => shadow_rays(scene),
        EffectName::Mis => mis(scene),
        EffectName::Environment => match scene.lights.iter().find(|light| is_environment(&light.kind)) {
            Some(Light { name, kind: LightKind::ImageEnvironment(sky) }) => {
                let (width, height) = (sky.image.width, sky.image.height);
                Ok(format!("light \"{name}\": \"{}\", {width} × {height} texels", sky.name))
            }
            Some(light) => Ok(format!("light \"{}\"", light.name)),
            None => nothing("no light at infinity"),
        },
        EffectName::SpecularChains => match first_surface(scene, |material, _| specular(&material.kind)) {
            Some(found) => Ok(found),
            None => nothing("no mirror, metal or glass"),
        },
        EffectName::NestedDielectrics => match first_surface(scene, |material, _| nested(&material.kind)) {
            Some(found) => Ok(found),
            None => nothing("no dielectric carries a priority"),
        },
        EffectName::Absorption => match first_surface(scene, absorption) {
            Some(found) => Ok(found),
            None => nothing("no medium absorbs"),
        },
        EffectName::Polarisation => polarisation(scene, false),
        EffectName::Textures => match first_surface(scene, |material, _| material.kind.image().map(size)) {
            Some(found) => Ok(found),
            None => nothing("no image on a surface"),
        },
        EffectName::ShadingNormals => match scene.placed_objects().find_map(bent) {
            Some(found) => Ok(found),
            None => nothing("no mesh has normals of its own, and no image bends any"),
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
        EffectName::WideFilter => match scene.film.filter {
            Filter::Box => nothing("a pixel is its own square"),
            Filter::Tent { radius_px } => Ok(format!("film: tent of radius {radius_px} px")),
            Filter::Gaussian { sigma_px } => Ok(format!("film: Gaussian of σ {sigma_px} px")),
        },
        EffectName::Bands => match &scene.film.bands {
            None => nothing("the film keeps the colour only"),
            Some(bands) => {
                let [first, last] = [bands.edge_nm(0), bands.edge_nm(bands.count)];
                Ok(format!("film: {} bands of {} nm over {first}–{last} nm", bands.count, bands.step_nm))
            }
        },
    }
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

fn dispersion(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<String> {
    match kind {
        MaterialKind::Dielectric { interior, exterior, .. }
        | MaterialKind::RoughDielectric { interior, exterior, .. } => [interior, exterior]
            .into_iter()
            .find(|index| index.is_dispersive())
            .map(|index| index_range(index, range_nm)),
        MaterialKind::Lambert { .. }
        | MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::RoughConductor { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Plastic { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::PolarisingSheet { .. }
        | MaterialKind::Black => None,
        MaterialKind::Blend { parts, .. } => parts.iter().find_map(|(_, part)| dispersion(part, range_nm)),
    }
}

/// How the light that a material hands on depends on the wavelength, if it does.
fn colour(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<String> {
    match kind {
        MaterialKind::Lambert { reflectance }
        | MaterialKind::Mirror { reflectance }
        | MaterialKind::OrenNayar { reflectance, .. }
        | MaterialKind::Conductor { metal: Metal::Reflectance(reflectance) }
        | MaterialKind::RoughConductor { metal: Metal::Reflectance(reflectance), .. } => {
            colour_of_texture(reflectance, range_nm)
        }
        MaterialKind::Conductor { metal: Metal::Index(index) }
        | MaterialKind::RoughConductor { metal: Metal::Index(index), .. } => {
            index.is_dispersive().then(|| metal_range(index, range_nm))
        }
        MaterialKind::Dielectric { .. } | MaterialKind::RoughDielectric { .. } => dispersion(kind, range_nm),
        MaterialKind::Plastic { reflectance, coat, .. } => colour_of_texture(reflectance, range_nm)
            .or_else(|| coat.is_dispersive().then(|| index_range(coat, range_nm))),
        MaterialKind::ThinDielectric { index } => index.is_dispersive().then(|| index_range(index, range_nm)),
        MaterialKind::PolarisingSheet { sheet, .. } => match sheet {
            PolarisingSheet::Polariser { transmittance, .. } => (!transmittance.is_constant())
                .then(|| format!("transmittance {}", spread(range_nm, |nm| transmittance.eval(nm)))),
            PolarisingSheet::Retarder { retardance_rad, at_nm } => at_nm.map(|at_nm| {
                format!("retardance in degrees {}", spread(range_nm, |nm| retardance_rad.to_degrees() * at_nm / nm))
            }),
        },
        MaterialKind::Blend { parts, .. } => parts.iter().find_map(|(_, part)| colour(part, range_nm)),
        MaterialKind::Black => None,
    }
}

/// How a reflectance depends on the wavelength, if it does.
fn colour_of_texture(reflectance: &SpectrumTexture, range_nm: [f64; 2]) -> Option<String> {
    (!reflectance.is_grey()).then(|| match reflectance {
        SpectrumTexture::Uniform(spectrum) => format!("reflectance {}", spread(range_nm, |nm| spectrum.eval(nm))),
        SpectrumTexture::Image(texture) => format!("colours of \"{}\"", texture.name),
    })
}

/// What lets a part of the light pass an object, if something does.
fn mask(object: &Object) -> Option<String> {
    match &object.opacity_image {
        Some(image) => Some(format!("\"{}\": opacity {}", object.name, size(&image.texture))),
        None => (object.opacity < 1.0).then(|| format!("\"{}\": opacity {}", object.name, object.opacity)),
    }
}

fn size(texture: &ImageTexture) -> String {
    format!("\"{}\", {} × {} texels", texture.name, texture.image.width, texture.image.height)
}

/// What bends the normals of an object, if something does.
fn bent(object: &Object) -> Option<String> {
    match &object.relief {
        Some(relief) => Some(format!("\"{}\": {}", object.name, size(relief.texture()))),
        None => smooth_mesh(object),
    }
}

fn smooth_mesh(object: &Object) -> Option<String> {
    match &object.shape {
        Shape::Mesh(mesh) if !mesh.normals.is_empty() => {
            Some(format!("\"{}\": {} vertices with normals", object.name, mesh.normals.len()))
        }
        Shape::Mesh(_)
        | Shape::Sphere { .. }
        | Shape::Parallelogram { .. }
        | Shape::Disk { .. }
        | Shape::Cylinder { .. } => None,
    }
}

fn specular(kind: &MaterialKind) -> Option<String> {
    match kind {
        MaterialKind::Mirror { .. } => Some("a mirror".to_owned()),
        MaterialKind::Conductor { .. } => Some("smooth metal".to_owned()),
        MaterialKind::Dielectric { .. } => Some("a smooth interface of two media".to_owned()),
        MaterialKind::ThinDielectric { .. } => Some("a thin pane".to_owned()),
        MaterialKind::PolarisingSheet { sheet, .. } => Some(sheet_name(sheet).to_owned()),
        MaterialKind::Blend { parts, .. } => parts.iter().find_map(|(_, part)| specular(part)),
        MaterialKind::Lambert { .. }
        | MaterialKind::RoughConductor { .. }
        | MaterialKind::RoughDielectric { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Plastic { .. }
        | MaterialKind::Black => None,
    }
}

/// What the medium within a surface absorbs, if it does.
fn absorption(material: &Material, range_nm: [f64; 2]) -> Option<String> {
    let absorption = material.absorption.as_ref().filter(|absorption| !absorption.is_zero())?;
    Some(format!("σ {}", spread(range_nm, |nm| absorption.eval(nm)).replace(" over", " m⁻¹ over")))
}

fn nested(kind: &MaterialKind) -> Option<String> {
    match kind {
        MaterialKind::Dielectric { priority, .. } | MaterialKind::RoughDielectric { priority, .. } => {
            priority.map(|priority| format!("priority {priority}"))
        }
        // The reader refuses priorities in the parts of a blend.
        MaterialKind::RoughConductor { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Plastic { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::PolarisingSheet { .. }
        | MaterialKind::Blend { .. }
        | MaterialKind::Lambert { .. }
        | MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::Black => None,
    }
}

/// Why polarisation is not carried where it could make no difference.
pub(super) const UNPOLARISED: &str = "no surface polarises light";

/// Whether polarisation is carried. Where it is not but could matter, how much it could.
pub(super) fn polarisation(scene: &Scene, asked_for: bool) -> Result<String, String> {
    if asked_for {
        return Ok("asked for by --polarised".to_owned());
    }
    let sheet = first_surface(scene, |material, _| match &material.kind {
        MaterialKind::PolarisingSheet { sheet, .. } => Some(sheet_name(sheet).to_owned()),
        _ => None,
    });
    if let Some(found) = sheet {
        return Ok(found);
    }
    if scene.film.stokes {
        return Ok("film: stokes".to_owned());
    }
    let worst = scene
        .placed_objects()
        .filter_map(|object| {
            let material = &scene.materials[object.material];
            let range_nm = scene.integrator.wavelength_range_nm;
            let (share, how) = polarises(&material.kind, range_nm)?;
            Some((share, format!("{}: {how}", surface(object, material))))
        })
        // The first of the worst.
        .reduce(|worst, other| if other.0 > worst.0 { other } else { worst });
    match worst {
        None => Err(UNPOLARISED.to_owned()),
        Some((_, found)) => Err(format!("not asked for (--polarised); the picture averages s and p at {found}")),
    }
}

fn sheet_name(sheet: &PolarisingSheet) -> &'static str {
    match sheet {
        PolarisingSheet::Polariser { .. } => "a polariser",
        PolarisingSheet::Retarder { .. } => "a retarder",
    }
}

/// By which share averaging s and p at a surface can be off after two of them, and that in words: two surfaces of diattenuation
/// a = (A_s − A_p)/(A_s + A_p) each hand on 1 + a² of what the averages do where their planes of incidence are parallel, and 1 − a²
/// where they are crossed.
fn polarises(kind: &MaterialKind, range_nm: [f64; 2]) -> Option<(f64, String)> {
    match kind {
        MaterialKind::Dielectric { interior, exterior, .. }
        | MaterialKind::RoughDielectric { interior, exterior, .. } => {
            let [interior, exterior] = [interior, exterior].map(|index| index.eval(middle(range_nm)));
            glass(interior / exterior)
        }
        MaterialKind::Plastic { coat, .. } => glass(coat.eval(middle(range_nm))),
        MaterialKind::ThinDielectric { index } => glass(index.eval(middle(range_nm))),
        MaterialKind::Conductor { metal: Metal::Reflectance(reflectance) }
        | MaterialKind::RoughConductor { metal: Metal::Reflectance(reflectance), .. } => {
            glass(Metal::index_of(texture::mean(reflectance, middle(range_nm))))
        }
        MaterialKind::Conductor { metal: Metal::Index(index) }
        | MaterialKind::RoughConductor { metal: Metal::Index(index), .. } => {
            let diattenuation = |nm: f64, cos: f64| {
                let (n, k) = index.eval(nm);
                let f = fresnel::conductor(cos, n, k);
                ((f.reflectance_s - f.reflectance_p) / (f.reflectance_s + f.reflectance_p)).abs()
            };
            let everywhere = steps(range_nm).flat_map(|nm| (1..100).map(move |i| (nm, f64::from(i) / 100.0)));
            let (most, nm, cos) = everywhere
                .map(|(nm, cos)| (diattenuation(nm, cos), nm, cos))
                .fold((0.0, 0.0, 1.0), |most, other| if other.0 > most.0 { other } else { most });
            let (share, degrees) = (most * most, cos.acos().to_degrees());
            Some((share, format!("up to {:.2} % after two reflections, at {degrees:.0}° and {nm} nm", 100.0 * share)))
        }
        MaterialKind::Blend { parts, .. } => {
            let worst = parts.iter().filter_map(|(_, part)| polarises(part, range_nm));
            worst.reduce(|worst, other| if other.0 > worst.0 { other } else { worst })
        }
        // A mirror treats s and p alike; sheets call for polarisation themselves.
        MaterialKind::Lambert { .. }
        | MaterialKind::Mirror { .. }
        | MaterialKind::PolarisingSheet { .. }
        | MaterialKind::OrenNayar { .. }
        | MaterialKind::Black => None,
    }
}

/// [`polarises`] of an interface of relative index `n`: reflection at Brewster's angle leaves s alone; and what a plate passes on
/// at 75°, followed for s and p each, against the averages at each face.
fn glass(n: f64) -> Option<(f64, String)> {
    if n == 1.0 {
        return None;
    }
    let brewster = n.atan().to_degrees();
    let plate = |reflectance: f64| (1.0 - reflectance) / (1.0 + reflectance);
    let behind = fresnel::dielectric(75_f64.to_radians().cos(), n).map(|f| {
        let polarised = 0.5 * (plate(f.r_s * f.r_s) + plate(f.r_p * f.r_p));
        format!(", {:.1} % behind a plate at 75°", 100.0 * (polarised / plate(f.reflectance) - 1.0))
    });
    let behind = behind.unwrap_or_default();
    Some((1.0, format!("up to a factor of 2 after two reflections at {brewster:.1}°{behind} (n {n:.3})")))
}

/// The helium line d, at which catalogues state indices, or the wavelength of the range nearest to it.
pub(super) fn middle([first, last]: [f64; 2]) -> f64 {
    587.5618_f64.clamp(first, last)
}

/// Whether a shadow ray from the surface could find light.
fn is_diffuse(kind: &MaterialKind) -> bool {
    match kind {
        MaterialKind::Lambert { reflectance } => !reflectance.is_zero(),
        MaterialKind::OrenNayar { reflectance, .. } => !reflectance.is_zero(),
        MaterialKind::RoughConductor { .. } | MaterialKind::RoughDielectric { .. } | MaterialKind::Plastic { .. } => {
            true
        }
        MaterialKind::Blend { parts, .. } => parts.iter().any(|(_, part)| is_diffuse(part)),
        MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::Dielectric { .. }
        | MaterialKind::ThinDielectric { .. }
        | MaterialKind::PolarisingSheet { .. }
        | MaterialKind::Black => false,
    }
}

fn is_environment(kind: &LightKind) -> bool {
    match kind {
        LightKind::Environment { radiance } => !radiance.is_zero(),
        LightKind::ImageEnvironment(image) => !image.is_zero(),
        LightKind::Point { .. } | LightKind::Spot { .. } | LightKind::Directional { .. } => false,
    }
}

/// Whether only a shadow ray finds the light.
fn is_target(kind: &LightKind) -> bool {
    match kind {
        LightKind::Point { intensity: spectrum, .. }
        | LightKind::Spot { intensity: spectrum, .. }
        | LightKind::Directional { irradiance: spectrum, .. } => !spectrum.is_zero(),
        LightKind::Environment { .. } | LightKind::ImageEnvironment(_) => false,
    }
}

/// An image of everything around, which shadow rays aim at and paths run into.
fn sky(scene: &Scene) -> Option<&Light> {
    scene.lights.iter().find(|light| matches!(&light.kind, LightKind::ImageEnvironment(image) if !image.is_zero()))
}

/// The spectrum of a light.
pub(super) fn spectrum(light: &Light) -> &Spectrum {
    match &light.kind {
        LightKind::Point { intensity, .. } | LightKind::Spot { intensity, .. } => intensity,
        LightKind::Directional { irradiance, .. } => irradiance,
        LightKind::Environment { radiance } => radiance,
        LightKind::ImageEnvironment(image) => &image.white,
    }
}

fn lens(projection: &Projection) -> Result<String, String> {
    match projection {
        Projection::Perspective { lens: Some(lens), .. } if lens.radius_m > 0.0 => {
            Ok(format!("camera: aperture of radius {:.4} m, in focus at {:.4} m", lens.radius_m, lens.focus_distance_m))
        }
        Projection::Perspective { .. } => Err("the camera is a pinhole".to_owned()),
        Projection::Orthographic { .. } => Err("the camera is orthographic".to_owned()),
    }
}

fn emitter(scene: &Scene) -> Option<&Object> {
    scene.placed_objects().find(|object| object.emission.as_ref().is_some_and(|e| !e.radiance.is_zero()))
}

/// A diffuse surface, one that does not shine itself if there is any.
fn diffuse_surface(scene: &Scene) -> Option<String> {
    let diffuse = |object: &&Object| is_diffuse(&scene.materials[object.material].kind);
    let lit = scene.placed_objects().filter(|object| object.emission.is_none()).find(diffuse);
    let object = lit.or_else(|| scene.placed_objects().find(diffuse))?;
    Some(surface(object, &scene.materials[object.material]))
}

fn shadow_rays(scene: &Scene) -> Result<String, String> {
    let Some(diffuse) = diffuse_surface(scene) else {
        return Err("no diffuse surface on which a shadow ray could find light".to_owned());
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

fn mis(scene: &Scene) -> Result<String, String> {
    match (scene.integrator.light_sampling, lamp(scene), diffuse_surface(scene)) {
        (LightSampling::Light, ..) => Err("integrator.light_sampling is \"light\"".to_owned()),
        (LightSampling::Bsdf, ..) => Err("integrator.light_sampling is \"bsdf\"".to_owned()),
        (LightSampling::Mis, None, _) => Err("no lamp that paths could run into".to_owned()),
        (LightSampling::Mis, _, None) => Err("no diffuse surface, where shadow rays and paths compete".to_owned()),
        (LightSampling::Mis, Some(lamp), Some(diffuse)) => {
            Ok(format!("{lamp} is found from {diffuse} by shadow rays and by paths"))
        }
    }
}

/// Whether one number cannot stand for all wavelengths.
fn wavelengths(scene: &Scene) -> Result<String, String> {
    if let Some(found) = first_surface(scene, |material, range| colour(&material.kind, range)) {
        return Ok(found);
    }
    let coloured = |material: &Material| material.absorption.as_ref().is_some_and(|a| !a.is_constant());
    if let Some(found) =
        first_surface(scene, |material, range| coloured(material).then(|| absorption(material, range)).flatten())
    {
        return Ok(found);
    }
    for light in &scene.lights {
        if let LightKind::ImageEnvironment(sky) = &light.kind
            && !sky.image.is_grey()
        {
            return Ok(format!("light \"{}\": colours of \"{}\"", light.name, sky.name));
        }
    }
    let range_nm = scene.integrator.wavelength_range_nm;
    let lamps = sources(scene);
    let Some((first, shape)) = lamps.first() else {
        return Err("nothing shines".to_owned());
    };
    match lamps.iter().find(|(_, other)| !same_shape(shape, other, range_nm)) {
        Some((second, _)) => Ok(format!("{first} and {second} differ in spectrum")),
        None => Err(format!("every surface is grey, and all light has the spectrum of {first}")),
    }
}

/// What shines, with its name.
pub(super) fn sources(scene: &Scene) -> Vec<(String, &Spectrum)> {
    let emitters = scene
        .placed_objects()
        .filter_map(|object| Some((format!("emission of \"{}\"", object.name), &object.emission.as_ref()?.radiance)));
    let lights = scene.lights.iter().map(|light| (format!("light \"{}\"", light.name), spectrum(light)));
    emitters.chain(lights).filter(|(_, spectrum)| !spectrum.is_zero()).collect()
}

fn index_range(index: &RefractiveIndex, range_nm: [f64; 2]) -> String {
    format!("n {}", spread(range_nm, |nm| index.eval(nm)))
}

fn metal_range(index: &ComplexIndex, range_nm: [f64; 2]) -> String {
    let n = extremes(range_nm, |nm| index.eval(nm).0);
    let k = extremes(range_nm, |nm| index.eval(nm).1);
    let [n, k] = [n, k].map(|[low, high]| format!("{low:.3}–{high:.3}"));
    format!("n {n} and k {k} over {}–{} nm", range_nm[0], range_nm[1])
}

/// `1.61–1.66 over 380–780 nm`.
fn spread(range_nm: [f64; 2], value: impl Fn(f64) -> f64) -> String {
    let [low, high] = extremes(range_nm, value);
    format!("{low:.3}–{high:.3} over {}–{} nm", range_nm[0], range_nm[1])
}

/// The least and the largest value at whole nanometres and at the ends.
fn extremes(range_nm: [f64; 2], value: impl Fn(f64) -> f64) -> [f64; 2] {
    steps(range_nm).map(value).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}
