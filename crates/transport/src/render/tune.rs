//! From a scene to what is rendered: prepared, then tuned by trials before the picture.

use crate::guiding::SpecularObjects;
use crate::guiding::{GuidedBy, USUAL_SHARES};
use crate::integrator::light_tracing::find_specular_objects;
use crate::integrator::light_tracing::trial::light_paths_per_pixel;
use crate::integrator::trial::{PIXELS, SAMPLES, SHARES, TRIED};
use crate::plan::{EffectName, LaneModel, Study};
use crate::sampler::mix;
use crate::scene::coincidence;
use crate::scene::prepare::{Prepared, build};
use crate::scene::prepare_error::PrepareError;
use crate::wavelength::guide::Regions;
use etalon_scene::{LightSampling, LightSelection, LightTracing, Scene};

/// Pixels and samples of the trials of lights. The first takes one sample of few pixels, and says whether the others are worth their time.
const LIGHT_TRIAL: (u64, u32) = (PIXELS, SAMPLES);
const FIRST_LIGHT_TRIAL: (u64, u32) = (256, 1);
/// Most objects of a scene in which lights are tried. A ray may meet all of them at one point: with 100,000 the trials take minutes.
const MOST_OBJECTS: usize = 10_000;
/// Most groups of lights whose shares are learned: of more the trial would know too little.
const MOST_LIGHT_GROUPS: usize = 64;

/// What must be left of the variance. Much, since the trial knows of no strata: where the picture's samples would be spread evenly over
/// directions, a share taken from them costs more than it foretells; and paths through guided targets are longer.
const MAX_COST_RATIO: f64 = 0.4;
/// The same of images of lamps: small, so that little is taken from what comes in otherwise.
const IMAGES_MAX_COST_RATIO: f64 = 0.9;
/// The same of whole lenses beside images, of what is left with images alone: with them a path takes a sixth longer, but what they leave of
/// the error is 0.69 and 0.66 where the trial says 0.54 and 0.88.
const LENSES_MAX_COST_RATIO: f64 = 0.9;

/// The time of a ray that is refracted, over that of others: these are cast many at once. In six scenes it is 1 to 2.8.
const REFRACTED_RAY: f64 = 2.0;

/// Regions of a picture that may have wavelengths of their own, about as many at most, and samples of each that they are learned from. A picture
/// of 1920 × 1080 pixels has squares of 23 × 23.
const REGIONS: u32 = 4096;
const SAMPLES_OF_REGION: u32 = 512;
/// The same of a first trial, which says whether the other is worth its time.
const FIRST_REGIONS: u32 = 256;
const FIRST_SAMPLES: u32 = 256;
/// Regions and samples of each by which it is learned how long paths are.
const FEW_REGIONS: u32 = 64;
const FEW_SAMPLES: u32 = 4;
/// Samples of a region from which something can be learned.
const FEWEST_SAMPLES: u32 = 64;
/// Rays that a trial may take, about: some seconds at most.
const MOST_RAYS: f64 = (1 << 23) as f64;
/// Fewest pixels of a region's side.
const SIDE: u32 = 8;

/// Prepares a scene: its frame, the shapes and the accelerator in it, the table of lights and the plan; and tunes it.
pub fn prepare(scene: &Scene) -> Result<Prepared, PrepareError> {
    prepare_study(scene, &Study::default())
}

/// As [`prepare`], with effects that the scene does not call for, or without some that it does.
pub fn prepare_study(scene: &Scene, study: &Study) -> Result<Prepared, PrepareError> {
    prepare_frame(scene, study, None)
}

/// As [`prepare_study`], for a frame of a sequence: what is the same in an earlier frame is taken over from it. What is rendered has the
/// same bits without it. If only the camera moves, everything but the trial is taken over; else the groups of which nothing inside moves,
/// and the tables of image environments.
pub fn prepare_frame(scene: &Scene, study: &Study, earlier: Option<Prepared>) -> Result<Prepared, PrepareError> {
    let mut prepared = build(scene, study, earlier)?;
    if !study.by_cosine_alone {
        // The same for each seed of a scene, so that pictures of different ones are drawn alike; and none that anyone would choose.
        prepared.tune(mix(0x6361_7573_7469_6373));
    } else if prepared.scene.integrator.light_tracing == LightTracing::Always {
        prepared.specular_objects = prepared.wanted_light_tracing();
    }
    let warnings = coincidence::warnings(&prepared);
    prepared.warnings.extend(warnings);
    Ok(prepared)
}

impl Prepared {
    /// Decides by trials, with random numbers of a seed: how often each light is chosen, whether shadow rays go through glass, what directions are
    /// guided by, and from how many vertices specular connections are made. Then whether light is followed from the lamps, and which wavelengths are drawn where.
    pub fn tune(&mut self, seed: u64) {
        // An earlier frame may have found otherwise, and each trial depends on what those before it have found.
        self.wavelength_guide = None;
        self.specular_objects = None;
        self.shadow_rays_stop_at_glass = false;
        self.forget_directions();
        self.tune_light_choice(seed);
        self.tune_camera_paths(seed);
        self.tune_light_tracing(seed);
        self.tune_wavelengths(seed);
    }

    /// Learns how often each light is worth a shadow ray, where the scene leaves that open and lights are not too many to be told apart.
    fn tune_light_choice(&mut self, seed: u64) {
        self.lights.learn(None);
        let integrator = &self.scene.integrator;
        let open =
            integrator.light_selection == LightSelection::Auto && integrator.light_sampling != LightSampling::Bsdf;
        let affordable = self.surfaces.objects.len() <= MOST_OBJECTS;
        if !open || !affordable || !(2..=MOST_LIGHT_GROUPS).contains(&self.lights.group_count()) {
            return;
        }
        let try_it = |prepared: &Self, seed, sampling, effort| {
            (prepared.kernel().try_light_choice)(prepared, seed, sampling, effort)
        };
        let by_shadow_rays = |effort| try_it(self, seed, Some(LightSampling::Light), effort).shares(&self.lights);
        // Few paths say whether more are worth their time.
        let Some(shares) = by_shadow_rays(FIRST_LIGHT_TRIAL).and_then(|_| by_shadow_rays(LIGHT_TRIAL)) else { return };
        // Other random numbers than those that they were learned from.
        let other_seed = mix(seed);
        let by_power = try_it(self, other_seed, None, LIGHT_TRIAL);
        self.lights.learn(Some(&shares));
        if !try_it(self, other_seed, None, LIGHT_TRIAL).is_better_than(&by_power) {
            self.lights.learn(None);
        }
    }

    fn tune_camera_paths(&mut self, seed: u64) {
        self.forget_directions();
        self.tune_refracted_shadows(seed);
        self.tune_guided_targets(seed);
        self.tune_connections(seed);
    }

    /// Nothing is guided, and specular connections are made as usual.
    fn forget_directions(&mut self) {
        (self.guided_targets.guided_by, self.guided_targets.share) = (GuidedBy::Nothing, 0.0);
        self.set_connection_shares(USUAL_SHARES);
    }

    /// Follows light from the lamps where that leaves less noise for the time than the best that camera paths do alone. What these are
    /// guided by is then decided anew: it is no longer for them to find what light paths bring.
    fn tune_light_tracing(&mut self, seed: u64) {
        let Some(mut specular_objects) = self.wanted_light_tracing() else { return };
        let try_camera_paths = |prepared: &Self| (prepared.kernel().try_camera_paths)(prepared, seed);
        let whole = try_camera_paths(self);
        self.specular_objects = Some(specular_objects.clone());
        let rest = try_camera_paths(self);
        let found = light_paths_per_pixel(self, &specular_objects, seed, [&whole, &rest]);
        let always = self.scene.integrator.light_tracing == LightTracing::Always;
        specular_objects.paths_per_pixel = found.map_or(1.0, |found| found.per_pixel);
        self.specular_objects = (always || found.is_some_and(|found| found.is_worth_it)).then_some(specular_objects);
        if self.specular_objects.is_some() {
            self.tune_camera_paths(seed);
        }
    }

    /// The specular objects of a scene in which light paths are wanted and possible. Warns where they are asked for and not possible.
    fn wanted_light_tracing(&mut self) -> Option<SpecularObjects> {
        let wanted = self.scene.integrator.light_tracing;
        if wanted == LightTracing::Never {
            return None;
        }
        match find_specular_objects(self) {
            Ok(specular_objects) => Some(specular_objects),
            Err(reason) if wanted == LightTracing::Always => {
                self.warnings.push(format!("no light paths are traced, although the scene asks for them: {reason}"));
                None
            }
            Err(_) => None,
        }
    }

    /// Makes specular connections from the share of the vertices that leaves the least variance for the rays.
    fn tune_connections(&mut self, seed: u64) {
        if self.specular_connections.is_some() {
            let shares = (self.kernel().try_connections)(self, seed).shares();
            self.set_connection_shares(shares);
        }
    }

    fn set_connection_shares(&mut self, shares: [f64; 2]) {
        self.specular_connections.iter_mut().for_each(|connections| connections.shares = shares);
    }

    /// Learns which wavelengths bring light in each region of the picture, where dispersion makes that differ.
    ///
    /// Bands do without, since each is the plain mean of its samples. So do pixels that share paths, since these share wavelengths.
    fn tune_wavelengths(&mut self, seed: u64) {
        let plan = self.plan();
        // A forced effect must leave every bit as it is, and channels have no wavelengths.
        let called_for = plan.runs(EffectName::Dispersion)
            && !plan.forces(EffectName::Dispersion)
            && plan.lane_model == LaneModel::Hero;
        let film = &self.scene.film;
        if !called_for || film.bands.is_some() || self.path_reuse().is_some() || !self.receivers.is_empty() {
            return;
        }
        let regions = |most: u32| Regions::new(film.width, film.height, SIDE, most);
        let try_it = |regions, samples| (self.kernel().try_wavelengths)(self, seed, regions, samples);
        // Few paths say how many a trial may take.
        let few = regions(FEW_REGIONS);
        let rays_of_path = try_it(few, FEW_SAMPLES).rays_of_path();
        let affordable =
            |regions: Regions, samples: u32| samples.min((MOST_RAYS / (regions.count() as f64 * rays_of_path)) as u32);
        let (coarse, fine) = (regions(FIRST_REGIONS), regions(REGIONS));
        let samples = affordable(fine, SAMPLES_OF_REGION);
        if samples < FEWEST_SAMPLES {
            return;
        }
        if coarse == fine || try_it(coarse, affordable(coarse, FIRST_SAMPLES)).guide().is_some() {
            self.wavelength_guide = try_it(fine, samples).guide();
        }
    }

    /// Lets shadow rays go through glass where that lowers the variance by more than it lengthens the time.
    fn tune_refracted_shadows(&mut self, seed: u64) {
        if self.refracting_bodies.is_none() {
            return;
        }
        let mut try_it = |stop_at_glass: bool| {
            self.shadow_rays_stop_at_glass = stop_at_glass;
            let trial = (self.kernel().try_guided_targets)(self, seed);
            let [variance, ..] = trial.variances();
            (trial.light(), variance, trial.rays as f64)
        };
        let (light, straight, rays) = try_it(true);
        let (more_light, refracted, more_rays) = try_it(false);
        let time = rays + REFRACTED_RAY * (more_rays - rays);
        // Of a trial that has missed half of the light, the variance says nothing.
        self.shadow_rays_stop_at_glass = more_light < 2.0 * light && refracted * time >= straight * rays;
    }

    /// Gives guided targets the share of the directions that leaves the least variance, relative to the level of each place, if that is
    /// worth it.
    ///
    /// One trial tells the variance for every share: with xₛ what a path comes to under share s and Fₛ the product of its factors, the
    /// mean square under s is E[xₛ²·F/Fₛ], F that under the share tried (importance sampling of the second moment, but for what roulette
    /// does). The rare bright paths that bear the variance without guided targets are common in the trial.
    fn tune_guided_targets(&mut self, seed: u64) {
        if self.guided_targets.bodies.is_empty() {
            return;
        }
        let mut best = (1.0, GuidedBy::Nothing, 0.0);
        let images = !self.guided_targets.images.is_empty();
        for (guided_by, worth_it, there) in [
            (GuidedBy::Bodies, MAX_COST_RATIO, !self.guided_targets.bodies.is_empty()),
            (GuidedBy::Images, IMAGES_MAX_COST_RATIO, images),
            (GuidedBy::ImagesAndLenses, LENSES_MAX_COST_RATIO, images && !self.guided_targets.lenses.is_empty()),
        ] {
            // Lenses come last: against the best without them.
            let worth_it = if guided_by == GuidedBy::ImagesAndLenses { worth_it * best.0 } else { worth_it };
            if !there {
                continue;
            }
            (self.guided_targets.guided_by, self.guided_targets.share) = (guided_by, TRIED);
            let [alone, shares @ ..] = (self.kernel().try_guided_targets)(self, seed).variances();
            for (share, variance) in SHARES.into_iter().zip(shares) {
                let left = variance / alone;
                if left < worth_it && left < best.0 {
                    best = (left, guided_by, share);
                }
            }
        }
        (_, self.guided_targets.guided_by, self.guided_targets.share) = best;
    }
}
