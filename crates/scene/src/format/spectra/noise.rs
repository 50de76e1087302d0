//! Value noise as an image.

use std::sync::Arc;

use super::{Spectra, Use};
use crate::format::spectrum::{MOST_CELLS, NoiseSpectrum};
use crate::format::uv::uv_map;
use crate::json::{Code, Reader};
use crate::texture::{Image, ImageTexture, Texels};

/// Most points of all noise of a scene: 200 MB of texels.
const MOST_POINTS: u64 = 1 << 24;

/// What an image of noise depends on: the bits of both colours, the cells of the first octave, the number of octaves, the seed.
pub(super) type NoiseKey = ([[u32; 3]; 2], [u64; 2], u64, u64);

impl Spectra<'_> {
    /// The sum of the lattices changes evenly along u and v within each cell of the finest. So an image with a texel for each point of that lattice
    /// shows it exactly.
    pub(super) fn noise(&mut self, form: &NoiseSpectrum, used: Use, reader: &mut Reader<'_>) -> Option<ImageTexture> {
        let (first, second) = (form.first.as_ref(), form.second.as_ref());
        let (cells, octaves, seed) = (form.cells?, form.octaves?.0, form.seed?.0);
        let mut uv_map = uv_map(form.uv_scale, &form.uv_matrix, form.uv_offset, form.at, reader)?;
        let [first, second] = [first, second].map(|colour| self.texel(colour?, form.at, used, reader));
        let colours = [first?, second?];
        let side = cells.map(|cells| cells.value.0 << (octaves - 1));
        for k in [0, 1] {
            if side[k] > MOST_CELLS {
                let message =
                    format!("the finest of {octaves} octaves has {} cells; at most {MOST_CELLS} are possible", side[k]);
                reader.error(Code::OutOfRange, cells[k].at, message);
                return None;
            }
            // Lattice points lie where texels have their centres.
            uv_map.offset[k] += 0.5 / side[k] as f64;
        }
        let key = (colours.map(|colour| colour.map(f32::to_bits)), cells.map(|cells| cells.value.0), octaves, seed);
        if !self.noise.contains_key(&key) {
            self.noise_points += side[0] * side[1];
            if self.noise_points > MOST_POINTS {
                let message = format!("all noise of the scene has more than {MOST_POINTS} points");
                reader.error(Code::OutOfRange, form.at.head(), message);
                return None;
            }
        }
        let image = self.noise.entry(key).or_insert_with(|| Arc::new(image(colours, key.1, octaves, seed))).clone();
        Some(ImageTexture { name: "noise".to_owned(), uv_map, ..ImageTexture::of(image) })
    }
}

/// A texel for each point of the finest lattice.
fn image([first, second]: [[f32; 3]; 2], cells: [u64; 2], octaves: u64, seed: u64) -> Image {
    let [width, height] = cells.map(|cells| cells << (octaves - 1));
    let mix = |t: f64| {
        std::array::from_fn(|c| (f64::from(first[c]) + t * (f64::from(second[c]) - f64::from(first[c]))) as f32)
    };
    // Rows count from the top.
    let points = (0..height).rev().flat_map(|j| (0..width).map(move |i| [i, j]));
    let texels = points.map(|point| mix(noise(point, cells, octaves, seed))).collect();
    Image::new(width as u32, height as u32, Texels::F32(texels))
}

/// Noise from 0 to 1 at a point of the finest lattice: Σ 2⁻ᵒ vₒ / Σ 2⁻ᵒ over the octaves o, where vₒ is the bilinear mean of the numbers around the point.
fn noise(point: [u64; 2], cells: [u64; 2], octaves: u64, seed: u64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for octave in 0..octaves {
        let weight = (-(octave as f64)).exp2();
        // Points of the finest lattice in a cell of this one.
        let fine = 1_u64 << (octaves - 1 - octave);
        let number = |k: usize, step: u64| (point[k] / fine + step) % (cells[k] << octave);
        let at = |du: u64, dv: u64| lattice_number(seed, octave, [number(0, du), number(1, dv)]);
        let [u, v] = point.map(|p| (p % fine) as f64 / fine as f64);
        let along = |dv: u64| at(0, dv) + u * (at(1, dv) - at(0, dv));
        sum += weight * (along(0) + v * (along(1) - along(0)));
        weights += weight;
    }
    sum / weights
}

/// The random number in [0, 1) of a lattice point.
fn lattice_number(seed: u64, octave: u64, [i, j]: [u64; 2]) -> f64 {
    let key = [octave, i, j].into_iter().fold(split_mix(seed), |key, number| split_mix(key ^ number));
    (key >> 11) as f64 / (1_u64 << 53) as f64
}

/// The output of SplitMix64 whose state is this (Steele, Lea & Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014).
fn split_mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
