//! What fills the bodies of Mitsuba, and what is outside of them.

use serde_json::{Value, json};

use super::Walk;
use super::element::Element;
use super::material::Look;
use super::sheet::is_sheet;
use crate::medium::fill;

/// Most bodies within each other that a path keeps apart.
const MOST_NESTED: usize = 16;

impl<'a> Walk<'a, '_, '_> {
    /// Finds the media that fill shapes, here and in what is within.
    pub(super) fn find_interiors(&mut self, element: &'a Element) {
        let [inside, outside] = ["interior", "exterior"].map(|name| self.named(element, name));
        if let Some(inside) = inside {
            self.interiors.entry(inside).or_insert(outside);
        }
        element.children.iter().for_each(|child| self.find_interiors(child));
    }

    /// Whether this or something in it says that what is outside of it fills another body.
    pub(super) fn holds_nested(&self, element: &Element) -> bool {
        self.named(element, "exterior").is_some_and(|outside| self.interiors.contains_key(&outside))
            || element.children.iter().any(|child| self.holds_nested(child))
    }

    /// What an element holds or refers to under a name. A reference to nothing is an error where it is read.
    fn named(&self, element: &Element, name: &str) -> Option<*const Element> {
        let child = element.children.iter().find(|child| child.attribute("name") == Some(name))?;
        if child.tag == "ref" { self.ids.of(child).ok() } else { Some(child) }.map(std::ptr::from_ref)
    }

    /// Within how many bodies, itself among them, a body that a medium fills stands by what is said to be outside of it.
    pub(super) fn nesting(&self, medium: &Element) -> usize {
        let outside = |medium: &*const Element| self.interiors.get(medium).copied().flatten();
        let bodies = std::iter::successors(Some(std::ptr::from_ref(medium)), outside);
        // What is outside of itself is so without end.
        bodies.take_while(|medium| self.interiors.contains_key(medium)).take(MOST_NESTED).count()
    }

    /// The medium that an element has under a name: "interior" or "exterior".
    pub(super) fn stated_medium(&mut self, element: &'a Element, name: &str) -> Result<Option<&'a Element>, String> {
        let stated = element
            .children
            .iter()
            .find(|child| child.attribute("name") == Some(name) && (child.tag == "medium" || child.tag == "ref"));
        let Some(stated) = stated else { return Ok(None) };
        stated.mark();
        let medium = if stated.tag == "ref" { self.ids.of(stated)? } else { stated };
        medium.mark();
        if medium.tag != "medium" {
            return Err(format!("{}: a <{}> stands where a medium should", stated.place, medium.tag));
        }
        if let Some(integrator) = self.ignores_media {
            let what =
                format!("the integrator \"{integrator}\" goes through media as if they were not there: it is left out");
            self.builder.leave_out(&medium.place, what);
            return Ok(None);
        }
        Ok(Some(medium))
    }

    /// The material with what fills the shape. What stands outside of it fills another body, or surrounds everything.
    pub(super) fn filled(&mut self, element: &'a Element, mut look: Look) -> Result<Look, String> {
        let place = &element.place;
        let [outside, inside] = ["exterior", "interior"].map(|name| self.stated_medium(element, name));
        let (outside, inside) = (outside?, inside?);
        let own = look.material.as_str().and_then(|name| self.builder.materials.get(name));
        let mut material = own.unwrap_or(&look.material).clone();
        let around = outside.map_or(0, |medium| self.nesting(medium));
        let mut changed = false;
        if let Some(medium) = outside {
            // It may be an open surface between two media.
            changed = self.put_outside(&mut material, medium, around > 0, place)?;
        }
        // Where a shape states no medium, a path stays in the one in which it is.
        let stays = outside.is_none() && inside.is_none() && material["type"] == "dielectric";
        if stays && self.builder.medium.is_none() && !self.interiors.is_empty() && self.ignores_media.is_none() {
            let what = "it states no medium: where it lies in a body of fog, Mitsuba has the fog in it, too, and here it is clear";
            self.builder.approximate(place, what);
        }
        let medium = match inside {
            Some(medium) => Some(self.medium(medium)?),
            // A hollow.
            None if around > 0 && material["type"] == "black" && look.opacity == 0.0 => {
                Some(json!({ "absorption_per_m": 0 }))
            }
            None => self.builder.medium.clone().filter(|_| stays),
        };
        if let Some(medium) = medium {
            if is_sheet(&material) {
                self.builder.leave_out(place, "the medium of a polarising sheet is left out");
            } else if fill(&mut material, &mut look.opacity, look.detail.contains_key("opacity_image"), &medium) {
                let is_outside = |inside| outside.is_some_and(|outside| std::ptr::eq(outside, inside));
                if material["type"] == "boundary" && inside.is_some_and(|inside| !is_outside(inside)) {
                    self.builder.bound(&medium, place);
                }
                if material["type"] == "boundary" && self.nested {
                    material["priority"] = json!(inside.map_or(1 + around, |medium| self.nesting(medium)));
                }
                changed = true;
            }
        }
        if changed {
            self.builder.spend(&material, place)?;
            look.material = material;
        }
        Ok(look)
    }

    /// States on a dielectric that a medium is outside of it, which may fill other bodies. Other materials cannot state it: it fills all space outside
    /// unless it fills other bodies. Whether the material is another now.
    fn put_outside(
        &mut self,
        material: &mut Value,
        medium: &'a Element,
        fills_bodies: bool,
        place: &str,
    ) -> Result<bool, String> {
        let states_it = material["type"] == "dielectric";
        if fills_bodies && !states_it {
            return Ok(false);
        }
        let medium = self.medium(medium)?;
        if !fills_bodies && self.builder.medium.is_none() {
            let what = match states_it {
                true => "here the space between the camera and it is in that medium, too, if nothing stands between",
                false => "here it fills all space outside, that of the camera, too",
            };
            self.builder.approximate(place, format!("a medium is outside of it, but the sensor is in none: {what}"));
        }
        if !states_it {
            self.builder.surround(medium, place);
        } else if fills_bodies || self.builder.medium.as_ref() != Some(&medium) {
            material["exterior_medium"] = medium;
            return Ok(true);
        }
        Ok(false)
    }
}
