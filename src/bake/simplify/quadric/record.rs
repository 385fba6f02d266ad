//! All contractions, in order.

use glam::Vec3;

use super::{Seen, Witness};

/// One contraction of two vertices, named as in the mesh of the task: what vertex hierarchies are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contraction {
    /// The vertex that both become, which goes to `position`.
    pub kept: u32,
    /// The vertex that goes.
    pub gone: u32,
    /// Where they go.
    pub position: Vec3,
    /// The largest error so far as the method estimates it, in object units. No bound of the deviation.
    pub error: f32,
}

/// A witness that writes contractions down.
#[derive(Default)]
pub(super) struct Record {
    pub(super) contractions: Vec<Contraction>,
}

impl Witness for Record {
    fn begin(&mut self, seen: &Seen) {
        self.contractions.reserve(seen.vertices().len());
    }

    fn before(&mut self, _: &Seen, _: u32, _: u32) {}

    fn after(&mut self, seen: &Seen, kept: u32, gone: u32) {
        let [old_kept, old_gone] = [kept, gone].map(|vertex| seen.vertices()[vertex as usize]);
        let (position, error) = (seen.position(kept), seen.error());
        self.contractions.push(Contraction { kept: old_kept, gone: old_gone, position, error });
    }
}
