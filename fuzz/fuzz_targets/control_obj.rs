//! Control meshes from OBJ: what is read is whole, and subdivided into meshes that are, or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::bake::read::obj::read_control;
use lod_budget::bake::subdivide::{Placement, Scheme};

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = read_control(bytes, "fuzz.obj") else { return };
    let mesh = file.mesh;
    assert_eq!(mesh.check(), Ok(()));
    assert!(mesh.corners.len() <= bytes.len());
    let Ok(levels) = mesh.subdivided(Scheme::of(&mesh), 1, Placement::Limit) else { return };
    assert!(levels.iter().all(|level| level.check().is_ok()));
});
