//! Surfaces whose sides differ.

use super::super::spectra::Spectra;
use super::blend::{Before, MOST_BLEND_PARTS};
use super::{Made, TwoSidedMaterial};
use crate::files::Files;
use crate::json::{Code, Reader};
use crate::model::MaterialKind;

/// What a material, and each part of a blend, is on the side that it is made for.
fn shown(kind: MaterialKind) -> MaterialKind {
    match kind {
        MaterialKind::Blend { parts, by } => {
            MaterialKind::Blend { parts: parts.into_iter().map(|(place, part)| (place, shown(part))).collect(), by }
        }
        MaterialKind::TwoSided { front, back } if *back == MaterialKind::Black => *front,
        MaterialKind::TwoSided { front, back } if *front == MaterialKind::Black => *back,
        kind => kind,
    }
}

/// Whether all light that it does not absorb comes back.
fn is_opaque(kind: &MaterialKind) -> bool {
    kind.parts().into_iter().all(|part| {
        matches!(
            part,
            MaterialKind::Lambert { .. }
                | MaterialKind::Mirror { .. }
                | MaterialKind::Conductor { .. }
                | MaterialKind::RoughConductor { .. }
                | MaterialKind::OrenNayar { .. }
                | MaterialKind::Plastic { .. }
                | MaterialKind::Fluorescent { .. }
                | MaterialKind::Measured { .. }
                | MaterialKind::Principled { .. }
                | MaterialKind::Black
        )
    })
}

/// The material of the form.
pub(super) fn two_sided<'f>(
    form: &'f TwoSidedMaterial,
    before: &Before<'_>,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    let mut side = |side| before.material(side, spectra, files, reader);
    let (front, back) = (form.front.as_deref().and_then(&mut side), form.back.as_deref().and_then(&mut side));
    let (front, back) = (front?, back?);
    let at = form.at.head();
    if [&front, &back].iter().any(|side| side.medium.is_some() || side.exterior_medium.is_some()) {
        let message = "a side of a two-sided material cannot have an absorption or a medium";
        reader.error_hint(Code::KeyConflict, at, message, "put the two-sided material into a \"filled\" one");
        return None;
    }
    let [front, back] = [front, back].map(|Made { kind, .. }| shown(kind));
    for (name, side) in [("front", &front), ("back", &back)] {
        if matches!(side, MaterialKind::TwoSided { .. }) {
            let message = format!("the {name} of a two-sided material is two-sided, too");
            reader.error_hint(Code::KeyConflict, at, message, "name the material of one of its sides");
            return None;
        }
        if !is_opaque(side) {
            let message = format!("the {name} of a two-sided material lets light through");
            reader.error_hint(Code::KeyConflict, at, message, "take a material that only reflects");
            return None;
        }
    }
    let kind = MaterialKind::TwoSided { front: Box::new(front), back: Box::new(back) };
    let count = kind.parts().len();
    if count > MOST_BLEND_PARTS {
        let message = format!("the two-sided material has {count} materials, counting those of blends inside it");
        reader.error_hint(Code::OutOfRange, at, message, format!("at most {MOST_BLEND_PARTS}"));
        return None;
    }
    Some(kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The material "m" of a file, or what is wrong.
    fn material(sides: &str) -> Result<MaterialKind, String> {
        let scene = format!(
            r#"{{ "etalon": 1, "camera": {{ "type": "perspective", "position_m": [0, 0, 1], "look_at_m": [0, 0, 0], "vertical_fov_deg": 20 }},
                "film": {{ "width": 1, "height": 1 }},
                "materials": {{
                    "paint": {{ "type": "lambert", "reflectance": 0.5, "sides": "front" }},
                    "milk": {{ "type": "filled", "material": "paint", "medium": {{ "scattering_per_m": 1 }} }},
                    "both": {{ "type": "two-sided", "front": "paint", "back": {{ "type": "black" }} }},
                    "m": {{ "type": "two-sided", {sides} }} }},
                "objects": [{{ "shape": {{ "type": "sphere", "radius_m": 1 }}, "material": "m" }}] }}"#
        );
        let (scene, _) = crate::parse(&scene, "test").map_err(|errors| errors.to_string())?;
        Ok(scene.materials.iter().find(|material| material.name == "m").expect("it is there").kind.clone())
    }

    #[test]
    fn each_side_is_what_its_material_is_made_for() {
        let paint = || Box::new(MaterialKind::Lambert { reflectance: etalon_optics::Spectrum::Constant(0.5).into() });
        let mirror = || Box::new(MaterialKind::Mirror { reflectance: etalon_optics::Spectrum::Constant(0.9).into() });
        let own = r#"{ "type": "mirror", "reflectance": 0.9 }"#;
        let expected = MaterialKind::TwoSided { front: mirror(), back: paint() };
        assert_eq!(material(&format!(r#""front": {own}, "back": "paint""#)), Ok(expected));
        // So is a part of a blend.
        let mixed = |share| format!(r#"{{ "type": "blend", "first": "paint", "second": "paint", "weight": {share} }}"#);
        let Ok(MaterialKind::TwoSided { back, .. }) = material(&format!(r#""front": {own}, "back": {}"#, mixed(0.5)))
        else {
            panic!("two sides")
        };
        assert_eq!(*back, MaterialKind::blend(*paint(), *paint(), 0.5));
        // Black on its back, it is shown by its front.
        let expected = MaterialKind::TwoSided { front: paint(), back: mirror() };
        assert_eq!(material(&format!(r#""front": "both", "back": {own}"#)), Ok(expected));
    }

    #[test]
    fn what_is_no_side_of_a_surface_is_refused() {
        for (sides, why) in [
            (
                r#""front": "paint", "back": { "type": "dielectric", "interior": 1.5 }"#,
                "the back of a two-sided material lets light through",
            ),
            (
                r#""front": { "type": "blend", "first": "paint", "second": { "type": "thin-dielectric", "interior": 1.5 }, "weight": 0.5 }, "back": "paint""#,
                "the front of a two-sided material lets light through",
            ),
            (r#""front": "milk", "back": "paint""#, "cannot have an absorption or a medium"),
            (r#""front": "m", "back": "paint""#, "it is made of the material \"m\""),
            (
                r#""front": { "type": "two-sided", "front": "paint", "back": "paint" }, "back": "paint""#,
                "is two-sided, too",
            ),
            (r#""front": "paint""#, "back"),
        ] {
            let said = material(sides).expect_err(sides);
            assert!(said.contains(why), "{said}");
        }
    }
}
