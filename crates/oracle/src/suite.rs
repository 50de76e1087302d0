//! Whole suites for a subject, and the macros that turn them into tests.

use std::{cell::LazyCell, rc::Rc};

use crate::{
    Verdict,
    generators::{self, Aim, ClosedMesh},
    laws,
    statistics::Budget,
    subjects::{Builds, Emits, Scatters},
};

/// Every law of a BSDF. The statistical ones share one budget, so that a right subject fails anything at all with
/// probability [`crate::statistics::SUITE_SIGNIFICANCE`].
#[must_use]
pub fn scatters(subject: &dyn Scatters, seed: u64) -> Vec<Verdict> {
    scatters_law_by_law(subject, seed).collect()
}

/// The verdicts of [`scatters`], each found when it is asked for, the quickest first: for whoever wants to know only whether
/// any law is broken.
pub fn scatters_law_by_law(subject: &dyn Scatters, seed: u64) -> impl Iterator<Item = Verdict> {
    let budget = Budget::for_tests(3);
    let albedos = Rc::new(LazyCell::new(move || laws::Albedos::new(subject, seed)));
    let again = Rc::clone(&albedos);
    let laws: [Box<dyn Fn() -> Verdict + '_>; 8] = [
        Box::new(move || laws::f_and_pdf_are_proper(subject, seed)),
        Box::new(move || laws::is_reciprocal(subject, seed)),
        Box::new(move || laws::sample_is_consistent(subject, seed)),
        Box::new(move || laws::etendue_is_conserved(subject, seed)),
        Box::new(move || albedos.create_no_energy()),
        Box::new(move || laws::pdf_integrates_to_one(subject, budget, seed)),
        Box::new(move || laws::samples_follow_pdf(subject, budget, seed)),
        Box::new(move || again.agree_with_samples(subject, budget)),
    ];
    laws.into_iter().map(|law| law())
}

/// Every law of a light, from each of the given points, m. `pdf_tolerance` as in [`laws::light_pdf_integrates_to_one`].
#[must_use]
pub fn emits(subject: &dyn Emits, from_m: &[[f64; 3]], pdf_tolerance: f64, seed: u64) -> Vec<Verdict> {
    let budget = Budget::for_tests(4 * from_m.len());
    from_m.iter().flat_map(|point| laws::light_laws(subject, *point, pdf_tolerance, budget, seed)).collect()
}

/// Every law of shapes and the tree over them, with `rays` rays for each scene and mesh. Right or wrong: no statistics.
#[must_use]
pub fn intersects(subject: &dyn Builds, rays: usize, seed: u64) -> Vec<Verdict> {
    let scenes = generators::scenes(subject.epsilon(), seed);
    let mut verdicts: Vec<Verdict> =
        scenes.iter().map(|scene| laws::neighbours_change_no_hit(subject, scene, rays, seed)).collect();
    verdicts.extend(closed_meshes(subject.epsilon()).map(|mesh| laws::built_mesh_is_tight(subject, &mesh, rays, seed)));
    verdicts.push(laws::needles_are_hit_where_they_are(subject, rays, seed));
    verdicts.push(laws::near_surfaces_are_hit(subject, rays, seed));
    verdicts.push(zeros_and_scales(subject, seed));
    verdicts
}

/// The closed meshes of [`intersects`], where they stand and moved as far as their vertices stay apart.
pub fn closed_meshes(epsilon: f64) -> impl Iterator<Item = ClosedMesh> {
    let far = if epsilon > 1e-10 { 1e2 } else { 1e6 };
    [ClosedMesh::cube(), ClosedMesh::sphere(16, 16), ClosedMesh::needles(30, 1e3)].into_iter().flat_map(move |mesh| {
        [0.0, 1e-2 * far, far].map(|by: f64| mesh.clone().moved([by, -0.3 * by, 0.6 * by], epsilon))
    })
}

/// Signed zeros and powers of two, on a cube and a ball of triangles.
fn zeros_and_scales(subject: &dyn Builds, seed: u64) -> Verdict {
    let cube = subject.build(&ClosedMesh::cube().shapes(1.0));
    let zeros = laws::signed_zeros_are_equal(cube.as_ref(), &[[0.0; 3], [0.5, -0.25, 0.125]], 5.0);
    let ball = ClosedMesh::sphere(16, 16);
    let aims: Vec<Aim> = ball.aims(300, subject.epsilon(), seed).collect();
    let build = |factor: f64| subject.build(&ball.shapes(factor));
    let scales = laws::powers_of_two_are_exact(build, &aims, &[-30, -20, -3, 7, 20, 30]);
    Verdict::worst_of("signed zeros are equal, and powers of two exact", [zeros, scales])
}

/// Makes a module of tests, one a law, that hold a BSDF to everything the oracle knows.
///
/// ```
/// # use etalon_oracle::subjects::{Scatters, Scattered};
/// # #[derive(Clone)] struct Matte;
/// # impl Scatters for Matte {
/// #     fn f(&self, _: [f64; 3], _: [f64; 3], _: f64) -> f64 { 0.0 }
/// #     fn pdf(&self, _: [f64; 3], _: [f64; 3], _: f64) -> f64 { 0.0 }
/// #     fn sample(&self, _: [f64; 3], _: [f64; 3], _: f64) -> Option<Scattered> { None }
/// # }
/// etalon_oracle::scatters_suite!(matte, Matte);
/// ```
#[macro_export]
macro_rules! scatters_suite {
    ($name:ident, $subject:expr) => {
        $crate::scatters_suite!($name, $subject, seed: 1);
    };
    ($name:ident, $subject:expr, seed: $seed:expr) => {
        #[cfg(test)]
        mod $name {
            #[allow(unused_imports, reason = "the subject's expression may or may not need what surrounds it")]
            use super::*;

            /// Made once for all tests: what tabulates its facets takes seconds.
            fn subject() -> &'static dyn $crate::subjects::Scatters {
                type Subject = Box<dyn $crate::subjects::Scatters + Send + Sync>;
                static SUBJECT: std::sync::LazyLock<Subject> = std::sync::LazyLock::new(|| Box::new($subject));
                &**SUBJECT
            }

            static ALBEDOS: std::sync::LazyLock<$crate::laws::Albedos> =
                std::sync::LazyLock::new(|| $crate::laws::Albedos::new(subject(), $seed));

            #[test]
            fn f_and_pdf_are_proper() {
                $crate::laws::f_and_pdf_are_proper(subject(), $seed).assert();
            }
            #[test]
            fn is_reciprocal() {
                $crate::laws::is_reciprocal(subject(), $seed).assert();
            }
            #[test]
            fn sample_is_consistent() {
                $crate::laws::sample_is_consistent(subject(), $seed).assert();
            }
            #[test]
            fn etendue_is_conserved() {
                $crate::laws::etendue_is_conserved(subject(), $seed).assert();
            }
            #[test]
            fn energy_is_not_created() {
                ALBEDOS.create_no_energy().assert();
            }
            #[test]
            fn pdf_integrates_to_one() {
                $crate::laws::pdf_integrates_to_one(subject(), $crate::statistics::Budget::for_tests(3), $seed).assert();
            }
            #[test]
            fn samples_follow_pdf() {
                $crate::laws::samples_follow_pdf(subject(), $crate::statistics::Budget::for_tests(3), $seed).assert();
            }
            #[test]
            fn furnace_agrees() {
                ALBEDOS.agree_with_samples(subject(), $crate::statistics::Budget::for_tests(3)).assert();
            }
        }
    };
}

/// Makes a module of tests that hold a light to everything the oracle knows, from the given points, m.
///
/// `pdf_tolerance` is the error accepted in ∫pdf, which is that of quadrature at the light's rim: 1e-6 for a light that is a
/// circular cone about the axis of its `extent`, about 1e-3 for one with corners.
#[macro_export]
macro_rules! emits_suite {
    ($name:ident, $subject:expr, from: $points:expr, pdf_tolerance: $tolerance:expr) => {
        $crate::emits_suite!($name, $subject, from: $points, pdf_tolerance: $tolerance, seed: 1);
    };
    ($name:ident, $subject:expr, from: $points:expr, pdf_tolerance: $tolerance:expr, seed: $seed:expr) => {
        #[cfg(test)]
        mod $name {
            #[allow(unused_imports, reason = "the subject's expression may or may not need what surrounds it")]
            use super::*;

            #[test]
            fn sample_is_consistent() {
                for point in &$points {
                    $crate::laws::light_sample_is_consistent(&$subject, *point, $seed).assert();
                }
            }
            #[test]
            fn pdf_integrates_to_one() {
                for point in &$points {
                    $crate::laws::light_pdf_integrates_to_one(&$subject, *point, $tolerance, $seed).assert();
                }
            }
            #[test]
            fn samples_follow_pdf() {
                let budget = $crate::statistics::Budget::for_tests(4 * $points.len());
                for point in &$points {
                    $crate::laws::light_samples_follow_pdf(&$subject, *point, budget, $seed).assert();
                }
            }
            #[test]
            fn closed_forms_hold() {
                let budget = $crate::statistics::Budget::for_tests(4 * $points.len());
                for point in &$points {
                    for verdict in $crate::laws::light_closed_forms(&$subject, *point, budget, $seed) {
                        verdict.assert();
                    }
                }
            }
        }
    };
}

/// Makes a module of one test that holds shapes and the tree over them, as a [`Builds`], to everything the oracle knows.
#[macro_export]
macro_rules! intersects_suite {
    ($name:ident, $subject:expr) => {
        $crate::intersects_suite!($name, $subject, rays: 20_000, seed: 1);
    };
    ($name:ident, $subject:expr, rays: $rays:expr, seed: $seed:expr) => {
        #[cfg(test)]
        mod $name {
            #[allow(unused_imports, reason = "the subject's expression may or may not need what surrounds it")]
            use super::*;

            #[test]
            fn every_law_of_intersection_holds() {
                $crate::suite::intersects(&$subject, $rays, $seed).iter().for_each($crate::Verdict::assert);
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use crate::subjects::{Density, Scattered, Scatters};

    /// Absorbs everything, but for what its fault lets through.
    struct Black {
        lets_through: f64,
    }

    impl Scatters for Black {
        fn f(&self, _: [f64; 3], _: [f64; 3], _: f64) -> f64 {
            0.0
        }

        fn pdf(&self, _: [f64; 3], _: [f64; 3], _: f64) -> f64 {
            0.0
        }

        fn sample(&self, wo: [f64; 3], u: [f64; 3], _: f64) -> Option<Scattered> {
            (u[0] < self.lets_through).then_some(Scattered { wi: wo, weight: 0.0, density: Density::Delta(1.0) })
        }
    }

    #[test]
    fn a_body_that_absorbs_everything_obeys_every_law_and_one_that_does_not_quite_breaks_one() {
        super::scatters(&Black { lets_through: 0.0 }, 1).iter().for_each(crate::Verdict::assert);
        assert!(super::scatters(&Black { lets_through: 0.01 }, 1).iter().any(|verdict| !verdict.pass));
    }
}
