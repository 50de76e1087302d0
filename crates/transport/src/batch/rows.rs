//! One number, or one vector, for each path of a set.

use etalon_geometry::{LANES, SurfaceId, SurfacePoint};
use etalon_optics::Vec3;

/// Paths in a set.
pub(crate) const W: usize = 16;

/// Groups of paths whose rays are cast at once.
pub(super) const GROUPS: usize = W / LANES;

/// One bit for each path.
pub(super) type Mask = u32;

/// A number for each path.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Row(pub [f64; W]);

/// A vector for each path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows3 {
    x: Row,
    y: Row,
    z: Row,
}

/// The point of one path, from rows of positions, their error bounds and normals. It can spawn rays, and names no surface.
#[inline(always)]
pub(super) fn surface_point((position, error, normal): (&Rows3, &Row, &Rows3), lane: usize) -> SurfacePoint<f64> {
    SurfacePoint {
        position: position.at(lane),
        position_error: error.0[lane],
        normal: normal.at(lane),
        surface: SurfaceId::NONE,
        label: 0,
        time: 0.0,
    }
}

impl Row {
    pub(super) const ZERO: Self = Self([0.0; W]);

    /// The numbers of a group.
    #[inline(always)]
    pub(super) fn group(&self, group: usize) -> [f64; LANES] {
        *self.0[group * LANES..].first_chunk().expect("a group is of as many")
    }

    /// The numbers of some paths.
    #[inline(always)]
    pub(super) fn of(&self, paths: &[usize; LANES]) -> [f64; LANES] {
        let mut numbers = [0.0; LANES];
        for lane in 0..LANES {
            numbers[lane] = self.0[paths[lane] % W];
        }
        numbers
    }

    /// Becomes these numbers in a group.
    #[inline(always)]
    pub(super) fn set_group(&mut self, group: usize, numbers: &[f64; LANES]) {
        self.0[group * LANES..][..LANES].copy_from_slice(numbers);
    }
}

impl Rows3 {
    pub(super) const ZERO: Self = Self { x: Row::ZERO, y: Row::ZERO, z: Row::ZERO };

    #[inline(always)]
    pub(super) fn at(&self, lane: usize) -> Vec3<f64> {
        Vec3::new(self.x.0[lane], self.y.0[lane], self.z.0[lane])
    }

    /// The vectors of a group.
    #[inline(always)]
    pub(super) fn group(&self, group: usize) -> [[f64; LANES]; 3] {
        [self.x.group(group), self.y.group(group), self.z.group(group)]
    }

    /// The vectors of some paths.
    #[inline(always)]
    pub(super) fn of(&self, paths: &[usize; LANES]) -> [[f64; LANES]; 3] {
        [self.x.of(paths), self.y.of(paths), self.z.of(paths)]
    }

    /// Becomes these vectors in a group.
    #[inline(always)]
    pub(super) fn set_group(&mut self, group: usize, [x, y, z]: &[[f64; LANES]; 3]) {
        self.x.set_group(group, x);
        self.y.set_group(group, y);
        self.z.set_group(group, z);
    }

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, v: Vec3<f64>) {
        self.x.0[lane] = v.x;
        self.y.0[lane] = v.y;
        self.z.0[lane] = v.z;
    }
}

/// The paths whose bits are set.
#[inline(always)]
pub(super) fn lanes(mut mask: Mask) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        if mask == 0 {
            return None;
        }
        // Below `W`, which spares the checks of bounds.
        let lane = mask.trailing_zeros() as usize % W;
        mask &= mask - 1;
        Some(lane)
    })
}

/// The bits of a group.
#[inline(always)]
pub(super) fn group_of(mask: Mask, group: usize) -> u8 {
    (mask >> (group * LANES)) as u8
}
