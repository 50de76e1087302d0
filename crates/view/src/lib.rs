//! A local web page that shows a render while its error falls: `etalon view`.
//!
//! ```text
//! Source ──Viewer::bind──▶ Viewer ──run──▶ page, events, pictures     for whoever knows the token
//!                             └── a painter renders: coarse, pilot, passes; begins again where the page wants another picture
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | `source` | what is viewed: a scene or a picture |
//! | `live` | what the pages wish and what there is to see; the painter, first coarse pictures, costs of effects, edits of files |
//! | `picture` | one picture at one moment |
//! | `camera`, `look` | the camera as a page moves it; exposure, white balance and tone curve |
//! | `inspect` | pixels, spectra, paths, maps |
//! | `server` | the guard, the routes, the files of the page |
//!
//! The page itself is in `page/`, plain HTML, CSS and JavaScript modules without a build step. It is part of the program and asks no
//! other server. No request names a file of the disk.

mod camera;
mod inspect;
mod live;
mod look;
mod picture;
mod server;
mod source;

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use inspect::spectrum::SpectralProbe;
use live::painter::Painter;
use live::publish::{Publisher, put};
use live::reload::WatchedFiles;
use live::status::{Phase, Status};
use live::{Live, Wish, reload};
use server::routes::App;

pub use server::guard::{LEAST_TOKEN, Token};
pub use source::{LoadScene, LoadedScene, SceneSource, Source};

/// Why there is nothing to view.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The address is taken, or is not of this machine.
    #[error("cannot listen at {address}")]
    Bind {
        /// The address.
        address: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// No thread, or no random numbers.
    #[error("cannot start the server: {0}")]
    Start(String),
    /// The picture cannot be shown.
    #[error(transparent)]
    Picture(#[from] etalon_picture::PictureError),
}

/// A server that is ready.
pub struct Viewer {
    runtime: tokio::runtime::Runtime,
    listener: tokio::net::TcpListener,
    address: String,
    app: Arc<App>,
}

impl Viewer {
    /// Listens at an address of this machine, for whoever knows the token, and begins to render. Port 0 takes one that is free.
    ///
    /// # Errors
    /// If the address cannot be had, or there is no thread.
    pub fn bind(source: Source, ip: IpAddr, port: u16, token: Token) -> Result<Self, ViewError> {
        let start = |error: &dyn std::fmt::Display| ViewError::Start(error.to_string());
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(4)
            .thread_name("view-answer")
            .build()
            .map_err(|error| start(&error))?;
        let address = SocketAddr::new(ip, port);
        let listener = runtime
            .block_on(tokio::net::TcpListener::bind(address))
            .map_err(|source| ViewError::Bind { address, source })?;
        let bound = listener.local_addr().map_err(|error| start(&error))?;
        let live = begin(source)?;
        let app = App {
            live,
            spectra: SpectralProbe::default(),
            pages: AtomicUsize::new(0),
            cache: server::answers::Cache::default(),
            token: token.clone(),
        };
        Ok(Self { runtime, listener, address: server::address_of(bound, &token), app: Arc::new(app) })
    }

    /// The address that a browser opens, with the token in it.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Serves as long as the program runs.
    ///
    /// # Errors
    /// If nothing can be accepted any more.
    pub fn run(self) -> Result<(), ViewError> {
        let served = self.runtime.block_on(server::run(self.listener, self.app));
        served.map_err(|error| ViewError::Start(error.to_string()))
    }
}

/// Starts what makes pictures.
fn begin(source: Source) -> Result<Arc<Live>, ViewError> {
    let failed = |error: std::io::Error| ViewError::Start(error.to_string());
    match source {
        Source::Picture { name, file } => {
            let snapshot = picture::of_file(*file, name.clone())?;
            let [width, height] = snapshot.size().map(|side| side as u32);
            let plan = match snapshot.file.attributes.get("plan") {
                Some(etalon_picture::Attribute::Text(text)) => serde_json::from_str(text).unwrap_or_default(),
                _ => serde_json::Value::Null,
            };
            let status =
                Status { name, size: [width, height], stage: 1, phase: Phase::Picture, plan, ..Status::default() };
            let live = Arc::new(Live::new(status, Wish { stage: 1, ..Wish::default() }, None));
            put(&live, snapshot);
            Ok(live)
        }
        Source::Scene(source) => {
            let SceneSource { name, first, load, study, error, threads } = *source;
            let film = &first.scene.film;
            let size = [film.width, film.height];
            let status = Status { name, is_scene: true, size, target: Some(error), ..Status::default() };
            let wish = Wish { stage: 1, target: Some(error), ..Wish::default() };
            let files = WatchedFiles::of(&first);
            let live = Arc::new(Live::new(status, wish, Some(first)));
            reload::start(&live, load, files).map_err(failed)?;
            let publisher = Publisher::start(&live).map_err(failed)?;
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads.unwrap_or(0))
                .thread_name(|index| format!("view-render-{index}"))
                .build()
                .map_err(|error| ViewError::Start(error.to_string()))?;
            let painter = Painter { live: Arc::clone(&live), study, error, publisher, pool };
            std::thread::Builder::new().name("view-painter".to_owned()).spawn(move || painter.run()).map_err(failed)?;
            Ok(live)
        }
    }
}
