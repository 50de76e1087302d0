//! Pictures that grow until they are good enough, and what is kept of them.

mod canvas;
mod dark;
mod source_hash;
mod stopping;
mod truths;
