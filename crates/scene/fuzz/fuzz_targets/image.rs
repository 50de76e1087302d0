//! Arbitrary bytes as an image: PNG, JPEG, BMP, EXR or HDR.
#![no_main]

use etalon_scene::{Channel, Encoding, Image};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok((image, _)) = Image::decode(bytes, Encoding::Auto) {
        assert!(image.linear_texels().flatten().all(f64::is_finite));
    }
    let _ = Image::decode_data(bytes, Channel::Auto, Encoding::Linear);
    let _ = Image::decode_data(bytes, Channel::Mean, Encoding::Auto);
});
