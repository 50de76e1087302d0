//! The program `etalon`.
fn main() {}
