//! Reading the text of a file.

use std::io::Read;
use std::path::Path;

use super::{Code, MAX_BYTES, Problem, SceneErrors, Severity, Span};
use crate::problem::LoadError;

/// The text of a file of at most [`MAX_BYTES`], without a byte order mark.
///
/// # Errors
/// [`LoadError::Io`] if it cannot be read, [`LoadError::Invalid`] if it is too large or not UTF-8.
pub fn load_text(path: &Path) -> Result<String, LoadError> {
    let file = etalon_picture::open_plain(path).map_err(|source| LoadError::Io { path: path.to_owned(), source })?;
    read_text(file, path)
}

/// The text that a source gives, under the name that errors call it by.
///
/// # Errors
///
/// As [`load_text`].
pub fn read_text(source: impl Read, path: &Path) -> Result<String, LoadError> {
    let io = |source| LoadError::Io { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    // One byte more than is allowed tells a source that is too large, also a growing one.
    source.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(io)?;
    let refuse = |text: String, code: Code, at: Span, line: usize, column: usize, message: String| {
        LoadError::Invalid(SceneErrors {
            file_name: path.display().to_string(),
            text,
            problems: vec![Problem {
                severity: Severity::Error,
                code,
                message,
                json_path: "$".to_owned(),
                line,
                column,
                span: at,
                hint: None,
                related: None,
            }],
        })
    };
    if bytes.len() > MAX_BYTES {
        let message = format!("the file is larger than {MAX_BYTES} bytes, which is the limit");
        return Err(refuse(String::new(), Code::Limit, Span::new(0, 0), 1, 1, message));
    }
    // As `read` does, whose places count from after the mark.
    if bytes.starts_with("\u{feff}".as_bytes()) {
        bytes.drain(..3);
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let before = String::from_utf8_lossy(&bytes[..good]).into_owned();
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        let message = format!("byte {good} (0x{:02X}) is not UTF-8", bytes[good]);
        // Bytes that are not UTF-8 become U+FFFD in the text; all places before them stay.
        let text = String::from_utf8_lossy(bytes).into_owned();
        refuse(text, Code::NotUtf8, Span::new(good, good + '\u{fffd}'.len_utf8()), line, column, message)
    })
}
