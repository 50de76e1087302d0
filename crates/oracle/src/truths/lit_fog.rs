//! Fog in beams and in the light of spots: what one ray through them shows of light that is scattered once.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::media::{boundary, isotropic, medium};
use super::scene::{Scene, block, glass, mirror, parallelogram, sphere, triangular_prism};
use super::{Claim, Truth};
use crate::laws::fresnel_exact;
use crate::quadrature::interval;
use crate::vector::{Vec3, cross, dot, length, normalize, scale, sub};

const EYE_M: f64 = 3.0;

/// Scattering and absorption of thin fog everywhere, 1/m.
const THIN: [f64; 2] = [0.08, 0.04];

/// The same of a ball of fog around the origin, in which light is scattered there as soon as it is looked for in a beam; its radius, m.
const THICK: [f64; 2] = [3.0, 0.2];
const BALL_M: f64 = 0.4;

/// A lamp in the fog: its form, and the fluence per area that it brings to a place without fog, with the way to there.
struct Lamp {
    name: &'static str,
    form: Value,
    brings: Box<dyn Fn(Vec3) -> [f64; 2] + Send + Sync>,
    /// Heights of the ray between which there is light, m.
    lit: [f64; 2],
    /// A body of glass that the light goes through first, before it comes to a ball of fog.
    through: Option<Value>,
    /// A mirror that reflects its light to the fog. The glass then reflects that of the other lamp.
    by: Option<Value>,
    /// Another lamp.
    aside: Option<Value>,
}

impl Lamp {
    fn fog(&self) -> [f64; 2] {
        if self.through.is_some() { THICK } else { THIN }
    }

    /// Height at which the eye's ray comes into the fog, m.
    fn top(&self) -> f64 {
        if self.through.is_some() { BALL_M } else { EYE_M }
    }

    /// L = ∫ σₛ/4π · E e^(−σ(s + d)) ds along a ray that comes down from the eye.
    fn seen(&self, share: impl Fn(f64) -> f64) -> f64 {
        let [first, last] = self.lit;
        let ([scattering, absorption], top) = (self.fog(), self.top());
        let along = |z: f64| {
            let [brought, way] = (self.brings)([0.0, 0.0, z]);
            scattering / (4.0 * PI) * brought * (-(scattering + absorption) * (way + top - z)).exp() * share(z)
        };
        interval(along, first, last, 1e-9).value
    }

    /// The same by midpoints.
    fn seen_by_midpoints(&self) -> f64 {
        let [first, last] = self.lit;
        let ([scattering, absorption], top) = (self.fog(), self.top());
        let steps = 200_000;
        let step = (last - first) / f64::from(steps);
        let at = |i: u32| first + (f64::from(i) + 0.5) * step;
        let value = |z: f64| {
            let [brought, way] = (self.brings)([0.0, 0.0, z]);
            brought * (-(scattering + absorption) * (way + top - z)).exp()
        };
        scattering / (4.0 * PI) * step * (0..steps).map(|i| value(at(i))).sum::<f64>()
    }

    fn truth(self) -> Truth {
        let scene = Scene::orthographic([0.0, 0.0, EYE_M], [0.0; 3], 1e-3).light(self.form.clone()).spp(256);
        let ([scattering, absorption], top) = (self.fog(), self.top());
        let fog = medium(scattering, absorption, &isotropic());
        // Both faces of a body are met; what the ball scatters twice would take another edge.
        let scene = match &self.through {
            Some(shape) => scene
                .object(shape.clone(), glass(INDEX))
                .thing(json!({ "shape": sphere([0.0; 3], BALL_M), "material": boundary(&fog) }))
                .depth(if self.by.is_some() { 3 } else { 4 })
                .film(8, 8),
            None => scene.whole("medium", fog).depth(2),
        };
        let scene = match &self.by {
            Some(mirror) => {
                scene.thing(mirror.clone()).set("integrator", "light_tracing", json!("never")).film(16, 16).spp(1024)
            }
            None => scene,
        };
        let scene = match &self.aside {
            Some(lamp) => scene.light(lamp.clone()),
            None => scene,
        };
        let passes = self.through.is_some();
        let value = self.seen(|_| 1.0);
        let [first, last] = self.lit;
        let middle = 0.5 * (first + last);
        let half = self.seen(|z| if z > middle { 1.0 } else { 0.0 });
        let clear = self.seen(|z| ((scattering + absorption) * (top - z)).exp());
        let truth = Truth::new(self.name, &scene, value, "∫ σₛ/4π E e^(−σ(s + d)) ds")
            .because("Fog that scatters once sends 1/4π of what it takes from each beam of light into each direction.")
            .confirmed("midpoints along the ray", 1e-6, move || self.seen_by_midpoints())
            .or_else("half of the light's width", half)
            .or_else("no fog before the eye", clear)
            .sees(if passes { 0.1 } else { 0.02 })
            .allows(2e-5 * value, "single precision; the picture is 1 mm wide")
            .claims(Claim::Scattering);
        match passes {
            true => truth.claims(Claim::SpecularConnections).claims(Claim::AveragesPolarisation),
            false => truth,
        }
    }
}

/// A beam of the power 1 W/nm: where its aperture is, its axis, radius, tangent, and whether it is Gaussian.
fn beam(name: &'static str, position: Vec3, axis: Vec3, [radius, half_angle_deg]: [f64; 2], gaussian: bool) -> Lamp {
    let axis = normalize(axis);
    let tangent = half_angle_deg.to_radians().tan();
    let brings = move |place: Vec3| {
        let from = sub(place, position);
        let depth = dot(from, axis);
        let across = sub(from, scale(depth, axis));
        let width = radius + depth * tangent;
        let squared = dot(across, across) / (width * width);
        let profile = match gaussian {
            true => 2.0 * (-2.0 * squared).exp(),
            false if squared <= 1.0 => 1.0,
            false => 0.0,
        };
        // The ray left the aperture nearer to the axis, by as much as the beam was narrower.
        let way = length(sub(from, scale(radius / width, across)));
        [profile / (PI * width * width) * way / depth, way]
    };
    let form = json!({
        "type": "beam", "position_m": position, "direction": axis, "radius_m": radius, "half_angle_deg": half_angle_deg,
        "profile": if gaussian { "gaussian" } else { "uniform" }, "power": 1,
    });
    // Across the axis of an even beam, exactly; of a Gaussian one, as far as there is anything.
    let lit = if gaussian { [-2.5, 2.5] } else { [-radius, radius] };
    Lamp { name, form, brings: Box::new(brings), lit, through: None, by: None, aside: None }
}

fn spot() -> Lamp {
    let position = [-2.0, 0.2, 0.3];
    let axis = normalize([1.0, 0.0, -0.1]);
    let [inner, outer] = [8.0_f64, 20.0].map(|degrees| degrees.to_radians().cos());
    let brings = move |place: Vec3| {
        let way = sub(place, position);
        let distance = length(way);
        let x = ((dot(way, axis) / distance - outer) / (inner - outer)).clamp(0.0, 1.0);
        [5.0 * x * x * (3.0 - 2.0 * x) / (distance * distance), distance]
    };
    let form = json!({
        "type": "spot", "position_m": position, "direction": axis, "inner_half_angle_deg": 8, "half_angle_deg": 20, "intensity": 5,
    });
    Lamp {
        name: "fog-in-a-spot",
        form,
        brings: Box::new(brings),
        lit: [-1.2, 1.4],
        through: None,
        by: None,
        aside: None,
    }
}

/// A gradient that a projector throws into the fog.
fn projector() -> Lamp {
    let position = [-2.0, 0.2, 0.3];
    let axis = normalize([1.0, 0.0, -0.1]);
    // Up is along the eye's ray, as nearly as it can be.
    let right = normalize(cross(axis, [0.0, 0.0, 1.0]));
    let up = cross(right, axis);
    let [across, height] = [0.4_f64, 0.3];
    let brings = move |place: Vec3| {
        let way = sub(place, position);
        let [x, y, depth] = [right, up, axis].map(|axis| dot(way, axis));
        let (u, v) = (0.5 + 0.5 * x / (depth * across), 0.5 + 0.5 * y / (depth * height));
        let distance = length(way);
        // 5 C/cos³θ/r², which is asked for within the picture only.
        let shows = if (0.0..=1.0).contains(&u) { 0.1 + 0.9 * v } else { f64::NAN };
        [5.0 * shows * distance / depth.powi(3), distance]
    };
    // Where the ray crosses the planes through the lamp and the lower, and the upper edge: their normals are up ∓ height · axis.
    let lit = [-height, height].map(|tangent| {
        let normal = sub(up, scale(tangent, axis));
        dot(position, normal) / normal[2]
    });
    let form = json!({
        "type": "point", "position_m": position, "intensity": 5,
        "slide": {
            "image": { "type": "gradient", "from": 0.1, "to": 1, "along": "v" }, "direction": axis, "up": [0, 0, 1],
            "horizontal_fov_deg": 2.0 * across.atan().to_degrees(), "aspect": across / height,
        },
    });
    Lamp {
        name: "fog-in-the-light-of-a-projector",
        form,
        brings: Box::new(brings),
        lit,
        through: None,
        by: None,
        aside: None,
    }
}

/// Radius of the beams that go through glass, and its index.
const RADIUS_M: f64 = 0.05;
const INDEX: f64 = 1.5;

/// A beam that has gone through glass, which passed this share of it, and comes through the middle of the ball.
fn behind(name: &'static str, shape: Value, [position, axis]: [Vec3; 2], share: f64) -> Lamp {
    let form = json!({ "type": "beam", "position_m": position, "direction": axis, "radius_m": RADIUS_M, "power": 1 });
    let brought = share / (PI * RADIUS_M * RADIUS_M);
    Lamp {
        name,
        form,
        brings: Box::new(move |[_, _, z]| [brought, (BALL_M * BALL_M - z * z).sqrt()]),
        lit: [-RADIUS_M, RADIUS_M],
        through: Some(shape),
        by: None,
        aside: None,
    }
}

/// A plate that is met head-on, and a prism that turns the beam as little as it can: then the beam stays round.
fn behind_glass() -> [Lamp; 3] {
    let head_on = fresnel_exact(1.0, INDEX).transmittance();
    let plate = block([-1.0, -1.0, -1.0], [-0.8, 1.0, 1.0]);
    // Within the prism light goes along x, at 30° to the normals of both faces.
    let outside = (0.5 * INDEX).asin();
    let turned = outside - 30_f64.to_radians();
    let (sin, cos) = turned.sin_cos();
    // Faces are met at (∓0.25 m, 0); the eye's ray is 0.8 m behind the second. It is the origin.
    let [x, y] = [0.25 + 0.8 * cos, -0.8 * sin];
    let height = 0.75_f64.sqrt();
    let corners = [[-0.5, -0.5 * height], [0.5, -0.5 * height], [0.0, 0.5 * height]].map(|[u, v]| [u - x, v - y]);
    let entered = [-0.25 - x, -y];
    let position = [entered[0] - cos, entered[1] - sin, 0.0];
    let share = fresnel_exact(outside.cos(), INDEX).transmittance();
    let along = [1.0, 0.0, 0.0];
    let lit = |name| behind(name, plate.clone(), [[-2.0, 0.0, 0.0], along], head_on * head_on);
    // As strong, above the ball.
    let above = behind("", plate.clone(), [[-2.0, 0.0, 0.7], along], 1.0).form;
    [
        lit("fog-behind-a-plate"),
        Lamp { aside: Some(above), ..lit("fog-beside-another-beam-behind-a-plate") },
        behind(
            "fog-behind-a-prism",
            triangular_prism(corners, [-0.5, 0.5]),
            [position, [cos, sin, 0.0]],
            share * share,
        ),
    ]
}

/// A beam by way of a mirror, and as strong a one that a plate of glass reflects, from both sides along the eye's plane.
fn by_a_mirror_and_by_glass() -> Truth {
    let (sin, cos) = 70_f64.to_radians().sin_cos();
    let share = fresnel_exact(cos, INDEX).reflectance();
    // Both surfaces stand upright, 0.8 m from the ray, and are met at this height.
    let (away, height) = (0.8, 0.8 * sin / cos);
    let mirror = json!({
        "shape": parallelogram([away, height - 0.4, -1.0], [0.0, 0.8, 0.0], [0.0, 0.0, 2.0]),
        "material": mirror(share),
    });
    let plate = block([-away - 0.2, height - 0.4, -1.0], [-away, height + 0.4, 1.0]);
    let from = |side: f64| [[side * (away - cos), height + sin, 0.0], [side * cos, -sin, 0.0]];
    // The eye, the fog, the mirror or the glass, and the lamp.
    let aside = behind("", plate.clone(), from(-1.0), share).form;
    let lamp = behind("fog-by-a-mirror-and-by-glass-that-reflects", plate, from(1.0), 2.0 * share);
    let value = lamp.seen(|_| 1.0);
    let lamp = Lamp { by: Some(mirror), aside: Some(aside), ..lamp };
    lamp.truth()
        .or_else("the light of one of the two lamps alone", 0.5 * value)
        .or_else("what the glass reflects counts twice", 1.5 * value)
}

pub(super) fn truths() -> Vec<Truth> {
    let [plate, beside, prism] = behind_glass();
    [
        beam("fog-in-a-beam", [-2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.2, 0.0], false),
        beam("fog-in-a-gaussian-beam-that-widens", [-1.5, 0.1, -0.5], [1.0, 0.0, 0.3], [0.1, 3.0], true),
        spot(),
        projector(),
        plate,
        beside,
        prism,
    ]
    .map(Lamp::truth)
    .into_iter()
    .chain([by_a_mirror_and_by_glass()])
    .collect()
}
