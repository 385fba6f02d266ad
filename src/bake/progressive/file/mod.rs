//! The file: `.lodp`, little-endian.
//!
//! Eight bytes say what it is and of which version; then come parts, each of which is four letters, its length in four
//! bytes, so many bytes, and eight more that check them all:
//!
//! | part | what it holds |
//! |---|---|
//! | `HEAD` | name, attributes, groups, counts |
//! | `BASE` | the coarsest mesh |
//! | `SPLT` … | splits, coarse to fine: how many, the triangles and the error after them, their records |
//! | `ORIG` | in what order the original has all that, and what simplification could not keep of it |
//!
//! A file may end anywhere after `BASE`: what is whole counts.

pub(super) mod base;
pub(super) mod bytes;
pub(super) mod head;
pub(super) mod original;
pub(super) mod record;

use std::ops::Range;

use bytes::{Bytes, Fault};

/// What a file begins with; the last byte is the version.
pub(super) const MAGIC: [u8; 8] = *b"\x89LODP\r\n\x01";

/// Bytes of a part beside what it holds.
const BEFORE: usize = 8;
const AFTER: usize = 8;

/// What a part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Head,
    Base,
    Splits,
    Original,
}

impl Kind {
    const ALL: [(Self, [u8; 4]); 4] = [
        (Self::Head, *b"HEAD"),
        (Self::Base, *b"BASE"),
        (Self::Splits, *b"SPLT"),
        (Self::Original, *b"ORIG"),
    ];

    fn letters(self) -> [u8; 4] {
        let letters = Self::ALL.iter().find(|(kind, _)| *kind == self);
        letters.map(|&(_, letters)| letters).unwrap_or_default()
    }
}

/// Appends a part.
///
/// # Errors
/// What it holds is 4 GiB or more.
pub(super) fn put_part(kind: Kind, holds: &[u8], out: &mut Vec<u8>) -> Result<(), String> {
    let length = u32::try_from(holds.len()).map_err(|_| "a part must be smaller than 4 GiB".to_owned())?;
    let start = out.len();
    out.extend_from_slice(&kind.letters());
    out.extend_from_slice(&length.to_le_bytes());
    out.extend_from_slice(holds);
    let sum = checksum(&out[start..]);
    out.extend_from_slice(&sum.to_le_bytes());
    Ok(())
}

/// The part of a file that begins at a byte: what it is, where what it holds is, and where the next one begins; `None`
/// where the file ends before it does.
pub(super) fn part(file: &[u8], start: usize) -> Result<Option<(Kind, Range<usize>, usize)>, Fault> {
    let mut bytes = Bytes::new(file, start..file.len());
    if bytes.left() < BEFORE {
        return Ok(None);
    }
    let fault = bytes.fault("a part must be HEAD, BASE, SPLT or ORIG");
    let letters = bytes.take(4)?;
    let kind = Kind::ALL.iter().find(|(_, known)| known == letters).map(|&(kind, _)| kind).ok_or(fault)?;
    let length = bytes.short()? as usize;
    let Some(end) = bytes.at().checked_add(length).filter(|end| file.len() - AFTER.min(file.len()) >= *end)
    else {
        return Ok(None);
    };
    let holds = bytes.at()..end;
    let sum = Bytes::new(file, end..file.len()).long()?;
    if checksum(&file[start..end]) != sum {
        return Err(Fault { byte: start, rule: "a part must be as its checksum says" });
    }
    Ok(Some((kind, holds, end + AFTER)))
}

/// FNV-1a (G. Fowler, L. Noll, K. Vo) over words of eight bytes, in four lanes that do not wait for each other. A step
/// loses nothing, so that one wrong word never goes unseen.
pub(super) fn checksum(bytes: &[u8]) -> u64 {
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    let step = |hash: u64, word: u64| {
        let mixed = (hash ^ word).wrapping_mul(PRIME);
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
