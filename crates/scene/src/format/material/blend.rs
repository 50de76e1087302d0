//! Materials side by side.

use super::super::detail::number_image;
use super::super::names::Names;
use super::super::scene::MaterialUse;
use super::super::spectra::Spectra;
use super::roughness::MOST_WIDTHS;
use super::{BlendMaterial, Made, material};
use crate::files::Files;
use crate::json::{Code, Optional, Reader, Spanned};
use crate::model::{MaterialKind, NumberTexture};

/// The most materials that a blend may hold, those of blends within it counted. Names can double their number with each line of a
/// file, and an image of roughness makes up to 97.
pub const MOST_BLEND_PARTS: usize = 8 * MOST_WIDTHS;

/// Named materials that a blend or a filled body may be made of: those that stand before it, so that none is made of itself.
#[derive(Debug)]
pub(crate) struct Before<'m> {
    /// All of the file's names.
    pub(crate) names: &'m Names<'m>,
    /// The materials read so far, by their place in the file; `None` is wrong, which has been reported.
    pub(crate) made: &'m [Option<Made>],
}

impl Before<'_> {
    /// A material that another is made of: a named one, or one of its own.
    pub(super) fn material<'f>(
        &self,
        of: &'f MaterialUse,
        spectra: &mut Spectra<'f>,
        files: &mut Files,
        reader: &mut Reader<'_>,
    ) -> Option<Made> {
        match of {
            MaterialUse::Own(own) => material(own, self, spectra, files, reader),
            MaterialUse::Named(name) => self.find(name, reader),
        }
    }

    fn find(&self, name: &Spanned<String>, reader: &mut Reader<'_>) -> Option<Made> {
        let place = self.names.find(name, reader)?;
        match self.made.get(place) {
            Some(made) => made.clone(),
            None => {
                let message = format!("it is made of the material \"{}\", which is defined after it", name.value);
                reader.error_hint(Code::Circular, name.at, message, "move it up");
                None
            }
        }
    }
}

/// The material of the form of a blend.
pub(super) fn blend<'f>(
    blend: &'f BlendMaterial,
    before: &Before<'_>,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    let mut part = |part: &'f Option<Box<MaterialUse>>| before.material(part.as_deref()?, spectra, files, reader);
    let (first, second) = (part(&blend.first), part(&blend.second));
    let by = match (&blend.weight, &blend.weight_image) {
        (Optional::Given(weight), _) => Some(NumberTexture::Uniform(weight.0)),
        (_, Optional::Given(image)) => number_image(image, files, reader).map(NumberTexture::Image),
        _ => None,
    };
    let (first, second, by) = (first?, second?, by?);
    if [&first, &second].iter().any(|part| part.exterior_medium.is_some()) {
        let message = "what is inside a blend cannot have an \"exterior_medium\"";
        reader.error_hint(Code::KeyConflict, blend.at.head(), message, "leave it out");
        return None;
    }
    if first.medium.is_some() || second.medium.is_some() {
        let message = "what is inside a blend cannot have an absorption or a medium";
        reader.error_hint(Code::KeyConflict, blend.at.head(), message, "put the blend into a \"filled\" material");
        return None;
    }
    let (first, second) = (first.kind, second.kind);
    if [&first, &second].iter().any(|part| part.solid().is_some()) {
        let message = "a dielectric inside a blend cannot have a \"priority\"";
        reader.error_hint(Code::KeyConflict, blend.at.head(), message, "give its \"exterior\" instead");
        return None;
    }
    if [&first, &second].iter().any(|part| matches!(part, MaterialKind::PolarisingSheet { .. })) {
        let message = "a blend cannot contain a polariser or a retarder";
        let hint = "put the sheet on an object of its own, with an \"opacity\" if needed";
        reader.error_hint(Code::KeyConflict, blend.at.head(), message, hint);
        return None;
    }
    let kind = MaterialKind::blend(first, second, by);
    let count = kind.parts().len();
    if count > MOST_BLEND_PARTS {
        let message = format!("the blend has {count} materials, counting those of blends inside it");
        reader.error_hint(Code::OutOfRange, blend.at.head(), message, format!("at most {MOST_BLEND_PARTS}"));
        return None;
    }
    Some(kind)
}
