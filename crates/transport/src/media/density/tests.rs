//! Columns against sums over many points, and the way back from a column to its place.

use super::*;
use etalon_scene::{DensityGrid, ExponentialDensity, Transform};

fn way(origin: [f64; 3], toward: [f64; 3], length: f64) -> Way {
    Way { origin: Vec3::from_array(origin), direction: Vec3::from_array(toward).normalized(), length, time: 0.0 }
}

/// The density at a point, by a formula of its own.
fn density_of(density: &etalon_scene::MediumDensity, p: Vec3<f64>) -> f64 {
    match density {
        etalon_scene::MediumDensity::Uniform => 1.0,
        etalon_scene::MediumDensity::Exponential(one) => {
            let height = (p - Vec3::from_array(one.base_m)).dot(Vec3::from_array(one.up));
            (-height / one.scale_height_m).exp()
        }
        etalon_scene::MediumDensity::Grid(grid) => {
            let cells = grid.cells;
            let p = p.to_array();
            let mut at = [0.0; 3];
            for k in 0..3 {
                let [low, high] = [grid.box_m[0][k], grid.box_m[1][k]];
                if p[k] < low || p[k] > high {
                    return 0.0;
                }
                at[k] = ((p[k] - low) / (high - low) * f64::from(cells[k]) - 0.5).clamp(0.0, f64::from(cells[k] - 1));
            }
            let mut sum = 0.0;
            for corner in 0..8_u32 {
                let (mut weight, mut place, mut stride) = (1.0, 0, 1);
                for k in 0..3 {
                    let low = at[k].floor().min(f64::from(cells[k].saturating_sub(2)));
                    let share = at[k] - low;
                    let up = corner >> k & 1 == 1;
                    weight *= if up { share } else { 1.0 - share };
                    let index = (low as usize + usize::from(up)).min(cells[k] as usize - 1);
                    place += index * stride;
                    stride *= cells[k] as usize;
                }
                sum += weight * f64::from(grid.values[place]);
            }
            sum
        }
    }
}

fn grid(cells: [u32; 3], holes: bool) -> etalon_scene::MediumDensity {
    let count = cells.iter().product::<u32>();
    // Numbers without a pattern; where there are holes, most of the far half is empty.
    let value = |i: u32| match holes && i % cells[0] > 2 && i % 97 != 5 {
        true => 0.0,
        false => f64::from((i * 7919 + i * i * 31) % 101) as f32 / 50.0,
    };
    etalon_scene::MediumDensity::Grid(DensityGrid {
        cells,
        values: (0..count).map(value).collect(),
        box_m: [[-1.0, 0.0, -0.5], [1.0, 1.5, 0.75]],
        transform: Transform::IDENTITY,
    })
}

fn all() -> Vec<etalon_scene::MediumDensity> {
    let up = Vec3::new(1.0, 2.0, 0.5).normalized().to_array();
    vec![
        etalon_scene::MediumDensity::Uniform,
        etalon_scene::MediumDensity::Exponential(ExponentialDensity {
            base_m: [0.1, 0.2, 0.3],
            up,
            scale_height_m: 0.4,
        }),
        grid([1, 1, 1], false),
        grid([2, 3, 4], false),
        grid([20, 17, 9], false),
        grid([40, 10, 12], true),
    ]
}

fn ways() -> Vec<Way> {
    let mut ways = Vec::new();
    for i in 0..60 {
        let number = |k: i32| f64::from((i * 37 + k * 61 + i * i * 11) % 41) / 20.0 - 1.0;
        ways.push(way(
            [number(1) * 2.0, number(2) * 2.0, number(3) * 2.0],
            [number(4), number(5), number(6) + 0.01],
            3.0,
        ));
    }
    // Along axes, on the faces between cells, from within.
    ways.push(way([-3.0, 0.75, 0.125], [1.0, 0.0, 0.0], 10.0));
    ways.push(way([0.0, 0.75, 0.125], [0.0, -1.0, 0.0], 0.3));
    ways.push(way([0.5, 5.0, 0.0], [0.0, -1.0, 0.0], 9.0));
    ways.push(way([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 0.6));
    ways
}

#[test]
fn columns_are_sums_over_many_points() {
    for density in all() {
        let prepared = MediumDensity::new(&density, &SceneFrame::WORLD);
        for way in ways() {
            let n = 20_000;
            let step = way.length / f64::from(n);
            let at = |i: i32| way.at((f64::from(i) + 0.5) * step);
            let sum: f64 = (0..n).map(|i| density_of(&density, at(i))).sum::<f64>() * step;
            let column = prepared.column(&way);
            // The midpoint rule errs by a step at each face of the box, and by 1e-8 elsewhere.
            assert!((column - sum).abs() < 8e-4 + 1e-6 * sum, "{way:?}: {column} is not {sum}");
        }
    }
}

#[test]
fn densities_at_places_are_those_of_the_formula() {
    for density in all() {
        let prepared = MediumDensity::new(&density, &SceneFrame::WORLD);
        for way in ways() {
            for i in 0..20 {
                let place = way.at(way.length * (f64::from(i) + 0.5) / 20.0);
                let (found, known) = (prepared.at(place), density_of(&density, place));
                assert!((found - known).abs() <= 1e-12 * known.max(1.0), "{place:?}: {found} is not {known}");
            }
        }
    }
}

#[test]
fn the_place_of_a_column_has_that_column() {
    for density in all() {
        let prepared = MediumDensity::new(&density, &SceneFrame::WORLD);
        for way in ways() {
            let whole = prepared.column(&way);
            for share in [1e-9, 0.1, 0.37, 0.999] {
                if whole == 0.0 {
                    continue;
                }
                let distance = prepared.distance(&way, share * whole);
                assert!((0.0..=way.length).contains(&distance), "{way:?}: {distance}");
                let found = prepared.column(&Way { length: distance, ..way });
                assert!((found - share * whole).abs() <= 1e-12 * whole, "{way:?}: {found} is not {share} of {whole}");
            }
        }
    }
}

#[test]
fn an_atmosphere_is_known_to_its_end() {
    let density = ExponentialDensity { base_m: [0.0; 3], up: [0.0, 1.0, 0.0], scale_height_m: 8.0 };
    let air = MediumDensity::new(&etalon_scene::MediumDensity::Exponential(density), &SceneFrame::WORLD);
    let up = way([0.0; 3], [0.0, 1.0, 0.0], f64::INFINITY);
    assert_eq!(air.column(&up), 8.0);
    assert!((air.column(&way([0.0; 3], [1.0, 1.0, 0.0], f64::INFINITY)) / 8.0 - 2.0_f64.sqrt()).abs() < 1e-15);
    // Level ways are the limit of slanting ones.
    let level = air.column(&way([0.0; 3], [1.0, 0.0, 0.0], 100.0));
    assert!((air.column(&way([0.0; 3], [1.0, 1e-9, 0.0], 100.0)) / level - 1.0).abs() < 1e-8);
    assert_eq!((level, air.column(&way([0.0; 3], [1.0, 0.0, 0.0], f64::INFINITY))), (100.0, f64::INFINITY));
    assert_eq!(air.column(&way([0.0; 3], [0.0, -1.0, 0.0], f64::INFINITY)), f64::INFINITY);
    // From where there is nothing, down to the ground: 8 m of column are reached there.
    let down = way([0.0, 1e4, 0.0], [0.0, -1.0, 0.0], 1e5);
    assert!((air.distance(&down, 8.0) - 1e4).abs() < 1e-8);
    assert!((air.distance(&up, 4.0) - 8.0 * 2.0_f64.ln()).abs() < 1e-14);
}

#[test]
fn a_grid_lies_where_its_transform_puts_it() {
    let etalon_scene::MediumDensity::Grid(plain) = grid([20, 17, 9], false) else { unreachable!("it is a grid") };
    // Twice as large, turned by 90° about z, and moved.
    let linear = [[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
    let placed = DensityGrid { transform: Transform { linear, translation_m: [5.0, 6.0, 7.0] }, ..plain.clone() };
    let [plain, placed] =
        [plain, placed].map(|grid| MediumDensity::new(&etalon_scene::MediumDensity::Grid(grid), &SceneFrame::WORLD));
    let there = |[x, y, z]: [f64; 3]| [5.0 - 2.0 * y, 6.0 + 2.0 * x, 7.0 + 2.0 * z];
    let [a, b] = [[-1.2, 0.1, -0.3], [0.9, 1.4, 0.7]].map(Vec3::from_array);
    let length = (b - a).length();
    let own = plain.column(&way(a.to_array(), (b - a).to_array(), length));
    let [a, b] = [a, b].map(|p| Vec3::from_array(there(p.to_array())));
    let moved = placed.column(&way(a.to_array(), (b - a).to_array(), 2.0 * length));
    assert!((moved / own - 2.0).abs() < 1e-12, "{moved} is not twice {own}");
}
