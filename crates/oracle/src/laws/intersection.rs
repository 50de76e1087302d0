//! Laws of ray intersection.

use crate::{
    Uniform, Verdict,
    double_double::DoubleDouble,
    generators::{Aim, ClosedMesh},
    subjects::Intersects,
    vector::{Vec3, add, frame, normalize, representable, scale, sub},
};

/// A sphere seen from far away is neither missed nor imagined, and its distance is right: rays at impact parameters b from 0
/// to 2 radii from `distance` radii away, in random orientation and position.
///
/// `hit` maps (centre, radius, origin, direction) to the nearest t > 0. The exact t comes from double-double arithmetic. Bound
/// on t, relative to the exact one: 8·ε·D²/(r²·√(1 − b²)) + 8 ε with D the distance in radii (an f64 subject at D = 1e4 is held
/// to about 2e-7 of a radius). Impact parameters within the bound of the limb may go either way.
pub fn far_sphere_is_hit(
    mut hit: impl FnMut([f64; 3], f64, [f64; 3], [f64; 3]) -> Option<f64>,
    distance: f64,
    epsilon: f64,
    seed: u64,
) -> Verdict {
    const LAW: &str = "a far sphere is hit where it is and missed where it is not";
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..2000).map(|_| {
        let radius = representable([numbers.log_between(0.1, 10.0); 3], epsilon)[0];
        let away = numbers.direction();
        let center = representable(scale(radius, numbers.direction()), epsilon);
        let origin = representable(add(center, scale(distance * radius, away)), epsilon);
        let (s, _) = frame(away);
        let aimed = add(center, scale(numbers.between(0.0, 2.0) * radius, s));
        let direction = representable(normalize(sub(aimed, origin)), epsilon);
        let exact = exact_sphere(center, radius, origin, direction);
        let got = hit(center, radius, origin, direction);
        let story = format!(
            "centre {center:?}, radius {radius}, origin {origin:?}, direction {direction:?}: t {got:?}, exactly {exact:?}"
        );
        // Errors of the origin-to-centre vector are of the size of an ulp of the distance.
        let limb = 8.0 * epsilon * distance;
        match (got, exact.t) {
            (None, None) => Verdict::bounded(LAW, 0.0, 8.0 * epsilon, story),
            (Some(t), Some(true_t)) => {
                let depth = exact.depth_squared.sqrt();
                let bound = 8.0 * epsilon * (1.0 + distance * distance / depth.max(limb.sqrt()) / distance);
                Verdict::bounded(LAW, (t - true_t).abs() / true_t, bound, story)
            }
            _ if exact.depth_squared.abs() <= limb => Verdict::bounded(LAW, 0.0, 8.0 * epsilon, story),
            _ => Verdict::broken(LAW, story),
        }
    });
    Verdict::worst_of(LAW, verdicts)
}

#[derive(Clone, Copy, Debug)]
struct ExactSphere {
    /// Nearest t > 0.
    t: Option<f64>,
    /// 1 − b²: with b the impact parameter in radii.
    depth_squared: f64,
}

fn exact_sphere(center: Vec3, radius: f64, origin: Vec3, direction: Vec3) -> ExactSphere {
    let wide = |v: Vec3| v.map(DoubleDouble::from);
    let dot = |a: [DoubleDouble; 3], b: [DoubleDouble; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (c, o, d) = (wide(center), wide(origin), wide(direction));
    let oc = [o[0] - c[0], o[1] - c[1], o[2] - c[2]];
    let r = DoubleDouble::from(radius);
    let (a, half_b) = (dot(d, d), dot(oc, d));
    let excess = dot(oc, oc) - r.squared();
    let discriminant = half_b.squared() - a * excess;
    let depth_squared = (discriminant / (a * r.squared())).to_f64();
    if discriminant.is_negative() {
        return ExactSphere { t: None, depth_squared };
    }
    let root = discriminant.sqrt();
    let near = ((-half_b - root) / a).to_f64();
    let far = ((-half_b + root) / a).to_f64();
    let t = [near, far].into_iter().find(|t| *t > 0.0);
    ExactSphere { t, depth_squared }
}

/// A closed mesh lets no ray out: `count` rays from inside, aimed at its vertices, edges and faces, all hit.
pub fn closed_mesh_is_tight(
    mesh: &ClosedMesh,
    subject: &dyn Intersects,
    count: usize,
    epsilon: f64,
    seed: u64,
) -> Verdict {
    const LAW: &str = "a closed mesh lets no ray out";
    let mut escaped = 0_usize;
    let mut first = String::new();
    for aim in mesh.aims(count, epsilon, seed) {
        if subject.intersect(aim.origin_m, aim.direction, f64::INFINITY).is_none() {
            escaped += 1;
            if first.is_empty() {
                first = format!("; the first: {aim:?}");
            }
        }
    }
    let story = format!("{escaped} of {count} rays left the {}{first}", mesh.name);
    Verdict::bounded(LAW, escaped as f64, 0.0, story)
}

/// The zeros of both signs are the same direction, and a ray that lies in a plane of the subject's bounding box is no worse
/// than its neighbours: for every axis and sign of zero the hit of an axis-parallel ray is the same.
///
/// `through` are points that the subject surely covers along all three axes (the centre of a box or ball, for example).
pub fn signed_zeros_are_equal(subject: &dyn Intersects, through: &[[f64; 3]], reach: f64) -> Verdict {
    const LAW: &str = "a direction's −0 and +0 hit the same point";
    let mut verdicts = Vec::new();
    for point in through {
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let mut origin = *point;
                origin[axis] -= sign * reach;
                let hits: Vec<Option<f64>> = (0..4)
                    .map(|zeros| {
                        let mut direction = [if zeros & 1 == 0 { 0.0 } else { -0.0 }; 3];
                        direction[(axis + 1) % 3] = if zeros & 2 == 0 { 0.0 } else { -0.0 };
                        direction[axis] = sign;
                        subject.intersect(origin, direction, f64::INFINITY).map(|hit| hit.t)
                    })
                    .collect();
                let same = hits.iter().all(|t| t.is_some() && *t == hits[0]);
                let story = format!("through {point:?} along axis {axis}, sign {sign}: t {hits:?}");
                verdicts.push(if same { Verdict::bounded(LAW, 0.0, 0.0, story) } else { Verdict::broken(LAW, story) });
            }
        }
    }
    Verdict::worst_of(LAW, verdicts)
}

/// Scaling the world by a power of two scales every t exactly, bit for bit: no absolute epsilon hides anywhere.
///
/// `build` makes the subject at a scale; rays are given at scale 1 and scaled with it (origins only, so t scales too).
pub fn powers_of_two_are_exact(
    mut build: impl FnMut(f64) -> Box<dyn Intersects>,
    aims: &[Aim],
    exponents: &[i32],
) -> Verdict {
    const LAW: &str = "scaling the world by a power of two scales every hit exactly";
    let reference = build(1.0);
    let mut verdicts = Vec::new();
    for exponent in exponents {
        let factor = 2.0_f64.powi(*exponent);
        let scaled = build(factor);
        for aim in aims {
            let plain = reference.intersect(aim.origin_m, aim.direction, f64::INFINITY).map(|hit| hit.t * factor);
            let large = scaled.intersect(scale(factor, aim.origin_m), aim.direction, f64::INFINITY).map(|hit| hit.t);
            let story = format!("2^{exponent}: {large:?} where {plain:?} is exact; {aim:?}");
            verdicts.push(if plain == large {
                Verdict::bounded(LAW, 0.0, 0.0, story)
            } else {
                Verdict::broken(LAW, story)
            });
        }
    }
    Verdict::worst_of(LAW, verdicts)
}
