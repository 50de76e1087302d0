//! PLY files (Turk 1994): ASCII and binary of either byte order.

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    BeginList, ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use etalon_optics::colour::srgb_decode;

use super::polygon::triangulate;
use super::{MAX_ELEMENTS, MeshError, Part, check_vertex, one_line};
use crate::model::Mesh;

/// Longest header that is read, bytes.
const MAX_HEADER: usize = 1 << 20;

/// Reads a PLY file: elements `vertex` (`x y z`, perhaps `nx ny nz`, perhaps `u v`, `s t` or `texture_u texture_v`) and
/// `face` (a list `vertex_indices` or `vertex_index`); polygons are cut into triangles. Both may have a colour, `red green blue`, `r g b` or `color_0 color_1 color_2`:
/// of floating-point type linear, of unsigned type with the curve of sRGB.
///
/// # Errors
/// If it is no PLY file, ends early, names a vertex that it does not have, or holds a coordinate that is not finite.
pub fn read_ply(bytes: &[u8]) -> Result<Part, MeshError> {
    let header_end = header_end(bytes)?;
    let mut reader = Reader::new(bytes);
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(|e| parser_error(&e, true))?;
    // What the parser makes of line ends must not move the payload.
    let payload = bytes.len() - reader.get_ref().len();
    if payload != header_end {
        return Err(MeshError::new("\"end_header\" must be on its own line"));
    }
    let lines = header.encoding == Encoding::Ascii;
    let mut left_out = Vec::new();
    let (mut vertices, mut faces) = (None, None);
    for (name, element) in &header.elements {
        check_count(element, lines, reader.get_ref().len())?;
        match name.as_str() {
            "vertex" => vertices = Some(read_vertices(&mut reader, element, &header)?),
            "face" => faces = Some(read_faces(&mut reader, element, &header, &mut left_out)?),
            other => {
                read_elements::<Skipped>(&mut reader, element, &header)?;
                if element.count > 0 {
                    left_out.push(format!("its {} elements \"{other}\" are not used", element.count));
                }
            }
        }
    }
    let rest = *reader.get_ref();
    let blank = lines && rest.iter().all(u8::is_ascii_whitespace);
    if !rest.is_empty() && !blank {
        left_out.push(format!("{} bytes after its last element are not read", rest.len()));
    }
    let mut mesh = vertices.ok_or_else(|| MeshError::new("there is no element \"vertex\""))?;
    let faces = faces.ok_or_else(|| MeshError::new("there is no element \"face\": the file has only points"))?;
    let mut face_colours = Vec::new();
    mesh.triangles.reserve_exact(faces.iter().map(|face| face.len().saturating_sub(2)).sum());
    let mut corners = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        corners.clear();
        for &index in face {
            let known = u32::try_from(index).ok().filter(|&known| (known as usize) < mesh.vertices.len());
            let Some(known) = known else {
                let count = mesh.vertices.len();
                let message = format!("face {i} names vertex {index}; there are {count}, counted from 0");
                return Err(MeshError { line: line_of(&header, bytes, header_end, "face", i), message });
            };
            corners.push(known);
        }
        if corners.len() < 3 {
            left_out.push(format!("face {i} has {} corners; a face needs at least 3", corners.len()));
        }
        triangulate(&corners, |v| mesh.vertices[v as usize], &mut mesh.triangles);
        if let Some(colour) = faces.colours.get(i) {
            face_colours.resize(mesh.triangles.len(), *colour);
        }
        if mesh.triangles.len() > MAX_ELEMENTS {
            return Err(MeshError::new(format!("it has more than {MAX_ELEMENTS} triangles")));
        }
    }
    if left_out.len() > 20 {
        let more = left_out.len() - 20;
        left_out.truncate(20);
        left_out.push(format!("{more} more elements or properties are not used"));
    }
    Ok(Part { mesh, face_colours, faces: faces.ends.len(), left_out, ..Part::default() })
}

/// Where the payload begins.
fn header_end(bytes: &[u8]) -> Result<usize, MeshError> {
    if !bytes.starts_with(b"ply") {
        return Err(MeshError::at_line(1, "it does not begin with \"ply\""));
    }
    const END: &[u8] = b"\nend_header";
    let head = &bytes[..bytes.len().min(MAX_HEADER)];
    let end = head.windows(END.len()).position(|window| window == END);
    let end = end.ok_or_else(|| MeshError::new(format!("no \"end_header\" in its first {} bytes", head.len())))?;
    let rest = &bytes[end + END.len()..];
    let line_end = rest.iter().position(|&byte| byte == b'\n').map_or(rest.len(), |at| at + 1);
    Ok(end + END.len() + line_end)
}

/// The line of an element of an ASCII file.
fn line_of(header: &Header, bytes: &[u8], payload: usize, element: &str, index: usize) -> Option<usize> {
    if header.encoding != Encoding::Ascii {
        return None;
    }
    let before: usize =
        header.elements.iter().take_while(|(name, _)| name.as_str() != element).map(|(_, e)| e.count).sum();
    Some(bytes[..payload].iter().filter(|&&byte| byte == b'\n').count() + before + index + 1)
}

/// Refuses a count that the file cannot hold, before anything is made of it.
fn check_count(element: &ElementDef, lines: bool, bytes: usize) -> Result<(), MeshError> {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    // An element of a binary file takes at least this many bytes, one of an ASCII file a digit and a space a property.
    let least: usize = element
        .properties
        .iter()
        .map(|(_, property)| match &property.data_type {
            _ if lines => 2,
            PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
        })
        .sum();
    let (name, count) = (&element.name, element.count);
    if count > 0 && least == 0 {
        return Err(MeshError::new(format!("its {count} elements \"{name}\" have no properties")));
    }
    // The last line may lack its end.
    if count > 0 && count.checked_mul(least).is_none_or(|needed| needed > bytes + 1) {
        let message =
            format!("its header promises {count} elements \"{name}\", but {bytes} bytes are too few for them");
        return Err(MeshError::new(message));
    }
    if count > MAX_ELEMENTS {
        return Err(MeshError::new(format!("{count} elements \"{name}\" are more than {MAX_ELEMENTS}")));
    }
    Ok(())
}

fn parser_error(error: &ParseError, lines: bool) -> MeshError {
    let text = error.to_string();
    // The parser puts the line before its message.
    let message = match (error.line(), text.split_once(": ")) {
        (Some(_), Some((_, message))) => message,
        _ => &text,
    };
    MeshError { line: error.line().filter(|_| lines), message: one_line(message) }
}

fn read_elements<E: PropertyAccess>(
    reader: &mut Reader<&[u8]>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, MeshError> {
    let lines = header.encoding == Encoding::Ascii;
    Parser::new().read_payload_for_element(reader, element, header).map_err(|e| parser_error(&e, lines))
}

/// Whether an element says the colours of what it is about.
fn has_colours(element: &ElementDef) -> bool {
    let has = |name: &str| element.properties.iter().any(|(key, _)| key.as_str() == name);
    COLOUR_NAMES.iter().any(|names| names.iter().copied().all(has))
}

/// A mesh without triangles.
fn read_vertices(reader: &mut Reader<&[u8]>, element: &ElementDef, header: &Header) -> Result<Mesh, MeshError> {
    let has = |name: &str| element.properties.iter().any(|(key, _)| key.as_str() == name);
    if let Some(missing) = ["x", "y", "z"].into_iter().find(|name| !has(name)) {
        return Err(MeshError::new(format!("its vertices have no property \"{missing}\"")));
    }
    let normals = ["nx", "ny", "nz"].into_iter().all(has);
    let uvs = UV_NAMES.iter().any(|names| names.iter().copied().all(has));
    let first_line = reader.line();
    let read = read_elements::<Vertex>(reader, element, header)?;
    let colours = has_colours(element);
    let mut all = Mesh { vertices: Vec::with_capacity(read.len()), ..Mesh::default() };
    for (i, mut vertex) in read.into_iter().enumerate() {
        let uv = vertex.uv;
        check_vertex(i, vertex.position, normals.then_some(&mut vertex.normal))
            .and_then(|()| match uvs && !uv.iter().all(|v| v.is_finite()) {
                true => Err(format!("the texture coordinates of vertex {i} are {uv:?}")),
                false => Ok(()),
            })
            .map_err(|message| MeshError {
                line: (header.encoding == Encoding::Ascii).then_some(first_line + i),
                message,
            })?;
        all.vertices.push(vertex.position);
        if normals {
            all.normals.push(vertex.normal);
        }
        if uvs {
            all.uvs.push(uv);
        }
        if colours {
            all.colours.push(vertex.colour);
        }
    }
    Ok(all)
}

fn read_faces(
    reader: &mut Reader<&[u8]>,
    element: &ElementDef,
    header: &Header,
    left_out: &mut Vec<String>,
) -> Result<Faces, MeshError> {
    let (mut found, colours) = (false, has_colours(element));
    for (name, property) in &element.properties {
        let whole = |scalar: &ScalarType| !matches!(scalar, ScalarType::Float | ScalarType::Double);
        match &property.data_type {
            PropertyType::List(_, scalar) if is_corners(name.as_str()) && whole(scalar) => found = true,
            PropertyType::Scalar(_) if colours && channel(name.as_str()).is_some() => {}
            _ => left_out.push(format!("the property \"{name}\" of its faces is not used")),
        }
    }
    if !found {
        return Err(MeshError::new("its faces have no list of whole numbers \"vertex_indices\""));
    }
    let mut faces = Faces { corners: Vec::new(), ends: Vec::with_capacity(element.count), colours: Vec::new() };
    // Some at a time: as the parser gives them, each with a list of its own, they take four times the memory of the file.
    let mut some = element.clone();
    let mut left = element.count;
    while left > 0 {
        some.count = left.min(FACES_AT_ONCE);
        left -= some.count;
        for face in read_elements::<Face>(reader, &some, header)? {
            faces.corners.extend(face.indices());
            faces.ends.push(faces.corners.len());
            if colours {
                faces.colours.push(face.colour);
            }
        }
    }
    Ok(faces)
}

/// Faces that the parser is asked for at once.
const FACES_AT_ONCE: usize = 1 << 12;

/// The corners of polygons, one after the other, and where those of each end.
struct Faces {
    corners: Vec<i64>,
    ends: Vec<usize>,
    /// One for each polygon, if there are any.
    colours: Vec<[f32; 3]>,
}

impl Faces {
    fn iter(&self) -> impl Iterator<Item = &[i64]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(&start, &end)| &self.corners[start..end])
    }
}

fn is_corners(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

/// How files name texture coordinates.
const UV_NAMES: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];

/// How files name the channels of colours.
const COLOUR_NAMES: [[&str; 3]; 3] = [["red", "green", "blue"], ["r", "g", "b"], ["color_0", "color_1", "color_2"]];

/// Which channel of a colour a property says.
fn channel(name: &str) -> Option<usize> {
    COLOUR_NAMES.iter().find_map(|names| names.iter().position(|known| *known == name))
}

/// A channel of a colour in linear terms: integers have the curve of sRGB, as image files do.
fn channel_value(value: &Property) -> Option<f32> {
    match value {
        Property::UChar(v) => Some(srgb_decode(f64::from(*v) / 255.0) as f32),
        Property::UShort(v) => Some(srgb_decode(f64::from(*v) / 65535.0) as f32),
        Property::Float(v) => Some(*v),
        Property::Double(v) => Some(*v as f32),
        _ => None,
    }
}

/// An element of which nothing is kept.
#[derive(Debug)]
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

#[derive(Debug, Default)]
struct Vertex {
    position: [f64; 3],
    normal: [f32; 3],
    uv: [f32; 2],
    colour: [f32; 3],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if let Some(channel) = channel(name) {
            return match channel_value(&value) {
                Some(number) => {
                    self.colour[channel] = number;
                    PropertyAccessResult::Set
                }
                None => PropertyAccessResult::Ignored,
            };
        }
        let number = match value {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            _ => return PropertyAccessResult::Ignored,
        };
        match name {
            "x" => self.position[0] = number,
            "y" => self.position[1] = number,
            "z" => self.position[2] = number,
            "nx" => self.normal[0] = number as f32,
            "ny" => self.normal[1] = number as f32,
            "nz" => self.normal[2] = number as f32,
            "u" | "s" | "texture_u" => self.uv[0] = number as f32,
            "v" | "t" | "texture_v" => self.uv[1] = number as f32,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// The corners of a polygon, in the type that the file gives them, if that is a usual one.
#[derive(Debug, Default)]
struct Face {
    signed: Vec<i32>,
    unsigned: Vec<u32>,
    colour: [f32; 3],
}

impl Face {
    fn indices(&self) -> impl Iterator<Item = i64> {
        self.signed.iter().map(|&i| i64::from(i)).chain(self.unsigned.iter().map(|&i| i64::from(i)))
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn begin_list_int(&mut self, name: &str, _: usize) -> BeginList<'_, i32> {
        if is_corners(name) { BeginList::Fill(&mut self.signed) } else { BeginList::UseSetter }
    }

    fn begin_list_uint(&mut self, name: &str, _: usize) -> BeginList<'_, u32> {
        if is_corners(name) { BeginList::Fill(&mut self.unsigned) } else { BeginList::UseSetter }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if let (Some(channel), Some(number)) = (channel(name), channel_value(&value)) {
            self.colour[channel] = number;
            return PropertyAccessResult::Set;
        }
        if !is_corners(name) {
            return PropertyAccessResult::Ignored;
        }
        self.signed = match value {
            Property::ListChar(list) => list.into_iter().map(i32::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i32::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i32::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i32::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}
