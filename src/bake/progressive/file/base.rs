//! The coarsest mesh in bytes: everything beside what came before it.

use glam::Vec3;

use super::bytes::{Bytes, Fault, Words, restored};
use super::head::Head;
use super::record::{near, put_near};
use crate::bake::progressive::split::is_proper;
use crate::bake::progressive::state::{MOST_TRIANGLES, State};

/// Appends a mesh.
pub(in crate::bake::progressive) fn put(state: &State, out: &mut Vec<u8>) {
    let mut words = Words::default();
    let mut last = Vec3::ZERO.to_array().map(f32::to_bits);
    for position in &state.positions {
        let position = position.to_array().map(f32::to_bits);
        words.add(&last, &position);
        words.put(out);
        last = position;
    }
    let mut expected = 0;
    for &position in &state.wedges {
        put_near(position, expected, out);
        expected = position + 1;
    }
    let mut last = vec![0; state.width];
    for row in state.rows.chunks_exact(state.width.max(1)) {
        words.add(&last, row);
        words.put(out);
        last.copy_from_slice(row);
    }
    let (mut expected, mut group) = (0, 0);
    for (triangle, &own) in state.triangles.iter().zip(&state.groups) {
        for &wedge in triangle {
            put_near(wedge, expected, out);
            expected = wedge;
        }
        put_near(own, group, out);
        group = own;
    }
}

/// Reads the mesh that a head promises, and no more than there are bytes for.
pub(in crate::bake::progressive) fn read(bytes: &mut Bytes, head: &Head) -> Result<State, Fault> {
    let mut state = State::new(head.columns.width(), head.groups.len());
    read_positions(bytes, head.base.positions, &mut state)?;
    read_wedges(bytes, head.base.wedges, &mut state)?;
    read_triangles(bytes, head.base.triangles, &mut state)?;
    bytes.must(bytes.left() == 0, "the base mesh must end here")?;
    Ok(state)
}

fn read_positions(bytes: &mut Bytes, count: usize, state: &mut State) -> Result<(), Fault> {
    let (mut last, mut differences) = ([0; 3], Vec::new());
    for _ in 0..count {
        let start = *bytes;
        bytes.differences(3, &mut differences)?;
        last = std::array::from_fn(|i| restored(last[i], differences[i]));
        let position = Vec3::from_array(last.map(f32::from_bits));
        start.must(position.is_finite(), "a position must be finite")?;
        state.push_position(position);
    }
    Ok(())
}

fn read_wedges(bytes: &mut Bytes, count: usize, state: &mut State) -> Result<(), Fault> {
    let mut expected = 0;
    for _ in 0..count {
        let start = *bytes;
        let position = near(bytes, expected)?;
        start.must(
            (position as usize) < state.positions.len(),
            "a wedge must be at a position that is there",
        )?;
        state.wedges.push(position);
        expected = position + 1;
    }
    let (mut last, mut differences) = (vec![0; state.width], Vec::new());
    for _ in 0..if state.width > 0 { count } else { 0 } {
        bytes.differences(state.width, &mut differences)?;
        last.iter_mut().zip(&differences).for_each(|(word, &d)| *word = restored(*word, d));
        state.rows.extend_from_slice(&last);
    }
    Ok(())
}

fn read_triangles(bytes: &mut Bytes, count: usize, state: &mut State) -> Result<(), Fault> {
    bytes.must(count <= MOST_TRIANGLES, "there must not be more than 268435456 triangles")?;
    let (mut expected, mut group) = (0, 0);
    for _ in 0..count {
        let start = *bytes;
        let mut corners = [0; 3];
        for corner in &mut corners {
            *corner = near(bytes, expected)?;
            start.must((*corner as usize) < state.wedges.len(), "a corner must be a wedge that is there")?;
            expected = *corner;
        }
        group = near(bytes, group)?;
        start.must((group as usize) < state.kinds, "a group must be one of those named")?;
        let positions = corners.map(|wedge| state.wedges[wedge as usize]);
        start.must(is_proper(positions), "a triangle must have three positions")?;
        state.push_triangle(corners, group);
    }
    Ok(())
}
