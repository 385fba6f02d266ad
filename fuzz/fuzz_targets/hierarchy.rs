//! Vertex hierarchies: what is read is written back as it was, and can be cut within a budget, into triangles of what is
//! in the cut.
#![no_main]

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use libfuzzer_sys::fuzz_target;
use lod_budget::View;
use lod_budget::bake::hierarchy::{from_bytes, to_bytes};
use lod_budget::hierarchy::{Budget, Cut};

fuzz_target!(|bytes: &[u8]| {
    let sealed = sealed(bytes);
    let Ok(hierarchy) = from_bytes(&sealed, "fuzz.lodh") else { return };
    assert_eq!(from_bytes(&to_bytes(&hierarchy), "again.lodh").as_ref(), Ok(&hierarchy));
    let base = hierarchy.base_triangles();
    let mut cut = Cut::new(Arc::new(hierarchy));
    let view = View::perspective(1.0, Vec2::splat(500.0)).at(Vec3::Z * 2.0, Quat::IDENTITY);
    for triangles in [1000, 0, 100] {
        assert!(cut.update(&[view], &Budget::triangles(triangles)).triangles <= triangles.max(base));
        assert!(cut.triangles().as_flattened().iter().all(|&node| cut.is_active(node)));
    }
});

/// With the checksum that it would have (FNV-1a by words), so that more than that is tried.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    let Some((body, _)) = bytes.split_last_chunk::<8>() else { return bytes.to_vec() };
    let word = |word: &[u8; 4]| u64::from(u32::from_le_bytes(*word));
    let mix = |sum: u64, word: u64| (sum ^ word).wrapping_mul(0x0100_0000_01b3);
    let sum = body.as_chunks::<4>().0.iter().map(word).fold(0xcbf2_9ce4_8422_2325, mix);
    [body, &sum.to_le_bytes()].concat()
}
