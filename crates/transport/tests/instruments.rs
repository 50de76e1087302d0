//! Prisms and lenses: where rays go, measured on whole renders.

use etalon_optics::RefractiveIndex;
use etalon_oracle::laws::fresnel_exact;
use etalon_transport::film::PixelRect;
use etalon_transport::{Control, Prepared, prepare};

fn prepared(json: &serde_json::Value) -> Prepared {
    let (scene, warnings) = etalon_scene::parse(&json.to_string(), "test").unwrap_or_else(|e| panic!("{e:?}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    prepare(&scene).unwrap()
}

/// Radiance that a ray reads through a BK7 prism of 60° at least deviation, from a disk of angular radius `aperture_rad`
/// that stands `error_rad` beside the direction in which light of this wavelength must leave.
fn through_prism(wavelength_nm: f64, aperture_rad: f64, error_rad: f64) -> f64 {
    let n = RefractiveIndex::named("N-BK7").unwrap().eval(wavelength_nm);
    let half_deviation = (n * 30.0_f64.to_radians().sin()).asin() - 30.0_f64.to_radians();
    // The apex points up, the ray inside runs along +x at y = 0, where the prism is 2 m wide.
    let height = 30.0_f64.to_radians().tan().recip();
    let (left, right, apex) = ([-2.0, -height], [2.0, -height], [0.0, height]);
    let vertices: Vec<[f64; 3]> =
        [-1.0, 1.0].iter().flat_map(|&z| [left, right, apex].map(|[x, y]| [x, y, z])).collect();
    // Into the prism the ray rises, out of it it falls.
    let (sin, cos) = half_deviation.sin_cos();
    let eye = [-1.0 - 2.0 * cos, -2.0 * sin, 0.0];
    let distance = 1000.0;
    let (sin_out, cos_out) = (half_deviation + error_rad).sin_cos();
    let target = [1.0 + distance * cos_out, -distance * sin_out, 0.0];
    let prepared = prepared(&serde_json::json!({
        "etalon": 1,
        "camera": {
            "type": "orthographic", "position_m": eye, "look_at_m": [-1.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0],
            "height_m": 1e-9
        },
        "film": {"width": 1, "height": 1},
        "materials": {"glass": {"type": "dielectric", "interior": "N-BK7"}, "black": {"type": "black"}},
        "objects": [
            {
                "material": "glass",
                "shape": {
                    "type": "mesh", "vertices_m": vertices,
                    "triangles": [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]
                }
            },
            {
                "material": "black", "emission": {"radiance": 1, "sides": "both"},
                "shape": {
                    "type": "disk", "center_m": target, "normal": [cos_out, -sin_out, 0.0],
                    "radius_m": distance * aperture_rad
                }
            }
        ],
        "integrator": {
            "wavelength_range_nm": [wavelength_nm, wavelength_nm + 1e-4], "sampler": "independent"
        }
    }));
    let paths = 10_000;
    let mean = |lanes: &[f64]| lanes.iter().sum::<f64>() / lanes.len() as f64;
    (0..paths).map(|sample| mean(&prepared.replay(0, 0, sample).radiance)).sum::<f64>() / f64::from(paths)
}

/// The deviation is hit to 1e-7 rad (6e-6°), which a prism of an index off by 1e-7 would miss; and as much light arrives
/// as two faces let through. Significance: |z| < 5 for each of four lines.
#[test]
fn a_prism_deviates_the_fraunhofer_lines_as_snell_and_sellmeier_say() {
    for (wavelength_nm, deviation_deg) in
        [(404.6561, 39.8353366), (486.1327, 39.1381087), (587.5618, 38.6466985), (656.2725, 38.4291367)]
    {
        let n = RefractiveIndex::named("N-BK7").unwrap().eval(wavelength_nm);
        let incidence = (n * 0.5).asin();
        // The published value has seven decimals.
        assert!(((2.0 * incidence).to_degrees() - 60.0 - deviation_deg).abs() < 5.1e-8);

        let transmitted = fresnel_exact(incidence.cos(), n).transmittance().powi(2);
        let read = through_prism(wavelength_nm, 1e-7, 0.0);
        let sigma = (transmitted * (1.0 - transmitted) / 10_000.0).sqrt();
        assert!(((read - transmitted) / sigma).abs() < 5.0, "{wavelength_nm} nm: {read} is not {transmitted}");
        for error_rad in [-2e-7, 2e-7] {
            assert_eq!(through_prism(wavelength_nm, 1e-7, error_rad), 0.0);
        }
    }
}

/// A lens of f = 50 mm and radius 12.5 mm in focus at 2 m shows a point at 5 m as a disk of 3.84615385e-4 m on the sensor.
///
/// Measured as the second moment of the picture of a small disk: a uniform disk of radius r has r²/4 along each axis, and
/// those of the blur and of the source's own image add. A square lens of the same half width would have r²/3.
#[test]
fn a_point_out_of_focus_blurs_to_the_size_that_the_thin_lens_formula_says() {
    let (focal_length, focus, depth, radius) = (0.05, 2.0, 5.0_f64, 0.0125);
    let pixels = 96_u32;
    let half_height = 0.005;
    let source_radius: f64 = 1e-3;
    let prepared = prepared(&serde_json::json!({
        "etalon": 1,
        "camera": {
            "type": "perspective", "position_m": [0, 0, 0], "look_at_m": [0, 0, -1], "up": [0, 1, 0],
            "vertical_fov_deg": 2.0 * f64::atan(half_height).to_degrees(),
            "lens": {"radius_m": radius, "focus_distance_m": focus}
        },
        "film": {"width": pixels, "height": pixels},
        "materials": {"black": {"type": "black"}},
        "objects": [{
            "material": "black", "emission": {"radiance": 1, "sides": "both"},
            "shape": {"type": "disk", "center_m": [0, 0, -depth], "normal": [0, 0, 1], "radius_m": source_radius}
        }],
        "integrator": {"spp": 1024, "seed": 3}
    }));
    let whole = prepared.whole(None);
    let film = prepared.render(&whole, &|_| Control::Continue).unwrap();
    let (mut sum, mut second) = (0.0, 0.0);
    for (x, y) in whole.rect.pixels() {
        let light = film.mean_y(PixelRect { x0: x, y0: y, x1: x + 1, y1: y + 1 });
        let at = |i: u32| half_height * (2.0 * (f64::from(i) + 0.5) / f64::from(pixels) - 1.0);
        sum += light;
        second += light * 0.5 * (at(x).powi(2) + at(y).powi(2));
    }
    // From unit distance to the sensor, at the image distance of the plane in focus.
    let image_distance = focal_length * focus / (focus - focal_length);
    let pixel = 2.0 * half_height / f64::from(pixels);
    // A pixel is a square of variance 1/12, and the source's image is a small disk.
    let own = 0.25 * (source_radius / depth).powi(2) + pixel * pixel / 12.0;
    let diameter = 2.0 * (4.0 * (second / sum - own)).sqrt() * image_distance;
    let formula = 2.0 * radius * (depth - focus) / depth * focal_length / (focus - focal_length);
    assert!((formula - 3.84615385e-4).abs() < 1e-12);
    // 9.4 million paths, of which one in 700 meets the source: the second moment has a standard error near 0.5 %, the
    // diameter 0.25 %; a square lens would be 15 % off.
    assert!((diameter / formula - 1.0).abs() < 0.0125, "{diameter} is not {formula}");
}
