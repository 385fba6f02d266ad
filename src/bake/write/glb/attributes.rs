//! Attributes as glTF allows them. Rows that keep its rules stay as they are, bit by bit.

use glam::{Vec2, Vec3, Vec4};

use super::primitive::Vertices;
use crate::bake::mesh::Skin;

/// How far a length may be from 1: normals are often stored in 8 bits a part, and the Khronos validator allows 0.0067.
const UNIT_TOLERANCE: f32 = 5e-3;

/// How far the sum of weights may be from 1, per weight that is not 0, as the specification says.
const WEIGHT_TOLERANCE: f64 = 2e-7;

/// Unit vectors, those that are missing from the triangles; `None` where all are.
pub(super) fn normals(vertices: &Vertices<'_>) -> Option<Vec<[f32; 3]>> {
    let column = &vertices.mesh.normals;
    if column.is_empty() {
        return None;
    }
    let mut normals: Vec<Option<Vec3>> = vertices.rows(column).map(unit).collect();
    if normals.iter().all(Option::is_none) {
        return None;
    }
    for corners in vertices.indices.as_chunks::<3>().0 {
        if corners.iter().any(|&v| normals[v as usize].is_none()) {
            let flat = face_normal(vertices, corners);
            corners.iter().for_each(|&v| _ = normals[v as usize].get_or_insert(flat));
        }
    }
    Some(normals.into_iter().map(|n| n.unwrap_or(Vec3::Z).to_array()).collect())
}

/// Any direction for a triangle without area.
fn face_normal(vertices: &Vertices<'_>, corners: &[u32; 3]) -> Vec3 {
    let position = |v: u32| {
        let position = vertices.mesh.wedges[vertices.wedges[v as usize]];
        vertices.mesh.positions[position as usize].as_dvec3()
    };
    let [a, b, c] = corners.map(position);
    (b - a).cross(c - a).try_normalize().map_or(Vec3::Z, |n| n.as_vec3())
}

/// Unit vectors and ±1, those that are missing across the normal; `None` where all are.
pub(super) fn tangents(vertices: &Vertices<'_>, normals: &[[f32; 3]]) -> Option<Vec<[f32; 4]>> {
    let column = &vertices.mesh.tangents;
    if column.is_empty() || vertices.rows(column).all(|t| unit(t.truncate()).is_none()) {
        return None;
    }
    let tangent = |(t, &normal): (Vec4, &[f32; 3])| {
        let across = || Vec3::from(normal).any_orthonormal_vector();
        let along = unit(t.truncate()).unwrap_or_else(across);
        along.extend(if t.w < 0.0 { -1.0 } else { 1.0 }).to_array()
    };
    Some(vertices.rows(column).zip(normals).map(tangent).collect())
}

/// A vector of length 1; `None` for one that has no direction.
pub(super) fn unit(v: Vec3) -> Option<Vec3> {
    let length = v.length();
    if (length - 1.0).abs() <= UNIT_TOLERANCE {
        Some(v)
    } else {
        v.as_dvec3().try_normalize().map(|v| v.as_vec3())
    }
}

/// As they are, 0 for what is no number.
pub(super) fn uvs(vertices: &Vertices<'_>, column: &[Vec2]) -> Vec<[f32; 2]> {
    let finite = |uv: Vec2| uv.to_array().map(|x| if x.is_finite() { x } else { 0.0 });
    vertices.rows(column).map(finite).collect()
}

/// From 0 to 1, 1 for what is no number; `None` where there are none.
pub(super) fn colours(vertices: &Vertices<'_>) -> Option<Vec<[f32; 4]>> {
    let column = &vertices.mesh.colours;
    let within = |c: Vec4| c.to_array().map(|x| if x.is_nan() { 1.0 } else { x.clamp(0.0, 1.0) });
    (!column.is_empty()).then(|| vertices.rows(column).map(within).collect())
}

/// Joints and weights; `None` where nothing is moved by any.
pub(super) fn skins(vertices: &Vertices<'_>) -> Option<Vec<Skin>> {
    let column = &vertices.mesh.skins;
    if column.is_empty() || vertices.rows(column).all(|skin| skin == Skin::default()) {
        return None;
    }
    Some(vertices.rows(column).map(valid_skin).collect())
}

/// Weights ≥ 0 that add up to 1, each joint once, and joint 0 where the weight is 0. What nothing moves is moved by
/// joint 0.
fn valid_skin(skin: Skin) -> Skin {
    let (mut joints, mut weights) = ([0; 4], [0.0; 4]);
    for (i, (joint, weight)) in skin.joints.into_iter().zip(skin.weights).enumerate() {
        if weight > 0.0 && weight.is_finite() {
            let before = (0..i).find(|&j| weights[j] > 0.0 && joints[j] == joint).unwrap_or(i);
            joints[before] = joint;
            weights[before] += f64::from(weight);
        }
    }
    let used = weights.iter().filter(|&&w| w > 0.0).count();
    let sum: f64 = weights.iter().sum();
    let weights = match used {
        0 => [1.0, 0.0, 0.0, 0.0],
        _ if (sum - 1.0).abs() > WEIGHT_TOLERANCE * used as f64 => shares(weights, sum),
        _ => weights.map(|w| w as f32),
    };
    let joint = |i: usize| if weights[i] > 0.0 { joints[i] } else { 0 };
    Skin { joints: [joint(0), joint(1), joint(2), joint(3)], weights }
}

/// Shares of the sum; the greatest makes up for what rounding leaves.
fn shares(weights: [f64; 4], sum: f64) -> [f32; 4] {
    let mut shares = weights.map(|w| (w / sum) as f32);
    let most = (0..4).fold(0, |most, i| if shares[i] > shares[most] { i } else { most });
    let others: f64 = (0..4).filter(|&i| i != most).map(|i| f64::from(shares[i])).sum();
    shares[most] = (1.0 - others) as f32;
    shares
}
