//! From a scene to what the kernels trace. After this nothing fails.

mod earlier;
use crate::bsdf::{Bsdf, Lambert, properties};
use crate::camera::{Camera, Moving, PreparedLens};
use crate::film::filter::FilterSampler;
use crate::frame::{Affine, SceneFrame, mapped};
use crate::guiding::SpecularObjects;
use crate::guiding::{GuidedTargets, RefractingBodies, SpecularConnections};
use crate::light::{Environment, Light, LightTable, weighted_sum};
use crate::media::{Media, Medium, Participating, Solid, StatedMedia};
use crate::plan::{EffectName, LaneModel, OneLaneFilm, Plan, Study, simulated};
use crate::scene::motion::motion;
use crate::scene::prepare_error::PrepareError;
use crate::scene::receiver::{self, PreparedReceiver};
use crate::scene::shading_tables::ShadingTables;
use crate::scene::shapes::{self, GroupShapes, SceneShapes};
use crate::scene::world::ShadowRays;
use crate::spectral::PathSpectrum;
use crate::surface::{Emission, ObjectSurface, Relief, Surfaces};
use crate::wavelength::WavelengthDistribution;
use crate::wavelength::guide::WavelengthGuide;
use etalon_geometry::{Geometry, SurfaceId};
use etalon_optics::spectrum::whole_nm;
use etalon_optics::{RefractiveIndex, Spectrum, Vec3};
use etalon_scene::{EnvironmentImage, LightSampling, MaterialKind, Object, Parameter, Projection, Scene};
use etalon_simd::Level;
use std::f64::consts::PI;
use std::sync::Arc;

/// A scene that is ready to be rendered. A copy of it takes memory, and no trials.
#[derive(Clone)]
pub struct Prepared {
    pub(crate) scene: Scene,
    pub(crate) frame: SceneFrame,
    /// In the frame.
    pub(crate) camera: etalon_scene::Camera,
    camera_motion: Option<Moving>,
    /// The camera's compound lens, if it has one.
    lens: Option<Arc<PreparedLens>>,
    pub(crate) geometry: Arc<Geometry>,
    /// Where paths begin instead of at the camera, column by column; empty where the scene is a picture.
    pub(crate) receivers: Vec<PreparedReceiver>,
    pub(crate) surfaces: Surfaces,
    pub(crate) lights: LightTable,
    pub(crate) environments: Vec<Environment>,
    pub(crate) media: Option<Media>,
    /// What fills the space outside of all bodies.
    surrounding: Option<Medium>,
    /// Whether some surface is only the boundary of a medium.
    pub(crate) has_boundaries: bool,
    pub(crate) wavelengths: WavelengthDistribution,
    /// Where regions of the picture draw them otherwise.
    pub(crate) wavelength_guide: Option<WavelengthGuide>,
    pub(crate) one_lane: OneLaneFilm,
    pub(crate) filter: FilterSampler,
    pub(crate) tables: ShadingTables,
    pub(crate) guided_targets: GuidedTargets,
    pub(crate) specular_connections: Option<SpecularConnections>,
    pub(crate) refracting_bodies: Option<RefractingBodies>,
    /// The panes through which shadow rays go straight to lamps without area.
    pub(crate) panes: Option<RefractingBodies>,
    /// Set by the trial before a picture.
    pub(crate) specular_objects: Option<SpecularObjects>,
    /// Whether a trial found no use in what goes through them.
    pub(crate) shadow_rays_stop_at_glass: bool,
    plan: Plan,
    /// Those of the shapes, then those of the view.
    pub(crate) warnings: Vec<String>,
    shape_warnings: usize,
    /// What a later frame of a sequence may take over.
    groups: Vec<Arc<GroupShapes>>,
    study: Study,
}

/// The most power that a surface gives back at other wavelengths, of one unit of light at each: light that excites counts for as much as
/// what the eye sees of it.
fn returned_by_fluorescence(scene: &Scene, plan: &Plan) -> PathSpectrum {
    let range_nm = scene.integrator.wavelength_range_nm;
    if !plan.runs(EffectName::Fluorescence) {
        return PathSpectrum::Constant(0.0);
    }
    let nm: Vec<f64> = whole_nm([range_nm[0].floor(), range_nm[1].ceil()]).collect();
    let mut most = vec![0.0_f64; nm.len()];
    for parameter in scene.materials.iter().flat_map(|material| material.kind.parameters()) {
        if let Parameter::Fluorescence(fluorescence) = parameter {
            let returned = fluorescence.returned(&nm, range_nm);
            most.iter_mut().zip(returned).for_each(|(most, returned)| *most = most.max(returned));
        }
    }
    PathSpectrum::tabulate(range_nm, |at| most[((at - nm[0]) as usize).min(nm.len() - 1)])
}

/// Prepares a scene: its frame, the shapes and the accelerator in it, the table of lights and the plan. Renders nothing. What is the
/// same in an earlier frame of a sequence is taken over from it.
pub(crate) fn build(scene: &Scene, study: &Study, earlier: Option<Prepared>) -> Result<Prepared, PrepareError> {
    Level::chosen()?;
    scene.check_references()?;
    let plan = Plan::new(scene, study)?;
    let simulated = simulated(scene, study);
    let scene = &simulated;
    let mut earlier = earlier.filter(|earlier| earlier.study == *study);
    if let Some(earlier) = earlier.take_if(|earlier| earlier.is_the_same_world(scene, &plan)) {
        return earlier.seen_anew(simulated, plan);
    }
    let range_nm = scene.integrator.wavelength_range_nm;
    let spectrum = |s: &Spectrum| PathSpectrum::new(s, range_nm);
    let groups = earlier.as_ref().map(|earlier| (&earlier.scene, earlier.groups.as_slice()));
    let SceneShapes { frame, geometry, object_of, mut emitters, coordinates, warnings, groups } =
        shapes::build(scene, range_nm, groups)?;
    let radius = geometry.bounds().map_or(0.0, |b| 0.5 * b.extent().length());
    // A meter alone has no extent, and parallel light would have no power.
    let radius = if radius == 0.0 && !scene.receivers.is_empty() { 1.0 } else { radius };

    let sampling = scene.integrator.light_sampling;
    if sampling == LightSampling::Bsdf {
        emitters.clear();
    }
    let mut environments = Vec::new();
    for light in &scene.lights {
        let known = |image: &EnvironmentImage| earlier.as_ref()?.image_environment(image, &scene.integrator);
        let (target, sky) = Light::of_scene(&light.kind, &frame, (range_nm, sampling), known);
        environments.extend(sky);
        if light.kind.is_delta() || sampling != LightSampling::Bsdf {
            emitters.extend(target);
        }
    }
    if plan.forces(EffectName::Environment) {
        environments.push(PathSpectrum::Constant(0.0).into());
    }
    let returned = returned_by_fluorescence(scene, &plan);
    let worth = |spectrum: &PathSpectrum| weighted_sum(spectrum, range_nm, |nm| returned.eval(nm));
    let lights = LightTable::weighed(emitters, radius, scene.integrator.light_selection, worth);
    Environment::number(&mut environments, lights.lights());
    let mut light_of: Vec<(SurfaceId, u32)> = lights
        .lights()
        .iter()
        .enumerate()
        .filter_map(|(index, light)| light.emitter().map(|emitter| (emitter.surface, index as u32)))
        .collect();
    light_of.sort_unstable();
    let mut bsdfs: Vec<Bsdf> = scene.materials.iter().map(|material| Bsdf::new(&material.kind, range_nm)).collect();
    if plan.runs(EffectName::NestedDielectrics) {
        let mut media: Vec<RefractiveIndex> = Vec::new();
        for index in scene.materials.iter().filter_map(|material| material.kind.solid()?.0) {
            if !media.contains(index) {
                media.push(index.clone());
            }
        }
        for (bsdf, material) in bsdfs.iter_mut().zip(&scene.materials) {
            if let (Bsdf::RoughDielectric(glass), Some(_)) = (bsdf.untinted_mut(), material.kind.solid()) {
                glass.prepare_media(&media, range_nm);
            }
        }
    }
    if plan.runs(EffectName::Fluorescence) {
        let skies = |nm: f64| {
            environments.iter().filter(|sky| sky.light.is_none()).map(move |sky| sky.radiance.spectrum().eval(nm))
        };
        let light = |nm| lights.power_at(nm, radius) + (PI * radius).powi(2) * skies(nm).sum::<f64>();
        let light = PathSpectrum::tabulate(range_nm, light);
        bsdfs.iter_mut().for_each(|bsdf| bsdf.expect_light(&light));
    }
    if plan.runs(EffectName::Polarisation) {
        bsdfs.iter_mut().for_each(Bsdf::prepare_polarisation);
    }
    let mut surfaces = Surfaces {
        bsdfs,
        white: Bsdf::Lambert(Lambert::new(PathSpectrum::Constant(1.0).into())),
        properties: scene.materials.iter().map(|material| properties(&material.kind)).collect(),
        stated_media: scene.materials.iter().map(|material| StatedMedia::of(material, range_nm, &frame)).collect(),
        objects: shapes::objects(scene)
            .zip(coordinates)
            .map(|(o, coordinates)| ObjectSurface {
                material: o.material,
                emission: o.emission.as_ref().map(|e| Emission {
                    radiance: spectrum(&e.radiance),
                    sides: e.sides,
                    image: e.image.clone(),
                }),
                opacity: match scene.materials[o.material].kind {
                    MaterialKind::Boundary { priority: None } => 0.0,
                    _ => o.opacity,
                },
                opacity_image: o.opacity_image.clone(),
                relief: o.relief.clone().map(|image| Relief { image, per_m: frame.per_m() }),
                coordinates,
                axis: axis(o, &scene.materials[o.material].kind),
            })
            .collect(),
        object_of,
        light_of,
    };
    if !scene.receivers.is_empty() {
        receiver::add_white(&mut surfaces, range_nm);
    }
    let camera_motion = camera_motion(&scene.camera, frame)?;
    let guided_targets = match study.carried {
        None => GuidedTargets::new(&surfaces, &geometry, &lights, range_nm),
        _ => GuidedTargets::default(),
    };
    let specular_connections = plan.runs(EffectName::SpecularConnections).then(|| {
        SpecularConnections::new(&surfaces, &geometry, &lights, |deltas| {
            LightTable::weighed(deltas, radius, scene.integrator.light_selection, worth)
        })
    });
    let specular_connections = specular_connections.flatten();
    // Places in beams are chosen for what is searched for from there.
    let panes = specular_connections
        .as_ref()
        .filter(|connections| !connections.has_beams)
        .and_then(|_| RefractingBodies::panes(&surfaces, &geometry));
    // A study may weigh shadow rays otherwise.
    let refracting_bodies = (plan.runs(EffectName::RefractedShadows) && sampling == LightSampling::Mis)
        .then(|| RefractingBodies::new(&surfaces, &geometry));
    let wavelengths = match &scene.film.bands {
        Some(bands) => WavelengthDistribution::for_bands(range_nm, bands),
        None => WavelengthDistribution::new(range_nm),
    };
    let drawn = matches!(plan.lane_model, LaneModel::Shared | LaneModel::Hero).then_some(&wavelengths);
    let tables = ShadingTables::new(&surfaces, &lights, &environments, drawn, plan.runs(EffectName::Polarisation));
    let has_boundaries = scene
        .placed_objects()
        .any(|object| matches!(scene.materials[object.material].kind, MaterialKind::Boundary { .. }));
    let media = plan.runs(EffectName::NestedDielectrics).then(|| media(scene, &frame)).transpose()?;
    Ok(Prepared {
        frame,
        camera: frame.camera(&scene.camera),
        camera_motion,
        lens: compound_lens(scene)?,
        media,
        has_boundaries,
        surrounding: scene.medium.as_ref().and_then(|medium| Medium::new(medium, range_nm, &frame)),
        geometry: Arc::new(geometry),
        receivers: scene.receivers.iter().map(|receiver| PreparedReceiver::new(receiver, &frame)).collect(),
        surfaces,
        lights,
        environments,
        wavelengths,
        wavelength_guide: None,
        one_lane: OneLaneFilm::new(scene),
        filter: FilterSampler::new(&scene.film.filter),
        tables,
        guided_targets,
        specular_connections,
        panes,
        refracting_bodies: refracting_bodies.flatten(),
        specular_objects: None,
        shadow_rays_stop_at_glass: false,
        plan,
        shape_warnings: warnings.len(),
        warnings,
        groups,
        study: study.clone(),
        scene: simulated,
    })
}

/// How the camera moves, if it does while the shutter is open.
fn camera_motion(camera: &etalon_scene::Camera, frame: SceneFrame) -> Result<Option<Moving>, PrepareError> {
    let Some(moves) = camera.motion.as_ref().filter(|moves| moves.moves(camera.shutter_s)) else { return Ok(None) };
    let motion = motion(&moves.motion, camera.shutter_s).map_err(PrepareError::Camera)?;
    Ok(Some(Moving { motion, eye_m: Vec3::from_array(moves.position_m), frame }))
}

/// The compound lens of the camera, if it has one.
fn compound_lens(scene: &Scene) -> Result<Option<Arc<PreparedLens>>, PrepareError> {
    let Projection::CompoundLens(lens) = &scene.camera.projection else { return Ok(None) };
    // A meter has no film.
    if !scene.receivers.is_empty() {
        return Ok(None);
    }
    let (width, height) = (f64::from(scene.film.width), f64::from(scene.film.height));
    // Wide filters look beyond the film.
    let beyond_px = if scene.film.sample_border { FilterSampler::reach_px(&scene.film.filter) } else { 0.5 };
    let reach = [width, height].map(|pixels| 1.0 + (2.0 * beyond_px - 1.0).max(0.0) / pixels);
    let made = PreparedLens::new(lens, width / height, reach, scene.integrator.wavelength_range_nm);
    made.map(|lens| Some(Arc::new(lens))).ok_or(PrepareError::DarkLens)
}

/// The axis of an object that is a polarising sheet, in the coordinates of its group.
fn axis(object: &Object, kind: &MaterialKind) -> Option<Vec3<f64>> {
    let MaterialKind::PolarisingSheet { axis, .. } = kind else { return None };
    Some(mapped(&Affine::new(&object.transform).normal_matrix(), Vec3::from_array(*axis)))
}

/// The solids that carry priorities.
fn media(scene: &Scene, frame: &SceneFrame) -> Result<Media, PrepareError> {
    let range_nm = scene.integrator.wavelength_range_nm;
    let solid = |object: &Object| {
        let Some((index, priority)) = scene.materials[object.material].kind.solid() else { return Ok(None) };
        match object.shape.open_edges() {
            None => {
                let medium = scene.materials[object.material].medium.as_deref();
                let medium = medium.and_then(|medium| Medium::new(medium, range_nm, frame));
                Ok(Some(Solid { priority, index: index.cloned(), medium }))
            }
            Some(why) => Err(PrepareError::OpenSolid { object: object.name.clone(), why }),
        }
    };
    Ok(Media { solids: shapes::objects(scene).map(solid).collect::<Result<_, _>>()? })
}

impl Prepared {
    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Other random numbers for the same scene. Nothing that is prepared depends on the seed: what is rendered from now on has every
    /// bit that it has in a scene of this seed.
    pub fn reseed(&mut self, seed: u64) {
        self.scene.integrator.seed = seed;
    }

    /// What will be simulated, and why.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// How many lights shadow rays aim at, and whether those near and bright are chosen for each point anew.
    pub fn lights(&self) -> (usize, bool) {
        (self.lights.lights().len(), self.lights.chooses_by_place())
    }

    /// The share of the shadow rays that a trial gave each light, or each light beyond the tree and then all of the tree: in the order of the scene,
    /// without lights that emit nothing, and for each triangle of a mesh that shines. `None` if no trial changed it.
    pub fn learned_light_shares(&self) -> Option<Vec<f64>> {
        self.lights.has_learned().then(|| self.lights.shares())
    }

    /// Of a camera with a compound lens: sin θ₀ of the cone of light that reaches the middle of the film, traced at the line d. Its pixels
    /// are irradiances over π sin²θ₀.
    pub fn image_numerical_aperture(&self) -> Option<f64> {
        self.lens.as_ref().map(|lens| lens.axial_sine())
    }

    /// The camera that makes the rays.
    pub(crate) fn tracing_camera(&self) -> Camera {
        let film = &self.scene.film;
        let made = |camera: &etalon_scene::Camera| {
            let made = Camera::new(camera, film.width, film.height, self.plan.runs(EffectName::Lens));
            match &self.lens {
                None => made,
                Some(lens) => {
                    made.through(lens.clone(), f64::from(film.width) / f64::from(film.height), self.frame.per_m())
                }
            }
        };
        match (&self.camera_motion, &self.scene.camera.motion) {
            (Some(moving), Some(unmoved)) => {
                let (forward, up) = (unmoved.forward, unmoved.up);
                let own = etalon_scene::Camera { position_m: [0.0; 3], forward, up, ..self.camera.clone() };
                made(&own).moving(moving.clone())
            }
            _ => made(&self.camera),
        }
    }

    /// Whether films hold S₁, S₂ and S₃: where they are asked for, and polarisation is carried.
    pub fn records_stokes(&self) -> bool {
        self.plan.stokes
    }

    /// What media do to light along paths, if that is simulated.
    pub(crate) fn participating(&self) -> Option<Participating<'_>> {
        let acts = self.plan.runs(EffectName::Absorption) || self.plan.runs(EffectName::Scattering);
        acts.then(|| Participating {
            unit_m: 1.0 / self.frame.per_m(),
            surrounding: self.surrounding.as_ref(),
            geometry: &self.geometry,
            frame: &self.frame,
        })
    }

    /// Width and height of the blocks of pixels that share paths, if any do.
    pub fn path_reuse(&self) -> Option<[u32; 2]> {
        self.plan.path_reuse
    }

    /// From which surfaces shadow rays are sent.
    pub(crate) fn shadow_rays(&self) -> ShadowRays {
        match () {
            () if self.plan.forces(EffectName::ShadowRays) => ShadowRays::Everywhere,
            // A lamp may shine in no wavelength that is rendered.
            () if self.plan.runs(EffectName::ShadowRays) && !self.lights.is_empty() => ShadowRays::WhereUseful,
            () => ShadowRays::Never,
        }
    }

    /// What was noticed and is not an error, such as triangles without area that were left out.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The share of the directions of diffuse surfaces that is drawn toward mirrors and bodies of glass where all of them are seen, and
    /// the number of these; 0 where that does not pay. Beside images of lamps only bodies of glass.
    pub fn guided_targets(&self) -> (f64, usize) {
        let (bodies, each) = self.guided_targets.bodies_aimed_at();
        (each * bodies.len() as f64, bodies.len())
    }

    /// In how many regions of the picture, and of how many, wavelengths are drawn by what they bring there; 0 of 0 if they are drawn alike
    /// everywhere.
    pub fn guided_wavelengths(&self) -> (usize, usize) {
        self.wavelength_guide.as_ref().map_or((0, 0), |guide| (guide.guided(), guide.densities.len()))
    }

    /// The shares of the vertices from which specular connections are made; `None` where there are none. The first is of vertices to which a
    /// path comes from the camera or by way of a mirror or glass. The second is of those to which it comes straight from a vertex that scatters.
    pub fn connection_shares(&self) -> Option<[f64; 2]> {
        self.specular_connections.as_ref().map(|connections| connections.shares)
    }

    /// Whether shadow rays go through glass.
    pub fn refracts_shadow_rays(&self) -> bool {
        self.refracting_bodies.is_some() && !self.shadow_rays_stop_at_glass
    }

    /// The largest share that is drawn toward images of lamps in smooth balls, and the number of images; 0 where that does not pay.
    pub fn specular_light_images(&self) -> (f64, usize) {
        let images = self.guided_targets.specular_images_aimed_at().len();
        (if images > 0 { self.guided_targets.share } else { 0.0 }, images)
    }

    /// The frame in which the scene is rendered; the geometry is in it.
    pub fn frame(&self) -> &SceneFrame {
        &self.frame
    }

    /// An object by its number on a path: the scene's own, then those of each group.
    pub(crate) fn object(&self, number: u32) -> Option<&Object> {
        shapes::objects(&self.scene).nth(number as usize)
    }

    /// The geometry.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }
}
