//! Geomview OFF, text (*Geomview manual*, Object File Format).
//!
//! A vertex a line and a face a line; `#` starts a comment. The letters before `OFF` say what follows a vertex's
//! position: `N` a normal, `C` a colour of three or four numbers (in 255ths where any is above 1), `ST` a texture
//! coordinate. Colours of faces are passed over. The number of edges may be missing and says nothing. Refused are
//! binary files and those of other dimensions (`4OFF`, `nOFF`).

use glam::{Vec2, Vec3, Vec4};

use super::polygons::{Corner, NONE, Polygons, colour, must_be};
use super::text::{Line, Lines, decoded, integer, quoted};
use super::{MeshError, MeshFile, Refused, stem};

/// Reads OFF; `file` names it in errors.
///
/// # Errors
/// A missing header, fewer vertices or faces than it says, what is no number, an index that points at no vertex: with
/// the line.
pub fn read(bytes: &[u8], file: &str) -> Result<MeshFile, MeshError> {
    read_polygons(&decoded(bytes))
        .and_then(|p| p.into_file(stem(file)))
        .map_err(|refused| refused.within(file))
}

fn read_polygons(text: &[u8]) -> Result<Polygons, Refused> {
    let mut lines = Lines::of(text);
    let header = Header::read(&mut lines)?;
    let mut polygons = Polygons::new("line");
    for index in 0..header.vertices {
        let line = expect(&mut lines, || format!("vertex {index} of {}", header.vertices))?;
        header.kind.read_vertex(line, &mut polygons)?;
    }
    for index in 0..header.faces {
        let line = expect(&mut lines, || format!("face {index} of {}", header.faces))?;
        read_face(line, &header.kind, &mut polygons)?;
    }
    scale_colours(&mut polygons.colours);
    Ok(polygons)
}

fn expect<'a>(lines: &mut Lines<'a>, what: impl FnOnce() -> String) -> Result<Line<'a>, Refused> {
    let line = lines.next_full();
    line.ok_or_else(|| {
        Refused::line(lines.number().saturating_add(1), format!("it is cut off: {} must be here", what()))
    })
}

struct Header {
    kind: Kind,
    vertices: u64,
    faces: u64,
}

/// What a vertex has besides its position.
#[derive(Default)]
struct Kind {
    uv: bool,
    colour: bool,
    normal: bool,
}

impl Header {
    fn read(lines: &mut Lines<'_>) -> Result<Self, Refused> {
        let first = expect(lines, || "'OFF'".into())?;
        let mut words = first.words();
        let kind = Kind::called(words.next().unwrap_or_default()).map_err(|rule| first.refused(rule))?;
        let rest: Vec<&[u8]> = words.collect();
        if rest.first() == Some(&b"BINARY".as_slice()) {
            return Err(first.refused("binary OFF is not read"));
        }
        let line = if rest.is_empty() { expect(lines, || "the counts".into())? } else { first };
        let counts = if rest.is_empty() { line.words().collect() } else { rest };
        let [vertices, faces, ..] = counts.as_slice() else {
            return Err(line.refused("it must say how many vertices and faces there are"));
        };
        let vertices = line.count_of(vertices, "the number of vertices")?;
        Ok(Self { kind, vertices, faces: line.count_of(faces, "the number of faces")? })
    }
}

impl Kind {
    fn called(word: &[u8]) -> Result<Self, String> {
        let letters =
            word.strip_suffix(b"OFF").ok_or_else(|| must_be(word, "'OFF', with letters for what it has"))?;
        let (mut kind, mut rest) = (Self::default(), letters);
        while let Some((&letter, after)) = rest.split_first() {
            rest = after;
            match letter {
                b'S' if rest.starts_with(b"T") => (kind.uv, rest) = (true, &rest[1..]),
                b'C' => kind.colour = true,
                b'N' => kind.normal = true,
                _ => {
                    return Err(format!(
                        "{} must have three dimensions and the letters ST, C and N alone",
                        quoted(word)
                    ));
                }
            }
        }
        Ok(kind)
    }

    fn read_vertex(&self, line: Line<'_>, polygons: &mut Polygons) -> Result<(), Refused> {
        let mut numbers = [0.0; MOST_NUMBERS];
        let mut count = 0;
        for (slot, word) in numbers.iter_mut().zip(line.words()) {
            *slot = line.number_of(word)?;
            count += 1;
        }
        let mut rest = &numbers[..count];
        let [x, y, z] = take(&mut rest).ok_or_else(|| line.refused("a vertex must have 3 coordinates"))?;
        polygons.positions.push(Vec3::new(x, y, z));
        if self.normal {
            let normal = take(&mut rest).ok_or_else(|| line.refused("its normal must have 3 numbers"))?;
            polygons.normals.push(Vec3::from_array(normal));
        }
        if self.uv {
            let (before, uv) =
                rest.split_last_chunk().ok_or_else(|| line.refused("it must have 2 texture coordinates"))?;
            polygons.uvs.push(Vec2::from_array(*uv));
            rest = before;
        }
        if self.colour {
            let colour = colour(rest).ok_or_else(|| line.refused("its colour must have 3 or 4 numbers"))?;
            polygons.colours.push(colour);
        }
        Ok(())
    }
}

/// Position, normal, colour, texture coordinate.
const MOST_NUMBERS: usize = 3 + 3 + 4 + 2;

fn take<const N: usize>(numbers: &mut &[f32]) -> Option<[f32; N]> {
    let (&taken, rest) = numbers.split_first_chunk()?;
    *numbers = rest;
    Some(taken)
}

fn read_face(line: Line<'_>, kind: &Kind, polygons: &mut Polygons) -> Result<(), Refused> {
    let mut words = line.words();
    let count = line.count_of(words.next().unwrap_or_default(), "the number of corners")?;
    for _ in 0..count {
        let word = words.next().ok_or_else(|| line.refused(format!("it must have {count} corners")))?;
        let index: u32 = integer(word).ok_or_else(|| line.refused(must_be(word, "the index of a vertex")))?;
        let or_none = |has: bool| if has { index } else { NONE };
        polygons.add_corner(Corner { position: index, uv: or_none(kind.uv), normal: or_none(kind.normal) });
    }
    polygons.end_face(line.number)
}

/// Divides by 255 where any part of any colour is above 1.
fn scale_colours(colours: &mut [Vec4]) {
    if colours.iter().any(|c| c.truncate().max_element() > 1.0) {
        for colour in colours {
            let alpha = if colour.w > 1.0 { colour.w / 255.0 } else { colour.w };
            *colour = (colour.truncate() / 255.0).extend(alpha);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> MeshFile {
        let file = read(text.as_bytes(), "a.off").unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(file.mesh.check(), Ok(()));
        file
    }

    fn refusal(text: &str) -> String {
        read(text.as_bytes(), "a.off").expect_err("refused").to_string()
    }

    const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

    #[test]
    fn faces_may_have_colours_and_files_comments() {
        let file =
            read_text(&format!("# by hand\nOFF # here\n\n4 2 0\n{SQUARE}4 0 1 2 3 0.9 0 0#red\n  3 0 1 3\n"));
        assert_eq!(file.mesh.surface().triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
        assert_eq!(file.origins.place(2), "line 10");
    }

    #[test]
    fn counts_may_follow_the_first_word_and_lack_edges() {
        assert_eq!(read_text(&format!("OFF 4 1 0\n{SQUARE}3 0 1 2")).mesh.triangles.len(), 1);
        assert_eq!(read_text(&format!("OFF\r4 1\r{SQUARE}3 0 1 2")).mesh.triangles.len(), 1);
    }

    #[test]
    fn letters_say_what_a_vertex_has() {
        let mesh = read_text("STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 51 .5 .5\n1 0 0 0 0 1 0 255 0 255 1 0\n0 1 0 0 0 1 0 0 255 255 0 1\n3 0 1 2\n").mesh;
        assert_eq!(mesh.normals, [Vec3::Z; 3]);
        assert_eq!((mesh.uvs[0][0], mesh.colours[0]), (Vec2::splat(0.5), Vec4::new(1.0, 0.0, 0.0, 0.2)));
        let mesh = read_text("COFF\n3 1 0\n0 0 0 .9 0 0 # red\n1 0 0 0 0 .9\n0 1 0 0 .9 0\n3 0 1 2").mesh;
        assert_eq!(mesh.colours[1], Vec4::new(0.0, 0.0, 0.9, 1.0));
    }

    #[test]
    fn counts_are_not_believed() {
        let rule = refusal(&format!("OFF\n353535235358 6 0\n{SQUARE}"));
        assert_eq!(rule, "a.off: line 7: it is cut off: vertex 4 of 353535235358 must be here");
        assert_eq!(refusal("OFF\n0 1 0\n99999999999 1 2"), "a.off: line 3: it must have 99999999999 corners");
        assert_eq!(refusal(""), "a.off: line 1: it is cut off: 'OFF' must be here");
        assert_eq!(refusal("OFF"), "a.off: line 2: it is cut off: the counts must be here");
        assert_eq!(refusal("OFF\n3"), "a.off: line 2: it must say how many vertices and faces there are");
    }

    #[test]
    fn what_is_wrong_is_named_by_its_line() {
        assert_eq!(refusal("OFF\n1 0 0\n0 x 0"), "a.off: line 3: 'x' must be a number");
        assert_eq!(refusal("OFF\n1 0 0\n0 0"), "a.off: line 3: a vertex must have 3 coordinates");
        assert_eq!(
            refusal("OFF\n1 1 0\n0 0 0\n3 0 0 1"),
            "a.off: line 4: a corner must be one of 1 vertices, not number 2"
        );
        assert_eq!(
            refusal("OFF\n1 1 0\n0 0 0\n3 0 0 -1"),
            "a.off: line 4: '-1' must be the index of a vertex"
        );
        assert!(refusal("4OFF\n").contains("three dimensions") && refusal("OFF BINARY\n").contains("binary"));
        assert!(refusal("MESH\n").starts_with("a.off: line 1: 'MESH' must be 'OFF'"));
    }
}
