//! Points at one place made one: for formats that say a mesh triangle by triangle (STL), or that give a point more than
//! once where its normal or texture differs (glTF).

use std::hash::BuildHasher;

use glam::DVec3;
use rustc_hash::FxBuildHasher;

use crate::core::progress::Cancel;

/// For formats in single precision: some rounding errors of the largest coordinate.
pub const SINGLE: f64 = 4.0 * f32::EPSILON as f64;

/// So many points are welded between two looks at whether to go on.
const AT_A_TIME: usize = 1 << 14;

/// Joins points that lie within some distance of each other; the first of them stays. A chain of points is not drawn together: each is
/// compared with the ones that stay. Those lie with whoever welds, and are found here by their number: eight to twelve bytes for each.
pub struct Welder {
    near: f64,
    /// How many of the cells by which points are found go into a unit. They are larger than the distance, so that a point seldom has to
    /// look beyond its own, but no more than a few hundred points that stay have room in one.
    cells: f64,
    /// The last point of each drawer, into which cells are laid by their hash; their number is a power of two. And for each point the
    /// one before it in its drawer.
    last: Vec<u32>,
    before: Vec<u32>,
}

impl Welder {
    /// A welder within `relative` times the largest coordinate, whichever sign it has.
    pub fn new(relative: f64, largest: f64) -> Welder {
        let near = (relative * largest).max(f64::MIN_POSITIVE);
        Welder { near, cells: 1.0 / (8.0 * near), last: vec![u32::MAX], before: Vec::new() }
    }

    /// The place of the point that stands for `p` among those that are kept: an earlier one, or itself, the last.
    pub fn weld(&mut self, kept: &mut Vec<DVec3>, p: DVec3) -> u32 {
        self.find(kept, p).unwrap_or_else(|| {
            kept.push(p);
            self.keep(kept)
        })
    }

    /// The first of the points kept that lies near `p`.
    fn find(&self, kept: &[DVec3], p: DVec3) -> Option<u32> {
        // Beside the largest number of all lies infinity, and no cell.
        let (low, high) = (self.cell((p - self.near).max(DVec3::MIN)), self.cell((p + self.near).min(DVec3::MAX)));
        let mut found: Option<u32> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let cell = [x, y, z];
                    let mut at = self.last[self.drawer(cell)];
                    while at != u32::MAX {
                        let q = kept[at as usize];
                        // A drawer has points of other cells too.
                        if q.distance(p) <= self.near && found.is_none_or(|f| at < f) && self.cell(q) == cell {
                            found = Some(at);
                        }
                        at = self.before[at as usize];
                    }
                }
            }
        }
        found
    }

    /// Takes in the last of the points kept; its place.
    fn keep(&mut self, kept: &[DVec3]) -> u32 {
        let new = self.before.len();
        if new == self.last.len() {
            // More drawers, and all points into them again.
            self.last = vec![u32::MAX; 2 * new];
            self.before.clear();
        }
        for at in self.before.len()..=new {
            let drawer = self.drawer(self.cell(kept[at]));
            self.before.push(std::mem::replace(&mut self.last[drawer], at as u32));
        }
        new as u32
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        (p * self.cells).floor().to_array().map(|x| x as i64)
    }

    fn drawer(&self, cell: [i64; 3]) -> usize {
        FxBuildHasher.hash_one(cell) as usize & (self.last.len() - 1)
    }
}

/// Joins points within `relative` times the largest coordinate: `points` becomes those that stay. Returns for each point given the place
/// of the one that stands for it. Told to end, it returns nothing, and `points` are of no use.
pub fn weld(points: &mut Vec<DVec3>, relative: f64, cancel: &Cancel) -> Vec<u32> {
    let mut welder = Welder::new(relative, points.iter().fold(0.0, |largest, p| p.abs().max_element().max(largest)));
    let mut standing = Vec::with_capacity(points.len());
    // Those that stay move to the front: no room is needed beside that of the points.
    let mut kept = 0;
    for k in 0..points.len() {
        if k % AT_A_TIME == 0 && cancel.is_asked() {
            return Vec::new();
        }
        let p = points[k];
        standing.push(welder.find(&points[..kept], p).unwrap_or_else(|| {
            points[kept] = p;
            kept += 1;
            welder.keep(&points[..kept])
        }));
    }
    drop(welder);
    points.truncate(kept);
    points.shrink_to_fit();
    standing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_within_rounding_become_the_first_of_them_and_others_stay_apart() {
        let near = 1000.0 * SINGLE;
        let p = DVec3::new(1000.0, -3.0, 0.5);
        let mut points =
            vec![p, DVec3::ZERO, p + DVec3::new(0.9 * near, 0.0, 0.0), p + DVec3::new(0.0, 1.1 * near, 0.0)];
        let apart = points[3];
        assert_eq!(weld(&mut points, SINGLE, &Cancel::default()), [0, 1, 0, 2]);
        assert_eq!(points, [p, DVec3::ZERO, apart]);
    }

    #[test]
    fn a_point_finds_its_like_across_the_border_of_a_cell() {
        let cell = 8.0 * SINGLE;
        for offset in [0.0, 1.0, -1.0, 7.0] {
            let border = DVec3::new(offset * cell, 0.0, 0.0);
            let mut points = vec![DVec3::ONE, border - 0.2 * SINGLE, border + 0.2 * SINGLE];
            assert_eq!(weld(&mut points, SINGLE, &Cancel::default()), [0, 1, 1], "{offset}");
        }
    }

    #[test]
    fn many_points_that_barely_stay_apart_beside_one_far_away_take_no_square_of_their_number() {
        // A coordinate gone astray sets the distance by which points are told apart.
        let near = SINGLE * 1e4;
        let mut points = vec![DVec3::new(1e4, 0.0, 0.0)];
        points.extend((0..70 * 70 * 40).map(|k| {
            let at = [k % 70, k / 70 % 70, k / 4900].map(f64::from);
            DVec3::from_array(at) * (1.1 * near)
        }));
        // With the square of their number this would not end in minutes.
        let number = points.len();
        weld(&mut points, SINGLE, &Cancel::default());
        assert_eq!(points.len(), number);
    }

    #[test]
    fn points_at_the_largest_number_of_all_end_in_no_search_without_end() {
        let mut points = vec![DVec3::MAX, DVec3::MIN, DVec3::MAX];
        assert_eq!(weld(&mut points, SINGLE, &Cancel::default()), [0, 1, 0]);
    }

    #[test]
    fn points_all_at_zero_are_one_and_none_are_none() {
        assert_eq!(weld(&mut vec![DVec3::ZERO; 3], SINGLE, &Cancel::default()), [0, 0, 0]);
        assert!(weld(&mut Vec::new(), SINGLE, &Cancel::default()).is_empty());
    }
}
