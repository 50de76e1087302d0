//! What an image shows, by its definition: texels, tents and how it goes on beyond its edges.

use serde_json::{Value, json};

use crate::truths::scene::grey_hdr;

/// What an image continues as beyond its edges.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

impl Wrap {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Repeat => "repeat",
            Self::Mirror => "mirror",
            Self::Clamp => "clamp",
        }
    }

    /// The texel that stands at place `i` of an endless row.
    fn texel(self, i: i64, n: i64) -> usize {
        let at = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Mirror => (i.rem_euclid(2 * n)).min(2 * n - 1 - i.rem_euclid(2 * n)),
            Self::Clamp => i.clamp(0, n - 1),
        };
        at as usize
    }
}

/// An image of numbers, rows from the top, as a surface shows it.
#[derive(Clone)]
pub(crate) struct Shown {
    pub(crate) width: usize,
    pub(crate) texels: Vec<f64>,
    pub(crate) wrap: [Wrap; 2],
    pub(crate) bilinear: bool,
}

/// ∫ of the tent function max(0, 1 − |x|) from −∞.
fn under_tent(x: f64) -> f64 {
    match x {
        _ if x <= -1.0 => 0.0,
        _ if x <= 0.0 => 0.5 * (1.0 + x).powi(2),
        _ if x <= 1.0 => 1.0 - 0.5 * (1.0 - x).powi(2),
        _ => 1.0,
    }
}

impl Shown {
    pub(crate) fn new(width: usize, texels: &[f64]) -> Self {
        Self { width, texels: texels.to_vec(), wrap: [Wrap::Repeat; 2], bilinear: true }
    }

    fn height(&self) -> usize {
        self.texels.len() / self.width
    }

    /// The texel in a column and a row counted from below.
    pub(crate) fn texel(&self, column: i64, row: i64) -> f64 {
        let (w, h) = (self.width, self.height());
        let column = self.wrap[0].texel(column, w as i64);
        let row = self.wrap[1].texel(row, h as i64);
        self.texels[(h - 1 - row) * w + column]
    }

    /// The mean over a rectangle of texture coordinates: each texel weighs as the integral of its tent, or its box, over it.
    pub(crate) fn mean(&self, u: [f64; 2], v: [f64; 2]) -> f64 {
        let weights = |from: f64, to: f64, count: usize| -> Vec<(i64, f64)> {
            let (from, to) = (from * count as f64, to * count as f64);
            (from.floor() as i64 - 2..=to.ceil() as i64 + 2)
                .map(|i| {
                    let centre = i as f64 + 0.5;
                    let part = if self.bilinear {
                        under_tent(to - centre) - under_tent(from - centre)
                    } else {
                        (to.min(centre + 0.5) - from.max(centre - 0.5)).max(0.0)
                    };
                    (i, part / (to - from))
                })
                .collect()
        };
        let (columns, rows) = (weights(u[0], u[1], self.width), weights(v[0], v[1], self.height()));
        let of_row = |j: i64| columns.iter().map(|&(i, weight)| weight * self.texel(i, j)).sum::<f64>();
        rows.iter().map(|&(j, weight)| weight * of_row(j)).sum()
    }

    /// The value at a place, by interpolation between the four centres around it.
    pub(crate) fn at(&self, u: f64, v: f64) -> f64 {
        let (x, y) = (u * self.width as f64, v * self.height() as f64);
        if !self.bilinear {
            return self.texel(x.floor() as i64, y.floor() as i64);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (i, j, s, t) = (x.floor() as i64, y.floor() as i64, x - x.floor(), y - y.floor());
        let row = |j: i64| (1.0 - s) * self.texel(i, j) + s * self.texel(i + 1, j);
        (1.0 - t) * row(j) + t * row(j + 1)
    }

    /// The mean over a picture whose places have these texture coordinates, by midpoints.
    pub(crate) fn over(&self, steps: u32, uv: impl Fn(f64, f64) -> [f64; 2]) -> f64 {
        let at = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        let row = |j: u32| {
            (0..steps)
                .map(|i| {
                    let [u, v] = uv(at(i), at(j));
                    self.at(u, v)
                })
                .sum::<f64>()
        };
        (0..steps).map(row).sum::<f64>() / f64::from(steps).powi(2)
    }

    pub(crate) fn hdr(&self) -> Vec<u8> {
        grey_hdr(self.width, &self.texels)
    }

    /// The albedo in the scene's words.
    pub(crate) fn albedo(&self, file: &str) -> Value {
        json!({
            "type": "image", "file": file, "filter": if self.bilinear { "bilinear" } else { "nearest" },
            "wrap": self.wrap[0].name(), "wrap_v": self.wrap[1].name(),
        })
    }
}

/// Twelve numbers without a pattern, exact in the file.
pub(super) const PATCHES: [f64; 12] =
    [0.125, 0.875, 0.25, 0.5, 0.75, 0.0625, 0.9375, 0.375, 0.625, 0.1875, 0.8125, 0.4375];

pub(crate) fn patches() -> Shown {
    Shown::new(4, &PATCHES)
}
