//! What the linear relaxation says about classes that are still open: the least loss at which they take up cost, or
//! give it back.

use super::prices::{Edge, PricedClass};

/// The least further gap of a partial choice, as a convex function of the room it leaves.
#[derive(Clone, Debug)]
pub(super) struct Relief {
    lambda: f64,
    /// Cumulative, by loss per cost, from (0, 0).
    up: Vec<Edge>,
    down: Vec<Edge>,
}

/// Relative rounding that a sum over all edges cannot exceed; bounds are lowered by it.
const ROUNDING: f64 = 1e-12;

/// The hull edges of all classes, each with the index of its class, by loss per cost: sorted once for every [`Relief`].
#[derive(Clone, Debug)]
pub(super) struct Edges {
    up: Vec<(usize, Edge)>,
    down: Vec<(usize, Edge)>,
}

impl Edges {
    pub fn of<T>(classes: &[PricedClass<T>]) -> Self {
        let sorted = |edges: fn(&PricedClass<T>) -> &[Edge]| {
            let all = classes.iter().enumerate();
            let mut all: Vec<_> =
                all.flat_map(|(at, class)| edges(class).iter().map(move |&edge| (at, edge))).collect();
            all.sort_by(|(_, a), (_, b)| (a.loss / a.cost).total_cmp(&(b.loss / b.cost)));
            all
        };
        Self { up: sorted(|class| &class.up), down: sorted(|class| &class.down) }
    }

    pub fn len(&self) -> usize {
        self.up.len() + self.down.len()
    }
}

impl Relief {
    /// Of the classes that are `open`, at price `lambda`.
    pub fn of(lambda: f64, edges: &Edges, open: impl Fn(usize) -> bool) -> Self {
        Self { lambda, up: cumulative(&edges.up, &open), down: cumulative(&edges.down, &open) }
    }

    /// A reader for rooms that mostly shrink from call to call.
    pub fn cursor(&self) -> Cursor<'_> {
        Cursor { relief: self, segment: 0 }
    }

    /// Least loss of deviations that fill `room`, or of leaving it; infinite where a negative room cannot be regained.
    fn interpolate(&self, edges: &[Edge], segment: usize, room: f64) -> f64 {
        let start = edges[segment];
        let beyond = room - start.cost;
        match edges.get(segment + 1) {
            Some(end) => start.loss + (end.loss - start.loss) * (beyond / (end.cost - start.cost)),
            None => start.loss + self.lambda * beyond,
        }
    }
}

fn cumulative(edges: &[(usize, Edge)], open: impl Fn(usize) -> bool) -> Vec<Edge> {
    let mut sum = Edge { cost: 0.0, loss: 0.0 };
    let mut sums = Vec::with_capacity(edges.len() + 1);
    sums.push(sum);
    for (_, edge) in edges.iter().filter(|&&(class, _)| open(class)) {
        sum = Edge { cost: sum.cost + edge.cost, loss: sum.loss + edge.loss };
        sums.push(sum);
    }
    sums
}

/// Evaluates a [`Relief`] at neighbouring rooms without searching.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    relief: &'a Relief,
    segment: usize,
}

impl Cursor<'_> {
    /// A lower bound of the gap that a partial choice leaving `room` still gathers.
    pub fn at(&mut self, room: f64) -> f64 {
        let relief = self.relief;
        let edges = if room >= 0.0 { &relief.up } else { &relief.down };
        let depth = room.abs();
        let last = edges[edges.len() - 1].cost;
        if room < 0.0 && depth > last {
            return if depth > last * (1.0 + ROUNDING) {
                f64::INFINITY
            } else {
                edges[edges.len() - 1].loss * (1.0 - ROUNDING)
            };
        }
        self.segment = self.segment.min(edges.len() - 1);
        while self.segment > 0 && edges[self.segment].cost > depth {
            self.segment -= 1;
        }
        while self.segment + 1 < edges.len() && edges[self.segment + 1].cost <= depth {
            self.segment += 1;
        }
        relief.interpolate(edges, self.segment, depth) * (1.0 - ROUNDING)
    }
}
