//! Stanford PLY, text and binary of both byte orders (Turk, *The PLY polygon file format*, 1994).
//!
//! Properties may come in any order and may be of any type; those that nobody here knows are passed over, as are
//! elements other than `vertex` and `face`. Known are `x y z`, `nx ny nz`, texture coordinates (`s t`, `u v`,
//! `texture_u texture_v`), `red green blue alpha` (with `diffuse_` before them as well; integers are divided by their
//! greatest), and of faces `vertex_indices` or `vertex_index`, and `texcoord`, two numbers per corner, which stands
//! above those of the vertices. Triangle strips are refused. Text has an element a line.
//!
//! An own reader rather than the `ply-rs` crate: that holds every element as a map from names to values, many times the
//! file's size, and names the line of some errors only.

mod body;
mod header;

use glam::{Vec2, Vec3};

use self::body::Body;
use self::header::{Element, Header, Kind, Property};
use super::polygons::{Corner, NONE, Polygons, colour};
use super::text::decoded;
use super::{MeshError, MeshFile, Refused, stem};
use crate::bake::finding::Defect;

/// Reads PLY; `file` names it in errors.
///
/// # Errors
/// A malformed header, an element that is cut off, a vertex without `x y z`, an index that points at no vertex,
/// triangle strips: with the line, or for binary files the element and its number from 0 on.
pub fn read(bytes: &[u8], file: &str) -> Result<MeshFile, MeshError> {
    read_polygons(&decoded(bytes))
        .and_then(|p| p.into_file(stem(file)))
        .map_err(|refused| refused.within(file))
}

fn read_polygons(bytes: &[u8]) -> Result<Polygons, Refused> {
    let (header, mut body) = Header::read(bytes)?;
    let mut polygons = Polygons::new(body.element());
    let corner_uvs = header.elements.iter().any(|e| e.name == b"face" && e.has(b"texcoord"));
    let vertices = header.elements.iter().find(|e| e.name == b"vertex");
    let vertices = vertices.ok_or_else(|| Refused::whole("its header must have an element vertex"))?;
    let columns = Columns::of(vertices, !corner_uvs)?;
    for element in &header.elements {
        match element.name.as_slice() {
            b"vertex" => read_vertices(element, &mut body, &mut polygons, !corner_uvs)?,
            b"face" => read_faces(element, &mut body, &mut polygons, &columns)?,
            b"tristrips" => return Err(Refused::whole("triangle strips are not read, only faces are")),
            _ => pass_over(element, &mut body)?,
        }
    }
    let extra = body.extra();
    if let Some(line) = extra {
        polygons.findings.add(Defect::Unread("values behind the last property"), || format!("line {line}"));
    }
    Ok(polygons)
}

fn pass_over(element: &Element, body: &mut Body<'_>) -> Result<(), Refused> {
    body.each(element, |values, _| element.properties.iter().try_for_each(|p| values.property(p, |_| ())))
}

/// What a vertex may have, each a slot for a number.
const SLOTS: [&[&[u8]]; 12] = [
    &[b"x"],
    &[b"y"],
    &[b"z"],
    &[b"nx"],
    &[b"ny"],
    &[b"nz"],
    &[b"s", b"u", b"texture_u"],
    &[b"t", b"v", b"texture_v"],
    &[b"red", b"diffuse_red", b"r"],
    &[b"green", b"diffuse_green", b"g"],
    &[b"blue", b"diffuse_blue", b"b"],
    &[b"alpha", b"diffuse_alpha", b"a"],
];

/// Which slots the properties of a vertex fill, and which groups of slots are full.
struct Columns {
    slots: Vec<Option<usize>>,
    has_normal: bool,
    has_uv: bool,
    has_colour: bool,
    has_alpha: bool,
}

impl Columns {
    fn of(element: &Element, uvs_wanted: bool) -> Result<Self, Refused> {
        let slot = |p: &Property| {
            let known = SLOTS.iter().position(|names| names.contains(&p.name.as_slice()));
            known.filter(|_| p.count.is_none())
        };
        let slots: Vec<Option<usize>> = element.properties.iter().map(slot).collect();
        let has = |range: std::ops::Range<usize>| range.into_iter().all(|s| slots.contains(&Some(s)));
        if !has(0..3) {
            return Err(Refused::line(element.line, "a vertex must have the properties x, y and z"));
        }
        let (has_normal, has_uv, has_colour, has_alpha) =
            (has(3..6), uvs_wanted && has(6..8), has(8..11), has(11..12));
        Ok(Self { slots, has_normal, has_uv, has_colour, has_alpha })
    }
}

fn read_vertices(
    element: &Element,
    body: &mut Body<'_>,
    polygons: &mut Polygons,
    uvs_wanted: bool,
) -> Result<(), Refused> {
    let columns = Columns::of(element, uvs_wanted)?;
    body.each(element, |values, _| {
        let mut row = [0.0; SLOTS.len()];
        row[11] = 1.0;
        for (property, slot) in element.properties.iter().zip(&columns.slots) {
            values.property(property, |value| {
                if let Some(slot) = *slot {
                    row[slot] = if slot < 8 { value } else { value * property.kind.unit() };
                }
            })?;
        }
        add_vertex(row.map(|x| x as f32), &columns, polygons);
        Ok(())
    })
}

fn add_vertex(row: [f32; SLOTS.len()], columns: &Columns, polygons: &mut Polygons) {
    let [x, y, z, nx, ny, nz, u, v, ..] = row;
    polygons.positions.push(Vec3::new(x, y, z));
    if columns.has_normal {
        polygons.normals.push(Vec3::new(nx, ny, nz));
    }
    if columns.has_uv {
        polygons.uvs.push(Vec2::new(u, v));
    }
    if columns.has_colour {
        polygons.colours.extend(colour(&row[8..if columns.has_alpha { 12 } else { 11 }]));
    }
}

fn read_faces(
    element: &Element,
    body: &mut Body<'_>,
    polygons: &mut Polygons,
    columns: &Columns,
) -> Result<(), Refused> {
    let (mut corners, mut uvs) = (Vec::new(), Vec::new());
    body.each(element, |values, number| {
        corners.clear();
        uvs.clear();
        for property in &element.properties {
            match property.name.as_slice() {
                b"vertex_indices" | b"vertex_index" if property.count.is_some() => {
                    values.property(property, |value| corners.push(value))?;
                }
                b"texcoord" if property.count.is_some() => {
                    values.property(property, |value| uvs.push(value as f32))?;
                }
                _ => values.property(property, |_| ())?,
            }
        }
        for (i, &corner) in corners.iter().enumerate() {
            let mut corner = corner_of(corner, columns)?;
            if let Some(&[u, v]) = uvs.get(2 * i..2 * i + 2) {
                corner.uv = polygons.uvs.len() as u32;
                polygons.uvs.push(Vec2::new(u, v));
            }
            polygons.add_corner(corner);
        }
        polygons.end_face(number).map_err(|refused| refused.rule)
    })
}

/// The corner, which has the attributes of its vertex. An index beyond the end is told later.
fn corner_of(index: f64, columns: &Columns) -> Result<Corner, String> {
    if index.fract() != 0.0 || !(0.0..f64::from(NONE)).contains(&index) {
        return Err(format!("a corner must be the index of a vertex, not {index}"));
    }
    let position = index as u32;
    let or_none = |has: bool| if has { position } else { NONE };
    Ok(Corner { position, uv: or_none(columns.has_uv), normal: or_none(columns.has_normal) })
}

impl Kind {
    /// What a step is worth in a colour: integers go up to their greatest.
    fn unit(self) -> f64 {
        match self {
            Kind::I8 => 1.0 / 127.0,
            Kind::U8 => 1.0 / 255.0,
            Kind::I16 => 1.0 / 32767.0,
            Kind::U16 => 1.0 / 65535.0,
            Kind::I32 => 1.0 / 2147483647.0,
            Kind::U32 => 1.0 / 4294967295.0,
            Kind::F32 | Kind::F64 => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    fn read_bytes(bytes: &[u8]) -> MeshFile {
        let file = read(bytes, "a.ply").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(file.mesh.check(), Ok(()));
        file
    }

    fn refusal(bytes: &[u8]) -> String {
        read(bytes, "a.ply").expect_err("refused").to_string()
    }

    fn square(header: &str, body: &str) -> String {
        format!("ply\nformat ascii 1.0\n{header}end_header\n{body}")
    }

    const PLAIN: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                         element face 1\nproperty list uchar int vertex_indices\n";
    const CORNERS: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

    #[test]
    fn text_is_read_line_by_line() {
        let file = read_bytes(square(PLAIN, &format!("{CORNERS}\n4 0 1 2 3")).as_bytes());
        assert_eq!(file.mesh.surface().triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(file.origins.place(0), "line 15");
    }

    #[test]
    fn properties_come_in_any_order_and_number() {
        let header = "comment made by hand\nobj_info x\nelement thing 2\nproperty list uchar short many\n\
                      element vertex 3\nproperty uchar green\nproperty double z\nproperty float s\nproperty int16 id\n\
                      property float t\nproperty float32 x\nproperty uchar red\nproperty float y\nproperty uchar blue\n\
                      element face 1\nproperty uchar red\nproperty list uchar uint vertex_index\nproperty float w\n";
        let body =
            "2 7 7\n0\n0 0 .25 1 .5 0 255 0 0\n255 0 0 2 0 1 0 0 0\n0 0 0 3 0 0 0 1 255\n9 3 0 1 2 0.5\n";
        let mesh = read_bytes(square(header, body).as_bytes()).mesh;
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert_eq!(
            mesh.colours,
            [Vec4::new(1., 0., 0., 1.), Vec4::new(0., 1., 0., 1.), Vec4::new(0., 0., 1., 1.)]
        );
        assert_eq!(mesh.uvs[0][0], Vec2::new(0.25, 0.5));
    }

    #[test]
    fn corners_may_have_texture_coordinates_of_their_own() {
        let header = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n\
                      element face 2\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\n";
        let body = "0 0 0 9 9\n1 0 0 9 9\n0 1 0 9 9\n6 0 0 1 0 0 1 3 0 1 2\n6 5 5 1 0 0 1 3 0 1 2\n";
        let mesh = read_bytes(square(header, body).as_bytes()).mesh;
        assert_eq!((mesh.positions.len(), mesh.wedges.len()), (3, 4));
        assert_eq!(mesh.uvs[0], [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::splat(5.0)]);
    }

    fn binary(order: &str, number: impl Fn(f32) -> [u8; 4], index: impl Fn(i32) -> [u8; 4]) -> Vec<u8> {
        let header = PLAIN.replace("vertex 4\n", "vertex 3\nproperty uchar flags\n");
        let mut bytes = format!("ply\nformat {order} 1.0\n{header}end_header\n").into_bytes();
        for corner in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 2.0]] {
            bytes.push(10);
            bytes.extend(corner.into_iter().flat_map(&number));
        }
        bytes.push(3);
        bytes.extend([0, 1, 2].into_iter().flat_map(index));
        bytes
    }

    #[test]
    fn both_byte_orders_are_read() {
        let little = binary("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes);
        let big = binary("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes);
        for bytes in [&little, &big] {
            let mesh = read_bytes(bytes).mesh;
            assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 2.0)]);
            assert_eq!(mesh.triangles.len(), 1);
        }
        assert_eq!(refusal(&little[..little.len() - 1]), "a.ply: face 0: it is cut off: its header says 1");
        assert_eq!(
            refusal(&little[..little.len() - 20]),
            "a.ply: vertex 2: it is cut off: its header says 3"
        );
    }

    #[test]
    fn counts_of_the_header_are_not_believed() {
        let huge = "element nothing 18446744073709551615\nelement vertex 18446744073709551615\n";
        let header = PLAIN.replace("element vertex 4\n", huge);
        let rule = refusal(square(&header, CORNERS).as_bytes());
        assert_eq!(rule, "a.ply: line 15: it is cut off: vertex 4 of 18446744073709551615 must be here");
        let list = square(PLAIN, &format!("{CORNERS}4000000000 0 1 2"));
        assert_eq!(
            refusal(list.as_bytes()),
            "a.ply: line 14: it must have another value for 'vertex_indices'"
        );
    }

    #[test]
    fn headers_are_checked() {
        let refused = |text: &str| refusal(text.as_bytes());
        assert_eq!(refused("plyx\n"), "a.ply: line 1: it must start with 'ply'");
        assert_eq!(
            refused("ply\nelement vertex 3\n"),
            "a.ply: it must have a format before its elements and an end_header"
        );
        assert_eq!(
            refused("ply\nformat ascii 2.0\n"),
            "a.ply: line 2: its format must be ascii, binary_little_endian or binary_big_endian, of version 1.0"
        );
        assert!(
            refused(&square("element vertex x\n", ""))
                .contains("line 3: the number of elements must be a count")
        );
        assert!(
            refused(&square("property float x\n", ""))
                .contains("line 3: a property must belong to an element")
        );
        assert!(
            refused(&square("element vertex 1\nproperty quad x\n", ""))
                .contains("line 4: 'quad' must be a type")
        );
        assert!(
            refused(&square("element vertex 1\nproperty float x\n", "1"))
                .contains("line 3: a vertex must have")
        );
        assert!(refused(&square("element face 0\n", "")).contains("must have an element vertex"));
        assert!(refused(&square("frob\n", "")).contains("line 3: 'frob' must be"));
        let strips = PLAIN.replace("element face", "element tristrips");
        assert!(refused(&square(&strips, CORNERS)).contains("triangle strips are not read"));
    }

    #[test]
    fn values_are_checked() {
        let refused = |face: &str| refusal(square(PLAIN, &format!("{CORNERS}{face}")).as_bytes());
        assert_eq!(refused("3 0 1 4"), "a.ply: line 14: a corner must be one of 4 vertices, not number 5");
        assert_eq!(refused("3 0 1 -1"), "a.ply: line 14: a corner must be the index of a vertex, not -1");
        assert_eq!(refused("3 0 1 a"), "a.ply: line 14: 'a' must be a number");
        assert_eq!(
            refused("-3 0 1 2"),
            "a.ply: line 14: the length of 'vertex_indices' must be a count, not -3"
        );
        let lists = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty list uchar int vertex_indices\n";
        assert!(refusal(square(lists, "1 2 3").as_bytes()).contains("another value for 'vertex_indices'"));
    }

    #[test]
    fn values_too_many_are_reported() {
        let file = read_bytes(square(PLAIN, &format!("{CORNERS}3 0 1 2 9")).as_bytes());
        assert_eq!(file.findings[0].to_string(), "1 values behind the last property, passed over: line 14");
    }
}
