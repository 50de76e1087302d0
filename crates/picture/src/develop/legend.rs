//! A colour bar with numbers beside a picture.

use super::false_colour::{ColourScale, NOT_FINITE, short_number};
use super::glyphs::{GLYPH, text_pixels, text_width};
use super::palette::palette;
use crate::Rgb8;

const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [0; 3];

/// Space around everything, pixels of a legend at its smallest size.
const MARGIN: usize = 6;
/// Width of the bar.
const BAR: usize = 14;
/// Length of a tick.
const TICK: usize = 3;
/// Least height of the bar.
const LEAST_BAR: usize = 90;

/// Height of a picture, pixels, for which the legend has its smallest size. It grows by whole numbers with the picture.
const SMALLEST_FOR: usize = 320;

/// The same picture on white paper, with a line of text above it and, to its right, the colour bar of a scale with numbers. Where
/// `not_finite` is set, a square in the colour of values that are not finite stands under the bar.
///
/// ```
/// use etalon_picture::Rgb8;
/// use etalon_picture::develop::{Axis, ColourScale, with_legend};
///
/// let picture = Rgb8 { width: 2, height: 1, pixels: vec![9, 8, 7, 6, 5, 4] };
/// let scale = ColourScale::new(Axis::Linear, [0.0, 1.0])?;
/// let page = with_legend(&picture, &scale, "channel units", false);
/// assert!(page.width > 2 && page.height > 90);
/// # Ok::<(), String>(())
/// ```
#[must_use]
pub fn with_legend(picture: &Rgb8, scale: &ColourScale, title: &str, not_finite: bool) -> Rgb8 {
    let k = (picture.height / SMALLEST_FOR).clamp(1, 16);
    let ticks: Vec<(f64, String)> = scale.ticks().into_iter().map(|tick| (tick, short_number(tick))).collect();
    let note = if not_finite { "not finite" } else { "" };
    let label_width = ticks.iter().map(|(_, label)| text_width(label)).max().unwrap_or(0);
    let beside = (BAR + TICK + 2 + label_width).max(if not_finite { GLYPH[1] + 3 + text_width(note) } else { 0 });

    let top = k * (2 * MARGIN + GLYPH[1]);
    let left = k * MARGIN;
    let bar_left = left + picture.width + k * MARGIN;
    let foot = if not_finite { k * (GLYPH[1] + MARGIN) } else { 0 };
    let body = picture.height.max(k * LEAST_BAR + foot);
    let width = (bar_left + k * (beside + MARGIN)).max(k * (2 * MARGIN + text_width(title)));
    let height = top + body + k * MARGIN;
    let mut page = Page::new(width, height);

    page.text(left, k * MARGIN, k, title);
    for (row, pixels) in picture.pixels.chunks_exact(3 * picture.width).enumerate() {
        let start = 3 * ((top + row) * width + left);
        page.image.pixels[start..start + pixels.len()].copy_from_slice(pixels);
    }
    let bar = body - foot;
    for row in 0..bar {
        let place = 1.0 - row as f64 / (bar - 1) as f64;
        page.fill([bar_left, top + row], [k * BAR, 1], palette(place));
    }
    // Labels stay within the bar's height and apart from each other; the first and last ticks come first.
    let mut free: Vec<usize> = Vec::new();
    let order = (0..ticks.len()).filter(|i| *i == 0 || i + 1 == ticks.len()).chain(1..ticks.len().max(2) - 1);
    for (value, label) in order.map(|i| &ticks[i]) {
        let y = ((1.0 - scale.place(*value)) * (bar - 1) as f64).round() as usize;
        page.fill([bar_left + k * BAR, top + y.min(bar - k)], [k * TICK, k], INK);
        let text = y.saturating_sub(k * GLYPH[1] / 2).min(bar - k * GLYPH[1]);
        if free.iter().all(|other| text.abs_diff(*other) >= k * (GLYPH[1] + 2)) {
            page.text(bar_left + k * (BAR + TICK + 2), top + text, k, label);
            free.push(text);
        }
    }
    if not_finite {
        let y = top + bar + k * MARGIN;
        page.fill([bar_left, y], [k * GLYPH[1]; 2], NOT_FINITE);
        page.text(bar_left + k * (GLYPH[1] + 3), y, k, note);
    }
    page.image
}

/// Paper to draw on.
struct Page {
    image: Rgb8,
}

impl Page {
    fn new(width: usize, height: usize) -> Self {
        Self { image: Rgb8 { width, height, pixels: PAPER.repeat(width * height) } }
    }

    /// Fills a rectangle from its top left; what lies outside is not drawn.
    fn fill(&mut self, [x, y]: [usize; 2], [width, height]: [usize; 2], colour: [u8; 3]) {
        for row in y..(y + height).min(self.image.height) {
            for column in x..(x + width).min(self.image.width) {
                let start = 3 * (row * self.image.width + column);
                self.image.pixels[start..start + 3].copy_from_slice(&colour);
            }
        }
    }

    /// A line of text in letters of k times their size.
    fn text(&mut self, x: usize, y: usize, k: usize, text: &str) {
        for [column, row] in text_pixels(text) {
            self.fill([x + k * column, y + k * row], [k, k], INK);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::develop::Axis;

    fn pixel(image: &Rgb8, x: usize, y: usize) -> [u8; 3] {
        let start = 3 * (y * image.width + x);
        image.pixels[start..start + 3].try_into().unwrap()
    }

    #[test]
    fn the_picture_is_on_the_page_as_it_is_beside_the_whole_palette() {
        for (width, height) in [(1, 1), (3, 200), (500, 2), (40, 700)] {
            let pixels: Vec<u8> = (0..3 * width * height).map(|i| (i % 251) as u8).collect();
            let picture = Rgb8 { width, height, pixels };
            let scale = ColourScale::new(Axis::Log, [0.01, 100.0]).unwrap();
            let page = with_legend(&picture, &scale, "luminance, cd/m²", true);
            assert_eq!(page.pixels.len(), 3 * page.width * page.height);
            let k = (height / 320).max(1);
            let [left, top] = [k * MARGIN, k * (2 * MARGIN + GLYPH[1])];
            for (x, y) in [(0, 0), (width - 1, height - 1), (width / 2, height / 2)] {
                assert_eq!(pixel(&page, left + x, top + y), pixel(&picture, x, y));
            }
            let bar: Vec<[u8; 3]> = (0..page.height).map(|y| pixel(&page, left + width + k * MARGIN + 1, y)).collect();
            let bright = bar.iter().position(|colour| *colour == palette(1.0)).expect("the bright end is there");
            let dark = bar.iter().rposition(|colour| *colour == palette(0.0)).expect("the dark end is there");
            assert!(bright < dark && dark - bright >= 60, "{bright} {dark}");
            assert!(page.pixels.chunks_exact(3).any(|colour| colour == NOT_FINITE) || (width, height) == (500, 2));
            assert!(page.pixels.chunks_exact(3).any(|colour| colour == INK));
        }
    }

    #[test]
    fn the_square_of_what_is_not_finite_is_there_only_where_it_is_needed() {
        let picture = Rgb8 { width: 4, height: 4, pixels: vec![7; 48] };
        let scale = ColourScale::new(Axis::Linear, [0.0, 1.0]).unwrap();
        for not_finite in [false, true] {
            let page = with_legend(&picture, &scale, "x", not_finite);
            assert_eq!(page.pixels.chunks_exact(3).any(|colour| colour == NOT_FINITE), not_finite);
        }
    }
}
