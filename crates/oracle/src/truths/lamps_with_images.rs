//! Images and patterns as light: lamps that show them to the eye, and colours of vertices that tint a mirror.

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    scene::{Scene, black, grey_hdr, radiance_hdr},
    textures::{Shown, Wrap, decoded, patches},
    tiles::{mean, row, tile},
};

pub(super) fn truths() -> Vec<Truth> {
    vec![images(), coloured(), patterns(), clouds(), tinted_mirror()]
}

/// What a colour of Rec. 709 shows to a sensor of CIE Y.
fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

const BECAUSE: &str = "A lamp is seen as bright as its image says, and each tile of the picture shows the mean of one lamp over its square.";
const ROUNDED: &str = "the luminances of the primaries are rounded to four digits; wavelengths are drawn";

/// Black squares beside each other that shine by a spectrum each.
fn lamps(radiances: &[Value]) -> Scene {
    let place = |scene: Scene, (at, radiance): (usize, &Value)| {
        scene.thing(json!({ "shape": tile(at, 0.0), "material": black(), "emission": { "radiance": radiance } }))
    };
    radiances.iter().enumerate().fold(row(radiances.len(), 2.0), place)
}

/// The share of 1000 × 1000 places of the unit square where `within` holds.
fn share(within: impl Fn(f64, f64) -> bool) -> f64 {
    let at = |k: u32| (f64::from(k) + 0.5) / 1000.0;
    let all = (0..1000).flat_map(|j| (0..1000).map(move |i| (i, j)));
    all.filter(|&(i, j)| within(at(i), at(j))).count() as f64 / 1e6
}

/// Of the unit square, what lies below 0.6 u + 0.8 v = ½, and below 0.6 u − 0.8 v = ½.
const CORNER: f64 = 0.5 * (0.5 / 0.6) * (0.5 / 0.8);
const OTHER_CORNER: f64 = 1.0 - 0.5 * (1.0 / 6.0) * 0.125;

/// Grey images as lamps: turned, and mirrored beyond their upper edge.
fn images() -> Truth {
    let (dim, bright) = (0.25, 3.0);
    let wrapped = Shown { wrap: [Wrap::Repeat, Wrap::Mirror], ..patches() };
    let mut beyond = wrapped.albedo("patches.hdr");
    (beyond["uv_scale"], beyond["uv_offset"]) = (json!([0.5, 0.75]), json!([0.1, 0.6]));
    let turned = json!({
        "type": "image", "file": "dim-and-bright.hdr", "wrap": "clamp", "filter": "nearest", "uv_matrix": [[0.6, 0.8], [-0.8, 0.6]],
    });
    let scene = lamps(&[turned, beyond])
        .file("dim-and-bright.hdr", grey_hdr(2, &[dim, bright]))
        .file("patches.hdr", wrapped.hdr())
        .spp(1024);
    let of_two = move |left: f64| left * dim + (1.0 - left) * bright;
    let (u, v) = ([0.1, 0.6], [0.6, 1.35]);
    let with = |wrap: [Wrap; 2]| Shown { wrap, ..patches() }.mean(u, v);
    let shown = move |left: f64, beyond: f64| 0.5 * (of_two(left) + beyond);
    let right = wrapped.mean(u, v);
    Truth::new(
        "lamps-by-turned-and-mirrored-images",
        &scene,
        shown(CORNER, right),
        "mean of ¼A + 3(1 − A), A = ½ · 0.5/0.6 · 0.5/0.8, and of an image over u from 0.1 to 0.6, v from 0.6 to 1.35, mirrored at 1",
    )
    .because(BECAUSE)
    .confirmed("counted places, and interpolation at midpoints", 1e-3, move || {
        let places = wrapped.over(1000, |a, b| [u[0] + a * (u[1] - u[0]), v[0] + b * (v[1] - v[0])]);
        shown(share(|u, v| 0.6 * u + 0.8 * v < 0.5), places)
    })
    .allows(1e-4, ROUNDED)
    .or_else("turned the other way", shown(OTHER_CORNER, right))
    .or_else("not turned", shown(0.5, right))
    .or_else("repeated along v", shown(CORNER, with([Wrap::Repeat; 2])))
    .or_else("ended along v", shown(CORNER, with([Wrap::Repeat, Wrap::Clamp])))
    .claims(Claim::PhotometricSensor)
    .sees(3e-3)
}

/// Numbers by the curve of sRGB, and a colour with a factor on each channel.
fn coloured() -> Truth {
    let (grey, colour, factor) = (0.5, [0.25, 0.75, 0.5], [4.0, 0.5, 2.0]);
    let by_curve = json!({ "type": "image", "file": "one-grey.hdr", "encoding": "srgb", "factor": [3, 3, 3] });
    let by_factor = json!({ "type": "image", "file": "colour-of-a-lamp.hdr", "encoding": "linear", "factor": factor });
    let scene = lamps(&[by_curve, by_factor])
        .file("one-grey.hdr", grey_hdr(1, &[grey]))
        .file("colour-of-a-lamp.hdr", radiance_hdr(1, &[colour]))
        .spp(4096);
    let scaled = |factor: [f64; 3]| luminance([0, 1, 2].map(|k| colour[k] * factor[k]));
    let shown = |curved: f64, colour: f64| 0.5 * (curved + colour);
    let right = (3.0 * decoded(grey), scaled(factor));
    Truth::new(
        "lamps-by-a-curve-and-factors",
        &scene,
        shown(right.0, right.1),
        "mean of 3((0.5 + 0.055)/1.055)^2.4 and 0.2126 · 4R + 0.7152 · ½G + 0.0722 · 2B",
    )
    .because(
        "Texels times factors are colours of the white of D65, which has the luminance of the constant spectrum 1.",
    )
    .confirmed("the published value of the curve at ½, and the sum in figures", 1e-6, move || {
        shown(3.0 * 0.214_041_14, 0.2126 + 0.7152 * 0.375 + 0.0722)
    })
    .allows(3e-4, ROUNDED)
    .or_else("the curve left out", shown(3.0 * grey, right.1))
    .or_else("the curve after the factor", shown(decoded(3.0 * grey), right.1))
    .or_else("the factor of the first left out", shown(decoded(grey), right.1))
    .or_else("the factors of the second left out", shown(right.0, scaled([1.0; 3])))
    .or_else("red and blue of the factors exchanged", shown(right.0, scaled([2.0, 0.5, 4.0])))
    .or_else("one factor for all", shown(right.0, scaled([4.0; 3])))
    .claims(Claim::PhotometricSensor)
    .sees(3e-3)
}

/// A board and a ramp that lie turned.
fn patterns() -> Truth {
    let (first, second) = (3.0, 0.5);
    let turn = json!([[0.6, 0.8], [0, 0.25]]);
    let board =
        json!({ "type": "checker", "first": first, "second": second, "uv_matrix": turn, "uv_offset": [0, 0.125] });
    let ramp = json!({
        "type": "gradient", "from": 0.5, "to": 2.5, "along": "v", "uv_matrix": [[-1, 2], [0.25, 0.5]], "uv_offset": [5, 0.1],
    });
    let of_board = move |first_one: f64| first_one * first + (1.0 - first_one) * second;
    let of_ramp = |t: f64| 0.5 + 2.0 * t;
    // The fields change where 0.6 u + 0.8 v is ½ and 1: the first one again in the upper right corner, of 0.4 beyond.
    let fields = CORNER + 0.5 * (0.4 / 0.6) * (0.4 / 0.8);
    let shown = move |fields: f64, t: f64| 0.5 * (of_board(fields) + of_ramp(t));
    let middle = 0.1 + 0.125 + 0.25;
    let counted = |slant: f64| share(move |u, v| (0.6 * u + slant * v).rem_euclid(1.0) < 0.5);
    Truth::new(
        "lamps-by-a-turned-board-and-ramp",
        &lamps(&[board, ramp]).spp(1024),
        shown(fields, middle),
        "mean of 3A + ½(1 − A), A the corners with 0.6 u + 0.8 v below ½ and above 1, and of ½ + 2t, t = 0.1 + ¼/2 + ½/2",
    )
    .because(BECAUSE)
    .confirmed("counted places, and the mean of the ramp's corners", 1e-3, move || {
        let corners = [0.1, 0.35, 0.6, 0.85].map(of_ramp);
        0.5 * (of_board(counted(0.8)) + mean(&corners))
    })
    .or_else("the board turned the other way", shown(counted(-0.8), middle))
    .or_else("the board not turned", shown(share(|u, _| 0.6 * u < 0.5), middle))
    .or_else("rows and columns of the ramp's matrix exchanged", shown(fields, 0.1 + 1.0 - 0.25))
    .or_else("the part of u left out", shown(fields, 0.1 + 0.25))
    .allows(1e-4, ROUNDED)
    .claims(Claim::PhotometricSensor)
    .sees(3e-3)
}

/// The number of a lattice's point by SplitMix64, from 0 to 1.
fn lattice(seed: u64, i: i64, j: i64) -> f64 {
    let h = |state: u64| {
        let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    };
    // One octave, of eight by eight points that repeat.
    let [i, j] = [i, j].map(|k| k.rem_euclid(8) as u64);
    (h(h(h(h(seed)) ^ i) ^ j) >> 11) as f64 / 9_007_199_254_740_992.0
}

/// Noise as light: some cells of it, scaled, and others by a quarter of a turn.
fn clouds() -> Truth {
    let noise = |seed: u64, placed: Value| {
        let mut form = json!({ "type": "noise", "first": 0.2, "second": 4, "seed": seed });
        form.as_object_mut().expect("an object").extend(placed.as_object().expect("an object").clone());
        form
    };
    let scaled = noise(3, json!({ "uv_scale": [0.25, 0.5] }));
    let turned = noise(4, json!({ "uv_matrix": [[0, -0.25], [0.375, 0]] }));
    // The mean of whole cells from a point of the lattice on: points count as often as cells have them.
    let cells = |seed: u64, [i0, j0]: [i64; 2], [wide, high]: [i64; 2]| {
        let of_cell = |i: i64, j: i64| {
            0.25 * [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[a, b]| lattice(seed, i + a, j + b)).iter().sum::<f64>()
        };
        let all = (i0..i0 + wide).flat_map(|i| (j0..j0 + high).map(move |j| of_cell(i, j)));
        all.sum::<f64>() / (wide * high) as f64
    };
    let light = |t: f64| 0.2 + 3.8 * t;
    let shown = move |first: f64, second: f64| 0.5 * (light(first) + light(second));
    let (first, second) = (cells(3, [0, 0], [2, 4]), cells(4, [-2, 0], [2, 3]));
    let bilinear = |seed: u64, x: f64, y: f64| {
        let (i, j) = (x.floor() as i64, y.floor() as i64);
        let (s, t) = (x - x.floor(), y - y.floor());
        let row = |j: i64| (1.0 - s) * lattice(seed, i, j) + s * lattice(seed, i + 1, j);
        (1.0 - t) * row(j) + t * row(j + 1)
    };
    let by_places = move |seed: u64, place: fn(f64, f64) -> [f64; 2]| {
        let at = |k: u32| (f64::from(k) + 0.5) / 240.0;
        let all = (0..240).flat_map(|i| (0..240).map(move |j| place(at(i), at(j))));
        all.map(|[x, y]| bilinear(seed, x, y)).sum::<f64>() / 57_600.0
    };
    Truth::new("lamps-by-scaled-and-turned-noise", &lamps(&[scaled, turned]).spp(1024), shown(first, second), "mean of 0.2 + 3.8 t̄ of cells (0, 0) to (2, 4), and of (−2, 0) to (0, 3) of another noise")
        .because("Over whole cells bilinear noise has the mean of its points, each cell of its four corners. The lattice has eight by eight of them.")
        .confirmed("bilinear at 240 × 240 places of each tile", 1e-6, move || {
            shown(by_places(3, |u, v| [2.0 * u, 4.0 * v]), by_places(4, |u, v| [-2.0 * v, 3.0 * u]))
        })
        .or_else("not scaled", shown(cells(3, [0, 0], [8, 8]), second))
        .or_else("scales exchanged", shown(cells(3, [0, 0], [4, 2]), second))
        .or_else("rows and columns of the matrix exchanged", shown(first, cells(4, [0, -2], [3, 2])))
        .or_else("the sign of the matrix left out", shown(first, cells(4, [0, 0], [2, 3])))
        .allows(1e-4, ROUNDED)
        .claims(Claim::PhotometricSensor)
        .sees(3e-3)
}

/// A mirror tinted by its vertices, times a board, times a factor on each channel, under daylight.
fn tinted_mirror() -> Truth {
    let ([a, b, c, d], factor) = ([0.25, 1.0, 0.5, 0.75], [0.5, 1.0, 0.25]);
    let (first, second) = (0.9, 0.3);
    let colours = [a, b, c, d].map(|v| [v; 3]);
    let shape = json!({
        "type": "mesh", "vertices_m": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "triangles": [[0, 1, 2], [0, 2, 3]],
        "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]], "colours": colours,
    });
    let tint = json!({
        "type": "vertex-colours", "factor": factor, "image": { "type": "checker", "first": first, "second": second },
    });
    let scene = row(1, 2.0)
        .thing(json!({ "shape": shape, "material": { "type": "mirror", "reflectance": tint } }))
        .light(json!({ "type": "environment", "radiance": { "type": "illuminant", "name": "D65" } }))
        .film(16, 16)
        .spp(1024);
    // The four fields: of the two on the diagonal, the means of both halves' corners; of the others, their middles.
    let lower = move |x: f64, y: f64| a * (1.0 - x) + b * (x - y) + c * y;
    let upper = move |x: f64, y: f64| a * (1.0 - y) + d * (y - x) + c * x;
    let diagonal = move |x: f64| {
        let h = x + 0.5;
        let half = |f: &dyn Fn(f64, f64) -> f64, corner: (f64, f64)| (f(x, x) + f(h, h) + f(corner.0, corner.1)) / 3.0;
        0.5 * (half(&lower, (h, x)) + half(&upper, (x, h)))
    };
    let of = move |first: f64, second: f64, factor: f64| {
        factor * 0.25 * (first * (diagonal(0.0) + diagonal(0.5)) + second * (lower(0.75, 0.25) + upper(0.25, 0.75)))
    };
    let y = luminance(factor);
    let whole = (2.0 * a + b + 2.0 * c + d) / 6.0;
    Truth::new(
        "mirror-tinted-by-vertices-a-board-and-factors",
        &scene,
        of(first, second, y),
        "(0.2126 · ½ + 0.7152 + 0.0722 · ¼) times the mean of colours times 0.9 and 0.3 by fields",
    )
    .because("Under a sky of D65 of luminance 1 a mirror shows the luminance of its tint: colours of vertices, interpolated, times image and factors.")
    .confirmed("midpoints of a million squares", 1e-6, move || {
        let at = |k: u32| (f64::from(k) + 0.5) / 1000.0;
        let tint = |x: f64, y: f64| {
            let colour = if x > y { lower(x, y) } else { upper(x, y) };
            colour * if (x < 0.5) == (y < 0.5) { first } else { second }
        };
        y * (0..1000).flat_map(|i| (0..1000).map(move |j| tint(at(i), at(j)))).sum::<f64>() / 1e6
    })
    .allows(2e-4, ROUNDED)
    .or_else("the board left out", y * whole)
    .or_else("fields exchanged", of(second, first, y))
    .or_else("the factors left out", of(first, second, 1.0))
    .or_else("red and blue of the factors exchanged", of(first, second, luminance([0.25, 1.0, 0.5])))
    .or_else("the colours left out", y * 0.6)
    .claims(Claim::PhotometricSensor)
    .sees(3e-3)
}
