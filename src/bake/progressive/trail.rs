//! Looking on while a mesh is simplified, and keeping what it takes to go back.

use glam::Vec3;

use super::bound::{Corner, Star};
use super::row::Columns;
use crate::bake::simplify::{Seen, Witness};
use crate::bake::{Mesh, Surface};

/// A contraction, by what it overwrote and took away. Vertices and triangles go by the method's numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    pub(super) kept: u32,
    /// Where the kept vertex was.
    pub(super) place: Vec3,
    /// How far it has taken the surface at most.
    pub(super) moved: f64,
    /// Where its parts of the trail's lists end.
    pub(super) ends: Ends,
}

/// How long the lists of a trail are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    pub(super) triangles: usize,
    pub(super) corners: usize,
    pub(super) changed: usize,
    pub(super) wedges: usize,
    pub(super) vertices: usize,
    pub(super) fans: usize,
}

/// A mesh as it is by now, and all contractions that led to it.
///
/// Its wedges are those of the mesh that simplification begins with: corners of a vertex that look the same. Every wedge
/// of a coarser mesh is one of the finer, so nothing but attributes changes when some become one.
#[derive(Default)]
pub(super) struct Walked {
    /// Per triangle, the original's. The triangles that simplification leaves out are none of these.
    pub(super) old_triangles: Vec<u32>,
    /// Per triangle, its wedges; those that are gone keep what they had.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Per triangle.
    pub(super) is_left: Vec<bool>,
    /// Per wedge, its vertex.
    pub(super) wedges: Vec<u32>,
    /// Words per wedge, and those words.
    pub(super) width: usize,
    pub(super) rows: Vec<u32>,
    pub(super) positions: Vec<Vec3>,
    pub(super) events: Vec<Event>,
    /// Triangles that went, event by event.
    pub(super) gone_triangles: Vec<u32>,
    /// Corners that got another wedge, and the one they had.
    pub(super) corners: Vec<(u32, u32)>,
    /// Wedges that got another row or vertex, and the vertex they had.
    pub(super) changed: Vec<(u32, u32)>,
    /// The rows they had.
    pub(super) old_rows: Vec<u32>,
    pub(super) gone_wedges: Vec<u32>,
    /// Vertices that went, first of each event the one that was contracted.
    pub(super) gone_vertices: Vec<u32>,
    /// Triangles that those that went have become part of.
    pub(super) fans: Vec<u32>,
}

impl Walked {
    fn ends(&self) -> Ends {
        Ends {
            triangles: self.gone_triangles.len(),
            corners: self.corners.len(),
            changed: self.changed.len(),
            wedges: self.gone_wedges.len(),
            vertices: self.gone_vertices.len(),
            fans: self.fans.len(),
        }
    }

    /// Where the parts of an event begin.
    pub(super) fn starts(&self, event: usize) -> Ends {
        event.checked_sub(1).map_or(Ends::default(), |before| self.events[before].ends)
    }

    /// The triangles around the vertices of a contraction, before or after it.
    pub(super) fn star(&self, event: usize) -> impl Iterator<Item = u32> {
        let (from, to) = (self.starts(event), self.events[event].ends);
        let fan = &self.fans[from.fans..to.fans];
        fan.iter().chain(&self.gone_triangles[from.triangles..to.triangles]).copied()
    }

    /// The mesh as it is by now.
    pub(super) fn surface(&self) -> Surface {
        let left = self.triangles.iter().zip(&self.is_left).filter(|&(_, &is_left)| is_left);
        let triangles = left.map(|(t, _)| t.map(|wedge| self.wedges[wedge as usize])).collect();
        Surface { positions: self.positions.clone(), triangles }
    }
}

/// Somebody who looks on.
pub(super) struct Trail<'a> {
    mesh: &'a Mesh,
    columns: Columns,
    /// Told of the mesh after every contraction, and how many there were.
    follow: &'a mut dyn FnMut(&Seen, usize),
    walked: Walked,
    /// Whether nothing would be left of the mesh: what follows is not kept.
    is_over: bool,
    star: Star,
    /// Where the kept vertex was.
    place: Vec3,
    /// The wedges that may go.
    wedges_before: Vec<u32>,
    /// Vertices across from the edge.
    thirds: Vec<u32>,
    fan: Vec<u32>,
    classes: Vec<Class>,
    row: Vec<u32>,
}

/// Corners of a vertex that look the same.
#[derive(Clone, Copy, Debug)]
struct Class {
    look: [u32; 3],
    /// Whether its tangents are left-handed.
    is_left: bool,
    /// The wedge that it is.
    wedge: u32,
    /// Whether that was the kept vertex's.
    is_own: bool,
    /// The wedge of the original whose tangent and skin it has.
    stands: u32,
    /// Whether that was where the vertex stems from.
    is_at_origin: bool,
}

impl<'a> Trail<'a> {
    pub(super) fn new(mesh: &'a Mesh, follow: &'a mut dyn FnMut(&Seen, usize)) -> Self {
        let columns = Columns::of(mesh);
        Self {
            mesh,
            columns,
            follow,
            walked: Walked { width: columns.width(), ..Walked::default() },
            is_over: false,
            star: Star::default(),
            place: Vec3::ZERO,
            wedges_before: Vec::new(),
            thirds: Vec::new(),
            fan: Vec::new(),
            classes: Vec::new(),
            row: Vec::new(),
        }
    }

    /// All that was seen.
    pub(super) fn walked(self) -> Walked {
        self.walked
    }

    /// The corner of a triangle that is at a vertex.
    fn corner(seen: &Seen, triangle: u32, vertex: u32) -> usize {
        let corners = seen.triangle(triangle).unwrap_or_default();
        corners.iter().position(|&corner| corner == vertex).unwrap_or_default()
    }

    /// Finds the classes of a vertex's corners. `wedge` says which wedge a corner has by now.
    fn find_classes(&mut self, seen: &Seen, vertex: u32) {
        self.fan.clear();
        self.fan.extend_from_slice(seen.fan(vertex));
        self.fan.sort_unstable();
        self.classes.clear();
        for i in 0..self.fan.len() {
            let triangle = self.fan[i];
            let corner = Self::corner(seen, triangle, vertex);
            let class = self.class_of(seen, vertex, triangle, corner);
            match self.classes.iter_mut().find(|c| c.look == class.look && c.is_left == class.is_left) {
                Some(known) => known.join(&class),
                None => self.classes.push(class),
            }
        }
    }

    /// The class of one corner.
    fn class_of(&self, seen: &Seen, vertex: u32, triangle: u32, corner: usize) -> Class {
        let old = self.mesh.triangles[self.walked.old_triangles[triangle as usize] as usize][corner];
        let is_left = self.mesh.tangents.get(old as usize).is_some_and(|t| t.w < 0.0);
        let wedge = self.walked.triangles[triangle as usize][corner];
        Class {
            look: if self.walked.width > 0 { seen.look(triangle, corner) } else { [0; 3] },
            is_left: is_left && self.walked.width > 0,
            wedge,
            is_own: self.walked.wedges.get(wedge as usize) == Some(&vertex),
            stands: old,
            is_at_origin: self.mesh.wedges[old as usize] == seen.origin(vertex),
        }
    }

    /// The row of a class, in `row`.
    fn find_row(&mut self, seen: &Seen, class: &Class) {
        self.row.clear();
        if self.walked.width > 0 {
            self.row.extend(seen.values(class.look).map(f32::to_bits));
            self.columns.read_rest(self.mesh, class.stands as usize, &mut self.row);
        }
    }

    /// Gives every class of a vertex, which has been found, a wedge of its own.
    fn add_wedges(&mut self, seen: &Seen, vertex: u32) {
        for k in 0..self.classes.len() {
            self.classes[k].wedge = self.walked.wedges.len() as u32;
            self.walked.wedges.push(vertex);
            self.find_row(seen, &self.classes[k].clone());
            self.walked.rows.extend_from_slice(&self.row);
        }
        for i in 0..self.fan.len() {
            let corner = Self::corner(seen, self.fan[i], vertex);
            let class = self.class_of(seen, vertex, self.fan[i], corner);
            self.walked.triangles[self.fan[i] as usize][corner] = self.wedge_of(&class);
        }
    }

    /// The wedge of a class that has been found.
    fn wedge_of(&self, class: &Class) -> u32 {
        let same = self.classes.iter().find(|c| c.look == class.look && c.is_left == class.is_left);
        same.map_or(class.wedge, |class| class.wedge)
    }

    /// Follows the wedges of the kept vertex.
    fn follow_wedges(&mut self, seen: &Seen, kept: u32) {
        self.find_classes(seen, kept);
        for i in 0..self.fan.len() {
            let (triangle, corner) = (self.fan[i], Self::corner(seen, self.fan[i], kept));
            let class = self.class_of(seen, kept, triangle, corner);
            let wedge = self.wedge_of(&class);
            if wedge != class.wedge {
                self.walked.corners.push((3 * triangle + corner as u32, class.wedge));
                self.walked.triangles[triangle as usize][corner] = wedge;
            }
        }
        for k in 0..self.classes.len() {
            self.update(seen, &self.classes[k].clone(), kept);
        }
    }

    /// Gives the wedge of a class its row and vertex.
    fn update(&mut self, seen: &Seen, class: &Class, vertex: u32) {
        self.find_row(seen, class);
        let at = class.wedge as usize;
        let row = &mut self.walked.rows[at * self.walked.width..][..self.walked.width];
        if row != self.row || self.walked.wedges[at] != vertex {
            self.walked.changed.push((class.wedge, self.walked.wedges[at]));
            self.walked.old_rows.extend_from_slice(row);
            row.copy_from_slice(&self.row);
            self.walked.wedges[at] = vertex;
        }
    }

    /// Notes the wedges that no corner has any more.
    fn find_gone_wedges(&mut self, seen: &Seen, kept: u32) {
        let mut before = std::mem::take(&mut self.wedges_before);
        before.sort_unstable();
        before.dedup();
        let vertices = || self.thirds.iter().copied().chain([kept]);
        let corners = || vertices().flat_map(|v| seen.fan(v).iter().map(move |&t| (v, t)));
        let wedge = |(v, t): (u32, u32)| self.walked.triangles[t as usize][Self::corner(seen, t, v)];
        before.retain(|&old| corners().all(|corner| wedge(corner) != old));
        self.walked.gone_wedges.extend_from_slice(&before);
        before.clear();
        self.wedges_before = before;
    }

    fn find_star(&mut self, seen: &Seen, kept: u32, gone: u32) {
        let [a, b] = [kept, gone].map(|vertex| seen.fan(vertex));
        let others = b.iter().filter(|&&t| !seen.triangle(t).is_some_and(|c| c.contains(&kept)));
        self.star.old.clear();
        self.star.old.extend(a.iter().chain(others).filter_map(|&t| corners(seen, t)));
        (self.star.kept, self.star.gone) = (kept, gone);
    }

    /// How far a contraction has taken the surface at most.
    fn measure(&mut self, seen: &Seen, kept: u32) -> f64 {
        self.star.to = seen.position(kept).as_dvec3();
        self.star.new.clear();
        self.star.new.extend(seen.fan(kept).iter().filter_map(|&t| corners(seen, t)));
        self.star.elsewhere = None;
        if !self.fan.is_empty() {
            self.walked.fans.extend_from_slice(&self.fan);
        } else if let Some((triangle, place)) = self.nearest(seen, self.star.to) {
            self.walked.fans.push(triangle);
            self.star.elsewhere = Some(place);
        }
        self.star.bound()
    }

    /// A triangle that is left, and the corner of it that is nearest to a place. O(triangles), for the rare case that a
    /// part goes altogether.
    fn nearest(&self, seen: &Seen, place: glam::DVec3) -> Option<(u32, glam::DVec3)> {
        let left = (0..self.walked.triangles.len() as u32).filter_map(|t| corners(seen, t).map(|c| (t, c)));
        let all = left.flat_map(|(t, corners)| corners.map(|corner| (t, corner.at)));
        all.min_by(|a, b| a.1.distance_squared(place).total_cmp(&b.1.distance_squared(place)))
    }
}

impl Class {
    /// Takes a later corner in.
    fn join(&mut self, other: &Self) {
        if other.is_own && !self.is_own {
            (self.wedge, self.is_own) = (other.wedge, true);
        }
        if other.is_at_origin && !self.is_at_origin {
            (self.stands, self.is_at_origin) = (other.stands, true);
        }
    }
}

fn corners(seen: &Seen, triangle: u32) -> Option<[Corner; 3]> {
    let corner = |vertex: u32| Corner { vertex, at: seen.position(vertex).as_dvec3() };
    seen.triangle(triangle).map(|vertices| vertices.map(corner))
}

impl Witness for Trail<'_> {
    fn begin(&mut self, seen: &Seen) {
        self.walked.old_triangles = seen.old_triangles().to_vec();
        self.walked.triangles = vec![[u32::MAX; 3]; self.walked.old_triangles.len()];
        self.walked.is_left = vec![true; self.walked.old_triangles.len()];
        let count = seen.vertices().len() as u32;
        self.walked.positions = (0..count).map(|vertex| seen.position(vertex)).collect();
        for vertex in 0..count {
            self.find_classes(seen, vertex);
            self.add_wedges(seen, vertex);
        }
    }

    fn before(&mut self, seen: &Seen, kept: u32, gone: u32) {
        let goes = |&&t: &&u32| seen.triangle(t).is_some_and(|corners| corners.contains(&kept));
        self.is_over |= seen.fan(gone).iter().filter(goes).count() == seen.live();
        if self.is_over {
            return;
        }
        self.place = seen.position(kept);
        self.find_star(seen, kept, gone);
        self.wedges_before.clear();
        self.thirds.clear();
        for vertex in [kept, gone] {
            for &triangle in seen.fan(vertex) {
                let wedge = self.walked.triangles[triangle as usize][Self::corner(seen, triangle, vertex)];
                self.wedges_before.push(wedge);
            }
        }
        for &triangle in seen.fan(gone) {
            let corners = seen.triangle(triangle).unwrap_or_default();
            if corners.contains(&kept) {
                self.walked.gone_triangles.push(triangle);
                self.walked.is_left[triangle as usize] = false;
                for (vertex, wedge) in corners.into_iter().zip(self.walked.triangles[triangle as usize]) {
                    if vertex != kept && vertex != gone {
                        self.thirds.push(vertex);
                        self.wedges_before.push(wedge);
                    }
                }
            }
        }
        self.thirds.sort_unstable();
        self.thirds.dedup();
    }

    fn after(&mut self, seen: &Seen, kept: u32, gone: u32) {
        if self.is_over {
            return;
        }
        if self.columns.tangents || self.columns.skins {
            for i in 0..self.thirds.len() {
                self.find_classes(seen, self.thirds[i]);
                for k in 0..self.classes.len() {
                    self.update(seen, &self.classes[k].clone(), self.thirds[i]);
                }
            }
        }
        self.follow_wedges(seen, kept);
        self.find_gone_wedges(seen, kept);
        self.walked.gone_vertices.push(gone);
        let is_bare = |vertex: &u32| seen.fan(*vertex).is_empty();
        let bare = [kept].into_iter().chain(self.thirds.iter().copied()).filter(is_bare);
        self.walked.gone_vertices.extend(bare);
        let moved = self.measure(seen, kept);
        self.walked.positions[kept as usize] = seen.position(kept);
        let ends = self.walked.ends();
        self.walked.events.push(Event { kept, place: self.place, moved, ends });
        (self.follow)(seen, self.walked.events.len());
    }
}
