//! Tensor files: named arrays of numbers in one file, as the RGL material database and Mitsuba write them.
//!
//! All integers are little-endian. The file begins with the twelve bytes `tensor_file` and 0, the version (two bytes, 1 and 0) and the number
//! of fields (32 bits). A description of each field follows:
//!
//! | bits | what |
//! |---:|---|
//! | 16 | length of its name, in bytes |
//! | 8 each | the name |
//! | 16 | number of its dimensions |
//! | 8 | type of its numbers |
//! | 64 | place of the numbers in the file |
//! | 64 each | extents along its dimensions; the last dimension runs first |

/// How a file begins: the name of the format, and the version.
const BEGINNING: &[u8; 14] = b"tensor_file\0\x01\0";

/// Most fields of a file.
const MOST_FIELDS: u32 = 256;

/// Most dimensions of a field.
const MOST_DIMENSIONS: u16 = 8;

/// Bytes of a number, by its type: none, integers of 8 to 64 bits without and with sign, floating point of 16, 32 and 64 bits.
const WIDTHS: [usize; 12] = [0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8];

/// The type of integers of 8 bits without a sign.
const U8: u8 = 1;

/// The type of floating-point numbers of 32 bits.
const F32: u8 = 10;

/// A named array.
#[derive(Clone, Debug)]
struct Field<'b> {
    name: &'b str,
    kind: u8,
    shape: Vec<usize>,
    numbers: &'b [u8],
}

/// The arrays of a file.
#[derive(Clone, Debug)]
pub(super) struct TensorFile<'b>(Vec<Field<'b>>);

impl<'b> TensorFile<'b> {
    /// The arrays in the bytes of a file. All of them together are no longer than the file.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub(super) fn new(bytes: &'b [u8]) -> Result<Self, String> {
        let mut rest = bytes;
        let beginning = take(&mut rest, BEGINNING.len()).ok_or("this is no tensor file: it is too short")?;
        if beginning[..12] != BEGINNING[..12] {
            return Err("this is no tensor file: it does not begin with \"tensor_file\"".to_owned());
        }
        if beginning != BEGINNING {
            return Err(format!("this tensor file has version {}.{}; 1.0 is read", beginning[12], beginning[13]));
        }
        let count = integer(&mut rest, 4).ok_or("it ends before its fields")?;
        if count > u64::from(MOST_FIELDS) {
            return Err(format!("it says that it has {count} fields; at most {MOST_FIELDS} are read"));
        }
        let mut fields: Vec<Field<'b>> = Vec::new();
        let mut claimed = 0;
        for place in 1..=count {
            let field = Field::read(&mut rest, bytes)
                .ok_or_else(|| format!("it ends within the description of its field {place}"))??;
            if fields.iter().any(|known| known.name == field.name) {
                return Err(format!("it has two fields \"{}\"", shown(field.name)));
            }
            claimed += field.numbers.len() as u128;
            if claimed > bytes.len() as u128 {
                return Err("its fields overlap: together they are longer than the file".to_owned());
            }
            fields.push(field);
        }
        Ok(Self(fields))
    }

    /// Whether it has a field.
    pub(super) fn has(&self, name: &str) -> bool {
        self.0.iter().any(|field| field.name == name)
    }

    /// The extents of a field of floating-point numbers with `D` dimensions, and its numbers.
    ///
    /// # Errors
    /// That there is none, or what it is instead.
    pub(super) fn floats<const D: usize>(&self, name: &str) -> Result<([usize; D], Vec<f32>), String> {
        let field = self.field(name)?;
        let shape = field.shape[..]
            .try_into()
            .map_err(|_| format!("its field \"{name}\" has the extents {:?}; it has {D} of them", field.shape))?;
        if field.kind != F32 {
            return Err(format!("the numbers of its field \"{name}\" are no floating-point numbers of 32 bits"));
        }
        let four = |four: &[u8]| f32::from_le_bytes(four.try_into().expect("four bytes"));
        Ok((shape, field.numbers.chunks_exact(4).map(four).collect()))
    }

    /// The only byte of a field.
    ///
    /// # Errors
    /// That there is no such field.
    pub(super) fn byte(&self, name: &str) -> Result<u8, String> {
        match self.field(name)? {
            Field { kind: U8, numbers: [byte], .. } => Ok(*byte),
            _ => Err(format!("its field \"{name}\" is not one byte")),
        }
    }

    fn field(&self, name: &str) -> Result<&Field<'b>, String> {
        self.0.iter().find(|field| field.name == name).ok_or_else(|| format!("it has no field \"{name}\""))
    }
}

impl<'b> Field<'b> {
    /// The next field of `rest`; its numbers are among `bytes`. `None` if its description is cut off.
    fn read(rest: &mut &'b [u8], bytes: &'b [u8]) -> Option<Result<Self, String>> {
        let length = integer(rest, 2)? as usize;
        let name = take(rest, length)?;
        let dimensions = integer(rest, 2)?;
        let kind = integer(rest, 1)? as u8;
        let at = integer(rest, 8)?;
        let Ok(name) = std::str::from_utf8(name) else {
            return Some(Err("the name of a field is no text".to_owned()));
        };
        if dimensions > u64::from(MOST_DIMENSIONS) {
            let name = shown(name);
            return Some(Err(format!(
                "its field \"{name}\" has {dimensions} dimensions; at most {MOST_DIMENSIONS} are read"
            )));
        }
        let mut shape = Vec::new();
        for _ in 0..dimensions {
            shape.push(integer(rest, 8)?);
        }
        Some(Self::at(name, kind, &shape, at, bytes))
    }

    /// The field whose numbers begin at a place.
    fn at(name: &'b str, kind: u8, shape: &[u64], at: u64, bytes: &'b [u8]) -> Result<Self, String> {
        let width = WIDTHS.get(usize::from(kind)).copied().filter(|width| *width > 0);
        let Some(width) = width else {
            return Err(format!("the numbers of its field \"{}\" are of the unknown type {kind}", shown(name)));
        };
        let length = shape.iter().try_fold(width as u64, |length, extent| length.checked_mul(*extent));
        let end = length.and_then(|length| length.checked_add(at));
        let numbers = end.and_then(|end| bytes.get(usize::try_from(at).ok()?..usize::try_from(end).ok()?));
        let Some(numbers) = numbers else {
            let (name, file) = (shown(name), bytes.len());
            return Err(format!("its field \"{name}\" of the extents {shape:?} does not fit into its {file} bytes"));
        };
        // An extent is no larger than what lies in the file, unless another one is 0.
        let shape = shape.iter().map(|extent| usize::try_from(*extent).unwrap_or(usize::MAX)).collect();
        Ok(Self { name, kind, shape, numbers })
    }
}

/// The next bytes of `rest`.
fn take<'b>(rest: &mut &'b [u8], count: usize) -> Option<&'b [u8]> {
    let (first, after) = rest.split_at_checked(count)?;
    *rest = after;
    Some(first)
}

/// The next integer of `rest`, of at most eight bytes.
fn integer(rest: &mut &[u8], bytes: usize) -> Option<u64> {
    Some(take(rest, bytes)?.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
}

/// The name of a field as messages show it.
fn shown(name: &str) -> String {
    name.chars().take(40).flat_map(char::escape_debug).collect()
}
