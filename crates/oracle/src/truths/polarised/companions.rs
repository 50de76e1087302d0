//! S₁, S₂ and S₃ of the same chains, and of chains without the mirror next to the eye.

use std::f64::consts::FRAC_PI_4;

use super::{Piece, along_orders, averaged, chain, two_rhombs};
use crate::laws::stokes_along;
use crate::truths::companions::{Light, ROLL_DEG, companions, keeping_stokes, rolled, seen_rolled};
use crate::truths::{Claim, Truth};
use crate::vector::Vec3;

const RIGHT: Vec3 = [1.0, 0.0, 0.0];
const UP: Vec3 = [0.0, 1.0, 0.0];
/// Samples of each of the 64 pixels.
const PATHS: u32 = 4096;

pub(super) fn truths(list: &[Truth], brewster: f64, sin2: f64) -> Vec<Truth> {
    let mut companions = analysed(list, brewster, sin2);
    companions.extend(half_a_rhomb(brewster, sin2));
    companions.extend(rhombs(brewster, sin2));
    companions
}

/// The right of the rolled camera.
fn rolled_right() -> Vec3 {
    let (sin, cos) = ROLL_DEG.to_radians().sin_cos();
    [cos, -sin, 0.0]
}

/// What a mirror next to the eye reflects swings across its plane of incidence, which is that of the rows of a camera without roll.
fn analysed(list: &[Truth], brewster: f64, sin2: f64) -> Vec<Truth> {
    let malus = |degrees: f64| 0.5 * brewster * brewster * degrees.to_radians().cos().powi(2);
    let mirrors = |degrees: f64| vec![(Piece::Polariser, 0.0), (Piece::Polariser, degrees)];
    let between = |pieces: &[Piece]| {
        let mut chain = vec![(Piece::Polariser, 0.0)];
        chain.extend(pieces.iter().enumerate().map(|(i, &piece)| (piece, if i == 0 { 45.0 } else { 0.0 })));
        chain.push((Piece::Polariser, 45.0));
        chain
    };
    let rhomb = Piece::Rhomb { sin2 };
    let unturned = "frames that are not turned from mirror to mirror";
    let no_phase = "total reflection without its phase";
    let mut truths = Vec::new();
    for (name, pieces, mistake) in [
        ("brewster-mirrors-parallel", mirrors(0.0), None),
        ("brewster-mirrors-at-30-degrees", mirrors(30.0), Some((unturned, malus(0.0)))),
        ("brewster-mirrors-at-60-degrees", mirrors(60.0), Some((unturned, malus(0.0)))),
        ("half-a-rhomb-between-brewster-mirrors", between(&[Piece::Total { sin2 }]), Some((no_phase, malus(0.0)))),
        ("two-fresnel-rhombs-between-crossed-brewster-mirrors", between(&[rhomb, rhomb]), None),
    ] {
        let base = list.iter().find(|truth| truth.name == name).expect("a truth of this list");
        let along_s = |intensity: f64| seen_rolled([-intensity, 0.0, 0.0]);
        let mut mistakes = vec![("the roll left out", [-base.value(), 0.0, 0.0])];
        mistakes.extend(mistake.map(|(what, intensity)| (what, along_s(intensity))));
        let light = Light {
            stokes: along_s(base.value()),
            formula: "what the mirrors hand on, times −cos 50°, −sin 50°",
            because: "The mirror next to the eye, at Brewster's angle, reflects s alone: along y, which lies at the roll's angle to the columns \
                      of the picture.",
            mistakes: &mistakes,
            // Paths among the faces of rhombs are long.
            sees: if pieces.len() > 3 { 0.2 } else { 0.1 },
            how: ("tracing the electric field along the path", 1e-9),
        };
        let base = keeping_stokes(base, name, |scene| rolled(scene, RIGHT, UP, PATHS));
        let (averaged, (_, path)) = (averaged(&pieces), chain(&pieces, PATHS));
        truths.extend(companions(&base, &light, move || {
            let stokes = match path.len() {
                0..4 => stokes_along(&path, rolled_right()),
                _ => along_orders(&path, true, sin2, rolled_right()),
            };
            [1, 2, 3].map(|i| averaged * stokes[i])
        }));
    }
    truths
}

/// A scene of pieces seen by a rolled camera, with the direct path. The value of the truth counts for nothing.
fn unanalysed(name: &str, pieces: &[(Piece, f64)]) -> (Truth, Vec<super::Turn>) {
    let (scene, path) = chain(pieces, PATHS);
    let base = Truth::new(name, &scene, 0.0, "").claims(Claim::CarriesPolarisation);
    (keeping_stokes(&base, name, |scene| rolled(scene, RIGHT, UP, PATHS)), path)
}

/// S₁, S₂ and S₃ in the picture of light of an intensity that a mirror made swing at 45° to the planes of total reflections, of which p and s
/// were multiplied by amplitudes whose product a_p a_s* is this.
fn at_45_degrees(intensity: f64, product: [f64; 2]) -> [f64; 3] {
    seen_rolled([0.0, intensity * product[0], intensity * product[1]])
}

fn half_a_rhomb(brewster: f64, sin2: f64) -> Vec<Truth> {
    let pieces = [(Piece::Total { sin2 }, 0.0), (Piece::Polariser, 45.0)];
    let (base, path) = unanalysed("half-a-rhomb-before-a-brewster-mirror", &pieces);
    // s is put behind p.
    let behind = |angle: f64| at_45_degrees(0.5 * brewster, [angle.cos(), -angle.sin()]);
    let light = Light {
        stokes: behind(FRAC_PI_4),
        formula: "½R_s times −cos 45° sin 50°, cos 45° cos 50°, −sin 45°",
        because: "Light at 45° to the plane of a total reflection comes out of it with s, along y, δ = 45° behind p, along x: \
                  S₂ + iS₃ = 2E_xE_y* ∝ e^(−iδ) in fields that run as e^(−iωt). The camera is rolled.",
        mistakes: &[
            ("total reflection without its phase", behind(0.0)),
            ("twice its phase", behind(2.0 * FRAC_PI_4)),
            ("the roll left out", [0.0, 0.5 * brewster * FRAC_PI_4.cos(), -0.5 * brewster * FRAC_PI_4.sin()]),
        ],
        sees: 0.05,
        how: ("tracing the electric field along the path", 1e-9),
    };
    let averaged = averaged(&pieces);
    companions(&base, &light, move || {
        let stokes = stokes_along(&path, rolled_right());
        [1, 2, 3].map(|i| averaged * stokes[i])
    })
}

/// A quarter of a wave, which makes light circular, and half a wave, which turns it by 90°.
fn rhombs(brewster: f64, sin2: f64) -> Vec<Truth> {
    let rhomb = Piece::Rhomb { sin2 };
    let mut truths = Vec::new();
    for count in [1, 2] {
        let mut pieces = vec![(rhomb, 0.0); count];
        pieces.push((Piece::Polariser, 45.0));
        let name = ["fresnel-rhomb-before-a-brewster-mirror", "two-fresnel-rhombs-before-a-brewster-mirror"][count - 1];
        let (base, path) = unanalysed(name, &pieces);
        let behind = |quarters: f64| {
            let (sin, cos) = (2.0 * FRAC_PI_4 * quarters).sin_cos();
            at_45_degrees(0.5 * brewster, if count == 1 { one_rhomb([cos, -sin]) } else { two_rhombs([cos, -sin]) })
        };
        let light = Light {
            stokes: behind(1.0),
            formula: ["½R_s times 0, 0, −T²/(1 + R²)", "½R_s Re τ(−i) times −sin 50°, cos 50°, 0"][count - 1],
            because: "A Fresnel rhomb puts s, along y, a quarter of a wave behind p, along x: a passage multiplies S₂ + iS₃ = 2E_xE_y* by −i, \
                      and so does each passage of light that was reflected between faces. τ(z) is the sum of all orders. The camera is rolled.",
            mistakes: &[
                ("total reflection without its phase", behind(0.0)),
                ("every total reflection with half its phase", behind(0.5)),
            ],
            sees: 0.1,
            how: ("tracing the electric field along every path of at most eight reflections at faces", 1e-9),
        };
        let averaged = averaged(&pieces);
        truths.extend(companions(&base, &light, move || {
            let stokes = along_orders(&path, false, sin2, rolled_right());
            [1, 2, 3].map(|i| averaged * stokes[i])
        }));
    }
    truths
}

/// T²z/(1 − R²z²), what a rhomb passes on with all orders of reflection between its faces, each passage multiplying by z.
fn one_rhomb([re, im]: [f64; 2]) -> [f64; 2] {
    let r = super::reflectance_of_face();
    let (r2, t2) = (r * r, (1.0 - r) * (1.0 - r));
    // Times the conjugate of 1 − R²z².
    let [down_re, down_im] = [1.0 - r2 * (re * re - im * im), -r2 * 2.0 * re * im];
    let square = down_re * down_re + down_im * down_im;
    [t2 * (re * down_re + im * down_im) / square, t2 * (im * down_re - re * down_im) / square]
}
