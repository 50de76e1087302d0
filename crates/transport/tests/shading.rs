//! Shading normals: what is known exactly about scattering around a normal that is not the surface's.

use etalon_optics::{Lanes, RefractiveIndex, Spectrum, Vec3};
use etalon_scene::{MaterialKind, Scene};
use etalon_transport::bsdf::{Bsdf, Shading};
use etalon_transport::mis::Density;
use etalon_transport::warp::uniform_sphere;
use etalon_transport::{Control, prepare};
use proptest::prelude::*;
use std::f64::consts::PI;

const LAMBDA_NM: Lanes<f64, 4> = Lanes([440.0, 520.0, 600.0, 680.0]);
const UP: Vec3<f64> = Vec3 { x: 0.0, y: 0.0, z: 1.0 };

fn lambert(albedo: f64) -> Bsdf {
    Bsdf::new(&MaterialKind::Lambert { reflectance: Spectrum::Constant(albedo).into() }, [380.0, 780.0])
}

fn direction(u: [f64; 2]) -> Vec3<f64> {
    uniform_sphere(u)
}

fn bent(tilt: f64, turns: f64) -> Shading<'static> {
    let (sin_phi, cos_phi) = (turns * 2.0 * PI).sin_cos();
    Shading::flat(UP).bent_to(Vec3::new(tilt.sin() * cos_phi, tilt.sin() * sin_phi, tilt.cos()).normalized())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Under a sky of radiance 1 each sample of a diffuse surface is worth its albedo, whatever the normal and the viewer:
    /// the furnace holds without noise.
    #[test]
    fn a_bent_diffuse_surface_loses_and_gains_no_light(
        tilt in 0.0..1.5_f64, turns in 0.0..1.0_f64, view in any::<[u16; 2]>(), u in any::<[u16; 2]>(),
    ) {
        let unit = |v: [u16; 2]| v.map(|v| (f64::from(v) + 0.5) / 65536.0);
        let (at, wo) = (bent(tilt, turns), direction(unit(view)));
        let [u1, u2] = unit(u);
        let s = lambert(0.7).sample::<4>(&LAMBDA_NM, &at, wo, [0.5, u1, u2]).unwrap();
        prop_assert!((s.weight[0] - 0.7).abs() < 1e-12, "{}", s.weight[0]);
        // No light comes through the triangle.
        prop_assert!(at.normal.dot(s.wi) * at.normal.dot(wo) > 0.0);
        let (f_cos, density) = lambert(0.7).eval::<4>(&LAMBDA_NM, &at, wo, s.wi);
        let density = density[0];
        prop_assert_eq!(Density::SolidAngle(density), s.density);
        prop_assert!((f_cos[0] - 0.7 * density).abs() <= 1e-12 * density);
    }

    /// Light from one direction: ρ/π·cos θ about the shading normal, and nothing from behind the triangle.
    #[test]
    fn direct_light_follows_the_shading_normal_on_the_side_of_the_triangle(
        tilt in 0.01..0.4_f64, turns in 0.0..1.0_f64, view in 0.05..1.0_f64, light in any::<[u16; 2]>(),
    ) {
        let at = bent(tilt, turns);
        let wi = direction(light.map(|v| (f64::from(v) + 0.5) / 65536.0));
        let wo = Vec3::new((1.0 - view * view).sqrt(), 0.0, view);
        let (f_cos, _) = lambert(0.5).eval::<4>(&LAMBDA_NM, &at, wo, wi);
        let mirrored = Vec3::new(wi.x, wi.y, -wi.z);
        let expected = match wi.z > 0.0 {
            true => 0.5 / PI * (at.shading_normal().dot(wi).max(0.0) + at.shading_normal().dot(mirrored).max(0.0)),
            false => 0.0,
        };
        prop_assert!((f_cos[0] - expected).abs() < 1e-13, "{} is not {expected}", f_cos[0]);
        // High above both horizons there is no mirror image.
        if wi.z > (2.0 * tilt).sin() {
            prop_assert!((f_cos[0] - 0.5 / PI * at.shading_normal().dot(wi)).abs() < 1e-13);
        }
    }

    /// The density that sampling states is the one that it draws by: it integrates to 1 over the sphere.
    #[test]
    fn glass_and_mirrors_stay_on_the_side_that_they_chose(
        tilt in 0.0..1.2_f64, turns in 0.0..1.0_f64, view in any::<[u16; 2]>(), u in 0.0..1.0_f64,
    ) {
        let (at, wo) = (bent(tilt, turns), direction(view.map(|v| (f64::from(v) + 0.5) / 65536.0)));
        let mirror = Bsdf::new(&MaterialKind::Mirror { reflectance: Spectrum::ONE.into() }, [380.0, 780.0]);
        let s = mirror.sample::<4>(&LAMBDA_NM, &at, wo, [u, 0.5, 0.5]).unwrap();
        prop_assert!(s.wi.z * wo.z > 0.0 && s.weight[0] == 1.0);
        let (interior, exterior) = (RefractiveIndex::constant(1.5).unwrap(), RefractiveIndex::constant(1.0).unwrap());
        let glass = Bsdf::new(&MaterialKind::Dielectric { interior, exterior, priority: None, film: None }, [380.0, 780.0]);
        let s = glass.sample::<4>(&LAMBDA_NM, &at, wo, [u, 0.5, 0.5]).unwrap();
        let crosses = s.wi.z * wo.z < 0.0;
        let eta = if wo.z > 0.0 { 1.5 } else { 1.0 / 1.5 };
        prop_assert_eq!(crosses, s.eta != 1.0);
        prop_assert!(!crosses || (s.eta - eta).abs() < 1e-15);
        prop_assert!((s.wi.length() - 1.0).abs() < 1e-14);
    }
}

#[test]
fn the_density_around_a_bent_normal_integrates_to_one() {
    for (tilt, turns) in [(0.3, 0.1), (1.0, 0.7), (1.5, 0.4)] {
        let (at, wo) = (bent(tilt, turns), Vec3::new(0.6, 0.0, 0.8));
        let n = 1000;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = [(f64::from(i % n) + 0.5) / f64::from(n), (f64::from(i / n) + 0.5) / f64::from(n)];
            sum += lambert(1.0).eval::<4>(&LAMBDA_NM, &at, wo, direction(u)).1[0];
        }
        let integral = sum * 4.0 * PI / f64::from(n * n);
        // The midpoint rule's error at the horizon, where the density is continuous, is of second order in 1/1000.
        assert!((integral - 1.0).abs() < 1e-4, "{integral}");
    }
}

/// The share of light that a scattering of albedo 1 reflects on the side of the viewer, by midpoints over the sphere.
fn reflected(f_cos: impl Fn(Vec3<f64>) -> f64) -> f64 {
    let n = 400;
    let at = |i: i32| direction([(f64::from(i % n) + 0.5) / f64::from(n), (f64::from(i / n) + 0.5) / f64::from(n)]);
    (0..n * n).map(|i| f_cos(at(i))).sum::<f64>() * 4.0 * PI / f64::from(n * n)
}

#[test]
fn scattering_that_drops_or_leaks_what_crosses_the_triangle_is_told_from_ours() {
    let (tilt, wo) = (0.8, UP);
    let at = bent(tilt, 0.0);
    let around = |wi: Vec3<f64>| at.shading_normal().dot(wi).max(0.0) / PI;
    let ours = reflected(|wi| lambert(1.0).eval::<4>(&LAMBDA_NM, &at, wo, wi).0[0]);
    // The midpoint rule's error at the horizons.
    assert!((ours - 1.0).abs() < 1e-3, "{ours}");
    // Dropping what crosses loses (1 − cos δ)/2 of the light, a black rim on every ball.
    let dropping = reflected(|wi| if wi.z > 0.0 { around(wi) } else { 0.0 });
    assert!((dropping - 0.5 * (1.0 + tilt.cos())).abs() < 1e-3, "{dropping}");
    // Letting the shading normal decide lets as much through the wall.
    let leaking = reflected(|wi| if wi.z < 0.0 { around(wi) } else { 0.0 });
    assert!(
        leaking > 0.1
            && reflected(|wi| if wi.z < 0.0 { lambert(1.0).eval::<4>(&LAMBDA_NM, &at, wo, wi).0[0] } else { 0.0 })
                == 0.0
    );
}

/// The picture of a shape under parallel light along the view, as luminances.
fn lit(shape: &str) -> Vec<f64> {
    let text = format!(
        r#"{{"etalon": 1, "film": {{"width": 32, "height": 32}},
        "camera": {{"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 1.8}},
        "objects": [{{"shape": {shape}, "material": {{"type": "lambert", "reflectance": 0.5}}}}],
        "lights": [{{"type": "directional", "direction": [0.2, -0.3, -1], "irradiance": 3}}],
        "integrator": {{"spp": 16, "max_depth": 2}}}}"#
    );
    let scene: Scene = etalon_scene::parse(&text, "ball.json").unwrap_or_else(|e| panic!("{}", e.summary())).0;
    let prepared = prepare(&scene).unwrap();
    let film = prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap();
    let luminance = |p: &[f32; 3]| p.iter().zip([0.2126, 0.7152, 0.0722]).map(|(v, y)| f64::from(*v) * y).sum();
    film.linear_rec709().iter().map(luminance).collect()
}

/// A unit sphere as a mesh of `rings` rings.
fn ball(rings: u32, shading: &str) -> String {
    let columns = 2 * rings;
    let (mut vertices, mut triangles) = (vec![[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]], Vec::new());
    for i in 1..rings {
        for j in 0..columns {
            let (theta, phi) = (PI * f64::from(i) / f64::from(rings), 2.0 * PI * f64::from(j) / f64::from(columns));
            vertices.push([theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()]);
        }
    }
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == rings => 1,
        i => 2 + (i - 1) * columns + j % columns,
    };
    for i in 0..rings {
        for j in 0..columns {
            if i + 1 < rings {
                triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
            }
            if i > 0 {
                triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            }
        }
    }
    format!(
        r#"{{"type": "mesh", "vertices_m": {vertices:?}, "triangles": {triangles:?}, "normals": {vertices:?},
            "shading": "{shading}"}}"#
    )
}

#[test]
fn a_smooth_mesh_converges_to_the_ball_that_it_stands_for() {
    // The same random numbers: the noise of wavelengths is the same in both pictures.
    let exact = lit(r#"{"type": "sphere", "radius_m": 1}"#);
    // Away from the silhouette, where the chords of the mesh cut into the disk.
    let inner = |i: usize| {
        let [x, y] = [i % 32, i / 32].map(|k| 0.9 * (2.0 * (k as f64 + 0.5) / 32.0 - 1.0));
        x * x + y * y < 0.6
    };
    let error = |rings: u32, shading: &str| {
        let picture = lit(&ball(rings, shading));
        (0..32 * 32).filter(|&i| inner(i)).map(|i| (picture[i] - exact[i]).abs()).fold(0.0, f64::max)
    };
    let smooth = [12, 24, 48].map(|rings| error(rings, "auto"));
    // Interpolated normals and chords are both off by the square of a triangle's size: a quarter each time.
    assert!(smooth[0] < 0.02, "{smooth:?}");
    assert!(smooth[1] < 0.4 * smooth[0] && smooth[2] < 0.4 * smooth[1], "{smooth:?}");
    // Flat triangles are off by their size.
    let flat = error(24, "flat");
    assert!(flat > 4.0 * smooth[1], "{flat} {smooth:?}");
}
