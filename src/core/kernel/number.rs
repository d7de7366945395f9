//! Numbers for explanations, figures and the window: integers grouped by thin spaces, a true minus sign, an en dash for
//! undefined values.

/// The text of an undefined number.
pub const UNDEFINED: &str = "–";
const THIN_SPACE: char = '\u{2009}';
const MINUS: char = '\u{2212}';

/// An integer, grouped by thin spaces.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3 * 3);
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(THIN_SPACE);
        }
        text.push(digit);
    }
    text
}

/// So many of something: `1 node`, `1 234 nodes`.
pub fn counted(n: u64, one: &str) -> String {
    format!("{} {one}{}", grouped(n), if n == 1 { "" } else { "s" })
}

/// A number with this many decimals.
pub fn fixed(x: f64, decimals: usize) -> String {
    if !x.is_finite() {
        return UNDEFINED.to_owned();
    }
    let text = format!("{x:.decimals$}");
    let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if zero { text.replace('-', "") } else { text.replace('-', &MINUS.to_string()) }
}

/// An angle given in radians, written in degrees without the degree sign.
pub fn degrees(radians: f64) -> String {
    fixed(radians.to_degrees(), 1)
}

/// A size or coordinate: at least three significant digits, four decimals where that is enough, powers of ten only
/// where necessary.
pub fn size(x: f64) -> String {
    if !x.is_finite() || x == 0.0 {
        return if x == 0.0 { "0".to_owned() } else { UNDEFINED.to_owned() };
    }
    let magnitude = x.abs();
    if !(1e-4..1e5).contains(&magnitude) {
        return format!("{x:.2e}").replace('-', &MINUS.to_string());
    }
    let decimals = 1 + [100.0, 10.0, 1.0, 0.01].iter().filter(|&&limit| magnitude < limit).count();
    fixed(x, decimals)
}

/// The number of decimals with which the smallest of some sizes has three digits, for a whole column.
pub fn decimals(values: impl Iterator<Item = f64>) -> usize {
    let least = values.map(f64::abs).filter(|v| *v > 0.0 && v.is_finite()).fold(f64::INFINITY, f64::min);
    if least.is_finite() { (2 - libm::floor(libm::log10(least)) as i32).clamp(0, 6) as usize } else { 4 }
}
