//! What files are: whole or cut off, as they were or not.

use std::io::{self, Read};

use lod_budget::bake::Mesh;
use lod_budget::bake::progressive::{Cursor, Extent, Progressive, Stream};
use lod_budget::bake::shapes::icosphere;
use lod_budget::bake::simplify::{GarlandHeckbert, Target};
use proptest::prelude::*;

use super::meshes::{any_mesh, bits, bumped, dressed, progressive, ragged};

fn small() -> Progressive {
    let mesh = ragged(dressed(bumped(icosphere(3), 0.1, 5), 2));
    progressive(&mesh, GarlandHeckbert::default(), 0)
}

/// All that can be had from a file is a mesh, or an error that names file and byte.
fn use_all(mesh: &Progressive) {
    let mut cursor = Cursor::new(mesh);
    loop {
        assert_eq!(cursor.mesh(mesh).check(), Ok(()));
        assert!(cursor.positions().iter().all(|p| p.is_finite()));
        match cursor.refine(mesh) {
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => {
                assert!(error.file == "torn.lodp" && error.place.is_some(), "{error}");
                break;
            }
        }
    }
    if let Ok(Some(original)) = mesh.original() {
        assert_eq!(original.check(), Ok(()));
    }
}

#[test]
fn a_file_that_is_cut_off_anywhere_gives_what_is_whole() {
    let whole = small();
    let bytes = whole.bytes();
    let base = whole.sizes().base;
    let mut most = 0;
    for end in 0..bytes.len() {
        match Progressive::from_bytes(bytes[..end].to_vec(), "torn.lodp") {
            Ok((mesh, Extent::Truncated { splits_read })) => {
                assert_eq!(splits_read, mesh.splits());
                assert!(splits_read >= most && mesh.original() == Ok(None));
                let prefix = mesh.extract(Target::error(0.0)).expect("its splits are whole");
                assert_eq!((prefix.splits, prefix.mesh.check()), (splits_read, Ok(())));
                most = splits_read;
            }
            Ok((_, Extent::Whole)) => panic!("{end} bytes are not all"),
            Err(error) => {
                assert!(error.to_string().starts_with("torn.lodp: byte "), "{error}");
                assert!(most == 0 && end < base);
            }
        }
    }
    assert_eq!(most, whole.splits());
    let (_, extent) = Progressive::from_bytes(bytes.to_vec(), "torn.lodp").expect("it is whole");
    assert_eq!(extent, Extent::Whole);
    let longer = [bytes, b"HEAD"].concat();
    assert!(Progressive::from_bytes(longer, "torn.lodp").is_err());
}

#[test]
fn what_is_no_such_file_is_refused_by_name_and_byte() {
    let refused = |bytes: &[u8]| match Progressive::from_bytes(bytes.to_vec(), "torn.lodp") {
        Ok(_) => panic!("must be refused"),
        Err(error) => error.to_string(),
    };
    assert_eq!(refused(b"ply\n"), "torn.lodp: byte 0: it must begin as a progressive mesh does");
    assert_eq!(refused(b""), "torn.lodp: byte 0: it must not end before its base mesh does");
    let mut later = small().bytes().to_vec();
    later[7] = 2;
    assert_eq!(refused(&later), "torn.lodp: byte 7: its version must be 1");
    later[7] = 1;
    later[20] ^= 4;
    assert_eq!(refused(&later), "torn.lodp: byte 8: a part must be as its checksum says");
}

#[test]
fn positions_are_finite_at_the_base_and_after_splits() {
    let whole = progressive(&bumped(icosphere(0), 0.1, 5).into(), GarlandHeckbert::default(), 0);
    let changes = (8..whole.bytes().len()).flat_map(|at| (0..=255).step_by(15).map(move |to| (at, to)));
    let rules: Vec<(bool, String)> = changes
        .filter_map(|(at, to)| {
            let mut bytes = whole.bytes().to_vec();
            bytes[at] = to;
            sum_up(&mut bytes);
            let read = Progressive::from_bytes(bytes, "torn.lodp");
            read.map(|(mesh, _)| {
                use_all(&mesh);
                mesh.verify().err().map(|error| (true, error.rule))
            })
            .unwrap_or_else(|error| Some((false, error.rule)))
        })
        .collect();
    for after_splits in [false, true] {
        assert!(rules.contains(&(after_splits, "a position must be finite".into())), "{after_splits}");
    }
}

#[test]
fn a_slow_reader_shows_more_and_more() {
    /// Gives a few bytes at a time, and at times none.
    struct Slow<'a>(&'a [u8], u32);
    impl Read for Slow<'_> {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            self.1 += 1;
            if self.1.is_multiple_of(3) {
                return Err(io::ErrorKind::Interrupted.into());
            }
            let room = into.len().min(7);
            self.0.read(&mut into[..room])
        }
    }
    let mesh: Mesh = dressed(bumped(icosphere(16), 0.02, 5), 2);
    let whole = progressive(&mesh, GarlandHeckbert::default(), 0);
    assert!(whole.marks().count() > 2, "it must have several blocks");
    let (mut stream, mut reader) = (Stream::new("slow.lodp"), Slow(whole.bytes(), 0));
    let (mut cursor, mut stages) = (None, Vec::new());
    while stream.read(&mut reader, 300).expect("it reads from memory") > 0 {
        stream.advance().expect("a good file");
        let Some(mesh) = stream.mesh() else { continue };
        let cursor = cursor.get_or_insert_with(|| Cursor::new(mesh));
        while cursor.refine(mesh).expect("a good file") {}
        assert_eq!(cursor.splits(), mesh.splits());
        assert_eq!(cursor.mesh(mesh).check(), Ok(()));
        stages.push(cursor.splits());
    }
    stages.dedup();
    assert!(stages.len() > 2 && stages.last() == Some(&whole.splits()), "{stages:?}");
    let (read, extent) = stream.finish().expect("a good file");
    assert_eq!(extent, Extent::Whole);
    assert_eq!(bits(&read.original().expect("a good file").expect("it is whole")), bits(&mesh));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn bytes_that_are_not_as_they_were_are_found_out(at in any::<prop::sample::Index>(), change in 1..=255u8) {
        let whole = small();
        let mut bytes = whole.bytes().to_vec();
        bytes[at.index(whole.bytes().len())] ^= change;
        if let Ok((mesh, extent)) = Progressive::from_bytes(bytes, "torn.lodp") {
            // What a length says may be out of reach.
            prop_assert_ne!(extent, Extent::Whole);
            use_all(&mesh);
        }
    }

    /// With checksums that fit: only what records say can be looked at.
    #[test]
    fn records_that_mean_nothing_do_no_harm(
        mesh in any_mesh(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let whole = progressive(&mesh, GarlandHeckbert::default(), 0);
        let mut bytes = whole.bytes().to_vec();
        for (at, to) in changes {
            bytes[8 + at.index(whole.bytes().len() - 8)] = to;
        }
        sum_up(&mut bytes);
        match Progressive::from_bytes(bytes, "torn.lodp") {
            Ok((mesh, _)) => use_all(&mesh),
            Err(error) => prop_assert!(error.to_string().starts_with("torn.lodp: byte "), "{}", error),
        }
    }
}

/// Gives every part the checksum of what it holds by now: FNV-1a in four lanes, as the format has it.
fn sum_up(bytes: &mut [u8]) {
    let mut start = 8;
    while start + 8 <= bytes.len() {
        let length = u32::from_le_bytes(bytes[start + 4..start + 8].try_into().expect("four bytes")) as usize;
        let end = start + 8 + length;
        if end + 8 > bytes.len() {
            return;
        }
        let sum = checksum(&bytes[start..end]);
        bytes[end..end + 8].copy_from_slice(&sum.to_le_bytes());
        start = end + 8;
    }
}

fn checksum(bytes: &[u8]) -> u64 {
    let step = |hash: u64, word: u64| {
        let mixed = (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        mixed ^ mixed >> 32
    };
    let words = bytes.len() / 32 * 4;
    let mut lanes = [1u64, 2, 3, 4].map(|lane| 0xcbf2_9ce4_8422_2325u64.wrapping_mul(lane));
    for word in 0..words {
        let eight = bytes[8 * word..][..8].try_into().expect("eight bytes");
        lanes[word % 4] = step(lanes[word % 4], u64::from_le_bytes(eight));
    }
    let hash = lanes.into_iter().fold(bytes.len() as u64, step);
    bytes[8 * words..].iter().fold(hash, |hash, &byte| step(hash, u64::from(byte)))
}
