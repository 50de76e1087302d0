//! Sensors from files.

#[cfg(test)]
mod tests;

use std::ops::Bound;
use std::path::Path;

use etalon_optics::spectrum::{Outside, Tabulated};
use etalon_picture::expose::{
    MOST_BITS, MOST_CHANNELS, MOST_FULL_WELL_E, MOST_MOSAIC, MOST_PRNU, Mosaic, QuantumEfficiency, Sensor,
    SensorChannel,
};
use etalon_scene::json::{
    self, Code, Decode, Kind, List, Named, Node, NonNegative, Optional, Positive, Reader, Required, Rule,
    SchemaBuilder, SchemaValue, Span, Spanned, Whole,
};
use etalon_scene::{LoadError, Problem, SceneErrors};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// Metres in a micrometre.
const UM: f64 = 1e-6;

/// An image sensor, read from a file.
///
/// ```
/// use etalon::SensorFile;
///
/// let file = SensorFile::parse(r#"{
///     "pixel_pitch_um": 3.45, "exposure_s": 0.01, "f_number": 4, "quantum_efficiency": { "mono": 0.6 },
///     "full_well_e": 10500, "dark_current_e_per_s": 5, "read_noise_e": 2.3, "gain_e_per_dn": 2.6, "bits": 12
/// }"#, "sensor.json")?;
/// assert_eq!(file.sensor.numerical_aperture, Some(0.125));
///
/// // Every mistake at once, each with its place.
/// let errors = SensorFile::parse(r#"{ "pixel_pitch_um": -1, "bits": 40 }"#, "sensor.json").unwrap_err();
/// assert!(errors.errors().count() > 5);
/// # Ok::<(), etalon::SceneErrors>(())
/// ```
#[derive(Clone, Debug)]
pub struct SensorFile {
    /// The sensor.
    pub sensor: Sensor,
    /// What is odd and not an error.
    pub warnings: Vec<Problem>,
    /// The name of the file in messages.
    pub file_name: String,
    /// The text of the file.
    pub text: String,
    /// SHA-256 of the text, in hex.
    pub sha256: String,
}

impl SensorFile {
    /// Reads a sensor from a file.
    ///
    /// # Errors
    /// If the file cannot be read; every error of its text at once.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, LoadError> {
        let path = path.as_ref();
        Ok(Self::parse(&json::load_text(path)?, &path.display().to_string())?)
    }

    /// Reads a sensor from the text of a file; `file_name` is for messages.
    ///
    /// # Errors
    /// Every error of the text at once.
    pub fn parse(text: &str, file_name: &str) -> Result<Self, SceneErrors> {
        let (sensor, warnings) = json::read(text, file_name, |form: SensorForm, reader| sensor(&form, reader))?;
        let sha256 = Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { sensor, warnings, file_name: file_name.to_owned(), text: text.to_owned(), sha256 })
    }

    /// The JSON Schema (2020-12) of such files.
    #[must_use]
    pub fn schema() -> Value {
        json::document_schema::<SensorForm>("Etalon sensor")
    }
}

etalon_scene::number! {
    /// A share from 0 to 1.
    pub(crate) struct Share in (Bound::Included(0.0), Bound::Included(1.0));
}

etalon_scene::number! {
    /// The sine of an angle, above 0 and at most 1.
    pub(crate) struct Sine in (Bound::Excluded(0.0), Bound::Included(1.0));
}

etalon_scene::number! {
    /// An f-number: at least 0.5, where the light fills a half-space.
    pub(crate) struct FNumber in (Bound::Included(0.5), Bound::Unbounded);
}

etalon_scene::number! {
    /// A relative standard deviation of at most 8 %.
    pub(crate) struct Nonuniformity in (Bound::Included(0.0), Bound::Included(MOST_PRNU));
}

etalon_scene::number! {
    /// A wavelength in nm, from 1 nm to 1 mm.
    pub(crate) struct TableWavelength in (Bound::Included(1.0), Bound::Included(1e6));
}

etalon_scene::record! {
    /// An image sensor behind a lens, in the words of EMVA Standard 1288 (release 4.0 Linear). e is an electron, DN a digital number.
    pub(crate) struct SensorForm + comment {
        /// The schema that this file follows, for editors. It changes nothing.
        #[allow(dead_code, reason = "for editors")]
        schema as "$schema": Optional<String>,
        /// Side of a square pixel, µm.
        pixel_pitch_um: Required<Positive>,
        /// Exposure time, s.
        exposure_s: Required<Positive>,
        /// F-number N of the lens: the irradiance is π L sin²θ with sin θ = 1/(2N). A picture through a compound lens states its own sin θ.
        f_number: Optional<FNumber>,
        /// sin θ of the cone of light on the side of the sensor, instead of `f_number`.
        numerical_aperture: Optional<Sine>,
        /// Share of light that the lens lets through. A picture through a compound lens has its losses already.
        lens_transmittance: Required<Share> = "1",
        /// Quantum efficiency by the name of the channel, such as "mono", or "R", "G" and "B".
        quantum_efficiency: Required<Spanned<Named<EfficiencyForm>>>,
        /// The channels of neighbouring pixels: "RGGB" for 2 × 2 pixels, or rows of names. Left out, each pixel has all channels.
        mosaic: Optional<Spanned<MosaicForm>>,
        /// Most electrons that a pixel holds.
        full_well_e: Required<Whole<1, { MOST_FULL_WELL_E as u64 }>>,
        /// Mean dark current of a pixel, electrons a second.
        dark_current_e_per_s: Required<NonNegative>,
        /// Standard deviation of the noise of the readout, electrons.
        read_noise_e: Required<NonNegative>,
        /// Electrons for one digital number: 1/K.
        gain_e_per_dn: Required<Positive>,
        /// Digital number of no electrons.
        black_level_dn: Required<NonNegative> = "0",
        /// Bits of a digital number.
        bits: Required<Whole<1, { MOST_BITS as u64 }>>,
        /// Photo response nonuniformity: standard deviation of the response of pixels over its mean; 0.01 is 1 %.
        prnu: Required<Nonuniformity> = "0",
        /// Dark signal nonuniformity: standard deviation of the dark signal of pixels, electrons.
        dsnu_e: Required<NonNegative> = "0",
        /// Seed of the fixed pattern of both: another seed is another specimen of the sensor.
        pattern_seed: Required<u32> = "0",
    } with [Rule::NotBoth("f_number", "numerical_aperture")]
}

etalon_scene::record! {
    /// Electrons for each photon on a pixel, by wavelength, linear between the entries.
    pub(crate) struct EfficiencyTable + comment {
        /// The wavelengths, nm, increasing; at least two.
        wavelengths_nm: Required<List<Spanned<TableWavelength>>>,
        /// The quantum efficiencies, one a wavelength, from 0 to 1.
        values: Required<List<Share>>,
        /// What holds outside the table: "error" (a picture with bands there is refused) or "zero".
        outside: Required<Beyond> = r#""error""#,
    }
}

/// What holds outside a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Beyond {
    Error,
    Zero,
}

etalon_scene::keywords!(Beyond {
    /// Nothing is known there: a picture with bands there is refused.
    "error" => Self::Error,
    /// Zero.
    "zero" => Self::Zero,
});

/// A quantum efficiency as the file writes it.
#[derive(Clone, Debug)]
pub(crate) enum EfficiencyForm {
    /// The same at every wavelength.
    Number(Share),
    Table(EfficiencyTable),
}

impl Decode for EfficiencyForm {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        json::by_json_type(vec![("number", Share::schema(schema)), ("object", EfficiencyTable::schema(schema))])
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::Number(_) => Share::decode(node, reader).map(Self::Number),
            _ => EfficiencyTable::decode(node, reader).map(Self::Table),
        }
    }
}

/// A mosaic as the file writes it: rows of names.
#[derive(Clone, Debug)]
pub(crate) struct MosaicForm(Vec<Vec<String>>);

impl Decode for MosaicForm {
    fn schema(_: &mut SchemaBuilder) -> SchemaValue {
        let row = json!({ "type": "array", "items": { "type": "string" }, "minItems": 1, "maxItems": MOST_MOSAIC });
        json::by_json_type(vec![
            ("string", json!({ "minLength": 4, "maxLength": 4 })),
            ("array", json!({ "items": row, "minItems": 1, "maxItems": MOST_MOSAIC })),
        ])
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let Kind::String(letters) = node.kind() else {
            let rows = List::<List<String>>::decode(node, reader)?.complete()?;
            return rows.into_iter().map(List::complete).collect::<Option<_>>().map(Self);
        };
        let names: Vec<String> = letters.chars().map(String::from).collect();
        if names.len() != 4 {
            let message = format!("a mosaic in one word has 4 letters, and this one has {}", names.len());
            let hint = "write \"RGGB\" for R G over G B, or a list of rows of names";
            reader.error_hint(Code::WrongLength, reader.span(node), message, hint);
            return None;
        }
        Some(Self(names.chunks(2).map(<[String]>::to_vec).collect()))
    }
}

/// The sensor of a form.
fn sensor(form: &SensorForm, reader: &mut Reader<'_>) -> Option<Sensor> {
    let channels = form.quantum_efficiency.as_ref().and_then(|named| channels(named, reader));
    let names: Vec<&str> =
        form.quantum_efficiency.iter().flat_map(|named| &named.value.0).map(|e| e.name.as_str()).collect();
    let mosaic = match form.mosaic.clone().checked()? {
        Some(mosaic) => Some(mosaic_of(&mosaic, &names, reader)?),
        None => None,
    };
    let f_number = form.f_number.clone().checked()?.map(|n| 0.5 / n.0);
    let sine = form.numerical_aperture.clone().checked()?.map(|sine| sine.0);
    Some(Sensor {
        pixel_pitch_m: form.pixel_pitch_um?.0 * UM,
        exposure_s: form.exposure_s?.0,
        numerical_aperture: f_number.or(sine),
        lens_transmittance: form.lens_transmittance?.0,
        channels: channels?,
        mosaic,
        // Within the bounds of their types.
        full_well_e: form.full_well_e?.0 as u32,
        dark_current_e_per_s: form.dark_current_e_per_s?.0,
        read_noise_e: form.read_noise_e?.0,
        gain_e_per_dn: form.gain_e_per_dn?.0,
        black_level_dn: form.black_level_dn?.0,
        bits: form.bits?.0 as u32,
        prnu: form.prnu?.0,
        dsnu_e: form.dsnu_e?.0,
        pattern_seed: form.pattern_seed?.into(),
    })
}

fn channels(named: &Spanned<Named<EfficiencyForm>>, reader: &mut Reader<'_>) -> Option<Vec<SensorChannel>> {
    let entries = &named.value.0;
    if entries.is_empty() || entries.len() > MOST_CHANNELS {
        let message = format!("a sensor of {} channels; there must be from 1 to {MOST_CHANNELS}", entries.len());
        reader.error_hint(Code::WrongLength, named.at.head(), message, "write { \"mono\": 0.6 } for a single one");
        return None;
    }
    let made: Vec<Option<SensorChannel>> = entries
        .iter()
        .map(|entry| {
            // Beside `meanPhotoelectrons.` it must fit into the 255 bytes of a channel's name.
            if entry.name.is_empty() || entry.name.len() > 64 || entry.name.contains('\0') {
                reader.error(Code::OutOfRange, entry.at, "the name of a channel has from 1 to 64 bytes without NUL");
            }
            let quantum_efficiency = match entry.value.as_ref()? {
                EfficiencyForm::Number(share) => QuantumEfficiency::Constant(share.0),
                EfficiencyForm::Table(form) => QuantumEfficiency::Table(table(form, reader)?),
            };
            Some(SensorChannel { name: entry.name.clone(), quantum_efficiency })
        })
        .collect();
    made.into_iter().collect()
}

fn table(form: &EfficiencyTable, reader: &mut Reader<'_>) -> Option<Tabulated> {
    let (wavelengths, values) = (form.wavelengths_nm.as_ref()?, form.values.as_ref()?);
    let before = reader.error_count();
    if wavelengths.0.len() < 2 {
        let message = format!("a table needs at least 2 wavelengths, but this one has {}", wavelengths.0.len());
        reader.error_hint(Code::WrongLength, form.at.head(), message, "for a constant efficiency write a number");
    }
    if wavelengths.0.len() != values.0.len() {
        let message = format!("{} wavelengths_nm, but {} values", wavelengths.0.len(), values.0.len());
        reader.error_hint(Code::WrongLength, form.at.head(), message, "each wavelength needs one");
    }
    for pair in wavelengths.0.windows(2) {
        if let [Some(first), Some(second)] = pair
            && second.value.0 <= first.value.0
        {
            let message = format!("wavelengths must increase, but {} follows {}", second.value.0, first.value.0);
            reader.error(Code::OutOfRange, second.at, message);
        }
    }
    let nm: Vec<f64> = wavelengths.0.iter().map(|nm| Some(nm.as_ref()?.value.0)).collect::<Option<_>>()?;
    let values: Vec<f64> = values.0.iter().map(|value| Some(value.as_ref()?.0)).collect::<Option<_>>()?;
    let outside = match form.outside? {
        Beyond::Zero => Outside::Zero,
        Beyond::Error => Outside::Hold,
    };
    if reader.error_count() > before {
        return None;
    }
    match Tabulated::new(nm, values, outside) {
        Ok(table) => Some(table),
        Err(error) => {
            reader.error(Code::OutOfRange, form.at.head(), error.to_string());
            None
        }
    }
}

fn mosaic_of(form: &Spanned<MosaicForm>, names: &[&str], reader: &mut Reader<'_>) -> Option<Mosaic> {
    let at: Span = form.at;
    let mut rows = Vec::new();
    for row in &form.value.0 {
        let mut numbers = Vec::new();
        for name in row {
            match names.iter().position(|known| known == name) {
                Some(number) => numbers.push(number),
                None => {
                    let message = format!("no channel is named \"{name}\"");
                    let hint = format!("\"quantum_efficiency\" has {}", json::listed(names.iter().copied()));
                    reader.error_hint(Code::UnknownName, at, message, hint);
                    return None;
                }
            }
        }
        rows.push(numbers);
    }
    match Mosaic::new(&rows) {
        Ok(mosaic) => Some(mosaic),
        Err(error) => {
            reader.error(Code::WrongLength, at, error.to_string());
            None
        }
    }
}
