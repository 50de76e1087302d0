//! Where two dimensions of a path meet before it has met anything: film and lens, lens and time, time and film, and the wavelength with
//! each. Each dimension may be drawn as it should be, and the picture be wrong because two of them share a number.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth, photometric_weight,
    scene::{Scene, black, parallelogram},
};
use crate::quadrature::{interval, rectangle};

/// A lens and the plane before its focus that its rays cross: they cross it evenly in a disk about where the pinhole's ray does.
const LENS_M: f64 = 0.2;
const FOCUS_M: f64 = 1.0;
const DEPTH_M: f64 = 0.2;
/// Radius of that disk, m: a(1 − z/z_f).
const DISK_M: f64 = LENS_M * (1.0 - DEPTH_M / FOCUS_M);
/// Half the side of the pixel there, or of the way of what moves, m.
const HALF_M: f64 = 0.2;
/// Half the width of the lamp, m.
const LAMP_M: f64 = 0.12;
/// Steps along each of two numbers in sums over a grid.
const STEPS: u32 = 600;

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![lens_and_film(), lens_and_time(0), lens_and_time(1), time_and_film()];
    list.extend(wavelength());
    list
}

/// The share of places y, even from −`HALF_M` to `HALF_M`, with |x + y| below `LAMP_M`.
fn covered(x: f64) -> f64 {
    let (from, to) = ((-LAMP_M - x).max(-HALF_M), (LAMP_M - x).min(HALF_M));
    (to - from).max(0.0) / (2.0 * HALF_M)
}

/// A point of the unit disk from two numbers, by concentric squares (Shirley & Chiu 1997).
fn on_disk(u: f64, v: f64) -> [f64; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (r, angle) = if a.abs() > b.abs() { (a, 0.25 * PI * b / a) } else { (b, 0.5 * PI - 0.25 * PI * a / b) };
    [r * angle.cos(), r * angle.sin()]
}

/// The mean over two numbers, even in [0, 1], by the middles of a grid.
fn mean(f: impl Fn(f64, f64) -> f64) -> f64 {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
    let sum: f64 = (0..STEPS).map(|i| (0..STEPS).map(|j| f(at(i), at(j))).sum::<f64>()).sum();
    sum / f64::from(STEPS * STEPS)
}

fn lit(inside: bool) -> f64 {
    f64::from(u8::from(inside))
}

/// A pixel whose footprint is larger than the aperture.
fn lens_and_film() -> Truth {
    // Square pixels of half side z·tan 45° = 0.2 m.
    let scene = Scene::lens([0.0; 3], [0.0, 0.0, -1.0], 90.0, LENS_M, FOCUS_M).film(1, 1).spp(1 << 16).lamp(
        parallelogram([-LAMP_M, -LAMP_M, -DEPTH_M], [2.0 * LAMP_M, 0.0, 0.0], [0.0, 2.0 * LAMP_M, 0.0]),
        black(),
        1.0,
        "front",
    );
    let in_polar = |r: f64, angle: f64| r * covered(DISK_M * r * angle.cos()) * covered(DISK_M * r * angle.sin());
    let value = rectangle(in_polar, [0.0, 1.0], [0.0, 2.0 * PI], 1e-9, 400_000).value / PI;
    // The film's y of a row that counts downward or upward.
    let shared = |up: f64| {
        mean(|u, v| {
            let [x, y] = on_disk(u, v).map(|p| DISK_M * p);
            let [film_x, film_y] = [u, v].map(|u| HALF_M * (2.0 * u - 1.0));
            lit((x + film_x).abs() < LAMP_M && (y + up * film_y).abs() < LAMP_M)
        })
    };
    let one_shared = mean(|u, v| {
        let [x, y] = on_disk(u, v).map(|p| DISK_M * p);
        lit((x + HALF_M * (2.0 * u - 1.0)).abs() < LAMP_M) * covered(y)
    });
    Truth::new("lens-wider-than-its-picture", &scene, value, "(1/πR²)∬ c(x) c(y) over the disk, c(x) = |{y: |x + y| < s, |y| < h}|/2h")
        .because(
            "Rays of a pixel of half side h cross a plane before the focus at the sum of a place on the pixel and a place on a disk of \
             radius R = a(1 − z/z_f), which are independent. The lamp is a square of half side s. For each point of the disk the share of the \
             pixel that sees it is a product over both axes.",
        )
        .confirmed("sum over a grid of lens points", 1e-4, || {
            mean(|u, v| on_disk(u, v).map(|p| covered(DISK_M * p)).iter().product::<f64>())
        })
        .or_else("the numbers of the film place the ray on the lens, rows upward", shared(1.0))
        .or_else("the numbers of the film place the ray on the lens, rows downward", shared(-1.0))
        .or_else("the first number of the film places the ray on the lens", one_shared)
        .or_else("all rays through the middle of the pixel", mean(|u, v| {
            lit(on_disk(u, v).iter().all(|p| (DISK_M * p).abs() < LAMP_M))
        }))
        .or_else("a pinhole", (LAMP_M / HALF_M).powi(2))
        .or_else("the lens sampled as a square", interval(|x| covered(DISK_M * x), 0.0, 1.0, 1e-9).value.powi(2))
        .sees(0.01)
}

/// A bar that passes before an open lens, along one axis.
fn lens_and_time(axis: usize) -> Truth {
    let along = |x: f64| if axis == 0 { [x, 0.0, 0.0] } else { [0.0, x, 0.0] };
    let bar = if axis == 0 {
        parallelogram([-LAMP_M, -1.0, -DEPTH_M], [2.0 * LAMP_M, 0.0, 0.0], [0.0, 2.0, 0.0])
    } else {
        parallelogram([-1.0, -LAMP_M, -DEPTH_M], [2.0, 0.0, 0.0], [0.0, 2.0 * LAMP_M, 0.0])
    };
    let bar = json!({ "shape": bar, "material": black(), "emission": { "radiance": 1, "sides": "both" } });
    let key = |time_s: f64, x: f64| json!({ "time_s": time_s, "transform": [{ "translate_m": along(x) }] });
    let scene = Scene::lens([0.0; 3], [0.0, 0.0, -1.0], 1e-4, LENS_M, FOCUS_M)
        .film(1, 1)
        .spp(1 << 16)
        .shutter([0.0, 1.0])
        .moving(&[bar], &[key(0.0, -HALF_M), key(1.0, HALF_M)]);
    // Over a unit disk x has the density 2√(1 − x²)/π.
    let value = 2.0 / PI * interval(|x| (1.0 - x * x).sqrt() * covered(DISK_M * x), -1.0, 1.0, 1e-9).value;
    let shared = |sign: f64| {
        mean(|u, v| {
            let time = [u, v][axis];
            lit((DISK_M * on_disk(u, v)[axis] - sign * HALF_M * (2.0 * time - 1.0)).abs() < LAMP_M)
        })
    };
    let name = ["bar-passing-a-lens", "bar-passing-a-lens-upward"][axis];
    Truth::new(name, &scene, value, "(2/π)∫ √(1 − x²) c(Rx) dx, c(x) = |{y: |x + y| < s, |y| < h}|/2h")
        .because(
            "A point of the lens looks at a place on a disk of radius R before the focus, a time at a place of the bar's middle, from −h to h at \
             a constant rate. They are independent. The bar of half width s covers the place for the share c of the time.",
        )
        .confirmed("sum over a grid of lens points", 1e-4, move || mean(|u, v| covered(DISK_M * on_disk(u, v)[axis])))
        .or_else("time by the number that places the ray on the lens", shared(1.0))
        .or_else("time by one less that number", shared(-1.0))
        .or_else("in the middle of the time", mean(|u, v| lit((DISK_M * on_disk(u, v)[axis]).abs() < LAMP_M)))
        .or_else("through the middle of the lens", LAMP_M / HALF_M)
        .claims(Claim::Motion)
        .sees(0.01)
}

/// A bar that passes a pixel along its second axis.
fn time_and_film() -> Truth {
    let bar = parallelogram([-1.0, -0.25, 0.0], [2.0, 0.0, 0.0], [0.0, 0.5, 0.0]);
    let bar = json!({ "shape": bar, "material": black(), "emission": { "radiance": 1, "sides": "front" } });
    let key = |time_s: f64, y: f64| json!({ "time_s": time_s, "transform": [{ "translate_m": [0, y, 0] }] });
    let scene = Scene::orthographic([0.0, 0.0, 3.0], [0.0; 3], 1.0)
        .up([0.0, 1.0, 0.0])
        .film(1, 1)
        .spp(1 << 16)
        .shutter([0.0, 1.0])
        .moving(&[bar], &[key(0.0, -2.0), key(1.0, 2.0)]);
    let visible = |c: f64| ((c + 0.25).min(0.5) - (c - 0.25).max(-0.5)).max(0.0);
    Truth::new("bar-passing-a-pixel-upward", &scene, 0.125, "½ m / (4 m/s)")
        .because("A bar half a metre high is before each point of the pixel for 1/8 s as it passes at 4 m/s.")
        .confirmed("quadrature of the covered part over time", 1e-9, move || {
            [[-0.75, -0.25], [-0.25, 0.25], [0.25, 0.75]]
                .map(|[a, b]| interval(visible, a, b, 1e-14).value)
                .iter()
                .sum::<f64>()
                / 4.0
        })
        .or_else("as the shutter opens", 0.0)
        .or_else("in the middle of the time", 0.5)
        // |u − ½ − (4u − 2)| < ¼ is |1.5 − 3u| < ¼, and |½ − u − (4u − 2)| < ¼ is |2.5 − 5u| < ¼.
        .or_else("time by the number that places the sample along y, rows upward", 0.5 / 3.0)
        .or_else("time by the number that places the sample along y, rows downward", 0.1)
        .claims(Claim::Motion)
}

/// Two lamps of ten nanometres' width each: half of all rays meet the one, half the other, by one dimension.
fn wavelength() -> Vec<Truth> {
    const LINES_NM: [u32; 2] = [550, 600];
    let lamp = |corner: [f64; 3], u: [f64; 3], v: [f64; 3], from_nm: u32| -> Value {
        let line = json!({ "type": "tabulated", "wavelengths_nm": [from_nm, from_nm + 10], "values": [1, 1], "outside": "zero" });
        json!({ "shape": parallelogram(corner, u, v), "material": black(), "emission": { "radiance": line, "sides": "both" } })
    };
    let lens = || Scene::lens([0.0; 3], [0.0, 0.0, -1.0], 1e-4, LENS_M, FOCUS_M).film(1, 1).spp(1 << 16);
    let film = || Scene::orthographic([0.0; 3], [0.0, 0.0, -1.0], 1.0).up([0.0, 1.0, 0.0]).film(1, 1).spp(1 << 16);
    // The first lamp from the middle on along one axis, the second up to it.
    let beside = |scene: Scene, axis: usize| {
        let (first, second, along, across) = match axis {
            0 => ([0.0, -10.0, -DEPTH_M], [-20.0, -10.0, -DEPTH_M], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]),
            _ => ([-10.0, 0.0, -DEPTH_M], [-10.0, -20.0, -DEPTH_M], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]),
        };
        scene.thing(lamp(first, along, across, LINES_NM[0])).thing(lamp(second, along, across, LINES_NM[1]))
    };
    // The first in the first half of the time, the second after it: both move by 20 m/s.
    let in_turn = || {
        let lamps = [-10.0, -30.0].map(|x| [x, -10.0, -DEPTH_M]);
        let lamps = [0, 1].map(|i| lamp(lamps[i], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0], LINES_NM[i]));
        let key = |time_s: f64, x: f64| json!({ "time_s": time_s, "transform": [{ "translate_m": [x, 0, 0] }] });
        Scene::orthographic([0.0; 3], [0.0, 0.0, -1.0], 1e-6)
            .film(1, 1)
            .spp(1 << 16)
            .shutter([0.0, 1.0])
            .moving(&lamps, &[key(0.0, 0.0), key(1.0, 20.0)])
    };
    let truth = |name: &str, scene: Scene| {
        let steps = LINES_NM.into_iter().flat_map(|from_nm| (0..10).map(move |nm| f64::from(from_nm + nm)));
        let w = photometric_weight;
        let lines: f64 = steps.clone().map(|nm| 0.5 * (w(nm) + w(nm + 1.0))).sum();
        Truth::new(name, &scene, 0.5 * lines, "½∫ȳdλ over two times ten nanometres /∫ȳdλ over all")
            .because("Half of the rays meet the lamp of one line, half the other, whatever their wavelengths.")
            .confirmed("Simpson's rule over each nanometre of the table", 1e-6, move || {
                0.5 * steps.clone().map(|nm| (w(nm) + 4.0 * w(nm + 0.5) + w(nm + 1.0)) / 6.0).sum::<f64>()
            })
            .or_else("wavelengths of a line only where its lamp is not", 0.0)
            .or_else("wavelengths of a line only where its lamp is", lines)
            .claims(Claim::PhotometricSensor)
            .sees(0.02)
    };
    vec![
        truth("two-lines-beside-each-other-in-a-lens", beside(lens(), 0)),
        truth("two-lines-above-each-other-in-a-lens", beside(lens(), 1)),
        truth("two-lines-beside-each-other-in-a-pixel", beside(film(), 0)),
        truth("two-lines-above-each-other-in-a-pixel", beside(film(), 1)),
        truth("two-lines-one-after-the-other", in_turn()).claims(Claim::Motion).claims(Claim::WholeFormat),
        lines_at_both_ends(
            [-1.25, -38.75]
                .map(|x| [x, -10.0, -DEPTH_M])
                .into_iter()
                .zip(LINES_NM)
                .map(|(corner, from_nm)| (lamp(corner, [20.0, 0.0, 0.0], [0.0, 20.0, 0.0], from_nm), from_nm)),
        ),
    ]
}

/// A lamp of one line that is there for the first sixteenth of the time, and one of another for the last. Paths carry wavelengths that are an eighth
/// of all apart, so shares of time that are no number of eighths show what two halves do not.
fn lines_at_both_ends(lamps: impl Iterator<Item = (Value, u32)>) -> Truth {
    const SHARE: f64 = 1.0 / 16.0;
    let key = |time_s: f64, x: f64| json!({ "time_s": time_s, "transform": [{ "translate_m": [x, 0, 0] }] });
    let (lamps, from_nm): (Vec<Value>, Vec<u32>) = lamps.unzip();
    let scene = Scene::orthographic([0.0; 3], [0.0, 0.0, -1.0], 1e-6)
        .film(1, 1)
        .spp(1 << 16)
        .shutter([0.0, 1.0])
        .moving(&lamps, &[key(0.0, 0.0), key(1.0, 20.0)]);
    let w = photometric_weight;
    let sum = move |from_nm: &u32, of: &dyn Fn(f64) -> f64| (0..10).map(|nm| of(f64::from(from_nm + nm))).sum::<f64>();
    let lines: Vec<f64> = from_nm.iter().map(|line| sum(line, &|nm| 0.5 * (w(nm) + w(nm + 1.0)))).collect();
    let both = lines[0] + lines[1];
    Truth::new("lines-for-a-sixteenth-of-the-time", &scene, SHARE * both, "∫ȳdλ over two times ten nanometres /16 ∫ȳdλ over all")
        .because(
            "An edge of the one lamp, 1.25 m away, passes at 20 m/s after a sixteenth of a second, an edge of the other as long before the end. When \
             they do has nothing to do with wavelengths.",
        )
        .confirmed("Simpson's rule over each nanometre of the table", 1e-6, move || {
            let simpson = |nm: f64| (w(nm) + 4.0 * w(nm + 0.5) + w(nm + 1.0)) / 6.0;
            SHARE * from_nm.iter().map(|line| sum(line, &simpson)).sum::<f64>()
        })
        .or_else("wavelengths of the lines only in between", 0.0)
        .or_else("wavelengths of both lines twice as often", 2.0 * SHARE * both)
        .or_else("those of the first twice as often, of the second never", 2.0 * SHARE * lines[0])
        .or_else("those of the second twice as often, of the first never", 2.0 * SHARE * lines[1])
        .claims(Claim::PhotometricSensor)
        .claims(Claim::Motion)
        .claims(Claim::WholeFormat)
        .sees(0.02)
}
