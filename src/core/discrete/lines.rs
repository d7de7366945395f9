//! Lines of a file on a surface that was mended: the edges that lie on them.

use glam::DVec3;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::edges::{Edges, Triangles};
use super::mend::IN_SIDE;

/// The edges on line segments between points of the file: their ends, ascending, and the number of the line, by ascending ends and
/// each once, on the first of its lines. A segment whose ends were made one with others, or got copies (`copied` has the points that
/// those were), is where these are; one in whose side points were found runs along several edges. How many lie on no edge.
pub fn on_edges(segments: &[([u32; 2], u32)], mesh: &Triangles, copied: &[u32]) -> (Vec<([u32; 2], u32)>, usize) {
    if segments.is_empty() {
        return (Vec::new(), 0);
    }
    let places = Places::of(mesh, copied);
    let mut found: Vec<([u32; 2], u32)> = Vec::new();
    let mut lost = 0;
    for (ends, line) in segments {
        let [from, to] = ends.map(|end| places.standing(end));
        let before = found.len();
        for (&a, &b) in from.iter().flat_map(|a| to.iter().map(move |b| (a, b))) {
            if let Some(edge) = places.edges.between([a, b]) {
                found.push((places.edges.get(edge).ends, *line));
            }
        }
        if found.len() == before {
            let way = from.first().zip(to.first()).and_then(|(&a, &b)| places.way(a, b));
            lost += usize::from(way.is_none());
            found.extend(way.into_iter().flatten().map(|ends| (ends, *line)));
        }
    }
    found.sort_unstable();
    found.dedup_by_key(|edge| edge.0);
    (found, lost)
}

/// Where the points of a file are on the surface.
struct Places<'a> {
    mesh: &'a Triangles,
    edges: Edges,
    /// Ends of the edges at each point, by point.
    near: Vec<[u32; 2]>,
    used: Vec<bool>,
    /// Points that have copies, and these, ascending.
    copies: Vec<[u32; 2]>,
    tree: RTree<GeomWithData<[f64; 3], u32>>,
    same: f64,
}

impl<'a> Places<'a> {
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
        let [same, _] = mesh.same_place(&used);
        Places { mesh, edges, near, used, copies, tree, same }
    }

    fn at(&self, point: u32) -> DVec3 {
        self.mesh.points[point as usize]
    }

    /// The points of the surface that a point of the file is now.
    fn standing(&self, point: u32) -> Vec<u32> {
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

    /// The edges along the straight way from one point to another.
    fn way(&self, from: u32, to: u32) -> Option<Vec<[u32; 2]>> {
        let (a, along) = (self.at(from), self.at(to) - self.at(from));
        let share = |point: u32| (self.at(point) - a).dot(along) / along.length_squared();
        let is_on = |point: u32| {
            let t = share(point);
            (self.at(point) - a - t * along).length() <= IN_SIDE * along.length() && t <= 1.0 + IN_SIDE
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
    fn lines_are_found_on_edges_on_points_made_one_and_on_sides_that_were_divided() {
        let mut mesh = plate(2, 0.0);
        let at = |mesh: &Triangles, x: f64, y: f64| {
            mesh.points.iter().position(|p| p.distance(DVec3::new(x, y, 0.0)) < 1e-9).unwrap() as u32
        };
        let [a, b, c] = [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0)].map(|(x, y)| at(&mesh, x, y));
        // A point of its own at the place of one that triangles have, and one that is nowhere.
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
    fn lines_at_points_that_were_parted_are_at_each_of_their_copies() {
        let mut mesh = plate(1, 0.0);
        let corner = mesh.triangles[0][0];
        mesh.points.push(mesh.points[corner as usize]);
        let copy = mesh.points.len() as u32 - 1;
        mesh.triangles.as_flattened_mut().iter_mut().filter(|k| **k == corner).for_each(|k| *k = copy);
        let other = mesh.triangles[0][1];
        assert_eq!(on_edges(&[([corner, other], 0)], &mesh, &[corner]), (vec![([other, copy], 0)], 0));
    }
}
