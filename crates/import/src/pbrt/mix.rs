//! Textures that are mixed, and chequerboards as numbers.

use serde_json::{Value, json};

use super::Reading;
use super::parameters::Parameters;
use crate::checker::{Checker, channels};
use crate::number::Number;
use crate::{reflectance, uv};

/// A chequerboard of the format as one of this program.
fn board(value: &Value) -> Option<Checker> {
    let field = |key: &str| match &value[key] {
        Value::Array(rgb) => Some([0, 1, 2].map(|c: usize| rgb.get(c).and_then(Value::as_f64).unwrap_or(0.0))),
        grey => grey.as_f64().map(|v| [v; 3]),
    };
    let uv_map = uv::of(value.as_object()?)?;
    (value["type"] == "checker").then_some(Checker { colours: [field("first")?, field("second")?], uv_map })
}

/// A share of the second of two colours.
fn between(first: [f64; 3], second: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|c| (1.0 - share) * first[c] + share * second[c])
}

impl Reading<'_, '_> {
    /// The numbers of a texture that is a chequerboard.
    pub(super) fn board_of_numbers(&mut self, name: &str) -> Option<Number> {
        if let Some(known) = self.boards.get(name) {
            return Some(known.clone());
        }
        let numbers = board(self.textures.get(name)?)?.numbers(self.builder);
        self.boards.insert(name.to_owned(), numbers.clone());
        Some(numbers)
    }

    /// The texture `mix`: of two colours by a number or a chequerboard, or of chequerboards that lie alike.
    pub(super) fn mixed(&mut self, list: &Parameters, place: &str) -> Result<Value, String> {
        let mut part =
            |name: &str, default: f64| Ok::<Value, String>(self.value(list, name, true)?.unwrap_or(json!(default)));
        let [first, second, amount] = [part("tex1", 0.0)?, part("tex2", 1.0)?, part("amount", 0.5)?];
        let boards = [&first, &second, &amount].map(board);
        let map = boards.iter().flatten().next().map(|board| board.uv_map);
        let fields = |value: &Value, board: &Option<Checker>| match board {
            Some(board) => (Some(board.uv_map) == map).then_some(board.colours),
            None => channels(value).filter(|_| value["type"].is_null() || value["type"] == "rgb").map(|rgb| [rgb; 2]),
        };
        let found = (fields(&first, &boards[0]), fields(&second, &boards[1]), fields(&amount, &boards[2]));
        let (Some(a), Some(b), Some(shares)) = found else {
            self.builder.approximate(place, "a mix of textures becomes the first of them");
            return Ok(first);
        };
        let mean = |rgb: [f64; 3]| rgb.iter().sum::<f64>() / 3.0;
        let colours = [0, 1].map(|k| between(a[k], b[k], mean(shares[k])));
        let Some(uv_map) = map else { return Ok(reflectance(colours[0])) };
        let made = Checker { colours, uv_map };
        let mut value = made.value();
        value["mean"] = made.mean_reflectance();
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chequerboard_of_the_format_is_read_back() {
        let made = Checker {
            colours: [[0.25; 3], [0.5, 0.75, 1.0]],
            uv_map: etalon_scene::UvMap::scaled([2.0, 3.0], [0.5, 0.0]),
        };
        let read = board(&made.value()).unwrap();
        assert_eq!((read.colours, read.uv_map), (made.colours, made.uv_map));
        assert!(board(&json!({ "type": "image", "uv_scale": [1, 1], "uv_offset": [0, 0] })).is_none());
    }
}
