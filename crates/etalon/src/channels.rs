//! What an EXR shows beside the picture, or instead of it.

use serde::{Deserialize, Serialize};

/// A group of channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Aov {
    /// `R`, `G`, `B`: the colour.
    Color,
    /// `Error.`: the standard error of each colour and band.
    Error,
    /// `Variance.`: the square of each standard error.
    Variance,
    /// `samples`: the number of finite samples of each pixel.
    Samples,
    /// `S0.…nm`: the spectral bands of the film. Polarised renders also have `S1.…nm` to `S3.…nm`.
    Bands,
    /// `S1.R` to `S3.B` and their errors: Stokes parameters, in polarised renders.
    Stokes,
    /// `Albedo.R/G/B`: the fraction of light that the first surface scatters.
    Albedo,
    /// `N.X/Y/Z`: the shading normal of the first surface in world space, toward the camera.
    Normal,
    /// `P.X/Y/Z`: the position of the first hit in world space, in metres.
    Position,
    /// `Z`: the depth of the first hit along the viewing direction, in metres.
    Depth,
    /// `u`, `v`: the texture coordinates of the first hit.
    Uv,
    /// `ObjectId`: the number of the first object. The attribute `objectNames` has the names.
    Object,
}

/// Which groups a file has.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Channels {
    /// What was asked for.
    also: Vec<Aov>,
    /// Whether nothing else is wanted.
    only: bool,
}

impl Channels {
    /// These, beside what every picture has or, with `only`, alone.
    pub fn new(also: &[Aov], only: bool) -> Self {
        Self { also: also.to_vec(), only }
    }

    /// Whether a group is wanted.
    pub fn has(&self, aov: Aov) -> bool {
        let of_every_picture = matches!(aov, Aov::Color | Aov::Error | Aov::Bands | Aov::Stokes);
        self.also.contains(&aov) || !self.only && of_every_picture
    }

    /// Whether any of them is of the first surface.
    pub fn has_features(&self) -> bool {
        [Aov::Albedo, Aov::Normal, Aov::Position, Aov::Depth, Aov::Uv, Aov::Object].into_iter().any(|aov| self.has(aov))
    }

    /// How many there are, of a film with this many bands and this many Stokes parameters.
    pub fn count(&self, bands: u64, parameters: u64) -> u64 {
        let of_bands = if self.has(Aov::Bands) { bands } else { 0 };
        let colours = 3 * u64::from(self.has(Aov::Color)) + (1 + parameters) * of_bands;
        let shown = 3 + parameters * of_bands;
        let errors = shown * (u64::from(self.has(Aov::Error)) + u64::from(self.has(Aov::Variance)));
        // The colours of S₁, S₂ and S₃, and their errors.
        let stokes = if self.has(Aov::Stokes) { 2 * 3 * (parameters - 1) } else { 0 };
        let of_features = |aov, count| count * u64::from(self.has(aov));
        colours
            + errors
            + stokes
            + 1
            + of_features(Aov::Albedo, 3)
            + of_features(Aov::Normal, 3)
            + of_features(Aov::Position, 3)
            + of_features(Aov::Depth, 1)
            + of_features(Aov::Uv, 2)
            + of_features(Aov::Object, 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_comes_beside_the_picture_or_alone() {
        let plain = Channels::default();
        assert!(plain.has(Aov::Color) && plain.has(Aov::Error) && plain.has(Aov::Bands) && !plain.has_features());
        let beside = Channels::new(&[Aov::Depth], false);
        assert!(beside.has(Aov::Color) && beside.has(Aov::Depth) && !beside.has(Aov::Normal) && beside.has_features());
        let alone = Channels::new(&[Aov::Depth, Aov::Variance], true);
        assert!(
            !alone.has(Aov::Color)
                && !alone.has(Aov::Error)
                && !alone.has(Aov::Stokes)
                && alone.has(Aov::Depth)
                && alone.has(Aov::Variance)
        );
    }
}
