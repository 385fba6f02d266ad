//! Impostor JSON: what is read is written back as it was, and every direction has pictures of it.
#![no_main]

use glam::DVec3;
use libfuzzer_sys::fuzz_target;
use lod_budget::bake::impostor::Impostor;

fuzz_target!(|bytes: &[u8]| {
    let Ok(impostor) = Impostor::from_json(bytes, "fuzz.json") else { return };
    let text = impostor.to_json().expect("what was read can be written");
    assert_eq!(Impostor::from_json(text.as_bytes(), "again.json").as_ref(), Ok(&impostor));
    for direction in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.3, 0.4, -1.0)] {
        let sights = impostor.sights(direction);
        assert!(sights.iter().all(|sight| sight.frame < impostor.frames.len()));
    }
});
