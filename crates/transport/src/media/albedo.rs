//! The share of what a medium takes from a path that it scatters, from place to place: the colours of a grid.

use super::density::to_cells;
use crate::frame::SceneFrame;
use etalon_optics::spectrum::RgbBasis;
use etalon_optics::{Lanes, Vec3};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Colours at the middles of cells, trilinear between them; from the outermost middles on everything is the same.
#[derive(Clone, Debug)]
pub(crate) struct AlbedoGrid {
    cells: [u32; 3],
    colours: Arc<[[f32; 3]]>,
    /// From the frame to coordinates in which the middle of cell (i, j, k) is (i, j, k).
    to_cells: DAffine3,
    /// What the channels are at each wavelength.
    basis: RgbBasis,
}

impl AlbedoGrid {
    pub(super) fn new(grid: &etalon_scene::AlbedoGrid, frame: &SceneFrame) -> Self {
        let to_cells = to_cells(grid.cells, grid.box_m, &grid.transform, frame);
        Self { cells: grid.cells, colours: grid.colours.clone(), to_cells, basis: RgbBasis::get() }
    }

    /// The share in each lane at a place.
    pub(super) fn lanes<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, place: Vec3<f64>) -> Lanes<f64, N> {
        let rgb = self.colour(place);
        Lanes::from_fn(|lane| self.basis.reflectance(rgb, lambda_nm[lane]))
    }

    fn colour(&self, place: Vec3<f64>) -> [f64; 3] {
        let at = self.to_cells.transform_point3(DVec3::from_array(place.to_array())).to_array();
        // The cells before and after along each axis, and the share of the latter.
        let along = [0, 1, 2].map(|k| {
            let last = self.cells[k] - 1;
            let at = at[k].clamp(0.0, f64::from(last));
            let before = (at as u32).min(last.saturating_sub(1));
            (before as usize, (before + 1).min(last) as usize, at - f64::from(before))
        });
        let [columns, rows] = [self.cells[0] as usize, self.cells[1] as usize];
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let (mut index, mut weight) = ([0; 3], 1.0);
            for k in 0..3 {
                let (before, after, share) = along[k];
                let is_after = corner >> k & 1 == 1;
                index[k] = if is_after { after } else { before };
                weight *= if is_after { share } else { 1.0 - share };
            }
            let colour = self.colours[(index[2] * rows + index[1]) * columns + index[0]];
            for c in 0..3 {
                sum[c] += weight * f64::from(colour[c]);
            }
        }
        sum
    }
}
