//! A light meter, a small Lambert plate, under lights of every kind.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use super::{
    Truth,
    irradiance::{
        disk_by_quadrature, disk_irradiance, lambert_polygon, parallelogram_by_quadrature, rectangle_corner_factor,
        signed_polygon, sphere_by_quadrature, sphere_irradiance, triangle_by_quadrature,
    },
    scene::{PLATE_ALBEDO, Scene, black, block, disk, level_square, mesh, mirror, parallelogram, shown, sphere},
};
use crate::vector::Vec3;

const UP: Vec3 = [0.0, 0.0, 1.0];

pub(super) fn truths() -> Vec<Truth> {
    let mut list = spheres();
    list.extend(disks());
    list.extend(polygons());
    list.extend(ways_of_sampling());
    list.extend(without_surface());
    list.push(hundreds());
    list.extend(shadows());
    list.extend(mirrors());
    list
}

fn ball(radius: f64, distance: f64, tilt_rad: f64) -> Scene {
    let center = [distance * tilt_rad.sin(), 0.0, distance * tilt_rad.cos()];
    Scene::light_meter().lamp(sphere(center, radius), black(), 1.0, "front")
}

fn spheres() -> Vec<Truth> {
    let because = "A sphere looks like the disk it projects to: it fills the cone of sin α = R/d uniformly, and ∫cosθ dω over that \
         cone about a direction β off the normal is π sin²α·cosβ as long as all of it is above the horizon.";
    let cut = "The part of the spherical light below the horizon is cut off; what remains, projected on the plate, is a segment of an \
         ellipse and one of the unit disk.";
    let above = |name: &str, radius: f64, distance: f64, tilt_deg: f64| {
        let tilt = f64::to_radians(tilt_deg);
        let value = shown(sphere_irradiance(radius, distance, tilt));
        Truth::new(
            name,
            &ball(radius, distance, tilt),
            value,
            format!("(ρ/π)·π(R/d)²cosβ, R/d = {:e}, β = {tilt_deg}°", radius / distance),
        )
        .because(because)
        .confirmed("quadrature over the cone", 1e-7, move || shown(sphere_by_quadrature(radius, distance, tilt)))
    };
    let sunk = |name: &str, tilt_deg: f64| {
        let tilt = f64::to_radians(tilt_deg);
        let value = shown(sphere_irradiance(1.0, 2.0, tilt));
        Truth::new(name, &ball(1.0, 2.0, tilt), value, format!("(ρ/π)E(R/d = ½, β = {tilt_deg}°), horizon included"))
            .because(cut)
            .confirmed("quadrature over the cone, cut at the horizon", 1e-6, move || {
                shown(sphere_by_quadrature(1.0, 2.0, tilt))
            })
            .or_else("the horizon forgotten", shown(0.25 * PI * tilt.cos()))
    };
    let near = |name: &str, gap: f64| {
        let scene = Scene::light_meter_below(gap).lamp(sphere([0.0, 0.0, 1.0 + gap], 1.0), black(), 1.0, "front");
        Truth::new(name, &scene, shown(PI / (1.0 + gap).powi(2)), format!("(ρ/π)·π/(1 + ε)², ε = {gap:e}"))
            .because(because)
            .or_else("an offset hides the light", 0.0)
            .sees(0.01)
    };
    let inside = Scene::light_meter().lamp(sphere([0.2, 0.1, 0.3], 1.0), black(), 1.0, "back");
    vec![
        above("sphere-light-overhead", 1.0, 2.0, 0.0)
            .or_else("cosine of the receiver dropped", shown(2.0 * PI * (1.0 - 0.75_f64.sqrt()))),
        above("sphere-light-oblique", 0.5, 3.0, 60.0).or_else("cosine at the centre left out", shown(PI / 36.0)),
        sunk("sphere-light-setting", 80.0),
        sunk("sphere-light-set", 100.0),
        above("sphere-light-far", 3e-3, 1.0, 0.0)
            .or_else("1 − cos in single precision", 1.0067 * shown(9e-6 * PI))
            .sees(6e-3),
        above("sphere-light-farther", 2e-4, 1.0, 0.0)
            .or_else("1 − cos in single precision", 2.98 * shown(4e-8 * PI))
            .sees(0.01),
        above("sphere-light-very-far", 1e-5, 1.0, 0.0).or_else("1 − cos in single precision: black", 0.0).sees(0.01),
        near("sphere-light-near", 1e-2),
        near("sphere-light-touching", 1e-4),
        Truth::new("sphere-light-from-inside", &inside, PLATE_ALBEDO, "(ρ/π)·π")
            .because("Inside a sphere that shines inward light comes from everywhere: E = π.")
            .or_else("sampled as from outside", 1.0086 * PLATE_ALBEDO)
            .sees(0.008),
    ]
}

fn disks() -> Vec<Truth> {
    let lamp = |off: f64, radius: f64, height: f64| {
        Scene::light_meter().lamp(disk([off, 0.0, height], [0.0, 0.0, -1.0], radius), black(), 1.0, "front")
    };
    let because = "Integrated over rings about the axis, E = ∫cos²θ/d² dA; off the axis by Lambert's contour formula (Howell, B-13).";
    let truth = |name: &str, off: f64, radius: f64, height: f64| {
        let value = shown(disk_irradiance(radius, height, off));
        Truth::new(
            name,
            &lamp(off, radius, height),
            value,
            format!("(ρ/π)E of a disk r = {radius}, h = {height}, off axis {off}"),
        )
        .because(because)
        .confirmed("quadrature over the disk", 1e-8, move || {
            shown(disk_by_quadrature([off, 0.0, height], [0.0, 0.0, -1.0], radius, [0.0; 3], UP))
        })
    };
    vec![
        truth("disk-light", 0.0, 1.0, 1.0)
            .or_else("cosine of the light dropped", shown(2.0 * PI * (1.0 - FRAC_1_SQRT_2)))
            .or_else("radius taken for diameter", shown(PI / 5.0)),
        truth("disk-light-off-axis", 1.5, 1.0, 1.0).or_else("as on the axis", shown(PI / 2.0)),
        truth("disk-light-small", 0.0, 1e-3, 1.0).or_else("sampled with area doubled", shown(2e-6 * PI)),
    ]
}

fn quad(name: &str, origin: Vec3, u: Vec3, v: Vec3, formula: &str) -> Truth {
    let corners = [
        origin,
        [0, 1, 2].map(|i| origin[i] + u[i]),
        [0, 1, 2].map(|i| origin[i] + u[i] + v[i]),
        [0, 1, 2].map(|i| origin[i] + v[i]),
    ];
    let value = shown(lambert_polygon(&corners, UP));
    let scene = Scene::light_meter().lamp(parallelogram(origin, u, v), black(), 1.0, "front");
    Truth::new(name, &scene, value, formula)
        .because("Lambert's formula (1760): E = ½Σθᵢ(γᵢ·n) over the polygon's edges, after cutting it at the horizon.")
        .confirmed("quadrature over the parallelogram", 1e-5, move || {
            shown(parallelogram_by_quadrature(origin, u, v, [0.0; 3], UP))
        })
}

fn polygons() -> Vec<Truth> {
    let corners = [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 2.0]];
    let triangle = Scene::light_meter().lamp(mesh(&corners, &[[0, 1, 2]]), black(), 1.0, "both");
    let square = 4.0 * 0.5_f64.sqrt() * 0.5_f64.sqrt().atan();
    let cube_center = [1.2, 0.9, 1.5];
    let (low, high) = (cube_center.map(|c| c - 0.25), cube_center.map(|c| c + 0.25));
    let cube = Scene::light_meter().lamp(block(low, high), black(), 1.0, "front");
    // From the origin the faces at the low coordinate of each axis are seen.
    let faces = [
        [[low[0], low[1], low[2]], [high[0], low[1], low[2]], [high[0], high[1], low[2]], [low[0], high[1], low[2]]],
        [[low[0], low[1], low[2]], [low[0], high[1], low[2]], [low[0], high[1], high[2]], [low[0], low[1], high[2]]],
        [[low[0], low[1], low[2]], [high[0], low[1], low[2]], [high[0], low[1], high[2]], [low[0], low[1], high[2]]],
    ];
    let cube_value: f64 = faces.iter().map(|face| lambert_polygon(face, UP)).sum();
    let turned = Scene::light_meter().lamp(level_square([0.0, 0.0, 1.0], 1.0, true), black(), 1.0, "front");
    let both = Scene::light_meter().lamp(level_square([0.0, 0.0, 1.0], 1.0, true), black(), 1.0, "both");
    vec![
        quad(
            "square-light",
            [-1.0, -1.0, 1.0],
            [0.0, 2.0, 0.0],
            [2.0, 0.0, 0.0],
            "(ρ/π)·4g·atan g, g = a/√(1 + a²), a = 1",
        )
        .or_else("one cosine dropped, which leaves the solid angle", shown(4.0 * PI / 6.0)),
        quad(
            "rectangle-light-at-a-corner",
            [0.0, 0.0, 1.0],
            [0.0, 3.0, 0.0],
            [2.0, 0.0, 0.0],
            "(ρ/π)·πF, F of a corner, 2 × 3",
        )
        .confirmed("the configuration factor of a corner (Howell, B-3)", 1e-12, || {
            shown(PI * rectangle_corner_factor(2.0, 3.0))
        })
        .or_else("half of the rectangle", 0.5 * shown(PI * rectangle_corner_factor(2.0, 3.0))),
        quad("wall-light", [1.0, -1.0, 0.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0], "(ρ/π)E of a wall 2 × 2 at distance 1")
            .sees(0.01),
        quad(
            "wall-light-below-the-horizon",
            [1.0, -1.0, -1.0],
            [0.0, 0.0, 3.0],
            [0.0, 2.0, 0.0],
            "the same wall, reaching down",
        )
        .or_else(
            "negative cosines counted",
            shown(signed_polygon(&[[1.0, -1.0, -1.0], [1.0, -1.0, 2.0], [1.0, 1.0, 2.0], [1.0, 1.0, -1.0]], UP)),
        ),
        quad("square-light-far", [-5e-5, -5e-5, 1.0], [0.0, 1e-4, 0.0], [1e-4, 0.0, 0.0], "(ρ/π)·4g·atan g, a = 5e-5")
            .or_else("solid angle as angle sum − 2π in single precision", 0.954 * shown(1e-8))
            .sees(0.01),
        Truth::new("triangle-light", &triangle, shown(lambert_polygon(&corners, UP)), "(ρ/π)·½Σθᵢ(γᵢ·n)")
            .because("Lambert's formula (1760) for a triangle with corners (1,0,1), (0,1,1), (0,0,2).")
            .confirmed("quadrature over the triangle", 1e-8, move || {
                shown(triangle_by_quadrature(corners[0], corners[1], corners[2], UP))
            })
            .or_else("the parallelogram that it is half of", 2.0 * shown(lambert_polygon(&corners, UP))),
        Truth::new("cube-light", &cube, shown(cube_value), "(ρ/π)Σ over the three faces in view")
            .because("Each face in view adds its Lambert polygon; the hidden ones add nothing.")
            .confirmed("quadrature over the three faces", 1e-7, move || {
                let size = [0.5, 0.5, 0.5];
                let axis = |i: usize| std::array::from_fn(|j| if i == j { size[j] } else { 0.0 });
                let face = |i: usize, j: usize| parallelogram_by_quadrature(low, axis(i), axis(j), [0.0; 3], UP);
                shown(face(0, 1) + face(1, 2) + face(2, 0))
            })
            .or_else("hidden faces counted too: a convex body shows as much of its back", 2.0 * shown(cube_value)),
        Truth::new("square-light-turned-away", &turned, 0.0, "0")
            .because("The light emits from its front, which faces away.")
            .or_else("it shines on both sides", shown(square)),
        Truth::new("square-light-of-two-sides", &both, shown(square), "(ρ/π)·4g·atan g")
            .because("The light emits from both sides; the plate sees its back.")
            .or_else("it shines on its front only", 0.0)
            .or_else("twice", 2.0 * shown(square)),
    ]
}

fn ways_of_sampling() -> Vec<Truth> {
    let square = 4.0 * 0.5_f64.sqrt() * 0.5_f64.sqrt().atan();
    ["mis", "light", "bsdf"]
        .into_iter()
        .flat_map(|how| {
            let area = Scene::light_meter()
                .lamp(level_square([0.0, 0.0, 1.0], 1.0, false), black(), 1.0, "front")
                .light_sampling(how);
            let round = ball(1.0, 2.0, 0.0).light_sampling(how);
            let because = "The light's own truth, found by shadow rays, by BSDF rays, or by both weighted: the way must not matter.";
            [
                Truth::new(format!("square-light-by-{how}"), &area, shown(square), "(ρ/π)·4g·atan g")
                    .because(because)
                    .or_else("both ways in full", 2.0 * shown(square))
                    .sees(0.015),
                Truth::new(format!("sphere-light-by-{how}"), &round, shown(0.25 * PI), "(ρ/π)·π(R/d)²")
                    .because(because)
                    .or_else("both ways in full", 2.0 * shown(0.25 * PI))
                    .sees(0.02),
            ]
        })
        .collect()
}

fn without_surface() -> Vec<Truth> {
    let above = Scene::light_meter().point_light([0.0, 0.0, 2.0], 10.0);
    let aslant = Scene::light_meter().point_light([1.0, 0.0, 1.0], 10.0);
    let below = Scene::light_meter().point_light([1.0, 0.0, -1.0], 10.0);
    let sun = Scene::light_meter().directional_light([0.75_f64.sqrt(), 0.0, -0.5], 2.0);
    let sky = Scene::light_meter().sky(1.0);
    let mut ring = Scene::light_meter();
    for i in 0..20 {
        let phi = 2.0 * PI * f64::from(i) / 20.0;
        let center = [2.0 * FRAC_1_SQRT_2 * phi.cos(), 2.0 * FRAC_1_SQRT_2 * phi.sin(), 2.0 * FRAC_1_SQRT_2];
        ring = ring.lamp(sphere(center, 0.1), black(), f64::from(i + 1), "front");
    }
    let pair = ball(1.0, 2.0, 0.0).point_light([1.0, 0.0, 1.0], 2.0);
    let inverse_square = "A point source of intensity I gives E = I·cosθ/d².";
    vec![
        Truth::new("point-light-overhead", &above, shown(2.5), "(ρ/π)I/h²")
            .because(inverse_square)
            .or_else("intensity taken for power", shown(2.5 / (4.0 * PI)))
            .or_else("falling with the distance, not its square", shown(5.0)),
        Truth::new("point-light-oblique", &aslant, shown(5.0 * FRAC_1_SQRT_2), "(ρ/π)I·cosθ/d², θ = 45°, d² = 2")
            .because(inverse_square)
            .or_else("cosine dropped", shown(5.0)),
        Truth::new("point-light-below", &below, 0.0, "0")
            .because("The light is below the plate's horizon and shines on its other face.")
            .or_else("absolute value of the cosine", shown(5.0 * FRAC_1_SQRT_2)),
        Truth::new("directional-light", &sun, shown(1.0), "(ρ/π)E₀cosθ, E₀ = 2, θ = 60°")
            .because("Parallel light of irradiance E₀ at right angles gives E₀cosθ.")
            .or_else("cosine dropped", shown(2.0)),
        Truth::new("sky-on-a-plate", &sky, PLATE_ALBEDO, "ρL")
            .because("E = ∫cosθ dω = π over the hemisphere.")
            .or_else("the whole sphere counted", 2.0 * PLATE_ALBEDO),
        Truth::new(
            "twenty-lamps-in-a-ring",
            &ring,
            shown(210.0 * PI * 0.0025 * FRAC_1_SQRT_2),
            "(ρ/π)ΣLᵢπ(R/d)²cosβ, Lᵢ = 1…20, R/d = 0.05, β = 45°",
        )
        .because("Irradiances add up; each sphere is wholly above the horizon.")
        .or_else("chosen lamp not divided by its probability", shown(10.5 * PI * 0.0025 * FRAC_1_SQRT_2)),
        Truth::new("sphere-and-point-light", &pair, shown(0.25 * PI + FRAC_1_SQRT_2), "(ρ/π)(π/4 + I·cosθ/d²)")
            .because("Irradiances add up.")
            .or_else("only one of them", shown(0.25 * PI)),
    ]
}

/// Square lamps side by side in one plane, so that none hides another, every third turned away, among point lights and the sun.
fn hundreds() -> Truth {
    let numbers = || (0..14_i32).flat_map(|i| (0..14_i32).map(move |j| (i, j)));
    let lamp = |(i, j): (i32, i32)| {
        let half = 0.02 + 0.01 * f64::from((3 * i + 5 * j) % 7);
        let center = [0.2 * f64::from(i) - 1.1, 0.2 * f64::from(j) - 1.5, 1.0];
        (center, half, f64::from(1 + (i * j) % 5))
    };
    let turned_away = |(i, j): (i32, i32)| (i + j) % 3 == 0;
    let point = |k: i32| ([0.3 * f64::from(k) - 2.0, 2.0, 0.5 + 0.1 * f64::from(k % 4)], 0.02 * f64::from(1 + k % 3));
    let mut scene = Scene::light_meter().directional_light([0.75_f64.sqrt(), 0.0, -0.5], 0.3);
    for number in numbers() {
        let (center, half, radiance) = lamp(number);
        scene = scene.lamp(level_square(center, half, turned_away(number)), black(), radiance, "front");
    }
    for k in 0..12 {
        let (position, intensity) = point(k);
        scene = scene.point_light(position, intensity);
    }
    let of_points: f64 = (0..12)
        .map(|k| {
            let ([x, y, z], intensity) = point(k);
            intensity * z / (x * x + y * y + z * z).powf(1.5)
        })
        .sum();
    let of_lamps = move |away: bool, one: &dyn Fn(Vec3, f64) -> f64| -> f64 {
        numbers()
            .filter(|&number| away || !turned_away(number))
            .map(|number| {
                let (center, half, radiance) = lamp(number);
                radiance * one(center, half)
            })
            .sum()
    };
    let polygon = |[x, y, z]: Vec3, h: f64| {
        lambert_polygon(&[[x - h, y - h, z], [x + h, y - h, z], [x + h, y + h, z], [x - h, y + h, z]], UP)
    };
    let value = shown(of_lamps(false, &polygon) + of_points + 0.15);
    Truth::new("hundreds-of-lamps", &scene, value, "(ρ/π)(Σ Lᵢ·Eᵢ + Σ Iₖcosθₖ/dₖ² + E₀cosθ)")
        .because("Irradiances add up: 130 of 196 squares by Lambert's formula, twelve points, parallel light of E₀ = 0.3 at 60°.")
        .confirmed("quadrature over the squares", 1e-6, move || {
            let quadrature = |[x, y, z]: Vec3, h: f64| {
                let (u, v) = ([0.0, 2.0 * h, 0.0], [2.0 * h, 0.0, 0.0]);
                parallelogram_by_quadrature([x - h, y - h, z], u, v, [0.0; 3], UP)
            };
            shown(of_lamps(false, &quadrature) + of_points + 0.15)
        })
        .or_else("those turned away counted too", shown(of_lamps(true, &polygon) + of_points + 0.15))
        .or_else("the sun left out", shown(of_lamps(false, &polygon) + of_points))
}

fn shadows() -> Vec<Truth> {
    let disk_in_sky = Scene::light_meter().sky(1.0).object(disk([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 1.0), black());
    let ball_in_sky = Scene::light_meter().sky(1.0).object(sphere([0.0, 0.0, 2.0], 1.0), black());
    let knife = Scene::light_meter()
        .lamp(disk([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 0.5), black(), 1.0, "front")
        .object(parallelogram([-2.0, -2.0, 0.5], [2.0, 0.0, 0.0], [0.0, 4.0, 0.0]), black());
    let eclipse = Scene::light_meter()
        .lamp(sphere([0.0, 0.0, 4.0], 1.0), black(), 1.0, "front")
        .object(sphere([0.0, 0.0, 2.0], 0.25), black());
    vec![
        Truth::new("sky-behind-a-disk", &disk_in_sky, shown(0.5 * PI), "(ρ/π)(π − πr²/(r² + h²))")
            .because("The black disk takes from the sky what it would give if it shone.")
            .or_else("no shadow", shown(PI)),
        Truth::new("sky-behind-a-sphere", &ball_in_sky, shown(0.75 * PI), "(ρ/π)(π − π(R/d)²)")
            .because("The black sphere takes from the sky what it would give if it shone.")
            .or_else("no shadow", shown(PI)),
        Truth::new("penumbra", &knife, shown(0.1 * PI), "(ρ/π)·½πr²/(r² + h²), r = ½, h = 1")
            .because(
                "A knife edge through the axis hides half of a disk light, and the halves give the same by symmetry.",
            )
            .or_else("shadow rays aimed at the centre only: all or nothing", shown(0.2 * PI)),
        Truth::new("annular-eclipse", &eclipse, shown(PI * (1.0 / 16.0 - 1.0 / 64.0)), "(ρ/π)·π((R/d)² − (r/e)²)")
            .because("A black ball, concentric in view, hides a smaller cone of the light's cone.")
            .or_else("no shadow", shown(PI / 16.0)),
    ]
}

fn mirrors() -> Vec<Truth> {
    // Rectangle [0, 1] × [−1, 1] at height 1 beside a mirror in the plane x = 0, seen from x = .3.
    let at = [0.3, 0.0, 0.0];
    let half = |from: f64, to: f64| {
        let x = [from - at[0], to - at[0]];
        lambert_polygon(&[[x[0], -1.0, 1.0], [x[1], -1.0, 1.0], [x[1], 1.0, 1.0], [x[0], 1.0, 1.0]], UP)
    };
    let beside = Scene::light_meter_at(at)
        .lamp(parallelogram([0.0, -1.0, 1.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]), black(), 1.0, "front")
        .object(parallelogram([0.0, -2.0, -1.0], [0.0, 4.0, 0.0], [0.0, 0.0, 2.0]), mirror(0.8));
    let (direct, image) = (half(0.0, 1.0), half(-1.0, 0.0));
    // A square tunnel from below the plate to the light, closed all round.
    let tunnel = [
        ([-0.5, -0.5, -0.1], [1.0, 0.0, 0.0]),
        ([-0.5, 0.5, -0.1], [1.0, 0.0, 0.0]),
        ([-0.5, -0.5, -0.1], [0.0, 1.0, 0.0]),
        ([0.5, -0.5, -0.1], [0.0, 1.0, 0.0]),
    ]
    .into_iter()
    .fold(
        Scene::light_meter().lamp(level_square([0.0, 0.0, 5.0], 0.5, false), black(), 1.0, "front").spp(512),
        |scene, (origin, along)| scene.object(parallelogram(origin, along, [0.0, 0.0, 5.1]), mirror(1.0)),
    );
    vec![
        Truth::new("light-beside-a-mirror", &beside, shown(direct + 0.8 * image), "(ρ/π)(E + ρₘE of the image), ρₘ = 0.8")
            .because("A flat mirror of reflectance ρₘ adds the light's image, ρₘ as bright.")
            .confirmed("quadrature over the light and its image", 1e-8, move || {
                let part = |x: f64| {
                    parallelogram_by_quadrature([x, -1.0, 1.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], at, UP)
                };
                shown(part(0.0) + 0.8 * part(-1.0))
            })
            .or_else("light by way of the mirror lost", shown(direct))
            .or_else("a perfect mirror", shown(direct + image)),
        Truth::new("light-through-a-mirror-tunnel", &tunnel, PLATE_ALBEDO, "(ρ/π)·π")
            .because(
                "The images of the light in four perfect mirrors tile the plane at its height: E = π, however long the tunnel. \
                 Only BSDF rays find it, after up to hundreds of reflections: after k with a probability that falls as 1/k², so that no \
                 number of them holds all paths. Nothing is brighter than the light, 1, for mirrors and the plate only pass on what they get.",
            )
            .no_brighter_than(1.0)
            .or_else("direct light only", shown(PI * 4.0 * rectangle_corner_factor(0.1, 0.1))),
    ]
}
