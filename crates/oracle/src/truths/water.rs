//! Flat interfaces of water and varnish: where the diver and the sky see each other.

use std::f64::consts::PI;

use super::{
    Truth,
    irradiance::walsh_reflectance,
    scene::{Scene, black, glass, lambert, level_square, parallelogram},
};
use crate::laws::fresnel_exact;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = water();
    list.push(coated());
    list
}

fn water() -> Vec<Truth> {
    const N: f64 = 1.33;
    let surface = || level_square([0.0; 3], 1e3, true);
    // From above at 45°, a shining floor under water.
    let (sine, cosine) = 45.0_f64.to_radians().sin_cos();
    let t_in = fresnel_exact(cosine, N).transmittance();
    let floor = |lamp: serde_json::Value| {
        Scene::orthographic([sine, 0.0, cosine], [0.0; 3], 1e-3).object(surface(), glass(N)).lamp(
            lamp,
            black(),
            1.0,
            "front",
        )
    };
    // Where the refracted ray through the origin meets the floor at depth 1.
    let refracted = sine / N;
    let landing = -refracted / (1.0 - refracted * refracted).sqrt();
    let edge = parallelogram([landing, -10.0, -1.0], [10.0, 0.0, 0.0], [0.0, 20.0, 0.0]);
    let looking_up = |from_zenith_deg: f64| {
        let (s, c) = from_zenith_deg.to_radians().sin_cos();
        let scene = Scene::orthographic([-s, 0.0, -c], [0.0; 3], 1e-3)
            .object(surface(), glass(N))
            .object(level_square([0.0, 0.0, -3.0], 1e3, true), black());
        (scene, c)
    };
    let (window, c) = looking_up(40.0);
    let t_out = fresnel_exact(c, 1.0 / N).transmittance();
    let (beyond, _) = looking_up(60.0);
    // A dark sea under the sky seen at 60°: what is not reflected sinks.
    let (s60, c60) = 60.0_f64.to_radians().sin_cos();
    let glint = fresnel_exact(c60, N).reflectance();
    let sea = Scene::orthographic([s60, 0.0, c60], [0.0; 3], 1e-3)
        .object(surface(), glass(N))
        .object(level_square([0.0, 0.0, -1.0], 1e4, true), black())
        .sky(1.0);
    // Looking straight up: the share of the picture that the sky fills.
    let critical_tan = 1.0 / (N * N - 1.0).sqrt();
    let dome = Scene::pinhole([0.0, 0.0, -1.0], [0.0; 3], 2.0 * 1.5_f64.atan().to_degrees())
        .object(surface(), glass(N))
        .object(level_square([0.0, 0.0, -3.0], 1e3, true), black())
        .sky(1.0);
    let in_window = move |rho: f64| fresnel_exact(1.0 / rho.hypot(1.0), 1.0 / N).transmittance() * N * N;
    let window_total =
        2.0 * PI * crate::quadrature::interval(|r| r * in_window(r), 0.0, critical_tan, 1e-12).value / 9.0;
    vec![
        Truth::new("floor-under-water", &floor(level_square([0.0, 0.0, -1.0], 50.0, true)), t_in / (N * N), "T/n², 45°, n = 1.33")
            .because("Radiance drops by n² when light leaves water, on top of what the surface reflects. The floor is black beneath its light.")
            .or_else("radiance not scaled by n²", t_in)
            .or_else("scaled the wrong way", t_in * N * N),
        Truth::new("edge-under-water", &floor(edge), 0.5 * t_in / (N * N), "½T/n²: the edge where Snell's law puts it")
            .because("The picture's middle ray meets the floor at tanθₜ of depth; an edge there halves the picture.")
            .or_else("not refracted, or refracted the other way", 0.0)
            .sees(0.02),
        Truth::new("window-of-a-diver", &window.clone().sky(1.0), t_out * N * N, "T·n², 40° from the zenith under water")
            .because("Radiance grows by n² on the way into water. The bottom is black, so the reflected part adds nothing.")
            .or_else("radiance not scaled by n²", t_out),
        Truth::new("mirror-of-a-diver-dark", &beyond.clone().sky(1.0), 0.0, "0 beyond 48.75°")
            .because("Beyond the critical angle a diver sees the bottom, which is black, and no sky at all.")
            .or_else("total reflection not noticed", N * N),
        Truth::new(
            "mirror-of-a-diver-bright",
            &Scene::orthographic([-s60, 0.0, -c60], [0.0; 3], 1e-3).object(surface(), glass(N)).lamp(
                level_square([0.0, 0.0, -3.0], 1e3, true),
                black(),
                1.0,
                "front",
            ),
            1.0,
            "1 beyond 48.75°",
        )
        .because("Total reflection loses nothing.")
        .or_else("reflected as from the air", fresnel_exact(c60, N).reflectance()),
        Truth::new("snells-window", &dome, window_total, "2π∫T·n²·r dr/9 over tanθ = r < 1/√(n² − 1)")
            .because("A diver who looks straight up in a picture 3 wide at depth 1 sees the whole sky in a disk of radius 1/√(n² − 1), \
                 as bright as T·n², and the black bottom around it.")
            .or_else("radiance not scaled by n²", window_total / (N * N))
            .sees(0.01),
        Truth::new("dark-sea-at-60-degrees", &sea, glint, "R, 60°, n = 1.33")
            .because("Only the reflected sky comes back from water over a black bed.")
            .or_else("Schlick's approximation", {
                let r0 = ((N - 1.0) / (N + 1.0)).powi(2);
                r0 + (1.0 - r0) * (1.0 - c60).powi(5)
            })
            .or_else("R_s only", fresnel_exact(c60, N).r_s)
            .sees(0.05),
    ]
}

fn coated() -> Truth {
    let (n, rho) = (1.5, 0.6);
    let external = walsh_reflectance(n);
    let internal = 1.0 - (1.0 - external) / (n * n);
    let r0 = 0.04;
    let body = rho * (1.0 - external) / (1.0 - rho * internal);
    let value = r0 + (1.0 - r0) * body / (n * n);
    let scene = Scene::orthographic([0.0, 0.0, 1.0], [0.0; 3], 1e-3)
        .object(level_square([0.0; 3], 100.0, true), glass(n))
        .object(level_square([0.0, 0.0, -0.01], 100.0, true), lambert(rho))
        .sky(1.0)
        .spp(1024);
    Truth::new("varnished-lambert", &scene, value, "R₀ + T₀ρ(1 − rₑ)/((1 − ρrᵢ)n²), n = 1.5, ρ = 0.6")
        .because(
            "Saunderson (1942): of a uniform sky's flux 1 − rₑ enters the varnish, the base returns ρ of it, the surface throws rᵢ of \
             that back, and so on; rₑ is Walsh's diffuse reflectance, rᵢ = 1 − (1 − rₑ)/n². What leaves along the normal is \
             T₀/n² of the radiance inside; the sky's own reflection R₀ comes on top.",
        )
        .confirmed("rₑ and rᵢ by quadrature of Fresnel's equations, the bounces one by one", 1e-8, move || {
            let diffuse = |eta: f64| {
                let integrand = |mu: f64| 2.0 * mu * fresnel_exact(mu, eta).reflectance();
                if eta > 1.0 {
                    return crate::quadrature::interval(integrand, 0.0, 1.0, 1e-12).value;
                }
                // Split at the critical angle, beyond which everything is reflected.
                let critical = (1.0 - eta * eta).sqrt();
                critical * critical + crate::quadrature::interval(integrand, critical, 1.0, 1e-12).value
            };
            let (external, internal) = (diffuse(n), diffuse(1.0 / n));
            let bounces: f64 = (0..200).map(|k| rho * (rho * internal).powi(k)).sum();
            r0 + (1.0 - r0) * (1.0 - external) * bounces / (n * n)
        })
        .or_else("light between base and surface lost after the first return", r0 + 0.96 * rho * (1.0 - external) / (n * n))
        .or_else("radiance not scaled by n²", r0 + (1.0 - r0) * rho * (1.0 - external) / (1.0 - rho * internal))
        .or_else("the sky's reflection forgotten", value - r0)
}
