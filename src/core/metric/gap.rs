//! Narrow gaps: across them no size exceeds their width over the number of layers.

use glam::DVec3;

use crate::core::kernel::Metric3;
use crate::core::kernel::box_tree::{BoxTree, Spot, share_along};

/// Straight lines across a gap, in the order in which they follow one another along it: their ends on both sides.
pub type Rungs = Vec<[DVec3; 2]>;

/// A bound on the sizes across gaps: the width between the rungs over the number of layers, growing with the distance
/// from the gap.
#[derive(Clone, Debug)]
pub(super) struct Gap {
    tree: BoxTree<DVec3>,
    /// Two rungs that follow one another, in the order of the tree.
    cells: Vec<[[DVec3; 2]; 2]>,
    layers: f64,
    /// Derivative of the size by the distance.
    slope: f64,
    size_scale: f64,
}

impl Gap {
    /// Sizes that grow by `ln(gradation)` times the distance from the gaps. All are divided by `size_scale`, by which
    /// fields are multiplied. `None` without two rungs.
    pub fn new(gaps: &[Rungs], layers: u32, gradation: f64, size_scale: f64) -> Option<Gap> {
        let cells: Vec<_> = gaps.iter().flat_map(|rungs| rungs.windows(2).map(|w| [w[0], w[1]])).collect();
        if cells.is_empty() {
            return None;
        }
        let around = |cell: &[[DVec3; 2]; 2]| {
            let [a, b] = axis(cell);
            (a.min(b), a.max(b))
        };
        let (tree, order) = BoxTree::new(&cells.iter().map(around).collect::<Vec<_>>());
        let cells = order.into_iter().map(|i| cells[i as usize]).collect();
        Some(Gap { tree, cells, layers: f64::from(layers), slope: libm::log(gradation), size_scale })
    }

    /// A unit vector across the nearest gap and the largest size in that direction; `None` when the point is not
    /// finite.
    #[inline]
    fn across(&self, p: DVec3) -> Option<(DVec3, f64)> {
        let foot = |id: u32| {
            let [a, b] = axis(&self.cells[id as usize]);
            let share = share_along(p, a, b);
            (a.between(b, share), share)
        };
        let (id, squared) = self.tree.nearest(p, |id| foot(id).0.distance2(p))?;
        let (_, share) = foot(id);
        let [one, other] = self.cells[id as usize].map(|[a, b]| b - a);
        let rung = one.between(other, share);
        let width = rung.length();
        let outside = (squared.sqrt() - 0.5 * width).max(0.0);
        Some((rung / width, (width / self.layers + self.slope * outside) / self.size_scale))
    }

    /// The metric of other fields with sizes across the gaps cut back; `None` when the point is not finite.
    #[inline]
    pub fn limit(&self, others: Option<Metric3>, p: DVec3) -> Option<Metric3> {
        let (n, h) = self.across(p)?;
        Some(match others {
            Some(others) if n.is_finite() => others.intersect_slab(n, h),
            Some(others) => others,
            None => Metric3::isotropic(h),
        })
    }
}

/// The line between the middles of two rungs.
fn axis(cell: &[[DVec3; 2]; 2]) -> [DVec3; 2] {
    cell.map(|[a, b]| a.midpoint(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_across_a_wedge_are_its_width_and_grow_outside() {
        // Between y = 0 and y = 0.1 + 0.1 x, for x from 0 to 2.
        let rung = |x: f64| [DVec3::new(x, 0.0, 0.0), DVec3::new(x, 0.1 + 0.1 * x, 0.0)];
        let gap = Gap::new(&[(0..=4).map(|k| rung(0.5 * f64::from(k))).collect()], 1, 1.3, 1.0).unwrap();
        let sizes = |x: f64, y: f64| {
            let m = gap.limit(Some(Metric3::isotropic(1.0)), DVec3::new(x, y, 0.0)).unwrap();
            [DVec3::X, DVec3::Y].map(|d| 1.0 / m.norm2(d).sqrt())
        };
        for x in [0.0, 0.3, 0.77, 1.5, 2.0] {
            let [along, across] = sizes(x, 0.05 + 0.05 * x);
            assert!((along - 1.0).abs() < 1e-9 && (across - 0.1 - 0.1 * x).abs() < 1e-9, "{x}: {along} {across}");
        }
        let [along, across] = sizes(-1.0, 0.05);
        assert!((along - 1.0).abs() < 1e-9 && (across - 0.1 - libm::log(1.3) * 0.95).abs() < 1e-9, "{across}");
        assert_eq!(sizes(-9.0, 0.05), [1.0, 1.0]);
        assert!(gap.limit(None, DVec3::NAN).is_none());
        assert!(Gap::new(&[vec![rung(0.0)]], 1, 1.3, 1.0).is_none());
        let thirds = Gap::new(&[vec![rung(0.0), rung(1.0)]], 3, 1.3, 1.0).unwrap();
        let m = thirds.limit(Some(Metric3::isotropic(1.0)), DVec3::new(0.5, 0.075, 0.0)).unwrap();
        assert!((1.0 / m.norm2(DVec3::Y).sqrt() - 0.05).abs() < 1e-9);
    }
}
