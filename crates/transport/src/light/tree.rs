//! A tree over lights: which of very many a shadow ray aims at, by where it starts.
//!
//! Each node knows the box, the power and the cone of directions of what shines within it, and so bounds what of it can reach a
//! point. A light is chosen by going down, left or right in proportion to these bounds (Conty Estevez and Kulla, *Importance
//! Sampling of Many Lights with Adaptive Tree Splitting*, 2018). The probability of a light is a function of the point and the light
//! alone, so that it is the same for a light that the BSDF's own direction found.

use etalon_geometry::Aabb;
use etalon_optics::Vec3;

/// What is known of where a light is and where it shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightBounds {
    /// Holds every point that shines.
    pub bounds: Aabb,
    /// Axis of a cone that holds the normals of these points, unit.
    pub axis: Vec3<f64>,
    /// Cosine of the cone's half angle.
    pub cos_normals: f64,
    /// Cosine of the largest angle to its own normal at which a point shines.
    pub cos_shines: f64,
    /// Whether the other sides shine too.
    pub both_sides: bool,
    /// Power, above zero.
    pub power: f64,
}

/// cos(max(0, a − b)), of angles from 0 to π, by their sines and cosines.
fn cos_of_difference((sin_a, cos_a): (f64, f64), (sin_b, cos_b): (f64, f64)) -> f64 {
    if cos_a > cos_b { 1.0 } else { cos_a * cos_b + sin_a * sin_b }
}

/// sin(max(0, a − b)).
fn sin_of_difference((sin_a, cos_a): (f64, f64), (sin_b, cos_b): (f64, f64)) -> f64 {
    if cos_a > cos_b { 0.0 } else { sin_a * cos_b - cos_a * sin_b }
}

fn sin_of(cos: f64) -> f64 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

impl LightBounds {
    /// Both together.
    fn union(self, other: Self) -> Self {
        let (axis, cos_normals) = cone_of(&self, &other);
        Self {
            bounds: self.bounds.union(other.bounds),
            axis,
            cos_normals,
            cos_shines: self.cos_shines.min(other.cos_shines),
            both_sides: self.both_sides || other.both_sides,
            power: self.power + other.power,
        }
    }

    /// What a split is to make small: power times the size of the box times the directions that it shines into.
    fn cost(&self) -> f64 {
        let e = self.bounds.extent();
        let area = 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
        // Lights in a row or at one place have boxes without area.
        let size = area + 1e-3 * e.length_squared();
        let (normals, shines) = (self.cos_normals.acos(), self.cos_shines.acos());
        let reach = (normals + shines).min(std::f64::consts::PI);
        // ∫ of the cosine beyond the cone of normals over the directions that are reached (eq. 1 there).
        let directions = std::f64::consts::TAU * (1.0 - normals.cos())
            + std::f64::consts::FRAC_PI_2
                * (2.0 * reach * normals.sin() - (normals - 2.0 * reach).cos() - 2.0 * normals * normals.sin()
                    + normals.cos());
        self.power * size * directions
    }
}

/// Smallest cosine that a light which may be seen counts with: a bound that is nearly zero would leave its few paths with weights
/// beyond measure.
const NARROWEST: f64 = 1e-3;

/// The cone that holds the normals of both.
fn cone_of(a: &LightBounds, b: &LightBounds) -> (Vec3<f64>, f64) {
    let everywhere = (a.axis, -1.0);
    // A light with two sides may be taken by its other one.
    let b_axis = if b.both_sides && a.axis.dot(b.axis) < 0.0 { -b.axis } else { b.axis };
    let (angle_a, angle_b) = (a.cos_normals.clamp(-1.0, 1.0).acos(), b.cos_normals.clamp(-1.0, 1.0).acos());
    let between = a.axis.dot(b_axis).clamp(-1.0, 1.0).acos();
    if between + angle_b <= angle_a {
        return (a.axis, a.cos_normals);
    }
    if between + angle_a <= angle_b {
        return (b_axis, b.cos_normals);
    }
    let half = 0.5 * (angle_a + between + angle_b);
    let across = b_axis - a.axis * a.axis.dot(b_axis);
    let length = across.length();
    if half >= std::f64::consts::PI || length < 1e-12 {
        return everywhere;
    }
    // From a's axis toward b's, until the far edge of b's cone is as far as that of a's.
    let turn = half - angle_a;
    let axis = (a.axis * turn.cos() + across * (turn.sin() / length)).normalized();
    // Rounding may leave a normal outside by so much.
    (axis, (half + 1e-7).min(std::f64::consts::PI).cos())
}

/// What a point needs to know of the bounds of a node.
#[derive(Clone, Copy, Debug)]
struct Seen {
    centre: Vec3<f64>,
    /// Of the sphere around the box.
    radius_squared: f64,
    power: f64,
    axis: Vec3<f64>,
    /// Sine and cosine of the half angle of the cone of normals.
    normals: (f64, f64),
    cos_shines: f64,
    both_sides: bool,
}

impl From<LightBounds> for Seen {
    fn from(of: LightBounds) -> Self {
        Self {
            centre: of.bounds.centre(),
            radius_squared: 0.25 * of.bounds.extent().length_squared(),
            power: of.power,
            axis: of.axis,
            normals: (sin_of(of.cos_normals), of.cos_normals),
            cos_shines: of.cos_shines,
            both_sides: of.both_sides,
        }
    }
}

impl Seen {
    /// A bound, up to a factor that is common to all lights, of the irradiance at `p`: zero only where none of its light arrives.
    #[inline]
    fn importance(&self, p: Vec3<f64>) -> f64 {
        let toward = p - self.centre;
        let distance_squared = toward.length_squared();
        if distance_squared <= self.radius_squared || distance_squared == 0.0 {
            // Some of it may shine straight at the point, from no nearer than its size, for within it the distance of the centre says
            // nothing. At the place of a point light there is no direction to it.
            return if self.radius_squared > 0.0 { self.power / self.radius_squared } else { 0.0 };
        }
        let inverse = 1.0 / distance_squared;
        let cos_axis = self.axis.dot(toward) * inverse.sqrt();
        let cos_axis = if self.both_sides { cos_axis.abs() } else { cos_axis };
        let of_axis = (sin_of(cos_axis), cos_axis);
        let beyond_normals = (sin_of_difference(of_axis, self.normals), cos_of_difference(of_axis, self.normals));
        // The directions in which the point is seen from the box.
        let sin_size_squared = self.radius_squared * inverse;
        let of_size = (sin_size_squared.sqrt(), (1.0 - sin_size_squared).sqrt());
        let cos = cos_of_difference(beyond_normals, of_size);
        if cos <= self.cos_shines { 0.0 } else { self.power * inverse * cos.max(NARROWEST) }
    }
}

/// A node: how it is seen, and what is within it.
#[derive(Clone, Debug)]
struct Node {
    seen: Seen,
    within: Within,
}

#[derive(Clone, Copy, Debug)]
enum Within {
    /// One light, by its place in the list that the tree was built of.
    Light(u32),
    /// The node after this one and the node of this number.
    Nodes(u32),
}

/// A tree over lights.
#[derive(Clone, Debug)]
pub(crate) struct LightTree {
    nodes: Vec<Node>,
    /// For each light the turns from the root, one bit each, the first turn lowest, and their number.
    ways: Vec<(u64, u32)>,
}

/// Bins along an axis in which splits are tried.
const BINS: usize = 12;

impl LightTree {
    /// A tree over lights; `None` of none.
    pub(crate) fn new(lights: &[LightBounds]) -> Option<Self> {
        if lights.is_empty() {
            return None;
        }
        let mut tree = Self { nodes: Vec::with_capacity(2 * lights.len() - 1), ways: vec![(0, 0); lights.len()] };
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        tree.build(lights, &mut order, 0, 0);
        Some(tree)
    }

    fn build(&mut self, lights: &[LightBounds], order: &mut [u32], way: u64, depth: u32) -> LightBounds {
        let number = self.nodes.len();
        if let [light] = *order {
            let bounds = lights[light as usize];
            self.nodes.push(Node { seen: bounds.into(), within: Within::Light(light) });
            self.ways[light as usize] = (way, depth);
            return bounds;
        }
        // Its bounds follow from those of its parts.
        self.nodes.push(Node { seen: lights[order[0] as usize].into(), within: Within::Nodes(0) });
        let middle = split(lights, order, depth);
        let (left, right) = order.split_at_mut(middle);
        let left = self.build(lights, left, way, depth + 1);
        let second = self.nodes.len() as u32;
        let right = self.build(lights, right, way | 1_u64 << depth, depth + 1);
        let bounds = left.union(right);
        self.nodes[number] = Node { seen: bounds.into(), within: Within::Nodes(second) };
        bounds
    }

    /// The probability to go to the first part of a node, seen from `p`; `None` if neither shines there.
    fn first_part(&self, number: usize, second: u32, p: Vec3<f64>) -> Option<f64> {
        let first = self.nodes[number + 1].seen.importance(p);
        let second = self.nodes[second as usize].seen.importance(p);
        let both = first + second;
        (both > 0.0).then(|| first / both)
    }

    /// The light that `u` in [0, 1) chooses for the point `p`, and its probability; `None` where no light shines.
    pub(crate) fn choose(&self, p: Vec3<f64>, mut u: f64) -> Option<(u32, f64)> {
        let (mut number, mut probability) = (0, 1.0);
        loop {
            let second = match self.nodes[number].within {
                Within::Light(light) => return Some((light, probability)),
                Within::Nodes(second) => second,
            };
            let first_part = self.first_part(number, second, p)?;
            if u < first_part {
                probability *= first_part;
                u /= first_part;
                number += 1;
            } else {
                probability *= 1.0 - first_part;
                u = (u - first_part) / (1.0 - first_part);
                number = second as usize;
            }
            // A quotient may round to 1.
            u = u.min(1.0 - f64::EPSILON);
        }
    }

    /// The probability of a light for the point `p`: that of [`LightTree::choose`].
    pub(crate) fn probability(&self, p: Vec3<f64>, light: u32) -> f64 {
        let (mut way, depth) = self.ways[light as usize];
        let (mut number, mut probability) = (0, 1.0);
        for _ in 0..depth {
            let Within::Nodes(second) = self.nodes[number].within else { break };
            let Some(first_part) = self.first_part(number, second, p) else { return 0.0 };
            if way & 1 == 0 {
                probability *= first_part;
                number += 1;
            } else {
                probability *= 1.0 - first_part;
                number = second as usize;
            }
            way >>= 1;
        }
        probability
    }
}

/// Orders lights so that those of the first part come first, and returns how many they are.
fn split(lights: &[LightBounds], order: &mut [u32], depth: u32) -> usize {
    let half = order.len() / 2;
    // Ways are 64 turns long: after half of them lights are halved, which ends in time for any number of them.
    if depth >= u64::BITS - u32::BITS {
        return half;
    }
    let centre = |light: u32| lights[light as usize].bounds.centre();
    let centres = Aabb::of_points(order.iter().map(|&light| centre(light)));
    let mut best: Option<(f64, usize, usize)> = None;
    let bin_of = |axis: usize, light: u32| {
        let (low, extent) = (centres.min.to_array()[axis], centres.extent().to_array()[axis]);
        let at = (centre(light).to_array()[axis] - low) / extent * BINS as f64;
        (at as usize).min(BINS - 1)
    };
    for axis in 0..3 {
        if centres.extent().to_array()[axis] <= 0.0 {
            continue;
        }
        let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
        for &light in order.iter() {
            let bin = &mut bins[bin_of(axis, light)];
            let bounds = lights[light as usize];
            *bin = Some(bin.map_or(bounds, |sum| sum.union(bounds)));
        }
        let join = |a: Option<LightBounds>, b: Option<LightBounds>| match (a, b) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
        let mut above = [None; BINS];
        let mut sum = None;
        for bin in (1..BINS).rev() {
            sum = join(bins[bin], sum);
            above[bin] = sum;
        }
        let mut below = None;
        for bin in 1..BINS {
            below = join(below, bins[bin - 1]);
            let (Some(below), Some(above)) = (below, above[bin]) else { continue };
            let cost = below.cost() + above.cost();
            if cost.is_finite() && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, bin));
            }
        }
    }
    let Some((_, axis, bin)) = best else { return half };
    // The first parts in front, each in their order.
    let (mut first, second): (Vec<u32>, Vec<u32>) = order.iter().partition(|&&light| bin_of(axis, light) < bin);
    let middle = first.len();
    first.extend(second);
    order.copy_from_slice(&first);
    middle
}

#[cfg(test)]
mod tests;
