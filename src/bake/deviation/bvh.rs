//! The nearest of many triangles: a hierarchy of boxes, one triangle to a leaf.

use glam::DVec3;

use super::facet::Facet;

/// Names a leaf, the other bits being its triangle; without it the bits are an inner node.
const LEAF: u32 = 1 << 31;

/// How many slabs centres are sorted into to find where to part them. More find slightly better trees, more slowly.
const BINS: usize = 16;

/// Below this depth nodes are halved by count, so that no tree is deeper than this and 31 levels more.
const BALANCE_FROM: usize = 64;

/// More than the deepest tree has levels.
const STACK: usize = 128;

/// A box in single precision, rounded outwards.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

impl Bounds {
    const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    fn around(corners: &[DVec3; 3]) -> Self {
        let (min, max) =
            (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
        Self { min: min.to_array().map(round_down), max: max.to_array().map(round_up) }
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|k| self.min[k].min(other.min[k])),
            max: std::array::from_fn(|k| self.max[k].max(other.max[k])),
        }
    }

    fn half_area(&self) -> f32 {
        let [x, y, z]: [f32; 3] = std::array::from_fn(|k| self.max[k] - self.min[k]);
        x * y + y * z + z * x
    }

    fn center(&self) -> [f32; 3] {
        std::array::from_fn(|k| 0.5 * self.min[k] + 0.5 * self.max[k])
    }

    /// The squared distance from `point` to the box; 0 inside.
    #[inline]
    fn distance2(&self, point: DVec3) -> f64 {
        let gap =
            |k: usize| (f64::from(self.min[k]) - point[k]).max(point[k] - f64::from(self.max[k])).max(0.0);
        let [x, y, z] = [gap(0), gap(1), gap(2)];
        x * x + y * y + z * z
    }
}

/// The largest `f32` that is no larger than `x`.
pub(super) fn round_down(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

/// The smallest `f32` that is no smaller than `x`.
pub(super) fn round_up(x: f64) -> f32 {
    -round_down(-x)
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: [Bounds; 2],
    children: [u32; 2],
}

/// What is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// The number of the triangle in the tree's order.
    pub triangle: u32,
    /// The squared distance to it.
    pub distance2: f64,
}

/// A hierarchy over triangles, which are renumbered in the order of its leaves, so that neighbours have near numbers.
///
/// Built top-down by binned surface-area heuristic (I. Wald, "On fast construction of SAH-based bounding volume
/// hierarchies", 2007), O(n log n).
#[derive(Clone, Debug)]
pub(super) struct Bvh {
    nodes: Vec<Node>,
    facets: Vec<Facet>,
}

/// A triangle on its way into the tree.
struct Item {
    bounds: Bounds,
    center: [f32; 3],
    triangle: u32,
}

/// A run of items that is to become a node's child.
struct Task {
    items: std::ops::Range<usize>,
    bounds: Bounds,
    parent: usize,
    side: usize,
    depth: usize,
}

impl Bvh {
    /// The tree over at least one triangle, and the triangles' former numbers in its order.
    pub(super) fn new(triangles: &[[DVec3; 3]]) -> (Self, Vec<u32>) {
        let mut items: Vec<Item> = (0..).zip(triangles).map(|(i, corners)| Item::new(i, corners)).collect();
        let nodes = build(&mut items);
        let order: Vec<u32> = items.iter().map(|item| item.triangle).collect();
        let facets = order.iter().map(|&i| Facet::new(triangles[i as usize])).collect();
        (Self { nodes, facets }, order)
    }

    pub(super) fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// The squared distance from `point` to one triangle.
    #[inline]
    pub(super) fn distance2(&self, triangle: u32, point: DVec3) -> f64 {
        self.facets[triangle as usize].distance2(point)
    }

    /// The triangle nearest to `point`: `hint` unless another is nearer. The nearer the hint, the quicker the answer.
    pub(super) fn nearest(&self, point: DVec3, hint: u32) -> Nearest {
        let best = Nearest { triangle: hint, distance2: self.distance2(hint, point) };
        self.nearer(point, best, |_| true)
    }

    /// `best`, unless a triangle that counts is nearer to `point`: the nearest of those.
    pub(super) fn nearer(&self, point: DVec3, mut best: Nearest, counts: impl Fn(u32) -> bool) -> Nearest {
        let root = if self.nodes.is_empty() { LEAF } else { 0 };
        if best.distance2 == 0.0 {
            return best;
        }
        let mut waiting = [(0_u32, 0.0_f64); STACK];
        waiting[0].0 = root;
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (child, distance2) = waiting[count];
            if distance2 >= best.distance2 {
                continue;
            }
            if child & LEAF != 0 {
                let triangle = child & !LEAF;
                if counts(triangle) {
                    self.try_leaf(triangle, point, &mut best);
                }
                continue;
            }
            for next in farther_first(&self.nodes[child as usize], point) {
                if next.1 < best.distance2 {
                    waiting[count] = next;
                    count += 1;
                }
            }
        }
        best
    }

    /// Visits all triangles whose squared distance from `point` is no more than `most2`.
    pub(super) fn each_within(&self, point: DVec3, most2: f64, mut visit: impl FnMut(u32)) {
        let root = if self.nodes.is_empty() { LEAF } else { 0 };
        let mut waiting = vec![root];
        while let Some(child) = waiting.pop() {
            if child & LEAF == 0 {
                let near = farther_first(&self.nodes[child as usize], point).into_iter();
                waiting.extend(near.filter(|&(_, distance2)| distance2 <= most2).map(|(next, _)| next));
            } else if self.distance2(child & !LEAF, point) <= most2 {
                visit(child & !LEAF);
            }
        }
    }

    fn try_leaf(&self, triangle: u32, point: DVec3, best: &mut Nearest) {
        let distance2 = self.distance2(triangle, point);
        if distance2 < best.distance2 {
            *best = Nearest { triangle, distance2 };
        }
    }
}

/// The children of a node and their squared distances, the nearer last.
#[inline]
fn farther_first(node: &Node, point: DVec3) -> [(u32, f64); 2] {
    let [left, right] = [0, 1].map(|side| (node.children[side], node.bounds[side].distance2(point)));
    if right.1 < left.1 { [left, right] } else { [right, left] }
}

impl Item {
    fn new(triangle: u32, corners: &[DVec3; 3]) -> Self {
        let bounds = Bounds::around(corners);
        Self { bounds, center: bounds.center(), triangle }
    }
}

/// The inner nodes over `items`, a parent before its children; puts the items into the order of the leaves.
fn build(items: &mut [Item]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(items.len().saturating_sub(1));
    let root = Task { items: 0..items.len(), bounds: around(items), parent: usize::MAX, side: 0, depth: 0 };
    let mut tasks = vec![root];
    while let Some(task) = tasks.pop() {
        let leaf = task.items.len() == 1;
        let id = if leaf { LEAF | task.items.start as u32 } else { nodes.len() as u32 };
        if let Some(parent) = nodes.get_mut(task.parent) {
            let parent: &mut Node = parent;
            parent.children[task.side] = id;
            parent.bounds[task.side] = task.bounds;
        }
        if task.items.len() < 2 {
            continue;
        }
        let parent = nodes.len();
        nodes.push(Node { bounds: [Bounds::EMPTY; 2], children: [0; 2] });
        let middle = task.items.start + part(&mut items[task.items.clone()], task.depth);
        for (side, run) in [(1, middle..task.items.end), (0, task.items.start..middle)] {
            let bounds = around(&items[run.clone()]);
            tasks.push(Task { items: run, bounds, parent, side, depth: task.depth + 1 });
        }
    }
    nodes
}

fn around(items: &[Item]) -> Bounds {
    items.iter().fold(Bounds::EMPTY, |all, item| all.union(&item.bounds))
}

/// Parts at least two items into two runs that are not empty; returns where the second begins.
fn part(items: &mut [Item], depth: usize) -> usize {
    let centers = items
        .iter()
        .fold(Bounds::EMPTY, |all, item| all.union(&Bounds { min: item.center, max: item.center }));
    let extent: [f32; 3] = std::array::from_fn(|k| centers.max[k] - centers.min[k]);
    let axis = (0..3).fold(0, |best, k| if extent[k] > extent[best] { k } else { best });
    let worth_trying = depth < BALANCE_FROM && items.len() > 2;
    let by_area =
        if worth_trying { part_by_area(items, axis, centers.min[axis], extent[axis]) } else { None };
    by_area.unwrap_or_else(|| part_by_count(items, axis))
}

fn part_by_count(items: &mut [Item], axis: usize) -> usize {
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.center[axis].total_cmp(&b.center[axis]).then(a.triangle.cmp(&b.triangle))
    });
    middle
}

/// The parting between two bins at which area times count, summed over both sides, is least.
fn part_by_area(items: &mut [Item], axis: usize, start: f32, extent: f32) -> Option<usize> {
    let scale = BINS as f32 / extent;
    if !scale.is_finite() {
        return None;
    }
    let bin = |item: &Item| (((item.center[axis] - start) * scale) as usize).min(BINS - 1);
    let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
    for item in &*items {
        let (bounds, count) = &mut bins[bin(item)];
        *bounds = bounds.union(&item.bounds);
        *count += 1;
    }
    let cut = cheapest_cut(&bins)?;
    let mut middle = 0;
    for i in 0..items.len() {
        if bin(&items[i]) < cut {
            items.swap(middle, i);
            middle += 1;
        }
    }
    (middle > 0 && middle < items.len()).then_some(middle)
}

/// The first bin of the second side; `None` where every cut leaves a side empty.
fn cheapest_cut(bins: &[(Bounds, usize); BINS]) -> Option<usize> {
    let grow =
        |(bounds, count): (Bounds, usize), bin: &(Bounds, usize)| (bounds.union(&bin.0), count + bin.1);
    let mut right = [(Bounds::EMPTY, 0); BINS + 1];
    for k in (0..BINS).rev() {
        right[k] = grow(right[k + 1], &bins[k]);
    }
    let (mut left, mut best) = ((Bounds::EMPTY, 0), None);
    for k in 1..BINS {
        left = grow(left, &bins[k - 1]);
        if left.1 == 0 || right[k].1 == 0 {
            continue;
        }
        let cost = left.0.half_area() * left.1 as f32 + right[k].0.half_area() * right[k].1 as f32;
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, k));
        }
    }
    best.map(|(_, cut)| cut)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn triangles(most: usize) -> impl Strategy<Value = Vec<[DVec3; 3]>> {
        let number = prop_oneof![3 => -1.0..1.0, 1 => Just(0.5), 1 => -1e-6..1e-6];
        let point = prop::array::uniform3(number).prop_map(DVec3::from);
        prop::collection::vec(prop::array::uniform3(point), 1..most)
    }

    proptest! {
        #[test]
        fn the_nearest_is_the_nearest_of_all(
            triangles in triangles(60), point in prop::array::uniform3(-2.0..2.0), hint in any::<prop::sample::Index>()
        ) {
            let (point, (bvh, order)) = (DVec3::from(point), Bvh::new(&triangles));
            let nearest = bvh.nearest(point, hint.index(triangles.len()) as u32);
            let all = triangles.iter().map(|&corners| Facet::new(corners).distance2(point));
            // Of triangles that meet in the nearest point, one may seem nearer than its box, by rounding.
            let least = all.fold(f64::INFINITY, f64::min);
            prop_assert!(nearest.distance2 >= least && nearest.distance2.sqrt() - least.sqrt() < 1e-14);
            let found = Facet::new(triangles[order[nearest.triangle as usize] as usize]);
            prop_assert_eq!(nearest.distance2, found.distance2(point));
        }

        #[test]
        fn all_within_a_distance_are_visited_once(
            triangles in triangles(40), point in prop::array::uniform3(-2.0..2.0), most in 0.0..3.0_f64
        ) {
            let (point, (bvh, order)) = (DVec3::from(point), Bvh::new(&triangles));
            let mut found = Vec::new();
            bvh.each_within(point, most, |triangle| found.push(order[triangle as usize]));
            found.sort_unstable();
            let is_within = |&i: &u32| Facet::new(triangles[i as usize]).distance2(point) <= most;
            prop_assert_eq!(found, (0..triangles.len() as u32).filter(is_within).collect::<Vec<u32>>());
        }
    }

    #[test]
    fn rounding_goes_outwards() {
        for x in [0.1, -0.1, 1.0, 1e-60, -1e-60, 1e39, -1e39, f64::from(f32::MAX)] {
            assert!(f64::from(round_down(x)) <= x && x <= f64::from(round_up(x)), "{x}");
        }
        assert_eq!((round_down(0.5), round_up(0.5)), (0.5, 0.5));
    }

    #[test]
    fn equal_triangles_and_long_runs_of_sizes_make_a_tree_that_is_not_too_deep() {
        let equal = vec![[DVec3::ZERO, DVec3::X, DVec3::Y]; 5000];
        let growing = (0..250).map(|k| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * 2.0_f64.powi(k - 125)));
        for triangles in [equal, growing.collect()] {
            let (bvh, order) = Bvh::new(&triangles);
            assert_eq!(bvh.nodes.len() + 1, order.len());
            assert_eq!(bvh.nearest(DVec3::new(0.0, 0.0, 2.0), 7).distance2, 4.0);
        }
    }
}
