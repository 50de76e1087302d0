//! Floors lit by way of a mirror or a plate of glass, found by paths from the lamps and without them.

use super::{
    Claim, Truth,
    scene::{Scene, black, block, glass, grey_hdr, lambert, level_square, mirror, parallelogram, shown, sphere},
};
use crate::laws::fresnel_exact;
use crate::vector::{add, dot, normalize, scale};
use serde_json::json;
use std::f64::consts::PI;

/// The words that a scene may say of light paths.
const WAYS: [&str; 2] = ["always", "never"];
/// Half of the side of the square that the camera sees, m.
fn half_view() -> f64 {
    0.5 * 20.0_f64.to_radians().tan()
}

pub(super) fn truths() -> Vec<Truth> {
    WAYS.into_iter()
        .flat_map(|way| [by_a_mirror(way, false), through_a_plate(way), in_glass(way)])
        .map(|truth| truth.claims(Claim::SpecularConnections))
        // Without light paths, few samples find the lamp.
        .chain([by_a_mirror("always", true)])
        .chain(WAYS.map(sky_by_a_mirror))
        .chain(
            [by_a_bent_mirror(), by_a_mirror_bent_beyond_the_sun()]
                .map(|truth| truth.claims(Claim::SpecularConnections)),
        )
        .collect()
}

/// A camera that looks straight down at a square of a floor about x = 0.5.
fn floor(way: &'static str) -> Scene {
    Scene::pinhole([0.5, 0.0, 0.5], [0.5, 0.0, 0.0], 40.0)
        .up([0.0, 1.0, 0.0])
        .object(level_square([0.5, 0.0, 0.0], 0.2, true), lambert(0.5))
        .set("integrator", "light_tracing", json!(way))
        .film(24, 24)
}

/// Samples, by the way in which a scene is rendered.
fn spp(way: &str, always: u32, never: u32) -> u32 {
    if way == "always" { always } else { never }
}

/// The lamp is shaded by a sheet, and lights the floor by way of an upright mirror.
fn by_a_mirror(way: &'static str, has_area: bool) -> Truth {
    const REFLECTANCE: f64 = 0.9;
    const RADIUS_M: f64 = 0.1;
    let (lamp, intensity) = ([0.2, 0.0, 0.8], 3.0);
    // As far behind the mirror, which stands at x = −0.6.
    let (near, far, height, half) = (1.9 - half_view(), 1.9 + half_view(), lamp[2], half_view());
    let solid_angle = |x: f64| (x * half / (height * (x * x + half * half + height * height).sqrt())).atan();
    let mean = intensity * 2.0 * (solid_angle(far) - solid_angle(near)) / (4.0 * half * half);
    let scene = floor(way)
        .object(parallelogram([-0.6, -0.2, 0.3], [0.0, 0.4, 0.0], [0.0, 0.0, 0.32]), mirror(REFLECTANCE))
        .object(parallelogram([0.05, -0.2, 0.6], [0.45, 0.0, 0.0], [0.0, 0.4, 0.0]), black());
    let (name, scene) = match has_area {
        false => ("lamp-at-a-point", scene.point_light(lamp, intensity).spp(spp(way, 256, 64))),
        true => {
            let radiance = intensity / (PI * RADIUS_M * RADIUS_M);
            let scene = scene.lamp(sphere(lamp, RADIUS_M), black(), radiance, "front");
            ("ball-lamp", scene.spp(256))
        }
    };
    Truth::new(
        format!("{name}-by-a-mirror-with-light-paths-{way}"),
        &scene,
        shown(REFLECTANCE * mean),
        "(ρ/π) R I Ω/A of the lamp's image above the square",
    )
    .because(
        "The mirror shows the lamp as far behind itself. A lamp of intensity I sends the flux I Ω to a square of the solid angle Ω, and a ball sends as \
         much as a point in its middle. The floor sends nothing to itself by way of the mirror.",
    )
    .confirmed("irradiance I h/r³ over a grid of points", 1e-4, move || {
        let at = |step: u32| half * ((f64::from(step) + 0.5) / 100.0 - 1.0);
        let irradiance = |x: f64, y: f64| intensity * height / ((x + 1.9).powi(2) + y * y + height * height).powf(1.5);
        let sum: f64 = (0..200).flat_map(|i| (0..200).map(move |j| irradiance(at(i), at(j)))).sum();
        shown(REFLECTANCE * sum / 40_000.0)
    })
    .or_else("the mirror shows nothing", 0.0)
    .or_else("the mirror loses nothing", shown(mean))
    .or_else("light counted twice", shown(2.0 * REFLECTANCE * mean))
    .sees(0.01)
}

/// A sky that is bright about the zenith and faint elsewhere, and its image in an upright mirror beside the floor.
fn sky_by_a_mirror(way: &'static str) -> Truth {
    const REFLECTANCE: f64 = 0.5;
    const BRIGHT: f64 = 6.0;
    // The mirror stands at x = 0.2, from the floor up to 0.6 m, and is 1.2 m wide.
    let (place, height, wide) = (0.2, 0.6, 0.6);
    // Between the centres of the first two rows of the image.
    let (upper, lower) = (PI / 8.0, 3.0 * PI / 8.0);
    let slope = (1.0 - BRIGHT) / (lower - upper);
    let radiance = move |polar: f64| BRIGHT + slope * (polar.clamp(upper, lower) - upper);
    // ∫ L cos θ sin θ dθ from the zenith.
    let up_to = move |polar: f64| {
        let of_constant = |from: f64, to: f64| 0.5 * (to.sin().powi(2) - from.sin().powi(2));
        let of_angle = |polar: f64| (2.0 * polar).sin() / 8.0 - polar * (2.0 * polar).cos() / 4.0;
        let [first, second] = [polar.min(upper), polar.clamp(upper, lower)];
        BRIGHT * of_constant(0.0, first)
            + (BRIGHT - slope * upper) * of_constant(upper, second)
            + slope * (of_angle(second) - of_angle(upper))
            + of_constant(lower, polar.max(lower))
    };
    let whole = 2.0 * PI * up_to(0.5 * PI);
    let half = half_view();
    let at = move |step: u32, steps: u32| half * (2.0 * (f64::from(step) + 0.5) / f64::from(steps) - 1.0);
    // What comes from the mirror to a point, if that reflects all: over azimuths, up to its upper edge.
    let of_mirror = move |x: f64, y: f64| {
        let away = x - place;
        let [from, to] = [-wide - y, wide - y].map(|side: f64| (side / away).atan());
        let steps = 200;
        let step = (to - from) / f64::from(steps);
        let of = |k: i32| {
            let edge = (away / ((from + (f64::from(k) + 0.5) * step).cos() * height)).atan();
            up_to(0.5 * PI) - up_to(edge)
        };
        (0..steps).map(of).sum::<f64>() * step
    };
    let steps = 40;
    let points = (0..steps).flat_map(|i| (0..steps).map(move |j| (0.5 + at(i, steps), at(j, steps))));
    let mirrored = points.map(|(x, y)| of_mirror(x, y)).sum::<f64>() / f64::from(steps * steps);
    let image: Vec<f64> = (0..32).map(|texel| if texel < 8 { BRIGHT } else { 1.0 }).collect();
    let scene = floor(way)
        .object(parallelogram([place, -wide, 0.0], [0.0, 2.0 * wide, 0.0], [0.0, 0.0, height]), mirror(REFLECTANCE))
        .light(json!({ "type": "environment", "image": {
            "file": "bright-above.hdr", "projection": "latitude-longitude", "up": [0, 0, 1], "forward": [1, 0, 0] } }))
        .file("bright-above.hdr", grey_hdr(8, &image))
        .spp(256);
    Truth::new(
        format!("sky-by-a-mirror-with-light-paths-{way}"),
        &scene,
        shown(whole - (1.0 - REFLECTANCE) * mirrored),
        "(ρ/π)(E − (1 − R) E′), E′ of the directions in which the mirror stands",
    )
    .because("The sky is the same all around. So an upright mirror shows what is behind it, times R.")
    .confirmed("irradiance by the parts of the mirror", 2e-3, move || {
        let (points, columns, rows) = (12, 240, 120);
        let of = |x: f64, y: f64| {
            let parts = (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j)));
            let parts = parts.map(|(i, j)| {
                let across = wide * (2.0 * (f64::from(i) + 0.5) / f64::from(columns) - 1.0) - y;
                let up = height * (f64::from(j) + 0.5) / f64::from(rows);
                let away = x - place;
                let r = (across * across + up * up + away * away).sqrt();
                radiance((up / r).acos()) * up * away / r.powi(4)
            });
            parts.sum::<f64>() * (2.0 * wide / f64::from(columns)) * (height / f64::from(rows))
        };
        let places = (0..points).flat_map(|i| (0..points).map(move |j| (0.5 + at(i, points), at(j, points))));
        let mean = places.map(|(x, y)| of(x, y)).sum::<f64>() / f64::from(points * points);
        // The whole sky by rings.
        let rings: f64 = (0..10_000)
            .map(|k| (f64::from(k) + 0.5) * PI / 20_000.0)
            .map(|polar| radiance(polar) * (2.0 * polar).sin())
            .sum();
        shown(rings * PI * PI / 20_000.0 - (1.0 - REFLECTANCE) * mean)
    })
    .or_else("the mirror shows nothing", shown(whole - mirrored))
    .or_else("the mirror loses nothing", shown(whole))
    .sees(0.01)
}

/// The sun, shaded by a sheet, lights the floor by way of an upright mirror whose shading normals lean.
fn by_a_bent_mirror() -> Truth {
    const REFLECTANCE: f64 = 0.9;
    let (lean, irradiance) = (20.0_f64.to_radians(), 2.0);
    let to_floor = normalize([1.1, 0.0, -0.5]);
    let normal = [lean.cos(), 0.0, lean.sin()];
    let sun = add(scale(2.0 * dot(normal, to_floor), normal), scale(-1.0, to_floor));
    let arriving = REFLECTANCE * irradiance * -to_floor[2];
    let scene = floor("always")
        .thing(json!({
            "shape": {
                "type": "mesh",
                "vertices_m": [[-0.6, -0.3, 0.3], [-0.6, 0.3, 0.3], [-0.6, 0.3, 0.7], [-0.6, -0.3, 0.7]],
                "triangles": [[0, 1, 2], [0, 2, 3]],
                "normals": [normal, normal, normal, normal],
            },
            "material": mirror(REFLECTANCE),
        }))
        .object(parallelogram([0.5, -0.3, 0.6], [0.6, 0.0, 0.0], [0.0, 0.6, 0.0]), black())
        .directional_light(scale(-1.0, sun), irradiance)
        .spp(256);
    Truth::new(
        "sun-by-a-bent-mirror-with-light-paths-always",
        &scene,
        shown(arriving),
        "(ρ/π) R E cos θ, θ at the floor",
    )
    .because(
        "The floor sees the radiance of the sun, times R, in the direction that is mirrored about the shading normal. A mirror image keeps solid          angles, so E is the same, whatever the angle at which the sun meets the mirror itself.",
    )
    .confirmed("the sun's elevation less twice the lean", 1e-12, move || {
        let elevation = sun[2].atan2(sun[0]);
        shown(REFLECTANCE * irradiance * (elevation - 2.0 * lean).sin())
    })
    .or_else("shading normals ignored", 0.0)
    .or_else("power left as it arrives on the mirror", shown(arriving * sun[0] / to_floor[0]))
    .sees(0.01)
}

/// The same, with a sun whose light meets the mirror at a smaller angle than its shading normals lean.
fn by_a_mirror_bent_beyond_the_sun() -> Truth {
    const REFLECTANCE: f64 = 0.9;
    let (lean, grazing, irradiance) = (25.0_f64.to_radians(), 20.0_f64.to_radians(), 2.0);
    // Elevations of the light that the floor sees.
    let below = PI / 2.0 - 2.0 * lean;
    let elevations = [below - grazing, below + grazing, PI / 2.0 - grazing];
    let shown_of = |shares: [f64; 3]| {
        let sines = elevations.iter().zip(shares).map(|(elevation, share)| share * elevation.sin());
        shown(REFLECTANCE * irradiance * sines.sum::<f64>())
    };
    let normal = [lean.cos(), 0.0, lean.sin()];
    let scene = floor("always")
        .thing(json!({
            "shape": {
                "type": "mesh",
                "vertices_m": [[-0.6, -0.3, 0.3], [-0.6, 0.3, 0.3], [-0.6, 0.3, 3.6], [-0.6, -0.3, 3.6]],
                "triangles": [[0, 1, 2], [0, 2, 3]],
                "normals": [normal, normal, normal, normal],
            },
            "material": mirror(REFLECTANCE),
        }))
        .object(parallelogram([0.5, -0.3, 0.6], [0.45, 0.0, 0.0], [0.0, 0.6, 0.0]), black())
        .directional_light([-grazing.sin(), 0.0, -grazing.cos()], irradiance)
        .spp(1024);
    Truth::new(
        "sun-by-a-mirror-bent-beyond-it-with-light-paths-always",
        &scene,
        shown_of([1.0; 3]),
        "(ρ/π) R E Σ sin θ, θ of three elevations: 90° − 2ν − ε, 90° − 2ν + ε, 90° − ε, normals lean by ν, the sun is ε above the mirror",
    )
    .because(
        "A mirror image about the shading normal that is behind the mirror is brought to the front, and so is an eye that is behind the shading \
         normal. So the floor sees the sun in three directions, each with its whole solid angle.",
    )
    .confirmed("a search over the elevations in which the floor may look", 1e-3, move || {
        // Angles from the mirror's own normal, upward.
        let seen = |elevation: f64| {
            let eye = if (lean + elevation).cos() > 0.0 { -elevation } else { PI + 2.0 * lean + elevation };
            let image = 2.0 * lean - eye;
            let front = if image.cos() > 0.0 { image } else { PI - image };
            (front - (PI / 2.0 - grazing)).sin()
        };
        let steps = 100_003;
        let at = |step: usize| step as f64 / steps as f64 * PI / 2.0;
        let crossings = (1..steps).filter(|step| {
            let [before, after] = [seen(at(step - 1)), seen(at(*step))];
            before * after <= 0.0 && (before - after).abs() < 0.1
        });
        shown(REFLECTANCE * irradiance * crossings.map(|step| at(step).sin()).sum::<f64>())
    })
    .or_else("light from behind is lost", shown_of([1.0, 0.0, 0.0]))
    .or_else("of two ways the one that is drawn counts once", shown_of([0.5, 0.25, 0.25]))
    .or_else("an eye behind the shading normal sees nothing", shown_of([1.0, 1.0, 0.0]))
    .sees(0.01)
}

/// The sun high above a plate of glass, and paths of four edges: camera, floor, two faces, sun.
fn through_a_plate(way: &'static str) -> Truth {
    const INDEX: f64 = 1.5;
    let kept = 1.0 - fresnel_exact(1.0, INDEX).reflectance();
    let irradiance = 2.0;
    let scene = floor(way)
        .object(block([0.2, -0.3, 0.7], [0.8, 0.3, 0.8]), glass(INDEX))
        .directional_light([0.0, 0.0, -1.0], irradiance)
        .depth(4)
        .spp(spp(way, 256, 16));
    Truth::new(
        format!("sun-through-a-plate-with-light-paths-{way}"),
        &scene,
        shown(kept * kept * irradiance),
        "(ρ/π) (1 − R)² E, R = ((n − 1)/(n + 1))²",
    )
    .because("Each face passes 1 − R; what goes to and fro inside takes more edges than paths may have.")
    .confirmed("4n/(n + 1)² of each face", 1e-12, move || {
        shown((4.0 * INDEX / ((INDEX + 1.0) * (INDEX + 1.0))).powi(2) * irradiance)
    })
    .or_else("no light through glass", 0.0)
    .or_else("power scaled by n² at one face", shown(kept * kept * irradiance * INDEX * INDEX))
    .sees(0.01)
}

/// The sun high above a block of glass that holds floor and camera, and paths of three edges: camera, floor, upper face, sun.
fn in_glass(way: &'static str) -> Truth {
    const INDEX: f64 = 1.5;
    let kept = 1.0 - fresnel_exact(1.0, INDEX).reflectance();
    let irradiance = 2.0;
    let scene = floor(way)
        .object(block([0.2, -0.3, -0.1], [0.8, 0.3, 0.6]), glass(INDEX))
        .directional_light([0.0, 0.0, -1.0], irradiance)
        .depth(3)
        .spp(spp(way, 256, 32));
    Truth::new(
        format!("sun-on-a-floor-in-glass-with-light-paths-{way}"),
        &scene,
        shown(kept * irradiance),
        "(ρ/π) (1 − R) E",
    )
    .because(
        "The upper face passes 1 − R of the power, whatever the index. The radiance of the sun is n² times as high within, and fills 1/n² of the \
         solid angle. What the floor sends back is seen within the glass.",
    )
    .confirmed("4n/(n + 1)²", 1e-12, move || shown(4.0 * INDEX / ((INDEX + 1.0) * (INDEX + 1.0)) * irradiance))
    .or_else("no light through glass", 0.0)
    .or_else("power scaled by n²", shown(kept * irradiance * INDEX * INDEX))
    .or_else("power scaled by 1/n²", shown(kept * irradiance / (INDEX * INDEX)))
    .sees(0.01)
}
