//! `etalon schema`: the JSON Schema of scene files, for editors.
