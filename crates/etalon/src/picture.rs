//! A picture that was rendered: pixels, errors, bands, files.

use std::path::Path;

use etalon_control::{Ended, Prediction, Reached, Settled};
use etalon_optics::colour::rec709_from_xyz;
use etalon_picture::{Clipping, ExrFile, encode_srgb8, write_exr, write_png};
use etalon_transport::{Band, Features, Film, ImageError, Pixel, PixelRect};

use crate::channels::{Aov, Channels};
use crate::error::RenderError;
use crate::film_file::FilmFile;
use crate::subject::Subject;

/// A picture that was rendered. Pixels are named by their column and row in the whole frame, from the top left.
#[derive(Clone, Debug)]
pub struct Render {
    pub(crate) film: Film,
    pub(crate) subject: Subject,
    pub(crate) ended: Ended,
    pub(crate) settled: Settled,
    pub(crate) channels: Channels,
    pub(crate) tiles: Vec<PixelRect>,
    pub(crate) features: Vec<Vec<Features>>,
    pub(crate) object_names: Vec<String>,
}

impl Render {
    /// The pixels that were rendered.
    pub fn rect(&self) -> PixelRect {
        self.subject.crop
    }

    /// The sums of all samples.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// One pixel; `None` where nothing was rendered.
    pub fn pixel(&self, x: u32, y: u32) -> Option<Pixel<'_>> {
        self.holds(x, y).then(|| self.film.pixel(x, y))
    }

    /// Linear Rec. 709 of one pixel; `None` where nothing was rendered.
    pub fn rgb(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        self.pixel(x, y).map(|pixel| pixel.linear_rec709())
    }

    /// Standard error of each component of [`Render::rgb`]; `None` where it is unknown, for instance with one replicate.
    pub fn rgb_error(&self, x: u32, y: u32) -> Option<[f64; 3]> {
        let (variance, _) = self.pixel(x, y)?.variance(rec709_from_xyz)?;
        Some(variance.map(f64::sqrt))
    }

    /// Linear Rec. 709 of all pixels of [`Render::rect`], row after row.
    pub fn rgb_pixels(&self) -> Vec<[f32; 3]> {
        self.rect().pixels().map(|(x, y)| self.film.pixel(x, y).linear_rec709()).collect()
    }

    /// Centres of the bands of wavelengths that the film keeps, nm; empty if it keeps none.
    pub fn bands_nm(&self) -> Vec<f64> {
        let bands = self.subject.bands.as_ref();
        bands.map_or_else(Vec::new, |bands| (0..bands.count).map(|index| bands.centre_nm(index)).collect())
    }

    /// Mean radiance over a band, in W·m⁻²·sr⁻¹·nm⁻¹, with its standard error; `index` counts in [`Render::bands_nm`]. `None` where
    /// nothing was rendered or the film has no such band.
    pub fn band(&self, x: u32, y: u32, index: usize) -> Option<Band> {
        self.stokes_band(x, y, 0, index)
    }

    /// As [`Render::band`], of Stokes parameter `parameter` (0 to 3); those above 0 are there for polarised renders only.
    pub fn stokes_band(&self, x: u32, y: u32, parameter: u32, index: usize) -> Option<Band> {
        let bands = self.subject.bands.as_ref().filter(|bands| index < bands.count as usize)?;
        let there = parameter < self.subject.stokes_parameters() && self.holds(x, y);
        there.then(|| bands.of_pixel(&self.film, x, y, parameter, index as u32))
    }

    /// What the camera rays of a pixel meet first; `None` where it was not asked for by [`Settings::channels`](crate::Settings).
    pub fn features(&self, x: u32, y: u32) -> Option<&Features> {
        let holds = |tile: &PixelRect| (tile.x0..tile.x1).contains(&x) && (tile.y0..tile.y1).contains(&y);
        let number = self.tiles.iter().position(holds)?;
        let tile = self.tiles[number];
        self.features[number].get(((y - tile.y0) * (tile.x1 - tile.x0) + (x - tile.x0)) as usize)
    }

    /// The relative error of the picture with its interval; `None` where nothing is known of it.
    pub fn error(&self) -> Option<ImageError> {
        self.film.error(self.rect())
    }

    /// Samples that every pixel has, at least; in the mean where regions with more error take more.
    pub fn samples(&self) -> u32 {
        self.ended.samples
    }

    /// Whether any sample was taken: a render that was stopped at once has none.
    pub fn has_samples(&self) -> bool {
        self.rect().pixels().any(|(x, y)| self.film.pixel(x, y).count() > 0)
    }

    /// Seconds from the start to the end, with the pilot.
    pub fn seconds(&self) -> f64 {
        self.ended.seconds
    }

    /// Which limit ended the render.
    pub fn reached(&self) -> Reached {
        self.ended.reached
    }

    /// What was predicted before the picture began, if an error was asked for.
    pub fn predicted(&self) -> Option<Prediction> {
        self.ended.predicted
    }

    /// What decides the pixels: scene, seed, size, plan.
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    fn holds(&self, x: u32, y: u32) -> bool {
        let rect = self.rect();
        (rect.x0..rect.x1).contains(&x) && (rect.y0..rect.y1).contains(&y)
    }

    fn file(&self) -> FilmFile<'_> {
        let interrupted = self.ended.reached == Reached::Interrupted;
        FilmFile {
            film: &self.film,
            subject: &self.subject,
            channels: &self.channels,
            tiles: &self.tiles,
            features: &self.features,
            object_names: self.channels.has(Aov::Object).then_some(self.object_names.as_slice()),
            samples: self.ended.samples,
            seconds: self.ended.seconds,
            error: self.error(),
            unfinished: interrupted
                .then(|| format!("interrupted on the way to {} samples a pixel", self.settled.samples)),
        }
    }

    /// Channels and attributes of the EXR file.
    ///
    /// # Errors
    /// If the picture is larger than an EXR file can be.
    pub fn exr(&self) -> Result<ExrFile, RenderError> {
        Ok(self.file().exr()?)
    }

    /// Writes an EXR file: linear Rec. 709, errors, bands and what else was asked for. It appears under its name whole or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<(), RenderError> {
        let ExrFile { picture, attributes } = self.exr()?;
        Ok(write_exr(path.as_ref(), &picture, &attributes)?)
    }

    /// Writes an sRGB PNG file with 8 bits a component, made brighter by `exposure_ev` stops, and says what was clipped.
    /// [`etalon_picture::develop`] offers white balance and tone curves.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_png(&self, path: impl AsRef<Path>, exposure_ev: f64) -> Result<Clipping, RenderError> {
        let (picture, clipping) = encode_srgb8(&self.file().colour()?, exposure_ev)?;
        write_png(path.as_ref(), &picture, &[])?;
        Ok(clipping)
    }
}
