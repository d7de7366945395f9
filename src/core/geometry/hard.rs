//! Hard points of a domain: places that become nodes, exactly. A point on a curve divides it there, one at a vertex is
//! that vertex, any other lies inside a face.

use glam::DVec2;

use super::assembly::placed;
use super::crossing::bulge;
use super::curve::distance_to_segment;
use super::domain::Domain;
use super::domain_curve::CurveId;
use super::domain_point::{DomainPoint, PointOn};
use super::spec::PointSpec;
use crate::core::fault::Fault;
use crate::core::kernel::decimal::point_text;

/// A point nearer to a curve or a vertex than this, as a fraction of the domain, lies on it.
const ON_CURVE: f64 = 1e-6;
/// Bisections of a curve's parameter: until double precision has no more.
const BISECTIONS: usize = 100;

impl Domain {
    /// A planar domain with the hard points of a case.
    ///
    /// # Errors
    /// A point outside of all faces; two points at one place.
    pub fn with_points(mut self, points: &[PointSpec]) -> Result<Domain, Fault> {
        let near = ON_CURVE * self.size;
        let mut sorted: Vec<&PointSpec> = points.iter().collect();
        sorted.sort_by(|a, b| a.at.x.total_cmp(&b.at.x).then(a.at.y.total_cmp(&b.at.y)));
        for (k, point) in sorted.iter().enumerate() {
            let mut others = sorted[k + 1..].iter().take_while(|other| other.at.x - point.at.x <= near);
            if let Some(other) = others.find(|other| other.at.distance(point.at) <= near) {
                let what = format!("The points \"{}\" and \"{}\" are at one place", point.name, other.name);
                return Err(placed(Fault::new(what).remedy("Remove one of them"), &point.place));
            }
        }
        for point in points {
            let on = self.under(point.at, near);
            if on == PointOn::Face && self.inside(point.at).is_none() {
                let fault = Fault::new(format!("The point \"{}\" lies outside of all faces", point.name));
                let fault = fault.at(format!("at {}", point_text(point.at)));
                return Err(placed(fault.remedy("Move it inside, or remove it"), &point.place));
            }
            self.points.push(DomainPoint { uv: point.at, xyz: point.at.extend(0.0), on });
        }
        Ok(self)
    }

    /// What lies within a distance of a point: a vertex, else the nearest curve.
    fn under(&self, p: DVec2, near: f64) -> PointOn {
        if let Some(vertex) = self.vertices.iter().position(|v| v.distance(p) <= near) {
            return PointOn::Vertices(vec![vertex as u32]);
        }
        let mut best: Option<(f64, CurveId, f64)> = None;
        for (id, curve) in (0..).map(CurveId).zip(&self.curves) {
            for w in curve.fine.windows(2) {
                if distance_to_segment(p, w[0].1, w[1].1) > near + bulge(curve, w[0], w[1]) {
                    continue;
                }
                // The distance falls and then rises along a chord this short.
                let (mut from, mut to) = (w[0].0, w[1].0);
                for _ in 0..BISECTIONS {
                    let third = (to - from) / 3.0;
                    let off = |t: f64| curve.curve.point(t).distance_squared(p);
                    if off(from + third) <= off(to - third) { to -= third } else { from += third }
                }
                let t = 0.5 * (from + to);
                let off = curve.curve.point(t).distance(p);
                if off <= near && best.is_none_or(|known| off < known.0) {
                    best = Some((off, id, t));
                }
            }
        }
        let Some((_, id, t)) = best else { return PointOn::Face };
        // At a corner, its own parameter.
        let curve = &self.curves[id.index()].curve;
        let corner = curve.corners().iter().copied().find(|&corner| curve.point(corner).distance(p) <= near);
        PointOn::Curve(id, corner.unwrap_or(t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::geometry::fixtures::{built, square_with_hole};

    fn point(name: &str, x: f64, y: f64) -> PointSpec {
        PointSpec { name: name.to_owned(), at: DVec2::new(x, y), size: None, growth: 1.2, place: String::new() }
    }

    #[test]
    fn points_lie_inside_faces_on_curves_or_at_vertices() {
        let domain = built(square_with_hole());
        let corner = domain.vertices[0];
        let curve = domain.curves.iter().position(|curve| !curve.curve.straight()).unwrap();
        let on_hole = domain.curves[curve].curve.point(0.3);
        let inside = DVec2::new(0.1, 0.15);
        let points = [("a", inside), ("b", on_hole), ("c", corner)].map(|(name, p)| point(name, p.x, p.y));
        let on: Vec<PointOn> =
            domain.clone().with_points(&points).unwrap().points.into_iter().map(|point| point.on).collect();
        assert_eq!((&on[0], &on[2]), (&PointOn::Face, &PointOn::Vertices(vec![0])));
        assert!(matches!(on[1], PointOn::Curve(id, t) if id.index() == curve && (t - 0.3).abs() < 1e-9), "{on:?}");
        let told = |points: &[PointSpec]| domain.clone().with_points(points).unwrap_err().to_string();
        assert!(told(&[point("far", 1e3, 0.0)]).contains("\"far\" lies outside"));
        assert!(told(&[points[0].clone(), points[0].clone()]).contains("at one place"));
    }
}
