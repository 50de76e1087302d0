//! The plot of a spectrum, as SVG.

use etalon_picture::Attributes;
use etalon_picture::develop::{BandMean, Rect, is_radiance};
use plotters::prelude::*;

/// Width and height, pixels.
const SIZE: (u32, u32) = (720, 440);
const COLOUR: RGBColor = RGBColor(0, 114, 178);

/// The means of bands against their wavelengths, with a bar of one standard error to each side. Means that are not finite are left out.
pub(super) fn svg(name: &str, region: Rect, bands: &[BandMean], attributes: &Attributes) -> Result<String, String> {
    let shown: Vec<&BandMean> = bands.iter().filter(|band| band.mean.is_finite()).collect();
    if shown.is_empty() {
        return Err(format!("the region {region} has no finite value in any band"));
    }
    let place = match region {
        Rect { x, y, width: 1, height: 1 } => format!("pixel {x},{y}"),
        Rect { x, y, width, height } => format!("mean of {width} × {height} pixels from {x},{y}"),
    };
    let unit = if is_radiance(attributes) { "radiance, W/(m² sr nm)" } else { "channel units" };
    draw(&format!("{name}: {place}"), unit, &shown).map_err(|error| error.to_string())
}

/// The error where it can be drawn.
fn error(band: &BandMean) -> f64 {
    band.error.filter(|error| error.is_finite()).unwrap_or(0.0)
}

fn draw(title: &str, unit: &str, bands: &[&BandMean]) -> Result<String, Box<dyn std::error::Error>> {
    let span = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let [first, last] = span(&mut bands.iter().map(|band| band.centre_nm));
    let margin = (0.03 * (last - first)).max(1.0);
    let [low, high] = span(&mut bands.iter().flat_map(|band| [band.mean - error(band), band.mean + error(band)]));
    // From 0, if nothing is below.
    let (low, high) = (low.min(0.0), high.max(0.0));
    let room = if high > low { 0.05 * (high - low) } else { 1.0 };
    let bottom = if low < 0.0 { low - room } else { 0.0 };
    let digits =
        |value: &f64| if *value == 0.0 { "0".to_owned() } else { etalon_picture::develop::short_number(*value) };
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .caption(title, ("sans-serif", 17))
            .margin(10)
            .x_label_area_size(44)
            .y_label_area_size(78)
            .build_cartesian_2d(first - margin..last + margin, bottom..high + room)?;
        chart
            .configure_mesh()
            .x_desc("wavelength, nm")
            .y_desc(format!("{unit}, ± one standard error"))
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.12))
            .x_label_formatter(&digits)
            .y_label_formatter(&digits)
            .draw()?;
        let points = || bands.iter().map(|band| (band.centre_nm, band.mean));
        chart.draw_series(LineSeries::new(points(), COLOUR.mix(0.4).stroke_width(1)))?;
        for band in bands.iter().filter(|band| error(band) > 0.0) {
            let ends = [-1.0, 1.0].map(|side| (band.centre_nm, band.mean + side * error(band)));
            chart.draw_series([PathElement::new(ends, COLOUR.stroke_width(1))])?;
            let cap = |end| EmptyElement::at(end) + PathElement::new([(-3, 0), (3, 0)], COLOUR.stroke_width(1));
            chart.draw_series(ends.map(cap))?;
        }
        chart.draw_series(points().map(|point| Circle::new(point, 3, COLOUR.filled())))?;
        root.present()?;
    }
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PIXEL: Rect = Rect { x: 3, y: 4, width: 1, height: 1 };

    fn band(centre_nm: f64, mean: f64, error: Option<f64>) -> BandMean {
        BandMean { centre_nm, mean, error, left_out: 0 }
    }

    #[test]
    fn every_finite_band_is_a_point_and_every_finite_error_a_bar() {
        let bands = [
            band(400.0, 1.0, Some(0.1)),
            band(500.0, 2.0, Some(f64::INFINITY)),
            band(600.0, f64::NAN, Some(0.1)),
            band(700.0, 3.0, None),
        ];
        let svg = svg("<a&b>.exr", PIXEL, &bands, &Attributes::new()).unwrap();
        assert_eq!(svg.matches("<circle").count(), 3);
        // The line between the points, a bar and its two caps.
        assert_eq!(svg.matches("#0072B2").count(), 3 + 1 + 3, "{svg}");
        assert!(svg.contains("pixel 3,4") && svg.contains("channel units") && !svg.contains("<a&b>"), "{svg}");
    }

    #[test]
    fn spectra_of_any_size_can_be_drawn_and_nothing_cannot() {
        for value in [0.0, -1.0, 1e30, 1e-30] {
            let drawn = svg("x", PIXEL, &[band(550.0, value, Some(0.0))], &Attributes::new()).unwrap();
            assert_eq!(drawn.matches("<circle").count(), 1, "{value}");
        }
        assert!(svg("x", PIXEL, &[band(550.0, f64::NAN, None)], &Attributes::new()).unwrap_err().contains("no finite"));
    }
}
