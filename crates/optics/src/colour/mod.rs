//! From spectra to colours: the CIE 1931 2° observer, CIE illuminants and daylight, linear RGB of Rec. 709 and of other
//! primaries, the sRGB transfer function, chromatic adaptation, CIELAB.

mod adaptation;
mod cie;
mod daylight;
mod lab;
mod matrix;
mod rec709;

pub use adaptation::adaptation;
pub(crate) use cie::colour_matching_rows;
pub use cie::{
    CIE_RANGE_NM, LUMINOUS_EFFICACY, cie_y_integral_nm, colour_matching, illuminant_a, illuminant_d65, luminance_of,
    xyz_of,
};
pub use daylight::{
    daylight_chromaticity, daylight_components, daylight_luminances, daylight_wavelengths_nm, daylight_weights,
};
pub use lab::{lab_from_xyz, xyz_from_lab};
pub use matrix::{Matrix, inverse, multiply, product};
pub(crate) use rec709::rgb_to_xyz_matrix;
pub use rec709::{
    REC709_FROM_XYZ, REC709_PRIMARIES_XY, REC709_WHITE_XY, XYZ_FROM_REC709, rec709_from_xyz, rec709_luminance,
    rec709_to_xyz, srgb_decode, srgb_encode, xyz_from_rgb, xyz_of_chromaticity,
};
