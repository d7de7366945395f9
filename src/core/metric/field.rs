//! Metric fields: what gives a tensor at a place (formula, uniform, table, boundary layer, intersection).

use glam::{DVec2, DVec3};

use super::tensor::Metric2;

/// A place where a metric is asked for: its point in space and its parametric coordinates (equal in the plane).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Point in space.
    pub xyz: DVec3,
    /// Parametric coordinates.
    pub uv: DVec2,
}

/// A field that yields no metric at some place: what is wrong and where.
#[derive(Clone, Debug, PartialEq)]
pub struct BadMetric {
    /// What is wrong ("h1 = -0.02 is not positive").
    pub what: String,
    /// Where.
    pub place: Place,
}

/// What the mesher and the converter ask: the metric of eq. (3) at parametric coordinates.
pub trait MetricSource {
    /// The metric at `uv`. A pure function: the same place gives the same bits.
    ///
    /// # Errors
    /// Where the field is not positive definite and finite there (boxed: the happy path is hot).
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>>;
}

/// One field as a case gives it; several are intersected.
#[derive(Clone, Debug, PartialEq)]
pub enum FieldSpec {
    /// The same size everywhere, in all directions.
    Uniform {
        /// Size.
        h: f64,
    },
    /// Formulas in x, y, z, u, v.
    Formula {
        /// Named helper expressions, each may use those before it.
        helpers: Vec<(String, String)>,
        /// h1, h2, h3; one alone (the others `None`) is isotropic.
        sizes: [Option<String>; 3],
        /// g1, g2, g3, three components each; what is not given is completed (in the plane g3 = z).
        directions: [Option<[String; 3]>; 3],
        /// Where it stands, for messages.
        place: String,
    },
    /// Distance to named curves: size `first` across them, growing by `growth` from row to row.
    BoundaryLayer {
        /// Names of curves.
        curves: Vec<String>,
        /// First height.
        first: f64,
        /// Ratio of a row's height to the one before, at least 1.
        growth: f64,
        /// Size along the curves; `None`: as large as the other fields allow.
        along: Option<f64>,
        /// Largest size that this field asks for across; `None`: as large as the other fields allow.
        far: Option<f64>,
        /// Where it stands, for messages.
        place: String,
    },
}
