//! What needs the eigenvalues of a tensor: sizes, roots, logarithms, log-Euclidean means, and intersection
//! (docs/algorithm.md, "Fields and their intersection").
//!
//! Both dimensions use Jacobi rotations: one in the plane, sweeps of three in space. They keep small eigenvalues of
//! nearly diagonal tensors accurate at any anisotropy, and give the same bits on every machine.

use glam::{DVec2, DVec3};

use super::tensor::{Metric2, Metric3};

/// Tangent of the Jacobi rotation that eliminates the entry `pq` of a symmetric matrix.
#[inline]
fn jacobi_tangent(pp: f64, pq: f64, qq: f64) -> f64 {
    let theta = (qq - pp) / (2.0 * pq);
    let t = 1.0 / (theta.abs() + (theta * theta + 1.0).sqrt());
    if theta < 0.0 { -t } else { t }
}

/// Eigenvalues in ascending order and unit eigenvectors of `[[uu, uv], [uv, vv]]`; the second eigenvector is the first
/// one rotated anticlockwise by a right angle.
#[inline]
fn eigen2(uu: f64, uv: f64, vv: f64) -> ([f64; 2], [DVec2; 2]) {
    let (mut values, mut first) = ([uu, vv], DVec2::X);
    if uv != 0.0 {
        let t = jacobi_tangent(uu, uv, vv);
        let c = 1.0 / (t * t + 1.0).sqrt();
        values = [uu - t * uv, vv + t * uv];
        first = DVec2::new(c, -t * c);
    }
    if values[0] <= values[1] {
        (values, [first, first.perp()])
    } else {
        ([values[1], values[0]], [first.perp(), -first])
    }
}

/// Eigenvalues in ascending order and orthonormal eigenvectors of a symmetric matrix `[xx, xy, xz, yy, yz, zz]`.
#[inline]
fn eigen3(m: [f64; 6]) -> ([f64; 3], [DVec3; 3]) {
    const SWEEPS: usize = 16;
    let mut a = [[m[0], m[1], m[2]], [m[1], m[3], m[4]], [m[2], m[4], m[5]]];
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        let mut turned = false;
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            let pq = a[p][q];
            // Relative to the diagonal, so that small eigenvalues of anisotropic tensors are accurate.
            if pq == 0.0 || pq * pq <= 1e-34 * (a[p][p] * a[q][q]).abs() {
                continue;
            }
            turned = true;
            let t = jacobi_tangent(a[p][p], pq, a[q][q]);
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            a[p][p] -= t * pq;
            a[q][q] += t * pq;
            (a[p][q], a[q][p]) = (0.0, 0.0);
            let (rp, rq) = (a[r][p], a[r][q]);
            a[r][p] = c * rp - s * rq;
            a[r][q] = s * rp + c * rq;
            (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
            for row in &mut v {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
        if !turned {
            break;
        }
    }
    let pair = |i: usize| (a[i][i], DVec3::new(v[0][i], v[1][i], v[2][i]));
    let mut pairs = [pair(0), pair(1), pair(2)];
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if pairs[j].0 < pairs[i].0 {
            pairs.swap(i, j);
        }
    }
    (pairs.map(|p| p.0), pairs.map(|p| p.1))
}

/// The logarithm of a metric: the entries of a symmetric matrix, which may be added and scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogMetric<const N: usize>(pub [f64; N]);

/// The logarithm of a metric of the plane: `[uu, uv, vv]`.
pub type LogMetric2 = LogMetric<3>;

/// The logarithm of a metric of space: `[xx, xy, xz, yy, yz, zz]`.
pub type LogMetric3 = LogMetric<6>;

impl<const N: usize> LogMetric<N> {
    /// The logarithm of the unit tensor.
    pub const ZERO: Self = LogMetric([0.0; N]);

    /// `self + weight * other`.
    #[inline]
    #[must_use]
    pub fn plus(&self, weight: f64, other: &Self) -> Self {
        LogMetric(std::array::from_fn(|i| self.0[i] + weight * other.0[i]))
    }

    /// The logarithm `sum of w_i ln M_i` of the log-Euclidean mean (docs/algorithm.md, "Metric at new places"); the
    /// weights should add to one.
    #[inline]
    pub fn log_euclidean<'a>(terms: impl IntoIterator<Item = (f64, &'a Self)>) -> Self {
        terms.into_iter().fold(Self::ZERO, |sum, (weight, logarithm)| sum.plus(weight, logarithm))
    }
}

impl LogMetric2 {
    /// The metric of this logarithm.
    #[inline]
    pub fn exp(&self) -> Metric2 {
        let (values, g) = eigen2(self.0[0], self.0[1], self.0[2]);
        Metric2::from_eigen(values.map(libm::exp), g)
    }
}

impl LogMetric3 {
    /// The metric of this logarithm.
    #[inline]
    pub fn exp(&self) -> Metric3 {
        let (values, g) = eigen3(self.0);
        Metric3::from_eigen(values.map(libm::exp), g)
    }
}

impl Metric2 {
    /// Eigenvalues `1/h^2` in ascending order and unit eigenvectors, the second a right angle anticlockwise from the
    /// first.
    #[inline]
    pub fn eigen(&self) -> ([f64; 2], [DVec2; 2]) {
        let (mut values, g) = eigen2(self.uu, self.uv, self.vv);
        // Rounding may have lost the smaller one of a very anisotropic tensor.
        values[0] = values[0].max(values[1] * f64::EPSILON);
        (values, g)
    }

    /// Eigenvalues of the pair (M, g) in ascending order: `1/h^2` of the sizes in space on a surface with the first
    /// fundamental form `g`; and the directions of these sizes in its parameters, of unit length in space.
    pub fn eigen_against(&self, g: &Metric2) -> ([f64; 2], [DVec2; 2]) {
        let p = g.unit_basis();
        let (values, q) = self.eigen_in(p);
        (values, q.map(|q| p[0] * q.x + p[1] * q.y))
    }

    /// An orthonormal basis of this metric: the columns of `L^-T`, where `L L^T` is this tensor.
    #[inline]
    fn unit_basis(&self) -> [DVec2; 2] {
        let l_uu = self.uu.sqrt();
        let l_vv = self.det().sqrt() / l_uu;
        [DVec2::new(1.0 / l_uu, 0.0), DVec2::new(-(self.uv / l_uu) / (l_uu * l_vv), 1.0 / l_vv)]
    }

    /// Eigenvalues and eigenvectors of this tensor in a basis.
    #[inline]
    fn eigen_in(&self, p: [DVec2; 2]) -> ([f64; 2], [DVec2; 2]) {
        let m_p1 = self.times(p[1]);
        eigen2(self.norm2(p[0]), p[0].dot(m_p1), p[1].dot(m_p1))
    }

    /// The smallest size in any direction: `1 / sqrt(largest eigenvalue)`, as in eq. (6).
    #[inline]
    pub fn min_size(&self) -> f64 {
        let half_difference = 0.5 * (self.uu - self.vv);
        let largest = 0.5 * (self.uu + self.vv) + (half_difference * half_difference + self.uv * self.uv).sqrt();
        1.0 / largest.sqrt()
    }

    /// The smallest size in any direction of a surface with the first fundamental form `g`: `1 / sqrt` of the largest
    /// eigenvalue of the pair (M, g), which does not depend on the parametrisation.
    #[inline]
    pub fn min_size_against(&self, g: &Metric2) -> f64 {
        let det = g.det();
        let half_trace = 0.5 * (g.vv * self.uu - 2.0 * g.uv * self.uv + g.uu * self.vv) / det;
        let largest = half_trace + (half_trace * half_trace - self.det() / det).max(0.0).sqrt();
        1.0 / largest.sqrt()
    }

    /// The symmetric square root: the map under which lengths in the metric become ordinary lengths.
    #[inline]
    #[must_use]
    pub fn sqrt(&self) -> Metric2 {
        // By Cayley-Hamilton, M + sqrt(det) I = (trace of the root) * root.
        let root_det = self.det().max(0.0).sqrt();
        let trace = (self.uu + self.vv + 2.0 * root_det).sqrt();
        Metric2 { uu: (self.uu + root_det) / trace, uv: self.uv / trace, vv: (self.vv + root_det) / trace }
    }

    /// The matrix logarithm.
    #[inline]
    pub fn ln(&self) -> LogMetric2 {
        let (values, g) = self.eigen();
        let m = Metric2::from_eigen(values.map(libm::log), g);
        LogMetric([m.uu, m.uv, m.vv])
    }

    /// The intersection of two metrics (docs/algorithm.md, "Fields and their intersection"): the largest unit ball, by
    /// simultaneous reduction, that lies in both.
    ///
    /// With `a = L L^T` the reduction diagonalises `S = L^-1 b L^-T`. Equal and proportional metrics are no special
    /// case, since any basis diagonalises a multiple of the unit tensor. If one unit ball lies in the other, its metric
    /// is returned bit for bit. If rounding has left `a` not positive definite, the result is `b`.
    #[inline]
    #[must_use]
    pub fn intersect(a: &Metric2, b: &Metric2) -> Metric2 {
        let det = a.det();
        if !(a.uu > 0.0 && det > 0.0) {
            return *b;
        }
        let l_uu = a.uu.sqrt();
        let l_vu = a.uv / l_uu;
        let l_vv = det.sqrt() / l_uu;
        let (s, q) = b.eigen_in(a.unit_basis());
        if s[1] <= 1.0 {
            return *a;
        }
        if s[0] >= 1.0 {
            return *b;
        }
        // L max(1, s) L^T differs from `a` only in the direction in which `b` asks for smaller sizes.
        let w = DVec2::new(l_uu * q[1].x, l_vu * q[1].x + l_vv * q[1].y);
        let more = s[1] - 1.0;
        Metric2 { uu: a.uu + more * w.x * w.x, uv: a.uv + more * w.x * w.y, vv: a.vv + more * w.y * w.y }
    }
}

impl Metric3 {
    #[inline]
    fn entries(&self) -> [f64; 6] {
        [self.xx, self.xy, self.xz, self.yy, self.yz, self.zz]
    }

    /// Eigenvalues `1/h^2` in ascending order and orthonormal eigenvectors.
    #[inline]
    pub fn eigen(&self) -> ([f64; 3], [DVec3; 3]) {
        let (values, g) = eigen3(self.entries());
        (values.map(|value| value.max(values[2] * f64::EPSILON)), g)
    }

    /// The smallest size in any direction: `1 / sqrt(largest eigenvalue)`, as in eq. (6).
    #[inline]
    pub fn min_size(&self) -> f64 {
        1.0 / self.eigen().0[2].sqrt()
    }

    /// The symmetric square root: the map under which lengths in the metric become ordinary lengths.
    #[inline]
    #[must_use]
    pub fn sqrt(&self) -> Metric3 {
        let (values, g) = self.eigen();
        Metric3::from_eigen(values.map(f64::sqrt), g)
    }

    /// The matrix logarithm.
    #[inline]
    pub fn ln(&self) -> LogMetric3 {
        let (values, g) = self.eigen();
        LogMetric(Metric3::from_eigen(values.map(libm::log), g).entries())
    }

    /// The intersection of two metrics; see [`Metric2::intersect`].
    #[inline]
    #[must_use]
    pub fn intersect(a: &Metric3, b: &Metric3) -> Metric3 {
        if a.is_planar() && b.is_planar() {
            let m = Metric2::intersect(&a.plane(), &b.plane());
            return Metric3 { xx: m.uu, xy: m.uv, xz: 0.0, yy: m.vv, yz: 0.0, zz: a.zz.max(b.zz) };
        }
        let Some(l) = a.cholesky() else { return *b };
        let y = [
            l.solve(DVec3::new(b.xx, b.xy, b.xz)),
            l.solve(DVec3::new(b.xy, b.yy, b.yz)),
            l.solve(DVec3::new(b.xz, b.yz, b.zz)),
        ];
        let s_x = l.solve(DVec3::new(y[0].x, y[1].x, y[2].x));
        let s_y = l.solve(DVec3::new(y[0].y, y[1].y, y[2].y));
        let s_z = l.solve(DVec3::new(y[0].z, y[1].z, y[2].z));
        let (s, q) = eigen3([s_x.x, s_x.y, s_x.z, s_y.y, s_y.z, s_z.z]);
        if s[2] <= 1.0 {
            return *a;
        }
        if s[0] >= 1.0 {
            return *b;
        }
        let mut m = *a;
        for k in 0..3 {
            if s[k] > 1.0 {
                m = m.plus_dyad(s[k] - 1.0, l.times(q[k]));
            }
        }
        m
    }

    /// The intersection with a slab: the size along the unit vector `n` becomes at most `h`; other directions are not
    /// constrained.
    ///
    /// The unit ball reaches `sqrt(n^T M^-1 n)` along n; adding a multiple of `n n^T` cuts it back to `h` and changes
    /// nothing else.
    #[inline]
    #[must_use]
    pub fn intersect_slab(&self, n: DVec3, h: f64) -> Metric3 {
        let Some(l) = self.cholesky() else { return *self };
        let more = 1.0 / (h * h) - 1.0 / l.solve(n).length_squared();
        if more > 0.0 { self.plus_dyad(more, n) } else { *self }
    }

    /// `M + s w w^T`.
    #[inline]
    fn plus_dyad(&self, s: f64, w: DVec3) -> Metric3 {
        let sw = s * w;
        Metric3 {
            xx: self.xx + sw.x * w.x,
            xy: self.xy + sw.x * w.y,
            xz: self.xz + sw.x * w.z,
            yy: self.yy + sw.y * w.y,
            yz: self.yz + sw.y * w.z,
            zz: self.zz + sw.z * w.z,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn metric2() -> impl Strategy<Value = Metric2> {
        (-3.0..3.0f64, 0.0..4.0f64, 0.0..7.0f64).prop_map(|(log_h, log_ratio, turn)| {
            let h = libm::pow(10.0, log_h);
            Metric2::from_sizes([h, h * libm::pow(10.0, log_ratio)], DVec2::from_angle(turn)).unwrap()
        })
    }

    /// Tensors of space with anisotropy up to 1e4; every third is planar.
    fn metric3() -> impl Strategy<Value = Metric3> {
        let numbers = prop::array::uniform6(-1.0..1.0f64);
        (-3.0..3.0f64, 0.0..4.0f64, 0.0..4.0f64, numbers, 0..3).prop_filter_map("directions", |(h, r1, r2, c, kind)| {
            let h = libm::pow(10.0, h);
            let sizes = [h, h * libm::pow(10.0, r1), h * libm::pow(10.0, r2)];
            let flat = if kind == 0 { 0.0 } else { 1.0 };
            let g1 = DVec3::new(c[0], c[1], flat * c[2]);
            let g2 = DVec3::new(c[3], c[4], flat * c[5]);
            if g1.cross(g2).length() < 0.01 { None } else { Metric3::from_sizes(sizes, [g1, g2, g1.cross(g2)]).ok() }
        })
    }

    fn close2(a: &Metric2, b: &Metric2, tolerance: f64) -> bool {
        let d = (a.uu - b.uu).abs() + (a.uv - b.uv).abs() + (a.vv - b.vv).abs();
        d <= tolerance * (a.uu + a.vv)
    }

    fn close3(a: &Metric3, b: &Metric3, tolerance: f64) -> bool {
        let d: f64 = a.entries().iter().zip(b.entries()).map(|(x, y)| (x - y).abs()).sum();
        d <= tolerance * (a.xx + a.yy + a.zz)
    }

    fn probes3() -> impl Iterator<Item = DVec3> {
        (0..60).map(|k| {
            let (t, z) = (2.4 * f64::from(k), (f64::from(k) + 0.5) / 60.0);
            (DVec2::from_angle(t) * (1.0 - z * z).sqrt()).extend(z)
        })
    }

    #[test]
    fn eigenvalues_ascend_and_degenerate_tensors_have_a_frame() {
        let (values, g) = Metric2::isotropic(0.5).eigen();
        assert_eq!((values, g), ([4.0, 4.0], [DVec2::X, DVec2::Y]));
        let (values, g) = Metric2 { uu: 9.0, uv: 0.0, vv: 1.0 }.eigen();
        assert_eq!((values, g), ([1.0, 9.0], [DVec2::Y, DVec2::NEG_X]));
        let (values, g) = Metric3 { xx: 9.0, xy: 0.0, xz: 0.0, yy: 1.0, yz: 0.0, zz: 4.0 }.eigen();
        assert_eq!((values, g), ([1.0, 4.0, 9.0], [DVec3::Y, DVec3::Z, DVec3::X]));
    }

    #[test]
    fn small_eigenvalues_of_nearly_diagonal_tensors_are_accurate() {
        let m = Metric2 { uu: 1e12, uv: 1e3, vv: 3.0 };
        assert!((m.eigen().0[0] - (3.0 - 1e-6)).abs() < 1e-14 * 3.0);
    }

    #[test]
    fn the_smallest_size_against_a_form_does_not_depend_on_the_parameters() {
        // Sizes 0.02 and 0.5 in space; parameters sheared and stretched by J, M = J^T M3D J, G = J^T J.
        let m = Metric2::from_sizes([0.02, 0.5], DVec2::new(0.3, 1.0)).unwrap();
        let (a, b) = (DVec2::new(40.0, 3.0), DVec2::new(-0.2, 0.07));
        let pulled = Metric2 { uu: m.norm2(a), uv: m.inner(a, b), vv: m.norm2(b) };
        let form = Metric2 { uu: a.dot(a), uv: a.dot(b), vv: b.dot(b) };
        assert!((pulled.min_size_against(&form) - 0.02).abs() < 1e-12);
        let (values, directions) = pulled.eigen_against(&form);
        let sizes = values.map(|value| 1.0 / value.sqrt());
        assert!((sizes[0] - 0.5).abs() < 1e-12 && (sizes[1] - 0.02).abs() < 1e-12, "{sizes:?}");
        // In space the smaller size runs along (0.3, 1).
        let small = a * directions[1].x + b * directions[1].y;
        assert!((small.length() - 1.0).abs() < 1e-12);
        assert!(small.perp_dot(DVec2::new(0.3, 1.0).normalize()).abs() < 1e-12);
        assert!((m.min_size_against(&Metric2::isotropic(1.0)) - m.min_size()).abs() < 1e-15);
    }

    #[test]
    fn min_size_is_the_smallest_size() {
        let m = Metric2::from_sizes([0.02, 3.0], DVec2::new(1.0, 2.0)).unwrap();
        assert!((m.min_size() - 0.02).abs() < 1e-15);
        let m = Metric3::from_sizes([7.0, 0.02, 3.0], [DVec3::ONE, DVec3::X, DVec3::Y]).unwrap();
        assert!((m.min_size() - 0.02).abs() < 1e-15);
    }

    #[test]
    fn log_euclidean_mean_of_sizes_is_geometric() {
        let logarithms = [0.1, 0.4].map(|h| Metric2::isotropic(h).ln());
        let mean = LogMetric::log_euclidean([0.5, 0.5].into_iter().zip(&logarithms)).exp();
        assert!((mean.min_size() - 0.2).abs() < 1e-15);
        let m = Metric3::from_sizes([0.1, 1.0, 2.0], [DVec3::ONE, DVec3::X, DVec3::Y]).unwrap();
        let same = [m.ln(); 3];
        assert!(close3(&LogMetric::log_euclidean([0.2, 0.3, 0.5].into_iter().zip(&same)).exp(), &m, 1e-13));
        assert_eq!(LogMetric2::ZERO.exp(), Metric2::isotropic(1.0));
        assert_eq!(LogMetric3::ZERO.exp(), Metric3::isotropic(1.0));
    }

    #[test]
    fn intersections_of_contained_and_proportional_metrics_are_exact() {
        let thin = Metric2::from_sizes([1e-4, 1.0], DVec2::new(1.0, 0.3)).unwrap();
        assert_eq!(Metric2::intersect(&thin, &thin.scaled(0.5)), thin.scaled(0.5));
        assert_eq!(Metric2::intersect(&thin, &thin.scaled(2.0)), thin);
        assert_eq!(Metric2::intersect(&thin, &Metric2::isotropic(5.0)), thin);
        assert_eq!(Metric2::intersect(&Metric2::isotropic(5.0), &thin), thin);
        let thin = Metric3::from_sizes([1e-4, 1.0, 1.0], [DVec3::ONE, DVec3::X, DVec3::Y]).unwrap();
        assert_eq!(Metric3::intersect(&thin, &thin.scaled(0.5)), thin.scaled(0.5));
        assert_eq!(Metric3::intersect(&Metric3::isotropic(5.0), &thin), thin);
        assert!(close2(&Metric2::intersect(&thin.plane(), &thin.plane()), &thin.plane(), 1e-12));
    }

    #[test]
    fn the_intersection_of_crossing_strips_is_their_square() {
        let x = Metric2::from_sizes([1e-4, 1.0], DVec2::X).unwrap();
        let y = Metric2::from_sizes([1e-4, 1.0], DVec2::Y).unwrap();
        assert!(close2(&Metric2::intersect(&x, &y), &Metric2::isotropic(1e-4), 1e-12));
        let space = |m: Metric2| Metric3 { xx: m.uu, xy: m.uv, xz: 0.0, yy: m.vv, yz: 0.0, zz: 1.0 };
        let tilted = Metric3::from_sizes([1e-4, 1.0, 1.0], [DVec3::Y, DVec3::X, DVec3::Z]).unwrap();
        assert!(close3(&Metric3::intersect(&space(x), &tilted), &space(Metric2::isotropic(1e-4)), 1e-12));
    }

    #[test]
    fn a_slab_cuts_back_one_size_and_no_other() {
        let m = Metric3::isotropic(1.0);
        let n = DVec3::new(0.6, 0.8, 0.0);
        let cut = m.intersect_slab(n, 1e-3);
        assert!((cut.norm2(n) - 1e6).abs() < 1e-6);
        assert!((cut.norm2(DVec3::new(-0.8, 0.6, 0.0)) - 1.0).abs() < 1e-9);
        assert_eq!(m.intersect_slab(n, 2.0), m);
        // The ball of a thin tensor reaches far along n only askew; it is cut where it leaves the slab, and no earlier.
        let thin = Metric3::from_sizes([0.01, 1.0, 1.0], [DVec3::X, DVec3::Y, DVec3::Z]).unwrap();
        let reach = (0.36 * 1e-4 + 0.64f64).sqrt();
        assert_eq!(thin.intersect_slab(n, reach * 1.001), thin);
        assert!(thin.intersect_slab(n, reach * 0.999).norm2(n) > thin.norm2(n));
    }

    proptest! {
        #[test]
        fn eigen_rebuilds_the_tensor(m2 in metric2(), m3 in metric3()) {
            let (values, g) = m2.eigen();
            prop_assert!(values[0] <= values[1]);
            prop_assert!((g[0].length() - 1.0).abs() < 1e-14 && (g[0].perp() - g[1]).length() < 1e-14);
            prop_assert!(close2(&Metric2::from_eigen(values, g), &m2, 1e-14));
            let (values, g) = m3.eigen();
            prop_assert!(values[0] <= values[1] && values[1] <= values[2]);
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                prop_assert!(g[i].dot(g[j]).abs() < 1e-14);
            }
            prop_assert!(close3(&Metric3::from_eigen(values, g), &m3, 1e-14));
        }

        #[test]
        fn exp_takes_ln_back_and_sqrt_squares(m2 in metric2(), m3 in metric3()) {
            prop_assert!(close2(&m2.ln().exp(), &m2, 1e-12));
            prop_assert!(close3(&m3.ln().exp(), &m3, 1e-12));
            let (s, t) = (m2.sqrt(), m3.sqrt());
            let squared = Metric2 { uu: s.uu * s.uu + s.uv * s.uv, uv: s.uv * (s.uu + s.vv), vv: s.uv * s.uv + s.vv * s.vv };
            prop_assert!(close2(&squared, &m2, 1e-12));
            for d in probes3() {
                prop_assert!((t.times(d).length_squared() - m3.norm2(d)).abs() < 1e-12 * (m3.xx + m3.yy + m3.zz));
            }
        }

        #[test]
        fn the_intersection_covers_both_and_no_more_than_it_must(a in metric2(), b in metric2()) {
            let m = Metric2::intersect(&a, &b);
            prop_assert!(m.is_spd());
            let slack = 1e-12 * (m.uu + m.vv);
            for k in 0..60 {
                let d = DVec2::from_angle(0.053 * f64::from(k));
                let needed = a.norm2(d).max(b.norm2(d));
                prop_assert!(m.norm2(d) >= needed * (1.0 - 1e-7) - slack, "{} {needed}", m.norm2(d));
                prop_assert!(m.norm2(d) <= (a.norm2(d) + b.norm2(d)) * (1.0 + 1e-7) + slack);
            }
            prop_assert!(close2(&Metric2::intersect(&b, &a), &m, 1e-6));
        }

        #[test]
        fn the_intersection_in_space_covers_both(a in metric3(), b in metric3()) {
            let m = Metric3::intersect(&a, &b);
            prop_assert!(m.is_spd());
            let slack = 1e-12 * (m.xx + m.yy + m.zz);
            for d in probes3() {
                let needed = a.norm2(d).max(b.norm2(d));
                prop_assert!(m.norm2(d) >= needed * (1.0 - 1e-6) - slack, "{} {needed}", m.norm2(d));
                prop_assert!(m.norm2(d) <= (a.norm2(d) + b.norm2(d)) * (1.0 + 1e-6) + slack);
            }
        }

        #[test]
        fn nearly_equal_metrics_intersect_to_themselves(a in metric2(), e in prop::array::uniform3(-1e-14..1e-14f64)) {
            let b = Metric2 { uu: a.uu * (1.0 + e[0]), uv: a.uv * (1.0 + e[1]), vv: a.vv * (1.0 + e[2]) };
            // The oblique reduction amplifies the perturbation.
            prop_assert!(close2(&Metric2::intersect(&a, &b), &a, 1e-10));
        }
    }
}
