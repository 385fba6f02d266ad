//! Which nodes are levels of one object: by `MSFT_lod`, by name, or each on its own.

use std::collections::BTreeMap;

use ::gltf::json;
use glam::DMat4;
use serde_json::Value;

use super::Refused;
use super::document::Document;
use super::nodes::Graph;

/// A mesh that a level draws, placed in the space of the object's node.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) mesh: usize,
    pub(super) transform: DMat4,
}

/// An object to be: the node that gives it its id and space, and what each level draws, finest first.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) node: usize,
    pub(super) levels: Vec<Vec<Part>>,
}

/// All objects of the scene; those that draw nothing at any level may be among them.
pub(super) fn gather(document: &Document, graph: &Graph) -> Result<Vec<Group>, Refused> {
    let links = Links::of(document)?;
    let spares = Spares::of(document);
    let mut groups = Vec::new();
    let mut waiting = vec![graph.roots().to_vec()];
    while let Some(siblings) = waiting.pop() {
        let free = siblings.into_iter().filter(|&n| links.level_of[n].is_none());
        let (heads, others): (Vec<usize>, Vec<usize>) = free.partition(|&n| links.levels[n].is_some());
        let chains = heads.into_iter().map(|n| links.chain(n)).chain(by_name(document, &others));
        for chain in chains {
            match chain[..] {
                [alone] if links.levels[alone].is_none() => {
                    groups.extend(document.mesh_of(alone).map(|mesh| spares.group(document, alone, mesh)));
                    waiting.push(document.children(alone).collect());
                }
                _ => groups.push(joined(document, graph, &links, &chain)?),
            }
        }
    }
    check_meshes(document, &groups)?;
    Ok(groups)
}

fn check_meshes(document: &Document, groups: &[Group]) -> Result<(), Refused> {
    for group in groups {
        let unknown = |part: &&Part| part.mesh >= document.meshes().len();
        if let Some(part) = group.levels.iter().flatten().find(unknown) {
            let rule = format!("its mesh {} is unknown", part.mesh);
            return Err(Refused::at(document.node_place(group.node), rule));
        }
    }
    Ok(())
}

/// What `MSFT_lod` says, per node.
struct Links {
    /// The coarser levels of a node that has the extension.
    levels: Vec<Option<Vec<usize>>>,
    /// The node that this one is a coarser level of.
    level_of: Vec<Option<usize>>,
}

impl Links {
    fn of(document: &Document) -> Result<Self, Refused> {
        let nodes = document.nodes().len();
        let mut links = Self { levels: vec![None; nodes], level_of: vec![None; nodes] };
        for node in 0..nodes {
            let refused = |rule: String| Refused::at(document.node_place(node), rule);
            let Some(ids) = lod_ids(document.node(node)).map_err(|r| refused(r.to_owned()))? else {
                continue;
            };
            for &id in &ids {
                links.claim(id, node).map_err(refused)?;
            }
            links.levels[node] = Some(ids);
        }
        let both = (0..nodes).find(|&n| links.levels[n].is_some() && links.level_of[n].is_some());
        match both {
            Some(node) => {
                let rule =
                    "it has MSFT_lod levels and is one itself: levels must not be nested or in a circle";
                Err(Refused::at(document.node_place(node), rule))
            }
            None => links.refuse_nested(document).map(|()| links),
        }
    }

    /// Refuses a level that has a node with levels below it, which may be the very one it is a level of.
    fn refuse_nested(&self, document: &Document) -> Result<(), Refused> {
        let is_level = |&n: &usize| self.level_of[n].is_some();
        let mut waiting: Vec<usize> = (0..self.level_of.len()).filter(is_level).collect();
        while let Some(node) = waiting.pop() {
            for child in document.children(node).filter(|n| !is_level(n)) {
                if self.levels[child].is_some() {
                    return Err(nested(document, child));
                }
                waiting.push(child);
            }
        }
        Ok(())
    }

    /// Makes `id` a level of `head`.
    fn claim(&mut self, id: usize, head: usize) -> Result<(), String> {
        let owner = self.level_of.get_mut(id).ok_or(format!("its MSFT_lod level {id} is unknown"))?;
        match owner.replace(head) {
            Some(other) if other == head => Err(format!("its MSFT_lod names node {id} twice")),
            Some(other) => Err(format!("its MSFT_lod level {id} is also a level of node {other}")),
            None => Ok(()),
        }
    }

    /// The nodes that are the levels of `head`.
    fn chain(&self, head: usize) -> Vec<usize> {
        let coarser = self.levels[head].iter().flatten().copied();
        std::iter::once(head).chain(coarser).collect()
    }
}

/// The `ids` of a node's `MSFT_lod`, if it has one that names any.
fn lod_ids(node: &json::Node) -> Result<Option<Vec<usize>>, &'static str> {
    let rule = "its MSFT_lod must have a list of node indices called ids";
    let Some(lod) = node.extensions.as_ref().and_then(|e| e.others.get("MSFT_lod")) else { return Ok(None) };
    let ids = lod.get("ids").and_then(Value::as_array).ok_or(rule)?;
    let ids: Option<Vec<usize>> = ids.iter().map(|id| usize::try_from(id.as_u64()?).ok()).collect();
    Ok(Some(ids.ok_or(rule)?).filter(|ids| !ids.is_empty()))
}

/// The object whose levels are the nodes of `chain`, each with everything below.
fn joined(document: &Document, graph: &Graph, links: &Links, chain: &[usize]) -> Result<Group, Refused> {
    let head = chain[0];
    let levels = chain.iter().map(|&level| {
        let transform = in_space_of(head, level, graph).ok_or_else(|| {
            Refused::at(
                document.node_place(head),
                "its levels must be placed by transforms that can be inverted",
            )
        })?;
        parts_below(document, graph, links, level, transform)
    });
    Ok(Group { node: head, levels: levels.collect::<Result<_, _>>()? })
}

/// From the space of `level` to that of `head`; exactly the identity where they are placed alike. `None` where
/// `head`'s transform has no inverse.
fn in_space_of(head: usize, level: usize, graph: &Graph) -> Option<DMat4> {
    let (to, from) = (graph.world(head), graph.world_beside(level, head));
    if to == from {
        return Some(DMat4::IDENTITY);
    }
    let transform = to.inverse() * from;
    (to.determinant() != 0.0 && transform.is_finite()).then_some(transform)
}

/// The meshes of a level's node and of everything below it, other levels left out.
fn parts_below(
    document: &Document,
    graph: &Graph,
    links: &Links,
    level: usize,
    transform: DMat4,
) -> Result<Vec<Part>, Refused> {
    let mut parts = Vec::new();
    let mut waiting = vec![(level, transform)];
    while let Some((node, transform)) = waiting.pop() {
        parts.extend(document.mesh_of(node).map(|mesh| Part { mesh, transform }));
        let below = document.children(node).rev().filter(|&n| links.level_of[n].is_none());
        for child in below {
            if links.levels[child].is_some() {
                return Err(nested(document, child));
            }
            waiting.push((child, transform * graph.local(child)));
        }
    }
    Ok(parts)
}

fn nested(document: &Document, node: usize) -> Refused {
    Refused::at(document.node_place(node), "it has MSFT_lod levels within a level, which is not supported")
}

/// Siblings by the stem of their names: chains of levels, and every other node as a chain of one.
fn by_name(document: &Document, siblings: &[usize]) -> Vec<Vec<usize>> {
    let mut stems: BTreeMap<&str, BTreeMap<u32, Vec<usize>>> = BTreeMap::new();
    let mut chains = Vec::new();
    for &node in siblings {
        match level_name(document, node) {
            Some((stem, level)) => stems.entry(stem).or_default().entry(level).or_default().push(node),
            None => chains.push(vec![node]),
        }
    }
    chains.extend(stems.values().flat_map(chains_of_stem));
    chains
}

/// The first node of every number, then the second ones, and so on.
fn chains_of_stem(levels: &BTreeMap<u32, Vec<usize>>) -> Vec<Vec<usize>> {
    let most = levels.values().map(Vec::len).max().unwrap_or(0);
    let mut chains = vec![Vec::new(); most];
    for nodes in levels.values() {
        for (chain, &node) in chains.iter_mut().zip(nodes) {
            chain.push(node);
        }
    }
    chains
}

/// Stem and number of a node's name, or else of its mesh's.
fn level_name(document: &Document, node: usize) -> Option<(&str, u32)> {
    let own = document.node(node).name.as_deref().and_then(split_level);
    own.or_else(|| mesh_level_name(document, document.mesh_of(node)?))
}

fn mesh_level_name(document: &Document, mesh: usize) -> Option<(&str, u32)> {
    split_level(document.meshes().get(mesh)?.name.as_deref()?)
}

/// Splits `tree_LOD2` into `tree` and 2.
fn split_level(name: &str) -> Option<(&str, u32)> {
    let rest = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let at = rest.len().checked_sub("_lod".len())?;
    let is_mark = rest.get(at..)?.eq_ignore_ascii_case("_lod");
    let level = name[rest.len()..].parse().ok()?;
    is_mark.then_some((&name[..at], level))
}

/// Meshes that no node uses, by stem and number.
struct Spares<'a>(BTreeMap<(&'a str, u32), usize>);

impl<'a> Spares<'a> {
    fn of(document: &'a Document) -> Self {
        let mut used = vec![false; document.meshes().len()];
        for mesh in (0..document.nodes().len()).filter_map(|n| document.mesh_of(n)) {
            if let Some(used) = used.get_mut(mesh) {
                *used = true;
            }
        }
        let spare = (0..used.len()).rev().filter(|&mesh| !used[mesh]);
        Self(spare.filter_map(|mesh| Some((mesh_level_name(document, mesh)?, mesh))).collect())
    }

    /// The object of a node on its own.
    fn group(&self, document: &Document, node: usize, mesh: usize) -> Group {
        let named = mesh_level_name(document, mesh);
        let coarser = named.into_iter().flat_map(|(stem, level)| {
            self.0.range((stem, level.saturating_add(1))..=(stem, u32::MAX)).map(|(_, &mesh)| mesh)
        });
        let part = |mesh| vec![Part { mesh, transform: DMat4::IDENTITY }];
        Group { node, levels: std::iter::once(mesh).chain(coarser).map(part).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn level_names_are_split_in_either_case() {
        assert_eq!(split_level("tree_LOD2"), Some(("tree", 2)));
        assert_eq!(split_level("a_b_lod010"), Some(("a_b", 10)));
        assert_eq!(split_level("_Lod0"), Some(("", 0)));
        for plain in
            ["tree", "tree_LOD", "treeLOD1", "tree_LOD_1", "LOD1", "12", "ä_L0", "tree_LOD99999999999"]
        {
            assert_eq!(split_level(plain), None, "{plain}");
        }
    }

    #[test]
    fn repeated_numbers_go_together_in_order() {
        let levels = BTreeMap::from([(0, vec![10, 20]), (2, vec![12, 22, 32])]);
        assert_eq!(chains_of_stem(&levels), [vec![10, 12], vec![20, 22], vec![32]]);
    }
}
