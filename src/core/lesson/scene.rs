//! A part of a lesson at its state: the step, what is framed and lit, the text with its numbers, and its questions.

use super::parts::Part;
use super::subject::Subject;
use super::text::{Block, Piece};
use super::things::{Things, watched};
use super::value::Quantity;
use super::{Equation, Go, Lesson, Names};
use crate::core::convert::EventKind;
use crate::core::fault::Fault;
use crate::core::question::Asked;
use crate::core::run::explain::{beginning, event as said, narration};
use crate::core::run::{History, Watched};

/// A piece of text, shown at a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The text, with numbers put in; it may have the markup of `run/explain`.
    pub text: String,
    /// How it is written.
    pub piece: Piece,
    /// What it lights; `None` where it lights nothing.
    pub lights: Option<Things>,
}

/// A part at its state.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The step at which it stands.
    pub step: u64,
    /// What the step did, in a sentence.
    pub narration: String,
    /// What is framed; empty: the whole mesh.
    pub frame: Things,
    /// What is lit.
    pub light: Things,
    /// The pieces of text of each block.
    pub text: Vec<Vec<Shown>>,
    /// The equation of each block that is one, with its numbers put in.
    pub equations: Vec<Option<Equation>>,
    /// Its questions, in its order.
    pub asked: Vec<Asked>,
}

impl Lesson {
    /// The step at which a part stands: where it says, or where the part before it does.
    ///
    /// # Errors
    /// The run has no such place.
    pub fn step_of(&self, part: usize, history: &mut History) -> Result<u64, Fault> {
        let until = &self.parts[..self.parts.len().min(part + 1)];
        let Some((part, go)) = until.iter().rev().find_map(|part| Some((part, part.go?))) else { return Ok(0) };
        go.resolve(history).map_err(|fault| fault.at(self.place(part.line)))
    }

    /// Whether a part stands at the end of the run, which is known only once all of it is recorded.
    pub fn stands_at_the_end(&self, part: usize) -> bool {
        let until = &self.parts[..self.parts.len().min(part + 1)];
        until.iter().rev().find_map(|part| part.go) == Some(Go::End)
    }

    /// A part at its state, which is then the current one of the history.
    ///
    /// # Errors
    /// With its line: a place that the run does not have, names that mean nothing there, a question that nothing
    /// answers there; a step that fails.
    pub fn scene(&self, part: usize, history: &mut History) -> Result<Scene, Fault> {
        let step = self.step_of(part, history)?;
        let Some(part) = self.parts.get(part) else { return Err(Fault::new("The lesson has no such part")) };
        let here = |fault: Fault| fault.at(self.place(part.line));
        history.seek(step).map_err(here)?;
        let mut scene = of_state(part, history).map_err(here)?;
        for ask in &part.asks {
            let here = |fault: Fault| fault.at(self.place(ask.line));
            let of = ask.of.as_ref().map(|names| about(names, history)).transpose().map_err(here)?;
            scene.asked.push(Asked::of(history, ask.kind, of).map_err(here)?);
        }
        Ok(scene)
    }

    /// Every part at its state.
    ///
    /// # Errors
    /// As [`Lesson::scene`].
    pub fn scenes(&self, history: &mut History) -> Result<Vec<Scene>, Fault> {
        (0..self.parts.len()).map(|part| self.scene(part, history)).collect()
    }

    fn place(&self, line: usize) -> String {
        format!("{}, line {line}", self.file)
    }
}

fn about(names: &Names, history: &mut History) -> Result<Watched, Fault> {
    watched(names, &Subject::of(history)?)
}

/// A part at the current state, without its questions.
fn of_state(part: &Part, history: &mut History) -> Result<Scene, Fault> {
    let step = history.step();
    let subject = Subject::of(history)?;
    let named = |names: &Option<Names>| match names {
        Some(names) => Things::named(names, &subject),
        None => Ok(Things::default()),
    };
    let (frame, light) = (named(&part.frame)?, named(&part.light)?);
    let number = |quantity: Quantity| {
        quantity.text(&subject).ok_or_else(|| {
            Fault::new(format!("At step {step} there is no {}", quantity.name())).remedy("Go to another step")
        })
    };
    let show = |piece: &Piece| -> Result<Shown, Fault> {
        let (text, lights) = match piece {
            Piece::Plain(text) | Piece::Emphasis(text) | Piece::Code(text) => (text.clone(), None),
            Piece::Lit(text) => (text.clone(), Some(light.clone())),
            Piece::Named(text, names) => (text.clone(), Some(Things::named(names, &subject)?)),
            Piece::Value(quantity) | Piece::LitValue(quantity) => {
                (number(*quantity)?, matches!(piece, Piece::LitValue(_)).then(|| light.clone()))
            }
        };
        Ok(Shown { text, piece: piece.clone(), lights })
    };
    let shown = |block: &Block| block.pieces().iter().map(show).collect::<Result<Vec<_>, _>>();
    let text = part.blocks.iter().map(shown).collect::<Result<_, _>>()?;
    let equation = |block: &Block| match block {
        Block::Equation { equation, .. } => equation.with_numbers(number).map(Some),
        Block::Paragraph(_) | Block::Item(_) => Ok(None),
    };
    let equations = part.blocks.iter().map(equation).collect::<Result<_, _>>()?;
    let narration = match &subject.last {
        Some(event) => narration(event, subject.base()),
        None => beginning(&subject.state.mesh),
    };
    Ok(Scene { step, narration, frame, light, text, equations, asked: Vec::new() })
}

/// A step that led to a state, for a list of where one is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// The step.
    pub step: u64,
    /// What it did, in one line.
    pub text: String,
}

/// The steps since the base of the quadrilateral under way, or of the last one, was selected, up to the current state.
///
/// # Errors
/// A step of the replay failed.
pub fn decisions(history: &History) -> Result<Vec<Decision>, Fault> {
    let step = history.step();
    let from = history.log().last_of(step, |kind| kind == EventKind::BaseSelected).unwrap_or(1);
    if step < from {
        return Ok(Vec::new());
    }
    let events = history.events(from, step)?;
    Ok((from..).zip(&events).map(|(step, event)| Decision { step, text: said(event) }).collect())
}
