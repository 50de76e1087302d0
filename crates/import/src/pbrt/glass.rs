//! Glasses and metals that pbrt knows by name.

use serde_json::{Value, json};

use crate::metals;
use crate::table::{Table, metal};

/// A name, B and C (µm²) of Sellmeier's formula, and the wavelengths for which it holds, nm.
type Glass = (&'static str, [f64; 3], [f64; 3], [f64; 2]);

/// Data sheets of SCHOTT for BAF10, N-FK51A, LASF9, SF5 and SF10.
const GLASSES: [Glass; 5] = [
    (
        "BAF10",
        [1.585_149_5, 0.143_559_385, 1.085_212_69],
        [0.009_266_812_82, 0.042_448_980_5, 105.613_573],
        [350.0, 2500.0],
    ),
    (
        "FK51A",
        [0.971_247_817, 0.216_901_417, 0.904_651_666],
        [0.004_723_019_95, 0.015_357_561_2, 168.681_33],
        [290.0, 2500.0],
    ),
    (
        "LASF9",
        [2.000_295_47, 0.298_926_886, 1.806_918_43],
        [0.012_142_601_7, 0.053_873_623_6, 156.530_829],
        [370.0, 2500.0],
    ),
    (
        "SF5",
        [1.461_418_85, 0.247_713_019, 0.949_995_832],
        [0.011_182_612_6, 0.050_859_466_9, 112.041_888],
        [370.0, 2500.0],
    ),
    (
        "SF10",
        [1.616_259_77, 0.259_229_334, 1.077_623_17],
        [0.012_753_455_9, 0.058_198_395_4, 116.607_68],
        [380.0, 2500.0],
    ),
];

/// The index of a glass by its name in pbrt, which calls the flints F5, F10 and F11.
pub(super) fn glass(name: &str) -> Option<Value> {
    let built_in = |name: &str| json!({ "type": "glass", "name": name, "outside_fit": "clamp" });
    let known = match name.strip_prefix("glass-")? {
        "BK7" => return Some(built_in("N-BK7")),
        "SF11" | "F11" => return Some(built_in("N-SF11")),
        "F5" => "SF5",
        "F10" => "SF10",
        other => other,
    };
    let (_, b, c, range_nm) = GLASSES.iter().find(|(name, ..)| *name == known)?;
    Some(json!({ "type": "sellmeier", "b": b, "c_um2": c, "range_nm": range_nm, "outside_fit": "clamp" }))
}

/// A metal of the format by its name in pbrt without `-eta` or `-k`, and what to say if another stands for it.
pub(super) fn named_metal(name: &str) -> (Value, Option<String>) {
    let symbol = name.strip_prefix("metal-");
    match symbol {
        Some("CuZn") => {
            let copper = metals::named("Cu").unwrap_or_else(aluminium);
            (copper, Some(format!("the metal \"{name}\" (brass) is not known: it becomes copper")))
        }
        Some("MgO") => {
            // Within 0.001 of the index that Stephens and Malitson measured (1952); it absorbs nothing.
            let index = Table::of_function(|nm| 1.7163 + 7330.0 / (nm * nm));
            (metal(&index, &Table::of_function(|_| 0.0)), None)
        }
        _ => match symbol.and_then(metals::named) {
            Some(known) => (known, None),
            None => (aluminium(), Some(format!("the metal \"{name}\" is not known: it becomes aluminium"))),
        },
    }
}

fn aluminium() -> Value {
    json!({ "type": "conductor", "metal": "Al" })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n_d of the data sheets.
    #[test]
    fn glasses_have_the_index_of_their_data_sheets() {
        for (name, expected) in
            [("BAF10", 1.67003), ("FK51A", 1.48656), ("LASF9", 1.85025), ("SF5", 1.67271), ("SF10", 1.72825)]
        {
            let value = glass(&format!("glass-{name}")).unwrap();
            let number = |key: &str, k: usize| value[key][k].as_f64().unwrap();
            let squared = 0.5875618_f64.powi(2);
            let terms = (0..3).map(|k| number("b", k) * squared / (squared - number("c_um2", k)));
            let index = (1.0 + terms.sum::<f64>()).sqrt();
            assert!((index - expected).abs() < 2e-5, "{name}: {index}");
        }
        assert_eq!(glass("glass-F10"), glass("glass-SF10"));
        assert_eq!(glass("glass-none"), None);
    }

    #[test]
    fn what_stands_for_a_metal_is_said() {
        assert_eq!(named_metal("metal-Au").1, None);
        assert_eq!(named_metal("metal-MgO").1, None);
        assert!(named_metal("metal-CuZn").1.unwrap().contains("becomes copper"));
        assert!(named_metal("metal-Xx").1.unwrap().contains("becomes aluminium"));
    }
}
