//! The exact way: every position goes to what it became, every wedge to the coarser one on its side of a seam.

use super::Ways;
use super::blend::{Source, unlikeness};
use super::goals::Goals;
use super::sets::Sets;
use crate::bake::Mesh;

/// Where vertices go by their heirs; `None` where that does not end in exactly the coarser mesh.
pub(super) fn ways(finer: &Mesh, coarser: &Mesh, heirs: &[u32]) -> Option<Ways> {
    let goals = Goals::new(finer, coarser, heirs)?;
    let ends = ends(finer, coarser, &goals)?;
    let mut parents = Parents::new(finer, coarser, &goals);
    parents.follow_triangles(&ends);
    parents.follow_collapsed_edges();
    parents.guess();
    let places = (0..finer.positions.len()).map(|p| goals.place(p, coarser)).collect();
    let sources =
        parents.of.iter().map(|&parent| (parent != NONE).then_some(Source::Wedge(parent))).collect();
    Some(Ways { places, sources })
}

/// No wedge yet.
const NONE: u32 = u32::MAX;

/// A triangle of the finer mesh that stays one: its number, that of the coarser mesh's triangle, and which of the
/// latter's corners its first one is.
struct End {
    finer: usize,
    coarser: usize,
    turn: usize,
}

/// What the triangles of the finer mesh end as, those left out that collapse; `None` where one of them becomes a
/// triangle that the coarser mesh does not have, or one of the latter's is missing.
fn ends(finer: &Mesh, coarser: &Mesh, goals: &Goals) -> Option<Vec<End>> {
    let known = Known::of(coarser);
    let mut is_met = vec![false; coarser.triangles.len()];
    let mut ends = Vec::new();
    for (triangle, group) in with_groups(finer) {
        let corners = finer.corners(triangle).map(|p| goals.of[p as usize]);
        if is_apart(corners) {
            let (met, turn) = known.find(corners, group)?;
            is_met[met] = true;
            ends.push(End { finer: triangle, coarser: met, turn });
        }
    }
    // Of what is there twice it is enough to meet one.
    let is_missing = |corners| known.same(corners).iter().all(|&(_, t)| !is_met[t as usize]);
    let mut kept =
        (0..coarser.triangles.len()).map(|t| coarser.corners(t)).filter(|&corners| is_apart(corners));
    (!kept.any(is_missing)).then_some(ends)
}

fn is_apart([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// The triangles of a mesh, each with the material or else the name of its group.
fn with_groups(mesh: &Mesh) -> impl Iterator<Item = (usize, &str)> {
    mesh.groups.iter().flat_map(|group| {
        let name = group.material.as_deref().unwrap_or(&group.name);
        group.triangles.clone().map(move |triangle| (triangle, name))
    })
}

/// Positions of a triangle from the lowest on, and the triangle.
type Entry = ([u32; 3], u32);

/// The triangles of the coarser mesh, to be found by their positions.
struct Known<'a> {
    /// Sorted.
    order: Vec<Entry>,
    groups: Vec<&'a str>,
    mesh: &'a Mesh,
}

impl<'a> Known<'a> {
    fn of(mesh: &'a Mesh) -> Self {
        let mut order: Vec<Entry> =
            (0..mesh.triangles.len()).map(|t| (from_lowest(mesh.corners(t)), t as u32)).collect();
        order.sort_unstable();
        Self { order, groups: with_groups(mesh).map(|(_, group)| group).collect(), mesh }
    }

    /// A triangle of these positions in this direction, and which of its corners is the first of them. Of several, the
    /// first in this group, or else the first.
    fn find(&self, corners: [u32; 3], group: &str) -> Option<(usize, usize)> {
        let same = self.same(corners);
        let fits = |&&(_, t): &&Entry| self.groups[t as usize] == group;
        let &(_, triangle) = same.iter().find(fits).or(same.first())?;
        let turn = self.mesh.corners(triangle as usize).iter().position(|&p| p == corners[0])?;
        Some((triangle as usize, turn))
    }

    /// All triangles of these positions in this direction, in their order.
    fn same(&self, corners: [u32; 3]) -> &[Entry] {
        let key = from_lowest(corners);
        let start = self.order.partition_point(|entry| entry.0 < key);
        let count = self.order[start..].partition_point(|entry| entry.0 == key);
        &self.order[start..start + count]
    }
}

fn from_lowest(mut corners: [u32; 3]) -> [u32; 3] {
    let lowest = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
    corners.rotate_left(lowest);
    corners
}

/// The coarser wedge of each wedge of the finer mesh, in the making.
struct Parents<'a> {
    finer: &'a Mesh,
    coarser: &'a Mesh,
    goals: &'a Goals,
    of: Vec<u32>,
}

impl<'a> Parents<'a> {
    fn new(finer: &'a Mesh, coarser: &'a Mesh, goals: &'a Goals) -> Self {
        Self { finer, coarser, goals, of: vec![NONE; finer.wedges.len()] }
    }

    fn goal(&self, wedge: u32) -> u32 {
        self.goals.of[self.finer.wedges[wedge as usize] as usize]
    }

    /// A wedge becomes what the corners of its triangles become. Where those are several, as where materials meet, it
    /// is the one of most corners, the lowest of equals.
    fn follow_triangles(&mut self, ends: &[End]) {
        let corners = ends.iter().flat_map(|end| {
            let (from, to) = (self.finer.triangles[end.finer], self.coarser.triangles[end.coarser]);
            (0..3).map(move |i| (from[i], to[(end.turn + i) % 3]))
        });
        let mut votes: Vec<(u32, u32)> = corners.collect();
        votes.sort_unstable();
        let mut most = vec![0; self.of.len()];
        for same in votes.chunk_by(|a, b| a == b) {
            let (wedge, parent) = (same[0].0 as usize, same[0].1);
            if same.len() > most[wedge] {
                (most[wedge], self.of[wedge]) = (same.len(), parent);
            }
        }
    }

    /// A wedge whose triangles all collapse becomes what a wedge becomes at the other end of a collapsed side, which is
    /// on the same side of every seam: it is in the same triangle.
    fn follow_collapsed_edges(&mut self) {
        let mut sets = Sets::new(self.of.len());
        for &[a, b, c] in &self.finer.triangles {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                if self.goal(a) == self.goal(b) {
                    sets.join(a, b);
                }
            }
        }
        let mut of_set = vec![NONE; self.of.len()];
        for wedge in 0..self.of.len() as u32 {
            let set = &mut of_set[sets.root(wedge) as usize];
            *set = (*set).min(self.of[wedge as usize]);
        }
        for wedge in 0..self.of.len() as u32 {
            if self.of[wedge as usize] == NONE {
                self.of[wedge as usize] = of_set[sets.root(wedge) as usize];
            }
        }
    }

    /// What nothing leads to the coarser mesh becomes the wedge there that looks most like it, the lowest of equals:
    /// all triangles of its side of the seam collapse, so it is never seen.
    fn guess(&mut self) {
        let mut at: Vec<(u32, u32)> = self.coarser.wedges.iter().copied().zip(0..).collect();
        at.sort_unstable();
        for wedge in 0..self.of.len() {
            let goal = self.goal(wedge as u32);
            if self.of[wedge] == NONE && self.goals.is_kept(goal) {
                let there = &at[at.partition_point(|a| a.0 < goal)..];
                let there = there.iter().take_while(|a| a.0 == goal).map(|a| a.1);
                let unlike =
                    |&parent: &u32| unlikeness(self.finer, wedge, self.coarser, Source::Wedge(parent));
                let best = there.min_by(|a, b| unlike(a).total_cmp(&unlike(b)));
                self.of[wedge] = best.unwrap_or(NONE);
            }
        }
    }
}
