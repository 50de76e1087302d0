//! Thin films: layers on a surface in which light interferes with itself.

use std::ops::Bound;

use etalon_optics::OutsideFit;

use super::super::detail::{NumberImageForm, number_image};
use super::super::spectrum::Wavelength;
use super::index::{IndexForm, NamedMetal, complex_index, complex_keys, index};
use crate::files::Files;
use crate::json::{Code, List, NonNegative, Optional, Positive, Reader, Required, Rule, Spanned};
use crate::model::{FilmIndex, FilmLayer, NumberTexture, ThinFilm};

/// The most layers of a film: a hostile file could otherwise make every reflection take for ever.
const MOST_LAYERS: usize = 256;

crate::number! {
    /// A thickness of a layer, nm, from 0 to 1 mm: waves that go farther do not interfere in light with many wavelengths.
    pub(crate) struct Thickness in (Bound::Included(0.0), Bound::Included(1e6));
}

crate::record! {
    /// A layer of a thin film. An index, the name of a metal, or own values of n and k.
    pub(crate) struct FilmLayerForm + comment {
        /// Its thickness, nm, from 0 to 1000000.
        thickness_nm: Required<Thickness>,
        /// An image of the share of that thickness at each place.
        thickness_image: Optional<NumberImageForm>,
        /// The index of a layer that absorbs nothing.
        index: Optional<IndexForm>,
        /// Instead: a metal with built-in n and k: "Ag", "Au", "Cu" or "Al".
        metal: Optional<Spanned<NamedMetal>>,
        /// Instead: wavelengths of own values, nm, increasing; at least two.
        wavelengths_nm: Optional<List<Spanned<Wavelength>>>,
        /// Real part n at each wavelength.
        n: Optional<List<Spanned<Positive>>>,
        /// Imaginary part k (extinction coefficient) at each wavelength.
        k: Optional<List<Spanned<NonNegative>>>,
        /// What holds at wavelengths for which the metal or the table has no values.
        outside_fit: Required<OutsideFit> = r#""error""#,
    } with [
        Rule::OneOf(&["index", "metal", "wavelengths_nm"]),
        Rule::Needs("wavelengths_nm", &["n", "k"]),
        Rule::Needs("n", &["wavelengths_nm"]),
        Rule::Needs("k", &["wavelengths_nm"]),
    ]
}

/// The film of a material, if it has one.
pub(super) fn thin_film(
    form: &Optional<Spanned<List<FilmLayerForm>>>,
    range_nm: Option<[f64; 2]>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<Option<ThinFilm>> {
    let (layers, at) = match form {
        Optional::Absent => return Some(None),
        Optional::Invalid => return None,
        Optional::Given(Spanned { value: List(layers), at }) => (layers, *at),
    };
    if layers.is_empty() || layers.len() > MOST_LAYERS {
        let message = format!("a thin film of {} layers", layers.len());
        reader.error_hint(Code::WrongLength, at, message, format!("it has from 1 to {MOST_LAYERS}"));
        return None;
    }
    // Every mistake of every layer at once.
    let layers: Vec<_> = layers.iter().map(|form| layer(form.as_ref()?, range_nm, files, reader)).collect();
    Some(Some(ThinFilm { layers: layers.into_iter().collect::<Option<_>>()?, at_nm: None }))
}

fn layer(
    form: &FilmLayerForm,
    range_nm: Option<[f64; 2]>,
    files: &mut Files,
    reader: &mut Reader<'_>,
) -> Option<FilmLayer> {
    let index = match &form.index {
        Optional::Given(form) => index(form, range_nm, reader).map(FilmIndex::Transparent),
        _ => complex_index(&complex_keys!(form), range_nm, reader).map(FilmIndex::Absorbing),
    };
    let image = match &form.thickness_image {
        Optional::Given(image) => number_image(image, files, reader).map(Some),
        Optional::Absent => Some(None),
        _ => None,
    };
    let thickness_nm = form.thickness_nm.as_ref()?.0;
    let thickness_nm = match image? {
        None => NumberTexture::Uniform(thickness_nm),
        Some(mut image) => {
            image.factor = image.factor.map(|factor| factor * thickness_nm);
            NumberTexture::Image(image)
        }
    };
    Some(FilmLayer { thickness_nm, index: index? })
}
