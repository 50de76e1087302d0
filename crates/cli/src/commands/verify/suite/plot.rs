//! The readings of a suite as a drawing, for its page.

use std::fmt::Write as _;

use super::{Figures, PeerReadings, SuiteCase, deviation, difference};

/// Width of the drawing; lengths are pixels.
const WIDTH: f64 = 960.0;
/// Space on the left and on the right of the panels.
const LEFT: f64 = 64.0;
const RIGHT: f64 = 12.0;
/// Height of a panel.
const PANEL: f64 = 190.0;
/// Tops of the two panels.
const TOPS: [f64; 2] = [66.0, 310.0];
/// Gap between two sections, in points.
const GAP: f64 = 1.5;
/// The largest difference in standard errors that is drawn in its place.
const LARGEST_Z: f64 = 5.0;
/// Ours first, then other renderers.
const COLOURS: [&str; 6] = ["#0b5cad", "#d9822b", "#2d8a4e", "#8a3ea8", "#b03030", "#5b6770"];

/// A panel with values from `−reach` to `reach`.
struct Panel {
    top: f64,
    reach: f64,
}

impl Panel {
    fn y(&self, value: f64) -> f64 {
        self.top + 0.5 * PANEL * (1.0 - (value / self.reach).clamp(-1.0, 1.0))
    }

    /// Its title, and lines at these values.
    fn draw(&self, svg: &mut String, title: &str, ticks: &[f64], unit: &str) {
        let (top, right) = (self.top, WIDTH - RIGHT);
        let _ = writeln!(svg, r##"<text x="{LEFT}" y="{:.1}" font-weight="bold">{title}</text>"##, top - 8.0);
        for &tick in ticks {
            let y = self.y(tick);
            let colour = if tick == 0.0 { "#555" } else { "#ddd" };
            let _ = writeln!(
                svg,
                r##"<path d="M{LEFT} {y:.1}H{right}" stroke="{colour}"/><text x="{:.1}" y="{:.1}" text-anchor="end">{tick}{unit}</text>"##,
                LEFT - 6.0,
                y + 4.0
            );
        }
    }
}

/// The next of 1, 2 and 5 times a power of ten.
fn round_up(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|step| step * power).into_iter().find(|&reach| reach >= value).unwrap_or(10.0 * power)
}

/// Text as it stands in XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// An SVG of the differences from the truth, in standard errors and in percent, point by point.
pub(super) fn plot(title: &str, lines: &[(&SuiteCase, Figures)], peers: &[PeerReadings<'_>]) -> String {
    let mut svg = String::new();
    let height = TOPS[1] + PANEL + 44.0;
    let _ = writeln!(
        svg,
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" font-size="12" fill="#222">
<rect width="{WIDTH}" height="{height}" fill="#fff"/>
<text x="{LEFT}" y="18" font-size="14">{}</text>"##,
        escaped(title)
    );
    // Where each point stands, in points with gaps between sections.
    let mut places = Vec::with_capacity(lines.len());
    let mut sections: Vec<(&str, f64, f64)> = Vec::new();
    let mut place = 0.0;
    for (case, _) in lines {
        match sections.last_mut() {
            Some((name, _, last)) if *name == case.section => *last = place,
            before => {
                place += if before.is_some() { GAP } else { 0.0 };
                sections.push((case.section, place, place));
            }
        }
        places.push(place);
        place += 1.0;
    }
    let x = |place: f64| LEFT + (WIDTH - RIGHT - LEFT) * (place + 0.8) / (places.last().unwrap_or(&0.0) + 1.6);

    let of_peers = |i: usize| peers.iter().map(move |peer| peer.figures.get(&lines[i].0.truth.name));
    let drawn: Vec<(usize, usize, &Figures)> = (0..lines.len())
        .flat_map(|i| {
            std::iter::once(Some(&lines[i].1)).chain(of_peers(i)).enumerate().map(move |(who, read)| (i, who, read))
        })
        .filter_map(|(i, who, read)| Some((i, who, read?)))
        .collect();
    let percent = |figures: &Figures| 100.0 * difference(figures);
    let error = |figures: &Figures| 100.0 * figures.standard_error / figures.truth.abs();
    let reach = drawn
        .iter()
        .filter(|(_, who, _)| *who == 0)
        .map(|(_, _, f)| percent(f).abs() + error(f))
        .filter(|reach| reach.is_finite())
        .fold(1e-6, f64::max);
    let reach = round_up(reach);
    let [z, relative] = [Panel { top: TOPS[0], reach: LARGEST_Z }, Panel { top: TOPS[1], reach }];
    z.draw(
        &mut svg,
        "Difference from the truth, in standard errors; what is larger stands at the edge",
        &[-4.0, -2.0, 0.0, 2.0, 4.0],
        "",
    );
    let ticks = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|part| part * reach);
    relative.draw(
        &mut svg,
        "Difference from the truth, with its standard error; what is larger stands at the edge",
        &ticks,
        " %",
    );
    for (i, who, figures) in drawn {
        let (at, colour) = (x(places[i]), COLOURS[who % COLOURS.len()]);
        let fill = if who == 0 { colour } else { "none" };
        let mut dot = |y: f64| {
            let _ = writeln!(svg, r##"<circle cx="{at:.1}" cy="{y:.1}" r="2.4" fill="{fill}" stroke="{colour}"/>"##);
        };
        if let Some(deviation) = deviation(figures) {
            dot(z.y(deviation));
        }
        let difference = percent(figures);
        // Of what should be 0 there is none.
        if !(difference.is_finite() && error(figures).is_finite()) {
            continue;
        }
        dot(relative.y(difference));
        let [low, high] = [-1.0, 1.0].map(|side| relative.y(difference + side * error(figures)));
        let _ = writeln!(svg, r##"<path d="M{at:.1} {low:.1}V{high:.1}" stroke="{colour}"/>"##);
    }
    for (k, (name, first, last)) in sections.iter().enumerate() {
        let middle = 0.5 * (x(*first) + x(*last));
        // In two rows, because names of small sections would meet.
        let y = TOPS[1] + PANEL + if k % 2 == 0 { 18.0 } else { 34.0 };
        let _ = writeln!(svg, r##"<text x="{middle:.1}" y="{y:.1}" text-anchor="middle">{}</text>"##, escaped(name));
        let (from, to) = (x(first - 0.4), x(last + 0.4));
        let y = TOPS[1] + PANEL + 4.0;
        let _ = writeln!(svg, r##"<path d="M{from:.1} {y:.1}H{to:.1}" stroke="#999"/>"##);
    }
    let names = std::iter::once("Etalon").chain(peers.iter().map(|peer| peer.name));
    // Each name has as much room as its letters need.
    let mut at = LEFT + 6.0;
    for (who, name) in names.enumerate() {
        let colour = COLOURS[who % COLOURS.len()];
        let fill = if who == 0 { colour } else { "none" };
        let _ = writeln!(
            svg,
            r##"<circle cx="{at:.1}" cy="34" r="3" fill="{fill}" stroke="{colour}"/><text x="{:.1}" y="38">{}</text>"##,
            at + 8.0,
            escaped(name)
        );
        at += 34.0 + 7.0 * name.chars().count() as f64;
    }
    svg + "</svg>\n"
}
