//! Laws of ray intersection, with the generators of rays that careless code loses.

use crate::{
    Uniform, Verdict,
    double_double::DoubleDouble,
    subjects::Intersects,
    vector::{Vec3, add, cross, dot, frame, length, normalize, representable, scale, sub},
};

/// A ray and what it is aimed at, for the evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Aim {
    /// Origin, m.
    pub origin_m: [f64; 3],
    /// Direction, not necessarily of unit length.
    pub direction: [f64; 3],
    /// What it is aimed at.
    pub target: String,
}

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

/// A closed triangle mesh: vertices in m and vertex indices.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedMesh {
    /// What it is, for the evidence.
    pub name: String,
    /// Positions, m.
    pub vertices: Vec<[f64; 3]>,
    /// Triangles, outward by the right-hand rule.
    pub triangles: Vec<[u32; 3]>,
}

impl ClosedMesh {
    /// A cube of half side 1.
    #[must_use]
    pub fn cube() -> Self {
        let vertices = (0..8).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 })).collect();
        let quads: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Self { name: "cube".into(), vertices, triangles }
    }

    /// A unit sphere of `rows` × `columns` facets.
    #[must_use]
    pub fn sphere(rows: u32, columns: u32) -> Self {
        let mut vertices = vec![[0.0, 0.0, 1.0]];
        for i in 1..rows {
            let theta = std::f64::consts::PI * f64::from(i) / f64::from(rows);
            for j in 0..columns {
                let phi = std::f64::consts::TAU * f64::from(j) / f64::from(columns);
                vertices.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
            }
        }
        vertices.push([0.0, 0.0, -1.0]);
        let last = vertices.len() as u32 - 1;
        let at = |i: u32, j: u32| 1 + (i - 1) * columns + j % columns;
        let mut triangles = Vec::new();
        for j in 0..columns {
            triangles.push([0, at(1, j), at(1, j + 1)]);
            triangles.push([last, at(rows - 1, j + 1), at(rows - 1, j)]);
            for i in 1..rows - 1 {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        Self { name: format!("sphere of {rows} × {columns}"), vertices, triangles }
    }

    /// Two cones of `sides` needles each, `slenderness` times as long as the ring's radius of 1.
    #[must_use]
    pub fn needles(sides: u32, slenderness: f64) -> Self {
        let mut vertices = vec![[0.0, 0.0, slenderness], [0.0, 0.0, -slenderness]];
        for j in 0..sides {
            let phi = std::f64::consts::TAU * f64::from(j) / f64::from(sides);
            vertices.push([phi.cos(), phi.sin(), 0.0]);
        }
        let at = |j: u32| 2 + j % sides;
        let triangles = (0..sides).flat_map(|j| [[0, at(j), at(j + 1)], [1, at(j + 1), at(j)]]).collect();
        Self { name: format!("{sides} needles of {slenderness}"), vertices, triangles }
    }

    /// The same mesh moved, m, with the vertices rounded to what the subject can represent.
    #[must_use]
    pub fn moved(mut self, by_m: [f64; 3], epsilon: f64) -> Self {
        for vertex in &mut self.vertices {
            *vertex = representable(add(*vertex, by_m), epsilon);
        }
        self.name = format!("{} moved by {by_m:?}", self.name);
        self
    }

    /// A point near the middle: the mean of the vertices.
    #[must_use]
    pub fn middle(&self) -> [f64; 3] {
        let sum = self.vertices.iter().copied().fold([0.0; 3], add);
        scale(1.0 / self.vertices.len() as f64, sum)
    }

    /// Six times the enclosed volume, m³: positive when closed and outward.
    #[must_use]
    pub fn volume_times_six(&self) -> f64 {
        let corner = |i: u32| sub(self.vertices[i as usize], self.middle());
        self.triangles.iter().map(|t| dot(corner(t[0]), cross(corner(t[1]), corner(t[2])))).sum()
    }

    /// Rays from near the middle: a third at vertices, a third at edges, a third at points of faces.
    pub fn aims(&self, count: usize, epsilon: f64, seed: u64) -> impl Iterator<Item = Aim> + '_ {
        let mut numbers = Uniform::new(seed);
        let middle = self.middle();
        let inner = self.vertices.iter().map(|v| length(sub(*v, middle))).fold(f64::INFINITY, f64::min);
        (0..count).map(move |i| {
            let triangle = self.triangles[(numbers.bits() % self.triangles.len() as u64) as usize];
            let corner = |k: usize| self.vertices[triangle[k] as usize];
            let (u, v) = (numbers.number(), numbers.number());
            let (point, what) = match i % 3 {
                0 => (corner(0), "a vertex"),
                1 => (add(scale(1.0 - u, corner(0)), scale(u, corner(1))), "an edge"),
                _ => {
                    let root = u.sqrt();
                    let a = scale(1.0 - root, corner(0));
                    let b = scale(root * (1.0 - v), corner(1));
                    (add(add(a, b), scale(root * v, corner(2))), "a face")
                }
            };
            // Well inside the largest ball about the middle that any of these meshes holds.
            let origin =
                representable(add(middle, scale(0.1 * inner * numbers.number(), numbers.direction())), epsilon);
            let direction = representable(sub(point, origin), epsilon);
            Aim { origin_m: origin, direction, target: format!("{what} of triangle {triangle:?} of the {}", self.name) }
        })
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generated_meshes_are_closed_and_outward() {
        for mesh in [ClosedMesh::cube(), ClosedMesh::sphere(16, 16), ClosedMesh::needles(3000, 1e3)] {
            assert!(mesh.volume_times_six() > 0.0, "{}", mesh.name);
            let mut edges = std::collections::HashMap::new();
            for t in &mesh.triangles {
                for k in 0..3 {
                    *edges.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
                }
            }
            assert!(edges.iter().all(|((a, b), n)| *n == 1 && edges.get(&(*b, *a)) == Some(&1)), "{}", mesh.name);
        }
        let cube = ClosedMesh::cube();
        assert!((cube.volume_times_six() - 48.0).abs() < 1e-12);
    }
}
