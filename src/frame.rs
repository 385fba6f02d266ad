//! What passes between the stages of a frame. Sizes are in pixels (`_px`, `_px2`), times in microseconds (`_us`).

use std::fmt;

use crate::scene::{LevelRange, ObjectId};
use crate::table::Level;

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
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// See [`Candidate::slot`].
    pub slot: Vec<u32>,
    /// See [`Candidate::table`].
    pub table: Vec<u16>,
    /// See [`Candidate::allowed`].
    pub allowed: Vec<LevelRange>,
    /// See [`Candidate::weight`].
    pub weight: Vec<f32>,
    /// See [`Candidate::cost_scale`].
    pub cost_scale: Vec<f32>,
    /// See [`Candidate::size_px`].
    pub size_px: Vec<f32>,
    /// See [`Candidate::near_px`].
    pub near_px: Vec<f32>,
    /// See [`Candidate::area_px2`].
    pub area_px2: Vec<f32>,
    /// What was wanted in the last frame; `None` for an object that has just come into view.
    pub previous: Vec<Option<Level>>,
    /// How long that has been wanted.
    pub age_ms: Vec<u32>,
    /// Where each group's candidates end, in the order of groups.
    pub ends: Vec<GroupEnd>,
}

/// The end of a group's run in [`Candidates`]; it starts where the run before it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupEnd {
    /// The group.
    pub group: GroupId,
    /// One past its last candidate.
    pub end: usize,
    /// Height of the viewport of the group's first view.
    pub height_px: f32,
}

impl Candidates {
    /// How many candidates there are.
    pub fn len(&self) -> usize {
        self.slot.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.slot.is_empty()
    }

    /// Forgets all candidates and keeps the memory.
    pub fn clear(&mut self) {
        self.slot.clear();
        self.table.clear();
        self.allowed.clear();
        self.weight.clear();
        self.cost_scale.clear();
        self.size_px.clear();
        self.near_px.clear();
        self.area_px2.clear();
        self.previous.clear();
        self.age_ms.clear();
        self.ends.clear();
    }

    /// Adds a candidate without memory of earlier frames.
    pub fn push(&mut self, c: Candidate) {
        self.slot.push(c.slot);
        self.table.push(c.table);
        self.allowed.push(c.allowed);
        self.weight.push(c.weight);
        self.cost_scale.push(c.cost_scale);
        self.size_px.push(c.size_px);
        self.near_px.push(c.near_px);
        self.area_px2.push(c.area_px2);
        self.forget_memory();
    }

    /// Gives the candidates that were appended to the other columns no memory of earlier frames.
    pub(crate) fn forget_memory(&mut self) {
        self.previous.resize(self.slot.len(), None);
        self.age_ms.resize(self.slot.len(), 0);
    }

    /// Overwrites candidate `i`, but for its memory of earlier frames.
    pub fn set(&mut self, i: usize, c: Candidate) {
        self.slot[i] = c.slot;
        self.table[i] = c.table;
        self.allowed[i] = c.allowed;
        self.weight[i] = c.weight;
        self.cost_scale[i] = c.cost_scale;
        self.size_px[i] = c.size_px;
        self.near_px[i] = c.near_px;
        self.area_px2[i] = c.area_px2;
    }

    /// One candidate, across the columns.
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

    /// Closes the run of `group`, whose first view is `height_px` high.
    pub fn end_group(&mut self, group: GroupId, height_px: f32) {
        self.ends.push(GroupEnd { group, end: self.len(), height_px });
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
    /// The same of the objective with switching prices folded in.
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
