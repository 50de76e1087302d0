//! Pinholes and thin lenses.

use std::f64::consts::PI;

use super::{
    Truth,
    scene::{Scene, black, disk, parallelogram},
};

const LENS_M: f64 = 0.0125;
const FOCUS_M: f64 = 2.0;

/// Radius of the circle of confusion in the object space at depth z, m: a·|z − z_f|/z_f.
fn confusion(depth_m: f64) -> f64 {
    LENS_M * (depth_m - FOCUS_M).abs() / FOCUS_M
}

/// A lens of f = 50 mm at f/2, in focus at 2 m, looking along −z in a field so narrow that it is one ray.
fn view() -> Scene {
    Scene::lens([0.0; 3], [0.0, 0.0, -1.0], 1e-4, LENS_M, FOCUS_M)
}

/// Share of a unit disk beyond the distance x of a chord from the centre.
fn segment(x: f64) -> f64 {
    (x.acos() - x * (1.0 - x * x).sqrt()) / PI
}

/// A wide view of eight by eight pixels, and a lamp in the plane of focus that fills the upper right one. Some pixels of it are read.
fn plane_of_focus(name: &str, crop_px: [u32; 4], value: f64) -> Truth {
    let scene = Scene::lens([0.0; 3], [0.0, 0.0, -1.0], 90.0, 0.1, 1.0).film(8, 8).spp(1024).lamp(
        parallelogram([0.75, 0.75, -1.0], [0.25, 0.0, 0.0], [0.0, 0.25, 0.0]),
        black(),
        1.0,
        "front",
    );
    Truth::new(name, &scene, value, if value == 0.125 { "1/8" } else if value == 1.0 { "1" } else { "0" })
        .because(
            "All rays of a pixel meet in the plane of focus within its square there, also far from the axis: a lamp of that square is seen by \
             this pixel alone, whole and sharp.",
        )
        .reads_pixels(crop_px)
}

/// A black screen that ends the view just before the plane from which rays start, and a lamp beyond.
fn near_planes() -> Vec<Truth> {
    let (screen_m, near_m, radiance) = (1.9_f64, 2.0, 3.0);
    let large = |z: f64| parallelogram([-20.0, -20.0, z], [40.0, 0.0, 0.0], [0.0, 40.0, 0.0]);
    // Of a square picture, the disk in which a ray is shorter than 2 m where it meets the screen.
    let tangent = ((near_m / screen_m).powi(2) - 1.0).sqrt() / 30_f64.to_radians().tan();
    let by_length = radiance * PI * tangent * tangent / 4.0;
    let eye = [0.0, 0.0, 0.0];
    let ahead = [0.0, 0.0, -1.0];
    [
        ("near-plane-of-a-pinhole", Scene::pinhole(eye, ahead, 60.0)),
        ("near-plane-of-a-lens", Scene::lens(eye, ahead, 60.0, 0.1, 3.0)),
    ]
    .map(|(name, scene)| {
        let scene = scene.near(near_m).object(large(-screen_m), black()).lamp(large(-5.0), black(), radiance, "front");
        Truth::new(name, &scene, radiance, "3")
            .because("Rays start on a plane across the view, 2 m away: what is nearer is not there, also far from the axis, where rays to it are longer.")
            .or_else("nothing is cut off", 0.0)
            .or_else("what is within 2 m along the ray is cut off", by_length)
    })
    .into()
}

/// Lamps that fill the upper right pixel of eight by eight where the picture is not mirrored: the upper left one of a mirrored picture is read.
fn mirrored() -> impl Iterator<Item = Truth> {
    let (eye, ahead) = ([0.0; 3], [0.0, 0.0, -1.0]);
    let lamp = || parallelogram([0.75, 0.75, -1.0], [0.25, 0.0, 0.0], [0.0, 0.25, 0.0]);
    let because = "What is to the right of the eye is to the left in a mirrored picture. Up stays up.";
    [
        ("mirrored-picture-of-a-pinhole", Scene::pinhole(eye, ahead, 90.0)),
        ("mirrored-picture-of-a-lens", Scene::lens(eye, ahead, 90.0, 0.1, 1.0)),
        ("mirrored-picture-in-parallel-rays", Scene::orthographic(eye, ahead, 2.0)),
    ]
    .map(|(name, scene)| {
        let scene = scene.mirrored().film(8, 8).spp(1024).lamp(lamp(), black(), 1.0, "front");
        Truth::new(name, &scene, 1.0, "1")
            .because(because)
            .or_else("not mirrored, or turned by half a turn", 0.0)
            .reads_pixels([0, 1, 0, 1])
    })
    .into_iter()
}

pub(super) fn truths() -> Vec<Truth> {
    let because = "Rays from a lens point p through the focus point on the axis pass depth z at p(1 − z/z_f): over the lens they fill a circle of \
         radius a|z − z_f|/z_f evenly.";
    let spot = |name: &str, depth: f64, radius: f64| {
        let scene = view().lamp(disk([0.0, 0.0, -depth], [0.0, 0.0, 1.0], radius), black(), 1.0, "front");
        let c = confusion(depth);
        Truth::new(
            name,
            &scene,
            (radius / c).powi(2),
            format!("(s/c)², s = {radius}, c = a|z − z_f|/z_f = {c}, z = {depth}"),
        )
        .because(because)
        .confirmed("counting lens points on a grid", 2e-3, move || {
            let n = 2000;
            let (mut inside, mut hit) = (0_u32, 0_u32);
            for i in 0..n {
                for j in 0..n {
                    let along = |k: i32| (f64::from(k) + 0.5) / f64::from(n) * 2.0 - 1.0;
                    let r = along(i).hypot(along(j));
                    if r < 1.0 {
                        inside += 1;
                        hit += u32::from(r * LENS_M * (1.0 - depth / FOCUS_M).abs() < radius);
                    }
                }
            }
            f64::from(hit) / f64::from(inside)
        })
        .or_else("the lens sampled as a square", 0.25 * PI * (radius / c).powi(2))
        .or_else("polar radius without its root", radius / c)
        .or_else("diameter taken for radius", (2.0 * radius / c).powi(2).min(1.0))
    };
    let c = confusion(5.0);
    let edge =
        view().lamp(parallelogram([0.5 * c, -1.0, -5.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]), black(), 1.0, "front");
    let share = LENS_M * 0.6;
    let stop = view()
        .lamp(disk([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], 1.0), black(), 1.0, "front")
        .object(parallelogram([0.0, -1.0, -1e-3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]), black());
    let sharp = view().lamp(disk([0.0, 0.0, -FOCUS_M], [0.0, 0.0, 1.0], 1e-4), black(), 1.0, "front");
    let closed = Scene::lens([0.0; 3], [0.0, 0.0, -1.0], 1e-4, 0.0, FOCUS_M).lamp(
        disk([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], 1e-4),
        black(),
        1.0,
        "front",
    );
    // A square of side .4 at distance 1 in a picture 1 wide: .16 of it, in the lower left quarter but for the middle.
    let window = Scene::pinhole([0.0; 3], [0.0, 0.0, -1.0], 2.0 * 0.5_f64.atan().to_degrees()).lamp(
        parallelogram([-0.4, -0.4, -1.0], [0.4, 0.0, 0.0], [0.0, 0.4, 0.0]),
        black(),
        1.0,
        "front",
    );
    let wide = Scene::pinhole([0.0; 3], [0.0, 0.0, -1.0], 2.0 * 0.5_f64.atan().to_degrees())
        .film(64, 32)
        .spp(512)
        .lamp(parallelogram([-0.4, -0.4, -1.0], [0.4, 0.0, 0.0], [0.0, 0.4, 0.0]), black(), 1.0, "front");
    let mut list = vec![
        spot("lens-spot-behind-focus", 5.0, 0.01),
        spot("lens-spot-before-focus", 1.25, 0.002),
        Truth::new("lens-share-of-the-aperture", &view().lamp(
            disk([0.0, 0.0, -5.0], [0.0, 0.0, 1.0], share),
            black(),
            1.0,
            "front",
        ), (share / c).powi(2), "(0.6a/c)²: a disk of .6 apertures at 5 m, focus 2 m")
            .because(because)
            .or_else("the lens sampled as a square", 0.25 * PI * (share / c).powi(2))
            .or_else("circle of confusion a|z − z_f|/z", (share / (LENS_M * 0.6)).powi(2))
            .sees(0.03),
        Truth::new("lens-edge", &edge, segment(0.5), "(acos ½ − ½√¾)/π: an edge half a circle of confusion off the axis")
            .because(because)
            .confirmed("quadrature of the chord", 1e-6, || {
                2.0 / PI * crate::quadrature::interval(|x| (1.0 - x * x).sqrt(), 0.5, 1.0, 1e-10).value
            })
            .or_else("the lens sampled as a square", 0.25)
            .or_else("the lens sampled as a Gaussian of the same spread", 0.1587),
        Truth::new("lens-half-covered", &stop, 0.5, "½")
            .because("A knife edge right before the lens, through its middle, hides half of it from everything out of focus or in.")
            .or_else("the ray starts from the lens's centre", 1.0),
        Truth::new("lens-in-focus", &sharp, 1.0, "1")
            .because("All rays of the lens meet in the plane of focus: a spot a hundredth of the lens wide fills the ray's picture.")
            .or_else("focus distance off by 1 %", (1e-4 / (LENS_M * 0.01)).powi(2)),
        plane_of_focus("lens-focus-in-a-corner", [7, 8, 0, 1], 1.0)
            .or_else("a sphere in focus", 0.808)
            .or_else("rows counted from below", 0.0),
        plane_of_focus("lens-focus-beside-a-corner", [6, 7, 0, 1], 0.0).or_else("a sphere in focus", 0.040),
        plane_of_focus("lens-focus-on-an-edge", [0, 8, 0, 1], 0.125).or_else("a sphere in focus", 0.106),
        Truth::new("lens-closed", &closed, 1.0, "1")
            .because("A lens of radius 0 is a pinhole; nothing divides by it.")
            .or_else("0/0", 0.0),
        Truth::new("pinhole-window", &window, 0.16, "0.16, the area of the image")
            .because("At distance 1 the picture is 1 × 1 and the square .4 × .4; central projection keeps its shape.")
            .or_else("field of view doubled", 0.04)
            .or_else("field of view taken for half of it", 0.16 * (0.5 / (2.0 * 0.5_f64.atan()).tan()).powi(2))
            .sees(0.02),
        Truth::new("pinhole-wide-window", &wide, 0.08, "0.16/2: the same in a picture twice as wide")
            .because("The field of view is the vertical one and pixels are square: the picture is 2 × 1 at distance 1.")
            .or_else("field of view taken as horizontal", 0.32)
            .or_else("pixels not square", 0.16)
            .sees(0.02),
    ];
    list.extend(near_planes());
    list.extend(mirrored());
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blur_on_the_sensor_has_its_published_value() {
        // 2a·|z − z_f|/z · f/(z_f − f): the circle of confusion, imaged.
        let on_sensor = 2.0 * confusion(5.0) * FOCUS_M / 5.0 * 0.05 / (FOCUS_M - 0.05);
        assert!((on_sensor - 3.846_153_85e-4).abs() < 1e-12);
    }
}
