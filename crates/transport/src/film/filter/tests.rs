use super::*;

const MITCHELL: Filter = Filter::Mitchell { radius_px: 2.0, b: 1.0 / 3.0, c: 1.0 / 3.0 };
const CATMULL_ROM: Filter = Filter::Mitchell { radius_px: 1.0, b: 0.0, c: 0.5 };
const LANCZOS: Filter = Filter::Lanczos { lobes: 3 };

/// The weight of the offsets between two is the integral of the filter.
#[test]
fn as_many_offsets_are_drawn_as_the_filter_says() {
    let positive = [Filter::Box, Filter::Tent { radius_px: 1.5 }, Filter::Gaussian { sigma_px: 0.5 }];
    for filter in positive.into_iter().chain([MITCHELL, CATMULL_ROM, LANCZOS]) {
        let sampler = FilterSampler::new(&filter);
        let reach = FilterSampler::reach_px(&filter);
        let steps = 20_000;
        let width = 2.0 * reach / f64::from(steps);
        let at = |step: i32| -reach + (f64::from(step) + 0.5) * width;
        let mut drawn_below = 0.0;
        for step in 0..steps {
            drawn_below += sampler.value(at(step)) * width;
            if step % 1000 == 999 {
                let edge = at(step) + 0.5 * width;
                let numbers = (0..10_000).map(|i| (f64::from(i) + 0.5) / 1e4);
                let share = numbers.filter(|u| sampler.offset(*u) < edge).map(|u| sampler.weight(u)).sum::<f64>() / 1e4;
                // A ten thousandth of the offsets lies between two of those counted; a cell's end may lie within a step.
                assert!((drawn_below - share).abs() < 1e-3, "{filter:?} below {edge}: {drawn_below} is not {share}");
            }
        }
        assert_eq!(sampler.value(reach * 1.001), 0.0);
    }
}

/// Of a pixel at the edge of a film, and of one that is all of it, by the tent's own integrals.
#[test]
fn offsets_on_a_film_stay_on_it_and_are_drawn_as_their_density_says() {
    // ∫ of 1 − |x|/2 from 0 to x.
    let tent = |x: f64| x - 0.25 * x * x.abs();
    let sampler = FilterSampler::new(&Filter::Tent { radius_px: 2.0 });
    for (centre, size) in [(0.5_f64, 1.0_f64), (0.5, 9.0), (1.5, 9.0), (8.5, 9.0), (4.5, 9.0)] {
        let [low, high] = [(-centre).max(-2.0), (size - centre).min(2.0)];
        let n = 10_000;
        let drawn = |i: i32| sampler.offset_on_film((f64::from(i) + 0.5) / f64::from(n), centre, size);
        assert!((0..n).map(drawn).all(|offset| (low - 1e-12..=high + 1e-12).contains(&offset)));
        for place in [0.1, 0.4, 0.8] {
            let offset = low + place * (high - low);
            let exact = (tent(offset) - tent(low)) / (tent(high) - tent(low));
            let share = (0..n).filter(|i| drawn(*i) < offset).count() as f64 / f64::from(n);
            // A ten thousandth lies between two of those counted; the cells of the table change shares by less.
            assert!((share - exact).abs() < 2e-4, "{centre} of {size}, below {offset}: {share} is not {exact}");
            let height = 1.0 - 0.5 * offset.abs();
            let density = height / (tent(high) - tent(low));
            let found = sampler.value_on_film(offset, centre, size);
            // It is constant in a cell, which is 2/(512 h) wide where the tent is h high. Over half of that the tent changes by this part.
            let cell = 1.0 / (2.0 * CELLS as f64 * height * height);
            assert!(
                (found / density - 1.0).abs() < 1.1 * cell,
                "{centre} of {size}, at {offset}: {found} is not {density}"
            );
        }
    }
    assert!(sampler.offset_on_film(f64::ONE_MINUS_EPSILON, 4.5, 9.0) <= 2.0);
    assert_eq!(FilterSampler::Box.offset_on_film(0.25, 0.5, 4.0), -0.25);
}

/// Second moments against the filters' own: box 1/12, tent r²/6, Gaussian cut at 3σ: σ²·0.973335…. The table's cells
/// spread each moment by less than 1e-4.
#[test]
fn offsets_have_the_filters_variance_and_no_bias() {
    let n = 100_000;
    for (filter, variance) in [
        (Filter::Box, 1.0 / 12.0),
        (Filter::Tent { radius_px: 1.0 }, 1.0 / 6.0),
        (Filter::Tent { radius_px: 2.0 }, 4.0 / 6.0),
        (Filter::Gaussian { sigma_px: 0.5 }, 0.25 * 0.973_335_6),
        // (2 − 4c + 3b)/15 in units of half the radius, term by term: that of the cubic B-spline is 1/3.
        (MITCHELL, 1.0 / 9.0),
        (Filter::Mitchell { radius_px: 2.0, b: 1.0, c: 0.0 }, 1.0 / 3.0),
    ] {
        let sampler = FilterSampler::new(&filter);
        let drawn = (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n));
        let offsets: Vec<[f64; 2]> = drawn.map(|u| [sampler.offset(u), sampler.weight(u)]).collect();
        let sum = offsets.iter().map(|[_, weight]| weight).sum::<f64>() / f64::from(n);
        let mean = offsets.iter().map(|[x, weight]| weight * x).sum::<f64>() / f64::from(n);
        let second = offsets.iter().map(|[x, weight]| weight * x * x).sum::<f64>() / f64::from(n);
        assert!((sum - 1.0).abs() < 1e-4, "{filter:?}: {sum}");
        assert!(mean.abs() < 1e-6, "{filter:?}: {mean}");
        assert!((second / variance - 1.0).abs() < 1e-3, "{filter:?}: {second} is not {variance}");
    }
}

/// The values of a table are those of the filter over its integral, with its sign. They are constant in a cell.
#[test]
fn values_are_those_of_the_filter() {
    for (filter, f) in [
        (MITCHELL, Box::new(|x| mitchell(x, 1.0 / 3.0, 1.0 / 3.0)) as Box<dyn Fn(f64) -> f64>),
        (CATMULL_ROM, Box::new(|x| 2.0 * mitchell(2.0 * x, 0.0, 0.5))),
        // Its integral, by Gauss-Legendre quadrature.
        (LANCZOS, Box::new(|x| lanczos(x, 3.0) / 0.997_055_332_9)),
    ] {
        let (sampler, reach) = (FilterSampler::new(&filter), FilterSampler::reach_px(&filter));
        for i in 1..100 {
            let x = f64::from(i) / 100.0 * reach;
            let (exact, found) = (f(x), sampler.value(x));
            // At a zero of slope m the first cell ends at h with m h²/2 = M/8192, M the integral of the magnitude, and its value is m h/2: 0.012
            // where m is 2 and M 1.17.
            assert!((exact - found).abs() < 0.0125, "{filter:?} at {x}: {found} is not {exact}");
            assert!((sampler.value(-x) - found).abs() < 0.025, "{filter:?} at −{x}");
        }
    }
}

/// What is left of a filter on a film is all of it: its weights have the mean one, and its values the integral one.
#[test]
fn a_filter_with_negative_parts_is_whole_on_every_film() {
    for filter in [MITCHELL, CATMULL_ROM, LANCZOS] {
        let (sampler, reach) = (FilterSampler::new(&filter), FilterSampler::reach_px(&filter));
        for (centre, size) in [(0.5_f64, 1.0_f64), (0.5, 9.0), (1.5, 9.0), (2.5, 3.0), (4.5, 9.0)] {
            let n = 100_000;
            let numbers = || (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n));
            let mean = numbers().map(|u| sampler.weight_on_film(u, centre, size)).sum::<f64>() / f64::from(n);
            assert!((mean - 1.0).abs() < 1e-4, "{filter:?}, {centre} of {size}: weights {mean}");
            let [low, high] = [(-centre).max(-reach), (size - centre).min(reach)];
            let value = |u: f64| sampler.value_on_film(low + u * (high - low), centre, size);
            let integral = numbers().map(value).sum::<f64>() * (high - low) / f64::from(n);
            assert!((integral - 1.0).abs() < 1e-3, "{filter:?}, {centre} of {size}: integral {integral}");
            // Weight by weight, what is drawn is what is stated.
            let at = |u: f64| low + u * (high - low);
            let below = numbers().filter(|u| at(*u) < 0.3).map(value).sum::<f64>() * (high - low) / f64::from(n);
            let drawn = numbers().filter(|u| sampler.offset_on_film(*u, centre, size) < 0.3);
            let drawn = drawn.map(|u| sampler.weight_on_film(u, centre, size)).sum::<f64>() / f64::from(n);
            assert!((below - drawn).abs() < 1e-3, "{filter:?}, {centre} of {size}: {drawn} is not {below}");
        }
    }
}
