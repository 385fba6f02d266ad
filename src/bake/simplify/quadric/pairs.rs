//! Pairs: vertices that may be contracted though no edge joins them, because they are close to each other.
//!
//! They are what lets parts grow together that a viewer sees as one (M. Garland, P. Heckbert, "Surface simplification
//! using quadric error metrics", SIGGRAPH 1997, section 3.2). As there, pairs are those of the original places. The
//! paper takes all that are near enough, which are as many as the square of the vertices where the distance is large;
//! we take the nearest few of each vertex.

use glam::Vec3;

use crate::bake::simplify::link::Complex;

/// How many of its neighbours in space a vertex is paired with. More join parts in more ways; each costs as much as an
/// edge, of which a vertex has six.
const MOST: usize = 8;

/// A vertex that would have more pairs by contraction drops those that come last, so that following a contraction takes
/// bounded time.
const MOST_MERGED: usize = 4 * MOST;

/// Per vertex, what it is paired with. The other one is paired with it as well.
pub(super) struct Pairs {
    partners: Vec<Vec<u32>>,
}

impl Pairs {
    /// Pairs every vertex that triangles use with the nearest others that are closer than `distance` and in no triangle
    /// with it. O(n log n), whatever the distance.
    pub(super) fn find(positions: &[Vec3], complex: Complex, distance: f64) -> Self {
        let halves = Halves::new(positions);
        let mut pairs = Self { partners: vec![Vec::new(); positions.len()] };
        for vertex in 0..positions.len() as u32 {
            let joins = |other| other == vertex || complex.triangles_at(vertex, other) > 0;
            for partner in halves.nearest(positions[vertex as usize], distance, joins) {
                pairs.add(vertex, partner);
            }
        }
        pairs
    }

    /// Adds a pair that is not there.
    fn add(&mut self, a: u32, b: u32) {
        if !self.of(a).contains(&b) {
            self.partners[a as usize].push(b);
            self.partners[b as usize].push(a);
        }
    }

    pub(super) fn of(&self, vertex: u32) -> &[u32] {
        &self.partners[vertex as usize]
    }

    /// Hands the pairs of `gone` to `kept`.
    pub(super) fn contract(&mut self, kept: u32, gone: u32) {
        for partner in std::mem::take(&mut self.partners[gone as usize]) {
            self.partners[partner as usize].retain(|&p| p != gone);
            if partner != kept && self.of(kept).len() < MOST_MERGED {
                self.add(kept, partner);
            }
        }
    }
}

/// Points cut in halves over and over, along x, y and z in turn: a k-d tree (J. L. Bentley, "Multidimensional binary
/// search trees used for associative searching", 1975) whose nodes are runs of one list, each with its point in the
/// middle.
struct Halves<'a> {
    positions: &'a [Vec3],
    order: Vec<u32>,
}

impl<'a> Halves<'a> {
    fn new(positions: &'a [Vec3]) -> Self {
        let mut order: Vec<u32> = (0..positions.len() as u32).collect();
        cut(positions, &mut order, 0);
        Self { positions, order }
    }

    /// The nearest points that are closer than `distance` and not left out, from near to far.
    fn nearest(
        &self,
        at: Vec3,
        distance: f64,
        leaves_out: impl Fn(u32) -> bool,
    ) -> impl Iterator<Item = u32> {
        let mut search = Search { at, reach: distance * distance, leaves_out, found: Vec::new() };
        self.search(&self.order, 0, &mut search);
        search.found.into_iter().map(|(_, point)| point)
    }

    fn search(&self, run: &[u32], axis: usize, search: &mut Search<impl Fn(u32) -> bool>) {
        let Some(&point) = run.get(run.len() / 2) else { return };
        let place = self.positions[point as usize];
        search.offer(point, place);
        let off = f64::from(search.at[axis]) - f64::from(place[axis]);
        let (low, high) = (&run[..run.len() / 2], &run[run.len() / 2 + 1..]);
        let (near, far) = if off < 0.0 { (low, high) } else { (high, low) };
        self.search(near, (axis + 1) % 3, search);
        if off * off < search.reach {
            self.search(far, (axis + 1) % 3, search);
        }
    }
}

/// Puts the median along an axis in the middle, what is below before it and what is above behind, and so on within both.
fn cut(positions: &[Vec3], run: &mut [u32], axis: usize) {
    if run.len() > 1 {
        let middle = run.len() / 2;
        let along = |&point: &u32| positions[point as usize][axis];
        run.select_nth_unstable_by(middle, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
        cut(positions, &mut run[..middle], (axis + 1) % 3);
        cut(positions, &mut run[middle + 1..], (axis + 1) % 3);
    }
}

/// What is nearest so far.
struct Search<F> {
    at: Vec3,
    /// What is to be found is closer than this, squared.
    reach: f64,
    leaves_out: F,
    /// Squared distances and points, ascending.
    found: Vec<(f64, u32)>,
}

impl<F: Fn(u32) -> bool> Search<F> {
    fn offer(&mut self, point: u32, place: Vec3) {
        let squared = place.as_dvec3().distance_squared(self.at.as_dvec3());
        if squared < self.reach && !(self.leaves_out)(point) {
            let at = self.found.partition_point(|&(other, _)| other <= squared);
            self.found.insert(at, (squared, point));
            self.found.truncate(MOST);
            if self.found.len() == MOST {
                self.reach = self.found[MOST - 1].0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::bake::simplify::fans::Fans;

    fn cloud() -> impl Strategy<Value = Vec<Vec3>> {
        // Whole numbers, so that many are equally far or in one place.
        let point = [0..5i8, 0..5, 0..3].prop_map(|[x, y, z]| Vec3::new(x.into(), y.into(), z.into()));
        prop::collection::vec(point, 3..60)
    }

    fn distance(positions: &[Vec3], a: u32, b: u32) -> f64 {
        positions[a as usize].as_dvec3().distance(positions[b as usize].as_dvec3())
    }

    /// How far the nearest of all others are that are near enough and not in `ring`.
    fn by_looking_at_all(positions: &[Vec3], vertex: u32, within: f64, ring: &[u32]) -> Vec<f64> {
        let others = (0..positions.len() as u32).filter(|v| *v != vertex && !ring.contains(v));
        let mut distances: Vec<f64> = others.map(|other| distance(positions, vertex, other)).collect();
        distances.retain(|&d| d < within);
        distances.sort_unstable_by(f64::total_cmp);
        distances.truncate(MOST);
        distances
    }

    proptest! {
        #[test]
        fn pairs_are_the_nearest_that_are_not_joined(positions in cloud(), within in 0.5..6.0f64) {
            let triangles = [[0, 1, 2]];
            let fans = Fans::new(positions.len(), &triangles);
            let complex = Complex { triangles: &triangles, fans: &fans };
            let pairs = Pairs::find(&positions, complex, within);
            for vertex in 0..positions.len() as u32 {
                let ring: &[u32] = if vertex < 3 { &[0, 1, 2] } else { &[] };
                let mut found: Vec<f64> =
                    pairs.of(vertex).iter().map(|&p| distance(&positions, vertex, p)).collect();
                found.sort_unstable_by(f64::total_cmp);
                let nearest = by_looking_at_all(&positions, vertex, within, ring);
                prop_assert_eq!(&found[..nearest.len()], &nearest[..]);
                prop_assert!(pairs.of(vertex).iter().all(|p| !ring.contains(p) && pairs.of(*p).contains(&vertex)));
                prop_assert!(found.iter().all(|&d| d < within));
            }
        }

        #[test]
        fn pairs_go_both_ways_whatever_is_contracted(
            positions in cloud(),
            steps in prop::collection::vec([any::<prop::sample::Index>(), any::<prop::sample::Index>()], 0..40),
        ) {
            let fans = Fans::new(positions.len(), &[]);
            let mut pairs = Pairs::find(&positions, Complex { triangles: &[], fans: &fans }, 3.0);
            let mut present: Vec<u32> = (0..positions.len() as u32).collect();
            for [kept, gone] in steps {
                let gone = present.remove(gone.index(present.len()));
                let Some(&kept) = present.get(kept.index(present.len().max(1))) else { break };
                pairs.contract(kept, gone);
                prop_assert!(pairs.of(gone).is_empty() && pairs.of(kept).len() <= positions.len());
                for &vertex in &present {
                    let partners = pairs.of(vertex);
                    let is_fine = |p: &u32| *p != vertex && present.contains(p) && pairs.of(*p).contains(&vertex);
                    prop_assert!(partners.iter().all(is_fine));
                    prop_assert!((1..partners.len()).all(|i| !partners[..i].contains(&partners[i])));
                }
            }
        }
    }

    /// Where all is in one place, or the distance has no end, the search must not look at all of it for every vertex.
    #[test]
    fn a_crowd_in_one_place_is_searched_in_good_time() {
        let positions = vec![Vec3::ONE; 100_000];
        let fans = Fans::new(positions.len(), &[]);
        let pairs = Pairs::find(&positions, Complex { triangles: &[], fans: &fans }, f64::INFINITY);
        assert!((0..100_000).all(|v| pairs.of(v).len() >= MOST));
    }
}
