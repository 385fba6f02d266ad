//! The attributes of a wedge as words: the bits of its numbers in a row.

use glam::{Vec2, Vec3, Vec4};

use crate::bake::{Mesh, Skin};

/// Words of a skin: joints two by two, then weights.
const SKIN_WORDS: usize = 6;

/// Which attributes the wedges of a mesh have. A row has them in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Columns {
    pub(super) normals: bool,
    /// Sets of texture coordinates.
    pub(super) uvs: usize,
    pub(super) colours: bool,
    pub(super) tangents: bool,
    pub(super) skins: bool,
}

impl Columns {
    pub(super) fn of(mesh: &Mesh) -> Self {
        Self {
            normals: !mesh.normals.is_empty(),
            uvs: mesh.uvs.len(),
            colours: !mesh.colours.is_empty(),
            tangents: !mesh.tangents.is_empty(),
            skins: !mesh.skins.is_empty(),
        }
    }

    /// Words per wedge.
    pub(super) fn width(&self) -> usize {
        let column = |is_there: bool, words: usize| if is_there { words } else { 0 };
        let vectors = column(self.normals, 3) + column(self.colours, 4) + column(self.tangents, 4);
        vectors + 2 * self.uvs + column(self.skins, SKIN_WORDS)
    }

    /// Appends the row of a wedge.
    pub(super) fn read(&self, mesh: &Mesh, wedge: usize, row: &mut Vec<u32>) {
        let uvs = mesh.uvs.iter().flat_map(|set| set[wedge].to_array());
        row.extend(mesh.normals.get(wedge).iter().flat_map(|n| n.to_array()).map(f32::to_bits));
        row.extend(uvs.map(f32::to_bits));
        row.extend(mesh.colours.get(wedge).iter().flat_map(|c| c.to_array()).map(f32::to_bits));
        self.read_rest(mesh, wedge, row);
    }

    /// Appends what simplification takes from one wedge as it is: the tangent and the skin.
    pub(super) fn read_rest(&self, mesh: &Mesh, wedge: usize, row: &mut Vec<u32>) {
        row.extend(mesh.tangents.get(wedge).iter().flat_map(|t| t.to_array()).map(f32::to_bits));
        if let Some(Skin { joints: [a, b, c, d], weights }) = mesh.skins.get(wedge) {
            let pair = |low: u16, high: u16| u32::from(high) << 16 | u32::from(low);
            row.extend([pair(*a, *b), pair(*c, *d)]);
            row.extend(weights.map(f32::to_bits));
        }
    }

    /// Gives a mesh the columns of some rows.
    pub(super) fn write(&self, rows: &[u32], mesh: &mut Mesh) {
        let mut at = 0;
        if self.normals {
            mesh.normals = self.column(rows, at, Vec3::from_array);
            at += 3;
        }
        mesh.uvs = (0..self.uvs).map(|set| self.column(rows, at + 2 * set, Vec2::from_array)).collect();
        at += 2 * self.uvs;
        if self.colours {
            mesh.colours = self.column(rows, at, Vec4::from_array);
            at += 4;
        }
        if self.tangents {
            mesh.tangents = self.column(rows, at, Vec4::from_array);
            at += 4;
        }
        if self.skins {
            mesh.skins = rows.chunks_exact(self.width()).map(|row| skin(&row[at..])).collect();
        }
    }

    fn column<T, const N: usize>(&self, rows: &[u32], at: usize, value: impl Fn([f32; N]) -> T) -> Vec<T> {
        let of = |row: &[u32]| value(std::array::from_fn(|i| f32::from_bits(row[at + i])));
        rows.chunks_exact(self.width()).map(of).collect()
    }
}

fn skin(words: &[u32]) -> Skin {
    let half = |i: usize| (words[i / 2] >> (16 * (i % 2))) as u16;
    Skin { joints: std::array::from_fn(half), weights: std::array::from_fn(|i| f32::from_bits(words[2 + i])) }
}
