//! The atlas: where each frame is in one image.

use serde::{Deserialize, Serialize};

use super::frame::{Extent, Frame, View};
use super::{ImpostorError, Kind, Options};

/// How frames are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AtlasOptions {
    /// The most pixels each way, 16 to 16 384.
    pub side_px: u32,
    /// What its sides may be.
    pub sides: Sides,
    /// Mip levels below the image in which frames do not run into each other, 0 to 6. There are 2^mips pixels of gutter
    /// around each frame, and cells begin at multiples of that.
    pub mips: u32,
    /// Memory of a texel in all its images, 1 to 64. 4 is colour and coverage as they are, 1 is what block compression
    /// makes of that; normals and depth come on top.
    pub bytes_per_texel: u32,
}

/// What the sides of an atlas may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Powers of two, as old hardware and some block compression want.
    PowersOfTwo,
    /// Multiples of the gutter.
    Any,
}

impl Default for AtlasOptions {
    /// At most 2048 pixels each way, powers of two, two mip levels, 4 bytes.
    fn default() -> Self {
        Self { side_px: 2048, sides: Sides::PowersOfTwo, mips: 2, bytes_per_texel: 4 }
    }
}

impl AtlasOptions {
    pub(super) fn check(&self) -> Result<(), &'static str> {
        let rules = [
            (
                (16..=16_384).contains(&self.side_px),
                "the atlas must have at most 16 to 16384 pixels each way",
            ),
            (self.mips <= 6, "frames must be kept apart in at most 6 mip levels"),
            ((1..=64).contains(&self.bytes_per_texel), "a texel must have 1 to 64 bytes"),
        ];
        rules.into_iter().find(|(holds, _)| !holds).map_or(Ok(()), |(_, rule)| Err(rule))
    }

    fn side(&self, pixels: u32) -> u32 {
        match self.sides {
            Sides::PowersOfTwo => pixels.next_power_of_two(),
            Sides::Any => pixels,
        }
    }
}

/// The image with all frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Atlas {
    /// Pixels.
    pub width_px: u32,
    /// Pixels.
    pub height_px: u32,
    /// Pixels around each frame that belong to it: copies of its border.
    pub gutter_px: u32,
    /// Mip levels below the image in which frames do not run into each other.
    pub mips: u32,
    /// The same for all frames, > 0; object units.
    pub texels_per_unit: f64,
    /// Memory of all images with their mip levels.
    pub bytes: u64,
}

/// Pixels of the atlas, from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rectangle {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// At least 1.
    pub width: u32,
    /// At least 1.
    pub height: u32,
}

/// How much larger texels get where frames do not fit. Nearer to 1 wastes less of the atlas and takes longer.
const SHRINK: f64 = 0.95;

/// Texels across the bound below which there is no picture.
const LEAST_TEXELS: f64 = 4.0;

/// The frames at the finest resolution that is asked for and fits.
pub(super) fn fitted(
    options: &Options,
    radius: f64,
    views: &[View],
    extents: &[Extent],
) -> Result<(Atlas, Vec<Frame>), ImpostorError> {
    let mut texels = options.size_px;
    while texels >= LEAST_TEXELS {
        let texels_per_unit = texels / (2.0 * radius);
        let frame = |(view, extent)| Frame::of(view, extent, texels_per_unit, options.outline);
        let mut frames: Vec<Frame> = views.iter().zip(extents).map(frame).collect();
        if let Some([width_px, height_px]) = place(&mut frames, options) {
            return Ok((atlas(options, [width_px, height_px], texels_per_unit), frames));
        }
        texels *= SHRINK;
    }
    Err(ImpostorError::Atlas { frames: views.len(), side_px: options.atlas.side_px })
}

fn atlas(options: &Options, [width_px, height_px]: [u32; 2], texels_per_unit: f64) -> Atlas {
    let mips = options.atlas.mips;
    let mip = |level: u32| u64::from((width_px >> level).max(1)) * u64::from((height_px >> level).max(1));
    let texels: u64 = (0..=width_px.max(height_px).ilog2()).map(mip).sum();
    let bytes = texels * u64::from(options.atlas.bytes_per_texel);
    Atlas { width_px, height_px, gutter_px: 1 << mips, mips, texels_per_unit, bytes }
}

/// Puts frames into an atlas and returns its size; `None` where they do not fit.
fn place(frames: &mut [Frame], options: &Options) -> Option<[u32; 2]> {
    let gutter = 1 << options.atlas.mips;
    let cell = |length: u32| (length + 2 * gutter).next_multiple_of(gutter);
    let cells: Vec<[u32; 2]> =
        frames.iter().map(|f| [cell(f.rectangle_px.width), cell(f.rectangle_px.height)]).collect();
    // Longer than any atlas; products below must not overflow.
    if cells.as_flattened().iter().any(|&length| length > options.atlas.side_px) {
        return None;
    }
    let ([width, height], corners) = match options.kind {
        Kind::Octahedral { frames, .. } => grid(&cells, frames),
        _ => shelves(&cells, &options.atlas),
    };
    for (frame, [x, y]) in frames.iter_mut().zip(corners) {
        (frame.rectangle_px.x, frame.rectangle_px.y) = (x + gutter, y + gutter);
    }
    let size = [options.atlas.side(width), options.atlas.side(height)];
    size.iter().all(|&side| side <= options.atlas.side_px).then_some(size)
}

/// Size and corners.
type Placed = ([u32; 2], Vec<[u32; 2]>);

/// Equal cells in rows of so many, so that a shader finds them by multiplication.
fn grid(cells: &[[u32; 2]], columns: u32) -> Placed {
    let most = |axis: usize| cells.iter().map(|cell| cell[axis]).max().unwrap_or(0);
    let (width, height) = (most(0), most(1));
    let corner = |k: u32| [k % columns * width, k / columns * height];
    let count = cells.len() as u32;
    ([columns * width, count.div_ceil(columns) * height], (0..count).map(corner).collect())
}

/// Rows of falling height: of the widths at which the first row ends after a cell, that of the smallest image.
fn shelves(cells: &[[u32; 2]], options: &AtlasOptions) -> Placed {
    let mut order: Vec<usize> = (0..cells.len()).collect();
    order.sort_by_key(|&k| (std::cmp::Reverse(cells[k][1]), k));
    let widest = cells.iter().map(|cell| cell[0]).max().unwrap_or(0);
    let ends = order.iter().scan(0, |end, &k| {
        *end += cells[k][0];
        Some(*end)
    });
    let all = ends.map(|end| filled(cells, &order, options.side(end.max(widest))));
    let size = |placed: &Placed| {
        let [width, height] = placed.0.map(|side| u64::from(options.side(side)));
        (width * height, width.max(height), width)
    };
    all.min_by_key(size).unwrap_or(([0, 0], Vec::new()))
}

/// Rows no wider than `width`.
fn filled(cells: &[[u32; 2]], order: &[usize], width: u32) -> Placed {
    let mut corners = vec![[0, 0]; cells.len()];
    let ([mut x, mut y], mut row, mut used) = ([0, 0], 0, 0);
    for &k in order {
        if x + cells[k][0] > width {
            (x, y, row) = (0, y + row, 0);
        }
        corners[k] = [x, y];
        x += cells[k][0];
        (row, used) = (row.max(cells[k][1]), used.max(x));
    }
    ([used, y + row], corners)
}
