//! A whole renderer in three hundred lines of plain `f64`, without a tree, without wavelengths, without MIS: the oracle's own
//! reader of its scenes, and the body that whole-picture mutants are made of.

use std::f64::consts::PI;

use crate::{
    vector::{Vec3, cross, dot, frame, minus, plus, times, unit},
    world::{Light, Material, World, number, vec3},
};
use etalon_oracle::{
    Uniform,
    statistics::{Estimate, Welford},
    subjects::Reading,
    truths::{Claim, Renders, Truth, photometric_weight},
};

struct Hit {
    t: f64,
    normal: Vec3,
    primitive: usize,
}

/// A renderer with a fault; the empty fault is none.
pub(crate) struct Tracer {
    pub(crate) fault: &'static str,
    pub(crate) paths: u64,
    pub(crate) seed: u64,
}

/// Surfaces nearer to each other than this along a ray are at one place, m: in scenes with masks only.
const COINCIDENT: f64 = 1e-9;

impl World {
    /// Nearest hit beyond the primitive left. A mask is there for a ray with the probability of its opacity; what coincides with
    /// the surface left is left with it.
    fn hit(&self, origin: Vec3, d: Vec3, leaving: Option<usize>, numbers: &mut Uniform) -> Option<Hit> {
        let least = if self.fault == "hits nearer than 1e-4 lost" { 1e-4 } else { 0.0 };
        let masked = self.objects.iter().any(|object| object.opacity < 1.0);
        let least = if masked { COINCIDENT } else { least };
        let mut passed = Vec::new();
        let mut nearest: Option<Hit> = None;
        for (i, primitive) in self.primitives.iter().enumerate() {
            let Some((t, normal)) = primitive.shape.hit(origin, d, leaving == Some(i)) else { continue };
            let opacity = self.opacity(i);
            if opacity < 1.0 && numbers.number() >= opacity {
                passed.push(t);
                continue;
            }
            let lies_before = |hit: &Hit| match (t - hit.t).abs() < COINCIDENT {
                // Of coincident surfaces a mask comes first, a later one before an earlier.
                true if masked => opacity < 1.0 || self.opacity(hit.primitive) == 1.0 && t < hit.t,
                _ => t < hit.t,
            };
            if t > least && nearest.as_ref().is_none_or(lies_before) {
                nearest = Some(Hit { t, normal, primitive: i });
            }
        }
        if self.fault == "what coincides with a mask that is passed is passed too" {
            nearest = nearest.filter(|hit| passed.iter().all(|t| (t - hit.t).abs() > COINCIDENT));
        }
        nearest
    }

    fn opacity(&self, primitive: usize) -> f64 {
        if self.fault == "masks are opaque" {
            return 1.0;
        }
        self.objects[self.primitives[primitive].object].opacity
    }

    fn radiance(&self, mut origin: Vec3, mut d: Vec3, numbers: &mut Uniform) -> f64 {
        let (mut sum, mut weight, mut edges) = (0.0, 1.0_f64, 0);
        // Where the path last left a diffuse surface, from which shadow rays were sent too.
        let (mut leaving, mut diffuse, mut medium) = (None, None::<Vec3>, 1.0_f64);
        loop {
            edges += 1;
            let Some(hit) = self.hit(origin, d, leaving, numbers) else { return sum + weight * self.sky };
            let object = &self.objects[self.primitives[hit.primitive].object];
            let front = dot(hit.normal, d) < 0.0;
            let shape = &self.primitives[hit.primitive].shape;
            let aimed_at = object.sampled && diffuse.is_some_and(|from| !shape.is_near(from));
            let counted = !aimed_at || self.fault == "light found both ways in full";
            if counted && if front { object.front } else { object.back } {
                sum += weight * object.radiance;
            }
            let limit = match self.fault {
                "paths cut at 100 edges, and counted" => 100,
                "paths cut at 400 edges, and counted" => 400,
                _ => u64::MAX,
            };
            if edges >= limit {
                let (count, throughput) = self.cut.get();
                self.cut.set((count + 1, throughput.max(weight)));
                return sum;
            }
            if edges >= self.most_edges {
                return sum;
            }
            let point = plus(origin, hit.t, d);
            // The normal on the side that the ray comes from.
            let n = if front || self.fault == "normals not turned" { hit.normal } else { times(-1.0, hit.normal) };
            diffuse = None;
            match object.material {
                Material::Black => return sum,
                Material::Lambert(albedo) => {
                    diffuse = Some(point);
                    if edges < self.most_edges {
                        sum += weight * albedo / PI * self.direct(point, n, hit.primitive, numbers);
                    }
                    weight *= if self.fault == "no division by pi" { albedo * PI } else { albedo };
                    let (s, t) = frame(n);
                    let (u, phi) = (numbers.number(), 2.0 * PI * numbers.number());
                    let r = if self.fault == "hemisphere sampled evenly" { (u * (2.0 - u)).sqrt() } else { u.sqrt() };
                    let z = (1.0 - r * r).max(0.0).sqrt();
                    d = unit(plus(plus(times(z, n), r * phi.cos(), s), r * phi.sin(), t));
                }
                Material::Mirror(reflectance) => {
                    weight *= if self.fault == "mirrors lose nothing" { 1.0 } else { reflectance };
                    d = unit(plus(d, -2.0 * dot(d, n), n));
                }
                Material::Conductor(re, im) => {
                    weight *= conductor(re, im, -dot(d, n));
                    d = unit(plus(d, -2.0 * dot(d, n), n));
                }
                Material::Dielectric { inside, outside, alpha } if alpha > 0.0 => {
                    let (from, to) = if front { (outside, inside) } else { (inside, outside) };
                    let Some((away, crossed)) = self.leave_facets(alpha, to / from, d, n, numbers) else { return sum };
                    d = away;
                    if crossed {
                        weight *= (from / to).powi(2);
                        medium *= (from / to).powi(2);
                    }
                }
                Material::Dielectric { inside, outside, .. } => {
                    let (from, to) = if front { (outside, inside) } else { (inside, outside) };
                    let eta = if self.fault == "the ratio never turned round" { inside / outside } else { to / from };
                    let c = -dot(d, n);
                    let square = 1.0 - (1.0 - c * c) / (eta * eta);
                    let r = self.reflectance(c, eta);
                    if numbers.number() < r {
                        d = unit(plus(d, 2.0 * c, n));
                    } else {
                        d = match self.fault {
                            "equation (1) of the assignment" => {
                                unit(plus(times(1.0 / eta, d), -c / eta - square.max(0.0).sqrt(), n))
                            }
                            "not refracted" => d,
                            _ => unit(plus(times(1.0 / eta, d), c / eta - square.max(0.0).sqrt(), n)),
                        };
                        let scale = match self.fault {
                            "no n squared" => 1.0,
                            "n squared the wrong way" => (to / from).powi(2),
                            _ => (from / to).powi(2),
                        };
                        weight *= scale;
                        medium *= scale;
                    }
                }
            }
            origin = point;
            leaving = Some(hit.primitive);
            if self.fault == "rays offset by 1e-3" {
                origin = plus(point, 1e-3, d);
            }
            // Russian roulette on what the path can still carry, the medium's share taken out.
            let mut q = (weight / medium).min(1.0);
            if self.fault == "roulette capped at 0.95" {
                q = q.min(0.95);
            }
            if edges > 4 && q < 1.0 {
                if numbers.number() >= q {
                    return sum;
                }
                if self.fault != "roulette not weighed" {
                    weight /= q;
                }
            }
        }
    }

    /// Where light along `d` goes from facets about `n` that absorb nothing, and whether it is behind them then. From a facet that sends it
    /// where it cannot go it meets another, until it can. `None` where it is lost.
    fn leave_facets(&self, alpha: f64, eta: f64, mut d: Vec3, n: Vec3, numbers: &mut Uniform) -> Option<(Vec3, bool)> {
        let (s, t) = frame(n);
        let (mut behind, mut eta) = (false, eta);
        loop {
            // GGX facets by D cos, of which those that face away are not met.
            let (u, phi) = (numbers.number(), 2.0 * PI * numbers.number());
            let z = ((1.0 - u) / (1.0 + (alpha * alpha - 1.0) * u)).sqrt();
            let r = (1.0 - z * z).max(0.0).sqrt();
            let h = plus(plus(times(z, n), r * phi.cos(), s), r * phi.sin(), t);
            let h = if behind { times(-1.0, h) } else { h };
            let c = -dot(d, h);
            if c <= 0.0 {
                continue;
            }
            if numbers.number() < self.reflectance(c, eta) {
                d = unit(plus(d, 2.0 * c, h));
            } else {
                let square = 1.0 - (1.0 - c * c) / (eta * eta);
                d = unit(plus(times(1.0 / eta, d), c / eta - square.max(0.0).sqrt(), h));
                (behind, eta) = (!behind, 1.0 / eta);
            }
            if (dot(d, n) < 0.0) == behind {
                return Some((d, behind));
            }
            if self.fault == "light that meets several facets lost" {
                return None;
            }
        }
    }

    fn reflectance(&self, c: f64, eta: f64) -> f64 {
        let square = 1.0 - (1.0 - c * c) / (eta * eta);
        if square <= 0.0 {
            return if self.fault == "no total reflection" { 0.0 } else { 1.0 };
        }
        let ct = square.sqrt();
        let (r_s, r_p) = ((c - eta * ct) / (c + eta * ct), (eta * c - ct) / (eta * c + ct));
        match self.fault {
            "s polarisation only" => r_s * r_s,
            "Schlick" => {
                let r0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
                r0 + (1.0 - r0) * (1.0 - c).powi(5)
            }
            "glass without reflection" => 0.0,
            _ => 0.5 * (r_s * r_s + r_p * r_p),
        }
    }

    /// Irradiance from one light, chosen evenly.
    fn direct(&self, point: Vec3, n: Vec3, leaving: usize, numbers: &mut Uniform) -> f64 {
        if self.lights.is_empty() {
            return 0.0;
        }
        let choice = ((numbers.number() * self.lights.len() as f64) as usize).min(self.lights.len() - 1);
        let many = if self.fault == "a light's choice not weighed" { 1.0 } else { self.lights.len() as f64 };
        let visible = |d: Vec3, t: f64, target: Option<usize>, numbers: &mut Uniform| {
            let hit = self.hit(point, d, Some(leaving), numbers);
            let clear = match (hit, target) {
                (None, _) => true,
                (Some(hit), Some(target)) => hit.primitive == target,
                (Some(hit), None) => hit.t > t,
            };
            clear || self.fault == "no shadows"
        };
        let irradiance = match self.lights[choice] {
            Light::Point { at, intensity } => {
                let to = minus(at, point);
                let d2 = dot(to, to);
                let d = unit(to);
                let cosine = if self.fault == "cosine of the receiver dropped" { 1.0 } else { dot(d, n) };
                let falls = if self.fault == "falling with the distance" { d2.sqrt() } else { d2 };
                if cosine > 0.0 && visible(d, d2.sqrt(), None, numbers) { intensity * cosine / falls } else { 0.0 }
            }
            Light::Directional { along, irradiance } => {
                let d = times(-1.0, along);
                let cosine = if self.fault == "cosine of the receiver dropped" { 1.0 } else { dot(d, n) };
                if cosine > 0.0 && visible(d, f64::INFINITY, None, numbers) { irradiance * cosine } else { 0.0 }
            }
            Light::Primitive(target) => {
                let object = &self.objects[self.primitives[target].object];
                if self.primitives[target].shape.is_near(point) {
                    return 0.0;
                }
                let u = [numbers.number(), numbers.number()];
                let Some((d, facing, inverse)) = self.primitives[target].shape.towards(point, u, self.fault) else {
                    return 0.0;
                };
                let shines = if facing { object.front } else { object.back };
                let cosine = dot(d, n);
                let lit = shines && cosine > 0.0 && visible(d, f64::INFINITY, Some(target), numbers);
                if lit { object.radiance * cosine * inverse } else { 0.0 }
            }
        };
        irradiance * many
    }

    fn camera_ray(&self, x: f64, y: f64, numbers: &mut Uniform) -> (Vec3, Vec3) {
        let position = vec3(&self.camera["position_m"]);
        let forward = unit(minus(vec3(&self.camera["look_at_m"]), position));
        let right = unit(cross(forward, vec3(&self.camera["up"])));
        let up = cross(right, forward);
        let (x, y) = (2.0 * x - 1.0, 1.0 - 2.0 * y);
        if self.camera["type"] == "orthographic" {
            let half = 0.5 * number(&self.camera["height_m"]);
            return (plus(plus(position, x * half * self.aspect, right), y * half, up), forward);
        }
        let half_angle = 0.5 * number(&self.camera["vertical_fov_deg"]).to_radians();
        let mut half = if self.fault == "field of view doubled" { (2.0 * half_angle).tan() } else { half_angle.tan() };
        if self.fault == "field of view taken as horizontal" {
            half /= self.aspect;
        }
        let d = plus(plus(forward, x * half * self.aspect, right), y * half, up);
        let lens = &self.camera["lens"];
        if lens.is_null() {
            return (position, unit(d));
        }
        let radius = number(&lens["radius_m"]);
        let focus = match self.fault {
            "focused at infinity" => 1e9,
            _ => number(&lens["focus_distance_m"]),
        };
        let (u, v) = (numbers.number(), numbers.number());
        let (a, b) = match self.fault {
            "lens sampled as a square" => (2.0 * u - 1.0, 2.0 * v - 1.0),
            "lens radius without its root" => (u * (2.0 * PI * v).cos(), u * (2.0 * PI * v).sin()),
            "lens of twice the radius" => {
                (2.0 * u.sqrt() * (2.0 * PI * v).cos(), 2.0 * u.sqrt() * (2.0 * PI * v).sin())
            }
            _ => (u.sqrt() * (2.0 * PI * v).cos(), u.sqrt() * (2.0 * PI * v).sin()),
        };
        let start = plus(plus(position, radius * a, right), radius * b, up);
        (start, unit(minus(plus(position, focus, d), start)))
    }
}

/// Reflectance of a metal by the real formulas of ellipsometry.
fn conductor(n: f64, k: f64, c: f64) -> f64 {
    let (c2, s2) = (c * c, 1.0 - c * c);
    let difference = n * n - k * k - s2;
    let sum = (difference * difference + 4.0 * n * n * k * k).sqrt();
    let a = (0.5 * (sum + difference)).max(0.0).sqrt();
    let r_s = (sum + c2 - 2.0 * a * c) / (sum + c2 + 2.0 * a * c);
    let (t3, t4) = (c2 * sum + s2 * s2, 2.0 * a * c * s2);
    0.5 * r_s * (1.0 + (t3 - t4) / (t3 + t4))
}

impl Tracer {
    /// What the sensor makes of a path of this wavelength, drawn evenly from 360 to 830 nm; 1 where all count alike.
    fn sensor(&self, wavelength_nm: f64) -> f64 {
        let lane = |k: u32| 470.0 * photometric_weight(360.0 + (wavelength_nm - 360.0 + 117.5 * f64::from(k)) % 470.0);
        match self.fault {
            _ if wavelength_nm == 0.0 => 1.0,
            "a wavelength lane kept after dispersion" => 0.25 * (0..4).map(lane).sum::<f64>(),
            "the hero not weighed up" => 0.25 * lane(0),
            _ => lane(0),
        }
    }
}

impl Renders for Tracer {
    fn render(&mut self, truth: &Truth) -> Result<Reading, String> {
        // The scene at each of many wavelengths, even steps over the visible range, for a sensor that tells them apart.
        let worlds: Vec<(f64, World)> = if truth.claims.contains(&Claim::PhotometricSensor) {
            let at = |i: u32| 360.0 + 470.0 * (f64::from(i) + 0.5) / 4700.0;
            (0..4700)
                .map(|i| Ok((at(i), World::read(&truth.scene, self.fault, Some(at(i)))?)))
                .collect::<Result<_, String>>()?
        } else {
            vec![(0.0, World::read(&truth.scene, self.fault, None)?)]
        };
        let mut numbers = Uniform::new(self.seed);
        // Strata over the picture; the variance is taken within pairs of samples in one stratum.
        let strata = ((self.paths / 2) as f64).sqrt().ceil() as u32;
        let (mut means, mut variance, mut nonfinite) = (Welford::new(), 0.0, 0);
        for i in 0..strata {
            for j in 0..strata {
                let pair = [0, 1].map(|_| {
                    let x = (f64::from(i) + numbers.number()) / f64::from(strata);
                    let y = (f64::from(j) + numbers.number()) / f64::from(strata);
                    let (wavelength_nm, world) = &worlds[(numbers.number() * worlds.len() as f64) as usize];
                    let (origin, d) = world.camera_ray(x, y, &mut numbers);
                    let value = world.radiance(origin, d, &mut numbers) * self.sensor(*wavelength_nm);
                    let value = if self.fault == "0/0 in one of a thousand" && numbers.number() < 1e-3 {
                        f64::NAN
                    } else {
                        value
                    };
                    nonfinite += u64::from(!value.is_finite());
                    if value.is_finite() { value } else { 0.0 }
                });
                means.push(0.5 * (pair[0] + pair[1]));
                variance += 0.25 * (pair[0] - pair[1]).powi(2);
            }
        }
        let count = f64::from(strata) * f64::from(strata);
        let cut = worlds.iter().map(|(_, world)| world.cut.get()).fold((0, 0.0_f64), |a, b| (a.0 + b.0, a.1.max(b.1)));
        let cut_bias = truth.bias_of_cut_paths(cut.0, cut.1, 2 * count as u64, 1e-9);
        Ok(Reading { estimate: Estimate::new(means.mean(), variance.sqrt() / count), nonfinite, cut_bias })
    }
}
