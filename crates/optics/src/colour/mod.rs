//! From spectra to colours: the CIE 1931 2° observer, CIE illuminants, linear Rec. 709, the sRGB transfer function.

mod cie;
mod rec709;

pub(crate) use cie::colour_matching_rows;
pub use cie::{
    CIE_RANGE_NM, cie_y_integral_nm, colour_matching, illuminant_a, illuminant_d65, luminance_of, xyz_of,
    xyz_of_reflectance,
};
pub use rec709::{
    REC709_FROM_XYZ, REC709_PRIMARIES_XY, REC709_WHITE_XY, XYZ_FROM_REC709, rec709_from_xyz, rec709_to_xyz,
    srgb_decode, srgb_encode,
};
pub(crate) use rec709::{inverse, multiply, rgb_to_xyz_matrix};
