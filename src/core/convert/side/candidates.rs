//! What a side edge is chosen from (paper 4.3.4, side edges i to vii): every edge and every swap, with what speaks
//! against it. Computed from the state on demand: a run that nobody watches pays nothing for it.

use std::f64::consts::{FRAC_PI_2, PI};

use serde::Serialize;

use super::choice::{BaseSide, SideChoice, Way};
use crate::core::convert::event::{SideEdge, degrees};
use crate::core::convert::phase::Attempt;
use crate::core::front::Side;
use crate::core::mesh::NodeId;

/// Why a candidate is not the side edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Passed {
    /// It ends at the other end of the base, or at the top of the other side.
    Taken,
    /// It is the neighbouring front segment, and the frontal angle is not below theta_rect.
    WideAngle,
    /// The neighbouring front segment is the side.
    SmallAngle,
    /// This attempt has its top laid down.
    LaidDown,
    /// Another one is nearer to the direction that is aimed at.
    Farther,
    /// A swap, while an edge is there that is near enough.
    NotNeeded,
    /// The swap would not give two positive triangles.
    NotPositive,
}

/// The rule by which a side is chosen (paper 4.3.4, side edges).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SideRule {
    /// The frontal angle is below theta_rect: the neighbouring front segment is the side (ii).
    Front,
    /// The nearest edge is within the limit (iii).
    Near,
    /// No edge is within the limit, and a swap makes one that is nearer than all (iv, v).
    Swap,
    /// No edge is within the limit, and no swap makes a nearer one: the nearest edge is the side (v).
    Nearest,
    /// The attempt says which edge it is (docs/algorithm.md, "Rescue").
    Attempt,
    /// Nothing can be the side.
    Nothing,
}

/// An edge that could be a side, or that a swap would make one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Its top node.
    pub node: NodeId,
    /// Ends of the edge that would have to be swapped for it; none where it is there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub swap: Option<[NodeId; 2]>,
    /// Its angle with the base, radians.
    #[serde(serialize_with = "degrees")]
    pub angle: f64,
    /// How far that is from the direction aimed at.
    #[serde(serialize_with = "degrees")]
    pub deviation: f64,
    /// Its length in the metric.
    pub length: f64,
    /// Why it is not the side; none for the one that is chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub passed: Option<Passed>,
}

/// Everything that one side is chosen from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidates {
    /// Which side.
    pub side: Side,
    /// The frontal angle there, radians.
    #[serde(serialize_with = "degrees")]
    pub theta: f64,
    /// The bound below which the neighbouring front segment is the side.
    #[serde(serialize_with = "degrees")]
    pub theta_rect: f64,
    /// The rule that decides.
    pub rule: SideRule,
    /// The angle that is aimed at.
    #[serde(serialize_with = "degrees")]
    pub target: f64,
    /// How far an edge may be off it before swaps are weighed (eq. 8).
    #[serde(serialize_with = "degrees")]
    pub limit: f64,
    /// Edges in the order in which they are met from the base, then swaps.
    pub edges: Vec<Candidate>,
}

impl Candidates {
    /// The one that is chosen.
    pub fn chosen(&self) -> Option<&Candidate> {
        self.edges.iter().find(|candidate| candidate.passed.is_none())
    }

    /// The nearest to the direction aimed at of those that the chosen one was compared with: other edges, and where no
    /// edge is near enough, swaps too. `None` where nothing was compared, or where there is no other.
    pub fn second(&self) -> Option<&Candidate> {
        let compared = self.edges.iter().filter(|candidate| candidate.passed == Some(Passed::Farther));
        compared.min_by(|a, b| a.deviation.total_cmp(&b.deviation)).filter(|_| self.is_found())
    }

    /// The interval of theta_rect in radians, from (excluded) to (included), between 90 and 180 degrees, in which the
    /// same side is chosen, all else unchanged. `None` where the decision does not depend on it.
    pub fn margin_of_theta_rect(&self) -> Option<[f64; 2]> {
        match self.rule {
            SideRule::Front => Some([self.theta.max(FRAC_PI_2), PI]),
            _ if self.is_found() => Some([FRAC_PI_2, self.theta.min(PI)]),
            _ => None,
        }
    }

    /// The bounds of the limit (`side_deviation`) within which the same side is chosen, all else unchanged: at least
    /// the first, and below the second; `None` where there is no such bound, or none of at most 90 degrees.
    pub fn margin_of_limit(&self) -> [Option<f64>; 2] {
        let least = |among: &dyn Fn(&Candidate) -> bool| {
            let deviations =
                self.edges.iter().filter(|candidate| among(candidate)).map(|candidate| candidate.deviation);
            deviations.min_by(f64::total_cmp)
        };
        match self.rule {
            // With a smaller limit swaps are weighed, and a nearer one is made.
            SideRule::Near => {
                let own = self.chosen().map(|chosen| chosen.deviation);
                let swap = least(&|candidate| candidate.passed == Some(Passed::NotNeeded));
                [own.filter(|own| swap.is_some_and(|swap| swap < *own)), None]
            }
            // With a larger one the nearest edge is near enough.
            SideRule::Swap => {
                let nearest = least(&|c| c.swap.is_none() && c.passed == Some(Passed::Farther));
                [None, nearest.filter(|nearest| *nearest <= FRAC_PI_2)]
            }
            _ => [None; 2],
        }
    }

    /// Whether the side was found among edges and swaps by their angles.
    fn is_found(&self) -> bool {
        matches!(self.rule, SideRule::Near | SideRule::Swap | SideRule::Nearest)
    }
}

/// Everything that a side is chosen from.
pub(in crate::core::convert) fn of(here: &BaseSide<'_>, attempt: &Attempt, left: Option<NodeId>) -> Candidates {
    let BaseSide { mesh, parameters, base, side } = *here;
    let theta = base.theta[side.index()];
    let limit = parameters.side_deviation;
    let chosen = here.choose(attempt, left).ok();
    let given = attempt.tops[side.index()];
    let rule = match chosen {
        None => SideRule::Nothing,
        Some(_) if given.is_some() => SideRule::Attempt,
        Some(SideChoice { way: Way::Front, .. }) => SideRule::Front,
        Some(SideChoice { way: Way::Swap(..), .. }) => SideRule::Swap,
        Some(SideChoice { way: Way::Edge, edge }) if edge.deviation <= limit => SideRule::Near,
        Some(SideChoice { way: Way::Edge, .. }) => SideRule::Nearest,
    };
    let swapped = match chosen.map(|choice| choice.way) {
        Some(Way::Swap(h, _)) => Some(mesh.ends(h)),
        _ => None,
    };
    let taken = |n: NodeId| n == base.a || n == base.b || Some(n) == left;
    let spokes = base.half_edge(mesh).map(|h| mesh.spokes(h, side)).unwrap_or_default();
    let nearest = spokes
        .iter()
        .filter(|s| !s.is_front && !taken(s.node))
        .map(|s| here.edge(s.node).deviation)
        .fold(f64::INFINITY, f64::min);
    // What holds against every candidate of this side but the chosen one.
    let settled = if given.is_some() {
        Some(Passed::LaidDown)
    } else {
        (theta < parameters.theta_rect).then_some(Passed::SmallAngle)
    };
    let candidate = |node: NodeId, swap: Option<[NodeId; 2]>, passed: Passed| {
        let SideEdge { angle, deviation, .. } = here.edge(node);
        let is_chosen = chosen.is_some_and(|c| c.edge.node == node) && swapped == swap;
        let length = mesh.distance(base.node(side), node);
        Candidate { node, swap, angle, deviation, length, passed: (!is_chosen).then_some(passed) }
    };
    let mut edges = Vec::new();
    for spoke in &spokes {
        let passed = if taken(spoke.node) {
            Passed::Taken
        } else if let Some(settled) = settled {
            settled
        } else if spoke.is_front {
            Passed::WideAngle
        } else {
            Passed::Farther
        };
        edges.push(candidate(spoke.node, None, passed));
    }
    for spoke in &spokes {
        let Some((opposite, far)) = here.opposite(spoke) else { continue };
        let passed = if taken(far) {
            Passed::Taken
        } else if let Some(settled) = settled {
            settled
        } else if mesh.can_swap(opposite).is_err() {
            Passed::NotPositive
        } else if nearest <= limit {
            Passed::NotNeeded
        } else {
            Passed::Farther
        };
        edges.push(candidate(far, Some(mesh.ends(opposite)), passed));
    }
    let theta_rect = parameters.theta_rect;
    Candidates { side, theta, theta_rect, rule, target: here.target_angle(), limit, edges }
}
