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

use crate::cull::{BlockTree, CullOptions, CullReport};
use crate::feedback::{Feedback, FeedbackOptions, Prediction};
use crate::frame::OptionsError;
use crate::frame::{Candidates, Change, FrameId, FrameReport, FrameTime, GroupId};
use crate::knapsack::FixedSum;
use crate::rate::{BenefitModel, CostModel, Drivers, Seen, TableRates, cost_us, rate};
use crate::scene::{ObjectId, Objects};
use crate::select::{Frame, Selector};
use crate::table::Level;
use crate::transition::{Shown, TransitionKind, TransitionOptions, follow};
use crate::view::View;
use memory::{GroupMemory, Layout};
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
    layout: Layout,
    groups: Vec<GroupMemory>,
    clock_ms: f64,
    report: FrameReport,
    changes: Vec<Change>,
    scratch: Scratch,
}

/// What the rates were made from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rated {
    tables: usize,
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
    /// Candidates that have come into view, or are not shown as they are wanted.
    news: Vec<usize>,
    /// Candidates whose shown level is not the one that is wanted.
    requests: Vec<usize>,
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
            layout: Layout::default(),
            groups: Vec::new(),
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
        let fades_us = self.remember();
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
        let found = objects.slot_of(id).zip(self.group(group));
        found.and_then(|(slot, memory)| memory.visible(slot)).unwrap_or(Shown::NOTHING)
    }

    /// Everything in view of a group: slots ascending, and what is shown of the objects in them.
    pub fn shown_slots(&self, group: GroupId) -> impl Iterator<Item = (usize, Shown)> + '_ {
        self.group(group).into_iter().flat_map(GroupMemory::shown)
    }

    /// The cost model in use, refitted by feedback.
    pub fn cost_model(&self) -> &CostModel {
        self.feedback.model()
    }

    /// The candidates of the last frame.
    pub fn candidates(&self) -> &Candidates {
        &self.scratch.candidates
    }

    /// The level that the policy wants for each candidate of the last frame.
    pub fn wanted(&self) -> &[Level] {
        &self.scratch.levels
    }

    /// The last frame as the selector saw it.
    pub fn last_frame<'a>(&'a self, objects: &'a Objects) -> Frame<'a> {
        Frame {
            id: self.report.frame,
            objects,
            candidates: &self.scratch.candidates,
            rates: &self.rates,
            model: self.feedback.model(),
            budget: self.report.budget,
            timing: self.feedback.timing(),
        }
    }

    /// Forgets everything learnt and shown, as if no frame had been run; the next changes start from nothing. The next
    /// frame may be of other objects.
    pub fn reset(&mut self) {
        self.selector.reset();
        self.feedback.reset(self.options.cost);
        self.tree = BlockTree::default();
        self.rated = None;
        self.layout = Layout::default();
        self.groups.clear();
        self.clock_ms = 0.0;
        self.report = FrameReport::default();
        self.changes.clear();
        self.scratch.candidates.clear();
        self.scratch.levels.clear();
    }

    fn group(&self, group: GroupId) -> Option<&GroupMemory> {
        self.groups.binary_search_by_key(&group, |g| g.id).ok().map(|at| &self.groups[at])
    }

    /// Advances the clock, learns from measurements, and brings up to date what is kept per slot and per table.
    fn begin(&mut self, objects: &mut Objects, input: &FrameInput<'_>) {
        let frame = FrameId(self.report.frame.0 + 1);
        let broken_bounds = objects.broken_bounds();
        self.report = FrameReport { frame, broken_bounds, ..FrameReport::default() };
        self.changes.clear();
        self.clock_ms += elapsed_ms(input.dt_s);
        self.feedback.measure(input.measured);
        self.tree.update(objects);
        self.layout.follow(objects, &mut self.groups, &mut self.changes);
        let rated = Rated { tables: objects.tables().len(), model_revision: self.feedback.model_revision() };
        if self.rated != Some(rated) {
            self.rates.renew(objects.tables(), self.feedback.model());
            self.rated = Some(rated);
        }
    }

    /// Culls every view and rates what each group sees.
    fn find_candidates(&mut self, objects: &Objects, input: &FrameInput<'_>) {
        let views = input.views;
        let Scratch { order, candidates, .. } = &mut self.scratch;
        candidates.clear();
        order.clear();
        order.extend((0..views.len()).filter(|&i| views[i].view.check().is_ok()));
        order.sort_unstable_by_key(|&i| (views[i].group, i));
        self.report.broken_views = views.len() - order.len();
        let mut first = 0;
        while let Some(&view) = self.scratch.order.get(first) {
            let group = views[view].group;
            let rest = &self.scratch.order[first..];
            let count = rest.iter().take_while(|&&i| views[i].group == group).count();
            self.cull_group(objects, views, first..first + count);
            let Scratch { seen, cursors, candidates, .. } = &mut self.scratch;
            rate(objects, &self.rates, &seen[..count], &self.options.benefit, cursors, candidates);
            candidates.end_group(group, views[view].view.viewport_px.y);
            first += count;
        }
        self.report.candidates = self.scratch.candidates.len();
    }

    /// Culls the views of one group, given by their places in [`Scratch::order`].
    fn cull_group(&mut self, objects: &Objects, views: &[ViewInput<'_>], members: Range<usize>) {
        for (at, member) in members.enumerate() {
            let input = &views[self.scratch.order[member]];
            let lens = input.view.lens(objects.origin());
            match self.scratch.seen.get_mut(at) {
                Some(seen) => seen.lens = lens,
                None => self.scratch.seen.push(Seen { lens, visible: Vec::new() }),
            }
            let seen = &mut self.scratch.seen[at];
            let culled = visibility::find(&self.tree, objects, &self.options.cull, input.visibility, seen);
            count_culled(&mut self.report, &culled);
        }
    }

    /// Fills in what was wanted of each candidate before, and advances its transition. Returns what the outgoing levels
    /// of transitions in flight cost, by the model.
    fn remember(&mut self) -> f64 {
        let Scratch { candidates, unsteady, .. } = &mut self.scratch;
        unsteady.clear();
        let mut fades_us = FixedSum::default();
        for run in 0..candidates.ends.len() {
            let group = candidates.ends[run].group;
            let memory = memory::of_group(&mut self.groups, group);
            let dt_ms = memory.begin_frame(self.layout.slots(), self.clock_ms);
            for i in candidates.range(group) {
                let Some(state) = memory.recall(candidates.slot[i]) else { continue };
                let coarsest = self.rates.coarsest(candidates.table[i]);
                let wanted = if state.wanted.is_drawn() { state.wanted.min(coarsest) } else { state.wanted };
                candidates.previous[i] = Some(wanted);
                candidates.age_ms[i] = GroupMemory::age_ms(self.clock_ms, state);
                if state.shown != Shown::steady(wanted) {
                    unsteady.push(i);
                }
                if state.shown.is_in_flight() {
                    state.shown = state.shown.advanced(dt_ms as f32, &self.options.transition);
                    let price = |level| cost_us(self.feedback.model(), &self.rates, candidates, i, level);
                    fades_us.add(outgoing_us(&self.options.transition, state.shown, price));
                    self.report.fades += usize::from(state.shown.is_in_flight());
                }
            }
        }
        fades_us.value()
    }

    /// Lets the policy choose under this frame's budget.
    fn choose(&mut self, objects: &Objects, budget_us: f64, fades_us: f64) {
        let mut budget = self.feedback.budget(if budget_us > 0.0 { budget_us.min(f64::MAX) } else { 0.0 });
        let reserve_us = self.options.transition.reserve_us(budget.target_us);
        budget.select_us = (budget.select_us - fades_us.max(reserve_us)).max(0.0);
        self.report.budget = budget;
        self.report.fades_us = fades_us;
        let mut levels = std::mem::take(&mut self.scratch.levels);
        levels.clear();
        levels.resize(self.scratch.candidates.len(), Level::NOT_DRAWN);
        let frame = Frame {
            id: self.report.frame,
            objects,
            candidates: &self.scratch.candidates,
            rates: &self.rates,
            model: self.feedback.model(),
            budget,
            timing: self.feedback.timing(),
        };
        self.report.select = self.selector.select(&frame, &mut levels);
        self.scratch.levels = levels;
    }

    /// Leads what is shown towards what is wanted, and lists what has changed.
    fn show(&mut self, objects: &Objects) {
        let reserve_us = self.options.transition.reserve_us(self.report.budget.target_us);
        let mut reserve_us = (reserve_us - self.report.fades_us).max(0.0);
        for run in 0..self.scratch.candidates.ends.len() {
            let group = self.scratch.candidates.ends[run].group;
            self.note_wanted(objects, group);
            self.grant_requests(objects, group, &mut reserve_us);
            let memory = memory::of_group(&mut self.groups, group);
            memory.end_frame(objects, &mut self.changes);
        }
        self.changes.sort_unstable_by_key(|c| (c.group, c.object));
    }

    /// Remembers what is wanted of every candidate of a group; shows at once what has come into view and what is shown
    /// at a level that is gone, and notes the candidates that are to change.
    fn note_wanted(&mut self, objects: &Objects, group: GroupId) {
        self.news(group);
        let news = std::mem::take(&mut self.scratch.news);
        self.scratch.requests.clear();
        for &i in &news {
            let (slot, wanted) = (self.scratch.candidates.slot[i], self.scratch.levels[i]);
            match self.scratch.candidates.previous[i] {
                Some(_) => {
                    let shown = memory::of_group(&mut self.groups, group).state(slot).shown;
                    self.ask(objects, i, shown);
                }
                None if wanted.is_drawn() => {
                    self.push_change(objects, i, Level::NOT_DRAWN, Shown::steady(wanted));
                }
                None => {}
            }
        }
        self.scratch.news = news;
    }

    /// Notes what is wanted of every candidate of a group, and which of them are news: in view for the first time, or
    /// not shown as they are wanted.
    fn news(&mut self, group: GroupId) {
        let Scratch { candidates, levels, news, unsteady, .. } = &mut self.scratch;
        let memory = memory::of_group(&mut self.groups, group);
        news.clear();
        let range = candidates.range(group);
        news.extend(unsteady.iter().filter(|i| range.contains(i)));
        for i in range {
            let (previous, wanted) = (candidates.previous[i], levels[i]);
            if previous == Some(wanted) {
                continue;
            }
            match previous {
                Some(_) => {
                    memory.want(candidates.slot[i], wanted);
                    self.report.switches += 1;
                }
                None => memory.enter(candidates.slot[i], wanted),
            }
            news.push(i);
        }
        news.sort_unstable();
        news.dedup();
    }

    /// Asks for a transition of candidate `i` to what is wanted. Where a level that is `shown` is no longer in its table
    /// or in memory there can be none: it switches hard.
    fn ask(&mut self, objects: &Objects, i: usize, shown: Shown) {
        let Candidates { slot, table, .. } = &self.scratch.candidates;
        let levels = self.rates.levels(table[i]).len();
        let showable = objects.settings(slot[i] as usize).showable(levels);
        let gone = |l: Level| l.is_drawn() && !showable.contains(l);
        let (slot, wanted) = (slot[i], self.scratch.levels[i]);
        if !gone(shown.level) && !gone(shown.from) {
            self.scratch.requests.extend((shown.level != wanted).then_some(i));
            return;
        }
        let group = self.scratch.candidates.group_of(i);
        memory::of_group(&mut self.groups, group).state(slot).shown = Shown::steady(wanted);
        if shown.level != wanted {
            self.push_change(objects, i, shown.level, Shown::steady(wanted));
        }
    }

    /// Starts, aborts and retargets transitions, in the order of ids, while the fade reserve lasts, which is one for all
    /// groups.
    fn grant_requests(&mut self, objects: &Objects, group: GroupId, reserve_us: &mut f64) {
        let options = self.options.transition;
        let mut requests = std::mem::take(&mut self.scratch.requests);
        if options.kind != TransitionKind::Hard {
            requests.sort_unstable_by_key(|&i| objects.id_of(self.scratch.candidates.slot[i] as usize));
        }
        for &i in &requests {
            let slot = self.scratch.candidates.slot[i];
            let to = self.scratch.levels[i];
            let candidates = &self.scratch.candidates;
            let price = |level| cost_us(self.feedback.model(), &self.rates, candidates, i, level);
            let memory = memory::of_group(&mut self.groups, group);
            let before = memory.state(slot).shown;
            let after = follow(before, to, &options, price, reserve_us);
            memory.state(slot).shown = after;
            if before.level != after.level {
                self.push_change(objects, i, before.level, after);
            }
        }
        self.scratch.requests = requests;
    }

    fn push_change(&mut self, objects: &Objects, i: usize, old: Level, shown: Shown) {
        let group = self.scratch.candidates.group_of(i);
        let object = objects.id_of(self.scratch.candidates.slot[i] as usize).unwrap_or_default();
        let cause = self.cause(objects, i, shown);
        self.changes.push(Change { group, object, old, new: shown.level, cause });
    }

    /// Sums up what is shown and tells feedback what to expect of it.
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
    fn tally(&mut self, objects: &Objects) -> (Drivers, f64) {
        let Scratch { candidates, tally, levels, .. } = &mut self.scratch;
        let (model, kind) = (self.feedback.model(), self.options.transition.kind);
        tally.clear(self.rates.len());
        if kind == TransitionKind::Hard {
            // What is wanted is shown.
            for (i, &level) in levels.iter().enumerate() {
                tally.add_level(model, &self.rates, candidates, i, level);
            }
            return tally.sum(model, objects.tables());
        }
        for (group, range) in candidates.groups() {
            let memory = memory::of_group(&mut self.groups, group.group);
            for i in range {
                let shown = memory.shown_at(candidates.slot[i]);
                tally.add(model, &self.rates, candidates, i, shown, kind);
            }
        }
        tally.sum(model, objects.tables())
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
}
