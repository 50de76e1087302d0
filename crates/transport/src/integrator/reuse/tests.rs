//! A room of known radiance.

use crate::film::Film;
use crate::guiding::GuidedBy;
use crate::plan::PathLoop;
use crate::scene::prepare::Prepared;
use crate::{Study, prepare_study};
use etalon_scene::PathReuse;

const REPLICATES: u32 = 16;

/// The film, by this thread, with this share of the directions drawn toward such guided targets.
fn film(path_loop: PathLoop, guided_by: GuidedBy) -> Film {
    let mut prepared =
        prepare_study(&super::room::room(REPLICATES), &Study { path_loop: Some(path_loop), ..Study::default() })
            .unwrap();
    assert_eq!(prepared.path_reuse(), Some([4, 4]));
    assert_eq!((prepared.guided_targets.bodies.len(), prepared.guided_targets.images.len()), (2, 16));
    (prepared.guided_targets.guided_by, prepared.guided_targets.share) = (guided_by, 0.4);
    rendered(&prepared)
}

fn rendered(prepared: &Prepared) -> Film {
    let extent = prepared.whole(None);
    let mut film = prepared.film();
    let mut sums = film.tile(extent.rect);
    film.counters = prepared.render_tile(extent.rect, extent.samples, &crate::Splats::NONE, &mut sums);
    film.put(extent.rect, &sums);
    film
}

/// The largest |mean − 1| over all pixels in standard errors, and the largest standard error.
fn farthest(film: &Film) -> (f64, f64) {
    film.pixels().fold((0.0, 0.0), |(z, most): (f64, f64), pixel| {
        let ([variance], _) = pixel.variance(|xyz| [xyz[1]]).unwrap();
        (z.max((pixel.xyz()[1] - 1.0).abs() / variance.sqrt()), most.max(variance.sqrt()))
    })
}

/// Nine standard errors of 16 replicates: Student's t with 15 degrees of freedom passes that with probability 2e-7, one of 64 pixels with
/// 1e-5. What paths deal out to each other adds up to what they have, so that only single pixels tell whether it is dealt rightly.
#[test]
fn every_pixel_of_a_room_of_constant_radiance_stays_one() {
    for path_loop in [PathLoop::Scalar, PathLoop::Batch] {
        for guided_by in [GuidedBy::Nothing, GuidedBy::Bodies, GuidedBy::Images, GuidedBy::ImagesAndLenses] {
            let (z, error) = farthest(&film(path_loop, guided_by));
            assert!(z < 9.0 && error < 0.02, "{path_loop:?}, {guided_by:?}: {z} standard errors of at most {error}");
        }
    }
}

/// The largest difference of two films over all pixels, in standard errors, where at most `max_depth` edges are followed: of one that shares
/// paths and one that does not. Behind the mirror and the glass the first diffuse surface is a later vertex, and what is left to follow less.
fn differs_without_sharing(max_depth: u32) -> f64 {
    let film = |path_reuse| {
        let mut scene = super::room::room(REPLICATES);
        (scene.integrator.max_depth, scene.integrator.path_reuse) = (Some(max_depth), path_reuse);
        let prepared = prepare_study(&scene, &Study { path_loop: Some(PathLoop::Scalar), ..Study::default() }).unwrap();
        rendered(&prepared)
    };
    let (shared, alone) = (film(PathReuse::Block4x4), film(PathReuse::None));
    shared.pixels().zip(alone.pixels()).fold(0.0, |z: f64, (a, b)| {
        let [a, b] = [a, b].map(|pixel| (pixel.xyz()[1], pixel.variance(|xyz| [xyz[1]]).unwrap().0[0]));
        z.max((a.0 - b.0).abs() / (a.1 + b.1).sqrt())
    })
}

/// Nine standard errors as above. Where a path is cut, the mates of another length would receive what is not theirs.
#[test]
fn paths_are_shared_with_those_of_their_length() {
    for max_depth in [2, 3] {
        let z = differs_without_sharing(max_depth);
        assert!(z < 9.0, "at most {max_depth} edges: {z} standard errors");
    }
}
