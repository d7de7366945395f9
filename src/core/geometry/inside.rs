//! Point-in-face tests: crossings of a ray with the fine polygons, found by a tree of boxes.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use smallvec::SmallVec;

use super::domain_curve::{CurveId, DomainCurve};
use crate::core::kernel::predicates::orient;

/// A chord of a curve's fine polyline: the curve and the index of the chord.
pub type Chord = GeomWithData<Rectangle<[f64; 2]>, (CurveId, u32)>;

/// The tree of boxes of all chords, each grown by `margin(curve, chord)` so that it contains the arc of the curve too.
pub fn chord_tree(curves: &[DomainCurve], margin: impl Fn(CurveId, u32) -> f64) -> RTree<Chord> {
    let mut boxes = Vec::new();
    for (c, curve) in curves.iter().enumerate() {
        let id = CurveId(c as u32);
        for (i, w) in curve.fine.windows(2).enumerate() {
            let grow = DVec2::splat(margin(id, i as u32));
            let (low, high) = (w[0].1.min(w[1].1) - grow, w[0].1.max(w[1].1) + grow);
            boxes.push(GeomWithData::new(Rectangle::from_corners([low.x, low.y], [high.x, high.y]), (id, i as u32)));
        }
    }
    RTree::bulk_load(boxes)
}

/// A chord that crosses a horizontal line, and its curve.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    low: DVec2,
    high: DVec2,
    /// The curve.
    pub curve: CurveId,
}

impl Crossing {
    /// Whether a ray towards -x from `p`, a point of the line, meets the chord.
    #[inline]
    pub fn left_of(&self, p: DVec2) -> bool {
        orient(self.low, self.high, p) < 0.0
    }
}

/// The chords that the horizontal line at `y` crosses between the two abscissas, and possibly some to the right of
/// them.
pub fn crossings(tree: &RTree<Chord>, curves: &[DomainCurve], y: f64, [left, right]: [f64; 2]) -> Crossings {
    let mut crossings = Crossings::new();
    if right < left {
        return crossings;
    }
    for chord in tree.locate_in_envelope_intersecting(AABB::from_corners([left, y], [right, y])) {
        let (id, i) = chord.data;
        let fine = &curves[id.index()].fine;
        let (a, b) = (fine[i as usize].1, fine[i as usize + 1].1);
        // Half-open intervals, so that a line through a corner counts once.
        let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
        if low.y <= y && y < high.y {
            crossings.push(Crossing { low, high, curve: id });
        }
    }
    crossings
}

/// The result of [`crossings`].
pub type Crossings = SmallVec<[Crossing; 8]>;
