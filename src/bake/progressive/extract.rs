//! From a progressive mesh to a mesh of any size.

use super::Progressive;
use super::file::bytes::{Bytes, Fault};
use super::file::record::{Codec, error_of};
use super::split::{Split, Undo};
use super::state::State;
use crate::bake::simplify::Target;
use crate::bake::{Group, Mesh, MeshError};

/// A mesh taken out of a progressive one.
#[derive(Clone, Debug, PartialEq)]
pub struct Extracted {
    /// Triangles are in the order of their groups.
    pub mesh: Mesh,
    /// No point of it is farther than this from the original, and no point of the original from it, in object units.
    pub error: f32,
    /// How many splits it took.
    pub splits: usize,
}

/// Where the next record is.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    block: usize,
    byte: usize,
}

/// A prefix of a progressive mesh that can be refined and coarsened, split by split.
///
/// Going from one prefix to another takes time in proportion to the splits between them. The arrays can be read as
/// they are at any time; [`Cursor::mesh`] makes a [`Mesh`] of them, which takes time in proportion to its size.
///
/// It borrows nothing, so that it outlives additions to a mesh that is still being loaded; it has to be given the same
/// mesh every time.
#[derive(Clone, Debug)]
pub struct Cursor {
    /// Of the mesh it belongs to.
    sum: u64,
    state: State,
    splits: usize,
    /// In steps.
    error: u32,
    at: Place,
    next: Split,
    codec: Codec,
    undo: Undo,
    /// Per split that was done, where its record is and what the error was before.
    before: Vec<(Place, u32)>,
}

impl Cursor {
    /// At the base mesh.
    pub fn new(mesh: &Progressive) -> Self {
        Self {
            sum: mesh.sum,
            state: mesh.base.clone(),
            splits: 0,
            error: mesh.head.error,
            at: Place { block: 0, byte: mesh.blocks.first().map_or(0, |block| block.records.start) },
            next: Split::default(),
            codec: Codec::default(),
            undo: Undo::default(),
            before: Vec::new(),
        }
    }

    /// How many splits have been done.
    pub fn splits(&self) -> usize {
        self.splits
    }

    /// No point of this prefix is farther than this from the original, and no point of the original from it, in object
    /// units.
    pub fn error(&self) -> f32 {
        error_of(self.error)
    }

    /// Where vertices are. What is split keeps its number; what is new comes last.
    pub fn positions(&self) -> &[glam::Vec3] {
        &self.state.positions
    }

    /// Per wedge, its position. A split appends wedges, and may take some to its new position.
    pub fn wedges(&self) -> &[u32] {
        &self.state.wedges
    }

    /// Triangles of wedges, in no order of groups. A split appends triangles, and may give corners of others new
    /// wedges.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.state.triangles
    }

    /// Does the next split; false where there is none, or none yet. O(triangles at the vertex).
    ///
    /// # Errors
    /// A record that is none, by file and byte; the cursor stays where it is.
    ///
    /// # Panics
    /// With another mesh than the cursor was made for.
    pub fn refine(&mut self, mesh: &Progressive) -> Result<bool, MeshError> {
        self.refine_while(mesh, |_, _| true, 1, true)
            .map(|done| done > 0)
            .map_err(|fault| mesh.refused(fault))
    }

    /// Takes the last split back; false at the base mesh. O(triangles at the vertex).
    pub fn coarsen(&mut self) -> bool {
        let Some((at, error)) = self.before.pop() else { return false };
        self.state.undo(&mut self.undo);
        self.splits -= 1;
        (self.at, self.error) = (at, error);
        true
    }

    /// Goes to the prefix that a target means: the one that [`Progressive::extract`] takes out. O(splits between).
    ///
    /// # Errors
    /// As [`Cursor::refine`].
    ///
    /// # Panics
    /// As [`Cursor::refine`].
    pub fn go_to(&mut self, mesh: &Progressive, target: Target) -> Result<(), MeshError> {
        let too_fine = |cursor: &Self| {
            let Some(&(_, before)) = cursor.before.last() else { return false };
            cursor.state.triangles.len() > target.triangles && error_of(before) <= target.error
        };
        while too_fine(self) {
            self.coarsen();
        }
        let wants = wants(target);
        let done = self.refine_while(mesh, wants, usize::MAX, true);
        done.map(|_| ()).map_err(|fault| mesh.refused(fault))
    }

    /// Does so many splits while the number of triangles after the next one, and the error before it, are wanted.
    fn refine_while(
        &mut self,
        mesh: &Progressive,
        wants: impl Fn(usize, f32) -> bool,
        most: usize,
        keeps: bool,
    ) -> Result<usize, Fault> {
        assert_eq!(self.sum, mesh.sum, "a cursor must be given the mesh that it was made for");
        let mut done = 0;
        while done < most {
            let Some((mut bytes, at)) = self.record(mesh) else { break };
            self.codec.read(&mut bytes, &self.state, self.error, &mut self.next)?;
            let triangles = self.state.triangles.len() + self.next.triangles.len();
            if !wants(triangles, error_of(self.error)) {
                break;
            }
            mesh.blocks[at.block].check(&bytes, self.splits + 1, triangles, self.next.error)?;
            self.state.apply(&self.next, keeps.then_some(&mut self.undo));
            if keeps {
                self.before.push((self.at, self.error));
            }
            self.at = Place { byte: bytes.at(), ..at };
            self.error = self.next.error;
            self.splits += 1;
            done += 1;
        }
        Ok(done)
    }

    /// The bytes from the next record to the end of its block.
    fn record<'a>(&self, mesh: &'a Progressive) -> Option<(Bytes<'a>, Place)> {
        let Place { block, byte } = self.at;
        let here = mesh.blocks.get(block)?;
        // A cursor that was made before there was a block begins with the first.
        let byte = byte.max(here.records.start);
        if byte < here.records.end {
            return Some((Bytes::new(&mesh.bytes, byte..here.records.end), Place { block, byte }));
        }
        let next = mesh.blocks.get(block + 1)?;
        let at = Place { block: block + 1, byte: next.records.start };
        Some((Bytes::new(&mesh.bytes, next.records.clone()), at))
    }

    /// The prefix as a mesh. O(its size).
    ///
    /// # Panics
    /// With another mesh than the cursor was made for.
    pub fn mesh(&self, mesh: &Progressive) -> Mesh {
        assert_eq!(self.sum, mesh.sum, "a cursor must be given the mesh that it was made for");
        mesh.mesh_of(self.state.clone())
    }
}

/// Whether the split to so many triangles, from a mesh of some error, is wanted.
fn wants(target: Target) -> impl Fn(usize, f32) -> bool {
    move |triangles, error| triangles <= target.triangles || error > target.error
}

/// The triangles in the order of their groups, and those groups that have some.
fn grouped(state: &State, mesh: &Progressive) -> (Vec<[u32; 3]>, Vec<Group>) {
    let mut ends = vec![0; mesh.head.groups.len() + 1];
    state.groups.iter().for_each(|&group| ends[group as usize + 1] += 1);
    for group in 1..ends.len() {
        ends[group] += ends[group - 1];
    }
    let named = mesh.head.groups.iter().zip(ends.windows(2)).filter(|(_, ends)| ends[0] < ends[1]);
    let groups = named.map(|(head, ends)| Group {
        name: head.name.clone(),
        material: head.material.clone(),
        triangles: ends[0]..ends[1],
    });
    let groups = groups.collect();
    if mesh.head.groups.len() < 2 {
        return (state.triangles.clone(), groups);
    }
    let mut triangles = vec![[0; 3]; state.triangles.len()];
    for (&triangle, &group) in state.triangles.iter().zip(&state.groups) {
        triangles[ends[group as usize]] = triangle;
        ends[group as usize] += 1;
    }
    (triangles, groups)
}

impl Progressive {
    /// The mesh of a prefix.
    fn mesh_of(&self, state: State) -> Mesh {
        let (triangles, groups) = grouped(&state, self);
        let mut mesh = Mesh { name: self.head.name.clone(), triangles, groups, ..Mesh::default() };
        self.head.columns.write(&state.rows, &mut mesh);
        (mesh.positions, mesh.wedges) = (state.positions, state.wedges);
        mesh
    }

    /// The mesh that a target means: the finest of at most so many triangles or, if that is finer, the coarsest within
    /// the error; the base mesh where that has too many triangles already. The error is a bound of the deviation, not
    /// an estimate.
    ///
    /// It takes time in proportion to its size, whatever the size of the whole.
    ///
    /// # Errors
    /// A record that is none, by file and byte.
    pub fn extract(&self, target: Target) -> Result<Extracted, MeshError> {
        let mut cursor = Cursor::new(self);
        let done = cursor.refine_while(self, wants(target), usize::MAX, false);
        let splits = done.map_err(|fault| self.refused(fault))?;
        Ok(Extracted { error: cursor.error(), mesh: self.mesh_of(cursor.state), splits })
    }

    /// The original, bit for bit: every number, name and order. `None` where the file was cut off before its last
    /// part.
    ///
    /// # Errors
    /// What is no record or no order, by file and byte.
    pub fn original(&self) -> Result<Option<Mesh>, MeshError> {
        let Some(part) = self.original.clone() else { return Ok(None) };
        let mut cursor = Cursor::new(self);
        let done = cursor.refine_while(self, |_, _| true, usize::MAX, false);
        done.map_err(|fault| self.refused(fault))?;
        let mut bytes = Bytes::new(&self.bytes, part);
        let counts = cursor.state.counts();
        let read = bytes
            .must(counts == self.head.full, "the splits must lead to what the head says")
            .and_then(|()| super::file::original::read(&mut bytes, &self.head, &cursor.state));
        read.map(Some).map_err(|fault| self.refused(fault))
    }
}
