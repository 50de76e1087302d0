//! Polarisers and retarders.

use super::super::spectra::{Role, Spectra};
use super::super::spectrum::{SpectrumForm, Wavelength};
use super::Share;
use crate::json::{Direction, Optional, Reader, Required};
use crate::model::{MaterialKind, PolarisingSheet};

crate::record! {
    /// An ideal linear polariser without thickness: light passes straight on, all of it that swings along the axis. It calls for
    /// polarisation.
    pub(crate) struct PolariserMaterial + comment {
        /// Along which light may swing, in the object's own coordinates; only its direction along the surface counts.
        axis: Required<Direction>,
        /// Share that passes of light that swings along the axis, from 0 to 1.
        transmittance: Required<SpectrumForm> = "1",
        /// What passes of light that swings across the axis, over that share, from 0 (ideal) to 1.
        extinction: Required<Share> = "0",
    }
}

crate::record! {
    /// A wave plate without thickness: light passes straight on, and what swings across the fast axis is delayed. It calls for
    /// polarisation.
    pub(crate) struct RetarderMaterial + comment {
        /// The fast axis, in the object's own coordinates; only its direction along the surface counts.
        axis: Required<Direction>,
        /// The delay: 90 is a quarter of a wave, 180 half of one.
        retardance_deg: Required<f64>,
        /// The wavelength at which this is the delay, nm; at others it is in inverse proportion. Left out: at all.
        at_nm: Optional<Wavelength>,
    }
}

/// The polariser of a form.
pub(super) fn polariser<'f>(
    form: &'f PolariserMaterial,
    spectra: &mut Spectra<'f>,
    reader: &mut Reader<'_>,
) -> Option<MaterialKind> {
    let transmittance = spectra.resolve(form.transmittance.as_ref()?, Role::Reflectance, reader);
    let sheet = PolarisingSheet::Polariser { transmittance: transmittance?, extinction: form.extinction?.0 };
    Some(MaterialKind::PolarisingSheet { axis: form.axis?.0, sheet })
}

/// The retarder of a form.
pub(super) fn retarder(form: &RetarderMaterial) -> Option<MaterialKind> {
    let at_nm = form.at_nm.clone().checked()?.map(|at| at.0);
    let sheet = PolarisingSheet::Retarder { retardance_rad: form.retardance_deg?.to_radians(), at_nm };
    Some(MaterialKind::PolarisingSheet { axis: form.axis?.0, sheet })
}
