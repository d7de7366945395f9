//! Symmetric positive definite tensors: the metric of the plane (eq. 3) and of space (eqs. 2, 11).
//!
//! This module has the types, their constructors and products; `spectrum` has what needs eigenvalues
//! (logarithms, intersection).

use glam::{DVec2, DVec3};

/// Largest ratio of two sizes in one tensor. Beyond it, a rotated tensor in double precision loses the larger size,
/// since the squares of the sizes differ too much.
pub const LARGEST_ANISOTROPY: f64 = 1e7;

/// Sizes beyond these bounds would overflow or underflow when squared and multiplied.
const SIZE_RANGE: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// A metric in the parametric plane: `M = [[uu, uv], [uv, vv]]` of eq. (3), units 1 / parametric length squared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric2 {
    /// M11.
    pub uu: f64,
    /// M12 = M21.
    pub uv: f64,
    /// M22.
    pub vv: f64,
}

/// A metric in space: the symmetric 3x3 tensor M3D of eq. (2), units 1 / length squared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric3 {
    /// M11.
    pub xx: f64,
    /// M12.
    pub xy: f64,
    /// M13.
    pub xz: f64,
    /// M22.
    pub yy: f64,
    /// M23.
    pub yz: f64,
    /// M33.
    pub zz: f64,
}

/// Refuses sizes that are not positive and finite, or whose ratio is too large; the names are those of eq. (11).
#[inline]
pub(in crate::core) fn check_sizes(h: &[f64]) -> Result<(), String> {
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0f64);
    for (i, &h_i) in h.iter().enumerate() {
        if !SIZE_RANGE.contains(&h_i) {
            let why = if h_i.is_nan() || h_i.is_infinite() {
                "is not finite"
            } else if h_i <= 0.0 {
                "is not positive"
            } else if h_i < 1.0 {
                "is too small"
            } else {
                "is too large"
            };
            return Err(format!("h{} = {h_i} {why}", i + 1));
        }
        (smallest, largest) = (smallest.min(h_i), largest.max(h_i));
    }
    if largest > LARGEST_ANISOTROPY * smallest {
        return Err(format!(
            "the sizes {smallest} and {largest} differ by a factor of more than {LARGEST_ANISOTROPY:e}"
        ));
    }
    Ok(())
}

/// Orthonormal directions by Gram-Schmidt: the first direction is kept, and so is the plane of the first two.
///
/// # Errors
/// A direction that is zero, not finite, or lies in the span of those before it; the names are those of eq. (11).
#[inline]
pub fn orthonormal(g: [DVec3; 3]) -> Result<[DVec3; 3], String> {
    let mut frame = [DVec3::ZERO; 3];
    for i in 0..3 {
        let length = g[i].length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(format!("g{} = ({}, {}, {}) is not a direction", i + 1, g[i].x, g[i].y, g[i].z));
        }
        let mut rest = g[i] / length;
        for e in &frame[..i] {
            rest -= rest.dot(*e) * *e;
        }
        let left = rest.length();
        if left < 1e-9 {
            let others = if i == 1 { "parallel to g1" } else { "in the plane of g1 and g2" };
            return Err(format!("g{} = ({}, {}, {}) is {others}", i + 1, g[i].x, g[i].y, g[i].z));
        }
        rest /= left;
        if left < 0.1 {
            // Orthogonalise again: the remainder was mostly rounding error.
            for e in &frame[..i] {
                rest -= rest.dot(*e) * *e;
            }
            rest = rest.normalize();
        }
        frame[i] = rest;
    }
    Ok(frame)
}

impl Metric2 {
    /// The same size `h` in all directions.
    #[inline]
    pub fn isotropic(h: f64) -> Metric2 {
        let lambda = 1.0 / (h * h);
        Metric2 { uu: lambda, uv: 0.0, vv: lambda }
    }

    /// Eq. (11) in the plane: size `h[0]` in the direction `g1`, which need not be a unit vector, `h[1]` across it.
    ///
    /// # Errors
    /// Sizes that are not positive and finite or whose ratio exceeds [`LARGEST_ANISOTROPY`]; a direction that is zero
    /// or not finite.
    #[inline]
    pub fn from_sizes(h: [f64; 2], g1: DVec2) -> Result<Metric2, String> {
        check_sizes(&h)?;
        let length = g1.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(format!("g1 = ({}, {}) is not a direction", g1.x, g1.y));
        }
        Ok(Metric2::from_eigen([1.0 / (h[0] * h[0]), 1.0 / (h[1] * h[1])], [g1 / length, (g1 / length).perp()]))
    }

    /// `sum of lambda_k g_k g_k^T` for orthonormal `g`.
    #[inline]
    pub fn from_eigen(lambda: [f64; 2], g: [DVec2; 2]) -> Metric2 {
        Metric2 {
            uu: lambda[0] * g[0].x * g[0].x + lambda[1] * g[1].x * g[1].x,
            uv: lambda[0] * g[0].x * g[0].y + lambda[1] * g[1].x * g[1].y,
            vv: lambda[0] * g[0].y * g[0].y + lambda[1] * g[1].y * g[1].y,
        }
    }

    /// Determinant.
    #[inline]
    pub fn det(&self) -> f64 {
        self.uu * self.vv - self.uv * self.uv
    }

    /// Whether it is finite and positive definite.
    #[inline]
    pub fn is_spd(&self) -> bool {
        let det = self.det();
        self.uu > 0.0 && self.vv > 0.0 && det > 0.0 && det.is_finite()
    }

    /// The metric of space that agrees with this one in the plane and has the geometric mean of its sizes across the
    /// plane.
    pub fn in_space(&self) -> Metric3 {
        Metric3 { xx: self.uu, xy: self.uv, xz: 0.0, yy: self.vv, yz: 0.0, zz: self.det().sqrt() }
    }

    /// `M d`.
    #[inline]
    pub fn times(&self, d: DVec2) -> DVec2 {
        DVec2::new(self.uu * d.x + self.uv * d.y, self.uv * d.x + self.vv * d.y)
    }

    /// Inner product `du^T M dv`.
    #[inline]
    pub fn inner(&self, du: DVec2, dv: DVec2) -> f64 {
        du.dot(self.times(dv))
    }

    /// Squared length `d^T M d`.
    #[inline]
    pub fn norm2(&self, d: DVec2) -> f64 {
        self.uu * d.x * d.x + 2.0 * self.uv * d.x * d.y + self.vv * d.y * d.y
    }

    /// All sizes multiplied by `size_factor` (positive).
    #[inline]
    #[must_use]
    pub fn scaled(&self, size_factor: f64) -> Metric2 {
        let s = 1.0 / (size_factor * size_factor);
        Metric2 { uu: s * self.uu, uv: s * self.uv, vv: s * self.vv }
    }
}

impl Metric3 {
    /// The same size `h` in all directions.
    #[inline]
    pub fn isotropic(h: f64) -> Metric3 {
        let lambda = 1.0 / (h * h);
        Metric3 { xx: lambda, xy: 0.0, xz: 0.0, yy: lambda, yz: 0.0, zz: lambda }
    }

    /// Eq. (11): size `h[k]` in the direction `g[k]`; the directions are made orthonormal by [`orthonormal`].
    ///
    /// # Errors
    /// Sizes that are not positive and finite or whose ratio exceeds [`LARGEST_ANISOTROPY`]; directions that are zero,
    /// not finite, parallel or coplanar.
    #[inline]
    pub fn from_sizes(h: [f64; 3], g: [DVec3; 3]) -> Result<Metric3, String> {
        check_sizes(&h)?;
        Ok(Metric3::from_eigen(h.map(|h| 1.0 / (h * h)), orthonormal(g)?))
    }

    /// `sum of lambda_k g_k g_k^T` for orthonormal `g`.
    #[inline]
    pub fn from_eigen(lambda: [f64; 3], g: [DVec3; 3]) -> Metric3 {
        let [a, b, c] = [lambda[0] * g[0], lambda[1] * g[1], lambda[2] * g[2]];
        Metric3 {
            xx: a.x * g[0].x + b.x * g[1].x + c.x * g[2].x,
            xy: a.x * g[0].y + b.x * g[1].y + c.x * g[2].y,
            xz: a.x * g[0].z + b.x * g[1].z + c.x * g[2].z,
            yy: a.y * g[0].y + b.y * g[1].y + c.y * g[2].y,
            yz: a.y * g[0].z + b.y * g[1].z + c.y * g[2].z,
            zz: a.z * g[0].z + b.z * g[1].z + c.z * g[2].z,
        }
    }

    /// Determinant.
    #[inline]
    pub fn det(&self) -> f64 {
        self.xx * (self.yy * self.zz - self.yz * self.yz) - self.xy * (self.xy * self.zz - self.yz * self.xz)
            + self.xz * (self.xy * self.yz - self.yy * self.xz)
    }

    /// Whether it is finite and positive definite.
    #[inline]
    pub fn is_spd(&self) -> bool {
        self.cholesky().is_some()
    }

    /// Whether z is a principal axis, as it is in planar domains.
    #[inline]
    pub fn is_planar(&self) -> bool {
        self.xz == 0.0 && self.yz == 0.0
    }

    /// The lower triangular factor L of `M = L L^T`; `None` if M is not positive definite and finite.
    #[inline]
    pub(in crate::core) fn cholesky(&self) -> Option<Lower3> {
        let xx = self.xx.sqrt();
        let (yx, zx) = (self.xy / xx, self.xz / xx);
        let yy = (self.yy - yx * yx).sqrt();
        let zy = (self.yz - zx * yx) / yy;
        let zz = (self.zz - zx * zx - zy * zy).sqrt();
        // The square root of a pivot that is not positive is NaN or zero, and an entry that is not finite reaches a
        // pivot.
        let positive = xx > 0.0 && yy > 0.0 && zz > 0.0;
        (positive && xx.is_finite() && yy.is_finite() && zz.is_finite()).then_some(Lower3 { xx, yx, yy, zx, zy, zz })
    }

    /// `M d`.
    #[inline]
    pub fn times(&self, d: DVec3) -> DVec3 {
        DVec3::new(
            self.xx * d.x + self.xy * d.y + self.xz * d.z,
            self.xy * d.x + self.yy * d.y + self.yz * d.z,
            self.xz * d.x + self.yz * d.y + self.zz * d.z,
        )
    }

    /// Inner product `du^T M dv`.
    #[inline]
    pub fn inner(&self, du: DVec3, dv: DVec3) -> f64 {
        du.dot(self.times(dv))
    }

    /// Squared length `d^T M d`.
    #[inline]
    pub fn norm2(&self, d: DVec3) -> f64 {
        self.inner(d, d)
    }

    /// All sizes multiplied by `size_factor` (positive).
    #[inline]
    #[must_use]
    pub fn scaled(&self, size_factor: f64) -> Metric3 {
        let s = 1.0 / (size_factor * size_factor);
        Metric3 { xx: s * self.xx, xy: s * self.xy, xz: s * self.xz, yy: s * self.yy, yz: s * self.yz, zz: s * self.zz }
    }

    /// Eq. (3): `J^T M3D J` with `J = [r_u r_v]`.
    #[inline]
    pub fn pull_back(&self, r_u: DVec3, r_v: DVec3) -> Metric2 {
        let m_v = self.times(r_v);
        Metric2 { uu: self.norm2(r_u), uv: r_u.dot(m_v), vv: r_v.dot(m_v) }
    }

    /// Eq. (3) in the plane, where J is the identity above a zero row.
    #[inline]
    pub fn plane(&self) -> Metric2 {
        Metric2 { uu: self.xx, uv: self.xy, vv: self.yy }
    }
}

/// A lower triangular 3x3 matrix.
#[derive(Clone, Copy, Debug)]
pub(in crate::core) struct Lower3 {
    pub xx: f64,
    pub yx: f64,
    pub yy: f64,
    pub zx: f64,
    pub zy: f64,
    pub zz: f64,
}

impl Lower3 {
    /// `L^-1 b`.
    #[inline]
    pub fn solve(&self, b: DVec3) -> DVec3 {
        let x = b.x / self.xx;
        let y = (b.y - self.yx * x) / self.yy;
        DVec3::new(x, y, (b.z - self.zx * x - self.zy * y) / self.zz)
    }

    /// `L b`.
    #[inline]
    pub fn times(&self, b: DVec3) -> DVec3 {
        DVec3::new(self.xx * b.x, self.yx * b.x + self.yy * b.y, self.zx * b.x + self.zy * b.y + self.zz * b.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DIAGONAL: [DVec3; 3] = [DVec3::new(-1.0, 1.0, 0.0), DVec3::new(3.0, 3.0, 0.0), DVec3::new(0.0, 0.0, 0.1)];

    #[test]
    fn eq_11_gives_each_size_along_its_direction() {
        let m = Metric3::from_sizes([0.1, 2.0, 5.0], DIAGONAL).unwrap();
        for (h, g) in [0.1, 2.0, 5.0].into_iter().zip(DIAGONAL) {
            assert!((m.norm2(h * g.normalize()) - 1.0).abs() < 1e-12);
        }
        assert!(m.is_spd() && m.is_planar());
        assert!((m.det() - 1.0).abs() < 1e-12);
        let plane = Metric2::from_sizes([0.1, 2.0], DVec2::new(-1.0, 1.0)).unwrap();
        assert!((m.plane().uu - plane.uu).abs() + (m.plane().uv - plane.uv).abs() < 1e-12);
    }

    #[test]
    fn directions_along_axes_give_diagonal_tensors_exactly() {
        let m = Metric3::from_sizes([0.5, 0.25, 2.0], [2.0 * DVec3::Y, -DVec3::X, DVec3::new(1.0, 5.0, 3.0)]).unwrap();
        assert_eq!(m, Metric3 { xx: 16.0, xy: 0.0, xz: 0.0, yy: 4.0, yz: 0.0, zz: 0.25 });
    }

    #[test]
    fn directions_are_made_orthonormal() {
        let g = orthonormal([DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 1.0 + 1e-7, 0.0), DVec3::new(1.0, 0.0, 1e-5)])
            .unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((g[i].dot(g[j]) - expected).abs() < 1e-14, "{i} {j}");
            }
        }
        assert!((g[0] - DVec3::new(1.0, 1.0, 0.0).normalize()).length() < 1e-15);
    }

    #[test]
    fn parallel_zero_and_infinite_directions_are_refused_by_name() {
        let unit = [DVec3::X, DVec3::Y, DVec3::Z];
        let refusal = |i: usize, g: DVec3| {
            let mut frame = unit;
            frame[i] = g;
            Metric3::from_sizes([1.0; 3], frame).unwrap_err()
        };
        assert!(refusal(1, DVec3::new(-3.0, 0.0, 0.0)).contains("g2 = (-3, 0, 0) is parallel to g1"));
        assert!(refusal(2, DVec3::new(1.0, 1.0, 0.0)).contains("g3 = (1, 1, 0) is in the plane of g1 and g2"));
        assert!(refusal(0, DVec3::ZERO).contains("g1"));
        assert!(refusal(1, DVec3::NAN).contains("g2"));
        assert!(refusal(2, DVec3::INFINITY).contains("g3"));
        assert!(Metric2::from_sizes([1.0, 1.0], DVec2::ZERO).unwrap_err().contains("g1"));
    }

    #[test]
    fn invalid_sizes_are_refused_by_name_and_value() {
        for (h, message) in [
            (0.0, "h2 = 0 is not positive"),
            (-0.5, "h2 = -0.5 is not positive"),
            (f64::NAN, "h2 = NaN is not finite"),
            (f64::INFINITY, "h2 = inf is not finite"),
            (f64::NEG_INFINITY, "h2 = -inf is not finite"),
            (1e-200, "is too small"),
            (1e200, "is too large"),
            (1e-8, "differ by a factor"),
        ] {
            let error = Metric3::from_sizes([1.0, h, 1.0], [DVec3::X, DVec3::Y, DVec3::Z]).unwrap_err();
            assert!(error.contains(message), "{error}");
            assert!(Metric2::from_sizes([1.0, h], DVec2::X).unwrap_err().contains(message));
        }
    }

    #[test]
    fn tensors_that_are_not_positive_definite_are_recognised() {
        let m = Metric2 { uu: 1.0, uv: 0.5, vv: 1.0 };
        assert!(m.is_spd());
        for bad in [
            Metric2 { uv: 1.0, ..m },
            Metric2 { uu: -1.0, vv: -1.0, ..m },
            Metric2 { uu: f64::NAN, ..m },
            Metric2 { uu: f64::INFINITY, ..m },
            Metric2 { uu: 0.0, uv: 0.0, ..m },
        ] {
            assert!(!bad.is_spd(), "{bad:?}");
        }
        let m = Metric3::isotropic(2.0);
        assert!(m.is_spd());
        for bad in [
            Metric3 { xy: 0.25, ..m },
            Metric3 { yz: 0.3, ..m },
            Metric3 { zz: -0.1, ..m },
            Metric3 { xx: f64::NAN, ..m },
            Metric3 { zz: f64::INFINITY, ..m },
            Metric3 { xz: f64::NAN, ..m },
        ] {
            assert!(!bad.is_spd(), "{bad:?}");
        }
    }

    proptest! {
        #[test]
        fn eq_3_measures_tangent_vectors_as_space_does(
            c in prop::array::uniform6(-2.0..2.0f64), d in prop::array::uniform2(-1.0..1.0f64), h in 0.01..3.0f64,
        ) {
            let (r_u, r_v) = (DVec3::new(c[0], c[1], c[2]), DVec3::new(c[3], c[4], c[5]));
            let m3 = Metric3::from_sizes([h, 0.5, 2.0], [DVec3::new(1.0, 2.0, 3.0), DVec3::X, DVec3::Y]).unwrap();
            let m2 = m3.pull_back(r_u, r_v);
            let in_space = m3.norm2(d[0] * r_u + d[1] * r_v);
            prop_assert!((m2.norm2(DVec2::from_array(d)) - in_space).abs() <= 1e-9 * in_space.max(1.0));
            prop_assert_eq!(m3.pull_back(DVec3::X, DVec3::Y), m3.plane());
        }

        #[test]
        fn scaling_multiplies_all_sizes(h in 0.01..10.0f64, ratio in 1.0..1e4f64, s in 0.01..100.0f64, t in 0.0..7.0f64) {
            let m = Metric2::from_sizes([h, h * ratio], DVec2::from_angle(t)).unwrap();
            let direct = Metric2::from_sizes([s * h, s * h * ratio], DVec2::from_angle(t)).unwrap();
            let scaled = m.scaled(s);
            let difference = (scaled.uu - direct.uu).abs() + (scaled.uv - direct.uv).abs() + (scaled.vv - direct.vv).abs();
            prop_assert!(difference < 1e-12 * (direct.uu + direct.vv));
        }
    }
}
