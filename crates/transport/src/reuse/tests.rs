//! A room of known radiance, and what is wrong on purpose.

use crate::film::Film;
use crate::plan::PathLoop;
use crate::{Study, prepare_study};
use std::cell::Cell;

/// What may be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// Densities do not know of the visibility: weights add up to less than one where somebody does not see a target.
    AllSeen,
    /// Densities do not know of the distance.
    NoDistance,
    /// Densities do not know at which angle a target is seen: as if all saw it at the same.
    NoCosine,
}

thread_local! {
    static FAULT: Cell<Option<Fault>> = const { Cell::new(None) };
}

/// Whether this thread is to be wrong in this way.
pub(super) fn is_wrong(fault: Fault) -> bool {
    FAULT.get() == Some(fault)
}

const REPLICATES: u32 = 16;

/// The film, by this thread.
fn film(path_loop: PathLoop) -> Film {
    let prepared =
        prepare_study(&super::room::room(REPLICATES), &Study { path_loop: Some(path_loop), ..Study::default() })
            .unwrap();
    assert_eq!(prepared.path_reuse(), Some([4, 4]));
    let extent = prepared.whole(None);
    let mut film = prepared.film();
    let mut sums = film.tile(extent.rect);
    film.counters = prepared.render_tile(extent.rect, extent.samples, sums.borrow());
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
fn every_pixel_of_a_room_of_constant_radiance_stays_one_and_not_if_densities_are_wrong() {
    for path_loop in [PathLoop::Plain, PathLoop::Lanes] {
        let (z, error) = farthest(&film(path_loop));
        assert!(z < 9.0 && error < 0.02, "{path_loop:?}: {z} standard errors of at most {error}");
        for fault in [Fault::AllSeen, Fault::NoDistance, Fault::NoCosine] {
            FAULT.set(Some(fault));
            let (z, _) = farthest(&film(path_loop));
            FAULT.set(None);
            assert!(z > 9.0, "{path_loop:?}, {fault:?}: {z} standard errors");
        }
    }
}
