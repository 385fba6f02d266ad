//! Kinds that grow or lie in a forest. Sizes in metres.

use glam::DVec3;

use super::angle::sin_cos_deg;
use super::foliage::{Crown, boughs, bumps};
use super::kind::Kind;
use super::model::Class::{LargeProp, LevelArchitecture, SmallProp};
use super::place::{at, between, even_unit, on_cone, ring, strewn};
use super::solid::{card, cylinder, field, frustum, rounded, sphere, tube};

/// Waves that fit to their neighbours' at the borders.
pub(super) fn ground() -> Kind {
    Kind::new("ground", LevelArchitecture, [50.0, 2.0, 50.0], |ground| {
        let wave = |x: f64| sin_cos_deg(x * 360.0 / 50.0).0;
        let height = |x: f64, z: f64| {
            let long = wave(x + 9.0) * wave(z - 4.0) + 0.5 * wave(2.0 * x) * wave(z);
            let short = 0.2 * wave(3.0 * x + 5.0) * wave(4.0 * z) + 0.12 * wave(7.0 * z) * wave(5.0 * x);
            0.95 + 0.6 * (long + short)
        };
        ground.put("soil", field([50.0, 50.0], [64, 64], height), [at(0.0, 0.0, 0.0)]);
    })
}

pub(super) fn beech() -> Kind {
    Kind::new("beech", SmallProp, [9.0, 16.0, 9.0], |beech| {
        beech.put("bark", tube([0.35, 0.15], 9.0, 32), [at(0.0, 0.0, 0.0)]);
        boughs(beech, [40, 10], 0.1, [4.0, 9.0], ([0.0, 10.0, 0.0], [2.9, 4.0, 2.9]));
        let main = Crown {
            center: [0.0, 10.4, 0.0],
            radii: [3.2, 4.9, 3.2],
            segments: 32,
            leaves: 2000,
            size: [0.35, 0.6],
        };
        main.put(beech);
        for side in ring(6, 2.3, 8.8) {
            let [x, y, z] = side.apply(DVec3::ZERO).to_array();
            Crown { center: [x, y, z], radii: [1.9, 2.1, 1.9], segments: 20, leaves: 430, size: [0.35, 0.6] }
                .put(beech);
        }
    })
    .seen_to(160.0)
}

/// Skirts of needles around a trunk, and sprays all over them.
pub(super) fn spruce() -> Kind {
    Kind::new("spruce", SmallProp, [6.0, 22.0, 6.0], |spruce| {
        spruce.put("bark", tube([0.3, 0.05], 20.0, 24), [at(0.0, 0.0, 0.0)]);
        for skirt in 0..9 {
            let up = f64::from(skirt);
            let (radius, height, y) = (2.7 - 0.25 * up, 4.0 - 0.12 * up, 1.6 + 1.95 * up);
            spruce.put("needle", frustum([0.9 * radius, 0.0], height, 48), [at(0.0, y, 0.0)]);
            let sprays = on_cone(620 - 50 * skirt, radius, height, y).into_iter().enumerate();
            let hung = sprays.map(|(i, spray)| {
                spray.roll(160.0 + 40.0 * even_unit(i)).pitch(10.0 + 25.0 * even_unit(3 * i))
            });
            spruce.put("needle", card([0.3, 0.55]), hung);
        }
    })
    .seen_to(160.0)
}

pub(super) fn birch() -> Kind {
    Kind::new("birch", SmallProp, [5.0, 13.0, 5.0], |birch| {
        birch.put("bark", tube([0.15, 0.06], 11.0, 24), [at(0.0, 0.0, 0.0)]);
        boughs(birch, [20, 8], 0.05, [4.0, 10.0], ([0.0, 8.6, 0.0], [1.4, 3.4, 1.4]));
        let clumps = [
            [0.0, 11.2, 0.0],
            [1.0, 9.6, 0.2],
            [-0.8, 9.9, 0.5],
            [0.1, 8.4, -1.0],
            [0.5, 7.2, 0.9],
            [-0.8, 6.9, -0.5],
        ];
        for center in clumps {
            Crown { center, radii: [1.35, 1.6, 1.35], segments: 16, leaves: 480, size: [0.2, 0.35] }
                .put(birch);
        }
    })
    .seen_to(120.0)
}

/// Where the path comes close: a tree for the camera to pass within arm's reach.
pub(super) fn old_oak() -> Kind {
    Kind::new("old oak", SmallProp, [18.0, 20.0, 18.0], |oak| {
        oak.put("bark", tube([1.2, 0.7], 7.0, 64), [at(0.0, 0.0, 0.0)]);
        oak.put("bark", sphere(0.4, 24), strewn(12, [0.0, 3.5, 0.0], [0.75, 2.8, 0.75]));
        boughs(oak, [60, 16], 0.3, [4.5, 7.0], ([0.0, 11.0, 0.0], [6.0, 5.0, 6.0]));
        let main = Crown {
            center: [0.0, 12.4, 0.0],
            radii: [7.2, 6.9, 7.2],
            segments: 64,
            leaves: 5000,
            size: [0.4, 0.7],
        };
        main.put(oak);
        for clump in strewn(12, [0.0, 12.0, 0.0], [5.6, 4.6, 5.6]) {
            let center = clump.apply(DVec3::ZERO).to_array();
            Crown { center, radii: [2.9, 2.6, 2.9], segments: 24, leaves: 880, size: [0.4, 0.7] }.put(oak);
        }
    })
    .importance(1.5)
}

pub(super) fn shrub() -> Kind {
    Kind::new("shrub", SmallProp, [1.8, 1.45, 1.6], |shrub| {
        let twigs = ring(10, 0.05, 0.01).into_iter().map(|twig| twig.pitch(25.0));
        shrub.put("bark", tube([0.02, 0.01], 0.8, 6), twigs);
        for (center, radius) in [([-0.17, 0.76, 0.0], 0.66), ([0.25, 0.64, 0.12], 0.55)] {
            Crown {
                center,
                radii: [radius, 0.9 * radius, radius],
                segments: 16,
                leaves: 400,
                size: [0.1, 0.18],
            }
            .put(shrub);
        }
    })
    .seen_to(120.0)
}

/// Eighteen fronds, each a rib that bows down and pairs of leaflets along it.
pub(super) fn fern() -> Kind {
    Kind::new("fern", SmallProp, [1.2, 0.8, 1.2], |fern| {
        let bow = |along: f64| 1.9 * along * (1.25 - along);
        for (i, frond) in ring(18, 0.0, 0.0).into_iter().enumerate() {
            let reach = 0.48 + 0.12 * even_unit(i);
            let rib = field([0.03, 1.0], [1, 9], |_, z| bow(z + 0.5));
            fern.put("leaf", rib, [frond.by(0.0, 0.0, 0.5 * reach).stretched([1.0, 1.0, reach])]);
            let leaflets = (0..26).map(|leaflet| {
                let along = 0.02 + 0.96 * f64::from(leaflet / 2) / 12.0;
                let side = if leaflet % 2 == 0 { 75.0 } else { -75.0 };
                let lying = frond.by(0.0, bow(along), along * reach).pitch(80.0).yaw(180.0);
                lying.roll(side).stretched([1.0, 1.0 - 0.7 * along, 1.0])
            });
            fern.put("leaf", card([0.045, 0.14]), leaflets);
        }
    })
    .seen_to(60.0)
}

pub(super) fn rock() -> Kind {
    Kind::new("rock", LargeProp, [2.4, 1.6, 2.0], |rock| {
        let boulder = rounded([2.2, 1.5, 1.85], 0.7, 15);
        let weathered = boulder.bent(|p| p * (0.96 + 0.2 * bumps(p * 110.0) + 0.02 * bumps(p * 600.0)));
        rock.put("stone", weathered, [at(0.0, 0.0, 0.0)]);
    })
    .seen_to(260.0)
}

pub(super) fn log() -> Kind {
    Kind::new("log", SmallProp, [5.0, 0.7, 0.7], |log| {
        let lying = between([-2.5, 0.32, 0.0], [2.5, 0.32, 0.0]);
        log.put("bark", cylinder(0.32, 1.0, 64), [lying]);
        let stubs =
            (0..8).map(|i| at(0.55 * f64::from(i) - 2.0, 0.32, 0.0).pitch(70.0 * f64::from(i % 3) - 70.0));
        log.put("bark", tube([0.08, 0.05], 0.37, 16), stubs);
    })
    .seen_to(150.0)
}
