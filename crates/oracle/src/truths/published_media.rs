//! Half-spaces and slabs whose fluxes are in print: along the normal, at 60° and in diffuse light, by eyes, by light meters and in bands.

use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

use serde_json::{Value, json};

use super::{
    Quantity, Truth,
    expectation::Expectation,
    media::{WIDE, boundary, forward, isotropic, medium, of_half_space, slab},
    meters::measured,
    scene::{Scene, black, block, lambert, level_square},
};
use crate::quadrature::{gauss_legendre_half, interval};
use crate::transfer::{
    Fluxes, HalfSpace, IsotropicSlab, Slab, by_scattering_orders, henyey_greenstein, legendre_moments, scattered_once,
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = half_spaces();
    list.extend(half_spaces_in_bands());
    list.push(clear_in_blue());
    list.extend(half_spaces_in_diffuse_light());
    list.extend([lit_along_the_normal(), lossless_lit_along_the_normal()]);
    list.extend(slabs_in_diffuse_light());
    list.extend(slabs_in_a_beam());
    list
}

/// Plane albedos for the cosines 1 and ½.
fn half_spaces() -> Vec<Truth> {
    [
        (0.5, 0.5, "half-space-of-albedo-0.5-at-60-degrees"),
        (0.8, 1.0, "half-space-of-albedo-0.8"),
        (0.9, 0.5, "half-space-of-albedo-0.9-at-60-degrees"),
        (0.99, 1.0, "half-space-of-albedo-0.99"),
        (0.999, 1.0, "half-space-of-albedo-0.999"),
        (0.999, 0.5, "half-space-of-albedo-0.999-at-60-degrees"),
    ]
    .map(|(albedo, mu, name)| {
        // Paths are long where little is absorbed, and then the picture has little noise.
        let spp = match albedo {
            0.999.. => 16,
            0.99.. => 32,
            _ => 256,
        };
        let scene = slab(400.0, &medium(albedo, 1.0 - albedo, &isotropic()), mu).sky(1.0).spp(spp);
        of_half_space(name, &scene, albedo, mu, HalfSpace::new(albedo).plane_albedo(mu))
    })
    .into()
}

/// Matter that is from 2 to 9 times as thick from violet to red, which a half-space shows in no band.
fn half_spaces_in_bands() -> Vec<Truth> {
    const ALBEDO: f64 = 0.9;
    let table =
        |times: f64| json!({ "type": "tabulated", "wavelengths_nm": [360, 830], "values": [2.0 * times, 9.0 * times] });
    let coloured = json!({ "scattering_per_m": table(ALBEDO), "absorption_per_m": table(1.0 - ALBEDO) });
    let scene =
        slab(100.0, &coloured, 0.5).sky(1.0).film(16, 16).spp(256).set("film", "bands_nm", json!([450, 750, 100]));
    [0_u32, 1, 2, 3]
        .map(|number| {
            let name = format!("half-space-of-coloured-extinction-about-{}-nanometres", 450 + 100 * number);
            of_half_space(&name, &scene, ALBEDO, 0.5, HalfSpace::new(ALBEDO).plane_albedo(0.5))
                .reads(Quantity::Band(number))
        })
        .into()
}

/// Matter that is clear from violet to green, above a black ground: those wavelengths are never scattered, and the others lose nothing by it.
fn clear_in_blue() -> Truth {
    const ALBEDO: f64 = 0.9;
    const DEPTH: f64 = 30.0;
    let table = |per_m: f64| json!({ "type": "tabulated", "wavelengths_nm": [360, 550, 600, 830], "values": [0, 0, per_m, per_m] });
    let red = json!({ "scattering_per_m": table(ALBEDO), "absorption_per_m": table(1.0 - ALBEDO) });
    let scene = dark_below(slab(DEPTH, &red, 1.0).sky(1.0), DEPTH).film(16, 16).spp(256).set(
        "film",
        "bands_nm",
        json!([650, 750, 100]),
    );
    let value = HalfSpace::new(ALBEDO).plane_albedo(1.0);
    of_half_space("half-space-that-is-clear-in-blue", &scene, ALBEDO, 1.0, value)
        .or_else("a path is scattered by its first wavelength alone, and half of these are clear", 0.5 * value)
        .reads(Quantity::Band(1))
}

/// A scene with a slab below z = 0, and a meter that looks at it.
fn metered(depth_m: f64, filled: &Value, height_m: f64, up: f64) -> Scene {
    measured(&[json!({ "type": "irradiance", "position_m": [0, 0, height_m], "normal": [0, 0, up] })])
        .thing(json!({ "shape": block([-1e4, -1e4, -depth_m], [1e4, 1e4, 0.0]), "material": boundary(filled) }))
        .sky(1.0)
        .spp(1 << 16)
}

fn half_spaces_in_diffuse_light() -> Vec<Truth> {
    [0.5, 0.8, 0.9, 0.99, 0.999]
        .map(|albedo| {
            let half_space = HalfSpace::new(albedo);
            let diffuse = half_space.diffuse_albedo();
            let scene = metered(400.0, &medium(albedo, 1.0 - albedo, &isotropic()), 0.5, -1.0);
            let once = |mu: f64| 0.5 * albedo * (1.0 - mu * (1.0 + 1.0 / mu).ln());
            Truth::new(
                format!("meter-above-a-half-space-of-albedo-{albedo}"),
                &scene,
                PI * diffuse,
                format!("π − 2π√(1 − ϖ) ∫H(μ)μ dμ, ϖ = {albedo}"),
            )
            .because(
                "Under a sky of 1 a half-space shows along each direction the share of a beam along it that comes back. A meter above it, which looks \
                 down, reads the integral of that with the cosine.",
            )
            .confirmed("Chandrasekhar's equation for H, by iteration", 1e-5, move || {
                let seen = |mu: f64| 1.0 - half_space.h_by_iteration(mu) * (1.0 - albedo).sqrt();
                2.0 * PI * gauss_legendre_half(12).into_iter().map(|(mu, w)| w * mu * seen(mu)).sum::<f64>()
            })
            .or_else("radiance instead of irradiance", diffuse)
            .or_else("light scattered once alone", 2.0 * PI * interval(|mu| mu * once(mu), 0.0, 1.0, 1e-10).value)
            .or_else("the albedo applied twice", PI * HalfSpace::new(albedo * albedo).diffuse_albedo())
            .or_else("as along the normal", PI * half_space.plane_albedo(1.0))
            .sees(0.02)
            .allows(1e-6, WIDE)
            .no_brighter_than(1.0)
        })
        .into()
}

/// Seen along the normal and lit along it.
fn lit_along_the_normal() -> Truth {
    const ALBEDO: f64 = 0.9;
    let half_space = HalfSpace::new(ALBEDO);
    let scene =
        slab(200.0, &medium(ALBEDO, 1.0 - ALBEDO, &isotropic()), 1.0).directional_light([0.0, 0.0, -1.0], PI).spp(256);
    Truth::new("half-space-lit-along-its-normal", &scene, half_space.radiance_factor(1.0, 1.0), "⅛ϖH(1)², ϖ = 0.9")
        .because("Chandrasekhar's law of diffuse reflection, for an irradiance of π on the surface.")
        .confirmed("Chandrasekhar's equation for H, by iteration", 2e-6, move || {
            0.125 * ALBEDO * half_space.h_by_iteration(1.0).powi(2)
        })
        .or_else("light scattered once alone", scattered_once(200.0, ALBEDO, 1.0, 1.0, 1.0))
        .or_else("the albedo applied twice", HalfSpace::new(ALBEDO * ALBEDO).radiance_factor(1.0, 1.0))
        .sees(0.03)
        .allows(1e-6, WIDE)
}

/// The same without loss. Deep in it light goes alike to all sides, as above a ground that reflects all light diffusely. So such a ground stands
/// for all that is below a depth of 8.
fn lossless_lit_along_the_normal() -> Truth {
    const DEPTH: f64 = 8.0;
    let value = HalfSpace::new(1.0).radiance_factor(1.0, 1.0);
    let scene = slab(DEPTH, &medium(1.0, 0.0, &isotropic()), 1.0)
        .object(level_square([0.0, 0.0, -DEPTH - 1.0], 1e4, true), lambert(1.0))
        .directional_light([0.0, 0.0, -1.0], PI)
        .spp(8);
    Truth::new("half-space-without-loss-lit-along-its-normal", &scene, value, "⅛H(1)², ϖ = 1")
        .because("Chandrasekhar's law of diffuse reflection, for an irradiance of π on the surface. A white ground at the depth 8 sends light back as what is below it would.")
        .confirmed("the equation for the source function of the slab, above a white ground", 3e-5, || {
            IsotropicSlab::new(DEPTH, 1.0).radiance_factor_above_white(1.0, 1.0)
        })
        .or_else("light scattered once alone", 0.125)
        .or_else("nothing from below the depth 8", IsotropicSlab::new(DEPTH, 1.0).radiance_factor(1.0, 1.0))
        .sees(0.05)
        .allows(3e-5, "what light keeps of its direction down to a depth of 8; the slab is 2·10⁴ m wide; single precision")
}

/// A black square below a slab, so that light comes from above alone.
fn dark_below(scene: Scene, depth_m: f64) -> Scene {
    scene.object(level_square([0.0, 0.0, -depth_m - 1.0], 1e4, true), black())
}

const EDGES: &str = "light from between the black square and the slab, 2·10⁴ m wide; single precision";

/// The relative bias that a reading must be able to see: less light comes through a deeper slab, by longer paths.
fn seen_of(depth: f64) -> f64 {
    match depth {
        10.0.. => 0.08,
        5.0.. => 0.05,
        _ => 0.02,
    }
}

/// Diffuse light: what comes through, and where some is absorbed what comes back, too.
fn slabs_in_diffuse_light() -> Vec<Truth> {
    let mut list: Vec<Truth> =
        [0.1, 0.5, 1.0, 2.0, 5.0, 10.0].map(|depth| in_diffuse_light(depth, 1.0, Side::Far)).into();
    for depth in [1.0, 5.0] {
        list.extend([Side::Far, Side::Near].map(|side| in_diffuse_light(depth, 0.9, side)));
    }
    list
}

/// The side of a slab that light leaves by: that away from the light, or that of the light.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Far,
    Near,
}

impl Side {
    fn of(self, fluxes: &Fluxes) -> f64 {
        if self == Self::Far { fluxes.transmitted } else { fluxes.reflected }
    }
}

fn in_diffuse_light(depth: f64, albedo: f64, side: Side) -> Truth {
    let filled = medium(albedo, 1.0 - albedo, &isotropic());
    let (height, up) = if side == Side::Far { (-depth - 0.5, 1.0) } else { (0.5, -1.0) };
    let scene = dark_below(metered(depth, &filled, height, up), depth);
    let work_out = move || {
        let slab = Slab::new(depth, albedo, &[1.0], 1.0);
        let fluxes = slab.of_diffuse_light();
        let (leaves, other) = (side.of(&fluxes), fluxes.reflected + fluxes.transmitted - side.of(&fluxes));
        let direct = interval(|mu| 2.0 * mu * (-depth / mu).exp(), 0.0, 1.0, 1e-12).value;
        let without_scattering = if side == Side::Far { direct } else { 0.0 };
        Expectation::new(PI * leaves)
            .or_else("light that was not scattered alone", PI * without_scattering)
            .or_else("what leaves by the other side", PI * other)
            .or_else("as along the normal", PI * side.of(&slab.of_beam()))
            .or_else("radiance instead of irradiance", leaves)
            .allows(1e-4, EDGES)
    };
    let name = match (albedo < 1.0, side) {
        (false, _) => format!("meter-below-a-slab-of-depth-{depth}"),
        (true, Side::Far) => format!("meter-below-a-slab-of-depth-{depth}-that-absorbs"),
        (true, Side::Near) => format!("meter-above-a-slab-of-depth-{depth}-that-absorbs"),
    };
    let what = if side == Side::Far { "comes through" } else { "comes back" };
    Truth::later(name, &scene, format!("π times what {what}, by doubling: τ = {depth}, ϖ = {albedo}"), work_out)
        .because(match side {
            Side::Far => "A sky of 1 sends diffuse light of the irradiance π into the slab. A meter below it reads what comes through.",
            Side::Near => "A sky of 1 sends diffuse light of the irradiance π into the slab. A meter above it reads what comes back.",
        })
        .confirmed("the equation for the source function", 1e-4, move || {
            PI * side.of(&IsotropicSlab::new(depth, albedo).of_diffuse_light())
        })
        .sees(seen_of(depth))
        .no_brighter_than(1.0)
}

/// A beam along the normal: the share that comes back, and the share that comes through.
fn slabs_in_a_beam() -> Vec<Truth> {
    let mut list = Vec::new();
    for (depth, albedo, g, name) in [
        (2.0, 1.0, 0.0, "slab-of-depth-2-without-loss"),
        (5.0, 1.0, 0.0, "slab-of-depth-5-without-loss"),
        (10.0, 1.0, 0.0, "slab-of-depth-10-without-loss"),
        (8.0, 0.99, 0.5, "slab-of-depth-8-that-scatters-half-forward"),
        (8.0, 0.99, 0.85, "slab-of-depth-8-that-scatters-forward-and-absorbs"),
    ] {
        let filled = medium(albedo, 1.0 - albedo, &if g == 0.0 { isotropic() } else { forward(g) });
        let reflects = dark_below(slab(depth, &filled, 1.0).sky(1.0), depth);
        let transmits = slab(depth, &filled, 1.0).object(level_square([0.0, 0.0, 2.0], 1e4, false), black()).sky(1.0);
        let fluxes = shared(move || doubled(depth, albedo, g));
        let reversed = shared(move || doubled(depth, albedo, -g));
        let again = shared(move || {
            if g == 0.0 {
                IsotropicSlab::new(depth, albedo).of_beam(1.0)
            } else {
                by_scattering_orders(depth, albedo, |x| henyey_greenstein(g, x))[0]
            }
        });
        // At depth 8 the grid of 400 layers is off by up to 2.6e-4 of a flux. With twice as many layers it is off by 7e-5.
        let (how, tolerance) = match g {
            0.0 => ("the equation for the source function", 1e-4),
            _ => ("the transfer equation, order by order", 3e-4),
        };
        let truth = |what: &str, scene: &Scene, of: fn(&Fluxes) -> f64| {
            let (fluxes, reversed, again) = (Arc::clone(&fluxes), Arc::clone(&reversed), Arc::clone(&again));
            let work_out = move || {
                let expectation = Expectation::new(of(&fluxes))
                    .or_else("what goes to the other side", fluxes.reflected + fluxes.transmitted - of(&fluxes))
                    .allows(1e-4, EDGES);
                if g == 0.0 { expectation } else { expectation.or_else("the phase function reversed", of(&reversed)) }
            };
            Truth::later(
                format!("{name}-{what}"),
                &scene.clone().spp(if depth < 5.0 { 256 } else { 16 }),
                format!("doubling: τ = {depth}, ϖ = {albedo}, g = {g}"),
                work_out,
            )
            .because("By reciprocity an eye sees of light of 1 on one side the share of a beam along its sight that goes to that side.")
            .confirmed(how, tolerance, move || of(&again))
            .sees(seen_of(depth))
            .no_brighter_than(1.0)
        };
        if albedo < 1.0 {
            list.push(truth("reflected", &reflects, |fluxes| fluxes.reflected));
        }
        list.push(truth("transmitted", &transmits, |fluxes| fluxes.transmitted));
    }
    list
}

fn doubled(depth: f64, albedo: f64, g: f64) -> Fluxes {
    Slab::new(depth, albedo, &legendre_moments(|x| henyey_greenstein(g, x), 96), 1.0).of_beam()
}

type Shared = Arc<LazyLock<Fluxes, Box<dyn FnOnce() -> Fluxes + Send>>>;

/// Fluxes that are worked out when they are first asked for.
fn shared(work_out: impl FnOnce() -> Fluxes + Send + 'static) -> Shared {
    Arc::new(LazyLock::new(Box::new(work_out)))
}
