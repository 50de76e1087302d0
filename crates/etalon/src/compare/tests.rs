//! Tests of the comparison by made-up pictures.

use super::each;
use super::scales::{ChannelTest, test};
use super::tiles::{Measured, rounding, welch};
use etalon_oracle::Uniform;

const WIDTH: usize = 64;

/// A picture's values and their standard errors.
type Channel = (Vec<f32>, Vec<f32>);

/// Standard normal numbers.
fn normal(numbers: &mut Uniform) -> f64 {
    let (u, v) = (1.0 - numbers.number(), numbers.number());
    (-2.0 * u.ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
}

/// A picture of 64 × 64 pixels, each with four replicates of the mean that `pixel` says. `replicate` draws one of mean 1.
fn picture(pixel: impl Fn(usize) -> f64, mut replicate: impl FnMut() -> f64) -> Channel {
    blocks(pixel, &mut replicate, 1)
}

/// The same, where all pixels of a block of `side` × `side` have the same noise.
fn blocks(pixel: impl Fn(usize) -> f64, replicate: &mut impl FnMut() -> f64, side: usize) -> Channel {
    let noise: Vec<[f64; 4]> = (0..WIDTH * WIDTH / (side * side)).map(|_| [0; 4].map(|_| replicate())).collect();
    (0..WIDTH * WIDTH)
        .map(|index| {
            let block = index / WIDTH / side * (WIDTH / side) + index % WIDTH / side;
            let own = noise[block].map(|replicate| pixel(index) * replicate);
            let mean = own.iter().sum::<f64>() / 4.0;
            let squares: f64 = own.iter().map(|x| (x - mean) * (x - mean)).sum();
            (mean as f32, (squares / 12.0).sqrt() as f32)
        })
        .unzip()
}

/// Two pictures around 1, the second with a bias in some of its pixels; their replicates are normally distributed with standard error `noise`
/// of the mean.
fn pair(seed: u64, noise: f64, bias: impl Fn(usize) -> f64) -> [Channel; 2] {
    let mut numbers = Uniform::new(seed);
    let mut replicate = || 1.0 + 2.0 * noise * normal(&mut numbers);
    [blocks(|_| 1.0, &mut replicate, 1), blocks(|pixel| 1.0 + bias(pixel), &mut replicate, 1)]
}

/// Distributions with tails, of mean 1: a mean of `samples` numbers.
#[derive(Clone, Copy)]
enum Tailed {
    /// e to the power of 1.5 normal numbers: a kurtosis of 10⁴.
    LogNormal,
    /// Half the light by one sample in fifty.
    Spikes,
}

impl Tailed {
    fn mean(self, numbers: &mut Uniform, samples: u32) -> f64 {
        let mut one = || match self {
            Self::LogNormal => (1.5 * normal(numbers) - 1.125).exp(),
            Self::Spikes if numbers.number() < 0.02 => 25.5,
            Self::Spikes => 0.5,
        };
        (0..samples).map(|_| one()).sum::<f64>() / f64::from(samples)
    }
}

/// Two pictures of the same thing, of light and dark parts, whose replicates have this many samples.
fn tailed_pair(seed: u64, tailed: Tailed, samples: [u32; 2]) -> [Channel; 2] {
    let mut numbers = Uniform::new(seed);
    let pixel = |pixel: usize| ((pixel % WIDTH) as f64 / 5.0).sin().exp();
    samples.map(|samples| picture(pixel, || tailed.mean(&mut numbers, samples)))
}

fn channel(pair: &[Channel; 2]) -> ChannelTest {
    channel_in_tiles(pair, 4, 1.0)
}

fn channel_in_tiles(pair: &[Channel; 2], side: usize, correlated: f64) -> ChannelTest {
    let mut channel = without_power(pair, side, correlated);
    let accepted_from = each(0.05, std::slice::from_ref(&channel));
    channel.set_power(accepted_from);
    channel
}

/// The same without the statement of power, which takes most of the time.
fn without_power(pair: &[Channel; 2], side: usize, correlated: f64) -> ChannelTest {
    let [a, b] = [0, 1].map(|i| Measured {
        values: &pair[i].0,
        errors: &pair[i].1,
        freedom: Some(3.0),
        correlated,
        rounding: rounding(false),
    });
    test("Y", &a, &b, WIDTH, side)
}

/// Whether the pictures are called different at this significance.
fn differ(channel: &ChannelTest, significance: f64) -> bool {
    channel.p() < each(significance, std::slice::from_ref(channel))
}

/// How many of some pairs are called different at 5 % and at 1 %.
fn alarms(pairs: u64, pair: impl Fn(u64) -> ChannelTest) -> [usize; 2] {
    let found: Vec<ChannelTest> = (0..pairs).map(pair).collect();
    [0.05, 0.01].map(|significance| found.iter().filter(|channel| differ(channel, significance)).count())
}

/// 400 pairs of equal pictures: 20 false alarms are expected at 5 %, and 4 at 1 %. Five standard deviations of the binomial are 22 and 10.
/// (Tests of the same tiles in several sizes depend on each other, so that somewhat fewer are to be expected.)
#[test]
fn false_alarms_are_as_many_as_stated() {
    let [five, one] = alarms(400, |seed| channel(&pair(seed, 0.1, |_| 0.0)));
    assert!((2..=42).contains(&five) && one <= 14, "{five} and {one} of 400");
}

/// The same for noise with tails, of which 4 × 4 pixels are few. Then there are fewer false alarms than stated. One of 60 pairs more than
/// stated would be 7 and 3 more of 400; the bounds are those of above.
#[test]
fn noise_with_tails_gives_no_more_false_alarms() {
    for (tailed, samples) in [(Tailed::LogNormal, [2, 3]), (Tailed::Spikes, [2, 2])] {
        let [five, one] = alarms(400, |seed| channel(&tailed_pair(7000 + seed, tailed, samples)));
        assert!(five <= 42 && one <= 14, "{five} and {one} of 400");
    }
}

/// Noise that is skewed in one picture and nearly absent in the other. Were small tiles tested all the same, most of such pairs would be
/// called different.
#[test]
fn tiles_whose_noise_is_skewed_are_left_to_larger_ones() {
    let [five, one] = alarms(100, |seed| {
        let channel = channel(&tailed_pair(9000 + seed, Tailed::Spikes, [1, 16]));
        assert!(channel.scales[0].skewed_tiles > 200, "{:?}", channel.scales[0]);
        channel
    });
    // Five and one are expected, five standard deviations of the binomial are 11 and 5.
    assert!(five <= 16 && one <= 6, "{five} and {one} of 100");
    // Equal noise is not skewed.
    assert_eq!(channel(&pair(1, 0.1, |_| 0.0)).scales.iter().map(|scale| scale.skewed_tiles).sum::<usize>(), 0);
}

/// 100 pairs at 5 %: 5 false alarms are expected, more than 16 once in 100,000 times. It sees that a single pixel was given five degrees
/// of freedom instead of three.
#[test]
fn false_alarms_are_as_many_as_stated_where_tiles_are_single_pixels() {
    for side in [1, 2] {
        let [alarms, _] = alarms(100, |seed| channel_in_tiles(&pair(3000 + seed, 0.1, |_| 0.0), side, 1.0));
        assert!(alarms <= 16, "{alarms} of 100 in tiles of {side}");
    }
}

/// Where all of a block's noise is common the bound on its error is reached: 400 pairs at 5 %, as above, for tiles of sixteen blocks and
/// of one. Told that pixels are independent, the test calls all of them different.
#[test]
fn false_alarms_are_as_many_as_stated_where_pixels_share_their_noise() {
    let pair = |seed| {
        let mut numbers = Uniform::new(5000 + seed);
        let mut replicate = || 1.0 + 0.2 * normal(&mut numbers);
        [0, 1].map(|_| blocks(|_| 1.0, &mut replicate, 4))
    };
    for side in [16, 4] {
        let [five, one] = alarms(400, |seed| channel_in_tiles(&pair(seed), side, 16.0));
        assert!((2..=42).contains(&five) && one <= 14, "{five} and {one} of 400 in tiles of {side}");
        let [_, alarms] = alarms(20, |seed| channel_in_tiles(&pair(seed), side, 1.0));
        assert!(alarms >= 19, "{alarms} of 20 in tiles of {side}");
    }
}

/// Squares of `side` pixels, alternately brighter and darker: the sum of a square of twice the side is as it was.
fn checkered(side: usize, part: f64) -> impl Fn(usize) -> f64 {
    move |pixel| if (pixel % WIDTH / side + pixel / WIDTH / side).is_multiple_of(2) { part } else { -part }
}

/// The difference of two tiles of 4 × 4 has a standard error of 0.1·√2/4 = 3.5 %, of 8 × 8 half of that.
#[test]
fn light_that_is_moved_within_a_larger_tile_is_found() {
    for side in [4, 8] {
        let found =
            (0..20).filter(|&seed| differ(&channel(&pair(100 + seed, 0.1, checkered(side, 0.05))), 1e-3)).count();
        assert_eq!(found, 20, "squares of {side}");
        // In tiles of 16 pixels nothing of it is to be seen.
        let coarse = (0..20)
            .filter(|&seed| differ(&channel_in_tiles(&pair(100 + seed, 0.1, checkered(side, 0.05)), 16, 1.0), 1e-3))
            .count();
        assert!(coarse <= 1, "squares of {side}");
    }
    // Where the noise has tails, too: the second picture has moved 20 % of its light, at a standard error of a pixel of 21 %.
    let moved = |seed: u64| {
        let mut numbers = Uniform::new(800 + seed);
        let mut replicate = || Tailed::LogNormal.mean(&mut numbers, 16);
        let change = checkered(4, 0.2);
        [blocks(|_| 1.0, &mut replicate, 1), blocks(|pixel| 1.0 + change(pixel), &mut replicate, 1)]
    };
    let found = (0..20).filter(|&seed| differ(&channel(&moved(seed)), 1e-3)).count();
    assert!(found >= 18, "{found} of 20");
}

/// A change as large as is said to be seen is found in nine of ten pictures: in 180 of 200, ± 4.2. The question that the statement is about
/// is asked alone.
#[test]
fn the_stated_power_is_the_real_one() {
    let without = channel(&pair(40, 0.1, |_| 0.0));
    let accepted_from = each(0.05, std::slice::from_ref(&without));
    for (size, side) in [(0, 4), (1, 8), (2, 16)] {
        let seen = without.scales[size].seen;
        let one = |pixel: usize| {
            let inside = pixel % WIDTH / side == 2 && pixel / WIDTH / side == 1;
            if inside { seen.in_one_tile.unwrap() } else { 0.0 }
        };
        let p_worst = |seed: u64| without_power(&pair(2000 + seed, 0.1, one), 4, 1.0).scales[size].p_worst;
        let found = (0..200).filter(|&seed| p_worst(seed) < accepted_from).count();
        assert!((159..=199).contains(&found), "{found} of 200 in one of {side}");
        let all = checkered(side, seen.in_all_tiles.unwrap());
        let p_spread = |seed: u64| without_power(&pair(2500 + seed, 0.1, &all), 4, 1.0).scales[size].p_spread.unwrap();
        let found = (0..200).filter(|&seed| p_spread(seed) < accepted_from).count();
        assert!((150..=200).contains(&found), "{found} of 200 in all of {side}");
    }
    let whole = without.scales[4].seen;
    // 0.1·√2/64 = 0.22 % times what the threshold and the power are in standard errors, 2.9 and 1.3.
    assert!(whole.in_all_tiles.is_none() && (0.008..0.011).contains(&whole.in_one_tile.unwrap()), "{whole:?}");
}

/// The p-values of tiles are uniform: five standard deviations of a count of 6400 at 10 % are 120.
#[test]
fn one_tile_in_ten_has_a_p_value_below_a_tenth() {
    let below = (0..400)
        .map(|seed| {
            let [a, b] = pair(1000 + seed, 0.1, |_| 0.0);
            let [a, b] = [&a, &b].map(|p| Measured {
                values: &p.0,
                errors: &p.1,
                freedom: Some(3.0),
                correlated: 1.0,
                rounding: rounding(false),
            });
            (0..16)
                .filter(|tile| {
                    let pixels: Vec<usize> = (0..256).map(|i| tile * 256 + i).collect();
                    welch(&a, &b, &pixels, [0; 4]).unwrap().p < 0.1
                })
                .count()
        })
        .sum::<usize>();
    assert!((520..=760).contains(&below), "{below} of 6400");
}

#[test]
fn a_bias_in_one_tile_is_found_there_and_a_small_one_everywhere_by_the_whole_picture() {
    // The difference of two tiles of 16 × 16 has a standard error of 0.1·√2/16 = 0.0088: 0.06 is 6.8 of them.
    let in_tile = |pixel: usize| if pixel % 64 / 16 == 2 && pixel / 64 / 16 == 1 { 0.06 } else { 0.0 };
    let found = channel(&pair(5, 0.1, in_tile));
    assert!(found.p_worst < 1e-6, "{found:?}");
    assert_eq!(found.worst.unwrap().crop, [32, 48, 16, 32]);
    // 1.5 standard errors in each of 16 tiles, six of the whole picture.
    let found = channel(&pair(6, 0.1, |_| 0.0133));
    assert_eq!((found.scales[4].side, found.scales[4].p_worst < 1e-5), (None, true), "{found:?}");
}

#[test]
fn rounding_to_f32_is_no_difference_and_unknown_errors_are_not_tested() {
    let (a, b) = (vec![0.1_f32; 256], vec![0.1_f32.next_up(); 256]);
    let exact = vec![0.0_f32; 256];
    let measured =
        |values, errors| Measured { values, errors, freedom: Some(3.0), correlated: 1.0, rounding: rounding(false) };
    assert_eq!(test("R", &measured(&a, &exact), &measured(&b, &exact), 16, 16).p(), 1.0);
    let far = vec![0.2_f32; 256];
    assert_eq!(test("R", &measured(&a, &exact), &measured(&far, &exact), 16, 16).p(), 0.0);
    let unknown = vec![f32::INFINITY; 256];
    let outcome = test("R", &measured(&a, &unknown), &measured(&far, &exact), 16, 16);
    assert_eq!((outcome.tiles, outcome.untested_tiles, outcome.p()), (0, 1, 1.0));
    // One pixel without an error leaves the other small tiles to be tested.
    let one: Vec<f32> = (0..256).map(|pixel| if pixel == 77 { f32::INFINITY } else { 0.0 }).collect();
    let outcome = test("R", &measured(&a, &one), &measured(&far, &exact), 16, 4);
    assert_eq!((outcome.tiles, outcome.untested_tiles, outcome.p()), (15, 1, 0.0));
}

/// Pictures without noise that two programs computed, and one that went through a file of 16-bit floats.
#[test]
fn what_rounding_explains_is_no_difference() {
    let exact = vec![0.0_f32; 256];
    let p = |a: f32, b: f32, halves: [bool; 2]| {
        let (a, b) = (vec![a; 256], vec![b; 256]);
        let [a, b] = [(&a, halves[0]), (&b, halves[1])].map(|(values, half)| Measured {
            values,
            errors: &exact,
            freedom: Some(3.0),
            correlated: 1.0,
            rounding: rounding(half),
        });
        test("R", &a, &b, 16, 16).p()
    };
    assert_eq!(p(0.300_001, 0.3, [false; 2]), 1.0, "a part in 300 000");
    assert_eq!(p(0.300_01, 0.3, [false; 2]), 0.0, "a part in 30 000");
    // The nearest 16-bit floats to 0.3 and to 0.3003.
    assert_eq!(p(0.300_048_83, 0.3, [true, false]), 1.0);
    assert_eq!(p(0.300_292_97, 0.3, [true, false]), 0.0);
    assert_eq!(p(0.300_048_83, 0.3, [false; 2]), 0.0, "as 32-bit floats they differ");
}

/// Whatever its error is said to be, also in both pictures alike.
#[test]
fn a_value_that_is_not_finite_differs_from_all_values() {
    let plain = vec![0.1_f32; 256];
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let with = (0..256).map(|pixel| if pixel == 77 { value } else { 0.1 }).collect::<Vec<_>>();
        for error in [0.0, 0.1, f32::INFINITY, f32::NAN] {
            let errors = vec![error; 256];
            let measured = |values| Measured {
                values,
                errors: &errors,
                freedom: Some(3.0),
                correlated: 1.0,
                rounding: rounding(false),
            };
            for (a, b) in [(&with, &plain), (&plain, &with), (&with, &with)] {
                let outcome = test("R", &measured(a), &measured(b), 16, 16);
                assert_eq!((outcome.untested_tiles, outcome.p()), (0, 0.0), "{value} ± {error}");
            }
        }
    }
}
