//! A film as files: the same for a picture that was rendered here and for one that was merged from parts.

use etalon::{Channels, FilmFile};
use etalon_control::Canvas;
use etalon_picture::{Attribute, ExrFile, PictureError};
use etalon_transport::{Features, Film, ImageError, PixelRect};
use miette::Report;

use crate::developing::{Developing, FRAME_SETTINGS};
use crate::failure::Failure;
use crate::frame_settings::FrameSettings;
use crate::output::{self, Format, Output, Written};
use crate::state::{self, Header};

/// What is to be written.
pub(crate) struct Delivery<'a> {
    /// What it is, and how far.
    pub header: &'a Header,
    /// Its tiles and its film.
    pub canvas: &'a Canvas,
    /// What the pixels of each tile meet first, where a channel wants it.
    pub features: &'a [Vec<Features>],
    /// Samples a pixel, as the file says.
    pub samples: u32,
    /// Its error, where something is known of it.
    pub error: Option<ImageError>,
    /// How PNG files are made.
    pub developing: &'a Developing,
    /// What the files say of the frame, if it is one of a sequence.
    pub frame: Option<&'a FrameSettings>,
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
            match state::write(&part.path, self.header, self.canvas, self.features) {
                Ok(()) => written.push(Written::whole(part)),
                Err(error) => failure.add(Failure::run(Report::from_err(error))),
            }
        }
        if pictures.is_empty() {
            return (written, failure);
        }
        let tiles: Vec<PixelRect> = (0..self.features.len()).map(|number| self.canvas.tile(number).0.rect).collect();
        let made = self.canvas.with_film(|film| {
            let file = self.film_file(film, &tiles);
            let mut whole = file.exr()?;
            let picture =
                if self.developing.needs_all_channels() { file.picture(&Channels::default())? } else { file.colour()? };
            let mut shown = ExrFile { picture, attributes: whole.attributes.clone() };
            if let Some(frame) = self.frame {
                for (file, format) in [(&mut whole, Format::Exr), (&mut shown, Format::Png)] {
                    file.attributes.insert(FRAME_SETTINGS.to_owned(), Attribute::Text(frame.text(format)));
                }
            }
            Ok::<_, PictureError>((whole, shown))
        });
        match made {
            Err(error) => failure.add(Failure::run(Report::from_err(error))),
            Ok((whole, shown)) => {
                for output in pictures {
                    let file = if output.format == Format::Png { &shown } else { &whole };
                    match output::write(output, file, self.developing) {
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

    fn film_file<'f>(&'f self, film: &'f Film, tiles: &'f [PixelRect]) -> FilmFile<'f> {
        FilmFile {
            film,
            subject: &self.header.subject,
            channels: &self.header.channels,
            tiles,
            features: self.features,
            object_names: self.header.object_names.as_deref(),
            samples: self.samples,
            seconds: self.header.seconds,
            error: self.error,
            unfinished: self.unfinished(),
        }
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
}
