//! How images and patterns lie over texture coordinates.

use crate::json::{Code, Optional, Reader, Span};
use crate::texture::UvMap;

/// The largest factor on texture coordinates, and the largest shift: of sixteen digits, eight are left.
const FARTHEST_UV: f64 = 1e8;

/// The map of the keys `uv_scale`, `uv_matrix` and `uv_offset` of a form at `at`.
pub(super) fn uv_map(
    scale: Option<[f64; 2]>,
    matrix: &Optional<[[f64; 2]; 2]>,
    offset: Option<[f64; 2]>,
    at: Span,
    reader: &mut Reader<'_>,
) -> Option<UvMap> {
    let scaled = UvMap::scaled(scale?, offset?);
    let given = matrix.clone().checked()?;
    let map = UvMap { matrix: given.unwrap_or(scaled.matrix), ..scaled };
    let key = if given.is_some() { "uv_matrix" } else { "uv_scale" };
    for (key, numbers) in [(key, map.matrix.as_flattened()), ("uv_offset", &map.offset[..])] {
        if numbers.iter().any(|v| v.abs() > FARTHEST_UV) {
            let message = format!("{key} is beyond {FARTHEST_UV:e}, where rounding errors are larger than the image");
            reader.error(Code::OutOfRange, at.head(), message);
            return None;
        }
    }
    Some(map)
}
