//! How distances are spread over a surface, by sampling.

use super::Options;
use super::shape::Shape;

/// Samples of the first pass; every further pass doubles their number.
const FIRST_PASS: usize = 4096;

/// How something is spread over a surface, each part counting by its area: the distance to another surface, or the
/// difference of an attribute.
///
/// A surface without area counts by triangles instead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Root mean square.
    pub rms: f64,
    /// Standard error of the root mean square, as if samples were independent; being spread evenly they do better.
    pub rms_error: f64,
    /// Mean.
    pub mean: f64,
    /// The largest among the samples: no bound.
    pub max: f64,
    /// How many samples were taken.
    pub samples: usize,
}

/// Samples `from` until the standard error is as small as asked for, in passes that are each spread over the whole
/// surface.
pub(super) fn sample(from: &Shape, to: &Shape, options: &Options) -> Spread {
    let mut sums = Sums::default();
    let strata = Strata::new(from);
    for pass in 0.. {
        let wanted = sums.count.max(FIRST_PASS).min(options.max_samples.max(1) - sums.count);
        let mut near = 0;
        strata.visit(wanted, options.seed, pass, |place| {
            let nearest = to.bvh.nearest(from.point(&place), near);
            near = nearest.triangle;
            sums.add(nearest.distance2);
        });
        let spread = sums.spread();
        if spread.rms_error <= options.rms_error * spread.rms || sums.count >= options.max_samples {
            return spread;
        }
    }
    sums.spread()
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    count: usize,
    first: f64,
    second: f64,
    fourth: f64,
    max2: f64,
}

impl Sums {
    /// Counts one more, given its square.
    pub(super) fn add(&mut self, distance2: f64) {
        self.count += 1;
        self.first += distance2.sqrt();
        self.second += distance2;
        self.fourth += distance2 * distance2;
        self.max2 = self.max2.max(distance2);
    }

    /// What was counted; zeros where nothing was.
    pub(super) fn spread(&self) -> Spread {
        let count = self.count.max(1) as f64;
        let (mean, mean2) = (self.first / count, self.second / count);
        let (rms, variance) = (mean2.sqrt(), (self.fourth / count - mean2 * mean2).max(0.0));
        // The derivative of the root carries the error of the mean square over.
        let rms_error = if rms > 0.0 { (variance / count).sqrt() / (2.0 * rms) } else { 0.0 };
        Spread { rms, rms_error, mean, max: self.max2.sqrt(), samples: self.count }
    }
}

/// A place on a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The triangle, in the order of the shape.
    pub triangle: usize,
    /// How much of each corner, ≥ 0, with a sum of 1.
    pub weights: [f64; 3],
}

/// A surface unrolled: its triangles side by side, each as long as it is large.
pub(super) struct Strata {
    /// Where each triangle ends.
    ends: Vec<f64>,
    total: f64,
}

impl Strata {
    pub(super) fn new(shape: &Shape) -> Self {
        let ends = running_sum(shape.bvh.facets().iter().map(|facet| facet.area()));
        let total = ends.last().copied().unwrap_or(0.0);
        if total > 0.0 && total.is_finite() {
            return Self { ends, total };
        }
        let ends = running_sum(shape.corners.iter().map(|_| 1.0));
        Self { total: ends.len() as f64, ends }
    }

    /// Takes one place from each of `count` strata of equal size, in their order, so that what is nearest to one is a
    /// good hint for the next. Another seed or pass takes others.
    ///
    /// Where in its stratum and where in its triangle is given by an additive recurrence with the powers of the root of
    /// x⁴ = x + 1 (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018), rotated.
    pub(super) fn visit(&self, count: usize, seed: u64, pass: u64, mut take: impl FnMut(Place)) {
        const STEPS: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2];
        let rotation = rotation(seed, pass);
        let mut triangle = 0;
        for i in 0..count {
            let [along, u, v] = std::array::from_fn(|k| (rotation[k] + i as f64 * STEPS[k]).fract());
            let place = (i as f64 + along) / count as f64 * self.total;
            while triangle + 1 < self.ends.len() && self.ends[triangle] <= place {
                triangle += 1;
            }
            take(Place { triangle, weights: weights(u, v) });
        }
    }
}

fn running_sum(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let add = |sum: &mut f64, value: f64| {
        *sum += value;
        Some(*sum)
    };
    values.scan(0.0, add).collect()
}

/// The weights of corners that belong to a point of the unit square, areas being kept
/// (G. Turk, "Generating random points in triangles", 1990).
fn weights(u: f64, v: f64) -> [f64; 3] {
    let root = u.sqrt();
    [1.0 - root, root * (1.0 - v), root * v]
}

/// Three numbers in [0, 1) for a pass (G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators",
/// 2014).
fn rotation(seed: u64, pass: u64) -> [f64; 3] {
    [1, 2, 3].map(|k| {
        let state = seed.wrapping_add((3 * pass + k).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    })
}
