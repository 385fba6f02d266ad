//! glTF, text and binary: what is read can be stored and written, and every bound is finite.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::files::Scene;

fuzz_target!(|bytes: &[u8]| {
    let Ok(scene) = Scene::from_gltf(bytes, "fuzz.glb") else { return };
    assert!(scene.to_objects().is_ok());
    assert!(scene.objects.iter().all(|o| o.bounds.is_valid()));
    let text = scene.to_json().expect("what was read can be written");
    assert_eq!(Scene::from_json(text.as_bytes(), "again.json").as_ref(), Ok(&scene));
});
