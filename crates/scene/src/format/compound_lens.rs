//! Cameras with a lens of many surfaces.

use std::ops::Bound;
use std::sync::Arc;

use etalon_optics::reference_nm;

use super::material::{IndexForm, index, least};
use super::motion::{KeyframeForm, Stretch, given, shutter_s};
use super::view::{moving, orientation};
use crate::files::Files;
use crate::json::{
    Code, Direction, List, Optional, Positive, Reader, Required, Rule, SceneErrors, Severity, Span, Spanned, read,
};
use crate::model::{Camera, CompoundLens, LensCoating, LensSurface, Projection};

/// Most surfaces of a lens: twice as many as a zoom lens has.
const MOST_SURFACES: usize = 64;
/// Most aspheric coefficients of a surface: up to the 20th power, as lens makers publish them.
const MOST_COEFFICIENTS: usize = 9;
/// Metres in a millimetre.
const MM: f64 = 1e-3;

crate::number! {
    /// A length of at most a kilometre, mm; above 0.
    pub(crate) struct LensLength in (Bound::Excluded(0.0), Bound::Included(1e6));
}

crate::number! {
    /// A thickness of at most a kilometre, mm.
    pub(crate) struct LensThickness in (Bound::Included(0.0), Bound::Included(1e6));
}

crate::record! {
    /// A lens of surfaces, each traced exactly, before a film. The picture is the irradiance on the film, over that of an unvignetted,
    /// lossless point on the axis: a field of radiance 1 shows 1 there.
    pub(crate) struct CompoundLensCamera + comment {
        /// Position of the vertex of the first surface, m.
        position_m: Required<[f64; 3]>,
        /// A point in the middle of the picture, m. Either this or `direction`.
        look_at_m: Optional<Spanned<[f64; 3]>>,
        /// The viewing direction; only the direction counts. Either this or `look_at_m`.
        direction: Optional<Spanned<Direction>>,
        /// Which way is up in the picture; only the direction counts, and only its part across the view.
        up: Required<Spanned<Direction>> = "[0, 1, 0]",
        /// Whether left and right are exchanged in the picture, as in a mirror.
        mirrored: Required<bool> = "false",
        /// The lens. Either this or `lens_file`.
        lens: Optional<CompoundLensForm>,
        /// A JSON file with the lens, relative to the folder of the scene.
        lens_file: Optional<Spanned<String>>,
        /// Height of the film, m.
        sensor_height_m: Required<Positive>,
        /// Distance from the first vertex to the plane in focus, m: the film moves to its paraxial image. Either this or `film_distance_m`.
        focus_distance_m: Optional<Spanned<Positive>>,
        /// Distance from the last vertex to the film, m.
        film_distance_m: Optional<Spanned<Positive>>,
        /// When the shutter opens and when it closes, s.
        shutter_s: Required<Spanned<[f64; 2]>> = "[0, 0]",
        /// How the camera moves: its placement at some times.
        keyframes: Optional<Spanned<List<Box<KeyframeForm>>>>,
    } with [
        Rule::OneOf(&["look_at_m", "direction"]),
        Rule::OneOf(&["lens", "lens_file"]),
        Rule::OneOf(&["focus_distance_m", "film_distance_m"]),
    ]
}

crate::record! {
    /// A lens, as its designer writes it down: surface by surface from the scene to the film, in millimetres.
    pub(crate) struct CompoundLensForm + comment {
        /// The surfaces, at most 64. Behind the last is air.
        surfaces: Required<Spanned<List<LensSurfaceForm>>>,
        /// What coats the glass.
        coating: Required<LensCoating> = r#""none""#,
    }
}

crate::record! {
    /// A surface of a lens, or a stop between two of them. Its sag is c ρ²/(1 + √(1 − (1 + conic) c² ρ²)) + Σ A ρ^4, ρ^6 …, with
    /// c = 1/radius_mm, at the distance ρ from the axis.
    pub(crate) struct LensSurfaceForm + comment {
        /// Radius of curvature at the vertex, mm: positive where the centre is on the side of the film. Left out, the surface is flat.
        radius_mm: Optional<Spanned<f64>>,
        /// Conic constant: 0 is a sphere, −1 a paraboloid.
        conic: Required<f64> = "0",
        /// The coefficients A4, A6, A8 … of the sag, mm⁻³, mm⁻⁵, mm⁻⁷ …; at most 9.
        aspheric: Optional<Spanned<List<f64>>>,
        /// From its vertex to that of the next surface, mm; not for the last.
        thickness_mm: Optional<Spanned<LensThickness>>,
        /// What is behind it: a glass, or air.
        medium: Required<IndexForm> = "1",
        /// Radius of the aperture, mm: light farther from the axis is blocked.
        semi_aperture_mm: Required<Spanned<LensLength>>,
        /// Whether this is the stop; one surface must be.
        stop: Required<bool> = "false",
    }
}

crate::keywords!(LensCoating {
    /// Nothing: each interface reflects by Fresnel's equations.
    "none" => Self::Bare,
    /// A coating that lets all light pass.
    "ideal" => Self::Ideal,
});

/// The camera of a form.
pub(super) fn compound_lens_camera(
    form: &CompoundLensCamera,
    range_nm: Option<[f64; 2]>,
    files: &mut Files<'_>,
    reader: &mut Reader<'_>,
) -> Option<Camera> {
    let view = orientation(form.position_m, &form.look_at_m, &form.direction, form.up, reader);
    let shutter_s = shutter_s(form.shutter_s.as_ref(), reader);
    let placed = given(&form.keyframes, shutter_s.unwrap_or_default(), Stretch::Refused, reader);
    let parts = match (&form.lens, &form.lens_file) {
        (Optional::Given(lens), _) => parts(lens, range_nm, reader),
        (_, Optional::Given(name)) => lens_of_file(name, range_nm, files, reader),
        _ => None,
    };
    let (surfaces, coating) = parts?;
    let (film_height_m, reference_nm) = (form.sensor_height_m?.0, reference_nm(range_nm?));
    let lens = CompoundLens { surfaces, coating, film_distance_m: 0.0, film_height_m, reference_nm };
    let film_distance_m = match (form.focus_distance_m.given(), form.film_distance_m.given()) {
        (Some(focus), _) => {
            let image_m = lens.image_distance_m(focus.value.0, reference_nm);
            if image_m.is_none() {
                let message = format!("the lens forms no image of a point at {} m on a film", focus.value.0);
                let hint = "focus farther away, or give \"film_distance_m\"";
                reader.error_hint(Code::OutOfRange, focus.at, message, hint);
            }
            image_m?
        }
        (None, Some(film)) => film.value.0,
        (None, None) => return None,
    };
    // What lies behind the vertex of the last surface must not reach the film.
    let last = lens.surfaces.last()?;
    let rim_m = last.sag_m(last.semi_aperture_m * last.semi_aperture_m);
    if rim_m.max(0.0) >= film_distance_m {
        let message = format!("the film, {film_distance_m} m behind the lens, touches its last surface");
        reader.error(Code::OutOfRange, form.at.head(), message);
        return None;
    }
    let (forward, up) = view?;
    let projection = Projection::CompoundLens(Arc::new(CompoundLens { film_distance_m, ..lens }));
    let position_m = form.position_m?;
    let still = Camera {
        position_m,
        forward,
        up,
        world_up: form.up?.value.0,
        mirrored: form.mirrored?,
        projection,
        near_m: 0.0,
        shutter_s: shutter_s?,
        motion: None,
    };
    Some(moving(still, placed?))
}

/// The lens of a file. What is wrong with it is reported at its name.
fn lens_of_file(
    name: &Spanned<String>,
    range_nm: Option<[f64; 2]>,
    files: &mut Files<'_>,
    reader: &mut Reader<'_>,
) -> Option<(Vec<LensSurface>, LensCoating)> {
    let bytes = files.bytes(name, reader)?;
    let Ok(text) = std::str::from_utf8(&bytes) else {
        reader.error(Code::NotUtf8, name.at, format!("{} is not UTF-8", name.value));
        return None;
    };
    match read(text, &name.value, |form: CompoundLensForm, reader| parts(&form, range_nm, reader)) {
        Ok((lens, _)) => Some(lens),
        Err(SceneErrors { problems, .. }) => {
            for problem in problems.into_iter().filter(|problem| problem.severity == Severity::Error) {
                let (line, column) = (problem.line, problem.column);
                let message = format!("{}:{line}:{column}: {}: {}", name.value, problem.json_path, problem.message);
                reader.error_hint(problem.code, name.at, message, problem.hint.unwrap_or_default());
            }
            None
        }
    }
}

/// The surfaces and the coating of a form.
fn parts(
    form: &CompoundLensForm,
    range_nm: Option<[f64; 2]>,
    reader: &mut Reader<'_>,
) -> Option<(Vec<LensSurface>, LensCoating)> {
    let before = reader.error_count();
    let list = form.surfaces.as_ref()?;
    let forms = &list.value.0;
    if forms.is_empty() || forms.len() > MOST_SURFACES {
        let message = format!("a lens of {} surfaces; there must be from 1 to {MOST_SURFACES}", forms.len());
        reader.error(Code::WrongLength, list.at.head(), message);
        return None;
    }
    let count = forms.len();
    let made = forms.iter().enumerate().map(|(i, form)| surface(form.as_ref()?, i + 1 == count, range_nm, reader));
    let surfaces: Vec<Option<LensSurface>> = made.collect();
    let stops: Vec<Span> = forms.iter().flatten().filter(|form| form.stop == Some(true)).map(|form| form.at).collect();
    match stops[..] {
        [_] => {}
        [] => reader.error_hint(
            Code::MissingKey,
            list.at.head(),
            "the lens has no stop",
            "add \"stop\": true to a surface",
        ),
        [first, second, ..] => {
            let label = (first.head(), "the first one");
            reader.error_related(Code::KeyConflict, second.head(), "the lens has two stops", "keep one of them", label);
        }
    }
    let surfaces: Vec<LensSurface> = surfaces.into_iter().collect::<Option<_>>()?;
    for (pair, forms) in surfaces.windows(2).zip(forms.windows(2)) {
        let rim_m = pair[0].semi_aperture_m.min(pair[1].semi_aperture_m);
        let gap_m = pair[0].thickness_m + pair[1].sag_m(rim_m * rim_m) - pair[0].sag_m(rim_m * rim_m);
        // Cemented glasses touch, up to rounding.
        if gap_m < -1e-9 {
            let at = forms[1].as_ref()?.at.head();
            let message = format!(
                "this surface meets the one before it within their apertures: at their rim by {:.4} mm",
                -gap_m / MM
            );
            reader.error_hint(Code::OutOfRange, at, message, "is a sign of \"radius_mm\" wrong?");
        }
    }
    (reader.error_count() == before).then_some((surfaces, form.coating?))
}

fn surface(
    form: &LensSurfaceForm,
    is_last: bool,
    range_nm: Option<[f64; 2]>,
    reader: &mut Reader<'_>,
) -> Option<LensSurface> {
    let before = reader.error_count();
    let medium = form.medium.as_ref().and_then(|form| index(form, range_nm, reader));
    let radius = form.radius_mm.clone().checked()?;
    // A nanometre.
    if let Some(radius) = &radius
        && radius.value.abs() < 1e-6
    {
        let hint = "leave the key out for a flat surface";
        reader.error_hint(Code::OutOfRange, radius.at, "a radius of curvature must not be 0", hint);
        return None;
    }
    let thickness_m = match (&form.thickness_mm, is_last) {
        (Optional::Given(thickness), false) => thickness.value.0 * MM,
        (Optional::Given(thickness), true) => {
            let message = "the last surface has no thickness";
            let hint = "the film stands by the camera's \"film_distance_m\" or \"focus_distance_m\"";
            reader.error_hint(Code::KeyConflict, thickness.at, message, hint);
            return None;
        }
        (Optional::Absent, false) => {
            let message = "missing key \"thickness_mm\"";
            reader.error_hint(Code::MissingKey, form.at.head(), message, "how far is it to the next surface?");
            return None;
        }
        (Optional::Absent, true) => 0.0,
        (Optional::Invalid, _) => return None,
    };
    let aspheric = match form.aspheric.clone().checked()? {
        None => Vec::new(),
        Some(list) if list.value.0.len() > MOST_COEFFICIENTS => {
            let message = format!("{} coefficients; at most {MOST_COEFFICIENTS} are possible", list.value.0.len());
            reader.error(Code::WrongLength, list.at, message);
            return None;
        }
        Some(list) => {
            // A4 is in mm⁻³, each further one has two powers more.
            let of_power = |(k, a): (usize, Option<f64>)| Some(a? * (0..2 * k + 3).fold(1.0, |power, _| power / MM));
            list.value.0.into_iter().enumerate().map(of_power).collect::<Option<_>>()?
        }
    };
    let aperture = form.semi_aperture_mm.as_ref()?;
    let surface = LensSurface {
        curvature_per_m: radius.map_or(0.0, |radius| 1.0 / (radius.value * MM)),
        conic: form.conic?,
        aspheric,
        thickness_m,
        medium: medium?,
        semi_aperture_m: aperture.value.0 * MM,
        is_stop: form.stop?,
    };
    if is_last && surface.medium != etalon_optics::RefractiveIndex::VACUUM {
        let hint = "leave its \"medium\" out";
        reader.error_hint(Code::OutOfRange, form.at.head(), "there must be air behind the last surface", hint);
    }
    if let Some(range_nm) = range_nm
        && least(&surface.medium, range_nm) < 1.0
    {
        reader.error(Code::OutOfRange, form.at.head(), "the index of a medium of a lens must be at least 1");
    }
    let rim_m2 = surface.semi_aperture_m * surface.semi_aperture_m;
    // Also where they are not numbers: a sphere ends at its radius.
    if !(surface.sag_m(rim_m2).is_finite() && surface.sag_slope_per_m(rim_m2).is_finite()) {
        let message = "the aperture is wider than the surface, which ends before";
        reader.error_hint(Code::OutOfRange, aperture.at, message, "state a smaller \"semi_aperture_mm\"");
    }
    (reader.error_count() == before).then_some(surface)
}
