//! Files of version 0.x: their names become those of version 3, as Mitsuba 3 reads them.

use super::element::Element;

/// Gives an element and all in it the names of version 3.
pub(super) fn upgrade(element: &mut Element) {
    if element.tag == "lookAt" {
        element.tag = "lookat".to_owned();
    }
    if let Some(name) = element.attribute("name").map(with_underscores) {
        element.set("name", name);
    }
    element.children.iter_mut().for_each(upgrade);
    if element.tag == "bsdf" && matches!(element.plugin(), "diffuse" | "roughdiffuse") {
        let is_long = |child: &&mut Element| child.attribute("name") == Some("diffuse_reflectance");
        element.children.iter_mut().filter(is_long).for_each(|child| child.set("name", "reflectance".to_owned()));
    }
    if element.tag == "texture" {
        scale_coordinates(element);
    }
}

/// `toWorld` and `intIOR` as `to_world` and `int_ior`.
fn with_underscores(name: &str) -> String {
    let mut made = String::with_capacity(name.len() + 4);
    let mut before_is_small = false;
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && before_is_small {
            made.push('_');
        }
        before_is_small = letter.is_ascii_lowercase();
        made.push(letter.to_ascii_lowercase());
    }
    made
}

/// Scales and offsets of texture coordinates become a transform.
fn scale_coordinates(texture: &mut Element) {
    let stated = |name: &str| texture.children.iter().rev().find(|child| child.attribute("name") == Some(name));
    let value = |name: &str, default: &str| {
        stated(name).and_then(|child| child.attribute("value")).unwrap_or(default).to_owned()
    };
    const NAMES: [&str; 4] = ["uscale", "vscale", "uoffset", "voffset"];
    let Some(place) = NAMES.into_iter().find_map(stated).map(|child| child.place.clone()) else { return };
    let steps = [("scale", ["uscale", "vscale"], "1"), ("translate", ["uoffset", "voffset"], "0")];
    let steps = steps.map(|(tag, names, default)| {
        let [u, v] = names.map(|name| value(name, default));
        let third = default.to_owned();
        Element::made(tag, &[("x", u), ("y", v), ("z", third)], Vec::new(), &place)
    });
    let transform = Element::made("transform", &[("name", "to_uv".to_owned())], steps.into(), &place);
    texture.children.retain(|child| !child.attribute("name").is_some_and(|name| NAMES.contains(&name)));
    texture.children.push(transform);
}

#[cfg(test)]
mod tests {
    use super::with_underscores;

    #[test]
    fn names_of_older_files_get_underscores() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("specularReflectance", "specular_reflectance"),
            ("sigmaT", "sigma_t"),
            ("extEta", "ext_eta"),
            ("color0", "color0"),
            ("to_world", "to_world"),
            ("flipTexCoords", "flip_tex_coords"),
        ] {
            assert_eq!(with_underscores(old), new);
        }
    }
}
