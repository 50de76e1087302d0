//! ꟻLIP: how different two pictures look when they are flipped between (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström
//! & Fairchild 2020, *FLIP: A Difference Evaluator for Alternating Images*, PACM CGIT 3(2), article 15), for what a screen
//! shows: linear Rec. 709 from 0 to 1.

use crate::{Picture, PictureError, Sample};
use std::f64::consts::PI;

/// Pixels per degree of the viewer's sight that the published evaluator assumes: a 0.7 m wide screen of 3840 pixels, 0.7 m
/// away (§4.1).
pub const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * PI / 180.0;

/// Exponents and cut-offs of the published evaluator (§4.1.4, §4.2, table 1).
const COLOUR_EXPONENT: f64 = 0.7;
const COLOUR_CUTOFF: f64 = 0.4;
const COLOUR_TARGET: f64 = 0.95;
const FEATURE_EXPONENT: f64 = 0.5;
const FEATURE_WIDTH_DEG: f64 = 0.082;

type Rgb = [f64; 3];

/// The ꟻLIP error of each pixel, from 0 (alike) to 1, row by row. Both pictures are multiplied by `scale` and cut to [0, 1]
/// as a screen would. NaN counts as 0.
///
/// # Errors
/// Different sizes, a picture without R, G and B.
pub fn flip<T: Sample, U: Sample>(
    image: &Picture<T>,
    reference: &Picture<U>,
    scale: f64,
    pixels_per_degree: f64,
) -> Result<Vec<f64>, PictureError> {
    let size = (image.width(), image.height());
    let reference_size = (reference.width(), reference.height());
    if size != reference_size {
        return Err(PictureError::SizeMismatch { image: size, reference: reference_size });
    }
    let (a, b) = (shown(image, scale)?, shown(reference, scale)?);
    let colour = colour_difference(&a, &b, size, pixels_per_degree);
    let feature = feature_difference(&a, &b, size, pixels_per_degree);
    Ok(colour.iter().zip(feature).map(|(c, f)| c.powf(1.0 - f)).collect())
}

fn shown<T: Sample>(picture: &Picture<T>, scale: f64) -> Result<Vec<Rgb>, PictureError> {
    let channels = [picture.require("R")?, picture.require("G")?, picture.require("B")?];
    let cut = |v: f64| if v.is_nan() { 0.0 } else { v.clamp(0.0, 1.0) };
    Ok((0..channels[0].len()).map(|i| channels.map(|c| cut(c[i].to_f64() * scale))).collect())
}

/// §4.1: filtered by the eye's contrast sensitivity, in CIELAB with the Hunt effect, by the HyAB distance, spread over [0, 1].
fn colour_difference(a: &[Rgb], b: &[Rgb], size: (usize, usize), ppd: f64) -> Vec<f64> {
    // a₁, b₁, a₂, b₂ of the achromatic, red-green and blue-yellow contrast sensitivity (table 1).
    let sensitivities = [[1.0, 0.0047, 0.0, 1e-5], [1.0, 0.0053, 0.0, 1e-5], [34.1, 0.04, 13.5, 0.025]];
    let widest = sensitivities.iter().flat_map(|s| [s[1], s[3]]).fold(0.0, f64::max);
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * ppd).ceil() as isize;
    let kernels = sensitivities.map(|[a1, b1, a2, b2]| {
        let value = |x: isize, y: isize| {
            let d2 = (x * x + y * y) as f64 / (ppd * ppd);
            let part = |a: f64, b: f64| a * (PI / b).sqrt() * (-PI * PI * d2 / b).exp();
            part(a1, b1) + part(a2, b2)
        };
        let mut kernel = grid(radius, value);
        let sum: f64 = kernel.iter().sum();
        kernel.iter_mut().for_each(|v| *v /= sum);
        kernel
    });
    let seen = |pixels: &[Rgb]| -> Vec<Rgb> {
        let opponent: Vec<Rgb> = pixels.iter().map(|&rgb| opponent_of(xyz_of(rgb))).collect();
        let planes = [0, 1, 2].map(|c| {
            let plane: Vec<f64> = opponent.iter().map(|p| p[c]).collect();
            convolve(&plane, size, &kernels[c], radius)
        });
        (0..pixels.len())
            .map(|i| {
                let rgb = rgb_of(xyz_of_opponent([planes[0][i], planes[1][i], planes[2][i]]));
                hunt(lab_of(xyz_of(rgb.map(|v| v.clamp(0.0, 1.0)))))
            })
            .collect()
    };
    let hyab = |a: Rgb, b: Rgb| (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2]);
    let corner = |rgb: Rgb| hunt(lab_of(xyz_of(rgb)));
    let most = hyab(corner([0.0, 1.0, 0.0]), corner([0.0, 0.0, 1.0])).powf(COLOUR_EXPONENT);
    let cutoff = COLOUR_CUTOFF * most;
    seen(a)
        .into_iter()
        .zip(seen(b))
        .map(|(a, b)| {
            let d = hyab(a, b).powf(COLOUR_EXPONENT);
            if d < cutoff {
                COLOUR_TARGET / cutoff * d
            } else {
                COLOUR_TARGET + (d - cutoff) / (most - cutoff) * (1.0 - COLOUR_TARGET)
            }
        })
        .collect()
}

/// §4.2: edges and points of the achromatic channel, by derivatives of a Gaussian.
fn feature_difference(a: &[Rgb], b: &[Rgb], size: (usize, usize), ppd: f64) -> Vec<f64> {
    let sigma = 0.5 * FEATURE_WIDTH_DEG * ppd;
    let radius = (3.0 * sigma).ceil() as isize;
    let gauss = |x: isize, y: isize| (-((x * x + y * y) as f64) / (2.0 * sigma * sigma)).exp();
    let edge = balanced(grid(radius, |x, y| -(x as f64) * gauss(x, y)));
    let point = balanced(grid(radius, |x, y| ((x * x) as f64 / (sigma * sigma) - 1.0) * gauss(x, y)));
    let side = 2 * radius as usize + 1;
    let transposed =
        |kernel: &[f64]| -> Vec<f64> { (0..side * side).map(|i| kernel[i % side * side + i / side]).collect() };
    let magnitudes = |pixels: &[Rgb], kernel: &[f64]| -> Vec<f64> {
        let grey: Vec<f64> = pixels.iter().map(|&rgb| (opponent_of(xyz_of(rgb))[0] + 16.0) / 116.0).collect();
        let along = convolve(&grey, size, kernel, radius);
        let across = convolve(&grey, size, &transposed(kernel), radius);
        along.iter().zip(across).map(|(x, y)| x.hypot(y)).collect()
    };
    let difference = |kernel: &[f64]| -> Vec<f64> {
        magnitudes(a, kernel).iter().zip(magnitudes(b, kernel)).map(|(a, b)| (a - b).abs()).collect()
    };
    difference(&edge)
        .iter()
        .zip(difference(&point))
        .map(|(edge, point)| (edge.max(point) / std::f64::consts::SQRT_2).powf(FEATURE_EXPONENT))
        .collect()
}

fn grid(radius: isize, value: impl Fn(isize, isize) -> f64) -> Vec<f64> {
    let value = &value;
    (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| value(x, y))).collect()
}

/// Positive weights that sum to 1 and negative ones that sum to −1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|&&v| v > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|&&v| v < 0.0).sum::<f64>();
    kernel.into_iter().map(|v| if v > 0.0 { v / positive } else { v / negative }).collect()
}

/// Correlation with a square kernel; beyond the border the picture goes on as its outermost pixels.
fn convolve(plane: &[f64], (width, height): (usize, usize), kernel: &[f64], radius: isize) -> Vec<f64> {
    let side = 2 * radius as usize + 1;
    let at =
        |v: usize, k: usize, length: usize| (v as isize + k as isize - radius).clamp(0, length as isize - 1) as usize;
    let mut out = Vec::with_capacity(plane.len());
    for y in 0..height {
        for x in 0..width {
            let mut sum = 0.0;
            for ky in 0..side {
                let row = &plane[at(y, ky, height) * width..][..width];
                for kx in 0..side {
                    sum += kernel[ky * side + kx] * row[at(x, kx, width)];
                }
            }
            out.push(sum);
        }
    }
    out
}

/// Linear Rec. 709 to XYZ, as the published evaluator has it.
const TO_XYZ: [Rgb; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

fn xyz_of(rgb: Rgb) -> Rgb {
    TO_XYZ.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2])
}

/// The inverse of [`TO_XYZ`], by cofactors.
fn rgb_of(xyz: Rgb) -> Rgb {
    let m = TO_XYZ;
    let cofactor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant: f64 = (0..3).map(|c| m[0][c] * cofactor(0, c)).sum();
    [0, 1, 2].map(|i| (0..3).map(|j| cofactor(j, i) * xyz[j]).sum::<f64>() / determinant)
}

/// XYZ relative to white.
fn relative(xyz: Rgb) -> Rgb {
    let white = xyz_of([1.0; 3]);
    [0, 1, 2].map(|c| xyz[c] / white[c])
}

/// YCxCz, a linear stand-in for CIELAB (§4.1.1).
fn opponent_of(xyz: Rgb) -> Rgb {
    let [x, y, z] = relative(xyz);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_of_opponent([y, cx, cz]: Rgb) -> Rgb {
    let white = xyz_of([1.0; 3]);
    let y = (y + 16.0) / 116.0;
    [white[0] * (y + cx / 500.0), white[1] * y, white[2] * (y - cz / 200.0)]
}

fn lab_of(xyz: Rgb) -> Rgb {
    const DELTA: f64 = 6.0 / 29.0;
    let f = |t: f64| if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let [x, y, z] = relative(xyz).map(f);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The Hunt effect: colours count by their lightness (§4.1.3).
fn hunt([l, a, b]: Rgb) -> Rgb {
    [l, 0.01 * l * a, 0.01 * l * b]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient(width: usize, height: usize, mut change: impl FnMut(usize, usize, &mut [f32; 3])) -> Picture<f32> {
        let pixels: Vec<[f32; 3]> = (0..width * height)
            .map(|i| {
                let (x, y) = (i % width, i / width);
                let mut rgb = [x as f32 / width as f32, y as f32 / height as f32, 0.5];
                change(x, y, &mut rgb);
                rgb
            })
            .collect();
        Picture::from_rgb(width, height, &pixels).unwrap()
    }

    #[test]
    fn the_published_evaluator_says_the_same() {
        let reference = gradient(56, 40, |_, _, _| {});
        let image = gradient(56, 40, |x, y, rgb| {
            if (15..30).contains(&x) && (10..20).contains(&y) {
                *rgb = [0.9, 0.2, 0.1];
            } else if (x, y) == (40, 25) {
                *rgb = [1.0; 3];
            } else if x < 20 && y >= 30 {
                *rgb = rgb.map(|v| v * 0.9);
            }
        });
        let map = flip(&image, &reference, 1.0, PIXELS_PER_DEGREE).unwrap();
        // The evaluator of the paper's authors, version 1.7, on linear input without tone mapping; it computes in f32.
        let close = |a: f64, b: f64| assert!((a - b).abs() < 2e-4, "{a} is not {b}");
        close(map.iter().sum::<f64>() / map.len() as f64, 0.104_503_66);
        for (x, y, value) in [
            (20, 15, 0.828_174_65),
            (40, 25, 0.169_375_76),
            (5, 5, 0.000_307_04),
            (10, 35, 0.260_354_64),
            (15, 10, 0.461_433),
            (0, 0, 0.0),
            (0, 39, 0.268_005_25),
        ] {
            close(map[y * 56 + x], value);
        }
    }

    #[test]
    fn a_picture_is_like_itself_and_exposure_hides_what_a_screen_cannot_show() {
        let image = gradient(20, 16, |_, _, _| {});
        assert!(flip(&image, &image, 1.0, PIXELS_PER_DEGREE).unwrap().iter().all(|&v| v == 0.0));
        let brighter = gradient(20, 16, |_, _, rgb| *rgb = rgb.map(|v| v + 1.0));
        let white = gradient(20, 16, |_, _, rgb| *rgb = [1.0; 3]);
        assert!(flip(&brighter, &white, 1.0, PIXELS_PER_DEGREE).unwrap().iter().all(|&v| v < 1e-6));
        assert!(flip(&image, &gradient(16, 20, |_, _, _| {}), 1.0, PIXELS_PER_DEGREE).is_err());
    }
}
