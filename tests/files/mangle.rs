//! Ways to spoil a file, and what must hold of whoever reads it.

use lod_budget::files::FileError;
use proptest::prelude::*;

/// A reader over bytes.
pub type Reader<T> = fn(&[u8], &str) -> Result<T, FileError>;

/// Cuts the file after every byte; what is left of it must be refused, by name.
pub fn is_refused_when_cut<T>(bytes: &[u8], read: Reader<T>) {
    for end in 0..bytes.len() {
        let error = read(&bytes[..end], "cut.file").err();
        let error = error.unwrap_or_else(|| panic!("accepted after {end} of {} bytes", bytes.len()));
        assert_eq!(error.file, "cut.file");
        assert!(!error.rule.is_empty());
    }
}

/// Bytes to put somewhere: those that formats care about come often.
pub fn spoiling_bytes() -> impl Strategy<Value = Vec<u8>> {
    let telling: [&[u8]; 16] = [
        b"",
        b"-",
        b"NaN",
        b"1e999",
        b"-1",
        b"4294967296",
        b"18446744073709551616",
        b"null",
        b"[",
        b"]",
        b"{",
        b"}",
        b",",
        b"\"",
        b"\n",
        b"\xff",
    ];
    let telling: Vec<Vec<u8>> = telling.iter().map(|t| t.to_vec()).collect();
    prop_oneof![prop::sample::select(telling), prop::collection::vec(any::<u8>(), 0..8)]
}

/// Where (as a fraction of the file), how many bytes to take out, and what to put there.
pub fn edits() -> impl Strategy<Value = Vec<(f64, usize, Vec<u8>)>> {
    prop::collection::vec((0.0..1.0, 0usize..12, spoiling_bytes()), 1..4)
}

/// The file after `edits`.
pub fn spoiled(bytes: &[u8], edits: &[(f64, usize, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (at, take, put) in edits {
        let at = (at * bytes.len() as f64) as usize;
        let end = (at + take).min(bytes.len());
        bytes.splice(at..end, put.iter().copied());
    }
    bytes
}

/// UTF-16 with its mark, in the order that Windows writes.
pub fn utf16(text: &str) -> Vec<u8> {
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    units.flat_map(u16::to_le_bytes).collect()
}

/// The text after a UTF-8 byte order mark, its lines ended as Windows does.
pub fn marked_crlf(text: &str) -> Vec<u8> {
    format!("\u{feff}{}", text.replace('\n', "\r\n")).into_bytes()
}
