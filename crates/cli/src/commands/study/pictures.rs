//! The pictures of a study, for screens.

use std::ops::Range;

use etalon_optics::colour::rec709_from_xyz;
use etalon_picture::develop::auto_exposure;
use etalon_picture::{Picture, PictureError, encode_png, encode_srgb8};

use super::measure::SceneStudy;

/// The pictures of a scene as PNG files, all with one exposure.
pub(super) struct Pictures {
    /// The reference.
    pub reference: Vec<u8>,
    /// The middle of each of [`SceneStudy::pictures`]: half of its width and of its height.
    pub middles: Vec<Vec<u8>>,
}

impl Pictures {
    /// Of a scene. The exposure is what suits the reference.
    pub(super) fn of(study: &SceneStudy) -> Result<Self, PictureError> {
        let reference = study.pictures.last().map_or(&[][..], |stage| &stage.xyz);
        // A picture without light is black under any exposure.
        let exposure = auto_exposure(reference.iter().map(|xyz| xyz[1])).unwrap_or(0.0);
        let [width, height] = [study.width, study.height].map(|side| side as usize);
        let png = |xyz: &[[f64; 3]], [x, y]: [Range<usize>; 2]| {
            let rows = y.clone().map(|row| &xyz[row * width..][x.clone()]);
            let rgb: Vec<[f64; 3]> = rows.flatten().map(|&xyz| rec709_from_xyz(xyz)).collect();
            let (shown, _) = encode_srgb8(&Picture::from_rgb(x.len(), y.len(), &rgb)?, exposure)?;
            encode_png(&shown, &[])
        };
        let middle = [width, height].map(|side| side / 4..side - side / 4);
        let middles: Result<Vec<_>, PictureError> =
            study.pictures.iter().map(|stage| png(&stage.xyz, middle.clone())).collect();
        Ok(Self { reference: png(reference, [0..width, 0..height])?, middles: middles? })
    }
}
