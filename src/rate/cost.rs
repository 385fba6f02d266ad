//! What drawing costs: coefficients per draw call, vertex, triangle and pixel.

use std::fmt;

use crate::table::LevelRecord;

/// How many coefficients a cost model has.
pub const DRIVERS: usize = 4;

/// The names of the coefficients, in the order of [`Drivers`] and [`CostModel::coefficients`].
pub const DRIVER_NAMES: [&str; DRIVERS] = ["draw", "vertex", "triangle", "pixel"];

/// Counts of draw calls, vertices, triangles and pixels.
pub type Drivers = [f64; DRIVERS];

/// How the geometry stage and the pixel stage of an object add up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Stages {
    /// One after the other: their times add up.
    #[default]
    Sum,
    /// Both at once: the slower one counts. Cost = max(C₁·polygons + C₂·vertices, C₃·pixels) after Funkhouser and
    /// Séquin 1993, with draw calls on the side of geometry.
    Max,
}

/// The predicted time of drawing, in microseconds per unit.
///
/// The default is that of an entry-level graphics card, from published render times (Godot's nightly benchmarks,
/// 2023–25) of a Radeon RX 550, a UHD 730 and a GeForce GT 1030 that draw 100 to 10 000 boxes of 12 and spheres of 4
/// 224 triangles: 0.1, 0.2 and 0.35 µs per object, and 1.0, 2.0 and 1.5 ns per triangle with the half vertex that comes
/// with it. They say nothing of pixels: 0.01 ns is a tenth of a nanosecond for one pixel in ten, since the projected
/// area is that of the bounding sphere, most of which is empty or covered.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CostModel {
    /// µs per draw call.
    pub draw_us: f64,
    /// µs per vertex.
    pub vertex_us: f64,
    /// µs per triangle.
    pub triangle_us: f64,
    /// µs per pixel of projected area.
    pub pixel_us: f64,
    /// How the stages add up.
    pub stages: Stages,
}

impl Default for CostModel {
    fn default() -> Self {
        Self { draw_us: 0.2, vertex_us: 0.001, triangle_us: 0.001, pixel_us: 0.000_01, stages: Stages::Sum }
    }
}

impl CostModel {
    /// The coefficients in the order of [`DRIVER_NAMES`].
    pub fn coefficients(&self) -> Drivers {
        [self.draw_us, self.vertex_us, self.triangle_us, self.pixel_us]
    }

    /// The same stages with other coefficients.
    pub fn with_coefficients(&self, [draw_us, vertex_us, triangle_us, pixel_us]: Drivers) -> Self {
        Self { draw_us, vertex_us, triangle_us, pixel_us, stages: self.stages }
    }

    /// Time of a level's geometry: draw calls, vertices and triangles, drawn once.
    pub fn geometry_us(&self, level: &LevelRecord) -> f64 {
        let [draws, vertices, triangles, _] = drivers_of(level);
        self.draw_us * draws + self.vertex_us * vertices + self.triangle_us * triangles
    }

    /// Time of an object from its geometry (drawn `cost_scale` times) and its projected area.
    pub fn object_us(&self, geometry_us: f64, cost_scale: f64, area_px2: f64) -> f64 {
        let (geometry, pixels) = (geometry_us * cost_scale, self.pixel_us * area_px2);
        match self.stages {
            Stages::Sum => geometry + pixels,
            Stages::Max => geometry.max(pixels),
        }
    }

    /// Whether the model can be used.
    ///
    /// # Errors
    /// Names the coefficient that is negative, not finite or above a second.
    pub fn check(&self) -> Result<(), CostModelError> {
        let bad = self.coefficients().into_iter().position(|c| !(0.0..=1e6).contains(&c));
        match bad {
            Some(i) => Err(CostModelError { coefficient: DRIVER_NAMES[i] }),
            None => Ok(()),
        }
    }
}

/// What drawing a level once counts, without its pixels.
pub fn drivers_of(level: &LevelRecord) -> Drivers {
    [f64::from(level.draws), f64::from(level.vertices), f64::from(level.triangles), 0.0]
}

/// Why a cost model was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CostModelError {
    /// The coefficient at fault.
    pub coefficient: &'static str,
}

impl fmt::Display for CostModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cost model: the {} coefficient must be from 0 to 1e6 µs", self.coefficient)
    }
}

impl std::error::Error for CostModelError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slower_stage_counts_or_both_do() {
        let sum = CostModel { pixel_us: 1.0, ..CostModel::default() };
        let max = CostModel { stages: Stages::Max, ..sum };
        assert_eq!(sum.object_us(3.0, 2.0, 10.0), 16.0);
        assert_eq!(max.object_us(3.0, 2.0, 10.0), 10.0);
        assert_eq!(max.object_us(3.0, 5.0, 10.0), 15.0);
    }

    #[test]
    fn a_coefficient_that_is_no_time_is_named() {
        let broken = CostModel { vertex_us: f64::NAN, ..CostModel::default() };
        assert_eq!(broken.check(), Err(CostModelError { coefficient: "vertex" }));
    }
}
