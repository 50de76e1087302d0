//! Metals that Mitsuba and pbrt know by name. They take other measurements than ours: their gold reflects 7 % more green.

use serde_json::Value;

use crate::table::{Table, metal};

const METALS: &str = include_str!("../data/metals.csv");

/// A metal of the format with the constants that Mitsuba has for a name, mostly a chemical symbol. `X_palik` is X, if it has no numbers of
/// its own.
pub(crate) fn named(name: &str) -> Option<Value> {
    of(name).or_else(|| of(name.strip_suffix("_palik")?))
}

fn of(symbol: &str) -> Option<Value> {
    let rows: Vec<[f64; 3]> = METALS.lines().filter_map(|line| row(line, symbol)).collect();
    let column = |c: usize| Table(rows.iter().map(|row| (row[0], row[c])).collect());
    (!rows.is_empty()).then(|| metal(&column(1), &column(2)))
}

/// Wavelength, n and k of a line, if it is of this metal.
fn row(line: &str, symbol: &str) -> Option<[f64; 3]> {
    let (metal, numbers) = line.split_once(',')?;
    let numbers: Vec<f64> = numbers.split(',').filter_map(|number| number.parse().ok()).collect();
    (metal == symbol).then_some(numbers)?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ((n − 1)² + k²)/((n + 1)² + k²) at the row of a wavelength.
    fn reflectance(metal: &Value, nm: f64) -> f64 {
        let list = |key: &str| -> Vec<f64> {
            metal[key].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
        };
        let at = list("wavelengths_nm").iter().position(|known| (known - nm).abs() < 0.01).unwrap();
        let (n, k) = (list("n")[at], list("k")[at]);
        ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k)
    }

    #[test]
    fn every_metal_is_a_table_of_the_visible_range() {
        // The last two are measured up to 826.5 nm; what is beyond is as there.
        let first = ["Ag", "Al", "Au", "Cr", "Cu", "W", "Na_palik", "a-C", "Ir"].map(|symbol| (symbol, 830.0));
        for (symbol, most_nm) in first.into_iter().chain(["Cu_palik", "TiN"].map(|symbol| (symbol, 826.0))) {
            let metal = named(symbol).unwrap();
            let wavelengths: Vec<f64> =
                metal["wavelengths_nm"].as_array().unwrap().iter().map(|nm| nm.as_f64().unwrap()).collect();
            assert!(wavelengths[0] < 360.0 && wavelengths[wavelengths.len() - 1] > most_nm, "{symbol}");
            assert!(wavelengths.is_sorted_by(|a, b| a < b), "{symbol}");
            assert_eq!([&metal["n"], &metal["k"]].map(|list| list.as_array().unwrap().len()), [wavelengths.len(); 2]);
        }
        let lines = METALS.lines().filter(|line| !line.starts_with('#'));
        assert!(lines.clone().count() == 902 && lines.clone().all(|line| line.split(',').count() == 4));
        assert_eq!(named("Unobtainium"), None);
    }

    /// Gold is yellow, copper red, silver and aluminium neither: what each reflects head-on near 450 and 650 nm, by hand from the rows of
    /// the two wavelengths. The numbers have three digits.
    #[test]
    fn metals_have_their_colours() {
        for (symbol, expected) in
            [("Au", [0.386, 0.941]), ("Cu", [0.553, 0.943]), ("Ag", [0.919, 0.970]), ("Al", [0.924, 0.912])]
        {
            let metal = named(symbol).unwrap();
            let found = [450.852, 652.548].map(|nm| reflectance(&metal, nm));
            assert!((0..2).all(|k| (found[k] - expected[k]).abs() <= 5e-4), "{symbol}: {found:?}");
        }
    }
}
