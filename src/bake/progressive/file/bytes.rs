//! Numbers in bytes: how they are written, and how they are read back without trust.
//!
//! A *word* is 32 bits that differ little from another word: the bits of two near floats, put in the order of the
//! numbers, differ by a small whole number. Four words have a byte that says how many bytes each takes, none, two,
//! three or four; then come those bytes.

/// Why bytes are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::bake::progressive) struct Fault {
    /// In the file.
    pub(in crate::bake::progressive) byte: usize,
    pub(in crate::bake::progressive) rule: &'static str,
}

/// Bytes of a file that are read one after the other.
#[derive(Clone, Copy, Debug)]
pub(in crate::bake::progressive) struct Bytes<'a> {
    /// From the start of the file to where they end.
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    /// Some bytes of a file.
    pub(in crate::bake::progressive) fn new(file: &'a [u8], part: std::ops::Range<usize>) -> Self {
        let end = part.end.min(file.len());
        Self { all: &file[..end], at: part.start.min(end) }
    }

    /// Where in the file the next byte is.
    pub(in crate::bake::progressive) fn at(&self) -> usize {
        self.at
    }

    /// How many are left.
    pub(in crate::bake::progressive) fn left(&self) -> usize {
        self.all.len() - self.at
    }

    /// Refuses the byte that comes next.
    pub(in crate::bake::progressive) fn fault(&self, rule: &'static str) -> Fault {
        Fault { byte: self.at, rule }
    }

    /// Refuses what breaks a rule.
    #[inline]
    pub(in crate::bake::progressive) fn must(&self, holds: bool, rule: &'static str) -> Result<(), Fault> {
        if holds { Ok(()) } else { Err(self.fault(rule)) }
    }

    pub(in crate::bake::progressive) fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        self.must(count <= self.left(), "it must not end here")?;
        let taken = &self.all[self.at..][..count];
        self.at += count;
        Ok(taken)
    }

    #[inline]
    pub(in crate::bake::progressive) fn byte(&mut self) -> Result<u8, Fault> {
        let byte = self.all.get(self.at).copied().ok_or(self.fault("it must not end here"))?;
        self.at += 1;
        Ok(byte)
    }

    /// A whole number in groups of seven bits, the lowest first.
    #[inline]
    pub(in crate::bake::progressive) fn number(&mut self) -> Result<u32, Fault> {
        let mut number = 0;
        for shift in (0..35).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return u32::try_from(number).map_err(|_| self.fault("a number must fit 32 bits"));
            }
        }
        Err(self.fault("a number must fit 32 bits"))
    }

    /// A number below a bound.
    #[inline]
    pub(in crate::bake::progressive) fn below(
        &mut self,
        bound: usize,
        rule: &'static str,
    ) -> Result<u32, Fault> {
        let fault = self.fault(rule);
        let number = self.number()?;
        if (number as usize) < bound { Ok(number) } else { Err(fault) }
    }

    /// How many things follow, each of which takes a byte at least.
    pub(in crate::bake::progressive) fn count(&mut self) -> Result<usize, Fault> {
        let fault = self.fault("a count must not exceed the bytes that follow");
        let count = self.number()? as usize;
        if count <= self.left() { Ok(count) } else { Err(fault) }
    }

    /// Eight bytes, the lowest first.
    pub(in crate::bake::progressive) fn long(&mut self) -> Result<u64, Fault> {
        let bytes = self.take(8)?;
        Ok(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }

    /// Four bytes, the lowest first.
    pub(in crate::bake::progressive) fn short(&mut self) -> Result<u32, Fault> {
        let bytes = self.take(4)?;
        Ok(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte)))
    }

    /// By how much so many words differ from those that were expected, as [`differ`] has it.
    #[inline]
    pub(in crate::bake::progressive) fn differences(
        &mut self,
        count: usize,
        differences: &mut Vec<u32>,
    ) -> Result<(), Fault> {
        differences.clear();
        let tags = self.take(count.div_ceil(4))?;
        for word in 0..count {
            let tag = usize::from(tags[word / 4] >> (2 * (word % 4)) & 3);
            let bytes = [0, 2, 3, 4][tag];
            let number = match self.all.get(self.at..self.at + 4) {
                Some(next) => u32::from_le_bytes([next[0], next[1], next[2], next[3]]) & MASKS[tag],
                None => {
                    let next = self.take(bytes)?;
                    self.at -= bytes;
                    next.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
                }
            };
            self.at += bytes;
            differences.push(number);
        }
        Ok(())
    }
}

/// By the tag, the bits that are a word's.
const MASKS: [u32; 4] = [0, 0xffff, 0xff_ffff, u32::MAX];

/// The bits of a float as a whole number, ordered as the floats are.
#[inline]
fn ordered(bits: u32) -> u32 {
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

#[inline]
fn unordered(number: u32) -> u32 {
    if number >> 31 == 1 { number & !(1 << 31) } else { !number }
}

/// A whole number whose sign is its lowest bit.
#[inline]
pub(in crate::bake::progressive) fn folded(number: i32) -> u32 {
    (number << 1 ^ number >> 31) as u32
}

#[inline]
pub(in crate::bake::progressive) fn unfolded(number: u32) -> i32 {
    (number >> 1) as i32 ^ -((number & 1) as i32)
}

/// How a word differs from the one that was expected: little if both are near floats.
#[inline]
fn differ(expected: u32, word: u32) -> u32 {
    folded(ordered(word).wrapping_sub(ordered(expected)) as i32)
}

/// The word that differs so from the expected one.
#[inline]
pub(in crate::bake::progressive) fn restored(expected: u32, difference: u32) -> u32 {
    unordered(ordered(expected).wrapping_add(unfolded(difference) as u32))
}

/// Appends a whole number in groups of seven bits.
pub(in crate::bake::progressive) fn put_number(mut number: u32, out: &mut Vec<u8>) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

/// Words to be written together, each beside the one that the reader will expect.
#[derive(Clone, Debug, Default)]
pub(in crate::bake::progressive) struct Words {
    differences: Vec<u32>,
}

impl Words {
    pub(in crate::bake::progressive) fn add(&mut self, expected: &[u32], words: &[u32]) {
        self.differences.extend(expected.iter().zip(words).map(|(&e, &w)| differ(e, w)));
    }

    /// Appends all, and begins anew.
    pub(in crate::bake::progressive) fn put(&mut self, out: &mut Vec<u8>) {
        let tag = |&difference: &u32| MASKS.iter().position(|mask| difference & !mask == 0).unwrap_or(3);
        for four in self.differences.chunks(4) {
            let tags = four.iter().rev().fold(0, |tags, difference| tags << 2 | tag(difference) as u8);
            out.push(tags);
        }
        for difference in &self.differences {
            let bytes = [0, 2, 3, 4][tag(difference)];
            out.extend_from_slice(&difference.to_le_bytes()[..bytes]);
        }
        self.differences.clear();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn words_and_numbers_come_back(
            words in prop::collection::vec((any::<u32>(), any::<u32>(), 0..32u32), 0..40),
            numbers in prop::collection::vec((any::<u32>(), 0..32u32), 0..40),
        ) {
            // As far apart as it takes for each length to occur.
            let words: Vec<(u32, u32)> = words.iter().map(|&(e, w, s)| (e, e.wrapping_add(w >> s))).collect();
            let numbers: Vec<u32> = numbers.iter().map(|&(n, s)| n >> s).collect();
            let mut out = vec![9];
            numbers.iter().for_each(|&n| put_number(n, &mut out));
            let mut all = Words::default();
            words.iter().for_each(|&(e, w)| all.add(&[e], &[w]));
            all.put(&mut out);
            let mut bytes = Bytes::new(&out, 1..out.len());
            for &number in &numbers {
                prop_assert_eq!(bytes.number(), Ok(number));
            }
            let mut differences = Vec::new();
            prop_assert_eq!(bytes.differences(words.len(), &mut differences), Ok(()));
            for (&(expected, word), &difference) in words.iter().zip(&differences) {
                prop_assert_eq!(restored(expected, difference), word);
            }
            prop_assert_eq!(bytes.left(), 0);
        }

        #[test]
        fn near_floats_differ_little(x in -1.0e3f32..1.0e3) {
            prop_assert!(differ(x.to_bits(), x.next_up().to_bits()) <= 2);
            prop_assert_eq!(differ(x.to_bits(), x.to_bits()), 0);
        }
    }
}
