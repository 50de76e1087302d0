//! Principled surfaces (Burley 2012 and 2015), lobe by lobe: in the light of a distant lamp f itself is seen, under a sky its integrals.

use std::f64::consts::{FRAC_PI_2, PI};

use serde_json::{Value, json};

use super::{
    Truth,
    principled_lobes::{ALL, DIFFUSE, GLOSSY, Surface, direction, grazing, sky, sky_by_facets},
    scene::{Scene, black, disk, level_square, rgba_png},
};
use crate::{
    laws::fresnel_exact,
    quadrature::interval,
    vector::{Vec3, add, dot, normalize, scale},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![diffuse(), flat(), sheen(), specular(), grain(), metal(), coat(), mixture(), metal_by_image()];
    list.extend(under_a_sky());
    list.extend(below_a_disk());
    list.extend(roughness_by_image());
    list.extend(from_behind());
    list
}

const BECAUSE: &str =
    "Each lobe is stated in closed form (Burley 2012, 2015). A distant lamp of irradiance 1 shows f cos θ_i.";

/// A square at the origin that faces up, seen from a direction.
pub(super) fn plate(from: Vec3, material: &Value) -> Scene {
    Scene::orthographic(scale(2.0, from), [0.0; 3], 0.1)
        .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": material }))
        .film(16, 16)
        .spp(64)
}

/// Lit by a light of irradiance 1 from a direction.
fn lit(scene: Scene, from: Vec3) -> Scene {
    scene.directional_light(from.map(|v| -v), 1.0)
}

/// Seen and lit at angles off the normal, so far apart in azimuth.
fn in_the_sun(
    name: &'static str,
    surface: Surface,
    [o, i, apart]: [f64; 3],
    formula: &str,
    instead: &[(&'static str, Surface)],
) -> Truth {
    let (to_viewer, to_light) = (direction(o, 20.0), direction(i, 20.0 + apart));
    let formula = format!("{formula}; viewer {o}° and light {i}° off the normal, {apart}° apart");
    let truth = Truth::new(
        name,
        &lit(plate(to_viewer, &surface.json()), to_light),
        surface.f_cos(to_viewer, to_light),
        formula,
    )
    .because(BECAUSE)
    .confirmed("spherical triangles", 1e-9, move || surface.by_angles(o, i, apart))
    .sees(2e-3);
    let mistaken =
        |truth: Truth, (what, other): &(&'static str, Surface)| truth.or_else(what, other.f_cos(to_viewer, to_light));
    instead.iter().fold(truth, mistaken)
}

fn diffuse() -> Truth {
    let rough = |roughness: f64| Surface { alpha: [roughness * roughness; 2], ..DIFFUSE };
    let truth = in_the_sun(
        "principled-diffuse-light-in-the-sun",
        DIFFUSE,
        [70.0, 65.0, 30.0],
        "(ρ/π)((1 − v_o/2)(1 − v_i/2) + R(v_o + v_i + v_o v_i (R − 1))) cos θ_i, R = 1.2 cos² θ_d",
        &[("α in place of the roughness", rough(0.36)), ("no light back to where it came from", rough(1e-6))],
    );
    let lambert = DIFFUSE.base / PI * 65_f64.to_radians().cos();
    truth.or_else("as Lambert has it", lambert)
}

fn flat() -> Truth {
    let surface = Surface { flatness: 0.75, ..DIFFUSE };
    in_the_sun(
        "principled-flat-light-in-the-sun",
        surface,
        [55.0, 40.0, 100.0],
        "(ρ/π)(¼ f_d + ¾·1.25 (S(1/(cos θ_o + cos θ_i) − ½) + ½)) cos θ_i",
        &[("not flat", DIFFUSE), ("flat throughout", Surface { flatness: 1.0, ..DIFFUSE })],
    )
}

fn sheen() -> Truth {
    let surface = Surface { sheen: 0.8, base: 0.0, ..DIFFUSE };
    let truth = in_the_sun(
        "principled-sheen-in-the-sun",
        surface,
        [75.0, 80.0, 170.0],
        "0.8 (1 − cos θ_d)⁵ cos θ_i",
        &[("half as much", Surface { sheen: 0.4, ..surface })],
    );
    let value = truth.value();
    let by_normal = 0.8 * grazing(80_f64.to_radians().cos()) * 80_f64.to_radians().cos();
    truth.or_else("divided by π", value / PI).or_else("by the angle to the normal", by_normal)
}

fn specular() -> Truth {
    let surface = GLOSSY;
    let truth = in_the_sun(
        "principled-highlight-in-the-sun",
        surface,
        [50.0, 35.0, 150.0],
        "F D G₁ G₁/(4 cos θ_o), α = 0.36, n = 1.6",
        &[
            ("the width squared", Surface { alpha: [0.36 * 0.36; 2], ..surface }),
            ("Schlick's reflectance", Surface { specular_tint: 1.0, ..surface }),
        ],
    );
    // G₂ = 1/(1 + Λ_o + Λ_i).
    let lambda = |deg: f64| 0.5 * ((1.0 + (0.36 * deg.to_radians().tan()).powi(2)).sqrt() - 1.0);
    let (l_o, l_i) = (lambda(50.0), lambda(35.0));
    let correlated = truth.value() * (1.0 + l_o) * (1.0 + l_i) / (1.0 + l_o + l_i);
    truth.or_else("masking by height", correlated).sees(1e-3)
}

/// A highlight of two widths.
fn grain() -> Truth {
    let surface = Surface { alpha: [0.15, 0.5], turned_deg: 30.0, ..GLOSSY };
    let (o, i) = (direction(50.0, 20.0), direction(35.0, 170.0));
    let again = move || {
        // Slopes of the facet along both axes, by tangents: those of its normal are those of the sum of the directions.
        let [x, y] = [o[0] + i[0], o[1] + i[1]].map(|part| part / (o[2] + i[2]));
        let (sin, cos) = (30_f64.to_radians()).sin_cos();
        let [along, across] = [cos * x + sin * y, cos * y - sin * x];
        let slope2 = x * x + y * y;
        let p = 1.0 / (PI * 0.15 * 0.5 * (1.0 + (along / 0.15).powi(2) + (across / 0.5).powi(2)).powi(2));
        let stretched = |tilt: f64, turn: f64| {
            let (sin, cos) = (turn - 30.0_f64).to_radians().sin_cos();
            (0.15 * cos).hypot(0.5 * sin) * tilt.to_radians().tan()
        };
        let g = |a: f64| 2.0 / (1.0 + (1.0 + a * a).sqrt());
        let d = (0.5 * (1.0 + dot(o, i))).sqrt();
        fresnel_exact(d, 1.6).reflectance()
            * p
            * (1.0 + slope2).powi(2)
            * g(stretched(50.0, 20.0))
            * g(stretched(35.0, 170.0))
            / (4.0 * o[2])
    };
    let instead = |other: Surface| other.f_cos(o, i);
    Truth::new(
        "principled-grain-in-the-sun",
        &lit(plate(o, &surface.json()), i),
        surface.f_cos(o, i),
        "F D G₁ G₁/(4 cos θ_o), α = 0.15 along a line 30° from u toward v, 0.5 across it",
    )
    .because(BECAUSE)
    .confirmed("slopes of facets by tangents", 1e-9, again)
    .or_else("the grain not turned", instead(Surface { turned_deg: 0.0, ..surface }))
    .or_else("turned the other way", instead(Surface { turned_deg: -30.0, ..surface }))
    .or_else("the widths exchanged", instead(Surface { alpha: [0.5, 0.15], ..surface }))
    .sees(1e-3)
}

fn metal() -> Truth {
    let surface = Surface { metallic: 1.0, index: 1.5, ..DIFFUSE };
    let truth = in_the_sun(
        "principled-metal-in-the-sun",
        surface,
        [65.0, 60.0, 175.0],
        "(ρ + (1 − ρ)(1 − cos θ_d)⁵) D G₁ G₁/(4 cos θ_o), ρ = 0.6",
        &[("a dielectric", Surface { metallic: 0.0, ..surface })],
    );
    let (o, i) = (direction(65.0, 20.0), direction(60.0, 195.0));
    let (value, fresnel) = (truth.value(), surface.fresnel(dot(o, normalize(add(o, i)))));
    let diffuse = DIFFUSE.f_cos(o, i);
    truth
        .or_else("the colour of the base at every angle", value * surface.base / fresnel)
        .or_else("diffuse light as well", value + diffuse)
}

fn coat() -> Truth {
    let surface = Surface { coat: 0.9, coat_alpha: 0.3, base: 0.0, ..DIFFUSE };
    let truth = in_the_sun(
        "principled-clear-coat-in-the-sun",
        surface,
        [60.0, 50.0, 165.0],
        "¼·0.9 (0.04 + 0.96 (1 − cos θ_d)⁵) D G₁ G₁ cos θ_i, α = 0.3 of D and ¼ of G₁",
        &[("the width squared", Surface { coat_alpha: 0.09, ..surface })],
    );
    let value = truth.value();
    truth
        .or_else(
            "divided by both cosines, as other facets are",
            value / (60_f64.to_radians().cos() * 50_f64.to_radians().cos()),
        )
        .or_else("not quartered", 4.0 * value)
        .sees(1e-3)
}

fn mixture() -> Truth {
    in_the_sun(
        "principled-mixture-in-the-sun",
        ALL,
        [60.0, 45.0, 140.0],
        "(1 − m)(diffuse + sheen) + F D G₁ G₁/(4 cos θ_o cos θ_i) + coat, all by cos θ_i, m = 0.3",
        &[
            ("no metal", Surface { metallic: 0.0, ..ALL }),
            ("no sheen", Surface { sheen: 0.0, ..ALL }),
            ("no coat", Surface { coat: 0.0, ..ALL }),
            ("not flat", Surface { flatness: 0.0, ..ALL }),
        ],
    )
}

/// The share of metal by an image of one value.
fn metal_by_image() -> Truth {
    let share = 102.0 / 255.0;
    let surface = Surface { metallic: share, ..ALL };
    let mut material = surface.json();
    material.as_object_mut().expect("an object").remove("metallic");
    material["metallic_image"] = json!({ "file": "share.png", "channel": "green" });
    let (o, i) = (direction(60.0, 20.0), direction(45.0, 160.0));
    Truth::new(
        "principled-share-of-metal-by-an-image",
        &lit(plate(o, &material), i).file("share.png", rgba_png(&[[255, 102, 0, 255]])),
        surface.f_cos(o, i),
        "f cos θ_i, m = 102/255",
    )
    .because(BECAUSE)
    .confirmed("spherical triangles", 1e-9, move || surface.by_angles(60.0, 45.0, 140.0))
    .or_else("no metal", Surface { metallic: 0.0, ..ALL }.f_cos(o, i))
    .or_else("all metal", Surface { metallic: 1.0, ..ALL }.f_cos(o, i))
    .or_else("another channel", Surface { metallic: 1.0, ..ALL }.f_cos(o, i))
    .sees(2e-3)
}

fn under_a_sky() -> Vec<Truth> {
    let r = 0.6;
    let above = |name: &'static str, surface: Surface, value: f64, formula: &str| {
        Truth::new(name, &plate([0.0, 0.0, 1.0], &surface.json()).sky(1.0).spp(512), value, formula)
            .because("Seen along the normal v_o is 0 and cos² θ_d is (1 + cos θ_i)/2: what is left are polynomials.")
            .confirmed("quadrature over the sky", 1e-5, move || {
                let ring = |theta: f64| {
                    2.0 * PI * theta.sin() * surface.f_cos([0.0, 0.0, 1.0], direction(theta.to_degrees(), 0.0))
                };
                interval(ring, 0.0, FRAC_PI_2 - 1e-12, 1e-9).value
            })
            .no_brighter_than(1.0)
            .sees(2e-3)
    };
    let rho = DIFFUSE.base;
    let diffuse = rho * (1.0 - 1.0 / 42.0 + r * 5.0 / 84.0);
    let cloth = Surface { sheen: 1.0, base: 0.0, ..DIFFUSE };
    // 8π∫(1 − c)⁵ (2c² − 1) c dc from √½ to 1, c the cosine of half the angle; with t = 1 − c.
    let (t, power) = (1.0 - 0.5_f64.sqrt(), |t: f64, n: i32| t.powi(n + 1) / f64::from(n + 1));
    let sheen = 8.0 * PI * (power(t, 5) - 5.0 * power(t, 6) + 6.0 * power(t, 7) - 2.0 * power(t, 8));
    let mut list = vec![
        above("principled-diffuse-light-under-a-sky-from-above", DIFFUSE, diffuse, "ρ(1 − 1/42 + 5r/84), r = 0.6")
            .or_else("as Lambert has it", rho)
            .or_else("α in place of r", rho * (1.0 - 1.0 / 42.0 + 0.36 * 5.0 / 84.0)),
        above("principled-sheen-under-a-sky-from-above", cloth, sheen, "8π∫(1 − c)⁵ (2c² − 1) c dc from √½ to 1")
            .or_else("divided by π", sheen / PI),
    ];
    let cases = [
        ("principled-mixture-under-a-sky", ALL, 55.0),
        ("principled-clear-coat-under-a-sky", Surface { coat: 1.0, coat_alpha: 0.05, base: 0.0, ..DIFFUSE }, 40.0),
        ("principled-metal-under-a-sky", Surface { metallic: 1.0, ..ALL }, 70.0),
    ];
    list.extend(cases.map(|(name, surface, tilt)| {
        let value = sky(&surface, tilt);
        Truth::new(
            name,
            &plate(direction(tilt, 20.0), &surface.json()).sky(1.0).spp(1024),
            value,
            format!("∫ f cos θ_i dω, seen {tilt}° off the normal"),
        )
        .because("In a sky of radiance 1 a surface shows how much of its light it gives back.")
        .confirmed("sums over facets", 2e-3, move || sky_by_facets(&surface, tilt))
        .or_else("no coat", sky(&Surface { coat: 0.0, ..surface }, tilt))
        .no_brighter_than(1.0)
        .sees(3e-3)
    }));
    list
}

/// A disk lamp above the camera, by each way to find it.
fn below_a_disk() -> Vec<Truth> {
    ["mis", "light", "bsdf"]
        .map(|how| {
            let shown = move |to: f64| {
                let ring = |theta: f64| {
                    2.0 * PI * theta.sin() * ALL.f_cos([0.0, 0.0, 1.0], direction(theta.to_degrees(), 0.0))
                };
                4.0 * interval(ring, 0.0, to, 1e-9).value
            };
            let value = shown(0.25 * PI);
            let scene = Scene::orthographic([0.0, 0.0, 0.5], [0.0; 3], 1e-3)
                .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": ALL.json() }))
                .lamp(disk([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 1.0), black(), 4.0, "front")
                .light_sampling(how)
                .film(16, 16)
                .spp(1024);
            Truth::new(
                format!("principled-mixture-below-a-disk-lamp-by-{how}"),
                &scene,
                value,
                "2πL∫f cos θ sin θ dθ to 45°, L = 4",
            )
            .because(BECAUSE)
            .confirmed("sums over facets", 1e-3, || {
                const STEPS: u32 = 4000;
                let step = std::f64::consts::FRAC_PI_8 / f64::from(STEPS);
                let at = |k: u32| (f64::from(k) + 0.5) * step;
                // θ is twice the facet's angle, dω_i is 4 cos θ_d dω_h.
                let ring = |h: f64| 2.0 * PI * h.sin() * 4.0 * h.cos() * ALL.by_angles(0.0, 2.0 * h.to_degrees(), 0.0);
                4.0 * (0..STEPS).map(at).map(ring).sum::<f64>() * step
            })
            .or_else("the whole sky", shown(FRAC_PI_2 - 1e-12))
            .or_else("counted by both ways", 2.0 * value)
            .no_brighter_than(8.0)
            .sees(3e-3)
        })
        .into()
}

/// α by an image: that of its own width, and a smooth one, which becomes the least width.
fn roughness_by_image() -> Vec<Truth> {
    let of = |name: &'static str, byte: u8, surface: Surface, value: f64, angles: [f64; 3], formula: &str| {
        let [o, i, apart] = angles;
        let file = format!("width-{byte}.png");
        let mut material = surface.json();
        material.as_object_mut().expect("an object").remove("alpha");
        material["roughness_image"] = json!({ "file": file, "channel": "green", "quantity": "alpha" });
        let (to_viewer, to_light) = (direction(o, 20.0), direction(i, 20.0 + apart));
        Truth::new(
            name,
            &lit(plate(to_viewer, &material), to_light).file(&file, rgba_png(&[[0, byte, 255, 255]])),
            value,
            formula,
        )
        .because(BECAUSE)
        .sees(1e-2)
    };
    let alpha = 92.0 / 255.0;
    let rough = Surface { alpha: [alpha; 2], ..DIFFUSE };
    let (o, i) = (direction(70.0, 20.0), direction(65.0, 50.0));
    let value = rough.f_cos(o, i);
    let smooth = Surface { alpha: [1e-4; 2], ..DIFFUSE };
    vec![
        of("principled-roughness-by-an-image", 92, rough, value, [70.0, 65.0, 30.0], "f cos θ_i, α = 92/255")
            // Between the widths that are made r is linear in α, and its curvature is small.
            .allows(1e-4 * value, "a blend of neighbouring widths stands for the image's, 1e-4 relative")
            .confirmed("spherical triangles", 1e-4, move || rough.by_angles(70.0, 65.0, 30.0))
            .or_else("another channel", Surface { alpha: [1.0; 2], ..DIFFUSE }.f_cos(o, i)),
        of(
            "principled-smooth-by-an-image",
            0,
            smooth,
            smooth.f_cos(o, i),
            [70.0, 65.0, 30.0],
            "f cos θ_i, α = 0.0001, r = 0.01",
        )
        .confirmed("spherical triangles", 1e-6, move || smooth.by_angles(70.0, 65.0, 30.0))
        .or_else("another channel", Surface { alpha: [1.0; 2], ..DIFFUSE }.f_cos(o, i)),
    ]
}

/// Both sides are alike, unless the scene says otherwise.
fn from_behind() -> Vec<Truth> {
    let (o, i) = (direction(60.0, 20.0), direction(45.0, 160.0));
    let below = |[x, y, z]: Vec3| [x, y, -z];
    let value = ALL.f_cos(o, i);
    let on = |sides: &str| {
        let mut material = ALL.json();
        material["sides"] = json!(sides);
        lit(plate(below(o), &material), below(i))
    };
    let shows = |name: &str, scene: &Scene| {
        Truth::new(name, scene, value, "f cos θ_i")
            .because("The back is the mirror image of the front in the plane of the surface.")
            .confirmed("spherical triangles", 1e-9, || ALL.by_angles(60.0, 45.0, 140.0))
            .or_else("black", 0.0)
            .sees(2e-3)
    };
    vec![
        shows("principled-from-behind", &lit(plate(below(o), &ALL.json()), below(i))),
        shows("principled-back-from-behind", &on("back")),
        Truth::new("principled-front-from-behind", &on("front"), 0.0, "0")
            .because("Its back is black, as the scene says.")
            .or_else("as bright as the front", value),
    ]
}
