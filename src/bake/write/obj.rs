//! Wavefront OBJ (*Advanced Visualizer manual, appendix B1: object files*).
//!
//! Positions are written once, so that a seam is no border: `v`, `vt` and `vn` have indices of their own. OBJ holds the
//! first set of texture coordinates and nothing of tangents and joints. Colours stand behind the `v`, as
//! many programs have it: where the wedges of one position differ in colour, the position is written once for each.
//! Materials are names; there is no material file.

use std::fmt::{self, Display, Formatter, Write};

use glam::Vec4;

use crate::bake::mesh::{Group, Mesh};
use crate::bake::weld::{Classes, classes};

/// The mesh as OBJ. Numbers are the shortest that are read as the same 32 bits again.
///
/// [`read::obj`](crate::bake::read::obj) gives the mesh back, its wedges in order of first use. Positions that are
/// equal become one, as do neighbouring groups of the same name and material. Line breaks in names become spaces.
///
/// # Panics
/// Where the mesh does not [check](Mesh::check).
pub fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    // A string takes whatever is written to it.
    let _ = write!(text, "{}", Obj::of(mesh));
    text
}

/// A mesh, and the numbers of what its wedges point at.
struct Obj<'a> {
    mesh: &'a Mesh,
    /// Pairs of position and first wedge of one colour; a position without a wedge has none.
    vertices: Vec<(u32, Option<u32>)>,
    vertex_of: Vec<u32>,
    uvs: Classes,
    normals: Classes,
}

impl<'a> Obj<'a> {
    fn of(mesh: &'a Mesh) -> Self {
        let (vertices, vertex_of) = coloured(mesh);
        let uvs = mesh.uvs.first().map_or(&[][..], Vec::as_slice);
        Self {
            mesh,
            vertices,
            vertex_of,
            uvs: classes(uvs.iter().map(|uv| [uv.x.to_bits(), uv.y.to_bits(), 0])),
            normals: classes(mesh.normals.iter().map(|n| n.to_array().map(f32::to_bits))),
        }
    }

    fn vertex(&self, f: &mut Formatter<'_>, position: u32, wedge: Option<u32>) -> fmt::Result {
        write!(f, "v {}", Numbers(&self.mesh.positions[position as usize].to_array()))?;
        if !self.mesh.colours.is_empty() {
            let colour = wedge.map_or(Vec4::ONE, |w| self.mesh.colours[w as usize]);
            let parts = if colour.w == 1.0 { 3 } else { 4 };
            write!(f, " {}", Numbers(&colour.to_array()[..parts]))?;
        }
        f.write_char('\n')
    }

    fn faces(&self, f: &mut Formatter<'_>, group: &Group) -> fmt::Result {
        for triangle in &self.mesh.triangles[group.triangles.clone()] {
            f.write_char('f')?;
            for &wedge in triangle {
                self.corner(f, wedge as usize)?;
            }
            f.write_char('\n')?;
        }
        Ok(())
    }

    /// `v`, `v/t`, `v//n` or `v/t/n`.
    fn corner(&self, f: &mut Formatter<'_>, wedge: usize) -> fmt::Result {
        write!(f, " {}", self.vertex_of[wedge] + 1)?;
        match (self.uvs.of.get(wedge), self.normals.of.get(wedge)) {
            (None, None) => Ok(()),
            (Some(uv), None) => write!(f, "/{}", uv + 1),
            (None, Some(normal)) => write!(f, "//{}", normal + 1),
            (Some(uv), Some(normal)) => write!(f, "/{}/{}", uv + 1, normal + 1),
        }
    }
}

impl Display for Obj<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for &(position, wedge) in &self.vertices {
            self.vertex(f, position, wedge)?;
        }
        for &first in &self.uvs.firsts {
            writeln!(f, "vt {}", Numbers(&self.mesh.uvs[0][first as usize].to_array()))?;
        }
        for &first in &self.normals.firsts {
            writeln!(f, "vn {}", Numbers(&self.mesh.normals[first as usize].to_array()))?;
        }
        // A file starts in the group without a name, and without a material.
        let mut last = (String::new(), None);
        for group in self.mesh.groups.iter().filter(|group| !group.triangles.is_empty()) {
            last = begin(f, group, last)?;
            self.faces(f, group)?;
        }
        Ok(())
    }
}

/// A `v` for each position and each colour that it has, in order of the positions; and per wedge, its `v`.
fn coloured(mesh: &Mesh) -> (Vec<(u32, Option<u32>)>, Vec<u32>) {
    let tint = colour_classes(mesh);
    let mut order: Vec<(u32, u32, u32)> =
        (0..).zip(&mesh.wedges).map(|(w, &p)| (p, tint[w as usize], w)).collect();
    order.sort_unstable();
    let (mut vertices, mut vertex_of) = (Vec::new(), vec![0; mesh.wedges.len()]);
    let mut wedges = order.into_iter().peekable();
    for position in 0..mesh.positions.len() as u32 {
        if wedges.peek().is_none_or(|&(p, ..)| p != position) {
            vertices.push((position, None));
        }
        let mut last = None;
        while let Some((_, tint, wedge)) = wedges.next_if(|&(p, ..)| p == position) {
            if last.replace(tint) != Some(tint) {
                vertices.push((position, Some(wedge)));
            }
            vertex_of[wedge as usize] = vertices.len() as u32 - 1;
        }
    }
    (vertices, vertex_of)
}

/// Per wedge, the number of its colour; 0 for all where there are none.
fn colour_classes(mesh: &Mesh) -> Vec<u32> {
    if mesh.colours.is_empty() {
        return vec![0; mesh.wedges.len()];
    }
    let rgb = classes(mesh.colours.iter().map(|c| c.truncate().to_array().map(f32::to_bits)));
    classes(mesh.colours.iter().zip(rgb.of).map(|(c, rgb)| [rgb, c.w.to_bits(), 0])).of
}

/// Says what has changed since the last group, and what holds now.
fn begin(
    f: &mut Formatter<'_>,
    group: &Group,
    (name, material): (String, Option<String>),
) -> Result<(String, Option<String>), fmt::Error> {
    let now = (line(&group.name), group.material.as_deref().map(line).filter(|name| !name.is_empty()));
    if now.0 != name {
        writeln!(f, "{}", format!("g {}", now.0).trim_end())?;
    }
    if now.1 != material {
        writeln!(f, "{}", format!("usemtl {}", now.1.as_deref().unwrap_or_default()).trim_end())?;
    }
    Ok(now)
}

/// A name that stays on its line.
fn line(name: &str) -> String {
    let spaced: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    // A line that ends in a backslash would go on in the next one.
    spaced.trim_end_matches(|c: char| c == '\\' || c.is_ascii_whitespace()).trim_ascii_start().to_owned()
}

/// Numbers with spaces between.
struct Numbers<'a>(&'a [f32]);

impl Display for Numbers<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (i, &x) in self.0.iter().enumerate() {
            let space = if i > 0 { " " } else { "" };
            match x.abs() {
                size if size == 0.0 || (1e-5..1e9).contains(&size) => write!(f, "{space}{x}")?,
                _ => write!(f, "{space}{x:e}")?,
            }
        }
        Ok(())
    }
}
