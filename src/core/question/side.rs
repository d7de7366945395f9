//! Which edge becomes a side of the quadrilateral (paper 4.3.4, side edges).

use super::judged::{Hint, Judged};
use super::rule::Rule;
use crate::core::convert::{Base, Candidate, Candidates, SideRule};
use crate::core::front::Side;
use crate::core::kernel::number::degrees;
use crate::core::mesh::NodeId;
use crate::core::run::explain::{angles_apart, edge, passed, side_rule};

const RULE: Rule = Rule::SideEdges;

/// The edge that a candidate is, or the one that is swapped for it.
fn pointed_at(candidate: &Candidate, from: NodeId) -> [NodeId; 2] {
    candidate.swap.unwrap_or([from, candidate.node])
}

/// The right answer: the edge that is chosen, or the one that is swapped to make it.
pub(super) fn right(tried: &Candidates, base: &Base) -> Option<[NodeId; 2]> {
    tried.chosen().map(|chosen| pointed_at(chosen, base.node(tried.side)))
}

/// Judges an edge as a side. An edge that a swap makes may be answered by its ends too.
pub(super) fn edge_is_side(tried: &Candidates, base: &Base, answer: [NodeId; 2]) -> Judged {
    let from = base.node(tried.side);
    let is = |ends: [NodeId; 2]| ends == answer || [ends[1], ends[0]] == answer;
    let of = |candidate: &&Candidate| is([from, candidate.node]) || candidate.swap.is_some_and(is);
    let rule = side_rule(tried);
    let chosen = tried.chosen();
    if chosen.as_ref().is_some_and(of) {
        return Judged::right(RULE, vec![rule]);
    }
    // An edge that is there comes before one that a swap would make.
    let Some(candidate) = tried.edges.iter().find(of) else {
        let [letter, which] = letter_and_name(tried.side);
        let no =
            format!("{} does not begin at {letter}, node {}, where the {which} side begins.", edge(answer), from.0);
        return Judged::wrong(RULE, vec![no]);
    };
    let reason = candidate.passed.map_or(String::new(), |why| passed(why, candidate, tried));
    let off = match chosen {
        Some(chosen) if tried.rule != SideRule::Front => {
            let [its, least] = angles_apart(candidate.deviation, chosen.deviation);
            format!(", {its}\u{b0} off the direction aimed at, where {least}\u{b0} is to be had")
        }
        _ => String::new(),
    };
    let why = vec![format!("{}: {reason}{off}.", edge([from, candidate.node])), rule];
    let would_do = tried.second().is_some_and(|second| second == candidate);
    if would_do { Judged::partly(RULE, why) } else { Judged::wrong(RULE, why) }
}

fn letter_and_name(side: Side) -> [&'static str; 2] {
    match side {
        Side::Left => ["A", "left"],
        Side::Right => ["B", "right"],
    }
}

/// Hints: the frontal angle and what is aimed at, then what each candidate is off.
pub(super) fn hints(tried: &Candidates, base: &Base) -> Vec<Hint> {
    let [letter, which] = letter_and_name(tried.side);
    let [theta, rect] = angles_apart(tried.theta, tried.theta_rect);
    if tried.theta < tried.theta_rect {
        return vec![Hint::of(format!(
            "The frontal angle at {letter} is {theta}\u{b0}, below \u{3b8}_{{rect}} = {rect}\u{b0}: the {which} \
             side is on the front."
        ))];
    }
    let target = degrees(tried.target);
    let first = format!(
        "The frontal angle at {letter} is {theta}\u{b0}, not below \u{3b8}_{{rect}} = {rect}\u{b0}. The direction \
         aimed at is {target}\u{b0} from the base."
    );
    let from = base.node(tried.side);
    let there = tried.edges.iter().filter(|candidate| candidate.swap.is_none());
    let labels = there.map(|candidate| ([from, candidate.node], format!("{}\u{b0} off", degrees(candidate.deviation))));
    let second = format!(
        "An edge within {}\u{b0} of it is taken, the nearest first; else a swap may make a nearer one.",
        degrees(tried.limit)
    );
    vec![Hint::of(first), Hint { text: second, labels: labels.collect() }]
}
