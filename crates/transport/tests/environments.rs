//! Images of everything around: sampled as their density says, bright as their closed forms say.

use etalon_geometry::SurfaceId;
use etalon_optics::spectrum::RgbBasis;
use etalon_optics::{Illuminant, Lanes, Spectrum, Vec3};
use etalon_oracle::statistics::{Budget, Welford};
use etalon_oracle::subjects::{Emits, Emitted};
use etalon_oracle::{Uniform, Verdict, emits_suite, laws};
use etalon_scene::{EnvironmentImage, EnvironmentProjection, Image, LightKind, LightSampling, Scene, Texels};
use etalon_transport::light::{EnvironmentLight, Light, Target};
use etalon_transport::mis::Density;
use etalon_transport::spectral::Colour;
use etalon_transport::{Control, prepare};
use std::f64::consts::PI;
use std::sync::Arc;

const RANGE_NM: [f64; 2] = [400.0, 700.0];

/// A grey image of equal energy, rows from the top; the middle shows +x, the upper edge +z.
pub(super) fn sky(width: u32, height: u32, texels: &[f64]) -> EnvironmentImage {
    let texels = texels.iter().map(|&v| [v as f32; 3]).collect();
    EnvironmentImage {
        image: Arc::new(Image::new(width, height, Texels::F32(texels))),
        name: "sky".to_owned(),
        projection: EnvironmentProjection::LatitudeLongitude,
        forward: [1.0, 0.0, 0.0],
        right: [0.0, -1.0, 0.0],
        up: [0.0, 0.0, 1.0],
        white: Spectrum::ONE,
    }
}

/// What arrives from a direction, by the spectra of three primaries.
fn radiance<const N: usize>(light: &EnvironmentLight, lambda_nm: &Lanes<f64, N>, wi: Vec3<f64>) -> Lanes<f64, N> {
    let colour = light.look(wi).colour;
    lambda_nm.map(|nm| RgbBasis::get().reflectance(colour, nm) * light.white().eval(nm))
}

/// What one of our lights is to the oracle.
pub(super) struct Sky {
    pub light: EnvironmentLight,
    /// Irradiance by the surface's unit normal, where it is known.
    pub irradiance: fn([f64; 3]) -> Option<f64>,
}

/// A sky that shadow rays alone find.
pub(super) fn subject(image: &EnvironmentImage, irradiance: fn([f64; 3]) -> Option<f64>) -> Sky {
    Sky { light: EnvironmentLight::new(image, RANGE_NM, LightSampling::Light), irradiance }
}

impl Emits for Sky {
    fn sample(&self, from_m: [f64; 3], u: [f64; 2]) -> Option<Emitted> {
        let s = Light::Environment(Arc::new(self.light.clone())).sample(Vec3::from_array(from_m), u, 0.0)?;
        let Density::SolidAngle(pdf) = s.density else { panic!("an image has no delta") };
        assert_eq!((s.target, s.surface, s.scale), (Target::Infinity, SurfaceId::NONE, 1.0));
        assert_eq!(s.colour, Some(Colour::Rgb(self.light.look(s.wi).colour)));
        Some(Emitted {
            wi: s.wi.to_array(),
            distance_m: f64::INFINITY,
            radiance: self.radiance(from_m, s.wi.to_array()),
            pdf,
        })
    }

    fn pdf(&self, _: [f64; 3], wi: [f64; 3]) -> f64 {
        self.light.look(Vec3::from_array(wi)).density
    }

    fn radiance(&self, _: [f64; 3], wi: [f64; 3]) -> f64 {
        radiance(&self.light, &Lanes([550.0]), Vec3::from_array(wi))[0]
    }

    fn irradiance(&self, _: [f64; 3], normal: [f64; 3]) -> Option<f64> {
        (self.irradiance)(normal)
    }
}

/// Every corner case of a cell: black next to bright, a bright pole, a bright seam.
pub(super) fn uneven() -> EnvironmentImage {
    let texels = [
        0.0, 0.0, 3.0, 0.5, 0.0, 1.0, 0.0, 0.0, //
        9.0, 0.0, 0.0, 1.0, 2.0, 4.0, 0.0, 7.0, //
        0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 0.0, 5.0, //
        0.0, 6.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0,
    ];
    sky(8, 4, &texels)
}

// Quadrature of a continuous function with creases along the rows and columns of its cells.
emits_suite!(uneven_sky, subject(&uneven(), |_| None), from: [[0.0; 3]], pdf_tolerance: 1e-4);
emits_suite!(constant_sky, subject(&sky(1, 1, &[2.0]), |_| Some(2.0 * PI)), from: [[0.0; 3]], pdf_tolerance: 1e-6);

/// The same texels, of which the first and the last row lie at the poles.
fn at_poles(image: EnvironmentImage) -> EnvironmentImage {
    EnvironmentImage { projection: EnvironmentProjection::LatitudeLongitudeAtPoles, ..image }
}

emits_suite!(uneven_sky_with_rows_at_the_poles, subject(&at_poles(uneven()), |_| None), from: [[0.0; 3]], pdf_tolerance: 1e-4);

/// A square of equal areas.
fn square(side: u32, texels: &[f64]) -> EnvironmentImage {
    EnvironmentImage { projection: EnvironmentProjection::EqualArea, ..sky(side, side, texels) }
}

/// Black next to bright within and across the fold, which is the diamond between the middles of the edges.
pub(super) fn uneven_square() -> EnvironmentImage {
    let texels = [
        1.0, 0.0, 3.0, 0.5, //
        9.0, 0.5, 0.0, 1.0, //
        0.1, 0.2, 7.0, 0.0, //
        0.0, 6.0, 0.0, 2.0,
    ];
    square(4, &texels)
}

// Quadrature of a function that jumps along the edges of texels.
emits_suite!(uneven_equal_area_sky, subject(&uneven_square(), |_| None), from: [[0.0; 3]], pdf_tolerance: 2e-2);
emits_suite!(constant_equal_area_sky, subject(&square(3, &[2.0; 9]), |_| Some(2.0 * PI)), from: [[0.0; 3]], pdf_tolerance: 1e-6);

/// Where the centre of a texel of a square lies, written from the paper's figure: the square's upper right quarter is, inside the
/// diagonal, the octant of positive axes, where r = 1 − z runs outward by √, and the angle in proportion along it.
fn equal_area_centre(column: u32, row: u32, side: u32) -> [f64; 3] {
    let [p, q] = [column, row].map(|k| (2.0 * f64::from(k) + 1.0) / f64::from(side) - 1.0);
    let (size_p, size_q) = (p.abs(), q.abs());
    let above = size_p + size_q <= 1.0;
    // Folded back over the diagonal.
    let (a, b) = if above { (size_p, size_q) } else { (1.0 - size_q, 1.0 - size_p) };
    let (r, angle) = (a + b, b / (a + b) * 0.5 * PI);
    let z = 1.0 - r * r;
    let level = (1.0 - z * z).sqrt();
    let (x, y) = (level * angle.cos() * p.signum(), level * angle.sin() * q.signum());
    [x, y, if above { z } else { -z }]
}

#[test]
fn each_texel_of_an_equal_area_sky_shows_its_colour_over_the_same_solid_angle() {
    const SIDE: u32 = 16;
    let texels: Vec<f64> = (0..SIDE * SIDE).map(f64::from).collect();
    let image = square(SIDE, &texels);
    let subject = subject(&image, |_| None);
    for i in 0..SIDE * SIDE {
        let [x, y, z] = equal_area_centre(i % SIDE, i / SIDE, SIDE);
        let world = |k: usize| x * image.right[k] + y * image.forward[k] + z * image.up[k];
        let wi = [world(0), world(1), world(2)];
        // The three primaries add up to white within roundoffs.
        assert!((subject.radiance([0.0; 3], wi) - f64::from(i)).abs() < 1e-11, "texel {i} toward {wi:?}");
    }
    // An image that is read down its columns is noticed.
    let transposed = EnvironmentImage { forward: image.right, right: image.forward, ..image.clone() };
    let wrong = (0..SIDE * SIDE).filter(|&i| {
        let [x, y, z] = equal_area_centre(i % SIDE, i / SIDE, SIDE);
        let wi = std::array::from_fn(|k| x * image.right[k] + y * image.forward[k] + z * image.up[k]);
        (self::subject(&transposed, |_| None).radiance([0.0; 3], wi) - f64::from(i)).abs() > 0.5
    });
    assert_eq!(wrong.count() as u32, SIDE * (SIDE - 1), "all but those of the diagonal");
    // Directions spread evenly over the sphere meet each texel as often: 256 counts of mean 1000, scatter 1 of √1000.
    let mut random = Uniform::new(3);
    let mut counts = vec![0_u32; (SIDE * SIDE) as usize];
    (0..256_000).for_each(|_| counts[subject.radiance([0.0; 3], random.direction()).round() as usize] += 1);
    let chi2: f64 = counts.iter().map(|&n| (f64::from(n) - 1000.0).powi(2) / 1000.0).sum();
    // χ² of 255 degrees of freedom: mean 255, standard deviation 22.6; five of them are one wrong alarm in a million.
    assert!((chi2 - 255.0).abs() < 5.0 * 22.6, "{chi2}");
}

/// A level plate under a square whose upper half (a diamond) is T and lower half B: E = πT on its upper side.
#[test]
fn an_equal_area_sky_lights_a_plate_as_a_closed_form_says() {
    const SIDE: u32 = 64;
    // L = a + b·(texel's mean of z), which is a polynomial of the place within the diamond; here L = 1 above, 3 below, so that
    // texels on the fold, half above, show the mean of both: their error is 1/SIDE of the horizon, whose cosine is nearly 0.
    let texels: Vec<f64> = (0..SIDE * SIDE)
        .map(|i| {
            let [_, _, z] = equal_area_centre(i % SIDE, i / SIDE, SIDE);
            1.0 + 2.0 * f64::from(u8::from(z < 0.0))
        })
        .collect();
    let truth = white_y() * 0.5;
    for sampling in [LightSampling::Mis, LightSampling::Light, LightSampling::Bsdf] {
        shows(|seed| plate(square(SIDE, &texels), sampling, seed, 256), truth, 0.05);
    }
}

#[test]
fn rows_at_the_poles_stand_where_they_say() {
    let image = at_poles(uneven());
    for i in 0..32_u32 {
        let (polar, azimuth) = (f64::from(i / 8) / 3.0 * PI, (f64::from(i % 8) + 0.5) / 4.0 * PI - PI);
        let wi = [polar.sin() * azimuth.cos(), -polar.sin() * azimuth.sin(), polar.cos()];
        let texel = image.image.texel(i as usize % 8, i as usize / 8)[0];
        // At the poles themselves the azimuth is that of a roundoff.
        if (0.1..3.1).contains(&polar) {
            assert!((subject(&image, |_| None).radiance([0.0; 3], wi) - texel).abs() < 1e-12, "texel {i}");
        }
    }
    // Two rows, T and B: L = T + (B − T)·θ/π, on a level plate 2π∫L sin θ cos θ dθ = πT + (B − T)·2·(π/8), by parts:
    // ∫θ sin θ cos θ from 0 to π/2 = [−θ cos 2θ/4 + sin 2θ/8] = π/8.
    let (top, bottom) = (3.0, 1.0);
    let subject = subject(&at_poles(sky(2, 2, &[top, top, bottom, bottom])), |_| None);
    let want = PI * top + (bottom - top) * 2.0 * PI / 8.0;
    laws::light_gives_irradiance(&subject, [0.0; 3], [0.0, 0.0, 1.0], want, 1e-12, Budget::for_tests(2), 3).assert();
}

/// One row of four texels is constant along each meridian, and linear in longitude between the texels at ±45° and ±135°. On an
/// upright surface that faces texel c between its neighbours b and d, E = (π/2)((b + d)(1 − 2/π)) + 2c: ∫sin²θ dθ = π/2, and
/// ∫ from −90° to 0 of (b + (c − b)(x + 90°)/90°)·cos x dx = b + (c − b)·2/π.
fn upright(b: f64, c: f64, d: f64) -> f64 {
    0.5 * PI * (b + d) * (1.0 - 2.0 / PI) + 2.0 * c
}

/// Columns stand at −135°, −45°, 45°, 135° to the right of +x; right is −y.
const MERIDIANS: [f64; 4] = [1.0, 0.25, 4.0, 0.5];

fn facing(column: usize) -> [f64; 3] {
    let angle = (-135.0 + 90.0 * column as f64).to_radians();
    [angle.cos(), -angle.sin(), 0.0]
}

#[test]
fn an_upright_surface_gets_the_irradiance_of_a_closed_form_also_across_the_seam() {
    let subject = subject(&sky(4, 1, &MERIDIANS), |_| None);
    for column in 0..4 {
        let [b, c, d] = [3, 4, 5].map(|k| MERIDIANS[(column + k) % 4]);
        let truth = upright(b, c, d);
        laws::light_gives_irradiance(&subject, [0.0; 3], facing(column), truth, 1e-12, Budget::for_tests(4), 7)
            .assert();
    }
}

/// Two rows: constant above 45°, below −45°, and linear in the polar angle between. A level surface gets
/// 2π∫L sin θ cos θ dθ = (π/2)L(0) + 2π∫ from 45° to 90° of (L(45°) + (L(135°) − L(45°))·(θ − 45°)/90°)·sin θ cos θ dθ.
#[test]
fn a_level_surface_gets_the_irradiance_of_a_closed_form() {
    let (top, bottom): (f64, f64) = (3.0, 1.0);
    let subject = subject(&sky(2, 2, &[top, top, bottom, bottom]), |_| None);
    // ∫ sin θ cos θ from 45° to 90° = 1/4; ∫ (θ − 45°) sin θ cos θ = [−(θ − π/4)cos 2θ/4 + sin 2θ/8] = π/16 − 1/8.
    let truth = |near: f64, far: f64| {
        0.5 * PI * near + 2.0 * PI * (0.25 * near + (far - near) * 2.0 / PI * (PI / 16.0 - 0.125))
    };
    for (normal, near, far) in [([0.0, 0.0, 1.0], top, bottom), ([0.0, 0.0, -1.0], bottom, top)] {
        let want = truth(near, far);
        laws::light_gives_irradiance(&subject, [0.0; 3], normal, want, 1e-12, Budget::for_tests(2), 3).assert();
    }
}

/// A sampler that is wrong in one way, and otherwise ours.
struct Mutant {
    right: Sky,
    fault: &'static str,
}

impl Mutant {
    fn spoil(&self, wi: [f64; 3], pdf: f64) -> f64 {
        let sin = (1.0 - wi[2] * wi[2]).max(0.0).sqrt();
        let turns = wi[1].atan2(wi[0]) / (2.0 * PI);
        match self.fault {
            // As if rows near the poles had as much solid angle as the others.
            "no sine" => pdf * sin * 4.0 / PI,
            // Beyond the centres of the outermost columns the density of those.
            "seam not wrapped" => {
                let width = 8.0;
                let clamped = turns.clamp(-0.5 + 0.5 / width, 0.5 - 0.5 / width) * 2.0 * PI;
                self.right.pdf([0.0; 3], [sin * clamped.cos(), sin * clamped.sin(), wi[2]])
            }
            "density of the nearest texel" => {
                let (column, row) = (((0.5 - turns) * 8.0).floor(), (wi[2].acos() / PI * 4.0).floor());
                let (polar, azimuth) = ((row + 0.5) / 4.0 * PI, (0.5 - (column + 0.5) / 8.0) * 2.0 * PI);
                let centre = [polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()];
                self.right.pdf([0.0; 3], centre)
            }
            "upside down" => self.right.pdf([0.0; 3], [wi[0], wi[1], -wi[2]]),
            _ => pdf,
        }
    }
}

impl Emits for Mutant {
    fn sample(&self, from_m: [f64; 3], u: [f64; 2]) -> Option<Emitted> {
        let s = self.right.sample(from_m, u)?;
        Some(Emitted { pdf: self.spoil(s.wi, s.pdf), ..s })
    }

    fn pdf(&self, from_m: [f64; 3], wi: [f64; 3]) -> f64 {
        self.spoil(wi, self.right.pdf(from_m, wi))
    }

    fn radiance(&self, from_m: [f64; 3], wi: [f64; 3]) -> f64 {
        self.right.radiance(from_m, wi)
    }
}

#[test]
fn wrong_densities_are_rejected() {
    let verdicts = |fault| {
        let mutant = Mutant { right: subject(&uneven(), |_| None), fault };
        laws::light_laws(&mutant, [0.0; 3], 1e-4, Budget::for_tests(1), 1)
    };
    verdicts("").iter().for_each(Verdict::assert);
    for fault in ["no sine", "seam not wrapped", "density of the nearest texel", "upside down"] {
        assert!(verdicts(fault).iter().any(|verdict| !verdict.pass), "the mutant \"{fault}\" survived");
    }
}

#[test]
fn no_direction_that_shines_has_a_density_of_zero_and_no_black_one_any_other() {
    let subject = subject(&uneven(), |_| None);
    let mut random = Uniform::new(5);
    let mut directions: Vec<_> = (0..100_000).map(|_| random.direction()).collect();
    directions.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [-1.0, -0.0, 0.0], [0.0, 1.0, 0.0]]);
    let mut black = 0;
    for wi in directions {
        let (radiance, pdf) = (subject.radiance([0.0; 3], wi), subject.pdf([0.0; 3], wi));
        assert!(radiance.is_finite() && pdf.is_finite());
        assert_eq!(radiance > 0.0, pdf > 0.0, "{wi:?}: {radiance} {pdf}");
        black += u32::from(radiance == 0.0);
    }
    assert!(black > 1000, "{black}: the image has black cells");
}

#[test]
fn turning_the_world_is_turning_the_image() {
    let image = uneven();
    // A quarter turn to the right shifts the eight columns by two.
    let shifted: Vec<f64> = (0..32).map(|i| image.image.texel((i % 8 + 6) % 8, i / 8)[0]).collect();
    let turned = EnvironmentImage { forward: image.right, right: [-1.0, 0.0, 0.0], ..image.clone() };
    let (a, b) = (subject(&turned, |_| None), subject(&sky(8, 4, &shifted), |_| None));
    let mut random = Uniform::new(8);
    for _ in 0..10_000 {
        let wi = random.direction();
        // The slope of the image, 9 in a texel of π/4, times the rounding of the angle.
        assert!((a.radiance([0.0; 3], wi) - b.radiance([0.0; 3], wi)).abs() < 1e-13);
        assert!((a.pdf([0.0; 3], wi) - b.pdf([0.0; 3], wi)).abs() < 1e-13);
    }
    // Each texel shows its own colour in the direction of its centre.
    for i in 0..32 {
        let (polar, azimuth) = ((f64::from(i / 8) + 0.5) / 4.0 * PI, (f64::from(i % 8) + 0.5) / 4.0 * PI - PI);
        let wi = [polar.sin() * azimuth.cos(), -polar.sin() * azimuth.sin(), polar.cos()];
        let texel = image.image.texel(i as usize % 8, i as usize / 8)[0];
        assert!((subject(&image, |_| None).radiance([0.0; 3], wi) - texel).abs() < 1e-12, "texel {i}");
    }
}

/// A level plate of albedo ½ that fills the picture under an image; its upper side is +z.
fn plate(image: EnvironmentImage, sampling: LightSampling, seed: u64, spp: u32) -> Scene {
    let text = format!(
        r#"{{"etalon": 1, "film": {{"width": 4, "height": 4}},
        "camera": {{"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 1}},
        "objects": [{{"shape": {{"type": "disk", "normal": [0, 0, 1], "radius_m": 2}},
            "material": {{"type": "lambert", "reflectance": 0.5}}}}],
        "lights": [{{"type": "environment", "radiance": 1}}],
        "integrator": {{"spp": {spp}, "seed": {seed}, "wavelength_range_nm": [400, 700]}}}}"#
    );
    let mut scene = etalon_scene::parse(&text, "plate.json").unwrap().0;
    scene.integrator.light_sampling = sampling;
    scene.lights[0].kind = LightKind::ImageEnvironment(image);
    scene
}

fn mean_y(scene: &Scene) -> f64 {
    let prepared = prepare(scene).unwrap();
    let extent = prepared.whole(Some(1));
    prepared.render(&extent, &|_| Control::Continue).unwrap().mean_y(extent.rect)
}

/// The mean over 16 seeds against `truth`, |z| < 5: one wrong alarm in 10⁶ with normal noise, in 6000 with Student's t.
fn shows(scene_of: impl Fn(u64) -> Scene, truth: f64, resolves: f64) {
    let readings: Welford = (0..16).map(|seed| mean_y(&scene_of(seed))).collect();
    // Rounding of a picture without noise.
    let error = readings.standard_error().max(1e-9 * truth);
    let z = (readings.estimate().mean - truth) / error;
    assert!(z.abs() < 5.0, "{:?} is not {truth}: z = {z}", readings.estimate());
    assert!(6.0 * error < resolves * truth, "too noisy to see {resolves}: {error}");
}

/// CIE Y of the constant spectrum 1 in the range of the plates.
fn white_y() -> f64 {
    let image = sky(1, 1, &[1.0]);
    let mut bare = plate(image, LightSampling::Mis, 0, 1);
    bare.objects.clear();
    mean_y(&bare)
}

#[test]
fn shadow_rays_and_paths_find_the_same_light() {
    let rows = [3.0, 3.0, 1.0, 1.0];
    let irradiance = 0.5 * PI * 3.0 + 2.0 * PI * (0.75 - 2.0 * 2.0 / PI * (PI / 16.0 - 0.125));
    let truth = white_y() * 0.5 / PI * irradiance;
    for sampling in [LightSampling::Mis, LightSampling::Light, LightSampling::Bsdf] {
        shows(|seed| plate(sky(2, 2, &rows), sampling, seed, 64), truth, 0.05);
    }
}

/// A texel of radiance L in a black image of small texels Δ is a sun: its irradiance is L·Δ·∫ hat(θ) sin θ dθ
/// = L·Δ·sin θ₀·(2 − 2cos Δ)/Δ, as much as parallel light of it gives.
#[test]
fn one_texel_is_a_sun() {
    let (width, height, row) = (512_u32, 256_u32, 40_u32);
    let mut texels = vec![0.0; (width * height) as usize];
    texels[(row * width + 511) as usize] = 1e5;
    let step = PI / f64::from(height);
    let polar = (f64::from(row) + 0.5) * step;
    let irradiance = 1e5 * polar.sin() * (2.0 - 2.0 * step.cos());
    // On a level plate parallel light brings cos θ₀ of that; the hat brings ∫ hat(θ) sin θ cos θ dθ = ½ ∫ hat(θ) sin 2θ dθ, which
    // is cos²(Δ/2) of it: 4e-5 less.
    let parallel_truth = white_y() * 0.5 / PI * irradiance * polar.cos();
    let truth = parallel_truth * (0.5 * step).cos().powi(2);
    for sampling in [LightSampling::Mis, LightSampling::Light] {
        shows(|seed| plate(sky(width, height, &texels), sampling, seed, 64), truth, 1e-3);
    }
    // Parallel light of the same irradiance.
    let mut parallel = plate(sky(1, 1, &[1.0]), LightSampling::Mis, 0, 16);
    let azimuth = (511.5 / 512.0 - 0.5) * 2.0 * PI;
    let toward = [polar.sin() * azimuth.cos(), -polar.sin() * azimuth.sin(), polar.cos()];
    parallel.lights[0].kind =
        LightKind::Directional { direction: toward.map(|v| -v), irradiance: Spectrum::Constant(irradiance) };
    assert!((mean_y(&parallel) / parallel_truth - 1.0).abs() < 1e-9);
}

/// A coloured texel shows its colour: the three primaries are parts of daylight that add up to it.
#[test]
fn white_is_daylight_and_primaries_add_up_to_it() {
    let daylight = Spectrum::illuminant(Illuminant::D65, 2.0).unwrap();
    let lambda = Lanes([450.0, 500.0, 550.0, 650.0]);
    let of = |rgb: [f32; 3]| {
        let image = EnvironmentImage {
            image: Arc::new(Image::new(1, 1, Texels::F32(vec![rgb]))),
            white: daylight.clone(),
            ..uneven()
        };
        radiance(&EnvironmentLight::new(&image, RANGE_NM, LightSampling::Mis), &lambda, Vec3::new(0.0, 0.6, 0.8))
    };
    let parts = of([1.0, 0.0, 0.0]) + of([0.0, 1.0, 0.0]) + of([0.0, 0.0, 1.0]);
    for lane in 0..4 {
        let want = daylight.eval(lambda[lane]);
        assert!((of([1.0; 3])[lane] / want - 1.0).abs() < 1e-13);
        assert!((parts[lane] / want - 1.0).abs() < 1e-13);
    }
}
