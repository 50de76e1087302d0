//! Every instruction set of this machine leaves the film of the scalar driver.

use super::render_on;
use crate::film::{Counters, Film, PixelRect, TileSums};
use crate::guiding::GuidedBy;
use crate::integrator::tracer::PixelSamples;
use crate::integrator::wavelength_lanes::{Hero, OneLane, Shared, WavelengthModel};
use crate::plan::{EffectName, LaneModel, PathLoop};
use crate::polarisation::Averaged;
use crate::scene::prepare::Prepared;
use crate::wavelength::guide::{HeroDensity, Regions, WavelengthGuide};
use crate::{Control, Study, prepare_study};
use etalon_simd::Level;

/// A room with lamps of three shapes, walls of three colours, one of them tabulated, a glass ball and a mirror, under a sky.
fn room() -> etalon_scene::Scene {
    let wall = |origin: &str, u: &str, v: &str, material: &str| {
        format!(
            r#"{{"shape": {{"type": "parallelogram", "origin_m": {origin}, "u_m": {u}, "v_m": {v}}}, "material": {material}}}"#
        )
    };
    let rgb = |rgb: &str| format!(r#"{{"type": "lambert", "reflectance": {{"type": "rgb", "rgb": {rgb}}}}}"#);
    let tabulated = r#"{"type": "lambert", "reflectance":
        {"type": "tabulated", "wavelengths_nm": [400, 500, 700], "values": [0.2, 0.9, 0.4], "outside": "zero"}}"#;
    let objects = [
        wall("[-1, -1, -1]", "[2, 0, 0]", "[0, 0, 2]", tabulated),
        wall("[-1, -1, -1]", "[0, 2, 0]", "[2, 0, 0]", &rgb("[0.2, 0.7, 0.3]")),
        wall("[-1, -1, -1]", "[0, 0, 2]", "[0, 2, 0]", &rgb("[0.8, 0.1, 0.1]")),
        r#"{"shape": {"type": "sphere", "center_m": [0.3, -0.6, 0], "radius_m": 0.4},
            "material": {"type": "dielectric", "interior": 1.5}}"#
            .to_owned(),
        r#"{"shape": {"type": "sphere", "center_m": [-0.5, -0.7, 0.2], "radius_m": 0.3}, "material": {"type": "mirror"}}"#
            .to_owned(),
        r#"{"shape": {"type": "parallelogram", "origin_m": [-0.3, 1, -0.3], "u_m": [0.6, 0, 0], "v_m": [0, 0, 0.6]},
            "material": {"type": "lambert", "reflectance": 0.5}, "emission": {"radiance": 8, "sides": "both"}}"#
            .to_owned(),
        r#"{"shape": {"type": "sphere", "center_m": [0.7, 0.5, 0.3], "radius_m": 0.1},
            "material": {"type": "black"}, "emission": {"radiance": 20}}"#
            .to_owned(),
        r#"{"shape": {"type": "disk", "center_m": [-0.7, 0.6, 0.2], "normal": [1, -1, 0.2], "radius_m": 0.2},
            "material": {"type": "mirror", "reflectance": 0.7}, "emission": {"radiance": 9}}"#
            .to_owned(),
    ];
    let json = format!(
        r#"{{"etalon": 1, "film": {{"width": 16, "height": 16}}, "integrator": {{"spp": 8}},
            "camera": {{"type": "perspective", "position_m": [0.2, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 35}},
            "objects": [{}], "lights": [{{"type": "environment", "radiance": 0.2}}]}}"#,
        objects.join(",")
    );
    etalon_scene::parse(&json, "room").unwrap().0
}

fn prepared(force: &[EffectName], path_loop: PathLoop) -> Prepared {
    let study = Study { force: force.to_vec(), path_loop: Some(path_loop), ..Study::default() };
    prepare_study(&room(), &study).unwrap()
}

fn scalar(force: &[EffectName]) -> Film {
    let prepared = prepared(force, PathLoop::Scalar);
    prepared.render(&prepared.whole(Some(1)), &|_| Control::Continue).unwrap()
}

/// The sums of the whole room and what was counted, on one instruction set.
fn batch<M: WavelengthModel<N>, const N: usize>(level: Level, prepared: &Prepared) -> (TileSums, Counters) {
    let film = &prepared.scene.film;
    let tile = PixelRect { x0: 0, y0: 0, x1: film.width, y1: film.height };
    let mut sums = prepared.film().tile(tile);
    let counters = {
        let all_samples = PixelSamples::of_tile(tile, &(0..prepared.scene.integrator.spp));
        let mut rays = vec![0; all_samples.len()];
        let counters =
            render_on::<M, Averaged, N>(level, prepared, &all_samples, sums.borrow(&crate::Splats::NONE), &mut rays);
        assert_eq!(rays.iter().sum::<u64>(), counters.rays + counters.shadow_rays);
        counters
    };
    (sums, counters)
}

fn is_that_of(film: &Film, (sums, counters): &(TileSums, Counters)) -> bool {
    let rect = PixelRect { x0: 0, y0: 0, x1: film.width(), y1: film.height() };
    film.tile(rect).to_bytes() == sums.to_bytes() && film.counters == *counters
}

#[test]
fn every_instruction_set_and_every_model_of_lanes_leaves_the_film_of_the_scalar_driver() {
    for level in Level::available() {
        let shared = prepared(&[], PathLoop::Batch);
        assert_eq!(shared.plan().lane_model, LaneModel::Shared);
        assert!(is_that_of(&scalar(&[]), &batch::<Shared, 8>(level, &shared)), "{level:?}");
        let hero = prepared(&[EffectName::Dispersion], PathLoop::Batch);
        let film = scalar(&[EffectName::Dispersion]);
        assert!(is_that_of(&film, &batch::<Hero<8>, 8>(level, &hero)), "{level:?}");
        // One lane of the same scene: not its picture, but the same paths on every instruction set.
        let one = batch::<OneLane, 1>(level, &shared);
        let baseline = batch::<OneLane, 1>(Level::Baseline, &shared);
        assert!(one.0.to_bytes() == baseline.0.to_bytes() && one.1 == baseline.1, "{level:?}");
    }
}

#[test]
fn directions_toward_casters_and_images_of_lamps_leave_the_film_of_the_scalar_driver_too() {
    for guided_by in [GuidedBy::Bodies, GuidedBy::Images, GuidedBy::ImagesAndLenses] {
        let aiming = |path_loop, share| {
            let mut prepared = prepared(&[], path_loop);
            // Two balls, one of which mirrors three lamps; the other shows them through itself.
            assert_eq!((prepared.guided_targets.bodies.len(), prepared.guided_targets.images.len()), (2, 6));
            (prepared.guided_targets.guided_by, prepared.guided_targets.share) = (guided_by, share);
            prepared
        };
        let scalar = aiming(PathLoop::Scalar, 0.5);
        let film = scalar.render(&scalar.whole(Some(1)), &|_| Control::Continue).unwrap();
        for level in Level::available() {
            let batch_of = aiming(PathLoop::Batch, 0.5);
            assert!(is_that_of(&film, &batch::<Shared, 8>(level, &batch_of)), "{guided_by:?}, {level:?}");
        }
        let other = aiming(PathLoop::Batch, 0.4);
        assert!(!is_that_of(&film, &batch::<Shared, 8>(Level::best(), &other)), "{guided_by:?}");
    }
}

#[test]
fn wavelengths_drawn_by_region_leave_the_film_of_the_scalar_driver() {
    let prepared = |path_loop, guided: bool| {
        let mut prepared = prepared(&[EffectName::Dispersion], path_loop);
        // Every other region draws a quarter of all wavelengths more often than the rest.
        let density = |region: usize| {
            let first = 4 * region;
            HeroDensity::new(&std::array::from_fn(|group| if (first..first + 32).contains(&group) { 1.0 } else { 0.0 }))
        };
        let densities = (0..16).map(|region| density(region).filter(|_| region % 2 == 0)).collect();
        let guide = WavelengthGuide { regions: Regions { side: 4, columns: 4, rows: 4 }, densities };
        prepared.wavelength_guide = guided.then_some(guide);
        prepared
    };
    let film = |guided| {
        let scalar = prepared(PathLoop::Scalar, guided);
        scalar.render(&scalar.whole(Some(1)), &|_| Control::Continue).unwrap()
    };
    let (guided, even) = (film(true), film(false));
    for level in Level::available() {
        assert!(is_that_of(&guided, &batch::<Hero<8>, 8>(level, &prepared(PathLoop::Batch, true))), "{level:?}");
    }
    assert_ne!(guided, even);
}
