//! The instruction set to use.

#[cfg(target_arch = "x86_64")]
use crate::{Avx2, Avx512};
use std::ffi::OsStr;
use std::sync::OnceLock;

/// The environment variable that names the instruction set to use: `baseline`, `avx2` or `avx512`.
pub const VARIABLE: &str = "ETALON_SIMD";

/// The values of [`VARIABLE`], the narrowest set first.
const NAMES: [&str; 3] = ["baseline", "avx2", "avx512"];

/// An instruction set that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// What every processor of the target has.
    Baseline,
    /// AVX2.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    /// AVX-512.
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

/// What can be wrong with the value of [`VARIABLE`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LevelError {
    /// No instruction set has this name.
    #[error("{VARIABLE}={0}: unknown instruction set; use baseline, avx2 or avx512")]
    Unknown(String),
    /// The processor does not have it.
    #[error("{VARIABLE}={asked}: this processor has {}", available.join(", "))]
    Missing {
        /// The set.
        asked: String,
        /// Those that the processor has.
        available: Vec<&'static str>,
    },
}

impl Level {
    /// All sets that this processor has, the narrowest first. [`VARIABLE`] changes nothing here.
    pub fn available() -> Vec<Self> {
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_mut))]
        let mut all = vec![Self::Baseline];
        #[cfg(target_arch = "x86_64")]
        all.extend(Avx2::detect().map(Self::Avx2));
        #[cfg(target_arch = "x86_64")]
        all.extend(Avx512::detect().map(Self::Avx512));
        all
    }

    /// The set to use: the one that [`VARIABLE`] names, or the widest. The variable is read once.
    pub fn chosen() -> Result<Self, LevelError> {
        static CHOSEN: OnceLock<Result<Level, LevelError>> = OnceLock::new();
        CHOSEN.get_or_init(|| Self::named(std::env::var_os(VARIABLE).as_deref())).clone()
    }

    /// [`Level::chosen`]. Panics if the value of [`VARIABLE`] is wrong: a program asks [`Level::chosen`] first.
    pub fn best() -> Self {
        Self::chosen().unwrap_or_else(|error| panic!("{error}"))
    }

    /// Its name, as a value of [`VARIABLE`].
    pub fn name(self) -> &'static str {
        NAMES[match self {
            Self::Baseline => 0,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => 1,
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => 2,
        }]
    }

    /// The set of this name, or the widest. An empty name is none.
    fn named(name: Option<&OsStr>) -> Result<Self, LevelError> {
        let available = Self::available();
        let Some(name) = name.filter(|name| !name.is_empty()) else {
            return Ok(available[available.len() - 1]);
        };
        match available.iter().find(|level| name == level.name()) {
            Some(&level) => Ok(level),
            None if NAMES.iter().any(|known| name == *known) => Err(LevelError::Missing {
                asked: name.to_string_lossy().into_owned(),
                available: available.into_iter().map(Self::name).collect(),
            }),
            None => Err(LevelError::Unknown(name.to_string_lossy().into_owned())),
        }
    }
}

/// Calls a function whose body is compiled for each [`Level`]: the one for a level. It is written as for
/// [`call_compiled!`](crate::call_compiled).
#[macro_export]
macro_rules! dispatch {
    ($level:expr; fn $name:ident
        $([$($parameters:tt)*][$($arguments:tt)*])? ($($x:ident: $t:ty),* $(,)?) $(-> $out:ty)? $body:block
    ) => {{
        #[inline(always)]
        #[allow(clippy::too_many_arguments, reason = "what the body reads of its surroundings")]
        fn $name $(<$($parameters)*>)? ($($x: $t),*) $(-> $out)? $body

        match $level {
            $crate::Level::Baseline => $name $(::<$($arguments)*>)? ($($x),*),
            #[cfg(target_arch = "x86_64")]
            $crate::Level::Avx2(token) => $crate::call_compiled!(
                Avx2, token; fn avx2 $([$($parameters)*][$($arguments)*])? ($($x: $t),*) $(-> $out)? {
                    $name $(::<$($arguments)*>)? ($($x),*)
                }
            ),
            #[cfg(target_arch = "x86_64")]
            $crate::Level::Avx512(token) => $crate::call_compiled!(
                Avx512, token; fn avx512 $([$($parameters)*][$($arguments)*])? ($($x: $t),*) $(-> $out)? {
                    $name $(::<$($arguments)*>)? ($($x),*)
                }
            ),
        }
    }};
}

#[cfg(test)]
mod tests {
    use super::{Level, LevelError, NAMES};
    #[cfg(target_arch = "x86_64")]
    use crate::with_features;
    use std::ffi::OsStr;

    #[test]
    fn the_variable_names_a_level_and_anything_else_is_an_error() {
        let available = Level::available();
        let named = |name: &str| Level::named(Some(OsStr::new(name)));
        assert_eq!(Level::named(None), Ok(*available.last().unwrap()));
        assert_eq!(named(""), Level::named(None));
        for name in NAMES {
            match available.iter().find(|level| level.name() == name) {
                Some(&level) => assert_eq!(named(name), Ok(level)),
                None => assert!(matches!(named(name), Err(LevelError::Missing { .. })), "{name}"),
            }
        }
        for name in ["sse2", "AVX2", "avx2 ", "1"] {
            assert_eq!(named(name), Err(LevelError::Unknown(name.to_owned())));
        }
    }

    #[test]
    fn a_function_gives_the_same_on_every_level() {
        let squares = |level: Level, count: u32| dispatch!(level; fn squares(count: u32) -> u32 { (0..count).map(|i| i * i).sum() });
        assert!(Level::available().into_iter().all(|level| squares(level, 5) == 30));
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn a_wider_set_has_every_feature_of_the_narrower() {
        let [avx2, avx512]: [&[&str]; 2] = [with_features!(Avx2 => names {}), with_features!(Avx512 => names {})];
        assert!(avx2.iter().all(|feature| avx512.contains(feature)));
    }
}
