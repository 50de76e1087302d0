//! Every material and every area light, held to the oracle's whole suite for its kind.

use etalon_optics::{ComplexIndex, Frame, Real, RefractiveIndex, Spectrum, Vec3, fresnel};
use etalon_oracle::laws::{self, FresnelPowers, SINGLE};
use etalon_oracle::{Verdict, suite};
use etalon_scene::{InternalReflection, MaterialKind, Metal, PolarisingSheet};
use etalon_transport::mis;

mod lamp;
mod lamps;
mod material;
mod materials;
mod measured;
mod principled;

use lamps::{disk_lamp, parallelogram_lamp, sphere_lamp, triangle_lamp};
use material::Material;

/// Every law for a material.
fn laws_of(kind: &MaterialKind) -> Vec<Verdict> {
    suite::scatters(&Material::new(kind.clone()), 1)
}

/// Fresnel's equations and what else is a function of a few numbers, in both scalars.
fn functions<R: Real>() -> Vec<Verdict> {
    let epsilon = if size_of::<R>() == 4 { SINGLE } else { f64::EPSILON };
    let powers = |cos: f64, eta: f64| match fresnel::dielectric(R::from_f64(cos), R::from_f64(eta)) {
        None => FresnelPowers { r_s: 1.0, r_p: 1.0, t_s: 0.0, t_p: 0.0 },
        Some(f) => {
            let [r_s, r_p] = [f.r_s, f.r_p].map(|r| (r * r).to_f64());
            // Ours is the unpolarised transmittance; the law asks for its parts, which the reflectances share out.
            let whole = f.transmittance.to_f64();
            let [t_s, t_p] =
                [1.0 - r_s, 1.0 - r_p].map(|t| if r_s + r_p < 2.0 { t * 2.0 * whole / (2.0 - r_s - r_p) } else { 0.0 });
            FresnelPowers { r_s, r_p, t_s, t_p }
        }
    };
    let frame = |n: [f64; 3]| {
        let frame = Frame::from_normal(Vec3::<R>::from_f64(n));
        let axis = |x: f64, y: f64| frame.to_world(Vec3::from_f64([x, y, 0.0])).to_f64().to_array();
        (axis(1.0, 0.0), axis(0.0, 1.0))
    };
    vec![
        laws::fresnel_conserves_energy(powers, epsilon, 1),
        laws::fresnel_obeys_brewster(powers, epsilon, 1),
        laws::fresnel_reflects_totally(powers, epsilon, 1),
        laws::frame_is_orthonormal(frame, epsilon, 1),
        laws::mis_weights_add_up(mis::power_heuristic, epsilon, 1),
        laws::mis_weights_add_up(mis::balance_heuristic, epsilon, 1),
    ]
}

/// The whole of our materials, lights and functions under every law, counted; the count and the closest call are printed by
/// `cargo test --release -p etalon-transport --test integration -- --nocapture two_hundred`.
#[test]
#[allow(clippy::print_stdout, reason = "the count is for whoever asks for it")]
fn more_than_two_hundred_instances_of_laws_hold() {
    let index = |name: &str| RefractiveIndex::named(name).unwrap_or(RefractiveIndex::VACUUM);
    let dielectric = |interior: &str, exterior: &str| MaterialKind::Dielectric {
        interior: index(interior),
        exterior: index(exterior),
        priority: None,
        film: None,
    };
    let colour = Spectrum::rgb_reflectance([0.8, 0.3, 0.1]).unwrap();
    let grey = || Spectrum::Constant(0.7).into();
    let polariser = PolarisingSheet::Polariser { transmittance: colour.clone(), extinction: 0.1 };
    let mut kinds = vec![
        MaterialKind::Black,
        MaterialKind::Lambert { reflectance: colour.clone().into() },
        MaterialKind::Mirror { reflectance: Spectrum::Constant(0.9).into() },
        MaterialKind::Conductor { metal: Metal::Reflectance(colour.into()), film: None },
        MaterialKind::OrenNayar { reflectance: grey(), roughness: 0.5 },
        MaterialKind::Translucent { reflectance: grey(), transmittance: Spectrum::Constant(0.2).into() },
        MaterialKind::Plastic {
            reflectance: grey(),
            coat: RefractiveIndex::Constant(1.5),
            facets: None,
            internal_reflection: InternalReflection::Coloured,
            compensated: true,
        },
        MaterialKind::ThinDielectric { index: RefractiveIndex::Constant(1.5), film: None },
        MaterialKind::PolarisingSheet { axis: [1.0, 0.0, 0.0], sheet: polariser },
    ];
    kinds.extend(
        ["Ag", "Al", "Au", "Cu"].map(|name| MaterialKind::Conductor {
            metal: Metal::Index(ComplexIndex::named(name).unwrap()),
            film: None,
        }),
    );
    kinds.extend(["N-BK7", "N-SF11", "fused-silica", "diamond", "water"].map(|name| dielectric(name, "vacuum")));
    kinds.extend(
        [
            ("vacuum", "water"),
            ("vacuum", "diamond"),
            ("diamond", "N-BK7"),
            ("N-SF11", "water"),
            ("fused-silica", "water"),
        ]
        .map(|(interior, exterior)| dielectric(interior, exterior)),
    );
    let from = [[0.0; 3], [1.0, 2.0, 0.0], [-2.0, 0.5, -1.0]];
    let (first, second) = kinds.split_at(kinds.len() / 2);
    let run = |kinds: &[MaterialKind]| kinds.iter().flat_map(laws_of).collect::<Vec<_>>();
    let mut verdicts = std::thread::scope(|scope| {
        let half = scope.spawn(|| run(first));
        let mut verdicts = run(second);
        verdicts.extend(half.join().expect("the laws are tried to the end"));
        verdicts
    });
    verdicts.extend(functions::<f32>());
    verdicts.extend(functions::<f64>());
    verdicts.extend(suite::emits(&sphere_lamp(), &from, 1e-6, 2));
    for lamp in [disk_lamp(), parallelogram_lamp(), triangle_lamp()] {
        verdicts.extend(suite::emits(&lamp, &from[..1], 0.02, 2));
    }
    verdicts.iter().for_each(Verdict::assert);
    let closest = verdicts.iter().max_by(|a, b| a.severity().total_cmp(&b.severity())).unwrap();
    println!("{} instances of laws hold; the closest call: {closest}", verdicts.len());
    assert!(verdicts.len() >= 200, "{}", verdicts.len());
}
