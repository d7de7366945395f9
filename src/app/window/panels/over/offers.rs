//! What the list of all commands offers beside those that are always there: commands that are typed with a value, and
//! what can be done in the panels at hand, so that everything is reached by keys.

use crate::app::window::command::Command;
use crate::app::window::session::{Goal, Source};
use crate::app::window::state::{Lookup, State};
use crate::app::window::study::StudyCommand;
use crate::app::window::sweep::SweepCommand;
use crate::app::window::words;
use crate::core::case::Parameters;
use crate::core::question::Answer;
use crate::core::run::explain;
use crate::core::run::{Condition, EditKind};
use crate::render::scene::Outlined;

/// How a breakpoint is typed, before its condition.
const BREAK: &str = "break where ";
/// How an answer to a question is typed, and a series of questions.
const ANSWER: &str = "answer ";
const PREDICT: &str = "predict ";

/// The command that a text stands for with a value: `c = 1.5` or `set c = 1.5`, `break where quad.min_angle < 30`,
/// `answer 12-40`, `predict seed=7,count=10`.
pub fn typed(text: &str) -> Option<Command> {
    let text = text.trim();
    let behind = |words: &str| {
        let start = text.get(..words.len())?;
        start.eq_ignore_ascii_case(words).then(|| text[words.len()..].trim())
    };
    if let Some(condition) = behind(BREAK) {
        return Condition::parse(condition).ok().map(|_| Command::AddBreakpoint(condition.to_owned()));
    }
    if let Some(answer) = behind(ANSWER) {
        return Some(Command::Study(StudyCommand::AnswerText(answer.to_owned())));
    }
    if let Some(series) = behind(PREDICT).filter(|series| series.contains('=')) {
        return series.parse().ok().map(|series| Command::Study(StudyCommand::PredictSeries(series)));
    }
    let (key, value) = text.split_once('=')?;
    let key = key.trim();
    let key = key.strip_prefix("set ").or_else(|| key.strip_prefix("Set ")).unwrap_or(key).trim();
    let (key, value) = (Parameters::KEYS.into_iter().find(|known| *known == key)?, value.trim());
    if EditKind::parameter(key, value).is_ok() {
        return Some(Command::Set(key, value.to_owned()));
    }
    // One that belongs to the case.
    Parameters::default().set(key, value).ok().map(|()| Command::SetForCase(key, value.to_owned()))
}

/// What can be done in the panels at hand, with its name; `state` is the run that they show.
pub fn at_hand(window: &State, state: &State) -> Vec<(String, Command)> {
    let mut all = Vec::new();
    if let Some((offer, _)) = window.run().autosave.as_ref().and_then(|autosave| autosave.offer()) {
        let kept = offer.opens.then_some(Command::OpenKept).into_iter().chain([Command::DiscardKept]);
        all.extend(kept.map(|command| (command.name(), command)));
    }
    if let Some(import) = &window.run().import {
        all.extend(import.is_ready().then(|| ("Convert the mesh".to_owned(), Command::Convert)));
        all.push(("Cancel the import".to_owned(), Command::CancelImport));
    }
    if let Some(posed) = state.open_question() {
        let choices = posed.asked.kind.choices().iter();
        let answer = |choice| Command::Study(StudyCommand::Answer(Answer::Choice(choice)));
        all.extend(choices.map(|choice| (format!("Answer: {}", explain::plain(choice.words())), answer(*choice))));
    }
    let step = |step: u64| Command::Go(Goal::Step(step));
    if let Some(Outlined::Element(element)) = state.document().picked
        && let Lookup::Known(told) = state.run().chain(element)
        && let Some(chain) = &told.chain
    {
        let name = |n, text: &str| format!("Chain, step {}: {}", words::grouped(n), explain::plain(text));
        all.extend(chain.links.iter().map(|link| (name(link.step, &link.text), step(link.step))));
    }
    for tried in state.run().moment.iter().flat_map(|moment| &moment.attempts) {
        let name = format!("Attempt {}: {}", u32::from(tried.attempt.number) + 1, explain::attempt(&tried.attempt));
        all.extend(tried.steps.first().map(|first| (name, step(first.0))));
    }
    let marks = state.document().bookmarks.iter();
    all.extend(
        marks.map(|mark| (format!("Go to the bookmark of step {}", words::grouped(mark.step)), step(mark.step))),
    );
    for (k, breakpoint) in state.document().breakpoints.iter().enumerate() {
        all.push((format!("Reduce this: {}", breakpoint.condition), Command::Reduce(k)));
        all.push((format!("Remove the breakpoint: {}", breakpoint.condition), Command::RemoveBreakpoint(k)));
    }
    if let Some(reducing) = state.reducing() {
        if reducing.is_running() {
            all.push((Command::StopReducing.name(), Command::StopReducing));
        } else if reducing.is_done {
            let open = Command::Open(Source::File(reducing.path.clone()));
            all.push((open.name(), open));
        }
    }
    if let Some(sweep) = window.sweep().and_then(|work| work.sweep.as_ref()) {
        for cell in 0..sweep.cells().len() {
            let open = Command::Sweep(SweepCommand::OpenBeside(cell));
            all.push((format!("Open {} as second run", sweep.name(cell)), open));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_conditions_are_typed_behind_their_commands() {
        let set = |key, value: &str| Some(Command::Set(key, value.to_owned()));
        assert_eq!(typed("c = 1.5"), set("c", "1.5"));
        assert_eq!(typed(" set theta_rect=120 "), set("theta_rect", "120"));
        assert_eq!(typed("size_scale = .5"), Some(Command::SetForCase("size_scale", ".5".to_owned())));
        assert_eq!(typed("c = abc"), None, "it is not a number");
        assert_eq!(typed("q = 1"), None);
        assert_eq!(typed("c"), None);
        let stop = "quad.min_angle < 30 && kind == formed";
        assert_eq!(typed(&format!("Break where {stop}")), Some(Command::AddBreakpoint(stop.to_owned())));
        assert_eq!(typed("break where quad.min_angle <"), None, "the condition has no end");
        assert_eq!(typed("break where"), None);
        assert_eq!(typed("ü = é"), None);
        let study = |command| Some(Command::Study(command));
        assert_eq!(typed("Answer 12-40"), study(StudyCommand::AnswerText("12-40".to_owned())));
        let series = "seed=7,count=3".parse().unwrap();
        assert_eq!(typed("predict seed=7,count=3"), study(StudyCommand::PredictSeries(series)));
        assert_eq!([typed("predict seed=x"), typed("predict what"), typed("answer")], [None, None, None]);
    }
}
