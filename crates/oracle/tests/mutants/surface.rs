//! Where rays go and what they hit: refraction formulas, sphere and triangle intersection, and what goes wrong in them.

use etalon_oracle::{
    Verdict,
    double_double::DoubleDouble,
    generators::{Aim, ClosedMesh},
    laws,
    subjects::{Hit, Intersects},
};

use crate::vector::{Vec3, cross, dot, minus, plus, times, unit};

fn refract(fault: &str, d: Vec3, n: Vec3, eta: f64) -> Option<Vec3> {
    let c = -dot(n, d);
    let inverse = match fault {
        "the ratio upside down" => eta,
        _ => 1.0 / eta,
    };
    let square = 1.0 - inverse * inverse * (1.0 - c * c);
    match fault {
        // K = rD + (r(N·D) − √(1 − r²(1 − (N·D)²)))N, the sign of its N·D term being for −N·D.
        "equation (1) of the assignment" => {
            return Some(plus(times(inverse, d), inverse * dot(n, d) - square.sqrt(), n));
        }
        "total reflection where there is none" if square > 0.0 && square < 0.3 => return None,
        "the test for total reflection upside down" => {
            return (square < 0.0).then(|| plus(times(inverse, d), inverse * c - square.abs().sqrt(), n));
        }
        "radicand clamped at zero" => {
            return Some(unit(plus(times(inverse, d), inverse * c - square.max(0.0).sqrt(), n)));
        }
        "small angles" => return Some(unit(plus(times(inverse, d), inverse * c - c, n))),
        "left at the length eta" => {
            return (square >= 0.0).then(|| plus(d, c - (eta * eta - 1.0 + c * c).max(0.0).sqrt(), n));
        }
        _ => {}
    }
    (square >= 0.0).then(|| plus(times(inverse, d), inverse * c - square.sqrt(), n))
}

fn refraction_verdicts(fault: &str, seed: u64) -> Vec<Verdict> {
    vec![
        laws::snell_sweep(|d, n, eta| refract(fault, d, n, eta), f64::EPSILON, seed),
        laws::total_internal_reflection(|d, n, eta| refract(fault, d, n, eta), f64::EPSILON, seed),
    ]
}

#[test]
fn right_refraction_is_accepted_and_wrong_refraction_rejected() {
    refraction_verdicts("", 1).iter().for_each(Verdict::assert);
    for fault in [
        "the ratio upside down",
        "equation (1) of the assignment",
        "total reflection where there is none",
        "the test for total reflection upside down",
        "radicand clamped at zero",
        "small angles",
        "left at the length eta",
    ] {
        let verdicts = refraction_verdicts(fault, 1);
        assert!(verdicts.iter().any(|verdict| !verdict.pass), "the mutant \"{fault}\" survived");
    }
}

fn hit_sphere(fault: &str, center: Vec3, radius: f64, origin: Vec3, direction: Vec3) -> Option<f64> {
    if fault == "b² − ac in single precision" {
        let (oc, d) = (minus(origin, center).map(|x| x as f32), direction.map(|x| x as f32));
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (a, b, c) = (dot(d, d), dot(oc, d), dot(oc, oc) - (radius * radius) as f32);
        let discriminant = b * b - a * c;
        return (discriminant >= 0.0).then(|| f64::from((-b - discriminant.sqrt()) / a));
    }
    // Perpendicular-vector discriminant (Haines et al. 2019).
    let oc = minus(origin, center);
    let a = dot(direction, direction);
    let b = -dot(oc, direction);
    let foot = plus(oc, b / a, direction);
    let reach = radius * radius - dot(foot, foot);
    if reach < 0.0 {
        return None;
    }
    if fault == "always the far root" {
        return Some((b + (a * reach).sqrt()) / a);
    }
    let q = b + (a * reach).sqrt().copysign(b);
    let c = dot(oc, oc) - radius * radius;
    let (t0, t1) = (c / q, q / a);
    let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
    if fault == "direction taken as unit" {
        return Some(near * a.sqrt() * 1.000_001);
    }
    [near, far].into_iter().find(|t| *t > 0.0)
}

#[test]
fn right_spheres_are_hit_and_wrong_ones_are_noticed() {
    for distance in [3.0, 1e2, 1e3, 1e4, 1e5] {
        laws::far_sphere_is_hit(|c, r, o, d| hit_sphere("", c, r, o, d), distance, f64::EPSILON, 1).assert();
    }
    for (fault, distance, epsilon) in [
        ("b² − ac in single precision", 1e3, f64::EPSILON),
        ("b² − ac in single precision", 1e3, laws::SINGLE),
        ("always the far root", 10.0, f64::EPSILON),
        ("direction taken as unit", 10.0, f64::EPSILON),
    ] {
        let verdict = laws::far_sphere_is_hit(|c, r, o, d| hit_sphere(fault, c, r, o, d), distance, epsilon, 1);
        assert!(!verdict.pass, "the mutant \"{fault}\" survived: {verdict}");
    }
}

/// Triangles without a tree, by Woop's watertight test (Woop, Benthin & Wald 2013) in f64.
struct Triangles {
    corners: Vec<[Vec3; 3]>,
    fault: &'static str,
}

impl Triangles {
    fn of(mesh: &ClosedMesh, factor: f64, fault: &'static str) -> Self {
        let corner = |i: u32| times(factor, mesh.vertices[i as usize]);
        Self { corners: mesh.triangles.iter().map(|t| t.map(corner)).collect(), fault }
    }
}

impl Intersects for Triangles {
    fn intersect(&self, origin: Vec3, direction: Vec3, t_max: f64) -> Option<Hit> {
        self.corners.iter().fold(None, |nearest: Option<Hit>, corners| {
            let limit = nearest.map_or(t_max, |hit| hit.t);
            meet_triangle(self.fault, corners, origin, direction, limit).or(nearest)
        })
    }
}

/// Where a ray meets a triangle before `t_max`, with one of several faults.
pub(crate) fn meet_triangle(
    fault: &str,
    corners: &[Vec3; 3],
    origin: Vec3,
    direction: Vec3,
    t_max: f64,
) -> Option<Hit> {
    let kz = (0..3).max_by(|a, b| direction[*a].abs().total_cmp(&direction[*b].abs()))?;
    let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
    let (kx, ky) = if direction[kz] < 0.0 { (ky, kx) } else { (kx, ky) };
    let shear = [direction[kx] / direction[kz], direction[ky] / direction[kz], 1.0 / direction[kz]];
    let local = corners.map(|corner| {
        let p = minus(corner, origin);
        [p[kx] - shear[0] * p[kz], p[ky] - shear[1] * p[kz], shear[2] * p[kz]]
    });
    // Where the products round to the same, exactly: a tiny triangle beside the ray would else seem to be met.
    let edge = |a: Vec3, b: Vec3| match a[0] * b[1] - a[1] * b[0] {
        0.0 => {
            let wide = DoubleDouble::from;
            (wide(a[0]) * wide(b[1]) - wide(a[1]) * wide(b[0])).to_f64()
        }
        area => area,
    };
    let (u, v, w) = (edge(local[2], local[1]), edge(local[0], local[2]), edge(local[1], local[0]));
    let outside = match fault {
        "edges excluded" => !(u > 0.0 && v > 0.0 && w > 0.0 || u < 0.0 && v < 0.0 && w < 0.0),
        "back faces culled" => u < 0.0 || v < 0.0 || w < 0.0,
        _ => (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0),
    };
    let determinant = u + v + w;
    if outside || determinant == 0.0 {
        return None;
    }
    let t = (u * local[0][2] + v * local[1][2] + w * local[2][2]) / determinant;
    let least = if fault == "an absolute epsilon" { 1e-4 } else { 0.0 };
    let normal = unit(cross(minus(corners[1], corners[0]), minus(corners[2], corners[0])));
    (t > least && t < t_max).then_some(Hit { t, normal })
}

/// Triangles by Möller & Trumbore in single precision with its customary epsilon.
pub(crate) struct Leaky(pub(crate) Vec<[[f32; 3]; 3]>);

impl Intersects for Leaky {
    fn intersect(&self, origin: Vec3, direction: Vec3, _: f64) -> Option<Hit> {
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let cross = |a: [f32; 3], b: [f32; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let minus = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let (o, d) = (origin.map(|x| x as f32), direction.map(|x| x as f32));
        self.0.iter().find_map(|[a, b, c]| {
            let (e1, e2) = (minus(*b, *a), minus(*c, *a));
            let p = cross(d, e2);
            let determinant = dot(e1, p);
            let s = minus(o, *a);
            let u = dot(s, p) / determinant;
            let q = cross(s, e1);
            let v = dot(d, q) / determinant;
            let t = dot(e2, q) / determinant;
            (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-6).then_some(Hit { t: f64::from(t), normal: [0.0; 3] })
        })
    }
}

#[test]
fn tight_meshes_are_accepted_and_leaking_ones_rejected() {
    let meshes = [ClosedMesh::cube(), ClosedMesh::sphere(16, 16), ClosedMesh::needles(30, 1e3)];
    for mesh in &meshes {
        laws::closed_mesh_is_tight(mesh, &Triangles::of(mesh, 1.0, ""), 20_000, f64::EPSILON, 1).assert();
        let moved = mesh.clone().moved([3e4, -1e4, 2e4], f64::EPSILON);
        laws::closed_mesh_is_tight(&moved, &Triangles::of(&moved, 1.0, ""), 20_000, f64::EPSILON, 1).assert();
    }
    let sphere = &meshes[1];
    for fault in ["edges excluded", "back faces culled"] {
        let verdict = laws::closed_mesh_is_tight(sphere, &Triangles::of(sphere, 1.0, fault), 20_000, f64::EPSILON, 1);
        assert!(!verdict.pass, "the mutant \"{fault}\" survived");
    }
    let corners = sphere.triangles.iter().map(|t| t.map(|i| sphere.vertices[i as usize].map(|x| x as f32)));
    let leaky = Leaky(corners.collect());
    assert!(
        !laws::closed_mesh_is_tight(sphere, &leaky, 20_000, laws::SINGLE, 1).pass,
        "a leaky triangle test survived"
    );
}

#[test]
fn exact_scaling_is_accepted_and_an_absolute_epsilon_rejected() {
    let mesh = ClosedMesh::cube();
    let aims: Vec<Aim> = mesh.aims(300, f64::EPSILON, 1).collect();
    let build = |fault: &'static str| {
        let mesh = mesh.clone();
        move |factor: f64| -> Box<dyn Intersects> { Box::new(Triangles::of(&mesh, factor, fault)) }
    };
    laws::powers_of_two_are_exact(build(""), &aims, &[-40, -20, -3, 7, 20, 40]).assert();
    assert!(!laws::powers_of_two_are_exact(build("an absolute epsilon"), &aims, &[-20]).pass);
}

/// An axis-aligned box of half side 1 by slabs.
struct Slabs {
    fault: &'static str,
}

impl Intersects for Slabs {
    fn intersect(&self, origin: Vec3, direction: Vec3, t_max: f64) -> Option<Hit> {
        let (mut near, mut far) = (0.0_f64, t_max);
        for axis in 0..3 {
            let inverse = 1.0 / direction[axis];
            let (a, b) = ((-1.0 - origin[axis]) * inverse, (1.0 - origin[axis]) * inverse);
            if self.fault == "a comparison that drops NaN the wrong way" {
                let (low, high) = if a < b { (a, b) } else { (b, a) };
                near = if low > near { low } else { near };
                far = if high < far || high.is_nan() { high } else { far };
            } else {
                // f64::max and min return the other operand for NaN: the slab that a ray lies in says nothing.
                near = a.max(near).min(b.max(near));
                far = a.min(far).max(b.min(far));
            }
        }
        (near <= far).then_some(Hit { t: near, normal: [0.0; 3] })
    }
}

#[test]
fn rays_in_a_slab_plane_are_kept_and_a_nan_that_loses_them_rejected() {
    let through = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.5]];
    laws::signed_zeros_are_equal(&Slabs { fault: "" }, &through, 5.0).assert();
    let fault = "a comparison that drops NaN the wrong way";
    assert!(!laws::signed_zeros_are_equal(&Slabs { fault }, &through, 5.0).pass);
}

#[test]
#[ignore = "a hundred whole suites take minutes; run by hand when laws change"]
fn right_surfaces_raise_no_false_alarm_in_a_hundred_seeds() {
    let mesh = ClosedMesh::sphere(16, 16);
    for seed in 1000..1100 {
        refraction_verdicts("", seed).iter().for_each(Verdict::assert);
        for distance in [3.0, 1e3, 1e5] {
            laws::far_sphere_is_hit(|c, r, o, d| hit_sphere("", c, r, o, d), distance, f64::EPSILON, seed).assert();
        }
        laws::closed_mesh_is_tight(&mesh, &Triangles::of(&mesh, 1.0, ""), 3_000, f64::EPSILON, seed).assert();
    }
}
