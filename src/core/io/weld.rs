//! Points at one place made one: for formats that say a mesh triangle by triangle (STL), or that give a point more than
//! once where its normal or texture differs (glTF).

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::core::progress::Cancel;

/// For formats in single precision: some rounding errors of the largest coordinate.
pub const SINGLE: f64 = 4.0 * f32::EPSILON as f64;

/// So many points are welded between two looks at whether to go on.
const AT_A_TIME: usize = 1 << 14;

/// Joins points that lie within some distance of each other; the first of them stays. A chain of points is not drawn together: each is
/// compared with the ones that stay.
pub struct Welder {
    near: f64,
    /// Side of the cells that points are found by: larger than the distance, so that a point seldom has to look beyond its own, but no
    /// more than a few hundred points that stay have room in one.
    cell: f64,
    kept: Vec<DVec3>,
    /// The last point of each cell, and for each point the one before it in its cell.
    last: FxHashMap<[i64; 3], u32>,
    before: Vec<u32>,
}

impl Welder {
    /// A welder within `relative` times the largest coordinate, whichever sign it has.
    pub fn new(relative: f64, largest: f64) -> Welder {
        let near = (relative * largest).max(f64::MIN_POSITIVE);
        Welder { near, cell: 8.0 * near, kept: Vec::new(), last: FxHashMap::default(), before: Vec::new() }
    }

    /// The place of the point that stands for `p` among those that stay: an earlier one, or itself.
    pub fn weld(&mut self, p: DVec3) -> u32 {
        let key = |p: DVec3| (p / self.cell).floor().to_array().map(|x| x as i64);
        let (low, high) = (key(p - self.near), key(p + self.near));
        let mut found: Option<u32> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let mut at = self.last.get(&[x, y, z]).copied().unwrap_or(u32::MAX);
                    while at != u32::MAX {
                        if self.kept[at as usize].distance(p) <= self.near && found.is_none_or(|f| at < f) {
                            found = Some(at);
                        }
                        at = self.before[at as usize];
                    }
                }
            }
        }
        if let Some(found) = found {
            return found;
        }
        let (new, key) = (self.kept.len() as u32, key(p));
        self.kept.push(p);
        self.before.push(self.last.insert(key, new).unwrap_or(u32::MAX));
        new
    }

    /// The points that stay.
    pub fn points(self) -> Vec<DVec3> {
        self.kept
    }
}

/// Joins points within `relative` times the largest coordinate. Returns the points that stay, and for each point given the place
/// of the one that stands for it. Told to end, it
/// returns nothing.
pub fn weld(points: &[DVec3], relative: f64, cancel: &Cancel) -> (Vec<DVec3>, Vec<u32>) {
    let mut welder = Welder::new(relative, points.iter().fold(0.0, |largest, p| p.abs().max_element().max(largest)));
    let mut standing = Vec::with_capacity(points.len());
    for part in points.chunks(AT_A_TIME) {
        if cancel.is_asked() {
            return (Vec::new(), Vec::new());
        }
        standing.extend(part.iter().map(|&p| welder.weld(p)));
    }
    (welder.points(), standing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_within_rounding_become_the_first_of_them_and_others_stay_apart() {
        let near = 1000.0 * SINGLE;
        let p = DVec3::new(1000.0, -3.0, 0.5);
        let points = [p, DVec3::ZERO, p + DVec3::new(0.9 * near, 0.0, 0.0), p + DVec3::new(0.0, 1.1 * near, 0.0)];
        let (kept, standing) = weld(&points, SINGLE, &Cancel::default());
        assert_eq!(kept, [p, DVec3::ZERO, points[3]]);
        assert_eq!(standing, [0, 1, 0, 2]);
    }

    #[test]
    fn a_point_finds_its_like_across_the_border_of_a_cell() {
        let cell = 8.0 * SINGLE;
        for offset in [0.0, 1.0, -1.0, 7.0] {
            let border = DVec3::new(offset * cell, 0.0, 0.0);
            let points = [DVec3::ONE, border - 0.2 * SINGLE, border + 0.2 * SINGLE];
            assert_eq!(weld(&points, SINGLE, &Cancel::default()).1, [0, 1, 1], "{offset}");
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
        assert_eq!(weld(&points, SINGLE, &Cancel::default()).0.len(), points.len());
    }

    #[test]
    fn points_all_at_zero_are_one_and_none_are_none() {
        assert_eq!(weld(&[DVec3::ZERO; 3], SINGLE, &Cancel::default()).1, [0, 0, 0]);
        assert_eq!(weld(&[], SINGLE, &Cancel::default()).0, []);
    }
}
