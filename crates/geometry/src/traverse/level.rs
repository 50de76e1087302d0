//! The instruction sets, of which one is chosen when a geometry is built.

use super::Filters;
use super::compiled::Compiled;
use super::portable::Portable;
use super::vector::Vector;
use etalon_simd::Level;

/// Lanes of a vector of an instruction set, and of the leaves of a tree that is made for it.
fn lanes_of<F: Filters>(_: F) -> usize {
    F::Vector::WIDTH
}

/// Work that is compiled for each instruction set. Its function is inlined into one that is.
pub(super) trait Job {
    /// What comes of it.
    type Output;
    /// The work.
    fn run<F: Compiled>(self, filters: F) -> Self::Output;
}

#[cfg(test)]
thread_local! {
    /// What tests take for the best instruction set.
    static FORCED: std::cell::Cell<Option<Level>> = const { std::cell::Cell::new(None) };
}

/// The instruction set that geometries are built for.
pub(crate) fn best() -> Level {
    #[cfg(test)]
    if let Some(level) = FORCED.get() {
        return level;
    }
    Level::best()
}

/// All instruction sets; the one that is taken for the best, if one is.
#[cfg(test)]
pub(crate) fn all() -> Vec<Level> {
    FORCED.get().map_or_else(Level::available, |level| vec![level])
}

/// What comes of some work if an instruction set is taken for the best.
#[cfg(test)]
pub(crate) fn forced<T>(level: Level, work: impl FnOnce() -> T) -> T {
    let before = FORCED.replace(Some(level));
    let out = work();
    FORCED.set(before);
    out
}

/// Lanes of the leaves of a tree that is made for an instruction set.
pub(crate) fn lanes(level: Level) -> usize {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(filters) => lanes_of(filters),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(filters) => lanes_of(filters),
        Level::Baseline => lanes_of(Portable),
    }
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

/// A loop that the compiler makes vectors of, as wide as an instruction set has.
pub(crate) trait Loop {
    /// What comes of it.
    type Output;
    /// The loop, marked to be inlined always, as all that it calls.
    fn run(self) -> Self::Output;
}

/// Runs a loop in the vectors of an instruction set. Operations are the same in all of them, and so is the result.
#[inline(always)]
pub(crate) fn vectorised<L: Loop>(level: Level, work: L) -> L::Output {
    let work = Vectorised(work);
    match level {
        // Vectors that the compiler makes of sixteen floats gain nothing, and what it stores by masks is waited for.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(filters) => filters.avx2().run(work),
        level => run(level, work),
    }
}

struct Vectorised<L>(L);

impl<L: Loop> Job for Vectorised<L> {
    type Output = L::Output;

    #[inline(always)]
    fn run<F: Compiled>(self, _: F) -> L::Output {
        self.0.run()
    }
}
