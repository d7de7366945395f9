//! Finds the edges of a repaired surface on the lines of its file.

use std::collections::BTreeMap;

use glam::DVec3;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::edges::{Edges, Triangles};
use super::stitch::ON_SIDE;
use crate::core::mesh::Named;

/// The edges on line segments between points of the file, each once, sorted: ends, ascending, and index of its first
/// line. Ends that were merged into other points or copied (`copied` has the originals) are replaced by these; a
/// segment divided at hanging points runs along several edges. Also returns the number of segments on no edge.
pub fn on_edges(segments: &[([u32; 2], u32)], mesh: &Triangles, copied: &[u32]) -> (Vec<([u32; 2], u32)>, usize) {
    if segments.is_empty() {
        return (Vec::new(), 0);
    }
    let points = SurfacePoints::of(mesh, copied);
    let mut found: Vec<([u32; 2], u32)> = Vec::new();
    let mut lost = 0;
    for (ends, line) in segments {
        let [from, to] = ends.map(|end| points.current(end));
        let before = found.len();
        for (&a, &b) in from.iter().flat_map(|a| to.iter().map(move |b| (a, b))) {
            if let Some(edge) = points.edges.between([a, b]) {
                found.push((points.edges.get(edge).ends, *line));
            }
        }
        if found.len() == before {
            let path = from.first().zip(to.first()).and_then(|(&a, &b)| points.path(a, b));
            lost += usize::from(path.is_none());
            found.extend(path.into_iter().flatten().map(|ends| (ends, *line)));
        }
    }
    found.sort_unstable();
    found.dedup_by_key(|edge| edge.0);
    (found, lost)
}

/// The points of a surface that replace points of the file, ascending, each with a number from 0; and for each number
/// the groups of the file's points. Also returns the number of points that the surface does not have.
pub fn on_points(points: &[(u32, Option<Named>)], mesh: &Triangles, copied: &[u32]) -> (Hard, PointGroups, usize) {
    if points.is_empty() {
        return (Vec::new(), Vec::new(), 0);
    }
    let (surface, mut lost) = (SurfacePoints::of(mesh, copied), 0);
    let mut found: BTreeMap<u32, Vec<Option<Named>>> = BTreeMap::new();
    for (point, named) in points {
        let current = surface.current(*point);
        lost += usize::from(current.is_empty());
        current.into_iter().for_each(|own| found.entry(own).or_default().push(named.clone()));
    }
    (found.keys().copied().zip(0..).collect(), found.into_values().collect(), lost)
}

/// Points of a surface with their numbers.
type Hard = Vec<(u32, u32)>;
/// The groups of hard points, by number.
pub type PointGroups = Vec<Vec<Option<Named>>>;

/// Finds the points of a file on the surface.
struct SurfacePoints<'a> {
    mesh: &'a Triangles,
    edges: Edges,
    /// Edges as pairs of point and neighbour, sorted.
    near: Vec<[u32; 2]>,
    used: Vec<bool>,
    /// Pairs of point and copy, sorted.
    copies: Vec<[u32; 2]>,
    tree: RTree<GeomWithData<[f64; 3], u32>>,
    same: f64,
}

impl<'a> SurfacePoints<'a> {
    fn of(mesh: &'a Triangles, copied: &[u32]) -> Self {
        let edges = Edges::of(&mesh.triangles);
        let mut near: Vec<[u32; 2]> =
            (0..edges.len()).map(|edge| edges.get(edge).ends).flat_map(|[a, b]| [[a, b], [b, a]]).collect();
        near.sort_unstable();
        let mut used = vec![false; mesh.points.len()];
        mesh.triangles.as_flattened().iter().for_each(|&point| used[point as usize] = true);
        let first_copy = (mesh.points.len() - copied.len()) as u32;
        let mut copies: Vec<[u32; 2]> = copied.iter().zip(first_copy..).map(|(&of, copy)| [of, copy]).collect();
        copies.sort_unstable();
        let own = || mesh.points.iter().zip(0_u32..).zip(&used).filter(|(_, used)| **used).map(|(point, _)| point);
        let tree = RTree::bulk_load(own().map(|(p, k)| GeomWithData::new(p.to_array(), k)).collect());
        let [same, _] = mesh.weld_tolerance(&used);
        SurfacePoints { mesh, edges, near, used, copies, tree, same }
    }

    fn at(&self, point: u32) -> DVec3 {
        self.mesh.points[point as usize]
    }

    /// The points of the surface that replace a point of the file.
    fn current(&self, point: u32) -> Vec<u32> {
        if self.used[point as usize] {
            return vec![point];
        }
        let first = self.copies.partition_point(|copy| copy[0] < point);
        let copies: Vec<u32> =
            self.copies[first..].iter().take_while(|copy| copy[0] == point).map(|copy| copy[1]).collect();
        if !copies.is_empty() || !self.at(point).is_finite() {
            return copies;
        }
        let nearest = self.tree.nearest_neighbor(self.at(point).to_array());
        nearest
            .map(|place| place.data)
            .filter(|&k| self.at(k).distance(self.at(point)) <= self.same)
            .into_iter()
            .collect()
    }

    /// The edges along the straight line from one point to another.
    fn path(&self, from: u32, to: u32) -> Option<Vec<[u32; 2]>> {
        let (a, along) = (self.at(from), self.at(to) - self.at(from));
        let share = |point: u32| (self.at(point) - a).dot(along) / along.length_squared();
        let is_on = |point: u32| {
            let t = share(point);
            (self.at(point) - a - t * along).length() <= ON_SIDE * along.length() && t <= 1.0 + ON_SIDE
        };
        let (mut edges, mut here) = (Vec::new(), from);
        while here != to {
            let first = self.near.partition_point(|near| near[0] < here);
            let others = self.near[first..].iter().take_while(|near| near[0] == here).map(|near| near[1]);
            let next = others.filter(|&other| share(other) > share(here) && is_on(other));
            let next = next.min_by(|a, b| share(*a).total_cmp(&share(*b)))?;
            edges.push([here.min(next), here.max(next)]);
            here = next;
        }
        (!edges.is_empty()).then_some(edges)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::fixtures::plate;

    #[test]
    fn lines_are_found_on_edges_at_merged_points_and_on_divided_sides() {
        let mut mesh = plate(2, 0.0);
        let at = |mesh: &Triangles, x: f64, y: f64| {
            mesh.points.iter().position(|p| p.distance(DVec3::new(x, y, 0.0)) < 1e-9).unwrap() as u32
        };
        let [a, b, c] = [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0)].map(|(x, y)| at(&mesh, x, y));
        // An unused point at a used one, and one off the surface.
        mesh.points.extend([DVec3::new(0.5, 0.0, 0.0), DVec3::new(7.0, 0.0, 0.0)]);
        let (same, far) = (mesh.points.len() as u32 - 2, mesh.points.len() as u32 - 1);
        let pair = |a: u32, b: u32| [a.min(b), a.max(b)];
        let found = |segments: &[([u32; 2], u32)]| on_edges(segments, &mesh, &[]);
        assert_eq!(found(&[([b, a], 3)]), (vec![(pair(a, b), 3)], 0));
        assert_eq!(found(&[([a, same], 3)]), (vec![(pair(a, b), 3)], 0));
        let mut both = vec![(pair(a, b), 1), (pair(b, c), 1)];
        both.sort_unstable();
        assert_eq!(found(&[([a, c], 1), ([a, b], 2)]), (both, 0));
        assert_eq!(found(&[([a, far], 1), ([a, a], 1)]), (vec![], 2));
        assert_eq!(found(&[]), (vec![], 0));
    }

    #[test]
    fn lines_at_separated_points_follow_each_copy() {
        let mut mesh = plate(1, 0.0);
        let corner = mesh.triangles[0][0];
        mesh.points.push(mesh.points[corner as usize]);
        let copy = mesh.points.len() as u32 - 1;
        mesh.triangles.as_flattened_mut().iter_mut().filter(|k| **k == corner).for_each(|k| *k = copy);
        let other = mesh.triangles[0][1];
        assert_eq!(on_edges(&[([corner, other], 0)], &mesh, &[corner]), (vec![([other, copy], 0)], 0));
    }
}
