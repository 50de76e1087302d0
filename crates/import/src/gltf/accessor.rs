//! Numbers of a glTF buffer, every place in it checked.

use etalon_scene::mesh::MAX_ELEMENTS;
use gltf::accessor::{DataType, Dimensions};
use gltf::{Accessor, buffer};

/// The most elements of an accessor without data: they are zeros, for which the file needs no bytes.
pub(super) const MOST_WITHOUT_DATA: usize = 1 << 24;
pub(super) const TOO_MANY_WITHOUT_DATA: &str = "it has more than 2^24 elements without data";

/// All numbers of an accessor, `N` an element, 16 of a matrix by columns; normalised integers as numbers from 0 or −1 to 1.
pub(super) fn numbers<const N: usize>(accessor: &Accessor<'_>, buffers: &[Vec<u8>]) -> Result<Vec<[f64; N]>, String> {
    let place = format!("$.accessors[{}]", accessor.index());
    let fail = |what: &str| format!("{place}: {what}");
    let expected = match N {
        1 => Dimensions::Scalar,
        2 => Dimensions::Vec2,
        3 => Dimensions::Vec3,
        4 => Dimensions::Vec4,
        _ => Dimensions::Mat4,
    };
    if accessor.dimensions() != expected {
        return Err(fail("it has the wrong number of components"));
    }
    let count = accessor.count();
    if count > MAX_ELEMENTS {
        return Err(fail("it has more than 2^29 elements"));
    }
    let (kind, normalized) = (accessor.data_type(), accessor.normalized());
    let element = N * kind.size();
    let mut numbers = Vec::new();
    match accessor.view() {
        Some(view) => {
            let stride = view.stride().unwrap_or(element);
            let bytes = bytes_of(&view, buffers).ok_or_else(|| fail("its buffer view leaves the buffer"))?;
            let needed = count
                .checked_sub(1)
                .map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(element)?.checked_add(accessor.offset()));
            if needed.is_none_or(|needed| needed > bytes.len()) {
                return Err(fail("it leaves its buffer view"));
            }
            numbers.reserve_exact(count);
            for i in 0..count {
                let at = accessor.offset() + i * stride;
                numbers.push(std::array::from_fn(|k| number(&bytes[at + k * kind.size()..], kind, normalized)));
            }
        }
        None if count > MOST_WITHOUT_DATA => return Err(fail(TOO_MANY_WITHOUT_DATA)),
        None => numbers.resize(count, [0.0; N]),
    }
    if let Some(sparse) = accessor.sparse() {
        let (indices, values) = (sparse.indices(), sparse.values());
        let index_kind = match indices.index_type() {
            gltf::accessor::sparse::IndexType::U8 => DataType::U8,
            gltf::accessor::sparse::IndexType::U16 => DataType::U16,
            gltf::accessor::sparse::IndexType::U32 => DataType::U32,
        };
        let part = |view: &buffer::View<'_>, offset: usize, size: usize| {
            let bytes = bytes_of(view, buffers)?;
            let end = offset.checked_add(sparse.count().checked_mul(size)?)?;
            bytes.get(offset..end)
        };
        let outside = || fail("its sparse part leaves its buffer view");
        let at = part(&indices.view(), indices.offset(), index_kind.size()).ok_or_else(outside)?;
        let data = part(&values.view(), values.offset(), element).ok_or_else(outside)?;
        for i in 0..sparse.count() {
            let index = number(&at[i * index_kind.size()..], index_kind, false) as usize;
            let target =
                numbers.get_mut(index).ok_or_else(|| fail("its sparse part names an element that does not exist"))?;
            *target = std::array::from_fn(|k| number(&data[i * element + k * kind.size()..], kind, normalized));
        }
    }
    Ok(numbers)
}

/// The bytes of a view; `None` if it leaves its buffer.
pub(super) fn bytes_of<'b>(view: &buffer::View<'_>, buffers: &'b [Vec<u8>]) -> Option<&'b [u8]> {
    buffers.get(view.buffer().index())?.get(view.offset()..view.offset().checked_add(view.length())?)
}

fn number(bytes: &[u8], kind: DataType, normalized: bool) -> f64 {
    let scaled = |value: f64, largest: f64| if normalized { (value / largest).max(-1.0) } else { value };
    match kind {
        DataType::I8 => scaled(f64::from(bytes[0] as i8), 127.0),
        DataType::U8 => scaled(f64::from(bytes[0]), 255.0),
        DataType::I16 => scaled(f64::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
        DataType::U16 => scaled(f64::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
        DataType::U32 => f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        DataType::F32 => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
    }
}
