//! `KHR_materials_iridescence`: a thin film on metals and on glass.
//!
//! The colours of a film depend on the phase of what the base reflects. glTF derives the base's index from its reflectance F₀ head-on, without
//! absorption: (1 + √F₀)/(1 − √F₀). So a metal under a film has this index here, and not the 1 + ik of a bare one.

use etalon_optics::Spectrum;
use etalon_scene::Metal;
use serde_json::{Value, json};

use crate::Builder;
use crate::checker::channels;

/// Wavelengths at which the index of a coloured base is stated, nm: the first, the last and the steps between.
const RANGE_NM: [f64; 2] = [360.0, 830.0];
const STEPS: usize = 94;

/// A film of a material.
pub(super) struct Iridescence {
    /// The share of the surface that carries it.
    factor: f64,
    film: Value,
}

impl Iridescence {
    /// That of a material, if it has one that shows. Its images are left out: the film is as thick as without one, at its maximum, or where
    /// one says the thickness half-way between minimum and maximum.
    pub(super) fn of(material: &gltf::Material<'_>, place: &str, builder: &mut Builder<'_>) -> Option<Self> {
        let value = material.extension_value("KHR_materials_iridescence")?;
        let number = |key: &str, default: f64| value[key].as_f64().filter(|n| n.is_finite()).unwrap_or(default);
        let factor = number("iridescenceFactor", 0.0).clamp(0.0, 1.0);
        if factor == 0.0 {
            return None;
        }
        let at = format!("{place}.extensions.KHR_materials_iridescence");
        let [least, most] = [("iridescenceThicknessMinimum", 100.0), ("iridescenceThicknessMaximum", 400.0)]
            .map(|(key, default)| number(key, default).clamp(0.0, 1e6));
        let thickness_nm = if value.get("iridescenceThicknessTexture").is_some() {
            builder
                .leave_out(&at, "the image of its thickness is left out: it is half-way between its limits everywhere");
            0.5 * (least + most)
        } else {
            most
        };
        if value.get("iridescenceTexture").is_some() {
            builder.leave_out(&at, "its image is left out: the film is the same everywhere");
        }
        let film = json!([{ "thickness_nm": thickness_nm, "index": number("iridescenceIor", 1.3).max(1.0) }]);
        Some(Self { factor, film })
    }

    /// A metal of a base colour with it.
    pub(super) fn on_metal(&self, bare: Value, colour: &Value, place: &str, builder: &mut Builder<'_>) -> Value {
        let mut coated = bare.clone();
        match index_below(colour) {
            Some((wavelengths_nm, n)) => {
                coated.as_object_mut().map(|keys| keys.remove("reflectance"));
                coated["k"] = json!(vec![0.0; n.len()]);
                (coated["wavelengths_nm"], coated["n"]) = (json!(wavelengths_nm), json!(n));
                coated["outside_fit"] = json!("clamp");
            }
            None => {
                let what = "below the film an image of the base colour is that of a metal of the index 1 + ik, not of a real one";
                builder.approximate(format!("{place}.extensions.KHR_materials_iridescence"), what);
            }
        }
        coated["thin_film"] = self.film.clone();
        if self.factor == 1.0 {
            return coated;
        }
        json!({ "type": "blend", "first": bare, "second": coated, "weight": self.factor })
    }

    /// Puts it on glass, all of it or none: what is inside a blend cannot absorb.
    pub(super) fn put_on_glass(&self, glass: &mut Value, place: &str, builder: &mut Builder<'_>) {
        if self.factor < 1.0 {
            let what = if self.factor < 0.5 {
                "a factor below 0.5 on glass becomes 0"
            } else {
                "its factor on glass becomes 1"
            };
            builder.leave_out(format!("{place}.extensions.KHR_materials_iridescence"), what);
        }
        if self.factor >= 0.5 {
            glass["thin_film"] = self.film.clone();
        }
    }
}

/// The real index of a base of a colour, at wavelengths in nm; `None` of an image.
fn index_below(colour: &Value) -> Option<(Vec<f64>, Vec<f64>)> {
    let rgb = channels(colour)?;
    let reflectance = Spectrum::rgb_reflectance(rgb).ok()?;
    let steps = if rgb == [rgb[0]; 3] { 1 } else { STEPS };
    let wavelengths: Vec<f64> =
        (0..=steps).map(|i| RANGE_NM[0] + (RANGE_NM[1] - RANGE_NM[0]) * i as f64 / steps as f64).collect();
    let index = |nm: &f64| {
        let root = reflectance.eval(*nm).clamp(0.0, Metal::MOST_REFLECTANCE).sqrt();
        (1.0 + root) / (1.0 - root)
    };
    let n = wavelengths.iter().map(index).collect();
    Some((wavelengths, n))
}
