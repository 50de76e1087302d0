//! How a picture is developed: the words of `etalon develop`, from the query of an address. A white that was picked is a colour, not a
//! patch of pixels: it holds for coarse pictures and for other views as well.

use etalon_picture::develop::{Exposure, MAX_STOPS, Settings, ToneCurve, White, WhiteBalance};
use serde::Deserialize;

/// Before the chromaticity of a white.
const CHROMATICITY: &str = "xy:";

/// A look, as a page asks for it. What is left out is as in `etalon develop`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
pub(crate) struct Look {
    /// Stops, or `auto`.
    #[serde(default)]
    pub exposure: String,
    /// `none`, a light, a temperature such as `3200K`, or a chromaticity such as `xy:0.3127,0.329`.
    #[serde(default)]
    pub white: String,
    /// `linear`, `filmic` or `agx`.
    #[serde(default)]
    pub curve: String,
}

impl Look {
    /// The settings of [`etalon_picture::develop`].
    ///
    /// # Errors
    /// A sentence that says what a value may be.
    pub(crate) fn settings(&self) -> Result<Settings, String> {
        let exposure = match self.exposure.as_str() {
            "" => Exposure::Stops(0.0),
            "auto" => Exposure::Auto,
            text => {
                let stops = text.parse().ok().filter(|stops: &f64| stops.abs() <= MAX_STOPS);
                Exposure::Stops(stops.ok_or("the exposure is a number of stops, or `auto`")?)
            }
        };
        let white_balance = match self.white.as_str() {
            "" | "none" => WhiteBalance::None,
            text => WhiteBalance::Light(match text.strip_prefix(CHROMATICITY) {
                Some(xy) => White::Chromaticity(
                    chromaticity(xy).ok_or("a chromaticity is x,y with x, y and x + y from 0 to 1")?,
                ),
                None => White::named(text)?,
            }),
        };
        let curve = match self.curve.as_str() {
            "" | "linear" => ToneCurve::Linear,
            "filmic" => ToneCurve::Filmic,
            "agx" => ToneCurve::Agx,
            _ => return Err("the curve is linear, filmic or agx".to_owned()),
        };
        Ok(Settings { exposure, white_balance, curve, ..Settings::default() })
    }

    /// The look in words.
    pub(crate) fn as_text(&self) -> String {
        let or = |text: &str, otherwise: &str| if text.is_empty() { otherwise.to_owned() } else { text.to_owned() };
        let Self { exposure, white, curve } = self;
        format!("exposure {}, white balance {}, curve {}", or(exposure, "0"), or(white, "none"), or(curve, "linear"))
    }
}

fn chromaticity(text: &str) -> Option<[f64; 2]> {
    let (x, y) = text.split_once(',')?;
    let [x, y] = [x.parse::<f64>().ok()?, y.parse::<f64>().ok()?];
    (x >= 0.0 && y > 0.0 && x + y <= 1.0).then_some([x, y])
}

/// The white of a look that makes this chromaticity white.
pub(crate) fn white_of_chromaticity([x, y]: [f64; 2]) -> String {
    format!("{CHROMATICITY}{x:.5},{y:.5}")
}

/// A PNG of 8-bit RGB, packed fast rather than small: it goes to a page on this machine.
pub(crate) fn fast_png(width: usize, height: usize, pixels: &[u8]) -> Vec<u8> {
    let side = |pixels: usize| u32::try_from(pixels).unwrap_or(0);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(width), side(height));
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fastest);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    // Writing to memory fails only for sizes that PNG does not know; there is no picture then.
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    if written.is_err() {
        bytes.clear();
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(exposure: &str, white: &str, curve: &str) -> Result<Settings, String> {
        Look { exposure: exposure.to_owned(), white: white.to_owned(), curve: curve.to_owned() }.settings()
    }

    #[test]
    fn looks_are_those_of_develop() {
        assert_eq!(look("", "", ""), Ok(Settings::default()));
        let settings = look("-1.5", "3200K", "agx").unwrap();
        assert_eq!((settings.exposure, settings.curve), (Exposure::Stops(-1.5), ToneCurve::Agx));
        assert_eq!(settings.white_balance, WhiteBalance::Light(White::Temperature(3200.0)));
        assert_eq!(look("auto", "none", "filmic").unwrap().exposure, Exposure::Auto);
        let xy = [0.4476, 0.4074];
        assert_eq!(
            look("", &white_of_chromaticity(xy), "").unwrap().white_balance,
            WhiteBalance::Light(White::Chromaticity(xy))
        );
        for (exposure, white, curve) in [
            ("x", "", ""),
            ("nan", "", ""),
            ("1e9", "", ""),
            ("", "lamp", ""),
            ("", "xy:0.3", ""),
            ("", "xy:0.3,0", ""),
            ("", "xy:0.7,0.4", ""),
            ("", "xy:nan,0.3", ""),
            ("", "", "log"),
        ] {
            assert!(look(exposure, white, curve).is_err(), "{exposure} {white} {curve}");
        }
    }

    #[test]
    fn fast_pngs_hold_their_pixels() {
        let pixels: Vec<u8> = (0..60).collect();
        let bytes = fast_png(5, 4, &pixels);
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        let mut read = vec![0; 60];
        reader.next_frame(&mut read).unwrap();
        assert_eq!(read, pixels);
    }
}
