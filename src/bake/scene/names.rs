//! Levels that an author made: by `MSFT_lod`, or by names that end in `_LOD` and a number.

use std::collections::{BTreeMap, BTreeSet};

use super::document::Document;

/// Per node, whether it is a level of an object that has several, or is below one.
pub(super) fn has_levels(document: &Document) -> Vec<bool> {
    let nodes = document.list("nodes").len();
    let mut has_levels = vec![false; nodes];
    let mut waiting: Vec<usize> = (0..nodes).filter(|&n| document.coarser(n).next().is_some()).collect();
    waiting.extend((0..nodes).flat_map(|n| document.coarser(n)));
    waiting.extend(by_name(document));
    while let Some(node) = waiting.pop() {
        let new = has_levels.get_mut(node).is_some_and(|seen| !std::mem::replace(seen, true));
        waiting.extend(document.children(node).filter(|_| new));
    }
    has_levels
}

/// Nodes that share a stem with siblings of another number, or with meshes of a greater one that nobody shows.
fn by_name(document: &Document) -> Vec<usize> {
    let spares = spares(document);
    let mut levels = Vec::new();
    for siblings in families(document) {
        let mut stems: BTreeMap<&str, Vec<(u32, usize)>> = BTreeMap::new();
        for node in siblings {
            if let Some((stem, number)) = level_name(document, node) {
                stems.entry(stem).or_default().push((number, node));
            }
        }
        for (stem, members) in stems {
            let numbers: BTreeSet<u32> = members.iter().map(|&(number, _)| number).collect();
            let has_spare = |number: u32| {
                spares.range((stem, number.saturating_add(1))..=(stem, u32::MAX)).next().is_some()
            };
            let several = members.into_iter().filter(|&(number, _)| numbers.len() > 1 || has_spare(number));
            levels.extend(several.map(|(_, node)| node));
        }
    }
    levels
}

/// The roots of each scene, and the children of each node.
fn families(document: &Document) -> Vec<Vec<usize>> {
    let nodes = document.list("nodes").len();
    let mut is_root = vec![true; nodes];
    for child in (0..nodes).flat_map(|n| document.children(n)) {
        if let Some(is_root) = is_root.get_mut(child) {
            *is_root = false;
        }
    }
    let roots = (0..nodes).filter(|&n| is_root[n]).collect();
    let below = (0..nodes).map(|n| document.children(n).collect());
    std::iter::once(roots).chain(below).collect()
}

/// Meshes that no node shows, by stem and number.
fn spares(document: &Document) -> BTreeSet<(&str, u32)> {
    let shown: BTreeSet<usize> =
        (0..document.list("nodes").len()).filter_map(|n| document.mesh_of(n)).collect();
    let spare = (0..document.list("meshes").len()).filter(|mesh| !shown.contains(mesh));
    spare.filter_map(|mesh| split_level(document.name("meshes", mesh)?)).collect()
}

/// Stem and number of a node's name, or else of its mesh's.
fn level_name(document: &Document, node: usize) -> Option<(&str, u32)> {
    let of_mesh = || split_level(document.name("meshes", document.mesh_of(node)?)?);
    document.name("nodes", node).and_then(split_level).or_else(of_mesh)
}

/// Splits `tree_LOD2` into `tree` and 2, in upper or lower case.
fn split_level(name: &str) -> Option<(&str, u32)> {
    let rest = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let at = rest.len().checked_sub("_lod".len())?;
    let is_mark = rest.get(at..)?.eq_ignore_ascii_case("_lod");
    let number = name[rest.len()..].parse().ok()?;
    is_mark.then_some((&name[..at], number))
}

/// What a level is called: by the stem of the finest one's name.
pub(super) fn of_level(name: &str, level: usize) -> String {
    let stem = split_level(name).map_or(name, |(stem, _)| stem);
    format!("{stem}_LOD{level}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_called_after_their_stem() {
        for (name, level) in
            [("tree", "tree_LOD2"), ("tree_lod0", "tree_LOD2"), ("_LOD", "_LOD_LOD2"), ("", "_LOD2")]
        {
            assert_eq!(of_level(name, 2), level);
        }
    }

    #[test]
    fn an_authors_levels_are_found() {
        let document = Document::parse(
            br#"{ "meshes": [{}, { "name": "rock_LOD0" }, { "name": "rock_LOD1" }, { "name": "moss_LOD1" }],
                  "nodes": [
                    { "children": [1, 2, 3] },
                    { "name": "a_LOD0", "mesh": 0 }, { "name": "a_lod7", "mesh": 0 }, { "name": "b_LOD0", "mesh": 0 },
                    { "mesh": 1 }, { "mesh": 3 },
                    { "extensions": { "MSFT_lod": { "ids": [7] } }, "children": [8] }, {}, { "mesh": 0 },
                    { "name": "a_LOD1", "mesh": 0 }] }"#,
        )
        .expect("JSON");
        let levels = has_levels(&document);
        let found: Vec<usize> = (0..levels.len()).filter(|&n| levels[n]).collect();
        assert_eq!(found, [1, 2, 4, 6, 7, 8]);
    }
}
