//! Classes by the hundred thousand, nearly all of which stay where they are.
//!
//! Before anything else it is clear from counts alone whether not even the cheapest choice fits, or everything does, or λ
//! has to be found. Given a bracket of λ, [`sift`] finds the classes that hold their item whatever λ in it turns out to be.
//! Of the others most go to one position whatever λ is; they are decided, and set aside with the settled ones as sums. Only
//! the rest are listed as classes, and solved as a list is. The answer is that of the list of all classes.

use super::certificate::{NEAR, Sums, best};
use super::class::Class;
use super::sift::{Columns, Units, opened, sift};
use super::{Critical, Outcome, Profiles, SharedClass, SharedKnapsack, Survey};

/// The classes of a call, column by column.
pub struct Crowd<'a, F> {
    /// Factor on the profile's values, finite and ≥ 0.
    pub weight: &'a [f32],
    /// No weight is greater.
    pub heaviest: f32,
    /// The number of the item that a class of scale 1 holds, among the items of all profiles in the order in which they
    /// were pushed. Any number beyond the census for an odd class.
    pub place: &'a [u32],
    /// How many classes hold each item.
    pub census: &'a [u32],
    /// The others in full, ascending.
    pub odd: &'a [OddClass],
    /// Price of switching of a class, in 0…1 (exclusive).
    pub stay: F,
    /// How many threads look through the columns (feature `rayon`); answers are the same.
    pub threads: usize,
}

/// A class of a crowd that holds no item, or has a scale or a profile of its own.
#[derive(Clone, Copy, Debug)]
pub struct OddClass {
    /// Which one it is.
    pub at: u32,
    /// The class in full.
    pub class: SharedClass,
}

impl<F: Fn(usize) -> f32> Crowd<'_, F> {
    fn holds_item(&self, i: usize) -> bool {
        (self.place[i] as usize) < self.census.len()
    }

    /// A class in full.
    pub fn class(&self, profiles: &Profiles, i: usize) -> SharedClass {
        match self.holds_item(i) {
            true => self.holder(profiles, i),
            false => self.odd[self.odd.partition_point(|odd| (odd.at as usize) < i)].class,
        }
    }

    /// A class that holds an item.
    fn holder(&self, profiles: &Profiles, i: usize) -> SharedClass {
        profiles.class_at(self.place[i], self.weight[i], (self.stay)(i))
    }

    /// A reader of classes, to be asked for ascending ones.
    fn reader<'a>(&'a self, profiles: &'a Profiles) -> impl FnMut(usize) -> SharedClass + 'a {
        let mut odd = self.odd.iter();
        move |i| match self.holds_item(i) {
            true => self.holder(profiles, i),
            false => {
                odd.by_ref().find(|odd| odd.at as usize == i).map_or(SharedClass::NOTHING, |odd| odd.class)
            }
        }
    }
}

/// What all classes add up to, in ticks, wherever λ is.
#[derive(Clone, Copy, Debug, Default)]
struct Totals {
    cheapest: u64,
    held: u64,
    best: u64,
    /// The most that one class can cost beyond its cheapest position.
    widest: u64,
}

impl Totals {
    fn of<F>(profiles: &Profiles, crowd: &Crowd<'_, F>) -> Self {
        let mut totals = Self::default();
        for (item, &count) in crowd.census.iter().enumerate().filter(|&(_, &count)| count > 0) {
            totals.add(profiles.item_ticks(item), u64::from(count));
        }
        for odd in crowd.odd {
            let class = Class::new(profiles, &odd.class);
            totals.add([0, class.held(), class.last()].map(|position| class.cost(position)), 1);
        }
        totals
    }

    fn add(&mut self, [cheapest, held, best]: [u64; 3], times: u64) {
        self.cheapest = self.cheapest.saturating_add(cheapest.saturating_mul(times));
        self.held = self.held.saturating_add(held.saturating_mul(times));
        self.best = self.best.saturating_add(best.saturating_mul(times));
        self.widest = self.widest.max(best - cheapest);
    }
}

/// What is known of the classes that are not listed.
#[derive(Clone, Debug, Default)]
pub(super) struct Aside {
    /// How many there are.
    pub classes: u64,
    /// Cost of where they are going, in ticks.
    pub cost: u64,
    /// Benefit of where they are going.
    pub benefit: Units,
    /// Those that go elsewhere than they are.
    moved: Vec<Decided>,
    /// Those that stay for the price of switching alone: without it they would be elsewhere for some λ of the bracket.
    hovering: Vec<Decided>,
    /// What would be gained by moving them to their best positions, and what that would cost.
    pub hover_value: i128,
    pub hover_cost: i128,
    /// Bit per class: it is listed, or has moved.
    marked: Vec<u64>,
}

/// A class that goes to a position whatever λ is.
#[derive(Clone, Copy, Debug)]
struct Decided {
    at: u32,
    class: SharedClass,
    position: u8,
    /// It has been listed after all.
    listed: bool,
}

impl Aside {
    /// Nobody.
    pub fn clear(&mut self) {
        (self.classes, self.cost, self.benefit) = (0, 0, Units::default());
        (self.hover_value, self.hover_cost) = (0, 0);
        self.moved.clear();
        self.hovering.clear();
    }

    fn mark(&mut self, i: usize) {
        self.marked[i / 64] |= 1 << (i % 64);
    }

    fn is_marked(&self, i: usize) -> bool {
        self.marked[i / 64] & (1 << (i % 64)) != 0
    }

    /// Everyone who holds an item, as if settled, but for what they are worth.
    fn begin<F>(&mut self, profiles: &Profiles, crowd: &Crowd<'_, F>) {
        self.clear();
        self.marked.clear();
        self.marked.resize(crowd.weight.len().div_ceil(64), 0);
        for (item, &count) in crowd.census.iter().enumerate().filter(|&(_, &count)| count > 0) {
            let [_, held, _] = profiles.item_ticks(item);
            self.classes += u64::from(count);
            self.cost = self.cost.saturating_add(held.saturating_mul(u64::from(count)));
        }
    }

    /// Takes out a class that holds an item and is not settled.
    fn dismiss(&mut self, class: &Class<'_>) {
        self.classes -= 1;
        self.cost = self.cost.saturating_sub(class.cost(class.held()));
    }

    /// Sets a class aside that goes to its position for every λ of the bracket. `held` is the code of the item it holds.
    fn decide(&mut self, decided: Decided, class: &Class<'_>, held: Option<u8>, [low, high]: [f32; 2]) {
        let position = decided.position;
        self.add(class, position);
        // A held item that is no corner of its hull is not held on.
        if held != Some(class.positions[usize::from(position)].item) {
            self.mark(decided.at as usize);
            self.moved.push(decided);
        }
        // Slopes at the very ends of the bracket may be on their other sides without rounding.
        let (low, high) = (low * (1.0 - NEAR), high * (1.0 + NEAR));
        if class.plain_slope(position) >= low || position > 0 && class.plain_slope(position - 1) < high {
            self.hovering.push(decided);
        }
    }

    /// Sets a class aside that goes to `position`.
    fn add(&mut self, class: &Class<'_>, position: u8) {
        let value = |p: u8| self.benefit.of(class.weight, class.positions[usize::from(p)].value);
        let (here, least) = (value(position), value(0));
        self.benefit.value += here;
        self.benefit.least += least;
        self.cost = self.cost.saturating_add(class.cost(position));
        self.classes += 1;
    }

    /// Undoes [`Aside::add`].
    fn remove(&mut self, class: &Class<'_>, position: u8) {
        let value = |p: u8| self.benefit.of(class.weight, class.positions[usize::from(p)].value);
        let (here, least) = (value(position), value(0));
        self.benefit.value -= here;
        self.benefit.least -= least;
        self.cost = self.cost.saturating_sub(class.cost(position));
        self.classes -= 1;
    }

    /// How much rounding may hide in the benefit.
    pub fn hidden(&self) -> f64 {
        (self.classes + 2 * self.hovering.len() as u64) as f64 * self.benefit.unit
    }

    /// Adds up what the price of switching keeps the hovering classes from at λ.
    fn weigh_hovering(&mut self, profiles: &Profiles, lambda: f32) {
        (self.hover_value, self.hover_cost) = (0, 0);
        for Decided { class, position, .. } in self.hovering.iter().filter(|h| !h.listed) {
            let (class, position) = (Class::new(profiles, class), *position);
            let best = best(&class, position, lambda, |p| class.plain_slope(p), |p| class.plain(p));
            let value = |p: u8| self.benefit.of(class.weight, class.positions[usize::from(p)].value);
            self.hover_value += value(best) - value(position);
            self.hover_cost += i128::from(class.cost(best)) - i128::from(class.cost(position));
        }
    }
}

fn make_room<T>(list: &mut Vec<T>, len: usize) {
    list.reserve(len.saturating_sub(list.len()));
}

/// Brackets that are tried before the classes are listed one and all.
const TRIES: usize = 6;

/// How much farther a bracket reaches than the one that λ turned out to be beyond.
const REACH: f32 = 0.15;

/// A sample is so large at least.
const SAMPLE: usize = 8192;

impl SharedKnapsack {
    /// [`SharedKnapsack::solve`] of a crowd. Afterwards [`SharedKnapsack::changed`] lists the classes that were looked at
    /// closely; all others hold what they held. `key` is given places in the crowd.
    ///
    /// Time: O(items) and a pass over the columns where λ is near the last one, a few passes where it is not. Where one
    /// item takes a large part of the budget, or the gap is large, all classes are listed.
    pub fn solve_crowd<F: Fn(usize) -> f32>(
        &mut self,
        crowd: &Crowd<'_, F>,
        budget: u64,
        ease: u64,
        key: impl Fn(usize) -> u128,
    ) -> Outcome {
        let shared = self.profiles.len();
        let ease = ease.min(budget);
        let outcome = match self.solve_aside(crowd, budget, ease, &key) {
            Some(outcome) => outcome,
            None => {
                self.list_all(crowd);
                self.choose(budget, ease, &key)
            }
        };
        self.note_chosen();
        self.profiles.truncate(shared);
        outcome
    }

    /// The classes of a crowd that were looked at closely, and the codes of their chosen items.
    pub fn changed(&self) -> impl Iterator<Item = (usize, u8)> {
        let moved = self.aside.moved.iter().filter(|m| !m.listed).map(|moved| {
            let positions = self.profiles.positions(moved.class.profile);
            (moved.at as usize, positions[usize::from(moved.position)].item)
        });
        let listed = self.owners.iter().zip(&self.chosen).map(|(&owner, &item)| (owner as usize, item));
        moved.chain(listed)
    }

    /// The answer, with few classes listed; `None` where that is not enough to be sure of it.
    fn solve_aside<F: Fn(usize) -> f32>(
        &mut self,
        crowd: &Crowd<'_, F>,
        budget: u64,
        ease: u64,
        key: &impl Fn(usize) -> u128,
    ) -> Option<Outcome> {
        let totals = Totals::of(&self.profiles, crowd);
        if totals.cheapest > budget {
            self.sift(crowd, [f32::MAX; 2]);
            let shortfall = totals.cheapest - budget;
            return Some(Outcome { shortfall, ..self.sum_up(0.0).outcome(budget, &self.aside) });
        }
        let target = totals.held.clamp(ease, budget);
        if totals.best <= target {
            self.sift(crowd, [f32::MIN_POSITIVE; 2]);
            return Some(self.sum_up(0.0).outcome(budget, &self.aside));
        }
        if totals.widest > target - totals.cheapest {
            return None;
        }
        let (survey, bracket) = self.bracket_crowd(crowd, target)?;
        let critical = self.greedy_aside(crowd, survey, target, bracket, key);
        self.bracket.lambda = critical.lambda;
        let sums = self.sum_up(critical.lambda);
        let is_near = sums.outcome(target, &self.aside).priced_gap() <= super::RIVAL_GAP;
        is_near.then(|| Outcome { steps: critical.steps, ..sums.outcome(budget, &self.aside) })
    }

    /// Lists every class.
    fn list_all<F: Fn(usize) -> f32>(&mut self, crowd: &Crowd<'_, F>) {
        let Self { profiles, classes, owners, aside, .. } = self;
        aside.clear();
        classes.clear();
        classes.extend((0..crowd.weight.len()).map(crowd.reader(profiles)));
        owners.clear();
        owners.extend(0..crowd.weight.len() as u32);
    }

    /// A bracket that the budget ends in, and the survey of the classes that it leaves to be listed: around the last λ, or
    /// where a sample of the crowd says.
    fn bracket_crowd<F: Fn(usize) -> f32>(
        &mut self,
        crowd: &Crowd<'_, F>,
        target: u64,
    ) -> Option<(Survey, [f32; 2])> {
        let is_warm = self.bracket.lambda > 0.0;
        let mut bracket = if is_warm { self.warm_bracket() } else { self.sampled_bracket(crowd, target) };
        for attempt in 0..TRIES {
            let survey = self.sift(crowd, bracket);
            if survey.above <= target && target < survey.down_to {
                self.bracket.narrow();
                return Some((survey, bracket));
            }
            self.bracket.widen();
            let [low, high] = bracket;
            bracket = if attempt == 0 && is_warm {
                self.sampled_bracket(crowd, target)
            } else if survey.above > target {
                [high, high * (1.0 + REACH)]
            } else {
                [(low * (1.0 - REACH)).max(f32::MIN_POSITIVE), low]
            };
        }
        None
    }

    /// The bracket that a sample of the crowd suggests.
    fn sampled_bracket<F: Fn(usize) -> f32>(&mut self, crowd: &Crowd<'_, F>, target: u64) -> [f32; 2] {
        let every = (crowd.weight.len() / SAMPLE).max(1);
        let Self { profiles, classes, .. } = self;
        classes.clear();
        classes.extend((0..crowd.weight.len()).step_by(every).map(crowd.reader(profiles)));
        let share = classes.len() as f64 / crowd.weight.len() as f64;
        let [low, high] = self.cold_bracket((target as f64 * share) as u64, None);
        [(low * 0.98).max(f32::MIN_POSITIVE), high * 1.02]
    }

    /// Makes room for as many classes to be looked at closely as there are, so that a frame with more of them than any
    /// before allocates nothing. None of it is touched until it is used.
    fn make_room(&mut self, classes: usize) {
        let Self { aside, .. } = self;
        [&mut aside.moved, &mut aside.hovering].into_iter().for_each(|list| make_room(list, classes));
        [&mut self.opened, &mut self.owners].into_iter().for_each(|list| make_room(list, classes));
        [&mut self.choice, &mut self.chosen].into_iter().for_each(|list| make_room(list, classes));
        make_room(&mut self.classes, classes);
        make_room(&mut self.open, classes / 16 + 1);
        make_room(&mut self.blocked, classes);
        make_room(&mut self.undecided, classes);
    }

    /// Sets aside what is settled or decided for every λ of the bracket, lists the rest, and surveys it.
    fn sift<F: Fn(usize) -> f32>(&mut self, crowd: &Crowd<'_, F>, bracket: [f32; 2]) -> Survey {
        let [low, high] = bracket;
        self.make_room(crowd.weight.len());
        let Self { profiles, classes, owners, aside, open, .. } = self;
        classes.clear();
        owners.clear();
        aside.begin(profiles, crowd);
        let &Crowd { weight, heaviest, place, .. } = crowd;
        let columns = Columns { size: weight, weight, heaviest, place, holds: profiles.holds() };
        aside.benefit = sift(columns, bracket, crowd.threads, open);
        let mut read = crowd.reader(profiles);
        for i in opened(open) {
            let shared = read(i);
            let class = Class::new(profiles, &shared);
            let above = class.reach(class.held(), high);
            let held = crowd.holds_item(i).then(|| profiles.code(crowd.place[i]));
            if held.is_some() {
                aside.dismiss(&class);
            }
            if class.reach(above, low) == above {
                let decided = Decided { at: i as u32, class: shared, position: above, listed: false };
                aside.decide(decided, &class, held, bracket);
            } else {
                classes.push(shared);
                owners.push(i as u32);
                aside.mark(i);
            }
        }
        drop(read);
        self.survey(bracket, None)
    }

    /// The greedy of a crowd, the budget being inside the bracket.
    fn greedy_aside<F: Fn(usize) -> f32>(
        &mut self,
        crowd: &Crowd<'_, F>,
        survey: Survey,
        budget: u64,
        bracket: [f32; 2],
        key: &impl Fn(usize) -> u128,
    ) -> Critical {
        let mut critical = Critical::default();
        let mut room = budget - survey.above;
        self.take(budget, &mut room, &mut critical, key);
        critical.descend(survey.low, room, budget);
        let mut above = bracket[0];
        while critical.goes_on() {
            let low = critical.low();
            self.list_openings(crowd, [low, above], room);
            self.gather(low, room);
            self.take(budget, &mut room, &mut critical, key);
            critical.descend(low.next_down(), room, budget);
            above = low;
        }
        critical
    }

    /// Lists the classes set aside whose next step has a slope of at least `low`, below `above`, and fits.
    fn list_openings<F: Fn(usize) -> f32>(
        &mut self,
        crowd: &Crowd<'_, F>,
        [low, above]: [f32; 2],
        room: u64,
    ) {
        let is_opening = |class: &Class<'_>, position: u8| {
            let slope = class.slope(position);
            let step = || class.cost(position + 1) - class.cost(position);
            slope >= low && slope < above && step() <= room
        };
        let mut found = std::mem::take(&mut self.opened);
        found.clear();
        let holds = self.profiles.holds();
        let goes_on = |i: &usize| {
            let hold = holds.get(crowd.place[*i] as usize);
            hold.is_some_and(|hold| hold.may_go_on(crowd.weight[*i], low)) && !self.aside.is_marked(*i)
        };
        found.extend((0..crowd.weight.len()).filter(goes_on).map(|i| i as u32));
        for &i in &found {
            let shared = crowd.holder(&self.profiles, i as usize);
            let class = Class::new(&self.profiles, &shared);
            if is_opening(&class, class.held()) {
                self.aside.remove(&class, class.held());
                let hovering = self.aside.hovering.binary_search_by_key(&i, |h| h.at);
                hovering.into_iter().for_each(|at| self.aside.hovering[at].listed = true);
                let position = class.held();
                self.list(i, shared, position);
            }
        }
        self.opened = found;
        for at in 0..self.aside.moved.len() {
            let Decided { at: i, class: shared, position, listed } = self.aside.moved[at];
            let class = Class::new(&self.profiles, &shared);
            if !listed && is_opening(&class, position) {
                self.aside.remove(&class, position);
                self.aside.moved[at].listed = true;
                let hovering = self.aside.hovering.binary_search_by_key(&i, |h| h.at);
                hovering.into_iter().for_each(|at| self.aside.hovering[at].listed = true);
                self.list(i, shared, position);
            }
        }
    }

    /// Lists a class that is at a position.
    fn list(&mut self, i: u32, class: SharedClass, position: u8) {
        self.classes.push(class);
        self.owners.push(i);
        self.choice.push(position);
        self.blocked.push(false);
        self.aside.mark(i as usize);
    }

    /// Sums up the choice and the classes set aside, and what is possible at λ.
    fn sum_up(&mut self, lambda: f32) -> Sums {
        self.aside.weigh_hovering(&self.profiles, lambda);
        self.certify(lambda)
    }
}
