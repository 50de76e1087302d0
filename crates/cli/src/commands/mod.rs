//! The commands, one a module: an `Args` for clap, and `pub(crate) fn run(args: Args) -> Outcome`.
