//! Indices of refraction of Mitsuba.

use super::Walk;
use super::element::Element;

/// Indices of refraction that Mitsuba has names for, as its documentation lists them.
const INDICES: [(&str, f64); 21] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.3330),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.470),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("diamond", 2.419),
];

impl Walk<'_, '_, '_> {
    /// An index of refraction that an element has under a name: a number, or the name of what has it.
    pub(super) fn index(&self, element: &Element, name: &str, default: f64) -> Result<f64, String> {
        let Some(property) = element.property(name) else { return Ok(default) };
        let text = property.attribute("value").unwrap_or("").trim();
        let named = INDICES.iter().find(|(known, _)| known.eq_ignore_ascii_case(text)).map(|(_, index)| *index);
        match named.or_else(|| text.parse().ok()) {
            Some(index) if index > 0.0 && index.is_finite() => Ok(index),
            _ => Err(format!("{}: \"{text}\" is not an index of refraction", property.place)),
        }
    }
}
