//! Whole developments.

use super::*;
use crate::{Attribute, Attributes, Chromaticities, encode_srgb8};
use proptest::prelude::*;

fn of_rgb(width: usize, height: usize, pixels: &[[f32; 3]]) -> ExrFile {
    ExrFile { picture: Picture::from_rgb(width, height, pixels).unwrap(), attributes: Attributes::new() }
}

fn ours(mut file: ExrFile) -> ExrFile {
    file.attributes.insert("software".to_owned(), Attribute::Text("etalon 0.1.0".to_owned()));
    file
}

const MAP: Map = Map { error: None, axis: Axis::Log, range: None };

#[test]
fn what_is_not_finite_is_counted_with_its_place_also_where_a_scale_leaves_it_out() {
    let mut pixels = vec![[0.5_f32; 3]; 16];
    pixels[6] = [f32::NAN, 0.5, 0.5];
    pixels[11] = [0.5, f32::INFINITY, 0.5];
    let file = of_rgb(4, 4, &pixels);
    let crop = Some(Rect { x: 1, y: 1, width: 3, height: 3 });
    for settings in [
        Settings { crop, ..Settings::default() },
        Settings { crop, scale: 0.5, ..Settings::default() },
        Settings { crop, map: Some(MAP), ..Settings::default() },
        Settings {
            crop,
            curve: ToneCurve::Agx,
            white_balance: WhiteBalance::Light(White::Daylight(5000)),
            ..Settings::default()
        },
    ] {
        let developed = develop(&file, &settings).unwrap();
        assert_eq!(developed.not_finite, NotFinite { count: 2, first: Some([2, 1]) }, "{settings:?}");
    }
    // Half the size: what is left out does not darken its neighbours.
    let half = develop(&file, &Settings { scale: 0.5, ..Settings::default() }).unwrap();
    assert!(half.image.pixels.iter().all(|level| *level == 188), "{:?}", half.image.pixels);
    // In false colour it has a colour of its own.
    let map = develop(&file, &Settings { map: Some(MAP), ..Settings::default() }).unwrap();
    let squares = map.image.pixels.chunks_exact(3).filter(|p| *p == NOT_FINITE).count();
    assert!(squares >= 2 + 49, "{squares}");
}

#[test]
fn luminance_has_its_unit_where_the_file_says_it() {
    let file = of_rgb(2, 1, &[[1.0; 3], [0.01; 3]]);
    let title_and_range = |file: &ExrFile| match develop(file, &Settings { map: Some(MAP), ..Settings::default() }) {
        Ok(Developed { tone: Tone::Map { title, range, .. }, .. }) => (title, range),
        other => panic!("{other:?}"),
    };
    assert_eq!(title_and_range(&file).0, "luminance, channel units");
    let mut nits = file.clone();
    nits.attributes.insert("whiteLuminance".to_owned(), Attribute::Float(100.0));
    let (title, [low, high]) = title_and_range(&nits);
    assert_eq!(title, "luminance, cd/m²");
    // Of two values the high end is that of rank 0.
    assert!((low - 0.5).abs() < 1e-6 && (high - 2.0).abs() < 1e-5, "{low} {high}");
    let (title, range) = title_and_range(&ours(file));
    assert!(title == "luminance, cd/m²" && range[1] > 1000.0, "{title} {range:?}");
}

#[test]
fn an_error_map_divides_by_the_value_it_belongs_to() {
    let mut file = of_rgb(2, 1, &[[1.0; 3], [4.0; 3]]);
    let settings = |error, range| Settings {
        map: Some(Map { error: Some(error), axis: Axis::Linear, range }),
        ..Settings::default()
    };
    let missing = develop(&file, &settings(ErrorKind::Relative, None)).unwrap_err().to_string();
    assert!(missing.contains("Error.R"), "{missing}");
    for name in ["Error.R", "Error.G", "Error.B"] {
        file.picture.insert(name, vec![0.5, 1.0]).unwrap();
    }
    let file = ours(file);
    for (error, range, says) in [
        (ErrorKind::Relative, [0.25, 0.5], "relative standard error of luminance"),
        (ErrorKind::Absolute, [0.5 * 72_983.5, 72_983.5], "standard error of luminance, cd/m²"),
    ] {
        let developed = develop(&file, &settings(error, Some(range))).unwrap();
        let Tone::Map { title, .. } = &developed.tone else { panic!() };
        assert_eq!(title, says);
        // Both are at an end of the range.
        let page = &developed.image;
        let pixel = |x: usize| &page.pixels[3 * (19 * page.width + 6 + x)..][..3];
        let ends = [palette(0.0), palette(1.0)];
        let [first, second] = if error == ErrorKind::Relative { [1, 0] } else { [0, 1] };
        assert_eq!([pixel(0), pixel(1)], [&ends[first], &ends[second]], "{error:?}");
    }
}

#[test]
fn a_band_is_grey_and_is_named_by_its_centre() {
    let mut picture = Picture::new(2, 1).unwrap();
    picture.insert("S0.540,000000nm", vec![0.25, f32::NAN]).unwrap();
    picture.insert("S0.560,000000nm", vec![0.5, 0.5]).unwrap();
    let file = ExrFile { picture, attributes: Attributes::new() };
    let settings = Settings { band_nm: Some(545.0), exposure: Exposure::Stops(2.0), ..Settings::default() };
    let developed = develop(&file, &settings).unwrap();
    assert_eq!((developed.band_nm, developed.image.pixels), (Some(540.0), vec![255, 255, 255, 0, 0, 0]));
    assert_eq!(developed.not_finite, NotFinite { count: 1, first: Some([1, 0]) });
    let map = develop(&file, &Settings { map: Some(MAP), ..settings }).unwrap();
    assert!(
        matches!(&map.tone, Tone::Map { title, .. } if title == "radiance at 540 nm, channel units"),
        "{:?}",
        map.tone
    );
    assert!(develop(&file, &Settings { band_nm: Some(600.0), ..settings }).is_err());
}

#[test]
fn a_picture_without_light_has_no_automatic_exposure_and_no_range() {
    let file = of_rgb(2, 1, &[[0.0; 3], [f32::NAN; 3]]);
    for settings in [
        Settings { exposure: Exposure::Auto, ..Settings::default() },
        Settings { map: Some(MAP), ..Settings::default() },
    ] {
        let error = develop(&file, &settings).unwrap_err();
        assert!(matches!(error, PictureError::Develop { .. }), "{error}");
    }
}

#[test]
fn values_outside_a_stated_range_are_counted() {
    let file = of_rgb(5, 1, &[[0.1; 3], [1.0; 3], [2.0; 3], [50.0; 3], [f32::INFINITY; 3]]);
    let map = Map { range: Some([0.5, 5.0]), ..MAP };
    let developed = develop(&file, &Settings { map: Some(map), ..Settings::default() }).unwrap();
    assert!(matches!(developed.tone, Tone::Map { below: 1, above: 1, .. }), "{:?}", developed.tone);
    let bad = Map { range: Some([0.0, 5.0]), ..MAP };
    assert!(develop(&file, &Settings { map: Some(bad), ..Settings::default() }).is_err());
}

#[test]
fn automatic_exposure_looks_at_the_part_that_is_shown_and_scale_does_not_change_it() {
    let mut pixels = vec![[0.045_f32; 3]; 32];
    pixels[16..].fill([9.0; 3]);
    let file = of_rgb(4, 8, &pixels);
    let auto = Settings { exposure: Exposure::Auto, ..Settings::default() };
    let ev = |settings: &Settings| match develop(&file, settings).unwrap().tone {
        Tone::Picture { exposure_ev, .. } => exposure_ev,
        Tone::Map { .. } => unreachable!(),
    };
    let crop = Some(Rect { x: 0, y: 0, width: 4, height: 4 });
    assert_eq!(ev(&Settings { crop, ..auto }), 2.0);
    assert_ne!(ev(&auto), 2.0);
    assert_eq!(ev(&Settings { scale: 0.3, ..auto }), ev(&auto));
}

proptest! {
    #[test]
    fn the_default_is_the_plain_conversion_and_a_stop_doubles_the_light(
        pixels in prop::collection::vec(prop::array::uniform3(any::<f32>()), 6),
        stops in -3..3_i32,
    ) {
        let file = of_rgb(3, 2, &pixels);
        let stops = f64::from(stops);
        let plain = encode_srgb8(&file.picture, stops).unwrap();
        let mut rec709 = file.clone();
        rec709.attributes.insert("chromaticities".to_owned(), Attribute::Chromaticities(Chromaticities::REC_709));
        for file in [&file, &rec709] {
            let developed = develop(file, &Settings { exposure: Exposure::Stops(stops), ..Settings::default() }).unwrap();
            prop_assert_eq!(&developed.image, &plain.0);
            prop_assert_eq!(developed.tone, Tone::Picture { exposure_ev: stops, clipping: plain.1 });
        }
        let finite: Vec<[f32; 3]> = pixels.iter().map(|p| p.map(|v| if v.is_finite() { v } else { 0.0 })).collect();
        let doubled: Vec<[f32; 3]> = finite.iter().map(|p| p.map(|v| 2.0 * (v / 4.0))).collect();
        let halved: Vec<[f32; 3]> = finite.iter().map(|p| p.map(|v| v / 4.0)).collect();
        for curve in [ToneCurve::Linear, ToneCurve::Filmic, ToneCurve::Agx] {
            let at = |pixels: &[[f32; 3]], stops| {
                let settings = Settings { exposure: Exposure::Stops(stops), curve, ..Settings::default() };
                develop(&of_rgb(3, 2, pixels), &settings).unwrap().image
            };
            prop_assert_eq!(at(&halved, stops + 1.0), at(&doubled, stops));
        }
    }
}
