//! Spectra: how a file writes them, and what they become where they are used.

use std::collections::HashSet;
use std::ops::Bound;

use etalon_optics::spectrum::Outside;
use etalon_optics::{Illuminant, OpticsError, Spectrum};
use serde_json::json;

use crate::json::{
    Code, Decode, Kind, List, Named, NamedEntry, Node, NonNegative, Optional, Positive, Reader, Required,
    SchemaBuilder, SchemaValue, Span, Spanned, did_you_mean, listed,
};

crate::number! {
    /// A wavelength in nm, from 1 nm to 1 mm.
    pub(crate) struct Wavelength in (Bound::Included(1.0), Bound::Included(1e6));
}

/// A number that must be 0 or above, and for a reflectance at most 1: the check of its role says so, with the place
/// where it is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Density(pub(crate) f64);

impl Decode for Density {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        NonNegative::schema(schema)
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        f64::decode(node, reader).map(Self)
    }
}

crate::record! {
    /// The same value at every wavelength. A plain number means the same.
    pub(crate) struct ConstantSpectrum + comment {
        /// The value.
        value: Required<Spanned<Density>>,
    }
}

crate::record! {
    /// Values at wavelengths, interpolated linearly between them.
    pub(crate) struct TabulatedSpectrum + comment {
        /// The wavelengths, nm, increasing; at least two.
        wavelengths_nm: Required<List<Spanned<Wavelength>>>,
        /// The values, one a wavelength.
        values: Required<List<Spanned<Density>>>,
        /// What holds outside the table: "error" (the file is refused if the rendered range reaches there), "clamp" (the
        /// value at the nearer end) or "zero".
        outside: Required<OutsideTable> = r#""error""#,
        /// Factor on every value.
        scale: Required<NonNegative> = "1",
    }
}

/// What holds outside a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutsideTable {
    Error,
    Clamp,
    Zero,
}

crate::keywords!(OutsideTable {
    /// Nothing is known there: the file is refused if the rendered wavelengths reach there.
    "error" => Self::Error,
    /// The value at the nearer end of the table.
    "clamp" => Self::Clamp,
    /// Zero.
    "zero" => Self::Zero,
});

crate::record! {
    /// Thermal radiance of a black body by Planck's law, W·m⁻²·sr⁻¹·nm⁻¹, times a factor. Emission only.
    pub(crate) struct BlackbodySpectrum + comment {
        /// Temperature, K.
        temperature_k: Required<Positive>,
        /// Factor on Planck's law.
        scale: Required<NonNegative> = "1",
    }
}

crate::record! {
    /// A CIE standard illuminant. Emission only.
    pub(crate) struct IlluminantSpectrum + comment {
        /// Which illuminant.
        name: Required<Illuminant>,
        /// The constant spectrum of the same luminance.
        scale: Required<NonNegative> = "1",
    }
}

crate::keywords!(Illuminant {
    /// Average daylight, 6504 K.
    "D65" => Self::D65,
    /// Equal energy at every wavelength.
    "E" => Self::E,
    /// Incandescent lamp, 2856 K.
    "A" => Self::A,
});

crate::record! {
    /// A smooth spectrum that shows a linear Rec. 709 colour: as a reflectance, under D65; as an emission, by itself.
    pub(crate) struct RgbSpectrum + comment {
        /// The colour, linear Rec. 709 (not gamma-encoded).
        rgb: Required<[Spanned<Density>; 3]>,
        /// Emission only, "D65" if left out: the illuminant that gives the spectrum its structure.
        white: Optional<Spanned<Illuminant>>,
        /// Emission only, 1 if left out: factor on the colour.
        scale: Optional<Spanned<NonNegative>>,
    }
}

crate::variants! {
    /// A spectrum that takes more than a number to say.
    pub(crate) enum SpectrumObject by "type" {
        "constant" => Constant(ConstantSpectrum),
        "tabulated" => Tabulated(TabulatedSpectrum),
        "blackbody" => Blackbody(BlackbodySpectrum),
        "illuminant" => Illuminant(IlluminantSpectrum),
        "rgb" => Rgb(RgbSpectrum),
    }
}

/// A spectrum as the file writes it.
#[derive(Clone, Debug)]
pub(crate) enum SpectrumForm {
    /// A number: the same at every wavelength.
    Number(Spanned<Density>),
    /// The name of another.
    Name(Spanned<String>),
    /// Anything else.
    Object(SpectrumObject),
}

impl Decode for SpectrumForm {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        schema.define("Spectrum", |schema| {
            json!({
                "description": "A spectrum: a number (the same at every wavelength), a name from \"spectra\", or an \
                    object with a \"type\".",
                "anyOf": [
                    Density::schema(schema),
                    { "type": "string" },
                    SpectrumObject::schema(schema),
                ],
            })
        })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::Number(_) => Spanned::decode(node, reader).map(Self::Number),
            Kind::String(_) => Spanned::decode(node, reader).map(Self::Name),
            Kind::Object => SpectrumObject::decode(node, reader).map(Self::Object),
            other => {
                let message = format!("expected a spectrum (a number, a name or an object), found {}", other.name());
                reader.error(Code::WrongType, reader.span(node), message);
                None
            }
        }
    }
}

/// What a spectrum is used as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// A share of light, in [0, 1].
    Reflectance,
    /// A density of light, 0 or above.
    Emission,
}

/// Turns forms into spectra.
#[derive(Debug)]
pub(crate) struct Spectra<'f> {
    named: &'f [NamedEntry<SpectrumForm>],
    /// The wavelengths to be rendered; `None` if the file does not say them rightly.
    pub(crate) range_nm: Option<[f64; 2]>,
    /// What has been said already about a place: a named spectrum is used more than once.
    said: HashSet<(Span, Code)>,
}

impl<'f> Spectra<'f> {
    /// Checks the names that spectra have for each other.
    pub(crate) fn new(
        named: Option<&'f Named<SpectrumForm>>,
        range_nm: Option<[f64; 2]>,
        reader: &mut Reader<'_>,
    ) -> Self {
        let named = named.map_or(&[][..], |named| &named.0);
        let spectra = Self { named, range_nm, said: HashSet::new() };
        for entry in named {
            spectra.check_definition(entry, reader);
        }
        spectra
    }

    fn check_definition(&self, entry: &NamedEntry<SpectrumForm>, reader: &mut Reader<'_>) {
        match &entry.value {
            Some(SpectrumForm::Object(SpectrumObject::Tabulated(table))) => check_table(table, reader),
            Some(SpectrumForm::Name(_)) => {
                let mut at = entry;
                // A chain of names longer than the list of them has come round.
                for _ in 0..=self.named.len() {
                    let Some(SpectrumForm::Name(name)) = &at.value else { return };
                    match self.find(&name.value) {
                        Some(next) => at = next,
                        None if std::ptr::eq(at, entry) => return self.unknown(name, reader),
                        // Reported where it is written.
                        None => return,
                    }
                }
                let message = format!("the spectrum \"{}\" stands, through other names, for itself", entry.name);
                reader.error(Code::Circular, entry.at, message);
            }
            _ => {}
        }
    }

    fn find(&self, name: &str) -> Option<&'f NamedEntry<SpectrumForm>> {
        self.named.iter().find(|entry| entry.name == name)
    }

    fn unknown(&self, name: &Spanned<String>, reader: &mut Reader<'_>) {
        let names = || self.named.iter().map(|entry| entry.name.as_str());
        let message = format!("no spectrum is named \"{}\"", name.value);
        let hint = match did_you_mean(&name.value, names()) {
            Some(meant) => format!("did you mean \"{meant}\"?"),
            None if self.named.is_empty() => "name one in \"spectra\" at the top of the file".to_owned(),
            None => format!("\"spectra\" has {}", listed(names())),
        };
        reader.error_hint(Code::UnknownName, name.at, message, hint);
    }

    /// The spectrum of a form in a role.
    pub(crate) fn resolve(&mut self, form: &'f SpectrumForm, role: Role, reader: &mut Reader<'_>) -> Option<Spectrum> {
        let mut form = form;
        let mut used_at = None;
        // As above: the bound ends circles, which have been reported.
        for _ in 0..=self.named.len() {
            match form {
                SpectrumForm::Name(name) => match self.find(&name.value) {
                    Some(entry) => {
                        used_at = used_at.or(Some(name.at));
                        form = entry.value.as_ref()?;
                    }
                    None => {
                        // One inside a definition has been reported there.
                        if used_at.is_none() {
                            self.unknown(name, reader);
                        }
                        return None;
                    }
                },
                SpectrumForm::Number(number) => return self.constant(number, role, used_at, reader),
                SpectrumForm::Object(object) => return self.object(object, role, used_at, reader),
            }
        }
        None
    }

    /// Reports what is wrong with a spectrum in the role it is used in: where it is written, and once.
    fn complain(
        &mut self,
        code: Code,
        at: Span,
        message: String,
        hint: &str,
        used_at: Option<Span>,
        reader: &mut Reader<'_>,
    ) {
        if self.said.insert((at, code)) {
            match used_at {
                Some(use_at) => reader.error_related(code, at, message, hint, (use_at, "used here")),
                None if hint.is_empty() => reader.error(code, at, message),
                None => reader.error_hint(code, at, message, hint),
            }
        }
    }

    /// `value` if it is possible in the role.
    fn admit(
        &mut self,
        value: f64,
        at: Span,
        role: Role,
        used_at: Option<Span>,
        reader: &mut Reader<'_>,
    ) -> Option<f64> {
        let (code, message) = match role {
            Role::Reflectance if !(0.0..=1.0).contains(&value) => {
                (Code::Reflectance, format!("{value} is no reflectance: those lie from 0 to 1"))
            }
            Role::Emission if value < 0.0 => (Code::NegativeEmission, format!("an emission of {value} is below 0")),
            _ => return Some(value),
        };
        self.complain(code, at, message, "", used_at, reader);
        None
    }

    fn constant(
        &mut self,
        number: &Spanned<Density>,
        role: Role,
        used_at: Option<Span>,
        reader: &mut Reader<'_>,
    ) -> Option<Spectrum> {
        self.admit(number.value.0, number.at, role, used_at, reader).map(Spectrum::Constant)
    }

    fn object(
        &mut self,
        object: &SpectrumObject,
        role: Role,
        used_at: Option<Span>,
        reader: &mut Reader<'_>,
    ) -> Option<Spectrum> {
        match object {
            SpectrumObject::Constant(constant) => self.constant(constant.value.as_ref()?, role, used_at, reader),
            SpectrumObject::Tabulated(table) => {
                if used_at.is_none() {
                    check_table(table, reader);
                }
                self.table(table, role, used_at, reader)
            }
            SpectrumObject::Blackbody(body) => {
                self.light_only("a black body", body.at, role, used_at, reader)?;
                accept(Spectrum::blackbody(body.temperature_k?.0, body.scale?.0), body.at, reader)
            }
            SpectrumObject::Illuminant(illuminant) => {
                self.light_only("an illuminant", illuminant.at, role, used_at, reader)?;
                let name = illuminant.name?;
                self.covered(illuminant_range_nm(name), illuminant.at, "the illuminant", used_at, "", reader);
                accept(Spectrum::illuminant(name, illuminant.scale?.0), illuminant.at, reader)
            }
            SpectrumObject::Rgb(colour) => self.rgb(colour, role, used_at, reader),
        }
    }

    fn light_only(
        &mut self,
        what: &str,
        at: Span,
        role: Role,
        used_at: Option<Span>,
        reader: &mut Reader<'_>,
    ) -> Option<()> {
        if role == Role::Emission {
            return Some(());
        }
        let message = format!("{what} is a light, not a reflectance");
        let hint = "a reflectance is a number, a table or an rgb colour";
        self.complain(Code::Reflectance, at.head(), message, hint, used_at, reader);
        None
    }

    fn table(
        &mut self,
        table: &TabulatedSpectrum,
        role: Role,
        used_at: Option<Span>,
        reader: &mut Reader<'_>,
    ) -> Option<Spectrum> {
        let scale = table.scale.map(|scale| scale.0);
        let mut possible = true;
        for value in table.values.iter().flat_map(|values| values.0.iter().flatten()) {
            // With a wrong scale only the sign can be judged.
            let scaled = value.value.0 * scale.unwrap_or(0.0);
            let judged = if value.value.0 < 0.0 { value.value.0 } else { scaled };
            possible &= self.admit(judged, value.at, role, used_at, reader).is_some();
        }
        let wavelengths_nm = plain(table.wavelengths_nm.as_ref()?, |w| w.0)?;
        let values = plain(table.values.as_ref()?, |v| v.0)?;
        let (scale, outside) = (scale?, table.outside?);
        if let (OutsideTable::Error, Some(first), Some(last)) = (outside, wavelengths_nm.first(), wavelengths_nm.last())
        {
            let hint = "add \"outside\": \"clamp\" or \"zero\", or narrow the integrator's wavelength_range_nm";
            self.covered([*first, *last], table.at.head(), "this table", used_at, hint, reader);
        }
        if !possible || !sound(&wavelengths_nm, &values) {
            return None;
        }
        // "error" cannot be met any more: the table covers what will be rendered.
        let outside = if outside == OutsideTable::Zero { Outside::Zero } else { Outside::Hold };
        let values = values.iter().map(|v| v * scale).collect();
        accept(Spectrum::tabulated(wavelengths_nm, values, outside), table.at, reader)
    }

    fn rgb(
        &mut self,
        colour: &RgbSpectrum,
        role: Role,
        used_at: Option<Span>,
        reader: &mut Reader<'_>,
    ) -> Option<Spectrum> {
        if role == Role::Reflectance {
            let stray = [
                ("white", colour.white.given().map(|white| white.at)),
                ("scale", colour.scale.given().map(|scale| scale.at)),
            ];
            for (key, at) in stray {
                if let Some(at) = at {
                    let message = format!("\"{key}\" belongs to an emission, and this colour is used as a reflectance");
                    self.complain(Code::KeyConflict, at, message, "remove it", used_at, reader);
                }
            }
        }
        let channels = colour.rgb.as_ref()?;
        let mut possible = true;
        for channel in channels {
            possible &= self.admit(channel.value.0, channel.at, role, used_at, reader).is_some();
        }
        if !possible {
            return None;
        }
        let rgb = channels.map(|channel| channel.value.0);
        if role == Role::Reflectance {
            return accept(Spectrum::rgb_reflectance(rgb), colour.at, reader);
        }
        let white = colour.white.clone().checked()?.map_or(Illuminant::D65, |white| white.value);
        let scale = colour.scale.clone().checked()?.map_or(1.0, |scale| scale.value.0);
        self.covered(illuminant_range_nm(white), colour.at, "the white", used_at, "", reader);
        accept(Spectrum::rgb_emission(rgb.map(|v| v * scale), white), colour.at, reader)
    }

    /// Reports wavelengths of the rendered range for which there are no data.
    fn covered(
        &mut self,
        known_nm: [f64; 2],
        at: Span,
        what: &str,
        used_at: Option<Span>,
        hint: &str,
        reader: &mut Reader<'_>,
    ) {
        let Some(range_nm) = self.range_nm else { return };
        if known_nm[0] <= range_nm[0] && range_nm[1] <= known_nm[1] {
            return;
        }
        let message = outside_message(what, known_nm, range_nm);
        let hint = if hint.is_empty() { "narrow the integrator's wavelength_range_nm" } else { hint };
        self.complain(Code::OutsideFit, at.head(), message, hint, used_at, reader);
    }
}

pub(crate) fn outside_message(what: &str, known_nm: [f64; 2], range_nm: [f64; 2]) -> String {
    let [first, last] = known_nm;
    let [from, to] = range_nm;
    format!("{what} is known from {first} to {last} nm only, and {from} to {to} nm are rendered")
}

/// The wavelengths for which the CIE defines an illuminant, nm.
fn illuminant_range_nm(illuminant: Illuminant) -> [f64; 2] {
    match illuminant {
        Illuminant::D65 => [300.0, 830.0],
        Illuminant::E | Illuminant::A => [0.0, f64::INFINITY],
    }
}

fn plain<T, U>(list: &List<Spanned<T>>, f: impl Fn(&T) -> U) -> Option<Vec<U>> {
    list.0.iter().map(|element| element.as_ref().map(|element| f(&element.value))).collect()
}

/// Whether [`check_table`] has nothing against it.
fn sound(wavelengths_nm: &[f64], values: &[f64]) -> bool {
    wavelengths_nm.len() >= 2
        && wavelengths_nm.len() == values.len()
        && wavelengths_nm.windows(2).all(|pair| pair[0] < pair[1])
}

/// Reports what is wrong with a table whatever it is used for.
fn check_table(table: &TabulatedSpectrum, reader: &mut Reader<'_>) {
    if let Some(wavelengths) = &table.wavelengths_nm {
        check_increasing(wavelengths, table.at, reader);
    }
    if let (Some(wavelengths), Some(values)) = (&table.wavelengths_nm, &table.values) {
        check_same_length("values", values.0.len(), wavelengths.0.len(), table.at, reader);
    }
}

pub(super) fn check_same_length(key: &str, found: usize, wavelengths: usize, at: Span, reader: &mut Reader<'_>) {
    if found != wavelengths {
        let message = format!("{wavelengths} wavelengths_nm, but {found} {key}");
        reader.error_hint(Code::WrongLength, at.head(), message, "each wavelength needs one");
    }
}

pub(super) fn check_increasing(wavelengths: &List<Spanned<Wavelength>>, at: Span, reader: &mut Reader<'_>) {
    if wavelengths.0.len() < 2 {
        let message = format!("a table needs at least 2 wavelengths, and has {}", wavelengths.0.len());
        reader.error_hint(Code::WrongLength, at.head(), message, "for a constant write a number");
    }
    for pair in wavelengths.0.windows(2) {
        if let [Some(before), Some(after)] = pair
            && after.value.0 <= before.value.0
        {
            let message = format!("wavelengths must increase, but {} follows {}", after.value.0, before.value.0);
            reader.error(Code::OutOfRange, after.at, message);
        }
    }
}

/// What optics made of checked numbers; should it refuse them after all, its reason.
pub(super) fn accept<T>(made: Result<T, OpticsError>, at: Span, reader: &mut Reader<'_>) -> Option<T> {
    made.map_err(|error| reader.error(Code::OutOfRange, at.head(), error.to_string())).ok()
}
