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
mod tests;
