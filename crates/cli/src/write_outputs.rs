//! A film as files: the same for a picture that was rendered here and for one that was merged from parts.

use etalon_optics::colour;
use etalon_picture::{
    Attribute, Attributes, ERROR_PREFIX, ErrorInfo, ExrFile, Picture, PictureError, RenderInfo, Window,
};
use etalon_transport::accuracy::Region;
use etalon_transport::{Band, Canvas, Features, Film, ImageError, Pixel, PixelRect};
use miette::Report;

use crate::channels::{Aov, Channels};
use crate::developing::Developing;
use crate::failure::Failure;
use crate::output::{self, Format, Output, Written};
use crate::state::{self, Header, KeptBands};

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
            let (picture, attributes) = self.contents(film, &tiles)?;
            let shown = ExrFile { picture: self.shown(film, &tiles)?, attributes: attributes.clone() };
            Ok::<_, PictureError>((ExrFile { picture, attributes }, shown))
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

    fn contents(&self, film: &Film, tiles: &[PixelRect]) -> Result<(Picture<f32>, Attributes), PictureError> {
        let (mut picture, mut attributes) = (self.picture(film, tiles, &self.header.channels)?, self.attributes(film)?);
        if self.header.channels.has(Aov::Stokes) {
            crate::stokes::add(&mut picture, &mut attributes, film, self.header.subject.crop)?;
        }
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
        if subject.bands.is_some() {
            let text = |text: &str| Attribute::Text(text.to_owned());
            attributes.extend([
                ("spectralLayoutVersion".to_owned(), text("1.0")),
                // The only unit that the layout knows; each channel is a mean over its band, per nanometre.
                ("emissiveUnits".to_owned(), text("W.m^-2.sr^-1")),
                ("emissiveDensity".to_owned(), text("nm^-1")),
                ("EV".to_owned(), Attribute::Float(0.0)),
            ]);
        }
        let [to_camera, to_ndc] = subject.matrices;
        attributes.insert("worldToCamera".to_owned(), Attribute::Matrix4(to_camera));
        attributes.insert("worldToNDC".to_owned(), Attribute::Matrix4(to_ndc));
        if let Some(names) = &self.header.object_names {
            let names = serde_json::to_string(names).expect("names are text");
            attributes.insert("objectNames".to_owned(), Attribute::Text(names));
        }
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

    /// An empty picture of the rendered part of the frame.
    fn frame(&self, film: &Film) -> Result<Picture<f32>, PictureError> {
        let rect = self.header.subject.crop;
        let window = Window {
            origin_px: [rect.x0 as i32, rect.y0 as i32],
            frame_px: [film.width() as usize, film.height() as usize],
        };
        Picture::new((rect.x1 - rect.x0) as usize, (rect.y1 - rect.y0) as usize)?.in_frame(window)
    }

    /// What a PNG is made from.
    fn shown(&self, film: &Film, tiles: &[PixelRect]) -> Result<Picture<f32>, PictureError> {
        if self.developing.needs_all_channels() {
            self.picture(film, tiles, &Channels::default())
        } else {
            self.colour(film)
        }
    }

    /// The colour alone.
    fn colour(&self, film: &Film) -> Result<Picture<f32>, PictureError> {
        let mut picture = self.frame(film)?;
        let pixels = self.of_pixels(film, |pixel| pixel.linear_rec709());
        insert_three(&mut picture, ["R", "G", "B"], &pixels)?;
        Ok(picture)
    }

    fn of_pixels<T>(&self, film: &Film, of: impl Fn(Pixel<'_>) -> T) -> Vec<T> {
        self.header.subject.crop.pixels().map(|(x, y)| of(film.pixel(x, y))).collect()
    }

    /// Every channel that is wanted; `tiles` are those of the features.
    fn picture(&self, film: &Film, tiles: &[PixelRect], channels: &Channels) -> Result<Picture<f32>, PictureError> {
        let rect = self.header.subject.crop;
        let mut picture = if channels.has(Aov::Color) { self.colour(film)? } else { self.frame(film)? };
        let variances = self.of_pixels(film, |pixel| match pixel.variance(colour::rec709_from_xyz) {
            Some((variance, _)) => variance,
            None => [f64::INFINITY; 3],
        });
        // Where nothing at all is known there is nothing to say.
        if variances.iter().any(|variance| variance[0].is_finite()) {
            for (aov, prefix, of) in SPREADS {
                if channels.has(aov) {
                    let values: Vec<[f32; 3]> = variances.iter().map(|v| v.map(|v| of(v) as f32)).collect();
                    let names = ["R", "G", "B"].map(|name| format!("{prefix}{name}"));
                    insert_three(&mut picture, names.each_ref().map(String::as_str), &values)?;
                }
            }
        }
        if let Some(bands) = self.header.subject.bands.as_ref().filter(|_| channels.has(Aov::Bands)) {
            for parameter in 0..self.header.subject.stokes_parameters() {
                insert_bands(&mut picture, (bands, parameter), film, rect, channels)?;
            }
        }
        let counts = self.of_pixels(film, |pixel| pixel.count() as f32);
        if channels.has(Aov::Samples) || !channels_only_features(channels) && counts.iter().any(|&c| c != counts[0]) {
            picture.insert(SAMPLES, counts)?;
        }
        if !self.features.is_empty() {
            self.insert_features(&mut picture, tiles, channels)?;
        }
        Ok(picture)
    }

    /// What the pixels meet first.
    fn insert_features(
        &self,
        picture: &mut Picture<f32>,
        tiles: &[PixelRect],
        channels: &Channels,
    ) -> Result<(), PictureError> {
        let rect = self.header.subject.crop;
        // Pixels of tiles that are not here meet nothing.
        let mut all = vec![Features::default(); rect.area() as usize];
        for (tile, features) in tiles.iter().zip(self.features) {
            for ((x, y), features) in tile.pixels().zip(features) {
                all[(y - rect.y0) as usize * (rect.x1 - rect.x0) as usize + (x - rect.x0) as usize] = *features;
            }
        }
        let three = |of: fn(&Features) -> [f32; 3]| -> Vec<[f32; 3]> { all.iter().map(of).collect() };
        let one = |of: fn(&Features) -> f32| -> Vec<f32> { all.iter().map(of).collect() };
        if channels.has(Aov::Albedo) {
            insert_three(picture, ["Albedo.R", "Albedo.G", "Albedo.B"], &three(|f| f.albedo))?;
        }
        if channels.has(Aov::Normal) {
            insert_three(picture, ["N.X", "N.Y", "N.Z"], &three(|f| f.normal))?;
        }
        if channels.has(Aov::Position) {
            insert_three(picture, ["P.X", "P.Y", "P.Z"], &three(|f| f.position_m))?;
        }
        if channels.has(Aov::Depth) {
            picture.insert("Z", one(|f| f.depth_m))?;
        }
        if channels.has(Aov::Uv) {
            picture.insert("u", one(|f| f.uv[0]))?;
            picture.insert("v", one(|f| f.uv[1]))?;
        }
        if channels.has(Aov::Object) {
            picture.insert("ObjectId", one(|f| f.object))?;
        }
        Ok(())
    }
}

/// How a variance is told: of which wish, under which prefix, as which function of it.
type Spread = (Aov, &'static str, fn(f64) -> f64);

const SPREADS: [Spread; 2] = [(Aov::Error, ERROR_PREFIX, f64::sqrt), (Aov::Variance, "Variance.", |variance| variance)];

/// Whether nothing of the picture itself is wanted.
fn channels_only_features(channels: &Channels) -> bool {
    ![Aov::Color, Aov::Error, Aov::Variance, Aov::Bands, Aov::Stokes].into_iter().any(|aov| channels.has(aov))
}

fn insert_three(picture: &mut Picture<f32>, names: [&str; 3], pixels: &[[f32; 3]]) -> Result<(), PictureError> {
    for (index, name) in names.into_iter().enumerate() {
        picture.insert(name, pixels.iter().map(|pixel| pixel[index]).collect())?;
    }
    Ok(())
}

/// The bands as spectral channels (Fichet, Pacanowski & Wilkie 2021, *An OpenEXR Layout for Spectral Images*): `S0.550,000000nm`
/// is the mean radiance over the band with this centre, `Error.` and `samples.` before it its standard error and its number of
/// wavelengths. `S1.550,000000nm` and so on are the other Stokes parameters, of the same wavelengths.
fn insert_bands(
    picture: &mut Picture<f32>,
    (bands, parameter): (&KeptBands, u32),
    film: &Film,
    rect: PixelRect,
    channels: &Channels,
) -> Result<(), PictureError> {
    for index in 0..bands.count {
        let name = spectral_channel(parameter, bands.centre_nm(index));
        let of = |value: fn(Band) -> f64| -> Vec<f32> {
            rect.pixels().map(|(x, y)| value(bands.of_pixel(film, x, y, parameter, index)) as f32).collect()
        };
        picture.insert(&name, of(|band| band.radiance))?;
        if channels.has(Aov::Error) {
            picture.insert(&format!("{ERROR_PREFIX}{name}"), of(|band| band.error))?;
        }
        if channels.has(Aov::Variance) {
            picture.insert(&format!("Variance.{name}"), of(|band| band.error * band.error))?;
        }
        if parameter == 0 {
            picture.insert(&format!("{SAMPLES}.{name}"), of(|band| f64::from(band.count)))?;
        }
    }
    Ok(())
}

/// The name of the channel of a Stokes parameter in a band: its centre with a decimal comma, in nm.
fn spectral_channel(parameter: u32, centre_nm: f64) -> String {
    format!("S{parameter}.{}nm", format!("{centre_nm:.6}").replace('.', ","))
}

/// The channel of the number of finite samples of each pixel.
const SAMPLES: &str = "samples";

/// What the file says about the error of its picture.
fn error_info(film: &Film, error: &ImageError) -> ErrorInfo {
    ErrorInfo {
        replicates: film.replicates(),
        correlated_pixels: film.correlated_pixels(),
        relative_rmse: error.relative_rmse,
        interval: error.interval,
        tail_index: error.tail_index,
        noisiest_tile: error.noisiest.map(|Region { rect, .. }| [rect.x0, rect.x1, rect.y0, rect.y1]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spectral_channels_are_named_with_a_comma() {
        assert_eq!(spectral_channel(0, 550.0), "S0.550,000000nm");
        assert_eq!(spectral_channel(3, 400.25), "S3.400,250000nm");
    }
}
