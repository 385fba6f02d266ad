//! Kinds for a festival: the crowd, and what it came for. Sizes in metres.

use super::angle::sin_cos_deg;
use super::foliage::loose;
use super::kind::Kind;
use super::model::Assembly;
use super::model::Class::{Character, SmallProp};
use super::place::{Place, at, between, corners, lattice, pair, ring, row, strewn};
use super::solid::{block, capsule, card, cylinder, field, frustum, prism, rounded, sphere, torus, tube};

/// Skinned: dearer than its triangles say, and worth more than a tree. Folds are those of the dress.
pub(super) fn person(name: &str, dress: &'static str, folds: u32) -> Kind {
    Kind::new(name, Character, [0.74, 1.77, 0.36], move |person| {
        person.put("skin", sphere(1.0, 40), [at(0.0, 1.61, 0.0).stretched([0.105, 0.135, 0.115])]);
        person.put("hair", sphere(0.12, 28), [at(0.0, 1.65, -0.025)]);
        person.put(dress, rounded([0.42, 0.62, 0.24], 0.1, 13), [at(0.0, 0.86, 0.0)]);
        let fold = |i: u32| {
            at(0.0, 0.92 - 0.05 * f64::from(i), 0.0).stretched([1.0 + 0.04 * f64::from(i), 1.0, 0.7])
        };
        person.put(dress, torus(0.22, 0.02, [32, 16]), (0..folds).map(fold));
        person.put(dress, capsule(0.07, 1.0, 12), limbs());
        let fingers = hands().into_iter().flat_map(|hand| {
            row(10, [-0.04, -0.1, 0.0], [0.04, -0.1, 0.0]).into_iter().map(move |f| hand.to(f))
        });
        person.put("skin", cylinder(0.008, 0.1, 13), fingers);
        person.put("leather", rounded([0.1, 0.1, 0.28], 0.04, 8), pair(0.11, 0.0, 0.04));
    })
    .importance(1.5)
    .cost(2.0)
    .seen_to(60.0)
}

/// Thighs and shins, upper arms and forearms.
fn limbs() -> impl Iterator<Item = Place> {
    let bones = |side: f64| {
        let [hip, knee, heel] = [[0.1, 0.95, 0.0], [0.11, 0.5, 0.02], [0.11, 0.06, 0.0]];
        let [shoulder, elbow, wrist] = [[0.22, 1.42, 0.0], [0.28, 1.14, 0.0], [0.3, 0.86, 0.08]];
        let sided = move |[x, y, z]: [f64; 3]| [side * x, y, z];
        [(hip, knee), (knee, heel), (shoulder, elbow), (elbow, wrist)]
            .map(|(a, b)| between(sided(b), sided(a)))
    };
    [-1.0, 1.0].into_iter().flat_map(bones)
}

fn hands() -> [Place; 2] {
    pair(0.305, 0.87, 0.085)
}

/// The singer: everything that a close-up asks for, 50 000 triangles.
pub(super) fn singer() -> Kind {
    Kind::new("singer", SmallProp, [0.77, 1.82, 0.64], |singer| {
        singer.put("skin", sphere(1.0, 96), [at(0.0, 1.62, 0.0).stretched([0.105, 0.14, 0.115])]);
        hair(singer, [0.0, 1.67, -0.03], [0.125, 0.125, 0.12]);
        hair(singer, [0.0, 1.4, -0.14], [0.16, 0.3, 0.06]);
        singer.put("silk", rounded([0.4, 0.64, 0.24], 0.11, 23), [at(0.0, 0.84, 0.0)]);
        let fold = |i: u32| {
            at(0.0, 0.9 - 0.11 * f64::from(i), 0.0).stretched([
                1.0 + 0.12 * f64::from(i),
                1.6,
                0.75 + 0.12 * f64::from(i),
            ])
        };
        singer.put("silk", torus(0.23, 0.03, [40, 20]), (0..5).map(fold));
        singer.put("silk", capsule(0.065, 1.0, 16), limbs());
        let joints = hands().into_iter().flat_map(|hand| {
            lattice([5, 3, 1], [-0.035, -0.1, 0.0], [0.035, -0.03, 0.02]).into_iter().map(move |f| hand.to(f))
        });
        singer.put("skin", cylinder(0.008, 0.036, 28), joints);
        singer.put("steel", sphere(0.012, 12), ring(26, 0.11, 1.46));
        singer.put("steel", torus(0.03, 0.006, [24, 12]), row(4, [0.305, 0.8, 0.12], [0.305, 0.86, 0.12]));
        singer.put("leather", rounded([0.1, 0.1, 0.28], 0.04, 8), pair(0.11, 0.0, 0.04));
    })
    .importance(4.0)
    .cost(2.5)
}

fn hair(singer: &mut Assembly, center: [f64; 3], radii: [f64; 3]) {
    let [x, y, z] = center;
    singer.put("hair", sphere(1.0, 48), [at(x, y, z).stretched(radii)]);
    let locks = strewn(3500, center, radii).into_iter().enumerate();
    singer.put("hair", card([0.008, 0.03]), locks.map(|(i, lock)| loose(lock, i)));
}

pub(super) fn tent() -> Kind {
    Kind::new("tent", SmallProp, [4.0, 2.4, 4.0], |tent| {
        let canvas = |x: f64, z: f64| 2.3 * (1.0 - x.abs() / 2.0) * (1.0 - z.abs() / 2.0) + 0.05;
        tent.put("canvas", field([3.9, 3.9], [28, 28], canvas), [at(0.0, 0.0, 0.0)]);
        let ropes = ring(12, 1.9, 0.0).into_iter().map(|peg| {
            let peg = peg.apply(glam::DVec3::ZERO);
            between([peg.x, 0.02, peg.z], [0.3 * peg.x, 1.7, 0.3 * peg.z])
        });
        tent.put("rope", tube([0.01, 0.01], 1.0, 8), ropes);
        tent.put("wood", cylinder(0.03, 2.2, 20), [at(0.0, 0.0, 0.0)]);
        tent.put("wood", cylinder(0.03, 1.2, 20), pair(0.9, 0.0, 0.0));
    })
}

pub(super) fn lantern() -> Kind {
    Kind::new("lantern", SmallProp, [0.6, 3.0, 0.6], |lantern| {
        lantern.put("wood", cylinder(0.05, 2.6, 24), [at(0.0, 0.0, 0.0)]);
        lantern.put("paper", sphere(0.27, 40), [at(0.0, 2.72, 0.0)]);
    })
    .seen_to(250.0)
}

pub(super) fn stage() -> Kind {
    Kind::new("stage", SmallProp, [20.0, 10.0, 12.0], |stage| {
        stage.put("wood", block([20.0, 1.4, 12.0]), [at(0.0, 0.0, 0.0)]);
        let lines = [-5.5, -2.75, 0.0, 2.75, 5.5];
        let chords = [[9.4, 0.0], [9.4, 0.5], [9.85, 0.25]];
        let chord =
            |z: f64| chords.map(|[y, off]| between([-9.7, y, z + off - 0.25], [9.7, y, z + off - 0.25]));
        stage.put("steel", tube([0.06, 0.06], 1.0, 20), lines.map(chord).concat());
        stage.put("steel", tube([0.12, 0.12], 8.2, 20), corners(9.6, 1.3, 5.5));
        stage.put("steel", tube([0.03, 0.03], 1.0, 12), lines.into_iter().flat_map(|z| lacing(&chords, z)));
        let lamps = lattice([8, 1, 5], [-8.0, 9.0, -5.5], [8.0, 9.0, 5.5]);
        stage.put("light", frustum([0.25, 0.1], 0.4, 36), lamps);
        let towers = [-9.0, 9.0].map(|x| row(8, [x, 1.4, 5.3], [x, 8.0, 5.3]));
        stage.put("plastic", rounded([1.0, 0.92, 0.9], 0.06, 5), towers.concat());
        let waves = |x: f64, z: f64| 0.25 * sin_cos_deg(80.0 * x).0 + 0.03 * z;
        stage.put("cloth", field([18.0, 7.6], [40, 40], waves), [at(0.0, 5.4, -5.5).pitch(90.0)]);
    })
    .importance(1.5)
}

/// The diagonals of a truss: sixty from chord to chord along each of its three sides.
fn lacing(chords: &[[f64; 2]; 3], z: f64) -> Vec<Place> {
    let end = |corner: usize, bay: usize| {
        let [y, off] = chords[corner % 3];
        [19.4 * (bay as f64 / 60.0 - 0.5), y, z + off - 0.25]
    };
    let strut = |side: usize, bay: usize| between(end(side + bay % 2, bay), end(side + 1 - bay % 2, bay + 1));
    (0..3).flat_map(|side| (0..60).map(move |bay| (side, bay))).map(|(side, bay)| strut(side, bay)).collect()
}

pub(super) fn food_stall() -> Kind {
    Kind::new("food stall", SmallProp, [5.0, 3.2, 3.0], |stall| {
        stall.put("wood", block([4.8, 1.0, 0.9]), [at(0.0, 0.0, 0.9)]);
        stall.put("wood", block([4.8, 2.4, 0.08]), [at(0.0, 0.0, -1.3)]);
        stall.put("wood", cylinder(0.05, 2.7, 20), corners(2.3, 0.0, 1.2));
        let roof = |x: f64, z: f64| 0.12 * sin_cos_deg(144.0 * x).0 + 0.35 - 0.15 * z * z;
        stall.put("cloth", field([5.0, 3.0], [20, 20], roof), [at(0.0, 2.7, 0.0)]);
        let crates = lattice([8, 3, 1], [-2.0, 0.1, -0.9], [2.0, 1.1, -0.9]);
        stall.put("wood", rounded([0.5, 0.3, 0.4], 0.03, 3), crates);
        stall.put("steel", cylinder(0.15, 0.3, 40), row(8, [-2.0, 1.0, 0.9], [2.0, 1.0, 0.9]));
        let gable = [[-1.2, 0.0], [1.2, 0.0], [0.0, -0.5]];
        stall.put("wood", prism(&gable, 0.05), [at(0.0, 2.3, 1.4).pitch(90.0)]);
    })
}

pub(super) fn bench() -> Kind {
    Kind::new("log bench", SmallProp, [2.2, 0.5, 0.4], |bench| {
        bench.put("wood", cylinder(0.2, 1.0, 40), [between([-1.1, 0.3, 0.0], [1.1, 0.3, 0.0])]);
        bench.put(
            "wood",
            cylinder(0.15, 1.0, 32),
            [-0.7, 0.7].map(|x| between([x, 0.15, -0.2], [x, 0.15, 0.2])),
        );
    })
    .seen_to(150.0)
}
