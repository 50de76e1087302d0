//! Slides before lamps.

use glam::DVec3;

use super::camera::FieldOfView;
use super::light::across;
use super::spectra::{BRIGHTEST, Role, Spectra};
use super::spectrum::SpectrumForm;
use crate::files::Files;
use crate::json::{Code, Direction, Optional, Positive, Reader, Required, Spanned};
use crate::model::{EvenOn, LightKind, SlideLight, SpectrumTexture};

crate::record! {
    /// An image before a lamp at a point, which sends nothing beside it: a projector, or a spot with a gobo.
    pub(crate) struct SlideForm + comment {
        /// An image or a pattern; where it is (1, 1, 1) it changes nothing.
        image: Required<Box<SpectrumForm>>,
        /// From the lamp through the middle of the image; only the direction counts.
        direction: Required<Spanned<Direction>>,
        /// Toward the upper edge of the image; only its part across `direction` counts.
        up: Required<Spanned<Direction>> = "[0, 1, 0]",
        /// Full angle between its left and its right edge, degrees.
        horizontal_fov_deg: Required<FieldOfView>,
        /// Width over height on a screen across `direction`; that of the texels if left out.
        aspect: Optional<Positive>,
        /// What a white image lights evenly, if the lamp has the same intensity in every direction.
        even_on: Required<EvenOn> = r#""screen""#,
    }
}

crate::keywords!(EvenOn {
    /// A flat screen across the direction: intensities are divided by the cube of the cosine of the angle to it.
    "screen" => Self::Screen,
    /// A sphere around the lamp.
    "sphere" => Self::Sphere,
});

/// The lamp, with the slide of the form before it if there is one.
pub(super) fn behind_slide<'f>(
    lamp: LightKind,
    slide: &'f Optional<SlideForm>,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<LightKind> {
    let form = match slide {
        Optional::Absent => return Some(lamp),
        Optional::Invalid => return None,
        Optional::Given(form) => form,
    };
    let axes = form.direction.zip(form.up).and_then(|(direction, up)| {
        let direction = DVec3::from(direction.value.0);
        let up = across(direction, "direction", "up", up, reader)?;
        Some([direction, direction.cross(up), up].map(|axis| axis.to_array()))
    });
    let written = form.image.as_ref()?;
    let image = match spectra.resolve_texture(written, Role::Emission, files, reader)? {
        SpectrumTexture::Image(image) => image,
        SpectrumTexture::Uniform(_) | SpectrumTexture::VertexColours { .. } => {
            let message = "a slide is an image, a checker, a gradient or noise";
            reader.error(Code::KeyConflict, written.at().head(), message.to_owned());
            return None;
        }
    };
    let across_right = (0.5 * form.horizontal_fov_deg?.0.to_radians()).tan();
    let of_texels = f64::from(image.image.width) / f64::from(image.image.height);
    let aspect = form.aspect.clone().checked()?.map_or(of_texels, |aspect| aspect.0);
    let [direction, right, up] = axes?;
    let slide = SlideLight {
        lamp,
        direction,
        right,
        up,
        tangents: [across_right, across_right / aspect],
        image,
        even_on: form.even_on?,
    };
    let of_lamp = match &slide.lamp {
        LightKind::Luminaire { photometry, .. } => photometry.most_cd(),
        _ => 1.0,
    };
    let brightest = slide.lamp.spectrum().max_over(spectra.range_nm?) * of_lamp * slide.most();
    if brightest > BRIGHTEST || brightest.is_nan() {
        let message = format!("with this slide, an intensity of {brightest:e} is more than {BRIGHTEST:e}");
        reader.error(Code::OutOfRange, form.at.head(), message);
        return None;
    }
    Some(LightKind::Slide(Box::new(slide)))
}
