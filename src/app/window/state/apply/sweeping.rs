//! Sweeps the run that is open, and opens the runs of cells.

use super::{Overlay, State};
use crate::app::window::layout::Pane;
use crate::app::window::sweep::{SweepCommand, SweepWork};

impl State {
    /// Does what the user asks for with the sweep.
    pub(super) fn sweep(&mut self, command: SweepCommand) {
        match command {
            SweepCommand::Show => self.view.reveal.ask(Some(Pane::Sweep)),
            SweepCommand::Set(form) => self.workspace.sweep = *form,
            SweepCommand::Run => self.run_sweep(),
            SweepCommand::Stop => {
                if let Some(sweep) = &mut self.run.sweep {
                    sweep.stop();
                }
            }
            SweepCommand::OpenCell(cell) => {
                if let Some((source, overrides, run)) = self.run.sweep.as_ref().and_then(|sweep| sweep.run_of(cell)) {
                    self.open_read(source, overrides, move || Ok(run));
                }
            }
            SweepCommand::Save => match &self.run.sweep {
                Some(sweep) if sweep.sweep.is_some() => self.toggle(Overlay::Sweep),
                _ => self.notice("There is no sweep yet: run one first.".to_owned()),
            },
            SweepCommand::SaveAs(path) => self.save_sweep(&path),
        }
    }

    /// Begins to sweep the run as it is, with the changes at its steps.
    fn run_sweep(&mut self) {
        self.view.reveal.ask(Some(Pane::Sweep));
        let (Some(source), Some(mut run)) = (self.run.source.clone(), self.current_run()) else { return };
        // Bookmarks belong to the steps of this run.
        run.bookmarks.clear();
        match self.workspace.sweep.axes() {
            Ok(axes) => {
                let earlier = self.run.sweep.take().and_then(|mut sweep| sweep.sweep.take());
                let opened = (source, self.run.overrides.clone());
                self.run.sweep = Some(SweepWork::begin(opened, run, axes, earlier, self.wake.clone()));
            }
            Err(fault) => self.complain(&fault),
        }
    }

    /// Starts to write the sweep to a path.
    fn save_sweep(&mut self, path: &str) {
        let Some(sweep) = &self.run.sweep else { return };
        match sweep.save(path, self.workspace.sweep.figure(), self.wake.clone()) {
            Ok(writing) => {
                self.run.meshes.extend(writing);
                self.view.overlay = Overlay::Nothing;
            }
            Err(fault) => self.complain(&fault),
        }
    }
}
