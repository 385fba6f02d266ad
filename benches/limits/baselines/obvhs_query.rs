//! Culling with obvhs alone: a box query for the view's box, and each sphere in the leaves tested exactly.

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use crate::camera::Lens;
use crate::scene::Scene;

pub struct ObvhsQuery {
    bvh: Bvh2,
    spheres: Vec<[f32; 4]>,
}

impl ObvhsQuery {
    pub fn over(scene: &Scene) -> Self {
        let spheres: Vec<[f32; 4]> = (0..scene.len()).map(|i| scene.sphere(i)).collect();
        let aabb = |&[x, y, z, radius]: &[f32; 4]| {
            let center = Vec3A::new(x, y, z);
            Aabb { min: center - radius, max: center + radius }
        };
        let boxes: Vec<Aabb> = spheres.iter().map(aabb).collect();
        let bvh = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        Self { bvh, spheres }
    }

    /// Lists the objects in view.
    pub fn cull(&self, lens: &Lens, [min, max]: [[f32; 3]; 2], visible: &mut Vec<u32>) {
        visible.clear();
        let aabb = Aabb { min: Vec3A::from_array(min), max: Vec3A::from_array(max) };
        self.bvh.aabb_traverse(aabb, |bvh, node| {
            let node = &bvh.nodes[node as usize];
            let leaf = node.first_index as usize..(node.first_index + node.prim_count) as usize;
            let objects = bvh.primitive_indices[leaf].iter();
            visible.extend(objects.filter(|&&i| lens.sees(self.spheres[i as usize])));
            true
        });
    }
}
