//! STL: what is read is whole, no larger than its bytes allow, can be repaired, and comes back when it is written.
#![no_main]

mod mesh;

use libfuzzer_sys::fuzz_target;
use lod_budget::bake::Format;
use lod_budget::bake::read::from_bytes;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = from_bytes(bytes, "fuzz.stl", Format::Stl) {
        mesh::holds(file, bytes.len());
    }
});
