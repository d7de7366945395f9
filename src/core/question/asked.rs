//! A question at a state of a run.

use std::sync::Arc;

use super::answer::Answer;
use super::choice::Choice;
use super::judged::{Hint, Judged};
use super::kind::Kind;
use super::rule::Rule;
use super::{around, entity, place, selection, side, top};
use crate::core::convert::{Converter, Event, LookedAt, Purpose};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::number::{degrees, fixed};
use crate::core::mesh::NodeId;
use crate::core::run::explain::{about, edge, narration};
use crate::core::run::{Corner, History, Selecting, Watched};

/// What a question is about, with all that its judgement needs beside the state.
#[derive(Clone, Debug)]
enum Matter {
    /// The next base.
    Segment { selecting: Arc<Selecting>, right: [NodeId; 2] },
    /// Its class.
    Class { selecting: Arc<Selecting>, base: [NodeId; 2] },
    /// A side edge.
    Side { right: [NodeId; 2] },
    /// An edge across the top.
    Across { right: [NodeId; 2] },
    /// An edge beside the new quadrilateral.
    Beside { right: [NodeId; 2] },
    /// A node that is removed.
    Node { right: NodeId, purpose: Purpose },
    /// What becomes of the top edge.
    Top { event: Event },
    /// Yes or no, with the reason.
    Whether { right: bool, why: Vec<String>, hints: Vec<Hint> },
    /// A number, with the reason.
    Count { right: u32, why: Vec<String> },
    /// The class of a frontal angle.
    Angle { node: NodeId, theta: f64, corner: Corner },
}

/// A question at a state of a run: the right answer is known, and any answer can be judged.
#[derive(Clone, Debug)]
pub struct Asked {
    /// What is asked.
    pub kind: Kind,
    /// The step of the state at which it is asked.
    pub step: u64,
    /// What it is about, where it names that.
    pub of: Option<Watched>,
    /// The rule that it is about.
    pub rule: Rule,
    /// Where on the mesh it is, as the nodes that a view has to show.
    pub place: Vec<NodeId>,
    looked_at: LookedAt,
    matter: Matter,
}

impl Asked {
    /// The question of a kind at the current state; `of` is what it is about, where it names that. The current state is
    /// the same afterwards.
    ///
    /// # Errors
    /// The state, or the step that follows it, does not answer such a question; a step of the replay failed.
    pub fn of(history: &mut History, kind: Kind, of: Option<Watched>) -> Result<Asked, Fault> {
        let step = history.step();
        let looked_at = history.state().looks_at();
        let matter = match (kind.is_of_state(), of) {
            (true, Some(subject)) => of_the_state(history.state(), kind, subject)?,
            (true, None) => {
                return Err(Fault::new(format!("A question of the kind {} says what it is about", kind.name()))
                    .of_kind(FaultKind::Parameter)
                    .remedy("Write for example of: \"7-4\""));
            }
            (false, Some(_)) => {
                return Err(Fault::new(format!("A question of the kind {} is about the next step", kind.name()))
                    .of_kind(FaultKind::Parameter)
                    .remedy("Leave \"of\" out"));
            }
            (false, None) => of_the_step(history, kind, &looked_at)?,
        };
        let event = if kind.is_of_state() { None } else { history.event(step + 1)? };
        let mesh = &history.state().mesh;
        let place = match (&matter, &event, of) {
            (Matter::Segment { selecting, .. } | Matter::Class { selecting, .. }, ..) => place::of_selection(selecting),
            (_, Some(event), _) => place::of_step(mesh, event, &looked_at),
            (_, None, Some(subject)) => place::of_subject(mesh, subject),
            (_, None, None) => Vec::new(),
        };
        Ok(Asked { kind, step, of, rule: kind.rule(event.as_ref()), place, looked_at, matter })
    }

    /// The kinds of questions that the next step answers at the current state, in the order of [`Kind::ALL`].
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn kinds_at(history: &mut History) -> Result<Vec<Kind>, Fault> {
        let step = history.step();
        history.extend(step + 1);
        let Some(event) = history.event(step + 1)? else { return Ok(Vec::new()) };
        let phase = history.state().phase();
        Ok(Kind::ALL.into_iter().filter(|kind| kind.is_answered_by(phase, &event)).collect())
    }

    /// The right answer.
    pub fn answer(&self) -> Answer {
        match &self.matter {
            Matter::Segment { right, .. }
            | Matter::Side { right }
            | Matter::Across { right }
            | Matter::Beside { right } => Answer::Edge(*right),
            Matter::Class { selecting, base: [a, b] } => {
                let class = selecting.table.find(*a, *b).map_or(4, |row| row.class);
                Answer::Choice(Choice::of_class(class))
            }
            Matter::Node { right, .. } => Answer::Node(*right),
            Matter::Top { event } => Answer::Choice(top::right(event)),
            Matter::Whether { right, .. } => Answer::Choice(Choice::of(*right)),
            Matter::Count { right, .. } => Answer::Number(*right),
            Matter::Angle { corner, .. } => Answer::Choice(entity::right_angle_class(*corner)),
        }
    }

    /// Judges an answer at the state of the question.
    ///
    /// # Errors
    /// Another state, or an answer of another kind: an edge where a choice is asked for.
    pub fn judge(&self, state: &Converter<'_>, answer: Answer) -> Result<Judged, Fault> {
        if state.counts.steps != self.step {
            return Err(
                Fault::new(format!("This question is asked at step {}", self.step)).of_kind(FaultKind::Parameter)
            );
        }
        let mesh = &state.mesh;
        let named: &[NodeId] = match &answer {
            Answer::Edge(ends) => ends,
            Answer::Node(node) => std::slice::from_ref(node),
            Answer::Choice(_) | Answer::Number(_) => &[],
        };
        // What is not there is a slip of the pen and no answer.
        let absent = named.iter().find(|node| !mesh.has_node(**node)).map(|node| format!("node {}", node.0));
        let absent = absent.or_else(|| {
            let must_be = matches!(self.matter, Matter::Segment { .. } | Matter::Across { .. } | Matter::Beside { .. });
            let Answer::Edge([a, b]) = answer else { return None };
            let is_there = mesh.half_edge_between(a, b).or_else(|| mesh.half_edge_between(b, a)).is_some();
            (must_be && !is_there).then(|| format!("edge {}", edge([a, b])))
        });
        if let Some(absent) = absent {
            return Err(Fault::new(format!("There is no {absent} at this step")).of_kind(FaultKind::Parameter));
        }
        let judged = match (&self.matter, answer) {
            (Matter::Segment { selecting, right }, Answer::Edge(ends)) => {
                selection::segment_is_next(selecting, state, *right, ends)
            }
            (Matter::Class { selecting, base }, Answer::Choice(choice)) => {
                selection::class_is(selecting, *base, choice)
            }
            (Matter::Side { .. }, Answer::Edge(ends)) => match (&self.looked_at.candidates, &self.looked_at.base) {
                (Some(tried), Some(base)) => side::edge_is_side(tried, base, ends),
                _ => return Err(self.other_answer()),
            },
            // A side is known by its top.
            (Matter::Side { .. }, Answer::Node(top)) => match (&self.looked_at.candidates, &self.looked_at.base) {
                (Some(tried), Some(base)) => side::edge_is_side(tried, base, [base.node(tried.side), top]),
                _ => return Err(self.other_answer()),
            },
            (Matter::Across { right }, Answer::Edge(ends)) => {
                let (line, crossings) = self.across();
                top::edge_is_swapped(mesh, line, crossings, *right, ends)
            }
            (Matter::Beside { right }, Answer::Edge(ends)) => around::edge_is_swapped(mesh, *right, ends),
            (Matter::Node { right, purpose }, Answer::Node(node)) => {
                around::node_is_removed(mesh, *right, *purpose, node)
            }
            (Matter::Top { event }, Answer::Choice(choice)) => {
                let (line, crossings) = self.across();
                let why = match event {
                    Event::RolledBack { .. } => narration(event, None),
                    _ => top::why(mesh, line, crossings, event),
                };
                Judged::of(choice == top::right(event), self.rule, vec![why])
            }
            (Matter::Whether { right, why, .. }, Answer::Choice(choice)) => {
                Judged::of(choice == Choice::of(*right), self.rule, why.clone())
            }
            (Matter::Count { right, why }, Answer::Number(number)) => {
                Judged::of(number == *right, self.rule, why.clone())
            }
            (Matter::Angle { node, theta, corner }, Answer::Choice(choice)) => {
                entity::angle_is(*node, (*theta, *corner), &self.looked_at.parameters, choice)
            }
            _ => return Err(self.other_answer()),
        };
        Ok(judged)
    }

    /// Hints, the first one weak, the last one strong.
    pub fn hints(&self, state: &Converter<'_>) -> Vec<Hint> {
        let mesh = &state.mesh;
        match &self.matter {
            Matter::Segment { selecting, .. } => selection::hints_to_segment(selecting),
            Matter::Class { selecting, base } => selection::hints_to_class(selecting, *base),
            Matter::Side { .. } => match (&self.looked_at.candidates, &self.looked_at.base) {
                (Some(tried), Some(base)) => side::hints(tried, base),
                _ => Vec::new(),
            },
            Matter::Across { .. } | Matter::Top { .. } => {
                let (line, crossings) = self.across();
                top::hints(mesh, line, crossings)
            }
            Matter::Beside { .. } => around::hints_to_swap(mesh, state.phase().last_formed()),
            Matter::Node { .. } => around::hints_to_node(),
            Matter::Angle { node, theta, .. } => entity::hints_to_angle(*node, *theta, &self.looked_at.parameters),
            Matter::Whether { hints, .. } => hints.clone(),
            Matter::Count { .. } => {
                vec![Hint::of("Count the triangles between the base, both sides and the top.")]
            }
        }
    }

    /// The top edge and what lies across it.
    fn across(&self) -> ([NodeId; 2], &[[NodeId; 2]]) {
        match (&self.looked_at.top, &self.matter) {
            (Some((line, crossings)), _) => (*line, crossings),
            // The edge is there, or a dead edge or a node lies on it.
            (None, Matter::Top { event: Event::TopFound { ends, .. } }) => (*ends, &[]),
            (None, _) => ([NodeId(0); 2], &[]),
        }
    }

    fn other_answer(&self) -> Fault {
        let choices: Vec<&str> = self.kind.choices().iter().map(|choice| choice.name()).collect();
        let what = match self.kind {
            Kind::Segment | Kind::Edge => "an edge, such as 12-40".to_owned(),
            Kind::Node => "a node".to_owned(),
            Kind::Count => "a number".to_owned(),
            _ => format!("one of {}", choices.join(", ")),
        };
        Fault::new(format!("A question of the kind {} is answered by {what}", self.kind.name()))
            .of_kind(FaultKind::Parameter)
    }
}

/// What decides about yes and no, with its bounds.
fn bounds(event: &Event, before: &LookedAt) -> String {
    let parameters = &before.parameters;
    match event {
        Event::Seamed { corner, .. } | Event::TransitionSeamed { corner, .. } | Event::SeamRefused { corner, .. } => {
            format!(
                "The angle is {}\u{b0}, and up to {}\u{b0} may be seamed here, if no element is turned over or \
                 becomes too poor.",
                degrees(corner.angle),
                degrees(corner.widest)
            )
        }
        event if event.is_about_a_split() => format!(
            "A split needs a triangle of a metric area below \u{3b5}_{{1}} = {}, more than \u{3b5}_{{2}} = {} times \
             as wide as high, and two even loops.",
            parameters.eps1, parameters.eps2
        ),
        _ => {
            let [gates, _] = before.gates;
            format!(
                "It must be strictly convex, of a quality of at least {}, with no new edge longer than {}, and \
                 every loop must stay even.",
                gates.quality,
                fixed(gates.length, 1)
            )
        }
    }
}

/// A question that the state answers.
fn of_the_state(state: &Converter<'_>, kind: Kind, subject: Watched) -> Result<Matter, Fault> {
    let mesh = &state.mesh;
    if kind == Kind::Angle {
        let (theta, corner) = entity::angle(mesh, state.parameters(), subject)?;
        let Watched::Node(node) = subject else { return Err(Fault::new("Only a node has a frontal angle")) };
        return Ok(Matter::Angle { node, theta, corner });
    }
    let (right, why) = entity::live(mesh, subject).ok_or_else(|| {
        Fault::new("What the question is about is no edge or element of this step")
            .of_kind(FaultKind::Parameter)
            .remedy("Write for example of: \"7-4\" or of: \"triangle 3\"")
    })?;
    Ok(Matter::Whether { right, why: vec![why], hints: entity::hints_to_live() })
}

/// A question that the next step answers.
fn of_the_step(history: &mut History, kind: Kind, looked_at: &LookedAt) -> Result<Matter, Fault> {
    let step = history.step();
    history.extend(step + 1);
    let event = history.event(step + 1)?;
    let fault = |then: &str| {
        Fault::new(format!("Nothing answers a question of the kind {} at step {step}: {then}", kind.name()))
            .of_kind(FaultKind::Parameter)
            .remedy(format!("Ask it {}", kind.asks_before()))
    };
    let Some(event) = event else { return Err(fault("no step follows")) };
    if !kind.is_answered_by(history.state().phase(), &event) {
        return Err(fault(&format!("the next step is {}", event.kind())));
    }
    let none = || fault("the state does not say what is chosen");
    let base = looked_at.base.map(|base| [base.a, base.b]);
    Ok(match (kind, event) {
        (Kind::Segment, Event::BaseSelected { a, b, .. }) => {
            Matter::Segment { selecting: history.selecting()?, right: [a, b] }
        }
        (Kind::Class, Event::BaseSelected { a, b, .. }) => {
            Matter::Class { selecting: history.selecting()?, base: [a, b] }
        }
        (Kind::Edge, Event::TopSwapped { across, .. }) => Matter::Across { right: across },
        (Kind::Edge, Event::Enhanced { new }) => {
            Matter::Beside { right: around::swapped(&history.state().mesh, new).ok_or_else(none)? }
        }
        (Kind::Edge, _) => {
            let right = looked_at.candidates.as_ref().zip(looked_at.base.as_ref());
            Matter::Side { right: right.and_then(|(tried, base)| side::right(tried, base)).ok_or_else(none)? }
        }
        (Kind::Node, Event::NodeRemoved { node, purpose }) => Matter::Node { right: node, purpose },
        (Kind::Top, event) => Matter::Top { event },
        (Kind::Count, Event::Formed { merged, .. }) => {
            Matter::Count { right: merged.into(), why: vec![narration(&event, base)] }
        }
        (_, event) => {
            let right = matches!(
                event,
                Event::Formed { .. } | Event::Seamed { .. } | Event::TransitionSeamed { .. } | Event::Split { .. }
            );
            let hints = vec![Hint::of(bounds(&event, looked_at))];
            Matter::Whether { right, why: reasons(history, &event, base, looked_at)?, hints }
        }
    })
}

/// What a step did, and what decided it: the sentence of its narration, and the first that tells its numbers.
fn reasons(
    history: &mut History,
    event: &Event,
    base: Option<[NodeId; 2]>,
    before: &LookedAt,
) -> Result<Vec<String>, Fault> {
    let step = history.step();
    history.seek(step + 1)?;
    let told = about(event, before, history.state());
    history.seek(step)?;
    let mut why = vec![narration(event, base)];
    why.extend(told.get(decisive(event, before, told.len())).cloned());
    Ok(why)
}

/// The place of the sentence that tells what decided. Of a split the last sentences are about the slender triangles,
/// one each, and the first triangle with a side that splits the front decides; without one, the first.
fn decisive(event: &Event, before: &LookedAt, sentences: usize) -> usize {
    let Some(narrow) = before.narrow.as_ref().filter(|_| event.is_about_a_split()) else { return 0 };
    let splits = narrow.slender.iter().position(|slender| slender.sides.iter().any(|side| side.splits()));
    (sentences + splits.unwrap_or(0)).saturating_sub(narrow.slender.len())
}
