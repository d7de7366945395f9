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
