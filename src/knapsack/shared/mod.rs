//! The greedy for classes that share hulls: what a frame loop can afford.
//!
//! The textbook greedy sorts every step of every class by slope and takes steps while they fit. Nearly all of that
//! order is wasted: a step matters only near the slope λ where the budget ends. So λ is *bracketed* first, from the
//! last call's λ or from a histogram over the bits of the slopes (positive floats sort as their bits); classes take all
//! their steps above the bracket without comparison, and only the steps inside it are sorted. The answer is that of the
//! textbook, whatever the bracket was.
//!
//! The objective can price switching: the steps of a class up to its current position count (1 + stay) times, the steps
//! beyond it (1 − stay) times. That keeps slopes falling along each hull, so the greedy and its bound hold for the
//! priced objective; the certificate of the plain one is computed beside it.
//!
//! Where there are many classes and most of them hold what they are going to hold, [`SharedKnapsack::solve_crowd`]
//! looks at the others alone. Its answer is that of [`SharedKnapsack::solve`].

mod certificate;
mod class;
mod crowd;
mod menus;
mod profiles;
mod sift;

pub use certificate::Outcome;
pub use crowd::{Crowd, OddClass};
pub use menus::{Ends, Menus, Octet, OwnClass};
pub use profiles::{Offer, Position, ProfileItem, Profiles};
pub(crate) use sift::{Columns, Hold, Units, opened, sift};

use certificate::Sums;
use class::{Class, scaled};
use crowd::Aside;
use profiles::position_at;

/// One class of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedClass {
    /// Number of the profile in [`SharedKnapsack::profiles`].
    pub profile: u32,
    /// Factor on the profile's values, finite and ≥ 0.
    pub weight: f32,
    /// Factor on the profile's ticks, finite and > 0.
    pub scale: f32,
    /// Price of switching, in 0…1 (exclusive): 0 for none.
    pub stay: f32,
    /// Position on the hull that the class holds now.
    pub current: u8,
}

/// Solver with its scratch and the memory of the last λ. Fill `profiles` and `classes`, call
/// [`SharedKnapsack::solve`], read `chosen`.
#[derive(Clone, Debug, Default)]
pub struct SharedKnapsack {
    /// The hulls.
    pub profiles: Profiles,
    /// The classes. Solving may change the profiles and current positions of classes; fill them anew for each call.
    pub classes: Vec<SharedClass>,
    /// The answer: the code of the chosen item of each class.
    pub chosen: Vec<u8>,
    choice: Vec<u8>,
    bracket: Bracket,
    undecided: Vec<Undecided>,
    blocked: Vec<bool>,
    /// Of a crowd: which class of it each of `classes` is, and what those that are not among them add up to. Of a list:
    /// nothing.
    owners: Vec<u32>,
    aside: Aside,
    /// A bit per class of the crowd: it is not settled.
    open: Vec<u16>,
    /// How many profiles there were at the start of the call. Others were made for its classes.
    shared: usize,
    opened: Vec<u32>,
    histogram: Vec<u64>,
    rival: Vec<u8>,
    affordable: Vec<ProfileItem>,
}

/// Where the last λ was, where it is going, and how far around there to look.
#[derive(Clone, Copy, Debug)]
struct Bracket {
    lambda: f32,
    /// By what factor it is expected to move.
    drift: f32,
    width: f32,
}

impl Default for Bracket {
    fn default() -> Self {
        Self { lambda: 0.0, drift: 1.0, width: *WIDTH.start() }
    }
}

/// A step inside the bracket.
#[derive(Clone, Copy, Debug)]
struct Undecided {
    slope: f32,
    class: u32,
    from: u8,
}

/// Costs over all classes at the ends of a bracket, and of the cheapest and the best choice.
#[derive(Clone, Copy, Debug, Default)]
struct Survey {
    cheapest: u64,
    best: u64,
    above: u64,
    down_to: u64,
    /// Cost of what the classes hold now.
    held: u64,
    /// The most that one class can cost beyond its cheapest position.
    widest: u64,
    /// The lower end of the bracket.
    low: f32,
}

impl Survey {
    fn add(&mut self, class: &Class<'_>, above: u8, down_to: u8) {
        let (cheapest, best) = (class.cost(0), class.cost(class.last()));
        self.cheapest = self.cheapest.saturating_add(cheapest);
        self.best = self.best.saturating_add(best);
        self.widest = self.widest.max(best - cheapest);
        self.held = self.held.saturating_add(class.cost(class.held()));
        self.above = self.above.saturating_add(class.cost(above));
        self.down_to = self.down_to.saturating_add(class.cost(down_to));
    }
}

/// A class held at a position, whatever its slope.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pin {
    class: usize,
    position: u8,
}

/// Where the greedy stopped: the first step that did not fit.
#[derive(Clone, Copy, Debug, Default)]
struct Critical {
    lambda: f32,
    step: Option<Pin>,
    steps: usize,
    /// The fill window that steps are taken in, and whether what is left is too little to go on.
    window: usize,
    done: bool,
}

impl Critical {
    /// The lowest slope of the window.
    fn low(&self) -> f32 {
        (self.lambda * FILL_WINDOWS[self.window]).max(f32::MIN_POSITIVE)
    }

    /// Whether there is a step that does not fit, and room for others.
    fn goes_on(&self) -> bool {
        self.step.is_some() && !self.done
    }

    /// Leaves the windows that end above `slope`, the last of them for good. It is done when too little of the budget
    /// is left at the end of any: whether it is depends on nothing but λ and the steps above, not on how they were
    /// found.
    fn descend(&mut self, slope: f32, room: u64, budget: u64) {
        while self.goes_on() && self.low() > slope {
            self.done = room <= budget / FILL_ENOUGH || self.window + 1 == FILL_WINDOWS.len();
            self.window += usize::from(!self.done);
        }
    }
}

/// Bracket widths around the last λ, as fractions: narrower means fewer steps to sort, wider fewer misses. A miss costs
/// a pass for the histogram and one for the survey.
const WIDTH: std::ops::RangeInclusive<f32> = 0.001..=0.1;

/// How far λ is expected to go on moving from one call to the next, as a factor. Further apart follows faster drives,
/// and expects more of a jump.
const DRIFT: std::ops::RangeInclusive<f32> = 0.8..=1.25;

/// Histogram buckets: the 12 highest of the 31 bits of a positive float, so that a bucket spans at most 1/16 of its
/// slope. More buckets leave the first-level cache, fewer leave more steps to sort.
const BUCKETS: usize = 1 << 12;
const BUCKET_SHIFT: u32 = 31 - 12;

/// After the first step that does not fit, others are looked for down to these fractions of its slope, a pass each.
/// More windows find less to sort in each, and cost more passes.
const FILL_WINDOWS: [f32; 9] = [0.99, 0.95, 0.8, 0.5, 0.2, 0.05, 0.01, 0.001, 0.0];

/// The fill stops when less than this fraction of the budget is left: it would buy less than looking costs.
const FILL_ENOUGH: u64 = 1 << 15;

/// Above this relative gap the rival choice, critical step first, is tried as well.
const RIVAL_GAP: f64 = 1e-3;

impl SharedKnapsack {
    /// Chooses an item for every class: at least half of the attainable priced benefit beyond the cheapest choice, and
    /// nearly all of it where steps are small against the budget. `key` breaks ties between equal slopes, the lower
    /// first; it must be unique per class.
    ///
    /// With `ease` below `budget` the budget has a dead band: more is bought only up to `ease`, while what is held is
    /// kept up to `budget`. The choice is then the best for the cost that is held, held between the two; the
    /// certificate stays that of `budget`. Where one item alone takes more than that, the dead band is left out.
    ///
    /// The ½ follows Kellerer, Pferschy and Pisinger, *Knapsack Problems*, 2004, ch. 11: items that do not fit beside
    /// the cheapest of all others are dropped before hulls are made, and the rival that takes the critical step first
    /// is tried where it could win.
    ///
    /// Time: O(positions) and a sort of the steps inside the bracket. Allocates only to grow its scratch.
    pub fn solve(&mut self, budget: u64, ease: u64, key: impl Fn(usize) -> u128) -> Outcome {
        let shared = self.profiles.len();
        self.owners.clear();
        self.aside.clear();
        let outcome = self.choose(budget, ease.min(budget), &key);
        self.note_chosen();
        self.profiles.truncate(shared);
        outcome
    }

    /// Forgets the last λ: the next call starts from the histogram.
    pub fn forget(&mut self) {
        self.bracket = Bracket::default();
    }

    fn choose(&mut self, budget: u64, ease: u64, key: &impl Fn(usize) -> u128) -> Outcome {
        let mut survey = self.survey(self.warm_bracket(), None);
        if survey.cheapest > budget {
            return self.keep_cheapest(survey.cheapest - budget, budget);
        }
        let target = self.target(&survey, budget, ease);
        if survey.best <= target {
            return self.take_all(budget);
        }
        if survey.widest > target - survey.cheapest {
            self.drop_unaffordable(target - survey.cheapest);
            survey = self.survey(self.warm_bracket(), None);
        }
        let critical = self.greedy(survey, target, None, key);
        self.bracket.follow(critical.lambda);
        let sums = self.certify(critical.lambda);
        let outcome = Outcome { steps: critical.steps, ..sums.outcome(budget, &self.aside) };
        match critical.step {
            Some(step) if sums.outcome(target, &self.aside).priced_gap() > RIVAL_GAP => {
                self.better_of(outcome, step, target, key)
            }
            _ => outcome,
        }
    }

    /// Nothing is affordable: every class at its cheapest position.
    fn keep_cheapest(&mut self, shortfall: u64, budget: u64) -> Outcome {
        self.choice.fill(0);
        Outcome { shortfall, ..self.certify(0.0).outcome(budget, &self.aside) }
    }

    /// Everything is affordable: every class takes all steps that are worth anything.
    fn take_all(&mut self, budget: u64) -> Outcome {
        self.survey([f32::MIN_POSITIVE; 2], None);
        self.certify(0.0).outcome(budget, &self.aside)
    }

    /// Notes the items of the choice.
    fn note_chosen(&mut self) {
        let items = self
            .classes
            .iter()
            .zip(&self.choice)
            .map(|(class, &position)| self.profiles.positions(class.profile)[usize::from(position)].item);
        self.chosen.clear();
        self.chosen.extend(items);
    }

    /// What to spend: what is held, held between `ease` and `budget`. Where the dead band alone would keep an item out
    /// there is none: with that item perhaps most of the benefit would be lost.
    fn target(&self, survey: &Survey, budget: u64, ease: u64) -> u64 {
        let target = survey.held.clamp(ease, budget);
        let (room, whole) = (target - survey.cheapest, budget - survey.cheapest);
        let kept_out = |class: &SharedClass| {
            let cheapest = Class::new(&self.profiles, class).cost(0);
            let mut items = self.profiles.items(class.profile).iter();
            items.any(|item| {
                let extra = scaled(item.ticks, class.scale) - cheapest;
                room < extra && extra <= whole
            })
        };
        if survey.widest > room && self.classes.iter().any(kept_out) { budget } else { target }
    }

    /// The bracket around where the last λ is going; an empty one at the top when there is none.
    fn warm_bracket(&self) -> [f32; 2] {
        let (lambda, width) = (self.bracket.expected(), self.bracket.width);
        if lambda > 0.0 {
            // Farther below than above, so that the first fill window is in it.
            [(lambda * (0.99 - 1.5 * width)).max(f32::MIN_POSITIVE), lambda * (1.0 + width)]
        } else {
            [f32::MAX; 2]
        }
    }

    /// One pass: every class takes its steps at or above the bracket's upper end into `choice`, its steps inside go to
    /// `undecided`, and the costs are summed.
    fn survey(&mut self, bracket: [f32; 2], pin: Option<Pin>) -> Survey {
        let [low, high] = bracket;
        let cost = self.aside.cost;
        let mut survey = Survey { low, above: cost, down_to: cost, ..Survey::default() };
        self.undecided.clear();
        self.choice.clear();
        self.blocked.clear();
        self.blocked.resize(self.classes.len(), false);
        for (i, class) in self.classes.iter().enumerate() {
            let class = Class::new(&self.profiles, class);
            let (above, down_to) = match pin.filter(|p| p.class == i) {
                Some(pin) => (pin.position, pin.position),
                None => {
                    let above = class.reach(class.held(), high);
                    (above, class.reach(above, low))
                }
            };
            self.choice.push(above);
            for from in above..down_to {
                self.undecided.push(Undecided { slope: class.slope(from), class: i as u32, from });
            }
            survey.add(&class, above, down_to);
        }
        survey
    }

    /// Gives every class that has an item costing more than `room` beyond its cheapest one a profile without such
    /// items. They could never be chosen, and a hull through them would hide the ones that can.
    fn drop_unaffordable(&mut self, room: u64) {
        for i in 0..self.classes.len() {
            let class = Class::new(&self.profiles, &self.classes[i]);
            if class.cost(class.last()) - class.cost(0) <= room {
                continue;
            }
            let limit = class.cost(0).saturating_add(room);
            let scale = class.scale;
            let held = class.positions[usize::from(class.held())].ticks;
            self.affordable.clear();
            let items = self.profiles.items(self.classes[i].profile).iter();
            self.affordable.extend(items.filter(|item| scaled(item.ticks, scale) <= limit));
            let narrowed = self.profiles.push(&self.affordable);
            self.classes[i].profile = narrowed;
            self.classes[i].current = position_at(self.profiles.positions(narrowed), held);
        }
    }

    /// The textbook greedy, given a survey: makes sure that the bracket holds the budget, takes the steps inside it in
    /// order while they fit, and fills what is left.
    fn greedy(
        &mut self,
        survey: Survey,
        budget: u64,
        pin: Option<Pin>,
        key: &impl Fn(usize) -> u128,
    ) -> Critical {
        let survey = self.bracketed(survey, budget, pin);
        if let Some(pin) = pin {
            self.blocked[pin.class] = true;
        }
        let mut critical = Critical::default();
        let mut room = budget - survey.above;
        self.take(budget, &mut room, &mut critical, key);
        critical.descend(survey.low, room, budget);
        while critical.goes_on() {
            self.gather(critical.low(), room);
            self.take(budget, &mut room, &mut critical, key);
            critical.descend(critical.low().next_down(), room, budget);
        }
        critical
    }

    /// The survey if the budget lies inside its bracket, else one of the histogram's bracket.
    fn bracketed(&mut self, survey: Survey, budget: u64, pin: Option<Pin>) -> Survey {
        if survey.above <= budget && budget < survey.down_to {
            return survey;
        }
        self.bracket.widen();
        let bracket = self.cold_bracket(budget, pin);
        self.survey(bracket, pin)
    }

    /// The bucket of slopes where the budget ends, from a histogram of step costs. Where all steps of a positive slope
    /// fit, the bracket is empty and below them.
    fn cold_bracket(&mut self, budget: u64, pin: Option<Pin>) -> [f32; 2] {
        self.histogram.clear();
        self.histogram.resize(BUCKETS, 0);
        let mut spent = 0;
        for i in 0..self.classes.len() {
            let class = Class::new(&self.profiles, &self.classes[i]);
            if let Some(pin) = pin.filter(|p| p.class == i) {
                spent = class.cost(pin.position).saturating_add(spent);
                continue;
            }
            spent = class.cost(0).saturating_add(spent);
            for from in 0..class.last() {
                let bucket = class.slope(from).to_bits() >> BUCKET_SHIFT;
                let bucket = &mut self.histogram[bucket as usize];
                *bucket = bucket.saturating_add(class.cost(from + 1) - class.cost(from));
            }
        }
        let critical = (0..BUCKETS).rev().find(|&bucket| {
            spent = self.histogram[bucket].saturating_add(spent);
            spent > budget
        });
        let edge = |bucket: usize| f32::from_bits((bucket as u32) << BUCKET_SHIFT).max(f32::MIN_POSITIVE);
        critical.map_or([f32::MIN_POSITIVE; 2], |bucket| [edge(bucket), edge(bucket + 1)])
    }

    /// Takes undecided steps in order of slope while they fit; a class whose step does not fit takes no later one.
    fn take(&mut self, budget: u64, room: &mut u64, critical: &mut Critical, key: &impl Fn(usize) -> u128) {
        let owners = &self.owners;
        let key =
            |class: u32| key(owners.get(class as usize).map_or(class as usize, |&owner| owner as usize));
        self.undecided.sort_unstable_by(|a, b| {
            b.slope
                .total_cmp(&a.slope)
                .then_with(|| key(a.class).cmp(&key(b.class)))
                .then(a.from.cmp(&b.from))
        });
        critical.steps += self.undecided.len();
        for step in &self.undecided {
            critical.descend(step.slope, *room, budget);
            if critical.done {
                break;
            }
            let i = step.class as usize;
            let class = Class::new(&self.profiles, &self.classes[i]);
            let cost = class.cost(step.from + 1) - class.cost(step.from);
            if self.blocked[i] {
                continue;
            }
            if cost <= *room {
                *room -= cost;
                self.choice[i] = step.from + 1;
            } else {
                self.blocked[i] = true;
                if critical.step.is_none() {
                    critical.step = Some(Pin { class: i, position: step.from + 1 });
                    critical.lambda = step.slope;
                }
            }
        }
    }

    /// Collects the untaken steps of slope `low` or more that fit by themselves.
    fn gather(&mut self, low: f32, room: u64) {
        self.undecided.clear();
        for i in 0..self.classes.len() {
            let class = Class::new(&self.profiles, &self.classes[i]);
            let mut from = self.choice[i];
            let mut fits = !self.blocked[i];
            while fits && class.slope(from) >= low {
                fits = class.cost(from + 1) - class.cost(from) <= room;
                if fits {
                    self.undecided.push(Undecided { slope: class.slope(from), class: i as u32, from });
                    from += 1;
                }
            }
            // Steps collected before the one that does not fit may still be taken.
            self.blocked[i] |= !fits && from == self.choice[i];
        }
    }

    /// Tries the choice that takes the critical step first, and keeps the better one.
    fn better_of(&mut self, found: Outcome, step: Pin, budget: u64, key: &impl Fn(usize) -> u128) -> Outcome {
        self.rival.clone_from(&self.choice);
        let survey = self.survey([f32::MAX; 2], Some(step));
        let critical = self.greedy(survey, budget, Some(step), key);
        let rival = self.certify(critical.lambda).outcome(budget, &self.aside);
        let steps = found.steps + critical.steps;
        if rival.priced_benefit > found.priced_benefit {
            let Outcome { upper_bound, priced_bound, lambda, .. } = found;
            return Outcome { upper_bound, priced_bound, lambda, steps, ..rival };
        }
        std::mem::swap(&mut self.rival, &mut self.choice);
        Outcome { steps, ..found }
    }

    /// Sums up what the choice comes to and what is possible at λ.
    fn certify(&self, lambda: f32) -> Sums {
        let mut sums = Sums::new(lambda, &self.classes);
        for (class, &position) in self.classes.iter().zip(&self.choice) {
            sums.add(&Class::new(&self.profiles, class), position);
        }
        sums
    }
}

impl Bracket {
    fn expected(&self) -> f32 {
        self.lambda * self.drift
    }

    /// After λ has been found: so wide that it could have been twice as far from where it was expected, and not much
    /// wider.
    fn follow(&mut self, lambda: f32) {
        if self.lambda > 0.0 {
            let missed = (lambda / self.expected() - 1.0).abs();
            self.width = (self.width * 0.5).max(2.0 * missed).clamp(*WIDTH.start(), *WIDTH.end());
            let moved = (lambda / self.lambda).clamp(*DRIFT.start(), *DRIFT.end());
            self.drift = 0.5 * (self.drift + moved);
        }
        self.lambda = lambda;
    }

    /// After a miss, if there was a λ to go by.
    fn widen(&mut self) {
        if self.lambda > 0.0 {
            self.width = (self.width * 4.0).min(*WIDTH.end());
        }
    }
}
