//! Lamps as balls show them: mirrored by a ball, or seen through a ball of glass.
//!
//! A smooth ball shows a lamp at one place, which can be computed: all that is specular about a ball happens in the plane through its
//! middle, the point that looks and the lamp. So directions can be drawn toward the image itself, which often fills a thousandth of
//! what the ball does. About where it is and how large is enough, since directions are weighed by the density that they are
//! drawn with, whatever that is; hence `f32`, few steps of Newton's method, and an ellipse.

use crate::light::Round;
use crate::warp::concentric_disk;
use etalon_optics::Vec3;
use std::f64::consts::PI;

/// How much larger than to first order an image is taken to be, since it is no ellipse.
const MARGIN: f32 = 1.1;
/// The tangent of the half angle beyond which no image is followed: there it is no longer small.
const LARGEST: f32 = 1.0;
/// The least cosine that an image counts with, of which the middle may lie below the horizon.
const LEAST_COS: f32 = 0.1;

/// A ball and a lamp.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    centre: Vec3<f32>,
    radius: f32,
    /// From the middle of the ball to that of a sphere around the lamp, and that sphere's radius.
    to_lamp: Vec3<f32>,
    lamp_distance: f32,
    lamp_radius: f32,
    /// Of the lamp, relative to the brightest.
    radiance: f32,
}

/// About an ellipse of directions, on the plane that touches the sphere of directions in its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub axis: Vec3<f32>,
    /// The first of the ellipse's axes; the second is `axis` × `in_plane`.
    pub in_plane: Vec3<f32>,
    /// The tangents of its half angles.
    pub half: [f32; 2],
    /// The light that it brings to a diffuse surface; 0 where nothing is seen.
    pub weight: f32,
}

/// A ball that shows a lamp. No function has branches, so that a loop over points is vectorised.
pub(crate) trait Shows {
    /// What a surface of normal `n` sees of it.
    fn view(&self, from: Vec3<f32>, n: Vec3<f32>) -> View;
}

/// By a mirror.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mirrored(pub Pair);

/// Through glass of this index of refraction, relative to what is around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refracted(pub Pair, pub f32);

/// Either.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Image {
    Mirrored(Mirrored),
    Refracted(Refracted),
}

/// The plane of a path by way of the ball: its axes, with the ball's middle for origin and the point that looks on the first.
struct Plane {
    axes: [Vec3<f32>; 2],
    /// Distance of the point.
    distance: f32,
    /// Cosine and sine of the angle between the two, as seen from the middle.
    cos: f32,
    sin: f32,
    /// Whether both are outside, and not in line.
    is_one: bool,
}

impl Pair {
    /// `radiance`: relative to the brightest lamp.
    pub(crate) fn new(ball: Round, lamp: Round, radiance: f64) -> Self {
        let to_lamp = lamp.centre - ball.centre;
        Self {
            centre: ball.centre.cast(),
            radius: ball.radius as f32,
            to_lamp: to_lamp.cast(),
            lamp_distance: to_lamp.length() as f32,
            lamp_radius: lamp.radius as f32,
            radiance: radiance as f32,
        }
    }

    #[inline(always)]
    fn plane(&self, from: Vec3<f32>) -> Plane {
        // Divisions are what takes long here: one for each length.
        let v = from - self.centre;
        let (distance, of_lamp) = (v.length(), 1.0 / self.lamp_distance);
        let first = v * (1.0 / distance);
        let along = first.dot(self.to_lamp);
        let across = self.to_lamp - first * along;
        let height = across.length();
        // Rounding of the distance must not put a point of the ball itself before it.
        let are_outside = (distance > self.radius * 1.000_01) & (self.lamp_distance > self.radius);
        let is_one = are_outside & (height > 1e-5 * self.lamp_distance);
        let (cos, sin) = (along * of_lamp, height * of_lamp);
        Plane { axes: [first, across * (1.0 / height)], distance, cos, sin, is_one }
    }

    /// The image of the lamp about `axis`, where a turn of the axis by an angle, in the plane and out of it, moves the light that
    /// arrives at the lamp by so many metres a radian.
    #[inline(always)]
    fn image(&self, plane: &Plane, n: Vec3<f32>, axis: [f32; 2], metres: [f32; 2], is_found: bool) -> View {
        let [e1, e2] = plane.axes;
        let most = (self.radius / leg(plane.distance, self.radius)).min(LARGEST);
        let reach = MARGIN * self.lamp_radius;
        let half = [(reach / metres[0]).min(most), (reach / metres[1]).min(most)];
        // What lies on a circle around the ball's middle bends toward it: by as much the image is wider, and its middle is moved.
        let bend = (0.25 * half[1] * half[1] * (axis[0] / axis[1]).abs()).min(half[1]);
        let toward = if axis[1] > 0.0 { bend } else { -bend };
        let (x, y) = (axis[0] - axis[1] * toward, axis[1] - axis[0].abs() * toward);
        let to_unit = 1.0 / (x * x + y * y).sqrt();
        let (x, y) = (x * to_unit, y * to_unit);
        let (middle, in_plane) = (e1 * x + e2 * y, e1 * -y + e2 * x);
        let half = [half[0] + bend, half[1]];
        let cos = n.dot(middle);
        let is_seen = is_found & plane.is_one & (cos > -half[0].max(half[1])) & (half[0] > 0.0) & (half[1] > 0.0);
        let weight = self.radiance * (half[0] * half[1]) * cos.max(LEAST_COS);
        View { axis: middle, in_plane, half, weight: if is_seen { weight } else { 0.0 } }
    }
}

impl Shows for Mirrored {
    /// The point of the ball at the angle α from the first axis is where both legs make the same angle with the normal:
    /// d·sin α·(D·cos(ψ − α) − R) = D·sin(ψ − α)·(d·cos α − R), with the distances d and D and the angle ψ between them.
    #[inline(always)]
    fn view(&self, from: Vec3<f32>, n: Vec3<f32>) -> View {
        let plane = self.0.plane(from);
        let (radius, d, to_lamp, cos, sin) =
            (self.0.radius, plane.distance, self.0.lamp_distance, plane.cos, plane.sin);
        // Nearly the answer for what is near the ball, as before a plane mirror, and for what is far from it.
        let (near, far) = ((d - radius) * to_lamp, (to_lamp - radius) * d);
        let (x, y) = (far + near * cos, near * sin);
        let to_unit = 1.0 / (x * x + y * y).sqrt();
        let (mut x, mut y) = (x * to_unit, y * to_unit);
        for _ in 0..2 {
            let (x_lamp, y_lamp) = (cos * x + sin * y, sin * x - cos * y);
            let error = d * y * (to_lamp * x_lamp - radius) - to_lamp * y_lamp * (d * x - radius);
            let slope = 2.0 * d * to_lamp * (x * x_lamp + y * y_lamp) - radius * (d * x + to_lamp * x_lamp);
            let step = -error / slope;
            (x, y) = (x - step * y, y + step * x);
            let to_unit = 1.5 - 0.5 * (x * x + y * y);
            (x, y) = (x * to_unit, y * to_unit);
        }
        let is_found = (d * x > radius) & (to_lamp * (cos * x + sin * y) > radius);
        let (leg_x, leg_y) = (radius * x - d, radius * y);
        let (lamp_x, lamp_y) = (to_lamp * cos - radius * x, to_lamp * sin - radius * y);
        let (p, q) = ((leg_x * leg_x + leg_y * leg_y).sqrt(), (lamp_x * lamp_x + lamp_y * lamp_y).sqrt());
        let of_p = 1.0 / p;
        let cos_of_incidence = (d * x - radius) * of_p;
        let (together, power) = (p + q, 2.0 * p * q / radius);
        let metres = [together + power / cos_of_incidence, together + power * cos_of_incidence];
        self.0.image(&plane, n, [leg_x * of_p, leg_y * of_p], metres, is_found)
    }
}

impl Shows for Refracted {
    /// A path of impact parameter b sweeps the angle acos(b/d) + acos(b/D) − 2 acos(b/R) + 2 acos(b/(nR)) about the middle: 2π − ψ,
    /// where it goes around the side away from the lamp, for positive b.
    #[inline(always)]
    fn view(&self, from: Vec3<f32>, n: Vec3<f32>) -> View {
        let plane = self.0.plane(from);
        let (radius, d, to_lamp, cos, sin) =
            (self.0.radius, plane.distance, self.0.lamp_distance, plane.cos, plane.sin);
        let rim = self.1 * radius;
        let paraxial = 2.0 / radius - 2.0 / rim - 1.0 / d - 1.0 / to_lamp;
        let most = 0.8 * radius;
        let of_turn = 1.0 / (rim * radius);
        let to_unit = of_turn * of_turn / (d * to_lamp);
        let is_far = (cos > 0.0) | (paraxial * most <= sin);
        let mut b = if is_far { most } else { sin / paraxial };
        let (mut slope, mut sine, mut cosine) = (paraxial, 0.0, 1.0);
        for step in 0..5 {
            if step > 0 {
                b = (b - sine / slope).max(-0.97 * radius).min(0.97 * radius);
            }
            let (near, far, outer, inner) = (leg(d, b), leg(to_lamp, b), leg(radius, b), leg(rim, b));
            slope = 2.0 / outer - 2.0 / inner - 1.0 / near - 1.0 / far;
            let turn = times([b, inner], [b, -outer]);
            let swept = times(times([b, near], [b, far]), times(turn, turn));
            let (swept_x, swept_y) = (swept[0] * to_unit, swept[1] * to_unit);
            (sine, cosine) = (swept_y * cos + swept_x * sin, swept_x * cos - swept_y * sin);
        }
        let is_found = (cosine > 0.0) & (sine.abs() < 0.1);
        let (near, far) = (leg(d, b), leg(to_lamp, b));
        let in_plane = near * far * slope.abs();
        let around = if b.abs() < 1e-3 * radius { in_plane } else { d * (to_lamp * sin / b).abs() };
        let of_d = 1.0 / d;
        self.0.image(&plane, n, [-near * of_d, -b * of_d], [in_plane, around], is_found)
    }
}

/// The leg of a right triangle of this hypotenuse and other leg.
#[inline(always)]
fn leg(hypotenuse: f32, other: f32) -> f32 {
    ((hypotenuse - other) * (hypotenuse + other)).sqrt()
}

/// The product of two complex numbers.
#[inline(always)]
fn times([a, b]: [f32; 2], [c, d]: [f32; 2]) -> [f32; 2] {
    [a * c - b * d, a * d + b * c]
}

impl View {
    pub(crate) const NONE: Self =
        Self { axis: Vec3::new(0.0, 0.0, 1.0), in_plane: Vec3::new(1.0, 0.0, 0.0), half: [1.0; 2], weight: 0.0 };

    /// A direction for `u` in [0, 1]².
    #[inline(always)]
    pub(crate) fn aim(&self, u: [f64; 2]) -> Vec3<f64> {
        let (axis, in_plane) = (self.axis.to_f64(), self.in_plane.to_f64());
        let half = [f64::from(self.half[0]), f64::from(self.half[1])];
        let [a, b] = concentric_disk(u);
        let toward = axis + in_plane * (a * half[0]) + axis.cross(in_plane) * (b * half[1]);
        toward / toward.length()
    }

    /// The density of that, sr⁻¹, to the rounding of `f32` by which its axes are not at right angles.
    #[inline(always)]
    pub(crate) fn density(&self, wi: Vec3<f64>) -> f64 {
        let (axis, in_plane) = (self.axis.to_f64(), self.in_plane.to_f64());
        let half = [f64::from(self.half[0]), f64::from(self.half[1])];
        let cos = wi.dot(axis);
        // Both axes times the other's half angle, so that nothing is divided.
        let (a, b) = (wi.dot(in_plane) * half[1], wi.dot(axis.cross(in_plane)) * half[0]);
        let product = half[0] * half[1];
        let is_within = (cos > 0.0) & (a * a + b * b <= (cos * cos) * (product * product));
        if is_within { 1.0 / (PI * product * (cos * cos * cos)) } else { 0.0 }
    }
}
