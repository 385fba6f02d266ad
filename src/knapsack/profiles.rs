//! Hulls that many classes share.
//!
//! Where every item of a class is worth `weight · value` and costs `scale · ticks`, with values and ticks from a small
//! set of *profiles*, the hull of the class is the hull of its profile whatever weight and scale are. It is made once.

use super::hull::upper_hull;
use super::instance::Item;

/// One vertex of a profile's hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    /// Value gained per tick by the step to the next position; 0 at the last one. Falls along the hull.
    pub next_slope: f32,
    /// Value at this position, for a class of weight 1.
    pub value: f32,
    /// Cost at this position, for a class of scale 1.
    pub ticks: u64,
    /// The caller's code of the item.
    pub item: u8,
}

/// One item that a profile is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileItem {
    /// Value for a class of weight 1, ≥ 0.
    pub value: f32,
    /// Cost for a class of scale 1.
    pub ticks: u64,
    /// The caller's code for it.
    pub item: u8,
}

/// A set of profiles, by number.
#[derive(Clone, Debug, Default)]
pub struct Profiles {
    ends: Vec<Ends>,
    positions: Vec<Position>,
    items: Vec<ProfileItem>,
    /// Per item, the costliest position that costs no more than it.
    held: Vec<u8>,
    points: Vec<Item>,
    hull: Vec<u32>,
}

/// Where a profile ends in each of the columns; it starts where the one before ends.
#[derive(Clone, Copy, Debug, Default)]
struct Ends {
    positions: usize,
    items: usize,
}

impl Profiles {
    /// Forgets all profiles from number `keep` on, and keeps the memory.
    pub fn truncate(&mut self, keep: usize) {
        self.ends.truncate(keep);
        let Ends { positions, items } = self.ends.last().copied().unwrap_or_default();
        self.positions.truncate(positions);
        self.items.truncate(items);
        self.held.truncate(items);
    }

    /// How many profiles there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Adds the profile of these items, of which there must be one at least, and returns its number.
    pub fn push(&mut self, items: &[ProfileItem]) -> u32 {
        let point = |i: &ProfileItem| Item { cost: i.ticks as f64, benefit: f64::from(i.value) };
        self.points.clear();
        self.points.extend(items.iter().map(point));
        upper_hull(&self.points, &mut self.hull);
        for (at, &i) in self.hull.iter().enumerate() {
            let next = self.hull.get(at + 1).map(|&n| items[n as usize]);
            self.positions.push(position(items[i as usize], next));
        }
        let start = self.ends.last().copied().unwrap_or_default().positions;
        let positions = &self.positions[start..];
        self.held.extend(items.iter().map(|item| position_at(positions, item.ticks)));
        self.items.extend_from_slice(items);
        self.ends.push(Ends { positions: self.positions.len(), items: self.items.len() });
        (self.ends.len() - 1) as u32
    }

    /// The hull of a profile, cheapest position first; never empty.
    pub fn positions(&self, profile: u32) -> &[Position] {
        &self.positions[self.start(profile).positions..self.ends[profile as usize].positions]
    }

    /// The items that a profile was made of, in the order they were given.
    pub fn items(&self, profile: u32) -> &[ProfileItem] {
        &self.items[self.start(profile).items..self.ends[profile as usize].items]
    }

    /// The position that holds `item`, or else the costliest one that costs no more than it; the cheapest for an item
    /// that the profile was not made of. O(1) where items were given in the order of their codes without gaps.
    pub fn position_of(&self, profile: u32, item: u8) -> u8 {
        let items = self.items(profile);
        let is_it = |i: &ProfileItem| i.item == item;
        let guess = usize::from(item.wrapping_sub(items.first().map_or(0, |i| i.item)));
        let at = if items.get(guess).is_some_and(is_it) { Some(guess) } else { items.iter().position(is_it) };
        at.map_or(0, |at| self.held[self.start(profile).items + at])
    }

    fn start(&self, profile: u32) -> Ends {
        (profile as usize).checked_sub(1).map_or(Ends::default(), |before| self.ends[before])
    }
}

/// The costliest position of at most so many ticks, or the cheapest.
pub(super) fn position_at(positions: &[Position], ticks: u64) -> u8 {
    positions.partition_point(|p| p.ticks <= ticks).saturating_sub(1) as u8
}

fn position(item: ProfileItem, next: Option<ProfileItem>) -> Position {
    let slope = |n: ProfileItem| (f64::from(n.value) - f64::from(item.value)) / (n.ticks - item.ticks) as f64;
    Position {
        next_slope: next.map_or(0.0, |n| slope(n) as f32),
        value: item.value,
        ticks: item.ticks,
        item: item.item,
    }
}
