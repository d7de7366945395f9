//! Metric fields: a tensor at each point (uniform, by formulas, by a table, by the distance from curves, by curvature),
//! their intersection, and on surfaces the pull-back (eq. 3).

mod by_formula;

use std::ops::Deref;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::boundary_layer::{BoundaryLayer, Distance};
use super::curvature::Curvature;
use super::forced::{Forced, ForcedSide};
use super::gap::{Gap, Rungs};
use super::place::MetricPlace;
use super::table::Table;
use super::walls::{Rows, Walls};
use crate::core::fault::{Fault, FaultKind};
use crate::core::geometry::assembly::placed;
use crate::core::geometry::{Atlas, Line, Mirror};
use crate::core::kernel::tensor::{LARGEST_ANISOTROPY, check_sizes};
use crate::core::kernel::{Metric2, Metric3};
use by_formula::FormulaField;

/// The failure of a field at a point: what is wrong and where.
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

/// The metric of eq. (3) at parametric coordinates, as the mesher and the converter use it.
pub trait MetricSource {
    /// The metric at `uv`. A pure function: the same point gives the same bits.
    ///
    /// # Errors
    /// If the field is not positive definite and finite there (boxed to keep the common result small).
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>>;

    /// The rows that are asked for at a node of a wall; `None` where there is no wall.
    fn rows_at(&self, _node: DVec2) -> Option<Rows> {
        None
    }

    /// Whether rows are asked for anywhere.
    fn has_walls(&self) -> bool {
        false
    }
}

impl<P: Deref<Target: MetricSource>> MetricSource for P {
    #[inline]
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
        (**self).metric(uv)
    }

    fn rows_at(&self, node: DVec2) -> Option<Rows> {
        (**self).rows_at(node)
    }

    fn has_walls(&self) -> bool {
        (**self).has_walls()
    }
}

/// The specification of a field in a case; several fields are intersected.
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
        /// Helper expressions (name, text); each may use those before it.
        helpers: Vec<(String, String)>,
        /// h1, h2, h3; h1 alone (the others `None`) is isotropic.
        sizes: [Option<String>; 3],
        /// g1, g2, g3, three components each; missing ones are completed (in the plane g3 = z).
        directions: [Option<[String; 3]>; 3],
        /// Its place in the case, for messages.
        place: String,
    },
    /// A boundary layer: size `first` across named curves, growing by `growth` from row to row.
    BoundaryLayer {
        /// Names of curves.
        curves: Vec<String>,
        /// First height.
        first: f64,
        /// Height ratio of successive rows, at least 1.
        growth: f64,
        /// Size along the curves; `None`: limited only by the other fields.
        along: Option<f64>,
        /// Largest size of this field across the curves; `None`: limited only by the other fields.
        far: Option<f64>,
        /// Its place in the case, for messages.
        place: String,
    },
    /// An isotropic size: `first` on named curves, growing by `growth` from row to row up to `far`.
    Distance {
        /// Names of curves.
        curves: Vec<String>,
        /// Size on the curves.
        first: f64,
        /// Height ratio of successive rows, at least 1.
        growth: f64,
        /// Largest size.
        far: f64,
        /// Its place in the case, for messages.
        place: String,
    },
    /// Sizes by the curvature of the surface: the distance of chords from it is a fraction of the radius (see
    /// `curvature`).
    Curvature {
        /// Distance of a chord from its arc, as a fraction of the radius.
        chord: f64,
        /// Smallest size of this field.
        least: f64,
        /// Size where the surface is flat.
        far: f64,
        /// Its place in the case, for messages.
        place: String,
    },
    /// Rows between curves of the plane that face each other: sizes across are at most this part of their distance.
    Gap {
        /// Number of rows.
        layers: u32,
        /// Its place in the case, for messages.
        place: String,
    },
}

/// A compiled field.
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
    Forced(Box<Forced>),
    Gap(Box<Gap>),
}

impl Field {
    /// Compiles a field; `curves` looks up the fine polyline of a named curve.
    ///
    /// Missing directions of a formula are completed: g1 or g2 alone in the plane (g3 = z), two directions by their
    /// cross product, none by the coordinate axes. A missing h3 is the larger of h1 and h2, which has no effect in the
    /// plane.
    ///
    /// # Errors
    /// An invalid size, a formula that does not compile or is incomplete, an unknown curve; the fault carries the place
    /// of the specification.
    pub fn compile(spec: &FieldSpec, curves: &dyn Fn(&str) -> Option<Line>) -> Result<Field, Fault> {
        Field::kind(spec, curves).map(Field).map_err(|fault| fault.of_kind(FaultKind::Metric))
    }

    fn kind(spec: &FieldSpec, curves: &dyn Fn(&str) -> Option<Line>) -> Result<Kind, Fault> {
        let lines = |names: &[String], field: &str, place: &String| -> Result<Vec<Line>, Fault> {
            let line = |name: &String| {
                curves(name).ok_or_else(|| {
                    placed(Fault::new(format!("The {field} names a curve \"{name}\" that does not exist")), place)
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
                Kind::Formula(Box::new(field.map_err(|fault| placed(fault, place))?))
            }
            FieldSpec::BoundaryLayer { curves: names, first, growth, along, far, place } => {
                let lines = lines(names, "boundary layer", place)?;
                let layer = BoundaryLayer::new(&lines, *first, *growth, *along, *far);
                Kind::BoundaryLayer(Box::new(layer.map_err(|fault| placed(fault, place))?), place.clone())
            }
            FieldSpec::Distance { curves: names, first, growth, far, place } => {
                let field = Distance::new(&lines(names, "distance", place)?, *first, *growth, *far);
                Kind::Distance(Box::new(field.map_err(|fault| placed(fault, place))?), place.clone())
            }
            FieldSpec::Curvature { chord, least, far, place } => {
                let field = Curvature::new(*chord, *least, *far);
                Kind::Curvature(field.map_err(|fault| placed(fault, place))?)
            }
            // In the plane the division of the curves finds the gaps.
            FieldSpec::Gap { place, .. } => {
                let fault = Fault::new("A metric of kind \"gap\" is for domains of curves in the plane");
                return Err(placed(fault.remedy("Remove it"), place));
            }
        })
    }

    /// A field by a table at the nodes of a triangle mesh in the parametric plane, log-Euclidean between them
    /// (docs/algorithm.md, "Metric at new places"); outside the mesh, the value at its nearest point.
    ///
    /// # Errors
    /// Different lengths, indices out of range, a triangle without area, a metric that is not positive definite.
    pub fn table(points: &[DVec2], triangles: &[[u32; 3]], metrics: Vec<Metric3>) -> Result<Field, Fault> {
        let table = Table::new(points, triangles, &metrics).map_err(|fault| fault.of_kind(FaultKind::Metric))?;
        Ok(Field(Kind::Table(Box::new(table))))
    }

    /// Whether it defines a tensor by itself; a boundary layer without a size along its curves and narrow gaps only
    /// limit other fields.
    fn is_tensor(&self) -> bool {
        match &self.0 {
            Kind::BoundaryLayer(layer, _) => layer.is_tensor(),
            Kind::Gap(_) => false,
            _ => true,
        }
    }

    /// The field's metric at a point, intersected with that of the fields before it.
    #[inline]
    fn intersect(&self, others: Option<Metric3>, place: &MetricPlace) -> Result<Metric3, Box<BadMetric>> {
        let m = match &self.0 {
            Kind::Uniform(m) => *m,
            Kind::Formula(field) => field.metric(place)?,
            Kind::Table(table) => table.metric(place.chart).ok_or_else(|| nowhere(place, ""))?,
            Kind::Forced(field) => field.metric(place.xyz).ok_or_else(|| nowhere(place, ""))?,
            Kind::BoundaryLayer(layer, origin) => {
                return layer.intersect(others, place.uv, place.xyz).ok_or_else(|| nowhere(place, origin));
            }
            Kind::Gap(gap) => {
                let limited = gap.limit(others, place.xyz).ok_or_else(|| nowhere(place, ""))?;
                // A gap too narrow for a tensor is left to the other fields.
                return Ok(others.filter(|_| !is_representable(&limited)).unwrap_or(limited));
            }
            Kind::Distance(field, origin) => field.metric(place.uv, place.xyz).ok_or_else(|| nowhere(place, origin))?,
            Kind::Curvature(field) => field.metric(place.bend.as_ref()),
        };
        Ok(others.map_or(m, |others| Metric3::intersect(&others, &m)))
    }
}

/// The failure of a field at a point; `origin` is the place of the field in the case.
#[cold]
fn bad(what: String, origin: &str, place: &MetricPlace) -> Box<BadMetric> {
    let what = if origin.is_empty() { what } else { format!("{what} ({origin})") };
    Box::new(BadMetric { what, place: *place })
}

#[cold]
fn nowhere(place: &MetricPlace, origin: &str) -> Box<BadMetric> {
    bad("the metric is evaluated at coordinates that are not finite".into(), origin, place)
}

/// The metric of a case: the intersection of its fields, with all sizes multiplied by one factor; on surfaces, its
/// pull-back to the plane in which they are meshed.
#[derive(Clone, Debug)]
pub struct Sizing {
    fields: Vec<Field>,
    size_scale: f64,
    /// The surfaces; `None` in a planar domain.
    atlas: Option<Arc<Atlas>>,
    /// Whether a field needs the curvature.
    bends: bool,
    /// Where boundary layers ask for rows; `None` where there is no wall.
    walls: Option<Arc<Walls>>,
    /// The mirror line of a symmetric domain: beyond it the metric is the image of the one on this side.
    mirror: Option<Mirror>,
}

impl Sizing {
    /// The intersection of fields, given in any order, with a factor on all sizes.
    ///
    /// # Panics
    /// Without fields, or if the factor is not positive and finite (the reader of cases refuses both).
    pub fn new(mut fields: Vec<Field>, size_scale: f64) -> Sizing {
        assert!(!fields.is_empty(), "a sizing has at least one field");
        assert!(size_scale > 0.0 && size_scale.is_finite(), "size_scale is positive");
        // Fields that only limit others come last; the sort is stable.
        fields.sort_by_key(|field| !field.is_tensor());
        let bends = fields.iter().any(|field| matches!(field.0, Kind::Curvature(..)));
        Sizing { fields, size_scale, atlas: None, bends, walls: None, mirror: None }
    }

    /// The same metric on surfaces.
    #[must_use]
    pub fn on(self, atlas: Option<Arc<Atlas>>) -> Sizing {
        Sizing { atlas, ..self }
    }

    /// The same metric, intersected with sizes that are forced, from which sizes grow by `gradation` over a unit length
    /// (docs/algorithm.md, "Forced spacing"), and with the widths of narrow gaps, for so many layers in them.
    #[must_use]
    pub(in crate::core) fn forced(&self, sides: &[ForcedSide], gaps: &[Rungs], layers: u32, gradation: f64) -> Sizing {
        let forced = (!sides.is_empty()).then(|| Forced::new(sides, gradation, self.size_scale));
        let gap = Gap::new(gaps, layers, gradation, self.size_scale);
        let more = [forced.map(|field| Kind::Forced(Box::new(field))), gap.map(|field| Kind::Gap(Box::new(field)))];
        let fields = self.fields.iter().cloned().chain(more.into_iter().flatten().map(Field)).collect();
        Sizing::new(fields, self.size_scale).on(self.atlas.clone()).mirrored(self.mirror)
    }

    /// The same metric on the side of a mirror line that is kept, and its image beyond (docs/algorithm.md, "Symmetry").
    #[must_use]
    pub fn mirrored(self, mirror: Option<Mirror>) -> Sizing {
        Sizing { mirror, ..self }
    }

    /// The mirror line and the image of a point beyond it, where the metric is to be looked up.
    #[inline]
    fn folded(&self, p: DVec2) -> Option<(&Mirror, DVec2)> {
        self.mirror.as_ref().filter(|mirror| mirror.offset(p) < 0.0).map(|mirror| (mirror, mirror.image(p)))
    }

    /// The same metric with walls.
    #[must_use]
    pub fn with_walls(self, walls: Walls) -> Sizing {
        Sizing { walls: (!walls.is_empty()).then(|| Arc::new(walls)), ..self }
    }

    /// The surfaces; `None` in a planar domain.
    pub fn atlas(&self) -> Option<&Arc<Atlas>> {
        self.atlas.as_ref()
    }

    /// The metric M3D of eq. (2) at a point. A pure function: the same point gives the same bits.
    ///
    /// # Errors
    /// If a field gives no positive finite tensor: which size, its value, the point.
    #[inline]
    pub fn metric3(&self, place: &MetricPlace) -> Result<Metric3, Box<BadMetric>> {
        let mut m = self.fields[0].intersect(None, place)?;
        for field in &self.fields[1..] {
            m = field.intersect(Some(m), place)?;
        }
        if self.fields.len() > 1 && !is_representable(&m) {
            let what = format!("the anisotropy of all fields together exceeds {LARGEST_ANISOTROPY:e}");
            return Err(bad(what, "", place));
        }
        Ok(if self.size_scale == 1.0 { m } else { m.scaled(self.size_scale) })
    }

    /// The metric M3D at a point of the plane that is meshed.
    ///
    /// # Errors
    /// As [`Sizing::metric3`].
    pub fn metric3_at(&self, chart: DVec2) -> Result<Metric3, Box<BadMetric>> {
        match &self.atlas {
            None => match self.folded(chart) {
                None => self.metric3(&MetricPlace::in_plane(chart)),
                Some((mirror, p)) => Ok(mirror.image_of_metric3(&self.metric3(&MetricPlace::in_plane(p))?)),
            },
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

/// Whether double precision can represent all sizes of an intersection.
#[inline]
fn is_representable(m: &Metric3) -> bool {
    let (det, trace) = (m.plane().det(), m.xx + m.yy);
    // If det / trace^2 is small, it is the ratio of the eigenvalues.
    let plane = det * LARGEST_ANISOTROPY * LARGEST_ANISOTROPY > trace * trace && trace.is_finite();
    if m.is_planar() { plane && m.zz > 0.0 && m.zz.is_finite() } else { m.is_spd() }
}

impl MetricSource for Sizing {
    #[inline]
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
        match &self.atlas {
            None => match self.folded(uv) {
                None => Ok(self.metric3(&MetricPlace::in_plane(uv))?.plane()),
                Some((mirror, p)) => Ok(mirror.image_of_metric(&self.metric3(&MetricPlace::in_plane(p))?.plane())),
            },
            Some(atlas) => self.on_surface(atlas, uv),
        }
    }

    fn rows_at(&self, node: DVec2) -> Option<Rows> {
        self.walls.as_ref()?.rows_at(node)
    }

    fn has_walls(&self) -> bool {
        self.walls.is_some()
    }
}

#[cfg(test)]
mod tests;
