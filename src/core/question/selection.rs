//! Which segment comes next, and of which class it is (paper 4.3.3, table 1).

use super::choice::Choice;
use super::judged::{Hint, Judged};
use super::rule::Rule;
use crate::core::case::Selection;
use crate::core::convert::Converter;
use crate::core::front::segment::Key;
use crate::core::kernel::number::{fixed, grouped, size};
use crate::core::mesh::NodeId;
use crate::core::run::explain::{angles_apart, edge, key_name, key_text, segment};
use crate::core::run::front_table::Row;
use crate::core::run::{EdgeFacts, EdgeKind, FrontTable, Selecting, Verdict};

/// Keys and angles that differ by less than this, relative to them, are the same but for rounding.
const ROUNDING: f64 = 1e-9;
/// Nobody sees which of two keys is smaller that differ by less than this, relative to them.
const SEEN: f64 = 0.05;

/// Judges a front segment as the next base, against the one that the rules select.
pub(super) fn segment_is_next(
    selecting: &Selecting,
    state: &Converter<'_>,
    right: [NodeId; 2],
    answer: [NodeId; 2],
) -> Judged {
    let [a, b] = answer;
    // A segment that is pointed at has no direction; where both directions are on the front, the right one counts.
    let directions = if right == [b, a] { [[b, a], [a, b]] } else { [[a, b], [b, a]] };
    let told = directions.into_iter().find_map(|[a, b]| selecting.explain(state, a, b));
    let Some(told) = told else { return Judged::wrong(Rule::LiveAndDead, vec![not_on_front(state, answer)]) };
    let table = &selecting.table;
    let row = &told.row;
    let mut why = selecting.decided(&told);
    if [row.a, row.b] == right {
        // The last sentences are about the rule that decides, those before about classes that are empty.
        why.drain(..why.len().saturating_sub(2));
        return Judged::right(rule_of(table, row), why);
    }
    let Some(chosen) = table.find(right[0], right[1]) else { return Judged::wrong(Rule::Front, why) };
    if is_the_same_but_for_rounding(table, row, chosen) {
        let only = format!(
            "Nothing but its number tells {} from {}: both have the same key, so both count.",
            segment(right),
            segment([row.a, row.b])
        );
        return Judged::right(rule_of(table, row), vec![only]);
    }
    if let Some((before, all)) = told.rank {
        why.insert(0, format!("It has rank {} of {}.", grouped(before as u64 + 1), grouped(all as u64)));
        why.truncate(2);
    }
    let is_by_table = table.parameters().selection == Selection::Table1;
    match told.verdict {
        Verdict::BetterClass { .. } | Verdict::ClassFour => Judged::wrong(Rule::Table1, why),
        _ if is_by_table && row.class == chosen.class => Judged::partly(Rule::HValue, why),
        Verdict::LaterRow => Judged::wrong(Rule::Levels, why),
        _ => Judged::wrong(if is_by_table { Rule::HValue } else { Rule::Front }, why),
    }
}

/// The rule that a segment which comes first is known by: its class, or its key where its class has others.
fn rule_of(table: &FrontTable, row: &Row) -> Rule {
    if table.parameters().selection != Selection::Table1 {
        return Rule::Front;
    }
    let rivals = table.rows.iter().filter(|other| table.competes(other) && other.class == row.class);
    if rivals.count() > 1 { Rule::HValue } else { Rule::Table1 }
}

/// Whether no rule tells two segments apart: equal classes and keys, where the sum of the frontal angles decides, or
/// would but for rounding, does so by rounding only.
fn is_the_same_but_for_rounding(table: &FrontTable, one: &Row, other: &Row) -> bool {
    let Some([one_key, other_key]) = comparable_keys(table, one, other) else { return false };
    let sums = [one, other].map(|row| row.theta[0] + row.theta[1]);
    let keys_are_near = are_near(&one_key, &other_key, ROUNDING);
    table.competes(one) && keys_are_near && (one_key != other_key || are_near(&sums[..1], &sums[1..], ROUNDING))
}

/// The keys of two segments where they decide which one comes first: not where the class or the reach does.
fn comparable_keys(table: &FrontTable, one: &Row, other: &Row) -> Option<[[f64; 3]; 2]> {
    let parameters = table.parameters();
    let by_table = parameters.selection == Selection::Table1;
    if by_table && (one.class != other.class || table.is_within_reach(one) != table.is_within_reach(other)) {
        return None;
    }
    Some(if by_table && !table.is_within_reach(one) {
        [one, other].map(|row| [row.h_value, 0.0, 0.0])
    } else {
        [one, other].map(|row| {
            let Key(key) = row.primary_key(parameters);
            key
        })
    })
}

/// Whether all values differ by at most a share of them.
fn are_near(one: &[f64], other: &[f64], share: f64) -> bool {
    one.iter().zip(other).all(|(x, y)| (x - y).abs() <= share * x.abs().max(y.abs()))
}

/// Whether one can see which segment comes next: no other one is nearly as good. What is as good but for rounding may
/// stand beside it, since both are right then.
pub(super) fn can_be_seen(table: &FrontTable) -> bool {
    let Some(chosen) = table.choice() else { return false };
    let is_rival = |row: &&Row| table.competes(row) && [row.a, row.b] != [chosen.a, chosen.b];
    !table.rows.iter().filter(is_rival).any(|row| {
        let keys = comparable_keys(table, row, chosen);
        keys.is_some_and(|[its, best]| are_near(&its, &best, SEEN)) && !is_the_same_but_for_rounding(table, row, chosen)
    })
}

/// Why an edge is no front segment.
fn not_on_front(state: &Converter<'_>, ends: [NodeId; 2]) -> String {
    let name = edge(ends);
    match EdgeFacts::of(&state.mesh, ends[0], ends[1]).map(|facts| facts.kind) {
        Some(EdgeKind::Live) => {
            format!("{name} lies between two live triangles, and a base is a segment of the front.")
        }
        _ => format!("{name} has no live triangle beside it any more, and a base is a segment of the front."),
    }
}

/// Judges a class of table 1 for a front segment.
pub(super) fn class_is(selecting: &Selecting, ends: [NodeId; 2], answer: Choice) -> Judged {
    let Some(row) = selecting.table.find(ends[0], ends[1]) else { return Judged::wrong(Rule::Front, Vec::new()) };
    let why = vec![why_class(&selecting.table, row)];
    let right = Choice::of_class(row.class);
    let one_end = [Choice::Second, Choice::Third];
    if answer != right && one_end.contains(&right) && one_end.contains(&answer) {
        return Judged::partly(Rule::Table1, why);
    }
    Judged::of(answer == right, Rule::Table1, why)
}

/// Why a segment is of its class.
fn why_class(table: &FrontTable, row: &Row) -> String {
    let rect = table.parameters().theta_rect;
    let [at_a, at_b] = row.theta.map(|theta| angles_apart(theta, rect)[0].clone());
    let rect = fixed(rect.to_degrees(), 0);
    let below = match row.class {
        1 => "both are",
        2 => "only that at A is",
        3 => "only that at B is",
        _ => "neither is",
    };
    format!(
        "The frontal angles of {} are {at_a}\u{b0} at A and {at_b}\u{b0} at B: {below} below \u{3b8}_{{rect}} = \
         {rect}\u{b0}, so it is of class {}.",
        segment([row.a, row.b]),
        row.class
    )
}

/// Hints to the next base: first what the front is ordered by, then the classes.
pub(super) fn hints_to_segment(selecting: &Selecting) -> Vec<Hint> {
    let table = &selecting.table;
    let parameters = table.parameters();
    let [short, name] = key_name(parameters);
    let labels = |text: &dyn Fn(&Row) -> String| {
        // The first ones get room first.
        let rows = table.in_order().into_iter().map(|place| &table.rows[place]).filter(|row| table.competes(row));
        rows.map(|row| ([row.a, row.b], text(row))).collect::<Vec<_>>()
    };
    let first = match parameters.selection {
        Selection::Table1 => format!(
            "What counts is {name}, and the reach is c\u{b7}H_{{min}} = {} \u{d7} {} = {}.",
            parameters.c,
            size(table.h_min),
            size(table.reach())
        ),
        _ => format!("The order is by {name}."),
    };
    let keys = Hint { text: first, labels: labels(&|row| format!("{short} {}", key_text(row, parameters))) };
    if parameters.selection != Selection::Table1 {
        return vec![keys];
    }
    let classes = (1..=4_u8).map(|class| {
        let of = table.rows.iter().filter(|row| table.competes(row) && row.class == class);
        let within = of.clone().filter(|row| table.is_within_reach(row)).count();
        match class {
            4 => format!("class 4: {}", of.count()),
            _ => format!("class {class}: {}, {within} within reach", of.count()),
        }
    });
    let class = |row: &Row| {
        let reach = if row.class == 4 || table.is_within_reach(row) { "" } else { ", out of reach" };
        format!("class {}{reach}", row.class)
    };
    let text = format!("Segments by class: {}.", classes.collect::<Vec<_>>().join("; "));
    vec![keys, Hint { text, labels: labels(&class) }]
}

/// Hints to the class of a segment: its angles, then the bound.
pub(super) fn hints_to_class(selecting: &Selecting, ends: [NodeId; 2]) -> Vec<Hint> {
    let table = &selecting.table;
    let Some(row) = table.find(ends[0], ends[1]) else { return Vec::new() };
    let rect = table.parameters().theta_rect;
    let [at_a, at_b] = row.theta.map(|theta| angles_apart(theta, rect)[0].clone());
    let label = vec![(ends, format!("{at_a}\u{b0}, {at_b}\u{b0}"))];
    let angles = format!("Its frontal angles are {at_a}\u{b0} at A and {at_b}\u{b0} at B.");
    vec![
        Hint { text: angles, labels: label },
        Hint::of(format!(
            "Class 1 has both below \u{3b8}_{{rect}} = {}\u{b0}, class 2 only that at A, class 3 only that at B.",
            fixed(rect.to_degrees(), 0)
        )),
    ]
}
