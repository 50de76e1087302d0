//! One picture at one moment, with all that the page may ask of it.

use etalon::{Channels, ErrorReport, FilmFile, ImageError, PixelRect, picture_files};
use etalon_control::Canvas;
use etalon_optics::colour::rec709_from_xyz;
use etalon_picture::develop::{colour_of, luminance_errors};
use etalon_picture::{Attributes, ERROR_PREFIX, ErrorInfo, ExrFile, Picture, PictureError};
use etalon_transport::accuracy::ErrorSum;
use etalon_transport::film::XyzSum;
use etalon_transport::{Film, Pixel};

use crate::camera::CameraView;

/// A picture at a moment. Nothing in it changes.
pub(crate) struct Snapshot {
    /// Its number, from 1: the page asks for a picture by it.
    pub number: u64,
    /// The stage, that is scene, camera and effects, that it shows.
    pub stage: u64,
    /// Channels and attributes, as an EXR file has them.
    pub file: ExrFile,
    /// Its colour as linear Rec. 709, where the file has other channels or primaries.
    pub colour: Option<Picture<f32>>,
    /// The luminance of each pixel, and its standard error; infinite where that is unknown.
    pub luminance: Luminance,
    /// Columns and rows of the film.
    pub film: [u32; 2],
    /// Side, in pixels of the film, of the blocks that its pixels stand for: 1 but for first coarse pictures.
    pub block: u32,
    /// Samples of each of its pixels, in the mean.
    pub samples: u32,
    /// Seconds since the picture was begun.
    pub seconds: f64,
    /// The error of the picture.
    pub error: Option<ErrorReport>,
    /// From where it is seen, if that is known.
    pub camera: Option<CameraView>,
    /// What it shows, in words for a list of pictures.
    pub title: String,
}

/// The luminance Y of each pixel, row after row.
pub(crate) struct Luminance {
    /// Its mean.
    pub values: Vec<f32>,
    /// The standard error of that; empty where no error is known.
    pub errors: Vec<f32>,
}

impl Luminance {
    fn of<'a>(pixels: impl Iterator<Item = Pixel<'a>>) -> Self {
        let (mut values, mut errors) = (Vec::new(), Vec::new());
        for pixel in pixels {
            values.push(pixel.xyz()[1] as f32);
            let variance = pixel.variance(|xyz| [xyz[1]]);
            errors.push(variance.map_or(f32::INFINITY, |([variance], _)| variance.sqrt() as f32));
        }
        if errors.iter().all(|error| error.is_infinite()) {
            errors.clear();
        }
        Self { values, errors }
    }
}

impl Snapshot {
    /// Columns and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.file.picture.width(), self.file.picture.height()]
    }

    /// The pixel of this picture that shows a pixel of the film.
    pub(crate) fn pixel_of(&self, [x, y]: [u32; 2]) -> Option<usize> {
        let [width, height] = self.size();
        let (x, y) = ((x / self.block) as usize, (y / self.block) as usize);
        (x < width && y < height).then_some(y * width + x)
    }
}

/// What every snapshot of a render says beside its pixels.
pub(crate) struct About {
    pub number: u64,
    pub stage: u64,
    pub seconds: f64,
    pub camera: CameraView,
    pub title: String,
}

/// A snapshot of a film.
///
/// # Errors
/// If the picture is larger than an EXR file can be.
pub(crate) fn of_film(
    film: &Film,
    subject: &etalon::Subject,
    samples: u32,
    about: About,
) -> Result<Snapshot, PictureError> {
    let rect = subject.crop;
    let error = film.error(rect);
    let file = FilmFile {
        film,
        subject,
        channels: &Channels::default(),
        tiles: &[],
        features: &[],
        object_names: None,
        samples,
        seconds: about.seconds,
        error,
        unfinished: None,
    }
    .exr()?;
    let luminance = Luminance::of(film.pixels());
    let About { number, stage, seconds, camera, title } = about;
    Ok(Snapshot {
        number,
        stage,
        file,
        colour: None,
        luminance,
        film: [film.width(), film.height()],
        block: 1,
        samples,
        seconds,
        error: error.map(|error| ErrorReport::new(subject.replicates, &error)),
        camera: Some(camera),
        title,
    })
}

/// What a canvas holds now.
pub(crate) fn film_of(canvas: &Canvas) -> Film {
    canvas.with_film(Film::clone)
}

/// The whole film.
pub(crate) fn whole([width, height]: [u32; 2]) -> PixelRect {
    PixelRect { x0: 0, y0: 0, x1: width, y1: height }
}

/// Pixels of a coarse picture: one for each block of the film, with the sums of its replicates.
pub(crate) struct CoarsePixels {
    pub width: u32,
    pub height: u32,
    /// Columns and rows of the film.
    pub film: [u32; 2],
    pub block: u32,
    pub replicates: u32,
    pub samples: u32,
    /// Pixel by pixel, in each replicate by replicate.
    pub sums: Vec<XyzSum>,
}

/// A snapshot of a coarse picture.
///
/// # Errors
/// If it is larger than a picture can be.
pub(crate) fn of_coarse(coarse: &CoarsePixels, about: About) -> Result<Snapshot, PictureError> {
    let pixels = || coarse.sums.chunks_exact(coarse.replicates as usize).map(Pixel::new);
    let mut all = ErrorSum::default();
    pixels().for_each(|pixel| all.push(pixel));
    let mut file = Picture::new(coarse.width as usize, coarse.height as usize)?;
    let colours: Vec<[f32; 3]> = pixels().map(|pixel| pixel.linear_rec709()).collect();
    let errors: Vec<[f32; 3]> = pixels()
        .map(|pixel| match pixel.variance(rec709_from_xyz) {
            Some((variance, _)) => variance.map(|v| v.sqrt() as f32),
            None => [f32::INFINITY; 3],
        })
        .collect();
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        file.insert(name, colours.iter().map(|rgb| rgb[c]).collect())?;
        file.insert(&format!("{ERROR_PREFIX}{name}"), errors.iter().map(|rgb| rgb[c]).collect())?;
    }
    let relative_rmse = all.relative_rmse();
    let error = relative_rmse.map(|relative_rmse| {
        ErrorReport::new(
            coarse.replicates,
            &ImageError {
                relative_rmse,
                interval: all.interval(1),
                mean_y: all.mean_y(),
                mean_y_interval: all.mean_y_interval(1),
                tail_index: all.tail_index(),
                pixel_tail_index: all.pixel_tail_index(),
                noisy_pixels: 0,
                noisiest: None,
                unknown_pixels: 0,
            },
        )
    });
    let About { number, stage, seconds, camera, title } = about;
    Ok(Snapshot {
        number,
        stage,
        file: ExrFile { picture: file, attributes: Attributes::new() },
        colour: None,
        luminance: Luminance::of(pixels()),
        film: coarse.film,
        block: coarse.block,
        samples: coarse.samples,
        seconds,
        error,
        camera: Some(camera),
        title,
    })
}

/// A snapshot of a picture from a file.
///
/// # Errors
/// If the file has no colour.
pub(crate) fn of_file(file: ExrFile, title: String) -> Result<Snapshot, PictureError> {
    let colour = colour_of(&file)?;
    let [r, g, b] = [colour.require("R")?, colour.require("G")?, colour.require("B")?];
    let luminance = |i: usize| {
        let rgb = [r[i], g[i], b[i]].map(f64::from);
        etalon_optics::colour::rec709_to_xyz(rgb)[1] as f32
    };
    let errors = luminance_errors(&file).unwrap_or_default();
    let luminance = Luminance {
        values: (0..r.len()).map(luminance).collect(),
        errors: errors.into_iter().map(|error| error as f32).collect(),
    };
    let info = picture_files::RenderInfo::from_attributes(&file.attributes);
    let error = ErrorInfo::from_attributes(&file.attributes).map(|error| {
        ErrorReport::new(
            error.replicates,
            &ImageError {
                relative_rmse: error.relative_rmse,
                interval: error.interval,
                mean_y: luminance.values.iter().map(|y| f64::from(*y)).sum::<f64>() / luminance.values.len() as f64,
                // A file has the errors of pixels alone.
                mean_y_interval: None,
                tail_index: error.tail_index,
                pixel_tail_index: None,
                noisy_pixels: 0,
                noisiest: None,
                unknown_pixels: 0,
            },
        )
    });
    Ok(Snapshot {
        number: 1,
        stage: 1,
        luminance,
        colour: Some(colour),
        film: [file.picture.width() as u32, file.picture.height() as u32],
        block: 1,
        samples: info.as_ref().map_or(0, |info| info.samples_per_pixel),
        seconds: info.as_ref().map_or(0.0, |info| info.render_time_s),
        error,
        camera: None,
        title,
        file,
    })
}
