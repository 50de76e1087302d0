//! A validated scene: inert data in SI units, every name resolved, nothing prepared for rendering.
//!
//! Lengths are metres, angles radians, wavelengths nanometres. World space is right-handed. Whoever holds a [`Scene`]
//! may rely on everything that `docs/scene-format.md` lists as an error being absent from it.

mod detail;
mod emission;
mod environment;
mod material;
mod motion;

pub use detail::{OpacityImage, Relief};
pub use emission::{Emission, EmissionSides};
pub use environment::{EnvironmentImage, EnvironmentProjection};
pub use material::{LEAST_ALPHA, Material, MaterialKind, Metal, NumberTexture, PolarisingSheet, SpectrumTexture};

pub use motion::{CameraMotion, Keyframe, Motion};

use std::sync::Arc;

use etalon_optics::Spectrum;

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
    /// How to integrate, as far as the file says; the command line may override it.
    pub integrator: Integrator,
}

impl Scene {
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

/// A camera in world space: if it moves, as it stands in the middle of the shutter's time.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye (the centre of the lens), m.
    pub position_m: [f64; 3],
    /// Unit vector of the viewing direction.
    pub forward: [f64; 3],
    /// Unit vector, orthogonal to `forward`, that is up in the picture.
    pub up: [f64; 3],
    /// How points project.
    pub projection: Projection,
    /// When the shutter opens and when it closes, s.
    pub shutter_s: [f64; 2],
    /// How it moves, if it does while the shutter is open.
    pub motion: Option<CameraMotion>,
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
}

/// An ideal thin lens.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinLens {
    /// Radius of the aperture, m; may be 0, which is a pinhole.
    pub radius_m: f64,
    /// Distance along `forward` of the plane in focus, m.
    pub focus_distance_m: f64,
}

/// Image size and reconstruction.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Pixel filter, sampled by importance so that every sample belongs to one pixel.
    pub filter: Filter,
    /// Whether S₁, S₂ and S₃ are recorded beside the radiance.
    pub stokes: bool,
    /// Bands of wavelengths that the film keeps apart, beside its colour.
    pub bands: Option<Bands>,
}

/// Bands of wavelengths, each as wide as their centres are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bands {
    /// Centre of the first, nm.
    pub first_nm: f64,
    /// From centre to centre, nm.
    pub step_nm: f64,
    /// How many.
    pub count: u32,
}

/// Most bands of a film.
pub const MOST_BANDS: u32 = 512;

/// Why there are no such bands.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BandsError {
    /// Numbers that make no bands.
    #[error(
        "bands are the first centre, the last centre and the step in nm, the last a whole number of steps from the first"
    )]
    Malformed,
    /// Too many.
    #[error("{0} bands are more than {MOST_BANDS}")]
    TooMany(u64),
    /// Wavelengths that are not rendered.
    #[error("the bands reach from {} to {} nm, and wavelengths from {} to {} nm are rendered", bands[0], bands[1], range[0], range[1])]
    OutOfRange {
        /// First and last edge, nm.
        bands: [f64; 2],
        /// What is rendered, nm.
        range: [f64; 2],
    },
}

impl Bands {
    /// Bands from the centre of the first to that of the last, in steps, within the wavelengths that are rendered.
    ///
    /// # Errors
    /// [`BandsError`].
    pub fn new([first_nm, last_nm, step_nm]: [f64; 3], range_nm: [f64; 2]) -> Result<Self, BandsError> {
        let steps = (last_nm - first_nm) / step_nm;
        let positive = |value: f64| value > 0.0 && value.is_finite();
        // Steps such as 0.1 are not exact; a millionth of a step is.
        if !positive(first_nm)
            || !positive(step_nm)
            || !(0.0..1e9).contains(&steps)
            || (steps - steps.round()).abs() > 1e-6
        {
            return Err(BandsError::Malformed);
        }
        let count = steps.round() as u64 + 1;
        if count > u64::from(MOST_BANDS) {
            return Err(BandsError::TooMany(count));
        }
        let bands = Self { first_nm, step_nm, count: count as u32 };
        let edges = [bands.edge_nm(0), bands.edge_nm(bands.count)];
        if edges[0] < range_nm[0] || edges[1] > range_nm[1] {
            return Err(BandsError::OutOfRange { bands: edges, range: range_nm });
        }
        Ok(bands)
    }

    /// Where band `index` begins and the one before it ends, nm.
    pub fn edge_nm(&self, index: u32) -> f64 {
        self.first_nm + (f64::from(index) - 0.5) * self.step_nm
    }

    /// The band that a wavelength falls into: each has its lower edge.
    pub fn at(&self, nm: f64) -> Option<u32> {
        let from = (nm - self.edge_nm(0)) / self.step_nm;
        // Within the range after the comparison.
        (0.0..f64::from(self.count)).contains(&from).then_some(from as u32)
    }

    /// Centre of band `index`, nm.
    pub fn centre_nm(&self, index: u32) -> f64 {
        self.first_nm + f64::from(index) * self.step_nm
    }
}

/// Pixel filter.
#[derive(Clone, Debug, PartialEq)]
pub enum Filter {
    /// The pixel's own square.
    Box,
    /// A tent of this radius, in pixels.
    Tent {
        /// Radius, pixels.
        radius_px: f64,
    },
    /// A Gaussian of this standard deviation, cut at three of them.
    Gaussian {
        /// Standard deviation, pixels.
        sigma_px: f64,
    },
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
    /// From the group's coordinates to those where it is placed: if it moves, in the middle of the shutter's time.
    pub transform: Transform,
    /// How it moves, if it does while the shutter is open.
    pub motion: Option<Motion>,
}

/// A shape in its own coordinates, lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Sphere; its normal points outward.
    Sphere {
        /// Centre.
        center: [f64; 3],
        /// Radius, above 0.
        radius_m: f64,
    },
    /// The points `origin + a·u + b·v` for a, b in [0, 1]; its normal is along u × v.
    Parallelogram {
        /// One corner.
        origin: [f64; 3],
        /// One edge from it.
        u: [f64; 3],
        /// The other edge from it.
        v: [f64; 3],
    },
    /// Disk.
    Disk {
        /// Centre.
        center: [f64; 3],
        /// Unit normal.
        normal: [f64; 3],
        /// Radius, above 0.
        radius_m: f64,
    },
    /// Cylinder; its normal points outward.
    Cylinder {
        /// Middle of one end.
        start: [f64; 3],
        /// Middle of the other.
        end: [f64; 3],
        /// Radius, above 0.
        radius_m: f64,
        /// Whether disks close its ends.
        capped: bool,
    },
    /// Triangles; objects that name the same file share them.
    Mesh(Arc<Mesh>),
}

/// Triangles, and what their vertices carry.
///
/// The geometric normal of a triangle (a, b, c) is along (b − a) × (c − a).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, m.
    pub vertices: Vec<[f64; 3]>,
    /// Vertex indices, all within range.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals: none, or for each vertex a unit vector, or (0, 0, 0) where it has none.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates: none, or one pair for each vertex.
    pub uvs: Vec<[f32; 2]>,
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
}

/// A light without a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name in the file, or `lights[i]`.
    pub name: String,
    /// What it is.
    pub kind: LightKind,
}

/// What a light without a surface is.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// The same intensity in every direction, from a point.
    Point {
        /// Position, m.
        position_m: [f64; 3],
        /// Radiant intensity, W·sr⁻¹·nm⁻¹.
        intensity: Spectrum,
    },
    /// A point that shines into a cone, less and less towards its edge.
    Spot {
        /// Position, m.
        position_m: [f64; 3],
        /// Unit vector along the axis of the cone.
        axis: [f64; 3],
        /// Half angles, rad, at which the intensity begins to fall and is 0; in [0, π], ordered.
        half_angles_rad: [f64; 2],
        /// Radiant intensity along the axis, W·sr⁻¹·nm⁻¹.
        intensity: Spectrum,
    },
    /// Parallel light.
    Directional {
        /// Unit vector in which the light travels.
        direction: [f64; 3],
        /// Irradiance on a plane at right angles to it, W·m⁻²·nm⁻¹.
        irradiance: Spectrum,
    },
    /// The same radiance from every direction at infinity.
    Environment {
        /// Radiance, W·m⁻²·sr⁻¹·nm⁻¹.
        radiance: Spectrum,
    },
    /// Radiance from infinity that an image says for each direction.
    ImageEnvironment(EnvironmentImage),
}

/// How to integrate.
#[derive(Clone, Debug, PartialEq)]
pub struct Integrator {
    /// Samples a pixel.
    pub spp: u32,
    /// Independent replicates that the samples are dealt to, from 1 to [`MOST_REPLICATES`].
    pub replicates: u32,
    /// Seed of every random number.
    pub seed: u64,
    /// Number sequence.
    pub sampler: SamplerKind,
    /// Most path edges from the camera to a light: 1 is emission seen directly, 2 adds one bounce; `None` is no limit.
    pub max_depth: Option<u32>,
    /// Whether Russian roulette may end a path.
    pub roulette: bool,
    /// How direct light is found.
    pub light_sampling: LightSampling,
    /// Which of several lights a shadow ray aims at.
    pub light_selection: LightSelection,
    /// Wavelengths rendered: the first and the last, nm.
    pub wavelength_range_nm: [f64; 2],
    /// Which neighbouring pixels share paths.
    pub path_reuse: PathReuse,
    /// Scalar type of what each wavelength carries along a path.
    pub precision: Precision,
}

/// Most replicates that samples can be dealt to.
pub const MOST_REPLICATES: u32 = 64;

/// Which neighbouring pixels share paths: blocks, counted from the upper left corner of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathReuse {
    /// None.
    None,
    /// 2 × 2 pixels.
    Block2x2,
    /// 4 × 2 pixels.
    Block4x2,
    /// 4 × 4 pixels.
    Block4x4,
}

impl PathReuse {
    /// Width and height of a block, pixels.
    pub fn block_px(self) -> Option<[u32; 2]> {
        match self {
            Self::None => None,
            Self::Block2x2 => Some([2, 2]),
            Self::Block4x2 => Some([4, 2]),
            Self::Block4x4 => Some([4, 4]),
        }
    }
}

/// Number sequence that drives the estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerKind {
    /// Owen-scrambled Sobol points, padded.
    Sobol,
    /// Independent Xoshiro256++ numbers.
    Independent,
}

/// How direct light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightSampling {
    /// Shadow rays and BSDF sampling, combined by multiple importance sampling.
    Mis,
    /// Shadow rays wherever they can find the light.
    Light,
    /// BSDF sampling wherever it can find the light.
    Bsdf,
}

/// Which of several lights a shadow ray aims at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightSelection {
    /// By a tree where there are many, by power where there are few.
    Auto,
    /// In proportion to their power, wherever they are.
    Power,
    /// By a tree over where they are and where they shine, for each point anew.
    Tree,
}

/// Scalar type of what each wavelength carries along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 32-bit floating point.
    F32,
    /// 64-bit floating point.
    F64,
}
