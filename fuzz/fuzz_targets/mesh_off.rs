//! OFF: what is read is whole, stays so when it is repaired, and is no larger than its bytes allow.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::bake::Format;
use lod_budget::bake::read::from_bytes;
use lod_budget::bake::repair::repair;

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut file) = from_bytes(bytes, "fuzz.off", Format::Off) else { return };
    assert_eq!(file.mesh.check(), Ok(()));
    assert!(file.mesh.triangles.len() <= bytes.len());
    repair(&mut file.mesh, &mut file.origins);
    assert_eq!(file.mesh.check(), Ok(()));
    assert!(file.mesh.positions.iter().all(|p| p.is_finite()));
});
