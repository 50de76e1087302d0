//! What the pages are told: plain data for JSON, in which unknown numbers are `null`.

use etalon::ErrorReport;
use etalon_transport::EffectName;
use serde::Serialize;
use serde_json::Value;

use crate::camera::CameraView;
use crate::live::costs::EffectCost;
use crate::picture::Snapshot;

/// What the painter does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Phase {
    /// The scene is made ready.
    #[default]
    Preparing,
    /// A first picture of few pixels.
    Coarse,
    /// It looks where the error is, and how fast it falls.
    Pilot,
    /// The picture.
    Rendering,
    /// The samples that the pilot planned for the stated error are taken: it is reached, or missed by little.
    Done,
    /// Stopped by the page.
    Paused,
    /// The cost of effects is found out.
    Costs,
    /// A picture from a file: nothing is rendered.
    Picture,
    /// The scene has errors.
    Refused,
}

/// A point of the curve of the error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct CurvePoint {
    /// Since the picture was begun, without pauses.
    pub seconds: f64,
    /// Samples a pixel; 0 for coarse pictures, which are not part of the picture.
    pub samples: u32,
    /// The relative error of the picture, and its 95 % interval.
    pub relative_rmse: f64,
    /// See `relative_rmse`; `null` if it is unknown.
    pub interval: Option<[f64; 2]>,
    /// Side of the blocks that the pixels of a coarse picture stand for; 1 for the picture itself.
    pub block: u32,
}

/// When an error is predicted to be reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Predicted {
    /// The relative error.
    pub relative_rmse: f64,
    /// Samples a pixel.
    pub samples: f64,
    /// Since the picture was begun, with what came before its first sample; and the 95 % interval.
    pub seconds: f64,
    /// See `seconds`.
    pub seconds_interval: [f64; 2],
}

/// A picture that another is compared with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Pinned {
    /// Its number.
    pub number: u64,
    /// The stage that it shows. Pictures of one stage share their samples, so their difference is not tested.
    pub stage: u64,
    /// Columns and rows.
    pub size: [usize; 2],
    /// What it shows.
    pub title: String,
    /// Its relative error.
    pub relative_rmse: Option<f64>,
}

impl Pinned {
    /// What a page is told of a picture.
    pub(crate) fn of(snapshot: &Snapshot) -> Self {
        Self {
            number: snapshot.number,
            stage: snapshot.stage,
            size: snapshot.size(),
            title: snapshot.title.clone(),
            relative_rmse: snapshot.error.as_ref().and_then(|error| error.relative_rmse),
        }
    }
}

/// What the page shows.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Status {
    /// Of the scene or picture.
    pub name: String,
    /// Whether it is a scene, which is rendered.
    pub is_scene: bool,
    /// Columns and rows of the film.
    pub size: [u32; 2],
    /// See `Wish::stage`.
    pub stage: u64,
    /// Number of the picture that can be had; 0 if there is none.
    pub picture: u64,
    /// Columns and rows of that picture.
    pub picture_size: [usize; 2],
    /// Side of the blocks that its pixels stand for.
    pub block: u32,
    /// What is done at the moment.
    pub phase: Phase,
    /// Samples a pixel.
    pub samples: u32,
    /// Independent replicates of each pixel.
    pub replicates: u32,
    /// Since the picture was begun, without pauses.
    pub seconds: f64,
    /// The error of the picture.
    pub error: Option<ErrorReport>,
    /// Its error as it fell.
    pub curve: Vec<CurvePoint>,
    /// What a pilot predicts.
    pub predicted: Vec<Predicted>,
    /// Samples a pixel at which the stated error is predicted to be reached.
    pub goal_samples: Option<u32>,
    /// The stated error.
    pub target: Option<f64>,
    /// Camera paths in a second.
    pub paths_per_second: f64,
    /// Camera paths so far.
    pub paths: u64,
    /// Whether regions take different numbers of samples, and the factor of time that this is predicted to win.
    pub adaptive_gain: Option<f64>,
    /// Where the camera is.
    pub camera: Option<CameraView>,
    /// Whether the page moved it.
    pub is_moved: bool,
    /// What the scene calls up: orbits turn about it.
    pub world_up: Option<[f64; 3]>,
    /// The plan: effects with their reasons.
    pub plan: Value,
    /// Effects that the page left out.
    pub without: Vec<EffectName>,
    /// What each effect costs, once it was asked for.
    pub costs: Vec<EffectCost>,
    /// What is wrong in the edited file, which is not shown.
    pub problems: Vec<Value>,
    /// Why the scene, with this camera and these effects, cannot be rendered.
    pub refusal: Option<String>,
    /// What is to be known of the picture, in sentences.
    pub notes: Vec<String>,
    /// The picture that it is compared with.
    pub pinned: Option<Pinned>,
    /// Pages that look on.
    pub pages: usize,
    /// Threads that render.
    pub threads: usize,
    /// Spectral bands of the picture itself, nm.
    pub bands_nm: Vec<f64>,
    /// Seconds that preparing the scene took.
    pub prepare_seconds: f64,
}
