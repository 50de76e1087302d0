//! What the lanes of a path stand for: the type parameter that tells the kernels apart, beside polarisation.
//!
//! | model | lanes | when |
//! |---|---|---|
//! | [`OneLane`] | 1 | every surface is grey and all light has one spectrum: radiance is a number times that spectrum |
//! | [`Shared`] | N | lanes differ in what they carry, never in where they go |
//! | [`ThreeChannels`] | 3 | never, but for study: red, green and blue |
//! | [`Hero`] | N | dispersion may send the lanes apart: each lane's own density of the path is carried along |
//!
//! Where both cover a scene, [`Shared`] and [`Hero`] give the same bits: without dispersion every relative density is
//! exactly 1, and so is the weight N/Σ that comes of it.

use crate::film::BandSum;
use crate::plan::CHANNELS_NM;
use crate::scene::prepare::Prepared;
use crate::wavelength::Wavelengths;
use etalon_optics::Lanes;
use etalon_optics::colour::rec709_to_xyz;
use etalon_scene::Bands;

/// How the lanes of one path relate to each other and to the film.
pub(crate) trait WavelengthModel<const N: usize>: Copy {
    /// Whether weights of lanes are carried at all; counted once a vertex.
    const CARRIES_WEIGHTS: bool;

    /// Where a path begins with these wavelengths.
    fn start(wavelengths: &Wavelengths<N>) -> Self;

    /// The path takes a step whose density in each lane, relative to the hero's, is `lane_density`. Returns the mean of
    /// those over the lanes, each weighed by its density of the path before the step.
    fn follow(&mut self, lane_density: Lanes<f64, N>) -> f64;

    /// The mean of the lanes' own densities of a step, each weighed by its density of the path so far.
    fn mean_density(&self, density: Lanes<f64, N>) -> f64;

    /// Whether all lanes have had the hero's densities so far.
    #[inline(always)]
    fn together(&self) -> bool {
        true
    }

    /// The balance heuristic over the lanes that could have been hero (Wilkie et al. 2014, eq. 5): N / Σ densities.
    fn weight(&self) -> f64;

    /// What [`WavelengthModel::weight`] would be if all wavelengths were drawn alike: roulette must not end a path because its region draws many
    /// like it.
    #[inline(always)]
    fn weight_of_even(&self, _: &Wavelengths<N>) -> f64 {
        self.weight()
    }

    /// The wavelengths of a path of a pixel; `u` gives the hero's number, if one is to be drawn.
    fn wavelengths(prepared: &Prepared, x: u32, y: u32, u: impl FnOnce() -> f64) -> Wavelengths<N>;

    /// Those of a path that does not begin at a pixel.
    fn wavelengths_of_light(prepared: &Prepared, u: f64) -> Wavelengths<N>;

    /// What each lane of the path's radiance adds to the film, in each of CIE XYZ.
    fn seen(prepared: &Prepared, wavelengths: &Wavelengths<N>, radiance: Lanes<f64, N>) -> [Lanes<f64, N>; 3];

    /// What the path's radiance adds to the film, CIE XYZ.
    #[inline(always)]
    fn to_xyz(prepared: &Prepared, wavelengths: &Wavelengths<N>, radiance: Lanes<f64, N>) -> [f64; 3] {
        Self::seen(prepared, wavelengths, radiance).map(Lanes::sum)
    }

    /// Adds the path's radiance to the sums of the bands that its wavelengths fall into.
    fn to_bands(bands: &Bands, wavelengths: &Wavelengths<N>, radiance: Lanes<f64, N>, sums: &mut [BandSum]) {
        for lane in 0..N {
            if let Some(band) = bands.at(wavelengths.lambda_nm[lane]) {
                sums[band as usize].add(radiance[lane]);
            }
        }
    }
}

/// One lane at a fixed wavelength that stands for all of them.
#[derive(Clone, Copy)]
pub(crate) struct OneLane;

/// Lanes that always go the same way.
#[derive(Clone, Copy)]
pub(crate) struct Shared;

/// Blue, green and red, each at the wavelength at which a scene without spectra shows it.
#[derive(Clone, Copy)]
pub(crate) struct ThreeChannels;

/// Lanes that dispersion may part from the hero's path: their densities relative to it, times that of each as hero.
#[derive(Clone, Copy)]
pub(crate) struct Hero<const N: usize> {
    density: Lanes<f64, N>,
    /// Whether lanes have had densities of their own. Until then all are exactly 1.
    parted: bool,
    /// Whether heroes are drawn otherwise than elsewhere in the region of the path's pixel.
    guided: bool,
}

impl WavelengthModel<1> for OneLane {
    const CARRIES_WEIGHTS: bool = false;

    #[inline(always)]
    fn start(_: &Wavelengths<1>) -> Self {
        Self
    }

    #[inline(always)]
    fn follow(&mut self, _: Lanes<f64, 1>) -> f64 {
        1.0
    }

    #[inline(always)]
    fn mean_density(&self, density: Lanes<f64, 1>) -> f64 {
        density[0]
    }

    #[inline(always)]
    fn weight(&self) -> f64 {
        1.0
    }

    #[inline(always)]
    fn wavelengths(prepared: &Prepared, _: u32, _: u32, _: impl FnOnce() -> f64) -> Wavelengths<1> {
        Wavelengths::fixed([prepared.one_lane.wavelength_nm])
    }

    fn wavelengths_of_light(prepared: &Prepared, _: f64) -> Wavelengths<1> {
        Wavelengths::fixed([prepared.one_lane.wavelength_nm])
    }

    #[inline(always)]
    fn seen(prepared: &Prepared, _: &Wavelengths<1>, radiance: Lanes<f64, 1>) -> [Lanes<f64, 1>; 3] {
        prepared.one_lane.xyz_of_unit.map(|v| Lanes([v * radiance[0]]))
    }

    /// One sum stands for all bands: each is it times a known number.
    fn to_bands(_: &Bands, _: &Wavelengths<1>, radiance: Lanes<f64, 1>, sums: &mut [BandSum]) {
        sums[0].add(radiance[0]);
    }
}

impl<const N: usize> WavelengthModel<N> for Shared {
    const CARRIES_WEIGHTS: bool = false;

    #[inline(always)]
    fn start(_: &Wavelengths<N>) -> Self {
        Self
    }

    #[inline(always)]
    fn follow(&mut self, _: Lanes<f64, N>) -> f64 {
        1.0
    }

    #[inline(always)]
    fn mean_density(&self, density: Lanes<f64, N>) -> f64 {
        density[0]
    }

    #[inline(always)]
    fn weight(&self) -> f64 {
        1.0
    }

    #[inline(always)]
    fn wavelengths(prepared: &Prepared, _: u32, _: u32, u: impl FnOnce() -> f64) -> Wavelengths<N> {
        prepared.wavelengths.sample_lanes(u())
    }

    fn wavelengths_of_light(prepared: &Prepared, u: f64) -> Wavelengths<N> {
        prepared.wavelengths.sample_lanes(u)
    }

    #[inline(always)]
    fn seen(prepared: &Prepared, wavelengths: &Wavelengths<N>, radiance: Lanes<f64, N>) -> [Lanes<f64, N>; 3] {
        prepared.wavelengths.seen(wavelengths, radiance)
    }
}

impl<const N: usize> WavelengthModel<N> for Hero<N> {
    const CARRIES_WEIGHTS: bool = true;

    #[inline(always)]
    fn together(&self) -> bool {
        !self.parted || self.density == Lanes::ONE
    }

    #[inline(always)]
    fn start(wavelengths: &Wavelengths<N>) -> Self {
        let guided = wavelengths.density != Lanes::ONE;
        Self { density: wavelengths.density, parted: guided, guided }
    }

    #[inline(always)]
    fn follow(&mut self, lane_density: Lanes<f64, N>) -> f64 {
        self.parted |= lane_density != Lanes::ONE;
        if !self.parted {
            return 1.0;
        }
        let before = self.density.sum();
        self.density *= lane_density;
        self.density.sum() / before
    }

    #[inline(always)]
    fn mean_density(&self, density: Lanes<f64, N>) -> f64 {
        // In differences from the hero's, so that equal densities give exactly that.
        let difference = density - Lanes::splat(density[0]);
        density[0] + (self.density * difference).sum() / self.density.sum()
    }

    #[inline(always)]
    fn weight(&self) -> f64 {
        if self.parted { N as f64 / self.density.sum() } else { 1.0 }
    }

    #[inline(always)]
    fn weight_of_even(&self, wavelengths: &Wavelengths<N>) -> f64 {
        if !self.guided {
            return self.weight();
        }
        let of_lane = |lane: usize| self.density[lane] / wavelengths.density[lane];
        N as f64 / (0..N).map(of_lane).sum::<f64>()
    }

    #[inline(always)]
    fn wavelengths(prepared: &Prepared, x: u32, y: u32, u: impl FnOnce() -> f64) -> Wavelengths<N> {
        match &prepared.wavelength_guide {
            None => prepared.wavelengths.sample_lanes(u()),
            Some(guide) => guide.sample_lanes(&prepared.wavelengths, x, y, u()),
        }
    }

    fn wavelengths_of_light(prepared: &Prepared, u: f64) -> Wavelengths<N> {
        prepared.wavelengths.sample_lanes(u)
    }

    #[inline(always)]
    fn seen(prepared: &Prepared, wavelengths: &Wavelengths<N>, radiance: Lanes<f64, N>) -> [Lanes<f64, N>; 3] {
        prepared.wavelengths.seen(wavelengths, radiance)
    }
}

impl WavelengthModel<3> for ThreeChannels {
    const CARRIES_WEIGHTS: bool = false;

    #[inline(always)]
    fn start(_: &Wavelengths<3>) -> Self {
        Self
    }

    #[inline(always)]
    fn follow(&mut self, _: Lanes<f64, 3>) -> f64 {
        1.0
    }

    #[inline(always)]
    fn mean_density(&self, density: Lanes<f64, 3>) -> f64 {
        density[0]
    }

    #[inline(always)]
    fn weight(&self) -> f64 {
        1.0
    }

    fn wavelengths(_: &Prepared, _: u32, _: u32, _: impl FnOnce() -> f64) -> Wavelengths<3> {
        Wavelengths::fixed(CHANNELS_NM)
    }

    fn wavelengths_of_light(_: &Prepared, _: f64) -> Wavelengths<3> {
        Wavelengths::fixed(CHANNELS_NM)
    }

    fn seen(_: &Prepared, _: &Wavelengths<3>, radiance: Lanes<f64, 3>) -> [Lanes<f64, 3>; 3] {
        let [red, green, blue] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(rec709_to_xyz);
        [0, 1, 2].map(|c: usize| Lanes::from_fn(|lane| [blue, green, red][lane][c] * radiance[lane]))
    }
}
