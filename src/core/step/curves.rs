//! Curves of a file (ISO 10303-42, "curve") and the parts of them that edges are.

use glam::{DVec3, DVec4};

use super::fields::{Entity, Fields};
use super::placement::Placed;
use super::spline::{Spline, nearest};
use crate::core::fault::Fault;
use crate::core::geometry::{AxisFrame, SpaceShape};

/// The deepest chain of curves of curves.
const DEEPEST: usize = 8;
/// A polyline has corners where it turns by more than this angle, radians: everywhere, since an edge of a part with
/// facets is as its file has it.
const CORNER: f64 = 1e-4;

/// A curve without ends.
#[derive(Clone, Debug)]
pub(super) enum Curve {
    /// A straight line along a vector.
    Line { origin: DVec3, along: DVec3 },
    /// A circle.
    Circle { frame: AxisFrame, radius: f64 },
    /// An ellipse with the half axes `x` and `y`.
    Ellipse { centre: DVec3, x: DVec3, y: DVec3 },
    /// A branch of a hyperbola: `centre + x cosh t + y sinh t`.
    Hyperbola { centre: DVec3, x: DVec3, y: DVec3 },
    /// A parabola: `centre + x t^2 + y t`.
    Parabola { centre: DVec3, x: DVec3, y: DVec3 },
    /// A polyline.
    Polyline(Vec<DVec3>),
    /// A B-spline.
    Spline(Spline),
}

impl Placed<'_, '_> {
    /// Reads a curve.
    ///
    /// # Errors
    /// What is no curve, or one of a kind that is not supported.
    pub fn curve(&self, id: u64) -> Result<Curve, Fault> {
        self.curve_within(id, DEEPEST)
    }

    fn curve_within(&self, id: u64, depth: usize) -> Result<Curve, Fault> {
        let entity = self.file.entity(id)?;
        let fields = entity.first();
        let inner = |i: usize| {
            let depth = depth.checked_sub(1).ok_or_else(|| self.unsupported(&entity, "curve"))?;
            self.curve_within(fields.instance(i)?, depth)
        };
        let frame = || self.frame(fields.instance(1)?);
        let length = |i: usize| {
            let found = self.length(fields.number(i)?);
            let refused = || entity.fault(format!("#{id} has a radius of {found}")).remedy(super::DAMAGED);
            if found > 0.0 { Ok(found) } else { Err(refused()) }
        };
        match entity.keyword() {
            "LINE" => {
                Ok(Curve::Line { origin: self.point(fields.instance(1)?)?, along: self.vector(fields.instance(2)?)? })
            }
            "CIRCLE" => Ok(Curve::Circle { frame: frame()?, radius: length(2)? }),
            "ELLIPSE" | "HYPERBOLA" => {
                let (frame, a, b) = (frame()?, length(2)?, length(3)?);
                let (centre, x, y) = (frame.centre, frame.start * a, frame.axis.cross(frame.start) * b);
                Ok(if entity.is("ELLIPSE") {
                    Curve::Ellipse { centre, x, y }
                } else {
                    Curve::Hyperbola { centre, x, y }
                })
            }
            "PARABOLA" => {
                let (frame, focus) = (frame()?, length(2)?);
                let (x, y) = (frame.start * focus, frame.axis.cross(frame.start) * (2.0 * focus));
                Ok(Curve::Parabola { centre: frame.centre, x, y })
            }
            "POLYLINE" => {
                let points = fields.instances(1)?.into_iter().map(|id| self.point(id)).collect::<Result<_, _>>()?;
                Ok(Curve::Polyline(points))
            }
            // The curve in space; its images on surfaces are computed anew.
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" | "BOUNDED_SURFACE_CURVE" => inner(1),
            // The vertices of the edge trim it once more.
            "TRIMMED_CURVE" => Ok(if fields.flag(4)? { inner(1)? } else { inner(1)?.reversed() }),
            _ if entity.keyword().contains("B_SPLINE_CURVE") || is_spline(&entity) => {
                self.spline(&entity).map(Curve::Spline)
            }
            _ => Err(self.unsupported(&entity, "curve").remedy(super::SKIP)),
        }
    }

    /// A B-spline curve, simple or complex.
    fn spline(&self, entity: &Entity<'_, '_>) -> Result<Spline, Fault> {
        // In a complex instance the parameters are divided among records; in a simple one they follow one another.
        let (own, knots_of) = divided(entity, "B_SPLINE_CURVE", "B_SPLINE_CURVE_WITH_KNOTS", 5);
        let own = own.ok_or_else(|| self.unsupported(entity, "curve").remedy(super::SKIP))?;
        let degree = own.count(0)?;
        let points = own.instances(1)?.into_iter().map(|id| self.point(id)).collect::<Result<Vec<_>, _>>()?;
        let knots = match knots_of {
            Some(fields) => repeated(&fields, 0, 1, points.len() + degree + 1)?,
            None => implied_knots(entity, degree, points.len()),
        };
        let weights = match entity.record("RATIONAL_B_SPLINE_CURVE") {
            Some(fields) => fields.numbers(fields.len().saturating_sub(1))?,
            None => Vec::new(),
        };
        if !weights.is_empty() && weights.len() != points.len() {
            return Err(entity.fault(format!("#{} has unlike numbers of points and weights", entity.id())));
        }
        let spline = Spline::new(degree, knots, &points, &weights);
        let placed = |fault: Fault| entity.fault(format!("#{}: {}", entity.id(), fault.what)).remedy(fault.remedy);
        spline.checked().map_err(placed)?;
        spline.clamped().map_err(placed)
    }
}

/// Whether a complex instance is a B-spline curve.
fn is_spline(entity: &Entity<'_, '_>) -> bool {
    ["B_SPLINE_CURVE", "BEZIER_CURVE", "UNIFORM_CURVE", "QUASI_UNIFORM_CURVE"].iter().any(|keyword| entity.is(keyword))
}

/// The parameters that all B-splines have, without the name, and those of their knots; `own` is the number of the first
/// ones.
pub(super) fn divided<'e, 'a>(
    entity: &'e Entity<'_, 'a>,
    all: &str,
    with_knots: &str,
    own: usize,
) -> (Option<Fields<'e, 'a>>, Option<Fields<'e, 'a>>) {
    match entity.record(all) {
        Some(fields) => (Some(fields), entity.record(with_knots)),
        None => {
            let fields = entity.first();
            (Some(fields.from(1)), (fields.len() > own + 1).then(|| fields.from(own + 1)))
        }
    }
}

/// Knots by their multiplicities and values.
///
/// # Errors
/// Lists that do not fit each other, or give more than `most` knots.
pub(super) fn repeated(
    fields: &Fields<'_, '_>,
    multiplicities: usize,
    values: usize,
    most: usize,
) -> Result<Vec<f64>, Fault> {
    let (times, values) = (fields.numbers(multiplicities)?, fields.numbers(values)?);
    let count: f64 = times.iter().sum();
    if times.len() != values.len() || times.iter().any(|t| *t < 1.0) || count != most as f64 {
        return Err(fields.refused("does not have as many knots as its degree and points need"));
    }
    Ok(times.iter().zip(values).flat_map(|(&t, value)| std::iter::repeat_n(value, t as usize)).collect())
}

/// The knots of a B-spline that has none of its own, by its kind.
pub(super) fn implied_knots(entity: &Entity<'_, '_>, degree: usize, points: usize) -> Vec<f64> {
    let is = |kind: &str| entity.instance.records.iter().any(|record| record.0.starts_with(kind));
    let spans = points.saturating_sub(degree).max(1);
    let ramp = |k: usize| k as f64;
    if is("BEZIER") || is("PIECEWISE_BEZIER") {
        let pieces = (points.saturating_sub(1) / degree.max(1)).max(1);
        let inner = (1..pieces).flat_map(|k| std::iter::repeat_n(ramp(k), degree));
        return [vec![0.0; degree + 1], inner.collect(), vec![ramp(pieces); degree + 1]].concat();
    }
    if is("UNIFORM") {
        return (0..points + degree + 1).map(|k| ramp(k) - ramp(degree)).collect();
    }
    [vec![0.0; degree + 1], (1..spans).map(ramp).collect(), vec![ramp(spans); degree + 1]].concat()
}

/// An edge's part of a curve.
pub(super) struct Part {
    /// From the first vertex to the last.
    pub shape: SpaceShape,
    /// How far the vertices are from the curve.
    pub off: f64,
}

impl Curve {
    /// The part between two vertices, in the direction of the curve or against it; all of a closed curve if the edge
    /// `is_closed` (begins and ends at one vertex).
    ///
    /// # Errors
    /// What is wrong, for a sentence that begins with the edge.
    pub fn between(&self, ends: [DVec3; 2], is_closed: bool, forward: bool) -> Result<Part, String> {
        let open = |kind: &str| if is_closed { Err(format!("is a closed {kind}")) } else { Ok(()) };
        let off_by = |places: [DVec3; 2]| places[0].distance(ends[0]).max(places[1].distance(ends[1]));
        match self {
            Curve::Line { origin, along } => {
                open("line")?;
                let unit = along.normalize_or_zero();
                let foot = |p: DVec3| *origin + unit * (p - *origin).dot(unit);
                let off = if unit == DVec3::ZERO { 0.0 } else { off_by(ends.map(foot)) };
                Ok(Part { shape: SpaceShape::Segment { from: ends[0], to: ends[1] }, off })
            }
            Curve::Circle { frame, radius } => {
                let y = frame.axis.cross(frame.start);
                let angles = ends.map(|p| {
                    let p = p - frame.centre;
                    libm::atan2(p.dot(y), p.dot(frame.start)).to_degrees()
                });
                let angles = turn(angles, is_closed, forward, 360.0);
                let off = off_by(angles.map(|angle| frame.centre + frame.towards(angle) * *radius));
                Ok(Part { shape: SpaceShape::Arc { frame: *frame, radius: *radius, angles }, off })
            }
            Curve::Ellipse { centre, x, y } => {
                let angles = ends.map(|p| {
                    let p = p - *centre;
                    libm::atan2(p.dot(*y) / y.length_squared(), p.dot(*x) / x.length_squared())
                });
                let [from, to] = turn(angles, is_closed, forward, std::f64::consts::TAU);
                let mut spline = Spline::ellipse(*centre, *x, *y, [from.min(to), from.max(to)]);
                if is_closed {
                    // The end of a full turn equals its start to the last bit.
                    let last = spline.points.len() - 1;
                    spline.points[last] = spline.points[0];
                }
                Part::of_spline(if from < to { spline } else { spline.reversed() }, ends)
            }
            Curve::Hyperbola { centre, x, y } => {
                open("hyperbola")?;
                // The rational parameter tanh(t / 2).
                let parameter = |p: DVec3| {
                    let t = libm::asinh((p - *centre).dot(*y) / y.length_squared());
                    libm::tanh(0.5 * t)
                };
                let blossom = |s: f64, t: f64| {
                    let w = 1.0 - s * t;
                    (*centre * w + *x * (1.0 + s * t) + *y * (s + t)).extend(w)
                };
                Part::of_conic(ends, ends.map(parameter), blossom)
            }
            Curve::Parabola { centre, x, y } => {
                open("parabola")?;
                let parameter = |p: DVec3| (p - *centre).dot(*y) / y.length_squared();
                let blossom = |s: f64, t: f64| (*centre + *x * (s * t) + *y * (0.5 * (s + t))).extend(1.0);
                Part::of_conic(ends, ends.map(parameter), blossom)
            }
            Curve::Polyline(points) => {
                let mut points = points.clone();
                let too_short = || "has a polyline of fewer than two points".to_owned();
                if !forward {
                    points.reverse();
                }
                let [first, last] = [points.first(), points.last()].map(Option::<&DVec3>::copied);
                let off = off_by([first.ok_or_else(too_short)?, last.ok_or_else(too_short)?]);
                Ok(Part { shape: SpaceShape::Polyline { points, closed: false, corner_angle: CORNER }, off })
            }
            Curve::Spline(spline) => spline_between(spline, ends, is_closed, forward),
        }
    }

    /// The same curve in the other direction.
    fn reversed(self) -> Curve {
        match self {
            Curve::Line { origin, along } => Curve::Line { origin, along: -along },
            Curve::Circle { frame, radius } => {
                Curve::Circle { frame: AxisFrame { axis: -frame.axis, ..frame }, radius }
            }
            Curve::Ellipse { centre, x, y } => Curve::Ellipse { centre, x, y: -y },
            Curve::Hyperbola { centre, x, y } => Curve::Hyperbola { centre, x, y: -y },
            Curve::Parabola { centre, x, y } => Curve::Parabola { centre, x, y: -y },
            Curve::Polyline(points) => Curve::Polyline(points.into_iter().rev().collect()),
            Curve::Spline(spline) => Curve::Spline(spline.reversed()),
        }
    }

    /// The whole curve as a B-spline; `None` for one that has no ends.
    pub fn whole(&self) -> Option<Spline> {
        let full = [0.0, std::f64::consts::TAU];
        match self {
            Curve::Circle { frame, radius } => {
                let (x, y) = (frame.start * *radius, frame.axis.cross(frame.start) * *radius);
                Some(Spline::ellipse(frame.centre, x, y, full))
            }
            Curve::Ellipse { centre, x, y } => Some(Spline::ellipse(*centre, *x, *y, full)),
            Curve::Spline(spline) => Some(spline.clone()),
            Curve::Polyline(points) => {
                let n = points.len().checked_sub(1).filter(|n| *n > 0)?;
                let inner = (0..=n).map(|k| k as f64);
                let knots = std::iter::once(0.0).chain(inner).chain([n as f64]).collect();
                Some(Spline::new(1, knots, points, &[]))
            }
            Curve::Line { .. } | Curve::Hyperbola { .. } | Curve::Parabola { .. } => None,
        }
    }
}

/// The angles of an arc that runs from one angle to another, forward or back; a full turn if it is closed.
fn turn([from, to]: [f64; 2], is_closed: bool, forward: bool, full: f64) -> [f64; 2] {
    let sign = if forward { 1.0 } else { -1.0 };
    if is_closed {
        return [from, from + sign * full];
    }
    let mut angle = (to - from) * sign;
    while angle <= 0.0 {
        angle += full;
    }
    [from, from + sign * angle]
}

impl Part {
    fn of_spline(spline: Spline, ends: [DVec3; 2]) -> Result<Part, String> {
        let at = |p: &DVec4| p.truncate() / p.w;
        let [first, last] = [spline.points.first(), spline.points.last()].map(|p| p.map(at).unwrap_or_default());
        let off = first.distance(ends[0]).max(last.distance(ends[1]));
        Ok(Part { shape: spline.shape(), off })
    }

    fn of_conic(ends: [DVec3; 2], [from, to]: [f64; 2], blossom: impl Fn(f64, f64) -> DVec4) -> Result<Part, String> {
        if from == to {
            return Err("has no length".to_owned());
        }
        let spline = Spline::conic([from.min(to), from.max(to)], blossom);
        Part::of_spline(if from < to { spline } else { spline.reversed() }, ends)
    }
}

fn spline_between(spline: &Spline, ends: [DVec3; 2], is_closed: bool, forward: bool) -> Result<Part, String> {
    let directed = if forward { spline.clone() } else { spline.reversed() };
    let curve = directed.checked().map_err(|fault| fault.to_string())?;
    let (first, last) = curve.basis().domain();
    let [start, end] = [first, last].map(|t| curve.at(t).0);
    let places = directed.places();
    let size = places.iter().map(|p| p.distance(places[0])).fold(0.0, f64::max);
    // The vertices are mostly the ends of the curve.
    let near = 1e-6 * size;
    let is_whole = start.distance(ends[0]) <= near && end.distance(ends[1]) <= near;
    let is_ring = start.distance(end) <= near;
    if is_whole && (is_closed || !is_ring || ends[0].distance(ends[1]) <= near) {
        return Part::of_spline(directed, ends);
    }
    let [(mut from, off), (mut to, off_end)] = ends.map(|p| nearest(&curve, p));
    let small = 1e-9 * (last - first);
    if is_ring && !is_closed {
        // A vertex at the joint of a ring is its start or its end, as the other vertex asks.
        if last - from < small {
            from = first;
        }
        if to - first < small {
            to = last;
        }
    }
    let part = |range: [f64; 2]| directed.part(range).map_err(|fault| fault.to_string());
    let found = if is_closed && is_ring {
        if from - first < small || last - from < small {
            directed
        } else {
            part([from, last])?.joined(&part([first, from])?)
        }
    } else if to - from > small {
        part([from, to])?
    } else if is_ring && from - to > small {
        if last - from < small { part([first, to])? } else { part([from, last])?.joined(&part([first, to])?) }
    } else if off.max(off_end) > near && !is_ring {
        return Err("has vertices that are not on its curve, or in the wrong order".to_owned());
    } else {
        return Err("has no length".to_owned());
    };
    Part::of_spline(found, ends)
}
