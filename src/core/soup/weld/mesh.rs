//! Merges points of a mesh that are meant to be one although their coordinates differ.

use glam::DVec3;

use super::borders::{Borders, CLOSE, Close};
use super::precision::quantum;
use super::{BATCH, Weld, Welder};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::DisjointSets;
use crate::core::kernel::decimal::number;
use crate::core::progress::Cancel;
use crate::core::soup::counting::Count;
use crate::core::soup::mesh_file::MeshFile;
use crate::core::soup::repairs::Repair;

/// By [`Weld::Auto`], points are merged up to this fraction of the shortest side at either of them,
const FAR_BELOW: f64 = 1e-3;
/// or up to [`CLOSE`] if rounding may have moved them so far: coordinates of one place differ by a unit in the last
/// place, in each direction.
const ROUNDED: f64 = 1.75;
/// Coordinates that differ by this fraction of the largest one are the same.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// No other distance may be less than so many times the largest at which points are merged.
const GAP: f64 = 10.0;
/// Points are merged up to so many times the largest distance found, if the gap has room for it.
const ROOM: f64 = 4.0;
/// Limit of the pairs compared with a given distance, for each point.
const PAIRS: usize = 512;

/// What was merged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Welded {
    /// The number of points that were merged into others.
    pub merged: usize,
    /// The largest distance of one of them from the other.
    pub farthest: f64,
    /// The number of points within a given distance that were kept apart: an element has both.
    pub apart: usize,
    /// The number of sides at which three elements or more have come together.
    pub branching: usize,
    /// The distance up to which a point is on a side; `None` if points are merged only at exactly one place.
    pub tolerance: Option<f64>,
}

impl Welded {
    /// The same after the coordinates have been multiplied.
    #[must_use]
    pub fn scaled(self, scale: f64) -> Welded {
        Welded { farthest: scale * self.farthest, tolerance: self.tolerance.map(|far| scale * far), ..self }
    }

    /// Appends what was merged to the repairs.
    pub fn report(&self, repairs: &mut Vec<String>) {
        Repair::NearPoint.report(self.merged, repairs);
        if let (Some(told), 1..) = (repairs.last_mut(), self.merged) {
            told.push_str(&format!(", up to {} away", number(self.farthest)));
        }
        Repair::KeptApart.report(self.apart, repairs);
        Repair::BranchingEdge.report(self.branching, repairs);
    }
}

impl MeshFile {
    /// Merges points of borders that differ in their coordinates only, each into the first of its group, and removes
    /// them. No element loses a corner: points of one element are kept apart. Without effect on a mesh with missing or
    /// infinite points, which is refused later.
    ///
    /// # Errors
    /// A given distance beyond the mean length of the sides, or one that has hundreds of points within it at many
    /// points; [`Fault::stopped`].
    pub fn weld(&mut self, how: Weld, cancel: &Cancel) -> Result<Welded, Fault> {
        let given = match how {
            Weld::Within(distance) if distance.is_nan() || distance <= 0.0 => return Ok(Welded::default()),
            Weld::Within(distance) => Some(distance),
            Weld::Auto => None,
        };
        let mut welded = Welded { tolerance: Some(given.unwrap_or(0.0)), ..Welded::default() };
        let is_sound = |k: &u32| self.points.get(*k as usize).is_some_and(|p| p.is_finite());
        if self.points.len() > u32::MAX as usize / 8 || !self.all_faces().flatten().all(is_sound) {
            return Ok(welded);
        }
        let borders = Borders::of(&self.points, self.all_faces());
        cancel.check()?;
        if let Some(distance) = given.filter(|&distance| distance > borders.mean_side()) {
            let [far, mean] = [distance, borders.mean_side()].map(number);
            let what =
                format!("Points up to {far} away cannot be merged: the edges have a length of {mean} on average");
            return Err(Fault::new(what).of_kind(FaultKind::Mesh).remedy("Give a smaller distance (--weld)"));
        }
        let tolerance = given.unwrap_or_else(|| automatic(&borders, &self.points, cancel));
        cancel.check()?;
        welded.tolerance = Some(tolerance);
        if tolerance == 0.0 {
            return Ok(welded);
        }
        let (first, apart) = self.first_of_each(&borders, tolerance, given.is_some(), cancel)?;
        let distance = |(k, &first): (usize, &u32)| self.points[k].distance(self.points[first as usize]);
        welded.apart = apart;
        welded.merged = first.iter().enumerate().filter(|(k, first)| *k != **first as usize).count();
        welded.farthest = first.iter().enumerate().map(distance).fold(0.0, f64::max);
        if welded.merged > 0 {
            let before = self.branching_sides();
            self.merge(&first);
            welded.branching = self.branching_sides().saturating_sub(before);
        }
        Ok(welded)
    }

    /// The corners of all elements: triangles, quadrilaterals, polygons.
    fn all_faces(&self) -> impl Iterator<Item = &[u32]> {
        self.faces().map(|(corners, _)| corners).chain(self.polygons.iter().map(Vec::as_slice))
    }

    /// The number of sides of three elements or more.
    fn branching_sides(&self) -> usize {
        let ends = |face: &[u32]| -> Vec<[u32; 2]> {
            let next = face.iter().cycle().skip(1);
            face.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]).collect()
        };
        let mut sides: Vec<[u32; 2]> = self.all_faces().flat_map(ends).collect();
        sides.sort_unstable();
        sides.chunk_by(|a, b| a == b).filter(|alike| alike.len() > 2).count()
    }

    /// For each point the first one that it is merged into, or itself; and how many are kept apart since an element has
    /// both. Two points at exactly one place and of one piece may be the banks of a crack: they are merged only within
    /// a given distance.
    fn first_of_each(
        &self,
        borders: &Borders<'_>,
        tolerance: f64,
        is_given: bool,
        cancel: &Cancel,
    ) -> Result<(Vec<u32>, usize), Fault> {
        let points = &self.points;
        let mut pieces = DisjointSets::new(points.len());
        self.all_faces().for_each(|face| face.iter().for_each(|&k| pieces.join(face[0], k)));
        let piece: Vec<u32> = (0..points.len() as u32).map(|k| pieces.find(k)).collect();
        let mut welder = Welder::new(1.0, tolerance);
        let mut first: Vec<u32> = (0..points.len() as u32).collect();
        // The points that others may be merged into, and their places.
        let (mut kept, mut places): (Vec<u32>, Vec<DVec3>) = (Vec::new(), Vec::new());
        let (mut apart, mut left) = (0, PAIRS * points.len());
        for k in 0..points.len() as u32 {
            if (k as usize).is_multiple_of(BATCH) {
                cancel.check()?;
            }
            if borders.elements_at(k).is_empty() {
                continue;
            }
            let p = points[k as usize];
            let mut is_apart = false;
            let mut may = |at: u32| {
                left = left.saturating_sub(1);
                let other = kept[at as usize];
                if left == 0 || !(borders.is_border[k as usize] || borders.is_border[other as usize]) {
                    return false;
                }
                if !is_given {
                    let distance = p.distance(points[other as usize]);
                    let local = borders.shortest[k as usize].min(borders.shortest[other as usize]);
                    if distance > CLOSE * local || distance == 0.0 && piece[k as usize] == piece[other as usize] {
                        return false;
                    }
                }
                let corners = borders.elements_at(k).iter().flat_map(|&element| borders.corners(element));
                let is_one = corners.copied().any(|corner| corner < k && first[corner as usize] == other);
                is_apart |= is_one;
                !is_one
            };
            match welder.find_where(&places, p, &mut may) {
                Some(at) => first[k as usize] = kept[at as usize],
                None => {
                    apart += usize::from(is_apart && is_given);
                    kept.push(k);
                    places.push(p);
                    welder.keep(&places);
                }
            }
            if left == 0 {
                let what = format!("Within {} of many points there are hundreds of others", number(tolerance));
                return Err(Fault::new(what).of_kind(FaultKind::Mesh).remedy("Give a smaller distance (--weld)"));
            }
        }
        Ok((first, apart))
    }

    /// Merges points into the `first` of each, and removes them.
    fn merge(&mut self, first: &[u32]) {
        let keep: Vec<bool> = first.iter().enumerate().map(|(k, &first)| k == first as usize).collect();
        let mut number = 0;
        let mut new: Vec<u32> = Vec::with_capacity(first.len());
        for &kept in &keep {
            new.push(number);
            number += u32::from(kept);
        }
        let of = |k: &mut u32| *k = first.get(*k as usize).map_or(*k, |&first| new[first as usize]);
        self.triangles.as_flattened_mut().iter_mut().for_each(of);
        self.quads.as_flattened_mut().iter_mut().for_each(of);
        self.polygons.iter_mut().flatten().for_each(of);
        self.lines.as_flattened_mut().iter_mut().for_each(of);
        for members in self.members.iter_mut().filter(|members| members.dimension == 0) {
            members.of.iter_mut().for_each(of);
            members.of.sort_unstable();
            members.of.dedup();
        }
        if !matches!(self.counting.points, Count::Nothing) {
            let kept = (0..keep.len()).filter(|&k| keep[k]);
            let numbers: Vec<u64> = kept.filter_map(|k| self.counting.points.number(k)).collect();
            self.counting.points = Count::of(&numbers);
        }
        retain(&mut self.points, &keep);
        self.metric.iter_mut().for_each(|metric| retain(metric, &keep));
        self.uv.iter_mut().for_each(|uv| retain(uv, &keep));
        self.point_data.iter_mut().for_each(|data| retain(&mut data.values, &keep));
    }
}

/// Removes the items whose flag is false.
fn retain<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| keep.next() != Some(&false));
}

/// The distance up to which points are merged by [`Weld::Auto`]; 0: none are.
fn automatic(borders: &Borders<'_>, points: &[DVec3], cancel: &Cancel) -> f64 {
    let mut close = borders.close(cancel);
    // What differs by rounding in double precision is at one place.
    let largest = points.iter().fold(0.0_f64, |largest, p| largest.max(p.abs().max_element()));
    close.retain(|close| close.distance > ROUNDING * largest);
    if close.is_empty() {
        return 0.0;
    }
    close.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance));
    let used = (0_u32..).zip(points).filter(|&(k, _)| !borders.elements_at(k).is_empty());
    let rounded = ROUNDED * quantum(used.map(|(_, &p)| p));
    let is_one = |close: &Close| close.distance <= (FAR_BELOW * close.local).max(rounded.min(CLOSE * close.local));
    for (k, near) in close.iter().enumerate().rev().filter(|(_, close)| is_one(close)) {
        let next = close.get(k + 1).map_or(f64::INFINITY, |next| next.distance);
        if next >= GAP * near.distance {
            return (ROOM * near.distance).min((near.distance * next).sqrt());
        }
    }
    0.0
}
