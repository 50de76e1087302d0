//! Scenes and rays that are hard to intersect: the oracle's, as primitives, and what only our own types can express. Nothing
//! here knows [`Geometry`](crate::Geometry).

use crate::{Cylinder, Disk, Instance, Parallelogram, Placement, Primitive, Sphere, Triangle};
use etalon_optics::Vec3;
use etalon_oracle::Uniform;
use etalon_oracle::generators::{self, Shape};

pub(crate) type V = Vec3<f64>;

/// Random numbers of a fixed seed.
pub(crate) struct Random(Uniform);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Uniform::new(seed))
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.0.bits() >> 11) as f64 * (0.5 / (1_u64 << 52) as f64)
    }

    /// Uniform in [−1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    /// 10 to a power uniform in [a, b).
    pub(crate) fn log_uniform(&mut self, a: f64, b: f64) -> f64 {
        10.0_f64.powf(a + (b - a) * self.unit())
    }

    /// Uniform in the cube [−1, 1)³.
    pub(crate) fn in_cube(&mut self) -> V {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Any bit pattern: mostly numbers of extreme magnitude, sometimes NaN, infinity or zero.
    pub(crate) fn any_number(&mut self) -> f64 {
        match self.below(8) {
            0 => [0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, f64::MAX][self.below(8)],
            1 => f64::from_bits(self.0.bits()),
            2 => f64::from(f32::from_bits((self.0.bits() >> 32) as u32)),
            // Within the range of coordinates.
            3 => self.signed() * 2.0_f64.powi(self.below(240) as i32 - 120),
            _ => self.signed() * 2.0_f64.powi(self.below(8) as i32),
        }
    }

    /// Three of any.
    pub(crate) fn any_vector(&mut self) -> V {
        let scale = if self.below(2) == 0 { 1.0 } else { self.any_number() };
        Vec3::new(self.any_number(), self.any_number(), self.any_number()) * scale
    }

    /// A direction, uniform over the sphere.
    pub(crate) fn direction(&mut self) -> V {
        loop {
            let v = self.in_cube();
            let l = v.length_squared();
            if l > 1e-4 && l <= 1.0 {
                return v.normalized();
            }
        }
    }
}

pub(crate) fn v(x: f64, y: f64, z: f64) -> V {
    Vec3::new(x, y, z)
}

/// An indexed triangle mesh.
#[derive(Clone)]
pub(crate) struct Mesh {
    pub(crate) vertices: Vec<V>,
    pub(crate) faces: Vec<[usize; 3]>,
}

impl Mesh {
    /// The faces that have an area, moved and scaled.
    pub(crate) fn primitives(&self) -> Vec<Primitive> {
        self.faces
            .iter()
            .filter_map(|f| Triangle::new(self.vertices[f[0]], self.vertices[f[1]], self.vertices[f[2]]).ok())
            .map(Primitive::from)
            .collect()
    }

    pub(crate) fn map(&self, f: impl Fn(V) -> V) -> Self {
        Self { vertices: self.vertices.iter().map(|&p| f(p)).collect(), faces: self.faces.clone() }
    }

    /// Cube [−1, 1]³, turned out of the axes.
    pub(crate) fn cube() -> Self {
        let vertices = (0..8).map(|i| {
            let c = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            turned(v(c(0), c(1), c(2)))
        });
        let quad = |a, b, c, d| [[a, b, c], [a, c, d]];
        let faces = [
            quad(0, 2, 3, 1),
            quad(4, 5, 7, 6),
            quad(0, 1, 5, 4),
            quad(2, 6, 7, 3),
            quad(0, 4, 6, 2),
            quad(1, 3, 7, 5),
        ];
        Self { vertices: vertices.collect(), faces: faces.concat() }
    }

    /// Sphere of `stacks` × `slices`, poles included.
    pub(crate) fn sphere(stacks: usize, slices: usize, radius: impl Fn(V) -> f64) -> Self {
        let mut vertices = vec![v(0.0, 0.0, 1.0), v(0.0, 0.0, -1.0)];
        for i in 1..stacks {
            let theta = std::f64::consts::PI * i as f64 / stacks as f64;
            for j in 0..slices {
                let phi = std::f64::consts::TAU * j as f64 / slices as f64;
                vertices.push(v(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()));
            }
        }
        let at = |i: usize, j: usize| match i {
            0 => 0,
            i if i == stacks => 1,
            i => 2 + (i - 1) * slices + j % slices,
        };
        let mut faces = Vec::new();
        for i in 0..stacks {
            for j in 0..slices {
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                if i + 1 < stacks {
                    faces.push([a, b, c]);
                }
                if i > 0 {
                    faces.push([a, c, d]);
                }
            }
        }
        let vertices = vertices.into_iter().map(|p| p * radius(p)).collect();
        Self { vertices, faces }
    }

    /// A closed tube of needles: long, thin triangles.
    pub(crate) fn needles(stacks: usize, slices: usize) -> Self {
        Self::sphere(stacks, slices, |_| 1.0).map(|p| turned(v(p.x, p.y, 3.0 * p.z)))
    }

    /// The edges, each once.
    pub(crate) fn edges(&self) -> Vec<[usize; 2]> {
        let mut edges: Vec<_> = self
            .faces
            .iter()
            .flat_map(|f| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]])
            .filter(|e| e[0] < e[1])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

/// A rotation that leaves no axis in place.
pub(crate) fn turned(p: V) -> V {
    let (s, c) = (0.6, 0.8);
    let p = v(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
    let (s, c) = (5.0 / 13.0, 12.0 / 13.0);
    v(p.x, c * p.y - s * p.z, s * p.y + c * p.z)
}

/// The primitive, if it has an area.
pub(crate) fn primitive(shape: &Shape) -> Option<Primitive> {
    let v = Vec3::from_array;
    match *shape {
        Shape::Triangle { corners_m: [a, b, c] } => Triangle::new(v(a), v(b), v(c)).ok().map(Primitive::from),
        Shape::Sphere { center_m, radius_m } => Sphere::new(v(center_m), radius_m).ok().map(Primitive::from),
        Shape::Disk { center_m, normal, radius_m } => {
            Disk::new(v(center_m), v(normal), radius_m).ok().map(Primitive::from)
        }
        Shape::Parallelogram { corner_m, edges_m: [a, b] } => {
            Parallelogram::new(v(corner_m), v(a), v(b)).ok().map(Primitive::from)
        }
        Shape::Cylinder { ends_m: [a, b], radius_m, capped } => {
            Cylinder::new(v(a), v(b), radius_m, capped).ok().map(Primitive::from)
        }
    }
}

/// `count` primitives of all kinds, their sizes spread over the decades `sizes`, in [−1, 1]³.
pub(crate) fn soup(random: &mut Random, count: usize, sizes: std::ops::Range<f64>) -> Vec<Primitive> {
    let [least, most] = [sizes.start, sizes.end].map(|decade| 10.0_f64.powf(decade));
    enough(count, || generators::soup(&mut random.0, count, least, most))
}

/// The first `count` shapes that have an area.
fn enough(count: usize, mut more: impl FnMut() -> Vec<Shape>) -> Vec<Primitive> {
    let mut out = Vec::with_capacity(count);
    while out.len() < count {
        out.extend(more().iter().filter_map(primitive));
    }
    out.truncate(count);
    out
}

/// A primitive scaled, then moved.
pub(crate) fn placed(primitive: &Primitive, s: f64, by: V) -> Option<Primitive> {
    let point = |p: V| p * s + by;
    match primitive {
        Primitive::Sphere(q) => Sphere::new(point(q.centre()), q.radius() * s).ok().map(Primitive::from),
        Primitive::Disk(q) => Disk::new(point(q.centre()), q.normal(), q.radius() * s).ok().map(Primitive::from),
        Primitive::Parallelogram(q) => {
            Parallelogram::new(point(q.corner()), q.edges()[0] * s, q.edges()[1] * s).ok().map(Primitive::from)
        }
        Primitive::Triangle(q) => {
            let [a, b, c] = q.vertices().map(point);
            Triangle::new(a, b, c).ok().map(Primitive::from)
        }
        Primitive::Cylinder(q) => {
            let [a, b] = q.ends().map(point);
            Cylinder::new(a, b, q.radius() * s, q.is_capped()).ok().map(Primitive::from)
        }
        Primitive::Instance(q) => {
            let rows = q.placement().linear().map(|row| (row * s).to_array());
            let placement = Placement::new(rows, point(q.placement().translation()).to_array()).ok()?;
            Instance::new(q.geometry().clone(), placement).ok().map(Primitive::from)
        }
    }
}

/// The same triangles with vertices that `f32` represents.
pub(crate) fn representable(primitives: &[Primitive]) -> Vec<Primitive> {
    let round = |p: V| p.cast::<f32>().to_f64();
    primitives
        .iter()
        .filter_map(|p| match p {
            Primitive::Triangle(t) => {
                let [a, b, c] = t.vertices().map(round);
                Triangle::new(a, b, c).ok().map(Primitive::from)
            }
            other => Some(other.clone()),
        })
        .collect()
}

/// Triangles whose sizes and distances from a corner halve at every step: a tree as deep as they are many.
pub(crate) fn converging(count: u32) -> Vec<Primitive> {
    generators::converging(count).iter().filter_map(primitive).collect()
}

/// Axis-aligned rectangles and halves of them on a coarse grid: planes shared by many boxes of a tree.
pub(crate) fn blocks(random: &mut Random, count: usize) -> Vec<Primitive> {
    enough(count, || generators::blocks(&mut random.0, count))
}

/// Sheets and shells close behind each other.
pub(crate) fn stacks(random: &mut Random, count: usize) -> Vec<Primitive> {
    enough(count, || generators::stacks(&mut random.0, count))
}

/// A ray's origin and direction.
pub(crate) type Line = (V, V);

/// A ray of one of several adversarial kinds, aimed at what is in [−1, 1]³ or at one of the points `at`.
pub(crate) fn line(random: &mut Random, at: &[V]) -> Line {
    let at: Vec<[f64; 3]> = at.iter().map(|p| p.to_array()).collect();
    let line = generators::line(&mut random.0, &at, 1.0, [0.0; 3]);
    (Vec3::from_array(line.origin_m), Vec3::from_array(line.direction))
}

/// Characteristic points of primitives: corners, centres, poles.
pub(crate) fn features(primitives: &[Primitive]) -> Vec<V> {
    let mut points = Vec::new();
    for p in primitives {
        match p {
            Primitive::Sphere(s) => {
                let r = s.radius();
                points.extend([s.centre(), s.centre() + v(r, 0.0, 0.0), s.centre() - v(0.0, r, 0.0)]);
            }
            Primitive::Parallelogram(s) => points.extend(s.corners()),
            Primitive::Disk(s) => points.push(s.centre()),
            Primitive::Triangle(s) => {
                let [a, b, c] = s.vertices();
                points.extend([a, b, c, (a + b) * 0.5, (b + c) * 0.5, (a + c) * 0.5]);
            }
            Primitive::Cylinder(s) => {
                let frame = etalon_optics::Frame::from_normal(s.axis());
                let rim = s.ends().map(|end| end + frame.s * s.radius());
                points.extend(s.ends().into_iter().chain(rim).chain([s.centre() + frame.t * s.radius()]));
            }
            Primitive::Instance(s) => {
                let inner = features(s.geometry().primitives());
                points.extend(inner.into_iter().map(|p| s.placement().point(p)));
                points.extend([s.bounds().min, s.bounds().max]);
            }
        }
    }
    points
}
