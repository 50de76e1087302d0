//! What a frame of a sequence takes over from an earlier one. Nothing depends on it but time.

use super::{Prepared, camera_motion, compound_lens};
use crate::light::{EnvironmentLight, EnvironmentRadiance};
use crate::plan::{EffectName, Plan};
use crate::scene::prepare_error::PrepareError;
use crate::scene::shapes::stand_still;
use etalon_scene::{EnvironmentImage, Integrator, LightKind, Scene};
use std::sync::Arc;

impl Prepared {
    /// Whether another scene differs in nothing but its camera, its seed and its number of samples.
    pub(super) fn is_the_same_world(&self, scene: &Scene, plan: &Plan) -> bool {
        let own = &self.scene;
        let integrator = Integrator { seed: own.integrator.seed, spp: own.integrator.spp, ..scene.integrator.clone() };
        let still = |scene: &Scene| {
            stand_still(&scene.instances, scene)
                && scene.groups.iter().all(|group| stand_still(&group.instances, scene))
        };
        own.integrator == integrator
            && own.film == scene.film
            && own.receivers == scene.receivers
            && own.instances == scene.instances
            && still(own)
            && still(scene)
            && own.materials == scene.materials
            && own.lights == scene.lights
            && own.medium == scene.medium
            && own.groups == scene.groups
            && own.objects == scene.objects
            && simulates_the_same(&self.plan, plan)
    }

    /// The same world in the view of another camera.
    pub(super) fn seen_anew(mut self, scene: Scene, plan: Plan) -> Result<Self, PrepareError> {
        self.camera = self.frame.camera(&scene.camera);
        self.camera_motion = camera_motion(&scene.camera, self.frame)?;
        if self.scene.camera.projection != scene.camera.projection {
            self.lens = compound_lens(&scene)?;
        }
        self.warnings.truncate(self.shape_warnings);
        Ok(Self { scene, plan, ..self })
    }

    /// The light that this image makes, if it is here.
    pub(super) fn image_environment(
        &self,
        image: &EnvironmentImage,
        integrator: &Integrator,
    ) -> Option<Arc<EnvironmentLight>> {
        let own = &self.scene.integrator;
        if (own.wavelength_range_nm, own.light_sampling) != (integrator.wavelength_range_nm, integrator.light_sampling)
        {
            return None;
        }
        let images = self.scene.lights.iter().filter_map(|light| match &light.kind {
            LightKind::ImageEnvironment(image) if !image.is_zero() => Some(image),
            _ => None,
        });
        let lights = self.environments.iter().filter_map(|sky| match &sky.radiance {
            EnvironmentRadiance::Image(light) => Some(light),
            _ => None,
        });
        // Both are in the order of the scene.
        images.zip(lights).find(|(other, _)| *other == image).map(|(_, light)| light.clone())
    }
}

/// Whether two plans agree in all that is prepared beside the camera.
fn simulates_the_same(a: &Plan, b: &Plan) -> bool {
    let effects = |plan: &Plan| -> Vec<_> {
        let of_world = |name| !matches!(name, EffectName::Lens | EffectName::Motion);
        plan.effects.iter().filter(|e| of_world(e.name)).map(|e| (e.name, e.on, e.study)).collect()
    };
    (a.kernel, a.lane_model, a.stokes) == (b.kernel, b.lane_model, b.stokes) && effects(a) == effects(b)
}
