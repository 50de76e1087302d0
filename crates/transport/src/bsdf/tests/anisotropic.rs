//! Tables of facets of two widths, against independent quadrature.

use super::super::albedo::{Azimuths, LossTable};
use super::super::microfacet::{Distribution, MEAN_ERROR, mean_over_facets};
use super::super::mueller::PolarisedLoss;
use super::super::plastic::let_in;
use etalon_optics::Vec3;
use etalon_oracle::laws::{Masking, anisotropic_ggx_albedo, fresnel_exact};
use etalon_scene::Microfacets;
use std::f64::consts::{PI, TAU};

fn ggx(alpha: [f64; 2]) -> Distribution {
    Distribution::new(&Microfacets::ggx(alpha, 0.0))
}

/// Of this cosine, `turn` radians from x toward y.
fn toward(mu: f64, turn: f64) -> Vec3<f64> {
    let (along, (sin, cos)) = (((1.0 - mu) * (1.0 + mu)).sqrt(), turn.sin_cos());
    Vec3::new(along * cos, along * sin, mu)
}

fn mirrors(ggx: &Distribution, wo: Vec3<f64>) -> f64 {
    mean_over_facets(ggx, wo, None, |facet| 1.0 - facet.mirrored)
}

/// What a coat of this index lets in.
fn coat(ggx: &Distribution, wo: Vec3<f64>, eta: f64) -> f64 {
    mean_over_facets(ggx, wo, Some(eta), |facet| let_in(facet, eta)[0])
}

/// To 6e-5, of which the oracle's own error is 4e-5: over all azimuths its steps are twice as wide as over half of them.
#[test]
fn what_facets_of_two_widths_lose_is_what_an_independent_quadrature_misses() {
    for (alpha, mu, turn) in [
        ([0.05, 0.4], 0.1, 0.0),
        ([0.05, 0.4], 0.1, 1.5),
        ([0.3, 0.1], 0.3, 0.7),
        ([1.0, 0.2], 0.05, 0.3),
        ([1.0, 0.2], 0.7, 1.2),
        ([0.6, 0.5], 0.9, 2.4),
    ] {
        let facets = ggx(alpha);
        let wo = toward(mu, turn);
        for eta in [None, Some(1.5), Some(2.4)] {
            let truth = 1.0 - anisotropic_ggx_albedo(alpha, wo.to_array(), eta, Masking::Correlated).reflected;
            let read = match eta {
                None => mirrors(&facets, wo),
                Some(eta) => coat(&facets, wo, eta),
            };
            assert!((read - truth).abs() < 6e-5, "η {eta:?}, α {alpha:?} µ {mu} turn {turn}: {read} is not {truth}");
        }
    }
}

#[test]
fn a_place_among_azimuths_is_where_its_direction_lies() {
    for alpha in [[0.1, 0.5], [0.5, 0.1], [1e-4, 1.0], [0.3, 0.300_001]] {
        let azimuths = Azimuths::of(&ggx(alpha));
        for k in 0..=24 {
            let place = 0.5 * f64::from(k);
            for mu in [0.0, 0.4, 0.99] {
                let w = azimuths.direction(mu, place);
                let found = azimuths.place(w);
                assert!((w.length() - 1.0).abs() < 1e-12 && w.x >= 0.0 && w.y >= 0.0);
                // Near the ends the place is a root of what is left by subtraction.
                let off = found.index as f64 + found.share - place;
                assert!(off.abs() < 1e-4, "α {alpha:?} µ {mu}: {place} is found at {found:?}");
                let mirrored = azimuths.place(Vec3::new(-w.x, w.y, -w.z));
                assert_eq!((mirrored.index, mirrored.share), (found.index, found.share));
            }
        }
    }
}

/// (what is missing of diffuse light, the most that is too much in one direction) of a table.
fn misses(table: &LossTable, eta: f64, loss: impl Fn(Vec3<f64>) -> f64) -> (f64, f64) {
    let (mut missing, mut mean, mut all, mut over) = (0.0, 0.0, 0.0, f64::MIN);
    let at = |i: u32, steps: u32| (f64::from(i) + 0.5) / f64::from(steps);
    for i in 0..60 {
        for k in 0..24 {
            let root = at(i, 60);
            let wo = toward(root * root, 0.25 * TAU * at(k, 24));
            let (held, truth) = (table.eval(wo, eta), loss(wo));
            let weight = root.powi(3);
            missing += weight * (truth - held);
            mean += weight * held;
            all += weight;
            over = over.max(held - truth);
        }
    }
    // The midpoints err by 1e-4 in what is not small.
    assert!((mean / all - table.average(eta)).abs() < 3e-4, "{} {}", mean / all, table.average(eta));
    (missing / all, over)
}

/// On the mean over diffuse light the tables give back less than is lost, by at most 5e-4 of all light, and in no direction more than 3e-4
/// too much.
#[test]
fn tables_of_brushed_surfaces_give_back_all_but_little_of_diffuse_light_and_never_more() {
    let (metal, glass) = (None, Some(1.5));
    for (alpha, eta) in
        [([1e-3, 0.1], metal), ([0.05, 0.5], glass), ([0.3, 0.4], metal), ([1.0, 0.1], glass), ([1e-3, 1.0], metal)]
    {
        let facets = ggx(alpha);
        let lost = |wo: Vec3<f64>| eta.map_or_else(|| mirrors(&facets, wo), |eta| coat(&facets, wo, eta));
        let table = LossTable::new(Azimuths::of(&facets), [1.0, 1.0], MEAN_ERROR, |wo, _| lost(wo));
        let (missing, over) = misses(&table, 1.0, lost);
        assert!((0.0..5e-4).contains(&missing) && over < 3e-4, "η {eta:?}, α {alpha:?}: {missing}, {over}");
    }
}

/// (ℓ₁, ℓ₂)/ℓ₀ of light that a coat of facets lets in, by an even grid over slopes and azimuths of facets, which no sampler knows.
fn let_in_of_polarised_light(alpha: [f64; 2], wo: Vec3<f64>, eta: f64) -> [f64; 2] {
    let o = wo.to_array();
    let lambda = |w: [f64; 3]| {
        let slope = (alpha[0] * w[0]).powi(2) + (alpha[1] * w[1]).powi(2);
        0.5 * ((1.0 + slope / (w[2] * w[2])).sqrt() - 1.0)
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (lambda_o, steps) = (lambda(o), 300);
    let sin = o[0].hypot(o[1]);
    // The surface's s, and what is 90° on from it for light that leaves along o.
    let s = [-o[1] / sin, o[0] / sin, 0.0];
    let p = [-o[2] * o[0] / sin, -o[2] * o[1] / sin, sin];
    let mut sums = [0.0; 3];
    for k in 0..steps * steps {
        let place = |k: usize| (k as f64 + 0.5) / steps as f64;
        let (x, phi) = (place(k % steps), TAU * place(k / steps));
        let tan = (x / (1.0 - x)).sqrt();
        let slope = [alpha[0] * tan * phi.cos(), alpha[1] * tan * phi.sin()];
        let cos_h = 1.0 / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        let h = [slope[0] * cos_h, slope[1] * cos_h, cos_h];
        let c = dot(o, h);
        if c <= 0.0 {
            continue;
        }
        let seen = c / (cos_h * (1.0 + lambda_o));
        let powers = fresnel_exact(c.min(1.0), eta);
        let r = [0, 1, 2].map(|i| 2.0 * c * h[i] - o[i]);
        let mirrored = if r[2] > 0.0 { (1.0 + lambda_o) / (1.0 + lambda_o + lambda(r)) } else { 0.0 };
        let [in_s, in_p] = [powers.r_s, powers.r_p].map(|reflected| 1.0 - reflected * mirrored);
        // The facet's s is at right angles to o and h; its Stokes axis in the surface's frame.
        let of_facet = [o[1] * h[2] - o[2] * h[1], o[2] * h[0] - o[0] * h[2], o[0] * h[1] - o[1] * h[0]];
        let (cos, sin) = (dot(of_facet, s), dot(of_facet, p));
        let twice = 2.0 * sin.atan2(cos);
        sums[0] += seen * 0.5 * (in_s + in_p);
        sums[1] += seen * 0.5 * (in_s - in_p) * twice.cos();
        sums[2] += seen * 0.5 * (in_s - in_p) * twice.sin();
    }
    [sums[1] / sums[0], sums[2] / sums[0]]
}

/// To 2e-3, in every quarter of azimuths, and from below.
#[test]
fn what_a_brushed_coat_lets_in_of_polarised_light_is_what_an_independent_quadrature_finds() {
    for (alpha, eta) in [([0.2, 0.8], 1.5), ([1.0, 0.1], 2.4)] {
        let facets = ggx(alpha);
        let table = PolarisedLoss::new([eta, eta], &facets, let_in);
        let mut largest = 0.0_f64;
        for (mu, turn) in [(0.5, 0.0), (0.5, 0.6), (0.3, 2.2), (0.7, 3.9), (0.9, 5.3)] {
            let wo = toward(mu, turn);
            let (read, truth) = (table.eval(wo, eta), let_in_of_polarised_light(alpha, wo, eta));
            for i in 0..2 {
                assert!((read[i] - truth[i]).abs() < 2e-3, "α {alpha:?} µ {mu} turn {turn}: {read:?} is not {truth:?}");
            }
            largest = largest.max(truth[1].abs());
            // Turned by half a turn about x, the surface is the same, seen from its other side.
            let below = table.eval(Vec3::new(wo.x, -wo.y, -wo.z), eta);
            assert!((0..2).all(|i| (below[i] - read[i]).abs() < 1e-12), "{below:?} is not {read:?}");
        }
        // The sense of 45° matters: a wrong sign would move a value by twice this, ten times the tolerance.
        assert!(largest > 0.01, "{largest}");
    }
}

/// Light at right angles to the surface has no plane of incidence, but the grain gives it one.
#[test]
fn along_the_normal_the_grain_prefers_a_state() {
    let facets = ggx([0.1, 1.0]);
    let table = PolarisedLoss::new([2.4, 2.4], &facets, let_in);
    let [straight, _] = table.eval(Vec3::new(0.0, 0.0, 1.0), 2.4);
    let [along_x, _] = table.eval(toward(1.0 - 1e-9, 0.0), 2.4);
    let [along_y, _] = table.eval(toward(1.0 - 1e-9, 0.5 * PI), 2.4);
    assert!((straight - along_x).abs() < 1e-4 && (along_x + along_y).abs() < 1e-3, "{straight} {along_x} {along_y}");
    assert!(along_x.abs() > 0.01, "{along_x}");
}
