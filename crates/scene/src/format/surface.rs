//! What materials and images ask of the surface that they are on.

use crate::json::{Code, Reader, Span};
use crate::model::{MaterialKind, Shape};
use crate::texture::ImageTexture;

/// Reports an image over a shape that has no texture coordinates.
pub(super) fn check_coordinates(image: Option<&ImageTexture>, shape: &Shape, at: Span, reader: &mut Reader<'_>) {
    if let Some(image) = image
        && !shape.has_texture_coordinates()
    {
        let message = format!("the shape has no texture coordinates for the image \"{}\"", image.name);
        reader.error_hint(Code::NoTextureCoordinates, at, message, GIVE_COORDINATES);
    }
}

/// Reports colours of vertices on a shape that has none, or whose colours are no reflectances.
pub(super) fn check_colours(material: &MaterialKind, shape: &Shape, at: Span, reader: &mut Reader<'_>) {
    let colours = shape.vertex_colours();
    for factor in material.vertex_colours() {
        if colours.is_empty() {
            let message = "the vertices of the shape have no colours, which its material shows";
            let hint = "give the mesh \"colours\", or use a PLY file with red, green and blue";
            reader.error_hint(Code::NoVertexColours, at, message, hint);
            return;
        }
        let shown = |colour: [f32; 3]| [0, 1, 2].map(|c| f64::from(colour[c]) * factor[c]);
        let possible = |colour: &[f32; 3]| shown(*colour).iter().all(|channel| (0.0..=1.0).contains(channel));
        if let Some(i) = colours.iter().position(|colour| !possible(colour)) {
            let message = format!("the colour of vertex {i} is {:?}: not a reflectance (0 to 1)", shown(colours[i]));
            reader.error(Code::Reflectance, at, message);
            return;
        }
    }
}

/// Reports facets of two widths on a shape that has no texture coordinates.
pub(super) fn check_tangents(shape: &Shape, at: Span, reader: &mut Reader<'_>) {
    if !shape.has_texture_coordinates() {
        let message = "the shape has no texture coordinates, from which the material's grain has its direction";
        reader.error_hint(Code::NoTextureCoordinates, at, message, GIVE_COORDINATES);
    }
}

const GIVE_COORDINATES: &str = "give the mesh \"uvs\", or use a file with texture coordinates";
