//! The precision of a file, by its coordinates alone: whatever the format, they are numbers of single precision, or
//! were written with so many digits.

use glam::DVec3;

/// Numbers with more significant digits have those of double precision, and of fewer a person may have written each
/// digit on purpose.
const DIGITS: std::ops::RangeInclusive<i32> = 5..=15;

/// The unit in the last place of the largest coordinate: by single precision, if all are such numbers and not short
/// ones, or else by the most significant digits that a coordinate has. 0 for double precision, few digits, and without
/// coordinates.
pub fn quantum(points: impl Iterator<Item = DVec3> + Clone) -> f64 {
    let coordinates = || points.clone().flat_map(|p| p.to_array());
    let largest = coordinates().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return 0.0;
    }
    let mut most = 0;
    for x in coordinates() {
        most = most.max(digits(x));
        if most > *DIGITS.end() {
            let is_single = coordinates().all(|x| f64::from(x as f32) == x);
            return if is_single { f64::from(f32::EPSILON) * largest } else { 0.0 };
        }
    }
    if !DIGITS.contains(&most) {
        return 0.0;
    }
    let exponent = libm::floor(libm::log10(largest)) as i32;
    libm::pow(10.0, f64::from(exponent + 1 - most))
}

/// The significant digits of the shortest text that gives the number: as many as were written, or fewer.
fn digits(x: f64) -> i32 {
    let text = format!("{:e}", x.abs());
    text.bytes().take_while(|&byte| byte != b'e').filter(u8::is_ascii_digit).count() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(xs: &[f64]) -> f64 {
        quantum(xs.iter().map(|&x| DVec3::new(x, 0.0, 0.0)))
    }

    #[test]
    fn the_precision_is_that_of_the_digits_or_of_single_precision() {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(near(of(&[1.000_001, 0.5]), 1e-6));
        // Nine digits: small numbers have more decimals, which the largest one does not have.
        assert!(near(of(&[-0.022_507_723_9, 12.345_678_9]), 1e-7));
        let thirds = f64::from(1.0_f32 / 3.0);
        assert!(near(of(&[thirds, 8.0]), 8.0 * f64::from(f32::EPSILON)));
        assert_eq!([of(&[1.0 / 3.0, thirds]), of(&[250.0, 0.25]), of(&[0.0]), of(&[])], [0.0; 4]);
    }
}
