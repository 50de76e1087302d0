//! Images that give detail: normals, heights, opacity; and texture coordinates of round shapes. Against closed forms.

use etalon_scene::{
    Bitangent, Image, ImageTexture, MaterialKind, OpacityImage, Relief, Scene, SpectrumTexture, Terminator, Texels,
    TextureFilter, Wrap,
};
use etalon_transport::{Control, EffectName, Film, Study, prepare, prepare_study};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn texture(width: u32, height: u32, texels: Vec<[f32; 3]>, filter: TextureFilter) -> ImageTexture {
    ImageTexture { wrap: [Wrap::Clamp; 2], filter, ..ImageTexture::new(Image::new(width, height, Texels::F32(texels))) }
}

/// A map of one normal.
fn one_normal(n: [f64; 3], strength: f64) -> Relief {
    let texel = n.map(|v| (0.5 + 0.5 * v) as f32);
    let texture = texture(1, 1, vec![texel], TextureFilter::Bilinear);
    Relief::Normals { texture, strength: [strength; 2], bitangent: Bitangent::AlongV, terminator: Terminator::Mirrored }
}

/// A square of 2 × 2 m about the origin, u along x and v along y, as a parallelogram, a mesh, and a mesh whose coordinates
/// run the other way.
fn squares() -> [Value; 2] {
    [
        json!({"type": "parallelogram", "origin_m": [-1, -1, 0], "u_m": [2, 0, 0], "v_m": [0, 2, 0]}),
        json!({"type": "mesh", "vertices_m": [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]],
            "triangles": [[0, 1, 2], [0, 2, 3]], "uvs": [[0, 0], [1, 0], [1, 1], [0, 1]]}),
    ]
}

/// One object, seen from above in parallel rays.
fn scene(shape: &Value, reflectance: f64, lights: &Value, height_m: f64) -> Scene {
    let text = json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": height_m},
        "film": {"width": 4, "height": 4},
        "objects": [{"shape": shape, "material": {"type": "lambert", "reflectance": reflectance}}],
        "lights": lights,
        "integrator": {"spp": 4}
    });
    etalon_scene::parse(&text.to_string(), "test").unwrap_or_else(|errors| panic!("{errors}")).0
}

fn render(scene: &Scene) -> Film {
    let prepared = prepare(scene).unwrap();
    prepared.render(&prepared.whole(Some(1)), &|_| Control::Continue).unwrap()
}

fn ys(scene: &Scene) -> Vec<f64> {
    render(scene).xyz().map(|xyz| xyz[1]).collect()
}

fn close(got: &[f64], want: f64, what: &str) {
    for y in got {
        // Texels are single precision.
        assert!((y / want - 1.0).abs() < 1e-6, "{what}: {y} is not {want}");
    }
}

/// Toward parallel light of irradiance 2 across it.
const TOWARD: [f64; 3] = [0.48, 0.36, 0.8];

fn sun() -> Value {
    json!([{"type": "directional", "direction": TOWARD.map(|v| -v), "irradiance": 2}])
}

fn lit(n: [f64; 3]) -> f64 {
    let cos: f64 = (0..3).map(|k| n[k] * TOWARD[k]).sum();
    0.5 / PI * 2.0 * cos
}

fn unit(n: [f64; 3]) -> [f64; 3] {
    let length = n.iter().map(|v| v * v).sum::<f64>().sqrt();
    n.map(|v| v / length)
}

#[test]
fn a_normal_map_turns_the_surface_to_the_light_as_its_closed_form_says() {
    let n = unit([0.3, -0.2, 0.9]);
    for shape in squares() {
        let mut mapped = scene(&shape, 0.5, &sun(), 1.0);
        close(&ys(&mapped), lit([0.0, 0.0, 1.0]), "without a map");
        mapped.objects[0].relief = Some(one_normal(n, 1.0));
        close(&ys(&mapped), lit(n), "with one");
        // Mutants: green downward, u and v exchanged.
        for wrong in [[n[0], -n[1], n[2]], [n[1], n[0], n[2]]] {
            assert!((lit(wrong) / lit(n) - 1.0).abs() > 0.05);
        }
        mapped.objects[0].relief = Some(one_normal(n, 2.0));
        close(&ys(&mapped), lit(unit([2.0 * n[0], 2.0 * n[1], n[2]])), "of twice the strength");
        // It is carried by the object: a quarter turn about z takes (x, y) to (−y, x).
        let mut turned = mapped.clone();
        turned.objects[0].relief = Some(one_normal(n, 1.0));
        turned.objects[0].transform.linear = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        close(&ys(&turned), lit([-n[1], n[0], n[2]]), "turned");
        // Mirrored in x, u grows along −x.
        turned.objects[0].transform.linear = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        close(&ys(&turned), lit([-n[0], n[1], n[2]]), "mirrored");
        // Without the effect the surface is flat again.
        let study = Study { without: vec![EffectName::ShadingNormals], ..Study::default() };
        let flat = prepare_study(&turned, &study).unwrap();
        let film = flat.render(&flat.whole(Some(1)), &|_| Control::Continue).unwrap();
        close(&film.xyz().map(|xyz| xyz[1]).collect::<Vec<_>>(), lit([0.0, 0.0, 1.0]), "left out");
    }
}

/// Heights that grow evenly with u from texel to texel: h = height·(64u − ½)/63 in the middle of the image.
fn ramp(height_m: f64) -> Relief {
    let texels = (0..64).map(|i| [i as f32 / 63.0; 3]).collect();
    Relief::Heights {
        texture: texture(64, 1, texels, TextureFilter::Bilinear),
        height_m,
        terminator: Terminator::Mirrored,
    }
}

#[test]
fn a_ramp_of_heights_is_a_tilted_plane_whatever_the_size_of_the_world() {
    for shape in squares() {
        for (size, height_m) in [(1.0, 0.6), (0.001, -0.0004), (1000.0, 300.0)] {
            let mut bumpy = scene(&shape, 0.5, &sun(), 1.0 * size);
            bumpy.objects[0].transform.linear = [[size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, size]];
            bumpy.camera.position_m = [0.0, 0.0, 3.0 * size];
            bumpy.objects[0].relief = Some(ramp(height_m));
            // Over 2 m of x u grows by 1.
            let slope = height_m * 64.0 / 63.0 / (2.0 * size);
            close(&ys(&bumpy), lit(unit([-slope, 0.0, 1.0])), "ramp");
        }
    }
}

/// Mirroring keeps all light (see `bsdf/shading.rs`): each sample of a white surface under a sky of 1 is worth 1.
#[test]
fn a_white_furnace_stays_white_under_any_map() {
    let noise = |n: u32| (0..64).map(|i: u32| [(i.wrapping_mul(n) % 97) as f32 / 97.0; 3]).collect::<Vec<_>>();
    let normals =
        (0..64).map(|i: u32| [(i * 37 % 97) as f32 / 97.0, (i * 53 % 89) as f32 / 89.0, 0.55 + (i % 7) as f32 / 16.0]);
    let normals = texture(8, 8, normals.collect(), TextureFilter::Bilinear);
    let maps = [
        Relief::Heights {
            texture: texture(8, 8, noise(31), TextureFilter::Bilinear),
            height_m: 0.5,
            terminator: Terminator::Mirrored,
        },
        Relief::Normals {
            texture: normals,
            strength: [1.0; 2],
            bitangent: Bitangent::AlongV,
            terminator: Terminator::Mirrored,
        },
    ];
    let sky = json!([{"type": "environment", "radiance": 1}]);
    let shapes = [
        squares()[0].clone(),
        squares()[1].clone(),
        json!({"type": "sphere", "radius_m": 1}),
        json!({"type": "disk", "normal": [0, 0, 1], "radius_m": 1}),
        json!({"type": "cylinder", "start_m": [-1, 0, 0], "end_m": [1, 0, 0], "radius_m": 0.8}),
    ];
    for shape in shapes {
        for map in &maps {
            let mut furnace = scene(&shape, 1.0, &sky, 1.2);
            furnace.objects[0].relief = Some(map.clone());
            for y in ys(&furnace) {
                // The ends of the observer's table leave 2e-8 of white.
                assert!((y - 1.0).abs() < 1e-7, "{shape}: {y}");
            }
        }
    }
}

fn stripes() -> OpacityImage {
    OpacityImage { texture: texture(2, 1, vec![[0.0; 3], [1.0; 3]], TextureFilter::Nearest), cutoff: None }
}

#[test]
fn an_opacity_image_lets_light_and_shadow_rays_through_where_it_says() {
    for shape in squares() {
        // Behind the square, the sky; the square is black.
        let sky = json!([{"type": "environment", "radiance": 1}]);
        let mut mask = scene(&shape, 0.0, &sky, 2.0);
        mask.objects[0].opacity_image = Some(stripes());
        let seen = ys(&mask);
        for (i, y) in seen.iter().enumerate() {
            assert!((y - f64::from(u8::from(i % 4 < 2))).abs() < 1e-7, "{i}: {y}");
        }
        // A share in between, which `opacity` multiplies: of many paths 1 − 0.5·0.6 pass.
        let mut half = mask.clone();
        half.objects[0].opacity = 0.5;
        half.objects[0].opacity_image =
            Some(OpacityImage { texture: texture(1, 1, vec![[0.6; 3]], TextureFilter::Nearest), cutoff: None });
        half.integrator.spp = 1024;
        let mean = ys(&half).iter().sum::<f64>() / 16.0;
        // 16,384 Sobol points of a yes or no.
        assert!((mean - 0.7).abs() < 0.01, "{mean}");
        // The cutoff makes it all or nothing.
        for (cutoff, want) in [(0.5, 0.5), (0.7, 1.0)] {
            half.objects[0].opacity_image.as_mut().unwrap().cutoff = Some(cutoff);
            let mean = ys(&half).iter().sum::<f64>() / 16.0;
            assert!((mean - want).abs() < 0.01, "{cutoff}: {mean}");
        }
    }
}

#[test]
fn shadows_have_the_shape_of_the_opacity_image() {
    // A floor at z = 0 under a mask at z = 1, lit from straight above; the camera looks from between.
    for shape in squares() {
        let lights = json!([{"type": "directional", "direction": [0, 0, -1], "irradiance": 2}]);
        let mut floor = scene(&squares()[0], 0.5, &lights, 2.0);
        floor.camera.position_m = [0.0, 0.0, 0.5];
        let mut mask = scene(&shape, 0.5, &lights, 2.0).objects.remove(0);
        mask.material = 0;
        mask.transform.translation_m = [0.0, 0.0, 1.0];
        mask.opacity_image = Some(stripes());
        floor.objects.push(mask);
        // Not what the mask's lower side throws back.
        floor.integrator.max_depth = Some(2);
        for (i, y) in ys(&floor).iter().enumerate() {
            let want = if i % 4 < 2 { 0.5 / PI * 2.0 } else { 0.0 };
            assert!((y - want).abs() < 1e-7, "{i}: {y} is not {want}");
        }
    }
}

/// Four columns and two rows: the value says which.
fn patches() -> ImageTexture {
    let texels = (0..8).map(|i| [(1 + i) as f32 / 10.0; 3]).collect();
    texture(4, 2, texels, TextureFilter::Nearest)
}

/// The patches on a shape under a sky of 1, seen along −z, four by four pixels.
fn patched(shape: &Value, linear: [[f64; 3]; 3]) -> Vec<f64> {
    let sky = json!([{"type": "environment", "radiance": 1}]);
    let mut scene = scene(shape, 0.5, &sky, 1.0);
    scene.materials[0].kind = MaterialKind::Lambert { reflectance: SpectrumTexture::Image(patches()) };
    scene.objects[0].transform.linear = linear;
    ys(&scene)
}

const UNTURNED: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn quadrants(seen: &[f64], want: [f64; 4], what: &str) {
    // Upper left, upper right, lower left, lower right.
    for (pixels, want) in [[0, 1, 4, 5], [2, 3, 6, 7], [8, 9, 12, 13], [10, 11, 14, 15]].iter().zip(want) {
        for &i in pixels {
            // Equal energy and a grey texel of single precision.
            assert!((seen[i] - want).abs() < 1e-6, "{what}, pixel {i}: {} is not {want}", seen[i]);
        }
    }
}

#[test]
fn round_shapes_carry_images_as_the_format_says() {
    // Seen from +z: ½ of the longitude in the middle, so columns 1 and 2 of 0 to 3; the north above.
    let ball = json!({"type": "sphere", "center_m": [0, 0, 0], "radius_m": 1});
    quadrants(&patched(&ball, UNTURNED), [0.2, 0.3, 0.6, 0.7], "sphere");
    // A quarter turn about y takes what was at +x to −z, and what was at −x to +z.
    let turn = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    quadrants(&patched(&ball, turn), [0.1, 0.2, 0.5, 0.6], "turned sphere");
    // A disk of radius 0.8: u is ½ + x/1.6, so the middles of the pixels, at ±1/8 and ±3/8, are in columns 1 and 2, or 0 and 3.
    let disk = json!({"type": "disk", "normal": [0, 0, 1], "radius_m": 0.8});
    let seen = patched(&disk, UNTURNED);
    for (i, y) in seen.iter().enumerate() {
        let column = [1, 1, 2, 2][i % 4];
        let want = f64::from(1 + column + 4 * i32::from(i >= 8)) / 10.0;
        assert!(i % 4 == 0 || i % 4 == 3 || (y - want).abs() < 1e-6, "disk, pixel {i}: {y} is not {want}");
    }
    // A tube about x, with its start on the left: v runs to the right, so the lower row is on the left.
    let tube = json!({"type": "cylinder", "start_m": [-1, 0, 0], "end_m": [1, 0, 0], "radius_m": 1});
    let seen = patched(&tube, UNTURNED);
    for (i, y) in seen.iter().enumerate() {
        assert_eq!(*y > 0.45, i % 4 < 2, "tube, pixel {i}: {y}");
    }
}
