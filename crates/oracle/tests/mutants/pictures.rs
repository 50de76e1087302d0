//! Whole pictures: the small renderer reads every truth; with a fault, the truth for that fault rejects it.

use etalon_oracle::{
    Verdict,
    statistics::{Budget, z_verdict},
    subjects::Reading,
    truths::{Claim, Renders, Truth, judge, truths},
};

use crate::renderer::Tracer;

/// Truths in the neutral form of whole pictures that apply to a renderer without polarisation, thermal spectra, priorities, motion,
/// facets of two widths and connections.
fn readable() -> Vec<Truth> {
    let claims: Vec<_> = Claim::UNPOLARISED
        .into_iter()
        .filter(|claim| {
            let beyond = [
                Claim::Priorities,
                Claim::Absorption,
                Claim::Scattering,
                Claim::Motion,
                Claim::AnisotropicFacets,
                Claim::SpecularConnections,
                Claim::WholeFormat,
                Claim::StatedPixels,
            ];
            !beyond.contains(claim)
        })
        .collect();
    let applies = |truth: &Truth| truth.applies_to(&claims) && !truth.scene.contains("blackbody");
    truths().into_iter().filter(applies).collect()
}

/// Agreement within noise; few paths, so the truth's demand for power is left out.
fn agreement(truth: &Truth, paths: u64, seed: u64, significance: f64) -> Verdict {
    // At grazing incidence one path in two thousand carries all the light: noise is known only from many of those.
    let paths = if truth.must_see > 0.15 { 40 * paths } else { paths };
    let reading = Tracer { fault: "", paths, seed }.render(truth).expect("a readable scene");
    assert_eq!(reading.nonfinite, 0, "{}", truth.name);
    // This renderer computes in f64, so nothing is allowed for single precision; 1e-7 is for the width of the light meter's
    // plate, over which an irradiance changes by (1e-4 m / 1 m)², and for panels in place of infinite planes.
    let single_precision = 2e-5 * truth.value();
    let tolerance = truth.tolerance() - single_precision + 1e-7 * truth.value();
    z_verdict(&truth.name, &reading.estimate, truth.value(), tolerance, significance)
}

fn all_agree(paths: u64, seed: u64) {
    let list = readable();
    let significance = Budget::for_tests(list.len()).each();
    let half = list.len() / 2;
    let run = |part: &[Truth]| part.iter().for_each(|truth| agreement(truth, paths, seed, significance).assert());
    std::thread::scope(|scope| {
        let first = scope.spawn(|| run(&list[..half]));
        run(&list[half..]);
        first.join().expect("the first half of the truths agrees");
    });
}

#[test]
fn an_independent_renderer_reads_every_truth() {
    all_agree(20_000, 1);
}

#[test]
#[ignore = "a hundred readings of every truth take many minutes; run by hand when truths or laws change"]
fn an_independent_renderer_raises_no_false_alarm_in_a_hundred_seeds() {
    for seed in 1000..1100 {
        all_agree(5_000, seed);
    }
}

#[test]
fn every_wrong_renderer_is_rejected() {
    let list = readable();
    let significance = Budget::for_tests(list.len()).each();
    for (fault, name) in [
        ("no n squared", "eye-in-glass"),
        ("no n squared", "floor-under-water"),
        ("n squared the wrong way", "window-of-a-diver"),
        ("equation (1) of the assignment", "edge-under-water"),
        ("equation (1) of the assignment", "ball-lens"),
        ("not refracted", "ball-lens"),
        ("the ratio never turned round", "ball-lens"),
        ("no total reflection", "mirror-of-a-diver-dark"),
        ("s polarisation only", "plate-at-75-degrees"),
        ("Schlick", "plate-at-75-degrees"),
        ("glass without reflection", "plate-at-0-degrees"),
        ("the index of the d line at every wavelength", "prism-bk7-at-404.6561-nanometres"),
        ("a wavelength lane kept after dispersion", "rainbow-cut-in-two"),
        ("the hero not weighed up", "rainbow-cut-in-two"),
        ("the index of the d line at every wavelength", "rainbow-cut-in-two"),
        ("lens sampled as a square", "lens-spot-behind-focus"),
        ("lens sampled as a square", "lens-edge"),
        ("lens radius without its root", "lens-spot-behind-focus"),
        ("lens of twice the radius", "lens-spot-before-focus"),
        ("focused at infinity", "lens-in-focus"),
        ("field of view doubled", "pinhole-window"),
        ("field of view taken as horizontal", "pinhole-wide-window"),
        ("roulette not weighed", "room-bright"),
        ("roulette capped at 0.95", "mirror-room-of-a-thousand-bounces"),
        ("tubes without their ends", "room-tube"),
        ("tubes without their ends", "cylinder-light-end-on"),
        ("cosine of the light dropped", "cylinder-light"),
        ("one edge more", "room-cut-at-3"),
        ("light found both ways in full", "sphere-light-overhead"),
        ("cosine of the light dropped", "square-light"),
        ("cosine of the receiver dropped", "point-light-oblique"),
        ("falling with the distance", "point-light-overhead"),
        ("half of the cone", "sphere-light-overhead"),
        ("1 - cos in single precision", "sphere-light-farther"),
        ("lights shine on both sides", "square-light-turned-away"),
        ("a light's choice not weighed", "twenty-lamps-in-a-ring"),
        ("no shadows", "annular-eclipse"),
        ("no division by pi", "furnace-lambert-cube"),
        ("hemisphere sampled evenly", "sky-behind-a-disk"),
        ("normals not turned", "integrating-sphere"),
        ("mirrors lose nothing", "furnace-mirror-sphere"),
        ("rays offset by 1e-3", "plate-at-45-degrees-thin"),
        ("rays offset by 1e-3", "room-cube-of-ten-micrometres"),
        ("hits nearer than 1e-4 lost", "room-cube-of-ten-micrometres"),
        ("what coincides with a mask that is passed is passed too", "mask-in-a-floor-listed-first"),
        ("what coincides with a mask that is passed is passed too", "mask-of-a-box-on-a-floor"),
        ("light that meets several facets lost", "furnace-rough-glass-of-a-half"),
        ("light that meets several facets lost", "furnace-rough-diamond-of-one"),
        ("masks are opaque", "mask-in-the-plane-of-a-lamp-light"),
        ("masks are opaque", "mask-of-half-in-a-tilted-floor"),
        ("masks are opaque", "masks-of-two-sheets-in-a-floor"),
        ("0/0 in one of a thousand", "furnace-lambert-sphere"),
    ] {
        let truth = list.iter().find(|truth| truth.name == name).unwrap_or_else(|| panic!("no truth is named {name}"));
        let reading = Tracer { fault, paths: 20_000, seed: 1 }.render(truth).expect("a readable scene");
        let verdict = judge(truth, &reading, significance);
        let noisy = verdict.evidence.contains("too noisy");
        assert!(!verdict.pass && !noisy, "the mutant \"{fault}\" survived {name}: {verdict}");
    }
}

#[test]
fn a_renderer_that_cuts_many_paths_is_refused_though_what_it_lost_does_not_stand_out() {
    // After k edges one path in k²/25 is still under way in the tunnel: after 100 it has up to half a per cent of the light left, which these
    // paths do not show; after 400 so little that they need not.
    let truth = truths().into_iter().find(|truth| truth.name == "light-through-a-mirror-tunnel").expect("a truth");
    let significance = Budget::for_tests(truths().len()).each();
    for (fault, accepted) in
        [("paths cut at 100 edges, and counted", false), ("paths cut at 400 edges, and counted", true)]
    {
        let reading = Tracer { fault, paths: 200_000, seed: 1 }.render(&truth).expect("a readable scene");
        judge(&truth, &Reading { cut_bias: 0.0, ..reading }, significance).assert();
        let verdict = judge(&truth, &reading, significance);
        assert!(reading.cut_bias > 0.0 && verdict.evidence.contains("paths that were cut"), "{verdict}");
        assert_eq!(verdict.pass, accepted, "{fault}: {verdict}");
    }
}
