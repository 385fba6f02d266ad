//! The record, followed step by step on the mesh that it was made of.

use glam::{DVec3, Vec3};

use super::ball::Ball;
use super::cones::Spread;
use super::error::BuildError;
use super::ground::Ground;
use super::leaves::{Raw, number};
use super::overlay::{Change, Drift};
use super::stars::Stars;
use super::upright::Upright;
use crate::bake::Mesh;
use crate::bake::simplify::Contraction;
use crate::hierarchy::{Cone, Operation, Parts};

/// What made a triangle what it is: the mesh, or an operation that was left out.
const MESH: u32 = u32::MAX;
const LEFT_OUT: u32 = u32::MAX - 1;

/// A mesh on its way to its base, and the operations so far. Vertices are positions of the mesh.
pub(super) struct Follow {
    stars: Stars,
    positions: Vec<Vec3>,
    is_gone: Vec<bool>,
    /// Where all triangles face, if that is along an axis; and what they are measured against then.
    upright: Option<DVec3>,
    ground: Option<Ground>,
    /// Per triangle, the operation that made it what it is by now.
    makers: Vec<u32>,
    /// Per operation, which way it is off, not rounded.
    spreads: Vec<Spread>,
    raw: Raw,
    change: Change,
    /// The triangles before, and those of them that are there after.
    star: Vec<u32>,
    staying: Vec<u32>,
    rests_on: Vec<u32>,
}

impl Follow {
    pub(super) fn new(mesh: &Mesh) -> Result<Self, BuildError> {
        let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
        let triangles: Vec<[u32; 3]> = corners.filter(|&[a, b, c]| a != b && b != c && c != a).collect();
        let is_finite = |t: &[u32; 3]| t.iter().all(|&v| mesh.positions[v as usize].is_finite());
        if let Some(t) = triangles.iter().position(|t| !is_finite(t)) {
            return Err(BuildError::Mesh(format!("triangle {t} must have finite corners")));
        }
        let stars = Stars::new(mesh.positions.len(), triangles.clone());
        let upright = Upright::of(&mesh.positions, &triangles).map(|Upright(axis)| axis);
        Ok(Self {
            ground: upright.map(|axis| Ground::new(axis, &mesh.positions, &stars, &triangles)),
            upright,
            is_gone: vec![false; mesh.positions.len()],
            makers: vec![MESH; triangles.len()],
            spreads: Vec::new(),
            raw: Raw::new(mesh.positions.clone(), &triangles),
            positions: mesh.positions.clone(),
            stars,
            change: Change::default(),
            star: Vec::new(),
            staying: Vec::new(),
            rests_on: Vec::new(),
        })
    }

    /// Refuses a contraction of what is not there.
    pub(super) fn check(
        &self,
        &Contraction { kept, gone, position, .. }: &Contraction,
    ) -> Result<(), &'static str> {
        let is_there = |v: u32| self.is_gone.get(v as usize) == Some(&false);
        if kept == gone || !is_there(kept) || !is_there(gone) {
            Err("it must be of two vertices that are there")
        } else if !position.is_finite() {
            Err("its position must be finite")
        } else {
            Ok(())
        }
    }

    /// Contracts, and keeps the operation unless it folds a height field or rests on one that was left out. What would
    /// fold one goes elsewhere on the edge if it can.
    pub(super) fn contract(&mut self, contraction: &Contraction) {
        let &Contraction { kept, gone, position, .. } = contraction;
        self.gather(kept, gone);
        let found = self.places(contraction).into_iter().find_map(|place| {
            self.describe(kept, gone, place);
            self.operation([kept, gone]).map(|found| (place, found))
        });
        let (place, maker) = match found {
            Some((place, (operation, spread))) => {
                self.spreads.push(spread);
                (place, self.raw.push(kept, gone, place, operation, &self.star, &self.stars))
            }
            None => (position, LEFT_OUT),
        };
        self.star.iter().for_each(|&t| self.makers[t as usize] = maker);
        self.stars.contract(kept, gone);
        self.positions[kept as usize] = place;
        self.is_gone[gone as usize] = true;
    }

    /// Where the contracted vertex may go, best first: where the simplifier had it, or to an end of the edge or between.
    /// Of ten million contractions of a terrain some ten fold it, and each would keep a thousand others from being done.
    fn places(&self, &Contraction { kept, gone, position, .. }: &Contraction) -> [Vec3; 4] {
        let ends = [kept, gone].map(|v| self.positions[v as usize]);
        [position, ends[0], ends[1], ends[0].midpoint(ends[1])]
    }

    pub(super) fn finish(self) -> Parts {
        number(self.raw)
    }

    /// Finds the triangles around both, and what made them.
    fn gather(&mut self, kept: u32, gone: u32) {
        self.star.clear();
        self.star.extend(self.stars.of(kept).chain(self.stars.of(gone)));
        self.star.sort_unstable();
        self.star.dedup();
        self.rests_on.clear();
        self.rests_on
            .extend(self.star.iter().map(|&t| self.makers[t as usize]).filter(|&maker| maker != MESH));
        self.rests_on.sort_unstable();
        self.rests_on.dedup();
    }

    /// Writes down the triangles before and after, with points of their own.
    fn describe(&mut self, kept: u32, gone: u32, position: Vec3) {
        let Change { points, before, after } = &mut self.change;
        let place = |v: u32| self.positions[v as usize].as_dvec3();
        points.clear();
        points.extend([place(kept), place(gone), position.as_dvec3()]);
        before.clear();
        after.clear();
        self.staying.clear();
        let mut names = vec![kept, gone, u32::MAX];
        for &triangle in &self.star {
            let corners = self.stars.corners(triangle).map(|v| match names.iter().position(|&n| n == v) {
                Some(at) => at,
                None => {
                    names.push(v);
                    points.push(place(v));
                    points.len() - 1
                }
            });
            before.push(corners);
            if !(corners.contains(&0) && corners.contains(&1)) {
                self.staying.push(triangle);
                after.push(corners.map(|corner| if corner < 2 { 2 } else { corner }));
            }
        }
    }

    /// What is known of the change; `None` where it is to be left out.
    fn operation(&mut self, ends: [u32; 2]) -> Option<(Operation, Spread)> {
        if self.rests_on.last() == Some(&LEFT_OUT) {
            return None;
        }
        let (moved, spread) = self.moved()?;
        let exact = self.exact(ends);
        let below =
            || self.rests_on.iter().map(|&o| (&self.raw.operations[o as usize], self.spreads[o as usize]));
        let so_far = below().map(|(o, _)| f64::from(o.error)).fold(0.0, f64::max);
        let spread = below().filter(|(o, _)| o.error > 0.0).map(|(_, s)| s).fold(spread, Spread::with);
        let ends = ends.iter().filter_map(|&end| self.raw.maker(end)).map(|end| Ball::of(&end.sphere));
        let sphere = ends.fold(Ball::around(self.change.points.iter().copied()), Ball::with).sphere();
        // Where a border has moved sideways, heights are not all that is off.
        let exact = if spread == Spread::EVERY { f64::INFINITY } else { exact.max(so_far) };
        let error = rounded_up((so_far + moved).min(exact));
        let cone = if error > 0.0 { spread.cone() } else { Cone::EVERY };
        Some((Operation { ends: [0; 2], triangles: 0, error, cone, sphere }, spread))
    }

    /// How far the surface then is from the mesh, where it is known to be along the axis of a height field.
    fn exact(&mut self, ends: [u32; 2]) -> f64 {
        let ground = self.ground.as_mut();
        let off = ground.and_then(|ground| ground.contract(ends, &self.change, &self.star, &self.staying));
        off.unwrap_or(f64::INFINITY)
    }

    /// How far the surface moves, and which way.
    fn moved(&self) -> Option<(f64, Spread)> {
        let axis = self.upright.or_else(|| self.change.facing().try_normalize());
        match axis.map_or(Drift::Folded, |axis| self.change.drift(axis)) {
            Drift::Along(far) => Some((far, axis.map_or(Spread::EVERY, Spread::along))),
            Drift::Folded if self.upright.is_some() => None,
            Drift::Folded | Drift::Slid => Some((self.change.reach(), Spread::EVERY)),
        }
    }
}

/// What is exact stays so.
fn rounded_up(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) < value { nearest.next_up() } else { nearest }
}
