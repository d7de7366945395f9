//! What comes next: what is decided of the quadrilateral under way, and which rule has its turn.

use super::about::divided;
use super::numbers::{capital, count, edge, segment};
use super::selecting::Selecting;
use super::side::name;
use crate::core::case::CleanUpBy;
use crate::core::convert::{Attempt, Base, Converter, FinishPart, Phase, SideRule};
use crate::core::front::Side;
use crate::core::mesh::NodeId;

/// What the next step does, as far as the state says it.
pub fn next(state: &Converter<'_>, selecting: &Selecting) -> String {
    let parameters = state.parameters();
    match state.phase() {
        Phase::Select => select(state, selecting),
        Phase::PrepareSide { side, attempt, .. } if attempt.number > 0 => {
            format!("Attempt {}: {}", u32::from(attempt.number) + 1, prepare(state, *side))
        }
        Phase::PrepareSide { side, .. } => prepare(state, *side),
        Phase::DivideSide { base, attempt, side, tops } => divide(state, base, attempt, *side, *tops),
        Phase::RecoverTop { tops, smooths: true, .. } => format!(
            "The nodes around {} are smoothed where that improves them (4.3.4, top edge v); then the top edge {} is looked \
             for.",
            tops[0].0,
            edge(*tops)
        ),
        Phase::RecoverTop { tops: [c, d], .. } => recover(state, *c, *d),
        Phase::Form { base, tops: [c, d], .. } => format!(
            "The triangles between nodes {}, {}, {} and {} are merged; shape, lengths and loops are checked (4.3.4).",
            base.a.0, base.b.0, d.0, c.0
        ),
        Phase::Defer { .. } => {
            "Every attempt has failed: the loop is closed if it is small, otherwise the segment is deferred.".to_owned()
        }
        Phase::Enhance { element, .. } if parameters.enhancement => format!(
            "Around quadrilateral {}: a node with three or four triangles is removed, or an edge swapped; where nothing \
             improves, {} (4.3.6).",
            element.0,
            if parameters.smoothing { "nodes are smoothed" } else { "corners are examined for seams" }
        ),
        Phase::Enhance { element, .. } | Phase::Smooth { element, .. } if parameters.smoothing => {
            format!("The nodes around quadrilateral {} are smoothed (4.3.6, eqs. 9 and 10).", element.0)
        }
        Phase::Enhance { element, .. } | Phase::Smooth { element, .. } | Phase::Seam { element, .. }
            if parameters.seaming =>
        {
            let split = if parameters.splitting { ", then its triangles for a split" } else { "" };
            format!(
                "The frontal angles at quadrilateral {} are examined for seams{split} (4.3.6); where there is none, {}.",
                element.0,
                after_it(selecting)
            )
        }
        Phase::Enhance { .. } | Phase::Smooth { .. } | Phase::Seam { .. } | Phase::Split { .. } => {
            split(state, selecting)
        }
        Phase::Close { waiting, .. } => {
            format!("The front has ended: {} left over, closed if they are small.", count(waiting.len(), "part"))
        }
        Phase::Match { left, at } if *at < left.len() => {
            format!("The last resort pairs the triangles of part {} of {}.", at + 1, left.len())
        }
        Phase::Match { .. } if parameters.post_processing => {
            "The last resort is done; the whole mesh is cleaned up and smoothed (4.3.7).".to_owned()
        }
        Phase::Match { .. } => "The last resort is done; the conversion ends without post-processing.".to_owned(),
        Phase::Patch { plan, patch, .. } => {
            format!("The last resort makes quadrilaterals, patch {} of {}.", patch + 1, plan.patches())
        }
        Phase::PostProcess { part } => finish(*part, parameters.clean_up).to_owned(),
        Phase::NextFace => "The next face is converted, if there is one.".to_owned(),
        Phase::Mirror => "The mirror image of the half is added and joined along the mirror line.".to_owned(),
        Phase::Done => "Nothing: the conversion is finished.".to_owned(),
    }
}

fn select(state: &Converter<'_>, selecting: &Selecting) -> String {
    if let Some([a, b]) = state.picked() {
        let is_there = state.check_base(a, b).is_ok();
        return if is_there {
            format!("{}, which you chose, becomes the base.", segment([a, b]))
        } else {
            format!("{}, which you chose as base, is no longer on the front.", segment([a, b]))
        };
    }
    match selecting.table.choice() {
        Some(row) => format!("{} becomes the base (4.3.3).", segment([row.a, row.b])),
        None if selecting.table.is_closed() => "The front is closed: the conversion of triangles ends.".to_owned(),
        None => "Every segment is deferred: all are tried once more with wider tolerances, or closed.".to_owned(),
    }
}

/// The next side, from what it will be chosen from.
fn prepare(state: &Converter<'_>, side: Side) -> String {
    let which = name(side);
    let Some(tried) = state.candidates() else { return String::new() };
    let chosen = tried.edges.iter().find(|candidate| candidate.passed.is_none());
    let node = chosen.map_or(0, |chosen| chosen.node.0);
    match tried.rule {
        SideRule::Front => format!("The front segment to node {node} becomes the {which} side (4.3.4, ii)."),
        SideRule::Near => format!("The edge to node {node} becomes the {which} side (4.3.4, iii)."),
        SideRule::Swap => format!("A swap makes the edge to node {node}, the {which} side (4.3.4, iv and v)."),
        SideRule::Nearest => format!("The edge to node {node} becomes the {which} side (4.3.4, v)."),
        SideRule::Attempt => format!("The edge to node {node} becomes the {which} side, as this attempt says."),
        SideRule::Nothing => format!("Nothing can be the {which} side: the attempt is taken back."),
    }
}

fn divide(state: &Converter<'_>, base: &Base, attempt: &Attempt, side: Side, tops: [Option<NodeId>; 2]) -> String {
    let which = name(side);
    let Some(top) = tops[side.index()] else { return String::new() };
    let ends = [base.node(side), top];
    let why = divided(state.parameters(), base, attempt, side, state.mesh.distance(ends[0], top));
    format!("The {which} side, {}, is to be divided: {why}", edge(ends))
}

fn recover(state: &Converter<'_>, c: NodeId, d: NodeId) -> String {
    let top = edge([c, d]);
    if state.mesh.are_joined(c, d) {
        return format!("The edge {top} is there: it becomes the top (4.3.4, top edge vi).");
    }
    match state.top_crossings() {
        Some(crossings) => {
            let edges = count(crossings.len(), "edge");
            let cross = if crossings.len() == 1 { "crosses" } else { "cross" };
            format!(
                "{} {cross} the top {top}: one is swapped, or else a node removed (4.3.4, top edge ii to iv).",
                capital(&edges)
            )
        }
        None => format!("The top {top} cannot be recovered: a dead edge or a node lies on it."),
    }
}

/// What follows the local post-processing.
fn after_it(selecting: &Selecting) -> &'static str {
    if selecting.table.is_closed() { "the front is closed" } else { "the next base is selected (4.3.3)" }
}

fn split(state: &Converter<'_>, selecting: &Selecting) -> String {
    let narrow = state.narrow().filter(|_| state.parameters().splitting);
    match narrow {
        Some(narrow) if !narrow.slender.is_empty() => {
            let triangles = count(narrow.slender.len(), "slender triangle");
            format!("The front is to be split at {triangles} beside the new quadrilateral (4.3.6, fig. 19).")
        }
        _ => format!("{}.", capital(after_it(selecting))),
    }
}

fn finish(part: FinishPart, clean_up: CleanUpBy) -> &'static str {
    match (part, clean_up) {
        (FinishPart::FirstSmoothing, _) => "The mesh is smoothed as the front has left it (4.3.7).",
        (FinishPart::CleanUp, CleanUpBy::Traditional) => {
            "The structure is cleaned up by the traditional operations, where they improve the valences (4.3.7)."
        }
        (FinishPart::CleanUp, CleanUpBy::Search) => {
            "The structure is cleaned up around irregular nodes: by changes of one or two elements, then by filling \
             cavities anew (4.3.7)."
        }
        (FinishPart::Rows, _) => "The rows at walls are laid on the normals of the walls, one after the other.",
        (FinishPart::LastSmoothing, _) => "The final structure is smoothed (4.3.7).",
        (FinishPart::Unfolding, _) => "Elements that fold over their surface are repaired.",
    }
}
