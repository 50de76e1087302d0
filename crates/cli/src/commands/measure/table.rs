//! Readings for people (a table), for spreadsheets (CSV) and for programs (JSON).

use std::fmt::Write as _;

use etalon::{METER_REPLICATES, Measured, Measurement, Reading};
use etalon_optics::colour::LUMINOUS_EFFICACY;
use etalon_scene::{MeterQuantity, Scene};
use serde::Serialize;

/// Rows of a grid that the table for people shows; files have all.
const ROWS_SHOWN: usize = 40;

/// All readings of a scene.
#[derive(Serialize)]
pub(super) struct Readings {
    scene: String,
    scene_sha256: String,
    /// Samples of each reading.
    samples: u32,
    /// Independent replicates, whose scatter the standard errors are.
    replicates: u32,
    /// Whether the error that was asked for is reached.
    reached: bool,
    /// Wavelengths that radiometric readings are over, nm.
    wavelength_range_nm: [f64; 2],
    /// lm/W.
    luminous_efficacy: f64,
    readings: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    meter: String,
    /// Column and row of the cell of a grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    cell: Option<[u32; 2]>,
    position_m: [f64; 3],
    quantity: &'static str,
    radiometric: Number,
    photometric: Number,
}

#[derive(Serialize)]
struct Number {
    value: f64,
    standard_error: f64,
    unit: &'static str,
}

impl Number {
    fn new(Measured { value, error }: Measured, unit: &'static str) -> Self {
        Self { value, standard_error: error, unit }
    }
}

impl Readings {
    pub(super) fn new(file: &str, sha256: &str, scene: &Scene, measurement: &Measurement) -> Self {
        let row = |reading: &Reading| {
            let meter = &scene.meters[reading.meter];
            let (quantity, units) = match meter.kind.quantity() {
                MeterQuantity::Irradiance => ("irradiance", ["W/m2", "lx"]),
                MeterQuantity::Flux => ("flux", ["W", "lm"]),
                MeterQuantity::Radiance => ("radiance", ["W/(m2 sr)", "cd/m2"]),
            };
            Row {
                meter: meter.name.clone(),
                cell: (meter.kind.reading_count() > 1).then_some(reading.cell),
                position_m: reading.position_m,
                quantity,
                radiometric: Number::new(reading.radiometric, units[0]),
                photometric: Number::new(reading.photometric, units[1]),
            }
        };
        Self {
            scene: file.to_owned(),
            scene_sha256: sha256.to_owned(),
            samples: measurement.samples,
            replicates: METER_REPLICATES,
            reached: measurement.reached,
            wavelength_range_nm: scene.integrator.wavelength_range_nm,
            luminous_efficacy: LUMINOUS_EFFICACY,
            readings: measurement.readings.iter().map(row).collect(),
        }
    }

    pub(super) fn json(&self) -> String {
        serde_json::to_string_pretty(self).expect("readings are plain data with text keys")
    }

    /// The table for people.
    pub(super) fn table(&self) -> String {
        let name = |row: &Row| match row.cell {
            Some([column, line]) => format!("{} [{column}, {line}]", row.meter),
            None => row.meter.clone(),
        };
        let width = self.readings.iter().map(|row| name(row).chars().count()).max().unwrap_or(0).max(5);
        let mut text = format!("{:width$}  {:>26}             {:>26}\n", "meter", "radiometric", "photometric");
        for row in self.readings.iter().take(ROWS_SHOWN) {
            let number = |n: &Number| format!("{:>26} {:11}", with_error(n.value, n.standard_error), n.unit);
            let line = format!("{:width$}  {} {}", name(row), number(&row.radiometric), number(&row.photometric));
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{}", line.trim_end());
        }
        if self.readings.len() > ROWS_SHOWN {
            let _ = writeln!(text, "… and {} more, which -o writes to a file", self.readings.len() - ROWS_SHOWN);
        }
        let [first, last] = self.wavelength_range_nm;
        let _ = write!(
            text,
            "\n{} samples of each reading. A standard error follows each number: the scatter of {} replicates.\n\
             Radiometric: {first} to {last} nm. Photometric: CIE 1931 2° observer, {LUMINOUS_EFFICACY} lm/W.",
            self.samples, self.replicates
        );
        text
    }
}

/// Most digits of a number: readings without noise still differ from the sums of CIE 15 by 2·10⁻⁸, since the film integrates the observer
/// by the trapezoid rule.
const MOST_DIGITS: f64 = 7.0;

/// A number and its error, with two digits of the error.
fn with_error(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite()) {
        return format!("{} ± {error}", digits(value, 6));
    }
    let exponent = |x: f64| x.abs().log10().floor();
    let last = exponent(error) - 1.0;
    let count = if value == 0.0 { 2.0 } else { exponent(value) - last + 1.0 };
    format!("{} ± {}", digits(value, count.clamp(2.0, MOST_DIGITS) as usize), digits(error, 2))
}

/// A number with `count` significant digits.
fn digits(value: f64, count: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..9).contains(&exponent) {
        let decimals = (count as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.*e}", count - 1)
    }
}

/// One line a reading. Numbers have every digit.
pub(super) fn csv(readings: &Readings) -> String {
    let mut text = "meter,column,row,x_m,y_m,z_m,quantity,radiometric,radiometric_error,radiometric_unit,\
                    photometric,photometric_error,photometric_unit,samples\n"
        .to_owned();
    for row in &readings.readings {
        let [column, line] = row.cell.unwrap_or_default();
        let [x, y, z] = row.position_m;
        let (a, b) = (&row.radiometric, &row.photometric);
        let _ = writeln!(
            text,
            "{},{column},{line},{x},{y},{z},{},{},{},{},{},{},{},{}",
            quoted(&row.meter),
            row.quantity,
            a.value,
            a.standard_error,
            a.unit,
            b.value,
            b.standard_error,
            b.unit,
            readings.samples
        );
    }
    text
}

/// A field of a CSV file (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_their_errors_leave() {
        assert_eq!(with_error(1234.5678, 0.123), "1234.57 ± 0.12");
        assert_eq!(with_error(1234.5678, 12.3), "1235 ± 12");
        assert_eq!(with_error(0.0, 0.0), "0 ± 0");
        assert_eq!(with_error(24.999_999_5, 1.9e-15), "25.00000 ± 1.9e-15");
        assert_eq!(with_error(1.5e-7, 2.5e-9), "1.500e-7 ± 2.5e-9");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}
