//! Lights without area, seen by way of mirrors and smooth glass: plates, balls, rods, prisms, corners, and fog above a mirror.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    media::{boundary, isotropic, medium},
    prisms::bk7,
    scene::{
        PLATE_ALBEDO, Scene, block, cylinder, glass, level_square, mirror, parallelogram, sellmeier_glass, sphere,
        triangular_prism,
    },
};
use crate::{
    laws::{FresnelPowers, fresnel_exact},
    vector::{Vec3, add, dot, scale},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = panes();
    list.extend(mirrors());
    list.extend(rounds());
    list.extend(beams_through_a_prism());
    list.push(fog_above_a_mirror());
    list.into_iter().map(|truth| truth.claims(Claim::SpecularConnections)).collect()
}

fn shown(irradiance: f64) -> f64 {
    PLATE_ALBEDO * irradiance / PI
}

const INDEX: f64 = 1.5;

/// A lamp of intensity 1 above a plate of glass, and the meter below, aside of the foot.
struct Plate;

impl Plate {
    const LAMP_M: f64 = 2.0;
    const BOTTOM_M: f64 = 0.6;
    const THICKNESS_M: f64 = 0.4;
    const ASIDE_M: f64 = 1.1;
    /// Times that light goes to and fro, beyond which less than 1e-12 is left.
    const ORDERS: i32 = 12;

    /// How far aside light arrives that leaves the lamp by the sine of this angle, after going to and fro inside some times.
    fn aside(sine: f64, order: i32) -> f64 {
        let tangent = |sine: f64| sine / (1.0 - sine * sine).sqrt();
        (Self::LAMP_M - Self::THICKNESS_M) * tangent(sine)
            + f64::from(2 * order + 1) * Self::THICKNESS_M * tangent(sine / INDEX)
    }

    /// The sine of the angle by which light leaves that arrives at the meter.
    fn sine(order: i32) -> f64 {
        let (mut low, mut high) = (0.0, 1.0 - 1e-9);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if Self::aside(middle, order) < Self::ASIDE_M { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// What comes through both faces, and what each reflection inside leaves.
    fn irradiance(share: impl Fn(&FresnelPowers, i32) -> f64) -> f64 {
        let of_order = |order: i32| {
            let sine = Self::sine(order);
            let cosine = (1.0 - sine * sine).sqrt();
            // d(aside)/d(sine): a tangent grows by 1/cos³.
            let inside = sine / INDEX;
            let grows = (Self::LAMP_M - Self::THICKNESS_M) / cosine.powi(3)
                + f64::from(2 * order + 1) * Self::THICKNESS_M / (INDEX * (1.0 - inside * inside).powf(1.5));
            // A ring of the width da holds the light of the angles sin θ dθ = sin θ d(sin θ)/cos θ.
            sine / cosine / (Self::ASIDE_M * grows) * share(&fresnel_exact(cosine, INDEX), order)
        };
        (0..Self::ORDERS).map(of_order).sum()
    }

    /// The same by rays that are refracted by Snell's law in vector form: the flux between neighbours over the ring that it arrives in.
    fn by_rays() -> f64 {
        let h = 1e-5;
        let lands = |angle: f64, order: i32| {
            let (sine, cosine) = angle.sin_cos();
            let inside = refracted([sine, 0.0, -cosine], [0.0, 0.0, 1.0], INDEX);
            let across = -inside[0] / inside[2] * Self::THICKNESS_M;
            sine / cosine * (Self::LAMP_M - Self::THICKNESS_M) + f64::from(2 * order + 1) * across
        };
        let of_order = |order: i32| {
            let angle = Self::sine(order).asin();
            let (near, far) = (lands(angle - h, order), lands(angle + h, order));
            let flux = (angle - h).cos() - (angle + h).cos();
            let reflectance = fresnel_exact(angle.cos(), INDEX).reflectance();
            flux / (0.5 * (far * far - near * near)) * (1.0 - reflectance).powi(2) * reflectance.powi(2 * order)
        };
        (0..Self::ORDERS).map(of_order).sum()
    }

    fn scene() -> Scene {
        let far = 200.0;
        let bottom = Self::BOTTOM_M;
        Scene::light_meter()
            .object(block([-far, -far, bottom], [far, far, bottom + Self::THICKNESS_M]), glass(INDEX))
            .point_light([Self::ASIDE_M, 0.0, Self::LAMP_M], 1.0)
            .spp(1 << 10)
    }
}

/// A direction after a face whose normal faces it, from index 1 to `eta`.
fn refracted(d: Vec3, normal: Vec3, eta: f64) -> Vec3 {
    let c = -dot(d, normal);
    let along = c / eta - (1.0 - (1.0 - c * c) / (eta * eta)).sqrt();
    add(scale(1.0 / eta, d), scale(along, normal))
}

fn panes() -> Vec<Truth> {
    let because = "A ring da wide about the foot of the lamp receives the light of the angles dθ: I sin θ dθ/(a da), whatever bends it. The faces \
         transmit 1 − R each, and every time that light goes to and fro inside, R² is left of it.";
    let unpolarised = |r: f64, order: i32| (1.0 - r).powi(2) * r.powi(2 * order);
    let averaged = Plate::irradiance(|powers, order| unpolarised(powers.reflectance(), order));
    let polarised =
        Plate::irradiance(|powers, order| 0.5 * (unpolarised(powers.r_s, order) + unpolarised(powers.r_p, order)));
    // A pane that has no thickness: what is lost is 2R/(1 + R).
    let distance = 2.5_f64;
    let r = fresnel_exact(2.0 / distance, INDEX).reflectance();
    let bare = 2.0 / distance.powi(3);
    let pane = json!({ "type": "thin-dielectric", "index": INDEX });
    let behind_a_pane = Scene::light_meter()
        .thing(json!({ "shape": level_square([0.0, 0.0, 1.0], 50.0, false), "material": pane }))
        .point_light([1.5, 0.0, 2.0], 1.0)
        .spp(1 << 10);
    vec![
        Truth::new("lamp-above-a-plate", &Plate::scene(), shown(averaged), "(ρ/π) Σ I sin θ dθ/(a da) (1 − R)² R²ᵏ")
            .because(because)
            .confirmed("rays refracted by vectors, the flux between neighbours", 1e-8, || shown(Plate::by_rays()))
            .or_else("dark", 0.0)
            .or_else("radiance not spread by n² behind the plate", shown(averaged) / (INDEX * INDEX))
            .claims(Claim::AveragesPolarisation)
            .sees(0.01),
        Truth::new(
            "lamp-above-a-plate-in-polarised-light",
            &Plate::scene(),
            shown(polarised),
            "the mean of that for s and for p",
        )
        .because(because)
        .or_else("dark", 0.0)
        .claims(Claim::CarriesPolarisation)
        .sees(0.01),
        Truth::new(
            "lamp-behind-a-thin-pane",
            &behind_a_pane,
            shown(bare * (1.0 - r) / (1.0 + r)),
            "(ρ/π) I h/d³ (1 − R)/(1 + R)",
        )
        .because("Light goes straight on; Σ (1 − R)² R²ᵏ = (1 − R)/(1 + R) of it comes through both faces.")
        .confirmed("the passes to and fro, one by one", 1e-12, move || {
            shown(bare * (0..30).map(|k| (1.0 - r).powi(2) * r.powi(2 * k)).sum::<f64>())
        })
        .or_else("dark", 0.0)
        .or_else("no pane", shown(bare))
        .claims(Claim::AveragesPolarisation)
        .sees(0.01),
    ]
}

/// What a point of intensity 1 gives the meter at the origin, which faces up.
fn from_point(position: Vec3) -> f64 {
    position[2].max(0.0) / dot(position, position).powf(1.5)
}

fn mirrors() -> Vec<Truth> {
    let below = from_point([0.7, 0.2, 1.2]) + 0.8 * from_point([0.7, 0.2, 2.8]);
    let below_a_mirror = Scene::light_meter()
        .object(level_square([0.0, 0.0, 2.0], 60.0, false), mirror(0.8))
        .point_light([0.7, 0.2, 1.2], 1.0)
        .spp(1 << 10);
    // Two mirrors at right angles, x = 1 and y = 1.
    let lamp = [0.2, 0.4, 1.3];
    let (x, y) = (2.0 - lamp[0], 2.0 - lamp[1]);
    let first = [from_point([x, lamp[1], lamp[2]]), from_point([lamp[0], y, lamp[2]])];
    let corner = from_point(lamp) + 0.9 * first[0] + 0.7 * first[1] + 0.63 * from_point([x, y, lamp[2]]);
    let in_a_corner = Scene::light_meter()
        .object(parallelogram([1.0, -60.0, -60.0], [0.0, 0.0, 120.0], [0.0, 61.0, 0.0]), mirror(0.9))
        .object(parallelogram([-60.0, 1.0, -60.0], [0.0, 0.0, 120.0], [61.0, 0.0, 0.0]), mirror(0.7))
        .point_light(lamp, 1.0)
        .spp(1 << 10);
    vec![
        Truth::new("lamp-below-a-mirror", &below_a_mirror, shown(below), "(ρ/π) I (h/d³ + R h′/d′³)")
            .because("A flat mirror shows the lamp as far behind it as it is before it, R times as bright.")
            .confirmed("by the angles to the normal", 1e-12, || {
                let seen = |aside: f64, height: f64| aside.atan2(height).cos().powi(3) / (height * height);
                let aside = 0.7_f64.hypot(0.2);
                shown(seen(aside, 1.2) + 0.8 * seen(aside, 2.8))
            })
            .or_else("the mirror shows nothing", shown(from_point([0.7, 0.2, 1.2])))
            .or_else("the mirror loses nothing", shown(from_point([0.7, 0.2, 1.2]) + from_point([0.7, 0.2, 2.8])))
            .or_else("the lamp as far as its mirror", shown(1.8 * from_point([0.7, 0.2, 1.2])))
            .sees(0.01),
        Truth::new(
            "lamp-in-a-corner-of-mirrors",
            &in_a_corner,
            shown(corner),
            "(ρ/π) I Σ R h/d³ over the lamp and three images",
        )
        .because("Each mirror shows the lamp, and the two together show it once more behind the edge, by R₁R₂.")
        .confirmed("by the angles to the normal", 1e-12, move || {
            let seen = |a: f64, b: f64| a.hypot(b).atan2(lamp[2]).cos().powi(3) / (lamp[2] * lamp[2]);
            shown(seen(lamp[0], lamp[1]) + 0.9 * seen(x, lamp[1]) + 0.7 * seen(lamp[0], y) + 0.63 * seen(x, y))
        })
        .or_else("no image behind the edge", shown(corner - 0.63 * from_point([x, y, lamp[2]])))
        .or_else("that image twice, by each order of the mirrors", shown(corner + 0.63 * from_point([x, y, lamp[2]])))
        .sees(0.01),
        sun_by_a_mirror_ball(),
    ]
}

/// A ball or rod across parallel light that comes down from above, its middle above the meter by `ABOVE_M`.
#[derive(Clone, Copy)]
struct Round {
    /// Whether the light spreads in the one plane only.
    is_rod: bool,
    /// Whether it is a mirror.
    mirrors: bool,
    aside_m: f64,
}

impl Round {
    const RADIUS_M: f64 = 0.5;
    const ABOVE_M: f64 = 1.0;
    /// Chords inside, beyond which less than 1e-8 is left.
    const CHORDS: i32 = 8;

    fn orders(&self) -> std::ops::RangeInclusive<i32> {
        if self.mirrors { 0..=0 } else { 0..=Self::CHORDS }
    }

    /// Where a ray arrives that comes in `b` beside the middle and takes some chords inside (none: it is reflected outside), by how much more that
    /// is for more b, and the share of light; `None` if it does not go down. The ray leaves as far from the middle as it came, turned by
    /// D = 2(i − t) + (k − 1)(π − 2t).
    fn ray(&self, b: f64, chords: i32) -> Option<(f64, f64, f64)> {
        let (r, h) = (Self::RADIUS_M, Self::ABOVE_M);
        let i = (b / r).asin();
        let i_grows = 1.0 / (r * i.cos());
        let powers = fresnel_exact(i.cos(), INDEX);
        let reflectance = if self.mirrors { 0.9 } else { powers.reflectance() };
        let (turned, turned_grows, share) = if chords == 0 {
            (2.0 * i - PI, 2.0 * i_grows, reflectance)
        } else {
            let t = (b / (r * INDEX)).asin();
            let t_grows = 1.0 / (r * INDEX * t.cos());
            let more = f64::from(chords - 1);
            (
                2.0 * (i - t) + more * (PI - 2.0 * t),
                2.0 * (i_grows - t_grows) - 2.0 * more * t_grows,
                (1.0 - reflectance).powi(2) * reflectance.powi(chords - 1),
            )
        };
        let (sine, cosine) = turned.sin_cos();
        if cosine <= 0.0 {
            return None;
        }
        let x = (b - h * sine) / cosine;
        let grows =
            ((1.0 - h * cosine * turned_grows) * cosine + (b - h * sine) * sine * turned_grows) / (cosine * cosine);
        Some((x, grows, share))
    }

    /// Irradiance at the meter, of 1 in the light.
    fn irradiance(&self, orders: impl Iterator<Item = i32>) -> f64 {
        /// Steps of b in which a root is looked for.
        const STEPS: usize = 20_000;
        let x = self.aside_m;
        let at = |step: usize| Self::RADIUS_M * (step as f64 + 0.5) / (STEPS as f64 + 1.0);
        let mut sum = if x > Self::RADIUS_M { 1.0 } else { 0.0 };
        for chords in orders {
            let miss = |b: f64, side: f64| self.ray(b, chords).map(|(arrives, ..)| arrives - side * x);
            for (step, side) in (0..STEPS).flat_map(|step| [(step, 1.0), (step, -1.0)]) {
                let (mut low, mut high) = (at(step), at(step + 1));
                let (Some(below), Some(above)) = (miss(low, side), miss(high, side)) else { continue };
                if below * above > 0.0 {
                    continue;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    let Some(there) = miss(middle, side) else { break };
                    if (there > 0.0) == (above > 0.0) { high = middle } else { low = middle }
                }
                let b = 0.5 * (low + high);
                let Some((_, grows, share)) = self.ray(b, chords) else { continue };
                let spread = if self.is_rod { 1.0 } else { b / x };
                sum += share * spread / grows.abs();
            }
        }
        sum
    }

    /// The same by rays that are reflected and refracted by vectors: the flux between neighbours that arrive on both sides of the meter.
    fn by_rays(&self) -> f64 {
        const STEPS: usize = 200_000;
        let x = self.aside_m;
        let mut sum = if x > Self::RADIUS_M { 1.0 } else { 0.0 };
        for chords in self.orders() {
            let mut before: Option<(f64, f64, f64)> = None;
            for step in 0..STEPS {
                let b = Self::RADIUS_M * (step as f64 + 0.5) / STEPS as f64;
                let ray = self.traced(b, chords).map(|(arrives, share)| (b, arrives, share));
                if let (Some((b_0, x_0, share_0)), Some((b_1, x_1, share_1))) = (before, ray) {
                    for side in [x, -x] {
                        if (x_0 - side) * (x_1 - side) <= 0.0 && x_0 != x_1 {
                            let part = (side - x_0) / (x_1 - x_0);
                            let (b, share) = (b_0 + part * (b_1 - b_0), share_0 + part * (share_1 - share_0));
                            let flux = (b_1 - b_0) * if self.is_rod { 1.0 } else { b / x };
                            sum += share * flux / (x_1 - x_0).abs();
                        }
                    }
                }
                before = ray;
            }
        }
        sum
    }

    fn traced(&self, b: f64, chords: i32) -> Option<(f64, f64)> {
        let r = Self::RADIUS_M;
        let mut p = [b, 0.0, (r * r - b * b).sqrt()];
        let mut d = [0.0, 0.0, -1.0];
        let normal = scale(1.0 / r, p);
        let cosine = -dot(d, normal);
        let reflectance = if self.mirrors { 0.9 } else { fresnel_exact(cosine, INDEX).reflectance() };
        let mirrored = |d: Vec3, n: Vec3| add(d, scale(-2.0 * dot(d, n), n));
        let share = if chords == 0 {
            d = mirrored(d, normal);
            reflectance
        } else {
            d = refracted(d, normal, INDEX);
            for chord in 1..=chords {
                p = add(p, scale(-2.0 * dot(p, d), d));
                let inward = scale(-1.0 / r, p);
                d = if chord == chords { refracted(d, inward, 1.0 / INDEX) } else { mirrored(d, inward) };
            }
            (1.0 - reflectance).powi(2) * reflectance.powi(chords - 1)
        };
        (d[2] < 0.0).then(|| (p[0] + d[0] / -d[2] * (p[2] + Self::ABOVE_M), share))
    }

    fn scene(&self) -> Scene {
        let middle = [-self.aside_m, 0.0, Self::ABOVE_M];
        let (near, far) = ([middle[0], -80.0, middle[2]], [middle[0], 80.0, middle[2]]);
        let shape = if self.is_rod { cylinder(near, far, Self::RADIUS_M) } else { sphere(middle, Self::RADIUS_M) };
        Scene::light_meter()
            .object(shape, if self.mirrors { mirror(0.9) } else { glass(INDEX) })
            .directional_light([0.0, 0.0, -1.0], 1.0)
            .spp(1 << 10)
    }

    fn truth(self, name: &str, formula: &str, because: &'static str) -> Truth {
        let value = self.irradiance(self.orders());
        let direct = if self.aside_m > Self::RADIUS_M { 1.0 } else { 0.0 };
        Truth::new(name, &self.scene(), shown(value), formula)
            .because(because)
            .confirmed("rays reflected and refracted by vectors, the flux between neighbours", 1e-5, move || {
                shown(self.by_rays())
            })
            .or_else("no light by way of it", shown(direct))
            .or_else("twice the light by way of it", shown(2.0 * value - direct))
            .sees(0.01)
    }
}

fn sun_by_a_mirror_ball() -> Truth {
    Round { is_rod: false, mirrors: true, aside_m: 1.2 }.truth(
        "sun-by-a-mirror-ball",
        "(ρ/π) E (1 + R b/(x |dx/db|))",
        "Light that comes in b beside the middle of a ball leaves it turned by 2 asin(b/r) − π. A ring dx wide receives what came in through a ring db \
         wide.",
    )
}

fn rounds() -> Vec<Truth> {
    let because = "Light that comes in b beside the middle leaves as far from it, turned by 2(i − t) + (k − 1)(π − 2t) after k chords, or reflected \
         outside. What came in between b and b + db arrives between x and x + dx. The faces transmit 1 − R each, and every reflection inside leaves R.";
    let averages = |truth: Truth| truth.claims(Claim::AveragesPolarisation);
    let glass_ball = |aside_m, name| {
        let round = Round { is_rod: false, mirrors: false, aside_m };
        averages(round.truth(name, "(ρ/π) E Σ T b/(x |dx/db|)", because))
    };
    let rod = Round { is_rod: true, mirrors: false, aside_m: 0.12 };
    // Every way that light leaves the middle by is along a radius.
    let from_the_middle = 1.0 / 1.25_f64.powf(1.5);
    let r = fresnel_exact(1.0, INDEX).reflectance();
    let middle = Scene::light_meter()
        .object(sphere([0.5, 0.0, 1.0], 0.4), glass(INDEX))
        .point_light([0.5, 0.0, 1.0], 1.0)
        .spp(1 << 10);
    vec![
        glass_ball(0.1, "sun-through-a-ball-lens"),
        glass_ball(0.35, "sun-through-a-ball-lens-farther-aside"),
        averages(rod.truth("sun-through-a-glass-rod", "(ρ/π) E Σ T/|dx/db|", because)),
        Truth::new("lamp-in-the-middle-of-a-glass-ball", &middle, shown(from_the_middle), "(ρ/π) I h/d³")
            .because("Light from the middle meets the surface along its normal. What is reflected comes back to the middle, and leaves the next time.")
            .confirmed("the passes to and fro, one by one", 1e-12, move || {
                shown((0..40).map(|k| (1.0 - r) * r.powi(k)).sum::<f64>() / 1.25_f64.powf(1.5))
            })
            .or_else("light that goes to and fro left out", shown((1.0 - r) * from_the_middle))
            .or_else("radiance not spread by n²", shown(from_the_middle) / (INDEX * INDEX))
            .or_else("dark", 0.0)
            .sees(0.01),
    ]
}

/// A Gaussian beam that goes through a prism of N-BK7 at least deviation for 587.5618 nm, in another line; the meter stands where the axis would
/// land by that wavelength.
fn beams_through_a_prism() -> Vec<Truth> {
    const DISTANCE_M: f64 = 1.0;
    const RADIUS_M: f64 = 0.01;
    let half_deviation = |n: f64| (0.5 * n).asin() - 30.0_f64.to_radians();
    let design = half_deviation(bk7(587.5618));
    let incidence = design + 30.0_f64.to_radians();
    // The incidence inside the second face, and the angle of what leaves it, for an index.
    let inside = |n: f64| 60.0_f64.to_radians() - (incidence.sin() / n).asin();
    let leaves = move |n: f64| (n * inside(n).sin()).asin();
    let share = |distance: f64, radius: f64| 2.0 * (-2.0 * (distance / radius).powi(2)).exp() / (PI * radius * radius);
    let irradiance = move |n: f64| {
        let error = leaves(n) - incidence;
        // The first face widens the beam by cos t/cos i, the second narrows it by cos i'/cos t'.
        let first = (incidence.sin() / n).asin();
        let narrower = first.cos() / incidence.cos() * leaves(n).cos() / inside(n).cos();
        // How far the axis lands from the meter toward the prism's base, and where the ray came in that lands at the meter.
        let moved = exit_shift(n, incidence);
        let aside = moved * incidence.cos() + (DISTANCE_M - moved * incidence.sin()) * error.tan();
        let across = aside * error.cos() / narrower;
        let transmitted =
            fresnel_exact(incidence.cos(), n).transmittance() * fresnel_exact(inside(n).cos(), 1.0 / n).transmittance();
        share(across, RADIUS_M) / narrower * error.cos() * transmitted
    };
    [486.1327, 587.5618, 656.2725]
        .map(|wavelength_nm| {
            let n = bk7(wavelength_nm);
            let traced = move || shown(prism_by_rays(n, design, DISTANCE_M, |b| share(b, RADIUS_M)));
            Truth::new(
                format!("gaussian-beam-through-a-prism-at-{wavelength_nm}-nanometres"),
                &prism_scene(design, DISTANCE_M, RADIUS_M).band([wavelength_nm - 5e-4, wavelength_nm + 5e-4]),
                shown(irradiance(n)),
                "(ρ/π) T₁T₂ 2Φ exp(−2b²/w²)/(πw²), b where the ray came in that lands at the meter",
            )
            .because(
                "A prism bends each line by an angle of its own. The meter faces the light of the design line along its axis, so that light of another \
                 line lands beside it by about the distance times the difference of the angles.",
            )
            .confirmed("Snell's law in vector form at both faces, from the meter back to the beam", 1e-6, traced)
            .or_else("the index of another line", shown(irradiance(bk7(if wavelength_nm > 600.0 { 486.1327 } else { 656.2725 }))))
            .or_else("index too large by 1e-3", shown(irradiance(n + 1e-3)))
            .or_else("dark", 0.0)
            .claims(Claim::AveragesPolarisation)
            .claims(Claim::Dispersion)
            .sees(0.02)
        })
        .into()
}

/// The apex of the prism is this far above the middle ray of the design line, along that ray's bisector.
const BELOW_APEX_M: f64 = 0.4;

/// How much farther from the apex than that of the design line the axis leaves the second face, for an index.
fn exit_shift(n: f64, incidence: f64) -> f64 {
    // Both faces meet at the apex by 60°. The axis meets the first at s from it, and leaves the second at s'.
    let s = BELOW_APEX_M / 30.0_f64.to_radians().cos();
    let first = (incidence.sin() / n).asin();
    let second = 60.0_f64.to_radians() - first;
    // The triangle of the apex and the two points has the angles 60°, 90° − t and 90° − t'.
    s * first.cos() / second.cos() - s
}

/// The directions of the design line: into the prism and out of it, in a frame whose x is the ray inside and whose y points to the apex.
fn prism_ways(design: f64) -> [Vec3; 2] {
    [[design.cos(), design.sin(), 0.0], [design.cos(), -design.sin(), 0.0]]
}

/// Where the design line meets the faces, in that frame.
fn prism_faces() -> [Vec3; 2] {
    let half = BELOW_APEX_M * 30.0_f64.to_radians().tan();
    [[-half, 0.0, 0.0], [half, 0.0, 0.0]]
}

/// Irradiance at the meter by tracing from there back to the beam, of the profile `share` over the distance from its axis.
fn prism_by_rays(n: f64, design: f64, distance_m: f64, share: impl Fn(f64) -> f64) -> f64 {
    let ([inward, outward], [enters, exits]) = (prism_ways(design), prism_faces());
    let (s, c) = 30.0_f64.to_radians().sin_cos();
    let (first, second) = ([-c, s, 0.0], [c, s, 0.0]);
    // The axis of this line through the prism.
    let within = refracted(inward, first, n);
    let out = refracted(within, scale(-1.0, second), 1.0 / n);
    // The meter, and back along the direction in which all of this line leaves.
    let meter = add(exits, scale(distance_m, outward));
    let meets = |p: Vec3, d: Vec3, on: Vec3, normal: Vec3| {
        add(p, scale(dot(add(on, scale(-1.0, p)), normal) / dot(d, normal), d))
    };
    let enters_beside = |meter: Vec3| {
        let left = meets(meter, out, exits, second);
        let entered = meets(left, within, enters, first);
        let across = [-inward[1], inward[0], 0.0];
        dot(add(entered, scale(-1.0, enters)), across)
    };
    let across = [-outward[1], outward[0], 0.0];
    let h = 1e-4;
    let grows =
        (enters_beside(add(meter, scale(h, across))) - enters_beside(add(meter, scale(-h, across)))) / (2.0 * h);
    let transmitted = fresnel_exact(-dot(inward, first), n).transmittance()
        * fresnel_exact(dot(within, second), 1.0 / n).transmittance();
    share(enters_beside(meter)) * grows.abs() * transmitted
}

/// The prism, turned so that the design line arrives at the meter along its normal.
fn prism_scene(design: f64, distance_m: f64, radius_m: f64) -> Scene {
    let ([inward, outward], [enters, exits]) = (prism_ways(design), prism_faces());
    let meter = add(exits, scale(distance_m, outward));
    // To the meter's frame: −outward is +z, what is across it +x, the prism's axis y.
    let across = [-outward[1], outward[0], 0.0];
    let turned = |d: Vec3| [dot(d, across), d[2], -dot(d, outward)];
    let placed = |p: Vec3| turned(add(p, scale(-1.0, meter)));
    let half = 2.0 * 30.0_f64.to_radians().tan();
    let apex_side = |depth: f64, aside: f64| [aside, BELOW_APEX_M - depth, 0.0];
    let corners = [apex_side(2.0, -half), apex_side(2.0, half), apex_side(0.0, 0.0)];
    let prism = triangular_prism_at(&corners.map(placed));
    let position = placed(add(enters, scale(-0.5, inward)));
    let glass =
        sellmeier_glass([1.039_612_12, 0.231_792_344, 1.010_469_45], [0.006_000_698_67, 0.020_017_914_4, 103.560_653]);
    Scene::light_meter()
        .object(prism, glass)
        .light(json!({
            "type": "beam", "position_m": position, "direction": turned(inward), "radius_m": radius_m, "profile": "gaussian", "power": 1.0,
        }))
        .film(16, 16)
        .spp(1 << 10)
}

/// A prism along y over a triangle.
fn triangular_prism_at(corners: &[Vec3; 3]) -> Value {
    let moved = |by: f64| corners.map(|corner| [corner[0], by, corner[2]]);
    let vertices: Vec<Vec3> = moved(-1.0).into_iter().chain(moved(1.0)).collect();
    let mut prism = triangular_prism([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [0.0, 1.0]);
    prism["vertices_m"] = json!(vertices);
    // Seen along +y, corners that run counter-clockwise in x and z run the other way.
    let twice = |a: Vec3, b: Vec3, c: Vec3| (b[0] - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (b[2] - a[2]);
    let reversed = twice(corners[0], corners[1], corners[2]) > 0.0;
    if reversed && let Some(triangles) = prism["triangles"].as_array_mut() {
        for triangle in triangles {
            if let Some(triangle) = triangle.as_array_mut() {
                triangle.swap(1, 2);
            }
        }
    }
    prism
}

/// A layer of thin fog above a mirror, in parallel light.
fn fog_above_a_mirror() -> Truth {
    const DEPTH: f64 = 0.7;
    const ALBEDO: f64 = 1e-4;
    let (mu, mu_0, r) = (0.8, 0.6, 0.9);
    // What comes to an optical depth along a cosine, straight and by way of the mirror.
    let arrives = move |depth: f64, mu: f64| (-depth / mu).exp() + r * (-(2.0 * DEPTH - depth) / mu).exp();
    let of = |k: f64, at: f64| if k == 0.0 { DEPTH * at } else { at * (1.0 - (-k * DEPTH).exp()) / k };
    // ∫ e^(−ks) ds of the four products; the mirrored ones grow with depth.
    let both = 1.0 / mu + 1.0 / mu_0;
    let lost = |mu: f64| (-2.0 * DEPTH / mu).exp();
    let integral = of(both, 1.0)
        + r * of(1.0 / mu - 1.0 / mu_0, lost(mu_0))
        + r * of(1.0 / mu_0 - 1.0 / mu, lost(mu))
        + r * r * of(-both, lost(mu) * lost(mu_0));
    let radiance = move |integral: f64| ALBEDO / (4.0 * PI) * 1e4 / mu * integral;
    let straight = of(both, 1.0);
    let fog = medium(ALBEDO, 1.0 - ALBEDO, &isotropic());
    let scene = Scene::orthographic([0.6, 0.0, 3.0], [0.0, 0.0, 3.0 - 0.8], 0.1)
        .thing(json!({ "shape": block([-500.0, -500.0, 0.0], [500.0, 500.0, DEPTH]), "material": boundary(&fog) }))
        .object(level_square([0.0, 0.0, -0.1], 500.0, true), mirror(r))
        .directional_light([-0.8, 0.0, -0.6], 1e4)
        .film(16, 16)
        .spp(1 << 10);
    Truth::new("fog-above-a-mirror", &scene, radiance(integral), "(ϖE/4πμ) ∫ (e^(−s/μ₀) + R e^(−(2τ − s)/μ₀))(e^(−s/μ) + R e^(−(2τ − s)/μ)) ds")
        .because("Light comes to each depth straight and by way of the mirror, and what it scatters comes to the eye in both ways.")
        .confirmed("by quadrature over depth", 1e-9, move || {
            let scattered = |s: f64| arrives(s, mu) * arrives(s, mu_0);
            radiance(crate::quadrature::interval(scattered, 0.0, DEPTH, 1e-12).value)
        })
        .or_else("no light by way of the mirror to the fog", radiance(straight + r * of(1.0 / mu_0 - 1.0 / mu, lost(mu))))
        .or_else("nothing lost before the mirror", radiance(integral + r * of(1.0 / mu - 1.0 / mu_0, 1.0 - lost(mu_0))))
        .allows(2e-4, "light scattered twice has an albedo of 1e-4 more, the edges are 500 m away")
        .claims(Claim::Scattering)
        .sees(0.01)
}
