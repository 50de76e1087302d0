//! Shapes and transforms.

use std::ops::Bound;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use serde_json::json;

use super::mesh;
use crate::files::Files;
use crate::json::{
    Code, Decode, Direction, List, Node, Optional, Positive, Reader, Required, Rule, SchemaBuilder, SchemaValue, Span,
    Spanned, by_json_type,
};
use crate::linear::{self, cofactors, is_similarity, norm, unit};
use crate::mesh::Shading;
use crate::model::{DiskCoordinates, Mesh, Shape, Transform};

crate::record! {
    /// A sphere; its normal points outward.
    pub(crate) struct SphereShape + comment {
        /// Centre, m.
        center_m: Required<[f64; 3]> = "[0, 0, 0]",
        /// Radius, m.
        radius_m: Required<Positive>,
    }
}

crate::record! {
    /// The points origin + a·u + b·v for a and b from 0 to 1; its normal is along u × v.
    pub(crate) struct ParallelogramShape + comment {
        /// One corner, m.
        origin_m: Required<[f64; 3]>,
        /// One edge from it, m.
        u_m: Required<[f64; 3]>,
        /// The other edge from it, m.
        v_m: Required<[f64; 3]>,
    }
}

crate::record! {
    /// A disk.
    pub(crate) struct DiskShape + comment {
        /// Centre, m.
        center_m: Required<[f64; 3]> = "[0, 0, 0]",
        /// Its normal; only the direction counts.
        normal: Required<Direction>,
        /// Radius, m.
        radius_m: Required<Positive>,
        /// What its texture coordinates are.
        coordinates: Required<DiskCoordinates> = r#""square""#,
    }
}

crate::keywords!(DiskCoordinates {
    /// Those of the square around it, (½, ½) in the middle.
    "square" => Self::Square,
    /// u from 0 in the middle to 1 at the rim; v around it from 0 to 1, counter-clockwise seen from its front.
    "polar" => Self::Polar,
});

crate::record! {
    /// Triangles, of a file or listed here; the normal of (a, b, c) is along (b − a) × (c − a): counter-clockwise seen
    /// from its front.
    pub(crate) struct MeshShape + comment {
        /// A PLY or OBJ file (.ply, .obj), relative to this file's folder; its lengths are metres.
        file: Optional<Spanned<String>>,
        /// Only the faces of this group or object of an OBJ file.
        group: Optional<Spanned<String>>,
        /// Vertex positions, m.
        vertices_m: Optional<List<[f64; 3]>>,
        /// Vertices of each triangle, counted from 0.
        triangles: Optional<List<Spanned<[u32; 3]>>>,
        /// A shading normal for each vertex; only the direction counts.
        normals: Optional<Spanned<List<Direction>>>,
        /// Texture coordinates for each vertex.
        uvs: Optional<Spanned<List<[f64; 2]>>>,
        /// A linear Rec. 709 colour for each vertex, shown where a reflectance is of the type "vertex-colours".
        colours: Optional<Spanned<List<[f64; 3]>>>,
        /// Which normals light is scattered by.
        shading: Required<Shading> = r#""auto""#,
    } with [
        Rule::OneOf(&["file", "vertices_m"]),
        Rule::Needs("vertices_m", &["triangles"]),
        Rule::Needs("triangles", &["vertices_m"]),
        Rule::Needs("normals", &["vertices_m"]),
        Rule::Needs("uvs", &["vertices_m"]),
        Rule::Needs("colours", &["vertices_m"]),
        Rule::Needs("group", &["file"]),
    ]
}

crate::keywords!(Shading {
    /// The normals of the vertices where they have some, else the triangles' own.
    "auto" => Self::Auto,
    /// The triangles' own normals.
    "flat" => Self::Flat,
    /// The normals of the vertices, made from the triangles around them if they have none.
    "smooth" => Self::Smooth,
});

crate::record! {
    /// A box along the axes: a mesh of 12 triangles whose normals point outward.
    pub(crate) struct BoxShape + comment {
        /// The corner with the least coordinates, m.
        min_m: Required<[f64; 3]>,
        /// The opposite corner, m; each coordinate above the other corner's.
        max_m: Required<Spanned<[f64; 3]>>,
    }
}

crate::record! {
    /// A circular cylinder; its normal points outward.
    pub(crate) struct CylinderShape + comment {
        /// Middle of one end, m.
        start_m: Required<[f64; 3]>,
        /// Middle of the other end, m.
        end_m: Required<[f64; 3]>,
        /// Radius, m.
        radius_m: Required<Positive>,
        /// Whether disks close its ends.
        capped: Required<bool> = "true",
    }
}

crate::variants! {
    /// A shape in its own coordinates.
    pub(crate) enum ShapeForm by "type" {
        "sphere" => Sphere(SphereShape),
        "parallelogram" => Parallelogram(ParallelogramShape),
        "disk" => Disk(DiskShape),
        "cylinder" => Cylinder(CylinderShape),
        "mesh" => Mesh(MeshShape),
        "box" => Box(BoxShape),
    }
}

/// Below this sine of the angle between two edges, fewer than four digits of the normal survive the rounding of their
/// vector product (2⁻⁵³ each way): a parallelogram this flat is a mistake.
const FLAT: f64 = 1e-12;

/// The shape of a form.
pub(crate) fn shape(form: &ShapeForm, object: &str, files: &mut Files, reader: &mut Reader<'_>) -> Option<Shape> {
    match form {
        ShapeForm::Sphere(sphere) => Some(Shape::Sphere { center: sphere.center_m?, radius_m: sphere.radius_m?.0 }),
        ShapeForm::Parallelogram(p) => {
            let (u, v) = (p.u_m?, p.v_m?);
            let sine = unit(u.into()).zip(unit(v.into())).map_or(0.0, |(u, v)| u.cross(v).length());
            if sine <= FLAT {
                let message = "u_m and v_m span no area";
                let hint = "they must be two edges, not zero and not parallel";
                reader.error_hint(Code::DegenerateShape, p.at.head(), message, hint);
                return None;
            }
            Some(Shape::Parallelogram { origin: p.origin_m?, u, v })
        }
        ShapeForm::Disk(disk) => {
            let (center, normal, radius_m) = (disk.center_m?, disk.normal?.0, disk.radius_m?.0);
            Some(Shape::Disk { center, normal, radius_m, coordinates: disk.coordinates? })
        }
        ShapeForm::Cylinder(c) => {
            let (start, end) = (c.start_m?, c.end_m?);
            if start == end {
                let message = "start_m and end_m are the same point";
                reader.error_hint(
                    Code::DegenerateShape,
                    c.at.head(),
                    message,
                    "a cylinder has a length; a disk has none",
                );
                return None;
            }
            Some(Shape::Cylinder { start, end, radius_m: c.radius_m?.0, capped: c.capped? })
        }
        ShapeForm::Mesh(mesh) => mesh::mesh(mesh, object, files, reader).map(Shape::Mesh),
        ShapeForm::Box(block) => {
            let (min, max) = (block.min_m?, block.max_m?);
            if let Some(axis) = (0..3).find(|&i| max.value[i] <= min[i]) {
                let message = format!("max_m must be above min_m along {}", ["x", "y", "z"][axis]);
                reader.error(Code::DegenerateShape, max.at, message);
                return None;
            }
            Some(Shape::Mesh(Arc::new(box_mesh(min, max.value))))
        }
    }
}

fn box_mesh(min: [f64; 3], max: [f64; 3]) -> Mesh {
    // Corner i takes the larger x, y, z where bit 0, 1, 2 of i is set.
    let corner = |i: usize| std::array::from_fn(|axis| if i >> axis & 1 == 1 { max[axis] } else { min[axis] });
    // Each face counter-clockwise from outside, cut along the diagonal from its first corner.
    const FACES: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        vertices: (0..8).map(corner).collect(),
        triangles: FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    }
}

crate::record! {
    /// A rotation about an axis through the origin, counter-clockwise when the axis points at the viewer.
    pub(crate) struct Rotation + comment {
        /// The axis; only the direction counts.
        axis: Required<Direction>,
        /// The angle, degrees.
        angle_deg: Required<f64>,
    }
}

/// Factors along the axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scaling([f64; 3]);

impl Decode for Scaling {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        let factor = json!({ "type": "number", "not": { "const": 0 } });
        let mut factors = <[f64; 3]>::schema(schema);
        factors["items"] = factor.clone();
        by_json_type(vec![("number", factor), ("array", factors)])
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let factors = match node.elements() {
            Some(_) => <[f64; 3]>::decode(node, reader)?,
            None => [f64::decode(node, reader)?; 3],
        };
        if factors.contains(&0.0) {
            reader.error(Code::SingularTransform, reader.span(node), "a scale of 0 flattens the object");
            return None;
        }
        Some(Self(factors))
    }
}

crate::record! {
    /// One step of a transform: exactly one of the keys.
    pub(crate) struct StepFields + comment {
        /// Moves by a vector, m.
        translate_m: Optional<[f64; 3]>,
        /// Turns about an axis through the origin.
        rotate: Optional<Rotation>,
        /// Scales about the origin: a factor, or one an axis. Negative factors mirror.
        scale: Optional<Scaling>,
        /// Any affine map: the upper three rows of a 4 × 4 matrix that acts on columns; the fourth numbers are metres.
        matrix: Optional<Spanned<[[f64; 4]; 3]>>,
    } with [Rule::OneOf(&["translate_m", "rotate", "scale", "matrix"])]
}

/// One step of a transform.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step(DAffine3);

impl Decode for Step {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        StepFields::schema(schema)
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        let step = StepFields::decode(node, reader)?;
        if let Some(by) = step.translate_m.given() {
            return Some(Self(DAffine3::from_translation((*by).into())));
        }
        if let Some(rotation) = step.rotate.given() {
            return Some(Self(DAffine3::from_mat3(linear::rotation(rotation.axis?.0.into(), rotation.angle_deg?))));
        }
        if let Some(Scaling(factors)) = step.scale.given() {
            return Some(Self(DAffine3::from_scale((*factors).into())));
        }
        let matrix = step.matrix.given()?;
        let map = linear::affine_from_rows(&matrix.value);
        if condition(&map.matrix3) > SINGULAR {
            reader.error(Code::SingularTransform, matrix.at, "the matrix cannot be inverted: it flattens the object");
            return None;
        }
        Some(Self(map))
    }
}

/// Beyond this condition number, the inverse of a matrix in double precision has fewer than four right digits.
const SINGULAR: f64 = 1e12;

/// ‖A‖·‖A⁻¹‖ in the Frobenius norm; infinite for a singular matrix, or one with numbers that are not finite.
fn condition(a: &DMat3) -> f64 {
    let largest = linear::largest(a);
    if largest == 0.0 || !largest.is_finite() {
        return f64::INFINITY;
    }
    let a = *a / largest;
    let condition = norm(&a) * norm(&cofactors(&a)) / a.determinant().abs();
    if condition.is_nan() { f64::INFINITY } else { condition }
}

/// The transform of a list of steps, the first of which is applied first.
pub(crate) fn transform(steps: &List<Box<Step>>, at: Span, reader: &mut Reader<'_>) -> Option<Transform> {
    let steps: Vec<&Step> = steps.0.iter().map(Option::as_deref).collect::<Option<_>>()?;
    let map = steps.iter().fold(DAffine3::IDENTITY, |map, step| step.0 * map);
    if condition(&map.matrix3) > SINGULAR || !map.translation.is_finite() {
        let message = "together, the steps of the transform cannot be inverted";
        reader.error(Code::SingularTransform, at, message);
        return None;
    }
    Some(map.into())
}

/// Reports a transform that would turn a sphere into an ellipsoid, or a disk into an ellipse.
pub(crate) fn check_similarity(shape: &ShapeForm, transform: &Transform, at: Span, reader: &mut Reader<'_>) {
    let what = match shape {
        ShapeForm::Sphere(_) => "sphere",
        ShapeForm::Disk(_) => "disk",
        ShapeForm::Cylinder(_) => "cylinder",
        ShapeForm::Parallelogram(_) | ShapeForm::Mesh(_) | ShapeForm::Box(_) => return,
    };
    if !is_similarity(&transform.affine().matrix3) {
        let message = format!("the transform of a {what} must scale all axes by the same factor");
        let hint = "use one factor for all axes, or a mesh; or put it in a group and place that";
        reader.error_hint(Code::NotSimilarity, at, message, hint);
    }
}

/// Reports an instance that would make an ellipsoid or an ellipse of an emitter.
pub(crate) fn check_instance_similarity(what: &str, transform: &Transform, at: Span, reader: &mut Reader<'_>) {
    if !is_similarity(&transform.affine().matrix3) {
        let message =
            format!("the group has an emitting {what}, so its transform must scale all axes by the same factor");
        reader.error_hint(Code::NotSimilarity, at, message, "use one factor for all axes, or an emitting mesh");
    }
}

/// Reports a shape that its transform would move beyond the numbers of double precision, or shrink to nothing.
pub(crate) fn check_extent(shape: &Shape, transform: &Transform, at: Span, reader: &mut Reader<'_>) {
    let map = transform.affine();
    let linear = |v: [f64; 3]| map.matrix3 * DVec3::from(v);
    let point = |p: [f64; 3]| map.transform_point3(p.into());
    // Squares of lengths are taken all over geometry: what would not survive that is refused as well.
    let kept = |v: DVec3| (f64::MIN_POSITIVE..f64::INFINITY).contains(&v.length_squared());
    let finite = |p: DVec3| p.length_squared().is_finite();
    let held = match shape {
        Shape::Sphere { center, radius_m } | Shape::Disk { center, radius_m, .. } => {
            finite(point(*center)) && kept(linear([*radius_m, 0.0, 0.0]))
        }
        Shape::Cylinder { start, end, radius_m, .. } => {
            let (start, end) = (point(*start), point(*end));
            finite(start) && finite(end) && kept(end - start) && kept(linear([*radius_m, 0.0, 0.0]))
        }
        Shape::Parallelogram { origin, u, v } => finite(point(*origin)) && kept(linear(*u)) && kept(linear(*v)),
        Shape::Mesh(mesh) => mesh.vertices.iter().all(|v| finite(point(*v))),
    };
    if !held {
        let message = "the object is too far away, too large or too small for double precision";
        reader.error(Code::OutOfRange, at, message);
    }
}

/// A finite angle in (0, 180).
pub(crate) const HALF_TURN: (Bound<f64>, Bound<f64>) = (Bound::Excluded(0.0), Bound::Excluded(180.0));
