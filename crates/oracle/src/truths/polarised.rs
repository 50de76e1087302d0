//! Light polarised by one surface and analysed by another: Malus' law at Brewster's angle, the phase of total reflection.

use std::f64::consts::FRAC_PI_8;

use super::{
    Claim, Truth,
    scene::{Scene, black, disk, glass_in},
};
use crate::laws::{Turn, TurnedBy, fresnel_exact, stokes_along};
use crate::vector::{Vec3, add, cross, dot, scale};

/// Index of the glass of polarisers and analysers.
const GLASS: f64 = 1.5;

/// Index of the glass within which light is totally reflected.
const DENSE: f64 = 1.51;

/// A mirror of a chain: glass that polarises, or the inside of denser glass.
#[derive(Clone, Copy)]
enum Mirror {
    /// At Brewster's angle.
    Polariser,
    /// A total reflection, at this sin² of incidence.
    Total { sin2: f64 },
}

/// The turns of a path that meets mirrors one after the other, each with its plane of incidence turned from the one before by an
/// angle about the ray between them, and where each lies: 3 m apart.
fn chain(mirrors: &[(Mirror, f64)]) -> Vec<(Vec3, Turn)> {
    let (mut at, mut travels, mut plane) = ([0.0; 3], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    let mut turns = Vec::new();
    for &(mirror, turned_deg) in mirrors {
        let wo = scale(-1.0, travels);
        let (sine, cosine) = turned_deg.to_radians().sin_cos();
        // In the plane of incidence, across the ray.
        plane = add(scale(cosine, plane), scale(sine, cross(travels, plane)));
        let (sin, cos) = match mirror {
            Mirror::Polariser => GLASS.atan().sin_cos(),
            Mirror::Total { sin2 } => (sin2.sqrt(), (1.0 - sin2).sqrt()),
        };
        let normal = add(scale(cos, wo), scale(sin, plane));
        let wi = add(scale(2.0 * dot(wo, normal), normal), scale(-1.0, wo));
        let by = match mirror {
            Mirror::Polariser => TurnedBy::Reflection { n: GLASS, k: 0.0 },
            Mirror::Total { .. } => TurnedBy::Reflection { n: 1.0 / DENSE, k: 0.0 },
        };
        turns.push((at, Turn { wo, wi, normal, by }));
        // The part of the plane's vector across the ray that comes next.
        let across = cross(travels, plane);
        travels = wi;
        plane = cross(across, travels);
        at = add(at, scale(3.0, travels));
    }
    turns
}

fn truth(name: &str, mirrors: &[(Mirror, f64)], value: f64, formula: &str) -> Truth {
    let turns = chain(mirrors);
    let (_, last) = turns[turns.len() - 1];
    let mut scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1e-3).spp(4096);
    for (&(mirror, _), &(at, turn)) in mirrors.iter().zip(&turns) {
        let material = match mirror {
            Mirror::Polariser => glass_in(GLASS, 1.0),
            Mirror::Total { .. } => glass_in(1.0, DENSE),
        };
        scene = scene.object(disk(at, turn.normal, 0.5), material);
    }
    let (at, _) = turns[turns.len() - 1];
    let lamp = disk(add(at, scale(3.0, last.wi)), scale(-1.0, last.wi), 0.5);
    let scene = scene.lamp(lamp, black(), 1.0, "front");
    // What the chain reflects of light whose polarisations are averaged at each mirror.
    let reflectance = fresnel_exact(GLASS.atan().cos(), GLASS).reflectance();
    let polarisers = mirrors.iter().filter(|(mirror, _)| matches!(mirror, Mirror::Polariser)).count();
    let averaged = reflectance.powi(i32::try_from(polarisers).expect("a few mirrors"));
    let path: Vec<Turn> = turns.iter().map(|&(_, turn)| turn).collect();
    Truth::new(name, &scene, value, formula)
        .confirmed("tracing the electric field along the path", 1e-9, move || {
            averaged * stokes_along(&path, [1.0, 0.0, 0.0])[0]
        })
        .sees(0.05)
        .or_else("polarisations averaged at each mirror", averaged)
        .claims(Claim::CarriesPolarisation)
}

pub(super) fn truths() -> Vec<Truth> {
    let brewster = fresnel_exact(GLASS.atan().cos(), GLASS).r_s;
    let malus = |degrees: f64| 0.5 * brewster * brewster * degrees.to_radians().cos().powi(2);
    let because = "At Brewster's angle glass reflects s alone, R_s = ((n² − 1)/(n² + 1))² of it. Of light that the one mirror polarises the \
         other reflects cos² of the angle between their planes of incidence.";
    let mut list: Vec<Truth> = [(0.0, "parallel"), (30.0, "at-30-degrees"), (60.0, "at-60-degrees")]
        .into_iter()
        .map(|(degrees, how)| {
            truth(
                &format!("brewster-mirrors-{how}"),
                &[(Mirror::Polariser, 0.0), (Mirror::Polariser, degrees)],
                malus(degrees),
                "½R_s² cos²φ",
            )
            .because(because)
            .or_else("frames that are not turned from mirror to mirror", malus(if degrees == 0.0 { 90.0 } else { 0.0 }))
        })
        .collect();
    // sin² at which s is put 45° behind p: tan²(δ/2) sin⁴ = cos²(sin² − 1/n²), the larger root.
    let t2 = FRAC_PI_8.tan().powi(2);
    let (p, q) = (1.0 + 1.0 / (DENSE * DENSE), 1.0 / (DENSE * DENSE));
    let sin2 = (p + (p * p - 4.0 * (1.0 + t2) * q).sqrt()) / (2.0 * (1.0 + t2));
    // The polariser's plane at 45° to the rhomb's; the analyser's at −45° to it, which is along what a mirror makes of the light.
    list.push(
        truth(
            "half-a-rhomb-between-brewster-mirrors",
            &[(Mirror::Polariser, 0.0), (Mirror::Total { sin2 }, 45.0), (Mirror::Polariser, 45.0)],
            malus(0.0) * FRAC_PI_8.sin().powi(2),
            "½R_s² sin²(δ/2), δ = 45°",
        )
        .because(
            "Light at 45° to the plane of a total reflection comes out of it with s 45° behind p: elliptical. Of the two diagonals an analyser \
             then passes cos²(δ/2) and sin²(δ/2). Two such reflections are Fresnel's rhomb.",
        )
        .or_else("total reflection without its phase", malus(0.0)),
    );
    list
}
