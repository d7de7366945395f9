//! What a reduced case must still show: a condition on a step or on the end of its run.

use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::DVec3;

use super::failure::{Failure, Panic};
use crate::core::convert::{Converter, Event, conversion, walk::walk_editing};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::box_tree::extent;
use crate::core::kernel::condition::{self, Field, Holds, Value, fields};
use crate::core::mesh::Mesh;
use crate::core::progress::Cancel;
use crate::core::record::report::figures::{self, Figure};
use crate::core::record::{Export, Report};
use crate::core::run::breakpoint::{self, Condition, StepFacts};
use crate::core::run::{History, Run};

/// Steps looked at between two looks at the condition.
const STRETCH: u64 = 2048;

/// What is asked of a case.
#[derive(Clone, Debug)]
pub struct Question {
    text: String,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// A breakpoint condition holds after some step.
    Step(Condition),
    /// A condition holds at the end.
    End(condition::Condition),
    /// The program panics.
    Panics,
}

/// How a conversion ended.
pub(super) struct End {
    /// Why there is no mesh, or no valid one.
    fault: Option<Fault>,
    report: Option<Report>,
}

fields! {
    End;
    "refused": Holds::Flag, "no mesh is made: exit code 2" => |end| Some(Value::Flag(end.report.is_none()));
    "exit": Holds::Number, "exit code of convert: 0, 1 (the mesh is not valid) or 2" => |end| Value::number(end.exit());
}

/// Fields of a report that depend on the clock.
const TIMED: [&str; 1] = ["seconds"];

/// The fields of conditions on the end of a run.
pub fn end_fields() -> Vec<Field> {
    let figures = figures::fields().into_iter().filter(|figure| !TIMED.contains(&figure.name));
    FIELDS.iter().copied().chain(figures).collect()
}

/// What a case was found to show.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The first step at which the condition holds; `None` for the end of a run.
    pub step: Option<u64>,
    /// What was found, a sentence without its full stop.
    pub sentence: String,
    /// Steps made.
    pub steps: u64,
    /// Triangles of the background mesh; `None` where there is none.
    pub triangles: Option<u64>,
    /// The extent of the background mesh; 1 where there is none.
    pub extent: f64,
    /// Where it shows, in coordinates of the case.
    pub places: Vec<DVec3>,
    failure: Option<Failure>,
}

/// What may be spent on one case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    steps: u64,
    quads: Option<u64>,
}

impl Budget {
    /// For the first case, whose cost is not known.
    pub const UNLIMITED: Budget = Budget { steps: u64::MAX, quads: None };

    /// For cases that should cost no more than one in which this was found, with room for detours.
    pub fn like(finding: &Finding) -> Budget {
        let is_limit = finding.failure.as_ref().is_some_and(Failure::is_limit);
        let quads = 2 * finding.triangles.unwrap_or(50_000) + 10_000;
        Budget { steps: finding.steps.saturating_mul(2) + 1000, quads: (!is_limit).then_some(quads) }
    }
}

impl Question {
    /// Reads a question: a breakpoint condition, a condition on the end (`last_resort > 0`, `exit 1`, `is refused`), or
    /// `panics`.
    ///
    /// # Errors
    /// A syntax error or an unknown name, with its position and the nearest known name; fields of steps and of the end
    /// in one condition.
    pub fn parse(text: &str) -> Result<Question, Fault> {
        let text = text.trim();
        let kind = match text.split_whitespace().collect::<Vec<_>>().as_slice() {
            ["panics"] => Kind::Panics,
            ["is", "refused"] => Kind::End(condition::Condition::parse("refused", &end_fields())?),
            ["exit", code] if code.parse::<u8>().is_ok() => {
                Kind::End(condition::Condition::parse(&format!("exit == {code}"), &end_fields())?)
            }
            _ => Question::condition(text)?,
        };
        Ok(Question { text: text.to_owned(), kind })
    }

    fn condition(text: &str) -> Result<Kind, Fault> {
        if let Ok(condition) = Condition::parse(text) {
            return Ok(Kind::Step(condition));
        }
        let of_end = end_fields();
        if let Ok(condition) = condition::Condition::parse(text, &of_end) {
            return Ok(Kind::End(condition));
        }
        // The error that names the nearest field of either kind.
        let all: Vec<Field> = breakpoint::FIELDS.iter().copied().chain(of_end.iter().copied()).collect();
        condition::Condition::parse(text, &all)?;
        let first = |fields: &[Field]| named_in(text, fields).next().unwrap_or_default().to_owned();
        Err(Fault::new(format!(
            "{} is about a step, and {} about the end of a run",
            first(breakpoint::FIELDS),
            first(&of_end)
        ))
        .of_kind(FaultKind::Syntax)
        .remedy("Ask for one of them"))
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it asks for a panic, which is best looked for in another process.
    pub fn asks_for_a_panic(&self) -> bool {
        matches!(self.kind, Kind::Panics)
    }

    /// What a run shows; `None` where it does not show what is asked for, where that costs more than the budget, or
    /// where the program panics, unless that is what is asked for.
    ///
    /// # Errors
    /// The work was cancelled.
    pub fn find(&self, run: &Run, budget: Budget, cancel: &Cancel) -> Result<Option<Finding>, Fault> {
        let mut run = run.clone();
        if let Some(quads) = budget.quads {
            run.parameters.max_quads = run.parameters.max_quads.min(quads);
        }
        let found = catch_unwind(AssertUnwindSafe(|| match &self.kind {
            Kind::Step(condition) => find_step(condition, &run, budget, cancel),
            Kind::End(condition) => find_end(condition, self.text(), &run, budget, cancel),
            Kind::Panics => ended(&run, budget, cancel).map(|_| None),
        }));
        cancel.check()?;
        match found {
            Ok(Err(fault)) if fault.is_stop() => Err(fault),
            Ok(found) => Ok(found.unwrap_or_default()),
            Err(payload) if self.asks_for_a_panic() => Ok(Some(Finding::panic(&Panic::caught(&*payload)))),
            Err(_) => Ok(None),
        }
    }

    /// How the end of a run differs from what is asked for: the values of the figures that the question names, or why
    /// the case is refused.
    pub fn shown_instead(&self, run: &Run, cancel: &Cancel) -> Option<String> {
        let Kind::End(_) = self.kind else { return None };
        let (end, _) = ended(run, Budget::UNLIMITED, cancel).ok()?;
        Some(end.sentence(&self.text))
    }
}

impl Finding {
    /// A panic.
    pub fn panic(panic: &Panic) -> Finding {
        Finding {
            step: None,
            sentence: panic.sentence(),
            steps: 0,
            triangles: None,
            extent: 1.0,
            places: Vec::new(),
            failure: Some(Failure::of_panic(panic)),
        }
    }

    /// Whether another finding is of the same kind: a case that is refused for another reason, or a panic at another
    /// place, is another failure.
    pub fn is_like(&self, other: &Finding) -> bool {
        self.failure == other.failure
    }
}

impl End {
    fn exit(&self) -> u8 {
        match (&self.report, &self.fault) {
            (None, _) => 2,
            (Some(_), Some(_)) => 1,
            (Some(_), None) => 0,
        }
    }

    fn value(&self, fields: &[Field], field: usize) -> Option<Value> {
        match VALUES.get(field) {
            Some(of) => of(self),
            None => Figure::named(fields[field].name)?.of(self.report.as_ref()?).map(Value::Number),
        }
    }

    fn sentence(&self, text: &str) -> String {
        let fields = figures::fields();
        let figure = |name: &str| {
            let value = Figure::named(name)?.of(self.report.as_ref()?)?;
            Some(format!("{name} = {}", crate::core::kernel::decimal::number(value)))
        };
        let figures: Vec<String> = named_in(text, &fields).filter_map(figure).collect();
        match &self.fault {
            Some(fault) => fault.what.clone(),
            None if figures.is_empty() => "The case is converted to a valid mesh".to_owned(),
            None => format!("The run ends with {}", figures.join(", ")),
        }
    }
}

/// The names of fields that a condition has.
fn named_in<'t>(text: &'t str, fields: &'t [Field]) -> impl Iterator<Item = &'t str> {
    let words = text.split(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.')));
    words.filter(|word| fields.iter().any(|field| field.name == *word))
}

fn find_step(condition: &Condition, run: &Run, budget: Budget, cancel: &Cancel) -> Result<Option<Finding>, Fault> {
    let background = run.background(&mut cancel.clone())?;
    let (triangles, extent) = measured(&background.mesh);
    let mut history = History::of(run.clone(), &background, MEMORY)?;
    let mut from = 0;
    loop {
        cancel.check()?;
        history.extend((from + STRETCH).min(budget.steps));
        let known = history.log().known();
        let events = history.events(from + 1, known)?;
        let log = history.log();
        let facts = |step: u64, event| StepFacts {
            step,
            nq: log.nq(step),
            event,
            front: log.front(step),
            angles: log.angles(step),
        };
        let steps = (from + 1..).zip(&events);
        let found = steps.into_iter().find(|(step, event)| condition.holds(&facts(*step, event)));
        if let Some((step, event)) = found {
            let (sentence, event) = (sentence_of(step, log.nq(step), event, log.angles(step)), *event);
            history.seek(step)?;
            let places = places_of(&event, history.state());
            return Ok(Some(Finding {
                step: Some(step),
                sentence,
                steps: step,
                triangles: Some(triangles),
                extent,
                places,
                failure: None,
            }));
        }
        if known < from + STRETCH {
            return Ok(None);
        }
        from = known;
    }
}

/// Memory for the states of a run while it is searched.
const MEMORY: usize = 256 << 20;

fn sentence_of(step: u64, nq: u64, event: &Event, angles: Option<crate::core::run::Angles>) -> String {
    let kind = event.kind().name().replace('_', " ");
    let angles = angles.map_or_else(String::new, |angles| {
        format!(", angles {:.1}-{:.1} degrees", angles.min.to_degrees(), angles.max.to_degrees())
    });
    format!("It holds at step {step} ({kind}{angles}; nq = {nq})")
}

/// Where a step was at work: the nodes of the quadrilateral that it formed, or of its base segment.
fn places_of(event: &Event, state: &Converter<'_>) -> Vec<DVec3> {
    let mesh = &state.mesh;
    let nodes = match *event {
        Event::Formed { nodes, .. } => nodes.to_vec(),
        Event::BaseSelected { a, b, .. } => vec![a, b],
        _ => state.phase().base().map_or(Vec::new(), |base| vec![base.a, base.b]),
    };
    nodes.into_iter().filter(|&n| mesh.has_node(n)).map(|n| mesh.xyz(n)).collect()
}

fn find_end(
    condition: &condition::Condition,
    text: &str,
    run: &Run,
    budget: Budget,
    cancel: &Cancel,
) -> Result<Option<Finding>, Fault> {
    let (end, cost) = ended(run, budget, cancel)?;
    let fields = end_fields();
    if !condition.holds(|field| end.value(&fields, field)) {
        return Ok(None);
    }
    let mut places: Vec<DVec3> = end.fault.iter().flat_map(|fault| fault.shapes.iter().flatten().copied()).collect();
    if places.is_empty() {
        places = cost.worst;
    }
    Ok(Some(Finding {
        step: None,
        sentence: end.sentence(text),
        steps: cost.steps,
        triangles: cost.triangles,
        extent: cost.extent,
        places,
        failure: end.fault.as_ref().map(Failure::of_fault),
    }))
}

/// What the end of a run has cost.
struct Cost {
    steps: u64,
    triangles: Option<u64>,
    extent: f64,
    /// The corners of the element with the sharpest corner.
    worst: Vec<DVec3>,
}

/// The corners of the element with the sharpest corner in space.
fn worst(mesh: &Mesh) -> Vec<DVec3> {
    let corners = |e| mesh.corners(e).map(|n| mesh.xyz(n)).collect::<Vec<_>>();
    let sharpness = |corners: &[DVec3]| {
        let n = corners.len();
        let cosine = |i: usize| {
            let (a, b) = (corners[(i + 1) % n] - corners[i], corners[(i + n - 1) % n] - corners[i]);
            a.normalize_or(DVec3::ZERO).dot(b.normalize_or(DVec3::ZERO))
        };
        (0..n).map(cosine).fold(f64::NEG_INFINITY, f64::max)
    };
    mesh.elements().map(corners).max_by(|a, b| sharpness(a).total_cmp(&sharpness(b))).unwrap_or_default()
}

/// The number of elements of a mesh, and its extent.
fn measured(mesh: &Mesh) -> (u64, f64) {
    let (low, high) = extent(mesh.nodes().map(|n| mesh.xyz(n)));
    (mesh.element_count() as u64, (high - low).max_element())
}

/// The end of a run, and its cost.
///
/// # Errors
/// The work was cancelled, or cost more than the budget.
fn ended(run: &Run, budget: Budget, cancel: &Cancel) -> Result<(End, Cost), Fault> {
    let mut cost = Cost { steps: 0, triangles: None, extent: 1.0, worst: Vec::new() };
    let mut is_over = false;
    let case = run.case_in_force();
    let converted = conversion::convert_by(&case, &mut cancel.clone(), &mut |converter, watch| {
        let (triangles, extent) = measured(&converter.mesh);
        (cost.triangles, cost.extent) = (Some(triangles), extent);
        run.make_edits(converter, 0)?;
        walk_editing(converter, None, watch, None, &mut |c, _| {
            cost.steps = c.counts.steps;
            cancel.check()?;
            is_over = cost.steps > budget.steps;
            if is_over {
                return Err(Fault::new("It takes too long"));
            }
            run.make_edits(c, c.counts.steps)
        })
    });
    let end = match converted {
        Err(fault) if fault.is_stop() || is_over => return Err(fault),
        Err(fault) => End { fault: Some(fault), report: None },
        Ok(converted) => {
            cost.worst = worst(&converted.mesh);
            let export = Export::of(&converted.mesh, &converted.names);
            let flaw = export.flaw(&converted.mesh, false);
            let report = Report::of_export(&case, &converted, &export, flaw.is_none())?;
            End { fault: flaw, report: Some(report) }
        }
    };
    Ok((end, cost))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_question_is_about_a_step_the_end_or_a_panic() {
        let kind = |text: &str| match Question::parse(text).unwrap().kind {
            Kind::Step(_) => "step",
            Kind::End(_) => "end",
            Kind::Panics => "panic",
        };
        let questions =
            ["quad.min_angle < 10", "fallback", "is refused", "exit 1", "last_resort > 0 || refused", "panics"];
        assert_eq!(questions.map(kind), ["step", "step", "end", "end", "end", "panic"]);
        let message = Question::parse("seconds > 1").unwrap_err().to_string();
        assert!(message.contains("\"seconds\" does not exist"), "time would make the result depend on the machine");
    }
}
