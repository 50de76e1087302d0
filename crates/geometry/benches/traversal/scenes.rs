//! The scenes: closed ones, so that every bounce has a next.

use etalon_geometry::{Geometry, Instance, Placement, Primitive, Sphere, Triangle};
use etalon_optics::Vec3;
use std::sync::Arc;

/// Numbers from a fixed seed (SplitMix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [−1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// A direction, uniform over the sphere.
    pub(crate) fn direction(&mut self) -> Vec3<f64> {
        loop {
            let v = Vec3::new(self.signed(), self.signed(), self.signed());
            if (1e-3..1.0).contains(&v.length_squared()) {
                return v.normalized();
            }
        }
    }
}

/// Indexed triangles, exactly representable in `f32`, as Embree wants them.
#[derive(Default)]
pub(crate) struct Mesh {
    pub(crate) vertices: Vec<[f32; 3]>,
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Mesh {
    /// The triangles that have an area.
    pub(crate) fn primitives(&self) -> Vec<Primitive> {
        self.faces.iter().filter_map(|face| triangle(&self.vertices, face)).map(Into::into).collect()
    }

    /// Adds a grid of (n × m) quads, two triangles each, at the points `at(i, j)`.
    fn add_grid(&mut self, n: u32, m: u32, at: impl Fn(f64, f64) -> [f64; 3]) {
        let base = self.vertices.len() as u32;
        for i in 0..=n {
            for j in 0..=m {
                let p = at(f64::from(i) / f64::from(n), f64::from(j) / f64::from(m));
                self.vertices.push(p.map(|c| c as f32));
            }
        }
        for i in 0..n {
            for j in 0..m {
                let a = base + i * (m + 1) + j;
                let (b, c, d) = (a + m + 1, a + m + 2, a + 1);
                self.faces.push([a, b, c]);
                self.faces.push([a, c, d]);
            }
        }
    }

    /// Adds the six sides of a box, each an n × n grid.
    fn add_box(&mut self, lower: [f64; 3], upper: [f64; 3], n: u32) {
        for k in 0..3 {
            for side in [lower[k], upper[k]] {
                self.add_grid(n, n, |s, t| {
                    let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                    let mut p = [side; 3];
                    p[a] = lower[a] + (upper[a] - lower[a]) * s;
                    p[b] = lower[b] + (upper[b] - lower[b]) * t;
                    p
                });
            }
        }
    }

    /// A displaced ball in a plain room: about `triangles` small triangles of even size.
    pub(crate) fn displaced(triangles: usize) -> Self {
        let mut mesh = Self::ball(triangles);
        mesh.add_box([-3.0, -3.0, -2.0], [3.0, 3.0, 3.0], 8);
        mesh
    }

    fn add_ball(&mut self, triangles: usize) {
        let n = (triangles as f64 / 4.0).sqrt() as u32;
        self.add_grid(n, 2 * n, |s, t| {
            use std::f64::consts::{PI, TAU};
            let (theta, phi) = (PI * s, TAU * t);
            let d = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            let wave = |f: f64| (f * d[0]).sin() * (f * d[1] + 1.0).sin() * (f * d[2] + 2.0).sin();
            let r = 1.0 + 0.25 * wave(5.0) + 0.06 * wave(23.0) + 0.015 * wave(97.0);
            d.map(|c| c * r)
        });
        // Without those at the poles that have no area, all have the same numbers for primitives.
        let vertices = &self.vertices;
        self.faces.retain(|face| triangle(vertices, face).is_some());
    }

    /// The room that the ball is in.
    pub(crate) fn room() -> Self {
        let mut mesh = Self::default();
        mesh.add_box([-3.0, -3.0, -2.0], [3.0, 3.0, 3.0], 8);
        mesh
    }

    /// A displaced ball alone.
    pub(crate) fn ball(triangles: usize) -> Self {
        let mut mesh = Self::default();
        mesh.add_ball(triangles);
        mesh
    }

    /// A room of gridded planes with gridded boxes in it.
    pub(crate) fn gridded(triangles: usize) -> Self {
        let mut mesh = Self::default();
        // One room and eleven boxes, all of six sides of n × n quads.
        let n = (triangles as f64 / (12.0 * 12.0)).sqrt() as u32;
        mesh.add_box([-3.0, -3.0, -2.0], [3.0, 3.0, 3.0], n);
        let mut random = Random(11);
        for _ in 0..11 {
            let c: [f64; 3] = std::array::from_fn(|_| 2.0 * random.signed());
            let h: [f64; 3] = std::array::from_fn(|_| 0.15 + 0.35 * random.unit());
            let lower = std::array::from_fn(|k| c[k] - h[k] - if k == 2 { 0.3 } else { 0.0 });
            mesh.add_box(lower, std::array::from_fn(|k| c[k] + h[k]), n);
        }
        mesh
    }

    /// The room and the two blocks of the Cornell box (Cornell University Program of Computer Graphics, *Cornell Box Data*), its
    /// lamp a hole in the ceiling, moved and scaled to where the camera looks.
    pub(crate) fn cornell() -> Self {
        let quads: [[[f32; 3]; 4]; 16] = [
            [[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]],
            [[556.0, 548.8, 0.0], [556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0]],
            [[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]],
            [[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]],
            [[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]],
            [[343.0, 548.7, 227.0], [343.0, 548.7, 332.0], [213.0, 548.7, 332.0], [213.0, 548.7, 227.0]],
            [[130.0, 165.0, 65.0], [82.0, 165.0, 225.0], [240.0, 165.0, 272.0], [290.0, 165.0, 114.0]],
            [[290.0, 0.0, 114.0], [290.0, 165.0, 114.0], [240.0, 165.0, 272.0], [240.0, 0.0, 272.0]],
            [[130.0, 0.0, 65.0], [130.0, 165.0, 65.0], [290.0, 165.0, 114.0], [290.0, 0.0, 114.0]],
            [[82.0, 0.0, 225.0], [82.0, 165.0, 225.0], [130.0, 165.0, 65.0], [130.0, 0.0, 65.0]],
            [[240.0, 0.0, 272.0], [240.0, 165.0, 272.0], [82.0, 165.0, 225.0], [82.0, 0.0, 225.0]],
            [[423.0, 330.0, 247.0], [265.0, 330.0, 296.0], [314.0, 330.0, 456.0], [472.0, 330.0, 406.0]],
            [[423.0, 0.0, 247.0], [423.0, 330.0, 247.0], [472.0, 330.0, 406.0], [472.0, 0.0, 406.0]],
            [[472.0, 0.0, 406.0], [472.0, 330.0, 406.0], [314.0, 330.0, 456.0], [314.0, 0.0, 456.0]],
            [[314.0, 0.0, 456.0], [314.0, 330.0, 456.0], [265.0, 330.0, 296.0], [265.0, 0.0, 296.0]],
            [[265.0, 0.0, 296.0], [265.0, 330.0, 296.0], [423.0, 330.0, 247.0], [423.0, 0.0, 247.0]],
        ];
        let mut mesh = Self::default();
        for quad in quads {
            let base = mesh.vertices.len() as u32;
            // The camera looks from +x −y toward the origin: the open side of the box is there.
            mesh.vertices.extend(quad.map(|[x, y, z]| [(280.0 - z) * 0.01, (x - 278.0) * 0.01, (y - 274.0) * 0.01]));
            mesh.faces.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
        }
        mesh
    }

    /// Long needles: tubes of a few hundred to one, in all directions.
    pub(crate) fn slivers(triangles: usize) -> Self {
        let mut mesh = Self::default();
        let mut random = Random(12);
        for _ in 0..triangles / 40 {
            let c = Vec3::new(2.0 * random.signed(), 2.0 * random.signed(), 2.0 * random.signed());
            let axis = random.direction();
            let frame = etalon_optics::Frame::from_normal(axis);
            let (length, radius) = (0.2 + 0.8 * random.unit(), 0.001 + 0.004 * random.unit());
            mesh.add_grid(20, 1, |s, t| {
                let phi = s * std::f64::consts::TAU;
                let p =
                    c + frame.s * (radius * phi.cos()) + frame.t * (radius * phi.sin()) + axis * (length * (t - 0.5));
                p.to_array()
            });
        }
        mesh.add_box([-3.0, -3.0, -3.0], [3.0, 3.0, 3.0], 1);
        mesh
    }
}

/// The triangle that a face is, if it has an area.
fn triangle(vertices: &[[f32; 3]], face: &[u32; 3]) -> Option<Triangle> {
    let [a, b, c] = face.map(|i| Vec3::from_f64(vertices[i as usize].map(f64::from)));
    Triangle::new(a, b, c).ok()
}

/// Balls in a room of six huge balls.
pub(crate) fn balls(count: usize) -> Vec<[f32; 4]> {
    let mut random = Random(13);
    let mut out: Vec<[f32; 4]> = (0..count)
        .map(|_| {
            let c: [f64; 3] = std::array::from_fn(|_| 2.5 * random.signed());
            [c[0] as f32, c[1] as f32, c[2] as f32, (0.01 + 0.06 * random.unit()) as f32]
        })
        .collect();
    for k in 0..3 {
        for side in [-1.0_f32, 1.0] {
            let mut ball = [0.0, 0.0, 0.0, 100.0];
            ball[k] = side * 103.0;
            out.push(ball);
        }
    }
    out
}

/// As primitives.
pub(crate) fn spheres(balls: &[[f32; 4]]) -> Vec<Primitive> {
    balls
        .iter()
        .map(|b| {
            let [x, y, z, r] = b.map(f64::from);
            Sphere::new(Vec3::new(x, y, z), r).expect("a ball").into()
        })
        .collect()
}

/// Places in the room: turned, scaled, and some mirrored. Rows of a linear map and a translation.
pub(crate) fn placements(count: usize) -> Vec<[f32; 12]> {
    let mut random = Random(14);
    (0..count)
        .map(|i| {
            let frame = etalon_optics::Frame::from_normal(random.direction());
            let size = 0.02 + 0.06 * random.unit();
            let mirror = if i % 4 == 0 { -1.0 } else { 1.0 };
            let axes = [frame.s * (size * mirror), frame.t * size, frame.n * size].map(Vec3::to_array);
            let centre = [2.7 * random.signed(), 2.7 * random.signed(), 0.5 + 2.2 * random.signed()];
            std::array::from_fn(|j| if j % 4 == 3 { centre[j / 4] as f32 } else { axes[j % 4][j / 4] as f32 })
        })
        .collect()
}

/// The same as primitives, and the room.
pub(crate) fn instances(placed: &Mesh, placements: &[[f32; 12]], others: &Mesh) -> Vec<Primitive> {
    let geometry = Arc::new(Geometry::build(placed.primitives()).expect("a ball"));
    let mut out = others.primitives();
    out.extend(placements.iter().map(|p| {
        let p = p.map(f64::from);
        let linear = [0, 4, 8].map(|row| [p[row], p[row + 1], p[row + 2]]);
        let placement = Placement::new(linear, [p[3], p[7], p[11]]).expect("a map that can be inverted");
        Primitive::from(Instance::new(Arc::clone(&geometry), placement).expect("a placed ball"))
    }));
    out
}
