//! Materials.

use etalon_optics::index::SellmeierTerm;
use etalon_optics::{ComplexIndex, OpticsError, OutsideFit, RefractiveIndex};
use serde_json::json;

use std::ops::Bound;

use super::names::Names;
use super::scene::MaterialUse;
use super::spectra::{Role, Spectra, accept, outside_message, plain};
use super::spectrum::{SpectrumForm, Wavelength, check_increasing, check_same_length};
use crate::files::Files;
use crate::json::{
    Code, Decode, Kind, List, Node, NonNegative, Optional, Positive, Reader, Required, Rule, SchemaBuilder,
    SchemaValue, Span, Spanned, Whole, did_you_mean, listed,
};
use crate::model::{LEAST_ALPHA, MaterialKind};

crate::record! {
    /// Ideal diffuse reflection, on both sides.
    pub(crate) struct LambertMaterial + comment {
        /// Share of light reflected, from 0 to 1.
        reflectance: Required<SpectrumForm>,
    }
}

crate::record! {
    /// Ideal mirror, on both sides.
    pub(crate) struct MirrorMaterial + comment {
        /// Share of light reflected, from 0 to 1, the same at every angle.
        reflectance: Required<SpectrumForm> = "1",
    }
}

crate::record! {
    /// Metal: Fresnel reflection from a complex index of refraction n + ik, seen from vacuum. Either the name of a metal, or
    /// own values.
    pub(crate) struct ConductorMaterial + comment {
        /// A metal with built-in n and k: "Ag", "Au", "Cu" or "Al".
        metal: Optional<Spanned<Metal>>,
        /// Wavelengths of own values, nm, increasing; at least two.
        wavelengths_nm: Optional<List<Spanned<Wavelength>>>,
        /// Real part n at each wavelength.
        n: Optional<List<Spanned<Positive>>>,
        /// Imaginary part k (extinction coefficient) at each wavelength.
        k: Optional<List<Spanned<NonNegative>>>,
        /// What holds at wavelengths for which there are no values.
        outside_fit: Required<OutsideFit> = r#""error""#,
        /// Roughness: the width α of the GGX distribution of facet normals, 0 (smooth) or from 0.0001 to 1.
        alpha: Required<Spanned<Alpha>> = "0",
        /// For a rough surface, whether light that meets several facets is counted ("compensated") or lost ("lost").
        multiple_scattering: Required<MultipleScattering> = r#""compensated""#,
    } with [
        Rule::OneOf(&["metal", "wavelengths_nm"]),
        Rule::Needs("wavelengths_nm", &["n", "k"]),
        Rule::Needs("n", &["wavelengths_nm"]),
        Rule::Needs("k", &["wavelengths_nm"]),
    ]
}

crate::keywords!(OutsideFit {
    /// Nothing is known there: the file is refused if the rendered wavelengths reach there.
    "error" => Self::Error,
    /// The value at the nearer end of the known range.
    "clamp" => Self::Clamp,
});

crate::number! {
    /// A width of a distribution of facets: 0 or a width that directions can resolve, at most 1.
    pub(crate) struct Alpha in (Bound::Included(0.0), Bound::Included(1.0));
}

/// What becomes of light that meets several facets of a rough surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MultipleScattering {
    Compensated,
    Lost,
}

crate::keywords!(MultipleScattering {
    /// A diffuse lobe gives back what single scattering loses.
    "compensated" => Self::Compensated,
    /// Single scattering only, as most renderers do: rough surfaces are too dark.
    "lost" => Self::Lost,
});

crate::record! {
    /// Interface between two transparent media, with dispersion.
    pub(crate) struct DielectricMaterial + comment {
        /// Medium on the side that the surface normal points away from (inside a sphere or a closed mesh).
        interior: Required<IndexForm>,
        /// Medium on the side that the surface normal points into.
        exterior: Required<IndexForm> = "1",
        /// Roughness: the width α of the GGX distribution of facet normals, 0 (smooth) or from 0.0001 to 1.
        alpha: Required<Spanned<Alpha>> = "0",
        /// For a rough surface, whether light that meets several facets is counted ("compensated") or lost ("lost").
        multiple_scattering: Required<MultipleScattering> = r#""compensated""#,
        /// For a smooth, closed solid that touches, overlaps or holds other solids: where several overlap, the one of the highest
        /// priority fills the place; of equal priorities, the object that comes later. It replaces `exterior`.
        priority: Optional<Whole<0, { u32::MAX as u64 }>>,
    } with [Rule::NotBoth("exterior", "priority"), Rule::NotBoth("alpha", "priority")]
}

crate::number! {
    /// A share, from 0 to 1.
    pub(crate) struct Share in (Bound::Included(0.0), Bound::Included(1.0));
}

crate::record! {
    /// Rough diffuse reflection, on both sides: chalk, clay, the moon.
    pub(crate) struct OrenNayarMaterial + comment {
        /// Albedo parameter, from 0 to 1: what a white surface multiplies at each bounce within its roughness.
        reflectance: Required<SpectrumForm>,
        /// Roughness, from 0 (as `lambert`) to 1.
        roughness: Required<Share>,
    }
}

crate::record! {
    /// A diffuse ground under a clear coat, seen from vacuum, on both sides.
    pub(crate) struct PlasticMaterial + comment {
        /// Share of light that the ground reflects, from 0 to 1.
        reflectance: Required<SpectrumForm>,
        /// Index of the coat.
        coat: Required<IndexForm> = "1.5",
        /// Roughness of the coat: the width α of the GGX distribution of facet normals, 0 (smooth) or from 0.0001 to 1.
        alpha: Required<Spanned<Alpha>> = "0",
    }
}

crate::record! {
    /// A pane of glass without thickness: mirrors light, or lets it pass straight on.
    pub(crate) struct ThinDielectricMaterial + comment {
        /// Index relative to what surrounds it.
        index: Required<IndexForm> = "1.5",
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
        weight: Required<Share>,
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
        "plastic" => Plastic(PlasticMaterial),
        "thin-dielectric" => ThinDielectric(ThinDielectricMaterial),
        "blend" => Blend(BlendMaterial),
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
            Self::Plastic(m) => m.at,
            Self::ThinDielectric(m) => m.at,
            Self::Blend(m) => m.at,
            Self::Black(m) => m.at,
        }
    }
}

crate::record! {
    /// The same index at every wavelength. A plain number means the same.
    pub(crate) struct ConstantIndex + comment {
        /// The index, relative to vacuum.
        value: Required<Positive>,
    }
}

crate::record! {
    /// A built-in medium. Its name alone means the same, with `outside_fit` "error".
    pub(crate) struct GlassIndex + comment {
        /// Its name: "N-BK7", "N-SF11", "fused-silica", "diamond" or "water".
        name: Required<Glass>,
        /// What holds at wavelengths for which its formula was not fitted.
        outside_fit: Required<OutsideFit> = r#""error""#,
    }
}

crate::record! {
    /// Sellmeier's formula n² = 1 + Σ B·λ²/(λ² − C), λ in µm.
    pub(crate) struct SellmeierIndex + comment {
        /// The coefficients B, dimensionless; at most 16.
        b: Required<List<f64>>,
        /// The coefficients C, µm², one a B.
        c_um2: Required<List<NonNegative>>,
        /// First and last wavelength of the fit, nm.
        range_nm: Required<Spanned<[Wavelength; 2]>>,
        /// What holds outside that range.
        outside_fit: Required<OutsideFit> = r#""error""#,
    }
}

crate::record! {
    /// Cauchy's formula n = A + B/λ² + C/λ⁴, λ in µm.
    pub(crate) struct CauchyIndex + comment {
        /// The coefficient A, dimensionless.
        a: Required<f64>,
        /// The coefficient B, µm².
        b_um2: Required<f64> = "0",
        /// The coefficient C, µm⁴.
        c_um4: Required<f64> = "0",
        /// First and last wavelength of the fit, nm.
        range_nm: Required<Spanned<[Wavelength; 2]>>,
        /// What holds outside that range.
        outside_fit: Required<OutsideFit> = r#""error""#,
    }
}

crate::variants! {
    /// An index of refraction that takes more than a number or a name to say.
    pub(crate) enum IndexObject by "type" {
        "constant" => Constant(ConstantIndex),
        "glass" => Glass(GlassIndex),
        "sellmeier" => Sellmeier(SellmeierIndex),
        "cauchy" => Cauchy(CauchyIndex),
    }
}

/// A built-in metal.
#[derive(Clone, Debug)]
pub(crate) struct Metal(ComplexIndex);

/// A built-in transparent medium.
#[derive(Clone, Debug)]
pub(crate) struct Glass(RefractiveIndex);

impl Decode for Metal {
    fn schema(_: &mut SchemaBuilder) -> SchemaValue {
        json!({ "enum": ComplexIndex::names().collect::<Vec<_>>() })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let names: Vec<_> = ComplexIndex::names().collect();
        built_in(node, "metal", &names, ComplexIndex::named, reader).map(Self)
    }
}

impl Decode for Glass {
    fn schema(_: &mut SchemaBuilder) -> SchemaValue {
        json!({ "enum": RefractiveIndex::names().collect::<Vec<_>>() })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let names: Vec<_> = RefractiveIndex::names().collect();
        built_in(node, "medium", &names, RefractiveIndex::named, reader).map(Self)
    }
}

/// What a name stands for. Only the names as they are listed count, so that the schema can list them; for others that
/// `find` knows, one of those is suggested.
fn built_in<T: PartialEq>(
    node: Node<'_>,
    what: &str,
    names: &[&'static str],
    find: impl Fn(&str) -> Option<T>,
    reader: &mut Reader<'_>,
) -> Option<T> {
    let name = String::decode(node, reader)?;
    if names.contains(&name.as_str()) {
        return find(&name);
    }
    let known = find(&name).and_then(|known| names.iter().copied().find(|n| find(n).as_ref() == Some(&known)));
    let hint = match known.or_else(|| did_you_mean(&name, names.iter().copied())) {
        Some(meant) => format!("did you mean \"{meant}\"?"),
        None => format!("there are {}", listed(names.iter().copied())),
    };
    reader.error_hint(Code::UnknownName, reader.span(node), format!("no built-in {what} is named \"{name}\""), hint);
    None
}

/// An index of refraction as the file writes it, and its place.
#[derive(Clone, Debug)]
pub(crate) struct IndexForm {
    at: Span,
    kind: IndexKind,
}

#[derive(Clone, Debug)]
enum IndexKind {
    Number(f64),
    Name(Glass),
    Object(IndexObject),
}

impl Decode for IndexForm {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        schema.define("Index", |schema| {
            json!({
                "description": "An index of refraction relative to vacuum: a number (the same at every wavelength), the \
                    name of a built-in medium, or an object with a \"type\".",
                "anyOf": [
                    { "type": "number", "exclusiveMinimum": 0 },
                    Glass::schema(schema),
                    IndexObject::schema(schema),
                ],
            })
        })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let kind = match node.kind() {
            Kind::Number(_) => Positive::decode(node, reader).map(|n| IndexKind::Number(n.0)),
            Kind::String(_) => Glass::decode(node, reader).map(IndexKind::Name),
            Kind::Object => IndexObject::decode(node, reader).map(IndexKind::Object),
            other => {
                let message =
                    format!("expected an index of refraction (a number, a name or an object), found {}", other.name());
                reader.error(Code::WrongType, reader.span(node), message);
                None
            }
        }?;
        Some(Self { at: reader.span(node), kind })
    }
}

/// The most materials that a blend may come down to: names can double them line by line.
const MOST_PARTS: usize = 64;

/// Materials that are no blends in a material.
fn parts(kind: &MaterialKind) -> usize {
    match kind {
        MaterialKind::Blend { first, second, .. } => parts(first) + parts(second),
        _ => 1,
    }
}

/// Named materials that a blend may be made of: those that stand before it, so that none is made of itself.
#[derive(Debug)]
pub(crate) struct Before<'m> {
    /// All of the file's names.
    pub(crate) names: &'m Names<'m>,
    /// The materials read so far, by their place in the file; `None` is wrong, which has been reported.
    pub(crate) made: &'m [Option<MaterialKind>],
}

impl Before<'_> {
    fn find(&self, name: &Spanned<String>, reader: &mut Reader<'_>) -> Option<MaterialKind> {
        let place = self.names.find(name, reader)?;
        match self.made.get(place) {
            Some(made) => made.clone(),
            None => {
                let message =
                    format!("the material \"{}\" does not stand before the blend that is made of it", name.value);
                reader.error_hint(Code::Circular, name.at, message, "move it up");
                None
            }
        }
    }
}

/// The material of a form.
pub(crate) fn material<'f>(
    form: &'f MaterialForm,
    before: &Before<'_>,
    spectra: &mut Spectra<'f>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    match form {
        MaterialForm::Lambert(lambert) => {
            let reflectance = spectra.resolve_texture(lambert.reflectance.as_ref()?, files, reader)?;
            Some(MaterialKind::Lambert { reflectance })
        }
        MaterialForm::Mirror(mirror) => {
            let reflectance = spectra.resolve_texture(mirror.reflectance.as_ref()?, files, reader)?;
            Some(MaterialKind::Mirror { reflectance })
        }
        MaterialForm::Conductor(conductor) => {
            let index = complex_index(conductor, spectra.range_nm, reader);
            let alpha = width(conductor.alpha.as_ref(), reader);
            let compensated = conductor.multiple_scattering? == MultipleScattering::Compensated;
            Some(match (index?, alpha?) {
                (index, 0.0) => MaterialKind::Conductor { index },
                (index, alpha) => MaterialKind::RoughConductor { index, alpha, compensated },
            })
        }
        MaterialForm::Dielectric(dielectric) => {
            let interior = dielectric.interior.as_ref().and_then(|form| index(form, spectra.range_nm, reader));
            let exterior = dielectric.exterior.as_ref().and_then(|form| index(form, spectra.range_nm, reader));
            let alpha = width(dielectric.alpha.as_ref(), reader);
            let compensated = dielectric.multiple_scattering? == MultipleScattering::Compensated;
            let priority = dielectric.priority.clone().checked()?.map(|priority| priority.0 as u32);
            let (interior, exterior) = (interior?, exterior?);
            Some(match alpha? {
                0.0 => MaterialKind::Dielectric { interior, exterior, priority },
                alpha => MaterialKind::RoughDielectric { interior, exterior, alpha, compensated },
            })
        }
        MaterialForm::OrenNayar(rough) => {
            let reflectance = spectra.resolve(rough.reflectance.as_ref()?, Role::Reflectance, reader)?;
            Some(MaterialKind::OrenNayar { reflectance, roughness: rough.roughness?.0 })
        }
        MaterialForm::Plastic(plastic) => {
            let reflectance =
                plastic.reflectance.as_ref().and_then(|form| spectra.resolve(form, Role::Reflectance, reader));
            let coat = plastic.coat.as_ref().and_then(|form| index(form, spectra.range_nm, reader));
            let alpha = width(plastic.alpha.as_ref(), reader);
            Some(MaterialKind::Plastic { reflectance: reflectance?, coat: coat?, alpha: alpha? })
        }
        MaterialForm::ThinDielectric(pane) => {
            let index = pane.index.as_ref().and_then(|form| index(form, spectra.range_nm, reader))?;
            Some(MaterialKind::ThinDielectric { index })
        }
        MaterialForm::Blend(blend) => {
            let mut part = |part: &'f Option<Box<MaterialUse>>| match part.as_deref()? {
                MaterialUse::Own(own) => material(own, before, spectra, files, reader).map(Box::new),
                MaterialUse::Named(name) => before.find(name, reader).map(Box::new),
            };
            let (first, second) = (part(&blend.first), part(&blend.second));
            let (first, second) = (first?, second?);
            if [&first, &second]
                .iter()
                .any(|part| matches!(***part, MaterialKind::Dielectric { priority: Some(_), .. }))
            {
                let message = "a part of a blend bounds no solid: its dielectric cannot have a priority";
                reader.error_hint(Code::KeyConflict, blend.at.head(), message, "say its exterior instead");
                return None;
            }
            let kind = MaterialKind::Blend { first, second, weight: blend.weight?.0 };
            let count = parts(&kind);
            if count > MOST_PARTS {
                let message = format!("a blend of {count} materials, blends in blends counted");
                reader.error_hint(Code::OutOfRange, blend.at.head(), message, format!("at most {MOST_PARTS}"));
                return None;
            }
            Some(kind)
        }
        MaterialForm::Black(_) => Some(MaterialKind::Black),
    }
}

/// A width of facets that can be rendered.
fn width(alpha: Option<&Spanned<Alpha>>, reader: &mut Reader<'_>) -> Option<f64> {
    let (alpha, at) = alpha.map(|alpha| (alpha.value.0, alpha.at))?;
    if alpha > 0.0 && alpha < LEAST_ALPHA {
        let message = format!("a width of {alpha} is narrower than {LEAST_ALPHA}, the least that is rendered");
        reader.error_hint(Code::OutOfRange, at, message, "0 is smooth");
        return None;
    }
    Some(alpha)
}

fn complex_index(
    form: &ConductorMaterial,
    range_nm: Option<[f64; 2]>,
    reader: &mut Reader<'_>,
) -> Option<ComplexIndex> {
    if let Optional::Given(wavelengths) = &form.wavelengths_nm {
        check_increasing(wavelengths, form.at, reader);
        for (key, length) in [("n", form.n.given().map(|n| n.0.len())), ("k", form.k.given().map(|k| k.0.len()))] {
            if let Some(length) = length {
                check_same_length(key, length, wavelengths.0.len(), form.at, reader);
            }
        }
    }
    let before = reader.error_count();
    let index = match form.metal.clone().checked()? {
        Some(metal) => metal.value.0,
        None => {
            let wavelengths_nm = plain(form.wavelengths_nm.given()?, |w| w.0)?;
            let n = plain(form.n.given()?, |n| n.0)?;
            let k = plain(form.k.given()?, |k| k.0)?;
            let increasing = wavelengths_nm.windows(2).all(|pair| pair[0] < pair[1]);
            if !increasing || wavelengths_nm.len() < 2 || [n.len(), k.len()] != [wavelengths_nm.len(); 2] {
                return None;
            }
            accept(ComplexIndex::tabulated(wavelengths_nm, n, k), form.at, reader)?
        }
    };
    let index = index.with_outside(form.outside_fit?);
    if let Some(range_nm) = range_nm {
        let at = form.metal.given().map_or(form.at.head(), |metal| metal.at);
        fits(index.check_range(range_nm), at, reader);
    }
    (reader.error_count() == before).then_some(index)
}

fn index(form: &IndexForm, range_nm: Option<[f64; 2]>, reader: &mut Reader<'_>) -> Option<RefractiveIndex> {
    let before = reader.error_count();
    let index = match &form.kind {
        IndexKind::Number(n) => accept(RefractiveIndex::constant(*n), form.at, reader)?,
        IndexKind::Name(glass) => glass.0.clone(),
        IndexKind::Object(IndexObject::Constant(constant)) => {
            accept(RefractiveIndex::constant(constant.value?.0), form.at, reader)?
        }
        IndexKind::Object(IndexObject::Glass(glass)) => glass.name.as_ref()?.0.clone().with_outside(glass.outside_fit?),
        IndexKind::Object(IndexObject::Sellmeier(form)) => sellmeier(form, reader)?,
        IndexKind::Object(IndexObject::Cauchy(form)) => {
            let range_nm = fit_range(form.range_nm.as_ref(), reader);
            let (a, b_um2, c_um4) = (form.a?, form.b_um2?, form.c_um4?);
            let cauchy = RefractiveIndex::cauchy(a, b_um2, c_um4, Some(range_nm?));
            accept(cauchy, form.at, reader)?.with_outside(form.outside_fit?)
        }
    };
    if let Some(range_nm) = range_nm {
        let at = match &form.kind {
            IndexKind::Object(_) => form.at.head(),
            _ => form.at,
        };
        fits(index.check_range(range_nm), at, reader);
    }
    (reader.error_count() == before).then_some(index)
}

fn sellmeier(form: &SellmeierIndex, reader: &mut Reader<'_>) -> Option<RefractiveIndex> {
    // So that a hostile file cannot make the check over the range take for ever.
    const MOST_TERMS: usize = 16;
    let range_nm = fit_range(form.range_nm.as_ref(), reader);
    let (b, c) = (form.b.as_ref()?, form.c_um2.as_ref()?);
    if b.0.len() != c.0.len() || b.0.is_empty() || b.0.len() > MOST_TERMS {
        let message = format!("{} coefficients b and {} c_um2", b.0.len(), c.0.len());
        let hint = format!("there must be as many of each, from 1 to {MOST_TERMS}");
        reader.error_hint(Code::WrongLength, form.at.head(), message, hint);
        return None;
    }
    let terms: Option<Vec<SellmeierTerm>> =
        b.0.iter().zip(&c.0).map(|(b, c)| Some(SellmeierTerm { b: (*b)?, c_um2: c.as_ref()?.0 })).collect();
    let made = RefractiveIndex::sellmeier(terms?, Some(range_nm?));
    Some(accept(made, form.at, reader)?.with_outside(form.outside_fit?))
}

fn fit_range(range: Option<&Spanned<[Wavelength; 2]>>, reader: &mut Reader<'_>) -> Option<[f64; 2]> {
    let range = range?;
    let [first, last] = range.value.map(|w| w.0);
    if first >= last {
        reader.error(Code::OutOfRange, range.at, format!("the range from {first} to {last} nm is empty"));
        return None;
    }
    Some([first, last])
}

/// Reports an index that is not known all over the rendered range.
fn fits(checked: Result<(), OpticsError>, at: Span, reader: &mut Reader<'_>) {
    match checked {
        Ok(()) => {}
        Err(OpticsError::OutsideFit { what, fit_nm, range_nm }) => {
            let message = outside_message(&what, fit_nm, range_nm);
            let hint = "say \"outside_fit\": \"clamp\", or narrow the integrator's wavelength_range_nm";
            reader.error_hint(Code::OutsideFit, at, message, hint);
        }
        Err(error) => reader.error(Code::OutOfRange, at, error.to_string()),
    }
}
