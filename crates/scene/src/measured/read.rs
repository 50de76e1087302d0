//! Files of measured BRDFs.

use super::tensor_file::TensorFile;
use super::{MeasuredArrays, MeasuredBrdf};

/// The greatest negative value of a spectrum that counts as noise of the measurement, over the greatest positive one.
const MOST_NOISE: f32 = 0.01;

/// Reads a measured BRDF from the bytes of a tensor file, and says what had to be changed.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn read_measured(bytes: &[u8]) -> Result<(MeasuredBrdf, Option<String>), String> {
    let file = TensorFile::new(bytes)?;
    if file.has("rgb") && !file.has("spectra") {
        let why = "it has colours (\"rgb\") and no spectra. Light is made of wavelengths here: take the file of the same material that has \"spectra\"";
        return Err(why.to_owned());
    }
    let list = |name: &str| file.floats::<1>(name).map(|(_, numbers)| numbers);
    let (shape, mut spectra) = file.floats("spectra")?;
    let changed = without_noise(&mut spectra);
    let arrays = MeasuredArrays {
        theta_i: list("theta_i")?,
        phi_i: list("phi_i")?,
        wavelengths_nm: list("wavelengths")?,
        ndf: file.floats("ndf")?,
        sigma: file.floats("sigma")?,
        vndf: file.floats("vndf")?,
        luminance: file.floats("luminance")?,
        spectra: (shape, spectra),
        jacobian: match file.byte("jacobian")? {
            0 => false,
            1 => true,
            other => return Err(format!("its field \"jacobian\" is {other}: it must be 0 or 1")),
        },
    };
    Ok((MeasuredBrdf::new(arrays)?, changed))
}

/// Makes 0 of slightly negative values, which noise of a measurement leaves. Others stay, and are refused.
fn without_noise(spectra: &mut [f32]) -> Option<String> {
    let most = spectra.iter().copied().fold(0.0, f32::max);
    let is_noise = |value: f32| value < 0.0 && value >= -MOST_NOISE * most;
    let least = spectra.iter().copied().fold(0.0, f32::min);
    if !is_noise(least) {
        return None;
    }
    let count = spectra.iter().filter(|value| is_noise(**value)).count();
    spectra.iter_mut().filter(|value| is_noise(**value)).for_each(|value| *value = 0.0);
    let all = spectra.len();
    Some(format!("{count} of {all} values of \"spectra\" are negative, the least is {least}: they count as 0"))
}
