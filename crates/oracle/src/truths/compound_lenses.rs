//! Lenses of many surfaces before a film.
//!
//! A pixel shows the irradiance on the film over π sin²θ₀, θ₀ the half angle of the cone of light on the middle of the film.

mod axial_colour;
mod fields;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    lens_tracer::{Lens, Surface, aperture, spherical},
    prisms::bk7,
    scene::{Scene, black, disk, parallelogram},
};

/// n of N-BK7 at the line d, rounded.
const N: f64 = 1.5168;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = image_scales();
    list.extend(colours());
    list.push(axial_colour::truth());
    list.extend(fields::truths());
    list.extend(losses());
    list.extend(aspheres());
    list
}

/// A surface as a scene states it.
fn surface(surface: &Surface, medium: &Value, is_last: bool, stop: bool) -> Value {
    let mut form = json!({ "semi_aperture_mm": surface.semi_aperture });
    if surface.curvature != 0.0 {
        form["radius_mm"] = json!(1.0 / surface.curvature);
    }
    if surface.conic != 0.0 {
        form["conic"] = json!(surface.conic);
    }
    if !surface.aspheric.is_empty() {
        form["aspheric"] = json!(surface.aspheric);
    }
    if !is_last {
        form["thickness_mm"] = json!(surface.thickness);
    }
    if surface.index != 1.0 {
        form["medium"] = medium.clone();
    }
    if stop {
        form["stop"] = json!(true);
    }
    form
}

/// A lens as a scene states it; its first surface is the stop, and its glass is `medium`.
fn lens_form(lens: &Lens, medium: &Value, coating: &str) -> Value {
    let last = lens.surfaces.len() - 1;
    let surfaces = lens.surfaces.iter().enumerate();
    let surfaces: Vec<Value> = surfaces.map(|(i, s)| surface(s, medium, i == last, i == 0)).collect();
    json!({ "surfaces": surfaces, "coating": coating })
}

/// A camera at the origin that looks along −z.
fn camera(lens: &Value, sensor_m: f64, further: &Value) -> Value {
    let mut camera = json!({
        "type": "compound-lens", "position_m": [0, 0, 0], "direction": [0, 0, -1], "lens": lens, "sensor_height_m": sensor_m,
    });
    for (key, value) in further.as_object().into_iter().flatten() {
        camera[key] = value.clone();
    }
    camera
}

/// A lamp that fills the half-space above a height, mm, at a distance, mm.
fn edge(scene: Scene, distance: f64, height: f64) -> Scene {
    let reach = 0.2 * distance * 1e-3;
    let corner = [-reach, height * 1e-3, -distance * 1e-3];
    scene.lamp(parallelogram(corner, [2.0 * reach, 0.0, 0.0], [0.0, reach, 0.0]), black(), 1.0, "both")
}

/// The share of a film above the image of an edge.
fn lit(height_on_film: f64, sensor: f64) -> f64 {
    (0.5 - height_on_film.abs() / sensor).clamp(0.0, 1.0)
}

/// A biconvex lens of ±50 mm, 5 mm thick.
fn biconvex(index: f64, film: f64, semi_aperture: f64) -> Lens {
    let surfaces = vec![spherical(50.0, 5.0, index, semi_aperture), spherical(-50.0, 0.0, 1.0, 10.0)];
    Lens { surfaces, film }
}

const IMAGE: &str = "Rays through the middle of the stop show the edge of a lamp at the height y′ = (B + dD)·(Y/s) on the film: (B, D) are elements of the \
     axial matrix of the lens, d is the distance to the film. The share of the film beyond the edge is lit. The stop is so small, and the field \
     so narrow, that aberrations and cos⁴ stay below the tolerance.";
/// cos⁴ of the largest angle of the fields below, 0.006, is 1 − 7e-5; the stop's radius over its distance squared is 1e-5.
const PARAXIAL: &str = "cos⁴ over the field 7e-5, aberrations 2e-5 of the film, single precision 2e-5 relative";
const SENSOR: f64 = 0.5;

/// A truth of the image of an edge that ends 5 % below the rim of the film, so that a small change of scale shows.
fn image_of_edge(name: &str, scene: impl Fn(f64) -> Scene, lens: &Lens, distance: f64, formula: String) -> Truth {
    let per_height = lens.height_on_film(distance, 1.0);
    // The height whose image is where it should be, in round numbers.
    let height = (0.45 * SENSOR / per_height.abs() * 1e3).round() * 1e-3;
    let on_film = lens.height_on_film(distance, height);
    let own = lens.clone();
    Truth::new(name, &edge(scene(height), distance, height), lit(on_film, SENSOR), formula)
        .because(IMAGE)
        .confirmed("rays traced through the surfaces, found by bisection", 2e-3, move || {
            lit(own.traced_height_on_film(distance, height, on_film), SENSOR)
        })
        .allows(9e-5, PARAXIAL)
        .sees(0.01)
}

fn image_scales() -> Vec<Truth> {
    let constant = json!(N);
    let distance = 1e6;
    let far = biconvex(N, 0.0, 0.15);
    let far = Lens { film: far.image(distance), ..far };
    let near_mm = 300.0;
    let near = Lens { film: far.image(near_mm), ..far.clone() };
    let form = lens_form(&far, &constant, "ideal");
    let of = |lens: &Lens, distance: f64, y: f64| lit(lens.height_on_film(distance, y), SENSOR);
    let thick = image_of_edge(
        "compound-lens-image-scale",
        |_| Scene::camera(camera(&form, SENSOR * 1e-3, &json!({ "focus_distance_m": distance * 1e-3 }))).film(16, 16),
        &far,
        distance,
        format!("1/2 − y′/h, f = 49.213 mm, the film {:.5} mm behind the last vertex", far.film),
    );
    let height = (0.45 * SENSOR / far.height_on_film(distance, 1.0).abs() * 1e3).round() * 1e-3;
    let thin = lit(50.0 / (2.0 * (N - 1.0)) * height / distance, SENSOR);
    let thick = thick.or_else("the focal length of a thin lens, 48.375 mm", thin).or_else(
        "the film at the focal length behind the last vertex",
        of(&Lens { film: 49.213, ..far.clone() }, distance, height),
    );
    let file = "biconvex.lens.json";
    let from_file = image_of_edge(
        "compound-lens-from-a-file",
        |_| {
            let mut camera =
                camera(&json!(null), SENSOR * 1e-3, &json!({ "focus_distance_m": distance * 1e-3, "lens_file": file }));
            camera.as_object_mut().expect("an object").remove("lens");
            Scene::camera(camera).film(16, 16).file(file, form.to_string().into_bytes())
        },
        &far,
        distance,
        "as with the lens in the scene".into(),
    )
    .or_else("the focal length of a thin lens, 48.375 mm", thin);
    let near_truth = image_of_edge(
        "compound-lens-focused-near",
        |_| Scene::camera(camera(&form, SENSOR * 1e-3, &json!({ "focus_distance_m": near_mm * 1e-3 }))).film(16, 16),
        &near,
        near_mm,
        format!("1/2 − y′/h, the film {:.5} mm behind the last vertex", near.film),
    )
    .or_else("the film not moved", {
        let height = (0.45 * SENSOR / near.height_on_film(near_mm, 1.0).abs() * 1e3).round() * 1e-3;
        lit(far.height_on_film(near_mm, height), SENSOR)
    });
    vec![thick, from_file, near_truth, order(), mirrored(&form)]
}

/// A lamp that fills what is to the right of the axis, in a mirrored picture.
fn mirrored(lens: &Value) -> Truth {
    let (distance, reach) = (1e3, 200.0);
    let further = json!({ "focus_distance_m": distance, "mirrored": true });
    let right = parallelogram([0.0, -reach, -distance], [reach, 0.0, 0.0], [0.0, 2.0 * reach, 0.0]);
    let scene = Scene::camera(camera(lens, SENSOR * 1e-3, &further)).film(8, 8).lamp(right, black(), 1.0, "both");
    Truth::new("mirrored-picture-of-a-compound-lens", &scene, 1.0, "1")
        .because("What is to the right of the lens is to the left in a mirrored picture. Three of its eight columns are read.")
        .or_else("not mirrored", 0.0)
        .reads_pixels([0, 3, 0, 8])
        .allows(9e-5, PARAXIAL)
}

/// A meniscus, which is another lens turned round.
fn order() -> Truth {
    let meniscus = vec![spherical(20.0, 8.0, N, 0.15), spherical(60.0, 0.0, 1.0, 10.0)];
    let meniscus = Lens { surfaces: meniscus, film: 50.0 };
    let distance = 1e6;
    let form = lens_form(&meniscus, &json!(N), "ideal");
    let height = (0.45 * SENSOR / meniscus.height_on_film(distance, 1.0).abs() * 1e3).round() * 1e-3;
    let film = json!({ "film_distance_m": meniscus.film * 1e-3, "up": [0, 1, 0] });
    image_of_edge(
        "compound-lens-in-order",
        |_| Scene::camera(camera(&form, SENSOR * 1e-3, &film)).film(16, 16),
        &meniscus,
        distance,
        "1/2 − y′/h, the film 50 mm behind the last vertex".into(),
    )
    .or_else("surfaces from the film to the scene", lit(meniscus.reversed().height_on_film(distance, height), SENSOR))
}

/// A lens of N-BK7 behind a remote stop, by lines.
fn colours() -> Vec<Truth> {
    let distance = 1e6;
    let lens = |index: f64| {
        let mut surfaces = vec![aperture(0.1, 40.0)];
        surfaces.extend(biconvex(index, 0.0, 10.0).surfaces);
        Lens { surfaces, film: 40.0 }
    };
    let form = lens_form(&lens(2.0), &json!("N-BK7"), "ideal");
    [("compound-lens-of-bk7-at-440-nm", 440.0, 650.0), ("compound-lens-of-bk7-at-650-nm", 650.0, 440.0)]
        .into_iter()
        .map(|(name, nm, other_nm)| {
            let own = lens(bk7(nm));
            let height = (0.45 * SENSOR / own.height_on_film(distance, 1.0).abs() * 1e3).round() * 1e-3;
            let at = |index: f64| lit(lens(index).height_on_film(distance, height), SENSOR);
            let further = json!({ "film_distance_m": 0.04 });
            let scene = |_| {
                let band = [nm - 5e-4, nm + 5e-4];
                Scene::camera(camera(&form, SENSOR * 1e-3, &further)).film(16, 16).band(band)
            };
            image_of_edge(name, scene, &own, distance, format!("1/2 − y′/h, n = {:.5}", bk7(nm)))
                .or_else("the index at the other end of the spectrum", at(bk7(other_nm)))
                .or_else("the index at the line d", at(N))
                .claims(Claim::Dispersion)
        })
        .collect()
}

/// A stop and a plane plate on the axis.
fn losses() -> Vec<Truth> {
    let index: f64 = 1.5;
    let plate = vec![aperture(0.2, 1.0), spherical(0.0, 3.0, index, 5.0), spherical(0.0, 0.0, 1.0, 5.0)];
    let plate = Lens { surfaces: plate, film: 40.0 };
    let r = ((index - 1.0) / (index + 1.0)).powi(2);
    let film = json!({ "film_distance_m": 0.04 });
    let make = |name: &str, coating: &str, value: f64, formula: &str| {
        let scene = Scene::camera(camera(&lens_form(&plate, &json!(index), coating), 1e-5, &film))
            .sky(1.0)
            .film(16, 16)
            .spp(1024);
        let own = plate.clone();
        let bare = coating == "none";
        Truth::new(name, &scene, value, formula)
            .because("A field of radiance 1 shows 1 on the axis, less what the two faces of a plate reflect at normal incidence, each R = ((n − 1)/(n + 1))².")
            .confirmed("a ray along the axis", 1e-9, move || {
                own.trace([0.0; 2], [0.0; 2]).map_or(0.0, |(_, _, share)| if bare { share } else { 1.0 })
            })
            .allows(1e-6, "Fresnel's equations within 0.3° of normal incidence 1e-8, cos⁴ 1e-7; single precision 2e-5 relative")
            .sees(0.01)
    };
    vec![
        make("compound-lens-bare-plate", "none", (1.0 - r) * (1.0 - r), "(1 − R)² = 0.96²")
            .or_else("no reflection", 1.0)
            .or_else("one face", 1.0 - r),
        make("compound-lens-coated-plate", "ideal", 1.0, "1").or_else("bare glass", (1.0 - r) * (1.0 - r)),
    ]
}

/// A plane and a hyperboloid focus parallel light in a point, whatever their aperture.
fn aspheres() -> Vec<Truth> {
    let radius = 30.0;
    let film = radius / (N - 1.0);
    let semi_aperture = 12.0;
    let lens = |conic: f64, aspheric: Vec<f64>| {
        let rear = Surface { conic, aspheric, ..spherical(-radius, 0.0, 1.0, 14.0) };
        Lens { surfaces: vec![spherical(0.0, 8.0, N, semi_aperture), rear], film }
    };
    // A far disk whose image is a quarter of a millimetre wide; the pixel is a tenth of that.
    let (distance, sensor) = (1e5, 0.01);
    let disk_radius = 0.125 / film * distance * 1e-3;
    let share = move |lens: &Lens| lens.share_from_disk(1.1 * semi_aperture, distance, disk_radius * 1e3);
    let conic = -N * N;
    // Powers of ρ of the hyperboloid that the sphere of the same curvature lacks.
    let (k, c) = (1.0 + conic, -1.0 / radius);
    let powers = vec![
        (k - 1.0) * c.powi(3) / 8.0,
        (k * k - 1.0) * c.powi(5) / 16.0,
        5.0 * (k.powi(3) - 1.0) * c.powi(7) / 128.0,
        7.0 * (k.powi(4) - 1.0) * c.powi(9) / 256.0,
        21.0 * (k.powi(5) - 1.0) * c.powi(11) / 1024.0,
    ];
    let sphere = share(&lens(0.0, Vec::new()));
    let make = |name: &str, own: Lens, formula: &str| {
        let form = lens_form(&own, &json!(N), "ideal");
        let scene = Scene::camera(camera(&form, sensor * 1e-3, &json!({ "film_distance_m": film * 1e-3 })))
            .lamp(disk([0.0, 0.0, -distance * 1e-3], [0.0, 0.0, 1.0], disk_radius), black(), 1.0, "both")
            .film(16, 16)
            .spp(1024);
        Truth::new(name, &scene, 1.0, formula)
            .because(
                "A hyperboloid of eccentricity n behind a plane sends all rays along the axis to one point, at R/(n − 1). The middle of the film \
                 sees a small distant disk through all of the lens, as bright as a uniform field.",
            )
            .confirmed("rays traced in the meridian", 1e-9, move || share(&own))
            .or_else("a sphere", sphere)
            .sees(0.01)
    };
    vec![
        make("compound-lens-hyperboloid", lens(conic, Vec::new()), "1: κ = −n²"),
        make("compound-lens-aspheric-coefficients", lens(0.0, powers), "1: the series of the hyperboloid up to ρ¹²"),
    ]
}
