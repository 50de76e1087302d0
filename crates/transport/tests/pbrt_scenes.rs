//! Scenes of pbrt, imported and rendered, against what they come to in closed form: pbrt's conventions written out independently.

use etalon_import::import_bytes;
use etalon_transport::{Control, prepare};
use std::f64::consts::PI;

/// The Y of the picture's only pixel.
fn shown(text: &str, files: &dyn Fn(&str) -> Result<Vec<u8>, String>) -> f64 {
    let imported = import_bytes("pbrt", text.as_bytes(), files, "", "a.pbrt").unwrap_or_else(|why| panic!("{why}"));
    assert!(imported.left_out.is_empty(), "{:?}", imported.left_out);
    let scene = imported.parse("a", None).unwrap_or_else(|e| panic!("{e}\n{}", imported.text)).scene;
    let prepared = prepare(&scene).unwrap_or_else(|why| panic!("{why}"));
    let extent = prepared.whole(Some(1));
    let film = prepared.render(&extent, &|_| Control::Continue).unwrap_or_else(|why| panic!("{why}"));
    film.mean_y(extent.rect)
}

fn without_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {name}"))
}

/// A picture of one pixel through a long lens, so that it is one place: from `eye` to `target`.
fn camera(eye: [f64; 3], target: [f64; 3], spp: u32, depth: u32) -> String {
    let up = if target[0] == eye[0] && target[2] == eye[2] { [0, 0, 1] } else { [0, 1, 0] };
    format!(
        "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nPixelFilter \"box\"\n\
         Sampler \"independent\" \"integer pixelsamples\" {spp}\nIntegrator \"path\" \"integer maxdepth\" {depth}\n\
         LookAt {} {} {}  {} {} {}  {} {} {}\nCamera \"perspective\" \"float fov\" 0.01\nWorldBegin\n",
        eye[0], eye[1], eye[2], target[0], target[1], target[2], up[0], up[1], up[2]
    )
}

const FLOOR: &str =
    "Shape \"trianglemesh\" \"point3 P\" [ -9 0 -9  9 0 -9  9 0 9  -9 0 9 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n";
const GREY: &str = "Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ]\n";

/// `value` against `truth`, off by `noise` at most, which is six standard errors or a bound of the arithmetic.
fn is(what: &str, value: f64, truth: f64, noise: f64) {
    assert!((value / truth - 1.0).abs() < noise, "{what}: {value} is not {truth}");
}

/// Light has the luminance of its scale, whatever its spectrum: the film's Y of D65, of the rendered range and in `f64`, agrees with
/// the import's own sum over nanometres to this.
const SPECTRAL: f64 = 2e-3;

#[test]
fn lights_without_a_surface_bring_their_irradiance() {
    // Everything here is lit directly: a plate of albedo ½ seen from (0, 5, 5).
    let view = camera([0.0, 5.0, 5.0], [0.0, 0.0, 0.0], 64, 1);
    // Parallel light of irradiance 3 from 60° off the normal: ½/π·3·cos 60°.
    let distant = "LightSource \"distant\" \"rgb L\" [ 1 1 1 ] \"float scale\" 3 \"point3 from\" [ 0 1 0 ] \"point3 to\" [ 1.7320508075688772 0 0 ]\n";
    is("distant", shown(&format!("{view}{distant}{GREY}{FLOOR}"), &without_files), 0.5 / PI * 3.0 * 0.5, SPECTRAL);
    // A point of intensity 8 two above and one aside: ½/π·8·cos θ/d², cos θ = 2/√5, d² = 5. Its place is moved by the transform.
    let point = "AttributeBegin\nTranslate 1 0 0\nLightSource \"point\" \"rgb I\" [ 1 1 1 ] \"float scale\" 8 \"point3 from\" [ 0 2 0 ]\nAttributeEnd\n";
    let truth = 0.5 / PI * 8.0 * (2.0 / 5.0_f64.sqrt()) / 5.0;
    is("point", shown(&format!("{view}{point}{GREY}{FLOOR}"), &without_files), truth, SPECTRAL);
    // Within its inner cone a spot is a point.
    let spot = "LightSource \"spot\" \"rgb I\" [ 1 1 1 ] \"float scale\" 8 \"point3 from\" [ 0 2 0 ] \"point3 to\" [ 0 0 0 ] \"float coneangle\" 20\n";
    is("spot", shown(&format!("{view}{spot}{GREY}{FLOOR}"), &without_files), 0.5 / PI * 8.0 / 4.0, SPECTRAL);
    // An even sky of 3: albedo · 3.
    let sky = "LightSource \"infinite\" \"rgb L\" [ 3 3 3 ]\n";
    is("sky", shown(&format!("{view}{sky}{GREY}{FLOOR}"), &without_files), 1.5, SPECTRAL);
    // Of a black body scale is the luminance.
    let body = "LightSource \"infinite\" \"blackbody L\" 3000 \"float scale\" 2\n";
    is("black body", shown(&format!("{view}{body}{GREY}{FLOOR}"), &without_files), 1.0, SPECTRAL);
}

#[test]
fn a_disk_of_light_brings_the_irradiance_of_its_cone() {
    // A disk of radius 1, 2 above, that shines downward: E = πL sin²θ = πL/5; its normal is +z before it is turned to −y.
    let view = camera([0.0, 1.0, 5.0], [0.0, 0.0, 0.0], 4096, 1);
    let lamp = |flip: &str| {
        format!(
            "AttributeBegin\nTranslate 0 2 0\nRotate 90 1 0 0\n{flip}AreaLightSource \"diffuse\" \"rgb L\" [ 7 7 7 ]\n\
             Shape \"disk\" \"float radius\" 1\nAttributeEnd\n"
        )
    };
    let lit = shown(&format!("{view}{}{GREY}{FLOOR}", lamp("")), &without_files);
    // A sample by area has cos⁴ θ, from 1 to (4/5)², which scatters by less than .15 of its mean; six standard errors of 4096.
    is("disk", lit, 0.5 * 7.0 / 5.0, 6.0 * 0.15 / 64.0);
    // Reversed it shines upward, and nothing comes down.
    assert_eq!(shown(&format!("{view}{}{GREY}{FLOOR}", lamp("ReverseOrientation\n")), &without_files), 0.0);
}

#[test]
fn a_pane_and_smooth_metal_reflect_as_fresnel_says() {
    let sky = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";
    let view = camera([0.0, 5.0, 0.0], [0.0, 0.0, 0.0], 64, 5);
    // A white sky behind and before glass: everything comes through or back.
    let glass = "Material \"thindielectric\" \"float eta\" 1.5\n";
    is("pane", shown(&format!("{view}{sky}{glass}{FLOOR}"), &without_files), 1.0, SPECTRAL);
    // A metal by its reflectance head-on.
    let metal = "Material \"conductor\" \"rgb reflectance\" [ 0.6 0.6 0.6 ] \"float roughness\" 0\n";
    is("metal", shown(&format!("{view}{sky}{metal}{FLOOR}"), &without_files), 0.6, SPECTRAL);
}

/// A square image as an HDR file, which holds powers of two exactly.
fn hdr(side: usize, of: impl Fn(usize, usize) -> f64) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {side} +X {side}\n").into_bytes();
    for row in 0..side {
        for column in 0..side {
            let value = of(column, row);
            assert!(value > 0.0 && value.log2().fract() == 0.0, "a power of two");
            // 128/256·2^(e − 128).
            bytes.extend([128, 128, 128, (value.log2() as i32 + 129) as u8]);
        }
    }
    bytes
}

#[test]
fn a_sky_by_an_image_shows_in_each_direction_what_the_map_says() {
    // Which texel of 4 × 4 lies in a direction of the light's axes, by the map's own words: in the middle z = 1, across each
    // diagonal r² = 1 − |z|, along it the angle in proportion.
    let radiance = |column: usize, row: usize| f64::from(2_u32.pow((3 * column + 5 * row) as u32 % 11));
    let texel_toward = |[x, y, z]: [f64; 3]| {
        let r = (1.0 - z.abs()).sqrt();
        let share = y.abs().atan2(x.abs()) / (0.5 * PI);
        let (p, q) = if z >= 0.0 { (r * (1.0 - share), r * share) } else { (1.0 - r * share, 1.0 - r * (1.0 - share)) };
        let place = |size: f64, sign: f64| ((0.5 + 0.5 * size * sign.signum()) * 4.0) as usize;
        radiance(place(p, x), place(q, y))
    };
    let file = |_: &str| Ok(hdr(4, radiance));
    let mut seen = std::collections::BTreeSet::new();
    for k in 0..40 {
        let angle = f64::from(k) + 0.21;
        let z = -0.95 + 1.9 * (f64::from(k) + 0.5) / 40.0;
        let level = (1.0 - z * z).sqrt();
        let toward = [level * (2.4 * angle).cos(), level * (2.4 * angle).sin(), z];
        // The light is turned by 30° about y: what is at d in its axes is seen at R·d in the world.
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let [x, y, z] = toward;
        let world = [cos * x + sin * z, y, -sin * x + cos * z];
        for mirror in ["", "Scale -1 1 1\n"] {
            let view = camera([0.0; 3], world, 1, 1);
            let text = format!(
                "{mirror}{view}AttributeBegin\nRotate 30 0 1 0\nLightSource \"infinite\" \"string filename\" \"sky.hdr\"\nAttributeEnd\n\
                 Translate 0 900 0\nShape \"sphere\" \"float radius\" 0.001\n"
            );
            let want = texel_toward(toward);
            is(&format!("{k} {mirror}"), shown(&text, &file), want, SPECTRAL);
            seen.insert(want as u64);
        }
    }
    assert!(seen.len() >= 8, "{seen:?}");
}
