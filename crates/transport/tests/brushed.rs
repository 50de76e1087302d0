//! Brushed surfaces, whose facets have two widths: albedos against independent quadrature, and where their grain comes from.

use etalon_optics::{ComplexIndex, Lanes, RefractiveIndex, Vec3};
use etalon_oracle::laws::{Masking, anisotropic_ggx_albedo, anisotropic_ggx_mirrors};
use etalon_scene::{MaterialKind, Metal, Microfacets, Scene};
use etalon_transport::Study;
use etalon_transport::bsdf::{Bsdf, Shading};
use serde_json::{Value, json};

use crate::common::rendering::{mean_y, parse, render};

const RANGE_NM: [f64; 2] = [380.0, 780.0];

fn facets([alpha_u, alpha_v]: [f64; 2], rotation_deg: f64) -> Microfacets {
    Microfacets::ggx([alpha_u, alpha_v], rotation_deg.to_radians())
}

/// Reflects everything: n → 0 with k > 0.
fn mirrors(facets: Microfacets, compensated: bool) -> Bsdf {
    let index = ComplexIndex::tabulated(vec![300.0, 900.0], vec![1e-12; 2], vec![3.0; 2]).unwrap();
    Bsdf::new(&MaterialKind::RoughConductor { metal: Metal::Index(index), facets, compensated, film: None }, RANGE_NM)
}

fn glass(facets: Microfacets, compensated: bool) -> Bsdf {
    let (interior, exterior) = (RefractiveIndex::Constant(1.5), RefractiveIndex::VACUUM);
    Bsdf::new(
        &MaterialKind::RoughDielectric { interior, exterior, facets, compensated, priority: None, film: None },
        RANGE_NM,
    )
}

/// Of this cosine, turned from x toward y.
fn direction(mu: f64, turn_deg: f64) -> [f64; 3] {
    let (across, (sin, cos)) = (((1.0 - mu) * (1.0 + mu)).sqrt(), turn_deg.to_radians().sin_cos());
    [across * cos, across * sin, mu]
}

/// A place whose u grows along +x, its v toward +y, though not at right angles.
fn place() -> Shading<'static> {
    Shading::flat(Vec3::new(0.0, 0.0, 1.0)).with_tangents([Vec3::new(3.0, 0.0, 0.0), Vec3::new(-0.5, 0.2, 0.0)])
}

/// Well spread points for three numbers: for smooth means the error falls nearly as 1/n.
fn points(n: u32) -> impl Iterator<Item = [f64; 3]> {
    let g = 1.220_744_084_605_759_5_f64;
    (0..n).map(move |i| [1.0 / g, 1.0 / (g * g), 1.0 / (g * g * g)].map(|a| (0.5 + a * f64::from(i)) % 1.0))
}

/// (reflected, transmitted) shares of light seen along `wo`, n² taken out, as the samples have it.
fn shares(bsdf: &Bsdf, wo: [f64; 3], n: u32) -> [f64; 2] {
    let (at, mut sums) = (place(), [0.0; 2]);
    for u in points(n) {
        if let Some(s) = bsdf.sample(&Lanes([550.0]), &at, Vec3::from_array(wo), u) {
            sums[usize::from(s.wi.z * wo[2] < 0.0)] += s.weight[0] * s.eta * s.eta / f64::from(n);
        }
    }
    sums
}

/// 2¹⁸ points of a low-discrepancy sequence: their error here is below 1.5e-3.
#[test]
fn single_scattering_has_the_albedo_of_an_independent_quadrature() {
    for (alpha, rotation, mu, turn) in
        [([0.1, 0.6], 0.0, 0.3, 0.0), ([0.1, 0.6], 0.0, 0.3, 90.0), ([0.9, 0.2], 35.0, 0.25, 60.0)]
    {
        let of = |alpha: [f64; 2], rotation: f64, eta: Option<f64>| {
            anisotropic_ggx_albedo(alpha, direction(mu, turn - rotation), eta, Masking::Correlated)
        };
        let wo = direction(mu, turn);
        let [read, _] = shares(&mirrors(facets(alpha, rotation), false), wo, 1 << 18);
        let truth = of(alpha, rotation, None).reflected;
        assert!((read - truth).abs() < 1.5e-3, "metal {alpha:?} {rotation} {mu} {turn}: {read} is not {truth}");
        // Known mistakes lie far from it.
        let exchanged = of([alpha[1], alpha[0]], rotation, None).reflected;
        assert!((read - exchanged).abs() > 0.02, "{read} is also that of exchanged widths");
        if rotation != 0.0 {
            for wrong in [0.0, -rotation] {
                let wrong = of(alpha, wrong, None).reflected;
                assert!((read - wrong).abs() > 0.01, "{read} is also that of another grain, {wrong}");
            }
        }
        // From inside the frame is turned over, and the grain is not.
        for (inside, eta) in [(false, 1.5), (true, 1.0 / 1.5)] {
            let truth = of(alpha, rotation, Some(eta));
            let wo = if inside { [wo[0], wo[1], -wo[2]] } else { wo };
            let [reflected, refracted] = shares(&glass(facets(alpha, rotation), false), wo, 1 << 18);
            assert!((reflected - truth.reflected).abs() < 1.5e-3, "{alpha:?} {mu} η {eta}: {reflected}, {truth:?}");
            assert!((refracted - truth.refracted).abs() < 1.5e-3, "{alpha:?} {mu} η {eta}: {refracted}, {truth:?}");
        }
    }
}

/// In a white furnace what absorbs nothing cannot be seen, seen along the grain, across it and between.
#[test]
fn a_lossless_brushed_metal_returns_all_light_and_no_more() {
    for alpha in [[0.05, 0.5], [1.0, 0.2], [1e-3, 0.3]] {
        let metal = mirrors(facets(alpha, 20.0), true);
        for (mu, turn) in [(1.0, 0.0), (0.2, 20.0), (0.2, 65.0), (0.03, 110.0)] {
            let read = shares(&metal, direction(mu, turn), 1 << 16)[0];
            // As of one width: the 2¹⁶ points leave an error of some 4e-3 where half the light is diffuse.
            assert!((-1e-2..6e-3).contains(&(read - 1.0)), "α {alpha:?}, µ {mu}, {turn}°: {read}");
        }
    }
}

/// Glass of two widths is never compensated, so it returns less than all light from either side, and the same whether a scene asks or not.
#[test]
fn brushed_glass_returns_no_more_than_all_light() {
    for alpha in [[0.05, 0.5], [1.0, 0.2], [1e-3, 0.3]] {
        let [asked, glass] = [true, false].map(|compensated| glass(facets(alpha, 20.0), compensated));
        for (mu, turn) in [(1.0, 0.0), (0.2, 20.0), (0.2, 65.0), (0.03, 110.0)] {
            let wo = direction(mu, turn);
            for wo in [wo, [wo[0], wo[1], -wo[2]]] {
                let read = shares(&glass, wo, 1 << 14);
                assert_eq!(shares(&asked, wo, 1 << 14), read);
                // Each sample passes on at most what it received.
                assert!(read.iter().sum::<f64>() <= 1.0, "α {alpha:?}, {wo:?}: {read:?}");
            }
        }
    }
}

/// Towards equal widths nothing changes but rounding and the tables, and a turn of the grain counts for nothing there.
#[test]
fn nearly_equal_widths_are_nearly_one() {
    let (wo, wi) = (Vec3::from_array(direction(0.5, 20.0)), Vec3::from_array(direction(0.7, 230.0)));
    // Glass of two widths is never compensated.
    for (make, compensated) in [(mirrors as fn(Microfacets, bool) -> Bsdf, false), (mirrors, true), (glass, false)] {
        let eval = |alpha: [f64; 2], rotation: f64| {
            let bsdf = make(facets(alpha, rotation), compensated);
            bsdf.eval::<1>(&Lanes([550.0]), &place(), wo, wi)
        };
        let ((f, density), (f_near, density_near)) = (eval([0.4, 0.4], 0.0), eval([0.4, 0.4 + 1e-7], 50.0));
        // Tables of losses are known to 1e-4 of them.
        assert!((f[0] / f_near[0] - 1.0).abs() < 3e-4, "{f:?} {f_near:?}");
        assert!((density[0] / density_near[0] - 1.0).abs() < 3e-4, "{density:?} {density_near:?}");
        assert_eq!(eval([0.4, 0.4], 50.0), (f, density));
    }
}

const ALPHA: [f64; 2] = [0.6, 0.15];

/// A brushed plate at z = 0 seen from +z under light 50° off its normal, 25° from +x toward +y.
fn lit(shape: &Value, alpha: [f64; 2], rotation_deg: f64, more: &Value) -> Scene {
    let metal = json!({
        "type": "conductor", "wavelengths_nm": [300, 900], "n": [1e-12, 1e-12], "k": [3, 3], "multiple_scattering": "lost",
        "alpha_u": alpha[0], "alpha_v": alpha[1], "tangent_rotation_deg": rotation_deg
    });
    under_light(shape, &metal, more)
}

fn under_light(shape: &Value, material: &Value, more: &Value) -> Scene {
    let light = direction(50.0_f64.to_radians().cos(), 25.0).map(|v| -v);
    let mut object = json!({"shape": shape, "material": material});
    for (key, value) in more.as_object().unwrap() {
        object[key] = value.clone();
    }
    parse(
        &json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "up": [0, 1, 0], "height_m": 0.1},
            "film": {"width": 4, "height": 4},
            "objects": [object],
            "lights": [{"type": "directional", "direction": light, "irradiance": 1}],
            "integrator": {"spp": 4}
        })
        .to_string(),
    )
}

/// What it shows over what a white plate does, by the same wavelengths: f cos θ.
fn shown(shape: &Value, rotation_deg: f64, more: &Value) -> f64 {
    let metal = mean_y(&render(&lit(shape, ALPHA, rotation_deg, more), &Study::default()));
    let white = under_light(shape, &json!({"type": "lambert", "reflectance": 1}), more);
    metal / mean_y(&render(&white, &Study::default())) * 50.0_f64.to_radians().cos() / std::f64::consts::PI
}

/// What it shows if its grain is turned from +x toward +y by so much.
fn highlight(alpha: [f64; 2], grain_deg: f64) -> f64 {
    let mu = 50.0_f64.to_radians().cos();
    anisotropic_ggx_mirrors(alpha, [0.0, 0.0, 1.0], direction(mu, 25.0 - grain_deg)) * mu
}

/// A square of two triangles with these texture coordinates at (−1, −1), (1, −1), (1, 1) and (−1, 1).
fn square(uvs: [[f64; 2]; 4]) -> Value {
    json!({"type": "mesh", "vertices_m": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], "triangles": [[0, 1, 2], [0, 2, 3]], "uvs": uvs})
}

#[test]
fn the_grain_runs_as_texture_coordinates_say() {
    let plate = |u: [f64; 3], v: [f64; 3]| {
        let origin: Vec<f64> = (0..3).map(|i| -0.5 * (u[i] + v[i])).collect();
        json!({"type": "parallelogram", "origin_m": origin, "u_m": u, "v_m": v})
    };
    let (x, y) = ([2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    let none = json!({});
    let turned = |deg: f64| json!({"transform": [{"rotate": {"axis": [0, 0, 1], "angle_deg": deg}}]});
    let mirrored = json!({"transform": [{"scale": [-1, 1, 1]}]});
    let disk = json!({"type": "disk", "center_m": [0, 0, 0], "normal": [0, 0, 1], "radius_m": 1});
    for (what, shape, rotation, more, grain) in [
        ("u along x", plate(x, y), 0.0, &none, 0.0),
        ("u along x, turned", plate(x, y), 30.0, &none, 30.0),
        // Seen from the back: v grows to the right of u there, and the grain still turns toward it.
        ("u along y", plate(y, x), 30.0, &none, 60.0),
        ("aslant", plate([2.0, 2.0, 0.0], y), 10.0, &none, 55.0),
        ("a turned plate", plate(x, y), 0.0, &turned(40.0), 40.0),
        ("a mirrored plate", plate(x, y), 30.0, &mirrored, -30.0),
        ("a disk", disk, 20.0, &none, 20.0),
        ("a mesh", square([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), 30.0, &none, 30.0),
        ("a mesh with u along y", square([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]), 30.0, &none, 60.0),
        ("a mesh with u toward −x", square([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0]]), 30.0, &none, 150.0),
    ] {
        let (read, truth) = (shown(&shape, rotation, more), highlight(ALPHA, grain));
        // The metal absorbs a trifle. Rounding does the rest.
        assert!((read / truth - 1.0).abs() < 1e-9, "{what}: {read} is not {truth}");
    }
}

/// Across the equator of a ball the longitude runs along u, and along its meridian v.
#[test]
fn the_grain_of_a_ball_runs_around_it() {
    // The camera looks along −z at the point (0, 0, 1) of the ball, where u grows along +x and v along +y.
    let ball = json!({"type": "sphere", "center_m": [0, 0, -1000], "radius_m": 1000});
    for rotation in [0.0, 30.0] {
        let (read, truth) = (shown(&ball, rotation, &json!({})), highlight(ALPHA, rotation));
        // On a ball of a kilometre normals within the picture lie 5e-5 off the middle's, and the light changes by six times that.
        assert!((read / truth - 1.0).abs() < 3e-4, "{rotation}: {read} is not {truth}");
    }
}
