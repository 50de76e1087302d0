//! Integration tests of the program and of whole renders, in one binary.

mod accuracy;
mod assignment;
mod channels;
mod defaults;
#[cfg(feature = "denoise")]
mod denoise;
mod develop;
mod display;
mod explain;
mod expose;
mod farm;
mod hostile;
mod import;
mod imported_light;
mod instruction_sets;
mod measure;
mod outputs;
mod refusals;
mod renders;
mod scenes;
mod sequences;
mod study;
mod support;
mod surviving;
mod tables;
mod usage;
mod verify;
mod view;
mod without_light;
