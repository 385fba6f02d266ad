//! The JSON of a glTF file: lists of objects that name each other by index, so that adding at the end changes nothing.

use serde_json::{Map, Value, json};

/// The root of a file.
pub(super) struct Document {
    root: Map<String, Value>,
}

impl Document {
    pub(super) fn parse(text: &[u8]) -> Result<Self, String> {
        match serde_json::from_slice(text) {
            Ok(Value::Object(root)) => Ok(Self { root }),
            Ok(_) => Err("its JSON must be an object".to_owned()),
            Err(error) => Err(format!("its JSON is wrong: {error}")),
        }
    }

    /// A list of the root; nothing where there is none.
    pub(super) fn list(&self, name: &str) -> &[Value] {
        self.root.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }

    /// An entry of a list; null where there is none.
    pub(super) fn get(&self, list: &str, index: usize) -> &Value {
        self.list(list).get(index).unwrap_or(&Value::Null)
    }

    /// An entry of a list as an object, made one where it is not.
    pub(super) fn edit(&mut self, list: &str, index: usize) -> &mut Map<String, Value> {
        let list = self.list_mut(list);
        if list.len() <= index {
            list.resize(index + 1, Value::Null);
        }
        object(&mut list[index])
    }

    /// Adds to a list, and returns the index.
    pub(super) fn push(&mut self, list: &str, entry: Value) -> usize {
        let list = self.list_mut(list);
        list.push(entry);
        list.len() - 1
    }

    /// Takes a whole list out.
    pub(super) fn take(&mut self, list: &str) -> Vec<Value> {
        std::mem::take(self.list_mut(list))
    }

    /// Puts a whole list in, in place of the one that was there.
    pub(super) fn put(&mut self, list: &str, entries: Vec<Value>) {
        self.root.insert(list.to_owned(), Value::Array(entries));
    }

    fn list_mut(&mut self, name: &str) -> &mut Vec<Value> {
        let list = self.root.entry(name).or_insert_with(|| json!([]));
        if !list.is_array() {
            *list = json!([]);
        }
        match list {
            Value::Array(entries) => entries,
            _ => unreachable!("it was made a list"),
        }
    }

    /// Notes that an extension is used.
    pub(super) fn use_extension(&mut self, name: &str) {
        if !self.uses(name) {
            self.push("extensionsUsed", json!(name));
        }
    }

    pub(super) fn uses(&self, extension: &str) -> bool {
        self.list("extensionsUsed").iter().any(|used| used == extension)
    }

    /// What errors and reports call an entry: `node 3 'tree'`.
    pub(super) fn place(&self, kind: &str, list: &str, index: usize) -> String {
        match self.name(list, index) {
            Some(name) => format!("{kind} {index} '{name}'"),
            None => format!("{kind} {index}"),
        }
    }

    pub(super) fn name(&self, list: &str, index: usize) -> Option<&str> {
        self.get(list, index).get("name").and_then(Value::as_str)
    }

    /// The nodes right below another one.
    pub(super) fn children(&self, node: usize) -> impl Iterator<Item = usize> {
        indices(self.get("nodes", node).get("children"))
    }

    /// The coarser levels of a node, by `MSFT_lod`.
    pub(super) fn coarser(&self, node: usize) -> impl Iterator<Item = usize> {
        indices(self.get("nodes", node).pointer("/extensions/MSFT_lod/ids"))
    }

    pub(super) fn mesh_of(&self, node: usize) -> Option<usize> {
        index(self.get("nodes", node).get("mesh")?)
    }

    /// As text, without a line break.
    pub(super) fn into_text(mut self) -> String {
        // glTF forbids lists of nothing.
        self.root.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
        Value::Object(self.root).to_string()
    }
}

/// A value as an object, made one where it is not.
pub(super) fn object(value: &mut Value) -> &mut Map<String, Value> {
    if !value.is_object() {
        *value = json!({});
    }
    match value {
        Value::Object(members) => members,
        _ => unreachable!("it was made an object"),
    }
}

/// A member as an object, made one where it is not.
pub(super) fn member<'a>(of: &'a mut Map<String, Value>, name: &str) -> &'a mut Map<String, Value> {
    object(of.entry(name).or_insert(Value::Null))
}

pub(super) fn index(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

/// The indices of a list, if it is one.
fn indices(list: Option<&Value>) -> impl Iterator<Item = usize> {
    list.and_then(Value::as_array).into_iter().flatten().filter_map(index)
}
