//! What is around a vertex: loops of corners, cut at its feature edges.

use glam::DVec3;

use crate::bake::simplify::link::others;
use crate::bake::simplify::rebuild::Corner;
use crate::bake::simplify::workpiece::Workpiece;

/// A run of triangles around a vertex: what is left of them when the vertex goes.
pub(super) struct Sector {
    /// Counter-clockwise. All around for a vertex without features; else from one feature edge or border to the next.
    pub(super) corners: Vec<Corner>,
    pub(super) triangles: Vec<u32>,
}

/// The kinds of vertices of the paper.
pub(super) enum Kind {
    /// Surrounded by triangles, no feature edge: one loop.
    Simple(Sector),
    /// On a border, or on a feature edge that goes straight through: its ends, and the loop or the two on its sides.
    Line([u32; 2], Vec<Sector>),
    /// Where feature edges end or several meet, or surrounded by something else than one fan of triangles. Stays.
    Fixed,
}

/// A triangle around a vertex, as the side across from it.
#[derive(Clone, Copy)]
struct Side {
    from: u32,
    to: u32,
    triangle: u32,
}

impl Kind {
    /// Classifies a vertex. Edges whose triangles' normals have a cosine below `least_cosine` are features, and so are
    /// seams.
    pub(super) fn of(piece: &Workpiece, vertex: u32, least_cosine: f64) -> Self {
        let Some((sides, is_closed)) = walk(piece, vertex) else { return Self::Fixed };
        let is_feature = |i: usize| {
            let (s, t) = (sides[(i + sides.len() - 1) % sides.len()], sides[i]);
            piece.is_crease(vertex, t.from)
                || normal(piece, s.triangle).dot(normal(piece, t.triangle)) < least_cosine
        };
        let first_inside = usize::from(!is_closed);
        let features: Vec<usize> = (first_inside..sides.len()).filter(|&i| is_feature(i)).collect();
        match (is_closed, &features[..]) {
            (true, []) => Self::Simple(sector(piece, &sides, is_closed)),
            (false, []) => {
                let ends = [sides[0].from, sides[sides.len() - 1].to];
                Self::Line(ends, vec![sector(piece, &sides, false)])
            }
            (true, &[a, b]) => {
                let turned: Vec<Side> = sides[b..].iter().chain(&sides[..a]).copied().collect();
                let sectors = [&sides[a..b], &turned].map(|s| sector(piece, s, false));
                Self::Line([sides[a].from, sides[b].from], sectors.into())
            }
            _ => Self::Fixed,
        }
    }
}

/// The sides across from a vertex in order, and whether they are all around; `None` if they are not one run.
fn walk(piece: &Workpiece, vertex: u32) -> Option<(Vec<Side>, bool)> {
    let side = |&triangle: &u32| {
        let [from, to] = others(piece.triangles[triangle as usize], vertex);
        Side { from, to, triangle }
    };
    let mut sides: Vec<Side> = piece.fans.of(vertex).iter().map(side).collect();
    sides.sort_unstable_by_key(|side| (side.from, side.to));
    let has_fork = sides.windows(2).any(|pair| pair[0].from == pair[1].from);
    let starts = |v: u32| sides.binary_search_by_key(&v, |side| side.from).ok();
    let mut ends: Vec<u32> = sides.iter().map(|side| side.to).collect();
    ends.sort_unstable();
    let start = sides.iter().position(|side| ends.binary_search(&side.from).is_err());
    let mut run = vec![*sides.get(start.unwrap_or(0)).filter(|_| !has_fork)?];
    while let Some(next) = starts(run[run.len() - 1].to).filter(|_| run.len() < sides.len()) {
        run.push(sides[next]);
    }
    let is_closed = run[run.len() - 1].to == run[0].from;
    let is_whole = run.len() == sides.len() && is_closed == start.is_none();
    is_whole.then_some((run, is_closed))
}

/// The corners of a run of sides, each with the wedge it has there.
fn sector(piece: &Workpiece, sides: &[Side], is_closed: bool) -> Sector {
    let mut corners: Vec<Corner> = sides.iter().map(|side| piece.corner(side.triangle, side.from)).collect();
    if let Some(last) = sides.last().filter(|_| !is_closed) {
        corners.push(piece.corner(last.triangle, last.to));
    }
    Sector { corners, triangles: sides.iter().map(|side| side.triangle).collect() }
}

/// The unit normal of a triangle; zero if it has no area.
fn normal(piece: &Workpiece, triangle: u32) -> DVec3 {
    let [a, b, c] = piece.places(triangle);
    (b - a).cross(c - a).normalize_or_zero()
}
