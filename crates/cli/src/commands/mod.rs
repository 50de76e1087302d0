//! The commands, one a module: a `…Args` for clap, and `pub(crate) fn run(args: …Args) -> Outcome`.

pub(crate) mod compare;
pub(crate) mod completions;
#[cfg(feature = "denoise")]
pub(crate) mod denoise;
pub(crate) mod develop;
pub(crate) mod explain;
pub(crate) mod expose;
pub(crate) mod farm;
pub(crate) mod figures;
pub(crate) mod import;
pub(crate) mod man;
pub(crate) mod measure;
pub(crate) mod merge;
pub(crate) mod quote;
pub(crate) mod render;
pub(crate) mod schema;
pub(crate) mod study;
pub(crate) mod verify;
pub(crate) mod view;
pub(crate) mod whitted;
