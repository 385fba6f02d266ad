//! Scenes as JSON, the project's own format, version 1.
//!
//! ```json
//! {
//!   "format": "lod-budget scene",
//!   "version": 1,
//!   "name": "yard",
//!   "tables": [
//!     {"name":"tree","center":[0.0,2.0,0.0],"radius":2.5,"levels":[
//!       {"triangles":1200,"vertices":700,"accuracy":0.9996,"error":0.0},
//!       {"triangles":90,"vertices":60,"accuracy":0.994,"error":0.08}
//!     ]}
//!   ],
//!   "objects": [
//!     {"id":1,"table":"tree","center":[4.0,2.0,-9.0],"radius":2.5},
//!     {"id":2,"table":"tree","center":[8.0,4.0,-9.0],"radius":5.0,"importance":2.0}
//!   ]
//! }
//! ```
//!
//! **Scene**: `format` and `version` as above; `name` (the file's name without one); `tables`; `objects`, which may
//! be empty.
//!
//! **Table**: `name`, unique; `center` (default `[0,0,0]`) and `radius` (> 0) of the bound of all levels, in object
//! units; `levels`, finest first, 1 to 254 of them.
//!
//! **Level**: `triangles`, `vertices`, `accuracy` (0 to 1); `draws` (default 1), `bytes` (default 0), `error`
//! (geometric, in object units; left out where nobody measured it), `min_size` (the smallest projected diameter, as a
//! fraction of the viewport's height, at which an author wants this level; left out where nobody said).
//!
//! **Object**: `id` (0 to 2⁶⁴ − 1, unique), `table` (a name), `center` and `radius` (≥ 0) of its bound in the world.
//! What it asks of the selection, each with the default of [`Settings`] where it is left out: `importance`, `bias`,
//! `cost_multiplier`, `clamp` (`[finest, coarsest]`), `forced` (a level), `resident` (`[finest, coarsest]`),
//! `may_skip`, `draw_distance`, `hidden`, `velocity` (`[x, y, z]`).
//!
//! Unknown keys, duplicate keys and numbers that a 32-bit float cannot hold are refused. Distances are in metres by
//! convention; nothing depends on it.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use glam::Vec3;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::json::{Entry, Listed, parse};
use super::{FileError, Scene, disk};
use crate::bounds::Sphere;
use crate::scene::{LevelRange, Object, Settings, TableId};
use crate::table::{Level, LevelRecord, LodTable};

const FORMAT: &str = "lod-budget scene";
const VERSION: u64 = 1;

impl Scene {
    /// Reads the JSON described in [`crate::files::scene_json`]. `file` names it in errors.
    ///
    /// # Errors
    /// Whatever is not as described, naming the object by its id, or by its position where it has none yet.
    pub fn from_json(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        let text = disk::text_of(bytes, file)?;
        check_header(&parse(text, file)?, file)?;
        let document: Document = parse(text, file)?;
        let scene = document.into_scene(file)?;
        match broken_rule(&scene) {
            Some((place, rule)) => Err(FileError { file: file.to_owned(), place, rule }),
            None => Ok(scene),
        }
    }

    /// The scene as JSON: one level or object a line, settings only where they differ from the default, floats in
    /// the fewest digits that read back as the same number. Equal scenes give equal bytes.
    ///
    /// # Errors
    /// What the format cannot hold: two tables of one name, an id used twice, an unknown table, a number that is not
    /// finite, a setting out of its range. The error names the scene where a file would be named.
    pub fn to_json(&self) -> Result<String, FileError> {
        if let Some((place, rule)) = broken_rule(self) {
            return Err(FileError { file: self.name.clone(), place, rule });
        }
        self.write_document().map_err(|e| FileError::whole(&self.name, e.to_string()))
    }

    fn write_document(&self) -> Result<String, serde_json::Error> {
        let tables = self.tables.iter().map(table_lines).collect::<Result<Vec<_>, _>>()?;
        let objects = self.objects.iter().map(|o| self.object_line(o)).collect::<Result<Vec<_>, _>>()?;
        Ok(format!(
            "{{\n  \"format\": \"{FORMAT}\",\n  \"version\": {VERSION},\n  \"name\": {},\n  \
             \"tables\": {},\n  \"objects\": {}\n}}\n",
            serde_json::to_string(&self.name)?,
            list("    ", &tables, "  "),
            list("    ", &objects, "  "),
        ))
    }

    fn object_line(&self, object: &Object) -> Result<String, serde_json::Error> {
        let table = self.tables[usize::from(object.table.0)].name();
        serde_json::to_string(&ObjectRow::of(object, table))
    }
}

/// A list with each entry on a line of its own.
fn list(indent: &str, entries: &[String], outer: &str) -> String {
    if entries.is_empty() {
        return "[]".to_owned();
    }
    format!("[\n{indent}{}\n{outer}]", entries.join(&format!(",\n{indent}")))
}

fn table_lines(table: &LodTable) -> Result<String, serde_json::Error> {
    let levels = table.levels().iter().map(|l| serde_json::to_string(&LevelRow::of(l)));
    let levels = levels.collect::<Result<Vec<_>, _>>()?;
    let Sphere { center, radius } = table.bounds();
    let mut line = format!("{{\"name\":{}", serde_json::to_string(table.name())?);
    if center != Vec3::ZERO {
        // Writing to a String cannot fail.
        let _ = write!(line, ",\"center\":{}", serde_json::to_string(&center.to_array())?);
    }
    let radius = serde_json::to_string(&radius)?;
    Ok(format!("{line},\"radius\":{radius},\"levels\":{}}}", list("      ", &levels, "    ")))
}

/// What a scene must have before anything else is looked at, so that a file of another kind is called that.
#[derive(Deserialize)]
struct Header {
    format: String,
    version: u64,
}

fn check_header(header: &Header, file: &str) -> Result<(), FileError> {
    if header.format != FORMAT {
        let rule = format!("its \"format\" must be \"{FORMAT}\", not \"{}\"", header.format);
        return Err(FileError::whole(file, rule));
    }
    if header.version != VERSION {
        let rule = format!("its \"version\" must be {VERSION}, not {}", header.version);
        return Err(FileError::whole(file, rule));
    }
    Ok(())
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    #[serde(rename = "format")]
    _format: IgnoredAny,
    #[serde(rename = "version")]
    _version: IgnoredAny,
    name: Option<String>,
    tables: Listed<TableRow>,
    objects: Listed<ObjectRow>,
}

impl Document {
    fn into_scene(self, file: &str) -> Result<Scene, FileError> {
        let name = self.name.unwrap_or_else(|| disk::stem(file));
        let tables = self.tables.0.into_iter().map(|t| t.into_table(file)).collect::<Result<Vec<_>, _>>()?;
        if let Some(name) = doubled_name(&tables) {
            return Err(FileError::at(file, format!("table '{name}'"), ONE_NAME));
        }
        let by_name = tables.iter().enumerate().map(|(i, t)| (t.name(), i)).collect();
        let objects = self.objects.0.iter().map(|o| o.to_object(&by_name, file));
        let objects = objects.collect::<Result<Vec<_>, _>>()?;
        Ok(Scene { name, tables, objects })
    }
}

const ONE_NAME: &str = "there must be no other table of that name";

/// A name that a table has in common with one before it.
fn doubled_name(tables: &[LodTable]) -> Option<&str> {
    let mut names = HashSet::new();
    tables.iter().map(LodTable::name).find(|name| !names.insert(*name))
}

/// What the format cannot hold, and where.
fn broken_rule(scene: &Scene) -> Option<(Option<String>, String)> {
    if let Some(name) = doubled_name(&scene.tables) {
        return Some((Some(format!("table '{name}'")), ONE_NAME.to_owned()));
    }
    if let Some(broken) = scene.objects.iter().find(|o| !o.bounds.is_valid()) {
        let rule = "center and radius must be finite, and the radius not negative";
        return Some((Some(format!("object {}", broken.id.0)), rule.to_owned()));
    }
    let refused = scene.to_objects().err()?;
    Some((refused.id.map(|id| format!("object {}", id.0)), refused.rule.to_owned()))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TableRow {
    name: String,
    #[serde(default)]
    center: [f32; 3],
    radius: f32,
    levels: Listed<LevelRow>,
}

impl Entry for TableRow {
    const KIND: &'static str = "table";
}

impl TableRow {
    fn into_table(self, file: &str) -> Result<LodTable, FileError> {
        let bounds = Sphere::new(self.center.into(), self.radius);
        let levels = self.levels.0.iter().map(LevelRow::to_record).collect();
        LodTable::new(self.name, bounds, levels).map_err(|e| super::of_table(e, file))
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LevelRow {
    triangles: u32,
    vertices: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    draws: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bytes: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<f32>,
    accuracy: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    min_size: Option<f32>,
}

impl Entry for LevelRow {
    const KIND: &'static str = "level";
}

impl LevelRow {
    fn of(level: &LevelRecord) -> Self {
        Self {
            triangles: level.triangles,
            vertices: level.vertices,
            draws: unless(1, level.draws),
            bytes: unless(0, level.bytes),
            error: level.error,
            accuracy: level.accuracy,
            min_size: level.min_size,
        }
    }

    fn to_record(&self) -> LevelRecord {
        LevelRecord {
            triangles: self.triangles,
            vertices: self.vertices,
            draws: self.draws.unwrap_or(1),
            bytes: self.bytes.unwrap_or(0),
            error: self.error,
            accuracy: self.accuracy,
            min_size: self.min_size,
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectRow {
    id: u64,
    table: String,
    center: [f32; 3],
    radius: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    importance: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cost_multiplier: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clamp: Option<[u8; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    forced: Option<u8>,
    #[serde(skip_serializing_if = "Option::is_none")]
    resident: Option<[u8; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    may_skip: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    draw_distance: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hidden: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity: Option<[f32; 3]>,
}

impl Entry for ObjectRow {
    const KIND: &'static str = "object";
}

impl ObjectRow {
    fn of(object: &Object, table: &str) -> Self {
        let (s, plain) = (&object.settings, Settings::default());
        Self {
            id: object.id.0,
            table: table.to_owned(),
            center: object.bounds.center.to_array(),
            radius: object.bounds.radius,
            importance: unless(plain.importance, s.importance),
            bias: unless(plain.bias, s.bias),
            cost_multiplier: unless(plain.cost_multiplier, s.cost_multiplier),
            clamp: unless(plain.clamp, s.clamp).map(ends),
            forced: s.forced.map(|level| level.0),
            resident: unless(plain.resident, s.resident).map(ends),
            may_skip: unless(plain.may_skip, s.may_skip),
            draw_distance: unless(plain.draw_distance, s.draw_distance),
            hidden: unless(plain.hidden, s.hidden),
            velocity: unless(plain.velocity, s.velocity).map(|v| v.to_array()),
        }
    }

    fn to_object(&self, tables: &HashMap<&str, usize>, file: &str) -> Result<Object, FileError> {
        let refused = |rule: &str| FileError::at(file, format!("object {}", self.id), rule);
        let table = *tables
            .get(self.table.as_str())
            .ok_or_else(|| refused(&format!("its table '{}' is unknown", self.table)))?;
        let table = u16::try_from(table).map_err(|_| refused("there can be at most 65536 tables"))?;
        let bounds = Sphere::new(self.center.into(), self.radius);
        Ok(Object { settings: self.settings(), ..Object::new(self.id, bounds, TableId(table)) })
    }

    fn settings(&self) -> Settings {
        let plain = Settings::default();
        Settings {
            importance: self.importance.unwrap_or(plain.importance),
            bias: self.bias.unwrap_or(plain.bias),
            cost_multiplier: self.cost_multiplier.unwrap_or(plain.cost_multiplier),
            clamp: self.clamp.map_or(plain.clamp, range),
            forced: self.forced.map(Level),
            resident: self.resident.map_or(plain.resident, range),
            may_skip: self.may_skip.unwrap_or(plain.may_skip),
            draw_distance: self.draw_distance.unwrap_or(plain.draw_distance),
            hidden: self.hidden.unwrap_or(plain.hidden),
            velocity: self.velocity.map_or(plain.velocity, Vec3::from_array),
        }
    }
}

fn range([finest, coarsest]: [u8; 2]) -> LevelRange {
    LevelRange::new(finest, coarsest)
}

fn ends(range: LevelRange) -> [u8; 2] {
    [range.finest.0, range.coarsest.0]
}

/// What is worth writing: `value`, unless it is the default.
fn unless<T: PartialEq>(default: T, value: T) -> Option<T> {
    (value != default).then_some(value)
}
