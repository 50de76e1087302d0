//! Mueller matrices of surfaces, each over its first element: that one is what the unpolarised BSDF has.
//!
//! What a smooth interface, a metal or a facet does follows from its complex amplitude ratios r_s, r_p or t_s, t_p, s at right
//! angles to the plane of incidence: with D = |a_s|² + |a_p|², a = (|a_s|² − |a_p|²)/D and c + id = 2a_s a_p*/D, the matrix in
//! the frames whose x is s is ((1, a), (a, 1)) on (S₀, S₁) and ((c, −d), (d, c)) on (S₂, S₃). Light that meets a diffuse ground
//! forgets all but what the ways in and out do to it: e_out e_inᵀ. Sums of them, each by its share, are what mixtures and
//! incoherent orders of reflection do.

use etalon_optics::fresnel::{Amplitudes, StackFresnel};
use etalon_optics::{Complex, Lanes, Vec3, fresnel};

/// A Mueller matrix, row by row.
pub type Matrix = [[f64; 4]; 4];

/// What a surface does to Stokes vectors at each wavelength, over its first element.
#[derive(Clone, Copy, Debug)]
pub struct Mueller<const N: usize> {
    /// Row by row, in the frames whose x is `x`.
    pub rows: [[Lanes<f64, N>; 4]; 4],
    /// The x of the frames of both rays, to rounding at right angles to them; not 0, of any length.
    pub x: Vec3<f64>,
}

impl<const N: usize> Mueller<N> {
    /// Of one matrix for each wavelength.
    pub fn of(matrices: [Matrix; N], x: Vec3<f64>) -> Self {
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| Lanes::from_fn(|lane| matrices[lane][i][j])));
        Self { rows, x }
    }

    /// The matrix of one wavelength.
    pub fn matrix(&self, lane: usize) -> Matrix {
        self.rows.map(|row| row.map(|lanes| lanes[lane]))
    }
}

/// Leaves everything as it is.
pub const IDENTITY: Matrix = pair(0.0, 1.0, 0.0);

/// Passes light on unpolarised.
pub const DEPOLARISER: Matrix = {
    let mut matrix = [[0.0; 4]; 4];
    matrix[0][0] = 1.0;
    matrix
};

/// The matrix of a pair of amplitudes.
pub(crate) const fn pair(a: f64, c: f64, d: f64) -> Matrix {
    [[1.0, a, 0.0, 0.0], [a, 1.0, 0.0, 0.0], [0.0, 0.0, c, -d], [0.0, 0.0, d, c]]
}

/// The sum of matrices over their first elements, which are the weights; a depolariser where all are 0.
pub(crate) fn mixed<const K: usize>(parts: [(f64, Matrix); K]) -> Matrix {
    let sum: f64 = parts.iter().map(|(weight, _)| weight).sum();
    if sum <= 0.0 {
        return DEPOLARISER;
    }
    std::array::from_fn(|i| std::array::from_fn(|j| parts.iter().map(|(weight, m)| weight / sum * m[i][j]).sum()))
}

/// The Stokes vector over its first element, in the frame of `x`, of light that travels along `k` and has S₁ and S₂ in the frame of
/// `along`; both vectors are unit vectors at right angles to `k`.
pub(crate) fn linear([s1, s2]: [f64; 2], along: Vec3<f64>, k: Vec3<f64>, x: Vec3<f64>) -> [f64; 4] {
    let (cos, sin) = (x.dot(along), k.cross(x).dot(along));
    let squared = cos * cos + sin * sin;
    let turned = [s1 * (cos * cos - sin * sin) / squared, s1 * 2.0 * cos * sin / squared];
    if s2 == 0.0 {
        return [1.0, turned[0], turned[1], 0.0];
    }
    let also = [-s2 * 2.0 * cos * sin / squared, s2 * (cos * cos - sin * sin) / squared];
    [1.0, turned[0] + also[0], turned[1] + also[1], 0.0]
}

/// Light that forgot its polarisation within: `out` is what the way out makes of unpolarised light, `on_way_in` the Stokes
/// vector to which the way in opens.
pub(crate) fn forgotten(out: [f64; 4], on_way_in: [f64; 4]) -> Matrix {
    out.map(|o| on_way_in.map(|i| o * i))
}

/// The matrix of two complex amplitudes.
fn of_amplitudes(s: Complex, p: Complex) -> Matrix {
    let (ss, pp) = (s.squared(), p.squared());
    let sum = ss + pp;
    if sum == 0.0 {
        // Nothing is reflected: no light, whatever its state.
        return IDENTITY;
    }
    let product = s * p.conjugate();
    pair((ss - pp) / sum, 2.0 * product.re / sum, 2.0 * product.im / sum)
}

/// An ideal mirror, which is a perfect conductor.
pub(crate) const MIRROR: Matrix = pair(0.0, -1.0, 0.0);

/// Reflection at an interface of relative index `eta`, total or not.
///
/// Beyond the critical angle the refracted wave decays: n·cos_t = i√(sin² − n²) (Born & Wolf, *Principles of Optics*, §1.5.4).
pub fn dielectric_reflection(cos: f64, eta: f64) -> Matrix {
    match fresnel::dielectric(cos, eta) {
        Some(fresnel) => of_amplitudes(Complex::real(fresnel.r_s), Complex::real(fresnel.r_p)),
        None => {
            let g = ((1.0 - cos) * (1.0 + cos) - eta * eta).max(0.0).sqrt();
            let ratio = |real: f64| Complex::new(real, -g).over(Complex::new(real, g));
            of_amplitudes(ratio(cos), ratio(eta * eta * cos))
        }
    }
}

/// Transmission through an interface of relative index `eta`, met at `cos` and left at `cos_t`: t_s : t_p = 1/k : 1/l with
/// k = c + n·c_t and l = n·c + c_t. The same in both directions.
pub fn dielectric_transmission(cos: f64, eta: f64, cos_t: f64) -> Matrix {
    let (k, l) = (cos + eta * cos_t, eta * cos + cos_t);
    of_amplitudes(Complex::real(l), Complex::real(k))
}

/// Reflection at a metal of relative index `n` + i`k`, from r_s = (c − q)/(c + q) and r_p = (m²c − q)/(m²c + q) with m = n + ik
/// and q = √(m² − sin²), its real part not negative.
pub fn conductor_reflection(cos: f64, n: f64, k: f64) -> Matrix {
    let m2 = Complex::new((n - k) * (n + k), 2.0 * n * k);
    let q = Complex::new(m2.re - (1.0 - cos) * (1.0 + cos), m2.im).sqrt_upper();
    let ratio = |u: Complex| (u - q).over(u + q);
    of_amplitudes(ratio(Complex::real(cos)), ratio(m2.scaled(cos)))
}

/// The waves that a coated interface reflects, or those that it transmits.
pub fn of_waves(amplitudes: &Amplitudes) -> Matrix {
    of_amplitudes(amplitudes.s, amplitudes.p)
}

/// What a thin pane of relative index `eta` makes of light that meets it at `cos`.
#[derive(Clone, Copy, Debug)]
pub struct Pane {
    /// Share of unpolarised light that is reflected.
    pub reflectance: f64,
    /// Share of unpolarised light that passes.
    pub transmittance: f64,
    /// The matrix of reflection over its first element.
    pub reflection: Matrix,
    /// The matrix of transmission over its first element.
    pub transmission: Matrix,
}

/// The orders of reflection between the faces of a pane added without interference: as Stokes vectors.
///
/// With R_s, R_p and q = r_s r_p of one face: R + T²R + T²R³ + … = 2R/(1 + R) and T/(1 + R) for s and p each, and for what is
/// coherent between them, T_s T_p the product for a way in and out, q + T_sT_p(q + q³ + …) = q(1 + T_sT_p/(1 − q²)) and
/// T_sT_p/(1 − q²).
pub fn pane(cos: f64, eta: f64) -> Pane {
    let Some(f) = fresnel::dielectric(cos, eta) else {
        // Into a pane that is thinner optically than what surrounds it nothing gets.
        let reflection = dielectric_reflection(cos, eta);
        return Pane { reflectance: 1.0, transmittance: 0.0, reflection, transmission: IDENTITY };
    };
    let (r_s, r_p) = (f.r_s * f.r_s, f.r_p * f.r_p);
    let q = f.r_s * f.r_p;
    // Directly, not as 1 − R: with k and l as in `dielectric_transmission`.
    let (k, l) = (cos + eta * f.cos_t, eta * cos + f.cos_t);
    let both = 4.0 * eta * cos * f.cos_t;
    let (t_s, t_p) = (both / (k * k), both / (l * l));
    // 1 − q² = 1 − R_s R_p = T_s + R_s T_p.
    let rest = t_s + r_s * t_p;
    let matrix = |s: f64, p: f64, coherent: f64| {
        let sum = s + p;
        // Where nothing is reflected, or at grazing incidence nothing passes.
        if sum > 0.0 { pair((s - p) / sum, 2.0 * coherent / sum, 0.0) } else { IDENTITY }
    };
    let (reflected_s, reflected_p) = (2.0 * r_s / (1.0 + r_s), 2.0 * r_p / (1.0 + r_p));
    let (passed_s, passed_p) = (t_s / (1.0 + r_s), t_p / (1.0 + r_p));
    let passed = if rest > 0.0 { t_s * t_p / rest } else { 0.0 };
    Pane {
        reflectance: 0.5 * (reflected_s + reflected_p),
        transmittance: 0.5 * (passed_s + passed_p),
        reflection: matrix(reflected_s, reflected_p, q * (1.0 + passed)),
        transmission: matrix(passed_s, passed_p, passed),
    }
}

/// [`pane()`] of a pane whose faces are coated alike: `outer` is what a face does to light from without, `inner` what it does to light that
/// has got in. Both pass the same waves, and absorb what they do not return.
///
/// R_o + T²R_i/(1 − R_i²) and T²/(1 − R_i²) for s and p each; for what is coherent between them the same sums of the complex
/// products a_s a_p*.
pub fn coated_pane(outer: &StackFresnel, inner: &StackFresnel) -> Pane {
    let orders = |outer: f64, inner: f64, passed: f64| {
        let left = (1.0 - inner) * (1.0 + inner);
        let through = if left > 0.0 { passed * passed / left } else { 0.0 };
        (outer + through * inner, through)
    };
    let of_each =
        |of: fn(&Amplitudes) -> f64| orders(of(&outer.reflection), of(&inner.reflection), of(&outer.transmission));
    let ((r_s, t_s), (r_p, t_p)) = (of_each(|a| a.s.squared()), of_each(|a| a.p.squared()));
    let product = |a: &Amplitudes| a.s * a.p.conjugate();
    let (inside, passed) = (product(&inner.reflection), product(&outer.transmission));
    let left = Complex::ONE - inside * inside;
    let through = if left.squared() > 0.0 { (passed * passed).over(left) } else { Complex::ZERO };
    let matrix = |s: f64, p: f64, coherent: Complex| {
        let sum = s + p;
        if sum > 0.0 { pair((s - p) / sum, 2.0 * coherent.re / sum, 2.0 * coherent.im / sum) } else { IDENTITY }
    };
    Pane {
        reflectance: 0.5 * (r_s + r_p),
        transmittance: 0.5 * (t_s + t_p),
        reflection: matrix(r_s, r_p, product(&outer.reflection) + through * inside),
        transmission: matrix(t_s, t_p, through),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_optics::Real;

    fn stokes(m: Matrix, s: [f64; 4]) -> [f64; 4] {
        m.map(|row| (0..4).map(|j| row[j] * s[j]).sum())
    }

    /// (a, c, d) of a pair's matrix.
    fn elements(m: Matrix) -> [f64; 3] {
        [m[0][1], m[2][2], m[3][2]]
    }

    /// A matrix is physical if it takes no fully polarised light beyond full polarisation; for these, if a² + c² + d² = 1.
    #[test]
    fn every_matrix_of_amplitudes_is_physical_and_pure() {
        for i in 1..=1000 {
            let cos = f64::from(i) / 1000.0;
            for n in [0.4, 0.7, 1.33, 1.5, 2.4] {
                let mut all = vec![
                    dielectric_reflection(cos, n),
                    conductor_reflection(cos, n, 0.3),
                    conductor_reflection(cos, n, 6.0),
                ];
                if let Some(f) = fresnel::dielectric(cos, n) {
                    all.push(dielectric_transmission(cos, n, f.cos_t));
                }
                for m in all.map_elements() {
                    assert!((m[0] * m[0] + m[1] * m[1] + m[2] * m[2] - 1.0).abs() < 1e-12, "{cos} {n}: {m:?}");
                }
            }
        }
    }

    trait MapElements {
        fn map_elements(self) -> Vec<[f64; 3]>;
    }

    impl MapElements for Vec<Matrix> {
        fn map_elements(self) -> Vec<[f64; 3]> {
            self.into_iter().map(elements).collect()
        }
    }

    #[test]
    fn brewster_polarises_all_that_it_reflects() {
        let n = 1.5_f64;
        let cos = 1.0 / (1.0 + n * n).sqrt();
        let reflected = stokes(dielectric_reflection(cos, n), [1.0, 0.0, 0.0, 0.0]);
        assert!((reflected[1] - 1.0).abs() < 1e-14 && (reflected[0] - 1.0).abs() < 1e-14);
    }

    /// Fresnel's rhomb: two total reflections in glass of 1.51 at 54°37′ (Born & Wolf, §1.5.4) turn light at 45° into circular
    /// light, since each puts s behind p by 45°: tan(δ/2) = cos·√(sin² − 1/n²)/sin². Light at +45° then is right-handed, as behind a
    /// quarter-wave plate whose fast axis is p, −y.
    #[test]
    fn two_total_reflections_of_a_rhomb_make_linear_light_circular() {
        let n = 1.51_f64;
        // sin² at which δ = 45°: tan²(22.5°)·s⁴ = (1 − s²)(s² − 1/n²), the larger root.
        let t2 = (std::f64::consts::FRAC_PI_8).tan().powi(2);
        let (p, q) = (1.0 + 1.0 / (n * n), 1.0 / (n * n));
        let sin2 = (p + (p * p - 4.0 * (1.0 + t2) * q).sqrt()) / (2.0 * (1.0 + t2));
        let minutes = sin2.sqrt().asin().to_degrees() * 60.0;
        assert!((minutes - (54.0 * 60.0 + 37.0)).abs() < 0.5, "{minutes}");
        let m = dielectric_reflection((1.0 - sin2).sqrt(), 1.0 / n);
        let [s0, s1, s2, s3] = stokes(m, stokes(m, [1.0, 0.0, 1.0, 0.0]));
        assert!((s0 - 1.0).abs() < 1e-12 && s1.abs() < 1e-12 && s2.abs() < 1e-9 && (s3 - 1.0).abs() < 1e-9, "{s3}");
        // The mutant: a total reflection without its phase leaves the light linear.
        let [.., mutant] = stokes(MIRROR, [1.0, 0.0, 1.0, 0.0]);
        assert_eq!(mutant, 0.0);
    }

    #[test]
    fn metals_have_the_reflectances_of_fresnel_and_the_phases_of_a_limit() {
        for (cos, n, k) in [(0.3, 0.2, 3.4), (0.8, 1.5, 0.0), (0.05, 2.0, 4.0)] {
            let f = fresnel::conductor(cos, n, k);
            let m = conductor_reflection(cos, n, k);
            let a = (f.reflectance_s - f.reflectance_p) / (f.reflectance_s + f.reflectance_p);
            assert!((m[0][1] - a).abs() < 1e-12, "{m:?} {a}");
        }
        // A perfect conductor is the ideal mirror; one without absorption is glass.
        let mirror = elements(conductor_reflection(0.4, 1e-9, 1e6));
        assert!((mirror[1] + 1.0).abs() < 1e-5 && mirror[2].abs() < 1e-5, "{mirror:?}");
        let (glass, same) = (dielectric_reflection(0.4, 1.5), conductor_reflection(0.4, 1.5, 0.0));
        (0..4).for_each(|i| (0..4).for_each(|j| assert!((glass[i][j] - same[i][j]).abs() < 1e-13)));
    }

    /// A pane is what its two faces are, order by order: the matrices of the faces multiplied and added.
    #[test]
    fn a_pane_is_the_sum_of_its_orders() {
        for (cos, eta) in [(0.9, 1.5), (0.3, 1.5), (0.05, 2.4), (0.8, 0.75)] {
            let f = fresnel::dielectric(cos, eta).unwrap();
            let scaled = |m: Matrix, by: f64| m.map(|row| row.map(|v| v * by));
            let times = |a: Matrix, b: Matrix| -> Matrix {
                std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
            };
            let reflect = scaled(dielectric_reflection(cos, eta), f.reflectance);
            let inside = scaled(dielectric_reflection(f.cos_t, 1.0 / eta), f.reflectance);
            let pass = scaled(dielectric_transmission(cos, eta, f.cos_t), f.transmittance);
            let (mut reflected, mut passed) = (reflect, [[0.0; 4]; 4]);
            let mut within = pass;
            for _ in 0..400 {
                let out = times(pass, within);
                (0..4).for_each(|i| (0..4).for_each(|j| passed[i][j] += out[i][j]));
                within = times(inside, within);
                let back = times(pass, within);
                (0..4).for_each(|i| (0..4).for_each(|j| reflected[i][j] += back[i][j]));
                within = times(inside, within);
            }
            let pane = pane(cos, eta);
            for (sum, m) in [
                (reflected, scaled(pane.reflection, pane.reflectance)),
                (passed, scaled(pane.transmission, pane.transmittance)),
            ] {
                (0..4).for_each(|i| {
                    (0..4).for_each(|j| {
                        assert!((sum[i][j] - m[i][j]).abs() < 1e-12, "{cos} {eta} {i} {j}: {sum:?} {m:?}")
                    })
                });
            }
            assert!((pane.reflectance + pane.transmittance - 1.0).abs() < 16.0 * f64::UNIT_ROUNDOFF);
        }
    }
}
