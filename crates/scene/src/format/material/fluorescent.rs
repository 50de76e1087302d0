//! Surfaces that give light back at another wavelength.

use etalon_optics::spectrum::whole_nm;
use etalon_optics::{Fluorescence, Fluorophore, ReradiationMatrix, Spectrum};

use super::super::spectra::{Role, Spectra, accept, plain};
use super::super::spectrum::{SpectrumForm, Wavelength};
use super::{MaterialSides, Share};
use crate::json::{Code, List, NonNegative, Optional, Reader, Required, Rule, Spanned};
use crate::model::MaterialKind;

/// The most fluorophores of a material: each is asked at each of many pairs of wavelengths.
const MOST_FLUOROPHORES: usize = 64;

crate::record! {
    /// A dye: it absorbs light and emits it again, always in the same spectrum.
    pub(crate) struct FluorophoreForm + comment {
        /// Share of light that it absorbs, from 0 to 1.
        absorption: Required<SpectrumForm>,
        /// Power that it emits at each wavelength, in any unit: only its shape counts.
        emission: Required<SpectrumForm>,
        /// Photons that leave for each that is absorbed, from 0 to 1.
        quantum_yield: Required<Share> = "1",
    }
}

crate::record! {
    /// A measured reradiation: the power that leaves at a wavelength, for each nanometre there, of one unit of power that came in at another.
    /// Bilinear between its values and zero outside.
    pub(crate) struct ReradiationForm + comment {
        /// Wavelengths of the light that comes in, nm, increasing; at least two.
        excitation_nm: Required<List<Spanned<Wavelength>>>,
        /// Wavelengths of the light that leaves, nm, increasing; at least two.
        emission_nm: Required<List<Spanned<Wavelength>>>,
        /// For each wavelength of excitation a row of values at all those of emission, nm⁻¹. What is only reflected is left out.
        per_nm: Required<List<Spanned<List<Spanned<NonNegative>>>>>,
    }
}

crate::record! {
    /// Diffuse reflection, and light that is given back at another wavelength, as diffuse, on both sides unless "sides" says otherwise.
    pub(crate) struct FluorescentMaterial + comment {
        /// Share of light reflected at its own wavelength, from 0 to 1.
        reflectance: Required<SpectrumForm> = "0",
        /// The dyes.
        fluorophores: Optional<Spanned<List<FluorophoreForm>>>,
        /// Instead: a measured reradiation.
        reradiation: Optional<ReradiationForm>,
        /// Which sides reflect and fluoresce; another is black.
        sides: Required<MaterialSides> = r#""both""#,
    } with [
        Rule::OneOf(&["fluorophores", "reradiation"]),
    ]
}

/// The material of a form.
pub(super) fn fluorescent<'f>(
    form: &'f FluorescentMaterial,
    spectra: &mut Spectra<'f>,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    let reflectance = form.reflectance.as_ref().and_then(|form| spectra.resolve(form, Role::Reflectance, reader));
    let fluorescence = match (&form.fluorophores, &form.reradiation) {
        (Optional::Given(dyes), _) => fluorophores(dyes, spectra, reader).map(Fluorescence::Fluorophores),
        (_, Optional::Given(form)) => matrix(form, reader).map(Fluorescence::Matrix),
        _ => None,
    };
    let (reflectance, fluorescence) = (reflectance?, fluorescence?);
    conserves_energy(&reflectance, &fluorescence, spectra.range_nm?, form, reader)?;
    Some(form.sides?.of(MaterialKind::Fluorescent { reflectance: reflectance.into(), fluorescence }))
}

fn fluorophores<'f>(
    form: &'f Spanned<List<FluorophoreForm>>,
    spectra: &mut Spectra<'f>,
    reader: &mut Reader<'_>,
) -> Option<Vec<Fluorophore>> {
    let List(list) = &form.value;
    if list.is_empty() || list.len() > MOST_FLUOROPHORES {
        let message = format!("a material of {} fluorophores", list.len());
        reader.error_hint(Code::WrongLength, form.at, message, format!("it has from 1 to {MOST_FLUOROPHORES}"));
        return None;
    }
    // Every one is looked at, so that all errors are reported.
    let made: Vec<_> = list.iter().map(|dye| fluorophore(dye.as_ref()?, spectra, reader)).collect();
    made.into_iter().collect()
}

fn fluorophore<'f>(
    form: &'f FluorophoreForm,
    spectra: &mut Spectra<'f>,
    reader: &mut Reader<'_>,
) -> Option<Fluorophore> {
    let absorption = form.absorption.as_ref().and_then(|form| spectra.resolve(form, Role::Reflectance, reader));
    let emission = form.emission.as_ref().and_then(|form| spectra.resolve(form, Role::Emission, reader));
    let made = Fluorophore::new(absorption?, emission?, form.quantum_yield?.0, spectra.range_nm?);
    accept(made, form.at, reader)
}

fn matrix(form: &ReradiationForm, reader: &mut Reader<'_>) -> Option<ReradiationMatrix> {
    let excitation_nm = plain(form.excitation_nm.as_ref()?, |nm| nm.0)?;
    let emission_nm = plain(form.emission_nm.as_ref()?, |nm| nm.0)?;
    let List(rows) = form.per_nm.as_ref()?;
    let rows: Option<Vec<Vec<f64>>> = rows.iter().map(|row| plain(&row.as_ref()?.value, |value| value.0)).collect();
    accept(ReradiationMatrix::new(excitation_nm, emission_nm, &rows?), form.at, reader)
}

/// Whether no more light comes back than came in, at any wavelength that is rendered.
fn conserves_energy(
    reflectance: &Spectrum,
    fluorescence: &Fluorescence,
    range_nm: [f64; 2],
    form: &FluorescentMaterial,
    reader: &mut Reader<'_>,
) -> Option<()> {
    let mut nm: Vec<f64> = whole_nm(range_nm).collect();
    nm.extend(fluorescence.kinks_nm(range_nm).into_iter().chain(reflectance.kinks_nm(range_nm)));
    let returned = fluorescence.returned(&nm, fluorescence.emission_range_nm());
    let sums = nm.iter().zip(returned).map(|(nm, returned)| (*nm, reflectance.eval(*nm), returned));
    // More than one by what decimal shares and a quadrature round to is none.
    let worst = sums.max_by(|a, b| (a.1 + a.2).total_cmp(&(b.1 + b.2))).filter(|(_, r, f)| r + f > 1.0 + 1e-9);
    let Some((nm, reflected, returned)) = worst else { return Some(()) };
    let message = format!(
        "of light at {nm} nm {:.4} times as much comes back: {reflected:.4} reflected, {returned:.4} as fluorescence",
        reflected + returned
    );
    let hint = "a surface gives back at most what it receives: lower the reflectance, the absorption or the values";
    reader.error_hint(Code::OutOfRange, form.at.head(), message, hint);
    None
}
