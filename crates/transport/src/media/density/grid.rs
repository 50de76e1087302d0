//! Densities of a grid, trilinear between the middles of its cells.
//!
//! A ray crosses the boxes between middles one after the other. Within one the density along the ray is a polynomial of the third degree, so
//! Simpson's rule gives its integral exactly. Blocks of such boxes in which there is nothing are passed in one step.

use super::Way;
use crate::frame::{Affine, SceneFrame};
use etalon_optics::Vec3;
use etalon_scene::{DensityGrid, Transform};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Boxes along each edge of a block.
const BLOCK: i64 = 8;

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    cells: [i64; 3],
    values: Arc<[f32]>,
    /// From the frame to coordinates in which the middle of cell (i, j, k) is (i, j, k).
    to_cells: DAffine3,
    /// Blocks along each edge, and whether anything is in each.
    blocks: [i64; 3],
    filled: Vec<bool>,
}

/// A way in the coordinates of cells, from its beginning at 0 to its end, both in units of the frame.
#[derive(Clone, Copy)]
struct Line {
    origin: [f64; 3],
    direction: [f64; 3],
}

/// A stretch of a line within one box between middles, with the densities at its corners.
struct Piece {
    from: f64,
    to: f64,
    corners: [f64; 8],
    /// The least corner.
    least: [f64; 3],
}

impl Line {
    fn at(&self, t: f64) -> [f64; 3] {
        [0, 1, 2].map(|k| self.origin[k] + t * self.direction[k])
    }

    /// The part of [from, to] within a box; empty if it ends before it begins.
    fn within(&self, least: [f64; 3], greatest: [f64; 3], [mut from, mut to]: [f64; 2]) -> [f64; 2] {
        for k in 0..3 {
            if self.direction[k] == 0.0 {
                if self.origin[k] < least[k] || self.origin[k] > greatest[k] {
                    return [1.0, 0.0];
                }
                continue;
            }
            let (a, b) =
                ((least[k] - self.origin[k]) / self.direction[k], (greatest[k] - self.origin[k]) / self.direction[k]);
            (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
        }
        [from, to]
    }

    /// Goes through the cubes of `size` boxes along each edge that a part of it crosses, from the least of `range` to the greatest, until
    /// `each` says that it is enough: then false. Which cube is next is counted, not computed, so that rounding can neither skip one nor stay
    /// in one (Amanatides & Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, Eurographics 1987).
    fn walk(
        &self,
        [from, to]: [f64; 2],
        size: i64,
        [least, greatest]: [[i64; 3]; 2],
        mut each: impl FnMut([i64; 3], [f64; 2]) -> bool,
    ) -> bool {
        // Cube i reaches from the middle of cell size·i − 1 to that of cell size·(i + 1) − 1.
        let start = self.at(from);
        let mut at: [i64; 3] =
            std::array::from_fn(|k| (((start[k] + 1.0) / size as f64).floor() as i64).clamp(least[k], greatest[k]));
        let face = |k: usize, at: i64| {
            let ahead = size * if self.direction[k] > 0.0 { at + 1 } else { at };
            if self.direction[k] == 0.0 {
                return f64::INFINITY;
            }
            (ahead as f64 - 1.0 - self.origin[k]) / self.direction[k]
        };
        let mut next: [f64; 3] = std::array::from_fn(|k| face(k, at[k]));
        let mut t = from;
        while t < to {
            let axis = match () {
                () if next[0] <= next[1] && next[0] <= next[2] => 0,
                () if next[1] <= next[2] => 1,
                () => 2,
            };
            let end = next[axis].min(to);
            if end > t {
                if !each(at, [t, end]) {
                    return false;
                }
                t = end;
            }
            at[axis] += if self.direction[axis] > 0.0 { 1 } else { -1 };
            if at[axis] < least[axis] || at[axis] > greatest[axis] {
                break;
            }
            next[axis] = face(axis, at[axis]);
        }
        true
    }
}

impl Piece {
    fn density(&self, line: &Line, t: f64) -> f64 {
        let [x, y, z] = line.at(t);
        let share = |v: f64, k: usize| (v - self.least[k]).clamp(0.0, 1.0);
        let (x, y, z) = (share(x, 0), share(y, 1), share(z, 2));
        let c = &self.corners;
        let along = |a: f64, b: f64| a + (b - a) * x;
        let (near, far) = (
            along(c[0], c[1]) + (along(c[2], c[3]) - along(c[0], c[1])) * y,
            along(c[4], c[5]) + (along(c[6], c[7]) - along(c[4], c[5])) * y,
        );
        near + (far - near) * z
    }

    /// The column from its beginning to `t`.
    fn column(&self, line: &Line, t: f64) -> f64 {
        let middle = 0.5 * (self.from + t);
        let sum = self.density(line, self.from) + 4.0 * self.density(line, middle) + self.density(line, t);
        (t - self.from) / 6.0 * sum
    }

    /// Where the column reaches a value that is less than that of the whole: Newton's method, kept between bounds that close in.
    fn reach(&self, line: &Line, column: f64) -> f64 {
        let (mut low, mut high) = (self.from, self.to);
        let mut t = 0.5 * (low + high);
        for _ in 0..64 {
            let excess = self.column(line, t) - column;
            if excess > 0.0 {
                high = t
            } else {
                low = t
            }
            let density = self.density(line, t);
            let next = t - excess / density;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - t).abs() <= 1e-15 * t.abs() {
                return next;
            }
            t = next;
        }
        t
    }
}

/// From the frame to coordinates in which the middle of cell (i, j, k) of a box is (i, j, k).
pub(in crate::media) fn to_cells(
    cells: [u32; 3],
    box_m: [[f64; 3]; 2],
    transform: &Transform,
    frame: &SceneFrame,
) -> DAffine3 {
    let [least, greatest] = box_m.map(DVec3::from_array);
    let per_cell = (greatest - least) / DVec3::from_array(cells.map(f64::from));
    // From cells to the box, to the world, to the frame.
    let to_box = DAffine3::from_scale_rotation_translation(per_cell, glam::DQuat::IDENTITY, least + 0.5 * per_cell);
    let placed = Affine::new(transform);
    let to_world = |p: DVec3| placed.point(to_box.transform_point3(p).to_array());
    let origin = frame.point(to_world(DVec3::ZERO));
    let axis = |k: usize| {
        let step = placed.vector(to_box.transform_vector3(DVec3::AXES[k]).to_array()) * frame.per_m();
        DVec3::from_array(step.to_array())
    };
    DAffine3::from_cols(axis(0), axis(1), axis(2), DVec3::from_array(origin.to_array())).inverse()
}

impl Grid {
    pub(super) fn new(grid: &DensityGrid, frame: &SceneFrame) -> Self {
        let cells = grid.cells.map(i64::from);
        let to_cells = to_cells(grid.cells, grid.box_m, &grid.transform, frame);
        let blocks = cells.map(|count| (count + 1 + BLOCK - 1) / BLOCK);
        let mut made = Self { cells, values: grid.values.clone(), to_cells, blocks, filled: Vec::new() };
        made.filled = made.find_filled();
        made
    }

    /// Box (i, j, k) lies between the middles of the cells i − 1 and i along x, and so on: from 0 to the number of cells.
    fn find_filled(&self) -> Vec<bool> {
        let [bx, by, bz] = self.blocks;
        let mut filled = vec![false; (bx * by * bz) as usize];
        let [nx, ny, nz] = self.cells;
        for (place, value) in self.values.iter().enumerate() {
            if *value == 0.0 {
                continue;
            }
            let place = place as i64;
            let cell = [place % nx, place / nx % ny, place / (nx * ny) % nz];
            // A cell is a corner of two boxes along each axis.
            let ends = cell.map(|c| [c / BLOCK, (c + 1) / BLOCK]);
            for z in ends[2][0]..=ends[2][1] {
                for y in ends[1][0]..=ends[1][1] {
                    for x in ends[0][0]..=ends[0][1] {
                        filled[((z * by + y) * bx + x) as usize] = true;
                    }
                }
            }
        }
        filled
    }

    fn line(&self, way: &Way) -> Line {
        let origin = self.to_cells.transform_point3(DVec3::from_array(way.origin.to_array()));
        let direction = self.to_cells.transform_vector3(DVec3::from_array(way.direction.to_array()));
        Line { origin: origin.to_array(), direction: direction.to_array() }
    }

    pub(super) fn at(&self, place: Vec3<f64>) -> f64 {
        let at = self.to_cells.transform_point3(DVec3::from_array(place.to_array())).to_array();
        if (0..3).any(|k| at[k] < -0.5 || at[k] > self.cells[k] as f64 - 0.5) {
            return 0.0;
        }
        let cube = std::array::from_fn(|k| ((at[k] + 1.0).floor() as i64).clamp(0, self.cells[k]));
        let still = Line { origin: at, direction: [0.0; 3] };
        self.piece(cube, [0.0, 0.0]).density(&still, 0.0)
    }

    pub(super) fn column(&self, way: &Way) -> f64 {
        let line = self.line(way);
        let mut column = 0.0;
        self.cross(&line, way.length, |piece| {
            column += piece.column(&line, piece.to);
            true
        });
        column
    }

    pub(super) fn distance(&self, way: &Way, column: f64) -> f64 {
        let line = self.line(way);
        let (mut left, mut distance) = (column, way.length);
        self.cross(&line, way.length, |piece| {
            let whole = piece.column(&line, piece.to);
            if whole > left {
                distance = piece.reach(&line, left);
                return false;
            }
            left -= whole;
            // Rounding alone may leave something at the end.
            distance = piece.to;
            true
        });
        distance
    }

    /// Goes through the boxes that a line crosses in which there may be something, until `each` says that it is enough.
    fn cross(&self, line: &Line, length: f64, mut each: impl FnMut(&Piece) -> bool) {
        // The box of the file reaches half a cell beyond the outermost middles.
        let greatest = self.cells.map(|count| count as f64 - 0.5);
        let part = line.within([-0.5; 3], greatest, [0.0, length]);
        line.walk(part, BLOCK, [[0; 3], self.blocks.map(|count| count - 1)], |block, part| {
            let index = (block[2] * self.blocks[1] + block[1]) * self.blocks[0] + block[0];
            if !self.filled[index as usize] {
                return true;
            }
            let first = block.map(|b| b * BLOCK);
            let last = std::array::from_fn(|k| (first[k] + BLOCK - 1).min(self.cells[k]));
            line.walk(part, 1, [first, last], |at, part| each(&self.piece(at, part)))
        });
    }

    fn piece(&self, at: [i64; 3], [from, to]: [f64; 2]) -> Piece {
        let [nx, ny, nz] = self.cells;
        let value = |x: i64, y: i64, z: i64| {
            let (x, y, z) = (x.clamp(0, nx - 1), y.clamp(0, ny - 1), z.clamp(0, nz - 1));
            f64::from(self.values[((z * ny + y) * nx + x) as usize])
        };
        let [x, y, z] = at;
        let corners = std::array::from_fn(|c| {
            let c = c as i64;
            value(x - 1 + (c & 1), y - 1 + (c >> 1 & 1), z - 1 + (c >> 2))
        });
        Piece { from, to, corners, least: at.map(|i| i as f64 - 1.0) }
    }
}
