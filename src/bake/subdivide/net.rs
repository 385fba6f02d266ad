//! What values are subdivided on: faces, edges, and how sharp they are.

/// The topology of a polygon mesh. Positions have one; so has every attribute, which is torn along its seams.
///
/// A vertex keeps its index in all finer nets: their vertices are those of this one, then one per edge, then (of
/// Catmull and Clark's) one per face.
#[derive(Clone, Debug)]
pub(super) struct Net {
    /// Per face, where its corners end.
    pub ends: Vec<u32>,
    /// Vertices, face after face.
    pub corners: Vec<u32>,
    /// Per corner, the edge from it to the next one of its face.
    pub edge_of: Vec<u32>,
    pub edges: Vec<Edge>,
    /// Per vertex, its own, beside that of its edges.
    pub sharpness: Vec<f32>,
    /// Per vertex, how many edges it has.
    pub valence: Vec<u32>,
}

/// An edge, whatever its number of faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub ends: [u32; 2],
    /// Two of its faces; only where there are two.
    pub faces: [u32; 2],
    /// How many there are.
    pub sides: u32,
    /// Infinite where there are not two.
    pub sharpness: f32,
}

impl Edge {
    /// Its faces are not known yet.
    pub fn new(ends: [u32; 2], sharpness: f32) -> Self {
        Self { ends, faces: [0; 2], sides: 0, sharpness }
    }

    /// The end that is not this one.
    pub fn other(&self, end: u32) -> u32 {
        self.ends[usize::from(self.ends[0] == end)]
    }
}

/// How a vertex moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// As the surface around it has it.
    Smooth,
    /// As the curve through these two neighbours has it.
    Crease([u32; 2]),
    /// Not at all.
    Corner,
}

impl Net {
    /// The net of these faces. `edges` are as `edge_of` names them; whose faces they are is found out.
    pub fn new(
        ends: Vec<u32>,
        corners: Vec<u32>,
        edge_of: Vec<u32>,
        mut edges: Vec<Edge>,
        sharpness: Vec<f32>,
    ) -> Self {
        let mut face = 0;
        for (corner, &edge) in edge_of.iter().enumerate() {
            face += usize::from(corner == ends[face] as usize);
            let edge = &mut edges[edge as usize];
            if let Some(side) = edge.faces.get_mut(edge.sides as usize) {
                *side = face as u32;
            }
            edge.sides += 1;
        }
        let mut valence = vec![0; sharpness.len()];
        for edge in &mut edges {
            edge.ends.iter().for_each(|&end| valence[end as usize] += 1);
            edge.sharpness = if edge.sides == 2 { edge.sharpness } else { f32::INFINITY };
        }
        Self { ends, corners, edge_of, edges, sharpness, valence }
    }

    /// The smooth net of these faces, its edges in the order of their ends.
    pub fn of_faces(vertices: usize, ends: Vec<u32>, corners: Vec<u32>) -> Self {
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(corners.len());
        let mut start = 0;
        for &end in &ends {
            let face = &corners[start as usize..end as usize];
            let nexts = face.iter().cycle().skip(1);
            let pairs = face.iter().zip(nexts).map(|(&a, &b)| [a.min(b), a.max(b)]);
            sides.extend(pairs.zip(start..));
            start = end;
        }
        sides.sort_unstable();
        let (mut edges, mut edge_of) = (Vec::new(), vec![0; corners.len()]);
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            same.iter().for_each(|&(_, corner)| edge_of[corner as usize] = edges.len() as u32);
            edges.push(Edge::new(same[0].0, 0.0));
        }
        Self::new(ends, corners, edge_of, edges, vec![0.0; vertices])
    }

    pub fn face_count(&self) -> usize {
        self.ends.len()
    }

    /// Where a face's corners are.
    pub fn span(&self, face: usize) -> std::ops::Range<usize> {
        let start = face.checked_sub(1).map_or(0, |before| self.ends[before]);
        start as usize..self.ends[face] as usize
    }

    /// A face's vertices.
    pub fn face(&self, face: usize) -> &[u32] {
        &self.corners[self.span(face)]
    }

    /// How every vertex moves where all that is sharper than `worn` is sharp: 0 for this subdivision, 1 for the next,
    /// [`f32::MAX`] for the limit. Two sharp edges make a crease, three a corner.
    pub fn rules(&self, worn: f32) -> Vec<Rule> {
        let mut sharp = vec![(0_u32, [0_u32; 2]); self.sharpness.len()];
        for edge in self.edges.iter().filter(|edge| edge.sharpness > worn) {
            for end in edge.ends {
                let (count, others) = &mut sharp[end as usize];
                if let Some(other) = others.get_mut(*count as usize) {
                    *other = edge.other(end);
                }
                *count += 1;
            }
        }
        let rule = |(vertex, (count, others)): (usize, (u32, [u32; 2]))| match count {
            _ if self.sharpness[vertex] > worn || self.valence[vertex] == 0 => Rule::Corner,
            0 | 1 => Rule::Smooth,
            2 => Rule::Crease(others),
            _ => Rule::Corner,
        };
        sharp.into_iter().enumerate().map(rule).collect()
    }

    /// Per vertex, the mean sharpness of what is smooth after this subdivision and is not yet; 0 where nothing is.
    pub fn fading(&self) -> Vec<f64> {
        let fades = |sharpness: f32| sharpness > 0.0 && sharpness <= 1.0;
        let own = |&sharpness: &f32| if fades(sharpness) { (f64::from(sharpness), 1.0) } else { (0.0, 0.0) };
        let mut sums: Vec<(f64, f64)> = self.sharpness.iter().map(own).collect();
        for edge in self.edges.iter().filter(|edge| fades(edge.sharpness)) {
            for end in edge.ends {
                let (sum, count) = &mut sums[end as usize];
                (*sum, *count) = (*sum + f64::from(edge.sharpness), *count + 1.0);
            }
        }
        sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 0.0 }).collect()
    }

    /// The greatest sharpness that is not for ever; 0 where there is none.
    pub fn fleeting(&self) -> f32 {
        let all = self.edges.iter().map(|edge| edge.sharpness).chain(self.sharpness.iter().copied());
        all.filter(|sharpness| sharpness.is_finite()).fold(0.0, f32::max)
    }

    /// Holds the vertices at which the surface is none: where several fans touch, and where an edge of more than two
    /// faces ends within.
    pub fn hold_non_manifold(&mut self) {
        let fans = self.fans();
        let mut forever = vec![0_u32; self.sharpness.len()];
        let mut branches = vec![false; self.sharpness.len()];
        for edge in self.edges.iter().filter(|edge| edge.sharpness == f32::INFINITY) {
            for end in edge.ends {
                forever[end as usize] += 1;
                branches[end as usize] |= edge.sides > 2;
            }
        }
        for (vertex, sharpness) in self.sharpness.iter_mut().enumerate() {
            if fans[vertex] > 1 || branches[vertex] && forever[vertex] < 2 {
                *sharpness = f32::INFINITY;
            }
        }
    }

    /// Holds all vertices of borders.
    pub fn hold_borders(&mut self) {
        for edge in self.edges.iter().filter(|edge| edge.sides != 2) {
            edge.ends.iter().for_each(|&end| self.sharpness[end as usize] = f32::INFINITY);
        }
    }

    /// Per vertex, into how many parts its faces fall that hang together through its edges. A forest of the ends of
    /// edges, which faces join.
    fn fans(&self) -> Vec<u32> {
        let mut above: Vec<u32> = (0..2 * self.edges.len() as u32).collect();
        let root = |above: &mut [u32], mut end: u32| {
            while above[end as usize] != end {
                above[end as usize] = above[above[end as usize] as usize];
                end = above[end as usize];
            }
            end
        };
        for face in 0..self.face_count() {
            let span = self.span(face);
            let mut before = self.edge_of[span.end - 1];
            for corner in span {
                let (vertex, edge) = (self.corners[corner], self.edge_of[corner]);
                let (a, b) = (self.end_at(before, vertex), self.end_at(edge, vertex));
                let (a, b) = (root(&mut above, a), root(&mut above, b));
                above[a.max(b) as usize] = a.min(b);
                before = edge;
            }
        }
        let mut fans = vec![0; self.sharpness.len()];
        let roots = above.iter().enumerate().filter(|&(end, &above)| end == above as usize);
        roots.for_each(|(end, _)| fans[self.edges[end / 2].ends[end % 2] as usize] += 1);
        fans
    }

    /// The number of an edge's end at a vertex, which is also that of the half there once the edge is cut in two.
    pub fn end_at(&self, edge: u32, vertex: u32) -> u32 {
        2 * edge + u32::from(self.edges[edge as usize].ends[1] == vertex)
    }

    /// The halves of all edges once they are cut in two, one subdivision less sharp.
    pub fn halves(&self) -> impl Iterator<Item = Edge> + '_ {
        let vertices = self.sharpness.len() as u32;
        self.edges.iter().enumerate().flat_map(move |(i, edge)| {
            let middle = vertices + i as u32;
            edge.ends.map(|end| Edge::new([end, middle], worn(edge.sharpness)))
        })
    }

    /// The sharpness of vertices that stay, one subdivision later.
    pub fn worn_sharpness(&self) -> impl Iterator<Item = f32> + '_ {
        self.sharpness.iter().copied().map(worn)
    }
}

/// A sharpness after one subdivision.
fn worn(sharpness: f32) -> f32 {
    (sharpness - 1.0).max(0.0)
}
