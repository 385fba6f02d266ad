//! The exact test of the sixteen objects of a block, shared by the linear scan and the tree.

use glam::Vec3;

use super::value::{Floor, ValueFloor};
use super::{CullOptions, CullReport, VisibleBlock};
use crate::kernel::{Kernel, run};
use crate::scene::{BLOCK, Block, Objects};
use crate::view::{Lens, PLANES};

/// Bits of the tests that are still open: one per plane, then the limits. A test is closed when all objects in question
/// are known to pass it.
pub(super) type OpenTests = u16;

/// All planes.
pub(super) const ALL_PLANES: OpenTests = (1 << PLANES) - 1;
/// The contribution cull.
pub(super) const SIZE: OpenTests = 1 << PLANES;
/// The draw distance.
pub(super) const DISTANCE: OpenTests = 2 << PLANES;
/// The value floor.
pub(super) const VALUE: OpenTests = 4 << PLANES;

/// A frame's question to the objects, and where the answer goes.
pub(super) struct Cull<'a> {
    pub objects: &'a Objects,
    pub lens: &'a Lens,
    pub min_size_px: f32,
    pub floor: Floor<'a>,
    pub visible: &'a mut Vec<VisibleBlock>,
    pub report: CullReport,
}

impl<'a> Cull<'a> {
    pub fn new(
        objects: &'a Objects,
        lens: &'a Lens,
        options: &CullOptions,
        floor: &ValueFloor<'a>,
        visible: &'a mut Vec<VisibleBlock>,
    ) -> Self {
        visible.clear();
        let (floor, report) = (Floor::new(floor, lens), CullReport::default());
        Self { objects, lens, min_size_px: options.min_size_px, floor, visible, report }
    }

    /// The tests that an object has to pass.
    pub fn tests(&self) -> OpenTests {
        let size = if self.min_size_px > 0.0 { SIZE } else { 0 };
        let value = if self.floor.is_open() { VALUE } else { 0 };
        ALL_PLANES | DISTANCE | size | value
    }

    /// Puts the `live` objects of a block to the open tests and yields those that pass.
    pub fn test(&mut self, index: usize, live: u16, open: OpenTests) {
        let block = &self.objects.blocks()[index];
        self.report.blocks_tested += 1;
        self.report.objects_tested += u64::from(live.count_ones());
        let mut seen = live & run(InView { block, lens: self.lens, open });
        if seen != 0 && open & !ALL_PLANES != 0 {
            seen = self.within_limits(index, block, seen, open);
        }
        self.yield_block(index, seen);
    }

    /// The lanes of `seen` that pass the open limits.
    fn within_limits(&mut self, index: usize, block: &Block, seen: u16, open: OpenTests) -> u16 {
        let far = if open & DISTANCE != 0 { self.too_far(index, block, seen) } else { 0 };
        let near = seen & !far;
        let small = if open & SIZE != 0 { self.too_small(index, block, near) } else { 0 };
        let large = near & !small;
        let over =
            if open & VALUE != 0 { self.floor.passes_over(self.objects, index, self.lens, large) } else { 0 };
        self.report.too_far += u64::from(far.count_ones());
        self.report.too_small += u64::from(small.count_ones());
        self.report.worth_too_little += u64::from(over.count_ones());
        large & !over
    }

    /// Yields the objects in `mask`, if there are any.
    pub fn yield_block(&mut self, index: usize, mask: u16) {
        if mask != 0 {
            self.report.visible += u64::from(mask.count_ones());
            self.visible.push(VisibleBlock { block: index as u32, mask });
        }
    }

    /// Which of the lanes in `mask` are beyond their draw distance. Only an adjusted lane has one.
    fn too_far(&self, index: usize, block: &Block, mask: u16) -> u16 {
        select(mask & block.adjusted, |lane| {
            let limit = self.objects.settings(index * BLOCK + lane).draw_distance;
            length(block.sphere(lane).center - self.lens.eye) > limit
        })
    }

    /// Which of the lanes in `mask` are too small. Only an adjusted lane has a bias other than 1.
    fn too_small(&self, index: usize, block: &Block, mask: u16) -> u16 {
        let plain = mask & !block.adjusted & small_lanes(block, self.lens, self.min_size_px);
        let adjusted = select(mask & block.adjusted, |lane| {
            let radius = block.radius[lane] * self.objects.settings(index * BLOCK + lane).bias;
            let distance = self.lens.distance(block.sphere(lane).center);
            size_px(self.lens, radius, distance) < self.min_size_px
        });
        plain | adjusted
    }
}

/// Projected diameter of a sphere at a distance as [`Lens::distance`] gives it: the arithmetic of [`Lens::size_px`].
pub(super) fn size_px(lens: &Lens, radius: f32, distance: f32) -> f32 {
    2.0 * radius * lens.scale_px / distance
}

/// Length of a vector, in the arithmetic of [`Lens::distance`].
pub(super) fn length(d: Vec3) -> f32 {
    (d.x * d.x + d.y * d.y + d.z * d.z).sqrt()
}

/// The positions of the bits of `mask`, ascending.
pub(super) fn lanes_of(mut mask: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < BLOCK).then_some(lane)
    })
}

/// The lanes of `mask` for which `is_so` holds.
fn select(mask: u16, is_so: impl Fn(usize) -> bool) -> u16 {
    lanes_of(mask).fold(0, |selected, lane| selected | u16::from(is_so(lane)) << lane)
}

/// The lanes that [`Frustum::sees`](crate::view::Frustum::sees), as far as the open planes can tell. Straight loops
/// over the lanes, which compilers turn into vector code.
struct InView<'a> {
    block: &'a Block,
    lens: &'a Lens,
    open: OpenTests,
}

impl Kernel for InView<'_> {
    type Sum = u16;

    #[inline(always)]
    fn run(self) -> u16 {
        let Self { block, lens, open } = self;
        let mut inside = [1; BLOCK];
        for (_, plane) in lens.frustum.planes.iter().enumerate().filter(|&(i, _)| open & (1 << i) != 0) {
            let n = plane.normal;
            for (lane, inside) in inside.iter_mut().enumerate() {
                let along = n.x * block.x[lane] + n.y * block.y[lane] + n.z * block.z[lane];
                *inside &= u32::from(along + plane.offset >= -block.radius[lane]);
            }
        }
        bits(&inside)
    }
}

/// The lanes whose projected diameter, at a bias of 1, is below `min_size_px`.
fn small_lanes(block: &Block, lens: &Lens, min_size_px: f32) -> u16 {
    let distances = distances(block, lens);
    bits(&std::array::from_fn(|lane| {
        u32::from(size_px(lens, block.radius[lane], distances[lane]) < min_size_px)
    }))
}

/// [`Lens::distance`] to every lane's centre.
pub(super) fn distances(block: &Block, lens: &Lens) -> [f32; BLOCK] {
    let eye = lens.eye;
    std::array::from_fn(|lane| {
        let d = Vec3::new(block.x[lane] - eye.x, block.y[lane] - eye.y, block.z[lane] - eye.z);
        if lens.perspective { length(d).max(lens.near) } else { 1.0 }
    })
}

/// Bit per lane from a 0 or 1 per lane.
#[inline(always)]
pub(super) fn bits(lanes: &[u32; BLOCK]) -> u16 {
    lanes.iter().enumerate().fold(0, |mask, (lane, &bit)| mask | bit << lane) as u16
}
