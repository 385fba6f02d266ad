//! glTF with its buffers inside, as one mesh and mesh by mesh: what is read is whole, can be repaired, and comes back
//! when it is written.
#![no_main]

mod mesh;

use libfuzzer_sys::fuzz_target;
use lod_budget::bake::read::gltf;

fuzz_target!(|bytes: &[u8]| {
    let one = gltf::read(bytes, "fuzz.glb", None).ok();
    let each = gltf::read_meshes(bytes, "fuzz.glb", None).unwrap_or_default();
    for file in one.into_iter().chain(each) {
        mesh::holds(file, bytes.len().max(1 << 20));
    }
});
