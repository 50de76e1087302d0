//! Polarised light, and what goes wrong in it: hands, frames, planes and phases.

use etalon_oracle::laws::{self, Turn, TurnedBy};

use crate::vector::{Vec3, cross, dot, plus, unit};

type Matrix = [[f64; 4]; 4];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

/// The path as a product of Mueller matrices, each in the frame of its plane of incidence, the frames turned between them.
fn stokes(fault: &str, turns: &[Turn], right: Vec3) -> [f64; 4] {
    let mut m: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let first = turns[0].wo;
    let mut x = unit(plus(right, -dot(right, first), first));
    for turn in turns {
        let s = unit(cross(turn.normal, turn.wi));
        let (cos, sin) = (dot(x, s), dot(cross(turn.wo, x), s));
        let (cos, sin) = match fault {
            "frames that are not turned" => (1.0, 0.0),
            "frames turned by the single angle" => (cos, sin),
            "frames turned the other way" => (cos * cos - sin * sin, -2.0 * cos * sin),
            _ => (cos * cos - sin * sin, 2.0 * cos * sin),
        };
        let turned = [[1.0, 0.0, 0.0, 0.0], [0.0, cos, -sin, 0.0], [0.0, sin, cos, 0.0], [0.0, 0.0, 0.0, 1.0]];
        m = product(&product(&m, &turned), &surface(fault, turn));
        x = s;
    }
    [m[0][0], m[1][0], m[2][0], m[3][0]]
}

fn surface(fault: &str, turn: &Turn) -> Matrix {
    let cos = dot(turn.wi, turn.normal);
    let sin2 = 1.0 - cos * cos;
    // |a_s|², |a_p|², the cosine and sine of the phase between them times the product of their moduli.
    let (mut ss, mut pp, mut c, mut d) = match turn.by {
        TurnedBy::Refraction { n } => {
            let t = (n * n - sin2).sqrt();
            let (s, p) = (1.0 / (cos + t), n / (n * n * cos + t));
            (s * s, p * p, s * p, 0.0)
        }
        TurnedBy::Reflection { n, k: 0.0 } if sin2 <= n * n => {
            let t = (n * n - sin2).sqrt();
            let (s, p) = ((cos - t) / (cos + t), (n * n * cos - t) / (n * n * cos + t));
            (s * s, p * p, s * p, 0.0)
        }
        TurnedBy::Reflection { n, k: 0.0 } => {
            // Born & Wolf, §1.5.4: phases of −2 atan(g/c) and −2 atan(g/(n²c)).
            let g = (sin2 - n * n).sqrt();
            let delta = 2.0 * ((g / (n * n * cos)).atan() - (g / cos).atan());
            (1.0, 1.0, delta.cos(), delta.sin())
        }
        TurnedBy::Reflection { n, k } => {
            // With (a + ib)² = (n + ik)² − sin²: ellipsometry's ρ = r_p/r_s = (s·tan − q)/(s·tan + q), s·tan = sin²/cos.
            let (re, im) = (n * n - k * k - sin2, 2.0 * n * k);
            let size = re.hypot(im);
            let (a, b) = ((0.5 * (size + re)).sqrt(), (0.5 * (size - re)).sqrt());
            let r_s = ((cos - a).powi(2) + b * b) / ((cos + a).powi(2) + b * b);
            let t = sin2 / cos;
            // r_p/r_s = (q − t)/(q + t)·(−1) in the sign convention in which r_p = −r_s along the normal.
            let bottom = (a + t).powi(2) + b * b;
            let (rho_re, rho_im) = (-((a - t) * (a + t) + b * b) / bottom, -(b * (a + t) - b * (a - t)) / bottom);
            let r_p = r_s * (rho_re * rho_re + rho_im * rho_im);
            // a_s a_p* = |a_s|² ρ*.
            (r_s, r_p, r_s * rho_re, -r_s * rho_im)
        }
    };
    match fault {
        "the left hand for the right" => d = -d,
        "s and p the other way round" => (ss, pp) = (pp, ss),
        "total reflection without its phase" if sin2 > 0.0 && ss == 1.0 && pp == 1.0 => (c, d) = (-1.0, 0.0),
        "metals without their phase" if !matches!(turn.by, TurnedBy::Reflection { k: 0.0, .. }) => {
            (c, d) = (c.hypot(d).copysign(c), 0.0);
        }
        "r_p as positive as r_s along the normal" if matches!(turn.by, TurnedBy::Reflection { .. }) => {
            (c, d) = (-c, -d)
        }
        "nothing but S0 and S1" => (c, d) = (0.0, 0.0),
        _ => {}
    }
    let half = 0.5 * (ss + pp);
    let (a, c, d) = (0.5 * (ss - pp) / half, c / half, d / half);
    [[1.0, a, 0.0, 0.0], [a, 1.0, 0.0, 0.0], [0.0, 0.0, c, -d], [0.0, 0.0, d, c]]
}

#[test]
fn right_paths_are_accepted_and_wrong_ones_rejected() {
    laws::stokes_along_paths_is_exact(|turns, right| stokes("", turns, right), 1).assert();
    for fault in [
        "frames that are not turned",
        "frames turned by the single angle",
        "frames turned the other way",
        "the left hand for the right",
        "s and p the other way round",
        "total reflection without its phase",
        "metals without their phase",
        "r_p as positive as r_s along the normal",
        "nothing but S0 and S1",
    ] {
        let verdict = laws::stokes_along_paths_is_exact(|turns, right| stokes(fault, turns, right), 1);
        assert!(!verdict.pass, "the mutant \"{fault}\" survived: {verdict}");
    }
}

/// A smooth interface in both directions, as a surface that scatters between any two of them.
struct Facets(&'static str);

impl laws::Polarises for Facets {
    fn mueller(&self, wo: Vec3, wi: Vec3, _: f64) -> Option<(Matrix, Vec3)> {
        let normal = unit(plus(wo, 1.0, wi));
        let turn = Turn { wo, wi, normal, by: TurnedBy::Reflection { n: 0.3, k: 3.0 } };
        let mut m = surface("", &turn);
        match self.0 {
            "S3 that turns one way forth and the other way back" if wo[0] > wi[0] => {
                (m[2][3], m[3][2]) = (-m[2][3], -m[3][2]);
            }
            "more polarised than it can be" => m[1][1] += 1e-3,
            "polarises light that comes and not light that goes" => m[1][0] = 0.0,
            _ => {}
        }
        Some((m, cross(wo, wi)))
    }
}

#[test]
fn right_matrices_are_accepted_and_wrong_ones_rejected() {
    let verdicts = |fault: &'static str| {
        let facets = Facets(fault);
        [laws::mueller_is_physical(&facets, false, 550.0, 1), laws::mueller_is_reciprocal(&facets, false, 550.0, 1)]
    };
    verdicts("").iter().for_each(etalon_oracle::Verdict::assert);
    for fault in [
        "S3 that turns one way forth and the other way back",
        "more polarised than it can be",
        "polarises light that comes and not light that goes",
    ] {
        assert!(verdicts(fault).iter().any(|verdict| !verdict.pass), "the mutant \"{fault}\" survived");
    }
}
