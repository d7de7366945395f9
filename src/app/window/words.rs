//! Names, numbers and events in words, as everywhere in the window: integers grouped by thin spaces, a true minus, an
//! en dash for what is not defined.

use super::session::words_of;
use super::state::Progress;
use crate::core::convert::EventKind;
use crate::core::progress::Stage;
use crate::render::scene::Outlined;

pub use crate::core::kernel::number::{UNDEFINED, counted, decimals, degrees, fixed, grouped, size};
pub use crate::core::run::explain::{capital, edge, event, segment, why_rolled_back as why};

/// The progress of some work.
pub fn progress(progress: &Progress) -> String {
    let Progress { words, done, total } = *progress;
    // These stages count bytes, or steps of unequal length.
    if total > 0 && [Stage::Read, Stage::Repair].map(words_of).contains(&words) {
        format!("{words}: {} %", 100 * done.min(total) / total)
    } else if total > 0 {
        format!("{words} {} of about {}", grouped(done), grouped(total.max(done)))
    } else {
        words.to_owned()
    }
}

/// The name of something that can be selected.
pub fn thing(what: Outlined) -> String {
    match what {
        Outlined::Node(node) => format!("node {}", node.0),
        Outlined::Edge(ends) => format!("edge {}", edge(ends)),
        Outlined::Element(element) => format!("element {}", element.0),
    }
}

/// The name of a kind of event.
pub fn kind(kind: EventKind) -> String {
    kind.name().replace('_', " ")
}

/// Names in plain text as the paper writes them, with the markup of [`super::theme::formula`]: theta_rect becomes
/// \u{3b8} with a subscript.
pub fn symbols(text: &str) -> String {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| word(c) != word(first)).unwrap_or(rest.len());
        let (token, after) = rest.split_at(end);
        out += &symbol(token);
        rest = after;
    }
    out
}

/// A word as the paper writes it.
fn symbol(word: &str) -> String {
    let greek = [("theta", "\u{3b8}"), ("lambda", "\u{3bb}"), ("eps", "\u{3b5}"), ("h", "h"), ("H", "H")];
    match word {
        "sqrt" => return "\u{221a}".to_owned(),
        "Hmin" => return "H_{min}".to_owned(),
        "eps1" => return "\u{3b5}_{1}".to_owned(),
        "eps2" => return "\u{3b5}_{2}".to_owned(),
        // A parameter, which is written so.
        "h_min_over" => return word.to_owned(),
        _ => {}
    }
    let parts = word.split_once('_').filter(|parts| !parts.1.contains('_'));
    let known = parts.and_then(|(name, low)| Some((greek.iter().find(|greek| greek.0 == name)?.1, low)));
    known.map_or_else(|| word.to_owned(), |(letter, low)| format!("{letter}_{{{low}}}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_symbols_and_parameters_stay() {
        assert_eq!(symbols("below theta_rect = 135, sqrt(lambda_A)"), "below θ_{rect} = 135, √(λ_{A})");
        assert_eq!(symbols("top_smoothing, h_min_over; Hmin, eps1"), "top_smoothing, h_min_over; H_{min}, ε_{1}");
        assert_eq!(symbols(""), "");
    }

    #[test]
    fn numbers_are_grouped_and_have_true_minus_signs() {
        assert_eq!(grouped(7), "7");
        assert_eq!(grouped(1267), "1\u{2009}267");
        assert_eq!(grouped(1_234_567), "1\u{2009}234\u{2009}567");
        assert_eq!(fixed(-45.04, 1), "−45.0");
        assert_eq!(fixed(-0.01, 1), "0.0");
        assert_eq!(fixed(f64::NAN, 2), "–");
    }

    #[test]
    fn sizes_have_three_digits_and_powers_only_where_they_must() {
        assert_eq!(size(0.022_43), "0.0224");
        assert_eq!(size(0.3978), "0.3978");
        assert_eq!(size(12.345), "12.35");
        assert_eq!(size(-1.5e-6), "−1.50e−6");
        assert_eq!(decimals([0.0224, 0.1, 3.0].into_iter()), 4);
        assert_eq!(decimals([12.0, 150.0].into_iter()), 1);
        assert_eq!(decimals(std::iter::empty()), 4);
    }
}
