//! The sky of Preetham, Shirley and Smits (SIGGRAPH 1999), and CIE daylight by its colour temperature.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};

use super::cie171::LUX;
use super::expectation::Expectation;
use super::meters::measured;
use super::photometric_weight;
use super::scene::Scene;
use super::skylight::{direction, midpoints};
use super::{Claim, Truth};
use crate::quadrature::rectangle;
use crate::vector::{Vec3, dot, normalize};

/// S₀, S₁ and S₂ from 360 to 830 nm in steps of 10 nm (CIE 15, components of daylight); linear in between.
const COMPONENTS: [[f64; 3]; 48] = [
    [61.5, 38.0, 5.3],
    [68.8, 42.4, 6.1],
    [63.4, 38.5, 3.0],
    [65.8, 35.0, 1.2],
    [94.8, 43.4, -1.1],
    [104.8, 46.3, -0.5],
    [105.9, 43.9, -0.7],
    [96.8, 37.1, -1.2],
    [113.9, 36.7, -2.6],
    [125.6, 35.9, -2.9],
    [125.5, 32.6, -2.8],
    [121.3, 27.9, -2.6],
    [121.3, 24.3, -2.6],
    [113.5, 20.1, -1.8],
    [113.1, 16.2, -1.5],
    [110.8, 13.2, -1.3],
    [106.5, 8.6, -1.2],
    [108.8, 6.1, -1.0],
    [105.3, 4.2, -0.5],
    [104.4, 1.9, -0.3],
    [100.0, 0.0, 0.0],
    [96.0, -1.6, 0.2],
    [95.1, -3.5, 0.5],
    [89.1, -3.5, 2.1],
    [90.5, -5.8, 3.2],
    [90.3, -7.2, 4.1],
    [88.4, -8.6, 4.7],
    [84.0, -9.5, 5.1],
    [85.1, -10.9, 6.7],
    [81.9, -10.7, 7.3],
    [82.6, -12.0, 8.6],
    [84.9, -14.0, 9.8],
    [81.3, -13.6, 10.2],
    [71.9, -12.0, 8.3],
    [74.3, -13.3, 9.6],
    [76.4, -12.9, 8.5],
    [63.3, -10.6, 7.0],
    [71.7, -11.6, 7.6],
    [77.0, -12.2, 8.0],
    [65.2, -10.2, 6.7],
    [47.7, -7.8, 5.2],
    [68.6, -11.2, 7.4],
    [65.0, -10.4, 6.8],
    [66.0, -10.6, 7.0],
    [61.0, -9.7, 6.4],
    [53.3, -8.3, 5.5],
    [58.9, -9.3, 6.1],
    [61.9, -9.8, 6.5],
];

fn component(part: usize, nm: f64) -> f64 {
    let x = ((nm - 360.0) / 10.0).clamp(0.0, 46.999_999);
    let i = x as usize;
    COMPONENTS[i][part] + (x - i as f64) * (COMPONENTS[i + 1][part] - COMPONENTS[i][part])
}

/// The mean of a component as the observer weighs it.
fn weighed(part: usize) -> f64 {
    (0..=470).map(|i| f64::from(360 + i)).map(|nm| photometric_weight(nm) * component(part, nm)).sum()
}

/// A sky over a world whose zenith is +z.
#[derive(Clone, Copy)]
struct Daylight {
    turbidity: f64,
    sun: Vec3,
    ground: f64,
    /// Y (cd·m⁻²), x and y: of the zenith, over the formula's value there; and the numbers of the formula.
    perez: [(f64, [f64; 5]); 3],
    /// ∫ S ȳ/∫ ȳ of the components.
    weighed: [f64; 3],
}

/// Perez's formula of the cosine of the angle from the zenith and the angle γ from the sun.
fn formula([a, b, c, d, e]: [f64; 5], cos: f64, gamma: f64) -> f64 {
    let gradation = if cos > 0.0 { 1.0 + a * (b / cos).exp() } else { 1.0 };
    gradation * (1.0 + c * (d * gamma).exp() + e * gamma.cos().powi(2))
}

impl Daylight {
    fn new(turbidity: f64, sun: Vec3) -> Self {
        let t = turbidity;
        let theta_s = sun[2].clamp(-1.0, 1.0).acos();
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta_s);
        let (s1, s2, s3) = (theta_s, theta_s * theta_s, theta_s.powi(3));
        let zenith = [
            1000.0 * ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192),
            t * t * (0.00166 * s3 - 0.00375 * s2 + 0.00209 * s1)
                + t * (-0.02903 * s3 + 0.06377 * s2 - 0.03202 * s1 + 0.00394)
                + (0.11693 * s3 - 0.21196 * s2 + 0.06052 * s1 + 0.25886),
            t * t * (0.00275 * s3 - 0.00610 * s2 + 0.00317 * s1)
                + t * (-0.04214 * s3 + 0.08970 * s2 - 0.04153 * s1 + 0.00516)
                + (0.15346 * s3 - 0.26756 * s2 + 0.06670 * s1 + 0.26688),
        ];
        let numbers = [
            [
                0.1787 * t - 1.4630,
                -0.3554 * t + 0.4275,
                -0.0227 * t + 5.3251,
                0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703,
            ],
            [
                -0.0193 * t - 0.2592,
                -0.0665 * t + 0.0008,
                -0.0004 * t + 0.2125,
                -0.0641 * t - 0.8989,
                -0.0033 * t + 0.0452,
            ],
            [
                -0.0167 * t - 0.2608,
                -0.0950 * t + 0.0092,
                -0.0079 * t + 0.2102,
                -0.0441 * t - 1.6537,
                -0.0109 * t + 0.0529,
            ],
        ];
        let perez = [0, 1, 2].map(|i| (zenith[i] / formula(numbers[i], 1.0, theta_s), numbers[i]));
        Self { turbidity, sun, ground: 0.0, perez, weighed: [0, 1, 2].map(weighed) }
    }

    /// Y (cd·m⁻²), x and y.
    fn colour(&self, toward: Vec3) -> [f64; 3] {
        [0, 1, 2].map(|part| self.part(part, toward))
    }

    /// One of them.
    fn part(&self, part: usize, toward: Vec3) -> f64 {
        let gamma = dot(toward, self.sun).clamp(-1.0, 1.0).acos();
        let (level, numbers) = self.perez[part];
        level * formula(numbers, toward[2], gamma)
    }

    /// Spectral radiance per nm, in units of cd·m⁻² over 683.002 lm/W ∫ȳ.
    fn radiance(&self, toward: Vec3, nm: f64) -> f64 {
        if toward[2] < 0.0 {
            return self.ground * self.radiance([0.0, 0.0, 1.0], nm);
        }
        let [luminance, x, y] = self.colour(toward);
        let over = 0.0241 + 0.2562 * x - 0.7341 * y;
        let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / over;
        let m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / over;
        let shape = |s: [f64; 3]| s[0] + m1 * s[1] + m2 * s[2];
        luminance * shape([0, 1, 2].map(|part| component(part, nm))) / shape(self.weighed)
    }

    fn luminance(&self, toward: Vec3) -> f64 {
        if toward[2] < 0.0 { self.ground * self.part(0, [0.0, 0.0, 1.0]) } else { self.part(0, toward) }
    }

    /// ∫ L cos θ over the upper half of the sky, on a plane of this normal.
    fn irradiance(normal: Vec3, radiance: impl Fn(Vec3) -> f64) -> f64 {
        // In units of the zenith's, since tolerances are absolute.
        let unit = radiance([0.0, 0.0, 1.0]);
        let over = |sin: f64, turns: f64| {
            // Over the square of the sine of the elevation: b/cos Z is steep at the horizon.
            let height = sin * sin;
            let level = (1.0 - height * height).sqrt();
            let toward = [level * (TAU * turns).cos(), level * (TAU * turns).sin(), height];
            2.0 * sin * TAU * radiance(toward) / unit * dot(toward, normal).max(0.0)
        };
        unit * rectangle(over, [0.0, 1.0], [0.0, 1.0], 2e-5, 400_000).value
    }

    /// The same by midpoints over both angles.
    fn irradiance_by_midpoints(normal: Vec3, radiance: impl Fn(Vec3) -> f64) -> f64 {
        midpoints([1000, 600], normal, radiance)
    }

    fn json(&self) -> Value {
        let mut form = json!({ "turbidity": self.turbidity, "sun_direction": self.sun, "up": [0, 0, 1] });
        if self.ground > 0.0 {
            form["ground"] = json!(self.ground);
        }
        form
    }
}

pub(super) fn truths() -> Vec<Truth> {
    let mut list = looks();
    list.extend(falls());
    list.extend(temperatures());
    list
}

/// A band so narrow that it counts as one wavelength, nm.
fn at(nm: f64) -> [f64; 2] {
    [nm - 5e-4, nm + 5e-4]
}

fn truth(
    name: String,
    scene: &Scene,
    formula: &str,
    value: impl FnOnce() -> f64 + Send + 'static,
    (mistake, mistaken): (&'static str, impl FnOnce(f64) -> f64 + Send + 'static),
) -> Truth {
    let work_out = move || {
        let value = value();
        Expectation::new(value)
            .allows(1e-4 * value, "2e-5 for single precision, 2e-5 for quadratures, and the width of a meter's cone")
            .or_else(mistake, mistaken(value))
    };
    Truth::later(name, scene, formula, work_out)
        .because(
            "Luminance and chromaticity of the sky are Perez's formula of the angles from the zenith and from the sun, with the numbers of the \
             paper; the spectrum of each chromaticity is the daylight S₀ + M₁S₁ + M₂S₂ of the CIE.",
        )
        .sees(0.005)
}

/// Seen in single directions.
fn looks() -> Vec<Truth> {
    let sun = direction(40.0, 25.0);
    let places = [
        ("zenith", [0.0, 0.0, 1.0]),
        ("near-the-sun", direction(46.0, 17.0)),
        ("opposite-the-sun", direction(20.0, 205.0)),
        ("at-the-horizon", direction(3.0, 100.0)),
    ];
    let mut list = Vec::new();
    for (turbidity, (place, toward)) in [2.0, 3.0, 6.0, 3.5].into_iter().zip(places) {
        let sky = Daylight::new(turbidity, sun);
        let meter = json!({ "type": "radiance", "position_m": [0, 0, 0], "direction": toward, "full_angle_deg": 0.01 });
        let scene =
            || measured(std::slice::from_ref(&meter)).light(json!({ "type": "environment", "daylight": sky.json() }));
        let value = sky.luminance(toward) / LUX;
        let zenith = Daylight::new(turbidity + 1.0, sun).luminance(toward) / LUX;
        list.push(
            truth(
                format!("daylight-luminance-{place}"),
                &scene(),
                "Y_z F(θ, γ)/F(0, θₛ), over 683.002 lm/W · ∫ȳ dλ",
                move || value,
                ("another turbidity", move |_| zenith),
            )
            .confirmed("the spectrum, weighed with ȳ", 1e-6, move || {
                (0..=470)
                    .map(|i| f64::from(360 + i))
                    .map(|nm| photometric_weight(nm) * sky.radiance(toward, nm))
                    .sum::<f64>()
                    / LUX
            })
            .claims(Claim::PhotometricSensor),
        );
        for nm in [450.0, 655.0] {
            let value = sky.radiance(toward, nm) / LUX;
            let grey = sky.luminance(toward) / LUX;
            list.push(truth(
                format!("daylight-at-{nm}-nanometres-{place}"),
                &scene().band(at(nm)),
                "Y S(λ)/∫ S ȳ dλ",
                move || value,
                ("the same luminance without colour", move |_| grey),
            ));
        }
    }
    list
}

/// What falls on tilted meters.
fn falls() -> Vec<Truth> {
    let normal = normalize([0.5, -0.3, 0.6]);
    let mut list = Vec::new();
    for (how, band, ground) in
        [("mis", None, 0.0), ("light", Some(450.0), 0.0), ("bsdf", Some(600.0), 0.0), ("mis", Some(700.0), 0.3)]
    {
        let mut sky = Daylight::new(4.0, direction(35.0, 20.0));
        sky.ground = ground;
        let radiance = move |toward: Vec3| match band {
            None => sky.luminance(toward),
            Some(nm) => sky.radiance(toward, nm),
        };
        // What lies below the horizon gives a plane of tilt β the configuration factor (1 − cos β)/2.
        let below = PI * 0.5 * (1.0 - normal[2]) * radiance([0.0, 0.0, -1.0]);
        let meter = json!({ "type": "irradiance", "position_m": [0, 0, 0], "normal": normal });
        let scene =
            measured(&[meter]).light(json!({ "type": "environment", "daylight": sky.json() })).light_sampling(how);
        let (name, scene) = match band {
            None => (format!("daylight-on-a-plane-by-{how}"), scene),
            Some(nm) => (format!("daylight-on-a-plane-at-{nm}-nanometres-by-{how}"), scene.band(at(nm))),
        };
        let turned = Daylight { sun: [-sky.sun[0], -sky.sun[1], sky.sun[2]], ..sky };
        let elsewhere = move |toward: Vec3| match band {
            None => turned.luminance(toward),
            Some(nm) => turned.radiance(toward, nm),
        };
        let truth = truth(
            name,
            &scene,
            "∫ L(θ, γ) cos θ dω",
            move || (Daylight::irradiance(normal, radiance) + below) / LUX,
            ("the sun on the other side", move |_| (Daylight::irradiance(normal, elsewhere) + below) / LUX),
        )
        .confirmed("midpoints over both angles", 3e-4, move || {
            (Daylight::irradiance_by_midpoints(normal, radiance) + below) / LUX
        });
        list.push(if band.is_none() { truth.claims(Claim::PhotometricSensor) } else { truth });
    }
    // y up, and a scale.
    let sky = Daylight::new(2.5, direction(60.0, 0.0));
    let [x, y, z] = sky.sun;
    let form = json!({ "turbidity": 2.5, "sun_direction": [y, z, x], "scale": 0.5 });
    let meter = json!({ "type": "irradiance", "position_m": [0, 0, 0], "normal": [0, 1, 0] });
    let scene = measured(&[meter]).light(json!({ "type": "environment", "daylight": form }));
    let up = [0.0, 0.0, 1.0];
    let truth = truth(
        "daylight-of-half-its-scale-with-y-up".to_owned(),
        &scene,
        "½∫ Y cos θ dω",
        move || 0.5 * Daylight::irradiance(up, |toward| sky.luminance(toward)) / LUX,
        ("the whole scale", |value| 2.0 * value),
    )
    .confirmed("midpoints over both angles", 3e-4, move || {
        0.5 * Daylight::irradiance_by_midpoints(up, |toward| sky.luminance(toward)) / LUX
    });
    list.push(truth.claims(Claim::PhotometricSensor));
    list
}

/// D50 from 380 to 780 nm in steps of 10 nm, relative to 560 nm (CIE 15, illuminants of daylight); linear in between.
const D50: [f64; 41] = [
    24.49, 29.87, 49.31, 56.51, 60.03, 57.82, 74.82, 87.25, 90.61, 91.37, 95.11, 91.96, 95.72, 96.61, 97.13, 102.10,
    100.75, 102.32, 100.00, 97.74, 98.92, 93.50, 97.69, 99.27, 99.04, 95.72, 98.86, 95.67, 98.19, 103.00, 99.13, 87.38,
    91.60, 92.89, 76.85, 86.51, 92.58, 78.23, 57.69, 82.92, 78.27,
];

fn d50(nm: f64) -> f64 {
    let x = ((nm - 380.0) / 10.0).clamp(0.0, 39.999_999);
    let i = x as usize;
    D50[i] + (x - i as f64) * (D50[i + 1] - D50[i])
}

/// Daylight by its colour temperature.
fn temperatures() -> Vec<Truth> {
    let sky = |name: &str, nm: Option<f64>, value: f64| {
        let radiance = json!({ "type": "daylight", "temperature_k": 5002.78, "scale": 3 });
        let scene = Scene::pinhole([0.0; 3], [0.0, 0.0, -1.0], 60.0)
            .light(json!({ "type": "environment", "radiance": radiance }))
            .film(16, 16)
            .spp(4096);
        // Half a unit of the last place of each. It leaves the luminance, which depends on the middle of the range, as it is.
        let rounding =
            nm.map_or(1e-4, |nm| (0.0005 * (component(1, nm).abs() + component(2, nm).abs()) + 0.005) / d50(nm));
        let scene = nm.map_or(scene.clone(), |nm| scene.band(at(nm)));
        Truth::new(name, &scene, value, "3 S(λ)/Σȳ S · Σȳ")
            .because("Daylight of 5000 K × 1.4388/1.4380 is the illuminant D50, whose spectrum the CIE publishes.")
            .allows(rounding * value, "weights M₁ and M₂ of the published D50 have three decimals, its powers two")
            .sees(0.005)
    };
    let luminance: f64 = (0..=470).map(|i| f64::from(360 + i)).map(|nm| photometric_weight(nm) * d50(nm)).sum();
    let mut list = vec![
        sky("sky-of-daylight-of-5003-kelvin", None, 3.0)
            .or_else("the spectrum as tabulated, 100 at 560 nm", 300.0)
            .claims(Claim::PhotometricSensor),
    ];
    for nm in [410.0, 450.0, 640.0] {
        let value = 3.0 * d50(nm) / luminance;
        list.push(
            sky(&format!("sky-of-daylight-of-5003-kelvin-at-{nm}-nanometres"), Some(nm), value)
                .confirmed("the components of daylight where its locus has 5002.78 K", 5e-4, move || {
                    let per_kelvin: f64 = 1.0 / 5002.78;
                    let x = -4.6070e9 * per_kelvin.powi(3)
                        + 2.9678e6 * per_kelvin.powi(2)
                        + 0.099_11e3 * per_kelvin
                        + 0.244_063;
                    let y = -3.0 * x * x + 2.87 * x - 0.275;
                    let over = 0.0241 + 0.2562 * x - 0.7341 * y;
                    let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / over;
                    let m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / over;
                    let shape = |s: [f64; 3]| s[0] + m1 * s[1] + m2 * s[2];
                    3.0 * shape([0, 1, 2].map(|part| component(part, nm))) / shape([0, 1, 2].map(weighed))
                })
                .or_else("the same at every wavelength", 3.0),
        );
    }
    list
}
