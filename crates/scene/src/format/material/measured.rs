//! Measured BRDFs.

use super::MaterialSides;
use crate::files::Files;
use crate::json::{Code, Optional, Reader, Required, Spanned};
use crate::measured::MeasuredSurface;
use crate::model::MaterialKind;

crate::record! {
    /// A measured BRDF from a file of the RGL material database. It reflects on the side that was measured, unless "sides" says otherwise.
    pub(crate) struct MeasuredMaterial + comment {
        /// A .bsdf file with spectra, relative to this file's folder.
        file: Required<Spanned<String>>,
        /// Of an anisotropic material: by how much its x axis is turned from growing u toward growing v, degrees.
        tangent_rotation_deg: Optional<Spanned<f64>>,
        /// Which sides reflect; another is black.
        sides: Required<MaterialSides> = r#""front""#,
    }
}

/// The material of a form.
pub(super) fn measured(form: &MeasuredMaterial, files: &mut Files, reader: &mut Reader<'_>) -> Option<MaterialKind> {
    let brdf = form.file.as_ref().and_then(|name| files.measured(name, reader));
    let (brdf, turned, sides) = (brdf?, form.tangent_rotation_deg.clone().checked()?, form.sides?);
    let rotation_rad = turned.as_ref().map_or(0.0, |deg| deg.value.to_radians());
    let surface = MeasuredSurface { brdf, rotation_rad, at_nm: None };
    if let Some(turned) = turned
        && surface.is_isotropic()
    {
        let message = "the material is isotropic: it looks the same when it is turned";
        reader.error_hint(Code::KeyConflict, turned.at, message, "leave it out");
        return None;
    }
    Some(sides.of(MaterialKind::Measured { surface }))
}
