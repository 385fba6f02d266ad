//! Kinds for a city: houses, towers, vehicles and street furniture. Sizes in metres.

use super::kind::Kind;
use super::shape::Shape;
use super::shape::Shape::{
    Block, Cone, Crown, Cylinder, Field, Profile, Recess, RoundedBlock, Sphere, StandIn, Torus, Tube,
};

/// Two crossed cards.
const fn cards(reach: f64) -> Shape {
    StandIn { triangles: 4, vertices: 8, reach }
}

pub(super) fn road() -> Kind {
    Kind::new("road", [75.0, 0.4, 30.0])
        .part("asphalt", Block([75.0, 0.2, 20.0]), 1, &[1, 1, 1])
        .part("stone", Block([75.0, 0.35, 5.0]), 2, &[1, 1, 1])
        .trim("stone", RoundedBlock([1.0, 0.2, 0.2], 0.03), 150, &[3, 1, 0], 0.2)
        .trim("iron", Cylinder { radius: 0.35, height: 0.02 }, 4, &[32, 0, 0], 0.02)
}

/// A glass tower of 40 storeys. Windows are pockets a hand deep: leaving them out hardly shows.
pub(super) fn glass_tower() -> Kind {
    Kind::new("glass tower", [36.0, 160.0, 36.0])
        .part("glass", RoundedBlock([36.0, 150.0, 36.0], 3.0), 1, &[9, 6, 4, 2, 1])
        .part("glass", Recess { depth: 0.15 }, 1920, &[1, 0, 0, 0, 0])
        .trim("steel", Profile { corners: 4, size: [0.2, 3.8, 0.4] }, 480, &[1, 1, 0, 0, 0], 0.4)
        .trim("steel", RoundedBlock([36.4, 0.6, 36.4], 3.0), 40, &[4, 3, 2, 0, 0], 0.6)
        .part("roof", Cylinder { radius: 3.0, height: 6.0 }, 6, &[32, 20, 10, 5, 0])
        .part("steel", Tube { radius: 0.3, length: 10.0 }, 3, &[16, 10, 4, 3, 0])
        .one_draw_from(3)
}

/// A stone tower with deep windows and set-backs.
pub(super) fn stone_tower() -> Kind {
    Kind::new("stone tower", [30.0, 110.0, 30.0])
        .part("stone", Block([30.0, 50.0, 30.0]), 3, &[1, 1, 1, 1])
        .part("stone", Recess { depth: 0.4 }, 1100, &[1, 1, 0, 0])
        .trim("stone", RoundedBlock([1.6, 0.2, 0.4], 0.05), 550, &[2, 0, 0, 0], 0.4)
        .part("copper", Cone { radius: 8.0, height: 18.0 }, 1, &[40, 20, 10, 5])
        .one_draw_from(2)
}

pub(super) fn apartment_block() -> Kind {
    Kind::new("apartment block", [40.0, 24.0, 16.0])
        .part("brick", Block([40.0, 22.0, 16.0]), 1, &[1, 1, 1, 1])
        .part("frame", Recess { depth: 0.25 }, 168, &[1, 1, 0, 0])
        .trim("iron", RoundedBlock([2.4, 0.15, 1.2], 0.04), 84, &[3, 1, 1, 0], 1.3)
        .trim("iron", Cylinder { radius: 0.012, height: 1.0 }, 1100, &[6, 3, 0, 0], 1.3)
        .part("tile", Profile { corners: 5, size: [40.0, 3.0, 16.0] }, 1, &[1, 1, 1, 1])
        .part("brick", RoundedBlock([1.0, 2.0, 1.0], 0.05), 6, &[3, 1, 1, 0])
        .one_draw_from(3)
}

pub(super) fn shop_row() -> Kind {
    Kind::new("shop row", [30.0, 12.0, 14.0])
        .part("brick", Block([30.0, 11.0, 14.0]), 1, &[1, 1, 1, 1])
        .part("glass", Recess { depth: 0.5 }, 42, &[1, 1, 1, 0])
        .part("cloth", Cylinder { radius: 1.2, height: 5.0 }, 6, &[40, 16, 8, 4])
        .trim("sign", RoundedBlock([3.0, 0.6, 0.2], 0.08), 12, &[6, 3, 1, 0], 0.3)
        .trim("brick", Torus { ring: 0.9, tube: 0.12 }, 18, &[28, 14, 0, 0], 0.25)
        .one_draw_from(3)
}

pub(super) fn house() -> Kind {
    Kind::new("house", [12.0, 9.0, 10.0])
        .part("plaster", Block([12.0, 6.0, 10.0]), 1, &[1, 1, 1, 1])
        .part("tile", Profile { corners: 3, size: [12.6, 3.0, 10.6] }, 1, &[1, 1, 1, 1])
        .trim("tile", RoundedBlock([0.3, 0.04, 0.4], 0.02), 120, &[3, 1, 0, 0], 0.05)
        .part("frame", Recess { depth: 0.2 }, 14, &[1, 1, 0, 0])
        .trim("wood", RoundedBlock([0.6, 1.4, 0.06], 0.02), 24, &[4, 2, 1, 0], 0.1)
        .trim("wood", Tube { radius: 0.06, length: 6.0 }, 8, &[16, 8, 4, 0], 0.2)
        .part("brick", RoundedBlock([0.8, 1.6, 0.8], 0.05), 1, &[4, 2, 1, 1])
        .one_draw_from(3)
}

/// Body of rounded panels, wheels, mirrors, seats.
fn car(name: &str, [length, height, width]: [f64; 3], seats: u32) -> Kind {
    Kind::new(name, [length, height, width])
        .part("paint", RoundedBlock([length, height * 0.5, width], 0.25), 1, &[17, 12, 7, 4, 2])
        .part("paint", RoundedBlock([length * 0.55, height * 0.45, width * 0.9], 0.3), 1, &[15, 10, 6, 3, 1])
        .part("rubber", Torus { ring: 0.28, tube: 0.1 }, 4, &[40, 24, 12, 8, 0])
        .part("alloy", Cylinder { radius: 0.24, height: 0.2 }, 4, &[48, 24, 12, 6, 4])
        .part("glass", Sphere { radius: 0.12 }, 4, &[28, 14, 6, 0, 0])
        .part("cloth", RoundedBlock([0.5, 0.9, 0.5], 0.1), seats, &[9, 5, 2, 0, 0])
        .part("cloth", Torus { ring: 0.18, tube: 0.02 }, 1, &[40, 16, 0, 0, 0])
        .part("paint", RoundedBlock([0.2, 0.14, 0.12], 0.04), 2, &[7, 3, 1, 0, 0])
        .one_draw_from(3)
        .seen_to(500.0)
}

pub(super) fn small_car() -> Kind {
    car("small car", [3.7, 1.45, 1.7], 4)
}

pub(super) fn saloon() -> Kind {
    car("saloon", [4.7, 1.45, 1.85], 5).importance(1.2)
}

pub(super) fn van() -> Kind {
    car("van", [5.4, 2.4, 2.0], 9)
}

pub(super) fn bus() -> Kind {
    Kind::new("bus", [12.0, 3.2, 2.6])
        .part("paint", RoundedBlock([12.0, 2.9, 2.6], 0.3), 1, &[15, 9, 5, 3, 1])
        .part("glass", Recess { depth: 0.05 }, 18, &[1, 1, 0, 0, 0])
        .part("cloth", RoundedBlock([0.5, 1.0, 0.5], 0.1), 40, &[7, 4, 1, 0, 0])
        .part("rubber", Torus { ring: 0.4, tube: 0.12 }, 6, &[40, 20, 10, 6, 0])
        .part("steel", Tube { radius: 0.02, length: 2.0 }, 16, &[16, 8, 0, 0, 0])
        .one_draw_from(2)
        .seen_to(700.0)
}

pub(super) fn street_lamp() -> Kind {
    Kind::new("street lamp", [2.0, 8.0, 0.5])
        .part("steel", Tube { radius: 0.1, length: 7.5 }, 1, &[32, 16, 8, 4])
        .part("steel", Torus { ring: 0.8, tube: 0.05 }, 1, &[32, 16, 8, 0])
        .part("glass", Sphere { radius: 0.2 }, 1, &[32, 16, 8, 4])
        .part("steel", RoundedBlock([0.4, 0.6, 0.4], 0.08), 1, &[7, 4, 1, 0])
        .one_draw_from(2)
        .seen_to(350.0)
}

pub(super) fn traffic_light() -> Kind {
    Kind::new("traffic light", [0.6, 3.6, 0.5])
        .part("steel", Tube { radius: 0.08, length: 3.5 }, 1, &[32, 14, 6])
        .part("plastic", RoundedBlock([0.3, 0.9, 0.25], 0.05), 2, &[9, 4, 1])
        .part("glass", Sphere { radius: 0.1 }, 6, &[28, 12, 4])
        .part("plastic", Tube { radius: 0.12, length: 0.2 }, 6, &[24, 10, 0])
        .importance(1.5)
        .seen_to(200.0)
}

pub(super) fn bench() -> Kind {
    Kind::new("bench", [1.8, 0.9, 0.7])
        .part("wood", RoundedBlock([1.8, 0.03, 0.09], 0.01), 9, &[5, 3, 1])
        .part("iron", Torus { ring: 0.2, tube: 0.025 }, 4, &[32, 14, 5])
        .trim("iron", Cylinder { radius: 0.008, height: 0.02 }, 36, &[10, 0, 0], 0.02)
        .seen_to(120.0)
}

pub(super) fn bin() -> Kind {
    Kind::new("bin", [0.6, 1.0, 0.6])
        .part("steel", Cylinder { radius: 0.28, height: 0.9 }, 1, &[48, 20, 8])
        .trim("steel", Torus { ring: 0.28, tube: 0.03 }, 2, &[40, 16, 0], 0.06)
        .seen_to(100.0)
}

pub(super) fn market_stall() -> Kind {
    Kind::new("market stall", [4.0, 3.0, 3.0])
        .part("cloth", Field { side: 4.0, relief: 0.6, bend: 0.6 }, 1, &[24, 12, 6, 2])
        .part("wood", Cylinder { radius: 0.04, height: 2.6 }, 6, &[20, 10, 5, 3])
        .part("wood", RoundedBlock([0.6, 0.25, 0.4], 0.02), 18, &[3, 2, 1, 1])
        .part("fruit", Sphere { radius: 0.05 }, 240, &[10, 6, 0, 0])
        .one_draw_from(2)
        .seen_to(250.0)
}

pub(super) fn fountain() -> Kind {
    Kind::new("fountain", [14.0, 7.0, 14.0])
        .part("stone", Torus { ring: 6.5, tube: 0.5 }, 1, &[128, 72, 40, 20, 10, 6])
        .part("stone", Torus { ring: 2.5, tube: 0.3 }, 2, &[96, 56, 32, 16, 8, 5])
        .part("stone", Cylinder { radius: 0.6, height: 5.0 }, 1, &[64, 40, 20, 10, 6, 4])
        .part("bronze", Sphere { radius: 0.5 }, 12, &[36, 24, 14, 8, 6, 4])
        .part("water", Field { side: 9.0, relief: 0.1, bend: 0.4 }, 1, &[48, 28, 14, 6, 3, 1])
        .importance(2.0)
        .cost(1.5)
}

pub(super) fn street_tree() -> Kind {
    Kind::new("street tree", [6.0, 9.0, 6.0])
        .part("leaf", Crown { radius: 3.0 }, 1, &[64, 44, 28, 16, 8])
        .part("leaf", Crown { radius: 1.5 }, 4, &[32, 20, 12, 0, 0])
        .part("bark", Tube { radius: 0.2, length: 4.0 }, 12, &[16, 8, 5, 3, 0])
        .part("leaf", cards(3.0), 1, &[0, 0, 0, 0, 1])
        .one_draw_from(3)
}
