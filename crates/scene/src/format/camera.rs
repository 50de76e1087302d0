//! Cameras and film.

use super::compound_lens::{CompoundLensCamera, compound_lens_camera};
use super::material::Share;
use super::motion::{KeyframeForm, Stretch, given, shutter_s};
use super::spectrum::Wavelength;
use super::view::{moving, orientation};
use crate::files::Files;
use crate::json::{Code, Direction, List, NonNegative, Optional, Positive, Reader, Required, Rule, Spanned, Whole};
use crate::model::{Bands, Camera, Film, Filter, Projection, ThinLens};

crate::number! {
    /// A full angle of view, degrees.
    pub(crate) struct FieldOfView in super::geometry::HALF_TURN;
}

crate::record! {
    /// Central projection through a pinhole or a thin lens. Pixels are square. The angle of view is given by exactly one of
    /// `vertical_fov_deg`, `horizontal_fov_deg`, or `focal_length_m` with `sensor_height_m` or `sensor_width_m`.
    pub(crate) struct PerspectiveCamera + comment {
        /// Position of the eye (the centre of the lens), m.
        position_m: Required<[f64; 3]>,
        /// A point in the middle of the picture, m. Either this or `direction`.
        look_at_m: Optional<Spanned<[f64; 3]>>,
        /// The viewing direction; only the direction counts. Either this or `look_at_m`.
        direction: Optional<Spanned<Direction>>,
        /// Which way is up in the picture; only the direction counts, and only its part across the view.
        up: Required<Spanned<Direction>> = "[0, 1, 0]",
        /// Whether left and right are exchanged in the picture, as in a mirror.
        mirrored: Required<bool> = "false",
        /// Full vertical angle of view, degrees.
        vertical_fov_deg: Optional<FieldOfView>,
        /// Full horizontal angle of view, degrees.
        horizontal_fov_deg: Optional<FieldOfView>,
        /// Focal length, m. With a sensor size it gives the angle of view; with `lens.f_number`, the lens radius.
        focal_length_m: Optional<Spanned<Positive>>,
        /// Height of the sensor, m; needs `focal_length_m`.
        sensor_height_m: Optional<Positive>,
        /// Width of the sensor, m; needs `focal_length_m`.
        sensor_width_m: Optional<Positive>,
        /// A thin lens; without it, the camera is a pinhole and everything is in focus.
        lens: Optional<Lens>,
        /// What is nearer than this plane is cut off: its distance along the viewing direction, m.
        near_m: Required<NonNegative> = "0",
        /// When the shutter opens and when it closes, s.
        shutter_s: Required<Spanned<[f64; 2]>> = "[0, 0]",
        /// How the camera moves: its placement at some times.
        keyframes: Optional<Spanned<List<Box<KeyframeForm>>>>,
    } with [
        Rule::OneOf(&["look_at_m", "direction"]),
        Rule::OneOf(&["vertical_fov_deg", "horizontal_fov_deg", "sensor_height_m", "sensor_width_m"]),
        Rule::Needs("sensor_height_m", &["focal_length_m"]),
        Rule::Needs("sensor_width_m", &["focal_length_m"]),
    ]
}

crate::record! {
    /// An ideal thin lens: exactly one of `radius_m` and `f_number`.
    pub(crate) struct Lens + comment {
        /// Radius of the aperture, m; 0 is a pinhole.
        radius_m: Optional<NonNegative>,
        /// Focal length over the diameter of the aperture; needs the camera's `focal_length_m`.
        f_number: Optional<Spanned<Positive>>,
        /// Distance along the viewing direction of the plane in focus, m.
        focus_distance_m: Required<Spanned<Positive>>,
    } with [Rule::OneOf(&["radius_m", "f_number"])]
}

crate::record! {
    /// Parallel projection. Pixels are square.
    pub(crate) struct OrthographicCamera + comment {
        /// A point on the plane from which the rays start, in the middle of the picture, m.
        position_m: Required<[f64; 3]>,
        /// A point in the middle of the picture, m. Either this or `direction`.
        look_at_m: Optional<Spanned<[f64; 3]>>,
        /// The viewing direction; only the direction counts. Either this or `look_at_m`.
        direction: Optional<Spanned<Direction>>,
        /// Which way is up in the picture; only the direction counts, and only its part across the view.
        up: Required<Spanned<Direction>> = "[0, 1, 0]",
        /// Whether left and right are exchanged in the picture, as in a mirror.
        mirrored: Required<bool> = "false",
        /// Height of the picture in the world, m.
        height_m: Required<Positive>,
        /// When the shutter opens and when it closes, s.
        shutter_s: Required<Spanned<[f64; 2]>> = "[0, 0]",
        /// How the camera moves: its placement at some times.
        keyframes: Optional<Spanned<List<Box<KeyframeForm>>>>,
    } with [Rule::OneOf(&["look_at_m", "direction"])]
}

crate::variants! {
    /// The camera.
    pub(crate) enum CameraForm by "type" {
        "perspective" => Perspective(PerspectiveCamera),
        "orthographic" => Orthographic(OrthographicCamera),
        "compound-lens" => CompoundLens(CompoundLensCamera),
    }
}

/// Most pixels along a side.
pub(crate) const MAX_SIDE: u64 = 65_536;
/// Most pixels of a picture: 2²⁸, some ten gigabytes of film.
pub(crate) const MAX_PIXELS: u64 = 1 << 28;
/// Most lobes of Lanczos's filter.
const MOST_LOBES: u64 = 16;

crate::record! {
    /// Size and reconstruction of the picture. At most 2²⁸ pixels.
    pub(crate) struct FilmForm + comment {
        /// Width, pixels.
        width: Required<Whole<1, MAX_SIDE>>,
        /// Height, pixels.
        height: Required<Spanned<Whole<1, MAX_SIDE>>>,
        /// Pixel filter.
        filter: Required<FilterForm> = r#"{ "type": "box" }"#,
        /// Whether pixels at the edges get light from beyond the film. If not, the part of their filter that lies on the film is all of it.
        sample_border: Required<bool> = "true",
        /// Whether the picture also holds S1, S2 and S3 of the light; it then calls for polarisation.
        stokes: Required<bool> = "false",
        /// Bands of wavelengths that the film keeps apart beside its colour: the centre of the first, that of the last, and the
        /// step between them, nm. Each band is as wide as the step.
        bands_nm: Optional<Spanned<[Wavelength; 3]>>,
    }
}

crate::record! {
    /// The pixel's own square.
    pub(crate) struct BoxFilter + comment {}
}

crate::record! {
    /// A tent.
    pub(crate) struct TentFilter + comment {
        /// Radius, pixels.
        radius_px: Required<Positive> = "1",
    }
}

crate::record! {
    /// A Gaussian, cut at three standard deviations.
    pub(crate) struct GaussianFilter + comment {
        /// Standard deviation, pixels.
        sigma_px: Required<Positive> = "0.5",
    }
}

crate::record! {
    /// The cubic of Mitchell and Netravali. It is negative between half of its radius and all of it, where `c` is above 0.
    pub(crate) struct MitchellFilter + comment {
        /// Radius, pixels.
        radius_px: Required<Positive> = "2",
        /// How much it smooths: 1 with `c` 0 is the cubic B-spline.
        b: Required<Share> = "0.3333333333333333",
        /// How far it is negative: 0.5 with `b` 0 is the spline of Catmull and Rom.
        c: Required<Share> = "0.3333333333333333",
    }
}

crate::record! {
    /// Lanczos's filter: sin(πx)/(πx), times the same function that is wider by the number of lobes, and cut where that is 0.
    pub(crate) struct LanczosFilter + comment {
        /// Radius, pixels.
        lobes: Required<Whole<1, MOST_LOBES>> = "3",
    }
}

crate::variants! {
    /// Pixel filter, sampled by importance so that every sample belongs to one pixel.
    pub(crate) enum FilterForm by "type" {
        "box" => Box(BoxFilter),
        "tent" => Tent(TentFilter),
        "gaussian" => Gaussian(GaussianFilter),
        "mitchell" => Mitchell(MitchellFilter),
        "lanczos" => Lanczos(LanczosFilter),
    }
}

fn mitchell(form: &MitchellFilter) -> Option<Filter> {
    Some(Filter::Mitchell { radius_px: form.radius_px?.0, b: form.b?.0, c: form.c?.0 })
}

/// The film of a form, perhaps with another width and height.
pub(crate) fn film(
    form: &FilmForm,
    size: Option<[u32; 2]>,
    range_nm: Option<[f64; 2]>,
    reader: &mut Reader<'_>,
) -> Option<Film> {
    let filter = match form.filter.as_ref() {
        None => None,
        Some(FilterForm::Box(_)) => Some(Filter::Box),
        Some(FilterForm::Tent(tent)) => tent.radius_px.map(|radius| Filter::Tent { radius_px: radius.0 }),
        Some(FilterForm::Gaussian(gaussian)) => gaussian.sigma_px.map(|sigma| Filter::Gaussian { sigma_px: sigma.0 }),
        Some(FilterForm::Mitchell(form)) => mitchell(form),
        // At most MOST_LOBES.
        Some(FilterForm::Lanczos(form)) => form.lobes.map(|lobes| Filter::Lanczos { lobes: lobes.0 as u32 }),
    };
    let (width, height) = (form.width?.0, form.height?);
    if width * height.value.0 > MAX_PIXELS {
        let message = format!("{width} × {} pixels; at most {MAX_PIXELS} are possible", height.value.0);
        reader.error(Code::OutOfRange, height.at, message);
        return None;
    }
    // Both are at most MAX_SIDE.
    let [width, height] = size.unwrap_or([width as u32, height.value.0 as u32]);
    let bands = match form.bands_nm.given() {
        None => None,
        Some(bands) => match Bands::new(bands.value.map(|w| w.0), range_nm?) {
            Ok(bands) => Some(bands),
            Err(error) => {
                reader.error(Code::OutOfRange, bands.at, error.to_string());
                return None;
            }
        },
    };
    let sample_border = form.sample_border?;
    Some(Film { width, height, filter: filter?, sample_border, stokes: form.stokes?, bands })
}

/// The camera of a form; `film` gives the shape of the picture.
pub(crate) fn camera(
    form: &CameraForm,
    film: Option<&Film>,
    range_nm: Option<[f64; 2]>,
    files: &mut Files<'_>,
    reader: &mut Reader<'_>,
) -> Option<Camera> {
    match form {
        CameraForm::CompoundLens(form) => compound_lens_camera(form, range_nm, files, reader),
        CameraForm::Perspective(form) => {
            let view = orientation(form.position_m, &form.look_at_m, &form.direction, form.up, reader);
            let projection = perspective(form, film, reader);
            let shutter_s = shutter_s(form.shutter_s.as_ref(), reader);
            let placed = given(&form.keyframes, shutter_s.unwrap_or_default(), Stretch::Refused, reader);
            let (forward, up) = view?;
            let still = Camera {
                position_m: form.position_m?,
                forward,
                up,
                world_up: form.up?.value.0,
                mirrored: form.mirrored?,
                projection: projection?,
                near_m: form.near_m?.0,
                shutter_s: shutter_s?,
                motion: None,
            };
            Some(moving(still, placed?))
        }
        CameraForm::Orthographic(form) => {
            let view = orientation(form.position_m, &form.look_at_m, &form.direction, form.up, reader);
            let projection = Projection::Orthographic { height_m: form.height_m?.0 };
            let shutter_s = shutter_s(form.shutter_s.as_ref(), reader);
            let placed = given(&form.keyframes, shutter_s.unwrap_or_default(), Stretch::Refused, reader);
            let (forward, up) = view?;
            let still = Camera {
                position_m: form.position_m?,
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
    }
}

/// When the shutter of a camera opens and closes, s; an instant where that is wrong, which is reported with the camera.
pub(crate) fn shutter_of(form: Option<&CameraForm>) -> [f64; 2] {
    let shutter = match form {
        Some(CameraForm::Perspective(form)) => form.shutter_s.as_ref(),
        Some(CameraForm::Orthographic(form)) => form.shutter_s.as_ref(),
        Some(CameraForm::CompoundLens(form)) => form.shutter_s.as_ref(),
        None => None,
    };
    shutter.map(|shutter| shutter.value).filter(|[open, close]| open <= close).unwrap_or_default()
}

fn perspective(form: &PerspectiveCamera, film: Option<&Film>, reader: &mut Reader<'_>) -> Option<Projection> {
    let lens = match &form.lens {
        Optional::Given(lens) => self::lens(lens, form, reader).map(Some),
        Optional::Absent => Some(None),
        Optional::Invalid => None,
    };
    let lens = lens?;
    // Height over width of the picture.
    let aspect = film.map(|film| f64::from(film.height) / f64::from(film.width));
    let vertical_fov_rad = if let Some(fov) = form.vertical_fov_deg.given() {
        fov.0.to_radians()
    } else if let Some(fov) = form.horizontal_fov_deg.given() {
        2.0 * ((0.5 * fov.0.to_radians()).tan() * aspect?).atan()
    } else {
        let focal_length_m = form.focal_length_m.given()?;
        let height_m = match form.sensor_height_m.given() {
            Some(height) => height.0,
            None => form.sensor_width_m.given()?.0 * aspect?,
        };
        2.0 * (0.5 * height_m / sensor_distance_m(focal_length_m, form, reader)?).atan()
    };
    // Also for NaN.
    if !(vertical_fov_rad > 0.0 && vertical_fov_rad < std::f64::consts::PI) {
        let message = "the angle of view rounds to 0° or 180°";
        reader.error(Code::OutOfRange, form.at.head(), message);
        return None;
    }
    Some(Projection::Perspective { vertical_fov_rad, lens })
}

/// Where the sensor stands behind the lens: at the focal length for a pinhole, else where the lens puts its plane of
/// focus, 1/f = 1/z + 1/s.
fn sensor_distance_m(
    focal_length_m: &Spanned<Positive>,
    form: &PerspectiveCamera,
    reader: &mut Reader<'_>,
) -> Option<f64> {
    let f = focal_length_m.value.0;
    let lens = match &form.lens {
        Optional::Absent => return Some(f),
        Optional::Invalid => return None,
        Optional::Given(lens) => lens,
    };
    let focus = lens.focus_distance_m.as_ref()?;
    if focus.value.0 <= f {
        let message = format!("a lens of focal length {f} m cannot focus at {} m", focus.value.0);
        reader.error_hint(Code::OutOfRange, focus.at, message, "focus farther away than the focal length");
        return None;
    }
    Some(f / (1.0 - f / focus.value.0))
}

fn lens(lens: &Lens, form: &PerspectiveCamera, reader: &mut Reader<'_>) -> Option<ThinLens> {
    let radius_m = match (lens.radius_m.given(), lens.f_number.given()) {
        (Some(radius), _) => radius.0,
        (None, Some(f_number)) => {
            if !form.focal_length_m.is_present() {
                let message = "\"f_number\" needs the camera's \"focal_length_m\"";
                reader.error_hint(Code::MissingKey, f_number.at, message, "add it, or give \"radius_m\"");
            }
            form.focal_length_m.given()?.value.0 / (2.0 * f_number.value.0)
        }
        (None, None) => return None,
    };
    if !radius_m.is_finite() {
        reader.error(Code::OutOfRange, lens.at.head(), "the lens is infinitely large");
        return None;
    }
    Some(ThinLens { radius_m, focus_distance_m: lens.focus_distance_m.as_ref()?.value.0 })
}
