//! Paths of a pixel once more, vertex by vertex, and where they are seen in the picture.

use etalon_optics::colour::rec709_from_xyz;
use etalon_transport::Prepared;
use etalon_transport::replay::{Event, Replay};
use serde::Serialize;

use super::pixel::material_of;
use crate::camera::CameraView;

/// Most paths that are asked for at once.
pub(crate) const MOST: u32 = 64;

/// A path as it is drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct DrawnPath {
    /// Number of the sample.
    pub sample: u32,
    /// Linear Rec. 709 of what the sample adds to its pixel.
    pub rgb: [f64; 3],
    /// Luminance Y of that.
    pub luminance: f64,
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
    /// Vertices in order.
    pub vertices: Vec<DrawnVertex>,
    /// Why it ended.
    pub end: &'static str,
    /// Straight pieces between vertices that are in front of the eye: number of the vertex at their end, and both ends in pixels.
    pub pieces: Vec<(usize, [[f64; 2]; 2])>,
}

/// A vertex of a path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct DrawnVertex {
    /// Name of the object; "medium" where a medium scattered the path.
    pub object: String,
    /// Name of its material.
    pub material: Option<String>,
    /// Position, m.
    pub position_m: [f64; 3],
    /// Column and row; `None` behind the eye.
    pub pixel: Option<[f64; 2]>,
    /// Throughput of the path up to here, mean over its wavelengths.
    pub throughput: f64,
    /// Light that was added here: how it was found, and its part of the luminance Y.
    pub light: Vec<(String, f64)>,
}

/// The first paths of a pixel.
///
/// # Errors
/// A sentence that says why paths cannot be told apart.
pub(crate) fn of_pixel(
    prepared: &Prepared,
    view: &CameraView,
    [x, y]: [u32; 2],
    count: u32,
) -> Result<Vec<DrawnPath>, String> {
    if prepared.path_reuse().is_some() {
        return Err("neighbouring pixels share paths here, so no path stands alone".to_owned());
    }
    let film = &prepared.scene().film;
    let size = [film.width, film.height];
    if x >= size[0] || y >= size[1] {
        return Err("the pixel is not in the picture".to_owned());
    }
    let drawn = |sample| draw(prepared, view, size, sample, &prepared.replay_camera_path(x, y, sample));
    Ok((0..count.min(MOST)).map(drawn).collect())
}

fn draw(prepared: &Prepared, view: &CameraView, size: [u32; 2], sample: u32, replay: &Replay) -> DrawnPath {
    let mean = |lanes: &[f64]| lanes.iter().sum::<f64>() / lanes.len().max(1) as f64;
    let (mut vertices, mut end) = (Vec::<DrawnVertex>::new(), "");
    // What is found before any surface, such as the sky behind everything.
    let mut before = Vec::new();
    let vertex = |object: &str, material, position_m: [f64; 3], beta: &[f64]| DrawnVertex {
        object: object.to_owned(),
        material,
        position_m,
        pixel: view.pixel(view.local(position_m), size),
        throughput: mean(beta),
        light: Vec::new(),
    };
    for event in &replay.events {
        match event {
            Event::Vertex { object, position_m, beta, .. } => {
                vertices.push(vertex(object, material_of(prepared.scene(), object), *position_m, beta));
            }
            Event::Scattering { position_m, beta, .. } => vertices.push(vertex("medium", None, *position_m, beta)),
            Event::Fluorescence { .. } => {
                if let Some(vertex) = vertices.last_mut() {
                    vertex.object.push_str(" (fluoresces)");
                }
            }
            Event::Light { found, luminance, .. } => {
                let light = vertices.last_mut().map_or(&mut before, |vertex| &mut vertex.light);
                light.push((found.clone(), *luminance));
            }
            Event::End { because } => end = because,
        }
    }
    let ends = vertices.windows(2).enumerate();
    let pieces = ends
        .filter_map(|(index, pair)| Some((index + 1, view.segment(pair[0].position_m, pair[1].position_m, size)?)))
        .collect();
    DrawnPath {
        sample,
        rgb: rec709_from_xyz(replay.xyz),
        luminance: replay.xyz[1],
        wavelengths_nm: replay.wavelengths_nm.clone(),
        vertices,
        end,
        pieces,
    }
}
