//! A mesh while vertices are taken out of it, with the wedges of all corners.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};

use super::cluster::cloud::without_repeats;
use super::fans::Fans;
use super::link::{Complex, Rings, Stamps, others};
use super::rebuild::{Corner, Facet, Rebuilt};
use super::{Progress, Simplified, Stopped, Task};
use crate::bounds::Aabb;

/// A triangle that went.
pub(super) const GONE: [u32; 3] = [u32::MAX; 3];

/// How many steps pass between two calls of the progress callback.
const STRIDE: usize = 4096;

/// What a triangle's corner looks like, other than where it is: its material and its wedge.
type Look = (u32, u32);

/// A mesh while vertices are taken out of it. Vertices have the indices of the task's positions; triangles are numbered
/// anew, those that use a position twice left out.
pub(super) struct Workpiece<'a> {
    pub(super) task: &'a Task<'a>,
    /// A power of two that makes places of positions, some units around.
    scale: f64,
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) fans: Fans,
    /// Per triangle, the old wedges of its corners.
    wedges: Vec<[u32; 3]>,
    /// Per triangle, the old one that it was, or in whose stead it came.
    old: Vec<u32>,
    /// Per triangle, its group.
    groups: Vec<u32>,
    has_attributes: bool,
    /// Per vertex, the old one it stems from by now, and what it was merged into, or itself.
    origins: Vec<u32>,
    heirs: Vec<u32>,
    from: usize,
    live: usize,
    stamps: Stamps,
    rings: Rings,
    fan: Vec<u32>,
}

impl<'a> Workpiece<'a> {
    pub(super) fn new(task: &'a Task) -> Self {
        let mesh = task.mesh;
        let (old, triangles) = task.proper_triangles();
        let count = mesh.positions.len();
        Self {
            task,
            scale: scale_of(triangles.as_flattened().iter().map(|&v| mesh.positions[v as usize])),
            positions: mesh.positions.clone(),
            fans: Fans::new(count, &triangles),
            wedges: old.iter().map(|&t| mesh.triangles[t as usize]).collect(),
            groups: groups_of(task, &old),
            has_attributes: mesh.has_attributes(),
            origins: (0..count as u32).collect(),
            heirs: (0..count as u32).collect(),
            from: triangles.len(),
            live: triangles.len(),
            stamps: Stamps::new(count),
            rings: Rings::default(),
            fan: Vec::new(),
            triangles,
            old,
        }
    }

    /// How many triangles there are now.
    pub(super) fn live(&self) -> usize {
        self.live
    }

    /// A position in double precision, scaled to some units around.
    #[inline]
    pub(super) fn place(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize].as_dvec3() * self.scale
    }

    /// The places of a triangle's corners.
    pub(super) fn places(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.place(v))
    }

    /// A length in object units.
    pub(super) fn in_units(&self, length: f64) -> f32 {
        (length / self.scale) as f32
    }

    /// The position of a place.
    pub(super) fn position_at(&self, place: DVec3) -> Vec3 {
        (place / self.scale).as_vec3()
    }

    /// The weight of a triangle; that of a new one is that of the one it came for.
    pub(super) fn weight(&self, triangle: u32) -> f64 {
        self.task.weight(self.old[triangle as usize] as usize)
    }

    pub(super) fn is_locked(&self, vertex: u32) -> bool {
        self.task.is_locked(vertex as usize)
    }

    /// The vertices that triangles are left of, ascending.
    pub(super) fn vertices(&self) -> impl Iterator<Item = u32> {
        (0..self.positions.len() as u32).filter(|&v| !self.fans.of(v).is_empty())
    }

    /// The neighbours of a vertex, ascending, each once.
    pub(super) fn neighbours(&self, vertex: u32, list: &mut Vec<u32>) {
        list.clear();
        list.extend(self.fans.of(vertex).iter().flat_map(|&t| others(self.triangles[t as usize], vertex)));
        list.sort_unstable();
        list.dedup();
    }

    /// The triangles that use both vertices.
    pub(super) fn at_edge(&self, a: u32, b: u32) -> impl Iterator<Item = u32> {
        self.fans.of(a).iter().copied().filter(move |&t| self.triangles[t as usize].contains(&b))
    }

    fn look(&self, triangle: u32, vertex: u32) -> Look {
        let wedge = if self.has_attributes { self.wedge_at(triangle, vertex) } else { vertex };
        (self.groups[triangle as usize], wedge)
    }

    /// Whether an edge is on a border or a seam: it has not two triangles, or they look different there.
    pub(super) fn is_crease(&self, a: u32, b: u32) -> bool {
        let mut at_edge = self.at_edge(a, b);
        match (at_edge.next(), at_edge.next(), at_edge.next()) {
            (Some(s), Some(t), None) => {
                self.look(s, a) != self.look(t, a) || self.look(s, b) != self.look(t, b)
            }
            _ => true,
        }
    }

    /// Whether the contraction of an edge keeps the topology; `at_border` as [`Complex::may_contract`] has it.
    pub(super) fn keeps_topology(&mut self, a: u32, b: u32, at_border: bool) -> bool {
        let complex = Complex { triangles: &self.triangles, fans: &self.fans };
        complex.find_rings([a, b], &mut self.rings);
        complex.may_contract([a, b], &self.rings, at_border, &mut self.stamps)
    }

    /// Whether a vertex is on an edge that has not exactly two triangles.
    pub(super) fn is_at_border(&self, vertex: u32) -> bool {
        let sides = || self.fans.of(vertex).iter().flat_map(|&t| others(self.triangles[t as usize], vertex));
        sides().any(|p| self.at_edge(vertex, p).count() != 2)
    }

    /// A triangle's corner at a vertex.
    pub(super) fn corner(&self, triangle: u32, vertex: u32) -> Corner {
        Corner { vertex, wedge: self.wedge_at(triangle, vertex) }
    }

    fn wedge_at(&self, triangle: u32, vertex: u32) -> u32 {
        let corners = self.triangles[triangle as usize];
        let corner = corners.iter().position(|&c| c == vertex).unwrap_or(0);
        self.wedges[triangle as usize][corner]
    }

    /// Makes all triangles of `gone` ones of `kept`. Those that use both go. Corners take the wedge of `kept` that a
    /// triangle between the two leads them to; without one they keep theirs, so that no corner crosses a seam.
    pub(super) fn merge(&mut self, gone: u32, kept: u32) {
        let lead = |t: u32| (self.look(t, gone), self.wedge_at(t, kept));
        let mut leads: Vec<_> = self.at_edge(gone, kept).map(lead).collect();
        leads.sort_unstable();
        let mut fan = std::mem::take(&mut self.fan);
        fan.clear();
        fan.extend_from_slice(self.fans.of(gone));
        for &triangle in &fan {
            if self.triangles[triangle as usize].contains(&kept) {
                self.remove(triangle);
            } else {
                self.hand_over(triangle, gone, kept, &leads);
            }
        }
        fan.retain(|&t| self.triangles[t as usize] != GONE);
        fan.splice(0..0, self.fans.of(kept).iter().copied());
        self.fans.replace(gone, &[]);
        self.fans.replace(kept, &fan);
        self.heirs[gone as usize] = kept;
        self.fan = fan;
    }

    /// Makes a triangle of `gone` one of `kept`.
    fn hand_over(&mut self, triangle: u32, gone: u32, kept: u32, leads: &[(Look, u32)]) {
        let look = self.look(triangle, gone);
        let lead = leads.iter().find(|(from, _)| *from == look).map(|&(_, to)| to);
        let wedge = lead.unwrap_or_else(|| self.wedge_at(triangle, gone));
        let at = triangle as usize;
        for corner in 0..3 {
            if self.triangles[at][corner] == gone {
                self.triangles[at][corner] = kept;
                self.wedges[at][corner] = wedge;
            }
        }
    }

    /// Takes a triangle out.
    pub(super) fn remove(&mut self, triangle: u32) {
        for corner in self.triangles[triangle as usize] {
            self.fans.remove(corner, triangle);
        }
        self.triangles[triangle as usize] = GONE;
        self.live -= 1;
    }

    /// Puts a triangle in the place of one that went, in its group.
    pub(super) fn insert(&mut self, triangle: u32, corners: [Corner; 3]) {
        self.triangles[triangle as usize] = corners.map(|c| c.vertex);
        self.wedges[triangle as usize] = corners.map(|c| c.wedge);
        for Corner { vertex, .. } in corners {
            let mut fan = std::mem::take(&mut self.fan);
            fan.clear();
            fan.extend_from_slice(self.fans.of(vertex));
            fan.push(triangle);
            self.fans.replace(vertex, &fan);
            self.fan = fan;
        }
        self.live += 1;
    }

    /// Says what a vertex whose triangles have gone has become.
    pub(super) fn set_heir(&mut self, gone: u32, heir: u32) {
        self.heirs[gone as usize] = heir;
    }

    /// Moves a vertex, which from then on stems from `origin`.
    pub(super) fn move_to(&mut self, vertex: u32, position: Vec3, origin: u32) {
        self.positions[vertex as usize] = position;
        self.origins[vertex as usize] = origin;
    }

    /// Takes steps until there are few enough triangles, or `step` says that there is none left.
    pub(super) fn run(
        &mut self,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
        mut step: impl FnMut(&mut Self) -> ControlFlow<()>,
    ) -> Stopped {
        let target = self.task.target.triangles;
        for taken in 1.. {
            if self.live <= target {
                return Stopped::Triangles;
            }
            let so_far = Progress { from: self.from, triangles: self.live, target };
            if taken % STRIDE == 0 && progress(so_far).is_break() {
                return Stopped::Cancelled;
            }
            if step(self).is_break() {
                break;
            }
        }
        Stopped::Exhausted
    }

    /// What is left, each triangle once, with an error in object units.
    pub(super) fn finish(mut self, error: f32, stopped: Stopped) -> Simplified {
        let left = (0..self.triangles.len()).filter(|&t| self.triangles[t] != GONE);
        let facets = without_repeats(left.map(|t| self.facet(t)).collect());
        let is_met = facets.len() <= self.task.target.triangles;
        let stopped = if is_met { Stopped::Triangles } else { stopped };
        let Rebuilt { mesh, vertices, wedges, position_of } =
            Rebuilt::new(self.task.mesh, &self.positions, facets);
        let origins = vertices.iter().map(|&v| self.origins[v as usize]).collect();
        let count = self.heirs.len() as u32;
        let heirs = (0..count).map(|v| position_of[self.last_heir(v) as usize]).collect();
        Simplified { mesh, origins, wedge_origins: wedges, heirs, error, stopped }
    }

    fn facet(&self, triangle: usize) -> Facet {
        let (vertices, wedges) = (self.triangles[triangle], self.wedges[triangle]);
        let corner = |i| Corner { vertex: vertices[i], wedge: wedges[i] };
        Facet { old: self.old[triangle], corners: [corner(0), corner(1), corner(2)] }
    }

    /// The vertex that a vertex has become; halves the way there for whoever asks next.
    fn last_heir(&mut self, mut vertex: u32) -> u32 {
        while self.heirs[vertex as usize] != vertex {
            let next = self.heirs[vertex as usize];
            self.heirs[vertex as usize] = self.heirs[next as usize];
            vertex = self.heirs[vertex as usize];
        }
        vertex
    }
}

/// Per kept triangle, the index of its group.
fn groups_of(task: &Task, kept: &[u32]) -> Vec<u32> {
    let groups = &task.mesh.groups;
    let group = |&t: &u32| groups.partition_point(|group| group.triangles.end <= t as usize) as u32;
    kept.iter().map(group).collect()
}

/// The power of two that scales the box around positions to a longest side between ½ and 1; 1 for a point.
pub(super) fn scale_of(positions: impl Iterator<Item = Vec3>) -> f64 {
    let bounds = Aabb::around(positions);
    let extent = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element();
    if extent > 0.0 { (-extent.log2().ceil()).exp2() } else { 1.0 }
}
