//! Kinds for a building: its structure, and what stands in its rooms. Sizes in metres.

use super::kind::Kind;
use super::shape::Shape;
use super::shape::Shape::{
    Block, Cone, Crown, Cylinder, Field, Profile, Recess, RoundedBlock, Sphere, StandIn, Torus, Tube,
};

/// A box with the counts of a box, for what a level leaves out.
const fn box_within(reach: f64) -> Shape {
    StandIn { triangles: 12, vertices: 24, reach }
}

pub(super) fn slab(side: f64) -> Kind {
    Kind::new("floor slab", [side, 0.3, side]).part("concrete", Block([side, 0.3, side]), 1, &[1])
}

pub(super) fn wall(length: f64, height: f64) -> Kind {
    Kind::new("wall", [length, height, 0.2]).part("plaster", Block([length, height, 0.2]), 1, &[1, 1]).trim(
        "wood",
        RoundedBlock([length, 0.1, 0.02], 0.01),
        2,
        &[3, 0],
        0.02,
    )
}

pub(super) fn window_wall(length: f64, height: f64) -> Kind {
    Kind::new("window wall", [length, height, 0.3])
        .part("plaster", Block([length, height, 0.3]), 1, &[1, 1, 1])
        .part("plaster", Recess { depth: 0.2 }, 3, &[1, 1, 0])
        .trim("frame", RoundedBlock([1.6, 0.06, 0.06], 0.01), 18, &[3, 1, 0], 0.1)
        .trim("steel", Cylinder { radius: 0.012, height: 0.12 }, 6, &[16, 0, 0], 0.12)
}

pub(super) fn door_wall(length: f64, height: f64) -> Kind {
    Kind::new("door wall", [length, height, 0.2])
        .part("plaster", Block([length, height, 0.2]), 3, &[1, 1, 1])
        .part("wood", RoundedBlock([0.9, 2.1, 0.05], 0.01), 1, &[4, 2, 1])
        .part("wood", RoundedBlock([0.1, 2.2, 0.25], 0.02), 3, &[4, 2, 1])
        .trim("steel", Torus { ring: 0.06, tube: 0.01 }, 2, &[24, 8, 0], 0.1)
        .trim("steel", Cylinder { radius: 0.012, height: 0.1 }, 6, &[16, 0, 0], 0.1)
}

pub(super) fn railing(length: f64) -> Kind {
    Kind::new("railing", [length, 1.1, 0.1])
        .part("steel", Cylinder { radius: 0.02, height: 1.0 }, 40, &[16, 6, 4, 0])
        .part("steel", Sphere { radius: 0.03 }, 40, &[12, 0, 0, 0])
        .part("wood", Cylinder { radius: 0.035, height: length }, 1, &[24, 12, 6, 4])
        .trim("steel", Profile { corners: 4, size: [length, 0.02, 0.02] }, 6, &[1, 1, 1, 0], 1.0)
        .one_draw_from(2)
}

pub(super) fn stairs() -> Kind {
    Kind::new("stairs", [2.4, 5.0, 12.0])
        .part("concrete", Block([2.4, 0.18, 0.5]), 24, &[1, 1, 1])
        .trim("rubber", RoundedBlock([2.4, 0.03, 0.06], 0.012), 24, &[4, 1, 0], 0.03)
        .part("steel", Cylinder { radius: 0.02, height: 1.0 }, 48, &[16, 5, 0])
        .part("wood", Cylinder { radius: 0.035, height: 12.5 }, 2, &[24, 10, 5])
}

pub(super) fn column() -> Kind {
    Kind::new("column", [0.8, 4.0, 0.8])
        .part("stone", Cylinder { radius: 0.3, height: 3.6 }, 1, &[48, 20, 8, 5])
        .part("stone", Torus { ring: 0.3, tube: 0.08 }, 3, &[48, 20, 8, 0])
        .part("stone", RoundedBlock([0.8, 0.2, 0.8], 0.04), 2, &[5, 2, 1, 1])
}

pub(super) fn pendant_lamp() -> Kind {
    Kind::new("pendant lamp", [0.6, 1.0, 0.6])
        .part("glass", Sphere { radius: 0.2 }, 1, &[40, 20, 10, 6])
        .part("steel", Cone { radius: 0.3, height: 0.2 }, 1, &[48, 20, 8, 0])
        .part("steel", Cylinder { radius: 0.01, height: 0.7 }, 1, &[12, 5, 3, 3])
        .one_draw_from(2)
        .seen_to(30.0)
}

/// The hero of the atrium: a cloud of rings and spheres, 50 000 triangles.
pub(super) fn mobile() -> Kind {
    Kind::new("mobile", [6.0, 9.0, 6.0])
        .part("brass", Torus { ring: 0.5, tube: 0.06 }, 12, &[48, 28, 16, 10, 6, 4])
        .part("glass", Sphere { radius: 0.3 }, 16, &[36, 20, 12, 8, 6, 4])
        .part("steel", Tube { radius: 0.01, length: 4.0 }, 28, &[12, 8, 6, 4, 3, 3])
        .importance(2.0)
}

pub(super) fn planter() -> Kind {
    Kind::new("planter", [1.8, 2.6, 1.8])
        .part("leaf", Crown { radius: 0.9 }, 1, &[80, 48, 28, 16, 8])
        .part("bark", Tube { radius: 0.06, length: 1.4 }, 3, &[20, 12, 6, 4, 0])
        .part("clay", Cylinder { radius: 0.5, height: 0.6 }, 1, &[48, 24, 12, 8, 5])
        .trim("clay", Torus { ring: 0.5, tube: 0.05 }, 1, &[48, 20, 8, 0, 0], 0.1)
        .trim("soil", Field { side: 0.8, relief: 0.08, bend: 0.5 }, 1, &[12, 6, 2, 0, 0], 0.1)
        .one_draw_from(3)
        .seen_to(45.0)
}

pub(super) fn office_chair() -> Kind {
    Kind::new("office chair", [0.7, 1.1, 0.7])
        .part("cloth", RoundedBlock([0.5, 0.1, 0.5], 0.04), 2, &[12, 7, 4, 2, 1])
        .part("plastic", Torus { ring: 0.12, tube: 0.02 }, 2, &[32, 16, 8, 0, 0])
        .part("plastic", RoundedBlock([0.3, 0.04, 0.05], 0.015), 5, &[6, 3, 1, 1, 0])
        .part("plastic", Sphere { radius: 0.035 }, 10, &[20, 10, 6, 0, 0])
        .part("steel", Cylinder { radius: 0.03, height: 0.4 }, 2, &[32, 14, 7, 4, 0])
        .one_draw_from(3)
        .seen_to(28.0)
}

pub(super) fn desk() -> Kind {
    Kind::new("desk", [1.6, 0.75, 0.8])
        .part("wood", RoundedBlock([1.6, 0.04, 0.8], 0.01), 1, &[5, 2, 1])
        .part("steel", RoundedBlock([0.05, 0.7, 0.05], 0.01), 4, &[5, 2, 1])
        .part("wood", RoundedBlock([0.4, 0.18, 0.5], 0.01), 3, &[4, 2, 1])
        .trim("steel", Torus { ring: 0.05, tube: 0.006 }, 3, &[24, 8, 0], 0.06)
        .seen_to(28.0)
}

/// Over a hundred keys with rounded edges: small, and dear.
pub(super) fn computer() -> Kind {
    Kind::new("computer", [0.9, 0.6, 0.5])
        .trim("plastic", RoundedBlock([0.018, 0.012, 0.018], 0.004), 104, &[4, 2, 0, 0], 0.012)
        .part("plastic", RoundedBlock([0.45, 0.02, 0.15], 0.008), 1, &[6, 3, 1, 0])
        .part("plastic", Sphere { radius: 0.05 }, 1, &[32, 14, 0, 0])
        .part("screen", RoundedBlock([0.6, 0.36, 0.03], 0.01), 1, &[7, 3, 1, 1])
        .part("steel", Cylinder { radius: 0.03, height: 0.25 }, 2, &[32, 12, 5, 3])
        .one_draw_from(2)
        .seen_to(16.0)
}

pub(super) fn desk_lamp() -> Kind {
    Kind::new("desk lamp", [0.4, 0.6, 0.25])
        .part("paint", Cone { radius: 0.12, height: 0.16 }, 2, &[48, 20, 8])
        .part("paint", Cylinder { radius: 0.012, height: 0.35 }, 3, &[20, 8, 4])
        .part("paint", Cylinder { radius: 0.1, height: 0.03 }, 1, &[48, 20, 8])
        .part("glass", Sphere { radius: 0.04 }, 1, &[24, 10, 0])
        .part("paint", Sphere { radius: 0.02 }, 3, &[20, 0, 0])
        .seen_to(16.0)
}

pub(super) fn shelf_of_books() -> Kind {
    Kind::new("shelf of books", [1.2, 2.1, 0.35])
        .part("wood", RoundedBlock([1.2, 0.03, 0.35], 0.006), 8, &[3, 1, 1, 1])
        .part("paper", RoundedBlock([0.03, 0.26, 0.2], 0.008), 180, &[3, 2, 1, 0])
        .part("paper", box_within(0.12), 6, &[0, 0, 0, 1])
        .one_draw_from(3)
        .seen_to(26.0)
}

pub(super) fn filing_cabinet() -> Kind {
    Kind::new("filing cabinet", [0.5, 1.3, 0.6])
        .part("steel", RoundedBlock([0.5, 0.3, 0.6], 0.01), 4, &[5, 2, 1])
        .trim("chrome", Torus { ring: 0.05, tube: 0.008 }, 4, &[24, 8, 0], 0.06)
        .trim("chrome", Cylinder { radius: 0.01, height: 0.01 }, 4, &[16, 0, 0], 0.01)
        .seen_to(28.0)
}

pub(super) fn sofa() -> Kind {
    Kind::new("sofa", [2.1, 0.85, 0.95])
        .part("cloth", RoundedBlock([0.9, 0.25, 0.8], 0.08), 6, &[12, 7, 4, 2, 1])
        .part("wood", Cylinder { radius: 0.03, height: 0.12 }, 4, &[20, 10, 5, 0, 0])
        .seen_to(32.0)
}

pub(super) fn round_table() -> Kind {
    Kind::new("round table", [1.2, 0.75, 1.2])
        .part("wood", Cylinder { radius: 0.6, height: 0.03 }, 1, &[96, 48, 20, 8])
        .trim("wood", Torus { ring: 0.6, tube: 0.015 }, 1, &[64, 24, 0, 0], 0.015)
        .part("steel", Cylinder { radius: 0.05, height: 0.7 }, 1, &[40, 16, 8, 4])
        .part("steel", Cone { radius: 0.3, height: 0.05 }, 1, &[64, 24, 10, 4])
        .seen_to(28.0)
}

pub(super) fn crockery() -> Kind {
    Kind::new("crockery", [0.5, 0.15, 0.5])
        .part("china", Torus { ring: 0.1, tube: 0.01 }, 6, &[36, 14, 6, 0])
        .part("china", Cylinder { radius: 0.04, height: 0.1 }, 6, &[36, 14, 6, 4])
        .part("china", Torus { ring: 0.025, tube: 0.006 }, 6, &[20, 8, 0, 0])
        .part("china", Cylinder { radius: 0.1, height: 0.01 }, 6, &[36, 14, 6, 4])
        .seen_to(12.0)
}

/// Flasks, tubes and rings on a bench: what makes a laboratory dense.
pub(super) fn glassware() -> Kind {
    Kind::new("glassware", [1.4, 0.5, 0.5])
        .part("glass", Sphere { radius: 0.08 }, 6, &[32, 18, 10, 6, 4])
        .part("glass", Tube { radius: 0.02, length: 0.2 }, 24, &[24, 14, 8, 4, 3])
        .part("glass", Torus { ring: 0.1, tube: 0.01 }, 4, &[48, 24, 12, 6, 0])
        .part("steel", Cylinder { radius: 0.008, height: 0.5 }, 6, &[12, 8, 4, 3, 0])
        .part("wood", Profile { corners: 4, size: [0.3, 0.06, 0.1] }, 4, &[1, 1, 1, 1, 1])
        .importance(1.25)
        .cost(1.5)
        .seen_to(18.0)
}

pub(super) fn lab_bench() -> Kind {
    Kind::new("lab bench", [3.0, 0.9, 0.8])
        .part("stone", RoundedBlock([3.0, 0.05, 0.8], 0.01), 1, &[4, 2, 1])
        .part("wood", RoundedBlock([0.7, 0.8, 0.7], 0.01), 4, &[4, 2, 1])
        .part("steel", Tube { radius: 0.015, length: 0.4 }, 6, &[20, 8, 0])
        .part("steel", Recess { depth: 0.2 }, 1, &[1, 1, 0])
        .seen_to(30.0)
}

pub(super) fn server_rack() -> Kind {
    Kind::new("server rack", [0.6, 2.0, 1.0])
        .part("steel", Block([0.6, 2.0, 1.0]), 1, &[1, 1, 1, 1])
        .trim("steel", RoundedBlock([0.48, 0.04, 0.05], 0.006), 40, &[4, 2, 1, 0], 0.05)
        .trim("light", Cylinder { radius: 0.004, height: 0.01 }, 80, &[10, 0, 0, 0], 0.01)
        .part("cable", Torus { ring: 0.15, tube: 0.006 }, 24, &[16, 8, 0, 0])
        .one_draw_from(2)
        .seen_to(30.0)
}

pub(super) fn theatre_seat() -> Kind {
    Kind::new("theatre seat", [0.6, 1.0, 0.7])
        .part("cloth", RoundedBlock([0.5, 0.12, 0.5], 0.05), 2, &[10, 6, 3, 1])
        .part("wood", RoundedBlock([0.06, 0.6, 0.5], 0.02), 2, &[6, 3, 2, 1])
        .part("steel", Cylinder { radius: 0.02, height: 0.3 }, 2, &[16, 8, 0, 0])
        .seen_to(36.0)
}

pub(super) fn whiteboard() -> Kind {
    Kind::new("whiteboard", [2.4, 1.8, 0.1])
        .part("enamel", RoundedBlock([2.4, 1.2, 0.03], 0.01), 1, &[4, 1])
        .part("steel", Cylinder { radius: 0.01, height: 0.12 }, 6, &[16, 0])
        .seen_to(28.0)
}

pub(super) fn coffee_machine() -> Kind {
    Kind::new("coffee machine", [0.5, 0.6, 0.5])
        .part("steel", RoundedBlock([0.5, 0.4, 0.45], 0.05), 2, &[9, 5, 2, 1])
        .part("chrome", Tube { radius: 0.012, length: 0.25 }, 4, &[24, 12, 5, 0])
        .part("chrome", Sphere { radius: 0.03 }, 6, &[24, 12, 6, 0])
        .part("chrome", Torus { ring: 0.05, tube: 0.008 }, 4, &[32, 14, 0, 0])
        .seen_to(20.0)
}

pub(super) fn grand_piano() -> Kind {
    Kind::new("grand piano", [1.5, 1.6, 2.2])
        .part("lacquer", Cylinder { radius: 0.75, height: 0.35 }, 1, &[128, 64, 28, 14, 7])
        .part("lacquer", RoundedBlock([1.4, 0.3, 1.2], 0.03), 2, &[9, 5, 3, 2, 1])
        .trim("ivory", RoundedBlock([0.022, 0.02, 0.15], 0.004), 88, &[4, 2, 1, 0, 0], 0.03)
        .trim("brass", Tube { radius: 0.002, length: 1.6 }, 230, &[8, 4, 0, 0, 0], 0.1)
        .part("lacquer", Cone { radius: 0.08, height: 0.7 }, 3, &[40, 20, 10, 6, 4])
        .part("brass", Torus { ring: 0.04, tube: 0.012 }, 3, &[32, 14, 6, 0, 0])
        .importance(1.5)
}
