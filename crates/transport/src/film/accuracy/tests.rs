//! The error of films whose noise is known.

use super::*;
use crate::film::TileSums;
use etalon_oracle::Uniform;
use etalon_oracle::statistics::Welford;

/// A film whose replicates hold one sample of Y each.
fn film(width: u32, replicates: u32, mut y: impl FnMut(u32) -> f64) -> Film {
    let mut film = Film::new(width, width, replicates);
    let rect = PixelRect { x0: 0, y0: 0, x1: width, y1: width };
    for (index, (x, y_px)) in rect.pixels().enumerate() {
        let sums: Vec<XyzSum> =
            (0..replicates).map(|_| XyzSum { xyz: [0.0, y(index as u32), 0.0], count: 1 }).collect();
        film.put(PixelRect { x0: x, y0: y_px, x1: x + 1, y1: y_px + 1 }, &TileSums { xyz: sums, ..Default::default() });
    }
    film
}

fn whole(film: &Film) -> PixelRect {
    PixelRect { x0: 0, y0: 0, x1: film.width(), y1: film.height() }
}

#[test]
fn the_variance_of_the_mean_is_the_textbook_one_and_knows_covariance() {
    let sums = [[1.0, 2.0], [2.0, 3.0], [3.0, 7.0]].map(|[x, y]| XyzSum { xyz: [2.0 * x, 2.0 * y, 0.0], count: 2 });
    let film = {
        let mut film = Film::new(1, 1, 3);
        film.put(PixelRect { x0: 0, y0: 0, x1: 1, y1: 1 }, &TileSums { xyz: sums.to_vec(), ..Default::default() });
        film
    };
    let pixel = film.pixel(0, 0);
    assert_eq!(pixel.xyz(), [2.0, 4.0, 0.0]);
    let (variance, freedom) = pixel.variance(|[x, y, _]| [x, y, x + y, x - y]).unwrap();
    // Sample variances 1 and 7, covariance 2.5; over three.
    let expected = [1.0, 7.0, 13.0, 3.0].map(|v| v / 3.0);
    assert!(variance.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{variance:?}");
    assert_eq!(freedom, 2);
}

#[test]
fn one_replicate_knows_nothing_and_two_are_enough() {
    assert_eq!(film(2, 1, |_| 1.0).error(PixelRect { x0: 0, y0: 0, x1: 2, y1: 2 }), None);
    let mut values = [1.0, 3.0].into_iter().cycle();
    let film = film(2, 2, |_| values.next().unwrap());
    let error = film.error(whole(&film)).unwrap();
    // Means 2, standard errors 1.
    assert_eq!((error.relative_rmse, error.mean_y, error.tail_index), (0.5, 2.0, None));
    assert_eq!(film.linear_rec709_error().len(), 4);
}

/// Normal and rare contributions of known variance: in 400 trials each, the interval of E must hold it in 95 % ± 4 %
/// (3.7 standard deviations of the binomial).
#[test]
fn the_interval_of_the_error_holds_the_truth_whatever_the_distribution() {
    let mut numbers = Uniform::new(5);
    for (name, rare) in [("normal", false), ("rare", true)] {
        let mut held = 0;
        let mut index = Welford::new();
        for _ in 0..400 {
            let film = film(32, 4, |_| {
                let u = numbers.number();
                if rare {
                    if u < 0.1 { 10.0 } else { 0.0 }
                } else {
                    1.0 + 0.3 * (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * PI * numbers.number()).cos()
                }
            });
            let error = film.error(whole(&film)).unwrap();
            let truth = if rare { (10.0_f64 - 1.0).sqrt() / 2.0 } else { 0.15 };
            held += u32::from(error.interval[0] <= truth && truth <= error.interval[1]);
            index.push(error.tail_index.unwrap());
        }
        assert!((365..=395).contains(&held), "{name}: {held} of 400");
        // 1024 pixels of normal replicates scatter by 0.01 about zero; one in ten is an outlier where it falls alone.
        let error = index.standard_error();
        assert!(
            if rare { index.mean() > 0.5 } else { index.mean().abs() < 5.0 * error },
            "{name}: {} ± {error}",
            index.mean()
        );
    }
}

/// One pixel of 64 carries nearly all of the error. Then 93 % of the intervals hold it; with the normal distribution 84 % would. 1600 trials tell a share to
/// 0.7 %: the bound of 90 % is four standard errors from both.
#[test]
fn the_interval_of_the_error_holds_the_truth_though_one_pixel_carries_it() {
    let mut numbers = Uniform::new(17);
    let deviation = |pixel: u32| -> f64 { if pixel == 0 { 0.5 } else { 0.02 } };
    let truth = ((0..64).map(|pixel| deviation(pixel).powi(2) / 4.0).sum::<f64>() / 64.0).sqrt();
    let held = (0..1600).filter(|_| {
        let film = film(8, 4, |pixel| {
            let radius = (-2.0 * (1.0 - numbers.number()).ln()).sqrt();
            1.0 + deviation(pixel) * radius * (2.0 * PI * numbers.number()).cos()
        });
        let [low, high] = film.error(whole(&film)).unwrap().interval;
        (low..=high).contains(&truth)
    });
    let held = held.count();
    assert!((1440..=1560).contains(&held), "{held} of 1600");
}

#[test]
fn the_noisiest_tile_is_found() {
    let mut numbers = Uniform::new(7);
    let film = film(64, 4, |pixel| {
        let (x, y) = (pixel % 64, pixel / 64);
        let noise = if (32..48).contains(&x) && (16..32).contains(&y) { 0.5 } else { 0.1 };
        1.0 + noise * (numbers.number() - 0.5)
    });
    let error = film.error(whole(&film)).unwrap();
    let noisiest = error.noisiest.unwrap();
    assert_eq!(noisiest.rect, PixelRect { x0: 32, y0: 16, x1: 48, y1: 32 });
    // 25 against 15 tiles of 1.
    assert!((noisiest.share - 25.0 / 40.0).abs() < 0.03, "{error:?}");
}

#[test]
fn a_picture_without_noise_has_no_error() {
    let film = film(8, 4, |_| 0.25);
    let error = film.error(whole(&film)).unwrap();
    assert_eq!((error.relative_rmse, error.interval), (0.0, [0.0, 0.0]));
    assert!(!error.is_heavy_tailed());
}

/// Nothing is certain of a picture without light, whatever the number of its replicates, and of one whose light is too faint or
/// too bright to be squared.
#[test]
fn the_error_of_a_picture_without_light_is_unknown() {
    for (replicates, y) in [(2, 0.0), (4, 0.0), (16, 0.0), (4, 1e-170), (4, 1e170)] {
        let film = film(8, replicates, |_| y);
        let error = film.error(whole(&film)).unwrap();
        assert_eq!((error.relative_rmse, error.interval), (f64::INFINITY, [0.0, f64::INFINITY]));
        assert_eq!((error.is_known(), error.found_light(), error.noisiest), (false, y > 0.0, None));
    }
    // A part of it that is black says nothing of that part, and takes nothing from what is known of the whole.
    let half = film(8, 4, |pixel| if pixel < 32 { 0.25 } else { 0.0 });
    assert_eq!(half.error(whole(&half)).unwrap().interval, [0.0, 0.0]);
    assert!(!half.error(PixelRect { x0: 0, y0: 4, x1: 8, y1: 8 }).unwrap().is_known());
}

/// One lit replicate of one pixel is an error, and no interval; sixteen are enough, and so is a lit pixel whose replicates
/// agree.
#[test]
fn what_few_replicates_found_by_chance_has_no_interval() {
    for replicates in [2, 3, 4, 8] {
        let lit = |count: u64| {
            let mut sums = 0;
            let film = film(8, replicates, |_| {
                sums += 1;
                // The first replicate of each pixel.
                f64::from(u8::from(sums % replicates == 1 && sums / replicates < count as u32))
            });
            film.error(whole(&film)).unwrap()
        };
        for count in [1, 3, FEWEST_LIT - 1] {
            let error = lit(count);
            // E² is 64/count pixels times Var/mean² = 1 of each of them.
            assert!((error.relative_rmse - (64.0 / count as f64).sqrt()).abs() < 1e-12, "{error:?}");
            assert!(error.is_known() && !error.has_interval() && error.interval[0] == 0.0, "{error:?}");
        }
        assert!(lit(FEWEST_LIT).has_interval());
    }
    let star = film(8, 4, |pixel| f64::from(u8::from(pixel == 9)));
    assert_eq!(star.error(whole(&star)).unwrap().interval, [0.0, 0.0]);
}

/// However rarely light is found, down to pictures of which most find none, the interval holds the true error in 95 % of all:
/// at least 365 of 400, as above.
#[test]
fn the_interval_holds_the_truth_however_rarely_light_is_found() {
    let mut numbers = Uniform::new(11);
    for lit in [0.05_f64, 0.1, 0.3, 1.0, 3.0, 10.0, 20.0, 40.0] {
        let probability = lit / (32.0 * 32.0 * 4.0);
        let truth = ((1.0 - probability) / (4.0 * probability)).sqrt();
        let held = (0..400).filter(|_| {
            let film = film(32, 4, |_| f64::from(u8::from(numbers.number() < probability)));
            let error = film.error(whole(&film)).unwrap();
            error.interval[0] <= truth && truth <= error.interval[1]
        });
        let held = held.count();
        assert!(held >= 365, "{lit}: {held} of 400");
    }
}

/// Of normal replicates one stands alone in 2.7 % of pixels; of those that have met one rare path each, in all.
#[test]
fn the_index_of_pixels_is_0_for_normal_replicates_and_1_for_single_finds() {
    let mut random = Uniform::new(3);
    let mut normal = || {
        let [u, v] = [random.number(), random.number()];
        (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * PI * v).cos()
    };
    let (side, replicates) = (200, 4);
    let film_of_normals = film(side, replicates, |_| 5.0 + normal());
    let error = film_of_normals.error(whole(&film_of_normals)).unwrap();
    // 40,000 pixels tell the index to 0.0008.
    assert!(error.pixel_tail_index.unwrap().abs() < 0.004 && !error.has_heavy_tailed_pixels(), "{error:?}");
    let mut sample = 0;
    let film_of_finds = film(side, replicates, |_| {
        sample += 1;
        if sample % 4 == 0 { 1.0 } else { 0.0 }
    });
    let error = film_of_finds.error(whole(&film_of_finds)).unwrap();
    assert_eq!(error.pixel_tail_index, Some(1.0));
    assert!(error.has_heavy_tailed_pixels());
    // A twentieth of the pixels are such: more than three standard errors above the bound.
    let mut sample = 0;
    let few = film(side, replicates, |pixel| {
        sample += 1;
        match pixel % 20 {
            0 => 10.0 * f64::from(u8::from(sample % 4 == 0)),
            _ => 5.0 + normal(),
        }
    });
    let error = few.error(whole(&few)).unwrap();
    assert!((error.pixel_tail_index.unwrap() - 0.05).abs() < 0.004 && error.has_heavy_tailed_pixels(), "{error:?}");
}
