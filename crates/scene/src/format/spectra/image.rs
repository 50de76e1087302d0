//! Images where spectra may vary over a surface, and patterns that are images of a few texels.

use std::ops::RangeInclusive;

use etalon_optics::Spectrum;

use super::{BRIGHTEST, Role, Spectra, Use};
use crate::files::Files;
use crate::format::spectrum::{
    CheckerSpectrum, GradientSpectrum, ImageSpectrum, SpectrumForm, SpectrumObject, TextureAxis, TextureColour,
};
use crate::json::{Code, Reader, Span};
use crate::model::SpectrumTexture;
use crate::texture::{Image, ImageTexture, Texels, TextureFilter, Wrap};

/// The largest factor on texture coordinates, and the largest shift: of sixteen digits, eight are left.
pub(crate) const FARTHEST_UV: f64 = 1e8;

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
        }
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
        check_uv(form.uv_scale?, form.uv_offset?, form.at, reader)?;
        let factor = form.factor.as_ref()?.map(|f| f.value.0);
        if let Some(negative) = factor.iter().find(|f| **f < 0.0) {
            reader.error(Code::OutOfRange, form.at.head(), format!("a factor of {negative} is below 0"));
            return None;
        }
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
            uv_scale: form.uv_scale?,
            uv_offset: form.uv_offset?,
            factor,
        })
    }

    /// A chequerboard is an image of two by two texels, each shown as it is.
    fn checker(&mut self, form: &CheckerSpectrum, used: Use, reader: &mut Reader<'_>) -> Option<ImageTexture> {
        let (first, second) = (form.first.as_ref(), form.second.as_ref());
        check_uv(form.uv_scale?, form.uv_offset?, form.at, reader)?;
        let [first, second] = [first, second].map(|colour| self.texel(colour?, form.at, used, reader));
        let (first, second) = (first?, second?);
        Some(ImageTexture {
            name: "checker".to_owned(),
            filter: TextureFilter::Nearest,
            uv_scale: form.uv_scale?,
            uv_offset: form.uv_offset?,
            ..ImageTexture::new(Image::new(2, 2, Texels::F32(vec![second, first, first, second])))
        })
    }

    /// An even change is an image of two texels, whose centres lie at 0 and at 1.
    fn gradient(&mut self, form: &GradientSpectrum, used: Use, reader: &mut Reader<'_>) -> Option<ImageTexture> {
        let (from, to) = (form.from.as_ref(), form.to.as_ref());
        let (along, [scale_u, scale_v], [offset_u, offset_v]) = (form.along?, form.uv_scale?, form.uv_offset?);
        check_uv([scale_u, scale_v], [offset_u, offset_v], form.at, reader)?;
        let [from, to] = [from, to].map(|colour| self.texel(colour?, form.at, used, reader));
        let (from, to) = (from?, to?);
        // A texture coordinate t lies at ¼ + ½t of two texels, the whole of one texel shows the same everywhere.
        let of_two = |scale: f64, offset: f64| (0.5 * scale, 0.5 * offset + 0.25);
        let ((width, height, texels), (scale_u, offset_u), (scale_v, offset_v)) = match along {
            TextureAxis::U => ((2, 1, vec![from, to]), of_two(scale_u, offset_u), (scale_v, offset_v)),
            // Rows count from the top.
            TextureAxis::V => ((1, 2, vec![to, from]), (scale_u, offset_u), of_two(scale_v, offset_v)),
        };
        Some(ImageTexture {
            name: "gradient".to_owned(),
            wrap: [Wrap::Clamp; 2],
            uv_scale: [scale_u, scale_v],
            uv_offset: [offset_u, offset_v],
            ..ImageTexture::new(Image::new(width, height, Texels::F32(texels)))
        })
    }

    /// A colour as a texel, if it is possible in its role.
    fn texel(&mut self, colour: &TextureColour, at: Span, used: Use, reader: &mut Reader<'_>) -> Option<[f32; 3]> {
        let rgb = colour.rgb();
        let (range, code, not) = possible(used.role);
        if rgb.iter().all(|channel| range.contains(channel)) {
            return Some(rgb.map(|channel| channel as f32));
        }
        self.complain(code, at.head(), format!("the colour {rgb:?} is {not}"), "", used, reader);
        None
    }
}

/// What texels may be in a role, the code of others, and what these are called.
fn possible(role: Role) -> (RangeInclusive<f64>, Code, String) {
    match role {
        Role::Emission => (0.0..=BRIGHTEST, Code::OutOfRange, format!("not an emission (0 to {BRIGHTEST:e})")),
        _ => (0.0..=1.0, Code::Reflectance, "not a reflectance (0 to 1)".to_owned()),
    }
}

fn check_uv(scale: [f64; 2], offset: [f64; 2], at: Span, reader: &mut Reader<'_>) -> Option<()> {
    for (key, pair) in [("uv_scale", scale), ("uv_offset", offset)] {
        if pair.iter().any(|v| v.abs() > FARTHEST_UV) {
            let message = format!("{key} is beyond {FARTHEST_UV:e}, where rounding errors are larger than the image");
            reader.error(Code::OutOfRange, at.head(), message);
            return None;
        }
    }
    Some(())
}
