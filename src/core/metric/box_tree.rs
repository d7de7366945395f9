//! Nearest of many small things in the plane, by a tree of their boxes.
//!
//! What a field needs and a general index does not promise: the answer is a pure function of the query (equal distances go
//! to the lowest id, whatever was asked before), nothing is allocated, and strongly graded sets cost no more than even ones.

use glam::DVec2;

/// Things in one leaf at most.
const LEAF: usize = 4;

/// A tree over things `0..n` that are known by their boxes.
#[derive(Clone, Debug)]
pub(super) struct BoxTree {
    nodes: Vec<Node>,
    /// Ids of the things, those of one leaf together.
    ids: Vec<u32>,
}

/// A node in preorder: the left child of an inner node is the next one.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: DVec2,
    high: DVec2,
    /// A leaf's first place in `ids`; an inner node's right child.
    at: u32,
    /// Things of a leaf; 0: an inner node.
    count: u32,
}

impl Node {
    #[inline]
    fn distance2(&self, p: DVec2) -> f64 {
        (self.low - p).max(p - self.high).max(DVec2::ZERO).length_squared()
    }
}

impl BoxTree {
    /// Builds the tree over boxes (lowest and highest corner, finite). Cost O(n log n).
    pub fn new(boxes: &[(DVec2, DVec2)]) -> BoxTree {
        let mut tree = BoxTree { nodes: Vec::new(), ids: (0..boxes.len() as u32).collect() };
        let mut ids = std::mem::take(&mut tree.ids);
        if !ids.is_empty() {
            tree.split(boxes, &mut ids, 0);
        }
        tree.ids = ids;
        tree
    }

    fn split(&mut self, boxes: &[(DVec2, DVec2)], ids: &mut [u32], offset: u32) {
        let whole = |(low, high): (DVec2, DVec2), &i: &u32| {
            let b = boxes[i as usize];
            (low.min(b.0), high.max(b.1))
        };
        let (low, high) = ids.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), whole);
        let here = self.nodes.len();
        let count = if ids.len() <= LEAF { ids.len() as u32 } else { 0 };
        self.nodes.push(Node { low, high, at: offset, count });
        if count > 0 {
            return;
        }
        // The median of the doubled centres along the longer side; ids break ties, so that the tree is one only.
        let along_x = high.x - low.x >= high.y - low.y;
        let centre = |i: u32| {
            let (low, high) = boxes[i as usize];
            if along_x { low.x + high.x } else { low.y + high.y }
        };
        let half = ids.len() / 2;
        ids.select_nth_unstable_by(half, |&i, &j| centre(i).total_cmp(&centre(j)).then(i.cmp(&j)));
        let (left, right) = ids.split_at_mut(half);
        self.split(boxes, left, offset);
        self.nodes[here].at = self.nodes.len() as u32;
        self.split(boxes, right, offset + half as u32);
    }

    /// The thing with the least `distance2` from `p` (squared; its box must not be farther), the lowest id among equals, and
    /// that squared distance. `None` when there are no things or `p` is not finite.
    #[inline]
    pub fn nearest(&self, p: DVec2, distance2: impl Fn(u32) -> f64) -> Option<(u32, f64)> {
        if !p.is_finite() {
            return None;
        }
        // Halving 2^32 things ends after 32 levels, and each leaves one node waiting.
        let mut waiting = [(0u32, 0.0f64); 40];
        let mut count = usize::from(!self.nodes.is_empty());
        let (mut best, mut best_distance) = (u32::MAX, f64::INFINITY);
        while count > 0 {
            count -= 1;
            let (i, lower_bound) = waiting[count];
            if lower_bound > best_distance {
                continue;
            }
            let node = &self.nodes[i as usize];
            if node.count > 0 {
                for &id in &self.ids[node.at as usize..(node.at + node.count) as usize] {
                    let d = distance2(id);
                    if d < best_distance || (d == best_distance && id < best) {
                        (best, best_distance) = (id, d);
                    }
                }
                continue;
            }
            let left = (i + 1, self.nodes[i as usize + 1].distance2(p));
            let right = (node.at, self.nodes[node.at as usize].distance2(p));
            let (near, far) = if left.1 <= right.1 { (left, right) } else { (right, left) };
            for child in [far, near] {
                if child.1 <= best_distance {
                    waiting[count] = child;
                    count += 1;
                }
            }
        }
        (best != u32::MAX).then_some((best, best_distance))
    }
}

/// The share of the way from `a` to `b`, in [0, 1], of the point of that segment that is nearest to `p`.
#[inline]
pub(super) fn share_along(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let d = b - a;
    let squared = d.length_squared();
    if squared > 0.0 { ((p - a).dot(d) / squared).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_is_that_of_a_search_through_all_and_ties_go_to_the_lowest_id() {
        // A lattice graded by 1e6, each point twice, and queries on and between the points.
        let at = |i: usize| if i < 20 { 1e-6 * i as f64 } else { 0.05 * (i - 19) as f64 };
        let mut points = Vec::new();
        for i in 0..40 {
            for j in 0..40 {
                points.extend([DVec2::new(at(i), at(j)); 2]);
            }
        }
        let tree = BoxTree::new(&points.iter().map(|&p| (p, p)).collect::<Vec<_>>());
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
    fn nothing_is_nearest_among_nothing_or_to_no_place() {
        assert_eq!(BoxTree::new(&[]).nearest(DVec2::ZERO, |_| 0.0), None);
        let one = BoxTree::new(&[(DVec2::ZERO, DVec2::ONE)]);
        assert_eq!(one.nearest(DVec2::NAN, |_| f64::NAN), None);
        assert_eq!(one.nearest(DVec2::new(0.0, f64::INFINITY), |_| f64::INFINITY), None);
    }
}
