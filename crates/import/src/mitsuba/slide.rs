//! Projectors of Mitsuba, and spots with a texture: lamps of the format with a slide.
//!
//! A projector brings π E z/(z² cos θ) to the depth z, with E of its image and z measured in its own units. So its intensity is π E/cos³θ,
//! which lights a screen evenly. The texture of a spot multiplies its intensity.

use std::f64::consts::PI;

use etalon_scene::UvMap;
use glam::DAffine3;
use serde_json::{Value, json};

use super::Walk;
use super::camera::field_of_view;
use super::colour::{Of, times};
use super::element::Element;
use crate::checker::{Checker, channels};
use crate::uv;

/// What a slide shows: an image, which lies over coordinates with v from above, and its width over its height.
struct Shown {
    image: Value,
    aspect: f64,
}

impl Walk<'_, '_, '_> {
    /// A point with a slide.
    pub(super) fn projector(&mut self, element: &Element) -> Result<Value, String> {
        let place = &element.place;
        let to_world = self.placement(element)?;
        let axes = to_world.matrix3;
        check_thickness(&to_world, place)?;
        let depth = axes.z_axis.length();
        let factor = PI * element.number("scale")?.unwrap_or(1.0) * depth;
        let stated = self.colour(element, "irradiance", Of::Shining)?;
        let aspect_of_texels = self.aspect_of_texels(stated.as_ref());
        let white = json!({ "type": "illuminant", "name": "D65", "scale": factor });
        let (image, intensity) = match stated {
            None => (even(1.0), white),
            Some(value) if is_image(&value) => (value, white),
            Some(value) => (even(1.0), times(value, factor)),
        };
        let shown = Shown { image, aspect: aspect_of_texels };
        // That of the image in units of its own.
        let (key, degrees) = field_of_view(element, shown.aspect)?;
        let tangent = (0.5 * degrees.to_radians()).tan();
        let tangent = if key == "vertical_fov_deg" { tangent * shown.aspect } else { tangent };
        let mirrored = axes.determinant() < 0.0;
        let over = UvMap::scaled([if mirrored { -1.0 } else { 1.0 }, -1.0], [if mirrored { 1.0 } else { 0.0 }, 1.0]);
        for harmless in ["near_clip", "far_clip"] {
            element.property(harmless);
        }
        let slide = self.slide(shown, &over, &to_world, tangent, "screen");
        Ok(
            json!({ "type": "point", "position_m": to_world.translation.to_array(), "intensity": intensity, "slide": slide }),
        )
    }

    /// Puts the texture of a spot before it.
    pub(super) fn put_slide_of_spot(
        &mut self,
        lamp: &mut Value,
        texture: Value,
        to_world: &DAffine3,
        cutoff: f64,
        place: &str,
    ) -> Result<(), String> {
        check_thickness(to_world, place)?;
        let image = match (is_image(&texture), channels(&texture)) {
            (true, _) => texture,
            (false, Some(rgb)) => flat(rgb),
            (false, None) => {
                self.builder.approximate(place, "a spectrum as texture becomes 0.5");
                even(0.5)
            }
        };
        if cutoff >= 90.0 {
            self.builder.leave_out(place, "the texture of a spot that shines backward is left out");
            return Ok(());
        }
        // Its texture is turned by half of a circle.
        let mirrored = to_world.matrix3.determinant() < 0.0;
        let over = UvMap::scaled([if mirrored { 1.0 } else { -1.0 }, 1.0], [if mirrored { 0.0 } else { 1.0 }, 0.0]);
        let shown = Shown { image, aspect: 1.0 };
        lamp["slide"] = self.slide(shown, &over, to_world, cutoff.to_radians().tan(), "sphere");
        Ok(())
    }

    /// Width over height of an image, 1 of everything else.
    fn aspect_of_texels(&self, shown: Option<&Value>) -> f64 {
        let file = shown.and_then(|shown| shown["file"].as_str());
        let size = file.and_then(|file| self.builder.image_size(file));
        size.map_or(1.0, |[width, height]| f64::from(width) / f64::from(height))
    }

    /// A slide of the format, whose right edge is seen under this tangent in the units of the lamp. `over` gives the coordinates of the
    /// texture from those of the slide.
    fn slide(&self, shown: Shown, over: &UvMap, to_world: &DAffine3, tangent: f64, even_on: &str) -> Value {
        let Shown { mut image, aspect } = shown;
        if let Some(keys) = image.as_object_mut() {
            let map = uv::of(keys).unwrap_or(UvMap::IDENTITY);
            uv::put(&uv::after(&map, over), keys);
        }
        let axes = to_world.matrix3;
        let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis.length());
        let fov = 2.0 * (tangent * x / z).atan().to_degrees();
        json!({
            "image": image, "direction": axes.z_axis.to_array(), "up": axes.y_axis.to_array(), "horizontal_fov_deg": fov,
            "aspect": aspect * x / y, "even_on": even_on,
        })
    }
}

/// That a slide has a width, a height and a depth.
fn check_thickness(to_world: &DAffine3, place: &str) -> Result<(), String> {
    let axes = to_world.matrix3;
    let flat = [axes.x_axis, axes.y_axis, axes.z_axis].iter().any(|axis| axis.length() == 0.0);
    if flat { Err(format!("{place}: its transform flattens it")) } else { Ok(()) }
}

fn is_image(value: &Value) -> bool {
    matches!(value["type"].as_str(), Some("image" | "checker" | "gradient"))
}

/// A slide of one colour.
fn flat(rgb: [f64; 3]) -> Value {
    Checker { colours: [rgb; 2], uv_map: UvMap::IDENTITY }.value()
}

fn even(grey: f64) -> Value {
    flat([grey; 3])
}
