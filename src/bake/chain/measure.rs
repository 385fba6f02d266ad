//! Levels and what is measured of them.

use super::{Appearance, BakeError, Chain, Lineage};
use crate::bake::deviation::{self, Deviation, Ruler};
use crate::bake::mesh::Mesh;

/// A level, and how far it is from level 0.
#[derive(Clone, Debug)]
pub struct ChainLevel {
    /// What is drawn.
    pub mesh: Mesh,
    /// From level 0, both ways.
    pub deviation: Deviation,
    /// The greatest Hausdorff bound of this and all finer levels, rounded up, in object units: the runtime's contract.
    pub error: f32,
    /// How it looks beside level 0; `None` for level 0 itself, and where nobody looked.
    pub appearance: Option<Appearance>,
    /// What became of the positions of a finer level; `None` for level 0, and for levels that somebody else made.
    pub lineage: Option<Lineage>,
}

impl ChainLevel {
    /// Triangles drawn.
    pub fn triangles(&self) -> usize {
        self.mesh.triangles.len()
    }

    /// Vertices processed: a graphics card needs one for each wedge.
    pub fn vertices(&self) -> usize {
        self.mesh.wedges.len()
    }

    /// Draw calls: one for each group that has triangles.
    pub fn draws(&self) -> usize {
        self.mesh.groups.iter().filter(|group| !group.triangles.is_empty()).count()
    }

    /// What one vertex buffer and one index buffer take, tightly packed: 12 bytes a position or normal, 8 a texture
    /// coordinate, 16 a colour or tangent, 24 for joints (16 bits each) and weights; indices of 16 bits for up to 65 535
    /// vertices, else of 32.
    pub fn bytes(&self) -> u64 {
        let mesh = &self.mesh;
        let column = |rows: usize, bytes: u64| if rows > 0 { bytes } else { 0 };
        let vertex = 12
            + column(mesh.normals.len(), 12)
            + 8 * mesh.uvs.len() as u64
            + column(mesh.colours.len(), 16)
            + column(mesh.tangents.len(), 16)
            + column(mesh.skins.len(), 24);
        let index = if mesh.wedges.len() <= usize::from(u16::MAX) { 2 } else { 4 };
        vertex * mesh.wedges.len() as u64 + 3 * index * mesh.triangles.len() as u64
    }
}

/// Measures levels against level 0.
pub(super) struct Gauge<'a> {
    ruler: Ruler,
    options: &'a deviation::Options,
}

impl<'a> Gauge<'a> {
    pub(super) fn new(finest: &Mesh, options: &'a deviation::Options) -> Result<Self, BakeError> {
        Ok(Self { ruler: Ruler::new(&finest.surface())?, options })
    }

    /// The level as measured, not yet looked at. Its `error` is that of itself alone until the chain is whole.
    pub(super) fn measured(&self, mesh: Mesh) -> Result<ChainLevel, BakeError> {
        let deviation = self.ruler.deviation(&mesh.surface(), self.options)?;
        let error = deviation::running_max(&[deviation])[0];
        Ok(ChainLevel { mesh, deviation, error, appearance: None, lineage: None })
    }

    /// The same with what became of the positions of level 0.
    pub(super) fn descended(&self, mesh: Mesh, heirs: Vec<u32>) -> Result<ChainLevel, BakeError> {
        Ok(ChainLevel { lineage: Some(Lineage::of_finest(heirs)), ..self.measured(mesh)? })
    }
}

/// Makes every error the greatest so far.
pub(super) fn accumulate(levels: &mut [ChainLevel]) {
    let deviations: Vec<Deviation> = levels.iter().map(|level| level.deviation).collect();
    for (level, error) in levels.iter_mut().zip(deviation::running_max(&deviations)) {
        level.error = error;
    }
}

/// What [`Chain::of_levels`] says.
pub(super) fn chain(meshes: Vec<Mesh>, options: &deviation::Options) -> Result<Chain, BakeError> {
    let finest = meshes.first().ok_or(BakeError::NoTriangles)?;
    let gauge = Gauge::new(finest, options)?;
    let mut levels = meshes.into_iter().map(|mesh| gauge.measured(mesh)).collect::<Result<Vec<_>, _>>()?;
    accumulate(&mut levels);
    Ok(Chain { levels, unreferenced: 0, left_out: Vec::new() })
}
