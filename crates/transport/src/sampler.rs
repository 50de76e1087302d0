//! Random numbers: each is a pure function of (seed, pixel, sample, set), so any path can be replayed alone.
//!
//! Numbers come in sets of four. A path owns two sets for the camera and [`SETS_PER_VERTEX`] for each vertex, whether it
//! uses them or not: an effect that is not called for leaves every other effect's numbers as they are.
//!
//! Sample k of a pixel is number k div R of replicate k mod R. The R replicates are independent, so that the scatter of
//! their means is the error of the whole; and the first samples of a pixel are the same however many follow.

use etalon_scene::SamplerKind;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use sobol_burley::parts::{
    hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev, sobol_int4_rev, u32_to_f32_norm,
};
use std::sync::LazyLock;

/// Sets drawn by the camera: (film x, film y, lens 1, lens 2), (wavelength, time, –, –).
pub const CAMERA_SETS: u32 = 2;
/// Sets that each path vertex owns: (lobe, BSDF 1, BSDF 2, roulette), (light choice, light 1, light 2, mask).
pub const SETS_PER_VERTEX: u32 = 2;

/// The first of the sets for surfaces that fluoresce, one for each vertex, beyond those of any path: (choice, wavelength, part, –).
const FLUORESCENCE_SETS: u32 = 1 << 24;

/// The first of the sets for specular connections, one for each vertex, beyond those: (seed 1, seed 2, kind of seed, light). Numbers for
/// places in beams behind glass follow in the same way, from the largest number of vertices on.
const CONNECTION_SETS: u32 = 1 << 25;

/// Longest Owen-scrambled Sobol point set of the library; further samples come from independent sets.
pub const SOBOL_POINTS: u32 = 1 << 16;

/// The numbers of the camera's first set by what they are for: the point of the film and the point of the lens. They are numbers of one sample, or
/// rows of numbers of several.
#[inline(always)]
pub(crate) fn film_and_lens<T: Copy>([film_x, film_y, lens_1, lens_2]: [T; 4]) -> ([T; 2], [T; 2]) {
    ([film_x, film_y], [lens_1, lens_2])
}

/// The numbers of the camera's second set by what they are for.
#[inline(always)]
pub(crate) fn wavelength_and_time<T: Copy>([wavelength, time, ..]: [T; 4]) -> (T, T) {
    (wavelength, time)
}

/// The numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    kind: SamplerKind,
    pixel_seed: u64,
    /// Number of the sample, counted over all replicates.
    sample: u32,
    /// Number of the sample within its replicate.
    index: u32,
    /// Number of the replicate.
    replicate: u32,
    sobol: &'static SobolTable,
}

impl Sampler {
    /// The numbers of sample number `sample` of pixel number `pixel` under `seed`, the samples being dealt in turn to
    /// `replicates` independent sequences.
    pub fn new(kind: SamplerKind, seed: u64, pixel: u64, sample: u32, replicates: u32) -> Self {
        let pixel_seed = mix(mix(seed) ^ pixel);
        let (index, replicate) = (sample / replicates, sample % replicates);
        Self { kind, pixel_seed, sample, index, replicate, sobol: &SOBOL }
    }

    /// The number of the Sobol point set: fewer than 2⁶ replicates of fewer than 2¹⁶ point sets each.
    #[inline(always)]
    fn points(&self) -> u32 {
        ((self.index / SOBOL_POINTS) << 6) | self.replicate
    }

    /// The four numbers of set `set`, each in [0, 1).
    pub fn set(&self, set: u32) -> [f64; 4] {
        match self.kind {
            SamplerKind::Sobol => {
                let scramble = scramble(self.pixel_seed, set, self.points());
                sobol_4d(self.sobol, self.index % SOBOL_POINTS, scramble).map(f64::from)
            }
            SamplerKind::Independent => {
                let stream = mix(self.pixel_seed ^ (u64::from(set) << 32 | u64::from(self.sample)));
                let mut generator = Xoshiro256PlusPlus::seed_from_u64(stream);
                std::array::from_fn(|_| unit_interval(generator.next_u64()))
            }
        }
    }

    /// The sets of path vertex `vertex`, the first being number 0: (choice, point 1, point 2, decision).
    pub fn vertex_set(&self, vertex: u32, set: u32) -> [f64; 4] {
        // The first two dimensions of the sequence are the best stratified together, so they are for the point.
        let [point_1, point_2, choice, decision] = self.set(CAMERA_SETS + vertex * SETS_PER_VERTEX + set);
        [choice, point_1, point_2, decision]
    }

    /// The numbers of vertex `vertex` where its surface fluoresces: (choice, wavelength, part, –).
    pub fn fluorescence_set(&self, vertex: u32) -> [f64; 4] {
        self.set(FLUORESCENCE_SETS + vertex)
    }

    /// The first numbers of the specular connection of vertex `vertex`: (light, kind of seed, seed 1, seed 2).
    pub fn connection_set(&self, vertex: u32) -> [f64; 4] {
        let [seed_1, seed_2, kind, light] = self.set(CONNECTION_SETS + vertex);
        [light, kind, seed_1, seed_2]
    }

    /// The further numbers of that connection, of which nobody knows beforehand how many there will be.
    pub fn connection_numbers(&self, vertex: u32) -> NumberStream {
        NumberStream(mix(self.pixel_seed ^ (u64::from(CONNECTION_SETS + vertex) << 32 | u64::from(self.sample))))
    }
}

/// Sets of independent numbers, each found by its own number.
#[derive(Clone, Copy, Debug, Default)]
pub struct NumberStream(u64);

impl NumberStream {
    /// Set number `number`, each of its numbers in [0, 1).
    pub fn set(&self, number: u64) -> [f64; 4] {
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(mix(self.0 ^ mix(number)));
        std::array::from_fn(|_| unit_interval(generator.next_u64()))
    }
}

/// The scramble of a set: the high half of a 64-bit hash. Sets and replicates are independent scrambles of the same points
/// (padding; Burley 2020, *Practical Hash-based Owen Scrambling*, §5).
#[inline(always)]
fn scramble(pixel_seed: u64, set: u32, points: u32) -> u32 {
    (mix(pixel_seed ^ (u64::from(set) << 32 | u64::from(points))) >> 32) as u32
}

/// Which of the four numbers of a set.
pub(crate) type Wanted = [bool; 4];

/// What the numbers of `W` samples depend on, beside the set.
#[derive(Clone, Debug)]
pub(crate) struct Samplers<const W: usize> {
    kind: SamplerKind,
    samplers: [Sampler; W],
    pixel_seed: [u64; W],
    points: [u32; W],
    index: [u32; W],
}

impl<const W: usize> Samplers<W> {
    /// All the same.
    pub(crate) fn new(sampler: Sampler) -> Self {
        let mut samplers =
            Self { kind: sampler.kind, samplers: [sampler; W], pixel_seed: [0; W], points: [0; W], index: [0; W] };
        (0..W).for_each(|lane| samplers.put(lane, sampler));
        samplers
    }

    /// Lane number `lane` becomes that of another sample, of the same kind of sampler.
    #[inline]
    pub(crate) fn put(&mut self, lane: usize, sampler: Sampler) {
        self.samplers[lane] = sampler;
        self.pixel_seed[lane] = sampler.pixel_seed;
        self.points[lane] = sampler.points();
        self.index[lane] = sampler.index % SOBOL_POINTS;
    }

    /// One of them.
    #[inline]
    pub(crate) fn lane(&self, lane: usize) -> &Sampler {
        &self.samplers[lane]
    }

    /// [`Sampler::set`] of each, lane `i` of set `sets[i]`: the same bits, of the numbers in `wanted`; others are left as they are.
    #[inline(always)]
    pub(crate) fn sets(&self, sets: &[u32; W], wanted: Wanted, numbers: &mut [[f64; W]; 4]) {
        match self.kind {
            SamplerKind::Sobol => self.sobol(sets, wanted, numbers),
            SamplerKind::Independent => {
                for lane in 0..W {
                    let set = self.samplers[lane].set(sets[lane]);
                    (0..4).for_each(|dimension| numbers[dimension][lane] = set[dimension]);
                }
            }
        }
    }

    /// One loop for each step, so that each is vectorised.
    #[inline(always)]
    fn sobol(&self, sets: &[u32; W], wanted: Wanted, numbers: &mut [[f64; W]; 4]) {
        let SobolTable([high, low]) = self.samplers[0].sobol;
        let (mut seeds, mut indices) = ([0; W], [0; W]);
        for lane in 0..W {
            seeds[lane] = scramble(self.pixel_seed[lane], sets[lane], self.points[lane]);
        }
        for lane in 0..W {
            indices[lane] = scrambled_index(self.index[lane], seeds[lane]);
            seeds[lane] = seeds[lane].wrapping_mul(SEED_FACTOR);
        }
        for dimension in 0..4 {
            if !wanted[dimension] {
                continue;
            }
            for lane in 0..W {
                let index = indices[lane];
                let point = high[(index >> 24) as usize][dimension] ^ low[(index >> 16 & 0xff) as usize][dimension];
                let scrambled = owen_scramble_rev(point, hash(seeds[lane] ^ OF_DIMENSION[dimension]));
                numbers[dimension][lane] = f64::from(u32_to_f32_norm(scrambled.reverse_bits()));
            }
        }
    }
}

/// The first four dimensions of the Sobol sequence, bits reversed, of all numbers with nothing but a high or a low byte: the
/// sequence is linear in the bits of the index, so the point of any number is two of these combined.
#[derive(Debug)]
struct SobolTable([[[u32; 4]; 256]; 2]);

static SOBOL: LazyLock<SobolTable> = LazyLock::new(|| {
    let point = |reversed_index: u32| sobol_int4_rev(reversed_index, 0).into();
    SobolTable([24, 16].map(|shift| std::array::from_fn(|byte| point((byte as u32) << shift))))
});

/// What the library makes the scrambles of the four dimensions of.
const OF_DIMENSION: [u32; 4] = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];
/// The same, of all of them.
const SEED_FACTOR: u32 = 0x9c8f_2d3b;

/// The index of a point as the library shuffles it, bits reversed.
#[inline(always)]
fn scrambled_index(index: u32, seed: u32) -> u32 {
    owen_scramble_rev(index.reverse_bits(), hash(seed ^ 0x79c6_8e4a))
}

/// [`sobol_burley::sample_4d`] of the first four dimensions, bit for bit, in half the instructions.
#[inline]
fn sobol_4d(SobolTable([high, low]): &SobolTable, index: u32, seed: u32) -> [f32; 4] {
    let index = scrambled_index(index, seed);
    let (high, low) = (high[(index >> 24) as usize], low[(index >> 16 & 0xff) as usize]);
    let point: [u32; 4] = std::array::from_fn(|dimension| high[dimension] ^ low[dimension]);
    let seed = seed.wrapping_mul(SEED_FACTOR);
    let scramble = OF_DIMENSION.map(|of_dimension| seed ^ of_dimension);
    owen_scramble_int4_rev(point.into(), hash_int4(scramble.into())).reverse_bits().to_f32_norm()
}

/// Maps 64 random bits to [0, 1), cutting (not rounding) to 53 bits so that 1 never occurs.
fn unit_interval(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

/// A bijective mixer of 64 bits: the finaliser of SplitMix64 (Steele, Lea & Flood 2014) after its increment.
#[inline(always)]
pub fn mix(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_in_the_half_open_unit_interval_and_repeatable() {
        for kind in [SamplerKind::Sobol, SamplerKind::Independent] {
            for sample in (0..200_000).step_by(997) {
                let sampler = Sampler::new(kind, 7, 12, sample, 4);
                let u = sampler.set(3);
                assert_eq!(u, sampler.set(3));
                assert!(u.iter().all(|u| (0.0..1.0).contains(u)));
            }
        }
        assert!(unit_interval(u64::MAX) < 1.0);
    }

    /// Correlation of any two of (set, pixel, sample, seed) streams: |r|·√n is standard normal; 5 is passed with
    /// probability 1 − 6e-7 a pair; a correlation of 0.05 would be seen.
    #[test]
    fn streams_are_uncorrelated() {
        let n = 16_384;
        let stream = |kind, seed, pixel, set, component: usize| -> Vec<f64> {
            (0..n).map(|s| Sampler::new(kind, seed, pixel, s, 1).set(set)[component] - 0.5).collect()
        };
        for kind in [SamplerKind::Sobol, SamplerKind::Independent] {
            let base = stream(kind, 1, 5, 2, 0);
            for other in
                [stream(kind, 1, 5, 3, 0), stream(kind, 1, 6, 2, 0), stream(kind, 2, 5, 2, 0), stream(kind, 1, 5, 2, 1)]
            {
                let r: f64 = base.iter().zip(&other).map(|(a, b)| a * b).sum::<f64>() * 12.0 / f64::from(n);
                assert!((r * f64::from(n).sqrt()).abs() < 5.0, "{kind:?}: correlation {r}");
            }
        }
    }

    #[test]
    fn tabulated_points_are_those_of_the_library_bit_for_bit() {
        for index in (0..SOBOL_POINTS).step_by(7).chain([SOBOL_POINTS - 1]) {
            let seed = mix(u64::from(index)) as u32;
            assert_eq!(sobol_4d(&SOBOL, index, seed), sobol_burley::sample_4d(index, 0, seed), "{index}, {seed}");
        }
    }

    #[test]
    fn sobol_points_are_stratified_on_the_film_and_where_a_vertex_draws_a_direction() {
        // 256 points of a (0, 8, 2)-net in base 2 put one into each of 16 × 16 cells of the first two dimensions.
        let sampler = |s| Sampler::new(SamplerKind::Sobol, 3, 9, s, 1);
        let film = |s| -> [f64; 4] { sampler(s).set(0) };
        let vertex = |s| -> [f64; 4] { sampler(s).vertex_set(1, 0) };
        let stratified = |pair: &dyn Fn(u32) -> [f64; 2]| {
            let mut cells = [0; 256];
            for s in 0..256 {
                let [x, y] = pair(s);
                cells[(x * 16.0) as usize * 16 + (y * 16.0) as usize] += 1;
            }
            cells.iter().all(|&c| c == 1)
        };
        assert!(stratified(&|s| [film(s)[0], film(s)[1]]));
        assert!(stratified(&|s| [vertex(s)[1], vertex(s)[2]]));
        // What the test would say of numbers that are not.
        assert!(!stratified(&|s| [film(s)[0], vertex(s)[1]]));
    }
}
