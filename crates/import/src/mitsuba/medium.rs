//! Media of Mitsuba.

use glam::DAffine3;
use serde_json::{Value, json};

use super::Walk;
use super::colour::{Of, three, times};
use super::element::Element;
use crate::matrix::steps;
use crate::medium::{blended, in_unit_box, means, shares, vol, without_colour};
use crate::{coefficient, reflectance};

/// What version 0.x says of a medium, for three channels.
struct Parts {
    albedo: [f64; 3],
    extinction: [f64; 3],
}

/// What a grid says of a medium.
struct Grid {
    /// Numbers, from place to place.
    density: Value,
    /// What they are to be multiplied by: 1, or the colour of a grid of colours.
    extinction: Value,
}

impl<'a> Walk<'a, '_, '_> {
    /// The medium that a sensor is in: whatever it is called.
    pub(super) fn medium_around(&mut self, sensor: &'a Element) -> Result<Option<Value>, String> {
        let stated = sensor.nested("medium", self.ids)?.first().copied().filter(|_| self.ignores_media.is_none());
        stated.map(|medium| self.medium(medium)).transpose()
    }

    /// What a medium is made of.
    pub(super) fn medium(&mut self, element: &'a Element) -> Result<Value, String> {
        self.within(element, |walk| walk.read_medium(element))
    }

    fn read_medium(&mut self, element: &'a Element) -> Result<Value, String> {
        let place = &element.place;
        let scale = element.number("scale")?.unwrap_or(1.0);
        let mut made = json!({});
        match element.property("albedo") {
            None => made["albedo"] = json!(0.75),
            Some(stated) => match self.albedo_grid(stated)? {
                Some(grid) => (made["albedo"], made["albedo_grid"]) = (json!(1), grid),
                None => made["albedo"] = self.uniform(stated, Of::Reflectance)?,
            },
        }
        let parts = self.parts_of_extinction(element)?;
        made["extinction_per_m"] = match (element.plugin(), parts) {
            ("homogeneous", Some(Parts { albedo, extinction })) => {
                made["albedo"] = reflectance(albedo);
                coefficient(extinction.map(|v| v * scale))
            }
            ("homogeneous", None) => match element.property("sigma_t") {
                None => json!(scale),
                Some(stated) => times(self.uniform(stated, Of::Coefficient)?, scale),
            },
            ("heterogeneous", _) => {
                // In version 0.x the extinction is the density times the scale.
                let stated = element.property("sigma_t").or_else(|| element.property("density"));
                let stated = stated.ok_or_else(|| format!("{place}: it has no \"sigma_t\""))?;
                match self.grid(stated)? {
                    Some(Grid { density, extinction }) => {
                        made["density"] = density;
                        times(extinction, scale)
                    }
                    None => {
                        made["density"] = self.box_of_ones(stated)?;
                        times(self.uniform(stated, Of::Coefficient)?, scale)
                    }
                }
            }
            (other, _) => return Err(format!("{place}: the medium \"{other}\" is not known")),
        };
        if let Some(phase) = element.nested("phase", self.ids)?.first() {
            made["phase"] = self.phase(phase)?;
        }
        // How it samples does not matter here.
        element.property("sample_emitters");
        element.property("has_spectral_extinction");
        element.property("majorant_resolution_factor");
        element.list_unused(self.builder);
        Ok(made)
    }

    /// What version 0.x states by absorption and scattering: the albedo and the extinction of three channels.
    fn parts_of_extinction(&mut self, element: &'a Element) -> Result<Option<Parts>, String> {
        let read = |name: &str| -> Result<Option<[f64; 3]>, String> {
            let Some(stated) = element.property(name) else { return Ok(None) };
            let text = stated.attribute("value").unwrap_or("");
            let channels = three(text).map_err(|why| format!("{}: {why}", stated.place))?;
            match channels.iter().all(|v| *v >= 0.0) {
                true => Ok(Some(channels)),
                false => Err(format!("{}: a coefficient is negative", stated.place)),
            }
        };
        let (absorbed, scattered) = (read("sigma_a")?, read("sigma_s")?);
        if absorbed.is_none() && scattered.is_none() {
            return Ok(None);
        }
        let [absorbed, scattered] = [absorbed, scattered].map(Option::unwrap_or_default);
        let extinction: [f64; 3] = std::array::from_fn(|i| absorbed[i] + scattered[i]);
        let albedo = std::array::from_fn(|i| if extinction[i] > 0.0 { scattered[i] / extinction[i] } else { 0.0 });
        Ok(Some(Parts { albedo, extinction }))
    }

    /// The density of what is the same everywhere in its volume: there, too, such a medium ends at the box from 0 to 1 of that volume.
    fn box_of_ones(&mut self, stated: &'a Element) -> Result<Value, String> {
        let volume = if stated.tag == "ref" { self.ids.of(stated)? } else { stated };
        let map = if volume.tag == "volume" { self.placement(volume)? } else { DAffine3::IDENTITY };
        let file = self.builder.add_file("density", "vol", vol([2; 3], 1, [[0.0; 3], [1.0; 3]], &[1.0; 8]));
        let mut density = json!({ "type": "grid", "file": file });
        let transform = steps(&map);
        if !transform.is_null() {
            density["transform"] = transform;
        }
        Ok(density)
    }

    /// A spectrum that is the same everywhere, as itself or as a volume.
    fn uniform(&mut self, stated: &'a Element, of: Of) -> Result<Value, String> {
        let target = if stated.tag == "ref" { self.ids.of(stated)? } else { stated };
        target.mark();
        if target.tag != "volume" {
            return self.colour_of(target, of);
        }
        if target.plugin() == "gridvolume" {
            return self.mean_of_grid(target, of);
        }
        if target.plugin() != "constvolume" {
            let what = format!("the volume \"{}\" becomes the same everywhere, 0.75", target.plugin());
            self.builder.approximate(&target.place, what);
            target.children.iter().for_each(Element::mark);
            return Ok(json!(0.75));
        }
        // Older versions say "color".
        let value = target.property("value").or_else(|| target.property("color"));
        let value = value.ok_or_else(|| format!("{}: the volume \"constvolume\" has no \"value\"", target.place))?;
        self.colour_of(value, of)
    }

    /// The mean of a grid that can only be the same everywhere here.
    fn mean_of_grid(&mut self, volume: &'a Element, of: Of) -> Result<Value, String> {
        let place = &volume.place;
        let name = volume.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?.to_owned();
        let means =
            means(&self.builder.bytes_of(&name, place)?).map_err(|why| format!("{place}: \"{name}\": {why}"))?;
        self.builder.approximate(place, "a grid becomes the same everywhere, its mean");
        volume.children.iter().for_each(Element::mark);
        self.rgb(&words(&means), place, of)
    }

    /// The density of a grid; `None` of what is the same everywhere.
    fn grid(&mut self, stated: &'a Element) -> Result<Option<Grid>, String> {
        let volume = if stated.tag == "ref" { self.ids.of(stated)? } else { stated };
        if volume.tag != "volume" || volume.plugin() != "gridvolume" {
            return Ok(None);
        }
        volume.mark();
        let place = &volume.place;
        let name = volume.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?.to_owned();
        let mut bytes = self.builder.bytes_of(&name, place)?;
        let means = means(&bytes).map_err(|why| format!("{place}: \"{name}\": {why}"))?;
        let grey = means.iter().sum::<f64>() / means.len() as f64;
        let extinction = if means.len() == 1 || grey == 0.0 {
            json!(1)
        } else {
            self.builder.approximate(
                place,
                "a grid of colours keeps one colour, its mean; its density is the mean of the channels",
            );
            let colour: Vec<f64> = means.iter().map(|mean| mean / grey).collect();
            self.rgb(&words(&colour), place, Of::Coefficient)?
        };
        if means.len() == 3 {
            without_colour(&mut bytes);
        }
        let mut density = self.placed_grid(volume, "density", bytes)?;
        density["type"] = json!("grid");
        Ok(Some(Grid { density, extinction }))
    }

    /// A grid of albedos; `None` of what is the same everywhere.
    fn albedo_grid(&mut self, stated: &'a Element) -> Result<Option<Value>, String> {
        let volume = if stated.tag == "ref" { self.ids.of(stated)? } else { stated };
        if volume.tag != "volume" || volume.plugin() != "gridvolume" {
            return Ok(None);
        }
        volume.mark();
        let place = &volume.place;
        let name = volume.string("filename").ok_or_else(|| format!("{place}: it has no \"filename\""))?.to_owned();
        let mut bytes = self.builder.bytes_of(&name, place)?;
        means(&bytes).map_err(|why| format!("{place}: \"{name}\": {why}"))?;
        if shares(&mut bytes) {
            self.builder.approximate(place, "albedos above 1 become 1");
        }
        let wrap = volume.string("wrap_mode").map(ToOwned::to_owned);
        let mut grid = self.placed_grid(volume, "albedo", bytes)?;
        if let Some(wrap @ ("repeat" | "mirror")) = wrap.as_deref() {
            grid["wrap"] = json!(wrap);
        }
        Ok(Some(grid))
    }

    /// The file of a grid, and where it lies.
    fn placed_grid(&mut self, volume: &'a Element, kind: &str, mut bytes: Vec<u8>) -> Result<Value, String> {
        let place = &volume.place;
        if !volume.flag("use_grid_bbox")?.unwrap_or(false) {
            in_unit_box(&mut bytes).map_err(|why| format!("{place}: {why}"))?;
        }
        if volume.string("filter_type").is_some_and(|filter| filter != "trilinear") {
            self.builder.approximate(place, "its numbers become trilinear");
        }
        volume.string("wrap_mode");
        volume.flag("raw")?;
        let map = self.placement(volume)?;
        let mut grid = json!({ "file": self.builder.add_file(kind, "vol", bytes) });
        volume.list_unused(self.builder);
        let transform = steps(&map);
        if !transform.is_null() {
            grid["transform"] = transform;
        }
        Ok(grid)
    }

    fn phase(&mut self, element: &'a Element) -> Result<Value, String> {
        let place = &element.place;
        let phase = match element.plugin() {
            "isotropic" => json!({ "type": "isotropic" }),
            "rayleigh" => json!({ "type": "rayleigh" }),
            "hg" => json!({ "type": "henyey-greenstein", "g": element.number("g")?.unwrap_or(0.8) }),
            "tabphase" => {
                let text = element.string("values").unwrap_or("").to_owned();
                let values = super::element::numbers(&text).map_err(|why| format!("{place}: {why}"))?;
                if values.len() < 2 {
                    return Err(format!("{place}: a table has at least two values"));
                }
                // Evenly spaced in the cosine, from −1: straight back.
                let last = values.len() - 1;
                let degrees = |i: usize| match i {
                    0 => 0.0,
                    i if i == last => 180.0,
                    i => (1.0 - 2.0 * i as f64 / last as f64).acos().to_degrees(),
                };
                let angles: Vec<f64> = (0..=last).map(degrees).collect();
                let values: Vec<f64> = values.into_iter().rev().collect();
                json!({ "type": "tabulated", "angles_deg": angles, "values": values })
            }
            "blendphase" => {
                let parts = element.nested("phase", self.ids)?;
                let [first, second] = parts[..] else {
                    return Err(format!("{place}: a blend has two phase functions, not {}", parts.len()));
                };
                let (first, second) = (self.phase(first)?, self.phase(second)?);
                let weight = element.number("weight")?.unwrap_or(0.5);
                match blended(&first, &second, weight) {
                    Some(phase) => phase,
                    None => {
                        self.builder.approximate(
                            place,
                            "a blend with another than Henyey and Greenstein's becomes its first part",
                        );
                        first
                    }
                }
            }
            other => {
                self.builder.approximate(place, format!("the phase function \"{other}\" becomes isotropic"));
                element.children.iter().for_each(Element::mark);
                json!({ "type": "isotropic" })
            }
        };
        element.list_unused(self.builder);
        Ok(phase)
    }
}

/// Numbers as the attribute of an element writes them.
fn words(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}
