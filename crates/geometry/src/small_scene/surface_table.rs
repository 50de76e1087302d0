//! The planes of few primitives, where eight rays at once find them.

use super::FLAT_LIMIT;
use crate::PrimitiveId;
use crate::ray::ExactPoint;
use crate::shapes::planar;
use etalon_optics::Vec3;

/// Numbers of a plane: see [`planar::surface`]. Its normal, a point, its size, and 1, or 0 for what is no plane.
pub(crate) const ROW: usize = 8;
pub(crate) const POINT: u32 = 3;
pub(crate) const SIZE: u32 = 6;
pub(crate) const IS_PLANE: u32 = 7;

/// The planes of primitives.
#[derive(Debug)]
pub(crate) struct SurfaceTable(Vec<f64>);

impl SurfaceTable {
    /// Of planes: a point, the unit normal and the size each; none of what is curved.
    pub(crate) fn new(planes: impl Iterator<Item = Option<(Vec3<f64>, Vec3<f64>, f64)>>) -> Self {
        let mut table = vec![0.0; ROW * FLAT_LIMIT];
        for (row, plane) in table.chunks_mut(ROW).zip(planes) {
            if let Some((point, normal, size)) = plane {
                row.copy_from_slice(&[normal.x, normal.y, normal.z, point.x, point.y, point.z, size, 1.0]);
            }
        }
        Self(table)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }

    /// The rows.
    #[inline(always)]
    pub(crate) fn rows(&self) -> &[f64; ROW * FLAT_LIMIT] {
        self.0.as_slice().try_into().expect("a plane for each id")
    }

    /// The surface of a primitive near a point; `or` tells that of what is curved.
    #[inline]
    pub(crate) fn at(&self, id: PrimitiveId, p: Vec3<f64>, or: impl FnOnce() -> ExactPoint) -> ExactPoint {
        let (rows, _) = self.0.as_chunks::<ROW>();
        match rows[id.0 as usize] {
            [nx, ny, nz, x, y, z, size, 1.0] => planar::surface(p, Vec3::new(x, y, z), Vec3::new(nx, ny, nz), size),
            _ => or(),
        }
    }
}
