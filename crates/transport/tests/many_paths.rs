//! Many paths at once against one at a time: the same films and the same counts, bit for bit, on the ready-made scenes and on
//! scenes made up by chance.

use etalon_scene::{SamplerKind, Scene};
use etalon_transport::{Control, EffectName, Film, PathLoop, Prepared, Study, prepare_study};
use serde_json::{Value, json};

/// The ready-made scenes, small.
fn ready_made() -> Vec<(String, Scene)> {
    crate::common::ready_made([22, 17], 4)
}

fn render(prepared: &Prepared) -> Film {
    prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap()
}

/// The film of many paths at once must be that of one at a time.
fn agrees(name: &str, scene: &Scene, study: &Study) {
    let prepared = |path_loop| {
        let study = Study { path_loop: Some(path_loop), ..study.clone() };
        let prepared = prepare_study(scene, &study).unwrap();
        assert_eq!(prepared.plan().path_loop.name, path_loop);
        prepared
    };
    let [batch, scalar] = [PathLoop::Batch, PathLoop::Scalar].map(|path_loop| render(&prepared(path_loop)));
    assert_eq!(batch.counters, scalar.counters, "{name}");
    // Sums of all replicates and bands, as bits: zeros of either sign are told apart.
    let bits = |film: &Film| -> Vec<u64> {
        film.pixels().flat_map(|pixel| pixel.sums().to_vec()).flat_map(|sum| sum.xyz.map(f64::to_bits)).collect()
    };
    assert!(batch == scalar && bits(&batch) == bits(&scalar), "{name}: the films differ");
}

#[test]
fn many_paths_at_once_leave_the_film_of_one_at_a_time_on_every_ready_made_scene() {
    let forced = |effect| Study { force: vec![effect], ..Study::default() };
    for (name, mut scene) in ready_made() {
        agrees(&name, &scene, &Study::default());
        let plan = prepare_study(&scene, &Study::default()).unwrap();
        for effect in [EffectName::Wavelengths, EffectName::Dispersion, EffectName::NestedDielectrics] {
            // Another model of lanes than the scene's own, or another walk along rays.
            if !plan.plan().runs(effect) {
                agrees(&format!("{name}, {effect}"), &scene, &forced(effect));
            }
        }
        agrees(&format!("{name}, polarised"), &scene, &Study { polarised: true, ..Study::default() });
        scene.integrator.sampler = SamplerKind::Independent;
        (scene.integrator.replicates, scene.integrator.spp) = (1, 5);
        agrees(&format!("{name}, independent numbers"), &scene, &Study::default());
    }
}

/// Numbers by SplitMix64.
struct Chance(u64);

impl Chance {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.number()
    }

    fn below(&mut self, n: usize) -> usize {
        (self.number() * n as f64) as usize
    }

    fn point(&mut self, reach: f64) -> Value {
        json!([self.within(-reach, reach), self.within(-reach, reach), self.within(-reach, reach)])
    }

    fn spectrum(&mut self, most: f64) -> Value {
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

    fn material(&mut self) -> Value {
        match self.below(11) {
            0 => json!({"type": "mirror", "reflectance": self.within(0.3, 1.0)}),
            1 => json!({"type": "dielectric", "interior": self.within(1.1, 2.4)}),
            2 => json!({"type": "dielectric", "interior": "N-SF11"}),
            3 => json!({"type": "conductor", "metal": "Au", "alpha": self.within(0.0, 0.5)}),
            4 => json!({"type": "plastic", "reflectance": self.spectrum(0.9)}),
            5 => json!({"type": "black"}),
            6 => json!({"type": "fluorescent", "reflectance": self.within(0.0, 0.4), "fluorophores": [{
                "absorption": {"type": "tabulated", "outside": "zero", "wavelengths_nm": [390, 430, 520], "values": [0.1, self.within(0.2, 0.6), 0]},
                "emission": {"type": "tabulated", "outside": "zero", "wavelengths_nm": [410, 540, 640], "values": [0, 1, 0.2]},
                "quantum_yield": self.within(0.3, 1.0)}]}),
            _ => json!({"type": "lambert", "reflectance": self.spectrum(1.0)}),
        }
    }

    fn medium(&mut self) -> Value {
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

    fn shape(&mut self) -> Value {
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

    fn scene(&mut self) -> Value {
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
                    object["emission"] = json!({"radiance": self.within(0.5, 20.0), "sides": sides});
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
        let mut camera =
            json!({"type": "perspective", "position_m": [0.3, 0.2, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40});
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
        scene
    }
}

#[test]
fn many_paths_at_once_leave_the_film_of_one_at_a_time_on_scenes_made_up_by_chance() {
    let mut chance = Chance(7);
    for number in 0..40 {
        let json = chance.scene();
        let scene = etalon_scene::parse(&json.to_string(), "test").unwrap_or_else(|e| panic!("{json:#}\n{e:?}")).0;
        let study = Study { polarised: chance.below(4) == 0, ..Study::default() };
        agrees(&format!("scene {number}: {json:#}"), &scene, &study);
    }
}
