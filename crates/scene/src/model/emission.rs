//! What surfaces emit.

use crate::texture::ImageTexture;
use etalon_optics::Spectrum;

/// Diffuse emission of a surface: the same radiance in every direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Emitted radiance, W·m⁻²·sr⁻¹·nm⁻¹; with an image, that of white (1, 1, 1).
    pub radiance: Spectrum,
    /// Colours over the surface, 0 or above: shares of white in each of Rec. 709's primaries, as those of an [`EnvironmentImage`](super::EnvironmentImage).
    pub image: Option<ImageTexture>,
    /// Which sides emit.
    pub sides: EmissionSides,
}

impl Emission {
    /// Whether no place emits anything.
    pub fn is_zero(&self) -> bool {
        self.radiance.is_zero() || self.image.as_ref().is_some_and(ImageTexture::is_zero)
    }
}

/// Which sides of a surface emit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmissionSides {
    /// The side the surface normal points into.
    Front,
    /// The side the surface normal points away from (a room that is itself a lamp).
    Back,
    /// Both.
    Both,
}
