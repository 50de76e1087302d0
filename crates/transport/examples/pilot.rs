//! Renders a scene file on one thread, for instruction counts: `pilot SCENE WIDTHxHEIGHT SAMPLES`.

use etalon_transport::{Control, Extent, prepare};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut next = || arguments.next().expect("pilot SCENE WIDTHxHEIGHT SAMPLES");
    let (path, size, samples) = (next(), next(), next());
    let (width, height) = size.split_once('x').expect("a size is WIDTHxHEIGHT");
    let number = |text: &str| text.parse().expect("a whole number");
    let text = std::fs::read_to_string(&path).expect("a scene file");
    let (mut scene, _) =
        etalon_scene::parse_with_size(&text, &path, Some([number(width), number(height)])).expect("a scene");
    scene.integrator.spp = number(&samples);
    let prepared = prepare(&scene).expect("a scene that can be prepared");
    let extent = Extent { threads: Some(1), ..prepared.whole(None) };
    let film = prepared.render(&extent, &|_| Control::Continue).expect("a thread");
    let paths = film.counters.paths;
    assert_eq!(paths, u64::from(film.width()) * u64::from(film.height()) * number_of_samples(&scene));
}

fn number_of_samples(scene: &etalon_scene::Scene) -> u64 {
    u64::from(scene.integrator.spp)
}
