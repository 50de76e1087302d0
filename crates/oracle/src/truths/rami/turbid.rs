//! Leaves too small to cast shadows on single leaves: a slab of radiative transfer on a diffuse ground.
//!
//! Leaves of the area density u with normals of every direction alike meet light after 1/(G u) on the mean, G = ½. Averaged over the leaves that
//! it meets, light is turned by the angle β with the density (2/(3π²))·[ρ(sin β − β cos β) + τ(sin β + (π − β) cos β)] sr⁻¹, which is ρ + τ in
//! all (J. Ross 1981, *The Radiation Regime and Architecture of Plant Stands*).

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::super::meters::measured;
use super::super::scene::{Scene, block, lambert, level_square};
use super::{HEIGHT_M, LEAF_AREA_INDEX, SUNS_DEG, SuiteCase, Truth, case};
use crate::random::Uniform;
use crate::transfer::{Slab, legendre_moments};

/// A part of the spectrum: what leaves reflect and pass, and what the ground reflects.
#[derive(Clone, Copy)]
struct Spectral {
    name: &'static str,
    reflectance: f64,
    transmittance: f64,
    ground: f64,
}

const NEAR_INFRARED: Spectral =
    Spectral { name: "near infrared", reflectance: 0.4957, transmittance: 0.4409, ground: 0.159 };
const RED: Spectral = Spectral { name: "red", reflectance: 0.0546, transmittance: 0.0149, ground: 0.127 };

impl Spectral {
    fn albedo(self) -> f64 {
        self.reflectance + self.transmittance
    }

    /// The phase function, of the mean 1 over the sphere, at the cosine of the angle by which light is turned.
    fn phase(self, cosine: f64) -> f64 {
        let angle = cosine.clamp(-1.0, 1.0).acos();
        let back = angle.sin() - angle * cosine;
        let on = angle.sin() + (PI - angle) * cosine;
        8.0 / (3.0 * PI) * (self.reflectance * back + self.transmittance * on) / self.albedo()
    }
}

/// τ along the vertical: G times the leaf area index.
const DEPTH: f64 = 0.5 * LEAF_AREA_INDEX;

pub(super) fn cases() -> Vec<SuiteCase> {
    let mut list = Vec::new();
    for spectral in [NEAR_INFRARED, RED] {
        let moments = legendre_moments(|x| spectral.phase(x), 64);
        for sun_deg in SUNS_DEG.map(Some).into_iter().chain([None]) {
            let mu = sun_deg.map_or(1.0, |deg: f64| deg.to_radians().cos());
            let slab = Slab::new(DEPTH, spectral.albedo(), &moments, mu);
            let diffuse = slab.of_diffuse_light();
            let first = if sun_deg.is_some() { slab.of_beam() } else { diffuse };
            let at_ground = first.transmitted / (1.0 - spectral.ground * diffuse.reflected);
            let above = first.reflected + at_ground * spectral.ground * diffuse.transmitted;
            for (what, value, meter, mistake) in [
                ("albedo", above, meter([0.0, 0.0, 0.1], -1.0), first.reflected),
                ("at the ground", at_ground, meter([0.0, 0.0, -HEIGHT_M], 1.0), first.transmitted),
            ] {
                let sun = sun_deg.map_or("diffuse light".to_owned(), |deg| format!("sun at {deg}°"));
                let name = format!("rami-turbid-{}-{sun}-{what}", spectral.name).replace([' ', '°'], "-");
                let above_ground = what == "albedo";
                let truth = Truth::new(name, &scene(spectral, sun_deg, meter), value, "A = R + T t ρ/(1 − ρ r), t and r of diffuse light, by doubling")
                    .because(
                        "Light that reached the ground is reflected there and by the canopy from below, again and again. What passes and what comes \
                         back of a slab follows by doubling thin layers, whose phase function is that of the leaves.",
                    )
                    .confirmed("a walk from leaf to leaf, 400,000 times", 0.006, move || {
                        walked(spectral, sun_deg)[usize::from(!above_ground)]
                    })
                    .allows(1e-4 * value, "a phase function that is linear over half a degree; single precision");
                // Red light that the canopy sends back to the ground is too little to be told from none.
                let known = spectral.ground * diffuse.reflected > 0.01;
                let truth = if known { truth.or_else("a black ground", mistake) } else { truth };
                list.push(case(
                    "turbid",
                    "A canopy without size of leaves",
                    format!("{}, {sun}, {what}", spectral.name),
                    truth,
                ));
            }
        }
    }
    list
}

fn meter(position_m: [f64; 3], up: f64) -> Value {
    json!({ "type": "irradiance", "position_m": position_m, "normal": [0, 0, up] })
}

/// The slab between z = 0 and −2 m on its ground, under light of the irradiance 1.
fn scene(spectral: Spectral, sun_deg: Option<f64>, meter: Value) -> Scene {
    let angles: Vec<f64> = (0..=360).map(|i| 0.5 * f64::from(i)).collect();
    let values: Vec<f64> = angles.iter().map(|deg| spectral.phase(deg.to_radians().cos())).collect();
    let medium = json!({
        "extinction_per_m": DEPTH / HEIGHT_M, "albedo": spectral.albedo(),
        "phase": { "type": "tabulated", "angles_deg": angles, "values": values }
    });
    // The medium goes on below the ground, so that no two surfaces coincide.
    let canopy = json!({
        "shape": block([-1e4, -1e4, -HEIGHT_M - 1.0], [1e4, 1e4, 0.0]), "material": { "type": "boundary", "medium": medium }
    });
    let scene = measured(&[meter])
        .object(level_square([0.0, 0.0, -HEIGHT_M], 9e3, true), lambert(spectral.ground))
        .thing(canopy);
    match sun_deg {
        // Only paths that leave find it.
        None => scene.sky(1.0 / PI).spp(1 << 21),
        Some(deg) => {
            let (sine, cosine) = deg.to_radians().sin_cos();
            scene.directional_light([sine, 0.0, -cosine], 1.0 / cosine)
        }
    }
}

/// What comes back and what reaches the ground of one unit of light, by walking from leaf to leaf. There is no phase function: the normals of leaves
/// are drawn, in proportion to what the light sees of them.
fn walked(spectral: Spectral, sun_deg: Option<f64>) -> [f64; 2] {
    const WALKS: u32 = 400_000;
    let mut random = Uniform::new(7);
    let mut sums = [0.0; 2];
    for _ in 0..WALKS {
        let mut cosine = match sun_deg {
            Some(deg) => -deg.to_radians().cos(),
            None => -random.number().sqrt(),
        };
        let mut direction = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
        let (mut depth, mut weight) = (0.0, 1.0);
        loop {
            cosine = direction[2];
            depth -= cosine * -(1.0 - random.number()).ln();
            if depth < 0.0 {
                sums[0] += weight;
                break;
            }
            if depth > DEPTH {
                depth = DEPTH;
                sums[1] += weight;
                weight *= spectral.ground;
                direction = diffuse(&mut random, [0.0, 0.0, 1.0]);
            } else {
                weight *= spectral.albedo();
                let normal = leaf(&mut random, direction);
                // The normal is on the side that the light came from.
                let reflects = random.number() * spectral.albedo() < spectral.reflectance;
                direction = diffuse(&mut random, if reflects { normal } else { normal.map(|x| -x) });
            }
            if weight < 1e-3 {
                break;
            }
        }
    }
    sums.map(|sum| sum / f64::from(WALKS))
}

/// A direction in proportion to its cosine to the normal.
fn diffuse(random: &mut Uniform, normal: [f64; 3]) -> [f64; 3] {
    // A point on the unit sphere about the tip of the normal.
    let on_sphere = random.direction();
    let sum = [0, 1, 2].map(|k| normal[k] + on_sphere[k]);
    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
    sum.map(|x| x / length)
}

/// The normal of a leaf that light meets, against the light.
fn leaf(random: &mut Uniform, direction: [f64; 3]) -> [f64; 3] {
    loop {
        let normal = random.direction();
        let cosine: f64 = (0..3).map(|k| normal[k] * direction[k]).sum();
        if random.number() < cosine.abs() {
            return if cosine < 0.0 { normal } else { normal.map(|x| -x) };
        }
    }
}
