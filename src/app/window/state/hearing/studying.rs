//! Lessons and predictions: what the session tells of them.

use std::sync::Arc;

use super::State;
use crate::app::lesson;
use crate::app::window::session::{Ask, Source, Taught};
use crate::app::window::state::Wanted;
use crate::app::window::study::{Study, Subject, Try};
use crate::core::fault::Fault;
use crate::core::question::{Answer, Asked, Drawn, Judged};
use crate::core::run::explain::plain;

impl State {
    /// A run is open: the lesson that it is of begins, or what was to be predicted.
    pub(super) fn begin_study(&mut self) {
        let (wanted, before) = (self.wanted.take(), self.study.take());
        match (self.run.source.clone(), wanted) {
            (_, Some(Wanted::Linked(link))) => self.begin_by_link(*link),
            (Some(Source::Lesson(name)), wanted) => match lesson::found(&name) {
                Ok(lesson) => {
                    // A file that has changed is read again at the same part.
                    let at = before.and_then(|study| match study.subject {
                        Subject::Lesson { source, part, .. } if source == name => Some(part),
                        _ => None,
                    });
                    let part = if let Some(Wanted::Part(part)) = wanted { part } else { at.unwrap_or(0) };
                    let lesson = Arc::new(lesson);
                    self.study = Some(Study::of(Subject::Lesson { lesson, source: name, part: 0 }));
                    self.teach(part);
                }
                Err(fault) => self.complain(&fault),
            },
            (_, Some(Wanted::Series(series))) => self.predict_series(series),
            _ => {}
        }
    }

    /// What is told and asked at the state that comes next.
    pub(super) fn be_taught(&mut self, taught: Arc<Taught>) {
        if let Some(study) = &mut self.study {
            study.taught = Some(taught);
            study.frames += 1;
            study.pose(0);
            self.view.over_epoch += 1;
        }
    }

    /// The questions of a series are drawn: the first one is asked.
    pub(super) fn be_asked(&mut self, questions: Vec<Drawn>) {
        let Some(Study { subject: Subject::Prediction { drawn, at, .. }, is_over, .. }) = &mut self.study else {
            return;
        };
        (*drawn, *at) = (questions, 0);
        match drawn.first().copied() {
            Some(first) => self.ask(Ask::Question(first)),
            None => *is_over = true,
        }
    }

    /// Nothing more can be asked along the run.
    pub(super) fn end_questions(&mut self) {
        if let Some(study) = &mut self.study {
            study.is_over = true;
        }
    }

    /// An answer is judged.
    pub(super) fn be_judged(&mut self, asked: &Arc<Asked>, answer: Answer, judged: Result<Judged, Fault>) {
        let Some(study) = &mut self.study else { return };
        let is_at_hand = study.posed().is_some_and(|posed| Arc::ptr_eq(&posed.asked, asked));
        let Some(is_shown) = study.judging.take().filter(|_| is_at_hand) else { return };
        let judged = match judged {
            Ok(judged) => judged,
            Err(fault) => {
                study.remark = Some(plain(&fault.to_string()));
                return;
            }
        };
        let is_first = study.tries.is_empty() && !is_shown;
        if is_shown {
            study.score.show(asked);
        }
        if is_first && study.score.note(asked, answer, &judged, study.hints as u32) {
            let learned = &mut self.workspace.learned;
            match &study.subject {
                Subject::Lesson { source, part, .. } => {
                    learned.answer(source, [*part, study.question], judged.rule, judged.verdict);
                }
                Subject::Prediction { .. } => learned.predict(judged.rule, judged.verdict),
            }
        }
        study.tries.push(Try { answer, judged, is_shown });
        self.view.over_epoch += 1;
    }
}
