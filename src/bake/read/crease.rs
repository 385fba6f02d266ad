//! Creases in OBJ.
//!
//! The standard has none. Read is what the regression shapes of OpenSubdiv, and of the hbr library before it, have:
//!
//! ```text
//! t crease 2/1/0 A B SHARPNESS      an edge; with more vertices than two, a row of edges
//! t corner 1/1/0 A SHARPNESS        a vertex
//! ```
//!
//! The word in the middle says how many whole numbers, numbers and names follow. Vertices count from 0, unlike those of
//! faces. Other tags are passed over and reported.

use super::Refused;
use super::text::{Line, integer, quoted};

/// Edges, or a vertex, that are to be sharp.
#[derive(Debug, PartialEq)]
pub(super) struct Crease {
    pub(super) line: u32,
    /// From 0 on, in the order of the file.
    pub(super) vertices: Vec<u32>,
    /// ≥ 0.
    pub(super) sharpness: f32,
}

/// A line that starts with `t`; nothing where it is another tag.
pub(super) fn tag(line: Line<'_>) -> Result<Option<Crease>, Refused> {
    let words: Vec<&[u8]> = line.words().skip(1).take_while(|word| !word.starts_with(b"#")).collect();
    let least = match words.first() {
        Some(&b"crease") => 2,
        Some(&b"corner") => 1,
        _ => return Ok(None),
    };
    let rule = || {
        line.refused(format!("a tag must be as in 't crease 2/1/0 0 1 2.5', with {least} vertices or more"))
    };
    let counts: Vec<usize> =
        words.get(1).ok_or_else(rule)?.split(|&b| b == b'/').filter_map(integer).collect();
    let &[vertices, sharpnesses, names] = counts.as_slice() else { return Err(rule()) };
    let numbers = words.len() - 2;
    let fits = vertices.checked_add(1).is_some_and(|all| all == numbers);
    if !fits || vertices < least || least == 1 && vertices > 1 || (sharpnesses, names) != (1, 0) {
        return Err(rule());
    }
    let vertex = |word: &&[u8]| {
        integer::<u32>(word)
            .ok_or_else(|| line.refused(format!("{} must be a vertex, from 0 on", quoted(word))))
    };
    let vertices = words[2..words.len() - 1].iter().map(vertex).collect::<Result<_, _>>()?;
    let sharpness = line.number_of(words[words.len() - 1])?;
    match sharpness >= 0.0 {
        true => Ok(Some(Crease { line: line.number, vertices, sharpness })),
        false => Err(line.refused(format!("a sharpness must be at least 0, not {sharpness}"))),
    }
}
