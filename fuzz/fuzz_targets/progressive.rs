//! Progressive meshes: every prefix of what is read is a mesh, going back leads to the base again, and the original is
//! a mesh, too.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lod_budget::bake::progressive::{Cursor, Progressive};
use lod_budget::bake::simplify::Target;

fuzz_target!(|bytes: &[u8]| {
    let Ok((progressive, _)) = Progressive::from_bytes(sealed(bytes), "fuzz.lodp") else { return };
    let mut cursor = Cursor::new(&progressive);
    let base = bits(&cursor);
    loop {
        assert_eq!(cursor.mesh(&progressive).check(), Ok(()));
        if !cursor.refine(&progressive).unwrap_or(false) {
            break;
        }
    }
    while cursor.coarsen() {}
    assert_eq!(bits(&cursor), base);
    if let Ok(extracted) = progressive.extract(Target::triangles(progressive.base().triangles + 2)) {
        assert_eq!(extracted.mesh.check(), Ok(()));
    }
    if let Ok(Some(original)) = progressive.original() {
        assert_eq!(original.check(), Ok(()));
        assert_eq!(progressive.verify(), Ok(()));
    }
});

/// What a cursor shows: positions may be no numbers, which equal nothing.
fn bits(cursor: &Cursor) -> (Vec<[u32; 3]>, Vec<u32>, Vec<[u32; 3]>) {
    let positions = cursor.positions().iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    (positions, cursor.wedges().to_vec(), cursor.triangles().to_vec())
}

/// Every part with the checksum that it would have, so that more than that is tried.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let mut start = 8;
    while let Some(length) = bytes.get(start + 4..start + 8) {
        let length = u32::from_le_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let end = start + 8 + length;
        let sum = checksum(bytes.get(start..end).unwrap_or_default());
        let Some(place) = bytes.get_mut(end..end + 8) else { break };
        place.copy_from_slice(&sum.to_le_bytes());
        start = end + 8;
    }
    bytes
}

/// FNV-1a over words of eight bytes in four lanes, then over the lanes and the bytes that are left.
fn checksum(bytes: &[u8]) -> u64 {
    let step = |hash: u64, word: u64| {
        let mixed = (hash ^ word).wrapping_mul(0x0100_0000_01b3);
        mixed ^ mixed >> 32
    };
    let mut lanes = [1, 2, 3, 4].map(|lane| 0xcbf2_9ce4_8422_2325u64.wrapping_mul(lane));
    let (rounds, rest) = bytes.as_chunks::<32>();
    for round in rounds {
        for (lane, word) in lanes.iter_mut().zip(round.as_chunks::<8>().0) {
            *lane = step(*lane, u64::from_le_bytes(*word));
        }
    }
    let hash = lanes.into_iter().fold(bytes.len() as u64, step);
    rest.iter().fold(hash, |hash, &byte| step(hash, u64::from(byte)))
}
