//! Trees over triangles, right and wrong in one way each, under the laws and generators of intersection.

use crate::surface::{Leaky, meet_triangle};
use crate::vector::Vec3;
use etalon_oracle::{
    Verdict,
    generators::{ClosedMesh, Scene, Shape, scenes},
    intersects_suite, laws,
    subjects::{Builds, Hit, Intersects},
};

/// Builds a binary tree of boxes over triangles.
struct Trees {
    fault: &'static str,
}

impl Builds for Trees {
    fn build(&self, shapes: &[Shape]) -> Box<dyn Intersects> {
        let corners: Vec<[Vec3; 3]> = shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Triangle { corners_m } => Some(*corners_m),
                _ => None,
            })
            .collect();
        if self.fault == "Möller and Trumbore in single precision" {
            return Box::new(Leaky(corners.iter().map(|t| t.map(|p| p.map(|x| x as f32))).collect()));
        }
        Box::new(Tree { root: (!corners.is_empty()).then(|| Node::over(corners)), fault: self.fault })
    }

    fn takes(&self, shape: &Shape) -> bool {
        matches!(shape, Shape::Triangle { .. })
    }
}

enum Node {
    Leaf(Vec<[Vec3; 3]>),
    Inner([(Box3, Box<Node>); 2]),
}

#[derive(Clone, Copy)]
struct Box3([Vec3; 2]);

impl Box3 {
    fn around(triangles: &[[Vec3; 3]]) -> Self {
        let all = |f: fn(f64, f64) -> f64| {
            [0, 1, 2].map(|k| triangles.iter().flatten().map(|p| p[k]).reduce(f).unwrap_or(f64::NAN))
        };
        Self([all(f64::min), all(f64::max)])
    }

    fn is_met(&self, fault: &str, origin: Vec3, direction: Vec3, t_max: f64) -> bool {
        let (mut near, mut far) = (0.0_f64, t_max);
        for k in 0..3 {
            let [mut low, mut high] = [self.0[0][k], self.0[1][k]];
            // The triangle's test is off by some roundings of the largest number in it.
            let margin = 32.0 * f64::EPSILON * (low.abs().max(high.abs()) + largest(origin));
            match fault {
                "boxes without a margin" => {}
                "boxes rounded to single precision" => {
                    (low, high) = (f64::from(low as f32), f64::from(high as f32));
                }
                _ => (low, high) = (low - margin, high + margin),
            }
            let inverse = 1.0 / direction[k];
            let (a, b) = ((low - origin[k]) * inverse, (high - origin[k]) * inverse);
            if fault == "a ray parallel to a slab is lost" && direction[k] == 0.0 {
                return false;
            }
            // f64::max and min return the other operand for NaN: a slab in which a ray lies says nothing.
            near = near.max(a.min(b) * (1.0 - 4.0 * f64::EPSILON));
            far = far.min(a.max(b) * (1.0 + 4.0 * f64::EPSILON));
        }
        near <= far
    }
}

fn largest(v: Vec3) -> f64 {
    v.iter().fold(0.0, |a: f64, b| a.max(b.abs()))
}

impl Node {
    fn over(mut triangles: Vec<[Vec3; 3]>) -> Self {
        if triangles.len() <= 2 {
            return Self::Leaf(triangles);
        }
        let Box3([low, high]) = Box3::around(&triangles);
        let axis = (0..3).max_by(|a, b| (high[*a] - low[*a]).total_cmp(&(high[*b] - low[*b]))).unwrap_or(0);
        triangles.sort_by(|a, b| a[0][axis].total_cmp(&b[0][axis]));
        let right = triangles.split_off(triangles.len() / 2);
        Self::Inner([triangles, right].map(|half| (Box3::around(&half), Box::new(Self::over(half)))))
    }
}

struct Tree {
    root: Option<Node>,
    fault: &'static str,
}

impl Intersects for Tree {
    fn intersect(&self, origin: Vec3, direction: Vec3, t_max: f64) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        let mut waiting: Vec<&Node> = self.root.iter().collect();
        while let Some(node) = waiting.pop() {
            let limit = nearest.map_or(t_max, |hit| hit.t);
            match node {
                Node::Leaf(triangles) => {
                    for corners in triangles {
                        let limit = nearest.map_or(t_max, |hit| hit.t);
                        let limit = if self.fault == "what is nearer by less than 1e-4 is dropped" && nearest.is_some()
                        {
                            limit - 1e-4
                        } else {
                            limit
                        };
                        nearest = meet_triangle(self.fault, corners, origin, direction, limit).or(nearest);
                    }
                    if self.fault == "the first leaf that is hit" && nearest.is_some() {
                        return nearest;
                    }
                }
                Node::Inner(children) => {
                    let met = children.iter().filter(|(bounds, _)| bounds.is_met(self.fault, origin, direction, limit));
                    for (_, child) in met {
                        if !(self.fault == "a stack of three" && waiting.len() == 3) {
                            waiting.push(child);
                        }
                    }
                }
            }
        }
        nearest
    }

    fn occluded(&self, origin: Vec3, direction: Vec3, t_max: f64) -> bool {
        let t_max = if self.fault == "a shadow ray without an end" { f64::INFINITY } else { t_max };
        self.intersect(origin, direction, t_max).is_some()
    }
}

intersects_suite!(a_right_tree, Trees { fault: "" }, rays: 3_000, seed: 1);

/// Rays a scene that a wrong tree is tried on.
const RAYS: usize = 5_000;

fn scene(name: &str) -> Scene {
    scenes(f64::EPSILON, 1).into_iter().find(|scene| scene.name.starts_with(name)).unwrap()
}

/// A law with its scene.
type Law<'a> = &'a dyn Fn(&Trees) -> Verdict;

#[test]
fn each_wrong_tree_is_rejected_by_the_generator_that_is_there_for_it() {
    let of_scene = |name: &'static str| {
        move |subject: &Trees| -> Verdict { laws::neighbours_change_no_hit(subject, &scene(name), RAYS, 1) }
    };
    let tight = |subject: &Trees| laws::built_mesh_is_tight(subject, &ClosedMesh::sphere(16, 16), RAYS, 1);
    let needles = |subject: &Trees| laws::needles_are_hit_where_they_are(subject, RAYS, 1);
    let near = |subject: &Trees| laws::near_surfaces_are_hit(subject, RAYS, 1);
    let cases: [(&'static str, Law<'_>); 13] = [
        ("edges excluded", &tight),
        ("back faces culled", &tight),
        ("Möller and Trumbore in single precision", &tight),
        ("Möller and Trumbore in single precision", &needles),
        ("Möller and Trumbore in single precision", &near),
        ("an absolute epsilon", &near),
        ("boxes without a margin", &of_scene("ball of triangles")),
        ("boxes rounded to single precision", &of_scene("soup of all shapes, sizes 1e-6 to 1, 1e3")),
        ("a ray parallel to a slab is lost", &of_scene("rectangles in shared planes")),
        ("the first leaf that is hit", &of_scene("ball of triangles")),
        ("a stack of three", &of_scene("triangles that converge")),
        ("a shadow ray without an end", &of_scene("small soup")),
        ("what is nearer by less than 1e-4 is dropped", &of_scene("sheets and shells")),
    ];
    for (fault, law) in cases {
        let right = law(&Trees { fault: "" });
        assert!(right.pass, "{right}");
        let verdict = law(&Trees { fault });
        assert!(!verdict.pass, "the mutant \"{fault}\" survived: {verdict}");
    }
}
