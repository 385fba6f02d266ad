//! STL, text and binary (3D Systems, *StereoLithography interface specification*, 1988).
//!
//! A file whose length is what the count in its 81st to 84th byte makes of it is binary, whatever it starts with;
//! others that start with `solid` are text. Normals, attributes and colours of facets are passed over: the corners
//! tell the normal. Text may have several solids, each a group, and is read word by word. A facet is known by its
//! number, from 0 on, in binary files.

use glam::Vec3;

use super::polygons::{Corner, Polygons, must_be, name_of};
use super::text::{Line, Lines, decoded};
use super::{MeshError, MeshFile, Refused, stem};
use crate::bake::finding::Defect;

/// Reads STL; `file` names it in errors.
///
/// # Errors
/// A binary file that is cut off; text with an unknown word, a vertex of fewer than three numbers, or a loop that does
/// not end: with the line.
pub fn read(bytes: &[u8], file: &str) -> Result<MeshFile, MeshError> {
    read_polygons(bytes).and_then(|p| p.into_file(stem(file))).map_err(|refused| refused.within(file))
}

/// Bytes of the header with the count, and of a facet.
const HEADER: usize = 84;
const FACET: usize = 50;

fn read_polygons(bytes: &[u8]) -> Result<Polygons, Refused> {
    let length = claimed_length(bytes);
    let text = decoded(bytes);
    let says_solid = text.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    match length {
        Some(length) if length == bytes.len() as u64 || !says_solid && length <= bytes.len() as u64 => {
            read_binary(bytes, length as usize)
        }
        _ if says_solid => read_text(&text),
        Some(length) => {
            Err(Refused::whole(format!("it is cut off: {length} bytes must be there, not {}", bytes.len())))
        }
        None => Err(Refused::whole("it must start with 'solid' or with a binary header of 84 bytes")),
    }
}

/// How long the file is if it is binary and its count is right.
fn claimed_length(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER - 4..)?.first_chunk()?;
    Some(HEADER as u64 + FACET as u64 * u64::from(u32::from_le_bytes(*count)))
}

fn read_binary(bytes: &[u8], length: usize) -> Result<Polygons, Refused> {
    let mut polygons = Polygons::new("facet");
    for (number, facet) in bytes[HEADER..length].as_chunks::<FACET>().0.iter().enumerate() {
        let numbers = facet[12..48].as_chunks().0.iter().map(|&b| f32::from_le_bytes(b));
        let numbers: Vec<f32> = numbers.collect();
        for corner in numbers.as_chunks::<3>().0 {
            add_corner(&mut polygons, Vec3::from_array(*corner));
        }
        polygons.end_face(number as u32)?;
    }
    if length < bytes.len() {
        let place = || format!("byte {length}");
        polygons.findings.add(Defect::Unread("runs of bytes behind the last facet"), place);
    }
    Ok(polygons)
}

/// Every corner has a position of its own; welding joins them.
fn add_corner(polygons: &mut Polygons, position: Vec3) {
    let index = u32::try_from(polygons.positions.len()).unwrap_or(u32::MAX);
    polygons.positions.push(position);
    polygons.add_corner(Corner::bare(index));
}

fn read_text(text: &[u8]) -> Result<Polygons, Refused> {
    let mut polygons = Polygons::new("line");
    let mut open = None;
    for line in Lines::of(text) {
        read_words(line, &mut open, &mut polygons)?;
    }
    match open {
        Some(line) => Err(Refused::line(line, "its loop must end with endloop")),
        None => Ok(polygons),
    }
}

/// The words of a line, which are several where the file has facets in one line. `open` is where the loop began.
fn read_words(line: Line<'_>, open: &mut Option<u32>, polygons: &mut Polygons) -> Result<(), Refused> {
    let mut words = line.words();
    while let Some(word) = words.next() {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => {
                polygons.begin_group(&name_of(&line.bytes.trim_ascii_start()[word.len()..]), None);
                return Ok(());
            }
            b"endsolid" => return Ok(()),
            b"outer" | b"facet" | b"endfacet" => {}
            b"normal" => words.by_ref().take(3).for_each(drop),
            b"loop" if open.is_some() => return Err(line.refused("a loop must end before the next")),
            b"loop" => *open = Some(line.number),
            b"vertex" if open.is_none() => return Err(line.refused("a vertex must be within a loop")),
            b"vertex" => add_corner(polygons, vertex(line, &mut words)?),
            b"endloop" => {
                let number = open.take().ok_or_else(|| line.refused("endloop must end a loop"))?;
                polygons.end_face(number)?;
            }
            _ => return Err(line.refused(must_be(word, "a word of STL, such as facet, loop or vertex"))),
        }
    }
    Ok(())
}

fn vertex<'a>(line: Line<'a>, words: &mut impl Iterator<Item = &'a [u8]>) -> Result<Vec3, Refused> {
    let mut number = || {
        let word = words.next().ok_or_else(|| line.refused("a vertex must have 3 coordinates"))?;
        line.number_of(word)
    };
    Ok(Vec3::new(number()?, number()?, number()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facet(corners: [[f32; 3]; 3]) -> Vec<u8> {
        let mut bytes = vec![0; 12];
        bytes.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0, 0]);
        bytes
    }

    fn binary(title: &str, facets: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = title.as_bytes().to_vec();
        bytes.resize(80, b' ');
        bytes.extend((facets.len() as u32).to_le_bytes());
        bytes.extend(facets.concat());
        bytes
    }

    fn square() -> [Vec<u8>; 2] {
        [facet([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.]]), facet([[0., 0., 0.], [1., 1., 0.], [0., 1., 0.]])]
    }

    #[test]
    fn facets_are_welded() {
        for title in ["made by hand", "solid though binary"] {
            let file = read(&binary(title, &square()), "a.stl").expect("valid");
            assert_eq!(file.mesh.surface().triangles, [[0, 1, 2], [0, 2, 3]]);
            assert_eq!((file.mesh.check(), file.origins.place(1).as_str()), (Ok(()), "facet 1"));
        }
    }

    #[test]
    fn what_is_cut_off_is_refused_and_what_is_more_reported() {
        let mut bytes = binary("x", &square());
        bytes.push(7);
        let file = read(&bytes, "a.stl").expect("valid");
        assert_eq!(
            file.findings[0].to_string(),
            "1 runs of bytes behind the last facet, passed over: byte 184"
        );
        let refused = |bytes: &[u8]| read(bytes, "a.stl").expect_err("refused").to_string();
        assert_eq!(refused(&bytes[..150]), "a.stl: it is cut off: 184 bytes must be there, not 150");
        bytes[83] = 255;
        assert!(refused(&bytes).contains("bytes must be there, not 185"));
        assert!(refused(b"").contains("must start with 'solid'"));
    }

    const TEXT: &str = "solid one\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1 0\n endloop\n\
                        endfacet\nendsolid one\nSOLID two\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 1 0 vertex 0 1 0 endloop endfacet\n";

    #[test]
    fn text_may_have_several_solids_and_any_layout() {
        let file = read(TEXT.as_bytes(), "a.stl").expect("valid");
        assert_eq!(file.mesh.surface().triangles, [[0, 1, 2], [0, 2, 3]]);
        let groups: Vec<_> =
            file.mesh.groups.iter().map(|g| (g.name.as_str(), g.triangles.clone())).collect();
        assert_eq!(groups, [("one", 0..1), ("two", 1..2)]);
        assert_eq!(file.origins.place(0), "line 3");
    }

    #[test]
    fn wrong_text_is_named_by_its_line() {
        let refused = |text: &str| read(text.as_bytes(), "a.stl").expect_err("refused").to_string();
        assert!(refused("solid\nfrob").starts_with("a.stl: line 2: 'frob' must be a word of STL"));
        assert_eq!(refused("solid\nvertex 0 0 0"), "a.stl: line 2: a vertex must be within a loop");
        assert_eq!(
            refused("solid\nouter loop\nvertex 0 0"),
            "a.stl: line 3: a vertex must have 3 coordinates"
        );
        assert_eq!(
            refused("solid\n\nouter loop\nvertex 0 0 0"),
            "a.stl: line 3: its loop must end with endloop"
        );
        assert_eq!(
            refused("solid\nouter loop\nouter loop"),
            "a.stl: line 3: a loop must end before the next"
        );
        assert_eq!(refused("solid\nendloop"), "a.stl: line 2: endloop must end a loop");
        assert!(read(b"solid Empty\nendsolid Empty\n", "a.stl").expect("valid").mesh.triangles.is_empty());
    }
}
