//! The instruction sets, of which one is chosen when a geometry is built.

use super::Filters;
use super::compiled::Compiled;
use super::portable::Portable;
use super::vector::Vector;
#[cfg(target_arch = "x86_64")]
use super::{avx2, avx512};

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

/// An instruction set that the processor has.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Level {
    #[cfg(target_arch = "x86_64")]
    Avx512(avx512::Avx512),
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
    Portable,
}

impl Level {
    /// The best one.
    pub(crate) fn detect() -> Self {
        #[cfg(test)]
        if let Some(level) = FORCED.get() {
            return level;
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(filters) = avx512::Avx512::detect() {
            return Self::Avx512(filters);
        } else if let Some(filters) = avx2::Avx2::detect() {
            return Self::Avx2(filters);
        }
        Self::Portable
    }

    /// All; the one that is taken for the best, if one is.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        if let Some(level) = FORCED.get() {
            return vec![level];
        }
        let mut all = vec![Self::Portable];
        #[cfg(target_arch = "x86_64")]
        all.extend(avx2::Avx2::detect().map(Self::Avx2));
        #[cfg(target_arch = "x86_64")]
        all.extend(avx512::Avx512::detect().map(Self::Avx512));
        all
    }

    /// What comes of some work if this is taken for the best.
    #[cfg(test)]
    pub(crate) fn forced<T>(self, work: impl FnOnce() -> T) -> T {
        let before = FORCED.replace(Some(self));
        let out = work();
        FORCED.set(before);
        out
    }

    /// Lanes of the leaves of a tree.
    pub(crate) fn lanes(self) -> usize {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(filters) => lanes_of(filters),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(filters) => lanes_of(filters),
            Self::Portable => lanes_of(Portable),
        }
    }

    /// Does some work.
    #[inline(always)]
    pub(super) fn run<J: Job>(self, job: J) -> J::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(filters) => filters.run(job),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(filters) => filters.run(job),
            Self::Portable => Portable.run(job),
        }
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
        Level::Avx512(filters) => avx2::Avx2::from(filters).run(work),
        level => level.run(work),
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
