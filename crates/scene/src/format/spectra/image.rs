//! Images where spectra may vary over a surface.

use etalon_optics::Spectrum;

use super::{BRIGHTEST, Role, Spectra, Use};
use crate::files::Files;
use crate::format::spectrum::{ImageSpectrum, SpectrumForm, SpectrumObject};
use crate::json::{Code, Reader};
use crate::model::SpectrumTexture;
use crate::texture::ImageTexture;

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
        for (key, pair) in [("uv_scale", form.uv_scale?), ("uv_offset", form.uv_offset?)] {
            if pair.iter().any(|v| v.abs() > FARTHEST_UV) {
                let message =
                    format!("{key} is beyond {FARTHEST_UV:e}, where rounding errors are larger than the image");
                reader.error(Code::OutOfRange, form.at.head(), message);
                return None;
            }
        }
        let factor = form.factor.as_ref()?.map(|f| f.value.0);
        if let Some(negative) = factor.iter().find(|f| **f < 0.0) {
            reader.error(Code::OutOfRange, form.at.head(), format!("a factor of {negative} is below 0"));
            return None;
        }
        let image = image?;
        let (range, code, not) = match used.role {
            Role::Emission => (0.0..=BRIGHTEST, Code::OutOfRange, format!("not an emission (0 to {BRIGHTEST:e})")),
            _ => (0.0..=1.0, Code::Reflectance, "not a reflectance (0 to 1)".to_owned()),
        };
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
}
