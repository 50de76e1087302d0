//! A picture under way that many pages look at: what they wish, and what there is.

pub(crate) mod coarse;
pub(crate) mod costs;
pub(crate) mod painter;
pub(crate) mod publish;
pub(crate) mod refine;
pub(crate) mod reload;
pub(crate) mod status;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, RwLock};
use std::time::Duration;

use etalon_scene::Scene;
use etalon_transport::{EffectName, Prepared, Study};
use tokio::sync::watch;

use crate::camera::CameraView;
use crate::picture::Snapshot;
use crate::source::LoadedScene;
use status::Status;

/// What the pages wish. The painter looks at it after each piece of work.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wish {
    /// Grows whenever the picture is to begin again: another camera, other effects, another scene.
    pub stage: u64,
    /// Where the camera was moved to; `None` leaves it where the scene has it.
    pub camera: Option<CameraView>,
    /// Whether the camera is on its way, so that a coarse picture is enough for the moment.
    pub moving: bool,
    /// Effects that are left out.
    pub without: Vec<EffectName>,
    /// The relative error that is enough; `None` goes on until it is stopped.
    pub target: Option<f64>,
    /// Whether nothing is rendered for now.
    pub paused: bool,
    /// Whether the cost of each effect is to be found out.
    pub costs: bool,
    /// Added to the seed of the scene, so that two pictures that are compared have noise of their own.
    pub seed_offset: u64,
}

/// What is rendered, and for which stage it was prepared.
pub(crate) struct Stage {
    /// See [`Wish::stage`].
    pub number: u64,
    /// The scene, ready.
    pub prepared: Prepared,
    /// What it was prepared from.
    pub scene: Scene,
    /// See `scene`.
    pub study: Study,
    /// SHA-256 of the scene and its files.
    pub scene_sha256: String,
}

/// What there is to see.
#[derive(Default)]
pub(crate) struct Seen {
    /// For the pages, as they show it.
    pub status: Status,
    /// The picture.
    pub snapshot: Option<Arc<Snapshot>>,
    /// The picture that it is compared with.
    pub pinned: Option<Arc<Snapshot>>,
}

/// Everything that the server and the painter share.
pub(crate) struct Live {
    wish: Mutex<Wish>,
    woken: Condvar,
    seen: Mutex<Seen>,
    /// The number of the last change of what is seen.
    news: watch::Sender<u64>,
    /// Read while something is traced, written while another scene is prepared.
    pub stage: RwLock<Option<Stage>>,
    snapshots: AtomicU64,
    /// The scene as its file has it now; `None` for a picture from a file.
    pub scene: Mutex<Option<LoadedScene>>,
    /// Whether any page has had a picture yet.
    is_watched: AtomicBool,
    /// Time that is spent on showing instead of rendering.
    pub overhead: publish::Overhead,
}

impl Live {
    pub(crate) fn new(status: Status, wish: Wish, scene: Option<LoadedScene>) -> Self {
        Self {
            wish: Mutex::new(wish),
            woken: Condvar::new(),
            seen: Mutex::new(Seen { status, ..Seen::default() }),
            news: watch::Sender::new(1),
            stage: RwLock::new(None),
            snapshots: AtomicU64::new(0),
            scene: Mutex::new(scene),
            is_watched: AtomicBool::new(false),
            overhead: publish::Overhead::default(),
        }
    }

    /// A wish as it is now.
    pub(crate) fn wish(&self) -> Wish {
        self.lock_wish().clone()
    }

    /// Changes what is wished, and wakes the painter.
    pub(crate) fn change(&self, change: impl FnOnce(&mut Wish)) {
        change(&mut self.lock_wish());
        self.woken.notify_all();
    }

    /// Waits until somebody changes a wish, or for this time.
    pub(crate) fn wait(&self, while_true: impl Fn(&Wish) -> bool, most: Duration) {
        let guard = self.lock_wish();
        let waited = self.woken.wait_timeout_while(guard, most, |wish| while_true(wish));
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    fn lock_wish(&self) -> MutexGuard<'_, Wish> {
        self.wish.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What there is to see, for reading.
    pub(crate) fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes what there is to see, and tells all pages.
    pub(crate) fn show(&self, change: impl FnOnce(&mut Seen)) {
        change(&mut self.seen());
        self.news.send_modify(|number| *number += 1);
    }

    /// Tells of changes.
    pub(crate) fn subscribe(&self) -> watch::Receiver<u64> {
        self.news.subscribe()
    }

    /// The number of a new snapshot.
    pub(crate) fn next_snapshot(&self) -> u64 {
        self.snapshots.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// A page has got a picture.
    pub(crate) fn is_looked_at(&self) {
        if !self.is_watched.swap(true, Ordering::Relaxed) {
            self.woken.notify_all();
        }
    }

    /// Waits until a page has got a picture, or for this time.
    pub(crate) fn wait_for_page(&self, most: Duration) {
        self.wait(|_| !self.is_watched.load(Ordering::Relaxed), most);
    }
}
