//! Random numbers are jointly uniform, any two of them: those of the film, the lens, the wavelength, the time and the first vertices, with
//! either sampler, within each replicate and between replicates.
//!
//! Each pair of dimensions is counted in a grid of 8 × 8 cells and judged by χ². Points of a stratified sequence are spread more evenly than
//! independent ones, so that χ² is smaller then; only large values count. All pairs of a test together have a significance of 10⁻⁶
//! (Šidák). The seeds are fixed, so that a test that passes once always does.

use etalon_oracle::Verdict;
use etalon_oracle::statistics::{SUITE_SIGNIFICANCE, chi_square_verdict, sidak};
use etalon_scene::SamplerKind;
use etalon_transport::sampler::{CAMERA_SETS, SETS_PER_VERTEX, Sampler};

const KINDS: [SamplerKind; 2] = [SamplerKind::Sobol, SamplerKind::Independent];
/// Vertices whose numbers are tested.
const VERTICES: u32 = 3;
const SETS: usize = (CAMERA_SETS + VERTICES * SETS_PER_VERTEX) as usize;
/// Film, lens, wavelength, time, two unused, and of each vertex eight and four where it fluoresces.
const DIMENSIONS: usize = 4 * (SETS + VERTICES as usize);
const REPLICATES: u32 = 4;
/// Cells along one dimension.
const CELLS: usize = 8;

/// Cells of all numbers of one sample.
fn cells(kind: SamplerKind, seed: u64, pixel: u64, sample: u32) -> [u8; DIMENSIONS] {
    let sampler = Sampler::new(kind, seed, pixel, sample, REPLICATES);
    let mut cells = [0; DIMENSIONS];
    let sets = (0..SETS as u32).map(|set| sampler.set(set)).chain((0..VERTICES).map(|v| sampler.fluorescence_set(v)));
    for (set, cells) in sets.zip(cells.chunks_exact_mut(4)) {
        cells.iter_mut().zip(set).for_each(|(cell, u)| *cell = (u * CELLS as f64) as u8);
    }
    cells
}

/// Judges pairs of cells, all as often expected as each other.
fn judged(name: String, pairs: impl Iterator<Item = (u8, u8)>, significance: f64) -> Verdict {
    let mut counts = [0_u64; CELLS * CELLS];
    pairs.for_each(|(a, b)| counts[usize::from(a) * CELLS + usize::from(b)] += 1);
    let expected = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
    chi_square_verdict(name, &counts, &[expected; CELLS * CELLS], significance, "8 × 8 cells")
}

fn all_pass(verdicts: impl Iterator<Item = Verdict>) {
    let failed: Vec<String> = verdicts.filter(|verdict| !verdict.pass).map(|verdict| verdict.to_string()).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..DIMENSIONS).flat_map(|a| (a + 1..DIMENSIONS).map(move |b| (a, b)))
}

/// Over 2048 pixels with the first 32 samples of each: a departure of 6 % in root mean square from the probability of a cell is seen.
#[test]
fn any_two_numbers_of_a_sample_are_jointly_uniform_over_pixels() {
    for kind in KINDS {
        let samples: Vec<_> = (0..2048).flat_map(|pixel| (0..32).map(move |s| cells(kind, 11, pixel, s))).collect();
        let significance = sidak(SUITE_SIGNIFICANCE, pairs().count());
        all_pass(pairs().map(|(a, b)| {
            let of = samples.iter().map(|sample| (sample[a], sample[b]));
            judged(format!("{kind:?}: numbers {a} and {b}"), of, significance)
        }));
    }
}

/// The same in each replicate of one pixel, whose samples belong to one sequence, which ends and begins anew within them.
#[test]
fn any_two_numbers_of_a_sample_are_jointly_uniform_within_each_replicate() {
    for kind in KINDS {
        let significance = sidak(SUITE_SIGNIFICANCE, pairs().count() * REPLICATES as usize);
        for replicate in 0..REPLICATES {
            let samples: Vec<_> =
                (0..3 << 15).map(|index| cells(kind, 5, 77, index * REPLICATES + replicate)).collect();
            all_pass(pairs().map(|(a, b)| {
                let of = samples.iter().map(|sample| (sample[a], sample[b]));
                judged(format!("{kind:?}: numbers {a} and {b} of replicate {replicate}"), of, significance)
            }));
        }
    }
}

/// Two replicates of a pixel, and two pixels side by side, have nothing in common: pairs of the same number and of neighbours of it.
#[test]
fn numbers_of_two_replicates_or_of_two_pixels_are_jointly_uniform() {
    let others = |a: usize| [a, a ^ 1, (a + 4) % DIMENSIONS];
    let tests = 9 * 3 * DIMENSIONS;
    for kind in KINDS {
        let significance = sidak(SUITE_SIGNIFICANCE, tests);
        // Sixteen samples of each of four replicates.
        let pixels: Vec<Vec<_>> =
            (0..2048).map(|pixel| (0..64).map(|sample| cells(kind, 23, pixel, sample)).collect()).collect();
        let between = |of: &dyn Fn(usize, usize) -> Verdict| {
            all_pass((0..DIMENSIONS).flat_map(|a| others(a).map(|b| of(a, b))));
        };
        for (first, second) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let name = format!("{kind:?}: replicates {first} and {second}");
            between(&|a, b| {
                let of = |pixel: &Vec<[u8; DIMENSIONS]>| -> Vec<(u8, u8)> {
                    (0..16).map(|k| (pixel[4 * k + first][a], pixel[4 * k + second][b])).collect()
                };
                judged(format!("{name}, numbers {a} and {b}"), pixels.iter().flat_map(of), significance)
            });
        }
        for apart in [1, 2, 1024] {
            let name = format!("{kind:?}: pixels {apart} apart");
            between(&|a, b| {
                let of = pixels.iter().zip(&pixels[apart..]);
                let of = of.flat_map(|(one, other)| one.iter().zip(other).map(|(one, other)| (one[a], other[b])));
                judged(format!("{name}, numbers {a} and {b}"), of, significance)
            });
        }
    }
}

/// What the tests would say of a number that is used twice, and of one that depends weakly on another.
#[test]
fn numbers_that_depend_on_each_other_are_found() {
    let significance = sidak(SUITE_SIGNIFICANCE, pairs().count());
    let samples: Vec<_> =
        (0..2048).flat_map(|pixel| (0..32).map(move |s| cells(SamplerKind::Sobol, 11, pixel, s))).collect();
    let twice = samples.iter().map(|sample| (sample[0], sample[0]));
    assert!(!judged("twice".into(), twice, significance).pass);
    // In one sample of eight the number of another dimension.
    let weakly = samples.iter().map(|sample| (sample[0], if sample[9] == 0 { sample[0] } else { sample[2] }));
    assert!(!judged("weakly".into(), weakly, significance).pass);
}
