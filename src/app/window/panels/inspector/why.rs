//! Why a segment was or was not selected (paper 4.3.3, table 1), and for which parameters the selection would be the
//! same.

use eframe::egui::Ui;

use super::{heading, sentence};
use crate::app::window::command::Command;
use crate::app::window::session::{Explained, Moment};
use crate::app::window::state::{Lookup, State};
use crate::app::window::words;
use crate::core::case::{Selection, SelectionWindow};
use crate::core::run::front_table::Row;
use crate::core::run::{SegmentFacts, Verdict};
use crate::render::palette::Palette;

pub fn show(ui: &mut Ui, state: &State, moment: &Moment, place: usize, commands: &mut Vec<Command>, palette: &Palette) {
    let row = &moment.rows[place];
    let ends = [row.a, row.b];
    let base = moment.base.as_ref().filter(|told| [told.row.a, told.row.b] == ends);
    let (told, deferred) = match base {
        Some(told) => (told.clone(), None),
        None => match state.run().explanation(ends) {
            Lookup::Known(explained) => {
                let Explained { told, deferred } = &*explained;
                (told.clone(), *deferred)
            }
            Lookup::Pending => return,
            Lookup::Unasked => return commands.push(Command::Explain(ends)),
        },
    };
    heading(ui, if told.is_base { "Why this segment" } else { "Why not this segment" }, "table 1, 4.3.3", palette);
    if let Some((step, why)) = deferred {
        let why = why.map_or(String::new(), |why| format!(" ({})", words::why(why)));
        let text =
            format!("Deferred at step {}{why}; available again when something near it changes.", words::grouped(step));
        sentence(ui, &text, palette.text, palette);
        return;
    }
    let sentences = if told.is_base { why(moment, &told) } else { why_not(moment, &told, place) };
    for (k, text) in sentences.iter().enumerate() {
        sentence(ui, text, if k == 0 { palette.text } else { palette.weak }, palette);
    }
    let same = same_choice(&told);
    if !same.is_empty() {
        sentence(ui, &same, palette.weak, palette);
    }
}

fn waiting(moment: &Moment) -> impl Iterator<Item = &Row> {
    moment.rows.iter().filter(|row| !row.is_deferred)
}

fn count_of_class(moment: &Moment, class: u8) -> usize {
    waiting(moment).filter(|row| row.class == class).count()
}

/// The segment with the smallest H among those that are not deferred.
fn smallest(moment: &Moment) -> Option<&Row> {
    waiting(moment).min_by(|a, b| a.h_value.total_cmp(&b.h_value))
}

/// The quantity that is compared with c Hmin.
fn window(moment: &Moment, row: &Row) -> String {
    let name = match moment.parameters.selection_window {
        SelectionWindow::HValue => "H",
        SelectionWindow::PhysicalLength => "length",
        SelectionWindow::MetricLengthTimesH => "metric length \u{d7} H",
    };
    format!("{name} = {}", words::size(row.window))
}

fn reach(moment: &Moment, h_min: f64) -> String {
    let c = moment.parameters.c;
    format!("c·H_{{min}} = {} \u{d7} {} = {}", words::fixed(c, 2), words::size(h_min), words::size(c * h_min))
}

fn why(moment: &Moment, told: &SegmentFacts) -> Vec<String> {
    let row = &told.row;
    if moment.parameters.selection != Selection::Table1 || told.verdict != Verdict::First {
        return vec![capital(&told.reason())];
    }
    let mut sentences = Vec::new();
    let empty: Vec<String> =
        (1..row.class).filter(|class| count_of_class(moment, *class) == 0).map(|class| class.to_string()).collect();
    let empty = match empty.len() {
        0 => String::new(),
        1 => format!("Class {} is empty. ", empty[0]),
        _ => format!("Classes {} are empty. ", empty.join(" and ")),
    };
    if row.class < 4 && row.window < moment.parameters.c * told.h_min {
        let text = format!(
            "{empty}First of class {}, and within reach: {} < {}.",
            row.class,
            window(moment, row),
            reach(moment, told.h_min)
        );
        sentences.push(text);
    } else {
        sentences.push(format!(
            "No segment of classes 1 to 3 is below {}, so the one with the smallest H, {}, is chosen.",
            reach(moment, told.h_min),
            words::size(row.h_value)
        ));
    }
    if let Some(least) = smallest(moment).filter(|least| least.h != row.h) {
        sentences.push(format!(
            "{} has H_{{min}} = {}, but is of class {}.",
            words::segment(least.a, least.b),
            words::size(least.h_value),
            least.class
        ));
    }
    sentences
}

fn why_not(moment: &Moment, told: &SegmentFacts, place: usize) -> Vec<String> {
    let row = &told.row;
    let mut text = match told.rank {
        Some(_) => format!("Rank {}. ", place + 1),
        None => String::new(),
    };
    let has_least = smallest(moment).is_some_and(|least| least.h == row.h);
    let but = |what: &str| if has_least { "It has H_{min}, but ".to_owned() + what } else { capital_of(what) };
    text += &match &told.verdict {
        Verdict::BetterClass { class } => {
            let what = format!(
                "class {class} has a segment within c·H_{{min}} = {}.",
                words::size(moment.parameters.c * told.h_min)
            );
            but(&what)
        }
        Verdict::OutOfReach { .. } => {
            format!("Out of reach: {} is not below {}.", window(moment, row), reach(moment, told.h_min))
        }
        Verdict::ClassFour => but("class 4 is considered only when no segment of classes 1 to 3 is within reach."),
        Verdict::First => "It will be selected next.".to_owned(),
        _ => capital(&told.reason()),
    };
    let mut sentences = vec![text];
    if let Some([low, high]) = told.chosen_for_c {
        sentences.push(format!("It would be next for {}.", range_of_c(low, high)));
    }
    sentences
}

fn same_choice(told: &SegmentFacts) -> String {
    let mut bounds = Vec::new();
    if let Some([low, high]) = told.margin_of_c {
        bounds.push(range_of_c(low, high));
    }
    if let Some([low, high]) = told.margin_of_theta_rect {
        bounds.push(format!("{}° < \u{3b8}_{{rect}} \u{2264} {}°", up(low, 1), down(high, 1)));
    }
    if bounds.is_empty() { String::new() } else { format!("Same choice for {}.", bounds.join(" and ")) }
}

fn range_of_c(low: f64, high: f64) -> String {
    match high.is_finite() {
        true => format!("{} < c \u{2264} {}", up(low, 3), down(high, 3)),
        false => format!("c > {}", up(low, 3)),
    }
}

/// Bounds are rounded inwards, so that they stay true.
fn up(x: f64, decimals: i32) -> String {
    let scale = libm::pow(10.0, f64::from(decimals));
    words::fixed((x * scale - 1e-9).ceil() / scale, decimals as usize)
}

fn down(x: f64, decimals: i32) -> String {
    let scale = libm::pow(10.0, f64::from(decimals));
    words::fixed((x * scale + 1e-9).floor() / scale, decimals as usize)
}

/// As a sentence.
fn capital(text: &str) -> String {
    format!("{}.", capital_of(text).trim_end_matches('.'))
}

fn capital_of(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_inwards() {
        assert_eq!((up(1.0104, 3), down(1.0109, 3)), ("1.011".to_owned(), "1.010".to_owned()));
        assert_eq!((up(92.5, 1), down(154.99, 1)), ("92.5".to_owned(), "154.9".to_owned()));
        assert_eq!(capital("chosen: the smallest"), "Chosen: the smallest.");
    }
}
