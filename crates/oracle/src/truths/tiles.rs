//! Unit squares beside each other, seen from straight above: each shows one thing, and the picture their mean.

use serde_json::{Value, json};

use super::scene::{Scene, parallelogram};

/// The place of one of them, from its lower left corner on.
pub(super) fn tile(at: usize, z: f64) -> Value {
    parallelogram([at as f64, 0.0, z], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
}

/// A view of so many, from a height. Each has four by four pixels of its own.
pub(super) fn row(count: usize, from_m: f64) -> Scene {
    let middle = 0.5 * count as f64;
    Scene::orthographic([middle, 0.5, from_m], [middle, 0.5, 0.0], 1.0).film(4 * count as u32, 4)
}

/// The same with materials on them.
pub(super) fn row_of(materials: &[Value]) -> Scene {
    let place = |scene: Scene, (at, material): (usize, &Value)| {
        scene.thing(json!({ "shape": tile(at, 0.0), "material": material }))
    };
    materials.iter().enumerate().fold(row(materials.len(), 2.0), place)
}

/// An object with some keys of another.
pub(super) fn with(mut object: Value, further: &Value) -> Value {
    for (key, value) in further.as_object().into_iter().flatten() {
        object[key] = value.clone();
    }
    object
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
