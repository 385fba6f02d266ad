//! The greedy: contract the edge that costs least, until there are few enough triangles.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};

use super::form::Quadric;
use super::guard::Guard;
use super::placement::{Spot, Vertex};
use super::{GarlandHeckbert, Topology};
use crate::bake::Surface;
use crate::bake::simplify::fans::Fans;
use crate::bake::simplify::frame::Frame;
use crate::bake::simplify::link::{Complex, Stamps, others};
use crate::bake::simplify::queue::Queue;
use crate::bake::simplify::{Progress, Simplified, Stopped, Task};

/// How much the squared length of an edge adds to its cost, compared with its squared error: enough to order what is flat
/// but for rounding, too little to matter elsewhere.
const SHORTER_FIRST: f64 = 1e-9;

/// A vertex in more triangles waits until they are fewer: every contraction walks around both ends, and a fan of a
/// hundred thousand would make that quadratic.
const LARGEST_FAN: usize = 1024;

/// How many looks at the queue pass between two calls of the progress callback.
const STRIDE: usize = 4096;

/// The queue is filled again while at least one in so many vertices was contracted since it was.
const WORTH_A_SWEEP: usize = 64;

/// A triangle that went.
const GONE: [u32; 3] = [u32::MAX; 3];

/// What is known of a vertex, one bit each.
mod mark {
    /// It was contracted into another.
    pub const GONE: u8 = 1;
    /// An edge of it has changed since its choice was made, which may now cost more or be gone.
    pub const DIRTY: u8 = 2;
    /// It has no choice and is not in the queue.
    pub const IDLE: u8 = 4;
    /// It must stay where it is.
    pub const LOCKED: u8 = 8;
    /// It is on an edge that has not exactly two triangles.
    pub const BORDER: u8 = 16;
}

/// The cheapest contraction of a vertex, with one of higher index.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
struct Choice {
    cost: f32,
    partner: u32,
}

/// A simplification on its way. Every edge belongs to its lower end, which is in the queue with the cheapest of its edges
/// and survives the contraction.
pub(super) struct Greedy<'a> {
    method: &'a GarlandHeckbert,
    task: &'a Task<'a>,
    guard: Guard,
    frame: Frame,
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
    fans: Fans,
    marks: Vec<u8>,
    choices: Vec<Choice>,
    queue: Queue,
    stamps: Stamps,
    /// Per vertex, the old vertex it stems from.
    origins: Vec<u32>,
    /// Per vertex, what it was contracted into, or itself.
    heirs: Vec<u32>,
    /// How many triangles there were, and are.
    from: usize,
    live: usize,
    /// Largest squared error so far, in the frame.
    error: f64,
    /// The fan of a contracted vertex, in the making.
    fan: Vec<u32>,
}

impl<'a> Greedy<'a> {
    /// Sums up the quadrics and fills the queue.
    pub(super) fn new(method: &'a GarlandHeckbert, task: &'a Task) -> Self {
        let Surface { positions, triangles } = task.surface;
        let count = positions.len();
        let is_triangle = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        let kept: Vec<usize> = (0..triangles.len()).filter(|&t| is_triangle(&triangles[t])).collect();
        let weights: Vec<f64> = kept.iter().map(|&t| task.weight(t)).collect();
        let triangles: Vec<[u32; 3]> = kept.into_iter().map(|t| triangles[t]).collect();
        let frame = Frame::around(triangles.as_flattened().iter().map(|&v| positions[v as usize]));
        let vertex = |&p| Vertex { place: frame.enter(p), quadric: Quadric::default() };
        let mut greedy = Self {
            method,
            task,
            guard: Guard::new(method.least_turn, method.least_shape),
            frame,
            vertices: positions.iter().map(vertex).collect(),
            fans: Fans::new(count, &triangles),
            from: triangles.len(),
            live: triangles.len(),
            triangles,
            marks: (0..count).map(|v| if task.is_locked(v) { mark::LOCKED } else { 0 }).collect(),
            choices: vec![Choice::default(); count],
            queue: Queue::new(),
            stamps: Stamps::new(count),
            origins: (0..count as u32).collect(),
            heirs: (0..count as u32).collect(),
            error: 0.0,
            fan: Vec::new(),
        };
        greedy.sum_up(&weights);
        greedy.sweep();
        greedy
    }

    /// Gives every vertex the quadrics of its triangles and borders, and marks the borders.
    fn sum_up(&mut self, weights: &[f64]) {
        for (t, &weight) in weights.iter().enumerate() {
            let corners = self.triangles[t];
            let [a, b, c] = corners.map(|v| self.vertices[v as usize].place);
            let across = (b - a).cross(c - a);
            let normal = across.normalize_or_zero();
            let plane = Quadric::plane(normal, a, 0.5 * weight * across.length());
            for corner in corners {
                self.vertices[corner as usize].quadric += plane;
            }
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let complex = Complex { triangles: &self.triangles, fans: &self.fans };
                if complex.triangles_at(corners[from], corners[to]) != 2 {
                    self.hold_border([corners[from], corners[to]], normal, weight);
                }
            }
        }
    }

    /// Holds both ends of a border to the plane through it that stands upright on its triangle.
    fn hold_border(&mut self, ends: [u32; 2], normal: DVec3, weight: f64) {
        let [a, b] = ends.map(|v| self.vertices[v as usize].place);
        let upright = normal.cross(b - a).normalize_or_zero();
        let weight = weight * f64::from(self.method.border) * a.distance_squared(b);
        let plane = Quadric::plane(upright, a, weight).constraint();
        for end in ends {
            self.vertices[end as usize].quadric += plane;
            self.marks[end as usize] |= mark::BORDER;
        }
    }

    /// Puts every vertex into the queue that is not there; returns how many are.
    fn sweep(&mut self) -> usize {
        let present = (0..self.marks.len() as u32).filter(|&v| !self.fans.of(v).is_empty());
        let present: Vec<u32> = present.collect();
        for &vertex in &present {
            self.choose(vertex, None);
        }
        present.len()
    }

    /// Contracts until there are few enough triangles.
    pub(super) fn run(&mut self, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Stopped {
        let target = self.task.target.triangles;
        let mut since_sweep = 0;
        let mut present = 0;
        for look in 1.. {
            if self.live <= target {
                return Stopped::Triangles;
            }
            let so_far = Progress { from: self.from, triangles: self.live, target };
            if look % STRIDE == 0 && progress(so_far).is_break() {
                return Stopped::Cancelled;
            }
            match self.queue.pop() {
                Some((_, vertex)) => since_sweep += usize::from(self.look_at(vertex)),
                None if since_sweep * WORTH_A_SWEEP > present => {
                    since_sweep = 0;
                    present = self.sweep();
                }
                None => break,
            }
        }
        Stopped::Exhausted
    }

    /// Contracts the choice of a vertex if it still stands and may be; returns whether it did.
    fn look_at(&mut self, vertex: u32) -> bool {
        let marks = &mut self.marks[vertex as usize];
        if *marks & mark::GONE != 0 {
            return false;
        }
        if *marks & mark::DIRTY != 0 {
            *marks &= !mark::DIRTY;
            self.choose(vertex, None);
            return false;
        }
        let choice = self.choices[vertex as usize];
        let (a, b) = (&self.vertices[vertex as usize], &self.vertices[choice.partner as usize]);
        let sum = a.quadric + b.quadric;
        let spot = self.spot(vertex, choice.partner, &sum);
        let error = if sum.area > 0.0 { spot.error / sum.area } else { 0.0 };
        if !self.may_contract(vertex, choice.partner, spot.place, error) {
            self.choose(vertex, Some(choice));
            return false;
        }
        self.error = self.error.max(error);
        self.contract(vertex, choice.partner, Vertex { place: spot.place, quadric: sum });
        true
    }

    /// Where the contraction of two vertices goes.
    #[inline]
    fn spot(&self, a: u32, b: u32, sum: &Quadric) -> Spot {
        let is_locked = |v: u32| self.marks[v as usize] & mark::LOCKED != 0;
        let (from, to) = (&self.vertices[a as usize], &self.vertices[b as usize]);
        match (is_locked(a), is_locked(b)) {
            (false, false) => self.method.placement.spot(from, to, sum),
            (true, _) => Spot::new(from.place, sum),
            (_, true) => Spot::new(to.place, sum),
        }
    }

    /// Chooses the cheapest contraction of a vertex above that one, and puts it into the queue.
    fn choose(&mut self, vertex: u32, above: Option<Choice>) {
        let marks = &mut self.marks[vertex as usize];
        *marks &= !mark::IDLE;
        match self.cheapest(vertex, above) {
            Some(choice) => {
                self.choices[vertex as usize] = choice;
                self.queue.push(choice.cost, vertex);
            }
            None => self.marks[vertex as usize] |= mark::IDLE,
        }
    }

    fn cheapest(&mut self, vertex: u32, above: Option<Choice>) -> Option<Choice> {
        let fan = self.fans.of(vertex);
        if fan.len() > LARGEST_FAN {
            return None;
        }
        let mut cheapest: Option<Choice> = None;
        self.stamps.clear();
        for &triangle in fan {
            for partner in others(self.triangles[triangle as usize], vertex) {
                if partner < vertex || !self.stamps.insert(partner) {
                    continue;
                }
                let choice = Choice { cost: self.cost(vertex, partner), partner };
                if above.is_none_or(|a| choice > a) && cheapest.is_none_or(|c| choice < c) {
                    cheapest = Some(choice);
                }
            }
        }
        cheapest
    }

    /// What contracting two vertices costs, in the frame's units to the fourth.
    #[inline]
    fn cost(&self, a: u32, b: u32) -> f32 {
        let (from, to) = (&self.vertices[a as usize], &self.vertices[b as usize]);
        let sum = from.quadric + to.quadric;
        let length = from.place.distance_squared(to.place);
        (self.spot(a, b, &sum).error + SHORTER_FIRST * sum.area * length) as f32
    }

    /// Whether two vertices may be contracted to a place, at a squared error.
    fn may_contract(&mut self, a: u32, b: u32, to: DVec3, error: f64) -> bool {
        let both = self.marks[a as usize] & self.marks[b as usize];
        let keeps_topology = |stamps: &mut Stamps| {
            let complex = Complex { triangles: &self.triangles, fans: &self.fans };
            complex.may_contract(a, b, both & mark::BORDER != 0, stamps)
        };
        both & mark::LOCKED == 0
            && self.frame.leave_length(error.sqrt()) <= self.task.target.error
            && self.fans.of(a).len() + self.fans.of(b).len() <= LARGEST_FAN
            && self.guard_allows(a, b, to)
            && self.guard_allows(b, a, to)
            && (self.method.topology == Topology::Free || keeps_topology(&mut self.stamps))
    }

    /// Whether the triangles of a vertex, but for those that go with the edge to `other`, may follow it.
    fn guard_allows(&self, vertex: u32, other: u32, to: DVec3) -> bool {
        let place = |v: u32| self.vertices[v as usize].place;
        let from = place(vertex);
        self.fans.of(vertex).iter().all(|&t| {
            let [p, q] = others(self.triangles[t as usize], vertex);
            p == other || q == other || self.guard.allows(from, to, place(p), place(q))
        })
    }

    /// Contracts `gone` into `kept`, which is the lower.
    fn contract(&mut self, kept: u32, gone: u32, merged: Vertex) {
        if merged.place == self.vertices[gone as usize].place {
            self.origins[kept as usize] = self.origins[gone as usize];
        }
        self.vertices[kept as usize] = merged;
        self.heirs[gone as usize] = kept;
        let inherited = self.marks[gone as usize] & (mark::BORDER | mark::LOCKED);
        self.marks[kept as usize] |= inherited;
        self.merge_fans(kept, gone);
        self.marks[gone as usize] = mark::GONE;
        self.choose(kept, None);
    }

    /// Gives `kept` the triangles of both but for those at the edge, which go.
    fn merge_fans(&mut self, kept: u32, gone: u32) {
        let mut fan = std::mem::take(&mut self.fan);
        fan.clear();
        fan.extend_from_slice(self.fans.of(kept));
        fan.retain(|&t| self.keeps(t, kept, gone));
        let first_of_gone = fan.len();
        fan.extend_from_slice(self.fans.of(gone));
        let mut at = first_of_gone;
        for i in first_of_gone..fan.len() {
            if self.hand_over(fan[i], kept, gone) {
                fan[at] = fan[i];
                at += 1;
            }
        }
        fan.truncate(at);
        self.fans.replace(gone, &[]);
        self.fans.replace(kept, &fan);
        self.fan = fan;
    }

    /// Whether a triangle of `kept` stays one. Disturbs the neighbours that own edges to `kept`.
    fn keeps(&mut self, triangle: u32, kept: u32, gone: u32) -> bool {
        let [p, q] = others(self.triangles[triangle as usize], kept);
        for corner in [p, q] {
            if corner < kept {
                self.disturb(corner);
            }
        }
        p != gone && q != gone
    }

    /// Makes a triangle of `gone` one of `kept`, or removes it; returns whether it stays. Disturbs the neighbours that own
    /// edges to `gone`.
    fn hand_over(&mut self, triangle: u32, kept: u32, gone: u32) -> bool {
        let [p, q] = others(self.triangles[triangle as usize], gone);
        let goes = p == kept || q == kept;
        for corner in [p, q] {
            if corner != kept && (corner < gone || goes) {
                self.disturb(corner);
            }
        }
        if goes {
            self.live -= 1;
            self.triangles[triangle as usize] = GONE;
            self.fans.remove(if p == kept { q } else { p }, triangle);
        } else {
            self.triangles[triangle as usize] = [kept, p, q];
        }
        !goes
    }

    /// Has a vertex choose again, when its turn comes.
    fn disturb(&mut self, vertex: u32) {
        let marks = &mut self.marks[vertex as usize];
        *marks |= mark::DIRTY;
        if *marks & mark::IDLE != 0 {
            *marks &= !mark::IDLE;
            self.queue.push(self.choices[vertex as usize].cost, vertex);
        }
    }

    /// What is left.
    pub(super) fn finish(mut self, stopped: Stopped) -> Simplified {
        self.triangles.retain(|&t| t != GONE);
        let mut new = vec![Simplified::GONE; self.marks.len()];
        for &corner in self.triangles.as_flattened() {
            new[corner as usize] = 0;
        }
        let kept: Vec<u32> = (0..new.len() as u32).filter(|&v| new[v as usize] == 0).collect();
        for (index, &vertex) in (0..).zip(&kept) {
            new[vertex as usize] = index;
        }
        let heirs =
            heirs(std::mem::take(&mut self.heirs)).into_iter().map(|heir| new[heir as usize]).collect();
        let surface = Surface {
            positions: kept.iter().map(|&v| self.position(v)).collect(),
            triangles: self.triangles.iter().map(|t| t.map(|v| new[v as usize])).collect(),
        };
        let origins = kept.iter().map(|&v| self.origins[v as usize]).collect();
        let error = self.frame.leave_length(self.error.sqrt());
        Simplified { surface, origins, heirs, error, stopped }
    }

    fn position(&self, vertex: u32) -> Vec3 {
        let place = self.vertices[vertex as usize].place;
        let origin = self.task.surface.positions[self.origins[vertex as usize] as usize];
        if self.frame.enter(origin) == place { origin } else { self.frame.leave(place) }
    }
}

/// Per vertex the last of its heirs, from per vertex the next: each has a lower index.
fn heirs(mut next: Vec<u32>) -> Vec<u32> {
    for vertex in 0..next.len() {
        next[vertex] = next[next[vertex] as usize];
    }
    next
}
