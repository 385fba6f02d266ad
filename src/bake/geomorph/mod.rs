//! Geomorphs: a finer level that turns into a coarser one without a jump.
//!
//! H. Hoppe, "Progressive meshes", SIGGRAPH 1996, section 3.1. Where a level is made by contractions, every vertex of a
//! finer level has a parent in the coarser one. The finer mesh is drawn with each vertex on the straight way to its
//! parent: at weight 0 it is the finer level, at weight 1 its triangles have no area or are those of the coarser level,
//! and between two frames no vertex moves by more than its share of the way. Attributes go along: normals, texture
//! coordinates, colours and tangents. Where we depart from the paper:
//! - parents follow from where the positions of level 0 ended, which every method tells, so that levels of clusters and
//!   of triangle or cell contractions morph as well, and any two levels of a chain do;
//! - a wedge goes to the coarser wedge on its side of a seam: to what the corners of its triangles became, and where
//!   all of those collapsed, to what their corners became on the other end of a collapsed edge;
//! - what vanishes as a whole shrinks to a point;
//! - levels of unknown origin (an artist's, or of a method that fills holes anew) go to the nearest point of the coarser
//!   surface, borders to borders and seams to seams ([`Fit::Nearest`]).
//!
//! Which level is drawn with which weight while a transition is in flight is [`Shown::morph`]'s to say.
//!
//! ```
//! use lod_budget::bake::chain::{Plan, quietly};
//! use lod_budget::bake::{geomorph::Fit, shapes};
//!
//! let knot = shapes::torus_knot(100, 12).into();
//! let chain = Plan { look: None, ..Plan::default() }.bake(&knot, &mut quietly)?;
//! let morph = chain.geomorph(0, 2)?;
//! assert_eq!(morph.fit, Fit::Exact);
//! let half_way = morph.at(&chain.levels[0].mesh, 0.5);
//! assert_eq!(half_way.triangles, chain.levels[0].mesh.triangles);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Shown::morph`]: crate::transition::Shown::morph

mod blend;
mod contracted;
mod features;
mod goals;
mod movement;
mod nearest;
mod sets;

use std::fmt;

use super::Mesh;
use super::deviation::DeviationError;
use blend::Source;

pub use movement::{Movement, Pop};

/// How a finer mesh turns into a coarser one.
#[derive(Clone, Debug, PartialEq)]
pub struct Geomorph {
    /// The finer mesh as it is at weight 1: its triangles and wedges, with positions and attributes of the coarser one.
    /// Joints and weights are the finer one's.
    pub target: Mesh,
    /// How true the target is to the coarser mesh.
    pub fit: Fit,
    /// How far it is to the target.
    pub movement: Movement,
}

/// How true a geomorph's end is to the coarser mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// Its triangles have no area or are those of the coarser mesh, and all of those are there: what is drawn does not
    /// change when the coarser mesh takes over.
    Exact,
    /// Its vertices lie on the coarser surface. What is between them may not, so that a part of the pop remains.
    Nearest,
}

impl Geomorph {
    /// From a finer mesh to a coarser one. `heirs` says for each position of the finer one which position of the
    /// coarser one it became, [`Simplified::GONE`] for none; where it is missing, or does not lead to the coarser mesh,
    /// the nearest points do. O(n log n).
    ///
    /// # Errors
    /// A mesh that does not [check](Mesh::check), has no triangle, or uses a position that is not finite.
    ///
    /// [`Simplified::GONE`]: super::simplify::Simplified::GONE
    pub fn between(finer: &Mesh, coarser: &Mesh, heirs: Option<&[u32]>) -> Result<Self, GeomorphError> {
        check("finer", finer)?;
        check("coarser", coarser)?;
        if let Some(ways) = heirs.and_then(|heirs| contracted::ways(finer, coarser, heirs)) {
            return Ok(Self::along(ways, finer, coarser, Fit::Exact));
        }
        if finer == coarser {
            return Ok(Self::still(finer));
        }
        let ways = nearest::ways(finer, coarser).map_err(GeomorphError::Surface)?;
        Ok(Self::along(ways, finer, coarser, Fit::Nearest))
    }

    /// A mesh that stays as it is.
    pub fn still(mesh: &Mesh) -> Self {
        Self { target: mesh.clone(), fit: Fit::Exact, movement: Movement::default() }
    }

    fn along(Ways { places, sources }: Ways, finer: &Mesh, coarser: &Mesh, fit: Fit) -> Self {
        let mut target = finer.clone();
        target.positions = places;
        blend::take_attributes(&mut target, coarser, &sources);
        let movement = Movement::between(finer, &target);
        Self { target, fit, movement }
    }

    /// The mesh at a weight: bit by bit `finer` at 0 and below, the target at 1 and above. What does not move stays
    /// where it is, bit by bit, at any weight. Between, normals and tangents are made unit vectors.
    ///
    /// # Panics
    /// Where `finer` has not as many positions and wedges as the target: it is another mesh.
    pub fn at(&self, finer: &Mesh, weight: f32) -> Mesh {
        blend::between(finer, &self.target, weight)
    }
}

/// Where the vertices of the finer mesh go.
struct Ways {
    /// Per position.
    places: Vec<glam::Vec3>,
    /// Per wedge, what has its attributes then; `None` to keep its own.
    sources: Vec<Option<Source>>,
}

/// Refuses what no geomorph can lead from or to.
fn check(which: &'static str, mesh: &Mesh) -> Result<(), GeomorphError> {
    let refused = |rule| GeomorphError::Mesh { which, name: mesh.name.clone(), rule };
    mesh.check().map_err(refused)?;
    if mesh.triangles.is_empty() {
        return Err(refused("it must have a triangle".to_owned()));
    }
    match mesh.positions.iter().position(|p| !p.is_finite()) {
        Some(position) => Err(refused(format!("position {position} must be finite"))),
        None => Ok(()),
    }
}

/// Why there is no geomorph.
#[derive(Clone, Debug, PartialEq)]
pub enum GeomorphError {
    /// A mesh that breaks a rule.
    Mesh {
        /// The finer or the coarser one.
        which: &'static str,
        /// What it is called.
        name: String,
        /// The rule.
        rule: String,
    },
    /// A level that the chain does not have, or a finer one that is behind the coarser one.
    Levels {
        /// The finer level that was asked for.
        finer: usize,
        /// The coarser one.
        coarser: usize,
        /// How many the chain has.
        levels: usize,
    },
    /// A surface on which nothing is nearest.
    Surface(DeviationError),
}

impl fmt::Display for GeomorphError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh { which, name, rule } => write!(f, "the {which} mesh '{name}': {rule}"),
            Self::Levels { finer, coarser, levels } => {
                write!(
                    f,
                    "a geomorph leads from a finer level to a coarser one of {levels}, not {finer} to {coarser}"
                )
            }
            Self::Surface(error) => write!(f, "the coarser surface: {error}"),
        }
    }
}

impl std::error::Error for GeomorphError {}
