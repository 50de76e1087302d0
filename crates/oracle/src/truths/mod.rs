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
mod truth;
mod tubes;
mod view_factors;
mod views;
mod water;

use std::{sync::LazyLock, thread};

pub use cie171::{LUX, cie171};
pub use claim::Claim;
pub use exchange::{ExchangeFile, REMOVED, SET_VERSION, exchange_files};
pub use expectation::{Mistake, SecondOpinion};
pub use irradiance::{
    cylinder_factor, disk_irradiance, lambert_polygon, rectangle_corner_factor, sphere_irradiance, stack_transmittance,
    walsh_reflectance,
};
pub use rami::rami;
pub use suite_case::SuiteCase;
pub use truth::{Quantity, SceneFile, Truth};

pub use judge::{CUT_SHARE, Renders, judge, judge_to};
pub use prisms::photometric_weight;

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
