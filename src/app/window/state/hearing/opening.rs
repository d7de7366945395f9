//! What is being opened: it takes the place of what is open, or is refused.

use std::path::PathBuf;
use std::sync::Arc;

use web_time::Instant;

use crate::app::window::autosave::Marks;
use crate::app::window::files::Watcher;
use crate::app::window::session::{Goal, Opened, SessionNews, Source};
use crate::app::window::state::{Look, Opening, RunState, State, ViewCamera};
use crate::app::window::words;
use crate::core::case::built_in;
use crate::core::fault::Fault;
use crate::core::formats::save;
use crate::core::lesson;

impl State {
    /// Takes in what the preview of an import reports; a mesh that cannot be read is given up.
    pub(in crate::app::window) fn hear_import(&mut self, dark: bool) {
        let Some(import) = &mut self.run.import else { return };
        if let Some(fault) = import.look(dark) {
            self.complain(&self.with_what_stays(fault));
            self.give_up_import();
        }
    }

    /// A fault that also says that the run that is open stays, if there is one.
    fn with_what_stays(&self, mut fault: Fault) -> Fault {
        if let Some(opened) = &self.run.opened {
            let stays = format!("{} stays open", opened.run.case.name);
            fault.remedy = if fault.remedy.is_empty() { stays } else { format!("{}; {stays}", fault.remedy) };
        }
        fault
    }

    pub(super) fn hear_opening(&mut self) {
        while let Some(told) = self.run.opening.as_ref().and_then(|opening| opening.session.hear().next()) {
            match told {
                SessionNews::Progress(progress) => self.run.progress = Some(progress),
                SessionNews::Opened(opened) => {
                    if let Some(opening) = self.run.opening.take() {
                        self.begin(opening, opened);
                    }
                }
                SessionNews::Fault(fault, asks) => {
                    let opening = self.run.opening.take();
                    match opening {
                        _ if fault.is_stop() => {}
                        Some(Opening { source: Source::Mesh(path, options), overrides, .. }) if !self.is_second => {
                            // The import shows why, and how the mesh may be imported in another way.
                            if self.run.import.is_none() {
                                self.import(path, options, overrides);
                            }
                            if let Some(import) = &mut self.run.import {
                                import.refuse_conversion(fault);
                            }
                        }
                        _ => self.complain(&self.with_what_stays(fault)),
                    }
                    if let Some(autosave) = &mut self.run.autosave {
                        autosave.failed();
                    }
                    self.answered(asks);
                }
                _ => {}
            }
        }
    }

    /// A run is open and takes the place of the one before.
    fn begin(&mut self, opening: Opening, opened: Arc<Opened>) {
        let Opening { source, overrides, session } = opening;
        self.give_up_import();
        let recovered = self.run.autosave.as_ref().and_then(|autosave| autosave.recovered(&source)).cloned();
        // What is opened again, with other parameters for instance, keeps its breakpoints.
        let is_again = self.run.source.as_ref() == Some(&source);
        let breakpoints = if is_again { self.document().breakpoints.clone() } else { Vec::new() };
        let watcher = match &source {
            // The window itself writes this file, and nobody else one that is not on a disk.
            Source::File(_) if recovered.is_some() => None,
            _ if !save::ON_DISK => None,
            Source::File(path) | Source::Mesh(path, _) => Some(Watcher::of(path.clone(), self.wake.clone())),
            Source::Lesson(name) if lesson::built_in::title(name).is_none() => {
                Some(Watcher::of(PathBuf::from(name), self.wake.clone()))
            }
            Source::BuiltIn(_) | Source::Lesson(_) | Source::Linked(_) => None,
        };
        let is_figure =
            matches!(&source, Source::BuiltIn(name) if built_in::FIGURES.iter().any(|figure| figure.0 == name));
        let old = std::mem::take(&mut self.run);
        self.run = RunState {
            source: Some(source),
            overrides,
            number: old.number + 1,
            track_epoch: old.track_epoch + 1,
            verdict: old.verdict,
            progress: old.progress,
            autosave: old.autosave,
            pictures: old.pictures,
            dialog: old.dialog,
            folder_dialog: old.folder_dialog,
            figures: old.figures,
            meshes: old.meshes,
            held: old.held,
            session: Some(session),
            watcher,
            since: Some(Instant::now()),
            waiting: 1,
            ..RunState::default()
        };
        self.workspace.begin(opened.run.edits().to_vec(), opened.run.bookmarks.clone());
        self.workspace.document.breakpoints = breakpoints;
        self.view.notes = is_figure;
        for view in [&mut self.view.plane, &mut self.view.space] {
            *view = ViewCamera { camera: None, is_fitted: true, ..*view };
        }
        self.view.look.ask(opened.run.camera.map_or(Look::Fit, Look::Kept));
        self.frame.hovered = None;
        self.run.awaited = opened.run.shown.as_ref().and_then(|shown| shown.state()).copied();
        if let Some(shown) = self.run.awaited {
            self.go(if shown.at.is_some() { Goal::Step(shown.step) } else { Goal::End });
        }
        self.run.opened = Some(opened);
        if let Some(marks) = recovered {
            self.recover(marks);
        }
        self.count_breakpoints();
        self.begin_study();
    }

    /// Sets what was set in the window of a recovered run, and says so.
    fn recover(&mut self, marks: Marks) {
        let Marks { step, breakpoints, watches } = marks;
        let document = &mut self.workspace.document;
        (document.breakpoints, document.watches) = (breakpoints, watches);
        let of = [
            (document.edits.len(), "edit"),
            (document.bookmarks.len(), "bookmark"),
            (document.breakpoints.len(), "breakpoint"),
            (document.watches.len(), "watchpoint"),
        ];
        let counts = of.into_iter().filter(|(count, _)| *count > 0).map(|(n, one)| words::counted(n as u64, one));
        let with = counts.collect::<Vec<_>>().join(", ");
        let name = self.run.opened.as_ref().map_or("The run", |opened| opened.run.case.name.as_str());
        let text = format!("{name} is recovered at step {}, with {with}.", words::grouped(step));
        self.notice(text);
        self.go(Goal::Step(step));
    }
}
