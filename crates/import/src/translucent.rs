//! Sheets that scatter light to both sides.

use etalon_optics::Spectrum;
use serde_json::{Value, json};

use crate::Builder;
use crate::table::Table;

/// The material of two shares. Where these are known to add up to more than 1 at some wavelength, both are lowered alike.
pub(crate) fn translucent(reflectance: Value, transmittance: Value, place: &str, builder: &mut Builder<'_>) -> Value {
    let mut shares = [reflectance, transmittance];
    if let [Some(reflected), Some(passed)] = [0, 1].map(|i| table(&shares[i])) {
        let most = reflected.0.iter().map(|&(nm, share)| share + passed.at(nm)).fold(0.0, f64::max);
        // Beyond rounding.
        if most > 1.0 + 1e-9 {
            builder.approximate(
                place,
                format!("reflectance and transmittance add up to {most:.3}: both are divided by it"),
            );
            shares = [reflected, passed].map(|share| share.times(1.0 / most).spectrum("clamp"));
        }
    }
    let [reflectance, transmittance] = shares;
    json!({ "type": "translucent", "reflectance": reflectance, "transmittance": transmittance })
}

/// A reflectance times a factor: a number, a colour, a table, an image, a chequerboard or the colours of vertices.
pub(crate) fn scaled(mut value: Value, factor: f64) -> Value {
    if let Some(number) = value.as_f64() {
        return json!(number * factor);
    }
    if let Some(numbers) = value.as_array() {
        return numbers.iter().map(|number| scaled(number.clone(), factor)).collect();
    }
    let keys: &[&str] = match value["type"].as_str() {
        // A tenth of a saturated red may have a spectrum as bright in deep red as the whole: the spectrum is scaled, not the channels.
        Some("rgb") => match table(&value) {
            Some(table) => return table.times(factor).spectrum("clamp"),
            None => &["rgb"],
        },
        Some("tabulated") => &["values"],
        Some("checker") => &["first", "second"],
        Some("image" | "vertex-colours") => &["factor"],
        _ => &[],
    };
    for key in keys {
        let before = value.get(key).cloned().unwrap_or(json!([1.0, 1.0, 1.0]));
        value[*key] = scaled(before, factor);
    }
    value
}

/// The square root of a reflectance that is no image, at each wavelength.
pub(crate) fn root(value: &Value) -> Option<Value> {
    if let Some(number) = value.as_f64() {
        return Some(json!(number.sqrt()));
    }
    if let Some(numbers) = value.as_array() {
        return numbers.iter().map(root).collect();
    }
    if value["type"] == "checker" {
        let mut board = value.clone();
        (board["first"], board["second"]) = (root(&value["first"])?, root(&value["second"])?);
        return Some(board);
    }
    let mut root = table(value)?;
    root.0.iter_mut().for_each(|(_, share)| *share = share.sqrt());
    Some(root.spectrum("clamp"))
}

/// A number, a colour or a table by wavelength.
fn table(value: &Value) -> Option<Table> {
    if let Some(stated) = Table::of_spectrum(value) {
        return Some(Table::of_function(|nm| stated.at(nm)));
    }
    let channel = |c: usize| value["rgb"][c].as_f64();
    let colour = Spectrum::rgb_reflectance([channel(0)?, channel(1)?, channel(2)?]).ok()?;
    Some(Table::of_function(|nm| colour.eval(nm)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_reflectance_is_scaled() {
        for (before, after) in [
            (json!(0.5), json!(0.25)),
            (
                json!({ "type": "tabulated", "values": [1.0, 0.5] }),
                json!({ "type": "tabulated", "values": [0.5, 0.25] }),
            ),
            (json!({ "type": "image" }), json!({ "type": "image", "factor": [0.5, 0.5, 0.5] })),
            (
                json!({ "type": "checker", "first": [1.0, 0.5, 0.0], "second": 0.5 }),
                json!({ "type": "checker", "first": [0.5, 0.25, 0.0], "second": 0.25 }),
            ),
        ] {
            assert_eq!(scaled(before, 0.5), after);
        }
    }

    #[test]
    fn a_root_times_itself_is_the_reflectance() {
        assert_eq!(root(&json!(0.25)), Some(json!(0.5)));
        let board = json!({ "type": "checker", "first": [0.25, 1.0, 0.0], "second": 0.25 });
        assert_eq!(root(&board).unwrap()["first"], json!([0.5, 1.0, 0.0]));
        let green = json!({ "type": "rgb", "rgb": [0.1, 0.6, 0.2] });
        let (whole, part) = (table(&green).unwrap(), table(&root(&green).unwrap()).unwrap());
        assert!([420.0, 550.0, 640.0].iter().all(|nm| (part.at(*nm).powi(2) - whole.at(*nm)).abs() < 1e-12));
        assert_eq!(root(&json!({ "type": "image", "file": "a" })), None);
    }

    /// A saturated red reflects nearly all of deep red, and so does one half as bright: half of its spectrum is not that of half its colour.
    #[test]
    fn a_part_of_a_colour_is_a_part_of_its_spectrum() {
        let red = json!({ "type": "rgb", "rgb": [0.7, 0.1, 0.1] });
        let (whole, half) = (table(&red).unwrap(), table(&scaled(red, 0.5)).unwrap());
        assert!(whole.at(700.0) > 0.9 && whole.0.len() == half.0.len());
        assert!(whole.0.iter().zip(&half.0).all(|(a, b)| (0.5 * a.1 - b.1).abs() < 1e-12));
    }
}
