//! The bytes of a GLB, and the views and accessors into them.

use glam::Vec3;
use serde_json::{Value, json};

use crate::bounds::Aabb;

/// What is written so far: columns one after the other, each in a view of its own, at multiples of 4 bytes.
#[derive(Debug, Default)]
pub(in crate::bake) struct Blob {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

const FLOAT: u32 = 5126;
const U16: u32 = 5123;
const U32: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

impl Blob {
    /// What is written after the bytes, views and accessors of a file. Its one buffer must end at a multiple of 4 bytes.
    pub(in crate::bake) fn after(bytes: Vec<u8>, views: Vec<Value>, accessors: Vec<Value>) -> Self {
        Self { bytes, views, accessors }
    }

    /// Rows of 2 to 4 floats. Returns the accessor, as all of these do.
    pub(super) fn floats<const N: usize>(&mut self, rows: &[[f32; N]]) -> usize {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N.clamp(1, 4) - 1];
        let bytes = rows.as_flattened().iter().flat_map(|x| x.to_le_bytes());
        self.column(bytes, VERTICES, json!({ "componentType": FLOAT, "count": rows.len(), "type": kind }))
    }

    /// Positions, with the box around them.
    pub(super) fn positions(&mut self, rows: &[[f32; 3]]) -> usize {
        let accessor = self.floats(rows);
        let Aabb { min, max } = Aabb::around(rows.iter().copied().map(Vec3::from));
        self.accessors[accessor]["min"] = json!(min.to_array());
        self.accessors[accessor]["max"] = json!(max.to_array());
        accessor
    }

    pub(super) fn joints(&mut self, rows: &[[u16; 4]]) -> usize {
        let bytes = rows.as_flattened().iter().flat_map(|x| x.to_le_bytes());
        self.column(bytes, VERTICES, json!({ "componentType": U16, "count": rows.len(), "type": "VEC4" }))
    }

    /// Indices of so many vertices, in 16 bits where none is 65 535, which would restart a strip.
    pub(super) fn indices(&mut self, indices: &[u32], vertices: usize) -> usize {
        let accessor = |kind: u32| json!({ "componentType": kind, "count": indices.len(), "type": "SCALAR" });
        if vertices <= usize::from(u16::MAX) {
            self.column(indices.iter().flat_map(|&i| (i as u16).to_le_bytes()), INDICES, accessor(U16))
        } else {
            self.column(indices.iter().flat_map(|i| i.to_le_bytes()), INDICES, accessor(U32))
        }
    }

    fn column(&mut self, bytes: impl Iterator<Item = u8>, target: u32, mut accessor: Value) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - start;
        pad(&mut self.bytes, 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": length, "target": target }));
        accessor["bufferView"] = json!(self.views.len() - 1);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Whether a GLB can still hold it.
    pub(in crate::bake) fn check(&self) -> Result<(), &'static str> {
        if self.bytes.len() > u32::MAX as usize { Err(TOO_LARGE) } else { Ok(()) }
    }

    /// Views, accessors, bytes.
    pub(in crate::bake) fn into_parts(self) -> (Vec<Value>, Vec<Value>, Vec<u8>) {
        (self.views, self.accessors, self.bytes)
    }
}

const TOO_LARGE: &str = "with it there are more than 4 GiB, which is as much as a GLB can have";

/// The file's one buffer, where it has any bytes.
pub(super) fn buffers(bytes: &[u8]) -> Vec<Value> {
    if bytes.is_empty() { Vec::new() } else { vec![json!({ "byteLength": bytes.len() })] }
}

/// A GLB: a header of 12 bytes, then chunks, each of length, kind and bytes: the JSON and, where there are any, the
/// buffer's.
pub(in crate::bake) fn packed(json: &str, mut blob: Vec<u8>) -> Result<Vec<u8>, &'static str> {
    let mut json = json.as_bytes().to_vec();
    pad(&mut json, b' ');
    pad(&mut blob, 0);
    let mut chunks = vec![(b"JSON", json)];
    chunks.extend((!blob.is_empty()).then_some((b"BIN\0", blob)));
    let length = 12 + chunks.iter().map(|(_, bytes)| 8 + bytes.len()).sum::<usize>();
    let total = u32::try_from(length).map_err(|_| TOO_LARGE)?;
    let mut file = Vec::with_capacity(length);
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend(total.to_le_bytes());
    for (kind, bytes) in chunks {
        // Shorter than the file, whose length is 32 bits.
        file.extend((bytes.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(bytes);
    }
    Ok(file)
}

/// Fills up to a multiple of 4 bytes.
fn pad(bytes: &mut Vec<u8>, with: u8) {
    bytes.resize(bytes.len().next_multiple_of(4), with);
}
