//! The energy that clean-up and global smoothing lower (docs/algorithm.md, "The energy"), and the relaxation of one
//! node by Newton's method.
//!
//! Sum over corners of ((a^2 + b^2) / 2x)^2 - 1 (a, b: metric lengths of the corner's sides, x: their metric cross
//! product; the corner's node gives the metric; 0 for a right angle with equal sides), plus for each edge the rational
//! twin of ln^2(l) (l^2 + l^-2 - 2 in place of 4 ln^2 l: equal to third order at l = 1, and without a logarithm), plus
//! (valence - ideal)^2 for each node. Infinite for what is not strictly convex.

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::kernel::Metric2;
use crate::core::kernel::predicates::convex;
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::metric::MetricSource;

/// Weight of an edge's length against the shape of a corner: 0.5 * 4 ln^2 l, half of it from the metric of each end.
const LENGTH_WEIGHT: f64 = 0.25;
/// A node does not move farther than this in one step, in its metric.
const LONGEST_MOVE: f64 = 0.5;

/// What the clean-up judges quadrilaterals by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Energy of the corners (1/sin^2 - 1, which leaves the lengths of a corner's sides to the next term) and half that
    /// of the sides' lengths (the other half is the neighbour's); infinite where one is not strictly convex.
    pub energy: f64,
    /// The worst quality, as `Mesh::quality`.
    pub quality: f64,
    /// The least sine of a corner.
    pub sine: f64,
    /// The lengths of the shortest and the longest side, over the metrics of both ends (geometric mean).
    pub lengths: [f64; 2],
}

impl Judged {
    /// Nothing, to which others are added.
    pub const NOTHING: Judged =
        Judged { energy: 0.0, quality: f64::INFINITY, sine: f64::INFINITY, lengths: [f64::INFINITY, 0.0] };
}

impl std::ops::AddAssign for Judged {
    fn add_assign(&mut self, other: Judged) {
        self.energy += other.energy;
        self.quality = self.quality.min(other.quality);
        self.sine = self.sine.min(other.sine);
        self.lengths = [self.lengths[0].min(other.lengths[0]), self.lengths[1].max(other.lengths[1])];
    }
}

/// Judges a quadrilateral of the mesh.
pub fn judge(mesh: &Mesh, e: ElementId) -> Judged {
    let n = mesh.quad(e);
    judge_corners(n.map(|n| mesh.uv(n)), n.map(|n| mesh.metric_ref(n)))
}

/// Judges the quadrilateral of these corners, anticlockwise, with their metrics.
pub fn judge_corners(p: [DVec2; 4], metrics: [&Metric2; 4]) -> Judged {
    let (mut energy, mut quality) = (0.0, f64::INFINITY);
    let (mut sine, mut lengths) = (f64::INFINITY, [f64::INFINITY, 0.0f64]);
    for k in 0..4 {
        let m = metrics[k];
        let (next, previous) = (p[(k + 1) % 4] - p[k], p[(k + 3) % 4] - p[k]);
        let (a, b, x) = (m.norm2(next), m.norm2(previous), m.det().sqrt() * next.perp_dot(previous));
        energy += if x > 0.0 { a * b / (x * x) - 1.0 } else { f64::INFINITY };
        energy += 0.5 * LENGTH_WEIGHT * (a + 1.0 / a + b + 1.0 / b - 4.0);
        quality = quality.min(2.0 * x / (a + b));
        sine = sine.min(x / (a * b).sqrt());
        // The square of the mean of both ends.
        let length = (a * metrics[(k + 1) % 4].norm2(next)).sqrt();
        lengths = [lengths[0].min(length), lengths[1].max(length)];
    }
    Judged { energy, quality, sine, lengths: lengths.map(f64::sqrt) }
}

/// A corner beside a free node: its place, its metric and the root of the metric's determinant.
#[derive(Clone, Copy)]
struct Corner<'a> {
    p: DVec2,
    m: &'a Metric2,
    root: f64,
}

impl Corner<'_> {
    /// (a^2 + b^2) / 2x over the sides to `a` and `b` (anticlockwise), or infinite where it is not convex.
    #[inline(always)]
    fn ratio(&self, a: DVec2, b: DVec2) -> f64 {
        let (a, b) = (a - self.p, b - self.p);
        let x = self.root * a.perp_dot(b);
        if x > 0.0 { (self.m.norm2(a) + self.m.norm2(b)) * (0.5 / x) } else { f64::INFINITY }
    }
}

/// Energy of the length of an edge in the metric of one end, by the square of the length.
#[inline(always)]
fn length(a: f64) -> f64 {
    LENGTH_WEIGHT * (a + 1.0 / a - 2.0)
}

/// What surrounds a free node: for each quadrilateral (node, b, c, d) its other corners.
struct Star<'a> {
    quads: SmallVec<[(Corner<'a>, DVec2, Corner<'a>); 6]>,
}

impl<'a> Star<'a> {
    /// The star of a free node; none where an element around it is no quadrilateral.
    #[inline]
    fn of(mesh: &'a Mesh, node: NodeId) -> Option<Star<'a>> {
        let mut quads: SmallVec<[(Corner<'a>, DVec2, Corner<'a>); 6]> = SmallVec::new();
        let at = |n: NodeId| {
            let (p, m) = mesh.place(n);
            Corner { p, m, root: m.det().sqrt() }
        };
        for h in mesh.fan(node) {
            if !mesh.is_quad(h.element()) {
                return None;
            }
            let [_, b, c, d] = mesh.quad_from(h);
            // Neighbours in the fan share a side.
            let b = quads.last().map_or_else(|| at(b), |last| last.2);
            quads.push((b, mesh.uv(c), at(d)));
        }
        Some(Star { quads })
    }

    /// Energy of everything that depends on the node, with the node at `p`.
    fn energy(&self, p: DVec2, m: &Metric2) -> f64 {
        let node = Corner { p, m, root: m.det().sqrt() };
        let mut sum = 0.0;
        for (b, c, d) in &self.quads {
            let ratios = [node.ratio(b.p, d.p), b.ratio(*c, p), d.ratio(p, *c)];
            sum += ratios.iter().map(|r| r * r - 1.0).sum::<f64>();
            sum += length(m.norm2(b.p - p)) + length(b.m.norm2(b.p - p));
        }
        sum
    }

    /// First and second derivatives of the energy by the node's place, its own metric held fast; and the energy.
    fn slope(&self, p: DVec2, m: &Metric2) -> Slope {
        let root = m.det().sqrt();
        let mut sum = Slope::default();
        for (b, c, d) in &self.quads {
            // At the node: both sides turn with it.
            let (to_b, to_d) = (b.p - p, d.p - p);
            let m_to_b = m.times(to_b);
            let (a_b, a_d) = (to_b.dot(m_to_b), m.norm2(to_d));
            let x = root * to_b.perp_dot(to_d);
            sum.add_corner(a_b + a_d, x, (m_to_b + m.times(to_d)) * -2.0, perp(d.p - b.p) * root, m, 4.0);
            // At b, between c and the node; at d, between the node and c: one side turns.
            let (to_c, to_p) = (*c - b.p, p - b.p);
            let m_to_p = b.m.times(to_p);
            let a_p = to_p.dot(m_to_p);
            let x = b.root * to_c.perp_dot(to_p);
            sum.add_corner(b.m.norm2(to_c) + a_p, x, m_to_p * 2.0, perp(to_c) * b.root, b.m, 2.0);
            // The edge to b, in the metrics of both ends.
            sum.add_length(a_b, m_to_b * -2.0, m);
            sum.add_length(a_p, m_to_p * 2.0, b.m);
            let (to_p, to_c) = (p - d.p, *c - d.p);
            let m_to_p = d.m.times(to_p);
            let x = d.root * to_p.perp_dot(to_c);
            let n = to_p.dot(m_to_p) + d.m.norm2(to_c);
            sum.add_corner(n, x, m_to_p * 2.0, -perp(to_c) * d.root, d.m, 2.0);
        }
        sum
    }

    /// Whether every quadrilateral is strictly convex, exactly, with the node at `p`.
    fn is_convex(&self, p: DVec2) -> bool {
        self.quads.iter().all(|(b, c, d)| convex(p, b.p, *c, d.p))
    }
}

/// A sum of terms with its gradient and second derivatives.
#[derive(Clone, Copy, Default)]
struct Slope {
    /// Infinite where a corner is not convex.
    energy: f64,
    gradient: DVec2,
    uu: f64,
    uv: f64,
    vv: f64,
}

impl Slope {
    /// Adds w m + g q' + q g' to the second derivatives.
    #[inline(always)]
    fn add_second(&mut self, w: f64, m: &Metric2, g: DVec2, q: DVec2) {
        self.uu += w * m.uu + 2.0 * g.x * q.x;
        self.uv += w * m.uv + g.x * q.y + g.y * q.x;
        self.vv += w * m.vv + 2.0 * g.y * q.y;
    }

    /// Adds (n / 2x)^2 - 1, where x is linear in the place and n has the second derivatives `second` * m.
    #[inline(always)]
    fn add_corner(&mut self, n: f64, x: f64, gradient_n: DVec2, gradient_x: DVec2, m: &Metric2, second: f64) {
        let half = 0.5 / x;
        let r = n * half;
        self.energy += if x > 0.0 { r * r - 1.0 } else { f64::INFINITY };
        // Gradient of the ratio r.
        let g = (gradient_n - gradient_x * (2.0 * r)) * half;
        self.gradient += g * (2.0 * r);
        // 2 g g' + 2 r (second m / 2x - (g x' + x' g) / x)
        let w = 2.0 * r * half;
        self.add_second(w * second, m, g, g - gradient_x * (2.0 * w));
    }

    /// Adds the energy of an edge with this square of its length in a metric.
    #[inline(always)]
    fn add_length(&mut self, a: f64, gradient: DVec2, m: &Metric2) {
        let inverse = 1.0 / a;
        self.energy += LENGTH_WEIGHT * (a + inverse - 2.0);
        let first = LENGTH_WEIGHT * (1.0 - inverse * inverse);
        self.gradient += gradient * first;
        self.add_second(2.0 * first, m, gradient, gradient * (LENGTH_WEIGHT * inverse * inverse * inverse));
    }
}

/// The vector w with `w . q = d/dq` of a cross product: for f(p) = (b - p) x (d - p), grad f = perp(d - b).
#[inline]
fn perp(d: DVec2) -> DVec2 {
    DVec2::new(-d.y, d.x)
}

/// A basis in which the metric is the identity: columns of the inverse transposed Cholesky factor.
pub fn unit_axes(m: &Metric2) -> [DVec2; 2] {
    let l11 = m.uu.sqrt();
    let l21 = m.uv / l11;
    let l22 = (m.vv - l21 * l21).sqrt();
    [DVec2::new(1.0 / l11, 0.0), DVec2::new(-l21 / (l11 * l22), 1.0 / l22)]
}

/// Moves a free node towards the least energy of its star by one damped Newton step, if that lowers it and keeps every
/// element strictly convex. Returns the distance moved, in the node's metric; 0 where it stays.
pub fn relax(mesh: &mut Mesh, node: NodeId, source: &dyn MetricSource) -> f64 {
    if mesh.is_fixed(node) {
        return 0.0;
    }
    let Some(star) = Star::of(mesh, node) else { return 0.0 };
    let (p, m) = (mesh.uv(node), mesh.metric(node));
    let slope = star.slope(p, &m);
    if !slope.energy.is_finite() {
        return 0.0;
    }
    let e = unit_axes(&m);
    let along = |g: DVec2| DVec2::new(g.dot(e[0]), g.dot(e[1]));
    let g = along(slope.gradient);
    // The second derivative is seldom below 10: the step would be too short to be worth the journal's memory.
    if g.length_squared() < 1e-4 {
        return 0.0;
    }
    let times = |w: DVec2| DVec2::new(slope.uu * w.x + slope.uv * w.y, slope.uv * w.x + slope.vv * w.y);
    let along_0 = times(e[0]);
    let (a, b, c) = (e[0].dot(along_0), e[1].dot(along_0), e[1].dot(times(e[1])));
    // Made positive definite where the energy is not convex.
    let (mean, radius) = (0.5 * (a + c), (0.25 * (a - c) * (a - c) + b * b).sqrt());
    let (low, high) = (mean - radius, mean + radius);
    let shift = (0.05 * high.abs().max(low.abs()) - low).max(0.0);
    let (a, c) = (a + shift, c + shift);
    let det = a * c - b * b;
    let newton = -DVec2::new(c * g.x - b * g.y, a * g.y - b * g.x) / det;
    if !newton.is_finite() {
        return 0.0;
    }
    let length = newton.length();
    if length < 1e-3 {
        return 0.0;
    }
    let newton = newton * (LONGEST_MOVE / length).min(1.0);
    let (mut step, mut found) = (1.0, None);
    for _ in 0..4 {
        let place = p + (e[0] * newton.x + e[1] * newton.y) * step;
        if let Ok(metric) = source.metric(place) {
            // The exact test comes last: it is expensive and seldom fails where the energy is finite.
            if star.energy(place, &metric) < slope.energy - 1e-9
                && star.is_convex(place)
                && mesh.permit_move(node, place).is_ok()
            {
                found = Some((place, metric));
                break;
            }
        }
        step *= 0.5;
    }
    drop(star);
    let Some((place, metric)) = found else { return 0.0 };
    mesh.move_node(node, place, metric);
    newton.length() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivatives_are_those_of_the_energy() {
        let metric = |uu, uv, vv| Metric2 { uu, uv, vv };
        let (m, around) =
            (metric(2.0, 0.3, 1.0), [metric(1.5, -0.2, 0.8), metric(1.0, 0.0, 1.0), metric(2.2, 0.5, 1.3)]);
        let corners = [DVec2::new(1.0, 0.1), DVec2::new(1.1, 1.0), DVec2::new(0.0, 0.9)];
        let at = |k: usize| Corner { p: corners[k], m: &around[k], root: around[k].det().sqrt() };
        let star = Star { quads: SmallVec::from_iter([(at(0), corners[1], at(2))]) };
        let p = DVec2::new(0.1, -0.05);
        let slope = star.slope(p, &m);
        assert!((slope.energy - star.energy(p, &m)).abs() < 1e-12 * slope.energy);
        for (axis, second) in [(DVec2::X, [slope.uu, slope.uv]), (DVec2::Y, [slope.uv, slope.vv])] {
            let step = axis * 1e-5;
            let first = (star.energy(p + step, &m) - star.energy(p - step, &m)) / 2e-5;
            assert!((first - slope.gradient.dot(axis)).abs() < 1e-6, "{first} {}", slope.gradient);
            let turn = (star.slope(p + step, &m).gradient - star.slope(p - step, &m).gradient) / 2e-5;
            assert!((turn - DVec2::from(second)).length() < 1e-5, "{turn} {second:?}");
        }
        // Beyond the line from b to d a corner is inverted.
        let beyond = DVec2::new(1.2, 1.2);
        assert_eq!([star.energy(beyond, &m), star.slope(beyond, &m).energy], [f64::INFINITY; 2]);
        assert!(star.is_convex(p) && !star.is_convex(beyond));
    }

    #[test]
    fn the_unit_square_of_the_metric_has_no_energy() {
        let m = Metric2 { uu: 4.0, uv: 0.0, vv: 25.0 };
        let at = |x, y| Corner { p: DVec2::new(x, y), m: &m, root: m.det().sqrt() };
        let star = Star { quads: SmallVec::from_iter([(at(0.5, 0.0), DVec2::new(0.5, 0.2), at(0.0, 0.2))]) };
        assert!(star.energy(DVec2::ZERO, &m).abs() < 1e-12);
    }
}
