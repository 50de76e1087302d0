//! A film as files: the same for a picture that was rendered here and for one that was merged from parts.

use etalon_picture::{Attribute, Attributes, ERROR_PREFIX, ErrorInfo, Picture, PictureError, RenderInfo, Window};
use etalon_transport::{Canvas, Film, ImageError};
use miette::Report;

use crate::failure::Failure;
use crate::output::{self, Format, Output, Written};
use crate::state::{self, Header};

/// What is to be written.
pub(crate) struct Delivery<'a> {
    /// What it is, and how far.
    pub header: &'a Header,
    /// Its tiles and its film.
    pub canvas: &'a Canvas,
    /// Samples a pixel, as the file says.
    pub samples: u32,
    /// Its error, where something is known of it.
    pub error: Option<ImageError>,
    /// Exposure of PNG files, stops.
    pub exposure_ev: f64,
}

impl Delivery<'_> {
    /// Writes every output, also after one of them has failed.
    pub(crate) fn write(&self, outputs: &[Output]) -> (Vec<Written>, Failure) {
        let (mut written, mut failure) = (Vec::new(), Failure::default());
        let (parts, pictures): (Vec<_>, Vec<_>) = outputs.iter().partition(|output| output.format == Format::Part);
        for part in parts {
            // A part that lacks samples is no part; what there is of it is in the checkpoint.
            if !self.header.complete {
                continue;
            }
            match state::write(&part.path, self.header, self.canvas) {
                Ok(()) => written.push(Written::whole(part)),
                Err(error) => failure.add(Failure::run(Report::from_err(error))),
            }
        }
        if pictures.is_empty() {
            return (written, failure);
        }
        match self.canvas.with_film(|film| self.contents(film)) {
            Err(error) => failure.add(Failure::run(Report::from_err(error))),
            Ok((picture, attributes)) => {
                let (software, comment) = (&self.header.subject.software, self.comment());
                for output in pictures {
                    match output::write(output, &picture, &attributes, self.exposure_ev, software, &comment) {
                        Ok(done) => written.push(done),
                        Err(error) => failure.add(error),
                    }
                }
            }
        }
        // In the order in which they were asked for.
        let place = |written: &Written| outputs.iter().position(|output| written.is(output));
        written.sort_by_key(place);
        (written, failure)
    }

    fn contents(&self, film: &Film) -> Result<(Picture<f32>, Attributes), PictureError> {
        let (mut picture, mut attributes) = (self.picture(film)?, self.attributes(film)?);
        crate::stokes::add(&mut picture, &mut attributes, film, self.header.subject.crop)?;
        Ok((picture, attributes))
    }

    fn attributes(&self, film: &Film) -> Result<Attributes, PictureError> {
        let subject = &self.header.subject;
        let mut attributes = RenderInfo {
            software: subject.software.clone(),
            render_time_s: self.header.seconds,
            samples_per_pixel: self.samples,
            seed: subject.seed,
            scene_sha256: subject.scene_sha256.clone(),
            plan_json: subject.plan.to_string(),
        }
        .attributes()?;
        let approximations = subject.approximations();
        if !approximations.is_empty() {
            let text = Attribute::Text(format!("without {}", approximations.join("; without ")));
            attributes.insert("approximation".to_owned(), text);
        }
        if let Some(unfinished) = self.unfinished() {
            attributes.insert("unfinished".to_owned(), Attribute::Text(unfinished));
        }
        attributes.extend(self.error.as_ref().map(|error| error_info(film, error).attributes()).unwrap_or_default());
        Ok(attributes)
    }

    /// What the picture lacks, if it is a part of one or was interrupted.
    fn unfinished(&self) -> Option<String> {
        let (shard, mut lacks) = (self.header.shard, Vec::new());
        if shard.of > 1 {
            lacks.push(format!("the tiles of share {} of {} only", shard.index + 1, shard.of));
        }
        if !self.header.complete {
            lacks.push(format!("interrupted on the way to {} samples a pixel", self.header.samples));
        }
        (!lacks.is_empty()).then(|| lacks.join(", "))
    }

    fn comment(&self) -> String {
        let subject = &self.header.subject;
        let mut comment = format!(
            "{} samples a pixel, seed {}, exposure {:+} EV, scene {}",
            self.samples, subject.seed, self.exposure_ev, subject.scene_sha256
        );
        let approximations = subject.approximations();
        if !approximations.is_empty() {
            comment += &format!(", approximation without {}", approximations.join("; without "));
        }
        if let Some(unfinished) = self.unfinished() {
            comment += &format!(", {unfinished}");
        }
        comment
    }

    /// The rendered part of the film as linear Rec. 709, the standard error of each channel where it is known, and the number of
    /// samples where pixels differ in it.
    fn picture(&self, film: &Film) -> Result<Picture<f32>, PictureError> {
        let rect = self.header.subject.crop;
        let cut = |whole: Vec<[f32; 3]>| -> Vec<[f32; 3]> {
            rect.pixels().map(|(x, y)| whole[y as usize * film.width() as usize + x as usize]).collect()
        };
        let window = Window {
            origin_px: [rect.x0 as i32, rect.y0 as i32],
            frame_px: [film.width() as usize, film.height() as usize],
        };
        let (width, height) = ((rect.x1 - rect.x0) as usize, (rect.y1 - rect.y0) as usize);
        let mut picture = Picture::from_rgb(width, height, &cut(film.linear_rec709()))?.in_frame(window)?;
        let errors = cut(film.linear_rec709_error());
        // Where nothing at all is known there is nothing to say.
        if errors.iter().any(|error| error[0].is_finite()) {
            for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
                picture.insert(&format!("{ERROR_PREFIX}{name}"), errors.iter().map(|error| error[index]).collect())?;
            }
        }
        let counts: Vec<f32> = rect.pixels().map(|(x, y)| film.pixel(x, y).count() as f32).collect();
        if counts.iter().any(|&count| count != counts[0]) {
            picture.insert(SAMPLES, counts)?;
        }
        Ok(picture)
    }
}

/// The channel of the number of finite samples of each pixel.
const SAMPLES: &str = "samples";

/// What the file says about the error of its picture.
fn error_info(film: &Film, error: &ImageError) -> ErrorInfo {
    let tile = error.noisiest.rect;
    ErrorInfo {
        replicates: film.replicates(),
        relative_rmse: error.relative_rmse,
        interval: error.interval,
        tail_index: error.tail_index,
        noisiest_tile: [tile.x0, tile.x1, tile.y0, tile.y1],
    }
}
