//! A truth: a scene, what its picture must show, and what mistakes would show.

use serde_json::{Value, json};

use super::claim::Claim;
use super::expectation::{Expectation, Expected, Mistake, SecondOpinion};
use super::scene::Scene;
use crate::statistics::poisson_mean_bound;

/// What is read off a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// The radiance, S₀.
    #[default]
    Radiance,
    /// S₁: light that oscillates along the rows of the picture, less light that oscillates along its columns.
    Stokes1,
    /// S₂: light along the diagonal from the lower left to the upper right, less light along the other.
    Stokes2,
    /// S₃: light whose field turns clockwise seen against the light, less light of the other hand.
    Stokes3,
    /// The mean of the readings of the scene's meters, in the units of [`Quantity::Radiance`] times those of the meter: irradiance
    /// (W·m⁻²·nm⁻¹), flux (W·nm⁻¹) or radiance.
    Meters,
    /// The mean radiance over one of the bands of wavelengths that the scene's film keeps, by its number from 0.
    Band(u32),
}

impl Quantity {
    /// Its name in files: `S0` to `S3`, `meters`, `band`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Radiance => "S0",
            Self::Stokes1 => "S1",
            Self::Stokes2 => "S2",
            Self::Stokes3 => "S3",
            Self::Meters => "meters",
            Self::Band(_) => "band",
        }
    }
}

/// A file that a scene names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFile {
    /// Its name, as the scene writes it.
    pub name: String,
    /// Its contents.
    pub bytes: Vec<u8>,
}

/// A scene with a known answer.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Its name: words joined by hyphens, unique.
    pub name: String,
    /// The scene as JSON text in the neutral form, version 1: SI units, camera, film, materials, objects, lights, integrator. With
    /// [`Claim::WholeFormat`] it uses keys of Etalon's own format that the neutral form lacks.
    pub scene: String,
    /// The files that the scene names, which lie beside it.
    pub files: Vec<SceneFile>,
    pub(super) expected: Expected,
    /// What is read off the picture.
    pub quantity: Quantity,
    /// The pixels that are read: columns x0 to x1, rows y0 to y1 from the top, the second of each excluded. All if `None`.
    pub crop_px: Option<[u32; 4]>,
    /// The formula, with the numbers of this scene.
    pub formula: String,
    /// Why it holds.
    pub derivation: &'static str,
    /// The value by another way, where there is one.
    pub second_opinion: Option<SecondOpinion>,
    /// The largest relative bias that a reading may leave undetected and still be accepted. Known mistakes nearer than that
    /// tighten it further.
    pub must_see: f64,
    /// What the renderer must be able to do, or claims.
    pub claims: Vec<Claim>,
    /// The wavelengths rendered, nm, when the truth holds for them only.
    pub band_nm: Option<[f64; 2]>,
    /// The largest radiance at any place of the scene in any direction, where it has been derived: what a path that is cut cannot
    /// have missed more of.
    pub brightest: Option<f64>,
}

impl Truth {
    pub(super) fn new(name: impl Into<String>, scene: &Scene, value: f64, formula: impl Into<String>) -> Self {
        Self::expecting(name, scene, formula, Expected::Known(Expectation::new(value)))
    }

    /// A truth whose value takes quadrature: it is worked out when it is first asked for.
    pub(super) fn later(
        name: impl Into<String>,
        scene: &Scene,
        formula: impl Into<String>,
        work_out: impl FnOnce() -> Expectation + Send + 'static,
    ) -> Self {
        Self::expecting(name, scene, formula, Expected::later(work_out))
    }

    pub(super) fn expecting(
        name: impl Into<String>,
        scene: &Scene,
        formula: impl Into<String>,
        expected: Expected,
    ) -> Self {
        Self {
            name: name.into(),
            scene: scene.to_json(),
            files: scene.files(),
            expected,
            quantity: if scene.has_meters() { Quantity::Meters } else { Quantity::Radiance },
            crop_px: None,
            formula: formula.into(),
            derivation: "",
            second_opinion: None,
            must_see: 0.02,
            claims: scene.claims(),
            band_nm: scene.band_nm(),
            brightest: None,
        }
    }

    pub(super) fn because(mut self, derivation: &'static str) -> Self {
        self.derivation = derivation;
        self
    }

    pub(super) fn or_else(self, what: &'static str, value: f64) -> Self {
        self.changed(move |expectation| expectation.or_else(what, value))
    }

    pub(super) fn changed(mut self, change: impl FnOnce(Expectation) -> Expectation + Send + 'static) -> Self {
        self.expected = self.expected.changed(change);
        self
    }

    pub(super) fn confirmed(
        mut self,
        how: &'static str,
        tolerance: f64,
        evaluate: impl Fn() -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.second_opinion = Some(SecondOpinion::new(how, tolerance, evaluate));
        self
    }

    pub(super) fn claims(mut self, claim: Claim) -> Self {
        self.claims.push(claim);
        self
    }

    /// Reads another quantity than the radiance.
    pub(super) fn reads(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self.claims(match quantity {
            Quantity::Band(_) => Claim::Bands,
            _ => Claim::StokesParameters,
        })
    }

    /// Reads only some pixels: columns x0 to x1, rows y0 to y1.
    pub(super) fn reads_pixels(mut self, crop_px: [u32; 4]) -> Self {
        self.crop_px = Some(crop_px);
        self.claims(Claim::StatedPixels)
    }

    /// Sets the relative bias that a reading must be able to see.
    pub(super) fn sees(mut self, relative: f64) -> Self {
        self.must_see = relative;
        self
    }

    /// Adds an absolute allowance with its reason to that for single precision.
    pub(super) fn allows(self, tolerance: f64, reason: &'static str) -> Self {
        self.changed(move |expectation| expectation.allows(tolerance, reason))
    }

    /// Says how much radiance there is at most anywhere in the scene.
    pub(super) fn no_brighter_than(mut self, radiance: f64) -> Self {
        self.brightest = Some(radiance);
        self
    }

    /// What the mean over the pixels must be. It may be negative only if it is no radiance.
    ///
    /// The first call may work it out, which takes up to a few tenths of a second.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.expected.get().value
    }

    /// What plausible mistakes would show.
    #[must_use]
    pub fn mistakes(&self) -> &[Mistake] {
        &self.expected.get().mistakes
    }

    /// Absolute deviation that is not an error: of the scene as a stand-in for an ideal one, and of single precision.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.expected.get().tolerance
    }

    /// Where the tolerance comes from.
    #[must_use]
    pub fn tolerance_reason(&self) -> &'static str {
        self.expected.get().tolerance_reason
    }

    /// Whether the truth applies to a renderer that meets these claims and no others.
    #[must_use]
    pub fn applies_to(&self, claims: &[Claim]) -> bool {
        self.claims.iter().all(|claim| claims.contains(claim))
    }

    /// The absolute bias that a reading must be able to see to count: [`must_see`](Self::must_see) of the value, and the
    /// distance of the nearest known mistake. A dark picture is held to its mistakes alone.
    #[must_use]
    pub fn must_resolve(&self) -> f64 {
        self.must_resolve_with(self.must_see)
    }

    /// The same with this share of the value instead.
    #[must_use]
    pub fn must_resolve_with(&self, share: f64) -> f64 {
        let value = self.value();
        let relative = if value == 0.0 { f64::INFINITY } else { share * value.abs() };
        self.mistakes().iter().map(|mistake| (mistake.value - value).abs()).fold(relative, f64::min)
    }

    /// A bound on the absolute bias of a reading that took `paths` paths, of which `cut` were ended by the renderer, not by the scene. None of
    /// these had more than `throughput` (the largest over the wavelengths).
    ///
    /// What one of them would still have found is on the mean at most its throughput times the [`brightest`](Self::brightest) radiance.
    /// `cut` is a count of rare events: [`poisson_mean_bound`] says how large its mean can be. The bound fails with a probability of at most
    /// `significance`. It is infinite where nothing bounds the radiance, and 0 if no path was cut.
    #[must_use]
    pub fn bias_of_cut_paths(&self, cut: u64, throughput: f64, paths: u64, significance: f64) -> f64 {
        if cut == 0 {
            return 0.0;
        }
        let brightest = self.brightest.unwrap_or(f64::INFINITY);
        poisson_mean_bound(cut, significance) / paths as f64 * throughput * brightest
    }

    /// The same camera, film and band under a constant sky of radiance 1, and nothing else. A sensor that answers 1 to a constant spectrum
    /// reads 1. A photometric sensor does not answer 1 to a constant spectrum that is cut to a band. So where the truth has a
    /// [`band_nm`](Self::band_nm), readings are divided by the mean of this picture.
    #[must_use]
    pub fn white_scene(&self) -> String {
        let mut scene: Value = serde_json::from_str(&self.scene).expect("a truth's scene is JSON");
        scene["objects"] = json!([]);
        if let Some(scene) = scene.as_object_mut() {
            scene.retain(|key, _| key != "groups" && key != "instances" && key != "medium");
        }
        scene["lights"] = json!([{ "type": "environment", "radiance": 1.0 }]);
        serde_json::to_string_pretty(&scene).expect("a JSON value always prints")
    }
}
