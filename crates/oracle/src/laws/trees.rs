//! Laws of what is built from many shapes: a tree may save work, never hits.

use super::closed_mesh_is_tight;
use crate::{
    Uniform, Verdict,
    generators::{ClosedMesh, Scene, Shape},
    subjects::{Builds, Intersects},
    vector::{cross, length, representable, representable_scalar, sub},
};

/// What a ray meets in company is the nearest of what it meets of each shape alone, and a shadow ray is stopped by it alone:
/// brute force by the subject's own tests of single shapes is the truth, so equality is to the bit.
///
/// `rays` rays of [`Scene::lines`], a quarter of them with an end. Where something is hit, the ray is cut 4 ε before and
/// beyond it too, to see that an end is kept.
pub fn neighbours_change_no_hit(subject: &dyn Builds, scene: &Scene, rays: usize, seed: u64) -> Verdict {
    const LAW: &str = "what a ray meets in company is the nearest of what it meets alone";
    let shapes: Vec<Shape> = scene.shapes.iter().filter(|shape| subject.takes(shape)).cloned().collect();
    let whole = subject.build(&shapes);
    let alone: Vec<Box<dyn Intersects>> =
        shapes.iter().map(|shape| subject.build(std::slice::from_ref(shape))).collect();
    let epsilon = subject.epsilon();
    let mut numbers = Uniform::new(seed ^ 0x5eed);
    let (mut wrong, mut hits) = (0_usize, 0_usize);
    let mut first = String::new();
    for line in scene.lines(seed).take(rays) {
        let (o, d) = (line.origin_m, line.direction);
        let ends = numbers.number() < 0.25;
        let t_max = if ends { representable_scalar(numbers.between(0.01, 2.0), epsilon) } else { f64::INFINITY };
        let nearest = alone.iter().filter_map(|one| one.intersect(o, d, t_max)).map(|hit| hit.t).reduce(f64::min);
        hits += usize::from(nearest.is_some());
        let got = whole.intersect(o, d, t_max).map(|hit| hit.t);
        let mut right = got == nearest && whole.occluded(o, d, t_max) == nearest.is_some();
        if let Some(t) = nearest {
            right &= whole.intersect(o, d, t * (1.0 - 4.0 * epsilon)).is_none();
            right &= whole.occluded(o, d, t * (1.0 + 4.0 * epsilon));
        }
        if !right {
            wrong += 1;
            if first.is_empty() {
                first = format!(
                    "; the first: {line:?}, end {t_max}: t {got:?} where {nearest:?} is right, or its occlusion"
                );
            }
        }
    }
    let story = format!("{wrong} of {rays} rays, {hits} of which hit, through {}{first}", scene.name);
    if hits == 0 {
        return Verdict::broken(LAW, format!("nothing was hit, so nothing was tried: {story}"));
    }
    Verdict::bounded(LAW, wrong as f64, 0.0, story)
}

/// [`closed_mesh_is_tight`] for what the subject builds of a mesh's triangles.
pub fn built_mesh_is_tight(subject: &dyn Builds, mesh: &ClosedMesh, rays: usize, seed: u64) -> Verdict {
    closed_mesh_is_tight(mesh, subject.build(&mesh.shapes(1.0)).as_ref(), rays, subject.epsilon(), seed)
}

/// Needles from 1 : 1 to 1 : 1e-4/ε in the plane z = 0, seen from all sides, are hit at t = 1 exactly, with the normal ±z.
///
/// The ray is aimed at a point well within the needle, from an origin whose height is what the direction descends by. The
/// bound on t is 256 ε·ratio over the height: what interpolating t from three weights leaves, each of which loses the ratio.
/// That on the normal is 256 ε·ratio, which a cross product of the edges keeps.
pub fn needles_are_hit_where_they_are(subject: &dyn Builds, count: usize, seed: u64) -> Verdict {
    const LAW: &str = "needles are hit where they are";
    let epsilon = subject.epsilon();
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..count).map(|_| {
        let ratio = numbers.log_between(1.0, 1e-4 / epsilon);
        let (b, c) = ([1.0, 0.0, 0.0], representable([numbers.number(), 1.0 / ratio, 0.0], epsilon));
        let (s, t) = (numbers.between(0.1, 0.5), numbers.between(0.1, 0.5));
        let target = [s * b[0] + t * c[0], t * c[1], 0.0];
        let height = numbers.between(0.01, 1.0) * if numbers.number() < 0.5 { -1.0 } else { 1.0 };
        let origin = representable([numbers.between(-1.0, 1.0), numbers.between(-1.0, 1.0), height], epsilon);
        let direction = representable(sub(target, origin), epsilon);
        let built = subject.build(&[Shape::Triangle { corners_m: [[0.0; 3], b, c] }]);
        let story = format!("needle of {ratio:e} : 1, third corner {c:?}, from {origin:?} along {direction:?}");
        let Some(hit) = built.intersect(origin, direction, f64::INFINITY) else {
            // The target's own rounding can leave the needle no sooner than this.
            return Verdict::broken(LAW, format!("missed: {story}"));
        };
        let off_axis = length(cross(hit.normal, [0.0, 0.0, 1.0]));
        let bound = 256.0 * epsilon * ratio;
        // Both in units of their bounds.
        let worst = ((hit.t - 1.0).abs() * origin[2].abs() / bound).max(off_axis / bound);
        Verdict::bounded(LAW, worst, 1.0, format!("{story}: {hit:?}"))
    });
    Verdict::worst_of(LAW, verdicts)
}

/// A surface is met however near it is: rays from 1e-30 to 1e3 m above two triangles that make a square, none aimed closer to
/// its rim than a tenth, have t within 8 ε of the exact one. No smallest t, absolute or of the scene's size, may hide it.
pub fn near_surfaces_are_hit(subject: &dyn Builds, count: usize, seed: u64) -> Verdict {
    const LAW: &str = "a surface is met however near it is";
    let epsilon = subject.epsilon();
    let [a, b, c, d] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let square = subject.build(&[Shape::Triangle { corners_m: [a, b, c] }, Shape::Triangle { corners_m: [a, c, d] }]);
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..count).map(|_| {
        let height = representable_scalar(numbers.log_between(1e-30, 1e3), epsilon);
        let lean = 0.4 / height.max(1.0);
        let mut across = |reach: f64| representable_scalar(numbers.between(-reach, reach), epsilon);
        let origin = [across(0.5), across(0.5), height];
        let direction = [across(lean), across(lean), -1.0];
        let story = format!("from {origin:?} along {direction:?}");
        match square.intersect(origin, direction, f64::INFINITY) {
            Some(hit) => {
                let error = (hit.t - height).abs() / height;
                Verdict::bounded(LAW, error, 8.0 * epsilon, format!("{story}: t {:e}", hit.t))
            }
            None => Verdict::broken(LAW, format!("{story}: missed")),
        }
    });
    Verdict::worst_of(LAW, verdicts)
}
