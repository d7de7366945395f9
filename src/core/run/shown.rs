//! What a figure of a run shows: states with the fingerprints that identify them, and the options it was drawn with.

use crate::core::convert::{Phase, Stop};
use crate::core::kernel::Fingerprint;
use crate::core::mesh::Mesh;

/// A state of a run as a figure shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownState {
    /// Its step.
    pub step: u64,
    /// The stop that selected it; `None`: the end.
    pub at: Option<Stop>,
    /// Its fingerprint.
    pub state: Fingerprint,
}

/// What a figure shows of its run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// The states; several are drawn side by side.
    pub states: Vec<ShownState>,
    /// The options it was drawn with, as command-line arguments.
    pub drawn: Vec<String>,
}

impl Shown {
    /// The state at which it opens: the last one.
    pub fn state(&self) -> Option<&ShownState> {
        self.states.last()
    }
}

/// The fingerprint of what a figure shows of a state: its mesh and the phase of the converter.
pub fn fingerprint(mesh: &Mesh, phase: &Phase) -> Fingerprint {
    let mut bytes = Vec::new();
    mesh.write_state(&mut bytes);
    bytes.extend_from_slice(format!("{:?}", phase.plain()).as_bytes());
    Fingerprint::of(&bytes)
}
