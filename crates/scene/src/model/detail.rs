//! Images that give a surface detail without geometry.

use crate::texture::ImageTexture;

/// An image of how much of the light meets a surface at all.
#[derive(Clone, Debug, PartialEq)]
pub struct OpacityImage {
    /// Shares from 0 to 1, the same in each channel.
    pub texture: ImageTexture,
    /// Given, what is below it is not there and the rest is all there.
    pub cutoff: Option<f64>,
}

impl OpacityImage {
    /// The share at texture coordinates.
    #[inline]
    pub fn eval(&self, uv: [f64; 2]) -> f64 {
        let [share, ..] = self.texture.eval(uv);
        match self.cutoff {
            Some(cutoff) => f64::from(u8::from(share >= cutoff)),
            None => share,
        }
    }
}

/// Which of the two directions along the surface, across that in which u grows, the green of a normal map stands for. They differ
/// where texture coordinates are mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bitangent {
    /// The one in which v grows.
    AlongV,
    /// The one to the left of growing u, seen from outside: normal × tangent, in the world.
    AcrossU,
}

/// What becomes of light that a changed normal sends through the surface, or that comes from behind that normal's horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terminator {
    /// It is mirrored back: no light is lost.
    Mirrored,
    /// It is lost.
    Lost,
    /// It is lost, and grazing light is dimmed.
    Shadowed,
}

/// An image by which a surface scatters around other normals than its own.
#[derive(Clone, Debug, PartialEq)]
pub enum Relief {
    /// A normal map: channels c are the vector 2c − 1 in the frame of the direction in which u grows, the bitangent, and the normal.
    Normals {
        /// The image.
        texture: ImageTexture,
        /// Factors on the two components along the surface.
        strength: [f64; 2],
        /// Which way the second of them points.
        bitangent: Bitangent,
        /// What becomes of light at its horizon.
        terminator: Terminator,
    },
    /// A bump map: heights over the surface.
    Heights {
        /// The image; its first channel counts.
        texture: ImageTexture,
        /// Height of a channel of 1 over one of 0, m; below 0 the image is one of depths.
        height_m: f64,
        /// What becomes of light at its horizon.
        terminator: Terminator,
    },
}

impl Relief {
    /// Its image.
    pub fn texture(&self) -> &ImageTexture {
        match self {
            Self::Normals { texture, .. } | Self::Heights { texture, .. } => texture,
        }
    }

    /// What becomes of light at its horizon.
    pub fn terminator(&self) -> Terminator {
        match self {
            Self::Normals { terminator, .. } | Self::Heights { terminator, .. } => *terminator,
        }
    }
}
