//! Merges points: coincident ones for formats that store each triangle with its own corners (STL), or that repeat a
//! point where its normal or texture coordinate differs (glTF); and those of a mesh whose coordinates differ although
//! they are meant to be one.

pub mod borders;
mod mesh;
mod precision;

use std::hash::BuildHasher;

use glam::DVec3;
use rustc_hash::FxBuildHasher;

use crate::core::kernel::Shortest;
use crate::core::progress::Cancel;
pub use mesh::Welded;

/// Relative tolerance for formats in single precision: a few rounding errors of the largest coordinate.
pub const SINGLE: f64 = 4.0 * f32::EPSILON as f64;

/// Which points of a mesh are merged besides those at exactly one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// Points of borders that are far closer to each other than the edges there are long, with a clear gap between
    /// these distances and all others (docs/files.md, "Near points").
    #[default]
    Auto,
    /// Points of borders up to this distance; none for 0.
    Within(f64),
}

impl Weld {
    /// The word for [`Weld::Auto`], on the command line and in cases.
    pub const AUTO: &str = "auto";

    /// The value as a case and the command line write it.
    pub fn written(self) -> String {
        match self {
            Weld::Auto => Weld::AUTO.to_owned(),
            Weld::Within(distance) => Shortest(distance).to_string(),
        }
    }

    /// The same for a mesh whose coordinates will be multiplied by `scale`.
    #[must_use]
    pub fn before_scaling(self, scale: f64) -> Weld {
        match self {
            Weld::Auto => Weld::Auto,
            Weld::Within(distance) => Weld::Within(distance / scale),
        }
    }
}

/// Points welded between two checks for cancellation.
const BATCH: usize = 1 << 14;

/// Merges points closer than a tolerance into the first of them. Each point is compared with the kept points only, so
/// that a chain of close points does not collapse. The caller owns the kept points; the welder stores 8 to 12 bytes for
/// each.
pub struct Welder {
    tolerance: f64,
    /// Grid cells per unit length. A cell is wider than the tolerance, so that a search seldom leaves it, and small
    /// enough to hold at most a few hundred kept points.
    cells: f64,
    /// Heads of the hash buckets, a power of two of them: the last point of each, `u32::MAX` for none.
    last: Vec<u32>,
    /// For each kept point, the previous one in its bucket.
    before: Vec<u32>,
}

impl Welder {
    /// A welder with the tolerance `relative` times the largest absolute coordinate.
    pub fn new(relative: f64, largest: f64) -> Welder {
        let tolerance = (relative * largest).max(f64::MIN_POSITIVE);
        Welder { tolerance, cells: 1.0 / (8.0 * tolerance), last: vec![u32::MAX], before: Vec::new() }
    }

    /// The index in `kept` of the point that represents `p`: an earlier point, or `p` itself, appended.
    pub fn weld(&mut self, kept: &mut Vec<DVec3>, p: DVec3) -> u32 {
        self.find(kept, p).unwrap_or_else(|| {
            kept.push(p);
            self.keep(kept)
        })
    }

    /// The first kept point within the tolerance of `p`.
    fn find(&self, kept: &[DVec3], p: DVec3) -> Option<u32> {
        self.find_where(kept, p, &mut |_| true)
    }

    /// The first kept point within the tolerance of `p` that may be merged with it.
    fn find_where(&self, kept: &[DVec3], p: DVec3, may: &mut dyn FnMut(u32) -> bool) -> Option<u32> {
        // Clamped, since the largest finite number plus the tolerance may be infinite, which has no cell.
        let ends = [p - self.tolerance, p + self.tolerance];
        let [low, high] = ends.map(|q| self.cell(q.clamp(DVec3::MIN, DVec3::MAX)));
        let mut found: Option<u32> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let cell = [x, y, z];
                    let mut at = self.last[self.bucket(cell)];
                    while at != u32::MAX {
                        let q = kept[at as usize];
                        // A bucket may hold points of other cells.
                        let is_near = q.distance(p) <= self.tolerance && found.is_none_or(|f| at < f);
                        if is_near && self.cell(q) == cell && may(at) {
                            found = Some(at);
                        }
                        at = self.before[at as usize];
                    }
                }
            }
        }
        found
    }

    /// Registers the last kept point; returns its index.
    fn keep(&mut self, kept: &[DVec3]) -> u32 {
        let new = self.before.len();
        if new == self.last.len() {
            // Rehash into twice as many buckets.
            self.last = vec![u32::MAX; 2 * new];
            self.before.clear();
        }
        for at in self.before.len()..=new {
            let bucket = self.bucket(self.cell(kept[at]));
            self.before.push(std::mem::replace(&mut self.last[bucket], at as u32));
        }
        new as u32
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        (p * self.cells).floor().to_array().map(|x| x as i64)
    }

    fn bucket(&self, cell: [i64; 3]) -> usize {
        FxBuildHasher.hash_one(cell) as usize & (self.last.len() - 1)
    }
}

/// Merges points within `relative` times the largest coordinate. Leaves the kept ones in `points`, and returns for each
/// original point the index of the kept one that represents it. When cancelled, returns an empty list and leaves
/// `points` in an unspecified state.
pub fn weld(points: &mut Vec<DVec3>, relative: f64, cancel: &Cancel) -> Vec<u32> {
    let mut welder = Welder::new(relative, points.iter().fold(0.0, |largest, p| p.abs().max_element().max(largest)));
    let mut representative = Vec::with_capacity(points.len());
    // Kept points move to the front: no second array is needed.
    let mut kept = 0;
    for k in 0..points.len() {
        if k % BATCH == 0 && cancel.is_asked() {
            return Vec::new();
        }
        let p = points[k];
        representative.push(welder.find(&points[..kept], p).unwrap_or_else(|| {
            points[kept] = p;
            kept += 1;
            welder.keep(&points[..kept])
        }));
    }
    drop(welder);
    points.truncate(kept);
    points.shrink_to_fit();
    representative
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_within_the_tolerance_merge_into_the_first_and_others_stay_apart() {
        let near = 1000.0 * SINGLE;
        let p = DVec3::new(1000.0, -3.0, 0.5);
        let mut points =
            vec![p, DVec3::ZERO, p + DVec3::new(0.9 * near, 0.0, 0.0), p + DVec3::new(0.0, 1.1 * near, 0.0)];
        let apart = points[3];
        assert_eq!(weld(&mut points, SINGLE, &Cancel::default()), [0, 1, 0, 2]);
        assert_eq!(points, [p, DVec3::ZERO, apart]);
    }

    #[test]
    fn a_point_merges_across_the_border_of_a_cell() {
        let cell = 8.0 * SINGLE;
        for offset in [0.0, 1.0, -1.0, 7.0] {
            let border = DVec3::new(offset * cell, 0.0, 0.0);
            let mut points = vec![DVec3::ONE, border - 0.2 * SINGLE, border + 0.2 * SINGLE];
            assert_eq!(weld(&mut points, SINGLE, &Cancel::default()), [0, 1, 1], "{offset}");
        }
    }

    #[test]
    fn many_points_just_beyond_the_tolerance_beside_one_outlier_do_not_take_quadratic_time() {
        // The outlier sets the tolerance.
        let near = SINGLE * 1e4;
        let mut points = vec![DVec3::new(1e4, 0.0, 0.0)];
        points.extend((0..70 * 70 * 40).map(|k| {
            let at = [k % 70, k / 70 % 70, k / 4900].map(f64::from);
            DVec3::from_array(at) * (1.1 * near)
        }));
        // In quadratic time, this would run for minutes.
        let number = points.len();
        weld(&mut points, SINGLE, &Cancel::default());
        assert_eq!(points.len(), number);
    }

    #[test]
    fn points_all_at_zero_or_at_the_largest_number_merge_and_an_empty_list_stays_empty() {
        let mut points = vec![DVec3::MAX, DVec3::MIN, DVec3::MAX];
        assert_eq!(weld(&mut points, SINGLE, &Cancel::default()), [0, 1, 0]);
        assert_eq!(weld(&mut vec![DVec3::ZERO; 3], SINGLE, &Cancel::default()), [0, 0, 0]);
        assert!(weld(&mut Vec::new(), SINGLE, &Cancel::default()).is_empty());
    }
}
