//! All bytes of a scene in one buffer, so that it is one file that can be put anywhere.

use serde_json::{Value, json};

use super::MeshError;
use super::document::{Document, index};
use crate::bake::read::gltf::Source;

/// The bytes of all buffers and images, one after the other at multiples of 4 bytes; views are moved to where theirs are.
pub(super) fn joined(document: &mut Document, source: &Source<'_>) -> Result<Vec<u8>, MeshError> {
    let (mut bytes, mut starts) = (Vec::new(), Vec::new());
    for buffer in source.buffers()? {
        starts.push(bytes.len());
        bytes.extend_from_slice(buffer);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    let mut views = document.take("bufferViews");
    for view in &mut views {
        move_view(view, &starts);
        let extensions = view.get_mut("extensions").and_then(Value::as_object_mut);
        // Compression has a buffer of its own there.
        extensions
            .into_iter()
            .flat_map(|all| all.values_mut())
            .for_each(|extension| move_view(extension, &starts));
    }
    document.put("bufferViews", views);
    embed_images(document, source, &mut bytes);
    Ok(bytes)
}

fn move_view(view: &mut Value, starts: &[usize]) {
    let Some(&start) = view.get("buffer").and_then(index).and_then(|buffer| starts.get(buffer)) else {
        return;
    };
    let offset = view.get("byteOffset").and_then(Value::as_u64).unwrap_or(0);
    view["buffer"] = json!(0);
    view["byteOffset"] = json!(offset + start as u64);
}

/// Takes in images that are files. Those that cannot be read, or are of a kind that glTF does not name, keep their
/// address.
fn embed_images(document: &mut Document, source: &Source<'_>, bytes: &mut Vec<u8>) {
    for image in 0..document.list("images").len() {
        let uri = document.get("images", image).get("uri").and_then(Value::as_str);
        let Some(content) = uri.and_then(|uri| source.file_beside(uri)) else { continue };
        let Some(kind) = kind_of(&content) else { continue };
        let view = json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": content.len() });
        bytes.extend(content);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        let view = document.push("bufferViews", view);
        let image = document.edit("images", image);
        image.remove("uri");
        image.insert("bufferView".to_owned(), json!(view));
        image.insert("mimeType".to_owned(), json!(kind));
    }
}

/// By the first bytes.
fn kind_of(image: &[u8]) -> Option<&'static str> {
    let is = |start: &[u8]| image.starts_with(start);
    if is(b"\x89PNG\r\n\x1a\n") { Some("image/png") } else { is(b"\xff\xd8\xff").then_some("image/jpeg") }
}
