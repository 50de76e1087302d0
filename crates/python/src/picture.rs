//! Pictures: named channels and what is said about them.

use std::path::PathBuf;

use etalon::CompareSettings;
use etalon::picture_files::develop::{
    Axis, ErrorKind, Exposure, MAX_STOPS, Map, Rect, Settings, Tone, ToneCurve, White, WhiteBalance, develop,
    spectrum_of,
};
use etalon::picture_files::{
    self as files, Attribute, Attributes, ErrorInfo, ExrFile, PictureError, encode_png, read_exr, read_png, write_exr,
    write_png,
};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyDict};
use serde_json::json;

use crate::errors::{of_picture, setting};

/// A band over some pixels: wavelength, mean, standard error, pixels left out.
type Mean = (f64, f64, Option<f64>, usize);

/// Named channels of 32-bit floats, and attributes.
#[pyclass(frozen, module = "etalon._etalon")]
pub(crate) struct Picture {
    pub(crate) file: ExrFile,
}

/// Reads an EXR file, or the linear colours of a PNG file.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<Picture> {
    let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    let file = py.detach(|| {
        if is_png {
            return Ok(ExrFile { picture: read_png(&path)?, attributes: Attributes::default() });
        }
        read_exr(&path)
    });
    file.map(|file| Picture { file }).map_err(|error| of_picture(py, &error))
}

/// Compares two pictures; the result is JSON. The map of FLIP is an array of 64-bit floats.
#[pyfunction]
#[pyo3(signature = (image, reference, *, significance, tile, exposure))]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    image: &Picture,
    reference: &Picture,
    significance: f64,
    tile: usize,
    exposure: f64,
) -> PyResult<(String, Bound<'py, PyByteArray>)> {
    if !(significance > 0.0 && significance < 1.0) {
        return Err(setting(py, format!("significance is {significance}; it is a probability between 0 and 1")));
    }
    if tile == 0 {
        return Err(setting(py, "tile is 0; it is a side of at least 1 pixel"));
    }
    check_stops(py, exposure)?;
    let settings = CompareSettings { significance, tile, exposure_ev: exposure };
    let comparison =
        py.detach(|| etalon::compare(&image.file, &reference.file, ["the picture", "the reference"], &settings));
    let comparison = comparison.map_err(|error| of_picture(py, &error))?;
    let text = serde_json::to_string(&comparison).expect("a comparison is plain data");
    Ok((text, doubles(py, comparison.flip_map.iter().copied())?))
}

/// An array of 64-bit floats as bytes.
pub(crate) fn doubles<'py>(
    py: Python<'py>,
    values: impl ExactSizeIterator<Item = f64>,
) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, 8 * values.len(), |bytes| {
        bytes.chunks_exact_mut(8).zip(values).for_each(|(to, value)| to.copy_from_slice(&value.to_ne_bytes()));
        Ok(())
    })
}

fn check_stops(py: Python<'_>, stops: f64) -> PyResult<()> {
    if stops.abs() <= MAX_STOPS {
        return Ok(());
    }
    Err(setting(py, format!("exposure is {stops}; it is from -{MAX_STOPS} to {MAX_STOPS} stops")))
}

impl Picture {
    fn developed(&self, py: Python<'_>, options: &Bound<'_, PyDict>) -> PyResult<(files::Rgb8, String)> {
        let settings = settings(py, options)?;
        let developed = py.detach(|| develop(&self.file, &settings)).map_err(|error| of_picture(py, &error))?;
        let tone = match &developed.tone {
            Tone::Picture { exposure_ev, clipping } => json!({
                "exposure": exposure_ev, "clipped": clipping.any, "too_bright": clipping.above,
                "outside_gamut": clipping.below,
            }),
            Tone::Map { title, range, below, above } => {
                json!({ "title": title, "range": range, "below": below, "above": above })
            }
        };
        let mut about = tone;
        about["band_nm"] = json!(developed.band_nm);
        about["not_finite"] = json!(developed.not_finite.count);
        Ok((developed.image, about.to_string()))
    }

    fn text(&self, name: &str) -> Option<&str> {
        match self.file.attributes.get(name) {
            Some(Attribute::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// The texts that a PNG of this picture has.
    fn png_texts(&self) -> Vec<(&'static str, &str)> {
        const OWN: &str = concat!("etalon ", env!("CARGO_PKG_VERSION"));
        vec![("Software", self.text("software").filter(|name| name.starts_with("etalon ")).unwrap_or(OWN))]
    }
}

/// Development, from the arguments of `Picture.develop` in Python, all of which are there.
fn settings(py: Python<'_>, options: &Bound<'_, PyDict>) -> PyResult<Settings> {
    let get = |name: &str| options.get_item(name).map(|value| value.filter(|value| !value.is_none()));
    let number = |name: &str| get(name)?.map(|value| value.extract::<f64>()).transpose();
    let word = |name: &str| get(name)?.map(|value| value.extract::<String>()).transpose();
    let rect = |value: Bound<'_, PyAny>| {
        let [x, y, width, height] = value.extract::<[usize; 4]>()?;
        Ok::<_, PyErr>(Rect { x, y, width, height })
    };
    let exposure = match get("exposure")? {
        None => Exposure::Stops(0.0),
        Some(value) if value.extract::<String>().is_ok_and(|word| word == "auto") => Exposure::Auto,
        Some(value) => {
            let stops = value.extract::<f64>()?;
            check_stops(py, stops)?;
            Exposure::Stops(stops)
        }
    };
    let white_balance = match get("white_balance")? {
        None => WhiteBalance::None,
        Some(value) => match value.extract::<String>() {
            Ok(name) => WhiteBalance::Light(White::named(&name).map_err(|why| setting(py, why.to_string()))?),
            Err(_) => WhiteBalance::Patch(rect(value)?),
        },
    };
    let curve = match word("curve")?.as_deref() {
        None | Some("linear") => ToneCurve::Linear,
        Some("filmic") => ToneCurve::Filmic,
        Some("agx") => ToneCurve::Agx,
        Some(other) => {
            return Err(setting(py, format!("there is no tone curve {other:?}: linear, filmic or agx")));
        }
    };
    let error = match word("error_map")?.as_deref() {
        None => None,
        Some("relative") => Some(ErrorKind::Relative),
        Some("absolute") => Some(ErrorKind::Absolute),
        Some(other) => {
            return Err(setting(py, format!("there is no error map {other:?}: relative or absolute")));
        }
    };
    let axis = match word("axis")?.as_deref() {
        None | Some("log") => Axis::Log,
        Some("linear") => Axis::Linear,
        Some(other) => return Err(setting(py, format!("there is no axis {other:?}: log or linear"))),
    };
    let false_colour = get("false_colour")?.is_some_and(|value| value.is_truthy().unwrap_or(false));
    let range = get("range")?.map(|value| value.extract::<[f64; 2]>()).transpose()?;
    let map = (false_colour || error.is_some()).then_some(Map { error, axis, range });
    let scale = number("scale")?.unwrap_or(1.0);
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(setting(py, format!("scale is {scale}; it must be above 0 and finite")));
    }
    let crop = get("crop")?.map(rect).transpose()?;
    Ok(Settings { crop, scale, band_nm: number("band_nm")?, white_balance, exposure, curve, map })
}

#[pymethods]
impl Picture {
    /// A picture of channels, each with 4 bytes a pixel: 32-bit floats, row after row.
    #[new]
    fn new(py: Python<'_>, width: usize, height: usize, channels: Vec<(String, Bound<'_, PyBytes>)>) -> PyResult<Self> {
        let make = || -> Result<files::Picture<f32>, PictureError> {
            let mut picture = files::Picture::new(width, height)?;
            for (name, bytes) in &channels {
                let (samples, _) = bytes.as_bytes().as_chunks::<4>();
                picture.insert(name, samples.iter().map(|bytes| f32::from_ne_bytes(*bytes)).collect())?;
            }
            Ok(picture)
        };
        let picture = make().map_err(|error| of_picture(py, &error))?;
        Ok(Self { file: ExrFile { picture, attributes: Attributes::default() } })
    }

    /// Width and height, pixels.
    #[getter]
    fn size(&self) -> (usize, usize) {
        (self.file.picture.width(), self.file.picture.height())
    }

    /// Column and row of the top left pixel in the frame; width and height of the frame.
    #[getter]
    fn window(&self) -> ([i32; 2], [usize; 2]) {
        let window = self.file.picture.window();
        (window.origin_px, window.frame_px)
    }

    /// Names of all channels.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.file.picture.channels().iter().map(|channel| channel.name.as_str()).collect()
    }

    /// The samples of a channel, as 32-bit floats, row after row.
    fn channel<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyByteArray>> {
        let samples = self.file.picture.require(name).map_err(|error| of_picture(py, &error))?;
        PyByteArray::new_with(py, 4 * samples.len(), |bytes| {
            let (chunks, _) = bytes.as_chunks_mut::<4>();
            chunks.iter_mut().zip(samples).for_each(|(to, value)| *to = value.to_ne_bytes());
            Ok(())
        })
    }

    /// What the file says beside its channels: texts, numbers, lists of numbers, bytes.
    fn attributes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for (name, attribute) in &self.file.attributes {
            match attribute {
                Attribute::Text(text) => all.set_item(name, text),
                Attribute::Int(value) => all.set_item(name, value),
                Attribute::Float(value) => all.set_item(name, value),
                Attribute::Double(value) => all.set_item(name, value),
                Attribute::Vec2(values) => all.set_item(name, values),
                Attribute::Vec3(values) => all.set_item(name, values),
                Attribute::Matrix4(values) => all.set_item(name, values),
                Attribute::Chromaticities(c) => all.set_item(name, [c.red, c.green, c.blue, c.white].concat()),
                Attribute::Other { bytes, .. } => all.set_item(name, PyBytes::new(py, bytes)),
            }?;
        }
        Ok(all)
    }

    /// The relative error of the whole picture and its 95 % interval, if the file states them.
    fn relative_error(&self) -> Option<(f64, [f64; 2])> {
        ErrorInfo::from_attributes(&self.file.attributes).map(|info| (info.relative_rmse, info.interval))
    }

    /// Means of the bands over a rectangle (column, row, width, height): wavelength, mean, standard error, pixels left out.
    fn spectrum(&self, py: Python<'_>, rect: [usize; 4]) -> PyResult<Vec<Mean>> {
        let [x, y, width, height] = rect;
        let bands = spectrum_of(&self.file, Rect { x, y, width, height }).map_err(|error| of_picture(py, &error))?;
        Ok(bands.iter().map(|band| (band.centre_nm, band.mean, band.error, band.left_out)).collect())
    }

    /// Writes an EXR file.
    fn write_exr(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write_exr(&path, &self.file.picture, &self.file.attributes))
            .map_err(|error| of_picture(py, &error))
    }

    /// Develops the picture and writes it as a PNG file; what became of the values, as JSON.
    fn write_png(&self, py: Python<'_>, path: PathBuf, options: &Bound<'_, PyDict>) -> PyResult<String> {
        let (image, about) = self.developed(py, options)?;
        write_png(&path, &image, &self.png_texts()).map_err(|error| of_picture(py, &error))?;
        Ok(about)
    }

    /// Develops the picture: width, height, 8-bit sRGB, and what became of the values, as JSON.
    fn develop<'py>(
        &self,
        py: Python<'py>,
        options: &Bound<'_, PyDict>,
    ) -> PyResult<(usize, usize, Bound<'py, PyByteArray>, String)> {
        let (image, about) = self.developed(py, options)?;
        Ok((image.width, image.height, PyByteArray::new(py, &image.pixels), about))
    }

    /// Develops the picture: the bytes of a PNG file.
    fn png<'py>(&self, py: Python<'py>, options: &Bound<'_, PyDict>) -> PyResult<Bound<'py, PyBytes>> {
        let (image, _) = self.developed(py, options)?;
        let bytes = encode_png(&image, &self.png_texts()).map_err(|error| of_picture(py, &error))?;
        Ok(PyBytes::new(py, &bytes))
    }
}
