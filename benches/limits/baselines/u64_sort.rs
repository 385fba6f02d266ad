//! Slope and step packed in 64 bits, sorted by the standard library.

use super::Selection;
use super::classes::Classes;

#[derive(Default)]
pub struct U64Sort {
    keys: Vec<u64>,
}

impl Selection for U64Sort {
    fn choose(&mut self, classes: &Classes<'_>, budget: u64, position: &mut [u8]) {
        let keys = classes.keys(&mut self.keys);
        keys.sort_unstable();
        classes.take(keys, budget, position);
    }
}
