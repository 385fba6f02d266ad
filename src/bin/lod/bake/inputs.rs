//! Which files are meant, and what their outputs are called.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use lod_budget::bake::Format;

/// A mesh file.
pub struct Input {
    pub file: PathBuf,
    /// What its outputs are called; no other input has it, whatever case letters are in.
    pub name: String,
}

/// What was found.
pub struct Found {
    /// Each file once, in the order in which they were named.
    pub inputs: Vec<Input>,
    /// Patterns and folders without a file, and why.
    pub nothing: Vec<(PathBuf, String)>,
}

/// The files that these names, folders and patterns stand for.
pub fn find(named: &[PathBuf]) -> Found {
    let (mut files, mut nothing) = (Vec::new(), Vec::new());
    for path in named {
        match files_of(path) {
            Ok(found) => files.extend(found),
            Err(rule) => nothing.push((path.clone(), rule)),
        }
    }
    let mut seen = BTreeSet::new();
    files.retain(|file| seen.insert(real(file)));
    let names = names(&files);
    Found { inputs: files.into_iter().zip(names).map(|(file, name)| Input { file, name }).collect(), nothing }
}

/// The same for all names of a file.
pub fn real(file: &Path) -> PathBuf {
    fs::canonicalize(file).unwrap_or_else(|_| file.to_owned())
}

/// A file is itself, a folder the meshes in it, and what is neither may be a pattern.
fn files_of(path: &Path) -> Result<Vec<PathBuf>, String> {
    if path.is_dir() {
        return meshes_in(path);
    }
    let pattern = path.to_str().filter(|text| text.contains(['*', '?', '['])).filter(|_| !path.exists());
    match pattern {
        Some(pattern) => matches(pattern),
        None => Ok(vec![path.to_owned()]),
    }
}

fn meshes_in(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("it cannot be read: {e}"))?;
    let is_mesh = |file: &PathBuf| file.is_file() && Format::guess(&[], &file.to_string_lossy()).is_some();
    let mut meshes: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(is_mesh).collect();
    meshes.sort();
    if meshes.is_empty() { Err("there is no mesh in this folder".to_owned()) } else { Ok(meshes) }
}

/// In alphabetical order.
fn matches(pattern: &str) -> Result<Vec<PathBuf>, String> {
    let paths = glob::glob(pattern).map_err(|e| format!("it is no pattern: {e}"))?;
    let files: Vec<PathBuf> = paths.filter_map(Result::ok).filter(|path| path.is_file()).collect();
    if files.is_empty() { Err("no file matches this pattern".to_owned()) } else { Ok(files) }
}

/// The stem of each file; where others have the same, with the folders before it, and then with the extension.
fn names(files: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<Option<String>> = vec![None; files.len()];
    for naming in [stem, path_and_stem, path_and_extension] {
        let now: Vec<String> = files.iter().map(|file| naming(file)).collect();
        let count = |name: &str| now.iter().filter(|n| n.to_lowercase() == name.to_lowercase()).count();
        for (name, now) in names.iter_mut().zip(&now).filter(|(name, _)| name.is_none()) {
            *name = Some(now.clone()).filter(|now| count(now) == 1);
        }
    }
    tell_apart(names.into_iter().zip(files).map(|(name, file)| name.unwrap_or_else(|| stem(file))))
}

fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(|| "mesh".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn path_and_stem(file: &Path) -> String {
    let is_name = |part: Component<'_>| match part {
        Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
        _ => None,
    };
    let folders = file.parent().into_iter().flat_map(Path::components).filter_map(is_name);
    folders.chain([stem(file)]).collect::<Vec<_>>().join("-")
}

fn path_and_extension(file: &Path) -> String {
    let extension = file.extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
    format!("{}-{extension}", path_and_stem(file))
}

/// Numbers those that are taken.
fn tell_apart(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let free = |name: String| {
        let numbered = (2..).map(|n| format!("{name}-{n}"));
        let mut names = std::iter::once(name.clone()).chain(numbered);
        // There are more numbers than names.
        names.find(|name| taken.insert(name.to_lowercase())).unwrap_or(name)
    };
    names.map(free).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_and_no_two_are_alike() {
        let named = |files: &[&str]| names(&files.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(named(&["a/rock.obj", "b/tree.ply"]), ["rock", "tree"]);
        assert_eq!(named(&["a/rock.obj", "../b/Rock.obj", "tree.obj"]), ["a-rock", "b-Rock", "tree"]);
        assert_eq!(named(&["a/rock.obj", "a/rock.ply"]), ["a-rock-obj", "a-rock-ply"]);
        assert_eq!(named(&["a/rock.obj", "b/rock.obj", "a-rock.obj"]), ["a-rock", "b-rock", "a-rock-2"]);
        assert_eq!(named(&["../x.obj", "../../x.obj"]), ["x", "x-2"]);
    }
}
