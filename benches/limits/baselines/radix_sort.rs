//! The packed steps, sorted by the bits of their slopes from the lowest digit up. The steps come in the order that
//! breaks ties, and the sort is stable, so that the slope alone has to be looked at.

use super::Selection;
use super::classes::Classes;

/// Bits per digit: more take fewer passes over the 32 bits of a slope, but write to more pages at a time than the
/// translation buffer holds: eleven bits took half as long again.
const DIGIT_BITS: u32 = 8;
const DIGITS: usize = 1 << DIGIT_BITS;
const PASSES: usize = 4;
/// The slope is in the upper half of a key.
const LOWEST_BIT: u32 = 32;

#[derive(Default)]
pub struct RadixSort {
    keys: Vec<u64>,
    spare: Vec<u64>,
}

impl Selection for RadixSort {
    fn choose(&mut self, classes: &Classes<'_>, budget: u64, position: &mut [u8]) {
        let keys = classes.keys(&mut self.keys);
        self.spare.resize(keys.len().max(self.spare.len()), 0);
        let (mut from, mut to) = (keys, &mut self.spare[..]);
        let mut counts = count(from);
        for (pass, counts) in counts.iter_mut().enumerate() {
            to = &mut to[..from.len()];
            scatter(from, to, pass, counts);
            std::mem::swap(&mut from, &mut to);
        }
        classes.take(from, budget, position);
    }
}

#[inline]
fn digit(key: u64, pass: usize) -> usize {
    (key >> (LOWEST_BIT + DIGIT_BITS * pass as u32)) as usize & (DIGITS - 1)
}

/// How many keys have which digit, for all passes at once.
fn count(keys: &[u64]) -> [[u32; DIGITS]; PASSES] {
    let mut counts = [[0; DIGITS]; PASSES];
    for &key in keys {
        for (pass, counts) in counts.iter_mut().enumerate() {
            counts[digit(key, pass)] += 1;
        }
    }
    counts
}

fn scatter(from: &[u64], to: &mut [u64], pass: usize, counts: &mut [u32; DIGITS]) {
    let mut start = 0;
    for count in counts.iter_mut() {
        (*count, start) = (start, start + *count);
    }
    for &key in from {
        let place = &mut counts[digit(key, pass)];
        to[*place as usize] = key;
        *place += 1;
    }
}
