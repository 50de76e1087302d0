//! The instruction sets, of which one is chosen when a geometry is built; and loops that are compiled for each.

#[cfg(target_arch = "x86_64")]
use etalon_simd::Avx2;
use etalon_simd::Level;

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
    match level {
        // Vectors that the compiler makes of sixteen floats gain nothing, and what it stores by masks is waited for.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(token) => in_avx2(token.avx2(), work),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(token) => in_avx2(token, work),
        Level::Baseline => work.run(),
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn in_avx2<L: Loop>(token: Avx2, work: L) -> L::Output {
    etalon_simd::call_compiled!(Avx2, token;
        fn compiled[L: Loop][L](work: L) -> L::Output { work.run() }
    )
}
