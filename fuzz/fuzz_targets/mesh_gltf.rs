//! glTF with its buffers inside, as one mesh and mesh by mesh: what is read is whole and stays so when it is repaired.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::bake::read::gltf;
use lod_budget::bake::repair::repair;

fuzz_target!(|bytes: &[u8]| {
    let one = gltf::read(bytes, "fuzz.glb", None).ok();
    let each = gltf::read_meshes(bytes, "fuzz.glb", None).unwrap_or_default();
    for mut file in one.into_iter().chain(each) {
        assert_eq!(file.mesh.check(), Ok(()));
        assert!(file.mesh.triangles.len() <= bytes.len().max(1 << 20));
        repair(&mut file.mesh, &mut file.origins);
        assert_eq!(file.mesh.check(), Ok(()));
        assert!(file.mesh.positions.iter().all(|p| p.is_finite()));
    }
});
