//! Arbitrary bytes as a rendered picture, as `compare` and `verify --images` read them.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = etalon_picture::decode_exr(bytes, Path::new("picture.exr"));
});
