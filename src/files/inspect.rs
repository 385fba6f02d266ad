//! What is in a file, and what is wrong with it. Plain data: printing is the command's job.

use std::path::Path;

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::{Break, CameraPath, FileError, Scene, disk};
use crate::bounds::{Aabb, Sphere};
use crate::knapsack::{Instance, Item, greedy};
use crate::scene::{Object, Settings};
use crate::table::LodTable;

/// What is in a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Inspection {
    /// Tables and objects.
    Scene(SceneInspection),
    /// Poses over time.
    Path(PathInspection),
    /// A multiple-choice knapsack `{"budget": B, "classes": [[[cost, benefit], …], …]}`.
    Instance(InstanceInspection),
}

/// What is in a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneInspection {
    /// Name of the scene.
    pub name: String,
    /// How many objects there are.
    pub objects: usize,
    /// How many tables there are.
    pub tables: usize,
    /// How many tables no object uses.
    pub unused_tables: usize,
    /// Every object at its finest level.
    pub finest: Total,
    /// Every object at its coarsest level.
    pub coarsest: Total,
    /// How many tables have how many levels; numbers that no table has are left out.
    pub level_counts: Vec<LevelCount>,
    /// How many objects have more than one level to choose from.
    pub objects_with_levels: usize,
    /// Smallest corner of the box around all objects; `None` without objects.
    pub min: Option<[f32; 3]>,
    /// Largest corner of the box around all objects; `None` without objects.
    pub max: Option<[f32; 3]>,
    /// The tables themselves where there are no objects, as in what a bake writes; empty otherwise.
    pub library: Vec<LodTable>,
    /// What is odd about tables, in order of table and level.
    pub lints: Vec<TableLint>,
    /// How many objects have each kind of setting; kinds that no object has are left out.
    pub settings: Vec<SettingCount>,
    /// Objects that cannot be seen: hidden, without extent, without importance, or not drawn at any distance.
    pub unseen: usize,
}

/// Sums over objects. Wide, because many objects share large tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Total {
    /// Triangles drawn.
    pub triangles: u64,
    /// Vertices processed.
    pub vertices: u64,
    /// Draw calls.
    pub draws: u64,
    /// Memory of the level over all *tables* that are used: objects share it.
    pub bytes: u64,
}

/// How many tables have so many levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LevelCount {
    /// Number of levels.
    pub levels: usize,
    /// Number of tables.
    pub tables: usize,
    /// Number of objects of those tables.
    pub objects: usize,
}

/// Something odd about a table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TableLint {
    /// Name of the table.
    pub table: String,
    /// The level it was found at.
    pub level: u8,
    /// What is odd.
    pub rule: &'static str,
}

/// How many objects have a setting other than the default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SettingCount {
    /// Name of the setting, as in scene files.
    pub setting: &'static str,
    /// Number of objects.
    pub objects: usize,
}

/// What is in a camera path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathInspection {
    /// Name of the path.
    pub name: String,
    /// How many poses there are.
    pub poses: usize,
    /// How many poses were left out because they repeat the time of the one before.
    pub dropped: usize,
    /// Time of the first pose.
    pub start_s: f64,
    /// Time from the first pose to the last.
    pub duration_s: f64,
    /// Distance travelled in world units (metres by convention), without breaks.
    pub length: f64,
    /// Poses per second, breaks and their time left out; 0 where there is no motion.
    pub rate_hz: f64,
    /// The greatest speed between neighbouring poses in world units per second, without breaks.
    pub top_speed: f64,
    /// Where no motion connects two poses.
    pub breaks: Vec<Break>,
}

/// What can be said of a knapsack at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InstanceInspection {
    /// The cost that a choice may have at most.
    pub budget: f64,
    /// How many classes there are.
    pub classes: usize,
    /// How many items there are in all classes.
    pub items: usize,
    /// Number of items of the smallest class; 0 without classes.
    pub fewest_items: usize,
    /// Number of items of the largest class.
    pub most_items: usize,
    /// Cost of the cheapest choice.
    pub least_cost: f64,
    /// Cost of the dearest choice.
    pub most_cost: f64,
    /// Whether any choice fits the budget.
    pub feasible: bool,
}

/// Reads a file of any kind and says what is in it. `.glb` and `.gltf` are scenes, `.csv`, `.tum` and `.txt` paths;
/// `.json` is what its keys say.
///
/// # Errors
/// What the reader of that kind refuses, and files of unknown kind.
pub fn inspect(path: &Path) -> Result<Inspection, FileError> {
    match disk::extension(path).as_str() {
        "glb" | "gltf" => Scene::read(path).map(|s| Inspection::Scene(SceneInspection::of(&s))),
        "csv" | "tum" | "txt" => CameraPath::read(path).map(|p| Inspection::Path(PathInspection::of(&p))),
        "json" => inspect_json(&disk::read_bytes(path)?, &path.display().to_string()),
        _ => {
            let rule = "it must be a .json, .glb, .gltf, .csv, .tum or .txt file";
            Err(FileError::whole(path.display().to_string(), rule))
        }
    }
}

/// Says what is in a JSON file: an instance where it has classes and no tables, else a scene. `file` names it in
/// errors.
///
/// # Errors
/// Malformed JSON, and what the reader of instances or scenes refuses.
pub fn inspect_json(bytes: &[u8], file: &str) -> Result<Inspection, FileError> {
    let text = disk::text_of(bytes, file)?;
    match super::json::parse(text, file)? {
        Keys { classes: Some(_), tables: None } => {
            let instance = Instance::from_bytes(bytes, file)?;
            Ok(Inspection::Instance(InstanceInspection::of(&instance)))
        }
        _ => Scene::from_json(bytes, file).map(|s| Inspection::Scene(SceneInspection::of(&s))),
    }
}

/// The keys that tell scenes from instances.
#[derive(Deserialize)]
struct Keys {
    classes: Option<IgnoredAny>,
    tables: Option<IgnoredAny>,
}

impl InstanceInspection {
    /// What can be said of a knapsack.
    pub fn of(instance: &Instance) -> Self {
        let sizes = || instance.classes().map(<[Item]>::len);
        let total = |worst: f64, pick: fn(f64, f64) -> f64| {
            let cost = |class: &[Item]| class.iter().map(|item| item.cost).fold(worst, pick);
            instance.classes().map(cost).fold(0.0, |sum, cost| sum + cost)
        };
        Self {
            budget: instance.budget(),
            classes: instance.len(),
            items: instance.items().len(),
            fewest_items: sizes().min().unwrap_or(0),
            most_items: sizes().max().unwrap_or(0),
            least_cost: total(f64::INFINITY, f64::min),
            most_cost: total(0.0, f64::max),
            feasible: greedy(instance).feasible,
        }
    }
}

impl SceneInspection {
    /// What is in a scene.
    ///
    /// # Panics
    /// Every object's table must be one of the scene's, as in every scene that was read.
    pub fn of(scene: &Scene) -> Self {
        let users = count_users(scene);
        let bounds = scene_box(scene);
        Self {
            name: scene.name.clone(),
            objects: scene.objects.len(),
            tables: scene.tables.len(),
            unused_tables: users.iter().filter(|&&users| users == 0).count(),
            finest: Total::over(scene, &users, |_| 0),
            coarsest: Total::over(scene, &users, |t| t.coarsest().index()),
            level_counts: count_levels(scene, &users),
            objects_with_levels: scene.objects.iter().filter(|o| has_choice(scene, o)).count(),
            min: bounds.map(|b| b.min.to_array()),
            max: bounds.map(|b| b.max.to_array()),
            library: if scene.objects.is_empty() { scene.tables.clone() } else { Vec::new() },
            lints: scene.tables.iter().flat_map(lints).collect(),
            settings: count_settings(&scene.objects),
            unseen: scene.objects.iter().filter(|o| is_unseen(o)).count(),
        }
    }
}

/// Objects per table.
fn count_users(scene: &Scene) -> Vec<u64> {
    let mut users = vec![0; scene.tables.len()];
    for object in &scene.objects {
        users[usize::from(object.table.0)] += 1;
    }
    users
}

impl Total {
    fn over(scene: &Scene, users: &[u64], level: fn(&LodTable) -> usize) -> Self {
        let mut total = Self::default();
        for (table, &users) in scene.tables.iter().zip(users) {
            let level = &table.levels()[level(table)];
            total.triangles += users * u64::from(level.triangles);
            total.vertices += users * u64::from(level.vertices);
            total.draws += users * u64::from(level.draws);
            total.bytes = total.bytes.saturating_add(users.min(1) * level.bytes);
        }
        total
    }
}

fn count_levels(scene: &Scene, users: &[u64]) -> Vec<LevelCount> {
    let mut counts: Vec<LevelCount> =
        (0..=crate::table::MAX_LEVELS).map(|levels| LevelCount { levels, tables: 0, objects: 0 }).collect();
    for (table, &users) in scene.tables.iter().zip(users) {
        let count = &mut counts[table.levels().len()];
        count.tables += 1;
        count.objects += users as usize;
    }
    counts.retain(|count| count.tables > 0);
    counts
}

fn has_choice(scene: &Scene, object: &Object) -> bool {
    let levels = scene.tables[usize::from(object.table.0)].levels().len();
    let allowed = object.settings.allowed(levels);
    allowed.finest != allowed.coarsest
}

fn scene_box(scene: &Scene) -> Option<Aabb> {
    let valid = scene.objects.iter().map(|o| o.bounds).filter(Sphere::is_valid);
    valid.map(|b| b.aabb()).reduce(Aabb::union)
}

fn lints(table: &LodTable) -> impl Iterator<Item = TableLint> {
    let name = table.name();
    let lint = |l: crate::table::Lint| TableLint { table: name.to_owned(), level: l.level.0, rule: l.rule };
    table.lint().into_iter().map(lint)
}

/// Whether an object's setting is not the default.
type IsSet = fn(&Settings, &Settings) -> bool;

/// Every setting by its name in scene files.
const SETTINGS: [(&str, IsSet); 10] = [
    ("importance", |a, b| a.importance != b.importance),
    ("bias", |a, b| a.bias != b.bias),
    ("cost_multiplier", |a, b| a.cost_multiplier != b.cost_multiplier),
    ("clamp", |a, b| a.clamp != b.clamp),
    ("forced", |a, b| a.forced != b.forced),
    ("resident", |a, b| a.resident != b.resident),
    ("may_skip", |a, b| a.may_skip != b.may_skip),
    ("draw_distance", |a, b| a.draw_distance != b.draw_distance),
    ("hidden", |a, b| a.hidden != b.hidden),
    ("velocity", |a, b| a.velocity != b.velocity),
];

fn count_settings(objects: &[Object]) -> Vec<SettingCount> {
    let plain = Settings::default();
    let count = |is_set: IsSet| objects.iter().filter(|o| is_set(&o.settings, &plain)).count();
    let counts = SETTINGS.iter().map(|&(setting, is_set)| SettingCount { setting, objects: count(is_set) });
    counts.filter(|c| c.objects > 0).collect()
}

fn is_unseen(object: &Object) -> bool {
    let s = &object.settings;
    s.hidden || s.importance == 0.0 || s.draw_distance == 0.0 || object.bounds.radius == 0.0
}

impl PathInspection {
    /// What is in a camera path.
    pub fn of(path: &CameraPath) -> Self {
        let moving_s = path.duration_s() - path.breaks().iter().map(|b| b.duration_s).sum::<f64>();
        let intervals = (path.poses().len() - 1 - path.breaks().len()) as f64;
        Self {
            name: path.name().to_owned(),
            poses: path.poses().len(),
            dropped: path.dropped(),
            start_s: path.start_s(),
            duration_s: path.duration_s(),
            length: path.length(),
            rate_hz: if intervals > 0.0 && moving_s > 0.0 { intervals / moving_s } else { 0.0 },
            top_speed: path.top_speed(),
            breaks: path.breaks().to_vec(),
        }
    }
}
