//! Sweeps the run that the panels show, and opens the runs of cells.

use super::{Overlay, State};
use crate::app::window::layout::Pane;
use crate::app::window::sweep::{SweepCommand, SweepWork};

impl State {
    /// Does what the user asks for with the sweep.
    pub(super) fn apply_to_sweep(&mut self, command: SweepCommand) {
        match command {
            SweepCommand::Show => self.view.reveal.ask(Some(Pane::Sweep)),
            SweepCommand::Set(form) => self.workspace.sweep = *form,
            SweepCommand::Run => self.run_sweep(),
            SweepCommand::Stop => {
                if let Some(sweep) = &mut self.sweep {
                    sweep.stop();
                }
            }
            SweepCommand::OpenBeside(cell) => {
                if let Some((source, overrides, run)) = self.sweep.as_ref().and_then(|sweep| sweep.run_of(cell)) {
                    self.open_read_beside(source, overrides, move || Ok(run));
                }
            }
            SweepCommand::Open(cell) => {
                if let Some((source, overrides, run)) = self.sweep.as_ref().and_then(|sweep| sweep.run_of(cell)) {
                    self.open_read(source, overrides, move || Ok(run));
                }
            }
            SweepCommand::Save => match &self.sweep {
                Some(sweep) if sweep.sweep.is_some() => self.toggle(Overlay::Sweep),
                _ => self.notice("There is no sweep yet: run one first.".to_owned()),
            },
            SweepCommand::SaveAs(path) => self.save_sweep(&path),
        }
    }

    /// Begins to sweep the run as it is, with the changes at its steps.
    fn run_sweep(&mut self) {
        self.view.reveal.ask(Some(Pane::Sweep));
        let active = self.active();
        let (Some(source), Some(mut run)) = (active.run.source.clone(), active.current_run()) else {
            return self.notice("There is nothing to sweep: open a case first.".to_owned());
        };
        let overrides = active.run.overrides.clone();
        // Bookmarks belong to the steps of this run.
        run.bookmarks.clear();
        match self.workspace.sweep.axes() {
            Ok(axes) => {
                let earlier = self.sweep.take().and_then(|mut sweep| sweep.sweep.take());
                self.sweep = Some(SweepWork::begin((source, overrides), run, axes, earlier, self.wake.clone()));
            }
            Err(fault) => self.complain(&fault),
        }
    }

    /// Starts to write the sweep to a path.
    fn save_sweep(&mut self, path: &str) {
        let Some(sweep) = &self.sweep else { return };
        match sweep.save(path, self.workspace.sweep.figure(), self.wake.clone()) {
            Ok(writing) => {
                self.run.meshes.extend(writing);
                self.view.overlay = Overlay::Nothing;
            }
            Err(fault) => self.complain(&fault),
        }
    }
}
