//! The 16 published pictures, and what it takes to get them wrong.

use std::io::Write;
use std::num::NonZero;
use std::path::PathBuf;

use etalon_whitted::{Arithmetic, Figure, Film, Published, Scene, Settings, Vec3, render, render_with};
use sha2::{Digest, Sha256};

fn settings(figure: &Figure) -> Settings {
    Settings { shadow_epsilon: figure.shadow_epsilon, ..Settings::default() }
}

fn film_with<A: Arithmetic>(figure: &Figure) -> Film {
    render_with::<A>(&figure.scene(), &settings(figure), |_| ())
}

fn workspace() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn decode(path: &std::path::Path) -> Vec<u8> {
    let image = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).to_rgb8();
    assert_eq!(image.dimensions(), (640, 480), "{}", path.display());
    image.into_raw()
}

fn sha256(rgb: &[u8]) -> String {
    Sha256::digest(rgb).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn committed_hash(name: &str) -> &'static str {
    let list = include_str!("../../../reference/assignment/sha256.txt");
    let line = list.lines().find(|line| line.ends_with(&format!("  {name}.png")));
    line.and_then(|line| line.split_once(' ')).unwrap_or_else(|| panic!("no hash of {name}")).0
}

fn differing_pixels(a: &[u8], b: &[u8]) -> usize {
    assert_eq!(a.len(), b.len());
    a.chunks(3).zip(b.chunks(3)).filter(|(a, b)| a != b).count()
}

#[test]
fn all_16_images_equal_the_published_ones_in_every_pixel() {
    let published = workspace().join("../shared/assignment/figures");
    if !published.is_dir() {
        // Not eprintln!, which is swallowed when a test passes.
        let note =
            "\nnote: the published figures are not at hand in ../shared/assignment/figures: compared by hash only\n";
        std::io::stderr().write_all(note.as_bytes()).unwrap();
    }
    for figure in &Figure::ALL {
        let film = film_with::<Published>(figure);
        assert_eq!(film.non_finite(), 0, "{}", figure.name);
        let rgb = film.to_rgb8();
        assert_eq!(rgb.len(), 307_200 * 3);
        if published.is_dir() {
            let theirs = decode(&published.join(figure.name).with_extension("png"));
            assert_eq!(differing_pixels(&rgb, &theirs), 0, "{}", figure.name);
        }
        assert_eq!(sha256(&rgb), committed_hash(figure.name), "{}", figure.name);
    }
}

#[test]
fn our_own_renders_in_the_repository_have_the_hashes_beside_them() {
    for figure in &Figure::ALL {
        let path = workspace().join("reference/assignment").join(figure.name).with_extension("png");
        assert_eq!(sha256(&decode(&path)), committed_hash(figure.name), "{}", figure.name);
    }
}

/// Sums the dot product from the right.
struct DotFromTheRight;
impl Arithmetic for DotFromTheRight {
    fn dot(a: Vec3, b: Vec3) -> f64 {
        a.0[0] * b.0[0] + (a.0[1] * b.0[1] + a.0[2] * b.0[2])
    }
}

/// Sums the dot product from its two ends.
struct DotFromTheEnds;
impl Arithmetic for DotFromTheEnds {
    fn dot(a: Vec3, b: Vec3) -> f64 {
        (a.0[0] * b.0[0] + a.0[2] * b.0[2]) + a.0[1] * b.0[1]
    }
}

/// Fuses each multiplication of the dot product with the addition that follows.
struct FusedDot;
impl Arithmetic for FusedDot {
    fn dot(a: Vec3, b: Vec3) -> f64 {
        a.0[2].mul_add(b.0[2], a.0[1].mul_add(b.0[1], a.0[0] * b.0[0]))
    }
}

/// Normalises by a multiplication with the reciprocal of the length.
struct ReciprocalNormalize;
impl Arithmetic for ReciprocalNormalize {
    fn normalize(v: Vec3) -> Vec3 {
        let z = Self::dot(v, v);
        if z > 0.0 { (1.0 / z.sqrt()) * v } else { v }
    }
}

#[test]
fn the_acne_of_figure_1_tells_any_other_rounding_from_the_published_one() {
    let [acne, clean, ..] = &Figure::ALL;
    let published = film_with::<Published>(acne).to_rgb8();
    let changed = |film: Film| differing_pixels(&film.to_rgb8(), &published);
    assert_eq!(changed(film_with::<DotFromTheRight>(acne)), 19_471);
    assert_eq!(changed(film_with::<DotFromTheEnds>(acne)), 20_959);
    assert_eq!(changed(film_with::<FusedDot>(acne)), 855);
    // A normal's last bit turns no shadow ray: what it moves stays below 8 bits.
    assert_eq!(changed(film_with::<ReciprocalNormalize>(acne)), 0);
    // And without acne, nothing of it shows.
    let published = film_with::<Published>(clean).to_rgb8();
    assert_eq!(differing_pixels(&film_with::<DotFromTheRight>(clean).to_rgb8(), &published), 0);
}

#[test]
fn five_fifths_are_not_the_whole() {
    let figure = &Figure::ALL[1];
    let five = film_with::<Published>(figure).to_rgb8();
    let one = Settings { rays: NonZero::<u32>::MIN, ..settings(figure) };
    let one = render(&figure.scene(), &one).to_rgb8();
    assert_eq!((&five[..3], &one[..3]), (&[77, 77, 229][..], &[77, 77, 230][..]));
    // All of the background, and nothing else.
    assert_eq!(differing_pixels(&five, &one), 233_438);
    assert_eq!(five.chunks(3).filter(|rgb| *rgb == [77, 77, 229]).count(), 233_438);
}

/// The platform's `pow` and `tan`.
struct PlatformLibm;
impl Arithmetic for PlatformLibm {
    fn pow(x: f64, y: f64) -> f64 {
        x.powf(y)
    }
    fn tan(angle_rad: f64) -> f64 {
        angle_rad.tan()
    }
}

/// No highlights: what does not change by this never asked `pow`.
struct NoPow;
impl Arithmetic for NoPow {
    fn pow(_: f64, _: f64) -> f64 {
        0.0
    }
}

/// Both `pow`s are within 1 ulp of the exact value (glibc states that, libm's source 0.70 ulp), so a wider gap means that one is broken.
#[test]
fn our_pow_is_within_two_units_in_the_last_place_of_the_platforms() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..200_000 {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let x = (state >> 11) as f64 / (1_u64 << 53) as f64;
        for y in [256.0, 5.0] {
            let (ours, theirs) = (Published::pow(x, y), x.powf(y));
            assert!(ours.to_bits().abs_diff(theirs.to_bits()) <= 2, "{x}^{y}: {ours:e} {theirs:e}");
        }
    }
    let half_view = Scene::seven_spheres().camera.field_of_view_rad / 2.0;
    assert_eq!(Published::tan(half_view), half_view.tan(), "the one tangent that the figures need");
}

#[test]
fn no_pixel_is_so_near_a_rounding_edge_that_pow_could_push_it_over() {
    for figure in &Figure::ALL[..4] {
        let film = film_with::<Published>(figure);
        let without = film_with::<NoPow>(figure);
        let edge_distance = film.pixels.iter().zip(&without.pixels).filter(|(with, without)| with != without);
        let edge_distance = edge_distance
            .flat_map(|(with, _)| with.0)
            .map(|c| ((c.clamp(0.0, 1.0) * 255.0).fract() - 0.5).abs())
            .fold(f64::INFINITY, f64::min);
        // One ulp of pow moves a pixel by less than 255 × 2⁻⁵² ≈ 6e-14 steps: a hundred million ulps would pass unseen.
        assert!((5e-6..1e-3).contains(&edge_distance), "{}: {edge_distance:e}", figure.name);
        let platform = film_with::<PlatformLibm>(figure).to_rgb8();
        assert_eq!(differing_pixels(&film.to_rgb8(), &platform), 0, "{}", figure.name);
    }
}
