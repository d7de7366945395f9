//! Copies of the current mesh for other threads. A copy that is no longer in use is updated by what changed since, so
//! that the cost of a step depends on what it changes and not on the size of the mesh.

use std::sync::Arc;

use super::history::Changes;
use crate::core::mesh::{Mesh, Touched};

/// The number of copies: one in use, one on its way, one to update.
const KEPT: usize = 3;

/// The changes since a state was last taken.
#[derive(Clone, Debug, Default)]
pub struct Since {
    touched: Touched,
    /// Whether too much changed to list it.
    all: bool,
}

impl Since {
    /// Everything is new.
    pub fn everything() -> Since {
        Since { touched: Touched::default(), all: true }
    }

    /// Records changes in a mesh with this number of element slots.
    pub fn note(&mut self, changes: &Changes, slots: usize) {
        match changes {
            Changes::Everything => self.all = true,
            Changes::Some { nodes, elements } if !self.all => {
                self.touched.note_ids(nodes, elements);
                self.all = self.touched.elements().len() > slots / 4 + 256;
            }
            Changes::Some { .. } => {}
        }
        if self.all {
            self.touched.clear();
        }
    }

    /// Whether nothing changed.
    pub fn is_nothing(&self) -> bool {
        !self.all && self.touched.is_empty()
    }

    /// Takes the changes and starts again with none.
    pub fn take(&mut self) -> Changes {
        if std::mem::take(&mut self.all) {
            return Changes::Everything;
        }
        let changes =
            Changes::Some { nodes: self.touched.nodes().to_vec(), elements: self.touched.elements().to_vec() };
        self.touched.clear();
        changes
    }
}

/// A copy of the mesh with the changes since it was made.
struct Copy {
    mesh: Arc<Mesh>,
    since: Since,
}

/// Copies of one mesh.
#[derive(Default)]
pub struct Copies {
    copies: Vec<Copy>,
}

impl Copies {
    /// Records changes of the mesh.
    pub fn note(&mut self, changes: &Changes) {
        for copy in &mut self.copies {
            copy.since.note(changes, copy.mesh.element_slots());
        }
    }

    /// A copy of the mesh in its current state. All its changes must have been recorded.
    pub fn of(&mut self, mesh: &Mesh) -> Arc<Mesh> {
        if let Some(same) = self.copies.iter().find(|copy| copy.since.is_nothing()) {
            return same.mesh.clone();
        }
        for copy in &mut self.copies {
            let Some(free) = Arc::get_mut(&mut copy.mesh) else { continue };
            if copy.since.all {
                free.become_same(mesh);
            } else {
                free.follow(mesh, &copy.since.touched);
            }
            copy.since.all = false;
            copy.since.touched.clear();
            return copy.mesh.clone();
        }
        // All are in use: leave the oldest one to its users.
        if self.copies.len() == KEPT {
            self.copies.remove(0);
        }
        let fresh = Arc::new(mesh.without_journal());
        self.copies.push(Copy { mesh: fresh.clone(), since: Since::default() });
        fresh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::history::History;
    use crate::core::run::run::Run;

    fn bytes(mesh: &Mesh) -> Vec<u8> {
        let mut bytes = Vec::new();
        mesh.write_state(&mut bytes);
        bytes
    }

    #[test]
    fn a_copy_equals_the_current_state_after_any_move_and_earlier_copies_stay() {
        let mut case = built_in::named("example1").unwrap().unwrap();
        case.parameters.size_scale = 2.0;
        let mut history = History::open(Run::of(case), &mut Nobody).unwrap();
        history.extend(u64::MAX);
        let end = history.end().unwrap();
        let mut copies = Copies::default();
        let mut in_use = Vec::new();
        let walk = (0..60).chain((0..60).rev()).chain([end, end - 1, 3, 4, 5, end / 2, end / 2 - 1, end / 2 + 40]);
        for (k, step) in walk.enumerate() {
            history.seek(step).unwrap();
            let changes = history.take_changes();
            let small = matches!(changes, Changes::Some { .. });
            copies.note(&changes);
            let copy = copies.of(&history.state().mesh);
            assert_eq!(bytes(&copy), bytes(&history.state().mesh), "step {step}");
            if let (true, Changes::Some { nodes, elements }) = (small, &changes) {
                copy.check_around(nodes, elements).unwrap();
            }
            in_use.push((step, copy.clone(), bytes(&copy)));
            in_use.retain(|_| k % 7 != 0);
        }
        // Copies in use do not change.
        assert!(in_use.iter().all(|(_, mesh, seen)| bytes(mesh) == *seen));
        assert!(copies.copies.len() <= KEPT);
    }
}
