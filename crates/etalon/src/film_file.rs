//! A film as the content of an EXR file: its channels, and what the file says of them.

use etalon_optics::colour;
use etalon_picture::expose::IMAGE_NUMERICAL_APERTURE;
use etalon_picture::{
    Attribute, Attributes, ERROR_PREFIX, ErrorInfo, ExrFile, Picture, PictureError, RenderInfo, Window,
};
use etalon_transport::accuracy::Region;
use etalon_transport::{Band, Features, Film, ImageError, Pixel, PixelRect};

use crate::channels::{Aov, Channels};
use crate::frame::{Frame, FrameRate};
use crate::subject::{KeptBands, Subject};

/// A film, with all that its file says of it.
#[derive(Clone, Debug)]
pub struct FilmFile<'a> {
    /// The pixels.
    pub film: &'a Film,
    /// What the picture is of.
    pub subject: &'a Subject,
    /// Which channels the file has.
    pub channels: &'a Channels,
    /// The rectangles of `features`.
    pub tiles: &'a [PixelRect],
    /// What the pixels of each tile meet first, row after row; empty where no channel wants it.
    pub features: &'a [Vec<Features>],
    /// Names of the objects, where a channel tells them apart.
    pub object_names: Option<&'a [String]>,
    /// Samples a pixel.
    pub samples: u32,
    /// Seconds that the render took.
    pub seconds: f64,
    /// The error of the picture, where something is known of it.
    pub error: Option<ImageError>,
    /// What the picture lacks, if it is a part of one or was interrupted.
    pub unfinished: Option<String>,
}

impl FilmFile<'_> {
    /// Channels and attributes of the EXR file.
    ///
    /// # Errors
    /// If the picture is larger than an EXR file can be.
    pub fn exr(&self) -> Result<ExrFile, PictureError> {
        let (mut picture, mut attributes) = (self.picture(self.channels)?, self.attributes()?);
        if self.channels.has(Aov::Stokes) {
            crate::stokes::add(&mut picture, &mut attributes, self.film, self.subject.crop)?;
        }
        Ok(ExrFile { picture, attributes })
    }

    /// What the file says beside its channels.
    fn attributes(&self) -> Result<Attributes, PictureError> {
        let subject = self.subject;
        let mut attributes = RenderInfo {
            software: subject.software.clone(),
            render_time_s: self.seconds,
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
        if let Some(Frame { number, rate: FrameRate([frames, seconds]) }) = subject.frame {
            attributes.insert("frame".to_owned(), Attribute::Text(number.to_string()));
            // Numerator and denominator, as OpenEXR's standard attribute has them.
            let bytes = [frames.to_le_bytes(), seconds.to_le_bytes()].concat();
            attributes.insert("framesPerSecond".to_owned(), Attribute::Other { kind: "rational".to_owned(), bytes });
        }
        let [to_camera, to_ndc] = subject.matrices;
        attributes.insert("worldToCamera".to_owned(), Attribute::Matrix4(to_camera));
        attributes.insert("worldToNDC".to_owned(), Attribute::Matrix4(to_ndc));
        if let Some(sine) = subject.image_numerical_aperture {
            attributes.insert(IMAGE_NUMERICAL_APERTURE.to_owned(), Attribute::Double(sine));
        }
        if let Some(names) = self.object_names {
            let names = serde_json::to_string(names).expect("names are text");
            attributes.insert("objectNames".to_owned(), Attribute::Text(names));
        }
        let approximations = subject.approximations();
        if !approximations.is_empty() {
            let text = Attribute::Text(format!("without {}", approximations.join("; without ")));
            attributes.insert("approximation".to_owned(), text);
        }
        if let Some(unfinished) = &self.unfinished {
            attributes.insert("unfinished".to_owned(), Attribute::Text(unfinished.clone()));
        }
        attributes
            .extend(self.error.as_ref().map(|error| error_info(self.film, error).attributes()).unwrap_or_default());
        Ok(attributes)
    }

    /// An empty picture of the rendered part of the frame.
    fn frame(&self) -> Result<Picture<f32>, PictureError> {
        let rect = self.subject.crop;
        let window = Window {
            origin_px: [rect.x0 as i32, rect.y0 as i32],
            frame_px: [self.film.width() as usize, self.film.height() as usize],
        };
        Picture::new((rect.x1 - rect.x0) as usize, (rect.y1 - rect.y0) as usize)?.in_frame(window)
    }

    /// The colour alone: `R`, `G`, `B`, linear Rec. 709.
    ///
    /// # Errors
    /// If the picture is larger than an EXR file can be.
    pub fn colour(&self) -> Result<Picture<f32>, PictureError> {
        let mut picture = self.frame()?;
        let pixels = self.of_pixels(|pixel| pixel.linear_rec709());
        insert_three(&mut picture, ["R", "G", "B"], &pixels)?;
        Ok(picture)
    }

    fn of_pixels<T>(&self, of: impl Fn(Pixel<'_>) -> T) -> Vec<T> {
        self.subject.crop.pixels().map(|(x, y)| of(self.film.pixel(x, y))).collect()
    }

    /// These channels, without those of polarisation.
    ///
    /// # Errors
    /// If the picture is larger than an EXR file can be.
    pub fn picture(&self, channels: &Channels) -> Result<Picture<f32>, PictureError> {
        let mut picture = if channels.has(Aov::Color) { self.colour()? } else { self.frame()? };
        let variances = self.of_pixels(|pixel| match pixel.variance(colour::rec709_from_xyz) {
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
        if let Some(bands) = self.subject.bands.as_ref().filter(|_| channels.has(Aov::Bands)) {
            for parameter in 0..self.subject.stokes_parameters() {
                self.insert_bands(&mut picture, bands, parameter, channels)?;
            }
        }
        let counts = self.of_pixels(|pixel| pixel.count() as f32);
        if channels.has(Aov::Samples) || !only_features(channels) && counts.iter().any(|&c| c != counts[0]) {
            picture.insert(SAMPLES, counts)?;
        }
        if !self.features.is_empty() {
            self.insert_features(&mut picture, channels)?;
        }
        Ok(picture)
    }

    /// What the pixels meet first.
    fn insert_features(&self, picture: &mut Picture<f32>, channels: &Channels) -> Result<(), PictureError> {
        let rect = self.subject.crop;
        // Pixels of tiles that are not here meet nothing.
        let mut all = vec![Features::default(); rect.area() as usize];
        for (tile, features) in self.tiles.iter().zip(self.features) {
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

    /// The bands as spectral channels (Fichet, Pacanowski & Wilkie 2021, *An OpenEXR Layout for Spectral Images*):
    /// `S0.550,000000nm` is the mean radiance over the band with this centre, `Error.` and `samples.` before it its standard error
    /// and its number of wavelengths. `S1.550,000000nm` and so on are the other Stokes parameters, of the same wavelengths.
    fn insert_bands(
        &self,
        picture: &mut Picture<f32>,
        bands: &KeptBands,
        parameter: u32,
        channels: &Channels,
    ) -> Result<(), PictureError> {
        for index in 0..bands.count {
            let name = spectral_channel(parameter, bands.centre_nm(index));
            let of = |value: fn(Band) -> f64| -> Vec<f32> {
                let pixels = self.subject.crop.pixels();
                pixels.map(|(x, y)| value(bands.of_pixel(self.film, x, y, parameter, index)) as f32).collect()
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
}

/// How a variance is shown: in which group of channels, under which prefix, as which function of it.
type Spread = (Aov, &'static str, fn(f64) -> f64);

const SPREADS: [Spread; 2] = [(Aov::Error, ERROR_PREFIX, f64::sqrt), (Aov::Variance, "Variance.", |variance| variance)];

/// Whether nothing of the picture itself is wanted.
fn only_features(channels: &Channels) -> bool {
    ![Aov::Color, Aov::Error, Aov::Variance, Aov::Bands, Aov::Stokes].into_iter().any(|aov| channels.has(aov))
}

fn insert_three(picture: &mut Picture<f32>, names: [&str; 3], pixels: &[[f32; 3]]) -> Result<(), PictureError> {
    for (index, name) in names.into_iter().enumerate() {
        picture.insert(name, pixels.iter().map(|pixel| pixel[index]).collect())?;
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
