//! Primitives that are compressed by Draco: all their attributes and triangles in one stream.

use draco_core::{DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::validation::Checked::Valid;
use gltf::json::validation::USize64;
use gltf::json::{Accessor, Index};
use gltf::mesh::Mode;
use serde_json::Value;

use super::{Decoded, TOO_MUCH, part, whole_number};

pub(super) const NAME: &str = "KHR_draco_mesh_compression";

/// Gives every compressed primitive accessors of its own: others may name those that it states, too.
pub(super) fn undo(out: &mut Decoded<'_>) -> Result<(), String> {
    for mesh in 0..out.root.meshes.len() {
        for primitive in 0..out.root.meshes[mesh].primitives.len() {
            let extensions = out.root.meshes[mesh].primitives[primitive].extensions.as_mut();
            let Some(extension) = extensions.and_then(|e| e.others.remove(NAME)) else { continue };
            write_out(out, [mesh, primitive], &extension)
                .map_err(|why| format!("$.meshes[{mesh}].primitives[{primitive}]: {why}"))?;
        }
    }
    Ok(())
}

fn write_out(out: &mut Decoded<'_>, [mesh, primitive]: [usize; 2], extension: &Value) -> Result<(), String> {
    let left = out.left;
    let (decoded, cost) = decoded(out, extension)?;
    let points = decoded.num_points();
    let stated = out.root.meshes[mesh].primitives[primitive].clone();
    for (semantic, accessor) in &stated.attributes {
        let Valid(semantic) = semantic else { continue };
        // An attribute that is not in the stream has an accessor with data.
        let name = semantic.to_string();
        let Some(id) = extension["attributes"].get(&name).and_then(Value::as_u64) else { continue };
        let attribute = u32::try_from(id).ok().and_then(|id| decoded.attribute_by_unique_id(id));
        let attribute = attribute.ok_or_else(|| format!("its compressed data have no attribute {id}"))?;
        let (like, components, kind) = described(out, *accessor)?;
        let found = usize::from(attribute.num_components());
        if found != components {
            return Err(format!("its {name} has {components} components, but {found} in its compressed data"));
        }
        // Each is four bytes before it is written.
        out.may_become(points.checked_mul(components * size_of::<f32>()))?;
        let mut bytes = Vec::with_capacity(points * components * kind.size());
        for number in attribute.read_f32s(points, components) {
            write(number, kind, &mut bytes);
        }
        let accessor = add(out, like, points, bytes)?;
        out.root.meshes[mesh].primitives[primitive].attributes.insert(Valid(semantic.clone()), accessor);
    }
    // Of triangles, whether they were stated as a list or as a strip.
    let corners: Vec<u8> = decoded.faces().iter().flatten().flat_map(|point| point.0.to_le_bytes()).collect();
    let indices = add(out, without_data(Type::Scalar, ComponentType::U32), 3 * decoded.num_faces(), corners)?;
    let primitive = &mut out.root.meshes[mesh].primitives[primitive];
    (primitive.indices, primitive.mode) = (Some(indices), Valid(Mode::Triangles));
    // A stream counts even if nothing of it is used: many primitives may name it.
    out.left = out.left.min(left.saturating_sub(cost));
    Ok(())
}

/// The mesh of the stream that an extension names, and what it costs of the budget: the larger of its decoded size and the stream's, bytes.
fn decoded(out: &Decoded<'_>, extension: &Value) -> Result<(Mesh, usize), String> {
    let view = extension.as_object().and_then(|extension| whole_number(extension, "bufferView"));
    let view =
        view.and_then(|index| out.root.buffer_views.get(index)).ok_or("its compressed data have no buffer view")?;
    let (offset, length) = (view.byte_offset.map_or(0, |offset| offset.0 as usize), view.byte_length.0 as usize);
    let source = part(out.buffers, view.buffer.value(), offset, length)?;
    out.may_become(Some(source.len()))?;
    let left = out.left as u64;
    let face = size_of::<[u32; 3]>();
    let limits = DecodeLimits::default()
        .with_max_decoded_bytes(left)
        .with_max_faces(left / face as u64)
        .with_max_points(left / size_of::<f32>() as u64);
    let mut stream = DecoderBuffer::new(source).with_limits(limits);
    let mut mesh = Mesh::new();
    MeshDecoder::new().decode(&mut stream, &mut mesh).map_err(|error| match error.kind() {
        ErrorKind::LimitExceeded => TOO_MUCH.to_owned(),
        _ => format!("its compressed data are damaged: {error}"),
    })?;
    let attributes = (0..mesh.num_attributes()).map(|i| mesh.attribute(i));
    let point: usize = attributes.map(|a| usize::from(a.num_components()) * a.data_type().byte_length()).sum();
    let size = point.saturating_mul(mesh.num_points()).saturating_add(face.saturating_mul(mesh.num_faces()));
    let cost = size.max(source.len());
    out.may_become(Some(cost))?;
    Ok((mesh, cost))
}

/// An accessor like another, the components of an element of it, and what each is.
fn described(out: &Decoded<'_>, accessor: Index<Accessor>) -> Result<(Accessor, usize, ComponentType), String> {
    let accessor = out.root.accessors.get(accessor.value()).ok_or("it names an accessor that is not there")?;
    match (&accessor.type_, &accessor.component_type) {
        (Valid(kind), Valid(component)) => {
            // Without its texts: many primitives may name the same one.
            let mut like = without_data(*kind, component.0);
            (like.min, like.max, like.normalized) = (bound(&accessor.min), bound(&accessor.max), accessor.normalized);
            Ok((like, kind.multiplicity(), component.0))
        }
        _ => Err("one of its accessors has an unknown type".to_owned()),
    }
}

/// A copy of a bound of an accessor; `None` if it is no list of few numbers.
fn bound(stated: &Option<Value>) -> Option<Value> {
    let is_bound = |numbers: &Vec<Value>| numbers.len() <= 16 && numbers.iter().all(Value::is_number);
    stated.as_ref().filter(|stated| stated.as_array().is_some_and(is_bound)).cloned()
}

/// Writes a number as a component of an accessor; those of normalised integers are integers in the stream, too.
fn write(number: f32, kind: ComponentType, bytes: &mut Vec<u8>) {
    match kind {
        ComponentType::I8 => bytes.extend((number as i8).to_le_bytes()),
        ComponentType::U8 => bytes.push(number as u8),
        ComponentType::I16 => bytes.extend((number as i16).to_le_bytes()),
        ComponentType::U16 => bytes.extend((number as u16).to_le_bytes()),
        ComponentType::U32 => bytes.extend((number as u32).to_le_bytes()),
        ComponentType::F32 => bytes.extend(number.to_le_bytes()),
    }
}

/// Adds an accessor of `count` elements whose data are `bytes`.
fn add(out: &mut Decoded<'_>, mut accessor: Accessor, count: usize, bytes: Vec<u8>) -> Result<Index<Accessor>, String> {
    out.may_become(Some(bytes.len()))?;
    let view = out.add_view(bytes);
    (accessor.buffer_view, accessor.count) = (Some(view), USize64(count as u64));
    Ok(out.root.push(accessor))
}

fn without_data(kind: Type, component: ComponentType) -> Accessor {
    Accessor {
        buffer_view: None,
        byte_offset: None,
        count: USize64(0),
        component_type: Valid(GenericComponentType(component)),
        extensions: None,
        extras: gltf::json::Extras::default(),
        type_: Valid(kind),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}
