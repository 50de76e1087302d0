//! Phase functions against their integrals and moments, and the directions that they draw.

use super::*;
use etalon_scene::PhaseTable;

fn all() -> Vec<(Phase, f64)> {
    let table = PhaseTable { cosines: vec![-1.0, -0.2, 0.5, 1.0], values: vec![2.0, 0.0, 1.0, 5.0], matrix: None };
    // ∫c(a + bc) over each piece of the table, over ∫(a + bc).
    let piece = |[c, d]: [f64; 2], [p, q]: [f64; 2]| {
        let b = (q - p) / (d - c);
        let a = p - b * c;
        [a * (d - c) + b * (d * d - c * c) / 2.0, a * (d * d - c * c) / 2.0 + b * (d.powi(3) - c.powi(3)) / 3.0]
    };
    let pieces = [piece([-1.0, -0.2], [2.0, 0.0]), piece([-0.2, 0.5], [0.0, 1.0]), piece([0.5, 1.0], [1.0, 5.0])];
    let mean = pieces.iter().map(|p| p[1]).sum::<f64>() / pieces.iter().map(|p| p[0]).sum::<f64>();
    let mut list = vec![
        (PhaseFunction::Isotropic, 0.0),
        (PhaseFunction::Rayleigh, 0.0),
        (PhaseFunction::DoubleHenyeyGreenstein { g: [0.9, -0.4], weight: 0.7 }, 0.7 * 0.9 - 0.3 * 0.4),
        (PhaseFunction::Tabulated(table), mean),
    ];
    for g in [-0.95, -0.3, 0.0, 1e-9, 0.5, 0.9, 0.99] {
        list.push((PhaseFunction::HenyeyGreenstein { g }, g));
    }
    list.into_iter().map(|(phase, mean)| (Phase::new(&phase), mean)).collect()
}

/// ∫ f over cosines, by Simpson's rule in the variable of the sampling itself: peaks are wide there.
fn mean_of(phase: &Phase, f: impl Fn(f64) -> f64) -> f64 {
    let n = 200_000;
    (0..n).map(|i| f(phase.cosine((f64::from(i) + 0.5) / f64::from(n)))).sum::<f64>() / f64::from(n)
}

#[test]
fn cosines_are_drawn_with_the_density_that_is_stated() {
    for (phase, mean) in all() {
        // The mean cosine: the midpoint rule errs by about 1e-5 in the steepest of them.
        let drawn = mean_of(&phase, |cos| cos);
        assert!((drawn - mean).abs() < 2e-5, "{phase:?}: {drawn} is not {mean}");
        // The share of the light below a cosine is the integral of the density up to it; two midpoint rules leave 1e-5.
        let n = 200_000;
        let mut drawn: Vec<f64> = (0..n).map(|i| phase.cosine((f64::from(i) + 0.5) / f64::from(n))).collect();
        drawn.sort_by(f64::total_cmp);
        let (mut at, mut share) = (-1.0, 0.0);
        for i in 1..=64 {
            let count = i * n / 64;
            let to = drawn[count as usize - 1];
            let steps = 4_000;
            let step = (to - at) / f64::from(steps);
            let area: f64 = (0..steps).map(|k| phase.density(at + (f64::from(k) + 0.5) * step)).sum::<f64>() * step;
            share += 2.0 * PI * area;
            let below = (f64::from(count) - 0.5) / f64::from(n);
            assert!((share - below).abs() < 2e-5, "{phase:?}: {share} of the light lies below {to}, not {below}");
            at = to;
        }
    }
}

#[test]
fn directions_have_the_cosines_and_all_turns_around_them() {
    let wo = Vec3::new(0.6, 0.48, -0.64);
    for (phase, mean) in all() {
        let n = 400;
        let mut sum = Vec3::ZERO;
        for i in 0..n {
            for j in 0..n {
                let u = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                let (wi, density) = phase.sample(wo, u);
                assert!((wi.length() - 1.0).abs() < 1e-12);
                assert_eq!(density, phase.density(-wo.dot(wi)));
                sum += wi / f64::from(n * n);
            }
        }
        // The mean direction is that of the light as it came, times the mean cosine; 400 rows leave 1e-3 of the sharpest peak.
        assert!((sum + wo * mean).length() < 2e-3, "{phase:?}: {sum:?}");
    }
}

#[test]
fn sideways_rayleigh_scattering_polarises_across_its_plane() {
    let phase = Phase::new(&PhaseFunction::Rayleigh);
    let (wo, wi) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0));
    let mueller = phase.mueller::<1>(wo, wi).expect("it polarises");
    assert_eq!(mueller.x.normalized(), Vec3::new(0.0, 1.0, 0.0));
    let matrix = mueller.matrix(0);
    assert_eq!([matrix[0][0], matrix[1][0], matrix[2][2]], [1.0, 1.0, 0.0]);
    // Light that goes straight on stays as it is; straight back, left and right change places.
    let on = phase.mueller::<1>(wo, -wo).expect("it polarises").matrix(0);
    assert_eq!([on[1][0], on[1][1], on[2][2], on[3][3]], [0.0, 1.0, 1.0, 1.0]);
    let back = phase.mueller::<1>(wo, wo).expect("it polarises").matrix(0);
    assert_eq!([back[1][0], back[1][1], back[2][2], back[3][3]], [0.0, 1.0, -1.0, -1.0]);
    assert!(Phase::new(&PhaseFunction::Isotropic).mueller::<1>(wo, wi).is_none());
}

/// A path that carries polarisation draws the same light as one whose directions are drawn all around, and each draw of a path of one lane
/// is worth the same.
#[test]
fn polarised_directions_are_drawn_by_their_worth() {
    use crate::polarisation::{Followed, Polarisation};
    use etalon_optics::Lanes;
    let (wo, right) = (Vec3::new(0.6, 0.48, -0.64), Vec3::new(0.8, -0.36, 0.48));
    let toward = Vec3::new(-0.28, 0.96, 0.0);
    let phase = Phase::new(&PhaseFunction::Rayleigh);
    // Light that comes from the first scattering is partly or wholly polarised.
    for wi in [-wo, right, (right - wo).normalized(), (right + wo * 0.01).normalized()] {
        let mut before = Followed::<1>::at_camera(-wo, right);
        before.follow(wo, wi, || phase.mueller(wo, wi));
        before.normalise();
        let (from, worth) = (-wi, before.linear_worth(&Lanes::ONE).expect("it is carried"));
        assert!(worth.s[0].hypot(worth.s[1]) < 1.0 + 1e-12 && worth.x.dot(from).abs() < 1e-12, "{worth:?}");
        let n = 300;
        let mut sums_of = [[0.0; 2]; 2];
        for i in 0..n {
            for j in 0..n {
                let u = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                let (drawn, density, around) = phase.sample_polarised(from, &worth, u);
                assert_eq!(density, phase.density(-from.dot(drawn)));
                let worth_of = |wi| {
                    let mut after = before;
                    after.follow(from, wi, || phase.mueller(from, wi));
                    after.normalise()[0]
                };
                let s0 = worth_of(drawn);
                // Where little is worth anything, it is a difference of nearly equal numbers.
                assert!((s0 - around).abs() < 1e-12, "{s0} {around}");
                let (even, _) = phase.sample(from, u);
                for (sums, wi, weight) in [(0, even, worth_of(even)), (1, drawn, s0 / around)] {
                    sums_of[sums][0] += wi.dot(toward).powi(2) * weight;
                    sums_of[sums][1] += (wi.dot(toward) * wi.dot(right)).powi(2) * weight;
                }
            }
        }
        let [even, drawn] = sums_of.map(|sums| sums.map(|sum| sum / f64::from(n * n)));
        // The midpoints of 300² cells: smooth numbers are summed to 1e-5, the ends of the distribution to 1e-4.
        (0..2).for_each(|k| assert!((even[k] - drawn[k]).abs() < 3e-4 * even[k], "{wi:?}: {even:?} {drawn:?}"));
    }
    // What depolarises is drawn as ever.
    let fog = Phase::new(&PhaseFunction::HenyeyGreenstein { g: 0.5 });
    let worth = Followed::<1>::at_camera(-wo, right).linear_worth(&Lanes::ONE).expect("it is carried");
    let (wi, density) = fog.sample(wo, [0.3, 0.7]);
    assert_eq!(fog.sample_polarised(wo, &worth, [0.3, 0.7]), (wi, density, 1.0));
}

#[test]
fn keplers_equation_is_solved_to_rounding() {
    for k in [0.0, 1e-9, 0.3, 0.9, 1.0 - 1e-12, 1.0] {
        for m in [0.0, 2f64.powi(-52), 1e-9, 0.01, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0 - 2f64.powi(-52)] {
            let e = eccentric_anomaly(m, k);
            let left = e - k / (2.0 * PI) * (2.0 * PI * e).sin();
            assert!((left - m).abs() < 1e-15, "{m} {k}: {e}, off by {:e}", left - m);
        }
    }
}
