//! Polarised light: whole paths against the electric field traced along them, and what every Mueller matrix must be.
//!
//! Stokes vectors refer to a unit vector x across the ray and y = k × x, k the direction of the light: S₁ = I_x − I_y,
//! S₂ + iS₃ = 2E_xE_y* for fields that go as exp(i(kz − ωt)), so that S₃ > 0 is right-handed in the sense of Born & Wolf (§1.4.2).

use super::directions::{for_all, unit_vectors};
use crate::{
    Uniform, Verdict,
    vector::{Vec3, add, cross, dot, frame, length, normalize, scale},
};

/// What a surface does to a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TurnedBy {
    /// Reflection at a medium of index n + ik relative to the one that the light is in; k = 0 is a dielectric, and below 1 it
    /// may reflect totally.
    Reflection {
        /// n.
        n: f64,
        /// k.
        k: f64,
    },
    /// Refraction into the medium of `wo`, whose index is this over that of the medium of `wi`.
    Refraction {
        /// n on the side of `wo` over n on the side of `wi`.
        n: f64,
    },
}

/// A vertex of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Unit vector from the surface toward the eye: light leaves along it.
    pub wo: Vec3,
    /// Unit vector from the surface toward the light: light comes along its opposite.
    pub wi: Vec3,
    /// Unit normal, on the side of `wi`.
    pub normal: Vec3,
    /// What the surface does.
    pub by: TurnedBy,
}

/// A complex number.
type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn over(a: Complex, b: Complex) -> Complex {
    let norm = b[0] * b[0] + b[1] * b[1];
    [(a[0] * b[0] + a[1] * b[1]) / norm, (a[1] * b[0] - a[0] * b[1]) / norm]
}

fn norm(a: Complex) -> f64 {
    a[0] * a[0] + a[1] * a[1]
}

/// The root in the upper half plane: of waves that decay in the direction of the light.
fn root(a: Complex) -> Complex {
    let (modulus, half) = (norm(a).sqrt().sqrt(), 0.5 * a[1].atan2(a[0]));
    [modulus * half.cos(), modulus * half.sin()]
}

/// Amplitude ratios (s, p) of a turn, up to a common factor, p along k × s before and after.
fn amplitudes(turn: &Turn) -> [Complex; 2] {
    let cos = dot(turn.wi, turn.normal).min(1.0);
    let sin2 = 1.0 - cos * cos;
    let c = [cos, 0.0];
    match turn.by {
        TurnedBy::Reflection { n, k } => {
            let m2 = [n * n - k * k, 2.0 * n * k];
            let q = root([m2[0] - sin2, m2[1]]);
            let mc = times(m2, c);
            let ratio = |a: Complex| over([a[0] - q[0], a[1] - q[1]], [a[0] + q[0], a[1] + q[1]]);
            [ratio(c), ratio(mc)]
        }
        TurnedBy::Refraction { n } => {
            let refracted = (n * n - sin2).max(0.0).sqrt();
            [[2.0 * cos / (cos + refracted), 0.0], [2.0 * n * cos / (n * n * cos + refracted), 0.0]]
        }
    }
}

/// The Stokes vector that unpolarised light of radiance 1 has at the eye after a path, the first turn being next to the eye, over
/// what it would have if each surface treated s and p as their mean. The frame's x is the part of `right` across the ray.
///
/// The electric field is followed as a complex vector in space, for two polarisations of the source at right angles to each
/// other, which do not interfere: no Mueller matrix, and no frame that would have to be turned.
#[must_use]
pub fn stokes_along(turns: &[Turn], right: Vec3) -> [f64; 4] {
    let source = turns.last().map_or([0.0, 0.0, 1.0], |turn| scale(-1.0, turn.wi));
    let (first, second) = frame(source);
    let mut fields = [first, second].map(|e| e.map(|x| [x * std::f64::consts::FRAC_1_SQRT_2, 0.0]));
    let mut mean = 1.0;
    for turn in turns.iter().rev() {
        let (k_in, k_out) = (scale(-1.0, turn.wi), turn.wo);
        let across = cross(turn.normal, k_in);
        // Along the normal every plane is one of incidence.
        let s = if length(across) > 1e-12 { normalize(across) } else { frame(k_in).0 };
        let (p_in, p_out) = (cross(k_in, s), cross(k_out, s));
        let [a_s, a_p] = amplitudes(turn);
        mean *= 0.5 * (norm(a_s) + norm(a_p));
        for field in &mut fields {
            let along = |axis: Vec3| -> Complex { [0, 1].map(|part| (0..3).map(|i| field[i][part] * axis[i]).sum()) };
            let (e_s, e_p) = (times(a_s, along(s)), times(a_p, along(p_in)));
            *field = std::array::from_fn(|i| [0, 1].map(|part| e_s[part] * s[i] + e_p[part] * p_out[i]));
        }
    }
    let k = turns.first().map_or([0.0, 0.0, 1.0], |turn| turn.wo);
    let x = normalize(add(right, scale(-dot(right, k), k)));
    let y = cross(k, x);
    let mut stokes = [0.0; 4];
    for field in fields {
        let along =
            |axis: Vec3| -> Complex { [0, 1].map(|part| (0..3).map(|i: usize| field[i][part] * axis[i]).sum()) };
        let (e_x, e_y) = (along(x), along(y));
        let product = times(e_x, [e_y[0], -e_y[1]]);
        let part = [norm(e_x) + norm(e_y), norm(e_x) - norm(e_y), 2.0 * product[0], 2.0 * product[1]];
        (0..4).for_each(|i| stokes[i] += part[i] / mean);
    }
    stokes
}

/// A path of up to six turns at random surfaces, and the picture's right.
fn random_path(numbers: &mut Uniform) -> (Vec<Turn>, Vec3) {
    let (mut wo, right) = (numbers.direction(), numbers.direction());
    let count = 1 + (numbers.between(0.0, 6.0) as usize).min(5);
    let mut turns = Vec::with_capacity(count);
    while turns.len() < count {
        // From near grazing to near the normal.
        let cos = numbers.between(0.03, 0.9999);
        let (u, v) = frame(wo);
        let (sin, cos_phi) = numbers.between(0.0, std::f64::consts::TAU).sin_cos();
        let slope = (1.0 - cos * cos).sqrt();
        let facing = add(scale(cos, wo), scale(slope, add(scale(cos_phi, u), scale(sin, v))));
        let mirrored = add(scale(2.0 * cos, facing), scale(-1.0, wo));
        let kind = numbers.between(0.0, 4.0) as u32;
        let turn = match kind {
            0 => Turn {
                wo,
                wi: mirrored,
                normal: facing,
                by: TurnedBy::Reflection { n: numbers.between(1.2, 2.5), k: 0.0 },
            },
            // From within: totally at most angles.
            1 => Turn {
                wo,
                wi: mirrored,
                normal: facing,
                by: TurnedBy::Reflection { n: numbers.between(0.4, 0.8), k: 0.0 },
            },
            2 => {
                let by = TurnedBy::Reflection { n: numbers.between(0.1, 2.0), k: numbers.between(0.5, 7.0) };
                Turn { wo, wi: mirrored, normal: facing, by }
            }
            _ => {
                // n of the eye's side over that of the light's.
                let n = numbers.between(0.45, 2.2);
                let sin2 = n * n * slope * slope;
                if sin2 >= 0.999 {
                    continue;
                }
                let cos_i = (1.0 - sin2).sqrt();
                // wi/n_i-side: n·(wo − cos·N) is the tangential part, mirrored through the surface.
                let tangential = add(wo, scale(-cos, facing));
                let wi = normalize(add(scale(-n, tangential), scale(-cos_i, facing)));
                Turn { wo, wi, normal: scale(-1.0, facing), by: TurnedBy::Refraction { n } }
            }
        };
        turns.push(turn);
        wo = scale(-1.0, turn.wi);
    }
    (turns, right)
}

/// A renderer's Stokes vector of a path is that of the field along it: `subject` is handed the turns, the first next to the eye,
/// and the picture's right, and returns what [`stokes_along`] does. On 2000 random paths of one to six turns at glass, from
/// without and within, at metals, and through interfaces; to 1e-9 of 2ᵏ, the most that k turns can make of S₀: angles are known
/// to some 100 ε after six turns, which near the critical angle counts 1/√ε′ as much.
pub fn stokes_along_paths_is_exact(subject: impl Fn(&[Turn], Vec3) -> [f64; 4], seed: u64) -> Verdict {
    const LAW: &str = "the Stokes vector of a path is that of the field along it";
    const BOUND: f64 = 1e-9;
    let mut numbers = Uniform::new(seed);
    Verdict::worst_of(
        LAW,
        (0..2000).map(|_| {
            let (turns, right) = random_path(&mut numbers);
            let (truth, read) = (stokes_along(&turns, right), subject(&turns, right));
            let most = f64::from(1_u32 << turns.len());
            let error = (0..4)
                .map(|i| (truth[i] - read[i]).abs())
                .fold(0.0, |worst: f64, e| if e <= worst { worst } else { e });
            Verdict::bounded(
                LAW,
                error / most,
                BOUND,
                format!("{read:?} and not {truth:?} along {turns:?}, right {right:?}"),
            )
        }),
    )
}

/// A scattering surface with its polarisation.
pub trait Polarises {
    /// The Mueller matrix over its first element for light that comes along −`wi` and leaves along `wo`, and the x of the frames of
    /// both rays, a vector across both; `None` where nothing is scattered.
    fn mueller(&self, wo: Vec3, wi: Vec3, wavelength_nm: f64) -> Option<([[f64; 4]; 4], Vec3)>;
}

/// The pairs of directions that a surface is tried on: the same side, and if it transmits both.
fn pairs(transmits: bool, seed: u64) -> Vec<(Vec3, Vec3)> {
    let mut numbers = Uniform::new(seed);
    let mut pairs = Vec::new();
    while pairs.len() < 300 {
        let (a, b) = (numbers.direction(), numbers.direction());
        let away = |w: Vec3| w[2].abs() > 0.02;
        if away(a) && away(b) && (transmits || a[2] * b[2] > 0.0) {
            pairs.push((a, b));
        }
    }
    pairs
}

/// A Mueller matrix is physical if its coherency matrix H = ¼ Σ m_ij σ_i ⊗ σ_j* has no negative eigenvalue (Cloude 1986): it is
/// then a sum of matrices of amplitudes, no light leaves it more than fully polarised, and none with less than no power. To
/// 1e-12, a few roundings of the largest element, which is 1.
pub fn mueller_is_physical(surface: &dyn Polarises, transmits: bool, wavelength_nm: f64, seed: u64) -> Verdict {
    const LAW: &str = "the coherency matrix of a Mueller matrix is positive";
    let tried = pairs(transmits, seed).into_iter().filter_map(|(wo, wi)| {
        let (m, _) = surface.mueller(wo, wi, wavelength_nm)?;
        let evidence = format!("wo {wo:?}, wi {wi:?}: {m:?}");
        let finite = m.iter().flatten().all(|v| v.is_finite());
        if !finite || (m[0][0] - 1.0).abs() > 1e-12 {
            return Some(Verdict::broken(LAW, evidence));
        }
        Some(Verdict::bounded(LAW, -least_eigenvalue(&coherency(&m)), 1e-12, evidence))
    });
    Verdict::worst_of(LAW, tried)
}

/// The coherency matrix of a Mueller matrix, as the real symmetric matrix ((Re, −Im), (Im, Re)).
fn coherency(m: &[[f64; 4]; 4]) -> [[f64; 8]; 8] {
    // σ₀ … σ₃ in the order of Stokes parameters, as [row][column] of complex numbers. With S₂ + iS₃ = 2E_xE_y*, ⟨E_xE_y*⟩ =
    // (S₂ + iS₃)/2: σ₃ = ((0, i), (−i, 0)).
    let (zero, one, minus, i, minus_i) = ([0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]);
    let sigma = [
        [[one, zero], [zero, one]],
        [[one, zero], [zero, minus]],
        [[zero, one], [one, zero]],
        [[zero, i], [minus_i, zero]],
    ];
    let mut h = [[0.0; 8]; 8];
    for (row, a) in m.iter().zip(&sigma) {
        for (element, b) in row.iter().zip(&sigma) {
            for (p, q) in (0..4).flat_map(|p| (0..4).map(move |q| (p, q))) {
                let [re, im] = times(a[p / 2][q / 2], [b[p % 2][q % 2][0], -b[p % 2][q % 2][1]]);
                let (re, im) = (0.25 * element * re, 0.25 * element * im);
                h[p][q] += re;
                h[p + 4][q + 4] += re;
                h[p][q + 4] -= im;
                h[p + 4][q] += im;
            }
        }
    }
    h
}

/// By Jacobi's rotations.
fn least_eigenvalue(symmetric: &[[f64; 8]; 8]) -> f64 {
    let mut a = *symmetric;
    for _ in 0..60 {
        for p in 0..8 {
            for q in p + 1..8 {
                if a[p][q].abs() < 1e-300 {
                    continue;
                }
                let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let t = if theta == 0.0 { 1.0 } else { t };
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for k in 0..8 {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                }
            }
        }
    }
    (0..8).map(|i| a[i][i]).fold(f64::INFINITY, f64::min)
}

/// Light that goes back meets the transposed matrix: M(wi, wo) = Q M(wo, wi)ᵀ Q with Q = diag(1, 1, −1, 1), both in frames whose x
/// is the same vector across both rays; reversing a ray reverses y, and so S₂. To 1e-9: the facet that turns one direction into
/// the other is known to a few roundings over the smaller cosine.
pub fn mueller_is_reciprocal(surface: &dyn Polarises, transmits: bool, wavelength_nm: f64, seed: u64) -> Verdict {
    const LAW: &str = "the Mueller matrix of the way back is the transposed one";
    let strategy = (unit_vectors(transmits, f64::EPSILON), unit_vectors(transmits, f64::EPSILON));
    for_all(LAW, strategy, 300, seed, |(wo, wi)| {
        let (forth, back) = (surface.mueller(wo, wi, wavelength_nm), surface.mueller(wi, wo, wavelength_nm));
        let across = cross(wo, wi);
        // Where the rays are parallel no frame is given by them.
        let (Some(forth), Some(back)) = (forth, back) else {
            return Verdict::bounded(LAW, 0.0, 1e-9, "nothing is scattered");
        };
        if length(across) < 1e-6 || wo[2].abs() < 1e-3 || wi[2].abs() < 1e-3 {
            return Verdict::bounded(LAW, 0.0, 1e-9, "no plane");
        }
        let x = normalize(across);
        let m = in_frame(&forth, wo, wi, x);
        let reversed = in_frame(&back, wi, wo, x);
        let sign = [1.0, 1.0, -1.0, 1.0];
        let mut error = 0.0_f64;
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let difference = (reversed[i][j] - sign[i] * sign[j] * m[j][i]).abs();
            if difference > error || difference.is_nan() {
                error = difference;
            }
        }
        Verdict::bounded(LAW, error, 1e-9, format!("wo {wo:?}, wi {wi:?}: {m:?} and {reversed:?}"))
    })
}

/// A matrix in other frames.
fn in_frame((m, own): &([[f64; 4]; 4], Vec3), wo: Vec3, wi: Vec3, x: Vec3) -> [[f64; 4]; 4] {
    // From the frame of `own` to that of `x` for light along k: S₁ and S₂ turn by twice the angle from `x` to `own`.
    let turn = |k: Vec3| -> [[f64; 4]; 4] {
        let own = normalize(add(*own, scale(-dot(*own, k), k)));
        let angle = dot(cross(k, x), own).atan2(dot(x, own));
        let (sin, cos) = (2.0 * angle).sin_cos();
        [[1.0, 0.0, 0.0, 0.0], [0.0, cos, -sin, 0.0], [0.0, sin, cos, 0.0], [0.0, 0.0, 0.0, 1.0]]
    };
    let product = |a: &[[f64; 4]; 4], b: &[[f64; 4]; 4]| -> [[f64; 4]; 4] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let after = turn(wo);
    let before = turn(scale(-1.0, wi));
    let back: [[f64; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| before[j][i]));
    product(&product(&after, m), &back)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms: Brewster's angle leaves s alone; two mirrors crossed there leave nothing, parallel ones double the mean; the
    /// rhomb's two total reflections at 54°37′ in glass of 1.51 make linear light circular.
    #[test]
    fn the_traced_field_has_the_closed_forms() {
        let n = 1.5_f64;
        let brewster = n.atan();
        let turn = |wo: Vec3, normal: Vec3, by: TurnedBy| {
            let wi = add(scale(2.0 * dot(wo, normal), normal), scale(-1.0, wo));
            Turn { wo, wi, normal, by }
        };
        let wo = [brewster.sin(), 0.0, brewster.cos()];
        let glass = TurnedBy::Reflection { n, k: 0.0 };
        let first = turn(wo, [0.0, 0.0, 1.0], glass);
        let [s0, s1, s2, s3] = stokes_along(&[first], [0.0, 1.0, 0.0]);
        assert!((s0 - 1.0).abs() < 1e-14 && (s1 - 1.0).abs() < 1e-14 && s2.abs() < 1e-14 && s3.abs() < 1e-14);
        let next = scale(-1.0, first.wi);
        for (angle, value) in [(0.0_f64, 2.0), (90.0, 0.0), (30.0, 1.5)] {
            // A second plane of incidence, turned about the ray between the two.
            let (u, v) = ([0.0, 1.0, 0.0], cross(next, [0.0, 1.0, 0.0]));
            let (sin, cos) = angle.to_radians().sin_cos();
            let aside = add(scale(cos, v), scale(sin, u));
            let normal = add(scale(brewster.cos(), next), scale(brewster.sin(), aside));
            let [s0, ..] = stokes_along(&[first, turn(next, normal, glass)], [0.0, 1.0, 0.0]);
            assert!((s0 - value).abs() < 1e-12, "{angle}: {s0}");
        }
        // Light that glass has polarised along y meets the rhomb's face at 45°.
        let t2 = (std::f64::consts::FRAC_PI_8).tan().powi(2);
        let (p, q) = (1.0 + 1.0 / (1.51 * 1.51), 1.0 / (1.51 * 1.51));
        let sin2 = (p + (p * p - 4.0 * (1.0 + t2) * q).sqrt()) / (2.0 * (1.0 + t2));
        let total = TurnedBy::Reflection { n: 1.0 / 1.51, k: 0.0 };
        let face = |w: Vec3, plane: Vec3| add(scale((1.0 - sin2).sqrt(), w), scale(sin2.sqrt(), plane));
        let eye = [0.0, 0.0, 1.0];
        let one = turn(eye, face(eye, [std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2, 0.0]), total);
        let between = scale(-1.0, one.wi);
        let two = turn(between, face(between, normalize(cross(cross(eye, one.normal), between))), total);
        let onward = scale(-1.0, two.wi);
        // s of the rhomb is along (1, −1, 0)/√2; the polariser's along x or y is at 45° to it.
        let s = normalize(cross(eye, one.normal));
        let diagonal = normalize(add(s, cross(onward, s)));
        let polariser =
            turn(onward, add(scale(brewster.cos(), onward), scale(brewster.sin(), cross(onward, diagonal))), glass);
        let [s0, s1, s2, s3] = stokes_along(&[one, two, polariser], [1.0, 0.0, 0.0]);
        assert!((s0 - 1.0).abs() < 1e-9 && s1.abs() < 1e-9 && s2.abs() < 1e-9 && (s3.abs() - 1.0).abs() < 1e-9, "{s3}");
    }

    #[test]
    fn matrices_beyond_what_light_can_do_are_no_physical_ones() {
        struct One([[f64; 4]; 4]);
        impl Polarises for One {
            fn mueller(&self, wo: Vec3, wi: Vec3, _: f64) -> Option<([[f64; 4]; 4], Vec3)> {
                Some((self.0, cross(wo, wi)))
            }
        }
        let diagonal = |a: [f64; 4]| -> [[f64; 4]; 4] {
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { a[i] } else { 0.0 }))
        };
        for (elements, physical) in [
            ([1.0, 1.0, 1.0, 1.0], true),
            ([1.0, 1.0, -1.0, -1.0], true),
            ([1.0, 0.0, 0.0, 0.0], true),
            ([1.0, 0.5, 0.5, 0.5], true),
            // It mirrors the sphere of states: no light does, although no state leaves the sphere.
            ([1.0, 1.0, 1.0, -1.0], false),
            ([1.0, 1.1, 0.0, 0.0], false),
        ] {
            assert_eq!(mueller_is_physical(&One(diagonal(elements)), true, 550.0, 1).pass, physical, "{elements:?}");
        }
    }
}
