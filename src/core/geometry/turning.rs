//! Curves keep their shape: how fast they turn limits the length of their chords, whatever the sizes are.

use glam::DVec3;

/// Limits on the division of curves, besides the metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeLimits {
    /// Largest distance of a chord from its arc, as a fraction of the radius.
    pub chord: f64,
    /// The least number of segments of a smooth closed curve.
    pub least_segments: u32,
    /// Limits by fields of sizes by curvature: chord, as above, and the smallest size that they ask for.
    pub by_fields: [f64; 2],
}

impl ShapeLimits {
    /// Where a case gives no chord.
    pub const CHORD: f64 = 0.1;
    /// Where a case gives no least number of segments.
    pub const LEAST_SEGMENTS: u32 = 8;
    /// No field.
    pub const NO_FIELD: [f64; 2] = [1.0, f64::INFINITY];
}

impl Default for ShapeLimits {
    fn default() -> Self {
        ShapeLimits { chord: Self::CHORD, least_segments: Self::LEAST_SEGMENTS, by_fields: Self::NO_FIELD }
    }
}

/// The smallest chord: below it, rounding would decide the angle.
const FINEST: f64 = 1e-12;

/// The limits of one curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Turning {
    /// Parameters, ascending, and the segments that the limit asks for there, for each unit of the parameter.
    table: Vec<(f64, f64)>,
    /// The least number of segments of the whole curve.
    pub least: u32,
}

impl Turning {
    /// The number of segments asked for at `t`, for each unit of the parameter.
    pub fn rate(&self, t: f64) -> f64 {
        let k = self.table.partition_point(|entry| entry.0 <= t).clamp(1, self.table.len() - 1);
        let [(from, a), (to, b)] = [self.table[k - 1], self.table[k]];
        a + (b - a) * ((t - from) / (to - from).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    }

    /// The number of segments asked for between two parameters.
    pub fn between(&self, from: f64, to: f64) -> f64 {
        let inner = self.table.iter().map(|entry| entry.0).filter(|&t| from < t && t < to);
        let places: Vec<f64> = [from].into_iter().chain(inner).chain([to]).collect();
        // The rate is linear between two entries.
        places.windows(2).map(|w| 0.5 * (w[1] - w[0]) * (self.rate(w[0]) + self.rate(w[1]))).sum()
    }

    /// The turning of a polyline along a curve between its `corners`, at which it may turn at once. `closed` curves go
    /// on at their start.
    pub(super) fn of(points: &[(f64, DVec3)], corners: &[f64], closed: bool, limits: &ShapeLimits) -> Option<Turning> {
        let n = points.len();
        if n < 3 {
            return None;
        }
        let along = |k: usize| (points[k + 1].1 - points[k].1).normalize_or_zero();
        // The rotation at each point, as a vector along its axis; where the curve does not turn smoothly, none.
        let rotation = |before: DVec3, after: DVec3| {
            let axis = before.cross(after);
            axis.normalize_or_zero() * libm::atan2(axis.length(), before.dot(after))
        };
        let is_corner = |t: f64| corners.contains(&t);
        let mut turns: Vec<DVec3> = vec![DVec3::ZERO; n];
        for k in 1..n - 1 {
            if !is_corner(points[k].0) {
                turns[k] = rotation(along(k - 1), along(k));
            }
        }
        if closed && corners.is_empty() {
            turns[0] = rotation(along(n - 2), along(0));
            turns[n - 1] = turns[0];
        }
        // Noise turns to and fro: the mean over neighbours cancels it.
        let smooth = |k: usize| {
            if turns[k] == DVec3::ZERO || k == 0 || k + 1 == n {
                return turns[k];
            }
            let [before, after] = [k - 1, k + 1].map(|other| {
                let goes_on = turns[other] != DVec3::ZERO;
                if goes_on { turns[other] } else { turns[k] }
            });
            0.25 * before + 0.5 * turns[k] + 0.25 * after
        };
        let angle = |chord: f64| 2.0 * libm::acos(1.0 - chord.clamp(FINEST, 1.0));
        let [chord, least] = limits.by_fields;
        let mut table = Vec::with_capacity(n);
        for k in 0..n {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(n - 1));
            let half = |a: usize, b: usize| 0.5 * (points[b].0 - points[a].0);
            let way = |a: usize, b: usize| 0.5 * points[a].1.distance(points[b].1);
            let (mut width, mut length) = (half(before, k) + half(k, after), way(before, k) + way(k, after));
            if k == 0 || k + 1 == n {
                // The other half of the turning at an end belongs to the other end.
                (width, length) = (2.0 * width, 2.0 * length);
            }
            let turn = smooth(k).length();
            let by_fields = (turn / angle(chord)).min(length / least);
            table.push((points[k].0, (turn / angle(limits.chord)).max(by_fields) / width.max(f64::MIN_POSITIVE)));
        }
        if !(closed && corners.is_empty()) {
            // The ends of an open curve turn as it does beside them.
            (table[0].1, table[n - 1].1) = (table[1].1, table[n - 2].1);
        }
        let turns_at_all = table.iter().any(|entry| entry.1 > 0.0);
        let least = if closed && corners.is_empty() && turns_at_all { limits.least_segments } else { 1 };
        turns_at_all.then_some(Turning { table, least })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle as a polyline.
    fn circle(n: u32, radius: f64) -> Vec<(f64, DVec3)> {
        let at = |k: u32| {
            let t = f64::from(k) / f64::from(n);
            let (sin, cos) = libm::sincos(t * std::f64::consts::TAU);
            (t, radius * DVec3::new(cos, sin, 0.0))
        };
        (0..=n).map(at).collect()
    }

    #[test]
    fn a_circle_asks_for_as_many_segments_as_its_chords_allow_whatever_its_radius() {
        for (chord, n) in [(0.1, 24), (0.1, 400), (0.01, 100)] {
            let limits = ShapeLimits { chord, ..ShapeLimits::default() };
            let turning = Turning::of(&circle(n, 3.0), &[], true, &limits).unwrap();
            // The distance of a chord over an angle a is r (1 - cos(a / 2)).
            let wanted = std::f64::consts::PI / libm::acos(1.0 - chord);
            assert!((turning.between(0.0, 1.0) / wanted - 1.0).abs() < 1e-9, "{chord} {n}");
            assert_eq!(turning.least, 8);
        }
    }

    #[test]
    fn straight_lines_and_noise_ask_for_nothing_and_fields_no_finer_than_their_least_size() {
        let line: Vec<_> = (0..9).map(|k| (f64::from(k) / 8.0, DVec3::X * f64::from(k))).collect();
        assert_eq!(Turning::of(&line, &[], false, &ShapeLimits::default()), None);
        let noisy: Vec<_> = line.iter().enumerate().map(|(k, (t, p))| (*t, *p + DVec3::Y * (k % 2) as f64)).collect();
        let turning = Turning::of(&noisy, &[], false, &ShapeLimits::default()).unwrap();
        assert!(turning.between(0.2, 0.8) < 1.0, "{}", turning.between(0.2, 0.8));
        let by_fields = [1e-6, 0.5];
        let limits = ShapeLimits { by_fields, ..ShapeLimits::default() };
        let turning = Turning::of(&circle(400, 1.0), &[], true, &limits).unwrap();
        assert!((turning.between(0.0, 1.0) / (std::f64::consts::TAU / 0.5) - 1.0).abs() < 1e-3);
    }
}
