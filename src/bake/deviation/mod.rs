//! How far two surfaces are apart, in both directions.
//!
//! A simplifier's own error is an estimate: it falls short of the distance between the surfaces, often by a multiple.
//! What the runtime projects to pixels has to be measured, and what users are to trust has to be a bound:
//!
//! - **Hausdorff distance**: how far a point of either surface can be from the other surface. Every triangle is covered
//!   by pieces whose distance is bounded from above; pieces that could hold the maximum are split until the bound is
//!   within [`Options::relative`] of a distance that is attained. The bound is rounded outwards, so it is one.
//! - **Root mean square**: of the distance from a random point of one surface to the other one. An estimate, by
//!   sampling, with its standard error. Of the two directions the larger counts, as in N. Aspert, D. Santa-Cruz, T.
//!   Ebrahimi, "MESH: measuring errors between surfaces using the Hausdorff distance", 2002. Each direction is what P.
//!   Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error on simplified surfaces", 1998, and MeshLab call RMS.
//!
//! A surface is the union of its triangles as closed sets. A triangle without area still counts as the segment or the
//! point that it is; a vertex that no triangle names does not count. Which side of a triangle is its front plays no
//! part.
//!
//! Distance is not all that is seen: [`attributes`] measures how far normals, texture coordinates and colours differ,
//! [`silhouette`] how far outlines are apart and how much is covered. Both are estimates.
//!
//! Equal surfaces, and two that are both empty, do not deviate. Where one is empty there is no distance, and an error
//! says so.
//!
//! ```
//! use glam::Vec3;
//! use lod_budget::bake::deviation::{Options, deviation};
//! use lod_budget::bake::surface::Surface;
//!
//! let triangle = |z: f32| Surface {
//!     positions: vec![Vec3::new(0.0, 0.0, z), Vec3::new(1.0, 0.0, z), Vec3::new(0.0, 1.0, z)],
//!     triangles: vec![[0, 1, 2]],
//! };
//! let apart = deviation(&triangle(0.0), &triangle(0.25), &Options::default())?;
//! assert!(apart.hausdorff >= 0.25 && apart.hausdorff < 0.25 * 1.02);
//! # Ok::<(), lod_budget::bake::deviation::DeviationError>(())
//! ```

use std::fmt;

use crate::bake::surface::Surface;

pub mod attributes;
mod bvh;
#[cfg(test)]
mod exact;
mod facet;
mod hausdorff;
mod nearest;
mod overlay;
mod piece;
mod sampling;
mod shape;
pub mod silhouette;

use hausdorff::Extent;
pub(in crate::bake) use nearest::{Finder, Spot};
pub use sampling::Spread;
use shape::Shape;

/// How closely to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How far the bound on the Hausdorff distance may exceed the true one, as a share of it. From 0.001, at which a
    /// measurement takes several times as long, to 1.
    pub relative: f64,
    /// How far it may exceed it in any case, as a share of the smaller bounding-box diagonal: what counts as equal.
    /// From 1e-9 to 1.
    pub of_diagonal: f64,
    /// The relative standard error at which sampling for the mean square ends. From 0.0005 to 1.
    pub rms_error: f64,
    /// The most samples taken in each direction; where most of a surface is exact, they end before `rms_error` is met.
    pub max_samples: usize,
    /// The most pieces and cells that the search for the Hausdorff distance looks at in each direction, per triangle of
    /// both surfaces, or of 65 536 where they have fewer; each takes about 2 µs and at most 150 bytes. Where that ends
    /// a search, as slivers that all cross each other make it, what is found is still a bound, but looser than asked
    /// for.
    pub max_splits: usize,
    /// Where samples lie; equal seeds give equal results.
    pub seed: u64,
}

impl Default for Options {
    /// A bound within 1 % or 5e-7 of the diagonal (half of what is promised for tables, so that nobody's rounding
    /// matters), root mean squares within 0.5 %, at most a million samples each way, 20 pieces per triangle.
    fn default() -> Self {
        Self {
            relative: 0.01,
            of_diagonal: 5e-7,
            rms_error: 0.005,
            max_samples: 1 << 20,
            max_splits: 20,
            seed: 0,
        }
    }
}

impl Options {
    fn check(&self) -> Result<(), DeviationError> {
        let rule =
            |holds: bool, rule: &'static str| if holds { Ok(()) } else { Err(DeviationError::Options(rule)) };
        rule((0.001..=1.0).contains(&self.relative), "`relative` is from 0.001 to 1")?;
        rule((1e-9..=1.0).contains(&self.of_diagonal), "`of_diagonal` is from 1e-9 to 1")?;
        rule((0.0005..=1.0).contains(&self.rms_error), "`rms_error` is from 0.0005 to 1")
    }
}

/// How far two surfaces are apart, in object units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// No point of either surface is farther than this from the other surface.
    pub hausdorff: f64,
    /// Some point of one surface is at least as far as this from the other: the true Hausdorff distance is between this
    /// and [`Self::hausdorff`].
    pub attained: f64,
    /// Distances from points of the first surface to the second.
    pub there: Spread,
    /// Distances from points of the second surface to the first.
    pub back: Spread,
    /// How many pieces were split and cells cut: what the bound has cost.
    pub splits: usize,
}

impl Deviation {
    /// The root mean square distance of the direction in which it is larger.
    pub fn rms(&self) -> f64 {
        self.there.rms.max(self.back.rms)
    }
}

/// The two-sided deviation between two surfaces. O(n log n) to prepare and, for surfaces that resemble each other,
/// about as much to measure: two seconds or so for half a million triangles.
///
/// A [`Ruler`] spares preparing the first surface again where several are measured against it.
///
/// # Errors
/// [`DeviationError`], for surfaces that are none and options out of range.
pub fn deviation(first: &Surface, second: &Surface, options: &Options) -> Result<Deviation, DeviationError> {
    Ruler::new(first)?.deviation(second, options)
}

/// The contract of a chain of levels: for each level the largest bound so far, rounded up to single precision. A
/// coarser level is never said to be truer than a finer one.
pub fn running_max(chain: &[Deviation]) -> Vec<f32> {
    let so_far = |most: &mut f32, level: &Deviation| {
        *most = most.max(bvh::round_up(level.hausdorff));
        Some(*most)
    };
    chain.iter().scan(0.0, so_far).collect()
}

/// A surface that others are measured against.
#[derive(Clone, Debug)]
pub struct Ruler {
    origin: glam::DVec3,
    shape: Shape,
}

impl Ruler {
    /// Prepares a surface; O(n log n), some 0.4 s for half a million triangles.
    ///
    /// # Errors
    /// [`DeviationError`], for a surface that is none.
    pub fn new(surface: &Surface) -> Result<Self, DeviationError> {
        let origin = shape::origin(surface);
        Ok(Self { origin, shape: Shape::new(surface, origin)? })
    }

    /// The deviation between the ruler's surface (the first) and another one.
    ///
    /// # Errors
    /// [`DeviationError`], for a surface that is none and options out of range.
    pub fn deviation(&self, surface: &Surface, options: &Options) -> Result<Deviation, DeviationError> {
        options.check()?;
        let other = Shape::new(surface, self.origin)?;
        if nothing_in([self.shape.is_empty(), other.is_empty()])? || self.shape.corners == other.corners {
            return Ok(Deviation::default());
        }
        Ok(measure(&self.shape, &other, options))
    }
}

/// Whether there is nothing to measure, by which surfaces are empty.
fn nothing_in(empty: [bool; 2]) -> Result<bool, DeviationError> {
    match empty.into() {
        (true, true) => Ok(true),
        (false, false) => Ok(false),
        _ => Err(DeviationError::OneIsEmpty),
    }
}

/// Samples both ways, then bounds both ways, each step knowing the largest distance found by those before it: the
/// finer surface first, as each of its triangles is mostly close to a single one of the other.
fn measure(first: &Shape, second: &Shape, options: &Options) -> Deviation {
    let there = sampling::sample(first, second, options);
    let back = sampling::sample(second, first, options);
    let start = Extent::at_least(there.max.max(back.max));
    let is_finer = first.corners.len() >= second.corners.len();
    let [fine, coarse] = if is_finer { [first, second] } else { [second, first] };
    let extent = hausdorff::bound(fine, coarse, start, options);
    let extent = hausdorff::bound(coarse, fine, extent, options);
    let Extent { attained, bound, splits } = extent;
    Deviation { hausdorff: bound, attained, there, back, splits }
}

/// Why two surfaces have no deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviationError {
    /// A triangle that is none.
    Triangle {
        /// Its index.
        triangle: usize,
        /// What is wrong with it.
        flaw: Flaw,
    },
    /// More than 2³¹ − 1 triangles.
    TooManyTriangles,
    /// One of the surfaces has triangles, the other has none.
    OneIsEmpty,
    /// An option out of its range; the rule it breaks.
    Options(&'static str),
}

/// What is wrong with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flaw {
    /// It names a vertex that does not exist.
    NoSuchVertex {
        /// The index of the vertex.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// One of its vertices is infinite or not a number.
    NotFinite {
        /// The index of the vertex.
        vertex: u32,
    },
}

impl fmt::Display for DeviationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Triangle { triangle, flaw } => write!(f, "triangle {triangle}: {flaw}"),
            Self::TooManyTriangles => f.write_str("a surface may have 2147483647 triangles"),
            Self::OneIsEmpty => {
                f.write_str("a surface without triangles is at no distance from one with triangles")
            }
            Self::Options(rule) => f.write_str(rule),
        }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSuchVertex { vertex, vertices } => {
                write!(f, "there is no vertex {vertex} among {vertices}")
            }
            Self::NotFinite { vertex } => write!(f, "vertex {vertex} is not finite"),
        }
    }
}

impl std::error::Error for DeviationError {}
