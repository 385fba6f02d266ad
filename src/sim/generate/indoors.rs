//! Kinds that stand in the rooms of a building. Sizes in metres.

use super::foliage::{Crown, boughs};
use super::kind::Kind;
use super::model::Class::SmallProp;
use super::place::{at, between, corners, even_unit, lattice, pair, ring, row};
use super::solid::{block, cylinder, field, frustum, lathe, prism, rounded, sphere, torus, tube};

pub(super) fn planter() -> Kind {
    Kind::new("planter", SmallProp, [1.8, 2.6, 1.8], |planter| {
        let pot = [[0.0, 0.0], [0.34, 0.0], [0.47, 0.6], [0.43, 0.6], [0.42, 0.5]];
        planter.put("clay", lathe(&pot, 48), [at(0.0, 0.0, 0.0)]);
        planter.put("clay", torus(0.45, 0.04, [48, 24]), [at(0.0, 0.58, 0.0)]);
        planter.put(
            "soil",
            field([0.62, 0.62], [12, 12], |x, z| 0.06 - 0.15 * (x * x + z * z)),
            [at(0.0, 0.48, 0.0)],
        );
        let stems = ring(3, 0.15, 0.4).into_iter().map(|stem| stem.pitch(4.0));
        planter.put("bark", tube([0.06, 0.03], 1.4, 20), stems);
        boughs(planter, [8, 8], 0.02, [1.2, 1.6], ([0.0, 1.75, 0.0], [0.5, 0.5, 0.5]));
        let crown = Crown {
            center: [0.0, 1.8, 0.0],
            radii: [0.8, 0.72, 0.8],
            segments: 32,
            leaves: 2500,
            size: [0.07, 0.14],
        };
        crown.put(planter);
    })
    .seen_to(45.0)
}

pub(super) fn office_chair() -> Kind {
    Kind::new("office chair", SmallProp, [0.62, 1.1, 0.63], |chair| {
        chair.put("cloth", rounded([0.5, 0.1, 0.5], 0.04, 11), [at(0.0, 0.46, 0.03)]);
        chair.put("cloth", rounded([0.46, 0.5, 0.09], 0.04, 11), [at(0.0, 0.6, -0.22).pitch(-6.0)]);
        let arms = pair(0.28, 0.62, 0.0).map(|arm| arm.roll(90.0).stretched([1.0, 1.0, 1.4]));
        chair.put("plastic", torus(0.12, 0.02, [32, 16]), arms);
        let legs = ring(5, 0.16, 0.07).into_iter().map(|leg| leg.yaw(90.0));
        chair.put("plastic", rounded([0.3, 0.04, 0.05], 0.015, 5), legs);
        let castors =
            ring(5, 0.28, 0.035).into_iter().flat_map(|leg| pair(0.02, 0.0, 0.0).map(|c| leg.to(c)));
        chair.put("plastic", sphere(0.035, 20), castors);
        chair.put("steel", cylinder(0.03, 0.4, 32), [at(0.0, 0.08, 0.0)]);
        chair.put("steel", cylinder(0.025, 0.3, 32), [at(0.0, 0.44, -0.2).pitch(-4.0)]);
    })
    .seen_to(28.0)
}

pub(super) fn desk() -> Kind {
    Kind::new("desk", SmallProp, [1.6, 0.75, 0.8], |desk| {
        desk.put("wood", rounded([1.6, 0.04, 0.8], 0.01, 4), [at(0.0, 0.71, 0.0)]);
        desk.put("steel", rounded([0.05, 0.71, 0.05], 0.01, 4), corners(0.74, 0.0, 0.35));
        desk.put("wood", rounded([0.4, 0.18, 0.5], 0.01, 3), row(3, [0.48, 0.13, 0.0], [0.48, 0.52, 0.0]));
        desk.put("steel", torus(0.05, 0.006, [24, 12]), row(3, [0.48, 0.22, 0.25], [0.48, 0.61, 0.25]));
    })
    .seen_to(28.0)
}

/// Over a hundred keys with rounded edges: small, and dear.
pub(super) fn computer() -> Kind {
    Kind::new("computer", SmallProp, [0.74, 0.58, 0.44], |computer| {
        let keys = lattice([26, 1, 4], [-0.34, 0.015, 0.1], [0.16, 0.015, 0.16]);
        computer.put("plastic", rounded([0.018, 0.012, 0.018], 0.004, 3), keys);
        computer.put("plastic", rounded([0.56, 0.02, 0.13], 0.008, 5), [at(-0.09, 0.0, 0.13)]);
        computer.put("plastic", sphere(0.05, 32), [at(0.34, 0.025, 0.14).stretched([0.65, 0.5, 1.0])]);
        computer.put("screen", rounded([0.7, 0.4, 0.03], 0.01, 6), [at(0.0, 0.18, -0.1).pitch(-4.0)]);
        computer.put("steel", cylinder(0.03, 0.3, 32), [at(0.0, 0.01, -0.15)]);
        computer.put("steel", cylinder(0.12, 0.015, 32), [at(0.0, 0.0, -0.12)]);
    })
    .seen_to(16.0)
}

pub(super) fn desk_lamp() -> Kind {
    Kind::new("desk lamp", SmallProp, [0.42, 0.57, 0.2], |lamp| {
        let joints = [[-0.1, 0.03, 0.0], [-0.17, 0.3, 0.0], [0.02, 0.55, 0.0], [0.07, 0.51, 0.0]];
        let arms = joints.windows(2).map(|pair| between(pair[0], pair[1]));
        lamp.put("paint", cylinder(0.1, 0.03, 48), [at(-0.1, 0.0, 0.0)]);
        lamp.put("paint", cylinder(0.01, 1.0, 20), arms);
        lamp.put("paint", sphere(0.02, 20), joints[1..].iter().map(|&[x, y, z]| at(x, y, z)));
        let shade = [[0.1, -0.14], [0.03, 0.0], [0.0, 0.0], [0.028, -0.003], [0.097, -0.14], [0.1, -0.14]];
        lamp.put("paint", lathe(&shade, 48), [at(0.08, 0.5, 0.0).roll(20.0)]);
        lamp.put("glass", sphere(0.04, 24), [at(0.08, 0.5, 0.0).roll(20.0).by(0.0, -0.08, 0.0)]);
    })
    .seen_to(16.0)
}

pub(super) fn shelf_of_books() -> Kind {
    Kind::new("shelf of books", SmallProp, [1.2, 2.1, 0.35], |shelf| {
        shelf.put("wood", rounded([1.16, 0.03, 0.34], 0.006, 2), row(6, [0.0, 0.03, 0.0], [0.0, 2.06, 0.0]));
        shelf.put("wood", rounded([0.03, 2.1, 0.35], 0.006, 2), pair(0.585, 0.0, 0.0));
        let books = lattice([36, 5, 1], [-0.545, 0.058, 0.04], [0.545, 1.682, 0.04]);
        let heights = books
            .into_iter()
            .enumerate()
            .map(|(i, book)| book.stretched([1.0, 0.8 + 0.45 * even_unit(i), 0.85 + 0.3 * even_unit(3 * i)]));
        shelf.put("paper", rounded([0.03, 0.26, 0.2], 0.008, 2), heights);
    })
    .seen_to(26.0)
}

pub(super) fn sofa() -> Kind {
    Kind::new("sofa", SmallProp, [2.1, 0.85, 0.95], |sofa| {
        sofa.put("cloth", rounded([0.88, 0.28, 0.8], 0.08, 11), pair(0.44, 0.15, 0.06));
        sofa.put("cloth", rounded([0.88, 0.5, 0.26], 0.08, 11), pair(0.44, 0.35, -0.33));
        sofa.put("cloth", rounded([0.2, 0.5, 0.93], 0.08, 11), pair(0.94, 0.11, 0.0));
        sofa.put("wood", cylinder(0.03, 0.14, 20), corners(0.92, 0.0, 0.38));
    })
    .seen_to(32.0)
}

pub(super) fn round_table() -> Kind {
    Kind::new("round table", SmallProp, [1.2, 0.75, 1.2], |table| {
        table.put("wood", cylinder(0.58, 0.03, 96), [at(0.0, 0.72, 0.0)]);
        table.put("wood", torus(0.58, 0.016, [64, 32]), [at(0.0, 0.734, 0.0)]);
        table.put("steel", cylinder(0.05, 0.7, 40), [at(0.0, 0.03, 0.0)]);
        table.put("steel", frustum([0.3, 0.06], 0.05, 64), [at(0.0, 0.0, 0.0)]);
    })
    .seen_to(28.0)
}

pub(super) fn crockery() -> Kind {
    Kind::new("crockery", SmallProp, [0.47, 0.15, 0.45], |crockery| {
        let stacks = |low: f64, high: f64| {
            ring(3, 0.135, low).into_iter().flat_map(move |s| [s, s.by(0.0, high - low, 0.0)])
        };
        let plate = [[0.0, 0.0], [0.06, 0.0], [0.1, 0.014], [0.1, 0.018], [0.058, 0.005], [0.0, 0.005]];
        let cup = [[0.0, 0.0], [0.028, 0.0], [0.04, 0.06], [0.037, 0.06], [0.025, 0.005], [0.0, 0.005]];
        crockery.put("china", lathe(&plate, 36), stacks(0.0, 0.025));
        crockery.put("china", torus(0.1, 0.008, [36, 16]), stacks(0.016, 0.041));
        crockery.put("china", lathe(&cup, 36), stacks(0.035, 0.09));
        let handles = stacks(0.065, 0.12).map(|cup| cup.yaw(40.0).by(0.0, 0.0, 0.05).roll(90.0));
        crockery.put("china", torus(0.02, 0.005, [20, 10]), handles);
    })
    .seen_to(12.0)
}

/// Flasks, tubes and rings on a bench: what makes a laboratory dense.
pub(super) fn glassware() -> Kind {
    Kind::new("glassware", SmallProp, [1.3, 0.5, 0.42], |glass| {
        let flasks = |y: f64| row(6, [-0.55, y, 0.14], [0.55, y, 0.14]);
        glass.put("glass", sphere(0.08, 32), flasks(0.08));
        glass.put("glass", tube([0.02, 0.025], 0.12, 24), flasks(0.15));
        let vials = row(18, [-0.62, 0.03, -0.15], [0.62, 0.03, -0.15]);
        glass.put("glass", tube([0.02, 0.02], 0.2, 24), vials);
        glass.put("wood", block([0.3, 0.06, 0.1]), row(4, [-0.5, 0.0, -0.15], [0.5, 0.0, -0.15]));
        glass.put("steel", cylinder(0.008, 0.5, 12), row(6, [-0.55, 0.0, 0.02], [0.55, 0.0, 0.02]));
        glass.put("glass", torus(0.09, 0.01, [48, 24]), row(4, [-0.33, 0.3, 0.12], [0.33, 0.36, 0.12]));
    })
    .importance(1.25)
    .cost(1.5)
    .seen_to(18.0)
}

pub(super) fn theatre_seat() -> Kind {
    Kind::new("theatre seat", SmallProp, [0.6, 1.0, 0.7], |seat| {
        seat.put("cloth", rounded([0.5, 0.12, 0.5], 0.05, 9), [at(0.0, 0.38, 0.08)]);
        seat.put("cloth", rounded([0.5, 0.56, 0.12], 0.05, 9), [at(0.0, 0.44, -0.2).pitch(-10.0)]);
        seat.put("wood", rounded([0.05, 0.6, 0.5], 0.02, 5), pair(0.27, 0.05, 0.05));
        seat.put("steel", cylinder(0.02, 0.4, 16), pair(0.2, 0.0, -0.1));
    })
    .seen_to(36.0)
}

pub(super) fn coffee_machine() -> Kind {
    Kind::new("coffee machine", SmallProp, [0.5, 0.58, 0.45], |machine| {
        machine.put("steel", rounded([0.5, 0.14, 0.45], 0.05, 8), [at(0.0, 0.0, 0.0)]);
        machine.put("steel", rounded([0.5, 0.24, 0.4], 0.05, 8), [at(0.0, 0.34, -0.02)]);
        machine.put("steel", block([0.44, 0.3, 0.16]), [at(0.0, 0.1, -0.12)]);
        machine.put("chrome", tube([0.012, 0.012], 0.1, 24), row(4, [-0.15, 0.26, 0.08], [0.15, 0.26, 0.08]));
        machine.put("chrome", sphere(0.03, 24), row(6, [-0.18, 0.46, 0.18], [0.18, 0.46, 0.18]));
        machine.put("chrome", torus(0.05, 0.008, [32, 16]), row(4, [-0.15, 0.26, 0.08], [0.15, 0.26, 0.08]));
    })
    .seen_to(20.0)
}

pub(super) fn grand_piano() -> Kind {
    Kind::new("grand piano", SmallProp, [1.5, 1.6, 2.2], |piano| {
        piano.put("lacquer", prism(&piano_outline(), 0.3), [at(0.0, 0.66, 0.0)]);
        piano.put(
            "lacquer",
            prism(&piano_outline(), 0.03),
            [at(-0.7, 0.97, 0.0).roll(24.0).by(0.7, 0.0, 0.0)],
        );
        piano.put("lacquer", rounded([1.44, 0.1, 0.28], 0.03, 8), [at(0.0, 0.6, 0.94)]);
        piano.put("lacquer", rounded([1.4, 0.25, 0.03], 0.01, 8), [at(0.0, 0.97, 0.4).pitch(-12.0)]);
        piano.put(
            "ivory",
            rounded([0.0145, 0.02, 0.15], 0.004, 3),
            row(88, [-0.68, 0.69, 0.98], [0.68, 0.69, 0.98]),
        );
        let strings = (0..230).map(|i| {
            let t = f64::from(i) / 230.0;
            between([-0.62 + 1.2 * t, 0.967, 0.6], [-0.62 + 1.15 * t, 0.967, -0.92 + 1.15 * t])
        });
        piano.put("brass", tube([0.002, 0.002], 1.0, 8), strings);
        let feet = |y: f64| [at(-0.6, y, 0.8), at(0.6, y, 0.8), at(-0.5, y, -0.75)];
        piano.put("lacquer", frustum([0.045, 0.08], 0.62, 40), feet(0.05));
        piano.put("brass", torus(0.04, 0.012, [32, 16]), feet(0.052).map(|foot| foot.roll(90.0)));
    })
    .importance(1.5)
}

/// Straight at the keys and along the bass, bent along the treble; from above.
fn piano_outline() -> Vec<[f64; 2]> {
    let bend = (0..=36).map(|i| {
        let t = f64::from(i) / 36.0;
        [0.72 - 1.02 * t * t * (3.0 - 2.0 * t), 0.2 - 1.25 * t]
    });
    let front = [[-0.72, 0.82], [0.72, 0.82]];
    let tail = [[-0.45, -1.09], [-0.62, -1.06], [-0.72, -0.92]];
    front.into_iter().chain(bend).chain(tail).collect()
}
