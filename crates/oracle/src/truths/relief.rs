//! Normals that are not those of the shape: of vertices, of normal maps and of bump maps, also on stretched and mirrored things; and those
//! of a stretched ball.

use serde_json::{Value, json};

use super::{
    Truth,
    scene::{Scene, grey_hdr, parallelogram, radiance_hdr, sphere},
};
use crate::vector::{Vec3, dot, normalize, scale};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = normal_maps();
    list.extend(bump_maps());
    list.extend(vertex_normals());
    list.push(interpolated());
    list.push(stretched_ball());
    list.push(bumps_of_a_ball());
    list
}

const ALBEDO: f64 = 0.8;
/// Toward the light, along no axis and no diagonal.
const TO_LIGHT: Vec3 = [0.3, 0.5, 0.8];

/// What a Lambert surface of this normal shows in parallel light of irradiance π.
fn shown(normal: Vec3) -> f64 {
    ALBEDO * dot(normalize(normal), normalize(TO_LIGHT)).max(0.0)
}

fn white() -> Value {
    json!({ "type": "lambert", "reflectance": ALBEDO })
}

/// From above, a square of side 0.2 m about a place of the plane z = 0.
fn view(centre: [f64; 2]) -> Scene {
    let [x, y] = centre;
    Scene::orthographic([x, y, 2.0], [x, y, 0.0], 0.2)
        .directional_light(scale(-1.0, normalize(TO_LIGHT)), std::f64::consts::PI)
        .film(16, 16)
        .spp(64)
}

fn square() -> Value {
    parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
}

const BECAUSE: &str = "A Lambert surface scatters around its shading normal n, which is not that of its shape: in parallel light of irradiance π \
                       from l it shows ρ n·l.";

fn truth(name: &str, scene: &Scene, normal: Vec3, formula: &str) -> Truth {
    let again = move || {
        // The same from the angle between both, by its tangent: |n × l| and n·l of vectors that are not unit vectors.
        let across = crate::vector::length(crate::vector::cross(normal, TO_LIGHT));
        ALBEDO * across.atan2(dot(normal, TO_LIGHT)).cos()
    };
    Truth::new(name, scene, shown(normal), formula)
        .because(BECAUSE)
        .confirmed("the cosine of the angle, from its tangent", 1e-12, again)
        .or_else("the normal of the shape", shown([0.0, 0.0, 1.0]))
        .sees(1e-3)
}

/// Red, green and blue of an image whose normal is (½, −¼, ¾).
const TILTED: [f64; 3] = [0.75, 0.375, 0.875];

fn normal_maps() -> Vec<Truth> {
    let file = "tilted-normal.hdr";
    let scene = |shape: Value, further: Value, transform: Value, by_instance: bool, centre: [f64; 2]| {
        let mut map = json!({ "file": file });
        for (key, value) in further.as_object().into_iter().flatten() {
            map[key] = value.clone();
        }
        let mut object = json!({ "shape": shape, "material": white(), "normal_map": map });
        let scene = view(centre).file(file, radiance_hdr(1, &[TILTED]));
        if by_instance {
            scene
                .set("groups", "sheet", json!({ "objects": [object] }))
                .whole("instances", json!([{ "group": "sheet", "transform": transform }]))
        } else {
            object["transform"] = transform;
            scene.thing(object)
        }
    };
    let n = [0.5, -0.25, 0.75];
    let flipped = |k: usize| {
        let mut flipped = n;
        flipped[k] = -flipped[k];
        shown(flipped)
    };
    let plain = |name: &str, further: Value, normal: Vec3| {
        truth(
            name,
            &scene(square(), further, json!([]), false, [0.5, 0.5]),
            normal,
            "ρ n·l, n of the map along u, v and z",
        )
    };
    // The texture coordinate v falls along y.
    let upside_down = json!({
        "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "triangles": [[0, 1, 2], [0, 2, 3]],
        "uvs": [[0, 1], [1, 1], [1, 0], [0, 0]],
    });
    let mirrored = json!([{ "scale": [-2, 1.5, 1] }]);
    let stretched = json!([{ "scale": [1, 3, 1] }, { "rotate": { "axis": [0, 0, 1], "angle_deg": 90 } }]);
    let sheet = |name: &str, transform: &Value, by_instance: bool, centre: [f64; 2], normal: Vec3| {
        truth(
            name,
            &scene(square(), json!({}), transform.clone(), by_instance, centre),
            normal,
            "ρ n·l, n along the placed u, v and z",
        )
        .or_else("tangents not placed", shown(n))
    };
    vec![
        plain("normal-map", json!({}), n).or_else("red turned", flipped(0)).or_else("green turned", flipped(1)),
        plain("normal-map-of-other-strength", json!({ "strength": [0.5, -2] }), [0.25, 0.5, 0.75])
            .or_else("the strength left out", shown(n)),
        truth(
            "normal-map-along-v-that-falls",
            &scene(upside_down.clone(), json!({}), json!([]), false, [0.5, 0.5]),
            [0.5, 0.25, 0.75],
            "ρ n·l, green along −y",
        )
        .or_else("green along y", shown(n)),
        truth(
            "normal-map-across-u-where-v-falls",
            &scene(upside_down, json!({ "bitangent": "across-u" }), json!([]), false, [0.5, 0.5]),
            n,
            "ρ n·l, green along z × x",
        )
        .or_else("green along v", shown([0.5, 0.25, 0.75])),
        sheet("normal-map-mirrored-and-stretched", &mirrored, false, [-1.0, 0.75], [-0.5, -0.25, 0.75]),
        sheet("normal-map-of-a-mirrored-and-stretched-instance", &mirrored, true, [-1.0, 0.75], [-0.5, -0.25, 0.75]),
        // u along y, v along −x.
        sheet("normal-map-stretched-and-turned", &stretched, false, [-1.5, 0.5], [0.25, 0.5, 0.75]),
        sheet("normal-map-of-a-stretched-and-turned-instance", &stretched, true, [-1.5, 0.5], [0.25, 0.5, 0.75]),
    ]
}

fn bump_maps() -> Vec<Truth> {
    const HEIGHT_M: f64 = 0.8;
    let file = "ramp.hdr";
    // Grows by 1/8 from texel to texel along u, a quarter of the square each, and by 1/16 along v from below.
    let ramp: Vec<f64> =
        (0..4).rev().flat_map(|row| (0..4).map(move |column| f64::from(2 * column + row + 1) / 16.0)).collect();
    let scene = |transform: Value, by_instance: bool, centre: [f64; 2], further: Value| {
        let mut map = json!({ "file": file, "height_m": HEIGHT_M, "wrap": "clamp" });
        for (key, value) in further.as_object().into_iter().flatten() {
            map[key] = value.clone();
        }
        let mut object = json!({ "shape": square(), "material": white(), "bump_map": map });
        let scene = view(centre).file(file, grey_hdr(4, &ramp));
        if by_instance {
            scene
                .set("groups", "sheet", json!({ "objects": [object] }))
                .whole("instances", json!([{ "group": "sheet", "transform": transform }]))
        } else {
            object["transform"] = transform;
            scene.thing(object)
        }
    };
    // Slopes along the sides of the square.
    let (along_u, along_v) = (HEIGHT_M * 0.125 / 0.25, HEIGHT_M * 0.0625 / 0.25);
    let normal = |x: f64, y: f64| [-x, -y, 1.0];
    let make = |name: &str, transform: Value, by_instance: bool, centre: [f64; 2], slopes: [f64; 2]| {
        let [x, y] = slopes;
        truth(name, &scene(transform, by_instance, centre, json!({})), normal(x, y), "ρ n·l, n ∝ (−∂h/∂x, −∂h/∂y, 1)")
            .or_else("white is deep", shown(normal(-x, -y)))
            .or_else("u and v exchanged", shown(normal(y, x)))
    };
    let mirrored = || json!([{ "scale": [-2, 0.5, 3] }]);
    let by_mirror = [-along_u / 2.0, along_v / 0.5];
    let unplaced = shown(normal(along_u, along_v));
    let scaled = json!({ "uv_scale": [0.5, 2], "uv_offset": [0.25, -0.5], "height_m": -HEIGHT_M });
    vec![
        make("bump-map", json!([]), false, [0.5, 0.5], [along_u, along_v]),
        make("bump-map-mirrored-and-stretched", mirrored(), false, [-1.0, 0.25], by_mirror)
            .or_else("slopes not placed", unplaced),
        make("bump-map-of-a-mirrored-and-stretched-instance", mirrored(), true, [-1.0, 0.25], by_mirror)
            .or_else("slopes not placed", unplaced),
        truth(
            "bump-map-deep-and-scaled",
            &scene(json!([]), false, [0.5, 0.5], scaled),
            normal(-0.5 * along_u, -2.0 * along_v),
            "ρ n·l, n ∝ (½h′, 2h′, 1)",
        )
        .or_else("the scale of coordinates left out", shown(normal(-along_u, -along_v)))
        .or_else("white is high", shown(normal(0.5 * along_u, 2.0 * along_v))),
    ]
}

fn vertex_normals() -> Vec<Truth> {
    let n = [0.3, 0.2, 0.9];
    let mesh = |shading: &str| {
        json!({
            "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "triangles": [[0, 1, 2], [0, 2, 3]],
            "normals": [n, n, n, n], "shading": shading,
        })
    };
    let make = |name: &str, shading: &str, transform: Value, by_instance: bool, centre: [f64; 2], normal: Vec3| {
        let mut object = json!({ "shape": mesh(shading), "material": white() });
        let scene = if by_instance {
            view(centre)
                .set("groups", "sheet", json!({ "objects": [object] }))
                .whole("instances", json!([{ "group": "sheet", "transforms": [transform] }]))
        } else {
            object["transform"] = transform;
            view(centre).thing(object)
        };
        Truth::new(name, &scene, shown(normal), "ρ n·l, n by the transposed inverse of the placement")
            .because(BECAUSE)
            .confirmed("the plane that the normal is of, placed by two of its directions", 1e-12, move || {
                // Two directions across the normal, and the normal across both.
                let (s, t) = crate::vector::frame(normalize(normal));
                ALBEDO * dot(normalize(crate::vector::cross(s, t)), normalize(TO_LIGHT))
            })
            .sees(1e-3)
    };
    let stretch = json!([{ "scale": [2, 1, 1] }]);
    let mirror = json!([{ "scale": [-2, 1, 0.5] }]);
    // World = matrix · local: a shear of x by z, which leaves the plane in place. The transposed inverse takes n_z to n_z − 0.5 n_x.
    let shear = json!([{ "matrix": [[1, 0, 0.5, 0], [0, 1, 0, 0], [0, 0, 1, 0]] }]);
    let plain = |truth: Truth| truth.or_else("normals placed as directions are", shown([0.6, 0.2, 0.9]));
    let turned = |truth: Truth| {
        truth
            .or_else("normals placed as directions are", shown([-0.6, 0.2, 0.45]))
            .or_else("not mirrored", shown([0.15, 0.2, 1.8]))
    };
    vec![
        make("vertex-normals", "auto", json!([]), false, [0.5, 0.5], n)
            .or_else("the normal of the shape", shown([0.0, 0.0, 1.0])),
        make("vertex-normals-left-out", "flat", json!([]), false, [0.5, 0.5], [0.0, 0.0, 1.0]).or_else("met", shown(n)),
        plain(make("vertex-normals-stretched", "smooth", stretch.clone(), false, [1.0, 0.5], [0.15, 0.2, 0.9])),
        plain(make("vertex-normals-of-a-stretched-instance", "smooth", stretch, true, [1.0, 0.5], [0.15, 0.2, 0.9])),
        turned(make("vertex-normals-mirrored", "smooth", mirror.clone(), false, [-1.0, 0.5], [-0.15, 0.2, 1.8])),
        turned(make("vertex-normals-of-a-mirrored-instance", "smooth", mirror, true, [-1.0, 0.5], [-0.15, 0.2, 1.8])),
        make("vertex-normals-sheared", "smooth", shear, false, [0.5, 0.5], [0.3, 0.2, 0.75])
            .or_else("normals placed as directions are", shown([0.75, 0.2, 0.9])),
    ]
}

/// A triangle with three normals, all of its view between its corners.
fn interpolated() -> Truth {
    let normals: [Vec3; 3] = [[-0.4, -0.3, 1.0], [0.6, 0.1, 0.8], [0.1, 0.7, 0.9]];
    let unit = normals.map(normalize);
    let mesh = json!({
        "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]], "normals": normals,
    });
    let scene = view([0.3, 0.25]).thing(json!({ "shape": mesh, "material": white() })).spp(1024);
    let at = move |x: f64, y: f64, normals: [Vec3; 3]| {
        let weights = [1.0 - x - y, x, y];
        shown([0, 1, 2].map(|k| (0..3).map(|i| weights[i] * normals[i][k]).sum()))
    };
    let mean = move |steps: u32, normals: [Vec3; 3]| {
        let place = |k: u32, centre: f64| centre - 0.1 + 0.2 * (f64::from(k) + 0.5) / f64::from(steps);
        let sum: f64 =
            (0..steps).flat_map(|i| (0..steps).map(move |j| at(place(i, 0.3), place(j, 0.25), normals))).sum();
        sum / f64::from(steps).powi(2)
    };
    Truth::new("vertex-normals-interpolated", &scene, mean(400, unit), "mean over the picture of ρ n·l, n ∝ Σ wᵢnᵢ")
        .because("The normal is interpolated between those of the corners by the shares of area, and made one long: in parallel light of irradiance π it shows ρ n·l.")
        .confirmed("Gauss's rule over the picture", 1e-6, move || {
            let part = crate::quadrature::rectangle(|x, y| at(x, y, unit), [0.2, 0.4], [0.15, 0.35], 1e-12, 100_000);
            part.value / 0.04
        })
        .or_else("not made one long before", mean(100, normals))
        .or_else("one normal for all", shown([0, 1, 2].map(|k| unit.iter().map(|n| n[k]).sum())))
        .sees(1e-3)
}

/// A ball of radius 1, of which an instance is twice as long along x.
fn stretched_ball() -> Truth {
    let centre = [1.0, 0.3];
    let ball = json!({ "shape": sphere([0.0; 3], 1.0), "material": white() });
    let scene = view(centre)
        .set("groups", "ball", json!({ "objects": [ball] }))
        .whole("instances", json!([{ "group": "ball", "transforms": [[{ "scale": [2, 1, 1] }]] }]));
    let height = |x: f64, y: f64| (1.0 - 0.25 * x * x - y * y).sqrt();
    let mean = move |normal: &dyn Fn(f64, f64) -> Vec3| {
        let [x, y] = centre.map(|at: f64| [at - 0.1, at + 0.1]);
        crate::quadrature::rectangle(|x, y| shown(normal(x, y)), x, y, 1e-12, 100_000).value / 0.04
    };
    let value = mean(&|x, y| [0.25 * x, y, height(x, y)]);
    Truth::new("ball-of-a-stretched-instance", &scene, value, "mean over the picture of ρ n·l, n ∝ (x/4, y, z)")
        .because("The normal of the ellipsoid x²/4 + y² + z² = 1 is its gradient, made one long: in parallel light of irradiance π it shows ρ n·l.")
        .confirmed("the normal across two tangents, by a sum over the picture", 1e-5, move || {
            let steps = 200;
            let place = |k: u32, centre: f64| centre - 0.1 + 0.2 * (f64::from(k) + 0.5) / f64::from(steps);
            let at = |x: f64, y: f64| {
                let z = height(x, y);
                shown(crate::vector::cross([1.0, 0.0, -0.25 * x / z], [0.0, 1.0, -y / z]))
            };
            let sum: f64 = (0..steps)
                .flat_map(|i| (0..steps).map(move |j| (i, j)))
                .map(|(i, j)| at(place(i, centre[0]), place(j, centre[1])))
                .sum();
            sum / f64::from(steps).powi(2)
        })
        .or_else("normals placed as directions are", mean(&|x, y| [x, y, height(x, y)]))
        .sees(1e-3)
}

/// A ball of radius 1 whose heights grow from its south pole −y to its north pole.
fn bumps_of_a_ball() -> Truth {
    const HEIGHT_M: f64 = 2.0;
    let centre = [0.2, 0.5];
    let file = "four-steps-up.hdr";
    // By a quarter from texel to texel, each a quarter of v; so the height over v is a straight line between the middles of the last.
    let rows = [1.0, 0.75, 0.5, 0.25];
    let scene = view(centre)
        .thing(json!({
            "shape": sphere([0.0; 3], 1.0), "material": white(), "bump_map": { "file": file, "height_m": HEIGHT_M, "wrap": "clamp" },
        }))
        .file(file, grey_hdr(1, &rows));
    let of_slope = move |slope: f64| {
        move |x: f64, y: f64| {
            let (z, off_axis) = ((1.0 - x * x - y * y).sqrt(), (1.0 - y * y).sqrt());
            let north = [-y * x / off_axis, off_axis, -y * z / off_axis];
            shown([x - slope * north[0], y - slope * north[1], z - slope * north[2]])
        }
    };
    let mean = move |at: &dyn Fn(f64, f64) -> f64| {
        let [x, y] = centre.map(|at: f64| [at - 0.1, at + 0.1]);
        crate::quadrature::rectangle(at, x, y, 1e-12, 100_000).value / 0.04
    };
    // From pole to pole is π of the way along a meridian.
    let slope = HEIGHT_M / std::f64::consts::PI;
    Truth::new("bump-map-from-pole-to-pole-of-a-ball", &scene, mean(&of_slope(slope)), "mean over the picture of ρ n·l, n ∝ r − h′ e, h′ = H/(π R)")
        .because(
            "v runs from the south pole to the north pole, over half a turn. Heights that grow by H along it have the slope H/(π R) toward \
             the north, e, and the normal r is bent by that; in parallel light of irradiance π it shows ρ n·l.",
        )
        .confirmed("the normal's latitude, by a sum over the picture", 1e-5, move || {
            let steps = 200;
            let place = |k: u32, centre: f64| centre - 0.1 + 0.2 * (f64::from(k) + 0.5) / f64::from(steps);
            // The normal has the place's longitude, and a latitude that is atan h′ nearer to the equator.
            let at = |x: f64, y: f64| {
                let (latitude, longitude) = (y.asin() - slope.atan(), x.atan2((1.0 - x * x - y * y).sqrt()));
                let (sin, cos) = latitude.sin_cos();
                shown([cos * longitude.sin(), sin, cos * longitude.cos()])
            };
            let all = (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j)));
            all.map(|(i, j)| at(place(i, centre[0]), place(j, centre[1]))).sum::<f64>() / f64::from(steps).powi(2)
        })
        .or_else("the normal of the shape", mean(&of_slope(0.0)))
        .or_else("v over a whole turn", mean(&of_slope(0.5 * slope)))
        .or_else("white is deep", mean(&of_slope(-slope)))
        .or_else("v over the length of the axis", mean(&of_slope(0.5 * HEIGHT_M)))
        .sees(1e-3)
}
