//! The walks, compiled for an instruction set.

use super::start::Start;
use super::{Filters, Job};
use crate::Primitive;
use crate::best::Best;
use crate::portal::Portal;
use crate::query::Query;
use crate::wide::WideTree;

/// What is compiled once for each instruction set: functions that a walk begins with, or that are called on it.
pub(super) trait Compiled: Filters {
    /// [`closest_with`](super::closest_with).
    fn closest<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit>;
    /// [`any_with`](super::any_with).
    fn any<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> bool;
    /// Does some work.
    fn run<J: Job>(self, job: J) -> J::Output;
    /// [`closest_far_with`](super::closest_far_with).
    fn closest_far<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit>;
    /// [`any_far_with`](super::any_far_with).
    fn any_far<S: Start>(self, tree: &WideTree, primitives: &[Primitive], start: S) -> bool;
    /// [`closest_within`](super::within::closest_within).
    fn closest_within(self, best: &mut Best, portal: &Portal, primitives: &[Primitive], query: &Query) -> bool;
    /// [`occludes_within`](super::within::occludes_within).
    fn occludes_within(self, portal: &Portal, primitives: &[Primitive], query: &Query) -> bool;
}

/// [`Compiled`] for a token that proves that the processor has some features.
#[cfg(target_arch = "x86_64")]
macro_rules! compiled {
    ($token:ty, $features:literal) => {
        compiled! { $token, $features;
            #[inline]
            fn closest<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit> = closest_with;
            #[inline]
            fn any<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> bool = any_with;
            #[inline]
            fn closest_far<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit> = closest_far_with;
            #[inline]
            fn any_far<S: Start>(tree: &WideTree, primitives: &[Primitive], start: S) -> bool = any_far_with;
            #[inline(never)]
            fn closest_within<>(best: &mut Best, portal: &Portal, primitives: &[Primitive], query: &Query) -> bool = closest_within;
            #[inline(never)]
            fn occludes_within<>(portal: &Portal, primitives: &[Primitive], query: &Query) -> bool = occludes_within;
        }
    };
    ($token:ty, $features:literal; $(
        #[$inline:meta]
        fn $f:ident<$($s:ident: $bound:ident)?>($($x:ident: $t:ty),*) -> $out:ty = $with:ident;
    )*) => {
        impl Compiled for $token {
            $(
                #[inline(always)]
                fn $f<$($s: $bound)?>(self, $($x: $t),*) -> $out {
                    #[target_feature(enable = $features)]
                    #[$inline]
                    fn compiled<$($s: $bound)?>(filters: $token, $($x: $t),*) -> $out {
                        $with(filters, $($x),*)
                    }
                    // SAFETY: the token proves that the processor has these features.
                    unsafe { compiled(self, $($x),*) }
                }
            )*

            #[inline(always)]
            fn run<J: Job>(self, job: J) -> J::Output {
                #[target_feature(enable = $features)]
                fn compiled<J: Job>(filters: $token, job: J) -> J::Output {
                    job.run(filters)
                }
                // SAFETY: as above.
                unsafe { compiled(self, job) }
            }
        }
    };
}
#[cfg(target_arch = "x86_64")]
pub(super) use compiled;
