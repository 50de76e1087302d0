//! A made-up measured BRDF that tables hold exactly: what it does, and its file.
//!
//! Every function below is bilinear in the quantities that tables interpolate. So a few nodes say all of it, and f has a closed form. A
//! direction (θ, φ) has the place x = √(2θ/π), y = (φ + π)/2π, of which facets count φ from the viewer if the material is isotropic. With
//! t = 2θ_o/π and s the azimuth of the viewer, from 0 at the first to 1 at the last of the file,
//!
//! - σ = 1 + x + ay/2, D = 3 − 2x + ay, with a = 1 of an anisotropic material and 0 of an isotropic one;
//! - the density of visible normals is (w + (1 − w) 2x)(½ + y), w = t(1 − s/2);
//! - so the place that it warps to (x, y) is x′ = wx + (1 − w)x², y′ = (y + y²)/2;
//! - S = c(λ) ((1 + t + s)/80 + x′(1 − t/2)/40 + 3y′(1 + s)/200).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::vector::{Vec3, add};

/// The azimuths of the viewer for which a file has tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Azimuths {
    /// None: the material is isotropic.
    One,
    /// From −π to 0: half a turn changes nothing.
    Half,
    /// From −π to −π/2: two mirrors change nothing.
    Quarter,
    /// From −π to π.
    All,
}

/// Such a material.
#[derive(Clone, Debug)]
pub(super) struct Made {
    pub(super) azimuths: Azimuths,
    /// Wavelengths, nm, and c at each.
    pub(super) colours: Vec<[f64; 2]>,
    /// Whether the file says D/(4σ) apart from S. Else S is all of f cos θ.
    pub(super) apart: bool,
}

/// A viewer and a facet in the coordinates of the tables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    /// The share of the way to the last angle and the last azimuth of the viewer.
    pub(super) viewer: [f64; 2],
    /// The viewer's and the facet's place in the square.
    pub(super) sigma: [f64; 2],
    pub(super) facet: [f64; 2],
}

impl Made {
    pub(super) fn grey(azimuths: Azimuths) -> Self {
        Self { azimuths, colours: vec![[550.0, 1.0]], apart: true }
    }

    /// 1 of what is anisotropic.
    fn grain(&self) -> f64 {
        f64::from(u8::from(self.azimuths != Azimuths::One))
    }

    /// The azimuth of the last tables.
    fn last(&self) -> f64 {
        match self.azimuths {
            Azimuths::One | Azimuths::Half => 0.0,
            Azimuths::Quarter => -FRAC_PI_2,
            Azimuths::All => PI,
        }
    }

    pub(super) fn sigma(&self, [x, y]: [f64; 2]) -> f64 {
        1.0 + x + 0.5 * self.grain() * y
    }

    pub(super) fn ndf(&self, [x, y]: [f64; 2]) -> f64 {
        3.0 - 2.0 * x + self.grain() * y
    }

    /// The density of visible normals.
    pub(super) fn visible([t, s]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
        let w = t * (1.0 - 0.5 * s);
        (w + (1.0 - w) * 2.0 * x) * (0.5 + y)
    }

    /// The place that the warp by visible normals takes to another.
    pub(super) fn unwarped([t, s]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
        let w = t * (1.0 - 0.5 * s);
        [w * x + (1.0 - w) * x * x, 0.5 * (y + y * y)]
    }

    /// S/c at a place of the square before the warp.
    pub(super) fn share([t, s]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
        (1.0 + t + s) / 80.0 + x * (1.0 - 0.5 * t) / 40.0 + 0.015 * y * (1.0 + s)
    }

    /// c, the same as at the ends beyond them.
    pub(super) fn colour(&self, nm: f64) -> f64 {
        let [first, last] = [self.colours[0], self.colours[self.colours.len() - 1]];
        if nm <= first[0] {
            return first[1];
        }
        let pair = self.colours.windows(2).find(|pair| nm <= pair[1][0]);
        pair.map_or(last[1], |pair| {
            pair[0][1] + (nm - pair[0][0]) / (pair[1][0] - pair[0][0]) * (pair[1][1] - pair[0][1])
        })
    }

    /// A viewer and a light above a surface whose u grows along x.
    pub(super) fn places(&self, o: Vec3, i: Vec3) -> Places {
        let h = add(o, i);
        let azimuth = |d: Vec3| d[1].atan2(d[0]);
        let polar = |d: Vec3| d[0].hypot(d[1]).atan2(d[2]);
        let (viewer, facet) = (azimuth(o), azimuth(h));
        // Into the azimuths of the tables, by angles.
        let (viewer, facet) = match self.azimuths {
            Azimuths::One => (0.0, facet - viewer),
            Azimuths::All => (viewer, facet),
            Azimuths::Half if viewer > 0.0 => (viewer - PI, facet - PI),
            Azimuths::Quarter if viewer > FRAC_PI_2 => (-viewer, -facet),
            Azimuths::Quarter if viewer > 0.0 => (viewer - PI, facet - PI),
            Azimuths::Quarter if viewer > -FRAC_PI_2 => (-PI - viewer, -PI - facet),
            Azimuths::Half | Azimuths::Quarter => (viewer, facet),
        };
        let across = |theta: f64| (theta / FRAC_PI_2).sqrt();
        let s = if self.azimuths == Azimuths::One { 0.0 } else { (viewer + PI) / (self.last() + PI) };
        Places {
            viewer: [polar(o) / FRAC_PI_2, s],
            sigma: [across(polar(o)), (viewer + PI) / TAU],
            facet: [across(polar(h)), ((facet + PI) / TAU).rem_euclid(1.0)],
        }
    }

    /// f cos θ_i/c.
    pub(super) fn f_cos(&self, o: Vec3, i: Vec3) -> f64 {
        let Places { viewer, sigma, facet } = self.places(o, i);
        let facets = if self.apart { self.ndf(facet) / (4.0 * self.sigma(sigma)) } else { 1.0 };
        Self::share(viewer, Self::unwarped(viewer, facet)) * facets
    }

    /// The name of the file, another for every other file.
    pub(super) fn name(&self) -> String {
        let azimuths = match self.azimuths {
            Azimuths::One => "isotropic",
            Azimuths::Half => "half-a-turn",
            Azimuths::Quarter => "two-mirrors",
            Azimuths::All => "no-symmetry",
        };
        let spectra = if self.apart { "" } else { "-whole-spectra" };
        format!("measured-{azimuths}{spectra}-{}.bsdf", self.colours.len())
    }

    /// The file.
    pub(super) fn file(&self) -> Vec<u8> {
        let azimuths: Vec<f64> = match self.azimuths {
            Azimuths::One => vec![0.0],
            _ => (0..3).map(|k| -PI + f64::from(k) * 0.5 * (self.last() + PI)).collect(),
        };
        let square = || [0.0, 1.0].into_iter().flat_map(|y| [0.0, 1.0].map(|x| [x, y]));
        let viewers: Vec<[f64; 2]> = azimuths
            .iter()
            .flat_map(|phi| {
                [0.0, 1.0].map(|t| [t, if azimuths.len() == 1 { 0.0 } else { (phi + PI) / (self.last() + PI) }])
            })
            .collect();
        let of_viewers = |of: &dyn Fn([f64; 2], [f64; 2]) -> f64| -> Vec<f64> {
            viewers.iter().flat_map(|viewer| square().map(|place| of(*viewer, place))).collect()
        };
        let spectra = viewers.iter().flat_map(|viewer| {
            let of_colour =
                move |[_, c]: &[f64; 2]| square().map(|place| c * Self::share(*viewer, place)).collect::<Vec<_>>();
            self.colours.iter().flat_map(of_colour)
        });
        let lights = azimuths.len() as u64;
        // Brightness guides directions, and changes no light: any will do.
        let luminance = of_viewers(&|[t, s], [x, y]| (0.5 + x + 0.5 * t) * (1.5 - y + 0.5 * s));
        let arrays = [
            ("theta_i", vec![2], vec![0.0, FRAC_PI_2]),
            ("phi_i", vec![lights], azimuths.clone()),
            ("ndf", vec![2, 2], square().map(|place| self.ndf(place)).collect()),
            ("sigma", vec![2, 2], square().map(|place| self.sigma(place)).collect()),
            ("vndf", vec![lights, 2, 2, 2], of_viewers(&Self::visible)),
            ("luminance", vec![lights, 2, 2, 2], luminance),
            ("spectra", vec![lights, 2, self.colours.len() as u64, 2, 2], spectra.collect()),
            ("wavelengths", vec![self.colours.len() as u64], self.colours.iter().map(|[nm, _]| *nm).collect()),
        ];
        tensor_file(&arrays, u8::from(self.apart))
    }
}

/// A tensor file of arrays of 32-bit numbers, of which the last extent runs first, and of one byte.
fn tensor_file(arrays: &[(&str, Vec<u64>, Vec<f64>)], jacobian: u8) -> Vec<u8> {
    let text = b"made up";
    let floats = arrays.iter().map(|(name, extents, values)| {
        let numbers: Vec<u8> = values.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect();
        (*name, 10, extents.clone(), numbers)
    });
    let bytes = [("description", 1, vec![text.len() as u64], text.to_vec()), ("jacobian", 1, vec![1], vec![jacobian])];
    let fields: Vec<(&str, u8, Vec<u64>, Vec<u8>)> = floats.chain(bytes).collect();
    let described: usize = fields.iter().map(|(name, _, extents, _)| 13 + name.len() + 8 * extents.len()).sum();
    let mut at = 18 + described as u64;
    let mut file = b"tensor_file\0\x01\0".to_vec();
    file.extend((fields.len() as u32).to_le_bytes());
    for (name, kind, extents, numbers) in &fields {
        file.extend((name.len() as u16).to_le_bytes());
        file.extend(name.bytes());
        file.extend((extents.len() as u16).to_le_bytes());
        file.push(*kind);
        file.extend(at.to_le_bytes());
        extents.iter().for_each(|extent| file.extend(extent.to_le_bytes()));
        at += numbers.len() as u64;
    }
    fields.iter().for_each(|(.., numbers)| file.extend(numbers));
    file
}
