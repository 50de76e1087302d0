//! Images of everything around a scene.

use std::sync::Arc;

use etalon_optics::Spectrum;

use crate::texture::Image;

/// Radiance from infinity by the colours of an image: longitude along its rows, latitude along its columns.
///
/// With f, r and u for `forward`, `right` and `up`, the direction d stands at the share ½ + atan2(d·r, d·f)/2π of the width
/// from the left, and at the share acos(d·u)/π of the height from the top. Between the centres of its texels the image is
/// interpolated linearly, across its left and right edge too; beyond the centres of its first and last row it is constant
/// along each meridian.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentImage {
    /// The image; no texel is negative.
    pub image: Arc<Image>,
    /// Its file, as the scene names it.
    pub name: String,
    /// Unit vector shown in the middle of the image.
    pub forward: [f64; 3],
    /// Unit vector shown a quarter of the width to the right of that.
    pub right: [f64; 3],
    /// Unit vector of the upper edge.
    pub up: [f64; 3],
    /// Radiance that a texel (1, 1, 1) stands for, W·m⁻²·sr⁻¹·nm⁻¹. The three primaries are parts of it that add up to it.
    pub white: Spectrum,
}

impl EnvironmentImage {
    /// Whether no light comes from it.
    pub fn is_zero(&self) -> bool {
        self.white.is_zero() || self.image.linear_texels().all(|texel| texel == [0.0; 3])
    }
}
