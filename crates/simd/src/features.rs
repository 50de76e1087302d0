//! The features of each instruction set, and the tokens that prove them.

/// The one list of features: calls a macro with those of a set, and with what follows `=>`.
#[doc(hidden)]
#[macro_export]
macro_rules! with_features {
    (Avx2 => $macro:ident $input:tt) => {
        $crate::$macro! { ["avx2" "bmi1" "bmi2" "lzcnt" "popcnt"] $input }
    };
    (Avx512 => $macro:ident $input:tt) => {
        $crate::$macro! {
            ["avx2" "bmi1" "bmi2" "lzcnt" "popcnt" "avx512f" "avx512bw" "avx512dq" "avx512vl"] $input
        }
    };
}

/// Whether the processor has some features.
#[doc(hidden)]
#[macro_export]
macro_rules! detected {
    ([$($feature:tt)*] {}) => { true $(&& std::arch::is_x86_feature_detected!($feature))* };
}

/// A function that is compiled for some features.
#[doc(hidden)]
#[macro_export]
macro_rules! compiled {
    ([$($feature:tt)*] { $function:item }) => { $(#[target_feature(enable = $feature)])* $function };
}

/// The names of some features.
#[cfg(test)]
#[macro_export]
macro_rules! names {
    ([$($feature:tt)*] {}) => { &[$($feature),*] };
}

/// Proof that the processor has AVX2, with the instructions on bits that came with it. Only [`Avx2::detect`] makes one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Avx2(());

impl Avx2 {
    /// The proof, if the processor has every feature of the set.
    #[inline]
    pub fn detect() -> Option<Self> {
        with_features!(Avx2 => detected {}).then_some(Self(()))
    }
}

/// Proof that the processor has AVX-512 (F, BW, DQ and VL), and AVX2. Only [`Avx512::detect`] makes one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Avx512(Avx2);

impl Avx512 {
    /// The proof, if the processor has every feature of the set.
    #[inline]
    pub fn detect() -> Option<Self> {
        Avx2::detect().filter(|_| with_features!(Avx512 => detected {})).map(Self)
    }

    /// The proof of AVX2.
    #[inline(always)]
    pub fn avx2(self) -> Avx2 {
        self.0
    }
}

impl From<Avx512> for Avx2 {
    #[inline(always)]
    fn from(token: Avx512) -> Self {
        token.avx2()
    }
}

/// Calls a function whose body is compiled for an instruction set, given the token of the set.
///
/// The function takes local variables of the caller, which it names with their types. A generic one states its parameters,
/// and then the same as arguments.
///
/// ```
/// # #[cfg(target_arch = "x86_64")]
/// fn sum<const N: usize>(token: etalon_simd::Avx2, values: &[f32; N]) -> f32 {
///     etalon_simd::call_compiled!(Avx2, token; fn sum[const N: usize][N](values: &[f32; N]) -> f32 {
///         values.iter().sum()
///     })
/// }
/// ```
///
/// The body is safe code: neither what reads through a pointer nor an instruction of another set compiles in it.
///
/// ```compile_fail,E0133
/// # use std::arch::x86_64::{__m512, _mm512_sqrt_ps};
/// fn root(token: etalon_simd::Avx2, v: __m512) -> __m512 {
///     etalon_simd::call_compiled!(Avx2, token; fn root(v: __m512) -> __m512 { _mm512_sqrt_ps(v) })
/// }
/// ```
#[macro_export]
macro_rules! call_compiled {
    ($set:ident, $token:expr; $(#[inline $(($how:ident))?])? fn $name:ident
        $([$($parameters:tt)*][$($arguments:tt)*])? ($($x:ident: $t:ty),* $(,)?) $(-> $out:ty)? $body:block
    ) => {{
        $crate::with_features! { $set => compiled {
            $(#[inline $(($how))?])?
            #[allow(clippy::too_many_arguments, reason = "what the body reads of its surroundings")]
            fn $name $(<$($parameters)*>)? ($($x: $t),*) $(-> $out)? $body
        }}
        let _: $crate::$set = $token;
        // SAFETY: the token proves that the processor has the features of the set. Nothing else about the function is unsafe: it
        // is declared safe, and its body is checked as safe code.
        #[allow(unsafe_code, reason = "the door to code that is compiled for an instruction set")]
        unsafe { $name $(::<$($arguments)*>)? ($($x),*) }
    }};
}
