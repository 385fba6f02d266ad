//! A kind of object: parts of parametric shapes, and how finely each level draws each part.

use glam::Vec3;

use super::shape::Shape;
use crate::bounds::Sphere;
use crate::scene::Settings;
use crate::table::{LevelRecord, LodTable, accuracy_of};

/// What an artist would hand in: a named object in metres, standing on the point it is placed at.
pub(super) struct Kind {
    name: String,
    size: [f64; 3],
    parts: Vec<Part>,
    one_draw_from: usize,
    settings: Settings,
}

/// Equal shapes of one material, and their detail per level, finest first.
struct Part {
    material: &'static str,
    shape: Shape,
    times: u32,
    details: Vec<u32>,
    /// No point of it is farther than this from the parts that stay when it is left out.
    sticks_out: f64,
}

impl Part {
    fn detail(&self, level: usize) -> u32 {
        self.details.get(level).copied().unwrap_or(0)
    }
}

impl Kind {
    /// Width, height and depth of the box around it.
    pub fn new(name: impl Into<String>, size: [f64; 3]) -> Self {
        Self {
            name: name.into(),
            size,
            parts: Vec::new(),
            one_draw_from: usize::MAX,
            settings: Settings::default(),
        }
    }

    /// Adds `times` equal shapes. Every part touches one that stays as long as it does.
    pub fn part(self, material: &'static str, shape: Shape, times: u32, details: &[u32]) -> Self {
        self.trim(material, shape, times, details, shape.extent())
    }

    /// Adds shapes that lie on a part that stays, and stick out of it by so much at most.
    pub fn trim(
        mut self,
        material: &'static str,
        shape: Shape,
        times: u32,
        details: &[u32],
        sticks_out: f64,
    ) -> Self {
        self.parts.push(Part { material, shape, times, details: details.to_vec(), sticks_out });
        self
    }

    /// From this level on, all materials share one atlas and are drawn in one call.
    pub fn one_draw_from(self, level: usize) -> Self {
        Self { one_draw_from: level, ..self }
    }

    /// Not drawn beyond this distance, in metres.
    pub fn seen_to(mut self, distance: f64) -> Self {
        self.settings.draw_distance = distance as f32;
        self
    }

    /// Factor on its benefit.
    pub fn importance(mut self, factor: f32) -> Self {
        self.settings.importance = factor;
        self
    }

    /// Factor on its cost, for skinning or an expensive material.
    pub fn cost(mut self, factor: f32) -> Self {
        self.settings.cost_multiplier = factor;
        self
    }

    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The table of its levels. The error of a level is the largest over its parts of
    /// - the part's deviation from its smooth shape plus that of level 0, where it is drawn, and
    /// - how far the part sticks out where it is left out (its diameter, unless told), or the reach of a stand-in
    ///   where that is less,
    ///
    /// rounded up to a tenth of a millimetre; the accuracy follows the number of triangles.
    ///
    /// # Panics
    /// A kind without a part or without an extent is a mistake in this crate.
    pub fn table(&self) -> LodTable {
        let levels = self.parts.iter().map(|p| p.details.len()).max().unwrap_or(0);
        let mut records: Vec<LevelRecord> = (0..levels).map(|level| self.level(level)).collect();
        let mut worst = 0.0f32;
        for record in &mut records {
            worst = worst.max(record.error.unwrap_or(0.0));
            record.error = Some(worst);
        }
        LodTable::new(&self.name, self.bounds(), records).expect("every kind has an extent and a level")
    }

    fn bounds(&self) -> Sphere {
        let [width, height, depth] = self.size;
        let radius = (width * width + height * height + depth * depth).sqrt() / 2.0;
        let round_up = |x: f64| (x * 1000.0).ceil() / 1000.0;
        Sphere::new(Vec3::new(0.0, (height / 2.0) as f32, 0.0), round_up(radius) as f32)
    }

    fn level(&self, level: usize) -> LevelRecord {
        let sum = |count: fn(Shape, u32) -> u32| {
            self.parts.iter().map(|p| p.times * count(p.shape, p.detail(level))).sum::<u32>()
        };
        let (triangles, vertices) = (sum(Shape::triangles), sum(Shape::vertices));
        LevelRecord {
            triangles,
            vertices,
            draws: self.draws(level),
            bytes: bytes_of(triangles, vertices),
            error: Some(((self.deviation(level) * 1e4).ceil() / 1e4) as f32),
            accuracy: accuracy_of(triangles),
            min_size: None,
        }
    }

    fn draws(&self, level: usize) -> u32 {
        if level >= self.one_draw_from {
            return 1;
        }
        let drawn = self.parts.iter().filter(|p| p.detail(level) > 0);
        let mut materials: Vec<&str> = drawn.map(|p| p.material).collect();
        materials.sort_unstable();
        materials.dedup();
        materials.len() as u32
    }

    fn deviation(&self, level: usize) -> f64 {
        let reach = self.reach(level);
        let of_part = |part: &Part| match (part.detail(0), part.detail(level)) {
            (_, now) if level == 0 || now == 0 && part.detail(0) == 0 => 0.0,
            (0, _) => part.shape.extent(),
            (_, 0) => part.sticks_out.min(reach),
            (finest, now) => part.shape.deviation(now) + part.shape.deviation(finest),
        };
        self.parts.iter().map(of_part).fold(0.0, f64::max)
    }

    /// How far at most what a level leaves out is from what stands in for it.
    fn reach(&self, level: usize) -> f64 {
        let drawn = self.parts.iter().filter(|p| p.detail(level) > 0);
        drawn.fold(f64::INFINITY, |reach, part| match part.shape {
            Shape::StandIn { reach: r, .. } => reach.min(r),
            _ => reach,
        })
    }
}

/// 32 bytes a vertex (position, normal, tangent and texture coordinates, packed) and three indices a triangle, of two
/// bytes where they suffice.
fn bytes_of(triangles: u32, vertices: u32) -> u64 {
    let index = if vertices > 1 << 16 { 4 } else { 2 };
    32 * u64::from(vertices) + 3 * index * u64::from(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn toadstool() -> Kind {
        Kind::new("toadstool", [0.2, 0.3, 0.2])
            .part("cap", Shape::Sphere { radius: 0.1 }, 1, &[32, 8, 0])
            .trim("cap", Shape::Sphere { radius: 0.01 }, 20, &[8, 0, 0], 0.015)
            .part("stem", Shape::Tube { radius: 0.02, length: 0.2 }, 1, &[16, 8, 0])
            .part("card", Shape::StandIn { triangles: 4, vertices: 8, reach: 0.12 }, 1, &[0, 0, 1])
            .one_draw_from(2)
    }

    #[test]
    fn counts_are_summed_over_parts() {
        let table = toadstool().table();
        let counts: Vec<_> = table.levels().iter().map(|l| (l.triangles, l.vertices, l.draws)).collect();
        let finest = (960 + 20 * 48 + 32, 482 + 20 * 26 + 32, 2);
        assert_eq!(counts, [finest, (48 + 16, 26 + 16, 2), (4, 8, 1)]);
    }

    #[test]
    fn the_worst_part_is_the_error() {
        let table = toadstool().table();
        let sphere = Shape::Sphere { radius: 0.1 };
        let coarse = sphere.deviation(8) + sphere.deviation(32);
        assert!(coarse > 0.015);
        let errors: Vec<_> = table.levels().iter().map(|l| l.error.unwrap_or(f32::NAN)).collect();
        assert_eq!(errors[0], 0.0);
        assert!((coarse as f32..coarse as f32 + 1e-4).contains(&errors[1]));
        assert_eq!(errors[2], 0.12);
    }
}
