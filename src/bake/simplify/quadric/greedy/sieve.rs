//! Lists of some items out of many.

/// Those of some items that pass, listed without branches: nobody can predict which do.
#[derive(Default)]
pub(super) struct Sieve<T> {
    /// Room for more items than there are.
    room: Vec<T>,
    len: usize,
}

impl<T: Copy + Default> Sieve<T> {
    /// Empties the list, and makes room for so many items, whether they pass or not.
    #[inline]
    pub(super) fn clear(&mut self, room: usize) {
        self.len = 0;
        if self.room.len() < room {
            self.room.resize(room, T::default());
        }
    }

    /// Adds an item, or only makes as if.
    #[inline]
    pub(super) fn add_if(&mut self, passes: bool, item: T) {
        self.room[self.len] = item;
        self.len += usize::from(passes);
    }

    /// Adds an item up to a multiple of so many, for which there must be room.
    #[inline]
    pub(super) fn fill_up(&mut self, multiple: usize, item: T) {
        self.room[self.len..][..multiple].fill(item);
        self.len = self.len.next_multiple_of(multiple);
    }

    pub(super) fn list(&self) -> &[T] {
        &self.room[..self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_is_listed_in_order() {
        let mut sieve = Sieve::<i32>::default();
        sieve.clear(9);
        (0..7).for_each(|i| sieve.add_if(i % 2 == 0, i));
        assert_eq!(sieve.list(), [0, 2, 4, 6]);
        sieve.fill_up(4, -1);
        assert_eq!(sieve.list(), [0, 2, 4, 6]);
        sieve.fill_up(3, -1);
        assert_eq!(sieve.list(), [0, 2, 4, 6, -1, -1]);
        sieve.clear(1);
        sieve.add_if(false, 8);
        assert!(sieve.list().is_empty());
    }
}
