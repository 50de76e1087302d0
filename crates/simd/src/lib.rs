//! Instruction sets: which the processor has, which one to use, and vector instructions as safe functions.
//!
//! A function is written once. [`dispatch!`] compiles it for each instruction set and calls the version for a [`Level`]:
//!
//! ```
//! use etalon_simd::{Level, dispatch};
//!
//! fn largest(level: Level, numbers: &[f32]) -> f32 {
//!     dispatch!(level; fn largest(numbers: &[f32]) -> f32 {
//!         numbers.iter().fold(f32::NEG_INFINITY, |a, &b| if b > a { b } else { a })
//!     })
//! }
//!
//! assert_eq!(largest(Level::best(), &[1.0, 3.0, 2.0]), 3.0);
//! assert!(Level::available().into_iter().all(|level| largest(level, &[1.0, 3.0, 2.0]) == 3.0));
//! ```
//!
//! | for | see |
//! |---|---|
//! | one instruction set of this processor, with its token | [`Level`] |
//! | a value that proves that the processor has every feature of a set | [`Avx2`], [`Avx512`] |
//! | a function compiled for each level | [`dispatch!`] |
//! | a function compiled for one set, given the token | [`call_compiled!`] |
//! | vector instructions as safe functions | methods of the tokens, named as in [`std::arch`] |
//!
//! The example `sum` times one loop on each instruction set.
//!
//! The features of each set stand in one list (`with_features!` in `features.rs`). Detection, the attribute `target_feature` and the methods
//! of the tokens all read it. So no code is compiled for a feature that was not detected. The macros write the only `unsafe` that their users
//! need.
//!
//! The environment variable [`VARIABLE`] makes [`Level::best`] a lower set than the processor has. Results do not depend on the set. The
//! variable is there to test that.

#[cfg(target_arch = "x86_64")]
mod features;
#[cfg(target_arch = "x86_64")]
mod instructions;
mod level;

#[cfg(target_arch = "x86_64")]
pub use features::{Avx2, Avx512};
pub use level::{Level, LevelError, VARIABLE};
