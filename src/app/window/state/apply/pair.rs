//! Two runs: which of them a command is for, and what is done with both.

use std::sync::Arc;

use web_time::Instant;

use super::State;
use crate::app::command_line::Overrides;
use crate::app::window::command::Command;
use crate::app::window::layout::Pane;
use crate::app::window::pair::{PairCommand, Which};
use crate::app::window::presentation::Chrome;
use crate::app::window::session::{Direction, Goal, Opened, Session, Source};
use crate::app::window::state::pair::{Pair, ShownDifference};
use crate::app::window::state::{Opening, Overlay, ViewKind};
use crate::core::fault::Fault;
use crate::core::formats::Format;
use crate::core::run::Run;
use crate::core::run::copies::Since;
use crate::core::step::is_step;
use crate::render::scene::Outlined;

/// What a command is for, where there are two runs.
enum Scope {
    /// The window, or the first run, whose style the second one follows.
    Window,
    /// Both runs.
    Both,
    /// The run that the panels show.
    Active,
}

impl State {
    /// Does something with two runs, or begins to have two.
    pub(super) fn apply_to_pair(&mut self, command: PairCommand) {
        match command {
            PairCommand::Fork | PairCommand::ForkWith(_) if self.active().run.is_busy() => {
                self.run.held.push(Command::Pair(command));
            }
            PairCommand::Fork => self.fork(),
            PairCommand::ForkWith(rules) => {
                self.fork();
                if let Some(pair) = &mut self.pair {
                    pair.first_rules = Some(rules);
                }
            }
            PairCommand::AskBeside => self.toggle(Overlay::PathBeside),
            PairCommand::OpenBeside(source, overrides) => self.open_beside(source, *overrides),
            command if self.pair.is_none() => {
                let how = "Fork at a step (Ctrl+K), or open a second run";
                self.notice(format!("\u{201c}{}\u{201d} needs two runs: {how}.", command.name()));
            }
            PairCommand::Activate(which) => self.change_pair(|pair| pair.active = which),
            PairCommand::Switch => self.change_pair(|pair| pair.active = pair.active.other()),
            PairCommand::Link(link) => self.change_pair(|pair| pair.link = link),
            PairCommand::Show(arrangement) => self.change_pair(|pair| pair.arrangement = arrangement),
            PairCommand::Exchange => self.exchange(),
            PairCommand::Close => self.close_second(),
            PairCommand::ToDifference => match self.pair.as_ref().map(Pair::first_difference) {
                Some(Some(step)) => {
                    self.change_pair(|pair| (pair.shown, pair.apart) = (None, None));
                    self.apply_beside(Command::Go(Goal::Step(step)));
                }
                _ => self.notice("No difference of the two runs is known.".to_owned()),
            },
            PairCommand::SeekDifference(direction) => self.seek_difference(direction),
            PairCommand::In(which, command) => {
                if matches!(*command, Command::Pick(_) | Command::Show(_)) {
                    self.change_pair(|pair| pair.active = which);
                }
                self.apply_in(which, *command);
            }
        }
    }

    /// Sends both runs to the next decision, or the one before, in which they differ although their fronts are the same
    /// there, and shows it.
    fn seek_difference(&mut self, direction: Direction) {
        let step = self.run.moment.as_ref().map_or(0, |moment| moment.step);
        let Some(pair) = &mut self.pair else { return };
        let Some(all) = pair.comparison.as_ref().and_then(|comparison| comparison.differences.as_ref()) else {
            let yet = if pair.is_comparing() { " yet" } else { "" };
            return self.notice(format!("No further difference of the two runs is known{yet}."));
        };
        // On the way to one, the next is the one after it.
        let step = pair.apart.map_or(step, |steps| steps[0]);
        let place = match direction {
            Direction::Forward => Some(all.partition_point(|difference| difference.steps[0] <= step)),
            Direction::Back => all.partition_point(|difference| difference.steps[0] < step).checked_sub(1),
        };
        let Some((place, difference)) = place.and_then(|place| Some((place, *all.get(place)?))) else {
            let which = if direction == Direction::Forward { "after" } else { "before" };
            return self.notice(format!("No decision {which} this one differs at the same front."));
        };
        pair.shown = Some(ShownDifference { place, did: None });
        pair.apart = Some(difference.steps);
        if let Some(comparing) = &pair.comparing {
            comparing.ask(place);
        }
        let [base, other] = difference.bases.map(Outlined::Edge);
        pair.other.find_at(difference.steps[1], other);
        self.find_at(difference.steps[0], base);
    }

    fn change_pair(&mut self, change: impl FnOnce(&mut Pair)) {
        if let Some(pair) = &mut self.pair {
            change(pair);
            self.view.over_epoch += 1;
            pair.other.view.over_epoch += 1;
        }
    }

    /// Does what the user asks for, where there are two runs.
    pub(super) fn apply_beside(&mut self, command: Command) {
        match self.scope(&command) {
            Scope::Window => self.apply_alone(command),
            Scope::Active => self.apply_in(self.active_run(), command),
            Scope::Both => Which::ALL.into_iter().for_each(|which| self.apply_in(which, command.clone())),
        }
    }

    fn scope(&self, command: &Command) -> Scope {
        match command {
            Command::Fit | Command::LookFrom(_) | Command::Figures | Command::Notes => Scope::Both,
            Command::Escape if self.view.overlay != Overlay::Nothing || self.run.import.is_some() => Scope::Window,
            Command::Escape if self.view.chrome != Chrome::Panels => Scope::Window,
            Command::Escape if self.view.figure_panel || self.view.notes => Scope::Both,
            command if command.is_of_the_window() => Scope::Window,
            _ => Scope::Active,
        }
    }

    /// Does something in one of two runs.
    fn apply_in(&mut self, which: Which, command: Command) {
        let moved = match command {
            Command::MoveCamera(view, _) => Some(view),
            _ => None,
        };
        let Some(pair) = self.pair.as_mut().filter(|_| which == Which::B) else {
            self.apply_alone(command);
            return self.link_cameras(which, moved);
        };
        // What is open over the window, and which panels it shows, belongs to the first run's state.
        pair.other.view.overlay = self.view.overlay;
        std::mem::swap(&mut pair.other.view.reveal, &mut self.view.reveal);
        pair.other.apply_alone(command);
        self.view.overlay = std::mem::take(&mut pair.other.view.overlay);
        std::mem::swap(&mut pair.other.view.reveal, &mut self.view.reveal);
        self.lift_messages();
        self.link_cameras(which, moved);
    }

    /// The camera of the other run follows one that has moved.
    fn link_cameras(&mut self, which: Which, moved: Option<ViewKind>) {
        let (Some(pair), Some(view)) = (&mut self.pair, moved) else { return };
        if !pair.is_in_one_place.is_some_and(|known| known.0) {
            return;
        }
        let (from, to) = match which {
            Which::A => (&self.view, &mut pair.other.view),
            Which::B => (&pair.other.view, &mut self.view),
        };
        let (from, to) = match view {
            ViewKind::Plane => (&from.plane, &mut to.plane),
            ViewKind::Space => (&from.space, &mut to.space),
            ViewKind::Import => return,
        };
        (to.camera, to.is_fitted) = (from.camera, from.is_fitted);
    }

    /// Shows the messages of the second run as those of the window.
    pub(in crate::app::window::state) fn lift_messages(&mut self) {
        let Some(pair) = &mut self.pair else { return };
        let view = &mut pair.other.view;
        let (faults, notice) = (std::mem::take(&mut view.faults), view.notice.take());
        if let Some((text, _)) = notice {
            self.notice(format!("B: {text}"));
        }
        faults.into_iter().for_each(|fault| self.warn(format!("B: {fault}")));
    }

    /// Starts a second run that is the same up to the current step.
    fn fork(&mut self) {
        let active = self.active();
        let (Some(run), Some(opened), Some(source)) =
            (active.current_run(), active.run.opened.clone(), active.run.source.clone())
        else {
            return self.notice("There is nothing to fork: open a case first.".to_owned());
        };
        let step = active.run.moment.as_ref().map_or(0, |moment| moment.step);
        let overrides = active.run.overrides.clone();
        let background = opened.background.clone();
        let session = Session::fork(run, background, self.wake.clone());
        self.begin_beside(Opening { source, overrides, session }, step, Some(step));
    }

    /// Opens a second run.
    fn open_beside(&mut self, source: Source, overrides: Overrides) {
        let source = match source {
            // A mesh is imported as it is.
            Source::File(path) if Format::from_path(&path).is_ok() || is_step(&path) => {
                Source::Mesh(path, Default::default())
            }
            source => source,
        };
        let (named, changed) = (source.clone(), overrides.clone());
        self.open_read_beside(source, overrides, move || super::opening::read(&named, &changed));
    }

    /// Opens the second run that `read` gives, of a source with its parameters changed.
    pub(super) fn open_read_beside(
        &mut self,
        source: Source,
        overrides: Overrides,
        read: impl FnOnce() -> Result<Run, Fault> + Send + 'static,
    ) {
        let session = Session::open(read, self.wake.clone());
        let step = self.run.moment.as_ref().map_or(0, |moment| moment.step);
        self.begin_beside(Opening { source, overrides, session }, step, None);
    }

    fn begin_beside(&mut self, opening: Opening, step: u64, forked: Option<u64>) {
        self.close_second();
        let mut other = Box::new(self.beside());
        other.run.opening = Some(opening);
        other.run.waiting = 1;
        other.run.since = Some(Instant::now());
        let mut pair = Pair::new(other, forked);
        pair.first_step = Some(step);
        self.pair = Some(pair);
        self.view.reveal.ask(Some(Pane::TwoRuns));
    }

    /// Closes the second run. If it has unsaved changes, it is offered for recovery.
    pub(in crate::app::window::state) fn close_second(&mut self) {
        self.lift_messages();
        let Some(mut pair) = self.pair.take() else { return };
        self.view.over_epoch += 1;
        // The second run's autosave ends first and releases its file.
        drop(pair.other.run.autosave.take());
        if let Some(autosave) = &mut self.run.autosave {
            autosave.search();
        }
    }

    /// Makes A the second run and B the first.
    fn exchange(&mut self) {
        if self.run.is_opening() || self.of(Which::B).run.is_opening() {
            return self.notice("The runs can be exchanged once both are open.".to_owned());
        }
        let Some(mut pair) = self.pair.take() else { return };
        let other = &mut pair.other;
        std::mem::swap(&mut self.run, &mut other.run);
        // What the window asks the user belongs to it, whichever run is the first.
        std::mem::swap(&mut self.run.dialog, &mut other.run.dialog);
        if let (Some(autosave), Some(of_other)) = (&mut self.run.autosave, &mut other.run.autosave) {
            autosave.swap_offers(of_other);
        }
        self.workspace.exchange(&mut other.workspace);
        std::mem::swap(&mut self.view.plane, &mut other.view.plane);
        std::mem::swap(&mut self.view.space, &mut other.view.space);
        for state in [&mut *self, &mut **other] {
            state.run.changes = Since::everything();
            state.view.style_epoch += 1;
            state.view.over_epoch += 1;
        }
        pair.active = pair.active.other();
        (pair.compared, pair.followed, pair.overlapped) = (None, None, None);
        pair.forget_comparison();
        self.pair = Some(pair);
    }
}

/// Whether two backgrounds lie in one place, so that one camera shows both.
pub(in crate::app::window::state) fn are_in_one_place(a: &Arc<Opened>, b: &Arc<Opened>) -> bool {
    let bounds = |opened: &Opened| {
        let mesh = &opened.background.mesh;
        mesh.nodes().map(|n| [mesh.xyz(n); 2]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    };
    let (Some([a, b]), Some([c, d])) = (bounds(a), bounds(b)) else { return false };
    let size = (b - a).length().max((d - c).length());
    (a - c).length() <= 0.01 * size && (b - d).length() <= 0.01 * size
}
