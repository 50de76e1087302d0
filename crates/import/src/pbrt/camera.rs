//! Cameras, films, filters, samplers and integrators of pbrt.

use etalon_scene::linear::unit;
use glam::{DAffine3, DVec3};
use serde_json::json;

use super::Reading;
use super::parameters::Parameters;
use crate::matrix::inverse;

impl Reading<'_, '_> {
    pub(super) fn camera(&mut self, kind: &str, list: &Parameters, place: &str) -> Result<(), String> {
        self.surround(place);
        let from_camera =
            inverse(&self.state.transform).ok_or_else(|| format!("{place}: its transform flattens it"))?;
        self.systems.insert("camera".to_owned(), from_camera);
        // In the camera's own axes x points right, y up and z into the picture.
        let mirrored = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        self.world = if from_camera.matrix3.determinant() > 0.0 { mirrored } else { DAffine3::IDENTITY };
        if self.world != DAffine3::IDENTITY {
            let what =
                "the axes of the model are left-handed: everything is mirrored along x, so that the picture is right";
            self.builder.added.push(what.to_owned());
        }
        let placed = self.world * from_camera;
        let (Some(forward), Some(up)) = (unit(placed.matrix3.z_axis), unit(placed.matrix3.y_axis)) else {
            return Err(format!("{place}: its transform flattens it"));
        };
        let mut camera = json!({
            "position_m": placed.translation.to_array(), "direction": forward.to_array(), "up": up.to_array(),
        });
        let size = |key: &str| self.builder.film[key].as_f64().unwrap_or(1.0);
        let aspect = size("width") / size("height");
        match kind {
            "perspective" => {
                camera["type"] = json!("perspective");
                let fov = list.number_or("fov", 90.0)?;
                // The angle is that of the shorter side.
                camera[if aspect >= 1.0 { "vertical_fov_deg" } else { "horizontal_fov_deg" }] = json!(fov);
            }
            "orthographic" => {
                camera["type"] = json!("orthographic");
                let height = if aspect >= 1.0 { 2.0 } else { 2.0 / aspect };
                camera["height_m"] = json!(height * from_camera.matrix3.y_axis.length());
            }
            other => {
                self.builder.leave_out(place, format!("the camera \"{other}\" is not known, and is left out"));
                return Ok(());
            }
        }
        let radius = list.number_or("lensradius", 0.0)?;
        let focus = list.number("focaldistance")?;
        if radius > 0.0 && kind == "perspective" {
            let along = from_camera.matrix3.z_axis.length();
            let focus = focus.unwrap_or(1e6) * along;
            camera["lens"] = json!({ "radius_m": radius * along, "focus_distance_m": focus });
        }
        let open_s = list.number_or("shutterclose", 1.0)? - list.number_or("shutteropen", 0.0)?;
        self.list_exposure(open_s, place);
        list.list_unused(self.builder);
        self.builder.camera = Some(camera);
        Ok(())
    }

    /// The film comes before the camera in files that people write; the camera's angle is along its shorter side.
    pub(super) fn film(&mut self, kind: &str, list: &Parameters, place: &str) -> Result<(), String> {
        let size = |name: &str, default: f64| Ok::<f64, String>(list.number_or(name, default)?.max(1.0).round());
        let (width, height) = (size("xresolution", 1280.0)?, size("yresolution", 720.0)?);
        self.builder.film["width"] = json!(width as u64);
        self.builder.film["height"] = json!(height as u64);
        if let Some(camera) = &mut self.builder.camera {
            // Stated after the camera.
            let stated = ["vertical_fov_deg", "horizontal_fov_deg"].into_iter().find(|key| camera[*key].is_number());
            if let Some(stated) = stated {
                let fov = camera[stated].take();
                if let Some(map) = camera.as_object_mut() {
                    map.remove(stated);
                }
                camera[if width >= height { "vertical_fov_deg" } else { "horizontal_fov_deg" }] = fov;
            }
        }
        // How the file is written, and what a physical camera would show, is not what light there is.
        for harmless in ["filename", "savefp16", "diagonal"] {
            list.get(harmless);
        }
        if let Some(sensor) = list.string("sensor").filter(|sensor| *sensor != "cie1931") {
            let what =
                format!("the sensor \"{sensor}\" is left out: colours are those that the CIE 1931 observer sees");
            self.builder.leave_out(place, what);
        }
        self.list_exposure(list.number_or("iso", 100.0)? / 100.0 * list.number_or("exposuretime", 1.0)?, place);
        if list.number("maxcomponentvalue")?.is_some() {
            self.builder.leave_out(place, "\"maxcomponentvalue\" is ignored: bright samples are not clamped");
        }
        if !matches!(kind, "rgb" | "gbuffer") {
            self.builder.approximate(place, format!("the film \"{kind}\" becomes a picture of colours"));
        }
        list.list_unused(self.builder);
        Ok(())
    }

    /// Lists what pbrt multiplies the picture by.
    fn list_exposure(&mut self, factor: f64, place: &str) {
        if factor != 1.0 {
            self.builder.leave_out(place, format!("its exposure is ignored: a factor of {factor} on the picture"));
        }
    }

    pub(super) fn sampler(&mut self, kind: &str, list: &Parameters) -> Result<(), String> {
        if let Some(count) = list.number("pixelsamples")?.filter(|count| *count >= 1.0) {
            self.builder.integrator.insert("spp".to_owned(), json!(count as u64));
        }
        if let (Some(x), Some(y)) = (list.number("xsamples")?, list.number("ysamples")?) {
            self.builder.integrator.insert("spp".to_owned(), json!((x * y).max(1.0) as u64));
        }
        if let Some(seed) = list.number("seed")?.filter(|seed| *seed >= 0.0) {
            self.builder.integrator.insert("seed".to_owned(), json!(seed as u64));
        }
        if kind == "independent" {
            self.builder.integrator.insert("sampler".to_owned(), json!("independent"));
        }
        for harmless in ["randomization", "jitter"] {
            list.get(harmless);
        }
        list.list_unused(self.builder);
        Ok(())
    }

    pub(super) fn integrator(&mut self, kind: &str, list: &Parameters, place: &str) -> Result<(), String> {
        if !matches!(kind, "path" | "volpath" | "simplepath" | "simplevolpath") {
            self.builder.approximate(place, format!("the integrator \"{kind}\" becomes a path tracer"));
        }
        // A depth of 0 is light seen directly, which is one edge of a path. What is more than a scene can say stands for no limit.
        let depth = (list.number_or("maxdepth", 5.0)?.max(0.0) + 1.0).min(f64::from(u32::MAX)) as u32;
        self.builder.integrator.insert("max_depth".to_owned(), json!(depth));
        for harmless in ["lightsampler", "regularize"] {
            if list.flag(harmless) != Some(true) {
                list.get(harmless);
            }
        }
        list.list_unused(self.builder);
        Ok(())
    }

    pub(super) fn filter(&mut self, kind: &str, list: &Parameters, place: &str) -> Result<(), String> {
        self.builder.film["filter"] = match kind {
            "box" => json!({ "type": "box" }),
            "triangle" => json!({ "type": "tent", "radius_px": list.number_or("xradius", 2.0)? }),
            "gaussian" => json!({ "type": "gaussian", "sigma_px": list.number_or("sigma", 0.5)? }),
            "mitchell" => {
                let [b, c] = [list.number_or("B", 1.0 / 3.0)?, list.number_or("C", 1.0 / 3.0)?];
                let radius = list.number_or("xradius", 2.0)?;
                if [b, c].iter().all(|number| (0.0..=1.0).contains(number)) {
                    json!({ "type": "mitchell", "radius_px": radius, "b": b, "c": c })
                } else {
                    let what = format!(
                        "the filter \"mitchell\" with B {b} and C {c} becomes a Gaussian: both are from 0 to 1"
                    );
                    self.builder.approximate(place, what);
                    json!({ "type": "gaussian" })
                }
            }
            other => {
                self.builder.approximate(place, format!("the filter \"{other}\" becomes a Gaussian"));
                json!({ "type": "gaussian" })
            }
        };
        for radius in ["xradius", "yradius"] {
            list.get(radius);
        }
        list.list_unused(self.builder);
        Ok(())
    }
}
