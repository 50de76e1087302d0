//! Paths that neighbouring pixels share: the same by both loops and in any part of a picture.

use etalon_scene::{PathReuse, Scene};
use etalon_transport::{Control, Extent, Film, PathLoop, PixelRect, Prepared, Study, prepare_study};

#[path = "../src/integrator/reuse/room.rs"]
mod room;

const REPLICATES: u32 = 16;

fn prepared(scene: &Scene, path_loop: PathLoop) -> Prepared {
    prepare_study(scene, &Study { path_loop: Some(path_loop), ..Study::default() }).unwrap()
}

fn render(prepared: &Prepared, extent: &Extent) -> Film {
    prepared.render(extent, &|_| Control::Continue).unwrap()
}

/// The ready-made scenes, small: of an odd size, so that some blocks are cut off by the film.
#[test]
fn many_paths_at_once_share_as_one_at_a_time_do() {
    let mut covered = 0;
    let blocks = [PathReuse::Block2x2, PathReuse::Block4x2, PathReuse::Block4x4];
    for ((name, mut scene), reuse) in crate::common::ready_made([13, 10], 4).into_iter().zip(blocks.into_iter().cycle())
    {
        scene.integrator.path_reuse = reuse;
        let study = Study { path_loop: Some(PathLoop::Batch), ..Study::default() };
        let Ok(batch) = prepare_study(&scene, &study) else { continue };
        let scalar = prepared(&scene, PathLoop::Scalar);
        let (batch, scalar) = (render(&batch, &batch.whole(Some(2))), render(&scalar, &scalar.whole(Some(2))));
        assert_eq!(batch.counters, scalar.counters, "{name}, {reuse:?}");
        assert!(batch == scalar, "{name}, {reuse:?}: the films differ");
        covered += 1;
    }
    assert!(covered >= 5, "only {covered} were covered");
}

#[test]
fn a_pixel_is_the_same_in_any_part_of_the_picture() {
    let mut scene = room::room(REPLICATES);
    (scene.film.width, scene.film.height, scene.integrator.spp) = (22, 19, 16);
    for path_loop in [PathLoop::Scalar, PathLoop::Batch] {
        let prepared = prepared(&scene, path_loop);
        let whole = render(&prepared, &prepared.whole(Some(2)));
        let crop = PixelRect { x0: 3, y0: 5, x1: 21, y1: 18 };
        let part = render(&prepared, &Extent { rect: crop, ..prepared.whole(Some(1)) });
        for (x, y) in crop.pixels() {
            assert_eq!(part.pixel(x, y), whole.pixel(x, y), "{path_loop:?}: {x}, {y}");
        }
        // Samples in pieces, too.
        let mut pieces = prepared.film();
        for samples in [0..5, 5..16] {
            let extent = Extent { samples, ..prepared.whole(Some(2)) };
            prepared.render_onto(&mut pieces, &extent, &|_| Control::Continue).unwrap();
        }
        assert!(pieces.pixels().eq(whole.pixels()), "{path_loop:?}");
    }
}

#[test]
fn where_paths_cannot_be_shared_the_scene_is_refused_with_the_reason() {
    let scene = room::room(REPLICATES);
    let polarised = Study { polarised: true, ..Study::default() };
    let refused = prepare_study(&scene, &polarised).map(|_| ()).unwrap_err().to_string();
    assert_eq!(refused, "neighbouring pixels cannot share paths: polarisation is traced");
}
