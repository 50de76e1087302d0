//! Words of other programs, and the words that stand for them here.
//!
//! The table only gives hints. A file with a foreign word is refused.

use Answer::{Advice, OneOf, Word, Write};
use Place::{Key, Keyword, Material, Medium, Metal, Spectrum};

/// Where a word can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The key of an object.
    Key,
    /// The value of a `type`, or another word from a fixed list.
    Keyword,
    /// The name of a built-in medium.
    Medium,
    /// The name of a built-in metal.
    Metal,
    /// The name of a material of the file.
    Material,
    /// The name of a spectrum of the file.
    Spectrum,
    /// The name of a group of the file.
    Group,
}

/// What to use instead of a foreign word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// One word, and a remark that may be empty.
    Word(&'static str, &'static str),
    /// One of several words.
    OneOf(&'static [&'static str]),
    /// A JSON value that replaces the name.
    Write(&'static str),
    /// For lists that contain the first word: what to do, since no word of the list means the same.
    Advice(&'static str, &'static str),
}

impl Answer {
    /// Whether the words of this answer are among those that are allowed.
    fn fits(self, allowed: &[&str]) -> bool {
        match self {
            Word(word, _) | Advice(word, _) => allowed.contains(&word),
            OneOf(words) => words.iter().all(|word| allowed.contains(word)),
            Write(_) => true,
        }
    }

    /// The word that surely was meant.
    pub fn word(self) -> Option<&'static str> {
        match self {
            Word(word, _) => Some(word),
            OneOf(_) | Write(_) | Advice(..) => None,
        }
    }

    /// The hint of a message.
    pub fn hint(self) -> String {
        match self {
            Word(word, "") => format!("use \"{word}\""),
            Word(word, remark) => format!("use \"{word}\": {remark}"),
            OneOf(words) => {
                let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
                let (last, others) = quoted.split_last().expect("an answer has words");
                format!("use {} or {last}", others.join(", "))
            }
            Write(json) => format!("write {json}"),
            Advice(_, text) => text.to_owned(),
        }
    }
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Neighbour {
    /// Where the words can be.
    pub place: Place,
    /// The foreign words, separated by spaces. Case, hyphens and underscores do not count.
    pub foreign: &'static str,
    /// What to use instead.
    pub answer: Answer,
}

/// What to use instead of a foreign word, at a place where some words are allowed.
pub(crate) fn neighbour(place: Place, given: &str, allowed: &[&str]) -> Option<Answer> {
    // No word of the table is this long.
    if given.len() > 100 {
        return None;
    }
    let given: String = given.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    let row = NEIGHBOURS.iter().find(|row| {
        row.place == place && row.foreign.split(' ').any(|foreign| foreign == given) && row.answer.fits(allowed)
    });
    row.map(|row| row.answer)
}

const fn row(place: Place, foreign: &'static str, answer: Answer) -> Neighbour {
    Neighbour { place, foreign, answer }
}

const fn key(foreign: &'static str, key: &'static str) -> Neighbour {
    row(Key, foreign, Word(key, ""))
}

const fn word(foreign: &'static str, word: &'static str) -> Neighbour {
    row(Keyword, foreign, Word(word, ""))
}

const METALLIC: &str = "a metal has the type \"conductor\"";
const SURFACE_LIGHT: &str = "give an object an \"emission\": its surface is then the light";

/// Words of Mitsuba, pbrt, Blender with Cycles, and glTF. Where several rows fit, the first counts.
pub const NEIGHBOURS: &[Neighbour] = &[
    // Types of cameras and filters.
    word("pinhole persp", "perspective"),
    row(Keyword, "thinlens realistic", Word("perspective", "its \"lens\" blurs what is out of focus")),
    word("ortho parallel", "orthographic"),
    word("triangle", "tent"),
    word("catmullrom", "mitchell"),
    word("sinc", "lanczos"),
    word("blackmanharris", "gaussian"),
    // Types of materials.
    word("diffuse matte bsdfdiffuse diffusebsdf", "lambert"),
    word("roughdiffuse", "oren-nayar"),
    word("diffusetransmission difftrans translucentbsdf bsdftranslucent leaf paper", "translucent"),
    word("metal metallicbsdf", "conductor"),
    row(Keyword, "roughconductor glossy glossybsdf", Word("conductor", "its \"alpha\" makes it rough")),
    row(Keyword, "coatedconductor", Word("conductor", "metals have no coat here")),
    word("glass glassbsdf refraction refractionbsdf", "dielectric"),
    row(Keyword, "roughdielectric", Word("dielectric", "its \"alpha\" makes it rough")),
    word("coateddiffuse substrate", "plastic"),
    row(Keyword, "roughplastic", Word("plastic", "its \"alpha\" makes it rough")),
    word("principledbsdf bsdfprincipled disney uber standardsurface openpbr pbrmetallicroughness", "principled"),
    word("mix mixbsdf mixshader blendbsdf mixture", "blend"),
    row(
        Keyword,
        "emission emissive emitter area light",
        Word("black", "the \"emission\" of its object makes it a light"),
    ),
    row(Keyword, "null interface none transparentbsdf mask", Advice("lambert", "give the object an \"opacity\"")),
    row(Keyword, "twosided", Advice("lambert", "leave it out: materials here cover both sides")),
    row(Keyword, "bumpmap normalmap", Advice("lambert", "give the object a \"bump_map\" or a \"normal_map\"")),
    // Types of shapes.
    word("ball uvsphere icosphere", "sphere"),
    word("rectangle quad plane square", "parallelogram"),
    word("circle", "disk"),
    word("cube cuboid", "box"),
    row(Keyword, "obj ply plymesh", Word("mesh", "it reads .obj and .ply files by its \"file\"")),
    row(
        Keyword,
        "gltf stl fbx serialized",
        Advice("mesh", "a \"mesh\" reads .obj and .ply files; `etalon import` reads glTF"),
    ),
    word("trianglemesh trimesh bilinearmesh polygonmesh triangles", "mesh"),
    // Types of lights.
    word("envmap infinite constant sky sunsky hdri world dome skydome background ibl", "environment"),
    word("distant sun distantlight sunlight", "directional"),
    word("omni pointlight", "point"),
    word("spotlight", "spot"),
    word("laser collimator collimated laserbeam", "beam"),
    row(Keyword, "area arealight diffuse diffusearea rectlight", Advice("directional", SURFACE_LIGHT)),
    // Types of spectra, and how images are read.
    word("uniform float", "constant"),
    word("spectrum irregular regular sampled piecewise interpolated", "tabulated"),
    word("srgb color colour", "rgb"),
    word("bitmap imagemap texture imagetexture teximage", "image"),
    row(Keyword, "d65", Word("illuminant", "its \"name\" is \"D65\"")),
    word("raw noncolor noncolour", "linear"),
    word("extend clamptoedge", "clamp"),
    word("mirroredrepeat", "mirror"),
    word("linear", "bilinear"),
    word("closest point", "nearest"),
    word("equirectangular latlong spherical", "latitude-longitude"),
    word("octahedral", "equal-area"),
    // Other words.
    word("twosided double doublesided", "both"),
    word("halton zsobol paddedsobol stratified multijitter ldsampler orthogonal pmj02bn", "sobol"),
    word("random uniform", "independent"),
    word("nee emitter", "light"),
    word("bvh", "tree"),
    // Keys of the whole file.
    key("shapes meshes primitives", "objects"),
    key("emitters lamps", "lights"),
    key("bsdfs shaders", "materials"),
    key("sensor", "camera"),
    key("textures colors colours", "spectra"),
    key("renderer render settings", "integrator"),
    key("shapegroups collections", "groups"),
    // Keys of any object.
    key("kind class plugin", "type"),
    key("description note notes", "comment"),
    key("id", "name"),
    key("filename uri url path", "file"),
    // Keys of cameras and film.
    key("origin eye location from", "position_m"),
    key("target to", "look_at_m"),
    row(Key, "fov fieldofview", OneOf(&["vertical_fov_deg", "horizontal_fov_deg"])),
    row(Key, "yfov fovy", Word("vertical_fov_deg", "the full angle in degrees")),
    row(Key, "xfov fovx anglex", Word("horizontal_fov_deg", "the full angle in degrees")),
    key("dof", "lens"),
    row(Key, "apertureradius lensradius thinlens", Advice("lens", "give the \"lens\" a \"radius_m\"")),
    key("apertureradius lensradius aperture", "radius_m"),
    key("fstop aperturefstop", "f_number"),
    key("focaldistance dofdistance", "focus_distance_m"),
    key("orthoscale ymag", "height_m"),
    row(
        Key,
        "shutteropen shutterclose shuttertime",
        Advice("shutter_s", "\"shutter_s\" is a list: when it opens and when it closes"),
    ),
    row(Key, "toworld", Advice("look_at_m", "place the camera by \"position_m\", \"look_at_m\" and \"up\"")),
    key("animation", "keyframes"),
    row(Key, "resolution size", Advice("filter", "give \"width\" and \"height\"")),
    key("xresolution resolutionx resx", "width"),
    key("yresolution resolutiony resy", "height"),
    key("rfilter pixelfilter reconstructionfilter", "filter"),
    // Keys of the integrator.
    key("samples samplecount pixelsamples samplesperpixel", "spp"),
    key("maxbounces bounces", "max_depth"),
    key("rrdepth russianroulette", "roulette"),
    key("lightsampler lightsamplestrategy", "light_selection"),
    key("lighttracer particletracer bidirectional", "light_tracing"),
    // Keys of objects, shapes and transforms.
    key("geometry mesh primitive", "shape"),
    key("bsdf shader", "material"),
    key("emitter arealight emissive emissivefactor", "emission"),
    key("toworld objecttoworld matrix", "transform"),
    key("alpha", "opacity"),
    key("normaltexture", "normal_map"),
    key("bumptexture displacement", "bump_map"),
    key("position location", "center_m"),
    key("points positions p", "vertices_m"),
    key("faces indices polygons", "triangles"),
    key("n", "normals"),
    key("st uv texcoords", "uvs"),
    key("p0", "start_m"),
    key("p1", "end_m"),
    key("translation location", "translate_m"),
    key("rotation", "rotate"),
    key("object shapegroup instanceof prototype collection", "group"),
    // Keys of materials.
    key(
        "diffuse kd basecolor basecolorfactor albedo color colour diffusecolor diffusereflectance specularreflectance tint",
        "reflectance",
    ),
    row(
        Key,
        "roughness roughnessfactor perceptualroughness",
        Word("alpha", "it is the square of the roughness of glTF and Blender"),
    ),
    row(Key, "metallic metallicfactor metalness", Advice("coat", METALLIC)),
    key("material", "metal"),
    key("eta", "n"),
    key("intior ior eta index", "interior"),
    key("extior", "exterior"),
    key("intior ior eta index", "coat"),
    key("intior ior eta", "index"),
    key("fac mixfactor amount", "weight"),
    // Keys of spectra and lights.
    key("color colour value", "rgb"),
    key("lambda lambdas", "wavelengths_nm"),
    key("multiplier", "scale"),
    row(Key, "power energy watts", Word("intensity", "the power divided by 4π, for a point")),
    key("i color colour", "intensity"),
    key("l strength energy illuminance", "irradiance"),
    key("l strength color colour emissioncolor emissionstrength", "radiance"),
    row(Key, "envmap hdri map mapname filename file", Word("image", "an object with the key \"file\"")),
    row(Key, "coneangle cutoffangle outerconeangle", Word("half_angle_deg", "from the axis to the edge, in degrees")),
    row(Key, "spotsize", Word("half_angle_deg", "half of the full angle, in degrees")),
    row(Key, "beamwidth innerconeangle", Word("inner_half_angle_deg", "from the axis, in degrees")),
    // Media and metals.
    row(Medium, "bk7 glassbk7 glass crown", Word("N-BK7", "")),
    row(Medium, "sf11 glasssf11 flint", Word("N-SF11", "")),
    row(Medium, "silica fusedquartz", Word("fused-silica", "")),
    row(Medium, "air vacuum", Write("1")),
    row(Medium, "acrylic acrylicglass pmma", Write("1.49")),
    row(Medium, "ice", Write("1.31")),
    row(Metal, "gold metalaueta metalauk", Word("Au", "")),
    row(Metal, "silver metalageta metalagk", Word("Ag", "")),
    row(Metal, "copper metalcueta metalcuk", Word("Cu", "")),
    row(Metal, "aluminium aluminum metalaleta metalalk", Word("Al", "")),
    // Names that other programs define by themselves.
    row(Spectrum, "d65", Write("{\"type\": \"illuminant\", \"name\": \"D65\"}")),
    row(Spectrum, "a", Write("{\"type\": \"illuminant\", \"name\": \"A\"}")),
    row(Spectrum, "e", Write("{\"type\": \"illuminant\", \"name\": \"E\"}")),
    row(Spectrum, "black", Write("0")),
    row(Material, "diffuse lambert matte", Write("{\"type\": \"lambert\", \"reflectance\": 0.5}")),
    row(Material, "mirror", Write("{\"type\": \"mirror\"}")),
    row(Material, "glass dielectric", Write("{\"type\": \"dielectric\", \"interior\": \"N-BK7\"}")),
    row(Material, "metal conductor", Write("{\"type\": \"conductor\", \"metal\": \"Al\"}")),
    row(Material, "black none", Write("{\"type\": \"black\"}")),
];
