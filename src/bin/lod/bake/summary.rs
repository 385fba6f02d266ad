//! What a bake comes to: the object that `--json` prints, and that the table is made from.

use lod_budget::bake::chain::{Appearance, Chain, ChainLevel, LeftOut, Reason};
use lod_budget::bake::deviation::attributes::Difference;
use lod_budget::bake::geomorph::Geomorph;
use lod_budget::bake::scene::Left;
use lod_budget::table::{LevelRecord, LodTable};
use serde::{Deserialize, Serialize};

use super::geomorph::GeomorphRow;
use super::impostor::ImpostorRow;
use super::inputs::{Found, Input};
use super::outputs::Folder;

/// A bake in numbers. Its keys are an interface: they are added to, never renamed.
#[derive(Serialize)]
pub struct Summary {
    /// Of scenes, each part by itself.
    pub meshes: Vec<MeshRow>,
    pub scenes: Vec<SceneRow>,
    /// What could not be baked, and why.
    pub failed: Vec<Failure>,
}

#[derive(Serialize)]
pub struct Failure {
    pub input: String,
    /// Names the input.
    pub error: String,
}

/// What was made of one file. Distances are in object units, times are of a wall clock.
#[derive(Clone, Serialize, Deserialize)]
pub struct MeshRow {
    pub input: String,
    /// What its outputs are called.
    pub name: String,
    pub status: Status,
    pub method: String,
    pub preset: Option<String>,
    /// Simplification alone.
    pub seconds: f64,
    pub measure_seconds: f64,
    /// Of the box around level 0.
    pub diagonal: f64,
    /// Positions that no triangle used; no level has them.
    pub unreferenced: usize,
    /// What was odd about the file.
    pub findings: Vec<String>,
    pub levels: Vec<LevelRow>,
    /// Levels that were asked for and would be of no use.
    pub left_out: Vec<LeftOutRow>,
    /// `null` where none was asked for.
    pub impostor: Option<ImpostorRow>,
    /// All levels in one file.
    pub scene_file: Option<String>,
    /// The LOD table.
    pub table_file: Option<String>,
    /// The levels side by side.
    pub sheet_file: Option<String>,
    /// The progressive mesh.
    #[serde(default)]
    pub progressive_file: Option<String>,
}

/// What was made of a scene.
#[derive(Serialize)]
pub struct SceneRow {
    pub input: String,
    /// The scene with levels.
    pub scene_file: String,
    /// Parts with more than one level.
    pub chains: usize,
    /// Parts that are chunks of a larger mesh.
    pub chunks: usize,
    /// Nodes that show a part which is no chunk.
    pub nodes: usize,
    /// Chains of the author's that were measured.
    pub measured: usize,
    /// What is shown and stays as it was.
    pub left: Vec<LeftRow>,
    /// What was odd about its meshes.
    pub findings: Vec<String>,
}

#[derive(Serialize)]
pub struct LeftRow {
    pub place: String,
    pub reason: &'static str,
}

impl LeftRow {
    pub fn of(left: &Left) -> Self {
        Self { place: left.place.clone(), reason: left.reason }
    }
}

/// What one input came to.
pub enum Baked {
    Mesh(Box<MeshRow>),
    Scene(SceneRow, Vec<MeshRow>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Just now.
    Baked,
    /// Before, from the same bytes in the same way.
    Kept,
}

#[derive(Clone, Serialize, Deserialize)]
pub struct LevelRow {
    pub level: usize,
    pub triangles: usize,
    pub vertices: usize,
    pub draws: usize,
    pub bytes: u64,
    /// A proved bound.
    pub hausdorff: f64,
    /// Some point is at least so far away: the true distance is between this and `hausdorff`.
    pub attained: f64,
    pub rms: f64,
    /// The greatest bound of this and all finer levels.
    pub error: f64,
    pub accuracy: f32,
    pub min_size: Option<f32>,
    /// `null` for level 0.
    pub appearance: Option<AppearanceRow>,
    /// The way to the next coarser level; `null` where nobody asked for it, and for the coarsest.
    #[serde(default)]
    pub geomorph: Option<GeomorphRow>,
    /// This level alone.
    pub file: Option<String>,
}

/// How a level looks beside level 0: estimates. `null` where one of them has no such attribute.
#[derive(Clone, Serialize, Deserialize)]
pub struct AppearanceRow {
    /// Angles between normals, in degrees.
    pub normals_deg: Option<DifferenceRow>,
    /// Of each set of texture coordinates, in UV units.
    pub uvs: Vec<Option<DifferenceRow>>,
    /// As distances between linear RGBA.
    pub colours: Option<DifferenceRow>,
    /// How far silhouettes are apart, in object units, within `silhouette_error`.
    pub silhouette: f64,
    pub silhouette_error: f64,
    /// The share by which silhouettes cover more; below 0 where they cover less.
    pub area_change: Option<f64>,
}

#[derive(Clone, Serialize, Deserialize)]
pub struct DifferenceRow {
    pub rms: f64,
    pub max: f64,
}

#[derive(Clone, Serialize, Deserialize)]
pub struct LeftOutRow {
    /// What was asked for: triangles, or an error in object units.
    pub target_triangles: Option<usize>,
    pub target_error: Option<f32>,
    /// The triangles that it came to.
    pub triangles: usize,
    pub reason: String,
}

impl Summary {
    pub fn of(found: &Found, results: Vec<anyhow::Result<Baked>>) -> Self {
        let nothing = found.nothing.iter().map(|(path, rule)| {
            let input = path.display().to_string();
            Failure { error: format!("{input}: {rule}"), input }
        });
        let mut summary = Self { meshes: Vec::new(), scenes: Vec::new(), failed: nothing.collect() };
        for (input, result) in found.inputs.iter().zip(results) {
            match result {
                Ok(Baked::Mesh(row)) => summary.meshes.push(*row),
                Ok(Baked::Scene(scene, parts)) => {
                    summary.scenes.push(scene);
                    summary.meshes.extend(parts);
                }
                Err(error) => {
                    let input = input.file.display().to_string();
                    summary.failed.push(Failure { input, error: format!("{error:#}") });
                }
            }
        }
        summary
    }
}

impl MeshRow {
    pub fn kept(self) -> Self {
        Self { status: Status::Kept, ..self }
    }

    /// The same files by the name that they go by now.
    pub fn of_input(self, input: &Input) -> Self {
        Self { input: input.file.display().to_string(), ..self }
    }

    /// Files as they are to be called from the current folder.
    pub fn within(mut self, folder: &Folder) -> Self {
        let levels = self.levels.iter_mut().map(|level| &mut level.file);
        let impostor = self.impostor.iter_mut().map(|impostor| &mut impostor.file);
        let files =
            levels.chain(impostor).chain([&mut self.scene_file, &mut self.table_file, &mut self.sheet_file]);
        let files = files.chain([&mut self.progressive_file]);
        for file in files.flatten() {
            *file = folder.file(file).display().to_string();
        }
        self
    }
}

impl LevelRow {
    pub fn all(chain: &Chain, table: &LodTable, geomorphs: &[Geomorph]) -> Vec<Self> {
        let levels = chain.levels.iter().zip(table.levels()).enumerate();
        let geomorph = |i: usize| geomorphs.get(i).map(GeomorphRow::of);
        levels
            .map(|(i, (level, record))| Self { geomorph: geomorph(i), ..Self::of(i, level, record) })
            .collect()
    }

    fn of(i: usize, level: &ChainLevel, record: &LevelRecord) -> Self {
        Self {
            level: i,
            triangles: level.triangles(),
            vertices: level.vertices(),
            draws: level.draws(),
            bytes: level.bytes(),
            hausdorff: level.deviation.hausdorff,
            attained: level.deviation.attained,
            rms: level.deviation.rms(),
            // All its digits, so that nobody reads a number below it.
            error: f64::from(level.error),
            accuracy: record.accuracy,
            min_size: record.min_size,
            appearance: level.appearance.as_ref().map(AppearanceRow::of),
            geomorph: None,
            file: None,
        }
    }
}

impl AppearanceRow {
    fn of(appearance: &Appearance) -> Self {
        let Appearance { attributes, silhouette } = appearance;
        let row = |difference: &Option<Difference>| {
            difference.as_ref().map(|d| DifferenceRow { rms: d.rms(), max: d.max() })
        };
        Self {
            normals_deg: row(&attributes.normals_deg),
            uvs: attributes.uvs.iter().map(row).collect(),
            colours: row(&attributes.colours),
            silhouette: silhouette.distance(),
            silhouette_error: silhouette.error(),
            area_change: silhouette.area_change(),
        }
    }
}

impl LeftOutRow {
    pub fn of(left_out: &LeftOut) -> Self {
        let target = left_out.target;
        let reason = match left_out.reason {
            Reason::NotCoarser => "hardly coarser than the level before",
            Reason::TooFar => "too far from level 0",
            Reason::Misfit => "no fit for the neighbouring chunks",
            Reason::Empty => "nothing is left of it",
        };
        Self {
            target_triangles: (target.triangles > 0).then_some(target.triangles),
            target_error: target.error.is_finite().then_some(target.error),
            triangles: left_out.triangles,
            reason: reason.to_owned(),
        }
    }
}
