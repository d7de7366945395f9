//! Mirror lines of the plane, and reflection in them without rounding (docs/algorithm.md, "Symmetry").

use glam::DVec2;

use crate::core::kernel::worded::worded;
use crate::core::kernel::{Metric2, Metric3};

/// A double holds the multiples of a power of two up to this many times it.
const MULTIPLES: f64 = (1_u64 << 53) as f64;
/// A sum of two ends that is this near, in units of the last place, to a number of at most 27 digits is that number:
/// the ends of computed curves are rounded.
const NEARLY: f64 = 8.0;

worded! {
    /// An axis of the plane: along it, a mirror image has the other direction.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Axis by word {
        /// The first coordinate.
        X = "x",
        /// The second one.
        Y = "y",
    }
}

impl Axis {
    /// The coordinate of a point along it.
    #[inline]
    pub fn along(self, p: DVec2) -> f64 {
        match self {
            Axis::X => p.x,
            Axis::Y => p.y,
        }
    }

    /// The other coordinate of a point.
    #[inline]
    pub fn across(self, p: DVec2) -> f64 {
        match self {
            Axis::X => p.y,
            Axis::Y => p.x,
        }
    }

    /// The point with these coordinates along it and across.
    #[inline]
    pub fn point(self, along: f64, across: f64) -> DVec2 {
        match self {
            Axis::X => DVec2::new(along, across),
            Axis::Y => DVec2::new(across, along),
        }
    }
}

/// What the sides on the mirror line become when the image of a half is joined to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// Inner edges.
    Glued,
    /// Borders between two faces, or repeated lines: both sides have nodes of their own at the same points.
    Shared,
    /// The two sides of a crack.
    Open,
}

/// The line in which a domain is its own mirror image, perpendicular to an axis, and the half that is converted.
///
/// A coordinate `x` along the axis and its image add up to `sum` exactly: all are multiples of `unit`, and no larger
/// than what a double holds as such.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    axis: Axis,
    sum: f64,
    /// A power of two.
    unit: f64,
    /// 1 where the half with the greater coordinates is converted, otherwise -1.
    kept: f64,
}

impl Mirror {
    /// The line in the middle of a domain that reaches along the axis from `low` to `high`. The half that is converted
    /// is the one with the larger absolute values: they have the fewest places to be rounded to.
    pub fn between(axis: Axis, low: f64, high: f64) -> Mirror {
        let largest = low.abs().max(high.abs()).max(f64::MIN_POSITIVE);
        let power = libm::ilogb(largest);
        let unit = libm::ldexp(1.0, if largest == libm::ldexp(1.0, power) { power - 53 } else { power - 52 });
        let given = low + high;
        let coarse = unit * f64::from(1 << 26);
        let plain = (given / coarse).round() * coarse;
        let sum = if (plain - given).abs() <= NEARLY * unit { plain } else { given };
        let kept = if high.abs() >= low.abs() { 1.0 } else { -1.0 };
        // Adding zero turns -0 into 0.
        Mirror { axis, sum: (sum / unit).round() * unit + 0.0, unit, kept }
    }

    /// The axis to which it is perpendicular.
    pub fn axis(&self) -> Axis {
        self.axis
    }

    /// The coordinate of the line along the axis.
    pub fn position(&self) -> f64 {
        0.5 * self.sum
    }

    /// Whether the half with the greater coordinates is converted.
    pub fn keeps_upper(&self) -> bool {
        self.kept > 0.0
    }

    /// The distance of a point from the line, positive in the half that is converted.
    #[inline]
    pub fn offset(&self, p: DVec2) -> f64 {
        self.kept * (self.axis.along(p) - self.position())
    }

    /// Whether a point lies exactly on the line.
    #[inline]
    pub fn holds(&self, p: DVec2) -> bool {
        self.axis.along(p) == self.position()
    }

    /// The point of the line nearest to a point.
    pub fn foot(&self, p: DVec2) -> DVec2 {
        self.axis.point(self.position(), self.axis.across(p))
    }

    /// The mirror image of a point: exact where the point is [`rounded`](Mirror::rounded).
    #[inline]
    pub fn image(&self, p: DVec2) -> DVec2 {
        self.axis.point(self.sum - self.axis.along(p), self.axis.across(p))
    }

    /// The mirror image of a direction.
    pub fn image_of_direction(&self, d: DVec2) -> DVec2 {
        self.axis.point(-self.axis.along(d), self.axis.across(d))
    }

    /// A point moved by at most half a last place of the largest coordinate, to where its image is exact. On the line
    /// x = 0 that is every point.
    pub fn rounded(&self, p: DVec2) -> DVec2 {
        if self.sum == 0.0 || self.holds(p) {
            return p;
        }
        let most = MULTIPLES * self.unit;
        let multiple = (self.axis.along(p) / self.unit).round() * self.unit;
        let along = multiple.clamp((self.sum - most).max(-most), (self.sum + most).min(most));
        self.axis.point(along, self.axis.across(p))
    }

    /// The metric at the image of a point, from the one there.
    #[inline]
    pub fn image_of_metric(&self, m: &Metric2) -> Metric2 {
        Metric2 { uv: 0.0 - m.uv, ..*m }
    }

    /// The same in space, where the mirror is the plane of the line and of z.
    pub fn image_of_metric3(&self, m: &Metric3) -> Metric3 {
        match self.axis {
            Axis::X => Metric3 { xy: 0.0 - m.xy, xz: 0.0 - m.xz, ..*m },
            Axis::Y => Metric3 { xy: 0.0 - m.xy, yz: 0.0 - m.yz, ..*m },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether two doubles add up to a third exactly: the error of their rounded sum is computed without error (Knuth).
    fn add_up(a: f64, b: f64, sum: f64) -> bool {
        let s = a + b;
        let part = s - a;
        s == sum && (a - (s - part)) + (b - part) == 0.0
    }

    #[test]
    fn points_and_their_images_add_up_to_the_last_bit_wherever_the_line_lies() {
        for (low, high) in
            [(-1.0, 1.0), (0.0, 1.0), (0.0, 0.3), (0.1, 0.7), (-3.0, 0.1), (1e9, 1e9 + 3.7), (-7e-9, 2e-8)]
        {
            let mirror = Mirror::between(Axis::X, low, high);
            assert!((mirror.position() - 0.5 * (low + high)).abs() <= 1e-15 * (low.abs() + high.abs()));
            for i in 0..1000 {
                let x = low + (high - low) * f64::from(i) / 999.0;
                let p = mirror.rounded(DVec2::new(x, 0.3));
                let q = mirror.image(p);
                assert!(add_up(p.x, q.x, 2.0 * mirror.position()), "{low} to {high}: {} and {}", p.x, q.x);
                assert_eq!((mirror.image(q), p.y, mirror.rounded(p)), (p, 0.3, p));
                assert!((p.x - x).abs() <= 2.0_f64.recip() * f64::EPSILON * low.abs().max(high.abs()));
            }
            assert!(mirror.holds(mirror.foot(DVec2::new(low, 5.0))));
        }
    }

    #[test]
    fn ends_that_rounding_has_moved_have_a_plain_middle() {
        let mirror = Mirror::between(Axis::Y, 0.3, 0.7_f64.next_up());
        assert_eq!((mirror.position(), mirror.axis().word()), (0.5, "y"));
        assert_eq!(Mirror::between(Axis::X, -1.0, 1.0_f64.next_down()).position(), 0.0);
        // Exact ends keep their own middle.
        assert_eq!(Mirror::between(Axis::X, 0.0, 0.3).position(), 0.15);
    }

    #[test]
    fn the_half_with_the_larger_coordinates_is_kept() {
        assert!(Mirror::between(Axis::X, 0.0, 1.0).keeps_upper());
        let left = Mirror::between(Axis::X, -3.0, 1.0);
        assert!(!left.keeps_upper() && left.offset(DVec2::new(-2.0, 0.0)) == 1.0);
    }
}
