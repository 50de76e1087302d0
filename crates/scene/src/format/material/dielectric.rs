//! Interfaces between two transparent media.

use super::super::detail::RoughnessImageForm;
use super::super::medium::{MediumForm, medium};
use super::super::spectra::{Role, Spectra};
use super::super::spectrum::SpectrumForm;
use super::index::{IndexForm, index};
use super::roughness::{Roughness, RoughnessKeys, roughness, roughness_keys};
use super::thin_film::{FilmLayerForm, thin_film};
use super::tint::tinted;
use super::{Alpha, Made, MultipleScattering, Width};
use crate::files::Files;
use crate::json::{Code, List, Optional, Positive, Reader, Required, Rule, Spanned, Whole};
use crate::model::{FacetDistribution, FacetMasking, MaterialKind, Medium};

crate::record! {
    /// Interface between two transparent media, with dispersion.
    pub(crate) struct DielectricMaterial + comment {
        /// Medium on the side that the surface normal points away from (inside a sphere or a closed mesh).
        interior: Required<IndexForm>,
        /// Medium on the side that the surface normal points into.
        exterior: Required<IndexForm> = "1",
        /// Roughness: the width α of the distribution of facet normals, 0 (smooth) or from 0.0001 to 1.
        alpha: Required<Spanned<Alpha>> = "0",
        /// Instead: the width along the tangent, the direction in which u grows, from 0.0001 to 1.
        alpha_u: Optional<Width>,
        /// And the width across the tangent, from 0.0001 to 1.
        alpha_v: Optional<Width>,
        /// By how much the tangent is turned from growing u toward growing v, degrees.
        tangent_rotation_deg: Optional<f64>,
        /// Instead: an image that says the width at each place.
        roughness_image: Optional<RoughnessImageForm>,
        /// How the slopes of facets are distributed.
        distribution: Required<FacetDistribution> = r#""ggx""#,
        /// How facets hide each other from reflected light.
        masking: Required<FacetMasking> = r#""correlated""#,
        /// For a rough surface, whether light that meets several facets is counted ("compensated") or lost ("lost"). The default is
        /// "compensated", of two widths or with a thin film "lost".
        multiple_scattering: Optional<Spanned<MultipleScattering>>,
        /// Layers between the two media, in which light interferes with itself: the first is met first from the exterior.
        thin_film: Optional<Spanned<List<FilmLayerForm>>>,
        /// Share of the light that it reflects, from 0 to 1, that is left; all if left out.
        reflected_tint: Optional<SpectrumForm>,
        /// Share of the light that it passes, from 0 to 1, that is left; all if left out.
        transmitted_tint: Optional<SpectrumForm>,
        /// For a closed solid that touches, overlaps or holds other solids: where several overlap, the one of the highest
        /// priority fills the place; of equal priorities, the object that comes later. It replaces `exterior`.
        priority: Optional<Whole<0, { u32::MAX as u64 }>>,
        /// Absorption coefficient σ of the interior, 1/m: over d metres e^(−σd) of the light is left.
        absorption_per_m: Optional<SpectrumForm>,
        /// Instead: the share of light that `transmittance_depth_m` of the interior let through, above 0 to 1.
        transmittance: Optional<SpectrumForm>,
        /// The depth at which `transmittance` holds, m.
        transmittance_depth_m: Optional<Positive>,
        /// Instead of an absorption: all that the interior does to light.
        medium: Optional<Box<MediumForm>>,
        /// What fills the exterior, as where an open surface parts two media. If left out, what fills the space around does.
        exterior_medium: Optional<Box<MediumForm>>,
    } with [
        Rule::NotBoth("alpha", "roughness_image"),
        Rule::NotBoth("alpha", "alpha_u"),
        Rule::NotBoth("alpha_u", "roughness_image"),
        Rule::Needs("alpha_u", &["alpha_v"]),
        Rule::Needs("alpha_v", &["alpha_u"]),
        Rule::Needs("tangent_rotation_deg", &["alpha_u"]),
        Rule::NotBoth("exterior", "priority"),
        Rule::NotBoth("exterior_medium", "priority"),
        Rule::NotBoth("roughness_image", "priority"),
        Rule::NotBoth("absorption_per_m", "transmittance"),
        Rule::NotBoth("absorption_per_m", "medium"),
        Rule::NotBoth("transmittance", "medium"),
        Rule::Needs("transmittance", &["transmittance_depth_m"]),
        Rule::Needs("transmittance_depth_m", &["transmittance"]),
    ]
}

/// The interface of a form, and what fills its interior.
pub(super) fn dielectric<'f>(
    form: &'f DielectricMaterial,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Made> {
    let interior = form.interior.as_ref().and_then(|form| index(form, spectra.range_nm, reader));
    let exterior = form.exterior.as_ref().and_then(|form| index(form, spectra.range_nm, reader));
    let roughness = roughness(&roughness_keys!(form), files, reader);
    let priority = form.priority.clone().checked()?.map(|priority| priority.0 as u32);
    let filling = interior_medium(form, spectra, files, reader);
    let around = match &form.exterior_medium {
        Optional::Given(form) => medium(form, spectra, files, reader).map(Some),
        _ => Some(None),
    };
    let film = thin_film(&form.thin_film, spectra.range_nm, files, reader);
    let (interior, exterior, roughness, film) = (interior?, exterior?, roughness?, film?);
    if film.is_some() && roughness.is_rough() && (interior == exterior || priority.is_some()) {
        // What a rough film would pass on between equal media goes straight on, which facets cannot say.
        let (message, hint) = match priority {
            None => ("a rough thin film between two equal media", "leave the roughness out"),
            Some(_) => (
                "a rough thin film on a dielectric with a priority",
                "leave the roughness out, or state the \"exterior\" instead of the \"priority\"",
            ),
        };
        reader.error_hint(Code::KeyConflict, form.at.head(), message, hint);
        return None;
    }
    let compensated = compensated(form, &roughness, film.is_some(), reader)?;
    let kind = roughness.material(|facets| {
        let (interior, exterior, film) = (interior.clone(), exterior.clone(), film.clone());
        match facets {
            None => MaterialKind::Dielectric { interior, exterior, priority, film },
            Some(facets) => MaterialKind::RoughDielectric { interior, exterior, facets, compensated, priority, film },
        }
    });
    let kind = tinted(kind, [&form.reflected_tint, &form.transmitted_tint], spectra, files, reader)?;
    let (medium, exterior_medium) = (filling?.map(Box::new), around?.map(Box::new));
    Some(Made { kind, medium, exterior_medium })
}

/// Whether light that meets several facets is counted. Of facets of two widths it cannot be, nor where a film reflects each wavelength and
/// each angle otherwise.
fn compensated(
    form: &DielectricMaterial,
    roughness: &Roughness,
    has_film: bool,
    reader: &mut Reader<'_>,
) -> Option<bool> {
    let stated = form.multiple_scattering.clone().checked()?;
    match stated {
        None => Some(!roughness.has_two_widths() && !has_film),
        Some(stated) if stated.value == MultipleScattering::Compensated && has_film && roughness.is_rough() => {
            let message = "light that meets several facets cannot be counted for a dielectric with a thin film";
            let hint = "leave \"multiple_scattering\" out, which is \"lost\" here";
            reader.error_hint(Code::KeyConflict, stated.at, message, hint);
            None
        }
        Some(stated) if stated.value == MultipleScattering::Compensated && roughness.has_two_widths() => {
            let message = "light that meets several facets cannot be counted for a dielectric of two widths";
            let hint = "leave \"multiple_scattering\" out, which is \"lost\" here, or give one width \"alpha\"";
            reader.error_hint(Code::KeyConflict, stated.at, message, hint);
            None
        }
        Some(stated) => Some(stated.value == MultipleScattering::Compensated),
    }
}

/// What fills a dielectric's interior; `Some(None)` if it is clear.
fn interior_medium<'f>(
    form: &'f DielectricMaterial,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Option<Medium>> {
    let absorption = match (&form.absorption_per_m, &form.transmittance, &form.medium) {
        (Optional::Absent, Optional::Absent, Optional::Absent) => return Some(None),
        (_, _, Optional::Given(form)) => return medium(form, spectra, files, reader).map(Some),
        (Optional::Given(coefficient), ..) => spectra.resolve(coefficient, Role::Coefficient, reader),
        (_, Optional::Given(share), _) => {
            let depth_m = form.transmittance_depth_m.given()?.0;
            let at = share.at().head();
            let share = spectra.resolve(share, Role::Reflectance, reader)?;
            spectra.absorption_of(&share, depth_m, at, reader)
        }
        _ => None,
    };
    absorption.map(|absorption| Some(Medium::absorbing(absorption)))
}
