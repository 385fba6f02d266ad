//! Hulls that many classes share.
//!
//! Where every item of a class is worth `weight · value` and costs `scale · ticks`, with values and ticks from a small
//! set of *profiles*, the hull of the class is the hull of its profile whatever weight and scale are. It is made once.

use super::SharedClass;
use super::class::scaled;
use super::sift::Hold;
use crate::knapsack::{Item, upper_hull};

/// One vertex of a profile's hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Value gained per tick by the step to the next position; 0 at the last one. Falls along the hull.
    pub next_slope: f32,
    /// Value at this position, for a class of weight 1.
    pub value: f32,
    /// Cost at this position, for a class of scale 1.
    pub ticks: u64,
    /// The value in fixed point, with [`FRACTION_BITS`] binary digits after the point.
    pub(super) worth: u64,
    /// The caller's code of the item.
    pub item: u8,
}

/// Binary digits after the point of weights and values in exact sums.
pub(super) const FRACTION_BITS: u32 = 32;

/// One item that a profile is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileItem {
    /// Value for a class of weight 1, from 0 to 1.
    pub value: f32,
    /// Cost for a class of scale 1.
    pub ticks: u64,
    /// The caller's code for it.
    pub item: u8,
}

/// What a class costs and is worth with one of its items.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offer {
    /// Cost, the scale included.
    pub ticks: u64,
    /// Benefit, the weight included.
    pub benefit: f64,
}

/// A set of profiles, by number.
#[derive(Clone, Debug, Default)]
pub struct Profiles {
    spans: Vec<Span>,
    positions: Vec<Position>,
    items: Vec<ProfileItem>,
    /// Per item, its profile, the costliest position that costs no more than it, and when a class holds it.
    owner: Vec<u32>,
    held: Vec<u8>,
    holds: Vec<Hold>,
    points: Vec<Item>,
    hull: Vec<u32>,
}

/// Where a profile lies in each of the columns.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    positions: (u32, u32),
    items: (u32, u32),
}

impl Profiles {
    /// Forgets all profiles from number `keep` on, and keeps the memory.
    pub fn truncate(&mut self, keep: usize) {
        self.spans.truncate(keep);
        let end = self.spans.last().copied().unwrap_or_default();
        self.positions.truncate(end.positions.1 as usize);
        self.items.truncate(end.items.1 as usize);
        self.owner.truncate(end.items.1 as usize);
        self.held.truncate(end.items.1 as usize);
        self.holds.truncate(end.items.1 as usize);
        self.holds.push(Hold::OPEN);
    }

    /// Makes room for so many more profiles, and items of all of them. None of it is touched until it is used.
    pub(super) fn reserve(&mut self, profiles: usize, items: usize) {
        self.spans.reserve(profiles);
        self.positions.reserve(items);
        self.items.reserve(items);
        self.owner.reserve(items);
        self.held.reserve(items);
        self.holds.reserve(items);
    }

    /// How many profiles there are.
    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// Adds the profile of these items, of which there must be one at least, and returns its number.
    pub fn push(&mut self, items: &[ProfileItem]) -> u32 {
        self.push_all(items.iter().copied())
    }

    /// [`Profiles::push`] of items that are not in a slice.
    pub(super) fn push_all(&mut self, items: impl Iterator<Item = ProfileItem>) -> u32 {
        let first = (self.positions.len(), self.items.len());
        self.items.extend(items);
        let items = &self.items[first.1..];
        let point = |i: &ProfileItem| Item { cost: i.ticks as f64, benefit: f64::from(i.value) };
        self.points.clear();
        self.points.extend(items.iter().map(point));
        upper_hull(&self.points, &mut self.hull);
        for (at, &i) in self.hull.iter().enumerate() {
            let next = self.hull.get(at + 1).map(|&n| items[n as usize]);
            self.positions.push(position(items[i as usize], next));
        }
        let positions = &self.positions[first.0..];
        self.owner.resize(self.owner.len() + items.len(), self.spans.len() as u32);
        self.held.extend(items.iter().map(|item| position_at(positions, item.ticks)));
        self.holds.pop();
        self.holds.extend(items.iter().map(|item| hold(positions, item)));
        self.holds.push(Hold::OPEN);
        self.spans.push(Span {
            positions: (first.0 as u32, self.positions.len() as u32),
            items: (first.1 as u32, self.items.len() as u32),
        });
        (self.spans.len() - 1) as u32
    }

    /// The hull of a profile, cheapest position first; never empty.
    pub fn positions(&self, profile: u32) -> &[Position] {
        let (start, end) = self.spans[profile as usize].positions;
        &self.positions[start as usize..end as usize]
    }

    /// When a class of scale 1 holds an item, for the items of all profiles in the order in which they were pushed, and
    /// an open one at the end.
    pub(super) fn holds(&self) -> &[Hold] {
        &self.holds
    }

    /// What a class of scale 1 costs at its cheapest position, at the one that it has with the item of this number, and
    /// at its best.
    pub(super) fn item_ticks(&self, item: usize) -> [u64; 3] {
        let positions = self.positions(self.owner[item]);
        [
            positions[0].ticks,
            positions[usize::from(self.held[item])].ticks,
            positions[positions.len() - 1].ticks,
        ]
    }

    /// The caller's code of the item of this number.
    pub(super) fn code(&self, item: u32) -> u8 {
        self.items[item as usize].item
    }

    /// A class of scale 1 that holds the item of this number, among those of all profiles.
    pub fn class_at(&self, item: u32, weight: f32, stay: f32) -> SharedClass {
        let at = item as usize;
        SharedClass { profile: self.owner[at], weight, scale: 1.0, stay, current: self.held[at] }
    }

    /// The items that a profile was made of, in the order they were given.
    pub fn items(&self, profile: u32) -> &[ProfileItem] {
        let (start, end) = self.spans[profile as usize].items;
        &self.items[start as usize..end as usize]
    }

    /// What a class costs and is worth with `item`; `None` when its profile was not made of it. O(1) where items were
    /// given in the order of their codes without gaps.
    pub fn offer(&self, class: &SharedClass, item: u8) -> Option<Offer> {
        let found = self.items(class.profile)[self.item_at(class.profile, item)?];
        let benefit = f64::from(class.weight) * f64::from(found.value);
        Some(Offer { ticks: scaled(found.ticks, class.scale), benefit })
    }

    /// What a class of scale 1 costs and is worth with the item of this number, among those of all profiles.
    pub fn offer_at(&self, item: u32, weight: f32) -> Offer {
        let ProfileItem { value, ticks, .. } = self.items[item as usize];
        Offer { ticks, benefit: f64::from(weight) * f64::from(value) }
    }

    /// The position that holds `item`, or else the costliest one that costs no more than it; the cheapest for an item
    /// that the profile was not made of. O(1) where items were given in the order of their codes without gaps.
    pub fn position_of(&self, profile: u32, item: u8) -> u8 {
        self.item_at(profile, item)
            .map_or(0, |at| self.held[self.spans[profile as usize].items.0 as usize + at])
    }

    /// Where an item is among those of a profile.
    fn item_at(&self, profile: u32, item: u8) -> Option<usize> {
        let items = self.items(profile);
        let is_it = |i: &ProfileItem| i.item == item;
        let guess = usize::from(item.wrapping_sub(items.first().map_or(0, |i| i.item)));
        if items.get(guess).is_some_and(is_it) { Some(guess) } else { items.iter().position(is_it) }
    }
}

/// The costliest position of at most so many ticks, or the cheapest.
pub(super) fn position_at(positions: &[Position], ticks: u64) -> u8 {
    positions.partition_point(|p| p.ticks <= ticks).saturating_sub(1) as u8
}

/// When an item is held; never where another is at least as good.
fn hold(positions: &[Position], item: &ProfileItem) -> Hold {
    let at = usize::from(position_at(positions, item.ticks));
    let here = positions[at];
    if here.item != item.item {
        return Hold::OPEN;
    }
    let into = at.checked_sub(1).map(|before| positions[before].next_slope);
    let out = (at + 1 < positions.len()).then_some(here.next_slope);
    Hold::new(into, out, here.value, positions[0].value)
}

fn position(item: ProfileItem, next: Option<ProfileItem>) -> Position {
    let slope = |n: ProfileItem| (f64::from(n.value) - f64::from(item.value)) / (n.ticks - item.ticks) as f64;
    Position {
        worth: (f64::from(item.value) * (1u64 << FRACTION_BITS) as f64) as u64,
        next_slope: next.map_or(0.0, |n| slope(n) as f32),
        value: item.value,
        ticks: item.ticks,
        item: item.item,
    }
}
