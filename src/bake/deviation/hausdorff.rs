//! The Hausdorff distance from above: branch and bound over pieces of triangles.

use std::collections::BinaryHeap;

use super::Options;
use super::overlay::{Cell, MOST_CORNERS, Overlay};
use super::piece::Piece;
use super::shape::Shape;

/// A share of the largest coordinate that is more than all rounding can come to.
///
/// A corner of a piece is off the triangle by three units in the last place (2⁻⁵³ of the largest coordinate) per axis
/// and cut, 6 · 2⁻⁵³ in length, and no piece is cut more than [`MOST_CUTS`] times: 3e-13. A distance is off by less
/// than 50 units. Cells of an overlay leave no point of a triangle farther from them than 4e-15 · 4 / 0.02, 8e-13.
/// Distance to a set changes no faster than the point moves.
const SLACK: f64 = 1e-11;

/// Pieces that were cut so often are left as they are.
const MOST_CUTS: u16 = 400;

/// A search may take as many splits as one of so many triangles, however small the surfaces.
const FEW_TRIANGLES: usize = 1 << 16;

/// What is known of the Hausdorff distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    /// The largest distance found.
    pub attained: f64,
    /// No distance is larger, over all that was searched.
    pub bound: f64,
    /// Pieces split.
    pub splits: usize,
}

impl Extent {
    /// Nothing searched, but a distance found.
    pub(super) fn at_least(attained: f64) -> Self {
        Self { attained, bound: attained, splits: 0 }
    }
}

/// Bounds the distance of all points of `from` to `to`, and with it what `known` bounds.
///
/// After M. Guthe, P. Borodin, R. Klein, "Fast and accurate Hausdorff distance calculation between meshes", 2005, and
/// M. Tang, M. Lee, Y. J. Kim, "Interactive Hausdorff distance computation for general polygonal models", 2009: pieces
/// in the order of their upper bounds, until no bound exceeds the largest distance found by more than is allowed. We
/// depart from them in where pieces are cut ([`Piece::cut`]) and in not looking closely where the other direction is
/// larger.
pub(super) fn bound(from: &Shape, to: &Shape, known: Extent, options: &Options) -> Extent {
    let mut search = Search::new(from, to, known, options);
    let open = search.visit_vertices();
    let triangles = (from.corners.len() + to.corners.len()).max(FEW_TRIANGLES);
    let most_splits = options.max_splits.saturating_mul(triangles);
    search.cover_triangles(&open, most_splits);
    search.refine(most_splits);
    search.extent(known)
}

struct Search<'a> {
    from: &'a Shape,
    to: &'a Shape,
    relative: f64,
    absolute: f64,
    /// The largest distance found.
    attained: f64,
    /// The square of the distance that is close enough to it: what is bounded by that needs no closer look.
    close2: f64,
    /// The largest squared bound of what was not looked at more closely.
    left2: f64,
    splits: usize,
    /// For each vertex the triangle nearest to it, if it was visited.
    near: Vec<u32>,
    /// What is to be looked at: the bits of the squared bound (which order as the numbers do), and the slot of the
    /// piece.
    queue: BinaryHeap<(u64, u32)>,
    pieces: Vec<Piece>,
    free: Vec<u32>,
}

/// The vertex has not been visited.
const UNSEEN: u32 = u32::MAX;

impl<'a> Search<'a> {
    fn new(from: &'a Shape, to: &'a Shape, known: Extent, options: &Options) -> Self {
        let mut search = Self {
            from,
            to,
            relative: options.relative,
            absolute: options.of_diagonal * smaller_diagonal(from, to),
            attained: 0.0,
            close2: 0.0,
            left2: 0.0,
            splits: 0,
            near: vec![UNSEEN; from.vertex_count],
            queue: BinaryHeap::new(),
            pieces: Vec::new(),
            free: Vec::new(),
        };
        search.raise(known.attained);
        search
    }

    /// Takes note of a distance that was found.
    fn raise(&mut self, distance: f64) {
        if distance >= self.attained {
            self.attained = distance;
            let close = distance + (distance * self.relative).max(self.absolute);
            self.close2 = close * close;
        }
    }

    /// Finds what is nearest to the vertices, and with it most of what distances there are; returns the triangles that
    /// call for a closer look.
    ///
    /// Where the triangle found last is close enough to all of the next one, as it mostly is where surfaces resemble each
    /// other, no vertex of that can be far away, and none is looked up.
    fn visit_vertices(&mut self) -> Vec<u32> {
        let (from, mut hint, mut open) = (self.from, 0, Vec::new());
        for (triangle, (&corners, vertices)) in (0..).zip(from.corners.iter().zip(&from.triangles)) {
            if self.settles(&Piece { corners, near: [hint; 3], also: hint, depth: 0 }) {
                continue;
            }
            for (&corner, &vertex) in corners.iter().zip(vertices) {
                if self.near[vertex as usize] == UNSEEN {
                    let nearest = self.to.bvh.nearest(corner, hint);
                    self.near[vertex as usize] = nearest.triangle;
                    self.raise(nearest.distance2.sqrt());
                }
                hint = self.near[vertex as usize];
            }
            open.push(triangle);
        }
        open
    }

    /// Looks at triangles whose vertices were visited: first at what is near to their corners, then at what is near to
    /// their centre.
    fn cover_triangles(&mut self, triangles: &[u32], most: usize) {
        let mut overlay = Overlay::new(self.to, self.from.reach.max(self.to.reach));
        for &triangle in triangles {
            let corners = self.from.corners[triangle as usize];
            let near = self.from.triangles[triangle as usize].map(|vertex| self.near[vertex as usize]);
            let mut piece = Piece { corners, near, also: near[0], depth: 0 };
            if self.settles(&piece) {
                continue;
            }
            let nearest = self.to.bvh.nearest(piece.center(), near[0]);
            self.raise(nearest.distance2.sqrt());
            piece.also = nearest.triangle;
            if !self.settles(&piece) && !self.settles_in_cells(&piece, &mut overlay, most) {
                self.consider(piece);
            }
        }
    }

    /// Lays a triangle over the other surface and takes the cells that are not close enough into the queue; false where
    /// it cannot be laid over it.
    fn settles_in_cells(&mut self, piece: &Piece, overlay: &mut Overlay, most: usize) -> bool {
        let (mut left2, mut far) = (self.left2, Vec::new());
        let (bvh, close2) = (&self.to.bvh, self.close2);
        let mut visited = 0;
        let cells = overlay.lay(&piece.corners, piece.also, most.saturating_sub(self.splits), |cell| {
            visited += 1;
            let distances2 = cell.corners().iter().map(|&corner| bvh.distance2(cell.triangle, corner));
            match distances2.fold(0.0, f64::max) {
                most2 if most2 <= close2 => left2 = left2.max(most2),
                _ => far.push(*cell),
            }
        });
        self.splits += visited;
        if cells.is_some() {
            self.left2 = left2;
            far.iter().for_each(|cell| self.consider_cell(cell));
        }
        cells.is_some()
    }

    /// Takes a cell into the queue as a fan of pieces.
    fn consider_cell(&mut self, cell: &Cell) {
        let mut near = [cell.triangle; MOST_CORNERS];
        for (near, &corner) in near.iter_mut().zip(cell.corners()) {
            let nearest = self.to.bvh.nearest(corner, cell.triangle);
            self.raise(nearest.distance2.sqrt());
            *near = nearest.triangle;
        }
        for k in 2..cell.corners().len() {
            let pick = [0, k - 1, k];
            let (corners, near) = (pick.map(|i| cell.corners()[i]), pick.map(|i| near[i]));
            self.consider(Piece { corners, near, also: cell.triangle, depth: 0 });
        }
    }

    /// Whether a piece is close enough by the nearest triangles of its corners.
    fn settles(&mut self, piece: &Piece) -> bool {
        let most2 = piece.cover(&self.to.bvh).most2();
        let settled = most2 <= self.close2;
        self.left2 = if settled { self.left2.max(most2) } else { self.left2 };
        settled
    }

    /// Puts a piece into the queue unless it is close enough.
    fn consider(&mut self, piece: Piece) {
        let most2 = piece.cover(&self.to.bvh).most2();
        if most2 <= self.close2 || piece.depth >= MOST_CUTS {
            self.left2 = self.left2.max(most2);
            return;
        }
        let slot = match self.free.pop() {
            Some(slot) => {
                self.pieces[slot as usize] = piece;
                slot
            }
            None => {
                self.pieces.push(piece);
                self.pieces.len() as u32 - 1
            }
        };
        self.queue.push((most2.to_bits(), slot));
    }

    /// Splits pieces, that with the largest bound first, until all are close enough or `most` were split.
    fn refine(&mut self, most: usize) {
        while let Some((bits, slot)) = self.queue.pop() {
            let most2 = f64::from_bits(bits);
            if most2 <= self.close2 || self.splits >= most {
                self.left2 = self.left2.max(most2);
                return;
            }
            self.free.push(slot);
            self.split(self.pieces[slot as usize]);
        }
    }

    fn split(&mut self, piece: Piece) {
        self.splits += 1;
        let cut = piece.cut(&piece.cover(&self.to.bvh), &self.to.bvh, self.close2);
        let nearest = self.to.bvh.nearest(cut.point, cut.covers[0]);
        self.raise(nearest.distance2.sqrt());
        for part in piece.parts(&cut, nearest.triangle) {
            self.consider(part);
        }
    }

    fn extent(&self, known: Extent) -> Extent {
        let slack = SLACK * self.from.reach.max(self.to.reach);
        let bound = (self.left2.sqrt().max(self.attained) + slack).max(known.bound);
        Extent { attained: (self.attained - slack).max(0.0), bound, splits: known.splits + self.splits }
    }
}

/// The smaller diagonal, unless it is that of a point.
fn smaller_diagonal(a: &Shape, b: &Shape) -> f64 {
    let least = a.diagonal.min(b.diagonal);
    if least > 0.0 { least } else { a.diagonal.max(b.diagonal) }
}
