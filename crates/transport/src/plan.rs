//! What a scene calls for, and what will therefore be simulated.

use etalon_scene::{Filter, LightKind, LightSampling, MaterialKind, Precision, Projection, SamplerKind, Scene, Shape};
use serde::Serialize;

/// What will be simulated, why, and with what.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// The kernel, by name.
    pub kernel: &'static str,
    /// Scalar type.
    pub precision: &'static str,
    /// Wavelengths a path carries.
    pub lanes: usize,
    /// Range of the wavelengths, nm.
    pub wavelength_range_nm: [f64; 2],
    /// Number sequence.
    pub sampler: &'static str,
    /// How direct light is found.
    pub light_sampling: &'static str,
    /// Most path edges, if there is a limit.
    pub max_depth: Option<u32>,
    /// Whether Russian roulette ends paths.
    pub roulette: bool,
    /// Each effect, on or off, with what called for it.
    pub effects: Vec<Effect>,
}

/// Something that light may do, which a scene may or may not call for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Effect {
    /// Its name.
    pub name: &'static str,
    /// Whether it will be simulated.
    pub on: bool,
    /// The object that called for it, or why nothing did.
    pub because: String,
}

impl Plan {
    /// Reads a scene.
    pub fn new(scene: &Scene) -> Self {
        let i = &scene.integrator;
        let (kernel, precision) = match i.precision {
            Precision::F32 => ("hero-4-f32", "f32"),
            Precision::F64 => ("hero-4-f64", "f64"),
        };
        Self {
            kernel,
            precision,
            lanes: crate::kernel::LANES,
            wavelength_range_nm: i.wavelength_range_nm,
            sampler: match i.sampler {
                SamplerKind::Sobol => "sobol",
                SamplerKind::Independent => "independent",
            },
            light_sampling: match i.light_sampling {
                LightSampling::Mis => "mis",
                LightSampling::Light => "light",
                LightSampling::Bsdf => "bsdf",
            },
            max_depth: i.max_depth,
            roulette: i.roulette,
            effects: effects(scene),
        }
    }
}

fn effects(scene: &Scene) -> Vec<Effect> {
    let first = |name, found: Option<String>, otherwise: &str| Effect {
        name,
        on: found.is_some(),
        because: found.unwrap_or_else(|| otherwise.to_owned()),
    };
    let used = |wanted: &dyn Fn(&MaterialKind) -> bool| {
        scene.objects.iter().find_map(|object| {
            let material = &scene.materials[object.material];
            wanted(&material.kind).then(|| format!("material \"{}\" of \"{}\"", material.name, object.name))
        })
    };
    let dispersive = |kind: &MaterialKind| match kind {
        MaterialKind::Dielectric { interior, exterior } => interior.is_dispersive() || exterior.is_dispersive(),
        MaterialKind::Lambert { .. }
        | MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::Black => false,
    };
    let specular = |kind: &MaterialKind| match kind {
        MaterialKind::Mirror { .. } | MaterialKind::Conductor { .. } | MaterialKind::Dielectric { .. } => true,
        MaterialKind::Lambert { .. } | MaterialKind::Black => false,
    };
    let diffuse = |kind: &MaterialKind| match kind {
        MaterialKind::Lambert { .. } => true,
        MaterialKind::Mirror { .. }
        | MaterialKind::Conductor { .. }
        | MaterialKind::Dielectric { .. }
        | MaterialKind::Black => false,
    };
    let lens = match &scene.camera.projection {
        Projection::Perspective { lens: Some(lens), .. } if lens.radius_m > 0.0 => {
            Some(format!("lens radius {} m, in focus at {} m", lens.radius_m, lens.focus_distance_m))
        }
        Projection::Perspective { .. } | Projection::Orthographic { .. } => None,
    };
    let environment = scene.lights.iter().find_map(|light| match light.kind {
        LightKind::Environment { .. } => Some(format!("light \"{}\"", light.name)),
        LightKind::Point { .. } | LightKind::Directional { .. } => None,
    });
    let target = scene
        .lights
        .iter()
        .find_map(|light| match light.kind {
            LightKind::Point { .. } | LightKind::Directional { .. } => Some(format!("light \"{}\"", light.name)),
            LightKind::Environment { .. } => None,
        })
        .or_else(|| {
            let sampled = scene.integrator.light_sampling != LightSampling::Bsdf;
            scene
                .objects
                .iter()
                .find(|object| sampled && object.emission.is_some())
                .map(|object| format!("emission of \"{}\"", object.name))
        });
    let shadow_rays = target.filter(|_| used(&diffuse).is_some());
    let mesh = scene.objects.iter().find_map(|object| match &object.shape {
        Shape::Mesh(mesh) => Some(format!("\"{}\": {} triangles", object.name, mesh.triangles.len())),
        Shape::Sphere { .. } | Shape::Parallelogram { .. } | Shape::Disk { .. } => None,
    });
    let filter = match scene.film.filter {
        Filter::Box => None,
        Filter::Tent { radius_px } => Some(format!("tent of radius {radius_px} px")),
        Filter::Gaussian { sigma_px } => Some(format!("Gaussian of σ {sigma_px} px")),
    };
    vec![
        first("dispersion", used(&dispersive), "no index depends on wavelength"),
        first("lens", lens, "the camera is a pinhole or orthographic"),
        first("shadow-rays", shadow_rays, "no light that a shadow ray could find meets a diffuse surface"),
        first("environment", environment, "no light at infinity"),
        first("specular", used(&specular), "no mirror, metal or glass"),
        first("diffuse", used(&diffuse), "no diffuse surface"),
        first("meshes", mesh, "analytic shapes only"),
        first("wide-filter", filter, "the pixel filter is the pixel"),
    ]
}
