//! What is known of one pixel: its value with its error, and what is seen there.

use etalon_picture::develop::{Rect, patch_xyz, white_balance};
use etalon_picture::{Attribute, ERROR_PREFIX, Picture};
use etalon_scene::Scene;
use etalon_transport::{PixelRect, Prepared};
use serde::Serialize;

use crate::picture::Snapshot;

/// Camera rays that tell what a pixel shows.
const RAYS: u32 = 16;
/// Pixels of the film on each side of a pixel whose colour is to look white.
const WHITE_REACH: u32 = 4;

/// A pixel of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct PixelInfo {
    /// Column and row in the film.
    pub at: [u32; 2],
    /// Linear Rec. 709.
    pub rgb: [f64; 3],
    /// Standard error of each component.
    pub rgb_error: Option<[f64; 3]>,
    /// Luminance Y.
    pub luminance: f64,
    /// Its standard error.
    pub luminance_error: Option<f64>,
    /// Mean luminance of the picture.
    pub mean_luminance: Option<f64>,
    /// Samples of the pixel; of a picture from a file only where it says so.
    pub samples: Option<f64>,
    /// Side of the block that the pixel stands for.
    pub block: u32,
    /// What is seen there.
    pub object: Option<ObjectInfo>,
}

/// What most camera rays of a pixel meet first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ObjectInfo {
    /// Name of the object.
    pub object: String,
    /// Name of its material.
    pub material: Option<String>,
    /// Where, m, in the mean.
    pub position_m: Option<[f64; 3]>,
    /// Distance along the viewing direction, m.
    pub depth_m: Option<f64>,
}

/// What a picture knows of a pixel; `None` if it has no such pixel.
pub(crate) fn of_picture(snapshot: &Snapshot, at: [u32; 2]) -> Option<PixelInfo> {
    let index = snapshot.pixel_of(at)?;
    let picture = &snapshot.file.picture;
    let value = |name: &str| picture.channel(name).map(|samples| f64::from(samples[index]));
    let three = |picture: &Picture<f32>, prefix: &str| {
        let of = |name| picture.channel(&format!("{prefix}{name}")).map(|samples| f64::from(samples[index]));
        let [r, g, b] = ["R", "G", "B"].map(of);
        Some([r?, g?, b?])
    };
    let luminance = f64::from(snapshot.luminance.values[index]);
    let luminance_error = snapshot.luminance.errors.get(index).map(|error| f64::from(*error));
    let even = (snapshot.samples > 0).then_some(f64::from(snapshot.samples));
    Some(PixelInfo {
        at,
        rgb: three(snapshot.colour.as_ref().unwrap_or(picture), "").unwrap_or([luminance; 3]),
        rgb_error: three(picture, ERROR_PREFIX),
        luminance,
        luminance_error: luminance_error.filter(|error| error.is_finite()),
        mean_luminance: snapshot.error.as_ref().map(|error| error.mean_y),
        samples: value("samples").or(even),
        block: snapshot.block,
        object: named_in_file(snapshot, index),
    })
}

/// The CIE 1931 chromaticity of what is seen about a pixel of the film.
///
/// # Errors
/// A sentence that says why that cannot look white.
pub(crate) fn white_at(snapshot: &Snapshot, at: [u32; 2]) -> Result<[f64; 2], String> {
    let patch = patch_at(snapshot, at).ok_or("the pixel is not in the picture")?;
    let picture = snapshot.colour.as_ref().unwrap_or(&snapshot.file.picture);
    let xyz = patch_xyz(picture, patch).map_err(|error| error.to_string())?;
    let is_colour = xyz.iter().all(|v| *v >= 0.0) && white_balance(xyz).is_some();
    let sum: f64 = xyz.iter().sum();
    let xy = is_colour.then(|| [xyz[0] / sum, xyz[1] / sum]);
    xy.ok_or_else(|| "this spot cannot look white: it is black, or its colour is that of no light".to_owned())
}

/// The pixels of a picture, which may be coarse, about a pixel of the film.
fn patch_at(snapshot: &Snapshot, at: [u32; 2]) -> Option<Rect> {
    snapshot.pixel_of(at)?;
    let size = snapshot.size();
    let [(x, width), (y, height)] = [0, 1].map(|axis| {
        let first = (at[axis].saturating_sub(WHITE_REACH) / snapshot.block) as usize;
        let last = (((at[axis] + WHITE_REACH) / snapshot.block) as usize).min(size[axis] - 1);
        (first, last - first + 1)
    });
    Some(Rect { x, y, width, height })
}

/// The object as a file tells it, by its number and the list of names.
fn named_in_file(snapshot: &Snapshot, index: usize) -> Option<ObjectInfo> {
    let picture = &snapshot.file.picture;
    let number = picture.channel("ObjectId")?[index];
    let Some(Attribute::Text(names)) = snapshot.file.attributes.get("objectNames") else { return None };
    let names: Vec<String> = serde_json::from_str(names).ok()?;
    let object = names.get((number as usize).checked_sub(1)?)?.clone();
    let depth_m = picture.channel("Z").map(|depths| f64::from(depths[index]));
    Some(ObjectInfo { object, material: None, position_m: None, depth_m })
}

/// What most camera rays of a pixel meet first; `None` where that is nothing.
pub(crate) fn object_at(prepared: &Prepared, [x, y]: [u32; 2]) -> Option<ObjectInfo> {
    let rect = PixelRect { x0: x, y0: y, x1: x + 1, y1: y + 1 };
    let features = prepared.features(&[rect], RAYS, Some(1)).ok()?;
    let features = features.first()?.first()?;
    let number = (features.object as usize).checked_sub(1)?;
    let (object, material) = names(prepared.scene(), number)?;
    Some(ObjectInfo {
        object,
        material: Some(material),
        position_m: Some(features.position_m.map(f64::from)),
        depth_m: Some(f64::from(features.depth_m)),
    })
}

/// The names of an object and of its material by its number on paths: the scene's own objects, then those of each group.
fn names(scene: &Scene, number: usize) -> Option<(String, String)> {
    let object = scene.objects.iter().chain(scene.groups.iter().flat_map(|group| &group.objects)).nth(number)?;
    Some((object.name.clone(), scene.materials[object.material].name.clone()))
}

/// The material of the first object of this name.
pub(crate) fn material_of(scene: &Scene, object: &str) -> Option<String> {
    let mut all = scene.objects.iter().chain(scene.groups.iter().flat_map(|group| &group.objects));
    let found = all.find(|other| other.name == object)?;
    Some(scene.materials[found.material].name.clone())
}
