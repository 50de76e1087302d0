//! Scenes with something changed by chance.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::everything;

/// Places in a JSON value: every value below the root.
pub(crate) fn places(value: &Value, at: String, found: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            for (key, member) in members {
                let path = format!("{at}/{key}");
                found.push(path.clone());
                places(member, path, found);
            }
        }
        Value::Array(elements) => {
            for (i, element) in elements.iter().enumerate() {
                let path = format!("{at}/{i}");
                found.push(path.clone());
                places(element, path, found);
            }
        }
        _ => {}
    }
}

fn wrong_value() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(json!(null)),
        Just(json!(true)),
        Just(json!("grey")),
        Just(json!([])),
        Just(json!({})),
        Just(json!([1, 2, 3])),
        Just(json!([0, 0, 0])),
        Just(json!({ "type": "black" })),
        prop::sample::select(vec![
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            1e300,
            -1e300,
            5e-324,
            1e-300,
            179.999,
            4294967296.0,
            1e16
        ])
        .prop_map(|v| json!(v)),
    ]
}

#[derive(Clone, Debug)]
pub(crate) enum Change {
    Replace(Value),
    Remove,
    Insert(String, Value),
}

pub(crate) fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        4 => wrong_value().prop_map(Change::Replace),
        2 => Just(Change::Remove),
        1 => (prop::sample::select(vec!["radius_m", "type", "comment", "scale", "spp", "nonsense"]), wrong_value())
            .prop_map(|(key, value)| Change::Insert(key.to_owned(), value)),
    ]
}

pub(crate) fn changed(changes: &[(prop::sample::Index, Change)]) -> Value {
    let mut scene = everything();
    for (index, change) in changes {
        let mut all = Vec::new();
        places(&scene, String::new(), &mut all);
        if all.is_empty() {
            break;
        }
        let path = index.get(&all);
        match change {
            Change::Replace(value) => *scene.pointer_mut(path).expect("there") = value.clone(),
            Change::Remove => {
                let (parent, key) = path.rsplit_once('/').expect("a path");
                match scene.pointer_mut(parent).expect("there") {
                    Value::Object(members) => {
                        members.remove(key);
                    }
                    Value::Array(elements) => {
                        elements.remove(key.parse().expect("an index"));
                    }
                    _ => {}
                }
            }
            Change::Insert(key, value) => {
                if let Some(members) = scene.pointer_mut(path).expect("there").as_object_mut() {
                    members.insert(key.clone(), value.clone());
                }
            }
        }
    }
    scene
}
