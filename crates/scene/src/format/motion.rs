//! Keyframes of instances and of the camera.

use super::geometry::{Step, transform};
use crate::json::{Code, List, Optional, Reader, Required, Spanned};
use crate::linear::is_similarity;
use crate::model::{Keyframe, Motion, Transform, middle_s};

crate::record! {
    /// Where something is at one time.
    pub(crate) struct KeyframeForm + comment {
        /// The time, s.
        time_s: Required<f64>,
        /// Its transform then: steps, the first of which is applied first.
        transform: Required<Spanned<List<Box<Step>>>> = "[]",
    }
}

/// When the shutter opens and closes, s.
pub(crate) fn shutter_s(form: Option<&Spanned<[f64; 2]>>, reader: &mut Reader<'_>) -> Option<[f64; 2]> {
    let shutter = form?;
    let [open, close] = shutter.value;
    if close < open {
        let message = format!("the shutter closes at {close} s, before it opens at {open} s");
        reader.error(Code::OutOfRange, shutter.at, message);
        return None;
    }
    // Also where each alone is finite.
    if !(close - open).is_finite() {
        reader.error(Code::OutOfRange, shutter.at, "the shutter time is too long for double precision");
        return None;
    }
    Some(shutter.value)
}

/// Whether what moves may be stretched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stretch {
    Allowed,
    Refused,
}

/// A placement in the middle of the shutter's time, and where it is at all times if there are keyframes.
pub(crate) type Placed = (Transform, Option<Motion>);

/// The motion of some keyframes.
pub(crate) fn motion(
    forms: &Spanned<List<Box<KeyframeForm>>>,
    shutter_s: [f64; 2],
    stretch: Stretch,
    reader: &mut Reader<'_>,
) -> Option<Placed> {
    if forms.value.0.is_empty() {
        let hint = "give one keyframe for a fixed place, or two or more for a motion";
        reader.error_hint(Code::WrongLength, forms.at.head(), "there are no keyframes", hint);
        return None;
    }
    // All of them are read before the first that is wrong ends it.
    let made: Vec<Option<Keyframe>> =
        forms.value.0.iter().map(|form| keyframe(form.as_deref()?, stretch, reader)).collect();
    let keyframes: Vec<Keyframe> = made.into_iter().collect::<Option<_>>()?;
    let before = reader.error_count();
    for (pair, form) in keyframes.windows(2).zip(&forms.value.0[1..]) {
        let Some(at) = form.as_ref().map(|form| form.at.head()) else { continue };
        let (a, b) = (&pair[0], &pair[1]);
        if a.time_s >= b.time_s {
            let message = format!("the keyframe at {} s does not come after the one at {} s", b.time_s, a.time_s);
            reader.error_hint(Code::OutOfRange, at, message, "times must increase");
        } else if !((b.time_s - a.time_s).is_finite() && (b.time_s - a.time_s).recip().is_finite()) {
            reader.error(Code::OutOfRange, at, "the time since the previous keyframe is too long for double precision");
        } else if a.mirrors() != b.mirrors() {
            let message =
                "of this keyframe and the previous one only one mirrors, so the object would become flat in between";
            reader.error(Code::Motion, at, message);
        } else if a.is_half_turn_from(b) {
            let message =
                "the keyframe is half a turn from the previous one, so the direction of the rotation is unknown";
            reader.error_hint(Code::Motion, at, message, "add a keyframe between the two");
        }
    }
    if reader.error_count() != before {
        return None;
    }
    let motion = Motion { keyframes };
    Some((motion.at(middle_s(shutter_s)), Some(motion)))
}

fn keyframe(form: &KeyframeForm, stretch: Stretch, reader: &mut Reader<'_>) -> Option<Keyframe> {
    let steps = form.transform.as_ref()?;
    let transform = transform(&steps.value, steps.at.head(), reader)?;
    let linear = transform.affine().matrix3;
    if stretch == Stretch::Refused && !(is_similarity(&linear) && (linear.row(0).length_squared() - 1.0).abs() <= RIGID)
    {
        let message = "a camera can only be moved and turned";
        reader.error_hint(Code::NotSimilarity, steps.at.head(), message, "change its angle of view to zoom");
        return None;
    }
    let mut keyframe = Keyframe::new(form.time_s?, transform);
    if stretch == Stretch::Refused {
        if keyframe.mirrors() {
            reader.error(Code::NotSimilarity, steps.at.head(), "a camera cannot be mirrored");
            return None;
        }
        keyframe.stretch = Transform::IDENTITY.linear;
        keyframe.transform.linear = keyframe.rotation;
    }
    Some(keyframe)
}

/// How far the square of a camera's scale may be from 1: matrices in files are often written with seven digits.
const RIGID: f64 = 1e-6;

/// The keyframes of a form, if it has some; `Err` where they are wrong.
pub(crate) fn given(
    forms: &Optional<Spanned<List<Box<KeyframeForm>>>>,
    shutter_s: [f64; 2],
    stretch: Stretch,
    reader: &mut Reader<'_>,
) -> Option<Option<Placed>> {
    match forms {
        Optional::Absent => Some(None),
        Optional::Invalid => None,
        Optional::Given(forms) => motion(forms, shutter_s, stretch, reader).map(Some),
    }
}
