//! The step that made each quadrilateral, recorded during a conversion, for files and figures that show it.

use crate::core::convert::Converter;
use crate::core::mesh::{ElementId, Mesh, Touched};

/// The step that made each quadrilateral: the last step that turned its element into a quadrilateral, regardless of
/// later changes (as [`History::made`](super::history::History::made) defines it).
#[derive(Clone, Debug, Default)]
pub struct Births {
    steps: Vec<Option<u64>>,
    touched: Touched,
}

impl Births {
    /// For a mesh at the beginning of a conversion: its quadrilaterals were made at step 0.
    pub fn of(mesh: &Mesh) -> Births {
        let mut births = Births::default();
        mesh.elements().for_each(|e| births.see(mesh, e, 0));
        births
    }

    /// Records the quadrilaterals that the last step made. The converter must keep a history of at least that step.
    pub fn note(&mut self, converter: &Converter<'_>) {
        let mut touched = std::mem::take(&mut self.touched);
        converter.note_last_step(&mut touched);
        touched.elements().iter().for_each(|e| self.see(&converter.mesh, *e, converter.counts.steps));
        touched.clear();
        self.touched = touched;
    }

    /// The step that made a quadrilateral; `None` for other elements.
    pub fn step(&self, element: ElementId) -> Option<u64> {
        self.steps.get(element.index()).copied().flatten()
    }

    fn see(&mut self, mesh: &Mesh, element: ElementId, step: u64) {
        if self.steps.len() <= element.index() {
            self.steps.resize(element.index() + 1, None);
        }
        let known = &mut self.steps[element.index()];
        if mesh.has_element(element) && mesh.is_quad(element) {
            known.get_or_insert(step);
        } else {
            *known = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::convert::Phase;
    use crate::core::progress::Nobody;
    use crate::core::run::history::{BUDGET, History};
    use crate::core::run::run::Run;

    #[test]
    fn births_are_the_steps_that_a_history_finds() {
        let mut run = Run::of(built_in::named("two-faces").unwrap().unwrap());
        run.parameters.size_scale *= 2.0;
        let background = run.background(&mut Nobody).unwrap();
        let mut history = History::of(run.clone(), &background, BUDGET).unwrap();
        history.seek(u64::MAX).unwrap();
        let mut converter = run.start(&background).unwrap();
        converter.keep_history();
        let mut births = Births::of(&converter.mesh);
        while *converter.phase() != Phase::Done {
            converter.step().unwrap();
            births.note(&converter);
            converter.shorten_history(1);
        }
        let quads: Vec<_> = converter.mesh.elements().collect();
        assert!(quads.len() > 20, "{}", quads.len());
        for e in quads {
            assert_eq!(births.step(e), history.made(e).unwrap(), "{e:?}");
        }
    }
}
