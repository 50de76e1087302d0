//! 5.5: what a plate of clear glass lets through, by the angle of incidence.

use serde_json::json;

use super::super::scene::{black, block};
use super::super::skylight::slab;
use super::{SuiteCase, case, measured};
use crate::truths::{Claim, Truth};

/// Index, thickness in m and absorption in 1/m.
const INDEX: f64 = 1.52;
const THICKNESS_M: f64 = 0.006;
const ABSORPTION_PER_M: f64 = 10.0;

/// Radiance behind a plate of 6 mm, before it 1: light that is not polarised, s and p carried apart.
pub(super) fn cases() -> Vec<SuiteCase> {
    let tau = ABSORPTION_PER_M * THICKNESS_M;
    [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0]
        .into_iter()
        .map(|angle: f64| {
            let (sin, cos) = angle.to_radians().sin_cos();
            let meter = json!({ "type": "radiance", "position_m": [-0.5 * sin, 0, -0.5 * cos], "direction": [sin, 0, cos], "full_angle_deg": 0 });
            let glass = json!({ "type": "dielectric", "interior": INDEX, "absorption_per_m": ABSORPTION_PER_M });
            let lamp = json!({
                "shape": { "type": "parallelogram", "origin_m": [-500, -500, 0.1], "u_m": [0, 1000, 0], "v_m": [1000, 0, 0] },
                "material": black(), "emission": { "radiance": 1, "sides": "front" },
            });
            let scene = measured(&[meter])
                .object(block([-200.0, -200.0, 0.0], [200.0, 200.0, THICKNESS_M]), glass)
                .thing(lamp)
                .spp(1 << 18);
            let value = slab(cos, INDEX, tau);
            let by_orders = move || {
                // Order by order: through, twice back and through, …
                let inner = (1.0 - (sin / INDEX).powi(2)).sqrt();
                let through = (-tau / inner).exp();
                let of = |r: f64| {
                    let back: f64 = r * r;
                    (0..60).map(|k| (1.0 - back).powi(2) * through * (back * through).powi(2 * k)).sum::<f64>()
                };
                0.5 * (of((cos - INDEX * inner) / (cos + INDEX * inner)) + of((INDEX * cos - inner) / (INDEX * cos + inner)))
            };
            let truth = Truth::new(format!("cie171-5.5-{angle}"), &scene, value, "½ Σ (1 − R)²τ/(1 − R²τ²) over s and p")
                .because("s and p are reflected by Fresnel's formulas, each goes back and forth in the plate, and is absorbed on each way.")
                .confirmed("the sum over the orders of reflection", 1e-9, by_orders)
                .claims(Claim::CarriesPolarisation)
                .claims(Claim::Absorption);
            case("5.5", format!("{angle}° from the normal"), "%", 100.0, truth)
        })
        .collect()
}
