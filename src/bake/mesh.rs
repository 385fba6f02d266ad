//! The one mesh type of the bake.

use std::mem::take;
use std::ops::Range;

use glam::{Vec2, Vec3, Vec4};

use super::surface::Surface;
use crate::bounds::Aabb;

/// A triangle mesh: positions welded, attributes per wedge (a corner's view of a vertex), triangles of wedges.
///
/// A vertex on a seam has one position and several wedges: the surface is whole there, its attributes are not
/// (Hoppe, *Efficient implementation of progressive meshes*, 1998).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// What the mesh is called; the file's stem where the file says nothing.
    pub name: String,
    /// In object units.
    pub positions: Vec<Vec3>,
    /// Per wedge, its position.
    pub wedges: Vec<u32>,
    /// Per wedge; empty where the mesh has none. The zero vector where one corner has none and others do.
    pub normals: Vec<Vec3>,
    /// One column per set, each per wedge.
    pub uvs: Vec<Vec<Vec2>>,
    /// Per wedge, linear RGBA as the file has it; empty where the mesh has none.
    pub colours: Vec<Vec4>,
    /// Per wedge: direction, and ±1 for the side of the bitangent; empty where the mesh has none.
    pub tangents: Vec<Vec4>,
    /// Per wedge; empty where the mesh has none.
    pub skins: Vec<Skin>,
    /// Wedges, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Runs of triangles by material or OBJ group, covering all triangles in order.
    pub groups: Vec<Group>,
}

/// The joints that move a wedge, and how much each does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Skin {
    /// Indices into the skeleton's joints.
    pub joints: [u16; 4],
    /// ≥ 0, with a sum of 1; 0 for joints that are not used.
    pub weights: [f32; 4],
}

/// A run of triangles of one material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// As the file has it; may be empty.
    pub name: String,
    /// The material's name.
    pub material: Option<String>,
    /// Indices into [`Mesh::triangles`].
    pub triangles: Range<usize>,
}

impl From<Surface> for Mesh {
    /// The mesh of a surface, without attributes: a wedge per position, all triangles one group.
    fn from(Surface { positions, triangles }: Surface) -> Self {
        let wedges = (0..positions.len() as u32).collect();
        let groups = vec![Group { triangles: 0..triangles.len(), ..Group::default() }];
        Self { positions, wedges, triangles, groups, ..Self::default() }
    }
}

impl Mesh {
    /// The geometry alone: triangles of positions, of which there are as many and in the same order.
    pub fn surface(&self) -> Surface {
        let corner = |wedge: u32| self.wedges[wedge as usize];
        let triangles = self.triangles.iter().map(|t| t.map(corner)).collect();
        Surface { positions: self.positions.clone(), triangles }
    }

    /// The smallest box around all positions, used or not.
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.positions.iter().copied())
    }

    /// Whether wedges have anything but a position.
    pub(super) fn has_attributes(&self) -> bool {
        let columns = [self.normals.len(), self.colours.len(), self.tangents.len(), self.skins.len()];
        columns.iter().any(|&rows| rows > 0) || !self.uvs.is_empty()
    }

    /// Whether neighbouring triangles can differ in anything but their positions.
    pub(super) fn has_seams(&self) -> bool {
        self.has_attributes() || self.groups.len() > 1
    }

    /// The positions of a triangle's corners, as indices.
    pub(super) fn corners(&self, triangle: usize) -> [u32; 3] {
        self.triangles[triangle].map(|wedge| self.wedges[wedge as usize])
    }

    /// Whether all indices point at something, all columns have a row per wedge, and the groups cover the triangles.
    ///
    /// # Errors
    /// The first rule that is broken, with the element that breaks it.
    pub fn check(&self) -> Result<(), String> {
        self.check_columns()?;
        check_indices("wedge", "position", &self.wedges, self.positions.len())?;
        check_indices("corner", "wedge", self.triangles.as_flattened(), self.wedges.len())?;
        let mut end = 0;
        for (i, group) in self.groups.iter().enumerate() {
            if group.triangles.start != end || group.triangles.end < end {
                return Err(format!("group {i} must start at triangle {end}, where the last one ends"));
            }
            end = group.triangles.end;
        }
        if end != self.triangles.len() {
            return Err(format!("the groups must cover {} triangles, not {end}", self.triangles.len()));
        }
        Ok(())
    }

    fn check_columns(&self) -> Result<(), String> {
        let uvs = self.uvs.iter().map(|set| ("uvs", Some(set.len())));
        let column = |name, rows: usize| (name, (rows > 0).then_some(rows));
        let others = [
            column("normals", self.normals.len()),
            column("colours", self.colours.len()),
            column("tangents", self.tangents.len()),
            column("skins", self.skins.len()),
        ];
        let mut wrong = uvs.chain(others).filter(|&(_, rows)| rows.is_some_and(|n| n != self.wedges.len()));
        match wrong.next() {
            Some((name, _)) => {
                Err(format!("{name} must have a row for each of {} wedges", self.wedges.len()))
            }
            None => Ok(()),
        }
    }

    /// A mesh of the same name and of the rows `kept` of every column, which are its wedges in that order. Without
    /// positions, triangles and groups.
    pub(super) fn rows(&self, kept: &[u32]) -> Self {
        Self {
            name: self.name.clone(),
            wedges: gather(&self.wedges, kept),
            normals: gather(&self.normals, kept),
            uvs: self.uvs.iter().map(|set| gather(set, kept)).collect(),
            colours: gather(&self.colours, kept),
            tangents: gather(&self.tangents, kept),
            skins: gather(&self.skins, kept),
            ..Self::default()
        }
    }

    /// Keeps, of every column, the rows of `kept`, which become the wedges in that order. Triangles are left alone.
    pub(super) fn keep_wedges(&mut self, kept: &[u32]) {
        *self = Self {
            positions: take(&mut self.positions),
            triangles: take(&mut self.triangles),
            groups: take(&mut self.groups),
            ..self.rows(kept)
        };
    }

    /// Keeps the triangles that `keep` says, and shortens the groups; those left without a triangle go.
    pub(super) fn retain_triangles(&mut self, keep: &[bool]) {
        let mut kept_before = vec![0; keep.len() + 1];
        for (i, &kept) in keep.iter().enumerate() {
            kept_before[i + 1] = kept_before[i] + usize::from(kept);
        }
        for group in &mut self.groups {
            group.triangles = kept_before[group.triangles.start]..kept_before[group.triangles.end];
        }
        self.groups.retain(|group| !group.triangles.is_empty());
        let mut kept = keep.iter();
        self.triangles.retain(|_| kept.next() == Some(&true));
    }
}

fn check_indices(what: &str, of: &str, indices: &[u32], count: usize) -> Result<(), String> {
    match indices.iter().position(|&i| i as usize >= count) {
        Some(at) => Err(format!("{what} {at} must be one of {count} {of}s, not {}", indices[at])),
        None => Ok(()),
    }
}

/// The rows of `kept`, in that order; an empty column stays empty.
pub(super) fn gather<T: Copy>(column: &[T], kept: &[u32]) -> Vec<T> {
    let rows = if column.is_empty() { &[] } else { kept };
    rows.iter().map(|&row| column[row as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE],
            wedges: vec![0, 1, 2, 3, 2],
            uvs: vec![vec![Vec2::ZERO; 5]],
            triangles: vec![[0, 1, 2], [4, 1, 3]],
            groups: vec![Group { triangles: 0..2, ..Group::default() }],
            ..Mesh::default()
        }
    }

    #[test]
    fn a_seam_is_no_border_of_the_surface() {
        let mesh = quad();
        assert_eq!(mesh.check(), Ok(()));
        assert_eq!(mesh.surface().triangles, [[0, 1, 2], [2, 1, 3]]);
    }

    #[test]
    fn what_points_nowhere_is_named() {
        let mut mesh = quad();
        mesh.triangles[1][2] = 5;
        assert_eq!(mesh.check(), Err("corner 5 must be one of 5 wedges, not 5".into()));
        let mut mesh = quad();
        mesh.wedges[3] = 9;
        assert_eq!(mesh.check(), Err("wedge 3 must be one of 4 positions, not 9".into()));
        let mut mesh = quad();
        mesh.normals = vec![Vec3::X];
        assert_eq!(mesh.check(), Err("normals must have a row for each of 5 wedges".into()));
        let mut mesh = quad();
        mesh.groups[0].triangles = 0..1;
        assert_eq!(mesh.check(), Err("the groups must cover 2 triangles, not 1".into()));
    }

    #[test]
    fn groups_shrink_with_their_triangles() {
        let mut mesh = quad();
        mesh.groups = vec![
            Group { name: "a".into(), triangles: 0..1, ..Group::default() },
            Group { name: "b".into(), triangles: 1..2, ..Group::default() },
        ];
        mesh.retain_triangles(&[false, true]);
        assert_eq!(mesh.triangles, [[4, 1, 3]]);
        assert_eq!((mesh.groups.len(), mesh.groups[0].name.as_str()), (1, "b"));
        assert_eq!(mesh.check(), Ok(()));
    }
}
