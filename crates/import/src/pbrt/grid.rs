//! Media of pbrt that are grids.
//!
//! There a cell outside of the grid counts as empty, so that densities fall to their half at the faces of the box. Here they stay what they
//! are in the outermost cells. A layer of empty cells around the grid makes both the same inside of the box.

use serde_json::{Value, json};

use super::Reading;
use super::parameters::Parameters;
use crate::coefficient;
use crate::matrix::steps;
use crate::medium::vol;

/// Differences that are smaller than this part of the largest number are rounding.
const ROUNDING: f64 = 1e-6;

/// A colour for each cell.
type Colours = Vec<[f64; 3]>;

/// Cells and the box around them.
#[derive(Clone, Copy, Debug)]
struct Lattice {
    cells: [usize; 3],
    box_m: [[f64; 3]; 2],
}

impl Lattice {
    fn read(list: &Parameters, place: &str) -> Result<Self, String> {
        let count = |key: &str| -> Result<usize, String> {
            let count = list.number_or(key, 1.0)?;
            match count {
                1.0..=4096.0 => Ok(count as usize),
                _ => Err(format!("{place}: \"{key}\" is {count}: 1 to 4096 cells are read")),
            }
        };
        let corners = [list.triple("p0")?.unwrap_or([0.0; 3]), list.triple("p1")?.unwrap_or([1.0; 3])];
        let [low, high] = [f64::min, f64::max]
            .map(|of: fn(f64, f64) -> f64| std::array::from_fn(|k| of(corners[0][k], corners[1][k])));
        Ok(Self { cells: [count("nx")?, count("ny")?, count("nz")?], box_m: [low, high] })
    }

    fn count(&self) -> usize {
        self.cells.iter().product()
    }

    fn index(&self, at: [usize; 3]) -> usize {
        (at[2] * self.cells[1] + at[1]) * self.cells[0] + at[0]
    }

    fn at(&self, index: usize) -> [usize; 3] {
        let [columns, rows, _] = self.cells;
        [index % columns, index / columns % rows, index / columns / rows]
    }

    fn is_outermost(&self, at: [usize; 3]) -> bool {
        (0..3).any(|k| at[k] == 0 || at[k] + 1 == self.cells[k])
    }

    /// The cells that are `steps` steps along axes away from one, along each axis at most one.
    fn near(&self, index: usize, steps: usize) -> Vec<usize> {
        let at = self.at(index);
        let moved = |code: usize| -> Option<[usize; 3]> {
            let step = [code % 3, code / 3 % 3, code / 9];
            let next: [usize; 3] = std::array::from_fn(|k| (at[k] + step[k]).wrapping_sub(1));
            let fits =
                step.iter().filter(|step| **step != 1).count() == steps && (0..3).all(|k| next[k] < self.cells[k]);
            fits.then_some(next)
        };
        (0..27).filter_map(moved).map(|at| self.index(at)).collect()
    }

    /// The same with one more layer of cells around it, which are empty.
    fn surrounded(&self, densities: &[f64]) -> (Self, Vec<f64>) {
        let [low, high] = self.box_m;
        let cell: [f64; 3] = std::array::from_fn(|k| (high[k] - low[k]) / self.cells[k] as f64);
        let box_m = [std::array::from_fn(|k| low[k] - cell[k]), std::array::from_fn(|k| high[k] + cell[k])];
        let outer = Self { cells: self.cells.map(|count| count + 2), box_m };
        let mut surrounded = vec![0.0; outer.count()];
        for (index, density) in densities.iter().enumerate() {
            surrounded[outer.index(self.at(index).map(|k| k + 1))] = *density;
        }
        (outer, surrounded)
    }

    fn file(&self, channels: u32, values: &[f64]) -> Vec<u8> {
        vol(self.cells.map(|count| count as u32), channels, self.box_m, values)
    }
}

impl Reading<'_, '_> {
    /// The density of a `uniformgrid`.
    pub(super) fn uniform_grid(&mut self, list: &Parameters, place: &str) -> Result<Value, String> {
        let lattice = Lattice::read(list, place)?;
        let densities = list.numbers("density").unwrap_or(&[]);
        if densities.len() != lattice.count() {
            let found = densities.len();
            return Err(format!("{place}: {} cells have {found} densities", lattice.count()));
        }
        Ok(self.density(&lattice, densities, place))
    }

    /// A density of the format.
    fn density(&mut self, lattice: &Lattice, densities: &[f64], place: &str) -> Value {
        let ends = |(index, density): (usize, &f64)| *density != 0.0 && lattice.is_outermost(lattice.at(index));
        let bytes = if densities.iter().enumerate().any(ends) {
            let what = "the outermost cells of its grid are not empty: where its body is larger than its box, it fades out over half a cell \
                        beyond the box, where pbrt cuts it off";
            self.builder.approximate(place, what);
            let (outer, densities) = lattice.surrounded(densities);
            outer.file(1, &densities)
        } else {
            lattice.file(1, densities)
        };
        let mut density = self.placed("density", bytes);
        density["type"] = json!("grid");
        density
    }

    /// The file of a grid and where it lies.
    fn placed(&mut self, kind: &str, bytes: Vec<u8>) -> Value {
        let mut grid = json!({ "file": self.builder.add_file(kind, "vol", bytes) });
        let transform = steps(&self.to_world());
        if !transform.is_null() {
            grid["transform"] = transform;
        }
        grid
    }

    /// An `rgbgrid`: two colours for each cell. The mean of the channels of the extinction is the density, and its mean colour is that of all
    /// cells; the share of each channel that is scattered is the albedo.
    pub(super) fn rgb_grid(&mut self, list: &Parameters, scale: f64, place: &str) -> Result<Value, String> {
        let lattice = Lattice::read(list, place)?;
        let (absorbed, scattered) =
            (colours(list, "sigma_a", &lattice, place)?, colours(list, "sigma_s", &lattice, place)?);
        let missing = match (&absorbed, &scattered) {
            (None, None) => return Err(format!("{place}: it has neither \"sigma_a\" nor \"sigma_s\"")),
            (None, _) => Some("sigma_a"),
            (_, None) => Some("sigma_s"),
            _ => None,
        };
        if let Some(missing) = missing {
            let what = format!(
                "\"{missing}\", which is not stated, is 1 in each cell: in pbrt it does not fall to its half at the faces of the box"
            );
            self.builder.approximate(place, what);
        }
        if list.get("Le").is_some() {
            list.get("Lescale");
            self.builder.leave_out(place, "\"Le\" is left out: a grid of light cannot be read");
        }
        let [absorbed, scattered] =
            [absorbed, scattered].map(|stated| stated.unwrap_or(vec![[1.0; 3]; lattice.count()]));
        let extinction: Colours =
            absorbed.iter().zip(&scattered).map(|(a, s)| std::array::from_fn(|c| a[c] + s[c])).collect();
        let densities: Vec<f64> = extinction.iter().map(|rgb| rgb.iter().sum::<f64>() / 3.0).collect();
        let total: f64 = densities.iter().sum();
        let largest = extinction.as_flattened().iter().fold(0.0, |a: f64, b| a.max(*b));
        if total == 0.0 {
            return Ok(json!({ "absorption_per_m": 0 }));
        }
        let hue =
            |of: &Colours| -> [f64; 3] { std::array::from_fn(|c| of.iter().map(|rgb| rgb[c]).sum::<f64>() / total) };
        // How far a cell may be from its density times the mean colour, as a share of the largest extinction.
        let off = |of: &Colours| {
            let hue = hue(of);
            let differences =
                of.iter().zip(&densities).flat_map(|(rgb, d)| (0..3).map(move |c| (rgb[c] - d * hue[c]).abs()));
            differences.fold(0.0, f64::max) / largest
        };
        let mut medium = json!({ "density": self.density(&lattice, &densities, place) });
        let stated = |rgb: [f64; 3]| coefficient(rgb.map(|v| v * scale));
        if off(&absorbed) <= ROUNDING && off(&scattered) <= ROUNDING {
            medium["absorption_per_m"] = stated(hue(&absorbed));
            medium["scattering_per_m"] = stated(hue(&scattered));
            return Ok(medium);
        }
        let of_colour = off(&extinction);
        if of_colour > ROUNDING {
            let what = format!(
                "the extinction of all cells has the mean colour: in a channel of a cell it is up to {} of the largest extinction from its own",
                percent(of_colour)
            );
            self.builder.approximate(place, what);
        }
        let albedos = albedos(&lattice, &extinction, &scattered);
        let of_albedo = between(&lattice, &densities, &albedos, hue(&extinction)) / largest;
        if of_albedo > ROUNDING {
            let what = format!(
                "between the middles of its cells density and albedo are in proportion, and not their product: what is scattered there differs \
                 by up to {} of the largest extinction",
                percent(of_albedo)
            );
            self.builder.approximate(place, what);
        }
        medium["extinction_per_m"] = stated(hue(&extinction));
        medium["albedo"] = json!(1);
        let is_grey = albedos.iter().all(|rgb| rgb[0] == rgb[1] && rgb[1] == rgb[2]);
        let bytes = match is_grey {
            true => lattice.file(1, &albedos.iter().map(|rgb| rgb[0]).collect::<Vec<_>>()),
            false => lattice.file(3, albedos.as_flattened()),
        };
        medium["albedo_grid"] = self.placed("albedo", bytes);
        Ok(medium)
    }
}

/// A colour for each cell, none of them negative.
fn colours(list: &Parameters, name: &str, lattice: &Lattice, place: &str) -> Result<Option<Colours>, String> {
    let Some(parameter) = list.get(name) else { return Ok(None) };
    let (colours, rest) = parameter.numbers().as_chunks();
    if !matches!(parameter.kind.as_str(), "rgb" | "color") || !rest.is_empty() || colours.len() != lattice.count() {
        return Err(format!("{place}: \"{name}\" is not a colour for each of {} cells", lattice.count()));
    }
    match colours.as_flattened().iter().all(|v| *v >= 0.0) {
        true => Ok(Some(colours.to_vec())),
        false => Err(format!("{place}: a number of \"{name}\" is negative")),
    }
}

/// The share of the extinction that is scattering, cell by cell. Where there is no extinction it is that of the nearest cells around, so that
/// it does not change toward the empty cell.
fn albedos(lattice: &Lattice, extinction: &Colours, scattered: &Colours) -> Colours {
    let share = |cells: &[usize], c: usize| {
        let sum = |of: &Colours| cells.iter().map(|cell| of[*cell][c]).sum::<f64>();
        Some(sum(extinction)).filter(|sum| *sum > 0.0).map(|extinction| (sum(scattered) / extinction).min(1.0))
    };
    let all: Vec<usize> = (0..lattice.count()).collect();
    let whole = [0, 1, 2].map(|c| share(&all, c).unwrap_or(0.0));
    let of_cell = |index: usize| {
        // First the cells that share a face with it, then those that share an edge, then a corner.
        let near = |steps: usize| if steps == 0 { vec![index] } else { lattice.near(index, steps) };
        std::array::from_fn(|c| (0..4).find_map(|steps| share(&near(steps), c)).unwrap_or(whole[c]))
    };
    all.iter().map(|index| of_cell(*index)).collect()
}

/// The largest difference between the mean of the products of densities and albedos and the product of their means, over the middles between
/// cells that touch, times the colour of the extinction.
fn between(lattice: &Lattice, densities: &[f64], albedos: &Colours, hue: [f64; 3]) -> f64 {
    let mut largest = 0.0_f64;
    for index in 0..lattice.count() {
        let at = lattice.at(index);
        for axes in 1..8_usize {
            let towards = |corner: usize| -> [usize; 3] { std::array::from_fn(|k| at[k] + (corner >> k & 1)) };
            let last = towards(axes);
            if (0..3).any(|k| last[k] == lattice.cells[k]) {
                continue;
            }
            let corners: Vec<usize> =
                (0..8).filter(|corner| corner & !axes == 0).map(|corner| lattice.index(towards(corner))).collect();
            let mean = |of: &dyn Fn(usize) -> f64| corners.iter().map(|i| of(*i)).sum::<f64>() / corners.len() as f64;
            for c in 0..3 {
                let product = mean(&|i| densities[i] * albedos[i][c]);
                let apart = mean(&|i| densities[i]) * mean(&|i| albedos[i][c]);
                largest = largest.max(hue[c] * (product - apart).abs());
            }
        }
    }
    largest
}

/// A share in per cent, with two digits that count.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let digits = (1.0 - percent.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{percent:.digits$} %")
}
