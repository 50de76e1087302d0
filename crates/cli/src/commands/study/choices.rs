//! What a study compares: a table of choices, each a change of a scene's integrator or of its effects.

use etalon_scene::{LightSampling, SamplerKind, Scene};
use etalon_transport::plan::LaneModel;
use etalon_transport::{Carried, EffectName, PathLoop, Plan, Study};

/// A choice, applied to a scene.
pub(super) struct Choice {
    /// Its name.
    pub name: String,
    /// What is chosen.
    pub group: &'static str,
    /// The scene with it.
    pub scene: Scene,
    /// Effects forced or left out.
    pub study: Study,
    /// Whether samples are spread as an exploration says, instead of evenly.
    pub adaptive: bool,
}

/// The choice that the others are held against: the scene as it is.
pub(super) const BASELINE: &str = "as it is";

/// Most edges of paths without roulette, so that rooms that absorb little end.
const DEEPEST: u32 = 64;
/// All choices that a scene allows and that differ from what it says, the baseline first.
pub(super) fn of(scene: &Scene, plan: &Plan) -> Vec<Choice> {
    let mut choices = Vec::new();
    let mut add = |group, name: &str, study: Study, change: &dyn Fn(&mut Scene)| {
        let mut changed = scene.clone();
        change(&mut changed);
        if name == BASELINE || changed != *scene || study != Study::default() {
            choices.push(Choice { name: name.to_owned(), group, scene: changed, study, adaptive: false });
        }
    };
    let plain = Study::default;
    add("baseline", BASELINE, plain(), &|_| ());
    if plan.path_loop.name == PathLoop::Batch {
        let study = Study { path_loop: Some(PathLoop::Scalar), ..Study::default() };
        add("paths", "one path at a time", study, &|_| ());
    }
    for (name, kind) in [("Owen-Sobol", SamplerKind::Sobol), ("independent numbers", SamplerKind::Independent)] {
        add("sampler", name, plain(), &|scene| scene.integrator.sampler = kind);
    }
    add("error bars", "one replicate: no error bars", plain(), &|scene| scene.integrator.replicates = 1);
    // A scene of one spectrum carries a number; its wavelengths are among the effects.
    if plan.lane_model != LaneModel::One {
        for (name, carried) in [
            ("one wavelength", Carried::OneWavelength),
            ("four wavelengths", Carried::FourWavelengths),
            ("three channels (RGB)", Carried::ThreeChannels),
        ] {
            let study = Study { carried: Some(carried), ..Study::default() };
            // Where the scene allows it.
            if Plan::new(scene, &study).is_ok() {
                add("wavelengths", name, study, &|_| ());
            }
        }
    }
    let runs_mis = plan.runs(EffectName::Mis);
    for (name, kind) in [
        ("lights and BSDF by MIS", LightSampling::Mis),
        ("lights only", LightSampling::Light),
        ("BSDF only", LightSampling::Bsdf),
    ] {
        // Where nothing is found both ways, the three are one.
        if runs_mis || scene.integrator.light_sampling != LightSampling::Mis {
            add("direct light", name, plain(), &|scene| scene.integrator.light_sampling = kind);
        }
    }
    add("roulette", "no roulette", plain(), &|scene| {
        scene.integrator.roulette = false;
        scene.integrator.max_depth = Some(scene.integrator.max_depth.map_or(DEEPEST, |depth| depth.min(DEEPEST)));
    });
    for depth in [2, 3, 5, 9] {
        if scene.integrator.max_depth.is_none_or(|most| depth < most) {
            add("path depth", &format!("at most {depth} edges"), plain(), &|scene| {
                scene.integrator.max_depth = Some(depth);
            });
        }
    }
    for effect in &plan.effects {
        // These are the choices of direct light above.
        if matches!(effect.name, EffectName::Mis | EffectName::ShadowRays) {
            continue;
        }
        if effect.on {
            let study = Study { without: vec![effect.name], ..Study::default() };
            add("effects", &format!("without {}", effect.name), study, &|_| ());
        } else if effect.name.can_be_forced() {
            let (study, how) = match effect.name {
                // It changes the picture, where anything polarises.
                EffectName::Polarisation => (Study { polarised: true, ..Study::default() }, "followed"),
                forced => (Study { force: vec![forced], ..Study::default() }, "forced"),
            };
            if Plan::new(scene, &study).is_ok() {
                add("effects", &format!("{} {how}", effect.name), study, &|_| ());
            }
        }
    }
    let adaptive = Choice {
        name: "adaptive".to_owned(),
        group: "where samples go",
        scene: scene.clone(),
        study: Study::default(),
        adaptive: true,
    };
    choices.insert(1, adaptive);
    choices
}
