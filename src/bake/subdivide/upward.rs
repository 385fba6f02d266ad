//! Levels upwards as a chain: how many, and how far each is from the limit surface.

use std::ops::ControlFlow;

use glam::Vec3;

use super::level::{Level, Stack};
use super::{ControlMesh, Placement, Scheme, SubdivideError, draw, remainder};
use crate::bake::chain::{Appearance, BakeError, Chain, ChainLevel, Length, Look, Progress};
use crate::bake::deviation::{self, Deviation, Ruler};
use crate::bake::mesh::Mesh;
use crate::table::MAX_LEVELS;

/// How to make levels upwards. Subdivides until one of its limits says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Upward {
    /// `None` for [`Scheme::of`] the mesh.
    pub scheme: Option<Scheme>,
    /// Where vertices lie.
    pub placement: Placement,
    /// The most subdivisions, at least 1.
    pub levels: usize,
    /// The first level that is as close to the limit surface is the finest; `None` not to look.
    pub error: Option<Length>,
    /// No level has more triangles. A mesh whose first subdivision would is refused.
    pub most_triangles: usize,
    /// How closely coarser levels are measured against the finest.
    pub measure: deviation::Options,
    /// How closely they are looked at; `None` not to look.
    pub look: Option<Look>,
}

impl Default for Upward {
    /// Three subdivisions, which make 64 triangles of one, up to half a million.
    fn default() -> Self {
        Self {
            scheme: None,
            placement: Placement::default(),
            levels: 3,
            error: None,
            most_triangles: 1 << 19,
            measure: deviation::Options::default(),
            look: None,
        }
    }
}

impl Upward {
    /// Subdivides, and measures every level. Level 0 is the finest and the last the control mesh.
    ///
    /// Unlike in other chains level 0 has an error, and all deviations are from the *limit surface*: what no finer
    /// subdivision would bring nearer is counted as well. Level 0's comes from second differences; those of the others
    /// are measured against level 0, and its own is added. [`Deviation::attained`] is what is left of the measured
    /// distance if the limit surface is nearer by as much. Root mean squares are from level 0.
    ///
    /// # Errors
    /// As [`ControlMesh::subdivided`]; a mesh without a face or without extent; one whose first subdivision has more
    /// triangles than it may, before anything is allocated for it; [`BakeError::Cancelled`].
    pub fn bake(
        &self,
        mesh: &ControlMesh,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Chain, SubdivideError> {
        self.check()?;
        check_extent(mesh)?;
        let (stack, apart) = self.subdivided(mesh)?;
        let meshes = draw::meshes(mesh, &stack, self.placement)?;
        let unreferenced = mesh.positions.len() - meshes[meshes.len() - 1].positions.len();
        let levels = self.measured(meshes, apart, progress)?;
        Ok(Chain { levels, unreferenced, left_out: Vec::new() })
    }

    /// Whether the limits are in range.
    ///
    /// # Errors
    /// [`SubdivideError::Options`] with the rule that is broken.
    pub fn check(&self) -> Result<(), SubdivideError> {
        let most = MAX_LEVELS - 1;
        if !(1..=most).contains(&self.levels) {
            let rule = format!("a mesh must be subdivided 1 to {most} times, not {}", self.levels);
            return Err(SubdivideError::Options(rule));
        }
        match self.error {
            Some(Length::Units(length) | Length::OfDiagonal(length))
                if !(length > 0.0 && length.is_finite()) =>
            {
                Err(SubdivideError::Options("the error must be finite and above 0".to_owned()))
            }
            _ => Ok(()),
        }
    }

    /// The levels, and how far the finest is from the limit surface.
    fn subdivided(&self, mesh: &ControlMesh) -> Result<(Stack, f64), SubdivideError> {
        let scheme = self.scheme.unwrap_or(Scheme::of(mesh));
        self.check_first(mesh, scheme)?;
        let mut stack = Stack::of_control(mesh, scheme)?;
        stack.add()?;
        let close_enough = self.error.map(|error| error.units(diagonal(mesh)));
        while self.has_next(&stack) {
            if close_enough.is_some_and(|most| self.distance(&stack) <= most) {
                break;
            }
            stack.add()?;
        }
        let apart = self.distance(&stack);
        Ok((stack, apart))
    }

    fn check_first(&self, mesh: &ControlMesh, scheme: Scheme) -> Result<(), SubdivideError> {
        let triangles = match scheme {
            Scheme::Loop => 4 * mesh.ends.len(),
            Scheme::CatmullClark => 2 * mesh.corners.len(),
        };
        let most = self.most_triangles;
        if triangles <= most { Ok(()) } else { Err(SubdivideError::TooMany { triangles, most }) }
    }

    fn has_next(&self, stack: &Stack) -> bool {
        // Both schemes make four triangles of each, as far as their faces are triangles and quads.
        stack.levels.len() <= self.levels && 4 * stack.finest().triangles() <= self.most_triangles
    }

    fn distance(&self, stack: &Stack) -> f64 {
        let limits = (self.placement == Placement::Limit).then(|| stack.limits());
        let finest: &Level = stack.finest();
        let places: Vec<Vec3> = draw::places(finest, limits.as_ref());
        remainder::limit_distance(finest, stack.scheme, &places)
    }

    /// Every level against the first, and that against the limit surface.
    fn measured(
        &self,
        meshes: Vec<Mesh>,
        apart: f64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<ChainLevel>, SubdivideError> {
        let ruler = Ruler::new(&meshes[0].surface())?;
        let (finest, total) = (meshes[0].clone(), meshes.len());
        let mut levels = Vec::with_capacity(total);
        for (done, mesh) in meshes.into_iter().enumerate() {
            if progress(Progress::Measuring { done, total }).is_break() {
                return Err(BakeError::Cancelled.into());
            }
            let deviation = from_limit(ruler.deviation(&mesh.surface(), &self.measure)?, apart);
            let look = self.look.as_ref().filter(|_| done > 0);
            let appearance = look.map(|look| Appearance::of(&mesh, &finest, look)).transpose()?;
            levels.push(ChainLevel { mesh, deviation, error: 0.0, appearance, lineage: None });
        }
        let deviations: Vec<Deviation> = levels.iter().map(|level| level.deviation).collect();
        for (level, error) in levels.iter_mut().zip(deviation::running_max(&deviations)) {
            level.error = error;
        }
        Ok(levels)
    }
}

/// What is measured against a surface that is itself no farther than `apart` from the one that is meant.
fn from_limit(measured: Deviation, apart: f64) -> Deviation {
    Deviation {
        hausdorff: (measured.hausdorff + apart).next_up(),
        attained: (measured.attained - apart).max(0.0),
        ..measured
    }
}

fn check_extent(mesh: &ControlMesh) -> Result<(), SubdivideError> {
    mesh.check()?;
    if mesh.ends.is_empty() {
        return Err(BakeError::NoTriangles.into());
    }
    let diagonal = diagonal(mesh);
    let fits = diagonal as f32 > 0.0 && diagonal < f64::from(f32::MAX);
    if fits { Ok(()) } else { Err(BakeError::NoExtent.into()) }
}

/// Of the box around all positions that a face uses.
fn diagonal(mesh: &ControlMesh) -> f64 {
    let corners = mesh.corner_positions();
    let bounds = crate::bounds::Aabb::around(corners.iter().map(|&p| mesh.positions[p as usize]));
    (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length()
}
