//! How a place in the plane is told to a person.

use glam::DVec2;

/// A point as messages show it, to six significant digits: `(0.25, -1.5e-8)`.
pub fn told(p: DVec2) -> String {
    format!("({}, {})", number(p.x), number(p.y))
}

/// A number as messages show it, to six significant digits.
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

    #[test]
    fn places_are_told_with_six_digits() {
        assert_eq!(told(DVec2::new(0.1 + 0.2, -1.0)), "(0.3, -1)");
        assert_eq!(told(DVec2::new(-0.0, 1.234_567_89e-9)), "(0, 1.23457e-9)");
        assert_eq!(told(DVec2::new(1e300, 250.0)), "(1e300, 250)");
    }
}
