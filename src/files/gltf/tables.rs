//! Tables out of groups, shared by those that are alike; and when the author wants which level.

use std::collections::BTreeMap;

use ::gltf::json;
use glam::DMat4;
use serde_json::Value;

use super::Refused;
use super::baked::Baked;
use super::groups::{Group, Part};
use super::meshes::{Box3, Measured};
use crate::scene::TableId;
use crate::table::{LevelRecord, LodTable, accuracy_of};

/// Width of the image over its height that a coverage is converted for.
const ASPECT: f64 = 16.0 / 9.0;

/// Tangent of half the vertical field of view of 60° that distances are converted for.
const HALF_FOV_TAN: f64 = 0.577_350_269_189_625_8;

/// The projected diameter, as a fraction of the viewport's height, of a disc that covers `coverage` (≥ 0) of a 16:9
/// image: √(coverage · 16/9 · 4/π). A coverage of 0.01 is a diameter of 0.15, one of 0.44 as high as the image.
pub fn size_of_coverage(coverage: f32) -> f32 {
    (f64::from(coverage) * ASPECT * 4.0 / std::f64::consts::PI).sqrt() as f32
}

/// The share of a 16:9 image that a disc covers whose diameter is `size` (≥ 0) of the image's height: the inverse of
/// [`size_of_coverage`], for whoever writes `MSFT_screencoverage`.
pub fn coverage_of_size(size: f32) -> f32 {
    let size = f64::from(size);
    (size * size * std::f64::consts::PI / (4.0 * ASPECT)) as f32
}

/// When an author wants which level.
pub(super) struct Switching {
    levels: usize,
    coverage: Option<Vec<f64>>,
    max_distance: Option<Vec<f64>>,
}

impl Switching {
    /// What the `extras` of `node` say about `levels` levels.
    pub(super) fn of(node: &json::Node, levels: usize) -> Result<Self, String> {
        let extras = node.extras.as_ref().map(|e| serde_json::from_str::<Value>(e.get()));
        let extras = extras.transpose().map_err(|e| format!("its extras cannot be read: {e}"))?;
        let list = |key, least| match extras.as_ref().and_then(|e| e.get(key)) {
            Some(value) => numbers(value, least).map(Some).ok_or_else(|| {
                format!("its extras.{key} must be a list of numbers that are finite and not below {least}")
            }),
            None => Ok(None),
        };
        let coverage = list("MSFT_screencoverage", 0.0)?;
        let max_distance = list("lod_max_distance", f64::MIN_POSITIVE)?;
        if coverage.as_ref().is_some_and(|c| c.len() > levels) {
            return Err(format!(
                "its extras.MSFT_screencoverage must have a value per level, of which it has {levels}"
            ));
        }
        if max_distance.as_ref().is_some_and(|d| d.len() != levels) {
            return Err(format!(
                "its extras.lod_max_distance must have a value per level, of which it has {levels}"
            ));
        }
        Ok(Self { levels, coverage, max_distance })
    }

    /// Per level, the least size that an object of this radius in the world should have.
    pub(super) fn min_sizes(&self, radius: f32) -> Vec<Option<f32>> {
        let by_distance = |d: &f64| f64::from(radius) / (d * HALF_FOV_TAN);
        let sizes: Vec<f32> = match (&self.coverage, &self.max_distance) {
            (Some(coverage), _) => coverage.iter().map(|&c| size_of_coverage(c as f32)).collect(),
            (None, Some(distances)) if self.levels > 1 => {
                distances.iter().map(|d| by_distance(d) as f32).collect()
            }
            _ => Vec::new(),
        };
        (0..self.levels).map(|level| sizes.get(level).copied()).collect()
    }

    /// The distance beyond which nothing is drawn; infinite where nobody said.
    pub(super) fn draw_distance(&self) -> f32 {
        let distances = self.max_distance.iter().flatten().copied();
        distances.reduce(f64::max).map_or(f32::INFINITY, |d| d as f32)
    }
}

fn numbers(value: &Value, least: f64) -> Option<Vec<f64>> {
    let number = |v: &Value| v.as_f64().filter(|x| x.is_finite() && *x >= least);
    value.as_array()?.iter().map(number).collect()
}

/// What the tables of one sort of object have in common, whatever their switching data.
pub(super) struct Shape {
    name: String,
    bounds: Box3,
    levels: Vec<LevelRecord>,
}

/// Mesh and, where it is not the identity, transform of each part, level by level.
type ShapeKey = Vec<Vec<(usize, Option<[u64; 16]>)>>;

/// Shape, and the bits of every `min_size`.
type TableKey = (usize, Vec<Option<u32>>);

/// Shapes and tables as they are found, each once.
pub(super) struct Tables<'a> {
    file: &'a str,
    shapes: Vec<Shape>,
    shape_keys: BTreeMap<ShapeKey, usize>,
    tables: Vec<LodTable>,
    table_keys: BTreeMap<TableKey, TableId>,
    names: BTreeMap<String, usize>,
}

impl<'a> Tables<'a> {
    pub(super) fn new(file: &'a str) -> Self {
        Self {
            file,
            shapes: Vec::new(),
            shape_keys: BTreeMap::new(),
            tables: Vec::new(),
            table_keys: BTreeMap::new(),
            names: BTreeMap::new(),
        }
    }

    /// The shape of a group; `None` where it draws nothing at any level.
    pub(super) fn shape(
        &mut self,
        group: &Group,
        meshes: &mut Measured<'_>,
    ) -> Result<Option<usize>, Refused> {
        let Some(first) = group.levels.iter().flatten().next() else { return Ok(None) };
        let key = shape_key(group);
        if let Some(&known) = self.shape_keys.get(&key) {
            return Ok(Some(known));
        }
        let mut shape =
            Shape { name: mesh_name(meshes, first.mesh), bounds: Box3::EMPTY, levels: Vec::new() };
        let mut baked = Vec::new();
        for parts in &group.levels {
            baked.push(shape.push_level(parts, meshes)?);
        }
        shape.tell(&baked);
        shape.bounds = shape.bounds.with_extent();
        self.shape_keys.insert(key, self.shapes.len());
        self.shapes.push(shape);
        Ok(Some(self.shapes.len() - 1))
    }

    /// The box around all levels of a shape, in object units.
    pub(super) fn shape_box(&self, shape: usize) -> Box3 {
        self.shapes[shape].bounds
    }

    /// The table of a shape whose levels are wanted from these sizes on.
    pub(super) fn table(&mut self, shape: usize, min_sizes: &[Option<f32>]) -> Result<TableId, Refused> {
        let key = (shape, min_sizes.iter().map(|size| size.map(f32::to_bits)).collect());
        if let Some(&known) = self.table_keys.get(&key) {
            return Ok(known);
        }
        let id = u16::try_from(self.tables.len()).map(TableId);
        let rule = || "there can be at most 65536 tables".to_owned();
        let id = id.map_err(|_| Refused { place: None, rule: rule() })?;
        let name = self.unused_name(shape);
        let Shape { bounds, levels, .. } = &self.shapes[shape];
        let levels = levels.iter().zip(min_sizes).map(|(l, &min_size)| LevelRecord { min_size, ..*l });
        let table = LodTable::new(name, bounds.placed(DMat4::IDENTITY), levels.collect());
        self.tables.push(table.map_err(|e| super::super::of_table(e, self.file))?);
        self.table_keys.insert(key, id);
        Ok(id)
    }

    pub(super) fn into_tables(self) -> Vec<LodTable> {
        self.tables
    }

    /// The name of a shape, numbered from the second table on that would have it.
    fn unused_name(&mut self, shape: usize) -> String {
        let name = &self.shapes[shape].name;
        let mut number = self.names.get(name).copied().unwrap_or(0);
        let free = loop {
            number += 1;
            let candidate = if number == 1 { name.clone() } else { format!("{name} #{number}") };
            if number == 1 || !self.names.contains_key(&candidate) {
                break candidate;
            }
        };
        self.names.insert(name.clone(), number);
        self.names.entry(free.clone()).or_insert(1);
        free
    }
}

fn shape_key(group: &Group) -> ShapeKey {
    let bits = |m: &DMat4| (*m != DMat4::IDENTITY).then(|| m.to_cols_array().map(f64::to_bits));
    let level = |parts: &Vec<Part>| parts.iter().map(|p| (p.mesh, bits(&p.transform))).collect();
    group.levels.iter().map(level).collect()
}

fn mesh_name(meshes: &Measured<'_>, mesh: usize) -> String {
    let name = meshes.document().meshes()[mesh].name.clone();
    name.unwrap_or_else(|| format!("mesh {mesh}"))
}

impl Shape {
    /// Adds a level, and returns what was measured of it.
    fn push_level(&mut self, parts: &[Part], meshes: &mut Measured<'_>) -> Result<Baked, Refused> {
        let mut baked = Vec::new();
        let mut sums = [0_u64; 4];
        for part in parts {
            let m = meshes.measure(part.mesh)?;
            self.bounds = self.bounds.union(m.bounds.transformed(&part.transform));
            for (sum, more) in sums.iter_mut().zip([m.triangles, m.vertices, m.draws, m.bytes]) {
                *sum = sum.saturating_add(more);
            }
            baked.push((m.baked, part.transform));
        }
        let place = || format!("table '{}', level {}", self.name, self.levels.len());
        let rule = "triangles, vertices and draws must each be at most 4294967295";
        let narrow = |n: u64| u32::try_from(n).map_err(|_| Refused::at(place(), rule));
        let [triangles, vertices, draws, bytes] = sums;
        let (triangles, vertices, draws) = (narrow(triangles)?, narrow(vertices)?, narrow(draws)?);
        let accuracy = accuracy_of(triangles);
        self.levels.push(LevelRecord {
            triangles,
            vertices,
            draws,
            bytes,
            error: None,
            accuracy,
            min_size: None,
        });
        Ok(Baked::joined(baked.into_iter()))
    }

    /// Tells every level what was measured of it.
    fn tell(&mut self, baked: &[Baked]) {
        for (level, baked) in self.levels.iter_mut().zip(baked).skip(1) {
            baked.tell(level);
        }
        if let (Some(level), [finest, coarser @ ..]) = (self.levels.first_mut(), baked) {
            finest.tell_finest(level, coarser);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_and_size_are_inverse() {
        for coverage in [0.0, 0.01, 0.2, 0.5, 1.0] {
            assert!((coverage_of_size(size_of_coverage(coverage)) - coverage).abs() < 1e-6);
        }
        let full = std::f32::consts::PI / 4.0 * 9.0 / 16.0;
        assert!((size_of_coverage(full) - 1.0).abs() < 1e-6, "a disc as high as the image");
    }

    #[test]
    fn sixty_degrees() {
        assert!((HALF_FOV_TAN - 30.0_f64.to_radians().tan()).abs() < 1e-15);
    }

    #[test]
    fn names_are_never_given_twice() {
        let mut tables = Tables::new("a.glb");
        for name in ["a", "a #2", "a"] {
            let shape = Shape { name: name.to_owned(), bounds: Box3::EMPTY, levels: Vec::new() };
            tables.shapes.push(shape);
        }
        let names: Vec<_> = [0, 1, 2, 0, 1].map(|shape| tables.unused_name(shape)).into();
        assert_eq!(names, ["a", "a #2", "a #3", "a #4", "a #2 #2"]);
    }
}
