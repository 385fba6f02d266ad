//! From what was seen of a simplification to the file: the same way back, split by split.

use super::file::bytes::put_number;
use super::file::head::{Counts, GroupHead, Head};
use super::file::record::{Codec, steps_of};
use super::file::{Kind, MAGIC, base, original, put_part};
use super::row::Columns;
use super::split::{Change, Split};
use super::state::{NONE, State};
use super::trail::{Ends, Walked};
use crate::bake::Mesh;

/// How many splits a block has. Of a file that ends within a block, all of the block is lost.
const BLOCK: usize = 1024;

/// Goes back from the base mesh. `state` is the mesh in the numbers of the file, `walked` in those of the method.
pub(super) struct Writer<'a> {
    mesh: &'a Mesh,
    walked: Walked,
    /// After each number of contractions, in steps.
    errors: Vec<u32>,
    state: State,
    /// Per vertex, wedge and triangle of the method, the file's number.
    vertices: Vec<u32>,
    wedges: Vec<u32>,
    triangles: Vec<u32>,
    /// Per triangle of the original.
    groups: Vec<u32>,
    split: Split,
    codec: Codec,
}

impl<'a> Writer<'a> {
    /// `errors` are those after each number of contractions.
    pub(super) fn new(mesh: &'a Mesh, walked: Walked, errors: &[f64]) -> Self {
        let mut groups = vec![0; mesh.triangles.len()];
        for (number, group) in (0..).zip(&mesh.groups) {
            groups[group.triangles.clone()].fill(number);
        }
        Self {
            mesh,
            errors: errors.iter().map(|&error| steps_of(error)).collect(),
            state: State::new(walked.width, mesh.groups.len()),
            vertices: vec![NONE; walked.positions.len()],
            wedges: vec![NONE; walked.wedges.len()],
            triangles: vec![NONE; walked.triangles.len()],
            groups,
            split: Split::default(),
            codec: Codec::default(),
            walked,
        }
    }

    /// The file.
    ///
    /// # Errors
    /// A part that is too large.
    pub(super) fn write(mut self) -> Result<Vec<u8>, String> {
        let mut file = MAGIC.to_vec();
        self.number_base();
        let mut holds = Vec::new();
        self.head().put(&mut holds);
        put_part(Kind::Head, &holds, &mut file)?;
        holds.clear();
        base::put(&self.state, &mut holds);
        put_part(Kind::Base, &holds, &mut file)?;
        let events: Vec<usize> = (0..self.walked.events.len()).rev().collect();
        for block in events.chunks(BLOCK) {
            put_part(Kind::Splits, &self.block(block), &mut file)?;
        }
        holds.clear();
        original::put(self.mesh, &self.state, &self.order(), &mut holds);
        put_part(Kind::Original, &holds, &mut file)?;
        Ok(file)
    }

    fn head(&self) -> Head {
        let (mesh, walked) = (self.mesh, &self.walked);
        let group = |group: &crate::bake::Group| GroupHead {
            name: group.name.clone(),
            material: group.material.clone(),
            triangles: group.triangles.len(),
        };
        let counts = |positions, wedges, triangles| Counts { positions, wedges, triangles };
        Head {
            name: mesh.name.clone(),
            columns: Columns::of(mesh),
            groups: mesh.groups.iter().map(group).collect(),
            base: self.state.counts(),
            full: counts(walked.positions.len(), walked.wedges.len(), walked.triangles.len()),
            original: counts(mesh.positions.len(), mesh.wedges.len(), mesh.triangles.len()),
            splits: walked.events.len(),
            error: self.errors.last().copied().unwrap_or(0),
        }
    }

    /// Numbers what is left, in the order of the method, which keeps neighbours together.
    fn number_base(&mut self) {
        let left = |t: &usize| self.walked.is_left[*t];
        let left: Vec<usize> = (0..self.walked.triangles.len()).filter(left).collect();
        let mut vertices: Vec<u32> = Vec::new();
        for &triangle in &left {
            for wedge in self.walked.triangles[triangle] {
                if self.wedges[wedge as usize] == NONE {
                    self.wedges[wedge as usize] = 0;
                    vertices.push(self.walked.wedges[wedge as usize]);
                }
            }
        }
        vertices.sort_unstable();
        vertices.dedup();
        vertices.iter().for_each(|&vertex| self.add_vertex(vertex));
        for wedge in 0..self.wedges.len() as u32 {
            if self.wedges[wedge as usize] == 0 {
                self.wedges[wedge as usize] = self.state.wedges.len() as u32;
                self.state.wedges.push(self.vertices[self.walked.wedges[wedge as usize] as usize]);
                self.state.rows.extend_from_slice(row(&self.walked.rows, self.walked.width, wedge as usize));
            }
        }
        for triangle in left {
            self.triangles[triangle] = self.state.triangles.len() as u32;
            let (wedges, group) = self.numbered(triangle);
            self.state.push_triangle(wedges, group);
        }
    }

    fn add_vertex(&mut self, vertex: u32) {
        self.vertices[vertex as usize] = self.state.positions.len() as u32;
        self.state.push_position(self.walked.positions[vertex as usize]);
    }

    /// A triangle's wedges in the numbers of the file, and its group.
    fn numbered(&self, triangle: usize) -> ([u32; 3], u32) {
        let wedges = self.walked.triangles[triangle].map(|wedge| self.wedges[wedge as usize]);
        (wedges, self.groups[self.walked.old_triangles[triangle] as usize])
    }

    /// The splits of some events, one after the other.
    fn block(&mut self, events: &[usize]) -> Vec<u8> {
        let mut records = Vec::new();
        for &event in events {
            self.go_back(event);
            let error = self.errors[event + 1];
            self.codec.write(&self.split, &self.state, error, &mut records);
            self.state.apply(&self.split, None);
        }
        let mut block = Vec::with_capacity(records.len() + 16);
        put_number(events.len() as u32, &mut block);
        put_number(self.state.triangles.len() as u32, &mut block);
        put_number(self.split.error, &mut block);
        block.append(&mut records);
        block
    }

    /// Undoes an event, and makes a split of it.
    fn go_back(&mut self, event: usize) {
        let (from, to) = (self.walked.starts(event), self.walked.events[event].ends);
        self.split.clear();
        self.split.error = self.errors[event];
        self.place_vertices(event, from, to);
        self.go_back_with_wedges(from, to);
        let (first, old) = (self.state.triangles.len() as u32, from.triangles..to.triangles);
        for (number, at) in (first..).zip(old) {
            let triangle = self.walked.gone_triangles[at] as usize;
            self.triangles[triangle] = number;
            let (wedges, group) = self.numbered(triangle);
            self.split.triangles.push(wedges);
            self.split.groups.push(group);
        }
    }

    /// A kept vertex that went, too, is none that is split: all comes back.
    fn place_vertices(&mut self, event: usize, from: Ends, to: Ends) {
        let event = self.walked.events[event];
        self.walked.positions[event.kept as usize] = event.place;
        self.split.parent = self.vertices[event.kept as usize];
        self.split.place = event.place;
        let first = self.state.positions.len() as u32;
        for (number, &vertex) in (first..).zip(&self.walked.gone_vertices[from.vertices..to.vertices]) {
            self.vertices[vertex as usize] = number;
            self.split.positions.push(self.walked.positions[vertex as usize]);
        }
    }

    fn go_back_with_wedges(&mut self, from: Ends, to: Ends) {
        let walked = &mut self.walked;
        let width = walked.width;
        for at in (from.changed..to.changed).rev() {
            let (wedge, vertex) = walked.changed[at];
            let of = &mut walked.wedges[wedge as usize];
            let moves = std::mem::replace(of, vertex) != vertex;
            walked.rows[wedge as usize * width..][..width].copy_from_slice(row(&walked.old_rows, width, at));
            self.split.changed.push(Change { wedge: self.wedges[wedge as usize], moves });
            self.split.rows.extend_from_slice(row(&walked.old_rows, width, at));
        }
        let first = self.state.wedges.len() as u32;
        for (number, &wedge) in (first..).zip(&walked.gone_wedges[from.wedges..to.wedges]) {
            self.wedges[wedge as usize] = number;
            self.split.wedges.push(self.vertices[walked.wedges[wedge as usize] as usize]);
            self.split.rows.extend_from_slice(row(&walked.rows, width, wedge as usize));
        }
        for &(corner, wedge) in walked.corners[from.corners..to.corners].iter().rev() {
            walked.triangles.as_flattened_mut()[corner as usize] = wedge;
            let number = 3 * self.triangles[corner as usize / 3] + corner % 3;
            self.split.corners.push((number, self.wedges[wedge as usize]));
        }
        // As the fan has them.
        self.split.corners.sort_unstable_by(|a, b| b.cmp(a));
    }

    /// For each triangle of the original, which one of the file's it is.
    fn order(&self) -> Vec<u32> {
        let mut order = vec![NONE; self.mesh.triangles.len()];
        for (&old, &number) in self.walked.old_triangles.iter().zip(&self.triangles) {
            order[old as usize] = number;
        }
        order
    }
}

fn row(rows: &[u32], width: usize, at: usize) -> &[u32] {
    &rows[at * width..][..width]
}
