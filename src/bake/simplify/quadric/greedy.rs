//! The greedy: contract the edge that costs least, until there are few enough triangles.

use std::hint::black_box;
use std::ops::ControlFlow;

use glam::{DVec3, Vec3};

use super::form::{Form, Quadric};
use super::guard::{Facing, Guard};
use super::layer::{Around, Move};
use super::layers::Layers;
use super::placement::Spot;
use super::{GarlandHeckbert, Topology};
use crate::bake::simplify::fans::Fans;
use crate::bake::simplify::link::{Complex, Stamps, others};
use crate::bake::simplify::order::{along_curve, by_lowest_corner};
use crate::bake::simplify::queue::Queue;
use crate::bake::simplify::rebuild::{Corner, Facet, Rebuilt};
use crate::bake::simplify::{Progress, Simplified, Stopped, Target, Task};
use crate::bounds::Aabb;

/// How much the squared length of an edge adds to its cost, compared with its squared error: enough to order what is
/// flat but for rounding, too little to matter elsewhere.
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
    /// Something cheaper than its choice, or all it had, was refused.
    pub const SETTLED: u8 = 64;
    /// It must stay where it is.
    pub const LOCKED: u8 = 8;
    /// It is on an edge that has not exactly two triangles.
    pub const BORDER: u8 = 16;
    /// It is on an edge that does not have as many triangles in either direction.
    pub const ODD: u8 = 32;
    /// It is on a seam that is held.
    pub const SEAM: u8 = 128;
    /// What a vertex has from those that are contracted into it.
    pub const INHERITED: u8 = LOCKED | BORDER | ODD | SEAM;
}

/// A contraction of a vertex, with one of higher index: the bits of its cost, then the partner, so that whole numbers
/// order them by cost and then by partner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Choice(u64);

impl Choice {
    /// The choice after all others.
    const NONE: Self = Self(u64::MAX);

    /// A cost that is not a number comes last.
    #[inline]
    fn new(cost: f32, partner: u32) -> Self {
        Self(u64::from(cost.abs().to_bits()) << 32 | u64::from(partner))
    }

    fn cost(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    fn partner(self) -> u32 {
        self.0 as u32
    }
}

/// A simplification on its way. Every edge belongs to its lower end, which is in the queue with the cheapest of its
/// edges and survives the contraction.
///
/// Vertices are in the order of a curve through space, not in that of the task; only [`Greedy::order`] and
/// [`Greedy::origins`] name old ones.
pub(super) struct Greedy<'a> {
    method: &'a GarlandHeckbert,
    task: &'a Task<'a>,
    guard: Guard,
    /// A power of two that makes places of positions, some units around.
    scale: f64,
    positions: Vec<Vec3>,
    quadrics: Vec<Quadric>,
    /// Weighted area that was contracted into each vertex.
    areas: Vec<f32>,
    triangles: Vec<[u32; 3]>,
    /// Per triangle, the old one that it was.
    old_triangles: Vec<u32>,
    /// Per triangle, where it faced before all contractions.
    facings: Vec<Facing>,
    fans: Fans,
    /// The attributes, if there are any.
    layers: Option<Layers<'a>>,
    marks: Vec<u8>,
    choices: Vec<Choice>,
    queue: Queue,
    stamps: Stamps,
    /// Per vertex, the old vertex it was.
    order: Vec<u32>,
    /// Per vertex, the old vertex it stems from by now.
    origins: Vec<u32>,
    /// Per vertex, what it was contracted into, or itself.
    heirs: Vec<u32>,
    /// How many triangles there were, and are.
    from: usize,
    live: usize,
    /// The largest error that a step may have by now, in object units; negative before the first run.
    most: f32,
    /// Largest squared error so far, scaled.
    error: f64,
    /// The fan of a contracted vertex, in the making.
    fan: Vec<u32>,
    /// What a vertex may be contracted with.
    partners: Vec<u32>,
}

impl<'a> Greedy<'a> {
    /// Sums up the quadrics and fills the queue.
    pub(super) fn new(method: &'a GarlandHeckbert, task: &'a Task) -> Self {
        let Ordered { origins, triangles, old_triangles, weights } = Ordered::new(task);
        let count = origins.len();
        let positions: Vec<Vec3> = origins.iter().map(|&v| task.mesh.positions[v as usize]).collect();
        let lock = |&v: &u32| if task.is_locked(v as usize) { mark::LOCKED } else { 0 };
        let scale = scale_of(&positions);
        let layers =
            task.mesh.has_seams().then(|| Layers::new(task.mesh, &old_triangles, &method.attributes, scale));
        let mut greedy = Self {
            method,
            task,
            guard: Guard::new(method.least_turn, method.least_shape),
            scale,
            positions,
            quadrics: vec![Quadric::default(); count],
            areas: vec![0.0; count],
            fans: Fans::new(count, &triangles),
            from: triangles.len(),
            live: triangles.len(),
            facings: vec![Facing::default(); triangles.len()],
            triangles,
            old_triangles,
            layers,
            marks: origins.iter().map(lock).collect(),
            choices: vec![Choice::default(); count],
            queue: Queue::new(),
            stamps: Stamps::new(count),
            order: origins.clone(),
            origins,
            heirs: (0..count as u32).collect(),
            most: -1.0,
            error: 0.0,
            fan: Vec::new(),
            partners: Vec::new(),
        };
        greedy.sum_up(&weights);
        greedy
    }

    #[inline]
    fn place(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize].as_dvec3() * self.scale
    }

    /// Gives every vertex the quadrics of its triangles and borders, and marks the borders.
    fn sum_up(&mut self, weights: &[f64]) {
        for (t, &weight) in weights.iter().enumerate() {
            let corners = self.triangles[t];
            let [a, b, c] = corners.map(|v| self.place(v));
            let across = (b - a).cross(c - a);
            let normal = across.normalize_or_zero();
            let area = 0.5 * weight * across.length();
            let plane = Quadric::plane(normal, area);
            self.facings[t] = Facing::new(normal);
            for corner in corners {
                self.quadrics[corner as usize].add(&plane);
                self.areas[corner as usize] += area as f32;
            }
        }
        let mut uses = vec![0u64; self.positions.len()];
        for vertex in 0..self.positions.len() as u32 {
            self.find_borders(vertex, weights, &mut uses);
        }
        if let Some(mut layers) = self.layers.take() {
            let places: Vec<DVec3> = (0..self.positions.len() as u32).map(|v| self.place(v)).collect();
            layers.sum_up(&self.triangles, &places, weights);
            self.hold_seams(&layers, weights);
            self.layers = Some(layers);
        }
    }

    /// Marks the vertices of seams, and holds them to the planes that stand upright on the triangles at either side.
    fn hold_seams(&mut self, layers: &Layers, weights: &[f64]) {
        for triangle in (0..self.triangles.len()).filter(|_| layers.holds_seams()) {
            let [a, b, c] = self.triangles[triangle];
            for edge in [[a, b], [b, c], [c, a]] {
                if self.is_seam(layers, edge) {
                    for [vertex, neighbour] in [edge, [edge[1], edge[0]]] {
                        self.marks[vertex as usize] |= mark::SEAM;
                        let weight = weights[triangle] * f64::from(self.method.seam);
                        self.hold_to_edge(vertex, neighbour, triangle, weight);
                    }
                }
            }
        }
    }

    /// Whether an edge is a seam that is held. One that has not two triangles is a border.
    fn is_seam(&self, layers: &Layers, edge: [u32; 2]) -> bool {
        let mut sides = self.around().edge(edge[0], edge[1]);
        match (sides.next(), sides.next(), sides.next()) {
            (Some(s), Some(t), None) => layers.is_seam(self.around(), edge, [s, t]),
            _ => false,
        }
    }

    fn around(&self) -> Around<'_> {
        Around { triangles: &self.triangles, fans: &self.fans }
    }

    /// Marks a vertex that has borders, and holds it to them. `uses` is 0 everywhere, and has room for counts: per
    /// neighbour of triangles that lead to it, and 2³² times those that come from it.
    fn find_borders(&mut self, vertex: u32, weights: &[f64], uses: &mut [u64]) {
        const PLAIN: u64 = 1 << 32 | 1;
        for &triangle in self.fans.of(vertex) {
            let [p, q] = others(self.triangles[triangle as usize], vertex);
            uses[p as usize] += 1;
            uses[q as usize] += 1 << 32;
        }
        for i in 0..self.fans.of(vertex).len() {
            let triangle = self.fans.of(vertex)[i] as usize;
            for neighbour in others(self.triangles[triangle], vertex) {
                let (to, from) = (uses[neighbour as usize] as u32, (uses[neighbour as usize] >> 32) as u32);
                if uses[neighbour as usize] != PLAIN {
                    self.marks[vertex as usize] |= if to != from { mark::ODD } else { 0 };
                    self.marks[vertex as usize] |= if to + from != 2 { mark::BORDER } else { 0 };
                }
                if to + from != 2 {
                    let weight = weights[triangle] * f64::from(self.method.border);
                    self.hold_to_edge(vertex, neighbour, triangle, weight);
                }
            }
        }
        for &triangle in self.fans.of(vertex) {
            for neighbour in others(self.triangles[triangle as usize], vertex) {
                uses[neighbour as usize] = 0;
            }
        }
    }

    /// Holds one end of an edge of a triangle to the plane through it that stands upright on the triangle.
    fn hold_to_edge(&mut self, vertex: u32, neighbour: u32, triangle: usize, weight: f64) {
        let [a, b, c] = self.triangles[triangle].map(|v| self.place(v));
        let edge = self.place(neighbour) - self.place(vertex);
        let upright = (b - a).cross(c - a).cross(edge).normalize_or_zero();
        let plane = Quadric::plane(upright, weight * edge.length_squared());
        self.quadrics[vertex as usize].add(&plane);
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
    pub(super) fn run(
        &mut self,
        target: Target,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Stopped {
        // What was too dear before may not be now.
        if target.error > self.most {
            self.sweep();
        }
        self.most = target.error;
        let target = target.triangles;
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
            self.read_ahead();
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

    /// Reads what the next looks will need, so that it is in the cache when their turn comes: they are all over the
    /// mesh, and simplification waits for memory more than for anything else. What is found by what was read has to
    /// wait for the next stage.
    #[inline]
    fn read_ahead(&self) {
        let Some([far, near, next]) = self.queue.ahead([14, 10, 6]) else { return };
        let partner = |vertex: u32| self.choices[vertex as usize].partner();
        let any_triangle = |vertex| self.fans.of(vertex).first().map_or(0, |&t| t);
        let corner = |&t: &u32| self.triangles[t as usize][0];
        let bits = self.read(far) ^ partner(far) ^ any_triangle(near) ^ self.read(partner(near));
        let corners = self.fans.of(next).iter().fold(0, |bits, t| bits ^ corner(t));
        black_box(bits ^ any_triangle(partner(next)) ^ corners);
    }

    /// Some bits of all that is kept of a vertex itself.
    #[inline]
    fn read(&self, vertex: u32) -> u32 {
        let at = vertex as usize;
        let marks = u32::from(self.marks[at]) ^ self.fans.of(vertex).len() as u32;
        marks ^ self.positions[at].x.to_bits() ^ self.quadrics[at].bits()
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
        let step = self.step(vertex, choice.partner());
        let may = self.may_contract(&step);
        if may {
            self.contract(&step)
        } else {
            self.choose(vertex, Some(choice))
        }
        may
    }

    /// What contracting two vertices means.
    fn step(&self, kept: u32, gone: u32) -> Step {
        let edge = self.place(gone) - self.place(kept);
        let shape = self.shape(kept, gone, edge);
        let spot = self.spot(kept, gone, edge, &(shape + self.looks(kept, gone, edge)));
        let area = f64::from(self.areas[kept as usize] + self.areas[gone as usize]);
        let position = if spot.place == DVec3::ZERO {
            self.positions[kept as usize]
        } else if spot.place == edge {
            self.positions[gone as usize]
        } else {
            ((self.place(kept) + spot.place) / self.scale).as_vec3()
        };
        let moved = position.as_dvec3() * self.scale - self.place(kept);
        let error = if area > 0.0 { shape.at(spot.place).max(0.0) / area } else { 0.0 };
        let way = Move {
            kept,
            gone,
            edge,
            to: if position == self.positions[gone as usize] { edge } else { moved },
        };
        Step { way, position, quadric: shape.seen_from(moved).pack(), error }
    }

    /// The error of both ends of an edge, seen from the first.
    #[inline]
    fn sum(&self, a: u32, b: u32, edge: DVec3) -> Form {
        match self.layers {
            None => self.shape(a, b, edge),
            Some(_) => self.shape(a, b, edge) + self.looks(a, b, edge),
        }
    }

    /// The part of the error that is distance.
    #[inline]
    fn shape(&self, a: u32, b: u32, edge: DVec3) -> Form {
        self.quadrics[a as usize].form() + self.quadrics[b as usize].form().seen_from(-edge)
    }

    /// The part of the error that is attributes.
    fn looks(&self, a: u32, b: u32, edge: DVec3) -> Form {
        let error = |layers: &Layers| layers.error(self.around(), a, b, edge);
        self.layers.as_ref().map_or(Form::default(), error)
    }

    /// Where the contraction of two vertices goes, seen from the first.
    #[inline]
    fn spot(&self, a: u32, b: u32, edge: DVec3, sum: &Form) -> Spot {
        let is_locked = |v: u32| self.marks[v as usize] & mark::LOCKED != 0;
        let area = |v: u32| f64::from(self.areas[v as usize]);
        let share = || {
            let share = area(b) / (area(a) + area(b));
            if share.is_finite() { share } else { 0.5 }
        };
        match (is_locked(a), is_locked(b)) {
            (false, false) => self.method.placement.spot(edge, share, sum),
            (true, _) => Spot::new(DVec3::ZERO, sum),
            (_, true) => Spot::new(edge, sum),
        }
    }

    /// Chooses the cheapest contraction of a vertex above that one, and puts it into the queue.
    fn choose(&mut self, vertex: u32, above: Option<Choice>) {
        let choice = self.cheapest(vertex, above.map_or(Choice(0), |Choice(c)| Choice(c + 1)));
        let marks = &mut self.marks[vertex as usize];
        *marks &= !(mark::IDLE | mark::SETTLED);
        *marks |= if above.is_some() { mark::SETTLED } else { 0 };
        if choice == Choice::NONE {
            *marks |= mark::IDLE;
            return;
        }
        self.choices[vertex as usize] = choice;
        self.queue.push(choice.cost(), vertex);
    }

    /// The cheapest contraction of a vertex from that one on.
    ///
    /// Where every edge has as many triangles in either direction it is enough to look at one corner of each.
    fn cheapest(&mut self, vertex: u32, from: Choice) -> Choice {
        let fan = self.fans.of(vertex);
        if fan.len() > LARGEST_FAN {
            return Choice::NONE;
        }
        let is_odd = self.marks[vertex as usize] & mark::ODD != 0;
        let mut partners = std::mem::take(&mut self.partners);
        partners.clear();
        let sides = fan.iter().map(|&t| others(self.triangles[t as usize], vertex));
        if is_odd {
            partners.extend(sides.flatten().filter(|&p| p > vertex));
        } else {
            partners.extend(sides.map(|[p, _]| p).filter(|&p| p > vertex));
        }
        // All are read before any is needed: one wait instead of one for each.
        black_box(partners.iter().fold(0, |bits, &p| bits ^ self.quadrics[p as usize].bits()));
        let mut cheapest = Choice::NONE;
        for &partner in &partners {
            let choice = Choice::new(self.cost(vertex, partner), partner);
            cheapest = if choice >= from { cheapest.min(choice) } else { cheapest };
        }
        self.partners = partners;
        cheapest
    }

    /// What contracting two vertices costs, in places to the fourth.
    #[inline]
    fn cost(&self, a: u32, b: u32) -> f32 {
        let edge = self.place(b) - self.place(a);
        let sum = self.sum(a, b, edge);
        let spread = SHORTER_FIRST * sum.weight() * edge.length_squared();
        (self.spot(a, b, edge, &sum).error + spread) as f32
    }

    /// Whether a step is allowed.
    fn may_contract(&mut self, step: &Step) -> bool {
        let &Step { way: Move { kept, gone, .. }, position, error, .. } = step;
        let to = position.as_dvec3() * self.scale;
        let both = self.marks[kept as usize] & self.marks[gone as usize];
        let keeps_topology = |stamps: &mut Stamps| {
            let complex = Complex { triangles: &self.triangles, fans: &self.fans };
            complex.may_contract(kept, gone, both & mark::BORDER != 0, stamps)
        };
        both & mark::LOCKED == 0
            && self.in_units(error) <= self.most
            && self.fans.of(kept).len() + self.fans.of(gone).len() <= LARGEST_FAN
            && self.guard_allows(kept, gone, to)
            && self.guard_allows(gone, kept, to)
            && (self.method.topology == Topology::Free
                || keeps_topology(&mut self.stamps) && self.keeps_charts(kept, gone))
    }

    /// Whether what is between seams stays whole: two vertices on seams may become one only along a seam.
    fn keeps_charts(&self, kept: u32, gone: u32) -> bool {
        let both = self.marks[kept as usize] & self.marks[gone as usize];
        let is_seam = |layers| both & mark::BORDER != 0 || self.is_seam(layers, [kept, gone]);
        both & mark::SEAM == 0 || self.layers.as_ref().is_none_or(is_seam)
    }

    /// The distance, in object units, of a squared one between places.
    fn in_units(&self, squared: f64) -> f32 {
        (squared.sqrt() / self.scale) as f32
    }

    /// Whether the triangles of a vertex, but for those that go with the edge to `other`, may follow it.
    fn guard_allows(&self, vertex: u32, other: u32, to: DVec3) -> bool {
        let from = self.place(vertex);
        self.fans.of(vertex).iter().all(|&t| {
            let [p, q] = others(self.triangles[t as usize], vertex);
            let side = || [self.place(p), self.place(q)];
            p == other || q == other || self.guard.allows(from, to, side(), self.facings[t as usize])
        })
    }

    /// Contracts `gone` into `kept`.
    fn contract(&mut self, step: &Step) {
        let Move { kept: heir, gone: parted, .. } = step.way;
        let (kept, gone) = (heir as usize, parted as usize);
        if let Some(layers) = &mut self.layers {
            layers.contract(Around { triangles: &self.triangles, fans: &self.fans }, &step.way);
        }
        if step.position == self.positions[gone] {
            self.origins[kept] = self.origins[gone];
        }
        self.positions[kept] = step.position;
        self.quadrics[kept] = step.quadric;
        self.areas[kept] += self.areas[gone];
        self.error = self.error.max(step.error);
        self.heirs[gone] = heir;
        self.marks[kept] |= self.marks[gone] & mark::INHERITED;
        self.merge_fans(heir, parted);
        self.marks[gone] = mark::GONE;
        self.choose(heir, None);
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

    /// Whether a triangle of `kept` stays one.
    fn keeps(&mut self, triangle: u32, kept: u32, gone: u32) -> bool {
        let [p, q] = others(self.triangles[triangle as usize], kept);
        self.disturb(p, kept, gone);
        self.disturb(q, kept, gone);
        (p != gone) & (q != gone)
    }

    /// Makes a triangle of `gone` one of `kept`, or removes it; returns whether it stays.
    fn hand_over(&mut self, triangle: u32, kept: u32, gone: u32) -> bool {
        let [p, q] = others(self.triangles[triangle as usize], gone);
        let goes = (p == kept) | (q == kept);
        self.disturb(p, kept, gone);
        self.disturb(q, kept, gone);
        if goes {
            self.live -= 1;
            self.triangles[triangle as usize] = GONE;
            self.fans.remove(if p == kept { q } else { p }, triangle);
        } else {
            let corners = &mut self.triangles[triangle as usize];
            *corners = corners.map(|corner| if corner == gone { kept } else { corner });
        }
        !goes
    }

    /// Has a neighbour of a contraction choose again, when its turn comes, if its choice is one of the two or if it had
    /// to settle for one. Any other choice is still its cheapest, since what has changed only became dearer.
    #[inline]
    fn disturb(&mut self, vertex: u32, kept: u32, gone: u32) {
        let marks = &mut self.marks[vertex as usize];
        let choice = self.choices[vertex as usize];
        let is_meant =
            (choice.partner() == kept) | (choice.partner() == gone) | (*marks & mark::SETTLED != 0);
        *marks |= mark::DIRTY * u8::from(is_meant);
        if *marks & (mark::IDLE | mark::DIRTY) == mark::IDLE | mark::DIRTY {
            *marks &= !mark::IDLE;
            self.queue.push(choice.cost(), vertex);
        }
    }

    /// What is left by now.
    pub(super) fn finish(&self, stopped: Stopped) -> Simplified {
        let left: Vec<usize> = (0..self.triangles.len()).filter(|&t| self.triangles[t] != GONE).collect();
        let wedges = self.wedges(&left);
        let facet = |(&t, wedges): (&usize, &[u32; 3])| self.facet(t, wedges);
        let facets: Vec<Facet> = left.iter().zip(&wedges).map(facet).collect();
        let mut rebuilt = Rebuilt::new(self.task.mesh, &self.positions, facets);
        if let Some(layers) = &self.layers {
            layers.write(&self.corners(&left, &wedges, &rebuilt.wedges), &mut rebuilt.mesh);
        }
        let Rebuilt { mesh, vertices, wedges: wedge_origins, position_of } = rebuilt;
        let origins = vertices.iter().map(|&v| self.origins[v as usize]).collect();
        let heirs = self.old_heirs(&position_of);
        Simplified { mesh, origins, wedge_origins, heirs, error: self.in_units(self.error), stopped }
    }

    /// Per triangle that is left, the old wedges whose attributes its corners have.
    fn wedges(&self, left: &[usize]) -> Vec<[u32; 3]> {
        let old = |&t: &usize| self.task.mesh.triangles[self.old_triangles[t] as usize];
        match &self.layers {
            Some(layers) => layers.looks(self.around(), left, &self.origins),
            None => left.iter().map(old).collect(),
        }
    }

    /// Per old wedge of a list, a triangle that is left and a corner of it that stands for it.
    fn corners(&self, left: &[usize], wedges: &[[u32; 3]], of: &[u32]) -> Vec<(usize, usize)> {
        let mut corner_of = vec![(0, 0); self.task.mesh.wedges.len()];
        for (&triangle, wedges) in left.iter().zip(wedges) {
            for (corner, &wedge) in wedges.iter().enumerate() {
                corner_of[wedge as usize] = (triangle, corner);
            }
        }
        of.iter().map(|&wedge| corner_of[wedge as usize]).collect()
    }

    fn facet(&self, triangle: usize, wedges: &[u32; 3]) -> Facet {
        let vertices = self.triangles[triangle];
        let corner = |i| Corner { vertex: vertices[i], wedge: wedges[i] };
        Facet { old: self.old_triangles[triangle], corners: [corner(0), corner(1), corner(2)] }
    }

    /// Per old vertex, the new index of its last heir.
    fn old_heirs(&self, new: &[u32]) -> Vec<u32> {
        let mut heirs = vec![Simplified::GONE; self.task.mesh.positions.len()];
        let mut last = self.heirs.clone();
        for (vertex, &old) in self.order.iter().enumerate() {
            // An heir is lower, so its own is known already.
            last[vertex] = last[last[vertex] as usize];
            heirs[old as usize] = new[last[vertex] as usize];
        }
        heirs
    }
}

/// What contracting two vertices means.
struct Step {
    way: Move,
    /// Where they go, in object units, and the error of the shape that is seen from there.
    position: Vec3,
    quadric: Quadric,
    /// Mean squared distance to the planes contracted so far, scaled.
    error: f64,
}

/// The triangles of a task in an order that keeps neighbours together, those that use a vertex twice left out.
struct Ordered {
    /// Per vertex that is used, its old index.
    origins: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// Per triangle, its old index.
    old_triangles: Vec<u32>,
    /// Per triangle, 1 at most.
    weights: Vec<f64>,
}

impl Ordered {
    fn new(task: &Task) -> Self {
        let old: Vec<[u32; 3]> = (0..task.mesh.triangles.len()).map(|t| task.mesh.corners(t)).collect();
        let is_triangle = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        let kept: Vec<u32> = (0..old.len() as u32).filter(|&t| is_triangle(&old[t as usize])).collect();
        let origins = along_curve(&task.mesh.positions, kept.iter().map(|&t| old[t as usize]));
        let mut new = vec![0; task.mesh.positions.len()];
        for (index, &vertex) in (0..).zip(&origins) {
            new[vertex as usize] = index;
        }
        let unsorted: Vec<[u32; 3]> =
            kept.iter().map(|&t| old[t as usize].map(|v| new[v as usize])).collect();
        let order = by_lowest_corner(&unsorted, origins.len());
        let most = task.weights.iter().fold(0.0, |most: f32, &w| most.max(w));
        let scale = if most > 0.0 { 1.0 / f64::from(most) } else { 1.0 };
        let old_triangles: Vec<u32> = order.iter().map(|&i| kept[i as usize]).collect();
        Self {
            triangles: order.iter().map(|&i| unsorted[i as usize]).collect(),
            weights: old_triangles.iter().map(|&t| task.weight(t as usize) * scale).collect(),
            old_triangles,
            origins,
        }
    }
}

/// The power of two that scales the box around the positions to a longest side between ½ and 1; 1 for a point.
fn scale_of(positions: &[Vec3]) -> f64 {
    let bounds = Aabb::around(positions.iter().copied());
    let extent = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element();
    if extent > 0.0 { (-extent.log2().ceil()).exp2() } else { 1.0 }
}
