//! Sensors and integrators of Mitsuba.

use etalon_scene::linear::unit;
use glam::DAffine3;
use serde_json::{Value, json};

use super::Walk;
use super::element::{Element, numbers};

/// The diagonal of the 35 mm film that a stated focal length is for, mm.
const DIAGONAL_35_MM: f64 = 43.266_615_305_567_87;
/// Where Mitsuba's cameras see no further, unless they say so; a lens that states no distance is in focus there.
const FAR_CLIP: f64 = 1e4;
/// Most lobes of Lanczos's filter in a scene.
const MOST_LOBES: f64 = 16.0;

impl<'a> Walk<'a, '_, '_> {
    pub(super) fn integrator(&mut self, element: &'a Element) -> Result<(), String> {
        self.within(element, |walk| walk.read_integrator(element))
    }

    fn read_integrator(&mut self, element: &'a Element) -> Result<(), String> {
        let plugin = element.plugin();
        match plugin {
            "path" | "prb" => self.ignores_media = Some(plugin),
            "volpath" | "volpathmis" | "prbvolpath" => {}
            "direct" => {
                self.ignores_media = Some(plugin);
                self.builder.integrator.insert("max_depth".to_owned(), json!(2));
            }
            "stokes" | "aov" | "moment" => {
                self.builder.leave_out(
                    &element.place,
                    match plugin {
                        "stokes" => "polarisation is an option of the command: --polarised",
                        "aov" => "channels beyond the colour are an option of the command: --aov",
                        _ => "moments of the samples are not written: the errors of the picture stand for them",
                    },
                );
                element.property("aovs");
                for nested in element.nested("integrator", self.ids)? {
                    self.integrator(nested)?;
                }
            }
            other => {
                self.builder.approximate(&element.place, format!("the integrator \"{other}\" becomes a path tracer"))
            }
        }
        // −1 is without limit.
        if let Some(depth) = element.number("max_depth")?.filter(|depth| *depth >= 0.0) {
            if depth < 1.0 {
                let what = "a max_depth of 0 shows nothing in Mitsuba: it becomes 1, which shows what shines";
                self.builder.approximate(&element.place, what);
            }
            self.builder.integrator.insert("max_depth".to_owned(), json!(depth.clamp(1.0, f64::from(u32::MAX)) as u32));
            if matches!(plugin, "volpath" | "volpathmis" | "prbvolpath") {
                self.limit_without_panes = true;
            }
        }
        if let Some(from) = element.number("rr_depth")?
            && self.builder.integrator.get("max_depth").and_then(Value::as_f64).is_some_and(|d| from > d)
        {
            self.builder.integrator.insert("roulette".to_owned(), json!(false));
        }
        if element.flag("hide_emitters")?.unwrap_or(false) {
            self.builder.integrator.insert("hide_lights".to_owned(), json!(true));
        }
        element.list_unused(self.builder);
        Ok(())
    }

    pub(super) fn sensor(&mut self, element: &'a Element) -> Result<(), String> {
        let place = element.place.clone();
        if self.builder.camera.is_some() {
            self.builder.leave_out(place, "only the first sensor is used");
            return Ok(());
        }
        if let Some(medium) = self.medium_around(element)? {
            self.builder.surround(medium, &place);
        }
        let aspect = self.film(element)?;
        let to_world = self.placement(element)?;
        let (Some(forward), Some(up)) = (unit(to_world.matrix3.z_axis), unit(to_world.matrix3.y_axis)) else {
            return Err(format!("{place}: its transform flattens it"));
        };
        let mut camera = json!({
            "position_m": to_world.translation.to_array(), "direction": forward.to_array(), "up": up.to_array(),
        });
        if to_world.matrix3.determinant() < 0.0 {
            camera["mirrored"] = json!(true);
        }
        // Mitsuba's own default.
        let near = element.number("near_clip")?.unwrap_or(0.01);
        match element.plugin() {
            "perspective" | "thinlens" => {
                camera["type"] = json!("perspective");
                camera["near_m"] = json!(near * to_world.matrix3.z_axis.length());
                let (key, degrees) = field_of_view(element, aspect)?;
                camera[key] = json!(degrees);
            }
            "orthographic" => {
                camera["type"] = json!("orthographic");
                // From −1 to 1 across the width, times the scale of the transform.
                let width = 2.0 * to_world.matrix3.x_axis.length();
                camera["height_m"] = json!(width / aspect);
                let start = to_world.translation + to_world.matrix3.z_axis * near;
                camera["position_m"] = json!(start.to_array());
            }
            other => {
                self.builder.leave_out(&place, format!("the sensor \"{other}\" is not known, and is left out"));
                element.children.iter().for_each(Element::mark);
                return Ok(());
            }
        }
        if element.plugin() == "thinlens" {
            let radius = element.number("aperture_radius")?.unwrap_or(0.0);
            let focus = match element.number("focus_distance")? {
                Some(focus) => focus,
                None => element.number("far_clip")?.unwrap_or(FAR_CLIP),
            };
            camera["lens"] = json!({ "radius_m": radius, "focus_distance_m": focus });
        }
        // Nothing is cut off far away.
        for harmless in ["far_clip", "shutter_open", "shutter_close"] {
            element.property(harmless);
        }
        if !camera["lens"].is_object() {
            element.property("focus_distance");
        }
        for name in ["principal_point_offset_x", "principal_point_offset_y"] {
            // Exporters write zeros.
            let offset = element.number(name)?.unwrap_or(0.0);
            if offset != 0.0 {
                self.builder.leave_out(&place, format!("{name} = {offset} is ignored"));
            }
        }
        for sampler in element.nested("sampler", self.ids)? {
            if let Some(count) = sampler.number("sample_count")?.filter(|count| *count >= 1.0) {
                self.builder.integrator.insert("spp".to_owned(), json!(count as u64));
            }
            if let Some(seed) = sampler.number("seed")?.filter(|seed| *seed >= 0.0) {
                self.builder.integrator.insert("seed".to_owned(), json!(seed as u64));
            }
        }
        self.builder.camera = Some(camera);
        element.list_unused(self.builder);
        Ok(())
    }

    /// Reads the film, and gives its width over its height.
    fn film(&mut self, sensor: &Element) -> Result<f64, String> {
        let films = sensor.nested("film", self.ids)?;
        let Some(film) = films.first() else {
            self.builder.film =
                json!({ "width": 768, "height": 576, "filter": { "type": "gaussian" }, "sample_border": false });
            return Ok(768.0 / 576.0);
        };
        let size = |name: &str, default: f64| Ok::<f64, String>(film.number(name)?.unwrap_or(default).max(1.0).round());
        let (width, height) = (size("width", 768.0)?, size("height", 576.0)?);
        let mut filter = json!({ "type": "gaussian", "sigma_px": 0.5 });
        for rfilter in film.nested("rfilter", self.ids)? {
            filter = self.reconstruction(rfilter)?.unwrap_or(filter);
            rfilter.list_unused(self.builder);
        }
        let crop = ["crop_offset_x", "crop_offset_y", "crop_width", "crop_height"];
        if film.property(crop[2]).is_some() || film.property(crop[3]).is_some() {
            let [x, y] = [film.number(crop[0])?.unwrap_or(0.0), film.number(crop[1])?.unwrap_or(0.0)];
            let [w, h] = [film.number(crop[2])?.unwrap_or(width), film.number(crop[3])?.unwrap_or(height)];
            let what = format!("the crop is an option of the command: --crop {x},{y},{w},{h}");
            self.builder.leave_out(&film.place, what);
        }
        // How the file is written is the command's choice.
        for harmless in ["file_format", "pixel_format", "component_format", "banner"] {
            film.property(harmless);
        }
        let has_border = film.flag("sample_border")?.unwrap_or(false);
        film.list_unused(self.builder);
        self.builder.film = json!({ "width": width as u64, "height": height as u64, "filter": filter });
        // The filter of a box does not reach beyond its pixel.
        if !has_border && filter["type"] != "box" {
            self.builder.film["sample_border"] = json!(false);
        }
        Ok(width / height)
    }

    /// The filter of a film, if there is such a filter here.
    fn reconstruction(&mut self, rfilter: &Element) -> Result<Option<Value>, String> {
        let filter = match rfilter.plugin() {
            "box" => json!({ "type": "box" }),
            "tent" => json!({ "type": "tent", "radius_px": rfilter.number("radius")?.unwrap_or(1.0) }),
            "gaussian" => json!({ "type": "gaussian", "sigma_px": rfilter.number("stddev")?.unwrap_or(0.5) }),
            "mitchell" => {
                let [b, c] = [rfilter.number("B")?, rfilter.number("C")?].map(|number| number.unwrap_or(1.0 / 3.0));
                if ![b, c].iter().all(|number| (0.0..=1.0).contains(number)) {
                    let what = format!(
                        "the filter \"mitchell\" with B {b} and C {c} becomes a Gaussian: both are from 0 to 1"
                    );
                    self.builder.approximate(&rfilter.place, what);
                    return Ok(None);
                }
                json!({ "type": "mitchell", "b": b, "c": c })
            }
            "catmullrom" => json!({ "type": "mitchell", "b": 0, "c": 0.5 }),
            "lanczos" => match rfilter.number("lobes")?.unwrap_or(3.0) {
                lobes if (1.0..=MOST_LOBES).contains(&lobes) => json!({ "type": "lanczos", "lobes": lobes.trunc() }),
                lobes => {
                    let what = format!(
                        "the filter \"lanczos\" of {lobes} lobes becomes a Gaussian: 1 to {MOST_LOBES} are possible"
                    );
                    self.builder.approximate(&rfilter.place, what);
                    return Ok(None);
                }
            },
            other => {
                self.builder.approximate(&rfilter.place, format!("the filter \"{other}\" becomes a Gaussian"));
                rfilter.children.iter().for_each(Element::mark);
                return Ok(None);
            }
        };
        Ok(Some(filter))
    }

    /// The `to_world` of an element.
    pub(super) fn placement(&mut self, element: &Element) -> Result<DAffine3, String> {
        match element.property("to_world") {
            None => Ok(DAffine3::IDENTITY),
            Some(transform) if transform.tag == "transform" => super::transform::read(transform),
            Some(other) => {
                self.builder.leave_out(&other.place, format!("<{}>: motion is ignored", other.tag));
                Ok(DAffine3::IDENTITY)
            }
        }
    }
}

/// The key of the format for an angle of view, and the angle in degrees.
pub(super) fn field_of_view(element: &Element, aspect: f64) -> Result<(&'static str, f64), String> {
    let place = &element.place;
    let axis = element.string("fov_axis").unwrap_or("x");
    let diagonal_to_vertical =
        |half_diagonal: f64| 2.0 * (half_diagonal / (1.0 + aspect * aspect).sqrt()).atan().to_degrees();
    let Some(fov) = element.number("fov")? else {
        let text = element.string("focal_length").unwrap_or("50mm");
        let length = numbers(text.trim().trim_end_matches("mm")).ok().filter(|list| list.len() == 1 && list[0] > 0.0);
        let length = length.ok_or_else(|| format!("{place}: \"{text}\" is not a focal length"))?[0];
        return Ok(("vertical_fov_deg", diagonal_to_vertical(0.5 * DIAGONAL_35_MM / length)));
    };
    Ok(match axis {
        "x" => ("horizontal_fov_deg", fov),
        "y" => ("vertical_fov_deg", fov),
        "smaller" => (if aspect >= 1.0 { "vertical_fov_deg" } else { "horizontal_fov_deg" }, fov),
        "larger" => (if aspect >= 1.0 { "horizontal_fov_deg" } else { "vertical_fov_deg" }, fov),
        "diagonal" => ("vertical_fov_deg", diagonal_to_vertical((0.5 * fov).to_radians().tan())),
        other => return Err(format!("{place}: \"{other}\" is not a fov_axis")),
    })
}
