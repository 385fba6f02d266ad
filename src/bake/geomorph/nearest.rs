//! The way where nobody knows what became of what: every position goes to the nearest point of the coarser surface.
//!
//! Nearest points as correspondence are what P. Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error on simplified
//! surfaces", 1998, take for distances. Ours keep to the side of the surface, to borders and to seams.

use glam::{DVec3, Vec3};

use super::Ways;
use super::blend::{Source, unlikeness};
use super::features::{Features, KINDS};
use crate::bake::Mesh;
use crate::bake::deviation::{DeviationError, Finder, Spot};

/// Where vertices go by what is nearest.
///
/// # Errors
/// [`DeviationError`], for a surface of too many triangles.
pub(super) fn ways(finer: &Mesh, coarser: &Mesh) -> Result<Ways, DeviationError> {
    let (own, features) = (Features::of(finer), Features::of(coarser));
    let Some(surface) = Finder::new(&coarser.surface())? else { return Ok(still(finer)) };
    let lines = Lines::new(&own, &features, coarser)?;
    let goal =
        |p: usize| lines.goal(finer.positions[p], p, surface.nearest(finer.positions[p], own.normals[p]));
    let places: Vec<Vec3> = (0..finer.positions.len()).map(goal).collect();
    let looks = Looks { finer, coarser, surface: &surface, places: &places };
    let sources = looks.sources();
    Ok(Ways { places, sources })
}

fn still(mesh: &Mesh) -> Ways {
    Ways { places: mesh.positions.clone(), sources: vec![None; mesh.wedges.len()] }
}

/// The edges that a position goes to if it is on one of the same kind.
struct Lines {
    /// Per kind, whether each position of the finer mesh is on such an edge.
    on: [Vec<bool>; KINDS],
    /// Per kind, those of the coarser mesh, if there are any.
    edges: [Option<Finder>; KINDS],
}

impl Lines {
    fn new(own: &Features, features: &Features, coarser: &Mesh) -> Result<Self, DeviationError> {
        let edges = |kind| Finder::new(&features.surface(kind, coarser));
        Ok(Self { on: [own.on(0), own.on(1)], edges: [edges(0)?, edges(1)?] })
    }

    /// The nearest point of an edge of its kind, if it is hardly farther than the nearest of all: by no more than half a
    /// side of the coarser triangle there. A border that is no more would else be led across the mesh.
    fn goal(&self, position: Vec3, number: usize, near: Spot) -> Vec3 {
        let reach = near.distance + 0.5 * near.side;
        let kinds = self.on.iter().zip(&self.edges).filter(|(on, _)| on[number]);
        let spots = kinds.filter_map(|(_, edges)| Some(edges.as_ref()?.nearest(position, DVec3::ZERO)));
        let mut within = spots.filter(|spot| spot.distance <= reach);
        within.next().map_or(near.place, |spot| spot.place)
    }
}

/// Attributes at the places where positions go.
struct Looks<'a> {
    finer: &'a Mesh,
    coarser: &'a Mesh,
    surface: &'a Finder,
    /// Per position of the finer mesh.
    places: &'a [Vec3],
}

impl Looks<'_> {
    /// Per wedge, the point in the triangle there that looks most like it: of those that touch the place, which at a
    /// seam are of either side.
    fn sources(&self) -> Vec<Option<Source>> {
        let mut by_position: Vec<(u32, u32)> = self.finer.wedges.iter().copied().zip(0..).collect();
        by_position.sort_unstable();
        let mut sources = vec![None; self.finer.wedges.len()];
        for wedges in by_position.chunk_by(|a, b| a.0 == b.0) {
            let touching = self.surface.touching(self.places[wedges[0].0 as usize]);
            for &(_, wedge) in wedges {
                sources[wedge as usize] = self.most_alike(wedge as usize, &touching);
            }
        }
        sources
    }

    /// Ties by the lower triangle.
    fn most_alike(&self, wedge: usize, touching: &[Spot]) -> Option<Source> {
        let rank = |spot: &Spot| {
            let source = self.source(spot);
            (unlikeness(self.finer, wedge, self.coarser, source), spot.triangle, source)
        };
        let ranked = touching.iter().map(rank);
        ranked.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, _, source)| source)
    }

    /// A point at a corner has that corner's attributes, to the bit.
    fn source(&self, spot: &Spot) -> Source {
        let wedges = self.coarser.triangles[spot.triangle];
        match spot.weights.iter().position(|&weight| weight == 1.0) {
            Some(corner) => Source::Wedge(wedges[corner]),
            None => Source::Within { wedges, weights: spot.weights.map(|weight| weight as f32) },
        }
    }
}
