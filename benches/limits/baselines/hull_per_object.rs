//! Costs of which the slower of two stages counts, max(geometry, pixels), by a hull per object: a table's hull
//! does not hold there, so that each object's own is made in every frame. The steps inside the bracket around the
//! last λ are sorted and taken; where the budget does not end inside it, all are.

use super::classes::Totals;
use crate::scene::{Detail, MOST_STEPS, UNITS_PER_US};

/// Objects whose cost is the larger of their geometry's and their pixels'.
#[derive(Clone, Copy)]
pub struct TwoStages<'a> {
    pub tables: &'a [Vec<Detail>],
    pub table: &'a [u16],
    pub weight: &'a [f32],
    /// Cost of each object's pixels in ticks.
    pub pixel_ticks: &'a [u64],
}

/// Ticks per 1024th of a microsecond. Pixels do not cost whole ones: so fine, a million roundings are no nanosecond.
const TICKS_PER_UNIT: u64 = 1 << 20;
pub const TICKS_PER_US: f64 = UNITS_PER_US * TICKS_PER_UNIT as f64;

impl TwoStages<'_> {
    pub fn ticks(&self, object: usize, level: u8) -> u64 {
        let detail = self.levels(object)[usize::from(level)];
        (u64::from(detail.units()) * TICKS_PER_UNIT).max(self.pixel_ticks[object])
    }

    pub fn totals(&self, level: &[u8]) -> Totals {
        let mut totals = Totals::default();
        for (object, &level) in level.iter().enumerate() {
            let detail = self.levels(object)[usize::from(level)];
            totals.units += self.ticks(object, level);
            totals.benefit += f64::from(self.weight[object]) * f64::from(detail.accuracy);
        }
        totals
    }

    fn levels(&self, object: usize) -> &[Detail] {
        &self.tables[usize::from(self.table[object])]
    }
}

/// A vertex of an object's hull.
#[derive(Clone, Copy, Default)]
struct Vertex {
    ticks: u64,
    benefit: f64,
    level: u8,
}

/// A step inside the bracket.
#[derive(Clone, Copy)]
struct Step {
    slope: f64,
    object: u32,
    to: u8,
    ticks: u64,
}

#[derive(Default)]
pub struct HullPerObject {
    lambda: f64,
    inside: Vec<Step>,
}

/// Half the width of the bracket around the last λ.
const WIDTH: f64 = 0.01;

impl HullPerObject {
    /// Fills in the level of every object.
    pub fn choose(&mut self, objects: &TwoStages<'_>, budget: u64, level: &mut [u8]) {
        let bracket = [self.lambda * (1.0 - WIDTH), self.lambda * (1.0 + WIDTH)];
        if self.lambda == 0.0 || !self.within(bracket, objects, budget, level) {
            self.within([0.0, f64::INFINITY], objects, budget, level);
        }
    }

    /// Takes what is above the bracket, then the steps inside it in order. False when the budget ends elsewhere.
    fn within(&mut self, bracket: [f64; 2], objects: &TwoStages<'_>, budget: u64, level: &mut [u8]) -> bool {
        let spent = self.survey(bracket, objects, level);
        let Some(mut room) = budget.checked_sub(spent) else { return false };
        let order = |a: &Step, b: &Step| b.slope.total_cmp(&a.slope).then(a.object.cmp(&b.object));
        self.inside.sort_by(order);
        for step in &self.inside {
            if step.ticks > room {
                self.lambda = step.slope;
                return true;
            }
            room -= step.ticks;
            level[step.object as usize] = step.to;
        }
        bracket[0] == 0.0
    }

    /// One pass over all hulls; returns what the steps above the bracket and the cheapest levels cost.
    fn survey(&mut self, [low, high]: [f64; 2], objects: &TwoStages<'_>, level: &mut [u8]) -> u64 {
        self.inside.clear();
        let mut spent = 0;
        for (object, level) in level.iter_mut().enumerate() {
            let (hull, last) = hull(objects, object);
            let mut at = 0;
            while at < last && slope(&hull[at], &hull[at + 1]) >= high {
                at += 1;
            }
            spent += hull[at].ticks;
            *level = hull[at].level;
            while at < last && slope(&hull[at], &hull[at + 1]) >= low {
                let (from, to) = (hull[at], hull[at + 1]);
                let ticks = to.ticks - from.ticks;
                let slope = slope(&from, &to);
                self.inside.push(Step { slope, object: object as u32, to: to.level, ticks });
                at += 1;
            }
        }
        spent
    }
}

fn slope(from: &Vertex, to: &Vertex) -> f64 {
    (to.benefit - from.benefit) / (to.ticks - from.ticks) as f64
}

/// The upper hull of an object, cheapest first, and the index of its last vertex. Monotone chain, from the coarsest
/// level on; a level that costs what the one before costs replaces it.
fn hull(objects: &TwoStages<'_>, object: usize) -> ([Vertex; MOST_STEPS + 1], usize) {
    let mut chain = [Vertex::default(); MOST_STEPS + 1];
    let mut len = 0;
    for (level, detail) in objects.levels(object).iter().enumerate().rev() {
        let benefit = f64::from(objects.weight[object]) * f64::from(detail.accuracy);
        let next = Vertex { ticks: objects.ticks(object, level as u8), benefit, level: level as u8 };
        if len > 0 && chain[len - 1].ticks == next.ticks {
            len -= 1;
        }
        while len > 1 && slope(&chain[len - 2], &chain[len - 1]) <= slope(&chain[len - 1], &next) {
            len -= 1;
        }
        chain[len] = next;
        len += 1;
    }
    (chain, len - 1)
}
