//! What became of the positions of finer levels.

use super::ChainLevel;
use crate::bake::geomorph::{Geomorph, GeomorphError};
use crate::bake::simplify::Simplified;

/// Which position of a level each position of a finer one became: 4 bytes for each of the finer one's.
///
/// The finer one is the level just before wherever methods go on from there in effect, so that all lineages of a chain
/// that halves take no more than two for level 0. Where a level does not follow from the one before, as with grids of
/// clusters that do not nest, it is the last one that it follows from; every level follows from level 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lineage {
    base: usize,
    heirs: Vec<u32>,
}

impl Lineage {
    /// From what became of the positions of level 0.
    pub(super) fn of_finest(heirs: Vec<u32>) -> Self {
        Self { base: 0, heirs }
    }

    /// The same of a level that is to follow these ones, from the last that it follows from.
    pub(super) fn shortest(self, levels: &[ChainLevel]) -> Self {
        let since = |base| {
            let heirs = factor(&heirs_between(levels, 0, base)?, &self.heirs, &levels[base])?;
            Some(Self { base, heirs })
        };
        (1..levels.len()).rev().find_map(since).unwrap_or(self)
    }

    /// The finer level.
    pub fn base(&self) -> usize {
        self.base
    }

    /// Per position of the finer level, that of this one, or [`Simplified::GONE`].
    pub fn heirs(&self) -> &[u32] {
        &self.heirs
    }
}

/// What positions of `base` became, if all that became one of them has one heir.
fn factor(to_base: &[u32], heirs: &[u32], base: &ChainLevel) -> Option<Vec<u32>> {
    const UNKNOWN: u32 = Simplified::GONE - 1;
    let mut factor = vec![UNKNOWN; base.mesh.positions.len()];
    for (&middle, &heir) in to_base.iter().zip(heirs).filter(|&(&middle, _)| middle != Simplified::GONE) {
        let known = factor.get_mut(middle as usize)?;
        if *known != UNKNOWN && *known != heir {
            return None;
        }
        *known = heir;
    }
    (!factor.contains(&UNKNOWN)).then_some(factor)
}

/// What positions of a finer level became in a coarser one; `None` where lineages do not lead from one to the other.
pub(super) fn heirs_between(levels: &[ChainLevel], finer: usize, coarser: usize) -> Option<Vec<u32>> {
    let level = levels.get(coarser)?;
    if finer == coarser {
        return Some((0..level.mesh.positions.len() as u32).collect());
    }
    let lineage = level.lineage.as_ref().filter(|lineage| finer <= lineage.base && lineage.base < coarser)?;
    let heir = |&middle: &u32| match middle {
        Simplified::GONE => Some(Simplified::GONE),
        middle => lineage.heirs.get(middle as usize).copied(),
    };
    heirs_between(levels, finer, lineage.base)?.iter().map(heir).collect()
}

/// What [`super::Chain::geomorph`] says.
pub(super) fn geomorph(
    levels: &[ChainLevel],
    finer: usize,
    coarser: usize,
) -> Result<Geomorph, GeomorphError> {
    if finer > coarser || coarser >= levels.len() {
        return Err(GeomorphError::Levels { finer, coarser, levels: levels.len() });
    }
    let heirs = heirs_between(levels, finer, coarser);
    Geomorph::between(&levels[finer].mesh, &levels[coarser].mesh, heirs.as_deref())
}
