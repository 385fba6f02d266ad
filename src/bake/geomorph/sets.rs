//! Things that hang together.

/// Sets of numbered things, each known by its lowest member.
pub(super) struct Sets {
    above: Vec<u32>,
}

impl Sets {
    /// Each thing by itself.
    pub(super) fn new(count: usize) -> Self {
        Self { above: (0..count as u32).collect() }
    }

    /// The lowest member of a set; halves the way there for whoever asks next.
    pub(super) fn root(&mut self, mut thing: u32) -> u32 {
        while self.above[thing as usize] != thing {
            self.above[thing as usize] = self.above[self.above[thing as usize] as usize];
            thing = self.above[thing as usize];
        }
        thing
    }

    /// Makes one set of those of two things.
    pub(super) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.above[a.max(b) as usize] = a.min(b);
    }
}
