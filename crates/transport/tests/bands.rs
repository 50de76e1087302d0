//! Bands of wavelengths: what a film keeps of each is the mean radiance over it.

use etalon_optics::Spectrum;
use etalon_optics::colour::{cie_y_integral_nm, colour_matching};
use etalon_optics::spectrum::Illuminant;
use etalon_oracle::statistics::Welford;
use etalon_scene::{Bands, Scene};
use etalon_transport::wavelength::WavelengthDistribution;
use etalon_transport::{Control, EffectName, Film, Prepared, Study, prepare_study};
use serde_json::{Value, json};

fn scene(json: &Value) -> Scene {
    etalon_scene::parse(&json.to_string(), "test").unwrap_or_else(|e| panic!("{e:?}")).0
}

/// A grey convex body under a sky: with reflectance 1 a furnace, in which every pixel shows the sky.
fn furnace(sky: &Value, bands: &Value) -> Scene {
    scene(&json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
        "film": {"width": 12, "height": 8, "bands_nm": bands},
        "objects": [{"shape": {"type": "sphere", "radius_m": 1}, "material": {"type": "lambert", "reflectance": 1}}],
        "lights": [{"type": "environment", "radiance": sky}],
        "integrator": {"spp": 64, "seed": 3}
    }))
}

fn render(scene: &Scene, study: &Study) -> (Prepared, Film) {
    let prepared = prepare_study(scene, study).unwrap();
    let film = prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap();
    (prepared, film)
}

fn forced() -> Study {
    Study { force: vec![EffectName::Wavelengths], ..Study::default() }
}

fn pixels(film: &Film) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (width, height) = (film.width(), film.height());
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// Mean of a spectrum over a band by the midpoint rule in steps of at most a hundredth of a nanometre, of which the tables here
/// are linear pieces: exact but for the kinks, 1e-5 at most.
fn mean_over(spectrum: &Spectrum, bands: &Bands, band: u32) -> f64 {
    let (from, to) = (bands.edge_nm(band), bands.edge_nm(band + 1));
    let n = ((to - from) / 0.01).ceil() as u32;
    (0..n).map(|i| spectrum.eval(from + (to - from) * (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
}

#[test]
fn a_constant_furnace_reads_one_in_every_band_by_sampled_wavelengths_and_by_one_lane() {
    let scene = furnace(&json!(1), &json!([370, 810, 20]));
    let (prepared, film) = render(&scene, &forced());
    assert_eq!(film.bands(), 23);
    for (x, y) in pixels(&film) {
        for band in 0..film.bands() {
            let got = film.band(x, y, band);
            // Every sample is 1 up to the rounding of a path of a few bounces; so is their mean.
            assert!(got.count > 0 && (got.radiance - 1.0).abs() < 1e-12, "{x}, {y}, band {band}: {got:?}");
            // A few wavelengths may all be of one replicate, of whose error nothing is known.
            assert!(got.error < 1e-12 || got.count < 24 && got.error == f64::INFINITY, "{got:?}");
        }
        let wavelengths: u32 = (0..film.bands()).map(|band| film.band(x, y, band).count).sum();
        // So many lanes a sample, of which a few fall between 820 and 830 nm.
        let all = 64 * prepared.plan().lanes as u32;
        assert!((all - all / 16..=all).contains(&wavelengths), "{wavelengths} of {all}");
    }
    assert_eq!(prepared.band_factors(), None);

    let (prepared, film) = render(&scene, &Study::default());
    assert_eq!(film.bands(), 1);
    for factor in prepared.band_factors().unwrap() {
        assert!((factor - 1.0).abs() < 1e-12);
    }
    let got = film.band(0, 0, 0);
    assert!(got.count == 64 && (got.radiance - 1.0).abs() < 1e-12, "{got:?}");
}

#[test]
fn an_illuminant_furnace_reads_its_spectrum_in_every_band() {
    let illuminant = Spectrum::illuminant(Illuminant::D65, 1.0).unwrap();
    let mut scene = furnace(&json!({"type": "illuminant", "name": "D65"}), &json!([400, 700, 10]));
    scene.integrator.spp = 512;
    let bands = scene.film.bands.unwrap();
    let (_, film) = render(&scene, &forced());
    let (mut chi_square, mut seen) = (0.0, 0);
    for band in 0..bands.count {
        let mut estimate = Welford::new();
        for (x, y) in pixels(&film) {
            let got = film.band(x, y, band);
            assert!(got.count > 0);
            estimate.push(got.radiance);
        }
        let truth = mean_over(&illuminant, &bands, band);
        // Pixels are independent: 96 of them, so that this is close to normal.
        let z = (estimate.mean() - truth) / estimate.standard_error();
        chi_square += z * z;
        // Had it the wavelengths of the next band, it would be seen wherever the spectrum is not flat.
        seen += u32::from(
            (estimate.mean() - mean_over(&illuminant, &bands, band + 1)).abs() > 4.5 * estimate.standard_error(),
        );
        assert!(z.abs() < 4.5, "band {band}: {} is not {truth}, z = {z}", estimate.mean());
        // The least that could be seen is a bias of 4.5 standard errors: less than 1 %.
        assert!(4.5 * estimate.standard_error() < 1e-2 * truth, "{}", estimate.standard_error() / truth);
    }
    // 31 degrees of freedom: above 66 by a chance of 3e-4.
    assert!(chi_square < 66.0, "{chi_square}");
    assert!(seen >= 20, "{seen} of 31");

    // One lane: known but for the rounding of paths, and for the midpoint rule.
    let (prepared, film) = render(&scene, &Study::default());
    let factors = prepared.band_factors().unwrap();
    for band in 0..bands.count {
        let got = factors[band as usize] * film.band(5, 5, 0).radiance;
        let truth = mean_over(&illuminant, &bands, band);
        assert!((got / truth - 1.0).abs() < 2e-5, "band {band}: {got} is not {truth}");
    }
}

/// What the density within a band must be: with one that varies, the mean of the wavelengths that fell into it is another.
#[test]
fn a_density_that_varies_within_a_band_would_be_seen() {
    let range = [360.0, 830.0];
    let bands = Bands::new([420.0, 480.0, 60.0], range).unwrap();
    let ramp = |nm: f64| nm - 390.0;
    let mean = |distribution: &WavelengthDistribution| {
        let mut estimate = Welford::new();
        for i in 0..100_000 {
            let (nm, _) = distribution.sample((f64::from(i) + 0.5) / 1e5);
            if bands.at(nm) == Some(0) {
                estimate.push(ramp(nm));
            }
        }
        estimate.mean()
    };
    // Stratified: errors of one stratum in thousands.
    assert!((mean(&WavelengthDistribution::for_bands(range, &bands)) - 30.0).abs() < 0.01);
    let mutant = mean(&WavelengthDistribution::new(range));
    assert!((mutant - 30.0).abs() > 1.0, "{mutant}");
}

/// ∫ over all bands of radiance times colour matching is the colour: for the same paths, so that only the form of the
/// spectrum within a band is left.
#[test]
fn the_bands_of_a_prism_integrate_to_its_colour() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/prism.json")).unwrap();
    let mut json: Value = serde_json::from_str(&text).unwrap();
    json["film"]["width"] = json!(24);
    json["film"]["height"] = json!(15);
    json["film"]["bands_nm"] = json!([371, 829, 2]);
    json["integrator"]["spp"] = json!(512);
    let mut differences = [Welford::new(), Welford::new(), Welford::new()];
    let mut colour = [0.0; 3];
    for seed in 0..8 {
        json["integrator"]["seed"] = json!(seed);
        let scene = scene(&json);
        let bands = scene.film.bands.unwrap();
        let (_, film) = render(&scene, &Study::default());
        let mut sum = [0.0; 3];
        let number = f64::from(film.width() * film.height());
        // The mean over the picture, wavelength by wavelength: a pixel alone may have met no wavelength of some band.
        for band in 0..bands.count {
            let (mut radiance, mut count) = (0.0, 0_u32);
            for (x, y) in pixels(&film) {
                let got = film.band(x, y, band);
                radiance += got.radiance * f64::from(got.count);
                count += got.count;
            }
            let matching = colour_matching(bands.centre_nm(band));
            let weight = radiance / f64::from(count) * bands.step_nm / cie_y_integral_nm();
            (0..3).for_each(|c| sum[c] += weight * matching[c]);
        }
        for c in 0..3 {
            let mean = film.xyz().map(|xyz| xyz[c]).sum::<f64>() / number;
            differences[c].push(sum[c] - mean);
            colour[c] += mean / 8.0;
        }
    }
    for (c, difference) in differences.iter().enumerate() {
        // Seven degrees of freedom: 5.4 standard errors by a chance of 1e-3. How colour matching curves within 2 nm
        // is less than 1e-4.
        let bound = 5.4 * difference.standard_error() + 1e-4 * colour[c];
        assert!(difference.mean().abs() < bound, "{c}: {} of {}, bound {bound}", difference.mean(), colour[c]);
        assert!(bound < 0.05 * colour[c], "a bound of {bound} sees nothing in {}", colour[c]);
    }
}

/// A polariser along the picture's right before a sky, and before that a quarter-wave plate for 550 nm whose fast axis is at 45°: of
/// δ = 90°·550 nm/λ, S = ½(1, cos δ, 0, sin δ) at each wavelength.
#[test]
fn each_band_has_the_stokes_parameters_of_its_wavelengths() {
    let sheet = |z: f64, material: Value| json!({"shape": {"type": "parallelogram", "origin_m": [-2, -2, z], "u_m": [4, 0, 0], "v_m": [0, 4, 0]}, "material": material});
    let of_film = |film: Value| {
        scene(&json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "height_m": 1},
            "film": film,
            "objects": [
                sheet(1.0, json!({"type": "retarder", "axis": [1, 1, 0], "retardance_deg": 90, "at_nm": 550})),
                sheet(0.0, json!({"type": "polariser", "axis": [1, 0, 0]}))
            ],
            "lights": [{"type": "environment", "radiance": 1}],
            "integrator": {"spp": 256, "seed": 5}
        }))
    };
    let scene = of_film(json!({"width": 12, "height": 8, "bands_nm": [400, 700, 20], "stokes": true}));
    let bands = scene.film.bands.unwrap();
    let (_, film) = render(&scene, &Study::default());
    assert_eq!(film.bands(), 4 * bands.count);
    let behind = |nm: f64| std::f64::consts::FRAC_PI_2 * 550.0 / nm;
    let truths: [&dyn Fn(f64) -> f64; 4] =
        [&|_| 0.5, &|nm| 0.5 * behind(nm).cos(), &|_| 0.0, &|nm| 0.5 * behind(nm).sin()];
    for (parameter, truth) in (0_u32..).zip(truths) {
        for band in 0..bands.count {
            let mut estimate = Welford::new();
            for (x, y) in pixels(&film) {
                let got = film.band(x, y, parameter * bands.count + band);
                assert_eq!(got.count, film.band(x, y, band).count);
                estimate.push(got.radiance);
            }
            let (from, to) = (bands.edge_nm(band), bands.edge_nm(band + 1));
            let expected = (0..1000).map(|i| truth(from + (to - from) * (f64::from(i) + 0.5) / 1e3)).sum::<f64>() / 1e3;
            // Of 96 pixels: 5 standard errors by a chance of 1e-6 each. Rounding of a few matrices where there is no noise. What it
            // sees is far less than a wrong hand, or another parameter's band.
            let bound = 5.0 * estimate.standard_error() + 1e-12;
            let off = (estimate.mean() - expected).abs();
            assert!(off < bound, "S{parameter} in band {band}: {} is not {expected}, bound {bound}", estimate.mean());
            assert!(bound < 2e-3, "{bound}");
        }
    }
    // Without the other parameters the bands of S₀ are the same to the bit.
    let (_, alone) = render(&of_film(json!({"width": 12, "height": 8, "bands_nm": [400, 700, 20]})), &Study::default());
    assert_eq!(alone.bands(), bands.count);
    for (x, y) in pixels(&film) {
        assert!((0..bands.count).all(|band| alone.band(x, y, band) == film.band(x, y, band)));
    }
}
