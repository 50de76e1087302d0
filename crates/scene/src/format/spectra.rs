//! What spectra become where they are used.

mod image;
mod noise;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use etalon_optics::colour::{
    LUMINOUS_EFFICACY, cie_y_integral_nm, daylight_chromaticity, daylight_luminances, daylight_weights, luminance_of,
};
use etalon_optics::spectrum::Outside;
use etalon_optics::{Illuminant, OpticsError, Spectrum};

use self::noise::NoiseKey;
use super::names::Names;
use super::spectrum::{
    DaylightSpectrum, Density, OutsideTable, RgbSpectrum, SpectrumForm, SpectrumObject, TabulatedSpectrum, check_table,
    of_bytes, sound,
};
use crate::json::{Code, List, Named, NamedEntry, Place, Reader, Span, Spanned};
use crate::texture::Image;

/// The largest emission: with the squares of distances, it stays within the single precision of pictures (3·10³⁸).
pub(crate) const BRIGHTEST: f64 = 1e30;

/// What a spectrum is used as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Role {
    /// A share of light, in [0, 1].
    Reflectance,
    /// A density of light, 0 or above.
    Emission,
    /// A coefficient of absorption or scattering, 0 or above.
    Coefficient,
}

/// How a spectrum is used.
#[derive(Clone, Copy, Debug)]
struct Use {
    role: Role,
    /// Where, if that is not where it is written.
    at: Option<Span>,
}

/// Turns forms into spectra.
#[derive(Debug)]
pub(crate) struct Spectra<'f> {
    entries: &'f [NamedEntry<Box<SpectrumForm>>],
    names: Names<'f>,
    /// For each entry the one that it stands for, itself if it is not another's name.
    targets: Vec<Option<usize>>,
    /// The wavelengths to be rendered; `None` if the file does not say them rightly.
    pub(crate) range_nm: Option<[f64; 2]>,
    /// What has been said already about a place: a named spectrum is used more than once.
    said: HashSet<(Span, Code)>,
    /// Named spectra that have been made: upsampling a colour takes milliseconds.
    made: HashMap<(usize, Role), Option<Spectrum>>,
    /// Images of noise: many materials may use the same.
    noise: HashMap<NoiseKey, Arc<Image>>,
    /// Points of their lattices, those that were too many included.
    noise_points: u64,
}

impl<'f> Spectra<'f> {
    /// Checks what is wrong with named spectra whatever they are used for.
    pub(crate) fn new(
        named: Option<&'f Named<Box<SpectrumForm>>>,
        range_nm: Option<[f64; 2]>,
        reader: &mut Reader<'_>,
    ) -> Self {
        let entries = named.map_or(&[][..], |named| &named.0);
        let names = Names::new("spectrum", "spectra", Place::Spectrum, entries);
        for entry in entries {
            if let Some(SpectrumForm::Object(SpectrumObject::Tabulated(table))) = entry.value.as_deref() {
                check_table(table, reader);
            }
        }
        let targets = targets(entries, &names, reader);
        Self {
            entries,
            names,
            targets,
            range_nm,
            said: HashSet::new(),
            made: HashMap::new(),
            noise: HashMap::new(),
            noise_points: 0,
        }
    }

    /// The spectrum of a form in a role.
    pub(crate) fn resolve(&mut self, form: &'f SpectrumForm, role: Role, reader: &mut Reader<'_>) -> Option<Spectrum> {
        let SpectrumForm::Name(name) = form else {
            if let SpectrumForm::Object(SpectrumObject::Tabulated(table)) = form {
                check_table(table, reader);
            }
            return self.make(form, Use { role, at: None }, reader);
        };
        let target = self.targets[self.names.find(name, reader)?]?;
        if let Some(made) = self.made.get(&(target, role)) {
            return made.clone();
        }
        let form = self.entries[target].value.as_deref()?;
        let made = self.make(form, Use { role, at: Some(name.at) }, reader);
        self.made.insert((target, role), made.clone());
        made
    }

    fn make(&mut self, form: &SpectrumForm, used: Use, reader: &mut Reader<'_>) -> Option<Spectrum> {
        let spectrum = match form {
            // `targets` has followed these.
            SpectrumForm::Name(_) => return None,
            SpectrumForm::Number(number) => self.constant(number, used, reader),
            SpectrumForm::Object(SpectrumObject::Constant(constant)) => {
                self.constant(constant.value.as_ref()?, used, reader)
            }
            SpectrumForm::Object(SpectrumObject::Tabulated(table)) => self.table(table, used, reader),
            SpectrumForm::Object(SpectrumObject::Rgb(colour)) => self.rgb(colour, used, reader),
            SpectrumForm::Object(
                SpectrumObject::Image(_)
                | SpectrumObject::Checker(_)
                | SpectrumObject::Gradient(_)
                | SpectrumObject::Noise(_),
            ) => {
                let hint = "an image can give the reflectance of a material or the emission of a surface";
                self.complain(
                    Code::KeyConflict,
                    form.at().head(),
                    "an image is not allowed here".to_owned(),
                    hint,
                    used,
                    reader,
                );
                None
            }
            SpectrumForm::Object(SpectrumObject::VertexColours(colours)) => {
                let message = "the colours of vertices are not allowed here".to_owned();
                let hint = "they can give the reflectance of a material";
                self.complain(Code::KeyConflict, colours.at.head(), message, hint, used, reader);
                None
            }
            SpectrumForm::Object(SpectrumObject::Blackbody(body)) => {
                self.light_only("a black body", body.at, used, reader)?;
                accept(Spectrum::blackbody(body.temperature_k?.0, body.scale?.0), body.at, reader)
            }
            SpectrumForm::Object(SpectrumObject::Illuminant(illuminant)) => {
                self.light_only("an illuminant", illuminant.at, used, reader)?;
                let name = illuminant.name?;
                self.covered(illuminant_range_nm(name), illuminant.at, "the illuminant", "", used, reader);
                accept(Spectrum::illuminant(name, illuminant.scale?.0), illuminant.at, reader)
            }
            SpectrumForm::Object(SpectrumObject::Daylight(daylight)) => self.cie_daylight(daylight, used, reader),
        }?;
        let largest = spectrum.max_over(self.range_nm?);
        if largest > BRIGHTEST || largest.is_nan() {
            let message = format!("an emission of {largest:e} is more than {BRIGHTEST:e}");
            self.complain(
                Code::OutOfRange,
                form.at().head(),
                message,
                "pictures store single-precision numbers, which cannot hold it",
                used,
                reader,
            );
            return None;
        }
        Some(spectrum)
    }

    /// The coefficient σ = −ln T/d, 1/m, of a medium that lets the share T through over `depth_m`.
    ///
    /// Rows at each nanometre of the rendered range and at those of a table: between them σ is linear, not T.
    pub(crate) fn absorption_of(
        &mut self,
        share: &Spectrum,
        depth_m: f64,
        at: Span,
        reader: &mut Reader<'_>,
    ) -> Option<Spectrum> {
        let [first, last] = self.range_nm?;
        let coefficient = |nm: f64| {
            let share = share.eval(nm);
            // Not −0 where nothing is absorbed.
            if share < 1.0 { -share.ln() / depth_m } else { 0.0 }
        };
        let wavelengths_nm: Vec<f64> = if share.is_constant() {
            vec![first]
        } else {
            let inner = (1..).map(|i| first.floor() + f64::from(i)).take_while(|nm| *nm < last);
            std::iter::once(first).chain(inner).chain(std::iter::once(last)).collect()
        };
        let values: Vec<f64> = wavelengths_nm.iter().map(|nm| coefficient(*nm)).collect();
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            let message =
                format!("the transmittance is 0 at {} nm: this would be an infinite absorption", wavelengths_nm[i]);
            reader.error_hint(Code::OutOfRange, at, message, "a transmittance must be above 0");
            return None;
        }
        match values.as_slice() {
            [one] => Some(Spectrum::Constant(*one)),
            _ => accept(Spectrum::tabulated(wavelengths_nm, values, Outside::Hold), at, reader),
        }
    }

    /// Daylight of this scale, for what is written at `at`.
    pub(crate) fn daylight(&mut self, scale: f64, at: Span, reader: &mut Reader<'_>) -> Option<Spectrum> {
        let used = Use { role: Role::Emission, at: None };
        self.covered(illuminant_range_nm(Illuminant::D65), at, "daylight", "", used, reader);
        accept(Spectrum::illuminant(Illuminant::D65, scale), at, reader)
    }

    fn cie_daylight(&mut self, form: &DaylightSpectrum, used: Use, reader: &mut Reader<'_>) -> Option<Spectrum> {
        self.light_only("daylight", form.at, used, reader)?;
        let (temperature, scale) = (form.temperature_k?, form.scale?.0);
        let Some(chromaticity) = daylight_chromaticity(temperature.value.0) else {
            let message = format!("there is no daylight of {} K", temperature.value.0);
            let hint = "daylight has from 4000 to 25000 K; below, use a \"blackbody\"";
            self.complain(Code::OutOfRange, temperature.at, message, hint, used, reader);
            return None;
        };
        self.covered(illuminant_range_nm(Illuminant::D65), form.at, "daylight", "", used, reader);
        let daylight = Spectrum::daylight(daylight_weights(chromaticity)).and_then(|spectrum| {
            let luminance = luminance_of(|nm| spectrum.eval(nm));
            spectrum.scaled(scale / luminance)
        });
        accept(daylight, form.at, reader)
    }

    /// The component S₀ of daylight with a luminance in cd·m⁻², for what is written at `at`.
    pub(crate) fn mean_daylight(&mut self, luminance: f64, at: Span, reader: &mut Reader<'_>) -> Option<Spectrum> {
        let used = Use { role: Role::Emission, at: None };
        self.covered(illuminant_range_nm(Illuminant::D65), at, "daylight", "", used, reader);
        let per_unit = LUMINOUS_EFFICACY * cie_y_integral_nm() * daylight_luminances()[0];
        accept(Spectrum::daylight([0.0; 2]).and_then(|mean| mean.scaled(luminance / per_unit)), at, reader)
    }

    /// Reports what is wrong with a spectrum as it is used: where it is written, and once.
    fn complain(&mut self, code: Code, at: Span, message: String, hint: &str, used: Use, reader: &mut Reader<'_>) {
        if self.said.insert((at, code)) {
            match used.at {
                Some(use_at) => reader.error_related(code, at, message, hint, (use_at, "used here")),
                None => reader.error_hint(code, at, message, hint),
            }
        }
    }

    /// Whether a value is possible in its role.
    fn admits(&mut self, value: f64, hint: &str, at: Span, used: Use, reader: &mut Reader<'_>) -> bool {
        let (code, message) = match used.role {
            Role::Reflectance if !(0.0..=1.0).contains(&value) => {
                (Code::Reflectance, format!("a reflectance must be from 0 to 1, but this is {value}"))
            }
            Role::Emission if value < 0.0 => (Code::NegativeEmission, format!("an emission of {value} is below 0")),
            Role::Coefficient if value < 0.0 => {
                (Code::OutOfRange, format!("a coefficient of {value} is below 0: light would be amplified"))
            }
            _ => return true,
        };
        self.complain(code, at, message, hint, used, reader);
        false
    }

    fn constant(&mut self, number: &Spanned<Density>, used: Use, reader: &mut Reader<'_>) -> Option<Spectrum> {
        self.admits(number.value.0, "", number.at, used, reader).then_some(Spectrum::Constant(number.value.0))
    }

    fn light_only(&mut self, what: &str, at: Span, used: Use, reader: &mut Reader<'_>) -> Option<()> {
        if used.role == Role::Emission {
            return Some(());
        }
        if used.role == Role::Coefficient {
            let hint = "an absorption or a scattering is a number, a table or an rgb colour";
            let message = format!("{what} cannot give an absorption or a scattering");
            self.complain(Code::KeyConflict, at.head(), message, hint, used, reader);
            return None;
        }
        let message = format!("{what} is a light, not a reflectance");
        let hint = "a reflectance is a number, a table or an rgb colour";
        self.complain(Code::Reflectance, at.head(), message, hint, used, reader);
        None
    }

    fn table(&mut self, table: &TabulatedSpectrum, used: Use, reader: &mut Reader<'_>) -> Option<Spectrum> {
        let scale = table.scale.map(|scale| scale.0);
        let mut possible = true;
        for value in table.values.iter().flat_map(|values| values.0.iter().flatten()) {
            // With a wrong scale only the sign can be judged.
            let scaled = if value.value.0 < 0.0 { value.value.0 } else { value.value.0 * scale.unwrap_or(0.0) };
            possible &= self.admits(scaled, "", value.at, used, reader);
        }
        let wavelengths_nm = plain(table.wavelengths_nm.as_ref()?, |w| w.0)?;
        let values = plain(table.values.as_ref()?, |v| v.0)?;
        let (scale, outside) = (scale?, table.outside?);
        if let (OutsideTable::Error, Some(first), Some(last)) = (outside, wavelengths_nm.first(), wavelengths_nm.last())
        {
            let hint = "add \"outside\": \"clamp\" or \"zero\", or narrow the integrator's wavelength_range_nm";
            self.covered([*first, *last], table.at, "this table", hint, used, reader);
        }
        if !possible || !sound(&wavelengths_nm, &values) {
            return None;
        }
        // "error" cannot be met any more: the table covers what will be rendered.
        let outside = if outside == OutsideTable::Zero { Outside::Zero } else { Outside::Hold };
        let values = values.iter().map(|v| v * scale).collect();
        accept(Spectrum::tabulated(wavelengths_nm, values, outside), table.at, reader)
    }

    fn rgb(&mut self, colour: &RgbSpectrum, used: Use, reader: &mut Reader<'_>) -> Option<Spectrum> {
        let stray = [
            ("white", used.role != Role::Emission, colour.white.given().map(|white| white.at)),
            ("scale", used.role == Role::Reflectance, colour.scale.given().map(|scale| scale.at)),
        ];
        for (key, is_stray, at) in stray {
            if let (true, Some(at)) = (is_stray, at) {
                let is_used = if used.role == Role::Reflectance { "a reflectance" } else { "a coefficient" };
                let message = format!("\"{key}\" belongs to an emission, and this colour is used as {is_used}");
                self.complain(Code::KeyConflict, at, message, "remove it", used, reader);
            }
        }
        let channels = colour.rgb.as_ref()?;
        let rgb = channels.map(|channel| channel.value.0);
        let hint = if rgb.iter().any(|v| *v > 1.0) { of_bytes(rgb) } else { String::new() };
        let mut possible = true;
        for channel in channels {
            possible &= self.admits(channel.value.0, &hint, channel.at, used, reader);
        }
        if !possible {
            return None;
        }
        if used.role == Role::Reflectance {
            return accept(Spectrum::rgb_reflectance(rgb), colour.at, reader);
        }
        let white = colour.white.clone().checked()?.map_or(Illuminant::D65, |white| white.value);
        let scale = colour.scale.clone().checked()?.map_or(1.0, |scale| scale.value.0);
        if used.role == Role::Coefficient {
            // As a reflectance whose largest channel is ½: with that, spectra are smooth.
            let twice = 2.0 * rgb.into_iter().fold(0.0, f64::max);
            if twice == 0.0 {
                return Some(Spectrum::Constant(0.0));
            }
            let shape = accept(Spectrum::rgb_reflectance(rgb.map(|v| v / twice)), colour.at, reader)?;
            return accept(shape.scaled(scale * twice), colour.at, reader);
        }
        self.covered(illuminant_range_nm(white), colour.at, "the white", "", used, reader);
        accept(Spectrum::rgb_emission(rgb.map(|v| v * scale), white), colour.at, reader)
    }

    /// What `of` makes of two spectra at each nanometre of the rendered range; between them it is taken for linear.
    pub(crate) fn combined(&self, a: &Spectrum, b: &Spectrum, of: impl Fn(f64, f64) -> f64) -> Option<Spectrum> {
        let [first, last] = self.range_nm?;
        if a.is_constant() && b.is_constant() {
            return Some(Spectrum::Constant(of(a.eval(first), b.eval(first))));
        }
        let inner = (1..).map(|i| first.floor() + f64::from(i)).take_while(|nm| *nm < last);
        let wavelengths_nm: Vec<f64> = std::iter::once(first).chain(inner).chain(std::iter::once(last)).collect();
        let values = wavelengths_nm.iter().map(|nm| of(a.eval(*nm), b.eval(*nm))).collect();
        Spectrum::tabulated(wavelengths_nm, values, Outside::Hold).ok()
    }

    /// Reports wavelengths of the rendered range for which there are no data.
    fn covered(&mut self, known_nm: [f64; 2], at: Span, what: &str, hint: &str, used: Use, reader: &mut Reader<'_>) {
        let Some(range_nm) = self.range_nm else { return };
        if known_nm[0] <= range_nm[0] && range_nm[1] <= known_nm[1] {
            return;
        }
        let message = outside_message(what, known_nm, range_nm);
        let hint = if hint.is_empty() { "narrow the integrator's wavelength_range_nm" } else { hint };
        self.complain(Code::OutsideFit, at.head(), message, hint, used, reader);
    }
}

/// For each entry the one that it stands for through any number of names; `None`, and an error, where there is none.
fn targets(
    entries: &[NamedEntry<Box<SpectrumForm>>],
    names: &Names<'_>,
    reader: &mut Reader<'_>,
) -> Vec<Option<usize>> {
    let alias = |i: usize| match entries[i].value.as_deref() {
        Some(SpectrumForm::Name(name)) => Some(name),
        _ => None,
    };
    let mut targets: Vec<Option<Option<usize>>> = vec![None; entries.len()];
    let mut met_in = vec![usize::MAX; entries.len()];
    for start in 0..entries.len() {
        // Follows names as far as nothing is known; then what is found holds for all that were passed.
        let (mut passed, mut at) = (Vec::<usize>::new(), start);
        let found = loop {
            if let Some(known) = targets[at] {
                break known;
            }
            if met_in[at] == start {
                for &i in passed.iter().skip_while(|i| **i != at) {
                    let message = format!("the spectrum \"{}\" refers to itself", entries[i].name);
                    reader.error(Code::Circular, entries[i].at, message);
                }
                break None;
            }
            met_in[at] = start;
            passed.push(at);
            match alias(at) {
                None => break Some(at),
                Some(name) => match names.find(name, reader) {
                    Some(next) => at = next,
                    None => break None,
                },
            }
        };
        for i in passed {
            targets[i] = Some(found);
        }
    }
    targets.into_iter().map(Option::flatten).collect()
}

pub(super) fn outside_message(what: &str, known_nm: [f64; 2], range_nm: [f64; 2]) -> String {
    let [first, last] = known_nm;
    let [from, to] = range_nm;
    format!("{what} covers only {first} to {last} nm, but the scene renders {from} to {to} nm")
}

/// The wavelengths for which the CIE defines an illuminant, nm.
fn illuminant_range_nm(illuminant: Illuminant) -> [f64; 2] {
    match illuminant {
        Illuminant::D65 => [300.0, 830.0],
        Illuminant::E | Illuminant::A => [0.0, f64::INFINITY],
    }
}

pub(super) fn plain<T, U>(list: &List<Spanned<T>>, f: impl Fn(&T) -> U) -> Option<Vec<U>> {
    list.0.iter().map(|element| element.as_ref().map(|element| f(&element.value))).collect()
}

/// What optics made of checked numbers; should it refuse them after all, its reason.
pub(super) fn accept<T>(made: Result<T, OpticsError>, at: Span, reader: &mut Reader<'_>) -> Option<T> {
    made.map_err(|error| reader.error(Code::OutOfRange, at.head(), error.to_string())).ok()
}
