//! meshoptimizer, by the crate `meshopt`, which compiles its C++. Both functions stop at no error.

use std::error::Error;
use std::time::Duration;

use glam::Vec3;
use lod_budget::bake::Surface;
use meshopt::{SimplifyOptions, VertexDataAdapter, typed_to_bytes};

use crate::timed;

/// What no error of a mesh reaches: errors are relative to its extent.
const ANY_ERROR: f32 = 1e9;

/// `meshopt_simplifyWithUpdate` without attributes: kept vertices move to where the error is least.
pub fn moving_vertices(surface: &Surface, triangles: usize) -> Result<(Surface, Duration), Box<dyn Error>> {
    let mut indices = surface.triangles.as_flattened().to_vec();
    let mut positions: Vec<[f32; 3]> = surface.positions.iter().map(Vec3::to_array).collect();
    let none = SimplifyOptions::None;
    let (count, time) = timed(|| {
        let (indices, positions) = (&mut indices, &mut positions);
        meshopt::simplify_with_update(
            indices,
            positions,
            &mut [],
            &[],
            0,
            None,
            3 * triangles,
            ANY_ERROR,
            none,
            None,
        )
    });
    indices.truncate(count);
    let positions = positions.into_iter().map(Vec3::from_array).collect();
    Ok((Surface { positions, triangles: indices.as_chunks().0.to_vec() }, time))
}

/// `meshopt_simplify`: the vertices are some of the old ones.
pub fn keeping_vertices(surface: &Surface, triangles: usize) -> Result<(Surface, Duration), Box<dyn Error>> {
    let positions: Vec<[f32; 3]> = surface.positions.iter().map(Vec3::to_array).collect();
    let vertices = VertexDataAdapter::new(typed_to_bytes(&positions), size_of::<[f32; 3]>(), 0)?;
    let indices = surface.triangles.as_flattened();
    let none = SimplifyOptions::None;
    let (indices, time) =
        timed(|| meshopt::simplify(indices, &vertices, 3 * triangles, ANY_ERROR, none, None));
    let triangles = indices.as_chunks().0.to_vec();
    Ok((Surface { positions: surface.positions.clone(), triangles }, time))
}
