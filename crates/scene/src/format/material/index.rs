//! Indices of refraction: names, numbers, formulas, tables.

use etalon_optics::index::SellmeierTerm;
use etalon_optics::{ComplexIndex, OpticsError, OutsideFit, RefractiveIndex};
use serde_json::json;

use super::super::spectra::{accept, outside_message, plain};
use super::super::spectrum::{Wavelength, check_increasing, check_same_length};
use crate::json::{
    Code, Decode, Kind, List, Node, NonNegative, Optional, Place, Positive, Reader, Required, SchemaBuilder,
    SchemaValue, Span, Spanned, by_json_type, did_you_mean, listed, neighbour,
};

crate::keywords!(OutsideFit {
    /// Nothing is known there: the file is refused if the rendered wavelengths reach there.
    "error" => Self::Error,
    /// The value at the nearer end of the known range.
    "clamp" => Self::Clamp,
});

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
pub(crate) struct NamedMetal(ComplexIndex);

/// A built-in transparent medium.
#[derive(Clone, Debug)]
pub(crate) struct Glass(RefractiveIndex);

impl Decode for NamedMetal {
    fn schema(_: &mut SchemaBuilder) -> SchemaValue {
        json!({ "enum": ComplexIndex::names().collect::<Vec<_>>() })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let names: Vec<_> = ComplexIndex::names().collect();
        built_in(node, Place::Metal, "metal", &names, ComplexIndex::named, reader).map(Self)
    }
}

impl Decode for Glass {
    fn schema(_: &mut SchemaBuilder) -> SchemaValue {
        json!({ "enum": RefractiveIndex::names().collect::<Vec<_>>() })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let names: Vec<_> = RefractiveIndex::names().collect();
        built_in(node, Place::Medium, "medium", &names, RefractiveIndex::named, reader).map(Self)
    }
}

/// What a name stands for. Only the names as they are listed count, so that the schema can list them.
fn built_in<T>(
    node: Node<'_>,
    place: Place,
    what: &str,
    names: &[&'static str],
    find: impl Fn(&str) -> Option<T>,
    reader: &mut Reader<'_>,
) -> Option<T> {
    let name = String::decode(node, reader)?;
    if names.contains(&name.as_str()) {
        return find(&name);
    }
    let hint = match neighbour(place, &name, names) {
        Some(answer) => answer.hint(),
        None => match did_you_mean(&name, names.iter().copied()) {
            Some(meant) => format!("did you mean \"{meant}\"?"),
            None => format!("the names are {}", listed(names.iter().copied())),
        },
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
            let mut index = by_json_type(vec![
                ("number", Positive::schema(schema)),
                ("string", Glass::schema(schema)),
                ("object", IndexObject::schema(schema)),
            ]);
            index["description"] =
                "An index of refraction relative to vacuum: a number (the same at every wavelength), the \
                name of a built-in medium, or an object with a \"type\"."
                    .into();
            index
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

/// The keys by which a metal is named or tabulated.
pub(super) struct ComplexKeys<'f> {
    pub(super) at: Span,
    pub(super) metal: &'f Optional<Spanned<NamedMetal>>,
    pub(super) wavelengths_nm: &'f Optional<List<Spanned<Wavelength>>>,
    pub(super) n: &'f Optional<List<Spanned<Positive>>>,
    pub(super) k: &'f Optional<List<Spanned<NonNegative>>>,
    pub(super) outside_fit: Option<OutsideFit>,
}

/// The [`ComplexKeys`] of a form.
macro_rules! complex_keys {
    ($form:expr) => {
        $crate::format::material::index::ComplexKeys {
            at: $form.at,
            metal: &$form.metal,
            wavelengths_nm: &$form.wavelengths_nm,
            n: &$form.n,
            k: &$form.k,
            outside_fit: $form.outside_fit,
        }
    };
}
pub(super) use complex_keys;

/// The metal that they name or tabulate, known all over the rendered range.
pub(super) fn complex_index(
    form: &ComplexKeys<'_>,
    range_nm: Option<[f64; 2]>,
    reader: &mut Reader<'_>,
) -> Option<ComplexIndex> {
    if let Optional::Given(wavelengths) = form.wavelengths_nm {
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

/// The index that a form stands for, known all over the rendered range.
pub(in crate::format) fn index(
    form: &IndexForm,
    range_nm: Option<[f64; 2]>,
    reader: &mut Reader<'_>,
) -> Option<RefractiveIndex> {
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

/// The least of an index within a range, at 65 wavelengths.
pub(in crate::format) fn least(index: &RefractiveIndex, [first, last]: [f64; 2]) -> f64 {
    (0..=64).map(|i| index.eval(first + (last - first) * f64::from(i) / 64.0)).fold(f64::INFINITY, f64::min)
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
            let hint = "set \"outside_fit\": \"clamp\", or narrow the integrator's wavelength_range_nm";
            reader.error_hint(Code::OutsideFit, at, message, hint);
        }
        Err(error) => reader.error(Code::OutOfRange, at, error.to_string()),
    }
}
