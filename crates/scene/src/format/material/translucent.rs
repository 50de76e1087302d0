//! Sheets that scatter light to both sides.

use etalon_optics::spectrum::whole_nm;

use super::super::spectra::{Role, Spectra};
use super::super::spectrum::SpectrumForm;
use crate::files::Files;
use crate::json::{Code, Reader, Required};
use crate::model::{MaterialKind, SpectrumTexture};
use crate::texture::ImageTexture;

crate::record! {
    /// Diffuse reflection and diffuse transmission, alike on both sides: leaves, paper, cloth, lampshades. The two shares add up to at most 1.
    pub(crate) struct TranslucentMaterial + comment {
        /// Share of light that comes back, from 0 to 1.
        reflectance: Required<SpectrumForm>,
        /// Share of light that leaves on the other side, from 0 to 1.
        transmittance: Required<SpectrumForm>,
    }
}

/// The material of a form.
pub(super) fn translucent<'f>(
    form: &'f TranslucentMaterial,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    let reflectance =
        form.reflectance.as_ref().and_then(|form| spectra.resolve_texture(form, Role::Reflectance, files, reader));
    let transmittance =
        form.transmittance.as_ref().and_then(|form| spectra.resolve_texture(form, Role::Reflectance, files, reader));
    let (reflectance, transmittance) = (reflectance?, transmittance?);
    // More than one by what decimal shares round to is none.
    let most = most_together(&reflectance, &transmittance, spectra.range_nm?);
    if most > 1.0 + 1e-9 {
        let message = format!("reflectance and transmittance add up to {most:.4}");
        let hint = "together they are at most 1 at every wavelength and every place: lower one of them";
        reader.error_hint(Code::OutOfRange, form.at.head(), message, hint);
        return None;
    }
    Some(MaterialKind::Translucent { reflectance, transmittance })
}

/// The greatest sum of both at a place and a wavelength; a bound of it where they are of different kinds.
fn most_together(reflectance: &SpectrumTexture, transmittance: &SpectrumTexture, range_nm: [f64; 2]) -> f64 {
    match (reflectance, transmittance) {
        (SpectrumTexture::Uniform(a), SpectrumTexture::Uniform(b)) => {
            let kinks = a.kinks_nm(range_nm).into_iter().chain(b.kinks_nm(range_nm));
            whole_nm(range_nm).chain(kinks).map(|nm| a.eval(nm) + b.eval(nm)).fold(0.0, f64::max)
        }
        // Interpolation between texels does not exceed them.
        (SpectrumTexture::Image(a), SpectrumTexture::Image(b)) if lie_alike(a, b) => {
            let texels = a.image.linear_texels().zip(b.image.linear_texels());
            let sum =
                |a: [f64; 3], b: [f64; 3], of: [[f64; 3]; 2]| [0, 1, 2].map(|c| a[c] * of[0][c] + b[c] * of[1][c]);
            texels.flat_map(|(p, q)| sum(p, q, [a.factor, b.factor])).fold(0.0, f64::max)
        }
        _ => greatest(reflectance, range_nm) + greatest(transmittance, range_nm),
    }
}

/// Whether the same places of both images come to lie on each other.
fn lie_alike(a: &ImageTexture, b: &ImageTexture) -> bool {
    let size = |texture: &ImageTexture| (texture.image.width, texture.image.height);
    size(a) == size(b) && a.wrap == b.wrap && a.filter == b.filter && a.uv_map == b.uv_map
}

/// The greatest value at a place and a wavelength.
fn greatest(texture: &SpectrumTexture, range_nm: [f64; 2]) -> f64 {
    let of_image = |image: &ImageTexture| {
        let texels = image.image.linear_texels();
        texels.fold([0.0; 3], |most: [f64; 3], texel| [0, 1, 2].map(|c| most[c].max(texel[c] * image.factor[c])))
    };
    match texture {
        SpectrumTexture::Uniform(spectrum) => {
            let nm = whole_nm(range_nm).chain(spectrum.kinks_nm(range_nm));
            nm.map(|nm| spectrum.eval(nm)).fold(0.0, f64::max)
        }
        SpectrumTexture::Image(image) => of_image(image).into_iter().fold(0.0, f64::max),
        SpectrumTexture::VertexColours { factor, image, .. } => {
            let most = image.as_deref().map_or([1.0; 3], of_image);
            [0, 1, 2].map(|c| factor[c] * most[c]).into_iter().fold(0.0, f64::max)
        }
    }
}
