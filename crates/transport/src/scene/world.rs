//! The scene as paths see it.

use crate::guiding::SpecularObjects;
use crate::guiding::{GuidedTargets, RefractingBodies, SpecularConnections};
use crate::light::{Environment, EnvironmentLight, LightTable};
use crate::media::{Media, Participating};
use crate::scene::shading_tables::ShadingTables;
use crate::surface::Surfaces;
use etalon_geometry::Geometry;
use etalon_scene::LightSampling;

/// All that a path meets.
#[derive(Clone, Copy)]
pub(crate) struct World<'a> {
    pub geometry: &'a Geometry,
    pub surfaces: &'a Surfaces,
    pub lights: &'a LightTable,
    pub environments: &'a [Environment],
    /// The media, if the scene's solids are nested.
    pub media: Option<&'a Media>,
    /// What media do to light on its way, if they do anything.
    pub participating: Option<Participating<'a>>,
    pub light_sampling: LightSampling,
    pub shadow_rays: ShadowRays,
    /// Whether some surface lets light, or a part of it, pass as if it were not there.
    pub masks: bool,
    /// Whether surfaces that coincide are met as one group: masks let paths pass, or solids share interfaces.
    pub meets_groups: bool,
    /// Whether something moves while the shutter is open.
    pub moves: bool,
    /// Whether shadow rays are sent to lamps without area of which ways through media have a lit part.
    pub lights_parts: bool,
    /// Whether light that the walk runs into may have been found by a shadow ray too.
    pub weigh_hits: bool,
    /// Most path edges from the camera to a light, at most [`MOST_VERTICES`](crate::integrator::MOST_VERTICES).
    pub max_depth: u32,
    /// Whether the way straight through a pane counts as an edge.
    pub counts_panes: bool,
    /// Whether camera rays go straight past lamps and find no light of skies.
    pub hides_lights: bool,
    pub roulette: bool,
    /// Whether some surface gives light back at other wavelengths.
    pub fluoresces: bool,
    pub tables: &'a ShadingTables,
    /// Whether no shadow ray aims at any of the skies.
    pub plain_skies: bool,
    /// The lamps without area whose light is looked for by way of mirrors and smooth interfaces, if it is.
    pub specular_connections: Option<&'a SpecularConnections>,
    /// The panes through which shadow rays go straight to such lamps, if they do.
    pub panes: Option<&'a RefractingBodies>,
    /// The glass that shadow rays go through, if they do.
    pub refracting_bodies: Option<&'a RefractingBodies>,
    /// The objects whose light is followed from the lamps, if it is.
    pub specular_objects: Option<&'a SpecularObjects>,
    /// What diffuse surfaces draw directions toward.
    pub guided_targets: &'a GuidedTargets,
}

impl World<'_> {
    /// Whether it matters which media hold a path.
    #[inline(always)]
    pub(crate) fn follows_media(&self) -> bool {
        self.media.is_some() || self.participating.is_some()
    }

    /// The first sky that is an image.
    #[inline(always)]
    pub(crate) fn first_image_of_the_sky(&self) -> Option<&EnvironmentLight> {
        self.environments.iter().find_map(|sky| sky.radiance.image())
    }
}

/// From which surfaces shadow rays are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShadowRays {
    Never,
    /// From those that can scatter what arrives from a given direction.
    WhereUseful,
    /// From every surface, although some can make nothing of it: for the study of what that costs.
    Everywhere,
}
