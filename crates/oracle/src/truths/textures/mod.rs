//! Images over surfaces: their filter, their wrapping, where they lie on shapes of every kind, what their channels mean.
//!
//! An image as the albedo of a convex Lambert body under a sky of radiance 1 is seen as it is: each place shows its own albedo.

mod disks_and_cylinders;
mod patterns;
mod places;
mod shown;
mod turned;
mod values;
mod vertices;

use serde_json::{Value, json};

use super::{
    Truth,
    scene::{Scene, parallelogram},
};
pub(super) use shown::{Shown, Wrap, patches};
pub(super) use values::decoded;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = places::filters();
    list.extend(places::wraps());
    list.extend(places::round());
    list.extend(places::placed());
    list.extend(disks_and_cylinders::truths());
    list.extend(values::channels());
    list.extend(values::numbers());
    list.extend(values::masks());
    list.push(values::emission());
    list.extend(patterns::patterns());
    list.extend(turned::turned());
    list.extend(vertices::vertices());
    list
}

fn matte(reflectance: Value) -> Value {
    json!({ "type": "lambert", "reflectance": reflectance })
}

/// The unit square, its texture coordinates x and y, and a view of the part [x] × [y] of it: square.
fn square() -> Value {
    parallelogram([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
}

/// A view of a square of side `side_m` about a place of the plane z = 0, from above, in a sky of radiance 1.
fn view(centre: [f64; 2], side_m: f64) -> Scene {
    let [x, y] = centre;
    Scene::orthographic([x, y, 2.0], [x, y, 0.0], side_m).sky(1.0).film(16, 16).spp(1024)
}

const BECAUSE: &str = "Each place of a Lambert plane under a sky of radiance 1 shows its albedo. Bilinear interpolation is a sum of tents \
                       over the centres of texels, which lie half a texel from the edges, so the mean over a rectangle of the surface is a \
                       sum of integrals of tents; with the nearest texel it is a sum of areas.";
const HOW: &str = "interpolation at midpoints of the picture";

/// A truth about a picture that shows [u] × [v] of an image evenly.
fn flat(name: &str, scene: &Scene, image: &Shown, u: [f64; 2], v: [f64; 2]) -> Truth {
    let value = image.mean(u, v);
    let (own, tolerance) = (image.clone(), if image.bilinear { 1e-5 } else { 3e-3 });
    let formula = format!("mean of the image over u from {} to {}, v from {} to {}", u[0], u[1], v[0], v[1]);
    Truth::new(name, scene, value, formula)
        .because(BECAUSE)
        .confirmed(HOW, tolerance, move || own.over(1000, |a, b| [u[0] + a * (u[1] - u[0]), v[0] + b * (v[1] - v[0])]))
        .sees(0.01)
}
