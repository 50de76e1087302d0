//! Arbitrary bytes as a model of this kind.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| etalon_import_fuzz::import("pbrt", bytes));
