//! What is told and asked: parts of lessons and questions at their states, and the judgement of answers.

use std::sync::Arc;

use super::super::{Posed, SessionNews, Taught};
use super::{Aim, Worker};
use crate::core::fault::Fault;
use crate::core::lesson::{Ask, Lesson, decisions};
use crate::core::question::{Answer, Asked, Drawn, Hint, draw, following};
use crate::core::run::History;

impl Worker {
    /// Reports what is told and asked where the aim leads, and returns that step. `None` while the run is not recorded
    /// far enough.
    pub(super) fn teach(&mut self, aim: &Aim) -> Result<Option<u64>, Fault> {
        let is_recorded = self.history.end().is_some();
        let found = match aim {
            Aim::Part(lesson, part) if !is_recorded && lesson.stands_at_the_end(*part) => return Ok(None),
            Aim::Part(lesson, part) => self.part(lesson, *part).map(Some),
            Aim::Question(drawn) => self.question(*drawn).map(Some),
            Aim::NextQuestion(from) => match following(&mut self.history, *from)? {
                Some(drawn) => self.question(drawn).map(Some),
                None => Ok(None),
            },
            Aim::Goals(_) | Aim::Break(..) => Ok(None),
        };
        let taught = match found {
            Ok(Some(taught)) => taught,
            // A place, or the step that answers a question, may not be recorded yet.
            Ok(None) | Err(_) if !is_recorded => return Ok(None),
            Ok(None) => {
                self.voice.say(SessionNews::NoQuestion);
                return Ok(Some(self.history.step()));
            }
            Err(fault) => return Err(fault),
        };
        let step = taught.step;
        self.voice.say(SessionNews::Taught(Arc::new(taught)));
        Ok(Some(step))
    }

    /// A part of a lesson at its state.
    fn part(&mut self, lesson: &Lesson, part: usize) -> Result<Taught, Fault> {
        let scene = lesson.scene(part, &mut self.history)?;
        // Questions about the next step may have gone there.
        self.history.seek(scene.step)?;
        let asks = lesson.parts.get(part).map_or(&[][..], |part| &part.asks);
        let pose = |(ask, asked): (&Ask, &Asked)| {
            let mut posed = posed(asked.clone(), ask.text.clone(), &self.history);
            let own = ask.hint.iter().map(|hint| Hint { text: hint.clone(), labels: Vec::new() });
            posed.hints.splice(..0, own);
            posed
        };
        let posed = asks.iter().zip(&scene.asked).map(pose).collect();
        Ok(Taught { step: scene.step, scene: Some(scene), posed })
    }

    /// A question that stands alone.
    fn question(&mut self, Drawn { step, kind }: Drawn) -> Result<Taught, Fault> {
        self.history.seek(step)?;
        let asked = Asked::of(&mut self.history, kind, None)?;
        self.history.seek(step)?;
        let posed = vec![posed(asked, kind.words().to_owned(), &self.history)];
        Ok(Taught { step, scene: None, posed })
    }

    /// Draws a series, once the whole run is recorded.
    pub(super) fn draw(&mut self) {
        if self.history.end().is_none() {
            return;
        }
        let Some(series) = self.series.take() else { return };
        let drawn = draw(&mut self.history, &series);
        self.report(drawn.map(SessionNews::Drawn), 0);
    }

    /// Judges an answer at the state of its question.
    pub(super) fn judge(&mut self, asked: &Arc<Asked>, answer: Answer) {
        let at = self.history.step();
        let mut judge = || {
            self.history.seek(asked.step)?;
            let judged = asked.judge(self.history.state(), answer)?;
            self.history.seek(at)?;
            Ok(judged)
        };
        let judged = judge();
        self.voice.say(SessionNews::Judged(asked.clone(), answer, judged));
    }

    /// Reports the decisions that led to the current state.
    pub(super) fn decisions(&self) {
        let step = self.history.step();
        self.report(decisions(&self.history).map(|all| SessionNews::Decisions(step, all)), 0);
    }
}

fn posed(asked: Asked, text: String, history: &History) -> Posed {
    let hints = asked.hints(history.state());
    Posed { asked: Arc::new(asked), text, hints }
}
