//! Tints: shares that are left of what smooth and rough surfaces reflect and pass.

use super::super::spectra::{Role, Spectra};
use super::super::spectrum::SpectrumForm;
use crate::files::Files;
use crate::json::{Optional, Reader};
use crate::model::{MaterialKind, SpectrumTexture};
use etalon_optics::Spectrum;

/// A material with what is left of its light; what no key says is left whole.
pub(super) fn tinted<'f>(
    kind: MaterialKind,
    [reflected, transmitted]: [&'f Optional<SpectrumForm>; 2],
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    if !reflected.is_present() && !transmitted.is_present() {
        return Some(kind);
    }
    let reflected = tint(reflected, spectra, files, reader);
    let transmitted = tint(transmitted, spectra, files, reader);
    Some(MaterialKind::Tinted { kind: Box::new(kind), reflected: reflected?, transmitted: transmitted? })
}

/// The share that is left by a key; all if it is absent.
pub(super) fn tint<'f>(
    form: &'f Optional<SpectrumForm>,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<SpectrumTexture> {
    match form {
        Optional::Absent => Some(SpectrumTexture::Uniform(Spectrum::Constant(1.0))),
        Optional::Invalid => None,
        Optional::Given(form) => spectra.resolve_texture(form, Role::Reflectance, files, reader),
    }
}
