//! Metric fields: what gives a tensor at a place (formula, uniform, table, about curves, by curvature, intersection), and on
//! surfaces its pull-back (eq. 3).

mod by_formula;

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::boundary_layer::{BoundaryLayer, Distance};
use super::curvature::Curvature;
use super::place::MetricPlace;
use super::table::Table;
use crate::core::fault::{Fault, FaultKind};
use crate::core::geometry::atlas::Atlas;
use crate::core::geometry::domain::Line;
use crate::core::kernel::tensor::{LARGEST_ANISOTROPY, Metric2, Metric3, check_sizes};
use by_formula::FormulaField;

/// A field that yields no metric at some place: what is wrong and where.
#[derive(Clone, Debug, PartialEq)]
pub struct BadMetric {
    /// What is wrong ("h1 = -0.02 is not positive").
    pub what: String,
    /// Where.
    pub place: MetricPlace,
}

impl From<Box<BadMetric>> for Fault {
    fn from(bad: Box<BadMetric>) -> Fault {
        let (p, uv) = (bad.place.xyz, bad.place.uv);
        let place = if p.truncate() == uv && p.z == 0.0 {
            format!("({}, {})", p.x, p.y)
        } else {
            format!("({}, {}, {}), u = {}, v = {}", p.x, p.y, p.z, uv.x, uv.y)
        };
        let fault = Fault::new(bad.what).of_kind(FaultKind::Metric).at(place);
        fault.remedy("The metric must be positive and finite on the whole domain")
    }
}

/// What the mesher and the converter ask: the metric of eq. (3) at parametric coordinates.
pub trait MetricSource {
    /// The metric at `uv`. A pure function: the same place gives the same bits.
    ///
    /// # Errors
    /// Where the field is not positive definite and finite there (boxed: the happy path is hot).
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>>;
}

impl<T: MetricSource + ?Sized> MetricSource for &T {
    #[inline]
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
        (**self).metric(uv)
    }
}

impl<T: MetricSource + ?Sized> MetricSource for Arc<T> {
    #[inline]
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
        (**self).metric(uv)
    }
}

/// One field as a case gives it; several are intersected.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a case has a handful of them")]
#[non_exhaustive]
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
    /// The same size in all directions: `first` on named curves, growing by `growth` from row to row up to `far`.
    Distance {
        /// Names of curves.
        curves: Vec<String>,
        /// Size on the curves.
        first: f64,
        /// Ratio of a row's height to the one before, at least 1.
        growth: f64,
        /// Largest size.
        far: f64,
        /// Where it stands, for messages.
        place: String,
    },
    /// Sizes by the curvature of the surface: chords stay within a part of the radius from it (see `curvature`).
    Curvature {
        /// Distance of a chord from its arc, as a part of the radius.
        chord: f64,
        /// Smallest size that it asks for.
        least: f64,
        /// Size where the surface is flat.
        far: f64,
        /// Where it stands, for messages.
        place: String,
    },
}

/// One compiled field.
#[derive(Clone, Debug)]
pub struct Field(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Uniform(Metric3),
    Formula(Box<FormulaField>),
    BoundaryLayer(Box<BoundaryLayer>, String),
    Distance(Box<Distance>, String),
    Curvature(Curvature),
    Table(Box<Table>),
}

impl Field {
    /// Compiles a field; `curves` gives a fine polyline of a named curve.
    ///
    /// Of a formula's directions, one of g1 and g2 alone is completed in the plane (g3 = z), two by their cross product, none by
    /// the coordinate axes; without h3 it is the larger of h1 and h2, which in the plane has no effect.
    ///
    /// # Errors
    /// A size that is no size, a formula that does not compile or leaves too much open, an unknown curve; the place of
    /// the specification goes into the fault.
    pub fn compile(spec: &FieldSpec, curves: &dyn Fn(&str) -> Option<Line>) -> Result<Field, Fault> {
        Field::kind(spec, curves).map(Field).map_err(|fault| fault.of_kind(FaultKind::Metric))
    }

    fn kind(spec: &FieldSpec, curves: &dyn Fn(&str) -> Option<Line>) -> Result<Kind, Fault> {
        let lines = |names: &[String], field: &str, place: &String| -> Result<Vec<Line>, Fault> {
            let line = |name: &String| {
                curves(name).ok_or_else(|| {
                    at(Fault::new(format!("The {field} names a curve \"{name}\" that is not there")), place)
                })
            };
            names.iter().map(line).collect()
        };
        Ok(match spec {
            FieldSpec::Uniform { h } => {
                check_sizes(&[*h]).map_err(|what| Fault::new(what.replace("h1", "h")))?;
                Kind::Uniform(Metric3::isotropic(*h))
            }
            FieldSpec::Formula { helpers, sizes, directions, place } => {
                let field = FormulaField::compile(helpers, sizes, directions, place);
                Kind::Formula(Box::new(field.map_err(|fault| at(fault, place))?))
            }
            FieldSpec::BoundaryLayer { curves: names, first, growth, along, far, place } => {
                let lines = lines(names, "boundary layer", place)?;
                let layer = BoundaryLayer::new(&lines, *first, *growth, *along, *far);
                Kind::BoundaryLayer(Box::new(layer.map_err(|fault| at(fault, place))?), place.clone())
            }
            FieldSpec::Distance { curves: names, first, growth, far, place } => {
                let field = Distance::new(&lines(names, "distance", place)?, *first, *growth, *far);
                Kind::Distance(Box::new(field.map_err(|fault| at(fault, place))?), place.clone())
            }
            FieldSpec::Curvature { chord, least, far, place } => {
                let field = Curvature::new(*chord, *least, *far);
                Kind::Curvature(field.map_err(|fault| at(fault, place))?)
            }
        })
    }

    /// A field by a table at the nodes of a triangle mesh in the parametric plane, log-Euclidean between them (spec 2.1.1);
    /// outside the mesh, the value at its nearest point.
    ///
    /// # Errors
    /// Lengths that differ, indices out of range, a triangle without area, a metric that is not positive definite.
    pub fn table(points: &[DVec2], triangles: &[[u32; 3]], metrics: Vec<Metric3>) -> Result<Field, Fault> {
        let table = Table::new(points, triangles, &metrics).map_err(|fault| fault.of_kind(FaultKind::Metric))?;
        Ok(Field(Kind::Table(Box::new(table))))
    }

    /// Whether it gives a tensor of itself; a boundary layer without a size along its curves only cuts back others.
    fn is_tensor(&self) -> bool {
        !matches!(&self.0, Kind::BoundaryLayer(layer, _) if !layer.is_tensor())
    }

    /// The field's metric at a place, intersected with that of the fields before it.
    #[inline]
    fn intersect(&self, others: Option<Metric3>, place: &MetricPlace) -> Result<Metric3, Box<BadMetric>> {
        let m = match &self.0 {
            Kind::Uniform(m) => *m,
            Kind::Formula(field) => field.metric(place)?,
            Kind::Table(table) => table.metric(place.chart).ok_or_else(|| nowhere(place, ""))?,
            Kind::BoundaryLayer(layer, origin) => {
                return layer.intersect(others, place.uv, place.xyz).ok_or_else(|| nowhere(place, origin));
            }
            Kind::Distance(field, origin) => field.metric(place.uv, place.xyz).ok_or_else(|| nowhere(place, origin))?,
            Kind::Curvature(field) => field.metric(place.bend.as_ref()),
        };
        Ok(others.map_or(m, |others| Metric3::intersect(&others, &m)))
    }
}

/// A fault at a place that may be unknown.
fn at(fault: Fault, place: &str) -> Fault {
    if place.is_empty() { fault } else { fault.at(place) }
}

/// What is wrong with a metric and where; `origin` is where its field stands.
#[cold]
fn bad(what: String, origin: &str, place: &MetricPlace) -> Box<BadMetric> {
    let what = if origin.is_empty() { what } else { format!("{what} ({origin})") };
    Box::new(BadMetric { what, place: *place })
}

#[cold]
fn nowhere(place: &MetricPlace, origin: &str) -> Box<BadMetric> {
    bad("a metric is asked for where the coordinates are not finite".into(), origin, place)
}

/// The metric of a case: the intersection of its fields with all sizes multiplied by one factor; on surfaces the pull-back of
/// that to the plane in which they are meshed.
#[derive(Clone, Debug)]
pub struct Sizing {
    fields: Vec<Field>,
    size_scale: f64,
    /// The surfaces; none in a planar domain.
    atlas: Option<Arc<Atlas>>,
    /// Whether a field asks for the curvature.
    bends: bool,
}

impl Sizing {
    /// Fields to intersect, in any order, and the factor on all sizes.
    ///
    /// # Panics
    /// Without fields, or with a factor that is not positive and finite (the reader of cases refuses both).
    pub fn new(mut fields: Vec<Field>, size_scale: f64) -> Sizing {
        assert!(!fields.is_empty(), "a sizing has at least one field");
        assert!(size_scale > 0.0 && size_scale.is_finite(), "size_scale is positive");
        // Fields that only cut back others come after them; the sort is stable.
        fields.sort_by_key(|field| !field.is_tensor());
        let bends = fields.iter().any(|field| matches!(field.0, Kind::Curvature(..)));
        Sizing { fields, size_scale, atlas: None, bends }
    }

    /// The same metric on surfaces.
    #[must_use]
    pub fn on(self, atlas: Option<Arc<Atlas>>) -> Sizing {
        Sizing { atlas, ..self }
    }

    /// The surfaces; none in a planar domain.
    pub fn atlas(&self) -> Option<&Arc<Atlas>> {
        self.atlas.as_ref()
    }

    /// The metric M3D of eq. (2) at a place. A pure function: the same place gives the same bits.
    ///
    /// # Errors
    /// Where a field gives no positive finite tensor: which size, its value, the place.
    #[inline]
    pub fn metric3(&self, place: &MetricPlace) -> Result<Metric3, Box<BadMetric>> {
        let mut m = self.fields[0].intersect(None, place)?;
        for field in &self.fields[1..] {
            m = field.intersect(Some(m), place)?;
        }
        if self.fields.len() > 1 && !is_held_well(&m) {
            let what = format!("the fields together stretch the metric by more than {LARGEST_ANISOTROPY:e}");
            return Err(bad(what, "", place));
        }
        Ok(if self.size_scale == 1.0 { m } else { m.scaled(self.size_scale) })
    }

    /// The metric M3D at a place of the plane in which it is meshed.
    ///
    /// # Errors
    /// As [`Sizing::metric3`].
    pub fn metric3_at(&self, chart: DVec2) -> Result<Metric3, Box<BadMetric>> {
        match &self.atlas {
            None => self.metric3(&MetricPlace::in_plane(chart)),
            Some(atlas) => {
                let at = atlas.at(chart);
                self.metric3(&self.place(atlas, chart, at.xyz, at.uv))
            }
        }
    }

    #[inline]
    fn place(&self, atlas: &Atlas, chart: DVec2, xyz: DVec3, uv: DVec2) -> MetricPlace {
        let bend = if self.bends { atlas.bent(chart).bend() } else { None };
        MetricPlace { xyz, uv, chart, bend }
    }

    /// Eq. (3): `M = J^T M3D J`.
    fn on_surface(&self, atlas: &Atlas, chart: DVec2) -> Result<Metric2, Box<BadMetric>> {
        let at = atlas.at(chart);
        let place = self.place(atlas, chart, at.xyz, at.uv);
        let m = self.metric3(&place)?.pull_back(at.j[0], at.j[1]);
        if m.is_spd() {
            return Ok(m);
        }
        Err(bad("the surface has no tangent plane here, or its derivatives are not finite".into(), "", &place))
    }
}

/// Whether double precision still holds all sizes of an intersection.
#[inline]
fn is_held_well(m: &Metric3) -> bool {
    let (det, trace) = (m.plane().det(), m.xx + m.yy);
    // det / trace^2 is the ratio of the eigenvalues where it is small.
    let plane = det * LARGEST_ANISOTROPY * LARGEST_ANISOTROPY > trace * trace && trace.is_finite();
    if m.is_planar() { plane && m.zz > 0.0 && m.zz.is_finite() } else { m.is_spd() }
}

impl MetricSource for Sizing {
    #[inline]
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
        match &self.atlas {
            None => Ok(self.metric3(&MetricPlace::in_plane(uv))?.plane()),
            Some(atlas) => self.on_surface(atlas, uv),
        }
    }
}

#[cfg(test)]
mod tests;
