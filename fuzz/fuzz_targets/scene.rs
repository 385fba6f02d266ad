//! Scene JSON: what is read can be stored, written and read again, and stays the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::files::Scene;

fuzz_target!(|bytes: &[u8]| {
    let Ok(scene) = Scene::from_json(bytes, "fuzz.json") else { return };
    assert!(scene.to_objects().is_ok());
    let text = scene.to_json().expect("what was read can be written");
    assert_eq!(Scene::from_json(text.as_bytes(), "again.json").as_ref(), Ok(&scene));
    assert_eq!(scene.to_json().as_ref(), Ok(&text));
});
