//! How rough a surface is: a width of facets, or an image of widths.

use super::super::detail::{RoughnessImageForm, RoughnessQuantity, roughness_image};
use super::{Alpha, Width};
use crate::files::Files;
use crate::json::{Code, Optional, Reader, Spanned};
use crate::model::{FacetDistribution, FacetMasking, LEAST_ALPHA, MaterialKind, Microfacets, NumberTexture};
use crate::texture::ImageTexture;

/// Neighbouring widths of an image have roughnesses √α in this ratio. The peak of a highlight, in proportion to 1/α², is then at
/// most 0.6 % higher in a blend of two than at the width between them (0.8 % where the image says α, 1 % where it says α²), which
/// is less than a step of an image of eight bits makes.
const RATIO: f64 = 1.05;
/// The most widths that an image of roughness makes: from [`LEAST_ALPHA`] to 1, and a smooth one.
pub const MOST_WIDTHS: usize = 97;

/// Of what kind facets are, of any width.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    distribution: FacetDistribution,
    masking: FacetMasking,
}

impl Kind {
    /// Facets of the width `alpha`; 0 is smooth.
    fn of_width(self, alpha: f64) -> Option<Microfacets> {
        (alpha > 0.0).then(|| self.of_widths([alpha; 2], 0.0))
    }

    fn of_widths(self, alpha: [f64; 2], rotation_rad: f64) -> Microfacets {
        Microfacets { alpha, rotation_rad, distribution: self.distribution, masking: self.masking }
    }
}

/// How rough a surface is.
pub(super) enum Roughness {
    /// The same everywhere; `None` is smooth.
    Uniform(Option<Microfacets>),
    /// A number that says it, by an image, and what facets are but wide.
    Image(ImageTexture, RoughnessQuantity, Kind),
}

impl RoughnessQuantity {
    /// The number that says a roughness √α.
    fn of(self, roughness: f64) -> f64 {
        let alpha = roughness * roughness;
        match self {
            Self::Roughness => roughness,
            Self::Alpha => alpha,
            Self::AlphaSquared => alpha * alpha,
        }
    }
}

impl Roughness {
    /// Whether facets are wider along one direction than across it.
    pub(super) fn has_two_widths(&self) -> bool {
        matches!(self, Self::Uniform(Some(facets)) if facets.alpha[0] != facets.alpha[1])
    }

    /// Whether it is rough anywhere.
    pub(super) fn is_rough(&self) -> bool {
        !matches!(self, Self::Uniform(None))
    }

    /// The material, of what it is for facets of each width: a blend of the neighbours among some widths where an image says it.
    pub(super) fn material(self, of: impl Fn(Option<Microfacets>) -> MaterialKind) -> MaterialKind {
        match self {
            Self::Uniform(facets) => of(facets),
            Self::Image(texture, quantity, kind) => {
                let range = texture.image.linear_texels().map(|[texel, ..]| texel * texture.factor[0]);
                let [least, most] = range.fold([1.0_f64, 0.0], |[least, most], r| [least.min(r), most.max(r)]);
                let nodes = nodes(least, most, quantity).into_iter();
                let parts: Vec<_> = nodes.map(|r| (quantity.of(r), of(kind.of_width(r * r)))).collect();
                MaterialKind::Blend { parts, by: NumberTexture::Image(texture) }
            }
        }
    }
}

/// The roughnesses between which those lie that numbers from `least` to `most` say, increasing, at least two.
fn nodes(least: f64, most: f64, quantity: RoughnessQuantity) -> Vec<f64> {
    // Downward from 1, so that images share them.
    let rough =
        std::iter::successors(Some(1.0), |r| (*r > LEAST_ALPHA.sqrt()).then(|| (r / RATIO).max(LEAST_ALPHA.sqrt())));
    let mut all: Vec<f64> = rough.chain([0.0]).collect();
    all.reverse();
    // The last at or below the least, the first at or above the most.
    let first = all.partition_point(|r| quantity.of(*r) <= least).saturating_sub(1).min(all.len() - 2);
    let last = all.partition_point(|r| quantity.of(*r) < most).clamp(first + 1, all.len() - 1);
    all[first..=last].to_vec()
}

/// The keys of a form that say how rough it is.
pub(super) struct RoughnessKeys<'f> {
    pub alpha: Option<&'f Spanned<Alpha>>,
    /// Along the tangent and across it.
    pub widths: [&'f Optional<Width>; 2],
    pub rotation_deg: &'f Optional<f64>,
    pub image: &'f Optional<RoughnessImageForm>,
    pub distribution: Option<FacetDistribution>,
    pub masking: Option<FacetMasking>,
}

/// The keys of a form that say how rough it is.
macro_rules! roughness_keys {
    ($form:ident) => {
        roughness_keys!($form, $form.distribution, $form.masking)
    };
    ($form:ident, $distribution:expr, $masking:expr) => {
        RoughnessKeys {
            alpha: $form.alpha.as_ref(),
            widths: [&$form.alpha_u, &$form.alpha_v],
            rotation_deg: &$form.tangent_rotation_deg,
            image: &$form.roughness_image,
            distribution: $distribution,
            masking: $masking,
        }
    };
}

pub(super) use roughness_keys;

/// The roughness of a form.
pub(super) fn roughness(keys: &RoughnessKeys<'_>, files: &mut Files, reader: &mut Reader<'_>) -> Option<Roughness> {
    let kind = Kind { distribution: keys.distribution?, masking: keys.masking? };
    match (keys.image, keys.widths) {
        (Optional::Absent, [Optional::Absent, Optional::Absent]) => {
            width(keys.alpha, reader).map(|alpha| Roughness::Uniform(kind.of_width(alpha)))
        }
        (Optional::Absent, [Optional::Given(u), Optional::Given(v)]) => {
            let rotation_deg = keys.rotation_deg.clone().checked()?.unwrap_or(0.0);
            Some(Roughness::Uniform(Some(kind.of_widths([u.0, v.0], rotation_deg.to_radians()))))
        }
        (Optional::Given(image), _) => {
            roughness_image(image, files, reader).map(|(image, quantity)| Roughness::Image(image, quantity, kind))
        }
        // Reported where the keys were read.
        _ => None,
    }
}

/// A width of facets that can be rendered.
fn width(alpha: Option<&Spanned<Alpha>>, reader: &mut Reader<'_>) -> Option<f64> {
    let (alpha, at) = alpha.map(|alpha| (alpha.value.0, alpha.at))?;
    if alpha > 0.0 && alpha < LEAST_ALPHA {
        let message = format!("alpha {alpha} is below {LEAST_ALPHA}, the smallest roughness that can be rendered");
        reader.error_hint(Code::OutOfRange, at, message, "for a smooth surface use 0");
        return None;
    }
    Some(alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUANTITIES: [(RoughnessQuantity, f64); 3] = [
        // The excess of the chord of v^(−4), v^(−2) and v^(−1) over them, at a ratio of 1.05, 1.05² and 1.05⁴.
        (RoughnessQuantity::Roughness, 0.0063),
        (RoughnessQuantity::Alpha, 0.0073),
        (RoughnessQuantity::AlphaSquared, 0.0096),
    ];

    #[test]
    fn widths_between_nodes_lie_close_to_their_blend() {
        for (quantity, bound) in QUANTITIES {
            let all = nodes(0.0, 1.0, quantity);
            assert_eq!(all.len(), MOST_WIDTHS);
            assert_eq!(all[..2], [0.0, LEAST_ALPHA.sqrt()]);
            assert_eq!(all.last(), Some(&1.0));
            // The peak by the number, which is a power of the roughness.
            let power = quantity.of(2.0).log2();
            let peak = |v: f64| v.powf(-4.0 / power);
            let mut largest = 0.0_f64;
            for pair in all[1..].windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|r| quantity.of(r));
                for i in 1..16 {
                    let share = f64::from(i) / 16.0;
                    let v = a + share * (b - a);
                    let excess = ((1.0 - share) * peak(a) + share * peak(b)) / peak(v) - 1.0;
                    assert!((0.0..bound).contains(&excess), "{excess} at {v}");
                    largest = largest.max(excess);
                }
            }
            assert!(largest > 0.9 * bound, "{quantity:?}: {largest}");
        }
    }

    #[test]
    fn only_widths_that_an_image_has_are_made() {
        for (quantity, _) in QUANTITIES {
            for (least, most) in [(0.3, 0.3), (0.3, 0.4), (0.0, 0.0), (1.0, 1.0), (0.0, 0.01), (0.005, 0.2)] {
                let few: Vec<f64> = nodes(least, most, quantity).into_iter().map(|r| quantity.of(r)).collect();
                assert!(few.len() >= 2 && few.is_sorted_by(|a, b| a < b));
                assert!(few[0] <= least && few[few.len() - 1] >= most, "{least} {most}");
                let inner = &few[1..few.len() - 1];
                assert!(inner.iter().all(|r| (least..=most).contains(r)), "{few:?}");
            }
        }
    }
}
