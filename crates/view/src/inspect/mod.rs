//! What the page asks about single pixels, and maps of all of them.

pub(crate) mod maps;
pub(crate) mod paths;
pub(crate) mod pixel;
pub(crate) mod spectrum;
