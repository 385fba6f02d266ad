//! What must hold of any selection: written from the contract, knowing no policy.
//!
//! Tests, fuzzers and tools hold the answers of selectors ([`selection`], [`bound`]) and of the runtime ([`Replay`])
//! against it. Nothing here is fast, allocates little or shares code with what it checks beyond the vocabulary and
//! the price of one level; do not call it in a frame loop.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use crate::frame::{Change, GroupId, SelectReport};
use crate::knapsack::{Instance, Item, exact};
use crate::rate::LevelRate;
use crate::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput, Visibility};
use crate::scene::{LevelRange, Object, ObjectId, Objects};
use crate::select::Frame;
use crate::table::Level;
use crate::transition::{Shown, TransitionKind};

/// A rule that does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Where: the group and the object, if it is one object's fault.
    pub object: Option<(GroupId, ObjectId)>,
    /// What should hold.
    pub rule: &'static str,
    /// What was found instead.
    pub found: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.object {
            Some((group, object)) => write!(f, "object {} in group {}: ", object.0, group.0)?,
            None => f.write_str("selection: ")?,
        }
        write!(f, "{} (found {})", self.rule, self.found)
    }
}

impl std::error::Error for Violation {}

/// `Ok` when `holds`, else the rule and what was found.
fn hold(holds: bool, rule: &'static str, found: impl FnOnce() -> String) -> Result<(), Violation> {
    if holds { Ok(()) } else { Err(Violation { object: None, rule, found: found() }) }
}

/// [`hold`], of one object.
fn hold_of(
    object: (GroupId, ObjectId),
    holds: bool,
    rule: &'static str,
    found: impl FnOnce() -> String,
) -> Result<(), Violation> {
    hold(holds, rule, found).map_err(|v| Violation { object: Some(object), ..v })
}

/// What a policy undertakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Promise {
    /// Levels in range and an honest report.
    Levels,
    /// Also: within the budget wherever the minimum choice is, the minimum choice elsewhere, and a certificate.
    Budget,
}

/// Checks a selection: one level per candidate, each of them allowed; cost, benefit and shortfall as reported; and
/// the promise.
///
/// Costs may be reported a little too high, as solvers count them in ticks and round up: see [`rounding_us`].
///
/// # Errors
/// The first rule that does not hold.
pub fn selection(
    frame: &Frame<'_>,
    levels: &[Level],
    report: &SelectReport,
    promise: Promise,
) -> Result<(), Violation> {
    let detailed = frame.detailed();
    let frame = &Frame { candidates: &detailed, ..*frame };
    each_level(frame, levels)?;
    let sums = Sums::of(frame, levels);
    reported_sums(&sums, report)?;
    shortfall(&sums, budget_us(frame), report)?;
    match promise {
        Promise::Levels => Ok(()),
        Promise::Budget => kept_budget(frame, levels, &sums, report),
    }
}

/// Checks that the certified bound is no less than the true optimum, by exact search: for small frames only. What
/// rounding hides is taken off the budget first.
///
/// # Errors
/// A bound that is too low.
pub fn bound(frame: &Frame<'_>, report: &SelectReport) -> Result<(), Violation> {
    let Some(certificate) = report.certificate else { return Ok(()) };
    let detailed = frame.detailed();
    let frame = &Frame { candidates: &detailed, ..*frame };
    let hidden: f64 = (0..frame.candidates.len()).map(|i| rounding_us(frame, i)).sum();
    let budget = (budget_us(frame) - hidden).min(f64::MAX);
    let classes = (0..frame.candidates.len()).map(|i| choices(frame, i).map(|l| item(frame, i, l)).collect());
    let Ok(instance) = Instance::new(budget.max(0.0), classes.collect::<Vec<Vec<Item>>>()) else {
        return Ok(());
    };
    let best = exact(&instance, &mut || false);
    let slack = 1e-12 * best.benefit + frame.candidates.len() as f64 * SUM_UNIT;
    hold(
        !best.feasible || budget < 0.0 || certificate.upper_bound >= best.benefit - slack,
        "the upper bound is no less than the optimum",
        || format!("{} below {}", certificate.upper_bound, best.benefit),
    )
}

fn item(frame: &Frame<'_>, i: usize, level: Level) -> Item {
    Item { cost: frame.cost_us(i, level), benefit: frame.benefit(i, level) }
}

/// Every level that candidate `i` may be shown at.
fn choices(frame: &Frame<'_>, i: usize) -> impl Iterator<Item = Level> + use<> {
    let allowed = frame.candidates.allowed[i];
    let levels = frame.rates.levels(frame.candidates.table[i]).len() as u8;
    (0..levels).map(Level).chain([Level::NOT_DRAWN]).filter(move |&l| allowed.contains(l))
}

/// How much the cost of candidate `i` may be off: costs are counted in ticks of 2⁻²⁴ µs, or coarser ones of which the
/// dearest level of any table takes 2³⁵, and are rounded up per draw and per object; areas are rounded to 2⁻⁶ px².
pub fn rounding_us(frame: &Frame<'_>, i: usize) -> f64 {
    let tables = (0..frame.rates.tables()).flat_map(|t| frame.rates.levels(t as u16));
    let dearest_us = tables.fold(0.0, |most: f64, level| most.max(level.geometry_us));
    let tick_us = (dearest_us / (1u64 << 35) as f64).max(1.0 / (1u64 << 24) as f64);
    tick_us * (f64::from(frame.candidates.cost_scale[i]) + 2.0) + frame.model.pixel_us / 64.0
}

/// Terms of sums, and accuracies in them, are rounded to this.
const SUM_UNIT: f64 = 1.0 / (1u64 << 32) as f64;

/// Benefits may be counted in units of which the heaviest candidate has 2³⁹ or more.
const BENEFIT_UNIT: f64 = 1.0 / (1u64 << 39) as f64;

/// The budget of the selection; nothing where it is no amount.
fn budget_us(frame: &Frame<'_>) -> f64 {
    if frame.budget.select_us > 0.0 { frame.budget.select_us } else { 0.0 }
}

fn who(frame: &Frame<'_>, i: usize) -> (GroupId, ObjectId) {
    let id = frame.objects.id_of(frame.candidates.slot_of(i) as usize).unwrap_or_default();
    (frame.candidates.group_of(i), id)
}

fn each_level(frame: &Frame<'_>, levels: &[Level]) -> Result<(), Violation> {
    let (given, candidates) = (levels.len(), frame.candidates.len());
    hold(given == candidates, "there is one level per candidate", || format!("{given} of {candidates}"))?;
    for (i, &level) in levels.iter().enumerate() {
        let may = choices(frame, i).any(|l| l == level);
        hold_of(who(frame, i), may, "the level is an allowed one", || {
            let LevelRange { finest, coarsest } = frame.candidates.allowed[i];
            format!("{level} where {finest} to {coarsest} are allowed")
        })?;
    }
    Ok(())
}

/// Plain double-precision sums over the candidates, and how much rounding may hide in them.
struct Sums {
    cost_us: f64,
    least_us: f64,
    benefit: f64,
    rounding_us: f64,
    rounding: f64,
}

impl Sums {
    fn of(frame: &Frame<'_>, levels: &[Level]) -> Self {
        let all = 0..frame.candidates.len();
        let cost_us: f64 = all.clone().map(|i| frame.cost_us(i, levels[i])).sum();
        let least_us: f64 = all.clone().map(|i| least_us(frame, i)).sum();
        let benefit: f64 = all.clone().map(|i| frame.benefit(i, levels[i])).sum();
        let ticks_us: f64 = all.clone().map(|i| rounding_us(frame, i)).sum();
        let heaviest = frame.candidates.weight.iter().fold(0.0, |most: f64, &w| most.max(f64::from(w)));
        let weight: f64 = frame.candidates.weight.iter().map(|&w| f64::from(w)).sum();
        let units = all.len() as f64 * SUM_UNIT;
        Self {
            cost_us,
            least_us,
            benefit,
            rounding_us: ticks_us + units + 1e-9 * cost_us,
            rounding: units + all.len() as f64 * heaviest * BENEFIT_UNIT + weight * SUM_UNIT + 1e-9 * benefit,
        }
    }
}

/// The least that candidate `i` can cost.
fn least_us(frame: &Frame<'_>, i: usize) -> f64 {
    choices(frame, i).map(|l| frame.cost_us(i, l)).fold(f64::INFINITY, f64::min)
}

fn reported_sums(sums: &Sums, report: &SelectReport) -> Result<(), Violation> {
    let off_us = (report.cost_us - sums.cost_us).abs();
    hold(off_us <= sums.rounding_us, "the reported cost is that of the levels", || {
        format!("{} µs for {} µs", report.cost_us, sums.cost_us)
    })?;
    let off = (report.benefit - sums.benefit).abs();
    hold(off <= sums.rounding, "the reported benefit is that of the levels", || {
        format!("{} px² for {} px²", report.benefit, sums.benefit)
    })
}

fn shortfall(sums: &Sums, budget_us: f64, report: &SelectReport) -> Result<(), Violation> {
    let truth_us = (sums.least_us - budget_us).max(0.0);
    let off_us = (report.infeasible_us - truth_us).abs();
    let rounding_us = sums.rounding_us + 1e-9 * sums.least_us;
    hold(off_us <= rounding_us, "the shortfall is what the minimum choice lacks", || {
        format!("{} µs for {truth_us} µs", report.infeasible_us)
    })
}

fn kept_budget(
    frame: &Frame<'_>,
    levels: &[Level],
    sums: &Sums,
    report: &SelectReport,
) -> Result<(), Violation> {
    if report.infeasible_us > 0.0 {
        hold(report.certificate.is_none(), "no certificate where the budget cannot be met", || "one".into())?;
        return cheapest_choice(frame, levels);
    }
    let budget_us = budget_us(frame);
    hold(sums.cost_us <= budget_us * (1.0 + 1e-12), "the cost is within the budget", || {
        format!("{} µs of {budget_us} µs", sums.cost_us)
    })?;
    let is_certified = report.certificate.is_some() || frame.floor > 0.0;
    hold(is_certified, "there is a certificate where the budget can be met", || "none".into())?;
    honest_certificate(sums, report)
}

fn cheapest_choice(frame: &Frame<'_>, levels: &[Level]) -> Result<(), Violation> {
    for (i, &level) in levels.iter().enumerate() {
        let (cost_us, least_us) = (frame.cost_us(i, level), least_us(frame, i));
        let cheapest = cost_us <= least_us * (1.0 + 1e-9) + rounding_us(frame, i);
        hold_of(who(frame, i), cheapest, "beyond the budget everything is at its cheapest", || {
            format!("{cost_us} µs where {least_us} µs is possible")
        })?;
    }
    Ok(())
}

fn honest_certificate(sums: &Sums, report: &SelectReport) -> Result<(), Violation> {
    let Some(certificate) = report.certificate else { return Ok(()) };
    let (bound, gap) = (certificate.upper_bound, certificate.gap);
    hold(bound >= report.benefit && bound.is_finite(), "the upper bound is above the benefit", || {
        format!("{bound} for {}", report.benefit)
    })?;
    for share in [gap, certificate.penalised_gap] {
        hold((0.0..=1.0).contains(&share), "a gap is from 0 to 1", || format!("{share}"))?;
    }
    // The gap is relative to what can be gained beyond the minimum choice, so it is no less than relative to the bound.
    hold(gap * bound >= bound - report.benefit - sums.rounding, "the gap is honest", || {
        format!("{gap} for {} of {bound}", report.benefit)
    })?;
    let lambda = certificate.lambda;
    hold(lambda >= 0.0 && lambda.is_finite(), "λ is an amount", || format!("{lambda}"))
}

/// Checks a runtime frame by frame: plays its lists of changes from nothing and holds them against what it says is
/// shown, and holds what it finds in view against every object.
#[derive(Clone, Debug)]
pub struct Replay {
    options: RuntimeOptions,
    /// The level shown of everything that is drawn.
    shown: BTreeMap<(GroupId, ObjectId), Level>,
    /// What was in view of each group that there has been, in the last frame with a view of it.
    seen: BTreeMap<GroupId, BTreeSet<ObjectId>>,
}

impl Replay {
    /// A replay of a runtime that was made with `options` and has run no frame.
    pub fn new(options: RuntimeOptions) -> Self {
        Self { options, shown: BTreeMap::new(), seen: BTreeMap::new() }
    }

    /// Checks the frame that `runtime` has just run with `input`.
    ///
    /// # Errors
    /// The first rule that does not hold.
    pub fn frame(
        &mut self,
        runtime: &Runtime,
        objects: &Objects,
        input: &FrameInput<'_>,
        promise: Promise,
    ) -> Result<(), Violation> {
        let detailed = runtime.last_frame(objects).detailed();
        let frame = Frame { candidates: &detailed, ..runtime.last_frame(objects) };
        self.apply(runtime.changes())?;
        self.dense_levels(runtime, objects, frame.candidates.groups().map(|(g, _)| g.group))?;
        self.memory(&frame)?;
        self.in_view(&frame, input.views)?;
        self.allowed_levels(&frame)?;
        in_memory(runtime, &frame)?;
        self.fade_reserve(runtime, &frame)?;
        counts(runtime, objects, input)?;
        selection(&frame, runtime.wanted(), &runtime.report().select, promise)
    }

    /// Plays a list of changes.
    fn apply(&mut self, changes: &[Change]) -> Result<(), Violation> {
        let mut last = None;
        for change in changes {
            let at = (change.group, change.object);
            hold_of(at, last < Some(at), "changes are by group and object, each once", || "another".into())?;
            last = Some(at);
            hold_of(at, change.old != change.new, "a change changes something", || change.new.to_string())?;
            let before = match change.new {
                Level::NOT_DRAWN => self.shown.remove(&at),
                level => self.shown.insert(at, level),
            };
            let before = before.unwrap_or(Level::NOT_DRAWN);
            hold_of(at, before == change.old, "a change starts from what was shown", || {
                format!("{} where {before} was shown", change.old)
            })?;
        }
        Ok(())
    }

    /// What was wanted before is remembered of exactly what was in view before.
    fn memory(&mut self, frame: &Frame<'_>) -> Result<(), Violation> {
        // What has been removed is forgotten, though its id may come back.
        self.seen.values_mut().for_each(|seen| seen.retain(|&id| frame.objects.slot_of(id).is_some()));
        for (group, range) in frame.candidates.groups() {
            let now: BTreeSet<ObjectId> = range.clone().map(|i| who(frame, i).1).collect();
            let before = self.seen.insert(group.group, now).unwrap_or_default();
            for i in range {
                let (remembered, at) = (frame.candidates.previous(i), who(frame, i));
                let rule = "what was in view, and nothing else, is remembered";
                hold_of(at, remembered.is_some() == before.contains(&at.1), rule, || {
                    format!("{remembered:?}")
                })?;
            }
        }
        Ok(())
    }

    /// What the lists of changes add up to is what is shown, one transition at a time.
    fn dense_levels(
        &self,
        runtime: &Runtime,
        objects: &Objects,
        groups: impl Iterator<Item = GroupId>,
    ) -> Result<(), Violation> {
        let mut dense = BTreeMap::new();
        let groups: BTreeSet<GroupId> = self.seen.keys().copied().chain(groups).collect();
        for group in groups {
            for (slot, shown) in runtime.shown_slots(group) {
                let at = (group, objects.id_of(slot).unwrap_or_default());
                self.one_transition(at, shown)?;
                if shown.level.is_drawn() {
                    let twice = dense.insert(at, shown.level);
                    hold_of(at, twice.is_none(), "each object is shown once per group", || "twice".into())?;
                }
            }
        }
        let lists = self.shown.iter().find(|&(at, level)| dense.get(at) != Some(level));
        let denses = dense.iter().find(|&(at, level)| self.shown.get(at) != Some(level));
        match lists.or(denses) {
            None => Ok(()),
            Some((&at, _)) => hold_of(at, false, "the changes add up to what is shown", || {
                format!("{:?} where {:?} is shown", self.shown.get(&at), dense.get(&at))
            }),
        }
    }

    fn one_transition(&self, at: (GroupId, ObjectId), shown: Shown) -> Result<(), Violation> {
        let found = || format!("{shown:?}");
        hold_of(at, (0.0..=1.0).contains(&shown.weight), "a weight is from 0 to 1", found)?;
        let leads = (shown.weight < 1.0) == (shown.level != shown.from);
        hold_of(at, leads, "a transition is between two levels and ends", found)?;
        let hard = self.options.transition.kind == TransitionKind::Hard;
        hold_of(at, !hard || !shown.is_in_flight(), "a hard switch takes no time", found)
    }

    /// The candidates are exactly what some view of their group sees, each once.
    fn in_view(&self, frame: &Frame<'_>, views: &[ViewInput<'_>]) -> Result<(), Violation> {
        let found: Vec<_> = (0..frame.candidates.len()).map(|i| who(frame, i)).collect();
        let mut expected = BTreeSet::new();
        for view in usable(views) {
            let seen = ids(frame.objects).filter(|&id| self.sees(frame.objects, view, id));
            expected.extend(seen.map(|id| (view.group, id)));
        }
        let once: BTreeSet<_> = found.iter().copied().collect();
        hold(once.len() == found.len(), "each object is a candidate once per group", || {
            format!("{} of {}", once.len(), found.len())
        })?;
        let passed_over = |at: &&(GroupId, ObjectId)| {
            frame.floor > 0.0
                && usable(views).any(|view| view.group == at.0 && is_passed_over(frame, view, at.1))
        };
        let once: BTreeSet<_> = once.iter().chain(expected.iter().filter(passed_over)).copied().collect();
        match once.symmetric_difference(&expected).next() {
            None => Ok(()),
            Some(&at) => hold_of(at, false, "candidates are what is in view", || {
                format!("candidate: {}, in view: {}", once.contains(&at), expected.contains(&at))
            }),
        }
    }

    fn sees(&self, objects: &Objects, input: &ViewInput<'_>, id: ObjectId) -> bool {
        let Some(object) = objects.get(id) else { return false };
        let (settings, bounds) = (&object.settings, &object.bounds);
        let lens = input.view.lens(objects.origin());
        let live = !settings.hidden && bounds.is_valid();
        let distance = (bounds.center - lens.eye).length();
        let large = lens.size_px(bounds) * settings.bias >= self.options.cull.min_size_px;
        let computed = lens.frustum.sees(bounds) && large && distance <= settings.draw_distance;
        live && match input.visibility {
            Visibility::Computed => computed,
            Visibility::Without(hidden) => computed && !hidden.contains(&id),
            Visibility::Given(given) => given.contains(&id),
        }
    }

    /// Candidates may choose among what their settings allow; only where detail is enough at some error may the finer
    /// end be missing.
    fn allowed_levels(&self, frame: &Frame<'_>) -> Result<(), Violation> {
        for i in 0..frame.candidates.len() {
            let settings = frame.objects.settings(frame.candidates.slot_of(i) as usize);
            let levels = frame.rates.levels(frame.candidates.table[i]).len();
            let mut allowed = settings.allowed(levels);
            if settings.may_skip && settings.forced.is_none() && allowed.coarsest.index() + 1 == levels {
                allowed.coarsest = Level::NOT_DRAWN;
            }
            let given = frame.candidates.allowed[i];
            let spared = self.options.benefit.enough_px > 0.0 && given.finest >= allowed.finest;
            let holds = given.coarsest == allowed.coarsest && (spared || given.finest == allowed.finest);
            hold_of(who(frame, i), holds, "the settings say what is allowed", || {
                format!("{given:?} for {allowed:?}")
            })?;
        }
        Ok(())
    }

    /// Fades in flight cost no more than the reserve, or than they did before new ones were started.
    fn fade_reserve(&self, runtime: &Runtime, frame: &Frame<'_>) -> Result<(), Violation> {
        let report = runtime.report();
        let outgoing_us = |i: usize| {
            let (group, id) = who(frame, i);
            let shown = runtime.shown(frame.objects, group, id);
            let price = |level| frame.cost_us(i, level);
            let cost_us = self.options.transition.outgoing_us(price(shown.from), price(shown.level));
            if shown.is_in_flight() { cost_us } else { 0.0 }
        };
        let fades_us: f64 = (0..frame.candidates.len()).map(outgoing_us).sum();
        let reserve_us = f64::from(self.options.transition.reserve) * report.budget.target_us;
        let limit_us = reserve_us.max(report.fades_us);
        let slack_us = 1e-9 * fades_us + frame.candidates.len() as f64 * SUM_UNIT;
        hold(fades_us <= limit_us + slack_us, "new fades fit the fade reserve", || {
            format!("{fades_us} µs of {limit_us} µs")
        })
    }
}

/// Whether an object may be left out and is worth less than the floor through a view.
fn is_passed_over(frame: &Frame<'_>, input: &ViewInput<'_>, id: ObjectId) -> bool {
    let Some(Object { bounds, table, settings, .. }) = frame.objects.get(id) else { return false };
    let levels = frame.rates.levels(table.0);
    let slope = |l: &LevelRate| f64::from(l.accuracy) / (l.geometry_us * f64::from(settings.cost_multiplier));
    let best = levels.iter().map(slope).fold(0.0, f64::max);
    let gain = f64::from(settings.importance * (settings.bias * settings.bias));
    let area_px2 = f64::from(input.view.lens(frame.objects.origin()).area_px2(&bounds));
    settings.may_be_left_out(levels.len()) && area_px2 * gain * best < frame.floor * (1.0 + 1e-5)
}

/// Nothing is shown that is not in memory, not even on its way out.
fn in_memory(runtime: &Runtime, frame: &Frame<'_>) -> Result<(), Violation> {
    for i in 0..frame.candidates.len() {
        let (group, id) = who(frame, i);
        let levels = frame.rates.levels(frame.candidates.table[i]).len();
        let resident = frame.objects.settings(frame.candidates.slot_of(i) as usize).showable(levels);
        let shown = runtime.shown(frame.objects, group, id);
        let may = |l: Level| !l.is_drawn() || resident.contains(l);
        hold_of((group, id), may(shown.level) && may(shown.from), "what is shown is in memory", || {
            format!("{} from {} where {resident:?} is", shown.level, shown.from)
        })?;
    }
    Ok(())
}

/// The views that can be used.
fn usable<'a>(views: &'a [ViewInput<'a>]) -> impl Iterator<Item = &'a ViewInput<'a>> {
    views.iter().filter(|v| v.view.check().is_ok())
}

/// All objects, by slot.
fn ids(objects: &Objects) -> impl Iterator<Item = ObjectId> + '_ {
    (0..objects.blocks().len() * crate::scene::BLOCK).filter_map(|slot| objects.id_of(slot))
}

fn counts(runtime: &Runtime, objects: &Objects, input: &FrameInput<'_>) -> Result<(), Violation> {
    let report = runtime.report();
    let broken = input.views.len() - usable(input.views).count();
    hold(report.broken_views == broken, "broken views are counted", || report.broken_views.to_string())?;
    let broken = ids(objects).filter_map(|id| objects.get(id)).filter(|o| !o.bounds.is_valid()).count();
    hold(report.broken_bounds == broken, "broken bounds are counted", || report.broken_bounds.to_string())?;
    let predicted_us = report.predicted_us;
    hold(predicted_us >= 0.0, "the predicted time is a time", || format!("{predicted_us} µs"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Sphere;
    use crate::select::{Coarsest, Finest};
    use crate::table::{LevelRecord, LodTable};
    use crate::view::View;
    use glam::{Vec2, Vec3};

    fn one_box() -> Objects {
        let mut objects = Objects::new();
        let levels = vec![LevelRecord::new(1000, 600), LevelRecord::new(10, 8)];
        let table = LodTable::new("box", Sphere::new(Vec3::ZERO, 1.0), levels).expect("a good table");
        let table = objects.add_table(table).expect("room");
        objects.insert(Object::new(7, Sphere::new(Vec3::new(0.0, 0.0, -5.0), 1.0), table)).expect("new");
        objects
    }

    fn rule_of(found: Result<(), Violation>) -> String {
        found.expect_err("a rule is broken").to_string()
    }

    #[test]
    fn broken_selections_are_named() {
        let mut objects = one_box();
        let views = [ViewInput::new(View::perspective(1.0, Vec2::new(800.0, 600.0)), 0)];
        let mut runtime =
            Runtime::new(RuntimeOptions::default(), Box::new(Finest)).expect("default options are good");
        let report = *runtime.frame(&mut objects, &FrameInput::new(&views, 0.0));
        let frame = runtime.last_frame(&objects);
        let (fine, select) = ([Level(0)], report.select);
        assert_eq!(selection(&frame, &fine, &select, Promise::Levels), Ok(()));
        let wrong = selection(&frame, &[Level(2)], &select, Promise::Levels);
        assert!(
            rule_of(wrong).starts_with("object 7 in group 0: the level is an allowed one (found level 2")
        );
        let none = selection(&frame, &[], &select, Promise::Levels);
        assert!(rule_of(none).contains("one level per candidate"));
        let cheap = SelectReport { cost_us: 0.0, ..select };
        assert!(rule_of(selection(&frame, &fine, &cheap, Promise::Levels)).contains("reported cost"));
        let fits = SelectReport { infeasible_us: 0.0, ..select };
        assert!(rule_of(selection(&frame, &fine, &fits, Promise::Levels)).contains("shortfall"));
        assert!(rule_of(selection(&frame, &fine, &select, Promise::Budget)).contains("cheapest"));
    }

    #[test]
    fn a_change_that_is_not_listed_is_found() {
        let mut objects = one_box();
        let views = [ViewInput::new(View::perspective(1.0, Vec2::new(800.0, 600.0)), 0)];
        let input = FrameInput::new(&views, 100.0);
        let options = RuntimeOptions::default();
        let mut runtime = Runtime::new(options, Box::new(Coarsest)).expect("default options are good");
        runtime.frame(&mut objects, &input);
        runtime.frame(&mut objects, &input);
        let late = Replay::new(options).frame(&runtime, &objects, &input, Promise::Levels);
        assert!(rule_of(late).contains("the changes add up to what is shown"));
    }
}
