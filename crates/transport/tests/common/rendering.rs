//! A scene from its text to the mean of its film.

use etalon_scene::Scene;
use etalon_transport::{Control, Film, Study, prepare_study};

/// The scene of a text that has no mistake.
pub(crate) fn parse(json: &str) -> Scene {
    etalon_scene::parse(json, "test").unwrap_or_else(|errors| panic!("{errors}")).0
}

/// The whole film.
pub(crate) fn render(scene: &Scene, study: &Study) -> Film {
    let prepared = prepare_study(scene, study).unwrap();
    prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap()
}

/// The mean of Y over the film.
pub(crate) fn mean_y(film: &Film) -> f64 {
    film.xyz().map(|xyz| xyz[1]).sum::<f64>() / f64::from(film.width() * film.height())
}
