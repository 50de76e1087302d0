//! How images and patterns lie over texture coordinates, as keys of the format.

use etalon_scene::UvMap;
use serde_json::{Map, Value, json};

/// States a map in an image or a pattern of the format: by `uv_scale` where it neither turns nor shears, else by `uv_matrix`.
pub(crate) fn put(map: &UvMap, keys: &mut Map<String, Value>) {
    // Without negative zeros.
    let [[a, b], [c, d]] = map.matrix.map(|row| row.map(|factor| factor + 0.0));
    let straight = b == 0.0 && c == 0.0;
    keys.remove(if straight { "uv_matrix" } else { "uv_scale" });
    let (key, value) = if straight { ("uv_scale", json!([a, d])) } else { ("uv_matrix", json!([[a, b], [c, d]])) };
    keys.insert(key.to_owned(), value);
    keys.insert("uv_offset".to_owned(), json!(map.offset.map(|shift| shift + 0.0)));
}

/// The map that an image or a pattern of the format states; `None` of anything else.
pub(crate) fn of(keys: &Map<String, Value>) -> Option<UvMap> {
    let pair = |value: &Value| Some([value[0].as_f64()?, value[1].as_f64()?]);
    let offset = pair(keys.get("uv_offset")?)?;
    match keys.get("uv_matrix") {
        Some(rows) => Some(UvMap { matrix: [pair(&rows[0])?, pair(&rows[1])?], offset }),
        None => Some(UvMap::scaled(pair(keys.get("uv_scale")?)?, offset)),
    }
}

/// The same of an image whose v is counted from above.
pub(crate) fn from_above(map: &UvMap) -> UvMap {
    let ([of_u, [a, b]], [u, v]) = (map.matrix, map.offset);
    UvMap { matrix: [of_u, [-a, -b]], offset: [u, 1.0 - v] }
}

/// The same over texture coordinates whose v is counted from above.
pub(crate) fn over_v_from_above(map: &UvMap) -> UvMap {
    after(map, &UvMap::scaled([1.0, -1.0], [0.0, 1.0]))
}

/// One map after another.
pub(crate) fn after(map: &UvMap, first: &UvMap) -> UvMap {
    let product = |row: usize, column: usize| (0..2).map(|k| map.matrix[row][k] * first.matrix[k][column]).sum();
    UvMap { matrix: [0, 1].map(|row| [0, 1].map(|column| product(row, column))), offset: map.at(first.offset) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURNED: UvMap = UvMap { matrix: [[0.5, -2.0], [3.0, 0.25]], offset: [0.125, 4.0] };

    #[test]
    fn a_map_is_read_as_it_was_put() {
        for map in [TURNED, UvMap::scaled([2.0, -3.0], [0.5, 0.25])] {
            // What another map has left is gone.
            let mut keys = Map::new();
            put(&TURNED, &mut keys);
            put(&map, &mut keys);
            assert_eq!((of(&keys), keys.len()), (Some(map), 2));
        }
        assert_eq!(of(&Map::new()), None);
    }

    #[test]
    fn v_is_counted_from_the_other_side_of_the_image_or_of_the_surface() {
        let uv = [0.375, 0.75];
        let [u, v] = TURNED.at(uv);
        assert_eq!(from_above(&TURNED).at(uv), [u, 1.0 - v]);
        assert_eq!(over_v_from_above(&TURNED).at([uv[0], 1.0 - uv[1]]), [u, v]);
        let first = UvMap { matrix: [[0.0, 0.5], [-2.0, 1.0]], offset: [0.25, -0.5] };
        assert_eq!(after(&TURNED, &first).at(uv), TURNED.at(first.at(uv)));
    }
}
