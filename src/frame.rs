//! What passes between the stages of a frame. Sizes are in pixels (`_px`, `_px2`), times in microseconds (`_us`).

use std::fmt;

use crate::scene::{BLOCK, LevelRange, ObjectId, lanes};
use crate::table::Level;
use crate::view::Lens;

/// Which frame a measurement belongs to. The runtime numbers its frames from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FrameId(pub u64);

/// Views that show the same level of every object: two eyes, or a camera and its shadow views. Groups are numbered
/// by the caller, densely from 0; all memory of earlier frames is kept per group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GroupId(pub u32);

/// One object in view of one group: a class of the knapsack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The object's slot.
    pub slot: u32,
    /// The object's table.
    pub table: u16,
    /// The levels to choose from, already cut to the table. A range that ends in [`Level::NOT_DRAWN`] allows that
    /// the object is left out.
    pub allowed: LevelRange,
    /// Benefit in px² of showing the object perfectly, summed over the views of the group.
    pub weight: f32,
    /// The object's cost multiplier times the number of views that see it.
    pub cost_scale: f32,
    /// Largest projected diameter over the views, times the object's bias.
    pub size_px: f32,
    /// Largest projected length over the views of the object's bounding radius at its nearest point, times bias.
    pub near_px: f32,
    /// Projected area for the pixel stage, summed over the views, times the object's cost multiplier.
    pub area_px2: f32,
}

/// The candidates of a frame, column by column: groups in the order of their ids, slots ascending within a group.
///
/// The columns from `slot` to `area_px2` are *details*. Where a policy can do without them
/// ([`Selector::needs`](crate::select::Selector::needs)) they are left empty, all or all but `size_px`, and
/// [`Frame::candidate`](crate::select::Frame::candidate) works out those of a single candidate.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// How many there are. While they are being listed columns may have more: what is left of an earlier frame.
    len: usize,
    /// See [`Candidate::weight`].
    pub weight: Vec<f32>,
    /// The heaviest weight; 0 where there is no candidate.
    pub heaviest: f32,
    /// See [`Candidates::previous`]; [`NEWCOMER`] for an object that has just come into view.
    pub(crate) held: Vec<Level>,
    /// Where the level that was wanted in the last frame, or what was [chosen](Candidates::deferred) instead, stands
    /// among the levels of all tables ([`TableRates::index`](crate::rate::TableRates::index)), of a candidate that may
    /// choose among all levels of its table and counts once. [`NO_PLACE`] for any other, and for one that has just come
    /// into view.
    pub place: Vec<u32>,
    /// How many candidates there are at each place.
    pub census: Vec<u32>,
    /// Those for which the policy chose another level in the last frame than was wanted in the end, ascending
    /// ([`Selector::deferred`](crate::select::Selector::deferred)).
    pub deferred: Vec<Deferred>,
    /// See [`Candidate::slot`].
    pub slot: Vec<u32>,
    /// See [`Candidate::table`].
    pub table: Vec<u16>,
    /// See [`Candidate::allowed`].
    pub allowed: Vec<LevelRange>,
    /// See [`Candidate::cost_scale`].
    pub cost_scale: Vec<f32>,
    /// See [`Candidate::size_px`].
    pub size_px: Vec<f32>,
    /// See [`Candidate::near_px`].
    pub near_px: Vec<f32>,
    /// See [`Candidate::area_px2`].
    pub area_px2: Vec<f32>,
    /// Sum of [`Candidate::area_px2`].
    pub pixels: PixelSum,
    /// The blocks that the candidates are in, in the same order.
    pub rows: Vec<Row>,
    /// Of every sixteenth candidate, its row.
    row_of: Vec<u32>,
    /// Where each group's candidates end, in the order of groups.
    pub ends: Vec<GroupEnd>,
}

/// What is remembered of an object for a policy that does not show at once all that it has chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Account {
    /// For how long the policy has held back a finer level, at most what 16 bits hold; 0 when it does not.
    pub owed_ms: u16,
    /// What is in the leaky bucket that counts refinements: each puts in [`Account::REFINEMENT_DROPS`], each
    /// [`Account::LEAK_MS`] takes one drop away.
    pub drops: u8,
    /// The level that was wanted before the one that is. Any level where that is not known; then the one that is has
    /// been wanted for long.
    pub from: Level,
}

impl Default for Account {
    fn default() -> Self {
        Self::NEW
    }
}

impl Account {
    /// That of an object that has just come into view.
    pub const NEW: Self = Self { owed_ms: 0, drops: 0, from: Level::FINEST };

    /// So many drops a refinement puts into the bucket.
    pub const REFINEMENT_DROPS: u8 = 16;
    /// Time in which the bucket loses a drop.
    pub const LEAK_MS: u32 = 16;

    /// The account after so long: what is owed goes on being owed.
    pub(crate) fn after(self, owed_for_ms: u16, leaking_for_ms: u32) -> Self {
        let leaked = (leaking_for_ms / Self::LEAK_MS).min(u32::from(u8::MAX)) as u8;
        let owed_ms = if self.owed_ms > 0 { self.owed_ms.saturating_add(owed_for_ms) } else { 0 };
        Self { owed_ms, drops: self.drops.saturating_sub(leaked), ..self }
    }
}

/// A candidate whose place is not that of the level it holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deferred {
    /// Which one it is.
    pub candidate: u32,
    /// Its slot.
    pub slot: u32,
}

/// A candidate for which a policy has chosen a level, and keeps what it holds all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deferral {
    /// Which one it is.
    pub candidate: u32,
    /// Its slot.
    pub slot: u32,
    /// The level that was chosen.
    pub chosen: Level,
    /// Whether that is owed to the object: it is better, and costs more.
    pub owed: bool,
}

/// What a frame can be asked of earlier ones about an object in view that was in view before.
pub trait Memory: fmt::Debug {
    /// What is remembered of it.
    fn recall(&self, group: GroupId, slot: u32) -> Remembered;
}

/// What is remembered of an object in view besides the level that was wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Remembered {
    /// How long that has been wanted.
    pub age_ms: u32,
    /// What the policy owes to it: nothing where no accounts are kept
    /// ([`Selector::deferred`](crate::select::Selector::deferred)).
    pub account: Account,
}

/// No frame came before.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMemory;

impl Memory for NoMemory {
    fn recall(&self, _: GroupId, _: u32) -> Remembered {
        Remembered::default()
    }
}

/// See [`Candidates::place`].
pub const NO_PLACE: u32 = u32::MAX;

/// No table has so many levels.
pub(crate) const NEWCOMER: Level = Level(u8::MAX - 1);

/// The candidates of one group in one block of objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// Index into [`Objects::blocks`](crate::scene::Objects::blocks).
    pub block: u32,
    /// Bit per lane that is a candidate, at least one of them set.
    pub mask: u16,
    /// Those of them that were candidates in the last frame as well.
    pub known: u16,
    /// Those of these that are [deferred](Candidates::deferred).
    pub deferred: u16,
    /// Its first candidate.
    pub first: u32,
}

impl Row {
    /// The candidates in the lanes of `deferred`.
    fn deferred(&self) -> impl Iterator<Item = Deferred> + '_ {
        lanes(self.deferred).map(|lane| {
            let before = self.mask & ((1u16 << lane) - 1);
            Deferred {
                candidate: self.first + before.count_ones(),
                slot: self.block * BLOCK as u32 + lane as u32,
            }
        })
    }

    /// The slot of candidate `i`, which is one of the row's.
    pub fn slot_of(&self, i: usize) -> u32 {
        let nth = i - self.first as usize;
        let lane = if self.mask == u16::MAX { Some(nth) } else { lanes(self.mask).nth(nth) };
        self.block * BLOCK as u32 + lane.unwrap_or(0) as u32
    }
}

/// The end of a group's run in [`Candidates`]; it starts where the run before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupEnd {
    /// The group.
    pub group: GroupId,
    /// One past its last candidate.
    pub end: usize,
    /// One past its last row.
    pub end_row: usize,
    /// How many views it has.
    pub views: usize,
    /// The group's first view.
    pub lens: Lens,
}

/// A sum of areas that does not depend on the order of its terms: each is rounded to 2⁻⁶ px², and sums of such numbers
/// below 2⁴⁷ px² are exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelSum(f64);

impl PixelSum {
    /// Adding and subtracting this rounds to 2⁻⁶.
    const ROUND: f64 = 3.0 * (1u64 << 45) as f64;

    /// An area as it counts.
    #[inline(always)]
    pub fn rounded(area_px2: f32) -> f64 {
        (f64::from(area_px2) + Self::ROUND) - Self::ROUND
    }

    /// Adds an area that has been rounded, or a sum of such.
    pub fn add(&mut self, rounded_px2: f64) {
        self.0 += rounded_px2;
    }

    /// The sum in px².
    pub fn px2(self) -> f64 {
        self.0
    }
}

impl Candidates {
    /// How many candidates there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether the columns of details are filled.
    pub fn is_detailed(&self) -> bool {
        self.table.len() == self.len()
    }

    /// Forgets all candidates and keeps the memory. `places` is how many levels all tables have.
    pub fn clear(&mut self, places: usize) {
        self.begin(places);
        self.end();
    }

    /// [`Candidates::clear`] of a list that will be about as long as the last one was: its columns are overwritten, which
    /// spares filling them with zeros. To be concluded by [`Candidates::end`].
    pub(crate) fn begin(&mut self, places: usize) {
        self.len = 0;
        self.heaviest = 0.0;
        self.census.clear();
        self.census.resize(places, 0);
        self.clear_details();
        self.pixels = PixelSum::default();
        self.deferred.clear();
        self.rows.clear();
        self.row_of.clear();
        self.ends.clear();
    }

    /// Concludes a list.
    pub(crate) fn end(&mut self) {
        self.weight.truncate(self.len);
        self.held.truncate(self.len);
        self.place.truncate(self.len);
    }

    /// Adds the candidates of blocks, given with their masks. Their weights are yet to be written.
    pub(crate) fn push_blocks(&mut self, blocks: impl Iterator<Item = (u32, u16)>) {
        blocks.for_each(|(block, mask)| self.begin_row(block, mask));
        self.weight.resize(self.len, 0.0);
    }

    fn begin_row(&mut self, block: u32, mask: u16) {
        self.rows.push(Row { block, mask, known: 0, deferred: 0, first: self.len as u32 });
        self.len += mask.count_ones() as usize;
        if self.row_of.len() * BLOCK < self.len {
            self.row_of.push(self.rows.len() as u32 - 1);
        }
    }

    /// Makes the columns of memory as long as the others. They are yet to be written.
    pub(crate) fn make_room_for_memory(&mut self) {
        self.held.resize(self.len, NEWCOMER);
        self.place.resize(self.len, NO_PLACE);
    }

    /// Empties the columns of details.
    pub fn clear_details(&mut self) {
        self.slot.clear();
        self.table.clear();
        self.allowed.clear();
        self.cost_scale.clear();
        self.size_px.clear();
        self.near_px.clear();
        self.area_px2.clear();
    }

    /// Adds the candidates of a block: those in `mask`, with the weights in their lanes. Not their details, not their
    /// memory of earlier frames.
    pub fn push_row(&mut self, block: u32, mask: u16, weight: &[f32; BLOCK]) {
        self.weight.truncate(self.len);
        self.begin_row(block, mask);
        for lane in lanes(mask) {
            self.weight.push(weight[lane]);
            self.heaviest = self.heaviest.max(weight[lane]);
        }
    }

    /// Adds the sizes in the lanes of `mask` of a block.
    pub fn push_sizes(&mut self, mask: u16, size_px: &[f32; BLOCK]) {
        if mask == u16::MAX {
            self.size_px.extend_from_slice(size_px);
        } else {
            self.size_px.extend(lanes(mask).map(|lane| size_px[lane]));
        }
    }

    /// Adds a candidate without memory of earlier frames, and its details.
    pub fn push(&mut self, c: Candidate) {
        self.weight.truncate(self.len);
        self.weight.push(c.weight);
        self.heaviest = self.heaviest.max(c.weight);
        self.len += 1;
        self.pixels.add(PixelSum::rounded(c.area_px2));
        self.push_details(c);
        self.forget_memory();
    }

    /// Adds to the columns of details alone.
    pub fn push_details(&mut self, c: Candidate) {
        self.slot.push(c.slot);
        self.table.push(c.table);
        self.allowed.push(c.allowed);
        self.cost_scale.push(c.cost_scale);
        self.size_px.push(c.size_px);
        self.near_px.push(c.near_px);
        self.area_px2.push(c.area_px2);
    }

    /// Gives the candidate that was pushed last no memory of earlier frames.
    fn forget_memory(&mut self) {
        self.held.truncate(self.len - 1);
        self.place.truncate(self.len - 1);
        self.make_room_for_memory();
    }

    /// What was wanted of candidate `i` in the last frame; `None` for an object that has just come into view.
    pub fn previous(&self, i: usize) -> Option<Level> {
        Some(self.held[i]).filter(|&level| level != NEWCOMER)
    }

    /// The slot of candidate `i`. O(1).
    pub fn slot_of(&self, i: usize) -> u32 {
        match self.slot.get(i) {
            Some(&slot) => slot,
            None => self.row_of(i).slot_of(i),
        }
    }

    /// The row of candidate `i`, which is not detailed: at most sixteen rows on from that of the sixteenth before.
    fn row_of(&self, i: usize) -> &Row {
        let rows = &self.rows[self.row_of[i / BLOCK] as usize..];
        &rows[rows[1..].iter().take_while(|row| row.first as usize <= i).count()]
    }

    /// The slots of candidates, in order.
    pub fn slots(&self) -> impl Iterator<Item = u32> + '_ {
        (self.rows.iter()).flat_map(|row| lanes(row.mask).map(|lane| row.block * BLOCK as u32 + lane as u32))
    }

    /// One candidate, across the columns, which must be [detailed](Candidates::is_detailed).
    pub fn get(&self, i: usize) -> Candidate {
        Candidate {
            slot: self.slot[i],
            table: self.table[i],
            allowed: self.allowed[i],
            weight: self.weight[i],
            cost_scale: self.cost_scale[i],
            size_px: self.size_px[i],
            near_px: self.near_px[i],
            area_px2: self.area_px2[i],
        }
    }

    /// Rewrites details. No candidate keeps its place: what it costs may no longer be what its table says.
    pub fn revise(&mut self, mut change: impl FnMut(&mut Candidate)) {
        self.pixels = PixelSum::default();
        self.place.fill(NO_PLACE);
        self.census.fill(0);
        self.heaviest = 0.0;
        for i in 0..self.len() {
            let mut candidate = self.get(i);
            change(&mut candidate);
            self.weight[i] = candidate.weight;
            self.heaviest = self.heaviest.max(candidate.weight);
            self.allowed[i] = candidate.allowed;
            self.cost_scale[i] = candidate.cost_scale;
            self.size_px[i] = candidate.size_px;
            self.near_px[i] = candidate.near_px;
            self.area_px2[i] = candidate.area_px2;
            self.pixels.add(PixelSum::rounded(candidate.area_px2));
        }
    }

    /// Closes the run of `group`, the first of whose views is seen through `lens`.
    pub fn end_group(&mut self, group: GroupId, lens: Lens, views: usize) {
        self.ends.push(GroupEnd { group, end: self.len(), end_row: self.rows.len(), views, lens });
    }

    /// The candidate of a group that lives in `slot`.
    pub fn find(&self, group: GroupId, slot: u32) -> Option<usize> {
        let run = self.ends.binary_search_by_key(&group, |g| g.group).ok()?;
        let first_row = if run == 0 { 0 } else { self.ends[run - 1].end_row };
        let rows = &self.rows[first_row..self.ends[run].end_row];
        let (block, lane) = (slot / BLOCK as u32, slot % BLOCK as u32);
        let row = rows[rows.binary_search_by_key(&block, |row| row.block).ok()?];
        let before = row.mask & ((1u16 << lane) - 1);
        (row.mask & (1 << lane) != 0).then(|| row.first as usize + before.count_ones() as usize)
    }

    /// The group that candidate `i` belongs to.
    pub fn group_of(&self, i: usize) -> GroupId {
        let run = self.ends.partition_point(|g| g.end <= i);
        self.ends.get(run).map_or(GroupId(0), |g| g.group)
    }

    /// The groups of this frame and their candidates.
    pub fn groups(&self) -> impl Iterator<Item = (GroupEnd, std::ops::Range<usize>)> + '_ {
        let starts = std::iter::once(0).chain(self.ends.iter().map(|g| g.end));
        self.ends.iter().zip(starts).map(|(&group, start)| (group, start..group.end))
    }

    /// The candidates of the group at `run` in [`Candidates::ends`].
    pub fn run(&self, run: usize) -> std::ops::Range<usize> {
        let start = if run == 0 { 0 } else { self.ends[run - 1].end };
        start..self.ends[run].end
    }

    /// Lists who is deferred, by what the rows say.
    pub(crate) fn list_deferred(&mut self) {
        for row in self.rows.iter().filter(|row| row.deferred != 0) {
            row.deferred().for_each(|deferred| self.deferred.push(deferred));
        }
    }

    /// Whether the census counts what is at each place, as far as two sums can tell.
    pub(crate) fn is_census_right(&self) -> bool {
        let code = |place: u32| (u64::from(place) + 1).wrapping_pow(5);
        let placed = self.place.iter().filter(|&&place| place != NO_PLACE);
        let found = placed.fold(0u64, |sum, &place| sum.wrapping_add(code(place)));
        let counted =
            |sum: u64, (place, &count): (u32, &u32)| sum.wrapping_add(code(place).wrapping_mul(count.into()));
        found == (0..).zip(&self.census).fold(0, counted)
    }

    /// The candidates without a [place](Candidates::place).
    pub fn unplaced(&self) -> impl Iterator<Item = usize> + '_ {
        let placed: u64 = self.census.iter().map(|&count| u64::from(count)).sum();
        let all = if placed == self.place.len() as u64 { 0 } else { self.place.len() };
        // Most chunks hold none, and looking at all of one takes a few instructions.
        let chunks = self.place[..all].chunks(BLOCK).enumerate();
        let some = chunks.filter(|(_, chunk)| chunk.iter().fold(false, |any, &p| any | (p == NO_PLACE)));
        let places = some.flat_map(|(at, chunk)| chunk.iter().zip(at * BLOCK..));
        places.filter(|&(&place, _)| place == NO_PLACE).map(|(_, i)| i)
    }

    /// The candidates of a group; empty for a group that is not in this frame.
    pub fn range(&self, group: GroupId) -> std::ops::Range<usize> {
        self.groups().find(|(g, _)| g.group == group).map_or(0..0, |(_, range)| range)
    }
}

/// What a measured time is a measurement of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clock {
    /// How long the machine was busy with the frame.
    Busy,
    /// From one presented image to the next under vertical synchronisation: a whole number of intervals, which says
    /// no more than that the work fits so many of them.
    Vsync {
        /// The display's interval.
        interval_us: f32,
    },
}

/// How long a frame took. It may arrive any number of frames later; it is matched by its id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTime {
    /// The frame that was measured.
    pub frame: FrameId,
    /// Its time.
    pub time_us: f32,
    /// What the time is a measurement of.
    pub clock: Clock,
}

impl FrameTime {
    /// A busy time.
    pub fn busy(frame: FrameId, time_us: f32) -> Self {
        Self { frame, time_us, clock: Clock::Busy }
    }
}

/// What the frame may cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// The time that the caller gives the frame.
    pub frame_us: f64,
    /// The time to aim at: the frame's less headroom.
    pub target_us: f64,
    /// What the selection may spend by the cost model: the target less the fade reserve, divided by how much slower
    /// the machine has shown to be than the model says.
    pub select_us: f64,
}

/// How sure a selection is to be the best one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Certificate {
    /// No selection within the budget has more benefit than this, in px².
    pub upper_bound: f64,
    /// (bound − benefit) ÷ (bound − benefit of the minimum choice), of the plain benefit; 0 where that is 0 ÷ 0.
    pub gap: f64,
    /// The same of the objective with switching prices folded in; under [`Steadiness`](crate::select::Steadiness), of
    /// the choice that is led to.
    pub penalised_gap: f64,
    /// The multiplier λ: what a microsecond is worth in px² where the budget ends; 0 when everything fits.
    pub lambda: f64,
}

/// What is known of the time that frames take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// Measured time after the filter; 0 until there is one.
    pub filtered_us: f64,
    /// Measurements that entered the filter since the last frame: hitches and paused frames do not.
    pub fresh: usize,
    /// The newest measurement says no more than that the frame fits its display interval.
    pub censored: bool,
}

/// What a selector reports about a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SelectReport {
    /// Predicted cost of the selection.
    pub cost_us: f64,
    /// Benefit of the selection in px².
    pub benefit: f64,
    /// Proof of quality; only selectors that optimise have one, and only where the budget can be met.
    pub certificate: Option<Certificate>,
    /// By how much even the minimum choice exceeds the budget; 0 where the budget can be met.
    pub infeasible_us: f64,
    /// Steps looked at one by one.
    pub steps: usize,
}

/// Counts and sums of one frame of the runtime.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameReport {
    /// The frame.
    pub frame: FrameId,
    /// Views that were left out because [`crate::view::View::check`] refuses them.
    pub broken_views: usize,
    /// Objects left out because their bound is not finite.
    pub broken_bounds: usize,
    /// Tree nodes visited by culling.
    pub visited_nodes: usize,
    /// Objects tested one by one by culling.
    pub tested_objects: usize,
    /// Objects in view, summed over groups.
    pub candidates: usize,
    /// Objects that may be left out and are worth less than this, in px² per µs, were not looked at.
    pub floor: f64,
    /// How many those were, some of them out of view.
    pub worth_too_little: usize,
    /// Objects that changed the level that is wanted for them, those that came into view not counted.
    pub switches: usize,
    /// Fades in flight.
    pub fades: usize,
    /// Predicted cost of the outgoing levels of fades in flight.
    pub fades_us: f64,
    /// What the selection was given.
    pub budget: Budget,
    /// What the selector says.
    pub select: SelectReport,
    /// Predicted time of what is shown, fades included, as the machine has shown to be.
    pub predicted_us: f64,
    /// Measured time after the filter; 0 until there is one.
    pub filtered_us: f64,
}

/// Why an object is shown at the level it is shown at, and at no finer one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// It is at its finest level.
    Finest,
    /// A finer level would cost more than it is worth under the budget, or is not called for by its size.
    Budget,
    /// Finer levels are not in memory.
    NotResident,
    /// The caller forces the level.
    Forced,
    /// The caller's clamp forbids finer levels.
    Clamped,
    /// It switched too recently.
    Dwell,
    /// Another level would be better, but not by enough to switch.
    Hysteresis,
    /// A fade is on its way, or waits for the fade reserve.
    Fading,
    /// It is too small, too far away or worth too little to be drawn.
    TooSmall,
    /// It is out of view, hidden or gone.
    OutOfView,
}

/// A change of what is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// In which group of views.
    pub group: GroupId,
    /// The object.
    pub object: ObjectId,
    /// What was shown before.
    pub old: Level,
    /// What is shown now; of a fade, the level that it leads to.
    pub new: Level,
    /// Why not finer.
    pub cause: Cause,
}

/// Why options were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OptionsError {
    /// The option.
    pub option: &'static str,
    /// The rule it breaks.
    pub rule: &'static str,
}

impl OptionsError {
    /// `Ok` when `holds`, else an error that states `rule`.
    pub(crate) fn unless(holds: bool, option: &'static str, rule: &'static str) -> Result<(), OptionsError> {
        if holds { Ok(()) } else { Err(OptionsError { option, rule }) }
    }
}

impl fmt::Display for OptionsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "option {}: {}", self.option, self.rule)
    }
}

impl std::error::Error for OptionsError {}
