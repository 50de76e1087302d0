//! Which wavelengths a path carries, and what a spectral sample means for the film.
//!
//! Hero-wavelength sampling (Wilkie et al. 2014, *Hero Wavelength Spectral Sampling*): one random number chooses the
//! hero, the other lanes are its rotations by 1/N **in the cumulative distribution**, so that each lane alone has the
//! density of the distribution and the lanes together are stratified.

pub(crate) mod cells;
pub(crate) mod guide;

use crate::wavelength::cells::{CellTable, Place};
use etalon_optics::Lanes;
use etalon_optics::colour::{cie_y_integral_nm, colour_matching};
use etalon_scene::Bands;

/// The wavelengths of one path.
#[derive(Clone, Copy, Debug)]
pub struct Wavelengths<const N: usize> {
    /// Wavelengths in nm; lane 0 is the hero.
    pub lambda_nm: Lanes<f64, N>,
    /// Where they are among the cells that they were drawn from.
    pub(crate) place: Place,
    /// The density of each as hero, over that of the distribution: 1 unless a [`guide`](guide::WavelengthGuide) has drawn them.
    pub(crate) density: Lanes<f64, N>,
}

/// A density over wavelengths: x̄ + ȳ + z̄ blurred, with a floor, constant within each nanometre.
///
/// It is normalised over the range that is sampled, nothing else (hard case 34).
///
/// The lanes of a path are equidistant in the cumulative distribution: together they are a quadrature rule, whose error is how
/// rough S·x̄/density is along that distribution. A density as bumpy as x̄ + ȳ + z̄ itself is nearer to what is integrated, and yet
/// the worse choice: hence the blur.
///
/// Every nanometre is divided evenly into whole numbers of cells of the same probability (module `cells`), so that its density is that
/// of the blurred sum to the nearest cell, and at least one cell's: what is linear between whole nanometres, as the
/// matching functions and tabulated spectra are, is linear along a cell.
#[derive(Clone, Debug)]
pub struct WavelengthDistribution {
    /// The wavelength at which each cell begins and its width, nm.
    cells: Vec<[f64; 2]>,
    last_nm: f64,
    lambda_nm: CellTable,
    /// x̄, ȳ and z̄ over the density and ∫ȳ.
    responses: [CellTable; 3],
}

/// Wavelengths between borders, each with its own constant density.
struct Segments {
    borders_nm: Vec<f64>,
    /// The probability up to each border, times a constant.
    cumulative: Vec<f64>,
}

/// Share of the largest colour-matching sum below which no wavelength's density falls: the ends of the range matter
/// little to the eye but must stay reachable with a bounded weight.
const FLOOR: f64 = 0.02;
/// Standard deviation of the blur, nm. Of 10 to 40 nm, and of several other shapes, this leaves eight lanes the least colour
/// noise over daylight, lamps, black bodies and what paints reflect of them: a tenth of that without blur.
const BLUR_NM: i32 = 40;
/// Fewest cells: nine a nanometre of the visible range in the mean, so that one, the fewest that a nanometre may have, is not much more
/// than the ends of the range would have by the floor, and few enough for tables by cells to stay in caches.
const FEWEST_CELLS: usize = 4096;

/// Share of the samples that bands of a film get evenly: every band then has at least half as many as an even spread would
/// give it, and the variance of the colour at most doubles.
const EVEN_SHARE: f64 = 0.5;

impl Segments {
    /// Nanometre by nanometre, in proportion to the blurred sum.
    fn blurred(range_nm: [f64; 2], blur_nm: i32) -> Self {
        let [first, last] = range_nm;
        let mut borders_nm = vec![first];
        borders_nm.extend((1..).map(|i| first.floor() + f64::from(i)).take_while(|&nm| nm < last));
        borders_nm.push(last);
        let blur: Vec<(f64, f64)> = (-4 * blur_nm..=4 * blur_nm)
            .map(|d| (f64::from(d), (-0.5 * f64::from(d * d) / f64::from(blur_nm * blur_nm)).exp()))
            .collect();
        let sensitivity = |nm: f64| -> f64 {
            blur.iter().map(|(d, weight)| weight * colour_matching(nm + d).iter().sum::<f64>()).sum()
        };
        let density: Vec<f64> = borders_nm.windows(2).map(|w| sensitivity(0.5 * (w[0] + w[1]))).collect();
        let floor = FLOOR * density.iter().fold(0.0, |a, &b| f64::max(a, b));
        // A range without any visible wavelength is sampled uniformly.
        let floor = if floor > 0.0 { floor } else { 1.0 };
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for (w, d) in borders_nm.windows(2).zip(density) {
            sum += (w[1] - w[0]) * f64::max(d, floor);
            cumulative.push(sum);
        }
        Self { borders_nm, cumulative }
    }

    /// The same with a segment for each band, half of what they have together spread evenly over them.
    fn with_bands(&self, bands: &Bands) -> Self {
        let edges: Vec<f64> = (0..=bands.count).map(|index| bands.edge_nm(index)).collect();
        let (begin, end) = (edges[0], edges[edges.len() - 1]);
        let outside = |nm: &f64| *nm < begin || *nm > end;
        let mut borders_nm: Vec<f64> = self.borders_nm.iter().copied().filter(outside).chain(edges).collect();
        borders_nm.sort_by(f64::total_cmp);
        let of_bands = self.up_to(end) - self.up_to(begin);
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for w in borders_nm.windows(2) {
            let seen = self.up_to(w[1]) - self.up_to(w[0]);
            let even = of_bands / f64::from(bands.count);
            let in_band = w[0] >= begin && w[1] <= end;
            sum += if in_band { EVEN_SHARE * even + (1.0 - EVEN_SHARE) * seen } else { seen };
            cumulative.push(sum);
        }
        Self { borders_nm, cumulative }
    }

    /// What [`Segments::cumulative`] is at `nm`.
    fn up_to(&self, nm: f64) -> f64 {
        let segment = self.borders_nm.partition_point(|&border| border <= nm).clamp(1, self.borders_nm.len() - 1) - 1;
        let (c, nms) = (&self.cumulative[segment..=segment + 1], &self.borders_nm[segment..=segment + 1]);
        c[0] + (c[1] - c[0]) * ((nm - nms[0]) / (nms[1] - nms[0]))
    }

    /// How many of `cells` each segment gets: what is nearest to its probability, at least one.
    fn shares(&self, cells: usize) -> Vec<usize> {
        let masses: Vec<f64> = self.cumulative.windows(2).map(|c| c[1] - c[0]).collect();
        // A little more than one, so that a sum of such is rounded up by one at least.
        let enough = |scale: f64, mass: f64| f64::max(scale * mass, 1.0 + 1e-9);
        let all = |scale: f64| masses.iter().map(|&mass| enough(scale, mass)).sum::<f64>();
        let (mut low, mut high) = (0.0, 2.0 * cells as f64 / self.cumulative[masses.len()]);
        // Halved as often as there are bits in a double.
        for _ in 0..64 {
            let middle = 0.5 * (low + high);
            if all(middle) < cells as f64 { low = middle } else { high = middle }
        }
        let (mut sum, mut before) = (0.0, 0);
        let mut shares: Vec<usize> = Vec::with_capacity(masses.len());
        for mass in masses {
            sum += enough(high, mass);
            let up_to_here = f64::round(sum) as usize;
            shares.push(up_to_here - before);
            before = up_to_here;
        }
        debug_assert!(before == cells && shares.iter().all(|&share| share > 0));
        shares
    }

    fn distribution(&self) -> WavelengthDistribution {
        let count = (4 * self.borders_nm.len()).next_power_of_two().max(FEWEST_CELLS);
        let mut cells = Vec::with_capacity(count);
        for (nm, share) in self.borders_nm.windows(2).zip(self.shares(count)) {
            let width_nm = (nm[1] - nm[0]) / share as f64;
            cells.extend((0..share).map(|cell| [nm[0] + cell as f64 * width_nm, width_nm]));
        }
        WavelengthDistribution::of_cells(cells, self.borders_nm[self.borders_nm.len() - 1])
    }
}

impl WavelengthDistribution {
    /// The distribution for a film that keeps bands: within each band the density is constant, so that the mean over the
    /// wavelengths that fall into a band is the mean over the band; half of the samples in the bands are spread evenly.
    pub fn for_bands(range_nm: [f64; 2], bands: &Bands) -> Self {
        Segments::blurred(range_nm, BLUR_NM).with_bands(bands).distribution()
    }

    /// The distribution over `range_nm`, which must be finite, ordered and not empty.
    pub fn new(range_nm: [f64; 2]) -> Self {
        Segments::blurred(range_nm, BLUR_NM).distribution()
    }

    fn of_cells(cells: Vec<[f64; 2]>, last_nm: f64) -> Self {
        let count = cells.len() as u32;
        let lambda_nm = CellTable::new(count, |cell| {
            let begin_nm = cells[cell as usize][0];
            let end_nm = cells.get(cell as usize + 1).map_or(last_nm, |next| next[0]);
            // Nothing is drawn where two cells meet, whatever is rounded: it would be in both.
            let first_nm = begin_nm.next_up();
            [first_nm, end_nm.next_down() - first_nm]
        });
        let of_cell = |&[begin_nm, width_nm]: &[f64; 2]| {
            // From within: at either end another stretch may begin.
            let [quarter, half, three_quarters] =
                [0.25, 0.5, 0.75].map(|part| colour_matching(begin_nm + part * width_nm));
            let scale = f64::from(count) * width_nm / cie_y_integral_nm();
            [0, 1, 2].map(|c: usize| {
                let step = 2.0 * (three_quarters[c] - quarter[c]);
                [(half[c] - 0.5 * step) * scale, step * scale]
            })
        };
        let of_cells: Vec<_> = cells.iter().map(of_cell).collect();
        let responses = [0, 1, 2].map(|c: usize| CellTable::new(count, |cell| of_cells[cell as usize][c]));
        Self { cells, last_nm, lambda_nm, responses }
    }

    /// The first and the last wavelength, nm.
    pub fn range_nm(&self) -> [f64; 2] {
        [self.cells[0][0], self.last_nm]
    }

    /// How many cells there are.
    pub(crate) fn count(&self) -> u32 {
        self.cells.len() as u32
    }

    /// The whole nanometres between which each cell is, as the first of the two; `None` if one of them is not between two.
    pub(crate) fn whole_nm(&self) -> Option<Vec<f64>> {
        let ends = self.cells[1..].iter().map(|cell| cell[0]).chain([self.last_nm]);
        let floors = self.cells.iter().zip(ends).map(|(&[begin_nm, _], end_nm)| {
            let whole_nm = begin_nm.floor();
            (end_nm <= whole_nm + 1.0).then_some(whole_nm)
        });
        floors.collect()
    }

    /// The wavelength at cumulative probability `u` in [0, 1), and its density in nm⁻¹.
    pub fn sample(&self, u: f64) -> (f64, f64) {
        let [_, width_nm] = self.cells[(u * self.cells.len() as f64) as usize];
        (self.sample_lanes::<1>(u).lambda_nm[0], 1.0 / (self.cells.len() as f64 * width_nm))
    }

    /// The wavelengths of a path whose hero is drawn by `u` in [0, 1); `N` divides eight.
    #[inline(always)]
    pub fn sample_lanes<const N: usize>(&self, u: f64) -> Wavelengths<N> {
        let place = Place::draw(u, self.count());
        Wavelengths { lambda_nm: self.lambda_nm.along(&place), place, density: Lanes::ONE }
    }

    /// The CIE XYZ estimate that the spectral radiance estimate `radiance` stands for, normalised so that a constant
    /// spectrum 1 over the whole visible range has Y = 1: Σ_lanes L·(x̄, ȳ, z̄)/pdf / N / ∫ȳ.
    #[inline(always)]
    pub fn to_xyz<const N: usize>(&self, wavelengths: &Wavelengths<N>, radiance: Lanes<f64, N>) -> [f64; 3] {
        self.seen(wavelengths, radiance).map(Lanes::sum)
    }

    /// What each lane adds to [`WavelengthDistribution::to_xyz`].
    #[inline(always)]
    pub(crate) fn seen<const N: usize>(
        &self,
        wavelengths: &Wavelengths<N>,
        radiance: Lanes<f64, N>,
    ) -> [Lanes<f64, N>; 3] {
        let radiance: Lanes<f64, N> = Lanes::from_fn(|lane| radiance[lane] * (1.0 / N as f64));
        let mut seen = [Lanes::ZERO; 3];
        for c in 0..3 {
            seen[c] = radiance * self.responses[c].along(&wavelengths.place);
        }
        seen
    }
}

impl<const N: usize> Wavelengths<N> {
    /// Those that are not drawn.
    pub(crate) const fn fixed(lambda_nm: [f64; N]) -> Self {
        Self { lambda_nm: Lanes(lambda_nm), place: Place::NONE, density: Lanes::ONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_integrates_to_one_and_samples_stay_inside() {
        for range in [[360.0, 830.0], [400.5, 700.25], [587.0, 587.5], [900.0, 1000.0]] {
            let d = WavelengthDistribution::new(range);
            assert_eq!(d.range_nm(), range);
            // E[1/pdf] over stratified u is the length of the range; the cells' borders fall between strata, which
            // costs one stratum's worth, 1e-5 of the range with 100 000 strata and densities within a factor 50.
            let n = 100_000;
            let length: f64 = (0..n).map(|i| 1.0 / d.sample((f64::from(i) + 0.5) / f64::from(n)).1).sum();
            let length = length / f64::from(n);
            assert!((length / (range[1] - range[0]) - 1.0).abs() < 1e-3, "{range:?}: {length}");
            for u in [0.0, f64::MIN_POSITIVE, 0.5, 1.0 - f64::EPSILON / 2.0] {
                let (nm, pdf) = d.sample(u);
                assert!((range[0]..=range[1]).contains(&nm) && pdf > 0.0 && pdf.is_finite(), "{u}: {nm} {pdf}");
            }
        }
    }

    /// A nanometre has at least one cell and what is nearest to its probability else; what is drawn there is spread evenly over it. Counted
    /// over an even comb of numbers with this many in each cell, so nothing is left to chance.
    #[test]
    fn densities_are_those_of_the_blurred_sum_to_half_a_cell_and_what_is_drawn_has_them() {
        let range = [360.0, 830.0];
        let (d, wanted) = (WavelengthDistribution::new(range), Segments::blurred(range, BLUR_NM));
        let cells = f64::from(d.count());
        let each = 16;
        let mut drawn = vec![(0_u32, 0.0); 470];
        for i in 0..d.count() * each {
            let (nm, pdf) = d.sample((f64::from(i) + 0.5) / f64::from(d.count() * each));
            let (count, within) = &mut drawn[(nm - range[0]) as usize];
            *count += 1;
            *within += nm.fract();
            // Of this very wavelength's cell: its share of all, over its width.
            let share = f64::from(d.cells.iter().filter(|cell| cell[0].floor() == nm.floor()).count() as u32);
            assert!((pdf - share / cells).abs() < 1e-12, "{nm} nm: {pdf}");
        }
        // One cell more or less than wanted: half by rounding where it begins, half where it ends; and by what raises others to one.
        let total = wanted.cumulative[470];
        for (nm, &(count, within)) in drawn.iter().enumerate() {
            let share = f64::from(count) / f64::from(each);
            let of_blurred = (wanted.cumulative[nm + 1] - wanted.cumulative[nm]) / total * cells;
            assert!(share >= 1.0 && share > 0.95 * of_blurred - 1.0 && share < of_blurred + 1.0, "{nm}: {share}");
            // The middles of even parts average to the middle, but for one ulp that no wavelength comes near borders.
            assert!((within / f64::from(count) - 0.5).abs() < 1e-9, "{nm}: {within}");
        }
    }

    #[test]
    fn no_wavelength_is_where_two_cells_meet() {
        for range in [[360.0, 830.0], [400.5, 700.25], [587.0, 587.5]] {
            let d = WavelengthDistribution::new(range);
            let whole_nm = d.whole_nm().expect("each cell is within a nanometre");
            for (cell, begin) in whole_nm.iter().enumerate() {
                for part in [0.0, 0.5, 1.0 - f64::from(f32::EPSILON)] {
                    let (nm, _) = d.sample((cell as f64 + part) / f64::from(d.count()));
                    assert!(nm > *begin && nm < begin + 1.0 && nm > range[0] && nm < range[1], "{cell}: {nm}");
                }
            }
        }
        // Bands that do not keep to nanometres are of one density each all the same.
        let bands = Bands::new([400.25, 700.25, 0.75], [360.0, 830.0]).unwrap();
        assert!(WavelengthDistribution::for_bands([360.0, 830.0], &bands).whole_nm().is_none());
    }

    /// Hard case 34: a sky of constant radiance 1. The estimate is an average over the hero's number alone.
    #[test]
    fn constant_one_reads_one_in_y_and_the_equal_energy_white_in_x_and_z() {
        let d = WavelengthDistribution::new([360.0, 830.0]);
        let n = 1_000_000;
        let mut xyz = [0.0; 3];
        for i in 0..n {
            let w = d.sample_lanes::<4>((f64::from(i) + 0.5) / f64::from(n));
            let sample = d.to_xyz(&w, Lanes::<f64, 4>::ONE);
            (0..3).for_each(|c| xyz[c] += sample[c] / f64::from(n));
        }
        let white = etalon_optics::colour::xyz_of(|_| 1.0);
        // The midpoint rule errs by 1/n at each of the 470 jumps of the density, with either sign.
        (0..3).for_each(|c| assert!((xyz[c] - white[c]).abs() < 1e-5, "{xyz:?} is not {white:?}"));
        assert!((white[1] - 1.0).abs() < 1e-12);
    }

    /// The lanes of one path are a quadrature of the picture's colour: of daylight, and of light that rises to the red, eight
    /// lanes tell linear Rec. 709 to a variance below .005 (root mean square over the channels, relative to Y = 1). A density
    /// that is hardly blurred, as near to the matching functions as can be, leaves over .01 and is seen.
    #[test]
    fn eight_lanes_of_a_smooth_density_are_a_good_quadrature() {
        let daylight = etalon_optics::colour::illuminant_d65;
        let rising = |nm: f64| (nm - 400.0).max(0.0);
        let variance = |d: &WavelengthDistribution, spectrum: &dyn Fn(f64) -> f64| {
            let n = 4000;
            let white = etalon_optics::colour::xyz_of(spectrum)[1];
            let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
            for i in 0..n {
                let w = d.sample_lanes::<8>((f64::from(i) + 0.5) / f64::from(n));
                let xyz = d.to_xyz(&w, Lanes::<f64, 8>::from_fn(|lane| spectrum(w.lambda_nm[lane]) / white));
                let rgb = etalon_optics::colour::rec709_from_xyz(xyz);
                for c in 0..3 {
                    sum[c] += rgb[c] / f64::from(n);
                    squares[c] += rgb[c] * rgb[c] / f64::from(n);
                }
            }
            (0..3).map(|c| squares[c] - sum[c] * sum[c]).sum::<f64>() / 3.0
        };
        let smooth = WavelengthDistribution::new([360.0, 830.0]);
        let near = Segments::blurred([360.0, 830.0], 1).distribution();
        for spectrum in [&daylight as &dyn Fn(f64) -> f64, &rising] {
            let (smooth, near) = (variance(&smooth, spectrum), variance(&near, spectrum));
            assert!(smooth < 0.005 && near > 0.01, "{smooth} and {near}");
        }
    }

    #[test]
    fn every_band_has_an_even_density_and_its_share_of_the_samples() {
        let range = [360.0, 830.0];
        for [first, last, step] in
            [[400.0, 700.0, 10.0], [365.0, 825.0, 10.0], [550.25, 551.25, 0.5], [500.0, 500.0, 60.0]]
        {
            let bands = Bands::new([first, last, step], range).unwrap();
            let d = WavelengthDistribution::for_bands(range, &bands);
            assert_eq!(d.range_nm(), range);
            let n = 100_000;
            let mut counts = vec![0_u32; bands.count as usize];
            let mut densities = vec![None; bands.count as usize];
            let mut length = 0.0;
            for i in 0..n {
                let (nm, pdf) = d.sample((f64::from(i) + 0.5) / f64::from(n));
                length += 1.0 / pdf / f64::from(n);
                let band = ((nm - bands.edge_nm(0)) / bands.step_nm).floor();
                if (0.0..f64::from(bands.count)).contains(&band) {
                    let band = band as usize;
                    counts[band] += 1;
                    // The same bits, but for a wavelength that was rounded onto the edge.
                    let known: f64 = *densities[band].get_or_insert(pdf);
                    assert!((pdf / known - 1.0).abs() < 1e-12, "{nm} nm: {pdf} is not {known}");
                }
            }
            assert!((length / (range[1] - range[0]) - 1.0).abs() < 1e-3, "{length}");
            let total: u32 = counts.iter().sum();
            let fewest = f64::from(*counts.iter().min().unwrap());
            // One stratum at each end.
            assert!(fewest + 2.0 >= 0.5 * f64::from(total) / f64::from(bands.count), "{counts:?}");
        }
    }

    #[test]
    fn a_lane_that_is_turned_to_the_very_end_begins_anew() {
        let d = WavelengthDistribution::new([360.0, 830.0]);
        // Three quarters and one quarter are exactly 1.
        assert_eq!(d.sample_lanes::<4>(0.75).lambda_nm[1], d.sample(0.0).0);
    }

    #[test]
    fn lanes_are_a_quarter_of_the_probability_apart() {
        let d = WavelengthDistribution::new([360.0, 830.0]);
        let w = d.sample_lanes::<4>(0.8);
        for (lane, u) in [0.8, 0.05, 0.3, 0.55].into_iter().enumerate() {
            // The rotated number is rounded once.
            assert!((w.lambda_nm[lane] - d.sample(u).0).abs() < 1e-9);
        }
    }
}
