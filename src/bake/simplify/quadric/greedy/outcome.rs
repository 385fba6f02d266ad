//! After a run: the mesh that is left.

use super::{GONE, Greedy};
use crate::bake::simplify::rebuild::{Corner, Facet, Rebuilt};
use crate::bake::simplify::{Simplified, Stopped};

impl Greedy<'_> {
    /// What is left by now.
    pub(in crate::bake::simplify::quadric) fn finish(&self, stopped: Stopped) -> Simplified {
        let left: Vec<usize> = (0..self.triangles.len()).filter(|&t| self.triangles[t] != GONE).collect();
        let wedges = self.wedges(&left);
        let facet = |(&t, wedges): (&usize, &[u32; 3])| self.facet(t, wedges);
        let facets: Vec<Facet> = left.iter().zip(&wedges).map(facet).collect();
        let mut rebuilt = Rebuilt::new(self.task.mesh, &self.positions(), facets);
        if let Some(layers) = &self.layers {
            layers.write(&self.corners(&left, &wedges, &rebuilt.wedges), &mut rebuilt.mesh);
        }
        let Rebuilt { mesh, vertices, wedges: wedge_origins, position_of } = rebuilt;
        let origins = vertices.iter().map(|&v| self.origins[v as usize]).collect();
        let heirs = self.old_heirs(&position_of);
        Simplified { mesh, origins, wedge_origins, heirs, error: self.in_units(self.error), stopped }
    }

    /// Per triangle that is left, the old wedges whose attributes its corners have.
    fn wedges(&self, left: &[usize]) -> Vec<[u32; 3]> {
        let old = |&t: &usize| self.task.mesh.triangles[self.old_triangles[t] as usize];
        match &self.layers {
            Some(layers) => layers.looks(self.around(), left, &self.origins),
            None => left.iter().map(old).collect(),
        }
    }

    /// Per old wedge of a list, a triangle that is left and a corner of it that stands for it.
    fn corners(&self, left: &[usize], wedges: &[[u32; 3]], of: &[u32]) -> Vec<(usize, usize)> {
        let mut corner_of = vec![(0, 0); self.task.mesh.wedges.len()];
        for (&triangle, wedges) in left.iter().zip(wedges) {
            for (corner, &wedge) in wedges.iter().enumerate() {
                corner_of[wedge as usize] = (triangle, corner);
            }
        }
        of.iter().map(|&wedge| corner_of[wedge as usize]).collect()
    }

    fn facet(&self, triangle: usize, wedges: &[u32; 3]) -> Facet {
        let vertices = self.triangles[triangle];
        let corner = |i| Corner { vertex: vertices[i], wedge: wedges[i] };
        Facet { old: self.old_triangles[triangle], corners: [corner(0), corner(1), corner(2)] }
    }

    /// Per old vertex, the new index of its last heir.
    fn old_heirs(&self, new: &[u32]) -> Vec<u32> {
        let mut heirs = vec![Simplified::GONE; self.task.mesh.positions.len()];
        let mut last = self.heirs.clone();
        for (vertex, &old) in self.order.iter().enumerate() {
            // An heir is lower, so its own is known already.
            last[vertex] = last[last[vertex] as usize];
            heirs[old as usize] = new[last[vertex] as usize];
        }
        heirs
    }
}
