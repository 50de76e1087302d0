//! Newton's method: the direction in which a chain points at a lamp.

use super::chain::{Chain, Link};
use crate::film::Counters;
use crate::integrator::vertex::Vertex;
use crate::integrator::wavelength_lanes::WavelengthModel;
use crate::light::Source;
use crate::polarisation::Polarisation;
use etalon_geometry::SurfaceId;
use etalon_optics::{Frame, Vec3};

/// Times that a derivative is found by differences before the search is given up.
const MOST_DERIVATIVES: u32 = 8;
/// Times that a step is tried which leads away from the lamp: whole, then a quarter as long each time.
const MOST_TRIES: u32 = 3;
/// The longest step, rad.
const LONGEST_STEP: f64 = 1.0;
/// A step of Newton's method so short that the next would be lost in rounding, rad: its square is.
const LAST_STEP: f64 = 1e-7;
/// Half of the difference between the directions by which derivatives are found, rad: what is neglected is its square, and rounding is divided
/// by it. Where a chain meets other surfaces on both sides, the next are tried.
const DIFFERENCES: [f64; 3] = [1e-5, 1e-6, 1e-7];
/// A direction that is nearer to a root than this, rad, has led to it. Two roots are farther apart.
const SAME: f64 = 1e-6;

/// Where a search begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed {
    pub direction: Vec3<f64>,
    pub chooses: Chooses,
}

/// How many vertices a chain is to have.
#[derive(Clone, Copy, Debug)]
pub(super) enum Chooses {
    /// A number in [0, 1) chooses it, by how near to the lamp the chain points.
    By(f64),
    /// This number.
    This(u32),
    /// That after which the chain points most nearly at the lamp.
    Nearest,
}

/// A direction in which a chain points at a lamp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    pub wi: Vec3<f64>,
    /// Vertices of the chain.
    pub vertices: u32,
    /// Through which of the last 64 it goes: a bit of each.
    pub passes: u64,
    /// det ∂r/∂ω.
    pub determinant: f64,
}

impl Root {
    /// Whether it is this root, of this chain.
    pub(super) fn is(&self, other: &Self) -> bool {
        (self.vertices, self.passes) == (other.vertices, other.passes)
            && (self.wi - other.wi).length_squared() < SAME * SAME
    }
}

/// A direction beside a root.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approached {
    wi: Vec3<f64>,
    end: End,
    vertices: u32,
}

impl Approached {
    /// Whether it is beside this root.
    pub(super) fn is_beside(&self, root: &Root) -> bool {
        self.vertices == root.vertices && (self.wi - root.wi).length_squared() < SAME * SAME
    }
}

/// Where a chain ends: its last vertex, and what is known of all.
#[derive(Clone, Copy, Debug)]
struct End {
    last: Link,
    /// The surfaces, as one number.
    surfaces: u64,
    /// Whether the chain has only passed panes: its light comes by a shadow ray.
    is_straight: bool,
    /// See [`Root::passes`].
    passes: u64,
}

impl End {
    /// The miss along the tangents of a frame.
    fn miss_along(&self, source: &Source, toward: &Frame<f64>) -> [f64; 2] {
        let miss = self.last.miss(source);
        [miss.dot(toward.s), miss.dot(toward.t)]
    }
}

/// The step to the root of a linear function with this derivative and this miss; `None` if it has none.
fn newton_step([[ss, st], [ts, tt]]: &Matrix, [r_s, r_t]: [f64; 2]) -> Option<[f64; 2]> {
    let determinant = ss * tt - st * ts;
    let step = [(st * r_t - tt * r_s) / determinant, (ts * r_s - ss * r_t) / determinant];
    step.iter().all(|s| s.is_finite()).then_some(step)
}

/// Changes a derivative as little as possible so that it gives the change of r that a step has made (Broyden 1965, eq. 4.5).
fn improve(derivative: &mut Matrix, step: [f64; 2], change: [f64; 2]) {
    let squared = step[0] * step[0] + step[1] * step[1];
    for (row, change) in derivative.iter_mut().zip(change) {
        let wrong = change - (row[0] * step[0] + row[1] * step[1]);
        (0..2).for_each(|axis| row[axis] += wrong * step[axis] / squared);
    }
}

fn length([a, b]: [f64; 2]) -> f64 {
    (a * a + b * b).sqrt()
}

/// A direction beside another one by two small angles.
fn beside(frame: &Frame<f64>, [a, b]: [f64; 2]) -> Vec3<f64> {
    let moved = frame.n + frame.s * a + frame.t * b;
    moved / moved.length()
}

/// Folds a surface into the number of those before.
fn with(surfaces: u64, surface: SurfaceId) -> u64 {
    crate::sampler::mix(surfaces ^ (u64::from(surface.primitive.0) << 32 | u64::from(surface.instance)))
}

impl<'a, V: Vertex<'a>, M: WavelengthModel<N>, P: Polarisation<N>, const N: usize> Chain<'_, 'a, V, M, P, N> {
    /// The root to which a direction leads.
    pub(super) fn solve(&mut self, seed: &Seed, source: &Source, counters: &mut Counters) -> Option<Root> {
        let Approached { wi, end, vertices } = self.approach(seed, source, counters)?;
        let (at, toward) = (Frame::from_normal(wi), Frame::from_normal(end.last.direction));
        let derivative = self.derivative((&at, &toward), (vertices, source), end.surfaces, counters)?;
        let step = newton_step(&derivative, end.miss_along(source, &toward))?;
        if length(step) >= SAME {
            // The derivative that led here was of a kink. A trial that ended here would not count either.
            return None;
        }
        let [[ss, st], [ts, tt]] = derivative;
        Some(Root { wi: beside(&at, step), vertices, passes: end.passes, determinant: ss * tt - st * ts })
    }

    /// Comes so near to a root that one more step of Newton's method finds it.
    ///
    /// The derivative is found by differences, and improved by each step (Broyden 1965, *A Class of Methods for Solving Nonlinear Simultaneous
    /// Equations*). It is found anew where a step does not halve the miss.
    pub(super) fn approach(&mut self, seed: &Seed, source: &Source, counters: &mut Counters) -> Option<Approached> {
        let vertices = self.vertices(seed, source, counters)?;
        let mut wi = seed.direction;
        let mut end = self.end(wi, vertices, counters).filter(|end| !end.is_straight)?;
        for _ in 0..MOST_DERIVATIVES {
            let (at, toward) = (Frame::from_normal(wi), Frame::from_normal(end.last.direction));
            let mut miss = end.miss_along(source, &toward);
            let mut derivative = self.rough_derivative((&at, &toward), (vertices, source), miss, counters)?;
            let mut angles = [0.0; 2];
            loop {
                let step = newton_step(&derivative, miss)?;
                if length(step) < LAST_STEP {
                    return (!end.is_straight).then_some(Approached { wi, end, vertices });
                }
                let before = length(miss);
                let mut part = (LONGEST_STEP / length(step)).min(1.0);
                let mut tries = 1;
                let taken = loop {
                    let taken = step.map(|s| s * part);
                    let moved = beside(&at, [angles[0] + taken[0], angles[1] + taken[1]]);
                    if let Some(there) = self.end(moved, vertices, counters)
                        && there.last.miss(source).length() < before
                    {
                        (wi, end) = (moved, there);
                        break taken;
                    }
                    if tries == MOST_TRIES {
                        return None;
                    }
                    tries += 1;
                    part *= 0.25;
                };
                let now = end.miss_along(source, &toward);
                // Beyond half a right angle the frame of the last derivative says little.
                if length(now) > 0.5 * before || end.last.direction.dot(toward.n) < 0.7 || tries > 1 {
                    break;
                }
                improve(&mut derivative, taken, [now[0] - miss[0], now[1] - miss[1]]);
                miss = now;
                angles = [angles[0] + taken[0], angles[1] + taken[1]];
            }
        }
        None
    }

    /// ∂r/∂ω by one-sided differences; `miss` is that in the middle.
    fn rough_derivative(
        &mut self,
        (at, toward): (&Frame<f64>, &Frame<f64>),
        (vertices, source): (u32, &Source),
        miss: [f64; 2],
        counters: &mut Counters,
    ) -> Option<Matrix> {
        let h = DIFFERENCES[0];
        let mut columns = [[0.0; 2]; 2];
        for (axis, column) in columns.iter_mut().enumerate() {
            let beside = |h: f64| beside(at, if axis == 0 { [h, 0.0] } else { [0.0, h] });
            let (h, end) = match self.end(beside(h), vertices, counters) {
                Some(end) => (h, end),
                None => (-h, self.end(beside(-h), vertices, counters)?),
            };
            let [s, t] = end.miss_along(source, toward);
            *column = [(s - miss[0]) / h, (t - miss[1]) / h];
        }
        let [[ss, ts], [st, tt]] = columns;
        Some([[ss, st], [ts, tt]])
    }

    /// After how many vertices the chain of a seed is to point at the lamp. Every number has a chance. It is large where the chain nearly points at the
    /// lamp, and small where the chain meets another vertex first.
    fn vertices(&mut self, seed: &Seed, source: &Source, counters: &mut Counters) -> Option<u32> {
        /// Added to the squared miss, so that no chance is infinite; and the factor of a chance where the chain is blocked.
        const NEAR: f64 = 1e-6;
        const BLOCKED: f64 = 0.01;
        if let Chooses::This(vertices) = seed.chooses {
            return Some(vertices);
        }
        let mut chances = Vec::new();
        let mut before: Option<(Vec3<f64>, f64)> = None;
        self.follow(seed.direction, counters, |link| {
            if let (Some((position, distance)), Some(chance)) = (before, chances.last_mut())
                && (link.position - position).length() < distance
            {
                *chance *= BLOCKED;
            }
            before = Some((link.position, source.distance(link.position)));
            chances.push(1.0 / (link.miss(source).length_squared() + NEAR));
            true
        });
        let Chooses::By(u) = seed.chooses else {
            let nearest = (0..chances.len()).max_by(|a, b| chances[*a].total_cmp(&chances[*b]));
            return nearest.map(|nearest| nearest as u32 + 1);
        };
        let mut left = u * chances.iter().sum::<f64>();
        let chosen = chances.iter().position(|chance| {
            left -= chance;
            left < 0.0
        });
        // Rounding may leave some.
        chosen.or(chances.len().checked_sub(1)).map(|last| last as u32 + 1)
    }

    /// Where the chain in a direction is after some vertices.
    fn end(&mut self, wi: Vec3<f64>, vertices: u32, counters: &mut Counters) -> Option<End> {
        let (mut count, mut surfaces, mut is_straight, mut passes, mut end) = (0, 0, true, 0, None);
        self.follow(wi, counters, |link| {
            count += 1;
            surfaces = with(surfaces, link.surface);
            is_straight &= link.passes_pane;
            passes = passes << 1 | u64::from(link.passes);
            if count == vertices {
                end = Some(End { last: *link, surfaces, is_straight, passes });
            }
            count < vertices
        });
        end
    }

    /// ∂r/∂ω by central differences. Where the chain meets other surfaces on the sides than it does in the middle, two differences must agree, as they
    /// do where these surfaces are one.
    fn derivative(
        &mut self,
        frames: (&Frame<f64>, &Frame<f64>),
        of: (u32, &Source),
        surfaces: u64,
        counters: &mut Counters,
    ) -> Option<Matrix> {
        let mut before: Option<Matrix> = None;
        for h in DIFFERENCES {
            let Some((derivative, same)) = self.difference(h, frames, of, surfaces, counters) else { continue };
            if same || before.is_some_and(|before| agree(&before, &derivative)) {
                return Some(derivative);
            }
            before = Some(derivative);
        }
        None
    }

    /// The changes along `toward.s` and `toward.t` with each of the two angles about `at`, over these, and whether the chain meets `surfaces` on all sides.
    fn difference(
        &mut self,
        h: f64,
        (at, toward): (&Frame<f64>, &Frame<f64>),
        (vertices, source): (u32, &Source),
        surfaces: u64,
        counters: &mut Counters,
    ) -> Option<(Matrix, bool)> {
        let (mut columns, mut same) = ([[0.0; 2]; 2], true);
        for (axis, column) in columns.iter_mut().enumerate() {
            let mut sides = [[0.0; 2]; 2];
            for (side, angle) in sides.iter_mut().zip([h, -h]) {
                let angles = if axis == 0 { [angle, 0.0] } else { [0.0, angle] };
                let end = self.end(beside(at, angles), vertices, counters)?;
                same &= end.surfaces == surfaces;
                *side = end.miss_along(source, toward);
            }
            *column = [0, 1].map(|row| (sides[0][row] - sides[1][row]) / (2.0 * h));
        }
        let [[ss, ts], [st, tt]] = columns;
        Some(([[ss, st], [ts, tt]], same))
    }
}

/// By rows.
type Matrix = [[f64; 2]; 2];

/// Whether two derivatives agree within their errors.
fn agree(a: &Matrix, b: &Matrix) -> bool {
    /// More than the error of a difference, and less than a kink changes it.
    const APART: f64 = 1e-4;
    let pairs = || a.iter().flatten().zip(b.iter().flatten());
    let apart = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    apart <= APART * pairs().map(|(a, b)| a.abs().max(b.abs())).fold(0.0, f64::max)
}
