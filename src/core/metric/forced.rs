//! Sizes that the boundary forces: isotropic, those of given sides on them, growing with the distance.

use glam::DVec3;

use crate::core::kernel::Metric3;
use crate::core::kernel::box_tree::{BoxTree, Spot, share_along};

/// A side that stands, or a place, at which sizes must be smaller than the metric asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForcedSide {
    /// Its ends in space.
    pub ends: [DVec3; 2],
    /// The size that it forces: its own length, if it stands.
    pub size: f64,
    /// This size in the metric, without the sizes that are forced.
    pub metric_size: f64,
}

impl ForcedSide {
    /// A side that stands, of this length in the metric.
    pub fn standing(ends: [DVec3; 2], metric_size: f64) -> ForcedSide {
        ForcedSide { ends, size: ends[0].distance(ends[1]), metric_size }
    }
}

/// The least over all sides of the side's size plus a multiple of the distance from it.
#[derive(Clone, Debug)]
pub(super) struct Forced {
    tree: BoxTree<DVec3>,
    /// In the order of the tree: the ends, and the distance from the shortest side over which sizes grow to the size of
    /// this one.
    sides: Vec<([DVec3; 2], f64)>,
    /// The smallest size.
    least: f64,
    /// Derivative of the size by the distance.
    slope: f64,
}

impl Forced {
    /// Sizes that grow by `ln(gradation)` times the distance from the sides, which is the growth of an isotropic metric
    /// with that gradation (docs/algorithm.md, "Gradation"). All are divided by `size_scale`, by which fields are
    /// multiplied.
    ///
    /// # Panics
    /// Without sides.
    pub fn new(sides: &[ForcedSide], gradation: f64, size_scale: f64) -> Forced {
        let slope = libm::log(gradation).max(1e-6);
        let least = sides.iter().map(|side| side.size).fold(f64::INFINITY, f64::min);
        let around = |side: &ForcedSide| (side.ends[0].min(side.ends[1]), side.ends[0].max(side.ends[1]));
        let (tree, order) = BoxTree::new(&sides.iter().map(around).collect::<Vec<_>>());
        let head_start = |side: &ForcedSide| (side.size - least) / slope;
        let sides = order.into_iter().map(|i| &sides[i as usize]).map(|side| (side.ends, head_start(side))).collect();
        Forced { tree, sides, least: least / size_scale, slope: slope / size_scale }
    }

    /// The metric at a point in space; `None` when it is not finite.
    #[inline]
    pub fn metric(&self, p: DVec3) -> Option<Metric3> {
        // A side with a larger size counts as if it were farther away.
        let away = |id: u32| {
            let ([a, b], head_start) = self.sides[id as usize];
            let distance = head_start + a.between(b, share_along(p, a, b)).distance(p);
            distance * distance
        };
        let (_, squared) = self.tree.nearest(p, away)?;
        Some(Metric3::isotropic(self.least + self.slope * squared.sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_the_least_that_any_side_asks_for() {
        // Sides of lengths from 1e-4 to 0.1, scattered.
        let mut sides = Vec::new();
        for k in 0..300 {
            let from = DVec3::new((f64::from(k) * 0.618_034).fract(), (f64::from(k) * 0.414_214).fract(), 0.0);
            let length = 1e-4 * libm::exp(f64::from(k % 7));
            let turn = glam::DVec2::from_angle(f64::from(k)) * length;
            sides.push(ForcedSide::standing([from, from + turn.extend(0.0)], 0.1));
        }
        let field = Forced::new(&sides, 1.3, 1.0);
        let doubled = Forced::new(&sides, 1.3, 2.0);
        for k in 0..500 {
            let p = DVec3::new((f64::from(k) * 0.732_051).fract(), f64::from(k) / 500.0, 0.0);
            let by_hand = sides.iter().map(|side| {
                let [a, b] = side.ends;
                let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                (b - a).length() + libm::log(1.3) * p.distance(a + (b - a) * t)
            });
            let by_hand = by_hand.fold(f64::INFINITY, f64::min);
            let size = |field: &Forced| field.metric(p).unwrap().min_size();
            assert!((size(&field) / by_hand - 1.0).abs() < 1e-9, "{p}");
            assert!((2.0 * size(&doubled) / by_hand - 1.0).abs() < 1e-9, "{p}");
        }
        assert!(field.metric(DVec3::NAN).is_none());
    }
}
