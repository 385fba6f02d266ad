//! One split in bytes.
//!
//! | | |
//! |---|---|
//! | flags | bit 0: not plain; bit 1: the error falls; bits 2 and 3: new triangles, 3 for a number that follows |
//! | number | by how many steps the error falls |
//! | number | new triangles, where they are 3 or more |
//! | number | the parent; where not plain, plus 1, and 0 for none |
//!
//! A *plain* split has a parent of one wedge, a new position with one new wedge, and new triangles of both and a wedge
//! across from the parent. That is nearly every split that is on no seam, and takes few bytes: a bit for each corner of
//! the parent's fan, whether it goes; for each triangle a number that says which corner of the fan's triangles is its
//! third, and in what order they come; and the words of both places and both rows.
//!
//! Any other split says how many positions, changed wedges, new wedges and changed corners there are, and then what
//! they are. Its wedges are numbers: 0 for one that is said outright, then the new ones, then those of the corners of
//! the fan's triangles.

use glam::Vec3;

use super::bytes::{Bytes, Fault, Words, folded, put_number, restored, unfolded};
use crate::bake::progressive::split::{Change, Split};
use crate::bake::progressive::state::{NONE, State};

const NOT_PLAIN: u8 = 1;
const ERROR_FALLS: u8 = 2;
const COUNT_SHIFT: u32 = 2;

/// Where in a triangle the parent's wedge, the new one and the third are.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// Reads and writes records of splits; what it has is scratch.
#[derive(Clone, Debug, Default)]
pub(in crate::bake::progressive) struct Codec {
    fan: Vec<u32>,
    differences: Vec<u32>,
    words: Words,
}

impl Codec {
    /// Reads the next split of a mesh. `error` is the mesh's, in steps.
    pub(in crate::bake::progressive) fn read(
        &mut self,
        bytes: &mut Bytes,
        state: &State,
        error: u32,
        split: &mut Split,
    ) -> Result<(), Fault> {
        split.clear();
        let start = *bytes;
        let flags = bytes.byte()?;
        start.must(flags >> 4 == 0, "a split must have flags that are known")?;
        let falls = if flags & ERROR_FALLS != 0 { bytes.number()? } else { 0 };
        start.must(falls <= error, "an error must not fall below 0")?;
        split.error = error - falls;
        let few = usize::from(flags >> COUNT_SHIFT);
        let triangles = if few == 3 { bytes.count()? } else { few };
        if flags & NOT_PLAIN == 0 {
            self.read_plain(bytes, state, triangles, split)?;
        } else {
            self.read_any(bytes, state, triangles, split)?;
            split.broken_rule(state).map_or(Ok(()), |rule| Err(start.fault(rule)))?;
        }
        start.must(split.is_finite(), "a position must be finite")
    }

    /// Appends the record of a split of a mesh whose error is so many steps.
    pub(in crate::bake::progressive) fn write(
        &mut self,
        split: &Split,
        state: &State,
        error: u32,
        out: &mut Vec<u8>,
    ) {
        self.find_fan(split.parent, state);
        let plain = self.plain(split, state);
        let (count, falls) = (split.triangles.len(), error - split.error);
        let flag = |is_set: bool, flag: u8| if is_set { flag } else { 0 };
        let few = (count.min(3) as u8) << COUNT_SHIFT;
        out.push(few | flag(plain.is_none(), NOT_PLAIN) | flag(falls > 0, ERROR_FALLS));
        if falls > 0 {
            put_number(falls, out);
        }
        if count >= 3 {
            put_number(count as u32, out);
        }
        match plain {
            Some(codes) => self.write_plain(split, state, &codes, out),
            None => self.write_any(split, state, out),
        }
    }

    fn find_fan(&mut self, parent: u32, state: &State) {
        self.fan.clear();
        if parent != NONE {
            self.fan.extend(state.fan(parent));
        }
    }

    // -- plain splits

    fn read_plain(
        &mut self,
        bytes: &mut Bytes,
        state: &State,
        triangles: usize,
        split: &mut Split,
    ) -> Result<(), Fault> {
        let parent = bytes.below(state.positions.len(), "a vertex that is split must be there")?;
        self.find_fan(parent, state);
        let &first = self.fan.first().ok_or(bytes.fault("a vertex that is split must have a triangle"))?;
        let (old, new) = (state.wedge(first), state.wedges.len() as u32);
        let mask = bytes.take(self.fan.len().div_ceil(8))?;
        let goes = |&(i, _): &(usize, &u32)| mask[i / 8] >> (i % 8) & 1 == 1;
        split.corners.extend(self.fan.iter().enumerate().filter(goes).map(|(_, &corner)| (corner, new)));
        for _ in 0..triangles {
            let code = bytes.below(12 * self.fan.len(), "a third corner must be one of the fan's")?;
            let (order, third) = (ORDERS[code as usize % 6], code / 6);
            let corner = self.fan[third as usize / 2];
            let wedges = [old, new, state.wedge_after(corner, 1 + third % 2)];
            split.triangles.push(std::array::from_fn(|k| wedges[order[k]]));
            split.groups.push(state.groups[corner as usize / 3]);
        }
        bytes.differences(6 + 2 * state.width, &mut self.differences)?;
        let place = state.positions[parent as usize];
        split.parent = parent;
        split.place = self.place(place, 0);
        split.positions.push(self.place(place, 3));
        split.wedges.push(state.positions.len() as u32);
        if state.width > 0 {
            split.changed.push(Change { wedge: old, moves: false });
        }
        let row = state.row(old).iter().chain(state.row(old));
        split.rows.extend(row.zip(&self.differences[6..]).map(|(&e, &d)| restored(e, d)));
        Ok(())
    }

    /// The place that differs so from an expected one, by the words from that one on.
    fn place(&self, expected: Vec3, first: usize) -> Vec3 {
        let expected = expected.to_array();
        let number = |i: usize| f32::from_bits(restored(expected[i].to_bits(), self.differences[first + i]));
        Vec3::from_array(std::array::from_fn(number))
    }

    /// The codes of the triangles of a split, if it is plain.
    fn plain(&self, split: &Split, state: &State) -> Option<Vec<u32>> {
        let (&first, new) = (self.fan.first()?, state.wedges.len() as u32);
        let old = state.wedge(first);
        let is_plain = split.positions.len() == 1
            && split.wedges == [state.positions.len() as u32]
            && self.fan.iter().all(|&corner| state.wedge(corner) == old)
            && split.corners.iter().all(|&(_, wedge)| wedge == new)
            && split.changed.iter().all(|change| *change == Change { wedge: old, moves: false });
        let code = |(triangle, &group): (&[u32; 3], &u32)| self.code([old, new], *triangle, group, state);
        if is_plain { split.triangles.iter().zip(&split.groups).map(code).collect() } else { None }
    }

    fn code(&self, [old, new]: [u32; 2], triangle: [u32; 3], group: u32, state: &State) -> Option<u32> {
        let third = triangle.into_iter().find(|&wedge| wedge != old && wedge != new)?;
        let wedges = [old, new, third];
        let order = ORDERS.iter().position(|order| order.map(|k| wedges[k]) == triangle)?;
        let is_third = |&at: &usize| {
            let corner = self.fan[at / 2];
            state.wedge_after(corner, 1 + at as u32 % 2) == third
                && state.groups[corner as usize / 3] == group
        };
        let at = (0..2 * self.fan.len()).find(is_third)?;
        Some((6 * at + order) as u32)
    }

    fn write_plain(&mut self, split: &Split, state: &State, codes: &[u32], out: &mut Vec<u8>) {
        put_number(split.parent, out);
        for eight in self.fan.chunks(8) {
            let goes = |corner: &u32| split.corners.iter().any(|(gone, _)| gone == corner);
            out.push(eight.iter().rev().fold(0, |mask, corner| mask << 1 | u8::from(goes(corner))));
        }
        codes.iter().for_each(|&code| put_number(code, out));
        let place = state.positions[split.parent as usize];
        self.add_place(place, split.place);
        self.add_place(place, split.positions[0]);
        let before = state.row(state.wedge(self.fan[0]));
        // A row that does not change is none of the split's.
        let changed = if split.changed.is_empty() { before } else { &split.rows[..state.width] };
        self.words.add(before, changed);
        self.words.add(before, &split.rows[split.rows.len() - state.width..]);
        self.words.put(out);
    }

    fn add_place(&mut self, expected: Vec3, place: Vec3) {
        self.words.add(&expected.to_array().map(f32::to_bits), &place.to_array().map(f32::to_bits));
    }

    // -- all others

    fn read_any(
        &mut self,
        bytes: &mut Bytes,
        state: &State,
        triangles: usize,
        split: &mut Split,
    ) -> Result<(), Fault> {
        let parent = bytes.below(state.positions.len() + 1, "a vertex that is split must be there")?;
        split.parent = parent.wrapping_sub(1);
        self.find_fan(split.parent, state);
        let [positions, changed, wedges, corners] =
            [bytes.count()?, bytes.count()?, bytes.count()?, bytes.count()?];
        for _ in 0..changed {
            let wedge = self.read_wedge(bytes, state, 0)?;
            split.changed.push(Change { wedge, moves: bytes.byte()? != 0 });
        }
        for _ in 0..wedges {
            let code = bytes.number()?;
            split.wedges.push(position_of(
                code,
                split.parent,
                positions as u32,
                state.positions.len() as u32,
            ));
        }
        let mut at = 0;
        for _ in 0..corners {
            at += bytes.below(self.fan.len() - at, "a corner must be one of the fan's")? as usize;
            let wedge = self.read_wedge(bytes, state, wedges as u32)?;
            split.corners.push((self.fan[at], wedge));
        }
        for _ in 0..triangles {
            let mut wedge = || self.read_wedge(bytes, state, wedges as u32);
            split.triangles.push([wedge()?, wedge()?, wedge()?]);
            split.groups.push(bytes.below(state.kinds, "a group must be one of those named")?);
        }
        bytes.must(split.has_places(state, positions), "a new wedge must be at a position that is there")?;
        self.read_words(bytes, state, positions, split)
    }

    fn read_words(
        &mut self,
        bytes: &mut Bytes,
        state: &State,
        positions: usize,
        split: &mut Split,
    ) -> Result<(), Fault> {
        let rows = split.changed.len() + split.wedges.len();
        let count = 3 + 3 * positions + rows * state.width;
        bytes.must(count.div_ceil(4) <= bytes.left(), "it must not end here")?;
        bytes.differences(count, &mut self.differences)?;
        let place = state.positions.get(split.parent as usize).copied().unwrap_or_default();
        split.place = self.place(place, 0);
        for i in 0..positions {
            split.positions.push(self.place(place, 3 + 3 * i));
        }
        let mut differences = &self.differences[3 + 3 * positions..];
        for model in split.models(state) {
            let (own, rest) = differences.split_at(state.width);
            let expected = expected_row(model, state);
            let word =
                |(k, &difference): (usize, &u32)| restored(expected.get(k).copied().unwrap_or(0), difference);
            split.rows.extend(own.iter().enumerate().map(word));
            differences = rest;
        }
        Ok(())
    }

    /// A wedge, which is one of the mesh or of so many new ones.
    fn read_wedge(&self, bytes: &mut Bytes, state: &State, new: u32) -> Result<u32, Fault> {
        let code = bytes.below(
            1 + new as usize + 3 * self.fan.len(),
            "a wedge must be a new one or one around the vertex",
        )?;
        if code == 0 {
            return bytes.below(state.wedges.len(), "a wedge must be there");
        }
        match (code - 1).checked_sub(new) {
            None => Ok(state.wedges.len() as u32 + code - 1),
            Some(at) => Ok(state.triangles[self.fan[at as usize / 3] as usize / 3][at as usize % 3]),
        }
    }

    fn put_wedge(&self, wedge: u32, state: &State, new: u32, out: &mut Vec<u8>) {
        let added = wedge.checked_sub(state.wedges.len() as u32);
        let around = self.fan.iter().flat_map(|&corner| state.triangles[corner as usize / 3]);
        let code = added.or_else(|| around.zip(new..).find(|&(w, _)| w == wedge).map(|(_, code)| code));
        match code {
            Some(code) => put_number(code + 1, out),
            None => {
                put_number(0, out);
                put_number(wedge, out);
            }
        }
    }

    fn write_any(&mut self, split: &Split, state: &State, out: &mut Vec<u8>) {
        put_number(split.parent.wrapping_add(1), out);
        let new = split.wedges.len() as u32;
        for count in [split.positions.len(), split.changed.len(), split.wedges.len(), split.corners.len()] {
            put_number(count as u32, out);
        }
        for change in &split.changed {
            self.put_wedge(change.wedge, state, 0, out);
            out.push(u8::from(change.moves));
        }
        for &position in &split.wedges {
            put_number(code_of(position, split, state.positions.len() as u32), out);
        }
        let mut last = 0;
        for (corner, wedge) in &split.corners {
            let at = self.fan.iter().position(|c| c == corner).unwrap_or_default();
            put_number((at - last) as u32, out);
            self.put_wedge(*wedge, state, new, out);
            last = at;
        }
        for (triangle, &group) in split.triangles.iter().zip(&split.groups) {
            triangle.iter().for_each(|&wedge| self.put_wedge(wedge, state, new, out));
            put_number(group, out);
        }
        let place = state.positions.get(split.parent as usize).copied().unwrap_or_default();
        self.add_place(place, split.place);
        split.positions.iter().for_each(|&position| self.add_place(place, position));
        let zeros = vec![0; state.width];
        for (row, model) in split.rows.chunks_exact(state.width.max(1)).zip(split.models(state)) {
            let expected = expected_row(model, state);
            self.words.add(if expected.is_empty() { &zeros } else { expected }, row);
        }
        self.words.put(out);
    }
}

/// The row of what another resembles; empty where there is no such thing.
fn expected_row(model: Option<u32>, state: &State) -> &[u32] {
    model.map_or(&[], |wedge| state.row(wedge))
}

/// A position as 0 for the parent, the number of a new one from 1 on, or any other after those.
fn code_of(position: u32, split: &Split, first: u32) -> u32 {
    let new = split.positions.len() as u32;
    if position == split.parent {
        0
    } else if position >= first {
        position - first + 1
    } else {
        position + new + 1
    }
}

fn position_of(code: u32, parent: u32, new: u32, first: u32) -> u32 {
    match code {
        0 => parent,
        code if code <= new => first + code - 1,
        code => code - new - 1,
    }
}

/// A distance as the steps that errors are kept in, rounded up; a step is a 2048th of an octave, roughly.
pub(in crate::bake::progressive) fn steps_of(error: f64) -> u32 {
    let nearest = error.min(f64::from(f32::MAX)) as f32;
    let above = if f64::from(nearest) < error { nearest.next_up() } else { nearest };
    above.max(0.0).to_bits().div_ceil(1 << STEP_BITS)
}

/// The distance of so many steps.
pub(in crate::bake::progressive) fn error_of(steps: u32) -> f32 {
    f32::from_bits(steps << STEP_BITS)
}

/// As many steps as there are: infinity.
pub(in crate::bake::progressive) const MOST_STEPS: u32 = 0x7f80_0000 >> STEP_BITS;

const STEP_BITS: u32 = 12;

/// A whole number near an expected one, as a number to write.
pub(in crate::bake::progressive) fn put_near(number: u32, expected: u32, out: &mut Vec<u8>) {
    put_number(folded(number.wrapping_sub(expected) as i32), out);
}

/// That number again.
pub(in crate::bake::progressive) fn near(bytes: &mut Bytes, expected: u32) -> Result<u32, Fault> {
    Ok(expected.wrapping_add(unfolded(bytes.number()?) as u32))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn steps_are_never_below_the_error(error in 0.0f64..1.0e9, shift in 0..80u32) {
            let error = error / 2.0f64.powi(shift as i32);
            let kept = f64::from(error_of(steps_of(error)));
            prop_assert!(kept >= error && kept <= error * (1.0 + 1.0 / 1024.0) + 1e-37, "{error} {kept}");
        }
    }

    #[test]
    fn what_is_too_large_is_infinite() {
        assert_eq!(error_of(steps_of(f64::INFINITY)), f32::INFINITY);
        assert_eq!((error_of(MOST_STEPS), error_of(0)), (f32::INFINITY, 0.0));
    }
}
