//! Light tracing: light that mirrors and glass throw on what the camera sees, followed from the lamps.
//!
//! A camera path finds such light only where its own direction happens to lead to a lamp, by way of mirrors and glass. For a small lamp that is
//! rare. A path that begins at the lamp finds the lit place at once, and a connection to the camera says which pixel shows it (Arvo 1986,
//! *Backward Ray Tracing*; Dutré, Lafortune & Willems 1993).
//!
//! **Which light.** Exactly the paths of the form camera – scattering surface – … – specular objects – lamp. The specular objects are mirrors or smooth interfaces of
//! certain objects, one or more next to the lamp. Between the first surface and those the path may scatter, and be reflected or refracted by specular objects.
//! All else is left to camera paths, which drop what they find of this form ([`LightTraced`](super::path::LightTraced)). So the two need no weights
//! against each other. Only a sky is divided: light paths bring the share of it that is above its mean, and camera paths the faint rest, which they find
//! well.
//!
//! **One light path** ([`trace_light_path`]). It begins at the specular object that is next to the lamp. Its first point is uniform on the area of all
//! specular objects, and a shadow ray looks for a lamp from there, as from any vertex. So every kind of lamp works. Then the path goes on, away from the
//! lamp. From the first surface on that is no specular object, each vertex is connected to a point on the lens.
//!
//! **The film.** A sample of the picture has a fixed number of light paths, from an eighth to eight for each pixel. What they bring to a pixel is added
//! to the camera path of the same number ([`Splats`](crate::film::Splats)). So a sample stays a function of the scene, its seed and its number, and replicates stay
//! independent. Each part of a picture traces the light paths of its samples anew, whatever its tiles.
//!
//! **Reciprocity.** Where a surface scatters, both directions are known, and the camera's own formula is used: shading normals need no correction.
//! Smooth surfaces reflect and transmit forward with the same probabilities as backward. But transmission scales radiance by n², and a walk along the
//! light carries power, which it does not scale (Veach 1997, §5.2): the factors η² of the walk are taken back. Around a shading normal the way back is
//! another, and power changes on it ([`Bsdf::sample_viewer`](crate::bsdf::Bsdf::sample_viewer)).

mod light_path;
mod splats;
#[cfg(test)]
mod tests;
pub(crate) mod trial;

pub(crate) use light_path::{Connection, trace_light_path};

use crate::film::filter::FilterSampler;
use crate::film::{PixelRect, Splats};
use crate::guiding::SpecularObjects;
use crate::plan::EffectName;
use crate::sampler::mix;
use crate::scene::prepare::Prepared;
use std::ops::Range;

/// Light paths that are traced before any of them reaches the film, about: a second, and some hundred megabytes. A round has one sample at least,
/// which is more where a picture has more pixels than that.
const PATHS_OF_ROUND: u64 = 1 << 20;
/// Samples of a round, of pictures that take few light paths.
const MOST_SAMPLES_OF_ROUND: u64 = 1 << 12;

/// Samples by which the noise of light paths is told.
const SAMPLES_OF_NOISE: u32 = 4;

/// What light paths bring to a sample, in the mean over pixels, with the variance that independent paths have.
#[derive(Clone, Copy, Debug)]
pub struct LightPathsNoise {
    /// CIE Y.
    pub y: f64,
    /// The variance of Y.
    pub variance: f64,
    /// Rays of all kinds that the light paths of a sample take, for the whole picture.
    pub rays: f64,
}

/// The time of a ray of a light path over that of others: these are cast many at once.
pub const LIGHT_RAY: f64 = 2.0;

/// Those of a scene, or why light paths are not possible in it.
pub(crate) fn find_specular_objects(prepared: &Prepared) -> Result<SpecularObjects, &'static str> {
    let plan = prepared.plan();
    // What is forced on a scene that does not need it must change no bit.
    let needs = |effect: EffectName| plan.runs(effect) && !plan.forces(effect);
    let reasons = [
        (needs(EffectName::NestedDielectrics), "solids with priorities are nested"),
        (needs(EffectName::Absorption) || needs(EffectName::Scattering), "a medium absorbs or scatters light"),
        (prepared.has_boundaries, "a surface is the boundary of a medium"),
        (prepared.scene.integrator.hide_lights, "the camera sees past lamps"),
        (needs(EffectName::Masks), "a surface lets a part of the light pass"),
        (needs(EffectName::Motion), "something moves"),
        (needs(EffectName::Fluorescence), "a surface fluoresces"),
        (needs(EffectName::Polarisation), "polarisation is followed"),
        (prepared.lights.is_empty(), "shadow rays aim at no light"),
        (prepared.tracing_camera().is_compound(), "the camera has a compound lens"),
        (prepared.path_reuse().is_some(), "pixels share paths"),
        (!prepared.receivers.is_empty(), "meters have no picture"),
        (prepared.scene.film.bands.is_some(), "the film keeps bands"),
    ];
    if let Some((_, reason)) = reasons.into_iter().find(|(is_so, _)| *is_so) {
        return Err(reason);
    }
    let mut specular_objects = SpecularObjects::new(&prepared.surfaces, &prepared.geometry)?;
    // What shadow rays through glass find from what the camera sees is found by light paths alone.
    let all_glass = || prepared.surfaces.other_properties(&specular_objects.is_one).all(|of| !of.delta_transmission);
    // A study that leaves out such light of lamps without area finds none of it.
    specular_objects.finds_sources &= !plan.leaves_out(EffectName::SpecularConnections);
    match prepared.refracting_bodies.is_none() || all_glass() {
        true => Ok(specular_objects),
        false => Err("shadow rays go through smooth glass that emits light or is stretched as an instance"),
    }
}

/// Light paths of each sample of a picture.
fn paths_of_sample(prepared: &Prepared, specular_objects: &SpecularObjects) -> u64 {
    ((pixels(prepared) as f64 * specular_objects.paths_per_pixel).round() as u64).max(1)
}

fn pixels(prepared: &Prepared) -> u64 {
    let film = &prepared.scene.film;
    u64::from(film.width) * u64::from(film.height)
}

impl Prepared {
    /// What light paths bring to the pixels of a rectangle in samples of these numbers; nothing where none are traced.
    pub fn splats(&self, samples: Range<u32>, rect: PixelRect) -> Splats {
        match &self.specular_objects {
            None => Splats::NONE,
            Some(specular_objects) => splats::of_samples(self, specular_objects, samples, rect),
        }
    }

    /// The samples that tiles take, in rounds whose light paths are best traced at once: few enough for memory, and for a render to be stopped
    /// soon. A round that no tile takes is left out. One round of all samples where no light paths are traced.
    pub fn light_rounds(&self, of_tiles: &[Range<u32>]) -> Vec<Range<u32>> {
        let of_tiles = of_tiles.iter().filter(|samples| !samples.is_empty());
        let Some(first) = of_tiles.clone().map(|samples| samples.start).min() else { return Vec::new() };
        let end = of_tiles.clone().map(|samples| samples.end).fold(first, u32::max);
        let Some(specular_objects) = &self.specular_objects else { return vec![Range { start: first, end }] };
        let reached = self.pixels_of_light_path().map_or(1, |[width, height]| u64::from(width * height));
        let most =
            (PATHS_OF_ROUND / (reached * paths_of_sample(self, specular_objects))).clamp(1, MOST_SAMPLES_OF_ROUND);
        let rounds = (first..end).step_by(most as usize).map(|start| start..start.saturating_add(most as u32).min(end));
        let is_taken = |round: &Range<u32>| of_tiles.clone().any(|own| own.start < round.end && round.start < own.end);
        rounds.filter(is_taken).collect()
    }

    /// What light paths bring to a rectangle; `None` where none are traced.
    pub fn light_paths_noise(&self, rect: PixelRect) -> Option<LightPathsNoise> {
        let specular_objects = self.specular_objects.as_ref()?;
        // No picture is of this seed.
        let seed = mix(self.scene.integrator.seed ^ 0x6c69_6768_7473);
        let of = paths_of_sample(self, specular_objects);
        let tried = of.min(PATHS_OF_ROUND / u64::from(SAMPLES_OF_NOISE));
        let splats = splats::of_paths(self, specular_objects, seed, (tried, 0..SAMPLES_OF_NOISE), rect);
        // What one path brings does not depend on how many there are, but for their number in its weight.
        let of_all = tried as f64 / of as f64;
        let moments = splats.moments(SAMPLES_OF_NOISE, |xyz| xyz[1]);
        let (y, variance) = moments.fold((0.0, 0.0), |sums, own| (sums.0 + own.0, sums.1 + own.1));
        let pixels = rect.area() as f64;
        let rays = splats.rays as f64 / splats.paths as f64 * of as f64;
        Some(LightPathsNoise { y: y / pixels, variance: variance * of_all / pixels, rays })
    }

    /// The largest distance of a pixel's centre from light that counts in it, along one axis, pixels.
    fn filter_reach_px(&self) -> f64 {
        FilterSampler::reach_px(&self.scene.film.filter)
    }

    /// Width and height of the block of pixels that one connection to the camera may reach, if it may reach several. The errors of these pixels
    /// have a part in common. `None` where no light paths are traced.
    pub fn pixels_of_light_path(&self) -> Option<[u32; 2]> {
        let side = (2.0 * self.filter_reach_px()).ceil() as u32;
        (self.specular_objects.is_some() && side > 1).then_some([side; 2])
    }

    /// Light paths of each sample, for each pixel of the picture; 0 where none are traced.
    pub fn light_paths_per_pixel(&self) -> f64 {
        self.specular_objects.as_ref().map_or(0.0, |specular_objects| specular_objects.paths_per_pixel)
    }
}
