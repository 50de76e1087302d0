//! Air: what it scatters is polarised, and scattered again.

use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

use serde_json::json;

use super::{
    Claim, Quantity, Truth,
    expectation::Expectation,
    media::{boundary, medium},
    scene::{Scene, block, lambert, level_square},
};
use crate::transfer::{Air, AirByOrders, Leaving};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = by_a_polariser();
    list.extend(slabs());
    list
}

/// Light that air has scattered by a right angle swings across the plane of both ways.
fn by_a_polariser() -> Vec<Truth> {
    let (depth, per_m) = (0.5_f64, 0.4_f64);
    let air = medium(per_m, 0.0, &json!({ "type": "rayleigh" }));
    // Light along x, seen along z: it swings along y. It comes to a slab of endless height through nothing: by a shield of 1 m from the face.
    let seen = 3.0 / (16.0 * PI) * PI * (1.0 - (-per_m * depth).exp()) * (-per_m * 0.5_f64).exp();
    let scene = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 1e-3)
            .thing(json!({
                "shape": block([-0.5, -10.0, -depth], [0.5, 10.0, 0.0]), "material": boundary(&air),
            }))
            .thing(json!({
                "shape": level_square([0.0, 0.0, 1.0], 1.0, true),
                "material": { "type": "polariser", "axis": [cos, sin, 0.0] },
            }))
            .directional_light([1.0, 0.0, 0.0], PI)
            .depth(3)
            .spp(64)
    };
    let truth = |name: &str, degrees: f64| {
        let across = degrees.to_radians().sin().powi(2);
        let truth = Truth::new(name, &scene(degrees), across * seen, "sin²φ · 3σ/(16π) E ∫ e^(−σs) ds e^(−σa)")
            .because("Scattered by a right angle, light swings across the plane of scattering alone; a polariser at φ to that plane passes sin²φ.")
            .claims(Claim::CarriesPolarisation)
            .sees(5e-3);
        let by_dipoles = move || {
            let (n, turns) = (20_000, 64);
            // The field swings across x at an angle to y, and what a dipole sends along z is the part along y.
            let swings = |k: i32| (PI * (f64::from(k) + 0.5) / f64::from(turns)).cos() * degrees.to_radians().sin();
            let sent = (0..turns).map(|k| 3.0 / (8.0 * PI) * swings(k).powi(2)).sum::<f64>() / f64::from(turns);
            let depths = (0..n).map(|i| per_m * depth * (f64::from(i) + 0.5) / f64::from(n));
            let passes = depths.map(|tau| (-tau).exp()).sum::<f64>() * per_m * depth / f64::from(n);
            PI * sent * passes * (-per_m * 0.5).exp()
        };
        let confirmed = |truth: Truth| {
            truth.confirmed("dipoles in light of every direction of swing, depth by depth", 1e-8, by_dipoles)
        };
        match degrees {
            0.0 => truth.or_else("light not polarised", 0.5 * seen).or_else("polarised within the plane", seen),
            45.0 => confirmed(truth).or_else("nothing passes", 0.0),
            _ => confirmed(truth).or_else("light not polarised", 0.5 * seen).or_else("polarised within the plane", 0.0),
        }
    };
    vec![
        truth("air-at-a-right-angle-by-a-polariser-across", 90.0),
        truth("air-at-a-right-angle-by-a-polariser-along", 0.0),
        truth("air-at-a-right-angle-by-a-slanting-polariser", 45.0),
    ]
}

/// A slab, and one that forgets polarisation.
type Slabs = LazyLock<[Air; 2], Box<dyn FnOnce() -> [Air; 2] + Send>>;

/// A slab of air above a ground: its depth, cosines of sun and eye, azimuth between the ways of both, degrees, albedo of the ground.
#[derive(Clone, Copy)]
struct Case {
    name: &'static str,
    depth: f64,
    sun: f64,
    leaving: Leaving,
    eye: f64,
    azimuth_deg: f64,
    ground: f64,
    /// The relative bias that a reading of S₀, S₁ and S₂ must be able to see. What is polarised has less of light and as much noise.
    must_see: [f64; 3],
}

impl Case {
    /// The eye looks along x and z. Its picture's right is y, and its upper side lies in the vertical plane.
    fn scene(&self) -> Scene {
        let &Self { depth, sun, leaving, eye, azimuth_deg, ground, .. } = self;
        let air = medium(1.0, 0.0, &json!({ "type": "rayleigh" }));
        let (sine, side) = ((1.0 - eye * eye).sqrt(), (1.0 - sun * sun).sqrt());
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let (position, up) = match leaving {
            Leaving::Upward => ([sine, 0.0, eye], [-eye, 0.0, sine]),
            Leaving::Downward => ([sine, 0.0, -depth - eye], [eye, 0.0, sine]),
        };
        let look_at = [0.0, 0.0, if leaving == Leaving::Upward { 0.0 } else { -depth }];
        let scene = Scene::orthographic(position, look_at, 1e-3)
            .up(up)
            .thing(json!({ "shape": block([-1e4, -1e4, -depth], [1e4, 1e4, 0.0]), "material": boundary(&air) }))
            .directional_light([side * cos, -side * sin, -sun], PI)
            .film(8, 8)
            .spp(32)
            .set("film", "stokes", json!(true));
        if ground > 0.0 {
            scene.object(level_square([0.0, 0.0, -depth - 2.0], 1e4, true), lambert(ground))
        } else {
            scene
        }
    }

    /// S₀, S₁ and S₂ of the picture, of I, Q and U in the vertical plane: what swings along its rows swings across that plane.
    fn in_the_picture(&self, [i, q, u]: [f64; 3]) -> [f64; 3] {
        [i, -q, if self.leaving == Leaving::Upward { -u } else { u }]
    }

    /// With the slab, and the same of a renderer that drops polarisation, made when a value is asked for.
    fn truths(&self, slabs: &Arc<Slabs>) -> Vec<Truth> {
        let &Self { name, depth, sun, leaving, eye, azimuth_deg, ground, .. } = self;
        let azimuth = azimuth_deg.to_radians();
        let scene = self.scene();
        let own = *self;
        let by_orders = Arc::new(LazyLock::new(move || {
            own.in_the_picture(AirByOrders::new(depth, sun, ground).seen(leaving, eye, azimuth))
        }));
        let mut list = Vec::new();
        for (k, parameter) in [Quantity::Radiance, Quantity::Stokes1, Quantity::Stokes2].into_iter().enumerate() {
            let by_orders = Arc::clone(&by_orders);
            let (case, slabs) = (own, Arc::clone(slabs));
            let work_out = move || {
                let [values, forgetful] =
                    slabs.each_ref().map(|slab| case.in_the_picture(slab.seen(sun, leaving, eye, azimuth, ground)));
                let expectation = Expectation::new(values[k])
                    .allows(1e-6 * values[0], "the slab is 2·10⁴ m wide, not endless; single precision");
                match k {
                    0 => expectation.or_else("polarisation forgotten before light is scattered again", forgetful[0]),
                    _ => expectation.or_else("the other sign", -values[k]).or_else("light not polarised", 0.0),
                }
            };
            let truth = Truth::later(
                if k == 0 { name.to_owned() } else { format!("{name}-s{k}") },
                &scene,
                format!("doubling for I, Q and U: τ = {depth}, μ₀ = {sun}, μ = {eye}, φ = {azimuth_deg}°, A = {ground}"),
                work_out,
            )
            .because(
                "Air scatters as dipoles do and absorbs nothing. Light that was scattered once is polarised, which changes how much of it goes where \
                 when it is scattered again. The irradiance across the sun's beam is π.",
            )
            // The grid has 256 layers. Its error grows with the square of their depth.
            .confirmed(
                "the tensor of the field on a grid of depths, scattering by scattering",
                2e-5 * (depth * depth).max(1.0),
                move || by_orders[k],
            )
            .reads(parameter)
            .claims(Claim::CarriesPolarisation)
            .sees(self.must_see[k]);
            list.push(truth);
        }
        list
    }
}

/// The situations of Coulson, Dave & Sekera (1960), whose tables Natraj, Li & Yung (2009) corrected, and of Natraj & Hovenier (2011).
fn slabs() -> Vec<Truth> {
    use Leaving::{Downward, Upward};
    let case = |name, depth, sun, leaving, eye, azimuth_deg, ground| Case {
        name,
        depth,
        sun,
        leaving,
        eye,
        azimuth_deg,
        ground,
        must_see: [0.03, 0.06, 0.06],
    };
    let coarser = |case: Case| Case { must_see: [0.05, 0.2, 0.1], ..case };
    let cases = [
        case("air-of-depth-0.5-from-above", 0.5, 0.2, Upward, 0.8, 60.0, 0.0),
        case("air-of-depth-0.5-from-below", 0.5, 0.8, Downward, 0.4, 120.0, 0.25),
        case("air-of-depth-1-above-a-bright-ground", 1.0, 0.2, Upward, 0.8, 60.0, 0.8),
        case("air-of-depth-4-from-above", 4.0, 0.8, Upward, 0.4, 60.0, 0.0),
        case("air-of-depth-1-from-below", 1.0, 0.4, Downward, 0.8, 90.0, 0.0),
        case("air-of-depth-1-above-a-grey-ground", 1.0, 0.8, Upward, 0.8, 30.0, 0.25),
        coarser(case("air-of-depth-0.5-above-a-bright-ground", 0.5, 0.4, Downward, 0.8, 120.0, 0.8)),
        coarser(case("air-of-depth-4-above-a-grey-ground", 4.0, 0.4, Upward, 0.8, 60.0, 0.25)),
        coarser(case("air-of-depth-4-above-a-bright-ground", 4.0, 0.8, Upward, 0.4, 60.0, 0.8)),
    ];
    const COSINES: [f64; 3] = [0.2, 0.4, 0.8];
    let of_depth = |depth: f64| {
        let slabs: Arc<Slabs> =
            Arc::new(LazyLock::new(Box::new(move || [Air::new(depth, &COSINES), Air::unpolarised(depth, &COSINES)])));
        cases
            .iter()
            .filter(move |case| case.depth == depth)
            .flat_map(move |case| case.truths(&slabs))
            .collect::<Vec<_>>()
    };
    [0.5, 1.0, 4.0].into_iter().flat_map(of_depth).collect()
}
