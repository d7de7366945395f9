//! Failure injection: operations refused at random although they are possible. Whatever is refused, the result must be
//! right; tests say so (docs/algorithm.md, "Failure injection").
//!
//! Whether an operation is refused is a pure function of the seed, the operation and its location: a repeated check
//! gives the same answer, a step that is undone and redone meets the same refusals, and no state is needed. A node that
//! moves by one bit is a different location.
//!
//! The templates of the last resort are never refused: the guarantee rests on them.

/// The reason why an operation cannot be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The edge lies on a boundary.
    OnBoundary,
    /// The node is fixed.
    FixedNode,
    /// An element has the wrong shape for the operation.
    NotTriangles,
    /// An element would be inverted, flat, or not convex.
    NotPositive,
    /// The ends have a common neighbour besides the two opposite nodes, or a common element: merging them would join
    /// separate parts.
    Link,
    /// The nodes of the new edge are already connected.
    Joined,
    /// A node has the wrong number of edges or elements.
    Valence,
    /// The operation is possible, but a test makes it fail; see [`Refusals`].
    Injected,
}

impl Refusal {
    /// Refuses for this reason when the condition holds.
    #[inline]
    pub(super) fn when(self, condition: bool) -> Result<(), Refusal> {
        if condition { Err(self) } else { Ok(()) }
    }
}

/// The operations that can be refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Operation {
    /// Swapping an edge.
    Swap,
    /// Collapsing an edge, also as a seam or a split of the front.
    Collapse,
    /// Dividing an edge.
    Divide,
    /// Deleting a node.
    DeleteNode,
    /// Moving a node.
    Move,
    /// Collapsing a diamond.
    CollapseDiamond,
    /// Rotating an edge between two quadrilaterals.
    RotateEdge,
    /// Opening a vertex.
    OpenVertex,
    /// Removing a doublet.
    RemoveDoublet,
    /// Filling a cavity anew.
    Refill,
    /// Pillowing a quadrilateral.
    Pillow,
    /// Forming a quadrilateral.
    Form,
    /// Covering a small loop.
    Close,
    /// Merging two triangles, in the last resort.
    Merge,
    /// Matching two triangles that cannot be merged, in the last resort.
    Match,
    /// Re-cutting pairs of triangles, in the last resort.
    Recut,
}

/// Which operations a mesh refuses, at random but reproducibly; see
/// [`Mesh::set_refusals`](super::half_edge::Mesh::set_refusals).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusals {
    seed: u64,
    share: f64,
}

impl Refusals {
    /// Refuses a fraction (from 0 to 1) of all operations.
    pub fn new(seed: u64, share: f64) -> Self {
        Refusals { seed, share }
    }

    /// Whether the operation is refused at a location, which the words identify.
    pub(super) fn refuses(&self, operation: Operation, place: impl IntoIterator<Item = u64>) -> bool {
        // The mixing function of splitmix64, word by word.
        let mix = |hash: u64, word: u64| {
            let mut z = (hash ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15);
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        };
        let hash = place.into_iter().fold(mix(self.seed, operation as u64), mix);
        ((hash >> 11) as f64) < self.share * (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_refused_fraction_is_the_requested_one() {
        for share in [0.0, 0.05, 0.8, 1.0] {
            let refusals = Refusals::new(7, share);
            let refused = (0..10_000).filter(|&n| refusals.refuses(Operation::Swap, [n, n + 1])).count();
            assert!((refused as f64 / 1e4 - share).abs() < 0.02, "{refused} of 10,000, not {share}");
        }
    }
}
