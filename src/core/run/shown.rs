//! What a figure of a run shows: its states, each with the fingerprint by which it is known again, and how it was drawn.

use crate::core::convert::phase::Phase;
use crate::core::convert::walk::Stop;
use crate::core::kernel::fingerprint::Fingerprint;
use crate::core::mesh::half_edge::Mesh;

/// A state of a run as a figure shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownState {
    /// Its step.
    pub step: u64,
    /// How it was asked for; `None`: as the end.
    pub at: Option<Stop>,
    /// Its fingerprint.
    pub state: Fingerprint,
}

/// What a figure shows of its run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// Its states, side by side where there are several.
    pub states: Vec<ShownState>,
    /// How it was drawn, in the words of the command line.
    pub drawn: Vec<String>,
}

impl Shown {
    /// The state that it opens at: the last one.
    pub fn state(&self) -> Option<&ShownState> {
        self.states.last()
    }
}

/// The fingerprint of what is seen of a state: its mesh and where the converter stands.
pub fn fingerprint(mesh: &Mesh, phase: &Phase) -> Fingerprint {
    let mut bytes = Vec::new();
    mesh.write_state(&mut bytes);
    bytes.extend_from_slice(format!("{:?}", phase.plain()).as_bytes());
    Fingerprint::of(&bytes)
}
