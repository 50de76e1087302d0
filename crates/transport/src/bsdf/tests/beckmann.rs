//! Beckmann's facets and separable masking: means, tables and draws against independent quadrature.

use super::super::albedo::{Azimuths, LossTable};
use super::super::glass_losses::{glass_table, loss};
use super::super::microfacet::{Distribution, MEAN_ERROR, mean_over_facets};
use super::{gives_back_all_but_little, toward};
use etalon_optics::Vec3;
use etalon_oracle::laws::{Masking, anisotropic_ggx_albedo, beckmann_albedo};
use etalon_scene::{FacetDistribution, FacetMasking, Microfacets};

fn facets(alpha: [f64; 2], distribution: FacetDistribution, masking: FacetMasking) -> Distribution {
    Distribution::new(&Microfacets { alpha, rotation_rad: 0.0, distribution, masking })
}

fn beckmann(alpha: [f64; 2]) -> Distribution {
    facets(alpha, FacetDistribution::Beckmann, FacetMasking::Correlated)
}

fn mirrors(facets: &Distribution, wo: Vec3<f64>) -> f64 {
    mean_over_facets(facets, wo, None, |facet| 1.0 - facet.mirrored)
}

/// Every direction sees as many facets as there is light in it: to the rule's 5e-6 of all light.
#[test]
fn the_facets_that_a_direction_sees_together_fill_it() {
    for alpha in [1e-4, 1e-3, 0.03, 0.3, 1.0] {
        for mu in [1e-6, 1e-3, 0.1, 0.7, 1.0] {
            for eta in [None, Some(1.5), Some(1.0 / 1.5), Some(1.0 / 2.4), Some(0.999), Some(1e-9), Some(1e9)] {
                let all = mean_over_facets(&beckmann([alpha; 2]), toward(mu), eta, |_| 1.0);
                assert!((all - 1.0).abs() < 5e-6, "η {eta:?}, α {alpha} µ {mu}: {all}");
            }
        }
    }
    for alpha in [[1e-4, 1.0], [0.03, 0.3], [0.8, 0.2], [1.0, 1e-3]] {
        for mu in [1e-6, 1e-3, 0.1, 0.7, 1.0_f64] {
            for turn in [0.0, 0.25, 1.3, 1.57_f64] {
                let s = ((1.0 - mu) * (1.0 + mu)).sqrt();
                let wo = Vec3::new(s * turn.cos(), s * turn.sin(), mu);
                let all = mean_over_facets(&beckmann(alpha), wo, None, |_| 1.0);
                assert!((all - 1.0).abs() < 5e-6, "α {alpha:?} µ {mu} turn {turn}: {all}");
            }
        }
    }
}

/// To 6e-5, of which the oracle's own error is 4e-5.
#[test]
fn what_facets_lose_is_what_an_independent_quadrature_misses() {
    let pairs =
        [([0.03; 2], 0.05), ([0.1; 2], 0.2), ([0.3; 2], 0.05), ([1.0; 2], 0.3), ([1.0; 2], 0.745), ([0.05, 0.4], 0.1)];
    for (alpha, mu) in pairs {
        let wo = toward(mu);
        for eta in [None, Some(1.5), Some(1.0 / 1.5)] {
            if alpha[0] != alpha[1] && eta.is_some() {
                continue;
            }
            for (masking, of_oracle) in
                [(FacetMasking::Correlated, Masking::Correlated), (FacetMasking::Separable, Masking::Separable)]
            {
                for (distribution, truth) in [
                    (FacetDistribution::Beckmann, beckmann_albedo(alpha, wo.to_array(), eta, of_oracle)),
                    (FacetDistribution::Ggx, anisotropic_ggx_albedo(alpha, wo.to_array(), eta, of_oracle)),
                ] {
                    let facets = facets(alpha, distribution, masking);
                    let truth = 1.0 - truth.reflected - truth.refracted;
                    let read = eta.map_or_else(|| mirrors(&facets, wo), |eta| loss(&facets, wo, eta));
                    assert!(
                        (read - truth).abs() < 6e-5,
                        "{distribution:?} {masking:?} η {eta:?}, α {alpha:?} µ {mu}: {read} is not {truth}"
                    );
                }
            }
        }
    }
}

/// As of GGX.
#[test]
fn tables_give_back_all_but_little_of_diffuse_light_and_never_more() {
    for alpha in [1e-3, 0.01, 0.1, 0.5, 1.0] {
        let facets = beckmann([alpha; 2]);
        let of_cosine = |mu: f64| mirrors(&facets, toward(mu));
        let table = LossTable::new(Azimuths::All, [1.0, 1.0], MEAN_ERROR, |wo, _| of_cosine(wo.z));
        gives_back_all_but_little(&format!("mirrors, α {alpha}"), &table, 1.0, of_cosine);
        for of in [(|n| n) as fn(f64) -> f64, f64::recip] {
            let what = format!("α {alpha}, η {}", of(1.5));
            let table = glass_table(&facets, [1.5, 1.5], of);
            gives_back_all_but_little(&what, &table, 1.5, |mu| loss(&facets, toward(mu), of(1.5)));
        }
    }
}

/// Normals are drawn by the density that is stated: the mean over draws of any function of the normal is that of the quadrature over facets.
/// An even grid of 512² numbers errs by less than 1e-3 of the largest value.
#[test]
fn normals_are_drawn_as_they_are_seen() {
    let of = |h: Vec3<f64>| [h.z, h.x, h.x * h.x, h.y * h.y, f64::from(h.x > 0.3)];
    for (alpha, mu) in [([0.5; 2], 1.0), ([0.3; 2], 0.4), ([1.0; 2], 0.02), ([0.2, 0.7], 0.6)] {
        let (facets, wo) = (beckmann(alpha), toward(mu));
        let mut sums = [0.0; 5];
        const STEPS: u32 = 512;
        for k in 0..STEPS * STEPS {
            let u = [k % STEPS, k / STEPS].map(|i| (f64::from(i) + 0.5) / f64::from(STEPS));
            let h = facets.visible_normal(wo, u);
            assert!(wo.dot(h) >= 0.0 && (h.length() - 1.0).abs() < 1e-12);
            sums.iter_mut().zip(of(h)).for_each(|(sum, value)| *sum += value / f64::from(STEPS * STEPS));
        }
        for (i, sum) in sums.iter().enumerate().take(4) {
            let truth = mean_over_facets(&facets, wo, None, |facet| {
                // Of one width the quadrature's azimuth is that of the direction.
                of(facet.h)[i]
            });
            assert!((sum - truth).abs() < 1e-3, "α {alpha:?} µ {mu}, function {i}: {sum} is not {truth}");
        }
    }
    // At the ends of the unit square, too.
    for u in [[0.0, 0.0], [1.0 - 2.0_f64.powi(-53); 2], [0.0, 1.0 - 2.0_f64.powi(-53)]] {
        for mu in [1e-9, 0.5, 1.0] {
            let h = beckmann([1.0; 2]).visible_normal(toward(mu), u);
            assert!((h.length() - 1.0).abs() < 1e-12 && h.z > 0.0, "{u:?} {mu}: {h:?}");
        }
    }
}
