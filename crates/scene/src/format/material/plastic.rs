//! Coated diffuse surfaces.

use super::super::detail::RoughnessImageForm;
use super::super::spectra::{Role, Spectra};
use super::super::spectrum::SpectrumForm;
use super::roughness::{RoughnessKeys, roughness, roughness_keys};
use super::tint::tint;
use super::{Alpha, IndexForm, MaterialSides, MultipleScattering, Width, index, least};
use crate::files::Files;
use crate::json::{Code, Optional, Reader, Required, Rule, Spanned};
use crate::model::{FacetDistribution, FacetMasking, InternalReflection, MaterialKind};
use etalon_optics::Spectrum;

crate::record! {
    /// A diffuse ground under a clear coat, seen from vacuum, on both sides unless "sides" says otherwise.
    pub(crate) struct PlasticMaterial + comment {
        /// Share of light that the ground reflects, from 0 to 1.
        reflectance: Required<SpectrumForm>,
        /// Index of the coat.
        coat: Required<IndexForm> = "1.5",
        /// Roughness of the coat: the width α of the distribution of facet normals, 0 (smooth) or from 0.0001 to 1.
        alpha: Required<Spanned<Alpha>> = "0",
        /// Instead: the coat's width along the tangent, the direction in which u grows, from 0.0001 to 1.
        alpha_u: Optional<Width>,
        /// And the width across the tangent, from 0.0001 to 1.
        alpha_v: Optional<Width>,
        /// By how much the tangent is turned from growing u toward growing v, degrees.
        tangent_rotation_deg: Optional<f64>,
        /// Instead: an image that says the coat's width at each place.
        roughness_image: Optional<RoughnessImageForm>,
        /// How the slopes of facets are distributed.
        distribution: Required<FacetDistribution> = r#""ggx""#,
        /// How facets hide each other from reflected light.
        masking: Required<FacetMasking> = r#""correlated""#,
        /// Whether the base colours light each time that the coat reflects it back down ("coloured") or only once ("uncoloured"), or whether
        /// that light is lost ("lost").
        internal_reflection: Required<InternalReflection> = r#""coloured""#,
        /// What becomes of light that facets of a rough coat hide from where it goes. It enters the base ("compensated"), or is lost ("lost"),
        /// as in other renderers. Facets of two widths lose none.
        multiple_scattering: Required<MultipleScattering> = r#""compensated""#,
        /// Share of the light that the coat reflects, from 0 to 1, that is left; all if left out. The ground is not tinted.
        reflected_tint: Optional<SpectrumForm>,
        /// Which sides reflect; another is black.
        sides: Required<MaterialSides> = r#""both""#,
    } with [
        Rule::NotBoth("alpha", "roughness_image"),
        Rule::NotBoth("alpha", "alpha_u"),
        Rule::NotBoth("alpha_u", "roughness_image"),
        Rule::Needs("alpha_u", &["alpha_v"]),
        Rule::Needs("alpha_v", &["alpha_u"]),
        Rule::Needs("tangent_rotation_deg", &["alpha_u"]),
    ]
}

crate::keywords!(InternalReflection {
    /// Each reflection colours it: ρ/(1 − ρ rᵢ).
    "coloured" => Self::Coloured,
    /// As if the base were white from the second time on, as other renderers have it: ρ/(1 − rᵢ).
    "uncoloured" => Self::Uncoloured,
    /// It is lost. Light goes in and out as through a smooth coat, each time once: T(µₒ) T(µᵢ) ρ/π.
    "lost" => Self::Lost,
});

/// The material of a form.
pub(super) fn plastic<'f>(
    plastic: &'f PlasticMaterial,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    let reflectance =
        plastic.reflectance.as_ref().and_then(|form| spectra.resolve_texture(form, Role::Reflectance, files, reader));
    let coat = plastic.coat.as_ref().and_then(|form| index(form, spectra.range_nm, reader));
    let roughness = roughness(&roughness_keys!(plastic), files, reader);
    let tint = match plastic.reflected_tint.is_present() {
        true => tint(&plastic.reflected_tint, spectra, files, reader).map(Some),
        false => Some(None),
    };
    let (reflectance, coat, roughness, tint) = (reflectance?, coat?, roughness?, tint?);
    let internal_reflection = plastic.internal_reflection?;
    let compensated = plastic.multiple_scattering? == MultipleScattering::Compensated;
    if !compensated && internal_reflection == InternalReflection::Lost {
        let message =
            "facets hide no light from a base whose \"internal_reflection\" is \"lost\": it sees a smooth coat";
        reader.error_hint(Code::KeyConflict, plastic.at.head(), message, "leave \"multiple_scattering\" out");
        return None;
    }
    if !compensated && roughness.has_two_widths() {
        let message = "what facets of two widths hide cannot be lost in a coat";
        let hint = "leave \"multiple_scattering\" out, or give one width \"alpha\"";
        reader.error_hint(Code::KeyConflict, plastic.at.head(), message, hint);
        return None;
    }
    // As in glass from inside: where total reflection begins, tables of two widths cannot say.
    if roughness.has_two_widths() && spectra.range_nm.is_some_and(|range_nm| least(&coat, range_nm) < 1.0) {
        let message = "a coat of two widths must have an index of at least 1";
        let hint = "give one width \"alpha\"";
        reader.error_hint(Code::OutOfRange, plastic.at.head(), message, hint);
        return None;
    }
    let kind = roughness.material(|facets| {
        let (reflectance, coat) = (reflectance.clone(), coat.clone());
        let kind = MaterialKind::Plastic { reflectance, coat, facets, internal_reflection, compensated };
        match &tint {
            None => kind,
            Some(tint) => MaterialKind::Tinted {
                kind: Box::new(kind),
                reflected: tint.clone(),
                transmitted: Spectrum::Constant(1.0).into(),
            },
        }
    });
    Some(plastic.sides?.of(kind))
}
