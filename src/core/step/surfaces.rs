//! Surfaces of a file (ISO 10303-42, "surface"), and the parts of them on which faces lie.

use std::f64::consts::TAU;

use glam::{DVec3, DVec4};

use super::curves::{Curve, divided, implied_knots, repeated};
use super::fields::Entity;
use super::placement::Placed;
use super::spline::Spline;
use crate::core::fault::Fault;
use crate::core::geometry::{AxisFrame, Basis, NurbsSurface, SurfaceShape, cut, revolution};
use crate::core::kernel::box_tree::extent;

/// The deepest chain of surfaces of surfaces.
const DEEPEST: usize = 8;
/// A bounded surface reaches beyond its face by this fraction of the face.
const MARGIN: f64 = 0.02;
/// A face that comes nearer to an apex than this fraction of its size ends there.
const AT_APEX: f64 = 1e-6;
/// The most control points of a surface.
const MOST_POINTS: usize = 4_000_000;

/// A surface without ends. Its normal is the file's.
#[derive(Clone, Debug)]
pub(super) enum Surface {
    /// A plane: the axis of its frame is the normal.
    Plane(AxisFrame),
    /// A cone, or a cylinder of slope 0: the radius at height h of its frame is `radius + slope h`.
    Cone { frame: AxisFrame, radius: f64, slope: f64 },
    /// A sphere.
    Sphere { frame: AxisFrame, radius: f64 },
    /// A torus.
    Torus { frame: AxisFrame, radius: f64, tube: f64 },
    /// A B-spline surface, with clamped knots.
    Net(Net),
    /// A curve swept along a vector.
    Extrusion { curve: Spline, along: DVec3 },
    /// A straight line swept about an axis.
    RuledRevolution { frame: AxisFrame, origin: DVec3, along: DVec3 },
    /// A curve swept about an axis.
    Revolution { frame: AxisFrame, curve: Spline },
}

/// Control points of a B-spline surface, in rows along v.
#[derive(Clone, Debug)]
pub(super) struct Net {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    points: Vec<DVec4>,
    columns: usize,
}

impl Placed<'_, '_> {
    /// Reads a surface.
    ///
    /// # Errors
    /// What is no surface, or one of a kind that is not supported.
    pub fn surface(&self, id: u64) -> Result<Surface, Fault> {
        self.surface_within(id, DEEPEST)
    }

    fn surface_within(&self, id: u64, depth: usize) -> Result<Surface, Fault> {
        let entity = self.file.entity(id)?;
        let fields = entity.first();
        let frame = || self.frame(fields.instance(1)?);
        let positive = |i: usize, what: &str| {
            let found = self.length(fields.number(i)?);
            let refused = || entity.fault(format!("#{id} has a {what} of {found}")).remedy(super::DAMAGED);
            if found > 0.0 { Ok(found) } else { Err(refused()) }
        };
        let inner = |i: usize| {
            let depth = depth.checked_sub(1).ok_or_else(|| self.unsupported(&entity, "surface"))?;
            self.surface_within(fields.instance(i)?, depth)
        };
        match entity.keyword() {
            "PLANE" => frame().map(Surface::Plane),
            "CYLINDRICAL_SURFACE" => Ok(Surface::Cone { frame: frame()?, radius: positive(2, "radius")?, slope: 0.0 }),
            "CONICAL_SURFACE" => {
                let (radius, angle) = (self.length(fields.number(2)?), fields.number(3)? * self.radians);
                if !(radius >= 0.0 && angle.abs() > 0.0 && angle.abs() < 0.25 * TAU) {
                    let what =
                        format!("#{id} is a cone of radius {radius} and half angle {} degrees", angle.to_degrees());
                    return Err(entity.fault(what).remedy(super::DAMAGED));
                }
                Ok(Surface::Cone { frame: frame()?, radius, slope: libm::tan(angle) })
            }
            "SPHERICAL_SURFACE" => Ok(Surface::Sphere { frame: frame()?, radius: positive(2, "radius")? }),
            "TOROIDAL_SURFACE" | "DEGENERATE_TOROIDAL_SURFACE" => Ok(Surface::Torus {
                frame: frame()?,
                radius: positive(2, "radius")?,
                tube: positive(3, "tube radius")?,
            }),
            "SURFACE_OF_LINEAR_EXTRUSION" => {
                let (curve, along) = (self.curve(fields.instance(1)?)?, self.vector(fields.instance(2)?)?);
                self.extrusion(&entity, curve, along)
            }
            "SURFACE_OF_REVOLUTION" => {
                let (curve, frame) = (self.curve(fields.instance(1)?)?, self.frame(fields.instance(2)?)?);
                self.revolution(&entity, curve, frame)
            }
            // The loops of the face bound it.
            "RECTANGULAR_TRIMMED_SURFACE" => {
                let [same_u, same_v] = [6, 7].map(|i| fields.flag(i).unwrap_or(true));
                if same_u == same_v {
                    inner(1)
                } else {
                    Err(self.unsupported(&entity, "surface with one parameter reversed").remedy(super::SKIP))
                }
            }
            "CURVE_BOUNDED_SURFACE" => inner(1),
            _ if entity.keyword().contains("B_SPLINE_SURFACE") || is_net(&entity) => {
                self.net(&entity).map(Surface::Net)
            }
            _ => Err(self.unsupported(&entity, "surface").remedy(super::SKIP)),
        }
    }

    fn extrusion(&self, entity: &Entity<'_, '_>, curve: Curve, along: DVec3) -> Result<Surface, Fault> {
        let refused = |what: &str| entity.fault(format!("#{} {what}", entity.id())).remedy(super::SKIP);
        if along.length() == 0.0 {
            return Err(refused("is swept along a vector of no length"));
        }
        match curve {
            Curve::Line { origin, along: line } => {
                let frame = AxisFrame::new(origin, line.cross(along), Some(line));
                frame.map(Surface::Plane).map_err(|_| refused("is a line that is swept along itself"))
            }
            Curve::Circle { frame, radius } if frame.axis.cross(along.normalize()).length() < 1e-12 => {
                // The normal points outwards where the sweep goes along the axis of the circle, which is its u x v.
                if frame.axis.dot(along) > 0.0 {
                    Ok(Surface::Cone { frame, radius, slope: 0.0 })
                } else {
                    let curve = Curve::Circle { frame, radius }.whole();
                    Ok(Surface::Extrusion { curve: curve.ok_or_else(|| refused("has no ends"))?, along })
                }
            }
            other => {
                let curve = other.whole().ok_or_else(|| refused("is swept from a curve without ends"))?;
                Ok(Surface::Extrusion { curve, along })
            }
        }
    }

    fn revolution(&self, entity: &Entity<'_, '_>, curve: Curve, frame: AxisFrame) -> Result<Surface, Fault> {
        let refused = |what: &str| entity.fault(format!("#{} {what}", entity.id())).remedy(super::SKIP);
        match curve {
            Curve::Line { origin, along } if along.dot(frame.axis).abs() <= 1e-12 * along.length() => {
                Err(refused("is a line that is swept about an axis at a right angle to it")
                    .at(format!("at {}", crate::core::kernel::decimal::point_text(origin))))
            }
            Curve::Line { origin, along } => Ok(Surface::RuledRevolution { frame, origin, along }),
            other => {
                let curve = other.whole().ok_or_else(|| refused("is swept from a curve without ends"))?;
                Ok(Surface::Revolution { frame, curve })
            }
        }
    }

    /// A B-spline surface, simple or complex.
    fn net(&self, entity: &Entity<'_, '_>) -> Result<Net, Fault> {
        let (own, knots_of) = divided(entity, "B_SPLINE_SURFACE", "B_SPLINE_SURFACE_WITH_KNOTS", 7);
        let own = own.ok_or_else(|| self.unsupported(entity, "surface").remedy(super::SKIP))?;
        let degrees = [own.count(0)?, own.count(1)?];
        let rows = own.rows_of_instances(2)?;
        let columns = rows.first().map_or(0, Vec::len);
        if columns == 0 || rows.iter().any(|row| row.len() != columns) || rows.len() * columns > MOST_POINTS {
            return Err(own.refused("has rows of control points of unlike lengths"));
        }
        let knots = match knots_of {
            Some(fields) => {
                let [p, q] = degrees;
                [repeated(&fields, 0, 2, rows.len() + p + 1)?, repeated(&fields, 1, 3, columns + q + 1)?]
            }
            None => [implied_knots(entity, degrees[0], rows.len()), implied_knots(entity, degrees[1], columns)],
        };
        let weights = match entity.record("RATIONAL_B_SPLINE_SURFACE") {
            Some(fields) => fields.rows_of_numbers(fields.len().saturating_sub(1))?.concat(),
            None => vec![1.0; rows.len() * columns],
        };
        if weights.len() != rows.len() * columns || weights.iter().any(|w| *w <= 0.0) {
            return Err(own.refused("has weights that do not fit its control points"));
        }
        let mut points = Vec::with_capacity(weights.len());
        for (&id, w) in rows.iter().flatten().zip(weights) {
            points.push((self.point(id)? * w).extend(w));
        }
        let net = Net { degrees, knots, points, columns };
        net.clamped().map_err(|fault| entity.fault(format!("#{}: {}", entity.id(), fault.what)).remedy(fault.remedy))
    }
}

/// Whether a complex instance is a B-spline surface.
fn is_net(entity: &Entity<'_, '_>) -> bool {
    let keywords = ["B_SPLINE_SURFACE", "BEZIER_SURFACE", "UNIFORM_SURFACE", "QUASI_UNIFORM_SURFACE"];
    keywords.iter().any(|keyword| entity.is(keyword))
}

impl Net {
    /// The same surface with clamped knots, in both directions; unclamped ones belong to closed surfaces, whose seam
    /// is found by the outer control points.
    fn clamped(self) -> Result<Net, Fault> {
        let rows = self.points.len() / self.columns;
        let bases = [
            Basis::new(self.degrees[0], self.knots[0].clone(), rows)?,
            Basis::new(self.degrees[1], self.knots[1].clone(), self.columns)?,
        ];
        let mut knots = self.knots.clone();
        let mut lines: Vec<Vec<DVec4>> = Vec::new();
        for row in self.points.chunks(self.columns) {
            let (first, last) = bases[1].domain();
            let (cut_knots, line) = cut(&bases[1], row, [first, last]);
            knots[1] = cut_knots;
            lines.push(line);
        }
        let columns = lines[0].len();
        let mut across: Vec<Vec<DVec4>> = Vec::new();
        for j in 0..columns {
            let column: Vec<DVec4> = lines.iter().map(|line| line[j]).collect();
            let (first, last) = bases[0].domain();
            let (cut_knots, line) = cut(&bases[0], &column, [first, last]);
            knots[0] = cut_knots;
            across.push(line);
        }
        let points = (0..across[0].len()).flat_map(|i| across.iter().map(move |line| line[i])).collect();
        Ok(Net { degrees: self.degrees, knots, points, columns })
    }

    /// As a surface of a case.
    fn shape(&self) -> SurfaceShape {
        let first = self.points[0].w;
        let is_polynomial = self.points.iter().all(|p| p.w == first);
        SurfaceShape::Nurbs {
            degrees: self.degrees,
            knots: self.knots.clone(),
            weights: if is_polynomial { Vec::new() } else { self.points.iter().map(|p| p.w).collect() },
            points: self.points.iter().map(|p| p.truncate() / p.w).collect(),
            columns: self.columns,
        }
    }
}

/// The lowest and highest of some numbers; 0 without any.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
    if low <= high { [low, high] } else { [0.0, 0.0] }
}

/// A range with a margin on both sides; an empty one becomes that of `size`.
fn widened([low, high]: [f64; 2], size: f64) -> [f64; 2] {
    let margin = MARGIN * (high - low).max(1e-3 * size);
    [low - margin, high + margin]
}

impl Surface {
    /// The part of it on which a face lies, whose border has the points `samples`. `to_apex` says that the border goes
    /// once around a cone, so that the face contains its apex.
    ///
    /// # Errors
    /// What is wrong, for a sentence that begins with the face.
    pub fn around(&self, samples: &[DVec3], to_apex: bool) -> Result<SurfaceShape, String> {
        let (low, high) = extent(samples.iter().copied());
        let size = if samples.is_empty() { 0.0 } else { (high - low).length() };
        let whole = [0.0, 360.0];
        match self {
            Surface::Plane(frame) => {
                let x = frame.start;
                let y = frame.axis.cross(x);
                let along = |d: DVec3| widened(range(samples.iter().map(|p| (*p - frame.centre).dot(d))), size);
                let ([x0, x1], [y0, y1]) = (along(x), along(y));
                let corner = frame.centre + x * x0 + y * y0;
                Ok(SurfaceShape::Plane { corner, sides: [x * (x1 - x0), y * (y1 - y0)] })
            }
            Surface::Cone { frame, radius, slope } => {
                let [foot, top] = range(samples.iter().map(|p| (*p - frame.centre).dot(frame.axis)));
                let margin = MARGIN * (top - foot).max(1e-3 * size);
                let at = |h: f64| (radius + slope * h).abs();
                let (foot, top, radii) = if *slope == 0.0 {
                    (foot - margin, top + margin, [*radius; 2])
                } else {
                    let apex = -radius / slope;
                    let least = AT_APEX * size.max(*radius);
                    // The cone opens from the apex towards the face.
                    let opens = if apex <= 0.5 * (foot + top) { 1.0 } else { -1.0 };
                    let (near, far) = if opens > 0.0 { (foot, top) } else { (top, foot) };
                    let gap = (near - apex) * opens;
                    if (far - apex) * opens <= least || gap < -least {
                        return Err("has no width on its cone, or lies on both halves of it".to_owned());
                    }
                    let far = far + opens * margin;
                    let (near, narrow) = if to_apex || gap <= least {
                        (apex, 0.0)
                    } else {
                        let near = near - opens * margin.min(0.5 * gap);
                        (near, at(near))
                    };
                    if opens > 0.0 { (near, far, [narrow, at(far)]) } else { (far, near, [at(far), narrow]) }
                };
                let frame = AxisFrame { centre: frame.centre + frame.axis * foot, ..*frame };
                Ok(SurfaceShape::Cone { frame, radii, height: top - foot, angles: whole })
            }
            Surface::Sphere { frame, radius } => {
                Ok(SurfaceShape::Sphere { frame: *frame, radius: *radius, angles: whole, latitudes: [-90.0, 90.0] })
            }
            Surface::Torus { frame, radius, tube } if tube < radius => {
                let (frame, radius, tube) = (*frame, *radius, *tube);
                Ok(SurfaceShape::Torus { frame, radius, tube, angles: whole, tube_angles: whole })
            }
            Surface::Torus { frame, radius, tube } => spindle(frame, *radius, *tube, samples),
            Surface::Net(net) => Ok(net.shape()),
            Surface::Extrusion { curve, along } => {
                let unit = along.normalize();
                let places = curve.places();
                let [low, high] = range(places.iter().map(|p| p.dot(unit)));
                let [first, last] = range(samples.iter().map(|p| p.dot(unit)));
                // The points of the curve lie between low and high: every point of the face is reached.
                let [from, to] = widened([first - high, last - low], size);
                let shifted = |by: f64| curve.points.iter().map(move |p| *p + (unit * (by * p.w)).extend(0.0));
                let (feet, tops): (Vec<DVec4>, Vec<DVec4>) = (shifted(from).collect(), shifted(to).collect());
                let points = feet.into_iter().zip(tops).flat_map(|(foot, top)| [foot, top]).collect();
                let knots = [curve.knots.clone(), vec![0.0, 0.0, to - from, to - from]];
                Ok(Net { degrees: [curve.degree, 1], knots, points, columns: 2 }.shape())
            }
            Surface::RuledRevolution { frame, origin, along } => {
                let rise = along.dot(frame.axis);
                let at = |p: &DVec3| (*p - *origin).dot(frame.axis) / rise;
                let [from, to] = widened(range(samples.iter().map(at)), size / along.length());
                let points = [*origin + *along * from, *origin + *along * to];
                let length = points[0].distance(points[1]);
                let line = Spline::new(1, vec![0.0, 0.0, length, length], &points, &[]);
                swept(&line, frame)
            }
            Surface::Revolution { frame, curve } => swept(curve, frame),
        }
    }

    /// Whether another surface is this one within a tolerance, as far as that is easily known: `Some(true)` if both
    /// have the same normal.
    pub fn coincides(&self, other: &Surface, tolerance: f64) -> Option<bool> {
        let apart = |p: DVec3, frame: &AxisFrame| {
            let p = p - frame.centre;
            (p - frame.axis * p.dot(frame.axis)).length()
        };
        let parallel = |a: &AxisFrame, b: &AxisFrame| a.axis.cross(b.axis).length() < 1e-6;
        let near = |a: f64, b: f64| (a - b).abs() <= tolerance;
        match (self, other) {
            (Surface::Plane(a), Surface::Plane(b)) => {
                let is_same = parallel(a, b) && (a.centre - b.centre).dot(a.axis).abs() <= tolerance;
                is_same.then(|| a.axis.dot(b.axis) > 0.0)
            }
            (Surface::Cone { frame: a, radius: r, slope: s }, Surface::Cone { frame: b, radius: q, slope: t }) => {
                let along = a.axis.dot(b.axis).signum();
                let at_b = r + s * (b.centre - a.centre).dot(a.axis);
                let is_same = parallel(a, b) && apart(b.centre, a) <= tolerance && near(at_b, *q);
                (is_same && (s - t * along).abs() < 1e-6).then_some(true)
            }
            (Surface::Sphere { frame: a, radius: r }, Surface::Sphere { frame: b, radius: q }) => {
                (a.centre.distance(b.centre) <= tolerance && near(*r, *q)).then_some(true)
            }
            (Surface::Torus { frame: a, radius: r, tube: s }, Surface::Torus { frame: b, radius: q, tube: t }) => {
                let is_same =
                    parallel(a, b) && a.centre.distance(b.centre) <= tolerance && near(*r, *q) && near(*s, *t);
                is_same.then_some(true)
            }
            _ => None,
        }
    }

    /// Whether a loop goes around its axis: the turns of points on it about the axis, to the nearest whole number.
    pub fn turns(&self, points: &[DVec3]) -> i32 {
        let (Surface::Cone { frame, .. }
        | Surface::Sphere { frame, .. }
        | Surface::Torus { frame, .. }
        | Surface::RuledRevolution { frame, .. }
        | Surface::Revolution { frame, .. }) = self
        else {
            return 0;
        };
        let y = frame.axis.cross(frame.start);
        let angle = |p: &DVec3| libm::atan2((*p - frame.centre).dot(y), (*p - frame.centre).dot(frame.start));
        let mut turned = 0.0;
        for (k, p) in points.iter().enumerate() {
            let step = angle(&points[(k + 1) % points.len()]) - angle(p);
            turned += step - TAU * (step / TAU).round();
        }
        (turned / TAU).round() as i32
    }
}

/// The frame of a sphere for a face with these loops on its left, seen from outside (from inside if `reversed`): the
/// poles of a sphere may be anywhere. A face that goes not too far around a pole is drawn about it; else no loop is to
/// cross the equator, where the sphere is divided.
pub(super) fn sphere_frame(frame: &AxisFrame, loops: &[Vec<DVec3>], reversed: bool) -> AxisFrame {
    /// The cosine of the largest angle between a pole and a face that is drawn about it.
    const FARTHEST: f64 = -0.7;
    /// The sine of the least latitude of a loop that does not cross the equator.
    const CLEAR: f64 = 0.02;
    let about =
        |axis: DVec3| AxisFrame::new(frame.centre, axis, Some(frame.start).filter(|s| s.cross(axis).length() > 0.1));
    let rings: Vec<Vec<DVec3>> =
        loops.iter().map(|points| points.iter().map(|p| (*p - frame.centre).normalize_or_zero()).collect()).collect();
    let middle = |ring: &Vec<DVec3>| {
        let next = |k: usize| ring[(k + 1) % ring.len()];
        // The vector area points to the middle of a loop that is anticlockwise seen from outside.
        (0..ring.len()).map(|k| ring[k].cross(next(k))).sum::<DVec3>().normalize_or_zero()
            * if reversed { -1.0 } else { 1.0 }
    };
    let middles: Vec<DVec3> = rings.iter().map(middle).filter(|m| *m != DVec3::ZERO).collect();
    if let ([ring], [pole]) = (&rings[..], &middles[..])
        && ring.iter().all(|d| d.dot(*pole) > FARTHEST)
    {
        return about(*pole).unwrap_or(*frame);
    }
    let is_clear = |axis: &DVec3| {
        rings.iter().all(|ring| {
            let [low, high] = range(ring.iter().map(|d| d.dot(*axis)));
            low > CLEAR || high < -CLEAR
        })
    };
    let others = [frame.axis, frame.start, frame.axis.cross(frame.start)];
    let diagonal =
        [DVec3::new(1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 0.5), DVec3::new(-0.5, 1.0, 1.0)].map(DVec3::normalize);
    let all = std::iter::once(frame.axis).chain(middles).chain(others).chain(diagonal);
    let found = all.into_iter().find(is_clear);
    found.and_then(|axis| about(axis).ok()).unwrap_or(*frame)
}

/// The surface that a spline sweeps about an axis in a whole turn.
fn swept(curve: &Spline, frame: &AxisFrame) -> Result<SurfaceShape, String> {
    let made = curve.checked().and_then(|curve| revolution(&curve, frame, [0.0, 360.0]));
    let surface: NurbsSurface =
        made.map_err(|fault| format!("lies on a surface of revolution that is refused: {fault}"))?;
    Ok(surface.shape())
}

/// The part of a torus that cuts itself on which a face lies: the arc of the tube that its border spans.
fn spindle(frame: &AxisFrame, radius: f64, tube: f64, samples: &[DVec3]) -> Result<SurfaceShape, String> {
    let refused = || "lies on a torus that cuts itself, and goes across where it does".to_owned();
    // The outer part has a positive distance from the axis, the inner one (a lemon) a negative one.
    let half = libm::acos((-radius / tube).clamp(-1.0, 1.0));
    let angles = samples.iter().map(|p| {
        let p = *p - frame.centre;
        let height = p.dot(frame.axis);
        let out = (p - frame.axis * height).length() - radius;
        libm::atan2(height, out)
    });
    let [low, high] = range(angles);
    if low < -half - 1e-6 || high > half + 1e-6 {
        return Err(refused());
    }
    let [low, high] = widened([low, high], 1.0).map(|angle| angle.clamp(-half, half));
    let centre = frame.centre + frame.start * radius;
    let (x, y) = (frame.start * tube, frame.axis * tube);
    swept(&Spline::ellipse(centre, x, y, [low, high]), frame)
}
