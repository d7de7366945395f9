//! Symmetric positive definite tensors: the metric of the plane (eq. 3) and of space (eqs. 2, 11).

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

impl Metric2 {
    /// d^T M d.
    #[inline]
    pub fn norm2(&self, d: glam::DVec2) -> f64 {
        self.inner(d, d)
    }
    /// a^T M b.
    #[inline]
    pub fn inner(&self, a: glam::DVec2, b: glam::DVec2) -> f64 {
        self.uu * a.x * b.x + self.uv * (a.x * b.y + a.y * b.x) + self.vv * a.y * b.y
    }
    /// Determinant.
    #[inline]
    pub fn det(&self) -> f64 {
        self.uu * self.vv - self.uv * self.uv
    }
    /// Positive definite.
    #[inline]
    pub fn is_spd(&self) -> bool {
        self.uu > 0.0 && self.det() > 0.0 && self.uu.is_finite() && self.vv.is_finite()
    }
    /// Smallest size.
    pub fn min_size(&self) -> f64 {
        let (m, r) = (0.5 * (self.uu + self.vv), 0.5 * (self.uu - self.vv));
        1.0 / (m + (r * r + self.uv * self.uv).sqrt()).sqrt()
    }
}
