//! Classes with items of their own: decided from those, at both ends of a bracket, without a hull.
//!
//! Where an item is the one best of its class at both ends of a bracket of λ it is that of every λ between, and so a
//! vertex of the hull that need not be made. Items are looked at eight side by side, in loops without branches.

use super::SharedClass;
use super::certificate::NEAR;
use super::profiles::{Offer, ProfileItem, Profiles};

/// Items that are looked at together.
pub(super) const LANES: usize = 8;

/// Eight items of a class, side by side. Any that are none are [`Octet::NOTHING`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Octet {
    /// Values for a class of weight 1, from 0 to 1, of no more than single precision.
    pub value: [f64; LANES],
    /// Costs in whole ticks, at most 2⁶².
    pub ticks: [f64; LANES],
}

impl Octet {
    /// Value and ticks of no item: worse than any item at any λ.
    pub const NOTHING: [f64; 2] = [-1.0, (1u64 << 62) as f64];
}

/// A class with items of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnClass {
    /// Which one of the crowd it is.
    pub at: u32,
    /// Factor on the values, finite and ≥ 0.
    pub weight: f32,
    /// Price of switching, in 0…1 (exclusive).
    pub stay: f32,
    /// The number of the item that the class holds.
    pub held: Option<u8>,
}

/// What classes add up to, in ticks, whatever is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ends {
    /// With the cheapest item of each.
    pub cheapest: u64,
    /// With the cheapest of the best items of each.
    pub best: u64,
    /// The most that the one of a class is dearer than the other.
    pub widest: u64,
}

impl Ends {
    /// Adds a class by what its cheapest item and the cheapest of its best ones cost.
    pub fn add(&mut self, cheapest: u64, best: u64) {
        self.cheapest = self.cheapest.saturating_add(cheapest);
        self.best = self.best.saturating_add(best);
        self.widest = self.widest.max(best - cheapest);
    }
}

/// The classes of a crowd with items of their own, in ascending order. Items of a class are numbered from 0.
pub trait Menus {
    /// How many classes there are.
    fn len(&self) -> usize;

    /// Whether there is none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What all of them add up to.
    fn ends(&self) -> Ends;

    /// The class of number `n`.
    fn class(&self, n: usize) -> OwnClass;

    /// How many octets its items fill; at most 32.
    fn octets(&self, n: usize) -> usize;

    /// How many octets the items of any class fill at most.
    fn most_octets(&self) -> usize;

    /// Its items from `8 · octet` on. There must be one at least in all octets.
    fn octet(&self, n: usize, octet: usize) -> Octet;

    /// The caller's code of an item.
    fn code(&self, n: usize, item: u8) -> u8;
}

/// No class has items of its own.
impl Menus for () {
    fn len(&self) -> usize {
        0
    }

    fn ends(&self) -> Ends {
        Ends::default()
    }

    fn class(&self, _: usize) -> OwnClass {
        OwnClass { at: u32::MAX, weight: 0.0, stay: 0.0, held: None }
    }

    fn octets(&self, _: usize) -> usize {
        0
    }

    fn most_octets(&self) -> usize {
        0
    }

    fn octet(&self, _: usize, _: usize) -> Octet {
        let [value, ticks] = Octet::NOTHING.map(|nothing| [nothing; LANES]);
        Octet { value, ticks }
    }

    fn code(&self, _: usize, item: u8) -> u8 {
        item
    }
}

/// A class with what it may choose from.
pub(super) struct Menu<'a, M> {
    menus: &'a M,
    n: usize,
    pub class: OwnClass,
    /// The first octet, which nearly always is all.
    first: Octet,
}

/// The item that a class goes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pick {
    pub item: u8,
    pub value: f32,
    pub ticks: u64,
    /// Value of the cheapest item.
    pub least: f32,
}

impl<'a, M: Menus> Menu<'a, M> {
    pub fn new(menus: &'a M, n: usize) -> Self {
        Self { menus, n, class: menus.class(n), first: menus.octet(n, 0) }
    }

    /// Folds all octets.
    #[inline]
    fn fold<T>(&self, start: T, mut step: impl FnMut(T, &Octet) -> T) -> T {
        let start = step(start, &self.first);
        let others = 1..self.menus.octets(self.n);
        others.fold(start, |folded, octet| step(folded, &self.menus.octet(self.n, octet)))
    }

    /// Value and ticks of an item.
    fn get(&self, item: u8) -> [f64; 2] {
        let (octet, lane) = (usize::from(item) / LANES, usize::from(item) % LANES);
        let Octet { value, ticks } = if octet == 0 { self.first } else { self.menus.octet(self.n, octet) };
        [value[lane], ticks[lane]]
    }

    /// What the class costs and is worth with the item of a code; `None` when it has no such item.
    pub fn offer(&self, code: u8) -> Option<Offer> {
        let item = self.items().find(|item| item.item == code)?;
        Some(Offer { ticks: item.ticks, benefit: f64::from(self.class.weight) * f64::from(item.value) })
    }

    /// All items, under the caller's codes.
    fn items(&self) -> impl Iterator<Item = ProfileItem> {
        let lanes = 0..self.menus.octets(self.n) * LANES;
        let items = lanes.map(|item| (item as u8, self.get(item as u8)));
        items.filter(|(_, [value, _])| *value >= 0.0).map(|(item, [value, ticks])| ProfileItem {
            value: value as f32,
            ticks: whole(ticks),
            item: self.menus.code(self.n, item),
        })
    }

    /// The class with a hull of its own.
    pub fn with_hull(&self, profiles: &mut Profiles) -> SharedClass {
        let profile = profiles.push_all(self.items());
        let held = self.class.held.map(|held| self.menus.code(self.n, held));
        let current = held.map_or(0, |held| profiles.position_of(profile, held));
        SharedClass { profile, weight: self.class.weight, scale: 1.0, stay: self.class.stay, current }
    }

    /// Ticks of where the class is on its hull. The hull is made for it.
    pub fn held_ticks(&self, profiles: &mut Profiles) -> u64 {
        let keep = profiles.len();
        let class = self.with_hull(profiles);
        let ticks = profiles.positions(class.profile)[usize::from(class.current)].ticks;
        profiles.truncate(keep);
        ticks
    }

    /// Ticks of the cheapest item.
    fn cheapest(&self) -> f64 {
        self.fold(f64::INFINITY, |cheapest, octet| f64::min(cheapest, least(octet.ticks)))
    }

    /// The item that is the best one for every λ of the bracket, with and without the price of switching; `None` where
    /// none is, or slopes are so near to the bracket's ends that their rounding could tell.
    ///
    /// Looked for at what is held first, which from frame to frame is nearly always the answer.
    #[inline]
    pub fn pick(&self, bracket: [f32; 2]) -> Option<Pick> {
        let ends = self.opened(bracket);
        let is_best = |item: &u8| self.is_best(*item, ends);
        let item = self.class.held.filter(is_best).or_else(|| Some(self.best(ends[0])).filter(is_best))?;
        let [value, ticks] = self.get(item);
        Some(Pick { item, value: value as f32, ticks: whole(ticks), least: self.least_value() })
    }

    /// Whether no step from an item that was picked has a slope of `low` or more, however slopes are rounded.
    pub fn rests_at(&self, item: u8, low: f32) -> bool {
        let [low, _] = self.opened([low; 2]);
        self.is_best(item, [low, 0.0])
    }

    /// The ends of a bracket, moved outwards by more than rounding and the price of switching can move slopes.
    fn opened(&self, [low, high]: [f32; 2]) -> [f64; 2] {
        let (near, stay) = (2.0 * f64::from(NEAR), f64::from(self.class.stay));
        let [low, high] = [f64::from(low) * (1.0 - near), f64::from(high) * (1.0 + near)];
        if stay == 0.0 { [low, high] } else { [low / (1.0 + stay), high / (1.0 - stay)] }
    }

    /// Whether an item is better than each other one: than those that cost more at the lower end, than those that cost
    /// less at the upper end. Of equal ones the first is the best.
    #[inline]
    fn is_best(&self, item: u8, ends: [f64; 2]) -> bool {
        let (found, weight) = (self.get(item), self.weight());
        let (_, is_best) = self.fold((f64::from(item), true), |(lane, is_best), octet| {
            (lane - LANES as f64, is_best & is_best_of(octet, found, lane, weight, ends))
        });
        is_best
    }

    /// The item of the greatest benefit − λ · cost, but for rounding.
    fn best(&self, lambda: f64) -> u8 {
        let weight = self.weight();
        let (_, best, _) = self.fold((0, 0, f64::NEG_INFINITY), |(first, mut best, mut most), octet| {
            for lane in 0..LANES {
                let surplus = weight * octet.value[lane] - lambda * octet.ticks[lane];
                (best, most) = if surplus > most { (first + lane, surplus) } else { (best, most) };
            }
            (first + LANES, best, most)
        });
        best as u8
    }

    /// The class's weight, a little above 0: so classes without weight compare values where costs are equal.
    fn weight(&self) -> f64 {
        f64::from(self.class.weight).max(f64::MIN_POSITIVE)
    }

    /// The greatest value of the cheapest items.
    fn least_value(&self) -> f32 {
        let cheapest = self.cheapest();
        self.fold(0.0, |value, octet| f64::max(value, value_of(octet, cheapest))) as f32
    }
}

/// Whether an item, whose `lane` it is counted from the octet's first, is better than the others in the octet, or the
/// first of equal ones.
#[inline]
fn is_best_of(
    octet: &Octet,
    [value, ticks]: [f64; 2],
    lane: f64,
    weight: f64,
    [low, high]: [f64; 2],
) -> bool {
    let mut not_worse = [0u64; LANES];
    for at in 0..LANES {
        let (gain, cost) = (octet.value[at] - value, octet.ticks[at] - ticks);
        let price = cost * if cost > 0.0 { low } else { high };
        let is_same = (gain == 0.0) & (cost == 0.0) & (LANE[at] >= lane);
        not_worse[at] = u64::from(!((weight * gain < price) | is_same));
    }
    not_worse.iter().fold(0, |any, &one| any | one) == 0
}

/// The numbers of lanes.
const LANE: [f64; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The greatest value of the items of so many ticks; 0 without one.
fn value_of(octet: &Octet, ticks: f64) -> f64 {
    let mut value = octet.value;
    for (value, &its_ticks) in value.iter_mut().zip(&octet.ticks) {
        *value = if its_ticks == ticks { -*value } else { 0.0 };
    }
    -least(value)
}

/// The least number. By halves, so that it is vector code.
fn least(mut lanes: [f64; LANES]) -> f64 {
    for half in [4, 2, 1] {
        for lane in 0..half {
            let (a, b) = (lanes[lane], lanes[lane + half]);
            lanes[lane] = if b < a { b } else { a };
        }
    }
    lanes[0]
}

/// A number of ticks.
fn whole(ticks: f64) -> u64 {
    ticks as i64 as u64
}
