//! The mesh of the state at hand, written for other programs beside the window.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use super::files::{answers, free_path};
use super::session::{Moment, Opened};
use super::state::{Over, State};
use crate::app::output::MeshTarget;
use crate::app::work;
use crate::core::convert::phase::Phase;
use crate::core::fault::Fault;

/// What is told of a mesh that is being written: for people, or why it was not.
pub type Saving = Receiver<Result<String, Fault>>;

impl State {
    /// Asks where the mesh is to go.
    pub fn ask_for_mesh(&mut self) {
        let (Some(moment), Some(opened)) = (&self.moment, &self.opened) else { return };
        let step = if is_done(moment) { String::new() } else { format!("-step-{}", moment.step) };
        let path = free_path(&format!("{}{step}", opened.case.name), "vtu");
        self.show(Over::Mesh);
        self.field = path.display().to_string();
    }

    /// Whether the mesh at hand is the one of the end.
    pub fn is_at_the_end(&self) -> bool {
        self.moment.as_deref().is_some_and(is_done)
    }

    /// Writes the mesh of the state at hand where the field says, in the format of the extension.
    pub fn save_mesh_field(&mut self) {
        let (Some(moment), Some(opened)) = (self.moment.clone(), self.opened.clone()) else { return };
        let path = PathBuf::from(self.field.trim());
        if path.exists() {
            let fault = Fault::new("There is a file of this name").at(path.display().to_string());
            return self.complain(&fault.remedy("Name another one: nothing is written over"));
        }
        let named = |fault: Fault| match fault.place.is_empty() {
            true => fault.at(path.display().to_string()),
            false => fault,
        };
        let target =
            match MeshTarget::file(path.clone()).map_err(named).and_then(|target| target.check().map(|()| target)) {
                Ok(target) => target,
                Err(fault) => return self.complain(&fault),
            };
        self.overlay = Over::Nothing;
        let (tell, told) = channel();
        let wake = self.wake.clone();
        std::thread::spawn(move || {
            // Nobody listens where the window has been closed.
            let _ = tell.send(write(&moment, &opened, &target, &path));
            wake();
        });
        self.saving.push(told);
    }

    /// Hears of the meshes that were being written.
    pub fn hear_saving(&mut self) {
        for answer in answers(&mut self.saving) {
            match answer {
                Ok(said) => self.notice(said),
                Err(fault) => self.complain(&fault),
            }
        }
    }
}

fn is_done(moment: &Moment) -> bool {
    matches!(moment.phase, Phase::Done)
}

/// Checks and writes a mesh; what is to be told.
fn write(moment: &Arc<Moment>, opened: &Arc<Opened>, target: &MeshTarget, path: &Path) -> Result<String, Fault> {
    let background = &opened.background;
    let data = target.shows_data().then_some((&background.sizing, None));
    let (export, flaw) = work::exported(&moment.mesh, &background.names, data, !is_done(moment))?;
    if let Some(flaw) = flaw {
        return Err(flaw.at("the mesh was not saved"));
    }
    target.write(&export.file)?;
    let (quads, triangles) = (export.file.quads.len(), export.file.triangles.len());
    let rest = if triangles > 0 { format!(" and {triangles} triangles") } else { String::new() };
    Ok(format!("The mesh was saved as {}: {quads} quadrilaterals{rest}.", path.display()))
}
