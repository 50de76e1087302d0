//! What media call for.

use super::first_surface;
use super::materials::spread;
use etalon_optics::Spectrum;
use etalon_scene::{Medium, Object, PhaseFunction, Scene};

/// What the first medium has to say that has something to say: that of a surface, then that outside of all bodies.
fn first_medium(scene: &Scene, says: impl Fn(&Medium, [f64; 2]) -> Option<String>) -> Option<String> {
    let of_surfaces =
        first_surface(scene, |material, range_nm| material.media().find_map(|medium| says(medium, range_nm)));
    let surrounding = || {
        let said = says(scene.medium.as_ref()?, scene.integrator.wavelength_range_nm)?;
        Some(format!("medium of the scene: {said}"))
    };
    of_surfaces.or_else(surrounding)
}

/// Media that some object states, and that outside of all.
fn present(scene: &Scene) -> impl Iterator<Item = &Medium> {
    let held = scene.placed_objects().flat_map(|object| scene.materials[object.material].media());
    held.chain(&scene.medium)
}

fn coefficient(symbol: &str, spectrum: &Spectrum, range_nm: [f64; 2]) -> String {
    format!("{symbol} {}", spread(range_nm, |nm| spectrum.eval(nm)).replace(" over", " m⁻¹ over"))
}

/// What absorbs.
pub(super) fn absorption(scene: &Scene) -> Option<String> {
    first_medium(scene, |medium, range_nm| {
        let everywhere = || coefficient("σ", &medium.absorption, range_nm);
        let Some(grid) = medium.albedo.as_ref().filter(|_| medium.scatters()) else {
            return medium.absorbs().then(everywhere);
        };
        let [r, g, b] = grid.mean().map(|channel| 1.0 - channel);
        let by_grid = format!("by a grid, in the mean {r:.3}, {g:.3} and {b:.3} of σₛ");
        Some(if medium.absorption.is_zero() { by_grid } else { format!("{}; {by_grid}", everywhere()) })
    })
}

/// What scatters.
pub(super) fn scattering(scene: &Scene) -> Option<String> {
    first_medium(scene, |medium, range_nm| medium.scatters().then(|| coefficient("σₛ", &medium.scattering, range_nm)))
}

/// What treats wavelengths differently.
pub(super) fn coloured(scene: &Scene) -> Option<String> {
    first_medium(scene, |medium, range_nm| match () {
        () if !medium.absorption.is_constant() => Some(coefficient("σ", &medium.absorption, range_nm)),
        () if !medium.scattering.is_constant() => Some(coefficient("σₛ", &medium.scattering, range_nm)),
        () if medium.albedo.as_ref().is_some_and(|grid| !grid.is_grey()) => {
            Some("albedo by a grid of colours".to_owned())
        }
        () => None,
    })
}

/// The first medium that scatters light, to which shadow rays are of use.
pub(super) fn scatters_everywhere(scene: &Scene) -> Option<String> {
    let scatters = |object: &Object| {
        let scatters = scene.materials[object.material].media().any(Medium::scatters);
        scatters.then(|| format!("the medium of \"{}\"", object.name))
    };
    let surrounding =
        || scene.medium.as_ref().filter(|medium| medium.scatters()).map(|_| "the medium of the scene".to_owned());
    scene.placed_objects().find_map(scatters).or_else(surrounding)
}

/// The first medium that polarises what it scatters, and by how much it matters: light that is scattered twice by right angles comes through
/// where the planes of scattering are parallel, and not where they are crossed.
pub(super) fn polarises(scene: &Scene) -> Option<String> {
    let polarises = |medium: &Medium, _| match &medium.phase {
        _ if !medium.scatters() => None,
        PhaseFunction::Rayleigh => Some("by up to a factor of 2 after two scatterings by right angles".to_owned()),
        PhaseFunction::Tabulated(table) if table.matrix.is_some() => {
            Some(format!("scattered light is up to {:.0} % polarised", 100.0 * table.most_polarised()))
        }
        _ => None,
    };
    first_medium(scene, polarises)
}

/// Whether wavelengths are scattered at different places, so that paths need each lane's own density.
pub(in crate::plan) fn parts_lanes(scene: &Scene) -> bool {
    present(scene)
        .any(|medium| medium.scatters() && !(medium.absorption.is_constant() && medium.scattering.is_constant()))
}

/// The first medium that shines, and what it shows where it is too thick to see through.
pub(super) fn sources(scene: &Scene) -> impl Iterator<Item = (String, &Spectrum)> {
    let held = scene.placed_objects().flat_map(|object| {
        let shining = scene.materials[object.material].media().filter_map(Medium::shines);
        shining.map(|source| (format!("medium of \"{}\"", object.name), source))
    });
    let surrounding =
        scene.medium.as_ref().and_then(|medium| Some(("medium of the scene".to_owned(), medium.shines()?)));
    held.chain(surrounding)
}
