//! Bytes from disk and back: whole files only, read at once and replaced at once.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::FileError;

/// The whole file.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    fs::read(path)
        .map_err(|e| FileError::whole(path.display().to_string(), format!("it cannot be read: {e}")))
}

/// `bytes` as text. A UTF-8 byte order mark is passed over; every other encoding is refused.
pub(super) fn text_of<'a>(bytes: &'a [u8], file: &str) -> Result<&'a str, FileError> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(FileError::whole(file, "it must be UTF-8, and starts with the mark of UTF-16"));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|e| {
        let place = format!("byte {}", e.valid_up_to());
        FileError::at(file, place, "it must be UTF-8")
    })
}

/// The extension in lower case; empty where there is none.
pub(super) fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// The name without folder and extension.
pub(super) fn stem(file: &str) -> String {
    let stem = Path::new(file).file_stem().and_then(|s| s.to_str());
    stem.unwrap_or(file).to_owned()
}

/// Replaces the file at `path` as a whole: whoever looks sees the old bytes or the new ones, never a part of them.
/// The bytes go to a temporary sibling first, which is renamed; it is removed when that fails.
///
/// # Errors
/// What the file system refuses; the old file is then as it was.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let refused =
        |e: io::Error| FileError::whole(path.display().to_string(), format!("it cannot be written: {e}"));
    let (sibling, file) = temporary_sibling(path).map_err(refused)?;
    let written = fill(file, bytes).and_then(|()| fs::rename(&sibling, path));
    written.map_err(|e| {
        // The rename failed, so the sibling is all there is to clean; nothing is to be done if that fails as well.
        let _ = fs::remove_file(&sibling);
        refused(e)
    })
}

/// A new empty file in the folder of `path`: its name, the process and a number make it ours.
fn temporary_sibling(path: &Path) -> io::Result<(PathBuf, File)> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?.to_string_lossy();
    for attempt in 0..1000 {
        let sibling = path.with_file_name(format!(".{name}.{}.{attempt}.tmp", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&sibling) {
            Ok(file) => return Ok((sibling, file)),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(e),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

fn fill(mut file: File, bytes: &[u8]) -> io::Result<()> {
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_folder_as_it_was() {
        let folder = tempfile::tempdir().expect("a folder");
        let taken = folder.path().join("scene.json");
        fs::create_dir(&taken).expect("a folder in the way");
        fs::write(taken.join("inside"), "x").expect("a file in it");
        let error = write_atomically(&taken, b"{}").expect_err("cannot replace a folder");
        assert!(error.rule.starts_with("it cannot be written"));
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
    }

    #[test]
    fn writing_replaces_the_whole_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.json");
        write_atomically(&path, b"a long first text").expect("written");
        write_atomically(&path, b"short").expect("replaced");
        assert_eq!(fs::read(&path).expect("there"), b"short");
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
    }

    #[test]
    fn only_utf8_is_text() {
        assert_eq!(text_of(b"\xef\xbb\xbf{}", "a").expect("marked UTF-8"), "{}");
        assert!(text_of(b"\xff\xfe{\0}\0", "a").is_err());
        assert_eq!(text_of(b"ab\xc3", "a").expect_err("cut").to_string(), "a: byte 2: it must be UTF-8");
    }
}
