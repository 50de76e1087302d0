//! Measured BRDFs: the tables of the RGL material database, and the files that hold them.
//!
//! # Formula
//!
//! Light from `i` that leaves along `o` meets the facet m = (i + o)/|i + o|. A direction (θ, φ) has the place x = √(2θ/π),
//! y = (φ + π)/2π in the unit square. Let q be the place of m, and V the warp by visible normals of `i`. The tables say
//!
//! f(i, o) cos θ_o = S(V⁻¹(q), λ) D(q)/(4 σ(p)), p the place of `i`.
//!
//! # Parameters
//!
//! | table | what it is |
//! |---|---|
//! | `theta_i`, `phi_i` | the directions `i` for which there are slices |
//! | `ndf` D, `sigma` σ | density of facet normals, and the area that facets show to a direction |
//! | `vndf` V | for each `i` the density of the facets that it sees, a [`Warp`] |
//! | `luminance` | for each `i` the brightness of S, a [`Warp`] |
//! | `spectra` S | for each `i` and each of `wavelengths` what light leaves |
//! | `jacobian` | whether D/(4σ) belongs to the formula, or S is all of it |
//!
//! # Source
//!
//! J. Dupuy & W. Jakob 2018, *An Adaptive Parameterization for Efficient Material Acquisition and Rendering*, ACM Transactions on Graphics
//! 37(6), section 4; the files: RGL, *Material database*, <https://rgl.epfl.ch/materials>.

mod read;
mod table;
mod tensor_file;
#[cfg(test)]
mod tests;
mod warp;

pub use read::read_measured;
pub use table::{Slices, Table};
pub use warp::Warp;

use std::f64::consts::PI;
use std::sync::Arc;

use table::neighbours;

/// By how much an angle of a file may miss what it should be, rad.
const ANGLE_ERROR: f64 = 0.02;

/// How a material looks when it is turned about its normal, and so for which azimuths of the light there are slices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Always the same: azimuths of facets count from that of the light.
    Isotropic,
    /// The same after half a turn: azimuths from −π to 0.
    HalfTurn,
    /// The same in two mirrors, along x and along y: azimuths from −π to −π/2.
    Mirrors,
    /// Never the same: azimuths from −π to π.
    None,
}

/// The tables of a measured BRDF.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredBrdf {
    theta_i: Vec<f64>,
    phi_i: Vec<f64>,
    wavelengths_nm: Vec<f64>,
    symmetry: Symmetry,
    ndf: Table,
    sigma: Table,
    vndf: Warp,
    luminance: Warp,
    spectra: Table,
    jacobian: bool,
    /// Found once: large tables take long to look through.
    grey: bool,
    zero: bool,
}

/// An array of a measured BRDF: its extents, of which the last runs first, and its values.
pub type MeasuredArray<const D: usize> = ([usize; D], Vec<f32>);

/// The arrays of a measured BRDF, as a file has them.
#[derive(Clone, Debug)]
pub struct MeasuredArrays {
    /// Angles of the light from the normal, rad.
    pub theta_i: Vec<f32>,
    /// Azimuths of the light, rad; one or two of an isotropic material.
    pub phi_i: Vec<f32>,
    /// Wavelengths of the spectra, nm.
    pub wavelengths_nm: Vec<f32>,
    /// By azimuth and angle of the facet.
    pub ndf: MeasuredArray<2>,
    /// By azimuth and angle of the light.
    pub sigma: MeasuredArray<2>,
    /// By azimuth and angle of the light, and those of the facet.
    pub vndf: MeasuredArray<4>,
    /// By azimuth and angle of the light, and the place in the square that [`MeasuredArrays::vndf`] warps.
    pub luminance: MeasuredArray<4>,
    /// The same, with the wavelength after the light.
    pub spectra: MeasuredArray<5>,
    /// Whether spectra are multiplied by D/(4σ).
    pub jacobian: bool,
}

/// A measured BRDF as a surface has it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredSurface {
    /// The tables.
    pub brdf: Arc<MeasuredBrdf>,
    /// By how much its x axis is turned, from growing u toward growing v, rad. It means nothing if the BRDF is isotropic.
    pub rotation_rad: f64,
    /// The wavelength that all others are treated like, nm, if one is.
    pub at_nm: Option<f64>,
}

impl MeasuredSurface {
    /// Whether it is the same when it is turned about its normal.
    pub fn is_isotropic(&self) -> bool {
        self.brdf.symmetry == Symmetry::Isotropic
    }

    /// Whether it treats wavelengths in different ways.
    pub fn is_coloured(&self) -> bool {
        self.at_nm.is_none() && !self.brdf.is_grey()
    }
}

impl MeasuredBrdf {
    /// The BRDF of these arrays.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn new(arrays: MeasuredArrays) -> Result<Self, String> {
        let theta_i = rising("theta_i", &arrays.theta_i, [0.0, 0.5 * PI])?;
        let phi_i = rising("phi_i", &arrays.phi_i, [-PI, PI])?;
        let wavelengths_nm = rising("wavelengths", &arrays.wavelengths_nm, [1.0, 1e6])?;
        let symmetry = symmetry(&phi_i)?;
        let lights = phi_i.len() * theta_i.len();
        let [ndf, sigma] = [("ndf", arrays.ndf), ("sigma", arrays.sigma)].map(|(name, ([rows, columns], values))| {
            Table::new(name, [columns, rows], 1, values).and_then(|table| table.check_sign(name))
        });
        let (ndf, sigma) = (ndf?, sigma?);
        // Facets show no area along the surface alone, if anywhere.
        let [columns, rows] = sigma.size();
        if (0..rows).any(|row| (0..columns - 1).any(|column| sigma.node(0, column, row) == 0.0)) {
            return Err("\"sigma\" is 0 for a direction that is not along the surface".to_owned());
        }
        let warp = |name, ([azimuths, angles, rows, columns], values): MeasuredArray<4>| {
            check_lights(name, [azimuths, angles], [&phi_i, &theta_i])?;
            Warp::new(name, Table::new(name, [columns, rows], lights, values)?.check_sign(name)?)
        };
        let (vndf, luminance) = (warp("vndf", arrays.vndf)?, warp("luminance", arrays.luminance)?);
        let ([azimuths, angles, colours, rows, columns], values) = arrays.spectra;
        check_lights("spectra", [azimuths, angles], [&phi_i, &theta_i])?;
        if colours != wavelengths_nm.len() {
            return Err(format!(
                "\"spectra\" has {colours} wavelengths, but \"wavelengths\" has {}",
                wavelengths_nm.len()
            ));
        }
        let slices = lights.checked_mul(colours).ok_or("\"spectra\" has too many slices")?;
        let spectra = Table::new("spectra", [columns, rows], slices, values)?.check_sign("spectra")?;
        let jacobian = arrays.jacobian;
        let of_lights: Vec<&[f32]> = spectra.slices().collect();
        let grey = of_lights.chunks(colours).all(|light| light.iter().all(|slice| *slice == light[0]));
        let zero = of_lights.iter().all(|slice| slice.iter().all(|value| *value == 0.0));
        drop(of_lights);
        Ok(Self {
            theta_i,
            phi_i,
            wavelengths_nm,
            symmetry,
            ndf,
            sigma,
            vndf,
            luminance,
            spectra,
            jacobian,
            grey,
            zero,
        })
    }

    /// How it looks when it is turned.
    pub fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    /// The slices for light from a direction, rad.
    #[inline]
    pub fn light(&self, theta_rad: f64, phi_rad: f64) -> Slices {
        Slices::of([&self.phi_i, &self.theta_i], [phi_rad, theta_rad])
    }

    /// The warp by the brightness of light.
    pub fn luminance(&self) -> &Warp {
        &self.luminance
    }

    /// The warp by visible normals.
    pub fn vndf(&self) -> &Warp {
        &self.vndf
    }

    /// D/(4σ) at the places of the facet and of the light; 1 if the file has it in its spectra. `None` where facets show no area.
    #[inline]
    pub fn facets(&self, facet: [f64; 2], light: [f64; 2]) -> Option<f64> {
        if !self.jacobian {
            return Some(1.0);
        }
        let sigma = self.sigma.eval(light);
        (sigma > 0.0).then(|| self.ndf.eval(facet) / (4.0 * sigma))
    }

    /// The spectra at a place of the square, at each of these wavelengths: linear between those of the file, and the same as at the first and
    /// the last beyond them.
    #[inline]
    pub fn spectra<const N: usize>(&self, slices: &Slices, place: [f64; 2], wavelengths_nm: [f64; N]) -> [f64; N] {
        let cell = self.spectra.cell(place);
        let colours = self.wavelengths_nm.len();
        wavelengths_nm.map(|nm| {
            let [(first, share), (second, other)] = neighbours(&self.wavelengths_nm, nm);
            let at = |colour: usize| slices.mean(|light| self.spectra.bilinear(light * colours + colour, cell));
            if other == 0.0 { at(first) } else { share * at(first) + other * at(second) }
        })
    }

    /// The wavelengths of the file, nm.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// Whether it treats all wavelengths alike.
    pub fn is_grey(&self) -> bool {
        self.grey
    }

    /// Whether it reflects nothing.
    pub fn is_zero(&self) -> bool {
        self.zero
    }
}

/// Numbers that rise within a range, which rounding may pass.
fn rising(name: &str, numbers: &[f32], [least, most]: [f64; 2]) -> Result<Vec<f64>, String> {
    if numbers.is_empty() {
        return Err(format!("\"{name}\" is empty"));
    }
    if let Some(place) =
        (1..numbers.len()).find(|place| numbers[place - 1].partial_cmp(&numbers[*place]).is_none_or(|o| o.is_ge()))
    {
        return Err(format!("\"{name}\" does not rise: after {} comes {}", numbers[place - 1], numbers[place]));
    }
    let numbers: Vec<f64> = numbers.iter().map(|number| f64::from(*number)).collect();
    match numbers.iter().find(|number| !(least - ANGLE_ERROR..=most + ANGLE_ERROR).contains(*number)) {
        Some(number) => Err(format!("\"{name}\" has {number}, which is not from {least} to {most}")),
        None => Ok(numbers),
    }
}

/// What the azimuths of the light say of the material.
fn symmetry(phi_i: &[f64]) -> Result<Symmetry, String> {
    if phi_i.len() <= 2 {
        return Ok(Symmetry::Isotropic);
    }
    let [first, last] = [phi_i[0], phi_i[phi_i.len() - 1]];
    let near = |angle: f64, other: f64| (angle - other).abs() <= ANGLE_ERROR;
    let ends = [(Symmetry::Mirrors, -0.5 * PI), (Symmetry::HalfTurn, 0.0), (Symmetry::None, PI)];
    match ends.into_iter().find(|(_, end)| near(first, -PI) && near(last, *end)) {
        Some((symmetry, _)) => Ok(symmetry),
        None => Err(format!("\"phi_i\" reaches from {first} to {last}: it must reach from −π to −π/2, 0 or π")),
    }
}

/// That a table has a slice for each direction of the light.
fn check_lights(name: &str, [azimuths, angles]: [usize; 2], [phi_i, theta_i]: [&[f64]; 2]) -> Result<(), String> {
    if [azimuths, angles] == [phi_i.len(), theta_i.len()] {
        return Ok(());
    }
    let (phi, theta) = (phi_i.len(), theta_i.len());
    Err(format!(
        "\"{name}\" has {azimuths} × {angles} directions of the light, but \"phi_i\" and \"theta_i\" have {phi} × {theta}"
    ))
}
