//! Plates, stacks, a prism and a ball of glass.

use std::f64::consts::PI;

use super::{
    Claim, Truth,
    irradiance::stack_transmittance,
    scene::{Scene, black, block, disk, glass, glass_in, level_square, parallelogram, sphere, triangular_prism},
};
use crate::laws::fresnel_exact;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = plates();
    list.extend(stacks());
    list.extend(total_reflection());
    list.push(ball_lens());
    list
}

/// Transmittance by following the flux from interface to interface until all of it has left: the second way for stacks.
fn by_following_flux(reflectances: &[f64]) -> f64 {
    let gaps = reflectances.len() + 1;
    // Flux going forward in each gap; gap 0 lies before the first interface.
    let (mut forward, mut backward) = (vec![0.0; gaps], vec![0.0; gaps]);
    forward[0] = 1.0;
    let mut transmitted = 0.0;
    for _ in 0..200_000 {
        let (mut next_forward, mut next_backward) = (vec![0.0; gaps], vec![0.0; gaps]);
        for (i, r) in reflectances.iter().enumerate() {
            next_forward[i + 1] += (1.0 - r) * forward[i] + r * backward[i + 1];
            next_backward[i] += r * forward[i] + (1.0 - r) * backward[i + 1];
        }
        transmitted += next_forward[gaps - 1];
        next_forward[gaps - 1] = 0.0;
        next_backward[0] = 0.0;
        (forward, backward) = (next_forward, next_backward);
        if forward.iter().chain(&backward).sum::<f64>() < 1e-17 {
            break;
        }
    }
    transmitted
}

/// The mean of the two polarisations' transmittances of a plate.
fn polarised_plate(cosine: f64, n: f64) -> f64 {
    let powers = fresnel_exact(cosine, n);
    0.5 * (stack_transmittance(&[powers.r_s; 2]) + stack_transmittance(&[powers.r_p; 2]))
}

/// A glass plate of index 1.5 seen through at an angle from its normal; behind it, and only there, everything shines.
fn through_plate(tilt_deg: f64, thickness: f64) -> Scene {
    let (sine, cosine) = tilt_deg.to_radians().sin_cos();
    Scene::orthographic([sine, 0.0, cosine], [0.0; 3], 1e-3 * cosine.max(1e-3))
        .object(block([-20.0, -20.0, -thickness], [20.0, 20.0, 0.0]), glass(1.5))
        .lamp(level_square([0.0, 0.0, -0.02], 1e3, true), black(), 1.0, "front")
        .spp(1024)
}

fn plates() -> Vec<Truth> {
    let because = "T = 1 − R at each face; the beams that are reflected to and fro inside leave in the same direction, TΣR²ᵏT: \
         (1 − R)/(1 + R) in all, whatever the thickness.";
    let mut list = Vec::new();
    for (tilt_deg, thickness, spp, sees) in [
        (0.0_f64, 0.01, 1024, 0.01),
        (45.0, 0.01, 1280, 0.01),
        (45.0, 1e-6, 1024, 0.01),
        (75.0, 0.01, 1024, 0.02),
        (89.0, 0.01, 1024, 0.06),
        (89.9, 0.01, 512, 0.2),
        // One path in 2000 comes through. 66 do in the first step of a run: of fewer, their number would not tell its own error.
        (89.99, 0.01, 4096, 0.9),
    ] {
        let cosine = tilt_deg.to_radians().cos();
        let r = fresnel_exact(cosine, 1.5).reflectance();
        let scene = through_plate(tilt_deg, thickness).spp(spp);
        let thin = if thickness < 1e-3 { "-thin" } else { "" };
        let mut truth = Truth::new(
            format!("plate-at-{tilt_deg}-degrees{thin}"),
            &scene,
            stack_transmittance(&[r, r]),
            "(1 − R)/(1 + R), R the mean of R_s and R_p",
        )
        .because(because)
        .confirmed("following the flux", 1e-9, move || by_following_flux(&[r, r]))
        .or_else("the far face skipped, or the exit a total reflection", 0.0)
        .sees(sees);
        if tilt_deg > 0.0 {
            truth = truth.claims(Claim::AveragesPolarisation);
            if tilt_deg <= 75.0 && thickness > 1e-3 {
                truth = truth.or_else(
                    "polarisation carried from face to face, which is not claimed",
                    polarised_plate(cosine, 1.5),
                );
            }
        }
        if tilt_deg == 75.0 {
            truth = truth.or_else("first pass only", (1.0 - r).powi(2));
        }
        list.push(truth);
    }
    for tilt_deg in [45.0_f64, 75.0, 89.0] {
        let cosine = tilt_deg.to_radians().cos();
        let powers = fresnel_exact(cosine, 1.5);
        list.push(
            Truth::new(
                format!("plate-at-{tilt_deg}-degrees-polarised"),
                &through_plate(tilt_deg, 0.01).spp(if tilt_deg < 89.0 { 1280 } else { 1024 }),
                polarised_plate(cosine, 1.5),
                "mean of (1 − R)/(1 + R) of s and of p",
            )
            .because("Each polarisation passes the plate by itself; unpolarised light is half of each.")
            .confirmed("following the flux of each polarisation", 1e-9, move || {
                0.5 * (by_following_flux(&[powers.r_s; 2]) + by_following_flux(&[powers.r_p; 2]))
            })
            .or_else(
                if tilt_deg < 89.0 { "polarisations averaged at each face" } else { "the exit a total reflection" },
                if tilt_deg < 89.0 { stack_transmittance(&[powers.reflectance(); 2]) } else { 0.0 },
            )
            .sees(if tilt_deg < 89.0 { 0.02 } else { 0.06 })
            .claims(Claim::CarriesPolarisation),
        );
    }
    let (sine, cosine) = 60.0_f64.to_radians().sin_cos();
    let r = fresnel_exact(cosine, 1.5).reflectance();
    let reflected = Scene::orthographic([sine, 0.0, cosine], [0.0; 3], 1e-3)
        .object(block([-20.0, -20.0, -0.01], [20.0, 20.0, 0.0]), glass(1.5))
        .lamp(disk([-sine, 0.0, cosine], [sine, 0.0, -cosine], 0.5), black(), 1.0, "front");
    list.push(
        Truth::new(
            "plate-reflects-at-60-degrees",
            &reflected,
            2.0 * r / (1.0 + r),
            "2R/(1 + R), R the mean of R_s and R_p",
        )
        .because("What a lossless plate does not transmit it reflects: 1 − (1 − R)/(1 + R).")
        .confirmed("following the flux", 1e-9, move || 1.0 - by_following_flux(&[r, r]))
        .or_else("the front face only", r)
        .sees(0.03)
        .claims(Claim::AveragesPolarisation),
    );
    list
}

fn stacks() -> Vec<Truth> {
    let because = "For lossless layers whose beams add as powers, R/T adds up: T = 1/(1 + ΣRᵢ/(1 − Rᵢ)) (Stokes 1862).";
    let pile = |count: u32| {
        (0..count).fold(
            Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 1e-3).lamp(
                level_square([0.0, 0.0, -1.0], 10.0, true),
                black(),
                1.0,
                "front",
            ),
            |scene, i| {
                let top = -0.02 * f64::from(i);
                scene.object(block([-1.0, -1.0, top - 0.01], [1.0, 1.0, top]), glass(1.5))
            },
        )
    };
    let mut list: Vec<Truth> = [2_u32, 5]
        .map(|count| {
            let faces = vec![0.04; 2 * count as usize];
            Truth::new(
                format!("{count}-plates-at-normal-incidence"),
                &pile(count),
                stack_transmittance(&faces),
                format!("1/(1 + 2NR/(1 − R)), N = {count}, R = 0.04"),
            )
            .because(because)
            .or_else("first pass only", 0.96_f64.powi(2 * count as i32))
            .confirmed("following the flux", 1e-9, move || by_following_flux(&faces))
        })
        .into();
    // Glass, water, glass at 30° in four interfaces.
    let (sine, cosine) = 30.0_f64.to_radians().sin_cos();
    let inside = |n: f64| (1.0 - (sine / n).powi(2)).sqrt();
    let (outer, inner) =
        (fresnel_exact(cosine, 1.5).reflectance(), fresnel_exact(inside(1.5), 1.33 / 1.5).reflectance());
    let faces = [outer, inner, inner, outer];
    let indices = [(1.5, 1.0), (1.33, 1.5), (1.5, 1.33), (1.0, 1.5)];
    let sandwich = indices.into_iter().enumerate().fold(
        Scene::orthographic([sine, 0.0, cosine], [0.0; 3], 1e-3)
            .lamp(level_square([0.0, 0.0, -1.0], 10.0, true), black(), 1.0, "front")
            .spp(1024),
        |scene, (i, (below, above))| {
            scene.object(level_square([0.0, 0.0, -0.01 * i as f64], 10.0, true), glass_in(below, above))
        },
    );
    list.push(
        Truth::new("glass-water-glass-at-30-degrees", &sandwich, stack_transmittance(&faces), "1/(1 + ΣRᵢ/(1 − Rᵢ))")
            .because(because)
            .or_else("glass and water do not touch: a film of air between", {
                stack_transmittance(&[
                    outer,
                    outer,
                    fresnel_exact(cosine, 1.33).reflectance(),
                    fresnel_exact(cosine, 1.33).reflectance(),
                    outer,
                    outer,
                ])
            })
            .sees(0.01)
            .confirmed("following the flux", 1e-9, move || by_following_flux(&faces))
            .claims(Claim::NestedMedia)
            .claims(Claim::AveragesPolarisation),
    );
    list
}

fn total_reflection() -> Vec<Truth> {
    // Right-angled prism, legs of 1 along +x and +y, hypotenuse at 45°; light in through one leg, out through the other.
    let prism = triangular_prism([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [-1.0, 1.0]);
    let scene = Scene::orthographic([0.3, -1.0, 0.0], [0.3, 0.0, 0.0], 1e-2).object(prism, glass(1.5)).lamp(
        parallelogram([-1.0, 0.0, -0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        black(),
        1.0,
        "front",
    );
    vec![
        Truth::new("right-angle-prism", &scene, 12.0 / 13.0, "(1 − R)/(1 + R), R = 0.04")
            .because(
                "Light enters one leg at right angles, is totally reflected at 45° > 41.8° by the hypotenuse and leaves by the other leg. \
                 Unfolded, the prism is a plate at normal incidence.",
            )
            .or_else("light leaks through the hypotenuse", 0.0)
            .sees(0.01),
    ]
}

fn ball_lens() -> Truth {
    // A beam .02 wide, focused nr/(2(n − 1)) = 1.5 from the centre onto a disk whose radius is 5 times the aberration.
    let scene = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 0.02)
        .object(sphere([0.0; 3], 1.0), glass(1.5))
        .lamp(disk([0.0, 0.0, -1.5], [0.0, 0.0, 1.0], 2e-5), black(), 1.0, "front")
        .spp(1024);
    Truth::new("ball-lens", &scene, 0.9216, "(1 − R)², R = 0.04: all of the beam in the focus nr/(2(n − 1)) = 1.5")
        .because(
            "A ball of index 1.5 focuses parallel light half a radius behind its surface. The beam is so narrow that the aberration, \
             3e-6, stays within the disk; beams reflected twice inside are out of focus and miss it.",
        )
        .confirmed("tracing the beam's rays in the meridional plane", 1e-6, || {
            // Share of a square beam whose rays land within the disk, times the transmittance of each.
            let landing = |y: f64| {
                let (incidence, refraction) = (y.asin(), (y / 1.5).asin());
                let turn = 2.0 * (incidence - refraction);
                // The exit point lies at the angle of incidence less the turn below the axis.
                let at = incidence - turn;
                let (x, height) = (at.cos(), at.sin());
                height - (1.5 - x) * turn.tan()
            };
            let beam = |a: f64, b: f64| {
                let y = a.hypot(b);
                let t = fresnel_exact((1.0 - y * y).sqrt(), 1.5).transmittance();
                if landing(y).abs() <= 2e-5 { t * t } else { 0.0 }
            };
            crate::quadrature::rectangle(beam, [0.0, 0.01], [0.0, 0.01], 1e-12, 20_000).value / 1e-4
        })
        .allows(1e-6, "2e-5 for single precision, 1e-6 for beams reflected inside that graze the disk")
        .or_else("not refracted", 0.9216 * PI * 1e-6)
        .or_else("refracted once only, or by another index", 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plates_and_stacks_have_their_published_values() {
        let plate = |degrees: f64| {
            let r = fresnel_exact(degrees.to_radians().cos(), 1.5).reflectance();
            stack_transmittance(&[r, r])
        };
        for (degrees, value, tolerance) in [
            (0.0, 0.923_076_923, 1e-9),
            (45.0, 0.904_326_791, 1e-9),
            (75.0, 0.596_092_048, 1e-9),
            (89.0, 0.050_318_142_8, 1e-9),
            (89.9, 0.005_069_633_08, 1e-10),
            (89.99, 5.073_096_17e-4, 1e-12),
        ] {
            assert!((plate(degrees) - value).abs() < tolerance, "{degrees}");
        }
        for (degrees, value) in [(45.0_f64, 0.907_344_330), (75.0, 0.618_148_516), (89.0, 0.050_678_959_4)] {
            assert!((polarised_plate(degrees.to_radians().cos(), 1.5) - value).abs() < 1e-9, "{degrees}");
        }
        let sandwich = stacks().pop().unwrap();
        assert!((sandwich.value() - 0.914_048).abs() < 1e-6, "{}", sandwich.value());
    }
}
