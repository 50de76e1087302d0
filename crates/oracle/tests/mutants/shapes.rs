//! The shapes of the small renderer: where rays meet them and how shadow rays are aimed at them.

use std::f64::consts::PI;

use crate::vector::{Vec3, cross, dot, frame, minus, plus, times, unit};

pub(crate) enum Shape {
    Sphere {
        center: Vec3,
        radius: f64,
    },
    Disk {
        center: Vec3,
        normal: Vec3,
        radius: f64,
    },
    Quad {
        origin: Vec3,
        u: Vec3,
        v: Vec3,
    },
    Triangle([Vec3; 3]),
    /// The side of a cylinder.
    Tube {
        start: Vec3,
        axis: Vec3,
        length: f64,
        radius: f64,
    },
}

impl Shape {
    pub(crate) fn hit(&self, origin: Vec3, d: Vec3, leaving: bool) -> Option<(f64, Vec3)> {
        match self {
            Self::Sphere { center, radius } => {
                let to = minus(*center, origin);
                let b = dot(to, d);
                let foot = plus(to, -b, d);
                let reach = radius * radius - dot(foot, foot);
                if reach < 0.0 {
                    return None;
                }
                let (near, far) = (b - reach.sqrt(), b + reach.sqrt());
                // From the sphere itself one of the two is the point left.
                let t = if leaving { Some(2.0 * b) } else { [near, far].into_iter().find(|t| *t > 0.0) };
                let t = t.filter(|t| *t > 0.0)?;
                Some((t, times(1.0 / radius, minus(plus(origin, t, d), *center))))
            }
            Self::Tube { start, axis, length, radius } => {
                let to = minus(origin, *start);
                let across = |v: Vec3| plus(v, -dot(v, *axis), *axis);
                let (o, e) = (across(to), across(d));
                let (a, b, c) = (dot(e, e), dot(o, e), dot(o, o) - radius * radius);
                let square = b * b - a * c;
                if a == 0.0 || square < 0.0 {
                    return None;
                }
                let roots = [(-b - square.sqrt()) / a, (-b + square.sqrt()) / a];
                // From the tube itself one of the two is the point left.
                let roots = if leaving { [f64::NAN, -2.0 * b / a] } else { roots };
                let within = |t: &f64| *t > 0.0 && (0.0..=*length).contains(&dot(plus(to, *t, d), *axis));
                let t = roots.into_iter().find(within)?;
                Some((t, times(1.0 / radius, across(plus(to, t, d)))))
            }
            _ if leaving => None,
            Self::Disk { center, normal, radius } => {
                let t = dot(minus(*center, origin), *normal) / dot(d, *normal);
                let off = minus(plus(origin, t, d), *center);
                (t > 0.0 && dot(off, off) <= radius * radius).then_some((t, *normal))
            }
            Self::Quad { origin: corner, u, v } => {
                let (t, a, b) = planar(*corner, *u, *v, origin, d)?;
                ((0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b)).then(|| (t, unit(cross(*u, *v))))
            }
            Self::Triangle([a, b, c]) => {
                let (u, v) = (minus(*b, *a), minus(*c, *a));
                let (t, x, y) = planar(*a, u, v, origin, d)?;
                (x >= 0.0 && y >= 0.0 && x + y <= 1.0).then(|| (t, unit(cross(u, v))))
            }
        }
    }

    /// Whether it is so near that light from it is to be found by the walk: the variance of a point drawn on its area has no bound
    /// where it touches what it shines on.
    pub(crate) fn is_near(&self, from: Vec3) -> bool {
        // Of the shapes drawn by their area, what the truths have within reach of a receiver is rectangles.
        let Self::Quad { origin, u, v } = self else { return false };
        let normal = cross(*u, *v);
        let at = minus(from, *origin);
        let scale = 1.0 / dot(normal, normal);
        let [a, b] = [dot(cross(at, *v), normal), dot(cross(*u, at), normal)].map(|x| (x * scale).clamp(0.0, 1.0));
        let off = minus(at, plus(times(a, *u), b, *v));
        // Nearer than a quarter of its own size.
        dot(off, off) < dot(normal, normal).sqrt() / 16.0
    }

    /// A direction towards it: unit vector, whether it leads to the front, and 1/density over solid angle.
    pub(crate) fn towards(&self, from: Vec3, u: [f64; 2], fault: &str) -> Option<(Vec3, bool, f64)> {
        let (point, normal, area) = match self {
            Self::Sphere { center, radius } => {
                let to = minus(*center, from);
                let distance = dot(to, to).sqrt();
                if distance <= *radius {
                    return None;
                }
                let s = radius / distance;
                let cosine = ((distance - radius) * (distance + radius)).sqrt() / distance;
                let lift = match fault {
                    "1 - cos in single precision" => f64::from(1.0_f32 - cosine as f32),
                    "half of the cone" => 0.5 * s * s / (1.0 + cosine),
                    _ => s * s / (1.0 + cosine),
                };
                let (x, y) = frame(times(1.0 / distance, to));
                let rise = u[0] * lift;
                let r = (rise * (2.0 - rise)).sqrt();
                let phi = 2.0 * PI * u[1];
                let d = plus(plus(times((1.0 - rise) / distance, to), r * phi.cos(), x), r * phi.sin(), y);
                return Some((unit(d), true, 2.0 * PI * lift));
            }
            Self::Disk { center, normal, radius } => {
                let (x, y) = frame(*normal);
                let (r, phi) = (radius * u[0].sqrt(), 2.0 * PI * u[1]);
                (plus(plus(*center, r * phi.cos(), x), r * phi.sin(), y), *normal, PI * radius * radius)
            }
            Self::Tube { start, axis, length, radius } => {
                let (x, y) = frame(*axis);
                let phi = 2.0 * PI * u[0];
                let normal = plus(times(phi.cos(), x), phi.sin(), y);
                (plus(plus(*start, u[1] * length, *axis), *radius, normal), normal, 2.0 * PI * radius * length)
            }
            Self::Quad { origin, u: a, v: b } => {
                let normal = cross(*a, *b);
                (plus(plus(*origin, u[0], *a), u[1], *b), unit(normal), dot(normal, normal).sqrt())
            }
            Self::Triangle([a, b, c]) => {
                let normal = cross(minus(*b, *a), minus(*c, *a));
                let root = u[0].sqrt();
                let point = plus(plus(times(1.0 - root, *a), root * (1.0 - u[1]), *b), root * u[1], *c);
                (point, unit(normal), 0.5 * dot(normal, normal).sqrt())
            }
        };
        let to = minus(point, from);
        let d2 = dot(to, to);
        let d = unit(to);
        let cosine = -dot(d, normal);
        let seen = if fault == "cosine of the light dropped" { 1.0 } else { cosine.abs() };
        Some((d, cosine > 0.0, area * seen / d2))
    }
}

/// Where a ray meets the plane through a corner: t and the coordinates along u and v.
fn planar(corner: Vec3, u: Vec3, v: Vec3, origin: Vec3, d: Vec3) -> Option<(f64, f64, f64)> {
    let normal = cross(u, v);
    let t = dot(minus(corner, origin), normal) / dot(d, normal);
    if t.is_nan() || t <= 0.0 {
        return None;
    }
    let at = minus(plus(origin, t, d), corner);
    let scale = 1.0 / dot(normal, normal);
    Some((t, dot(cross(at, v), normal) * scale, dot(cross(u, at), normal) * scale))
}
