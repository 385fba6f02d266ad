//! A city of ten by ten blocks over one and a half kilometres.
//!
//! Blocks of 120 m on a pitch of 150 m; streets run along the edges of the pitch. x points east, z south, y up, the
//! origin is the north-west corner of the ground.

use glam::DVec3;

use super::dice::Dice;
use super::draft::{Draft, Stock};
use super::film::{Film, Key, key};
use super::{street, urban};
use crate::files::CameraPath;

/// One letter per block: `h` houses with gardens, `s` shops, `a` apartments, `T` towers, `p` park, `q` market square.
const DISTRICTS: [&str; 10] = [
    "hhhhhhphhh",
    "hhhasshhhh",
    "hhaassaahh",
    "hpassTTsah",
    "hasTTTTsah",
    "hasTTqTTsh",
    "hhasTTTsap",
    "hhaassTaah",
    "hhhhasshhh",
    "hhhphhhhhh",
];

const PITCH: f64 = 150.0;
const STREET: f64 = 30.0;

pub(super) fn draft(seed: u64) -> Draft {
    let mut town = Town::new(seed);
    for (row, district) in DISTRICTS.iter().enumerate() {
        for (column, use_) in district.bytes().enumerate() {
            let corner = DVec3::new(PITCH * column as f64, 0.0, PITCH * row as f64);
            town.streets(corner);
            town.block(use_, corner + DVec3::new(STREET, 0.0, STREET));
        }
    }
    town.draft
}

/// What a city is made of.
struct Stocks {
    road: Stock,
    glass_tower: Stock,
    stone_tower: Stock,
    apartments: Stock,
    shops: Stock,
    house: Stock,
    cars: [Stock; 4],
    bus: Stock,
    lamp: Stock,
    traffic_light: Stock,
    bench: Stock,
    bin: Stock,
    stall: Stock,
    fountain: Stock,
    tree: Stock,
}

impl Stocks {
    fn new(draft: &mut Draft) -> Self {
        let [small_car, saloon, van] =
            [street::small_car(), street::saloon(), street::van()].map(|kind| draft.stock(kind));
        Self {
            road: draft.stock(urban::road()),
            glass_tower: draft.stock(urban::glass_tower()),
            stone_tower: draft.stock(urban::stone_tower()),
            apartments: draft.stock(urban::apartment_block()),
            shops: draft.stock(urban::shop_row()),
            house: draft.stock(urban::house()),
            cars: [small_car, small_car, saloon, van],
            bus: draft.stock(street::bus()),
            lamp: draft.stock(street::street_lamp()),
            traffic_light: draft.stock(street::traffic_light()),
            bench: draft.stock(street::bench()),
            bin: draft.stock(street::bin()),
            stall: draft.stock(street::market_stall()),
            fountain: draft.stock(street::fountain()),
            tree: draft.stock(street::street_tree()),
        }
    }
}

struct Town {
    draft: Draft,
    stocks: Stocks,
    dice: Dice,
}

impl Town {
    fn new(seed: u64) -> Self {
        let mut draft = Draft::new("city", include_str!("../../../scenes/tables/city.json"));
        let stocks = Stocks::new(&mut draft);
        Self { draft, stocks, dice: Dice::new(seed, 2) }
    }

    /// The street along the north edge of a block and the one along its west edge.
    fn streets(&mut self, corner: DVec3) {
        let crossing = corner + DVec3::new(STREET / 2.0, 0.0, STREET / 2.0);
        for along in [DVec3::X, DVec3::Z] {
            let across = DVec3::new(along.z, 0.0, along.x);
            for half in [37.5, 112.5] {
                self.draft.put(self.stocks.road, crossing + along * half);
            }
            for lamp in 1..4 {
                let side = if lamp % 2 == 0 { 11.0 } else { -11.0 };
                self.draft.put(self.stocks.lamp, crossing + along * (f64::from(lamp) * 40.0) + across * side);
            }
            self.draft.put(self.stocks.traffic_light, crossing + along * 17.0 + across * 11.0);
            self.traffic(crossing, along, across);
        }
    }

    /// Parked cars at the kerbs, a bus now and then. The storyboard drives in the middle of the road.
    fn traffic(&mut self, crossing: DVec3, along: DVec3, across: DVec3) {
        for _ in 0..2 + self.dice.below(4) {
            let side = self.dice.pick(&[-8.5, 8.5]);
            let at = crossing + along * self.dice.between(25.0, 140.0) + across * side;
            let car = self.dice.pick(&self.stocks.cars);
            self.draft.put(car, at);
        }
        if self.dice.chance(0.15) {
            let at = crossing + along * self.dice.between(30.0, 130.0) + across * 5.0;
            self.draft.put(self.stocks.bus, at);
        }
    }

    fn block(&mut self, use_: u8, corner: DVec3) {
        match use_ {
            b'T' => self.towers(corner),
            b'a' => self.apartments(corner),
            b's' => self.shops(corner),
            b'p' => self.park(corner),
            b'q' => self.square(corner),
            _ => self.houses(corner),
        }
    }

    fn towers(&mut self, corner: DVec3) {
        for (x, z) in [(30.0, 30.0), (90.0, 30.0), (30.0, 90.0), (90.0, 90.0)] {
            let tower = self.dice.pick(&[self.stocks.glass_tower, self.stocks.stone_tower]);
            let scale = self.dice.between(0.7, 1.3);
            self.draft.put_scaled(tower, corner + DVec3::new(x, 0.0, z), scale);
        }
        self.scatter(self.stocks.tree, 6, corner);
        self.scatter(self.stocks.bench, 6, corner);
        self.scatter(self.stocks.bin, 4, corner);
    }

    /// Four long blocks around a court with trees.
    fn apartments(&mut self, corner: DVec3) {
        for (x, z) in [(35.0, 12.0), (85.0, 12.0), (35.0, 108.0), (85.0, 108.0)] {
            let scale = self.dice.between(0.9, 1.15);
            self.draft.put_scaled(self.stocks.apartments, corner + DVec3::new(x, 0.0, z), scale);
        }
        self.scatter(self.stocks.tree, 10, corner);
        self.scatter(self.stocks.bench, 4, corner);
        self.scatter(self.stocks.bin, 4, corner);
    }

    fn shops(&mut self, corner: DVec3) {
        for (x, z) in
            (0..3).flat_map(|i| [(20.0 + 40.0 * f64::from(i), 10.0), (20.0 + 40.0 * f64::from(i), 110.0)])
        {
            let scale = self.dice.between(0.9, 1.3);
            self.draft.put_scaled(self.stocks.shops, corner + DVec3::new(x, 0.0, z), scale);
        }
        self.scatter(self.stocks.apartments, 1, corner);
        self.scatter(self.stocks.tree, 4, corner);
        self.scatter(self.stocks.bench, 5, corner);
        self.scatter(self.stocks.bin, 5, corner);
    }

    /// Three rows of four gardens.
    fn houses(&mut self, corner: DVec3) {
        for plot in 0..12 {
            let [column, row] = [plot % 4, plot / 4].map(f64::from);
            let plot = corner + DVec3::new(15.0 + 30.0 * column, 0.0, 20.0 + 40.0 * row);
            if self.dice.chance(0.85) {
                let scale = self.dice.between(0.85, 1.25);
                self.draft.put_scaled(self.stocks.house, plot, scale);
            }
            if self.dice.chance(0.7) {
                let along = self.dice.between(-12.0, 12.0);
                self.tree(plot + DVec3::new(along, 0.0, 13.0));
            }
        }
    }

    fn park(&mut self, corner: DVec3) {
        self.scatter(self.stocks.tree, 60, corner);
        self.scatter(self.stocks.bench, 12, corner);
        self.scatter(self.stocks.bin, 6, corner);
    }

    /// The market: stalls in rows around a fountain.
    fn square(&mut self, corner: DVec3) {
        self.draft.put(self.stocks.fountain, corner + DVec3::new(60.0, 0.0, 60.0));
        for stall in 0..48 {
            let [column, row] = [stall % 8, stall / 8].map(f64::from);
            let south = if row < 3.0 { 8.0 + 11.0 * row } else { 48.0 + 11.0 * row };
            self.draft.put(self.stocks.stall, corner + DVec3::new(11.0 + 14.0 * column, 0.0, south));
        }
        self.scatter(self.stocks.bench, 16, corner);
        self.scatter(self.stocks.bin, 10, corner);
    }

    fn scatter(&mut self, stock: Stock, count: usize, corner: DVec3) {
        for _ in 0..count {
            let at = DVec3::new(self.dice.between(3.0, 117.0), 0.0, self.dice.between(22.0, 98.0));
            self.draft.put(stock, corner + at);
        }
    }

    fn tree(&mut self, at: DVec3) {
        let scale = self.dice.between(0.6, 1.3);
        self.draft.put_scaled(self.stocks.tree, at, scale);
    }
}

/// The driver's eyes.
const EYE: f64 = 1.3;

/// In from the suburbs at 14 m/s, right at the towers, a stop, and up.
const DRIVE: &[Key] = &[
    // A quiet street at the western edge, looking half out of the city.
    key(0.0, [15.0, EYE, 450.0], 215.0, 0.0),
    key(3.0, [15.0, EYE, 450.0], 215.0, 0.0),
    key(7.0, [15.0, EYE, 490.0], 190.0, 0.0),
    key(14.0, [15.0, EYE, 590.0], 180.0, 0.0),
    // Left, towards the towers.
    key(17.0, [24.0, EYE, 614.0], 90.0, 0.0),
    key(33.0, [300.0, EYE, 615.0], 90.0, 2.0),
    key(47.0, [595.0, EYE, 615.0], 90.0, 4.0),
    // Right at the crossing, and a red light at the market.
    key(50.0, [614.0, EYE, 626.0], 180.0, 2.0),
    key(56.0, [615.0, EYE, 735.0], 180.0, 0.0),
    key(61.0, [615.0, EYE, 735.0], 180.0, 0.0),
    // Look down, let go of the ground, and turn over the roofs.
    key(64.0, [616.0, 12.0, 745.0], 150.0, -35.0),
    key(70.0, [600.0, 190.0, 620.0], 220.0, -40.0),
    key(77.0, [250.0, 260.0, 200.0], 135.0, -22.0),
    key(82.0, [100.0, 230.0, 80.0], 130.0, -15.0),
    key(86.0, [90.0, 220.0, 70.0], 215.0, -16.0),
];

pub(super) fn path(seed: u64) -> CameraPath {
    Film { name: "city", hz: 20, sway_deg: 0.6, shots: &[DRIVE] }.shoot(seed)
}
