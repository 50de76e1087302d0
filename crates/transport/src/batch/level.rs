//! The instruction set that stages of a batch run on, chosen once for a tile.
//!
//! A stage is a loop over the paths of one [`W`](super::rows::W)-wide set, without branches, which the compiler turns into vector
//! instructions: compiled once for each instruction set from one source, it computes the same bits on all of them, since no
//! operation is fused and each is rounded correctly.

pub(super) use etalon_simd::Level;

/// Functions whose body is compiled once for each instruction set; they take a [`Level`] before their arguments. Generic ones
/// state their parameters, and then those as arguments.
macro_rules! stages {
    ($(
        $(#[$meta:meta])*
        fn $name:ident $([$($generics:tt)*][$($arguments:tt)*])? ($($argument:ident: $type:ty),* $(,)?) $body:block
    )*) => {$(
        $(#[$meta])*
        #[inline]
        #[allow(clippy::too_many_arguments, reason = "rows in and rows out")]
        pub(in crate::batch) fn $name $(<$($generics)*>)? (level: Level, $($argument: $type),*) {
            etalon_simd::dispatch!(level; fn body $([$($generics)*][$($arguments)*])? ($($argument: $type),*) $body)
        }
    )*};
}

pub(super) use stages;
