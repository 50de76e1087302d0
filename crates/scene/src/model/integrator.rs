//! How a scene is to be integrated.

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
    /// Whether `max_depth` counts the way straight through a thin pane or a polarising sheet as an edge.
    pub count_panes: bool,
    /// Whether the camera sees straight past lamps and skies, which light the scene all the same.
    pub hide_lights: bool,
    /// Whether Russian roulette may end a path.
    pub roulette: bool,
    /// How direct light is found.
    pub light_sampling: LightSampling,
    /// Which of several lights a shadow ray aims at.
    pub light_selection: LightSelection,
    /// Whether light is followed from the lamps too.
    pub light_tracing: LightTracing,
    /// Wavelengths rendered: the first and the last, nm.
    pub wavelength_range_nm: [f64; 2],
    /// Which neighbouring pixels share paths.
    pub path_reuse: PathReuse,
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
    /// In proportion to their power, without regard to their place.
    Power,
    /// By a tree over where they are and where they shine, for each point anew.
    Tree,
}

/// Whether what mirrors and glass throw on a scene is found by paths from the lamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightTracing {
    /// Where a trial before the picture finds less noise for the time.
    Auto,
    /// Never.
    Never,
    /// Wherever they are possible.
    Always,
}
