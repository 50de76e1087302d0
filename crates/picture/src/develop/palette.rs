//! The colours of false colour.

use std::f64::consts::PI;
use std::sync::LazyLock;

use etalon_optics::colour::{REC709_WHITE_XY, rec709_from_xyz, xyz_from_lab, xyz_of_chromaticity};

use crate::encode_srgb;

/// Where the path of the palette begins and ends in lightness L*.
const LIGHTNESS: [f64; 2] = [10.0, 92.0];
/// And in hue, °: from blue-violet over red and orange to yellow.
const HUE_DEG: [f64; 2] = [285.0, 460.0];
/// Chroma at the dark end, and what is added toward the bright one.
const CHROMA: [f64; 2] = [20.0, 28.0];
/// Pieces of the path by which its length is measured.
const PIECES: usize = 4096;

static PALETTE: LazyLock<[[u8; 3]; 256]> = LazyLock::new(make);

/// The colour of a place from 0 to 1 in the palette, as sRGB levels; places beyond are those of the ends.
///
/// The palette is a path through CIELAB, computed here. Its lightness L* rises from 10 to 92. Its hue turns from 285° (blue-violet) over red and
/// orange to 100° (yellow). Its chroma is 20 + 28·sin(πu/2) where u goes from 0 to 1 with the lightness. 256 colours are taken at equal distances
/// ΔE*ab = √(ΔL*² + Δa*² + Δb*²) (CIE 15:2018, §8.2.1) along it, so that equal steps of a value look equally large. All
/// of them are within sRGB, and lightness alone tells them apart on a grey printer.
///
/// ```
/// use etalon_picture::develop::palette;
///
/// assert_eq!(palette(-1.0), palette(0.0));
/// let grey = |[r, g, b]: [u8; 3]| u32::from(r) + u32::from(g) + u32::from(b);
/// assert!(grey(palette(0.9)) > grey(palette(0.1)));
/// ```
#[must_use]
pub fn palette(place: f64) -> [u8; 3] {
    PALETTE[(255.0 * place.clamp(0.0, 1.0)).round() as usize]
}

/// CIELAB at a place from 0 to 1 of the path.
fn lab(u: f64) -> [f64; 3] {
    let hue = (HUE_DEG[0] + u * (HUE_DEG[1] - HUE_DEG[0])) * PI / 180.0;
    let chroma = CHROMA[0] + CHROMA[1] * (0.5 * PI * u).sin();
    [LIGHTNESS[0] + u * (LIGHTNESS[1] - LIGHTNESS[0]), chroma * hue.cos(), chroma * hue.sin()]
}

fn linear_rgb(lab: [f64; 3]) -> [f64; 3] {
    rec709_from_xyz(xyz_from_lab(lab, xyz_of_chromaticity(REC709_WHITE_XY)))
}

/// The 256 places at equal distances along the path.
fn places() -> [f64; 256] {
    let point = |i: usize| lab(i as f64 / PIECES as f64);
    let mut lengths = vec![0.0];
    for i in 1..=PIECES {
        let (a, b) = (point(i - 1), point(i));
        let piece = (0..3).map(|c| (b[c] - a[c]).powi(2)).sum::<f64>().sqrt();
        lengths.push(lengths[i - 1] + piece);
    }
    std::array::from_fn(|step| {
        let wanted = lengths[PIECES] * step as f64 / 255.0;
        let i = lengths.partition_point(|length| *length < wanted).clamp(1, PIECES);
        let part = (wanted - lengths[i - 1]) / (lengths[i] - lengths[i - 1]);
        (i as f64 - 1.0 + part) / PIECES as f64
    })
}

fn make() -> [[u8; 3]; 256] {
    places().map(|u| linear_rgb(lab(u)).map(|v| (255.0 * encode_srgb(v)).round() as u8))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decode_srgb;
    use etalon_optics::colour::{lab_from_xyz, rec709_to_xyz};

    #[test]
    fn the_whole_path_is_within_srgb() {
        for u in places() {
            let rgb = linear_rgb(lab(u));
            assert!(rgb.iter().all(|v| (0.0..=1.0).contains(v)), "{u}: {rgb:?}");
        }
    }

    #[test]
    fn steps_look_equally_large_and_lightness_rises() {
        let seen: Vec<[f64; 3]> = (0..256)
            .map(|i| {
                let linear = palette(f64::from(i) / 255.0).map(|level| decode_srgb(f64::from(level) / 255.0));
                lab_from_xyz(rec709_to_xyz(linear), xyz_of_chromaticity(REC709_WHITE_XY))
            })
            .collect();
        // Over 15 steps, because levels are rounded.
        let steps: Vec<f64> = (0..17)
            .map(|k| {
                let (a, b) = (seen[15 * k], seen[15 * k + 15]);
                (0..3).map(|c| (b[c] - a[c]).powi(2)).sum::<f64>().sqrt()
            })
            .collect();
        let [least, most] = steps.iter().fold([f64::INFINITY, 0.0], |[l, m], s| [f64::min(l, *s), f64::max(m, *s)]);
        assert!(most / least < 1.1, "{steps:?}");
        for k in 1..=17 {
            assert!(seen[15 * k][0] > seen[15 * k - 15][0] + 2.0, "{k}");
        }
    }
}
