//! Colours of vertices.

use serde_json::{Value, json};

use super::values::{LUMINANCE, decoded};
use super::{matte, view};
use crate::truths::scene::{Scene, grey_hdr};
use crate::truths::{Claim, Truth};

const BECAUSE: &str = "Each place of a Lambert plane under a sky of radiance 1 shows its albedo, which is linear over each triangle: its mean \
                       is that of the three corners, and in a square about a place it is that of the place.";

/// Albedos at the corners (0, 0), (1, 0), (1, 1) and (0, 1) of the unit square.
const CORNERS: [f64; 4] = [0.125, 0.75, 0.375, 1.0];

/// The unit square, cut from (0, 0) to (1, 1), with a colour at each corner.
fn square(colours: [[f64; 3]; 4]) -> Value {
    json!({
        "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "triangles": [[0, 1, 2], [0, 2, 3]],
        "colours": colours,
    })
}

fn painted() -> Value {
    matte(json!({ "type": "vertex-colours" }))
}

/// What the lower triangle shows at a place.
fn lower([x, y]: [f64; 2]) -> f64 {
    let [a, b, c, _] = CORNERS;
    a * (1.0 - x) + b * (x - y) + c * y
}

pub(super) fn vertices() -> Vec<Truth> {
    let [a, b, c, d] = CORNERS;
    let grey = square(CORNERS.map(|v| [v; 3]));
    let whole = view([0.5, 0.5], 1.0).thing(json!({ "shape": grey, "material": painted() }));
    // The same by the midpoints of small squares, in each of the triangle that they lie in.
    let by_places = move || {
        let at = |k: u32| (f64::from(k) + 0.5) / 1000.0;
        let upper = |[x, y]: [f64; 2]| a * (1.0 - y) + d * (y - x) + c * x;
        let shown = |place: [f64; 2]| if place[0] > place[1] { lower(place) } else { upper(place) };
        (0..1000).flat_map(|i| (0..1000).map(move |j| shown([at(i), at(j)]))).sum::<f64>() / 1e6
    };
    let place = [0.7, 0.2];
    let part = |name: &str, scene: &Scene| {
        Truth::new(name, scene, lower(place), "0.3 a + 0.5 b + 0.2 c, in the triangle of these corners")
            .because(BECAUSE)
            .or_else("the second and the third corner exchanged", a * 0.3 + b * 0.2 + c * 0.5)
            .or_else("the first corner's colour all over the triangle", a)
            .or_else("not interpolated along the triangles but between all corners", {
                let [x, y] = place;
                a * (1.0 - x) * (1.0 - y) + b * x * (1.0 - y) + c * x * y + d * (1.0 - x) * y
            })
            .sees(0.01)
    };
    let mirror = || json!([{ "scale": [-1, 1, 1] }]);
    let mirrored =
        view([-place[0], place[1]], 0.2).thing(json!({ "shape": grey, "material": painted(), "transform": mirror() }));
    let of_instance = view([-place[0], place[1]], 0.2)
        .set("groups", "sheet", json!({ "objects": [{ "shape": grey, "material": painted() }] }))
        .whole("instances", json!([{ "group": "sheet", "transform": mirror() }]));
    // Bytes have the curve of sRGB.
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n\
               property uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
               0 0 0 64 64 64\n1 0 0 128 128 128\n1 1 0 255 255 255\n0 1 0 0 0 0\n3 0 1 2\n3 0 2 3\n";
    let of_bytes = |curve: fn(f64) -> f64| {
        let [a, b, c, d] = [64.0, 128.0, 255.0, 0.0].map(|byte| curve(byte / 255.0));
        (2.0 * a + b + 2.0 * c + d) / 6.0
    };
    let of_file = view([0.5, 0.5], 1.0)
        .thing(json!({ "shape": { "type": "mesh", "file": "painted.ply" }, "material": painted() }))
        .file("painted.ply", ply.as_bytes().to_vec());
    vec![
        Truth::new("vertex-colours", &whole, (2.0 * a + b + 2.0 * c + d) / 6.0, "(2a + b + 2c + d)/6")
            .because(BECAUSE)
            .confirmed("midpoints of a million squares", 1e-6, by_places)
            .or_else("not interpolated along the triangles but between all corners", (a + b + c + d) / 4.0)
            .or_else("the first corner's colour all over a triangle", a)
            .sees(0.01),
        part(
            "vertex-colours-within-a-triangle",
            &view(place, 0.2).thing(json!({ "shape": grey, "material": painted() })),
        ),
        part("vertex-colours-mirrored", &mirrored),
        part("vertex-colours-of-a-mirrored-instance", &of_instance),
        Truth::new("vertex-colours-of-a-file", &of_file, of_bytes(decoded), "(2a + b + 2c + d)/6, of decoded bytes")
            .because(BECAUSE)
            .or_else("bytes taken in proportion", of_bytes(|x| x))
            .sees(0.01),
        coloured(),
        times_an_image(),
    ]
}

/// Colours times an image of two texels, which show beside each other.
fn times_an_image() -> Truth {
    let file = "two-texels.hdr";
    let image = json!({ "type": "image", "file": file, "filter": "nearest" });
    // Other colours to the left than to the right.
    let [a, b, c, d] = [0.1, 0.9, 0.6, 0.3];
    let mut shape = square([a, b, c, d].map(|v| [v; 3]));
    shape["uvs"] = json!([[0, 0], [1, 0], [1, 1], [0, 1]]);
    let scene = view([0.5, 0.5], 1.0)
        .thing(json!({ "shape": shape, "material": matte(json!({ "type": "vertex-colours", "image": image })) }))
        .file(file, grey_hdr(2, &[0.25, 0.75]));
    // ∫ over the square where x > ½, of what the colours are: 1 − x, x − y and y below the diagonal, 1 − y, y − x and x above it.
    let right = (5.0 * a + 7.0 * b + 11.0 * c + d) / 48.0;
    let whole = (2.0 * a + b + 2.0 * c + d) / 6.0;
    Truth::new("vertex-colours-times-an-image", &scene, 0.25 * (whole - right) + 0.75 * right, "¼ ∫ left + ¾ ∫ right")
        .because(BECAUSE)
        .confirmed("midpoints of a million squares", 1e-5, move || {
            let at = |k: u32| (f64::from(k) + 0.5) / 1000.0;
            let shown = |x: f64, y: f64| {
                let colour =
                    if x > y { a * (1.0 - x) + b * (x - y) + c * y } else { a * (1.0 - y) + d * (y - x) + c * x };
                colour * if x < 0.5 { 0.25 } else { 0.75 }
            };
            (0..1000).flat_map(|i| (0..1000).map(move |j| shown(at(i), at(j)))).sum::<f64>() / 1e6
        })
        .or_else("the image left out", whole)
        .or_else("the colours left out", 0.5)
        .or_else("the means of both multiplied", 0.5 * whole)
        .or_else("left and right exchanged", 0.75 * (whole - right) + 0.25 * right)
        .sees(0.01)
}

/// Colours with factors on their channels.
fn coloured() -> Truth {
    let (colour, factor) = ([0.75, 0.25, 0.5], [0.5, 1.0, 0.25]);
    let light = json!({ "type": "environment", "radiance": { "type": "illuminant", "name": "D65" } });
    let material = matte(json!({ "type": "vertex-colours", "factor": factor }));
    let scene = Scene::orthographic([0.5, 0.5, 2.0], [0.5, 0.5, 0.0], 0.4)
        .light(light)
        .thing(json!({ "shape": square([colour; 4]), "material": material }))
        .film(16, 16)
        .spp(4096);
    let sum = |factor: [f64; 3]| (0..3).map(|k| LUMINANCE[k] * colour[k] * factor[k]).sum::<f64>();
    Truth::new(
        "vertex-colours-times-factors",
        &scene,
        sum(factor),
        "0.2126 R + 0.7152 G + 0.0722 B of colour times factor",
    )
    .because("A colour of Rec. 709 shows its luminance under D65 of luminance 1 to a sensor of CIE Y.")
    .allows(
        2e-4 * sum(factor),
        "the luminances of the primaries are rounded to four digits, and an upsampled colour is met to 1e-4",
    )
    .claims(Claim::PhotometricSensor)
    .or_else("the factors left out", sum([1.0; 3]))
    .or_else("red and blue of the factors exchanged", sum([0.25, 1.0, 0.5]))
    .sees(0.005)
}
