//! Exact orientation in the parametric plane (docs/algorithm.md, "Exact predicates"). The sign is exact for given f64
//! input; there is no epsilon.

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

/// Whether a triangle is strictly positive and not so flat that a template of the last resort could be inverted by
/// rounding (docs/algorithm.md, "Rounding"): altitude over longest edge at least 1e-7, altitude at least 256 ulp of the
/// largest coordinate.
#[inline]
pub fn firm(a: DVec2, b: DVec2, c: DVec2) -> bool {
    let twice_area = orient(a, b, c);
    let longest2 = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    let coordinate = a.abs().max(b.abs()).max(c.abs()).max_element();
    twice_area > 0.0
        && twice_area >= 1e-7 * longest2
        && twice_area * twice_area
            >= (256.0 * f64::EPSILON * coordinate) * (256.0 * f64::EPSILON * coordinate) * longest2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orientation_is_exact_where_rounding_lies() {
        let (a, c) = (DVec2::new(0.5, 0.5), DVec2::new(24.0, 24.0));
        for (i, j) in [(1.0, 0.0), (0.0, 1.0), (3.0, 2.0)] {
            let b = DVec2::new(12.0 + i * f64::EPSILON * 8.0, 12.0 + j * f64::EPSILON * 8.0);
            assert_eq!(orient(a, b, c) > 0.0, i > j, "{i} {j}");
            assert!(orient(a, b, c) != 0.0);
        }
        assert_eq!(orient(a, DVec2::splat(12.0), c), 0.0);
    }

    #[test]
    fn a_needle_is_positive_but_not_firm() {
        let (a, b) = (DVec2::ZERO, DVec2::X);
        assert!(positive(a, b, DVec2::new(0.5, 1e-8)) && !firm(a, b, DVec2::new(0.5, 1e-8)));
        assert!(firm(a, b, DVec2::new(0.5, 1e-4)));
        let far = DVec2::splat(1e6);
        assert!(!firm(far, far + DVec2::X * 1e-9, far + DVec2::Y * 1e-9));
    }

    #[test]
    fn a_quadrilateral_with_a_flat_corner_is_not_convex() {
        let (a, b, c) = (DVec2::ZERO, DVec2::X, DVec2::new(1.0, 1.0));
        assert!(convex(a, b, c, DVec2::Y));
        assert!(!convex(a, b, c, DVec2::new(0.5, 0.5)));
    }
}
