//! How dense media are along a way: one kind a file, one door, [`MediumDensity`].
//!
//! Both coefficients of a medium are multiplied by its density ρ, so all that light meets on a way depends on its **column**, the integral of
//! ρ over the way: a column c takes as much light away as the length c of the medium where ρ is 1. For each kind here the column is known in
//! closed form, and so is the place at which a given column is reached. So what comes through has no noise, a path is scattered by one random
//! number, and there are no collisions that scatter nothing (regular tracking; Novák et al., *Monte Carlo Methods for Volumetric Light
//! Transport Simulation*, CGF 37(2), 2018, §5.1). The cost grows with what a ray crosses.

mod exponential;
mod grid;

use crate::frame::SceneFrame;
use etalon_optics::Vec3;
use exponential::Exponential;
use grid::Grid;
pub(super) use grid::to_cells;

/// A straight way, in the frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// Where it begins.
    pub origin: Vec3<f64>,
    /// A unit vector; in the coordinates of a medium that is placed, as the placement leaves it.
    pub direction: Vec3<f64>,
    /// Of the whole, in lengths of the direction. May be infinite.
    pub length: f64,
    /// From 0 to 1 of the shutter's.
    pub time: f64,
}

impl Way {
    /// The place at a distance along it.
    #[inline]
    pub(crate) fn at(&self, distance: f64) -> Vec3<f64> {
        self.origin + self.direction * distance
    }
}

/// How dense a medium is at each place.
#[derive(Clone, Debug)]
pub(crate) enum MediumDensity {
    Uniform,
    Exponential(Exponential),
    Grid(Box<Grid>),
}

impl MediumDensity {
    /// The density of a scene, in its frame.
    pub(crate) fn new(density: &etalon_scene::MediumDensity, frame: &SceneFrame) -> Self {
        match density {
            etalon_scene::MediumDensity::Uniform => Self::Uniform,
            etalon_scene::MediumDensity::Exponential(one) => Self::Exponential(Exponential::new(one, frame)),
            etalon_scene::MediumDensity::Grid(grid) => Self::Grid(Box::new(Grid::new(grid, frame))),
        }
    }

    /// Whether it is not the same everywhere.
    #[inline]
    pub(crate) fn varies(&self) -> bool {
        !matches!(self, Self::Uniform)
    }

    /// The integral of the density over a way, in lengths of its direction.
    #[inline]
    pub(crate) fn column(&self, way: &Way) -> f64 {
        match self {
            Self::Uniform => way.length,
            Self::Exponential(one) => one.column(way),
            Self::Grid(grid) => grid.column(way),
        }
    }

    /// The density at a place.
    #[inline]
    pub(crate) fn at(&self, place: Vec3<f64>) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Exponential(one) => one.at(place),
            Self::Grid(grid) => grid.at(place),
        }
    }

    /// How far along a way a column is reached that is less than that of the whole way.
    #[inline]
    pub(crate) fn distance(&self, way: &Way, column: f64) -> f64 {
        match self {
            Self::Uniform => column,
            Self::Exponential(one) => one.distance(way, column),
            Self::Grid(grid) => grid.distance(way, column),
        }
    }
}

#[cfg(test)]
mod tests;
