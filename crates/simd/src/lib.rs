//! Instruction sets: which the processor has, which one to use, and safe doors to vector instructions.
//!
//! | item | what it is |
//! |---|---|
//! | [`Avx2`], [`Avx512`] | tokens: a value proves that the processor has every feature of the set |
//! | [`Level`] | one instruction set of this processor, with its token |
//! | [`call_compiled!`] | compiles a function for a set and calls it, given the token |
//! | [`dispatch!`] | the same for each [`Level`], and calls the one for a level |
//! | methods of the tokens | vector instructions as safe functions, named as in [`std::arch`] |
//!
//! The features of each set stand in one list (`with_features!` in `features.rs`). Detection, the attribute
//! `target_feature` and the methods of the tokens all read it, so that code is never compiled for a feature that was not
//! detected. The macros write the only `unsafe` that their users need; users need no `unsafe` of their own.
//!
//! The environment variable [`VARIABLE`] makes [`Level::best`] a lower set than the processor has. Results do not depend
//! on the set: it is there to test just that.

#[cfg(target_arch = "x86_64")]
mod features;
#[cfg(target_arch = "x86_64")]
mod instructions;
mod level;

#[cfg(target_arch = "x86_64")]
pub use features::{Avx2, Avx512};
pub use level::{Level, LevelError, VARIABLE};
