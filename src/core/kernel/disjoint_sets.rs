//! Disjoint sets (union-find) with path halving; the lowest number represents its set.

/// Disjoint sets of the numbers from 0 to n - 1.
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// Each number in a set of its own.
    pub fn new(n: usize) -> Self {
        DisjointSets((0..n as u32).collect())
    }

    /// The lowest number of the set of `x`.
    pub fn find(&mut self, mut x: u32) -> u32 {
        while self.0[x as usize] != x {
            self.0[x as usize] = self.0[self.0[x as usize] as usize];
            x = self.0[x as usize];
        }
        x
    }

    /// Unites the sets of `a` and `b`.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
