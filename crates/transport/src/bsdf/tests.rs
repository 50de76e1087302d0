//! The rules and tables that materials are prepared with, against closed forms and independent quadrature.

use super::albedo::{Azimuths, LossTable, NODES, extremes, node};
use super::glass_losses::{glass_table, loss, mean_transmittance, polarised_loss};
use super::metal::{OfMetal, PathMetal};
use super::microfacet::{Distribution, MEAN_ERROR, gauss_rule, mean_over_facets};
use super::mueller::PolarisedLoss;
use super::oren_nayar::albedo;
use super::plastic::let_in;
use super::{Bsdf, Shading};
use etalon_optics::{ComplexIndex, Lanes, Spectrum, Vec3, fresnel};
use etalon_oracle::laws::{Masking, fresnel_exact, ggx_albedo};
use etalon_oracle::truths::walsh_reflectance;
use etalon_scene::{MaterialKind, Metal};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

mod anisotropic;
mod beckmann;
mod stored;
mod viewers;

const RANGE_NM: [f64; 2] = [380.0, 780.0];

/// Facets of one width.
fn ggx(alpha: f64) -> Distribution {
    Distribution::new(&alpha.into())
}

/// A direction of this cosine: of facets of one width no more of it counts.
fn toward(mu: f64) -> Vec3<f64> {
    Vec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, mu)
}

#[test]
fn rules_integrate_polynomials_up_to_their_degree() {
    for points in [1, 2, 3, 8, 24, 48] {
        for degree in 0..2 * points {
            let sum: f64 = gauss_rule(points).iter().map(|(x, weight)| weight * x.powi(degree as i32)).sum();
            // Sums of at most 48 terms below 1.
            assert!((sum * (degree as f64 + 1.0) - 1.0).abs() < 1e-12, "{points} points, degree {degree}: {sum}");
        }
    }
}

#[test]
fn indices_within_a_range_lie_between_their_extremes() {
    assert_eq!(extremes([400.0, 800.0], |nm| 1000.0 / nm), [1.25, 2.5]);
    assert_eq!(extremes([400.0, 800.0], |nm| nm / 1000.0), [0.4, 0.8]);
    // Half way is one of the places.
    assert_eq!(extremes([400.0, 800.0], |nm| 1.0 + (nm - 600.0).powi(2)), [1.0, 40_001.0]);
}

/// To 2e-5, of which the oracle's own error is 1e-5.
#[test]
fn what_facets_lose_is_what_an_independent_quadrature_misses() {
    let pairs = [
        (0.03, 0.05),
        (0.03, 0.2),
        (0.1, 0.02),
        (0.1, 0.2),
        (0.3, 0.05),
        (0.3, 0.2),
        (1.0, 0.05),
        (1.0, 0.3),
        (1.0, 0.9),
        // Where a rule of even azimuths meets the circle of total reflection at its edge: it was off by 7e-4 here.
        (1.0, 0.745),
    ];
    for (alpha, mu) in pairs {
        let ggx = ggx(alpha);
        for eta in [None, Some(1.5), Some(1.0 / 1.5)] {
            let truth = ggx_albedo(alpha, mu, eta, Masking::Correlated);
            let truth = 1.0 - truth.reflected - truth.refracted;
            let read = match eta {
                None => mean_over_facets(&ggx, toward(mu), None, |facet| 1.0 - facet.mirrored),
                Some(eta) => loss(&ggx, toward(mu), eta),
            };
            assert!((read - truth).abs() < 2e-5, "η {eta:?}, α {alpha} µ {mu}: {read} is not {truth}");
        }
        // What is the same on both sides is no interface.
        assert_eq!(loss(&ggx, toward(mu), 1.0), 0.0);
    }
}

/// Every direction sees as many facets as there is light in it, whatever it is divided at: to the rule's 5e-6 of all light.
#[test]
fn the_facets_that_a_direction_sees_together_fill_it() {
    for alpha in [1e-4, 1e-3, 0.03, 0.3, 1.0] {
        for mu in [1e-6, 1e-3, 0.1, 0.7, 1.0] {
            for eta in [None, Some(1.5), Some(1.0 / 1.5), Some(1.0 / 2.4), Some(0.999), Some(1e-9), Some(1e9)] {
                let all = mean_over_facets(&ggx(alpha), toward(mu), eta, |_| 1.0);
                assert!((all - 1.0).abs() < 5e-6, "η {eta:?}, α {alpha} µ {mu}: {all}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// The tables of rough glass hold what an independent quadrature over all facets finds lost: what they give back is never more than
    /// that by 1e-4 of all light, and never less by 1e-3 of it. Facets narrower than 0.05 are too narrow for the quadrature's grid.
    #[test]
    fn tables_of_rough_glass_hold_what_an_independent_quadrature_finds_lost(
        alpha in 0.05..1.0_f64, n in 1.1..2.6_f64, mu in 0.02..1.0_f64, dispersion in 0.0..0.05_f64, inside: bool,
    ) {
        let of: fn(f64) -> f64 = if inside { f64::recip } else { |n| n };
        let table = glass_table(&ggx(alpha), [n, n + dispersion], of);
        for n in [n, n + 0.4 * dispersion] {
            let truth = ggx_albedo(alpha, mu, Some(of(n)), Masking::Correlated);
            let truth = 1.0 - truth.reflected - truth.refracted;
            let over = table.eval(toward(mu), n) - truth;
            prop_assert!(over < 1e-4 && over > -1e-3, "α {}, n {}, µ {}: {} too much of {}", alpha, n, mu, over, truth);
        }
    }
}

/// On the mean over diffuse light the tables give back less than is lost, by at most 1.5e-4 of all light: what the many times that light
/// meets the surface from inside a body may add up. In no direction do they give back more than 1e-4 too much, also between their nodes.
fn gives_back_all_but_little(what: &str, table: &LossTable, eta: f64, loss: impl Fn(f64) -> f64) {
    // In √µ the loss of a narrow width is smooth enough for midpoints.
    let at = |i: u32| (f64::from(i) + 0.5) / 400.0;
    let losses: Vec<f64> = (0..400).map(|i| loss(at(i).powi(2))).collect();
    let lost = (0..400).map(|i| at(i).powi(3) * 4.0 / 400.0 * losses[i as usize]).sum::<f64>();
    let missing = lost - table.average(eta);
    assert!((0.0..1.5e-4).contains(&missing), "{what}: {missing} of {lost}");
    for i in 0..400 {
        let over = table.eval(toward(at(i).powi(2)), eta) - losses[i as usize];
        assert!(over < 1e-4, "{what}, µ {}: {over} too much", at(i).powi(2));
    }
}

#[test]
fn tables_of_rough_surfaces_give_back_all_but_little_of_diffuse_light_and_never_more() {
    for alpha in [1e-3, 0.01, 0.1, 0.5, 1.0] {
        let ggx = ggx(alpha);
        let mirrors = |mu: f64| mean_over_facets(&ggx, toward(mu), None, |facet| 1.0 - facet.mirrored);
        let table = LossTable::new(Azimuths::All, [1.0, 1.0], MEAN_ERROR, |wo, _| mirrors(wo.z));
        gives_back_all_but_little(&format!("mirrors, α {alpha}"), &table, 1.0, mirrors);
        for n in [1.5, 2.4] {
            for of in [(|n| n) as fn(f64) -> f64, f64::recip] {
                let what = format!("α {alpha}, η {}", of(n));
                gives_back_all_but_little(&what, &glass_table(&ggx, [n, n], of), n, |mu| loss(&ggx, toward(mu), of(n)));
            }
        }
    }
}

/// T of diffuse light from outside is 1 less Walsh's reflectance, and from inside, by reciprocity, 1/n² of that.
#[test]
fn diffuse_light_is_transmitted_as_walsh_says() {
    for n in [1.1, 1.33, 1.5, 2.4] {
        let truth = 1.0 - walsh_reflectance(n);
        let [outside, inside] = [n, 1.0 / n].map(mean_transmittance);
        // The rule's own error: T has a root at the critical angle.
        assert!((outside - truth).abs() < 1e-6, "n {n}: {outside} is not {truth}");
        assert!((inside * n * n - truth).abs() < 1e-5, "n {n} from inside: {} is not {truth}", inside * n * n);
    }
    assert!((mean_transmittance(1.0) - 1.0).abs() < 1e-12);
}

/// The albedo of a white rough diffuse surface is the mean of A(1 + r·s/t) over cosine-weighted directions, here by midpoints in cos² and azimuth.
#[test]
fn rough_diffuse_surfaces_have_the_albedo_of_their_scattering() {
    let steps = 200;
    let place = |i: usize| (i as f64 + 0.5) / steps as f64;
    for (roughness, mu) in [(0.0, 0.4), (0.5, 0.9), (1.0, 0.6), (1.0, 0.2), (0.7, 0.3)] {
        let scale = 1.0 / (1.0 + roughness * (0.5 - 2.0 / (3.0 * PI)));
        let of = |i: usize| {
            let (mu_i, turn) = (place(i % steps).sqrt(), PI * place(i / steps));
            let s = f64::sqrt((1.0 - mu * mu) * (1.0 - mu_i * mu_i)) * turn.cos();
            let t = if s > 0.0 { f64::max(mu, mu_i) } else { 1.0 };
            scale * (1.0 + roughness * s / t)
        };
        let truth = (0..steps * steps).map(of).sum::<f64>() / (steps * steps) as f64;
        let read = albedo(roughness, scale, mu);
        // The midpoint rule, at the kink where s = 0.
        assert!((read - truth).abs() < 1e-4, "r {roughness} µ {mu}: {read} is not {truth}");
    }
}

/// A loss of which all is known: 2∫ℓµ dµ = (η − 1)/20 + 1/20.
fn known_loss(wo: Vec3<f64>, eta: f64) -> f64 {
    known_loss_at(wo.z, eta)
}

fn known_loss_at(mu: f64, eta: f64) -> f64 {
    0.3 * (eta - 1.0) * (1.0 - mu) * (1.0 - mu) + 0.05
}

/// Between its nodes, in cosine and in index, a table is nowhere above the loss by more than 3e-5 of it: the lowered line meets the loss in
/// the middle, at a slope that is a little off. It is below by at most 3e-4: a parabola of this second derivative lies h²/8 of it below
/// its chords, 4e-5 for nodes h ≤ 2/80 apart, and lowering takes as much again from either end.
#[test]
fn a_table_of_losses_lies_just_below_them() {
    for (range, error) in [([1.5, 1.5], 0.0), ([1.4, 1.8], 0.0), ([1.4, 1.8], 0.02)] {
        let table = LossTable::new(Azimuths::All, range, error, known_loss);
        for eta in [range[0], 0.7 * range[0] + 0.3 * range[1], range[1]] {
            for i in 0..=1000 {
                let mu = f64::from(i) / 1000.0;
                let (read, truth) = (table.eval(toward(mu), eta) / (1.0 - error), known_loss_at(mu, eta));
                assert!(read <= truth * (1.0 + 3e-5) && read > truth - 3e-4, "µ {mu}, η {eta}: {read} is not {truth}");
            }
            let (read, truth) = (table.average(eta) / (1.0 - error), 0.05 * eta);
            assert!(read <= truth && read > truth - 3e-4, "η {eta}: {read} is not {truth}");
        }
        // Beyond its indices it goes on as at their end.
        assert_eq!(table.eval(toward(0.3), 9.0), table.eval(toward(0.3), range[1]));
    }
    // Nor above them in the middle of its cells where the chord between two indices is, by .004 of the loss.
    let convex = |wo: Vec3<f64>, eta: f64| known_loss(wo, eta) * (1.0 + 0.1 * (eta - 1.6) * (eta - 1.6));
    let table = LossTable::new(Azimuths::All, [1.4, 1.8], 0.0, convex);
    for i in 1..NODES {
        let mu = 0.5 * (node(i - 1) + node(i));
        let (read, truth) = (table.eval(toward(mu), 1.6), convex(toward(mu), 1.6));
        assert!(read <= truth * (1.0 + 1e-12) && read > truth * (1.0 - 4e-3), "µ {mu}: {read} is not {truth}");
    }
}

/// The share of directions below a cosine, from the density alone, which is a multiple of the cosine in each cell.
fn share_below(table: &LossTable, mu: f64) -> f64 {
    (0..NODES - 1)
        .map(|i| (node(i), node(i + 1).min(mu)))
        .filter(|(low, high)| low < high)
        .map(|(low, high)| TAU * table.density(0.5 * (low + high)) * (high - low))
        .sum()
}

#[test]
fn directions_are_drawn_as_their_density_and_the_loss_say() {
    let table = LossTable::new(Azimuths::All, [1.4, 1.8], 0.0, known_loss);
    assert!((share_below(&table, 1.0) - 1.0).abs() < 1e-12);
    for i in 0..200 {
        let u = [(f64::from(i) + 0.3) / 200.0, f64::from(i % 8) / 8.0];
        let direction = table.sample(u);
        assert!((share_below(&table, direction.z) - u[0]).abs() < 1e-9, "{u:?}: {direction:?}");
        assert!((direction.length() - 1.0).abs() < 1e-12);
        let (sin, cos) = (TAU * u[1]).sin_cos();
        let across = (1.0 - direction.z * direction.z).sqrt();
        assert!(
            (direction.x - across * cos).abs() + (direction.y - across * sin).abs() < 1e-12,
            "{u:?}: {direction:?}"
        );
    }
    // ∫ℓµ dµ up to ½ over that up to 1, the mean over both ends of the indices: ℓ = 0.18(1 − µ)² + 0.05.
    let below = |mu: f64| 0.18 * (mu * mu / 2.0 - 2.0 * mu.powi(3) / 3.0 + mu.powi(4) / 4.0) + 0.025 * mu * mu;
    // The table lies up to 3e-4 of 0.05 or more below.
    assert!((share_below(&table, 0.5) - below(0.5) / below(1.0)).abs() < 3e-3);
    // Where nothing is lost nothing is drawn.
    assert_eq!(LossTable::new(Azimuths::All, [1.0, 1.0], 0.0, |_, _| 0.0).density(0.5), 0.0);
}

/// By steps of √R, between which it is linear.
#[test]
fn a_function_of_a_metal_given_by_its_reflectance_is_found_by_it() {
    let metal = PathMetal::new(&Metal::Reflectance(Spectrum::Constant(0.5).into()), RANGE_NM);
    // (n² + k²) made bounded: R itself is k²/(4 + k²).
    let of_metal = OfMetal::new(&metal, RANGE_NM, |n, k| n * (1.0 + k * k / (4.0 + k * k)));
    for i in 0..100 {
        let reflectance = f64::from(i) / 100.0;
        let read = of_metal.eval(550.0, Metal::k_of(reflectance));
        // (1/256)²/8 of the second derivative, 2.
        assert!((read - 1.0 - reflectance).abs() < 4e-6, "{reflectance}: {read}");
    }
}

/// What an interface does to light of one state: the powers that it reflects and refracts, and the shares of either that other facets let pass.
struct OfState {
    r: f64,
    t: f64,
    mirrored: f64,
    passed: f64,
}

/// (w_s − w_p)/(w_s + w_p) of the light that `of` tells of each state, by an even grid over slopes and azimuths of facets, which no sampler
/// knows: of each facet that light of the cosine `mu` sees, in its own s and p, turned into the surface's.
fn diattenuation(alpha: f64, mu: f64, eta: f64, of: impl Fn(OfState) -> f64) -> f64 {
    let o = [(1.0 - mu * mu).sqrt(), 0.0, mu];
    let lambda = |cos: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 - cos * cos) / (cos * cos)).sqrt() - 1.0);
    let (lambda_o, steps) = (lambda(mu), 160);
    let mut sums = [0.0; 2];
    for k in 0..steps * steps {
        let place = |k: usize| (k as f64 + 0.5) / steps as f64;
        let (x, phi) = (place(k % steps), PI * place(k / steps));
        let tan2 = alpha * alpha * x / (1.0 - x);
        let cos_h = 1.0 / (1.0 + tan2).sqrt();
        let sin_h = tan2.sqrt() * cos_h;
        let h = [sin_h * phi.cos(), sin_h * phi.sin(), cos_h];
        let c = o[0] * h[0] + o[2] * h[2];
        if c <= 0.0 {
            continue;
        }
        let seen = c / (cos_h * (1.0 + lambda_o));
        let powers = fresnel_exact(c.min(1.0), eta);
        let up = 2.0 * c * h[2] - o[2];
        let mirrored = if up > 0.0 { (1.0 + lambda_o) / (1.0 + lambda_o + lambda(up)) } else { 0.0 };
        let square = 1.0 - (1.0 - c * c) / (eta * eta);
        let down = if square > 0.0 { o[2] / eta - (c / eta - square.sqrt()) * h[2] } else { 0.0 };
        let passed = if down > 0.0 { 1.0 / (1.0 + lambda(down)) } else { 0.0 };
        let s = of(OfState { r: powers.r_s, t: powers.t_s, mirrored, passed });
        let p = of(OfState { r: powers.r_p, t: powers.t_p, mirrored, passed });
        // The facet's s is o × h, the surface's y.
        let across = [-o[2] * h[1], o[2] * h[0] - o[0] * h[2], o[0] * h[1]];
        let squared: f64 = across.iter().map(|a| a * a).sum();
        sums[0] += seen * 0.5 * (s + p);
        sums[1] += seen * 0.5 * (s - p) * (2.0 * across[1] * across[1] / squared - 1.0);
    }
    sums[1] / sums[0]
}

/// To 1.5e-2, which the grid of 160 by 160 facets and the chords between a table's nodes explain.
#[test]
fn what_is_lost_of_polarised_light_is_what_an_independent_quadrature_misses() {
    let lost = |of: OfState| of.r * (1.0 - of.mirrored) + of.t * (1.0 - of.passed);
    for alpha in [0.3, 1.0] {
        let ggx = ggx(alpha);
        for inside in [false, true] {
            let side = |eta: f64| if inside { 1.0 / eta } else { eta };
            let of = |range| PolarisedLoss::new(range, &ggx, |facet, eta| polarised_loss(&ggx, facet, side(eta)));
            let (one, two) = (of([1.5, 1.5]), of([1.4, 1.6]));
            for mu in [0.9, 0.5, 0.2] {
                for (table, eta) in [(&one, 1.5), (&two, 1.4), (&two, 1.45), (&two, 1.6)] {
                    let (read, truth) = (table.eval(toward(mu), eta)[0], diattenuation(alpha, mu, side(eta), lost));
                    assert!((read - truth).abs() < 1.5e-2, "α {alpha} µ {mu} η {eta} {inside}: {read} is not {truth}");
                }
            }
        }
    }
}

/// All that does not leave by reflection, also where a coat of less than vacuum's index reflects totally.
#[test]
fn a_coat_lets_in_of_polarised_light_what_an_independent_quadrature_finds() {
    for (alpha, eta) in [0.3, 1.0].into_iter().flat_map(|alpha| [1.5, 1.0 / 1.5].map(|eta| (alpha, eta))) {
        let table = PolarisedLoss::new([eta, eta], &ggx(alpha), let_in);
        for mu in [0.9, 0.6, 0.4, 0.2] {
            let (read, truth) =
                (table.eval(toward(mu), eta)[0], diattenuation(alpha, mu, eta, |of| 1.0 - of.r * of.mirrored));
            // As for what is lost.
            assert!((read - truth).abs() < 1e-2, "α {alpha} µ {mu} η {eta}: {read} is not {truth}");
        }
    }
}

/// Between two nodes, in the cosine and in the index, it is the mean of what it is at them half way.
#[test]
fn what_is_lost_of_polarised_light_is_linear_between_nodes() {
    let ggx = ggx(0.5);
    let table = PolarisedLoss::new([1.4, 1.6], &ggx, |facet, eta| polarised_loss(&ggx, facet, eta));
    for i in 1..NODES {
        let ends = [node(i - 1), node(i)].map(|mu| table.eval(toward(mu), 1.4)[0]);
        let middle = table.eval(toward(0.5 * (node(i - 1) + node(i))), 1.4)[0];
        assert!((middle - 0.5 * (ends[0] + ends[1])).abs() < 1e-12, "{i}: {middle} between {ends:?}");
        let between = table.eval(toward(node(i)), 1.5)[0];
        assert!((between - 0.5 * (ends[1] + table.eval(toward(node(i)), 1.6)[0])).abs() < 1e-12, "{i}");
    }
}

/// What light that meets several facets of a metal adds is (1 − E(µ_o))(1 − E(µ_i))/(π(1 − Ē)) of the F̄²Ē/(1 − F̄(1 − Ē)) that is not absorbed on its way
/// (Kulla & Conty 2017), with the albedos of facets by independent quadrature. The metal absorbs enough for a power of F̄ to be told from another.
#[test]
fn what_several_facets_of_a_metal_add_is_coloured_by_as_many_reflections() {
    let (alpha, n, k) = (0.8, 1.5, 3.0);
    let bsdf = |compensated| {
        let index = ComplexIndex::tabulated(vec![300.0, 900.0], vec![n; 2], vec![k; 2]).unwrap();
        let kind =
            MaterialKind::RoughConductor { metal: Metal::Index(index), facets: alpha.into(), compensated, film: None };
        Bsdf::new(&kind, RANGE_NM)
    };
    let at = |i: u32, steps: u32| (f64::from(i) + 0.5) / f64::from(steps);
    let albedo = |mu: f64| ggx_albedo(alpha, mu, None, Masking::Correlated).reflected;
    let mean_albedo = (0..12).map(|i| 2.0 * at(i, 12) * albedo(at(i, 12)) / 12.0).sum::<f64>();
    let of_facet = |mu: f64| 2.0 * mu * fresnel::conductor(mu, n, k).reflectance;
    let mean = (0..10_000).map(|i| of_facet(at(i, 10_000)) / 10_000.0).sum::<f64>();
    let colour = mean * mean * mean_albedo / (1.0 - mean * (1.0 - mean_albedo));
    let (whole, single) = (bsdf(true), bsdf(false));
    for (mu_o, mu_i) in [(0.9, 0.5), (0.3, 0.7), (0.2, 0.2)] {
        let direction = |mu: f64, sign: f64| Vec3::new(sign * (1.0 - mu * mu).sqrt(), 0.0, mu);
        let eval = |bsdf: &Bsdf| {
            let up = Shading::flat(Vec3::new(0.0, 0.0, 1.0));
            bsdf.eval::<1>(&Lanes([550.0]), &up, direction(mu_o, 1.0), direction(mu_i, -1.0)).0[0]
        };
        let read = eval(&whole) - eval(&single);
        let truth = mu_i * (1.0 - albedo(mu_o)) * (1.0 - albedo(mu_i)) / (PI * (1.0 - mean_albedo)) * colour;
        // Twelve midpoints and the tables.
        assert!((read / truth - 1.0).abs() < 0.01, "{mu_o} {mu_i}: {read} is not {truth}");
    }
}
