//! `etalon explain`: what a scene calls for, what will be done about it, and what was not needed.

use std::path::PathBuf;
use std::time::Instant;

use etalon_scene::{LightTracing, Scene};
use etalon_transport::plan::{Decision, Effect, LaneModel, Plan};
use etalon_transport::{Control, EffectName, Extent, PathLoop, Prepared, Study, prepare_study};
use miette::Report;
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::load::load;
use crate::overrides::Overrides;
use crate::print;

/// List the effects of light that a scene needs, which object needs them, and how it will be rendered.
#[derive(clap::Args)]
#[command(after_help = "Example:
  etalon explain scenes/cornell-glass.json")]
pub(crate) struct ExplainArgs {
    /// Scene as JSON, or a model (see `etalon render`).
    scene: PathBuf,
    #[command(flatten)]
    overrides: Overrides,
    /// Measure what each effect costs, or would cost if it is off, and what light paths and guided directions cost, by short renders with and
    /// without it.
    #[arg(long)]
    measure: bool,
    /// Print one JSON object on standard output.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct ExplainJson<'a> {
    scene: String,
    plan: &'a Plan,
    /// Lights that shadow rays aim at: emitting surfaces one by one, and lights without a surface.
    lights: usize,
    /// Whether they are chosen for each point anew, by where they are; else by power alone.
    lights_by_place: bool,
    /// Share of the shadow rays that a trial gave each of them, in the order of the scene; with `lights_by_place` each without a place, then all
    /// others together. Left out if no trial changed it.
    #[serde(skip_serializing_if = "Option::is_none")]
    light_shares: Option<Vec<f64>>,
    /// Share of the directions of diffuse surfaces that is drawn toward mirrors and bodies of glass, and how many these are; 0 where
    /// that does not pay.
    guided_share: f64,
    guided_targets: usize,
    /// The largest share that is drawn toward images of lamps in smooth balls, and how many these are; 0 where that does not pay.
    specular_image_share: f64,
    specular_light_images: usize,
    /// Shares of the vertices from which specular connections are made: of those behind the camera, a mirror or glass, and of others.
    #[serde(skip_serializing_if = "Option::is_none")]
    connection_shares: Option<[f64; 2]>,
    /// Light paths for each pixel and sample; 0 where that does not pay.
    light_paths_per_pixel: f64,
    /// How many regions of the picture draw some wavelengths more often, and how many there are. Both are 0 where that does not pay.
    guided_wavelengths: (usize, usize),
    /// What effects cost, or would have cost if they are off, and what light paths and guided directions cost, if it was measured.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    costs: Vec<Cost>,
}

/// The time of a render with something, over that without.
#[derive(Serialize)]
struct Cost {
    /// An effect, or how paths are sampled.
    #[serde(rename = "effect")]
    of: &'static str,
    /// Whether the scene is rendered with it.
    on: bool,
    /// Median over the pairs.
    ratio: f64,
    /// First and third quartile.
    quartiles: [f64; 2],
    /// Pairs of renders, alternating.
    pairs: usize,
}

pub(crate) fn run(args: ExplainArgs) -> Outcome {
    let mut loaded = load(&args.scene, args.overrides.film_size(), args.overrides.parameters())?;
    args.overrides.apply(&mut loaded.scene)?;
    print::warnings(&loaded.warnings);
    let study = args.overrides.study();
    let prepared = prepared(&loaded.scene, &study)?;
    let plan = prepared.plan();
    let costs = if args.measure { measure(&loaded.scene, &study, &prepared)? } else { Vec::new() };
    if args.json {
        let scene = args.scene.display().to_string();
        let ((lights, lights_by_place), (guided_share, guided_targets)) =
            (prepared.lights(), prepared.guided_targets());
        let (specular_image_share, specular_light_images) = prepared.specular_light_images();
        print::json(&ExplainJson {
            scene,
            plan,
            lights,
            lights_by_place,
            light_shares: prepared.learned_light_shares(),
            guided_share,
            guided_targets,
            specular_image_share,
            specular_light_images,
            connection_shares: prepared.connection_shares(),
            light_paths_per_pixel: prepared.light_paths_per_pixel(),
            guided_wavelengths: prepared.guided_wavelengths(),
            costs,
        });
    } else {
        print::line(&describe(&prepared, &costs));
    }
    Ok(())
}

fn prepared(scene: &Scene, study: &Study) -> Result<Prepared, Failure> {
    prepare_study(scene, study).map_err(|error| Failure::input(Report::from_err(error)))
}

/// The plan, for people: a line an effect, then how the paths are traced.
fn describe(prepared: &Prepared, costs: &[Cost]) -> String {
    let plan = prepared.plan();
    let mut lines: Vec<String> = plan.effects.iter().map(|effect| line(effect, costs)).collect();
    lines.push(String::new());
    lines.extend(how(prepared).into_iter().map(|(what, value)| format!("{what:<20} {value}")));
    if plan.runs(EffectName::RefractedShadows) {
        let what = match prepared.refracts_shadow_rays() {
            true => "go through glass",
            false => "stop at glass: a trial found no less noise for the time",
        };
        lines.push(format!("{:<20} {what}", "shadow rays"));
    }
    if let (share, bodies @ 1..) = prepared.guided_targets() {
        let share = format!("{:.0} % of the directions at diffuse surfaces aim at", 100.0 * share);
        let objects = if bodies == 1 { "object that mirrors or refracts" } else { "objects that mirror or refract" };
        let cost = cost_of(costs, GUIDED_DIRECTIONS);
        lines.push(format!("{:<20} {share} {bodies} {objects}: a trial found less noise{cost}", "caustics"));
    }
    let per_pixel = prepared.light_paths_per_pixel();
    if per_pixel > 0.0 {
        let why = match prepared.scene().integrator.light_tracing {
            LightTracing::Always => "as the scene asks",
            LightTracing::Auto | LightTracing::Never => "a trial found less noise",
        };
        let what = format!("{per_pixel} a pixel and sample bring what mirrors and glass throw on the scene");
        lines.push(format!("{:<20} {what}: {why}{}", "light paths", cost_of(costs, LIGHT_PATHS)));
    }
    if let (share, images @ 1..) = prepared.specular_light_images() {
        let share = format!("up to {:.0} % of the directions at diffuse surfaces aim at", 100.0 * share);
        let images_word = if images == 1 { "image of a lamp in a ball" } else { "images of lamps in balls" };
        lines.push(format!("{:<20} {share} {images} {images_word}: a trial found less noise", "caustics"));
    }
    if let Some([direct, indirect]) = prepared.connection_shares() {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        let what = format!(
            "from {} of the vertices behind the camera, a mirror or glass, {} of others",
            percent(direct),
            percent(indirect)
        );
        lines.push(format!("{:<20} {what}", "connections"));
    }
    if let (guided @ 1.., regions) = prepared.guided_wavelengths() {
        let what = format!("drawn more often where they bring light, in {guided} of {regions} regions");
        lines.push(format!("{:<20} {what}: a trial found less noise", "wavelengths"));
    }
    for lost in &plan.approximations {
        lines.push(format!("{:<20} without {lost}", "approximation"));
    }
    lines.join("\n")
}

fn line(effect: &Effect, costs: &[Cost]) -> String {
    let state = if effect.on { "on" } else { "off" };
    let study = match effect.study {
        Some(Decision::Forced) => "forced, although ",
        Some(Decision::LeftOut) => "left out, although needed by ",
        None => "",
    };
    let cost = cost_of(costs, effect.name.as_str());
    format!("{:<20} {state:<4} {study}{}{cost}", effect.name, effect.because)
}

/// What something costs, in words after what is said of it; nothing if that was not measured.
fn cost_of(costs: &[Cost], what: &str) -> String {
    costs.iter().find(|cost| cost.of == what).map_or(String::new(), |cost| {
        let percent = |ratio: f64| format!("{:+.0} %", 100.0 * (ratio - 1.0));
        let [low, high] = cost.quartiles.map(percent);
        let costs = if cost.on { "costs" } else { "would cost" };
        format!(" ({costs} {}, quartiles {low} to {high})", percent(cost.ratio))
    })
}

fn how(prepared: &Prepared) -> Vec<(&'static str, String)> {
    let plan = prepared.plan();
    let choice = match prepared.lights() {
        _ if !plan.runs(EffectName::ShadowRays) => "no shadow rays".to_owned(),
        (0, _) => "no lamp for shadow rays".to_owned(),
        (1, _) => "the only one".to_owned(),
        (count, false) => format!("one of {count}, chosen by power"),
        (count, true) => format!("one of {count}, chosen by a light tree: by power, distance and direction"),
    };
    let choice = match (prepared.learned_light_shares(), prepared.lights().1) {
        (None, _) => choice,
        (Some(shares), true) => {
            let beyond = 100.0 * (1.0 - shares.last().expect("the tree is one of them"));
            format!("{choice}; a trial gave {beyond:.0} % of the shadow rays to those without a place")
        }
        (Some(shares), false) => {
            let mut percent: Vec<String> = shares.iter().map(|share| format!("{:.0}", 100.0 * share)).collect();
            if percent.len() > MOST_SHARES {
                percent.truncate(MOST_SHARES);
                percent.push("…".to_owned());
            }
            format!("one of {}; a trial gave them {} % of the shadow rays", shares.len(), percent.join(", "))
        }
    };
    let lanes = match plan.lane_model {
        LaneModel::One => "1, because all light has the same spectrum".to_owned(),
        LaneModel::Hero if plan.runs(EffectName::Dispersion) => {
            format!("{} wavelengths; dispersion may separate them", plan.lanes)
        }
        LaneModel::Hero => format!("{} wavelengths, each with its own density of the path", plan.lanes),
        LaneModel::Shared => format!("{} wavelengths that share the whole path", plan.lanes),
        LaneModel::ThreeChannels => format!("{}: red, green and blue", plan.lanes),
    };
    let paths = match plan.path_loop.name {
        PathLoop::Scalar => "one at a time",
        PathLoop::Batch => "many at once",
    };
    let paths = format!("{paths} ({}): {}", plan.path_loop.name.as_str(), plan.path_loop.because);
    let [first, last] = plan.wavelength_range_nm;
    let uncounted = if plan.count_panes { "" } else { " without those through panes" };
    let depth = plan.max_depth.map_or("no limit".to_owned(), |depth| format!("at most {depth} path edges{uncounted}"));
    let roulette = if plan.roulette { "Russian roulette" } else { "no Russian roulette" };
    vec![
        ("kernel", plan.kernel.to_owned()),
        ("lanes", lanes),
        ("paths", paths),
        ("wavelengths", format!("{first}–{last} nm")),
        ("bounces", format!("{depth}, {roulette}")),
        ("light sampling", plan.light_sampling.to_owned()),
        ("choice of lights", choice),
        (
            "path reuse",
            plan.path_reuse.map_or("none".to_owned(), |[w, h]| format!("within blocks of {w} × {h} pixels")),
        ),
        ("numbers", plan.sampler.to_owned()),
    ]
}

/// Lights whose shares are listed.
const MOST_SHARES: usize = 8;

/// What is measured beside effects.
const LIGHT_PATHS: &str = "light-paths";
const GUIDED_DIRECTIONS: &str = "guided-directions";

/// Pairs of renders that each cost is measured by.
const PAIRS: usize = 9;

/// What each effect costs, or would have cost, and light paths and guided directions where there are any.
fn measure(scene: &Scene, study: &Study, lean: &Prepared) -> Result<Vec<Cost>, Failure> {
    let mut costs = Vec::new();
    for effect in lean.plan().effects.iter().filter(|effect| effect.study.is_none()) {
        let mut other = study.clone();
        if effect.on { &mut other.without } else { &mut other.force }.push(effect.name);
        // What cannot be forced or left out has no cost of its own.
        let Ok(other) = prepare_study(scene, &other) else { continue };
        costs.push(cost(effect.name.as_str(), effect.on, lean, &other)?);
    }
    if lean.light_paths_per_pixel() > 0.0 {
        let mut camera_paths_alone = scene.clone();
        camera_paths_alone.integrator.light_tracing = LightTracing::Never;
        costs.push(cost(LIGHT_PATHS, true, lean, &prepared(&camera_paths_alone, study)?)?);
    }
    if lean.guided_targets().1 > 0 {
        let by_cosine_alone = Study { by_cosine_alone: true, ..study.clone() };
        costs.push(cost(GUIDED_DIRECTIONS, true, lean, &prepared(scene, &by_cosine_alone)?)?);
    }
    Ok(costs)
}

/// The time of renders with something over that without: `other` is without it if the scene has it `on`, else with it. The renders alternate, so
/// that what else the machine does falls on both.
fn cost(of: &'static str, on: bool, lean: &Prepared, other: &Prepared) -> Result<Cost, Failure> {
    let (without, with) = if on { (other, lean) } else { (lean, other) };
    let mut ratios = Vec::with_capacity(PAIRS);
    for pair in 0..PAIRS {
        // Whoever comes second finds warmer caches.
        let (first, second) = if pair % 2 == 0 { (without, with) } else { (with, without) };
        let times = [seconds(first)?, seconds(second)?];
        ratios.push(if pair % 2 == 0 { times[1] / times[0] } else { times[0] / times[1] });
    }
    ratios.sort_by(f64::total_cmp);
    let quartiles = [ratios[PAIRS / 4], ratios[PAIRS - 1 - PAIRS / 4]];
    Ok(Cost { of, on, ratio: ratios[PAIRS / 2], quartiles, pairs: PAIRS })
}

/// How long one sample of each pixel takes.
fn seconds(prepared: &Prepared) -> Result<f64, Failure> {
    let extent = Extent { samples: 0..1, ..prepared.whole(None) };
    let start = Instant::now();
    prepared.render(&extent, &|_| Control::Continue).map_err(|error| Failure::run(Report::from_err(error)))?;
    Ok(start.elapsed().as_secs_f64())
}
