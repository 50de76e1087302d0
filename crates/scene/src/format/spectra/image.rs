//! Images where spectra may vary over a surface, and patterns that are images of a few texels.

use std::ops::RangeInclusive;

use etalon_optics::Spectrum;

use super::{BRIGHTEST, Role, Spectra, Use};
use crate::files::Files;
use crate::format::spectrum::{
    CheckerSpectrum, Density, GradientSpectrum, ImageSpectrum, SpectrumForm, SpectrumObject, TextureAxis,
    TextureColour, VertexColoursSpectrum,
};
use crate::format::uv::uv_map;
use crate::json::{Code, Optional, Reader, Span, Spanned};
use crate::model::SpectrumTexture;
use crate::texture::{Image, ImageTexture, Texels, TextureFilter, Wrap};

impl<'f> Spectra<'f> {
    /// The spectrum of a form that may vary over a surface: a reflectance or an emission.
    pub(crate) fn resolve_texture(
        &mut self,
        form: &'f SpectrumForm,
        role: Role,
        files: &mut Files,
        reader: &mut Reader<'_>,
    ) -> Option<SpectrumTexture> {
        let (target, used) = match form {
            SpectrumForm::Name(name) => {
                let target = self.targets[self.names.find(name, reader)?]?;
                (self.entries[target].value.as_deref()?, Use { role, at: Some(name.at) })
            }
            form => (form, Use { role, at: None }),
        };
        match target {
            SpectrumForm::Object(SpectrumObject::Image(image)) => {
                self.image(image, used, files, reader).map(SpectrumTexture::Image)
            }
            SpectrumForm::Object(SpectrumObject::Checker(form)) => {
                self.checker(form, used, reader).map(SpectrumTexture::Image)
            }
            SpectrumForm::Object(SpectrumObject::Gradient(form)) => {
                self.gradient(form, used, reader).map(SpectrumTexture::Image)
            }
            SpectrumForm::Object(SpectrumObject::Noise(form)) => {
                self.noise(form, used, reader).map(SpectrumTexture::Image)
            }
            SpectrumForm::Object(SpectrumObject::VertexColours(form)) if role == Role::Reflectance => {
                self.vertex_colours(form, files, reader)
            }
            _ => self.resolve(form, role, reader).map(SpectrumTexture::Uniform),
        }
    }

    /// The emission of a form: a spectrum, and if that is the white of an image, the image.
    pub(crate) fn resolve_emission(
        &mut self,
        form: &'f SpectrumForm,
        files: &mut Files,
        reader: &mut Reader<'_>,
    ) -> Option<(Spectrum, Option<ImageTexture>)> {
        match self.resolve_texture(form, Role::Emission, files, reader)? {
            SpectrumTexture::Uniform(spectrum) => Some((spectrum, None)),
            SpectrumTexture::Image(image) => Some((self.daylight(1.0, form.at(), reader)?, Some(image))),
            // Refused where it is resolved.
            SpectrumTexture::VertexColours { .. } => None,
        }
    }

    fn vertex_colours(
        &mut self,
        form: &'f VertexColoursSpectrum,
        files: &mut Files,
        reader: &mut Reader<'_>,
    ) -> Option<SpectrumTexture> {
        let factor = factors(form.factor.as_ref()?, form.at, reader);
        let image = match &form.image {
            Optional::Absent => None,
            Optional::Invalid => return None,
            Optional::Given(inner) => {
                let SpectrumTexture::Image(image) = self.resolve_texture(inner, Role::Reflectance, files, reader)?
                else {
                    let message = "only an image or a pattern can multiply the colours of vertices";
                    reader.error_hint(
                        Code::KeyConflict,
                        inner.at().head(),
                        message,
                        "for one colour there is \"factor\"",
                    );
                    return None;
                };
                Some(Box::new(image))
            }
        };
        Some(SpectrumTexture::VertexColours { factor: factor?, grey: false, image })
    }

    fn image(
        &mut self,
        form: &ImageSpectrum,
        used: Use,
        files: &mut Files,
        reader: &mut Reader<'_>,
    ) -> Option<ImageTexture> {
        let file = form.file.as_ref()?;
        let image = files.image(file, form.encoding?, reader);
        let uv_map = uv_map(form.uv_scale, &form.uv_matrix, form.uv_offset, form.at, reader)?;
        let factor = factors(form.factor.as_ref()?, form.at, reader)?;
        let image = image?;
        let (range, code, not) = possible(used.role);
        let impossible = |texel: [f64; 3]| (0..3).any(|c| !range.contains(&(texel[c] * factor[c])));
        if let Some(i) = image.linear_texels().position(impossible) {
            let (column, row) = (i % image.width as usize, i / image.width as usize);
            let texel = image.texel(column, row);
            let message = format!(
                "{}: the texel in column {column}, row {row} is {texel:?}: with the factors {factor:?} it is {not}",
                file.value
            );
            self.complain(code, file.at, message, "", used, reader);
            return None;
        }
        let wrap = form.wrap?;
        let wrap_v = form.wrap_v.clone().checked()?.unwrap_or(wrap);
        Some(ImageTexture {
            image,
            name: file.value.clone(),
            wrap: [wrap, wrap_v],
            filter: form.filter?,
            uv_map,
            factor,
        })
    }

    /// A chequerboard is an image of two by two texels, each shown as it is.
    fn checker(&mut self, form: &CheckerSpectrum, used: Use, reader: &mut Reader<'_>) -> Option<ImageTexture> {
        let (first, second) = (form.first.as_ref(), form.second.as_ref());
        let uv_map = uv_map(form.uv_scale, &form.uv_matrix, form.uv_offset, form.at, reader)?;
        let [first, second] = [first, second].map(|colour| self.texel(colour?, form.at, used, reader));
        let (first, second) = (first?, second?);
        Some(ImageTexture {
            name: "checker".to_owned(),
            filter: TextureFilter::Nearest,
            uv_map,
            ..ImageTexture::new(Image::new(2, 2, Texels::F32(vec![second, first, first, second])))
        })
    }

    /// An even change is an image of two texels, whose centres lie at 0 and at 1.
    fn gradient(&mut self, form: &GradientSpectrum, used: Use, reader: &mut Reader<'_>) -> Option<ImageTexture> {
        let (from, to) = (form.from.as_ref(), form.to.as_ref());
        let (along, mut uv_map) =
            (form.along?, uv_map(form.uv_scale, &form.uv_matrix, form.uv_offset, form.at, reader)?);
        let [from, to] = [from, to].map(|colour| self.texel(colour?, form.at, used, reader));
        let (from, to) = (from?, to?);
        // A texture coordinate t lies at ¼ + ½t of two texels, the whole of one texel shows the same everywhere.
        let (width, height, k, texels) = match along {
            TextureAxis::U => (2, 1, 0, vec![from, to]),
            // Rows count from the top.
            TextureAxis::V => (1, 2, 1, vec![to, from]),
        };
        uv_map.matrix[k] = uv_map.matrix[k].map(|factor| 0.5 * factor);
        uv_map.offset[k] = 0.5 * uv_map.offset[k] + 0.25;
        Some(ImageTexture {
            name: "gradient".to_owned(),
            wrap: [Wrap::Clamp; 2],
            uv_map,
            ..ImageTexture::new(Image::new(width, height, Texels::F32(texels)))
        })
    }

    /// A colour as a texel, if it is possible in its role.
    pub(super) fn texel(
        &mut self,
        colour: &TextureColour,
        at: Span,
        used: Use,
        reader: &mut Reader<'_>,
    ) -> Option<[f32; 3]> {
        let rgb = colour.rgb();
        let (range, code, not) = possible(used.role);
        if rgb.iter().all(|channel| range.contains(channel)) {
            return Some(rgb.map(|channel| channel as f32));
        }
        self.complain(code, at.head(), format!("the colour {rgb:?} is {not}"), "", used, reader);
        None
    }
}

/// Factors on the channels of colours.
fn factors(stated: &[Spanned<Density>; 3], at: Span, reader: &mut Reader<'_>) -> Option<[f64; 3]> {
    let factor = [0, 1, 2].map(|c| stated[c].value.0);
    if let Some(negative) = factor.iter().find(|f| **f < 0.0) {
        reader.error(Code::OutOfRange, at.head(), format!("a factor of {negative} is below 0"));
        return None;
    }
    Some(factor)
}

/// What texels may be in a role, the code of others, and what these are called.
fn possible(role: Role) -> (RangeInclusive<f64>, Code, String) {
    match role {
        Role::Emission => (0.0..=BRIGHTEST, Code::OutOfRange, format!("not an emission (0 to {BRIGHTEST:e})")),
        _ => (0.0..=1.0, Code::Reflectance, "not a reflectance (0 to 1)".to_owned()),
    }
}
