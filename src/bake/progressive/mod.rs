//! Progressive meshes: a coarse mesh, and the splits that lead from it to the original.
//!
//! H. Hoppe, "Progressive meshes", SIGGRAPH 1996, and "Efficient implementation of progressive meshes", 1998. The
//! contractions of [`GarlandHeckbert`], last first and each turned into its inverse, a *vertex split*. Any number of
//! splits makes a mesh: at n triangles the one that simplifying to n leaves, with all its attributes, and after the last
//! part of the file the original itself, bit for bit. What is of it:
//!
//! - [`Progressive::extract`] takes out a mesh of so many triangles, or within an error, in time that follows its size
//!   and not that of the whole;
//! - a [`Cursor`] goes back and forth, split by split;
//! - [`Stream`] reads a file as it arrives, and shows what there is;
//! - [`Progressive::table`] makes a LOD table of as many levels as wanted.
//!
//! Where we depart from the papers: a split may have any number of triangles and wedges, so that holes that close and
//! parts that go are splits, too; places and attributes are kept to the last bit; and every split has an *error*, which
//! is a bound that is proved (`marks.rs` says how), not the error of the method.
//!
//! Take chains of levels ([`chain`](super::chain)) where a few levels are enough: a graphics card draws them faster than
//! anything that changes from frame to frame, and they can be loaded without decoding.
//!
//! ```
//! use lod_budget::bake::progressive::{Options, Progressive};
//! use lod_budget::bake::shapes;
//! use lod_budget::bake::simplify::{Target, quietly};
//!
//! let knot = shapes::torus_knot(100, 10).into();
//! let mesh = Progressive::build(&knot, &Options::default(), &mut quietly)?;
//! let coarse = mesh.extract(Target::triangles(500))?;
//! assert_eq!(coarse.mesh.triangles.len(), 500);
//! let close = mesh.extract(Target::error(coarse.error))?;
//! assert!(close.splits <= coarse.splits && close.error <= coarse.error);
//! assert_eq!(mesh.original()?, Some(knot));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bound;
mod build;
mod extract;
mod file;
mod marks;
mod row;
mod split;
mod state;
mod stream;
mod table;
mod trail;
mod write;

pub use build::Options;
pub use extract::{Cursor, Extracted};
pub use file::head::Counts;
pub use stream::Stream;

use std::ops::Range;
use std::path::Path;

use file::bytes::Fault;
use file::head::Head;
use file::record::error_of;
use state::State;

use super::MeshError;
#[cfg(doc)]
use super::simplify::GarlandHeckbert;

/// A progressive mesh: the bytes of its file and where in them things are.
///
/// Splits stay as they are in the file and are decoded as they are done. Memory: the file, and the base mesh.
#[derive(Clone, Debug)]
pub struct Progressive {
    /// What errors call it.
    file: String,
    /// The file, as far as it is there.
    bytes: Vec<u8>,
    head: Head,
    base: State,
    blocks: Vec<Block>,
    /// Where the way to the original is, if it is there.
    original: Option<Range<usize>>,
    /// Tells it apart from other meshes.
    sum: u64,
}

/// A run of splits.
#[derive(Clone, Debug)]
struct Block {
    /// Where in the file.
    records: Range<usize>,
    /// The number of its first split.
    first: usize,
    splits: usize,
    /// Triangles after it.
    triangles: usize,
    /// After it, in steps.
    error: u32,
}

/// How much of a file there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// All of it.
    Whole,
    /// It ends too early. What is whole can be used: the base mesh and so many splits.
    Truncated {
        /// How many splits there are.
        splits_read: usize,
    },
}

/// How many bytes of a file are what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Beginning, head and base mesh.
    pub base: usize,
    /// Splits.
    pub splits: usize,
    /// The way to the original.
    pub original: usize,
}

/// What is known of a prefix without extracting it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Splits.
    pub splits: usize,
    /// Triangles.
    pub triangles: usize,
    /// Bound of the deviation, in object units.
    pub error: f32,
}

impl Progressive {
    /// The mesh in the bytes of a file, which errors call `file`; bytes that end too early are no error where the base
    /// mesh is whole. Splits are looked at when they are done, not before: [`Progressive::verify`] does all.
    ///
    /// # Errors
    /// What is no such file, or breaks a checksum, by file and byte.
    pub fn from_bytes(bytes: Vec<u8>, file: &str) -> Result<(Self, Extent), MeshError> {
        let mut stream = Stream::new(file);
        stream.give(bytes);
        stream.finish()
    }

    /// The mesh in a file.
    ///
    /// # Errors
    /// A file that cannot be read, and what [`Progressive::from_bytes`] refuses.
    pub fn load(path: &Path) -> Result<(Self, Extent), MeshError> {
        let file = path.display().to_string();
        let unread =
            |e| MeshError { file: file.clone(), place: None, rule: format!("it cannot be read: {e}") };
        let bytes = std::fs::read(path).map_err(unread)?;
        Self::from_bytes(bytes, &file)
    }

    /// A mesh that has no splits yet. The bytes before `end` are its head and base.
    fn of_base(head: Head, base: State, bytes: Vec<u8>, end: usize, file: String) -> Self {
        let sum = file::checksum(&bytes[..end]);
        Self { file, bytes, head, base, blocks: Vec::new(), original: None, sum }
    }

    /// The file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// What the mesh is called.
    pub fn name(&self) -> &str {
        &self.head.name
    }

    /// How many splits are there.
    pub fn splits(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.first + block.splits)
    }

    /// What the base mesh has.
    pub fn base(&self) -> Counts {
        self.head.base
    }

    /// What the mesh has after all splits, those that are not there included.
    pub fn full(&self) -> Counts {
        self.head.full
    }

    /// What the original has; more than [`Progressive::full`] where it has what no simplification keeps: triangles
    /// that use a position twice, positions that nothing uses, wedges that look the same.
    pub fn of_original(&self) -> Counts {
        self.head.original
    }

    /// Where the bytes of the file go.
    pub fn sizes(&self) -> Sizes {
        let original = self.original.as_ref().map_or(0, Range::len);
        let splits = self.blocks.iter().map(|block| block.records.len()).sum();
        Sizes { base: self.bytes.len() - original - splits, splits, original }
    }

    /// The base mesh, and the mesh after every block of splits.
    pub fn marks(&self) -> impl Iterator<Item = Mark> {
        let base = Mark { splits: 0, triangles: self.head.base.triangles, error: error_of(self.head.error) };
        let mark = |block: &Block| Mark {
            splits: block.first + block.splits,
            triangles: block.triangles,
            error: error_of(block.error),
        };
        std::iter::once(base).chain(self.blocks.iter().map(mark))
    }

    /// Does all splits and goes on to the original, to see whether that can be done. O(the whole).
    ///
    /// # Errors
    /// The first record that is none, by file and byte.
    pub fn verify(&self) -> Result<(), MeshError> {
        match self.original {
            Some(_) => self.original().map(|_| ()),
            None => self.extract(super::simplify::Target::error(-1.0)).map(|_| ()),
        }
    }

    fn refused(&self, fault: Fault) -> MeshError {
        refused(&self.file, fault)
    }
}

/// A fault of a file.
fn refused(file: &str, fault: Fault) -> MeshError {
    let place = Some(format!("byte {}", fault.byte));
    MeshError { file: file.to_owned(), place, rule: fault.rule.to_owned() }
}
