//! Lamps as balls show them: mirrored by a ball, or seen through a ball of glass.
//!
//! A smooth ball shows a lamp at one place, which can be computed: all that is specular about a ball happens in the plane through its
//! middle, the point that looks and the lamp. So directions can be drawn toward the image itself, which often fills a thousandth of
//! what the ball does. About where it is and how large is enough, since directions are weighed by the density that they are
//! drawn with, whatever that is; hence `f32`, few steps of Newton's method, and an ellipse.
//!
//! What an image brings can be told without knowing where it is, if roughly, and most directions meet no ball. So every point asks
//! every image for its weight, but only the one that it aims at, and those that a direction shows, are found.

use crate::warp::concentric_disk;
use etalon_geometry::SphereSampler;
use etalon_optics::Vec3;
use std::f64::consts::PI;

/// How much larger than to first order an image is taken to be, since it is no ellipse.
const MARGIN: f32 = 1.1;
/// The tangent of the half angle beyond which no image is followed: there it is no longer small.
const LARGEST: f32 = 1.0;
/// The least cosine that an image counts with, of which the middle may lie below the horizon.
const LEAST_COS: f32 = 0.1;

/// A smooth ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    centre: Vec3<f32>,
    radius: f32,
    pub shows: Shows,
}

/// How a ball shows what is around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shows {
    Mirrored,
    /// Through glass of this index of refraction, relative to what is around it.
    Refracted(f32),
}

/// A lamp that a ball shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpecularImage {
    pub ball: Ball,
    /// From the middle of the ball to that of a sphere around the lamp: the unit vector and its length, and that sphere's radius.
    toward: Vec3<f32>,
    lamp_distance: f32,
    lamp_radius: f32,
    /// Distance of the ball's rim from the lamp; 0 from within.
    lamp_rim: f32,
    /// Of the lamp, relative to the brightest.
    radiance: f32,
}

/// A point that looks at a ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye {
    /// From the middle of the ball: the unit vector and its length.
    pub toward: Vec3<f32>,
    pub distance: f32,
    /// Distance of the ball's rim, m.
    pub rim: f32,
    /// The tangent of the half angle that the ball fills, at most [`LARGEST`]; 0 from within.
    pub most: f32,
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

/// The plane of a path by way of the ball: its axes, with the ball's middle for origin and the point that looks on the first.
struct Plane {
    axes: [Vec3<f32>; 2],
    /// Cosine and sine of the angle between the two, as seen from the middle.
    cos: f32,
    sin: f32,
    /// Whether both are outside, and not in line.
    is_one: bool,
}

/// A ray that a ball has handed on: from where, as seen from the ball's middle, and its direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HandedOn {
    pub start: Vec3<f32>,
    pub direction: Vec3<f32>,
}

impl Ball {
    pub(crate) fn new(ball: SphereSampler, shows: Shows) -> Self {
        Self { centre: ball.centre.cast(), radius: ball.radius as f32, shows }
    }

    /// A point, as it looks at the ball.
    #[inline(always)]
    pub(crate) fn eye(&self, from: Vec3<f32>) -> Eye {
        let v = from - self.centre;
        let distance = v.length();
        // Rounding of the distance must not put a point of the ball itself before it.
        let is_outside = distance > self.radius * 1.000_01;
        let rim = leg(distance, self.radius);
        let most = (self.radius / rim).min(LARGEST);
        let (rim, most) = (if is_outside { rim } else { 0.0 }, if is_outside { most } else { 0.0 });
        Eye { toward: v * (1.0 / distance), distance, rim, most }
    }

    /// Whether a ray from outside meets it.
    #[inline(always)]
    pub(crate) fn is_met(&self, from: Vec3<f32>, direction: Vec3<f32>) -> bool {
        let v = from - self.centre;
        let along = v.dot(direction);
        let across = v - direction * along;
        (along < 0.0) & (across.length_squared() < self.radius * self.radius)
    }

    /// What becomes of such a ray: light that it finds there is what the ball shows.
    pub(crate) fn hand_on(&self, from: Vec3<f32>, direction: Vec3<f32>) -> HandedOn {
        let v = from - self.centre;
        let across = v - direction * v.dot(direction);
        let half_chord = (self.radius * self.radius - across.length_squared()).max(0.0).sqrt();
        let first = across - direction * half_chord;
        let n = first * (1.0 / self.radius);
        match self.shows {
            Shows::Mirrored => HandedOn { start: first, direction: direction - n * (2.0 * direction.dot(n)) },
            Shows::Refracted(index) => {
                let within = refract(direction, n, 1.0 / index);
                let second = first - within * (2.0 * first.dot(within));
                HandedOn { start: second, direction: refract(within, second * (-1.0 / self.radius), index) }
            }
        }
    }
}

/// A direction beyond an interface whose normal `n` is on its side, for an index before over that behind; not a number where all is
/// reflected.
#[inline(always)]
fn refract(direction: Vec3<f32>, n: Vec3<f32>, eta: f32) -> Vec3<f32> {
    let cos = -direction.dot(n);
    direction * eta + n * (eta * cos - (1.0 - eta * eta * (1.0 - cos * cos)).sqrt())
}

impl SpecularImage {
    /// `radiance`: relative to the brightest lamp.
    pub(crate) fn new(ball: Ball, lamp: SphereSampler, radiance: f64) -> Self {
        let to_lamp = lamp.centre - ball.centre.to_f64();
        let lamp_distance = to_lamp.length();
        Self {
            ball,
            toward: (to_lamp / lamp_distance).cast(),
            lamp_distance: lamp_distance as f32,
            lamp_radius: lamp.radius as f32,
            lamp_rim: if lamp_distance > f64::from(ball.radius) { leg(lamp_distance as f32, ball.radius) } else { 0.0 },
            radiance: radiance as f32,
        }
    }

    /// The light that it brings to a surface of normal `n`, about; 0 where it is not seen. Without branches, so that a loop over points
    /// is vectorised. Of a mirror, where the mirroring point is guessed at: nearly right but for what a near ball shows at its rim, of
    /// which it promises too much.
    #[inline(always)]
    pub(crate) fn weight_mirrored(&self, eye: &Eye, n: Vec3<f32>) -> f32 {
        let (radius, d, to_lamp) = (self.ball.radius, eye.distance, self.lamp_distance);
        let (cos, facing, n_lamp) = (eye.toward.dot(self.toward), n.dot(eye.toward), n.dot(self.toward));
        // The mirroring point is at x and y radii along the directions of the point and of the lamp.
        let (near, far) = ((d - radius) * to_lamp, (to_lamp - radius) * d);
        let of_length = 1.0 / (near * near + far * far + 2.0 * near * far * cos).sqrt();
        let (x, y) = (far * of_length, near * of_length);
        let (cos_point, cos_lamp) = (x + y * cos, x * cos + y);
        // Its distance from the point and about that from the lamp; the point's above its tangential plane, and its own above the surface.
        let p = (d * d + radius * radius - 2.0 * d * radius * cos_point).sqrt();
        let q = to_lamp - radius * cos_lamp;
        let above = (d * cos_point - radius).max(LEAST_COS * p);
        let height = radius * (x * facing + y * n_lamp) - d * facing;
        // As `about` has it for these, but with a single division.
        let (together, power) = (p + q, 2.0 / radius * p * q);
        let metres = (together * above + power * p) * (together * p + power * above);
        let reach = MARGIN * self.lamp_radius;
        let solid_angle = (reach * reach * (above * p)).min(eye.most * eye.most * metres);
        let weight = self.radiance * solid_angle * height.max(LEAST_COS * p) / (metres * p);
        // In line with both rims, the ball still shows it.
        let is_shown = d * to_lamp * cos > radius * radius - eye.rim * self.lamp_rim;
        let is_seen = is_shown & (eye.rim > 0.0) & (self.lamp_rim > 0.0) & (height * together > -2.0 * reach * p);
        if is_seen { weight } else { 0.0 }
    }

    /// What the point sees of it.
    #[inline(always)]
    pub(crate) fn view(&self, eye: &Eye, n: Vec3<f32>) -> View {
        match self.ball.shows {
            Shows::Mirrored => self.view_mirrored(eye, n),
            Shows::Refracted(index) => self.view_refracted(index, eye, n),
        }
    }

    /// Whether a ray that the ball has handed on meets the lamp, about.
    #[inline(always)]
    pub(crate) fn is_shown(&self, ray: &HandedOn) -> bool {
        let toward = self.toward * self.lamp_distance - ray.start;
        let reach = MARGIN * self.lamp_radius;
        (toward.dot(ray.direction) > 0.0) & (toward.cross(ray.direction).length_squared() < reach * reach)
    }

    #[inline(always)]
    fn plane(&self, eye: &Eye) -> Plane {
        let cos = eye.toward.dot(self.toward);
        let across = self.toward - eye.toward * cos;
        let sin = across.length();
        let is_one = (eye.rim > 0.0) & (self.lamp_rim > 0.0) & (sin > 1e-5);
        Plane { axes: [eye.toward, across * (1.0 / sin)], cos, sin, is_one }
    }

    /// The image of the lamp about `axis`, where a turn of the axis by an angle, in the plane and out of it, moves the light that
    /// arrives at the lamp by this many metres a radian.
    #[inline(always)]
    fn about(
        &self,
        (eye, plane): (&Eye, &Plane),
        n: Vec3<f32>,
        axis: [f32; 2],
        metres: [f32; 2],
        is_found: bool,
    ) -> View {
        let [e1, e2] = plane.axes;
        let reach = MARGIN * self.lamp_radius;
        let half = [(reach / metres[0]).min(eye.most), (reach / metres[1]).min(eye.most)];
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

    /// The point of the ball at the angle α from the first axis is where both legs make the same angle with the normal:
    /// d·sin α·(D·cos(ψ − α) − R) = D·sin(ψ − α)·(d·cos α − R), with the distances d and D and the angle ψ between them.
    #[inline(always)]
    fn view_mirrored(&self, eye: &Eye, n: Vec3<f32>) -> View {
        let plane = self.plane(eye);
        let (radius, d, to_lamp, cos, sin) = (self.ball.radius, eye.distance, self.lamp_distance, plane.cos, plane.sin);
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
        self.about((eye, &plane), n, [leg_x * of_p, leg_y * of_p], metres, is_found)
    }

    /// A path of impact parameter b sweeps the angle acos(b/d) + acos(b/D) − 2 acos(b/R) + 2 acos(b/(nR)) about the middle: 2π − ψ,
    /// where it goes around the side away from the lamp, for positive b.
    #[inline(always)]
    pub(crate) fn view_refracted(&self, index: f32, eye: &Eye, n: Vec3<f32>) -> View {
        let plane = self.plane(eye);
        let (radius, d, to_lamp, cos, sin) = (self.ball.radius, eye.distance, self.lamp_distance, plane.cos, plane.sin);
        let rim = index * radius;
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
        self.about((eye, &plane), n, [-near * of_d, -b * of_d], [in_plane, around], is_found)
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
