//! The head: what a file is of, and how much of it there is.

use super::bytes::{Bytes, Fault, put_number};
use crate::bake::progressive::row::Columns;

/// Most sets of texture coordinates.
pub(in crate::bake::progressive) const MOST_UVS: usize = 255;

/// How much there is of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Positions.
    pub positions: usize,
    /// Wedges.
    pub wedges: usize,
    /// Triangles.
    pub triangles: usize,
}

/// A group's name, its material, and the triangles it has in the original.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::bake::progressive) struct GroupHead {
    pub(in crate::bake::progressive) name: String,
    pub(in crate::bake::progressive) material: Option<String>,
    pub(in crate::bake::progressive) triangles: usize,
}

/// The head of a file. What it says of parts that follow is not believed before they are there.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::bake::progressive) struct Head {
    pub(in crate::bake::progressive) name: String,
    pub(in crate::bake::progressive) columns: Columns,
    pub(in crate::bake::progressive) groups: Vec<GroupHead>,
    pub(in crate::bake::progressive) base: Counts,
    /// After all splits.
    pub(in crate::bake::progressive) full: Counts,
    pub(in crate::bake::progressive) original: Counts,
    pub(in crate::bake::progressive) splits: usize,
    /// Of the base mesh, in steps.
    pub(in crate::bake::progressive) error: u32,
}

impl Head {
    pub(in crate::bake::progressive) fn put(&self, out: &mut Vec<u8>) {
        put_text(&self.name, out);
        let Columns { normals, uvs, colours, tangents, skins } = self.columns;
        let flags = [normals, colours, tangents, skins];
        out.push(flags.iter().rev().fold(0, |all, &is_there| all << 1 | u8::from(is_there)));
        put_number(uvs as u32, out);
        put_number(self.groups.len() as u32, out);
        for group in &self.groups {
            put_text(&group.name, out);
            out.push(u8::from(group.material.is_some()));
            put_text(group.material.as_deref().unwrap_or_default(), out);
            put_number(group.triangles as u32, out);
        }
        for Counts { positions, wedges, triangles } in [self.base, self.full, self.original] {
            [positions, wedges, triangles].iter().for_each(|&count| put_number(count as u32, out));
        }
        put_number(self.splits as u32, out);
        put_number(self.error, out);
    }

    pub(in crate::bake::progressive) fn read(bytes: &mut Bytes) -> Result<Self, Fault> {
        let name = text(bytes)?;
        let fault = bytes.fault("attributes must be those that are known");
        let flags = bytes.byte()?;
        if flags >> 4 != 0 {
            return Err(fault);
        }
        let has = |bit: u8| flags >> bit & 1 == 1;
        let uvs = bytes.below(MOST_UVS + 1, "there must not be more than 255 sets of texture coordinates")?;
        let columns =
            Columns { normals: has(0), uvs: uvs as usize, colours: has(1), tangents: has(2), skins: has(3) };
        let count = bytes.count()?;
        let groups = (0..count).map(|_| group(bytes)).collect::<Result<_, _>>()?;
        let [base, full, original] = [counts(bytes)?, counts(bytes)?, counts(bytes)?];
        let splits = bytes.number()? as usize;
        let error = bytes.below(super::record::MOST_STEPS as usize + 1, "an error must be a number")?;
        Ok(Self { name, columns, groups, base, full, original, splits, error })
    }
}

fn group(bytes: &mut Bytes) -> Result<GroupHead, Fault> {
    let name = text(bytes)?;
    let has_material = bytes.byte()? != 0;
    let material = Some(text(bytes)?).filter(|_| has_material);
    Ok(GroupHead { name, material, triangles: bytes.number()? as usize })
}

fn counts(bytes: &mut Bytes) -> Result<Counts, Fault> {
    let mut number = || bytes.number().map(|n| n as usize);
    Ok(Counts { positions: number()?, wedges: number()?, triangles: number()? })
}

fn put_text(text: &str, out: &mut Vec<u8>) {
    put_number(text.len() as u32, out);
    out.extend_from_slice(text.as_bytes());
}

fn text(bytes: &mut Bytes) -> Result<String, Fault> {
    let length = bytes.count()?;
    let fault = bytes.fault("a name must be UTF-8");
    let text = std::str::from_utf8(bytes.take(length)?).map_err(|_| fault)?;
    Ok(text.to_owned())
}
