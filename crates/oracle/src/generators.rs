//! Scenes and rays that careless intersection code loses, as plain numbers: for anyone's shapes and tree.

mod mesh;

pub use mesh::{Aim, ClosedMesh};

use crate::{
    Uniform,
    vector::{add, frame, normalize, representable, scale, sub},
};

/// A shape that a subject may be asked to build. Lengths are in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A triangle.
    Triangle {
        /// Its corners.
        corners_m: [[f64; 3]; 3],
    },
    /// A sphere.
    Sphere {
        /// Its middle.
        center_m: [f64; 3],
        /// Its radius.
        radius_m: f64,
    },
    /// A flat disk.
    Disk {
        /// Its middle.
        center_m: [f64; 3],
        /// Unit vector at right angles to it.
        normal: [f64; 3],
        /// Its radius.
        radius_m: f64,
    },
    /// A parallelogram.
    Parallelogram {
        /// One corner.
        corner_m: [f64; 3],
        /// The two edges that leave it.
        edges_m: [[f64; 3]; 2],
    },
    /// A round tube.
    Cylinder {
        /// The ends of its axis.
        ends_m: [[f64; 3]; 2],
        /// Its radius.
        radius_m: f64,
        /// Whether disks close both ends.
        capped: bool,
    },
}

impl Shape {
    /// The same shape scaled about the origin, then moved, with numbers that a subject of this machine epsilon represents.
    #[must_use]
    pub fn placed(&self, factor: f64, by_m: [f64; 3], epsilon: f64) -> Self {
        let point = |p: [f64; 3]| representable(add(scale(factor, p), by_m), epsilon);
        let vector = |v: [f64; 3]| representable(scale(factor, v), epsilon);
        let length = |l: f64| vector([l; 3])[0];
        match self {
            Self::Triangle { corners_m } => Self::Triangle { corners_m: corners_m.map(point) },
            Self::Sphere { center_m, radius_m } => {
                Self::Sphere { center_m: point(*center_m), radius_m: length(*radius_m) }
            }
            Self::Disk { center_m, normal, radius_m } => Self::Disk {
                center_m: point(*center_m),
                normal: representable(*normal, epsilon),
                radius_m: length(*radius_m),
            },
            Self::Parallelogram { corner_m, edges_m } => {
                Self::Parallelogram { corner_m: point(*corner_m), edges_m: edges_m.map(vector) }
            }
            Self::Cylinder { ends_m, radius_m, capped } => {
                Self::Cylinder { ends_m: ends_m.map(point), radius_m: length(*radius_m), capped: *capped }
            }
        }
    }

    /// Points at which careless code goes wrong: corners, middles of edges, centres, poles, rims.
    #[must_use]
    pub fn features(&self) -> Vec<[f64; 3]> {
        let middle = |a, b| scale(0.5, add(a, b));
        match *self {
            Self::Triangle { corners_m: [a, b, c] } => vec![a, b, c, middle(a, b), middle(b, c), middle(a, c)],
            Self::Sphere { center_m, radius_m } => {
                vec![center_m, add(center_m, [radius_m, 0.0, 0.0]), sub(center_m, [0.0, radius_m, 0.0])]
            }
            Self::Disk { center_m, normal, radius_m } => {
                vec![center_m, add(center_m, scale(radius_m, frame(normal).0))]
            }
            Self::Parallelogram { corner_m, edges_m: [a, b] } => {
                vec![corner_m, add(corner_m, a), add(corner_m, b), add(corner_m, add(a, b))]
            }
            Self::Cylinder { ends_m: [a, b], radius_m, .. } => {
                let (s, t) = frame(normalize(sub(b, a)));
                let rim = |end| add(end, scale(radius_m, s));
                vec![a, b, rim(a), rim(b), add(middle(a, b), scale(radius_m, t))]
            }
        }
    }
}

/// A ray's line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Origin, m.
    pub origin_m: [f64; 3],
    /// Direction, of any length.
    pub direction: [f64; 3],
}

/// Shapes within [−1, 1]³, or what a place made of them, and rays at them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What it is, for the evidence.
    pub name: String,
    /// The shapes.
    pub shapes: Vec<Shape>,
    factor: f64,
    by_m: [f64; 3],
    epsilon: f64,
}

impl Scene {
    fn new(name: &str, shapes: Vec<Shape>, epsilon: f64) -> Self {
        Self { name: name.to_owned(), shapes, factor: 1.0, by_m: [0.0; 3], epsilon }.placed(1.0, [0.0; 3])
    }

    /// The same scene scaled, then moved, rays and all.
    #[must_use]
    pub fn placed(&self, factor: f64, by_m: [f64; 3]) -> Self {
        let place = if (factor, by_m) == (1.0, [0.0; 3]) {
            String::new()
        } else {
            format!(", {factor:e} times as large, moved by {by_m:?}")
        };
        Self {
            name: format!("{}{place}", self.name),
            shapes: self.shapes.iter().map(|shape| shape.placed(factor, by_m, self.epsilon)).collect(),
            factor: self.factor * factor,
            by_m: add(scale(factor, self.by_m), by_m),
            epsilon: self.epsilon,
        }
    }

    /// Rays, as many as are asked for, each a [`line()`] at the scene's features.
    pub fn lines(&self, seed: u64) -> impl Iterator<Item = Line> {
        let features: Vec<[f64; 3]> = self.shapes.iter().flat_map(Shape::features).collect();
        let (factor, by_m, epsilon) = (self.factor, self.by_m, self.epsilon);
        let mut numbers = Uniform::new(seed);
        std::iter::repeat_with(move || {
            let Line { origin_m, direction } = line(&mut numbers, &features, factor, by_m);
            Line { origin_m: representable(origin_m, epsilon), direction: representable(direction, epsilon) }
        })
    }
}

/// A ray for shapes in [−1, 1]³ that have been scaled by a factor and then moved: half of them aimed at one of the features
/// given, the rest anywhere; from far, near, within and on the surfaces; a third with one or two components of the direction
/// ±0 or nearly, so that they lie in planes of bounding boxes.
pub fn line(numbers: &mut Uniform, features: &[[f64; 3]], factor: f64, by_m: [f64; 3]) -> Line {
    let anywhere = |numbers: &mut Uniform, reach: f64| add(scale(factor * reach, in_cube(numbers)), by_m);
    let feature = |numbers: &mut Uniform| match features.len() {
        0 => anywhere(numbers, 1.0),
        count => features[below(numbers, count)],
    };
    let aim = if below(numbers, 2) == 0 { feature(numbers) } else { anywhere(numbers, 1.0) };
    let origin_m = match below(numbers, 4) {
        0 => anywhere(numbers, 1.0),
        1 => {
            let reach = numbers.log_between(1.0, 1e6);
            anywhere(numbers, reach)
        }
        2 => {
            let reach = factor * numbers.log_between(1e-12, 1.0);
            add(aim, scale(reach, in_cube(numbers)))
        }
        _ => feature(numbers),
    };
    let mut direction = scale(numbers.log_between(1e-3, 1e3), sub(aim, origin_m));
    if below(numbers, 3) == 0 {
        let tiny = [0.0, -0.0, 1e-30, -1e-30, 1e-17, -1e-12][below(numbers, 6)];
        let axis = below(numbers, 3);
        direction[axis] = tiny;
        if below(numbers, 2) == 0 {
            direction[(axis + 1) % 3] = -tiny;
        }
    }
    Line { origin_m, direction }
}

/// The scenes that trees are tried on, for a subject of this machine epsilon.
#[must_use]
pub fn scenes(epsilon: f64, seed: u64) -> Vec<Scene> {
    let mut numbers = Uniform::new(seed);
    let scene = |name: &str, shapes| Scene::new(name, shapes, epsilon);
    let soup = scene("soup of all shapes, sizes 1e-6 to 1", soup(&mut numbers, 120, 1e-6, 1.0));
    vec![
        soup.placed(1e-6, [0.0; 3]),
        soup.placed(1e3, [2e6, -1e6, 3e6]),
        soup,
        scene("small soup", self::soup(&mut numbers, 120, 1e-3, 0.1)),
        scene("rectangles in shared planes", blocks(&mut numbers, 150)),
        scene("triangles that converge to a corner", converging(60)),
        scene("ball of triangles", ClosedMesh::sphere(9, 12).shapes(0.9)),
        scene("needles of 1000 : 1", ClosedMesh::needles(60, 1e3).shapes(1e-3)),
        scene(
            "one triangle, a hundred times",
            vec![Shape::Triangle { corners_m: [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.1], [0.0, 0.6, 0.0]] }; 100],
        ),
        scene("sheets and shells behind each other", stacks(&mut numbers, 160)),
    ]
}

/// Shapes of all kinds, their sizes log-uniform between two lengths, in [−1, 1]³.
#[must_use]
pub fn soup(numbers: &mut Uniform, count: usize, least_m: f64, most_m: f64) -> Vec<Shape> {
    (0..count)
        .map(|i| {
            let p = in_cube(numbers);
            let size = numbers.log_between(least_m, most_m);
            let near = |numbers: &mut Uniform| scale(size, in_cube(numbers));
            match i % 6 {
                0 => Shape::Sphere { center_m: p, radius_m: size },
                1 => Shape::Disk { center_m: p, normal: numbers.direction(), radius_m: size },
                2 => Shape::Parallelogram { corner_m: p, edges_m: [near(numbers), near(numbers)] },
                3 => {
                    let length = size * numbers.log_between(0.01, 10.0);
                    let end = add(p, scale(length, numbers.direction()));
                    Shape::Cylinder { ends_m: [p, end], radius_m: size, capped: numbers.number() < 0.5 }
                }
                4 => Shape::Triangle { corners_m: [p, add(p, near(numbers)), add(p, near(numbers))] },
                _ => {
                    // A needle.
                    let along = scale(size, numbers.direction());
                    let across = scale(size * numbers.log_between(1e-6, 1.0), in_cube(numbers));
                    let third = add(add(p, scale(numbers.number(), along)), across);
                    Shape::Triangle { corners_m: [p, add(p, along), third] }
                }
            }
        })
        .collect()
}

/// Axis-aligned rectangles and halves of them on a coarse grid: planes that many boxes of a tree share.
#[must_use]
pub fn blocks(numbers: &mut Uniform, count: usize) -> Vec<Shape> {
    (0..count)
        .map(|_| {
            let corner_m = [0; 3].map(|_| (below(numbers, 9) as f64 - 4.0) * 0.25);
            let across = below(numbers, 3);
            let mut edges_m = [[0.0; 3]; 2];
            for (k, edge) in edges_m.iter_mut().enumerate() {
                edge[(across + 1 + k) % 3] = (below(numbers, 4) + 1) as f64 * 0.25;
            }
            if numbers.number() < 0.5 {
                Shape::Parallelogram { corner_m, edges_m }
            } else {
                Shape::Triangle { corners_m: [corner_m, add(corner_m, edges_m[0]), add(corner_m, edges_m[1])] }
            }
        })
        .collect()
}

/// Stacks of twenty surfaces each, 1e-6 to 1e-4 apart and in no order: sheets (triangles, parallelograms and disks), shells (spheres
/// about a point), and balls that touch sheets from behind. A tree that gives up a surface for one that is nearer by a hair, or
/// nearer but for an error that it allows for, is wrong here.
#[must_use]
pub fn stacks(numbers: &mut Uniform, count: usize) -> Vec<Shape> {
    const IN_STACK: usize = 20;
    let mut out = Vec::with_capacity(count + IN_STACK);
    while out.len() < count {
        let (p, size) = (scale(0.7, in_cube(numbers)), numbers.log_between(0.2, 0.8));
        let gap_m = numbers.log_between(1e-6, 1e-4);
        let kind = out.len() / IN_STACK % 3;
        // What balls touch is where they have a pole.
        let up = if kind == 2 { [1.0, 0.0, 0.0] } else { numbers.direction() };
        let (s, t) = frame(up);
        for i in 0..IN_STACK {
            let height_m = gap_m * below(numbers, IN_STACK) as f64;
            let top = add(p, scale(height_m, up));
            let mut edge = || {
                scale(size, normalize(add(scale(numbers.between(-1.0, 1.0), s), scale(numbers.between(-1.0, 1.0), t))))
            };
            let (a, b) = (edge(), edge());
            out.push(match (kind, i % 4) {
                (1, _) => Shape::Sphere { center_m: p, radius_m: size + height_m },
                (2, 0) => Shape::Sphere { center_m: add(top, scale(-size, up)), radius_m: size },
                (_, 1) => Shape::Disk { center_m: top, normal: up, radius_m: size },
                (_, 2) => Shape::Parallelogram { corner_m: add(top, scale(-0.5, add(a, b))), edges_m: [a, b] },
                _ => Shape::Triangle { corners_m: [add(top, a), add(top, b), sub(sub(top, a), b)] },
            });
        }
    }
    out
}

/// Triangles whose sizes and distances from a corner halve at every step: a tree as deep as they are many.
#[must_use]
pub fn converging(count: u32) -> Vec<Shape> {
    (0..count as i32)
        .map(|i| {
            let s = 0.5_f64.powi(i);
            let p = [s - 1.0; 3];
            let (a, b) = ([0.2 * s, 0.0, 0.1 * s], [0.0, 0.2 * s, -0.1 * s]);
            Shape::Triangle { corners_m: [p, add(p, a), add(p, b)] }
        })
        .collect()
}

fn in_cube(numbers: &mut Uniform) -> [f64; 3] {
    numbers.triple().map(|u| 2.0 * u - 1.0)
}

fn below(numbers: &mut Uniform, count: usize) -> usize {
    (numbers.number() * count as f64) as usize
}
