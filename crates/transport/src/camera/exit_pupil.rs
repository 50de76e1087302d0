//! Where points of the film see the stop of a lens, tabulated by their distance from the axis.
//!
//! Points are drawn evenly within a rectangle that holds the image of the stop, on the plane of the last surface that is next to the film.
//! Kolb et al. (1995) draw on a disk that holds all such images, pbrt-v4 (Pharr, Jakob & Humphreys 2023, section 5.4) on rectangles
//! for rings of the film. Ours change evenly within a ring, and hold the image of the stop alone: other apertures block rays, which then carry
//! nothing. A rectangle that is too large costs samples and changes no mean; one too small would lose light, so each is found with a margin.

use etalon_optics::Vec3;

/// Rings of the film.
const RINGS: usize = 32;
/// Cells of a search, along and across the meridian. Half of the pupil is searched: the other is its mirror image.
const CELLS: [usize; 2] = [24, 12];
/// Most searches, each in what the one before has left over. One that finds a pupil shrinks the field by a factor of about ten.
const MOST_SEARCHES: usize = 24;

/// A rectangle on the plane: from `low` to `high` along the meridian of the film's point, and as wide on both sides of it.
#[derive(Clone, Copy, Debug)]
struct Window {
    low_m: f64,
    high_m: f64,
    half_width_m: f64,
}

impl Window {
    const NOTHING: Self = Self { low_m: 0.0, high_m: 0.0, half_width_m: 0.0 };

    /// Between this one and another.
    fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + (b - a) * share;
        Self {
            low_m: between(self.low_m, other.low_m),
            high_m: between(self.high_m, other.high_m),
            half_width_m: between(self.half_width_m, other.half_width_m),
        }
    }

    /// By how much it must grow on its sides to hold another.
    fn lacks(&self, other: &Self) -> [f64; 3] {
        [self.low_m - other.low_m, other.high_m - self.high_m, other.half_width_m - self.half_width_m]
            .map(|m| m.max(0.0))
    }

    fn grown(&self, [low_m, high_m, half_width_m]: [f64; 3]) -> Self {
        Self { low_m: self.low_m - low_m, high_m: self.high_m + high_m, half_width_m: self.half_width_m + half_width_m }
    }

    fn joined(&self, other: &Self) -> Self {
        self.grown(self.lacks(other))
    }
}

/// See the module.
#[derive(Debug)]
pub(super) struct ExitPupil {
    plane_m: f64,
    /// Rings of the film in a metre.
    rings_per_m: f64,
    /// At the inner and the outer edge of each ring.
    rings: Vec<[Window; 2]>,
}

/// The end of a lens toward the film, in metres.
pub(super) struct RearEnd<F> {
    /// The z of the two planes between which the last surface lies.
    pub planes_m: [f64; 2],
    /// Radius of its aperture, and of the stop.
    pub radius_m: f64,
    pub stop_m: f64,
    /// Where a ray from a point of the film along a unit vector, at a wavelength in nm, meets the stop, whatever apertures it passes on the
    /// way: x and y.
    pub at_stop: F,
}

/// A point to aim at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aimed {
    pub point_m: Vec3<f64>,
    /// Over what area it was drawn.
    pub area_m2: f64,
}

impl ExitPupil {
    pub(super) const NOWHERE: Self = Self { plane_m: 0.0, rings_per_m: 0.0, rings: Vec::new() };

    /// Of a film whose points are at most `most_m` from the axis, for light of some wavelengths.
    pub(super) fn new<F>(lens: &RearEnd<F>, most_m: f64, wavelengths_nm: &[f64]) -> Self
    where
        F: Fn(Vec3<f64>, Vec3<f64>, f64) -> Option<[f64; 2]>,
    {
        // Edges and middles of the rings.
        let at = |half: usize| {
            let film_m = most_m * half as f64 / (2 * RINGS) as f64;
            let found = wavelengths_nm.iter().filter_map(|&nm| find(lens, [film_m, most_m], nm));
            found.reduce(|a, b| a.joined(&b))
        };
        let windows: Vec<Option<Window>> = (0..=2 * RINGS).map(at).collect();
        let ring = |i: usize| match [windows[2 * i], windows[2 * i + 1], windows[2 * i + 2]] {
            [Some(inner), Some(middle), Some(outer)] => {
                // Edges curve with the radius. Between three points of a parabola the line errs most at the middle one; twice that for
                // what else they do.
                let lacks = inner.towards(&outer, 0.5).lacks(&middle).map(|m| 2.0 * m);
                [inner.grown(lacks), outer.grown(lacks)]
            }
            // Where the stop is not seen from all of the ring, all that is seen of it from there.
            some => {
                let joined = some.into_iter().flatten().reduce(|a, b| a.joined(&b)).unwrap_or(Window::NOTHING);
                [joined; 2]
            }
        };
        let [plane_m, _] = lens.planes_m;
        Self { plane_m, rings_per_m: RINGS as f64 / most_m, rings: (0..RINGS).map(ring).collect() }
    }

    /// A point by two numbers, for a point of the film at a distance from the axis.
    pub(super) fn draw(&self, radius_m: f64, u: [f64; 2]) -> Aimed {
        let place = radius_m * self.rings_per_m;
        let ring = (place as usize).min(RINGS - 1);
        let [inner, outer] = &self.rings[ring];
        let window = inner.towards(outer, place - ring as f64);
        let length_m = window.high_m - window.low_m;
        let point_m = Vec3::new(window.low_m + u[0] * length_m, (2.0 * u[1] - 1.0) * window.half_width_m, self.plane_m);
        Aimed { point_m, area_m2: 2.0 * window.half_width_m * length_m }
    }
}

/// What a point of the film, at `film_m` of at most `most_m` from the axis, sees of the stop, with a margin.
fn find<F>(lens: &RearEnd<F>, [film_m, most_m]: [f64; 2], wavelength_nm: f64) -> Option<Window>
where
    F: Fn(Vec3<f64>, Vec3<f64>, f64) -> Option<[f64; 2]>,
{
    let &RearEnd { planes_m: [plane_m, far_m], radius_m, stop_m, .. } = lens;
    // The farthest from the axis that a ray from the film to the last surface meets the plane.
    let reach_m = radius_m + most_m * (1.0 - plane_m / far_m);
    let from = Vec3::new(film_m, 0.0, 0.0);
    let image = |x: f64, y: f64| {
        let direction = (Vec3::new(x, y, plane_m) - from).normalized();
        (lens.at_stop)(from, direction, wavelength_nm)
    };
    let mut field = Window { low_m: -reach_m, high_m: reach_m, half_width_m: reach_m };
    for _ in 0..MOST_SEARCHES {
        let steps = [(field.high_m - field.low_m) / CELLS[0] as f64, field.half_width_m / CELLS[1] as f64];
        let row = |j: usize| -> Vec<Option<[f64; 2]>> {
            (0..=CELLS[0]).map(|i| image(field.low_m + steps[0] * i as f64, steps[1] * j as f64)).collect()
        };
        let rows: Vec<_> = (0..=CELLS[1]).map(row).collect();
        let mut found: Option<Window> = None;
        for j in 0..CELLS[1] {
            for i in 0..CELLS[0] {
                let corners = [rows[j][i], rows[j][i + 1], rows[j + 1][i], rows[j + 1][i + 1]];
                if !may_see(corners, stop_m) {
                    continue;
                }
                let low_m = field.low_m + steps[0] * i as f64;
                let cell = Window { low_m, high_m: low_m + steps[0], half_width_m: steps[1] * (j + 1) as f64 };
                found = Some(found.map_or(cell, |window| window.joined(&cell)));
            }
        }
        let found = found?;
        let shrinks = found.high_m - found.low_m < 0.75 * (field.high_m - field.low_m)
            || found.half_width_m < 0.75 * field.half_width_m;
        field = found;
        if !shrinks {
            break;
        }
    }
    Some(field)
}

/// Whether the stop may be seen through a cell whose corners have these images on the stop: through the hull of the images, grown by its own
/// size on each side. A lens is smooth, so what lies between the corners is not farther away.
fn may_see(corners: [Option<[f64; 2]>; 4], stop_m: f64) -> bool {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for image in corners.into_iter().flatten() {
        for axis in 0..2 {
            bounds[axis] = [bounds[axis][0].min(image[axis]), bounds[axis][1].max(image[axis])];
        }
    }
    // Where the lens blocks some corners, the others are no hull.
    let least = if corners.contains(&None) { 0.5 * stop_m } else { 0.0 };
    bounds.iter().all(|[low, high]| {
        let size = if high < low { f64::NAN } else { (high - low).max(least) };
        // False where there is no image, whose size is no number.
        low - size <= stop_m && high + size >= -stop_m
    })
}
