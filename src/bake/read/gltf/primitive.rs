//! Primitives, moved and put together into one mesh.

use ::gltf::json;
use ::gltf::json::mesh::{Mode, Semantic};
use ::gltf::json::validation::Checked;
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};

use super::Refused;
use super::accessor::Rows;
use super::document::Document;
use super::nodes::Placed;
use crate::bake::finding::{Defect, Findings};
use crate::bake::mesh::{Group, Mesh, Skin};
use crate::bake::read::{MeshFile, Origins, short_name};
use crate::bake::weld::{classes, weld};

/// How many sets of texture coordinates are read.
const UV_SETS: u32 = 8;

/// A file may have so many triangles however small it is.
const FREE_TRIANGLES: u64 = 1 << 20;

/// Names are kept once per group, and a mesh of a thousand groups may be shown a thousand times: so many bytes of them
/// count as a triangle. More would let names fill the memory, less would count those that people give.
const LETTERS_PER_TRIANGLE: usize = 64;

/// The mesh as far as it is put together.
pub(super) struct Assembly<'a> {
    document: &'a Document<'a>,
    mesh: Mesh,
    origins: Origins,
    findings: Findings,
    /// How many more triangles it may have. A primitive counts as one at least, so that empty ones do not go on for
    /// ever.
    left: u64,
}

/// How many triangles the file may be made into.
pub(super) fn triangle_limit(document: &Document<'_>) -> u64 {
    document.bytes.max(FREE_TRIANGLES).min(u64::from(u32::MAX / 3))
}

impl<'a> Assembly<'a> {
    /// `element` is what a triangle's origin counts: nodes or meshes.
    pub(super) fn new(document: &'a Document<'a>, name: String, element: &'static str, left: u64) -> Self {
        let origins = Origins { element, numbers: Vec::new() };
        Self {
            document,
            mesh: Mesh { name, ..Mesh::default() },
            origins,
            findings: Findings::default(),
            left,
        }
    }

    /// Adds all primitives of a mesh.
    pub(super) fn add(&mut self, placed: &Placed) -> Result<(), Refused> {
        let place = self.place(placed);
        let document = self.document;
        let mesh = document.meshes.get(placed.mesh);
        let mesh = mesh.ok_or_else(|| Refused::at(place.as_str(), "its mesh is unknown"))?;
        let space = Space::of(placed.world);
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let place = || format!("{place}, primitive {i}");
            let name = document.mesh_name(placed.mesh);
            let added = self.add_primitive(primitive, &space, &name, &place);
            added.map_err(|rule| Refused::at(place(), rule))?;
        }
        let number = placed.node.unwrap_or(placed.mesh);
        self.origins.numbers.resize(self.mesh.triangles.len(), number as u32);
        Ok(())
    }

    /// How many triangles are left for others.
    pub(super) fn left(&self) -> u64 {
        self.left
    }

    /// The mesh, welded.
    pub(super) fn into_file(mut self) -> MeshFile {
        weld(&mut self.mesh);
        MeshFile { mesh: self.mesh, origins: self.origins, findings: self.findings.0 }
    }

    fn place(&self, placed: &Placed) -> String {
        let name =
            |name: Option<&String>| name.map_or_else(String::new, |name| format!(" {:?}", short_name(name)));
        let mesh = name(self.document.meshes.get(placed.mesh).and_then(|m| m.name.as_ref()));
        let mesh = format!("mesh {}{mesh}", placed.mesh);
        let Some(node) = placed.node else { return mesh };
        format!("node {node}{}, {mesh}", name(self.document.nodes[node].name.as_ref()))
    }

    fn add_primitive(
        &mut self,
        primitive: &json::mesh::Primitive,
        space: &Space,
        name: &str,
        place: &dyn Fn() -> String,
    ) -> Result<(), String> {
        self.charge(1)?;
        let Checked::Valid(mode) = primitive.mode else {
            return Err("its mode must be one of 0 to 6".to_owned());
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.findings.add(Defect::Unread("primitives of points or lines"), place);
            return Ok(());
        }
        let attributes = Attributes::of(self.document, primitive)?;
        if attributes.has_more {
            self.findings
                .add(Defect::Unread("primitives with further sets of attributes or morph targets"), place);
        }
        let indices = self.indices(primitive, mode, attributes.positions.count)?;
        let used = classes(indices.iter().map(|&index| [index, 0, 0]));
        let vertices: Vec<usize> =
            used.firsts.iter().map(|&first| indices[first as usize] as usize).collect();
        let first_wedge = self.mesh.wedges.len() as u32;
        self.add_vertices(&attributes, space, &vertices);
        let start = self.mesh.triangles.len();
        let wedge = |corner: usize| first_wedge + used.of[corner];
        for [a, b, c] in triangles(mode, indices.len()) {
            let [b, c] = if space.mirrors { [c, b] } else { [b, c] };
            self.mesh.triangles.push([a, b, c].map(wedge));
        }
        let material = primitive.material.map(|material| self.document.material(material.value()));
        let letters = name.len() + material.as_ref().map_or(0, String::len);
        self.charge((letters / LETTERS_PER_TRIANGLE) as u64)?;
        let triangles = start..self.mesh.triangles.len();
        self.mesh.groups.push(Group { name: name.to_owned(), material, triangles });
        Ok(())
    }

    fn charge(&mut self, triangles: u64) -> Result<(), String> {
        let left = self.left.checked_sub(triangles);
        self.left = left.ok_or("with it there are more triangles or names than the file has bytes")?;
        Ok(())
    }

    /// The vertex of every corner, all known to be there, unless they make too many triangles.
    fn indices(
        &mut self,
        primitive: &json::mesh::Primitive,
        mode: Mode,
        vertices: usize,
    ) -> Result<Vec<u32>, String> {
        let rows = primitive.indices.map(|i| Rows::of(self.document, i.value(), &[1])).transpose()?;
        let count = rows.as_ref().map_or(vertices, |rows| rows.count);
        let new = if mode == Mode::Triangles { count / 3 } else { count.saturating_sub(2) };
        self.charge(new.saturating_sub(1) as u64)?;
        let corners = if mode == Mode::Triangles {
            new * 3
        } else if new == 0 {
            0
        } else {
            count
        };
        let index = |corner: usize| rows.as_ref().map_or(corner as f64, |rows| rows.row(corner)[0]);
        let checked = |corner: usize| match index(corner) {
            index if index >= 0.0 && index < vertices as f64 => Ok(index as u32),
            index => Err(format!("its index {corner} must be one of {vertices} vertices, not {index}")),
        };
        (0..corners).map(checked).collect()
    }

    /// A wedge for each of these vertices; columns that are new start with neutral rows for the wedges before. No
    /// vertices bring no column: one without rows would be taken for one that nobody has.
    fn add_vertices(&mut self, attributes: &Attributes<'_>, space: &Space, vertices: &[usize]) {
        if vertices.is_empty() {
            return;
        }
        let mesh = &mut self.mesh;
        let before = mesh.wedges.len();
        let after = before + vertices.len();
        mesh.wedges.extend(before as u32..after as u32);
        mesh.positions.extend(vertices.iter().map(|&v| space.point(attributes.positions.row(v))));
        if mesh.uvs.len() < attributes.uvs.len() {
            mesh.uvs.resize(attributes.uvs.len(), vec![Vec2::ZERO; before]);
        }
        let row = |rows: &Rows<'_>, v: usize| rows.floats(v);
        append(
            &mut mesh.normals,
            before,
            after,
            Vec3::ZERO,
            attributes.normals.as_ref().map(|rows| vertices.iter().map(|&v| space.normal(row(rows, v)))),
        );
        append(
            &mut mesh.tangents,
            before,
            after,
            Vec4::ZERO,
            attributes.tangents.as_ref().map(|rows| vertices.iter().map(|&v| space.tangent(row(rows, v)))),
        );
        append(
            &mut mesh.colours,
            before,
            after,
            Vec4::ONE,
            attributes.colours.as_ref().map(|(rows, opaque)| {
                let alpha = |c: Vec4| if *opaque { c.truncate().extend(1.0) } else { c };
                vertices.iter().map(move |&v| alpha(Vec4::from(row(rows, v))))
            }),
        );
        append(
            &mut mesh.skins,
            before,
            after,
            Skin::default(),
            attributes.skin.as_ref().map(|(joints, weights)| {
                let joint = |part: f64| part as u16;
                vertices
                    .iter()
                    .map(move |&v| Skin { joints: joints.row(v).map(joint), weights: row(weights, v) })
            }),
        );
        for (i, set) in mesh.uvs.iter_mut().enumerate() {
            append(
                set,
                before,
                after,
                Vec2::ZERO,
                attributes
                    .uvs
                    .get(i)
                    .map(|rows| vertices.iter().map(|&v| Vec2::new(row(rows, v)[0], row(rows, v)[1]))),
            );
        }
    }
}

/// Adds rows to a column, or neutral ones where there are none; a column that nobody has stays empty.
fn append<T: Clone>(
    column: &mut Vec<T>,
    before: usize,
    after: usize,
    neutral: T,
    rows: Option<impl Iterator<Item = T>>,
) {
    match rows {
        Some(rows) => {
            column.resize(before, neutral);
            column.extend(rows);
        }
        None if column.is_empty() => {}
        None => column.resize(after, neutral),
    }
}

/// The corners of each triangle, by their place in the list of indices.
fn triangles(mode: Mode, corners: usize) -> impl Iterator<Item = [usize; 3]> {
    let count = if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) };
    (0..count).map(move |i| match mode {
        Mode::TriangleStrip if i % 2 == 1 => [i, i + 2, i + 1],
        Mode::TriangleStrip => [i, i + 1, i + 2],
        Mode::TriangleFan => [i + 1, i + 2, 0],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    })
}

/// The accessors of a primitive.
struct Attributes<'a> {
    positions: Rows<'a>,
    normals: Option<Rows<'a>>,
    tangents: Option<Rows<'a>>,
    uvs: Vec<Rows<'a>>,
    /// With whether the alpha is missing.
    colours: Option<(Rows<'a>, bool)>,
    skin: Option<(Rows<'a>, Rows<'a>)>,
    /// Whether there is more than is read.
    has_more: bool,
}

impl<'a> Attributes<'a> {
    fn of(document: &'a Document<'_>, primitive: &json::mesh::Primitive) -> Result<Self, String> {
        let index = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|i| i.value());
        let positions = index(Semantic::Positions).ok_or("it must have a POSITION")?;
        let positions = Rows::of(document, positions, &[3])?;
        let column = |semantic, parts: &[usize]| {
            let rows = index(semantic).map(|i| Rows::of(document, i, parts)).transpose()?;
            match rows {
                Some(rows) if rows.count < positions.count => {
                    Err(format!("its attributes must have {} rows, not {}", positions.count, rows.count))
                }
                rows => Ok(rows),
            }
        };
        let opaque =
            column(Semantic::Colors(0), &[3, 4])?.is_some() && column(Semantic::Colors(0), &[4]).is_err();
        let uvs = (0..UV_SETS).map_while(|set| column(Semantic::TexCoords(set), &[2]).transpose());
        let uvs = uvs.collect::<Result<Vec<_>, _>>()?;
        let skin = column(Semantic::Joints(0), &[4])?.zip(column(Semantic::Weights(0), &[4])?);
        let normals = column(Semantic::Normals, &[3])?;
        let tangents = column(Semantic::Tangents, &[4])?;
        let colours = column(Semantic::Colors(0), &[3, 4])?.map(|rows| (rows, opaque));
        let further = [Semantic::Joints(1), Semantic::Colors(1), Semantic::TexCoords(UV_SETS)];
        let has_more = further.into_iter().any(|s| index(s).is_some())
            || primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty());
        Ok(Self { positions, normals, tangents, uvs, colours, skin, has_more })
    }
}

/// From a mesh's own units to the scene's.
struct Space {
    points: DMat4,
    /// Turns normals the way their surfaces turn; they are to be normalised.
    normals: DMat3,
    mirrors: bool,
    is_identity: bool,
}

impl Space {
    fn of(points: DMat4) -> Self {
        let [x, y, z] = [points.x_axis, points.y_axis, points.z_axis].map(|axis| axis.truncate());
        let mirrors = x.cross(y).dot(z) < 0.0;
        // The matrix of cofactors is the inverse transposed, as far as directions go, and is there for flat ones too.
        let sign = if mirrors { -1.0 } else { 1.0 };
        let normals = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
        Self { points, normals, mirrors, is_identity: points == DMat4::IDENTITY }
    }

    fn point(&self, [x, y, z, _]: [f64; 4]) -> Vec3 {
        let p = DVec3::new(x, y, z);
        if self.is_identity { p.as_vec3() } else { self.points.transform_point3(p).as_vec3() }
    }

    fn normal(&self, [x, y, z, _]: [f32; 4]) -> Vec3 {
        let n = Vec3::new(x, y, z);
        if self.is_identity { n } else { (self.normals * n.as_dvec3()).normalize_or_zero().as_vec3() }
    }

    fn tangent(&self, tangent: [f32; 4]) -> Vec4 {
        let t = Vec4::from(tangent);
        if self.is_identity {
            return t;
        }
        let along = self.points.transform_vector3(t.truncate().as_dvec3()).normalize_or_zero();
        along.as_vec3().extend(if self.mirrors { -t.w } else { t.w })
    }
}
