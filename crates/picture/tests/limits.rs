//! Files that claim more than they hold: refused before memory is taken for it.

use std::io::Cursor;
use std::path::Path;

use etalon_picture::{Picture, check_exr_size, decode_exr, read_png};
use exr::compression::Compression;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::{LineOrder, Text};
use exr::meta::header::LayerAttributes;

/// A file whose pixels are packed by DWA.
fn dwa(compression: Compression, blocks: Blocks, side: usize) -> Vec<u8> {
    let channel = |name: &str, scale: f32| {
        let samples = (0..side * side).map(|i| scale * ((i / 50 % 5) as f32)).collect();
        AnyChannel::new(Text::from(name), FlatSamples::F32(samples))
    };
    let channels = ["R", "G", "B", "A"].into_iter().zip([0.1, 0.2, 0.3, 0.01]).map(|(name, s)| channel(name, s));
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let channels = AnyChannels::sort(channels.collect());
    let layer = Layer::new((side, side), LayerAttributes::default(), encoding, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn decoded(bytes: &[u8]) -> Result<Picture<f32>, String> {
    decode_exr(bytes, Path::new("x.exr")).map(|file| file.picture).map_err(|error| error.with_causes())
}

/// Where the counters of the first chunk begin: the version, 2, as a 64-bit number.
fn counters(bytes: &[u8]) -> usize {
    bytes.windows(8).rposition(|window| window == 2_u64.to_le_bytes()).unwrap()
}

#[test]
fn chunks_of_dwa_that_claim_more_than_their_pixels_are_refused() {
    for (compression, blocks, side) in [
        (Compression::DWAA(None), Blocks::ScanLines, 50),
        (Compression::DWAB(None), Blocks::ScanLines, 50),
        (Compression::DWAA(None), Blocks::Tiles(exr::math::Vec2(32, 32)), 40),
        (Compression::DWAA(None), Blocks::ScanLines, 21),
    ] {
        let good = dwa(compression, blocks, side);
        assert_eq!(decoded(&good).unwrap().width(), side, "{compression:?} {blocks:?}");
        let start = counters(&good);
        for (counter, claim) in [(1, 1_u64 << 40), (6, 1 << 40), (7, 1 << 40), (8, 1 << 40), (8, 1 << 60), (9, 1 << 40)]
        {
            let mut bad = good.clone();
            bad[start + 8 * counter..][..8].copy_from_slice(&claim.to_le_bytes());
            let why = decoded(&bad).unwrap_err();
            assert!(why.contains("values; at most"), "counter {counter}: {why}");
            assert!(check_exr_size(&bad, u64::MAX, u64::MAX).is_err());
        }
    }
}

#[test]
fn damaged_chunks_of_dwa_are_refused_or_decoded() {
    let good = dwa(Compression::DWAA(None), Blocks::ScanLines, 40);
    let start = counters(&good) - 40;
    let mut state = 1_u64;
    for _ in 0..3000 {
        let mut bad = good.clone();
        for _ in 0..3 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = start + (state >> 33) as usize % (good.len() - start);
            bad[at] = (state >> 20) as u8;
        }
        let _ = decoded(&bad);
    }
}

#[test]
fn colour_profiles_and_conversions_of_a_png_are_bounded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let write = |side: u32, profile: usize| {
        let mut bytes = Vec::new();
        let mut info = png::Info::with_size(side, side);
        (info.color_type, info.bit_depth) = (png::ColorType::Grayscale, png::BitDepth::One);
        info.icc_profile = (profile > 0).then(|| vec![0; profile].into());
        let mut writer = png::Encoder::with_info(&mut bytes, info).unwrap().write_header().unwrap();
        writer.write_image_data(&vec![0x5a; (side as usize).div_ceil(8) * side as usize]).unwrap();
        writer.finish().unwrap();
        std::fs::write(&path, bytes).unwrap();
    };
    // A profile is not used, whatever its size.
    write(8, 64 << 20);
    let picture = read_png(&path).unwrap();
    assert_eq!((picture.width(), picture.channels().len()), (8, 3));
    // A bit in the file, a byte decoded, twelve as three channels.
    write(10_000, 0);
    let error = read_png(&path).unwrap_err().with_causes();
    assert!(error.contains("Memory limit"), "{error}");
}
