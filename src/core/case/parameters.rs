//! The parameters of a conversion: thresholds of the paper and limits. Radians here, degrees in files, on the command
//! line and in [`Parameters::text_of`].

use std::fmt::Display;
use std::str::FromStr;

use super::rules::{
    CleanUpBy, DivisionAt, EnhancementOrder, FirstRescue, HMinOver, Selection, SelectionWindow, SmoothingWeights,
};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::spelling::nearest;

/// All settings besides geometry and metric. Angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    /// Factor for all target sizes.
    pub size_scale: f64,
    /// The selection factor c of section 4.3.3: 1.5 to 2.0 in the paper, which used 2.0. So large that every segment is
    /// within reach, the classes of table 1 alone decide.
    pub c: f64,
    /// Below this frontal angle the neighbouring front segment is the side edge (section 4.3.4, ii); table 1 makes its
    /// classes by it.
    pub theta_rect: f64,
    /// At or below this frontal angle a front corner is closed by a seam (section 4.3.6).
    pub theta_seam: f64,
    /// Where segments are short, corners are closed by seams up to `theta_seam` times this (docs/algorithm.md,
    /// "Seaming"); 1, as in the paper, widens nothing.
    pub seam_widening: f64,
    /// Above this frontal angle a corner is a reversal (fig. 12).
    pub theta_revr: f64,
    /// A live side edge longer than this times the base is split (section 4.3.4, vi).
    pub side_split: f64,
    /// A side edge shorter than this in the metric stays whole: its halves would be less than half a unit long
    /// (docs/algorithm.md, "Sides over 1.5 l_AB"). The paper divides it.
    pub whole_below: f64,
    /// Largest deviation of a side edge from its target direction (eq. 8).
    pub side_deviation: f64,
    /// Metric area below which the front is split at a triangle (section 4.3.6, ii b).
    pub eps1: f64,
    /// Metric width over height above which the front is split at a triangle (section 4.3.6, ii c).
    pub eps2: f64,
    /// Number of rows offset from the boundary first (0: none).
    pub layers: u32,
    /// Curves on whose loops rows are offset; empty for all loops. Belongs to the case: later changes have no effect.
    pub layered_loops: Vec<String>,
    /// Faces to convert; empty for all. Belongs to the case: later changes have no effect.
    pub faces: Vec<String>,
    /// Selection of base segments.
    pub selection: Selection,
    /// What is compared with `c` times the smallest H-value.
    pub selection_window: SelectionWindow,
    /// Over which segments the smallest H-value is taken.
    pub h_min_over: HMinOver,
    /// Aim a side edge at the bisector of a frontal angle up to 225 degrees, and at the right angle beyond; off: always
    /// at the right angle (4.3.4, iii).
    pub bisector: bool,
    /// Place the new top nodes of each quadrilateral, and the nodes of rows at walls (docs/algorithm.md, "Placement of
    /// new top nodes", "Rows at walls"); off: the paper's eq. (9) on front nodes.
    pub placement: bool,
    /// Where a side edge is divided.
    pub division_at: DivisionAt,
    /// What is tried first when a quadrilateral cannot be formed.
    pub first_rescue: FirstRescue,
    /// Smooth around the left top after each swap for the top edge (4.3.4, top edge v).
    pub top_smoothing: bool,
    /// Smooth around each new quadrilateral (4.3.6).
    pub smoothing: bool,
    /// Smooth also the nodes that only dead elements join to the new quadrilateral: the second of the paper's three
    /// groups (4.3.6).
    pub smooth_joined: bool,
    /// The weights of the smoothing.
    pub smoothing_weights: SmoothingWeights,
    /// Local structural enhancement (4.3.6).
    pub enhancement: bool,
    /// The order of its operations.
    pub enhancement_order: EnhancementOrder,
    /// Seam small frontal angles (4.3.6).
    pub seaming: bool,
    /// Split the front at slender elements (4.3.6).
    pub splitting: bool,
    /// Clean-up and smoothing of the whole mesh at the end (4.3.7).
    pub post_processing: bool,
    /// How that cleans up the structure.
    pub clean_up: CleanUpBy,
    /// A mesh that would need more quadrilaterals is rejected before memory is allocated for it.
    pub max_quads: u64,
}

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            size_scale: 1.0,
            c: 2.0,
            theta_rect: 135_f64.to_radians(),
            theta_seam: 30_f64.to_radians(),
            seam_widening: 3.0,
            theta_revr: 225_f64.to_radians(),
            side_split: 1.5,
            whole_below: 1.0,
            side_deviation: 30_f64.to_radians(),
            eps1: 0.1,
            eps2: 5.0,
            layers: 0,
            layered_loops: Vec::new(),
            faces: Vec::new(),
            selection: Selection::Table1,
            selection_window: SelectionWindow::MetricLengthTimesH,
            h_min_over: HMinOver::Front,
            bisector: false,
            placement: true,
            division_at: DivisionAt::Midpoint,
            first_rescue: FirstRescue::LeftNeighbour,
            top_smoothing: true,
            smoothing: true,
            smooth_joined: true,
            smoothing_weights: SmoothingWeights::Printed,
            enhancement: true,
            enhancement_order: EnhancementOrder::DeleteFirst,
            seaming: true,
            splitting: true,
            post_processing: true,
            clean_up: CleanUpBy::Search,
            max_quads: 20_000_000,
        }
    }
}

impl Parameters {
    /// The paper as printed: the defaults but for the rules of ours that are better (docs/algorithm.md, "Departures
    /// from the paper").
    pub fn paper() -> Parameters {
        Parameters {
            selection_window: SelectionWindow::PhysicalLength,
            whole_below: 0.0,
            seam_widening: 1.0,
            placement: false,
            clean_up: CleanUpBy::Traditional,
            ..Parameters::default()
        }
    }

    /// The paper's reading with the size, limit, offset rows and faces of these parameters, which belong to the case.
    #[must_use]
    pub fn read_as_paper(&self) -> Parameters {
        self.with_rules_of(Parameters::paper())
    }

    /// The rules and values of `other` with the size, limit, offset rows and faces of these parameters, which belong to
    /// the case.
    #[must_use]
    pub fn with_rules_of(&self, other: Parameters) -> Parameters {
        Parameters {
            size_scale: self.size_scale,
            layers: self.layers,
            layered_loops: self.layered_loops.clone(),
            faces: self.faces.clone(),
            max_quads: self.max_quads,
            ..other
        }
    }

    /// Sets one parameter from its text in a file or in `--set KEY=VALUE` (angles in degrees). Rejects a number in
    /// quotes: files pass strings with their quotes.
    ///
    /// # Errors
    /// An unknown key (with the nearest known one), or a value of the wrong type or out of range. Nothing is changed.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Fault> {
        self.take(key, value).map_err(|fault| fault.of_kind(FaultKind::Parameter))
    }
}

/// The values that a parameter takes.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterKind {
    /// A number between two limits.
    Number([f64; 2]),
    /// An angle between two limits, in degrees.
    Angle([f64; 2]),
    /// A whole number between two limits.
    Count([f64; 2]),
    /// One of these words.
    Word(Vec<&'static str>),
    /// True or false.
    Flag,
    /// A list of names.
    Names,
}

impl ParameterKind {
    /// The limits of a number, an angle (in degrees) or a whole number.
    pub fn limits(&self) -> Option<[f64; 2]> {
        match *self {
            ParameterKind::Number(limits) | ParameterKind::Angle(limits) | ParameterKind::Count(limits) => Some(limits),
            _ => None,
        }
    }
}

/// The [`ParameterKind`] of a reader with its limits.
macro_rules! kind {
    (number($least:expr, $most:expr)) => {
        ParameterKind::Number([$least, $most])
    };
    (angle($least:expr, $most:expr, $usual:expr)) => {
        ParameterKind::Angle([$least, $most])
    };
    (count($least:expr, $most:expr)) => {
        ParameterKind::Count([$least, $most].map(f64::from))
    };
    (word($all:expr, $word:expr)) => {
        ParameterKind::Word($all.iter().map(|&one| $word(one)).collect())
    };
    (flag()) => {
        ParameterKind::Flag
    };
    (names($separator:expr)) => {
        ParameterKind::Names
    };
}

/// Reads and writes each parameter by a row `key = reader(limits), |value| text`.
macro_rules! parameters {
    ($($key:ident = $read:ident($($limit:expr),*), |$value:ident| $text:expr;)*) => {
        impl Parameters {
            /// The keys in files and for `--set`, in the documented order.
            pub const KEYS: [&'static str; [$(stringify!($key)),*].len()] = [$(stringify!($key)),*];

            fn take(&mut self, key: &str, value: &str) -> Result<(), Fault> {
                let value = value.trim();
                match key {
                    $(stringify!($key) => self.$key = $read(key, value, $($limit),*)?,)*
                    _ => return Err(unknown_key(key, &Self::KEYS)),
                }
                Ok(())
            }

            /// The value of a parameter as text for [`Parameters::set`]; `None` for an unknown key.
            pub fn text_of(&self, key: &str) -> Option<String> {
                match key {
                    $(stringify!($key) => { let $value = &self.$key; Some($text) })*
                    _ => None,
                }
            }

            /// The values that a parameter takes; `None` for an unknown key.
            pub fn kind_of(key: &str) -> Option<ParameterKind> {
                match key {
                    $(stringify!($key) => Some(kind!($read($($limit),*))),)*
                    _ => None,
                }
            }
        }
    };
}

parameters! {
    size_scale = number(1e-9, 1e9), |value| value.to_string();
    c = number(0.5, 1000.0), |value| value.to_string();
    theta_rect = angle(90.0, 180.0, 135.0), |value| degrees(*value);
    theta_seam = angle(0.0, 90.0, 30.0), |value| degrees(*value);
    seam_widening = number(1.0, 3.0), |value| value.to_string();
    theta_revr = angle(180.0, 360.0, 225.0), |value| degrees(*value);
    side_split = number(1.0, 10.0), |value| value.to_string();
    whole_below = number(0.0, 2.0), |value| value.to_string();
    side_deviation = angle(0.0, 90.0, 30.0), |value| degrees(*value);
    eps1 = number(0.0, 1.0), |value| value.to_string();
    eps2 = number(1.0, 1000.0), |value| value.to_string();
    layers = count(0, 1000), |value| value.to_string();
    layered_loops = names(','), |value| value.join(", ");
    faces = names(';'), |value| value.join("; ");
    selection = word(&Selection::ALL, Selection::word), |value| value.word().to_owned();
    selection_window = word(&SelectionWindow::ALL, SelectionWindow::word), |value| value.word().to_owned();
    h_min_over = word(&HMinOver::ALL, HMinOver::word), |value| value.word().to_owned();
    bisector = flag(), |value| value.to_string();
    placement = flag(), |value| value.to_string();
    division_at = word(&DivisionAt::ALL, DivisionAt::word), |value| value.word().to_owned();
    first_rescue = word(&FirstRescue::ALL, FirstRescue::word), |value| value.word().to_owned();
    top_smoothing = flag(), |value| value.to_string();
    smoothing = flag(), |value| value.to_string();
    smooth_joined = flag(), |value| value.to_string();
    smoothing_weights = word(&SmoothingWeights::ALL, SmoothingWeights::word), |value| value.word().to_owned();
    enhancement = flag(), |value| value.to_string();
    enhancement_order = word(&EnhancementOrder::ALL, EnhancementOrder::word), |value| value.word().to_owned();
    seaming = flag(), |value| value.to_string();
    splitting = flag(), |value| value.to_string();
    post_processing = flag(), |value| value.to_string();
    clean_up = word(&CleanUpBy::ALL, CleanUpBy::word), |value| value.word().to_owned();
    max_quads = count(1, 200_000_000), |value| value.to_string();
}

/// The fault of an unknown key: names the nearest known one, or all if none is near.
pub fn unknown_key(key: &str, known: &[&str]) -> Fault {
    let nearest = nearest(key, known.iter().copied());
    let fault = Fault::new(format!("The key \"{key}\" is not known"));
    match nearest {
        Some(near) => fault.remedy(format!("The nearest known one is \"{near}\"")),
        _ => fault.remedy(format!("Known here: {}", known.join(", "))),
    }
}

fn number(key: &str, value: &str, least: f64, most: f64) -> Result<f64, Fault> {
    let number = value.parse::<f64>().ok().filter(|n| !n.is_nan());
    let number = number.ok_or_else(|| {
        let fault = Fault::new(format!("{key} = {} is not a number", quoted(value)));
        match leading_number(value) {
            Some(plain) => {
                let extra = if plain.len() == value.trim_matches('"').len() { "quotes" } else { "a unit" };
                fault.remedy(format!("Write it without {extra}: {key} = {plain}"))
            }
            None => fault.remedy(format!("Write a number from {least} to {most}")),
        }
    })?;
    if !(least..=most).contains(&number) {
        return Err(
            Fault::new(format!("{key} = {value} is out of range")).remedy(format!("It may be from {least} to {most}"))
        );
    }
    Ok(number)
}

fn angle(key: &str, value: &str, least: f64, most: f64, usual: f64) -> Result<f64, Fault> {
    let number = value.parse::<f64>().ok().filter(|n| !n.is_nan());
    let number = number.ok_or_else(|| {
        let plain = leading_number(value).map_or_else(|| usual.to_string(), str::to_owned);
        Fault::new(format!("{key} = {} is not a number", quoted(value)))
            .remedy(format!("Write degrees without a unit: {key} = {plain}"))
    })?;
    if !(least..=most).contains(&number) {
        return Err(Fault::new(format!("{key} = {value} is out of range"))
            .remedy(format!("It may be from {least} to {most} degrees, and is {usual} by default")));
    }
    Ok(number.to_radians())
}

fn count<T: FromStr + PartialOrd + Display + Copy>(key: &str, value: &str, least: T, most: T) -> Result<T, Fault> {
    let number = value.parse::<T>().ok().filter(|n| (least..=most).contains(n));
    number.ok_or_else(|| {
        Fault::new(format!("{key} = {} is not a whole number from {least} to {most}", quoted(value)))
            .remedy(format!("Write for example {key} = {least}"))
    })
}

fn flag(key: &str, value: &str) -> Result<bool, Fault> {
    value.parse::<bool>().map_err(|_| {
        Fault::new(format!("{key} = {} is neither true nor false", quoted(value)))
            .remedy(format!("Write {key} = true or {key} = false"))
    })
}

fn word<T: Copy>(key: &str, value: &str, all: &[T], word: fn(T) -> &'static str) -> Result<T, Fault> {
    all.iter().copied().find(|&one| word(one) == value).ok_or_else(|| {
        let known: Vec<_> = all.iter().map(|&one| format!("\"{}\"", word(one))).collect();
        Fault::new(format!("{key} = {} is not known", quoted(value))).remedy(format!("Known: {}", known.join(", ")))
    })
}

/// Splits a list of names; the separator is not a comma where names may contain one.
fn names(_: &str, value: &str, separator: char) -> Result<Vec<String>, Fault> {
    Ok(value.split(separator).map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect())
}

/// Degrees that give the same radians again, without the digits that come from rounding errors where that is possible.
fn degrees(radians: f64) -> String {
    let exact = radians.to_degrees();
    let plain = (exact * 1e9).round() / 1e9;
    let near = [plain, exact, exact.next_down(), exact.next_up()];
    near.into_iter().find(|degrees| degrees.to_radians() == radians).unwrap_or(exact).to_string()
}

/// A value for a message: strings in quotes (files pass their own) and escaped, to keep the message on one line.
fn quoted(value: &str) -> String {
    if value.parse::<f64>().is_ok() {
        return value.to_owned();
    }
    format!("\"{}\"", value.trim_matches('"').escape_debug())
}

/// The number that a text such as "135deg" starts with.
fn leading_number(value: &str) -> Option<&str> {
    let value = value.trim_matches('"');
    let end = value.find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-')).unwrap_or(value.len());
    let start = value.get(..end)?;
    start.parse::<f64>().ok().map(|_| start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_survives_a_round_trip_through_text() {
        let standard = Parameters::default();
        let mut parameters = standard.clone();
        for key in Parameters::KEYS {
            let text = standard.text_of(key).unwrap();
            parameters.set(key, &text).unwrap();
        }
        assert_eq!(parameters, standard);
        assert_eq!(standard.text_of("theta_rect").unwrap(), "135");
    }

    #[test]
    fn the_paper_s_reading_keeps_the_size_of_the_case() {
        let mut own = Parameters::default();
        for (key, value) in
            [("size_scale", "0.5"), ("layers", "2"), ("max_quads", "1000"), ("c", "1.5"), ("seaming", "false")]
        {
            own.set(key, value).unwrap();
        }
        let paper = own.read_as_paper();
        let text = |key| paper.text_of(key).unwrap();
        assert_eq!(["size_scale", "layers", "max_quads"].map(text), ["0.5", "2", "1000"]);
        assert_eq!(["c", "theta_rect", "theta_seam"].map(text), ["2", "135", "30"]);
        assert_eq!(["selection_window", "bisector", "placement"].map(text), ["physical_length", "false", "false"]);
        let rules = ["h_min_over", "division_at", "first_rescue", "smoothing_weights", "enhancement_order"];
        assert_eq!(rules.map(text), ["front", "midpoint", "left_neighbour", "printed", "delete_first"]);
        let numbers = ["seam_widening", "whole_below", "top_smoothing", "smooth_joined"];
        assert_eq!(numbers.map(text), ["1", "0", "true", "true"]);
        assert_eq!(text("seaming"), "true");
    }

    #[test]
    fn an_angle_with_a_unit_is_refused_with_the_right_form() {
        let fault = Parameters::default().set("theta_rect", "120deg").unwrap_err();
        assert_eq!(
            fault.to_string(),
            "theta_rect = \"120deg\" is not a number. Write degrees without a unit: theta_rect = 120."
        );
    }

    #[test]
    fn an_unknown_key_names_the_nearest_known_one() {
        let fault = Parameters::default().set("theta_rekt", "135").unwrap_err();
        assert!(fault.remedy.contains("\"theta_rect\""), "{fault}");
        let fault = Parameters::default().set("colour", "3").unwrap_err();
        assert!(fault.remedy.starts_with("Known here: size_scale, c,"), "{fault}");
    }

    #[test]
    fn values_out_of_range_and_not_finite_are_refused_and_change_nothing() {
        let mut parameters = Parameters::default();
        for (key, value) in [
            ("c", "0.4"),
            ("c", "1001"),
            ("size_scale", "0"),
            ("size_scale", "-1"),
            ("size_scale", "NaN"),
            ("size_scale", "inf"),
            ("theta_rect", "60"),
            ("theta_seam", "91"),
            ("layers", "-1"),
            ("layers", "2.5"),
            ("max_quads", "0"),
            ("selection", "largest"),
            ("selection_window", "length"),
            ("bisector", "1"),
            ("seaming", "\"true\""),
        ] {
            assert!(parameters.set(key, value).is_err(), "{key} = {value}");
        }
        assert_eq!(parameters, Parameters::default());
    }
}
