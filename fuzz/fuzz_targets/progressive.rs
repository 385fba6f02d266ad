//! Progressive meshes: every prefix of what is read is a mesh, and so is the original.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::bake::progressive::{Cursor, Progressive};

fuzz_target!(|bytes: &[u8]| {
    let Ok((progressive, _)) = Progressive::from_bytes(bytes.to_vec(), "fuzz.lodp") else { return };
    let mut cursor = Cursor::new(&progressive);
    loop {
        assert_eq!(cursor.mesh(&progressive).check(), Ok(()));
        if !cursor.refine(&progressive).unwrap_or(false) {
            break;
        }
    }
    while cursor.coarsen() {}
    assert_eq!(cursor.triangles().len(), progressive.base().triangles);
    if let Ok(Some(original)) = progressive.original() {
        assert_eq!(original.check(), Ok(()));
    }
});
