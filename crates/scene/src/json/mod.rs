//! Reading JSON with every error at once, each with its place; and the JSON Schema of what is read.
//!
//! A file format is declared once, by the macros [`record!`](crate::record), [`variants!`](crate::variants) and
//! [`keywords!`](crate::keywords): types whose documentation, keys, defaults and ranges give both the reader
//! ([`Decode::decode`]) and the schema ([`Decode::schema`]). [`read`] then parses a text, decodes it and runs the
//! format's own checks; whatever goes wrong is collected by the [`Reader`] and comes back as one [`SceneErrors`].
//!
//! ```
//! use etalon_scene::json::{self, Optional, Positive, Required};
//!
//! etalon_scene::record! {
//!     /// A ball.
//!     pub struct Ball {
//!         /// Radius, m.
//!         radius_m: Required<Positive>,
//!         /// Number of stripes.
//!         stripes: Required<u32> = "3",
//!         /// Whose it is.
//!         owner: Optional<String>,
//!     }
//! }
//!
//! let text = r#"{ "raduis_m": -1, "owner": 7 }"#;
//! let errors = json::read(text, "ball.json", |ball: Ball, _| Some(ball)).unwrap_err();
//! let lines: Vec<String> = errors.problems.iter().map(ToString::to_string).collect();
//! assert_eq!(lines, [
//!     r#"1:3: error[unknown-key]: $.raduis_m: unknown key "raduis_m" (did you mean "radius_m"?)"#,
//!     r#"1:15: error[out-of-range]: $.raduis_m: -1 is not above 0"#,
//!     r#"1:28: error[wrong-type]: $.owner: expected a string, found a number"#,
//! ]);
//!
//! let (ball, _) = json::read(r#"{ "radius_m": 0.5 }"#, "ball.json", |ball: Ball, _| Some(ball)).unwrap();
//! assert_eq!((ball.radius_m.unwrap().0, ball.stripes.unwrap()), (0.5, 3));
//! ```
//!
//! # Limits
//!
//! So that no text can exhaust stack or memory: at most [`MAX_BYTES`] of text, [`MAX_VALUES`] values and [`MAX_DEPTH`]
//! levels of nesting, and at most [`MAX_PROBLEMS`] errors and as many warnings kept (a last one says how many more there were).

mod decode;
mod load;
mod macros;
mod neighbours;
mod number;
mod object;
mod path;
mod reader;
mod schema;
mod suggest;
mod syntax;

pub use decode::{
    Comment, Decode, Direction, Field, List, Named, NamedEntry, Nullable, Optional, Required, Spanned, keyword, tag,
};
pub use load::{load_text, read_text};
pub(crate) use neighbours::neighbour;
pub use neighbours::{Answer, NEIGHBOURS, Neighbour, Place};
pub use number::{NonNegative, Positive, Whole, bounded, bounded_schema};
pub use object::{ObjectReader, Record, Rule};
pub use reader::{Kind, Node, Reader, read};
pub use schema::{
    FieldSchema, SchemaBuilder, SchemaValue, by_json_type, describe, document_schema, one_of, record_schema,
    tagged_record_schema, words,
};
pub use suggest::{did_you_mean, listed};

pub use crate::problem::{Code, Problem, Related, SceneErrors, Severity, Span};

/// The longest text that is read, bytes: 64 MiB.
pub const MAX_BYTES: usize = 64 << 20;
/// The most values (numbers, strings, lists, objects…) of a text that is read. A value takes some 100 to 300 bytes while
/// a file is read, so this bounds the memory.
pub const MAX_VALUES: usize = 10_000_000;
/// The deepest nesting of arrays and objects that is read.
pub const MAX_DEPTH: usize = 64;
/// The most problems that are kept of one file.
pub const MAX_PROBLEMS: usize = 50;
