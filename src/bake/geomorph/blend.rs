//! Attributes on their way: from wedges of the coarser mesh, and between two meshes.

use std::ops::{Add, Mul, Sub};

use glam::{Vec2, Vec3, Vec4};

use crate::bake::Mesh;

/// What a wedge has its attributes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    /// A wedge of the coarser mesh.
    Wedge(u32),
    /// A point in a triangle of the coarser mesh: the wedges of its corners, and how much of each there is in it, ≥ 0
    /// with a sum of 1.
    Within { wedges: [u32; 3], weights: [f32; 3] },
}

impl Source {
    fn row<T: Copy + Add<Output = T> + Mul<f32, Output = T>>(self, column: &[T]) -> T {
        match self {
            Self::Wedge(wedge) => column[wedge as usize],
            Self::Within { wedges, weights } => {
                let [a, b, c] = wedges.map(|wedge| column[wedge as usize]);
                a * weights[0] + b * weights[1] + c * weights[2]
            }
        }
    }
}

/// Gives the target the coarser mesh's attributes, as far as both have them. Which side the bitangent of a tangent is
/// on stays as it is, since there is nothing between.
pub(super) fn take_attributes(target: &mut Mesh, coarser: &Mesh, sources: &[Option<Source>]) {
    take(&mut target.normals, &coarser.normals, sources, |_, source, column| {
        unit_unless_wedge(source, source.row(column))
    });
    take(&mut target.tangents, &coarser.tangents, sources, |own, source, column| {
        unit_unless_wedge(source, source.row(column).truncate()).extend(own.w)
    });
    take(&mut target.colours, &coarser.colours, sources, |_, source, column| source.row(column));
    for (own, coarser) in target.uvs.iter_mut().zip(&coarser.uvs) {
        take(own, coarser, sources, |_, source, column| source.row(column));
    }
}

/// Replaces the rows of a column that have a source, if the coarser mesh has the column too.
fn take<T: Copy>(
    own: &mut [T],
    coarser: &[T],
    sources: &[Option<Source>],
    row: impl Fn(T, Source, &[T]) -> T,
) {
    if !coarser.is_empty() {
        for (own, source) in own.iter_mut().zip(sources) {
            *own = source.map_or(*own, |source| row(*own, source, coarser));
        }
    }
}

/// A direction that comes from several wedges is made a unit vector, one that comes from a single wedge is as it is.
fn unit_unless_wedge(source: Source, direction: Vec3) -> Vec3 {
    match source {
        Source::Wedge(_) => direction,
        Source::Within { .. } => direction.normalize_or_zero(),
    }
}

/// How much a wedge looks unlike what it would have its attributes from, in those that both meshes have: a sum of
/// squares, of no unit.
pub(super) fn unlikeness(mesh: &Mesh, wedge: usize, other: &Mesh, source: Source) -> f32 {
    let normals = apart(&mesh.normals, &other.normals, wedge, source, Vec3::length_squared);
    let colours = apart(&mesh.colours, &other.colours, wedge, source, Vec4::length_squared);
    let sets = mesh.uvs.iter().zip(&other.uvs);
    let uvs: f32 = sets.map(|(own, other)| apart(own, other, wedge, source, Vec2::length_squared)).sum();
    normals + colours + uvs
}

/// 0 where one of the columns is empty.
fn apart<T>(own: &[T], other: &[T], wedge: usize, source: Source, square: impl Fn(T) -> f32) -> f32
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>,
{
    let own = own.get(wedge).filter(|_| !other.is_empty());
    own.map_or(0.0, |&own| square(own - source.row(other)))
}

/// The mesh between two that differ in positions and attributes alone.
pub(super) fn between(from: &Mesh, to: &Mesh, weight: f32) -> Mesh {
    let counts = |mesh: &Mesh| (mesh.positions.len(), mesh.wedges.len());
    assert_eq!(counts(from), counts(to), "the finer mesh must be the one that the geomorph is of");
    if weight >= 1.0 {
        return to.clone();
    }
    let mut mesh = from.clone();
    if weight > 0.0 {
        lead(&mut mesh.positions, &to.positions, |a, b| way(a, b, weight));
        lead(&mut mesh.normals, &to.normals, |a, b| unit_way(a, b, weight));
        let tangent = |a: Vec4, b: Vec4| unit_way(a.truncate(), b.truncate(), weight).extend(a.w);
        lead(&mut mesh.tangents, &to.tangents, tangent);
        lead(&mut mesh.colours, &to.colours, |a, b| way(a, b, weight));
        for (own, to) in mesh.uvs.iter_mut().zip(&to.uvs) {
            lead(own, to, |a: Vec2, b| way(a, b, weight));
        }
    }
    mesh
}

fn lead<T: Copy>(column: &mut [T], to: &[T], way: impl Fn(T, T) -> T) {
    column.iter_mut().zip(to).for_each(|(own, to)| *own = way(*own, *to));
}

/// As a graphics card does it with morph targets: what has nowhere to go stays, bit by bit.
fn way<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>>(from: T, to: T, weight: f32) -> T {
    from + (to - from) * weight
}

/// Between directions; one that has nowhere to go stays as it is, and one without direction is neither.
fn unit_way(from: Vec3, to: Vec3, weight: f32) -> Vec3 {
    if from == to { from } else { way(from, to, weight).normalize_or(from) }
}
