//! The trees of each instruction set held to a search of every primitive.

use crate::query::Query;
use crate::ray::Found;
use crate::test_support::*;
use crate::{Geometry, Primitive, PrimitiveId, Ray};
use crate::{level, traverse};
use etalon_optics::Real;
use etalon_simd::Level;
use std::cell::RefCell;

/// What brute force finds along a ray, whatever the instruction set.
#[derive(Clone, Copy)]
struct BruteForce {
    closest: Option<Found>,
    occluded: bool,
    /// Whether the ray is occluded if it aims at what is closest.
    aimed: bool,
    /// What it hits if it leaves that, and whether anything occludes it.
    left: (Option<Found>, bool),
}

impl BruteForce {
    fn new<R: Real>(geometry: &Geometry, ray: &Ray<R>, query: &Query) -> Self {
        let (closest, occluded) = (geometry.closest_flat(query), geometry.any_flat(query));
        let Some((_, hit)) = closest else { return Self { closest, occluded, aimed: false, left: (None, false) } };
        let aimed = Query::new(&Ray { aims_at: hit, ..*ray }).unwrap();
        let left = Query::new(&Ray { leaves: hit, ..*ray }).unwrap();
        let (aimed, left) = (geometry.any_flat(&aimed), (geometry.closest_flat(&left), geometry.any_flat(&left)));
        Self { closest, occluded, aimed, left }
    }
}

/// What brute force has found along rays in turn, so that the trees of several instruction sets are held to one search.
#[derive(Default)]
struct Searched {
    found: Vec<Option<BruteForce>>,
    next: usize,
}

impl Searched {
    fn again(&mut self) {
        self.next = 0;
    }

    fn next(&mut self, search: impl FnOnce() -> Option<BruteForce>) -> Option<BruteForce> {
        if self.next == self.found.len() {
            self.found.push(search());
        }
        self.next += 1;
        self.found[self.next - 1]
    }
}

/// Compares closest hits (bit for bit) and occlusion for one ray in both scalar types; counts hits.
pub(super) fn agrees(geometry: &Geometry, line: Line, t_max: f64, leaves: PrimitiveId, time: f64) -> usize {
    agrees_with(&mut Searched::default(), geometry, line, t_max, leaves, time)
}

fn agrees_with(
    searched: &mut Searched,
    geometry: &Geometry,
    line: Line,
    t_max: f64,
    leaves: PrimitiveId,
    time: f64,
) -> usize {
    fn one<R: Real>(
        searched: &mut Searched,
        geometry: &Geometry,
        line: Line,
        t_max: f64,
        leaves: PrimitiveId,
        time: f64,
    ) -> usize {
        let leaves = leaves.into();
        let ray = Ray::<R> { t_max: R::from_f64(t_max), leaves, time, ..Ray::free(line.0.cast(), line.1.cast()) };
        let query = Query::new(&ray);
        let known = searched.next(|| query.as_ref().map(|query| BruteForce::new(geometry, &ray, query)));
        let (Some(query), Some(known)) = (query, known) else {
            assert!(geometry.closest_hit(&ray).is_none() && !geometry.occluded(&ray));
            return 0;
        };
        let (flat, occluded) = (known.closest, known.occluded);
        assert_eq!(geometry.closest(&query), flat, "{ray:?}");
        assert_eq!(geometry.occluded(&ray), occluded, "{ray:?}");
        if let Some(tree) = geometry.tree() {
            let primitives = geometry.primitives();
            let scaled = flat.map(|(hit, id)| (R::from_f64(hit.t * query.scale), id));
            assert_eq!(geometry.closest_hit(&ray).map(|hit| (hit.t, hit.surface)), scaled, "{ray:?}");
            // Rays, too, not queries made of them.
            let start =
                flat.and_then(|(hit, id)| crate::Hit::new(crate::ray::RawHit { t: hit.t * query.scale, ..hit }, id));
            // Whatever instruction set the tree is made for.
            for level in level::all() {
                assert_eq!(traverse::closest(level, tree, primitives, &query), flat, "{level:?} {ray:?}");
                assert_eq!(traverse::any(level, tree, primitives, &query), occluded, "{level:?} {ray:?}");
                assert_eq!(traverse::closest(level, tree, primitives, &ray), start, "{level:?} {ray:?}");
                assert_eq!(traverse::any(level, tree, primitives, &ray), occluded, "{level:?} {ray:?}");
            }
            assert_eq!(traverse::closest_deep(tree, primitives, &query), flat, "{ray:?}");
            assert_eq!(traverse::any_deep(tree, primitives, &query), occluded, "{ray:?}");
        }
        if let Some(few) = geometry.small_scene() {
            for level in level::all() {
                assert_eq!(few.closest(level, geometry.primitives(), &query), flat, "{level:?} {ray:?}");
                assert_eq!(few.any(level, geometry.primitives(), &query), occluded, "{level:?} {ray:?}");
            }
        }
        if let Some((_, closest)) = flat {
            // What a shadow ray aims at does not hide it.
            let aimed = Ray { aims_at: closest, ..ray };
            assert_eq!(geometry.occluded(&aimed), known.aimed, "{aimed:?}");
            // One that leaves it goes on.
            let left = Ray { leaves: closest, ..ray };
            assert_eq!(geometry.closest(&Query::new(&left).unwrap()), known.left.0, "{left:?}");
            assert_eq!(geometry.occluded(&left), known.left.1, "{left:?}");
        }
        usize::from(flat.is_some())
    }
    one::<f64>(searched, geometry, line, t_max, leaves, time)
        + one::<f32>(searched, geometry, line, t_max, leaves, time)
}

/// Holds the trees of some primitives, one for each instruction set, against brute force on `rays` adversarial rays each; returns the
/// least fraction of hits.
pub(super) fn check(primitives: Vec<Primitive>, rays: usize, seed: u64, place: impl Fn(Line) -> Line) -> f64 {
    let searched = RefCell::new(Searched::default());
    at_each_level(|level| {
        let geometry = Geometry::build_with(primitives.clone(), 0).unwrap();
        assert!(geometry.tree().is_none_or(|tree| tree.lanes() == crate::bvh::node::leaf_lanes(level)));
        let mut searched = searched.borrow_mut();
        searched.again();
        check_geometry_with(&mut searched, &geometry, rays, seed, &place)
    })
}

/// The least of what comes of some work done with each instruction set taken for the best.
pub(super) fn at_each_level(work: impl Fn(Level) -> f64) -> f64 {
    level::all().into_iter().map(|level| level::forced(level, || work(level))).fold(f64::INFINITY, f64::min)
}

/// The same of what serves a geometry.
pub(super) fn check_geometry(geometry: &Geometry, rays: usize, seed: u64, place: impl Fn(Line) -> Line) -> f64 {
    check_geometry_with(&mut Searched::default(), geometry, rays, seed, place)
}

fn check_geometry_with(
    searched: &mut Searched,
    geometry: &Geometry,
    rays: usize,
    seed: u64,
    place: impl Fn(Line) -> Line,
) -> f64 {
    // Nothing depends on them where nothing moves.
    let mut times = Random::new(seed ^ 1 << 32);
    let mut random = Random::new(seed);
    let features = features(geometry.primitives());
    let mut hits = 0;
    for _ in 0..rays {
        let line = place(line(&mut random, &features));
        let t_max = if random.below(4) == 0 { random.unit() * 2.0 } else { f64::INFINITY };
        let leaves = match random.below(3) {
            0 => PrimitiveId(random.below(geometry.len()) as u32),
            _ => PrimitiveId::NONE,
        };
        hits += agrees_with(searched, geometry, line, t_max, leaves, times.unit());
    }
    hits as f64 / (2 * rays) as f64
}
