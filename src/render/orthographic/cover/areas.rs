//! What is seen of areas: a triangle less the parts of others before its plane, by whole-number coordinates, so that
//! the outlines are the same on every machine.

use glam::{DVec2, DVec3};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::Overlay;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::i_shape::int::shape::IntShapes;
use smallvec::SmallVec;

use super::{Cover, Face, Half, NARROW, SeenFace};

/// The side of the picture in steps of the lattice.
const STEPS: f64 = 536_870_912.0;

/// A convex polygon in space; a triangle cut by a plane has four corners.
type Convex = SmallVec<[DVec3; 4]>;
/// The outlines of areas on the lattice.
type Outlines = IntShapes<i32>;

/// The whole-number coordinates in which outlines are combined.
pub(super) struct Lattice {
    middle: DVec2,
    /// Steps per unit of the picture.
    scale: f64,
}

impl Lattice {
    /// The lattice over a box.
    pub(super) fn over(low: DVec2, high: DVec2) -> Lattice {
        let size = (high - low).max_element();
        if !(size.is_finite() && size > 0.0) {
            return Lattice { middle: DVec2::ZERO, scale: 1.0 };
        }
        Lattice { middle: low.midpoint(high), scale: STEPS / size }
    }

    fn on(&self, p: DVec2) -> IntPoint<i32> {
        let steps = ((p - self.middle) * self.scale).round();
        // The conversion saturates; a point of the box is within half of `STEPS`.
        IntPoint::new(steps.x as i32, steps.y as i32)
    }

    fn off(&self, p: IntPoint<i32>) -> DVec2 {
        self.middle + DVec2::new(f64::from(p.x), f64::from(p.y)) / self.scale
    }
}

/// What is left of a triangle.
enum Left {
    /// All of it.
    Whole,
    /// What is within these outlines.
    Parts(Outlines),
}

impl Cover {
    /// What is seen of a face.
    pub fn seen(&self, face: usize) -> SeenFace {
        let Face { halves: own, is_folded } = &self.faces[face];
        let mut left: SmallVec<[Left; 2]> = own.iter().map(|k| self.left(*k)).collect();
        let halves = own.iter().map(|k| &self.halves[*k as usize]);
        if !is_folded && left.iter().all(|left| matches!(left, Left::Whole)) {
            return SeenFace::Whole;
        }
        let outlines = halves.zip(left.drain(..)).map(|(half, left)| match left {
            Left::Whole => vec![vec![self.outline(&half.corners)]],
            Left::Parts(outlines) => outlines,
        });
        let joined = outlines.reduce(|a, b| {
            let mut both = Overlay::from_subj_and_clip(&a, &b);
            both.overlay(OverlayRule::Union, FillRule::NonZero)
        });
        let contours = joined.into_iter().flatten().flatten();
        let places = |contour: Vec<IntPoint<i32>>| contour.into_iter().map(|p| self.lattice.off(p)).collect();
        SeenFace::Parts(contours.filter(|contour| is_wide(contour)).map(places).collect())
    }

    fn outline(&self, corners: &[DVec3]) -> Vec<IntPoint<i32>> {
        corners.iter().map(|p| self.lattice.on(p.truncate())).collect()
    }

    /// What other triangles leave of a triangle.
    fn left(&self, own: u32) -> Left {
        let half = &self.halves[own as usize];
        let [a, b, c] = half.corners.map(|p| p.truncate());
        let farthest = half.nearness()[0];
        let mut before: Vec<Convex> = Vec::new();
        for k in self.near(a.min(b).min(c), a.max(b).max(c)) {
            let other = &self.halves[k as usize];
            if k == own || other.nearness()[1] <= farthest {
                continue;
            }
            let part = self.before(half, other);
            if part.len() > 2 && self.overlaps(half, &part) {
                before.push(part);
            }
        }
        if before.is_empty() {
            return Left::Whole;
        }
        let hiding: Vec<Vec<IntPoint<i32>>> = before.iter().map(|part| self.outline(part)).collect();
        let mut overlay = Overlay::from_subj_and_clip(&self.outline(&half.corners)[..], &hiding);
        Left::Parts(overlay.overlay(OverlayRule::Difference, FillRule::NonZero))
    }

    /// The part of a triangle before the plane of another one.
    fn before(&self, plane: &Half, other: &Half) -> Convex {
        let distances = other.corners.map(|p| plane.before(p, self.in_plane));
        let mut part = Convex::new();
        if distances.iter().all(|distance| *distance <= 0.0) {
            return part;
        }
        for k in 0..3 {
            let next = (k + 1) % 3;
            let (p, q) = ((other.corners[k], distances[k]), (other.corners[next], distances[next]));
            if p.1 >= 0.0 {
                part.push(p.0);
            }
            if p.1 * q.1 < 0.0 {
                // Both triangles of an edge get the same point: neighbours leave no gap.
                let (p, q) = if p.0.to_array() < q.0.to_array() { (p, q) } else { (q, p) };
                part.push(p.0.lerp(q.0, p.1 / (p.1 - q.1)));
            }
        }
        part
    }

    /// Whether a triangle and a convex polygon have an area in common.
    fn overlaps(&self, half: &Half, part: &Convex) -> bool {
        let mut common: SmallVec<[DVec2; 8]> = part.iter().map(|p| p.truncate()).collect();
        let [a, b, c] = half.corners.map(|p| p.truncate());
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let inside = |p: DVec2| (to - from).perp_dot(p - from);
            let mut kept = SmallVec::new();
            for (k, &p) in common.iter().enumerate() {
                let q = common[(k + 1) % common.len()];
                let (at_p, at_q) = (inside(p), inside(q));
                if at_p >= 0.0 {
                    kept.push(p);
                }
                if at_p * at_q < 0.0 {
                    kept.push(p.lerp(q, at_p / (at_p - at_q)));
                }
            }
            common = kept;
        }
        let around = |k: usize| (common[k], common[(k + 1) % common.len()]);
        let area: f64 = (0..common.len()).map(around).map(|(p, q)| 0.5 * (p - a).perp_dot(q - a)).sum();
        let length: f64 = (0..common.len()).map(around).map(|(p, q)| p.distance(q)).sum();
        area > self.narrow * length
    }
}

/// Whether an outline is wide enough to be seen: twice its area is its width times its length.
fn is_wide(contour: &[IntPoint<i32>]) -> bool {
    let place = |k: usize| DVec2::new(f64::from(contour[k].x), f64::from(contour[k].y));
    let around = |k: usize| (place(k), place((k + 1) % contour.len()));
    let area: f64 = (0..contour.len()).map(around).map(|(p, q)| 0.5 * (p - place(0)).perp_dot(q - place(0))).sum();
    let length: f64 = (0..contour.len()).map(around).map(|(p, q)| p.distance(q)).sum();
    area.abs() > NARROW * STEPS * length
}
