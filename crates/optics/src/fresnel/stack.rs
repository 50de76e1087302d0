//! Reflection and transmission at an interface that is coated with thin films.
//!
//! The waves that the faces of a film reflect interfere: their amplitudes add, not their powers. Each layer is a characteristic matrix
//! that takes the tangential fields at its far face to those at its near one (F. Abelès 1950; Born & Wolf, *Principles of Optics*,
//! §1.6; H. A. Macleod, *Thin-Film Optical Filters*, §2.6), for each of the two polarisations, of any complex index, beyond critical angles too.

use super::refracted_cosine;
use crate::complex::Complex;
use crate::exponential::{exp_neg, one_minus_exp_neg};
use crate::real::Real;

/// A layer of a thin film at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Index n + ik relative to vacuum; n above 0, k at least 0.
    pub index: Complex,
    /// Thickness, nm, at least 0.
    pub thickness_nm: f64,
}

/// Amplitude ratios of light polarised perpendicular (s) and parallel (p) to the plane of incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amplitudes {
    /// Of s.
    pub s: Complex,
    /// Of p.
    pub p: Complex,
}

impl Amplitudes {
    /// The share of unpolarised power.
    #[inline]
    pub fn power(&self) -> f64 {
        0.5 * (self.s.squared() + self.p.squared())
    }
}

/// What a coated interface does to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StackFresnel {
    /// Reflected waves, p with the sign convention in which r_p = −r_s at normal incidence on a bare interface.
    pub reflection: Amplitudes,
    /// Transmitted waves, scaled such that their squares are shares of power. 0 where nothing is carried away behind the interface.
    pub transmission: Amplitudes,
}

/// The interface between a transparent medium of the index `incident` above 0, where light arrives at `cos_i` in [0, 1], and one of the
/// index `substrate`, with `layers` between them **from the innermost to the outermost**; the wavelength in vacuum, nm, above 0.
///
/// Waves run as exp(−iωt), so that n + ik with k ≥ 0 absorbs. With q = √(n² − n₁² sin²) the wave's normal component over that in
/// vacuum and u = q for s, q/n² for p, the field F that is tangential (E for s, H for p) and its partner G = u·F obey across a layer
/// of thickness d
///
/// F ← F cos δ − i G sin δ/u, G ← G cos δ − i u F sin δ, δ = 2πqd/λ,
///
/// from (1, u) behind the interface; r = (u₁F − G)/(u₁F + G). Matrices are scaled by e^(−Im δ), so that thick layers that absorb do not
/// overflow. A layer that absorbs nothing and that light runs through has a real matrix: one root and no exponential. Then
/// R + T = 1 to a few roundings for each layer.
#[inline]
pub fn stack(
    cos_i: f64,
    wavelength_nm: f64,
    incident: f64,
    layers: impl Iterator<Item = Layer>,
    substrate: Complex,
) -> StackFresnel {
    let sin2 = (1.0 - cos_i) * (1.0 + cos_i);
    let tangential = incident * incident * sin2;
    let (q_t, m2_t) = match substrate.im {
        // The rays that the walk follows refract, or not, by this very cosine.
        0.0 => match refracted_cosine(cos_i, substrate.re / incident) {
            Some(cos_t) => (Complex::real(substrate.re * cos_t), Complex::real(substrate.re * substrate.re)),
            None => {
                let m2 = substrate.re * substrate.re;
                (Complex::new(0.0, (tangential - m2).sqrt_nonnegative()), Complex::real(m2))
            }
        },
        _ => normal_component(substrate, tangential),
    };
    between(tangential, wavelength_nm, [incident * cos_i, cos_i / incident], layers, [q_t, q_t.over(m2_t)])
}

/// [`stack`] of light that leaves at the cosine `cos_o` into a transparent medium of the index `behind`, from `cos_i` in the first medium.
/// Where it leaves at a grazing angle `cos_i` alone does not tell how grazing: its last digits are lost.
#[inline]
pub fn stack_leaving(
    (cos_i, cos_o): (f64, f64),
    wavelength_nm: f64,
    incident: f64,
    layers: impl Iterator<Item = Layer>,
    behind: f64,
) -> StackFresnel {
    let tangential = behind * behind * (1.0 - cos_o) * (1.0 + cos_o);
    let u_t = [behind * cos_o, cos_o / behind].map(Complex::real);
    between(tangential, wavelength_nm, [incident * cos_i, cos_i / incident], layers, u_t)
}

/// [`stack`] from the square of the waves' component along the surface and u of the two media, for s and p.
#[inline(always)]
fn between(
    tangential: f64,
    wavelength_nm: f64,
    u_i: [f64; 2],
    layers: impl Iterator<Item = Layer>,
    u_t: [Complex; 2],
) -> StackFresnel {
    let mut fields = [(Complex::ONE, u_t[0]), (Complex::ONE, u_t[1])];
    let mut scale = 1.0;
    for Layer { index, thickness_nm } in layers {
        let waves = thickness_nm / wavelength_nm;
        match crossing(index, tangential) {
            Crossing::Lossless { q, m2 } => {
                let (sin, cos) = sin_cos_of_phase(q * waves);
                let over_q = if q == 0.0 { 2.0 * f64::PI * waves } else { sin / q };
                for ((f, g), (u_sin, over_u)) in fields.iter_mut().zip([(q * sin, over_q), (q * sin / m2, over_q * m2)])
                {
                    let (before_f, before_g) = (*f, *g);
                    *f = before_f.scaled(cos) - before_g.scaled(over_u).times_i();
                    *g = before_g.scaled(cos) - before_f.scaled(u_sin).times_i();
                }
            }
            Crossing::Decaying { q, m2 } => {
                let (sin, cos) = sin_cos_of_phase(q.re * waves);
                let decay = 2.0 * f64::PI * q.im * waves;
                let (kept, lost) = (0.5 * (1.0 + exp_neg(2.0 * decay)), 0.5 * one_minus_exp_neg(2.0 * decay));
                scale *= exp_neg(decay);
                let cos_delta = Complex::new(cos * kept, -sin * lost);
                let sin_delta = Complex::new(sin * kept, cos * lost);
                let over_q = if q == Complex::ZERO { Complex::real(2.0 * f64::PI * waves) } else { sin_delta.over(q) };
                for ((f, g), (u, over_u)) in fields.iter_mut().zip([(q, over_q), (q.over(m2), over_q * m2)]) {
                    let (before_f, before_g) = (*f, *g);
                    *f = before_f * cos_delta - (before_g * over_u).times_i();
                    *g = before_g * cos_delta - (before_f * u * sin_delta).times_i();
                }
            }
        }
    }
    let wave = |k: usize| {
        let (f, g) = (fields[k].0.scaled(u_i[k]), fields[k].1);
        let sum = f + g;
        if sum == Complex::ZERO {
            // Along an interface of two equal media: the limit of grazing incidence.
            return (Complex::real(-1.0), Complex::ZERO);
        }
        let passed = 2.0 * scale * (u_i[k] * u_t[k].re).sqrt_nonnegative();
        ((f - g).over(sum), Complex::real(passed).over(sum))
    };
    let ((r_s, t_s), (r_p, t_p)) = (wave(0), wave(1));
    StackFresnel { reflection: Amplitudes { s: r_s, p: r_p }, transmission: Amplitudes { s: t_s, p: t_p } }
}

/// How a wave crosses a layer: q, and the square of the layer's index.
enum Crossing {
    /// The layer is transparent and light runs through it: all its numbers are real.
    Lossless { q: f64, m2: f64 },
    /// It absorbs, or the wave is evanescent.
    Decaying { q: Complex, m2: Complex },
}

#[inline(always)]
fn crossing(index: Complex, tangential: f64) -> Crossing {
    let m2 = index.re * index.re;
    if index.im == 0.0 && m2 >= tangential {
        return Crossing::Lossless { q: (m2 - tangential).sqrt_nonnegative(), m2 };
    }
    let (q, m2) = normal_component(index, tangential);
    Crossing::Decaying { q, m2 }
}

/// Of a phase in turns, at least 0.
#[inline(always)]
fn sin_cos_of_phase(turns: f64) -> (f64, f64) {
    f64::sin_cos_turns(turns - (turns as u64) as f64)
}

/// q in the first quadrant for an index n + ik, and (n + ik)².
#[inline(always)]
fn normal_component(index: Complex, tangential: f64) -> (Complex, Complex) {
    let m2 = Complex::new((index.re - index.im) * (index.re + index.im), 2.0 * index.re * index.im);
    (Complex::new(m2.re - tangential, m2.im).sqrt_upper(), m2)
}
