//! What an edge, an element or a node is, as the state says it: live or dead, and the class of a frontal angle.

use super::choice::Choice;
use super::judged::{Hint, Judged};
use super::rule::Rule;
use crate::core::case::Parameters;
use crate::core::fault::{Fault, FaultKind};
use crate::core::front::Side;
use crate::core::mesh::{Mesh, NodeId};
use crate::core::run::explain::{angles_apart, edge};
use crate::core::run::{Corner, EdgeFacts, EdgeKind, Watched};

/// Whether something is live, and why; `None` where it is not there, or is a node.
pub(super) fn live(mesh: &Mesh, subject: Watched) -> Option<(bool, String)> {
    match subject {
        Watched::Node(_) => None,
        Watched::Edge(a, b) => {
            let name = edge([a, b]);
            Some(match EdgeFacts::of(mesh, a, b)?.kind {
                EdgeKind::Live => {
                    (true, format!("{name} has a live triangle on both sides, so it is live and may still change."))
                }
                EdgeKind::Front => (
                    false,
                    format!("{name} has a live triangle on one side only: it is on the front, and its edges are dead."),
                ),
                EdgeKind::Dead => (false, format!("{name} lies between two quadrilaterals, so it is dead.")),
                EdgeKind::Boundary => {
                    (false, format!("{name} is on the boundary, with a quadrilateral beside it: it is dead."))
                }
            })
        }
        Watched::Element(element) if !mesh.has_element(element) => None,
        Watched::Element(element) if mesh.is_triangle(element) => {
            Some((true, format!("Triangle {} is not converted yet, so it is live.", element.0)))
        }
        Watched::Element(element) => {
            Some((false, format!("Element {} is a quadrilateral, which is used up: it is dead.", element.0)))
        }
    }
}

/// The frontal angle of a node in radians, with its class.
///
/// # Errors
/// A node without one, or with several.
pub(super) fn angle(mesh: &Mesh, parameters: &Parameters, subject: Watched) -> Result<(f64, Corner), Fault> {
    let fault = |what: String| Fault::new(what).of_kind(FaultKind::Parameter);
    let Watched::Node(node) = subject else {
        return Err(fault("Only a node has a frontal angle".to_owned()).remedy("Write for example of: \"3\""));
    };
    if !mesh.has_node(node) {
        return Err(fault(format!("Node {} does not exist at this step", node.0)));
    }
    let mut leaving = mesh.fan(node).filter(|&h| mesh.is_front(h));
    match (leaving.next(), leaving.next()) {
        (Some(h), None) => {
            let theta = mesh.frontal_angle(h, Side::Left);
            Ok((theta, Corner::of(theta, parameters)))
        }
        (Some(_), Some(_)) => Err(fault(format!("The front runs through node {} more than once", node.0))),
        (None, _) => Err(fault(format!("Node {} is not on the front", node.0))),
    }
}

fn choice(corner: Corner) -> Choice {
    match corner {
        Corner::Seam => Choice::Seam,
        Corner::Rectangle => Choice::Rectangle,
        Corner::Flat => Choice::Flat,
        Corner::Reversal => Choice::Reversal,
    }
}

/// The right class of a frontal angle.
pub(super) fn right_angle_class(corner: Corner) -> Choice {
    choice(corner)
}

/// Judges the class of a frontal angle.
pub(super) fn angle_is(
    node: NodeId,
    (theta, corner): (f64, Corner),
    parameters: &Parameters,
    answer: Choice,
) -> Judged {
    let bound = |bound: f64, name: &str, sign: &str| {
        let [theta, bound] = angles_apart(theta, bound);
        format!("{theta}\u{b0} {sign} \u{3b8}_{{{name}}} = {bound}\u{b0}")
    };
    let Parameters { theta_seam, theta_rect, theta_revr, .. } = *parameters;
    let (where_it_lies, so) = match corner {
        Corner::Seam => (bound(theta_seam, "seam", "\u{2264}"), "a seam may close it"),
        Corner::Rectangle => (bound(theta_rect, "rect", "<"), "the neighbouring segment serves as a side"),
        Corner::Flat => (bound(theta_rect, "rect", "\u{2265}"), "a side has to be found"),
        Corner::Reversal => (bound(theta_revr, "revr", ">"), "the front turns back here, and a side has to be found"),
    };
    let why = format!("The frontal angle at node {} is {where_it_lies}, so {so}.", node.0);
    Judged::of(answer == choice(corner), Rule::Angles, vec![why])
}

/// Hints to the class of a frontal angle: the angle, then the bounds.
pub(super) fn hints_to_angle(node: NodeId, theta: f64, parameters: &Parameters) -> Vec<Hint> {
    let Parameters { theta_seam, theta_rect, theta_revr, .. } = *parameters;
    let [angle, seam] = angles_apart(theta, theta_seam);
    let [_, rect] = angles_apart(theta, theta_rect);
    let [_, revr] = angles_apart(theta, theta_revr);
    vec![
        Hint::of(format!("The angle at node {} is {angle}\u{b0}, measured inside the live region.", node.0)),
        Hint::of(format!(
            "The bounds are \u{3b8}_{{seam}} = {seam}\u{b0}, \u{3b8}_{{rect}} = {rect}\u{b0} and \u{3b8}_{{revr}} = \
             {revr}\u{b0}."
        )),
    ]
}

/// Hints to what is live.
pub(super) fn hints_to_live() -> Vec<Hint> {
    vec![
        Hint::of("Look at what lies on both sides of it."),
        Hint::of("Triangles are live. An edge is live between two of them, and only there."),
    ]
}
