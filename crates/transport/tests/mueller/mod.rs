//! Mueller matrices of our surfaces, held to what polarised light must do.

use etalon_optics::{ComplexIndex, Lanes, RefractiveIndex, Spectrum, Vec3};
use etalon_oracle::laws::{self, Polarises};
use etalon_scene::{InternalReflection, MaterialKind, Metal, Microfacets, PolarisingSheet};
use etalon_transport::bsdf::{Bsdf, BsdfSample, Lobe, Shading};
use etalon_transport::mis::Density;
use etalon_transport::polarisation::mueller::{DEPOLARISER, Matrix, Mueller};
use etalon_transport::polarisation::{Followed, Polarisation};

mod paths;

const RANGE_NM: [f64; 2] = [380.0, 780.0];

fn bsdf(kind: &MaterialKind) -> Bsdf {
    let mut bsdf = Bsdf::new(kind, RANGE_NM);
    bsdf.prepare_polarisation();
    bsdf
}

fn glass(interior: f64, exterior: f64) -> MaterialKind {
    let (interior, exterior) = (RefractiveIndex::Constant(interior), RefractiveIndex::Constant(exterior));
    MaterialKind::Dielectric { interior, exterior, priority: None, film: None }
}

fn metal(n: f64, k: f64) -> Metal {
    Metal::Index(ComplexIndex::tabulated(vec![300.0, 900.0], vec![n; 2], vec![k; 2]).unwrap())
}

fn rough_glass(alpha: f64, compensated: bool) -> MaterialKind {
    let (interior, exterior) = (RefractiveIndex::Constant(1.5), RefractiveIndex::VACUUM);
    MaterialKind::RoughDielectric { interior, exterior, facets: alpha.into(), compensated, priority: None, film: None }
}

fn rough_metal(n: f64, k: f64, alpha: f64) -> MaterialKind {
    MaterialKind::RoughConductor { metal: metal(n, k), facets: alpha.into(), compensated: true, film: None }
}

/// Facets of a coat; 0 is smooth.
fn facets(alpha: f64) -> Option<Microfacets> {
    (alpha > 0.0).then(|| alpha.into())
}

fn plastic(rho: f64, alpha: f64) -> MaterialKind {
    MaterialKind::Plastic {
        reflectance: Spectrum::Constant(rho).into(),
        coat: RefractiveIndex::Constant(1.5),
        facets: facets(alpha),
        internal_reflection: InternalReflection::Coloured,
        compensated: true,
    }
}

/// Plastic whose coat loses what its facets hide.
fn lossy_plastic(rho: f64, alpha: f64) -> MaterialKind {
    let MaterialKind::Plastic { reflectance, coat, facets, internal_reflection, .. } = plastic(rho, alpha) else {
        unreachable!("it is plastic")
    };
    MaterialKind::Plastic { reflectance, coat, facets, internal_reflection, compensated: false }
}

/// Plastic in a medium denser than its coat.
fn plastic_in_glass(alpha: f64) -> MaterialKind {
    MaterialKind::Plastic {
        reflectance: Spectrum::Constant(1.0).into(),
        coat: RefractiveIndex::Constant(0.8),
        facets: facets(alpha),
        internal_reflection: InternalReflection::Coloured,
        compensated: true,
    }
}

fn pane() -> MaterialKind {
    MaterialKind::ThinDielectric { index: RefractiveIndex::Constant(1.5), film: None }
}

fn up() -> Vec3<f64> {
    Vec3::new(0.0, 0.0, 1.0)
}

fn direction(mu: f64, turns: f64) -> Vec3<f64> {
    let (sin, cos) = (turns * std::f64::consts::TAU).sin_cos();
    let across = ((1.0 - mu) * (1.0 + mu)).sqrt();
    Vec3::new(across * cos, across * sin, mu)
}

/// The part of a material without deltas, as the oracle wants it.
struct Scattering(Bsdf);

impl Polarises for Scattering {
    fn mueller(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> Option<(Matrix, [f64; 3])> {
        let (at, wo, wi) = (Shading::flat(up()), Vec3::from_array(wo), Vec3::from_array(wi));
        let lambda = Lanes([wavelength_nm]);
        let (f_cos, _) = self.0.eval::<1>(&lambda, &at, wo, wi);
        if f_cos[0] <= 0.0 {
            return None;
        }
        let across = wo.cross(wi);
        match self.0.mueller(&lambda, &at, wo, wi, Lobe::SolidAngle) {
            Some(mueller) => Some((mueller.matrix(0), mueller.x.to_array())),
            None => Some((DEPOLARISER, across.to_array())),
        }
    }
}

fn blend() -> MaterialKind {
    MaterialKind::blend(rough_metal(0.2, 3.0, 0.3), plastic(0.6, 0.2), 0.4)
}

#[test]
fn matrices_are_physical_and_reciprocal() {
    for (kind, transmits) in [
        (rough_metal(0.2, 3.0, 0.3), false),
        (rough_metal(1.5, 0.0, 1.0), false),
        (rough_glass(0.3, false), true),
        (rough_glass(1.0, true), true),
        (plastic(0.5, 0.0), false),
        (plastic(1.0, 0.4), false),
        (lossy_plastic(1.0, 0.4), false),
        (blend(), false),
        (MaterialKind::Lambert { reflectance: Spectrum::Constant(0.5).into() }, false),
    ] {
        let surface = Scattering(bsdf(&kind));
        for verdict in [
            laws::mueller_is_physical(&surface, transmits, 550.0, 1),
            laws::mueller_is_reciprocal(&surface, transmits, 550.0, 1),
        ] {
            assert!(verdict.pass, "{kind:?}: {verdict}");
        }
    }
}

/// Well spread points for three numbers: for smooth means the error falls nearly as 1/n.
fn points(n: u32) -> impl Iterator<Item = [f64; 3]> {
    let g = 1.220_744_084_605_759_5_f64;
    (0..n).map(move |i| [1.0 / g, 1.0 / (g * g), 1.0 / (g * g * g)].map(|a| (0.5 + a * f64::from(i)) % 1.0))
}

/// The Stokes vector in which a surface is seen under a uniform sky of unpolarised light, n² taken out.
fn seen(bsdf: &Bsdf, wo: Vec3<f64>, n: u32) -> [f64; 4] {
    let (lambda, at) = (Lanes([550.0]), Shading::flat(up()));
    let mut sum = [0.0; 4];
    for u in points(n) {
        let Some(sample): Option<BsdfSample<1>> = bsdf.sample(&lambda, &at, wo, u) else { continue };
        let lobe = match sample.density {
            Density::Delta => Lobe::Delta(u[0]),
            Density::SolidAngle(_) => Lobe::SolidAngle,
        };
        // The frame's x at right angles to the plane of the normal.
        let mut light = Followed::<1>::at_camera(-wo, up().cross(wo));
        let weight = sample.weight * sample.eta * sample.eta / f64::from(n);
        let s0 = light.receive_scattered(wo, sample.wi, || bsdf.mueller(&lambda, &at, wo, sample.wi, lobe), weight);
        let [s1, s2, s3] = light.received().expect("carried").map(|lanes| lanes[0]);
        [s0[0], s1, s2, s3].iter().zip(&mut sum).for_each(|(s, sum)| *sum += s);
    }
    sum
}

/// What absorbs nothing cannot be seen in uniform unpolarised light, and what cannot be seen does not polarise: what a surface
/// passes on of s it does not mirror. Only where light that the coat let in and out keeps the diattenuation of that does it
/// hold for plastic: the mutant is the same surface without the table for it (of rough glass the table changes less than this sees). To 6e-3, the error of the points where half
/// the light is diffuse, and of tables that stay 0.5 % below the loss.
#[test]
fn a_lossless_surface_in_uniform_light_is_white_and_polarises_nothing() {
    for kind in [
        glass(1.5, 1.0),
        pane(),
        rough_glass(0.1, true),
        rough_glass(0.5, true),
        plastic(1.0, 0.0),
        plastic(1.0, 0.4),
        plastic_in_glass(0.4),
    ] {
        let bsdf = bsdf(&kind);
        for mu in [0.9, 0.5, 0.2] {
            for wo in [direction(mu, 0.0), direction(mu, 0.3), -direction(mu, 0.1)] {
                let [s0, s1, s2, s3] = seen(&bsdf, wo, 1 << 15);
                let close = |read: f64, truth: f64| (-1e-2..6e-3).contains(&(read - truth));
                assert!(close(s0, 1.0), "{kind:?}, {wo:?}: S0 {s0}");
                assert!([s1, s2, s3].iter().all(|s| s.abs() < 6e-3), "{kind:?}, {wo:?}: {s1} {s2} {s3}");
            }
        }
    }
    let mutant = Bsdf::new(&plastic(1.0, 0.4), RANGE_NM);
    let [_, s1, ..] = seen(&mutant, direction(0.2, 0.0), 1 << 15);
    assert!(s1.abs() > 1.2e-2, "without tables {s1}");
}

/// Towards α = 0 rough surfaces polarise as smooth ones do. Facets are tilted by about α: with a slope of the diattenuation of
/// at most 3 per radian, by less than 5α.
#[test]
fn rough_surfaces_join_smooth_ones() {
    let (lambda, at) = (Lanes([550.0]), Shading::flat(up()));
    let alpha = 1e-3;
    let (smooth_plastic, rough_plastic) = (plastic(0.0, 0.0), plastic(0.0, alpha));
    for (smooth, rough) in [
        (glass(1.5, 1.0), rough_glass(alpha, true)),
        (MaterialKind::Conductor { metal: metal(0.2, 3.0), film: None }, rough_metal(0.2, 3.0, alpha)),
        (smooth_plastic, rough_plastic),
        (plastic(0.5, 0.0), lossy_plastic(0.5, alpha)),
    ] {
        let (smooth, rough) = (bsdf(&smooth), bsdf(&rough));
        for wo in [direction(0.6, 0.2), direction(0.3, 0.0), -direction(0.9, 0.6)] {
            for u in [[0.01, 0.4, 0.3], [0.99, 0.1, 0.6]] {
                let sample = |bsdf: &Bsdf| -> Option<Mueller<1>> {
                    let sample: BsdfSample<1> = bsdf.sample(&lambda, &at, wo, u)?;
                    let lobe = match sample.density {
                        Density::Delta => Lobe::Delta(u[0]),
                        Density::SolidAngle(_) => Lobe::SolidAngle,
                    };
                    bsdf.mueller(&lambda, &at, wo, sample.wi, lobe)
                };
                let (Some(smooth), Some(rough)) = (sample(&smooth), sample(&rough)) else { continue };
                for (a, b) in smooth.matrix(0).iter().flatten().zip(rough.matrix(0).iter().flatten()) {
                    assert!((a - b).abs() < 5.0 * alpha, "{wo:?}: {smooth:?} {rough:?}");
                }
            }
        }
    }
}

/// Through sheets straight on, from either side and at an angle: an ideal polariser passes half of unpolarised light and all of
/// what it has passed; whatever the angle, what passes swings at right angles to the wires.
#[test]
fn sheets_pass_light_straight_on_along_their_axis() {
    let sheet = PolarisingSheet::Polariser { transmittance: Spectrum::Constant(0.8), extinction: 0.0 };
    let axis = [1.0, 0.0, 0.0];
    let bsdf = bsdf(&MaterialKind::PolarisingSheet { axis, sheet });
    let at = Shading::flat(up()).with_axis(Vec3::from_array(axis));
    for wo in [direction(1.0, 0.0), direction(0.3, 0.1), -direction(0.6, 0.4)] {
        let lambda = Lanes([550.0]);
        let sample: BsdfSample<1> = bsdf.sample(&lambda, &at, wo, [0.5; 3]).unwrap();
        assert!((sample.weight[0] - 0.4).abs() < 1e-15 && (sample.wi + wo).length() < 1e-15);
        let mueller = bsdf.mueller(&lambda, &at, wo, sample.wi, Lobe::Delta(0.5)).unwrap();
        let wires = Vec3::new(0.0, 1.0, 0.0);
        assert!(mueller.x.dot(wires).abs() < 1e-12 && mueller.x.dot(wo).abs() < 1e-12);
        let passed = mueller.matrix(0).map(|row| row[0]);
        assert_eq!(passed, [1.0, 1.0, 0.0, 0.0]);
    }
}

/// f·|cos θ| and the Mueller matrix of a pair of directions; `None` where nothing is scattered.
fn scattered(bsdf: &Bsdf, wo: Vec3<f64>, wi: Vec3<f64>) -> Option<(f64, Matrix)> {
    scattered_at(bsdf, 550.0, wo, wi)
}

fn scattered_at(bsdf: &Bsdf, nm: f64, wo: Vec3<f64>, wi: Vec3<f64>) -> Option<(f64, Matrix)> {
    let (lambda, at) = (Lanes([nm]), Shading::flat(up()));
    let (f_cos, _) = bsdf.eval::<1>(&lambda, &at, wo, wi);
    (f_cos[0] > 0.0).then(|| {
        let mueller = bsdf.mueller(&lambda, &at, wo, wi, Lobe::SolidAngle);
        (f_cos[0], mueller.map_or(DEPOLARISER, |mueller| mueller.matrix(0)))
    })
}

fn differ(a: &Matrix, b: &Matrix) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Pairs of directions in general position, the second on either side.
fn pairs() -> impl Iterator<Item = (Vec3<f64>, Vec3<f64>)> {
    let from = [direction(0.6, 0.2), direction(0.3, 0.0), -direction(0.9, 0.6), -direction(0.5, 0.1)];
    from.into_iter().flat_map(|wo| {
        let up = [direction(0.7, 0.65), direction(0.2, 0.4), direction(0.75, 0.62), direction(0.7, 0.1)];
        let to = up.into_iter().chain([-direction(0.8, 0.7), -direction(0.85, 0.22), -direction(0.7, 0.03)]);
        to.map(move |wi| (wo, wi))
    })
}

/// What meets one facet leaves it as it leaves a smooth surface that lies as the facet does.
#[test]
fn a_facet_does_to_polarised_light_what_a_smooth_surface_in_its_place_does() {
    let conductor = MaterialKind::Conductor { metal: metal(0.2, 3.0), film: None };
    let rough_conductor =
        MaterialKind::RoughConductor { metal: metal(0.2, 3.0), facets: 0.4.into(), compensated: false, film: None };
    let mut compared = [0; 2];
    for (rough, smooth, coated) in [
        (rough_conductor, conductor, false),
        (rough_glass(0.4, false), glass(1.5, 1.0), false),
        (plastic(0.0, 0.4), glass(1.5, 1.0), true),
    ] {
        let (rough, smooth) = (bsdf(&rough), bsdf(&smooth));
        // A coat is on both sides, so that from below nothing is inside.
        for (wo, wi) in pairs().filter(|(wo, _)| !coated || wo.z > 0.0) {
            let Some((_, read)) = scattered(&rough, wo, wi) else { continue };
            let crosses = wo.z * wi.z < 0.0;
            let index = |w: Vec3<f64>| if w.z > 0.0 { 1.0 } else { 1.5 };
            let h = if crosses { wo * index(wo) + wi * index(wi) } else { wo + wi }.normalized();
            let facet = Shading::flat(if h.z < 0.0 { -h } else { h });
            let lobe = Lobe::Delta(if crosses { 0.999_999 } else { 0.0 });
            let truth = smooth.mueller(&Lanes([550.0]), &facet, wo, wi, lobe).unwrap().matrix(0);
            assert!(differ(&read, &truth) < 1e-9, "{wo:?} {wi:?}: {read:?} is not {truth:?}");
            assert!(differ(&read, &DEPOLARISER) > 1e-3);
            compared[usize::from(crosses)] += 1;
        }
    }
    assert!(compared[0] > 10 && compared[1] >= 3, "{compared:?}");
}

/// Rough glass whose index varies does at each wavelength what glass of the index there does, from either side: its tables, linear
/// between the ends of a range of .4, miss what their curvature makes of it.
#[test]
fn dispersive_rough_glass_polarises_as_glass_of_each_index_does() {
    let exterior = RefractiveIndex::VACUUM;
    let glass = |interior: RefractiveIndex| {
        bsdf(&MaterialKind::RoughDielectric {
            interior,
            exterior: exterior.clone(),
            facets: 0.6.into(),
            compensated: true,
            priority: None,
            film: None,
        })
    };
    let dispersive = RefractiveIndex::cauchy(1.25, 0.08, 0.0, None).unwrap();
    let varied = glass(dispersive.clone());
    for nm in [400.0, 500.0, 700.0] {
        let constant = glass(RefractiveIndex::Constant(dispersive.eval(nm)));
        for (wo, wi) in pairs() {
            let read = |bsdf: &Bsdf| scattered_at(bsdf, nm, wo, wi).map(|(_, matrix)| matrix);
            let (Some(varied), Some(constant)) = (read(&varied), read(&constant)) else { continue };
            // Most where light from within is reflected, between the two critical angles.
            let tolerance = if wo.z < 0.0 && wi.z > 0.0 { 4e-3 } else { 1.2e-2 };
            assert!(differ(&varied, &constant) < tolerance, "{nm} nm, {wo:?} {wi:?}: {varied:?} is not {constant:?}");
        }
    }
}

/// Around a shading normal, on whatever side of the surface it is given, frames are at right angles to both rays, and matrices stay
/// physical; where no direction had to be turned to the side of the triangle, they are those of a surface that lies so.
#[test]
fn around_a_shading_normal_frames_belong_to_both_rays() {
    let (mut compared, mut turned) = (0, 0);
    for kind in [
        glass(1.5, 1.0),
        MaterialKind::Conductor { metal: metal(0.2, 3.0), film: None },
        rough_metal(0.2, 3.0, 0.3),
        rough_glass(0.3, true),
        plastic(0.5, 0.3),
        lossy_plastic(0.5, 0.3),
    ] {
        let bsdf = bsdf(&kind);
        for (i, [a, b, c]) in points(400).enumerate() {
            let normal = direction(1.0 - 0.7 * a, b) * if i % 2 == 0 { 1.0 } else { -1.0 };
            let (at, flat) =
                (Shading::flat(up()).bent_to(normal), Shading::flat(normal * if i % 2 == 0 { 1.0 } else { -1.0 }));
            assert!((at.shading_normal() - flat.normal).length() < 1e-15, "{at:?}");
            let wo = direction(0.05 + 0.9 * c, 2.0 * a) * if i % 3 == 0 { -1.0 } else { 1.0 };
            let lambda = Lanes([550.0]);
            let Some(sample): Option<BsdfSample<1>> = bsdf.sample(&lambda, &at, wo, [b, c, a]) else { continue };
            let lobe = match sample.density {
                Density::Delta => Lobe::Delta(b),
                Density::SolidAngle(_) => Lobe::SolidAngle,
            };
            let wi = sample.wi;
            let Some(mueller) = bsdf.mueller(&lambda, &at, wo, wi, lobe) else { continue };
            let x = mueller.x.normalized();
            assert!(x.dot(wo).abs().max(x.dot(wi).abs()) < 1e-6, "{kind:?} {at:?} {wo:?} {wi:?}: {mueller:?}");
            let matrix = mueller.matrix(0);
            assert!(matrix.iter().flatten().all(|m| m.abs() < 1.0 + 1e-9), "{kind:?}: {matrix:?}");
            let sides = |w: Vec3<f64>| at.normal.dot(w) * flat.normal.dot(w) > 0.0;
            if sides(wo) && sides(wi) {
                let truth = bsdf.mueller(&lambda, &flat, wo, wi, lobe).unwrap();
                assert!(differ(&matrix, &truth.matrix(0)) < 1e-9, "{kind:?} {at:?}: {matrix:?} is not {truth:?}");
                compared += 1;
            } else {
                turned += 1;
            }
        }
    }
    assert!(compared > 500 && turned > 200, "{compared} {turned}");
}

/// f times the matrix adds up over the parts of a surface: what several facets of a metal add is unpolarised, and a mixture is its parts.
#[test]
fn what_parts_of_a_surface_do_to_polarised_light_adds_up() {
    let rough = |compensated| MaterialKind::RoughConductor {
        metal: metal(0.2, 3.0),
        facets: 0.8.into(),
        compensated,
        film: None,
    };
    let (single, whole) = (bsdf(&rough(false)), bsdf(&rough(true)));
    let (first, second) = (bsdf(&rough_metal(0.2, 3.0, 0.3)), bsdf(&plastic(0.6, 0.2)));
    let mixed = bsdf(&blend());
    let mut compared = 0;
    for (wo, wi) in pairs().filter(|(wo, wi)| wo.z > 0.0 && wi.z > 0.0) {
        let part = |bsdf: &Bsdf, share: f64| {
            let (f, matrix) = scattered(bsdf, wo, wi).unwrap();
            matrix.map(|row| row.map(|entry| share * f * entry))
        };
        let sum =
            |a: Matrix, b: Matrix| -> Matrix { std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j])) };
        let [f_single, f_whole] = [&single, &whole].map(|bsdf| scattered(bsdf, wo, wi).unwrap().0);
        assert!(f_whole > 1.01 * f_single);
        let several = DEPOLARISER.map(|row| row.map(|entry| (f_whole - f_single) * entry));
        assert!(differ(&part(&whole, 1.0), &sum(part(&single, 1.0), several)) < 1e-12, "{wo:?} {wi:?}");
        assert!(differ(&part(&mixed, 1.0), &sum(part(&first, 0.6), part(&second, 0.4))) < 1e-12, "{wo:?} {wi:?}");
        compared += 1;
    }
    assert_eq!(compared, 8);
}

/// Amplitudes 1 : √e give diattenuation (1 − e)/(1 + e) and leave 2√e/(1 + e) of the rest; 1 : exp(iδ) turns by δ, which a plate of a fixed thickness
/// has in inverse proportion to the wavelength.
#[test]
fn sheets_that_leak_or_delay_have_the_matrices_of_their_amplitudes() {
    let axis = [1.0, 0.0, 0.0];
    let matrix = |sheet: PolarisingSheet, nm: f64| {
        let bsdf = bsdf(&MaterialKind::PolarisingSheet { axis, sheet });
        let at = Shading::flat(up()).with_axis(Vec3::from_array(axis));
        bsdf.mueller(&Lanes([nm]), &at, direction(0.8, 0.1), -direction(0.8, 0.1), Lobe::Delta(0.5)).unwrap().matrix(0)
    };
    let diagonal =
        |a: f64, b: f64, c: f64| [[1.0, a, 0.0, 0.0], [a, 1.0, 0.0, 0.0], [0.0, 0.0, b, c], [0.0, 0.0, -c, b]];
    let leaky = PolarisingSheet::Polariser { transmittance: Spectrum::Constant(0.8), extinction: 0.25 };
    assert!(differ(&matrix(leaky, 550.0), &diagonal(0.6, 0.8, 0.0)) < 1e-12);
    let quarter = std::f64::consts::FRAC_PI_2;
    for (at_nm, nm, delay) in
        [(None, 440.0, quarter), (Some(550.0), 550.0, quarter), (Some(550.0), 440.0, 1.25 * quarter)]
    {
        let read = matrix(PolarisingSheet::Retarder { retardance_rad: quarter, at_nm }, nm);
        let truth = diagonal(0.0, delay.cos(), delay.sin());
        assert!(differ(&read, &truth) < 1e-12, "{at_nm:?} at {nm} nm: {read:?} is not {truth:?}");
    }
}
