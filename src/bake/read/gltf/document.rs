//! The parts of a glTF file that hold meshes, and the bytes they are in.

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use ::gltf::json;
use serde::Deserialize;

use super::Refused;
use crate::bake::read::short_name;
use crate::gltf::{broken_rule, parts};

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Root {
    asset: Asset,
    scene: Option<usize>,
    #[serde(default)]
    scenes: Vec<Scene>,
    #[serde(default)]
    nodes: Vec<json::Node>,
    #[serde(default)]
    meshes: Vec<json::Mesh>,
    #[serde(default)]
    materials: Vec<Named>,
    #[serde(default)]
    accessors: Vec<json::Accessor>,
    #[serde(default)]
    buffer_views: Vec<json::buffer::View>,
    #[serde(default)]
    buffers: Vec<json::Buffer>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

#[derive(Deserialize)]
struct Scene {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
struct Named {
    name: Option<String>,
}

/// A file with the bytes of its buffers, those that cannot be had with the reason.
pub(super) struct Document<'a> {
    pub(super) nodes: Vec<json::Node>,
    pub(super) meshes: Vec<json::Mesh>,
    pub(super) accessors: Vec<json::Accessor>,
    roots: Option<Vec<usize>>,
    materials: Vec<Named>,
    views: Vec<json::buffer::View>,
    buffers: Vec<Result<Cow<'a, [u8]>, String>>,
    /// Of the file and its buffers.
    pub(super) bytes: u64,
}

impl<'a> Document<'a> {
    /// From text or GLB. Buffers that are files of their own must be in `folder`.
    pub(super) fn open(bytes: &'a [u8], folder: Option<&Path>) -> Result<Self, Refused> {
        let (text, blob) = parts(bytes).map_err(Refused::whole)?;
        let root: Root =
            serde_json::from_slice(text).map_err(|e| Refused::whole(format!("its JSON is wrong: {e}")))?;
        root.check().map_err(Refused::whole)?;
        let buffers = root.buffers.iter().enumerate();
        let buffers: Vec<_> = buffers.map(|(i, buffer)| fetch(i, buffer, blob, folder)).collect();
        let held = buffers.iter().flatten().map(|b| b.len() as u64).sum::<u64>();
        Ok(Self {
            roots: root.roots(),
            nodes: root.nodes,
            meshes: root.meshes,
            accessors: root.accessors,
            materials: root.materials,
            views: root.buffer_views,
            buffers,
            bytes: held + bytes.len() as u64,
        })
    }

    /// The nodes that the scene starts from; `None` where the file has no scene.
    pub(super) fn roots(&self) -> Option<&[usize]> {
        self.roots.as_deref()
    }

    /// The bytes of every buffer, or why they cannot be had.
    pub(super) fn buffers(&self) -> impl Iterator<Item = Result<&[u8], &str>> {
        self.buffers.iter().map(|buffer| buffer.as_deref().map_err(String::as_str))
    }

    /// The bytes of a buffer view, and how far apart its elements are if it says so.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), String> {
        let view = self.views.get(index).ok_or_else(|| format!("buffer view {index} is unknown"))?;
        let buffer = view.buffer.value();
        let bytes = self.buffers.get(buffer).ok_or_else(|| format!("buffer {buffer} is unknown"))?;
        let bytes = bytes.as_ref().map_err(|rule| format!("buffer {buffer} {rule}"))?;
        let start = usize::try_from(view.byte_offset.map_or(0, |offset| offset.0)).ok();
        let length = usize::try_from(view.byte_length.0).ok();
        let within = start.zip(length).and_then(|(start, length)| bytes.get(start..)?.get(..length));
        let within = within.ok_or_else(|| {
            format!("buffer view {index} must lie within the {} bytes of buffer {buffer}", bytes.len())
        })?;
        Ok((within, view.byte_stride.map(|stride| stride.0).filter(|&stride| stride > 0)))
    }

    pub(super) fn material(&self, index: usize) -> String {
        let name = self.materials.get(index).and_then(|m| m.name.as_deref());
        name.map_or_else(|| format!("material {index}"), short_name)
    }

    pub(super) fn mesh_name(&self, mesh: usize) -> String {
        let name = self.meshes.get(mesh).and_then(|m| m.name.as_deref());
        name.map_or_else(|| format!("mesh {mesh}"), short_name)
    }
}

impl Root {
    fn check(&self) -> Result<(), String> {
        if self.scene.is_some_and(|scene| scene >= self.scenes.len()) {
            return Err("its default scene must be one of its scenes".to_owned());
        }
        broken_rule(&self.asset.version, &self.extensions_required, &[]).map_or(Ok(()), Err)
    }

    fn roots(&self) -> Option<Vec<usize>> {
        let scene = self.scenes.get(self.scene.unwrap_or(0))?;
        Some(scene.nodes.clone())
    }
}

/// The bytes of a buffer: the GLB's own, written into the text, or a file's.
fn fetch<'a>(
    index: usize,
    buffer: &json::Buffer,
    blob: Option<&'a [u8]>,
    folder: Option<&Path>,
) -> Result<Cow<'a, [u8]>, String> {
    let bytes = match buffer.uri.as_deref() {
        None if index == 0 => Cow::Borrowed(blob.ok_or("must have a uri, or be in the file")?),
        None => return Err("must have a uri".to_owned()),
        Some(uri) => Cow::Owned(match uri.strip_prefix("data:") {
            Some(data) => inline(data).ok_or("must be data in base64")?,
            None => from_disk(uri, folder)?,
        }),
    };
    if (bytes.len() as u64) < buffer.byte_length.0 {
        return Err(format!("must have {} bytes, not {}", buffer.byte_length.0, bytes.len()));
    }
    Ok(bytes)
}

/// A file beside the glTF file. Only plain files are opened, so that nothing is read for ever.
pub(super) fn from_disk(uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    let folder = folder.ok_or("must be in the file itself here")?;
    let name = unescaped(uri).filter(|name| !name.contains(':') && !Path::new(name).is_absolute());
    let path = folder.join(name.ok_or_else(|| format!("must be a file beside this one, not {uri:?}"))?);
    let unreadable = |e: std::io::Error| format!("cannot be read from {}: {e}", path.display());
    if !fs::metadata(&path).map_err(unreadable)?.is_file() {
        return Err(format!("must be a plain file, unlike {}", path.display()));
    }
    fs::read(&path).map_err(unreadable)
}

/// A relative reference with its `%XX` resolved.
fn unescaped(uri: &str) -> Option<String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        bytes.push(u8::from_str_radix(part.get(..2)?, 16).ok()?);
        bytes.extend_from_slice(&part.as_bytes()[2..]);
    }
    String::from_utf8(bytes).ok()
}

/// What follows `data:`: a type, and base64 (RFC 4648, with or without padding).
fn inline(data: &str) -> Option<Vec<u8>> {
    let (_, text) = data.split_once(";base64,")?;
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for four in text.chunks(4) {
        let bits = four.iter().try_fold(0, |bits: u32, &letter| Some(bits << 6 | sextet(letter)?))?;
        let bits = bits << (6 * (4 - four.len()));
        let whole = four.len() * 6 / 8;
        bytes.extend_from_slice(bits.to_be_bytes().get(1..1 + whole)?);
    }
    Some(bytes)
}

fn sextet(letter: u8) -> Option<u32> {
    let value = match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' | b'-' => 62,
        b'/' | b'_' => 63,
        _ => return None,
    };
    Some(u32::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_read_with_and_without_padding() {
        for (text, bytes) in
            [("", ""), ("Zg==", "f"), ("Zg", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob")]
        {
            assert_eq!(inline(&format!("a/b;base64,{text}")).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(inline("a/b;base64,+/-_").as_deref(), Some([0xfb, 0xff, 0xbf].as_slice()));
        assert_eq!((inline("a/b,Zg"), inline(";base64,Z!"), inline(";base64,A")), (None, None, Some(vec![])));
    }

    #[test]
    fn only_files_beside_are_opened() {
        assert_eq!(unescaped("a%20b.bin").as_deref(), Some("a b.bin"));
        assert_eq!((unescaped("a%2"), unescaped("a%zz")), (None, None));
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("a b.bin"), b"x").expect("written");
        assert_eq!(from_disk("a%20b.bin", Some(folder.path())), Ok(vec![b'x']));
        for uri in ["/etc/hosts", "file:a", "http://a/b", "missing.bin", "."] {
            assert!(from_disk(uri, Some(folder.path())).is_err(), "{uri}");
        }
        assert!(from_disk("a%20b.bin", None).is_err());
    }
}
