//! Classes by the hundred thousand, nearly all of which stay where they are.
//!
//! Before anything else it is clear from counts alone whether not even the cheapest choice fits, or everything does, or
//! λ has to be found. Given a bracket of λ, [`sift`] finds the classes that hold their item whatever λ in it turns out
//! to be. Of the others most go to one position whatever λ is; they are decided, and set aside with the settled ones as
//! sums. Only the rest are listed as classes, and solved as a list is. The answer is that of the list of all classes.
//!
//! Classes with items of their own are decided from these (`menus.rs`). A hull is made for those that are listed alone.

use super::certificate::{NEAR, Sums, best};
use super::class::Class;
use super::menus::{LANES, Menu, Menus, Pick};
use super::sift::{Columns, Units, opened, sift};
use super::{Critical, Offer, Outcome, Profiles, SharedClass, SharedKnapsack, Survey};

/// The classes of a call, column by column.
pub struct Crowd<'a, F, M> {
    /// Factor on the profile's values, finite and ≥ 0.
    pub weight: &'a [f32],
    /// No weight is greater.
    pub heaviest: f32,
    /// The number of the item that a class of scale 1 holds, among the items of all profiles in the order in which they
    /// were pushed. Any number beyond the census for a class that is odd or has items of its own.
    pub place: &'a [u32],
    /// How many classes hold each item.
    pub census: &'a [u32],
    /// Odd classes in full, ascending.
    pub odd: &'a [OddClass],
    /// Those with items of their own.
    pub own: M,
    /// Price of switching of a class, in 0…1 (exclusive).
    pub stay: F,
    /// How many threads look through the columns (feature `rayon`); answers are the same.
    pub threads: usize,
}

/// A class of a crowd that holds no item, or has a scale of its own.
#[derive(Clone, Copy, Debug)]
pub struct OddClass {
    /// Which one it is.
    pub at: u32,
    /// The class in full.
    pub class: SharedClass,
}

/// Where a class of a crowd is described.
#[derive(Clone, Copy, Debug)]
enum Entry {
    /// By the item it holds.
    Held,
    /// At this number of the odd ones.
    Odd(usize),
    /// At this number of those with items of their own.
    Own(usize),
}

impl<F: Fn(usize) -> f32, M: Menus> Crowd<'_, F, M> {
    fn holds_item(&self, i: usize) -> bool {
        (self.place[i] as usize) < self.census.len()
    }

    /// What a class costs and is worth with the item of a code; `None` when it has no such item. O(log classes).
    pub fn offer(&self, profiles: &Profiles, i: usize, code: u8) -> Option<Offer> {
        if self.holds_item(i) {
            return profiles.offer(&self.holder(profiles, i), code);
        }
        match self.odd.binary_search_by_key(&i, |odd| odd.at as usize) {
            Ok(odd) => profiles.offer(&self.odd[odd].class, code),
            Err(_) => self.menu(self.own_number(i)).offer(code),
        }
    }

    /// Which of the classes with items of their own this is.
    fn own_number(&self, i: usize) -> usize {
        let (mut first, mut end) = (0, self.own.len());
        while end - first > 1 {
            let middle = first.midpoint(end);
            if self.own.class(middle).at as usize <= i { first = middle } else { end = middle }
        }
        first
    }

    fn menu(&self, n: usize) -> Menu<'_, M> {
        Menu::new(&self.own, n)
    }

    fn menus(&self) -> impl Iterator<Item = Menu<'_, M>> {
        (0..self.own.len()).map(|n| self.menu(n))
    }

    /// A class that holds an item.
    fn holder(&self, profiles: &Profiles, i: usize) -> SharedClass {
        profiles.class_at(self.place[i], self.weight[i], (self.stay)(i))
    }

    /// A class with a hull: with one made for it where it shares none.
    fn class(&self, profiles: &mut Profiles, i: usize, entry: Entry) -> SharedClass {
        match entry {
            Entry::Held => self.holder(profiles, i),
            Entry::Odd(odd) => self.odd[odd].class,
            Entry::Own(n) => self.menu(n).with_hull(profiles),
        }
    }

    /// Finds the entries of classes, to be asked for ascending ones.
    fn finder(&self) -> impl FnMut(usize) -> Entry {
        let (mut odd, mut own) = (0, 0);
        move |i| {
            if self.holds_item(i) {
                return Entry::Held;
            }
            while own < self.own.len() && (self.own.class(own).at as usize) < i {
                own += 1;
            }
            if own < self.own.len() && self.own.class(own).at as usize == i {
                return Entry::Own(own);
            }
            odd += self.odd[odd..].iter().take_while(|odd| (odd.at as usize) < i).count();
            Entry::Odd(odd)
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
    /// What is held is left out of the count where it is not `with_held`: of a class with items of its own it takes a
    /// hull.
    fn of<F: Fn(usize) -> f32, M: Menus>(
        profiles: &mut Profiles,
        crowd: &Crowd<'_, F, M>,
        with_held: bool,
    ) -> Self {
        let mut totals = Self::default();
        for (item, &count) in crowd.census.iter().enumerate().filter(|&(_, &count)| count > 0) {
            totals.add(profiles.item_ticks(item), u64::from(count));
        }
        for odd in crowd.odd {
            let class = Class::new(profiles, &odd.class);
            totals.add([0, class.held(), class.last()].map(|position| class.cost(position)), 1);
        }
        let own = crowd.own.ends();
        totals.cheapest = totals.cheapest.saturating_add(own.cheapest);
        totals.best = totals.best.saturating_add(own.best);
        totals.widest = totals.widest.max(own.widest);
        for menu in crowd.menus().take(if with_held { usize::MAX } else { 0 }) {
            totals.held = totals.held.saturating_add(menu.held_ticks(profiles));
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
    /// Of each class with items of its own, the item it goes to; [`LISTED`] where it is listed.
    picks: Vec<u16>,
    /// Those of them that hold another.
    turned: Vec<Turned>,
}

/// See [`Aside::picks`].
const LISTED: u16 = u16::MAX;

/// A class with items of its own that goes to another item than it holds.
#[derive(Clone, Copy, Debug)]
struct Turned {
    at: u32,
    /// Its number among those with items of their own.
    n: u32,
    /// The code of the item.
    code: u8,
}

/// A class that goes to a position whatever λ is.
#[derive(Clone, Copy, Debug)]
struct Decided {
    at: u32,
    class: SharedClass,
    position: u8,
    /// The code of the item at the position.
    code: u8,
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
        self.picks.clear();
        self.turned.clear();
    }

    fn mark(&mut self, i: usize) {
        self.marked[i / 64] |= 1 << (i % 64);
    }

    fn is_marked(&self, i: usize) -> bool {
        self.marked[i / 64] & (1 << (i % 64)) != 0
    }

    /// Everyone who holds an item, as if settled, but for what they are worth.
    fn begin<F: Fn(usize) -> f32, M: Menus>(&mut self, profiles: &Profiles, crowd: &Crowd<'_, F, M>) {
        self.clear();
        self.picks.resize(crowd.own.len(), LISTED);
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

    /// Sets a class aside that goes to its position for every λ of the bracket. `held` is the code of the item it
    /// holds.
    fn decide(&mut self, decided: Decided, class: &Class<'_>, held: Option<u8>, [low, high]: [f32; 2]) {
        let position = decided.position;
        self.add(class, position);
        // A held item that is no corner of its hull is not held on.
        if held != Some(decided.code) {
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

    /// Sets a class with items of its own aside that goes to one of them for every λ of the bracket.
    #[inline]
    fn settle<M: Menus>(&mut self, menus: &M, n: usize, menu: &Menu<'_, M>, pick: Pick) {
        let weight = menu.class.weight;
        self.benefit.value += self.benefit.of(weight, pick.value);
        self.benefit.least += self.benefit.of(weight, pick.least);
        self.cost = self.cost.saturating_add(pick.ticks);
        self.classes += 1;
        self.picks[n] = u16::from(pick.item);
        if menu.class.held != Some(pick.item) {
            let code = menus.code(n, pick.item);
            self.turned.push(Turned { at: menu.class.at, n: n as u32, code });
        }
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

/// Whether the next step of a class has a slope of at least `low`, below `above`, and fits.
fn is_opening(class: &Class<'_>, position: u8, [low, above]: [f32; 2], room: u64) -> bool {
    let slope = class.slope(position);
    slope >= low && slope < above && class.cost(position + 1) - class.cost(position) <= room
}

fn make_room<T>(list: &mut Vec<T>, len: usize) {
    list.reserve(len.saturating_sub(list.len()));
}

/// Brackets that are tried before the classes are listed one and all.
const TRIES: usize = 6;

/// How much farther a bracket reaches than the one that λ turned out to be beyond.
const REACH: f32 = 0.15;

/// A bracket is guessed from one before that is no more than so many widths away.
const FARTHEST: f64 = 8.0;

/// How far to look around the guess, as a share of the way to it, and of λ.
const DOUBT: [f64; 2] = [0.25, 0.01];

/// A sample is so large at least.
const SAMPLE: usize = 8192;

/// Where the budget may end, if costs go on beyond a bracket as they go inside; `None` where that is too far to tell.
fn next_bracket(survey: &Survey, [low, high]: [f32; 2], target: u64) -> Option<[f32; 2]> {
    let inside = survey.down_to.saturating_sub(survey.above) as f64;
    let width = f64::from(high) - f64::from(low);
    let (from, distance) = if survey.above > target {
        (f64::from(high), (survey.above - target) as f64 / inside)
    } else {
        (f64::from(low), -((target - survey.down_to) as f64 / inside))
    };
    let guess = from + distance * width;
    let doubt = DOUBT[0] * (distance * width).abs() + DOUBT[1] * guess;
    let bracket = [((guess - doubt) as f32).max(f32::MIN_POSITIVE), (guess + doubt) as f32];
    (distance.abs() <= FARTHEST && guess > doubt).then_some(bracket)
}

/// The bracket beyond another, where the budget does not end.
fn farther_bracket(survey: &Survey, [low, high]: [f32; 2], target: u64) -> [f32; 2] {
    if survey.above > target {
        [high, high * (1.0 + REACH)]
    } else {
        [(low * (1.0 - REACH)).max(f32::MIN_POSITIVE), low]
    }
}

impl SharedKnapsack {
    /// [`SharedKnapsack::solve`] of a crowd. Afterwards [`SharedKnapsack::changed`] lists the classes that were looked at
    /// closely; all others hold what they held. `key` is given places in the crowd.
    ///
    /// Time: O(items) and a pass over the columns where λ is near the last one, a few passes where it is not. Where one
    /// item takes a large part of the budget, or the gap is large, all classes are listed.
    pub fn solve_crowd<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        budget: u64,
        ease: u64,
        key: impl Fn(usize) -> u128,
    ) -> Outcome {
        let shared = self.profiles.len();
        self.shared = shared;
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
        let Aside { moved, picks, turned, .. } = &self.aside;
        let moved = moved.iter().filter(|m| !m.listed).map(|moved| (moved.at as usize, moved.code));
        let turned = turned.iter().filter(|t| picks[t.n as usize] != LISTED);
        let turned = turned.map(|turned| (turned.at as usize, turned.code));
        let listed = self.owners.iter().zip(&self.chosen).map(|(&owner, &item)| (owner as usize, item));
        moved.chain(turned).chain(listed)
    }

    /// Whether a class of the crowd was looked at closely, so that it is among [`SharedKnapsack::changed`]. One that
    /// has items of its own may hold what it held though it was.
    pub fn has_looked_at(&self, i: usize) -> bool {
        self.aside.is_marked(i)
    }

    /// The answer, with few classes listed; `None` where that is not enough to be sure of it.
    fn solve_aside<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        budget: u64,
        ease: u64,
        key: &impl Fn(usize) -> u128,
    ) -> Option<Outcome> {
        let totals = Totals::of(&mut self.profiles, crowd, ease < budget);
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
        let (survey, bracket) = self.bracket_crowd(crowd, target, totals.cheapest)?;
        let critical = self.greedy_aside(crowd, survey, target, bracket, key);
        self.bracket.follow(critical.lambda);
        let sums = self.sum_up(critical.lambda);
        let is_near = sums.outcome(target, &self.aside).priced_gap() <= super::RIVAL_GAP;
        is_near.then(|| Outcome { steps: critical.steps, ..sums.outcome(budget, &self.aside) })
    }

    /// Lists every class.
    fn list_all<F: Fn(usize) -> f32, M: Menus>(&mut self, crowd: &Crowd<'_, F, M>) {
        self.aside.clear();
        self.aside.marked.clear();
        self.aside.marked.resize(crowd.weight.len().div_ceil(64), u64::MAX);
        self.list_every(crowd, 1);
        self.owners.clear();
        self.owners.extend(0..crowd.weight.len() as u32);
    }

    /// Lists every so-manieth class.
    fn list_every<F: Fn(usize) -> f32, M: Menus>(&mut self, crowd: &Crowd<'_, F, M>, step: usize) {
        self.profiles.truncate(self.shared);
        self.classes.clear();
        let mut find = crowd.finder();
        for i in (0..crowd.weight.len()).step_by(step) {
            let class = crowd.class(&mut self.profiles, i, find(i));
            self.classes.push(class);
        }
    }

    /// A bracket that the budget ends in, and the survey of the classes that it leaves to be listed: around the last λ,
    /// or not far from there, or where a sample of the crowd says.
    fn bracket_crowd<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        target: u64,
        cheapest: u64,
    ) -> Option<(Survey, [f32; 2])> {
        let mut is_warm = self.bracket.lambda > 0.0;
        let room = target - cheapest;
        let mut bracket = if is_warm { self.warm_bracket() } else { self.sampled_bracket(crowd, room) };
        for _attempt in 0..TRIES {
            let survey = self.sift(crowd, bracket);
            if survey.above <= target && target < survey.down_to {
                return Some((survey, bracket));
            }
            let next = next_bracket(&survey, bracket, target);
            bracket = match next {
                Some(next) => next,
                None if is_warm => self.sampled_bracket(crowd, room),
                None => farther_bracket(&survey, bracket, target),
            };
            is_warm &= next.is_some();
            self.bracket.widen();
        }
        None
    }

    /// The bracket that a sample of the crowd suggests, for so much room beyond the cheapest choice.
    fn sampled_bracket<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        room: u64,
    ) -> [f32; 2] {
        self.list_every(crowd, (crowd.weight.len() / SAMPLE).max(1));
        let share = self.classes.len() as f64 / crowd.weight.len() as f64;
        let cheapest = |class| Class::new(&self.profiles, class).cost(0);
        let cheapest = self.classes.iter().map(cheapest).fold(0, u64::saturating_add);
        let [low, high] = self.cold_bracket(cheapest.saturating_add((room as f64 * share) as u64), None);
        [(low * 0.995).max(f32::MIN_POSITIVE), high * 1.005]
    }

    /// Makes room for as many classes to be looked at closely as there are, so that a frame with more of them than any
    /// before allocates nothing. None of it is touched until it is used.
    fn make_room(&mut self, classes: usize, own: &impl Menus) {
        let Self { aside, .. } = self;
        make_room(&mut aside.turned, own.len());
        make_room(&mut aside.picks, own.len());
        self.profiles.reserve(own.len(), own.len() * own.most_octets() * LANES);
        [&mut aside.moved, &mut aside.hovering].into_iter().for_each(|list| make_room(list, classes));
        [&mut self.opened, &mut self.owners].into_iter().for_each(|list| make_room(list, classes));
        [&mut self.choice, &mut self.chosen].into_iter().for_each(|list| make_room(list, classes));
        make_room(&mut self.classes, classes);
        make_room(&mut self.open, classes / 16 + 1);
        make_room(&mut self.blocked, classes);
        make_room(&mut self.undecided, classes);
    }

    /// Sets aside what is settled or decided for every λ of the bracket, lists the rest, and surveys it.
    fn sift<F: Fn(usize) -> f32, M: Menus>(&mut self, crowd: &Crowd<'_, F, M>, bracket: [f32; 2]) -> Survey {
        self.profiles.truncate(self.shared);
        self.make_room(crowd.weight.len(), &crowd.own);
        let Self { profiles, classes, owners, aside, open, .. } = self;
        classes.clear();
        owners.clear();
        aside.begin(profiles, crowd);
        let &Crowd { weight, heaviest, place, .. } = crowd;
        let columns = Columns { size: weight, weight, heaviest, place, holds: profiles.holds() };
        aside.benefit = sift(columns, bracket, crowd.threads, open);
        let open = std::mem::take(&mut self.open);
        let mut find = crowd.finder();
        for i in opened(&open) {
            match find(i) {
                Entry::Own(n) if self.pick(crowd, n, bracket) => {}
                entry => self.decide(crowd, i as u32, entry, bracket),
            }
        }
        self.open = open;
        self.survey(bracket, None)
    }

    /// Sets a class with items of its own aside if these decide it. Returns whether they do.
    fn pick<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        n: usize,
        bracket: [f32; 2],
    ) -> bool {
        let menu = crowd.menu(n);
        let pick = menu.pick(bracket);
        if let Some(pick) = pick {
            self.aside.settle(&crowd.own, n, &menu, pick);
        }
        pick.is_some()
    }

    /// Sets a class aside if its hull decides it, else lists it.
    fn decide<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        i: u32,
        entry: Entry,
        bracket: [f32; 2],
    ) {
        let [low, high] = bracket;
        let shared = crowd.class(&mut self.profiles, i as usize, entry);
        let class = Class::new(&self.profiles, &shared);
        let above = class.reach(class.held(), high);
        let held = crowd.holds_item(i as usize).then(|| self.profiles.code(crowd.place[i as usize]));
        if held.is_some() {
            self.aside.dismiss(&class);
        }
        if class.reach(above, low) == above {
            let code = class.positions[usize::from(above)].item;
            let decided = Decided { at: i, class: shared, position: above, code, listed: false };
            self.aside.decide(decided, &class, held, bracket);
        } else {
            self.classes.push(shared);
            self.owners.push(i);
            self.aside.mark(i as usize);
        }
    }

    /// The greedy of a crowd, the budget being inside the bracket.
    fn greedy_aside<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
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
    fn list_openings<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        ends: [f32; 2],
        room: u64,
    ) {
        self.list_held(crowd, ends, room);
        for at in 0..self.aside.moved.len() {
            let Decided { at: i, class: shared, position, listed, .. } = self.aside.moved[at];
            let class = Class::new(&self.profiles, &shared);
            if !listed && is_opening(&class, position, ends, room) {
                self.aside.moved[at].listed = true;
                self.list(i, shared, position);
            }
        }
        self.list_picked(crowd, ends, room);
    }

    /// Lists those of them that hold an item of a shared profile and stay there.
    fn list_held<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        ends: [f32; 2],
        room: u64,
    ) {
        let mut found = std::mem::take(&mut self.opened);
        found.clear();
        let holds = self.profiles.holds();
        let goes_on = |i: &usize| {
            let hold = holds.get(crowd.place[*i] as usize);
            hold.is_some_and(|hold| hold.may_go_on(crowd.weight[*i], ends[0])) && !self.aside.is_marked(*i)
        };
        found.extend((0..crowd.weight.len()).filter(goes_on).map(|i| i as u32));
        for &i in &found {
            let shared = crowd.holder(&self.profiles, i as usize);
            let class = Class::new(&self.profiles, &shared);
            let position = class.held();
            if is_opening(&class, position, ends, room) {
                self.list(i, shared, position);
            }
        }
        self.opened = found;
    }

    /// Lists those of them that have items of their own, each with a hull.
    fn list_picked<F: Fn(usize) -> f32, M: Menus>(
        &mut self,
        crowd: &Crowd<'_, F, M>,
        ends: [f32; 2],
        room: u64,
    ) {
        for n in 0..crowd.own.len() {
            let (menu, pick) = (crowd.menu(n), self.aside.picks[n]);
            if pick == LISTED || menu.rests_at(pick as u8, ends[0]) {
                continue;
            }
            let shared = menu.with_hull(&mut self.profiles);
            let position = self.profiles.position_of(shared.profile, crowd.own.code(n, pick as u8));
            if is_opening(&Class::new(&self.profiles, &shared), position, ends, room) {
                self.aside.picks[n] = LISTED;
                self.list(menu.class.at, shared, position);
            }
        }
    }

    /// Lists a class that was set aside at a position.
    fn list(&mut self, i: u32, class: SharedClass, position: u8) {
        self.aside.remove(&Class::new(&self.profiles, &class), position);
        let hovering = self.aside.hovering.binary_search_by_key(&i, |h| h.at);
        hovering.into_iter().for_each(|at| self.aside.hovering[at].listed = true);
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
