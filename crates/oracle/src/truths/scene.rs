//! Scenes in the neutral form, built piece by piece.

use serde_json::{Value, json};

pub(super) use super::image_files::{grey_hdr, grey_png, radiance_hdr, rgba_png};
use super::{Claim, SceneFile};
use crate::vector::{Vec3, add, cross, length, normalize, sub};

/// A scene in the making.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    camera: Value,
    film: (u32, u32),
    spp: u32,
    objects: Vec<Value>,
    /// Objects that move together, and their keyframes.
    moving: Vec<(Vec<Value>, Vec<Value>)>,
    lights: Vec<Value>,
    max_depth: Option<u32>,
    light_sampling: Option<&'static str>,
    band_nm: Option<[f64; 2]>,
    /// Values of the whole format, by the names of the two keys that lead to them; a whole part has no second.
    further: Vec<([&'static str; 2], Value)>,
    files: Vec<SceneFile>,
    /// Whether the scene uses keys that the neutral form lacks.
    whole_format: bool,
}

/// Plate that a light meter looks at: its albedo and half side.
pub(super) const PLATE_ALBEDO: f64 = 0.5;
const PLATE_HALF_SIDE_M: f64 = 5e-4;

/// What the plate shows under an irradiance.
pub(super) fn shown(irradiance: f64) -> f64 {
    PLATE_ALBEDO * irradiance / std::f64::consts::PI
}

impl Scene {
    fn new(camera: Value) -> Self {
        Self {
            camera,
            // Four tiles of a usual size, so that several cores take part.
            film: (32, 32),
            spp: 1024,
            objects: Vec::new(),
            moving: Vec::new(),
            lights: Vec::new(),
            max_depth: None,
            light_sampling: None,
            band_nm: None,
            further: Vec::new(),
            files: Vec::new(),
            whole_format: false,
        }
    }

    /// A camera of Etalon's whole format.
    pub(super) fn camera(camera: Value) -> Self {
        Self { whole_format: true, ..Self::new(camera) }
    }

    /// Sets a key of the whole format in one of the scene's parts, such as `"film"` and `"filter"`.
    pub(super) fn set(mut self, part: &'static str, key: &'static str, value: Value) -> Self {
        self.further.push(([part, key], value));
        self.whole_format = true;
        self
    }

    /// Sets a whole part of the scene, such as `"instances"`.
    pub(super) fn whole(mut self, part: &'static str, value: Value) -> Self {
        self.further.push(([part, ""], value));
        self.whole_format = true;
        self
    }

    /// An object of the whole format.
    pub(super) fn thing(mut self, object: Value) -> Self {
        self.objects.push(object);
        self.whole_format = true;
        self
    }

    /// A light of the whole format.
    pub(super) fn light(mut self, light: Value) -> Self {
        self.lights.push(light);
        self.whole_format = true;
        self
    }

    /// A file that the scene names.
    pub(super) fn file(mut self, name: &str, bytes: Vec<u8>) -> Self {
        self.files.push(SceneFile { name: name.to_owned(), bytes });
        self.whole_format = true;
        self
    }

    pub(super) fn files(&self) -> Vec<SceneFile> {
        self.files.clone()
    }

    /// Parallel rays from a plane through `position`.
    pub(super) fn orthographic(position: Vec3, look_at: Vec3, height_m: f64) -> Self {
        Self::new(json!({
            "type": "orthographic", "position_m": position, "look_at_m": look_at, "height_m": height_m,
            "up": up_for(position, look_at)
        }))
    }

    /// Rays through a pinhole.
    pub(super) fn pinhole(position: Vec3, look_at: Vec3, vertical_fov_deg: f64) -> Self {
        Self::new(json!({
            "type": "perspective", "position_m": position, "look_at_m": look_at, "vertical_fov_deg": vertical_fov_deg,
            "up": up_for(position, look_at)
        }))
    }

    /// Rays through a thin lens.
    pub(super) fn lens(
        position: Vec3,
        look_at: Vec3,
        vertical_fov_deg: f64,
        radius_m: f64,
        focus_distance_m: f64,
    ) -> Self {
        let mut scene = Self::pinhole(position, look_at, vertical_fov_deg);
        scene.camera["lens"] = json!({ "radius_m": radius_m, "focus_distance_m": focus_distance_m });
        scene
    }

    /// The camera cuts off what is nearer.
    pub(super) fn near(mut self, near_m: f64) -> Self {
        self.camera["near_m"] = json!(near_m);
        self.whole_format = true;
        self
    }

    /// Left and right are exchanged in the picture.
    pub(super) fn mirrored(mut self) -> Self {
        self.camera["mirrored"] = json!(true);
        self.whole_format = true;
        self
    }

    /// A Lambert plate of albedo ½ at the origin that faces +z, seen in parallel rays from 60° off its normal, from so near
    /// that nothing comes between; it shows E/(2π). It is smaller than 1e-3 m, so that E is the same all over it to 1e-6 when
    /// nothing is nearer than 1 m.
    pub(super) fn light_meter() -> Self {
        Self::meter([0.0; 3], 0.01, 1e-4)
    }

    /// The plate elsewhere.
    pub(super) fn light_meter_at(at: Vec3) -> Self {
        Self::meter(at, 0.01, 1e-4)
    }

    /// The plate under something that is `gap_m` above it: seen from below that.
    pub(super) fn light_meter_below(gap_m: f64) -> Self {
        Self::meter([0.0; 3], gap_m, 1e-4)
    }

    fn meter(at: Vec3, distance_m: f64, height_m: f64) -> Self {
        let position = [at[0], at[1] - 0.75_f64.sqrt() * distance_m, at[2] + 0.5 * distance_m];
        let h = PLATE_HALF_SIDE_M;
        Self::orthographic(position, at, height_m).object(
            parallelogram([at[0] - h, at[1] - h, at[2]], [2.0 * h, 0.0, 0.0], [0.0, 2.0 * h, 0.0]),
            lambert(PLATE_ALBEDO),
        )
    }

    pub(super) fn object(mut self, shape: Value, material: Value) -> Self {
        self.objects.push(json!({ "shape": shape, "material": material }));
        self
    }

    /// An object that lets the share 1 − `opacity` of the light pass.
    pub(super) fn mask(mut self, shape: Value, material: Value, opacity: f64) -> Self {
        self.objects.push(json!({ "shape": shape, "material": material, "opacity": opacity }));
        self
    }

    /// An object that emits from its "front", "back" or "both" sides.
    pub(super) fn lamp(mut self, shape: Value, material: Value, radiance: f64, sides: &str) -> Self {
        let emission = json!({ "radiance": radiance, "sides": sides });
        self.objects.push(json!({ "shape": shape, "material": material, "emission": emission }));
        self
    }

    /// A thermal emitter at a temperature, K, multiplied by a factor.
    pub(super) fn thermal_lamp(mut self, shape: Value, temperature_k: f64, scale: f64) -> Self {
        let radiance = json!({ "type": "blackbody", "temperature_k": temperature_k, "scale": scale });
        let emission = json!({ "radiance": radiance, "sides": "front" });
        self.objects.push(json!({ "shape": shape, "material": black(), "emission": emission }));
        self
    }

    /// Objects that move through some keyframes.
    pub(super) fn moving(mut self, objects: &[Value], keyframes: &[Value]) -> Self {
        self.moving.push((objects.to_vec(), keyframes.to_vec()));
        self
    }

    /// When the shutter opens and closes, s.
    pub(super) fn shutter(mut self, shutter_s: [f64; 2]) -> Self {
        self.camera["shutter_s"] = json!(shutter_s);
        self
    }

    /// A camera that moves.
    pub(super) fn camera_keys(mut self, keyframes: &[Value]) -> Self {
        self.camera["keyframes"] = json!(keyframes);
        self
    }

    pub(super) fn sky(mut self, radiance: f64) -> Self {
        self.lights.push(json!({ "type": "environment", "radiance": radiance }));
        self
    }

    pub(super) fn point_light(mut self, position: Vec3, intensity: f64) -> Self {
        self.lights.push(json!({ "type": "point", "position_m": position, "intensity": intensity }));
        self
    }

    pub(super) fn directional_light(mut self, direction: Vec3, irradiance: f64) -> Self {
        self.lights.push(json!({ "type": "directional", "direction": direction, "irradiance": irradiance }));
        self
    }

    pub(super) fn film(mut self, width: u32, height: u32) -> Self {
        self.film = (width, height);
        self
    }

    pub(super) fn spp(mut self, spp: u32) -> Self {
        self.spp = spp;
        self
    }

    pub(super) fn up(mut self, up: Vec3) -> Self {
        self.camera["up"] = json!(up);
        self
    }

    /// Paths of at most this many edges from the camera to a light.
    pub(super) fn depth(mut self, edges: u32) -> Self {
        self.max_depth = Some(edges);
        self
    }

    /// Forces a way of finding direct light: "mis", "light" or "bsdf".
    pub(super) fn light_sampling(mut self, how: &'static str) -> Self {
        self.light_sampling = Some(how);
        self
    }

    pub(super) fn band(mut self, band_nm: [f64; 2]) -> Self {
        self.band_nm = Some(band_nm);
        self
    }

    pub(super) fn band_nm(&self) -> Option<[f64; 2]> {
        self.band_nm
    }

    /// Whether it is measured, not seen.
    pub(super) fn has_meters(&self) -> bool {
        self.further.iter().any(|([part, _], _)| *part == "meters")
    }

    /// What the scene itself asks of a renderer.
    pub(super) fn claims(&self) -> Vec<Claim> {
        let mut claims = Vec::new();
        if self.camera.get("lens").is_some() {
            claims.push(Claim::ThinLens);
        }
        if self.max_depth.is_some() {
            claims.push(Claim::DepthLimit);
        }
        if self.band_nm.is_some() {
            claims.push(Claim::NarrowBand);
        }
        if self.whole_format {
            claims.push(Claim::WholeFormat);
        }
        if self.has_meters() {
            claims.push(Claim::Meters);
        }
        claims
    }

    pub(super) fn to_json(&self) -> String {
        let mut integrator = json!({ "spp": self.spp });
        if let Some(edges) = self.max_depth {
            integrator["max_depth"] = json!(edges);
        }
        if let Some(how) = self.light_sampling {
            integrator["light_sampling"] = json!(how);
        }
        if let Some(band) = self.band_nm {
            integrator["wavelength_range_nm"] = json!(band);
        }
        let mut scene = json!({
            "etalon": 1,
            "camera": self.camera,
            "film": { "width": self.film.0, "height": self.film.1, "filter": { "type": "box" } },
            "objects": self.objects,
            "lights": self.lights,
            "integrator": integrator,
        });
        if !self.moving.is_empty() {
            let name = |i: usize| format!("group {i}");
            let groups =
                self.moving.iter().enumerate().map(|(i, (objects, _))| (name(i), json!({ "objects": objects })));
            scene["groups"] = groups.collect::<serde_json::Map<_, _>>().into();
            let instances =
                self.moving.iter().enumerate().map(|(i, (_, keys))| json!({ "group": name(i), "keyframes": keys }));
            scene["instances"] = instances.collect();
        }
        for ([part, key], value) in &self.further {
            match *key {
                "" => scene[*part] = value.clone(),
                key => scene[*part][key] = value.clone(),
            }
        }
        serde_json::to_string_pretty(&scene).expect("a JSON value always prints")
    }
}

/// An upward direction well across the view.
fn up_for(position: Vec3, look_at: Vec3) -> Vec3 {
    let view = normalize(sub(look_at, position));
    let up = [0.0, 1.0, 0.0];
    if length(cross(view, up)) > 0.1 { up } else { [0.0, 0.0, 1.0] }
}

pub(super) fn lambert(reflectance: f64) -> Value {
    json!({ "type": "lambert", "reflectance": reflectance })
}

pub(super) fn mirror(reflectance: f64) -> Value {
    json!({ "type": "mirror", "reflectance": reflectance })
}

/// A metal of the same n + ik at every wavelength.
pub(super) fn conductor(n: f64, k: f64) -> Value {
    json!({ "type": "conductor", "wavelengths_nm": [300, 900], "n": [n, n], "k": [k, k] })
}

/// Metal that reflects everything, with GGX facets of widths along the grain and across it. The grain is turned from the direction of growing
/// u toward that of growing v. Light that meets several facets is given back or lost.
pub(super) fn brushed_metal(alpha: [f64; 2], rotation_deg: f64, lossless: bool) -> Value {
    let mut metal = conductor(1e-12, 3.0);
    (metal["alpha_u"], metal["alpha_v"]) = (json!(alpha[0]), json!(alpha[1]));
    if rotation_deg != 0.0 {
        metal["tangent_rotation_deg"] = json!(rotation_deg);
    }
    if !lossless {
        metal["multiple_scattering"] = json!("lost");
    }
    metal
}

pub(super) fn glass(interior: f64) -> Value {
    json!({ "type": "dielectric", "interior": interior })
}

/// Glass whose facets have the GGX distribution of width `alpha`.
pub(super) fn rough_glass(interior: f64, alpha: f64) -> Value {
    json!({ "type": "dielectric", "interior": interior, "alpha": alpha })
}

pub(super) fn glass_in(interior: f64, exterior: f64) -> Value {
    json!({ "type": "dielectric", "interior": interior, "exterior": exterior })
}

/// A closed solid of this index among others: where they overlap, the highest priority fills the place.
pub(super) fn solid(interior: f64, priority: u32) -> Value {
    json!({ "type": "dielectric", "interior": interior, "priority": priority })
}

/// A glass by Sellmeier's formula, coefficients B and C (µm²).
pub(super) fn sellmeier_glass(b: [f64; 3], c_um2: [f64; 3]) -> Value {
    let index = json!({ "type": "sellmeier", "b": b, "c_um2": c_um2, "range_nm": [300, 2500] });
    json!({ "type": "dielectric", "interior": index })
}

pub(super) fn black() -> Value {
    json!({ "type": "black" })
}

pub(super) fn sphere(center: Vec3, radius_m: f64) -> Value {
    json!({ "type": "sphere", "center_m": center, "radius_m": radius_m })
}

pub(super) fn disk(center: Vec3, normal: Vec3, radius_m: f64) -> Value {
    json!({ "type": "disk", "center_m": center, "normal": normal, "radius_m": radius_m })
}

/// A round rod or room, closed by disks at its ends; the front is outside.
pub(super) fn cylinder(start: Vec3, end: Vec3, radius_m: f64) -> Value {
    json!({ "type": "cylinder", "start_m": start, "end_m": end, "radius_m": radius_m, "capped": true })
}

/// The front is along u × v.
pub(super) fn parallelogram(origin: Vec3, u: Vec3, v: Vec3) -> Value {
    json!({ "type": "parallelogram", "origin_m": origin, "u_m": u, "v_m": v })
}

/// A square of half side `half` about a centre at the height `z`, its front upward or downward.
pub(super) fn level_square(center: Vec3, half: f64, front_up: bool) -> Value {
    let origin = [center[0] - half, center[1] - half, center[2]];
    let (a, b) = ([2.0 * half, 0.0, 0.0], [0.0, 2.0 * half, 0.0]);
    if front_up { parallelogram(origin, a, b) } else { parallelogram(origin, b, a) }
}

pub(super) fn block(min: Vec3, max: Vec3) -> Value {
    json!({ "type": "box", "min_m": min, "max_m": max })
}

pub(super) fn mesh(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Value {
    json!({ "type": "mesh", "vertices_m": vertices, "triangles": triangles })
}

/// A closed prism over a polygon given counter-clockwise as seen from where `along` points to.
pub(super) fn extruded(corners: &[Vec3], along: Vec3) -> Value {
    let far = corners.iter().map(|&corner| add(corner, along));
    let vertices: Vec<Vec3> = corners.iter().copied().chain(far).collect();
    let n = u32::try_from(corners.len()).expect("a few corners");
    let fan = (1..n - 1).flat_map(|i| [[0, i + 1, i], [n, n + i, n + i + 1]]);
    let sides = (0..n).map(|i| (i, (i + 1) % n)).flat_map(|(i, j)| [[i, j, n + j], [i, n + j, n + i]]);
    let triangles: Vec<[u32; 3]> = fan.chain(sides).collect();
    mesh(&vertices, &triangles)
}

/// A closed prism along z over a triangle given counter-clockwise in the xy plane.
pub(super) fn triangular_prism(corners: [[f64; 2]; 3], z: [f64; 2]) -> Value {
    extruded(&corners.map(|[x, y]| [x, y, z[0]]), [0.0, 0.0, z[1] - z[0]])
}
