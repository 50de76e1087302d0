//! Light polarised by one surface and analysed by another: Malus' law at Brewster's angle, the phase of total reflection, Fresnel's
//! rhombs.

mod companions;

use std::f64::consts::FRAC_PI_8;

use super::{
    Claim, Truth,
    scene::{Scene, black, disk, extruded, glass, glass_in},
};
use crate::laws::{Turn, TurnedBy, fresnel_exact, stokes_along};
use crate::vector::{Vec3, add, cross, dot, scale};

/// Index of polarisers and analysers: diamond's. At Brewster's angle it reflects 7 times as much as glass of 1.5, so 11 times as many
/// random paths meet two of them.
const POLARISER: f64 = 2.4;

/// Index of the glass within which light is totally reflected.
const DENSE: f64 = 1.51;

/// Side of the faces by which light enters a rhomb and leaves it.
const RHOMB_SIDE_M: f64 = 0.02;

/// What stands in the way of a ray.
#[derive(Clone, Copy, PartialEq)]
enum Piece {
    /// A mirror at Brewster's angle.
    Polariser,
    /// The inside of denser glass: a total reflection at this sin² of incidence.
    Total { sin2: f64 },
    /// A block of glass that light enters and leaves at right angles, totally reflected twice within.
    Rhomb { sin2: f64 },
}

/// A ray on its way from the eye: where it is, where it goes, and a unit vector across it in the plane of incidence.
#[derive(Clone, Copy)]
struct Ray {
    at: Vec3,
    travels: Vec3,
    plane: Vec3,
}

impl Ray {
    fn advance(&mut self, distance_m: f64) {
        self.at = add(self.at, scale(distance_m, self.travels));
    }

    /// Turns the plane of incidence about the ray.
    fn turn(&mut self, degrees: f64) {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        self.plane = add(scale(cosine, self.plane), scale(sine, cross(self.travels, self.plane)));
    }

    /// Meets a mirror at this sine and cosine of incidence, on the side of the plane's vector.
    fn reflect(&mut self, sin: f64, cos: f64, by: TurnedBy) -> Turn {
        let wo = scale(-1.0, self.travels);
        let normal = add(scale(cos, wo), scale(sin, self.plane));
        let wi = add(scale(2.0 * dot(wo, normal), normal), scale(-1.0, wo));
        let across = cross(self.travels, self.plane);
        self.travels = wi;
        self.plane = cross(across, wi);
        Turn { wo, wi, normal, by }
    }

    fn pass(&self, n: f64) -> Turn {
        Turn { wo: scale(-1.0, self.travels), wi: self.travels, normal: self.travels, by: TurnedBy::Refraction { n } }
    }

    /// Meets a face at right angles. On the way back the first wall of a rhomb is the other one.
    fn turn_back(&mut self, n: f64) -> Turn {
        let wo = scale(-1.0, self.travels);
        self.travels = wo;
        self.plane = scale(-1.0, self.plane);
        Turn { wo, wi: wo, normal: wo, by: TurnedBy::Reflection { n, k: 0.0 } }
    }

    /// From the middle of a face of a rhomb to that of the other, by two total reflections.
    fn through_rhomb(&mut self, sin2: f64, mut turns: impl FnMut(Turn)) {
        let (sin, cos) = (sin2.sqrt(), (1.0 - sin2).sqrt());
        // tan of the angle between ray and wall.
        let tan = cos / sin;
        let total = TurnedBy::Reflection { n: 1.0 / DENSE, k: 0.0 };
        self.advance(0.5 * RHOMB_SIDE_M / tan);
        turns(self.reflect(sin, cos, total));
        self.advance(RHOMB_SIDE_M / tan);
        // The opposite wall.
        self.plane = scale(-1.0, self.plane);
        turns(self.reflect(sin, cos, total));
        self.plane = scale(-1.0, self.plane);
        self.advance(0.5 * RHOMB_SIDE_M / tan);
    }
}

/// A rhomb that a ray is about to enter at the middle of its first face; the first wall is met where the plane's vector points away
/// from it.
fn rhomb(ray: &Ray, sin2: f64) -> serde_json::Value {
    let (sin, cos) = (sin2.sqrt(), (1.0 - sin2).sqrt());
    let (tan, half) = (cos / sin, 0.5 * RHOMB_SIDE_M);
    // cos of twice the angle between ray and wall, by which the ray is turned.
    let length = RHOMB_SIDE_M / tan * (1.0 + sin2 - (1.0 - sin2));
    // Along the ray, and across it away from the plane's vector; counter-clockwise seen against `deep`.
    let (along, up) = (ray.travels, scale(-1.0, ray.plane));
    let deep = cross(along, up);
    let corners = [[0.0, -half], [length, -half - length * tan], [length, half - length * tan], [0.0, half]];
    let at = |[x, y]: [f64; 2]| add(add(ray.at, scale(-half, deep)), add(scale(x, along), scale(y, up)));
    extruded(&corners.map(at), scale(2.0 * half, deep))
}

/// One order of reflection between faces at right angles to the path: the turns of the path, and the share of light that the faces pass on.
/// Polarisers and total reflections are not part of that share.
type Order = (Vec<Turn>, f64);

/// A scene of pieces in a row before a lamp, 3 m apart, and the direct path through them. Each plane of incidence is turned from the one
/// before by an angle about the ray between them.
fn chain(pieces: &[(Piece, f64)], spp: u32) -> (Scene, Vec<Turn>) {
    let mut scene = Scene::orthographic([0.0, 0.0, 2.0], [0.0; 3], 1e-3).spp(spp);
    let mut ray = Ray { at: [0.0; 3], travels: [0.0, 0.0, -1.0], plane: [1.0, 0.0, 0.0] };
    let mut turns = Vec::new();
    for &(piece, turned_deg) in pieces {
        ray.turn(turned_deg);
        let at = ray.at;
        match piece {
            Piece::Polariser => {
                let (sin, cos) = POLARISER.atan().sin_cos();
                let turn = ray.reflect(sin, cos, TurnedBy::Reflection { n: POLARISER, k: 0.0 });
                scene = scene.object(disk(at, turn.normal, 0.5), glass_in(POLARISER, 1.0));
                turns.push(turn);
            }
            Piece::Total { sin2 } => {
                let by = TurnedBy::Reflection { n: 1.0 / DENSE, k: 0.0 };
                let turn = ray.reflect(sin2.sqrt(), (1.0 - sin2).sqrt(), by);
                scene = scene.object(disk(at, turn.normal, 0.5), glass_in(1.0, DENSE));
                turns.push(turn);
            }
            Piece::Rhomb { sin2 } => {
                scene = scene.object(rhomb(&ray, sin2), glass(DENSE));
                turns.push(ray.pass(1.0 / DENSE));
                ray.through_rhomb(sin2, |turn| turns.push(turn));
                turns.push(ray.pass(DENSE));
            }
        }
        ray.advance(3.0);
    }
    let lamp = disk(ray.at, scale(-1.0, ray.travels), 0.5);
    (scene.lamp(lamp, black(), 1.0, "front"), turns)
}

fn truth(name: &str, pieces: &[(Piece, f64)], value: f64, formula: &str) -> Truth {
    let (scene, path) = chain(pieces, 2048);
    let averaged = averaged(pieces);
    Truth::new(name, &scene, value, formula)
        .confirmed("tracing the electric field along the path", 1e-9, move || {
            averaged * stokes_along(&path, [1.0, 0.0, 0.0])[0]
        })
        .sees(0.05)
        .or_else("polarisations averaged at each mirror", averaged)
        .claims(Claim::CarriesPolarisation)
}

/// What the polarisers of a chain reflect of light whose polarisations are averaged at each.
fn averaged(pieces: &[(Piece, f64)]) -> f64 {
    let reflectance = fresnel_exact(POLARISER.atan().cos(), POLARISER).reflectance();
    let polarisers = pieces.iter().filter(|(piece, _)| *piece == Piece::Polariser).count();
    reflectance.powi(i32::try_from(polarisers).expect("a few mirrors"))
}

/// What a face of a rhomb reflects.
fn reflectance_of_face() -> f64 {
    fresnel_exact(1.0, DENSE).reflectance()
}

/// What two rhombs one behind the other pass on, with all orders of reflection between their four faces. Each passage through a rhomb
/// multiplies by z, whose phase is how far s falls behind p. Real and imaginary part.
fn two_rhombs([re, im]: [f64; 2]) -> [f64; 2] {
    let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
    let over = |a: [f64; 2], b: [f64; 2]| {
        let square = b[0] * b[0] + b[1] * b[1];
        [(a[0] * b[0] + a[1] * b[1]) / square, (a[1] * b[0] - a[0] * b[1]) / square]
    };
    let r = reflectance_of_face();
    let t2 = (1.0 - r) * (1.0 - r);
    let z2 = times([re, im], [re, im]);
    let rest = [1.0 - r * r * z2[0], -r * r * z2[1]];
    // One rhomb: T²z/(1 − R²z²) through it, R + T²Rz²/(1 − R²z²) back from it.
    let through = over([t2 * re, t2 * im], rest);
    let back = over([t2 * r * z2[0], t2 * r * z2[1]], rest);
    let back = [back[0] + r, back[1]];
    let both = times(back, back);
    over(times(through, through), [1.0 - both[0], -both[1]])
}

/// Ways through one rhomb or two, and those that are left to walk.
struct Walk {
    /// Of the total reflections.
    sin2: f64,
    /// The face that is nearest to the lamp.
    last: usize,
    orders: Vec<Order>,
}

impl Walk {
    /// On from a ray that is about to meet a face: 0 and 1 bound the first rhomb, 2 and 3 the second if there is one. At most `left` faces reflect.
    fn step(&mut self, ray: Ray, (face, forward): (usize, bool), path: &[Turn], share: f64, left: u32) {
        let enters = face.is_multiple_of(2) == forward;
        let beyond = if enters { DENSE } else { 1.0 / DENSE };
        let (ahead, behind) = if forward { (face + 1, face.wrapping_sub(1)) } else { (face.wrapping_sub(1), face + 1) };
        let reflectance = reflectance_of_face();

        let starts_from_outside = enters && !(1..=2).contains(&face);
        if left > 0 && !starts_from_outside {
            let (mut back, mut turns) = (ray, path.to_vec());
            turns.push(back.turn_back(beyond));
            if !enters {
                back.through_rhomb(self.sin2, |turn| turns.push(turn));
            }
            self.step(back, (behind, !forward), &turns, share * reflectance, left - 1);
        }
        let (mut on, mut turns) = (ray, path.to_vec());
        turns.push(on.pass(1.0 / beyond));
        if enters {
            on.through_rhomb(self.sin2, |turn| turns.push(turn));
        }
        let share = share * (1.0 - reflectance);
        match (face, forward) {
            (face, true) if face == self.last => self.orders.push((turns, share)),
            // Back toward the eye.
            (0, false) => {}
            _ => self.step(on, (ahead, forward), &turns, share, left),
        }
    }
}

/// The Stokes vector at the eye, by way of one rhomb or two before the mirror next to the lamp. It has all orders of at most eight
/// reflections at faces, and is divided by what the mirrors reflect of light whose polarisations are averaged at each. `direct` is the direct
/// path. If it is `analysed`, it begins with a mirror, from which the planes of the rhombs are turned by 45°.
fn along_orders(direct: &[Turn], analysed: bool, sin2: f64, right: Vec3) -> [f64; 4] {
    let (first, rest) = direct.split_at(usize::from(analysed));
    let (mirror, between) = rest.split_last().expect("a chain ends with a mirror");
    let mut ray = Ray { at: [0.0; 3], travels: [0.0, 0.0, -1.0], plane: [1.0, 0.0, 0.0] };
    if let [first] = first {
        let (sin, cos) = POLARISER.atan().sin_cos();
        ray.reflect(sin, cos, first.by);
        ray.turn(45.0);
    }
    // Four turns each.
    let mut walk = Walk { sin2, last: between.len() / 2 - 1, orders: Vec::new() };
    walk.step(ray, (0, true), &[], 1.0, 8);
    assert_eq!(walk.orders.iter().map(|(turns, _)| turns.len()).min(), Some(between.len()), "the direct path");
    let mut stokes = [0.0; 4];
    for (turns, share) in walk.orders {
        let path = [first, &turns[..], &[*mirror]].concat();
        let order = stokes_along(&path, right);
        (0..4).for_each(|i| stokes[i] += share * order[i]);
    }
    stokes
}

pub(super) fn truths() -> Vec<Truth> {
    let brewster = fresnel_exact(POLARISER.atan().cos(), POLARISER).r_s;
    let malus = |degrees: f64| 0.5 * brewster * brewster * degrees.to_radians().cos().powi(2);
    let because = "At Brewster's angle a dielectric reflects s alone, R_s = ((n² − 1)/(n² + 1))² of it. Of light that the one mirror polarises \
         the other reflects cos² of the angle between their planes of incidence.";
    let mut list: Vec<Truth> = [(0.0, "parallel"), (30.0, "at-30-degrees"), (60.0, "at-60-degrees")]
        .into_iter()
        .map(|(degrees, how)| {
            truth(
                &format!("brewster-mirrors-{how}"),
                &[(Piece::Polariser, 0.0), (Piece::Polariser, degrees)],
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
            &[(Piece::Polariser, 0.0), (Piece::Total { sin2 }, 45.0), (Piece::Polariser, 45.0)],
            malus(0.0) * FRAC_PI_8.sin().powi(2),
            "½R_s² sin²(δ/2), δ = 45°",
        )
        .because(
            "Light at 45° to the plane of a total reflection comes out of it with s 45° behind p: elliptical. Of the two diagonals an analyser \
             then passes cos²(δ/2) and sin²(δ/2). Two such reflections are Fresnel's rhomb.",
        )
        .or_else("total reflection without its phase", malus(0.0)),
    );
    list.push(two_rhombs_between_crossed_mirrors(malus(0.0), sin2));
    let beside = companions::truths(&list, brewster, sin2);
    list.extend(beside);
    list
}

/// `parallel` is what two mirrors with parallel planes hand on.
fn two_rhombs_between_crossed_mirrors(parallel: f64, sin2: f64) -> Truth {
    let rhomb = Piece::Rhomb { sin2 };
    let pieces = [(Piece::Polariser, 0.0), (rhomb, 45.0), (rhomb, 0.0), (Piece::Polariser, 45.0)];
    let (scene, direct) = chain(&pieces, 4096);
    let averaged = averaged(&pieces);
    let [whole, _] = two_rhombs([1.0, 0.0]);
    // What a passage through a rhomb that puts s by this angle behind p leaves for the crossed analyser: (1 − cos δ)/2 of each order.
    let crossed = |behind: f64| {
        let (sin, cos) = behind.sin_cos();
        parallel * 0.5 * (whole - two_rhombs([cos, sin])[0])
    };
    let quarter_turn = std::f64::consts::FRAC_PI_2;
    Truth::new(
        "two-fresnel-rhombs-between-crossed-brewster-mirrors",
        &scene,
        crossed(quarter_turn),
        "½R_s²·½(τ(1) − Re τ(i)), τ(z) = t²/(1 − r²), t = T²z/(1 − R²z²), r = R + RT²z²/(1 − R²z²)",
    )
    .because(
        "A Fresnel rhomb puts s a quarter of a wave behind p by two total reflections; two of them are a half-wave plate, which at 45° turns \
         linear light by 90°, so that crossed mirrors hand it on. Light that is reflected between the four faces, which it meets at right \
         angles, goes through rhombs more often: each passage multiplies by z, whose phase is what s gets behind p.",
    )
    .confirmed("tracing the electric field along every path of at most eight reflections at faces", 1e-9, move || {
        averaged * along_orders(&direct, true, sin2, [1.0, 0.0, 0.0])[0]
    })
    .sees(0.05)
    .or_else("polarisations averaged at each surface", averaged * whole)
    .or_else("total reflection without its phase", crossed(0.0))
    .or_else("every total reflection with half its phase", crossed(0.5 * quarter_turn))
    .claims(Claim::CarriesPolarisation)
}
