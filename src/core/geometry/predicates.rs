//! Exact orientation in the parametric plane (spec 5). The sign is exact for given f64 input; there is no epsilon.

use glam::DVec2;

/// Twice the signed area of the triangle a, b, c; its *sign* is exact (positive: anticlockwise).
#[inline]
pub fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    // The filter of Shewchuk's adaptive predicate, inlined: nearly every call ends here.
    let left = (a.x - c.x) * (b.y - c.y);
    let right = (a.y - c.y) * (b.x - c.x);
    let det = left - right;
    let bound = 3.330_669_073_875_472e-16 * (left.abs() + right.abs());
    if det > bound || -det > bound {
        return det;
    }
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Whether the triangle a, b, c is strictly positive (anticlockwise), exactly.
#[inline]
pub fn positive(a: DVec2, b: DVec2, c: DVec2) -> bool {
    orient(a, b, c) > 0.0
}

/// Whether the quadrilateral a, b, c, d is strictly convex and anticlockwise, exactly.
#[inline]
pub fn convex(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    positive(a, b, c) && positive(b, c, d) && positive(c, d, a) && positive(d, a, b)
}

fn coord(p: DVec2) -> robust::Coord<f64> {
    robust::Coord { x: p.x, y: p.y }
}
