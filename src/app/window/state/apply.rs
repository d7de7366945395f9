//! Does what the user asks for. With `hearing` this is the only place that changes [`State`].

mod finding;
mod held;
mod linking;
mod marking;
mod opening;
mod pair;
mod parameters;
mod presenting;
mod saving;
mod studying;
mod sweeping;

use std::time::Duration;

use web_time::Instant;

pub(super) use pair::are_in_one_place;

use super::{Document, Look, Overlay, State, SurfaceView, ViewCamera, ViewKind, watched};
use crate::app::command_line::Overrides;
use crate::app::window::command::Command;
use crate::app::window::figures::Formats;
use crate::app::window::files::Dialog;
use crate::app::window::film::FilmCommand;
use crate::app::window::layout::Pane;
use crate::app::window::lists::{ListKind, RecordedSteps};
use crate::app::window::measure::Measuring;
use crate::app::window::presentation::Chrome;
use crate::app::window::reducing::Reducing;
use crate::app::window::session::{Ask, Direction, Goal, Source};
use crate::app::window::words;
use crate::core::convert::Event;
use crate::core::fault::Fault;
use crate::core::mesh::NodeId;
use crate::core::run::{Edit, EditKind, Query};
use crate::render::scene::Outlined;

impl State {
    /// Does what the user asks for.
    pub(in crate::app::window) fn apply(&mut self, command: Command) {
        if self.run.import.is_some() && !command.fits_import() {
            return self.notice("This command needs a run: convert the mesh first, or cancel the import.".to_owned());
        }
        self.lift_black(&command);
        let Some(command) = self.as_answer(command) else { return };
        match command {
            Command::Study(command) => {
                if self.pair.is_some() && State::begins_study(&command) {
                    return self.notice("This needs the whole window: close the second run first.".to_owned());
                }
                self.apply_to_study(command);
            }
            Command::Pair(command) => self.apply_to_pair(command),
            command if self.pair.is_some() => self.apply_beside(command),
            command => self.apply_alone(command),
        }
    }

    /// The same in this run, whether or not there is a second one.
    fn apply_alone(&mut self, command: Command) {
        let Some(command) = self.hold(command) else { return };
        match command {
            Command::Go(goal) => self.go(goal),
            Command::GoToText(text) => self.go_to_text(&text),
            Command::ToBreakpoint(direction) => self.seek_breakpoint(direction),
            Command::Play => self.run.playing = if self.run.playing.is_some() { None } else { Some(Instant::now()) },
            Command::Speed(speed) => self.workspace.speed = speed,
            Command::Stop => self.stop(),
            Command::Hover(what) => self.frame.hovered = Some(what),
            Command::Pick(picked) => self.change(|document| document.picked = picked),
            Command::Show(what) => self.view.look.ask(Look::At(what)),
            Command::LightUp(what, notice) => {
                self.notice(notice);
                self.view.lit = what;
                self.view.over_epoch += 1;
            }
            Command::LastTouch(what) => self.ask(Ask::Touch(watched(what))),
            Command::Made(what) => self.go_to_creation(what),
            Command::Explain(ends) => self.run.asked = self.inquire(Ask::Explain(ends)).map(|step| (step, ends)),
            Command::TellTranscript(from, until) => {
                self.run.asked_transcript = self.inquire(Ask::Transcript(from, until)).map(|_| [from, until]);
            }
            Command::TellPast(watched) => {
                self.run.asked_past = self.inquire(Ask::Past(watched)).map(|step| (step, watched));
            }
            Command::TellChain(element) => {
                self.run.asked_chain = self.inquire(Ask::Chain(element)).map(|step| (step, element));
            }
            Command::ShowChain(element) => {
                self.change(|document| document.picked = Some(Outlined::Element(element)));
                self.view.reveal.ask(Some(Pane::Inspector));
                self.view.chain.ask(Some(element));
            }
            Command::ToLargestLoss => self.seek_largest_loss(),
            Command::List(kind, query) => self.list(kind, query, false),
            Command::CopyList(kind, query) => self.list(kind, query, true),
            Command::Find(what) => self.find(what),
            Command::FindWorst => self.find_worst(),
            Command::FindAt(step, what) => self.find_at(step, what),
            Command::Watch(what) => self.watch(watched(what)),
            Command::SwitchWatch(k) => {
                self.change(|document| flip(document.watches.get_mut(k).map(|watch| &mut watch.is_on)));
            }
            Command::Measure => self.run.measuring = Some(Measuring::default()),
            Command::ShowTimes => self.view.times = !self.view.times,
            Command::Fit => self.view.look.ask(Look::Fit),
            Command::ShowDecision => self.view.look.ask(Look::Decision),
            Command::ToggleFollow => self.toggle_follow(),
            Command::LookFrom(side) => self.view.look.ask(Look::From(side)),
            Command::MoveCamera(view, camera) => self.move_camera(view, camera),
            Command::SurfaceView(view) => self.workspace.surfaces.view = view,
            Command::TogglePlane => self.workspace.surfaces.view = self.workspace.surfaces.view.toggled(),
            Command::ToggleSplit => {
                let view = &mut self.workspace.surfaces.view;
                *view = if *view == SurfaceView::Both { SurfaceView::Space } else { SurfaceView::Both };
            }
            Command::HiddenLines => self.workspace.surfaces.hidden = self.workspace.surfaces.hidden.next(),
            Command::ToggleCurved => self.workspace.surfaces.curved = !self.workspace.surfaces.curved,
            Command::Set(key, value) => self.set(key, value),
            Command::ChooseBase(ends) => self.choose_base(ends),
            Command::ResetParameters => {
                self.change(|document| document.edits.retain(|edit| !matches!(edit.kind, EditKind::Parameter { .. })));
            }
            Command::SetRules(rules) => self.set_rules(rules),
            Command::SetForCase(key, value) => self.set_for_case(key, value),
            Command::Layer(layer) => self.change(|document| flip(Some(layer.switch(&mut document.layers)))),
            Command::ColourBy(by) => self.change(|document| document.colour_by = by),
            Command::AddBreakpoint(text) => self.add_breakpoint(text),
            Command::SwitchBreakpoint(k) => {
                self.change(|document| flip(document.breakpoints.get_mut(k).map(|breakpoint| &mut breakpoint.is_on)));
            }
            Command::RemoveBreakpoint(k) => self.change(|document| {
                if k < document.breakpoints.len() {
                    document.breakpoints.remove(k);
                }
            }),
            Command::Reduce(k) => {
                let condition = self.document().breakpoints.get(k).map(|breakpoint| breakpoint.condition.clone());
                if let Some((condition, run)) = condition.zip(self.current_run()) {
                    self.reducing = Some(Reducing::begin(run, condition, self.wake.clone()));
                }
            }
            Command::StopReducing => {
                if let Some(reducing) = &mut self.reducing {
                    reducing.stop();
                }
            }
            Command::Bookmark => self.bookmark(),
            Command::NoteHere => self.note_here(),
            Command::WriteNote(step, note) => self.workspace.write_note(step, note),
            Command::RemoveBookmark(step) => {
                self.change(|document| document.bookmarks.retain(|mark| mark.step != step))
            }
            Command::ExportNotes => self.export_notes(),
            Command::Open(source) => self.open(source, Overrides::default()),
            Command::OpenWith(source, overrides) => self.open(source, *overrides),
            Command::Import => match &self.run.source {
                Some(Source::Mesh(path, options)) => {
                    self.import(path.clone(), options.clone(), self.run.overrides.clone());
                }
                _ => self.notice("What is open was not imported from a mesh file in this window.".to_owned()),
            },
            Command::SetImport(options, gesture) => {
                if let Some(import) = &mut self.run.import {
                    import.set(*options, gesture);
                }
            }
            Command::Convert => {
                if let Some(import) = self.run.import.as_ref().filter(|import| import.is_ready()) {
                    let source = Source::Mesh(import.path.clone(), import.options.clone());
                    self.open(source, import.overrides.clone());
                }
            }
            Command::CancelImport => self.cancel_import(),
            Command::OpenDialog => {
                self.run.dialog.get_or_insert_with(|| Dialog::open(self.wake.clone()));
            }
            Command::OpenPath => self.toggle(Overlay::Path),
            Command::GoTo => self.toggle(Overlay::GoTo),
            Command::FindField => self.toggle(Overlay::Find),
            Command::Palette => self.toggle(Overlay::Palette),
            Command::Help => self.toggle(Overlay::Help),
            Command::CloseOverlay => self.view.overlay = Overlay::Nothing,
            Command::CloseFault(k) => {
                if k < self.view.faults.len() {
                    self.view.faults.remove(k);
                }
            }
            Command::Messages => self.view.messages = !self.view.messages,
            Command::Screenshot => self.frame.screenshot = true,
            Command::Figures => self.view.figure_panel = !self.view.figure_panel,
            Command::ChooseFolder => {
                self.run.folder_dialog.get_or_insert_with(|| Dialog::choose_folder(self.wake.clone()));
            }
            Command::SetFigure(form) => self.workspace.figure = *form,
            Command::Export => self.save_figure(Formats::Both),
            Command::SaveFigure(formats) => self.save_figure(formats),
            Command::Film(FilmCommand::Save(format)) => self.save_film(format),
            Command::Film(FilmCommand::Stop) => {
                if let Some(film) = &mut self.film {
                    film.stop();
                }
            }
            Command::Reopen => {
                if let Some(source) = self.run.source.clone() {
                    self.open(source, self.run.overrides.clone());
                }
            }
            Command::Notes => self.view.notes = !self.view.notes,
            Command::OpenKept => {
                if let Some(source) = self.run.autosave.as_mut().and_then(|autosave| autosave.take()) {
                    self.open(source, Overrides::default());
                }
            }
            Command::DiscardKept => {
                if let Some(autosave) = &mut self.run.autosave {
                    autosave.discard();
                }
            }
            Command::OpenLink(text) => self.open_link(&text),
            Command::CopyLink => self.copy_link(),
            Command::SavePage => self.save_page(),
            Command::SaveRun => drop(self.save_run()),
            Command::SaveMesh => {
                if self.run.opened.is_some() && self.run.moment.is_some() {
                    self.toggle(Overlay::Mesh);
                }
            }
            Command::SaveMeshAs(path) => self.save_mesh(&path),
            Command::Sweep(command) => self.apply_to_sweep(command),
            Command::Undo => self.take_back(Direction::Back),
            Command::Redo => self.take_back(Direction::Forward),
            Command::Reveal(pane) => self.view.reveal.ask(Some(pane)),
            Command::Arrange(layout) => self.change(|document| document.layout = Some(layout)),
            Command::ResetLayout => {
                self.change(|document| document.layout = None);
                self.view.relayout.ask(());
            }
            Command::ToggleTheme => self.frame.toggle_theme = true,
            Command::Escape => self.escape(),
            Command::Pair(command) => self.apply_to_pair(command),
            Command::Study(command) => self.apply_to_study(command),
            Command::Presentation(command) => self.apply_to_presentation(command),
        }
    }

    /// Ends a frame: does what its panels ask for. Returns whether the next frame has something new to show.
    pub(in crate::app::window) fn end_frame(&mut self, commands: Vec<Command>) -> bool {
        let pointed = std::mem::take(&mut self.frame.pointed);
        let hovered = self.begin_hovering();
        let is_asked = commands.iter().any(|command| !command.is_hover());
        commands.into_iter().for_each(|command| self.apply(command));
        let is_pointed_anew = self.frame.pointed != pointed;
        self.view.over_epoch += u64::from(is_pointed_anew);
        is_asked | is_pointed_anew | self.is_hovered_anew(hovered)
    }

    /// Forgets what the pointer was on in each run. Returns it.
    fn begin_hovering(&mut self) -> [Option<Outlined>; 2] {
        let other = self.pair.as_mut().and_then(|pair| std::mem::take(&mut pair.other.frame).hovered);
        [std::mem::take(&mut self.frame).hovered, other]
    }

    /// Whether the pointer is on something else than it was before, in either run.
    fn is_hovered_anew(&mut self, [before, other]: [Option<Outlined>; 2]) -> bool {
        let is_new = self.frame.hovered != before;
        self.view.over_epoch += u64::from(is_new);
        self.pair.as_mut().is_some_and(|pair| pair.other.is_hovered_anew([other, None])) || is_new
    }

    /// While the run is played, goes on when it is time. Returns how long to wait until then.
    pub(in crate::app::window) fn play_on(&mut self) -> Option<Duration> {
        let waits = [self.pair.as_mut().and_then(|pair| pair.other.play_on()), self.play_on_alone()];
        waits.into_iter().flatten().min()
    }

    fn play_on_alone(&mut self) -> Option<Duration> {
        let last = self.run.playing.filter(|_| !self.run.is_busy())?;
        let period = Duration::from_secs_f32(1.0 / self.workspace.speed.max(0.1));
        let left = period.checked_sub(last.elapsed()).filter(|left| !left.is_zero());
        if left.is_none() {
            self.run.playing = Some(Instant::now());
            self.go(Goal::Quads(1));
        }
        left
    }

    /// While times are measured, goes on to the next step once the frame before has shown the last one.
    pub(in crate::app::window) fn measure_on(&mut self) {
        let is_there = !self.run.is_busy();
        let took = self.run.moment.as_ref().map_or(Duration::ZERO, |moment| moment.took);
        let end = self.run.track.len() as u64;
        let Some(measuring) = &mut self.run.measuring else { return };
        if let Some(goal) = measuring.next(is_there, took, end) {
            self.go(goal);
        } else if let Some(told) = measuring.told() {
            println!("{told}");
            self.run.measuring = None;
            self.notice(told);
        }
    }

    /// Shows a fault until the user closes it.
    pub(in crate::app::window) fn complain(&mut self, fault: &Fault) {
        self.warn(fault.to_string());
    }

    /// Shows what went wrong until the user closes it.
    fn warn(&mut self, text: String) {
        self.view.log.keep(text.clone(), true, self.step());
        // The latest one is shown.
        self.view.notice = None;
        self.view.faults.retain(|old| *old != text);
        self.view.faults.push(text);
    }

    /// Shows for a while what was done.
    pub(in crate::app::window) fn notice(&mut self, text: String) {
        self.view.log.keep(text.clone(), false, self.step());
        self.view.notice = Some((text, Instant::now()));
    }

    /// The step that is shown.
    fn step(&self) -> Option<u64> {
        self.run.moment.as_ref().map(|moment| moment.step)
    }

    /// Asks the session to go somewhere.
    pub(super) fn go(&mut self, goal: Goal) {
        self.ask(Ask::Go(goal, Instant::now()));
    }

    /// Asks the session for another state; it owes an answer to that.
    pub(super) fn ask(&mut self, ask: Ask) {
        let Some(session) = &self.run.session else { return };
        session.ask(ask);
        self.run.waiting += 1;
        self.run.since.get_or_insert_with(Instant::now);
    }

    /// Changes the document, so that undo takes it back.
    pub(super) fn change(&mut self, change: impl FnOnce(&mut Document)) {
        if let Some(before) = self.workspace.change(change) {
            self.follow(&before);
        }
    }

    /// Undoes or redoes a change.
    fn take_back(&mut self, direction: Direction) {
        if let Some(import) = &mut self.run.import {
            return import.take_back(direction);
        }
        let Some(before) = self.workspace.take_back(direction) else { return };
        self.follow(&before);
        if self.document().layout != before.layout {
            self.view.relayout.ask(());
        }
    }

    /// Has the run and the views follow a change of the document.
    pub(super) fn follow(&mut self, before: &Document) {
        let document = &self.workspace.document;
        if document.layers != before.layers || document.colour_by != before.colour_by {
            self.view.style_epoch += 1;
        }
        if document.breakpoints != before.breakpoints {
            self.count_breakpoints();
        }
        let document = &self.workspace.document;
        if document.picked != before.picked {
            self.view.scroll.ask(document.picked);
        }
        self.view.over_epoch += 1;
        if document.edits != before.edits {
            self.run.recorded = false;
            self.ask(Ask::Edits(document.edits.clone()));
            self.leave_changed_run();
        }
    }

    /// Replaces the base if it has just been selected, or else decides the next selection.
    fn choose_base(&mut self, [a, b]: [NodeId; 2]) {
        let Some(moment) = &self.run.moment else { return };
        let selected = matches!(moment.event, Some(Event::BaseSelected { .. }));
        let step = moment.step - u64::from(selected);
        self.edit([Edit { step, kind: EditKind::Base { a, b } }]);
        let which = if selected { "The base is now" } else { "The next base will be" };
        self.notice(format!("{which} {}.", words::segment([a, b])));
    }

    /// Asks the session about the current state. Returns its step.
    fn inquire(&self, ask: Ask) -> Option<u64> {
        let (moment, session) = (self.run.moment.as_ref()?, self.run.session.as_ref()?);
        session.ask(ask);
        Some(moment.step)
    }

    /// Has a list of the current state made.
    fn list(&mut self, kind: ListKind, query: Query, as_text: bool) {
        let Some(moment) = &self.run.moment else { return };
        let mesh = moment.mesh.clone();
        let born = match kind {
            ListKind::Elements => self.run.born.of_quads(moment.step, mesh.element_slots()),
            ListKind::Nodes => self.run.born.of_nodes(moment.step, mesh.node_slots()),
        };
        let recorded = RecordedSteps { step: moment.step, born, changes: self.run.change_log.clone() };
        self.run.lists.make(kind, query, as_text, mesh, recorded, self.wake.clone());
    }

    fn move_camera(&mut self, view: ViewKind, camera: ViewCamera) {
        match view {
            ViewKind::Plane => self.view.plane = camera,
            ViewKind::Space => self.view.space = camera,
            ViewKind::Import => {
                if let Some(import) = &mut self.run.import {
                    import.view = camera;
                }
            }
        }
    }

    /// Opens something over the window, or closes it if it is open.
    fn toggle(&mut self, overlay: Overlay) {
        self.view.overlay = if self.view.overlay == overlay { Overlay::Nothing } else { overlay };
    }

    fn escape(&mut self) {
        if self.view.overlay != Overlay::Nothing {
            self.view.overlay = Overlay::Nothing;
        } else if self.run.import.is_some() {
            self.cancel_import();
        } else if self.view.chrome == Chrome::Presentation {
            self.end_presentation();
        } else if self.view.figure_panel || self.view.notes || self.view.messages {
            // What lies over the views is closed before what is selected behind it is let go.
            (self.view.figure_panel, self.view.notes, self.view.messages) = (false, false, false);
        } else if self.run.playing.is_some() {
            self.run.playing = None;
        } else {
            self.change(|document| document.picked = None);
        }
    }

    /// Stops all work under way: playing, opening, and what the session does.
    fn stop(&mut self) {
        self.run.playing = None;
        self.run.held.clear();
        self.stop_opening();
        if let Some(session) = &self.run.session {
            session.stop();
        }
    }
}

fn flip(switch: Option<&mut bool>) {
    if let Some(on) = switch {
        *on = !*on;
    }
}
