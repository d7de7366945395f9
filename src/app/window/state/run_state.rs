//! The run: what is open, how far it is known, and the work under way on other threads.

use std::sync::Arc;

use web_time::Instant;

use crate::app::command_line::Overrides;
use crate::app::window::autosave::Autosave;
use crate::app::window::command::Command;
use crate::app::window::files::{Dialog, Watcher, Writing};
use crate::app::window::import::Import;
use crate::app::window::lists::Lists;
use crate::app::window::measure::Measuring;
use crate::app::window::session::{Explained, Moment, Opened, Past, Session, Source, ToldChain, Transcript, Verdict};
use crate::core::convert::Phase;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::record::link::Link;
use crate::core::run::copies::Since;
use crate::core::run::timeline::Tracked;
use crate::core::run::{Born, ChangeLog, Sample, ShownState, Sought, Watched};
use crate::render::scene::Outlined;

/// How far some work is.
#[derive(Clone, Debug)]
pub struct Progress {
    pub words: &'static str,
    pub done: u64,
    /// 0 where it is unknown.
    pub total: u64,
}

/// What is known about a question that the session answers.
pub enum Lookup<T> {
    Known(Arc<T>),
    /// The answer is on its way, or has to wait until other work is done.
    Pending,
    /// Nobody has asked yet.
    Unasked,
}

/// Something that was looked for and is not there.
#[derive(Clone, Debug)]
pub struct Missing {
    /// As it was written.
    pub text: String,
    pub sought: Sought,
    /// The step at which it was looked for.
    pub step: u64,
    /// Why it is not there, a sentence.
    pub why: String,
    /// The step that ended it, once it is known.
    pub ended: Option<u64>,
    /// The next step that makes it, as far as the run is recorded.
    pub begins: Option<u64>,
}

/// What is being opened.
pub(super) struct Opening {
    pub source: Source,
    pub overrides: Overrides,
    pub session: Session,
}

/// The run and the work on it.
#[derive(Default)]
pub struct RunState {
    /// What was opened.
    pub source: Option<Source>,
    /// How its parameters were changed before it began.
    pub overrides: Overrides,
    /// The case as it was opened, with its background mesh.
    pub opened: Option<Arc<Opened>>,
    /// How many runs have been opened before this one and with it.
    pub number: u64,
    /// The current state of the run.
    pub moment: Option<Arc<Moment>>,
    /// Whether the invariants hold in it.
    pub verdict: Verdict,
    /// The steps of the run, as far as they have been recorded.
    pub track: Vec<Tracked>,
    /// Invariants and sizes along it.
    pub samples: Vec<Sample>,
    /// The steps that made quadrilaterals and nodes.
    pub born: Born,
    /// What the steps changed.
    pub change_log: ChangeLog,
    /// Changes with all of them.
    pub track_epoch: u64,
    /// Whether all steps have been recorded.
    pub recorded: bool,
    /// The steps at which each breakpoint is met, in order.
    pub hits: Vec<Vec<u64>>,
    /// Since when the session owes an answer.
    pub since: Option<Instant>,
    pub progress: Option<Progress>,
    /// Set while the run is played: when it went on last.
    pub playing: Option<Instant>,
    pub measuring: Option<Measuring>,
    /// The lists of elements and nodes.
    pub lists: Lists,
    /// The mesh that is about to be converted.
    pub import: Option<Import>,
    /// Saves the run while the user works on it.
    pub autosave: Option<Autosave>,
    pub(super) session: Option<Session>,
    /// What is being opened; the run that is open stays until it is ready.
    pub(super) opening: Option<Opening>,
    /// The number of the last picture of an import.
    pub(super) pictures: u64,
    /// Watches the file that was opened.
    pub(super) watcher: Option<Watcher>,
    /// The state of a figure that was opened, until the run gets there.
    pub(super) awaited: Option<ShownState>,
    /// What a link says of the state that it leads to, until the run gets there.
    pub(super) linked: Option<Link>,
    /// The differences between the current state and the one that the views took last.
    pub(super) changes: Since,
    /// Commands that wait until it owes none.
    pub(super) held: Vec<Command>,
    /// The selected quadrilateral, if the run is to go to its largest loss once its decision chain is known.
    pub(super) to_loss: Option<ElementId>,
    /// How many answers the session owes.
    pub(super) waiting: usize,
    /// Why the selected segment was or was not chosen, at a step; and the question asked last.
    pub(super) explained: Option<(u64, Arc<Explained>)>,
    pub(super) asked: Option<(u64, [NodeId; 2])>,
    /// The history of the selected element; and the question asked last.
    pub(super) past: Option<Arc<Past>>,
    pub(super) asked_past: Option<(u64, Watched)>,
    /// The decision chain of the selected quadrilateral; and the question asked last.
    pub(super) chain: Option<Arc<ToldChain>>,
    pub(super) asked_chain: Option<(u64, ElementId)>,
    /// What some steps did, a sentence each; and which of them were asked for last.
    pub(super) transcript: Option<Arc<Transcript>>,
    pub(super) asked_transcript: Option<[u64; 2]>,
    /// What was looked for last, where it is not in the current state.
    pub missing: Option<Missing>,
    /// What is to be found when the run gets to a step.
    pub(super) find_at: Option<(u64, Outlined)>,
    /// The file dialog, while it is open.
    pub(super) dialog: Option<Dialog>,
    /// The dialog for the folder of figures, while it is open.
    pub(super) folder_dialog: Option<Dialog>,
    /// Figures and meshes that are being written.
    pub(super) figures: Vec<Writing>,
    pub(super) meshes: Vec<Writing>,
}

impl RunState {
    /// Whether the session still owes an answer.
    pub fn is_busy(&self) -> bool {
        self.waiting > 0
    }

    /// Whether something is being opened.
    pub fn is_opening(&self) -> bool {
        self.opening.is_some()
    }

    /// Whether a file dialog is open.
    pub fn is_asking_for_file(&self) -> bool {
        self.dialog.is_some() || self.folder_dialog.is_some()
    }

    /// Whether a figure is being made.
    pub fn is_making_figure(&self) -> bool {
        !self.figures.is_empty()
    }

    /// Of all quadrilaterals that were formed up to a step the one that had the lowest quality then: step, element and
    /// quality.
    pub fn worst_formed(&self, step: u64) -> Option<(u64, ElementId, f64)> {
        let formed = self.track.iter().take(step as usize).zip(1..);
        let formed = formed.filter_map(|(tracked, step)| tracked.formed.map(|(e, quality)| (step, e, quality)));
        formed.min_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// Whether the current state is the last one.
    pub fn is_at_the_end(&self) -> bool {
        self.moment.as_ref().is_some_and(|moment| moment.phase == Phase::Done)
    }

    /// Forgets what the session said of the state before: the run may have changed at an earlier step.
    pub(super) fn forget_answers(&mut self) {
        (self.explained, self.asked) = (None, None);
        (self.past, self.asked_past) = (None, None);
        (self.chain, self.asked_chain, self.to_loss) = (None, None, None);
    }

    /// Forgets the transcript of steps after one, which are others now.
    pub(super) fn forget_transcript_after(&mut self, step: u64) {
        if self.asked_transcript.is_some_and(|[_, until]| until > step) {
            (self.transcript, self.asked_transcript) = (None, None);
        }
    }

    /// What a step did, in a sentence, where the transcript that was told last has it.
    pub fn sentence(&self, step: u64) -> Option<&str> {
        let told = self.transcript.as_ref()?;
        told.sentences.get(usize::try_from(step.checked_sub(told.from)?).ok()?).map(String::as_str)
    }

    /// Whether the transcript from a step to another has been asked for.
    pub fn has_asked_for_transcript(&self, from: u64, until: u64) -> bool {
        self.asked_transcript == Some([from, until])
    }

    /// Why a segment of the front was or was not chosen at the current step.
    pub fn explanation(&self, ends: [NodeId; 2]) -> Lookup<Explained> {
        let Some(step) = self.moment.as_ref().map(|moment| moment.step) else { return Lookup::Pending };
        match &self.explained {
            Some((at, told)) if (*at, [told.told.row.a, told.told.row.b]) == (step, ends) => {
                Lookup::Known(told.clone())
            }
            _ if self.asked == Some((step, ends)) => Lookup::Pending,
            _ => Lookup::Unasked,
        }
    }

    /// The decision chain of a quadrilateral of the current step. While other work is under way the question waits.
    pub fn chain(&self, element: ElementId) -> Lookup<ToldChain> {
        let Some(step) = self.moment.as_ref().map(|moment| moment.step) else { return Lookup::Pending };
        match &self.chain {
            Some(told) if (told.step, told.element) == (step, element) => Lookup::Known(told.clone()),
            _ if self.asked_chain == Some((step, element)) || self.is_busy() || self.playing.is_some() => {
                Lookup::Pending
            }
            _ => Lookup::Unasked,
        }
    }

    /// The history of something up to the current step. While other work is under way the question waits.
    pub fn past(&self, watched: Watched) -> Lookup<Past> {
        let Some(step) = self.moment.as_ref().map(|moment| moment.step) else { return Lookup::Pending };
        match &self.past {
            Some(past) if (past.step, past.watched) == (step, watched) => Lookup::Known(past.clone()),
            _ if self.asked_past == Some((step, watched)) || self.is_busy() || self.playing.is_some() => {
                Lookup::Pending
            }
            _ => Lookup::Unasked,
        }
    }
}
