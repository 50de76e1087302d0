//! A validated scene: inert data in SI units, every name resolved, nothing prepared for rendering.
//!
//! Lengths are metres, angles radians, wavelengths nanometres. World space is right-handed. Whoever holds a [`Scene`]
//! may rely on everything that `docs/scene-format.md` lists as an error being absent from it.

mod compound_lens;
mod daylight;
mod detail;
mod emission;
mod environment;
mod film;
mod grating;
mod integrator;
mod light;
mod material;
mod medium;
mod meter;
mod motion;
mod parameter;
mod references;
mod shape;
mod shutter;
mod sky;
mod slide;
mod thin_film;
mod varying;

pub use compound_lens::{CompoundLens, LensCoating, LensSurface};
pub use daylight::{DaylightExtremes, DaylightLook, DaylightPattern, DaylightSky};
pub use detail::{Bitangent, OpacityImage, Relief, Terminator};
pub use emission::{Emission, EmissionSides};
pub use environment::{EnvironmentImage, EnvironmentProjection};
pub use film::{Bands, BandsError, Film, Filter, MOST_BANDS};
pub use grating::{Grating, Grooves};
pub use integrator::{
    Integrator, LightSampling, LightSelection, LightTracing, MOST_REPLICATES, PathReuse, SamplerKind,
};
pub use light::{Beam, BeamProfile, Light, LightCone, LightKind};
pub use material::{
    FacetDistribution, FacetMasking, InternalReflection, LEAST_ALPHA, Material, MaterialKind, Metal, Microfacets,
    PolarisingSheet, PrincipledLobes, Side,
};
pub use medium::{
    AlbedoGrid, DensityGrid, ExponentialDensity, Medium, MediumDensity, PhaseFunction, PhaseMatrix, PhaseTable,
};
pub use meter::{Meter, MeterKind, MeterQuantity, Receiver};
pub use motion::{CameraMotion, Keyframe, Motion};
pub use parameter::{Parameter, ParameterMut};
pub use references::ReferenceError;
pub use shape::{DiskCoordinates, Mesh, Shape};
pub(crate) use shutter::middle_s;
pub use sky::{CieSky, Perez, SkyCoefficients};
pub use slide::{EvenOn, SlideLight};
pub use thin_film::{FilmIndex, FilmLayer, ThinFilm};
pub use varying::{NumberTexture, SpectrumTexture};

use glam::{DAffine3, DVec3};
use std::sync::Arc;

use crate::linear::{from_rows, rows};

/// A whole scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The camera.
    pub camera: Camera,
    /// Image size and reconstruction.
    pub film: Film,
    /// Materials by index; objects refer to them.
    pub materials: Vec<Material>,
    /// Things with a surface.
    pub objects: Vec<Object>,
    /// Objects that are defined once and placed by instances. A group's own instances place groups before it.
    pub groups: Vec<Group>,
    /// Groups placed in the scene.
    pub instances: Vec<Instance>,
    /// Lights without a surface.
    pub lights: Vec<Light>,
    /// What fills the space outside of all bodies, if it does anything to light.
    pub medium: Option<Medium>,
    /// What is measured beside the picture: [`Scene::measured`].
    pub meters: Vec<Meter>,
    /// Where paths begin instead of at the camera: column by column of the film. Empty where the scene is a picture.
    pub receivers: Vec<Receiver>,
    /// How to integrate, as far as the file says; the command line may override it.
    pub integrator: Integrator,
}

impl Scene {
    /// The scene as its meters see it: a film with a column for each reading, in the order of the meters, and `rows` rows that are
    /// independent of each other. It keeps one band, all wavelengths rendered. `None` if there are no meters.
    ///
    /// A row is a replicate, so that each has a place of its own on the film, and all of them can be rendered at the same time.
    pub fn measured(&self, rows: u32) -> Option<Self> {
        let receivers: Vec<Receiver> = self.meters.iter().flat_map(|meter| meter.kind.receivers()).collect();
        let width = u32::try_from(receivers.len()).ok().filter(|&width| width > 0)?;
        let [first, last] = self.integrator.wavelength_range_nm;
        let all = Bands { first_nm: 0.5 * (first + last), step_nm: last - first, count: 1 };
        let film =
            Film { width, height: rows, filter: Filter::Box, sample_border: true, stokes: false, bands: Some(all) };
        let integrator = Integrator { replicates: 1, path_reuse: PathReuse::None, ..self.integrator.clone() };
        Some(Self { film, integrator, receivers, ..self.clone() })
    }

    /// Every object that is somewhere in the scene, once however often it is placed: the scene's own, then those of each
    /// group that an instance places.
    pub fn placed_objects(&self) -> impl Iterator<Item = &Object> {
        let mut placed = vec![false; self.groups.len()];
        self.instances.iter().for_each(|instance| placed[instance.group] = true);
        // Groups place only groups before them.
        for (index, group) in self.groups.iter().enumerate().rev() {
            if placed[index] {
                group.instances.iter().for_each(|instance| placed[instance.group] = true);
            }
        }
        let groups = self.groups.iter().zip(placed).filter(|(_, placed)| *placed);
        self.objects.iter().chain(groups.flat_map(|(group, _)| &group.objects))
    }
}

/// A camera in world space: if it has keyframes, as it stands in the middle of the shutter's time.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye (the centre of the lens; the vertex of the first surface of a compound lens), m.
    pub position_m: [f64; 3],
    /// Unit vector of the viewing direction.
    pub forward: [f64; 3],
    /// Unit vector, orthogonal to `forward`, that is up in the picture.
    pub up: [f64; 3],
    /// Unit vector that the scene calls up, at any angle to `forward`. Keyframes do not turn it. It makes no ray.
    pub world_up: [f64; 3],
    /// Whether left and right are exchanged in the picture, as in a mirror.
    pub mirrored: bool,
    /// How points project.
    pub projection: Projection,
    /// Where rays start: this far along `forward` from the eye, m; what is nearer is cut off.
    pub near_m: f64,
    /// When the shutter opens and when it closes, s.
    pub shutter_s: [f64; 2],
    /// Where it is at all times, if the scene states keyframes. Whether it moves while the shutter is open: [`CameraMotion::moves`].
    pub motion: Option<CameraMotion>,
}

impl Camera {
    /// Unit vector to the right in the picture.
    pub fn right(&self) -> [f64; 3] {
        right_of(self.forward, self.up, self.mirrored)
    }
}

/// Unit vector to the right in the picture of a camera with these orthogonal unit vectors, whose picture may be mirrored.
pub fn right_of(forward: [f64; 3], up: [f64; 3], mirrored: bool) -> [f64; 3] {
    let right = DVec3::from(forward).cross(DVec3::from(up));
    if mirrored { -right } else { right }.to_array()
}

/// How a camera projects.
#[derive(Clone, Debug, PartialEq)]
pub enum Projection {
    /// Central projection, through a pinhole or a thin lens.
    Perspective {
        /// Full vertical field of view, rad, in (0, π). Pixels are square.
        vertical_fov_rad: f64,
        /// The lens; `None` is a pinhole.
        lens: Option<ThinLens>,
    },
    /// Parallel projection.
    Orthographic {
        /// Height of the picture in the world, m.
        height_m: f64,
    },
    /// Through the surfaces of a lens, onto a film. The camera's position is the vertex of the first surface.
    CompoundLens(Arc<CompoundLens>),
}

/// An ideal thin lens.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinLens {
    /// Radius of the aperture, m; may be 0, which is a pinhole.
    pub radius_m: f64,
    /// Distance along `forward` of the plane in focus, m.
    pub focus_distance_m: f64,
}

/// A thing with a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name in the file, or `objects[i]`.
    pub name: String,
    /// Its shape, in its own coordinates.
    pub shape: Shape,
    /// From its own coordinates to the world.
    pub transform: Transform,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// What it emits, if it does.
    pub emission: Option<Emission>,
    /// Share of light that meets the surface at all, in [0, 1]; the rest passes as if it were not there.
    pub opacity: f64,
    /// An image of that share, by which `opacity` is multiplied.
    pub opacity_image: Option<OpacityImage>,
    /// An image of other normals to scatter around.
    pub relief: Option<Relief>,
}

/// Objects that are placed together, in the group's own coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name in the file.
    pub name: String,
    /// Things with a surface.
    pub objects: Vec<Object>,
    /// Groups before this one, placed within it.
    pub instances: Vec<Instance>,
}

/// A group placed in the scene, or in another group.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Its name in the file, or `instances[i]`.
    pub name: String,
    /// Index into [`Scene::groups`].
    pub group: usize,
    /// From the group's coordinates to those where it is placed: if it has keyframes, in the middle of the shutter's time.
    pub transform: Transform,
    /// Where it is at all times, if the scene states keyframes. Whether it moves while the shutter is open: [`Motion::moves`].
    pub motion: Option<Motion>,
}

/// An affine map: `world = linear · local + translation`.
#[derive(Clone, Debug, PartialEq)]
pub struct Transform {
    /// Rows of the linear part; never singular.
    pub linear: [[f64; 3]; 3],
    /// Translation, m.
    pub translation_m: [f64; 3],
}

impl Transform {
    /// Leaves everything in place.
    pub const IDENTITY: Self =
        Self { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation_m: [0.0; 3] };

    /// The map.
    pub fn affine(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(from_rows(self.linear), self.translation_m.into())
    }
}

impl From<DAffine3> for Transform {
    fn from(map: DAffine3) -> Self {
        Self { linear: rows(&map.matrix3), translation_m: map.translation.to_array() }
    }
}
