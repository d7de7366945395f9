//! Which face holds a point: crossings of a ray with the fine polygons, found by a tree of boxes.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use smallvec::SmallVec;

use super::domain::{CurveId, DomainCurve};
use super::predicates::orient;

/// A chord of a curve's fine polyline: the curve and the number of the chord.
pub type Chord = GeomWithData<Rectangle<[f64; 2]>, (CurveId, u32)>;

/// Boxes of all chords, each grown by `margin(curve, chord)`, so that the curve's arc lies in it too.
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

/// The curves that a ray from `p` towards -x crosses, one entry for each crossing.
pub fn crossed_by_ray(tree: &RTree<Chord>, curves: &[DomainCurve], p: DVec2, far_left: f64) -> SmallVec<[CurveId; 16]> {
    let mut crossed = SmallVec::new();
    if p.x < far_left {
        return crossed;
    }
    for chord in tree.locate_in_envelope_intersecting(AABB::from_corners([far_left, p.y], [p.x, p.y])) {
        let (id, i) = chord.data;
        let fine = &curves[id.index()].fine;
        let (a, b) = (fine[i as usize].1, fine[i as usize + 1].1);
        // Half-open, so that a ray through a corner counts it once.
        let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
        if low.y <= p.y && p.y < high.y && orient(low, high, p) < 0.0 {
            crossed.push(id);
        }
    }
    crossed
}
