//! The walks, compiled for an instruction set.

use super::best::Best;
use super::start::Start;
use super::{Filters, Job};
use crate::Primitive;
use crate::geometry::{InstanceNode, WideTree};
use crate::query::Query;

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
    /// [`closest_in_instance`](super::instance::closest_in_instance).
    fn closest_in_instance(
        self,
        best: &mut Best,
        instance_node: &InstanceNode,
        primitives: &[Primitive],
        query: &Query,
    ) -> bool;
    /// [`occludes_in_instance`](super::instance::occludes_in_instance).
    fn occludes_in_instance(self, instance_node: &InstanceNode, primitives: &[Primitive], query: &Query) -> bool;
}

/// [`Compiled`] for the token of an instruction set.
#[cfg(target_arch = "x86_64")]
macro_rules! compiled {
    ($set:ident) => {
        compiled! { $set;
            #[inline]
            fn closest[S: Start][S](tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit> = closest_with;
            #[inline]
            fn any[S: Start][S](tree: &WideTree, primitives: &[Primitive], start: S) -> bool = any_with;
            #[inline]
            fn closest_far[S: Start][S](tree: &WideTree, primitives: &[Primitive], start: S) -> Option<S::Hit> = closest_far_with;
            #[inline]
            fn any_far[S: Start][S](tree: &WideTree, primitives: &[Primitive], start: S) -> bool = any_far_with;
            #[inline(never)]
            fn closest_in_instance[][](best: &mut Best, instance_node: &InstanceNode, primitives: &[Primitive], query: &Query) -> bool = closest_in_instance;
            #[inline(never)]
            fn occludes_in_instance[][](instance_node: &InstanceNode, primitives: &[Primitive], query: &Query) -> bool = occludes_in_instance;
        }
    };
    ($set:ident; $(
        #[inline $(($how:ident))?]
        fn $f:ident[$($parameters:tt)*][$($arguments:tt)*]($($x:ident: $t:ty),*) -> $out:ty = $with:ident;
    )*) => {
        impl Compiled for $set {
            $(
                #[inline(always)]
                fn $f<$($parameters)*>(self, $($x: $t),*) -> $out {
                    let filters = self;
                    etalon_simd::call_compiled!($set, self;
                        #[inline $(($how))?] fn compiled[$($parameters)*][$($arguments)*](filters: $set, $($x: $t),*) -> $out {
                            $with(filters, $($x),*)
                        }
                    )
                }
            )*

            #[inline(always)]
            fn run<J: Job>(self, job: J) -> J::Output {
                let filters = self;
                etalon_simd::call_compiled!($set, self;
                    fn compiled[J: Job][J](filters: $set, job: J) -> J::Output { job.run(filters) }
                )
            }
        }
    };
}
#[cfg(target_arch = "x86_64")]
pub(super) use compiled;
