//! An endlessly looping GIF of a few thousand colours at most, with hardly a visible loss.

use std::collections::BTreeMap;
use std::time::Duration;

use etalon_picture::Rgb8;

/// Colours that a GIF can have.
const PALETTE: usize = 256;

type Color = [u8; 3];

/// Encodes frames of one size, each shown for `frame_time` (in hundredths of a second, as far as GIF can tell).
///
/// All frames share one palette, so that nothing flickers between them.
///
/// # Errors
/// A side above 65,535 pixels, or frames of different sizes.
pub(super) fn encode(frames: &[Rgb8], frame_time: Duration) -> Result<Vec<u8>, gif::EncodingError> {
    let colors = |frame: &Rgb8| -> Vec<Color> { frame.pixels.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect() };
    let side = |pixels: usize| u16::try_from(pixels).map_err(|_| too_large());
    let mut counts = BTreeMap::<Color, usize>::new();
    for color in frames.iter().flat_map(colors) {
        *counts.entry(color).or_default() += 1;
    }
    let (palette, index) = choose_palette(&counts);

    let (width, height) = frames.first().map_or((1, 1), |frame| (frame.width, frame.height));
    let mut bytes = Vec::new();
    let mut encoder = gif::Encoder::new(&mut bytes, side(width)?, side(height)?, palette.as_flattened())?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    for frame in frames {
        let indices: Vec<u8> = colors(frame).iter().map(|color| index[color]).collect();
        let mut encoded = gif::Frame::from_indexed_pixels(side(frame.width)?, side(frame.height)?, indices, None);
        encoded.delay = u16::try_from(frame_time.as_millis() / 10).unwrap_or(u16::MAX);
        encoder.write_frame(&encoded)?;
    }
    drop(encoder);
    Ok(bytes)
}

fn too_large() -> gif::EncodingError {
    std::io::Error::new(std::io::ErrorKind::InvalidInput, "a GIF's sides have at most 65,535 pixels").into()
}

/// A palette, and for each colour the palette's nearest.
///
/// Gonzalez's farthest-point clustering: the commonest colour first, then again and again the colour that the palette so
/// far serves worst. Its largest error is at most twice that of the best possible palette.
fn choose_palette(counts: &BTreeMap<Color, usize>) -> (Vec<Color>, BTreeMap<Color, u8>) {
    let distance2 = |a: Color, b: Color| -> u32 { (0..3).map(|i| u32::from(a[i].abs_diff(b[i])).pow(2)).sum() };
    let mut palette = Vec::with_capacity(PALETTE);
    // Each colour with its nearest entry of the palette and the squared distance to it.
    let mut nearest: BTreeMap<Color, (u8, u32)> = counts.keys().map(|&color| (color, (0, u32::MAX))).collect();
    let mut next = counts.iter().max_by_key(|&(_, count)| count).map(|(&color, _)| color);
    while let Some(chosen) = next.take().filter(|_| palette.len() < PALETTE) {
        for (&color, entry) in &mut nearest {
            let distance2 = distance2(color, chosen);
            if distance2 < entry.1 {
                *entry = (palette.len() as u8, distance2);
            }
        }
        palette.push(chosen);
        let worst = nearest.iter().max_by_key(|&(_, entry)| entry.1).filter(|(_, entry)| entry.1 > 0);
        next = worst.map(|(&color, _)| color);
    }
    (palette, nearest.into_iter().map(|(color, (index, _))| (color, index)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_whitted::{Figure, Settings, render};
    use image::AnimationDecoder;

    fn decode(bytes: &[u8]) -> Vec<image::Frame> {
        let decoder = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(bytes)).unwrap();
        assert!(matches!(decoder.loop_count(), image::metadata::LoopCount::Infinite));
        decoder.into_frames().collect_frames().unwrap()
    }

    #[test]
    fn the_animation_loops_at_40_ms_a_frame_and_no_value_is_off_by_more_than_one_level() {
        let frames: Vec<Rgb8> = Figure::ALL[4..]
            .iter()
            .map(|figure| {
                let film = render(&figure.scene(), &Settings::default());
                Rgb8 { width: film.width as usize, height: film.height as usize, pixels: film.to_rgb8() }
            })
            .collect();
        let decoded = decode(&encode(&frames, Duration::from_millis(40)).unwrap());
        assert_eq!(decoded.len(), 12);
        for (frame, decoded) in frames.iter().zip(&decoded) {
            assert_eq!(decoded.delay().numer_denom_ms(), (40, 1));
            assert_eq!(decoded.buffer().dimensions(), (640, 480));
            let ours = frame.pixels.chunks_exact(3);
            let off = ours.zip(decoded.buffer().pixels()).flat_map(|(a, b)| [0, 1, 2].map(|i| a[i].abs_diff(b.0[i])));
            assert!(off.max().unwrap() <= 1);
        }
    }

    #[test]
    fn up_to_256_colors_are_kept_exactly() {
        for colors in [1_usize, 2, 3, 200, 256] {
            let pixels: Vec<u8> = (0..colors).flat_map(|i| [i as u8, (7 * i) as u8, 255 - i as u8]).collect();
            let frame = Rgb8 { width: colors, height: 1, pixels };
            let decoded = decode(&encode(std::slice::from_ref(&frame), Duration::from_millis(40)).unwrap());
            let rgb: Vec<u8> = decoded[0].buffer().pixels().flat_map(|p| [p.0[0], p.0[1], p.0[2]]).collect();
            assert_eq!(rgb, frame.pixels, "{colors} colours");
        }
    }

    #[test]
    fn a_gif_too_large_is_refused() {
        let frame = Rgb8 { width: 70_000, height: 1, pixels: vec![0; 210_000] };
        assert!(encode(&[frame], Duration::from_millis(40)).is_err());
    }
}
