//! Keeping the order of objects that move, come and go, a few thousand objects at a time.
//!
//! The order is kept by *windows* of 64 blocks. Within a window it matters which objects share a block, and it matters
//! which objects share a window; in what order the windows come hardly does, since there are so few of them. A window
//! whose blocks have come to reach too far is laid out anew, and its strays, whose neighbours are in another window, go
//! to holes there. What one repair leaves out of order the next ones find. The like of it is the reinsertion of
//! N. Beckmann et al. ("The R*-tree", 1990), here without splits: slots that are too few are made at the end.

use std::ops::Range;

use glam::Vec3;

use super::morton::Curve;
use super::node::{Node, is_tame};
use super::order::Arranger;
use super::tree::{BlockTree, FAN_OUT};
use super::value::worth;
use crate::bounds::{Aabb, Sphere};
use crate::scene::{BLOCK, Objects};

/// The level of the tree whose nodes are windows. 1 to 3: larger windows bring more strays home, and take longer.
const WINDOW: usize = 2;

/// Objects that an update may lay anew whatever it had to do else, give or take a window: under a millisecond of work.
/// From 1 up; larger keeps better order, smaller takes less time.
const WORK: usize = 1024;

/// Blocks that were refitted for each object that may be laid anew beyond [`WORK`]: as much as a quarter of the time.
const REFITTED_PER_OBJECT: usize = 32;

/// Growth of a window's area, summed over its blocks, at which it is laid out anew. Above 1; smaller keeps boxes tight
/// while objects move, larger works less often.
const GROWTH: f32 = 2.0;

/// A block has strays when its area is so many times the median of its window's blocks. Above 1; smaller moves
/// objects that are at home, larger leaves more astray.
const ASTRAY: f32 = 16.0;

/// What repairs keep for the next time.
#[derive(Clone, Default)]
pub(super) struct Repairs {
    /// Per window, the summed area of its blocks when it was last laid out.
    home: Vec<f32>,
    /// Windows to be laid out, the worst first: by how much they have grown.
    worst: Vec<(f32, u32)>,
    /// Whether some had to wait.
    pub is_pending: bool,
    /// Along a curve, whatever orders the whole: it allocates nothing once warm.
    arranger: Arranger<Curve>,
    from: Vec<u32>,
    to: Vec<u32>,
    areas: Vec<f32>,
}

impl BlockTree {
    /// Lays the windows that have suffered most out anew; `refitted` blocks were renewed in this update. Returns how
    /// many objects it moved. The tree has to be refitted and [settled](BlockTree::settle_repairs) afterwards.
    pub(super) fn repair(&mut self, objects: &mut Objects, refitted: usize) -> usize {
        let mut repairs = std::mem::take(&mut self.repairs);
        repairs.rank(self);
        let budget = WORK + refitted / REFITTED_PER_OBJECT;
        let (mut moved, mut done) = (0, 0);
        while done < repairs.worst.len() && moved < budget {
            moved += repairs.lay_out(self, objects, repairs.worst[done].1 as usize);
            done += 1;
        }
        repairs.is_pending = done < repairs.worst.len();
        repairs.worst.truncate(done);
        self.repairs = repairs;
        moved
    }

    /// Notes the areas of the windows that were laid out last.
    pub(super) fn settle_repairs(&mut self) {
        let mut repairs = std::mem::take(&mut self.repairs);
        let windows = &self.level(self.window_level()).limits;
        repairs.home.resize(windows.len(), 0.0);
        for &(_, window) in &repairs.worst {
            if let Some(limits) = windows.get(window as usize) {
                repairs.home[window as usize] = limits.area;
            }
        }
        self.repairs = repairs;
    }

    /// Notes the areas of all windows, after an order.
    pub(super) fn settle_all(&mut self) {
        let mut repairs = std::mem::take(&mut self.repairs);
        repairs.home.clear();
        repairs.home.extend(self.level(self.window_level()).limits.iter().map(|limits| limits.area));
        repairs.is_pending = false;
        self.repairs = repairs;
    }

    fn window_level(&self) -> usize {
        WINDOW.min(self.height())
    }
}

impl Repairs {
    /// Finds the windows that have grown, the worst first, ties by index.
    fn rank(&mut self, tree: &BlockTree) {
        self.worst.clear();
        let windows = tree.level(tree.window_level()).limits.iter().zip(0..);
        let grown = windows.filter_map(|(limits, window)| {
            let home = self.home.get(window as usize).copied().unwrap_or(0.0);
            (limits.area > GROWTH * home).then(|| (limits.area / home, window))
        });
        self.worst.extend(grown);
        self.worst.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    }

    /// Lays a window out anew and sends its strays home; returns how many objects were moved.
    fn lay_out(&mut self, tree: &BlockTree, objects: &mut Objects, window: usize) -> usize {
        let width = FAN_OUT.pow(tree.window_level() as u32) * BLOCK;
        let first = window * width;
        let slots = first..(first + width).min(objects.blocks().len() * BLOCK);
        self.from.clear();
        self.from.extend_from_slice(self.arranger.arrange(objects, slots, tree.kept_slopes()));
        let moved = self.from.len();
        self.send_strays(tree, objects, window);
        self.to.clear();
        self.to.extend((first as u32..).take(self.from.len()));
        objects.relocate(&self.from, &self.to);
        moved
    }

    /// Moves the strays among the objects of a window, which `from` lists in order, to holes near where they are.
    fn send_strays(&mut self, tree: &BlockTree, objects: &mut Objects, window: usize) {
        let usual = self.usual_area(objects);
        for chunk in self.from.chunks_mut(BLOCK) {
            let mut spheres = [Sphere::default(); BLOCK];
            for (sphere, &slot) in spheres.iter_mut().zip(chunk.iter()) {
                *sphere = sphere_in(objects, slot);
            }
            let spheres = &spheres[..chunk.len()];
            if area(spheres) <= ASTRAY * usual {
                continue;
            }
            let (middle, reach) = (median(spheres), usual.sqrt());
            for (slot, sphere) in chunk.iter_mut().zip(spheres) {
                let is_astray = (sphere.center - middle).abs().max_element() > reach;
                let home = is_astray.then(|| find_home(tree, objects, *slot, window)).flatten();
                if let Some(home) = home {
                    objects.relocate(&[*slot], &[home]);
                    *slot = GONE;
                }
            }
        }
        self.from.retain(|&slot| slot != GONE);
    }

    /// Median area of sixteen objects at a time.
    fn usual_area(&mut self, objects: &Objects) -> f32 {
        self.areas.clear();
        self.areas.extend(self.from.chunks(BLOCK).map(|chunk| {
            let spheres = chunk.iter().map(|&slot| sphere_in(objects, slot));
            spheres.fold(Aabb::EMPTY, |around, sphere| around.union(sphere.aabb())).half_area()
        }));
        self.areas.sort_unstable_by(f32::total_cmp);
        self.areas.get(self.areas.len() / 2).copied().unwrap_or(0.0)
    }
}

/// Marks an object that has left its window.
const GONE: u32 = u32::MAX;

fn sphere_in(objects: &Objects, slot: u32) -> Sphere {
    objects.blocks()[slot as usize / BLOCK].sphere(slot as usize % BLOCK)
}

/// Half-area of the box around spheres.
fn area(spheres: &[Sphere]) -> f32 {
    spheres.iter().fold(Aabb::EMPTY, |around, sphere| around.union(sphere.aabb())).half_area()
}

/// The median of up to sixteen centres, axis by axis.
fn median(spheres: &[Sphere]) -> Vec3 {
    let along = |axis: usize| {
        let mut places = [f32::INFINITY; BLOCK];
        for (place, sphere) in places.iter_mut().zip(spheres) {
            *place = sphere.center[axis];
        }
        places.sort_unstable_by(f32::total_cmp);
        places[spheres.len() / 2]
    };
    Vec3::new(along(0), along(1), along(2))
}

/// A hole for the object in a slot of window `from`, in the smallest other window around it that has one and whose
/// objects are of its kind; none where that is no smaller than its own.
fn find_home(tree: &BlockTree, objects: &Objects, slot: u32, from: usize) -> Option<u32> {
    let (index, lane) = (slot as usize / BLOCK, slot as usize % BLOCK);
    let (block, sphere) = (&objects.blocks()[index], sphere_in(objects, slot));
    if block.live & (1 << lane) == 0 || !is_tame(&sphere) {
        return None;
    }
    let worth = match block.skippable & (1 << lane) {
        0 => f64::INFINITY,
        _ => worth(objects, index, lane, Some(tree.kept_slopes().of(block.table[lane]))),
    };
    let own = tree.level(tree.window_level()).node(from).aabb.half_area();
    let mut search = Search { tree, objects, center: sphere.center, worth, from, best: (own, None) };
    search.visit(tree.height(), 0);
    search.best.1.and_then(|window| hole_in(tree, objects, window, &sphere))
}

/// A search for the smallest window around a point.
struct Search<'a> {
    tree: &'a BlockTree,
    objects: &'a Objects,
    center: Vec3,
    worth: f64,
    from: usize,
    best: (f32, Option<usize>),
}

impl Search<'_> {
    fn visit(&mut self, level: usize, group: usize) {
        let nodes = group * FAN_OUT..group * FAN_OUT + self.tree.siblings(level, group);
        for index in nodes {
            let node = self.tree.level(level).node(index);
            let around = node.aabb.min.cmple(self.center).all() && self.center.cmple(node.aabb.max).all();
            if around && level > self.tree.window_level() {
                self.visit(level - 1, index);
            } else if around && self.is_better(index, &node) {
                self.best = (node.aabb.half_area(), Some(index));
            }
        }
    }

    /// Whether a window is the best so far: smaller, with a hole, and with objects whose worth is of a kind.
    fn is_better(&self, window: usize, node: &Node) -> bool {
        let most = node.limits.worth[1];
        let is_alike = self.worth <= most * 8.0 && (most < f64::INFINITY || self.worth == f64::INFINITY);
        let mut occupied = self.objects.occupied()[blocks_of(self.tree, self.objects, window)].iter();
        window != self.from
            && is_alike
            && node.aabb.half_area() < self.best.0
            && occupied.any(|&lanes| lanes != u16::MAX)
    }
}

/// The blocks of a window that are still there and that the tree knows.
fn blocks_of(tree: &BlockTree, objects: &Objects, window: usize) -> Range<usize> {
    let (width, len) =
        (FAN_OUT.pow(tree.window_level() as u32), tree.live().len().min(objects.occupied().len()));
    (window * width).min(len)..((window + 1) * width).min(len)
}

/// The first hole of the block in a window that grows least when it takes a sphere in.
fn hole_in(tree: &BlockTree, objects: &Objects, window: usize, sphere: &Sphere) -> Option<u32> {
    let growth = |block: usize| {
        let aabb = tree.level(0).node(block).aabb;
        aabb.union(sphere.aabb()).half_area() - aabb.half_area()
    };
    let loose = blocks_of(tree, objects, window).filter(|&block| objects.occupied()[block] != u16::MAX);
    let block = loose.min_by(|&a, &b| growth(a).total_cmp(&growth(b)))?;
    Some((block * BLOCK) as u32 + objects.occupied()[block].trailing_ones())
}
