//! The faces around a vertex, side by side.

use super::net::Net;

/// Corners at a vertex whose faces hang together by edges that are not cut there, in order around it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fan {
    /// As numbers among the vertex's corners, and whether the face is turned against the order.
    pub corners: Vec<(usize, bool)>,
    /// Edges in order, corner i being between edges i and i + 1. Of a closed fan the first is the last as well, and
    /// named once.
    pub spokes: Vec<u32>,
}

/// The fans of a vertex with these corners of the net, all of whose faces have as many corners. Each goes
/// counter-clockwise where faces agree on what that is. Fans that begin at a cut come first. O(n log n).
pub(super) fn fans(net: &Net, corners: &[u32], is_cut: impl Fn(u32) -> bool) -> Vec<Fan> {
    let mut around = Around::new(net, corners);
    let mut fans = Vec::new();
    let cut_first = [(0, false), (1, false), (0, true)];
    for (end, is_anywhere) in cut_first {
        for start in 0..corners.len() {
            if is_anywhere || is_cut(around.spokes[start][end]) {
                fans.extend(around.walk(start, end, &is_cut));
            }
        }
    }
    fans
}

/// What a vertex's corners have in common.
struct Around {
    /// Per corner, the edges to the next and from the last vertex of its face.
    spokes: Vec<[u32; 2]>,
    /// Edges and their corners, in order.
    sides: Vec<(u32, usize)>,
    is_done: Vec<bool>,
}

impl Around {
    fn new(net: &Net, corners: &[u32]) -> Self {
        let sides = net.corners.len() / net.face_count();
        let before = |corner: usize| corner - corner % sides + (corner + sides - 1) % sides;
        let spokes: Vec<[u32; 2]> =
            corners.iter().map(|&c| [c as usize, before(c as usize)].map(|at| net.edge_of[at])).collect();
        let mut sides: Vec<(u32, usize)> =
            spokes.iter().enumerate().flat_map(|(corner, ends)| ends.map(|edge| (edge, corner))).collect();
        sides.sort_unstable();
        Self { is_done: vec![false; corners.len()], spokes, sides }
    }

    /// From a corner on, in at one of its edges and out at the other, until that is cut or the fan is closed.
    fn walk(&mut self, start: usize, end: usize, is_cut: impl Fn(u32) -> bool) -> Option<Fan> {
        if self.is_done[start] {
            return None;
        }
        let mut fan = Fan { corners: Vec::new(), spokes: Vec::new() };
        let (mut corner, mut entry) = (start, self.spokes[start][end]);
        loop {
            self.is_done[corner] = true;
            let [next, before] = self.spokes[corner];
            let exit = if entry == next { before } else { next };
            fan.corners.push((corner, entry != next));
            fan.spokes.push(entry);
            let beyond = self.beyond(exit, corner).filter(|_| !is_cut(exit));
            match beyond {
                None => fan.spokes.push(exit),
                Some(other) if !self.is_done[other] => {
                    (corner, entry) = (other, exit);
                    continue;
                }
                Some(_) => {}
            }
            return Some(fan);
        }
    }

    /// The other corner at an edge.
    fn beyond(&self, edge: u32, corner: usize) -> Option<usize> {
        let first = self.sides.partition_point(|&(other, _)| other < edge);
        let same = self.sides[first..].iter().take_while(|&&(other, _)| other == edge);
        same.map(|&(_, other)| other).find(|&other| other != corner)
    }
}
