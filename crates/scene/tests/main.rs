//! Scenes read, refused and written.

mod all_at_once;
mod common;
mod compound_lenses;
mod documentation;
mod environments;
mod errors;
mod luminaires;
mod measured;
mod media;
mod meshes;
mod neighbours;
mod round_trip;
mod schema;
mod textures;
mod vocabulary;
