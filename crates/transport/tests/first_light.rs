//! The smallest scenes with a known answer, built without a file.

use etalon_optics::{RefractiveIndex, Spectrum};
use etalon_scene::*;
use etalon_transport::{Control, prepare};

fn scene(objects: Vec<(Shape, MaterialKind, Option<Emission>)>, lights: Vec<LightKind>) -> Scene {
    let identity =
        Transform { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation_m: [0.0, 0.0, 0.0] };
    Scene {
        camera: Camera {
            position_m: [0.0, 0.0, 5.0],
            forward: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            projection: Projection::Perspective { vertical_fov_rad: 0.25, lens: None },
        },
        film: Film { width: 16, height: 16, filter: Filter::Box },
        materials: objects
            .iter()
            .enumerate()
            .map(|(i, o)| Material { name: format!("m{i}"), kind: o.1.clone() })
            .collect(),
        objects: objects
            .into_iter()
            .enumerate()
            .map(|(i, (shape, _, emission))| Object {
                name: format!("o{i}"),
                shape,
                transform: identity.clone(),
                material: i,
                emission,
            })
            .collect(),
        lights: lights.into_iter().enumerate().map(|(i, kind)| Light { name: format!("l{i}"), kind }).collect(),
        integrator: Integrator {
            spp: 64,
            seed: 1,
            sampler: SamplerKind::Sobol,
            max_depth: None,
            roulette: true,
            light_sampling: LightSampling::Mis,
            wavelength_range_nm: [360.0, 830.0],
            precision: Precision::F32,
        },
    }
}

/// Mean Y over the film, its standard error over 16 independent seeds.
fn mean(scene: &Scene) -> (f64, f64) {
    let replicates: Vec<f64> = (0..16)
        .map(|seed| {
            let mut scene = scene.clone();
            scene.integrator.seed = seed;
            let prepared = prepare(&scene).unwrap();
            let whole = prepared.whole(None);
            let film = prepared.render(&whole, &|_| Control::Continue).unwrap();
            assert_eq!(film.counters.nonfinite, 0);
            film.mean_y(whole.rect)
        })
        .collect();
    let n = replicates.len() as f64;
    let mean = replicates.iter().sum::<f64>() / n;
    let variance = replicates.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

fn sphere(radius_m: f64) -> Shape {
    Shape::Sphere { center: [0.0, 0.0, 0.0], radius_m }
}

#[test]
fn probe() {
    let sky = || vec![LightKind::Environment { radiance: Spectrum::Constant(1.0) }];
    let lambert = |r| MaterialKind::Lambert { reflectance: Spectrum::Constant(r) };
    let glass = MaterialKind::Dielectric {
        interior: RefractiveIndex::constant(1.5).unwrap(),
        exterior: RefractiveIndex::constant(1.0).unwrap(),
    };
    for precision in [Precision::F32, Precision::F64] {
        for (name, mut s, truth) in [
            ("sky", scene(vec![], sky()), 1.0),
            ("furnace", scene(vec![(sphere(1.0), lambert(0.5), None)], sky()), 0.5),
            ("glass ball", scene(vec![(sphere(1.0), glass.clone(), None)], sky()), 1.0),
            ("in glass", scene(vec![(sphere(10.0), glass.clone(), None)], sky()), 2.25),
            (
                "enclosure",
                scene(
                    vec![(
                        sphere(10.0),
                        lambert(0.5),
                        Some(Emission { radiance: Spectrum::Constant(0.5), sides: EmissionSides::Both }),
                    )],
                    vec![],
                ),
                1.0,
            ),
        ] {
            s.integrator.precision = precision;
            let (mean, se) = mean(&s);
            println!("{precision:?} {name}: {mean} ± {se} against {truth}: z = {}", (mean - truth) / se);
        }
    }
}
