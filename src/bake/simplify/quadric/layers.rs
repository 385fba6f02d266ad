//! All attributes of a mesh on their way through a simplification.

use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};

use super::form::Form;
use super::layer::{Around, Layer, Move};
use crate::bake::weld::classes;
use crate::bake::{Group, Mesh};
use crate::bounds::Aabb;

/// How much attributes count in the error of a contraction; 0 for one that goes along and does not count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attributes {
    /// A normal that is off by a radian counts as a distance of this share of the longest side of the mesh.
    pub normals: f32,
    /// A texture that slides over the surface by some distance counts as this share of the distance.
    pub uvs: f32,
    /// A colour that is off by 1 in one channel counts as a distance of this share of the longest side of the mesh.
    pub colours: f32,
}

impl Attributes {
    /// The shape alone counts: attributes go along, and seams are not held.
    pub const IGNORED: Self = Self { normals: 0.0, uvs: 0.0, colours: 0.0 };
}

impl Default for Attributes {
    /// A normal off by ten degrees, a texture shifted by ten thousandths of the mesh and a colour off by a twentieth count
    /// as much as a position off by two thousandths.
    fn default() -> Self {
        Self { normals: 0.01, uvs: 0.2, colours: 0.04 }
    }
}

/// The layers of a mesh: normals, then all sets of texture coordinates, then colours, those that it has.
pub(super) struct Layers<'a> {
    mesh: &'a Mesh,
    kinds: Vec<Kind>,
    layers: Vec<Layer>,
    /// Per triangle, its material or group, and the old triangle that it was.
    groups: Vec<u32>,
    old: Vec<u32>,
    /// Whether seams are held.
    holds_seams: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Normals,
    Uvs,
    Colours,
}

impl<'a> Layers<'a> {
    /// The layers of a mesh whose `old` triangles, and no others, are simplified. `unit` is the longest side of the mesh
    /// in the units of `places`.
    pub(super) fn new(mesh: &'a Mesh, old: &[u32], attributes: &Attributes, scale: f64) -> Self {
        let unit = extent(mesh) * scale;
        let has = |kind: &Kind| match kind {
            Kind::Normals => !mesh.normals.is_empty(),
            Kind::Uvs => !mesh.uvs.is_empty(),
            Kind::Colours => !mesh.colours.is_empty(),
        };
        let kinds: Vec<Kind> = [Kind::Normals, Kind::Uvs, Kind::Colours].into_iter().filter(has).collect();
        let weight = |kind: &Kind| match kind {
            Kind::Normals => f64::from(attributes.normals) * unit,
            Kind::Uvs => f64::from(attributes.uvs) * stretch(mesh, old) * scale,
            Kind::Colours => f64::from(attributes.colours) * unit,
        };
        let layers = kinds.iter().map(|kind| layer(mesh, old, *kind, weight(kind).powi(2))).collect();
        let holds_seams = *attributes != Attributes::IGNORED;
        Self { mesh, kinds, layers, groups: groups_of(mesh, old), old: old.to_vec(), holds_seams }
    }

    /// Adds up what the triangles say. `places` are scaled, areas weighted.
    pub(super) fn sum_up(&mut self, triangles: &[[u32; 3]], places: &[DVec3], weights: &[f64]) {
        self.layers.iter_mut().for_each(|layer| layer.sum_up(triangles, places, weights));
    }

    /// What attributes add to the error of both ends of an edge, seen from the first.
    pub(super) fn error(&self, around: Around, a: u32, b: u32, edge: DVec3) -> Form {
        let forms = self.layers.iter().map(|layer| layer.error(around, a, b, edge));
        forms.fold(Form::default(), |sum, form| sum + form)
    }

    /// Follows a contraction, before the triangles and fans do.
    pub(super) fn contract(&mut self, around: Around, step: &Move) {
        self.layers.iter_mut().for_each(|layer| layer.contract(around, step));
    }

    /// Whether seams are held at all.
    pub(super) fn holds_seams(&self) -> bool {
        self.holds_seams
    }

    /// Whether an edge of two triangles is a seam that is held: of materials, textures or colours. A seam of normals
    /// alone is a hard edge, which the shape holds already.
    pub(super) fn is_seam(&self, around: Around, edge: [u32; 2], sides: [usize; 2]) -> bool {
        let counts = |(kind, layer): &(&Kind, &Layer)| **kind != Kind::Normals && layer.counts();
        let mut held = self.kinds.iter().zip(&self.layers).filter(counts);
        self.groups[sides[0]] != self.groups[sides[1]]
            || held.any(|(_, layer)| layer.differs(around, edge, sides))
    }

    /// Per corner of some triangles, an old wedge that stands for all corners that look the same: one that was at the
    /// vertex's origin, if there is one.
    pub(super) fn looks(&self, around: Around, left: &[usize], origins: &[u32]) -> Vec<[u32; 3]> {
        let corners: Vec<(usize, usize)> = left.iter().flat_map(|&t| [(t, 0), (t, 1), (t, 2)]).collect();
        let wedge = |&(t, i): &(usize, usize)| self.mesh.triangles[self.old[t] as usize][i];
        let layer = |k: usize, (t, i): (usize, usize)| self.layers.get(k).map_or(0, |l| l.corner(t, i));
        let first = classes(corners.iter().map(|&c| [around.triangles[c.0][c.1], layer(0, c), layer(1, c)]));
        let side = |wedge: u32| self.mesh.tangents.get(wedge as usize).map_or(0, |t| u32::from(t.w < 0.0));
        let alike =
            classes(corners.iter().zip(&first.of).map(|(c, &class)| [class, layer(2, *c), side(wedge(c))]));
        let mut stands: Vec<u32> = alike.firsts.iter().map(|&c| wedge(&corners[c as usize])).collect();
        for (corner, &class) in corners.iter().zip(&alike.of).rev() {
            let origin = origins[around.triangles[corner.0][corner.1] as usize];
            if self.mesh.wedges[wedge(corner) as usize] == origin {
                stands[class as usize] = wedge(corner);
            }
        }
        alike.of.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|class| stands[class as usize])).collect()
    }

    /// The wedges, one in each layer, of a corner of a triangle.
    pub(super) fn look(&self, triangle: usize, corner: usize) -> [u32; 3] {
        std::array::from_fn(|k| self.layers.get(k).map_or(0, |layer| layer.corner(triangle, corner)))
    }

    /// The values of a look, as [`Layers::write`] has them.
    pub(super) fn finished(&self, look: [u32; 3]) -> impl Iterator<Item = f32> {
        let layers = self.kinds.iter().zip(&self.layers).zip(look);
        layers.flat_map(|((kind, layer), wedge)| kind.finished(layer.values(wedge)))
    }

    /// Gives wedges of what is left the values that were worked out. `corner_of` says for each a triangle and corner that
    /// has it.
    pub(super) fn write(&self, corner_of: &[(usize, usize)], mesh: &mut Mesh) {
        for (kind, layer) in self.kinds.iter().zip(&self.layers) {
            for (wedge, &(t, i)) in corner_of.iter().enumerate() {
                kind.write(layer.values(layer.corner(t, i)), wedge, mesh);
            }
        }
    }
}

impl Kind {
    /// How many values a wedge has.
    fn width(self, mesh: &Mesh) -> usize {
        match self {
            Self::Normals => 3,
            Self::Uvs => 2 * mesh.uvs.len(),
            Self::Colours => 4,
        }
    }

    /// The values of a wedge, in a row.
    fn read(self, mesh: &Mesh, wedge: usize) -> Vec<f32> {
        match self {
            Self::Normals => mesh.normals[wedge].to_array().to_vec(),
            Self::Uvs => mesh.uvs.iter().flat_map(|set| set[wedge].to_array()).collect(),
            Self::Colours => mesh.colours[wedge].to_array().to_vec(),
        }
    }

    /// Sets the values of a wedge.
    fn write(self, values: &[f32], wedge: usize, mesh: &mut Mesh) {
        let values = self.finished(values);
        match self {
            Self::Normals => mesh.normals[wedge] = Vec3::from_slice(&values),
            Self::Uvs => {
                for (set, uv) in mesh.uvs.iter_mut().zip(values.chunks_exact(2)) {
                    set[wedge] = Vec2::from_slice(uv);
                }
            }
            Self::Colours => mesh.colours[wedge] = Vec4::from_slice(&values),
        }
    }

    /// The values of a wedge, normals with a length of 1 and colours as colours can be.
    fn finished(self, values: &[f32]) -> Vec<f32> {
        match self {
            Self::Normals => {
                let normal = Vec3::from_slice(values);
                let is_unit = (normal.length_squared() - 1.0).abs() < 1e-5;
                if is_unit { normal } else { normal.normalize_or_zero() }.to_array().to_vec()
            }
            Self::Uvs => values.to_vec(),
            Self::Colours => Vec4::from_slice(values).clamp(Vec4::ZERO, Vec4::ONE).to_array().to_vec(),
        }
    }
}

/// The layer of one kind of attribute: wedges of one position and the same values are one.
fn layer(mesh: &Mesh, old: &[u32], kind: Kind, weight: f64) -> Layer {
    let width = kind.width(mesh);
    let rows: Vec<f32> = (0..mesh.wedges.len()).flat_map(|wedge| kind.read(mesh, wedge)).collect();
    let mut alike = classes(mesh.wedges.iter().map(|&position| [position, 0, 0]));
    for i in (0..width).step_by(2) {
        let bits =
            |wedge: usize, i: usize| if i < width { (rows[wedge * width + i] + 0.0).to_bits() } else { 0 };
        let keys = alike.of.iter().enumerate().map(|(w, &class)| [class, bits(w, i), bits(w, i + 1)]);
        alike = classes(keys);
    }
    let corners = old.iter().map(|&t| mesh.triangles[t as usize].map(|w| alike.of[w as usize])).collect();
    let values = alike.firsts.iter().flat_map(|&w| &rows[w as usize * width..][..width]).copied();
    Layer::new(width, weight, corners, values.collect())
}

/// The longest side of the box around what triangles use, in object units.
fn extent(mesh: &Mesh) -> f64 {
    let corners = (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t));
    let bounds = Aabb::around(corners.map(|v| mesh.positions[v as usize]));
    (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element().max(0.0)
}

/// How many object units a unit of texture coordinates covers on average; 0 where textures cover nothing.
fn stretch(mesh: &Mesh, old: &[u32]) -> f64 {
    let (mut surface, mut texture) = (0.0, 0.0);
    for &triangle in old {
        let [a, b, c] = mesh.corners(triangle as usize).map(|v| mesh.positions[v as usize].as_dvec3());
        surface += (b - a).cross(c - a).length();
        let [a, b, c]: [DVec2; 3] =
            mesh.triangles[triangle as usize].map(|w| mesh.uvs[0][w as usize].as_dvec2());
        texture += (b - a).perp_dot(c - a).abs();
    }
    let stretch = (surface / texture).sqrt();
    if stretch.is_finite() { stretch } else { 0.0 }
}

/// Per old triangle of a list, the number of its material, or of its group where it has none.
fn groups_of(mesh: &Mesh, old: &[u32]) -> Vec<u32> {
    let same = |a: &Group, b: &Group| a.material == b.material && (a.material.is_some() || a.name == b.name);
    let first = |group: &Group| mesh.groups.iter().position(|g| same(g, group)).unwrap_or_default() as u32;
    let mut of_triangle = vec![0; mesh.triangles.len()];
    for group in &mesh.groups {
        of_triangle[group.triangles.clone()].fill(first(group));
    }
    old.iter().map(|&t| of_triangle[t as usize]).collect()
}
