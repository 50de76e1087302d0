//! Principled surfaces.

use super::super::detail::{NumberImageForm, RoughnessImageForm, number_image};
use super::super::spectra::{Role, Spectra};
use super::super::spectrum::SpectrumForm;
use super::roughness::{RoughnessKeys, roughness, roughness_keys};
use super::{Alpha, IndexForm, MaterialSides, Share, Width, index, least};
use crate::files::Files;
use crate::json::{Code, NonNegative, Optional, Reader, Required, Rule, Spanned};
use crate::model::{
    FacetDistribution, FacetMasking, LEAST_ALPHA, MaterialKind, Microfacets, NumberTexture, PrincipledLobes,
};
use std::ops::Bound;

crate::number! {
    /// A width of the facets of a clear coat: one that directions can resolve, below 1.
    pub(crate) struct CoatWidth in (Bound::Included(LEAST_ALPHA), Bound::Excluded(1.0));
}

crate::record! {
    /// The surface of films and games (Burley 2012): a diffuse base, metal, sheen and a clear coat, added up. It is no law of physics, and may
    /// give back more light than it gets.
    pub(crate) struct PrincipledMaterial + comment {
        /// The colour of the base: the share of light that it reflects, from 0 to 1.
        reflectance: Required<SpectrumForm>,
        /// Index of the surface, at least 1: how much it reflects as a dielectric.
        index: Required<Spanned<IndexForm>> = "1.5",
        /// Roughness: the width α of the distribution of facet normals, from 0.0001 to 1. Burley's roughness is √α.
        alpha: Required<Spanned<Alpha>> = "0.25",
        /// Instead: the width along the tangent, the direction in which u grows, from 0.0001 to 1.
        alpha_u: Optional<Width>,
        /// And the width across the tangent, from 0.0001 to 1.
        alpha_v: Optional<Width>,
        /// By how much the tangent is turned from growing u toward growing v, degrees.
        tangent_rotation_deg: Optional<f64>,
        /// Instead: an image that says the width at each place. Below 0.0001 the width is 0.0001.
        roughness_image: Optional<RoughnessImageForm>,
        /// Share of metal, from 0 to 1: it has no diffuse light, and reflects the colour of the base.
        metallic: Required<Share> = "0",
        /// Instead: an image of that share.
        metallic_image: Optional<NumberImageForm>,
        /// Share of what it reflects as a dielectric that has the colour of the base, from 0 to 1.
        specular_tint: Required<Share> = "0",
        /// Share of the diffuse light that comes as from below the surface, from 0 to 1.
        flatness: Required<Share> = "0",
        /// Light at grazing angles, as of cloth, at least 0.
        sheen: Required<NonNegative> = "0",
        /// Share of the sheen that has the colour of the base, from 0 to 1.
        sheen_tint: Required<Share> = "0",
        /// Strength of a clear coat, at least 0. Of strength 1 it reflects 0.04 of the light head-on.
        clear_coat: Required<NonNegative> = "0",
        /// Width α of the facets of the clear coat, from 0.0001 to below 1.
        clear_coat_alpha: Required<CoatWidth> = "0.1",
        /// Which sides reflect; another is black.
        sides: Required<MaterialSides> = r#""both""#,
    } with [
        Rule::NotBoth("alpha", "roughness_image"),
        Rule::NotBoth("alpha", "alpha_u"),
        Rule::NotBoth("alpha_u", "roughness_image"),
        Rule::Needs("alpha_u", &["alpha_v"]),
        Rule::Needs("alpha_v", &["alpha_u"]),
        Rule::Needs("tangent_rotation_deg", &["alpha_u"]),
        Rule::NotBoth("metallic", "metallic_image"),
    ]
}

/// The material of a form.
pub(super) fn principled<'f>(
    form: &'f PrincipledMaterial,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    let reflectance =
        form.reflectance.as_ref().and_then(|form| spectra.resolve_texture(form, Role::Reflectance, files, reader));
    let of_index = form.index.as_ref().and_then(|form| {
        let index = index(&form.value, spectra.range_nm, reader)?;
        let least = spectra.range_nm.map_or(1.0, |range_nm| least(&index, range_nm));
        if least < 1.0 {
            let message = format!("the index of a principled surface is {least}: it is at least 1");
            reader.error_hint(
                Code::OutOfRange,
                form.at,
                message,
                "a surface of index 1 reflects nothing as a dielectric",
            );
            return None;
        }
        Some(index)
    });
    if let Some(alpha) = &form.alpha
        && alpha.value.0 == 0.0
    {
        let hint = format!("the least is {LEAST_ALPHA}");
        reader.error_hint(Code::OutOfRange, alpha.at, "a principled surface cannot be smooth", hint);
        return None;
    }
    let (distribution, masking) = (Some(FacetDistribution::Ggx), Some(FacetMasking::Separable));
    let roughness = roughness(&roughness_keys!(form, distribution, masking), files, reader);
    let image = form.metallic_image.clone().checked()?.map(|form| number_image(&form, files, reader));
    let lobes = PrincipledLobes {
        metallic: form.metallic?.0,
        specular_tint: form.specular_tint?.0,
        flatness: form.flatness?.0,
        sheen: form.sheen?.0,
        sheen_tint: form.sheen_tint?.0,
        clear_coat: form.clear_coat?.0,
        clear_coat_alpha: form.clear_coat_alpha?.0,
    };
    let (reflectance, index, roughness) = (reflectance?, of_index?, roughness?);
    let image = match image {
        Some(image) => Some(image?),
        None => None,
    };
    let kind = roughness.material(|facets| {
        let smooth = || Microfacets {
            distribution: FacetDistribution::Ggx,
            masking: FacetMasking::Separable,
            ..LEAST_ALPHA.into()
        };
        let facets = facets.unwrap_or_else(smooth);
        let of = |metallic: f64| MaterialKind::Principled {
            reflectance: reflectance.clone(),
            index: index.clone(),
            facets,
            lobes: Box::new(PrincipledLobes { metallic, ..lobes }),
        };
        match &image {
            // Each lobe is linear in the share.
            Some(image) => MaterialKind::blend(of(0.0), of(1.0), NumberTexture::Image(image.clone())),
            None => of(lobes.metallic),
        }
    });
    Some(form.sides?.of(kind))
}
