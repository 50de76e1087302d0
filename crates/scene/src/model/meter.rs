//! Meters: what a scene measures beside its picture.

use std::f64::consts::PI;

/// A meter.
#[derive(Clone, Debug, PartialEq)]
pub struct Meter {
    /// Its name in the file, or `meters[i]`.
    pub name: String,
    /// What it measures, and where.
    pub kind: MeterKind,
}

/// What a meter measures. It is in nobody's way: no ray meets it.
#[derive(Clone, Debug, PartialEq)]
pub enum MeterKind {
    /// Irradiance at a point, on the side that the normal points into.
    Irradiance {
        /// Position, m.
        position_m: [f64; 3],
        /// Unit normal.
        normal: [f64; 3],
    },
    /// Irradiance at the centres of the cells of a parallelogram, on the side that u × v points into.
    IrradianceGrid {
        /// A corner, m.
        origin_m: [f64; 3],
        /// Edges u and v from it, m; not parallel.
        edges_m: [[f64; 3]; 2],
        /// Cells along u and along v, at least one each.
        cells: [u32; 2],
    },
    /// Flux through a parallelogram toward the side that u × v points away from: what arrives on the side that it points into.
    Flux {
        /// A corner, m.
        origin_m: [f64; 3],
        /// Edges u and v from it, m; not parallel.
        edges_m: [[f64; 3]; 2],
    },
    /// Mean radiance that arrives at a point from a cone of directions.
    Radiance {
        /// Position, m.
        position_m: [f64; 3],
        /// Unit vector along the axis of the cone, from the meter outward.
        direction: [f64; 3],
        /// Half angle of the cone, rad, from 0 to π/2.
        half_angle_rad: f64,
    },
}

/// A place where a path begins that is measured.
#[derive(Clone, Debug, PartialEq)]
pub enum Receiver {
    /// The white side of a piece of a plane, seen from before it: it shows E/π, E the mean irradiance over the piece.
    Plane {
        /// A corner, m.
        origin_m: [f64; 3],
        /// Edges from it, m; both 0 of a point.
        edges_m: [[f64; 3]; 2],
        /// Unit normal.
        normal: [f64; 3],
    },
    /// A point that sees directions of a cone, evenly in solid angle.
    Cone {
        /// Position, m.
        position_m: [f64; 3],
        /// Unit vector along the axis.
        axis: [f64; 3],
        /// One less the cosine of the half angle.
        one_minus_cos: f64,
    },
}

/// What is beside a reading's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeterQuantity {
    /// W·m⁻², lx.
    Irradiance,
    /// W, lm.
    Flux,
    /// W·m⁻²·sr⁻¹, cd·m⁻².
    Radiance,
}

impl MeterKind {
    /// What it measures.
    pub fn quantity(&self) -> MeterQuantity {
        match self {
            Self::Irradiance { .. } | Self::IrradianceGrid { .. } => MeterQuantity::Irradiance,
            Self::Flux { .. } => MeterQuantity::Flux,
            Self::Radiance { .. } => MeterQuantity::Radiance,
        }
    }

    /// What the mean radiance that its receiver shows is multiplied by: π of irradiance, π and the area in m² of flux, 1 of radiance.
    pub fn factor(&self) -> f64 {
        match self {
            Self::Irradiance { .. } | Self::IrradianceGrid { .. } => PI,
            Self::Flux { edges_m, .. } => PI * cross(*edges_m).iter().map(|c| c * c).sum::<f64>().sqrt(),
            Self::Radiance { .. } => 1.0,
        }
    }

    /// How many readings it has.
    pub fn reading_count(&self) -> u64 {
        match self {
            Self::IrradianceGrid { cells: [columns, rows], .. } => u64::from(*columns) * u64::from(*rows),
            _ => 1,
        }
    }

    /// Readings in a row of a grid; else 1.
    pub fn columns(&self) -> u32 {
        match self {
            Self::IrradianceGrid { cells: [columns, _], .. } => *columns,
            _ => 1,
        }
    }

    /// Its readings, row by row of a grid, each row along u.
    pub fn receivers(&self) -> Vec<Receiver> {
        match *self {
            Self::Irradiance { position_m, normal } => {
                vec![Receiver::Plane { origin_m: position_m, edges_m: [[0.0; 3]; 2], normal }]
            }
            Self::IrradianceGrid { origin_m, edges_m, cells: [columns, rows] } => {
                let normal = normal_of(edges_m);
                let share = |i: u32, of: u32| (f64::from(i) + 0.5) / f64::from(of);
                let at = |column: u32, row: u32| {
                    let (a, b) = (share(column, columns), share(row, rows));
                    std::array::from_fn(|k| origin_m[k] + a * edges_m[0][k] + b * edges_m[1][k])
                };
                let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
                let plane =
                    |(column, row)| Receiver::Plane { origin_m: at(column, row), edges_m: [[0.0; 3]; 2], normal };
                cells.map(plane).collect()
            }
            Self::Flux { origin_m, edges_m } => {
                vec![Receiver::Plane { origin_m, edges_m, normal: normal_of(edges_m) }]
            }
            Self::Radiance { position_m, direction, half_angle_rad } => {
                // 1 − cos x = 2 sin²(x/2) loses no digits of small angles.
                let half = (0.5 * half_angle_rad).sin();
                vec![Receiver::Cone { position_m, axis: direction, one_minus_cos: 2.0 * half * half }]
            }
        }
    }
}

fn cross([u, v]: [[f64; 3]; 2]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// The unit vector along u × v; edges that the format accepts have one.
fn normal_of(edges_m: [[f64; 3]; 2]) -> [f64; 3] {
    // Lengths near 1 first, so that the product neither overflows nor underflows.
    let scaled = edges_m.map(|edge| {
        let largest = edge.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        edge.map(|c| c / largest)
    });
    let normal = cross(scaled);
    let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
    normal.map(|c| c / length)
}
