//! Points of a mesh that are meant to be one although their coordinates differ, and borders that nearly touch
//! (docs/files.md, "Near points").
//!
//! Points at exactly one place are not meant here: whether they are one depends on what the mesh is for.

use std::collections::BTreeMap;

use glam::DVec3;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use smallvec::SmallVec;

use super::MeshFile;
use super::weld::weld;
use crate::core::kernel::DisjointSets;
use crate::core::kernel::box_tree::extent;
use crate::core::kernel::decimal::{number, point_text};
use crate::core::progress::Cancel;

/// Which points of a mesh are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// Points of borders that are far closer to each other than their elements are large, or than the file is precise.
    #[default]
    Auto,
    /// All points up to this distance; none for 0.
    Within(f64),
}

impl Weld {
    /// The word for [`Weld::Auto`], on the command line and in cases.
    pub const AUTO: &str = "auto";
}

/// Points of a border are joined if their distance is at most this part of the shortest edge at either of them.
const JOINED: f64 = 1e-3;
/// Up to this part of that edge they are joined if the file is no more precise, and told otherwise.
const CLOSE: f64 = 0.1;
/// The errors of two coordinates, in units of the last digit.
const ROUNDED: f64 = 2.0;
/// Numbers with more significant digits are those of double precision, and with fewer those that a person writes.
const DIGITS: std::ops::RangeInclusive<i32> = 5..=14;
/// Places that are named.
const NAMED: usize = 3;
/// Points looked at between two checks for cancellation.
const BATCH: usize = 1 << 12;

impl MeshFile {
    /// Joins near points, each to the first of its group: elements and lines then have that one. Returns how many were
    /// joined, as a phrase. Without effect on a mesh with missing or infinite points, which is refused later, and when
    /// cancelled.
    pub fn join_near(&mut self, how: Weld, cancel: &Cancel) -> Option<String> {
        let corners = self.faces().map(|face| face.0).chain(self.polygons.iter().map(Vec::as_slice)).flatten();
        let is_sound = |k: &u32| self.points.get(*k as usize).is_some_and(|p| p.is_finite());
        if !corners.into_iter().all(is_sound) || self.points.len() > u32::MAX as usize / 8 {
            return None;
        }
        let joined = match how {
            Weld::Within(distance) => self.within(distance, cancel),
            Weld::Auto => self.near(cancel),
        };
        if joined.is_empty() || cancel.is_asked() {
            return None;
        }
        let distance = |(&k, &first): (&u32, &u32)| self.points[k as usize].distance(self.points[first as usize]);
        let farthest = number(joined.iter().map(distance).fold(0.0, f64::max));
        self.replace_points(&joined);
        Some(match joined.len() {
            1 => format!("1 point was joined to another, {farthest} away"),
            n => format!("{n} points were joined to others, at most {farthest} away"),
        })
    }

    /// Each point up to a distance from an earlier one, with that one.
    fn within(&self, distance: f64, cancel: &Cancel) -> BTreeMap<u32, u32> {
        if distance == 0.0 {
            return BTreeMap::new();
        }
        let mut used = vec![false; self.points.len()];
        let faces = self.faces().map(|face| face.0).chain(self.polygons.iter().map(Vec::as_slice));
        faces.flatten().for_each(|&k| used[k as usize] = true);
        let used: Vec<u32> = (0..self.points.len() as u32).filter(|&k| used[k as usize]).collect();
        let mut places: Vec<DVec3> = used.iter().map(|&k| self.points[k as usize]).collect();
        let largest = places.iter().fold(f64::MIN_POSITIVE, |largest, p| p.abs().max_element().max(largest));
        let representative = weld(&mut places, distance / largest, cancel);
        let mut first = vec![u32::MAX; places.len()];
        let mut joined = BTreeMap::new();
        for (&k, &place) in used.iter().zip(&representative) {
            match first[place as usize] {
                u32::MAX => first[place as usize] = k,
                earlier => _ = joined.insert(k, earlier),
            }
        }
        joined
    }

    fn replace_points(&mut self, joined: &BTreeMap<u32, u32>) {
        let mut by = Vec::from_iter(0..self.points.len() as u32);
        joined.iter().for_each(|(&k, &first)| by[k as usize] = first);
        let corners = self.triangles.as_flattened_mut().iter_mut().chain(self.quads.as_flattened_mut());
        let corners = corners.chain(self.polygons.iter_mut().flatten()).chain(self.lines.as_flattened_mut());
        corners.for_each(|k| *k = by.get(*k as usize).copied().unwrap_or(*k));
        for members in self.members.iter_mut().filter(|members| members.dimension == 0) {
            members.of.iter_mut().for_each(|k| *k = by.get(*k as usize).copied().unwrap_or(*k));
            members.of.sort_unstable();
            members.of.dedup();
        }
        self.joined = joined.len();
    }

    /// Each point that is joined by [`Weld::Auto`], with the first point of its place.
    fn near(&self, cancel: &Cancel) -> BTreeMap<u32, u32> {
        let faces = self.faces().map(|face| face.0).chain(self.polygons.iter().map(Vec::as_slice));
        let Some(borders) = Borders::of(&self.points, faces, cancel) else { return BTreeMap::new() };
        let precision = precision(borders.points.iter().map(|&k| self.points[k as usize]));
        let mut pairs = Vec::new();
        borders.pairs(cancel, &mut |ends, distance, edge| {
            let joins = distance <= (JOINED * edge).max(precision.min(CLOSE * edge));
            if joins && distance > 0.0 && !borders.is_side(ends) {
                pairs.push((distance, edge, ends));
            }
        });
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        let mut sets = DisjointSets::new(self.points.len());
        for &(distance, edge, ends) in &pairs {
            let [a, b] = ends.map(|k| sets.find(k));
            // No chain of near points joins distant ones.
            if self.points[a as usize].distance(self.points[b as usize]) <= 4.0 * distance.max(JOINED * edge) {
                sets.join(a, b);
            }
        }
        (0..self.points.len() as u32).map(|k| (k, sets.find(k))).filter(|(k, first)| k != first).collect()
    }
}

/// Tells of points of the border that lie on or near triangles without being joined to them, as a phrase: near points
/// of the border that are not at one place, and points beside a part to which they do not belong. Parts are what is
/// connected by sides. `None` where there are none, and when cancelled.
pub fn nearly_touching(points: &[DVec3], triangles: &[[u32; 3]], cancel: &Cancel) -> Option<String> {
    let borders = Borders::of(points, triangles.iter().map(<[u32; 3]>::as_slice), cancel)?;
    let (mut same, mut close) = (Vec::new(), Vec::new());
    borders.pairs(cancel, &mut |ends, distance, edge| {
        if distance == 0.0 {
            same.push(ends);
        } else if distance <= CLOSE * edge && ends.iter().all(|&k| borders.slot(k).is_some()) && !borders.is_side(ends)
        {
            close.push((ends, distance));
        }
    });
    let mut sets = DisjointSets::new(points.len());
    same.iter().for_each(|&[p, q]| sets.join(p, q));
    let place: Vec<u32> = (0..points.len() as u32).map(|k| sets.find(k)).collect();
    let at_places = |ends: [u32; 2]| ends.map(|k| place[k as usize]);
    close.retain(|&(ends, _)| at_places(ends)[0] != at_places(ends)[1] && !borders.is_side(at_places(ends)));
    let mut found: Vec<(u32, f64)> =
        close.iter().flat_map(|&([p, q], distance)| [(p, distance), (q, distance)]).collect();
    borders.beside_other_parts(triangles, &place, cancel, &mut found);
    if cancel.is_asked() {
        return None;
    }
    let nearest = number(found.iter().map(|close| close.1).reduce(f64::min)?);
    found.sort_unstable_by_key(|close| close.0);
    found.dedup_by_key(|close| close.0);
    let places = found.iter().take(NAMED).map(|close| point_text(points[close.0 as usize]));
    let places = places.collect::<Vec<_>>().join(", ");
    let more = if found.len() > NAMED { ", ..." } else { "" };
    let (count, lie) = match found.len() {
        1 => ("1 border point".to_owned(), "lies"),
        n => (format!("{n} border points"), "lie"),
    };
    Some(format!(
        "{count} {lie} on or near elements without being joined to them (nearest {nearest} away): {places}{more}"
    ))
}

/// The border of a mesh: the sides of one element.
struct Borders<'a> {
    all: &'a [DVec3],
    /// The sides of all elements, by their ends in ascending order.
    sides: Vec<[u32; 2]>,
    /// For each point, the length of the shortest side there; infinite without one.
    shortest: Vec<f64>,
    /// The points of the border, ascending.
    points: Vec<u32>,
    tree: RTree<GeomWithData<[f64; 3], u32>>,
}

impl<'a> Borders<'a> {
    /// `None` without a border, and when cancelled.
    fn of<'f>(all: &'a [DVec3], faces: impl Iterator<Item = &'f [u32]>, cancel: &Cancel) -> Option<Borders<'a>> {
        let mut sides = Vec::new();
        for corners in faces {
            let ends = (0..corners.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()]]);
            sides.extend(ends.map(|[a, b]| [a.min(b), a.max(b)]));
        }
        sides.sort_unstable();
        let mut shortest = vec![f64::INFINITY; all.len()];
        let mut points = Vec::new();
        for alike in sides.chunk_by(|a, b| a == b) {
            let length = alike[0].map(|end| all[end as usize]);
            let length = length[0].distance(length[1]);
            if length > 0.0 {
                alike[0].iter().for_each(|&end| shortest[end as usize] = shortest[end as usize].min(length));
            }
            if alike.len() == 1 {
                points.extend(alike[0]);
            }
        }
        points.sort_unstable();
        points.dedup();
        if points.is_empty() || cancel.is_asked() {
            return None;
        }
        let places = points.iter().map(|&k| GeomWithData::new(all[k as usize].to_array(), k)).collect();
        Some(Borders { all, sides, shortest, points, tree: RTree::bulk_load(places) })
    }

    /// The place of a point among those of the border.
    fn slot(&self, point: u32) -> Option<usize> {
        self.points.binary_search(&point).ok()
    }

    fn is_side(&self, [a, b]: [u32; 2]) -> bool {
        self.sides.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }

    /// The points of the border in a box.
    fn within(&self, low: DVec3, high: DVec3) -> impl Iterator<Item = u32> + '_ {
        let around = AABB::from_corners(low.to_array(), high.to_array());
        self.tree.locate_in_envelope(around).map(|near| near.data)
    }

    /// Calls `tell` once for each pair of points, one of them at least of the border, that is closer than the
    /// [`CLOSE`] part of the shortest side at both: with the points, their distance, and the length of that side.
    fn pairs(&self, cancel: &Cancel, tell: &mut dyn FnMut([u32; 2], f64, f64)) {
        for (q, &edge) in (0_u32..).zip(&self.shortest).filter(|(_, edge)| edge.is_finite()) {
            if (q as usize).is_multiple_of(BATCH) && cancel.is_asked() {
                return;
            }
            let place = self.all[q as usize];
            let on_border = self.slot(q).is_some();
            for p in self.within(place - CLOSE * edge, place + CLOSE * edge) {
                // Pairs of two points of the border come twice.
                if p == q || on_border && p > q {
                    continue;
                }
                let distance = place.distance(self.all[p as usize]);
                let edge = edge.min(self.shortest[p as usize]);
                if distance <= CLOSE * edge {
                    tell([p, q], distance, edge);
                }
            }
        }
    }

    /// Adds points of the border that lie beside triangles of parts that they do not belong to, with their distances.
    /// `place` is the first point at the place of each.
    fn beside_other_parts(&self, triangles: &[[u32; 3]], place: &[u32], cancel: &Cancel, found: &mut Vec<(u32, f64)>) {
        let mut sides = Vec::with_capacity(3 * triangles.len());
        for (triangle, corners) in (0_u32..).zip(triangles) {
            let at = corners.map(|k| place[k as usize]);
            sides.extend([(0, 1), (1, 2), (2, 0)].map(|(i, j)| ([at[i].min(at[j]), at[i].max(at[j])], triangle)));
        }
        sides.sort_unstable();
        let mut parts = DisjointSets::new(triangles.len());
        for alike in sides.chunk_by(|a, b| a.0 == b.0) {
            alike.windows(2).for_each(|pair| parts.join(pair[0].1, pair[1].1));
        }
        drop(sides);
        let part: Vec<u32> = (0..triangles.len() as u32).map(|triangle| parts.find(triangle)).collect();
        if part.iter().all(|&own| own == part[0]) {
            return;
        }
        // The parts at each place of the border.
        let mut of_place: BTreeMap<u32, SmallVec<[u32; 2]>> =
            self.points.iter().map(|&k| (place[k as usize], SmallVec::new())).collect();
        for (corners, &own) in triangles.iter().zip(&part) {
            for k in corners {
                if let Some(parts) = of_place.get_mut(&place[*k as usize]).filter(|parts| !parts.contains(&own)) {
                    parts.push(own);
                }
            }
        }
        for (at, (corners, &own)) in triangles.iter().zip(&part).enumerate() {
            if at.is_multiple_of(BATCH) && cancel.is_asked() {
                return;
            }
            let corners = corners.map(|k| self.all[k as usize]);
            let (low, high) = extent(corners);
            let long = (high - low).max_element();
            for k in self.within(low - CLOSE * long, high + CLOSE * long) {
                if of_place.get(&place[k as usize]).is_some_and(|parts| parts.contains(&own)) {
                    continue;
                }
                let distance = distance_to_triangle(self.all[k as usize], corners);
                if distance <= CLOSE * self.shortest[k as usize].min(long) {
                    found.push((k, distance));
                }
            }
        }
    }
}

/// How far two coordinates of one place may be apart by rounding, if all are numbers of single precision or have been
/// written with few digits; otherwise 0.
fn precision(points: impl Iterator<Item = DVec3> + Clone) -> f64 {
    let coordinates = || points.clone().flat_map(|p| p.to_array());
    let largest = coordinates().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    if coordinates().all(|x| f64::from(x as f32) == x) {
        return ROUNDED * f64::from(f32::EPSILON) * largest;
    }
    // The shortest text that gives the number has as many digits as were written, or fewer.
    let digits = |x: f64| format!("{:e}", x.abs()).split('e').next().map_or(0, |digits| digits.len() as i32 - 1);
    let most = coordinates().map(digits).max().unwrap_or(0);
    if !DIGITS.contains(&most) {
        return 0.0;
    }
    ROUNDED * libm::pow(10.0, f64::from(libm::log10(largest).floor() as i32 + 1 - most))
}

/// The distance of a point from a triangle (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
fn distance_to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac, normal) = (b - a, c - a, (b - a).cross(c - a));
    let inside = normal.length_squared() > 0.0
        && [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| normal.dot((to - from).cross(p - from)) >= 0.0);
    if inside {
        return (p - a).dot(normal).abs() / ab.cross(ac).length();
    }
    let to_side = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let share = ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        p.distance(if share.is_finite() { from.lerp(to, share) } else { from })
    };
    [(a, b), (b, c), (c, a)].map(to_side).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests;
