//! From the mesh after all splits to the original: the order of everything, and what simplification leaves out.
//!
//! | | |
//! |---|---|
//! | flat triangles | those that use a position twice, which are never simplified: their places and corners |
//! | order | for each other triangle which one of the splits' it is: four bits that say the how-manieth of those around the last one, not yet taken, or 0 |
//! | jumps | the number of each triangle whose four bits are 0 |
//! | corners | where a corner's wedge is not the last that stood for the splits' wedge, or else one more than the last new one; a byte for each wedge that there are more |
//! | wedges | where a wedge's position is not as its corners say, or else one more than the last new one |
//! | positions | those that no triangle uses |
//! | rows | the attributes of wedges that differ from those after the splits |

use glam::Vec3;

use super::bytes::{Bytes, Fault, Words, put_number, restored};
use super::head::{GroupHead, Head};
use super::record::{near, put_near};
use crate::bake::progressive::row::Columns;
use crate::bake::progressive::state::{NONE, State};
use crate::bake::{Group, Mesh};

/// Places around a triangle that four bits can say.
const NEAR: usize = 15;

/// Appends what leads from the mesh after all splits to the original. `order` says for each triangle of the original
/// which one it is, [`NONE`] for those that use a position twice.
pub(in crate::bake::progressive) fn put(mesh: &Mesh, state: &State, order: &[u32], out: &mut Vec<u8>) {
    let flat: Vec<usize> = (0..order.len()).filter(|&t| order[t] == NONE).collect();
    put_number(flat.len() as u32, out);
    let mut expected = 0;
    for &triangle in &flat {
        put_number((triangle - expected) as u32, out);
        mesh.triangles[triangle].iter().for_each(|&wedge| put_number(wedge, out));
        expected = triangle + 1;
    }
    let order: Vec<u32> = order.iter().copied().filter(|&t| t != NONE).collect();
    put_order(state, &order, out);
    let whole = (0..mesh.triangles.len()).filter(|t| flat.binary_search(t).is_err());
    let corners: Vec<u32> = whole.flat_map(|t| mesh.triangles[t]).collect();
    let ours: Vec<u32> = order.iter().flat_map(|&t| state.triangles[t as usize]).collect();
    let owners = put_wedges(&corners, &ours, state, mesh.wedges.len(), out);
    let ours: Vec<u32> =
        owners.iter().map(|&w| if w == NONE { NONE } else { state.wedges[w as usize] }).collect();
    let places = put_positions(&mesh.wedges, &ours, state, mesh.positions.len(), out);
    put_places(mesh, &places, out);
    put_rows(mesh, rows_of(mesh), &owners, state, out);
}

/// The rows of all wedges of a mesh.
fn rows_of(mesh: &Mesh) -> Vec<u32> {
    let columns = Columns::of(mesh);
    let mut rows = Vec::with_capacity(mesh.wedges.len() * columns.width());
    (0..mesh.wedges.len()).for_each(|wedge| columns.read(mesh, wedge, &mut rows));
    rows
}

fn put_order(state: &State, order: &[u32], out: &mut Vec<u8>) {
    let mut walk = Walk::new(state);
    let mut jumps = Vec::new();
    let mut codes = order.iter().map(|&triangle| {
        let code = walk.around().position(|t| t == triangle).map_or(0, |at| at + 1);
        if code == 0 {
            put_number(triangle, &mut jumps);
        }
        walk.take(triangle);
        code as u8
    });
    while let Some(low) = codes.next() {
        out.push(low | codes.next().unwrap_or(0) << 4);
    }
    out.extend_from_slice(&jumps);
}

/// A walk over triangles from neighbour to neighbour.
struct Walk<'a> {
    state: &'a State,
    taken: Vec<bool>,
    last: Option<u32>,
}

impl<'a> Walk<'a> {
    fn new(state: &'a State) -> Self {
        Self { state, taken: vec![false; state.triangles.len()], last: None }
    }

    fn take(&mut self, triangle: u32) {
        self.taken[triangle as usize] = true;
        self.last = Some(triangle);
    }

    /// The first triangles around the last one that are not taken: those at its last corner first. Some may come
    /// twice.
    fn around(&self) -> impl Iterator<Item = u32> {
        let state = self.state;
        let corners = self.last.map(|t| state.triangles[t as usize]).into_iter().flatten().rev();
        let fans = corners.flat_map(|wedge| state.fan(state.wedges[wedge as usize]).map(|corner| corner / 3));
        fans.filter(|&t| !self.taken[t as usize]).take(NEAR)
    }
}

/// What stands for what: of two numberings of the same things, the second of each of the first.
struct Pairing {
    of: Vec<u32>,
    expected: u32,
}

impl Pairing {
    fn new(count: usize) -> Self {
        Self { of: vec![NONE; count], expected: 0 }
    }

    fn expected(&self, of: u32) -> u32 {
        let known = self.of.get(of as usize).copied().filter(|&known| known != NONE);
        known.unwrap_or(self.expected)
    }

    /// Takes note of a pair; returns whether it was to be expected.
    fn note(&mut self, of: u32, number: u32) -> bool {
        let was_expected = self.expected(of) == number;
        if let Some(known) = self.of.get_mut(of as usize).filter(|known| **known != number) {
            *known = number;
            self.expected = number.wrapping_add(1);
        } else if of == NONE {
            self.expected = number.wrapping_add(1);
        }
        was_expected
    }
}

/// Appends where numbers are not as expected: how many, and for each how far it is from the last and by how much it
/// is off.
fn put_surprises(pairs: impl Iterator<Item = (u32, u32)>, pairing: &mut Pairing, out: &mut Vec<u8>) {
    let (mut count, mut surprises, mut expected_at) = (0, Vec::new(), 0);
    for (at, (of, number)) in (0u32..).zip(pairs) {
        let expected = pairing.expected(of);
        if !pairing.note(of, number) {
            put_number(at - expected_at, &mut surprises);
            put_near(number, expected, &mut surprises);
            expected_at = at + 1;
            count += 1;
        }
    }
    put_number(count, out);
    out.extend_from_slice(&surprises);
}

/// Reads as many numbers as there are things, each below a bound.
fn read_surprises(
    bytes: &mut Bytes,
    things: impl Iterator<Item = u32>,
    pairing: &mut Pairing,
    bound: usize,
) -> Result<Vec<u32>, Fault> {
    let mut left = bytes.count()?;
    let mut next = |bytes: &mut Bytes, at: usize| -> Result<Option<usize>, Fault> {
        if left == 0 {
            return Ok(None);
        }
        left -= 1;
        Ok(Some(at + bytes.number()? as usize))
    };
    let mut surprise = next(bytes, 0)?;
    let mut numbers = Vec::new();
    for (at, of) in things.enumerate() {
        let start = *bytes;
        let expected = pairing.expected(of);
        let is_surprise = surprise == Some(at);
        let number = if is_surprise { near(bytes, expected)? } else { expected };
        start.must((number as usize) < bound, "an index must be of something that is there")?;
        pairing.note(of, number);
        numbers.push(number);
        if is_surprise {
            surprise = next(bytes, at + 1)?;
        }
    }
    bytes.must(surprise.is_none(), "an exception must be of something that is there")?;
    Ok(numbers)
}

/// Returns for each wedge of the original the one that it is; [`NONE`] for those that no corner has.
fn put_wedges(corners: &[u32], ours: &[u32], state: &State, wedges: usize, out: &mut Vec<u8>) -> Vec<u32> {
    let mut pairing = Pairing::new(state.wedges.len());
    put_surprises(ours.iter().copied().zip(corners.iter().copied()), &mut pairing, out);
    out.resize(out.len() + wedges.saturating_sub(state.wedges.len()), 0);
    owners(corners, ours, wedges)
}

/// For each of so many numbers what it is paired with first; [`NONE`] for those that are not.
fn owners(numbers: &[u32], of: &[u32], count: usize) -> Vec<u32> {
    let mut owners = vec![NONE; count];
    for (&number, &of) in numbers.iter().zip(of) {
        let owner = &mut owners[number as usize];
        *owner = if *owner == NONE { of } else { *owner };
    }
    owners
}

fn put_positions(
    wedges: &[u32],
    ours: &[u32],
    state: &State,
    positions: usize,
    out: &mut Vec<u8>,
) -> Vec<u32> {
    let mut pairing = Pairing::new(state.positions.len());
    put_surprises(ours.iter().copied().zip(wedges.iter().copied()), &mut pairing, out);
    owners(wedges, ours, positions)
}

/// Appends the positions that no triangle uses.
fn put_places(mesh: &Mesh, places: &[u32], out: &mut Vec<u8>) {
    let mut words = Words::default();
    for (position, _) in mesh.positions.iter().zip(places).filter(|&(_, &place)| place == NONE) {
        words.add(&[0; 3], &position.to_array().map(f32::to_bits));
        words.put(out);
    }
}

/// Appends the rows that are not as the splits leave them.
fn put_rows(mesh: &Mesh, rows: Vec<u32>, owners: &[u32], state: &State, out: &mut Vec<u8>) {
    let zeros = vec![0; state.width];
    let expected = |wedge: usize| if owners[wedge] == NONE { &zeros } else { state.row(owners[wedge]) };
    let own = |wedge: usize| &rows[wedge * state.width..][..state.width];
    let other: Vec<usize> = (0..mesh.wedges.len()).filter(|&w| expected(w) != own(w)).collect();
    put_number(other.len() as u32, out);
    let (mut words, mut next) = (Words::default(), 0);
    for wedge in other {
        put_number((wedge - next) as u32, out);
        words.add(expected(wedge), own(wedge));
        words.put(out);
        next = wedge + 1;
    }
}

/// The original, from the mesh after all splits.
pub(in crate::bake::progressive) fn read(
    bytes: &mut Bytes,
    head: &Head,
    state: &State,
) -> Result<Mesh, Fault> {
    let counts = head.original;
    // Whatever the splits do not have takes a byte at least.
    let most = |ours: usize| ours + bytes.left();
    let is_possible = counts.triangles <= most(state.triangles.len())
        && counts.positions <= most(state.positions.len())
        && counts.wedges <= most(state.wedges.len());
    bytes.must(is_possible, "the original must not have more than there are bytes for")?;
    let flat = read_flat(bytes, counts.triangles, counts.wedges)?;
    let count = counts.triangles - flat.len();
    bytes.must(count == state.triangles.len(), "the original must have all triangles of the splits")?;
    let order = read_order(bytes, state)?;
    let ours: Vec<u32> = order.iter().flat_map(|&t| state.triangles[t as usize]).collect();
    let mut pairing = Pairing::new(state.wedges.len());
    let corners = read_surprises(bytes, ours.iter().copied(), &mut pairing, counts.wedges)?;
    bytes.take(counts.wedges.saturating_sub(state.wedges.len()))?;
    let owners_of_wedges = owners(&corners, &ours, counts.wedges);
    let place = |&wedge: &u32| state.wedges.get(wedge as usize).copied().unwrap_or(NONE);
    let places: Vec<u32> = owners_of_wedges.iter().map(place).collect();
    let mut pairing = Pairing::new(state.positions.len());
    let wedges = read_surprises(bytes, places.iter().copied(), &mut pairing, counts.positions)?;
    let owners_of_positions = owners(&wedges, &places, counts.positions);
    let positions = read_places(bytes, &owners_of_positions, state)?;
    let rows = read_rows(bytes, &owners_of_wedges, state)?;
    bytes.must(bytes.left() == 0, "the original must end here")?;
    let triangles = woven(&flat, &corners);
    let mut mesh = Mesh { name: head.name.clone(), positions, wedges, triangles, ..Mesh::default() };
    mesh.groups = groups(head);
    head.columns.write(&rows, &mut mesh);
    mesh.check().map(|()| mesh).map_err(|_| bytes.fault("the original must be a mesh as its head says"))
}

/// Triangles that use a position twice, and their places.
fn read_flat(bytes: &mut Bytes, triangles: usize, wedges: usize) -> Result<Vec<(usize, [u32; 3])>, Fault> {
    let (count, mut at) = (bytes.count()?, 0);
    let mut flat = Vec::with_capacity(count);
    for _ in 0..count {
        at += bytes.below(triangles - at, "a triangle must be one of the original's")? as usize;
        let mut wedge = || bytes.below(wedges, "a corner must be one of the original's wedges");
        flat.push((at, [wedge()?, wedge()?, wedge()?]));
        at += 1;
    }
    Ok(flat)
}

fn read_order(bytes: &mut Bytes, state: &State) -> Result<Vec<u32>, Fault> {
    let count = state.triangles.len();
    let codes = bytes.take(count.div_ceil(2))?;
    let mut walk = Walk::new(state);
    let mut order = Vec::with_capacity(count);
    for at in 0..count {
        let code = usize::from(codes[at / 2] >> (4 * (at % 2)) & 15);
        let start = *bytes;
        let triangle = match code.checked_sub(1) {
            Some(near) => {
                walk.around().nth(near).ok_or(start.fault("a triangle must be one around the last"))?
            }
            None => bytes.below(count, "a triangle must be there")?,
        };
        start.must(!walk.taken[triangle as usize], "a triangle must come once")?;
        walk.take(triangle);
        order.push(triangle);
    }
    Ok(order)
}

fn read_places(bytes: &mut Bytes, owners: &[u32], state: &State) -> Result<Vec<Vec3>, Fault> {
    let mut differences = Vec::new();
    let mut place = |&owner: &u32| {
        if owner != NONE {
            return Ok(state.positions[owner as usize]);
        }
        bytes.differences(3, &mut differences)?;
        let number = |i: usize| f32::from_bits(restored(0, differences[i]));
        Ok(Vec3::from_array(std::array::from_fn(number)))
    };
    owners.iter().map(&mut place).collect()
}

fn read_rows(bytes: &mut Bytes, owners: &[u32], state: &State) -> Result<Vec<u32>, Fault> {
    let zeros = vec![0; state.width];
    let expected = |&owner: &u32| if owner == NONE { &zeros[..] } else { state.row(owner) };
    let mut rows: Vec<u32> = owners.iter().flat_map(expected).copied().collect();
    let (count, mut at, mut differences) = (bytes.count()?, 0, Vec::new());
    for _ in 0..count {
        at += bytes.below(owners.len() - at, "a wedge must be one of the original's")? as usize;
        bytes.differences(state.width, &mut differences)?;
        let row = &mut rows[at * state.width..][..state.width];
        row.iter_mut().zip(&differences).for_each(|(word, &d)| *word = restored(*word, d));
        at += 1;
    }
    Ok(rows)
}

/// Puts flat triangles between the others, in their places.
fn woven(flat: &[(usize, [u32; 3])], corners: &[u32]) -> Vec<[u32; 3]> {
    let mut others = corners.as_chunks::<3>().0.iter();
    let mut flat = flat.iter().peekable();
    let mut triangles = Vec::with_capacity(flat.len() + others.len());
    loop {
        let is_flat = flat.peek().is_some_and(|(at, _)| *at == triangles.len());
        let next = if is_flat { flat.next().map(|(_, t)| t) } else { others.next() };
        match next {
            Some(triangle) => triangles.push(*triangle),
            None => return triangles,
        }
    }
}

fn groups(head: &Head) -> Vec<Group> {
    let mut groups = Vec::with_capacity(head.groups.len());
    let mut start = 0;
    for GroupHead { name, material, triangles } in &head.groups {
        let end = start + triangles;
        groups.push(Group { name: name.clone(), material: material.clone(), triangles: start..end });
        start = end;
    }
    groups
}
