//! The loop: owns scratch and the memory of each view group, and runs the stages of a frame in order.
//!
//! Everything a frame needs from the frames before it is kept here, per view group and object; stages are functions
//! over borrowed slices and can be called without it.

mod explain;
mod memory;
mod tally;
mod visibility;

pub use explain::Explanation;
pub use visibility::Visibility;

use std::ops::Range;

use crate::cull::{BlockTree, CullOptions, CullReport, ValueFloor};
use crate::feedback::{Feedback, FeedbackOptions, Prediction};
use crate::frame::{
    Candidates, Change, FrameId, FrameReport, FrameTime, GroupEnd, GroupId, Memory, NO_PLACE, NoMemory,
};
use crate::frame::{Deferred, OptionsError};
use crate::knapsack::FixedSum;
use crate::rate::{BenefitModel, CostModel, Drivers, Seen, Stages, TableRates, rate, weigh};
use crate::scene::{BLOCK, ObjectId, Objects};
use crate::select::{Frame, Needs, Selector};
use crate::table::Level;
use crate::transition::{Shown, TransitionKind, TransitionOptions, follow};
use crate::view::View;
use memory::{GroupMemory, Groups, Layout, Places, Recalled};
use tally::Tally;

/// Options of a [`Runtime`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RuntimeOptions {
    /// What drawing is worth.
    pub benefit: BenefitModel,
    /// What drawing costs, as far as is known before the first measurement.
    pub cost: CostModel,
    /// What is left out for being too small.
    pub cull: CullOptions,
    /// How one level gives way to another.
    pub transition: TransitionOptions,
    /// How measurements are learnt from.
    pub feedback: FeedbackOptions,
    /// On how many threads, of the rayon pool that the caller of a frame is in, loops over many thousand objects run;
    /// without the feature `rayon`, and where it is less than 2, on the caller's alone. Frames on several threads may
    /// allocate; answers are the same.
    pub threads: usize,
}

/// One camera of a frame.
#[derive(Clone, Copy, Debug)]
pub struct ViewInput<'a> {
    /// The camera.
    pub view: View,
    /// The group it belongs to: views of a group show the same levels.
    pub group: GroupId,
    /// What is visible in it.
    pub visibility: Visibility<'a>,
}

impl ViewInput<'_> {
    /// A view culled by the runtime.
    pub fn new(view: View, group: u32) -> Self {
        Self { view, group: GroupId(group), visibility: Visibility::Computed }
    }
}

/// Whether the caller's window is in use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Activity {
    /// Frames are shown as usual.
    #[default]
    Running,
    /// In the background, minimised or behind a menu: what is measured says nothing, and is not learnt from.
    Paused,
}

/// What the runtime is told about a frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameInput<'a> {
    /// The cameras, in any order and number. A group without a view in this frame stays as it is.
    pub views: &'a [ViewInput<'a>],
    /// Time since the last frame, which transitions and dwell run by. Taken as 0 when negative or not a number.
    pub dt_s: f32,
    /// What the objects of this frame may cost the machine. Taken as 0 when negative or not a number.
    pub budget_us: f64,
    /// Measured times of earlier frames that have become known.
    pub measured: &'a [FrameTime],
    /// Whether the caller's window is in use.
    pub activity: Activity,
}

impl<'a> FrameInput<'a> {
    /// A running frame without measurements, 1/60 s after the last.
    pub fn new(views: &'a [ViewInput<'a>], budget_us: f64) -> Self {
        Self { views, dt_s: 1.0 / 60.0, budget_us, measured: &[], activity: Activity::Running }
    }
}

/// Chooses the levels of all views, frame by frame.
///
/// A clone is a snapshot: it continues from here in the same way. [`Runtime::reset`] forgets everything.
#[derive(Clone)]
pub struct Runtime {
    options: RuntimeOptions,
    selector: Box<dyn Selector>,
    feedback: Feedback,
    tree: BlockTree,
    rates: TableRates,
    rated: Option<Rated>,
    /// Whether some objects may be left out, at this revision of them.
    skippable: (u64, bool),
    layout: Layout,
    groups: Groups,
    clock_ms: f64,
    report: FrameReport,
    changes: Vec<Change>,
    scratch: Scratch,
}

/// What the rates were made from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rated {
    tables_revision: u64,
    model_revision: u64,
}

/// Memory that is overwritten every frame.
#[derive(Clone, Debug, Default)]
struct Scratch {
    /// Views that can be used, by group.
    order: Vec<usize>,
    seen: Vec<Seen>,
    cursors: Vec<usize>,
    candidates: Candidates,
    levels: Vec<Level>,
    /// Candidates whose transition is in flight, or who were not shown as wanted in the last frame.
    unsteady: Vec<usize>,
    /// Candidates that have come into view, or are not shown as they are wanted: of one group, and of all.
    news: Vec<usize>,
    all_news: Vec<usize>,
    /// Candidates whose shown level is not the one that is wanted, and what they show.
    requests: Vec<(usize, Shown)>,
    tally: Tally,
}

impl Runtime {
    /// A runtime with this policy.
    ///
    /// # Errors
    /// An option that is out of its range.
    pub fn new(options: RuntimeOptions, selector: Box<dyn Selector>) -> Result<Self, OptionsError> {
        options.transition.check()?;
        options.benefit.check()?;
        Ok(Self {
            options,
            selector,
            feedback: Feedback::new(options.feedback, options.cost)?,
            tree: BlockTree::default(),
            rates: TableRates::default(),
            rated: None,
            skippable: (0, false),
            layout: Layout::default(),
            groups: Groups::default(),
            clock_ms: 0.0,
            report: FrameReport::default(),
            changes: Vec::new(),
            scratch: Scratch::default(),
        })
    }

    /// Runs one frame. Afterwards [`Runtime::changes`] lists what to upload and [`Runtime::shown`] knows every level.
    ///
    /// Allocates nothing once it has seen as many objects, views and changes before. Objects may be re-arranged (their
    /// slots, not their ids).
    pub fn frame(&mut self, objects: &mut Objects, input: &FrameInput<'_>) -> &FrameReport {
        self.begin(objects, input);
        self.find_candidates(objects, input);
        let fades_us = self.remember(objects);
        self.choose(objects, input.budget_us, fades_us);
        self.show(objects);
        self.account(objects, input.activity);
        &self.report
    }

    /// What has changed with the last frame, by group, then object.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Counts and sums of the last frame.
    pub fn report(&self) -> &FrameReport {
        &self.report
    }

    /// What is shown of an object to a group; nothing of an object that is out of view.
    pub fn shown(&self, objects: &Objects, group: GroupId, id: ObjectId) -> Shown {
        let found = objects.slot_of(id).zip(self.groups.get(group));
        found.and_then(|(slot, memory)| memory.visible(slot)).unwrap_or(Shown::NOTHING)
    }

    /// Everything in view of a group: slots ascending, and what is shown of the objects in them.
    pub fn shown_slots(&self, group: GroupId) -> impl Iterator<Item = (usize, Shown)> + '_ {
        self.groups.get(group).into_iter().flat_map(GroupMemory::shown)
    }

    /// The cost model in use, refitted by feedback.
    pub fn cost_model(&self) -> &CostModel {
        self.feedback.model()
    }

    /// The candidates of the last frame. Those of a policy that does without details have none:
    /// [`Frame::detailed`] of [`Runtime::last_frame`] fills them in.
    pub fn candidates(&self) -> &Candidates {
        &self.scratch.candidates
    }

    /// The level that the policy wants for each candidate of the last frame.
    pub fn wanted(&self) -> &[Level] {
        &self.scratch.levels
    }

    /// The last frame as the selector saw it.
    pub fn last_frame<'a>(&'a self, objects: &'a Objects) -> Frame<'a> {
        let Self { rates, feedback, groups, report, .. } = self;
        let frame = frame_of(objects, &self.scratch.candidates, rates, feedback, groups, report);
        Frame { threads: self.options.threads, ..frame }
    }

    /// Forgets everything learnt and shown, as if no frame had been run; the next changes start from nothing. The next
    /// frame may be of other objects.
    pub fn reset(&mut self) {
        self.selector.reset();
        self.feedback.reset(self.options.cost);
        self.tree = BlockTree::default();
        self.rated = None;
        self.skippable = (0, false);
        self.layout = Layout::default();
        self.groups.clear();
        self.clock_ms = 0.0;
        self.report = FrameReport::default();
        self.changes.clear();
        self.scratch.candidates.clear(0);
        self.scratch.levels.clear();
    }

    /// Advances the clock, learns from measurements, and brings up to date what is kept per slot and per table.
    fn begin(&mut self, objects: &mut Objects, input: &FrameInput<'_>) {
        let frame = FrameId(self.report.frame.0 + 1);
        let broken_bounds = objects.broken_bounds();
        let floor = if self.some_may_be_left_out(objects) { self.selector.floor() } else { 0.0 };
        self.report = FrameReport { frame, broken_bounds, floor, ..FrameReport::default() };
        self.changes.clear();
        self.clock_ms += elapsed_ms(input.dt_s);
        self.feedback.measure(input.measured);
        let tables_revision = objects.tables_revision();
        let rated = Rated { tables_revision, model_revision: self.feedback.model_revision() };
        if self.rated != Some(rated) {
            self.rates.renew(objects.tables(), self.feedback.model());
            self.tree.expect_slopes(self.rates.best_slopes());
            self.rated = Some(rated);
        }
        self.tree.update(objects);
        self.layout.follow(objects, &mut self.groups, &mut self.changes);
    }

    /// Whether the selection may leave out any object.
    fn some_may_be_left_out(&mut self, objects: &Objects) -> bool {
        let revision = objects.revision();
        if self.skippable.0 != revision {
            self.skippable = (revision, objects.blocks().iter().any(|b| b.skippable & b.live != 0));
        }
        self.skippable.1
    }

    /// Culls every view and rates what each group sees.
    fn find_candidates(&mut self, objects: &Objects, input: &FrameInput<'_>) {
        let views = input.views;
        self.order_views(views);
        let in_detail = self.is_in_detail(views);
        self.scratch.candidates.begin(self.rates.len());
        let mut first = 0;
        while let Some(&view) = self.scratch.order.get(first) {
            let group = views[view].group;
            let rest = &self.scratch.order[first..];
            let count = rest.iter().take_while(|&&i| views[i].group == group).count();
            self.cull_group(objects, views, first..first + count);
            let Scratch { seen, cursors, candidates, .. } = &mut self.scratch;
            if in_detail {
                rate(objects, &self.rates, &seen[..count], &self.options.benefit, cursors, candidates);
            } else {
                let with_sizes = self.selector.needs() == Needs::Sizes;
                let RuntimeOptions { benefit, threads, .. } = &self.options;
                weigh(objects, &seen[0], benefit, with_sizes, *threads, candidates);
            }
            candidates.end_group(group, seen[0].lens, count);
            first += count;
        }
        self.scratch.candidates.end();
        self.report.candidates = self.scratch.candidates.len();
    }

    /// Lists the views that can be used, by group.
    fn order_views(&mut self, views: &[ViewInput<'_>]) {
        let order = &mut self.scratch.order;
        order.clear();
        order.extend((0..views.len()).filter(|&i| views[i].view.check().is_ok()));
        order.sort_unstable_by_key(|&i| (views[i].group, i));
        self.report.broken_views = views.len() - order.len();
    }

    /// Whether candidates have to be rated in detail: for a policy that asks for it, and wherever details of one
    /// candidate could not be worked out from one view alone.
    fn is_in_detail(&self, views: &[ViewInput<'_>]) -> bool {
        let several = self.scratch.order.windows(2).any(|pair| views[pair[0]].group == views[pair[1]].group);
        self.selector.needs() == Needs::Details
            || several
            || self.options.benefit.enough_px > 0.0
            || self.feedback.model().stages == Stages::Max
    }

    /// Culls the views of one group, given by their places in [`Scratch::order`].
    fn cull_group(&mut self, objects: &Objects, views: &[ViewInput<'_>], members: Range<usize>) {
        // Where several views see the same objects, one of them cannot tell what an object is worth.
        let lambda = if members.len() == 1 { self.report.floor } else { 0.0 };
        let floor = ValueFloor { lambda, best_slope: self.rates.best_slopes() };
        for (at, member) in members.enumerate() {
            let input = &views[self.scratch.order[member]];
            let lens = input.view.lens(objects.origin());
            match self.scratch.seen.get_mut(at) {
                Some(seen) => seen.lens = lens,
                None => self.scratch.seen.push(Seen { lens, visible: Vec::new() }),
            }
            let seen = &mut self.scratch.seen[at];
            let culled =
                visibility::find(&self.tree, objects, &self.options.cull, &floor, input.visibility, seen);
            count_culled(&mut self.report, &culled);
        }
    }

    /// Fills in what was wanted of each candidate before, and advances its transition. Returns what the outgoing levels
    /// of transitions in flight cost, by the model.
    fn remember(&mut self, objects: &Objects) -> f64 {
        self.scratch.unsteady.clear();
        self.scratch.candidates.make_room_for_memory();
        self.scratch.levels.resize(self.scratch.candidates.len(), Level::NOT_DRAWN);
        let mut fades_us = FixedSum::default();
        let mut first_row = 0;
        for run in 0..self.scratch.candidates.ends.len() {
            let GroupEnd { group, end_row, .. } = self.scratch.candidates.ends[run];
            let dt_ms = self.recall(objects, run, first_row..end_row);
            self.advance(objects, group, dt_ms as f32, &mut fades_us);
            first_row = end_row;
        }
        self.scratch.candidates.list_deferred();
        debug_assert!(self.scratch.candidates.is_census_right());
        fades_us.value()
    }

    /// Recalls what was wanted of the candidates of a group, which are in `rows`, and lists what has left its view.
    /// Returns the time since the group's last frame.
    fn recall(&mut self, objects: &Objects, run: usize, rows: Range<usize>) -> f64 {
        let places = Places { objects, rates: &self.rates, once: self.counts_once(run) };
        let Scratch { candidates, levels, .. } = &mut self.scratch;
        let (group, range) = (candidates.ends[run].group, candidates.run(run));
        let memory = self.groups.of(group);
        let dt_ms = memory.begin_frame(places, self.clock_ms);
        if self.selector.deferred().is_some() {
            memory.keep_accounts();
        }
        let recalled = Recalled {
            held: &mut candidates.held[range.clone()],
            place: &mut candidates.place[range.clone()],
            levels: &mut levels[range],
        };
        memory.recall(&mut candidates.rows[rows], places, recalled, self.options.threads, &mut self.changes);
        candidates.census.iter_mut().zip(memory.census()).for_each(|(sum, &count)| *sum += count);
        dt_ms
    }

    /// Whether everything that a group sees costs what its table says, once.
    fn counts_once(&self, run: usize) -> bool {
        self.scratch.candidates.ends[run].views == 1
            && self.options.benefit.enough_px == 0.0
            && self.feedback.model().stages == Stages::Sum
    }

    /// Advances the transitions of a group, notes who is not shown as wanted, and adds up what outgoing levels cost.
    fn advance(&mut self, objects: &Objects, group: GroupId, dt_ms: f32, fades_us: &mut FixedSum) {
        let Scratch { candidates, unsteady, .. } = &mut self.scratch;
        let frame = frame_of(objects, candidates, &self.rates, &self.feedback, &NoMemory, &self.report);
        let options = &self.options.transition;
        let memory = self.groups.of(group);
        let mut fades = 0;
        for (slot, shown) in memory.unsteady() {
            let Some(i) = candidates.find(group, slot) else { continue };
            unsteady.push(i);
            if shown.is_in_flight() {
                *shown = shown.advanced(dt_ms, options);
                fades_us.add(outgoing_us(options, *shown, |level| frame.cost_us(i, level)));
                fades += usize::from(shown.is_in_flight());
            }
        }
        self.report.fades += fades;
    }

    /// Lets the policy choose under this frame's budget.
    fn choose(&mut self, objects: &Objects, budget_us: f64, fades_us: f64) {
        let mut budget = self.feedback.budget(if budget_us > 0.0 { budget_us.min(f64::MAX) } else { 0.0 });
        let reserve_us = self.options.transition.reserve_us(budget.target_us);
        budget.select_us = (budget.select_us - fades_us.max(reserve_us)).max(0.0);
        self.report.budget = budget;
        self.report.fades_us = fades_us;
        let mut levels = std::mem::take(&mut self.scratch.levels);
        let Self { rates, feedback, groups, report, selector, scratch, options, .. } = self;
        let frame = frame_of(objects, &scratch.candidates, rates, feedback, groups, report);
        let frame = Frame { threads: options.threads, ..frame };
        report.select = selector.select(&frame, &mut levels);
        self.scratch.levels = levels;
    }

    /// Leads what is shown towards what is wanted, and lists what has changed.
    fn show(&mut self, objects: &Objects) {
        let reserve_us = self.options.transition.reserve_us(self.report.budget.target_us);
        let mut reserve_us = (reserve_us - self.report.fades_us).max(0.0);
        self.scratch.all_news.clear();
        for run in 0..self.scratch.candidates.ends.len() {
            let group = self.scratch.candidates.ends[run].group;
            self.find_news(run);
            self.note_wanted(objects, run);
            self.note_deferred(objects, run);
            self.grant_requests(objects, group, &mut reserve_us);
            self.groups.of(group).end_frame();
            self.scratch.all_news.extend_from_slice(&self.scratch.news);
        }
        self.changes.sort_unstable_by_key(|c| (c.group, c.object));
    }

    /// Lists the candidates of a group that are news: in view for the first time, no longer wanted as before, or not
    /// shown as they were wanted.
    fn find_news(&mut self, run: usize) {
        let Scratch { candidates, levels, news, unsteady, .. } = &mut self.scratch;
        let range = candidates.run(run);
        news.clear();
        news.extend(unsteady.iter().filter(|i| range.contains(i)));
        let changed = |i: &usize| candidates.held[*i] != levels[*i];
        for start in range.clone().step_by(BLOCK) {
            let chunk = start..(start + BLOCK).min(range.end);
            // Most chunks hold nothing new, and comparing all of one takes a few instructions.
            let pairs = candidates.held[chunk.clone()].iter().zip(&levels[chunk.clone()]);
            if pairs.fold(0, |differs, (held, level)| differs | (held.0 ^ level.0)) != 0 {
                news.extend(chunk.filter(changed));
            }
        }
        news.sort_unstable();
        news.dedup();
    }

    /// Remembers what is wanted of the news of a group; shows at once what has come into view and what is shown at a
    /// level that is gone, and notes the candidates that are to change.
    fn note_wanted(&mut self, objects: &Objects, run: usize) {
        let group = self.scratch.candidates.ends[run].group;
        let once = self.counts_once(run);
        let news = std::mem::take(&mut self.scratch.news);
        self.scratch.requests.clear();
        for &i in &news {
            let Scratch { candidates, levels, .. } = &self.scratch;
            let (slot, previous, wanted) = (candidates.slot_of(i), candidates.previous(i), levels[i]);
            let place = Places { objects, rates: &self.rates, once }.of(slot as usize, wanted);
            let memory = self.groups.of(group);
            match previous {
                Some(previous) => {
                    let shown = memory.shown_at(slot);
                    if previous != wanted {
                        memory.want(slot, wanted, place);
                        self.report.switches += 1;
                    }
                    self.ask(objects, group, i, shown);
                }
                None => {
                    memory.enter(slot, wanted, place);
                    if wanted.is_drawn() {
                        self.push_change(objects, i, Level::NOT_DRAWN, Shown::steady(wanted));
                    }
                }
            }
        }
        self.scratch.news = news;
    }

    /// Remembers what the policy has chosen for candidates of a group and put off, and what it owes to them; and who is
    /// deferred no longer.
    fn note_deferred(&mut self, objects: &Objects, run: usize) {
        let places = Places { objects, rates: &self.rates, once: self.counts_once(run) };
        let Scratch { candidates, levels, .. } = &self.scratch;
        let (group, range) = (candidates.ends[run].group, candidates.run(run));
        let memory = self.groups.of(group);
        let deferrals = self.selector.deferred().unwrap_or_default().iter();
        for deferral in deferrals.filter(|d| range.contains(&(d.candidate as usize))) {
            memory.defer(deferral.slot, places.of(deferral.slot as usize, deferral.chosen));
            if deferral.owed {
                memory.owe(deferral.slot);
            }
        }
        let before = candidates.deferred.iter().filter(|d| range.contains(&(d.candidate as usize)));
        for &Deferred { candidate, slot } in before {
            if !memory.is_deferred(slot) {
                memory.conclude(slot, places.of(slot as usize, levels[candidate as usize]));
            }
        }
    }

    /// Asks for a transition of candidate `i` to what is wanted. Where a level that is `shown` is no longer in its
    /// table or in memory there can be none: it switches hard.
    fn ask(&mut self, objects: &Objects, group: GroupId, i: usize, shown: Shown) {
        let (slot, wanted) = (self.scratch.candidates.slot_of(i), self.scratch.levels[i]);
        let table = objects.blocks()[slot as usize / BLOCK].table[slot as usize % BLOCK];
        let levels = self.rates.levels(table).len();
        let showable = objects.settings(slot as usize).showable(levels);
        let gone = |l: Level| l.is_drawn() && !showable.contains(l);
        let hard = gone(shown.level) || gone(shown.from);
        if !hard && shown.level != wanted {
            self.scratch.requests.push((i, shown));
            return;
        }
        let after = if hard { Shown::steady(wanted) } else { shown };
        self.groups.of(group).show(slot, after);
        if shown.level != wanted {
            self.push_change(objects, i, shown.level, after);
        }
    }

    /// Starts, aborts and retargets transitions, in the order of ids, while the fade reserve lasts, which is one for
    /// all groups.
    fn grant_requests(&mut self, objects: &Objects, group: GroupId, reserve_us: &mut f64) {
        let options = self.options.transition;
        let mut requests = std::mem::take(&mut self.scratch.requests);
        if options.kind != TransitionKind::Hard {
            let candidates = &self.scratch.candidates;
            requests.sort_unstable_by_key(|&(i, _)| objects.id_of(candidates.slot_of(i) as usize));
        }
        for &(i, before) in &requests {
            let Scratch { candidates, levels, .. } = &self.scratch;
            let frame =
                frame_of(objects, candidates, &self.rates, &self.feedback, &self.groups, &self.report);
            let after = follow(before, levels[i], &options, |level| frame.cost_us(i, level), reserve_us);
            self.groups.of(group).show(candidates.slot_of(i), after);
            if before.level != after.level {
                self.push_change(objects, i, before.level, after);
            }
        }
        self.scratch.requests = requests;
    }

    fn push_change(&mut self, objects: &Objects, i: usize, old: Level, shown: Shown) {
        let group = self.scratch.candidates.group_of(i);
        let object = objects.id_of(self.scratch.candidates.slot_of(i) as usize).unwrap_or_default();
        let cause = self.cause(objects, i, shown);
        self.changes.push(Change { group, object, old, new: shown.level, cause });
    }

    /// Ends the frame of every group, sums up what is shown and tells feedback what to expect of it.
    fn account(&mut self, objects: &Objects, activity: Activity) {
        let (drivers, model_us) = self.tally(objects);
        let came_or_went = |c: &&Change| c.old.is_drawn() != c.new.is_drawn();
        let moved = self.changes.iter().filter(came_or_went).count().min(self.report.candidates);
        self.feedback.expect(Prediction {
            frame: self.report.frame,
            drivers,
            model_us,
            churn: moved as f64 / self.report.candidates.max(1) as f64,
            usable: activity == Activity::Running && model_us > 0.0,
        });
        self.report.predicted_us = model_us * self.feedback.correction();
        self.report.filtered_us = self.feedback.timing().filtered_us;
    }

    /// Counts and model time of everything shown, outgoing levels of transitions included.
    ///
    /// Who has a place, is no news and not deferred is shown as was wanted, and has been counted.
    fn tally(&mut self, objects: &Objects) -> (Drivers, f64) {
        let Scratch { candidates, levels, tally, all_news, .. } = &mut self.scratch;
        let frame = frame_of(objects, candidates, &self.rates, &self.feedback, &self.groups, &self.report);
        tally.begin(&frame, self.options.transition.kind);
        let shown = |i: usize| {
            let memory = self.groups.get(candidates.group_of(i));
            memory.map_or(Shown::NOTHING, |memory| memory.shown_at(candidates.slot_of(i)))
        };
        candidates.unplaced().for_each(|i| tally.add(&frame, i, shown(i)));
        let placed = |i: &&usize| candidates.place[**i] != NO_PLACE;
        all_news.iter().filter(placed).for_each(|&i| tally.recount(&frame, i, shown(i)));
        tally.recount_deferred(&frame, all_news, levels);
        tally.sum(frame.model, objects.tables())
    }
}

/// The last frame as a selector sees it.
fn frame_of<'a>(
    objects: &'a Objects,
    candidates: &'a Candidates,
    rates: &'a TableRates,
    feedback: &'a Feedback,
    memory: &'a dyn Memory,
    report: &FrameReport,
) -> Frame<'a> {
    Frame {
        id: report.frame,
        objects,
        candidates,
        rates,
        model: feedback.model(),
        budget: report.budget,
        timing: feedback.timing(),
        floor: report.floor,
        memory,
        threads: 1,
    }
}

/// What the outgoing level of a transition costs; 0 when none is in flight.
fn outgoing_us(options: &TransitionOptions, shown: Shown, price: impl Fn(Level) -> f64) -> f64 {
    if shown.is_in_flight() { options.outgoing_us(price(shown.from), price(shown.level)) } else { 0.0 }
}

fn elapsed_ms(dt_s: f32) -> f64 {
    if dt_s > 0.0 { f64::from(dt_s.min(f32::MAX)) * 1e3 } else { 0.0 }
}

fn count_culled(report: &mut FrameReport, culled: &CullReport) {
    report.visited_nodes += culled.nodes_visited as usize;
    report.tested_objects += culled.objects_tested as usize;
    report.worth_too_little += culled.worth_too_little as usize;
}
