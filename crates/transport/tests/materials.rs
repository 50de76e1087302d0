//! Coated and rough diffuse surfaces, panes, masks and spots against closed forms.

use etalon_optics::{ComplexIndex, Lanes, RefractiveIndex, Spectrum, Vec3};
use etalon_oracle::laws::fresnel_exact;
use etalon_oracle::statistics::Welford;
use etalon_oracle::truths::walsh_reflectance;
use etalon_scene::{
    Image, ImageTexture, InternalReflection, MaterialKind, Metal, NumberTexture, SpectrumTexture, Texels,
};
use etalon_transport::bsdf::{Bsdf, Shading};
use etalon_transport::light::{Light, PointLight, SpotLight};
use etalon_transport::spectral::PathSpectrum;
use etalon_transport::{Control, prepare};
use serde_json::{Value, json};
use std::f64::consts::PI;

const RANGE_NM: [f64; 2] = [380.0, 780.0];

fn direction(mu: f64, turns: f64) -> Vec3<f64> {
    let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
    Vec3::new(sin * (2.0 * PI * turns).cos(), sin * (2.0 * PI * turns).sin(), mu)
}

/// ∫ f cos over the upper hemisphere without the deltas, by midpoints in cos² and azimuth.
fn albedo(bsdf: &Bsdf, mu: f64) -> f64 {
    let n = 256;
    let at = |i: usize| (i as f64 + 0.5) / n as f64;
    let up = Shading::flat(Vec3::new(0.0, 0.0, 1.0));
    let mut sum = 0.0;
    for i in 0..n * n {
        let wi = direction(at(i % n).sqrt(), at(i / n));
        let (f_cos, _) = bsdf.eval::<1>(&Lanes([550.0]), &up, direction(mu, 0.0), wi);
        // dω cos = π d(cos²) d(turns).
        sum += f_cos[0] / wi.z * PI;
    }
    sum / (n * n) as f64
}

#[test]
fn smooth_plastic_has_the_albedo_of_its_closed_form() {
    let n = 1.5;
    for rho in [0.2, 0.8, 1.0] {
        let plastic = |internal_reflection| {
            let (reflectance, coat) = (Spectrum::Constant(rho).into(), RefractiveIndex::Constant(n));
            Bsdf::new(
                &MaterialKind::Plastic { reflectance, coat, facets: None, internal_reflection, compensated: true },
                RANGE_NM,
            )
        };
        let (bsdf, uncoloured) = (plastic(InternalReflection::Coloured), plastic(InternalReflection::Uncoloured));
        for mu in [1.0, 0.5, 0.1] {
            let passed = fresnel_exact(mu, n).transmittance();
            let mean = 1.0 - walsh_reflectance(n);
            // As if the ground were white from the second time on, the geometric series sums to n²/T_avg: T(µ)ρ is left.
            let read = albedo(&uncoloured, mu);
            assert!((read - passed * rho).abs() < 3e-4, "uncoloured, ρ {rho} µ {mu}: {read} is not {}", passed * rho);
            let series = |r_i: f64| passed * mean * rho / (n * n * (1.0 - rho * r_i));
            // Inside, a diffuse ray meets 1 − (1 − r)/n² = 0.596 of mirror.
            let truth = series(1.0 - mean / (n * n));
            let read = albedo(&bsdf, mu);
            // The midpoint rule: T is a square root in cos² at grazing angles, n^-1.5.
            assert!((read - truth).abs() < 3e-4, "ρ {rho} µ {mu}: {read} is not {truth}");
            // Without n² inside, or with the outside's reflectance inside.
            assert!((read - series(walsh_reflectance(n))).abs() > 2e-3);
            assert!((read - truth * n * n).abs() > 0.01);
        }
    }
}

/// Averaged over diffuse light and with the ground too dark for a second bounce, EON returns
/// ρA(1 + r(2/3 − 28/(15π))), A = 1/(1 + r(1/2 − 2/(3π))).
#[test]
fn rough_diffuse_reflection_has_the_mean_albedo_of_its_closed_form() {
    for roughness in [0.0, 0.5, 1.0] {
        let rho = 1e-6;
        let kind = MaterialKind::OrenNayar { reflectance: Spectrum::Constant(rho).into(), roughness };
        let bsdf = Bsdf::new(&kind, RANGE_NM);
        let n = 24;
        let mean: f64 =
            (0..n).map(|i| albedo(&bsdf, ((f64::from(i) + 0.5) / f64::from(n)).sqrt())).sum::<f64>() / f64::from(n);
        let scale = 1.0 / (1.0 + roughness * (0.5 - 2.0 / (3.0 * PI)));
        let truth = scale * (1.0 + roughness * (2.0 / 3.0 - 28.0 / (15.0 * PI)));
        // The midpoint rule over 24 angles.
        assert!((mean / rho - truth).abs() < 2e-3, "r {roughness}: {} is not {truth}", mean / rho);
    }
}

/// Averaged over diffuse light each facet lets the share E of what it reflects escape and the next one have the rest, and takes 1 − ρ:
/// ρE Σ (ρ(1 − E))ᵏ = ρE/(1 − ρ(1 − E)), E as above. A white one returns all from wherever it comes.
#[test]
fn rough_diffuse_reflection_returns_what_meets_one_facet_after_another() {
    for roughness in [0.5, 1.0] {
        let single =
            (1.0 + roughness * (2.0 / 3.0 - 28.0 / (15.0 * PI))) / (1.0 + roughness * (0.5 - 2.0 / (3.0 * PI)));
        for rho in [0.2, 0.7, 1.0] {
            let kind = MaterialKind::OrenNayar { reflectance: Spectrum::Constant(rho).into(), roughness };
            let bsdf = Bsdf::new(&kind, RANGE_NM);
            let n = 24;
            let albedos: Vec<f64> =
                (0..n).map(|i| albedo(&bsdf, ((f64::from(i) + 0.5) / f64::from(n)).sqrt())).collect();
            let mean = albedos.iter().sum::<f64>() / f64::from(n);
            let truth = rho * single / (1.0 - rho * (1.0 - single));
            // The midpoint rule over 24 angles, and what the table misses between its nodes.
            assert!((mean - truth).abs() < 2e-3, "r {roughness}, ρ {rho}: {mean} is not {truth}");
            let all = albedos.iter().all(|a| (a - 1.0).abs() < 1e-3);
            assert!(rho < 1.0 || all, "r {roughness}: {albedos:?}");
        }
    }
}

/// With the ground too dark for a second bounce f·π/ρ = A(1 + r·s/t) for each pair of directions: s is what is left of their cosine
/// without the heights, t the larger height where s > 0 and 1 elsewhere (Portsmouth et al. 2024, equation (5)).
#[test]
fn rough_diffuse_reflection_is_brightest_toward_its_light() {
    let (rho, roughness) = (1e-9, 0.6);
    let kind = MaterialKind::OrenNayar { reflectance: Spectrum::Constant(rho).into(), roughness };
    let (bsdf, up) = (Bsdf::new(&kind, RANGE_NM), Shading::flat(Vec3::new(0.0, 0.0, 1.0)));
    let scale = 1.0 / (1.0 + roughness * (0.5 - 2.0 / (3.0 * PI)));
    for (mu_o, mu_i) in [(0.6, 0.6), (0.9, 0.3), (0.2, 0.8)] {
        for turns in [0.0_f64, 0.1, 0.3, 0.5, 0.85] {
            let s = f64::sqrt((1.0 - mu_o * mu_o) * (1.0 - mu_i * mu_i)) * (2.0 * PI * turns).cos();
            let t = if s > 0.0 { f64::max(mu_o, mu_i) } else { 1.0 };
            let (wo, wi) = (direction(mu_o, 0.2), direction(mu_i, 0.2 + turns));
            let (f_cos, _) = bsdf.eval::<1>(&Lanes([550.0]), &up, wo, wi);
            let (read, truth) = (f_cos[0] * PI / (rho * mu_i), scale * (1.0 + roughness * s / t));
            // The second bounce, ρ of the first.
            assert!((read - truth).abs() < 1e-8, "{mu_o}, {mu_i}, {turns} turns: {read} is not {truth}");
        }
    }
}

#[test]
fn a_spot_has_its_intensity_and_its_power() {
    let intensity = PathSpectrum::Constant(3.0);
    let point = PointLight { position: Vec3::new(0.0, 0.0, 2.0), intensity, per_m: 1.0 };
    let cosines = [0.9, 0.6];
    let spot = Light::Spot(SpotLight { point, axis: Vec3::new(0.0, 0.0, -1.0), cosines });
    let intensity = |toward: Vec3<f64>| {
        let from = Vec3::new(0.0, 0.0, 2.0) + toward * 5.0;
        spot.sample(from, [0.5; 2], 0.0).map_or(0.0, |s| s.scale * 25.0)
    };
    // Half way between the cosines half of the intensity is left, by symmetry of 3x² − 2x³.
    for (cos, share) in [(1.0, 1.0), (0.9, 1.0), (0.75, 0.5), (0.6, 0.0), (-1.0, 0.0)] {
        let read = intensity(direction(-cos, 0.3));
        assert!((read - share).abs() < 1e-14, "{cos}: {read} is not {share}");
    }
    // ∫ I dω = 2π(1 − (cos i + cos o)/2), by midpoints.
    let n = 10_000;
    let power: f64 = (0..n)
        .map(|i| intensity(direction((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0, 0.0)) * 4.0 * PI / f64::from(n))
        .sum();
    assert!((power - 2.0 * PI * (1.0 - 0.75)).abs() < 1e-6, "{power}");
}

/// Mean Y over 8 seeds.
fn read(json: &Value) -> Welford {
    let (mut scene, _) = etalon_scene::parse(&json.to_string(), "test").unwrap_or_else(|e| panic!("{e:?}"));
    scene.integrator.replicates = 1;
    let mut prepared = prepare(&scene).unwrap();
    let mut estimate = Welford::default();
    for seed in 0..8 {
        prepared.reseed(seed);
        let whole = prepared.whole(Some(1));
        estimate.push(prepared.render(&whole, &|_| Control::Continue).unwrap().mean_y(whole.rect));
    }
    estimate
}

/// A sheet of opacity 0.4 hangs under a disk light of radius 1 at height 1 over a white floor of albedo 1: the floor's radiance
/// is E/π = 0.5·0.6, by shadow rays, by the walk and by both, and even two edges of a path reach the lamp through it. The
/// sheet is black.
#[test]
fn a_mask_passes_its_share_to_shadow_rays_and_to_the_walk_alike() {
    let scene = |sampling: &str, opacity: f64| {
        json!({
            "etalon": 1,
            "camera": {
                "type": "orthographic", "position_m": [0, 0.2, 0], "direction": [0, -1, 0], "up": [0, 0, 1], "height_m": 1e-6
            },
            "film": {"width": 2, "height": 2},
            "objects": [
                {
                    "material": {"type": "lambert", "reflectance": 1},
                    "shape": {"type": "disk", "normal": [0, 1, 0], "radius_m": 0.5}
                },
                {
                    "material": {"type": "black"}, "opacity": opacity,
                    "shape": {"type": "disk", "center_m": [0, 0.5, 0], "normal": [0, 1, 0], "radius_m": 4}
                },
                {
                    "material": {"type": "black"}, "emission": {"radiance": 1},
                    "shape": {"type": "disk", "center_m": [0, 1, 0], "normal": [0, -1, 0], "radius_m": 1}
                }
            ],
            "integrator": {"spp": 4096, "max_depth": 2, "light_sampling": sampling}
        })
    };
    for sampling in ["mis", "light", "bsdf"] {
        for opacity in [0.4, 1.0] {
            let estimate = read(&scene(sampling, opacity));
            let (mean, error) = (estimate.mean(), estimate.standard_error());
            let truth = 0.5 * (1.0 - opacity);
            // Counting the lamp twice, or once where a mask is met, would be off by a factor of two.
            assert!(error < 2e-3, "{sampling}: the test sees too little, {error}");
            assert!(
                (mean - truth).abs() <= 5.0 * error + 1e-12,
                "{sampling} {opacity}: {mean} ± {error} is not {truth}"
            );
        }
    }
}

/// Rough flint under a lamp, lit by shadow rays, by the walk and by both: lanes whose densities differ must add up to the
/// same light. |t| < 6 with 7 + 7 degrees of freedom; a bias of 9 % would be seen.
#[test]
fn every_strategy_finds_the_same_light_through_rough_flint() {
    let scene = |sampling: &str| {
        json!({
            "etalon": 1,
            "camera": {
                "type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40
            },
            "film": {"width": 8, "height": 8},
            "objects": [
                {
                    "material": {
                        "type": "dielectric", "alpha": 0.3, "interior": {"type": "glass", "name": "N-SF11", "outside_fit": "clamp"}
                    },
                    "shape": {"type": "box", "min_m": [-2, -2, -0.5], "max_m": [2, 2, 0.5]},
                    "transform": [{"rotate": {"axis": [0, 1, 0], "angle_deg": 40}}]
                },
                {
                    "material": {"type": "black"}, "emission": {"radiance": 1, "sides": "both"},
                    "shape": {"type": "disk", "center_m": [0, 0, -2.5], "normal": [0, 0, 1], "radius_m": 1.5}
                }
            ],
            "integrator": {"spp": 256, "light_sampling": sampling}
        })
    };
    let reference = read(&scene("mis"));
    for sampling in ["light", "bsdf"] {
        let other = read(&scene(sampling));
        let error = reference.standard_error().hypot(other.standard_error());
        let (a, b) = (other.mean(), reference.mean());
        assert!(error < 0.015 * b, "{sampling}: the test sees too little, {error} of {b}");
        assert!(((a - b) / error).abs() < 6.0, "{sampling}: {a} is not {b} ± {error}");
    }
}

/// An image of one texel.
fn texel(value: f32) -> ImageTexture {
    ImageTexture::new(Image::new(1, 1, Texels::F32(vec![[value; 3]])))
}

/// What an image says of a material is what the material is where the image says it, to the bit where no neighbour has a share.
#[test]
fn a_material_by_images_is_the_material_that_they_say() {
    let rough = |alpha: f64| MaterialKind::Plastic {
        reflectance: Spectrum::Constant(0.5).into(),
        coat: RefractiveIndex::Constant(1.5),
        facets: Some(alpha.into()),
        internal_reflection: InternalReflection::Coloured,
        compensated: true,
    };
    let places = [0.25, 0.5, 1.0];
    let varied = |roughness: f32| MaterialKind::Blend {
        parts: places.map(|r| (r, rough(r * r))).to_vec(),
        by: NumberTexture::Image(texel(roughness)),
    };
    let directions = [(direction(0.9, 0.0), direction(0.8, 0.4)), (direction(0.3, 0.0), direction(0.5, 0.7))];
    let at = Shading::flat(Vec3::new(0.0, 0.0, 1.0));
    let eval = |kind: &MaterialKind, (wo, wi): (Vec3<f64>, Vec3<f64>)| {
        Bsdf::new(kind, RANGE_NM).eval::<1>(&Lanes([550.0]), &at, wo, wi)
    };
    for pair in directions {
        let own = places.map(|r| eval(&rough(r * r), pair));
        for (roughness, expected) in [(0.25, own[0]), (0.5, own[1]), (1.0, own[2]), (0.125, own[0])] {
            assert_eq!(eval(&varied(roughness), pair), expected, "{roughness}");
        }
        // A quarter of the way from the second to the third.
        let (f, density) = eval(&varied(0.625), pair);
        for (between, [from, to]) in [(f, [own[1].0, own[2].0]), (density, [own[1].1, own[2].1])] {
            let expected = 0.75 * from[0] + 0.25 * to[0];
            assert!((between[0] - expected).abs() < 1e-15, "{between:?} {expected}");
        }
        // Grounds and metals by images of one colour.
        let painted = |reflectance: SpectrumTexture| MaterialKind::Plastic {
            reflectance,
            coat: RefractiveIndex::Constant(1.5),
            facets: None,
            internal_reflection: InternalReflection::Coloured,
            compensated: true,
        };
        let image = || SpectrumTexture::Image(texel(0.5));
        let uniform = || SpectrumTexture::from(Spectrum::Constant(0.5));
        let (a, b) = (eval(&painted(image()), pair), eval(&painted(uniform()), pair));
        assert!((a.0[0] - b.0[0]).abs() < 1e-12 * b.0[0], "{a:?} {b:?}");
        let metal = |r| MaterialKind::RoughConductor {
            metal: Metal::Reflectance(r),
            facets: 0.3.into(),
            compensated: true,
            film: None,
        };
        // k²/(4 + k²) is one half.
        let index = ComplexIndex::tabulated(vec![300.0, 900.0], vec![1.0; 2], vec![2.0; 2]).unwrap();
        let exact = MaterialKind::RoughConductor {
            metal: Metal::Index(index),
            facets: 0.3.into(),
            compensated: true,
            film: None,
        };
        let (a, b, c) = (eval(&metal(image()), pair), eval(&metal(uniform()), pair), eval(&exact, pair));
        // What light that meets several facets adds is tabulated in steps of 1/256 of √R.
        for found in [a, b] {
            assert!((found.0[0] - c.0[0]).abs() < 1e-5 * c.0[0], "{found:?} {c:?}");
        }
    }
}

/// Seen and lit from the side that the normal points into or away from, a plate shows ρE cos/π where it reflects and nothing elsewhere.
#[test]
fn a_one_sided_plate_is_black_from_behind() {
    let shown = |material: &Value, z: f64| {
        let scene = json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 2.0 * z], "look_at_m": [0, 0, 0], "height_m": 0.1},
            "film": {"width": 2, "height": 2},
            "objects": [{"shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 0, 1], "radius_m": 1}, "material": material}],
            "lights": [{"type": "directional", "direction": [0.6, 0, -0.8 * z], "irradiance": 1}],
            "integrator": {"spp": 4}
        });
        let (scene, _) = etalon_scene::parse(&scene.to_string(), "test").unwrap();
        let prepared = prepare(&scene).unwrap();
        let film = prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap();
        film.xyz().map(|xyz| xyz[1]).sum::<f64>() / 4.0
    };
    for (kind, number) in [("lambert", 0.5), ("plastic", 0.5), ("conductor", 0.5), ("oren-nayar", 0.5)] {
        let material = |sides: &str| {
            let mut material = json!({"type": kind, "reflectance": number, "sides": sides});
            match kind {
                "conductor" => material["alpha"] = json!(0.5),
                "oren-nayar" => material["roughness"] = json!(0.3),
                _ => {}
            }
            material
        };
        let both = [1.0, -1.0].map(|z| shown(&material("both"), z));
        assert!(both[0] > 0.0 && (both[0] / both[1] - 1.0).abs() < 1e-12, "{kind}: {both:?}");
        for (sides, expected) in [("front", [both[0], 0.0]), ("back", [0.0, both[1]])] {
            assert_eq!([1.0, -1.0].map(|z| shown(&material(sides), z)), expected, "{kind} {sides}");
        }
    }
    // ρ cos/π, by the constant spectrum's own Y.
    let white = shown(&json!({"type": "lambert", "reflectance": 1}), 1.0);
    let half = shown(&json!({"type": "lambert", "reflectance": 0.5, "sides": "front"}), 1.0);
    assert!((half / white - 0.5).abs() < 1e-12, "{half} of {white}");
}
