//! What clustering works on, and the mesh that clusters make.

use glam::{DVec3, Vec3};

use crate::bake::simplify::planes::Planes;
use crate::bake::simplify::rebuild::{Corner, Facet, Rebuilt};
use crate::bake::simplify::{Progress, Simplified, Stopped, Task};
use crate::bounds::Aabb;

/// Vertices in a box whose longest side is 1, and the triangles of three of them.
pub(in crate::bake::simplify) struct Cloud<'a> {
    pub(in crate::bake::simplify) task: &'a Task<'a>,
    corner: DVec3,
    /// The box's longest side in object units.
    extent: f64,
    pub(in crate::bake::simplify) triangles: Vec<[u32; 3]>,
    /// Per triangle, its old index.
    old: Vec<u32>,
    /// Per old position, whether it may be joined with others: it is used, and not locked.
    is_free: Vec<bool>,
}

/// Which cluster each vertex is in, and where clusters are.
pub(in crate::bake::simplify) struct Clusters {
    /// Per old position; of no meaning for one that is not used.
    pub(in crate::bake::simplify) of: Vec<u32>,
    /// Per cluster, in object units.
    pub(in crate::bake::simplify) positions: Vec<Vec3>,
}

impl<'a> Cloud<'a> {
    pub(in crate::bake::simplify) fn new(task: &'a Task) -> Self {
        let mesh = task.mesh;
        let (old, triangles) = task.proper_triangles();
        let used = triangles.as_flattened().iter().map(|&v| mesh.positions[v as usize]);
        let bounds = Aabb::around(used);
        let corner = bounds.min.as_dvec3();
        let extent = (bounds.max.as_dvec3() - corner).max_element();
        let extent = if extent > 0.0 { extent } else { 1.0 };
        let mut is_free = vec![false; mesh.positions.len()];
        for &vertex in triangles.as_flattened() {
            is_free[vertex as usize] = !task.is_locked(vertex as usize);
        }
        Self { task, corner, extent, triangles, old, is_free }
    }

    /// A vertex in the box.
    #[inline]
    pub(in crate::bake::simplify) fn place(&self, vertex: u32) -> DVec3 {
        (self.task.mesh.positions[vertex as usize].as_dvec3() - self.corner) / self.extent
    }

    /// Whether a vertex may be joined with others: it is used, and not locked.
    #[inline]
    pub(in crate::bake::simplify) fn is_free(&self, vertex: u32) -> bool {
        self.is_free[vertex as usize]
    }

    /// The position of a place in the box.
    pub(in crate::bake::simplify) fn position_at(&self, place: DVec3) -> Vec3 {
        (self.corner + place * self.extent).as_vec3()
    }

    /// A length of the box in object units.
    pub(in crate::bake::simplify) fn in_units(&self, length: f64) -> f64 {
        length * self.extent
    }

    /// How far things have come with so many triangles.
    pub(in crate::bake::simplify) fn progress(&self, triangles: usize) -> Progress {
        Progress { from: self.triangles.len(), triangles, target: self.task.target.triangles }
    }

    /// The weight of a triangle.
    pub(in crate::bake::simplify) fn weight_of(&self, triangle: usize) -> f64 {
        self.task.weight(self.old[triangle] as usize)
    }

    /// The plane of a triangle, counted by its weight and area.
    pub(in crate::bake::simplify) fn plane_of(&self, triangle: usize) -> Planes {
        Planes::of(self.triangles[triangle].map(|v| self.place(v)), self.weight_of(triangle))
    }

    /// Each vertex a cluster of its own.
    pub(in crate::bake::simplify) fn singles(&self) -> Clusters {
        let positions = self.task.mesh.positions.clone();
        Clusters { of: (0..positions.len() as u32).collect(), positions }
    }

    /// The largest distance from a vertex to its cluster, in object units.
    pub(in crate::bake::simplify) fn farthest(&self, clusters: &Clusters) -> f32 {
        let far = |&v: &u32| self.away(v, clusters);
        self.triangles.as_flattened().iter().map(far).fold(0.0, f64::max).sqrt() as f32
    }

    /// The squared distance from a vertex to its cluster, in object units.
    fn away(&self, vertex: u32, clusters: &Clusters) -> f64 {
        let position = clusters.positions[clusters.of[vertex as usize] as usize];
        position.as_dvec3().distance_squared(self.task.mesh.positions[vertex as usize].as_dvec3())
    }

    /// The mesh of the triangles whose corners are in three clusters, each only once.
    pub(in crate::bake::simplify) fn finish(
        self,
        clusters: &Clusters,
        error: f32,
        is_cancelled: bool,
    ) -> Simplified {
        let facets = without_repeats(self.facets(clusters));
        let stopped = match facets.len() <= self.task.target.triangles {
            true => Stopped::Triangles,
            false if is_cancelled => Stopped::Cancelled,
            false => Stopped::Exhausted,
        };
        let Rebuilt { mesh, vertices, wedges, position_of } =
            Rebuilt::new(self.task.mesh, &clusters.positions, facets);
        let nearest = self.nearest(clusters);
        let mut heirs = vec![Simplified::GONE; self.task.mesh.positions.len()];
        for &vertex in self.triangles.as_flattened() {
            heirs[vertex as usize] = position_of[clusters.of[vertex as usize] as usize];
        }
        let origins = vertices.iter().map(|&c| nearest[c as usize]).collect();
        Simplified { mesh, origins, wedge_origins: wedges, heirs, error, stopped }
    }

    /// The vertex of each cluster that is nearest to where it is, ties by the lower index.
    fn nearest(&self, clusters: &Clusters) -> Vec<u32> {
        let mut nearest = vec![(f64::INFINITY, u32::MAX); clusters.positions.len()];
        for &vertex in self.triangles.as_flattened() {
            let best = &mut nearest[clusters.of[vertex as usize] as usize];
            let this = (self.away(vertex, clusters), vertex);
            *best = if this < *best { this } else { *best };
        }
        nearest.into_iter().map(|(_, vertex)| vertex).collect()
    }

    /// The triangles that stay.
    fn facets(&self, clusters: &Clusters) -> Vec<Facet> {
        let looks = self.looks(clusters);
        let stays = |&t: &usize| is_apart(self.triangles[t].map(|v| clusters.of[v as usize]));
        let facet = |t: usize| {
            let (vertices, old) = (self.triangles[t], self.old[t]);
            let wedges = self.task.mesh.triangles[old as usize];
            let corner = |i: usize| Corner {
                vertex: clusters.of[vertices[i] as usize],
                wedge: looks[wedges[i] as usize],
            };
            Facet { old, corners: [corner(0), corner(1), corner(2)] }
        };
        (0..self.triangles.len()).filter(stays).map(facet).collect()
    }

    /// Per wedge, the one whose attributes it gets: of those in its cluster that triangles within the cluster lead to,
    /// the nearest to where the cluster is. The sides of a seam are not led to from each other, and stay two.
    fn looks(&self, clusters: &Clusters) -> Vec<u32> {
        let mesh = self.task.mesh;
        let mut joined = Joined::new(mesh.wedges.len());
        for (&vertices, &old) in self.triangles.iter().zip(&self.old) {
            let of = vertices.map(|v| clusters.of[v as usize]);
            let wedges = mesh.triangles[old as usize];
            for (i, j) in [(0, 1), (1, 2), (2, 0)].into_iter().filter(|&(i, j)| of[i] == of[j]) {
                joined.join(wedges[i], wedges[j]);
            }
        }
        let mut best = vec![(f64::INFINITY, u32::MAX); mesh.wedges.len()];
        for &wedge in self.old.iter().flat_map(|&t| &mesh.triangles[t as usize]) {
            let this = (self.away(mesh.wedges[wedge as usize], clusters), wedge);
            let root = joined.root(wedge) as usize;
            best[root] = if this < best[root] { this } else { best[root] };
        }
        (0..mesh.wedges.len() as u32).map(|wedge| best[joined.root(wedge) as usize].1).collect()
    }
}

/// Whether three clusters are three.
#[inline]
pub(in crate::bake::simplify) fn is_apart<T: PartialEq>([a, b, c]: [T; 3]) -> bool {
    (a != b) & (b != c) & (c != a)
}

/// Keeps the first of the facets that have the same corners in the same direction.
pub(in crate::bake::simplify) fn without_repeats(facets: Vec<Facet>) -> Vec<Facet> {
    let key = |facet: &Facet| {
        let mut corners = facet.corners.map(|c| c.vertex);
        let lowest = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
        corners.rotate_left(lowest);
        corners
    };
    let mut order: Vec<([u32; 3], u32)> = (0..).zip(&facets).map(|(i, f)| (key(f), i)).collect();
    order.sort_unstable();
    let mut is_repeat = vec![false; facets.len()];
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        same[1..].iter().for_each(|&(_, i)| is_repeat[i as usize] = true);
    }
    facets.into_iter().zip(is_repeat).filter(|(_, is_repeat)| !is_repeat).map(|(f, _)| f).collect()
}

/// Things that are joined into sets, each known by its lowest member.
pub(in crate::bake::simplify) struct Joined {
    lower: Vec<u32>,
}

impl Joined {
    pub(in crate::bake::simplify) fn new(count: usize) -> Self {
        Self { lower: (0..count as u32).collect() }
    }

    /// The lowest member of a set; halves the way there for whoever asks next.
    pub(in crate::bake::simplify) fn root(&mut self, mut thing: u32) -> u32 {
        while self.lower[thing as usize] != thing {
            let next = self.lower[thing as usize];
            self.lower[thing as usize] = self.lower[next as usize];
            thing = self.lower[thing as usize];
        }
        thing
    }

    /// Joins the sets of two things; the root that is one no more, unless they were one set.
    pub(in crate::bake::simplify) fn join(&mut self, a: u32, b: u32) -> Option<u32> {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.lower[high as usize] = low;
        (low != high).then_some(high)
    }
}
