//! Kinds that a city is built of. Sizes in metres.

use super::kind::Kind;
use super::model::Class::Vista;
use super::place::{at, lattice, pair, ring, row};
use super::solid::{block, card, cylinder, direction, facade, frustum, prism, rounded, torus, tube, walls};

pub(super) fn road() -> Kind {
    Kind::new("road", Vista, [75.0, 0.4, 30.0], |road| {
        road.put("asphalt", block([75.0, 0.2, 20.0]), [at(0.0, 0.0, 0.0)]);
        road.put("stone", block([75.0, 0.35, 4.9]), [-12.55, 12.55].map(|z| at(0.0, 0.0, z)));
        let kerbs = lattice([75, 1, 2], [-37.0, 0.17, -10.05], [37.0, 0.17, 10.05]);
        road.put("stone", rounded([0.98, 0.2, 0.2], 0.03, 2), kerbs);
        road.put("iron", cylinder(0.35, 0.02, 32), row(4, [-28.0, 0.19, 2.0], [28.0, 0.19, -2.0]));
    })
}

/// A glass tower of 34 storeys between bands of steel. Windows are pockets a foot deep.
pub(super) fn glass_tower() -> Kind {
    Kind::new("glass tower", Vista, [36.0, 160.0, 36.0], |tower| {
        tower.put("glass", rounded([35.0, 150.0, 35.0], 2.4, 8), [at(0.0, 0.0, 0.0)]);
        let side = facade([30.0, 148.0], [8, 34], [3.2, 3.6], 0.3);
        tower.put("glass", side, ring(4, 17.82, 1.0));
        let fins = lattice([10, 12, 1], [-14.9, 1.5, 0.0], [14.9, 137.2, 0.0]);
        let around =
            ring(4, 17.8, 0.0).into_iter().flat_map(|face| fins.iter().map(move |fin| face.to(*fin)));
        tower.put("steel", block([0.2, 11.6, 0.36]), around);
        tower.put(
            "steel",
            prism(&rounded_square(18.0, 2.9), 0.6),
            row(40, [0.0, 2.5, 0.0], [0.0, 149.0, 0.0]),
        );
        tower.put(
            "roof",
            cylinder(3.0, 5.0, 32),
            lattice([3, 1, 2], [-10.0, 149.5, -7.0], [10.0, 149.5, 7.0]),
        );
        tower.put("steel", tube([0.3, 0.1], 10.0, 16), row(3, [-8.0, 150.0, 0.0], [8.0, 150.0, 0.0]));
    })
}

/// Ten points a corner, from above.
fn rounded_square(half: f64, radius: f64) -> Vec<[f64; 2]> {
    let corner = |i: u32| {
        let (turn, inner) = (10.0 * f64::from(i % 10), half - radius);
        let [x, z] = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][i as usize / 10];
        let out = radius * direction(90.0 * f64::from(i / 10) + turn, 0.0);
        [x * inner + out.x, z * inner + out.z]
    };
    (0..40).rev().map(corner).collect()
}

/// A stone tower with deep windows and set-backs.
pub(super) fn stone_tower() -> Kind {
    Kind::new("stone tower", Vista, [30.0, 110.0, 30.0], |tower| {
        let tiers = [(29.0, 46.0, 0.0, [8, 10]), (23.0, 31.0, 46.0, [6, 8]), (17.0, 15.0, 77.0, [4, 3])];
        for (width, height, base, [columns, rows]) in tiers {
            let shell = walls([width, height, width], [columns, columns, rows], [1.5, 2.6], 0.4);
            tower.put("stone", shell, [at(0.0, base, 0.0)]);
            tower.put("stone", block([width + 0.9, 0.8, width + 0.9]), [at(0.0, base + height - 0.7, 0.0)]);
            let step = [width / f64::from(columns), height / f64::from(rows)];
            let (far, low) = ((width - step[0]) / 2.0, step[1] / 2.0 - 1.5);
            let sills = lattice([columns, rows, 1], [-far, low, 0.0], [far, low + height - step[1], 0.0]);
            let around = ring(4, width / 2.0, base)
                .into_iter()
                .flat_map(|face| sills.iter().map(move |sill| face.to(*sill)));
            tower.put("stone", rounded([1.7, 0.2, 0.4], 0.05, 1), around);
        }
        tower.put("copper", frustum([8.0, 0.0], 18.0, 40), [at(0.0, 92.0, 0.0)]);
    })
}

pub(super) fn apartment_block() -> Kind {
    Kind::new("apartment block", Vista, [40.0, 24.0, 16.0], |block_| {
        block_.put("brick", walls([39.0, 20.5, 13.4], [10, 4, 6], [1.6, 1.9], 0.25), [at(0.0, 0.0, 0.0)]);
        let gable = [[-7.6, 0.0], [7.6, 0.0], [7.6, -0.3], [0.0, -3.2], [-7.6, -0.3]];
        let roof = at(-20.0, 20.4, 0.0).yaw(90.0).pitch(90.0);
        block_.put("tile", prism(&gable, 40.0), [roof]);
        let slabs = lattice([7, 6, 2], [-16.5, 0.4, -7.25], [16.5, 17.5, 7.25]);
        let bars = row(12, [-1.1, 0.15, 0.0], [1.1, 0.15, 0.0]);
        let railings = slabs.iter().flat_map(|slab| {
            let out = if slab.apply(glam::DVec3::ZERO).z > 0.0 { 0.55 } else { -0.55 };
            bars.iter().map(move |bar| slab.by(0.0, 0.0, out).to(*bar))
        });
        block_.put("iron", cylinder(0.012, 1.0, 5), railings.collect::<Vec<_>>());
        block_.put("iron", rounded([2.4, 0.15, 1.2], 0.04, 2), slabs);
        block_.put(
            "brick",
            rounded([1.0, 2.0, 1.0], 0.05, 2),
            row(6, [-16.0, 22.0, 2.0], [16.0, 22.0, -2.0]),
        );
    })
}

pub(super) fn shop_row() -> Kind {
    Kind::new("shop row", Vista, [30.0, 12.0, 14.0], |shops| {
        shops.put("brick", walls([29.0, 7.5, 11.5], [9, 3, 2], [1.8, 2.2], 0.4), [at(0.0, 3.8, 0.0)]);
        shops.put("glass", walls([29.0, 3.8, 11.5], [6, 2, 1], [3.8, 2.8], 0.5), [at(0.0, 0.0, 0.0)]);
        shops.put("brick", block([29.8, 0.7, 12.3]), [at(0.0, 11.3, 0.0)]);
        let awnings = row(6, [-12.1, 3.2, 5.6], [12.1, 3.2, 5.6])
            .into_iter()
            .map(|shop| shop.by(-2.1, 0.0, 0.0).roll(-90.0));
        shops.put("cloth", cylinder(1.1, 4.2, 40), awnings);
        let signs = lattice([6, 1, 2], [-12.1, 3.4, -5.85], [12.1, 3.4, 5.85]);
        shops.put("sign", rounded([3.0, 0.6, 0.2], 0.08, 5), signs);
        let arches = lattice([9, 1, 2], [-12.9, 9.6, -5.75], [12.9, 9.6, 5.75])
            .into_iter()
            .map(|arch| arch.pitch(90.0));
        shops.put("brick", torus(0.9, 0.12, [28, 14]), arches);
    })
}

pub(super) fn house() -> Kind {
    Kind::new("house", Vista, [12.0, 9.0, 10.0], |house| {
        house.put("plaster", walls([11.2, 6.0, 9.2], [4, 2, 2], [1.0, 1.3], 0.2), [at(0.0, 0.0, 0.0)]);
        let gable = [[-4.9, 0.0], [4.9, 0.0], [0.0, -2.6]];
        house.put("tile", prism(&gable, 11.8), [at(-5.9, 5.9, 0.0).yaw(90.0).pitch(90.0)]);
        for side in [0.0, 180.0] {
            let slope = at(0.0, 5.98, 0.0).yaw(side).by(0.0, 0.0, 4.95).pitch(27.95);
            let tiles = lattice([12, 1, 5], [-5.4, 0.0, -4.9], [5.4, 0.0, -0.6]);
            house.put(
                "tile",
                rounded([0.96, 0.06, 1.1], 0.02, 2),
                tiles.into_iter().map(|tile| slope.to(tile)),
            );
        }
        let windows = lattice([4, 2, 2], [-4.2, 0.85, -4.62], [4.2, 3.85, 4.62]);
        let shutters = windows
            .iter()
            .filter(|w| w.apply(glam::DVec3::ZERO).x.abs() > 1.5)
            .flat_map(|w| pair(0.82, 0.0, 0.0).map(|s| w.to(s)));
        house.put("wood", rounded([0.6, 1.4, 0.06], 0.02, 3), shutters.chain(pair(0.45, 0.0, 4.64)));
        house.put(
            "wood",
            tube([0.06, 0.06], 6.0, 16),
            lattice([4, 1, 2], [-5.5, 0.0, -4.68], [5.5, 0.0, 4.68]),
        );
        house.put("brick", rounded([0.8, 2.6, 0.8], 0.05, 3), [at(3.0, 6.4, -1.5)]);
        house.put("frame", card([1.1, 2.1]), [at(0.0, 0.0, 4.61)]);
    })
}
