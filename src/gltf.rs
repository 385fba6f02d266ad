//! What the readers of glTF 2.0 share: where in a file its text is, what it may require, and how a node is placed.

use ::gltf::json::Node;
use glam::{DMat4, DQuat, DVec3};

/// The JSON of a text or GLB file, and the bytes in it if it has any.
///
/// # Errors
/// A GLB that is none, of another version, or cut off.
pub(crate) fn parts(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    match bytes.starts_with(b"glTF") {
        true => chunks(bytes),
        false => Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None)),
    }
}

/// The JSON of a GLB, and its bytes if it has any: a header of 12 bytes (magic, version, length), then chunks (length,
/// kind, bytes).
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let field = |at: usize| u32_at(bytes, at).ok_or("it is cut off within its header");
    let (version, length) = (field(4)?, field(8)? as usize);
    if version != 2 {
        return Err(format!("its GLB version must be 2, not {version}"));
    }
    let all = bytes
        .get(..length)
        .ok_or_else(|| format!("it is cut off: its header says {length} bytes, it has {}", bytes.len()))?;
    let (kind, json, mut rest) = chunk(all.get(12..).unwrap_or_default())?;
    if kind != b"JSON" {
        return Err("its first chunk must be JSON".to_owned());
    }
    let second = if rest.is_empty() { None } else { Some(chunk(rest)?) };
    while !rest.is_empty() {
        (_, _, rest) = chunk(rest)?;
    }
    Ok((json, second.filter(|(kind, ..)| *kind == b"BIN\0").map(|(_, blob, _)| blob)))
}

type Chunk<'a> = (&'a [u8], &'a [u8], &'a [u8]);

/// The first chunk's kind and bytes, and what follows.
fn chunk(bytes: &[u8]) -> Result<Chunk<'_>, String> {
    let cut = || "it is cut off within a chunk".to_owned();
    let length = u32_at(bytes, 0).ok_or_else(cut)? as usize;
    let kind = bytes.get(4..8).ok_or_else(cut)?;
    let (chunk, rest) = bytes[8..].split_at_checked(length).ok_or_else(cut)?;
    Ok((kind, chunk, rest))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// Required extensions that leave counts, bounds and geometry as they are: images, lights, metadata, levels.
/// `KHR_materials_*` are fine as well.
const HARMLESS: [&str; 14] = [
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_texture_avif",
    "EXT_texture_procedurals",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_texture_dds",
];

/// The rule that a file of this version breaks, or that requires these extensions, of which `known` are no hindrance.
pub(crate) fn broken_rule(version: &str, required: &[String], known: &[&str]) -> Option<String> {
    if !version.starts_with("2.") {
        return Some(format!("its asset.version must be 2.x, not {version}"));
    }
    let is_fine =
        |name: &str| HARMLESS.contains(&name) || known.contains(&name) || name.starts_with("KHR_materials_");
    let strange = required.iter().find(|name| !is_fine(name))?;
    Some(format!("it requires the extension {strange}, which is not supported"))
}

/// The transform of a node, given as a matrix or as scale, rotation, translation. Doubles, so that what is moved through
/// it rounds once, at the end.
///
/// # Errors
/// A matrix that is not affine, a rotation without length.
pub(crate) fn local(node: &Node) -> Result<DMat4, &'static str> {
    match node.matrix {
        Some(matrix) => affine(DMat4::from_cols_array(&matrix.map(f64::from))),
        None => composed(node),
    }
}

fn affine(matrix: DMat4) -> Result<DMat4, &'static str> {
    let last = matrix.row(3);
    if last.truncate().abs().max_element() > 1e-6 || (last.w - 1.0).abs() > 1e-6 {
        return Err("its matrix must be affine: the last row must be 0, 0, 0, 1");
    }
    Ok(matrix)
}

fn composed(node: &Node) -> Result<DMat4, &'static str> {
    let scale = node.scale.map_or(DVec3::ONE, |s| DVec3::from_array(s.map(f64::from)));
    let translation = node.translation.map_or(DVec3::ZERO, |t| DVec3::from_array(t.map(f64::from)));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
    let length = rotation.length();
    if length.is_nan() || length < 1e-6 {
        return Err("its rotation must have a length");
    }
    Ok(DMat4::from_scale_rotation_translation(scale, rotation / length, translation))
}
