//! What is learnt in the window: a lesson, part by part, or predictions of what a run does next. Questions are answered
//! in the view, by choices or as text; the session judges the answers.

#[cfg(target_arch = "wasm32")]
mod in_words;
mod learned;

use std::sync::Arc;

#[cfg(target_arch = "wasm32")]
pub use in_words::in_words;
pub use learned::Learned;

use super::icons;
use super::session::{Posed, Taught};
use crate::core::case::built_in::FIGURES;
use crate::core::lesson::{Decision, Lesson, Things, built_in};
use crate::core::mesh::{Mesh, NodeId};
use crate::core::question::{Answer, Drawn, Hint, Judged, Kind, Rule, Score, Series, Verdict};
use crate::render::scene::Outlined;

/// Something that is done while one learns.
#[derive(Clone, Debug, PartialEq)]
pub enum StudyCommand {
    /// Open a lesson of the tour.
    Open(&'static str),
    /// Go on with the lesson that was open last, or begin the tour.
    Resume,
    /// Predict what comes next, from this step on.
    Predict,
    /// Predict the answers to a series of questions.
    PredictSeries(Series),
    /// Go on: show the answer to an open question, or go to the next question, part or lesson.
    Continue,
    /// Go to the part before this one.
    PartBack,
    /// Go to a part of the lesson.
    Part(usize),
    /// Answer the question.
    Answer(Answer),
    /// The same, as text.
    AnswerText(String),
    /// Take the next hint.
    Hint,
    /// Turn the state into the whole window, or come back from there.
    Explore,
    /// Go back to the state that is spoken of.
    Return,
    /// The pointer is on words that mean this.
    PointAt(Vec<Outlined>),
    /// Ask for the decisions that led to the current state.
    TellDecisions,
    /// Save the answers to the questions of a prediction.
    Save,
    /// End it.
    Leave,
}

impl StudyCommand {
    /// Its name in the palette, in menus and in tooltips.
    pub fn name(&self) -> String {
        match self {
            StudyCommand::Open(name) => format!("Lesson: {}", built_in::title(name).unwrap_or(name)),
            StudyCommand::Resume => "Go on with the tour".into(),
            StudyCommand::Predict => "Predict what comes next".into(),
            StudyCommand::PredictSeries(series) => {
                format!("Predict {} answers drawn by seed {}", series.count, series.seed)
            }
            StudyCommand::Continue => "Continue".into(),
            StudyCommand::PartBack => "Previous part".into(),
            StudyCommand::Part(part) => format!("Part {}", part + 1),
            StudyCommand::Answer(answer) => format!("Answer {}", answer.words()),
            StudyCommand::AnswerText(text) => format!("Answer {text}"),
            StudyCommand::Hint => "Hint".into(),
            StudyCommand::Explore => "Explore freely, or back to the lesson".into(),
            StudyCommand::Return => "Back to what is spoken of".into(),
            StudyCommand::PointAt(_) => "Point at what words mean".into(),
            StudyCommand::TellDecisions => "Where we are".into(),
            StudyCommand::Save => "Save the answers as CSV".into(),
            StudyCommand::Leave => "End the lesson".into(),
        }
    }

    /// All that need no more than their names.
    pub fn all() -> Vec<StudyCommand> {
        let mut all = vec![
            StudyCommand::Resume,
            StudyCommand::Predict,
            StudyCommand::PredictSeries(Series::default()),
            StudyCommand::Explore,
            StudyCommand::Save,
            StudyCommand::Leave,
        ];
        all.extend(built_in::LESSONS.iter().map(|(name, _)| StudyCommand::Open(name)));
        all
    }
}

/// What is learnt.
#[derive(Clone, Debug)]
pub enum Subject {
    /// A lesson, by its name in the tour or the path of its file, at one of its parts.
    Lesson { lesson: Arc<Lesson>, source: String, part: usize },
    /// What comes next along the run, question by question; or a series with the questions that were drawn, at one of
    /// them. None are drawn until the whole run is recorded.
    Prediction { series: Option<Series>, drawn: Vec<Drawn>, at: usize },
}

/// An answer to the question at hand.
#[derive(Clone, Debug)]
pub struct Try {
    pub answer: Answer,
    pub judged: Judged,
    /// Whether it was shown and not given.
    pub is_shown: bool,
}

impl Try {
    /// How good it was, in a word.
    pub fn word(&self) -> &'static str {
        match self.judged.verdict {
            _ if self.is_shown => "The answer",
            Verdict::Right => "Yes",
            Verdict::Partly => "In part",
            Verdict::Wrong => "No",
        }
    }
}

/// A lesson or a prediction that is under way.
pub struct Study {
    pub subject: Subject,
    /// What is told and asked now; none while it is on its way.
    pub taught: Option<Arc<Taught>>,
    /// Which of its questions is at hand.
    pub question: usize,
    /// The answers to it.
    pub tries: Vec<Try>,
    /// How many of its hints were taken.
    pub hints: usize,
    /// Whether an answer is being judged; whether it was shown.
    pub(super) judging: Option<bool>,
    /// All answers since it began.
    pub score: Score,
    /// Whether the whole window is shown.
    pub explores: bool,
    /// Whether a prediction has come to its end.
    pub is_over: bool,
    /// What to do, where something was done that is no answer.
    pub remark: Option<String>,
    /// The decisions that led to a state, by its step; and the step that was asked about last.
    pub decisions: Option<(u64, Vec<Decision>)>,
    pub(super) asked_decisions: Option<u64>,
    /// Changes when the camera is to go where the part is again.
    pub(super) frames: u64,
}

impl Study {
    /// A study that begins.
    pub fn of(subject: Subject) -> Study {
        Study {
            subject,
            taught: None,
            question: 0,
            tries: Vec::new(),
            hints: 0,
            judging: None,
            score: Score::default(),
            explores: false,
            is_over: false,
            remark: None,
            decisions: None,
            asked_decisions: None,
            frames: 0,
        }
    }

    /// The lesson, with its part.
    pub fn lesson(&self) -> Option<(&Arc<Lesson>, usize)> {
        match &self.subject {
            Subject::Lesson { lesson, part, .. } => Some((lesson, *part)),
            Subject::Prediction { .. } => None,
        }
    }

    /// The place of the lesson in the tour, from 0; none for a file.
    pub fn tour_place(&self) -> Option<usize> {
        let Subject::Lesson { source, .. } = &self.subject else { return None };
        built_in::LESSONS.iter().position(|known| known.0 == source)
    }

    /// The question at hand.
    pub fn posed(&self) -> Option<&Posed> {
        self.taught.as_ref()?.posed.get(self.question).filter(|_| !self.is_over)
    }

    /// The hints to it that were taken.
    pub fn taken_hints(&self) -> &[Hint] {
        self.posed().map_or(&[], |posed| &posed.hints[..self.hints.min(posed.hints.len())])
    }

    /// Whether the question at hand is answered: rightly, or by showing the answer.
    pub fn is_answered(&self) -> bool {
        self.tries.last().is_some_and(|last| last.is_shown || last.judged.verdict == Verdict::Right)
    }

    /// Whether a question waits for its answer.
    pub fn is_asking(&self) -> bool {
        self.posed().is_some() && !self.is_answered()
    }

    /// Whether the state of a step is the one that is spoken of.
    pub fn is_about(&self, step: u64) -> bool {
        self.taught.as_ref().is_some_and(|taught| taught.step == step)
    }

    /// The question that waits for an answer at the state of a step.
    pub fn open_question(&self, step: u64) -> Option<&Posed> {
        self.posed().filter(|_| self.is_asking() && self.is_about(step))
    }

    /// Whether classes and H-values would give an answer away: until a hint tells them.
    pub fn hides_classes(&self, step: u64) -> bool {
        let is_about_them = |posed: &Posed| matches!(posed.asked.kind, Kind::Segment | Kind::Class);
        self.hints == 0 && self.tries.is_empty() && self.open_question(step).is_some_and(is_about_them)
    }

    /// What the question at hand is about, at the state of a step.
    pub fn about(&self, step: u64) -> Option<Outlined> {
        self.posed().filter(|_| self.is_about(step))?.asked.of.map(super::state::outlined)
    }

    /// Whether the segments of the front have labels with class and H-value: in a lesson, where one of its rules speaks
    /// of them.
    pub fn labels_segments(&self) -> bool {
        let speaks = |lesson: &Lesson| lesson.rules.iter().any(|rule| matches!(rule, Rule::HValue | Rule::Table1));
        self.lesson().is_none_or(|(lesson, _)| speaks(lesson))
    }

    /// What is lit at the state of a step.
    pub fn lit(&self, step: u64) -> Vec<Outlined> {
        let Some(taught) = self.taught.as_ref().filter(|taught| taught.step == step) else { return Vec::new() };
        let light = taught.scene.iter().flat_map(|scene| outlined(&scene.light));
        let shown = self.tries.last().and_then(|last| pointed(&last.answer));
        // What a question is about is not to be taken for what the part lights.
        let about = self.about(step);
        light.filter(|_| about.is_none()).chain(shown).chain(about).collect()
    }

    /// Labels at edges and nodes: hints, and answers with the sign of their verdict.
    pub fn labels(&self, step: u64) -> Vec<(Outlined, String, Verdict)> {
        if !self.is_about(step) {
            return Vec::new();
        }
        let answers = self.tries.iter().filter_map(|one| {
            let sign = sign(one.judged.verdict);
            Some((pointed(&one.answer)?, format!("{sign} {}", one.answer.words()), one.judged.verdict))
        });
        // The last hint at an edge stands there.
        let mut labels: Vec<(Outlined, String, Verdict)> = answers.collect();
        for (ends, text) in self.taken_hints().iter().rev().flat_map(|hint| &hint.labels) {
            let edge = Outlined::Edge(*ends);
            if !labels.iter().any(|label| label.0 == edge) {
                labels.push((edge, text.clone(), Verdict::Partly));
            }
        }
        labels
    }

    /// Where the camera goes at the state of a step, with a number that changes when it is to go there: the nodes that
    /// it shows, those of its questions too, none for the whole mesh.
    pub fn framed(&self, step: u64, mesh: &Mesh) -> Option<(u64, Vec<NodeId>)> {
        let taught = self.taught.as_ref().filter(|taught| taught.step == step)?;
        let framed = taught.scene.as_ref().map(|scene| scene.frame.all_nodes(mesh));
        let shows_all = framed.as_ref().is_some_and(Vec::is_empty);
        let asked = taught.posed.iter().filter(|_| !shows_all).flat_map(|posed| posed.asked.place.iter().copied());
        let nodes = framed.into_iter().flatten().chain(asked).collect();
        Some((self.frames, nodes))
    }

    /// Whether the keys step by operation: in the small cases of a figure.
    pub fn steps_by_operation(case: &str) -> bool {
        FIGURES.iter().any(|figure| figure.0 == case)
    }

    /// Forgets what was answered to the question before.
    pub(super) fn pose(&mut self, question: usize) {
        self.question = question;
        self.tries.clear();
        (self.hints, self.judging, self.remark) = (0, None, None);
    }
}

/// The sign of a verdict.
pub fn sign(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Right => icons::CHECK,
        Verdict::Partly => "\u{bd}",
        Verdict::Wrong => icons::X,
    }
}

/// What an answer points at.
fn pointed(answer: &Answer) -> Option<Outlined> {
    match answer {
        Answer::Edge(ends) => Some(Outlined::Edge(*ends)),
        Answer::Node(node) => Some(Outlined::Node(*node)),
        Answer::Choice(_) | Answer::Number(_) => None,
    }
}

/// What is pointed at as an answer to a question of a kind, or else what to do.
pub fn answer_of(kind: Kind, what: Outlined) -> Result<Answer, &'static str> {
    match (kind, what) {
        (Kind::Segment | Kind::Edge, Outlined::Edge(ends)) => Ok(Answer::Edge(ends)),
        (Kind::Edge, Outlined::Node(node)) | (Kind::Node, Outlined::Node(node)) => Ok(Answer::Node(node)),
        (Kind::Segment, _) => Err("Click a segment of the front."),
        (Kind::Edge, _) => Err("Click an edge, or the node that it would lead to."),
        (Kind::Node, _) => Err("Click a node."),
        (Kind::Count, _) => Err("Write a number."),
        _ => Err("Choose one of the answers."),
    }
}

/// Things as the views know them. Lines between nodes that nothing joins are edges too.
pub fn outlined(things: &Things) -> Vec<Outlined> {
    let edges = things.edges.iter().chain(&things.missing).map(|ends| Outlined::Edge(*ends));
    let nodes = things.nodes.iter().map(|node: &NodeId| Outlined::Node(*node));
    edges.chain(nodes).chain(things.elements.iter().map(|e| Outlined::Element(*e))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::ElementId;

    #[test]
    fn what_is_clicked_answers_a_question_that_asks_for_such_a_thing() {
        let edge = Outlined::Edge([NodeId(1), NodeId(2)]);
        let (node, element) = (Outlined::Node(NodeId(3)), Outlined::Element(ElementId(4)));
        assert_eq!(answer_of(Kind::Segment, edge), Ok(Answer::Edge([NodeId(1), NodeId(2)])));
        assert_eq!(answer_of(Kind::Edge, node), Ok(Answer::Node(NodeId(3))), "a side is known by its top");
        assert_eq!(answer_of(Kind::Node, node), Ok(Answer::Node(NodeId(3))));
        for (kind, what) in [(Kind::Segment, node), (Kind::Node, edge), (Kind::Seam, edge), (Kind::Edge, element)] {
            assert!(answer_of(kind, what).is_err(), "{}", kind.name());
        }
    }

    #[test]
    fn every_command_has_a_name_of_its_own() {
        let mut names: Vec<String> = StudyCommand::all().iter().map(StudyCommand::name).collect();
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all);
    }
}
