//! Numbers as decimal text: exact in files, six significant digits in messages.

use std::fmt;

/// A number in the shortest form that reads back to the same bits, with an exponent where that is shorter.
#[derive(Clone, Copy, Debug)]
pub struct Shortest(pub f64);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-5..1e16).contains(&size) || !size.is_finite() {
            fmt::Display::fmt(&self.0, f)
        } else {
            fmt::LowerExp::fmt(&self.0, f)
        }
    }
}

/// A point of the plane or of space for messages, with six significant digits: `(0.25, -1.5e-8)`.
pub fn point_text<const N: usize>(p: impl Into<[f64; N]>) -> String {
    format!("({})", p.into().map(number).join(", "))
}

/// A number for messages, with six significant digits.
pub fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    if rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs()) {
        format!("{}", rounded + 0.0)
    } else {
        format!("{rounded:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};

    #[test]
    fn numbers_are_written_in_the_shortest_form_that_reads_back() {
        let shown = |x: f64| Shortest(x).to_string();
        assert_eq!([0.1, 2.0, 1e300, 2.5e-7, 0.0].map(shown), ["0.1", "2", "1e300", "2.5e-7", "0"]);
        for x in [1.0 / 3.0, f64::MIN_POSITIVE, f64::MAX, -5e-324, 1e16, 123_456_789.125] {
            assert_eq!(shown(x).parse::<f64>().unwrap().to_bits(), x.to_bits());
        }
    }

    #[test]
    fn points_are_written_with_six_digits() {
        assert_eq!(point_text(DVec2::new(0.1 + 0.2, -1.0)), "(0.3, -1)");
        assert_eq!(point_text(DVec2::new(-0.0, 1.234_567_89e-9)), "(0, 1.23457e-9)");
        assert_eq!(point_text(DVec3::new(1e300, 250.0, 1e-3)), "(1e300, 250, 0.001)");
    }
}
