//! Files that are read as a whole.

use std::fs::{self, File};
use std::io;
use std::path::Path;

/// Opens a plain file for reading. Opening a named pipe would wait until somebody writes to it, and a device may never end: both are
/// refused without being opened.
///
/// # Errors
/// Those of the operating system; what is not a plain file.
pub fn open_plain(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path)?;
    if kind.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory, not a plain file"));
    }
    if !kind.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a pipe or a device, not a plain file"));
    }
    File::open(path)
}

/// All bytes of a plain file.
///
/// # Errors
/// As [`open_plain`].
pub fn read_plain(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::Read::read_to_end(&mut open_plain(path)?, &mut bytes)?;
    Ok(bytes)
}
