//! The `lod` command.
fn main() {}
