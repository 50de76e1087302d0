//! Materials whose numbers vary over a surface: blends of materials whose numbers do not.
//!
//! A chequerboard says two values of a number. The material is read once with the values of its first fields and once with those of its second
//! fields. Both stand in a blend, whose weight is 0 on the first fields and 1 on the second. So any number may be a chequerboard.
//! An image may say a number that a material is linear in: the material is then a blend of what it is at 0 and at 1, by the image.
//! Each chequerboard or image that lies otherwise doubles the parts of the blend.

use etalon_scene::{MOST_BLEND_PARTS, MOST_WIDTHS, UvMap};
use serde_json::{Value, json};

use super::Walk;
use super::element::Element;
use crate::checker::Checker;
use crate::number::Number;

/// Chequerboards and images that one material is split by at most; further ones become their mean.
const MOST_CHOICES: usize = 4;

/// What tells two materials apart at each place.
#[derive(Clone, Debug, PartialEq)]
enum By {
    /// The fields of a chequerboard that lies so.
    Board(UvMap),
    /// An image of the format: how much there is of the second.
    Image(Value),
}

/// Which of two materials is read, for each chequerboard and image that tells them apart.
#[derive(Debug, Default)]
pub(super) struct Choices {
    made: Vec<(By, bool)>,
    most: usize,
}

impl Choices {
    /// Whether the second is read; of what has not been met before, the first. `None` if there are too many.
    fn choose(&mut self, by: By) -> Option<bool> {
        if let Some((_, second)) = self.made.iter().find(|(known, _)| *known == by) {
            return Some(*second);
        }
        (self.made.len() < self.most).then(|| {
            self.made.push((by, false));
            false
        })
    }
}

impl Walk<'_, '_, '_> {
    /// The material that an element is. It is a blend if its numbers vary over a surface, and no key of the format says so.
    pub(super) fn varying(&mut self, element: &Element, plugin: &str) -> Result<Value, String> {
        let split = self.split(element, plugin, MOST_CHOICES)?;
        let fits = most_parts(&split) <= MOST_BLEND_PARTS;
        let material = if fits { split } else { self.split(element, plugin, 0)? };
        self.builder.spend(&material, &element.place)?;
        Ok(material)
    }

    fn split(&mut self, element: &Element, plugin: &str, most: usize) -> Result<Value, String> {
        self.choices = Choices { made: Vec::new(), most };
        let material = self.each_choice(element, plugin);
        // Shares of masks and blends are images.
        self.choices = Choices::default();
        material
    }

    /// The material of the choices made so far, and a blend by each that reading it adds.
    fn each_choice(&mut self, element: &Element, plugin: &str) -> Result<Value, String> {
        let known = self.choices.made.len();
        let material = self.material(element, plugin)?;
        let Some((by, _)) = self.choices.made.get(known).cloned() else { return Ok(material) };
        let mut part = |second: bool| {
            self.choices.made.truncate(known);
            self.choices.made.push((by.clone(), second));
            self.each_choice(element, plugin)
        };
        let (first, second) = (part(false)?, part(true)?);
        let mut blend = json!({ "type": "blend", "first": first, "second": second });
        let weight = match by {
            By::Board(uv_map) => Checker { colours: [[0.0; 3], [1.0; 3]], uv_map }.numbers(self.builder),
            By::Image(image) => Number::Image(image, 0.5),
        };
        weight.put_weight(&mut blend);
        Ok(blend)
    }

    /// A number by a chequerboard: of a material that is split, that of the fields that are read.
    pub(super) fn field_of(&mut self, board: &Checker) -> Number {
        let [first, second] = board.fields();
        if first == second {
            return Number::Value(first);
        }
        match self.choices.choose(By::Board(board.uv_map)) {
            Some(is_second) => Number::Value(if is_second { second } else { first }),
            None => board.numbers(self.builder),
        }
    }

    /// A number that a material is linear in.
    pub(super) fn linear(&mut self, number: Number, what: &str, place: &str) -> f64 {
        if let Number::Image(image, _) = &number
            && let Some(is_second) = self.choices.choose(By::Image(image.clone()))
        {
            return f64::from(is_second);
        }
        number.mean(what, place, self.builder)
    }
}

/// Materials in a material that are no blends, at most: an image of roughness makes one for each width.
fn most_parts(material: &Value) -> usize {
    match material.get("roughness_image") {
        _ if material["type"] == "blend" => most_parts(&material["first"]) + most_parts(&material["second"]),
        Some(_) => MOST_WIDTHS,
        None => 1,
    }
}
