//! What trees and shrubs are made of.

use glam::DVec3;

use super::angle::sin_cos_deg;
use super::model::Assembly;
use super::place::{Place, at, between, even_unit, strewn};
use super::solid::{Solid, card, sphere, tube};

/// An ellipsoid of leaves around a point.
pub(super) struct Crown {
    pub center: [f64; 3],
    pub radii: [f64; 3],
    /// Of the uneven shell that is seen between the leaves.
    pub segments: u32,
    /// Cards on the shell.
    pub leaves: u32,
    /// Of a leaf, or of the spray of leaves that is on one card.
    pub size: [f64; 2],
}

impl Crown {
    pub fn put(&self, plant: &mut Assembly) {
        let [x, y, z] = self.center;
        plant.put("leaf", lump(self.segments), [at(x, y, z).stretched(self.radii.map(|r| 0.95 * r))]);
        let places = strewn(self.leaves, self.center, self.radii.map(|r| 0.93 * r));
        plant.put("leaf", card(self.size), places.into_iter().enumerate().map(|(i, place)| loose(place, i)));
    }
}

/// A unit sphere with bumps of a tenth.
fn lump(segments: u32) -> Solid {
    sphere(1.0, segments).bent(|p| p * (0.95 + 0.05 * bumps(p * 400.0)))
}

/// From −1 to 1, in waves of 360 units.
pub(super) fn bumps(p: DVec3) -> f64 {
    let wave = |x: f64, y: f64| sin_cos_deg(x).0 * sin_cos_deg(y + 40.0).1;
    (wave(p.x, p.y) + wave(p.y, p.z) + wave(p.z, p.x)) / 3.0
}

/// Turned about and lifted off the surface, each leaf by its own angle.
pub(super) fn loose(place: Place, leaf: usize) -> Place {
    place.roll(360.0 * even_unit(leaf)).pitch(15.0 + 40.0 * even_unit(leaf * 7 + 3))
}

/// Boughs from the trunk to points all over an ellipsoid; thinner than `thickness` towards their ends.
pub(super) fn boughs(
    plant: &mut Assembly,
    [count, segments]: [u32; 2],
    thickness: f64,
    trunk: [f64; 2],
    ends: ([f64; 3], [f64; 3]),
) {
    let bough = |(i, end): (usize, Place)| {
        let root = [0.0, trunk[0] + (trunk[1] - trunk[0]) * even_unit(i), 0.0];
        between(root, end.apply(DVec3::ZERO).to_array())
    };
    let places = strewn(count, ends.0, ends.1).into_iter().enumerate().map(bough);
    plant.put("bark", tube([thickness, 0.3 * thickness], 1.0, segments), places);
}
