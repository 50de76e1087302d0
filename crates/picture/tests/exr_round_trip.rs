//! EXR files come back bit for bit, and say what they were told to say.

use std::path::Path;

use etalon_picture::{
    Attribute, Attributes, Chromaticities, Picture, PictureError, RenderInfo, Window, decode_exr, encode_exr, read_exr,
    write_exr,
};
use proptest::prelude::*;

/// Any bit pattern but signalling NaNs, which some instructions quieten on the way.
fn any_f32() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => any::<u32>().prop_map(f32::from_bits),
        1 => prop::sample::select(vec![
            0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, f32::from_bits(1), -f32::from_bits(1), f32::MAX, f32::MIN,
            f32::INFINITY, f32::NEG_INFINITY, f32::NAN,
        ]),
    ]
    .prop_filter("a signalling NaN", |value| !value.is_nan() || value.to_bits() & 0x0040_0000 != 0)
}

fn any_picture() -> impl Strategy<Value = Picture<f32>> {
    let names = prop::collection::btree_set("[A-Za-z][A-Za-z0-9.,_]{0,40}", 1..5);
    (1..40_usize, 1..40_usize, names).prop_flat_map(|(width, height, names)| {
        let channels = prop::collection::vec(prop::collection::vec(any_f32(), width * height), names.len());
        channels.prop_map(move |channels| {
            let mut picture = Picture::new(width, height).unwrap();
            for (name, samples) in names.iter().zip(channels) {
                picture.insert(name, samples).unwrap();
            }
            picture
        })
    })
}

fn bits(picture: &Picture<f32>) -> Vec<(&str, Vec<u32>)> {
    let mut channels: Vec<_> = picture
        .channels()
        .iter()
        .map(|channel| (channel.name.as_str(), channel.samples.iter().map(|sample| sample.to_bits()).collect()))
        .collect();
    channels.sort();
    channels
}

fn render_info() -> RenderInfo {
    RenderInfo {
        software: "etalon 0.1.0".to_owned(),
        render_time_s: 12.5,
        samples_per_pixel: 256,
        seed: u64::MAX,
        scene_sha256: "ab".repeat(32),
        plan_json: r#"{"effects":[{"effect":"dispersion","by":"prisme à λ"}]}"#.to_owned(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn every_sample_comes_back_bit_for_bit_nan_infinity_and_subnormals_too(picture in any_picture()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.exr");
        write_exr(&path, &picture, &Attributes::new()).unwrap();
        let file = read_exr(&path).unwrap();
        prop_assert_eq!(bits(&file.picture), bits(&picture));
        prop_assert_eq!(file.picture.window(), picture.window());
        prop_assert_eq!(file.attributes, Attributes::new());
    }

    #[test]
    fn attributes_of_every_type_come_back(
        text in "\\PC{0,60}", int in any::<i32>(), float in -1e30..1e30_f32, double in -1e300..1e300_f64,
        matrix in any::<[i16; 16]>(), bytes in prop::collection::vec(any::<u8>(), 0..50),
    ) {
        let attributes: Attributes = [
            ("aText", Attribute::Text(text)),
            ("anInt", Attribute::Int(int)),
            ("aFloat", Attribute::Float(float)),
            ("aDouble", Attribute::Double(double)),
            ("aPair", Attribute::Vec2([float, 1.0])),
            ("aTriple", Attribute::Vec3([float, 1.0, 2.0])),
            ("worldToCamera", Attribute::Matrix4(matrix.map(f32::from))),
            ("ourMatrix", Attribute::Matrix4(matrix.map(f32::from))),
            ("aNameLongerThanThirtyOneBytesWhichOldReadersDislike", Attribute::Int(1)),
            ("aKindOfItsOwn", Attribute::Other { kind: "etalonBlob".to_owned(), bytes }),
        ].into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.exr");
        let picture = Picture::from_rgb(1, 1, &[[0.0_f32; 3]]).unwrap();
        write_exr(&path, &picture, &attributes).unwrap();
        prop_assert_eq!(read_exr(&path).unwrap().attributes, attributes);
    }

    #[test]
    fn doubles_are_stored_as_the_nearest_float(values in prop::collection::vec(any::<f64>(), 3)) {
        let pixel = [values[0], values[1], values[2]];
        let wide = encode_exr(&Picture::from_rgb(1, 1, &[pixel]).unwrap(), &Attributes::new()).unwrap();
        let narrow = encode_exr(&Picture::from_rgb(1, 1, &[pixel.map(|x| x as f32)]).unwrap(), &Attributes::new());
        prop_assert_eq!(wide, narrow.unwrap());
    }
}

#[test]
fn a_render_describes_itself() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("render.exr");
    let picture = Picture::from_rgb(2, 1, &[[0.1_f32, 0.2, 0.3], [0.4, 0.5, 0.6]]).unwrap();
    write_exr(&path, &picture, &render_info().attributes().unwrap()).unwrap();
    let file = read_exr(&path).unwrap();
    assert_eq!(RenderInfo::from_attributes(&file.attributes), Some(render_info()));
    // ITU-R BT.709-6, written out here once more.
    let rec_709 = Chromaticities { red: [0.64, 0.33], green: [0.3, 0.6], blue: [0.15, 0.06], white: [0.3127, 0.329] };
    assert_eq!(file.attributes["chromaticities"], Attribute::Chromaticities(rec_709));
    assert_eq!(file.attributes["renderTimeSeconds"], Attribute::Float(12.5));
    assert_eq!(file.attributes["samplesPerPixel"], Attribute::Int(256));
    assert_eq!(file.attributes["seed"], Attribute::Text("18446744073709551615".to_owned()));
}

#[test]
fn the_same_picture_gives_the_same_bytes_with_any_number_of_threads() {
    let pixels: Vec<[f32; 3]> = (0..200 * 150).map(|i| [i as f32, (i * i) as f32, 1.0 / (1 + i) as f32]).collect();
    let picture = Picture::from_rgb(200, 150, &pixels).unwrap();
    let mut attributes = render_info().attributes().unwrap();
    for index in 0..20 {
        attributes.insert(format!("extra{index}"), Attribute::Int(index));
    }
    let first = encode_exr(&picture, &attributes).unwrap();
    for _ in 0..8 {
        assert!(encode_exr(&picture, &attributes).unwrap() == first);
    }
    let header = String::from_utf8_lossy(&first[..2000]).into_owned();
    let place = |name: &str| header.find(name).unwrap();
    assert!(place("chromaticities") < place("extra0") && place("extra0") < place("samplesPerPixel"));
}

#[test]
fn a_crop_keeps_its_place_in_the_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("crop.exr");
    let window = Window { origin_px: [100, -3], frame_px: [640, 480] };
    let picture = Picture::from_rgb(3, 5, &[[0.5_f32; 3]; 15]).unwrap().in_frame(window).unwrap();
    write_exr(&path, &picture, &Attributes::new()).unwrap();
    assert_eq!(read_exr(&path).unwrap().picture, {
        // Channels are read in the order of their names.
        let mut by_name = Picture::new(3, 5).unwrap().in_frame(window).unwrap();
        for name in ["B", "G", "R"] {
            by_name.insert(name, vec![0.5; 15]).unwrap();
        }
        by_name
    });
}

#[test]
fn what_exr_cannot_hold_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.exr");
    let picture = Picture::from_rgb(1, 1, &[[0.0_f32; 3]]).unwrap();
    for (name, value) in [
        ("channels", Attribute::Int(1)),
        ("software", Attribute::Int(1)),
        ("", Attribute::Int(1)),
        ("nul\0", Attribute::Int(1)),
        ("kindless", Attribute::Other { kind: String::new(), bytes: Vec::new() }),
    ] {
        let attributes = Attributes::from([(name.to_owned(), value)]);
        let error = write_exr(&path, &picture, &attributes).unwrap_err();
        assert!(matches!(&error, PictureError::BadAttribute { name: named, .. } if named == name), "{error}");
    }
    let empty = Picture::<f32>::new(1, 1).unwrap();
    assert!(write_exr(&path, &empty, &Attributes::new()).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn pictures_refuse_what_is_not_a_picture() {
    assert!(matches!(Picture::<f32>::new(0, 5), Err(PictureError::BadSize { .. })));
    assert!(matches!(Picture::<f32>::new(5, usize::MAX), Err(PictureError::BadSize { .. })));
    assert!(matches!(Picture::from_rgb(2, 2, &[[0.0_f32; 3]; 3]), Err(PictureError::ChannelLength { .. })));
    let mut picture = Picture::from_rgb(1, 1, &[[0.0_f32; 3]]).unwrap();
    for name in ["R", "", "nul\0", &"x".repeat(256)] {
        assert!(matches!(picture.insert(name, vec![0.0]), Err(PictureError::ChannelName { .. })), "{name}");
    }
}

#[test]
fn reading_names_the_file_and_the_cause() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("no.exr");
    let error = read_exr(&path).unwrap_err();
    assert!(error.with_causes().contains("no.exr`: No such file"), "{}", error.with_causes());
    std::fs::write(&path, "not an exr file at all").unwrap();
    let error = read_exr(&path).unwrap_err();
    assert!(error.with_causes().starts_with("cannot read the EXR file"), "{}", error.with_causes());
}

#[test]
fn a_truncated_file_is_an_error_wherever_it_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.exr");
    let picture = Picture::from_rgb(20, 20, &[[0.25_f32, 0.5, 1e-3]; 400]).unwrap();
    let whole = encode_exr(&picture, &render_info().attributes().unwrap()).unwrap();
    for length in (0..whole.len()).step_by(7) {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(read_exr(Path::new(&path)).is_err(), "{length} of {} bytes were enough", whole.len());
    }
}

/// Where the data window stands in a file, so that one can be written whose few bytes claim any number of pixels.
fn claiming(picture: &Picture<f32>, last: [i32; 2]) -> Vec<u8> {
    let mut bytes = encode_exr(picture, &render_info().attributes().unwrap()).unwrap();
    let key = b"dataWindow\0box2i\0";
    // Behind the key stand the value's size and its first corner.
    let place = bytes.windows(key.len()).position(|window| window == key).unwrap() + key.len() + 12;
    for (k, last) in last.into_iter().enumerate() {
        bytes[place + 4 * k..place + 4 * k + 4].copy_from_slice(&last.to_le_bytes());
    }
    bytes
}

#[test]
fn a_few_bytes_cannot_claim_memory_for_pixels_that_they_do_not_hold() {
    let picture = Picture::from_rgb(20, 20, &[[0.25_f32, 0.5, 1e-3]; 400]).unwrap();
    let path = Path::new("claims.exr");
    assert_eq!(decode_exr(&claiming(&picture, [19, 19]), path).unwrap().picture.width(), 20);
    for last in [[1 << 29, 0], [0, 1 << 29], [1 << 29, 1 << 29], [1 << 14, 1 << 14]] {
        let error = decode_exr(&claiming(&picture, last), path).unwrap_err().with_causes();
        let [width, height] = last.map(|v| v + 1);
        assert!(error.contains("claims.exr") && error.contains(&format!("{width} × {height} pixels")), "{error}");
    }
}
