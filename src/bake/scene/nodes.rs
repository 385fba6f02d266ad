//! Nodes that show levels.

use serde_json::{Map, Value, json};

use super::document::{Document, index, member};
use super::names::of_level;
use super::survey::of_chunk;

/// What a node is to show.
pub(super) struct Show<'a> {
    /// Per level, finest first; never empty.
    pub(super) meshes: &'a [usize],
    /// Per level, or empty.
    pub(super) coverage: Vec<f32>,
}

/// What an author says of levels, in the `extras` of the node that shows the finest.
const OF_LEVELS: [&str; 2] = ["MSFT_screencoverage", "lod_max_distance"];

impl Document {
    /// Has a node show coarser levels of its mesh.
    pub(super) fn show(&mut self, node: usize, show: &Show<'_>) {
        if show.meshes.len() > 1 {
            let head = if self.is_plain(node) { node } else { self.hand_down(node) };
            self.add_levels(head, show);
        }
    }

    /// Has a node show chunks in place of its mesh, each as a child.
    pub(super) fn show_chunks(&mut self, node: usize, shows: &[Show<'_>]) {
        let name = self.name("nodes", node).unwrap_or_default().to_owned();
        self.edit("nodes", node).remove("mesh");
        let said = self.take_said(node);
        for (i, show) in shows.iter().enumerate() {
            let child =
                self.add_child(node, json!({ "name": of_chunk(&name, i), "mesh": show.meshes[0] }), &said);
            self.add_levels(child, show);
        }
    }

    /// Whether a node has a mesh, a place and nothing else that could get lost with level 0, or that moves it.
    fn is_plain(&self, node: usize) -> bool {
        let has = |member: &str| self.get("nodes", node).get(member).is_some();
        let channels = self.list("animations").iter().filter_map(|a| a.get("channels")?.as_array()).flatten();
        let mut moved = channels.filter_map(|channel| index(channel.pointer("/target/node")?));
        let is_moved = self.uses("KHR_animation_pointer") || moved.any(|target| target == node);
        !is_moved && !["children", "camera", "extensions", "weights"].into_iter().any(has)
    }

    /// Gives a node's mesh to a new child at the same place.
    fn hand_down(&mut self, node: usize) -> usize {
        let name = self.name("nodes", node).unwrap_or_default().to_owned();
        let mesh = self.edit("nodes", node).remove("mesh");
        let said = self.take_said(node);
        self.add_child(node, json!({ "name": name, "mesh": mesh }), &said)
    }

    /// Takes out of a node's extras what the author says of levels.
    fn take_said(&mut self, node: usize) -> Map<String, Value> {
        let Some(extras) = self.edit("nodes", node).get_mut("extras").and_then(Value::as_object_mut) else {
            return Map::new();
        };
        OF_LEVELS.iter().filter_map(|&key| Some((key.to_owned(), extras.remove(key)?))).collect()
    }

    fn add_child(&mut self, parent: usize, mut child: Value, extras: &Map<String, Value>) -> usize {
        if !extras.is_empty() {
            child["extras"] = Value::Object(extras.clone());
        }
        let child = self.push("nodes", child);
        let children = self.edit("nodes", parent).entry("children").or_insert_with(|| json!([]));
        if let Value::Array(children) = children {
            children.push(json!(child));
        }
        child
    }

    /// Adds a node for each coarser level, placed as the head is, and has the head name them.
    fn add_levels(&mut self, head: usize, show: &Show<'_>) {
        if show.meshes.len() < 2 {
            return;
        }
        let name = self.name("nodes", head).unwrap_or_default().to_owned();
        let place: Map<String, Value> = ["matrix", "translation", "rotation", "scale"]
            .into_iter()
            .filter_map(|part| Some((part.to_owned(), self.get("nodes", head).get(part)?.clone())))
            .collect();
        let mut ids = Vec::new();
        for (level, mesh) in show.meshes.iter().enumerate().skip(1) {
            let mut node = place.clone();
            node.insert("name".to_owned(), json!(of_level(&name, level)));
            node.insert("mesh".to_owned(), json!(mesh));
            ids.push(self.push("nodes", Value::Object(node)));
        }
        member(member(self.edit("nodes", head), "extensions"), "MSFT_lod")
            .insert("ids".to_owned(), json!(ids));
        self.say(head, show);
        self.use_extension("MSFT_lod");
    }

    /// Says in the extras when to show which level. What is no object there is kept as one.
    fn say(&mut self, head: usize, show: &Show<'_>) {
        let node = self.edit("nodes", head);
        if let Some(old) = node.get("extras").filter(|extras| !extras.is_object()).cloned() {
            node.insert("extras".to_owned(), json!({ "extras": old }));
        }
        let levels = show.meshes.len();
        let last = node.get("extras").and_then(|e| e.get("lod_max_distance")?.as_array()?.last().cloned());
        let coverage = (show.coverage.len() == levels).then(|| json!(show.coverage));
        let distance = last.map(|last| json!(vec![last; levels]));
        let said = OF_LEVELS.into_iter().zip([coverage, distance]);
        for (key, value) in said.filter_map(|(key, value)| Some((key, value?))) {
            member(node, "extras").insert(key.to_owned(), value);
        }
    }
}
