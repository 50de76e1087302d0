//! Materials.

mod blend;
mod dielectric;
mod filled;
mod fluorescent;
mod grating;
mod index;
mod measured;
mod plastic;
mod principled;
mod roughness;
mod sheet;
mod thin_film;
mod tint;
mod translucent;
mod two_sided;

use etalon_optics::OutsideFit;

use std::ops::Bound;

use super::detail::{NumberImageForm, RoughnessImageForm};
use super::medium::{MediumForm, medium};
use super::scene::MaterialUse;
use super::spectra::{Role, Spectra};
use super::spectrum::{SpectrumForm, Wavelength};
use crate::files::Files;
use crate::json::{List, NonNegative, Optional, Positive, Reader, Required, Rule, Span, Spanned, Whole};
use crate::model::{FacetDistribution, FacetMasking, LEAST_ALPHA, Material, MaterialKind, Medium, Metal, Side};
pub(crate) use blend::Before;
pub use blend::MOST_BLEND_PARTS;
use blend::blend;
pub(crate) use dielectric::DielectricMaterial;
use dielectric::dielectric;
use filled::filled;
use fluorescent::{FluorescentMaterial, fluorescent};
use grating::{GratingMaterial, grating};
pub(super) use index::{IndexForm, index, least};
use index::{NamedMetal, complex_index, complex_keys};
use measured::{MeasuredMaterial, measured};
use plastic::{PlasticMaterial, plastic};
use principled::{PrincipledMaterial, principled};
pub use roughness::MOST_WIDTHS;
use roughness::{RoughnessKeys, roughness, roughness_keys};
use sheet::{PolariserMaterial, RetarderMaterial, polariser, retarder};
use thin_film::{FilmLayerForm, thin_film};
use tint::tinted;
use translucent::{TranslucentMaterial, translucent};
use two_sided::two_sided;

crate::record! {
    /// Ideal diffuse reflection, on both sides unless "sides" says otherwise.
    pub(crate) struct LambertMaterial + comment {
        /// Share of light reflected, from 0 to 1.
        reflectance: Required<SpectrumForm>,
        /// Which sides reflect; another is black.
        sides: Required<MaterialSides> = r#""both""#,
    }
}

crate::record! {
    /// Ideal mirror, on both sides unless "sides" says otherwise.
    pub(crate) struct MirrorMaterial + comment {
        /// Share of light reflected, from 0 to 1, the same at every angle.
        reflectance: Required<SpectrumForm> = "1",
        /// Which sides reflect; another is black.
        sides: Required<MaterialSides> = r#""both""#,
    }
}

crate::record! {
    /// Metal: Fresnel reflection from a complex index of refraction n + ik, seen from vacuum. The name of a metal, own values of
    /// n and k, or what it reflects head-on.
    pub(crate) struct ConductorMaterial + comment {
        /// A metal with built-in n and k: "Ag", "Au", "Cu" or "Al".
        metal: Optional<Spanned<NamedMetal>>,
        /// Wavelengths of own values, nm, increasing; at least two.
        wavelengths_nm: Optional<List<Spanned<Wavelength>>>,
        /// Real part n at each wavelength.
        n: Optional<List<Spanned<Positive>>>,
        /// Imaginary part k (extinction coefficient) at each wavelength.
        k: Optional<List<Spanned<NonNegative>>>,
        /// Share of light R reflected head-on, from 0 to 1 (0.9999 at most is), perhaps an image: n = 1, k = 2√(R/(1 − R)).
        reflectance: Optional<SpectrumForm>,
        /// What holds at wavelengths for which there are no values.
        outside_fit: Required<OutsideFit> = r#""error""#,
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
        /// For a rough surface, whether light that meets several facets is counted ("compensated") or lost ("lost").
        multiple_scattering: Required<MultipleScattering> = r#""compensated""#,
        /// Layers that coat it, in which light interferes with itself: from the outermost to the innermost.
        thin_film: Optional<Spanned<List<FilmLayerForm>>>,
        /// Share of the light that it reflects, from 0 to 1, that is left; all if left out.
        reflected_tint: Optional<SpectrumForm>,
        /// Which sides reflect; another is black.
        sides: Required<MaterialSides> = r#""both""#,
    } with [
        Rule::OneOf(&["metal", "wavelengths_nm", "reflectance"]),
        Rule::NotBoth("alpha", "roughness_image"),
        Rule::NotBoth("alpha", "alpha_u"),
        Rule::NotBoth("alpha_u", "roughness_image"),
        Rule::Needs("alpha_u", &["alpha_v"]),
        Rule::Needs("alpha_v", &["alpha_u"]),
        Rule::Needs("tangent_rotation_deg", &["alpha_u"]),
        Rule::Needs("wavelengths_nm", &["n", "k"]),
        Rule::Needs("n", &["wavelengths_nm"]),
        Rule::Needs("k", &["wavelengths_nm"]),
    ]
}

crate::number! {
    /// A width of a distribution of facets: 0 or a width that directions can resolve, at most 1.
    pub(crate) struct Alpha in (Bound::Included(0.0), Bound::Included(1.0));
}

crate::number! {
    /// A width of a distribution of facets: one that directions can resolve, at most 1.
    pub(crate) struct Width in (Bound::Included(LEAST_ALPHA), Bound::Included(1.0));
}

crate::number! {
    /// A share, from 0 to 1.
    pub(crate) struct Share in (Bound::Included(0.0), Bound::Included(1.0));
}

/// Which sides of a surface reflect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MaterialSides {
    Both,
    Front,
    Back,
}

crate::keywords!(MaterialSides {
    /// Both.
    "both" => Self::Both,
    /// The side that the surface normal points into.
    "front" => Self::Front,
    /// The side that the surface normal points away from.
    "back" => Self::Back,
});

impl MaterialSides {
    /// The material that reflects on these sides.
    fn of(self, kind: MaterialKind) -> MaterialKind {
        match self {
            Self::Both => kind,
            Self::Front => MaterialKind::one_sided(kind, Side::Front),
            Self::Back => MaterialKind::one_sided(kind, Side::Back),
        }
    }
}

crate::keywords!(FacetDistribution {
    /// Of Trowbridge and Reitz: long tails around a highlight.
    "ggx" => Self::Ggx,
    /// Beckmann's: a Gaussian of slopes, without tails.
    "beckmann" => Self::Beckmann,
});

crate::keywords!(FacetMasking {
    /// By their heights, as of a real surface.
    "correlated" => Self::Correlated,
    /// Each direction by itself, as some renderers have it: darker at grazing angles.
    "separable" => Self::Separable,
});

/// What becomes of light that meets several facets of a rough surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MultipleScattering {
    Compensated,
    Lost,
}

crate::keywords!(MultipleScattering {
    /// What single scattering loses comes back: by a diffuse lobe, or by the base below a coat.
    "compensated" => Self::Compensated,
    /// Single scattering only, as most renderers do: rough surfaces are too dark.
    "lost" => Self::Lost,
});

crate::record! {
    /// Rough diffuse reflection, on both sides unless "sides" says otherwise: chalk, clay, the moon.
    pub(crate) struct OrenNayarMaterial + comment {
        /// Albedo parameter, from 0 to 1: what a white surface multiplies at each bounce within its roughness.
        reflectance: Required<SpectrumForm>,
        /// Roughness, from 0 (as `lambert`) to 1.
        roughness: Required<Share>,
        /// Which sides reflect; another is black.
        sides: Required<MaterialSides> = r#""both""#,
    }
}

crate::record! {
    /// A pane of glass without thickness: mirrors light, or lets it pass straight on.
    pub(crate) struct ThinDielectricMaterial + comment {
        /// Index relative to what surrounds it.
        index: Required<IndexForm> = "1.5",
        /// Layers that coat both of its faces, in which light interferes with itself: from the outermost to the innermost. Their indices,
        /// too, are relative to what surrounds the pane.
        thin_film: Optional<Spanned<List<FilmLayerForm>>>,
        /// Share of the light that it reflects, from 0 to 1, that is left; all if left out.
        reflected_tint: Optional<SpectrumForm>,
        /// Share of the light that it passes, from 0 to 1, that is left; all if left out.
        transmitted_tint: Optional<SpectrumForm>,
    }
}

crate::record! {
    /// Two materials side by side, finer than can be seen.
    pub(crate) struct BlendMaterial + comment {
        /// The one: the name of one of "materials" that stands before this one, or a material of its own.
        first: Required<Box<MaterialUse>>,
        /// The other.
        second: Required<Box<MaterialUse>>,
        /// The other's share of the surface, from 0 to 1.
        weight: Optional<Share>,
        /// Instead: an image of that share.
        weight_image: Optional<NumberImageForm>,
    } with [
        Rule::OneOf(&["weight", "weight_image"]),
    ]
}

crate::record! {
    /// A surface whose sides differ. Neither lets light through.
    pub(crate) struct TwoSidedMaterial + comment {
        /// The side that the surface normal points into: the name of one of "materials" that stands before this one, or a material of its own. Its own
        /// "sides" do not count.
        front: Required<Box<MaterialUse>>,
        /// The other side.
        back: Required<Box<MaterialUse>>,
    }
}

crate::record! {
    /// A body of another material, and what fills it: light that the material lets in, or an "opacity" lets by, is in a medium there.
    pub(crate) struct FilledMaterial + comment {
        /// Its surface: the name of one of "materials" that stands before this one, or a material of its own.
        material: Required<Box<MaterialUse>>,
        /// What fills the side that the surface normal points away from (the inside of a sphere or a closed mesh).
        medium: Required<Box<MediumForm>>,
    }
}

crate::record! {
    /// No surface at all, only the boundary of a medium: fog, smoke, a cloud. Light passes it as if it were not there.
    pub(crate) struct BoundaryMaterial + comment {
        /// What fills the side that the surface normal points away from (the inside of a sphere or a closed mesh).
        medium: Required<Box<MediumForm>>,
        /// Makes it one of the closed solids with priorities. Where several overlap, the one of the highest priority fills the place; of equal
        /// priorities, the object that comes later. The index of refraction is that of the dielectrics among them.
        priority: Optional<Whole<0, { u32::MAX as u64 }>>,
    }
}

crate::record! {
    /// Reflects nothing: for a lamp that is only a light, or an absorber.
    pub(crate) struct BlackMaterial + comment {}
}

crate::variants! {
    /// What a surface does to light.
    pub(crate) enum MaterialForm by "type" {
        "lambert" => Lambert(LambertMaterial),
        "mirror" => Mirror(MirrorMaterial),
        "conductor" => Conductor(ConductorMaterial),
        "dielectric" => Dielectric(DielectricMaterial),
        "oren-nayar" => OrenNayar(OrenNayarMaterial),
        "translucent" => Translucent(TranslucentMaterial),
        "plastic" => Plastic(PlasticMaterial),
        "thin-dielectric" => ThinDielectric(ThinDielectricMaterial),
        "polariser" => Polariser(PolariserMaterial),
        "retarder" => Retarder(RetarderMaterial),
        "grating" => Grating(GratingMaterial),
        "fluorescent" => Fluorescent(FluorescentMaterial),
        "measured" => Measured(MeasuredMaterial),
        "principled" => Principled(PrincipledMaterial),
        "blend" => Blend(BlendMaterial),
        "two-sided" => TwoSided(TwoSidedMaterial),
        "filled" => Filled(FilledMaterial),
        "boundary" => Boundary(BoundaryMaterial),
        "black" => Black(BlackMaterial),
    }
}

impl MaterialForm {
    /// Its place.
    pub(crate) fn at(&self) -> Span {
        match self {
            Self::Lambert(m) => m.at,
            Self::Mirror(m) => m.at,
            Self::Conductor(m) => m.at,
            Self::Dielectric(m) => m.at,
            Self::OrenNayar(m) => m.at,
            Self::Translucent(m) => m.at,
            Self::Plastic(m) => m.at,
            Self::ThinDielectric(m) => m.at,
            Self::Polariser(m) => m.at,
            Self::Retarder(m) => m.at,
            Self::Grating(m) => m.at,
            Self::Fluorescent(m) => m.at,
            Self::Measured(m) => m.at,
            Self::Principled(m) => m.at,
            Self::Blend(m) => m.at,
            Self::TwoSided(m) => m.at,
            Self::Filled(m) => m.at,
            Self::Boundary(m) => m.at,
            Self::Black(m) => m.at,
        }
    }
}

/// What a form says.
#[derive(Clone, Debug)]
pub(crate) struct Made {
    /// What the surface does.
    pub(crate) kind: MaterialKind,
    /// What fills its interior.
    pub(crate) medium: Option<Box<Medium>>,
    /// What fills the other side, where the form says so.
    pub(crate) exterior_medium: Option<Box<Medium>>,
}

impl Made {
    /// With this name.
    pub(crate) fn named(self, name: String) -> Material {
        Material { name, kind: self.kind, medium: self.medium, exterior_medium: self.exterior_medium }
    }
}

impl From<MaterialKind> for Made {
    fn from(kind: MaterialKind) -> Self {
        Self { kind, medium: None, exterior_medium: None }
    }
}

/// The material of a form.
pub(crate) fn material<'f>(
    form: &'f MaterialForm,
    before: &Before<'_>,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Made> {
    let kind = match form {
        MaterialForm::Lambert(lambert) => {
            let reflectance =
                spectra.resolve_texture(lambert.reflectance.as_ref()?, Role::Reflectance, files, reader)?;
            Some(lambert.sides?.of(MaterialKind::Lambert { reflectance }))
        }
        MaterialForm::Mirror(mirror) => {
            let reflectance =
                spectra.resolve_texture(mirror.reflectance.as_ref()?, Role::Reflectance, files, reader)?;
            Some(mirror.sides?.of(MaterialKind::Mirror { reflectance }))
        }
        MaterialForm::Conductor(conductor) => {
            let metal = match &conductor.reflectance {
                Optional::Given(reflectance) => {
                    spectra.resolve_texture(reflectance, Role::Reflectance, files, reader).map(Metal::Reflectance)
                }
                _ => complex_index(&complex_keys!(conductor), spectra.range_nm, reader).map(Metal::Index),
            };
            let roughness = roughness(&roughness_keys!(conductor), files, reader);
            let compensated = conductor.multiple_scattering? == MultipleScattering::Compensated;
            let film = thin_film(&conductor.thin_film, spectra.range_nm, files, reader);
            let (metal, film) = (metal?, film?);
            let kind = roughness?.material(|facets| {
                let (metal, film) = (metal.clone(), film.clone());
                match facets {
                    None => MaterialKind::Conductor { metal, film },
                    Some(facets) => MaterialKind::RoughConductor { metal, facets, compensated, film },
                }
            });
            let tints = [&conductor.reflected_tint, &Optional::Absent];
            let kind = tinted(kind, tints, spectra, files, reader)?;
            Some(conductor.sides?.of(kind))
        }
        MaterialForm::Dielectric(form) => return dielectric(form, spectra, files, reader),
        MaterialForm::OrenNayar(rough) => {
            let reflectance = spectra.resolve_texture(rough.reflectance.as_ref()?, Role::Reflectance, files, reader)?;
            Some(rough.sides?.of(MaterialKind::OrenNayar { reflectance, roughness: rough.roughness?.0 }))
        }
        MaterialForm::Translucent(form) => translucent(form, spectra, files, reader),
        MaterialForm::Plastic(form) => plastic(form, spectra, files, reader),
        MaterialForm::ThinDielectric(pane) => {
            let index = pane.index.as_ref().and_then(|form| index(form, spectra.range_nm, reader));
            let film = thin_film(&pane.thin_film, spectra.range_nm, files, reader);
            let kind = MaterialKind::ThinDielectric { index: index?, film: film? };
            tinted(kind, [&pane.reflected_tint, &pane.transmitted_tint], spectra, files, reader)
        }
        MaterialForm::Polariser(form) => polariser(form, spectra, reader),
        MaterialForm::Retarder(form) => retarder(form),
        MaterialForm::Grating(form) => grating(form, spectra, files, reader),
        MaterialForm::Fluorescent(form) => fluorescent(form, spectra, reader),
        MaterialForm::Measured(form) => measured(form, files, reader),
        MaterialForm::Principled(form) => principled(form, spectra, files, reader),
        MaterialForm::Blend(form) => blend(form, before, spectra, files, reader),
        MaterialForm::TwoSided(form) => two_sided(form, before, spectra, files, reader),
        MaterialForm::Filled(form) => return filled(form, before, spectra, files, reader),
        MaterialForm::Boundary(boundary) => {
            let medium = medium(boundary.medium.as_ref()?, spectra, files, reader)?;
            let priority = boundary.priority.clone().checked()?.map(|priority| priority.0 as u32);
            return Some(Made { medium: Some(Box::new(medium)), ..MaterialKind::Boundary { priority }.into() });
        }
        MaterialForm::Black(_) => Some(MaterialKind::Black),
    };
    kind.map(Made::from)
}
