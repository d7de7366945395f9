//! Maps of a surface part to the plane: injectivity and stretch.

use glam::{DVec2, DVec3};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::core::kernel::predicates::orient;

/// Distortion of a map to the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Largest ratio of the two singular values at a point (1: conformal).
    pub shape: f64,
    /// Ratio of the largest to the smallest area factor.
    pub area: f64,
}

impl Default for Stretch {
    fn default() -> Self {
        Stretch { shape: 1.0, area: 1.0 }
    }
}

/// Limits on the stretch of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchBound {
    /// Bound for [`Stretch::shape`].
    pub shape: f64,
    /// Bound for [`Stretch::area`].
    pub area: f64,
}

impl Default for StretchBound {
    fn default() -> Self {
        // Far below what the arithmetic would bear (50 and 1e4; docs/algorithm.md, "Charts of triangles"): the mesh is
        // made in the plane, and follows its metric the better the less that changes from triangle to triangle.
        StretchBound { shape: 4.0, area: 16.0 }
    }
}

impl StretchBound {
    pub(super) fn allows(self, stretch: Stretch) -> bool {
        stretch.shape <= self.shape && stretch.area <= self.area
    }
}

/// The nearest multiple of `grid`.
pub fn snapped(p: DVec2, grid: f64) -> DVec2 {
    (p / grid).round() * grid
}

/// Whether all triangles are positively oriented, by an exact predicate.
pub fn is_positive(triangles: &[[u32; 3]], uv: &[DVec2]) -> bool {
    triangles.iter().all(|t| {
        let [a, b, c] = t.map(|k| uv[k as usize]);
        orient(a, b, c) > 0.0
    })
}

/// Whether the border loops bound one region of the plane to their left: none crosses or touches itself or another, and
/// exactly one runs anticlockwise. Positively oriented triangles then cover each point once, since the number that
/// cover a point is the winding number of the loops around it: 1 inside, 0 in the holes. By exact predicates.
pub fn is_embedded(uv: &[DVec2], loops: &[u32]) -> bool {
    let mut next: Vec<u32> = Vec::new();
    let mut anticlockwise = 0;
    for &long in loops {
        let first = next.len() as u32;
        next.extend((1..long).map(|k| first + k));
        next.push(first);
        let polygon = &uv[first as usize..next.len()];
        let doubled: f64 = (0..polygon.len())
            .map(|k| (polygon[k] - polygon[0]).perp_dot(polygon[(k + 1) % polygon.len()] - polygon[0]))
            .sum();
        anticlockwise += usize::from(doubled > 0.0);
    }
    let side = |k: usize| [uv[k], uv[next[k] as usize]];
    let boxed = |k: usize| Rectangle::from_corners(side(k)[0].to_array(), side(k)[1].to_array());
    let tree = RTree::bulk_load((0..next.len()).map(|k| GeomWithData::new(boxed(k), k)).collect());
    let meet = |[a, b]: [DVec2; 2], [c, d]: [DVec2; 2]| {
        let apart = |s: f64, t: f64| (s > 0.0 && t > 0.0) || (s < 0.0 && t < 0.0);
        !apart(orient(a, b, c), orient(a, b, d)) && !apart(orient(c, d, a), orient(c, d, b))
    };
    // Adjacent sides share a corner and must not fold back on each other.
    let folds = |[a, b]: [DVec2; 2], c: DVec2| orient(a, b, c) == 0.0 && (a - b).dot(c - b) >= 0.0;
    let is_free = |k: usize| {
        let own = side(k);
        let near = tree.locate_in_envelope_intersecting(AABB::from_corners(own[0].to_array(), own[1].to_array()));
        near.map(|found| found.data).all(|l| match l {
            _ if l == k => true,
            _ if l == next[k] as usize => !folds(own, side(l)[1]),
            _ if k == next[l] as usize => !folds(side(l), own[1]),
            _ => !meet(own, side(l)),
        })
    };
    anticlockwise == 1 && (0..next.len()).all(is_free)
}

/// The stretch of a map. Nearly degenerate triangles are ignored.
pub fn stretch(xyz: &[DVec3], triangles: &[[u32; 3]], uv: &[DVec2]) -> Stretch {
    let (mut shape, mut least, mut most) = (1.0_f64, f64::INFINITY, 0.0_f64);
    for t in triangles {
        let [p, q, r] = t.map(|k| xyz[k as usize]);
        let (e, f) = (q - p, r - p);
        let area = e.cross(f).length();
        let longest = e.length_squared().max(f.length_squared()).max(e.distance_squared(f));
        if area < 1e-3 * longest {
            continue;
        }
        // Eigenvalues of the first fundamental form of the map from the plane to space are the squared singular values.
        let [a, b, c] = t.map(|k| uv[k as usize]);
        let (g, h) = (b - a, c - a);
        let det = g.perp_dot(h);
        let (x_u, x_v) = ((e * h.y - f * g.y) / det, (f * g.x - e * h.x) / det);
        let (uu, uv, vv) = (x_u.length_squared(), x_u.dot(x_v), x_v.length_squared());
        let (mean, radius) = (0.5 * (uu + vv), (0.25 * (uu - vv) * (uu - vv) + uv * uv).sqrt());
        let product = (area / det).abs();
        // By the product of the eigenvalues: the smaller one would be lost in a difference.
        let ratio = (mean + radius) / product;
        shape = shape.max(if ratio.is_finite() { ratio } else { f64::INFINITY });
        (least, most) = (least.min(product), most.max(product));
    }
    let area = if most > 0.0 { most / least } else { 1.0 };
    Stretch { shape, area: if area.is_finite() { area } else { f64::INFINITY } }
}
