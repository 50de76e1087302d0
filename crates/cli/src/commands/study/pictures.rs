//! The pictures of a study, for screens.

use etalon_optics::colour::rec709_from_xyz;
use etalon_picture::develop::auto_exposure;
use etalon_picture::{Picture, PictureError, encode_png, encode_srgb8};

use super::measure::SceneStudy;

/// The pictures of a scene as PNG files, all with one exposure.
pub(super) struct Pictures {
    /// In the order of [`SceneStudy::pictures`]: never empty.
    pub png: Vec<Vec<u8>>,
}

impl Pictures {
    /// Of a scene. The exposure is what suits the reference.
    pub(super) fn of(study: &SceneStudy) -> Result<Self, PictureError> {
        let reference = study.pictures.last().map_or(&[][..], |stage| &stage.xyz);
        // A picture without light is black under any exposure.
        let exposure = auto_exposure(reference.iter().map(|xyz| xyz[1])).unwrap_or(0.0);
        let [width, height] = [study.width, study.height].map(|side| side as usize);
        let png = |xyz: &[[f64; 3]]| {
            let rgb: Vec<[f64; 3]> = xyz.iter().map(|&xyz| rec709_from_xyz(xyz)).collect();
            let (shown, _) = encode_srgb8(&Picture::from_rgb(width, height, &rgb)?, exposure)?;
            encode_png(&shown, &[])
        };
        let png: Result<Vec<_>, PictureError> = study.pictures.iter().map(|stage| png(&stage.xyz)).collect();
        Ok(Self { png: png? })
    }

    /// The picture with the least noise.
    pub(super) fn reference(&self) -> &[u8] {
        &self.png[self.png.len() - 1]
    }
}
