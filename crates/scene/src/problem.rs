//! What can be wrong with a file, and where.

use std::fmt;
use std::io;
use std::path::PathBuf;

/// A stretch of the source text, in bytes: `start..end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// The bytes `start..end`.
    pub const fn new(start: usize, end: usize) -> Self {
        Self { start, end }
    }

    /// The first character of this stretch, for a mark that should not underline a whole object.
    ///
    /// Only for stretches that begin with an ASCII character, as every JSON value but an empty text does.
    pub const fn head(self) -> Self {
        Self { start: self.start, end: if self.end > self.start { self.start + 1 } else { self.end } }
    }

    /// Number of bytes.
    pub const fn len(self) -> usize {
        self.end - self.start
    }

    /// Whether it holds no byte.
    pub const fn is_empty(self) -> bool {
        self.end == self.start
    }

    /// Whether `other` lies wholly inside.
    pub const fn contains(self, other: Self) -> bool {
        self.start <= other.start && other.end <= self.end
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth a look; the file is still used.
    Warning,
    /// The file is refused.
    Error,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $code:ident = $name:literal),* $(,)?) => {
        /// The kind of a problem: a stable name that programs may test for.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $($(#[doc = $doc])+ $code,)*
        }

        impl Code {
            /// Every kind.
            pub const ALL: &'static [Self] = &[$(Self::$code),*];

            /// The stable name, such as `unknown-key`.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$code => $name,)*
                }
            }
        }
    };
}

codes! {
    /// The text is not JSON.
    Syntax = "syntax",
    /// The file is not UTF-8.
    NotUtf8 = "not-utf-8",
    /// The file is larger, or nested deeper, than this program reads.
    Limit = "limit",
    /// The file says a version of the format that this program does not read.
    Version = "version",
    /// A key appears twice in one object.
    DuplicateKey = "duplicate-key",
    /// A key that has no meaning here.
    UnknownKey = "unknown-key",
    /// A key that must be there is not.
    MissingKey = "missing-key",
    /// Keys that exclude each other, or one that needs another.
    KeyConflict = "key-conflict",
    /// Another type of value was expected.
    WrongType = "wrong-type",
    /// A list of another length was expected.
    WrongLength = "wrong-length",
    /// A number that is infinite or not a number.
    NotFinite = "not-finite",
    /// A number outside the range that makes sense.
    OutOfRange = "out-of-range",
    /// A word that is not among the ones that can stand here.
    UnknownWord = "unknown-word",
    /// A name that nothing in the file, nor the program, defines.
    UnknownName = "unknown-name",
    /// Named spectra that stand for each other in a circle.
    Circular = "circular",
    /// A vector without a direction: zero.
    ZeroVector = "zero-vector",
    /// A camera that looks nowhere, or whose `up` is along its view.
    DegenerateView = "degenerate-view",
    /// A shape without extent.
    DegenerateShape = "degenerate-shape",
    /// A transform that cannot be inverted.
    SingularTransform = "singular-transform",
    /// A shape that its transform would turn into another kind of shape.
    NotSimilarity = "not-similarity",
    /// Keyframes that no motion joins.
    Motion = "motion",
    /// A mesh that names a vertex it does not have.
    IndexOutOfRange = "index-out-of-range",
    /// A mesh without triangles.
    EmptyMesh = "empty-mesh",
    /// A reflectance below 0 or above 1.
    Reflectance = "reflectance",
    /// An emission below 0.
    NegativeEmission = "negative-emission",
    /// A wavelength at which something is not known.
    OutsideFit = "outside-fit",
    /// A file that the scene names cannot be read.
    File = "file",
    /// A file that the scene names is of a kind that is not read there.
    FileFormat = "file-format",
    /// A mesh file that is damaged, or holds what makes no sense.
    MeshFile = "mesh-file",
    /// An image file that is damaged, of a kind that is not read, or larger than is read.
    ImageFile = "image-file",
    /// An image over a surface without texture coordinates.
    NoTextureCoordinates = "no-texture-coordinates",
    /// The colours of vertices on a surface whose vertices have none.
    NoVertexColours = "no-vertex-colours",
    /// Something in a file that is not used (a warning).
    LeftOut = "left-out",
    /// Triangles without area were left out (a warning).
    DegenerateTriangles = "degenerate-triangles",
    /// Triangles that repeat others were left out (a warning).
    RepeatedTriangles = "repeated-triangles",
    /// Nothing in the scene emits light (a warning).
    NoLight = "no-light",
    /// The scene has no objects (a warning).
    NoObjects = "no-objects",
    /// The schema that the file names for editors does not exist (a warning).
    NoSchema = "no-schema",
    /// Wavelengths that no eye sees add nothing to the picture (a warning).
    InvisibleWavelengths = "invisible-wavelengths",
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Most characters of a message, a path or a hint; names in a file may be of any length.
const MAX_CHARACTERS: usize = 400;

/// A text for a message: its middle is replaced by an ellipsis if it has more than 400 characters.
pub fn shortened(text: String) -> String {
    let end_of = |count: usize| text.char_indices().nth(count).map(|(at, _)| at);
    if end_of(MAX_CHARACTERS).is_none() {
        return text;
    }
    let head = &text[..end_of(MAX_CHARACTERS * 3 / 4).unwrap_or(0)];
    let tail = text.char_indices().rev().nth(MAX_CHARACTERS / 4 - 2).map_or("", |(at, _)| &text[at..]);
    format!("{head}…{tail}")
}

/// One thing that is wrong, or odd, at one place of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// How bad it is.
    pub severity: Severity,
    /// Its kind.
    pub code: Code,
    /// What is wrong, in a sentence that starts in lower case and has no full stop.
    pub message: String,
    /// Where, as a JSON path: `$.objects[3].shape.radius_m`.
    pub json_path: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, counted in characters (Unicode scalar values).
    pub column: usize,
    /// Where, in bytes of the source text.
    pub span: Span,
    /// What to do about it.
    pub hint: Option<String>,
    /// Another place that has to do with it.
    pub related: Option<Related>,
}

/// Another place that has to do with a problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Related {
    /// What is there: `first here`.
    pub label: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, counted in characters.
    pub column: usize,
    /// Where, in bytes of the source text.
    pub span: Span,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {}[{}]: {}: {}",
            self.line, self.column, self.severity, self.code, self.json_path, self.message
        )?;
        if let Some(hint) = &self.hint {
            write!(f, " ({hint})")?;
        }
        if let Some(related) = &self.related {
            write!(f, " [{}: {}:{}]", related.label, related.line, related.column)?;
        }
        Ok(())
    }
}

/// Everything that is wrong with a file.
///
/// `Display` gives a line for the file and one for each problem; a front end that can draw source code takes
/// [`text`](Self::text) and the problems' spans instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.render())]
pub struct SceneErrors {
    /// Name of the file, for messages.
    pub file_name: String,
    /// Its text; spans count bytes of it.
    pub text: String,
    /// The problems, errors and warnings, in the order of the file. At least one is an error.
    pub problems: Vec<Problem>,
}

impl SceneErrors {
    /// The problems that are errors.
    pub fn errors(&self) -> impl Iterator<Item = &Problem> {
        self.problems.iter().filter(|p| p.severity == Severity::Error)
    }

    /// The problems that are warnings.
    pub fn warnings(&self) -> impl Iterator<Item = &Problem> {
        self.problems.iter().filter(|p| p.severity == Severity::Warning)
    }

    /// A line such as `room.json: 3 errors, 1 warning`.
    pub fn summary(&self) -> String {
        let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let mut line = format!("{}: {}", self.file_name, count(self.errors().count(), "error"));
        match self.warnings().count() {
            0 => {}
            n => line += &format!(", {}", count(n, "warning")),
        }
        line
    }

    fn render(&self) -> String {
        let mut out = self.summary();
        for problem in &self.problems {
            out += &format!("\n{}:{problem}", self.file_name);
        }
        out
    }
}

/// Why a file could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// It could not be read.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// It was read, and refused.
    #[error(transparent)]
    Invalid(#[from] SceneErrors),
}
