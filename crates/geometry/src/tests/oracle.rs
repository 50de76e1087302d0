//! Our shapes and tree, held to the oracle's laws of intersection with its generators.

use crate::small_scene::FLAT_LIMIT;
use crate::test_support::primitive;
use crate::{Geometry, Ray};
use etalon_optics::{Real, Vec3};
use etalon_oracle::generators::{Shape, scenes};
use etalon_oracle::laws::{self, SINGLE};
use etalon_oracle::subjects::{Builds, Hit, Intersects};
use etalon_oracle::{Verdict, intersects_suite, suite};
use rayon::prelude::*;
use std::marker::PhantomData;

/// Our geometry, for rays of scalar type `R`; with a tree above this many primitives.
struct Ours<R> {
    flat_limit: usize,
    scalar: PhantomData<R>,
}

impl<R> Ours<R> {
    /// As everyone has it.
    const BUILT: Self = Self { flat_limit: FLAT_LIMIT, scalar: PhantomData };
    /// Trees even of few primitives.
    const TREES: Self = Self { flat_limit: 0, scalar: PhantomData };
}

struct Built<R> {
    geometry: Geometry,
    scalar: PhantomData<R>,
}

impl<R: Real> Builds for Ours<R> {
    fn build(&self, shapes: &[Shape]) -> Box<dyn Intersects> {
        let primitives = shapes.iter().filter_map(primitive).collect();
        let geometry = Geometry::build_with(primitives, self.flat_limit).expect("few enough shapes");
        Box::new(Built { geometry, scalar: PhantomData::<R> })
    }

    fn epsilon(&self) -> f64 {
        if size_of::<R>() == 4 { SINGLE } else { f64::EPSILON }
    }
}

impl<R: Real> Built<R> {
    fn ray(origin_m: [f64; 3], direction: [f64; 3], t_max: f64) -> Ray<R> {
        Ray { t_max: R::from_f64(t_max), ..Ray::free(Vec3::from_f64(origin_m), Vec3::from_f64(direction)) }
    }
}

impl<R: Real> Intersects for Built<R> {
    fn intersect(&self, origin_m: [f64; 3], direction: [f64; 3], t_max: f64) -> Option<Hit> {
        let ray = Self::ray(origin_m, direction, t_max);
        let hit = self.geometry.closest_hit(&ray)?;
        let normal = self.geometry.surface(&ray, &hit).normal.to_f64().to_array();
        Some(Hit { t: hit.t.to_f64(), normal })
    }

    fn occluded(&self, origin_m: [f64; 3], direction: [f64; 3], t_max: f64) -> bool {
        self.geometry.occluded(&Self::ray(origin_m, direction, t_max))
    }
}

intersects_suite!(rays_in_f64, Ours::<f64>::BUILT, rays: 4_000, seed: 1);
intersects_suite!(rays_in_f32, Ours::<f32>::BUILT, rays: 4_000, seed: 2);
intersects_suite!(trees_in_f64, Ours::<f64>::TREES, rays: 2_000, seed: 3);
intersects_suite!(trees_in_f32, Ours::<f32>::TREES, rays: 2_000, seed: 4);

/// `cargo test --release -p etalon-geometry -- --ignored million`
#[test]
#[ignore = "two minutes and a half of two cores; run by hand when the tree or a shape changes"]
#[allow(clippy::print_stdout, reason = "what was tried is for whoever asks for it")]
fn a_million_rays_a_generator_meet_in_company_what_they_meet_alone() {
    let few = [Ours::<f64>::BUILT, Ours::<f64>::TREES];
    scenes(f64::EPSILON, 7).par_iter().flat_map(|scene| few.par_iter().map(move |ours| (scene, ours))).for_each(
        |(scene, ours)| {
            if ours.flat_limit > 0 && scene.shapes.len() > FLAT_LIMIT {
                // The same tree as the other's.
                return;
            }
            let verdict = laws::neighbours_change_no_hit(ours, scene, 1_000_000, 7);
            println!("{verdict}");
            verdict.assert();
        },
    );
}

/// `cargo test --release -p etalon-geometry -- --ignored escape`
#[test]
#[ignore = "some seconds of two cores; run by hand when the tree or the triangle changes"]
#[allow(clippy::print_stdout, reason = "what was tried is for whoever asks for it")]
fn of_ten_million_rays_none_escapes_from_a_closed_mesh() {
    let subject = Ours::<f64>::BUILT;
    let meshes: Vec<_> = suite::closed_meshes(f64::EPSILON).collect();
    let each = 10_000_000_usize.div_ceil(meshes.len());
    let verdicts: Vec<Verdict> =
        meshes.par_iter().map(|mesh| laws::built_mesh_is_tight(&subject, mesh, each, 7)).collect();
    for verdict in verdicts {
        println!("{verdict}");
        verdict.assert();
    }
}
