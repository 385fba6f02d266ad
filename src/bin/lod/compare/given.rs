//! What is compared on: a scene and a camera path, from files or made on the spot.

use std::path::{Path, PathBuf};

use anyhow::ensure;
use lod_budget::files::{CameraPath, Scene};
use lod_budget::sim::generate::Recipe;

/// A scene and a path, and where they come from.
pub struct Given {
    pub scene: Scene,
    pub path: CameraPath,
    /// `None` where it was made on the spot.
    pub scene_file: Option<PathBuf>,
    /// `None` where it was made on the spot.
    pub path_file: Option<PathBuf>,
    /// How many levels a mesh without levels was to get.
    pub assume_levels: Option<usize>,
    /// How many tables got assumed levels.
    pub assumed_tables: usize,
}

impl Given {
    /// Reads or makes the scene, and the path: the one given, else the one that belongs to the scene.
    pub fn load(scene: &str, path: Option<&Path>, assume_levels: Option<usize>) -> anyhow::Result<Self> {
        let mut given = match Recipe::named(scene) {
            Some(recipe) => Self::made(recipe, path)?,
            None => Self::read(Path::new(scene), path)?,
        };
        if let Some(levels) = assume_levels {
            given.assume_levels = assume_levels;
            given.assumed_tables = given.scene.assume_levels(levels)?;
        }
        Ok(given)
    }

    fn made(recipe: Recipe, path_file: Option<&Path>) -> anyhow::Result<Self> {
        let path = match path_file {
            Some(file) => CameraPath::read(file)?,
            None => recipe.path(recipe.bundled_seed()),
        };
        Ok(Self {
            scene: recipe.scene(recipe.bundled_seed()),
            path,
            scene_file: None,
            path_file: path_file.map(Path::to_owned),
            assume_levels: None,
            assumed_tables: 0,
        })
    }

    fn read(scene_file: &Path, path_file: Option<&Path>) -> anyhow::Result<Self> {
        let scene = Scene::read(scene_file)?;
        let path_file = match path_file {
            Some(file) => file.to_owned(),
            None => own_path(scene_file)?,
        };
        Ok(Self {
            scene,
            path: CameraPath::read(&path_file)?,
            scene_file: Some(scene_file.to_owned()),
            path_file: Some(path_file),
            assume_levels: None,
            assumed_tables: 0,
        })
    }

    /// What errors about the scene begin with.
    pub fn scene_label(&self) -> String {
        self.scene_file.as_ref().map_or_else(|| self.scene.name.clone(), |file| file.display().to_string())
    }
}

/// The path that belongs to a scene: the CSV file of its name beside it.
fn own_path(scene_file: &Path) -> anyhow::Result<PathBuf> {
    let file = scene_file.with_extension("csv");
    let (scene, path) = (scene_file.display(), file.display());
    ensure!(file.exists(), "{scene}: camera path: there is no {path}; name one with --path");
    Ok(file)
}
