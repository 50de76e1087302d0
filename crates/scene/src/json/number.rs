//! Numbers.

use std::ops::Bound;

use serde_json::json;

use super::decode::wrong_type;
use super::{Code, Decode, Kind, Node, Reader, SchemaBuilder};

/// A finite number; errors of syntax in it have been reported by the parser.
fn number(node: Node<'_>, expected: &str, reader: &mut Reader<'_>) -> Option<f64> {
    let Kind::Number(text) = node.kind() else {
        wrong_type(expected, node, reader);
        return None;
    };
    // Only liberties with the grammar do not parse (0x10) or are not decimal (NaN), and those are faults already.
    let value: f64 = text.parse().ok()?;
    if !value.is_finite() {
        if text.contains(|c: char| c.is_ascii_digit()) {
            let message = format!("{text} is too large for a double-precision number");
            reader.error(Code::NotFinite, reader.span(node), message);
        }
        return None;
    }
    Some(value)
}

impl Decode for f64 {
    fn schema(_: &mut SchemaBuilder) -> serde_json::Value {
        json!({ "type": "number" })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        number(node, "a number", reader)
    }
}

/// Decodes a number within bounds; [`number!`](crate::number) makes types of it.
#[doc(hidden)]
pub fn bounded(node: Node<'_>, bounds: (Bound<f64>, Bound<f64>), reader: &mut Reader<'_>) -> Option<f64> {
    let value = number(node, "a number", reader)?;
    let too_small = match bounds.0 {
        Bound::Included(least) => (value < least).then(|| format!("{value} is below {least}")),
        Bound::Excluded(limit) => (value <= limit).then(|| format!("{value} is not above {limit}")),
        Bound::Unbounded => None,
    };
    let too_large = match bounds.1 {
        Bound::Included(most) => (value > most).then(|| format!("{value} is above {most}")),
        Bound::Excluded(limit) => (value >= limit).then(|| format!("{value} is not below {limit}")),
        Bound::Unbounded => None,
    };
    match too_small.or(too_large) {
        Some(message) => {
            reader.error(Code::OutOfRange, reader.span(node), message);
            None
        }
        None => Some(value),
    }
}

/// The schema of a number within bounds.
#[doc(hidden)]
pub fn bounded_schema(bounds: (Bound<f64>, Bound<f64>)) -> serde_json::Value {
    let mut schema = json!({ "type": "number" });
    match bounds.0 {
        Bound::Included(least) => schema["minimum"] = json!(least),
        Bound::Excluded(limit) => schema["exclusiveMinimum"] = json!(limit),
        Bound::Unbounded => {}
    }
    match bounds.1 {
        Bound::Included(most) => schema["maximum"] = json!(most),
        Bound::Excluded(limit) => schema["exclusiveMaximum"] = json!(limit),
        Bound::Unbounded => {}
    }
    schema
}

crate::number! {
    /// A number above 0.
    pub struct Positive in (Bound::Excluded(0.0), Bound::Unbounded);
}

crate::number! {
    /// A number that is 0 or above.
    pub struct NonNegative in (Bound::Included(0.0), Bound::Unbounded);
}

fn integer(node: Node<'_>, least: u64, most: u64, reader: &mut Reader<'_>) -> Option<u64> {
    let value = number(node, "a whole number", reader)?;
    let Kind::Number(text) = node.kind() else { return None };
    let whole = match text.parse::<u64>() {
        Ok(whole) => Some(whole),
        // 1e3 and 64.0 are whole as well, and JSON Schema agrees; from 2⁵³ on a double may not be what was written.
        Err(_) if value.fract() == 0.0 && (0.0..9_007_199_254_740_992.0).contains(&value) => Some(value as u64),
        Err(_) => None,
    };
    match whole {
        Some(whole) if (least..=most).contains(&whole) => Some(whole),
        _ => {
            let message = if value.fract() == 0.0 {
                format!("{text} is not within {least} … {most}")
            } else {
                format!("{text} is not a whole number")
            };
            reader.error(Code::OutOfRange, reader.span(node), message);
            None
        }
    }
}

/// A whole number in `LEAST..=MOST`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whole<const LEAST: u64, const MOST: u64>(pub u64);

impl<const LEAST: u64, const MOST: u64> Decode for Whole<LEAST, MOST> {
    fn schema(_: &mut SchemaBuilder) -> serde_json::Value {
        json!({ "type": "integer", "minimum": LEAST, "maximum": MOST })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        integer(node, LEAST, MOST, reader).map(Self)
    }
}

impl Decode for u32 {
    fn schema(schema: &mut SchemaBuilder) -> serde_json::Value {
        Whole::<0, { u32::MAX as u64 }>::schema(schema)
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        // In range by the bounds just checked.
        integer(node, 0, u32::MAX.into(), reader).map(|whole| whole as Self)
    }
}
