//! Statistics of a mesh, in its metric and physically: distributions of angles (fig. 24) and edge lengths (fig. 23),
//! irregular nodes, scaled Jacobian, quality. Computed from plain arrays, so that any mesh can be measured.

use glam::{DVec2, DVec3};
use serde::Serialize;

use crate::core::geometry::Atlas;
use crate::core::kernel::Metric2;
use crate::core::mesh::{FULL_TURN, PointId, twelfths};
use crate::core::metric::measure::{
    angle, angles_in_space, length_exact, quad_quality, scaled_jacobian, triangle_quality,
};
use crate::core::metric::straight_quad::StraightQuad;
use crate::core::metric::{BadMetric, MetricSource};

/// Number of angle classes, each 10 degrees wide; the last has no upper limit.
pub const ANGLE_CLASSES: usize = 18;

/// Number of length classes, each 0.1 wide; the last has no upper limit.
pub const LENGTH_CLASSES: usize = 31;

/// The Euclidean metric of the plane.
const PLANE: Metric2 = Metric2 { uu: 1.0, uv: 0.0, vv: 1.0 };

/// A mesh to be measured.
#[derive(Clone, Copy)]
pub struct Measured<'a> {
    /// Coordinates of each node.
    pub uv: &'a [DVec2],
    /// Output point of each node; copies of a node on both sides of a curve share one.
    pub points: &'a [PointId],
    /// Triangles, anticlockwise.
    pub triangles: &'a [[u32; 3]],
    /// Quadrilaterals, anticlockwise.
    pub quads: &'a [[u32; 4]],
    /// Where the mesh lies in space; `None` in the plane.
    pub surfaces: Option<OnSurfaces<'a>>,
}

/// Where a mesh lies in space.
#[derive(Clone, Copy)]
pub struct OnSurfaces<'a> {
    /// The charts of its surfaces.
    pub atlas: &'a Atlas,
    /// The position of each output point.
    pub xyz: &'a [DVec3],
}

/// Statistics of a mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Statistics {
    /// Output points in use.
    pub nodes: usize,
    /// Triangles.
    pub triangles: usize,
    /// Quadrilaterals.
    pub quads: usize,
    /// Edges; edges between copies of the same two points count once.
    pub edges: usize,
    /// Angles in the metric at the corner.
    pub metric_angles: Angles,
    /// Physical angles: in space, between straight sides.
    pub physical_angles: Angles,
    /// Edge lengths in the metric, integrated along the edge.
    pub lengths: Lengths,
    /// Irregular nodes inside faces.
    pub irregular: Irregular,
    /// Scaled Jacobian of the quadrilaterals in the metric, minimum over the corners; `None` without quadrilaterals.
    pub metric_scaled_jacobian: Option<Range>,
    /// Physical scaled Jacobian of the quadrilaterals, on surfaces in the tangent planes of the corners, minimum over
    /// the corners; `None` without quadrilaterals.
    pub physical_scaled_jacobian: Option<Range>,
    /// What Verdict, the library of VTK and ParaView, says of the quadrilaterals; `None` without quadrilaterals.
    pub verdict: Option<VerdictSpreads>,
    /// Shape in the metric (docs/algorithm.md, "Quality"): 1 for the square and the equilateral triangle.
    pub quality: Option<Range>,
}

/// Minimum and mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// The minimum.
    pub min: f64,
    /// The mean.
    pub mean: f64,
}

/// Minimum, maximum and mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The minimum.
    pub min: f64,
    /// The maximum.
    pub max: f64,
    /// The mean.
    pub mean: f64,
}

/// Verdict's measures of all quadrilaterals, from the coordinates of their corners
/// ([`VerdictMeasures`](crate::core::metric::straight_quad::VerdictMeasures)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VerdictSpreads {
    /// Scaled Jacobian: above 0 in elements that solvers accept.
    pub scaled_jacobian: Spread,
    /// Aspect ratio, from 1.
    pub aspect_ratio: Spread,
    /// Skew, from 0.
    pub skew: Spread,
    /// Warpage: 1 where elements are flat.
    pub warpage: Spread,
}

/// A distribution of corner angles, in degrees.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Angles {
    /// The minimum.
    pub min: f64,
    /// The maximum.
    pub max: f64,
    /// Share of corners within [60, 120].
    pub share_60_120: f64,
    /// Share of corners within [30, 160].
    pub share_30_160: f64,
    /// Number of corners in each class of 10 degrees.
    pub corners: [u64; ANGLE_CLASSES],
    /// Number of elements by class of their smallest angle (fig. 24).
    pub least_of_element: [u64; ANGLE_CLASSES],
    /// Number of elements by class of their largest angle (fig. 24).
    pub greatest_of_element: [u64; ANGLE_CLASSES],
}

/// A distribution of edge lengths in the metric.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lengths {
    /// The minimum.
    pub min: f64,
    /// The maximum.
    pub max: f64,
    /// The mean.
    pub mean: f64,
    /// The standard deviation.
    pub deviation: f64,
    /// Share within [1/sqrt 2, sqrt 2].
    pub share_unit: f64,
    /// Number of edges in each class of 0.1, of which fig. 23 draws proportions.
    pub edges: [u64; LENGTH_CLASSES],
}

/// Nodes inside faces, away from every curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Irregular {
    /// Their number.
    pub interior: usize,
    /// Number of irregular ones: not four quadrilaterals, six triangles, or an equivalent mixture.
    pub irregular: usize,
    /// Percentage of irregular ones.
    pub percent: f64,
}

impl Statistics {
    /// Measures a mesh with valid indices in the metric of `source`.
    ///
    /// # Errors
    /// A node or edge at which `source` has no metric.
    pub fn measure(mesh: Measured<'_>, source: &dyn MetricSource) -> Result<Statistics, Box<BadMetric>> {
        let metrics = mesh.uv.iter().map(|&uv| source.metric(uv)).collect::<Result<Vec<_>, _>>()?;
        // The physical metric at a node: Euclidean, or the first fundamental form of the surface.
        let seen: Vec<Metric2> = match mesh.surfaces {
            None => Vec::new(),
            Some(OnSurfaces { atlas, .. }) => mesh.uv.iter().map(|&uv| atlas.at(uv).first_form()).collect(),
        };
        let seen = |n: u32| seen.get(n as usize).copied().unwrap_or(PLANE);
        let xyz = |n: u32| match mesh.surfaces {
            None => mesh.uv[n as usize].extend(0.0),
            Some(OnSurfaces { xyz, .. }) => xyz[mesh.points[n as usize].index()],
        };
        let mut tally = Tally::default();
        for triangle in mesh.triangles {
            let p = triangle.map(|n| mesh.uv[n as usize]);
            tally.angles(&p, &triangle.map(|n| metrics[n as usize]), &triangle.map(xyz));
            let at_centroid = source.metric((p[0] + p[1] + p[2]) / 3.0)?;
            tally.quality.add(triangle_quality(&at_centroid, p[0], p[1], p[2]));
        }
        for quad in mesh.quads {
            let p = quad.map(|n| mesh.uv[n as usize]);
            let m = quad.map(|n| metrics[n as usize]);
            tally.angles(&p, &m, &quad.map(xyz));
            tally.quality.add(quad_quality(m.each_ref(), p));
            tally.metric_jacobian.add(scaled_jacobian(&m, p));
            tally.physical_jacobian.add(scaled_jacobian(&quad.map(seen), p));
            tally.verdict.add(&StraightQuad(quad.map(xyz)));
        }
        let (edges, interior) = edges_and_interior(&mesh);
        let lengths = edges.iter().map(|[a, b]| length_exact(source, mesh.uv[*a as usize], mesh.uv[*b as usize]));
        let lengths = Lengths::of(&lengths.collect::<Result<Vec<_>, _>>()?);
        let mut used = vec![false; mesh.points.len()];
        let corners = mesh.triangles.as_flattened().iter().chain(mesh.quads.as_flattened());
        corners.for_each(|n| used[mesh.points[*n as usize].index()] = true);
        Ok(Statistics {
            nodes: used.iter().filter(|used| **used).count(),
            triangles: mesh.triangles.len(),
            quads: mesh.quads.len(),
            edges: edges.len(),
            metric_angles: tally.metric_angles.angles(),
            physical_angles: tally.physical_angles.angles(),
            lengths,
            irregular: irregular(&mesh, &interior),
            metric_scaled_jacobian: tally.metric_jacobian.range(),
            physical_scaled_jacobian: tally.physical_jacobian.range(),
            verdict: tally.verdict.spreads(),
            quality: tally.quality.range(),
        })
    }
}

/// Every edge once (copies of the same two points are one edge), and for each node whether it is on no curve.
fn edges_and_interior(mesh: &Measured<'_>) -> (Vec<[u32; 2]>, Vec<bool>) {
    let mut sides = Vec::with_capacity(mesh.triangles.len() * 3 + mesh.quads.len() * 4);
    let mut walk = |nodes: &[u32]| {
        for (k, &a) in nodes.iter().enumerate() {
            let b = nodes[(k + 1) % nodes.len()];
            sides.push([a.min(b), a.max(b)]);
        }
    };
    mesh.triangles.iter().for_each(|t| walk(t));
    mesh.quads.iter().for_each(|q| walk(q));
    sides.sort_unstable();
    let mut interior = vec![true; mesh.uv.len()];
    let mut edges = Vec::with_capacity(sides.len() / 2 + 1);
    let mut on_curves = Vec::new();
    for same in sides.chunk_by(|a, b| a == b) {
        let [a, b] = same[0];
        if same.len() == 1 {
            (interior[a as usize], interior[b as usize]) = (false, false);
            let (p, q) = (mesh.points[a as usize], mesh.points[b as usize]);
            on_curves.push(([p.min(q), p.max(q)], [a, b]));
        } else {
            edges.push([a, b]);
        }
    }
    on_curves.sort_unstable();
    on_curves.dedup_by_key(|edge| edge.0);
    edges.extend(on_curves.iter().map(|edge| edge.1));
    (edges, interior)
}

fn irregular(mesh: &Measured<'_>, interior: &[bool]) -> Irregular {
    let mut turns = vec![0_u32; mesh.uv.len()];
    mesh.triangles.as_flattened().iter().for_each(|n| turns[*n as usize] += twelfths(false));
    mesh.quads.as_flattened().iter().for_each(|n| turns[*n as usize] += twelfths(true));
    let inside = || turns.iter().zip(interior).filter(|(turn, inside)| **turn > 0 && **inside);
    let (interior, irregular) = (inside().count(), inside().filter(|(turn, _)| **turn != FULL_TURN).count());
    Irregular { interior, irregular, percent: 100.0 * share(irregular as u64, interior as u64) }
}

fn share(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// Running sums over the elements.
#[derive(Default)]
struct Tally {
    metric_angles: AngleTally,
    physical_angles: AngleTally,
    quality: RangeTally,
    metric_jacobian: RangeTally,
    physical_jacobian: RangeTally,
    verdict: VerdictTally,
}

impl Tally {
    fn angles<const N: usize>(&mut self, p: &[DVec2; N], m: &[Metric2; N], xyz: &[DVec3; N]) {
        let in_metric = |k: usize| angle(&m[k], p[(k + 1) % N] - p[k], p[(k + N - 1) % N] - p[k]);
        self.metric_angles.add((0..N).map(in_metric));
        self.physical_angles.add(angles_in_space(xyz));
    }
}

#[derive(Default)]
struct RangeTally {
    count: u64,
    sum: f64,
    min: f64,
    max: f64,
}

impl RangeTally {
    fn add(&mut self, value: f64) {
        let is_first = self.count == 0;
        self.min = if is_first { value } else { self.min.min(value) };
        self.max = if is_first { value } else { self.max.max(value) };
        self.count += 1;
        self.sum += value;
    }

    fn range(&self) -> Option<Range> {
        self.spread().map(|Spread { min, mean, .. }| Range { min, mean })
    }

    fn spread(&self) -> Option<Spread> {
        (self.count > 0).then(|| Spread { min: self.min, max: self.max, mean: self.sum / self.count as f64 })
    }
}

#[derive(Default)]
struct VerdictTally {
    scaled_jacobian: RangeTally,
    aspect_ratio: RangeTally,
    skew: RangeTally,
    warpage: RangeTally,
}

impl VerdictTally {
    fn add(&mut self, quad: &StraightQuad) {
        let measures = quad.measures();
        self.scaled_jacobian.add(measures.scaled_jacobian);
        self.aspect_ratio.add(measures.aspect_ratio);
        self.skew.add(measures.skew);
        self.warpage.add(measures.warpage);
    }

    fn spreads(&self) -> Option<VerdictSpreads> {
        Some(VerdictSpreads {
            scaled_jacobian: self.scaled_jacobian.spread()?,
            aspect_ratio: self.aspect_ratio.spread()?,
            skew: self.skew.spread()?,
            warpage: self.warpage.spread()?,
        })
    }
}

#[derive(Default)]
struct AngleTally {
    count: u64,
    min: f64,
    max: f64,
    within_60_120: u64,
    within_30_160: u64,
    corners: [u64; ANGLE_CLASSES],
    least: [u64; ANGLE_CLASSES],
    greatest: [u64; ANGLE_CLASSES],
}

impl AngleTally {
    /// Adds the angles of an element, in radians.
    fn add(&mut self, angles: impl Iterator<Item = f64>) {
        let first = self.count == 0;
        let class = |degrees: f64| ((degrees / 10.0) as usize).min(ANGLE_CLASSES - 1);
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        for theta in angles.map(f64::to_degrees) {
            // Tolerates rounding at the limits.
            let within = |low: f64, high: f64| u64::from(theta > low - 1e-9 && theta < high + 1e-9);
            self.within_60_120 += within(60.0, 120.0);
            self.within_30_160 += within(30.0, 160.0);
            self.corners[class(theta)] += 1;
            self.count += 1;
            (least, greatest) = (least.min(theta), greatest.max(theta));
        }
        self.least[class(least)] += 1;
        self.greatest[class(greatest)] += 1;
        self.min = if first { least } else { self.min.min(least) };
        self.max = if first { greatest } else { self.max.max(greatest) };
    }

    fn angles(self) -> Angles {
        Angles {
            min: self.min,
            max: self.max,
            share_60_120: share(self.within_60_120, self.count),
            share_30_160: share(self.within_30_160, self.count),
            corners: self.corners,
            least_of_element: self.least,
            greatest_of_element: self.greatest,
        }
    }
}

impl Lengths {
    fn of(lengths: &[f64]) -> Lengths {
        let count = lengths.len() as f64;
        let mean = if lengths.is_empty() { 0.0 } else { lengths.iter().sum::<f64>() / count };
        let squares: f64 = lengths.iter().map(|l| (l - mean) * (l - mean)).sum();
        let mut edges = [0; LENGTH_CLASSES];
        lengths.iter().for_each(|l| edges[((l * 10.0) as usize).min(LENGTH_CLASSES - 1)] += 1);
        let unit = std::f64::consts::FRAC_1_SQRT_2..=std::f64::consts::SQRT_2;
        let (least, greatest) = (f64::min as fn(f64, f64) -> f64, f64::max as fn(f64, f64) -> f64);
        Lengths {
            min: lengths.iter().copied().reduce(least).unwrap_or(0.0),
            max: lengths.iter().copied().reduce(greatest).unwrap_or(0.0),
            mean,
            deviation: if lengths.is_empty() { 0.0 } else { (squares / count).sqrt() },
            share_unit: share(lengths.iter().filter(|l| unit.contains(l)).count() as u64, lengths.len() as u64),
            edges,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::kernel::Metric2;

    /// A constant metric.
    struct Constant(Metric2);

    impl MetricSource for Constant {
        fn metric(&self, _: DVec2) -> Result<Metric2, Box<BadMetric>> {
            Ok(self.0)
        }
    }

    /// n by n squares of side 1 / n.
    fn squares(n: u32) -> (Vec<DVec2>, Vec<PointId>, Vec<[u32; 4]>) {
        let step = 1.0 / f64::from(n);
        let node = |i: u32, j: u32| j * (n + 1) + i;
        let uv: Vec<_> =
            (0..=n).flat_map(|j| (0..=n).map(move |i| DVec2::new(f64::from(i), f64::from(j)) * step)).collect();
        let quads =
            (0..n).flat_map(|j| (0..n).map(move |i| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]));
        let points = (0..uv.len() as u32).map(PointId).collect();
        (uv, points, quads.collect())
    }

    #[test]
    fn squares_of_unit_size_are_perfect() {
        let (uv, points, quads) = squares(4);
        let mesh = Measured { uv: &uv, points: &points, triangles: &[], quads: &quads, surfaces: None };
        let found = Statistics::measure(mesh, &Constant(Metric2::isotropic(0.25))).unwrap();
        assert_eq!((found.nodes, found.quads, found.edges), (25, 16, 40));
        assert_eq!((found.irregular.interior, found.irregular.irregular), (9, 0));
        assert!((found.lengths.mean - 1.0).abs() < 1e-12 && found.lengths.deviation < 1e-12);
        assert!((found.lengths.share_unit - 1.0).abs() < 1e-12);
        assert_eq!(found.metric_angles.share_60_120, 1.0);
        assert!((found.metric_angles.min - 90.0).abs() < 1e-9 && (found.metric_angles.max - 90.0).abs() < 1e-9);
        assert!((found.metric_scaled_jacobian.unwrap().min - 1.0).abs() < 1e-12);
        assert!((found.quality.unwrap().mean - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_sheared_metric_changes_metric_but_not_physical_angles_and_lengths() {
        let uv = [(0.0, 0.0), (2.0, 0.0), (2.5, 1.0), (0.5, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let points = [0, 1, 2, 3].map(PointId);
        let mesh = Measured { uv: &uv, points: &points, triangles: &[], quads: &[[0, 1, 2, 3]], surfaces: None };
        let sheared = Metric2 { uu: 0.25, uv: -0.125, vv: 1.0625 };
        let found = Statistics::measure(mesh, &Constant(sheared)).unwrap();
        assert!((found.metric_scaled_jacobian.unwrap().min - 1.0).abs() < 1e-12, "a unit square of that metric");
        assert!((found.lengths.mean - 1.0).abs() < 1e-12);
        let physical = libm::atan2(1.0, 0.5).to_degrees();
        assert!((found.physical_angles.min - physical).abs() < 1e-9);
        assert!((found.physical_angles.max - (180.0 - physical)).abs() < 1e-9);
        assert_eq!(found.physical_angles.greatest_of_element[11], 1);
    }

    #[test]
    fn an_edge_on_a_shared_curve_counts_once_and_on_a_crack_twice() {
        // Two adjacent squares with doubled nodes along their common line.
        let uv = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)];
        let uv = uv.map(|(x, y)| DVec2::new(x, y));
        let quads = [[0, 1, 2, 3], [4, 5, 6, 7]];
        let measured = |points: [u32; 8]| {
            let points = points.map(PointId);
            let mesh = Measured { uv: &uv, points: &points, triangles: &[], quads: &quads, surfaces: None };
            let found = Statistics::measure(mesh, &Constant(Metric2::isotropic(1.0))).unwrap();
            (found.nodes, found.edges, found.irregular.interior)
        };
        assert_eq!(measured([0, 1, 2, 3, 1, 4, 5, 2]), (6, 7, 0));
        assert_eq!(measured([0, 1, 2, 3, 6, 4, 5, 7]), (8, 8, 0));
    }

    #[test]
    fn triangles_and_mixtures_are_measured_too() {
        let (uv, points, quads) = squares(2);
        let cut: Vec<_> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        let source = Constant(Metric2::isotropic(0.5));
        let all = Measured { uv: &uv, points: &points, triangles: &cut, quads: &[], surfaces: None };
        let found = Statistics::measure(all, &source).unwrap();
        assert_eq!((found.triangles, found.edges, found.irregular.irregular), (8, 16, 0), "six triangles meet inside");
        assert!(found.metric_scaled_jacobian.is_none());
        let mixed = Measured { uv: &uv, points: &points, triangles: &cut[..2], quads: &quads[1..], surfaces: None };
        let found = Statistics::measure(mixed, &source).unwrap();
        assert_eq!((found.triangles, found.quads, found.edges), (2, 3, 13));
        assert_eq!(found.irregular.irregular, 1, "three quadrilaterals and two triangles are more than a turn");
    }
}
