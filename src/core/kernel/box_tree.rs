//! Nearest-neighbour search in the plane or in space by a tree of bounding boxes.
//!
//! It promises what a size field needs and a general index does not: the answer is a pure function of the query (ties
//! go to the lowest number, independent of earlier queries), a query allocates nothing, and strongly graded sets cost
//! no more than uniform ones.

use std::ops::{Add, Mul, Sub};

use glam::{DVec2, DVec3};

/// A point of the plane or of space: the operations that the tree needs.
pub(in crate::core) trait Spot:
    Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
    const NOWHERE: [Self; 2];
    fn least(self, other: Self) -> Self;
    fn greatest(self, other: Self) -> Self;
    fn inner(self, other: Self) -> f64;
    fn is_somewhere(self) -> bool;
    fn between(self, other: Self, share: f64) -> Self;
    /// The squared distance to a box.
    fn outside2(self, low: Self, high: Self) -> f64;
    /// The axis of the largest component, the first among equals.
    fn longest_axis(self) -> usize;
    fn along(self, axis: usize) -> f64;
    fn distance2(self, other: Self) -> f64;
}

macro_rules! spot {
    ($vector:ty) => {
        impl Spot for $vector {
            const NOWHERE: [Self; 2] = [<$vector>::INFINITY, <$vector>::NEG_INFINITY];
            #[inline]
            fn least(self, other: Self) -> Self {
                self.min(other)
            }
            #[inline]
            fn greatest(self, other: Self) -> Self {
                self.max(other)
            }
            #[inline]
            fn inner(self, other: Self) -> f64 {
                self.dot(other)
            }
            #[inline]
            fn is_somewhere(self) -> bool {
                self.is_finite()
            }
            #[inline]
            fn between(self, other: Self, share: f64) -> Self {
                self.lerp(other, share)
            }
            #[inline]
            fn outside2(self, low: Self, high: Self) -> f64 {
                (low - self).max(self - high).max(Self::ZERO).length_squared()
            }
            fn longest_axis(self) -> usize {
                let lengths = self.to_array();
                (0..lengths.len()).fold(0, |best, axis| if lengths[axis] > lengths[best] { axis } else { best })
            }
            fn along(self, axis: usize) -> f64 {
                self[axis]
            }
            #[inline]
            fn distance2(self, other: Self) -> f64 {
                self.distance_squared(other)
            }
        }
    };
}

spot!(DVec2);
spot!(DVec3);

/// The largest number of items in a leaf.
const LEAF: usize = 4;

/// A tree over items given by their bounding boxes. It renumbers them so that the items of a leaf are consecutive.
#[derive(Clone, Debug)]
pub(in crate::core) struct BoxTree<P> {
    root: Branch<P>,
    /// Both branches of an inner node side by side: choosing between them takes one memory access.
    nodes: Vec<[Branch<P>; 2]>,
}

/// A box and its contents.
#[derive(Clone, Copy, Debug)]
struct Branch<P> {
    low: P,
    high: P,
    /// In a leaf the first item, otherwise the index into `nodes`.
    at: u32,
    /// The number of items in a leaf; 0 for an inner node.
    count: u32,
}

impl<P: Spot> Branch<P> {
    #[inline]
    fn distance2(&self, p: P) -> f64 {
        p.outside2(self.low, self.high)
    }
}

impl<P: Spot> BoxTree<P> {
    /// Builds the tree over at least one box (lowest and highest corner, finite). Also returns the numbering: item `k`
    /// of the tree is the box `order[k]`. Cost O(n log n).
    pub fn new(boxes: &[(P, P)]) -> (BoxTree<P>, Vec<u32>) {
        assert!(!boxes.is_empty(), "a box tree needs at least one box");
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut nodes = Vec::new();
        let root = branch(&mut nodes, boxes, &mut order, 0);
        (BoxTree { root, nodes }, order)
    }

    /// An item close to `p`: the first one of the leaf reached by always taking the nearer branch. `None` when `p` is
    /// not finite.
    #[inline]
    pub fn descend(&self, p: P) -> Option<u32> {
        let mut branch = &self.root;
        while branch.count == 0 {
            let [left, right] = &self.nodes[branch.at as usize];
            branch = if left.distance2(p) <= right.distance2(p) { left } else { right };
        }
        p.is_somewhere().then_some(branch.at)
    }

    /// The item with the least `distance2` from `p` (squared, and at least the distance of its box), the lowest number
    /// among equals, and that squared distance. `None` when `p` is not finite.
    #[inline]
    pub fn nearest(&self, p: P, distance2: impl Fn(u32) -> f64) -> Option<(u32, f64)> {
        if !p.is_somewhere() {
            return None;
        }
        // Halving 2^32 items ends after 32 levels, and each level leaves one branch waiting.
        let mut waiting = [(0u32, 0u32, 0.0f64); 40];
        waiting[0] = (self.root.at, self.root.count, 0.0);
        let mut waiting_count = 1;
        let (mut best, mut best_distance) = (u32::MAX, f64::INFINITY);
        while waiting_count > 0 {
            waiting_count -= 1;
            let (at, count, lower_bound) = waiting[waiting_count];
            if lower_bound > best_distance {
                continue;
            }
            if count > 0 {
                for id in at..at + count {
                    let d = distance2(id);
                    if d < best_distance || (d == best_distance && id < best) {
                        (best, best_distance) = (id, d);
                    }
                }
                continue;
            }
            let [left, right] = &self.nodes[at as usize];
            let (left, right) = ((left, left.distance2(p)), (right, right.distance2(p)));
            let (near, far) = if left.1 <= right.1 { (left, right) } else { (right, left) };
            for (child, bound) in [far, near] {
                if bound <= best_distance {
                    waiting[waiting_count] = (child.at, child.count, bound);
                    waiting_count += 1;
                }
            }
        }
        (best != u32::MAX).then_some((best, best_distance))
    }
}

/// The branch over the items `order`, which are numbered from `first`.
fn branch<P: Spot>(nodes: &mut Vec<[Branch<P>; 2]>, boxes: &[(P, P)], order: &mut [u32], first: u32) -> Branch<P> {
    let whole = |(low, high): (P, P), &i: &u32| {
        let b = boxes[i as usize];
        (low.least(b.0), high.greatest(b.1))
    };
    let [nowhere, everywhere] = P::NOWHERE;
    let (low, high) = order.iter().fold((nowhere, everywhere), whole);
    if order.len() <= LEAF {
        return Branch { low, high, at: first, count: order.len() as u32 };
    }
    // The median of the doubled centres along the longest side; ids break ties, so that the tree is unique.
    let axis = (high - low).longest_axis();
    let centre = |i: u32| {
        let (low, high) = boxes[i as usize];
        low.along(axis) + high.along(axis)
    };
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |&i, &j| centre(i).total_cmp(&centre(j)).then(i.cmp(&j)));
    let here = nodes.len();
    nodes.push([Branch { low, high, at: 0, count: 0 }; 2]);
    let (left, right) = order.split_at_mut(half);
    nodes[here][0] = branch(nodes, boxes, left, first);
    nodes[here][1] = branch(nodes, boxes, right, first + half as u32);
    Branch { low, high, at: here as u32, count: 0 }
}

/// Lowest and highest corner of the bounding box of points.
pub(in crate::core) fn extent<P: Spot>(points: impl IntoIterator<Item = P>) -> (P, P) {
    let [nowhere, everywhere] = P::NOWHERE;
    points.into_iter().fold((nowhere, everywhere), |(low, high), p| (low.least(p), high.greatest(p)))
}

/// The parameter in [0, 1] of the point nearest to `p` on the segment from `a` (0) to `b` (1).
#[inline]
pub(in crate::core) fn share_along<P: Spot>(p: P, a: P, b: P) -> f64 {
    let d = b - a;
    let squared = d.inner(d);
    if squared > 0.0 { ((p - a).inner(d) / squared).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_item_is_that_of_a_linear_search_and_ties_go_to_the_lowest_id() {
        // A lattice graded by 1e6, each point twice, and queries on and between the points.
        let at = |i: usize| if i < 20 { 1e-6 * i as f64 } else { 0.05 * (i - 19) as f64 };
        let mut points = Vec::new();
        for i in 0..40 {
            for j in 0..40 {
                points.extend([DVec2::new(at(i), at(j)); 2]);
            }
        }
        let (tree, order) = BoxTree::new(&points.iter().map(|&p| (p, p)).collect::<Vec<_>>());
        let mut all = order.clone();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..points.len() as u32));
        let points: Vec<DVec2> = order.into_iter().map(|i| points[i as usize]).collect();
        for k in 0..2000 {
            let q = DVec2::new(at(k % 37), at(k / 37)) * if k % 2 == 0 { 1.0 } else { 0.97 };
            let by_hand = (0..points.len() as u32)
                .map(|i| (i, points[i as usize].distance_squared(q)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            assert_eq!(tree.nearest(q, |i| points[i as usize].distance_squared(q)), Some(by_hand));
        }
    }

    #[test]
    fn nothing_is_nearest_to_a_point_that_is_not_finite() {
        let (one, _) = BoxTree::new(&[(DVec2::ZERO, DVec2::ONE)]);
        assert_eq!(one.nearest(DVec2::NAN, |_| f64::NAN), None);
        assert_eq!(one.nearest(DVec2::new(0.0, f64::INFINITY), |_| f64::INFINITY), None);
        assert_eq!(one.nearest(DVec2::ONE, |_| 0.0), Some((0, 0.0)));
    }
}
