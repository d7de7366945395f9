//! Side edges in words (paper 4.3.4): what the frontal angles mean for them, by which rule one was chosen, and why each
//! other candidate was not.

use super::Corner;
use std::f64::consts::FRAC_PI_2;

use super::numbers::{angles_apart, down, edge, up};
use super::why::{range_of_theta_rect, same_choice};
use crate::core::case::Parameters;
use crate::core::convert::{Candidate, Candidates, Passed, Phase, SideRule};
use crate::core::front::Side;
use crate::core::kernel::number::degrees;
use crate::core::mesh::{Mesh, NodeId};

pub(super) fn name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

/// The letter of the base node of a side.
pub(super) fn letter(side: Side) -> &'static str {
    match side {
        Side::Left => "A",
        Side::Right => "B",
    }
}

/// What the frontal angle at one end of a front segment means. Of the base under way: what is decided about that side,
/// or how it will be; of another segment: what it would be.
pub fn corner(
    mesh: &Mesh,
    phase: &Phase,
    parameters: &Parameters,
    ends: [NodeId; 2],
    theta: f64,
    side: Side,
) -> String {
    let which = name(side);
    let is_base = phase.base().is_some_and(|base| [base.a, base.b] == ends);
    let (tops, attempt) = decided(phase);
    if let Some(top) = tops[side.index()].filter(|_| is_base) {
        let is_divided = matches!(phase, Phase::DivideSide { side: at_hand, .. } if *at_hand == side);
        let then = if is_divided { ", to be divided" } else { "" };
        return format!("{which} side decided: {}{then}", edge([ends[side.index()], top]));
    }
    if let Some(top) = attempt.and_then(|tops| tops[side.index()]).filter(|_| is_base) {
        return format!("this attempt tries {} as the {which} side", edge([ends[side.index()], top]));
    }
    let neighbour = mesh.front_between(ends[0], ends[1]).map(|h| match side {
        Side::Left => [mesh.origin(mesh.front_before(h)), ends[0]],
        Side::Right => [ends[1], mesh.target(mesh.front_after(h))],
    });
    let front = neighbour.map_or("the front".to_owned(), |segment| format!("the front, {},", edge(segment)));
    let far = neighbour.map(|segment| segment[side.index()]);
    let is_taken = far.is_some_and(|far| ends.contains(&far) || is_base && tops.contains(&Some(far)));
    let becomes = match (is_taken, is_base) {
        (true, _) => "ends at a corner in use and cannot be",
        (false, true) => "is to be",
        (false, false) => "would be",
    };
    let bound = |sign: &str, angle: f64, of: &str| {
        let [_, angle] = angles_apart(theta, angle);
        format!("{sign} {angle}\u{b0} = \u{3b8}_{{{of}}}")
    };
    let found = if is_base { "is to be found" } else { "would have to be found" };
    match Corner::of(theta, parameters) {
        Corner::Seam => {
            let bound = bound("\u{2264}", parameters.theta_seam, "seam");
            format!("{bound}: narrow enough for a seam; {front} {becomes} the {which} side")
        }
        Corner::Rectangle => {
            format!("{}: {front} {becomes} the {which} side", bound("<", parameters.theta_rect, "rect"))
        }
        Corner::Flat => format!("{}: a {which} side {found}", bound("\u{2265}", parameters.theta_rect, "rect")),
        Corner::Reversal => {
            format!("{}, a reversal: a {which} side {found}", bound(">", parameters.theta_revr, "revr"))
        }
    }
}

/// The tops that are decided in a phase, and those that its attempt names.
fn decided(phase: &Phase) -> ([Option<NodeId>; 2], Option<[Option<NodeId>; 2]>) {
    let tops = match phase {
        Phase::PrepareSide { left, .. } => [*left, None],
        Phase::DivideSide { tops, .. } => *tops,
        Phase::RecoverTop { tops, .. } | Phase::Form { tops, .. } => tops.map(Some),
        _ => [None; 2],
    };
    (tops, phase.attempt().map(|attempt| attempt.tops))
}

/// By which rule a side was chosen from its candidates, with the numbers that it compared.
pub fn side_rule(tried: &Candidates) -> String {
    let Candidates { side, theta, theta_rect, rule, target, limit, .. } = tried;
    let (which, at) = (name(*side), letter(*side));
    let direction = if *target == FRAC_PI_2 { "right angle" } else { "bisector" };
    let [target, bound] = [target, limit].map(|angle| degrees(*angle));
    let [theta, rect] = angles_apart(*theta, *theta_rect);
    let chosen = tried.chosen();
    let [off, limit] = chosen.map_or([String::new(), bound], |chosen| angles_apart(chosen.deviation, *limit));
    let is_front = tried.theta < tried.theta_rect;
    let nearest = tried.edges.iter().filter(|c| c.swap.is_none() && c.passed == Some(Passed::Farther));
    let nearest = nearest.min_by(|a, b| a.deviation.total_cmp(&b.deviation));
    let not_front = format!("\u{3b8}_{{{at}}} = {theta}\u{b0} is not below \u{3b8}_{{rect}} = {rect}\u{b0}.");
    match rule {
        SideRule::Front => format!(
            "\u{3b8}_{{{at}}} = {theta}\u{b0} is below \u{3b8}_{{rect}} = {rect}\u{b0}: the neighbouring front segment is the \
             {which} side (4.3.4, ii)."
        ),
        SideRule::Near => format!(
            "{not_front} The edge nearest to the target of {target}\u{b0}, the {direction}, is {off}\u{b0} off, within {limit}\u{b0} (4.3.4, iii)."
        ),
        SideRule::Swap => {
            let best = match nearest {
                Some(best) => {
                    format!("The best edge is {}\u{b0} off, more than {limit}\u{b0}", degrees(best.deviation))
                }
                None => "No edge is there".to_owned(),
            };
            format!(
                "{not_front} {best}; a swap makes one that is {off}\u{b0} off the target of {target}\u{b0}, the {direction} (4.3.4, iv and v)."
            )
        }
        SideRule::Nearest => format!(
            "{not_front} No edge is within {limit}\u{b0} of the target of {target}\u{b0}, the {direction}, and no swap makes a nearer one than \
             the best edge, {off}\u{b0} off (4.3.4, v)."
        ),
        SideRule::Attempt => {
            let node = chosen.map_or(0, |chosen| chosen.node.0);
            format!("This attempt takes the edge to node {node} as the {which} side, whatever its angle.")
        }
        SideRule::Nothing if tried.edges.iter().any(|c| c.passed == Some(Passed::LaidDown)) => {
            format!("The edge that this attempt takes cannot be the {which} side.")
        }
        SideRule::Nothing if is_front => format!(
            "\u{3b8}_{{{at}}} = {theta}\u{b0} is below \u{3b8}_{{rect}} = {rect}\u{b0}, but the neighbouring front segment ends \
             at a corner in use (4.3.4, ii)."
        ),
        SideRule::Nothing => format!("No edge can be the {which} side, and no swap makes one."),
    }
}

/// The candidate that comes next to the chosen one, with its deviation; `None` where a side was not found by angles.
pub fn second(tried: &Candidates) -> Option<String> {
    let chosen = tried.chosen()?;
    Some(match (tried.second(), tried.rule) {
        (Some(second), _) => {
            let [_, off] = angles_apart(chosen.deviation, second.deviation);
            let by = if second.swap.is_some() { " by a swap" } else { "" };
            format!("the second best, node {}{by}, is {off}\u{b0} off", second.node.0)
        }
        (None, SideRule::Attempt) => "this attempt takes it, whatever its angle".to_owned(),
        (None, SideRule::Front | SideRule::Nothing) => return None,
        (None, _) => "there is no other".to_owned(),
    })
}

/// For which parameters the same side would be chosen; `None` where no parameter decides.
pub fn side_margins(tried: &Candidates) -> Option<String> {
    let mut bounds = Vec::new();
    bounds.extend(tried.margin_of_theta_rect().map(|margin| range_of_theta_rect(margin.map(f64::to_degrees))));
    let [least, below] = tried.margin_of_limit().map(|bound| bound.map(f64::to_degrees));
    bounds.extend(least.map(|bound| format!("side_deviation \u{2265} {}\u{b0}", up(bound, 1))));
    bounds.extend(below.map(|bound| format!("side_deviation < {}\u{b0}", down(bound, 1))));
    same_choice(&bounds)
}

/// Why a candidate is not the side.
pub fn passed(passed: Passed, candidate: &Candidate, tried: &Candidates) -> String {
    match passed {
        Passed::Taken => "ends at a corner in use".to_owned(),
        Passed::WideAngle => "front, but not below \u{3b8}rect".to_owned(),
        Passed::SmallAngle if tried.rule == SideRule::Nothing => "only the front may be the side".to_owned(),
        Passed::SmallAngle => "the front is the side".to_owned(),
        Passed::LaidDown => "not used in this attempt".to_owned(),
        Passed::Farther if tried.rule == SideRule::Near && candidate.deviation > tried.limit => {
            format!("more than {}\u{b0}", degrees(tried.limit))
        }
        Passed::Farther => "another is nearer".to_owned(),
        Passed::NotNeeded => "an edge is near enough".to_owned(),
        Passed::NotPositive => "it would fold over".to_owned(),
    }
}
