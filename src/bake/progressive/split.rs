//! What splitting a vertex does, and what it takes to undo it.

use glam::Vec3;

use super::state::{MOST_TRIANGLES, NONE, State};

/// A split of a vertex, in the numbers of the mesh that it is done to. What is new has the numbers that follow.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Split {
    /// The vertex; [`NONE`] where a part comes back that was gone altogether.
    pub(super) parent: u32,
    /// Where it goes.
    pub(super) place: Vec3,
    /// The new positions. Corners leave the parent for the first alone.
    pub(super) positions: Vec<Vec3>,
    pub(super) changed: Vec<Change>,
    /// Per new wedge, its position.
    pub(super) wedges: Vec<u32>,
    /// The rows of the changed wedges, then of the new ones.
    pub(super) rows: Vec<u32>,
    /// Corners of the parent that get another wedge, and which.
    pub(super) corners: Vec<(u32, u32)>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Per new triangle.
    pub(super) groups: Vec<u32>,
    /// The error of the mesh after it, in steps.
    pub(super) error: u32,
}

/// A wedge that gets another row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Change {
    pub(super) wedge: u32,
    /// Whether it goes from the parent to the first new position.
    pub(super) moves: bool,
}

impl Split {
    pub(super) fn clear(&mut self) {
        self.positions.clear();
        self.changed.clear();
        self.wedges.clear();
        self.rows.clear();
        self.corners.clear();
        self.triangles.clear();
        self.groups.clear();
    }

    /// The rule that this split of a mesh breaks, if any. What is new and where corners are is enough: the wedges of
    /// what stays are known to fit.
    pub(super) fn broken_rule(&self, state: &State) -> Option<&'static str> {
        let wedges = state.wedges.len() + self.wedges.len();
        let first = state.positions.len() as u32;
        let is_there = |&wedge: &u32| (wedge as usize) < wedges;
        let is_own =
            |position: u32| position == self.parent || !self.positions.is_empty() && position == first;
        let moved = self.moved();
        let position = |wedge: u32| self.position(state, &moved, wedge);
        let changes = |c: &Change| {
            let before = state.wedges.get(c.wedge as usize);
            before.is_some_and(|&at| !c.moves || at == self.parent && !self.positions.is_empty())
        };
        if !self.changed.iter().all(changes) {
            Some("a wedge that changes must be there, and at the vertex if it leaves it")
        } else if !self.has_places(state, self.positions.len()) {
            Some("a new wedge must be at a position that is there")
        } else if !self.corners.iter().all(|(_, w)| is_there(w) && is_own(position(*w))) {
            Some("a corner of the vertex must stay at it or go to the new one")
        } else if !self.triangles.as_flattened().iter().all(is_there) {
            Some("a corner must be one of the wedges that are there")
        } else if !self.triangles.iter().all(|t| is_proper(t.map(position))) {
            Some("a triangle must have three positions")
        } else if state.triangles.len() + self.triangles.len() > MOST_TRIANGLES || wedges >= NONE as usize {
            Some("there must not be more than 268435456 triangles")
        } else {
            None
        }
    }

    /// Whether all new wedges are at positions of a mesh or at one of so many new ones.
    pub(super) fn has_places(&self, state: &State, added: usize) -> bool {
        let positions = state.positions.len() + added;
        self.wedges.iter().all(|&position| (position as usize) < positions)
    }

    /// The wedges that go from the parent to the first new position, ascending: a record may have a great many.
    fn moved(&self) -> Vec<u32> {
        let mut moved: Vec<u32> = self.changed.iter().filter(|c| c.moves).map(|c| c.wedge).collect();
        moved.sort_unstable();
        moved
    }

    /// Where a wedge is after the split.
    fn position(&self, state: &State, moved: &[u32], wedge: u32) -> u32 {
        match self.wedges.get((wedge as usize).wrapping_sub(state.wedges.len())) {
            Some(&position) => position,
            None if moved.binary_search(&wedge).is_ok() => state.positions.len() as u32,
            None => state.wedges[wedge as usize],
        }
    }

    /// Whether the vertex and all that is new are somewhere.
    pub(super) fn is_finite(&self) -> bool {
        self.place.is_finite() && self.positions.iter().all(|place| place.is_finite())
    }

    /// Per row, the wedge of the mesh before that likely resembles it: a changed wedge itself; for a new one that of a
    /// corner that becomes its, or else one at its position, or else one of the parent.
    pub(super) fn models(&self, state: &State) -> Vec<Option<u32>> {
        let first_new = state.wedges.len() as u32;
        let mut corner_of = vec![None; self.wedges.len()];
        for &(corner, wedge) in self.corners.iter().rev() {
            if let Some(own) = corner_of.get_mut(wedge.wrapping_sub(first_new) as usize) {
                *own = Some(corner);
            }
        }
        let of = |position: u32| {
            let is_there = (position as usize) < state.positions.len();
            is_there.then(|| state.fan(position).next()).flatten()
        };
        let model = |(&position, corner): (&u32, Option<u32>)| {
            let corner = corner.or_else(|| of(position)).or_else(|| of(self.parent));
            corner.map(|corner| state.wedge(corner))
        };
        let changed = self.changed.iter().map(|change| Some(change.wedge));
        changed.chain(self.wedges.iter().zip(corner_of).map(model)).collect()
    }
}

pub(super) fn is_proper([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// What splits have overwritten, the last on top.
#[derive(Clone, Debug, Default)]
pub(super) struct Undo {
    pub(super) steps: Vec<Step>,
    /// Corners, and the wedges they had.
    pub(super) corners: Vec<(u32, u32)>,
    /// Wedges, and the positions they had.
    pub(super) changed: Vec<(u32, u32)>,
    /// The rows they had.
    pub(super) rows: Vec<u32>,
}

/// What one split has overwritten and added: the parent and where it was, and how many of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) parent: u32,
    pub(super) place: Vec3,
    pub(super) positions: u32,
    pub(super) wedges: u32,
    pub(super) triangles: u32,
    pub(super) corners: u32,
    pub(super) changed: u32,
}

impl Undo {
    /// Keeps what a split is about to overwrite.
    pub(super) fn keep(&mut self, state: &State, split: &Split) {
        self.steps.push(Step {
            parent: split.parent,
            place: state.positions.get(split.parent as usize).copied().unwrap_or_default(),
            positions: split.positions.len() as u32,
            wedges: split.wedges.len() as u32,
            triangles: split.triangles.len() as u32,
            corners: split.corners.len() as u32,
            changed: split.changed.len() as u32,
        });
        self.corners.extend(split.corners.iter().map(|&(corner, _)| (corner, state.wedge(corner))));
        for change in &split.changed {
            self.changed.push((change.wedge, state.wedges[change.wedge as usize]));
            self.rows.extend_from_slice(state.row(change.wedge));
        }
    }
}
