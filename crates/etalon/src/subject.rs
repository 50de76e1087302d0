//! What a picture is of: all that decides its pixels, and what its file says about it.

use std::collections::BTreeMap;

use etalon_transport::{Band, Film, PixelRect, Prepared};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::frame::Frame;
use crate::matrices;

/// All that decides a pixel's samples, so that two pictures of one subject are two parts of the same picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Subject {
    /// Program and version: another version may trace other paths.
    pub software: String,
    /// SHA-256 of the sources of the program: two builds of one version may trace other paths, too.
    pub sources_sha256: String,
    /// SHA-256 of the scene and of all files that it refers to.
    pub scene_sha256: String,
    /// Width and height of the frame, pixels.
    pub size: [u32; 2],
    /// The pixels that are rendered.
    pub crop: PixelRect,
    /// Which frame of a sequence, if it is one of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    /// Seed of every random number.
    pub seed: u64,
    /// Independent replicates of each pixel.
    pub replicates: u32,
    /// `worldToCamera` and `worldToNDC` of the EXR file, for row vectors, row after row.
    pub matrices: [[f32; 16]; 2],
    /// Of a compound lens: sin θ₀ of the cone of light that reaches the middle of the film.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image_numerical_aperture: Option<f64>,
    /// Bands of wavelengths that the film keeps.
    pub bands: Option<KeptBands>,
    /// The plan: effects, kernel, sampler, depth.
    pub plan: Value,
    /// The share of directions that is drawn toward what casts caustics, and how many these are: bodies, and images of lamps.
    pub guided_targets: [(f64, usize); 2],
    /// Regions that draw wavelengths by what they bring there, and all regions.
    #[serde(default)]
    pub guided_wavelengths: (usize, usize),
    /// The shares of the vertices from which specular connections are made, if any are.
    #[serde(default)]
    pub connection_shares: Option<[f64; 2]>,
    /// Light paths of each sample, for each pixel of the picture; 0 if none are traced.
    #[serde(default)]
    pub light_paths_per_pixel: f64,
    /// Width and height of a block of pixels that one of them may reach, if it may reach several.
    #[serde(default)]
    pub pixels_of_light_path: Option<[u32; 2]>,
}

/// Bands of wavelengths, and how the film keeps them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptBands {
    /// Centre of the first, nm, and the step from one to the next.
    pub first_nm: f64,
    /// From centre to centre, nm.
    pub step_nm: f64,
    /// How many.
    pub count: u32,
    /// Where one sum stands for all bands: the bits of the 64-bit floats by which it is multiplied for each.
    pub factors: Option<Vec<u64>>,
}

impl KeptBands {
    /// Sums that the film has for this many Stokes parameters of them.
    fn sums(&self, parameters: u32) -> u32 {
        // One sum stands for all where nothing is polarised.
        if self.factors.is_some() { 1 } else { self.count * parameters }
    }

    /// Centre of band `index`, nm.
    pub fn centre_nm(&self, index: u32) -> f64 {
        self.first_nm + f64::from(index) * self.step_nm
    }

    /// What a pixel knows of Stokes parameter number `parameter` in band `index`.
    pub fn of_pixel(&self, film: &Film, x: u32, y: u32, parameter: u32, index: u32) -> Band {
        let Some(factors) = &self.factors else { return film.band(x, y, parameter * self.count + index) };
        let (one, factor) = (film.band(x, y, 0), f64::from_bits(factors[index as usize]));
        Band {
            radiance: factor * one.radiance,
            // Where nothing is known of the sum, nothing is known of a multiple that is zero either.
            error: if one.error.is_finite() { factor * one.error } else { one.error },
            count: one.count,
        }
    }
}

/// Program and version.
const SOFTWARE: &str = concat!("etalon ", env!("CARGO_PKG_VERSION"));

impl Subject {
    /// Of a scene that is ready to be rendered.
    pub fn new(prepared: &Prepared, scene_sha256: &str, crop: PixelRect) -> Self {
        let scene = prepared.scene();
        Self {
            software: SOFTWARE.to_owned(),
            sources_sha256: etalon_control::SOURCES_SHA256.to_owned(),
            scene_sha256: scene_sha256.to_owned(),
            size: [scene.film.width, scene.film.height],
            crop,
            frame: None,
            seed: scene.integrator.seed,
            replicates: scene.integrator.replicates,
            matrices: matrices::of_camera(&scene.camera, scene.film.width, scene.film.height),
            image_numerical_aperture: prepared.image_numerical_aperture(),
            bands: scene.film.bands.filter(|_| prepared.band_sums() > 0).map(|bands| KeptBands {
                first_nm: bands.first_nm,
                step_nm: bands.step_nm,
                count: bands.count,
                factors: prepared.band_factors().map(|factors| factors.iter().map(|factor| factor.to_bits()).collect()),
            }),
            plan: serde_json::to_value(prepared.plan()).expect("a plan is plain data"),
            guided_targets: [prepared.guided_targets(), prepared.specular_light_images()],
            guided_wavelengths: prepared.guided_wavelengths(),
            connection_shares: prepared.connection_shares(),
            light_paths_per_pixel: prepared.light_paths_per_pixel(),
            pixels_of_light_path: prepared.pixels_of_light_path(),
        }
    }

    /// A black film of this picture.
    pub fn film(&self) -> Film {
        let block = serde_json::from_value(self.plan["path_reuse"].clone()).ok().or(self.pixels_of_light_path);
        let film = Film::with_bands(self.size[0], self.size[1], self.replicates, self.band_sums()).sharing(block);
        if self.records_stokes() { film.recording_stokes() } else { film }
    }

    /// Whether its film holds S₁, S₂ and S₃.
    pub fn records_stokes(&self) -> bool {
        self.plan["stokes"] == true
    }

    /// Stokes parameters that the film holds: S₀, or all four.
    pub fn stokes_parameters(&self) -> u32 {
        if self.records_stokes() { 4 } else { 1 }
    }

    /// Sums for bands that each replicate of a pixel has.
    pub fn band_sums(&self) -> u32 {
        self.bands.as_ref().map_or(0, |bands| bands.sums(self.stokes_parameters()))
    }

    /// What the picture lacks that the scene calls for.
    pub fn approximations(&self) -> Vec<String> {
        let list = self.plan["approximations"].as_array();
        list.into_iter().flatten().filter_map(|lost| lost.as_str().map(str::to_owned)).collect()
    }

    /// The first thing in which another subject differs, as "its seed is 3, not 4"; `None` if in nothing.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let parts = |subject: &Self| {
            let mut value = serde_json::to_value(subject).expect("plain data");
            let plan = value["plan"].take().as_object().cloned().unwrap_or_default();
            // A picture of another size has another crop too, and another seed is no surprise where the scene is another.
            let first = [
                "software",
                "sources_sha256",
                "scene_sha256",
                "size",
                "crop",
                "frame",
                "seed",
                "replicates",
                "bands",
                "guided_targets",
                "guided_wavelengths",
                "connection_shares",
                "light_paths_per_pixel",
            ];
            let first: Vec<_> = first.iter().map(|&key| (key.to_owned(), value[key].take())).collect();
            first.into_iter().chain(plan.into_iter().map(|(key, value)| (format!("plan.{key}"), value))).collect()
        };
        let other_frame = other.frame;
        let (own, others): (Vec<(String, Value)>, BTreeMap<String, Value>) =
            (parts(self), parts(other).into_iter().collect());
        let name = |key: &str| match key {
            "software" => "the program that rendered it".to_owned(),
            "sources_sha256" => "the SHA-256 of the sources of the program that rendered it".to_owned(),
            "scene_sha256" => "the SHA-256 of its scene".to_owned(),
            "size" => "its size".to_owned(),
            "crop" => "its crop".to_owned(),
            "frame" => "its frame".to_owned(),
            "seed" => "its seed".to_owned(),
            "replicates" => "its number of replicates".to_owned(),
            "bands" => "its bands".to_owned(),
            other => format!("its {}", other.trim_start_matches("plan.")),
        };
        own.iter()
            .map(|(key, value)| (key, value, others.get(key).unwrap_or(&Value::Null)))
            .find(|(_, a, b)| a != b)
            .map(|(key, own, other)| match key.as_str() {
                "guided_targets" => "its paths are guided toward other objects (see `etalon explain`)".to_owned(),
                "guided_wavelengths" => "it draws other wavelengths (see `etalon explain`)".to_owned(),
                "connection_shares" => {
                    "it makes specular connections from other vertices (see `etalon explain`)".to_owned()
                }
                "light_paths_per_pixel" => "it follows other light from the lamps (see `etalon explain`)".to_owned(),
                "plan.effects" => "it simulates other effects (see `etalon explain`)".to_owned(),
                "frame" => format!("it is {}, not {}", frame_name(self.frame), frame_name(other_frame)),
                _ => format!("{} is {own}, not {other}", name(key)),
            })
    }
}

/// A frame in words.
fn frame_name(frame: Option<Frame>) -> String {
    frame.map_or_else(
        || "a single picture".to_owned(),
        |Frame { number, rate }| format!("frame {number} of a sequence with {rate} frames a second"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameRate;

    #[test]
    fn the_first_difference_is_named() {
        let subject = Subject {
            software: SOFTWARE.to_owned(),
            sources_sha256: "01".to_owned(),
            scene_sha256: "ab".to_owned(),
            size: [4, 3],
            crop: PixelRect { x0: 0, y0: 0, x1: 4, y1: 3 },
            frame: None,
            seed: 3,
            replicates: 4,
            matrices: [[0.0; 16]; 2],
            image_numerical_aperture: None,
            bands: None,
            guided_targets: [(0.0, 0); 2],
            guided_wavelengths: (0, 0),
            connection_shares: None,
            light_paths_per_pixel: 0.0,
            pixels_of_light_path: None,
            plan: serde_json::json!({"sampler": "sobol", "approximations": ["lens: everything is in focus"]}),
        };
        assert_eq!(subject.difference(&subject.clone()), None);
        assert_eq!(subject.approximations(), ["lens: everything is in focus"]);
        let with = |change: &dyn Fn(&mut Subject)| {
            let mut other = subject.clone();
            change(&mut other);
            subject.difference(&other).unwrap()
        };
        assert_eq!(with(&|s| s.seed = 4), "its seed is 3, not 4");
        assert_eq!(
            with(&|s| s.frame = Some(Frame { number: 7, rate: FrameRate::default() })),
            "it is a single picture, not frame 7 of a sequence with 24 frames a second"
        );
        assert_eq!(
            with(&|s| s.guided_targets[1] = (0.5, 2)),
            "its paths are guided toward other objects (see `etalon explain`)"
        );
        assert_eq!(with(&|s| s.guided_wavelengths = (3, 16)), "it draws other wavelengths (see `etalon explain`)");
        assert_eq!(
            with(&|s| s.connection_shares = Some([1.0, 0.25])),
            "it makes specular connections from other vertices (see `etalon explain`)"
        );
        assert_eq!(
            with(&|s| s.light_paths_per_pixel = 2.0),
            "it follows other light from the lamps (see `etalon explain`)"
        );
        assert_eq!(with(&|s| s.scene_sha256 = "cd".to_owned()), "the SHA-256 of its scene is \"ab\", not \"cd\"");
        assert_eq!(
            with(&|s| s.sources_sha256 = "02".to_owned()),
            "the SHA-256 of the sources of the program that rendered it is \"01\", not \"02\""
        );
        assert_eq!(
            with(&|s| s.plan["sampler"] = "independent".into()),
            "its sampler is \"sobol\", not \"independent\""
        );
    }
}
