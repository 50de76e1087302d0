//! The file of a picture under way: written whole or not at all, checked when it is read.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use etalon::{Channels, Subject};
use etalon_control::{Canvas, Shard, Tile};
use etalon_picture::{PictureError, open_plain, write_atomically};
use etalon_transport::{Features, TileSums};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::args::Adaptive;

const MAGIC: [u8; 8] = *b"ETALON\0\x03";
/// A header is a page of JSON and, with shares, a number for each region; a file that claims more is damaged.
const LARGEST_HEADER: u32 = 1 << 28;
/// The most a tile's own JSON can have: sixteen places of samples that were not finite, and a dozen numbers.
const LARGEST_TILE_HEADER: u32 = 1 << 16;

/// What a file says before its tiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    /// What the picture is of.
    pub subject: Subject,
    /// Which share of the picture's tiles.
    pub shard: Shard,
    /// What ends the render, as it was asked for.
    pub limits: Limited,
    /// Samples a pixel that were settled before the picture began (with shares, in the mean).
    pub samples: u32,
    /// Weights of the regions, where samples are spread by shares.
    pub allocation: Option<Vec<u32>>,
    /// What these samples are to reach: "samples" or "error".
    pub reaches: String,
    /// Which channels the picture is to have.
    pub channels: Channels,
    /// Names of the objects, where a channel tells them apart.
    pub object_names: Option<Vec<String>>,
    /// Seconds spent so far.
    pub seconds: f64,
    /// Whether every tile has the samples that were settled, or time was up.
    pub complete: bool,
}

/// The limits of a render.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Limited {
    /// Most samples a pixel.
    pub samples: u32,
    /// The relative error.
    pub error: Option<f64>,
    /// Seconds.
    pub time_s: Option<f64>,
    /// Whether regions take different numbers of samples.
    pub adaptive: Adaptive,
}

/// A file that was read.
pub(crate) struct Kept {
    /// What it says.
    pub header: Header,
    /// Its tiles, and what their pixels meet first, if it is there.
    pub tiles: Vec<(Tile, TileSums, Vec<Features>)>,
}

/// Why a file of a picture under way cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StateError {
    /// It cannot be read at all.
    #[error("cannot read `{}`", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// It is something else.
    #[error("`{}` is not a checkpoint or part of this version of etalon", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// It is not what was written.
    #[error("`{}` is damaged: {why}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

/// Writes what a canvas holds now, tile by tile, while others may work on it; `features` has what the pixels of each tile meet
/// first, or nothing.
pub(crate) fn write(
    path: &Path,
    header: &Header,
    canvas: &Canvas,
    features: &[Vec<Features>],
) -> Result<(), PictureError> {
    write_atomically(path, |out| {
        let mut out = Hashing { out, hash: Sha256::new() };
        out.write_all(&MAGIC)?;
        out.block(&serde_json::to_vec(header)?)?;
        for number in 0..canvas.tiles() {
            let (tile, sums) = canvas.tile(number);
            if tile.samples > 0 {
                out.block(&serde_json::to_vec(&tile)?)?;
                out.block(&sums.to_bytes())?;
                let of_tile = features.get(number).into_iter().flatten().flat_map(Features::to_array);
                out.block(&of_tile.flat_map(f32::to_le_bytes).collect::<Vec<u8>>())?;
            }
        }
        out.write_all(&0_u32.to_le_bytes())?;
        let hash = out.hash.finalize();
        out.out.write_all(&hash)
    })
}

/// Reads a file and checks it as a whole.
pub(crate) fn read(path: &Path) -> Result<Kept, StateError> {
    let file = open_plain(path).map_err(|source| StateError::Io { path: path.to_owned(), source })?;
    let mut input = Input { input: BufReader::new(file), hash: Sha256::new(), path };
    let mut magic = [0; 8];
    match input.take(&mut magic) {
        Ok(()) if magic == MAGIC => {}
        _ => return Err(StateError::Foreign { path: path.to_owned() }),
    }
    let header: Header = input.json(LARGEST_HEADER)?.ok_or_else(|| input.damaged("it has no header"))?;
    let mut tiles = Vec::new();
    while let Some(tile) = input.json::<Tile>(LARGEST_TILE_HEADER)? {
        let bytes = input.block(u32::MAX)?;
        let (rect, frame) = (tile.rect, header.subject.crop);
        let inside = rect.x0 < rect.x1
            && rect.y0 < rect.y1
            && rect.x0 >= frame.x0
            && rect.y0 >= frame.y0
            && rect.x1 <= frame.x1
            && rect.y1 <= frame.y1;
        let sums = inside
            .then(|| TileSums::from_bytes(&bytes, rect.area(), header.subject.replicates, header.subject.band_sums()))
            .flatten();
        let sums = sums.ok_or_else(|| input.damaged("a tile does not fit into the picture"))?;
        let bytes = input.block(u32::MAX)?;
        let numbers: Vec<f32> =
            bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().expect("four bytes"))).collect();
        let features: Vec<Features> = numbers
            .chunks_exact(Features::NUMBERS)
            .map(|pixel| Features::from_array(pixel.try_into().expect("so many numbers")))
            .collect();
        let expected = if features.is_empty() { 0 } else { rect.area() as usize * Features::NUMBERS * 4 };
        if bytes.len() != expected {
            return Err(input.damaged("a tile's features do not fit into the picture"));
        }
        tiles.push((tile, sums, features));
    }
    let Input { input: mut rest, hash, .. } = input;
    let mut stated = [0; 32];
    let damaged = |why: &str| StateError::Damaged { path: path.to_owned(), why: why.to_owned() };
    rest.read_exact(&mut stated).map_err(|_| damaged("it ends early"))?;
    if stated != hash.finalize()[..] {
        return Err(damaged("its checksum does not match"));
    }
    if rest.read(&mut [0]).map_err(|source| StateError::Io { path: path.to_owned(), source })? != 0 {
        return Err(damaged("something follows its end"));
    }
    Ok(Kept { header, tiles })
}

/// Writes and hashes.
struct Hashing<'a> {
    out: &'a mut dyn Write,
    hash: Sha256,
}

impl Hashing<'_> {
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.out.write_all(bytes)
    }

    /// Bytes with their number before them.
    fn block(&mut self, bytes: &[u8]) -> io::Result<()> {
        let length = u32::try_from(bytes.len()).map_err(io::Error::other)?;
        self.write_all(&length.to_le_bytes())?;
        self.write_all(bytes)
    }
}

/// Reads and hashes.
struct Input<'a> {
    input: BufReader<File>,
    hash: Sha256,
    path: &'a Path,
}

impl Input<'_> {
    fn damaged(&self, why: &str) -> StateError {
        StateError::Damaged { path: self.path.to_owned(), why: why.to_owned() }
    }

    fn take(&mut self, bytes: &mut [u8]) -> Result<(), StateError> {
        self.input.read_exact(bytes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => self.damaged("it ends early"),
            _ => StateError::Io { path: self.path.to_owned(), source: error },
        })?;
        self.hash.update(bytes);
        Ok(())
    }

    fn block(&mut self, most: u32) -> Result<Vec<u8>, StateError> {
        let mut length = [0; 4];
        self.take(&mut length)?;
        let length = u32::from_le_bytes(length);
        if length > most {
            return Err(self.damaged("a block is longer than the largest possible"));
        }
        // By what is there, not by what is claimed.
        let mut bytes = Vec::new();
        let read = (&mut self.input).take(u64::from(length)).read_to_end(&mut bytes);
        match read {
            Ok(read) if read == length as usize => {}
            Ok(_) => return Err(self.damaged("it ends early")),
            Err(source) => return Err(StateError::Io { path: self.path.to_owned(), source }),
        }
        self.hash.update(&bytes);
        Ok(bytes)
    }

    /// JSON, or `None` where its length is zero.
    fn json<T: serde::de::DeserializeOwned>(&mut self, most: u32) -> Result<Option<T>, StateError> {
        let bytes = self.block(most)?;
        if bytes.is_empty() {
            return Ok(None);
        }
        serde_json::from_slice(&bytes).map(Some).map_err(|error| self.damaged(&error.to_string()))
    }
}
