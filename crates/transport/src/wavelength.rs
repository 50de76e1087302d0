//! Which wavelengths a path carries, and what a spectral sample means for the film.
//!
//! Hero-wavelength sampling (Wilkie et al. 2014, *Hero Wavelength Spectral Sampling*): one random number chooses the
//! hero, the other lanes are its rotations by 1/N **in the cumulative distribution**, so that each lane alone has the
//! density of the distribution and the lanes together are stratified.

use etalon_optics::colour::{cie_y_integral_nm, colour_matching, colour_matching_lanes};
use etalon_optics::{Lanes, Real};
use etalon_scene::Bands;

/// The wavelengths of one path.
#[derive(Clone, Copy, Debug)]
pub struct Wavelengths<const N: usize> {
    /// Wavelengths in nm; lane 0 is the hero.
    pub lambda_nm: Lanes<f64, N>,
    /// Density of each, nm⁻¹.
    pub pdf: Lanes<f64, N>,
}

/// A density over wavelengths: x̄ + ȳ + z̄ blurred, with a floor, constant within each nanometre.
///
/// It is normalised over the range that is sampled, nothing else (hard case 34).
///
/// The lanes of a path are equidistant in the cumulative distribution: together they are a quadrature rule, whose error is how
/// rough S·x̄/density is along that distribution. A density as bumpy as x̄ + ȳ + z̄ itself is nearer to what is integrated, and yet
/// the worse choice: hence the blur.
#[derive(Clone, Debug)]
pub struct WavelengthDistribution {
    /// Where cells begin and end, in order: the cumulative probability, from 0 to 1, and the wavelength, nm.
    borders: Vec<[f64; 2]>,
    /// The cell at each multiple of 1/[`GUIDES`] of probability: where the search for a cell begins.
    guides: Vec<u16>,
    /// Most cells that a search passes.
    most_passed: u32,
}

/// A cell: see [`WavelengthDistribution`].
#[derive(Clone, Copy)]
struct Cell {
    /// Cumulative probability where it begins and ends.
    cdf: [f64; 2],
    /// Wavelengths there, nm.
    nm: [f64; 2],
}

impl Cell {
    /// The wavelength at cumulative probability `u`, nm, and its density, nm⁻¹.
    #[inline(always)]
    fn at(&self, u: f64) -> (f64, f64) {
        let (probability, width_nm) = (self.cdf[1] - self.cdf[0], self.nm[1] - self.nm[0]);
        (self.nm[0] + (u - self.cdf[0]) / probability * width_nm, probability / width_nm)
    }
}

/// Share of the largest colour-matching sum below which no wavelength's density falls: the ends of the range matter
/// little to the eye but must stay reachable with a bounded weight.
const FLOOR: f64 = 0.02;
/// Standard deviation of the blur, nm. Of 10 to 40 nm, and of several other shapes, this leaves eight lanes the least colour
/// noise over daylight, lamps, black bodies and what paints reflect of them: a tenth of that without blur.
const BLUR_NM: i32 = 40;
/// So many times the nanometres of the visible range that hardly a search passes more than one cell.
const GUIDES: usize = 4096;

/// Share of the samples that bands of a film get evenly: every band then has at least half as many as an even spread would
/// give it, and the variance of the colour at most doubles.
const EVEN_SHARE: f64 = 0.5;

impl WavelengthDistribution {
    /// The distribution for a film that keeps bands: within each band the density is constant, so that the mean over the
    /// wavelengths that fall into a band is the mean over the band; half of the samples in the bands are spread evenly.
    pub fn for_bands(range_nm: [f64; 2], bands: &Bands) -> Self {
        let plain = Self::new(range_nm);
        let edges: Vec<f64> = (0..=bands.count).map(|index| bands.edge_nm(index)).collect();
        let (begin, end) = (edges[0], edges[edges.len() - 1]);
        let outside = |nm: &f64| *nm < begin || *nm > end;
        let plain_nm = plain.borders.iter().map(|&[_, nm]| nm);
        let mut borders_nm: Vec<f64> = plain_nm.filter(outside).chain(edges).collect();
        borders_nm.sort_by(f64::total_cmp);
        let of_bands = plain.cumulative(end) - plain.cumulative(begin);
        let mut cdf = vec![0.0];
        let mut sum = 0.0;
        for w in borders_nm.windows(2) {
            let seen = plain.cumulative(w[1]) - plain.cumulative(w[0]);
            let even = of_bands / f64::from(bands.count);
            let in_band = w[0] >= begin && w[1] <= end;
            sum += if in_band { EVEN_SHARE * even + (1.0 - EVEN_SHARE) * seen } else { seen };
            cdf.push(sum);
        }
        cdf.iter_mut().for_each(|c| *c /= sum);
        Self::of_cells(borders_nm, cdf)
    }

    /// Probability of the wavelengths up to `nm`.
    fn cumulative(&self, nm: f64) -> f64 {
        let cell = self.borders.partition_point(|&[_, border]| border <= nm).clamp(1, self.borders.len() - 1) - 1;
        let ([c0, nm0], [c1, nm1]) = (self.borders[cell], self.borders[cell + 1]);
        c0 + (c1 - c0) * ((nm - nm0) / (nm1 - nm0))
    }

    /// The distribution over `range_nm`, which must be finite, ordered and not empty.
    pub fn new(range_nm: [f64; 2]) -> Self {
        Self::blurred(range_nm, BLUR_NM)
    }

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
        let mut cdf = vec![0.0];
        let mut sum = 0.0;
        for (w, d) in borders_nm.windows(2).zip(density) {
            sum += (w[1] - w[0]) * f64::max(d, floor);
            cdf.push(sum);
        }
        cdf.iter_mut().for_each(|c| *c /= sum);
        Self::of_cells(borders_nm, cdf)
    }

    fn of_cells(borders_nm: Vec<f64>, cdf: Vec<f64>) -> Self {
        let cell_at = |u: f64| cdf.partition_point(|&c| c <= u) - 1;
        let at = |guide: usize| guide as f64 / GUIDES as f64;
        // Fewer cells than 2¹⁶: wavelengths are tabulated at nanometres, and files of bands hold fewer.
        let guides: Vec<u16> =
            (0..GUIDES).map(|g| cell_at(at(g)).try_into().expect("cells have short numbers")).collect();
        // What a number below the next guide's may pass.
        let last = |g: usize| cell_at(at(g + 1).next_down());
        let most_passed = (0..GUIDES).map(|g| last(g) - usize::from(guides[g])).max().expect("there are guides") as u32;
        let borders = cdf.into_iter().zip(borders_nm).map(|(c, nm)| [c, nm]).collect();
        Self { borders, guides, most_passed }
    }

    /// The first and the last wavelength, nm.
    pub fn range_nm(&self) -> [f64; 2] {
        [self.borders[0][1], self.borders[self.borders.len() - 1][1]]
    }

    /// Number of the cell that `u` in [0, 1) falls into; no branch depends on `u`.
    #[inline(always)]
    fn number(&self, u: f64) -> usize {
        let mut cell = usize::from(self.guides[(u * GUIDES as f64) as u32 as usize]);
        for _ in 0..self.most_passed {
            cell += usize::from(self.borders[cell + 1][0] <= u);
        }
        cell
    }

    /// The cell of a number.
    #[inline(always)]
    fn cell(&self, number: usize) -> Cell {
        let (begin, end) = (self.borders[number], self.borders[number + 1]);
        Cell { cdf: [begin[0], end[0]], nm: [begin[1], end[1]] }
    }

    /// The wavelength at cumulative probability `u` in [0, 1), and its density in nm⁻¹.
    pub fn sample(&self, u: f64) -> (f64, f64) {
        self.cell(self.number(u)).at(u)
    }

    /// The wavelengths of a path whose hero is drawn by `u` in [0, 1).
    #[inline(always)]
    pub fn sample_lanes<const N: usize>(&self, u: f64) -> Wavelengths<N> {
        // Loops apart, of which the arithmetic becomes vector instructions.
        let (mut turned, mut numbers) = ([0.0; N], [0; N]);
        for lane in 0..N {
            let on = u + lane as f64 / N as f64;
            turned[lane] = if on < 1.0 { on } else { on - 1.0 };
        }
        for lane in 0..N {
            numbers[lane] = self.number(turned[lane]);
        }
        let (mut begin, mut end, mut first, mut last) = ([0.0; N], [0.0; N], [0.0; N], [0.0; N]);
        for lane in 0..N {
            let Cell { cdf, nm } = self.cell(numbers[lane]);
            ([begin[lane], end[lane]], [first[lane], last[lane]]) = (cdf, nm);
        }
        let mut lanes = Wavelengths { lambda_nm: Lanes::ZERO, pdf: Lanes::ZERO };
        for lane in 0..N {
            let cell = Cell { cdf: [begin[lane], end[lane]], nm: [first[lane], last[lane]] };
            (lanes.lambda_nm[lane], lanes.pdf[lane]) = cell.at(turned[lane]);
        }
        lanes
    }
}

impl<const N: usize> Wavelengths<N> {
    /// The CIE XYZ estimate that the spectral radiance estimate `radiance` stands for, normalised so that a constant
    /// spectrum 1 over the whole visible range has Y = 1: Σ_lanes L·(x̄, ȳ, z̄)/pdf / N / ∫ȳ.
    #[inline(always)]
    pub fn to_xyz<R: Real>(&self, radiance: Lanes<R, N>) -> [f64; 3] {
        let scale = N as f64 * cie_y_integral_nm();
        let bars = colour_matching_lanes(&self.lambda_nm.0);
        let weights = Lanes::from_fn(|lane| radiance[lane].to_f64() / (self.pdf[lane] * scale));
        bars.map(|bar| (weights * Lanes(bar)).sum())
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
            for u in [0.0, f64::MIN_POSITIVE, 0.5, 1.0 - f64::EPSILON / 2.0, f64::from(f32::ONE_MINUS_EPSILON)] {
                let (nm, pdf) = d.sample(u);
                assert!((range[0]..=range[1]).contains(&nm) && pdf > 0.0 && pdf.is_finite(), "{u}: {nm} {pdf}");
            }
        }
    }

    /// Hard case 34: a sky of constant radiance 1. The estimate is an average over the hero's number alone.
    #[test]
    fn constant_one_reads_one_in_y_and_the_equal_energy_white_in_x_and_z() {
        let d = WavelengthDistribution::new([360.0, 830.0]);
        let n = 1_000_000;
        let mut xyz = [0.0; 3];
        for i in 0..n {
            let w = d.sample_lanes::<4>((f64::from(i) + 0.5) / f64::from(n));
            let sample = w.to_xyz(Lanes::<f64, 4>::ONE);
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
                let xyz = w.to_xyz(Lanes::<f64, 8>::from_fn(|lane| spectrum(w.lambda_nm[lane]) / white));
                let rgb = etalon_optics::colour::rec709_from_xyz(xyz);
                for c in 0..3 {
                    sum[c] += rgb[c] / f64::from(n);
                    squares[c] += rgb[c] * rgb[c] / f64::from(n);
                }
            }
            (0..3).map(|c| squares[c] - sum[c] * sum[c]).sum::<f64>() / 3.0
        };
        let smooth = WavelengthDistribution::new([360.0, 830.0]);
        let near = WavelengthDistribution::blurred([360.0, 830.0], 1);
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
