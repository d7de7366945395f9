//! Connectivity repairs: merges coincident points, inserts hanging points into the sides on which they lie (also where
//! three sheets meet), and separates parts that touch in a point only.

use std::collections::BTreeSet;

use glam::DVec3;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};

use super::edges::{Edges, Groups, Triangles};
use crate::core::kernel::DisjointSets;
use crate::core::kernel::box_tree::extent;
use crate::core::progress::Cancel;
use crate::core::soup::weld::weld;

/// Points closer than this fraction of the size of the mesh coincide,
const COINCIDENT: f64 = 1e-9;
/// and so do points closer than this fraction of the largest coordinate.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// A point closer to a side than this fraction of the side's length hangs on it.
pub(super) const ON_SIDE: f64 = 1e-6;
/// At most this fraction of the side, whatever the tolerance is.
const FAR_FROM_SIDE: f64 = 0.1;
/// Parts that touch in a point are separated by this fraction of the size, at most by the second fraction of an edge
/// there.
const GAP: f64 = 1e-6;
const GAP_OF_EDGE: f64 = 1e-2;
/// Rounds of dividing sides on which points hang.
const ROUNDS: usize = 8;

type Tree = RTree<GeomWithData<[f64; 3], u32>>;

impl Triangles {
    /// Replaces coincident points by the first of them; returns how many points are no longer used.
    pub fn weld(&mut self, cancel: &Cancel) -> usize {
        let mut is_used = vec![false; self.points.len()];
        self.triangles.as_flattened().iter().for_each(|&k| is_used[k as usize] = true);
        let used: Vec<u32> = (0..self.points.len() as u32).filter(|&k| is_used[k as usize]).collect();
        let mut kept: Vec<DVec3> = used.iter().map(|&k| self.points[k as usize]).collect();
        let [tolerance, largest] = self.weld_tolerance(&is_used);
        let representative = weld(&mut kept, tolerance / largest.max(f64::MIN_POSITIVE), cancel);
        if kept.len() == used.len() || cancel.is_asked() {
            return 0;
        }
        // The first point of each position, in the order of the kept positions.
        let mut first = vec![u32::MAX; kept.len()];
        for (&point, &place) in used.iter().zip(&representative) {
            let first = &mut first[place as usize];
            *first = (*first).min(point);
        }
        let mut merged = vec![u32::MAX; self.points.len()];
        used.iter().zip(&representative).for_each(|(&point, &place)| merged[point as usize] = first[place as usize]);
        self.triangles.as_flattened_mut().iter_mut().for_each(|k| *k = merged[*k as usize]);
        used.len() - kept.len()
    }

    /// The distance below which points coincide, by the size of the mesh but above rounding; and the largest absolute
    /// coordinate of the used points.
    pub(super) fn weld_tolerance(&self, is_used: &[bool]) -> [f64; 2] {
        let used = self.points.iter().zip(is_used).filter(|(_, used)| **used).map(|(p, _)| *p);
        let ends = used.map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let [low, high] = ends.unwrap_or([DVec3::ZERO; 2]);
        let largest = low.abs().max(high.abs()).max_element();
        [(COINCIDENT * (high - low).max_element()).max(ROUNDING * largest), largest]
    }

    /// Divides border sides at the border points that hang on them, so that the two borders match; returns how often a
    /// point hung on an edge. With `closed`, divides only sides along which other border sides run from end to end.
    ///
    /// With a `joint`, a point hangs on a side up to that distance; and unless `closed`, a border ends on a sheet where
    /// it hangs on edges inside that, or where points inside that hang on its sides. All triangles at the edge are
    /// divided:
    /// ```text
    ///   sheet      b                  b
    ///         c    |    d        c   /|\   d
    ///              | p              - p -
    ///              |                 \|/
    ///              a                  a
    /// ```
    pub fn stitch(&mut self, closed: bool, joint: Option<f64>, cancel: &Cancel) -> usize {
        let mut stitched: BTreeSet<([u32; 2], u32)> = BTreeSet::new();
        // Each round divides a triangle at one of its sides.
        for _ in 0..ROUNDS {
            let hanging = self.hanging(closed, joint, cancel);
            if hanging.is_empty() {
                break;
            }
            for of_triangle in hanging.chunk_by(|a, b| a.0 / 3 == b.0 / 3) {
                let (t, side) = (of_triangle[0].0 as usize / 3, of_triangle[0].0);
                let in_side = of_triangle.iter().filter(|h| h.0 == side).map(|h| h.2);
                let [a, b] = self.side(side);
                let apex = self.triangles[t][(side as usize + 2) % 3];
                self.forget_texture(t);
                let along: Vec<u32> = [a].into_iter().chain(in_side).chain([b]).collect();
                stitched.extend(along[1..along.len() - 1].iter().map(|&point| ([a.min(b), a.max(b)], point)));
                for (k, piece) in along.windows(2).enumerate() {
                    let piece = [piece[0], piece[1], apex];
                    if k == 0 {
                        self.triangles[t] = piece;
                    } else {
                        self.triangles.push(piece);
                        self.region.push(self.region[t]);
                        if !self.origin.is_empty() {
                            self.origin.push(self.origin[t]);
                        }
                        if !self.texture.is_empty() {
                            self.texture.push(None);
                        }
                    }
                }
            }
        }
        stitched.len()
    }

    /// Points that hang on sides: the side, the parameter along it, the point; ascending. See [`Triangles::stitch`].
    fn hanging(&self, closed: bool, joint: Option<f64>, cancel: &Cancel) -> Vec<(u32, f64, u32)> {
        let Ok(edges) = Edges::unless(&self.triangles, cancel) else { return Vec::new() };
        let (outer, inner): (Vec<usize>, Vec<usize>) =
            (0..edges.len()).partition(|&edge| edges.get(edge).sides.len() == 1);
        let of = |mut points: Vec<u32>| -> Tree {
            points.sort_unstable();
            points.dedup();
            let place = |k: u32| GeomWithData::new(self.points[k as usize].to_array(), k);
            RTree::bulk_load(points.into_iter().map(place).collect())
        };
        let border = of(outer.iter().flat_map(|&edge| edges.get(edge).ends).collect());
        let mut hanging: Vec<(u32, f64, u32)> = Vec::new();
        let mut hang = |edge: usize, points: &Tree| {
            let sides = edges.get(edge).sides;
            let [a, b] = self.side(sides[0]).map(|k| self.points[k as usize]);
            let along = b - a;
            let share = ON_SIDE.max((joint.unwrap_or(0.0) / along.length()).min(FAR_FROM_SIDE));
            let margin = DVec3::splat(share * along.length());
            let (low, high) = (a.min(b) - margin, a.max(b) + margin);
            for place in points.locate_in_envelope(AABB::from_corners(low.to_array(), high.to_array())) {
                let p = self.points[place.data as usize] - a;
                let t = p.dot(along) / along.length_squared();
                let own = sides.iter().any(|&side| self.triangles[side as usize / 3].contains(&place.data));
                if !own && t > share && t < 1.0 - share && (p - t * along).length() < margin.x {
                    let from_end = |side: &u32| if self.side(*side) == self.side(sides[0]) { t } else { 1.0 - t };
                    hanging.extend(sides.iter().map(|side| (*side, from_end(side), place.data)));
                }
            }
        };
        if joint.is_some() && !closed && !outer.is_empty() {
            let all = of(self.triangles.as_flattened().to_vec());
            outer.iter().for_each(|&edge| hang(edge, &all));
            inner.iter().for_each(|&edge| hang(edge, &border));
        } else {
            outer.iter().for_each(|&edge| hang(edge, &border));
        }
        hanging.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        if closed {
            let is_border =
                |ends: &[u32]| edges.between([ends[0], ends[1]]).is_some_and(|edge| edges.get(edge).sides.len() == 1);
            let of_side = hanging.chunk_by(|a, b| a.0 == b.0).filter(|of_side| {
                let [a, b] = self.side(of_side[0].0);
                let along: Vec<u32> = [a].into_iter().chain(of_side.iter().map(|h| h.2)).chain([b]).collect();
                along.windows(2).all(is_border)
            });
            return of_side.flatten().copied().collect();
        }
        hanging
    }

    /// Separates parts that touch in a point only, if one of them is closed around it: each gets a copy of the point,
    /// slightly displaced. Returns the original of each copy, the number of points separated, and the number of other
    /// contact points.
    pub fn separate(&mut self, cancel: &Cancel) -> (Vec<u32>, usize, usize) {
        let corners = 3 * self.triangles.len();
        let Ok(edges) = Edges::unless(&self.triangles, cancel) else { return (Vec::new(), 0, 0) };
        let mut sets = DisjointSets::new(corners);
        let next = |c: u32| c - c % 3 + (c + 1) % 3;
        // Border sides at each point: two for each part that is not closed around it.
        let mut outer = vec![0; self.points.len()];
        for e in 0..edges.len() {
            let edge = edges.get(e);
            if let [_] = edge.sides {
                edge.ends.iter().for_each(|&end| outer[end as usize] += 1);
            }
            let corner_at = |side: u32, end: u32| if self.side(side)[0] == end { side } else { next(side) };
            for other in &edge.sides[1..] {
                edge.ends.iter().for_each(|&end| sets.join(corner_at(edge.sides[0], end), corner_at(*other, end)));
            }
        }
        let fan_of: Vec<u32> = (0..corners as u32).map(|c| sets.find(c)).collect();
        let at = |c: u32| self.triangles[c as usize / 3][c as usize % 3];
        let mut by_point = Groups::of(corners, self.points.len(), at);
        let (low, high) = extent(self.points.iter().copied());
        let size = (high - low).length();
        let (mut copies, mut places, mut pinched) = (Vec::new(), 0, 0);
        for (point, at_point) in (0_u32..).zip(by_point.iter_mut()) {
            at_point.sort_unstable_by_key(|&c| (fan_of[c as usize], c));
            let fans = at_point.chunk_by(|&a, &b| fan_of[a as usize] == fan_of[b as usize]);
            let fan_count = fans.clone().count();
            if fan_count < 2 || 2 * fan_count <= outer[point as usize] {
                pinched += usize::from(fan_count > 1);
                continue;
            }
            places += 1;
            let place = self.points[point as usize];
            for fan in fans {
                let others = fan.iter().flat_map(|&c| self.triangles[c as usize / 3]).filter(|&k| k != point);
                let others: Vec<DVec3> = others.map(|k| self.points[k as usize]).collect();
                let way = others.iter().sum::<DVec3>() / others.len() as f64 - place;
                let shortest = others.iter().map(|p| p.distance(place)).fold(f64::INFINITY, f64::min);
                let far = (GAP * size).min(GAP_OF_EDGE * shortest);
                self.points.push(place + way.normalize_or_zero() * far);
                copies.push(point);
                for &c in fan {
                    self.triangles[c as usize / 3][c as usize % 3] = self.points.len() as u32 - 1;
                }
            }
        }
        (copies, places, pinched)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::fixtures::{beside, border_edges, cube, plate};

    #[test]
    fn coincident_points_are_merged() {
        let mut mesh = beside(plate(4, 0.0), &plate(4, 0.0), DVec3::X);
        assert_eq!((border_edges(&mesh), mesh.weld(&Cancel::default()), border_edges(&mesh)), (32, 5, 24));
        assert_eq!(mesh.weld(&Cancel::default()), 0);
    }

    #[test]
    fn hanging_points_are_inserted_into_their_sides() {
        // One border has four sides along the two of the other.
        let mut mesh = beside(plate(4, 0.0), &plate(2, 0.0), DVec3::X);
        assert_eq!((mesh.weld(&Cancel::default()), mesh.stitch(false, None, &Cancel::default())), (3, 2));
        assert_eq!(border_edges(&mesh), 16 + 8 - 4 - 2);
        let area: f64 = (0..mesh.triangles.len()).map(|t| 0.5 * mesh.area_vector(t).length()).sum();
        assert!((area - 2.0).abs() < 1e-12 && mesh.stitch(false, None, &Cancel::default()) == 0);
    }

    #[test]
    fn cubes_that_touch_in_a_corner_are_separated_and_plates_are_not() {
        let mut mesh = beside(cube(1), &cube(1), DVec3::ONE);
        assert_eq!(mesh.weld(&Cancel::default()), 1);
        let points = mesh.points.len();
        let (copies, places, _) = mesh.separate(&Cancel::default());
        assert_eq!((copies.len(), places, mesh.points.len()), (2, 1, points + 2));
        let [a, b] = [mesh.points[points], mesh.points[points + 1]];
        assert!(a.distance(b) > 1e-7 && a.distance(b) < 1e-5);
        let mut mesh = beside(plate(2, 0.0), &plate(2, 0.0), DVec3::new(1.0, 1.0, 0.0));
        assert_eq!((mesh.weld(&Cancel::default()), mesh.separate(&Cancel::default()).1), (1, 0));
    }
}
