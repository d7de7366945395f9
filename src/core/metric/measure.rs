//! Lengths, angles, areas and shape in a metric (eqs. 4, 5; spec 2.1).

use std::f64::consts::TAU;

use glam::DVec2;

use super::field::{BadMetric, MetricSource};
use super::tensor::Metric2;

/// Eq. (4): the length of `d` in the metric `m`.
#[inline]
pub fn length(m: &Metric2, d: DVec2) -> f64 {
    m.norm2(d).max(0.0).sqrt()
}

/// The length of `d` between two metrics (spec 2.1.2): the logarithmic mean of the lengths at both ends, which is exact where
/// the size along the edge changes geometrically.
#[inline]
pub fn length_between(ma: &Metric2, mb: &Metric2, d: DVec2) -> f64 {
    let (l_a, l_b) = (length(ma, d), length(mb, d));
    if (l_a - l_b).abs() < 1e-3 {
        // The quotient would lose its digits; the two means differ by less than 1e-7 of a unit edge here.
        0.5 * (l_a + l_b)
    } else {
        (l_a - l_b) / libm::log(l_a / l_b)
    }
}

/// Eq. (5): the anticlockwise angle from `du` to `dv` in the metric `m`, in [0, 2 pi).
///
/// The paper takes the arc cosine of the normed inner product and the sign of the cross product. The arc tangent of the same
/// two, `sqrt(det M) x(du, dv)` and `du^T M dv`, is the same angle (they are its sine and cosine, times both lengths), and
/// keeps all digits near 0 and pi, where the arc cosine keeps half.
#[inline]
pub fn angle(m: &Metric2, du: DVec2, dv: DVec2) -> f64 {
    let sine = m.det().max(0.0).sqrt() * du.perp_dot(dv);
    let t = libm::atan2(sine, m.inner(du, dv));
    if t < 0.0 {
        // A hair clockwise is nearly a full turn, never none: rounding must not reach 2 pi.
        (t + TAU).min(TAU.next_down())
    } else {
        // Turns -0 into 0.
        t + 0.0
    }
}

/// Nodes in (-1, 1) and weights of the Gauss-Legendre rule of eight points; it is symmetric, so half of it is here.
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// The length of the straight uv edge from `a` to `b`: the integral of eq. (4) along it, by eight Gauss points.
///
/// # Errors
/// Where the source has no metric at a point of the edge.
pub fn length_exact(source: &dyn MetricSource, a: DVec2, b: DVec2) -> Result<f64, Box<BadMetric>> {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let mut sum = 0.0;
    for (node, weight) in GAUSS_8 {
        for side in [-node, node] {
            sum += weight * length(&source.metric(middle + side * half)?, half);
        }
    }
    Ok(sum)
}

/// The signed area of the triangle a, b, c in the metric `m`, positive when anticlockwise.
#[inline]
pub fn triangle_area(m: &Metric2, a: DVec2, b: DVec2, c: DVec2) -> f64 {
    0.5 * m.det().max(0.0).sqrt() * (b - a).perp_dot(c - a)
}

/// `4 sqrt(3) A / sum of l^2` of a triangle in the metric `m`: 1 for the equilateral one, negative when clockwise.
#[inline]
pub fn triangle_quality(m: &Metric2, a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let squares = m.norm2(b - a) + m.norm2(c - b) + m.norm2(a - c);
    if squares > 0.0 { 4.0 * 3f64.sqrt() * triangle_area(m, a, b, c) / squares } else { 0.0 }
}

/// Quality of a quadrilateral (spec 2.1.5): the least over its corners of `2 sqrt(det M_k) x(a, b) / (a^T M_k a + b^T M_k b)`
/// with a and b the sides that leave the corner, anticlockwise, and M_k its metric; 1 for a metric square, at most 0 when a
/// corner is not convex.
#[inline]
pub fn quad_quality(metrics: [&Metric2; 4], corners: [DVec2; 4]) -> f64 {
    let mut least = f64::INFINITY;
    for k in 0..4 {
        let m = metrics[k];
        let a = corners[(k + 1) % 4] - corners[k];
        let b = corners[(k + 3) % 4] - corners[k];
        let squares = m.norm2(a) + m.norm2(b);
        let q = if squares > 0.0 { 2.0 * m.det().max(0.0).sqrt() * a.perp_dot(b) / squares } else { 0.0 };
        least = least.min(q);
    }
    least
}
