//! The surface's own triangles as a background: each chart is a flattened face with its border kept. Counts are made
//! even by dividing sides between charts. Deliberately absent: remeshing the shape (`surface`).

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::chart::Chart;
use super::defects::capital;
use super::edges::{Corner, Edge, Edges, Triangles};
use super::right_angled::right_angles;
use super::surface::{Surface, sides};
use crate::core::fault::Fault;
use crate::core::kernel::decimal::point_text;
use crate::core::kernel::parity::fewest_toggles;
use crate::core::kernel::predicates::firm;
use crate::core::kernel::{DisjointSets, LogMetric3, Metric3};
use crate::core::mesh::{PointId, TriangleSet};

/// A chart whose sides are being divided.
struct DividedChart {
    uv: Vec<DVec2>,
    points: Vec<u32>,
    local: Vec<[u32; 3]>,
    /// The surface triangle that each is, or is a part of.
    triangles: Vec<u32>,
}

impl Surface {
    /// The triangles of the surface `mesh`, chart by chart in the plane, and the number of sides divided to give every
    /// chart an even number of triangles. Sides on the border of the surface are divided only with `split_odd`.
    ///
    /// # Errors
    /// An open part with an odd number of triangles; triangles that are too flat in space or in the plane.
    pub fn triangles(&self, mesh: &Triangles, split_odd: bool) -> Result<(TriangleSet, usize), Fault> {
        let offset = |k: usize| self.domain.spatial.as_ref().map_or(DVec2::ZERO, |spatial| spatial.atlas.offset(k));
        let divided_chart = |(k, chart): (usize, &Chart)| DividedChart {
            uv: chart.uv.iter().map(|&uv| uv + offset(k)).collect(),
            points: chart.points.clone(),
            local: chart.local.clone(),
            triangles: chart.triangles.clone(),
        };
        let mut charts: Vec<DividedChart> = self.charts.iter().enumerate().map(divided_chart).collect();
        let mut points = mesh.points.clone();
        let divided = divide_odd(mesh, &self.charts, split_odd)?;
        let mut lines = mesh.lines.clone();
        for &[a, b] in &divided {
            let middle = points.len() as u32;
            points.push(0.5 * (points[a as usize] + points[b as usize]));
            if let Ok(k) = mesh.lines.binary_search_by_key(&[a, b], |line| line.0) {
                let line = lines[k].1;
                lines[k].0 = [a, middle];
                lines.push(([b, middle], line));
            }
            charts.iter_mut().for_each(|chart| chart.divide([a, b], middle));
        }
        let mut set = TriangleSet::default();
        let mut flat: Vec<(u32, [DVec3; 3])> = Vec::new();
        let corners_of = |chart: &DividedChart| -> Vec<[u32; 3]> {
            chart.local.iter().map(|t| t.map(|node| chart.points[node as usize])).collect()
        };
        let mut fans = Fans::of(charts.iter().flat_map(corners_of).collect());
        let mut number = vec![u32::MAX; 3 * fans.triangles.len()];
        let mut triangle = 0;
        for (k, chart) in charts.iter().enumerate() {
            let first = set.uv.len() as u32;
            // A corner of each node.
            let mut corner_of = vec![0; chart.uv.len()];
            for t in &chart.local {
                (0..3).for_each(|corner| corner_of[t[corner] as usize] = 3 * triangle + corner as u32);
                triangle += 1;
            }
            for ((&uv, &point), corner) in chart.uv.iter().zip(&chart.points).zip(corner_of) {
                let known = &mut number[fans.sets.find(corner) as usize];
                if *known == u32::MAX {
                    *known = set.xyz.len() as u32;
                    set.xyz.push(points[point as usize]);
                }
                if let Some(hard) = mesh.hard_number(point) {
                    set.hard.push((set.uv.len() as u32, hard));
                }
                set.uv.push(uv);
                set.point.push(PointId(*known));
            }
            for (t, &given) in chart.local.iter().zip(&chart.triangles) {
                let [a, b, c] = t.map(|node| chart.uv[node as usize]);
                if !firm(a, b, c) {
                    flat.push((given, t.map(|node| points[chart.points[node as usize] as usize])));
                }
                set.triangles.push(t.map(|node| first + node));
                set.region.push(k as u32);
            }
        }
        if !flat.is_empty() {
            return Err(flat_fault(mesh, &flat));
        }
        let mut numbered = |&(ends, line): &([u32; 2], u32)| {
            let at = fans.corners(ends)?;
            Some((at.map(|corner| PointId(number[fans.sets.find(corner) as usize])), line))
        };
        set.lines = lines.iter().filter_map(&mut numbered).collect();
        Ok((set, divided.len()))
    }
}

/// Triangles by their points, with the corners of each fan around a point joined: parts that touch in a point only have
/// a node each there.
struct Fans {
    triangles: Vec<[u32; 3]>,
    edges: Edges,
    /// Sets of corners.
    sets: DisjointSets,
}

impl Fans {
    fn of(triangles: Vec<[u32; 3]>) -> Fans {
        let (edges, sets) = (Edges::of(&triangles), DisjointSets::new(3 * triangles.len()));
        let mut fans = Fans { triangles, edges, sets };
        for edge in 0..fans.edges.len() {
            let Edge { ends, sides } = fans.edges.get(edge);
            let [first, others] = [&sides[..1], &sides[1..]];
            for (end, other) in ends.into_iter().flat_map(|end| others.iter().map(move |&other| (end, other))) {
                let [a, b] = [first[0], other].map(|side| at_end(&fans.triangles, side, end));
                fans.sets.join(a, b);
            }
        }
        fans
    }

    /// A corner at each end of an edge.
    fn corners(&self, ends: [u32; 2]) -> Option<[u32; 2]> {
        let side = self.edges.get(self.edges.between(ends)?).sides[0];
        Some(ends.map(|end| at_end(&self.triangles, side, end)))
    }
}

/// The corner at an end of a side.
fn at_end(triangles: &[[u32; 3]], side: Corner, end: u32) -> Corner {
    let own = triangles[side as usize / 3][side as usize % 3] == end;
    if own { side } else { side - side % 3 + (side + 1) % 3 }
}

impl DividedChart {
    /// Divides the triangles at a side, on both sides of a slit.
    fn divide(&mut self, [a, b]: [u32; 2], middle: u32) {
        let is_side = |at: &DividedChart, t: usize, k: usize, [a, b]: [u32; 2]| {
            let node = |k: usize| at.points[at.local[t][k % 3] as usize];
            (node(k), node(k + 1)) == (a, b) || (node(k), node(k + 1)) == (b, a)
        };
        let sides: Vec<(usize, usize)> = (0..self.local.len())
            .flat_map(|t| [0, 1, 2].map(|k| (t, k)))
            .filter(|&(t, k)| is_side(self, t, k, [a, b]))
            .collect();
        for (t, k) in sides {
            let [p, q, r] = [0, 1, 2].map(|i| self.local[t][(k + i) % 3]);
            let new = self.uv.len() as u32;
            self.uv.push(0.5 * (self.uv[p as usize] + self.uv[q as usize]));
            self.points.push(middle);
            self.local[t] = [p, new, r];
            self.local.push([new, q, r]);
            self.triangles.push(self.triangles[t]);
        }
    }
}

/// The sides to divide, by their end points, so that every border loop has an even number of sides, and thus every
/// chart an even number of triangles; if that is impossible, only the latter.
fn divide_odd(mesh: &Triangles, charts: &[Chart], split_odd: bool) -> Result<Vec<[u32; 2]>, Fault> {
    if charts.iter().all(|chart| chart.loops.iter().all(|long| long % 2 == 0)) {
        return Ok(Vec::new());
    }
    let edges = Edges::of(&mesh.triangles);
    let divided = |rows: &Borders| rows.divided(mesh, &edges, split_odd);
    let borders = |by_loop: bool| Borders::of(charts, &edges, by_loop);
    divided(&borders(true)).or_else(|_| divided(&borders(false))).map_err(|blamed| {
        let charts: Vec<&Chart> = blamed.iter().map(|&k| &charts[k as usize]).collect();
        odd_fault(mesh, &edges, &charts, split_odd)
    })
}

/// The fault for triangles, with their corners, that have no area in the plane.
fn flat_fault(mesh: &Triangles, flat: &[(u32, [DVec3; 3])]) -> Fault {
    let mut triangles: Vec<u32> = flat.iter().map(|triangle| triangle.0).collect();
    triangles.sort_unstable();
    triangles.dedup();
    let [verb, as_] = if triangles.len() == 1 { ["is", "it is"] } else { ["are", "they are"] };
    let [p, q, r] = flat[0].1.map(point_text);
    Fault::new(format!("{} {verb} too flat to be converted as {as_}", capital(&mesh.describe(&triangles))))
        .at(format!("at {p}, {q}, {r}"))
        .remedy("Repair the mesh there, or remesh its shape (--use shape)")
        .showing(flat.iter().map(|triangle| triangle.1.to_vec()))
}

/// The fault for charts with an odd total number of triangles.
fn odd_fault(mesh: &Triangles, edges: &Edges, charts: &[&Chart], split_odd: bool) -> Fault {
    let triangles = match charts.iter().map(|chart| chart.local.len()).sum::<usize>() {
        1 => "1 triangle".to_owned(),
        n => format!("{n} triangles"),
    };
    // The odd loops of the surface's border, across charts.
    let of_charts =
        charts.iter().flat_map(|chart| sides(chart).flatten().map(|side| side.map(|node| chart.points[node as usize])));
    let is_outer = |ends: &[u32; 2]| edges.between(*ends).is_some_and(|edge| edges.get(edge).sides.len() == 1);
    let outer: Vec<[u32; 2]> = of_charts.filter(is_outer).collect();
    let mut loops = DisjointSets::new(mesh.points.len());
    outer.iter().for_each(|&[a, b]| loops.join(a, b));
    let mut count: BTreeMap<u32, usize> = BTreeMap::new();
    outer.iter().for_each(|ends| *count.entry(loops.find(ends[0])).or_default() += 1);
    let odd: Vec<[u32; 2]> = outer.into_iter().filter(|ends| count[&loops.find(ends[0])] % 2 == 1).collect();
    let at = |point: u32| format!("at {}", point_text(mesh.points[point as usize]));
    let beside = |ends: &[u32; 2]| edges.between(*ends).map(|edge| edges.get(edge).sides[0] / 3);
    let beside: Vec<u32> = odd.iter().filter_map(beside).collect();
    let place = match odd.first() {
        Some(ends) => format!("{}, sides of {}", at(ends[0]), mesh.describe(&beside)),
        None => at(charts[0].points[0]),
    };
    let shape = |ends: &[u32; 2]| ends.map(|end| mesh.points[end as usize]).to_vec();
    Fault::new(format!(
        "A part of the surface with {triangles} has an odd number of border sides; an all-quad mesh needs an even count"
    ))
    .at(place)
    .remedy(if split_odd { "Divide one side there" } else { "Divide one border side, or allow that (--split-odd)" })
    .showing(odd.iter().map(shape))
}

/// Borders to be made even, with their edges.
struct Borders {
    odd: Vec<bool>,
    /// Pairs of edge and border along it, ascending, with repetition.
    along: Vec<(usize, u32)>,
}

impl Borders {
    /// One border for each loop, or for all loops of a chart.
    fn of(charts: &[Chart], edges: &Edges, by_loop: bool) -> Borders {
        let mut borders = Borders { odd: Vec::new(), along: Vec::new() };
        for chart in charts {
            let on = |side: &[u32; 2]| edges.between(side.map(|node| chart.points[node as usize]));
            let loops: Vec<Vec<[u32; 2]>> = sides(chart).collect();
            for sides in if by_loop { loops } else { vec![loops.concat()] } {
                let number = borders.odd.len() as u32;
                borders.along.extend(sides.iter().filter_map(on).map(|edge| (edge, number)));
                borders.odd.push(sides.len() % 2 == 1);
            }
        }
        borders.along.sort_unstable();
        borders
    }

    /// The edges to divide, by their end points: of all edges with the same borders, the longest is the candidate.
    ///
    /// # Errors
    /// The borders that cannot be made even.
    fn divided(&self, mesh: &Triangles, edges: &Edges, split_odd: bool) -> Result<Vec<[u32; 2]>, Vec<u32>> {
        // The borders whose parity changes when an edge is divided, and the longest such edge.
        let mut longest: BTreeMap<Vec<u32>, (f64, usize)> = BTreeMap::new();
        for at_edge in self.along.chunk_by(|a, b| a.0 == b.0) {
            let edge = edges.get(at_edge[0].0);
            let is_toggled = |same: &&[(usize, u32)]| same.len() % 2 == 1;
            let turned: Vec<u32> = at_edge.chunk_by(|a, b| a == b).filter(is_toggled).map(|same| same[0].1).collect();
            if turned.is_empty() || (edge.sides.len() == 1 && !split_odd) {
                continue;
            }
            let [a, b] = edge.ends.map(|end| mesh.points[end as usize]);
            let long = a.distance(b);
            let known = longest.entry(turned).or_insert((long, at_edge[0].0));
            if long > known.0 {
                *known = (long, at_edge[0].0);
            }
        }
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); self.odd.len()];
        for (column, turned) in longest.keys().enumerate() {
            turned.iter().for_each(|&border| rows[border as usize].push(column as u32));
        }
        let cost: Vec<Option<f64>> =
            longest.values().map(|(long, _)| Some(1.0 / long.max(f64::MIN_POSITIVE))).collect();
        let toggled = fewest_toggles(&rows, &self.odd, &cost)?;
        let chosen = longest.values().zip(toggled).filter(|(_, toggled)| *toggled);
        Ok(chosen.map(|((_, edge), _)| edges.get(*edge).ends).collect())
    }
}

/// The metric implied by the triangles, at each point: a triangle is equilateral with unit sides in its own metric, or,
/// in a grid that was cut along diagonals, right-angled with unit legs; a point has the log-Euclidean mean over its
/// triangles, as in the plane (`background::implied_metric`).
pub fn implied_metric_in_space(mesh: &Triangles) -> Vec<Metric3> {
    let mut sums = vec![(LogMetric3::ZERO, 0.0_f64); mesh.points.len()];
    let right_angles = right_angles(&mesh.points, &mesh.triangles);
    for (t, nodes) in mesh.triangles.iter().enumerate() {
        let corners = mesh.corners(t);
        let Some(metric) = implied_by(corners, Shape::Equilateral) else { continue };
        let mut ln = metric.ln();
        if let Some(right) = right_angles[t]
            && let Some(metric) = implied_by(corners, Shape::RightAngled(right.corner))
        {
            ln = LogMetric3::ZERO.plus(1.0 - right.weight, &ln).plus(right.weight, &metric.ln());
        }
        for &node in nodes {
            let (sum, count) = &mut sums[node as usize];
            *sum = sum.plus(1.0, &ln);
            *count += 1.0;
        }
    }
    let mean = |(sum, count): &(LogMetric3, f64)| {
        if *count > 0.0 { LogMetric3::ZERO.plus(1.0 / count, sum).exp() } else { Metric3::isotropic(1.0) }
    };
    sums.iter().map(mean).collect()
}

/// What a triangle is in the metric that it implies.
#[derive(Clone, Copy)]
enum Shape {
    /// Equilateral with unit sides.
    Equilateral,
    /// Right-angled at a corner, with unit legs.
    RightAngled(usize),
}

/// The metric in which a triangle has a shape; the eigenvalue along the normal is the geometric mean of the other two.
/// `None` for a degenerate triangle.
fn implied_by(corners: [DVec3; 3], shape: Shape) -> Option<Metric3> {
    let first = if let Shape::RightAngled(corner) = shape { corner } else { 0 };
    let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
    let s = (b - a).try_normalize()?;
    let normal = (b - a).cross(c - a).try_normalize()?;
    let t = normal.cross(s);
    let [e, f] = [b - a, c - a].map(|d| DVec2::new(d.dot(s), d.dot(t)));
    let doubled = e.perp_dot(f);
    let (third, share) = match shape {
        Shape::Equilateral => (f - e, 0.5),
        Shape::RightAngled(_) => (DVec2::ZERO, 1.0),
    };
    let sides = [e, third, -f];
    let factor = share / (doubled * doubled);
    let sum = |of: fn(DVec2) -> f64| factor * sides.iter().map(|&side| of(side)).sum::<f64>();
    let (uu, uv, vv) = (sum(|d| d.y * d.y), -sum(|d| d.x * d.y), sum(|d| d.x * d.x));
    let angle = 0.5 * libm::atan2(2.0 * uv, uu - vv);
    let half = (0.25 * (uu - vv) * (uu - vv) + uv * uv).sqrt();
    let [one, other] = [0.5 * (uu + vv) + half, 0.5 * (uu + vv) - half];
    let along = s * libm::cos(angle) + t * libm::sin(angle);
    let metric = Metric3::from_eigen([one, other, (one * other).sqrt()], [along, normal.cross(along), normal]);
    metric.is_spd().then_some(metric)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::features::ANGLE;
    use crate::core::discrete::fixtures::{cube, plate, sphere, torus};
    use crate::core::discrete::planar_map::StretchBound;
    use crate::core::discrete::surface::surface;
    use crate::core::mesh::Named;
    use crate::core::progress::Nobody;

    #[test]
    fn charts_of_closed_surfaces_are_made_even_without_other_changes() {
        for mesh in [cube(3), sphere(5), torus(15, 9)] {
            let laid = surface(&mesh, &[Named::new("all")], ANGLE, StretchBound::default(), &mut Nobody).unwrap();
            let (set, divided) = laid.triangles(&mesh, false).unwrap();
            assert_eq!(set.xyz.len(), mesh.points.len() + divided);
            assert_eq!(set.triangles.len(), mesh.triangles.len() + 2 * divided);
            for chart in 0..laid.charts.len() as u32 {
                assert_eq!(set.region.iter().filter(|r| **r == chart).count() % 2, 0);
            }
        }
    }

    #[test]
    fn every_loop_of_a_ring_is_made_even_not_only_both_together() {
        let mut mesh = plate(9, 0.02);
        // A hole of five sides, and a border of 37: a triangle beside it, and one at the rim.
        mesh.triangles.drain(80..83);
        mesh.triangles.pop();
        mesh.region.truncate(mesh.triangles.len());
        let laid = surface(&mesh, &[Named::new("all")], ANGLE, StretchBound::default(), &mut Nobody).unwrap();
        assert_eq!(laid.charts[0].loops.iter().map(|long| long % 2).collect::<Vec<_>>(), [1, 1]);
        assert_eq!(laid.triangles(&mesh, true).unwrap().1, 2);
        // Without divided border sides, the number of triangles is still even.
        assert_eq!(laid.triangles(&mesh, false).unwrap().1, 0);
    }

    #[test]
    fn plates_that_touch_in_a_corner_keep_separate_points_there() {
        let (mut mesh, other) = (plate(2, 0.0), plate(2, 0.0));
        let last = mesh.points.len() as u32 - 1;
        // The first point of the other one is the last of this one.
        mesh.points.extend(other.points[1..].iter().map(|p| *p + DVec3::new(1.0, 1.0, 0.0)));
        mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|k| k + last)));
        mesh.region.extend(&other.region);
        mesh.lines = vec![([0, 1], 0), ([last, last + 1], 1)];
        let laid = surface(&mesh, &[Named::new("all")], ANGLE, StretchBound::default(), &mut Nobody).unwrap();
        let (set, _) = laid.triangles(&mesh, false).unwrap();
        assert_eq!((set.xyz.len(), mesh.points.len()), (18, 17));
        let ends = set.lines.iter().map(|(ends, _)| ends.map(|end| set.xyz[end.index()].truncate()));
        let [half, one] = [DVec2::new(0.5, 0.0), DVec2::ONE];
        assert_eq!(ends.collect::<Vec<_>>(), [[DVec2::ZERO, half], [one, one + half]]);
    }

    #[test]
    fn a_part_with_an_odd_count_is_refused_unless_a_side_may_be_divided() {
        // Of several charts.
        let mut mesh = plate(3, 0.2);
        mesh.triangles.pop();
        mesh.region.pop();
        // A file that has other triangles before these.
        mesh.origin = (4..21).collect();
        let laid = surface(&mesh, &[Named::new("all")], ANGLE, StretchBound::default(), &mut Nobody).unwrap();
        assert!(laid.charts.len() > 1);
        let fault = laid.triangles(&mesh, false).unwrap_err();
        assert!(fault.what.contains("17 triangles"), "{fault}");
        let edges = Edges::of(&mesh.triangles);
        let border = (0..edges.len()).map(|edge| edges.get(edge).sides).filter(|sides| sides.len() == 1);
        let beside: Vec<u32> = border.map(|sides| sides[0] / 3).collect();
        assert!(fault.place.ends_with(&format!(", sides of {}", mesh.describe(&beside))), "{fault}");
        assert!(fault.place.contains("sides of triangles 5, "), "{fault}");
        assert_eq!(fault.shapes.len(), beside.len());
        assert!(fault.shapes.iter().all(|shape| shape.len() == 2));
        assert_eq!(laid.triangles(&mesh, true).unwrap().0.triangles.len(), 18);
    }

    #[test]
    fn triangles_too_flat_in_the_plane_are_named_by_the_file_and_shown() {
        let mut mesh = plate(3, 0.02);
        mesh.origin = (4..22).collect();
        let mut laid = surface(&mesh, &[Named::new("all")], ANGLE, StretchBound::default(), &mut Nobody).unwrap();
        let chart = &mut laid.charts[0];
        let place = chart.triangles.iter().position(|&t| t == 7).unwrap();
        // Collapse a side between two triangles.
        let [a, b, _] = chart.local[place];
        chart.uv[a as usize] = chart.uv[b as usize];
        let at_both = |t: &[u32; 3]| t.contains(&a) && t.contains(&b);
        let flat: Vec<u32> =
            chart.triangles.iter().zip(&chart.local).filter(|(_, t)| at_both(t)).map(|(&t, _)| t).collect();
        let fault = laid.triangles(&mesh, false).unwrap_err();
        assert!(fault.what.starts_with(&capital(&mesh.describe(&flat))), "{fault}");
        assert!(fault.what.contains("12") && fault.what.ends_with("too flat to be converted as they are"), "{fault}");
        assert!(fault.shapes.contains(&mesh.corners(7).to_vec()), "{:?}", fault.shapes);
    }

    #[test]
    fn sides_have_length_one_in_the_metric_of_their_triangle() {
        let corners = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(4.0, 0.5, 1.0), DVec3::new(0.0, 1.0, -2.0)];
        let metric = implied_by(corners, Shape::Equilateral).unwrap();
        for k in 0..3 {
            let d = corners[(k + 1) % 3] - corners[k];
            let [xx, xy, xz, yy, yz, zz] = [metric.xx, metric.xy, metric.xz, metric.yy, metric.yz, metric.zz];
            let long = xx * d.x * d.x
                + yy * d.y * d.y
                + zz * d.z * d.z
                + 2.0 * (xy * d.x * d.y + xz * d.x * d.z + yz * d.y * d.z);
            assert!((long - 1.0).abs() < 1e-12, "{long}");
        }
    }
}
