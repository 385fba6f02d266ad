//! The driver: simplify, measure, keep what is of use.

use std::ops::ControlFlow;

use super::measure::{Gauge, accumulate};
use super::search::{self, Found};
use super::{Appearance, BakeError, Chain, ChainLevel, LeftOut, Length, Limits, Look, Reason, Stops};
use crate::bake::deviation::{self, Deviation};
use crate::bake::mesh::Mesh;
use crate::bake::repair;
use crate::bake::simplify::{self, GarlandHeckbert, Method, Simplified, Simplifier, Stopped, Target, Task};

/// How to make the levels of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What simplifies.
    pub method: Method,
    /// How [`Method::Quadric`] does it; the other methods are as they are by default.
    pub quadric: GarlandHeckbert,
    /// Where levels are made.
    pub stops: Stops,
    /// Where the chain ends.
    pub limits: Limits,
    /// How closely levels are measured.
    pub measure: deviation::Options,
    /// How closely they are looked at; `None` not to look.
    pub look: Option<Look>,
}

impl Default for Plan {
    /// Halves the triangles until the default limits say so.
    fn default() -> Self {
        Self {
            method: Method::default(),
            quadric: GarlandHeckbert::default(),
            stops: Stops::Ratio(0.5),
            limits: Limits::default(),
            measure: deviation::Options::default(),
            look: Some(Look::default()),
        }
    }
}

/// How far a bake has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// The simplifier is at work; told before each pass as well.
    Simplifying(simplify::Progress),
    /// So many of the levels at hand are measured; told before each of them.
    Measuring {
        /// Those that are.
        done: usize,
        /// All of them.
        total: usize,
    },
}

/// The progress callback of somebody who does not care.
pub fn quietly(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Asks whether to go on.
pub(super) type Tell<'a> = dyn FnMut(Progress) -> ControlFlow<()> + 'a;

impl Plan {
    /// Makes and measures the levels of a mesh. The same plan and mesh have the same result.
    ///
    /// Every level is simplified from the mesh itself. What would be of no use is left out and told of
    /// ([`Chain::left_out`]): a chain may have level 0 alone. Some 2 µs per triangle to simplify with the default
    /// method; measuring every level takes longer, as [`deviation::Ruler`] says, and looking at it as [`Look`] says.
    ///
    /// # Errors
    /// A plan out of range; a mesh that has no triangle or no extent, is not finite, or does not pass
    /// [`Mesh::check`]; [`BakeError::Cancelled`] where `progress` breaks.
    pub fn bake(
        &self,
        mesh: &Mesh,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Chain, BakeError> {
        self.bake_locked(mesh, &[], progress)
    }

    /// As [`Plan::bake`], with positions that must stay where they are in all levels, bit by bit: as many as the mesh
    /// has, or none.
    ///
    /// # Errors
    /// As [`Plan::bake`]; a list of another length.
    pub fn bake_locked(
        &self,
        mesh: &Mesh,
        locked: &[bool],
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Chain, BakeError> {
        self.check()?;
        let (finest, unreferenced) = finest(mesh)?;
        let locked = locked_of(mesh, locked)?;
        let diagonal = diagonal(&finest)?;
        let gauge = Gauge::new(&finest, &self.measure)?;
        let mut draft = Draft::new(self, diagonal, finest, locked);
        match self.stops.counts(draft.finest().triangles.len(), &self.limits) {
            Some(counts) => draft.add_counts(&counts, &gauge, progress)?,
            None => draft.add_errors(&gauge, progress)?,
        }
        Ok(draft.finish(unreferenced))
    }

    /// Whether stops and limits are in range.
    ///
    /// # Errors
    /// [`BakeError::Plan`] with the first rule that is broken.
    pub fn check(&self) -> Result<(), BakeError> {
        self.stops.check()?;
        self.limits.check()
    }

    fn simplifier(&self) -> Box<dyn Simplifier> {
        match self.method {
            Method::Quadric => Box::new(self.quadric),
            method => method.simplifier(),
        }
    }

    /// The levels of these targets, each from the task's mesh itself.
    pub(super) fn simplify(
        &self,
        task: &Task<'_>,
        targets: &[Target],
        progress: &mut Tell<'_>,
    ) -> Result<Vec<Simplified>, BakeError> {
        let Some(&first) = targets.first() else { return Ok(Vec::new()) };
        let mut tell = |at| progress(Progress::Simplifying(at));
        let from = task.mesh.triangles.len();
        if tell(simplify::Progress { from, triangles: from, target: first.triangles }).is_break() {
            return Err(BakeError::Cancelled);
        }
        let levels = self.simplifier().chain(&Task { target: first, ..*task }, targets, &mut tell)?;
        match levels.iter().any(|level| level.stopped == Stopped::Cancelled) {
            true => Err(BakeError::Cancelled),
            false => Ok(levels),
        }
    }
}

/// Says that a measurement begins.
pub(super) fn tell_measuring(done: usize, total: usize, progress: &mut Tell<'_>) -> Result<(), BakeError> {
    match progress(Progress::Measuring { done, total }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(BakeError::Cancelled),
    }
}

/// The mesh without positions and wedges that no triangle uses, and how many positions those were.
fn finest(mesh: &Mesh) -> Result<(Mesh, usize), BakeError> {
    mesh.check().map_err(|rule| BakeError::Simplify(simplify::SimplifyError::Mesh(rule)))?;
    if mesh.triangles.is_empty() {
        return Err(BakeError::NoTriangles);
    }
    let mut finest = mesh.clone();
    repair::drop_isolated(&mut finest);
    let unreferenced = mesh.positions.len() - finest.positions.len();
    Ok((finest, unreferenced))
}

/// The locks of those positions that a triangle uses.
fn locked_of(mesh: &Mesh, locked: &[bool]) -> Result<Vec<bool>, BakeError> {
    if locked.is_empty() {
        return Ok(Vec::new());
    }
    if locked.len() != mesh.positions.len() {
        let (given, vertices) = (locked.len(), mesh.positions.len());
        return Err(simplify::SimplifyError::Locked { given, vertices }.into());
    }
    let mut used = vec![false; mesh.positions.len()];
    for &wedge in mesh.triangles.as_flattened() {
        used[mesh.wedges[wedge as usize] as usize] = true;
    }
    Ok(locked.iter().zip(used).filter(|&(_, used)| used).map(|(&locked, _)| locked).collect())
}

/// Of the bounding box.
fn diagonal(mesh: &Mesh) -> Result<f64, BakeError> {
    let bounds = mesh.bounds();
    let diagonal = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length();
    // Half of it is the radius of a bound, which must be a number in single precision.
    let fits = diagonal as f32 > 0.0
        && diagonal < f64::from(f32::MAX)
        && mesh.positions.iter().all(|p| p.is_finite());
    if fits { Ok(diagonal) } else { Err(BakeError::NoExtent) }
}

/// A chain in the making.
struct Draft<'a> {
    plan: &'a Plan,
    diagonal: f64,
    /// Per position of level 0, or empty.
    locked: Vec<bool>,
    levels: Vec<ChainLevel>,
    left_out: Vec<LeftOut>,
}

impl<'a> Draft<'a> {
    fn new(plan: &'a Plan, diagonal: f64, finest: Mesh, locked: Vec<bool>) -> Self {
        let deviation = Deviation::default();
        let finest = ChainLevel { mesh: finest, deviation, error: 0.0, appearance: None, lineage: None };
        Self { plan, diagonal, locked, levels: vec![finest], left_out: Vec::new() }
    }

    fn finest(&self) -> &Mesh {
        &self.levels[0].mesh
    }

    /// What to simplify, whatever the target.
    fn task(&self) -> Task<'_> {
        Task { locked: &self.locked, ..Task::new(self.finest(), Target::triangles(0)) }
    }

    /// One pass of the method, then a measurement per level, until one is too far.
    fn add_counts(
        &mut self,
        counts: &[usize],
        gauge: &Gauge<'_>,
        progress: &mut Tell<'_>,
    ) -> Result<(), BakeError> {
        let targets: Vec<Target> = counts.iter().copied().map(Target::triangles).collect();
        let levels = self.plan.simplify(&self.task(), &targets, progress)?;
        for (i, (&target, level)) in targets.iter().zip(levels).enumerate() {
            tell_measuring(i, targets.len(), progress)?;
            let Simplified { mesh, heirs, .. } = level;
            self.add(target, mesh, |mesh| gauge.descended(mesh, heirs))?;
        }
        Ok(())
    }

    /// The levels that a search finds for target errors.
    fn add_errors(&mut self, gauge: &Gauge<'_>, progress: &mut Tell<'_>) -> Result<(), BakeError> {
        let Stops::Errors(lengths) = &self.plan.stops else { return Ok(()) };
        let mut limits: Vec<f64> = lengths.iter().map(|length| length.units(self.diagonal)).collect();
        limits.sort_unstable_by(f64::total_cmp);
        for Found { limit, level } in search::search(self.plan, &self.task(), &limits, gauge, progress)? {
            let target = Target::error(limit as f32);
            match level {
                Some(level) => self.add(target, level.mesh, |mesh| Ok(ChainLevel { mesh, ..level }))?,
                None => self.leave_out(target, self.finest().triangles.len(), Reason::NotCoarser),
            }
        }
        Ok(())
    }

    /// Keeps a level if it is of use, measuring it only if it could be.
    fn add(
        &mut self,
        target: Target,
        mesh: Mesh,
        measured: impl FnOnce(Mesh) -> Result<ChainLevel, BakeError>,
    ) -> Result<(), BakeError> {
        let triangles = mesh.triangles.len();
        match self.objection(triangles) {
            Some(reason) => self.leave_out(target, triangles, reason),
            None => match measured(mesh)? {
                level if self.is_too_far(&level) => self.leave_out(target, triangles, Reason::TooFar),
                level => {
                    let look = |look| Appearance::of(&level.mesh, self.finest(), look);
                    let appearance = self.plan.look.as_ref().map(look).transpose()?;
                    let lineage = level.lineage.map(|lineage| lineage.shortest(&self.levels));
                    self.levels.push(ChainLevel { appearance, lineage, ..level });
                }
            },
        }
        Ok(())
    }

    fn leave_out(&mut self, target: Target, triangles: usize, reason: Reason) {
        self.left_out.push(LeftOut { target, triangles, reason });
    }

    /// What the number of triangles alone has against a level.
    fn objection(&self, triangles: usize) -> Option<Reason> {
        let before = self.levels.last().map_or(0, ChainLevel::triangles);
        let most = (1.0 - self.plan.limits.least_gain) * before as f64;
        if self.left_out.iter().any(|level| level.reason == Reason::TooFar) {
            Some(Reason::TooFar)
        } else if triangles == 0 {
            Some(Reason::Empty)
        } else if triangles >= before
            || triangles as f64 > most
            || self.levels.len() >= self.plan.limits.levels
        {
            Some(Reason::NotCoarser)
        } else {
            None
        }
    }

    fn is_too_far(&self, level: &ChainLevel) -> bool {
        let most = self.plan.limits.most_error.map(|most: Length| most.units(self.diagonal));
        most.is_some_and(|most| level.deviation.hausdorff > most)
    }

    fn finish(self, unreferenced: usize) -> Chain {
        let Self { mut levels, left_out, .. } = self;
        accumulate(&mut levels);
        Chain { levels, unreferenced, left_out }
    }
}
