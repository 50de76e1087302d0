//! Whole scenes whose picture is known in closed form.
//!
//! A [`Truth`] is data: a scene that any renderer can be taught, and the number that the mean of its picture must show. It says where the
//! number comes from, and has a second evaluation by other means. It knows what plausible mistakes would show instead. [`truths`] lists
//! them all, [`judge`] holds a reading to one, [`exchange_files`] writes them down for a renderer in another language.
//!
//! The quantity is a mean over pixels: all of them, unless the truth names some ([`Truth::crop_px`]). It is the radiance (W·m⁻²·sr⁻¹·nm⁻¹)
//! that arrives at the pixel, or one of its other Stokes parameters ([`Truth::quantity`]). A linear sensor reads it, whose answer to a
//! constant spectrum of radiance 1 is 1: CIE Y, if normalised that way. Irradiance E is read off a small Lambert plate of albedo ρ, which
//! shows ρE/π.

mod absorption;
mod air;
mod albedo_grids;
mod bands;
mod beams;
mod beckmann;
mod cameras;
mod cie171;
mod claim;
mod coloured_lamps;
mod companions;
mod compound_lenses;
mod connections;
mod daylight;
mod densities;
mod dimensions;
mod dispersive_facets;
mod enclosures;
mod exchange;
mod expectation;
mod exteriors;
mod facets;
mod films;
mod fluorescence;
mod furnaces;
mod glass;
mod gratings;
mod guided;
mod hidden_lights;
mod illumination;
mod image_files;
mod image_numbers;
mod images;
mod indices_and_metals;
mod instruments;
mod irradiance;
mod judge;
mod lamps;
mod lamps_behind_glass;
mod lamps_with_images;
mod lens_tracer;
mod light_paths;
mod lit_fog;
mod lossy_coats;
mod luminous;
mod masks;
mod measured;
mod measured_files;
mod media;
mod media_furnaces;
mod meters;
mod motion;
mod moving_media;
mod named;
mod nested_media;
mod panes;
mod phase_matrices;
mod placed_densities;
mod placed_grids;
mod polar_disks;
mod polarised;
mod principled;
mod principled_lobes;
mod principled_tints;
mod prisms;
mod published_media;
mod rami;
mod relief;
mod relief_in_mirrors;
mod rough_surfaces;
mod scene;
mod second_skies;
mod shared_paths;
mod sheets;
mod sides_and_grains;
mod skies;
mod skylight;
mod slides;
mod solids;
mod sources;
mod stokes;
mod suite_case;
mod surfaces;
mod terminators;
mod textures;
mod tiles;
mod tints;
mod translucent;
mod tubes;
mod view_factors;
mod views;
mod water;

use std::{sync::LazyLock, thread};

use serde_json::{Value, json};

use crate::statistics::poisson_mean_bound;
pub use cie171::{LUX, cie171};
pub use claim::Claim;
pub use exchange::{ExchangeFile, REMOVED, SET_VERSION, exchange_files};
use expectation::{Expectation, Expected};
pub use expectation::{Mistake, SecondOpinion};
pub use irradiance::{
    cylinder_factor, disk_irradiance, lambert_polygon, rectangle_corner_factor, sphere_irradiance, stack_transmittance,
    walsh_reflectance,
};
pub use rami::rami;
pub use suite_case::SuiteCase;

pub use judge::{CUT_SHARE, Renders, judge, judge_to};
pub use prisms::photometric_weight;

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
    expected: Expected,
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
    fn new(name: impl Into<String>, scene: &scene::Scene, value: f64, formula: impl Into<String>) -> Self {
        Self::expecting(name, scene, formula, Expected::Known(Expectation::new(value)))
    }

    /// A truth whose value takes quadrature: it is worked out when it is first asked for.
    fn later(
        name: impl Into<String>,
        scene: &scene::Scene,
        formula: impl Into<String>,
        work_out: impl FnOnce() -> Expectation + Send + 'static,
    ) -> Self {
        Self::expecting(name, scene, formula, Expected::later(work_out))
    }

    fn expecting(
        name: impl Into<String>,
        scene: &scene::Scene,
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

    fn because(mut self, derivation: &'static str) -> Self {
        self.derivation = derivation;
        self
    }

    fn or_else(self, what: &'static str, value: f64) -> Self {
        self.changed(move |expectation| expectation.or_else(what, value))
    }

    fn changed(mut self, change: impl FnOnce(Expectation) -> Expectation + Send + 'static) -> Self {
        self.expected = self.expected.changed(change);
        self
    }

    fn confirmed(
        mut self,
        how: &'static str,
        tolerance: f64,
        evaluate: impl Fn() -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.second_opinion = Some(SecondOpinion::new(how, tolerance, evaluate));
        self
    }

    fn claims(mut self, claim: Claim) -> Self {
        self.claims.push(claim);
        self
    }

    /// Reads another quantity than the radiance.
    fn reads(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self.claims(match quantity {
            Quantity::Band(_) => Claim::Bands,
            _ => Claim::StokesParameters,
        })
    }

    /// Reads only some pixels: columns x0 to x1, rows y0 to y1.
    fn reads_pixels(mut self, crop_px: [u32; 4]) -> Self {
        self.crop_px = Some(crop_px);
        self.claims(Claim::StatedPixels)
    }

    /// Sets the relative bias that a reading must be able to see.
    fn sees(mut self, relative: f64) -> Self {
        self.must_see = relative;
        self
    }

    /// Adds an absolute allowance with its reason to that for single precision.
    fn allows(self, tolerance: f64, reason: &'static str) -> Self {
        self.changed(move |expectation| expectation.allows(tolerance, reason))
    }

    /// Says how much radiance there is at most anywhere in the scene.
    fn no_brighter_than(mut self, radiance: f64) -> Self {
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

    /// A bound on the absolute bias of a reading that took this many paths and cut some, though the scene did not end them. None of these
    /// had more than `throughput` (largest over the wavelengths), by which light found beyond would have been multiplied.
    ///
    /// The mean of what one of them would still have found is at most its throughput times the [`brightest`](Self::brightest) radiance.
    /// How often paths are cut is known by a count only: if on the mean more were than [`poisson_mean_bound`] allows, so few would have
    /// been found with a probability below `significance`. Infinite where nothing bounds the radiance; 0 if no path was cut.
    #[must_use]
    pub fn bias_of_cut_paths(&self, cut: u64, throughput: f64, paths: u64, significance: f64) -> f64 {
        if cut == 0 {
            return 0.0;
        }
        let brightest = self.brightest.unwrap_or(f64::INFINITY);
        poisson_mean_bound(cut, significance) / paths as f64 * throughput * brightest
    }

    /// The same camera, film and band under a constant sky of radiance 1, and nothing else: a sensor that answers 1 to a
    /// constant spectrum reads 1. One that does not answer 1 to a constant spectrum cut to a band (a photometric one does not)
    /// is read relative to this picture's mean where the truth has a [`band_nm`](Self::band_nm).
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

/// Every truth, those for polarised light included: filter by [`Truth::applies_to`].
///
/// The first call writes down their scenes and works out most of their values, which takes some tenths of a second; later ones copy the list.
/// Values that take long are worked out when they are asked for.
#[must_use]
pub fn truths() -> Vec<Truth> {
    static LIST: LazyLock<Vec<Truth>> = LazyLock::new(|| {
        // On all cores at once.
        thread::scope(|scope| {
            let groups = GROUPS.map(|group| scope.spawn(group));
            groups.into_iter().flat_map(|group| group.join().expect("values are worked out without a panic")).collect()
        })
    });
    LIST.clone()
}

const GROUPS: [fn() -> Vec<Truth>; 71] = [
    lamps_behind_glass::truths,
    hidden_lights::truths,
    panes::truths,
    furnaces::truths,
    beckmann::truths,
    facets::truths,
    enclosures::truths,
    illumination::truths,
    lamps::truths,
    view_factors::truths,
    tubes::truths,
    glass::truths,
    polar_disks::truths,
    polarised::truths,
    solids::truths,
    absorption::truths,
    water::truths,
    prisms::truths,
    cameras::truths,
    compound_lenses::truths,
    dimensions::truths,
    motion::truths,
    masks::truths,
    textures::truths,
    relief::truths,
    terminators::truths,
    sheets::truths,
    films::truths,
    gratings::truths,
    fluorescence::truths,
    stokes::truths,
    images::truths,
    instruments::truths,
    sources::truths,
    slides::truths,
    beams::truths,
    connections::truths,
    named::truths,
    skies::truths,
    surfaces::truths,
    lossy_coats::truths,
    tints::truths,
    translucent::truths,
    measured::truths,
    principled::truths,
    principled_tints::truths,
    media::truths,
    moving_media::truths,
    placed_grids::truths,
    albedo_grids::truths,
    nested_media::truths,
    exteriors::truths,
    lit_fog::truths,
    light_paths::truths,
    phase_matrices::truths,
    meters::truths,
    luminous::truths,
    daylight::truths,
    shared_paths::truths,
    guided::truths,
    dispersive_facets::truths,
    bands::truths,
    image_numbers::truths,
    relief_in_mirrors::truths,
    lamps_with_images::truths,
    coloured_lamps::truths,
    views::truths,
    indices_and_metals::truths,
    sides_and_grains::truths,
    second_skies::truths,
    placed_densities::truths,
];
