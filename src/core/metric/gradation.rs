//! Gradation: a bound on the growth of the sizes of a tabulated metric (docs/algorithm.md, "Gradation"; after Alauzet's
//! mixed-space gradation).

use glam::{DVec2, DVec3};

use crate::core::kernel::{Metric2, Metric3};

/// A tensor whose sizes can grow along an edge.
pub trait Gradable: Copy {
    /// A point or an edge vector.
    type Point: Copy + std::ops::Sub<Output = Self::Point>;

    /// The tensor at the far end of the edge `d`, after its sizes have grown by at most `exp(ln_beta)` per unit length.
    fn spanned(&self, d: Self::Point, ln_beta: f64) -> Self;

    /// The intersection of two tensors.
    #[must_use]
    fn intersect(&self, other: &Self) -> Self;

    /// The smallest size.
    fn min_size(&self) -> f64;

    /// Whether `self` differs from `old` by more than rounding errors.
    fn is_news(&self, old: &Self) -> bool;
}

/// The eigenvalue `lambda = 1 / h^2` after its size has grown along an edge of length `l_metric` in the metric,
/// `l_euclid` in the plane and so `l_own = l_euclid / h` in that size. The growth factor is `(1 + l_metric ln
/// beta)^(1-t) (1 + l_own ln beta)^t` with t = 1/8, between a growth that preserves the shape of the unit ball (t = 0)
/// and one that makes it round (t = 1).
#[inline]
fn grown(lambda: f64, l_metric: f64, l_euclid: f64, ln_beta: f64) -> f64 {
    let (shape, round) = (1.0 + l_metric * ln_beta, 1.0 + lambda.sqrt() * l_euclid * ln_beta);
    // The eighth root is three square roots, which are the same on all systems.
    let eta = shape * (round / shape).sqrt().sqrt().sqrt();
    lambda / (eta * eta)
}

/// Changes below this fraction of the trace are not propagated.
const NEWS: f64 = 1e-9;

impl Gradable for Metric2 {
    type Point = DVec2;

    fn spanned(&self, d: DVec2, ln_beta: f64) -> Metric2 {
        let (l_metric, l_euclid) = (self.norm2(d).max(0.0).sqrt(), d.length());
        let (values, g) = self.eigen();
        Metric2::from_eigen(values.map(|lambda| grown(lambda, l_metric, l_euclid, ln_beta)), g)
    }

    fn intersect(&self, other: &Metric2) -> Metric2 {
        Metric2::intersect(self, other)
    }

    fn min_size(&self) -> f64 {
        Metric2::min_size(self)
    }

    fn is_news(&self, old: &Metric2) -> bool {
        let change = (self.uu - old.uu).abs() + (self.uv - old.uv).abs() + (self.vv - old.vv).abs();
        change > NEWS * (self.uu + self.vv)
    }
}

impl Gradable for Metric3 {
    type Point = DVec3;

    fn spanned(&self, d: DVec3, ln_beta: f64) -> Metric3 {
        let (l_metric, l_euclid) = (self.norm2(d).max(0.0).sqrt(), d.length());
        let (values, g) = self.eigen();
        Metric3::from_eigen(values.map(|lambda| grown(lambda, l_metric, l_euclid, ln_beta)), g)
    }

    fn intersect(&self, other: &Metric3) -> Metric3 {
        Metric3::intersect(self, other)
    }

    fn min_size(&self) -> f64 {
        Metric3::min_size(self)
    }

    fn is_news(&self, old: &Metric3) -> bool {
        let diagonal = (self.xx - old.xx).abs() + (self.yy - old.yy).abs() + (self.zz - old.zz).abs();
        let rest = (self.xy - old.xy).abs() + (self.xz - old.xz).abs() + (self.yz - old.yz).abs();
        diagonal + rest > NEWS * (self.xx + self.yy + self.zz)
    }
}

/// Bounds the gradation of nodal metrics along edges to `beta` (greater than 1): intersects each metric with the grown
/// metrics of its neighbours until nothing changes. Sizes only shrink. Nodes are processed in rounds, in the first
/// round by increasing size, and later rounds process only nodes that have changed. Returns the number of rounds, which
/// is bounded.
///
/// # Panics
/// If an edge names a node that does not exist, or the lengths differ (a programming error).
pub fn bound_gradation<M: Gradable>(points: &[M::Point], edges: &[[u32; 2]], metrics: &mut [M], beta: f64) -> usize {
    assert_eq!(points.len(), metrics.len(), "one metric for each node");
    assert!(beta > 1.0, "the gradation must exceed 1");
    let ln_beta = libm::log(beta);
    let (starts, neighbours) = neighbours(points.len(), edges);
    let mut served: Vec<u32> = (0..points.len() as u32).collect();
    let sizes: Vec<f64> = metrics.iter().map(Gradable::min_size).collect();
    served.sort_by(|&i, &j| sizes[i as usize].total_cmp(&sizes[j as usize]).then(i.cmp(&j)));
    let mut waits = vec![true; points.len()];
    let mut next = Vec::new();
    // In the worst case sizes propagate by one edge per round; the bound ends changes caused by rounding.
    let most_rounds = 64 + 8 * (points.len() as f64).sqrt() as usize;
    for round in 0..most_rounds {
        if served.is_empty() {
            return round;
        }
        for &i in &served {
            let i = i as usize;
            waits[i] = false;
            for &j in &neighbours[starts[i] as usize..starts[i + 1] as usize] {
                let asked = metrics[i].spanned(points[j as usize] - points[i], ln_beta);
                let old = metrics[j as usize];
                let new = old.intersect(&asked);
                if new.is_news(&old) {
                    metrics[j as usize] = new;
                    if !waits[j as usize] {
                        waits[j as usize] = true;
                        next.push(j);
                    }
                }
            }
        }
        served.clear();
        std::mem::swap(&mut served, &mut next);
    }
    most_rounds
}

/// The adjacency lists of the nodes: those of node i are `neighbours[starts[i]..starts[i + 1]]`.
fn neighbours(count: usize, edges: &[[u32; 2]]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; count + 1];
    for &[a, b] in edges {
        starts[a as usize + 1] += 1;
        starts[b as usize + 1] += 1;
    }
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    let mut fill = starts.clone();
    let mut neighbours = vec![0u32; 2 * edges.len()];
    for &[a, b] in edges {
        for (from, to) in [(a, b), (b, a)] {
            neighbours[fill[from as usize] as usize] = to;
            fill[from as usize] += 1;
        }
    }
    (starts, neighbours)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of nodes 0.1 apart, the first with size 0.01, the others with size 10.
    fn row(n: u32) -> (Vec<DVec2>, Vec<[u32; 2]>, Vec<Metric2>) {
        let points = (0..n).map(|i| DVec2::new(0.1 * f64::from(i), 0.0)).collect();
        let edges = (1..n).map(|i| [i - 1, i]).collect();
        let metrics = (0..n).map(|i| Metric2::isotropic(if i == 0 { 0.01 } else { 10.0 })).collect();
        (points, edges, metrics)
    }

    #[test]
    fn an_isotropic_row_grows_by_the_bound_from_edge_to_edge() {
        let (points, edges, mut metrics) = row(30);
        let rounds = bound_gradation(&points, &edges, &mut metrics, 1.3);
        assert!(rounds < 10, "{rounds}");
        let ln_beta = libm::log(1.3);
        let mut h = 0.01;
        for m in &metrics {
            assert!((m.min_size() - h).abs() < 1e-9 * h, "{} {h}", m.min_size());
            // Both lengths are |e| / h: the size grows by 1 + |e| ln(beta) / h.
            h = (h + 0.1 * ln_beta).min(10.0);
        }
    }

    #[test]
    fn sizes_only_shrink_and_every_edge_keeps_the_bound() {
        // A lattice with thin tensors of turning directions at some nodes.
        let n = 12;
        let at = |i: u32, j: u32| i * n + j;
        let mut points = Vec::new();
        let mut edges = Vec::new();
        for i in 0..n {
            for j in 0..n {
                points.push(DVec2::new(f64::from(i), f64::from(j)) * 0.3);
                if i > 0 {
                    edges.push([at(i - 1, j), at(i, j)]);
                }
                if j > 0 {
                    edges.push([at(i, j - 1), at(i, j)]);
                }
            }
        }
        let given: Vec<Metric2> = (0..n * n)
            .map(|k| {
                let turn = f64::from(k) * 0.7;
                let h = if k % 17 == 3 { [1e-3, 1.0] } else { [3.0, 5.0] };
                Metric2::from_sizes(h, DVec2::new(libm::cos(turn), libm::sin(turn))).unwrap()
            })
            .collect();
        let mut bounded = given.clone();
        bound_gradation(&points, &edges, &mut bounded, 1.5);
        assert!(bounded.iter().all(Metric2::is_spd));
        let probes: Vec<DVec2> = (0..16).map(|k| DVec2::from_angle(0.2 * f64::from(k))).collect();
        let covers = |m: &Metric2, other: &Metric2| {
            probes.iter().all(|&d| m.norm2(d) > other.norm2(d) * (1.0 - 1e-6) - 1e-9 * (m.uu + m.vv))
        };
        for (before, after) in given.iter().zip(&bounded) {
            assert!(covers(after, before));
        }
        for &[a, b] in &edges {
            for (i, j) in [(a as usize, b as usize), (b as usize, a as usize)] {
                let asked = bounded[i].spanned(points[j] - points[i], libm::log(1.5));
                assert!(covers(&bounded[j], &asked), "{i} {j}");
            }
        }
        let mut again = given.clone();
        bound_gradation(&points, &edges, &mut again, 1.5);
        assert_eq!(again, bounded);
        let mut twice = bounded.clone();
        bound_gradation(&points, &edges, &mut twice, 1.5);
        for (one, two) in bounded.iter().zip(&twice) {
            assert!((one.uu - two.uu).abs() + (one.vv - two.vv).abs() < 1e-6 * (one.uu + one.vv));
        }
    }

    #[test]
    fn space_and_plane_agree_on_planar_tensors() {
        let (points, edges, mut plane) = row(10);
        plane[4] = Metric2::from_sizes([0.003, 0.4], DVec2::new(1.0, 2.0)).unwrap();
        let mut space: Vec<Metric3> =
            plane.iter().map(|m| Metric3 { xx: m.uu, xy: m.uv, xz: 0.0, yy: m.vv, yz: 0.0, zz: 1.0 }).collect();
        let points3: Vec<DVec3> = points.iter().map(|p| p.extend(0.0)).collect();
        bound_gradation(&points, &edges, &mut plane, 1.3);
        bound_gradation(&points3, &edges, &mut space, 1.3);
        for (m2, m3) in plane.iter().zip(&space) {
            let d = (m2.uu - m3.xx).abs() + (m2.uv - m3.xy).abs() + (m2.vv - m3.yy).abs();
            assert!(d < 1e-6 * (m2.uu + m2.vv), "{m2:?} {m3:?}");
            assert!(m3.is_spd());
        }
    }
}
