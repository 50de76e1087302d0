//! S₁, S₂ and S₃ of a picture as channels of an EXR file.
//!
//! Beside `R`, `G` and `B`, which are S₀, stand `S1.R` … `S3.B`: linear Rec. 709 of the CIE XYZ of each parameter, negative where
//! it is, and their standard errors as `Error.S1.R` … `Error.S3.B`.

use etalon_picture::{Attribute, Attributes, ERROR_PREFIX, Picture, PictureError};
use etalon_transport::{Film, PixelRect};

/// Adds what the film has of S₁, S₂ and S₃ in `rect` to its picture, and says in `attributes` how to read it.
pub(crate) fn add(
    picture: &mut Picture<f32>,
    attributes: &mut Attributes,
    film: &Film,
    rect: PixelRect,
) -> Result<(), PictureError> {
    if !film.records_stokes() {
        return Ok(());
    }
    let pixels: Vec<_> = rect.pixels().filter_map(|(x, y)| film.stokes_rec709(x, y)).collect();
    for (index, channel) in ["R", "G", "B"].into_iter().enumerate() {
        for parameter in 0..3 {
            let name = format!("S{}.{channel}", parameter + 1);
            let of = |what: usize| pixels.iter().map(|stokes| stokes[parameter][what][index]).collect::<Vec<f32>>();
            picture.insert(&name, of(0))?;
            let errors = of(1);
            // Where nothing at all is known there is nothing to say.
            if errors.iter().any(|error| error.is_finite()) {
                picture.insert(&format!("{ERROR_PREFIX}{name}"), errors)?;
            }
        }
    }
    // S₃ > 0 is right-handed: the field turns clockwise for whom the light comes toward.
    attributes.insert("polarisationHandedness".to_owned(), Attribute::Text("right".to_owned()));
    let frame =
        "S1: along the picture's right less along its up; S2: along the diagonal up to the right less along the other";
    attributes.insert("stokesFrame".to_owned(), Attribute::Text(frame.to_owned()));
    Ok(())
}
