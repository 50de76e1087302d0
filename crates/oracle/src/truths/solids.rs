//! Solids that touch, overlap and float in each other.

use super::{
    Claim, Truth,
    irradiance::stack_transmittance,
    scene::{Scene, black, block, conductor, lambert, level_square, parallelogram, solid, sphere},
};
use crate::laws::fresnel_exact;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = sandwiches();
    list.extend(furnaces());
    list.push(metal_under_water());
    list.push(lamp_in_an_overlap());
    list
}

const GLASS: f64 = 1.5;
const WATER: f64 = 1.33;

/// R at 30° into glass, and at the angle that this becomes inside between glass and water.
fn reflectances() -> (f64, f64) {
    let (sine, cosine) = 30.0_f64.to_radians().sin_cos();
    let inside = (1.0 - (sine / GLASS).powi(2)).sqrt();
    (fresnel_exact(cosine, GLASS).reflectance(), fresnel_exact(inside, WATER / GLASS).reflectance())
}

/// A layer of water between two of glass, each a block, seen through at 30°: exactly touching, overlapping, or with a layer
/// of water that is not there to be seen.
fn sandwiches() -> Vec<Truth> {
    let (sine, cosine) = 30.0_f64.to_radians().sin_cos();
    let layer = |top: f64, bottom: f64| block([-10.0, -10.0, bottom], [10.0, 10.0, top]);
    let base = || {
        Scene::orthographic([sine, 0.0, cosine], [0.0; 3], 1e-3)
            .lamp(level_square([0.0, 0.0, -1.0], 10.0, true), black(), 1.0, "front")
            .spp(1024)
    };
    let (outer, inner) = reflectances();
    let water_in_air = fresnel_exact(cosine, WATER).reflectance();
    let faces = [outer, inner, inner, outer];
    let film_of_air = stack_transmittance(&[outer, outer, water_in_air, water_in_air, outer, outer]);
    let because = "For lossless layers whose beams add as powers, R/T adds up: T = 1/(1 + ΣRᵢ/(1 − Rᵢ)) (Stokes 1862). Where solids \
         overlap, the one of the highest priority is there, so that four interfaces are left.";
    let truth = |name: &str, scene: Scene, faces: &[f64], mistake: &'static str, mistaken: f64| {
        Truth::new(name, &scene, stack_transmittance(faces), "1/(1 + ΣRᵢ/(1 − Rᵢ))")
            .because(because)
            .or_else(mistake, mistaken)
            .sees(0.01)
            .claims(Claim::Priorities)
            .claims(Claim::AveragesPolarisation)
    };
    let touching = |glass: u32, water: u32| {
        base()
            .object(layer(0.0, -0.01), solid(GLASS, glass))
            .object(layer(-0.01, -0.02), solid(WATER, water))
            .object(layer(-0.02, -0.03), solid(GLASS, glass))
    };
    let overlapping = base()
        .object(layer(0.0, -0.01), solid(GLASS, 2))
        .object(layer(-0.01 + 1e-6, -0.02 - 1e-6), solid(WATER, 1))
        .object(layer(-0.02, -0.03), solid(GLASS, 2));
    // The middle block is of glass and comes later: of equal priorities it wins over the water that it shares a place with.
    let tie = base().object(layer(0.0, -0.03), solid(WATER, 1)).object(layer(-0.01, -0.02), solid(GLASS, 1));
    let tie_lost = base().object(layer(-0.01, -0.02), solid(GLASS, 1)).object(layer(0.0, -0.03), solid(WATER, 1));
    let in_water = (1.0 - (sine / WATER).powi(2)).sqrt();
    let to_glass = fresnel_exact(in_water, GLASS / WATER).reflectance();
    let through_both = stack_transmittance(&[water_in_air, to_glass, to_glass, water_in_air]);
    let through_water = stack_transmittance(&[water_in_air; 2]);
    vec![
        truth("solids-touching-at-30-degrees", touching(1, 0), &faces, "a film of air between", film_of_air),
        truth("solids-touching-priorities-reversed", touching(0, 1), &faces, "a film of air between", film_of_air),
        truth("solids-touching-equal-priorities", touching(3, 3), &faces, "a film of air between", film_of_air),
        truth(
            "solids-overlapping-at-30-degrees",
            overlapping,
            &faces,
            "all faces are interfaces with air",
            film_of_air,
        ),
        truth(
            "solids-equal-priorities-later-wins",
            tie,
            &[water_in_air, to_glass, to_glass, water_in_air],
            "the earlier wins",
            through_water,
        ),
        truth("solids-equal-priorities-earlier-loses", tie_lost, &[water_in_air; 2], "the earlier wins", through_both),
    ]
}

fn furnaces() -> Vec<Truth> {
    let nested = |eye: Scene| {
        eye.object(block([-1.0; 3], [1.0; 3]), solid(GLASS, 1))
            .object(sphere([0.1, 0.0, 0.0], 0.7), solid(WATER, 2))
            .object(sphere([0.1, 0.1, 0.0], 0.4), solid(GLASS, 3))
            // Half out of the glass ball, half in it: a bubble.
            .object(sphere([0.35, 0.1, 0.1], 0.3), solid(1.0, 4))
            .sky(1.0)
            .spp(256)
    };
    let lossless = "Lossless interfaces in uniform light change nothing, however they are nested: along every path reflected and refracted \
         parts add up, and n² of the way in is undone on the way out.";
    let mut list = vec![
        Truth::new(
            "furnace-glass-in-water-in-glass",
            &nested(Scene::orthographic([2.0, 3.0, 4.0], [0.0; 3], 3.0)),
            1.0,
            "L = 1",
        )
        .because(lossless)
        .or_else("radiance not scaled back on the way out of overlapping bodies", WATER * WATER)
        .sees(0.01)
        .claims(Claim::Priorities),
    ];
    for (name, at, n, where_from) in [
        ("eye-in-glass-in-water-in-glass", [-0.2, 0.1, 0.0], GLASS, "the inner glass"),
        ("eye-in-water-in-glass", [-0.45, 0.0, 0.0], WATER, "the water"),
        ("eye-in-a-bubble", [0.45, 0.1, 0.1], 1.0, "the bubble"),
    ] {
        list.push(
            Truth::new(name, &nested(Scene::pinhole(at, [0.0, 0.0, 5.0], 90.0)), n * n, "n²L")
                .because(match where_from {
                    "the bubble" => "Radiance over n² is the same along a lossless path, so in a bubble it is that of the sky.",
                    _ => "Radiance over n² is the same along a lossless path: the eye sees n² times the sky, n the index of the place it is in.",
                })
                .or_else("the eye's own medium not known", if n == WATER { GLASS * GLASS } else { WATER * WATER })
                .sees(0.01)
                .claims(Claim::Priorities),
        );
    }
    list
}

/// Metal at the bottom of a basin of water, the two exactly touching, seen straight down under a sky.
fn metal_under_water() -> Truth {
    let (n, k) = (0.2, 3.4);
    let scene = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 0.5)
        .object(block([-10.0, -10.0, -1.0], [10.0, 10.0, 0.0]), solid(WATER, 0))
        .object(block([-10.0, -10.0, -2.0], [10.0, 10.0, -1.0]), conductor(n, k))
        .sky(1.0)
        .spp(1024);
    let surface = fresnel_exact(1.0, WATER).reflectance();
    let seen_through = |metal: f64| surface + (1.0 - surface).powi(2) * metal / (1.0 - surface * metal);
    let bordering = |m: f64| ((n - m).powi(2) + k * k) / ((n + m).powi(2) + k * k);
    let (in_water, in_vacuum) = (bordering(WATER), bordering(1.0));
    Truth::new(
        "metal-touching-water",
        &scene,
        seen_through(in_water),
        "R₁ + T₁²R₂/(1 − R₁R₂), R₂ = |(n + ik − 1.33)/(n + ik + 1.33)|²",
    )
    .because(
        "Light is reflected to and fro between the water's surface and the metal, which borders on water: its index counts \
         relative to 1.33.",
    )
    .or_else("the metal as seen from vacuum", seen_through(in_vacuum))
    .sees(0.005)
    .claims(Claim::Priorities)
}

/// A lamp and a plate in a block of glass, and between them the face of a block of water that the glass overrules: shadow
/// rays and paths go through it as through nothing.
fn lamp_in_an_overlap() -> Truth {
    let half = 5e-4;
    let scene = Scene::orthographic([0.0, -0.75_f64.sqrt() * 0.01, 0.005], [0.0; 3], 1e-4)
        .object(parallelogram([-half, -half, 0.0], [2.0 * half, 0.0, 0.0], [0.0, 2.0 * half, 0.0]), lambert(0.5))
        .object(block([-20.0, -20.0, -1.0], [20.0, 20.0, 3.0]), solid(GLASS, 1))
        .object(block([-20.0, -20.0, 0.5], [20.0, 20.0, 2.0]), solid(WATER, 0))
        .lamp(sphere([0.0, 0.0, 1.0], 0.25), black(), 1.0, "front")
        .spp(2048);
    // E = πL(R/d)², of which the plate shows ρE/π; glass reflects light at its outer faces, far away and on no side black.
    let direct = 0.5 * 0.0625;
    Truth::new("lamp-behind-an-overruled-face", &scene.depth(2), direct, "ρL(R/d)², R = 0.25, d = 1")
        .because(
            "Eye, plate and lamp are in the same glass. A face of water inside it bounds nothing: neither is light lost there, nor is the \
             step counted as an edge of the path. Two edges are allowed, so that no light comes back from the block's own faces.",
        )
        .or_else("shadow rays stopped by the face, though paths are weighed as if they were not", 0.0)
        .sees(0.01)
        .claims(Claim::Priorities)
}
