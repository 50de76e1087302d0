//! Work that is compiled for each instruction set.

use super::compiled::Compiled;
use super::portable::Portable;
use etalon_simd::Level;

/// Work that is compiled for each instruction set. Its function is inlined into one that is.
pub(super) trait Job {
    /// What comes of it.
    type Output;
    /// The work.
    fn run<F: Compiled>(self, filters: F) -> Self::Output;
}

/// Does some work on an instruction set.
#[inline(always)]
pub(super) fn run<J: Job>(level: Level, job: J) -> J::Output {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(filters) => filters.run(job),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(filters) => filters.run(job),
        Level::Baseline => Portable.run(job),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::node::leaf_lanes;
    use crate::level;
    use crate::traverse::vector::Vector;

    struct Width;

    impl Job for Width {
        type Output = usize;
        fn run<F: Compiled>(self, _: F) -> usize {
            F::Vector::WIDTH
        }
    }

    #[test]
    fn leaves_are_as_wide_as_vectors() {
        assert!(level::all().into_iter().all(|level| run(level, Width) == leaf_lanes(level)));
    }
}
