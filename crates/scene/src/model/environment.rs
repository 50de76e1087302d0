//! Images of everything around a scene.

use std::sync::Arc;

use etalon_optics::Spectrum;

use crate::texture::Image;

/// How directions stand in an image of everything around. With f, r and u for `forward`, `right` and `up` of an
/// [`EnvironmentImage`]:
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnvironmentProjection {
    /// The direction d stands at the share ½ + atan2(d·r, d·f)/2π of the width from the left, and at the share acos(d·u)/π of the
    /// height from the top. Between the centres of its texels the image is interpolated linearly, across its left and right
    /// edge too; beyond the centres of its first and last row it is constant along each meridian.
    LatitudeLongitude,
    /// The same, but for its rows: the centres of the first lie at the upper pole, those of the last at the lower. At least two
    /// rows.
    LatitudeLongitudeAtPoles,
    /// A square after Clarberg (2008), every texel of which is the same solid angle and shows its own colour: its middle shows u, its
    /// corners −u, the middle of its right edge r, that of its lower edge f.
    EqualArea,
}

/// Radiance from infinity by the colours of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentImage {
    /// The image; no texel is negative.
    pub image: Arc<Image>,
    /// Its file, as the scene names it.
    pub name: String,
    /// How directions stand in it.
    pub projection: EnvironmentProjection,
    /// Unit vector; by longitude and latitude shown in the middle of the image.
    pub forward: [f64; 3],
    /// Unit vector; by longitude and latitude shown a quarter of the width to the right of that. At right angles to both others, of
    /// either hand.
    pub right: [f64; 3],
    /// Unit vector; by longitude and latitude that of the upper edge.
    pub up: [f64; 3],
    /// Radiance that a texel (1, 1, 1) stands for, W·m⁻²·sr⁻¹·nm⁻¹. The three primaries are parts of it that add up to it.
    pub white: Spectrum,
}

impl EnvironmentImage {
    /// Whether no light comes from it.
    pub fn is_zero(&self) -> bool {
        self.white.is_zero() || self.image.most() == [0.0; 3]
    }
}
