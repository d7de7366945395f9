//! A surface of triangles as a domain: each chart is a face; borders of charts become curves between the points where
//! they meet, divided once for all faces that share them, as the curves of a case are (docs/algorithm.md, "Charts of
//! triangles").

use std::sync::Arc;

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::chart::{Chart, charts};
use super::edges::{Edge, Edges, Triangles};
use super::features::{ANGLE, features, with_lines};
use super::further::groups_by_place;
use super::planar_map::StretchBound;
use crate::core::fault::Fault;
use crate::core::geometry::complex::assemble;
use crate::core::geometry::lifting::{Lifted, Piece};
use crate::core::geometry::{
    Domain, DomainCurve, DomainPoint, FaceSpec, FaceSurface, Facets, Image, NamedCurve, PointOn, SpaceCurve,
};
use crate::core::kernel::Metric3;
use crate::core::kernel::box_tree::extent;
use crate::core::mesh::{GroupsByPlace, names};
use crate::core::metric::Field;
use crate::core::metric::gradation::bound_gradation;
use crate::core::progress::Watch;
use crate::core::soup::MeshFile;

/// Implied sizes: the largest angle by which the surface turns within an element (radians).
const MOST_TURN: f64 = std::f64::consts::FRAC_PI_6;
/// Lower bound for that as a fraction of the edges there: the normals of slivers are unreliable.
const LEAST_SIZE: f64 = 1.0 / 6.0;
/// Implied sizes: the largest distance from the surface as a fraction of its size (approximate).
const MOST_AWAY: f64 = 0.003;
/// Growth of such sizes from one element to the next (docs/algorithm.md, "Sizes where none are given").
const GRADATION: f64 = 1.3;

/// A flattened surface.
#[derive(Debug)]
pub struct Surface {
    /// Its faces and curves.
    pub domain: Domain,
    pub(super) charts: Vec<Chart>,
    /// The region of each face, by its name.
    pub regions: Vec<names::Named>,
    /// The line of the file on which each curve of the domain lies, if any.
    pub lines: Vec<Option<u32>>,
    /// Whether each curve of the domain is a feature, and not only a cut for flattening.
    pub features: Vec<bool>,
}

/// Border sides from one junction to the next, or a closed loop.
struct Chain {
    /// Points of the surface; a closed chain ends with its first point.
    points: Vec<u32>,
    /// Whether the sides are features, not only cuts for flattening.
    feature: bool,
    /// The line of the file on which they lie, if any.
    line: Option<u32>,
}

/// The chain of a border side, and its position in it.
#[derive(Clone, Copy)]
struct Link {
    chain: u32,
    at: u32,
}

/// Divides a surface at its features (folds beyond `angle`, in radians) into charts with a stretch within `bound`, and
/// makes a domain of them.
///
/// # Errors
/// Those of a domain, which are rare for a repaired surface; [`Fault::stopped`].
pub fn surface(
    mesh: &Triangles,
    regions: &[names::Named],
    angle: f64,
    bound: StretchBound,
    watch: &mut dyn Watch,
) -> Result<Surface, Fault> {
    let edges = Edges::unless(&mesh.triangles, &watch.cancel())?;
    let features = with_lines(features(mesh, &edges, angle), mesh, &edges);
    let charts = charts(mesh, &edges, &features, bound, watch)?;
    let cancel = watch.cancel();
    let mut line_of: Vec<Option<u32>> = vec![None; edges.len()];
    for (edge, line) in mesh.lines.iter().filter_map(|(ends, line)| Some((edges.between(*ends)?, *line))) {
        line_of[edge].get_or_insert(line);
    }
    let kind = |edge: usize| (features[edge].is_some(), line_of[edge]);
    let (chains, links) = chains(mesh, &edges, &charts, &kind);
    let mut vertices = Vec::new();
    let mut vertex_of = vec![u32::MAX; mesh.points.len()];
    let mut curves = Vec::with_capacity(chains.len());
    for (number, chain) in chains.iter().enumerate() {
        let ends = [chain.points[0], chain.points[chain.points.len() - 1]].map(|point| {
            let known = &mut vertex_of[point as usize];
            if *known == u32::MAX {
                *known = vertices.len() as u32;
                vertices.push(mesh.points[point as usize]);
            }
            *known
        });
        let points = chain.points.iter().map(|&p| mesh.points[p as usize]).collect();
        let corners = if chain.feature { corners(mesh, &chain.points, angle) } else { Vec::new() };
        curves.push(NamedCurve {
            name: format!("curve {}", number + 1),
            curve: Arc::new(SpaceCurve::of_sides(points, corners)),
            segments: None,
            place: String::new(),
            ends,
        });
    }
    let (mut specs, mut lifts) = (Vec::new(), Vec::new());
    let mut parts = vec![0_u32; regions.len()];
    for chart in &charts {
        cancel.check()?;
        let region = mesh.region[chart.triangles[0] as usize] as usize;
        parts[region] += 1;
        let xyz = chart.points.iter().map(|&p| mesh.points[p as usize]).collect();
        let facets = Arc::new(Facets::new(&chart.uv, xyz, &chart.local)?);
        let loops = pieces(chart, &facets, &edges, &chains, &links, &curves);
        let named = |pieces: &Vec<Piece>| pieces.iter().map(|piece| curves[piece.curve].name.clone()).collect();
        specs.push(FaceSpec {
            name: format!("{}, part {}", regions[region].name, parts[region]),
            outer: named(&loops[0]),
            holes: loops[1..].iter().map(named).collect(),
            cracks: Vec::new(),
            repeated: Vec::new(),
            groups: Vec::new(),
            place: String::new(),
        });
        lifts.push(Lifted { surface: FaceSurface::Facets(facets), loops, cracks: Vec::new(), repeated: Vec::new() });
    }
    let mut domain = assemble(&curves, &vertices, &specs, lifts, None)?;
    domain.points = hard_points(mesh, &charts, &vertex_of, &domain);
    let region = |chart: &Chart| regions[mesh.region[chart.triangles[0] as usize] as usize].clone();
    let regions = charts.iter().map(region).collect();
    let by_name: FxHashMap<&str, &Chain> =
        curves.iter().zip(&chains).map(|(curve, chain)| (curve.name.as_str(), chain)).collect();
    let chain_of = |curve: &DomainCurve| by_name.get(curve.name.as_str());
    let lines = domain.curves.iter().map(|curve| chain_of(curve)?.line).collect();
    let features = domain.curves.iter().map(|curve| chain_of(curve).is_some_and(|chain| chain.feature)).collect();
    Ok(Surface { domain, charts, regions, lines, features })
}

impl Surface {
    /// The field of metrics given at the points of the surface.
    ///
    /// # Errors
    /// Metrics that are not positive definite.
    pub fn table(&self, metrics: &[Metric3]) -> Result<Field, Fault> {
        let (uv, triangles) = self.flat();
        let at = self.charts.iter().flat_map(|chart| &chart.points).map(|&p| metrics[p as usize]).collect();
        Field::table(&uv, &triangles, at)
    }

    /// The groups of the file that overlap others; `mesh` are the triangles of the surface.
    pub fn groups_by_place(
        &self,
        file: &MeshFile,
        mesh: &Triangles,
        repairs: &mut Vec<String>,
    ) -> Option<Arc<GroupsByPlace>> {
        if file.members.iter().all(|members| members.dimension != 2) {
            return None;
        }
        let (uv, triangles) = self.flat();
        let of_charts = self.charts.iter().flat_map(|chart| &chart.triangles);
        let element: Vec<u32> = of_charts.filter_map(|&t| mesh.origin.get(t as usize).copied()).collect();
        groups_by_place(file, &uv, &triangles, &element, repairs)
    }

    /// The triangles of all charts in the plane of the atlas.
    fn flat(&self) -> (Vec<DVec2>, Vec<[u32; 3]>) {
        let (mut uv, mut triangles) = (Vec::new(), Vec::new());
        for (k, chart) in self.charts.iter().enumerate() {
            let offset = self.domain.spatial.as_ref().map_or(DVec2::ZERO, |spatial| spatial.atlas.offset(k));
            let first = uv.len() as u32;
            uv.extend(chart.uv.iter().map(|p| *p + offset));
            triangles.extend(chart.local.iter().map(|t| t.map(|node| first + node)));
        }
        (uv, triangles)
    }
}

/// The isotropic sizes for a surface without given sizes, at each point: the mean length of the edges there, at most
/// the size at which the surface turns by 30 degrees (but at least a sixth of the mean) or deviates by 0.3 % of its
/// extent, and with a growth of at most 1.3 from one element to the next.
pub fn implied_sizes(mesh: &Triangles) -> Vec<Metric3> {
    let mut sums = vec![(0.0, 0.0); mesh.points.len()];
    let edges = Edges::of(&mesh.triangles);
    for [a, b] in (0..edges.len()).map(|edge| edges.get(edge).ends) {
        let long = mesh.points[a as usize].distance(mesh.points[b as usize]);
        for end in [a, b] {
            let (sum, count) = &mut sums[end as usize];
            (*sum, *count) = (*sum + long, *count + 1.0);
        }
    }
    // A point without edges has no size.
    let means: Vec<f64> = sums.iter().map(|&(sum, count)| if count > 0.0 { sum / count } else { 0.0 }).collect();
    sizes_within(mesh, &means)
}

/// As [`implied_sizes`], with other lengths than those of the edges at each point.
pub fn sizes_within(mesh: &Triangles, means: &[f64]) -> Vec<Metric3> {
    let edges = Edges::of(&mesh.triangles);
    // Upper bounds by turning and by deviation.
    let mut most = vec![(f64::INFINITY, f64::INFINITY); mesh.points.len()];
    let (low, high) = extent(mesh.points.iter().copied());
    let away = MOST_AWAY * low.distance(high);
    let features = features(mesh, &edges, ANGLE);
    for edge in 0..edges.len() {
        let Edge { ends, sides } = edges.get(edge);
        let [a, b] = ends.map(|end| mesh.points[end as usize]);
        let long = a.distance(b);
        if let (None, &[one, other]) = (features[edge], sides) {
            let [n, m] = [one, other].map(|side| mesh.area_vector(side as usize / 3));
            let turn = libm::atan2(n.cross(m).length(), n.dot(m));
            // Half the height of each triangle over the edge: the length over which the surface turns.
            let way = 0.5 * (n.length() + m.length()) / long.max(f64::MIN_POSITIVE);
            let corners = [one, other].map(|side| mesh.triangles[side as usize / 3]);
            for node in corners.as_flattened() {
                let (by_turn, by_distance) = &mut most[*node as usize];
                let turn = turn.max(f64::MIN_POSITIVE);
                *by_turn = by_turn.min(way * MOST_TURN / turn);
                // An element with a fold across its middle deviates by a quarter of its size times the angle.
                *by_distance = by_distance.min(4.0 * away / turn);
            }
        }
    }
    let size = |(&mean, (by_turn, by_distance)): (&f64, &(f64, f64))| match mean {
        mean if mean > 0.0 => by_turn.clamp(LEAST_SIZE * mean, mean).min(*by_distance),
        _ => 1.0,
    };
    let mut sizes: Vec<Metric3> = means.iter().zip(&most).map(size).map(Metric3::isotropic).collect();
    let ends: Vec<[u32; 2]> = (0..edges.len()).map(|edge| edges.get(edge).ends).collect();
    bound_gradation(&mesh.points, &ends, &mut sizes, GRADATION);
    sizes
}

/// The hard points of a surface: those on borders of charts have become vertices.
fn hard_points(mesh: &Triangles, charts: &[Chart], vertex_of: &[u32], domain: &Domain) -> Vec<DomainPoint> {
    let Some(spatial) = domain.spatial.as_deref().filter(|_| !mesh.hard.is_empty()) else { return Vec::new() };
    let mut inside: FxHashMap<u32, DVec2> = FxHashMap::default();
    for (k, chart) in charts.iter().enumerate() {
        let places = chart.points.iter().zip(&chart.uv);
        inside.extend(places.map(|(&point, &uv)| (point, uv + spatial.atlas.offset(k))));
    }
    let images = |vertex: u32| (0..).zip(&spatial.vertex_of).filter(move |(_, own)| **own == vertex).map(|(v, _)| v);
    let place = |&(point, _): &(u32, u32)| {
        let on = match vertex_of[point as usize] {
            u32::MAX => PointOn::Face,
            vertex => PointOn::Vertices(images(vertex).collect()),
        };
        DomainPoint { uv: inside.get(&point).copied().unwrap_or_default(), xyz: mesh.points[point as usize], on }
    };
    mesh.hard.iter().map(place).collect()
}

/// The sides of a chart's border, loop by loop, each with its first local node.
pub(super) fn sides(chart: &Chart) -> impl Iterator<Item = Vec<[u32; 2]>> + '_ {
    let mut first = 0;
    chart.loops.iter().map(move |&long| {
        let begin = first;
        first += long;
        (0..long).map(|k| [begin + k, begin + (k + 1) % long]).collect()
    })
}

/// The chains of all borders, and the link of each edge on one. A chain continues through a point where exactly two
/// border edges meet that have the same charts, are both features or both not, and lie on the same line or on none.
fn chains(
    mesh: &Triangles,
    edges: &Edges,
    charts: &[Chart],
    kind: &dyn Fn(usize) -> (bool, Option<u32>),
) -> (Vec<Chain>, Vec<Option<Link>>) {
    // The charts on each border edge, ascending.
    let mut users: Vec<(usize, u32)> = Vec::new();
    for (number, chart) in charts.iter().enumerate() {
        for side in sides(chart).flatten() {
            if let Some(edge) = edges.between(side.map(|node| chart.points[node as usize])) {
                users.push((edge, number as u32));
            }
        }
    }
    users.sort_unstable();
    let mut of_edge: Vec<&[(usize, u32)]> = vec![&[]; edges.len()];
    users.chunk_by(|a, b| a.0 == b.0).for_each(|group| of_edge[group[0].0] = group);
    let mut at_point: Vec<Vec<u32>> = vec![Vec::new(); mesh.points.len()];
    let border: Vec<usize> = (0..edges.len()).filter(|&edge| !of_edge[edge].is_empty()).collect();
    for &edge in &border {
        edges.get(edge).ends.iter().for_each(|&end| at_point[end as usize].push(edge as u32));
    }
    let alike = |a: u32, b: u32| {
        let charts = |edge: u32| of_edge[edge as usize].iter().map(|user| user.1);
        kind(a as usize) == kind(b as usize) && charts(a).eq(charts(b))
    };
    let goes_on =
        |point: u32| mesh.hard_number(point).is_none() && matches!(at_point[point as usize][..], [a, b] if alike(a, b));
    let mut chains = Vec::new();
    let mut links: Vec<Option<Link>> = vec![None; edges.len()];
    let mut walk = |first: u32, edge: u32, links: &mut Vec<Option<Link>>| {
        let mut points = vec![first];
        let (mut at, mut edge) = (first, edge);
        loop {
            links[edge as usize] = Some(Link { chain: chains.len() as u32, at: points.len() as u32 - 1 });
            let [a, b] = edges.get(edge as usize).ends;
            at = if a == at { b } else { a };
            points.push(at);
            let next = at_point[at as usize].iter().copied().find(|&next| next != edge);
            match next {
                Some(next) if at != first && goes_on(at) => edge = next,
                _ => break,
            }
        }
        let (feature, line) = kind(edge as usize);
        chains.push(Chain { points, feature, line });
    };
    for point in 0..mesh.points.len() as u32 {
        if !goes_on(point) {
            for &edge in &at_point[point as usize] {
                if links[edge as usize].is_none() {
                    walk(point, edge, &mut links);
                }
            }
        }
    }
    for &edge in &border {
        if links[edge].is_none() {
            walk(edges.get(edge).ends[0], edge as u32, &mut links);
        }
    }
    (chains, links)
}

/// Positions in a chain at which it turns by more than an angle.
fn corners(mesh: &Triangles, points: &[u32], angle: f64) -> Vec<u32> {
    let least_cosine = libm::cos(angle);
    let p = |k: usize| mesh.points[points[k] as usize];
    let turns = |&k: &usize| {
        let (before, after) = (p(k) - p(k - 1), p(k + 1) - p(k));
        before.dot(after) < least_cosine * before.length() * after.length()
    };
    (1..points.len() - 1).filter(turns).map(|k| k as u32).collect()
}

/// The loops of a chart as images of the curves, the outer one first.
fn pieces(
    chart: &Chart,
    facets: &Arc<Facets>,
    edges: &Edges,
    chains: &[Chain],
    links: &[Option<Link>],
    curves: &[NamedCurve],
) -> Vec<Vec<Piece>> {
    let mut loops: Vec<(bool, Vec<Piece>)> = Vec::new();
    for sides in sides(chart) {
        let uv = |node: u32| chart.uv[node as usize];
        let doubled: f64 =
            sides.iter().map(|side| (uv(side[0]) - uv(sides[0][0])).perp_dot(uv(side[1]) - uv(sides[0][0]))).sum();
        // The chain of each side, the position in it, and whether it runs forward.
        let on: Vec<(u32, u32, bool)> = sides
            .iter()
            .map(|side| {
                let ends = side.map(|node| chart.points[node as usize]);
                let link = edges.between(ends).and_then(|edge| links[edge]).expect("sides of borders are on chains");
                let forward = chains[link.chain as usize].points[link.at as usize] == ends[0];
                (link.chain, link.at, forward)
            })
            .collect();
        let begins = |&(chain, at, forward): &(u32, u32, bool)| {
            if forward { at == 0 } else { at as usize + 2 == chains[chain as usize].points.len() }
        };
        let start = on.iter().position(begins).unwrap_or(0);
        let n = on.len();
        let mut pieces = Vec::new();
        let mut k = 0;
        while k < n {
            let (chain, _, forward) = on[(start + k) % n];
            let long = chains[chain as usize].points.len() - 1;
            let nodes = (0..long).map(|i| sides[(start + k + i) % n][0]).chain([sides[(start + k + long - 1) % n][1]]);
            let mut places: Vec<DVec2> = nodes.map(uv).collect();
            if !forward {
                places.reverse();
            }
            let image = Image::of_sides(facets, &curves[chain as usize].curve, &places);
            pieces.push(Piece { curve: chain as usize, image, forward });
            k += long;
        }
        loops.push((doubled < 0.0, pieces));
    }
    loops.sort_by_key(|l| l.0);
    loops.into_iter().map(|l| l.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::fixtures::{cube, plate, sphere, three_half_planes, torus, tube};
    use crate::core::progress::Nobody;

    #[test]
    fn surfaces_become_domains_whose_curves_are_shared() {
        let names = [names::Named::new("all")];
        for (mesh, faces, curves) in [
            (cube(4), 6, 12),
            (sphere(8), 2, 1),
            (tube(24, 10, 4.0), 1, 3),
            (three_half_planes(), 3, 4),
            (plate(10, 0.1), 1, 1),
        ] {
            let found = surface(&mesh, &names, ANGLE, StretchBound::default(), &mut Nobody).unwrap();
            let domain = &found.domain;
            let own = domain.curves.iter().enumerate().filter(|(k, curve)| curve.first.index() == *k).count();
            assert_eq!((domain.faces.len(), own), (faces, curves));
            assert!(found.table(&implied_sizes(&mesh)).is_ok());
        }
        assert!(surface(&torus(30, 20), &names, ANGLE, StretchBound::default(), &mut Nobody).is_ok());
    }
}
