//! The greedy: contract the edge that costs least, until there are few enough triangles.

mod choice;
mod disturbance;
mod outcome;
mod prepare;
mod sieve;
mod step;
mod verdict;
pub(in crate::bake) mod witness;

use std::hint::black_box;
use std::ops::ControlFlow;

use glam::{DVec3, Vec3};

use choice::Choice;
use disturbance::Disturbance;
use sieve::Sieve;
use step::Step;
use verdict::Verdict;
use witness::{Seen, Witness};

use crate::bake::simplify::fans::Fans;
use crate::bake::simplify::link::{Rings, Stamps};
use crate::bake::simplify::quadric::form::Quadric;
use crate::bake::simplify::quadric::guard::{Facing, Guard};
use crate::bake::simplify::quadric::layer::{Around, Move};
use crate::bake::simplify::quadric::layers::Layers;
use crate::bake::simplify::quadric::pairs::Pairs;
use crate::bake::simplify::quadric::patch::Patch;
use crate::bake::simplify::quadric::rest::Rest;
use crate::bake::simplify::quadric::{GarlandHeckbert, Topology};
use crate::bake::simplify::queue::Queue;
use crate::bake::simplify::{Progress, Stopped, Target, Task};

/// A vertex in more triangles waits until they are fewer: every contraction walks around both ends, and a fan of a
/// hundred thousand would make that quadratic.
const LARGEST_FAN: usize = 1024;

/// How many looks at the queue pass between two calls of the progress callback.
const STRIDE: usize = 4096;

/// The queue is filled again while at least one in so many vertices was contracted since it was.
const WORTH_A_SWEEP: usize = 64;

/// A mesh of fewer triangles is in the processor's cache as a whole, or nearly.
const LARGE: usize = 50_000;

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
    /// Where vertices are: positions in double precision, scaled, which loses nothing.
    places: Vec<DVec3>,
    quadrics: Vec<Quadric>,
    /// What was contracted into each vertex.
    patches: Vec<Patch>,
    triangles: Vec<[u32; 3]>,
    /// Per triangle, the old one that it was.
    old_triangles: Vec<u32>,
    /// Per triangle, where it faced before all contractions.
    facings: Vec<Facing>,
    fans: Fans,
    /// What may be contracted besides edges, if anything.
    pairs: Option<Pairs>,
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
    /// Whether changes of topology have no price any more.
    is_free: bool,
    /// The largest error that a step may have by now, in object units; negative before the first run.
    most: f32,
    /// Largest squared error so far, scaled.
    error: f64,
    /// Who looks on, if anybody does.
    pub(super) witness: Option<&'a mut dyn Witness>,
    /// The fan of a contracted vertex, in the making.
    fan: Sieve<u32>,
    /// The triangles that went with it, and their other corners.
    going: Sieve<(u32, u32)>,
    /// What a vertex may be contracted with.
    partners: Sieve<u32>,
    /// What is around both ends of the last contraction that was looked at, and what would be left of it.
    rings: Rings,
    rest: [Rest; 2],
}

impl<'a> Greedy<'a> {
    #[inline]
    fn place(&self, vertex: u32) -> DVec3 {
        self.places[vertex as usize]
    }

    /// Where a vertex is, in object units.
    fn position(&self, vertex: u32) -> Vec3 {
        (self.place(vertex) / self.scale).as_vec3()
    }

    fn positions(&self) -> Vec<Vec3> {
        (0..self.places.len() as u32).map(|v| self.position(v)).collect()
    }

    fn around(&self) -> Around<'_> {
        Around { triangles: &self.triangles, fans: &self.fans }
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
                None if self.method.topology == Topology::Free && !self.is_free => {
                    self.is_free = true;
                    present = self.sweep();
                }
                None => break,
            }
        }
        Stopped::Exhausted
    }

    /// Reads what the next looks will need, so that it is in the cache when their turn comes: they are all over the
    /// mesh, and simplification of a large one waits for memory more than for anything else. What is found by what was
    /// read has to wait for the next stage.
    #[inline]
    fn read_ahead(&self) {
        if self.from < LARGE {
            return;
        }
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
        marks ^ self.places[at].x.to_bits() as u32 ^ self.quadrics[at].bits()
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
        match may {
            Verdict::Yes => self.contract(&step),
            Verdict::No => self.choose(vertex, Some(choice)),
            Verdict::For(price) => self.put_off(vertex, choice, price),
        }
        matches!(may, Verdict::Yes)
    }

    /// Contracts `gone` into `kept`.
    fn contract(&mut self, step: &Step) {
        let Move { kept: heir, gone: parted, .. } = step.way;
        let (kept, gone) = (heir as usize, parted as usize);
        self.tell(|witness, seen| witness.before(seen, heir, parted));
        if let Some(layers) = &mut self.layers {
            layers.contract(Around { triangles: &self.triangles, fans: &self.fans }, &step.way);
        }
        if step.to == self.places[gone] {
            self.origins[kept] = self.origins[gone];
        }
        self.places[kept] = step.to;
        self.quadrics[kept] = step.quadric;
        self.patches[kept] = step.patch;
        self.error = self.error.max(step.error);
        self.heirs[gone] = heir;
        self.marks[kept] |= self.marks[gone] & mark::INHERITED;
        self.merge_fans(heir, parted);
        self.merge_pairs(heir, parted);
        self.tell(|witness, seen| witness.after(seen, heir, parted));
        self.marks[gone] = mark::GONE;
        self.choose(heir, None);
    }

    /// Tells the witness something, if there is one.
    #[inline]
    pub(super) fn tell(&mut self, tell: impl FnOnce(&mut dyn Witness, &Seen)) {
        if let Some(witness) = self.witness.take() {
            tell(witness, &Seen { greedy: self });
            self.witness = Some(witness);
        }
    }

    /// Gives `kept` the triangles of both but for those at the edge, which go, and has all neighbours choose again.
    fn merge_fans(&mut self, kept: u32, gone: u32) {
        let Self { fans, triangles, fan, going, .. } = self;
        let (marks, choices, queue) = (&mut self.marks, &self.choices, &mut self.queue);
        let is_odd = marks[kept as usize] & mark::ODD != 0;
        let mut disturbance = Disturbance { edge: [kept, gone], marks, choices, queue };
        fan.clear(self.rings[0].len() + self.rings[1].len() + 1);
        going.clear(self.rings[1].len() + 1);
        for (&triangle, &[p, q]) in fans.of(kept).iter().zip(&self.rings[0]) {
            disturbance.reach_side([p, q], is_odd);
            fan.add_if((p != gone) & (q != gone), triangle);
        }
        for (&triangle, &[p, q]) in fans.of(gone).iter().zip(&self.rings[1]) {
            disturbance.reach_side([p, q], is_odd);
            let (goes, far) = ((p == kept) | (q == kept), if p == kept { q } else { p });
            let corners = &mut triangles[triangle as usize];
            let instead = |corner| if corner == gone { kept } else { corner };
            *corners = corners.map(|corner| if goes { GONE[0] } else { instead(corner) });
            fan.add_if(!goes, triangle);
            going.add_if(goes, (far, triangle));
        }
        for &(far, triangle) in going.list() {
            fans.remove(far, triangle);
        }
        self.live -= going.list().len();
        fans.replace(gone, &[]);
        fans.replace(kept, fan.list());
    }

    /// Gives `kept` the pairs of both.
    fn merge_pairs(&mut self, kept: u32, gone: u32) {
        let Some(mut pairs) = self.pairs.take() else { return };
        let (marks, choices, queue) = (&mut self.marks, &self.choices, &mut self.queue);
        let mut disturbance = Disturbance { edge: [kept, gone], marks, choices, queue };
        for &partner in pairs.of(kept).iter().chain(pairs.of(gone)) {
            if partner != kept && partner != gone {
                disturbance.reach(partner);
            }
        }
        pairs.contract(kept, gone);
        self.pairs = Some(pairs);
    }
}
