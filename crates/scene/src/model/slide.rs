//! Slides: images that lamps at a point throw.

use super::{LightCone, LightKind};
use crate::texture::ImageTexture;

/// A lamp at a point with an image before it, such as a projector or a spot with a gobo. It sends nothing beside the image.
#[derive(Clone, Debug, PartialEq)]
pub struct SlideLight {
    /// The lamp: a point, a spot or a luminaire.
    pub lamp: LightKind,
    /// Unit vector from the lamp through the middle of the image.
    pub direction: [f64; 3],
    /// Unit vector toward the right edge of the image for who looks along `direction`.
    pub right: [f64; 3],
    /// Unit vector toward its upper edge.
    pub up: [f64; 3],
    /// Tangents of the angles between the middle and the right, and the upper edge.
    pub tangents: [f64; 2],
    /// What the image lets pass in each of Rec. 709's primaries; (0, 0) is its lower left corner, (1, 1) the upper right one.
    pub image: ImageTexture,
    /// What a white image lights evenly.
    pub even_on: EvenOn,
}

/// What a lamp lights evenly through a white slide, if it has the same intensity in every direction by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EvenOn {
    /// A flat screen across the direction of the slide: intensities are divided by cos³θ of the angle θ to it, as the lenses of projectors do.
    #[default]
    Screen,
    /// A sphere around the lamp: the slide changes intensities by its colours alone.
    Sphere,
}

impl SlideLight {
    /// The narrowest cone around its middle that holds the slide.
    pub(super) fn cone(&self) -> Option<LightCone> {
        let position_m = self.lamp.position_m()?;
        let [x, y] = self.tangents;
        Some(LightCone { position_m, axis: self.direction, half_angle_rad: x.hypot(y).atan() })
    }

    /// Whether it sends nothing.
    pub(super) fn is_zero(&self) -> bool {
        self.lamp.is_zero() || self.image.is_zero()
    }

    /// At most what the intensity of the lamp is multiplied by.
    pub(crate) fn most(&self) -> f64 {
        let largest = self.image.most().into_iter().fold(0.0, f64::max);
        let [x, y] = self.tangents;
        match self.even_on {
            EvenOn::Screen => largest * (1.0 + x * x + y * y).powf(1.5),
            EvenOn::Sphere => largest,
        }
    }
}
