//! Lessons and predictions: what the learner asks for.

use super::State;
use crate::app::command_line::Overrides;
use crate::app::window::command::Command;
use crate::app::window::files;
use crate::app::window::session::{Ask, Goal, Source};
use crate::app::window::state::Wanted;
use crate::app::window::study::{Study, StudyCommand, Subject, answer_of};
use crate::core::formats::save::save;
use crate::core::lesson::built_in::LESSONS;
use crate::core::mesh::NodeId;
use crate::core::question::{Answer, Kind, Series};
use crate::core::run::explain::plain;
use crate::render::scene::Decision;

impl State {
    /// Does what the learner asks for.
    pub(super) fn apply_to_study(&mut self, command: StudyCommand) {
        match command {
            StudyCommand::Open(name) => self.open(Source::Lesson(name.to_owned()), Overrides::default()),
            StudyCommand::Resume => {
                let (name, part) = self.workspace.learned.next();
                self.open(Source::Lesson(name.to_owned()), Overrides::default());
                self.wanted = Some(Wanted::Part(part));
            }
            StudyCommand::Predict => self.predict(),
            // The run that is asked about is the one that is being opened.
            StudyCommand::PredictSeries(series) if self.run.is_opening() || self.run.import.is_some() => {
                self.wanted = Some(Wanted::Series(series));
            }
            StudyCommand::PredictSeries(series) => self.predict_series(series),
            StudyCommand::PointAt(things) => self.frame.pointed = things,
            StudyCommand::TellDecisions => {
                let asked = self.inquire(Ask::Decisions);
                if let Some(study) = &mut self.study {
                    study.asked_decisions = asked;
                }
            }
            _ if self.study.is_none() => {
                self.notice("No lesson is open, and nothing is predicted: see the menu Learn.".to_owned());
            }
            StudyCommand::Continue => self.continue_study(),
            StudyCommand::PartBack => {
                if let Some(part) = self.lesson_part().and_then(|part| part.checked_sub(1)) {
                    self.teach(part);
                }
            }
            StudyCommand::Part(part) => self.teach(part),
            StudyCommand::Answer(answer) => self.answer(answer, false),
            StudyCommand::AnswerText(text) => self.answer_text(&text),
            StudyCommand::Hint => self.change_study(|study| {
                let all = study.posed().map_or(0, |posed| posed.hints.len());
                study.hints = (study.hints + 1).min(all);
            }),
            StudyCommand::Explore => {
                let explores = self.study.as_mut().is_some_and(|study| {
                    study.explores = !study.explores;
                    study.explores
                });
                if !explores {
                    self.return_to_study();
                }
                self.view.over_epoch += 1;
            }
            StudyCommand::Return => self.return_to_study(),
            StudyCommand::Save => self.save_answers(),
            StudyCommand::Leave => {
                self.study = None;
                self.view.over_epoch += 1;
            }
        }
    }

    /// A click that answers the question at hand; other commands stay what they are.
    pub(super) fn as_answer(&mut self, command: Command) -> Option<Command> {
        let Command::Pick(Some(what)) = command else { return Some(command) };
        let Some(kind) = self.open_question().map(|posed| posed.asked.kind) else { return Some(command) };
        match answer_of(kind, what) {
            Ok(answer) => Some(Command::Study(StudyCommand::Answer(answer))),
            Err(remark) => {
                self.change_study(|study| study.remark = Some(remark.to_owned()));
                None
            }
        }
    }

    /// The part of the lesson that is open.
    fn lesson_part(&self) -> Option<usize> {
        self.study.as_ref()?.lesson().map(|(_, part)| part)
    }

    fn change_study(&mut self, change: impl FnOnce(&mut Study)) {
        if let Some(study) = &mut self.study {
            change(study);
            self.view.over_epoch += 1;
        }
    }

    /// Goes to a part of the lesson.
    pub(in crate::app::window::state) fn teach(&mut self, part: usize) {
        let Some(study) = &mut self.study else { return };
        let Subject::Lesson { lesson, source, part: at } = &mut study.subject else { return };
        if !matches!(&self.run.source, Some(Source::Lesson(name)) if name == source) {
            // A link has brought the lesson beside another run.
            let own = Source::Lesson(source.clone());
            self.open(own, Overrides::default());
            self.wanted = Some(Wanted::Part(part));
            return;
        }
        *at = part.min(lesson.parts.len() - 1);
        let ask = Ask::Part(lesson.clone(), *at);
        self.workspace.learned.be_at(source, *at);
        study.taught = None;
        study.pose(0);
        self.ask(ask);
    }

    /// Goes to the next question, part or lesson.
    fn continue_study(&mut self) {
        let Some(study) = self.study.as_mut().filter(|study| !study.explores) else { return };
        // What comes next is on its way.
        let Some(taught) = study.taught.clone() else { return };
        // Nothing is left behind unanswered: the answer is shown before one goes on.
        if let Some(posed) = study.posed().filter(|_| study.is_asking()) {
            let right = posed.asked.answer();
            return self.answer(right, true);
        }
        if study.question + 1 < taught.posed.len() {
            return self.change_study(|study| study.pose(study.question + 1));
        }
        let ask = match &mut study.subject {
            Subject::Lesson { lesson, part, .. } if *part + 1 < lesson.parts.len() => {
                let next = *part + 1;
                return self.teach(next);
            }
            Subject::Lesson { .. } => return self.finish_lesson(),
            Subject::Prediction { series: None, .. } => Ask::NextQuestion(taught.step + 1),
            Subject::Prediction { drawn, at, .. } if *at + 1 < drawn.len() => {
                *at += 1;
                Ask::Question(drawn[*at])
            }
            Subject::Prediction { .. } => return self.change_study(|study| study.is_over = true),
        };
        study.taught = None;
        study.pose(0);
        self.ask(ask);
    }

    /// The last part of a lesson is left: the next one of the tour follows.
    fn finish_lesson(&mut self) {
        let Some(study) = &self.study else { return };
        let Subject::Lesson { source, .. } = &study.subject else { return };
        self.workspace.learned.finish(source);
        match study.tour_place().map(|at| LESSONS.get(at + 1)) {
            Some(Some((next, _))) => self.open(Source::Lesson((*next).to_owned()), Overrides::default()),
            is_last => {
                let what = if is_last.is_some() { "The tour is done" } else { "The lesson is done" };
                self.notice(format!("{what}. The menu Learn has predictions for any run."));
                self.change_study(|study| study.explores = true);
            }
        }
    }

    /// Asks what comes next, from the current step on.
    fn predict(&mut self) {
        let Some(step) = self.run.moment.as_ref().map(|moment| moment.step) else { return };
        self.run.playing = None;
        self.study = Some(Study::of(Subject::Prediction { series: None, drawn: Vec::new(), at: 0 }));
        self.ask(Ask::NextQuestion(step));
    }

    /// Asks the questions of a series.
    pub(in crate::app::window::state) fn predict_series(&mut self, series: Series) {
        self.run.playing = None;
        if let Some(session) = &self.run.session {
            session.ask(Ask::Draw(series.clone()));
            let subject = Subject::Prediction { series: Some(series), drawn: Vec::new(), at: 0 };
            self.study = Some(Study::of(subject));
        }
    }

    /// Has an answer to the question at hand judged.
    fn answer(&mut self, answer: Answer, is_shown: bool) {
        let Some(asked) = self.open_question().map(|posed| posed.asked.clone()) else {
            let is_asking = self.study.as_ref().is_some_and(Study::is_asking);
            if is_asking {
                self.notice("The question is about another step: go back to it first.".to_owned());
            }
            return;
        };
        let Some((study, session)) = self.study.as_mut().zip(self.run.session.as_ref()) else { return };
        if study.judging.is_none() && !study.tries.iter().any(|one| one.answer == answer) {
            study.judging = Some(is_shown);
            study.remark = None;
            session.ask(Ask::Judge(asked, answer));
        }
    }

    fn answer_text(&mut self, text: &str) {
        let Some(kind) = self.open_question().map(|posed| posed.asked.kind) else { return };
        // Nodes of the quadrilateral under way may be called by their letters.
        let letters: Vec<(NodeId, char)> = self
            .run
            .moment
            .iter()
            .flat_map(|moment| Decision::of(&moment.phase).letters().collect::<Vec<_>>())
            .collect();
        let numbered = |part: &str| {
            let named = letters.iter().find(|(_, letter)| part.trim().eq_ignore_ascii_case(&letter.to_string()));
            named.map_or_else(|| part.to_owned(), |(node, _)| node.0.to_string())
        };
        let text = match kind {
            Kind::Segment | Kind::Edge | Kind::Node => text.split('-').map(numbered).collect::<Vec<_>>().join("-"),
            _ => text.to_owned(),
        };
        match Answer::parse(kind, &text) {
            Ok(answer) => self.answer(answer, false),
            Err(fault) => self.change_study(|study| study.remark = Some(plain(&fault.to_string()))),
        }
    }

    /// Goes back to the state that is spoken of, in the run of the lesson.
    fn return_to_study(&mut self) {
        let Some(study) = &mut self.study else { return };
        study.frames += 1;
        let step = study.taught.as_ref().map(|taught| taught.step);
        let is_lesson = matches!(&self.run.source, Some(Source::Lesson(_)));
        let own = self.run.opened.as_ref().map(|opened| opened.run.edits().to_vec());
        if let Some(own) = own.filter(|own| is_lesson && *own != self.document().edits) {
            self.change(|document| document.edits = own);
            self.notice("The run is that of the lesson again; Ctrl+Z takes your changes back.".to_owned());
        }
        match (step, self.lesson_part()) {
            (Some(step), _) => self.go(Goal::Step(step)),
            (None, Some(part)) => self.teach(part),
            (None, None) => self.predict_anew(),
        }
    }

    /// The run has other edits: what was told or asked of it is no longer true. A lesson is left for the whole window
    /// until its own run is there again; a prediction is asked anew when the learner comes back.
    pub(super) fn leave_changed_run(&mut self) {
        let own = self.run.opened.as_ref().map(|opened| opened.run.edits());
        let is_own = own == Some(&self.workspace.document.edits[..]);
        let Some(study) = &mut self.study else { return };
        match &mut study.subject {
            Subject::Lesson { .. } => study.explores |= !is_own,
            Subject::Prediction { drawn, at, .. } => {
                drawn.clear();
                (*at, study.taught, study.explores, study.is_over) = (0, None, true, false);
                study.pose(0);
            }
        }
    }

    /// Asks about the run as it is now.
    fn predict_anew(&mut self) {
        let Some(Study { subject: Subject::Prediction { series, .. }, .. }) = &self.study else { return };
        match (series.clone(), self.run.moment.as_ref().map(|moment| moment.step)) {
            (Some(series), _) => {
                if let Some(session) = &self.run.session {
                    session.ask(Ask::Draw(series));
                }
            }
            (None, Some(step)) => self.ask(Ask::NextQuestion(step)),
            (None, None) => {}
        }
    }

    /// Saves the answers in the working folder, under a name that is free.
    fn save_answers(&mut self) {
        let Some((study, opened)) = self.study.as_ref().zip(self.run.opened.as_ref()) else { return };
        if study.score.given().is_empty() {
            return self.notice("No question is answered yet.".to_owned());
        }
        let path = files::free_path(&format!("{}-answers", opened.run.case.name), "csv");
        match save(&path, |out| out.write_all(study.score.csv().as_bytes())) {
            Ok(()) => self.notice(format!("The answers were saved as {}.", path.display())),
            Err(fault) => self.complain(&fault),
        }
    }

    /// Whether it begins what needs the whole window.
    pub(super) fn begins_study(command: &StudyCommand) -> bool {
        matches!(
            command,
            StudyCommand::Open(_) | StudyCommand::Resume | StudyCommand::Predict | StudyCommand::PredictSeries(_)
        )
    }
}
