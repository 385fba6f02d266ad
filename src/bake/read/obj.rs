//! Wavefront OBJ (*Advanced Visualizer manual, appendix B1: object files*).
//!
//! Read are `v` (with a weight, which is passed over, or a colour behind it), `vt` (its first two numbers), `vn`, `f`
//! with any number of corners and with negative indices, `o`, `g` and `usemtl`. Material files are not opened: a
//! group has its material's name. A line that ends in `\` goes on in the next one; what follows `#` is a comment, but
//! not in names. Indices may point forward. A corner whose normal or texture coordinate is not there has none, which
//! is reported, as are faces of fewer than three corners and statements that make no triangles; a vertex that is not
//! there is refused.
//!
//! An own reader rather than the `tobj` crate: that names neither file nor line in its errors, reads UTF-8 alone, knows
//! no continued lines and cuts every polygon into a fan.

use std::borrow::Cow;

use glam::{Vec2, Vec3, Vec4};

use super::crease::{self, Crease};
use super::polygons::{Corner, NONE, Polygons, colour, name_of};
use super::text::{Line, Lines, decoded, integer, quoted};
use super::{MeshError, MeshFile, Refused, stem};
use crate::bake::finding::Defect;
use crate::bake::subdivide::ControlFile;

/// Reads OBJ; `file` names it in errors.
///
/// # Errors
/// A number that is none, a vertex of fewer than three, an index that points at no vertex: with the line.
pub fn read(bytes: &[u8], file: &str) -> Result<MeshFile, MeshError> {
    parsed(&decoded(bytes), Obj::new())
        .and_then(|obj| obj.polygons.into_file(stem(file)))
        .map_err(|refused| refused.within(file))
}

/// Reads the polygons of OBJ as they are, for subdivision; `file` names it in errors. Normals are left behind. Creases
/// are those of `t crease` and `t corner`, as OpenSubdiv's shapes have them: `t crease 2/1/0 A B SHARPNESS` for an edge,
/// `t corner 1/1/0 A SHARPNESS` for a vertex, vertices counted from 0.
///
/// # Errors
/// As [`read`]; a crease that is not as it should be.
pub fn read_control(bytes: &[u8], file: &str) -> Result<ControlFile, MeshError> {
    let obj = Obj { creases: Some(Vec::new()), ..Obj::new() };
    parsed(&decoded(bytes), obj)
        .and_then(|obj| obj.polygons.into_control(stem(file), &obj.creases.unwrap_or_default()))
        .map_err(|refused| refused.within(file))
}

fn parsed(text: &[u8], mut obj: Obj) -> Result<Obj, Refused> {
    let mut lines = Lines::of(text);
    while let Some(line) = lines.next() {
        match continued(line, &mut lines) {
            Cow::Borrowed(bytes) => obj.statement(Line { bytes, ..line })?,
            Cow::Owned(joined) => obj.statement(Line { number: line.number, bytes: &joined })?,
        }
    }
    Ok(obj)
}

/// The line, with those that it goes on in. Comments do not go on.
fn continued<'a>(line: Line<'a>, lines: &mut Lines<'a>) -> Cow<'a, [u8]> {
    let is_comment = line.bytes.trim_ascii_start().starts_with(b"#");
    let Some(start) = line.bytes.strip_suffix(b"\\").filter(|_| !is_comment) else {
        return Cow::Borrowed(line.bytes);
    };
    let mut joined = start.to_vec();
    for next in lines {
        joined.push(b' ');
        let end = next.bytes.strip_suffix(b"\\");
        joined.extend_from_slice(end.unwrap_or(next.bytes));
        if end.is_none() {
            break;
        }
    }
    Cow::Owned(joined)
}

struct Obj {
    polygons: Polygons,
    object: String,
    group: Option<String>,
    material: Option<String>,
    /// `None` where nobody wants them.
    creases: Option<Vec<Crease>>,
}

impl Obj {
    fn new() -> Self {
        Self {
            polygons: Polygons::new("line"),
            object: String::new(),
            group: None,
            material: None,
            creases: None,
        }
    }

    fn statement(&mut self, line: Line<'_>) -> Result<(), Refused> {
        let Some(keyword) = line.words().next() else { return Ok(()) };
        let name = || name_of(&line.bytes.trim_ascii_start()[keyword.len()..]);
        match keyword {
            b"v" => self.vertex(line)?,
            b"vt" => self.uv(line)?,
            b"vn" => self.normal(line)?,
            b"f" | b"fo" => self.face(line)?,
            b"o" => (self.object, self.group) = (name(), None),
            b"g" => self.group = Some(name()),
            b"usemtl" => self.material = Some(name()).filter(|name| !name.is_empty()),
            b"t" => self.tag(line)?,
            _ => self.pass_over(line, keyword),
        }
        if matches!(keyword, b"o" | b"g" | b"usemtl") {
            let name = self.group.as_deref().unwrap_or(&self.object);
            self.polygons.begin_group(name, self.material.as_deref());
        }
        Ok(())
    }

    fn tag(&mut self, line: Line<'_>) -> Result<(), Refused> {
        let crease = if self.creases.is_some() { crease::tag(line)? } else { None };
        match self.creases.as_mut().zip(crease) {
            Some((creases, crease)) => creases.push(crease),
            None => self.pass_over(line, b"t"),
        }
        Ok(())
    }

    fn pass_over(&mut self, line: Line<'_>, keyword: &[u8]) {
        let what = match keyword {
            [b'#', ..] | b"s" | b"mtllib" | b"lod" | b"usemap" | b"maplib" => return,
            b"l" => "lines",
            b"p" => "points",
            b"curv" | b"curv2" | b"surf" | b"vp" | b"cstype" | b"deg" | b"parm" | b"trim" | b"hole"
            | b"end" => "statements of curves and surfaces",
            _ => "unknown statements",
        };
        let place = || format!("line {} ({})", line.number, quoted(keyword));
        self.polygons.findings.add(Defect::Unread(what), place);
    }

    fn vertex(&mut self, line: Line<'_>) -> Result<(), Refused> {
        let (numbers, count) = numbers::<8>(line)?;
        let [x, y, z, rest @ ..] = numbers;
        if count < 3 {
            return Err(line.refused(format!("a vertex must have 3 coordinates, not {count}")));
        }
        // x y z, x y z w, x y z r g b, x y z r g b a, or x y z w r g b a.
        let colour = match count {
            6 | 7 => colour(&rest[..count - 3]),
            8 => colour(&rest[1..]),
            _ => None,
        };
        if let Some(colour) = colour {
            self.polygons.colours.resize(self.polygons.positions.len(), Vec4::ONE);
            self.polygons.colours.push(colour);
        }
        self.polygons.positions.push(Vec3::new(x, y, z));
        Ok(())
    }

    fn uv(&mut self, line: Line<'_>) -> Result<(), Refused> {
        let ([u, v, _], count) = numbers::<3>(line)?;
        if count == 0 {
            return Err(line.refused("a texture coordinate must have a number"));
        }
        self.polygons.uvs.push(Vec2::new(u, v));
        Ok(())
    }

    fn normal(&mut self, line: Line<'_>) -> Result<(), Refused> {
        let (numbers, count) = numbers::<3>(line)?;
        if count < 3 {
            return Err(line.refused(format!("a normal must have 3 numbers, not {count}")));
        }
        self.polygons.normals.push(Vec3::from(numbers));
        Ok(())
    }

    fn face(&mut self, line: Line<'_>) -> Result<(), Refused> {
        for word in values(line) {
            let corner = self.corner(line, word)?;
            self.polygons.add_corner(corner);
        }
        self.polygons.end_face(line.number)
    }

    /// `v`, `v/t`, `v//n` or `v/t/n`; `v/` and `v//` are taken as `v`.
    fn corner(&self, line: Line<'_>, word: &[u8]) -> Result<Corner, Refused> {
        let mut parts = word.split(|&b| b == b'/');
        let mut part = || parts.next().unwrap_or_default();
        let (position, uv, normal) = (part(), part(), part());
        if parts.next().is_some() {
            return Err(
                line.refused(format!("a corner must have at most three indices, unlike {}", quoted(word)))
            );
        }
        let index = |word: &[u8], count: usize| {
            self.index(word, count).map_err(|rule| line.refused(format!("{} {rule}", quoted(word))))
        };
        if position.is_empty() {
            return Err(line.refused(format!("a corner must name a vertex, unlike {}", quoted(word))));
        }
        Ok(Corner {
            position: index(position, self.polygons.positions.len())?,
            uv: if uv.is_empty() { NONE } else { index(uv, self.polygons.uvs.len())? },
            normal: if normal.is_empty() { NONE } else { index(normal, self.polygons.normals.len())? },
        })
    }

    /// From 1 on, or from −1 back. What points beyond the end is told later, when the end is known; what points before
    /// the start becomes an index that will be beyond any end.
    fn index(&self, word: &[u8], count: usize) -> Result<u32, &'static str> {
        let given: i64 = integer(word).ok_or("must be an index")?;
        let index = match given {
            0 => return Err("must be an index, counted from 1 or back from -1"),
            1.. => given - 1,
            _ if given.unsigned_abs() > count as u64 => return Err("must not point before the first"),
            _ => count as i64 + given,
        };
        Ok(u32::try_from(index).unwrap_or(NONE - 1).min(NONE - 1))
    }
}

/// The words behind the keyword, up to a comment.
fn values<'a>(line: Line<'a>) -> impl Iterator<Item = &'a [u8]> {
    line.words().skip(1).take_while(|word| !word.starts_with(b"#"))
}

/// The first `N` numbers of the statement, 0 where there are fewer, and how many there are. More are passed over.
fn numbers<const N: usize>(line: Line<'_>) -> Result<([f32; N], usize), Refused> {
    let (mut numbers, mut count) = ([0.0; N], 0);
    for (slot, word) in numbers.iter_mut().zip(values(line)) {
        *slot = line.number_of(word)?;
        count += 1;
    }
    Ok((numbers, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> MeshFile {
        let file = read(text.as_bytes(), "a.obj").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(file.mesh.check(), Ok(()));
        assert_eq!(file.origins.numbers.len(), file.mesh.triangles.len());
        file
    }

    fn refusal(text: &str) -> String {
        read(text.as_bytes(), "a.obj").expect_err("refused").to_string()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn polygons_become_triangles_that_know_their_line() {
        let file = read_text(&format!("{SQUARE}f 1 2 3 4"));
        assert_eq!(file.mesh.surface().triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!((file.origins.place(1).as_str(), file.mesh.name.as_str()), ("line 5", "a"));
    }

    #[test]
    fn negative_indices_count_back_from_the_line() {
        let file = read_text(&format!("{SQUARE}f -4 -3 -2\nv 5 5 5\nf -1 -2 -3"));
        assert_eq!(file.mesh.surface().triangles, [[0, 1, 2], [4, 3, 2]]);
        assert_eq!(refusal("v 0 0 0\nf -2 1 1"), "a.obj: line 2: '-2' must not point before the first");
    }

    #[test]
    fn indices_may_point_forward_but_not_out() {
        assert_eq!(read_text(&format!("f 1 2 3\n{SQUARE}")).mesh.triangles.len(), 1);
        let rule = refusal(&format!("{SQUARE}\n\nf 1 2 5"));
        assert_eq!(rule, "a.obj: line 7: a corner must be one of 4 vertices, not number 5");
        assert!(refusal("v 0 0 0\nf 1 2 99999999999").contains("line 2: a corner must be one of 1 vertices"));
        let zero = refusal("v 0 0 0\nf 0 1 1");
        assert!(zero.starts_with("a.obj: line 2: '0' must be an index"), "{zero}");
    }

    #[test]
    fn seams_are_wedges_and_not_positions() {
        let file = read_text(&format!(
            "{SQUARE}vt 0 0\nvt 1 1 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/2/1 3/1/1 4/1/1"
        ));
        assert_eq!((file.mesh.positions.len(), file.mesh.wedges.len()), (4, 5));
        assert_eq!(file.mesh.normals, [Vec3::Z; 5]);
        assert_eq!(file.mesh.uvs[0].iter().filter(|uv| **uv == Vec2::ONE).count(), 1);
    }

    #[test]
    fn attributes_that_are_not_there_are_none() {
        let file = read_text(&format!("{SQUARE}f 1//1 2/7/ 3//"));
        assert!(file.mesh.normals.is_empty() && file.mesh.uvs.is_empty());
        assert_eq!(
            file.findings[0].to_string(),
            "2 corners with an unknown normal or texture coordinate, taken as without: line 5 …"
        );
    }

    #[test]
    fn groups_cover_all_triangles() {
        let text = format!(
            "{SQUARE}f 1 2 3\no house\nusemtl red brick#2\nf 1 2 4\ng\tdoor f one\nf 2 3 4\nusemtl red brick#2\nf 1 3 4\no roof\n"
        );
        let mesh = read_text(&text).mesh;
        let groups: Vec<_> = mesh
            .groups
            .iter()
            .map(|g| (g.name.as_str(), g.material.as_deref(), g.triangles.clone()))
            .collect();
        let brick = Some("red brick#2");
        assert_eq!(groups, [("", None, 0..1), ("house", brick, 1..2), ("door f one", brick, 2..4)]);
    }

    #[test]
    fn colours_and_weights_behind_a_vertex_are_told_apart() {
        let mesh =
            read_text("v 0 0 0 1\nv 1 0 0 .5 0 1\nv 0 1 0\nv 0 0 1 1 0.25 0.25 0.25 0.5\nf 1 2 3 4\n").mesh;
        let colours = [Vec4::ONE, Vec4::new(0.5, 0.0, 1.0, 1.0), Vec4::ONE, Vec4::new(0.25, 0.25, 0.25, 0.5)];
        assert_eq!(mesh.colours, colours);
        assert!(read_text("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3").mesh.colours.is_empty());
    }

    #[test]
    fn lines_go_on_after_a_backslash() {
        let text = "# a comment \\\nv 0 0 \\\r\n 0\nv 1 0 0 # one\nv 0 1 0\\\n\nf 1 \\\n2 \\\n3";
        let file = read_text(text);
        assert_eq!((file.mesh.positions.len(), file.origins.place(0).as_str()), (3, "line 7"));
        assert_eq!(read_text("v 0 0 0\\").mesh.triangles.len(), 0);
    }

    #[test]
    fn short_faces_are_left_out_and_named() {
        let file = read_text(&format!("{SQUARE}f\nf 1// 2//\nf 1 2 3"));
        assert_eq!(file.mesh.triangles.len(), 1);
        assert_eq!(file.findings[0].to_string(), "2 faces of fewer than 3 corners, left out: line 5, line 6");
    }

    #[test]
    fn what_makes_no_triangle_is_reported() {
        let file =
            read_text(&format!("{SQUARE}s 1\nmtllib a.mtl\nl 1 2\np 1\ncurv 0 1 1 2\nfrob 3\nf 1 2 3\n"));
        let said: Vec<String> = file.findings.iter().map(ToString::to_string).collect();
        assert_eq!(said[0], "1 lines, passed over: line 7 ('l')");
        assert_eq!(said[3], "1 unknown statements, passed over: line 10 ('frob')");
        assert_eq!(said.len(), 4);
    }

    #[test]
    fn what_is_no_number_is_refused_with_its_line() {
        assert_eq!(refusal("v 0 0 0\n\nv 1 2 3.1+e2"), "a.obj: line 3: '3.1+e2' must be a number");
        assert_eq!(refusal("v 0 0"), "a.obj: line 1: a vertex must have 3 coordinates, not 2");
        assert_eq!(refusal("vn 0 0"), "a.obj: line 1: a normal must have 3 numbers, not 2");
        assert_eq!(refusal("vt"), "a.obj: line 1: a texture coordinate must have a number");
        assert_eq!(refusal("f a b c"), "a.obj: line 1: 'a' must be an index");
        assert!(refusal("f 1/2/3/4 1 1").contains("at most three indices"));
        assert!(refusal("f /1 /2 /3").contains("must name a vertex"));
    }

    #[test]
    fn wide_text_is_read() {
        let text = format!("{SQUARE}f 1 2 3 4");
        let bytes: Vec<u8> = [0xfe, 0xff].into_iter().chain(text.bytes().flat_map(|b| [0, b])).collect();
        assert_eq!(read(&bytes, "a.obj").expect("UTF-16").mesh.triangles.len(), 2);
    }
}
