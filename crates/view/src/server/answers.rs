//! Answers that take work: pictures, maps, pixels, paths, files.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use axum::http::{HeaderName, StatusCode, header};
use axum::response::{IntoResponse, Response};
use etalon_picture::develop::{Tone, develop};
use etalon_picture::{Attribute, encode_exr, encode_png};

use super::routes::{App, PictureQuery, Refusal};
use crate::inspect::maps::{MapKind, comparison as compare, map as map_of};
use crate::inspect::{paths as drawn, pixel as of_pixel, spectrum as spectra};
use crate::live::Stage;
use crate::live::publish::Glance;
use crate::look::{Look, fast_png, white_of_chromaticity};
use crate::picture::Snapshot;

/// Developed pictures that are kept, for pages with the same look.
const KEPT: usize = 4;
/// Where an answer says what else is to be known of a picture, as JSON.
const ABOUT: HeaderName = HeaderName::from_static("etalon-about");

/// Developed pictures by number and look.
#[derive(Default)]
pub(crate) struct Cache {
    pictures: Mutex<VecDeque<Kept>>,
}

struct Kept {
    number: u64,
    look: Look,
    png: Arc<[u8]>,
    about: String,
}

fn refuse(status: StatusCode, why: impl Into<String>) -> Refusal {
    (status, why.into())
}

fn cannot(why: impl ToString) -> Refusal {
    refuse(StatusCode::UNPROCESSABLE_ENTITY, why.to_string())
}

/// The picture, or the one that it is compared with.
fn snapshot(app: &App, pinned: bool) -> Result<Arc<Snapshot>, Refusal> {
    let seen = app.live.seen();
    let found = if pinned { seen.pinned.clone() } else { seen.snapshot.clone() };
    found.ok_or_else(|| refuse(StatusCode::NOT_FOUND, "there is no such picture yet"))
}

fn with_stage<T>(app: &App, work: impl FnOnce(&Stage) -> Result<T, Refusal>) -> Result<T, Refusal> {
    let stage = app.live.stage.read().unwrap_or_else(PoisonError::into_inner);
    work(stage.as_ref().ok_or_else(|| refuse(StatusCode::SERVICE_UNAVAILABLE, "the scene is not ready yet"))?)
}

fn json(value: &impl serde::Serialize) -> Response {
    axum::Json(value).into_response()
}

/// A developed picture; nothing if there is none yet. The header says its number, its size, and what was clipped.
pub(crate) fn picture(app: &App, query: &PictureQuery) -> Result<Response, Refusal> {
    if !query.pinned && app.live.seen().snapshot.is_none() {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let (snapshot, look) = (snapshot(app, query.pinned)?, query.look());
    app.live.is_looked_at();
    let answer = |png: &[u8], about: &str| {
        ([(header::CONTENT_TYPE, "image/png".to_owned()), (ABOUT, about.to_owned())], png.to_vec()).into_response()
    };
    let kept = || app.cache.pictures.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(kept) = kept().iter().find(|kept| kept.number == snapshot.number && kept.look == look) {
        return Ok(answer(&kept.png, &kept.about));
    }
    let settings = look.settings().map_err(cannot)?;
    let (developed, png) = app.live.overhead.count(Glance::Answer, || -> Result<_, Refusal> {
        let developed = develop(&snapshot.file, &settings).map_err(cannot)?;
        let image = &developed.image;
        let png = fast_png(image.width, image.height, &image.pixels);
        Ok((developed, png))
    })?;
    let Tone::Picture { exposure_ev, clipping } = developed.tone else { return Err(cannot("no picture")) };
    let about = serde_json::json!({
        "picture": snapshot.number,
        "stage": snapshot.stage,
        "size": snapshot.size(),
        "film": snapshot.film,
        "block": snapshot.block,
        "relative_rmse": snapshot.error.as_ref().and_then(|error| error.relative_rmse),
        "exposure_ev": exposure_ev,
        "clipped": clipping.any,
        "pixels": clipping.of,
        "not_finite": developed.not_finite.count,
    })
    .to_string();
    let answer = answer(&png, &about);
    let mut pictures = kept();
    pictures.push_front(Kept { number: snapshot.number, look, png: png.into(), about });
    pictures.truncate(KEPT);
    Ok(answer)
}

/// A map of the picture; the header has its legend.
pub(crate) fn map(app: &App, kind: MapKind) -> Result<Response, Refusal> {
    let current = snapshot(app, false)?;
    let pinned = snapshot(app, true).ok();
    if kind == MapKind::Difference && pinned.as_ref().is_some_and(|pinned| pinned.stage == current.stage) {
        return Err(cannot("the pinned picture and this one share their samples: change something first"));
    }
    let map = app.live.overhead.count(Glance::Answer, || map_of(kind, &current, pinned.as_deref())).map_err(cannot)?;
    let about =
        serde_json::json!({ "picture": current.number, "size": current.size(), "legend": map.legend }).to_string();
    Ok(([(header::CONTENT_TYPE, "image/png".to_owned()), (ABOUT, about)], map.png).into_response())
}

/// What is known of a pixel.
pub(crate) fn pixel(app: &App, at: [u32; 2]) -> Result<Response, Refusal> {
    let snapshot = snapshot(app, false)?;
    let outside = || refuse(StatusCode::NOT_FOUND, "the pixel is not in the picture");
    let mut info = of_pixel::of_picture(&snapshot, at).ok_or_else(outside)?;
    if snapshot.camera.is_some() {
        with_stage(app, |stage| {
            let film = &stage.prepared.scene().film;
            if at[0] < film.width && at[1] < film.height {
                info.object = of_pixel::object_at(&stage.prepared, at);
            }
            Ok(())
        })?;
    }
    Ok(json(&info))
}

/// The white of a look in which what is seen about a pixel looks white.
pub(crate) fn white(app: &App, at: [u32; 2]) -> Result<Response, Refusal> {
    let picture = snapshot(app, false)?;
    let xy = of_pixel::white_at(&picture, at).map_err(cannot)?;
    Ok(json(&serde_json::json!({ "white": white_of_chromaticity(xy) })))
}

/// The spectrum of a pixel: that of the picture where it has bands, else by paths of its own.
pub(crate) fn spectrum(app: &App, at: [u32; 2], samples: u32) -> Result<Response, Refusal> {
    let snapshot = snapshot(app, false)?;
    if snapshot.pixel_of(at).is_none() {
        return Err(refuse(StatusCode::NOT_FOUND, "the pixel is not in the picture"));
    }
    if let Some(spectrum) = spectra::of_picture(&snapshot, at) {
        return Ok(json(&spectrum));
    }
    if snapshot.camera.is_none() {
        return Err(cannot("the file has no spectral bands"));
    }
    Ok(json(&app.spectra.ask(&app.live, at, samples).map_err(cannot)?))
}

/// Paths of a pixel, and where they are seen.
pub(crate) fn paths(app: &App, at: [u32; 2], count: u32) -> Result<Response, Refusal> {
    if snapshot(app, false)?.camera.is_none() {
        return Err(cannot("a picture from a file has no paths: open its scene"));
    }
    with_stage(app, |stage| {
        let view = crate::camera::CameraView::of(&stage.scene.camera);
        Ok(json(&drawn::of_pixel(&stage.prepared, &view, at, count.max(1)).map_err(cannot)?))
    })
}

/// Whether the picture and the pinned one differ beyond their noise. Null as long as there is nothing to compare: a coarse picture has
/// fewer pixels, one of the stage before shows something else, and one of the pinned picture's own stage shares its samples.
pub(crate) fn comparison(app: &App) -> Result<Response, Refusal> {
    let (current, pinned) = (snapshot(app, false)?, snapshot(app, true)?);
    let under_way = app.live.seen().status.stage;
    if current.block > 1 || current.stage != under_way || current.stage == pinned.stage {
        return Ok(json(&serde_json::Value::Null));
    }
    Ok(json(&app.live.overhead.count(Glance::Answer, || compare(&current, &pinned)).map_err(cannot)?))
}

fn download(kind: &'static str, name: &str, bytes: Vec<u8>) -> Response {
    let name: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' }).collect();
    let disposition = format!("attachment; filename=\"{name}\"");
    ([(header::CONTENT_TYPE, kind.to_owned()), (header::CONTENT_DISPOSITION, disposition)], bytes).into_response()
}

fn stem(snapshot: &Snapshot) -> String {
    let name = snapshot.title.split_whitespace().next().unwrap_or("picture").to_owned();
    let stem = name.rsplit(['/', '\\']).next().unwrap_or_default().split('.').next().unwrap_or_default().to_owned();
    if stem.is_empty() { "picture".to_owned() } else { stem }
}

/// The picture as an EXR file with its errors. It says from where it is seen.
pub(crate) fn save_exr(app: &App) -> Result<Response, Refusal> {
    let snapshot = snapshot(app, false)?;
    let mut attributes = snapshot.file.attributes.clone();
    if let Some(camera) = &snapshot.camera {
        let text = serde_json::to_string(camera).expect("a camera is plain data");
        attributes.insert("viewCamera".to_owned(), Attribute::Text(text));
    }
    let bytes = encode_exr(&snapshot.file.picture, &attributes).map_err(cannot)?;
    Ok(download("image/x-exr", &format!("{}.exr", stem(&snapshot)), bytes))
}

/// The picture as a PNG file as it looks. It says how it was made.
pub(crate) fn save_png(app: &App, query: &PictureQuery) -> Result<Response, Refusal> {
    let (snapshot, look) = (snapshot(app, query.pinned)?, query.look());
    let developed = develop(&snapshot.file, &look.settings().map_err(cannot)?).map_err(cannot)?;
    let error = snapshot.error.as_ref().and_then(|error| error.relative_rmse);
    let mut comment = format!("{}, {} samples a pixel, {}", snapshot.title, snapshot.samples, look.as_text());
    if let Some(error) = error {
        comment += &format!(", relative error {error}");
    }
    if let Some(camera) = &snapshot.camera {
        comment += &format!(", camera {}", serde_json::to_string(camera).expect("a camera is plain data"));
    }
    let software = concat!("etalon ", env!("CARGO_PKG_VERSION"));
    let bytes = encode_png(&developed.image, &[("Software", software), ("Comment", &comment)]).map_err(cannot)?;
    Ok(download("image/png", &format!("{}.png", stem(&snapshot)), bytes))
}
