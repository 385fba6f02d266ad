//! Which operations take triangles whose third corner is some node.

/// Per node, the operations that take a triangle with that as its apex, ascending. Each is once in the list for every
/// such triangle. 4 bytes per node and per triangle that goes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Takers {
    /// Per node, where its operations begin; and where those of the last one end.
    starts: Vec<u32>,
    operations: Vec<u32>,
}

impl Takers {
    /// Of so many nodes; `firsts` has per operation the first of its triangles, and where those of the last one end.
    /// O(n).
    pub(super) fn new(nodes: usize, apexes: &[u32], firsts: &[u32]) -> Self {
        let mut starts = vec![0; nodes + 1];
        apexes.iter().for_each(|&apex| starts[apex as usize + 1] += 1);
        (0..nodes).for_each(|node| starts[node + 1] += starts[node]);
        let (mut next, mut operations) = (starts.clone(), vec![0; apexes.len()]);
        for (operation, going) in (0u32..).zip(firsts.windows(2)) {
            for &apex in &apexes[going[0] as usize..going[1] as usize] {
                let at = &mut next[apex as usize];
                operations[*at as usize] = operation;
                *at += 1;
            }
        }
        Self { starts, operations }
    }

    pub(super) fn of(&self, node: u32) -> &[u32] {
        let [start, end] = [node, node + 1].map(|at| self.starts[at as usize] as usize);
        &self.operations[start..end]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_is_at_its_apex() {
        let takers = Takers::new(4, &[2, 0, 2, 2], &[0, 1, 1, 3, 4]);
        let all = [0, 1, 2, 3].map(|node| takers.of(node));
        assert_eq!(all, [&[2][..], &[], &[0, 2, 3], &[]]);
        assert_eq!(Takers::new(1, &[], &[0]).of(0), [0; 0]);
    }
}
