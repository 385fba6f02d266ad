//! Kinds that stand in the streets of a city. Sizes in metres.

use super::foliage::{Crown, boughs};
use super::kind::Kind;
use super::model::Class::{LargeProp, SmallProp};
use super::place::{at, lattice, ring, row, strewn};
use super::solid::{cylinder, facade, field, hoop, lathe, rounded, sphere, torus, tube};

/// Body and cabin of rounded panels, wheels, lamps, mirrors, seats; along x.
fn car(name: &str, [length, height, width]: [f64; 3], seats: u32) -> Kind {
    Kind::new(name, LargeProp, [length, height, width], move |car| {
        let body = 0.52 * height;
        car.put("paint", rounded([length, body, width], 0.25, 16), [at(0.0, 0.28, 0.0)]);
        let cabin = rounded([0.58 * length, height - body, 0.88 * width], 0.3, 14);
        car.put("glass", cabin, [at(-0.06 * length, body, 0.0)]);
        let wheels = lattice(
            [2, 1, 2],
            [-0.31 * length, 0.36, 0.1 - width / 2.0],
            [0.31 * length, 0.36, width / 2.0 - 0.1],
        );
        let upright = || wheels.iter().map(|wheel| wheel.pitch(90.0));
        car.put("rubber", torus(0.27, 0.09, [40, 20]), upright());
        car.put("alloy", cylinder(0.24, 0.16, 48), upright().map(|wheel| wheel.by(0.0, -0.08, 0.0)));
        let lamps = lattice(
            [2, 1, 2],
            [0.05 - length / 2.0, 0.62, -0.36 * width],
            [length / 2.0 - 0.05, 0.62, 0.36 * width],
        );
        car.put("glass", sphere(0.1, 28), lamps);
        let rows = seats.div_ceil(3);
        let bench = |row: u32| {
            let along = 0.07 * length - 0.28 * length * f64::from(row) / f64::from(rows.max(2) - 1);
            row_of((seats - 3 * row).min(3), along, 0.3 * width)
        };
        car.put("cloth", rounded([0.45, 0.8, 0.45], 0.1, 8), (0..rows).flat_map(bench));
        car.put("cloth", torus(0.18, 0.02, [40, 20]), [at(0.3 * length, 0.85, 0.2 * width).roll(60.0)]);
        let mirrors = [-1.0, 1.0].map(|side| at(0.24 * length, body + 0.1, side * (width / 2.0 - 0.06)));
        car.put("paint", rounded([0.2, 0.14, 0.12], 0.04, 6), mirrors);
    })
    .seen_to(500.0)
}

/// Seats side by side.
fn row_of(count: u32, x: f64, reach: f64) -> Vec<super::place::Place> {
    row(count, [x, 0.32, -reach], [x, 0.32, reach])
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
    Kind::new("bus", LargeProp, [12.0, 3.2, 2.6], |bus| {
        bus.put("paint", rounded([12.0, 2.85, 2.46], 0.3, 14), [at(0.0, 0.35, 0.0)]);
        let panes = facade([10.8, 1.2], [9, 1], [1.05, 1.0], 0.05);
        bus.put("glass", panes, [0.0, 180.0].map(|turn| at(0.0, 1.5, 0.0).yaw(turn).by(0.0, 0.0, 1.29)));
        bus.put(
            "cloth",
            rounded([0.45, 1.0, 0.45], 0.1, 6),
            lattice([10, 1, 4], [-5.2, 0.6, -0.9], [4.2, 0.6, 0.9]),
        );
        let wheels =
            lattice([3, 1, 2], [-4.0, 0.5, -1.1], [4.0, 0.5, 1.1]).into_iter().map(|w| w.pitch(90.0));
        bus.put("rubber", torus(0.38, 0.12, [40, 20]), wheels);
        bus.put("steel", tube([0.02, 0.02], 2.1, 16), lattice([8, 1, 2], [-4.5, 0.8, -0.4], [4.5, 0.8, 0.4]));
    })
    .seen_to(700.0)
}

pub(super) fn street_lamp() -> Kind {
    Kind::new("street lamp", SmallProp, [1.8, 8.0, 0.4], |lamp| {
        lamp.put("steel", tube([0.1, 0.07], 7.2, 32), [at(-0.85, 0.0, 0.0)]);
        lamp.put("steel", hoop(0.75, 0.05, 180.0, [32, 16]), [at(-0.1, 7.2, 0.0).pitch(-90.0)]);
        lamp.put("steel", rounded([0.4, 0.3, 0.4], 0.08, 6), [at(0.65, 7.0, 0.0)]);
        lamp.put("glass", sphere(0.2, 32), [at(0.65, 6.98, 0.0)]);
    })
    .seen_to(350.0)
}

pub(super) fn traffic_light() -> Kind {
    Kind::new("traffic light", SmallProp, [0.3, 3.6, 0.5], |light| {
        light.put("steel", tube([0.08, 0.06], 3.5, 32), [at(0.0, 0.0, 0.0)]);
        let heads = [0.0, 180.0].map(|turn| at(0.0, 2.7, 0.0).yaw(turn));
        let lenses = || {
            let three = |head: super::place::Place| {
                row(3, [0.0, 0.15, 0.17], [0.0, 0.75, 0.17]).into_iter().map(move |lens| head.to(lens))
            };
            heads.into_iter().flat_map(three)
        };
        light.put("plastic", rounded([0.3, 0.9, 0.2], 0.05, 8), heads.map(|head| head.by(0.0, 0.0, 0.09)));
        light.put("glass", sphere(0.08, 28), lenses().map(|lens| lens.by(0.0, 0.0, -0.03)));
        light.put("plastic", tube([0.1, 0.1], 0.08, 24), lenses().map(|lens| lens.pitch(90.0)));
    })
    .importance(1.5)
    .seen_to(200.0)
}

pub(super) fn bench() -> Kind {
    Kind::new("bench", SmallProp, [1.8, 0.9, 0.7], |bench| {
        let seat = row(5, [0.0, 0.42, -0.16], [0.0, 0.44, 0.24]);
        let back = row(4, [0.0, 0.5, -0.23], [0.0, 0.85, -0.34]).into_iter().map(|slat| slat.pitch(75.0));
        let slats: Vec<_> = seat.into_iter().chain(back).collect();
        let bolts = slats.iter().flat_map(|slat| {
            row(4, [-0.7, 0.02, 0.0], [0.7, 0.02, 0.0]).into_iter().map(move |bolt| slat.to(bolt))
        });
        bench.put("iron", cylinder(0.008, 0.015, 10), bolts.collect::<Vec<_>>());
        bench.put("wood", rounded([1.8, 0.03, 0.09], 0.01, 4), slats);
        let hoops = lattice([2, 1, 2], [-0.7, 0.21, -0.12], [0.7, 0.21, 0.14]);
        bench.put("iron", torus(0.185, 0.025, [32, 16]), hoops.into_iter().map(|hoop| hoop.roll(90.0)));
    })
    .seen_to(120.0)
}

pub(super) fn bin() -> Kind {
    Kind::new("bin", SmallProp, [0.6, 1.0, 0.6], |bin| {
        let can = [[0.0, 0.0], [0.2, 0.0], [0.26, 0.9], [0.25, 0.9], [0.2, 0.1], [0.0, 0.1]];
        bin.put("steel", lathe(&can, 48), [at(0.0, 0.0, 0.0)]);
        bin.put("steel", torus(0.26, 0.03, [40, 20]), [at(0.0, 0.5, 0.0).scaled(0.93), at(0.0, 0.92, 0.0)]);
    })
    .seen_to(100.0)
}

pub(super) fn market_stall() -> Kind {
    Kind::new("market stall", SmallProp, [4.0, 3.0, 3.0], |stall| {
        let roof = |x: f64, z: f64| 2.9 - 0.2 * z * z + 0.02 * x;
        stall.put("cloth", field([4.0, 3.0], [24, 24], roof), [at(0.0, 0.0, 0.0)]);
        stall.put("wood", cylinder(0.04, 2.65, 20), lattice([3, 1, 2], [-1.8, 0.0, -1.0], [1.8, 0.0, 1.0]));
        let crates = lattice([6, 1, 3], [-1.6, 0.5, -0.1], [1.6, 0.7, 0.9]);
        let fruit = crates.iter().flat_map(|one| {
            strewn(13, [0.0, 0.22, 0.0], [0.22, 0.05, 0.13]).into_iter().map(move |f| one.to(f))
        });
        stall.put("fruit", sphere(0.05, 10), fruit.collect::<Vec<_>>());
        stall.put("wood", rounded([0.58, 0.25, 0.4], 0.02, 2), crates);
    })
    .seen_to(250.0)
}

pub(super) fn fountain() -> Kind {
    Kind::new("fountain", LargeProp, [14.0, 7.0, 14.0], |fountain| {
        fountain.put("stone", torus(6.5, 0.5, [128, 64]), [at(0.0, 0.5, 0.0)]);
        let bowls = [at(0.0, 2.6, 0.0), at(0.0, 4.6, 0.0).scaled(0.55)];
        fountain.put("stone", torus(2.5, 0.3, [96, 48]), bowls);
        let column = [
            [0.0, 0.0],
            [0.9, 0.0],
            [0.6, 1.0],
            [0.5, 2.2],
            [2.4, 2.6],
            [0.5, 2.5],
            [0.3, 4.2],
            [1.3, 4.55],
            [0.25, 4.5],
            [0.0, 6.0],
        ];
        fountain.put("stone", lathe(&column, 64), [at(0.0, 0.0, 0.0)]);
        let balls = ring(11, 4.5, 0.5).into_iter().chain([at(0.0, 6.4, 0.0)]);
        fountain.put("bronze", sphere(0.5, 36), balls);
        let ripple = |x: f64, z: f64| 0.05 * super::angle::sin_cos_deg(180.0 * (x * x + z * z).sqrt()).0;
        fountain.put("water", field([8.4, 8.4], [48, 48], ripple), [at(0.0, 0.55, 0.0)]);
    })
    .importance(2.0)
    .cost(1.5)
}

pub(super) fn street_tree() -> Kind {
    Kind::new("street tree", SmallProp, [6.0, 9.0, 6.0], |tree| {
        tree.put("bark", tube([0.2, 0.12], 4.5, 16), [at(0.0, 0.0, 0.0)]);
        boughs(tree, [11, 16], 0.1, [2.5, 4.4], ([0.0, 5.8, 0.0], [1.8, 1.8, 1.8]));
        let size = [0.25, 0.45];
        Crown { center: [0.0, 6.1, 0.0], radii: [2.4, 2.6, 2.4], segments: 24, leaves: 1600, size }.put(tree);
        for (x, z) in [(1.4, 0.3), (-0.4, 1.4), (-1.4, -0.2), (0.3, -1.4)] {
            Crown { center: [x, 5.4, z], radii: [1.35, 1.4, 1.35], segments: 16, leaves: 400, size }
                .put(tree);
        }
    })
}
