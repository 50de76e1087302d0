//! Measured BRDFs, by files whose f has a closed form: see [`super::measured_files`].

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    measured_files::{Azimuths, Made},
    photometric_weight,
    scene::{Scene, black, disk, level_square},
};
use crate::{
    quadrature::{interval, rectangle},
    vector::{Vec3, dot, normalize, scale, sub},
};

pub(super) fn truths() -> Vec<Truth> {
    let mut list = vec![in_the_sun(), all_in_the_spectra(), overhead()];
    list.extend(under_a_sky());
    list.extend(below_a_disk());
    list.extend(spectra());
    list.extend(brushed_in_the_sun());
    list.extend(from_behind());
    list
}

const BECAUSE: &str = "The file gives f cos θ_i = S(V⁻¹(q)) D(q)/(4σ(p)), p and q the places of the viewer and of the facet half way to the \
                       light (Dupuy & Jakob 2018). Its tables hold bilinear functions exactly, so each factor is known.";

/// A direction at `tilt_deg` off +z, `turn_deg` from +x toward +y.
fn direction(tilt_deg: f64, turn_deg: f64) -> Vec3 {
    let ((sin, cos), (sin_turn, cos_turn)) = (tilt_deg.to_radians().sin_cos(), turn_deg.to_radians().sin_cos());
    [sin * cos_turn, sin * sin_turn, cos]
}

/// A square at the origin that faces up, seen from a direction.
fn plate(from: Vec3, made: &Made, further: &[(&str, Value)]) -> Scene {
    let mut material = json!({ "type": "measured", "file": made.name() });
    further.iter().for_each(|(key, value)| material[*key] = value.clone());
    Scene::orthographic(scale(2.0, from), [0.0; 3], 0.1)
        .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": material }))
        .file(&made.name(), made.file())
        .film(16, 16)
        .spp(64)
}

/// Lit by a light of irradiance 1 from a direction.
fn lit(scene: Scene, from: Vec3) -> Scene {
    scene.directional_light(from.map(|v| -v), 1.0)
}

/// f cos θ_i once more: the facet by its slopes, and the warp by adding up densities over a fine grid of the square.
fn by_sums(made: &Made, o: Vec3, i: Vec3) -> f64 {
    const STEPS: u32 = 4000;
    let mut places = made.places(o, i);
    let slope = (o[0] + i[0]).hypot(o[1] + i[1]) / (o[2] + i[2]);
    places.facet[0] = (slope.atan() / FRAC_PI_2).sqrt();
    let [x, y] = places.facet;
    let at = |step: u32, to: f64| to * (f64::from(step) + 0.5) / f64::from(STEPS);
    let sum = |to: f64, of: &dyn Fn(f64) -> f64| (0..STEPS).map(|step| of(at(step, to))).sum::<f64>() * to;
    let density = |x: f64, y: f64| Made::visible(places.viewer, [x, y]);
    let row = |to: f64| sum(to, &|x| density(x, y));
    let column = |to: f64| sum(to, &|y| density(0.5, y));
    let place = [row(x) / row(1.0), column(y) / column(1.0)];
    let facets = if made.apart { made.ndf([x, y]) / (4.0 * made.sigma(places.sigma)) } else { 1.0 };
    Made::share(places.viewer, place) * facets
}

fn in_the_sun() -> Truth {
    let made = Made::grey(Azimuths::One);
    let (o, i) = (direction(60.0, 20.0), direction(35.0, 95.0));
    let value = made.f_cos(o, i);
    let places = made.places(o, i);
    let at = |viewer: [f64; 2], place: [f64; 2]| {
        Made::share(viewer, place) * made.ndf(places.facet) / (4.0 * made.sigma(places.sigma))
    };
    let unwarped = Made::unwarped(places.viewer, places.facet);
    let again = made.clone();
    let mirrored = Made::unwarped(places.viewer, [places.facet[0], 1.0 - places.facet[1]]);
    Truth::new(
        "measured-brdf-in-the-sun",
        &lit(plate(o, &made, &[]), i),
        value,
        "S(V⁻¹(q)) D(q)/(4σ(p)), viewer 60° and light 35° off the normal, 75° apart",
    )
    .because(BECAUSE)
    .confirmed("slopes of facets, and sums of densities", 1e-6, move || by_sums(&again, o, i))
    .or_else("σ left out", value * made.sigma(places.sigma))
    .or_else("spectra read at the place of the facet, without the warp", at(places.viewer, places.facet))
    .or_else("spectra of the nearest angle", at([1.0, 0.0], Made::unwarped([1.0, 0.0], places.facet)))
    .or_else("the light in place of the viewer", made.f_cos(i, o))
    .or_else("the cosine of the light once more", value * i[2])
    .or_else("azimuths counted the other way", at(places.viewer, mirrored))
    .or_else("the density of facets at the place before the warp", value * made.ndf(unwarped) / made.ndf(places.facet))
    .sees(1e-3)
}

fn all_in_the_spectra() -> Truth {
    let made = Made { apart: false, ..Made::grey(Azimuths::One) };
    let (o, i) = (direction(50.0, -30.0), direction(20.0, 60.0));
    let value = made.f_cos(o, i);
    let apart = Made::grey(Azimuths::One).f_cos(o, i);
    let again = made.clone();
    Truth::new(
        "measured-brdf-with-all-in-its-spectra",
        &lit(plate(o, &made, &[]), i),
        value,
        "S(V⁻¹(q)): the file says that D/(4σ) is part of S",
    )
    .because(BECAUSE)
    .confirmed("slopes of facets, and sums of densities", 1e-6, move || by_sums(&again, o, i))
    .or_else("D/(4σ) counted twice", apart)
    .sees(1e-3)
}

/// ∫₀ᵇ θᵖ sin θ dθ by the series of the sine.
fn moment(p: f64, to: f64) -> f64 {
    let mut factorial = 1.0;
    let term = |k: i32| {
        let power = 2.0 * f64::from(k) + 1.0;
        if k > 0 {
            factorial *= (power - 1.0) * power;
        }
        (-1.0_f64).powi(k) * to.powf(power + 1.0 + p) / (factorial * (power + 1.0 + p))
    };
    (0..20).map(term).sum()
}

/// What a plate shows along its normal under light of radiance 1 within an angle of the normal: there x′ = θ/π, and the mean of y′ is 5/12.
fn along_the_normal(within: f64) -> f64 {
    let (even, rise) = (1.0 / 80.0 + 0.015 * 5.0 / 12.0, 1.0 / (40.0 * PI));
    let root = 2.0 / PI.sqrt();
    let [zero, half, one, more] = [0.0, 0.5, 1.0, 1.5].map(|p| moment(p, within));
    FRAC_PI_2 * (even * (3.0 * zero - root * half) + rise * (3.0 * one - root * more))
}

/// The same by quadrature of f over angles and azimuths.
fn along_the_normal_by_quadrature(within: f64) -> f64 {
    let made = Made::grey(Azimuths::One);
    let f_cos = |theta: f64, phi: f64| {
        made.f_cos([0.0, 0.0, 1.0], [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()])
    };
    let ring = |theta: f64| theta.sin() * interval(|phi| f_cos(theta, phi), -PI, PI, 1e-9).value;
    interval(ring, 0.0, within, 1e-7).value
}

fn overhead() -> Truth {
    let made = Made::grey(Azimuths::One);
    let value = along_the_normal(FRAC_PI_2);
    Truth::new(
        "measured-brdf-under-a-sky-from-above",
        &plate([0.0, 0.0, 1.0], &made, &[]).sky(1.0).spp(1024),
        value,
        "(π/2)∫(a + bθ/π)(3 − 2√(θ/π)) sin θ dθ, a = 1/80 + 1/160, b = 1/40",
    )
    .because("Along the normal σ is 1 and θ_h = θ/2. The warp makes x′ = x² = θ/π, and the mean of y′ around the normal is 5/12.")
    .confirmed("quadrature over angles and azimuths", 1e-5, || along_the_normal_by_quadrature(FRAC_PI_2))
    .or_else("cosine of the light once more", 0.5 * value)
    .or_else("solid angles of facets taken for those of light", sky(&made, [0.0, 0.0, 1.0], |o, h| 1.0 / (4.0 * dot(o, h))))
    .no_brighter_than(1.0)
    .sees(2e-3)
}

/// ∫ f cos θ g dω over the sky, g a function of the viewer and the facet: in elevations toward y, cut where azimuths begin again.
fn sky(made: &Made, o: Vec3, factor: impl Fn(Vec3, Vec3) -> f64) -> f64 {
    let from = -o[1].asin();
    let of = |alpha: f64, beta: f64| {
        let i = [beta.cos() * alpha.sin(), beta.sin(), beta.cos() * alpha.cos()];
        beta.cos() * made.f_cos(o, i) * factor(o, normalize([0, 1, 2].map(|k| o[k] + i[k])))
    };
    let part = |from: f64, to: f64| rectangle(of, [-FRAC_PI_2, FRAC_PI_2], [from, to], 1e-6, 60_000).value;
    part(-FRAC_PI_2, from) + part(from, FRAC_PI_2)
}

/// The same over the square of facets that light above the surface may meet.
fn sky_by_facets(made: &Made, o: Vec3) -> f64 {
    const STEPS: u32 = 1500;
    let at = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
    let mut sum = 0.0;
    for x in (0..STEPS).map(at) {
        let theta = FRAC_PI_2 * x * x;
        let (sin, cos) = theta.sin_cos();
        for y in (0..STEPS).map(at) {
            let phi = PI * (2.0 * y - 1.0);
            let h = [sin * phi.cos(), sin * phi.sin(), cos];
            let i = sub(scale(2.0 * dot(o, h), h), o);
            if dot(o, h) > 0.0 && i[2] > 0.0 {
                sum += made.f_cos(o, i) * 2.0 * PI * PI * x * sin * 4.0 * dot(o, h);
            }
        }
    }
    sum / f64::from(STEPS).powi(2)
}

fn under_a_sky() -> Vec<Truth> {
    let cases = [
        ("measured-brdf-under-a-sky", Azimuths::One, [60.0, 0.0, 0.0]),
        ("measured-grain-under-a-sky", Azimuths::Half, [50.0, 70.0, 0.0]),
        ("measured-grain-of-two-mirrors-under-a-sky", Azimuths::Quarter, [65.0, 130.0, 0.0]),
        ("measured-grain-turned-under-a-sky", Azimuths::All, [55.0, 75.0, 40.0]),
    ];
    let truth = |(name, azimuths, [tilt, turn, rotation]): (&str, Azimuths, [f64; 3])| {
        let made = Made::grey(azimuths);
        let further = if rotation == 0.0 { vec![] } else { vec![("tangent_rotation_deg", json!(rotation))] };
        let (seen, o) = (direction(tilt, turn), direction(tilt, turn - rotation));
        let again = made.clone();
        let truth = Truth::new(
            name,
            &plate(seen, &made, &further).sky(1.0).spp(512),
            sky(&made, o, |_, _| 1.0),
            format!("∫ S(V⁻¹(q)) D(q)/(4σ(p)) dω, seen {tilt}° off the normal, {turn}° from u toward v, the grain turned by {rotation}°"),
        )
        .because(BECAUSE)
        .confirmed("sums over the square of facets", 1e-4, move || sky_by_facets(&again, o))
        .or_else("solid angles of facets taken for those of light", sky(&made, o, |o, h| 1.0 / (4.0 * dot(o, h))))
        .no_brighter_than(1.0)
        .sees(2e-3);
        match azimuths {
            Azimuths::One => truth,
            _ => truth.or_else(
                "the grain turned by a quarter",
                sky(&made, direction(tilt, turn - rotation + 90.0), |_, _| 1.0),
            ),
        }
    };
    cases.map(truth).into()
}

/// A disk lamp above the camera, by each way to find it.
fn below_a_disk() -> Vec<Truth> {
    ["mis", "light", "bsdf"]
        .map(|how| {
            let made = Made::grey(Azimuths::One);
            let scene = Scene::orthographic([0.0, 0.0, 0.5], [0.0; 3], 1e-3)
                .thing(json!({ "shape": level_square([0.0; 3], 1.0, true), "material": { "type": "measured", "file": made.name() } }))
                .file(&made.name(), made.file())
                .lamp(disk([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 1.0), black(), 4.0, "front")
                .light_sampling(how)
                .film(16, 16)
                .spp(1024);
            let value = 4.0 * along_the_normal(FRAC_PI_4);
            Truth::new(format!("measured-brdf-below-a-disk-lamp-by-{how}"), &scene, value, "2π∫(a + bθ/π)(3 − 2√(θ/π)) sin θ dθ to 45°, L = 4")
                .because("Along the normal σ is 1 and θ_h = θ/2. The warp makes x′ = x² = θ/π, and the mean of y′ around the normal is 5/12.")
                .confirmed("quadrature over angles and azimuths", 1e-5, || 4.0 * along_the_normal_by_quadrature(FRAC_PI_4))
                .or_else("the whole sky", 4.0 * along_the_normal(FRAC_PI_2))
                .or_else("counted by both ways", 2.0 * value)
                .no_brighter_than(8.0)
                .sees(3e-3)
        })
        .into()
}

/// Bands between two wavelengths of the file, beyond its ends, and all of them.
fn spectra() -> Vec<Truth> {
    let made =
        Made { colours: vec![[420.0, 1.0], [500.0, 0.2], [560.0, 1.2], [650.0, 0.5]], ..Made::grey(Azimuths::One) };
    let (o, i) = (direction(45.0, 0.0), direction(30.0, 140.0));
    let scene = || lit(plate(o, &made, &[]), i);
    let grey = made.f_cos(o, i);
    let [all, steps] = [0.0, 1.0].map(|steps| {
        let of = |nm: f64| {
            let nearest = made.colours.iter().min_by(|a, b| (a[0] - nm).abs().total_cmp(&(b[0] - nm).abs()));
            if steps == 0.0 { made.colour(nm) } else { nearest.map_or(0.0, |[_, c]| *c) }
        };
        grey * (360..=830).map(f64::from).map(|nm| photometric_weight(nm) * of(nm)).sum::<f64>()
    });
    let again = made.clone();
    let mut list = vec![
        Truth::new(
            "measured-brdf-of-a-colour-in-the-sun",
            &scene(),
            all,
            "f cos θ_i ∫ȳc dλ/∫ȳ dλ, c from 0.2 to 1.2 at four wavelengths",
        )
        .because(
            "Spectra are linear between the wavelengths of the file, and beyond these they keep their last values.",
        )
        .confirmed("the midpoints of a quarter of a nanometre", 1e-4, move || {
            let nm = |step: u32| 360.0 + (f64::from(step) + 0.5) / 4.0;
            by_sums(&again, o, i)
                * (0..1880).map(nm).map(|nm| 0.25 * photometric_weight(nm) * again.colour(nm)).sum::<f64>()
        })
        .or_else("the nearest wavelength", steps)
        .claims(Claim::PhotometricSensor)
        .sees(3e-3),
    ];
    for (nm, instead) in [(400.0, 1.2), (470.0, 0.2), (530.0, 1.2), (600.0, 1.2), (700.0, 0.0)] {
        let value = grey * made.colour(nm);
        let again = made.clone();
        list.push(
            Truth::new(
                format!("measured-brdf-at-{nm}-nanometres"),
                &scene().band([nm - 5e-4, nm + 5e-4]),
                value,
                format!("f cos θ_i c({nm} nm)"),
            )
            .because(
                "Spectra are linear between the wavelengths of the file, and beyond these they keep their last values.",
            )
            .confirmed("slopes of facets, and sums of densities", 1e-6, move || {
                by_sums(&again, o, i) * again.colour(nm)
            })
            .or_else(
                if nm < 420.0 { "continued beyond the first wavelength" } else { "a neighbouring wavelength, or none" },
                grey * instead,
            )
            .sees(2e-3),
        );
    }
    list
}

/// Viewers in other quadrants than that of the tables.
fn brushed_in_the_sun() -> Vec<Truth> {
    let cases = [
        ("measured-grain-in-the-sun", Azimuths::Half, 70.0),
        ("measured-grain-in-the-sun-from-the-other-side", Azimuths::Half, -110.0),
        ("measured-grain-of-two-mirrors-in-the-sun", Azimuths::Quarter, 35.0),
        ("measured-grain-of-one-mirror-in-the-sun", Azimuths::Quarter, 160.0),
        ("measured-grain-without-symmetry-in-the-sun", Azimuths::All, 125.0),
    ];
    let truth = |(name, azimuths, turn): (&str, Azimuths, f64)| {
        let made = Made::grey(azimuths);
        let (o, i) = (direction(55.0, turn), direction(40.0, turn + 110.0));
        let value = made.f_cos(o, i);
        let again = made.clone();
        let unturned = Made::grey(Azimuths::All).f_cos(o, i);
        let truth = Truth::new(
            name,
            &lit(plate(o, &made, &[]), i),
            value,
            format!("S(V⁻¹(q)) D(q)/(4σ(p)), viewer 55° off the normal and {turn}° from u toward v, light 40° off it and 110° further"),
        )
        .because("A file with azimuths over half of the circle holds for a surface that half a turn does not change. One with a quarter holds for a surface that two mirrors do not change. Viewers elsewhere are turned or mirrored, and lights with them.")
        .confirmed("slopes of facets, and sums of densities", 1e-6, move || by_sums(&again, o, i))
        .or_else("the light turned, and not the viewer", made.f_cos(o, direction(40.0, turn - 70.0)))
        .or_else("azimuths counted from v", made.f_cos(direction(55.0, turn - 90.0), direction(40.0, turn + 20.0)))
        .or_else("azimuths counted from v toward u", made.f_cos(direction(55.0, 90.0 - turn), direction(40.0, -20.0 - turn)))
        .sees(1e-3);
        if azimuths == Azimuths::All {
            truth
        } else {
            truth.or_else("as if the file reached around the circle", unturned)
        }
    };
    cases.map(truth).into()
}

/// The side that was not measured: black, unless the scene says otherwise.
fn from_behind() -> Vec<Truth> {
    let made = Made::grey(Azimuths::One);
    let (o, i) = (direction(50.0, 10.0), direction(30.0, 80.0));
    let below = |[x, y, z]: Vec3| [x, y, -z];
    let value = made.f_cos(o, i);
    let dark = Truth::new("measured-brdf-from-behind", &lit(plate(below(o), &made, &[]), below(i)), 0.0, "0")
        .because("The back of a measured surface was not measured: it is black.")
        .or_else("as bright as the front", value);
    let lit = ["both", "back"].map(|sides| {
        let again = made.clone();
        Truth::new(
            format!("measured-brdf-on-{sides}-from-behind"),
            &lit(plate(below(o), &made, &[("sides", json!(sides))]), below(i)),
            value,
            "S(V⁻¹(q)) D(q)/(4σ(p)) of the directions mirrored in the surface",
        )
        .because("A back that reflects is the mirror image of the front in the plane of the surface.")
        .confirmed("slopes of facets, and sums of densities", 1e-6, move || by_sums(&again, o, i))
        .or_else("black", 0.0)
        .sees(1e-3)
    });
    std::iter::once(dark).chain(lit).collect()
}
