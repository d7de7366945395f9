//! Words and numbers that several explanations share.

use crate::core::case::Parameters;
use crate::core::kernel::number::{degrees, fixed, size};
use crate::core::mesh::NodeId;

/// A sentence without its markup: `H_{min}` becomes `Hmin`.
pub fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, (low, after))) =
        rest.split_once("_{").and_then(|(before, after)| Some((before, after.split_once('}')?)))
    {
        plain += before;
        plain += low;
        rest = after;
    }
    plain + rest
}

/// A front segment by its nodes.
pub fn segment([a, b]: [NodeId; 2]) -> String {
    format!("{} \u{2192} {}", a.0, b.0)
}

/// An edge by its nodes.
pub fn edge([a, b]: [NodeId; 2]) -> String {
    format!("{}\u{2013}{}", a.0, b.0)
}

/// As many of something as there are.
pub(super) fn count(n: usize, one: &str) -> String {
    match n {
        0 => format!("no {one}"),
        1 => format!("1 {one}"),
        _ => format!("{n} {one}s"),
    }
}

/// Two sizes that differ, with as many digits as it takes to see it.
pub fn apart(x: f64, y: f64) -> [String; 2] {
    longer([x, y], [x, y].map(size), 5)
}

/// The same for angles in radians, written in degrees without the degree sign.
pub fn angles_apart(x: f64, y: f64) -> [String; 2] {
    longer([x, y].map(f64::to_degrees), [x, y].map(degrees), 2)
}

fn longer(values: [f64; 2], short: [String; 2], first: usize) -> [String; 2] {
    if short[0] != short[1] || values[0] == values[1] {
        return short;
    }
    let mut texts = (first..16).map(|decimals| values.map(|value| fixed(value, decimals)));
    texts.find(|texts| texts[0] != texts[1]).unwrap_or(short)
}

/// That one number is smaller than another, from their texts: those of numbers that differ by rounding only are equal.
pub(super) fn smaller([less, more]: [String; 2]) -> String {
    if less == more { format!("both are {less} but for rounding") } else { format!("{less} < {more}") }
}

/// An interval of c, which is positive; its lower end is excluded.
pub(super) fn range_of_c(low: f64, high: f64) -> String {
    match (low > 0.0, high.is_finite()) {
        (true, true) => format!("{} < c \u{2264} {}", up(low, 3), down(high, 3)),
        (true, false) => format!("c > {}", up(low, 3)),
        (false, true) => format!("c \u{2264} {}", down(high, 3)),
        (false, false) => "every c".to_owned(),
    }
}

/// A lower bound with this many decimals, rounded inwards, so that it stays true.
pub(super) fn up(x: f64, decimals: i32) -> String {
    let scale = libm::pow(10.0, f64::from(decimals));
    fixed((x * scale - 1e-9).ceil() / scale, decimals as usize)
}

/// The same for an upper bound.
pub(super) fn down(x: f64, decimals: i32) -> String {
    let scale = libm::pow(10.0, f64::from(decimals));
    fixed((x * scale + 1e-9).floor() / scale, decimals as usize)
}

/// The text with its first letter in upper case.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// A parameter with its value, as a case has it.
pub(super) fn value(parameters: &Parameters, key: &str) -> String {
    format!("{key} = {}", parameters.text_of(key).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_inwards() {
        assert_eq!((up(1.0104, 3), down(1.0109, 3)), ("1.011".to_owned(), "1.010".to_owned()));
        assert_eq!((up(92.5, 1), down(154.99, 1)), ("92.5".to_owned(), "154.9".to_owned()));
    }

    #[test]
    fn two_sizes_that_differ_are_told_apart() {
        assert_eq!(apart(0.5, 0.25), ["0.5000", "0.2500"]);
        assert_eq!(apart(0.022_500_1, 0.022_5), ["0.0225001", "0.0225000"]);
        assert_eq!(apart(0.5, 0.5), ["0.5000", "0.5000"]);
        assert_eq!(smaller(apart(0.25, 0.5)), "0.2500 < 0.5000");
        assert_eq!(smaller(apart(0.3, 0.1 + 0.2)), "both are 0.3000 but for rounding");
        assert_eq!(angles_apart(134.99_f64.to_radians(), 135_f64.to_radians()), ["134.99", "135.00"]);
    }

    #[test]
    fn plain_text_has_no_markup() {
        assert_eq!(plain("c\u{b7}H_{min} and \u{3b8}_{rect}, x_{"), "c\u{b7}Hmin and \u{3b8}rect, x_{");
    }
}
