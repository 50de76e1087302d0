//! Normal and bump maps of Mitsuba and pbrt, imported and rendered: a grey square under parallel light, whose radiance follows
//! from each program's own conventions, written out here in that program's own axes.

use etalon_import::import_bytes;
use etalon_transport::{Control, prepare};
use std::f64::consts::PI;

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn sum(parts: &[(f64, V)]) -> V {
    std::array::from_fn(|k| parts.iter().map(|(factor, v)| factor * v[k]).sum())
}

fn unit(v: V) -> V {
    sum(&[(1.0 / dot(v, v).sqrt(), v)])
}

/// The texels of an image of 4 × 4, in 256ths.
type Texels = fn(column: i32, row: i32) -> [i32; 3];

/// An HDR file, which holds numbers of eight bits below 1 exactly.
fn hdr(texels: Texels) -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n".to_vec();
    for place in 0..16 {
        bytes.extend(texels(place % 4, place / 4).map(|v| u8::try_from(v).expect("a byte")));
        bytes.push(128);
    }
    bytes
}

/// Where a square from (−1, −1, 0) to (1, 1, 0) stands, in the axes of its program: the columns of a matrix, of equal lengths and at
/// right angles.
#[derive(Clone, Copy, Debug)]
struct Square {
    columns: [V; 3],
    /// Whether v grows against its second axis.
    mirrored_uv: bool,
    /// Whether its outer side is the one that its third axis points away from.
    inside_out: bool,
}

impl Square {
    fn outward(&self) -> V {
        let n = unit(self.columns[2]);
        if self.inside_out { sum(&[(-1.0, n)]) } else { n }
    }

    /// How a point moves with u and with v, which grow by 1 over the whole square.
    fn along(&self) -> [V; 2] {
        let v = if self.mirrored_uv { -2.0 } else { 2.0 };
        [sum(&[(2.0, self.columns[0])]), sum(&[(v, self.columns[1])])]
    }

    /// Both programs: the vector of a map in the frame of the direction of u, of normal × that, and of the normal.
    fn mapped(&self, [x, y, z]: V) -> V {
        let (n, t) = (self.outward(), unit(self.along()[0]));
        unit(sum(&[(x, t), (y, cross(n, t)), (z, n)]))
    }

    /// Both programs: the normal of the surface that is raised along its normal.
    fn raised(&self, slopes: [f64; 2]) -> V {
        let (n, [u, v]) = (self.outward(), self.along());
        let normal = cross(sum(&[(1.0, u), (slopes[0], n)]), sum(&[(1.0, v), (slopes[1], n)]));
        let outside = dot(normal, n).signum();
        unit(sum(&[(outside, normal)]))
    }

    fn toward_light(&self) -> V {
        unit(sum(&[(0.8, self.outward()), (0.56, unit(self.columns[0])), (-0.2, unit(self.columns[1]))]))
    }

    /// ρ/π·E·cos of albedo ½ and irradiance 2.
    fn lit(&self, normal: V) -> f64 {
        0.5 / PI * 2.0 * dot(normal, self.toward_light())
    }
}

/// The squares that are tried: turned, scaled, mirrored, inside out.
fn squares() -> Vec<Square> {
    // A rotation by rows of small whole numbers.
    let [x, y, z] = [[2.0, 3.0, 6.0], [3.0, -6.0, 2.0], [6.0, 2.0, -3.0]].map(|v: V| v.map(|c| c / 7.0));
    assert!((dot(cross(x, y), z) - 1.0).abs() < 1e-12);
    let mut squares = Vec::new();
    for (scale, mirror) in [(1.0, 1.0), (3.0, 1.0), (1.0, -1.0)] {
        for (mirrored_uv, inside_out) in [(false, false), (true, false), (false, true), (true, true)] {
            let columns = [sum(&[(scale * mirror, x)]), sum(&[(scale, y)]), sum(&[(scale, z)])];
            squares.push(Square { columns, mirrored_uv, inside_out });
        }
    }
    squares
}

fn shown(kind: &str, text: &str, texels: Texels) -> f64 {
    let file = |name: &str| match name {
        "a.hdr" => Ok(hdr(texels)),
        "bare.obj" => {
            Ok(b"v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n".to_vec())
        }
        "normals.obj" => Ok(b"v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
            f 1/1/1 2/2/1 3/3/1 4/4/1\n"
            .to_vec()),
        other => Err(format!("there is no {other}")),
    };
    let imported = import_bytes(kind, text.as_bytes(), &file, "", "a").unwrap_or_else(|why| panic!("{why}\n{text}"));
    assert!(imported.left_out.is_empty(), "{:?}", imported.left_out);
    let scene = imported.parse("a", None).unwrap_or_else(|e| panic!("{e}\n{}", imported.text)).scene;
    let prepared = prepare(&scene).unwrap_or_else(|why| panic!("{why}"));
    let extent = prepared.whole(Some(1));
    prepared.render(&extent, &|_| Control::Continue).unwrap_or_else(|why| panic!("{why}")).mean_y(extent.rect)
}

fn text(v: V, between: &str) -> String {
    v.map(|c| format!("{c:.17}")).join(between)
}

/// The square of Mitsuba, seen from straight outside.
fn mitsuba(square: &Square, map: &str, bare: bool) -> String {
    let (eye, along) = (sum(&[(9.0, square.outward())]), sum(&[(-1.0, square.toward_light())]));
    let [a, b, d] = square.columns;
    let rows = [0, 1, 2].map(|k| format!("{:.17} {:.17} {:.17} 0", a[k], b[k], d[k])).join(" ");
    // Texture coordinates of an OBJ file are turned upside down there, unless it says otherwise. Without normals of its own it is
    // turned inside out by a mirroring transform.
    let shape = match (square.mirrored_uv, bare) {
        (false, _) => "<shape type=\"rectangle\">",
        (true, false) => r#"<shape type="obj"><string name="filename" value="normals.obj"/>"#,
        (true, true) => r#"<shape type="obj"><string name="filename" value="bare.obj"/>"#,
    };
    let flipped = square.inside_out != (square.mirrored_uv && bare && dot(cross(a, b), d) < 0.0);
    format!(
        r#"<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="2"/></integrator>
        <sensor type="perspective"><float name="fov" value="0.01"/>
          <transform name="to_world"><lookat origin="{}" target="0 0 0" up="{}"/></transform>
          <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/></film>
          <sampler type="independent"><integer name="sample_count" value="4"/></sampler></sensor>
        <emitter type="directional"><vector name="direction" value="{}"/><rgb name="irradiance" value="2"/></emitter>
        {shape}<transform name="to_world"><matrix value="{rows} 0 0 0 1"/></transform>
          <boolean name="flip_normals" value="{flipped}"/>{map}</shape></scene>"#,
        text(eye, " "),
        text(a, " "),
        text(along, " ")
    )
}

/// The square of pbrt, whose axes are left-handed unless its camera mirrors; within an object or not.
fn pbrt(square: &Square, material: &str, mirrors: bool, placed: bool) -> String {
    let [a, b, d] = square.columns;
    let eye = sum(&[(9.0, square.outward())]);
    let transform = format!("ConcatTransform [ {} 0 {} 0 {} 0 0 0 0 1 ]\n", text(a, " "), text(b, " "), text(d, " "));
    let uvs = if square.mirrored_uv { "0 1 1 1 1 0 0 0" } else { "0 0 1 0 1 1 0 1" };
    let shape = format!(
        "{}{material}\nShape \"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 1 1 0 -1 1 0 ] \"point2 uv\" [ {uvs} ] \
         \"integer indices\" [ 0 1 2 0 2 3 ]\n",
        if square.inside_out { "ReverseOrientation\n" } else { "" }
    );
    let shape = match placed {
        true => format!("ObjectBegin \"o\"\n{shape}ObjectEnd\n{transform}ObjectInstance \"o\"\n"),
        false => format!("{transform}{shape}"),
    };
    format!(
        "{}LookAt {} 0 0 0 {}\nFilm \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nPixelFilter \"box\"\n\
         Sampler \"independent\" \"integer pixelsamples\" 4\nIntegrator \"path\" \"integer maxdepth\" 1\n\
         Camera \"perspective\" \"float fov\" 0.01\nWorldBegin\n\
         LightSource \"distant\" \"rgb L\" [ 1 1 1 ] \"float scale\" 2 \"point3 from\" [ {} ] \"point3 to\" [ 0 0 0 ]\n{shape}",
        if mirrors { "Scale -1 1 1\n" } else { "" },
        text(eye, " "),
        text(a, " "),
        text(square.toward_light(), " ")
    )
}

/// The film's Y of light of one colour agrees with the import's own sum over wavelengths to this.
const SPECTRAL: f64 = 2e-3;

/// All squares and programs, by what a map makes of their normal and what it would if a sign were another.
fn held(mitsuba_map: &str, pbrt_map: &str, texels: Texels, normals: impl Fn(&Square, bool) -> (V, Vec<V>)) {
    for square in squares() {
        let (want, wrong) = normals(&square, false);
        let want = square.lit(want);
        for wrong in wrong {
            assert!(
                (square.lit(wrong) / want - 1.0).abs() > 20.0 * SPECTRAL,
                "a mutant would not be noticed: {square:?}"
            );
        }
        for bare in [false, true] {
            let got = shown("xml", &mitsuba(&square, mitsuba_map, bare), texels);
            assert!((got / want - 1.0).abs() < SPECTRAL, "Mitsuba, {bare}: {got} is not {want}, {square:?}");
        }
        let want = square.lit(normals(&square, true).0);
        for (mirrors, placed) in [(false, false), (true, false), (false, true), (true, true)] {
            let got = shown("pbrt", &pbrt(&square, pbrt_map, mirrors, placed), texels);
            assert!((got / want - 1.0).abs() < SPECTRAL, "pbrt, {mirrors}, {placed}: {got} is not {want}, {square:?}");
        }
    }
}

#[test]
fn a_normal_map_turns_the_normal_as_its_program_says() {
    let mitsuba = r#"<bsdf type="normalmap"><boolean name="use_shadowing_function" value="false"/>
        <texture type="bitmap" name="normalmap"><string name="filename" value="a.hdr"/><boolean name="raw" value="true"/></texture>
        <bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf></bsdf>"#;
    let pbrt = "Material \"diffuse\" \"float reflectance\" 0.5 \"string normalmap\" \"a.hdr\"";
    let tilts: [(Texels, V); 4] = [
        (|_, _| [168, 128, 248], [40.0, 0.0, 120.0]),
        (|_, _| [88, 128, 248], [-40.0, 0.0, 120.0]),
        (|_, _| [128, 168, 248], [0.0, 40.0, 120.0]),
        (|_, _| [128, 88, 248], [0.0, -40.0, 120.0]),
    ];
    for (texels, [x, y, z]) in tilts {
        held(mitsuba, pbrt, texels, |square, _| {
            (square.mapped([x, y, z]), vec![square.mapped([-x, -y, z]), square.mapped([y, x, z])])
        });
    }
}

#[test]
fn a_bump_map_raises_the_surface_as_its_program_says() {
    let mitsuba = r#"<bsdf type="bumpmap"><boolean name="use_shadowing_function" value="false"/><float name="scale" value="1.5"/>
        <texture type="bitmap"><string name="filename" value="a.hdr"/></texture>
        <bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf></bsdf>"#;
    let pbrt = "Texture \"h\" \"float\" \"imagemap\" \"string filename\" \"a.hdr\" \"float scale\" 0.5\n\
        Texture \"higher\" \"float\" \"scale\" \"texture tex\" \"h\" \"float scale\" 3\n\
        Material \"diffuse\" \"float reflectance\" 0.5 \"texture displacement\" \"higher\"";
    // Even ramps, of four texels over a whole of u and v: steps to the right, and from row to row downward.
    let ramps: [(Texels, [f64; 2]); 4] = [
        (|column, _| [64 + 32 * column; 3], [32.0, 0.0]),
        (|column, _| [192 - 32 * column; 3], [-32.0, 0.0]),
        (|_, row| [64 + 32 * row; 3], [0.0, 32.0]),
        (|_, row| [192 - 32 * row; 3], [0.0, -32.0]),
    ];
    for (texels, steps) in ramps {
        let [right, down] = steps.map(|step| 1.5 * step / 256.0 * 4.0);
        held(mitsuba, pbrt, texels, |square, by_pbrt| {
            // Mitsuba has the first row at v = 0, pbrt at v = 1.
            let down = if by_pbrt { -down } else { down };
            (square.raised([right, down]), vec![square.raised([-right, -down]), square.raised([down, right])])
        });
    }
}
