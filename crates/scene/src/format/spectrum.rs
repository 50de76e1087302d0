//! Spectra as a file writes them.

use std::ops::Bound;

use etalon_optics::Illuminant;
use etalon_optics::colour::srgb_decode;

use crate::texture::{Encoding, TextureFilter, Wrap};

use crate::json::{
    Code, Decode, Kind, List, Node, NonNegative, Optional, Positive, Reader, Required, Rule, SchemaBuilder,
    SchemaValue, Span, Spanned, Whole, by_json_type,
};

crate::number! {
    /// A wavelength in nm, from 1 nm to 1 mm.
    pub(crate) struct Wavelength in (Bound::Included(1.0), Bound::Included(1e6));
}

/// A number that must be 0 or above, and for a reflectance at most 1: the check of its role says so, with the place
/// where it is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Density(pub(crate) f64);

impl Decode for Density {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        NonNegative::schema(schema)
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        f64::decode(node, reader).map(Self)
    }
}

crate::record! {
    /// The same value at every wavelength. A plain number means the same.
    pub(crate) struct ConstantSpectrum + comment {
        /// The value.
        value: Required<Spanned<Density>>,
    }
}

crate::record! {
    /// Values at wavelengths, interpolated linearly between them.
    pub(crate) struct TabulatedSpectrum + comment {
        /// The wavelengths, nm, increasing; at least two.
        wavelengths_nm: Required<List<Spanned<Wavelength>>>,
        /// The values, one a wavelength.
        values: Required<List<Spanned<Density>>>,
        /// What holds outside the table: "error" (the file is refused if the rendered range reaches there), "clamp" (the
        /// value at the nearer end) or "zero".
        outside: Required<OutsideTable> = r#""error""#,
        /// Factor on every value.
        scale: Required<NonNegative> = "1",
    }
}

/// What holds outside a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutsideTable {
    Error,
    Clamp,
    Zero,
}

crate::keywords!(OutsideTable {
    /// Nothing is known there: the file is refused if the rendered wavelengths reach there.
    "error" => Self::Error,
    /// The value at the nearer end of the table.
    "clamp" => Self::Clamp,
    /// Zero.
    "zero" => Self::Zero,
});

crate::record! {
    /// Thermal radiance of a black body by Planck's law, W·m⁻²·sr⁻¹·nm⁻¹, times a factor. Emission only.
    pub(crate) struct BlackbodySpectrum + comment {
        /// Temperature, K.
        temperature_k: Required<Positive>,
        /// Factor on Planck's law.
        scale: Required<NonNegative> = "1",
    }
}

crate::record! {
    /// A CIE standard illuminant. Emission only.
    pub(crate) struct IlluminantSpectrum + comment {
        /// Which illuminant.
        name: Required<Illuminant>,
        /// The constant spectrum of the same luminance.
        scale: Required<NonNegative> = "1",
    }
}

crate::record! {
    /// Daylight by its correlated colour temperature (CIE 15): D50 has 5003 K, D55 5503 K, D65 6504 K, D75 7504 K. Emission only.
    pub(crate) struct DaylightSpectrum + comment {
        /// Correlated colour temperature, K: from 4000 to 25000.
        temperature_k: Required<Spanned<Positive>>,
        /// The constant spectrum of the same luminance.
        scale: Required<NonNegative> = "1",
    }
}

crate::keywords!(Illuminant {
    /// Average daylight, 6504 K.
    "D65" => Self::D65,
    /// Equal energy at every wavelength.
    "E" => Self::E,
    /// Incandescent lamp, 2856 K.
    "A" => Self::A,
});

crate::record! {
    /// A smooth spectrum that shows a linear Rec. 709 colour: as a reflectance, under D65; as an emission, by itself.
    pub(crate) struct RgbSpectrum + comment {
        /// The colour, linear Rec. 709 (not gamma-encoded).
        rgb: Required<[Spanned<Density>; 3]>,
        /// Emission only, "D65" if left out: the illuminant that gives the spectrum its structure.
        white: Optional<Spanned<Illuminant>>,
        /// Emission only, 1 if left out: factor on the colour.
        scale: Optional<Spanned<NonNegative>>,
    }
}

crate::record! {
    /// An image over the texture coordinates of a surface: for what a material reflects or a surface emits.
    pub(crate) struct ImageSpectrum + comment {
        /// A PNG, JPEG, BMP, EXR or HDR file, relative to this file's folder.
        file: Required<Spanned<String>>,
        /// How its numbers are to be read.
        encoding: Required<Encoding> = r#""auto""#,
        /// What the image shows beyond its edges.
        wrap: Required<Wrap> = r#""repeat""#,
        /// What it shows beyond its lower and upper edge, if that is another thing.
        wrap_v: Optional<Wrap>,
        /// What it shows between the centres of its texels.
        filter: Required<TextureFilter> = r#""bilinear""#,
        /// Factors on the texture coordinates: 2 shows the image twice.
        uv_scale: Required<[f64; 2]> = "[1, 1]",
        /// Instead: rows of a matrix that the texture coordinates are multiplied by, which may turn and shear the image.
        uv_matrix: Optional<[[f64; 2]; 2]>,
        /// Added to the texture coordinates after that.
        uv_offset: Required<[f64; 2]> = "[0, 0]",
        /// Factor on each channel.
        factor: Required<[Spanned<Density>; 3]> = "[1, 1, 1]",
    } with [Rule::NotBoth("uv_scale", "uv_matrix")]
}

crate::record! {
    /// A chequerboard over the texture coordinates of a surface, where an image may stand: two by two fields in a unit, repeated.
    pub(crate) struct CheckerSpectrum + comment {
        /// The lower left field and the upper right one: a number or a linear Rec. 709 colour.
        first: Required<TextureColour>,
        /// The other two.
        second: Required<TextureColour>,
        /// Factors on the texture coordinates: 2 shows four by four fields.
        uv_scale: Required<[f64; 2]> = "[1, 1]",
        /// Instead: rows of a matrix that the texture coordinates are multiplied by, which may turn and shear the board.
        uv_matrix: Optional<[[f64; 2]; 2]>,
        /// Added to the texture coordinates after that.
        uv_offset: Required<[f64; 2]> = "[0, 0]",
    } with [Rule::NotBoth("uv_scale", "uv_matrix")]
}

crate::record! {
    /// A colour that changes evenly with a texture coordinate from 0 to 1, and stays as it is beyond. It may stand where an image may.
    pub(crate) struct GradientSpectrum + comment {
        /// At 0: a number or a linear Rec. 709 colour.
        from: Required<TextureColour>,
        /// At 1.
        to: Required<TextureColour>,
        /// The coordinate along which it changes.
        along: Required<TextureAxis> = r#""u""#,
        /// Factors on the texture coordinates: 2 shows all of it on half a unit.
        uv_scale: Required<[f64; 2]> = "[1, 1]",
        /// Instead: rows of a matrix that the texture coordinates are multiplied by, which may turn and shear it.
        uv_matrix: Optional<[[f64; 2]; 2]>,
        /// Added to the texture coordinates after that.
        uv_offset: Required<[f64; 2]> = "[0, 0]",
    } with [Rule::NotBoth("uv_scale", "uv_matrix")]
}

crate::record! {
    /// Value noise over the texture coordinates, where an image may stand: random numbers at the points of a lattice, with an even change between them.
    pub(crate) struct NoiseSpectrum + comment {
        /// Where the noise is 0: a number or a linear Rec. 709 colour.
        first: Required<TextureColour>,
        /// Where it is 1.
        second: Required<TextureColour>,
        /// Cells of the lattice in a unit, along u and v; then it repeats.
        cells: Required<[Spanned<Whole<1, MOST_CELLS>>; 2]> = "[8, 8]",
        /// How many lattices are added: each is twice as fine as the one before, and half as strong.
        octaves: Required<Whole<1, 12>> = "1",
        /// Chooses the numbers.
        seed: Required<Whole<0, { u32::MAX as u64 }>> = "1",
        /// Factors on the texture coordinates: 2 shows twice as many cells.
        uv_scale: Required<[f64; 2]> = "[1, 1]",
        /// Instead: rows of a matrix that the texture coordinates are multiplied by, which may turn and shear it.
        uv_matrix: Optional<[[f64; 2]; 2]>,
        /// Added to the texture coordinates after that.
        uv_offset: Required<[f64; 2]> = "[0, 0]",
    } with [Rule::NotBoth("uv_scale", "uv_matrix")]
}

/// Most cells of noise along a side, of its finest lattice.
pub(crate) const MOST_CELLS: u64 = 2048;

crate::record! {
    /// The colours of the vertices of a mesh, interpolated over each triangle: for what a material reflects.
    pub(crate) struct VertexColoursSpectrum + comment {
        /// Factor on each channel.
        factor: Required<[Spanned<Density>; 3]> = "[1, 1, 1]",
        /// An image or a pattern by which they are multiplied.
        image: Optional<Box<SpectrumForm>>,
    }
}

/// A texture coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TextureAxis {
    U,
    V,
}

crate::keywords!(TextureAxis {
    /// The first.
    "u" => Self::U,
    /// The second.
    "v" => Self::V,
});

/// A colour of a texture: a number, or three of linear Rec. 709.
#[derive(Clone, Debug)]
pub(crate) enum TextureColour {
    Grey(Spanned<Density>),
    Rgb(Box<[Spanned<Density>; 3]>),
}

impl TextureColour {
    /// Its channels.
    pub(crate) fn rgb(&self) -> [f64; 3] {
        match self {
            Self::Grey(grey) => [grey.value.0; 3],
            Self::Rgb(rgb) => [0, 1, 2].map(|c| rgb[c].value.0),
        }
    }
}

impl Decode for TextureColour {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        by_json_type(vec![("number", Density::schema(schema)), ("array", <[Density; 3]>::schema(schema))])
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::Array(_) => Decode::decode(node, reader).map(|rgb| Self::Rgb(Box::new(rgb))),
            _ => Spanned::decode(node, reader).map(Self::Grey),
        }
    }
}

crate::keywords!(Encoding {
    /// As the kind of file has it: "srgb" in PNG and JPEG, "linear" in EXR and HDR.
    "auto" => Self::Auto,
    /// By the curve of sRGB.
    "srgb" => Self::Srgb,
    /// Values are proportional to light.
    "linear" => Self::Linear,
});

crate::keywords!(Wrap {
    /// The image repeats.
    "repeat" => Self::Repeat,
    /// The image repeats, mirrored every other time.
    "mirror" => Self::Mirror,
    /// The outermost texels continue.
    "clamp" => Self::Clamp,
});

crate::keywords!(TextureFilter {
    /// Linear interpolation between the four nearest texels.
    "bilinear" => Self::Bilinear,
    /// The nearest texel.
    "nearest" => Self::Nearest,
});

crate::variants! {
    /// A spectrum that takes more than a number to say.
    pub(crate) enum SpectrumObject by "type" {
        "constant" => Constant(ConstantSpectrum),
        "tabulated" => Tabulated(TabulatedSpectrum),
        "blackbody" => Blackbody(BlackbodySpectrum),
        "illuminant" => Illuminant(IlluminantSpectrum),
        "daylight" => Daylight(DaylightSpectrum),
        "rgb" => Rgb(RgbSpectrum),
        "image" => Image(ImageSpectrum),
        "checker" => Checker(CheckerSpectrum),
        "gradient" => Gradient(GradientSpectrum),
        "noise" => Noise(Box<NoiseSpectrum>),
        "vertex-colours" => VertexColours(VertexColoursSpectrum),
    }
}

/// A spectrum as the file writes it.
#[derive(Clone, Debug)]
pub(crate) enum SpectrumForm {
    /// A number: the same at every wavelength.
    Number(Spanned<Density>),
    /// The name of another.
    Name(Spanned<String>),
    /// Anything else.
    Object(SpectrumObject),
}

impl Decode for SpectrumForm {
    fn schema(schema: &mut SchemaBuilder) -> SchemaValue {
        schema.define("Spectrum", |schema| {
            let mut spectrum = by_json_type(vec![
                ("number", Density::schema(schema)),
                ("string", String::schema(schema)),
                ("object", SpectrumObject::schema(schema)),
            ]);
            spectrum["description"] =
                "A spectrum: a number (the same at every wavelength), a name from \"spectra\", or an \
                object with a \"type\"."
                    .into();
            spectrum
        })
    }

    fn decode(node: Node<'_>, reader: &mut Reader<'_>) -> Option<Self> {
        match node.kind() {
            Kind::Number(_) => Spanned::decode(node, reader).map(Self::Number),
            Kind::String(_) => Spanned::decode(node, reader).map(Self::Name),
            Kind::Object => SpectrumObject::decode(node, reader).map(Self::Object),
            other => {
                let message = format!("expected a spectrum (a number, a name or an object), found {}", other.name());
                reader.error_hint(Code::WrongType, reader.span(node), message, list_hint(node));
                None
            }
        }
    }
}

/// What to write instead of a list, which is no spectrum.
fn list_hint(node: Node<'_>) -> String {
    let Some(elements) = node.elements() else { return String::new() };
    let numbers: Option<Vec<f64>> = elements
        .take(4)
        .map(|element| match element.kind() {
            Kind::Number(number) => number.parse().ok(),
            _ => None,
        })
        .collect();
    let Some([red, green, blue]) = numbers.as_deref() else {
        return "a table is {\"type\": \"tabulated\", \"wavelengths_nm\": […], \"values\": […]}".to_owned();
    };
    let colour = [*red, *green, *blue];
    let mut hint = format!("a colour is {}", written(colour));
    if colour.iter().any(|v| *v > 1.0) {
        hint += &format!("; {}", of_bytes(colour));
    }
    hint
}

/// A linear colour as a file writes it.
fn written([red, green, blue]: [f64; 3]) -> String {
    format!("{{\"type\": \"rgb\", \"rgb\": [{red}, {green}, {blue}]}}")
}

/// The hint for a colour that may count from 0 to 255, as image programs do.
pub(super) fn of_bytes(colour: [f64; 3]) -> String {
    let linear = colour.map(|v| (srgb_decode(v / 255.0) * 1e4).round() / 1e4);
    format!("if these numbers are sRGB values from 0 to 255, write {}", written(linear))
}

impl SpectrumForm {
    /// Its place.
    pub(crate) fn at(&self) -> Span {
        match self {
            Self::Number(number) => number.at,
            Self::Name(name) => name.at,
            Self::Object(SpectrumObject::Constant(s)) => s.at,
            Self::Object(SpectrumObject::Tabulated(s)) => s.at,
            Self::Object(SpectrumObject::Blackbody(s)) => s.at,
            Self::Object(SpectrumObject::Illuminant(s)) => s.at,
            Self::Object(SpectrumObject::Daylight(s)) => s.at,
            Self::Object(SpectrumObject::Rgb(s)) => s.at,
            Self::Object(SpectrumObject::Image(s)) => s.at,
            Self::Object(SpectrumObject::Checker(s)) => s.at,
            Self::Object(SpectrumObject::Gradient(s)) => s.at,
            Self::Object(SpectrumObject::Noise(s)) => s.at,
            Self::Object(SpectrumObject::VertexColours(s)) => s.at,
        }
    }
}

/// Whether [`check_table`] has nothing against it.
pub(super) fn sound(wavelengths_nm: &[f64], values: &[f64]) -> bool {
    wavelengths_nm.len() >= 2
        && wavelengths_nm.len() == values.len()
        && wavelengths_nm.windows(2).all(|pair| pair[0] < pair[1])
}

/// Reports what is wrong with a table whatever it is used for.
pub(super) fn check_table(table: &TabulatedSpectrum, reader: &mut Reader<'_>) {
    if let Some(wavelengths) = &table.wavelengths_nm {
        check_increasing(wavelengths, table.at, reader);
    }
    if let (Some(wavelengths), Some(values)) = (&table.wavelengths_nm, &table.values) {
        check_same_length("values", values.0.len(), wavelengths.0.len(), table.at, reader);
    }
}

pub(super) fn check_same_length(key: &str, found: usize, wavelengths: usize, at: Span, reader: &mut Reader<'_>) {
    if found != wavelengths {
        let message = format!("{wavelengths} wavelengths_nm, but {found} {key}");
        reader.error_hint(Code::WrongLength, at.head(), message, "each wavelength needs one");
    }
}

pub(super) fn check_increasing(wavelengths: &List<Spanned<Wavelength>>, at: Span, reader: &mut Reader<'_>) {
    if wavelengths.0.len() < 2 {
        let message = format!("a table needs at least 2 wavelengths, but this one has {}", wavelengths.0.len());
        reader.error_hint(Code::WrongLength, at.head(), message, "for a constant spectrum write a number");
    }
    for pair in wavelengths.0.windows(2) {
        if let [Some(before), Some(after)] = pair
            && after.value.0 <= before.value.0
        {
            let message = format!("wavelengths must increase, but {} follows {}", after.value.0, before.value.0);
            reader.error(Code::OutOfRange, after.at, message);
        }
    }
}
