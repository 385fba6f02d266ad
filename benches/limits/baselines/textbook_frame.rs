//! The frame of a textbook: a box query on a hierarchy, objects as an array of structs, and all their steps sorted as
//! structs.

use super::Selection;
use super::classes::{Classes, Hull};
use super::obvhs_query::ObvhsQuery;
use super::struct_sort::StructSort;
use crate::camera::Lens;
use crate::scene::Scene;

/// What an engine keeps of an object.
struct Item {
    sphere: [f32; 4],
    importance: f32,
    table: u16,
}

pub struct TextbookFrame<'a> {
    hulls: &'a [Hull],
    query: ObvhsQuery,
    items: Vec<Item>,
    /// What is in view, and the position that each has been given.
    pub visible: Vec<u32>,
    pub position: Vec<u8>,
    table: Vec<u16>,
    weight: Vec<f32>,
    selection: StructSort,
}

impl<'a> TextbookFrame<'a> {
    pub fn over(scene: &Scene, hulls: &'a [Hull]) -> Self {
        let item =
            |i| Item { sphere: scene.sphere(i), importance: scene.importance[i], table: scene.table[i] };
        Self {
            hulls,
            query: ObvhsQuery::over(scene),
            items: (0..scene.len()).map(item).collect(),
            visible: Vec::new(),
            position: Vec::new(),
            table: Vec::new(),
            weight: Vec::new(),
            selection: StructSort::default(),
        }
    }

    /// Chooses for everything in view, of which `aabb` is the box.
    pub fn run(&mut self, lens: &Lens, aabb: [[f32; 3]; 2], budget: u64) {
        self.query.cull(lens, aabb, &mut self.visible);
        self.table.clear();
        self.weight.clear();
        for &object in &self.visible {
            let item = &self.items[object as usize];
            self.table.push(item.table);
            self.weight.push(lens.weight(item.sphere, item.importance));
        }
        self.position.resize(self.visible.len(), 0);
        let classes = Classes { hulls: self.hulls, table: &self.table, weight: &self.weight };
        self.selection.choose(&classes, budget, &mut self.position);
    }
}
