//! How rough a surface is: a width of facets, or an image of widths.

use super::super::detail::{NumberImageForm, number_image};
use super::Alpha;
use crate::files::Files;
use crate::json::{Code, Optional, Reader, Spanned};
use crate::model::{LEAST_ALPHA, MaterialKind, NumberTexture};
use crate::texture::ImageTexture;

/// Neighbouring widths of an image have roughnesses √α in this ratio. The peak of a highlight, in proportion to 1/α², is then at
/// most 0.6 % higher in a blend of two than at the width between them, which is less than a step of an image of eight bits makes.
const RATIO: f64 = 1.05;
/// The most widths that an image of roughness makes: from [`LEAST_ALPHA`] to 1, and a smooth one.
pub(super) const MOST_WIDTHS: usize = 97;

/// How rough a surface is.
pub(super) enum Roughness {
    /// α, the same everywhere.
    Width(f64),
    /// √α, by an image.
    Image(ImageTexture),
}

impl Roughness {
    /// The material, of what it is for each width α: a blend of the neighbours among some widths where an image says it.
    pub(super) fn material(self, of: impl Fn(f64) -> MaterialKind) -> MaterialKind {
        match self {
            Self::Width(alpha) => of(alpha),
            Self::Image(texture) => {
                let range = texture.image.linear_texels().map(|[texel, ..]| texel * texture.factor[0]);
                let [least, most] = range.fold([1.0_f64, 0.0], |[least, most], r| [least.min(r), most.max(r)]);
                let parts: Vec<_> = nodes(least, most).into_iter().map(|r| (r, of(r * r))).collect();
                MaterialKind::Blend { parts, by: NumberTexture::Image(texture) }
            }
        }
    }
}

/// The roughnesses between which those from `least` to `most` lie, increasing, at least two.
fn nodes(least: f64, most: f64) -> Vec<f64> {
    // Downward from 1, so that images share them.
    let rough =
        std::iter::successors(Some(1.0), |r| (*r > LEAST_ALPHA.sqrt()).then(|| (r / RATIO).max(LEAST_ALPHA.sqrt())));
    let mut all: Vec<f64> = rough.chain([0.0]).collect();
    all.reverse();
    // The last at or below the least, the first at or above the most.
    let first = all.partition_point(|r| *r <= least).saturating_sub(1).min(all.len() - 2);
    let last = all.partition_point(|r| *r < most).clamp(first + 1, all.len() - 1);
    all[first..=last].to_vec()
}

/// The roughness of a form.
pub(super) fn roughness(
    alpha: Option<&Spanned<Alpha>>,
    image: &Optional<NumberImageForm>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Roughness> {
    match image {
        Optional::Absent => width(alpha, reader).map(Roughness::Width),
        Optional::Given(image) => number_image(image, files, reader).map(Roughness::Image),
        Optional::Invalid => None,
    }
}

/// A width of facets that can be rendered.
pub(super) fn width(alpha: Option<&Spanned<Alpha>>, reader: &mut Reader<'_>) -> Option<f64> {
    let (alpha, at) = alpha.map(|alpha| (alpha.value.0, alpha.at))?;
    if alpha > 0.0 && alpha < LEAST_ALPHA {
        let message = format!("a width of {alpha} is narrower than {LEAST_ALPHA}, the least that is rendered");
        reader.error_hint(Code::OutOfRange, at, message, "0 is smooth");
        return None;
    }
    Some(alpha)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_between_nodes_lie_close_to_their_blend() {
        let all = nodes(0.0, 1.0);
        assert_eq!(all.len(), MOST_WIDTHS);
        assert_eq!(all[..2], [0.0, LEAST_ALPHA.sqrt()]);
        assert_eq!(all.last(), Some(&1.0));
        let peak = |r: f64| r.powi(-4);
        for pair in all[1..].windows(2) {
            for i in 1..16 {
                let share = f64::from(i) / 16.0;
                let r = pair[0] + share * (pair[1] - pair[0]);
                let excess = ((1.0 - share) * peak(pair[0]) + share * peak(pair[1])) / peak(r) - 1.0;
                assert!((0.0..0.0063).contains(&excess), "{excess} at {r}");
            }
        }
    }

    #[test]
    fn only_widths_that_an_image_has_are_made() {
        for (least, most) in [(0.3, 0.3), (0.3, 0.4), (0.0, 0.0), (1.0, 1.0), (0.0, 0.01), (0.005, 0.2)] {
            let few = nodes(least, most);
            assert!(few.len() >= 2 && few.is_sorted_by(|a, b| a < b));
            assert!(few[0] <= least && few[few.len() - 1] >= most, "{least} {most}");
            let inner = &few[1..few.len() - 1];
            assert!(inner.iter().all(|r| (least..=most).contains(r)), "{few:?}");
        }
    }
}
