//! Bodies of any material, and what fills them.

use super::super::medium::medium;
use super::super::scene::MaterialUse;
use super::super::spectra::Spectra;
use super::{Before, FilledMaterial, Made};
use crate::files::Files;
use crate::json::{Code, Reader};

/// The material of the form of a filled body.
pub(super) fn filled<'f>(
    form: &'f FilledMaterial,
    before: &Before<'_>,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Made> {
    let of = form.material.as_deref().and_then(|of: &MaterialUse| before.material(of, spectra, files, reader));
    let medium = form.medium.as_ref().and_then(|form| medium(form, spectra, files, reader));
    let (of, medium) = (of?, medium?);
    let (message, hint) = match of.kind.solid() {
        _ if of.medium.is_some() => ("what is filled already holds an absorption or a medium", "leave one of them out"),
        Some(_) => ("what is filled cannot have a \"priority\"", "give the dielectric itself a \"medium\""),
        None => return Some(Made { medium: Some(Box::new(medium)), ..of }),
    };
    reader.error_hint(Code::KeyConflict, form.at.head(), message, hint);
    None
}
