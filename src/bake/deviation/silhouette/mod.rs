//! How far the silhouettes of two surfaces are apart, seen from a few directions.
//!
//! What is seen of a level first is its outline against the background, and how much it covers: a tree whose leaves went
//! one by one has lost its crown long before any point of it is far from the original. So both surfaces are drawn from
//! [13 directions](DIRECTIONS), without perspective, and for each of these views it is measured
//! - how far a point of what one surface covers can be from what the other one covers: the Hausdorff distance between
//!   the covered regions. Where an outline moves, it is how far it moves; where a hole closes, the hole's radius;
//! - how much each of them covers.
//!
//! Distances between outlines as curves are not taken: a crack that closes, however narrow, is a curve that has gone, and
//! would count as if the surface about it had gone too.
//!
//! An estimate, of known resolution: of each of these views the distance is within [`View::error`] of the true one, as
//! every pixel that a surface touches counts as covered and stands for its centre. Of what is seen from other directions
//! nothing is known but that no silhouette moves farther than the
//! [Hausdorff distance](super::Deviation::hausdorff) of the surfaces themselves.

mod distances;
mod drawing;
mod mask;

use glam::{DVec2, DVec3, Vec3};

use super::shape::check;
use super::{DeviationError, nothing_in};
use crate::bake::surface::Surface;
use distances::Distances;
use drawing::{Drawing, Frame};
use mask::Mask;

/// The directions of the views, not normalised: along the axes, the diagonals of their planes, and the diagonals of
/// space. From the opposite direction a silhouette is the same in a mirror.
pub const DIRECTIONS: [DVec3; 13] = [
    DVec3::X,
    DVec3::Y,
    DVec3::Z,
    DVec3::new(1.0, 1.0, 0.0),
    DVec3::new(1.0, -1.0, 0.0),
    DVec3::new(1.0, 0.0, 1.0),
    DVec3::new(1.0, 0.0, -1.0),
    DVec3::new(0.0, 1.0, 1.0),
    DVec3::new(0.0, 1.0, -1.0),
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(1.0, 1.0, -1.0),
    DVec3::new(1.0, -1.0, 1.0),
    DVec3::new(-1.0, 1.0, 1.0),
];

/// How finely to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Pixels along the longer side of the box around both silhouettes, from 16 to 8192.
    pub resolution: usize,
}

impl Default for Options {
    /// 512 pixels: distances within 0.3 % of the silhouettes' size.
    fn default() -> Self {
        Self { resolution: 512 }
    }
}

/// How far silhouettes are apart, from all directions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SilhouetteDeviation {
    /// One per direction, in the order of [`DIRECTIONS`]; none of surfaces that are both empty.
    pub views: Vec<View>,
}

/// Two silhouettes from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// How far a point of one silhouette can be from the other, in object units.
    pub distance: f64,
    /// The true distance differs by no more than this, in object units: 1.5 pixels.
    pub error: f64,
    /// The areas that the first and the second surface cover, in square object units: of the pixels whose centres are
    /// covered.
    pub areas: [f64; 2],
}

impl SilhouetteDeviation {
    /// The largest distance of all views, in object units.
    pub fn distance(&self) -> f64 {
        self.views.iter().map(|view| view.distance).fold(0.0, f64::max)
    }

    /// The true distance, the largest from the same directions, differs by no more than this, in object units.
    pub fn error(&self) -> f64 {
        self.views.iter().map(|view| view.error).fold(0.0, f64::max)
    }

    /// By which share of what the first surface covers the second one covers more, all views together; negative where it
    /// covers less. `None` where the first one covers no pixel's centre.
    pub fn area_change(&self) -> Option<f64> {
        let [first, second] = [0, 1].map(|side| self.views.iter().map(|view| view.areas[side]).sum::<f64>());
        (first > 0.0).then_some(second / first - 1.0)
    }
}

/// How far the silhouettes of two surfaces are apart. Some 0.3 s for two surfaces of half a million triangles.
///
/// O(triangles + pixels) per direction, but for triangles larger than a pixel, which cost their height in pixels.
///
/// # Errors
/// [`DeviationError`], for surfaces that are none, where one has triangles and the other none, and for options out of
/// range.
pub fn deviation(
    first: &Surface,
    second: &Surface,
    options: &Options,
) -> Result<SilhouetteDeviation, DeviationError> {
    if !(16..=8192).contains(&options.resolution) {
        return Err(DeviationError::Options("`resolution` is from 16 to 8192"));
    }
    check(first)?;
    check(second)?;
    if nothing_in([first, second].map(|surface| surface.triangles.is_empty()))? {
        return Ok(SilhouetteDeviation::default());
    }
    let figures = [first, second].map(used);
    let view = |direction: &DVec3| view(&figures, *direction, options.resolution);
    Ok(SilhouetteDeviation { views: DIRECTIONS.iter().map(view).collect() })
}

/// The surface without the vertices that no triangle uses.
fn used(surface: &Surface) -> Surface {
    let mut numbers = vec![u32::MAX; surface.positions.len()];
    let mut used = Surface::default();
    for corners in &surface.triangles {
        used.triangles.push(corners.map(|vertex| {
            let number = &mut numbers[vertex as usize];
            if *number == u32::MAX {
                *number = used.positions.len() as u32;
                used.positions.push(surface.positions[vertex as usize]);
            }
            *number
        }));
    }
    used
}

/// Draws both surfaces on one sheet and measures how far apart they are.
fn view(figures: &[Surface; 2], direction: DVec3, resolution: usize) -> View {
    let (right, up) = direction.normalize().any_orthonormal_pair();
    let flat = |p: &Vec3| DVec2::new(p.as_dvec3().dot(right), p.as_dvec3().dot(up));
    let shadows = figures.each_ref().map(|figure| figure.positions.iter().map(flat).collect::<Vec<DVec2>>());
    let frame = Frame::around(shadows.iter().flatten(), resolution);
    let [first, second] = [0, 1].map(|side| frame.draw(&shadows[side], &figures[side].triangles));
    let far2 = farthest2(&first.touched, &second.touched).max(farthest2(&second.touched, &first.touched));
    let area = |drawn: &Drawing| drawn.covered.count() as f64 * frame.pixel * frame.pixel;
    View {
        distance: f64::from(far2).sqrt() * frame.pixel,
        error: 1.5 * frame.pixel,
        areas: [area(&first), area(&second)],
    }
}

/// The largest squared distance from a pixel of `from` to the nearest one of `to`, in pixels.
fn farthest2(from: &Mask, to: &Mask) -> u32 {
    if from.is_within(to) {
        return 0;
    }
    let mut distances = Distances::new(to);
    let mut farthest2 = 0;
    for row in 0..from.rows() {
        if !from.is_row_within(to, row) {
            let distances2 = distances.of_row(row);
            farthest2 = from.in_row(row).map(|column| distances2[column]).fold(farthest2, u32::max);
        }
    }
    farthest2
}
