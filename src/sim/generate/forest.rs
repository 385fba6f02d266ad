//! A forest around a clearing with a festival: four hundred metres square, a crowd of eight hundred.
//!
//! x points east, z south, y up; the origin is the middle of the clearing, on a low hill.

use glam::DVec3;

use super::angle::sin_cos_deg;
use super::dice::Dice;
use super::draft::{Draft, Stock};
use super::film::{Film, Key, key};
use super::{festival, outdoors};
use crate::files::CameraPath;

/// Half of a side of the forest.
const REACH: f64 = 200.0;
/// Radius of the clearing.
const CLEARING: f64 = 55.0;
const PEOPLE: usize = 800;
/// The stage stands at the north of the clearing.
const STAGE: [f64; 2] = [0.0, -32.0];
/// Half of the width of the path that the visitor comes by.
const LANE: f64 = 4.0;

pub(super) fn draft(seed: u64) -> Draft {
    let mut forest = Forest::new(seed);
    forest.lay_ground();
    forest.grow();
    forest.build_festival();
    forest.let_people_in();
    forest.draft
}

/// Height of the ground: a hill of 6 m in the middle, flat far away.
fn ground(x: f64, z: f64) -> f64 {
    let q = (x * x + z * z) / (120.0 * 120.0);
    6.0 / (1.0 + q * q)
}

/// What grows, and how often.
struct Growth {
    stock: Stock,
    count: usize,
    /// Smallest and largest size.
    scale: [f64; 2],
}

struct Stocks {
    ground: Stock,
    oak: Stock,
    log: Stock,
    people: [Stock; 3],
    singer: Stock,
    tent: Stock,
    lantern: Stock,
    stage: Stock,
    food: Stock,
    bench: Stock,
}

impl Stocks {
    fn new(draft: &mut Draft) -> Self {
        let people = [("dancer", "cotton", 6), ("guest in wool", "wool", 2), ("guest in linen", "linen", 0)];
        Self {
            ground: draft.stock(outdoors::ground()),
            oak: draft.stock(outdoors::old_oak()),
            log: draft.stock(outdoors::log()),
            people: people.map(|(name, dress, folds)| draft.stock(festival::person(name, dress, folds))),
            singer: draft.stock(festival::singer()),
            tent: draft.stock(festival::tent()),
            lantern: draft.stock(festival::lantern()),
            stage: draft.stock(festival::stage()),
            food: draft.stock(festival::food_stall()),
            bench: draft.stock(festival::bench()),
        }
    }
}

struct Forest {
    draft: Draft,
    stocks: Stocks,
    dice: Dice,
}

impl Forest {
    fn new(seed: u64) -> Self {
        let mut draft = Draft::new("forest", include_str!("../../../scenes/tables/forest.json"));
        let stocks = Stocks::new(&mut draft);
        Self { draft, stocks, dice: Dice::new(seed, 3) }
    }

    fn lay_ground(&mut self) {
        for patch in 0..64 {
            let [column, row] = [patch % 8, patch / 8].map(|i| f64::from(i) * 50.0 - REACH + 25.0);
            self.put(self.stocks.ground, [column, row], 1.0);
        }
    }

    fn grow(&mut self) {
        let growths = [
            (outdoors::beech(), 700, [0.5, 1.3]),
            (outdoors::spruce(), 800, [0.4, 1.2]),
            (outdoors::birch(), 350, [0.6, 1.2]),
            (outdoors::shrub(), 550, [0.5, 1.6]),
            (outdoors::fern(), 500, [0.6, 1.5]),
            (outdoors::rock(), 260, [0.2, 1.6]),
        ];
        for (kind, count, scale) in growths {
            let stock = self.draft.stock(kind);
            self.spread(&Growth { stock, count, scale });
        }
        self.spread(&Growth { stock: self.stocks.log, count: 90, scale: [0.6, 1.3] });
        for at in [[-62.0, 6.0], [61.0, 12.0], [-30.0, 60.0], [45.0, -48.0], [110.0, -90.0], [-140.0, 6.0]] {
            self.put(self.stocks.oak, at, 1.0);
        }
    }

    /// Sows in the forest, but neither in the clearing nor on the lane.
    fn spread(&mut self, growth: &Growth) {
        let mut left = growth.count;
        while left > 0 {
            let [x, z] = [self.dice.between(-REACH, REACH), self.dice.between(-REACH, REACH)];
            let clear = x * x + z * z < CLEARING * CLEARING || (x < 0.0 && z.abs() < LANE);
            if !clear {
                let scale = self.dice.between(growth.scale[0], growth.scale[1]);
                self.put(growth.stock, [x, z], scale);
                left -= 1;
            }
        }
    }

    fn build_festival(&mut self) {
        self.put(self.stocks.stage, STAGE, 1.0);
        self.ring(self.stocks.tent, 30, [46.0, 53.0]);
        self.ring(self.stocks.lantern, 60, [40.0, 44.0]);
        self.ring(self.stocks.food, 16, [33.0, 38.0]);
        self.ring(self.stocks.bench, 50, [26.0, 40.0]);
        let singer = DVec3::new(STAGE[0], ground(STAGE[0], STAGE[1]) + 1.4, STAGE[1] + 4.0);
        self.draft.put(self.stocks.singer, singer);
    }

    /// So many around the clearing, between two radii; none in the way of the lane from the west or the stage.
    fn ring(&mut self, stock: Stock, count: usize, [inner, outer]: [f64; 2]) {
        for i in 0..count {
            let turn = 300.0 * (i as f64 + 0.5) / count as f64 - 60.0 + self.dice.between(-2.0, 2.0);
            let radius = self.dice.between(inner, outer);
            let (sin, cos) = sin_cos_deg(turn);
            let at = [radius * cos, radius * sin];
            if at[0] > -outer + 10.0 || at[1].abs() > LANE + 2.0 {
                self.put(stock, at, 1.0);
            }
        }
    }

    /// Dense before the stage, thinner behind; one in ten strolls about.
    fn let_people_in(&mut self) {
        for _ in 0..PEOPLE {
            let at = if self.dice.chance(0.1) {
                [self.dice.between(-38.0, 38.0), self.dice.between(-15.0, 38.0)]
            } else {
                let depth = self.dice.unit() * self.dice.unit();
                let half_width = 9.0 + 14.0 * depth;
                [self.dice.between(-half_width, half_width), -24.0 + 36.0 * depth]
            };
            let person = self.dice.pick(&self.stocks.people);
            let scale = self.dice.between(0.85, 1.08);
            self.put(person, at, scale);
        }
    }

    fn put(&mut self, stock: Stock, [x, z]: [f64; 2], scale: f64) {
        self.draft.put_scaled(stock, DVec3::new(x, ground(x, z), z), scale);
    }
}

/// Up the lane and into the crowd.
const WALK: &[Key] = &[
    // At the forest's western edge, looking back over the fields.
    key(0.0, [-196.0, 1.9, 0.0], 330.0, 0.0),
    key(3.0, [-196.0, 1.9, 0.0], 330.0, 0.0),
    key(6.0, [-192.0, 1.9, 0.5], 400.0, 8.0),
    key(10.0, [-180.0, 2.3, -0.5], 450.0, 4.0),
    // The old oak by the lane.
    key(19.0, [-148.0, 3.5, 1.0], 465.0, 20.0),
    key(22.0, [-143.0, 3.7, 1.0], 520.0, 25.0),
    key(26.0, [-130.0, 4.2, 0.0], 450.0, 0.0),
    key(36.0, [-85.0, 6.5, 0.0], 455.0, 0.0),
    // Out of the trees: the festival.
    key(43.0, [-55.0, 7.5, 0.0], 435.0, 0.0),
    key(48.0, [-30.0, 7.7, -4.0], 440.0, -3.0),
    key(54.0, [-10.0, 7.7, -10.0], 410.0, 2.0),
    key(57.0, [-5.0, 7.7, -16.0], 380.0, 4.0),
    key(60.0, [-5.0, 7.7, -16.0], 380.0, 4.0),
];

/// On the stage, before the singer's face.
const CLOSE_UP: &[Key] = &[
    key(60.0, [2.4, 9.0, -26.0], 310.0, -2.0),
    key(63.0, [1.0, 9.0, -26.9], 318.0, -2.0),
    key(66.0, [0.6, 9.0, -27.2], 320.0, -2.0),
    key(71.0, [0.6, 9.0, -27.2], 320.0, -2.0),
    // Turn to the crowd: everybody at once.
    key(73.0, [0.6, 9.0, -27.0], 180.0, -6.0),
    key(77.0, [0.0, 9.4, -26.0], 170.0, -8.0),
    key(81.0, [0.0, 13.0, -30.0], 180.0, -12.0),
];

pub(super) fn path(seed: u64) -> CameraPath {
    Film { name: "forest", hz: 20, sway_deg: 1.2, shots: &[WALK, CLOSE_UP] }.shoot(seed)
}
