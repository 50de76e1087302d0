//! Snell's law at every surface, lenses turned round, aspheres that are spheres, pupils that hold all light.

use super::*;
use proptest::prelude::*;
use std::sync::LazyLock;

const D_NM: f64 = 587.5618;

fn surface(radius_mm: f64, thickness_mm: f64, index: f64, semi_aperture_mm: f64) -> LensSurface {
    LensSurface {
        curvature_per_m: if radius_mm == 0.0 { 0.0 } else { 1e3 / radius_mm },
        conic: 0.0,
        aspheric: Vec::new(),
        thickness_m: 1e-3 * thickness_mm,
        medium: RefractiveIndex::constant(index).unwrap(),
        semi_aperture_m: 1e-3 * semi_aperture_mm,
        is_stop: false,
    }
}

/// A double Gauss lens of 50 mm at f/2 (A. W. Tronnier, US patent 2 673 491).
fn double_gauss() -> CompoundLens {
    let mut surfaces = vec![
        surface(29.475, 3.76, 1.67, 12.6),
        surface(84.83, 0.12, 1.0, 12.6),
        surface(19.275, 4.025, 1.67, 11.5),
        surface(40.77, 3.275, 1.699, 11.5),
        surface(12.75, 5.705, 1.0, 9.0),
        surface(0.0, 4.5, 1.0, 8.55),
        surface(-14.495, 1.18, 1.603, 8.5),
        surface(40.77, 6.065, 1.658, 10.0),
        surface(-20.385, 0.19, 1.0, 10.0),
        surface(437.065, 3.22, 1.717, 10.0),
        surface(-39.73, 0.0, 1.0, 10.0),
    ];
    surfaces[5].is_stop = true;
    lens(surfaces, 36.0)
}

fn lens(surfaces: Vec<LensSurface>, film_mm: f64) -> CompoundLens {
    let coating = LensCoating::Ideal;
    CompoundLens { surfaces, coating, film_distance_m: 1e-3 * film_mm, film_height_m: 0.024, reference_nm: D_NM }
}

fn prepared(lens: &CompoundLens) -> PreparedLens {
    PreparedLens::new(lens, 1.5, [1.0; 2], [400.0, 700.0]).unwrap()
}

/// That lens, the same turned round, and the same of aspheres without coefficients.
static DOUBLE_GAUSS: LazyLock<PreparedLens> = LazyLock::new(|| prepared(&double_gauss()));
static TURNED: LazyLock<PreparedLens> = LazyLock::new(|| prepared(&turned(&double_gauss())));
static ASPHERIC: LazyLock<PreparedLens> = LazyLock::new(|| {
    let mut aspheric = double_gauss();
    aspheric.surfaces.iter_mut().for_each(|surface| surface.aspheric = vec![0.0; 3]);
    prepared(&aspheric)
});
/// That lens wide open, half closed, and with its iris shut to a point.
static IRISES: LazyLock<[PreparedLens; 3]> = LazyLock::new(|| {
    [1.0, 0.5, 0.002].map(|share| {
        let mut lens = double_gauss();
        lens.surfaces[5].semi_aperture_m *= share;
        prepared(&lens)
    })
});

/// The same lens with its other end toward the film.
fn turned(lens: &CompoundLens) -> CompoundLens {
    let count = lens.surfaces.len();
    let turn = |i: usize| {
        let thickness_m = if i == 0 { 0.0 } else { lens.surfaces[i - 1].thickness_m };
        let own = &lens.surfaces[i];
        LensSurface {
            curvature_per_m: -own.curvature_per_m,
            aspheric: own.aspheric.iter().map(|a| -a).collect(),
            medium: lens.medium_before(i).clone(),
            thickness_m,
            ..own.clone()
        }
    };
    CompoundLens { surfaces: (0..count).rev().map(turn).collect(), ..lens.clone() }
}

proptest! {
    /// n sin θ along the surface is the same on both sides: n·d × N is kept.
    #[test]
    fn snell_holds_at_every_surface(
        radius_mm in prop_oneof![-200.0..-12.0_f64, 12.0..200.0_f64], conic in -3.0..0.9_f64, a4 in -2e3..2e3_f64,
        x in -5e-3..5e-3_f64, y in -5e-3..5e-3_f64, film in 0.0..0.02_f64, index in 1.3..2.0_f64,
    ) {
        let mut shape = surface(radius_mm, 0.0, 1.0, 10.0);
        (shape.conic, shape.aspheric) = (conic, vec![a4]);
        let media = Some([RefractiveIndex::VACUUM, RefractiveIndex::constant(index).unwrap()]);
        let interface = Interface { vertex_m: 0.05, most_m2: 1e-4, media, shape };
        let origin = Vec3::new(film, 0.0, 0.0);
        let ray = LensRay { origin, direction: (Vec3::new(x, y, 0.05) - origin).normalized() };
        let Some((at, normal)) = interface.meet(&ray) else { return Ok(()) };
        let q = at.x * at.x + at.y * at.y;
        // The point lies on the surface and on the ray, to a few roundings of 0.05.
        prop_assert!((0.05 - at.z - interface.shape.sag_m(q)).abs() < 1e-16);
        prop_assert!((at - ray.origin).cross(ray.direction).length() < 1e-16);
        let normal = normal.normalized();
        let Some(out) = interface.refract(&ray, at, normal, D_NM, None) else { return Ok(()) };
        let difference = ray.direction.cross(normal) - out.direction.cross(normal) * index;
        prop_assert!(difference.length() < 1e-14, "{difference:?}");
        prop_assert!((out.direction.length() - 1.0).abs() < 1e-14);
    }

    /// Light that comes back takes the same way.
    #[test]
    fn rays_are_reversible(x in -8e-3..8e-3_f64, y in -8e-3..8e-3_f64, film in 0.0..0.018_f64) {
        let (there, back) = (&*DOUBLE_GAUSS, &*TURNED);
        let origin = Vec3::new(film, 0.0, 0.0);
        let ray = LensRay { origin, direction: (Vec3::new(x, y, 0.036) - origin).normalized() };
        let Some((out, _)) = there.trace(ray, D_NM) else { return Ok(()) };
        // Seen from the other end: z counts from the other film.
        let z = |z: f64| 0.036 + there.front_m - z;
        let (o, d) = (out.origin, out.direction);
        let returns = LensRay { origin: Vec3::new(o.x, o.y, z(o.z)), direction: Vec3::new(-d.x, -d.y, d.z) };
        // Begun a little before the surface, as a ray from a film is.
        let returns = LensRay { origin: returns.origin - returns.direction * 0.01, ..returns };
        let (home, _) = back.trace(returns, D_NM).expect("the way is open");
        let at_film = home.origin + home.direction * ((z(0.0) - home.origin.z) / home.direction.z);
        // Ten refractions, each magnifying roundings of centimetres by a few.
        prop_assert!((at_film.x - film).abs() < 1e-13 && at_film.y.abs() < 1e-13, "{at_film:?}");
    }

    /// An asphere whose coefficients are 0 is found by Newton's method, and is the sphere.
    #[test]
    fn an_asphere_without_coefficients_is_the_sphere(x in -8e-3..8e-3_f64, y in -8e-3..8e-3_f64, film in 0.0..0.018_f64) {
        let origin = Vec3::new(film, 0.0, 0.0);
        let ray = LensRay { origin, direction: (Vec3::new(x, y, 0.036) - origin).normalized() };
        let [a, b] = [&*DOUBLE_GAUSS, &*ASPHERIC].map(|lens| lens.trace(ray, D_NM));
        prop_assert_eq!(a.is_some(), b.is_some());
        if let (Some((a, _)), Some((b, _))) = (a, b) {
            prop_assert!((a.origin - b.origin).length() < 1e-14 && (a.direction - b.direction).length() < 1e-13);
        }
    }

    /// Every ray that comes through was within the rectangle that points are drawn from.
    #[test]
    fn the_pupil_holds_all_light(
        film in 0.0..0.0216_f64, x in -0.01..0.01_f64, y in -0.01..0.01_f64, iris in 0..3_usize,
    ) {
        let prepared = &IRISES[iris];
        // Corners of the window: the points of the numbers 0 and 1.
        let [low, high] = [0.0, 1.0].map(|u| prepared.pupil.draw(film, [u; 2]).point_m);
        // Most of what is tried lies near it.
        let (x, y) = (0.5 * (low.x + high.x) + x * (high.x - low.x) * 100.0, y * (high.y - low.y) * 100.0);
        let origin = Vec3::new(film, 0.0, 0.0);
        let ray = LensRay { origin, direction: (Vec3::new(x, y, low.z) - origin).normalized() };
        if prepared.trace(ray, D_NM).is_some() {
            prop_assert!(x > low.x && x < high.x && y > low.y && y < high.y, "{x} {y} {low:?} {high:?}");
        }
    }
}

/// A uniform field of radiance 1 shows 1 on the axis, less at the rim; and the window is not much larger than the pupil.
#[test]
fn a_uniform_field_shows_one_on_the_axis() {
    let prepared = &*DOUBLE_GAUSS;
    let n = 256;
    let at = |film: [f64; 2]| {
        let numbers = (0..n * n).map(|i| [f64::from(i % n) + 0.5, f64::from(i / n) + 0.5].map(|u| u / f64::from(n)));
        let passed: Vec<f64> = numbers.filter_map(|u| prepared.ray(film, 1.5, u, D_NM)).map(|ray| ray.weight).collect();
        let count = f64::from(n * n);
        (passed.iter().sum::<f64>() / count, passed.len() as f64 / count)
    };
    let (mean, open) = at([0.0; 2]);
    // The rim of the pupil crosses four cells in 256 on each side; their errors have either sign.
    assert!((mean - 1.0).abs() < 2e-3, "{mean}");
    assert!(open > 0.5, "{open}");
    let (corner, _) = at([1.0; 2]);
    assert!(corner > 0.05 && corner < 0.6, "{corner}");
    let mirrored = at([-1.0, 1.0]).0;
    assert!((mirrored / corner - 1.0).abs() < 1e-2, "{mirrored} {corner}");
}

/// f/2 of a 50 mm lens focused far away: sin θ₀ = 1/4.
#[test]
fn the_cone_on_the_axis_is_that_of_the_f_number() {
    let mut lens = double_gauss();
    lens.film_distance_m = lens.image_distance_m(1e30, D_NM).unwrap();
    let f = lens.focal_length_m(D_NM);
    assert!((f - 0.05).abs() < 5e-4, "{f}");
    let prepared = prepared(&lens);
    let sine = (prepared.axial_irradiance / std::f64::consts::PI).sqrt();
    // The patent states f/2 to one digit.
    assert!((sine - 0.25).abs() < 0.01, "{sine}");
}
