//! Reading a progressive mesh while it arrives.

use std::io::{self, Read};
use std::ops::Range;

use super::file::bytes::{Bytes, Fault};
use super::file::head::Head;
use super::file::record::error_of;
use super::file::{Kind, MAGIC, base, part};
use super::{Block, Extent, Progressive, refused};
use crate::bake::MeshError;

/// A progressive mesh on its way in. What has arrived can be drawn: see [`Stream::mesh`].
///
/// ```
/// use lod_budget::bake::progressive::{Cursor, Options, Progressive, Stream};
/// use lod_budget::bake::shapes;
/// use lod_budget::bake::simplify::quietly;
///
/// let knot = shapes::torus_knot(60, 8).into();
/// let file = Progressive::build(&knot, &Options::default(), &mut quietly)?;
/// let (mut stream, mut reader, mut drawn) = (Stream::new("knot.lodp"), file.bytes(), None);
/// while stream.read(&mut reader, 4096)? > 0 {
///     stream.advance()?;
///     if let Some(mesh) = stream.mesh() {
///         let cursor = drawn.get_or_insert_with(|| Cursor::new(mesh));
///         while cursor.refine(mesh)? {}
///     }
/// }
/// assert_eq!(drawn.map(|cursor| cursor.triangles().len()), Some(knot.triangles.len()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stream {
    file: String,
    /// What has arrived, until there is a mesh that takes it over.
    bytes: Vec<u8>,
    head: Option<Head>,
    mesh: Option<Progressive>,
    /// Up to where parts are known.
    at: usize,
}

impl Stream {
    /// Of a file that errors name so.
    pub fn new(file: impl Into<String>) -> Self {
        Self { file: file.into(), bytes: Vec::new(), head: None, mesh: None, at: 0 }
    }

    /// Takes bytes from a reader, up to so many, as far as it has some; returns how many, 0 at its end. They count once
    /// [`Stream::advance`] has looked at them.
    ///
    /// # Errors
    /// What the reader says.
    pub fn read(&mut self, reader: &mut impl Read, most: usize) -> io::Result<usize> {
        let bytes = self.arrived_mut();
        let before = bytes.len();
        let mut chunk = [0; 1 << 14];
        while bytes.len() - before < most {
            let room = chunk.len().min(most - (bytes.len() - before));
            match reader.read(&mut chunk[..room]) {
                Ok(0) => break,
                Ok(count) => bytes.extend_from_slice(&chunk[..count]),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock && bytes.len() > before => break,
                Err(error) => return Err(error),
            }
        }
        Ok(bytes.len() - before)
    }

    /// Takes over bytes that are there already. They count once [`Stream::advance`] has looked at them.
    pub fn give(&mut self, bytes: Vec<u8>) {
        let arrived = self.arrived_mut();
        if arrived.is_empty() {
            *arrived = bytes;
        } else {
            arrived.extend_from_slice(&bytes);
        }
    }

    fn arrived_mut(&mut self) -> &mut Vec<u8> {
        self.mesh.as_mut().map_or(&mut self.bytes, |mesh| &mut mesh.bytes)
    }

    fn arrived(&self) -> &[u8] {
        self.mesh.as_ref().map_or(&self.bytes, |mesh| &mesh.bytes)
    }

    /// Looks at what has arrived, as far as parts of it are whole. O(what is new).
    ///
    /// # Errors
    /// What is no part, or breaks its checksum, by file and byte.
    pub fn advance(&mut self) -> Result<(), MeshError> {
        self.try_advance().map_err(|fault| refused(&self.file, fault))
    }

    fn try_advance(&mut self) -> Result<(), Fault> {
        if self.at == 0 && !self.begin()? {
            return Ok(());
        }
        while let Some((kind, holds, end)) = part(self.arrived(), self.at)? {
            self.take_part(kind, holds, end)?;
            self.at = end;
        }
        Ok(())
    }

    /// Whether it is a file that can be read; false where that cannot be told yet.
    fn begin(&mut self) -> Result<bool, Fault> {
        let known = self.bytes.len().min(MAGIC.len());
        if self.bytes[..known.min(7)] != MAGIC[..known.min(7)] {
            return Err(Fault { byte: 0, rule: "it must begin as a progressive mesh does" });
        }
        if known == MAGIC.len() && self.bytes[7] != MAGIC[7] {
            return Err(Fault { byte: 7, rule: "its version must be 1" });
        }
        self.at = if known == MAGIC.len() { known } else { 0 };
        Ok(self.at > 0)
    }

    fn take_part(&mut self, kind: Kind, holds: Range<usize>, end: usize) -> Result<(), Fault> {
        let fault = Fault { byte: self.at, rule: "parts must be HEAD, BASE, any number of SPLT, ORIG" };
        match (kind, self.head.take(), &mut self.mesh) {
            (Kind::Head, None, None) => {
                let mut bytes = Bytes::new(&self.bytes, holds);
                self.head = Some(Head::read(&mut bytes)?);
                bytes.must(bytes.left() == 0, "the head must end here")
            }
            (Kind::Base, Some(head), None) => {
                let base = base::read(&mut Bytes::new(&self.bytes, holds), &head)?;
                let bytes = std::mem::take(&mut self.bytes);
                self.mesh = Some(Progressive::of_base(head, base, bytes, end, self.file.clone()));
                Ok(())
            }
            (Kind::Splits, None, Some(mesh)) if mesh.original.is_none() => {
                let block = Block::read(&mesh.bytes, holds, mesh)?;
                mesh.blocks.push(block);
                Ok(())
            }
            (Kind::Original, None, Some(mesh)) if mesh.original.is_none() => {
                let all = mesh.splits() == mesh.head.splits;
                mesh.original = Some(holds);
                if all {
                    Ok(())
                } else {
                    Err(Fault { rule: "all splits must come before the original", ..fault })
                }
            }
            _ => Err(fault),
        }
    }

    /// The mesh as far as it has arrived; `None` before its base mesh has.
    pub fn mesh(&self) -> Option<&Progressive> {
        self.mesh.as_ref()
    }

    /// The mesh, and how much of it there is, when nothing more will come.
    ///
    /// # Errors
    /// A file that ends before its base mesh does, or goes on after its end.
    pub fn finish(mut self) -> Result<(Progressive, Extent), MeshError> {
        self.advance()?;
        let length = self.arrived().len();
        let is_over = self.mesh.as_ref().is_some_and(|mesh| mesh.original.is_some());
        if is_over && self.at < length {
            let fault = Fault { byte: self.at, rule: "nothing must follow the original" };
            return Err(refused(&self.file, fault));
        }
        let short = Fault { byte: length, rule: "it must not end before its base mesh does" };
        let mut mesh = self.mesh.ok_or(refused(&self.file, short))?;
        mesh.bytes.truncate(self.at);
        let splits_read = mesh.splits();
        Ok((mesh, if is_over { Extent::Whole } else { Extent::Truncated { splits_read } }))
    }
}

impl Block {
    fn read(file: &[u8], holds: Range<usize>, mesh: &Progressive) -> Result<Self, Fault> {
        let mut bytes = Bytes::new(file, holds.clone());
        let last = mesh.blocks.last();
        let (first, before) =
            last.map_or((0, mesh.head.error), |block| (block.first + block.splits, block.error));
        let splits = bytes.number()? as usize;
        let triangles = bytes.number()? as usize;
        let error = bytes.number()?;
        let is_possible = splits > 0 && splits <= bytes.left() && splits <= mesh.head.splits - first;
        bytes.must(is_possible, "splits must be as many as there are bytes for, and as the head says")?;
        bytes.must(error <= before && !error_of(error).is_nan(), "an error must not rise")?;
        Ok(Self { records: bytes.at()..holds.end, first, splits, triangles, error })
    }

    /// Checks, after a split, that the block ends where it says and leaves what it says.
    pub(super) fn check(
        &self,
        bytes: &Bytes,
        splits: usize,
        triangles: usize,
        error: u32,
    ) -> Result<(), Fault> {
        let is_last = splits == self.first + self.splits;
        let leaves = !is_last || triangles == self.triangles && error == self.error;
        let rule = "a block must have the splits, and leave the triangles and the error, that it says";
        bytes.must((bytes.left() == 0) == is_last && leaves, rule)
    }
}
