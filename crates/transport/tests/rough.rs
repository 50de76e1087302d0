//! Rough metal and glass: albedos against independent quadrature, the smooth limit, lanes under dispersion, grazing angles.

use etalon_optics::{ComplexIndex, Frame, Lanes, RefractiveIndex, Vec3};
use etalon_oracle::laws::{Masking, fresnel_exact, ggx_albedo};
use etalon_scene::{MaterialKind, Metal};
use etalon_transport::bsdf::{Bsdf, BsdfSample, Shading};
use etalon_transport::mis::Density;

const RANGE_NM: [f64; 2] = [380.0, 780.0];

/// Reflects everything: n → 0 with k > 0.
fn mirrors(alpha: f64, compensated: bool) -> Bsdf {
    let index = ComplexIndex::tabulated(vec![300.0, 900.0], vec![1e-12; 2], vec![3.0; 2]).unwrap();
    Bsdf::new(
        &MaterialKind::RoughConductor { metal: Metal::Index(index), facets: alpha.into(), compensated, film: None },
        RANGE_NM,
    )
}

fn glass(interior: RefractiveIndex, alpha: f64, compensated: bool) -> Bsdf {
    let exterior = RefractiveIndex::VACUUM;
    Bsdf::new(
        &MaterialKind::RoughDielectric {
            interior,
            exterior,
            facets: alpha.into(),
            compensated,
            priority: None,
            film: None,
        },
        RANGE_NM,
    )
}

fn up() -> Vec3<f64> {
    Vec3::new(0.0, 0.0, 1.0)
}

fn direction(mu: f64) -> Vec3<f64> {
    Vec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, mu)
}

fn sample<const N: usize>(bsdf: &Bsdf, lambda: &Lanes<f64, N>, wo: Vec3<f64>, u: [f64; 3]) -> Option<BsdfSample<N>> {
    bsdf.sample(lambda, &Shading::flat(up()), wo, u)
}

/// Points of an additive recurrence with the plastic number's three-dimensional kin, well spread: for smooth means the error
/// falls nearly as 1/n.
fn points(n: u32) -> impl Iterator<Item = [f64; 3]> {
    let g = 1.220_744_084_605_759_5_f64;
    (0..n).map(move |i| [1.0 / g, 1.0 / (g * g), 1.0 / (g * g * g)].map(|a| (0.5 + a * f64::from(i)) % 1.0))
}

/// (reflected, transmitted) shares of light seen along `wo`, n² taken out, as the samples have it.
fn shares(bsdf: &Bsdf, wo: Vec3<f64>, n: u32) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for u in points(n) {
        if let Some(s) = sample(bsdf, &Lanes([550.0]), wo, u) {
            sums[usize::from(s.wi.z * wo.z < 0.0)] += s.weight[0] * s.eta * s.eta / f64::from(n);
        }
    }
    sums
}

#[test]
fn single_scattering_has_the_albedo_of_an_independent_quadrature() {
    for (alpha, mu) in [(0.1, 0.9), (0.3, 0.3), (1.0, 0.6), (1.0, 0.05)] {
        let truth = ggx_albedo(alpha, mu, None, Masking::Correlated).reflected;
        // 2¹⁸ points of a low-discrepancy sequence; their error here is below 1e-3.
        let [read, _] = shares(&mirrors(alpha, false), direction(mu), 1 << 18);
        assert!((read - truth).abs() < 1e-3, "metal α {alpha} µ {mu}: {read} is not {truth}");
        // The width is α, not its square, and masking is not G₁G₁: a mistake would be seen.
        for wrong in [
            ggx_albedo(alpha * alpha, mu, None, Masking::Correlated).reflected,
            ggx_albedo(alpha, mu, None, Masking::Separable).reflected,
        ] {
            assert!(
                mu > 0.5 || alpha == 1.0 || (read - wrong).abs() > 5e-3,
                "metal α {alpha} µ {mu}: {read} is also {wrong}"
            );
        }
        for (inside, eta) in [(false, 1.5), (true, 1.0 / 1.5)] {
            let truth = ggx_albedo(alpha, mu, Some(eta), Masking::Correlated);
            let bsdf = glass(RefractiveIndex::Constant(1.5), alpha, false);
            let wo = direction(mu);
            let [reflected, refracted] = shares(&bsdf, if inside { -wo } else { wo }, 1 << 18);
            assert!((reflected - truth.reflected).abs() < 1.5e-3, "α {alpha} µ {mu} η {eta}: {reflected}, {truth:?}");
            assert!((refracted - truth.refracted).abs() < 1.5e-3, "α {alpha} µ {mu} η {eta}: {refracted}, {truth:?}");
        }
    }
}

/// In a white furnace what absorbs nothing cannot be seen: all light comes back, to the 1.5e-4 of it that the tables
/// may miss; never more by 1e-4.
#[test]
fn a_lossless_rough_surface_returns_all_light_and_no_more() {
    for alpha in [1e-3, 0.05, 0.3, 1.0] {
        for mu in [1.0, 0.2, 0.03] {
            let close = |read: f64, what: &str| {
                // The 2¹⁶ points leave an error of some 4e-3 where half the light is diffuse.
                assert!((-1e-2..6e-3).contains(&(read - 1.0)), "{what}, α {alpha}, µ {mu}: {read}");
            };
            close(shares(&mirrors(alpha, true), direction(mu), 1 << 16)[0], "metal");
            let bsdf = glass(RefractiveIndex::Constant(1.5), alpha, true);
            close(shares(&bsdf, direction(mu), 1 << 16).iter().sum(), "glass from outside");
            close(shares(&bsdf, -direction(mu), 1 << 16).iter().sum(), "glass from inside");
        }
    }
    // And without compensation it is missing.
    let [dark, _] = shares(&mirrors(1.0, false), direction(1.0), 1 << 16);
    assert!((0.25..0.35).contains(&dark), "{dark}");
}

/// Towards α = 0 the shares and the directions join those of the smooth interface, the first with an error below 5α away
/// from grazing and critical angles, the second with half of all facets tilted by less than α, so that reflected light is
/// off by less than 2α in the median, and refracted light by less, and both by less than 2.5α.
#[test]
fn rough_glass_joins_smooth_glass() {
    for alpha in [1e-2, 1e-3, 1e-4] {
        for (mu, inside, eta) in [(0.7, false, 1.5), (0.95, true, 1.0 / 1.5)] {
            let bsdf = glass(RefractiveIndex::Constant(1.5), alpha, true);
            let wo = if inside { -direction(mu) } else { direction(mu) };
            let plane = fresnel_exact(mu, eta);
            let [reflected, refracted] = shares(&bsdf, wo, 1 << 14);
            // Beside the points' own error.
            let bound = 5.0 * alpha + 5e-4;
            assert!((reflected - plane.reflectance()).abs() < bound, "α {alpha}: {reflected}");
            assert!((refracted - plane.transmittance()).abs() < bound, "α {alpha}: {refracted}");
            let sin = (1.0 - mu * mu).sqrt() / eta;
            let side = wo.z.signum();
            let smooth = [Vec3::new(-wo.x, 0.0, wo.z), Vec3::new(-wo.x / eta, 0.0, -side * (1.0 - sin * sin).sqrt())];
            let mut off: Vec<f64> = points(4096)
                .filter_map(|u| sample(&bsdf, &Lanes([550.0]), wo, u))
                .map(|s| (s.wi - smooth[usize::from(s.wi.z * wo.z < 0.0)]).length())
                .collect();
            off.sort_by(f64::total_cmp);
            assert!(off[off.len() / 2] < 2.5 * alpha, "α {alpha}: {}", off[off.len() / 2]);
        }
    }
}

/// Under a sky of radiance 1 the balance heuristic over lanes reads the same albedo at every wavelength as one lane alone
/// does: the mean over the four heroes.
#[test]
fn dispersive_rough_glass_loses_no_wavelength() {
    let index = RefractiveIndex::named("N-SF11").unwrap();
    let bsdf = glass(index.clone(), 0.15, true);
    let nm = [440.0, 520.0, 600.0, 680.0];
    for wo in [direction(0.8), direction(0.3), -direction(0.85)] {
        let n = 1 << 14;
        let mut read = [0.0; 4];
        for hero in 0..4 {
            let lambda = Lanes::<f64, 4>::from_fn(|lane| nm[(hero + lane) % 4]);
            for s in points(n).filter_map(|u| sample(&bsdf, &lambda, wo, u)) {
                assert!(s.lane_density[0] == 1.0 && matches!(s.density, Density::SolidAngle(_)));
                for lane in 0..4 {
                    // Each wavelength with its own n².
                    let crossed = s.wi.z * wo.z < 0.0;
                    let eta = index.eval(lambda[lane]).powf(if wo.z > 0.0 { 1.0 } else { -1.0 });
                    let value = s.weight[lane] * if crossed { eta * eta } else { 1.0 } / f64::from(n);
                    read[(hero + lane) % 4] += value / s.lane_density.sum();
                }
            }
        }
        for wavelength in 0..4 {
            // The points' error.
            assert!((read[wavelength] - 1.0).abs() < 3e-3, "{wo:?}: {read:?}");
        }
    }
}

#[test]
fn nothing_breaks_at_grazing_angles_and_near_deltas() {
    fn check(bsdf: &Bsdf, wo: Vec3<f64>, n: Vec3<f64>, u: [f64; 3]) {
        let lambda = Lanes([450.0, 550.0]);
        if let Some(s) = bsdf.sample::<2>(&lambda, &Shading::flat(n), wo, u) {
            let Density::SolidAngle(density) = s.density else { panic!("a rough surface has no delta") };
            assert!(density.is_finite() && density > 0.0);
            assert!(s.weight.is_finite() && s.lane_density.is_finite(), "{wo:?} {u:?}: {s:?}");
            // G₂/G₁ ≤ 1, radiance in glass up to n², and the hero's own weight is bounded by both lobes'.
            assert!(s.weight[0] < 8.0, "{wo:?} {u:?}: {s:?}");
            assert!((s.wi.length() - 1.0).abs() < 1e-14);
        }
    }
    for alpha in [etalon_scene::LEAST_ALPHA, 0.01, 1.0] {
        let flint = glass(RefractiveIndex::named("N-SF11").unwrap(), alpha, true);
        for bsdf in [&mirrors(alpha, true), &flint] {
            for mu in [0.5, 1e-2, 1e-4, 1e-7, 1e-12, 0.0] {
                for u in points(64).chain([[0.0; 3], [1.0 - 1e-16; 3], [0.5, 0.0, 1.0 - 1e-16], [0.99, 0.5, 0.0]]) {
                    for side in [1.0, -1.0] {
                        let tilted = Frame::from_normal(Vec3::new(0.6, 0.0, 0.8));
                        let wo = direction(mu) * side;
                        check(bsdf, wo, up(), u);
                        check(bsdf, tilted.to_world(wo), tilted.n, u);
                    }
                }
            }
        }
    }
}
