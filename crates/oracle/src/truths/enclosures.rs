//! Closed rooms, cavities and mirrors: light that comes back again and again.

use std::f64::consts::PI;

use super::{
    Truth,
    scene::{Scene, black, block, glass, lambert, level_square, mirror, sphere, triangular_prism},
};
use crate::vector::Vec3;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = rooms();
    list.extend(cut_rooms());
    list.extend(integrating_spheres());
    list.extend(lamps_in_spheres());
    list.extend(plates());
    list.extend(mirror_rooms());
    list
}

const CLOSED: &str = "In a closed room whose walls all emit Le and reflect ρ diffusely, every wall sees the same radiance everywhere, so \
     L = Le + ρL: L = Le/(1 − ρ) = LeΣρᵏ, whatever the room's shape and size.";

/// Σ Leρᵏ to the number of terms, added up one by one.
fn series(emitted: f64, reflectance: f64, terms: u32) -> f64 {
    (0..terms).map(|k| emitted * reflectance.powi(k as i32)).sum()
}

fn rooms() -> Vec<Truth> {
    let ball = Scene::pinhole([0.3, 0.2, 0.1], [-1.0, 0.3, 0.5], 90.0)
        .lamp(sphere([0.0; 3], 1.0), lambert(0.5), 0.5, "back")
        .spp(512);
    let bright = Scene::pinhole([0.3, 0.2, 0.1], [-1.0, 0.3, 0.5], 90.0)
        .lamp(block([-1.0; 3], [1.0; 3]), lambert(0.8), 1.0, "back")
        .spp(256);
    let cube = |name: &str, center: Vec3, half: f64, peer: f64| {
        let at = |offset: Vec3| [0, 1, 2].map(|i| center[i] + half * offset[i]);
        let scene = Scene::pinhole(at([0.3, 0.2, 0.1]), at([-1.0, 0.3, 0.5]), 90.0)
            .lamp(block(at([-1.0; 3]), at([1.0; 3])), lambert(0.5), 0.5, "back")
            .spp(256);
        Truth::new(name, &scene, 1.0, "Le/(1 − ρ), Le = ρ = ½")
            .because(CLOSED)
            .confirmed("the series, 60 terms", 1e-12, || series(0.5, 0.5, 60))
            .or_else("light leaks or is shadowed at the walls: what a peer was measured to read", peer)
            .sees(0.01)
    };
    let apex = 0.03_f64.to_radians();
    let wedge_height = 10.0 * (0.5 * apex).tan();
    let wedge = Scene::pinhole([9.0, 0.0, 0.0], [0.0; 3], 1.0)
        .lamp(
            triangular_prism([[0.0, 0.0], [10.0, -wedge_height], [10.0, wedge_height]], [-1.0, 1.0]),
            lambert(0.5),
            0.5,
            "back",
        )
        .spp(256);
    let with_glass = Scene::pinhole([0.0, 0.0, 0.95], [0.0; 3], 40.0)
        .lamp(block([-1.0; 3], [1.0; 3]), lambert(0.5), 0.5, "back")
        .object(sphere([0.0; 3], 0.5), glass(1.5))
        .spp(256);
    let with_mirror = Scene::pinhole([0.0, 0.0, 0.95], [0.0; 3], 40.0)
        .lamp(block([-1.0; 3], [1.0; 3]), lambert(0.5), 0.5, "back")
        .object(sphere([0.0; 3], 0.5), mirror(1.0))
        .spp(256);
    let formula = "Le/(1 − ρ), Le = ρ = ½";
    vec![
        Truth::new("room-sphere", &ball, 1.0, formula)
            .because(CLOSED)
            .or_else("emission found by shadow rays and by BSDF rays, both in full", 1.5)
            .or_else("a spherical light sampled from inside as from outside", 1.0086)
            .sees(0.008),
        Truth::new("room-bright", &bright, 5.0, "Le/(1 − ρ), Le = 1, ρ = 0.8")
            .because(CLOSED)
            .confirmed("the series, 200 terms", 1e-12, || series(1.0, 0.8, 200))
            .or_else("paths cut at 16 edges", series(1.0, 0.8, 16))
            .or_else("emission found by shadow rays and by BSDF rays, both in full", 9.0),
        cube("room-cube", [0.0; 3], 1e-3, 0.989),
        cube("room-cube-of-ten-micrometres", [0.0; 3], 1e-5, 0.52),
        cube("room-cube-of-a-hundred-kilometres", [0.0; 3], 1e5, 0.989),
        cube("room-cube-moved-a-thousand-sizes", [1e3, -7e2, 5e2], 1.0, 0.989),
        cube("room-cube-moved-thirty-thousand-sizes", [3e4, -2e4, 1e4], 1.0, 0.52),
        Truth::new("room-wedge", &wedge, 1.0, formula)
            .because(CLOSED)
            .or_else("a fixed offset crosses the other wall of the wedge of 0.03°", 0.5),
        Truth::new("room-with-glass-ball", &with_glass, 1.0, formula)
            .because(
                "In uniform light a lossless glass body changes nothing: the room with a ball in it is the room without it. \
                 Light that reaches a wall through the ball is found by no shadow ray.",
            )
            .sees(0.015),
        Truth::new("room-with-mirror-ball", &with_mirror, 1.0, formula)
            .because("In uniform light a perfect mirror changes nothing.")
            .sees(0.015),
    ]
}

fn cut_rooms() -> Vec<Truth> {
    let room = |edges: u32| {
        Scene::pinhole([0.3, 0.2, 0.1], [-1.0, 0.3, 0.5], 90.0)
            .lamp(sphere([0.0; 3], 1.0), lambert(0.5), 0.5, "back")
            .depth(edges)
    };
    let truth = |edges: u32, scene: &Scene| {
        let value = 1.0 - 0.5_f64.powi(edges as i32);
        Truth::new(format!("room-cut-at-{edges}"), scene, value, "Le(1 − ρⁿ)/(1 − ρ), Le = ρ = ½")
            .because("A path of n edges from the camera to a light holds the first n terms of LeΣρᵏ.")
            .confirmed("the series, term by term", 1e-14, move || series(0.5, 0.5, edges))
            .or_else("never cut", 1.0)
    };
    let mut list: Vec<Truth> = [1_u32, 2, 3]
        .map(|edges| {
            truth(edges, &room(edges))
                .or_else("one edge more", 1.0 - 0.5_f64.powi(edges as i32 + 1))
                .or_else("one edge less", 1.0 - 0.5_f64.powi(edges as i32 - 1))
        })
        .into();
    list.push(truth(8, &room(8).spp(2048)).sees(0.004));
    list
}

fn integrating_spheres() -> Vec<Truth> {
    let centred = || {
        Scene::pinhole([0.5, 0.2, 0.3], [-0.6, 0.0, -0.1], 90.0)
            .object(sphere([0.0; 3], 1.0), lambert(0.8))
            .point_light([0.0; 3], 1.0)
            .spp(256)
    };
    let one = 0.8 / PI;
    let because = "A central point source of intensity I gives the wall E = I/R². Two points of a sphere exchange the same light \
         wherever they lie, so every later bounce gives a uniform ρ times the last: L = (ρE/π)Σρᵏ = ρI/(πR²(1 − ρ)).";
    let cut = |edges: u32| {
        let terms = edges - 1;
        Truth::new(
            format!("integrating-sphere-cut-at-{edges}"),
            &centred().depth(edges),
            series(one, 0.8, terms),
            "ρI/(πR²)·Σρᵏ to n − 1 terms, ρ = 0.8",
        )
        .because("The first edge leads to the wall, the last to the lamp: n edges hold n − 1 terms of the series.")
        .or_else("one edge more", series(one, 0.8, terms + 1))
    };
    // The lamp at half the radius: from the far wall 1.5 away, from the near one .5, both at normal incidence.
    let off_centre = |name: &str, wall: f64, distance: f64| {
        let scene = Scene::orthographic([0.0, 0.0, 0.5 * wall - 0.25], [0.0, 0.0, wall], 1e-3)
            .object(sphere([0.0; 3], 1.0), lambert(0.5))
            .point_light([0.0, 0.0, 0.5], 1.0)
            .spp(256);
        let direct = 1.0 / (distance * distance);
        Truth::new(name, &scene, 0.5 / PI * (direct + 1.0), "(ρ/π)(I/d² + (ρ/(1 − ρ))·I/R²), ρ = ½")
            .because(
                "The power 4πI falls on the wall of area 4πR², so the mean irradiance is I/R² wherever the lamp is, and all later \
                 bounces are uniform: Iρ/((1 − ρ)R²) of irradiance. The direct part is the wall's own, I·cosθ/d², θ = 0.",
            )
            .confirmed("mean irradiance by quadrature over the wall", 1e-9, move || {
                // The wall at height z is √(1.25 − z) from the lamp, under cosθ = (1 − z/2)/that.
                let irradiance = |z: f64| (1.0 - 0.5 * z) / (1.25 - z).powf(1.5);
                let mean = 0.5 * crate::quadrature::interval(irradiance, -1.0, 1.0, 1e-12).value;
                0.5 / PI * (irradiance(wall) + mean)
            })
            .or_else("as if the lamp were in the middle", 1.0 / PI)
            .or_else("no light but the direct", 0.5 / PI * direct)
    };
    vec![
        Truth::new("integrating-sphere", &centred(), one / 0.2, "ρI/(πR²(1 − ρ)), ρ = 0.8")
            .because(because)
            .confirmed("the series, 200 terms", 1e-12, move || series(one, 0.8, 200))
            .or_else("intensity taken for power", one / 0.2 / (4.0 * PI))
            .or_else("albedo of the first bounce left out", one / 0.16),
        cut(2),
        cut(4),
        off_centre("integrating-sphere-lamp-off-centre-far-wall", -1.0, 1.5),
        off_centre("integrating-sphere-lamp-off-centre-near-wall", 1.0, 0.5),
    ]
}

/// Two diffuse concentric spheres: the radiance of the wall and of the lamp, by iterating the exchange.
fn concentric(lamp_albedo: f64, wall_albedo: f64, share: f64) -> (f64, f64) {
    let (mut lamp, mut wall) = (1.0, 0.0);
    for _ in 0..400 {
        (lamp, wall) = (1.0 + lamp_albedo * wall, wall_albedo * (share * lamp + (1.0 - share) * wall));
    }
    (wall, lamp)
}

fn lamps_in_spheres() -> Vec<Truth> {
    let scene = |lamp_albedo: f64, look_at_lamp: bool| {
        let material = if lamp_albedo == 0.0 { black() } else { lambert(lamp_albedo) };
        let target = if look_at_lamp { [0.0; 3] } else { [0.0, 0.0, 1.0] };
        Scene::pinhole([0.0, 0.0, 0.75], target, 60.0)
            .object(sphere([0.0; 3], 1.0), lambert(0.6))
            .lamp(sphere([0.0; 3], 0.5), material, 1.0, "front")
            .spp(256)
    };
    let because = "The lamp of radius r sees only the wall; the wall of radius R sees the lamp with the factor (r/R)² and itself with \
         1 − (r/R)² from everywhere alike: L₁ = Le + ρ₁L₂, L₂ = ρ₂((r/R)²L₁ + (1 − (r/R)²)L₂).";
    vec![
        Truth::new("lamp-in-a-sphere", &scene(0.0, false), 3.0 / 11.0, "ρ₂s/(1 − ρ₂(1 − s)), s = ¼, ρ₂ = 0.6")
            .because(because)
            .confirmed("iterated exchange", 1e-12, || concentric(0.0, 0.6, 0.25).0)
            .or_else("direct light only", 0.15)
            .or_else("the lamp does not shadow the wall from itself", 0.375),
        Truth::new("diffuse-lamp-in-a-sphere", &scene(0.5, false), 6.0 / 19.0, "ρ₂s/(1 − ρ₂(1 − s) − ρ₁ρ₂s), ρ₁ = ½")
            .because(because)
            .confirmed("iterated exchange", 1e-12, || concentric(0.5, 0.6, 0.25).0)
            .or_else("a lamp that reflects nothing", 3.0 / 11.0),
        Truth::new("diffuse-lamp-in-a-sphere-seen", &scene(0.5, true), 22.0 / 19.0, "Le + ρ₁L₂")
            .because(because)
            .confirmed("iterated exchange", 1e-12, || concentric(0.5, 0.6, 0.25).1)
            .or_else("a lamp that reflects nothing", 1.0),
    ]
}

fn plates() -> Vec<Truth> {
    let half = 2e4;
    let between = |target: f64| {
        Scene::orthographic([0.0, 0.0, 0.5], [0.0, 0.0, target], 1e-2)
            .lamp(level_square([0.0; 3], half, true), lambert(0.5), 1.0, "front")
            .object(level_square([0.0, 0.0, 1.0], half, false), lambert(0.7))
            .spp(256)
    };
    let because = "Between infinite diffuse plates everything is uniform: L₁ = Le + ρ₁L₂ and L₂ = ρ₂L₁. Squares 4·10⁴ times as wide as \
         their distance lose (distance/half side)², 3·10⁻⁹ of the light in the middle.";
    let exchange = |steps: u32| {
        let (mut lower, mut upper) = (1.0, 0.0);
        for _ in 0..steps {
            (lower, upper) = (1.0 + 0.5 * upper, 0.7 * lower);
        }
        (lower, upper)
    };
    vec![
        Truth::new("parallel-plates-lower", &between(0.0), 1.0 / 0.65, "1/(1 − ρ₁ρ₂), ρ₁ = ½, ρ₂ = 0.7")
            .because(because)
            .confirmed("iterated exchange", 1e-12, move || exchange(200).0)
            .or_else("one bounce only", 1.35),
        Truth::new("parallel-plates-upper", &between(1.0), 0.7 / 0.65, "ρ₂/(1 − ρ₁ρ₂)")
            .because(because)
            .confirmed("iterated exchange", 1e-12, move || exchange(200).1)
            .or_else("direct light only", 0.7),
    ]
}

fn mirror_rooms() -> Vec<Truth> {
    let room = |rho: f64, spp: u32| {
        Scene::pinhole([0.3, 0.2, 0.1], [-1.0, 0.3, 0.5], 90.0)
            .lamp(block([-1.0; 3], [1.0; 3]), mirror(rho), 1.0 - rho, "back")
            .spp(spp)
    };
    let because = "Every ray in a closed room of mirrors meets wall after wall: L = LeΣρᵏ = Le/(1 − ρ). Russian roulette whose survival \
         probability q is capped below ρ² has no finite variance here.";
    vec![
        Truth::new("mirror-room", &room(0.9, 256), 1.0, "Le/(1 − ρ), ρ = 0.9, Le = 0.1")
            .because(because)
            .confirmed("the series, 400 terms", 1e-12, || series(0.1, 0.9, 400))
            .or_else("paths cut at 20 edges", 1.0 - 0.9_f64.powi(20)),
        Truth::new("mirror-room-of-a-thousand-bounces", &room(0.999, 12), 1.0, "Le/(1 − ρ), ρ = 0.999, Le = 0.001")
            .because(because)
            .or_else("roulette capped at 0.95: what a finite sample shows", 0.3)
            .or_else("paths cut at 1000 edges", 1.0 - 0.999_f64.powi(1000))
            // The same everywhere.
            .no_brighter_than(1.0)
            .sees(0.1),
        Truth::new("mirror-room-cut-at-5", &room(0.9, 256).depth(5), 1.0 - 0.9_f64.powi(5), "1 − ρ⁵, ρ = 0.9")
            .because("n edges hold n terms of Le Σρᵏ with Le = 1 − ρ, without noise.")
            .confirmed("the series, term by term", 1e-14, || series(0.1, 0.9, 5))
            .or_else("one edge more", 1.0 - 0.9_f64.powi(6))
            .or_else("one edge less", 1.0 - 0.9_f64.powi(4)),
    ]
}
