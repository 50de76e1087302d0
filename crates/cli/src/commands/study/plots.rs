//! The plots of a study, as SVG.

use plotters::element::{DynElement, IntoDynElement};
use plotters::prelude::*;

use super::measure::{Row, SceneStudy};

/// Okabe & Ito's colours but for black, which is the baseline's. Most people can tell them apart.
const COLOURS: [RGBColor; 6] = [
    RGBColor(230, 159, 0),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
];

/// Pixels; narrow enough for the labels to be read on a phone.
const SIZE: (u32, u32) = (460, 380);

/// How each choice of a report is drawn: the same in all of its plots. Where colours repeat, the marks differ.
pub(super) struct Styles(Vec<String>);

impl Styles {
    /// Of all choices that have curves, in the order of the plots.
    pub(super) fn of(studies: &[SceneStudy]) -> Self {
        let mut choices: Vec<String> = Vec::new();
        for (_, _, groups) in PLOTS {
            for row in studies.iter().flat_map(|study| &study.rows).filter(|row| is_drawn(row, groups)) {
                if !choices.contains(&row.choice) {
                    choices.push(row.choice.clone());
                }
            }
        }
        Self(choices)
    }

    /// The line of a choice, and the number of its mark.
    fn find(&self, choice: &str) -> (ShapeStyle, usize) {
        match self.0.iter().position(|other| other == choice) {
            None => (BLACK.stroke_width(3), 0),
            Some(place) => (COLOURS[place % COLOURS.len()].stroke_width(2), place / COLOURS.len()),
        }
    }
}

/// An effect that is forced changes no bit of the picture: what it costs stands among the bars.
fn is_drawn(row: &Row, groups: &[&str]) -> bool {
    groups.contains(&row.group) && !row.choice.ends_with(" forced")
}

/// A plot: its name, which is also the stem of its file, and the SVG.
pub(super) struct Plot {
    pub name: String,
    pub svg: String,
}

/// Groups that share a plot of error against time.
const PLOTS: [(&str, &str, &[&str]); 5] = [
    ("numbers", "numbers", &["where samples go", "sampler", "error bars"]),
    ("wavelengths", "wavelengths of a path", &["wavelengths"]),
    ("light", "finding light", &["direct light"]),
    ("depth", "path depth and roulette", &["path depth", "roulette"]),
    ("effects", "effects on and off", &["effects"]),
];

/// All plots of a scene.
pub(super) fn of(study: &SceneStudy, styles: &Styles) -> Result<Vec<Plot>, String> {
    let mut plots = Vec::new();
    for (name, title, groups) in PLOTS {
        let rows: Vec<&Row> = study.rows.iter().filter(|row| is_drawn(row, groups)).collect();
        if !rows.is_empty() {
            let title = format!("{}: {title}", study.scene);
            let svg = curves(&title, &study.rows[0], &rows, styles).map_err(|error| error.to_string())?;
            plots.push(Plot { name: format!("{}-{name}", study.scene), svg });
        }
    }
    let svg = estimates(study).map_err(|error| error.to_string())?;
    plots.push(Plot { name: format!("{}-prices", study.scene), svg });
    Ok(plots)
}

type Drawn<T> = Result<T, Box<dyn std::error::Error>>;

/// Error against time, both logarithmic, a curve a choice.
fn curves(title: &str, baseline: &Row, rows: &[&Row], styles: &Styles) -> Drawn<String> {
    let all: Vec<&Row> = std::iter::once(baseline).chain(rows.iter().copied()).collect();
    let points = |row: &Row| -> Vec<(f64, f64)> {
        let error = |point: &super::measure::Point| point.error.or(point.scatter).filter(|&error| error > 0.0);
        row.points.iter().filter_map(|point| Some((point.seconds.max(1e-6), error(point)?))).collect()
    };
    let everything: Vec<(f64, f64)> = all.iter().flat_map(|row| points(row)).collect();
    let span = |pick: fn(&(f64, f64)) -> f64| {
        let low = everything.iter().map(pick).fold(f64::INFINITY, f64::min);
        let high = everything.iter().map(pick).fold(0.0, f64::max);
        if low.is_finite() { (low / 1.3, high * 1.3) } else { (0.1, 1.0) }
    };
    let ((x0, x1), (y0, y1)) = (span(|p| p.0), span(|p| p.1));
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        // Room at the top for the legend, so that it covers no curve.
        let room = (y1 / y0).powf(0.11 * all.len() as f64 + 0.1);
        let mut chart = ChartBuilder::on(&root)
            .caption(title, ("sans-serif", 17))
            .margin(8)
            .x_label_area_size(42)
            .y_label_area_size(66)
            .build_cartesian_2d(
                (x0..x1).log_scale().with_key_points(ticks(x0, x1)),
                (y0..y1 * room).log_scale().with_key_points(ticks(y0, y1)),
            )?;
        chart
            .configure_mesh()
            .x_labels(12)
            .y_labels(12)
            .x_desc("seconds")
            .y_desc("relative error")
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .light_line_style(BLACK.mix(0.06))
            .bold_line_style(BLACK.mix(0.16))
            .x_label_formatter(&|x| plain(*x))
            .y_label_formatter(&|y| format!("{} %", plain(100.0 * y)))
            .draw()?;
        for row in all {
            let (style, number) = styles.find(&row.choice);
            let line = points(row);
            chart.draw_series(LineSeries::new(line.clone(), style))?.label(row.choice.clone()).legend(move |(x, y)| {
                EmptyElement::at((x, y)) + PathElement::new([(0, 0), (24, 0)], style) + mark(number, (12, 0), style)
            });
            chart.draw_series(line.into_iter().map(|at| EmptyElement::at(at) + mark(number, (0, 0), style)))?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .label_font(("sans-serif", 13))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .draw()?;
        root.present()?;
    }
    Ok(svg)
}

/// A mark at a place, pixels from its element: a disk, a triangle, a cross or a ring.
fn mark<D: DrawingBackend>(number: usize, at: (i32, i32), line: ShapeStyle) -> DynElement<'static, D, (i32, i32)> {
    let (filled, thin) = (line.color.filled(), ShapeStyle { stroke_width: 2, ..line });
    match number % 4 {
        0 => Circle::new(at, 3, filled).into_dyn(),
        1 => TriangleMarker::new(at, 5, filled).into_dyn(),
        2 => Cross::new(at, 4, thin).into_dyn(),
        _ => Circle::new(at, 4, thin).into_dyn(),
    }
}

/// What each effect adds to the time of a sample, and what else a choice costs or saves.
fn estimates(study: &SceneStudy) -> Drawn<String> {
    let bars: Vec<(String, f64)> = study.rows.iter().skip(1).map(cost_estimate).collect();
    let height = 78 + 24 * bars.len() as u32;
    let most = bars.iter().map(|bar| bar.1.abs()).fold(5.0, f64::max);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (SIZE.0, height)).into_drawing_area();
        root.fill(&WHITE)?;
        root.draw(&Text::new(format!("{}: time of a sample", study.scene), (8, 8), ("sans-serif", 17).into_font()))?;
        let beside = "beside that of the scene as it is";
        root.draw(&Text::new(beside, (8, 28), ("sans-serif", 13).into_font()))?;
        let (left, middle, reach) = (200, 310, 95.0);
        root.draw(&PathElement::new(vec![(middle, 50), (middle, height as i32 - 12)], BLACK.mix(0.5)))?;
        for (index, (name, percent)) in bars.iter().enumerate() {
            let y = 56 + 24 * index as i32;
            let end = middle + (reach * percent / most).round() as i32;
            root.draw(&Text::new(name.clone(), (8, y + 2), ("sans-serif", 13).into_font()))?;
            root.draw(&Rectangle::new([(middle.min(end), y), (middle.max(end), y + 16)], BLACK.mix(0.45).filled()))?;
            let at = if *percent > 0.0 { end + 5 } else { middle + 5 };
            root.draw(&Text::new(format!("{percent:+.0} %"), (at.max(left), y + 2), ("sans-serif", 13).into_font()))?;
        }
        root.present()?;
    }
    Ok(svg)
}

fn cost_estimate(row: &Row) -> (String, f64) {
    (row.choice.clone(), 100.0 * (row.relative_cost - 1.0))
}

/// Where a logarithmic axis has ticks: at 1, 2 and 5 times powers of ten, or at these alone where there would be too many.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let steps: &[f64] = if high / low > 1e4 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    decades
        .flat_map(|decade| steps.iter().map(move |step| step * 10.0_f64.powi(decade)))
        .filter(|tick| (low..=high).contains(tick))
        .collect()
}

/// A tick of a logarithmic axis.
fn plain(value: f64) -> String {
    let digits = (-value.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_has_round_ticks_within_its_range() {
        let shown = |low, high| ticks(low, high).into_iter().map(plain).collect::<Vec<_>>();
        assert_eq!(shown(0.03, 0.7), ["0.05", "0.1", "0.2", "0.5"]);
        assert_eq!(shown(0.9, 30.0), ["1", "2", "5", "10", "20"]);
        assert_eq!(shown(1e-3, 99.0), ["0.001", "0.01", "0.1", "1", "10"]);
    }
}
