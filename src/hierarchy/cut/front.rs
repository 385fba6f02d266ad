//! The triangles of a cut, and how they change when a vertex is split or two are contracted.

use crate::hierarchy::{Hierarchy, NONE};

/// The triangles of a cut in *slots* without holes, and the active nodes, which are their corners.
///
/// Corner `i` of slot `s` is number `3 s + i`. The corners at a node are a linked list.
#[derive(Clone, Debug)]
pub(super) struct Front {
    /// Per slot, the nodes at its corners.
    slots: Vec<[u32; 3]>,
    /// Per slot, the triangle of the mesh that it is.
    triangles: Vec<u32>,
    /// Per corner, the next one at its node.
    next: Vec<u32>,
    /// Per node, the first corner at it.
    heads: Vec<u32>,
    /// Per node.
    stages: Vec<Stage>,
    /// The slots that have changed since they were last told, each once, and per slot whether it is among them.
    changed: Vec<u32>,
    is_changed: Vec<bool>,
    /// Slots on their way out.
    going: Vec<u32>,
}

/// What has become of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// It is split: nodes below it are active.
    Split,
    /// It is in the cut.
    Active,
    /// It is contracted: a node above it is active.
    Contracted,
}

impl Front {
    /// The coarsest: every operation is done. All slots are new.
    pub(super) fn coarsest(hierarchy: &Hierarchy) -> Self {
        let mut front = Self {
            slots: Vec::new(),
            triangles: Vec::new(),
            next: Vec::new(),
            heads: vec![NONE; hierarchy.positions().len()],
            stages: vec![Stage::Contracted; hierarchy.positions().len()],
            changed: Vec::new(),
            is_changed: Vec::new(),
            going: Vec::new(),
        };
        let roots = hierarchy.roots();
        roots.iter().for_each(|&root| front.stages[root as usize] = Stage::Active);
        for triangle in hierarchy.triangles() - hierarchy.base_triangles()..hierarchy.triangles() {
            let leaves = hierarchy.parts().triangles[triangle];
            front.push(triangle as u32, leaves.map(|leaf| roots[leaf as usize]));
        }
        front
    }

    pub(super) fn slots(&self) -> &[[u32; 3]] {
        &self.slots
    }

    pub(super) fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    pub(super) fn changed(&self) -> &[u32] {
        &self.changed
    }

    pub(super) fn is_active(&self, node: u32) -> bool {
        self.stages[node as usize] == Stage::Active
    }

    /// Nothing has changed yet.
    pub(super) fn forget_changes(&mut self) {
        for slot in self.changed.drain(..) {
            self.is_changed[slot as usize] = false;
        }
    }

    /// Puts the changed slots in order; those beyond the last slot are none any more.
    pub(super) fn sort_changes(&mut self) {
        let slots = self.slots.len() as u32;
        for &slot in self.changed.iter().filter(|&&slot| slot >= slots) {
            self.is_changed[slot as usize] = false;
        }
        self.changed.retain(|&slot| slot < slots);
        self.changed.sort_unstable();
    }

    /// The corners of the triangles at a node, itself among them.
    pub(super) fn around(&self, node: u32) -> impl Iterator<Item = u32> {
        self.fan(node).flat_map(|corner| self.slots[corner as usize / 3])
    }

    /// An active node that has to be split before that of an operation: the youngest neighbour if it is younger, or what
    /// is above a node that was a neighbour until triangles went.
    pub(super) fn blocker(&self, hierarchy: &Hierarchy, operation: u32) -> Option<u32> {
        let node = hierarchy.node(operation);
        let youngest = self.around(node).max().filter(|&youngest| youngest > node);
        youngest.or_else(|| self.lost_neighbour(hierarchy, operation).map(|n| self.above(hierarchy, n)))
    }

    /// A node that is to be split before that of an operation: one whose operation took a triangle of it, or one that has
    /// taken up a corner of a triangle that comes back.
    fn lost_neighbour(&self, hierarchy: &Hierarchy, operation: u32) -> Option<u32> {
        let mut takers = hierarchy.takers(hierarchy.node(operation)).iter().map(|&t| hierarchy.node(t));
        let mut apexes = hierarchy.apexes(operation).iter().copied();
        let stage = |node: u32| self.stages[node as usize];
        let taker = takers.find(|&taker| stage(taker) != Stage::Split);
        taker.or_else(|| apexes.find(|&apex| stage(apex) == Stage::Contracted))
    }

    /// The active node that is or is above one that is not split.
    fn above(&self, hierarchy: &Hierarchy, mut node: u32) -> u32 {
        while let Some(parent) = hierarchy.parent(node).filter(|_| !self.is_active(node)) {
            node = hierarchy.node(parent);
        }
        node
    }

    /// Whether the ends of an operation can be contracted now: they are active, and around them nothing has to be
    /// contracted before them.
    pub(super) fn may_merge(&self, hierarchy: &Hierarchy, operation: u32) -> bool {
        let ends = hierarchy.operation(operation).ends;
        let is_due = |&node: &u32| hierarchy.parent(node).is_none_or(|parent| parent >= operation);
        let may_follow = |corner: u32| self.slots[corner as usize / 3].iter().all(is_due);
        ends.iter().all(|&end| self.is_active(end)) && ends.iter().all(|&end| self.fan(end).all(may_follow))
    }

    /// Undoes an operation whose node is active and has no blocker.
    pub(super) fn split(&mut self, hierarchy: &Hierarchy, operation: u32) {
        let node = hierarchy.node(operation);
        let mut corner = std::mem::replace(&mut self.heads[node as usize], NONE);
        while corner != NONE {
            let next = self.next[corner as usize];
            let leaves = hierarchy.parts().triangles[self.triangles[corner as usize / 3] as usize];
            self.hang(corner, hierarchy.end_of(operation, leaves[corner as usize % 3]));
            corner = next;
        }
        for triangle in hierarchy.going(operation) {
            let [a, b, _] = hierarchy.parts().triangles[triangle as usize];
            let [a, b] = [a, b].map(|leaf| hierarchy.end_of(operation, leaf));
            self.push(triangle, [a, b, hierarchy.parts().apexes[triangle as usize]]);
        }
        self.activate(hierarchy, operation, true);
    }

    /// Does an operation that [`Front::may_merge`].
    pub(super) fn merge(&mut self, hierarchy: &Hierarchy, operation: u32) {
        let (node, ends) = (hierarchy.node(operation), hierarchy.operation(operation).ends);
        let mut going = std::mem::take(&mut self.going);
        for (end, other) in [(ends[0], ends[1]), (ends[1], ends[0])] {
            let mut corner = std::mem::replace(&mut self.heads[end as usize], NONE);
            while corner != NONE {
                let next = self.next[corner as usize];
                let slot = corner / 3;
                match self.slots[slot as usize].contains(&other) {
                    true => going.push(slot),
                    false => self.hang(corner, node),
                }
                corner = next;
            }
        }
        // Those of the first end are those of the second.
        going.sort_unstable();
        going.dedup();
        for slot in going.drain(..).rev() {
            self.remove(slot, ends);
        }
        self.going = going;
        self.activate(hierarchy, operation, false);
    }

    fn activate(&mut self, hierarchy: &Hierarchy, operation: u32, is_split: bool) {
        let [node, end] =
            if is_split { [Stage::Split, Stage::Active] } else { [Stage::Active, Stage::Contracted] };
        self.stages[hierarchy.node(operation) as usize] = node;
        hierarchy.operation(operation).ends.iter().for_each(|&below| self.stages[below as usize] = end);
    }

    /// The corners at a node.
    fn fan(&self, node: u32) -> impl Iterator<Item = u32> {
        let some = |corner: u32| (corner != NONE).then_some(corner);
        std::iter::successors(some(self.heads[node as usize]), move |&c| some(self.next[c as usize]))
    }

    /// Makes a corner, which is in no list, one of `node`.
    fn hang(&mut self, corner: u32, node: u32) {
        self.slots[corner as usize / 3][corner as usize % 3] = node;
        self.next[corner as usize] = std::mem::replace(&mut self.heads[node as usize], corner);
        self.touch(corner / 3);
    }

    /// What leads to a corner in the list of its node becomes `to`.
    fn lead(&mut self, corner: u32, to: u32) {
        let node = self.slots[corner as usize / 3][corner as usize % 3];
        let mut link = &mut self.heads[node as usize];
        while *link != corner {
            let at = *link as usize;
            link = &mut self.next[at];
        }
        *link = to;
    }

    fn touch(&mut self, slot: u32) {
        if !std::mem::replace(&mut self.is_changed[slot as usize], true) {
            self.changed.push(slot);
        }
    }

    fn push(&mut self, triangle: u32, nodes: [u32; 3]) {
        let slot = self.slots.len() as u32;
        self.slots.push(nodes);
        self.triangles.push(triangle);
        self.next.extend([NONE; 3]);
        if self.is_changed.len() < self.slots.len() {
            self.is_changed.push(false);
        }
        (0..).zip(nodes).for_each(|(i, node)| self.hang(3 * slot + i, node));
    }

    /// Takes a slot out, whose corners at `ends` are in no list any more, and puts the last slot in its place.
    fn remove(&mut self, slot: u32, ends: [u32; 2]) {
        for corner in (0..3).map(|i| 3 * slot + i) {
            if !ends.contains(&self.slots[slot as usize][corner as usize % 3]) {
                self.lead(corner, self.next[corner as usize]);
            }
        }
        let last = self.slots.len() as u32 - 1;
        if slot != last {
            (0..3).for_each(|i| self.lead(3 * last + i, 3 * slot + i));
            (0..3).for_each(|i| self.next[3 * slot as usize + i] = self.next[3 * last as usize + i]);
            self.touch(slot);
        }
        self.slots.swap_remove(slot as usize);
        self.triangles.swap_remove(slot as usize);
        self.next.truncate(3 * last as usize);
    }
}
