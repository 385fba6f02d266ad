//! `.lodh`: a hierarchy in a file.
//!
//! Numbers are little-endian. A head of 24 bytes has `LODH`, the version (1), and how many nodes, operations, triangles
//! and apexes there are, 32 bits each. Then come the columns of [`Parts`] in their order: a position in three floats; an
//! operation as two ends, its triangles, error, cone in four bytes, and its sphere in four floats; a triangle as three
//! leaves; an apex. A checksum of 8 bytes over all before it (FNV-1a by words of 32 bits) comes last.

use std::path::Path;

use glam::Vec3;

use super::error::ReadError;
use crate::bounds::Sphere;
use crate::hierarchy::{Cone, Flaw, Hierarchy, Operation, Part, Parts};

const MAGIC: [u8; 4] = *b"LODH";
const VERSION: u32 = 1;
const HEAD: usize = 24;
const CHECKSUM: usize = 8;

/// Bytes of a position, an operation, a triangle and an apex.
const ROWS: [usize; 4] = [12, 36, 12, 4];

/// The hierarchy as the bytes of a file.
pub fn to_bytes(hierarchy: &Hierarchy) -> Vec<u8> {
    let Parts { positions, operations, triangles, apexes } = hierarchy.parts();
    let counts = [positions.len(), operations.len(), triangles.len(), apexes.len()];
    let mut bytes = Vec::with_capacity(length(counts.map(|n| n as u32)).unwrap_or(0));
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    counts.iter().for_each(|&n| bytes.extend((n as u32).to_le_bytes()));
    positions.iter().for_each(|p| put_floats(&mut bytes, p.to_array()));
    operations.iter().for_each(|operation| put_operation(&mut bytes, operation));
    triangles.as_flattened().iter().chain(apexes).for_each(|n| bytes.extend(n.to_le_bytes()));
    let sum = checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

fn put_floats<const N: usize>(bytes: &mut Vec<u8>, floats: [f32; N]) {
    floats.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
}

fn put_operation(bytes: &mut Vec<u8>, operation: &Operation) {
    let [a, b] = operation.ends;
    [a, b, operation.triangles].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    put_floats(bytes, [operation.error]);
    bytes.extend(operation.cone.to_bytes());
    put_floats(bytes, operation.sphere.center.to_array());
    put_floats(bytes, [operation.sphere.radius]);
}

/// The hierarchy of the file at `path`.
///
/// # Errors
/// What cannot be read from disk, and what [`from_bytes`] refuses.
pub fn read(path: &Path) -> Result<Hierarchy, ReadError> {
    let file = path.display().to_string();
    match std::fs::read(path) {
        Ok(bytes) => from_bytes(&bytes, &file),
        Err(error) => Err(ReadError { file, byte: 0, rule: format!("it cannot be read: {error}") }),
    }
}

/// The hierarchy of the bytes of a file, which `file` names in errors. Takes no more memory than a few times the bytes.
///
/// # Errors
/// What is no such file, is cut off or too long, or was changed since it was written, and what [`Hierarchy::new`]
/// refuses: each with the position of what is at fault.
pub fn from_bytes(bytes: &[u8], file: &str) -> Result<Hierarchy, ReadError> {
    let refused = |(byte, rule): (usize, String)| ReadError { file: file.to_owned(), byte, rule };
    let counts = head(bytes).map_err(refused)?;
    let mut rest = &bytes[HEAD..bytes.len() - CHECKSUM];
    let parts = Parts {
        positions: column(&mut rest, counts[0], |row: [u8; 12]| vector(words(row))),
        operations: column(&mut rest, counts[1], operation),
        triangles: column(&mut rest, counts[2], |row: [u8; 12]| words(row)),
        apexes: column(&mut rest, counts[3], u32::from_le_bytes),
    };
    Hierarchy::new(parts).map_err(|flaw| refused((byte_of(&flaw, counts), flaw.rule.to_owned())))
}

/// The counts of the columns, if there are as many bytes as they need, and those that were written.
fn head(bytes: &[u8]) -> Result<[u32; 4], (usize, String)> {
    let whole = |rule: String| Err((bytes.len(), rule));
    let Some((head, _)) = bytes.split_first_chunk::<HEAD>() else {
        return whole(format!("it must have a head of {HEAD} bytes"));
    };
    if head[..4] != MAGIC {
        return Err((0, "it must start with LODH".into()));
    }
    let [_, version, a, b, c, d] = words(*head);
    if version != VERSION {
        return Err((4, format!("its version must be {VERSION}, not {version}")));
    }
    let counts = [a, b, c, d];
    match length(counts) {
        Some(length) if length == bytes.len() => {}
        Some(length) if length > bytes.len() => {
            return whole(format!("it is cut off, and must have {length} bytes"));
        }
        Some(length) => return Err((length, "it must end here".into())),
        None => return Err((8, "it has more parts than fit into memory".into())),
    }
    let (body, sum) = bytes.split_at(bytes.len() - CHECKSUM);
    if checksum(body).to_le_bytes() != *sum {
        return Err((body.len(), "its checksum must be that of the bytes before".into()));
    }
    Ok(counts)
}

/// How long a file is.
fn length(counts: [u32; 4]) -> Option<usize> {
    let mut columns = counts.iter().zip(ROWS).map(|(&n, row)| (n as usize).checked_mul(row));
    columns.try_fold(HEAD + CHECKSUM, |sum, column| sum.checked_add(column?))
}

/// Where what is wrong begins.
fn byte_of(flaw: &Flaw, counts: [u32; 4]) -> usize {
    let column = match flaw.part {
        Part::Position => 0,
        Part::Operation => 1,
        Part::Triangle => 2,
        Part::Apex => 3,
    };
    let before: usize = (0..column).map(|c| counts[c] as usize * ROWS[c]).sum();
    HEAD + before + flaw.index * ROWS[column]
}

/// The next rows, of which there are as many.
fn column<const N: usize, T>(bytes: &mut &[u8], rows: u32, row: impl Fn([u8; N]) -> T) -> Vec<T> {
    let (these, rest) = bytes.split_at(rows as usize * N);
    *bytes = rest;
    these.as_chunks::<N>().0.iter().map(|&bytes| row(bytes)).collect()
}

fn operation(row: [u8; 36]) -> Operation {
    let [first, second, triangles, error, cone, x, y, z, radius] = words(row);
    Operation {
        ends: [first, second],
        triangles,
        error: f32::from_bits(error),
        cone: Cone::from_bytes(cone.to_le_bytes()),
        sphere: Sphere::new(vector([x, y, z]), f32::from_bits(radius)),
    }
}

fn vector(bits: [u32; 3]) -> Vec3 {
    Vec3::from_array(bits.map(f32::from_bits))
}

/// `BYTES` / 4 words.
fn words<const BYTES: usize, const WORDS: usize>(bytes: [u8; BYTES]) -> [u32; WORDS] {
    std::array::from_fn(|i| {
        u32::from_le_bytes([bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]])
    })
}

/// FNV-1a, of whole words at a time.
fn checksum(bytes: &[u8]) -> u64 {
    let words = bytes.as_chunks::<4>().0.iter().map(|&word| u64::from(u32::from_le_bytes(word)));
    words.fold(0xcbf2_9ce4_8422_2325, |sum, word| (sum ^ word).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::bake::shapes::{icosphere, terrain};
    use crate::bake::simplify::{GarlandHeckbert, quietly};
    use crate::hierarchy::{Budget, Cut};
    use crate::view::View;
    use glam::Vec2;
    use proptest::prelude::*;

    fn made(surface: crate::bake::Surface) -> Hierarchy {
        super::super::of(&surface.into(), &GarlandHeckbert::default(), &mut quietly).expect("a good shape")
    }

    fn refusal(bytes: &[u8]) -> String {
        from_bytes(bytes, "a.lodh").expect_err("it is broken").to_string()
    }

    /// With the checksum of what it is by now.
    fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
        bytes.truncate(bytes.len() - CHECKSUM);
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        bytes
    }

    #[test]
    fn a_hierarchy_comes_back_as_it_was() {
        for surface in [terrain(12, 1), icosphere(4), Default::default()] {
            let hierarchy = made(surface);
            assert_eq!(from_bytes(&to_bytes(&hierarchy), "a").expect("just written"), hierarchy);
        }
    }

    #[test]
    fn whatever_is_cut_off_or_changed_is_refused_at_its_place() {
        let bytes = to_bytes(&made(icosphere(1)));
        for end in 0..bytes.len() {
            assert!(refusal(&bytes[..end]).starts_with(&format!("a.lodh: byte {end}: ")));
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 0x10;
            refusal(&changed);
        }
        let longer = [&bytes[..], &[0]].concat();
        assert_eq!(refusal(&longer), format!("a.lodh: byte {}: it must end here", bytes.len()));
        assert_eq!(
            refusal(b"LODHxxxxyyyyzzzzuuuuvvvv"),
            "a.lodh: byte 4: its version must be 1, not 2021161080"
        );
        let mut huge = bytes.clone();
        huge[8..24].fill(0xff);
        assert!(refusal(&huge).contains("it is cut off"));
    }

    #[test]
    fn what_is_no_hierarchy_is_refused_at_its_place() {
        let hierarchy = made(icosphere(1));
        let Parts { positions, triangles, .. } = hierarchy.parts();
        let bytes = to_bytes(&hierarchy);
        let with = |at: usize, word: u32| {
            let mut changed = bytes.clone();
            changed[at..at + 4].copy_from_slice(&word.to_le_bytes());
            refusal(&sealed(changed))
        };
        let operations = HEAD + 12 * positions.len();
        let apexes = bytes.len() - CHECKSUM - 4 * hierarchy.parts().apexes.len();
        assert!(
            with(HEAD + 12, f32::NAN.to_bits()).contains(&format!("byte {}: it must be finite", HEAD + 12))
        );
        assert!(with(operations, 9999).contains(&format!("byte {operations}: its ends must be nodes")));
        assert!(with(apexes - 12 * triangles.len(), 9999).contains("its corners must be leaves"));
        assert!(with(apexes, 9999).contains(&format!("byte {apexes}: it must be the node above")));
    }

    proptest! {
        /// What is not refused is a hierarchy, and can be cut.
        #[test]
        fn no_file_is_trusted(changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
            let mut bytes = to_bytes(&made(icosphere(2)));
            for (at, byte) in changes {
                let at = at.index(bytes.len() - HEAD - CHECKSUM);
                bytes[HEAD + at] = byte;
            }
            if let Ok(hierarchy) = from_bytes(&sealed(bytes), "a") {
                let mut cut = Cut::new(Arc::new(hierarchy));
                let view = View::perspective(1.0, Vec2::splat(500.0)).at(Vec3::Z * 2.0, glam::Quat::IDENTITY);
                for triangles in [1000, 20, 200] {
                    prop_assert!(cut.update(&[view], &Budget::triangles(triangles)).triangles <= triangles.max(cut.hierarchy().base_triangles()));
                }
            }
        }
    }
}
