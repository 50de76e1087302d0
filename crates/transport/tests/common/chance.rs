//! Scenes made up by chance.

use etalon_scene::{EnvironmentImage, EnvironmentProjection, Image, LightKind, Scene, Texels};
use serde_json::{Value, json};
use std::sync::Arc;

/// The scene of a text. A light whose name is "image N" becomes a sky of 8 × 4 texels, of which number N is bright.
pub(crate) fn made(json: &Value) -> Scene {
    let text = json.to_string();
    let mut scene = etalon_scene::parse(&text, "test").unwrap_or_else(|errors| panic!("{json:#}\n{errors}")).0;
    for light in &mut scene.lights {
        if let Some(bright) = light.name.strip_prefix("image ") {
            let bright: usize = bright.parse().expect("the number of a texel");
            let texels = (0..32).map(|i| [if i == bright { 8.0 } else { 0.2 }; 3]).collect();
            light.kind = LightKind::ImageEnvironment(EnvironmentImage {
                image: Arc::new(Image::new(8, 4, Texels::F32(texels))),
                name: light.name.clone(),
                projection: EnvironmentProjection::LatitudeLongitude,
                forward: [1.0, 0.0, 0.0],
                right: [0.0, 0.0, 1.0],
                up: [0.0, 1.0, 0.0],
                white: etalon_optics::Spectrum::ONE,
            });
        }
    }
    scene
}

/// Numbers by SplitMix64.
pub(crate) struct Chance(pub u64);

impl Chance {
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.number()
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.number() * n as f64) as usize
    }

    pub(crate) fn point(&mut self, reach: f64) -> Value {
        json!([self.within(-reach, reach), self.within(-reach, reach), self.within(-reach, reach)])
    }

    pub(crate) fn spectrum(&mut self, most: f64) -> Value {
        let level = self.within(0.05, most);
        match self.below(4) {
            0 => json!(level),
            1 => {
                json!({"type": "tabulated", "outside": "clamp", "wavelengths_nm": [400, 550, 700], "values": [level, 0.3 * level, 0.7 * level]})
            }
            2 => json!({"type": "rgb", "rgb": [level, 0.5 * level, 0.2 * level]}),
            _ => json!(0),
        }
    }

    pub(crate) fn material(&mut self) -> Value {
        match self.below(17) {
            0 => json!({"type": "mirror", "reflectance": self.within(0.3, 1.0)}),
            1 => json!({"type": "dielectric", "interior": self.within(1.1, 2.4)}),
            2 => json!({"type": "dielectric", "interior": "N-SF11"}),
            3 => json!({"type": "conductor", "metal": "Au", "alpha": self.within(0.0, 0.5)}),
            4 => json!({"type": "plastic", "reflectance": self.spectrum(0.9)}),
            5 => json!({"type": "black"}),
            7 => json!({"type": "oren-nayar", "reflectance": self.spectrum(0.9), "roughness": self.within(0.0, 1.0)}),
            8 => {
                json!({"type": "translucent", "reflectance": self.within(0.0, 0.5), "transmittance": self.within(0.0, 0.5)})
            }
            9 => json!({"type": "thin-dielectric", "index": self.within(1.1, 2.0)}),
            10 => json!({"type": "dielectric", "interior": self.within(1.1, 2.0), "alpha": self.within(0.05, 0.5)}),
            11 => {
                json!({"type": "dielectric", "interior": 1.5, "thin_film": [{"thickness_nm": self.within(50.0, 800.0), "index": self.within(1.1, 2.0)}]})
            }
            12 => {
                json!({"type": "blend", "weight": self.within(0.0, 1.0), "first": {"type": "lambert", "reflectance": self.spectrum(1.0)},
                    "second": {"type": "mirror"}})
            }
            13 => {
                json!({"type": "principled", "reflectance": self.spectrum(0.6), "alpha": self.within(0.05, 0.8), "metallic": self.within(0.0, 1.0),
                    "specular_tint": self.within(0.0, 1.0), "flatness": self.within(0.0, 1.0), "sheen": self.within(0.0, 0.3),
                    "sheen_tint": self.within(0.0, 1.0), "clear_coat": self.within(0.0, 1.0)})
            }
            6 => json!({"type": "fluorescent", "reflectance": self.within(0.0, 0.4), "fluorophores": [{
                "absorption": {"type": "tabulated", "outside": "zero", "wavelengths_nm": [390, 430, 520], "values": [0.1, self.within(0.2, 0.6), 0]},
                "emission": {"type": "tabulated", "outside": "zero", "wavelengths_nm": [410, 540, 640], "values": [0, 1, 0.2]},
                "quantum_yield": self.within(0.3, 1.0)}]}),
            _ => json!({"type": "lambert", "reflectance": self.spectrum(1.0)}),
        }
    }

    fn slide(&mut self) -> Value {
        let colour = [self.within(0.0, 1.0), self.within(0.0, 1.0), self.within(0.0, 1.0)];
        let image = json!({"type": "checker", "first": colour, "second": 0.2, "uv_scale": [2, 2]});
        json!({"image": image, "direction": self.point(1.0), "horizontal_fov_deg": self.within(20.0, 100.0)})
    }

    pub(crate) fn medium(&mut self) -> Value {
        let phase = match self.below(3) {
            0 => json!({"type": "rayleigh"}),
            1 => json!({"type": "henyey-greenstein", "g": self.within(-0.8, 0.9)}),
            _ => json!({"type": "isotropic"}),
        };
        let mut medium =
            json!({"scattering_per_m": self.spectrum(3.0), "absorption_per_m": self.spectrum(0.5), "phase": phase});
        if self.below(2) == 0 {
            medium["density"] =
                json!({"type": "exponential", "scale_height_m": self.within(0.3, 3.0), "up": self.point(1.0)});
        }
        if self.below(3) == 0 {
            medium["source_radiance"] = json!(self.within(0.1, 1.0));
        }
        medium
    }

    pub(crate) fn shape(&mut self) -> Value {
        match self.below(5) {
            0 => json!({"type": "sphere", "center_m": self.point(1.0), "radius_m": self.within(0.1, 0.6)}),
            1 => {
                json!({"type": "disk", "center_m": self.point(1.0), "normal": self.point(1.0), "radius_m": self.within(0.2, 1.0)})
            }
            2 => {
                json!({"type": "cylinder", "start_m": self.point(1.0), "end_m": self.point(1.0), "radius_m": self.within(0.05, 0.3)})
            }
            3 => {
                let (x, y, z, size) =
                    (self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(0.1, 0.7));
                json!({"type": "box", "min_m": [x, y, z], "max_m": [x + size, y + 0.5 * size, z + size]})
            }
            _ => {
                json!({"type": "parallelogram", "origin_m": self.point(1.5), "u_m": self.point(1.5), "v_m": self.point(1.5)})
            }
        }
    }

    pub(crate) fn scene(&mut self) -> Value {
        let objects: Vec<Value> = (0..2 + self.below(14))
            .map(|index| {
                let mut object = json!({"shape": self.shape(), "material": self.material()});
                if self.below(6) == 0 {
                    object["opacity"] = json!(self.within(0.0, 1.0));
                }
                if object["shape"]["type"] == "sphere" && self.below(3) == 0 {
                    // Solids that may overlap, some of which absorb.
                    let (interior, priority) = (self.within(1.1, 1.8), self.below(3));
                    object["material"] = json!({"type": "dielectric", "interior": interior, "priority": priority});
                    match self.below(4) {
                        0 | 1 => object["material"]["absorption_per_m"] = json!(self.within(0.0, 3.0)),
                        2 => object["material"]["medium"] = self.medium(),
                        _ => {}
                    }
                } else if object["shape"]["type"] == "box" && self.below(3) == 0 {
                    object["material"] = json!({"type": "boundary", "medium": self.medium()});
                }
                if index == 0 || self.below(4) == 0 {
                    let sides = ["front", "back", "both"][self.below(3)];
                    object["emission"] = json!({"radiance": self.within(0.5, 5.0), "sides": sides});
                }
                object
            })
            .collect();
        let mut lights = Vec::new();
        if self.below(2) == 0 {
            lights.push(json!({"type": "environment", "radiance": self.within(0.1, 1.0)}));
        }
        if self.below(3) == 0 {
            lights.push(json!({"type": "point", "position_m": self.point(2.0), "intensity": 3}));
        }
        if self.below(3) == 0 {
            lights.push(json!({"type": "directional", "direction": self.point(1.0), "irradiance": 2}));
        }
        let sun = [self.within(-1.0, 1.0), self.within(0.3, 1.0), self.within(-1.0, 1.0)];
        if self.below(5) == 0 {
            lights.push(json!({"type": "environment", "sky": {"cie_type": 12, "zenith_radiance": self.within(0.1, 1.0), "sun_direction": sun, "up": [0, 1, 0]}}));
        }
        if self.below(6) == 0 {
            lights.push(json!({"type": "environment", "daylight": {"turbidity": 3, "scale": 2, "sun_direction": sun, "up": [0, 1, 0]}}));
        }
        for name in ["image 10", "image 13"] {
            if self.below(4) == 0 {
                lights.push(json!({"type": "environment", "name": name, "radiance": 1}));
            }
        }
        if self.below(5) == 0 {
            lights.push(json!({"type": "spot", "position_m": self.point(2.0), "direction": self.point(1.0), "intensity": 5, "half_angle_deg": 40}));
        }
        if self.below(6) == 0 {
            lights.push(json!({"type": "beam", "position_m": self.point(2.0), "direction": self.point(1.0), "radius_m": self.within(0.1, 0.4), "power": 1}));
        }
        let mut camera = json!({"type": "perspective", "position_m": [0.3, 0.2, 4], "look_at_m": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_deg": 40});
        if self.below(3) == 0 {
            camera["lens"] = json!({"radius_m": 0.05, "focus_distance_m": 4});
        }
        let mut film = json!({"width": 19, "height": 18});
        if self.below(3) == 0 {
            film["bands_nm"] = json!([400, 700, 30]);
        }
        if self.below(3) == 0 {
            film["filter"] = json!({"type": "gaussian", "sigma_px": 0.5});
        }
        let sampling = ["mis", "light", "bsdf"][self.below(3)];
        let mut integrator = json!({"spp": 1 + self.below(12), "wavelength_range_nm": [380, 720], "seed": self.below(1000), "light_sampling": sampling});
        integrator["light_selection"] = json!(["auto", "power", "tree"][self.below(3)]);
        // Where nothing absorbs and no way leads out, a path would go on for hours.
        integrator["max_depth"] = json!(if self.below(2) == 0 { 1 + self.below(9) } else { 64 });
        let mut scene = json!({"etalon": 1, "camera": camera, "film": film, "integrator": integrator, "objects": objects, "lights": lights});
        if self.below(4) == 0 {
            scene["medium"] = self.medium();
        }
        if self.below(12) == 0 {
            let light = json!({"type": "point", "position_m": self.point(2.0), "intensity": 5, "slide": self.slide()});
            scene["lights"].as_array_mut().expect("a list").push(light);
        }
        scene
    }
}
