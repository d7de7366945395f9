//! Writes the current mesh for other programs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::files::{self, Writing, free_path};
use super::session::{Moment, Opened, Wake};
use super::state::State;
use super::words;
use crate::app::output::MeshTarget;
use crate::app::work;
use crate::core::convert::Phase;
use crate::core::fault::Fault;
use crate::core::formats::save;

/// A path for the current mesh that is free.
pub fn suggested_path(state: &State) -> String {
    let (Some(moment), Some(opened)) = (&state.run().moment, &state.run().opened) else { return String::new() };
    let step = if state.run().is_at_the_end() { String::new() } else { format!("-step-{}", moment.step) };
    free_path(&format!("{}{step}", opened.run.case.name), "vtu").display().to_string()
}

/// Starts to write the current mesh, in the format of the path's extension; does nothing if nothing is open. `wake` is
/// called when it is done.
///
/// # Errors
/// If there is such a file, or no such format.
pub fn begin(state: &State, path: &str, wake: Wake) -> Result<Option<Writing>, Fault> {
    let (Some(moment), Some(opened)) = (state.run().moment.clone(), state.run().opened.clone()) else {
        return Ok(None);
    };
    let path = PathBuf::from(path.trim());
    if save::is_file(&path) {
        let fault = Fault::new("There is a file of this name").at(path.display().to_string());
        return Err(fault.remedy("Choose another name: no file is overwritten"));
    }
    let named = |fault: Fault| match fault.place.is_empty() {
        true => fault.at(path.display().to_string()),
        false => fault,
    };
    let target = MeshTarget::file(path.clone()).map_err(named).and_then(|target| target.check().map(|()| target))?;
    Ok(Some(files::work(wake, move || write(&moment, &opened, &target, &path))))
}

/// Checks and writes a mesh. Returns what to tell the user.
fn write(moment: &Arc<Moment>, opened: &Arc<Opened>, target: &MeshTarget, path: &Path) -> Result<String, Fault> {
    let background = &opened.background;
    let data = target.shows_data().then_some((&background.sizing, None));
    let (export, flaw) = work::exported(&moment.mesh, &background.names, data, moment.phase != Phase::Done)?;
    if let Some(flaw) = flaw {
        return Err(flaw.at("the mesh was not saved"));
    }
    target.write(&export.file)?;
    let (quads, triangles) = (export.file.quads.len(), export.file.triangles.len());
    let [quads, triangles] =
        [(quads, "quadrilateral"), (triangles, "triangle")].map(|(n, one)| (n, words::counted(n as u64, one)));
    let rest = if triangles.0 > 0 { format!(" and {}", triangles.1) } else { String::new() };
    Ok(format!("The mesh was saved as {}: {}{rest}.", path.display(), quads.1))
}
