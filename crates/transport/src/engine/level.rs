//! The instruction set that stages of the engine run on, chosen once for a tile.
//!
//! A stage is a loop over the paths of one [`W`](super::rows::W)-wide set, without branches, which the compiler turns into vector
//! instructions: compiled once for each instruction set from one source, it computes the same bits on all of them, since no
//! operation is fused and each is rounded correctly.

/// An instruction set of this machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Level(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Set {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// What every machine of the target has.
    Baseline,
}

impl Level {
    /// The widest that this machine has.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2");
            let lengths = is_x86_feature_detected!("avx512vl") && is_x86_feature_detected!("avx512dq");
            if avx2 && lengths && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512bw") {
                return Self(Set::Avx512);
            }
            if avx2 {
                return Self(Set::Avx2);
            }
        }
        Self(Set::Baseline)
    }

    /// All that this machine has, the widest first.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        let widest = Self::detect().0;
        #[cfg(target_arch = "x86_64")]
        let narrower = match widest {
            Set::Avx512 => vec![Set::Avx2, Set::Baseline],
            Set::Avx2 => vec![Set::Baseline],
            Set::Baseline => vec![],
        };
        #[cfg(not(target_arch = "x86_64"))]
        let narrower = vec![];
        std::iter::once(widest).chain(narrower).map(Self).collect()
    }

    pub(super) fn set(self) -> Set {
        self.0
    }
}

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
        pub(in crate::engine) fn $name $(<$($generics)*>)? (level: Level, $($argument: $type),*) {
            #[inline(always)]
            #[allow(clippy::too_many_arguments, reason = "rows in and rows out")]
            fn body $(<$($generics)*>)? ($($argument: $type),*) $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt")]
            #[allow(clippy::too_many_arguments, reason = "rows in and rows out")]
            fn avx512 $(<$($generics)*>)? ($($argument: $type),*) {
                body $(::<$($arguments)*>)? ($($argument),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
            #[allow(clippy::too_many_arguments, reason = "rows in and rows out")]
            fn avx2 $(<$($generics)*>)? ($($argument: $type),*) {
                body $(::<$($arguments)*>)? ($($argument),*)
            }

            match level.set() {
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the door to vector instructions")]
                // SAFETY: only `Level::detect` makes a level, and only of instructions that this machine has.
                Set::Avx512 => unsafe { avx512 $(::<$($arguments)*>)? ($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the door to vector instructions")]
                // SAFETY: as above.
                Set::Avx2 => unsafe { avx2 $(::<$($arguments)*>)? ($($argument),*) },
                Set::Baseline => body $(::<$($arguments)*>)? ($($argument),*),
            }
        }
    )*};
}

pub(super) use stages;
