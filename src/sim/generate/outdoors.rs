//! Kinds for a forest and a festival in its clearing. Sizes in metres.

use super::kind::Kind;
use super::shape::Shape;
use super::shape::Shape::{
    Block, Cone, Crown, Cylinder, Field, Profile, RoundedBlock, Sphere, StandIn, Torus, Tube,
};

/// Two crossed cards.
const fn cards(reach: f64) -> Shape {
    StandIn { triangles: 4, vertices: 8, reach }
}

pub(super) fn ground() -> Kind {
    Kind::new("ground", [50.0, 2.0, 50.0]).part(
        "soil",
        Field { side: 50.0, relief: 2.0, bend: 0.05 },
        1,
        &[64, 40, 24, 12, 6, 2],
    )
}

pub(super) fn beech() -> Kind {
    Kind::new("beech", [9.0, 16.0, 9.0])
        .part("leaf", Crown { radius: 4.5 }, 1, &[72, 48, 32, 20, 10, 0])
        .part("leaf", Crown { radius: 2.0 }, 6, &[36, 24, 14, 8, 0, 0])
        .part("bark", Tube { radius: 0.35, length: 9.0 }, 1, &[32, 16, 10, 6, 4, 0])
        .part("bark", Tube { radius: 0.1, length: 3.0 }, 40, &[10, 7, 4, 0, 0, 0])
        .part("leaf", cards(4.5), 1, &[0, 0, 0, 0, 0, 1])
        .one_draw_from(4)
        .seen_to(160.0)
}

pub(super) fn spruce() -> Kind {
    Kind::new("spruce", [6.0, 22.0, 6.0])
        .part("needle", Cone { radius: 3.0, height: 3.0 }, 9, &[96, 48, 24, 10, 5, 0])
        .part("needle", Crown { radius: 2.0 }, 9, &[28, 20, 12, 0, 0, 0])
        .part("bark", Tube { radius: 0.3, length: 21.0 }, 1, &[24, 14, 8, 5, 3, 0])
        .part("needle", cards(3.0), 1, &[0, 0, 0, 0, 0, 1])
        .one_draw_from(3)
        .seen_to(160.0)
}

pub(super) fn birch() -> Kind {
    Kind::new("birch", [5.0, 13.0, 5.0])
        .part("leaf", Crown { radius: 1.6 }, 6, &[36, 24, 14, 8, 0])
        .part("bark", Tube { radius: 0.15, length: 11.0 }, 1, &[24, 12, 8, 4, 0])
        .part("bark", Tube { radius: 0.05, length: 2.0 }, 20, &[8, 5, 3, 0, 0])
        .part("leaf", cards(2.5), 1, &[0, 0, 0, 0, 1])
        .one_draw_from(3)
        .seen_to(120.0)
}

/// Where the path comes close: a tree for the camera to pass within arm's reach.
pub(super) fn old_oak() -> Kind {
    Kind::new("old oak", [18.0, 20.0, 18.0])
        .part("leaf", Crown { radius: 8.0 }, 1, &[120, 80, 48, 28, 14, 8])
        .part("leaf", Crown { radius: 3.0 }, 12, &[48, 30, 18, 10, 0, 0])
        .part("bark", Tube { radius: 1.2, length: 7.0 }, 1, &[64, 40, 24, 12, 6, 4])
        .part("bark", Tube { radius: 0.3, length: 6.0 }, 60, &[16, 10, 6, 4, 0, 0])
        .part("bark", Sphere { radius: 0.4 }, 12, &[24, 14, 8, 0, 0, 0])
        .one_draw_from(4)
        .importance(1.5)
}

pub(super) fn shrub() -> Kind {
    Kind::new("shrub", [1.8, 1.4, 1.8])
        .part("leaf", Crown { radius: 0.8 }, 2, &[32, 20, 10, 0])
        .part("bark", Tube { radius: 0.02, length: 0.8 }, 10, &[6, 4, 0, 0])
        .part("leaf", cards(0.9), 1, &[0, 0, 0, 1])
        .one_draw_from(2)
        .seen_to(120.0)
}

pub(super) fn fern() -> Kind {
    Kind::new("fern", [1.2, 0.8, 1.2]).part("leaf", Crown { radius: 0.5 }, 1, &[36, 20, 8]).seen_to(60.0)
}

pub(super) fn rock() -> Kind {
    Kind::new("rock", [2.4, 1.6, 2.0])
        .part("stone", RoundedBlock([2.4, 1.6, 2.0], 0.6), 1, &[16, 9, 5, 3, 1])
        .seen_to(260.0)
}

pub(super) fn log() -> Kind {
    Kind::new("log", [5.0, 0.7, 0.7])
        .part("bark", Cylinder { radius: 0.35, height: 5.0 }, 1, &[64, 28, 12, 6])
        .part("bark", Tube { radius: 0.08, length: 0.8 }, 8, &[16, 8, 0, 0])
        .seen_to(150.0)
}

/// Skinned: dearer than its triangles say, and worth more than a tree. Folds are those of the dress.
pub(super) fn person(name: &str, dress: &'static str, folds: u32) -> Kind {
    Kind::new(name, [0.8, 1.8, 0.5])
        .part("skin", Sphere { radius: 0.12 }, 1, &[40, 26, 16, 10, 6])
        .trim("skin", Cylinder { radius: 0.015, height: 0.08 }, 20, &[14, 8, 0, 0, 0], 0.08)
        .part("hair", Crown { radius: 0.13 }, 1, &[28, 16, 8, 0, 0])
        .part(dress, RoundedBlock([0.45, 0.6, 0.25], 0.1), 1, &[14, 9, 5, 3, 1])
        .trim(dress, Torus { ring: 0.22, tube: 0.02 }, folds, &[32, 20, 10, 0, 0], 0.05)
        .part(dress, Cylinder { radius: 0.08, height: 0.4 }, 8, &[36, 20, 12, 6, 4])
        .part("leather", RoundedBlock([0.1, 0.1, 0.28], 0.04), 2, &[9, 5, 2, 0, 0])
        .one_draw_from(3)
        .importance(1.5)
        .cost(2.0)
        .seen_to(60.0)
}

/// The singer: everything that a close-up asks for, 50 000 triangles.
pub(super) fn singer() -> Kind {
    Kind::new("singer", [0.9, 1.85, 0.7])
        .part("skin", Sphere { radius: 0.12 }, 1, &[96, 60, 36, 20, 12, 6])
        .trim("skin", Cylinder { radius: 0.012, height: 0.04 }, 56, &[28, 18, 10, 0, 0, 0], 0.05)
        .part("hair", Crown { radius: 0.2 }, 2, &[96, 60, 32, 16, 8, 0])
        .part("silk", RoundedBlock([0.45, 0.7, 0.25], 0.12), 1, &[24, 16, 9, 5, 3, 1])
        .trim("silk", Torus { ring: 0.25, tube: 0.03 }, 5, &[40, 26, 16, 8, 0, 0], 0.1)
        .part("silk", Cylinder { radius: 0.08, height: 0.4 }, 8, &[64, 40, 20, 10, 6, 4])
        .trim("steel", Torus { ring: 0.02, tube: 0.004 }, 4, &[24, 12, 0, 0, 0, 0], 0.05)
        .importance(4.0)
        .cost(2.5)
}

pub(super) fn tent() -> Kind {
    Kind::new("tent", [4.0, 2.4, 4.0])
        .part("canvas", Field { side: 4.0, relief: 2.0, bend: 0.8 }, 1, &[28, 16, 8, 4])
        .part("rope", Tube { radius: 0.01, length: 2.5 }, 12, &[8, 3, 0, 0])
        .part("wood", Cylinder { radius: 0.03, height: 2.2 }, 3, &[20, 10, 4, 0])
        .one_draw_from(2)
}

pub(super) fn lantern() -> Kind {
    Kind::new("lantern", [0.6, 3.0, 0.6])
        .part("wood", Cylinder { radius: 0.05, height: 2.6 }, 1, &[24, 10, 4])
        .part("paper", Sphere { radius: 0.25 }, 1, &[40, 18, 6])
        .seen_to(250.0)
}

pub(super) fn stage() -> Kind {
    Kind::new("stage", [20.0, 10.0, 12.0])
        .part("wood", Block([20.0, 1.4, 12.0]), 1, &[1, 1, 1, 1])
        .part("steel", Tube { radius: 0.03, length: 1.2 }, 900, &[12, 6, 3, 0])
        .part("steel", Tube { radius: 0.06, length: 10.0 }, 16, &[20, 10, 6, 4])
        .part("light", Cone { radius: 0.25, height: 0.4 }, 40, &[36, 16, 8, 0])
        .part("plastic", RoundedBlock([1.0, 1.2, 0.9], 0.06), 16, &[6, 3, 1, 1])
        .part("cloth", Field { side: 18.0, relief: 1.5, bend: 0.2 }, 1, &[40, 20, 10, 3])
        .importance(1.5)
}

pub(super) fn food_stall() -> Kind {
    Kind::new("food stall", [5.0, 3.2, 3.0])
        .part("wood", Profile { corners: 6, size: [5.0, 3.0, 3.0] }, 1, &[1, 1, 1])
        .part("cloth", Field { side: 4.0, relief: 0.4, bend: 0.4 }, 1, &[20, 8, 2])
        .part("wood", RoundedBlock([0.5, 0.3, 0.4], 0.03), 24, &[4, 2, 0])
        .part("steel", Cylinder { radius: 0.15, height: 0.3 }, 8, &[40, 16, 0])
}

pub(super) fn bench() -> Kind {
    Kind::new("log bench", [2.2, 0.5, 0.5])
        .part("wood", Cylinder { radius: 0.2, height: 2.2 }, 1, &[40, 16, 6])
        .part("wood", Cylinder { radius: 0.15, height: 0.3 }, 2, &[32, 12, 0])
        .seen_to(150.0)
}
