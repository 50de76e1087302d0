//! The share of what a medium takes from a path that it scatters, from place to place: the colours of a grid.

use super::density::to_cells;
use crate::frame::SceneFrame;
use etalon_optics::spectrum::RgbBasis;
use etalon_optics::{Lanes, Vec3};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// A grid of a scene, prepared for paths.
#[derive(Clone, Debug)]
pub(crate) struct AlbedoGrid {
    grid: Arc<etalon_scene::AlbedoGrid>,
    /// From the frame to coordinates in which the box of the grid reaches from 0 to 1.
    to_box: DAffine3,
    /// What the channels are at each wavelength.
    basis: RgbBasis,
}

impl AlbedoGrid {
    pub(super) fn new(grid: &Arc<etalon_scene::AlbedoGrid>, frame: &SceneFrame) -> Self {
        // The middle of cell i lies at (i + ½)/n.
        let per_cell = DVec3::from_array(grid.cells.map(f64::from)).recip();
        let of_cells = DAffine3::from_scale(per_cell) * DAffine3::from_translation(DVec3::splat(0.5));
        let to_box = of_cells * to_cells(grid.cells, grid.box_m, &grid.transform, frame);
        Self { grid: grid.clone(), to_box, basis: RgbBasis::get() }
    }

    /// The share in each lane at a place.
    pub(super) fn lanes<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, place: Vec3<f64>) -> Lanes<f64, N> {
        let rgb = self.grid.eval(self.to_box.transform_point3(DVec3::from_array(place.to_array())).to_array());
        Lanes::from_fn(|lane| self.basis.reflectance(rgb, lambda_nm[lane]))
    }
}
