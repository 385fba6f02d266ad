//! How alike two wedges look.

use crate::bake::{Mesh, Skin};

/// How different two wedges look: the sum of squared differences of their attributes, places left out. Normals, colours
/// and skinning are of order 1 by nature; texture coordinates are where a texture is used once.
pub(super) fn difference(mesh: &Mesh, a: u32, b: u32) -> f32 {
    let (a, b) = (a as usize, b as usize);
    let far = |column: &[glam::Vec4]| column.get(a).map_or(0.0, |v| v.distance_squared(column[b]));
    let turned = mesh.normals.get(a).map_or(0.0, |n| n.distance_squared(mesh.normals[b]));
    let moved: f32 = mesh.uvs.iter().map(|set| set[a].distance_squared(set[b])).sum();
    let bound = mesh.skins.get(a).map_or(0.0, |skin| apart(skin, &mesh.skins[b]));
    turned + moved + far(&mesh.colours) + bound
}

/// The squared difference of two skinnings, as vectors of a weight per joint.
pub(super) fn apart(a: &Skin, b: &Skin) -> f32 {
    let weight = |skin: &Skin, joint: u16| -> f32 {
        skin.joints.iter().zip(skin.weights).filter(|&(j, _)| *j == joint).map(|(_, w)| w).sum()
    };
    let only_in = |a: &Skin, b: &Skin, joint: u16| weight(b, joint) == 0.0 && weight(a, joint) != 0.0;
    let mut sum = 0.0;
    for (slot, &joint) in a.joints.iter().enumerate() {
        let is_first = !a.joints[..slot].contains(&joint);
        sum += if is_first { (weight(a, joint) - weight(b, joint)).powi(2) } else { 0.0 };
    }
    for (slot, &joint) in b.joints.iter().enumerate() {
        let is_new = !b.joints[..slot].contains(&joint) && !a.joints.contains(&joint);
        sum += if is_new && only_in(b, a, joint) { weight(b, joint).powi(2) } else { 0.0 };
    }
    sum
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;

    #[test]
    fn skins_are_compared_joint_by_joint() {
        let skin = |joints, weights| Skin { joints, weights };
        let arm = skin([3, 4, 0, 0], [0.75, 0.25, 0.0, 0.0]);
        assert_eq!(apart(&arm, &skin([4, 3, 9, 0], [0.25, 0.75, 0.0, 0.0])), 0.0);
        assert_eq!(apart(&arm, &skin([4, 5, 0, 0], [0.25, 0.75, 0.0, 0.0])), 2.0 * 0.75 * 0.75);
        assert_eq!(apart(&arm, &skin([0, 3, 4, 0], [0.5, 0.25, 0.25, 0.0])), 0.5);
    }

    #[test]
    fn columns_that_are_there_count() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO],
            wedges: vec![0, 0],
            normals: vec![Vec3::X, Vec3::Y],
            uvs: vec![vec![Vec2::ZERO, Vec2::ONE]],
            ..Mesh::default()
        };
        assert_eq!((difference(&mesh, 0, 1), difference(&mesh, 1, 1)), (4.0, 0.0));
    }
}
