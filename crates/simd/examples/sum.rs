//! One loop, compiled for every instruction set of this processor:
//! `cargo run --release -p etalon-simd --example sum`

#![allow(clippy::print_stdout)]

use std::time::Instant;

use etalon_simd::{Level, dispatch};

/// The sum of the squares of some numbers, in sixteen sums, as many as the widest vector holds.
fn sum_of_squares(level: Level, numbers: &[f32]) -> f32 {
    dispatch!(level; fn sum(numbers: &[f32]) -> f32 {
        let mut sums = [0.0; 16];
        for row in numbers.as_chunks::<16>().0 {
            for i in 0..16 {
                sums[i] += row[i] * row[i];
            }
        }
        sums.iter().sum()
    })
}

fn main() {
    let numbers: Vec<f32> = (0..1 << 16).map(|i| (i % 100) as f32 * 0.01).collect();
    let first = sum_of_squares(Level::Baseline, &numbers);
    for level in Level::available() {
        let start = Instant::now();
        for _ in 0..1000 {
            std::hint::black_box(sum_of_squares(level, std::hint::black_box(&numbers)));
        }
        let per_number = start.elapsed().as_secs_f64() * 1e9 / (1000 * numbers.len()) as f64;
        let sum = sum_of_squares(level, &numbers);
        assert_eq!(sum.to_bits(), first.to_bits(), "the same operations in the same order give the same bits");
        println!("{:8} {sum} in {per_number:.3} ns a number", level.name());
    }
    println!("a program uses {}, unless ETALON_SIMD names another", Level::best().name());
}
