//! Points at one place made one: for formats that say a mesh triangle by triangle (STL), or that give a point more than
//! once where its normal or texture differs (glTF).

use glam::DVec3;
use rustc_hash::FxHashMap;

/// For formats in single precision: some rounding errors of the largest coordinate.
pub const SINGLE: f64 = 4.0 * f32::EPSILON as f64;

/// Joins points that lie within `relative` times the largest coordinate of each other; the first of them stays, in the order
/// given. Returns the points that stay, and for each point given the place of the one that stands for it. A chain of points
/// is not drawn together: each is compared with the ones that stay.
pub fn weld(points: &[DVec3], relative: f64) -> (Vec<DVec3>, Vec<u32>) {
    let largest = points.iter().filter(|p| p.is_finite()).fold(0.0_f64, |l, p| l.max(p.abs().max_element()));
    let near = (relative * largest).max(f64::MIN_POSITIVE);
    // Cells much larger than the distance: a point seldom has to look beyond its own.
    let cell = 64.0 * near;
    let mut kept: Vec<DVec3> = Vec::new();
    let mut standing = Vec::with_capacity(points.len());
    // The last point of each cell, and for each point the one before it in its cell.
    let mut last: FxHashMap<[i64; 3], u32> = FxHashMap::default();
    let mut before: Vec<u32> = Vec::new();
    for &p in points {
        let key = |p: DVec3| (p / cell).floor().to_array().map(|x| x as i64);
        let (low, high) = (key(p - near), key(p + near));
        let mut found: Option<u32> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let mut at = last.get(&[x, y, z]).copied().unwrap_or(u32::MAX);
                    while at != u32::MAX {
                        if kept[at as usize].distance(p) <= near && found.is_none_or(|f| at < f) {
                            found = Some(at);
                        }
                        at = before[at as usize];
                    }
                }
            }
        }
        standing.push(found.unwrap_or_else(|| {
            let new = kept.len() as u32;
            kept.push(p);
            before.push(last.insert(key(p), new).unwrap_or(u32::MAX));
            new
        }));
    }
    (kept, standing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_within_rounding_become_the_first_of_them_and_others_stay_apart() {
        let near = 1000.0 * SINGLE;
        let p = DVec3::new(1000.0, -3.0, 0.5);
        let points = [p, DVec3::ZERO, p + DVec3::new(0.9 * near, 0.0, 0.0), p + DVec3::new(0.0, 1.1 * near, 0.0)];
        let (kept, standing) = weld(&points, SINGLE);
        assert_eq!(kept, [p, DVec3::ZERO, points[3]]);
        assert_eq!(standing, [0, 1, 0, 2]);
    }

    #[test]
    fn a_point_finds_its_like_across_the_border_of_a_cell() {
        let cell = 64.0 * SINGLE;
        for offset in [0.0, 1.0, -1.0, 7.0] {
            let border = DVec3::new(offset * cell, 0.0, 0.0);
            let points = [DVec3::ONE, border - 0.2 * SINGLE, border + 0.2 * SINGLE];
            assert_eq!(weld(&points, SINGLE).1, [0, 1, 1], "{offset}");
        }
    }

    #[test]
    fn points_all_at_zero_are_one_and_none_are_none() {
        assert_eq!(weld(&[DVec3::ZERO; 3], SINGLE).1, [0, 0, 0]);
        assert_eq!(weld(&[], SINGLE).0, []);
    }
}
