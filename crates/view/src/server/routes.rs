//! What can be asked, and by whom.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use axum::extract::{DefaultBodyLimit, Path, Query, Request, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::sse::{Event, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use etalon_transport::EffectName;
use futures_util::stream::{self, Stream};
use serde::Deserialize;
use tokio::sync::watch;

use super::guard::{Token, check};
use super::{MOST_BODY, MOST_PAGES, answers, page};
use crate::camera::CameraView;
use crate::inspect::maps::MapKind;
use crate::inspect::spectrum::SpectralProbe;
use crate::live::Live;
use crate::live::status::Pinned;
use crate::look::Look;
use crate::picture::Snapshot;

/// Shortest time between two events.
const EVENT_INTERVAL: Duration = Duration::from_millis(60);

/// What all requests share.
pub(crate) struct App {
    pub live: Arc<Live>,
    pub token: Token,
    pub spectra: SpectralProbe,
    pub pages: AtomicUsize,
    pub cache: answers::Cache,
}

type Shared = State<Arc<App>>;

/// A refusal, as a status and a sentence.
pub(crate) type Refusal = (StatusCode, String);

/// All routes, behind the guard.
pub(crate) fn router(app: Arc<App>) -> Router {
    Router::new()
        .route("/{token}/", get(|| async { page_file("") }))
        .route("/{token}/{name}", get(|Path((_, name)): Path<(String, String)>| async move { page_file(&name) }))
        .route("/{token}/ask/events", get(events))
        .route("/{token}/ask/picture.png", get(picture))
        .route("/{token}/ask/map.png", get(map))
        .route("/{token}/ask/pixel", get(pixel))
        .route("/{token}/ask/white", get(white))
        .route("/{token}/ask/spectrum", get(spectrum))
        .route("/{token}/ask/paths", get(paths))
        .route("/{token}/ask/comparison", get(comparison))
        .route("/{token}/ask/save.exr", get(save_exr))
        .route("/{token}/ask/save.png", get(save_png))
        .route("/{token}/do/camera", post(move_camera))
        .route("/{token}/do/control", post(control))
        .route("/{token}/do/effects", post(effects))
        .route("/{token}/do/pin", post(pin))
        .layer(DefaultBodyLimit::max(MOST_BODY))
        .layer(from_fn_with_state(Arc::clone(&app), guard))
        .with_state(app)
}

/// Lets in whom [`check`] lets in, and says in every answer what a browser may do with it.
async fn guard(State(app): Shared, request: Request, next: Next) -> Response {
    let allowed = check(request.method(), request.uri().path(), request.headers(), &app.token);
    let mut response = match allowed {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (header::CACHE_CONTROL, "no-store"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (
            header::CONTENT_SECURITY_POLICY,
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; \
             base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        ),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

fn page_file(name: &str) -> Response {
    match page::find(name) {
        Some(file) => ([(header::CONTENT_TYPE, file.kind)], file.text).into_response(),
        None => (StatusCode::NOT_FOUND, "there is no such part of the page").into_response(),
    }
}

/// Counts a page as long as it listens.
struct Listening(Arc<App>);

impl Listening {
    fn begin(app: &Arc<App>) -> Option<Self> {
        let count = |pages: usize| (pages < MOST_PAGES).then_some(pages + 1);
        let before = app.pages.fetch_update(Ordering::Relaxed, Ordering::Relaxed, count).ok()?;
        app.live.show(|seen| seen.status.pages = before + 1);
        Some(Self(Arc::clone(app)))
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        let before = self.0.pages.fetch_sub(1, Ordering::Relaxed);
        self.0.live.show(|seen| seen.status.pages = before - 1);
    }
}

async fn events(State(app): Shared) -> Result<Sse<impl Stream<Item = Result<Event, Infallible>>>, Refusal> {
    let listening = Listening::begin(&app).ok_or_else(|| {
        (StatusCode::SERVICE_UNAVAILABLE, format!("{MOST_PAGES} pages look on already; close one of them"))
    })?;
    let mut news = app.live.subscribe();
    news.mark_changed();
    let next = |(listening, mut news): (Listening, watch::Receiver<u64>)| async move {
        news.changed().await.ok()?;
        let text = serde_json::to_string(&listening.0.live.seen().status).expect("a status is plain data");
        tokio::time::sleep(EVENT_INTERVAL).await;
        Some((Ok(Event::default().data(text)), (listening, news)))
    };
    Ok(Sse::new(stream::unfold((listening, news), next)).keep_alive(Default::default()))
}

/// Which picture, and how it looks.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct PictureQuery {
    #[serde(default)]
    pub pinned: bool,
    #[serde(default)]
    pub exposure: String,
    #[serde(default)]
    pub white: String,
    #[serde(default)]
    pub curve: String,
}

impl PictureQuery {
    pub(crate) fn look(&self) -> Look {
        Look { exposure: self.exposure.clone(), white: self.white.clone(), curve: self.curve.clone() }
    }
}

/// Does work that takes a while where it keeps no other request waiting.
async fn aside<T: Send + 'static>(
    app: &Arc<App>,
    work: impl FnOnce(&App) -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let app = Arc::clone(app);
    let done = tokio::task::spawn_blocking(move || work(&app)).await;
    done.unwrap_or_else(|_| Err((StatusCode::INTERNAL_SERVER_ERROR, "the answer could not be computed".to_owned())))
}

async fn picture(State(app): Shared, Query(query): Query<PictureQuery>) -> Result<Response, Refusal> {
    aside(&app, move |app| answers::picture(app, &query)).await
}

#[derive(Deserialize)]
struct MapQuery {
    kind: MapKind,
}

async fn map(State(app): Shared, Query(query): Query<MapQuery>) -> Result<Response, Refusal> {
    aside(&app, move |app| answers::map(app, query.kind)).await
}

/// A pixel of the film, and how much is to be done for it.
#[derive(Clone, Copy, Deserialize)]
struct PixelQuery {
    x: u32,
    y: u32,
    #[serde(default)]
    count: u32,
}

async fn pixel(State(app): Shared, Query(query): Query<PixelQuery>) -> Result<Response, Refusal> {
    aside(&app, move |app| answers::pixel(app, [query.x, query.y])).await
}

async fn white(State(app): Shared, Query(query): Query<PixelQuery>) -> Result<Response, Refusal> {
    aside(&app, move |app| answers::white(app, [query.x, query.y])).await
}

async fn spectrum(State(app): Shared, Query(query): Query<PixelQuery>) -> Result<Response, Refusal> {
    aside(&app, move |app| answers::spectrum(app, [query.x, query.y], query.count)).await
}

async fn paths(State(app): Shared, Query(query): Query<PixelQuery>) -> Result<Response, Refusal> {
    aside(&app, move |app| answers::paths(app, [query.x, query.y], query.count)).await
}

async fn comparison(State(app): Shared) -> Result<Response, Refusal> {
    aside(&app, answers::comparison).await
}

async fn save_exr(State(app): Shared) -> Result<Response, Refusal> {
    aside(&app, answers::save_exr).await
}

async fn save_png(State(app): Shared, Query(query): Query<PictureQuery>) -> Result<Response, Refusal> {
    aside(&app, move |app| answers::save_png(app, &query)).await
}

#[derive(Deserialize)]
struct CameraOrder {
    /// `None` goes back to the scene's own camera.
    camera: Option<CameraView>,
    #[serde(default)]
    moving: bool,
}

/// The stage that an order begins.
type Begun = Result<Json<serde_json::Value>, Refusal>;

fn only_scenes(app: &App) -> Result<(), Refusal> {
    if app.live.seen().status.is_scene {
        return Ok(());
    }
    Err((StatusCode::CONFLICT, "this is a picture from a file: nothing is rendered".to_owned()))
}

fn change(app: &App, change: impl FnOnce(&mut crate::live::Wish)) -> Begun {
    let mut stage = 0;
    app.live.change(|wish| {
        change(wish);
        stage = wish.stage;
    });
    Ok(Json(serde_json::json!({ "stage": stage })))
}

async fn move_camera(State(app): Shared, Json(order): Json<CameraOrder>) -> Begun {
    only_scenes(&app)?;
    let camera = order.camera.map(CameraView::checked).transpose();
    let camera = camera.map_err(|why| (StatusCode::UNPROCESSABLE_ENTITY, why))?;
    change(&app, |wish| {
        let is_same = wish.camera == camera;
        (wish.camera, wish.moving) = (camera, order.moving);
        if !is_same {
            wish.stage += 1;
        }
    })
}

#[derive(Deserialize)]
struct ControlOrder {
    paused: Option<bool>,
    /// The relative error that is enough; 0 goes on without end.
    target: Option<f64>,
    #[serde(default)]
    costs: bool,
}

async fn control(State(app): Shared, Json(order): Json<ControlOrder>) -> Begun {
    only_scenes(&app)?;
    if order.target.is_some_and(|target| !(0.0..=1.0).contains(&target)) {
        return Err((StatusCode::UNPROCESSABLE_ENTITY, "the error is a share from 0 to 1".to_owned()));
    }
    let done = change(&app, |wish| {
        wish.paused = order.paused.unwrap_or(wish.paused);
        if let Some(target) = order.target {
            wish.target = (target > 0.0).then_some(target);
        }
        wish.costs |= order.costs;
    });
    app.live.show(|seen| {
        if let Some(target) = order.target {
            seen.status.target = (target > 0.0).then_some(target);
            seen.status.goal_samples = None;
        }
    });
    done
}

#[derive(Deserialize)]
struct EffectsOrder {
    /// The effects to leave out.
    without: Vec<String>,
}

async fn effects(State(app): Shared, Json(order): Json<EffectsOrder>) -> Begun {
    only_scenes(&app)?;
    let names: Result<Vec<EffectName>, String> = order.without.iter().map(|name| name.parse()).collect();
    let mut names = names.map_err(|why| (StatusCode::UNPROCESSABLE_ENTITY, why))?;
    let mut seen = Vec::new();
    names.retain(|name| {
        !seen.contains(name) && {
            seen.push(*name);
            true
        }
    });
    change(&app, |wish| {
        if wish.without != names {
            wish.without = names;
            wish.stage += 1;
        }
    })
}

#[derive(Deserialize)]
struct PinOrder {
    pinned: bool,
}

/// The picture of now, if it can be compared with those that follow. A coarse one has fewer pixels.
fn pinnable(app: &App) -> Result<Arc<Snapshot>, Refusal> {
    let found = app.live.seen().snapshot.clone().filter(|snapshot| snapshot.block == 1);
    found.ok_or_else(|| (StatusCode::CONFLICT, "there is no picture of all pixels to pin yet".to_owned()))
}

/// Pins the picture as it is, to be compared with those that follow, or lets it go.
async fn pin(State(app): Shared, Json(order): Json<PinOrder>) -> Begun {
    let pinned = order.pinned.then(|| pinnable(&app)).transpose()?;
    let stage = pinned.as_ref().map(|snapshot| snapshot.stage);
    app.live.show(|seen| {
        seen.status.pinned = pinned.as_deref().map(Pinned::of);
        seen.pinned = pinned;
    });
    change(&app, |wish| {
        // What is rendered from the next stage on has noise of its own.
        wish.seed_offset += u64::from(order.pinned);
        // A later stage that is under way already shares its noise with the pinned picture, so it begins again.
        wish.stage += u64::from(stage.is_some_and(|stage| stage != wish.stage));
    })
}
