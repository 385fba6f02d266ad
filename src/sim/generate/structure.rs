//! Kinds that a building is built of. Sizes in metres.

use super::kind::Kind;
use super::model::Class::{LevelArchitecture, SmallProp};
use super::place::{at, between, lattice, pair, row};
use super::solid::{block, card, cylinder, facade, frustum, lathe, rounded, sphere, torus, tube};

pub(super) fn slab(side: f64) -> Kind {
    Kind::new("floor slab", LevelArchitecture, [side, 0.3, side], move |slab| {
        slab.put("concrete", block([side, 0.3, side]), [at(0.0, 0.0, 0.0)]);
    })
}

pub(super) fn wall(length: f64, height: f64) -> Kind {
    Kind::new("wall", LevelArchitecture, [length, height, 0.2], move |wall| {
        wall.put("plaster", block([length, height, 0.17]), [at(0.0, 0.0, 0.0)]);
        wall.put("wood", rounded([length, 0.1, 0.02], 0.008, 2), [-0.09, 0.09].map(|z| at(0.0, 0.0, z)));
    })
}

/// Three windows that are seen from both sides.
pub(super) fn window_wall(length: f64, height: f64) -> Kind {
    Kind::new("window wall", LevelArchitecture, [length, height, 0.26], move |wall| {
        let side = facade([length, height], [3, 1], [1.6, 1.6], 0.06);
        wall.put(
            "plaster",
            side.at([at(0.0, 0.0, 0.12), at(0.0, 0.0, -0.12).yaw(180.0)]),
            [at(0.0, 0.0, 0.0)],
        );
        wall.put("plaster", block([length, height, 0.1]), [at(0.0, 0.0, 0.0)]);
        let windows = row(3, [-length / 3.0, height / 2.0, 0.09], [length / 3.0, height / 2.0, 0.09]);
        let bars = [-0.77, 0.0, 0.77]
            .map(|off| [at(0.0, off - 0.03, 0.0), at(off + 0.03, 0.0, 0.0).roll(90.0).scaled(0.97)]);
        let frames = windows.iter().flat_map(|window| bars.as_flattened().iter().map(|bar| window.to(*bar)));
        wall.put("frame", rounded([1.6, 0.06, 0.06], 0.01, 2), frames);
        let handles =
            windows.iter().flat_map(|window| pair(0.06, 0.05, 0.03).map(|handle| window.to(handle)));
        wall.put("steel", cylinder(0.012, 0.12, 16), handles);
    })
}

pub(super) fn door_wall(length: f64, height: f64) -> Kind {
    Kind::new("door wall", LevelArchitecture, [length, height, 0.2], move |wall| {
        let beside = (length - 0.9) / 2.0;
        wall.put("plaster", block([beside, height, 0.16]), pair((length - beside) / 2.0, 0.0, 0.0));
        wall.put("plaster", block([1.0, height - 2.1, 0.15]), [at(0.0, 2.1, 0.0)]);
        wall.put("wood", rounded([0.88, 2.08, 0.05], 0.01, 3), [at(0.0, 0.01, 0.0)]);
        wall.put("wood", rounded([0.1, 2.2, 0.2], 0.02, 3), pair(0.49, 0.0, 0.0));
        wall.put("wood", rounded([1.1, 0.1, 0.19], 0.02, 3), [at(0.0, 2.11, 0.0)]);
        let knobs = [-0.05, 0.05].map(|z| at(0.36, 1.05, z).pitch(90.0));
        wall.put("steel", torus(0.05, 0.01, [24, 12]), knobs);
        let hinges = [0.25, 1.0, 1.75].map(|y| pair(0.44, y, 0.04));
        wall.put("steel", cylinder(0.012, 0.1, 16), hinges.into_iter().flatten());
    })
}

pub(super) fn railing(length: f64) -> Kind {
    Kind::new("railing", LevelArchitecture, [length, 1.1, 0.07], move |railing| {
        let end = length / 2.0;
        let along = |count, y, end: f64| row(count, [-end, y, 0.0], [end, y, 0.0]);
        railing.put("steel", cylinder(0.012, 1.04, 16), along(40, 0.0, end - 0.05));
        railing.put("steel", sphere(0.03, 12), along(40, 0.55, end - 0.05));
        railing.put("steel", block([length, 0.02, 0.02]), row(6, [0.0, 0.1, 0.0], [0.0, 0.95, 0.0]));
        railing.put("wood", cylinder(0.035, 1.0, 24), [between([-end, 1.065, 0.0], [end, 1.065, 0.0])]);
    })
}

/// Twelve metres long, four metres up.
pub(super) fn stairs() -> Kind {
    Kind::new("stairs", LevelArchitecture, [2.4, 5.0, 12.0], |stairs| {
        let steps = |x: f64, y: f64, z: f64| row(24, [x, y, -5.75 + z], [x, y + 3.82, 5.75 + z]);
        stairs.put("concrete", block([2.4, 0.18, 0.52]), steps(0.0, 0.0, 0.0));
        stairs.put("rubber", rounded([2.36, 0.03, 0.06], 0.012, 3), steps(0.0, 0.155, -0.22));
        stairs.put("steel", cylinder(0.02, 0.84, 16), [-1.12, 1.12].map(|x| steps(x, 0.12, 0.0)).concat());
        let rails = [-1.12, 1.12].map(|x| between([x, 0.96, -5.9], [x, 4.86, 5.9]));
        stairs.put("wood", cylinder(0.035, 1.0, 24), rails);
    })
}

pub(super) fn column() -> Kind {
    Kind::new("column", LevelArchitecture, [0.8, 4.0, 0.8], |column| {
        let shaft = [[0.3, 0.2], [0.3, 1.2], [0.285, 2.2], [0.26, 3.3], [0.25, 3.8]];
        column.put("stone", lathe(&shaft, 48), [at(0.0, 0.0, 0.0)]);
        let rings = [at(0.0, 0.28, 0.0), at(0.0, 3.45, 0.0).scaled(0.85), at(0.0, 3.73, 0.0)];
        column.put("stone", torus(0.3, 0.08, [48, 24]), rings);
        column.put("stone", rounded([0.8, 0.2, 0.8], 0.04, 4), [at(0.0, 0.0, 0.0), at(0.0, 3.8, 0.0)]);
    })
}

pub(super) fn pendant_lamp() -> Kind {
    Kind::new("pendant lamp", SmallProp, [0.6, 1.0, 0.6], |lamp| {
        lamp.put("glass", sphere(0.2, 40), [at(0.0, 0.2, 0.0)]);
        lamp.put("steel", frustum([0.3, 0.03], 0.2, 48), [at(0.0, 0.28, 0.0)]);
        lamp.put("steel", cylinder(0.01, 0.54, 12), [at(0.0, 0.46, 0.0)]);
    })
    .seen_to(30.0)
}

/// The hero of the atrium: a cloud of rings and spheres on strings, 50 000 triangles.
pub(super) fn mobile() -> Kind {
    Kind::new("mobile", SmallProp, [5.4, 9.0, 5.4], |mobile| {
        let hung = |i: u32| {
            let (turn, out, up) = (137.5 * f64::from(i), 0.7 + 0.07 * f64::from(i), 0.25 * f64::from(i));
            at(0.0, up + 0.56, 0.0).yaw(turn).by(0.0, 0.0, out)
        };
        let (rings, balls): (Vec<u32>, Vec<u32>) = (0..28).partition(|i| [0, 2, 5].contains(&(i % 7)));
        mobile.put("brass", torus(0.5, 0.06, [48, 24]), rings.iter().map(|&i| hung(i).pitch(70.0)));
        mobile.put("glass", sphere(0.3, 36), balls.iter().map(|&i| hung(i)));
        let strings = (0..28).map(|i| {
            let end = hung(i).apply(glam::DVec3::ZERO);
            between(end.to_array(), [0.2 * end.x, 8.98, 0.2 * end.z])
        });
        mobile.put("steel", tube([0.01, 0.01], 1.0, 12), strings);
        mobile.put("steel", cylinder(0.6, 0.04, 24), [at(0.0, 8.96, 0.0)]);
    })
    .importance(2.0)
}

pub(super) fn whiteboard() -> Kind {
    Kind::new("whiteboard", SmallProp, [2.4, 1.8, 0.078], |board| {
        board.put("enamel", rounded([2.4, 1.2, 0.03], 0.01, 3), [at(0.0, 0.6, 0.0)]);
        board.put("enamel", card([2.3, 1.1]), [at(0.0, 0.65, 0.016)]);
        board.put("steel", cylinder(0.02, 0.62, 16), pair(1.1, 0.0, 0.0));
        let pens = row(4, [-0.6, 0.63, 0.03], [0.6, 0.63, 0.03]);
        board.put("steel", cylinder(0.01, 0.12, 16), pens.into_iter().map(|pen| pen.roll(90.0)));
    })
    .seen_to(28.0)
}

pub(super) fn lab_bench() -> Kind {
    Kind::new("lab bench", SmallProp, [3.0, 0.9, 0.8], |bench| {
        bench.put("stone", rounded([3.0, 0.05, 0.8], 0.01, 3), [at(0.0, 0.85, 0.0)]);
        let cabinets = row(4, [-1.125, 0.02, 0.0], [1.125, 0.02, 0.0]);
        bench.put("wood", rounded([0.7, 0.82, 0.7], 0.01, 3), cabinets);
        bench.put(
            "steel",
            cylinder(0.015, 0.84, 20),
            lattice([3, 1, 2], [-0.75, 0.01, -0.36], [0.75, 0.01, 0.3]),
        );
        bench.put("steel", block([2.8, 0.06, 0.5]), [at(0.0, 0.0, 0.0)]);
    })
    .seen_to(30.0)
}

pub(super) fn server_rack() -> Kind {
    Kind::new("server rack", SmallProp, [0.6, 2.0, 1.0], |rack| {
        rack.put("steel", block([0.58, 2.0, 0.94]), [at(0.0, 0.0, 0.0)]);
        rack.put(
            "steel",
            rounded([0.48, 0.04, 0.05], 0.006, 3),
            row(40, [0.0, 0.05, 0.46], [0.0, 1.91, 0.46]),
        );
        let lights = lattice([2, 40, 1], [0.17, 0.07, 0.48], [0.2, 1.93, 0.48]);
        rack.put("light", cylinder(0.004, 0.012, 10), lights.into_iter().map(|light| light.pitch(90.0)));
        let cables = lattice([2, 12, 1], [-0.1, 0.2, -0.485], [0.1, 1.8, -0.47]);
        rack.put("cable", torus(0.15, 0.006, [16, 8]), cables.into_iter().map(|cable| cable.pitch(90.0)));
    })
    .seen_to(30.0)
}

pub(super) fn filing_cabinet() -> Kind {
    Kind::new("filing cabinet", SmallProp, [0.5, 1.3, 0.6], |cabinet| {
        let drawers = |z: f64, up: f64| row(4, [0.0, 0.005 + up, z], [0.0, 0.98 + up, z]);
        cabinet.put("steel", rounded([0.5, 0.315, 0.54], 0.01, 4), drawers(-0.02, 0.0));
        cabinet.put("chrome", torus(0.05, 0.008, [24, 12]), drawers(0.24, 0.16));
        let locks = drawers(0.245, 0.26).into_iter().map(|lock| lock.by(0.18, 0.0, 0.0).pitch(90.0));
        cabinet.put("chrome", cylinder(0.01, 0.01, 16), locks);
        cabinet.put("steel", block([0.44, 0.02, 0.48]), [at(0.0, 0.0, 0.0)]);
    })
    .seen_to(28.0)
}
