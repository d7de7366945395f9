//! The only place where a command changes anything.

use std::path::PathBuf;
use std::time::Instant;

use super::command::Command;
use super::figures::Formats;
use super::files;
use super::measure::Measuring;
use super::session::{Direction, Goal, Source};
use super::state::{Kept, Look, Over, Place, State};
use super::words;
use crate::core::convert::event::Event;
use crate::core::convert::parameters::Parameters;
use crate::core::fault::Fault;
use crate::core::io::run_file;
use crate::core::mesh::ids::NodeId;
use crate::core::run::breakpoint::Condition;
use crate::core::run::run::{Edit, EditKind};
use crate::core::run::watch::Watched;
use crate::render::scene::Outlined;

/// How many changes can be taken back.
const UNDO: usize = 200;

impl State {
    /// Does what a person asks for.
    pub fn apply(&mut self, command: Command) {
        if self.import.is_some() && !command.fits_import() {
            return self.notice("That belongs to a run: convert the mesh first, or cancel.".to_owned());
        }
        match command {
            Command::Go(goal) => self.go(goal),
            Command::ToBreakpoint(direction) => self.seek_breakpoint(direction),
            Command::Play => self.playing = if self.playing.is_some() { None } else { Some(Instant::now()) },
            Command::Speed(speed) => self.speed = speed,
            Command::Stop => {
                self.playing = None;
                self.stop_opening();
                if let Some(session) = &self.session {
                    session.stop();
                }
            }
            Command::Pick(picked) => self.keep(|kept| kept.picked = picked),
            Command::Show(what) => self.look = Some(Look::At(what)),
            Command::LastTouch(what) => {
                let Some(session) = &self.session else { return };
                session.go_to_touch(watched(what));
                self.wait();
            }
            Command::Made(element) => {
                let Some(session) = &self.session else { return };
                session.go_to_making(element);
                self.wait();
            }
            Command::Watch(what) => {
                let watched = watched(what);
                self.keep(|kept| match kept.watches.iter().position(|w| w.0 == watched) {
                    Some(k) => drop(kept.watches.remove(k)),
                    None => kept.watches.push((watched, true)),
                });
            }
            Command::SwitchWatch(k) => self.keep(|kept| {
                if let Some(watch) = kept.watches.get_mut(k) {
                    watch.1 = !watch.1;
                }
            }),
            Command::Measure => self.measuring = Some(Measuring::default()),
            Command::ShowTimes => self.show_times = !self.show_times,
            Command::Fit => self.look = Some(Look::Fit),
            Command::ShowDecision => self.look = Some(Look::Decision),
            Command::Place(place) => self.space.place = place,
            Command::TogglePlace => self.space.place = self.space.place.toggled(),
            Command::ToggleSplit => {
                self.space.place = if self.space.place == Place::Both { Place::Space } else { Place::Both };
            }
            Command::LookFrom(side) => self.look = Some(Look::From(side)),
            Command::HiddenLines => self.space.hidden = self.space.hidden.next(),
            Command::ToggleCurved => self.space.curved = !self.space.curved,
            Command::Set(key, value) => self.set(key, value),
            Command::ChooseBase(ends) => self.choose_base(ends),
            Command::ResetParameters => {
                self.keep(|kept| kept.edits.retain(|edit| !matches!(edit.kind, EditKind::Parameter { .. })));
            }
            Command::Layer(layer) => self.keep(|kept| {
                let on = layer.switch(&mut kept.layers);
                *on = !*on;
            }),
            Command::ColourBy(by) => self.keep(|kept| kept.colour_by = by),
            Command::AddBreakpoint(text) => self.add_breakpoint(text),
            Command::SwitchBreakpoint(k) => self.keep(|kept| {
                if let Some(breakpoint) = kept.breakpoints.get_mut(k) {
                    breakpoint.1 = !breakpoint.1;
                }
            }),
            Command::RemoveBreakpoint(k) => self.keep(|kept| {
                if k < kept.breakpoints.len() {
                    kept.breakpoints.remove(k);
                }
            }),
            Command::Bookmark => self.bookmark(),
            Command::Open(source) => self.open(source),
            Command::Import => match &self.source {
                Some(Source::Mesh(path, options)) => self.import(path.clone(), options.clone()),
                _ => self.notice("What is open is no mesh that was opened here.".to_owned()),
            },
            Command::SetImport(options, gesture) => {
                if let Some(import) = &mut self.import {
                    import.set(*options, gesture);
                }
            }
            Command::Convert => {
                if let Some(import) = self.import.as_ref().filter(|import| import.is_ready()) {
                    self.open(Source::Mesh(import.path.clone(), import.options.clone()));
                }
            }
            Command::CancelImport => self.cancel_import(),
            Command::OpenDialog => self.ask_for_file(),
            Command::OpenPath => self.show(Over::Path),
            Command::GoTo => self.show(Over::GoTo),
            Command::Palette => self.show(Over::Palette),
            Command::Help => self.show(Over::Help),
            Command::Screenshot => self.screenshot = true,
            Command::Export => self.save_figure(Formats::Both),
            Command::Figures => self.figures.shown = !self.figures.shown,
            Command::SaveFigure(formats) => self.save_figure(formats),
            Command::Reopen => {
                if let Some(source) = self.source.clone() {
                    self.open(source);
                }
            }
            Command::Notes => self.notes = !self.notes,
            Command::OpenKept => {
                if let Some(source) = self.autosave.as_mut().and_then(|autosave| autosave.take()) {
                    self.open(source);
                }
            }
            Command::DiscardKept => {
                if let Some(autosave) = &mut self.autosave {
                    autosave.discard();
                }
            }
            Command::SaveRun => drop(self.save_run()),
            Command::SaveMesh => self.ask_for_mesh(),
            Command::Undo => self.take_back(Direction::Back),
            Command::Redo => self.take_back(Direction::Forward),
            Command::ResetLayout => self.reset_layout = true,
            Command::ToggleTheme => self.toggle_theme = true,
            Command::Escape => self.escape(),
        }
    }

    fn go(&mut self, goal: Goal) {
        let Some(session) = &self.session else { return };
        session.go(goal);
        self.wait();
    }

    /// Changes what a person has set, so that it can be taken back.
    fn keep(&mut self, change: impl FnOnce(&mut Kept)) {
        let before = self.kept.clone();
        change(&mut self.kept);
        if self.kept != before {
            self.follow(&before);
            self.undo.push(before);
            if self.undo.len() > UNDO {
                self.undo.remove(0);
            }
            self.redo.clear();
        }
    }

    /// A person has arranged the docks; can be taken back.
    pub fn arrange(&mut self, layout: Option<String>) {
        let relayout = self.relayout;
        self.keep(|kept| kept.layout = layout);
        self.relayout = relayout;
    }

    /// Lets the window follow what a person has set.
    fn follow(&mut self, before: &Kept) {
        if self.kept.edits != before.edits {
            self.run_changed();
        }
        if self.kept.layers != before.layers || self.kept.colour_by != before.colour_by {
            self.style_epoch += 1;
        }
        if self.kept.breakpoints != before.breakpoints
            && let Some(session) = &self.session
        {
            // Switched off, a breakpoint keeps its count.
            let all = self.kept.breakpoints.iter().filter_map(|b| Condition::parse(&b.0).ok());
            session.count(all.collect());
        }
        // Only undo changes it here: a person's hand has changed the docks already.
        self.relayout |= self.kept.layout != before.layout;
        if self.kept.picked != before.picked {
            self.scroll_to = self.kept.picked;
        }
        self.over_epoch += 1;
    }

    /// Undoes or redoes a change.
    fn take_back(&mut self, direction: Direction) {
        if let Some(import) = &mut self.import {
            return import.take_back(direction);
        }
        let (from, to) = match direction {
            Direction::Back => (&mut self.undo, &mut self.redo),
            Direction::Forward => (&mut self.redo, &mut self.undo),
        };
        let Some(kept) = from.pop() else { return };
        let before = std::mem::replace(&mut self.kept, kept);
        to.push(before.clone());
        self.follow(&before);
    }

    fn set(&mut self, key: &'static str, value: String) {
        let Some(step) = self.moment.as_ref().map(|moment| moment.step) else { return };
        if self.parameter(key).as_ref() == Some(&value) {
            return;
        }
        match EditKind::parameter(key, &value) {
            Ok(kind) => self.edit(Edit { step, kind }),
            Err(fault) => self.complain(&fault),
        }
    }

    fn edit(&mut self, edit: Edit) {
        self.keep(|kept| {
            kept.edits.retain(|old| old.step != edit.step || !edit.kind.replaces(&old.kind));
            let place = kept.edits.partition_point(|old| old.step <= edit.step);
            kept.edits.insert(place, edit);
        });
    }

    /// Where a base has just been selected, another takes its place; else the next selection takes it.
    fn choose_base(&mut self, [a, b]: [NodeId; 2]) {
        let Some(moment) = &self.moment else { return };
        let selected = matches!(moment.event, Some(Event::BaseSelected { .. }));
        let step = moment.step - u64::from(selected);
        self.edit(Edit { step, kind: EditKind::Base { a, b } });
        let which = if selected { "The base is now" } else { "The next base will be" };
        self.notice(format!("{which} {}.", words::segment(a, b)));
    }

    fn add_breakpoint(&mut self, text: String) {
        let text = text.trim().to_owned();
        if text.is_empty() || self.kept.breakpoints.iter().any(|b| b.0 == text) {
            return;
        }
        match Condition::parse(&text) {
            Ok(_) => self.keep(|kept| kept.breakpoints.push((text, true))),
            Err(fault) => self.complain(&fault),
        }
    }

    fn seek_breakpoint(&mut self, direction: Direction) {
        let stops = self.stops();
        if stops.conditions.is_empty() && stops.watched.is_empty() {
            return self.notice("No breakpoint is on: write a condition in the panel Breakpoints.".to_owned());
        }
        let Some(session) = &self.session else { return };
        session.go_to_break(stops, direction);
        self.wait();
    }

    /// One more answer is owed.
    fn wait(&mut self) {
        self.waiting += 1;
        self.since.get_or_insert_with(Instant::now);
    }

    fn bookmark(&mut self) {
        let Some(step) = self.moment.as_ref().map(|moment| moment.step) else { return };
        self.keep(|kept| match kept.bookmarks.binary_search(&step) {
            Ok(k) => drop(kept.bookmarks.remove(k)),
            Err(k) => kept.bookmarks.insert(k, step),
        });
    }

    pub fn show(&mut self, over: Over) {
        self.overlay = if self.overlay == over { Over::Nothing } else { over };
        self.field.clear();
    }

    fn escape(&mut self) {
        if self.overlay != Over::Nothing {
            self.overlay = Over::Nothing;
        } else if self.import.is_some() {
            self.cancel_import();
        } else if self.playing.is_some() {
            self.playing = None;
        } else {
            self.keep(|kept| kept.picked = None);
        }
    }

    /// Ends the conversion that has begun, and back to how the mesh is taken; else gives up the mesh.
    fn cancel_import(&mut self) {
        if self.is_opening() {
            self.stop_opening();
        } else {
            self.give_up_import();
        }
    }

    /// Goes where the field of that name says: a step, or nq=N.
    pub fn go_to_field(&mut self) {
        let text = self.field.trim().replace(['\u{2009}', ' '], "");
        let goal = match text.to_lowercase().strip_prefix("nq=") {
            Some(quads) => quads.parse().map(Goal::ToQuads),
            None => text.trim_start_matches("step=").parse().map(Goal::Step),
        };
        match goal {
            Ok(goal) => {
                self.overlay = Over::Nothing;
                self.go(goal);
            }
            Err(_) => self.complain(
                &Fault::new(format!("\"{}\" is no step", self.field)).remedy("Write a step such as 812, or nq=100"),
            ),
        }
    }

    /// Opens what the path field says.
    pub fn open_field(&mut self) {
        let text = self.field.trim().to_owned();
        self.overlay = Over::Nothing;
        self.open(Source::named(&text));
    }

    /// Saves the run in the working folder, under a name that is free; tells where.
    pub fn save_run(&mut self) -> Option<PathBuf> {
        let run = self.run()?;
        let path = files::free_path(&format!("{}-run", run.case.name), "toml");
        match run_file::write(&path, &run) {
            Ok(()) => {
                if let Some(autosave) = &mut self.autosave {
                    autosave.saved(&run);
                }
                self.notice(format!("The run was saved as {}.", path.display()));
                Some(path)
            }
            Err(fault) => {
                self.complain(&fault);
                None
            }
        }
    }

    fn ask_for_file(&mut self) {
        self.dialog.get_or_insert_with(|| files::Dialog::open(self.wake.clone()));
    }

    /// Parameters of the case, before any edit.
    pub fn parameters_of_case(&self) -> Option<&Parameters> {
        self.opened.as_ref().map(|opened| &opened.case.parameters)
    }
}

/// The same for the run.
pub fn watched(what: Outlined) -> Watched {
    match what {
        Outlined::Node(node) => Watched::Node(node),
        Outlined::Edge([a, b]) => Watched::Edge(a.min(b), a.max(b)),
        Outlined::Element(element) => Watched::Element(element),
    }
}
