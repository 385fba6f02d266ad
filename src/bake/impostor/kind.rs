//! What an impostor draws.

use serde::{Deserialize, Serialize};

/// The kinds of impostors, the order of their frames, and how each is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Kind {
    /// One quad through the middle that turns to the viewer and shows the picture whose direction, around the axis, is
    /// nearest. Cheap, and good for what looks alike from all sides.
    ///
    /// Frame k of n is taken from the middle of the k-th of n equal parts of the range of yaw, at elevation 0.
    Billboard {
        /// How it turns.
        facing: Facing,
        /// 1 to 64. With one, what is seen turns with the viewer.
        frames: u32,
    },
    /// Upright quads that cross at the axis, and stay as they are: needs no code in an engine. From between two quads it
    /// is seen that they are flat, from above that they are upright.
    ///
    /// Frame k of n looks at the quad that is turned by 180° · k / n from the front; the horizontal one, from above, is
    /// the last. Quads are drawn from both sides.
    CrossQuads {
        /// 2 to 8.
        planes: u32,
        /// Whether a horizontal quad through the middle is added.
        horizontal: bool,
    },
    /// A quad that covers the object, on which every pixel is the blend of three pictures: for each, the ray through the
    /// pixel meets the plane through the middle that the picture was taken across, and what the picture has there counts
    /// by its weight. Follows the viewer smoothly.
    ///
    /// Frames are the points of a square grid under the [octahedral map](super::Octahedron), row by row.
    Octahedral {
        /// Frames each way: odd, 3 to 31.
        frames: u32,
        /// Only directions from above; from below, what is seen from the horizon is shown.
        hemisphere: bool,
    },
}

/// How a billboard turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Facing {
    /// Right at the viewer. Seen from above it lies on its back.
    Viewer,
    /// Around the axis alone, as trees do. Seen from above it gets short.
    Axis,
}

impl Kind {
    /// How many frames it has.
    pub fn frame_count(self) -> usize {
        match self {
            Self::Billboard { frames, .. } => frames as usize,
            Self::CrossQuads { planes, horizontal } => planes as usize + usize::from(horizontal),
            Self::Octahedral { frames, .. } => (frames as usize).saturating_mul(frames as usize),
        }
    }

    /// Whether its numbers are in range.
    ///
    /// # Errors
    /// The rule that is broken.
    pub fn check(self) -> Result<(), &'static str> {
        let (holds, rule) = match self {
            Self::Billboard { frames, .. } => {
                ((1..=64).contains(&frames), "a billboard must have 1 to 64 frames")
            }
            Self::CrossQuads { planes, .. } => {
                ((2..=8).contains(&planes), "cross-quads must have 2 to 8 planes")
            }
            Self::Octahedral { frames, .. } => (
                (3..=31).contains(&frames) && frames % 2 == 1,
                "an octahedral impostor must have an odd number of frames each way, from 3 to 31",
            ),
        };
        if holds { Ok(()) } else { Err(rule) }
    }

    /// Whether pictures stay in the planes they were taken across, instead of turning with the viewer.
    pub(super) fn stands(self) -> bool {
        !matches!(self, Self::Billboard { .. })
    }
}
